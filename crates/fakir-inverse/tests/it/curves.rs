//! Fits of several synthetic curves.

use crate::fit::{COMPLIANCE, SUBSTRATE, case_file, indentations, loading};
use chacha20::ChaCha12Rng;
use chacha20::rand_core::SeedableRng;
use fakir::state::{CancelToken, Run, SolveError};
use fakir_case::CaseFile;
use fakir_inverse::fit::{
    Column, Curve, CurveFits, FitError, FitOptions, Measurements, Parameter, fit_curves,
};
use rand_distr::{Distribution, Normal};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Standard deviation of the synthetic forces, N.
const NOISE: f64 = 0.5e-6;

const FREE: [Parameter; 2] = [SUBSTRATE, Parameter::ContactPoint];

/// A curve of 24 rows of the case, with noise of its seed, and its contact point moved by `shift` (m).
fn noisy(file: &CaseFile, seed: u64, shift: f64) -> Measurements {
    let [displacement, force, _] = loading(file, &indentations(24));
    let mut random = ChaCha12Rng::seed_from_u64(seed);
    let noise = Normal::new(0.0, NOISE).unwrap();
    let noisy = force.iter().map(|force| force + noise.sample(&mut random));
    let moved = displacement.iter().map(|reading| reading + shift);
    Measurements::new(&[
        (Column::Displacement, moved.collect()),
        (Column::Force, noisy.collect()),
    ])
    .unwrap()
}

fn curve(name: &str, data: Measurements) -> Curve {
    let options = FitOptions {
        machine_compliance: COMPLIANCE,
        ..FitOptions::default()
    };
    Curve {
        name: name.to_owned(),
        data: Ok((data, options)),
    }
}

/// Ten curves of one modulus with different contact points.
fn ten(file: &CaseFile) -> Vec<Curve> {
    (0..10u32)
        .map(|k| {
            let shift = 0.1e-6 * f64::from(k);
            let data = noisy(file, 100 + u64::from(k), shift);
            curve(&format!("{k}.csv"), data)
        })
        .collect()
}

fn fit_all(curves: Vec<Curve>, run: &Run<'_>) -> CurveFits {
    fit_curves(&case_file(&[]), curves, &FREE, run, &|| {}).unwrap()
}

fn modulus(file: &CaseFile) -> f64 {
    file.case().unwrap().system.substrate().young_modulus
}

/// The mean of the modulus lies within three of its standard errors from the truth, and the scatter is that of the standard errors: its
/// square has a chi-square of 9 degrees of freedom, which is between 1.7 and 23.6 with a probability of 0.99.
#[test]
fn ten_curves_have_the_true_mean_and_the_scatter_of_their_errors() {
    let truth = case_file(&[]);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(2)
        .build()
        .unwrap();
    let run = Run {
        pool: Some(&pool),
        ..Run::default()
    };
    let fitted = fit_all(ten(&truth), &run);
    assert_eq!(fitted.failed().count(), 0);
    let found = fitted.statistics[0].as_ref().unwrap();
    let error = found.standard_error.unwrap();
    assert_eq!(found.count, 10);
    assert!((found.mean - modulus(&truth)).abs() < 3.0 * error, "{found:?}");
    let weighted = found.weighted_mean.unwrap();
    let off = (weighted.value - modulus(&truth)).abs() / weighted.standard_error;
    assert!(off < 3.0, "{weighted:?}");
    assert!((1.7..23.6).contains(&weighted.chi_square), "{weighted:?}");
    // The contact points differ by design, and the fits find the steps of 0.1 um.
    let points = fitted.statistics[1].as_ref().unwrap();
    assert!(points.weighted_mean.unwrap().p_value.unwrap() < 1e-6);
    // The same on one thread, bit for bit.
    let single = fit_all(ten(&truth), &Run::default());
    assert_eq!(single.statistics, fitted.statistics);
    let means = fitted.mean_case(&truth).case().unwrap();
    assert_eq!(means.system.substrate().young_modulus, found.mean);
}

#[test]
fn a_curve_of_another_sample_is_an_outlier() {
    let truth = case_file(&[]);
    let other = format!("substrate.young_modulus={}Pa", 1.5 * modulus(&truth));
    let mut curves = ten(&truth);
    curves.truncate(5);
    curves.push(curve("other.csv", noisy(&case_file(&[&other]), 7, 0.0)));
    let fitted = fit_all(curves, &Run::default());
    let outliers: Vec<_> = fitted.outliers().collect();
    assert_eq!(outliers.len(), 1, "{outliers:?}");
    let (parameter, outlier) = outliers[0];
    assert_eq!((parameter, outlier.curve), (SUBSTRATE, 5));
    assert!(outlier.score > 3.5);
    assert_eq!(fitted.outlier_of(5), ["substrate.young_modulus"]);
    let table = fitted.table().to_csv();
    let last = table.lines().last().unwrap();
    assert!(last.starts_with("other.csv,"), "{last}");
    assert!(last.contains(",substrate.young_modulus,true,"), "{last}");
}

#[test]
fn curves_that_cannot_be_fitted_are_named_and_the_others_fitted() {
    let truth = case_file(&[]);
    let few = Measurements::new(&[
        (Column::Displacement, vec![4e-6, 5e-6]),
        (Column::Force, vec![1e-5, 3e-5]),
    ]);
    let curves = vec![
        curve("good.csv", noisy(&truth, 1, 0.0)),
        Curve {
            name: "missing.csv".to_owned(),
            data: Err(FitError::Unreadable(
                "missing.csv: cannot read: not found".to_owned(),
            )),
        },
        curve("few.csv", few.unwrap()),
        curve("too.csv", noisy(&truth, 2, 0.0)),
    ];
    let count = AtomicUsize::new(0);
    let done = || {
        count.fetch_add(1, Ordering::Relaxed);
    };
    let fitted = fit_curves(&truth, curves, &FREE, &Run::default(), &done).unwrap();
    assert_eq!(count.into_inner(), 4);
    let failed: Vec<&str> = fitted.failed().map(|curve| &curve.name[..]).collect();
    assert_eq!(failed, ["missing.csv", "few.csv"]);
    assert_eq!(fitted.statistics[0].as_ref().unwrap().count, 2);
    let warnings = fitted.warnings();
    let told = "no fit of missing.csv: cannot read: not found";
    assert!(warnings.iter().any(|warning| warning == told), "{warnings:?}");
    assert!(
        warnings
            .iter()
            .any(|warning| warning.starts_with("no fit of few.csv: ")),
        "{warnings:?}"
    );
}

#[test]
fn a_cancelled_computation_has_no_result() {
    let truth = case_file(&[]);
    let cancel = CancelToken::default();
    cancel.cancel();
    let run = Run {
        cancel,
        ..Run::default()
    };
    let curves = vec![curve("one.csv", noisy(&truth, 1, 0.0))];
    let stopped = fit_curves(&truth, curves, &FREE, &run, &|| {});
    assert!(matches!(
        stopped,
        Err(FitError::Solve(SolveError::Interrupted))
    ));
}
