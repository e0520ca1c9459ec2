//! Pillars with rounded tops.

use crate::answer::Answer;
use crate::error::{
    PYTHON, case_error, pillar_heights_error, solve_error, value_error, warn_of_file,
};
use crate::load::{Approached, approached, load, load_or_critical, path, plan};
use crate::samples::{Field, arrays, floor_cells, points};
use crate::settings::{BodySettings, by_key, settings};
use crate::study::{PyColumns, columns};
use crate::surface::{LayerNumbers, layer_of, numbers_of};
use crate::watched::{Options, watched};
use fakir::problem::{
    Accuracy, Adhesion, Asperity, AsperityArray, Indenter, Material, PillarCompliance,
};
use fakir::state;
use fakir_case::{AsperityCase, CaseFile};
use fakir_inverse::HeightsSummary;
use fakir_inverse::heights::{Curve, WantedPoint};
use fakir_inverse::pillar_heights::design_pillars;
use fakir_study::record::{AsperityAnswer, AsperityCritical, GradientObject};
use fakir_study::result::{
    self, SurfaceVerifySummary, asperity_cycle, asperity_cycle_warnings, asperity_pillars,
    asperity_press, asperity_warnings, json,
};
use fakir_study::workshop::Relief;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::time::Instant;

/// Pillars with rounded tops, and the indenter.
#[pyclass(frozen, skip_from_py_object, module = "fakir._fakir")]
#[derive(Clone)]
pub(crate) struct Asperities {
    case: AsperityCase,
}

#[pymethods]
impl Asperities {
    /// `pillars` contains x, y, height above the floor, and diameter (m), which is NaN if not defined; `lens` contains the numbers and words
    /// of the keys of both bodies, `plate` modulus and Poisson's ratio, or neither for a rigid plate; `layers` are the substrate and the indenter if they are not half-spaces, `adhesion` the works of adhesion where contact is made and broken, and whether the floor is adhesive.
    #[new]
    fn new(
        pillars: Vec<[f64; 4]>,
        top_radius: f64,
        height: f64,
        lens: Option<BodySettings>,
        plate: Option<[f64; 2]>,
        substrate: [f64; 2],
        layers: [Option<LayerNumbers>; 2],
        column: bool,
        accurate: bool,
        adhesion: Option<(f64, Option<f64>, bool)>,
    ) -> PyResult<Self> {
        let material = |[modulus, ratio]: [f64; 2]| Material::new(modulus, ratio);
        let (indenter, lens) = match lens {
            Some((numbers, words)) => {
                let file = CaseFile::from_settings(PYTHON, settings(numbers, words)?);
                let lens = file.shaped_lens().map_err(|error| case_error(&error))?;
                let keys = file.lens_settings().map_err(|error| case_error(&error))?;
                (Indenter::from(lens), keys)
            }
            None => (Indenter::Flat(plate.map(material)), Vec::new()),
        };
        let asperity = |[x, y, own, diameter]: [f64; 4]| Asperity {
            rim_radius: (!diameter.is_nan()).then_some(0.5 * diameter),
            ..Asperity::new([x, y], top_radius).raised_by(own - height)
        };
        let asperities = pillars.into_iter().map(asperity).collect();
        let field =
            AsperityArray::new(indenter, material(substrate), asperities).map_err(value_error)?;
        let [film, of_indenter] = layers.map(|layer| layer.map(layer_of));
        let field = field.with_layers(film, of_indenter).map_err(value_error)?;
        let field = match adhesion {
            Some((work, work_receding, floor)) => field
                .with_adhesion(Adhesion {
                    work,
                    work_receding,
                    floor,
                })
                .map_err(value_error)?,
            None => field,
        };
        let accuracy = if accurate {
            Accuracy::Accurate
        } else {
            Accuracy::Default
        };
        let compliance = if column {
            PillarCompliance::Column
        } else {
            PillarCompliance::None
        };
        let case = AsperityCase::new(field, accuracy, height, compliance, lens);
        let case = case.map_err(value_error)?;
        Ok(Self { case })
    }

    /// Reads a case file with `pattern.top_radius`.
    #[staticmethod]
    fn read(path: PathBuf, overrides: Vec<String>) -> PyResult<Self> {
        let file = CaseFile::read(&path).map_err(|error| case_error(&error))?;
        Self::of(file, &overrides)
    }

    /// Reads the text of a case file; `name` is used in error messages.
    #[staticmethod]
    fn parse(name: &str, text: &str, overrides: Vec<String>) -> PyResult<Self> {
        let file = CaseFile::parse(name, text).map_err(|error| case_error(&error))?;
        Self::of(file, &overrides)
    }

    /// The case as a case file that reads the pillars from a table of that name.
    fn to_toml(&self, table: &str) -> String {
        self.case.to_toml_with_table(table)
    }

    /// The table read by such a file.
    fn table(&self) -> String {
        self.case.pillar_table()
    }

    /// The surface as a binary STL file, lengths in mm.
    fn stl(&self) -> Vec<u8> {
        Relief::new(&self.case.field, self.case.height).stl()
    }

    /// x and y from the lens axis, height above the floor, and diameter of every pillar, m; the diameter is NaN if not defined.
    fn pillars(&self) -> Vec<[f64; 4]> {
        let asperities = self.case.field.asperities().iter().zip(self.case.heights());
        let row = |(asperity, height): (&Asperity, f64)| {
            let [x, y] = asperity.apex;
            let diameter = asperity.rim_radius.map_or(f64::NAN, |rim| 2.0 * rim);
            [x, y, height, diameter]
        };
        asperities.map(row).collect()
    }

    /// Height of the common pillar, m.
    #[getter]
    fn height(&self) -> f64 {
        self.case.height
    }

    /// Radius of curvature of the tops, m.
    #[getter]
    fn top_radius(&self) -> f64 {
        self.case
            .field
            .asperities()
            .first()
            .map_or(f64::NAN, |asperity| asperity.top_radius)
    }

    /// Values of a lens by their keys; none for a level plate.
    #[getter]
    fn lens<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let lens = self.case.lens_settings();
        (!lens.is_empty()).then(|| by_key(py, lens)).transpose()
    }

    /// Modulus and Poisson's ratio of an elastic plate.
    #[getter]
    fn plate(&self) -> Option<[f64; 2]> {
        match self.case.field.indenter() {
            Indenter::Flat(Some(material)) => {
                Some([material.young_modulus, material.poisson_ratio])
            }
            _ => None,
        }
    }

    /// Works of adhesion where contact is made and broken, J/m^2, and whether the floor is adhesive; none without adhesion.
    #[getter]
    fn adhesion(&self) -> Option<(f64, Option<f64>, bool)> {
        let adhesion = self.case.field.adhesion();
        (!adhesion.is_none()).then_some((adhesion.work, adhesion.work_receding, adhesion.floor))
    }

    /// Modulus and Poisson's ratio of the substrate.
    #[getter]
    fn substrate(&self) -> [f64; 2] {
        let material = self.case.field.substrate();
        [material.young_modulus, material.poisson_ratio]
    }

    /// The substrate and the indenter as layers; `None` for half-spaces.
    #[getter]
    fn layers(&self) -> [Option<LayerNumbers>; 2] {
        (self.case.field.layers()).map(|layer| layer.map(numbers_of))
    }
}

impl From<AsperityCase> for Asperities {
    fn from(case: AsperityCase) -> Self {
        Self { case }
    }
}

impl Asperities {
    /// The case as a case file.
    pub(crate) fn text(&self) -> String {
        self.case.to_toml()
    }

    /// The case file that describes the same tops.
    pub(crate) fn file(&self) -> PyResult<CaseFile> {
        let file = CaseFile::parse(PYTHON, &self.text()).map_err(|error| case_error(&error))?;
        match file.asperity_case() {
            Ok(case) if case.field == self.case.field => Ok(file),
            _ => Err(value_error(
                "rounded tops are fitted and designed for a case file: save them with to_toml and to_csv, and read the case with fakir.read_case",
            )),
        }
    }

    /// The case.
    pub(crate) fn case(&self) -> &AsperityCase {
        &self.case
    }

    pub(crate) fn of(mut file: CaseFile, overrides: &[String]) -> PyResult<Self> {
        for setting in overrides {
            file.set(setting).map_err(|error| case_error(&error))?;
        }
        let case = file.asperity_case().map_err(|error| case_error(&error))?;
        warn_of_file(&file)?;
        Ok(Self { case })
    }
}

/// A contact with rounded tops.
#[pyclass(frozen, extends = Answer, module = "fakir._fakir")]
pub(crate) struct AsperityContact {
    case: AsperityCase,
    contact: state::AsperityContact,
}

#[pymethods]
impl AsperityContact {
    /// The columns of `pillars.csv`.
    fn pillars<'py>(&self, py: Python<'py>) -> PyResult<PyColumns<'py>> {
        columns(py, &asperity_pillars(self.answer()))
    }

    /// Centres of the floor cells in contact along x and y (m), and the pressure on each (Pa); `None` if the floor carries no load.
    fn floor_cells<'py>(&self, py: Python<'py>) -> Option<[Field<'py>; 3]> {
        Some(floor_cells(py, self.contact.floor.as_ref()?))
    }

    /// Displacement, gap and pressure at points, m from the lens axis.
    fn sample<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
        y: PyReadonlyArray1<'py, f64>,
        options: Options,
    ) -> PyResult<[Field<'py>; 3]> {
        let points = points(&x, &y)?;
        let fields = self.contact.fields(&self.case.field, self.case.height);
        let fields = fields.ok_or_else(|| value_error("the contact has no fields"))?;
        let samples = watched(py, &options, |run| fields.sample(&points, run))?;
        let samples = samples.map_err(|error| solve_error(&error))?;
        Ok(arrays(py, samples))
    }
}

impl AsperityContact {
    /// The contact of a case, with the computing time in s.
    pub(crate) fn made(
        py: Python<'_>,
        case: AsperityCase,
        contact: state::AsperityContact,
        wall_time: f64,
    ) -> PyResult<Py<Self>> {
        let contact = Self { case, contact };
        let answer = contact.answer();
        let summary = json(&asperity_press(answer, wall_time));
        let (ended, warnings) = (answer.contact.termination, asperity_warnings(answer));
        let answer = Answer::new(&answer, summary, ended, warnings);
        Py::new(py, (contact, answer))
    }

    fn answer(&self) -> AsperityAnswer<'_> {
        AsperityAnswer::of(&self.case, &self.contact)
    }
}

/// The contact with rounded tops at an indentation (m) or under a force (N).
#[pyfunction]
pub(crate) fn press_asperities(
    py: Python<'_>,
    tops: &Asperities,
    indentation: Option<f64>,
    force: Option<f64>,
    options: Options,
) -> PyResult<Py<AsperityContact>> {
    let load = load(indentation, force)?;
    let case = tops.case.clone();
    let start = Instant::now();
    let contact = watched(py, &options, |run| {
        case.field.press(load, case.accuracy, run)
    })?;
    let contact = contact.map_err(|error| solve_error(&error))?;
    AsperityContact::made(py, case, contact, start.elapsed().as_secs_f64())
}

/// The object that `fakir approach --json` prints for rounded tops, the critical state, and the other contacts.
type Loading = (
    String,
    Option<Py<AsperityTransition>>,
    Vec<Py<AsperityContact>>,
);

/// Computes the contacts of a loading in steps of the indentation (m).
#[pyfunction]
pub(crate) fn approach_asperities(
    py: Python<'_>,
    tops: &Asperities,
    step: f64,
    until: Option<f64>,
    to: Option<f64>,
    to_force: Option<f64>,
    options: Options,
) -> PyResult<Loading> {
    let path = path(step, until, to, to_force)?;
    let case = &tops.case;
    let Approached {
        found,
        states,
        summary,
    } = approached(py, case, &path, &options)?;
    let critical = found
        .critical
        .map(|critical| AsperityTransition::made(py, case, critical, found.critical_time));
    let states = states
        .into_iter()
        .map(|(contact, time)| AsperityContact::made(py, case.clone(), contact, time));
    Ok((
        summary,
        critical.transpose()?,
        states.collect::<PyResult<_>>()?,
    ))
}

/// The object that `fakir verify --json` prints for rounded tops, and the contact with discs.
#[pyfunction]
pub(crate) fn verify_asperities(
    py: Python<'_>,
    tops: &Asperities,
    indentation: Option<f64>,
    force: Option<f64>,
    cells: usize,
    options: Options,
) -> PyResult<(String, Py<AsperityContact>)> {
    let load = load(indentation, force)?;
    let case = tops.case.clone();
    let start = Instant::now();
    let found = watched(py, &options, |run| {
        fakir::verify_asperities(&case.field, load, cells, run)
    })?;
    let found = found.map_err(|error| solve_error(&error))?;
    let wall_time = start.elapsed().as_secs_f64();
    let summary = SurfaceVerifySummary::of_asperities(&case.field, load, &found, wall_time);
    let summary = json(&summary);
    let contact = AsperityContact::made(py, case, found.discs, wall_time)?;
    Ok((summary, contact))
}

/// The state in which the lens just reaches the floor among rounded tops.
#[pyclass(frozen, extends = Answer, module = "fakir._fakir")]
pub(crate) struct AsperityTransition {
    #[pyo3(get)]
    contact: Py<AsperityContact>,
}

/// Computes the state in which the lens just reaches the floor.
#[pyfunction]
pub(crate) fn asperity_transition(
    py: Python<'_>,
    tops: &Asperities,
    options: Options,
) -> PyResult<Py<AsperityTransition>> {
    let case = &tops.case;
    let start = Instant::now();
    let found = watched(py, &options, |run| {
        case.field.transition(case.accuracy, run)
    })?;
    let found = found.map_err(|error| solve_error(&error))?;
    AsperityTransition::made(py, case, found, start.elapsed().as_secs_f64())
}

impl AsperityTransition {
    /// The critical state of a case, with the computing time in s.
    pub(crate) fn made(
        py: Python<'_>,
        case: &AsperityCase,
        found: state::Critical<state::AsperityContact>,
        wall_time: f64,
    ) -> PyResult<Py<Self>> {
        let critical = AsperityCritical::of(case, &found);
        let summary = json(&result::asperity_transition(critical, wall_time));
        let warnings = asperity_warnings(critical.answer);
        let answer = Answer::new(&critical, summary, found.contact.termination, warnings);
        let contact = AsperityContact::made(py, case.clone(), found.contact, wall_time)?;
        Py::new(py, (Self { contact }, answer))
    }
}

/// The contact at an indentation (m) or under a force (N), or the critical state if neither is given; also returns the object that `--gradient` adds
/// to the JSON output.
#[pyfunction]
pub(crate) fn gradient_asperities(
    py: Python<'_>,
    tops: &Asperities,
    indentation: Option<f64>,
    force: Option<f64>,
    options: Options,
) -> PyResult<(Py<PyAny>, String)> {
    let load = load_or_critical(indentation, force);
    let case = &tops.case;
    let start = Instant::now();
    let found = watched(py, &options, |run| case.gradient(load, run))?;
    let found = found.map_err(|error| solve_error(&error))?;
    let wall_time = start.elapsed().as_secs_f64();
    let summary = json(&GradientObject::from(&found.gradient));
    let reached = match found.critical {
        Some(critical) => AsperityTransition::made(py, case, critical, wall_time)?.into_any(),
        None => {
            let contact = found.gradient.contact;
            AsperityContact::made(py, case.clone(), contact, wall_time)?.into_any()
        }
    };
    Ok((reached, summary))
}

/// Points of a curve: branch, indentation (m), force (N), contact area (m^2) and number of tops in contact.
type CycleCurve = Vec<(&'static str, f64, f64, f64, usize)>;

/// Contacts that begin and end: branch, kind, number of the top, indentation (m), force (N) and contact radius (m).
type CycleEvents = Vec<(&'static str, &'static str, usize, f64, f64, f64)>;

/// Loading up to an indentation (m) or a force (N), and optional unloading; a stiffness (N/m) is that of the testing machine.
#[pyfunction]
pub(crate) fn cycle_asperities(
    py: Python<'_>,
    tops: &Asperities,
    to: Option<f64>,
    to_force: Option<f64>,
    drive: &str,
    machine_stiffness: Option<f64>,
    retract: bool,
    options: Options,
) -> PyResult<(Py<Answer>, CycleCurve, CycleEvents)> {
    let plan = plan(to, to_force, drive, machine_stiffness, retract);
    let case = &tops.case;
    let start = Instant::now();
    let cycle = watched(py, &options, |run| {
        case.field.cycle(plan, case.accuracy, run)
    })?;
    let cycle = cycle.map_err(|error| solve_error(&error))?;
    cycle_answer(py, case, &cycle, start.elapsed().as_secs_f64())
}

/// The numbers, the curve and the events of a cycle, with the computing time in s.
pub(crate) fn cycle_answer(
    py: Python<'_>,
    case: &AsperityCase,
    cycle: &state::AsperityCycle,
    wall_time: f64,
) -> PyResult<(Py<Answer>, CycleCurve, CycleEvents)> {
    let summary = json(&asperity_cycle(cycle, &case.field, None, wall_time));
    let warnings = asperity_cycle_warnings(case, cycle);
    let answer = Answer::new(cycle, summary, cycle.termination, warnings);
    let steps = cycle.load_steps.iter().map(|step| {
        (
            step.branch.name(),
            step.indentation,
            step.force,
            step.contact_area,
            step.pillars_in_contact,
        )
    });
    let events = cycle.events.iter().map(|event| {
        (
            event.branch.name(),
            event.kind.name(),
            event.asperity,
            event.indentation,
            event.force,
            event.radius,
        )
    });
    Ok((Py::new(py, answer)?, steps.collect(), events.collect()))
}

/// The object that `fakir design --free heights --json` prints, the resulting pillars, and the columns of `curve.csv`.
type DesignedHeights<'py> = (String, Asperities, PyColumns<'py>);

/// Heights of rounded tops for a target curve: `"area of the force"`, `"force of the indentation"` or `"area of the indentation"`, in SI
/// units.
#[pyfunction]
pub(crate) fn design_heights<'py>(
    py: Python<'py>,
    tops: &Asperities,
    curve: &str,
    points: Vec<[f64; 2]>,
    seed: u64,
    height_error: Option<f64>,
    options: Options,
) -> PyResult<DesignedHeights<'py>> {
    let curves = [
        Curve::AreaOfForce,
        Curve::ForceOfIndentation,
        Curve::AreaOfIndentation,
    ];
    let curve = curves.into_iter().find(|known| known.words() == curve);
    let curve = curve.ok_or_else(|| value_error("there is no such curve"))?;
    let wanted = points
        .into_iter()
        .map(|[load, value]| WantedPoint { load, value });
    let wanted: Vec<WantedPoint> = wanted.collect();
    let start = Instant::now();
    let found = watched(py, &options, |run| {
        design_pillars(&tops.case, curve, &wanted, seed, run)
    })?;
    let found = found.map_err(|error| pillar_heights_error(&error))?;
    let wall_time = start.elapsed().as_secs_f64();
    let summary = HeightsSummary::new(&found, seed, height_error, wall_time);
    let table = columns(py, &found.table(height_error))?;
    Ok((json(&summary), Asperities { case: found.case }, table))
}
