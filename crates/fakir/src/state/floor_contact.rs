//! Contact with the floor between the pillars.

use super::error::SolveError;
use super::finite::check_number;
use crate::problem::point::turned;
use crate::problem::{Area, Cells, Point};

/// The contact with the floor between the pillars. Its pressure is constant on the cells of a grid that is aligned with the lattice.
#[derive(Debug, Clone, PartialEq)]
pub struct FloorContact {
    /// Normal force on the floor, N.
    pub force: f64,
    /// Fraction of the total force carried by the floor.
    pub share: f64,
    /// Area in contact, m^2: that of the cells, minus the mean excess of cells along its border.
    pub area: f64,
    /// Number of groups of cells in contact that share sides, on this grid. Bridges between adjacent patches are narrow while they form, so
    /// that this is a property of the contact only if [two grids agree](Self::patches_agree).
    pub patches: usize,
    /// Whether the number is the same on the grid with twice the cell size.
    pub patches_agree: bool,
    /// Distance of the farthest floor contact from the lens axis, m; half a cell too large on average.
    pub radius: f64,
    /// Smallest distance between a contact with the floor and the rim of a pillar, m.
    pub smallest_distance_to_rim: f64,
    /// Estimated relative errors.
    pub error: FloorErrors,
    /// Duality gap: an upper bound of the energy error, divided by the energy. The pillar tops are assumed to be solved. Zero for an
    /// adhesive floor, whose fronts are determined by their energy.
    pub energy_bound: f64,
    /// The cells in contact, on a grid with the lens axis at the origin, m; before its [rotation](Self::rotation).
    pub cells: Cells,
    /// Rotation of this grid about the lens axis, rad: that of the lattice relative to its standard orientation.
    pub rotation: f64,
    /// The pressure on each of these cells, Pa.
    pub pressure: Vec<f64>,
}

/// Estimated relative errors of the floor contact, from two grids and from refinement on pillars.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FloorErrors {
    /// Error of the force on the floor.
    pub force: f64,
    /// Error of its fraction of the load: the same, unless the floor pulls with more than the load, which may then pass through zero.
    pub share: f64,
    /// Error of the area.
    pub area: f64,
}

impl FloorErrors {
    /// The errors are unknown.
    pub(crate) const UNKNOWN: Self = Self {
        force: 1.0,
        share: 1.0,
        area: 1.0,
    };

    /// Errors of a floor that carries a part of the load.
    pub(crate) fn of_part(share: f64, area: f64) -> Self {
        Self {
            force: share,
            share,
            area,
        }
    }
}

impl FloorContact {
    /// The area in contact with its error.
    pub(crate) fn contact_area(&self) -> Area {
        Area {
            value: self.area,
            error: Some(self.error.area * self.area),
        }
    }

    /// Sides of a cell along x and y, m.
    #[must_use]
    pub fn cell(&self) -> [f64; 2] {
        self.cells.grid().cell()
    }

    /// The centre of every cell in contact, rotated with the grid, m from the lens axis.
    pub fn centres(&self) -> impl Iterator<Item = Point> + '_ {
        self.cells.centres().map(|centre| self.placed(centre))
    }

    /// Position of a point of the grid after the rotation, m from the lens axis.
    #[must_use]
    pub fn placed(&self, point: Point) -> Point {
        self.turned_by(point, self.rotation)
    }

    /// Position of a point (m from the lens axis) in the grid before the rotation.
    #[must_use]
    pub fn on_grid(&self, point: Point) -> Point {
        self.turned_by(point, -self.rotation)
    }

    fn turned_by(&self, point: Point, angle: f64) -> Point {
        if self.rotation == 0.0 {
            point
        } else {
            turned(point, angle)
        }
    }

    /// The largest pressure, Pa, and the centre of its cell, m from the lens axis.
    #[must_use]
    pub fn largest_pressure(&self) -> (f64, Point) {
        let pressures = self.pressure.iter().copied().zip(self.centres());
        pressures.fold((0.0, [0.0, 0.0]), |largest, other| {
            if other.0 > largest.0 { other } else { largest }
        })
    }
}

impl FloorContact {
    /// Checks that all numbers of the contact are finite before it is returned.
    pub(super) fn check(&mut self) -> Result<(), SolveError> {
        for (what, value) in [
            ("force on the floor", &mut self.force),
            ("fraction of the load on the floor", &mut self.share),
            ("area of the floor contact", &mut self.area),
            ("radius of the floor contact", &mut self.radius),
            (
                "distance of the floor contact from a rim",
                &mut self.smallest_distance_to_rim,
            ),
            ("error estimate of the floor's force", &mut self.error.force),
            ("error estimate of the floor's share", &mut self.error.share),
            ("error estimate of the floor's area", &mut self.error.area),
            ("energy error", &mut self.energy_bound),
        ] {
            check_number(what, value)?;
        }
        for pressure in &mut self.pressure {
            check_number("pressure on the floor", pressure)?;
        }
        Ok(())
    }
}
