//! A measured curve that the user gives the page: it is read as by `fakir fit`, and fitted.

use crate::clock::Moment;
use crate::refusal::Refusal;
use crate::request::{self, GivenFile, Ticket, Values};
use crate::worker::{Failure, Worker};
use fakir::state::Branch;
use fakir_inverse::fit::{
    Fit, FitError, FitOptions, FitSummary, Hints, Measurements, Parameter, Position, fit,
};
use serde::{Deserialize, Serialize};

/// Largest size of a curve, unpacked, bytes.
const LARGEST: u64 = 8_000_000;

/// `POST /api/fit`: reads a curve, and fits it if parameters are free.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Request {
    pub(crate) ticket: Ticket,
    case: Values,
    /// Contents of the table of pillars, if the case names one.
    #[serde(default)]
    table: Option<GivenFile>,
    curve: GivenFile,
    /// Names of the parameters to fit; none only reads the curve.
    #[serde(default)]
    free: Vec<String>,
    /// Contact point, m: value, or initial value if it is free.
    #[serde(default)]
    contact_point_m: Option<f64>,
}

#[derive(Serialize)]
struct MeasuredLine {
    measured: Measured,
}

/// The curve as it was read.
#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct Measured {
    name: String,
    /// Kind of the position: `displacement`, which includes the contact point and the compliance of the machine, or `indentation`.
    position: &'static str,
    position_m: Vec<f64>,
    force_N: Vec<f64>,
    unloading: Vec<bool>,
    /// How the columns were understood.
    notes: Vec<String>,
}

#[derive(Serialize)]
struct FittedLine {
    fitted: Fitted,
}

#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct Fitted {
    /// As `fakir fit --json` prints it.
    summary: FitSummary,
    estimates: Vec<FittedValue>,
    contact_point_m: f64,
    /// Position and force of the computed curve, as the instrument would read them.
    curve: Vec<[f64; 2]>,
    /// Position and measured minus computed force of the rows that were used.
    residuals: Vec<[f64; 2]>,
    warnings: Vec<String>,
}

/// A fitted parameter, in SI units.
#[derive(Serialize)]
struct FittedValue {
    name: &'static str,
    /// Whether it is a key of the case.
    is_key: bool,
    value: f64,
    /// `None` if the data do not determine it.
    standard_error: Option<f64>,
}

/// `POST /api/fit`
pub(crate) fn answer(request: &Request, worker: &Worker) -> Result<(), Failure> {
    let data = read(&request.curve)?;
    let position = match data.position() {
        Position::Displacement => "displacement",
        Position::Indentation => "indentation",
        Position::None => {
            return Err(of_curve("it has forces, but no positions of the lens")
                .accepted("a column of the displacement or of the indentation, in any unit")
                .into());
        }
    };
    let rows = data.rows().iter();
    let rows = rows.filter_map(|row| Some((row.position?.value, row.force?.value, row.branch)));
    let rows: Vec<_> = rows.collect();
    worker.send(&MeasuredLine {
        measured: Measured {
            name: data.name().to_owned(),
            position,
            position_m: rows.iter().map(|row| row.0).collect(),
            force_N: rows.iter().map(|row| row.1).collect(),
            unloading: rows
                .iter()
                .map(|row| row.2 == Some(Branch::Unloading))
                .collect(),
            notes: data.layout().lines(),
        },
    });
    if request.free.is_empty() {
        return Ok(());
    }
    let free: Result<Vec<Parameter>, Refusal> =
        request.free.iter().map(|name| parameter(name)).collect();
    request::case(&request.case, request.table.as_ref())?;
    let file = request::file(&request.case, request.table.as_ref())?;
    let options = FitOptions {
        contact_point: request.contact_point_m.filter(|point| point.is_finite()),
        ..FitOptions::default()
    };
    let start = Moment::now();
    let fitted =
        fit(&file, &data, &free?, &options, &worker.run()).map_err(|error| failure(&error))?;
    let wall_time = start.elapsed().as_secs_f64();
    worker.send(&FittedLine {
        fitted: shown(&data, &fitted, wall_time),
    });
    Ok(())
}

fn shown(data: &Measurements, fitted: &Fit, wall_time: f64) -> Fitted {
    let estimates = fitted.estimates.iter().map(|it| FittedValue {
        name: it.parameter.name(),
        is_key: matches!(it.parameter, Parameter::Key(_)),
        value: it.value,
        standard_error: it.standard_error,
    });
    let rows = fitted.rows.iter().filter(|row| row.used);
    Fitted {
        estimates: estimates.collect(),
        contact_point_m: fitted.contact_point,
        curve: fitted.curve.iter().map(|at| [at.load, at.force]).collect(),
        residuals: rows
            .filter_map(|row| Some([row.measurement.position?.value, row.force?.residual()]))
            .collect(),
        warnings: fitted.warnings(),
        summary: FitSummary::new(data, fitted, wall_time),
    }
}

fn read(curve: &GivenFile) -> Result<Measurements, Refusal> {
    let text = curve.contents("curve", LARGEST)?;
    Measurements::from_bytes(&curve.name, &text, &Hints::default())
        .map_err(|error| of_curve(error.to_string()))
}

fn of_curve(message: impl Into<String>) -> Refusal {
    Refusal::impossible(message).at("curve")
}

fn parameter(name: &str) -> Result<Parameter, Refusal> {
    Parameter::named(name).ok_or_else(|| {
        let known: Vec<&str> = Parameter::names().collect();
        let known = known.join(", ");
        Refusal::impossible("no such parameter of a fit")
            .at("free")
            .accepted(known)
    })
}

fn failure(error: &FitError) -> Failure {
    if error.is_interruption() {
        return Failure::Cancelled;
    }
    of_curve(error.to_string()).into()
}
