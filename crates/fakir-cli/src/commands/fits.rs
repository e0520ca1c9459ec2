//! `fakir fit` with several files: every curve fitted separately, with the statistics of the parameters, or all curves together.

use super::fit::{Fitted, estimates_table, figure, provenance, quantity};
use crate::arguments::Fit as Options;
use crate::failure::Failure;
use crate::numbers::{column_unit, seconds, significant, with_unit};
use crate::session::Session;
use fakir::problem::Question;
use fakir_case::CaseFile;
use fakir_case::unit::Dimension;
use fakir_figure::{Figure, FittedParameter, FittedValue, fits};
use fakir_inverse::fit::{
    CurveFit, CurveFits, CurvesSummary, Estimate, FEWEST_FOR_OUTLIERS, FitError, JointFit,
    JointSummary, MeasuredCurve, OUTLIER_SCORE, Parameter, Quantity, Statistics, fit_curves,
    fit_jointly, method_name,
};
use fakir_study::answer::described;
use fakir_study::figures::saved;
use fakir_study::output::File;
use fakir_study::provenance::Provenance;
use fakir_study::report::Report;
use fakir_study::report::state::exceeded_limits;
use fakir_study::report::table::{Column, table};
use fakir_study::result::json;
use std::path::PathBuf;
use std::time::Instant;

pub(crate) fn run(
    file: &CaseFile,
    options: &Options,
    session: &Session,
) -> Result<Fitted, Failure> {
    let start = Instant::now();
    let curves = read(file, options)?;
    let surfaces = surfaces(&curves)?;
    // The case is checked before the first curve: an error of it is reported once.
    let method = method_name(file)?;
    let bar = session.count("curves", curves.len());
    let run = session.run();
    let done = || bar.inc(1);
    let fitted = fit_curves(file, curves, &options.free, &run, &done);
    bar.finish_and_clear();
    let fitted = refuse_if_all_failed(fitted?)?;
    let wall_time = start.elapsed().as_secs_f64();
    let case = described(&fitted.mean_case(file).any_case(&[Question::Fit])?)?;
    let of = format!(", {} curves", fitted.curves.len());
    let provenance = provenance(&case, "least squares", &options.free, &of);
    let tables = session.files(|| {
        let mut files = vec![File::new("fits.csv", fitted.table().to_csv())];
        files.extend(saved(figure_of(&fitted), &provenance));
        files.extend(files_of_curves(&fitted.curves, &provenance));
        files
    });
    let (misfits, warnings) = sorted_warnings(&fitted);
    let report = Report {
        json: json(&CurvesSummary::new(method, &fitted, wall_time)),
        text: text(
            &surfaces.unwrap_or_else(|| case.lines.join("\n")),
            &fitted,
            wall_time,
        ),
        provenance,
        tables,
        warnings,
        converged: fitted.failed().next().is_none(),
        exceeded: exceeded(&fitted.curves),
    };
    Ok(Fitted { report, misfits })
}

/// All files fitted together.
pub(crate) fn joint(
    file: &CaseFile,
    options: &Options,
    session: &Session,
) -> Result<Fitted, Failure> {
    let start = Instant::now();
    let curves = read(file, options)?;
    let surfaces = surfaces(&curves)?;
    let method = method_name(file)?;
    let shared = options.shared();
    let bar = session.count("curves", curves.len());
    let run = session.run();
    let done = || bar.inc(1);
    let fitted = fit_jointly(file, curves, &options.free, &shared, &run, &done);
    bar.finish_and_clear();
    let fitted = fitted?;
    let wall_time = start.elapsed().as_secs_f64();
    let case = described(&fitted.file.any_case(&[Question::Fit])?)?;
    let of = format!(", {} curves", fitted.curves.len());
    let provenance = provenance(&case, "joint least squares", &options.free, &of);
    let tables = session.files(|| {
        let mut files = vec![File::new("fits.csv", fitted.table().to_csv())];
        files.extend(saved(figure_of_joint(&fitted), &provenance));
        files.extend(files_of_curves(&fitted.curves, &provenance));
        files
    });
    let misfits = fitted.misfit_statements();
    let mut warnings = fitted.warnings();
    warnings.retain(|warning| !misfits.contains(warning));
    let mut exceeded = exceeded(&fitted.curves);
    if !fitted.agrees() {
        exceeded.push("the curves do not agree on the shared values".to_owned());
    }
    let report = Report {
        json: json(&JointSummary::new(method, &fitted, wall_time)),
        text: text_of_joint(
            &surfaces.unwrap_or_else(|| case.lines.join("\n")),
            &fitted,
            wall_time,
        ),
        provenance,
        tables,
        warnings,
        converged: fitted.converged(),
        exceeded,
    };
    Ok(Fitted { report, misfits })
}

/// Surface and method of every curve, if curves have cases of their own.
fn surfaces(curves: &[MeasuredCurve]) -> Result<Option<String>, Failure> {
    let mut lines = Vec::new();
    for (number, curve) in curves.iter().enumerate() {
        let Some(case) = &curve.case else {
            return Ok(None);
        };
        let [surface, method] = described(&case.any_case(&[Question::Fit])?)?.lines;
        lines.push(format!("{}  {surface}; {method}", number + 1));
    }
    Ok(Some(lines.join("\n")))
}

/// The data of all files, or why they cannot be read.
fn read(file: &CaseFile, options: &Options) -> Result<Vec<MeasuredCurve>, Failure> {
    for (number, path) in options.data.iter().enumerate() {
        if options.data[..number].contains(path) {
            let path = path.display();
            return Err(Failure::Argument(format!(
                "{path} is given twice: give every file once"
            )));
        }
    }
    let cases = options.cases()?;
    let one = |(number, path): (usize, &PathBuf)| {
        let case = cases.get(number);
        let data = match options.measurements(path, case.unwrap_or(file)) {
            Ok(data) => {
                let known = options.known(&data);
                Ok((data, known))
            }
            Err(Failure::Fit(error)) => Err(error),
            Err(other) => return Err(other),
        };
        Ok(MeasuredCurve {
            name: path.display().to_string(),
            data,
            case: case.cloned(),
        })
    };
    options.data.iter().enumerate().map(one).collect()
}

/// If there is no fit of any curve, prints the errors of all but the last one, which it returns. An error that all curves have in common
/// is printed once.
fn refuse_if_all_failed(mut fitted: CurveFits) -> Result<CurveFits, Failure> {
    if fitted.curves.iter().any(|curve| curve.outcome.is_ok()) {
        return Ok(fitted);
    }
    let mut errors: Vec<FitError> = Vec::new();
    for curve in fitted.curves.drain(..) {
        let Err(error) = curve.outcome else {
            continue;
        };
        let is_new = |known: &FitError| known.to_string() != error.to_string();
        if errors.last().is_none_or(is_new) {
            errors.push(error);
        }
    }
    let last = errors.pop();
    for error in errors {
        Failure::Fit(error).explain();
    }
    match last {
        Some(error) => Err(error.into()),
        None => Ok(fitted),
    }
}

/// Statements of fits that do not describe their data, and all other warnings.
fn sorted_warnings(fitted: &CurveFits) -> (Vec<String>, Vec<String>) {
    let misfits: Vec<String> = fitted
        .curves
        .iter()
        .filter_map(|curve| {
            let statement = curve.outcome.as_ref().ok()?.fit.misfit_statement()?;
            Some(curve.named(&statement))
        })
        .collect();
    let mut warnings = fitted.warnings();
    warnings.retain(|warning| !misfits.contains(warning));
    (misfits, warnings)
}

/// Limits of the model that are exceeded, and fits that do not describe their data.
fn exceeded(curves: &[CurveFit]) -> Vec<String> {
    let of = |curve: &CurveFit| -> Vec<String> {
        let Ok(fitted) = &curve.outcome else {
            return Vec::new();
        };
        let mut words = exceeded_limits(&fitted.fit.limits);
        if !fitted.fit.misfit.describes_data() {
            words.push("the fit does not describe the data".to_owned());
        }
        let named = words.iter().map(|words| format!("{}: {words}", curve.name));
        named.collect()
    };
    curves.iter().flat_map(of).collect()
}

/// Table with data and model, and figure, of every curve: in a folder for each, named by its number and the name of its file.
fn files_of_curves(curves: &[CurveFit], provenance: &Provenance) -> Vec<File> {
    let mut files = Vec::new();
    for (number, curve) in curves.iter().enumerate() {
        let Ok(fitted) = &curve.outcome else {
            continue;
        };
        let stem = PathBuf::from(&curve.name);
        let stem = stem.file_stem().map(|stem| stem.to_string_lossy());
        let stem: String = stem
            .unwrap_or_default()
            .chars()
            .map(|c| match c.is_alphanumeric() || "-_.".contains(c) {
                true => c,
                false => '-',
            })
            .collect();
        let folder = format!("curves/{}-{stem}", number + 1);
        let figure = figure(&fitted.data, &fitted.fit).with_provenance(&provenance.stamp());
        files.extend([
            File::new(
                format!("{folder}/fitted.csv"),
                fitted.fit.table(&fitted.data).to_csv(),
            ),
            File::new(format!("{folder}/fit.svg"), figure.svg()),
        ]);
    }
    files
}

/// The unit of the values of a parameter in a column: its symbol and its size in SI units.
fn unit_of(parameter: Parameter, values: impl Iterator<Item = f64>) -> (&'static str, f64) {
    match parameter.dimension() {
        None => ("m/N", 1.0),
        Some(dimension) => {
            column_unit(values, dimension).map_or(("", 1.0), |unit| (unit.symbol, unit.in_si()))
        }
    }
}

/// A value with its standard error, both with as many decimals as two digits of the error have.
fn plus_minus(value: f64, error: Option<f64>) -> String {
    let Some(error) = error.filter(|error| error.is_finite() && *error > 0.0) else {
        return format!("{} (not determined)", significant(value, 3));
    };
    let place = error.log10().floor();
    if (-8.0..6.0).contains(&place) {
        let decimals = (1.0 - place).max(0.0) as usize;
        format!("{value:.decimals$} ± {error:.decimals$}")
    } else {
        format!("{value:.5e} ± {error:.1e}")
    }
}

/// A parameter of the table: its number among the estimates, and the unit of its column.
struct Place {
    number: usize,
    unit: &'static str,
    size: f64,
}

/// A curve as a row of the table.
struct Line {
    number: usize,
    file: String,
    values: Vec<String>,
    residual: String,
    verdict: String,
}

impl Line {
    fn new(number: usize, curve: &CurveFit, places: &[Place]) -> Self {
        let mut line = Self {
            number: number + 1,
            file: curve.name.clone(),
            values: vec!["-".to_owned(); places.len()],
            residual: "-".to_owned(),
            verdict: "no fit".to_owned(),
        };
        let Ok(fitted) = &curve.outcome else {
            return line;
        };
        let estimates = &fitted.fit.estimates;
        let values = places.iter().map(|Place { number, size, .. }| {
            let estimate = &estimates[*number];
            let error = estimate.standard_error.map(|error| error / size);
            plus_minus(estimate.value / size, error)
        });
        line.values = values.collect();
        let residuals = fitted.fit.scatter.iter().map(|scatter| {
            let dimension = match scatter.quantity {
                Quantity::Force => Dimension::Force,
                Quantity::ContactRadius => Dimension::Length,
            };
            with_unit(scatter.residual, dimension, 3)
        });
        line.residual = residuals.collect::<Vec<_>>().join(", ");
        line.verdict = match curve.problem() {
            Some(_) => "not converged".to_owned(),
            None if fitted.fit.misfit.describes_data() => "yes".to_owned(),
            None => "no".to_owned(),
        };
        line
    }
}

/// All fitted values of a parameter, by its number.
fn estimates(curves: &[CurveFit], number: usize) -> impl Iterator<Item = (usize, &Estimate)> {
    let curves = curves.iter().enumerate();
    curves.filter_map(move |(curve, of)| {
        let fitted = of.outcome.as_ref().ok()?;
        Some((curve, fitted.fit.estimates.get(number)?))
    })
}

/// The table of all curves, with these parameters, each after its number among the estimates.
fn curves_table(parameters: &[(usize, Parameter)], curves: &[CurveFit]) -> String {
    let units: Vec<Place> = parameters
        .iter()
        .map(|(number, parameter)| {
            let values = estimates(curves, *number).map(|(_, estimate)| estimate.value);
            let (unit, size) = unit_of(*parameter, values);
            Place {
                number: *number,
                unit,
                size,
            }
        })
        .collect();
    let lines = curves.iter().enumerate();
    let lines: Vec<Line> = lines
        .map(|(number, curve)| Line::new(number, curve, &units))
        .collect();
    let mut columns = vec![
        Column::right("", |line: &Line| line.number.to_string()),
        Column::text("file", |line: &Line| line.file.clone()),
    ];
    for (place, ((_, parameter), unit)) in parameters.iter().zip(&units).enumerate() {
        let heading = match unit.unit {
            "" => parameter.name().to_owned(),
            unit => format!("{} ({unit})", parameter.name()),
        };
        columns.push(Column::formatted(&heading, move |line: &Line| {
            line.values[place].clone()
        }));
    }
    columns.push(Column::right("residual", |line: &Line| {
        line.residual.clone()
    }));
    columns.push(Column::text("describes the data", |line: &Line| {
        line.verdict.clone()
    }));
    table(&lines, &columns)
}

fn text(surfaces: &str, fitted: &CurveFits, wall_time: f64) -> String {
    let failed: Vec<&CurveFit> = fitted.failed().collect();
    let of_failed = match failed.len() {
        0 => String::new(),
        count => format!(", {count} without a result"),
    };
    let mut text = format!(
        "{} curves, each fitted separately{of_failed}\n{surfaces}, in {}\n\n",
        fitted.curves.len(),
        seconds(wall_time)
    );
    let all: Vec<(usize, Parameter)> = fitted.free.iter().copied().enumerate().collect();
    text += &curves_table(&all, &fitted.curves);
    text.push('\n');
    text += &remarks(&fitted.curves);
    let of = fitted.free.iter().zip(&fitted.statistics);
    let found: Vec<(Parameter, Statistics)> = of
        .filter_map(|(parameter, found)| Some((*parameter, found.clone()?)))
        .collect();
    if !found.is_empty() {
        text += &statistics_table(&found);
        text.push('\n');
    }
    for (parameter, outlier) in fitted.outliers() {
        text += &format!(
            "outlier: {}, {} {}, modified z-score {}\n",
            fitted.curves[outlier.curve].name,
            parameter.name(),
            quantity(parameter, outlier.value, 4),
            significant(outlier.score, 3)
        );
    }
    let usable = found.iter().map(|(_, found)| found.count).max();
    if usable.is_some_and(|count| count < FEWEST_FOR_OUTLIERS) {
        text += &format!("outliers: named for {FEWEST_FOR_OUTLIERS} curves or more\n");
    } else if fitted.outliers().next().is_none() {
        text += &format!("outliers: none (modified z-score beyond {OUTLIER_SCORE})\n");
    }
    for curve in failed {
        if let Some(problem) = curve.problem() {
            text += &format!("no result of {}\n", curve.named(&problem));
        }
    }
    text
}

/// Remarks on how each file was read, if there are any.
fn remarks(curves: &[CurveFit]) -> String {
    /// Largest number of files with remarks, so that the results remain visible.
    const MOST: usize = 20;
    let fitted = curves.iter().enumerate();
    let fitted = fitted.filter_map(|(number, curve)| {
        let remarks = curve.outcome.as_ref().ok()?.data.layout().remarks();
        let words = format!("{}  {}: {}\n", number + 1, curve.name, remarks.join("; "));
        (!remarks.is_empty()).then_some(words)
    });
    let mut lines: Vec<String> = fitted.collect();
    let more = lines.len().saturating_sub(MOST);
    lines.truncate(MOST);
    if more > 0 {
        lines.push(format!("and {more} more files with remarks\n"));
    }
    if !lines.is_empty() {
        lines.push("\n".to_owned());
    }
    lines.concat()
}

/// A probability with two digits.
fn probability(p: f64) -> String {
    if p < 1e-16 {
        return "< 1e-16".to_owned();
    }
    significant(p, 2)
}

/// A mean with its standard error, in the unit that suits it.
fn mean_words(parameter: Parameter, mean: f64, error: Option<f64>) -> String {
    let (unit, size) = unit_of(parameter, [mean].into_iter());
    let error = error.filter(|error| *error > 0.0);
    let words = match error {
        Some(error) => plus_minus(mean / size, Some(error / size)),
        None => significant(mean / size, 4),
    };
    match unit {
        "" => words,
        unit if error.is_some() => format!("({words}) {unit}"),
        unit => format!("{words} {unit}"),
    }
}

fn text_of_joint(surfaces: &str, fitted: &JointFit, wall_time: f64) -> String {
    let mut text = format!(
        "{} curves, fitted together\n{surfaces}, {} in {} steps, in {}\n\nshared by all curves\n{}",
        fitted.curves.len(),
        fitted.termination.description(),
        fitted.iterations,
        seconds(wall_time),
        estimates_table(&fitted.shared),
    );
    let is_shared = |parameter: &Parameter| fitted.shared.iter().any(|e| e.parameter == *parameter);
    let own = fitted.free.iter().copied().enumerate();
    let own: Vec<(usize, Parameter)> = own.filter(|(_, free)| !is_shared(free)).collect();
    text += &format!("\n{}\n", curves_table(&own, &fitted.curves));
    text += &remarks(&fitted.curves);
    for (a, one) in fitted.shared.iter().enumerate() {
        for (b, other) in fitted.shared.iter().enumerate().take(a) {
            if let Some(correlation) = fitted.correlation[a][b] {
                text += &format!(
                    "correlation of {} with {}: {correlation:.3}\n",
                    other.parameter.name(),
                    one.parameter.name()
                );
            }
        }
    }
    if let Some(test) = fitted.agreement {
        let verdict = match fitted.agrees() {
            true => "the curves agree on the shared values",
            false => "the curves do not agree on the shared values",
        };
        let against = match test.denominator {
            None => format!(
                "chi-square {} with {} degrees of freedom",
                significant(test.statistic, 3),
                test.degrees_of_freedom
            ),
            Some(rest) => format!(
                "F {} with {} and {rest} degrees of freedom",
                significant(test.statistic, 3),
                test.degrees_of_freedom
            ),
        };
        text += &format!(
            "{verdict}: joint fit against separate fits, {against}, p = {}\n",
            probability(test.p_value)
        );
    }
    text += &match fitted.chi_square_p_value {
        Some(p) => format!(
            "chi-square of all curves {} for {} degrees of freedom, p = {}; normal intervals\n",
            significant(fitted.chi_square, 4),
            fitted.degrees_of_freedom,
            probability(p)
        ),
        None => format!(
            "{} degrees of freedom; intervals of Student's distribution\n",
            fitted.degrees_of_freedom
        ),
    };
    text += match fitted.describes_data() {
        true => "the joint fit describes the data\n",
        false => "the joint fit does not describe the data\n",
    };
    text
}

/// Own values of every curve, and separate and joint values of the shared parameters.
fn figure_of_joint(fitted: &JointFit) -> Figure {
    let panel = |(number, parameter): (usize, &Parameter)| {
        let mut shared = fitted.shared.iter();
        let shared = shared.position(|estimate| estimate.parameter == *parameter);
        let values: Vec<(usize, &Estimate)> = match shared {
            None => estimates(&fitted.curves, number).collect(),
            Some(place) => {
                let curves = fitted.separate.iter().enumerate();
                curves
                    .filter_map(|(curve, of)| Some((curve, of.get(place)?)))
                    .collect()
            }
        };
        let (unit, size) = unit_of(*parameter, values.iter().map(|(_, e)| e.value));
        let value = |(curve, estimate): &(usize, &Estimate)| FittedValue {
            curve: curve + 1,
            value: estimate.value / size,
            error: estimate.standard_error.map(|error| error / size),
            outlier: false,
        };
        FittedParameter {
            name: parameter.name().to_owned(),
            unit: unit.replacen('u', "µ", 1),
            values: values.iter().map(value).collect(),
            mean: shared.map(|place| {
                let shared = &fitted.shared[place];
                [shared.value, shared.standard_error.unwrap_or(0.0)].map(|value| value / size)
            }),
        }
    };
    let panels: Vec<FittedParameter> = fitted.free.iter().enumerate().map(panel).collect();
    fits(&panels, fitted.curves.len(), true)
}

/// Mean, scatter and weighted mean of every parameter.
fn statistics_table(found: &[(Parameter, Statistics)]) -> String {
    type Row = (Parameter, Statistics);
    table(
        found,
        &[
            Column::text("", |(parameter, _): &Row| parameter.name().to_owned()),
            Column::right("curves", |(_, found): &Row| found.count.to_string()),
            Column::right("mean ± standard error", |(parameter, found): &Row| {
                mean_words(*parameter, found.mean, found.standard_error)
            }),
            Column::right("standard deviation", |(parameter, found): &Row| {
                let scatter = found.standard_deviation;
                scatter.map_or("-".to_owned(), |scatter| quantity(*parameter, scatter, 3))
            }),
            Column::right(
                "weighted mean ± standard error",
                |(parameter, found): &Row| {
                    found.weighted_mean.map_or("-".to_owned(), |mean| {
                        mean_words(*parameter, mean.value, Some(mean.standard_error))
                    })
                },
            ),
            Column::right("same value: p", |(_, found): &Row| {
                let p = found.weighted_mean.and_then(|mean| mean.p_value);
                p.map_or("-".to_owned(), probability)
            }),
        ],
    )
}

/// Values of every parameter with their mean and standard deviation.
fn figure_of(fitted: &CurveFits) -> Figure {
    let panel = |(number, parameter): (usize, &Parameter)| {
        let of = || estimates(&fitted.curves, number);
        let (unit, size) = unit_of(*parameter, of().map(|(_, estimate)| estimate.value));
        let found = fitted.statistics[number].as_ref();
        let outliers = found.map_or(&[][..], |found| &found.outliers);
        let value = |(curve, estimate): (usize, &Estimate)| FittedValue {
            curve: curve + 1,
            value: estimate.value / size,
            error: estimate.standard_error.map(|error| error / size),
            outlier: outliers.iter().any(|outlier| outlier.curve == curve),
        };
        FittedParameter {
            name: parameter.name().to_owned(),
            unit: unit.replacen('u', "µ", 1),
            values: of().map(value).collect(),
            mean: found.map(|found| {
                [found.mean, found.standard_deviation.unwrap_or(0.0)].map(|value| value / size)
            }),
        }
    };
    let panels: Vec<FittedParameter> = fitted.free.iter().enumerate().map(panel).collect();
    fits(&panels, fitted.curves.len(), false)
}
