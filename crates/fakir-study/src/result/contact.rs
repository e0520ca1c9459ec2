//! The contact under a load.

use super::RelativeErrors;
use crate::VERSION;
use fakir::state::ContactState;
use serde::Serialize;

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
