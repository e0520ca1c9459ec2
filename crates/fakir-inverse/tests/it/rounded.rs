//! Fits of measurements on rounded tops, to data from closed forms of one top, and from contacts of many, with known parameters.

use super::flat::{close, covers, fitted, jkr_force, value};
use chacha20::ChaCha12Rng;
use chacha20::rand_core::SeedableRng;
use fakir::problem::{Accuracy, Load};
use fakir::state::{Branch, Run};
use fakir_case::{CaseFile, Key};
use fakir_inverse::fit::{Column, FitError, FitOptions, Measurements, Parameter, fit};
use rand_distr::{Distribution, Normal};

const SUBSTRATE: Parameter = Parameter::Key(Key::SubstrateYoungModulus);
const CURVATURE: Parameter = Parameter::Key(Key::TopRadius);
const WORK: Parameter = Parameter::Key(Key::WorkOfAdhesion);
const POINT: Parameter = Parameter::ContactPoint;
const OFFSET: Parameter = Parameter::ForceOffset;
const COMPLIANCE: Parameter = Parameter::MachineCompliance;

/// Rubber tops under a glass plate. Fits begin with 1 MPa.
const TOPS: &str = "[lens]\nshape = \"plate\"\nyoung_modulus = \"70 GPa\"\npoisson_ratio = 0.2\n\
                    [substrate]\nyoung_modulus = \"1 MPa\"\npoisson_ratio = 0.5\n\
                    [pattern]\nlattice = \"square\"\npitch = \"0.2 mm\"\ncolumns = 1\ntop_radius = \"0.5 mm\"\n\
                    [pattern.pillar]\nheight = \"0.2 mm\"\n";

const RADIUS: f64 = 0.5e-3;
const TRUE_MODULUS: f64 = 1.6e6;
const TRUE_WORK: f64 = 45e-3;
const TRUE_POINT: f64 = 4e-6;
const TRUE_OFFSET: f64 = 3e-6;

pub(crate) fn file(overrides: &[&str]) -> CaseFile {
    let mut file = CaseFile::parse("tops.toml", TOPS).unwrap();
    for argument in overrides {
        file.set(argument).unwrap();
    }
    file
}

/// `E*` of a substrate on glass.
fn reduced(young_modulus: f64) -> f64 {
    ((1.0 - 0.25) / young_modulus + (1.0 - 0.04) / 70e9).recip()
}

/// Readings of a force at depths below the first contact, with noise of the force (N).
fn readings(depths: &[f64], force: impl Fn(f64) -> f64, noise: f64, seed: u64) -> Measurements {
    let mut random = ChaCha12Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, noise).unwrap();
    let forces = depths.iter().map(|depth| force(*depth) + TRUE_OFFSET);
    let forces = forces.map(|force| force + normal.sample(&mut random));
    let columns = [
        (Column::Force, forces.collect::<Vec<_>>()),
        (
            Column::Displacement,
            depths.iter().map(|depth| depth + TRUE_POINT).collect(),
        ),
    ];
    Measurements::new(&columns).unwrap()
}

/// Hertz's contact, `F = 4/3 E* sqrt(R) zeta^(3/2)`.
fn hertz(depth: f64) -> f64 {
    4.0 / 3.0 * reduced(TRUE_MODULUS) * RADIUS.sqrt() * depth.max(0.0).powf(1.5)
}

fn depths(count: i32) -> Vec<f64> {
    (-count / 5..count)
        .map(|k| 6e-6 * f64::from(k) / f64::from(count))
        .collect()
}

#[test]
fn parameters_of_hertz_are_found_again() {
    let data = readings(&depths(30), hertz, 1e-12, 1);
    let found = fitted(&file(&[]), &data, &[SUBSTRATE, POINT, OFFSET]);
    close(value(&found, SUBSTRATE), TRUE_MODULUS, 1e-4);
    assert!((value(&found, POINT) - TRUE_POINT).abs() < 1e-9);
    close(value(&found, OFFSET), TRUE_OFFSET, 5e-3);
    assert_eq!(found.method, "rounded tops");
    assert!(found.cycle.is_none() && found.rows.iter().all(|row| row.branch.is_none()));
    assert!(found.scatter[0].interpolation_error.unwrap() < 1e-3 * hertz(6e-6));
    // With the modulus, the radius of curvature.
    let begin = file(&["substrate.young_modulus=1.6MPa", "pattern.top_radius=0.3mm"]);
    let found = fitted(&begin, &data, &[CURVATURE, POINT, OFFSET]);
    close(value(&found, CURVATURE), RADIUS, 2e-4);
    // Not both: the force contains their product `E* sqrt(R)` only.
    let both = [SUBSTRATE, CURVATURE, POINT];
    let found = fit(
        &file(&[]),
        &data,
        &both,
        &FitOptions::default(),
        &Run::default(),
    )
    .unwrap();
    let [together] = &found.undetermined[..] else {
        panic!("{:?}", found.undetermined);
    };
    assert!(together.parameters.contains(&CURVATURE) && together.parameters.contains(&SUBSTRATE));
}

/// Of ten draws of noise, the 95 % intervals contain the truth in seven or more except once in ten thousand.
#[test]
fn intervals_contain_the_truth() {
    let mut covered = [0; 2];
    for seed in 0..10 {
        let data = readings(&depths(40), hertz, 2e-6, seed);
        let found = fitted(&file(&[]), &data, &[SUBSTRATE, POINT, OFFSET]);
        covered[0] += usize::from(covers(&found, SUBSTRATE, TRUE_MODULUS));
        covered[1] += usize::from(covers(&found, POINT, TRUE_POINT));
    }
    assert!(covered.iter().all(|count| *count >= 7), "{covered:?}");
}

/// Nine interacting tops below a lens, two of them in the plane of zero indentation, at the end of a machine, solved with the accurate setting.
#[test]
fn a_modulus_is_found_again_from_many_tops_with_a_machine() {
    let many = [
        "lens.shape=paraboloid",
        "lens.radius=20mm",
        "pattern.columns=3",
        "pattern.pitch=0.15mm",
        "pattern.height_standard_deviation=0.0025",
        "pattern.seed=3",
    ];
    let truth = file(&[&many[..], &["substrate.young_modulus=1.6MPa"]].concat());
    let case = truth.asperity_case().unwrap();
    let compliance = 1e-3;
    let touch = case.field.first_touch();
    assert!(touch.abs() > 1e-8, "{touch}");
    let indentations: Vec<f64> = (-6..24).map(|k| touch + 0.25e-6 * f64::from(k)).collect();
    let force = |indentation: f64| {
        let load = Load::Indentation(indentation);
        let contact = case.field.press(load, Accuracy::Accurate, &Run::default());
        contact.unwrap().force
    };
    let forces: Vec<f64> = indentations.iter().map(|depth| force(*depth)).collect();
    let positions = indentations.iter().zip(&forces);
    let positions = positions.map(|(depth, force)| depth + compliance * force + TRUE_POINT);
    let columns = [
        (Column::Displacement, positions.collect::<Vec<_>>()),
        (Column::Force, forces.clone()),
    ];
    let data = Measurements::new(&columns).unwrap();
    let found = fitted(&file(&many), &data, &[SUBSTRATE, POINT, COMPLIANCE]);
    close(value(&found, SUBSTRATE), TRUE_MODULUS, 2e-3);
    close(value(&found, COMPLIANCE), compliance, 5e-3);
    assert!((value(&found, POINT) - TRUE_POINT).abs() < 5e-9);
    // Contact radii jump from one top to the next.
    let columns = [
        (Column::ContactRadius, vec![1e-5, 2e-5, 3e-5]),
        (Column::Force, vec![1e-4, 2e-4, 3e-4]),
    ];
    let data = Measurements::new(&columns).unwrap();
    let options = FitOptions::default();
    let refused = fit(&file(&many), &data, &[SUBSTRATE], &options, &Run::default()).unwrap_err();
    assert!(matches!(refused, FitError::RadiusOfTops(_)), "{refused}");
}

/// Loading and unloading of one top of Johnson, Kendall and Roberts.
fn jkr() -> Measurements {
    let of = [reduced(TRUE_MODULUS), RADIUS, TRUE_WORK];
    let force = |branch, depth| jkr_force(of, branch, depth);
    let depths = (-12..=24).map(|k| 0.25e-6 * (f64::from(k) + 0.4));
    let loading = depths.clone().map(|depth| (Branch::Loading, depth));
    let unloading = depths.rev().skip(1).map(|depth| (Branch::Unloading, depth));
    let steps: Vec<(Branch, f64)> = loading.chain(unloading).collect();
    let columns = [
        (
            Column::Displacement,
            steps
                .iter()
                .map(|step| step.1 + TRUE_POINT)
                .collect::<Vec<_>>(),
        ),
        (
            Column::Force,
            steps.iter().map(|step| force(step.0, step.1)).collect(),
        ),
    ];
    Measurements::new(&columns).unwrap()
}

#[test]
fn the_work_of_adhesion_is_found_again() {
    let begin = file(&["adhesion.work=20mJ/m2"]);
    let found = fitted(&begin, &jkr(), &[SUBSTRATE, WORK, POINT]);
    close(value(&found, SUBSTRATE), TRUE_MODULUS, 2e-2);
    close(value(&found, WORK), TRUE_WORK, 2e-2);
    assert!((value(&found, POINT) - TRUE_POINT).abs() < 5e-8);
    let pull_off = found.pull_off.unwrap();
    // -(3/2) pi w R (K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301 (1971)).
    let exact = -1.5 * std::f64::consts::PI * value(&found, WORK) * RADIUS;
    close(pull_off.computed, exact, 1e-4);
}

#[test]
fn what_rounded_tops_do_not_have_is_refused() {
    let data = readings(&depths(20), hertz, 1e-12, 1);
    let free = |parameter: Parameter| {
        let error = fit(
            &file(&[]),
            &data,
            &[parameter],
            &FitOptions::default(),
            &Run::default(),
        );
        error.unwrap_err().to_string()
    };
    let diameter = free(Parameter::Key(Key::PillarDiameter));
    assert!(diameter.contains("pattern.pillar.diameter"), "{diameter}");
    let thickness = free(Parameter::Key(Key::SubstrateThickness));
    assert!(thickness.contains("substrate.thickness"), "{thickness}");
    // Flat tops have no radius of curvature.
    let mut flat = CaseFile::parse(
        "flat.toml",
        TOPS.replace("top_radius = \"0.5 mm\"\n", "").as_str(),
    )
    .unwrap();
    flat.set("pattern.pillar.diameter=50um").unwrap();
    let error = fit(
        &flat,
        &data,
        &[CURVATURE],
        &FitOptions::default(),
        &Run::default(),
    )
    .unwrap_err();
    assert!(matches!(error, FitError::NotGiven(CURVATURE)), "{error}");
}
