//! Fits of several synthetic curves.

use crate::fit::{COMPLIANCE, SUBSTRATE, case_file, close, indentations, loading};
use chacha20::ChaCha12Rng;
use chacha20::rand_core::SeedableRng;
use fakir::state::{CancelToken, Run, SolveError};
use fakir_case::{CaseFile, Key};
use fakir_inverse::fit::{
    Column, CurveFits, FitError, FitOptions, JointFit, MeasuredCurve, Measurements, Parameter, fit,
    fit_curves, fit_jointly, shared_by_default,
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

fn curve(name: &str, data: Measurements) -> MeasuredCurve {
    let options = FitOptions {
        machine_compliance: COMPLIANCE,
        ..FitOptions::default()
    };
    MeasuredCurve {
        name: name.to_owned(),
        data: Ok((data, options)),
        case: None,
    }
}

fn two_threads() -> rayon::ThreadPool {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(2);
    builder.build().unwrap()
}

/// Ten curves of one modulus with different contact points.
fn ten(file: &CaseFile) -> Vec<MeasuredCurve> {
    (0..10u32)
        .map(|k| {
            let shift = 0.1e-6 * f64::from(k);
            let data = noisy(file, 100 + u64::from(k), shift);
            curve(&format!("{k}.csv"), data)
        })
        .collect()
}

fn fit_all(curves: Vec<MeasuredCurve>, run: &Run<'_>) -> CurveFits {
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
    let pool = two_threads();
    let run = Run {
        pool: Some(&pool),
        ..Run::default()
    };
    let fitted = fit_all(ten(&truth), &run);
    assert_eq!(fitted.failed().count(), 0);
    let found = fitted.statistics[0].as_ref().unwrap();
    let error = found.standard_error.unwrap();
    assert_eq!(found.count, 10);
    assert!(
        (found.mean - modulus(&truth)).abs() < 3.0 * error,
        "{found:?}"
    );
    let weighted = found.weighted_mean.unwrap();
    let off = (weighted.value - modulus(&truth)).abs() / weighted.standard_error;
    assert!(off < 3.0, "{weighted:?}");
    assert!((1.7..23.6).contains(&weighted.chi_square), "{weighted:?}");
    // The contact points differ by design, and the fits find the steps of 0.1 um.
    let points = fitted.statistics[1].as_ref().unwrap();
    assert!(points.weighted_mean.unwrap().p_value.unwrap() < 1e-6);
    // The same on one thread, bit for bit.
    let mut first = ten(&truth);
    first.truncate(1);
    let single = fit_all(first, &Run::default());
    let [one, other] = [&single, &fitted].map(|fits| &fits.curves[0].converged().unwrap().fit);
    assert_eq!(one.estimates, other.estimates);
    let means = fitted.mean_case(&truth).case().unwrap();
    assert!(close(
        means.system.substrate().young_modulus,
        found.mean,
        1e-12
    ));
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
        MeasuredCurve {
            name: "missing.csv".to_owned(),
            data: Err(FitError::Unreadable(
                "missing.csv: cannot read: not found".to_owned(),
            )),
            case: None,
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
    assert!(
        warnings.iter().any(|warning| warning == told),
        "{warnings:?}"
    );
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

fn fit_together(curves: Vec<MeasuredCurve>, free: &[Parameter], shared: &[Parameter]) -> JointFit {
    let file = case_file(&[]);
    fit_jointly(&file, curves, free, shared, &Run::default(), &|| {}).unwrap()
}

/// Three curves with given errors: the modulus of the joint fit is in its interval. In a linear model its value and standard error are
/// those of the weighted mean of the separate fits, whatever the other parameters are; here the model is nearly linear over the errors of
/// a few per cent, so that both agree to a tenth of the standard error and to 5 %.
#[test]
fn a_joint_modulus_is_the_weighted_mean_of_the_curves() {
    let truth = case_file(&[]);
    let curves = || {
        let mut curves = ten(&truth);
        curves.truncate(3);
        for curve in &mut curves {
            let (data, _) = curve.data.as_mut().unwrap();
            *data = data.clone().with_force_error(NOISE);
        }
        curves
    };
    let joint = fit_together(curves(), &FREE, &shared_by_default(&FREE));
    assert!(
        joint.converged() && joint.describes_data(),
        "{:?}",
        joint.agreement
    );
    let [estimate] = &joint.shared[..] else {
        panic!("{:?}", joint.shared);
    };
    let [low, high] = estimate.interval.unwrap();
    assert!(
        low < modulus(&truth) && modulus(&truth) < high,
        "{estimate:?}"
    );
    let separate = fit_all(curves(), &Run::default());
    let weighted = separate.statistics[0]
        .as_ref()
        .unwrap()
        .weighted_mean
        .unwrap();
    let error = estimate.standard_error.unwrap();
    assert!(
        (estimate.value - weighted.value).abs() < 0.1 * error,
        "{estimate:?} {weighted:?}"
    );
    assert!(
        (error / weighted.standard_error - 1.0).abs() < 0.05,
        "{estimate:?} {weighted:?}"
    );
    // The test of the agreement is the chi-square of the separate values about the weighted mean, in a linear model.
    let agreement = joint.agreement.unwrap();
    assert_eq!(
        (agreement.degrees_of_freedom, agreement.denominator),
        (2, None)
    );
    assert!(
        (agreement.statistic - weighted.chi_square).abs() < 0.1,
        "{agreement:?} {weighted:?}"
    );
    // Contact points are those of the curves, with smaller errors than in the separate fits.
    for (k, (one, alone)) in joint.curves.iter().zip(&separate.curves).enumerate() {
        let own = &one.converged().unwrap().fit.estimates[1];
        let point = 3e-6 + 0.1e-6 * k as f64;
        let error = own.standard_error.unwrap();
        assert!((own.value - point).abs() < 4.0 * error, "{own:?}");
        let alone = &alone.converged().unwrap().fit.estimates[1];
        assert!(error < alone.standard_error.unwrap());
    }
}

/// Offset and drift of the force are exactly linear. With given errors the joint offset is then the weighted mean of the separate fits, its
/// standard error is that of the weighted mean to rounding, and the test of the agreement is that of the weighted mean. A search ends when
/// its next step is shorter than a thousandth of the standard error: this limits the comparison of values.
#[test]
fn linear_parameters_follow_the_exact_theory() {
    let truth = case_file(&[]);
    let free = [Parameter::ForceOffset, Parameter::ForceDrift];
    let curves = || -> Vec<MeasuredCurve> {
        // Curves of different precision.
        let errors = [0.4e-6, 0.5e-6, 1.5e-6];
        let one = |(k, error): (u64, f64)| {
            let data = noisy(&truth, 20 + k, 0.0).with_force_error(error);
            let mut curve = curve(&format!("{k}.csv"), data);
            let (_, options) = curve.data.as_mut().unwrap();
            options.contact_point = Some(3e-6);
            curve
        };
        (0..).zip(errors).map(one).collect()
    };
    let shared = [Parameter::ForceOffset];
    let joint = fit_together(curves(), &free, &shared);
    let file = case_file(&[]);
    let separate = fit_curves(&file, curves(), &free, &Run::default(), &|| {}).unwrap();
    let weighted = separate.statistics[0]
        .as_ref()
        .unwrap()
        .weighted_mean
        .unwrap();
    let offset = &joint.shared[0];
    let error = offset.standard_error.unwrap();
    assert!(
        (offset.value - weighted.value).abs() < 1e-3 * error,
        "{offset:?} {weighted:?}"
    );
    assert!(
        (error / weighted.standard_error - 1.0).abs() < 1e-9,
        "{offset:?} {weighted:?}"
    );
    let agreement = joint.agreement.unwrap();
    let chi_square = weighted.chi_square;
    assert!(
        (agreement.statistic - chi_square).abs() < 1e-3,
        "{agreement:?} {weighted:?}"
    );
    assert!((agreement.p_value - weighted.p_value.unwrap()).abs() < 1e-3);
    // Degrees of freedom: 72 values, one offset and three drifts.
    assert_eq!(joint.degrees_of_freedom, 68);
}

#[test]
fn a_joint_fit_of_one_curve_is_the_single_fit() {
    let truth = case_file(&[]);
    let data = noisy(&truth, 3, 0.0);
    let joint = fit_together(vec![curve("one.csv", data.clone())], &FREE, &[SUBSTRATE]);
    let options = FitOptions {
        machine_compliance: COMPLIANCE,
        ..FitOptions::default()
    };
    let single = fit(&truth, &data, &FREE, &options, &Run::default()).unwrap();
    let found = &joint.curves[0].converged().unwrap().fit;
    for (one, other) in found.estimates.iter().zip(&single.estimates) {
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
        assert!(near(one.value, other.value), "{one:?} {other:?}");
        let errors = [one, other].map(|estimate| estimate.standard_error.unwrap());
        assert!(near(errors[0], errors[1]), "{one:?} {other:?}");
        let [ends, others] = [one, other].map(|estimate| estimate.interval.unwrap());
        assert!(near(ends[0], others[0]) && near(ends[1], others[1]));
    }
    assert!((found.chi_square / single.chi_square - 1.0).abs() < 1e-9);
    assert_eq!(found.degrees_of_freedom, single.degrees_of_freedom);
    assert_eq!(joint.agreement, None);
    assert_eq!(joint.shared[0], found.estimates[0]);
}

/// Two moduli that differ by a fifth, with errors of two per cent: the test of the agreement rejects a common value, with estimated errors too.
#[test]
fn curves_of_different_samples_do_not_agree() {
    let truth = case_file(&[]);
    let other = format!("substrate.young_modulus={}Pa", 1.2 * modulus(&truth));
    let other = case_file(&[&other]);
    for error in [None, Some(NOISE)] {
        let with_error = |data: Measurements| match error {
            Some(error) => data.with_force_error(error),
            None => data,
        };
        let curves = vec![
            curve("one.csv", with_error(noisy(&truth, 1, 0.0))),
            curve("two.csv", with_error(noisy(&truth, 2, 0.2e-6))),
            curve("other.csv", with_error(noisy(&other, 3, 0.1e-6))),
        ];
        let joint = fit_together(curves, &FREE, &[SUBSTRATE]);
        let agreement = joint.agreement.unwrap();
        assert_eq!(agreement.denominator.is_some(), error.is_none());
        assert!(agreement.p_value < 1e-4, "{agreement:?}");
        assert!(!joint.agrees() && !joint.describes_data());
        let statements = joint.misfit_statements();
        let told = "the curves do not agree on substrate.young_modulus (p = ";
        assert!(statements[0].starts_with(told), "{statements:?}");
    }
}

#[test]
fn what_cannot_be_fitted_together_says_why() {
    let truth = case_file(&[]);
    let refused = |curves: Vec<MeasuredCurve>, shared: &[Parameter]| {
        let joint = fit_jointly(&truth, curves, &FREE, shared, &Run::default(), &|| {});
        joint.unwrap_err().to_string()
    };
    let good = || curve("good.csv", noisy(&truth, 1, 0.0));
    let [displacement, force, radius] = loading(&truth, &indentations(12));
    let radii = Measurements::new(&[
        (Column::Displacement, displacement),
        (Column::ContactRadius, radius),
    ]);
    let radii = || curve("radii.csv", radii.clone().unwrap());
    let told = refused(vec![good(), radii()], &[SUBSTRATE]);
    assert!(
        told.starts_with("joint fits whose curves have other quantities"),
        "{told}"
    );
    assert!(
        told.contains("good.csv has force, radii.csv has contact radius"),
        "{told}"
    );
    let told = refused(vec![good()], &[]);
    assert!(told.starts_with("no free parameter is shared"), "{told}");
    let told = refused(vec![good()], &[Parameter::ForceOffset]);
    assert_eq!(
        told,
        "force_offset is shared, but not free: make it free too"
    );
    let few = Measurements::new(&[
        (Column::Displacement, vec![4e-6, 5e-6]),
        (Column::Force, vec![force[5], force[8]]),
    ]);
    let told = refused(vec![good(), curve("few.csv", few.unwrap())], &[SUBSTRATE]);
    assert!(told.starts_with("few.csv: "), "{told}");
    let missing = MeasuredCurve {
        name: "missing.csv".to_owned(),
        data: Err(FitError::Unreadable(
            "missing.csv: cannot read: no file".to_owned(),
        )),
        case: None,
    };
    let told = refused(vec![good(), missing], &[SUBSTRATE]);
    assert_eq!(told, "missing.csv: cannot read: no file");
}

/// On every kind of surface the separate fits of several curves are those of the single curves, with and without threads. The data are Hertz's contact of a
/// glass lens on rubber of 1.6 MPa.
#[test]
fn separate_fits_on_every_kind_of_surface() {
    let modulus = ((1.0 - 0.25) / 1.6e6 + (1.0 - 0.04) / 70e9f64).recip();
    let hertz = |radius: f64, points: &[f64]| -> Vec<MeasuredCurve> {
        let one = |point: &f64| {
            let depths: Vec<f64> = (-5..25).map(|k| 0.04e-6 * f64::from(k)).collect();
            let force = |(row, depth): (usize, &f64)| {
                let ripple = if row % 2 == 0 { 1e-8 } else { -1e-8 };
                4.0 / 3.0 * modulus * radius.sqrt() * depth.max(0.0).powf(1.5) + ripple
            };
            let data = Measurements::new(&[
                (
                    Column::Force,
                    depths.iter().enumerate().map(force).collect(),
                ),
                (
                    Column::Displacement,
                    depths.iter().map(|depth| depth + point).collect(),
                ),
            ]);
            MeasuredCurve {
                name: format!("{point}"),
                data: Ok((data.unwrap(), FitOptions::default())),
                case: None,
            }
        };
        points.iter().map(one).collect()
    };
    let pool = two_threads();
    let with_threads = Run {
        pool: Some(&pool),
        ..Run::default()
    };
    let surfaces = [
        (super::flat::file(&[]), 2e-3),
        (super::rounded::file(&[]), 0.5e-3),
        (super::height_maps::map(|_, _| 0.0, &[]), 1e-3),
    ];
    for (file, radius) in surfaces {
        let points = [1e-6, -0.3e-6];
        let alone: Vec<f64> = hertz(radius, &points)
            .into_iter()
            .map(|curve| {
                let (data, options) = curve.data.unwrap();
                let found = fit(&file, &data, &FREE, &options, &Run::default()).unwrap();
                assert!(found.converged());
                found.estimates[0].value
            })
            .collect();
        for run in [&Run::default(), &with_threads] {
            let fits = fit_curves(&file, hertz(radius, &points), &FREE, run, &|| {}).unwrap();
            assert_eq!(fits.failed().count(), 0);
            for (curve, alone) in fits.curves.iter().zip(&alone) {
                let found = &curve.converged().unwrap().fit;
                close(found.estimates[0].value, *alone, 1e-9);
            }
            let mean = fits.statistics[0].as_ref().unwrap().mean;
            let given = fits.mean_case(&file).given(Key::SubstrateYoungModulus);
            close(given.unwrap().unwrap(), mean, 1e-12);
            close(mean, 1.6e6, 0.03);
        }
    }
}
