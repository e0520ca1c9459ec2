//! A lens or a plate on a height map.

use crate::answer::{Answer, warnings};
use crate::error::{
    PYTHON, case_error, solve_error, surface_verify_error, value_error, warn_of_file,
};
use crate::load::{Approached, approached, load, load_or_critical, path, plan};
use crate::settings::{BodySettings, by_key, settings};
use crate::watched::{Options, watched};
use fakir::problem::{
    Adhesion, Base, Boundary, Floor, FloorModel, Grid, HeightMap, Indenter, Layer, Material, Point,
    SurfaceSystem,
};
use fakir::state::Run;
use fakir_case::unit::{Dimension, format_quantity};
use fakir_case::{CaseFile, SurfaceCase, implausible_relief};
use fakir_study::record::SurfaceAnswer;
use fakir_study::result::{self, SurfaceVerifySummary, json};
use fakir_study::surfaces::{self, SurfaceVerifyError};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::time::Instant;

/// A surface and the lens or plate pressed onto it.
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct Surface {
    system: SurfaceSystem,
    /// The case file it was read from, if any.
    file: Option<CaseFile>,
    /// The keys of the bodies, for a lens on a surface that was not read.
    bodies: Option<Box<CaseFile>>,
    /// The canonical text of that case.
    text: Option<String>,
}

#[pymethods]
impl Surface {
    /// `heights` (m) has a row for every y; `lens` contains the numbers and words of the keys of both bodies, `plate` modulus and Poisson's
    /// ratio, or neither for a rigid plate. `floor` is its height (m) and whether it carries load. `origin` (m) is the lower left corner of the map relative to the lens axis.
    #[new]
    fn new(
        heights: PyReadonlyArray2<'_, f64>,
        cell: [f64; 2],
        origin: Point,
        lens: Option<BodySettings>,
        plate: Option<[f64; 2]>,
        substrate: [f64; 2],
        layers: [Option<LayerNumbers>; 2],
        periodic: bool,
        floor: Option<(f64, bool)>,
        adhesion: Option<(f64, Option<f64>, bool)>,
    ) -> PyResult<Self> {
        let (rows, columns) = (heights.shape()[0], heights.shape()[1]);
        let grid = Grid::new(columns, rows, cell, origin).map_err(value_error)?;
        let map = HeightMap::new(grid, heights.as_slice()?.to_vec()).map_err(value_error)?;
        if let Some(lengths) = implausible_relief(&map) {
            let [range, extent] = lengths.map(|length| format_quantity(length, Dimension::Length));
            return Err(value_error(format!(
                "heights differ by {range} on a map of {extent}: give them in metres, as 1e-9 * heights if they are in nm"
            )));
        }
        let material = |[modulus, ratio]: [f64; 2]| Material::new(modulus, ratio);
        let bodies = match lens {
            Some((numbers, words)) => {
                Some(CaseFile::from_settings(PYTHON, settings(numbers, words)?))
            }
            None => None,
        };
        let indenter = match &bodies {
            Some(file) => {
                let lens = file.shaped_lens().map_err(|error| case_error(&error))?;
                Indenter::from(lens)
            }
            None => Indenter::Flat(plate.map(material)),
        };
        let boundary = if periodic {
            Boundary::Periodic
        } else {
            Boundary::FreeSpace
        };
        let system = SurfaceSystem::new(indenter, material(substrate), map, boundary);
        let [film, of_lens] = layers.map(|layer| layer.map(layer_of));
        let system = system.and_then(|system| system.with_layers(film, of_lens));
        let adhesion = adhesion.map_or(Adhesion::NONE, |(work, work_receding, floor)| Adhesion {
            work,
            work_receding,
            floor,
        });
        let system = system.and_then(|system| system.with_adhesion(adhesion));
        let system = system.map_err(value_error)?;
        if floor.is_none() && adhesion.floor {
            return Err(value_error(
                "which cells are floor is not known, so that it cannot be adhesive by itself: give floor, a height, or leave out floor of the adhesion",
            ));
        }
        Ok(Self {
            system: match floor {
                Some((height, carries_load)) => system
                    .with_floor(Floor::AtOrBelow(height))
                    .with_floor_model(match carries_load {
                        true => FloorModel::Contact,
                        false => FloorModel::Ignored,
                    }),
                None => system,
            },
            file: None,
            bodies: bodies.map(Box::new),
            text: None,
        })
    }

    /// Reads a case file with a `[surface]`.
    #[staticmethod]
    fn read(path: PathBuf, overrides: Vec<String>, memory_limit: Option<usize>) -> PyResult<Self> {
        let file = CaseFile::read(&path).map_err(|error| case_error(&error))?;
        Self::of(file, &overrides, memory_limit)
    }

    /// Reads the text of a case file; `name` is used in error messages.
    #[staticmethod]
    fn parse(
        name: &str,
        text: &str,
        overrides: Vec<String>,
        memory_limit: Option<usize>,
    ) -> PyResult<Self> {
        let file = CaseFile::parse(name, text).map_err(|error| case_error(&error))?;
        Self::of(file, &overrides, memory_limit)
    }

    /// The case as a case file, if it was read from one.
    fn to_toml(&self) -> Option<&str> {
        self.text.as_deref()
    }

    /// The pillar of every cell, a row for every y and -1 for the floor, and the compliance of each pillar, m/N; `None` without pillars.
    fn pillars<'py>(&self, py: Python<'py>) -> PyResult<Option<Pillars<'py>>> {
        let grid = self.system.surface().grid();
        let Some(pillars) = self.system.surface().pillars() else {
            return Ok(None);
        };
        let label = |label: &u32| match *label {
            HeightMap::NO_PILLAR => -1,
            label => i64::from(label),
        };
        let labels = PyArray1::from_iter(py, pillars.labels.iter().map(label));
        Ok(Some((
            labels.reshape([grid.rows(), grid.columns()])?,
            PyArray1::from_slice(py, &pillars.compliance),
        )))
    }

    #[getter]
    fn reduced_modulus(&self) -> f64 {
        self.system.reduced_modulus()
    }

    /// Heights, m, a row for every y.
    fn heights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (surface, grid) = (self.system.surface(), self.system.surface().grid());
        let flat = PyArray1::from_slice(py, surface.heights());
        flat.reshape([grid.rows(), grid.columns()])
    }

    /// Sides of a cell, m.
    #[getter]
    fn cell(&self) -> [f64; 2] {
        self.system.surface().grid().cell()
    }

    /// Lower left corner, m from the lens axis.
    #[getter]
    fn origin(&self) -> Point {
        self.system.surface().grid().origin()
    }

    #[getter]
    fn periodic(&self) -> bool {
        self.system.boundary() == Boundary::Periodic
    }

    /// Values of the lens by their keys, if it is one.
    #[getter]
    fn lens<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let file = self.file.as_ref().or(self.bodies.as_deref());
        let (Some(_), Some(file)) = (self.system.indenter().lens(), file) else {
            return Ok(None);
        };
        let lens = file.lens_settings().map_err(|error| case_error(&error))?;
        by_key(py, &lens).map(Some)
    }

    /// Modulus and Poisson's ratio of an elastic plate.
    #[getter]
    fn plate(&self) -> Option<[f64; 2]> {
        match self.system.indenter() {
            Indenter::Flat(material) => {
                material.map(|material| [material.young_modulus, material.poisson_ratio])
            }
            Indenter::Lens(_) => None,
        }
    }

    #[getter]
    fn substrate(&self) -> [f64; 2] {
        let material = self.system.substrate();
        [material.young_modulus, material.poisson_ratio]
    }

    /// Works of adhesion on attachment and, if it differs, on detachment (J/m^2), and whether the floor is adhesive; `None` without adhesion.
    #[getter]
    fn adhesion(&self) -> Option<(f64, Option<f64>, bool)> {
        let adhesion = self.system.adhesion();
        (!adhesion.is_none()).then_some((adhesion.work, adhesion.work_receding, adhesion.floor))
    }

    /// The substrate and the lens as layers; `None` for half-spaces.
    #[getter]
    fn layers(&self) -> [Option<LayerNumbers>; 2] {
        self.system.layers().map(|layer| layer.map(numbers_of))
    }
}

/// Thickness (m), condition at the back, and modulus and Poisson's ratio of an elastic base.
pub(crate) type LayerNumbers = (f64, String, Option<[f64; 2]>);

pub(crate) fn layer_of((thickness, base, material): LayerNumbers) -> Layer {
    let base = match (base.as_str(), material) {
        ("elastic", Some([modulus, ratio])) => Base::Elastic(Material::new(modulus, ratio)),
        ("frictionless", _) => Base::Frictionless,
        _ => Base::Rigid,
    };
    Layer { thickness, base }
}

pub(crate) fn numbers_of(layer: &Layer) -> LayerNumbers {
    let (base, material) = match layer.base {
        Base::Rigid => ("rigid", None),
        Base::Frictionless => ("frictionless", None),
        Base::Elastic(base) => ("elastic", Some([base.young_modulus, base.poisson_ratio])),
    };
    (layer.thickness, base.to_owned(), material)
}

/// Pillars of the cells, and their compliances.
type Pillars<'py> = (Bound<'py, PyArray2<i64>>, Bound<'py, PyArray1<f64>>);

/// A contact on a height map.
#[pyclass(frozen, extends = Answer, module = "fakir._fakir")]
pub(crate) struct SurfaceContact {
    contact: fakir::state::SurfaceContact,
}

#[pymethods]
impl SurfaceContact {
    #[getter]
    fn mean_pressure(&self) -> f64 {
        self.contact.mean_pressure()
    }

    /// Pressure, gap and displacement, a row for every y.
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyArray2<f64>>; 3]> {
        let grid = &self.contact.grid;
        let array = |values: &[f64]| {
            let flat = PyArray1::from_slice(py, values);
            flat.reshape([grid.rows(), grid.columns()])
        };
        Ok([
            array(&self.contact.pressure)?,
            array(&self.contact.gap)?,
            array(&self.contact.displacement)?,
        ])
    }
}

/// The state in which the lens just reaches the floor of a height map.
#[pyclass(frozen, extends = Answer, module = "fakir._fakir")]
pub(crate) struct SurfaceTransition {
    #[pyo3(get)]
    contact: Py<SurfaceContact>,
}

/// The contact at an indentation (m) or under a force (N).
#[pyfunction]
pub(crate) fn press_surface(
    py: Python<'_>,
    surface: &Surface,
    indentation: Option<f64>,
    force: Option<f64>,
    options: Options,
) -> PyResult<Py<SurfaceContact>> {
    let load = load(indentation, force)?;
    let start = Instant::now();
    let contact = watched(py, &options, |run| surface.system.press(load, run))?;
    let contact = contact.map_err(|error| solve_error(&error))?;
    surface.contact(py, contact, start.elapsed().as_secs_f64())
}

/// Computes the state in which the lens just reaches the floor.
#[pyfunction]
pub(crate) fn surface_transition(
    py: Python<'_>,
    surface: &Surface,
    options: Options,
) -> PyResult<Py<SurfaceTransition>> {
    if surface.system.floor().is_none() {
        return Err(value_error(
            "which cells are floor is not known: give floor, a height",
        ));
    }
    let start = Instant::now();
    let found = watched(py, &options, |run| surface.system.transition(run))?;
    let found = found.map_err(|error| solve_error(&error))?;
    surface.reached(py, found, start.elapsed().as_secs_f64())
}

/// The object that `fakir approach --json` prints for a surface, the critical state, if any, and the other states.
type Loading = (
    String,
    Option<Py<SurfaceTransition>>,
    Vec<Py<SurfaceContact>>,
);

/// Computes the states of a loading in steps of the indentation (m).
#[pyfunction]
pub(crate) fn approach_surface(
    py: Python<'_>,
    surface: &Surface,
    step: f64,
    until: Option<f64>,
    to: Option<f64>,
    to_force: Option<f64>,
    options: Options,
) -> PyResult<Loading> {
    let path = path(step, until, to, to_force)?;
    let Approached {
        found,
        states,
        summary,
    } = approached(py, &surface.system, &path, &options)?;
    let critical = found
        .critical
        .map(|critical| surface.reached(py, critical, found.critical_time));
    let states = states
        .into_iter()
        .map(|(contact, time)| surface.contact(py, contact, time));
    Ok((
        summary,
        critical.transpose()?,
        states.collect::<PyResult<_>>()?,
    ))
}

/// Points of a curve: branch, indentation (m), force (N) and contact area (m^2).
pub(crate) type Curve = Vec<(&'static str, f64, f64, f64)>;

/// A cycle, its curve, and the contacts at the end of loading and at pull-off.
pub(crate) type Cycled = (
    Py<Answer>,
    Curve,
    Py<SurfaceContact>,
    Option<Py<SurfaceContact>>,
);

/// Loading up to an indentation (m), a force (N) or the critical state, and optional unloading.
#[pyfunction]
pub(crate) fn cycle_surface(
    py: Python<'_>,
    surface: &Surface,
    to: Option<f64>,
    to_force: Option<f64>,
    retract: bool,
    options: Options,
) -> PyResult<Cycled> {
    if surface.system.floor().is_none() && to.is_none() && to_force.is_none() {
        return Err(value_error(
            "without a floor there is no critical state at which the loading could end: give to or to_force",
        ));
    }
    let plan = plan(to, to_force, "displacement", None, retract);
    let start = Instant::now();
    let cycle = watched(py, &options, |run| surface.system.cycle(plan, run))?;
    let cycle = cycle.map_err(|error| solve_error(&error))?;
    cycle_answer(py, surface, cycle, start.elapsed().as_secs_f64())
}

/// A cycle on a surface.
pub(crate) fn cycle_answer(
    py: Python<'_>,
    surface: &Surface,
    cycle: fakir::state::SurfaceCycle,
    wall_time: f64,
) -> PyResult<Cycled> {
    let answer = SurfaceAnswer {
        system: &surface.system,
        answer: &cycle,
    };
    let summary = json(&result::surface_cycle(&answer, None, wall_time));
    let careful = result::surface_cycle_warnings(&cycle);
    let answer = Answer::new(&answer, summary, cycle.termination, careful);
    let point = |step: &fakir::state::SurfaceLoadStep| {
        let name = step.branch.name();
        (name, step.indentation, step.force, step.contact_area)
    };
    let curve = cycle.load_steps.iter().map(point).collect();
    let contact = |contact| surface.contact(py, contact, wall_time);
    Ok((
        Py::new(py, answer)?,
        curve,
        contact(cycle.turn)?,
        cycle.pull_off.map(contact).transpose()?,
    ))
}

/// The object that `fakir verify --json` prints for a surface, and the surfaces of both meshes with their contacts.
type Verified = (String, Vec<(Surface, Py<SurfaceContact>)>);

/// Solves the same problem on two meshes.
#[pyfunction]
pub(crate) fn verify_surface(
    py: Python<'_>,
    surface: &Surface,
    indentation: Option<f64>,
    force: Option<f64>,
    cells_per_diameter: usize,
    options: Options,
) -> PyResult<Verified> {
    let load = load_or_critical(indentation, force);
    let file = surface
        .file
        .as_ref()
        .ok_or_else(|| value_error(SurfaceVerifyError::OneMesh))?;
    let start = Instant::now();
    let found = watched(py, &options, |run| {
        surfaces::verify(file, load, cells_per_diameter, run, &|_| {})
    })?;
    let found = found.map_err(|error| surface_verify_error(&error))?;
    let wall_time = start.elapsed().as_secs_f64();
    let summary = json(&SurfaceVerifySummary::new(load, &found, wall_time));
    let answers = found.answers.into_iter().map(|answered| {
        let surface = Surface {
            text: Some(answered.case.to_toml()),
            system: answered.case.system,
            file: Some(file.clone()),
            bodies: None,
        };
        let contact = surface.contact(py, answered.answer, wall_time)?;
        Ok((surface, contact))
    });
    Ok((summary, answers.collect::<PyResult<_>>()?))
}

impl Surface {
    /// The system.
    pub(crate) fn system(&self) -> &SurfaceSystem {
        &self.system
    }

    /// The case file it was read from, if any.
    pub(crate) fn file(&self) -> Option<&CaseFile> {
        self.file.as_ref()
    }

    /// The case file it was read from, which is required to fit these quantities.
    pub(crate) fn of_file(&self, fitted: &str) -> PyResult<CaseFile> {
        self.file.clone().ok_or_else(|| {
            value_error(format!(
                "{fitted} are fitted or designed for a height map of a case file: save the heights as a file, and read the case with fakir.read_case"
            ))
        })
    }

    pub(crate) fn of(
        mut file: CaseFile,
        overrides: &[String],
        memory_limit: Option<usize>,
    ) -> PyResult<Self> {
        for setting in overrides {
            file.set(setting).map_err(|error| case_error(&error))?;
        }
        let run = Run {
            memory_limit,
            ..Run::default()
        };
        let case = file.surface_case(run.memory_limit());
        let case = case.map_err(|error| case_error(&error))?;
        file.refuse_absurd_heights(&case)
            .map_err(|error| case_error(&error))?;
        warn_of_file(&file)?;
        Ok(Self::of_case(case, file))
    }

    /// A case and the file that describes it.
    pub(crate) fn of_case(case: SurfaceCase, file: CaseFile) -> Self {
        Self {
            text: Some(case.to_toml()),
            system: case.system,
            file: Some(file),
            bodies: None,
        }
    }

    pub(crate) fn reached(
        &self,
        py: Python<'_>,
        found: fakir::state::SurfaceTransition,
        wall_time: f64,
    ) -> PyResult<Py<SurfaceTransition>> {
        let answer = SurfaceAnswer {
            system: &self.system,
            answer: &found,
        };
        let summary = json(&result::surface_transition(&answer, wall_time));
        let contact = &found.contact;
        let answer = Answer::new(&answer, summary, contact.termination, warnings(contact));
        let contact = self.contact(py, found.contact, wall_time)?;
        Py::new(py, (SurfaceTransition { contact }, answer))
    }

    pub(crate) fn contact(
        &self,
        py: Python<'_>,
        contact: fakir::state::SurfaceContact,
        wall_time: f64,
    ) -> PyResult<Py<SurfaceContact>> {
        let answer = SurfaceAnswer {
            system: &self.system,
            answer: &contact,
        };
        let summary = json(&result::surface_press(&answer, wall_time));
        let answer = Answer::new(&answer, summary, contact.termination, warnings(&contact));
        Py::new(py, (SurfaceContact { contact }, answer))
    }
}
