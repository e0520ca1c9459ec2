//! The contact with a general surface, by cells.

use super::contact::{ErrorEstimate, Termination, Warning};
use super::critical::Critical;
use super::error::SolveError;
use super::finite::check_number;
use super::floor_contact::FloorErrors;
use super::resolution::{Remedy, Unresolved};
use crate::problem::{Grid, Point};

/// The contact of an indenter with a surface. Fields have one value for every cell of the grid.
#[derive(Debug, Clone)]
pub struct SurfaceContact {
    /// The cells.
    pub grid: Grid,
    /// Indentation, m; the [solver](crate::solve::elements::surface) defines its reference.
    pub indentation: f64,
    /// Normal force, N; on a periodic surface, the force per period.
    pub force: f64,
    /// Area of the cells in contact, m^2.
    pub contact_area: f64,
    /// Distance from the lens axis of the farthest cell in contact plus half its shorter side, m; `None` for a plate.
    pub contact_radius: Option<f64>,
    /// Pressure, Pa.
    pub pressure: Vec<f64>,
    /// Relative normal displacement of the two surfaces due to the pressure, including columns, m; on a periodic surface, relative to the
    /// mean displacement of the half-space.
    pub displacement: Vec<f64>,
    /// Gap between the two deformed surfaces, m. Infinite beyond the equator of the lens.
    pub gap: Vec<f64>,
    /// Load carried by tops and floor, if the [floor](crate::problem::Floor) is defined.
    pub shares: Option<LoadSharing>,
    /// Smallest gap to the floor, m, and its position, m, which may be between the centres of cells of equal height; `None` if the floor is
    /// not defined.
    pub nearest_floor: Option<(f64, Point)>,
    /// Duality gap and violation of the contact conditions.
    pub certificate: DualityGap,
    /// Estimated relative errors due to the cell size, zero for the prescribed quantity; `None` if the surface has too few cells, or a
    /// periodic surface an odd number of cells, for a comparison with cells twice as large.
    pub error: Option<ErrorEstimate>,
    /// Estimated relative error of the contact area due to the cell size; `None` if [`error`](Self::error) is `None`.
    pub area_error: Option<f64>,
    /// The same for the load carried by the floor, if it is defined.
    pub floor_error: Option<FloorErrors>,
    /// The numbers on cells of twice the size, if there are such cells: the side on which the estimated errors are more likely.
    pub larger_cells: Option<OnLargerCells>,
    /// Why the solver stopped.
    pub termination: Termination,
    /// Number of operator products on the last level.
    pub products: usize,
    /// Validity warnings.
    pub warnings: Vec<Warning>,
}

impl SurfaceContact {
    /// Checks that all numbers are finite before the contact is returned, and removes the sign of negative zeros.
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

    /// Whether the solver converged.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.termination == Termination::Converged
    }

    /// The first result of a converged solution that is [not resolved](Unresolved), among force, indentation and contact area, if errors
    /// are estimated. An indentation of 0 has no relative error, since it depends on the reference.
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

    /// Estimated error of the contact radius relative to it: the diagonal of a cell. `None` for a plate.
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

    /// Force divided by the area of the grid, Pa.
    #[must_use]
    pub fn mean_pressure(&self) -> f64 {
        self.force / (self.grid.cell_count() as f64 * self.grid.cell_area())
    }
}

/// Numbers of a contact on cells of twice the size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnLargerCells {
    /// Normal force, N.
    pub force: f64,
    /// Indentation, m.
    pub indentation: f64,
    /// Contact radius, m; `None` for a plate.
    pub contact_radius: Option<f64>,
}

/// The critical state on a general surface.
pub type SurfaceTransition = Critical<SurfaceContact>;

impl SurfaceTransition {
    /// Critical contact radius: the larger of the contact radius and the distance of the floor contact from the lens axis, m; `None` under a plate.
    #[must_use]
    pub fn contact_radius(&self) -> Option<f64> {
        let [x, y] = self.floor_contact;
        Some(self.contact.contact_radius?.max(x.hypot(y)))
    }
}

/// Load sharing between tops and floor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LoadSharing {
    /// All parts that are not floor.
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

/// Measures of how well pressures satisfy the contact conditions. Pressures are never negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DualityGap {
    /// Upper bound of the energy error divided by the elastic energy; see the [solver](crate::solve::elements::solver).
    pub energy_bound: f64,
    /// Deepest interpenetration anywhere, m.
    pub interpenetration: f64,
    /// Largest gap at an element with positive pressure, m.
    pub gap_under_pressure: f64,
}
