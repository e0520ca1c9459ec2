//! `fakir fit`: moduli, work of adhesion and instrument parameters from a measured curve.

use crate::arguments::Fit as Options;
use crate::failure::Failure;
use crate::numbers::{DIGITS, digits, significant, with_unit};
use crate::session::Session;
use fakir::problem::{PillarCompliance, Question};
use fakir::state::Branch;
use fakir_case::CaseFile;
use fakir_case::unit::Dimension;
use fakir_figure::{Figure, FittedCurve, FittedLoad, FittedPoint, FittedQuantity, fit_curves};
use fakir_inverse::fit::{
    CurvePoint, Estimate, Fit, FitSummary, FittedPullOff, FittedRow, Measurements, Parameter,
    Position, Quantity, fit,
};
use fakir_study::answer::{Described, described};
use fakir_study::citations::Topic;
use fakir_study::figures::saved;
use fakir_study::output::File;
use fakir_study::provenance::Provenance;
use fakir_study::report::Report;
use fakir_study::report::state::{QuantityList, exceeded_limits};
use fakir_study::report::table::{Column, table};
use fakir_study::result::json;
use std::time::Instant;

/// The report of a fit, and what is printed even if no warnings are.
pub(crate) struct Fitted {
    pub(crate) report: Report,
    /// Why fits do not describe the data.
    pub(crate) misfits: Vec<String>,
}

pub(crate) fn run(
    file: &CaseFile,
    data: &Measurements,
    options: &Options,
    session: &Session,
) -> Result<Fitted, Failure> {
    let start = Instant::now();
    session.part("fit");
    let fitted = fit(
        file,
        data,
        &options.free,
        &options.known(data),
        &session.run(),
    )?;
    let wall_time = start.elapsed().as_secs_f64();
    let case = described(&fitted.file.any_case(&[Question::Fit])?)?;
    let provenance = provenance(&case, "least squares", &options.free, "");
    let tables = session.files(|| {
        let mut files = vec![File::new("fitted.csv", fitted.table(data).to_csv())];
        files.extend(saved(figure(data, &fitted), &provenance));
        files
    });
    let misfit = fitted.misfit_statement();
    let mut warnings = fitted.warnings();
    warnings.retain(|warning| Some(warning) != misfit.as_ref());
    let mut exceeded = exceeded_limits(&fitted.limits);
    if misfit.is_some() {
        exceeded.push("the fit does not describe the data".to_owned());
    }
    let report = Report {
        json: json(&FitSummary::new(data, &fitted, wall_time)),
        text: text(data, &case, &fitted, wall_time),
        provenance,
        tables,
        warnings,
        converged: fitted.converged(),
        exceeded,
    };
    Ok(Fitted {
        report,
        misfits: misfit.into_iter().collect(),
    })
}

/// The provenance of a fit of a kind, with these free parameters; `of` follows their names.
pub(crate) fn provenance(case: &Described, kind: &str, free: &[Parameter], of: &str) -> Provenance {
    let names: Vec<&str> = free.iter().map(|free| free.name()).collect();
    let mut topics = case.topics.clone();
    topics.push(Topic::LeastSquares);
    Provenance::new(
        format!("{kind} for {}{of}", names.join(", ")),
        case.method.clone(),
        &topics,
        case.text.clone(),
    )
}

/// A value of a parameter with its unit.
pub(crate) fn quantity(parameter: Parameter, value: f64, digits: usize) -> String {
    match parameter.dimension() {
        Some(dimension) => with_unit(value, dimension, digits),
        None => format!("{} m/N", significant(value, digits)),
    }
}

fn text(data: &Measurements, case: &Described, fitted: &Fit, wall_time: f64) -> String {
    let rows = fitted.rows.len();
    let out = fitted.past_transition().count();
    let out = match out {
        0 => String::new(),
        count => format!(", {count} of them left out"),
    };
    let mut text = format!(
        "{}: {rows} states{out}\n{}{}\n{}, {} in {} steps, in {}\n\n",
        data.name(),
        understood(data),
        case.lines[0],
        case.lines[1],
        fitted.termination.description(),
        fitted.iterations,
        crate::numbers::seconds(wall_time)
    );
    if let (true, Some(last)) = (fitted.is_viscoelastic, data.rows().last()) {
        let begin = data.rows().first().and_then(|row| row.time);
        let duration = last.time.unwrap_or(0.0) - begin.unwrap_or(0.0);
        text += &format!(
            "history of viscoelastic bodies over {}; moduli are the relaxed ones\n\n",
            with_unit(duration, Dimension::Time, 3)
        );
    }
    text += &estimates_table(&fitted.estimates);
    text.push('\n');
    if let Some(pull_off) = &fitted.pull_off {
        let case = fitted.file.case();
        let compliance = case.map(|case| case.system.pillar().compliance);
        let of_pillars = match compliance {
            Ok(PillarCompliance::Elastic) => "corners of elastic pillars",
            _ => "columns that do not lean",
        };
        text += &pull_off_words(pull_off, of_pillars);
    }
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
        if let Some(error) = scatter.interpolation_error {
            text += &format!(
                "{}: interpolated between solved states, estimated error {}\n",
                scatter.quantity.name(),
                with_unit(error, dimension, 2)
            );
        }
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
    text += &description(fitted);
    let mut limits = QuantityList::default();
    limits.model(&fitted.limits);
    let limits = limits.text();
    if !limits.is_empty() {
        text += &format!("\nunder the largest load\n{limits}");
    }
    text
}

/// Values, standard errors and intervals.
pub(crate) fn estimates_table(estimates: &[Estimate]) -> String {
    let mut text = table(
        estimates,
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
    for estimate in estimates.iter().filter(|estimate| estimate.one_sided) {
        text += &format!(
            "{}: the interval is one-sided, as the data do not tell the value from the least that it can have\n",
            estimate.parameter.name()
        );
    }
    text
}

/// What the columns of the file were taken for.
fn understood(data: &Measurements) -> String {
    let lines = data.layout().lines();
    let cantilever = data.layout().cantilever_compliance.map(|compliance| {
        format!(
            "compliance of the cantilever: {} m/N, in the machine compliance unless this is given",
            significant(compliance, 4)
        )
    });
    let lines = lines.iter().chain(&cantilever);
    lines.map(|line| format!("  {line}\n")).collect()
}

/// Whether the fit describes the data, and the starting points of its searches.
fn description(fitted: &Fit) -> String {
    let misfit = &fitted.misfit;
    let least = |values: &mut dyn Iterator<Item = f64>| values.fold(1.0, f64::min);
    let mut parts = Vec::new();
    if !misfit.runs.is_empty() {
        let p = least(&mut misfit.runs.iter().map(|test| test.p_value));
        parts.push(format!("runs of residuals p = {}", significant(p, 2)));
    }
    if let Some(p) = misfit.chi_square_p_value {
        parts.push(format!("chi-square p = {}", significant(p, 2)));
    }
    if let Some(left) = misfit.left_out.first() {
        parts.push(format!(
            "fixed parameter most likely wrong: {} (p = {})",
            left.parameter.name(),
            significant(left.p_value, 2)
        ));
    }
    let verdict = if misfit.describes_data() {
        "describes the data"
    } else {
        "does not describe the data"
    };
    let mut text = match &parts[..] {
        [] => String::new(),
        parts => format!("{verdict}: {}\n", parts.join("; ")),
    };
    if fitted.starts.len() > 1 {
        let same = fitted.starts.iter().filter(|start| start.is_answer).count();
        text += &format!("{} starts: {same} came to this fit\n", fitted.starts.len());
    }
    text
}

/// The pull-off as measured and as fitted, and the error of the model.
fn pull_off_words(pull_off: &FittedPullOff, of_pillars: &str) -> String {
    let force = |force| with_unit(force, Dimension::Force, 3);
    let of_work = pull_off.work_error.map_or(String::new(), |error| {
        format!(
            ", which is {} of the work of adhesion and not in its interval",
            significant(error, 1)
        )
    });
    let forces = format!(
        "pull-off: smallest reading {}, fitted {}",
        force(pull_off.measured),
        force(pull_off.computed)
    );
    if pull_off.model_error == 0.0 {
        return format!("{forces}\n\n"); // on a flat surface
    }
    format!(
        "{forces}; error of the model {} (shapes of partial contacts, {of_pillars}){of_work}\n\n",
        significant(pull_off.model_error, 1),
    )
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

/// Data and model.
pub(crate) fn figure(data: &Measurements, fitted: &Fit) -> Figure {
    let load_of = match data.position() {
        _ if fitted.is_viscoelastic => FittedLoad::Time,
        Position::Displacement => FittedLoad::Displacement,
        Position::Indentation => FittedLoad::Indentation,
        Position::None => FittedLoad::Force,
    };
    let curve = |scatter: &fakir_inverse::fit::Scatter| {
        let quantity = scatter.quantity;
        let point = |(number, row): (usize, &FittedRow)| {
            let compared = row.compared(quantity)?;
            if load_of == FittedLoad::Time {
                // The force also depends on earlier states, and drifts are not separate from it.
                return Some(FittedPoint {
                    load: row.measurement.time?,
                    measured: compared.measured,
                    computed: compared.computed,
                    error: compared.error,
                    used: row.used,
                    unloading: false,
                });
            }
            let load = match load_of {
                FittedLoad::Force => row.measurement.force,
                _ => row.measurement.position,
            }?;
            // Without the drift, as the curve is at the first row.
            let moment = fitted.moments.get(number).copied().unwrap_or(0.0);
            let force_drift = moment * fitted.force_drift;
            let [load_drift, drift] = match (load_of, quantity) {
                (FittedLoad::Displacement, Quantity::Force) => {
                    [moment * fitted.displacement_drift, force_drift]
                }
                (FittedLoad::Displacement, _) => [moment * fitted.displacement_drift, 0.0],
                (FittedLoad::Indentation, Quantity::Force) => [0.0, force_drift],
                (FittedLoad::Indentation, _) => [0.0, 0.0],
                (FittedLoad::Force | FittedLoad::Time, _) => [force_drift, 0.0],
            };
            Some(FittedPoint {
                load: load.value - load_drift,
                measured: compared.measured - drift,
                computed: compared.computed - drift,
                error: compared.error,
                used: row.used,
                unloading: row.branch == Some(Branch::Unloading),
            })
        };
        let place = |point: &CurvePoint| match quantity {
            Quantity::Force => [point.load, point.force],
            Quantity::ContactRadius => [point.load, point.contact_radius],
        };
        let (back, forth): (Vec<&CurvePoint>, Vec<&CurvePoint>) = fitted
            .curve
            .iter()
            .partition(|point| point.branch == Some(Branch::Unloading));
        let points: Vec<FittedPoint> = fitted.rows.iter().enumerate().filter_map(point).collect();
        let [curve, unloading] = if load_of == FittedLoad::Time {
            let mut at_rows: Vec<[f64; 2]> = points.iter().map(|p| [p.load, p.computed]).collect();
            at_rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
            [at_rows, Vec::new()]
        } else {
            [forth, back].map(|branch| branch.into_iter().map(place).collect())
        };
        FittedCurve {
            quantity: match quantity {
                Quantity::Force => FittedQuantity::Force,
                Quantity::ContactRadius => FittedQuantity::ContactRadius,
            },
            points,
            curve,
            unloading,
        }
    };
    let curves: Vec<FittedCurve> = fitted.scatter.iter().map(curve).collect();
    let describes = fitted.misfit.describes_data();
    fit_curves(load_of, &curves, describes)
}
