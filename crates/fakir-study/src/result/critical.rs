//! The critical state.

use super::contact::lens_shape;
use super::{GradientObject, LimitObject, ReducedVariables, RelativeErrors};
use crate::VERSION;
use fakir::problem::Point;
use fakir::state::{ContactState, CriticalState};
use serde::Serialize;

/// A critical state: what `fakir transition --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct TransitionSummary {
    method: &'static str,
    /// Of a lens that is no sphere.
    #[serde(skip_serializing_if = "Option::is_none")]
    lens_shape: Option<&'static str>,
    regime: &'static str,
    surface_fraction: f64,
    pitch_m: f64,
    critical_force_N: f64,
    critical_indentation_m: f64,
    critical_contact_radius_m: f64,
    top_contact_radius_m: f64,
    bottom_contact_m: Point,
    floor_contact_m: Point,
    pillars_in_contact: usize,
    pillars_partially_in_contact: usize,
    normalized: ReducedVariables,
    relative_error_estimate: RelativeErrors,
    limits: Vec<LimitObject>,
    /// Where it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    gradient: Option<GradientObject>,
    converged: bool,
    /// The quantity that is not resolved, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    unresolved: Option<&'static str>,
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
            lens_shape: lens_shape(&state.system),
            regime: critical.regime.name(),
            surface_fraction: state.system.texture().surface_fraction(),
            pitch_m: state.system.pitch(),
            critical_force_N: state.force,
            critical_indentation_m: state.indentation,
            critical_contact_radius_m: critical.contact_radius(),
            top_contact_radius_m: state.contact_radius,
            bottom_contact_m: critical.floor_contact,
            floor_contact_m: critical.floor_contact,
            pillars_in_contact: state.pillars_in_contact,
            pillars_partially_in_contact: state.pillars_partially_in_contact,
            normalized: critical.normalized().into(),
            relative_error_estimate: RelativeErrors {
                top_contact_radius: Some(state.relative_contact_radius_error()),
                ..RelativeErrors::new(state.error, Some(critical.relative_contact_radius_error()))
            },
            limits: LimitObject::all(state.limits(None)),
            gradient: None,
            converged: state.converged(),
            unresolved: state.unresolved().map(|it| it.quantity),
            iterations: state.iterations,
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }

    /// The same with derivatives, if there are any.
    #[must_use]
    pub fn with_gradient(self, gradient: Option<GradientObject>) -> Self {
        Self { gradient, ..self }
    }

    /// The same where the range of the attraction (m) is known, or is not.
    #[must_use]
    pub fn with_range(self, state: &ContactState, range: Option<f64>) -> Self {
        Self {
            limits: LimitObject::all(state.limits(range)),
            ..self
        }
    }
}
