//! Contact states, and the computations that give them.

use crate::case::Case;
use crate::error::{approach_error, solve_error};
use crate::load::{load, load_or_critical, path};
use crate::study::columns;
use crate::watched::{Options, watched};
use fakir::problem::{CyclePlan, Drive, ElementMesh, Method, Point};
use fakir::state::{ContactState, CriticalState, FieldSamples, Run};
use fakir_study::record::GradientObject;
use fakir_study::result::{
    self, ApproachSummary, CycleSummary, VerifySummary, json, pillars, pillars_of,
};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use std::time::Instant;

/// A contact under a load.
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct State {
    state: ContactState,
    wall_time: f64,
}

type Field<'py> = Bound<'py, PyArray1<f64>>;

#[pymethods]
impl State {
    /// Centres along x and y of the floor's cells in contact (m), and the pressure on each (Pa); none if the floor
    /// bears nothing.
    fn floor_cells<'py>(&self, py: Python<'py>) -> Option<[Field<'py>; 3]> {
        let floor = self.state.floor.as_ref()?;
        let along = |axis: usize| floor.centres().map(move |centre| centre[axis]);
        Some([
            PyArray1::from_iter(py, along(0)),
            PyArray1::from_iter(py, along(1)),
            PyArray1::from_slice(py, &floor.pressure),
        ])
    }

    /// The object that `fakir press --json` prints.
    fn json(&self) -> String {
        json(&result::press(&self.state, None, None, self.wall_time))
    }

    #[getter]
    fn case(&self) -> Case {
        fakir_case::Case::new(self.state.system.clone(), self.state.method).into()
    }

    #[getter]
    fn smallest_gap_position(&self) -> Point {
        self.state.smallest_gap_position
    }

    #[getter]
    fn termination(&self) -> &'static str {
        self.state.termination.description()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        let words = self.state.warnings.iter().map(ToString::to_string);
        words
            .chain(self.state.unresolved().map(|it| it.to_string()))
            .collect()
    }

    /// The touched pillars: the names of `pillars.csv`, each with a column.
    fn pillars<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        columns(py, &pillars(&self.state))?.into_py_dict(py)
    }

    /// Displacement, gap and pressure at points; none from methods that do not resolve pillars.
    fn sample<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
        y: PyReadonlyArray1<'py, f64>,
        options: Options,
    ) -> PyResult<Option<[Field<'py>; 3]>> {
        let points: Vec<Point> = x
            .as_slice()?
            .iter()
            .zip(y.as_slice()?)
            .map(|(x, y)| [*x, *y])
            .collect();
        let samples = watched(py, &options, |run| self.state.sample(&points, run))?;
        samples
            .map(|samples| Some(arrays(py, samples?)))
            .map_err(|error| solve_error(&error))
    }

    /// Displacement and gap at the points of a grid, `x` fastest, and mean pressures over its cells;
    /// none from methods that do not resolve pillars.
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

    /// Which points are on a pillar top.
    fn on_pillar<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
        y: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let tops = self.state.system.tops();
        let on_pillar = |(x, y): (&f64, &f64)| tops.holds([*x, *y]);
        let points = x.as_slice()?.iter().zip(y.as_slice()?);
        Ok(PyArray1::from_iter(py, points.map(on_pillar)))
    }
}

fn arrays(py: Python<'_>, samples: FieldSamples) -> [Field<'_>; 3] {
    let FieldSamples {
        displacement,
        gap,
        pressure,
    } = samples;
    [displacement, gap, pressure].map(|field| PyArray1::from_vec(py, field))
}

/// Whether fields at so many points fit the memory allowed, with the arrays of Python: coordinates
/// twice, and the fields.
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
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct Critical {
    critical: CriticalState,
    wall_time: f64,
}

#[pymethods]
impl Critical {
    /// The object that `fakir transition --json` prints.
    fn json(&self) -> String {
        json(&result::transition(
            &self.critical,
            None,
            None,
            self.wall_time,
        ))
    }

    /// The contact at the transition.
    #[getter]
    fn state(&self) -> State {
        State {
            state: self.critical.contact.clone(),
            wall_time: self.wall_time,
        }
    }
}

impl State {
    pub(crate) fn new(state: ContactState, wall_time: f64) -> Self {
        Self { state, wall_time }
    }
}

impl Critical {
    pub(crate) fn new(critical: CriticalState, wall_time: f64) -> Self {
        Self {
            critical,
            wall_time,
        }
    }
}

/// The critical state.
#[pyfunction]
pub(crate) fn transition(py: Python<'_>, case: &Case, options: Options) -> PyResult<Critical> {
    let (system, method) = (case.case.system.clone(), case.case.method);
    let start = Instant::now();
    let critical = watched(py, &options, |run| fakir::transition(&system, method, run))?;
    Ok(Critical {
        critical: critical.map_err(|error| solve_error(&error))?,
        wall_time: start.elapsed().as_secs_f64(),
    })
}

/// The contact at an indentation (m) or under a force (N).
#[pyfunction]
pub(crate) fn press(
    py: Python<'_>,
    case: &Case,
    indentation: Option<f64>,
    force: Option<f64>,
    options: Options,
) -> PyResult<State> {
    let load = load(indentation, force)?;
    let (system, method) = (case.case.system.clone(), case.case.method);
    let start = Instant::now();
    let state = watched(py, &options, |run| fakir::press(&system, load, method, run))?;
    Ok(State {
        state: state.map_err(|error| solve_error(&error))?,
        wall_time: start.elapsed().as_secs_f64(),
    })
}

/// The contact at an indentation (m) or under a force (N), or the critical state if neither is given; and the object that `--gradient` adds to
/// what the program prints.
#[pyfunction]
pub(crate) fn gradient(
    py: Python<'_>,
    case: &Case,
    indentation: Option<f64>,
    force: Option<f64>,
    options: Options,
) -> PyResult<(State, String)> {
    let load = load_or_critical(indentation, force);
    let (system, method) = (case.case.system.clone(), case.case.method);
    let start = Instant::now();
    let found = watched(py, &options, |run| {
        fakir::gradient(&system, load, method, run)
    })?;
    let found = found.map_err(|error| solve_error(&error))?;
    let summary = json(&GradientObject::from(&found));
    let state = State::new(found.contact, start.elapsed().as_secs_f64());
    Ok((state, summary))
}

/// The object that `fakir approach --json` prints, the critical state, and the other states.
type Loading = (String, Option<Critical>, Vec<State>);

/// The states of a loading by steps of the indentation (m).
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
    let problem = (case.case.system.clone(), case.case.method);
    let (found, states) = watched(py, &options, |run| {
        let mut states = Vec::new();
        let mut keep = |state, wall_time| states.push(State { state, wall_time });
        let found = fakir_study::approach::approach(&problem, &path, run, &|_| {}, &mut keep);
        (found, states)
    })?;
    let found = found.map_err(|error| approach_error(&error))?;
    let summary = json(&ApproachSummary::new(&problem, &found));
    let time = found.critical_time;
    let critical = found.critical.map(|critical| Critical::new(critical, time));
    Ok((summary, critical, states))
}

/// The object that `fakir cycle --json` prints, the critical state, the columns of the pillars that hold at pull-off, and
/// how the computation ended.
pub(crate) type Cycled<'py> = (
    String,
    Option<Critical>,
    Option<Bound<'py, PyDict>>,
    &'static str,
);

/// Loading up to an indentation (m), a force (N) or the critical state, and unloading if it is to be; a stiffness (N/m) is that of the
/// machine that drives the lens.
#[pyfunction]
pub(crate) fn cycle<'py>(
    py: Python<'py>,
    case: &Case,
    to: Option<f64>,
    to_force: Option<f64>,
    drive: &str,
    machine_stiffness: Option<f64>,
    retract: bool,
    options: Options,
) -> PyResult<Cycled<'py>> {
    let drive = match (drive, machine_stiffness) {
        (_, Some(stiffness)) => Drive::Machine(stiffness),
        ("force", None) => Drive::Force,
        _ => Drive::Displacement,
    };
    let plan = CyclePlan {
        turn: load_or_critical(to, to_force).into(),
        drive,
        retract,
    };
    let (system, method) = (case.case.system.clone(), case.case.method);
    let start = Instant::now();
    let found = watched(py, &options, |run| fakir::cycle(&system, plan, method, run))?;
    let cycle = found.map_err(|error| solve_error(&error))?;
    cycled(py, cycle, start.elapsed().as_secs_f64())
}

/// What Python has of a cycle that was found in some time, s.
pub(crate) fn cycled(
    py: Python<'_>,
    cycle: fakir::state::Cycle,
    time: f64,
) -> PyResult<Cycled<'_>> {
    let summary = json(&CycleSummary::new(&cycle, time));
    let pulling = cycle.pull_off.as_ref();
    let pulling = pulling.map(|it| columns(py, &pillars_of(&it.pillars))?.into_py_dict(py));
    let critical = cycle.critical.map(|critical| Critical::new(critical, time));
    let ended = cycle.termination.description();
    Ok((summary, critical, pulling.transpose()?, ended))
}

/// The object that `fakir compare --json` prints, and the critical states by method.
type Compared = (String, Vec<(&'static str, Critical)>);

/// The critical state by every method.
#[pyfunction]
pub(crate) fn compare(py: Python<'_>, case: &Case, options: Options) -> PyResult<Compared> {
    let system = case.case.system.clone();
    let (found, states) = watched(py, &options, |run| {
        let mut states = Vec::new();
        let mut keep = |method, critical, wall_time| {
            states.push((method, Critical::new(critical, wall_time)));
        };
        let found = fakir_study::compare::compare(&system, run, &|_| {}, &mut keep);
        (found, states)
    })?;
    let found = found.map_err(|error| solve_error(&error))?;
    Ok((json(&found.summary), states))
}

/// The object that `fakir verify --json` prints, and the states, the spectral one first.
type Verified = (String, Vec<State>);

/// A second opinion on the critical state, or on a contact under a load.
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
    let states = [answer.spectral, coarse, fine].map(|state| State { state, wall_time });
    Ok((json(&summary), states.into()))
}
