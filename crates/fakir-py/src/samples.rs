//! Fields at points, as arrays.

use fakir::problem::Point;
use fakir::state::{FieldSamples, FloorContact};
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

/// Centres of the floor cells in contact along x and y (m), and the pressure on each (Pa).
pub(crate) fn floor_cells<'py>(py: Python<'py>, floor: &FloorContact) -> [Field<'py>; 3] {
    let along = |axis: usize| floor.centres().map(move |centre| centre[axis]);
    [
        PyArray1::from_iter(py, along(0)),
        PyArray1::from_iter(py, along(1)),
        PyArray1::from_slice(py, &floor.pressure),
    ]
}
