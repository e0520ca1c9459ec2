//! What the floor between the pillars bears.

use crate::problem::point::turned;
use crate::problem::{Cells, Point};

/// The contact with the floor between the pillars. Its pressure is constant on the cells of a grid that is aligned with the lattice.
#[derive(Debug, Clone, PartialEq)]
pub struct FloorContact {
    /// Normal force on the floor, N.
    pub force: f64,
    /// That force over the whole one.
    pub share: f64,
    /// Area in contact, m^2: that of the cells, less what cells along its border count too much on the average.
    pub area: f64,
    /// Groups of cells in contact that share sides: a count of the grid. Bridges between neighbouring patches are narrow while they
    /// form, so that it is a number of the contact only if [two grids agree](Self::patches_agree).
    pub patches: usize,
    /// Whether the grid of twice the cell size has as many.
    pub patches_agree: bool,
    /// Distance of the farthest contact with the floor from the lens axis, m; half a cell too far on the average.
    pub radius: f64,
    /// Smallest distance between a contact with the floor and the rim of a pillar, m.
    pub smallest_distance_to_rim: f64,
    /// Estimated relative errors.
    pub error: FloorErrors,
    /// How well the pressures meet the contact conditions: an upper bound of the error of the energy, over the energy. The pillar tops
    /// count as solved. Zero where the floor sticks, whose fronts stand by their energy.
    pub energy_bound: f64,
    /// The cells in contact, of a grid with the lens axis at the origin, m; before it is [turned](Self::rotation).
    pub cells: Cells,
    /// By how much that grid is turned about the lens axis, rad: as much as a lattice is from how one of its kind is drawn.
    pub rotation: f64,
    /// The pressure on each of them, Pa.
    pub pressure: Vec<f64>,
}

/// Estimated relative errors of what the floor bears, from two grids and from refinement on pillars.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FloorErrors {
    /// Of the force on the floor, and so of its share.
    pub share: f64,
    /// Of the area.
    pub area: f64,
}

impl FloorErrors {
    /// Nothing is known of them.
    pub(crate) const UNKNOWN: Self = Self {
        share: 1.0,
        area: 1.0,
    };
}

impl FloorContact {
    /// Sides of a cell along x and y, m.
    #[must_use]
    pub fn cell(&self) -> [f64; 2] {
        self.cells.grid().cell()
    }

    /// The centre of every cell in contact, turned as the grid is, m from the lens axis.
    pub fn centres(&self) -> impl Iterator<Item = Point> + '_ {
        self.cells.centres().map(|centre| self.placed(centre))
    }

    /// Where a point of the grid is when that is turned, m from the lens axis.
    #[must_use]
    pub fn placed(&self, point: Point) -> Point {
        self.turned_by(point, self.rotation)
    }

    /// Where a point (m from the lens axis) is on the grid before that is turned.
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
