//! Fits in which most rows are interpolated, compared with fits that solve every row.

use super::*;
use chacha20::ChaCha12Rng;
use chacha20::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

const SUBSTRATE: Parameter = Parameter::Key(Key::SubstrateYoungModulus);
const INSTRUMENT: [Parameter; 3] = [
    SUBSTRATE,
    Parameter::ContactPoint,
    Parameter::MachineCompliance,
];

fn example(name: &str) -> String {
    let path = format!("{}/../../examples/fit/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).unwrap()
}

fn example_case(overrides: &[&str]) -> CaseFile {
    let mut file = CaseFile::parse("case.toml", &example("case.toml")).unwrap();
    for given in overrides {
        file.set(given).unwrap();
    }
    file
}

/// A fit with interpolation, and one that solves every row.
fn both(file: &CaseFile, data: &Measurements, free: &[Parameter]) -> [Fit; 2] {
    let pool = rayon::ThreadPoolBuilder::new().build().unwrap();
    let run = Run {
        pool: Some(&pool),
        ..Run::default()
    };
    [0, usize::MAX]
        .map(|direct| fit_with(file, data, free, &FitOptions::default(), &run, direct).unwrap())
}

/// Values within a tenth of a standard error, standard errors within 3 %, and the same verdict.
fn assert_same([fast, direct]: &[Fit; 2]) {
    assert_eq!(fast.termination, Termination::Converged);
    for (a, b) in fast.estimates.iter().zip(&direct.estimates) {
        let (a_error, b_error) = (a.standard_error.unwrap(), b.standard_error.unwrap());
        let away = (a.value - b.value).abs() / b_error;
        assert!(away < 0.1, "{:?}: {away} standard errors", a.parameter);
        assert!(
            (a_error / b_error - 1.0).abs() < 0.03,
            "{a_error} {b_error}"
        );
    }
    assert_eq!(fast.misfit.describes_data(), direct.misfit.describes_data());
    assert!(fast.solutions < direct.solutions);
}

#[test]
#[ignore = "slow: the spectral method, row by row"]
fn the_example_is_fitted_as_row_by_row() {
    let file = example_case(&["floor.contact=false"]);
    let data = Measurements::from_csv("data", example("loading.csv").as_bytes(), &[]).unwrap();
    let fits = both(&file, &data, &INSTRUMENT);
    assert_same(&fits);
    // Up to 64 rows are solved at the end, so that nothing of the result is interpolated.
    assert_eq!(fits[0].scatter[0].interpolation_error, None);
    // Tests of fixed parameters: those of the direct fit to a tenth.
    let [fast, direct] = fits.each_ref().map(|fit| &fit.misfit.left_out);
    for left in direct {
        let same = fast.iter().find(|other| other.parameter == left.parameter);
        let p_value = same.unwrap().p_value;
        assert!((p_value - left.p_value).abs() < 0.1, "{left:?} {p_value}");
    }
}

#[test]
#[ignore = "slow: rows with load on the floor, one by one"]
fn the_example_with_the_floor_is_fitted_as_row_by_row() {
    let file = example_case(&[]);
    let data = Measurements::from_csv("data", example("loading.csv").as_bytes(), &[]).unwrap();
    let fits = both(&file, &data, &INSTRUMENT);
    assert_same(&fits);
}

/// Readings of a state at every indentation, with noise of the force and, if wanted, of the contact radius.
fn synthetic(file: &CaseFile, depths: &[f64], noise: f64) -> [Vec<f64>; 3] {
    let case = file.case().unwrap();
    let mut random = ChaCha12Rng::seed_from_u64(3);
    let normal = Normal::new(0.0, noise).unwrap();
    let mut columns = [const { Vec::new() }; 3];
    for depth in depths {
        let load = fakir::problem::Load::Indentation(*depth);
        let state = fakir::press(&case.system, load, case.method, &Run::default()).unwrap();
        columns[0].push(depth + 3e-6 + 2e-3 * state.force);
        columns[1].push(state.force + normal.sample(&mut random));
        columns[2].push(state.contact_radius);
    }
    columns
}

#[test]
fn contact_radii_that_jump_are_fitted_as_row_by_row() {
    // Punch lattice: the contact radius changes by jumps alone, from one ring of pillars to the next.
    let case = |modulus: &str| {
        example_case(&[
            "method.name=punch",
            "pattern.surface_fraction=0.05",
            &format!("substrate.young_modulus={modulus}"),
        ])
    };
    let depths: Vec<f64> = (1..=90).map(|k| 0.07e-6 * f64::from(k)).collect();
    let [_, force, radius] = synthetic(&case("1.4 MPa"), &depths, 1e-8);
    let columns = [(Column::Force, force), (Column::ContactRadius, radius)];
    let data = Measurements::new(&columns).unwrap();
    let fits = both(&case("1.7 MPa"), &data, &[SUBSTRATE]);
    assert_same(&fits);
    assert!(fits[0].scatter[0].interpolation_error.is_some());
}

/// More rows than are solved at the end, with load on the floor in the last ones, and a size free: states after small steps follow from those before.
#[test]
#[ignore = "slow: rows with load on the floor, one by one"]
fn many_rows_are_fitted_as_row_by_row() {
    let free = [
        SUBSTRATE,
        Parameter::ContactPoint,
        Parameter::Key(Key::LensRadius),
    ];
    let depths: Vec<f64> = (1..=80).map(|k| 0.039e-6 * f64::from(k)).collect();
    let truth = example_case(&["substrate.young_modulus=1.4 MPa"]);
    let [_, force, _] = synthetic(&truth, &depths, 0.3e-6);
    let position = depths.iter().map(|depth| depth + 3e-6).collect();
    let columns = [(Column::Displacement, position), (Column::Force, force)];
    let data = Measurements::new(&columns).unwrap();
    let fits = both(&example_case(&[]), &data, &free);
    assert_same(&fits);
    assert!(
        fits[0]
            .rows
            .iter()
            .any(|row| row.smallest_floor_gap.is_some_and(|gap| gap <= 0.0))
    );
    let error = fits[0].scatter[0].interpolation_error.unwrap();
    assert!(error < 0.1 * fits[0].scatter[0].residual);
}

#[test]
#[ignore = "slow: ten thousand rows"]
fn ten_thousand_rows_take_few_solutions() {
    const ROWS: usize = 10_000;
    let case = |modulus: &str| {
        example_case(&[
            "floor.contact=false",
            &format!("substrate.young_modulus={modulus}"),
        ])
    };
    // A curve of 300 states, between which the true values are linear: closer than the noise.
    let depths: Vec<f64> = (1..=300).map(|k| 8.7e-9 * f64::from(k)).collect();
    let [displacement, force, _] = synthetic(&case("1.4 MPa"), &depths, 1e-12);
    let mut random = ChaCha12Rng::seed_from_u64(5);
    let noise = Normal::new(0.0, 0.5e-6).unwrap();
    let mut columns = [const { Vec::new() }; 2];
    for row in 0..ROWS {
        let place = 299.0 * row as f64 / ROWS as f64;
        let (at, part) = (place as usize, place.fract());
        let between = |values: &[f64]| values[at] + part * (values[at + 1] - values[at]);
        columns[0].push(between(&displacement));
        columns[1].push(between(&force) + noise.sample(&mut random));
    }
    let [displacement, force] = columns;
    let columns = [(Column::Displacement, displacement), (Column::Force, force)];
    let data = Measurements::new(&columns).unwrap();
    let run = Run::default();
    let options = FitOptions::default();
    let fitted = fit(&case("2 MPa"), &data, &INSTRUMENT, &options, &run).unwrap();
    assert_eq!(fitted.termination, Termination::Converged);
    for (estimate, truth) in fitted.estimates.iter().zip([1.4e6, 3e-6, 2e-3]) {
        let away = (estimate.value - truth).abs() / estimate.standard_error.unwrap();
        assert!(away < 4.0, "{estimate:?}");
    }
    assert!(fitted.solutions < 600, "{}", fitted.solutions);
    let scatter = fitted.scatter[0];
    let error = scatter.interpolation_error.unwrap();
    assert!(error < 0.1 * scatter.residual, "{scatter:?}");
}

#[test]
fn rows_of_a_cycle_are_not_interpolated() {
    let mut file = CaseFile::parse("case.toml", &example("retraction.toml")).unwrap();
    file.set("adhesion.work=35 mJ/m2").unwrap();
    let text = example("retraction.csv");
    let data = Measurements::from_csv("data", text.as_bytes(), &[]).unwrap();
    let options = FitOptions {
        contact_point: Some(3e-6),
        ..FitOptions::default()
    };
    let run = Run::default();
    let model = Model::new(&file, &data, &[SUBSTRATE], &options, &run).unwrap();
    assert!(data.rows().len() > sampled::DIRECT && !Sampled::suits(&model, sampled::DIRECT));
}
