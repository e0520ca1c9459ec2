//! Fits of loading and unloading with adhesion to synthetic data with known parameters.

use chacha20::ChaCha12Rng;
use chacha20::rand_core::SeedableRng;
use fakir::problem::{CyclePlan, LoadingMode, UnloadingPoint};
use fakir::state::{Branch, Cycle, Run, Termination};
use fakir_case::{Case, CaseFile, Key};
use fakir_inverse::fit::{Column, Fit, FitOptions, Measurements, Parameter, fit};
use rand_distr::{Distribution, Normal};

const SUBSTRATE: Parameter = Parameter::Key(Key::SubstrateYoungModulus);
const WORK: Parameter = Parameter::Key(Key::WorkOfAdhesion);
const RECEDING: Parameter = Parameter::Key(Key::RecedingWorkOfAdhesion);

/// Parameters of the synthetic data.
const CONTACT_POINT: f64 = 3e-6;
const COMPLIANCE: f64 = 2e-3;
const OFFSET: f64 = 4e-6;
const NOISE: f64 = 0.5e-6;

/// The paper's intermediate substrate at a surface fraction of 0.03, with adhesion of 30 mJ/m^2 unless overridden.
fn case_file(overrides: &[&str]) -> CaseFile {
    let mut file = CaseFile::parse("case.toml", &Case::example().to_toml()).unwrap();
    file.set("pattern.surface_fraction=0.03").unwrap();
    file.set("adhesion.work=30mJ/m2").unwrap();
    for argument in overrides {
        file.set(argument).unwrap();
    }
    file
}

fn cycle(file: &CaseFile, drive: LoadingMode) -> Cycle {
    let case = file.case().unwrap();
    let plan = CyclePlan {
        turn: UnloadingPoint::Indentation(3.5e-6),
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
            let part = if p[1][0] > p[0][0] {
                (at - p[0][0]) / (p[1][0] - p[0][0])
            } else {
                0.0
            };
            p[0][1] + part * (p[1][1] - p[0][1])
        })
    };
    let (loading, mut unloading) = (places(Branch::Loading), places(Branch::Unloading));
    let turn = *loading.last().unwrap();
    unloading.push(turn);
    let steps = ((turn[0] + 1.5e-6) / step) as i32;
    let at = |k: i32| turn[0] - step * f64::from(k);
    let down = (0..=steps)
        .rev()
        .map(|k| (Branch::Loading, at(k), force(&loading, at(k))));
    let up = (1..=steps).map(|k| (Branch::Unloading, at(k), force(&unloading, at(k))));
    down.chain(up).collect()
}

fn noisy(readings: &[(Branch, f64, f64)], seed: u64, noise: f64) -> Vec<(Column, Vec<f64>)> {
    let mut random = ChaCha12Rng::seed_from_u64(seed);
    let noise = Normal::new(0.0, noise).unwrap();
    let forces = readings
        .iter()
        .map(|r| r.2 + OFFSET + noise.sample(&mut random));
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
const FREE: [Parameter; 4] = [
    WORK,
    SUBSTRATE,
    Parameter::ContactPoint,
    Parameter::ForceOffset,
];
const TRUTHS: [f64; 4] = [0.03, 2e6, CONTACT_POINT, OFFSET];

/// Number of intervals that contain the true value, and the fitted works of adhesion.
fn draws(offset: &str, step: f64, noise: f64, compliance: f64, count: u64) -> ([u64; 4], Vec<f64>) {
    let drive = match compliance > 0.0 {
        true => LoadingMode::Machine(1.0 / compliance),
        false => LoadingMode::Displacement,
    };
    let exact = readings(&cycle(&case_file(&[offset]), drive), compliance, step);
    let (mut inside, mut works) = ([0; 4], Vec::new());
    for seed in 0..count {
        let data = Measurements::new(&noisy(&exact, seed, noise)).unwrap();
        // Without a value for the work, and with a wrong modulus.
        let first = case_file(&[offset, "adhesion.work=0", "substrate.young_modulus=1.5MPa"]);
        let fitted = run_fit(&first, &data, &FREE, compliance);
        assert_eq!(
            fitted.termination,
            Termination::Converged,
            "{offset}, seed {seed}"
        );
        assert!(fitted.converged() && fitted.undetermined.is_empty());
        for (k, (estimate, truth)) in fitted.estimates.iter().zip(TRUTHS).enumerate() {
            let [low, high] = estimate.interval.unwrap();
            inside[k] += u64::from(low < truth && truth < high);
        }
        let error = fitted.scatter[0].estimated.unwrap();
        assert!(close(error, noise, 0.4), "{error:e}");
        works.push(fitted.estimates[0].value);
    }
    (inside, works)
}

fn close(value: f64, truth: f64, tolerance: f64) -> bool {
    (value / truth - 1.0).abs() < tolerance
}

/// Beside a pillar jumps are small; on one they are as large as they get, and by a soft machine larger still.
#[test]
#[ignore = "slow: fits of many cycles"]
fn intervals_contain_the_true_value_in_most_draws() {
    for (offset, compliance, count) in [
        ("pattern.offset=0.3", 0.0, 4),
        ("pattern.offset=0", COMPLIANCE, 3),
    ] {
        let (inside, works) = draws(offset, 0.1e-6, NOISE, compliance, count);
        eprintln!("{offset}, {compliance}: inside {inside:?} of {count}");
        assert!(
            inside.iter().all(|inside| *inside + 1 >= count),
            "{offset}: {inside:?}"
        );
        assert!(
            works.iter().all(|work| close(*work, 0.03, 0.08)),
            "{works:?}"
        );
    }
}

/// A short cycle on few pillars, without noise.
fn small_data(overrides: &[&str], step: f64) -> Vec<(Column, Vec<f64>)> {
    let file = case_file(
        &[
            &["pattern.surface_fraction=0.01", "pattern.offset=0.3"],
            overrides,
        ]
        .concat(),
    );
    let case = file.case().unwrap();
    let plan = CyclePlan {
        turn: UnloadingPoint::Indentation(2.4e-6),
        ..CyclePlan::default()
    };
    let cycle = fakir::cycle(&case.system, plan, case.method, &Run::default()).unwrap();
    noisy(&readings(&cycle, 0.0, step), 1, 1e-9)
}

#[test]
fn a_receding_work_is_determined_from_data_of_both_branches() {
    let data = Measurements::new(&small_data(&["adhesion.work_receding=80mJ/m2"], 0.1e-6)).unwrap();
    let first = case_file(&["pattern.surface_fraction=0.01", "pattern.offset=0.3"]);
    let options = FitOptions {
        contact_point: Some(CONTACT_POINT),
        force_offset: OFFSET,
        ..FitOptions::default()
    };
    let fitted = fit(&first, &data, &[RECEDING], &options, &Run::default()).unwrap();
    assert!(
        close(fitted.estimates[0].value, 0.08, 0.08),
        "{:?}",
        fitted.estimates
    );
    let pull_off = fitted.pull_off.unwrap();
    // The smallest of readings 0.1 um apart is not the minimum of the curve.
    assert!(
        close(pull_off.computed, pull_off.measured, 0.2),
        "{pull_off:?}"
    );
    assert!(pull_off.model_error > 0.0 && pull_off.work_error.is_some_and(|error| error > 0.0));
}

/// Both branches without adhesion, with noise: the work of adhesion found is zero or nearly so.
#[test]
fn a_work_of_adhesion_that_vanishes_has_a_one_sided_interval() {
    let file = case_file(&[
        "pattern.surface_fraction=0.01",
        "pattern.offset=0.3",
        "adhesion.work=0",
    ]);
    let case = file.case().unwrap();
    let force = |depth: f64| {
        if depth <= 0.0 {
            return 0.0;
        }
        let load = fakir::problem::Load::Indentation(depth);
        let state = fakir::press(&case.system, load, case.method, &Run::default());
        state.unwrap().force
    };
    let down: Vec<[f64; 2]> = (-5..=20)
        .map(|k| 0.1e-6 * f64::from(k))
        .map(|depth| [depth, force(depth)])
        .collect();
    let unloading = down.iter().rev().skip(1);
    let unloading = unloading.map(|[depth, force]| (Branch::Unloading, *depth, *force));
    let loading = down
        .iter()
        .map(|[depth, force]| (Branch::Loading, *depth, *force));
    let both: Vec<_> = loading.chain(unloading).collect();
    for seed in 0..3 {
        let data = Measurements::new(&noisy(&both, seed, NOISE)).unwrap();
        let options = FitOptions {
            contact_point: Some(CONTACT_POINT),
            force_offset: OFFSET,
            ..FitOptions::default()
        };
        let fitted = fit(&file, &data, &[WORK], &options, &Run::default()).unwrap();
        assert!(fitted.converged(), "{:?}", fitted.warnings());
        let work = &fitted.estimates[0];
        assert!(work.one_sided, "{work:?}");
        let [least, most] = work.interval.unwrap();
        assert!(
            least == 0.0 && work.value <= most && most < 5e-3,
            "{work:?}"
        );
    }
}

/// The receding work is not smaller than the other: if the search starts with equal works, it moves them together as long as the data require
/// a smaller one.
#[test]
fn both_works_of_adhesion_are_fitted_from_one_guess() {
    let data = Measurements::new(&small_data(&["adhesion.work_receding=60mJ/m2"], 0.1e-6)).unwrap();
    let options = FitOptions {
        contact_point: Some(CONTACT_POINT),
        force_offset: OFFSET,
        ..FitOptions::default()
    };
    let guess = [
        "pattern.surface_fraction=0.01",
        "pattern.offset=0.3",
        "adhesion.work=80mJ/m2",
    ];
    let fitted = fit(
        &case_file(&guess),
        &data,
        &[WORK, RECEDING],
        &options,
        &Run::default(),
    )
    .unwrap();
    assert!(fitted.converged(), "{:?}", fitted.warnings());
    let [work, receding] = &fitted.estimates[..] else {
        panic!("{:?}", fitted.estimates);
    };
    assert!(close(receding.value, 0.06, 0.1), "{receding:?}");
    assert!(work.value <= receding.value, "{work:?}");
}

/// A force offset is not interpreted as adhesion.
#[test]
fn an_offset_of_the_force_is_found() {
    let file = case_file(&[
        "pattern.surface_fraction=0.01",
        "adhesion.work=0",
        "method.name=homogenised",
    ]);
    let case = file.case().unwrap();
    let depths: Vec<f64> = (0..12).map(|k| 0.2e-6 * f64::from(k) - 0.4e-6).collect();
    let forces = depths.iter().map(|depth| {
        let load = fakir::problem::Load::Indentation(depth.max(1e-12));
        let state = fakir::press(&case.system, load, case.method, &Run::default());
        OFFSET
            + if *depth > 0.0 {
                state.unwrap().force
            } else {
                0.0
            }
    });
    let columns = [
        (Column::Force, forces.collect()),
        (Column::Indentation, depths.clone()),
    ];
    let data = Measurements::new(&columns).unwrap();
    let mut first = file.clone();
    first.set("substrate.young_modulus=1.5MPa").unwrap();
    let fitted = run_fit(&first, &data, &[SUBSTRATE, Parameter::ForceOffset], 0.0);
    for (estimate, truth) in fitted.estimates.iter().zip([2e6, OFFSET]) {
        assert!(close(estimate.value, truth, 1e-6), "{estimate:?}");
    }
    assert!(fitted.cycle.is_none() && fitted.pull_off.is_none());
}

#[test]
fn insufficient_data_of_adhesion_are_reported() {
    let refusal = |columns: &[(Column, Vec<f64>)], work: &str, free: &[Parameter]| {
        let data = Measurements::new(columns).unwrap();
        let file = case_file(&["pattern.surface_fraction=0.01", work]);
        fit(&file, &data, free, &FitOptions::default(), &Run::default())
            .unwrap_err()
            .to_string()
    };
    let work = "adhesion.work=0";
    let up = vec![0.5e-6, 1e-6, 1.5e-6, 2e-6];
    let loading = [
        (Column::Indentation, up.clone()),
        (Column::Force, vec![1e-6, 2e-6, 4e-6, 8e-6]),
    ];
    let message = refusal(&loading, work, &[WORK]);
    assert!(
        message.contains("adhesion.work takes rows of the unloading"),
        "{message}"
    );
    let down = [
        (Column::Indentation, vec![0.5e-6, 2e-6, 1e-6, 0.5e-6]),
        (Column::Force, vec![1e-6, 8e-6, 3e-6, 1e-6]),
    ];
    let message = refusal(&down, work, &[WORK]);
    assert!(
        message.contains("give adhesion.work in the case"),
        "{message}"
    );
    let radii = [
        (Column::Indentation, up.clone()),
        (Column::ContactRadius, up.clone()),
    ];
    let message = refusal(&radii, work, &[Parameter::ForceOffset]);
    assert!(
        message.contains("force_offset takes a column force_N"),
        "{message}"
    );
    let mut partly = loading.to_vec();
    partly.push((Column::Branch, vec![0.0, 0.0, f64::NAN, 1.0]));
    let message = refusal(&partly, work, &[WORK]);
    assert!(message.contains("branch: no branch here"), "{message}");
    let odd = "branch,indentation_m,force_N\nup,1e-6,1e-6\n";
    let message = Measurements::from_csv("data.csv", odd.as_bytes(), &[])
        .unwrap_err()
        .to_string();
    assert_eq!(
        message,
        "data.csv:2: branch: \"up\" is no branch: give loading or unloading"
    );
    let odd = Measurements::new(&[
        (Column::Force, vec![1.0]),
        (Column::Indentation, vec![1.0]),
        (Column::Branch, vec![0.5]),
    ]);
    assert!(
        odd.unwrap_err()
            .to_string()
            .contains("0 for loading or 1 for unloading")
    );
}

/// The branches are those of the column; otherwise unloading begins after the largest load.
#[test]
fn branches_are_given_or_found() {
    let found = |branch: &str| -> Vec<Option<Branch>> {
        let rows = [("loading", 1), ("loading", 2), ("unloading", 1)];
        let text: String = rows
            .iter()
            .map(|(name, depth)| match branch {
                "" => format!("{depth}e-6,{depth}e-6\n"),
                _ => format!("{depth}e-6,{depth}e-6,{name}\n"),
            })
            .collect();
        let text = format!("indentation_m,force_N{branch}\n{text}");
        let data = Measurements::from_csv("data", text.as_bytes(), &[])
            .unwrap()
            .with_force_error(1e-7);
        let file = case_file(&["pattern.surface_fraction=0.01"]);
        let fitted = run_fit(&file, &data, &[SUBSTRATE], 0.0);
        fitted.rows.iter().map(|row| row.branch).collect()
    };
    let branches = [Branch::Loading, Branch::Loading, Branch::Unloading].map(Some);
    assert_eq!(found(",branch"), branches);
    assert_eq!(found(""), branches);
}
