//! Fits of measured curves.

use crate::asperities::Asperities;
use crate::case::{Case, Described};
use crate::error::{case_error, fit_error, value_error, warn_of_former_name};
use crate::flat::Flat;
use crate::study::{PyColumns, columns};
use crate::surface::Surface;
use crate::watched::{Options, watched, watched_parts};
use fakir::state::Branch;
use fakir_case::CaseFile;
use fakir_inverse::fit::{
    Column, CurveFit, CurvesSummary, Fit, FitError, FitOptions, FitSummary, Hints, JointSummary,
    MeasuredCurve, Measurements, NamedColumn, Parameter, Position, Quantity, Selection,
    method_name, shared_by_default,
};
use fakir_study::Table;
use fakir_study::result::json;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::time::Instant;

/// A measured loading experiment.
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct Data {
    measurements: Measurements,
}

#[pymethods]
impl Data {
    /// Reads a file, with explicitly assigned columns, quantity and heading, the spring constant (N/m) of a cantilever, the last row that is used,
    /// and whether rows of pauses are used.
    #[staticmethod]
    fn read(
        path: PathBuf,
        named: Vec<(String, String)>,
        spring_constant: Option<f64>,
        last_row: Option<usize>,
        has_pauses: bool,
    ) -> PyResult<Self> {
        let hints = Hints {
            last_row,
            has_pauses,
            ..hints(&named, spring_constant)?
        };
        let measurements = Measurements::read_with(&path, &hints);
        Ok(Self {
            measurements: measurements.map_err(|error| fit_error(&error.into()))?,
        })
    }

    /// Columns by their headings, NaN for missing measurements; `None` for columns that are not numeric.
    #[staticmethod]
    fn of(
        columns: Vec<(String, Option<PyReadonlyArray1<'_, f64>>)>,
        named: Vec<(String, String)>,
        spring_constant: Option<f64>,
    ) -> PyResult<Self> {
        let columns = columns.into_iter().map(|(name, values)| {
            let values = values.map(|values| values.as_array().to_vec());
            (name, values)
        });
        let columns: Vec<(String, Option<Vec<f64>>)> = columns.collect();
        let measurements = Measurements::from_columns(&columns, &hints(&named, spring_constant)?);
        Ok(Self {
            measurements: measurements.map_err(|error| fit_error(&error.into()))?,
        })
    }

    /// Selected rows: the first and the last one and the cycle from 1, the branch, and the smallest and the largest load (m, or N).
    fn select(
        &self,
        rows: [Option<usize>; 2],
        cycle: Option<usize>,
        branch: Option<&str>,
        between: [Option<f64>; 2],
    ) -> PyResult<Self> {
        let [from, to] = between;
        let selection = Selection {
            rows,
            cycle,
            branch: match branch {
                None => None,
                Some("loading") => Some(Branch::Loading),
                Some("unloading") => Some(Branch::Unloading),
                Some(other) => {
                    let problem = format!("branch is {other:?}: give \"loading\" or \"unloading\"");
                    return Err(value_error(problem));
                }
            },
            from,
            to,
        };
        let measurements = self.measurements.clone().select(&selection);
        Ok(Self {
            measurements: measurements.map_err(|error| fit_error(&error.into()))?,
        })
    }

    /// The dimension of the loads: `"length"` or `"force"`.
    fn load_dimension(&self) -> &'static str {
        self.measurements.load_dimension().noun()
    }

    /// Compliance of the cantilever whose deflection is the force, m/N.
    fn cantilever_compliance(&self) -> Option<f64> {
        self.measurements.layout().cantilever_compliance
    }

    /// How every column was interpreted, one line each.
    fn understood(&self) -> Vec<String> {
        self.measurements.layout().lines()
    }

    /// Adds standard errors of position (m), force (N) and contact radius (m) where none were given.
    fn with_errors(
        &self,
        position: Option<f64>,
        force: Option<f64>,
        contact_radius: Option<f64>,
    ) -> Self {
        let mut measurements = self.measurements.clone();
        if let Some(error) = position {
            measurements = measurements.with_position_error(error);
        }
        if let Some(error) = force {
            measurements = measurements.with_force_error(error);
        }
        if let Some(error) = contact_radius {
            measurements = measurements.with_contact_radius_error(error);
        }
        Self { measurements }
    }
}

/// Explicitly assigned columns.
pub(crate) fn hints(named: &[(String, String)], spring_constant: Option<f64>) -> PyResult<Hints> {
    let one = |(quantity, heading): &(String, String)| {
        NamedColumn::new(quantity, heading).map_err(value_error)
    };
    Ok(Hints {
        named: named.iter().map(one).collect::<PyResult<_>>()?,
        spring_constant,
        ..Hints::default()
    })
}

/// Result of a fit.
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct Fitted {
    fit: Fit,
    table: Table,
    load: &'static str,
    summary: String,
}

#[pymethods]
impl Fitted {
    /// The object that `fakir fit --json` prints.
    fn json(&self) -> &str {
        &self.summary
    }

    /// The case with the fitted values.
    #[getter]
    fn case(&self) -> PyResult<Described> {
        Described::of(self.fit.file.clone(), &[], true)
    }

    /// The column used as load: `"displacement_m"`, `"indentation_m"` or `"force_N"`.
    #[getter]
    fn load(&self) -> &'static str {
        self.load
    }

    /// Compared quantities, as column names.
    #[getter]
    fn compared(&self) -> Vec<&'static str> {
        let quantities = self.fit.scatter.iter();
        quantities
            .map(|scatter| match scatter.quantity {
                Quantity::Force => "force",
                Quantity::ContactRadius => "contact_radius",
            })
            .collect()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.fit.warnings()
    }

    /// Data and model, as columns.
    fn table<'py>(&self, py: Python<'py>) -> PyResult<PyColumns<'py>> {
        columns(py, &self.table)
    }

    /// Whether points of the curve belong to the unloading, with adhesive tops.
    fn unloading<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        let curve = self.fit.curve.iter();
        PyArray1::from_iter(py, curve.map(|p| p.branch == Some(Branch::Unloading)))
    }

    /// The computed curve: load, force (N) and contact radius (m).
    fn curve<'py>(&self, py: Python<'py>) -> [Bound<'py, PyArray1<f64>>; 3] {
        let curve = || self.fit.curve.iter();
        [
            PyArray1::from_iter(py, curve().map(|point| point.load)),
            PyArray1::from_iter(py, curve().map(|point| point.force)),
            PyArray1::from_iter(py, curve().map(|point| point.contact_radius)),
        ]
    }
}

/// A case that can be fitted.
#[derive(FromPyObject)]
pub(crate) enum Fittable<'py> {
    Pillars(PyRef<'py, Case>),
    Flat(PyRef<'py, Flat>),
    Asperities(PyRef<'py, Asperities>),
    Surface(PyRef<'py, Surface>),
}

impl Fittable<'_> {
    /// Its case file; that of a height map is required to fit these quantities.
    pub(crate) fn file(&self, fitted: &str) -> PyResult<CaseFile> {
        match self {
            Self::Pillars(case) => case.file(),
            Self::Flat(flat) => Ok(flat.file.clone()),
            Self::Asperities(asperities) => asperities.file(),
            Self::Surface(surface) => surface.of_file(fitted),
        }
    }
}

impl Fitted {
    fn new(measurements: &Measurements, fit: Fit, wall_time: f64) -> Self {
        let summary = FitSummary::new(measurements, &fit, wall_time);
        Self {
            table: fit.table(measurements),
            load: match measurements.position() {
                Position::Displacement => Column::Displacement.name(),
                Position::Indentation => "measured_indentation_m",
                Position::None => Column::Force.name(),
            },
            summary: json(&summary),
            fit,
        }
    }
}

/// Parameters of these names.
fn parameters(py: Python<'_>, names: &[String]) -> PyResult<Vec<Parameter>> {
    for name in names {
        warn_of_former_name(py, name)?;
    }
    let parameters = names.iter().map(|name| {
        let named = Parameter::all_named(name);
        let names: Vec<&str> = match named[..] {
            [parameter] => return Ok(parameter),
            [] => Parameter::names().collect(),
            _ => named.iter().map(|parameter| parameter.name()).collect(),
        };
        let names = names.join(", ");
        Err(value_error(format!(
            "{name} cannot be fitted: give some of {names}"
        )))
    });
    parameters.collect()
}

/// Contact point, machine compliance, force offset, drifts of displacement and force, and force slope.
type Instrument = (Option<f64>, f64, f64, f64, f64, f64);

fn fit_options(instrument: Instrument, starts: usize) -> FitOptions {
    let (
        contact_point,
        machine_compliance,
        force_offset,
        displacement_drift,
        force_drift,
        force_slope,
    ) = instrument;
    FitOptions {
        contact_point,
        machine_compliance,
        force_offset,
        displacement_drift,
        force_drift,
        force_slope,
        starts,
    }
}

/// Whether the rows are a history over time, to which pauses belong.
#[pyfunction]
pub(crate) fn has_relaxation(case: Fittable<'_>, free: Vec<String>) -> PyResult<bool> {
    let named = free.iter().flat_map(|name| Parameter::all_named(name));
    let free: Vec<Parameter> = named.collect();
    match case {
        // A height map of an array, of which only moduli are fitted.
        Fittable::Surface(surface) if surface.of_file("parameters").is_err() => Ok(false),
        _ => fakir_inverse::fit::has_relaxation(&case.file("parameters")?, &free)
            .map_err(|error| case_error(&error)),
    }
}

/// Values of the free parameters that fit the data best.
#[pyfunction]
pub(crate) fn fit(
    py: Python<'_>,
    case: Fittable<'_>,
    data: &Data,
    free: Vec<String>,
    instrument: Instrument,
    starts: usize,
    options: Options,
) -> PyResult<Fitted> {
    let free = parameters(py, &free)?;
    let known = fit_options(instrument, starts);
    let file = case.file("parameters")?;
    let measurements = &data.measurements;
    let start = Instant::now();
    let fit = watched(py, &options, |run| {
        fakir_inverse::fit::fit(&file, measurements, &free, &known, run)
    })?;
    let fit = fit.map_err(|error| fit_error(&error))?;
    let wall_time = start.elapsed().as_secs_f64();
    Ok(Fitted::new(measurements, fit, wall_time))
}

/// Results of fits of several curves.
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct FittedCurves {
    curves: Vec<Option<Py<Fitted>>>,
    table: Table,
    summary: String,
    warnings: Vec<String>,
}

#[pymethods]
impl FittedCurves {
    /// The object that `fakir fit --json` prints.
    fn json(&self) -> &str {
        &self.summary
    }

    /// The fit of every curve; `None` if there is none.
    fn curves(&self, py: Python<'_>) -> Vec<Option<Py<Fitted>>> {
        let curves = self.curves.iter();
        curves
            .map(|curve| curve.as_ref().map(|curve| curve.clone_ref(py)))
            .collect()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// Results by curve, as columns.
    fn table<'py>(&self, py: Python<'py>) -> PyResult<PyColumns<'py>> {
        columns(py, &self.table)
    }
}

/// A curve: its name, its data with the values of the instrument, or why there are none, and its case, if it is not the common one.
type GivenCurve<'py> = (
    String,
    Option<(PyRef<'py, Data>, Instrument)>,
    String,
    Option<Fittable<'py>>,
);

fn given_curves(curves: Vec<GivenCurve<'_>>, starts: usize) -> PyResult<Vec<MeasuredCurve>> {
    let one = |(name, given, problem, case): GivenCurve<'_>| {
        let case = case.map(|case| case.file("parameters")).transpose()?;
        let data = match given {
            Some((data, instrument)) => {
                Ok((data.measurements.clone(), fit_options(instrument, starts)))
            }
            None => Err(FitError::Unreadable(problem)),
        };
        Ok(MeasuredCurve { name, data, case })
    };
    curves.into_iter().map(one).collect()
}

/// The fits of curves as Python objects.
fn fitted_curves(py: Python<'_>, curves: Vec<CurveFit>) -> PyResult<Vec<Option<Py<Fitted>>>> {
    let one = |curve: CurveFit| match curve.outcome {
        Err(_) => Ok(None),
        Ok(one) => {
            let fitted = Fitted::new(&one.data, one.fit, one.wall_time);
            Py::new(py, fitted).map(Some)
        }
    };
    curves.into_iter().map(one).collect()
}

/// Fits of several curves, each separately.
#[pyfunction]
pub(crate) fn fit_curves(
    py: Python<'_>,
    case: Fittable<'_>,
    curves: Vec<GivenCurve<'_>>,
    free: Vec<String>,
    starts: usize,
    options: Options,
) -> PyResult<FittedCurves> {
    let free = parameters(py, &free)?;
    let file = case.file("parameters")?;
    let curves = given_curves(curves, starts)?;
    let start = Instant::now();
    let total = curves.len();
    let fitted = watched_parts(py, &options, total, |run, done| {
        fakir_inverse::fit::fit_curves(&file, curves, &free, run, done)
    })?;
    let fitted = fitted.map_err(|error| fit_error(&error))?;
    let wall_time = start.elapsed().as_secs_f64();
    let method = method_name(&file).map_err(|error| case_error(&error))?;
    Ok(FittedCurves {
        summary: json(&CurvesSummary::new(method, &fitted, wall_time)),
        table: fitted.table(),
        warnings: fitted.warnings(),
        curves: fitted_curves(py, fitted.curves)?,
    })
}

/// Fit of several curves together; without `shared`, the keys of the case are shared.
#[pyfunction]
pub(crate) fn fit_jointly(
    py: Python<'_>,
    case: Fittable<'_>,
    curves: Vec<GivenCurve<'_>>,
    free: Vec<String>,
    shared: Option<Vec<String>>,
    starts: usize,
    options: Options,
) -> PyResult<FittedCurves> {
    let free = parameters(py, &free)?;
    let shared = match shared {
        None => shared_by_default(&free),
        Some(names) => parameters(py, &names)?,
    };
    let file = case.file("parameters")?;
    let curves = given_curves(curves, starts)?;
    let start = Instant::now();
    let total = curves.len();
    let joint = watched_parts(py, &options, total, |run, done| {
        fakir_inverse::fit::fit_jointly(&file, curves, &free, &shared, run, done)
    })?;
    let joint = joint.map_err(|error| fit_error(&error))?;
    let wall_time = start.elapsed().as_secs_f64();
    let method = method_name(&file).map_err(|error| case_error(&error))?;
    Ok(FittedCurves {
        summary: json(&JointSummary::new(method, &joint, wall_time)),
        table: joint.table(),
        warnings: joint.warnings(),
        curves: fitted_curves(py, joint.curves)?,
    })
}
