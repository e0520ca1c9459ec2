//! Errors of the libraries as exceptions of `fakir.errors`, with the same messages.

use fakir::state::SolveError;
use fakir_case::{CaseFile, Key, with_keys};
use fakir_inverse::design::DesignError;
use fakir_inverse::fit::FitError;
use fakir_inverse::heights::HeightDesignError;
use fakir_inverse::pillar_heights::PillarHeightsError;
use fakir_inverse::spread::SpreadError;
use fakir_study::StudyError;
use fakir_study::approach::ApproachError;
use fakir_study::surfaces::SurfaceVerifyError;
use pyo3::exceptions::{PyFutureWarning, PyKeyboardInterrupt, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use std::ffi::CString;

mod exceptions {
    pyo3::import_exception!(fakir.errors, CaseError);
    pyo3::import_exception!(fakir.errors, DesignError);
    pyo3::import_exception!(fakir.errors, FitError);
    pyo3::import_exception!(fakir.errors, SolveError);
    pyo3::import_exception!(fakir.errors, StudyError);
}

/// Name of a case created in Python.
pub(crate) const PYTHON: &str = "fakir.System";

/// An error in a case; errors in values given in Python have no file position.
pub(crate) fn case_error(error: &fakir_case::CaseError) -> PyErr {
    let in_python = [PYTHON, "a number that was set", "--set"].contains(&error.file());
    let text = match error.what_is_accepted() {
        _ if !in_python => error.one_line(),
        Some(accepted) => format!("{error}; {accepted}"),
        None => error.to_string(),
    };
    let place = error.position().filter(|_| !in_python);
    exceptions::CaseError::new_err((
        text,
        (!in_python).then(|| error.file().to_owned()),
        place.map(|(line, _)| line),
        place.map(|(_, column)| column),
        error.key_path().map(str::to_owned),
    ))
}

/// Warns the caller of the package, two stack levels up, of deprecated names in a file or in overrides, and of a lens axis outside the pillars.
pub(crate) fn warn_of_file(file: &CaseFile) -> PyResult<()> {
    Python::attach(|py| {
        let warn = |category, text: String| {
            let text = CString::new(text).map_err(value_error)?;
            PyErr::warn(py, &category, &text, 2)
        };
        for text in file.deprecations() {
            warn(py.get_type::<PyFutureWarning>().into_any(), text)?;
        }
        if let Some(text) = file.axis_outside() {
            warn(py.get_type::<PyUserWarning>().into_any(), text)?;
        }
        Ok(())
    })
}

/// Warns the caller of the package if `name` is a deprecated name of a key.
pub(crate) fn warn_of_former_name(py: Python<'_>, name: &str) -> PyResult<()> {
    let Some(key) = Key::at_former(name) else {
        return Ok(());
    };
    let text = CString::new(format!("{name} is deprecated: use {key}")).map_err(value_error)?;
    PyErr::warn(py, &py.get_type::<PyFutureWarning>(), &text, 2)
}

/// An invalid value given in Python.
pub(crate) fn value_error(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

// An interruption is caused by Ctrl-C, or by an exception that is raised in its place.

pub(crate) fn solve_error(error: &SolveError) -> PyErr {
    match error {
        SolveError::Interrupted => PyKeyboardInterrupt::new_err(()),
        SolveError::InvalidQuantity(_) => value_error(error),
        _ => exceptions::SolveError::new_err(with_keys(error)),
    }
}

pub(crate) fn approach_error(error: &ApproachError) -> PyErr {
    match error {
        ApproachError::Solve(error) => solve_error(error),
        other => value_error(other),
    }
}

pub(crate) fn surface_verify_error(error: &SurfaceVerifyError) -> PyErr {
    match error {
        SurfaceVerifyError::Case(error) => case_error(error),
        SurfaceVerifyError::Surface(error) => solve_error(error),
        other => value_error(other),
    }
}

pub(crate) fn design_error(error: &DesignError) -> PyErr {
    match error {
        DesignError::Case(error) => case_error(error),
        DesignError::Solve(error) => solve_error(error),
        _ => exceptions::DesignError::new_err(error.to_string()),
    }
}

pub(crate) fn spread_error(error: &SpreadError) -> PyErr {
    match error {
        SpreadError::Case(error) => case_error(error),
        SpreadError::Solve(error) => solve_error(error),
        _ => exceptions::DesignError::new_err(error.to_string()),
    }
}

pub(crate) fn pillar_heights_error(error: &PillarHeightsError) -> PyErr {
    use HeightDesignError as E;
    match error {
        PillarHeightsError::Solve(error) | PillarHeightsError::Heights(E::Start(error)) => {
            solve_error(error)
        }
        PillarHeightsError::Heights(E::Interrupted) => PyKeyboardInterrupt::new_err(()),
        PillarHeightsError::Heights(
            E::WantedPoint { .. } | E::Falls { .. } | E::NoPoints | E::Caps(_),
        )
        | PillarHeightsError::BelowFloor { .. } => value_error(error),
        _ => exceptions::DesignError::new_err(error.to_string()),
    }
}

pub(crate) fn fit_error(error: &FitError) -> PyErr {
    match error.cause() {
        FitError::Case(error) => case_error(error),
        FitError::Solve(error) => solve_error(error),
        _ => exceptions::FitError::new_err(error.to_string()),
    }
}

/// A fit that is refused.
pub(crate) fn refused_fit(error: &impl std::fmt::Display) -> PyErr {
    exceptions::FitError::new_err(error.to_string())
}

pub(crate) fn study_error(error: &StudyError) -> PyErr {
    match error {
        StudyError::Case(error) => case_error(error),
        _ => exceptions::StudyError::new_err(error.to_string()),
    }
}
