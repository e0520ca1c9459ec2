//! `fakir fit`: moduli and instrument parameters from a measured loading curve.

use crate::arguments::Fit as Options;
use crate::failure::Failure;
use crate::numbers::{DIGITS, digits, significant, with_unit};
use crate::report::figures::saved;
use crate::report::state::{VERSION, texture_line};
use crate::report::table::{Column, table};
use crate::report::{Report, json};
use crate::session::Session;
use fakir_case::unit::Dimension;
use fakir_case::{Case, CaseFile};
use fakir_figure::{Figure, FittedCurve, FittedLoad, FittedPoint, FittedQuantity, fit_curves};
use fakir_study::citations::Topic;
use fakir_study::fit::{
    Compared, Estimate, Fit, FittedRow, Measured, Measurements, Parameter, Position, Quantity, fit,
};
use fakir_study::output::File;
use fakir_study::provenance::{Provenance, method_words};
use serde::Serialize;
use serde_json::{Map, Value};
use std::time::Instant;

pub(crate) fn run(
    file: &CaseFile,
    data: &Measurements,
    options: &Options,
    session: &Session,
) -> Result<Report, Failure> {
    let start = Instant::now();
    session.part("fit");
    let fitted = fit(file, data, &options.free, &options.known(), &session.run())?;
    let wall_time = start.elapsed().as_secs_f64();
    let case = fitted.file.case()?;
    let names: Vec<&str> = options.free.iter().map(|free| free.name()).collect();
    let provenance = Provenance::new(
        format!("least squares for {}", names.join(", ")),
        method_words(case.method),
        &[Topic::Method(case.method), Topic::LeastSquares],
        case.to_toml(),
    );
    let mut tables = vec![fitted_table(data, &fitted)];
    tables.extend(saved(figure(data, &fitted), &provenance));
    Ok(Report {
        json: json(&FitJson::new(data, &case, &fitted, wall_time)),
        text: text(data, &case, &fitted, wall_time),
        provenance,
        tables,
        warnings: warnings(&fitted),
        converged: fitted.converged(),
    })
}

/// A value of a parameter with its unit.
fn quantity(parameter: Parameter, value: f64, digits: usize) -> String {
    match parameter.dimension() {
        Some(dimension) => with_unit(value, dimension, digits),
        None => format!("{} m/N", significant(value, digits)),
    }
}

fn text(data: &Measurements, case: &Case, fitted: &Fit, wall_time: f64) -> String {
    let rows = fitted.rows.len();
    let out = fitted.past_transition().count();
    let out = match out {
        0 => String::new(),
        count => format!(", {count} of them past the transition and left out"),
    };
    let mut text = format!(
        "{}: {rows} states{out}\n{}\n{}, {} in {} steps, in {}\n\n",
        data.name(),
        texture_line(&case.system),
        method_words(case.method),
        fitted.termination.description(),
        fitted.iterations,
        crate::numbers::seconds(wall_time)
    );
    text += &table(
        &fitted.estimates,
        &[
            Column::text("", |e: &Estimate| e.parameter.name().to_owned()),
            Column::right("value", |e| quantity(e.parameter, e.value, known_digits(e))),
            Column::right("standard error", |e| match e.standard_error {
                Some(error) => quantity(e.parameter, error, 2),
                None => "not determined".to_owned(),
            }),
            Column::right("95 % interval", interval),
        ],
    );
    text.push('\n');
    text += &correlations(fitted);
    for scatter in &fitted.scatter {
        let dimension = match scatter.quantity {
            Quantity::Force => Dimension::Force,
            Quantity::ContactRadius => Dimension::Length,
        };
        let of_error = match scatter.estimated {
            Some(error) if error < 1e-3 * scatter.residual => {
                "no errors given, the scatter is that of the load or of jumps from ring to ring of \
                 pillars"
                    .to_owned()
            }
            Some(error) => format!(
                "no errors given, standard error estimated as {}",
                with_unit(error, dimension, 3)
            ),
            None => "errors as given".to_owned(),
        };
        text += &format!(
            "{}: {} values, residual {} (root mean square), {of_error}\n",
            scatter.quantity.name(),
            scatter.values,
            with_unit(scatter.residual, dimension, 3),
        );
    }
    text += &match fitted.reduced_chi_square() {
        Some(reduced) => format!(
            "chi-square {} for {} degrees of freedom: {} each; normal intervals\n",
            significant(fitted.chi_square, 4),
            fitted.degrees_of_freedom,
            significant(reduced, 3)
        ),
        None => format!(
            "{} degrees of freedom; intervals of Student's distribution\n",
            fitted.degrees_of_freedom
        ),
    };
    text
}

/// Digits of a value that its standard error leaves, and one more.
fn known_digits(estimate: &Estimate) -> usize {
    let known = estimate
        .standard_error
        .map_or(3, |error| digits((error / estimate.value).abs()) + 1);
    known.clamp(3, DIGITS)
}

fn interval(estimate: &Estimate) -> String {
    let known = known_digits(estimate);
    let end = |value| quantity(estimate.parameter, value, known);
    match estimate.interval {
        Some([low, high]) => format!("{} to {}", end(low), end(high)),
        None => "-".to_owned(),
    }
}

fn correlations(fitted: &Fit) -> String {
    let mut text = String::new();
    for (a, estimate) in fitted.estimates.iter().enumerate() {
        for b in 0..a {
            if let Some(correlation) = fitted.correlation[a][b] {
                text += &format!(
                    "correlation of {} with {}: {correlation:.3}\n",
                    fitted.estimates[b].parameter.name(),
                    estimate.parameter.name()
                );
            }
        }
    }
    if !text.is_empty() {
        text.push('\n');
    }
    text
}

fn warnings(fitted: &Fit) -> Vec<String> {
    let mut warnings: Vec<String> = fitted
        .undetermined
        .iter()
        .map(|undetermined| undetermined.statement.clone())
        .collect();
    let out: Vec<String> = fitted
        .past_transition()
        .map(|row| row.measurement.line.to_string())
        .collect();
    match &out[..] {
        [] => {}
        [line] => warnings.push(format!(
            "1 state (line {line}) is past the transition, where the lens touches the floor, and \
             left out"
        )),
        [first, .., last] => warnings.push(format!(
            "{} states (lines {first} to {last}) are past the transition, where the lens touches \
             the floor, and left out",
            out.len()
        )),
    }
    let unsolved = fitted.rows.iter().filter(|row| !row.converged).count();
    if unsolved > 0 {
        warnings.push(format!("{unsolved} contacts did not converge"));
    }
    if fitted.termination != fakir::contact::Termination::Converged {
        warnings.push(format!("the fit {}", fitted.termination.description()));
    }
    // Beyond three standard deviations of chi-square, which is 2 per degree of freedom.
    let freedom = fitted.degrees_of_freedom as f64;
    if fitted.reduced_chi_square().is_some()
        && (fitted.chi_square - freedom).abs() > 3.0 * (2.0 * freedom).sqrt()
    {
        let problem = if fitted.chi_square > freedom {
            "larger than it should be: the errors that were given are too small, or the model does \
             not describe the data; the intervals are too narrow"
        } else {
            "smaller than it should be: the errors that were given are too large"
        };
        warnings.push(format!("chi-square is {problem}"));
    }
    for estimate in &fitted.estimates {
        if estimate.parameter == Parameter::MachineCompliance
            && estimate.interval.is_some_and(|[_, high]| high < 0.0)
        {
            warnings.push("the machine compliance is negative, which cannot be".to_owned());
        }
    }
    warnings
}

#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct FitJson {
    method: &'static str,
    parameters: Vec<Map<String, Value>>,
    correlation: Vec<Vec<Option<f64>>>,
    undetermined: Vec<UndeterminedJson>,
    contact_point_m: Option<f64>,
    machine_compliance_m_per_N: Option<f64>,
    rows: usize,
    rows_past_transition: usize,
    values: usize,
    degrees_of_freedom: usize,
    chi_square: f64,
    reduced_chi_square: Option<f64>,
    distribution: &'static str,
    scatter: Vec<Map<String, Value>>,
    converged: bool,
    termination: &'static str,
    iterations: usize,
    wall_time_s: f64,
    fakir_version: &'static str,
}

#[derive(Serialize)]
struct UndeterminedJson {
    parameters: Vec<&'static str>,
    statement: String,
}

impl FitJson {
    fn new(data: &Measurements, case: &Case, fitted: &Fit, wall_time: f64) -> Self {
        let of_displacement = data.position() == Position::Displacement;
        Self {
            method: case.method.name(),
            parameters: fitted.estimates.iter().map(estimate_json).collect(),
            correlation: fitted.correlation.clone(),
            undetermined: fitted
                .undetermined
                .iter()
                .map(|undetermined| UndeterminedJson {
                    parameters: undetermined.parameters.iter().map(|p| p.name()).collect(),
                    statement: undetermined.statement.clone(),
                })
                .collect(),
            contact_point_m: of_displacement.then_some(fitted.contact_point),
            machine_compliance_m_per_N: of_displacement.then_some(fitted.machine_compliance),
            rows: fitted.rows.len(),
            rows_past_transition: fitted.past_transition().count(),
            values: fitted.scatter.iter().map(|scatter| scatter.values).sum(),
            degrees_of_freedom: fitted.degrees_of_freedom,
            chi_square: fitted.chi_square,
            reduced_chi_square: fitted.reduced_chi_square(),
            distribution: if fitted.is_scatter_estimated() {
                "student_t"
            } else {
                "normal"
            },
            scatter: fitted.scatter.iter().map(scatter_json).collect(),
            converged: fitted.converged(),
            termination: fitted.termination.description(),
            iterations: fitted.iterations,
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }
}

fn estimate_json(estimate: &Estimate) -> Map<String, Value> {
    let suffix = estimate.parameter.suffix();
    Map::from_iter([
        ("name".to_owned(), Value::from(estimate.parameter.name())),
        (format!("value{suffix}"), Value::from(estimate.value)),
        (format!("start{suffix}"), Value::from(estimate.start)),
        (
            "determined".to_owned(),
            Value::from(estimate.interval.is_some()),
        ),
        (
            format!("standard_error{suffix}"),
            Value::from(estimate.standard_error),
        ),
        (
            format!("confidence_interval_95{suffix}"),
            estimate
                .interval
                .map_or(Value::Null, |ends| Value::from(ends.to_vec())),
        ),
    ])
}

fn scatter_json(scatter: &fakir_study::fit::Scatter) -> Map<String, Value> {
    let suffix = match scatter.quantity {
        Quantity::Force => "_N",
        Quantity::ContactRadius => "_m",
    };
    Map::from_iter([
        ("quantity".to_owned(), Value::from(scatter.quantity.name())),
        ("values".to_owned(), Value::from(scatter.values)),
        (format!("residual{suffix}"), Value::from(scatter.residual)),
        (
            format!("estimated_error{suffix}"),
            Value::from(scatter.estimated),
        ),
    ])
}

/// The data beside the model.
fn fitted_table(data: &Measurements, fitted: &Fit) -> File {
    let position = match data.position() {
        Position::Displacement => Some("displacement_m"),
        Position::Indentation => Some("measured_indentation_m"),
        Position::None => None,
    };
    let mut heading = vec!["line"];
    heading.extend(position);
    heading.extend([
        "indentation_m",
        "force_N",
        "force_error_N",
        "fitted_force_N",
        "force_residual_N",
        "contact_radius_m",
        "contact_radius_error_m",
        "fitted_contact_radius_m",
        "contact_radius_residual_m",
        "smallest_floor_gap_m",
        "used",
    ]);
    let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer
        .write_record(&heading)
        .expect("memory takes every byte");
    for row in &fitted.rows {
        let value = |measured: Option<Measured>| measured.map(|measured| measured.value);
        let mut record = vec![row.measurement.line.to_string()];
        if position.is_some() {
            record.push(number(value(row.measurement.position)));
        }
        record.push(row.indentation.to_string());
        for (measured, compared) in [
            (row.measurement.force, row.force),
            (row.measurement.contact_radius, row.contact_radius),
        ] {
            record.push(number(value(measured)));
            record.push(number(compared.map(|c| c.error)));
            record.push(number(compared.map(|c| c.computed)));
            record.push(number(compared.as_ref().map(Compared::residual)));
        }
        record.push(row.smallest_floor_gap.to_string());
        record.push(row.used.to_string());
        writer
            .write_record(&record)
            .expect("records are as long as the heading");
    }
    File::new(
        "fitted.csv",
        writer.into_inner().expect("memory takes every byte"),
    )
}

fn figure(data: &Measurements, fitted: &Fit) -> Figure {
    let load = match data.position() {
        Position::Displacement => FittedLoad::Displacement,
        Position::Indentation => FittedLoad::Indentation,
        Position::None => FittedLoad::Force,
    };
    let curve = |scatter: &fakir_study::fit::Scatter| {
        let quantity = scatter.quantity;
        let point = |row: &FittedRow| {
            let compared = match quantity {
                Quantity::Force => row.force,
                Quantity::ContactRadius => row.contact_radius,
            }?;
            let load = match load {
                FittedLoad::Force => row.measurement.force,
                _ => row.measurement.position,
            }?;
            Some(FittedPoint {
                load: load.value,
                measured: compared.measured,
                computed: compared.computed,
                error: compared.error,
                used: row.used,
            })
        };
        let curve = fitted.curve.iter().map(|point| match quantity {
            Quantity::Force => [point.load, point.force],
            Quantity::ContactRadius => [point.load, point.contact_radius],
        });
        FittedCurve {
            quantity: match quantity {
                Quantity::Force => FittedQuantity::Force,
                Quantity::ContactRadius => FittedQuantity::ContactRadius,
            },
            points: fitted.rows.iter().filter_map(point).collect(),
            curve: curve.collect(),
        }
    };
    let curves: Vec<FittedCurve> = fitted.scatter.iter().map(curve).collect();
    fit_curves(load, &curves)
}
