//! The contact of viscoelastic bodies over time.

use crate::answer::Answer;
use crate::asperities::Asperities;
use crate::case::Case;
use crate::error::{PYTHON, approach_error, case_error, value_error};
use crate::flat::Flat;
use crate::surface::Surface;
use crate::watched::{Options, watched};
use fakir::problem::{Prescribed, Protocol, ProtocolSegment, Relaxation};
use fakir::state::Run;
use fakir_case::CaseFile;
use fakir_study::approach::{ApproachError, Loadable};
use fakir_study::history::{HistoryCourse, HistoryPlan, follow};
use fakir_study::record::{HistoryAnswer, Record};
use fakir_study::result::{HistorySummary, json};
use pyo3::prelude::*;

/// A problem of any kind.
#[derive(FromPyObject)]
pub(crate) enum Problem<'py> {
    Pillars(PyRef<'py, Case>),
    Flat(PyRef<'py, Flat>),
    Asperities(PyRef<'py, Asperities>),
    Surface(PyRef<'py, Surface>),
}

/// A segment: whether the force is prescribed, the value at its end (N or m), and its duration (s).
type PySegment = (bool, f64, f64);

/// The history of a problem under a protocol; the relaxation is given by strengths and times (s), or by the case.
#[pyfunction]
#[pyo3(signature = (problem, segments, relaxation, options))]
pub(crate) fn history(
    py: Python<'_>,
    problem: Problem<'_>,
    segments: Vec<PySegment>,
    relaxation: Option<(Vec<f64>, Vec<f64>)>,
    options: Options,
) -> PyResult<Answer> {
    let segments = segments
        .into_iter()
        .map(|(force, to, duration)| ProtocolSegment {
            prescribed: if force {
                Prescribed::Force
            } else {
                Prescribed::Indentation
            },
            to,
            duration,
        });
    let protocol = Protocol::new(segments.collect()).map_err(value_error)?;
    let of_file = |file: &CaseFile| -> PyResult<Relaxation> {
        let of = file.viscoelastic().map_err(|error| case_error(&error))?;
        Ok(of.relaxation)
    };
    let missing = || {
        value_error(
            "the bodies are elastic: give a relaxation, as fakir.Relaxation([1.0], [\"10 s\"])",
        )
    };
    let relaxation = match (&relaxation, &problem) {
        (Some((strengths, times)), _) => Relaxation::new(strengths, times).map_err(value_error)?,
        (None, Problem::Pillars(case)) => case.case.relaxation.clone().ok_or_else(missing)?,
        (None, Problem::Flat(flat)) => of_file(&flat.file)?,
        (None, Problem::Surface(surface)) => of_file(surface.file().ok_or_else(missing)?)?,
        (None, Problem::Asperities(asperities)) => {
            let text = asperities.case().to_toml();
            of_file(&CaseFile::parse(PYTHON, &text).map_err(|error| case_error(&error))?)?
        }
    };
    let plan = HistoryPlan {
        relaxation,
        course: HistoryCourse::Protocol(protocol),
    };
    match &problem {
        Problem::Pillars(case) => followed(py, &options, &plan, &case.case),
        Problem::Flat(flat) => followed(py, &options, &plan, flat.case()),
        Problem::Asperities(asperities) => followed(py, &options, &plan, asperities.case()),
        Problem::Surface(surface) => followed(py, &options, &plan, surface.system()),
    }
}

fn followed<P: Loadable + Sync>(
    py: Python<'_>,
    options: &Options,
    plan: &HistoryPlan,
    problem: &P,
) -> PyResult<Answer>
where
    P::Contact: Send,
{
    let found = watched(py, options, |run: &Run<'_>| -> Result<_, ApproachError> {
        let found = follow(problem, plan, run, &|_| {})?;
        let record = HistoryAnswer::of(&found).map(|answer| Record::of(&answer));
        let summary = json(&HistorySummary::new(problem, &found));
        Ok((record, summary, found.converged, found.warnings))
    })?;
    let (record, summary, converged, warnings) = found.map_err(|error| approach_error(&error))?;
    let record = record.ok_or_else(|| value_error("the protocol has no states"))?;
    Ok(Answer::of_record(record, summary, converged, warnings))
}
