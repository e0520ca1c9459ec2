//! Flat surfaces.

use crate::answer::{Answer, warnings};
use crate::error::{PYTHON, case_error, solve_error, warn_of_file};
use crate::load::{Approached, approached, load, path, plan};
use crate::samples::{Field, arrays};
use crate::settings::settings;
use crate::watched::{Options, watched};
use fakir::problem::Point;
use fakir::solve::flat::fields::FlatFields;
use fakir::state::{FlatContact, FlatCycle};
use fakir_case::{CaseFile, FlatCase, Key, Setting};
use fakir_study::record::{FlatAnswer, GradientObject};
use fakir_study::result::{self, SurfaceVerifySummary, flat_press, json};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::time::Instant;

/// A validated case with a flat surface.
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct Flat {
    pub(crate) file: CaseFile,
    case: FlatCase,
}

#[pymethods]
impl Flat {
    /// Creates a case from numbers in SI units and words, by their keys.
    #[staticmethod]
    fn build(numbers: Vec<(String, f64)>, words: Vec<(String, String)>) -> PyResult<Self> {
        let file = CaseFile::from_settings(PYTHON, settings(numbers, words)?);
        Self::of(file, &[])
    }

    /// Reads the text of a case file; `name` is used in error messages.
    #[staticmethod]
    fn parse(name: &str, text: &str, overrides: Vec<String>) -> PyResult<Self> {
        let file = CaseFile::parse(name, text).map_err(|error| case_error(&error))?;
        Self::of(file, &overrides)
    }

    /// Reads a case file.
    #[staticmethod]
    fn read(path: PathBuf, overrides: Vec<String>) -> PyResult<Self> {
        let file = CaseFile::read(&path).map_err(|error| case_error(&error))?;
        Self::of(file, &overrides)
    }

    /// The case with other settings.
    fn with_settings(&self, settings: Vec<String>) -> PyResult<Self> {
        Self::of(self.file.clone(), &settings)
    }

    /// The case as a case file.
    fn to_toml(&self) -> String {
        self.case.to_toml()
    }

    /// Numbers in SI units and words of the given keys.
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let values = PyDict::new(py);
        for key in Key::ALL {
            match self.case.setting(key) {
                Some(Setting::Number(number)) => values.set_item(key.path(), number)?,
                Some(Setting::Word(word)) => values.set_item(key.path(), word)?,
                None => {}
            }
        }
        Ok(values)
    }

    /// `E*`, Pa.
    #[getter]
    fn reduced_modulus(&self) -> f64 {
        self.case.system.reduced_modulus()
    }

    /// Displacement (m), gap (m) and pressure (Pa) at distances from the lens axis (m), of the contact with this radius and indentation (m).
    fn sample<'py>(
        &self,
        py: Python<'py>,
        contact_radius: f64,
        indentation: f64,
        distances: PyReadonlyArray1<'py, f64>,
        options: Options,
    ) -> PyResult<[Field<'py>; 3]> {
        let points: Vec<Point> = distances.as_slice()?.iter().map(|at| [*at, 0.0]).collect();
        let farthest = points
            .iter()
            .fold(0.0, |most: f64, at| most.max(at[0].abs()));
        let fields = FlatFields::of_disc(&self.case.system, contact_radius, indentation, farthest);
        let samples = watched(py, &options, |run| fields.sample(&points, run))?;
        Ok(arrays(py, samples.map_err(|error| solve_error(&error))?))
    }
}

impl Flat {
    pub(crate) fn of(mut file: CaseFile, overrides: &[String]) -> PyResult<Self> {
        for setting in overrides {
            file.set(setting).map_err(|error| case_error(&error))?;
        }
        let case = file.flat_case().map_err(|error| case_error(&error))?;
        warn_of_file(&file)?;
        Ok(Self { file, case })
    }

    /// The case.
    pub(crate) fn case(&self) -> &FlatCase {
        &self.case
    }

    /// A contact of the case.
    pub(crate) fn answer(&self, contact: &FlatContact, wall_time: f64) -> Answer {
        let answer = FlatAnswer {
            system: &self.case.system,
            contact,
        };
        let summary = json(&flat_press(&answer, None, wall_time));
        Answer::new(&answer, summary, contact.termination, warnings(contact))
    }
}

/// The contact with a flat surface at an indentation (m) or under a force (N).
#[pyfunction]
pub(crate) fn press_flat(
    py: Python<'_>,
    flat: &Flat,
    indentation: Option<f64>,
    force: Option<f64>,
    options: Options,
) -> PyResult<Answer> {
    let load = load(indentation, force)?;
    let start = Instant::now();
    let contact = watched(py, &options, |run| flat.case.system.press(load, run))?;
    let contact = contact.map_err(|error| solve_error(&error))?;
    Ok(flat.answer(&contact, start.elapsed().as_secs_f64()))
}

/// The contact with a flat surface, and the object that `--gradient` adds to the JSON output.
#[pyfunction]
pub(crate) fn gradient_flat(
    py: Python<'_>,
    flat: &Flat,
    indentation: Option<f64>,
    force: Option<f64>,
    options: Options,
) -> PyResult<(Answer, String)> {
    let load = load(indentation, force)?;
    let start = Instant::now();
    let found = watched(py, &options, |run| flat.case.system.gradient(load, run))?;
    let found = found.map_err(|error| solve_error(&error))?;
    let summary = json(&GradientObject::from(&found));
    let answer = flat.answer(&found.contact, start.elapsed().as_secs_f64());
    Ok((answer, summary))
}

/// The object that `fakir verify --json` prints for a flat surface, and the contact as one disc.
#[pyfunction]
pub(crate) fn verify_flat(
    py: Python<'_>,
    flat: &Flat,
    indentation: Option<f64>,
    force: Option<f64>,
    cells: usize,
    options: Options,
) -> PyResult<(String, Answer)> {
    let load = load(indentation, force)?;
    let system = &flat.case.system;
    let start = Instant::now();
    let found = watched(py, &options, |run| {
        fakir::verify_flat(system, load, cells, run)
    })?;
    let found = found.map_err(|error| solve_error(&error))?;
    let wall_time = start.elapsed().as_secs_f64();
    let summary = json(&SurfaceVerifySummary::of_flat(
        system, load, &found, wall_time,
    ));
    Ok((summary, flat.answer(&found.disc, wall_time)))
}

/// The object that `fakir approach --json` prints, and the states.
#[pyfunction]
pub(crate) fn approach_flat(
    py: Python<'_>,
    flat: &Flat,
    step: f64,
    until: Option<f64>,
    to: Option<f64>,
    to_force: Option<f64>,
    options: Options,
) -> PyResult<(String, Vec<Py<Answer>>)> {
    let path = path(step, until, to, to_force)?;
    let Approached {
        states, summary, ..
    } = approached(py, &flat.case, &path, &options)?;
    let states = states
        .into_iter()
        .map(|(contact, time)| Py::new(py, flat.answer(&contact, time)));
    Ok((summary, states.collect::<PyResult<_>>()?))
}

/// Points of a curve: branch, indentation (m), force (N) and contact radius (m).
pub(crate) type Curve = Vec<(&'static str, f64, f64, f64)>;

/// Loading up to an indentation (m) or a force (N), and optional unloading; a stiffness (N/m) is that of the testing machine.
#[pyfunction]
pub(crate) fn cycle_flat(
    py: Python<'_>,
    flat: &Flat,
    to: Option<f64>,
    to_force: Option<f64>,
    drive: &str,
    machine_stiffness: Option<f64>,
    retract: bool,
    options: Options,
) -> PyResult<(Py<Answer>, Curve)> {
    let plan = plan(to, to_force, drive, machine_stiffness, retract);
    let start = Instant::now();
    let cycle = watched(py, &options, |run| flat.case.system.cycle(&plan, run))?;
    let cycle = cycle.map_err(|error| solve_error(&error))?;
    cycle_answer(py, flat, &cycle, start.elapsed().as_secs_f64())
}

/// A cycle of a case, with the points of its curve.
pub(crate) fn cycle_answer(
    py: Python<'_>,
    flat: &Flat,
    cycle: &FlatCycle,
    wall_time: f64,
) -> PyResult<(Py<Answer>, Curve)> {
    let summary = json(&result::flat_cycle(
        cycle,
        &flat.case.system,
        None,
        wall_time,
    ));
    let (ended, careful) = (cycle.turn.termination, warnings(&cycle.turn));
    let answer = Py::new(py, Answer::new(cycle, summary, ended, careful))?;
    let point = |step: &fakir::state::FlatLoadStep| {
        let name = step.branch.name();
        (name, step.indentation, step.force, step.contact_radius)
    };
    Ok((answer, cycle.load_steps.iter().map(point).collect()))
}
