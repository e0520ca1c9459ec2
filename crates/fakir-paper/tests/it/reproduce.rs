//! A coarse reproduction of the paper, read back from its files.

use fakir::state::Run;
use fakir_figure::Measured;
use fakir_paper::grid::{Fractions, Substrate};
use fakir_paper::{Scope, reproduce};
use fakir_study::{Existing, StudyError};
use std::collections::HashMap;
use std::path::Path;

type Record = HashMap<String, String>;

fn read(path: &Path) -> Vec<Record> {
    let mut reader = csv::Reader::from_path(path).expect("a table");
    let rows = reader.deserialize();
    rows.map(|row| row.expect("a row")).collect()
}

fn number(record: &Record, name: &str) -> f64 {
    record[name].parse().expect("a number")
}

/// Rows of a substrate with the lens axis on a pillar.
fn on_pillar(rows: &[Record], young_modulus: f64) -> Vec<&Record> {
    rows.iter()
        .filter(|row| {
            let modulus = number(row, "substrate.young_modulus_Pa");
            (modulus / young_modulus - 1.0).abs() < 1e-12 && number(row, "pattern.offset") == 0.0
        })
        .collect()
}

/// Slope of a straight line by least squares.
fn centre(points: &[(f64, f64)]) -> (f64, f64) {
    let count = points.len() as f64;
    let mean_x = points.iter().map(|p| p.0).sum::<f64>() / count;
    let mean_y = points.iter().map(|p| p.1).sum::<f64>() / count;
    (mean_x, mean_y)
}

fn slope(points: &[(f64, f64)]) -> f64 {
    let (mean_x, mean_y) = centre(points);
    let products: f64 = points.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    products / points.iter().map(|p| (p.0 - mean_x).powi(2)).sum::<f64>()
}

/// Numbers of the report are derived again from the table of critical states; figures have no
/// faults; files are where the report states.
#[test]
#[ignore = "slow: the whole study"]
fn the_report_agrees_with_the_tables() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("paper");
    let measured = Measured {
        surface_fraction: [0.01, 0.001],
        force: Some([10.0, 2.0]),
        contact_radius: None,
        indentation: Some([1.5, 0.1]),
    };
    let scope = Scope {
        fractions: Fractions {
            points: 12,
            to: 0.05,
            ..Fractions::OBSERVED
        },
        dense: false,
        measured: vec![(Substrate::Intermediate, measured)],
    };
    let run = Run::default();
    let made = reproduce(&scope, &folder, Existing::Refuse, &run, &|_| {}).unwrap();
    assert_eq!((made.cases, made.failed), (216, 0));
    for plate in &made.plates {
        let faults = plate.figure.faults();
        assert_eq!(faults, Vec::<String>::new(), "{}", plate.figure.name());
        for extension in ["svg", "png"] {
            let name = format!("figures/{}.{extension}", plate.figure.name());
            assert!(folder.join(name).is_file());
        }
    }
    let report = std::fs::read_to_string(folder.join("report.html")).unwrap();
    // One file: nothing is loaded from elsewhere.
    for loads in ["src=\"", "url(http", "<script", "<link"] {
        assert!(!report.contains(loads), "{loads}");
    }

    let rows = read(&folder.join("critical-states/table.csv"));
    let claims = read(&folder.join("tables/claims.csv"));
    let claimed = |name: &str| {
        let row = claims.iter().find(|row| row["number"] == name);
        number(row.unwrap(), "value")
    };
    // The force on one pillar, and the ratio of the substrates.
    let near = |modulus: f64| {
        let rows = on_pillar(&rows, modulus);
        let away = |row: &&&Record| (number(row, "pattern.surface_fraction") / 1e-3).ln().abs();
        let row = rows.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        number(row.unwrap(), "critical_force_N")
    };
    let (rigid, intermediate) = (near(1e9), near(2e6));
    assert_eq!(
        claimed("one_pillar_force_rigid_N").to_bits(),
        rigid.to_bits()
    );
    assert!(report.contains(&format!("{:.2} × 10⁻⁵ N", rigid * 1e5)));
    let ratio = intermediate / rigid;
    assert!((claimed("intermediate_over_rigid_force") - ratio).abs() < 1e-15);
    assert!(report.contains(&format!("{ratio:.3} of it.")));
    // An exponent.
    let points: Vec<(f64, f64)> = on_pillar(&rows, 2e6)
        .into_iter()
        .map(|row| {
            let phi = number(row, "pattern.surface_fraction");
            (phi, number(row, "critical_force_N"))
        })
        .filter(|(phi, _)| (0.01..=0.05).contains(phi))
        .map(|(phi, force)| (phi.ln(), force.ln()))
        .collect();
    let exponent = slope(&points);
    let laws = read(&folder.join("tables/power-laws.csv"));
    let law = laws
        .iter()
        .find(|law| law["quantity"] == "critical force" && law["substrate"] == "intermediate")
        .unwrap();
    assert!((number(law, "exponent") - exponent).abs() < 1e-12);
    // The curve has no noise, so that the deviation from the law is stated instead of a confidence
    // interval.
    let (mean_x, mean_y) = centre(&points);
    let line = |x: f64| mean_y + exponent * (x - mean_x);
    let away = points.iter().map(|(x, y)| (y - line(*x)).exp_m1());
    let largest = away.map(f64::abs).fold(0.0, f64::max);
    assert!((number(law, "largest_deviation") - largest).abs() < 1e-12);
    assert!(report.contains(&format!("{exponent:.3}, within ")));
    assert!(!report.contains('±'));
    for symbol in ["γ<sub>int</sub>", "δx/e", "φ", "r<sub>c</sub>"] {
        assert!(report.contains(&format!("<td>{symbol}</td>")), "{symbol}");
    }

    // A folder that is not empty is refused.
    let again = reproduce(&scope, &folder, Existing::Refuse, &run, &|_| {});
    assert!(matches!(
        again,
        Err(fakir_paper::PaperError::Study(StudyError::NotEmpty(_)))
    ));
}
