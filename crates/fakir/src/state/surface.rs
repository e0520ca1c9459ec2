//! The contact with any surface, cell by cell.

use super::checked::check_number;
use super::contact::{ErrorEstimate, Termination, Warning};
use super::critical::Critical;
use super::error::SolveError;
use super::floor_contact::FloorErrors;
use super::resolution::{Remedy, Unresolved};
use crate::problem::{Grid, Point};

/// The contact of an indenter with a surface. Fields have one value for every cell of the grid.
#[derive(Debug, Clone)]
pub struct SurfaceContact {
    /// The cells.
    pub grid: Grid,
    /// Indentation, m; the [solver](crate::solve::elements::surface) says from where it counts.
    pub indentation: f64,
    /// Normal force, N; on a periodic surface that on one period.
    pub force: f64,
    /// Area of the cells in contact, m^2.
    pub contact_area: f64,
    /// Distance from the lens axis of the farthest cell in contact, with half its shorter side,
    /// m; none under a plate.
    pub contact_radius: Option<f64>,
    /// Pressure, Pa.
    pub pressure: Vec<f64>,
    /// By how much the two surfaces have moved apart under the pressure, columns included, m; on
    /// a periodic surface relative to the mean displacement of the half-space.
    pub displacement: Vec<f64>,
    /// Gap between the two deformed surfaces, m. Infinite beyond the equator of the lens.
    pub gap: Vec<f64>,
    /// What tops and floor bear, where it is known which part of the surface is the [floor](crate::problem::Floor).
    pub shares: Option<LoadSharing>,
    /// Smallest gap to the floor, m, and where it is, m: between the centres of cells too, where these are of one height; likewise.
    pub nearest_floor: Option<(f64, Point)>,
    /// How well the contact conditions are met.
    pub certificate: DualityGap,
    /// Estimated relative errors from the size of the cells, zero of what was prescribed; none where the surface has too few
    /// cells, or a periodic one an odd number of them, to compare with cells twice as large.
    pub error: Option<ErrorEstimate>,
    /// Estimated relative error of the contact area, from the size of the cells; none where [`error`](Self::error) is none.
    pub area_error: Option<f64>,
    /// The same of what the floor carries, where it is known which part of the surface that is.
    pub floor_error: Option<FloorErrors>,
    /// Why the solver stopped.
    pub termination: Termination,
    /// Products with the operator on the last level.
    pub products: usize,
    /// What to be careful about.
    pub warnings: Vec<Warning>,
}

impl SurfaceContact {
    /// The contact as it is handed out: all of its numbers are numbers, and no zero has a sign.
    pub(crate) fn checked(mut self) -> Result<Self, SolveError> {
        check_number("force", &mut self.force)?;
        check_number("indentation", &mut self.indentation)?;
        check_number("contact area", &mut self.contact_area)?;
        if let Some(radius) = &mut self.contact_radius {
            check_number("contact radius", radius)?;
        }
        if let Some(error) = &mut self.error {
            check_number("error estimate of the force", &mut error.force)?;
            check_number("error estimate of the indentation", &mut error.indentation)?;
        }
        if let Some(error) = &mut self.area_error {
            check_number("error estimate of the contact area", error)?;
        }
        if let Some(error) = &mut self.floor_error {
            check_number("error estimate of the floor's share", &mut error.share)?;
            check_number("error estimate of the floor's area", &mut error.area)?;
        }
        if let Some((gap, _)) = &mut self.nearest_floor {
            check_number("floor gap", gap)?;
        }
        let certificate = &mut self.certificate;
        check_number("energy error", &mut certificate.energy_bound)?;
        check_number("interpenetration", &mut certificate.interpenetration)?;
        check_number("gap under pressure", &mut certificate.gap_under_pressure)?;
        for value in &mut self.pressure {
            check_number("pressure", value)?;
        }
        for value in &mut self.displacement {
            check_number("displacement", value)?;
        }
        for value in self.gap.iter_mut().filter(|gap| **gap < f64::INFINITY) {
            check_number("gap", value)?;
        }
        if self.gap.iter().any(|gap| gap.is_nan()) {
            return Err(SolveError::NotFinite { what: "gap" });
        }
        Ok(self)
    }

    /// Whether the numbers are the solution.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.termination == Termination::Converged
    }

    /// The first number of a solution that is [not resolved](Unresolved), of force, indentation and contact area, where errors are estimated. Of an indentation of 0,
    /// which only depends on where it is counted from, there is no relative error.
    #[must_use]
    pub fn unresolved(&self) -> Option<Unresolved> {
        let error = self.error.filter(|_| self.converged())?;
        let of_indentation = if self.indentation == 0.0 {
            0.0
        } else {
            error.indentation
        };
        let numbers = [
            ("force", error.force),
            ("indentation", of_indentation),
            ("contact area", self.area_error.unwrap_or(0.0)),
        ];
        Unresolved::among(numbers, Remedy::SmallerCells)
    }

    /// Estimated error of the contact radius relative to it: that of the cells, from corner to corner.
    /// `None` under a plate.
    #[must_use]
    pub fn relative_contact_radius_error(&self) -> Option<f64> {
        let [width, height] = self.grid.cell();
        let radius = self.contact_radius?;
        Some(if radius > 0.0 {
            width.hypot(height) / radius
        } else {
            0.0
        })
    }

    /// Force over the area of the grid, Pa.
    #[must_use]
    pub fn mean_pressure(&self) -> f64 {
        self.force / (self.grid.cell_count() as f64 * self.grid.cell_area())
    }
}

/// The critical state on any surface.
pub type SurfaceTransition = Critical<SurfaceContact>;

/// How the load is shared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LoadSharing {
    /// What is not floor.
    pub tops: Share,
    /// The floor.
    pub floor: Share,
}

/// A part of the load.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Share {
    /// Force, N.
    pub force: f64,
    /// Area in contact, m^2.
    pub area: f64,
}

/// How well pressures meet the contact conditions. Pressures are never negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DualityGap {
    /// Upper bound of the energy error over the elastic energy; see the
    /// [solver](crate::solve::elements::solver).
    pub energy_bound: f64,
    /// Deepest interpenetration anywhere, m.
    pub interpenetration: f64,
    /// Largest distance from contact of an element that bears pressure, m.
    pub gap_under_pressure: f64,
}
