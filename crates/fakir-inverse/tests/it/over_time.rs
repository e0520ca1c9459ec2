//! Fits of data over time on viscoelastic bodies, to data from closed forms and from histories with known parameters.

use crate::flat::{close, covers, fitted, value};
use chacha20::ChaCha12Rng;
use chacha20::rand_core::SeedableRng;
use fakir::problem::{Load, Prescribed, Protocol, ProtocolSegment, Relaxation};
use fakir::state::Run;
use fakir_case::{CaseFile, Key};
use fakir_inverse::fit::{Column, Fit, FitError, FitOptions, Measurements, Parameter, fit};
use fakir_study::history::{HistoryCourse, HistoryPlan, follow};
use rand_distr::{Distribution, Normal};

const MODULUS: Parameter = Parameter::Key(Key::SubstrateYoungModulus);
const STRENGTH: Parameter = Parameter::RelaxationStrength(0);
const TIME: Parameter = Parameter::RelaxationTime(0);
const POINT: Parameter = Parameter::ContactPoint;

/// A glass sphere on a viscoelastic half-space; the values are where fits begin.
const FLAT: &str = "[lens]\nshape = \"paraboloid\"\nradius = \"2 mm\"\nyoung_modulus = \"70 GPa\"\npoisson_ratio = 0.2\n\
                    [substrate]\nyoung_modulus = \"1 MPa\"\npoisson_ratio = 0.5\n\
                    [relaxation]\nstrengths = [0.5]\ntimes = [\"30 s\"]\n";

const RADIUS: f64 = 2e-3;
const TRUE_MODULUS: f64 = 1.6e6;
const TRUE_STRENGTH: f64 = 0.8;
const TRUE_TIME: f64 = 12.0;
const TRUE_POINT: f64 = 1.5e-6;

fn file() -> CaseFile {
    CaseFile::parse("flat.toml", FLAT).unwrap()
}

/// `F = 4/3 E*_inf sqrt(R) ∫ E(t - s)/E_inf d(zeta^(3/2))` after E. H. Lee and J. R. M. Radok, J. Appl. Mech. 27, 438 (1960), for `zeta = v t` up to
/// `ramp` and constant after it, by Simpson's rule in the square root of time.
fn lee_radok(time: f64, speed: f64, ramp: f64) -> f64 {
    const PARTS: usize = 400;
    let end = time.min(ramp).max(0.0).sqrt();
    let step = end / PARTS as f64;
    let relaxed = |age: f64| 1.0 + TRUE_STRENGTH * (-age / TRUE_TIME).exp();
    // d(zeta^(3/2)) = 3/2 v^(3/2) sqrt(s) ds, with s = u^2.
    let of = |u: f64| relaxed(time - u * u) * 3.0 * speed.powf(1.5) * u * u;
    let inner: f64 = (1..PARTS)
        .map(|k| if k % 2 == 1 { 4.0 } else { 2.0 } * of(step * k as f64))
        .sum();
    4.0 / 3.0 * reduced() * RADIUS.sqrt() * step / 3.0 * (of(0.0) + inner + of(end))
}

/// `E*` of the substrate and the sphere, relaxed.
fn reduced() -> f64 {
    ((1.0 - 0.25) / TRUE_MODULUS + (1.0 - 0.04) / 70e9).recip()
}

const SPEED: f64 = 1e-6;
const RAMP: f64 = 6.0;

/// A ramp and a hold: time, displacement and force. The lens touches the surface in the third row.
fn readings() -> [Vec<f64>; 3] {
    let times: Vec<f64> = (0..80).map(|k| 0.5 * f64::from(k)).collect();
    let depth = |time: &f64| SPEED * (time - TRUE_POINT / SPEED).min(RAMP);
    let displacements = times.iter().map(|time| depth(time) + TRUE_POINT).collect();
    let forces = times
        .iter()
        .map(|time| lee_radok(time - TRUE_POINT / SPEED, SPEED, RAMP));
    let forces = forces.collect();
    [times, displacements, forces]
}

/// The readings with normal noise of force and displacement.
fn noisy(
    [times, displacements, forces]: &[Vec<f64>; 3],
    seed: u64,
    noise: [f64; 2],
) -> Measurements {
    let mut random = ChaCha12Rng::seed_from_u64(seed);
    let mut with = |values: &[f64], noise: f64| -> Vec<f64> {
        let normal = Normal::new(0.0, noise).unwrap();
        values
            .iter()
            .map(|value| value + normal.sample(&mut random))
            .collect()
    };
    let columns = [
        (Column::Time, times.clone()),
        (Column::Displacement, with(displacements, noise[1])),
        (Column::Force, with(forces, noise[0])),
    ];
    Measurements::new(&columns).unwrap()
}

/// How many of the fits have each parameter in its 95 % interval.
fn covered(fits: &[Fit], truths: &[(Parameter, f64)]) -> Vec<usize> {
    let count = |(parameter, truth): &(Parameter, f64)| {
        let fits = fits.iter();
        fits.filter(|found| covers(found, *parameter, *truth))
            .count()
    };
    truths.iter().map(count).collect()
}

const TRUTHS: [(Parameter, f64); 4] = [
    (MODULUS, TRUE_MODULUS),
    (STRENGTH, TRUE_STRENGTH),
    (TIME, TRUE_TIME),
    (POINT, TRUE_POINT),
];

/// Expected: Lee and Radok's sphere, from which the data are. One elastic curve serves the whole fit.
#[test]
fn a_sphere_on_loading_and_relaxing() {
    let data = noisy(&readings(), 0, [1e-12, 1e-15]);
    let free = TRUTHS.map(|(parameter, _)| parameter);
    let found = fitted(&file(), &data, &free);
    assert!(found.is_viscoelastic);
    for (parameter, truth) in TRUTHS {
        close(value(&found, parameter), truth, 2e-4);
    }
    assert!(found.solutions < 40, "{}", found.solutions);
    let relaxation = found.file.relaxation().unwrap().unwrap().relaxation;
    close(relaxation.instantaneous(), 1.0 + TRUE_STRENGTH, 2e-4);
    assert!(found.rows.iter().all(|row| row.used));
}

/// The 95 % intervals cover the true values in at least 90 of 100 draws, with noise of force and displacement.
#[test]
fn intervals_cover_the_truth() {
    let exact = readings();
    let largest = exact[2].iter().copied().fold(0.0, f64::max);
    let free = TRUTHS.map(|(parameter, _)| parameter);
    let fits: Vec<Fit> = (0..100)
        .map(|seed| {
            fitted(
                &file(),
                &noisy(&exact, seed, [0.005 * largest, 5e-9]),
                &free,
            )
        })
        .collect();
    for (count, (parameter, _)) in covered(&fits, &TRUTHS).into_iter().zip(TRUTHS) {
        assert!(count >= 90, "{} {count}", parameter.name());
    }
    let bad = fits
        .iter()
        .filter(|fit| !fit.misfit.describes_data())
        .count();
    assert!(bad <= 5, "{bad}");
}

/// Expected: under a force that is held from the first row on, `zeta^(3/2) = 3/4 F J(t)/(E*_inf sqrt(R))` with the creep function of the standard linear
/// solid, `J = 1 - g/(1 + g) exp(-t/((1 + g) tau))`.
#[test]
fn creep_of_a_hold() {
    const FORCE: f64 = 1e-3;
    let times: Vec<f64> = (0..60).map(|k| 1.0 * f64::from(k)).collect();
    let creep = |time: &f64| {
        let part = TRUE_STRENGTH / (1.0 + TRUE_STRENGTH);
        1.0 - part * (-time / ((1.0 + TRUE_STRENGTH) * TRUE_TIME)).exp()
    };
    let depth =
        |time: &f64| (0.75 * FORCE * creep(time) / (reduced() * RADIUS.sqrt())).powf(2.0 / 3.0);
    let displacements: Vec<f64> = times.iter().map(depth).collect();
    let exact = [times, displacements, vec![FORCE; 60]];
    let free = [MODULUS, STRENGTH, TIME];
    let found = fitted(&file(), &noisy(&exact, 3, [1e-7 * FORCE, 1e-15]), &free);
    // Between the rows the displacement is taken to be linear in time, here 1/20 of the creep time apart.
    for (parameter, truth) in &TRUTHS[..3] {
        close(value(&found, *parameter), *truth, 2e-3);
    }
}

/// Data of a glass lens on pillars with floor: loading past the transition, a hold, and unloading. Expected: the history from which they are. One
/// elastic curve, of at most 160 contacts, serves the fit.
#[test]
fn pillars_with_floor_and_unloading() {
    let mut truth = CaseFile::parse("case", &fakir_case::Case::example().to_toml()).unwrap();
    for given in [
        "pattern.surface_fraction=0.03",
        "lens.young_modulus=70 GPa",
        "relaxation.strengths=[1.0]",
        "relaxation.times=20 s",
    ] {
        truth.set(given).unwrap();
    }
    let case = truth.case().unwrap();
    let run = Run::default();
    let critical = fakir::press(&case.system, Load::FloorContact, case.method, &run).unwrap();
    let top = 1.2 * critical.indentation;
    let segment = |to: f64, duration: f64| ProtocolSegment {
        prescribed: Prescribed::Indentation,
        to: to * top,
        duration,
    };
    let segments = vec![segment(1.0, 10.0), segment(1.0, 30.0), segment(0.4, 10.0)];
    let plan = HistoryPlan {
        relaxation: Relaxation::new(&[1.0], &[20.0]).unwrap(),
        course: HistoryCourse::Protocol(Protocol::new(segments).unwrap()),
    };
    let history = follow(&case, &plan, &run, &|_| {}).unwrap().history;
    let every = history.states.len().div_ceil(60);
    // Among them the ends of the segments.
    let is_end = |time: f64| {
        [10.0, 40.0, 50.0]
            .iter()
            .any(|end| (time - end).abs() < 1e-9)
    };
    let states = history.states.iter().enumerate();
    let states: Vec<_> = states
        .filter(|(number, state)| number % every == 0 || is_end(state.time))
        .map(|(_, state)| state)
        .collect();
    let columns = [
        (Column::Time, states.iter().map(|it| it.time).collect()),
        (
            Column::Indentation,
            states.iter().map(|it| it.indentation).collect(),
        ),
        (
            Column::Force,
            states.iter().map(|it| it.force).collect::<Vec<f64>>(),
        ),
    ];
    let data = Measurements::new(&columns).unwrap();
    let mut file = truth.clone();
    let young_modulus = case.number(Key::SubstrateYoungModulus).unwrap();
    file.set_number(Key::SubstrateYoungModulus, 1.5 * young_modulus);
    file.set("relaxation.strengths=[0.6]").unwrap();
    file.set("relaxation.times=40 s").unwrap();
    let found = fitted(&file, &data, &[MODULUS, STRENGTH, TIME]);
    close(value(&found, MODULUS), young_modulus, 3e-3);
    close(value(&found, STRENGTH), 1.0, 1e-2);
    close(value(&found, TIME), 20.0, 2e-2);
    assert!(found.solutions < 170, "{}", found.solutions);
}

/// What cannot be fitted is refused with the reason.
#[test]
fn refusals() {
    let [times, displacements, forces] = readings();
    let without = Measurements::new(&[
        (Column::Displacement, displacements.clone()),
        (Column::Force, forces.clone()),
    ])
    .unwrap();
    let run = Run::default();
    let options = FitOptions::default();
    let error = |file: &CaseFile, data: &Measurements, free: &[Parameter]| {
        fit(file, data, free, &options, &run).unwrap_err()
    };
    let refused = error(&file(), &without, &[TIME]);
    assert!(matches!(refused, FitError::NoTimes { .. }), "{refused}");
    assert!(
        refused
            .to_string()
            .contains("relaxation.times[0] takes a column time_s")
    );
    // Without times the bodies are relaxed, and this is said.
    let relaxed = fitted(&file(), &without, &[MODULUS]);
    assert!(
        relaxed
            .warnings()
            .iter()
            .any(|it| it.contains("relaxation has no effect"))
    );
    let mut backwards = times.clone();
    backwards.swap(4, 5);
    let backwards = Measurements::new(&[
        (Column::Time, backwards),
        (Column::Displacement, displacements.clone()),
        (Column::Force, forces.clone()),
    ])
    .unwrap();
    let refused = error(&file(), &backwards, &[MODULUS]);
    assert!(
        refused.to_string().contains("the time is smaller"),
        "{refused}"
    );
    let data = noisy(&readings(), 0, [1e-12, 1e-15]);
    let refused = error(&file(), &data, &[Parameter::RelaxationTime(1)]);
    assert!(matches!(refused, FitError::NotGiven(_)), "{refused}");
    let mut sticky = file();
    sticky.set("adhesion.work=50 mJ/m^2").unwrap();
    let refused = error(&sticky, &data, &[MODULUS]);
    assert!(refused.to_string().contains("dissipate"), "{refused}");
}

/// The terms of a table begin at its series: a table of `1 + 0.8 exp(-t/12 s)` whose modulus was measured 30 % too low in its relaxing part, and data
/// of the true function. Expected: with the strengths free, the true function.
#[test]
fn terms_of_a_table_can_be_free() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let path = folder.join("fit_over_time_moduli.csv");
    let rows = (0..60).map(|k| {
        let time = 0.5 * 10f64.powf(0.04 * f64::from(k));
        let part = 0.7 * TRUE_STRENGTH * (-time / TRUE_TIME).exp();
        format!("{time},{}\n", TRUE_MODULUS * (1.0 + part))
    });
    let table: String = rows.collect();
    std::fs::write(&path, format!("time_s,modulus_Pa\n{table}")).unwrap();
    let mut file =
        CaseFile::parse("flat.toml", FLAT.split("[relaxation]").next().unwrap()).unwrap();
    let path = path.display();
    file.set(&format!("relaxation.table={path}")).unwrap();
    let before = file.relaxation().unwrap().unwrap().relaxation;
    let data = noisy(&readings(), 0, [1e-9, 1e-12]);
    let all = [0, 1, 2, 3].map(Parameter::RelaxationStrength);
    let number = before.terms().len();
    assert!((1..=4).contains(&number), "{number}");
    let free: Vec<Parameter> = [MODULUS, POINT]
        .into_iter()
        .chain(all[..number].iter().copied())
        .collect();
    let found = fitted(&file, &data, &free);
    let after = found.file.relaxation().unwrap().unwrap();
    // Times of the series are fixed, at a quarter of a decade.
    assert!(after.fitted.is_none() && after.relaxation.terms().len() == number);
    for time in [0.0, 3.0, 12.0, 30.0] {
        let truth = 1.0 + TRUE_STRENGTH * (-time / TRUE_TIME).exp();
        close(after.relaxation.at(time), truth, 0.02);
        assert!((before.at(time) / truth - 1.0).abs() > 0.02 || time > 20.0);
    }
    // A term that the series does not have is not given.
    let options = FitOptions::default();
    let beyond = [MODULUS, Parameter::RelaxationStrength(number.min(3))];
    let refused = fit(&file, &data, &beyond, &options, &Run::default());
    assert!(number == 4 || matches!(refused, Err(FitError::NotGiven(_))));
}

/// Elastic fits warn of data that depend on the rate, and not of noise.
#[test]
fn elastic_fits_of_viscoelastic_data_warn() {
    let mut elastic =
        CaseFile::parse("flat.toml", FLAT.split("[relaxation]").next().unwrap()).unwrap();
    let exact = readings();
    let largest = exact[2].iter().copied().fold(0.0, f64::max);
    let noise = [0.005 * largest, 1e-10];
    let warns = |fit: &Fit| {
        fit.warnings()
            .iter()
            .any(|it| it.contains("depend on the rate"))
    };
    let found = fitted(&elastic, &noisy(&exact, 1, noise), &[MODULUS, POINT]);
    let test = found.rate.unwrap();
    assert!(test.p_value < 1e-10, "{}", test.p_value);
    // The order of the relaxation time is found.
    assert!(
        test.time > TRUE_TIME / 10.0 && test.time < TRUE_TIME * 10.0,
        "{}",
        test.time
    );
    assert!(warns(&found), "{:?}", found.warnings());
    // Hertz's contact at the same times.
    elastic.set("substrate.young_modulus=1.6 MPa").unwrap();
    let of = |displacement: &f64| {
        let depth = (displacement - TRUE_POINT).max(0.0);
        4.0 / 3.0 * reduced() * RADIUS.sqrt() * depth.powf(1.5)
    };
    let forces: Vec<f64> = exact[1].iter().map(of).collect();
    let exact = [exact[0].clone(), exact[1].clone(), forces];
    let warned = (0..12)
        .filter(|seed| {
            let data = noisy(&exact, *seed, noise);
            warns(&fitted(&elastic, &data, &[MODULUS, POINT]))
        })
        .count();
    // At a level of 1 %.
    assert!(warned <= 1, "{warned}");
}
