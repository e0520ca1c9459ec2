//! A fit as a JSON object, as a table and as warnings, for command line and Python package.

use super::{
    Estimate, Fit, FittedCycle, FittedRow, LEVEL, LeftOut, Measured, Measurements, Misfit,
    Parameter, Position, Quantity, RateTest, ReadColumn, RunsTest, Scatter, Skipped,
};
use fakir::numerics::convergence::larger;
use fakir::state::Termination;
use fakir_case::SurfaceKind;
use fakir_case::unit::{Dimension, format_quantity};
use fakir_study::record::LimitObject;
use fakir_study::{Column, Table, VERSION, Values};
use serde::Serialize;
use serde_json::{Map, Value};

/// Why states past the transition are left out, and what uses them.
const WITH_FLOOR: &str = "past the transition, where the lens touches the floor, and left out: the method spectral uses them, unless the case has \
    floor.contact = false";

/// The same with adhesion.
const WITH_ADHESION: &str = "past the transition, where the lens touches the floor, and left out: with adhesion the loading ends there, and the unloading \
    is that from there";

/// Why states on a flat surface are left out.
const DEEPER: &str = "deeper than the loading that could be solved, and left out: check the sign of the forces and the contact point";

/// Force of the first row, relative to the largest, from which the history before it matters.
const EARLY: f64 = 0.05;

/// A value of a parameter with its unit.
fn value_words(parameter: Parameter, value: f64) -> String {
    const DIGITS: i32 = 2;
    // The value is rounded before the unit is chosen.
    let rounded: f64 = format!("{value:.*e}", DIGITS as usize - 1)
        .parse()
        .unwrap_or(value);
    match parameter.dimension() {
        Some(dimension) => format_quantity(rounded, dimension),
        None => format!("{rounded} m/N"),
    }
}

impl Fit {
    /// Message to the user if the fit does not describe the data; `None` if the search did not converge, which is the reason then.
    #[must_use]
    pub fn misfit_statement(&self) -> Option<String> {
        let is_best = self.termination == Termination::Converged;
        is_best.then(|| self.misfit.statement(value_words))?
    }

    /// Warning that the search did not converge, with what to try.
    pub(super) fn search_warning(&self) -> Option<String> {
        let description = self.termination.description();
        let is_best = self.termination == Termination::Converged;
        (!is_best).then(|| format!("the fit {description}; try several starts, as with --starts 8, or other initial values"))
    }

    /// Warnings about quantities whose residuals are as large as their computed values: errors estimated from them hide what no test of residuals sees.
    fn strangers(&self) -> Vec<String> {
        /// Fraction of the largest computed value.
        const PART: f64 = 0.5;
        let is_strange = |scatter: &&Scatter| {
            let computed = self.rows.iter().filter(|row| row.used);
            let computed = computed.filter_map(|row| row.compared(scatter.quantity));
            let largest = computed.fold(0.0, |most, it| larger(most, it.computed.abs()));
            scatter.values > 2 && scatter.estimated.is_some() && scatter.residual > PART * largest
        };
        let strange = self.scatter.iter().filter(is_strange);
        let words = strange.map(|scatter| {
            format!(
                "the residuals of the {} are as large as its computed values: is its column another quantity, or in another unit?",
                scatter.quantity.name()
            )
        });
        words.collect()
    }

    /// Warning if the error of the computed curve of a height map is larger than the standard error of a modulus, which does not contain it, or unknown.
    fn error_of_cells(&self) -> Option<String> {
        if !self.file.is_surface() {
            return None;
        }
        let force = self
            .scatter
            .iter()
            .find(|it| it.quantity == Quantity::Force)?;
        let forces = self.rows.iter().filter_map(|row| row.force);
        let largest = forces.fold(0.0, |largest, force| larger(largest, force.computed.abs()));
        let Some(error) = force.interpolation_error else {
            return Some(
                "the error of the computed forces is not estimated: the height map has too few cells for a comparison with larger ones"
                    .to_owned(),
            );
        };
        let relative = error / largest;
        let is_modulus = |it: &&Estimate| it.parameter.dimension() == Some(Dimension::Pressure);
        let modulus = self.estimates.iter().find(is_modulus)?;
        let of_noise = modulus.standard_error? / modulus.value;
        (relative > of_noise).then(|| {
            format!(
                "the cells of the height map cause an estimated error of {:.1e} of the computed forces, more than the standard error of {}, \
                 {of_noise:.1e} of its value, which does not contain it: use smaller cells",
                relative,
                modulus.parameter.name(),
            )
        })
    }

    /// Warnings about the result: parameters that are not determined, rows left out, and failed
    /// tests.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings: Vec<String> = self
            .undetermined
            .iter()
            .map(|undetermined| undetermined.statement.clone())
            .collect();
        if let [(first, why), others @ ..] = &self.not_modelled[..] {
            let lines = match others.last() {
                Some((last, _)) => format!("{} rows (lines {first} to {last})", others.len() + 1),
                None => format!("1 row (line {first})"),
            };
            let verb = if others.is_empty() { "is" } else { "are" };
            warnings.push(format!(
                "{lines} {verb} outside of the model and left out: {why}"
            ));
        }
        let out: Vec<String> = self
            .past_transition()
            .map(|row| row.measurement.line.to_string())
            .collect();
        let why = match (self.file.surface_kind(), &self.cycle) {
            (SurfaceKind::Flat, _) => DEEPER,
            (_, Some(_)) => WITH_ADHESION,
            (_, None) => WITH_FLOOR,
        };
        match &out[..] {
            [] => {}
            [line] => warnings.push(format!("1 state (line {line}) is {why}")),
            [first, .., last] => warnings.push(format!(
                "{} states (lines {first} to {last}) are {why}",
                out.len()
            )),
        }
        warnings.extend(
            self.cycle
                .as_ref()
                .map_or(Vec::new(), FittedCycle::warnings),
        );
        if let Some(line) = self.assumed_unloading_point {
            warnings.push(format!(
                "the data contain no loading: the unloading is assumed to begin at the first row (line {line}), and the adhesive contact on unloading depends on that load; give the loading too, or its last row"
            ));
        }
        if self.radii_left_out {
            warnings.push(
                "contact radii are left out: on rounded tops and height maps they jump from one top to the next"
                    .to_owned(),
            );
        }
        let unsolved: Vec<u64> = self
            .rows
            .iter()
            .filter(|row| !row.converged)
            .map(|row| row.measurement.line)
            .collect();
        match &unsolved[..] {
            [] => {}
            [line] => warnings.push(format!(
                "1 state (line {line}) did not converge or is not resolved"
            )),
            [first, .., last] => warnings.push(format!(
                "{} states (lines {first} to {last}) did not converge or are not resolved",
                unsolved.len()
            )),
        }
        warnings.extend(self.error_of_cells());
        warnings.extend(self.search_warning());
        warnings.extend(self.misfit_statement());
        warnings.extend(self.strangers());
        warnings.extend(self.rate.as_ref().and_then(RateTest::statement));
        if !self.is_viscoelastic && matches!(self.file.relaxation(), Ok(Some(_))) {
            warnings.push(
                "relaxation has no effect: the data contain no times, and the bodies of the fit are relaxed"
                    .to_owned(),
            );
        }
        if self.is_viscoelastic
            && let Some(first) = self.rows.first().filter(|row| row.indentation > 0.0)
            && let Some(force) = first.force
            && let Some(largest) = self
                .rows
                .iter()
                .filter_map(|row| row.force)
                .map(|it| it.computed)
                .reduce(f64::max)
            && force.computed - self.force_offset > EARLY * (largest - self.force_offset)
        {
            warnings.push(
                "the first row is in contact already: what was before is not in the data, and the load is taken to be applied there at once"
                    .to_owned(),
            );
        }
        if self.misfit.is_chi_square_small() {
            warnings.push(
                "chi-square is smaller than it should be: the errors that were given are too large"
                    .to_owned(),
            );
        }
        for estimate in &self.estimates {
            if estimate.parameter == Parameter::MachineCompliance
                && estimate.interval.is_some_and(|[_, high]| high < 0.0)
            {
                warnings.push("the machine compliance is negative, which cannot be".to_owned());
            }
        }
        warnings
    }

    /// Table of the data with the computed values: one row for each row of the data.
    #[must_use]
    pub fn table(&self, data: &Measurements) -> Table {
        let numbers = |name: &str, value: &dyn Fn(&FittedRow) -> Option<f64>| Column {
            name: name.to_owned(),
            values: Values::Numbers(self.rows.iter().map(value).collect()),
        };
        let lines = self.rows.iter();
        let lines = lines.map(|row| i64::try_from(row.measurement.line).ok());
        let mut columns = vec![Column {
            name: "line".to_owned(),
            values: Values::Counts(lines.collect()),
        }];
        if self.cycle.is_some() {
            let branches = self.rows.iter();
            let branches = branches.map(|row| row.branch.map(|branch| branch.name().to_owned()));
            columns.push(Column {
                name: "branch".to_owned(),
                values: Values::Words(branches.collect()),
            });
        }
        let position = match data.position() {
            Position::Displacement => Some("displacement_m"),
            Position::Indentation => Some("measured_indentation_m"),
            Position::None => None,
        };
        if let Some(name) = position {
            let value = |row: &FittedRow| row.measurement.position.map(|measured| measured.value);
            columns.push(numbers(name, &value));
        }
        columns.push(numbers("indentation_m", &|row| {
            row.modelled.then_some(row.indentation)
        }));
        for quantity in Quantity::ALL {
            let (name, suffix) = match quantity {
                Quantity::Force => ("force", "_N"),
                Quantity::ContactRadius => ("contact_radius", "_m"),
            };
            let measured = |row: &FittedRow| -> Option<Measured> {
                match quantity {
                    Quantity::Force => row.measurement.force,
                    Quantity::ContactRadius => row.measurement.contact_radius,
                }
            };
            columns.extend([
                numbers(&format!("{name}{suffix}"), &|row| {
                    measured(row).map(|measured| measured.value)
                }),
                numbers(&format!("{name}_error{suffix}"), &|row| {
                    row.compared(quantity).map(|compared| compared.error)
                }),
                numbers(&format!("fitted_{name}{suffix}"), &|row| {
                    row.compared(quantity).map(|compared| compared.computed)
                }),
                numbers(&format!("{name}_residual{suffix}"), &|row| {
                    row.compared(quantity).map(|compared| compared.residual())
                }),
            ]);
        }
        if self.displacement_drift != 0.0 || self.force_drift != 0.0 {
            for (name, drift) in [
                ("displacement_drift_m", self.displacement_drift),
                ("force_drift_N", self.force_drift),
            ] {
                let values = self.moments.iter().map(|moment| Some(drift * moment));
                columns.push(Column {
                    name: name.to_owned(),
                    values: Values::Numbers(values.collect()),
                });
            }
        }
        columns.push(numbers("smallest_floor_gap_m", &|row| {
            row.smallest_floor_gap
        }));
        columns.push(Column {
            name: "used".to_owned(),
            values: Values::Flags(self.rows.iter().map(|row| Some(row.used)).collect()),
        });
        Table { columns }
    }
}

/// A fit, as `fakir fit --json` prints it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct FitSummary {
    method: &'static str,
    parameters: Vec<Map<String, Value>>,
    correlation: Vec<Vec<Option<f64>>>,
    undetermined: Vec<UndeterminedJson>,
    contact_point_m: Option<f64>,
    machine_compliance_m_per_N: Option<f64>,
    force_offset_N: f64,
    displacement_drift_m: f64,
    force_drift_N: f64,
    force_slope_N_per_m: f64,
    drift_over: &'static str,
    describes_data: bool,
    tests: TestsJson,
    limits: Vec<LimitObject>,
    starts: Vec<StartJson>,
    columns: Vec<ColumnJson>,
    rows_skipped: usize,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    skipped: Vec<SkippedJson>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pull_off: Option<PullOffJson>,
    rows: usize,
    rows_past_transition: usize,
    rows_not_modelled: usize,
    values: usize,
    degrees_of_freedom: usize,
    chi_square: f64,
    reduced_chi_square: Option<f64>,
    distribution: &'static str,
    scatter: Vec<Map<String, Value>>,
    converged: bool,
    termination: &'static str,
    iterations: usize,
    solutions: usize,
    wall_time_s: f64,
    fakir_version: &'static str,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct PullOffJson {
    measured_force_N: f64,
    fitted_force_N: f64,
    relative_error_of_model: f64,
    relative_error_of_work: Option<f64>,
}

/// Tests of whether the fit describes the data.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct TestsJson {
    level: f64,
    runs: Vec<RunsJson>,
    chi_square_p_value: Option<f64>,
    left_out: Vec<Map<String, Value>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rate: Option<RateJson>,
}

/// Test of whether the forces depend on the rate.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct RateJson {
    p_value: f64,
    relaxation_time_s: f64,
    strength: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct RunsJson {
    quantity: &'static str,
    branch: &'static str,
    positive: usize,
    negative: usize,
    runs: usize,
    expected_runs: f64,
    p_value: f64,
}

impl TestsJson {
    fn new(misfit: &Misfit, rate: Option<RateTest>) -> Self {
        let runs = |test: &RunsTest| RunsJson {
            quantity: test.quantity.name(),
            branch: test.branch.name(),
            positive: test.signs[0],
            negative: test.signs[1],
            runs: test.runs,
            expected_runs: test.expected(),
            p_value: test.p_value,
        };
        let wanted: Vec<Parameter> = misfit.wanted().map(|left| left.parameter).collect();
        let left_out = |left: &LeftOut| {
            Map::from_iter([
                ("name".to_owned(), Value::from(left.parameter.name())),
                ("p_value".to_owned(), Value::from(left.p_value)),
                (
                    "wanted".to_owned(),
                    Value::from(wanted.contains(&left.parameter)),
                ),
                (
                    format!("value{}", left.parameter.suffix()),
                    Value::from(left.value),
                ),
            ])
        };
        Self {
            level: LEVEL,
            runs: misfit.runs.iter().map(runs).collect(),
            chi_square_p_value: misfit.chi_square_p_value,
            left_out: misfit.left_out.iter().map(left_out).collect(),
            rate: rate.map(|rate| RateJson {
                p_value: rate.p_value,
                relaxation_time_s: rate.time,
                strength: rate.strength,
            }),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct StartJson {
    converged: bool,
    deviance_per_value: Option<f64>,
    is_answer: bool,
}

/// Interpretation of a column of the data.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct ColumnJson {
    number: usize,
    heading: String,
    quantity: Option<&'static str>,
    unit: Option<String>,
    negated: bool,
    by_hand: bool,
}

impl ColumnJson {
    fn new(read: &ReadColumn) -> Self {
        Self {
            number: read.number,
            heading: read.heading.clone(),
            quantity: read.column.map(super::Column::quantity),
            unit: read.unit.clone(),
            negated: read.negated,
            by_hand: read.by_hand,
        }
    }
}

/// Rows of the data that were skipped.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct SkippedJson {
    reason: &'static str,
    rows: usize,
    lines: Vec<u64>,
}

impl SkippedJson {
    fn new(skipped: &Skipped) -> Self {
        Self {
            reason: skipped.reason.name(),
            rows: skipped.lines.len(),
            lines: skipped.lines.clone(),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct UndeterminedJson {
    parameters: Vec<&'static str>,
    statement: String,
}

impl FitSummary {
    /// Summary of a fit.
    #[must_use]
    pub fn new(data: &Measurements, fitted: &Fit, wall_time: f64) -> Self {
        let of_displacement = data.position() == Position::Displacement;
        Self {
            method: fitted.method,
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
            force_offset_N: fitted.force_offset,
            displacement_drift_m: fitted.displacement_drift,
            force_drift_N: fitted.force_drift,
            force_slope_N_per_m: fitted.force_slope,
            drift_over: if data.has_times() { "time" } else { "rows" },
            describes_data: fitted.misfit.describes_data(),
            tests: TestsJson::new(&fitted.misfit, fitted.rate),
            limits: LimitObject::all(fitted.limits.clone()),
            starts: fitted
                .starts
                .iter()
                .map(|start| StartJson {
                    converged: start.converged,
                    deviance_per_value: start.deviance,
                    is_answer: start.is_answer,
                })
                .collect(),
            columns: data.layout().columns.iter().map(ColumnJson::new).collect(),
            rows_skipped: data.layout().rows_skipped(),
            skipped: data.layout().skipped.iter().map(SkippedJson::new).collect(),
            notes: data.layout().notes.clone(),
            pull_off: fitted.pull_off.map(|pull_off| PullOffJson {
                measured_force_N: pull_off.measured,
                fitted_force_N: pull_off.computed,
                relative_error_of_model: pull_off.model_error,
                relative_error_of_work: pull_off.work_error,
            }),
            rows: fitted.rows.len(),
            rows_past_transition: fitted.past_transition().count(),
            rows_not_modelled: fitted.not_modelled.len(),
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
            solutions: fitted.solutions,
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }
}

/// An estimate as a JSON object.
pub(super) fn estimate_json(estimate: &Estimate) -> Map<String, Value> {
    let suffix = estimate.parameter.suffix();
    Map::from_iter([
        ("name".to_owned(), Value::from(estimate.parameter.name())),
        (format!("value{suffix}"), Value::from(estimate.value)),
        (format!("start{suffix}"), Value::from(estimate.start)),
        (
            "determined".to_owned(),
            Value::from(estimate.interval.is_some()),
        ),
        ("one_sided".to_owned(), Value::from(estimate.one_sided)),
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

fn scatter_json(scatter: &Scatter) -> Map<String, Value> {
    let suffix = match scatter.quantity {
        Quantity::Force => "_N",
        Quantity::ContactRadius => "_m",
    };
    let mut all = Map::from_iter([
        ("quantity".to_owned(), Value::from(scatter.quantity.name())),
        ("values".to_owned(), Value::from(scatter.values)),
        (format!("residual{suffix}"), Value::from(scatter.residual)),
        (
            format!("estimated_error{suffix}"),
            Value::from(scatter.estimated),
        ),
    ]);
    if let Some(error) = scatter.interpolation_error {
        all.insert(format!("interpolation_error{suffix}"), Value::from(error));
    }
    all
}
