//! The contact under a load.

use super::{GradientObject, LimitObject, RelativeErrors};
use crate::VERSION;
use fakir::problem::System;
use fakir::state::{ContactState, FloorContact};
use serde::Serialize;

/// What the floor bears past the transition.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct FloorObject {
    force_N: f64,
    share: f64,
    contact_area_m2: f64,
    /// Distance of the farthest contact with the floor from the lens axis.
    radius_m: f64,
    smallest_distance_to_rim_m: f64,
    /// None where two grids differ.
    patches: Option<usize>,
    cell_m: [f64; 2],
    relative_error_estimate: FloorErrorsObject,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct FloorErrorsObject {
    share: f64,
    contact_area: f64,
}

impl From<&FloorContact> for FloorObject {
    fn from(floor: &FloorContact) -> Self {
        Self {
            force_N: floor.force,
            share: floor.share,
            contact_area_m2: floor.area,
            radius_m: floor.radius,
            smallest_distance_to_rim_m: floor.smallest_distance_to_rim,
            patches: floor.patches_agree.then_some(floor.patches),
            cell_m: floor.cell(),
            relative_error_estimate: FloorErrorsObject {
                share: floor.error.share,
                contact_area: floor.error.area,
            },
        }
    }
}

/// A number of what the floor bears: zero before it is touched, none past that if it was to be ignored.
#[must_use]
pub fn of_floor(state: &ContactState, number: impl Fn(&FloorContact) -> f64) -> Option<f64> {
    match &state.floor {
        Some(floor) => Some(number(floor)),
        None => (!state.beyond_transition()).then_some(0.0),
    }
}

/// The shape of a lens that is no sphere.
pub(super) fn lens_shape(system: &System) -> Option<&'static str> {
    let lens = system.lens();
    lens.sphere().is_none().then(|| lens.shape_name())
}

/// A contact under a load: what `fakir press --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct PressSummary {
    method: &'static str,
    /// Of a lens that is no sphere.
    #[serde(skip_serializing_if = "Option::is_none")]
    lens_shape: Option<&'static str>,
    force_N: f64,
    indentation_m: f64,
    contact_radius_m: f64,
    /// Of the pillar tops alone, where the floor is in contact too.
    #[serde(skip_serializing_if = "Option::is_none")]
    top_contact_radius_m: Option<f64>,
    pillars_in_contact: usize,
    pillars_partially_in_contact: usize,
    smallest_floor_gap_m: f64,
    beyond_transition: bool,
    /// None before the transition, and past it if the floor was to be ignored.
    floor: Option<FloorObject>,
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

impl PressSummary {
    /// A contact that took so many seconds.
    #[must_use]
    pub fn new(state: &ContactState, wall_time: f64) -> Self {
        Self {
            method: state.method.name(),
            lens_shape: lens_shape(&state.system),
            force_N: state.force,
            indentation_m: state.indentation,
            contact_radius_m: state.whole_contact_radius(),
            top_contact_radius_m: state.floor.as_ref().map(|_| state.contact_radius),
            pillars_in_contact: state.pillars_in_contact,
            pillars_partially_in_contact: state.pillars_partially_in_contact,
            smallest_floor_gap_m: state.smallest_floor_gap,
            beyond_transition: state.beyond_transition(),
            floor: state.floor.as_ref().map(FloorObject::from),
            relative_error_estimate: RelativeErrors::new(
                state.error,
                Some(state.relative_whole_contact_radius_error()),
            ),
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
