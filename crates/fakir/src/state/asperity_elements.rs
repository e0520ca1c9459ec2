//! The contact with rounded tops, with boundary elements.

use super::contact::{ErrorEstimate, Termination};
use super::error::SolveError;
use super::finite::check_number;
use super::floor_contact::FloorErrors;

/// The contact with rounded tops, with boundary elements on every top.
#[derive(Debug, Clone)]
pub struct AsperityElements {
    /// Cells across every contact that is expected; with the floor, across their mean.
    pub cells: usize,
    /// Indentation, m.
    pub indentation: f64,
    /// Normal force, N.
    pub force: f64,
    /// Area of the cells of tops in contact, m^2.
    pub area: f64,
    /// Distance from the lens axis of the farthest cell in contact, as of [`AsperityContact`](super::AsperityContact), m; `None` for a level
    /// plate.
    pub contact_radius: Option<f64>,
    /// Force on every top, N.
    pub forces: Vec<f64>,
    /// Estimated relative errors due to the cell size, zero for the prescribed quantity.
    pub error: ErrorEstimate,
    /// Estimated relative error of the contact area.
    pub area_error: f64,
    /// The floor between the tops; `None` where it carries no load.
    pub floor: Option<FloorElements>,
    /// Why the solver stopped.
    pub termination: Termination,
    /// Number of operator products with these cells.
    pub products: usize,
}

/// The floor between rounded tops, with boundary elements on one grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FloorElements {
    /// Force on the floor, N.
    pub force: f64,
    /// Fraction of the total force carried by the floor.
    pub share: f64,
    /// Area of the cells in contact, m^2.
    pub area: f64,
    /// Estimated relative errors.
    pub error: FloorErrors,
    /// Number of cells along a side of the grid, which contains tops and floor.
    pub columns: usize,
}

impl AsperityElements {
    /// Whether the solver converged.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.termination == Termination::Converged
    }

    /// Number of tops that carry a force, of either sign with adhesion.
    #[must_use]
    pub fn touched(&self) -> usize {
        self.forces.iter().filter(|force| force.abs() > 0.0).count()
    }

    /// Checks that all numbers are finite before the contact is returned.
    pub(crate) fn checked(mut self) -> Result<Self, SolveError> {
        check_number("force", &mut self.force)?;
        check_number("indentation", &mut self.indentation)?;
        check_number("contact area", &mut self.area)?;
        if let Some(radius) = &mut self.contact_radius {
            check_number("contact radius", radius)?;
        }
        for force in &mut self.forces {
            check_number("force of an asperity", force)?;
        }
        check_number("error estimate of the force", &mut self.error.force)?;
        check_number(
            "error estimate of the indentation",
            &mut self.error.indentation,
        )?;
        check_number("error estimate of the area", &mut self.area_error)?;
        if let Some(floor) = &mut self.floor {
            check_number("force on the floor", &mut floor.force)?;
            check_number("fraction of the load on the floor", &mut floor.share)?;
            check_number(
                "error estimate of the floor's share",
                &mut floor.error.share,
            )?;
            check_number("error estimate of the floor's area", &mut floor.error.area)?;
        }
        Ok(self)
    }
}
