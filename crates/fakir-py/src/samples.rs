//! Fields at points, as arrays.

use fakir::state::FieldSamples;
use numpy::PyArray1;
use pyo3::prelude::*;

/// A field at points.
pub(crate) type Field<'py> = Bound<'py, PyArray1<f64>>;

/// Displacement, gap and pressure.
pub(crate) fn arrays(py: Python<'_>, samples: FieldSamples) -> [Field<'_>; 3] {
    let FieldSamples {
        displacement,
        gap,
        pressure,
    } = samples;
    [displacement, gap, pressure].map(|field| PyArray1::from_vec(py, field))
}
