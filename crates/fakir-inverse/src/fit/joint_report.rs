//! A joint fit as a JSON object, as a table and as warnings, for command line and Python package.

use super::Estimate;
use super::curves::CurveFit;
use super::curves_report::curve_table;
use super::joint::{Agreement, JointFit};
use super::report::{FitSummary, estimate_json};
use fakir::state::Termination;
use fakir_study::{Table, VERSION};
use serde::Serialize;
use serde_json::{Map, Value};

/// A joint fit, as `fakir fit --joint --json` prints it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointSummary {
    method: &'static str,
    joint: bool,
    shared: Vec<&'static str>,
    parameters: Vec<Map<String, Value>>,
    correlation: Vec<Vec<Option<f64>>>,
    undetermined: Vec<String>,
    curves: Vec<JointCurveJson>,
    agreement: Option<AgreementJson>,
    chi_square: f64,
    degrees_of_freedom: usize,
    chi_square_p_value: Option<f64>,
    describes_data: bool,
    converged: bool,
    termination: &'static str,
    iterations: usize,
    wall_time_s: f64,
    fakir_version: &'static str,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct JointCurveJson {
    file: String,
    problem: Option<String>,
    separate: Vec<Map<String, Value>>,
    fit: Option<FitSummary>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct AgreementJson {
    test: &'static str,
    statistic: f64,
    degrees_of_freedom: Vec<usize>,
    p_value: f64,
    agree: bool,
}

impl Agreement {
    /// Name of the distribution of the statistic: `chi_square` or `f`.
    #[must_use]
    pub fn distribution(&self) -> &'static str {
        match self.denominator {
            None => "chi_square",
            Some(_) => "f",
        }
    }
}

impl JointSummary {
    /// Summary of a joint fit.
    #[must_use]
    pub fn new(method: &'static str, joint: &JointFit, wall_time: f64) -> Self {
        let curve = |(curve, separate): (&CurveFit, &Vec<Estimate>)| JointCurveJson {
            file: curve.name.clone(),
            problem: curve.problem(),
            separate: separate.iter().map(estimate_json).collect(),
            fit: curve
                .outcome
                .as_ref()
                .ok()
                .map(|fitted| FitSummary::new(&fitted.data, &fitted.fit, fitted.wall_time)),
        };
        Self {
            method,
            joint: true,
            shared: joint.shared.iter().map(|e| e.parameter.name()).collect(),
            parameters: joint.shared.iter().map(estimate_json).collect(),
            correlation: joint.correlation.clone(),
            undetermined: joint.undetermined.clone(),
            curves: joint
                .curves
                .iter()
                .zip(&joint.separate)
                .map(curve)
                .collect(),
            agreement: joint.agreement.map(|test| AgreementJson {
                test: test.distribution(),
                statistic: test.statistic,
                degrees_of_freedom: [Some(test.degrees_of_freedom), test.denominator]
                    .into_iter()
                    .flatten()
                    .collect(),
                p_value: test.p_value,
                agree: joint.agrees(),
            }),
            chi_square: joint.chi_square,
            degrees_of_freedom: joint.degrees_of_freedom,
            chi_square_p_value: joint.chi_square_p_value,
            describes_data: joint.describes_data(),
            converged: joint.converged(),
            termination: joint.termination.description(),
            iterations: joint.iterations,
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }
}

impl JointFit {
    /// Why the joint fit does not describe the data: shared values that do not agree, and statements of the curves.
    #[must_use]
    pub fn misfit_statements(&self) -> Vec<String> {
        let mut statements = Vec::new();
        if let Some(test) = self.agreement.filter(|_| !self.agrees()) {
            let names: Vec<&str> = self.shared.iter().map(|e| e.parameter.name()).collect();
            statements.push(format!(
                "the curves do not agree on {} (p = {:.1e}), and the intervals of the joint fit do not hold: fit the curves separately",
                names.join(" and "),
                test.p_value
            ));
        }
        statements.extend(self.curves.iter().filter_map(|curve| {
            let statement = curve.outcome.as_ref().ok()?.fit.misfit_statement()?;
            Some(curve.named(&statement))
        }));
        statements
    }

    /// Warnings of the joint fit and of all curves.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self.undetermined.clone();
        if self.termination != Termination::Converged {
            warnings.push(format!("the joint fit {}", self.termination.description()));
        }
        if self.agreement.is_none() && self.curves.len() > 1 {
            warnings.push(
                "the agreement of the shared values is not tested: a separate fit did not converge"
                    .to_owned(),
            );
        }
        let misfits = self.misfit_statements();
        for curve in &self.curves {
            if let Ok(fitted) = &curve.outcome {
                let own = fitted.fit.warnings().into_iter();
                let of_search = fitted.fit.search_warning();
                let own = own.filter(|warning| Some(warning) != of_search.as_ref());
                warnings.extend(own.map(|warning| curve.named(&warning)));
            }
        }
        // Statements on agreement are not warnings of a curve.
        for statement in misfits {
            if !warnings.contains(&statement) {
                warnings.push(statement);
            }
        }
        warnings
    }

    /// Table of the results: one row for each curve.
    #[must_use]
    pub fn table(&self) -> Table {
        curve_table(&self.free, &self.curves, None)
    }
}
