//! Samples of height maps, against the spectral method, laws of scaling, and cases that are solved again.

use fakir::problem::Load;
use fakir::state::Run;
use fakir_case::{CaseFile, Key};
use fakir_inverse::spread::{
    Critical, Deviation, Landing, Sampling, Spread, SpreadError, Tolerance, spread,
};
use std::fmt::Write;

const BODIES: &str = "[lens]\nshape = \"paraboloid\"\nradius = \"1 mm\"\nyoung_modulus = \"1e9 GPa\"\npoisson_ratio = 0.5\n\
                      [substrate]\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n";

/// Round pillars on a square lattice, which is known to the spectral method too.
const ROUND: &str = "[surface]\narrangement = \"square\"\npitch = \"14 um\"\n\
                     [surface.pillar]\ndiameter = \"6 um\"\nheight = \"0.3 um\"\n\
                     [surface.grid]\ncells_per_diameter = 12\nwidth = \"80 um\"\n";
const PATTERN: &str = "[pattern]\nlattice = \"square\"\npitch = \"14 um\"\n\
                       [pattern.pillar]\ndiameter = \"6 um\"\nheight = \"0.3 um\"\n";

fn file(surface: &str, overrides: &[&str]) -> CaseFile {
    let mut file = CaseFile::parse("case.toml", &format!("{BODIES}{surface}")).unwrap();
    for argument in overrides {
        file.set(argument).unwrap();
    }
    file
}

/// Heights of a file in units of 0.1 um: tops of 8 by 8 um on a floor, on cells of 1 um.
fn map(floor: &str) -> CaseFile {
    let mut heights = String::new();
    for row in 0..64 {
        for column in 0..64 {
            let is_top = row % 16 < 8 && column % 16 < 8;
            write!(heights, "{} ", if is_top { 2 } else { 0 }).unwrap();
        }
        heights.push('\n');
    }
    let surface =
        "[surface]\nheight_map = \"map.txt\"\nheight_unit = \"0.1 um\"\ncell_size = \"1 um\"\n";
    file(&format!("{surface}{floor}"), &[]).with_table("map.txt", heights.as_bytes())
}

/// What of the map is floor.
const FLOOR: &str = "floor = \"0.1 um\"\n";

/// Square pillars in the place of round ones.
fn squares() -> String {
    ROUND.replace(
        "diameter = \"6 um\"",
        "cross_section = \"square\"\nside = \"6 um\"",
    )
}

fn sampling(tolerances: &[(Key, f64)], landing: Landing, samples: usize) -> Sampling {
    let tolerances = tolerances.iter().map(|(key, part)| Tolerance {
        key: *key,
        deviation: Deviation::Relative(*part),
    });
    Sampling {
        tolerances: tolerances.collect(),
        landing,
        indentations: vec![0.3e-6],
        samples,
        seed: 5,
    }
}

fn samples(file: &CaseFile, sampling: &Sampling) -> Spread {
    spread(file, sampling, &Run::default(), &|_| {}).unwrap()
}

/// Mean and standard deviation of the same samples by both methods: within the errors that are stated for the cells.
#[test]
fn round_pillars_scatter_as_with_the_spectral_method() {
    const SAMPLES: usize = 6;
    let of = |height, diameter, modulus| {
        let tolerances = [(height, 0.1), (diameter, 0.03), (modulus, 0.05)];
        sampling(&tolerances, Landing::Anywhere, SAMPLES)
    };
    let modulus = Key::SubstrateYoungModulus;
    let on_cells = of(Key::PatternHeight, Key::OutlineDiameter, modulus);
    let on_cells = samples(&file(ROUND, &[]), &on_cells);
    let exact = of(Key::PillarHeight, Key::PillarDiameter, modulus);
    let exact = samples(&file(PATTERN, &[]), &exact);
    for (one, other) in on_cells.samples.iter().zip(&exact.samples) {
        assert_eq!(one.offset.to_bits(), other.offset.to_bits());
        assert_eq!(one.values, other.values);
    }
    let both =
        |name, pick: fn(&Critical) -> f64| (name, on_cells.summary(pick), exact.summary(pick));
    let compared = [
        both("force", |it| it.force),
        both("indentation", |it| it.indentation),
        both("contact radius", |it| it.contact_radius),
    ];
    let pressed = ("pressed", on_cells.force_summary(0), exact.force_summary(0));
    for (name, found, expected) in compared.into_iter().chain([pressed]) {
        let (found, expected) = (found.unwrap(), expected.unwrap());
        let [of_mean, of_deviation] = found.errors.unwrap();
        println!("{name}: {found:?} {expected:?}");
        assert!((found.mean - expected.mean).abs() <= of_mean, "{name}");
        assert!(
            (found.deviation - expected.deviation).abs() <= of_deviation,
            "{name}"
        );
        assert!(of_mean < 0.2 * found.mean, "{name}");
        assert!(expected.errors.is_none(), "{name}");
    }
    assert!(on_cells.first_order.is_err());
}

/// Under a rigid lens and without columns, all forces are in proportion to the modulus, so that their relative scatter is that of the modulus. Under a paraboloid
/// they are those of the lens radius `R` with heights times `R` over `R^2`: all heights of both surfaces are then in proportion.
#[test]
fn a_map_of_a_file_scatters_as_a_whole() {
    let map = map(FLOOR);
    let force = |overrides: &[(Key, f64)]| {
        let mut file = map.clone();
        for (key, value) in overrides {
            file.set_number(*key, *value);
        }
        let case = file.surface_case(1_000_000_000).unwrap();
        let critical = case.system.transition(&Run::default()).unwrap();
        critical.contact.force
    };
    let tolerance = [(Key::SubstrateYoungModulus, 0.1)];
    let of_moduli = samples(&map, &sampling(&tolerance, Landing::AsGiven, 4));
    let reference = force(&[]);
    for sample in &of_moduli.samples {
        let found = sample.outcome.as_ref().unwrap().force;
        let times = sample.values[0] / 2e6;
        assert!((found / reference / times - 1.0).abs() < 1e-6);
    }
    let values: Vec<f64> = of_moduli.samples.iter().map(|it| it.values[0]).collect();
    let mean = values.iter().sum::<f64>() / 4.0;
    let squares: f64 = values.iter().map(|it| (it / mean - 1.0).powi(2)).sum();
    let summary = of_moduli.summary(|it| it.force).unwrap();
    let relative = summary.deviation / summary.mean;
    assert!((relative / (squares / 3.0).sqrt() - 1.0).abs() < 1e-6);
    // The relative error of the cells is the same in all samples, and so in the mean and in the deviation.
    let [of_mean, of_deviation] = summary.errors.unwrap();
    let ratio = of_mean / summary.mean / (of_deviation / summary.deviation);
    assert!((ratio - 1.0).abs() < 1e-4, "{ratio}");

    let tolerance = [(Key::LensRadius, 0.1)];
    let of_radii = samples(&map, &sampling(&tolerance, Landing::AsGiven, 3));
    for sample in &of_radii.samples {
        let times = sample.values[0] / 1e-3;
        let [unit, floor] = [0.1e-6, 0.1e-6].map(|height| height * times);
        let expected = force(&[(Key::HeightUnit, unit), (Key::Floor, floor)]) / times;
        let found = sample.outcome.as_ref().unwrap().force;
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }
    let table = of_radii.table(&sampling(&tolerance, Landing::AsGiven, 3));
    assert!(!table.to_csv().contains("offset"));
}

/// Random pillars, and heights of pillars: other ones in every sample, each of which is the case with its seed.
#[test]
fn pillars_on_cells_are_drawn_again() {
    let squares = squares();
    let random = squares.replace("pitch = \"14 um\"", "surface_fraction = 0.2");
    let random = random.replace("arrangement = \"square\"", "arrangement = \"random\"");
    let coarse = "surface.grid.cells_per_diameter=6";
    for (file, landing) in [
        (file(&random, &[coarse]), Landing::Anywhere),
        (
            file(&squares, &[coarse, "surface.height_half_width=0.1"]),
            Landing::AsGiven,
        ),
    ] {
        let sampling = sampling(&[], landing, 3);
        let spread = samples(&file, &sampling);
        let mut found = Vec::new();
        for sample in &spread.samples {
            let mut file = file.clone();
            file.set_number(Key::Seed, f64::from(sample.pillar_seed.unwrap()));
            let case = file.surface_case(1_000_000_000).unwrap();
            let load = Load::Indentation(0.3e-6);
            let force = case.system.press(load, &Run::default()).unwrap().force;
            // Samples without a reliable critical state have no forces.
            if sample.outcome.is_ok() {
                assert_eq!(sample.forces, [force]);
                found.push(force);
            }
        }
        assert!(
            found.len() >= 2 && found[0].to_bits() != found[1].to_bits(),
            "{found:?}"
        );
        assert!(spread.table(&sampling).to_csv().contains("surface.seed"));
    }
    // Pillars of a random arrangement that stay where they are.
    let still = samples(
        &file(&random, &[coarse]),
        &sampling(&[], Landing::AsGiven, 2),
    );
    assert_eq!(still.samples[0], still.samples[1]);
}

/// A single square pillar that is covered by the contact: its pull-off force grows with the work of adhesion.
#[test]
#[ignore = "slow: cycles on cells"]
fn adhesive_maps_are_unloaded() {
    let single = "[surface]\narrangement = \"square\"\npitch = \"60 um\"\n\
                  [surface.pillar]\ncross_section = \"square\"\nside = \"24 um\"\nheight = \"0.3 um\"\n\
                  [surface.grid]\ncells_per_diameter = 40\nwidth = \"80 um\"\n";
    let adhesive = file(single, &["adhesion.work=50 mJ/m2"]);
    let tolerance = [(Key::WorkOfAdhesion, 0.3)];
    let spread = samples(&adhesive, &sampling(&tolerance, Landing::AsGiven, 3));
    assert!(spread.is_adhesive(), "{:?}", spread.samples);
    let mut pulled: Vec<(f64, f64)> = Vec::new();
    for sample in &spread.samples {
        let pull_off = sample.outcome.as_ref().unwrap().pull_off.unwrap();
        assert!(pull_off.force < 0.0 && pull_off.hysteresis > 0.0);
        pulled.push((sample.values[0], -pull_off.force));
    }
    pulled.sort_by(|one, other| one.0.total_cmp(&other.0));
    assert!(
        pulled.windows(2).all(|pair| pair[0].1 < pair[1].1),
        "{pulled:?}"
    );
    let summary = spread.pull_off_summary(|it| it.force).unwrap();
    let [of_mean, of_deviation] = summary.errors.unwrap();
    assert!(of_mean > 0.0 && of_deviation >= 0.0, "{summary:?}");
}

#[test]
fn what_cannot_vary_on_a_map_is_refused_with_what_can() {
    let refused = |file: &CaseFile, key, landing| {
        let sampling = sampling(&[(key, 0.1)], landing, 2);
        spread(file, &sampling, &Run::default(), &|_| {})
            .unwrap_err()
            .to_string()
    };
    let given = Landing::AsGiven;
    let of_pillars = refused(&map(FLOOR), Key::PatternHeight, given);
    assert!(
        of_pillars.contains("surface.pillar.height has no tolerance")
            && of_pillars.contains("surface.height_unit"),
        "{of_pillars}"
    );
    let of_pattern = refused(&file(ROUND, &[]), Key::PillarHeight, given);
    assert!(
        of_pattern.contains("have surface.pillar.height"),
        "{of_pattern}"
    );
    for setting in [Key::GridCells, Key::GridWidth, Key::Seed] {
        let why = refused(&file(ROUND, &[]), setting, given);
        assert!(
            why.contains(setting.path()) && why.contains("setting"),
            "{why}"
        );
    }
    let absent = refused(&map(FLOOR), Key::HeightRange, given);
    assert!(absent.contains("the case file gives"), "{absent}");
    let anywhere = refused(&map(FLOOR), Key::LensRadius, Landing::Anywhere);
    assert!(anywhere.contains("--keep-offset"), "{anywhere}");
    let sampling = sampling(&[(Key::LensRadius, 0.1)], given, 2);
    let why = spread(&map(""), &sampling, &Run::default(), &|_| {}).unwrap_err();
    assert!(matches!(why, SpreadError::NoFloor), "{why}");
}
