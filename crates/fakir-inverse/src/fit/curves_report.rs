//! Several fits as a JSON object, as a table and as warnings, for command line and Python package.

use super::curves::{CurveFit, CurveFits};
use super::measurements::Quantity;
use super::parameter::Parameter;
use super::report::FitSummary;
use super::statistics::{FEWEST_FOR_OUTLIERS, OUTLIER_SCORE, Statistics};
use fakir_study::{Column, Table, VERSION, Values};
use serde::Serialize;
use serde_json::{Map, Value, json};

/// Several fits, as `fakir fit --json` prints them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CurvesSummary {
    method: &'static str,
    joint: bool,
    curves: Vec<CurveJson>,
    parameters: Vec<Map<String, Value>>,
    outlier_score: f64,
    fewest_curves_for_outliers: usize,
    failed: usize,
    describes_data: bool,
    converged: bool,
    wall_time_s: f64,
    fakir_version: &'static str,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct CurveJson {
    file: String,
    problem: Option<String>,
    outlier_of: Vec<&'static str>,
    fit: Option<FitSummary>,
}

impl CurvesSummary {
    /// Summary of several fits.
    #[must_use]
    pub fn new(method: &'static str, fits: &CurveFits, wall_time: f64) -> Self {
        let curve = |(number, curve): (usize, &CurveFit)| CurveJson {
            file: curve.name.clone(),
            problem: curve.problem(),
            outlier_of: fits.outlier_of(number),
            fit: curve
                .outcome
                .as_ref()
                .ok()
                .map(|fitted| FitSummary::new(&fitted.data, &fitted.fit, fitted.wall_time)),
        };
        let of = fits.free.iter().zip(&fits.statistics);
        let failed = fits.failed().count();
        Self {
            method,
            joint: false,
            curves: fits.curves.iter().enumerate().map(curve).collect(),
            parameters: of
                .map(|(parameter, found)| fits.statistics_json(*parameter, found.as_ref()))
                .collect(),
            outlier_score: OUTLIER_SCORE,
            fewest_curves_for_outliers: FEWEST_FOR_OUTLIERS,
            failed,
            describes_data: fits.describe_data(),
            converged: failed == 0,
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }
}

impl CurveFits {
    /// Names of the parameters of which a curve, by its number, is an outlier.
    #[must_use]
    pub fn outlier_of(&self, curve: usize) -> Vec<&'static str> {
        let outliers = self.outliers();
        let of_curve = outliers.filter(|(_, outlier)| outlier.curve == curve);
        of_curve.map(|(parameter, _)| parameter.name()).collect()
    }

    /// Whether all fits describe their data.
    #[must_use]
    pub fn describe_data(&self) -> bool {
        let fitted = self
            .curves
            .iter()
            .filter_map(|curve| curve.outcome.as_ref().ok());
        fitted
            .into_iter()
            .all(|fitted| fitted.fit.misfit.describes_data())
    }

    fn statistics_json(
        &self,
        parameter: Parameter,
        found: Option<&Statistics>,
    ) -> Map<String, Value> {
        let suffix = parameter.suffix();
        let weighted = found.and_then(|found| found.weighted_mean);
        let outliers = found.map_or(&[][..], |found| &found.outliers);
        let outliers = outliers.iter().map(|outlier| {
            Map::from_iter([
                (
                    "file".to_owned(),
                    json!(self.curves.get(outlier.curve).map(|curve| &curve.name)),
                ),
                (format!("value{suffix}"), json!(outlier.value)),
                ("modified_z_score".to_owned(), json!(outlier.score)),
            ])
        });
        let with_unit = |name: &str, value: Option<f64>| (format!("{name}{suffix}"), json!(value));
        Map::from_iter([
            ("name".to_owned(), json!(parameter.name())),
            (
                "curves".to_owned(),
                json!(found.map_or(0, |found| found.count)),
            ),
            with_unit("mean", found.map(|found| found.mean)),
            with_unit(
                "standard_deviation",
                found.and_then(|found| found.standard_deviation),
            ),
            with_unit(
                "standard_error_of_mean",
                found.and_then(|found| found.standard_error),
            ),
            with_unit("median", found.map(|found| found.median)),
            with_unit("weighted_mean", weighted.map(|mean| mean.value)),
            with_unit(
                "standard_error_of_weighted_mean",
                weighted.map(|mean| mean.standard_error),
            ),
            (
                "agreement_chi_square".to_owned(),
                json!(weighted.map(|mean| mean.chi_square)),
            ),
            (
                "agreement_p_value".to_owned(),
                json!(weighted.and_then(|mean| mean.p_value)),
            ),
            (
                "outliers".to_owned(),
                Value::Array(outliers.map(Value::Object).collect()),
            ),
        ])
    }

    /// Warnings of all fits with the names of their curves, and curves without a result.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let of = |curve: &CurveFit| -> Vec<String> {
            match &curve.outcome {
                Err(error) => vec![format!("no fit of {}", curve.named(&error.to_string()))],
                Ok(fitted) => {
                    let warnings = fitted.fit.warnings();
                    warnings
                        .iter()
                        .map(|warning| curve.named(warning))
                        .collect()
                }
            }
        };
        self.curves.iter().flat_map(of).collect()
    }

    /// Table of the results: one row for each curve.
    #[must_use]
    pub fn table(&self) -> Table {
        curve_table(
            &self.free,
            &self.curves,
            Some(&|number| self.outlier_of(number)),
        )
    }
}

/// Table of the results of several curves: one row for each.
pub(super) fn curve_table(
    free: &[Parameter],
    curves: &[CurveFit],
    outlier_of: Option<&dyn Fn(usize) -> Vec<&'static str>>,
) -> Table {
    let fits = || {
        let of = curves.iter();
        of.map(|curve| curve.outcome.as_ref().ok().map(|fitted| &fitted.fit))
    };
    let column = |name: String, values: Values| Column { name, values };
    let files = curves.iter().map(|curve| Some(curve.name.clone()));
    let mut columns = vec![column("file".to_owned(), Values::Words(files.collect()))];
    for (number, parameter) in free.iter().enumerate() {
        let (name, suffix) = (parameter.name(), parameter.suffix());
        let estimates = || fits().map(|fit| fit?.estimates.get(number));
        let values = estimates().map(|estimate| Some(estimate?.value));
        let errors = estimates().map(|estimate| estimate?.standard_error);
        columns.extend([
            column(format!("{name}{suffix}"), Values::Numbers(values.collect())),
            column(
                format!("{name}_standard_error{suffix}"),
                Values::Numbers(errors.collect()),
            ),
        ]);
    }
    for quantity in Quantity::ALL {
        let name = match quantity {
            Quantity::Force => "rms_force_residual_N",
            Quantity::ContactRadius => "rms_contact_radius_residual_m",
        };
        let residuals: Vec<Option<f64>> = fits()
            .map(|fit| {
                let mut scatters = fit?.scatter.iter();
                let of = scatters.find(|scatter| scatter.quantity == quantity);
                Some(of?.residual)
            })
            .collect();
        if residuals.iter().any(Option::is_some) {
            columns.push(column(name.to_owned(), Values::Numbers(residuals)));
        }
    }
    let count = |value: Option<usize>| value.and_then(|value| i64::try_from(value).ok());
    let freedoms = fits().map(|fit| count(fit.map(|fit| fit.degrees_of_freedom)));
    let described = fits().map(|fit| Some(fit?.misfit.describes_data()));
    let problems = curves.iter();
    let problems = problems.map(|curve| Some(curve.problem().unwrap_or_default()));
    let converged = curves.iter();
    let converged = converged.map(|curve| Some(curve.converged().is_some()));
    columns.extend([
        column(
            "degrees_of_freedom".to_owned(),
            Values::Counts(freedoms.collect()),
        ),
        column(
            "describes_data".to_owned(),
            Values::Flags(described.collect()),
        ),
    ]);
    if let Some(outlier_of) = outlier_of {
        let outliers = (0..curves.len()).map(|number| Some(outlier_of(number).join(" ")));
        columns.push(column(
            "outlier_of".to_owned(),
            Values::Words(outliers.collect()),
        ));
    }
    columns.extend([
        column("converged".to_owned(), Values::Flags(converged.collect())),
        column("problem".to_owned(), Values::Words(problems.collect())),
    ]);
    Table { columns }
}
