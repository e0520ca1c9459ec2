//! The command `fakir` of the package.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the command with its arguments, starting with its name; returns its exit status.
#[pyfunction]
pub(crate) fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| fakir_cli::main(arguments))
}
