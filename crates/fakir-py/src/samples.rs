//! Fields at points, as arrays.

use fakir::problem::Point;
use fakir::state::FieldSamples;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

/// A field at points.
pub(crate) type Field<'py> = Bound<'py, PyArray1<f64>>;

/// Points from their coordinates.
pub(crate) fn points(
    x: &PyReadonlyArray1<'_, f64>,
    y: &PyReadonlyArray1<'_, f64>,
) -> PyResult<Vec<Point>> {
    let pairs = x.as_slice()?.iter().zip(y.as_slice()?);
    Ok(pairs.map(|(x, y)| [*x, *y]).collect())
}

/// Displacement, gap and pressure.
pub(crate) fn arrays(py: Python<'_>, samples: FieldSamples) -> [Field<'_>; 3] {
    let FieldSamples {
        displacement,
        gap,
        pressure,
    } = samples;
    [displacement, gap, pressure].map(|field| PyArray1::from_vec(py, field))
}
