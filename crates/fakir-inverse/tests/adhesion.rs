//! Fits of loading and unloading with adhesion, of synthetic data whose truth is known.

#![allow(clippy::unwrap_used)]

use fakir::problem::{CyclePlan, Drive, Turn};
use fakir::state::{Branch, Cycle, Run, Termination};
use fakir_case::{Case, CaseFile, Key};
use fakir_inverse::fit::{Column, Fit, FitOptions, Measurements, Parameter, fit};
use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

const SUBSTRATE: Parameter = Parameter::Key(Key::SubstrateYoungModulus);
const WORK: Parameter = Parameter::Key(Key::WorkOfAdhesion);
const RECEDING: Parameter = Parameter::Key(Key::RecedingWorkOfAdhesion);

/// What the synthetic data have.
const CONTACT_POINT: f64 = 3e-6;
const COMPLIANCE: f64 = 2e-3;
const OFFSET: f64 = 4e-6;
const NOISE: f64 = 0.5e-6;

/// The paper's intermediate substrate at a surface fraction of 0.03, with adhesion of 30 mJ/m^2 unless overridden.
fn case_file(overrides: &[&str]) -> CaseFile {
    let mut file = CaseFile::parse("case.toml", &Case::example().to_toml()).unwrap();
    file.set("texture.surface_fraction=0.03").unwrap();
    file.set("adhesion.work=30mJ/m2").unwrap();
    for argument in overrides {
        file.set(argument).unwrap();
    }
    file
}

fn cycle(file: &CaseFile, drive: Drive) -> Cycle {
    let case = file.case().unwrap();
    let plan = CyclePlan {
        turn: Turn::Indentation(3.5e-6),
        drive,
        retract: true,
    };
    fakir::cycle(&case.system, plan, case.method, &Run::default()).unwrap()
}

/// Crosshead and force of a cycle at steps of this length, up and down, to 1.5 um above the tops. The curve between stations is
/// straight; it is drawn again here, not taken from the fit.
fn readings(cycle: &Cycle, compliance: f64, step: f64) -> Vec<(Branch, f64, f64)> {
    let places = |branch: Branch| {
        let stations = cycle.stations.iter().filter(|s| s.branch == branch);
        let mut places: Vec<[f64; 2]> = stations
            .map(|s| [s.indentation + compliance * s.force, s.force])
            .collect();
        if branch == Branch::Unloading {
            places.reverse();
        }
        places
    };
    let force = |places: &[[f64; 2]], at: f64| {
        let pair = places.windows(2).find(|p| p[0][0] <= at && at <= p[1][0]);
        pair.map_or(0.0, |p| {
            let part = if p[1][0] > p[0][0] { (at - p[0][0]) / (p[1][0] - p[0][0]) } else { 0.0 };
            p[0][1] + part * (p[1][1] - p[0][1])
        })
    };
    let (loading, mut unloading) = (places(Branch::Loading), places(Branch::Unloading));
    let turn = *loading.last().unwrap();
    unloading.push(turn);
    let steps = ((turn[0] + 1.5e-6) / step) as i32;
    let at = |k: i32| turn[0] - step * f64::from(k);
    let down = (0..=steps).rev().map(|k| (Branch::Loading, at(k), force(&loading, at(k))));
    let up = (1..=steps).map(|k| (Branch::Unloading, at(k), force(&unloading, at(k))));
    down.chain(up).collect()
}

fn noisy(readings: &[(Branch, f64, f64)], seed: u64, noise: f64) -> Vec<(Column, Vec<f64>)> {
    let mut random = ChaCha12Rng::seed_from_u64(seed);
    let noise = Normal::new(0.0, noise).unwrap();
    let forces = readings.iter().map(|r| r.2 + OFFSET + noise.sample(&mut random));
    vec![
        (
            Column::Displacement,
            readings.iter().map(|r| r.1 + CONTACT_POINT).collect(),
        ),
        (Column::Force, forces.collect()),
    ]
}

fn run_fit(file: &CaseFile, data: &Measurements, free: &[Parameter], compliance: f64) -> Fit {
    let options = FitOptions {
        machine_compliance: compliance,
        ..FitOptions::default()
    };
    fit(file, data, free, &options, &Run::default()).unwrap()
}

/// What is fitted, and what the data have of it.
const FREE: [Parameter; 4] = [WORK, SUBSTRATE, Parameter::ContactPoint, Parameter::ForceOffset];
const TRUTHS: [f64; 4] = [0.03, 2e6, CONTACT_POINT, OFFSET];

/// How often the intervals hold the truth, and the works of adhesion that were found.
fn draws(offset: &str, step: f64, noise: f64, compliance: f64, count: u64) -> ([u64; 4], Vec<f64>) {
    let drive = match compliance > 0.0 {
        true => Drive::Machine(1.0 / compliance),
        false => Drive::Displacement,
    };
    let exact = readings(&cycle(&case_file(&[offset]), drive), compliance, step);
    let (mut inside, mut works) = ([0; 4], Vec::new());
    for seed in 0..count {
        let data = Measurements::new(&noisy(&exact, seed, noise)).unwrap();
        // Nothing is said of the work, and the modulus is wrong.
        let first = case_file(&[offset, "adhesion.work=0", "substrate.young_modulus=1.5MPa"]);
        let fitted = run_fit(&first, &data, &FREE, compliance);
        assert_eq!(fitted.termination, Termination::Converged, "{offset}, seed {seed}");
        assert!(fitted.converged() && fitted.undetermined.is_empty());
        for (k, (estimate, truth)) in fitted.estimates.iter().zip(TRUTHS).enumerate() {
            let [low, high] = estimate.interval.unwrap();
            inside[k] += u64::from(low < truth && truth < high);
        }
        let error = fitted.scatter[0].estimated.unwrap();
        assert!(close(error, noise, 0.4), "{error:e}");
        works.push(fitted.estimates[0].value);
        eprintln!(
            "{offset} {compliance}: {} {} {:?} {:?}",
            fitted.iterations,
            error,
            fitted.estimates.iter().zip(TRUTHS).map(|(e, t)| e.value / t).collect::<Vec<_>>(),
            fitted.estimates.iter().zip(TRUTHS).map(|(e, t)| e.standard_error.unwrap() / t).collect::<Vec<_>>()
        );
    }
    (inside, works)
}

fn close(value: f64, truth: f64, tolerance: f64) -> bool {
    (value / truth - 1.0).abs() < tolerance
}

/// Beside a pillar jumps are small; on one they are as large as they get; a soft machine has other jumps.
#[test]
fn intervals_hold_the_truth_in_most_draws() {
    const DRAWS: u64 = 4;
    for (offset, step, noise, compliance) in [
        ("texture.offset=0.3", 0.1e-6, NOISE, 0.0),
        ("texture.offset=0", 0.1e-6, NOISE, 0.0),
        ("texture.offset=0", 0.04e-6, 0.2e-6, 0.0),
        ("texture.offset=0", 0.1e-6, NOISE, COMPLIANCE),
    ] {
        let (inside, works) = draws(offset, step, noise, compliance, DRAWS);
        eprintln!("{offset}, {compliance}: inside {inside:?} of {DRAWS}");
        assert!(inside.iter().all(|inside| *inside + 1 >= DRAWS), "{offset}: {inside:?}");
        assert!(works.iter().all(|work| close(*work, 0.03, 0.08)), "{works:?}");
    }
}
