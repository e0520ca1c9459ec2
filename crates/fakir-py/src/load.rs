//! Conversion of prescribed loads from Python.

use crate::error::{approach_error, value_error};
use crate::watched::{Options, watched};
use fakir::problem::{CyclePlan, Load, LoadingMode};
use fakir_study::approach::{Approach, Loadable, LoadingEnd, LoadingPath, approach};
use fakir_study::result::{ApproachSummary, json};
use pyo3::prelude::*;

/// The load for an indentation (m) or a force (N), one of which is required.
pub(crate) fn load(indentation: Option<f64>, force: Option<f64>) -> PyResult<Load> {
    let load = Load::given(indentation, force);
    load.ok_or_else(|| value_error("give an indentation or a force"))
}

/// The load for an indentation (m) or a force (N); the critical state if neither is given.
pub(crate) fn load_or_critical(indentation: Option<f64>, force: Option<f64>) -> Load {
    Load::given(indentation, force).unwrap_or(Load::FloorContact)
}

/// A loading in steps of the indentation (m) up to the given end, or to the critical state.
pub(crate) fn path(
    step: f64,
    until: Option<f64>,
    to: Option<f64>,
    to_force: Option<f64>,
) -> PyResult<LoadingPath> {
    let end = LoadingEnd::of(until, false, to, to_force);
    let end = end.map_err(|error| approach_error(&error))?;
    Ok(LoadingPath { step, end })
}

/// A loading on any surface.
pub(crate) struct Approached<P: Loadable> {
    pub(crate) found: Approach<P>,
    /// Contacts, but for the critical state, with their computing times, s.
    pub(crate) states: Vec<(P::Contact, f64)>,
    /// The object that `fakir approach --json` prints.
    pub(crate) summary: String,
}

/// Computes a loading.
pub(crate) fn approached<P: Loadable<Contact: Send> + Sync>(
    py: Python<'_>,
    problem: &P,
    path: &LoadingPath,
    options: &Options,
) -> PyResult<Approached<P>> {
    let (found, states) = watched(py, options, |run| {
        let mut states = Vec::new();
        let mut keep = |contact, wall_time| states.push((contact, wall_time));
        let found = approach(problem, path, run, &|_| {}, &mut keep);
        (found, states)
    })?;
    let found = found.map_err(|error| approach_error(&error))?;
    let summary = json(&ApproachSummary::new(problem, &found));
    Ok(Approached {
        found,
        states,
        summary,
    })
}

/// A cycle up to an indentation (m), a force (N) or the critical state; a stiffness (N/m) is that of the testing machine that drives the lens.
pub(crate) fn plan(
    to: Option<f64>,
    to_force: Option<f64>,
    drive: &str,
    machine_stiffness: Option<f64>,
    retract: bool,
) -> CyclePlan {
    let drive = match (drive, machine_stiffness) {
        (_, Some(stiffness)) => LoadingMode::Machine(stiffness),
        ("force", None) => LoadingMode::Force,
        _ => LoadingMode::Displacement,
    };
    CyclePlan {
        turn: load_or_critical(to, to_force).into(),
        drive,
        retract,
    }
}
