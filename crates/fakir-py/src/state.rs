//! Contact states, and the functions that compute them.

use crate::answer::{Answer, warnings};
use crate::case::Case;
use crate::error::solve_error;
use crate::load::{Approached, approached, load, load_or_critical, path, plan};
use crate::samples::{Field, arrays, floor_cells, points};
use crate::study::columns;
use crate::watched::{Options, watched};
use fakir::problem::{ElementMesh, Method, Point};
use fakir::state::{ContactState, CriticalState, FieldSamples, Run};
use fakir_study::record::GradientObject;
use fakir_study::result::{
    self, CycleSummary, VerifySummary, cycle_warnings, json, pillars, pillars_of,
};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use std::time::Instant;

/// A contact under a load.
#[pyclass(frozen, extends = Answer, module = "fakir._fakir")]
pub(crate) struct State {
    state: ContactState,
}

#[pymethods]
impl State {
    /// Centres of the floor cells in contact along x and y (m), and the pressure on each (Pa); `None` if the floor carries no load.
    fn floor_cells<'py>(&self, py: Python<'py>) -> Option<[Field<'py>; 3]> {
        Some(floor_cells(py, self.state.floor.as_ref()?))
    }

    #[getter]
    fn case(&self) -> Case {
        fakir_case::Case::new(self.state.system.clone(), self.state.method).into()
    }

    #[getter]
    fn smallest_gap_position(&self) -> Point {
        self.state.smallest_gap_position
    }

    /// The touched pillars: the columns of `pillars.csv` by name.
    fn pillars<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        columns(py, &pillars(&self.state))?.into_py_dict(py)
    }

    /// Displacement, gap and pressure at points; `None` for methods that do not resolve pillars.
    fn sample<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
        y: PyReadonlyArray1<'py, f64>,
        options: Options,
    ) -> PyResult<Option<[Field<'py>; 3]>> {
        let points = points(&x, &y)?;
        let samples = watched(py, &options, |run| self.state.sample(&points, run))?;
        samples
            .map(|samples| Some(arrays(py, samples?)))
            .map_err(|error| solve_error(&error))
    }

    /// Displacement and gap at the points of a grid, `x` fastest, and mean pressures over its cells; `None` for methods that do not resolve
    /// pillars.
    fn grid<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
        y: PyReadonlyArray1<'py, f64>,
        options: Options,
    ) -> PyResult<Option<[Field<'py>; 3]>> {
        let (x, y) = (x.as_slice()?, y.as_slice()?);
        let samples = watched(py, &options, |run| self.state.sample_on_grid(x, y, run))?;
        samples
            .map(|samples| Some(arrays(py, samples?)))
            .map_err(|error| solve_error(&error))
    }

    /// Whether points are on a pillar top.
    fn on_pillar<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
        y: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let tops = self.state.system.tops();
        let on_pillar = points(&x, &y)?.into_iter().map(|point| tops.holds(point));
        Ok(PyArray1::from_iter(py, on_pillar))
    }
}

/// Returns an error if fields at so many points exceed the memory limit, including the Python arrays: coordinates twice, and the fields.
#[pyfunction]
pub(crate) fn check_points(points: usize, memory_limit: Option<usize>) -> PyResult<()> {
    const BYTES_IN_PYTHON: usize = 56;
    let run = Run {
        memory_limit,
        ..Run::default()
    };
    FieldSamples::check_memory(points, BYTES_IN_PYTHON, &run).map_err(|error| solve_error(&error))
}

/// A critical state.
#[pyclass(frozen, extends = Answer, module = "fakir._fakir")]
pub(crate) struct Critical {
    /// The contact at the transition.
    #[pyo3(get)]
    state: Py<State>,
}

impl State {
    pub(crate) fn new(py: Python<'_>, state: ContactState, wall_time: f64) -> PyResult<Py<Self>> {
        let summary = json(&result::press(&state, None, None, wall_time));
        let answer = Answer::new(&state, summary, state.termination, warnings(&state));
        Py::new(py, (Self { state }, answer))
    }
}

impl Critical {
    pub(crate) fn new(
        py: Python<'_>,
        critical: CriticalState,
        wall_time: f64,
    ) -> PyResult<Py<Self>> {
        let summary = json(&result::transition(&critical, None, None, wall_time));
        let contact = &critical.contact;
        let answer = Answer::new(&critical, summary, contact.termination, warnings(contact));
        let state = State::new(py, critical.contact, wall_time)?;
        Py::new(py, (Self { state }, answer))
    }
}

/// Computes the critical state.
#[pyfunction]
pub(crate) fn transition(py: Python<'_>, case: &Case, options: Options) -> PyResult<Py<Critical>> {
    let (system, method) = (case.case.system.clone(), case.case.method);
    let start = Instant::now();
    let critical = watched(py, &options, |run| fakir::transition(&system, method, run))?;
    let critical = critical.map_err(|error| solve_error(&error))?;
    Critical::new(py, critical, start.elapsed().as_secs_f64())
}

/// Computes the contact at an indentation (m) or under a force (N).
#[pyfunction]
pub(crate) fn press(
    py: Python<'_>,
    case: &Case,
    indentation: Option<f64>,
    force: Option<f64>,
    options: Options,
) -> PyResult<Py<State>> {
    let load = load(indentation, force)?;
    let (system, method) = (case.case.system.clone(), case.case.method);
    let start = Instant::now();
    let state = watched(py, &options, |run| fakir::press(&system, load, method, run))?;
    let state = state.map_err(|error| solve_error(&error))?;
    State::new(py, state, start.elapsed().as_secs_f64())
}

/// Computes the contact at an indentation (m) or under a force (N), or the critical state if neither is given; also returns the object that
/// `--gradient` adds to the JSON output.
#[pyfunction]
pub(crate) fn gradient(
    py: Python<'_>,
    case: &Case,
    indentation: Option<f64>,
    force: Option<f64>,
    options: Options,
) -> PyResult<(Py<State>, String)> {
    let load = load_or_critical(indentation, force);
    let (system, method) = (case.case.system.clone(), case.case.method);
    let start = Instant::now();
    let found = watched(py, &options, |run| {
        fakir::gradient(&system, load, method, run)
    })?;
    let found = found.map_err(|error| solve_error(&error))?;
    let summary = json(&GradientObject::from(&found));
    let state = State::new(py, found.contact, start.elapsed().as_secs_f64())?;
    Ok((state, summary))
}

/// The object that `fakir approach --json` prints, the critical state, and the other states.
type Loading = (String, Option<Py<Critical>>, Vec<Py<State>>);

/// Computes the states of a loading in steps of the indentation (m).
#[pyfunction]
pub(crate) fn approach(
    py: Python<'_>,
    case: &Case,
    step: f64,
    until: Option<f64>,
    to: Option<f64>,
    to_force: Option<f64>,
    options: Options,
) -> PyResult<Loading> {
    let path = path(step, until, to, to_force)?;
    let problem = case.case.clone();
    let Approached {
        found,
        states,
        summary,
    } = approached(py, &problem, &path, &options)?;
    let time = found.critical_time;
    let critical = found.critical.map(|it| Critical::new(py, it, time));
    let states = states
        .into_iter()
        .map(|(it, time)| State::new(py, it, time));
    Ok((
        summary,
        critical.transpose()?,
        states.collect::<PyResult<_>>()?,
    ))
}

/// Loading and unloading.
#[pyclass(frozen, extends = Answer, module = "fakir._fakir")]
pub(crate) struct Cycle {
    #[pyo3(get)]
    critical: Option<Py<Critical>>,
    /// The columns of the pillars attached at pull-off.
    #[pyo3(get)]
    pull_off_pillars: Option<Py<PyDict>>,
}

impl Cycle {
    pub(crate) fn new(
        py: Python<'_>,
        cycle: fakir::state::Cycle,
        wall_time: f64,
    ) -> PyResult<Py<Self>> {
        let summary = json(&CycleSummary::new(&cycle, wall_time));
        let answer = Answer::new(&cycle, summary, cycle.termination, cycle_warnings(&cycle));
        let pulling = cycle.pull_off.as_ref();
        let pulling = pulling.map(|it| columns(py, &pillars_of(&it.pillars))?.into_py_dict(py));
        let critical = cycle
            .critical
            .map(|critical| Critical::new(py, critical, wall_time));
        let cycle = Self {
            critical: critical.transpose()?,
            pull_off_pillars: pulling.transpose()?.map(Bound::unbind),
        };
        Py::new(py, (cycle, answer))
    }
}

/// Loading up to an indentation (m), a force (N) or the critical state, and optional unloading; a stiffness (N/m) is that of the testing
/// machine that drives the lens.
#[pyfunction]
pub(crate) fn cycle(
    py: Python<'_>,
    case: &Case,
    to: Option<f64>,
    to_force: Option<f64>,
    drive: &str,
    machine_stiffness: Option<f64>,
    retract: bool,
    options: Options,
) -> PyResult<Py<Cycle>> {
    let plan = plan(to, to_force, drive, machine_stiffness, retract);
    let (system, method) = (case.case.system.clone(), case.case.method);
    let start = Instant::now();
    let found = watched(py, &options, |run| fakir::cycle(&system, plan, method, run))?;
    let cycle = found.map_err(|error| solve_error(&error))?;
    Cycle::new(py, cycle, start.elapsed().as_secs_f64())
}

/// The object that `fakir compare --json` prints, and the critical states by method.
type Compared = (String, Vec<(&'static str, Py<Critical>)>);

/// Computes the critical state with every method.
#[pyfunction]
pub(crate) fn compare(py: Python<'_>, case: &Case, options: Options) -> PyResult<Compared> {
    let system = case.case.system.clone();
    let (found, states) = watched(py, &options, |run| {
        let mut states = Vec::new();
        let mut keep = |method, critical, wall_time| {
            states.push((method, critical, wall_time));
        };
        let found = fakir_study::compare::compare(&system, run, &|_| {}, &mut keep);
        (found, states)
    })?;
    let found = found.map_err(|error| solve_error(&error))?;
    let states = states
        .into_iter()
        .map(|(method, critical, time)| Ok((method, Critical::new(py, critical, time)?)));
    Ok((json(&found.summary), states.collect::<PyResult<_>>()?))
}

/// The object that `fakir verify --json` prints, and the states, the spectral one first.
type Verified = (String, Vec<Py<State>>);

/// Verifies the critical state, or a contact under a load, with a second method.
#[pyfunction]
pub(crate) fn verify(
    py: Python<'_>,
    case: &Case,
    indentation: Option<f64>,
    force: Option<f64>,
    cells_per_diameter: usize,
    options: Options,
) -> PyResult<Verified> {
    let load = load_or_critical(indentation, force);
    let mesh = match case.case.method {
        Method::Love(mesh) => mesh,
        _ => ElementMesh::default(),
    };
    let mesh = ElementMesh {
        cells_per_diameter,
        ..mesh
    };
    let system = case.case.system.clone();
    let start = Instant::now();
    let answer = watched(py, &options, |run| fakir::verify(&system, load, mesh, run))?;
    let answer = answer.map_err(|error| solve_error(&error))?;
    let wall_time = start.elapsed().as_secs_f64();
    let summary = VerifySummary::new(load, &answer, wall_time);
    let [coarse, fine] = answer.elements;
    let states = [answer.spectral, coarse, fine].into_iter();
    let states = states.map(|state| State::new(py, state, wall_time));
    Ok((json(&summary), states.collect::<PyResult<_>>()?))
}
