//! A lens or a plate on a height map.

use crate::error::{surface_error, value_error};
use crate::state::load;
use crate::watched::{Options, watched};
use fakir::problem::{Boundary, Floor, Grid, HeightMap, Indenter, SurfaceSystem};
use fakir::problem::{Lens, Material, Point};
use fakir::state::Shares;
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::time::Instant;

/// What is pressed onto what.
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct Surface {
    system: SurfaceSystem,
    floor: Option<f64>,
}

#[pymethods]
impl Surface {
    /// `heights` (m) has a row for every y; `lens` is radius, modulus and Poisson's ratio, `plate`
    /// modulus and Poisson's ratio, or neither for a rigid plate. `origin` (m) is the lower left
    /// corner of the map, from the lens axis.
    #[new]
    fn new(
        heights: PyReadonlyArray2<'_, f64>,
        cell: [f64; 2],
        origin: Point,
        lens: Option<[f64; 3]>,
        plate: Option<[f64; 2]>,
        substrate: [f64; 2],
        periodic: bool,
        floor: Option<f64>,
    ) -> PyResult<Self> {
        let (rows, columns) = (heights.shape()[0], heights.shape()[1]);
        let grid = Grid::new(columns, rows, cell, origin).map_err(value_error)?;
        let map = HeightMap::new(grid, heights.as_slice()?.to_vec()).map_err(value_error)?;
        let material = |[modulus, ratio]: [f64; 2]| Material::new(modulus, ratio);
        let indenter = match lens {
            Some([radius, modulus, ratio]) => Indenter::Lens(Lens {
                radius,
                material: Material::new(modulus, ratio),
            }),
            None => Indenter::Flat(plate.map(material)),
        };
        let boundary = if periodic {
            Boundary::Periodic
        } else {
            Boundary::FreeSpace
        };
        let system = SurfaceSystem::new(indenter, material(substrate), map, boundary);
        Ok(Self {
            system: system.map_err(value_error)?,
            floor,
        })
    }

    #[getter]
    fn reduced_modulus(&self) -> f64 {
        self.system.reduced_modulus()
    }
}

/// A contact on a height map.
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct SurfaceContact {
    contact: fakir::state::SurfaceContact,
    shares: Option<Shares>,
    wall_time: f64,
}

#[pymethods]
impl SurfaceContact {
    /// Its numbers, by the names of `fakir press --json`.
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let contact = &self.contact;
        let summary = PyDict::new(py);
        summary.set_item("method", "love")?;
        summary.set_item("force_N", contact.force)?;
        summary.set_item("indentation_m", contact.indentation)?;
        summary.set_item("contact_area_m2", contact.contact_area)?;
        summary.set_item("contact_radius_m", contact.contact_radius)?;
        for (name, share) in [
            ("tops", self.shares.map(|shares| shares.tops)),
            ("floor", self.shares.map(|shares| shares.floor)),
        ] {
            let share = share.map(|share| {
                let numbers = PyDict::new(py);
                numbers.set_item("force_N", share.force)?;
                numbers.set_item("area_m2", share.area)?;
                Ok::<_, PyErr>(numbers)
            });
            summary.set_item(name, share.transpose()?)?;
        }
        let error = contact.error.map(|error| {
            let numbers = PyDict::new(py);
            numbers.set_item("force", error.force)?;
            numbers.set_item("indentation", error.indentation)?;
            if let Some(error) = contact.relative_contact_radius_error() {
                numbers.set_item("contact_radius", error)?;
            }
            Ok::<_, PyErr>(numbers)
        });
        summary.set_item("relative_error_estimate", error.transpose()?)?;
        summary.set_item("converged", contact.converged())?;
        summary.set_item("iterations", contact.products)?;
        summary.set_item("wall_time_s", self.wall_time)?;
        summary.set_item("fakir_version", fakir_study::VERSION)?;
        Ok(summary)
    }

    #[getter]
    fn termination(&self) -> &'static str {
        self.contact.termination.description()
    }

    #[getter]
    fn mean_pressure(&self) -> f64 {
        self.contact.mean_pressure()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.contact
            .warnings
            .iter()
            .map(ToString::to_string)
            .collect()
    }

    /// Pressure, gap and displacement, a row for every y.
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyArray2<f64>>; 3]> {
        let grid = &self.contact.grid;
        let array = |values: &[f64]| {
            let flat = numpy::PyArray1::from_slice(py, values);
            flat.reshape([grid.rows(), grid.columns()])
        };
        Ok([
            array(&self.contact.pressure)?,
            array(&self.contact.gap)?,
            array(&self.contact.displacement)?,
        ])
    }
}

/// The state in which the floor of a height map is just reached.
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct SurfaceTransition {
    #[pyo3(get)]
    contact: Py<SurfaceContact>,
    #[pyo3(get)]
    regime: &'static str,
    #[pyo3(get)]
    floor_contact: Point,
}

/// The contact at an indentation (m) or under a force (N).
#[pyfunction]
pub(crate) fn press_surface(
    py: Python<'_>,
    surface: &Surface,
    indentation: Option<f64>,
    force: Option<f64>,
    options: Options,
) -> PyResult<SurfaceContact> {
    let load = load(indentation, force)?;
    let start = Instant::now();
    let contact = watched(py, &options, |run| surface.system.press(load, run))?;
    let contact = contact.map_err(|error| surface_error(&error))?;
    Ok(surface.with_shares(contact, start))
}

/// The state in which the floor is just reached.
#[pyfunction]
pub(crate) fn surface_transition(
    py: Python<'_>,
    surface: &Surface,
    options: Options,
) -> PyResult<SurfaceTransition> {
    let floor = surface
        .floor
        .ok_or_else(|| value_error("which cells are floor is not known: give floor, a height"))?;
    let start = Instant::now();
    let found = watched(py, &options, |run| {
        surface.system.transition(Floor::AtOrBelow(floor), run)
    })?;
    let found = found.map_err(|error| surface_error(&error))?;
    Ok(SurfaceTransition {
        contact: Py::new(py, surface.with_shares(found.contact, start))?,
        regime: found.regime.name(),
        floor_contact: found.floor_contact,
    })
}

impl Surface {
    fn with_shares(&self, contact: fakir::state::SurfaceContact, start: Instant) -> SurfaceContact {
        let shares = self
            .floor
            .map(|floor| contact.shares(self.system.surface(), Floor::AtOrBelow(floor)));
        SurfaceContact {
            contact,
            shares,
            wall_time: start.elapsed().as_secs_f64(),
        }
    }
}
