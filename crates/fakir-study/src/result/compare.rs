//! The critical state by every method.

use crate::closed_forms::ClosedForm;
use fakir::state::{CriticalState, Solution, SolveError};
use serde::Serialize;

/// A critical state by one method: a row of `compare.csv`. Quantities that a method does not provide are `None`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct MethodRow {
    /// Name of the method or formula.
    pub method: &'static str,
    /// Descriptive name.
    #[serde(skip)]
    pub name: &'static str,
    /// Critical force, N.
    pub critical_force_N: Option<f64>,
    /// Critical indentation, m.
    pub critical_indentation_m: Option<f64>,
    /// Critical contact radius, m.
    pub critical_contact_radius_m: Option<f64>,
    /// Number of touched pillars.
    pub pillars_in_contact: Option<usize>,
    /// Relative difference from the reference.
    pub force_difference: Option<f64>,
    /// The same for the indentation.
    pub indentation_difference: Option<f64>,
    /// Estimated relative error of the force.
    pub force_error_estimate: Option<f64>,
    /// Estimated relative error of the contact radius.
    pub contact_radius_error_estimate: Option<f64>,
    /// Whether the numbers are converged and resolved, or there are none.
    pub converged: bool,
    /// Steps taken.
    pub iterations: Option<usize>,
    /// Computing time, s.
    pub wall_time_s: Option<f64>,
    /// Processor time of the whole process during the computation, s.
    pub processor_time_s: Option<f64>,
    /// Why there is no result, or that a formula is used out of its range.
    pub remark: Option<String>,
}

/// The critical state by every method: what `fakir compare --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CompareSummary {
    /// Fraction of the surface covered by pillar tops.
    pub surface_fraction: f64,
    /// Distance between neighbouring pillars, m.
    pub pitch_m: f64,
    /// The reference of the differences: the most accurate method with a result.
    pub reference: Option<&'static str>,
    /// Formulas and methods, approximate to exact.
    pub methods: Vec<MethodRow>,
    /// Number of threads.
    pub threads: usize,
    /// Whether all solutions converged and are resolved.
    pub converged: bool,
    pub(crate) fakir_version: &'static str,
}

impl CompareSummary {
    /// Descriptive name of the reference.
    #[must_use]
    pub fn reference_name(&self) -> Option<&'static str> {
        let reference = self.reference?;
        let row = self.methods.iter().find(|row| row.method == reference)?;
        Some(row.name)
    }
}

impl MethodRow {
    pub(crate) fn formula(form: &ClosedForm, adhesive: bool) -> Self {
        let remarks = [
            (!form.applies).then_some("out of its range"),
            adhesive.then_some("without adhesion"),
        ];
        let remarks: Vec<&str> = remarks.into_iter().flatten().collect();
        Self {
            critical_force_N: Some(form.estimate.force),
            critical_indentation_m: Some(form.estimate.indentation),
            critical_contact_radius_m: Some(form.estimate.contact_radius()),
            converged: true,
            remark: (!remarks.is_empty()).then(|| remarks.join(", ")),
            ..Self::empty(form.formula.key(), form.formula.name())
        }
    }

    pub(crate) fn solved(
        method: &'static str,
        name: &'static str,
        critical: &CriticalState,
    ) -> Self {
        let state = &critical.contact;
        Self {
            critical_force_N: Some(state.force),
            critical_indentation_m: Some(state.indentation),
            critical_contact_radius_m: Some(critical.contact_radius()),
            contact_radius_error_estimate: Some(critical.relative_contact_radius_error()),
            pillars_in_contact: Some(state.pillars_in_contact),
            force_error_estimate: Some(state.error.force),
            converged: state.is_answer(),
            iterations: Some(state.iterations),
            remark: state.problem(),
            ..Self::empty(method, name)
        }
    }

    /// A method that does not support the case is not a failure of the comparison; one that fails for another reason is.
    pub(crate) fn refused(method: &'static str, name: &'static str, error: &SolveError) -> Self {
        Self {
            converged: matches!(error, SolveError::Unsupported(_)),
            remark: Some(error.to_string()),
            ..Self::empty(method, name)
        }
    }

    fn empty(method: &'static str, name: &'static str) -> Self {
        Self {
            method,
            name,
            critical_force_N: None,
            critical_indentation_m: None,
            critical_contact_radius_m: None,
            pillars_in_contact: None,
            force_difference: None,
            indentation_difference: None,
            force_error_estimate: None,
            contact_radius_error_estimate: None,
            converged: false,
            iterations: None,
            wall_time_s: None,
            processor_time_s: None,
            remark: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir::problem::Method;
    use fakir::state::Run;
    use fakir_case::Case;

    #[test]
    fn a_method_whose_numbers_are_not_resolved_has_no_answer() {
        let system = Case::example().system;
        let mut critical =
            fakir::transition(&system, Method::Homogenised, &Run::default()).unwrap();
        let row = |critical: &CriticalState| MethodRow::solved("homogenised", "", critical);
        assert!(row(&critical).converged && row(&critical).remark.is_none());
        critical.contact.error.force = 0.6;
        let doubtful = row(&critical);
        assert!(!doubtful.converged);
        assert!(
            doubtful
                .remark
                .unwrap()
                .contains("the force is not resolved")
        );
    }
}
