//! Conversion of prescribed loads from Python.

use crate::error::{approach_error, value_error};
use fakir::problem::{CyclePlan, Load, LoadingMode};
use fakir_study::approach::{LoadingEnd, LoadingPath};
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
