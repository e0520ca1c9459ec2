//! Several curves, each fitted separately, and the statistics of their parameters.

use super::error::FitError;
use super::measurements::Measurements;
use super::options::FitOptions;
use super::parameter::Parameter;
use super::statistics::{Outlier, Sample, Statistics};
use super::subject::Subject;
use super::{Fit, fit};
use fakir::problem::Question;
use fakir::state::{Run, SolveError};
use fakir_case::CaseFile;
use rayon::prelude::*;
use std::time::Instant;

/// A curve to be fitted.
#[derive(Debug)]
pub struct MeasuredCurve {
    /// Its name: the file.
    pub name: String,
    /// The data with the options of the fit, or why they cannot be read.
    pub data: Result<(Measurements, FitOptions), FitError>,
    /// Its case, if it was measured on another surface than the others.
    pub case: Option<CaseFile>,
}

/// A fitted curve.
#[derive(Debug)]
pub struct FittedData {
    /// The data.
    pub data: Measurements,
    /// The fit.
    pub fit: Fit,
    /// Duration of the fit, s.
    pub wall_time: f64,
}

/// A curve and its fit.
#[derive(Debug)]
pub struct CurveFit {
    /// Name of the curve.
    pub name: String,
    /// The fit, or why there is none.
    pub outcome: Result<FittedData, FitError>,
}

impl CurveFit {
    /// The fit, unless there is none or it did not converge.
    #[must_use]
    pub fn converged(&self) -> Option<&FittedData> {
        let fitted = self.outcome.as_ref().ok();
        fitted.filter(|fitted| fitted.fit.converged())
    }

    /// A text about the curve, with its name before it unless it is there already, as in errors of data.
    #[must_use]
    pub fn named(&self, text: &str) -> String {
        if text.starts_with(&self.name) {
            text.to_owned()
        } else {
            format!("{}: {text}", self.name)
        }
    }

    /// Why there is no result of this curve.
    #[must_use]
    pub fn problem(&self) -> Option<String> {
        match &self.outcome {
            Err(error) => Some(error.to_string()),
            Ok(fitted) if fitted.fit.converged() => None,
            Ok(fitted) if fitted.fit.rows.iter().all(|row| row.converged) => {
                Some(format!("the fit {}", fitted.fit.termination.description()))
            }
            Ok(_) => Some("contacts did not converge or are not resolved".to_owned()),
        }
    }
}

/// Several curves with the same free parameters, each fitted separately.
#[derive(Debug)]
pub struct CurveFits {
    /// The free parameters.
    pub free: Vec<Parameter>,
    /// The curves, in the order in which they were given.
    pub curves: Vec<CurveFit>,
    /// For every parameter, the statistics of the fits that converged and determine it; `None` if there are none.
    pub statistics: Vec<Option<Statistics>>,
}

impl CurveFits {
    /// Curves without a converged fit.
    pub fn failed(&self) -> impl Iterator<Item = &CurveFit> {
        let curves = self.curves.iter();
        curves.filter(|curve| curve.converged().is_none())
    }

    /// Outliers of all parameters.
    pub fn outliers(&self) -> impl Iterator<Item = (Parameter, Outlier)> {
        let of = self.free.iter().zip(&self.statistics);
        let of = of.filter_map(|(parameter, found)| Some((*parameter, found.as_ref()?)));
        of.flat_map(|(parameter, found)| found.outliers.iter().map(move |o| (parameter, *o)))
    }

    /// The case with the mean values of its free keys; the given case if these values are invalid together.
    #[must_use]
    pub fn mean_case(&self, file: &CaseFile) -> CaseFile {
        let mut mean = file.clone();
        for (parameter, found) in self.free.iter().zip(&self.statistics) {
            if let Some(found) = found {
                parameter.set(&mut mean, found.mean);
            }
        }
        match Subject::of(&mean) {
            Ok(_) => mean,
            Err(_) => file.clone(),
        }
    }
}

/// Fits the free parameters to every curve separately, with its own case or the common one. The threads of `run` share the curves, and the rows of each. `done` is called after
/// each curve.
///
/// # Errors
/// If the case is invalid or the computation was cancelled. Errors of single curves are part of the result.
pub fn fit_curves(
    file: &CaseFile,
    curves: Vec<MeasuredCurve>,
    free: &[Parameter],
    run: &Run<'_>,
    done: &(dyn Fn() + Sync),
) -> Result<CurveFits, FitError> {
    file.check_surface(&[Question::Fit])?;
    Subject::of(file)?;
    // The curves are computed on different threads, and a progress report would mix them.
    let of_one = Run {
        progress: None,
        ..run.clone()
    };
    let one = |curve: MeasuredCurve| {
        let start = Instant::now();
        let outcome = curve.data.and_then(|(data, options)| {
            if run.cancel.is_cancelled() {
                return Err(SolveError::Interrupted.into());
            }
            let file = curve.case.as_ref().unwrap_or(file);
            let fit = fit(file, &data, free, &options, &of_one)?;
            Ok(FittedData {
                data,
                fit,
                wall_time: start.elapsed().as_secs_f64(),
            })
        });
        done();
        CurveFit {
            name: curve.name,
            outcome,
        }
    };
    let curves: Vec<CurveFit> = match run.pool {
        None => curves.into_iter().map(one).collect(),
        Some(pool) => pool.install(|| curves.into_par_iter().map(one).collect()),
    };
    if run.cancel.is_cancelled() {
        return Err(SolveError::Interrupted.into());
    }
    let statistics = (0..free.len()).map(|number| Statistics::new(&samples(&curves, number)));
    Ok(CurveFits {
        free: free.to_vec(),
        statistics: statistics.collect(),
        curves,
    })
}

/// Values of a parameter, by its number, of all fits that converged and determine it.
fn samples(curves: &[CurveFit], number: usize) -> Vec<Sample> {
    let sample = |(curve, of): (usize, &CurveFit)| {
        let estimate = of.converged()?.fit.estimates.get(number)?;
        Some(Sample {
            curve,
            value: estimate.value,
            standard_error: estimate.standard_error?,
        })
    };
    curves.iter().enumerate().filter_map(sample).collect()
}
