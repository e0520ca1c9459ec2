//! Fits of shear stresses to lateral forces.

use crate::case::Described;
use crate::error::{case_error, fit_error, solve_error};
use crate::fit::{Fittable, hints};
use crate::study::{PyColumns, columns};
use crate::watched::{Options, watched};
use fakir::problem::Question;
use fakir::state::SolveError;
use fakir_inverse::fit::friction::{FrictionError, FrictionFit, LateralForces};
use fakir_study::answer::{AnswerError, Running};
use fakir_study::result::json;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::time::Instant;

/// Measured lateral forces.
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct LateralData {
    data: LateralForces,
}

#[pymethods]
impl LateralData {
    /// Reads a file, with explicitly assigned columns, quantity and heading; `error` is the standard error (N) of lateral forces without one.
    #[staticmethod]
    fn read(path: PathBuf, named: Vec<(String, String)>, error: Option<f64>) -> PyResult<Self> {
        let data = LateralForces::read(&path, &hints(&named, None)?);
        Self::of_data(data.map_err(FrictionError::from), error)
    }

    /// Columns by their headings, NaN for missing measurements; `None` for columns that are not numeric.
    #[staticmethod]
    fn of(
        columns: Vec<(String, Option<PyReadonlyArray1<'_, f64>>)>,
        named: Vec<(String, String)>,
        error: Option<f64>,
    ) -> PyResult<Self> {
        let columns = columns.into_iter().map(|(name, values)| {
            let values = values.map(|values| values.as_array().to_vec());
            (name, values)
        });
        let columns: Vec<(String, Option<Vec<f64>>)> = columns.collect();
        let data = LateralForces::from_columns(&columns, &hints(&named, None)?);
        Self::of_data(data.map_err(FrictionError::from), error)
    }
}

impl LateralData {
    fn of_data(data: Result<LateralForces, FrictionError>, error: Option<f64>) -> PyResult<Self> {
        let data = data.map_err(friction_error)?;
        Ok(Self {
            data: match error {
                Some(error) => data.with_error(error),
                None => data,
            },
        })
    }
}

/// Fitted shear stresses.
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct FittedFriction {
    fit: FrictionFit,
    summary: String,
}

#[pymethods]
impl FittedFriction {
    /// The object that `fakir friction --json` prints.
    fn json(&self) -> &str {
        &self.summary
    }

    /// The case with the fitted stresses.
    #[getter]
    fn case(&self) -> PyResult<Described> {
        Described::of(self.fit.file.clone(), &[], true)
    }

    /// Statements about the result.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.fit.warnings.clone()
    }

    /// Data and model.
    fn table<'py>(&self, py: Python<'py>) -> PyResult<PyColumns<'py>> {
        columns(py, &self.fit.table())
    }

    /// The curve of the model: normal force, lateral force, and areas on tops and floor of each point; the last is 0 without a floor.
    fn curve(&self) -> Vec<[f64; 4]> {
        let points = self.fit.curve.iter();
        points
            .map(|(contact, lateral)| {
                let floor = contact.floor.map_or(0.0, |area| area.value);
                [contact.force, *lateral, contact.tops.value, floor]
            })
            .collect()
    }
}

/// Shear stresses that fit lateral forces best.
#[pyfunction]
pub(crate) fn fit_friction(
    py: Python<'_>,
    case: Fittable<'_>,
    data: &LateralData,
    options: Options,
) -> PyResult<FittedFriction> {
    let file = case.file("shear stresses")?;
    let data = &data.data;
    let start = Instant::now();
    let fit = watched(py, &options, |run| {
        let running = Running {
            run: run.clone(),
            next: &|_| {},
        };
        fakir_inverse::fit::friction::fit_friction(&file, data, &running)
    })?;
    let fit = fit.map_err(friction_error)?;
    let summary = json(&fit.summary(data, start.elapsed().as_secs_f64()));
    Ok(FittedFriction { fit, summary })
}

/// Warnings that the keys of interactions have no effect on the answer of `"verify"`, `"compare"`, `"design"` or `"fit"`.
#[pyfunction]
pub(crate) fn without_interactions(case: Fittable<'_>, question: &str) -> Vec<String> {
    let questions = [
        Question::Verify,
        Question::Compare,
        Question::Design,
        Question::Fit,
    ];
    let mut questions = questions.into_iter();
    let asked = questions.find(|known| known.name() == question);
    // Height maps that are not from a file have no answer to these questions.
    match (asked, case.file("parameters")) {
        (Some(asked), Ok(file)) => file.without_interactions(asked),
        _ => Vec::new(),
    }
}

fn friction_error(error: FrictionError) -> PyErr {
    match error {
        FrictionError::Case(error) => case_error(&error),
        FrictionError::Data(error) => fit_error(&error.into()),
        FrictionError::Answer {
            error: AnswerError::Solve(error),
            ..
        } => solve_error(&error),
        FrictionError::Answer {
            error: AnswerError::Case(error),
            ..
        } => case_error(&error),
        FrictionError::Interrupted => solve_error(&SolveError::Interrupted),
        other => crate::error::refused_fit(&other),
    }
}
