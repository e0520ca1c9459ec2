//! The contact with rounded tops.

use super::contact::{PillarStatus, Termination, relative};
use super::discs::Contacts;
use super::error::SolveError;
use super::finite::check_number;
use super::floor_contact::{FloorContact, FloorErrors};
use super::resolution::{FLOOR_AREA, FLOOR_FORCE, Remedy, Unresolved};
use crate::problem::{Accuracy, Point};
use std::sync::Arc;

/// One asperity of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AsperityState {
    /// Whether it is in contact: partially, or with its whole top up to the rim.
    pub status: PillarStatus,
    /// Centre of the contact, m; for an asperity without contact, the point of the smallest gap.
    pub centre: Point,
    /// Radius of the contact, m.
    pub radius: f64,
    /// Normal force on it, N.
    pub force: f64,
    /// Gap at an asperity without contact, m; zero for others.
    pub gap: f64,
}

/// Derivatives of force and area. Those with respect to heights are at constant indentation. They are one-sided at loads at which contacts
/// begin or end. Past the transition they are differences of contacts on one grid; with adhesion, derivatives with the same cells of the floor in contact.
#[derive(Debug, Clone, PartialEq)]
pub struct AsperitySlopes {
    /// Derivative of the force with respect to the indentation, N/m.
    pub force_with_indentation: f64,
    /// Derivative of the area with respect to the indentation, m.
    pub area_with_indentation: f64,
    /// Derivative of the force with respect to the height of every asperity, N/m.
    pub force_with_height: Vec<f64>,
    /// Derivative of the area with respect to the height of every asperity, m; empty past the transition, where it is not computed.
    pub area_with_height: Vec<f64>,
}

impl AsperitySlopes {
    /// Derivative of the area with respect to the height of an asperity at constant force, m; zero without contact, NaN past the transition.
    #[must_use]
    pub fn area_with_height_at_force(&self, asperity: usize) -> f64 {
        let at_indentation = self.area_with_height.get(asperity).copied();
        at_indentation.unwrap_or(f64::NAN)
            + self.area_with_indentation * self.indentation_with_height(asperity)
    }

    /// Derivative of the indentation with respect to the height of an asperity at constant force; zero without contact.
    #[must_use]
    pub fn indentation_with_height(&self, asperity: usize) -> f64 {
        if self.force_with_indentation > 0.0 {
            -self.force_with_height[asperity] / self.force_with_indentation
        } else {
            0.0
        }
    }
}

/// Estimated errors of a contact, from a pressure of a higher degree and from the ovality of the contacts. They are errors of the solution,
/// not of the model.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AsperityErrors {
    /// Relative error of the force.
    pub force: f64,
    /// Relative error of the area.
    pub area: f64,
    /// Error of the indentation, m.
    pub indentation: f64,
}

/// The smallest gap between the lens and the floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AsperityFloorGap {
    /// The gap, m; zero if the floor is in contact, negative where the lens would be below the floor, whose load is then not
    /// computed.
    pub gap: f64,
    /// Position of this point of the floor, m from the lens axis.
    pub position: Point,
}

/// The contact of a [`AsperityArray`](crate::problem::AsperityArray).
#[derive(Debug, Clone)]
pub struct AsperityContact {
    /// Accuracy setting of the solution.
    pub accuracy: Accuracy,
    /// Indentation, m: displacement of the lens or the plate below the reference level.
    pub indentation: f64,
    /// Normal force, N.
    pub force: f64,
    /// Area in contact on the tops, m^2.
    pub area: f64,
    /// Distance from the lens axis of the farthest point in contact on a top, m; from the origin for a cylinder and a tilted plate, `None` for a level
    /// plate.
    pub contact_radius: Option<f64>,
    /// Every asperity, in the order of the array.
    pub asperities: Vec<AsperityState>,
    /// Derivatives of force and area with respect to indentation and heights; exact for the discrete
    /// solution, except past the transition.
    pub slopes: AsperitySlopes,
    /// Estimated errors, if they were requested and are available.
    pub error: Option<AsperityErrors>,
    /// The smallest gap between the lens and the [floor](crate::problem::AsperityArray::with_floor); `None` without a floor, under a plate or
    /// a cylinder, which come closest to it outside the pillars, and if it was not requested.
    pub floor_gap: Option<AsperityFloorGap>,
    /// The floor contact; `None` if the floor is not touched, or its load is not computed.
    pub floor: Option<FloorContact>,
    /// Why the solver stopped.
    pub termination: Termination,
    /// Number of Newton steps.
    pub iterations: usize,
    pub(crate) contacts: Arc<Contacts>,
}

impl AsperityContact {
    /// Whether the solver converged.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.termination == Termination::Converged
    }

    /// The first result of a converged solution that is [not resolved](Unresolved), among force, contact area and indentation, and force and
    /// area on the floor, if errors are estimated. The error of the indentation is relative to the indentation or to force divided by stiffness, whichever is larger,
    /// since the reference level is arbitrary.
    #[must_use]
    pub fn unresolved(&self) -> Option<Unresolved> {
        let error = self.error.filter(|_| self.converged())?;
        let rise = relative(self.force, self.slopes.force_with_indentation);
        let depth = self.indentation.abs().max(rise);
        let floor = self.floor.as_ref().map(|floor| floor.error);
        let known = floor.filter(|error| *error != FloorErrors::UNKNOWN);
        let of_floor = |of: fn(&FloorErrors) -> f64| known.as_ref().map_or(0.0, of);
        let numbers = [
            ("force", error.force),
            ("contact area", error.area),
            ("indentation", relative(error.indentation, depth)),
            (FLOOR_FORCE, of_floor(|error| error.force)),
            (FLOOR_AREA, of_floor(|error| error.area)),
        ];
        let remedy = match self.accuracy {
            Accuracy::Default => Remedy::AccurateSetting,
            Accuracy::Accurate => Remedy::HigherLoad,
        };
        Unresolved::among(numbers, remedy)
    }

    /// Whether the lens has reached the floor, whether or not its load is computed; `None` if that is not known.
    #[must_use]
    pub fn beyond_transition(&self) -> Option<bool> {
        let gap = self.floor_gap.map(|floor| floor.gap < 0.0);
        self.floor.as_ref().map_or(gap, |_| Some(true))
    }

    /// Number of asperities that are touched.
    #[must_use]
    pub fn touched(&self) -> usize {
        self.contacts.discs.len()
    }

    /// Checks that all numbers are finite before the contact is returned.
    pub(crate) fn checked(mut self) -> Result<Self, SolveError> {
        check_number("force", &mut self.force)?;
        check_number("indentation", &mut self.indentation)?;
        check_number("contact area", &mut self.area)?;
        if let Some(radius) = &mut self.contact_radius {
            check_number("contact radius", radius)?;
        }
        for asperity in &mut self.asperities {
            check_number("force of an asperity", &mut asperity.force)?;
            check_number("radius of a contact", &mut asperity.radius)?;
        }
        let slopes = &mut self.slopes;
        check_number("stiffness", &mut slopes.force_with_indentation)?;
        check_number("slope of the area", &mut slopes.area_with_indentation)?;
        let with_height = slopes.force_with_height.iter_mut();
        for slope in with_height.chain(&mut slopes.area_with_height) {
            check_number("slope with a height", slope)?;
        }
        if let Some(floor) = &mut self.floor_gap {
            check_number("gap of the floor", &mut floor.gap)?;
        }
        if let Some(floor) = &mut self.floor {
            floor.check()?;
        }
        if let Some(error) = &mut self.error {
            check_number("error estimate of the force", &mut error.force)?;
            check_number("error estimate of the area", &mut error.area)?;
            check_number("error estimate of the indentation", &mut error.indentation)?;
        }
        Ok(self)
    }
}
