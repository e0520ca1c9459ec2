//! Results as JSON objects: the names are a contract, and end in the unit of the number.

use crate::VERSION;
use fakir::problem::Point;
use fakir::state::{ContactState, CriticalState, ErrorEstimate, Normalized};
use serde::Serialize;

/// Estimated relative errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RelativeErrors {
    /// Of the force.
    pub force: f64,
    /// Of the indentation.
    pub indentation: f64,
    /// Of the contact radius, of a critical state the larger one; none under a plate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_radius: Option<f64>,
    /// Of the radius of the contact on the pillar tops of a critical state.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub top_contact_radius: Option<f64>,
}

impl RelativeErrors {
    /// Errors with that of the contact radius.
    #[must_use]
    pub fn new(error: ErrorEstimate, contact_radius: Option<f64>) -> Self {
        Self {
            force: error.force,
            indentation: error.indentation,
            contact_radius,
            top_contact_radius: None,
        }
    }
}

/// The paper's reduced variables.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ReducedVariables {
    /// `F gamma_int/(h d)`.
    pub force: f64,
    /// `a/e`.
    pub contact_radius: f64,
    /// `zeta/h`.
    pub indentation: f64,
}

impl From<Normalized> for ReducedVariables {
    fn from(normalized: Normalized) -> Self {
        Self {
            force: normalized.force,
            contact_radius: normalized.contact_radius,
            indentation: normalized.indentation,
        }
    }
}

/// A critical state: what `fakir transition --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct TransitionSummary {
    method: &'static str,
    regime: &'static str,
    surface_fraction: f64,
    pitch_m: f64,
    critical_force_N: f64,
    critical_indentation_m: f64,
    critical_contact_radius_m: f64,
    top_contact_radius_m: f64,
    bottom_contact_m: Point,
    pillars_in_contact: usize,
    pillars_partially_in_contact: usize,
    normalized: ReducedVariables,
    relative_error_estimate: RelativeErrors,
    converged: bool,
    iterations: usize,
    wall_time_s: f64,
    fakir_version: &'static str,
}

impl TransitionSummary {
    /// A critical state that took so many seconds.
    #[must_use]
    pub fn new(critical: &CriticalState, wall_time: f64) -> Self {
        let state = &critical.contact;
        Self {
            method: state.method.name(),
            regime: critical.regime.name(),
            surface_fraction: state.system.texture().surface_fraction(),
            pitch_m: state.system.lattice().pitch,
            critical_force_N: state.force,
            critical_indentation_m: state.indentation,
            critical_contact_radius_m: critical.contact_radius(),
            top_contact_radius_m: state.contact_radius,
            bottom_contact_m: critical.floor_contact,
            pillars_in_contact: state.pillars_in_contact,
            pillars_partially_in_contact: state.pillars_partially_in_contact,
            normalized: critical.normalized().into(),
            relative_error_estimate: RelativeErrors {
                top_contact_radius: Some(state.relative_contact_radius_error()),
                ..RelativeErrors::new(state.error, Some(critical.relative_contact_radius_error()))
            },
            converged: state.converged(),
            iterations: state.iterations,
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }
}

/// A contact under a load: what `fakir press --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct PressSummary {
    method: &'static str,
    force_N: f64,
    indentation_m: f64,
    contact_radius_m: f64,
    pillars_in_contact: usize,
    pillars_partially_in_contact: usize,
    smallest_floor_gap_m: f64,
    beyond_transition: bool,
    relative_error_estimate: RelativeErrors,
    converged: bool,
    iterations: usize,
    wall_time_s: f64,
    fakir_version: &'static str,
}

impl PressSummary {
    /// A contact that took so many seconds.
    #[must_use]
    pub fn new(state: &ContactState, wall_time: f64) -> Self {
        Self {
            method: state.method.name(),
            force_N: state.force,
            indentation_m: state.indentation,
            contact_radius_m: state.contact_radius,
            pillars_in_contact: state.pillars_in_contact,
            pillars_partially_in_contact: state.pillars_partially_in_contact,
            smallest_floor_gap_m: state.smallest_floor_gap,
            beyond_transition: state.beyond_transition(),
            relative_error_estimate: RelativeErrors::new(
                state.error,
                Some(state.relative_contact_radius_error()),
            ),
            converged: state.converged(),
            iterations: state.iterations,
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }
}
