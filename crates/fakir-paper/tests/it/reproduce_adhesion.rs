//! A coarse study of adhesion, interrupted and resumed, and its report read back from its tables.

use fakir::state::{CancelToken, Run};
use fakir_paper::adhesion::scaling::{Form, HeldOut, Reduced};
use fakir_paper::adhesion::study::{FloorCase, Part, Scope, others};
use fakir_paper::adhesion::{Progress, cases_of_laws, reproduce_adhesion};
use fakir_paper::{PaperError, grid::Substrate};
use fakir_study::{Existing, StudyError, collapse};
use std::collections::HashMap;
use std::f64::consts::PI;
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

/// The row of the intermediate substrate at 3 % with this work of adhesion (J/m^2).
fn typical(rows: &[Record], work: f64) -> &Record {
    let near =
        |row: &Record, name: &str, value: f64| (number(row, name) / value - 1.0).abs() < 1e-9;
    let found = rows.iter().find(|row| {
        near(
            row,
            "substrate.young_modulus_Pa",
            Substrate::Intermediate.young_modulus(),
        ) && near(row, "pattern.surface_fraction", 0.03)
            && near(row, "adhesion.work_J_per_m2", work)
    });
    found.expect("a row")
}

fn small() -> Scope {
    Scope {
        fractions: vec![0.02, 0.03],
        works: vec![10e-3, 20e-3, 50e-3, 100e-3],
        heights: vec![1.7e-6, 2.2e-6, 2.9e-6],
        diameters: vec![5e-6, 6e-6, 7e-6],
        sized_fractions: vec![0.02],
        sized_works: vec![30e-3],
        ..Scope::quick()
    }
}

/// A study that is stopped after some cases continues from its journal. Three findings and the scatter of every law are derived again from the
/// tables.
#[test]
#[ignore = "slow: the whole study"]
fn the_report_agrees_with_the_tables() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("reproduce-adhesion");
    if folder.exists() {
        std::fs::remove_dir_all(&folder).unwrap();
    }
    let scope = small();
    let cancel = CancelToken::default();
    let run = Run {
        cancel: cancel.clone(),
        ..Run::default()
    };
    let stop = |progress: Progress| {
        if matches!(progress, Progress::Sweep(Part::Floor, progress) if progress.done >= 5) {
            cancel.cancel();
        }
    };
    let stopped = reproduce_adhesion(&scope, &folder, Existing::Refuse, &run, &stop);
    let Err(PaperError::Study(StudyError::Interrupted { done, cases })) = stopped else {
        panic!("not interrupted: {stopped:?}");
    };
    assert!((5..cases).contains(&done));
    assert!(!folder.join("report.html").exists());

    let found = std::sync::Mutex::new(0);
    let see = |progress: Progress| {
        if let Progress::Sweep(Part::Floor, progress) = progress {
            *found.lock().unwrap() = progress.found;
        }
    };
    let run = Run::default();
    let made = reproduce_adhesion(&scope, &folder, Existing::Resume, &run, &see).unwrap();
    assert_eq!(*found.lock().unwrap(), done);
    assert_eq!(made.failed, 0);
    for plate in &made.plates {
        let faults = plate.figure.faults();
        assert_eq!(faults, Vec::<String>::new(), "{}", plate.figure.name());
    }
    let report = std::fs::read_to_string(folder.join("report.html")).unwrap();
    for loads in ["src=\"", "url(http", "<script", "<link"] {
        assert!(!report.contains(loads), "{loads}");
    }

    let claims = read(&folder.join("tables/findings.csv"));
    let claimed = |name: &str| {
        let row = claims.iter().find(|row| row["number"] == name);
        number(row.unwrap_or_else(|| panic!("{name}")), "value")
    };
    let same = |name: &str, expected: f64| {
        assert!(
            (claimed(name) / expected - 1.0).abs() < 1e-9,
            "{name}: {} {expected}",
            claimed(name)
        );
    };
    let (floor, tops) = (
        read(&folder.join("floor/table.csv")),
        read(&folder.join("tops/table.csv")),
    );
    // The model compared with the case on cells within its range.
    let cells = read(&folder.join("cells/table.csv"));
    let (cells, model) = (typical(&cells, 0.01), typical(&floor, 0.01));
    let [by_model, by_cells] = [model, cells].map(|of| number(of, "floor_lost_indentation_m"));
    let change = (by_model - by_cells).abs() / number(model, "critical_indentation_m");
    assert!(claimed("largest_change_of_loss_over_critical_indentation") >= 0.999_999 * change);
    assert!(claimed("solved_on_cells") >= 2.0);
    let (floor, tops) = (typical(&floor, 0.05), typical(&tops, 0.05));
    // The jump.
    let critical = number(floor, "critical_force_N");
    let drop = 1.0 - number(floor, "jump_force_N") / critical;
    same("jump_force_drop", drop);
    same("jump_holes", number(floor, "jump_holes"));
    assert!(
        report.contains(&format!("{:.1} % of", 100.0 * drop)),
        "{drop}"
    );
    // The pull-off.
    let pulls = [
        number(floor, "floor_pull_off_force_N"),
        number(tops, "pull_off_force_N"),
    ];
    same("floor_over_tops_pull_off", pulls[0] / pulls[1]);
    assert!(report.contains(&format!("{:.2} times the", pulls[0] / pulls[1])));
    // The threshold.
    same(
        "collapse_work_intermediate_mJ_per_m2",
        1e3 * number(floor, "collapse_work_J_per_m2"),
    );

    // Scatter of the cases and of the test systems about the laws.
    let of_laws = cases_of_laws(&made.cases);
    assert!(made.laws.len() >= 4, "{:?}", made.laws);
    for (law, held) in &made.laws {
        let is_sum = law.reduced.form() == Form::Sum;
        let residual = |case: &&FloorCase| {
            let (value, by_law) = (law.reduced.of(case)?, law.at(case));
            Some(if is_sum {
                value - by_law
            } else {
                (value / by_law).ln()
            })
        };
        let residuals: Vec<f64> = of_laws.iter().filter_map(residual).collect();
        let squares: f64 = residuals.iter().map(|x| x * x).sum();
        let freedom = (residuals.len() - law.groups.len() - 1) as f64;
        let name = law.reduced.name();
        let root = (squares / freedom).sqrt();
        let scatter = if is_sum { root } else { root.exp_m1() };
        same(&format!("{name}_scatter"), scatter);
        // The residuals of least squares are orthogonal to every group.
        assert!(residuals.iter().sum::<f64>().abs() < 1e-6);
        let held = held.unwrap();
        same(&format!("{name}_held_out_scatter"), held.scatter);
        println!(
            "{} = {}: {} {} held out {held:?}",
            law.reduced.plain(),
            law.words(),
            law.scatter,
            law.largest
        );
    }
    // A withdrawal and a pull-off computed by hand.
    let by_hand =
        1.0 - number(floor, "floor_lost_indentation_m") / number(floor, "critical_indentation_m");
    let case = made.cases.at(Substrate::Intermediate, 0.03, 0.05).unwrap();
    assert!((Reduced::Withdrawal.of(case).unwrap() - by_hand).abs() < 1e-12);
    let smooth = 1.5 * PI * 0.05 * 2.2e-3;
    assert!((Reduced::PullOff.of(case).unwrap() + pulls[0] / smooth).abs() < 1e-9);

    // Systems that were not in the study.
    let fresh = fresh(20, 20);
    let (mut cases, mut right) = (0, 0);
    for (law, held) in &made.laws {
        let found = HeldOut::new(law, &fresh).unwrap();
        println!("{}: {found:?}, band {}", law.reduced.name(), law.band);
        let largest = law.band.max(held.unwrap().largest);
        let within = |case: &&FloorCase| law.distance(case).is_some_and(|d| d <= largest);
        cases += found.points;
        right += fresh.iter().filter(within).count();
    }
    println!("{right} of {cases} within the interval of the report");
    assert!(20 * right >= 19 * cases, "{right} of {cases}");
    for finding in &made.findings {
        println!("{}: {}", finding.title, finding.text);
    }
}

/// A number of further test systems, solved one by one.
fn fresh(count: usize, after: usize) -> Vec<FloorCase> {
    use fakir_case::{Case, CaseFile};
    use fakir_paper::adhesion::study::VARIED;
    let systems = others(count, after).expect("systems");
    let case = |values: [f64; 6]| {
        let mut file = CaseFile::parse("fresh", &Case::example().to_toml()).expect("a case");
        for (key, value) in VARIED.into_iter().zip(values) {
            file.set_number(key, value);
        }
        let case = file.case().expect("a case");
        let (found, _) = collapse(&case.system, case.method, &Run::default()).expect("an answer");
        FloorCase {
            surface_fraction: values[3],
            young_modulus: values[4],
            offset: 0.0,
            height: values[1],
            diameter: values[2],
            lens_radius: values[0],
            found,
            cells: None,
        }
    };
    systems.into_iter().map(case).collect()
}

/// Systems with the same groups are equal except for their units: all lengths along the surface are scaled by 1.5, heights by 1.3,
/// moduli by 3.
#[test]
fn systems_with_the_same_groups_are_the_same() {
    use fakir_case::{Case, CaseFile, Key};
    let answer = |along: f64, up: f64, stiff: f64| {
        let mut file = CaseFile::parse("similar", &Case::example().to_toml()).expect("a case");
        for (key, value) in [
            (Key::LensRadius, 2.2e-3 * along * along / up),
            (Key::PillarHeight, 2.2e-6 * up),
            (Key::PillarDiameter, 6e-6 * along),
            (Key::LensYoungModulus, 2e6 * stiff),
            // The compliance of the column is proportional to h/(E_s d), that of the punch to 1/E*.
            (Key::SubstrateYoungModulus, 1e12),
            (Key::SurfaceFraction, 0.03),
            (Key::WorkOfAdhesion, 60e-3 * stiff * up * up / along),
        ] {
            file.set_number(key, value);
        }
        let case = file.case().expect("a case");
        let (found, _) = collapse(&case.system, case.method, &Run::default()).expect("an answer");
        found
    };
    let (one, other) = (answer(1.0, 1.0, 1.0), answer(1.5, 1.3, 3.0));
    assert!((one.lens_number / other.lens_number - 1.0).abs() < 1e-12);
    let ratio = one.work_over_collapse_work / other.work_over_collapse_work;
    assert!((ratio - 1.0).abs() < 1e-4, "{ratio}");
    assert_eq!(one.fate, other.fate);
    let unit = |of: &fakir_study::Collapsed| of.jump.expect("a jump").force / of.critical_force;
    assert!((unit(&one) - unit(&other)).abs() < 1e-3);
    let lost = |of: &fakir_study::Collapsed| {
        of.lost.expect("a loss").indentation / of.critical_indentation
    };
    assert!((lost(&one) - lost(&other)).abs() < 1e-9);
}
