//! The states of a loading, as rows of a table.

use crate::record::of_floor;
use fakir::state::{ContactState, Solution, SurfaceContact};
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
    /// Smallest gap between lens and floor, m; past the transition negative if the floor was to be ignored.
    pub smallest_floor_gap_m: f64,
    /// Force on the floor, N; none past the transition if it was to be ignored.
    pub floor_force_N: Option<f64>,
    /// That over the whole force.
    pub floor_share: Option<f64>,
    /// Contact area on the floor, m^2.
    pub floor_contact_area_m2: Option<f64>,
    /// Distance of the farthest contact with the floor from the lens axis, m.
    pub floor_radius_m: Option<f64>,
    /// Estimated relative error of the force.
    pub force_error_estimate: f64,
    /// Estimated relative error of the contact radius.
    pub contact_radius_error_estimate: f64,
    /// Estimated relative error of the floor's share; none where the floor bears nothing.
    pub floor_share_error_estimate: Option<f64>,
    /// Estimated relative error of the contact area on the floor.
    pub floor_contact_area_error_estimate: Option<f64>,
    /// Whether it is the critical state.
    pub critical: bool,
    /// Whether the floor is touched, or would be if it was not to be ignored.
    pub beyond_transition: bool,
    /// Whether the numbers are the solution, and resolved.
    pub converged: bool,
}

impl LoadingRow {
    pub(crate) fn new(state: &ContactState, critical: bool) -> Self {
        Self {
            indentation_m: state.indentation,
            force_N: state.force,
            contact_radius_m: state.whole_contact_radius(),
            pillars_in_contact: state.pillars_in_contact,
            pillars_partially_in_contact: state.pillars_partially_in_contact,
            smallest_floor_gap_m: state.smallest_floor_gap,
            floor_force_N: of_floor(state, |floor| floor.force),
            floor_share: of_floor(state, |floor| floor.share),
            floor_contact_area_m2: of_floor(state, |floor| floor.area),
            floor_radius_m: of_floor(state, |floor| floor.radius),
            force_error_estimate: state.error.force,
            contact_radius_error_estimate: state.relative_whole_contact_radius_error(),
            floor_share_error_estimate: state.floor.as_ref().map(|floor| floor.error.share),
            floor_contact_area_error_estimate: state.floor.as_ref().map(|floor| floor.error.area),
            critical,
            beyond_transition: state.beyond_transition(),
            converged: state.is_answer(),
        }
    }
}

/// A state of the loading of a general surface: a row of `approach.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct SurfaceLoadingRow {
    /// Indentation, m.
    pub indentation_m: f64,
    /// Normal force, N.
    pub force_N: f64,
    /// Area of the cells in contact, m^2.
    pub contact_area_m2: f64,
    /// Contact radius, m; none under a plate.
    pub contact_radius_m: Option<f64>,
    /// Force on the tops, N; none where it is not known what the floor is.
    pub tops_force_N: Option<f64>,
    /// Contact area on the tops, m^2.
    pub tops_contact_area_m2: Option<f64>,
    /// Force on the floor, N.
    pub floor_force_N: Option<f64>,
    /// Contact area on the floor, m^2.
    pub floor_contact_area_m2: Option<f64>,
    /// Estimated relative error of the force; none on too few cells.
    pub force_error_estimate: Option<f64>,
    /// Estimated relative error of the contact radius.
    pub contact_radius_error_estimate: Option<f64>,
    /// Estimated relative error of the contact area; none on too few cells.
    pub contact_area_error_estimate: Option<f64>,
    /// Whether it is the critical state.
    pub critical: bool,
    /// Whether it is past that; none where it is not known what the floor is.
    pub beyond_transition: Option<bool>,
    /// Whether the numbers are the solution, and resolved.
    pub converged: bool,
}

impl SurfaceLoadingRow {
    pub(crate) fn new(
        contact: &SurfaceContact,
        critical: bool,
        beyond_transition: Option<bool>,
    ) -> Self {
        let tops = contact.shares.map(|shares| shares.tops);
        let floor = contact.shares.map(|shares| shares.floor);
        Self {
            indentation_m: contact.indentation,
            force_N: contact.force,
            contact_area_m2: contact.contact_area,
            contact_radius_m: contact.contact_radius,
            tops_force_N: tops.map(|share| share.force),
            tops_contact_area_m2: tops.map(|share| share.area),
            floor_force_N: floor.map(|share| share.force),
            floor_contact_area_m2: floor.map(|share| share.area),
            force_error_estimate: contact.error.map(|error| error.force),
            contact_radius_error_estimate: contact.relative_contact_radius_error(),
            contact_area_error_estimate: contact.area_error,
            critical,
            beyond_transition,
            converged: contact.is_answer(),
        }
    }
}
