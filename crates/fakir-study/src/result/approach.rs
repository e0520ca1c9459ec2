//! Loading step by step.

use super::TransitionSummary;
use fakir::contact::ContactState;
use serde::Serialize;

/// A state of the loading: a row of `approach.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct LoadingRow {
    /// Indentation, m.
    pub indentation_m: f64,
    /// Normal force, N.
    pub force_N: f64,
    /// Contact radius, m.
    pub contact_radius_m: f64,
    /// Number of pillars touched.
    pub pillars_in_contact: usize,
    /// Number of pillars crossed by the edge of the contact.
    pub pillars_partially_in_contact: usize,
    /// Smallest gap between lens and floor, m; negative past the transition.
    pub smallest_floor_gap_m: f64,
    /// Estimated relative error of the force.
    pub force_error_estimate: f64,
    /// Estimated relative error of the contact radius.
    pub contact_radius_error_estimate: f64,
    /// Whether it is the critical state.
    pub critical: bool,
    /// Whether the floor would have been touched already.
    pub beyond_transition: bool,
    /// Whether the numbers are the solution.
    pub converged: bool,
}

impl LoadingRow {
    pub(crate) fn new(state: &ContactState, critical: bool) -> Self {
        Self {
            indentation_m: state.indentation,
            force_N: state.force,
            contact_radius_m: state.contact_radius,
            pillars_in_contact: state.pillars_in_contact,
            pillars_partially_in_contact: state.pillars_partially_in_contact,
            smallest_floor_gap_m: state.smallest_floor_gap,
            force_error_estimate: state.error.force,
            contact_radius_error_estimate: state.relative_contact_radius_error(),
            critical,
            beyond_transition: state.beyond_transition(),
            converged: state.converged(),
        }
    }
}

/// A loading: what `fakir approach --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ApproachSummary {
    pub(crate) method: &'static str,
    pub(crate) critical: TransitionSummary,
    /// The states, by rising indentation.
    pub states: Vec<LoadingRow>,
    /// Whether all of them, and the critical state, are solutions.
    pub converged: bool,
    pub(crate) wall_time_s: f64,
    pub(crate) fakir_version: &'static str,
}
