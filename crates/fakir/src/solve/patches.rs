//! Geometry of the floor cells that carry pressure: area, border, groups and distances.

use crate::numerics::neighbours::{Nearest, Neighbours};
use crate::problem::{Cells, Point};

/// Bias of the contact area of cells, and its uncertainty, as fractions of the border length times the cell size.
const BORDER_BIAS: f64 = 0.025;
const BORDER_ERROR: f64 = 0.05;

/// Geometry of the set of floor cells in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Patches {
    /// Number of cells, and number of groups of cells that share sides.
    pub(crate) cells: usize,
    pub(crate) count: usize,
    /// Total length of the sides between cells in contact and others.
    pub(crate) perimeter: f64,
    /// Distance of the farthest corner from the lens axis.
    pub(crate) radius: f64,
    /// Smallest distance from the rim of a pillar.
    pub(crate) rim_distance: f64,
}

impl Default for Patches {
    /// No cells.
    fn default() -> Self {
        Self {
            cells: 0,
            count: 0,
            perimeter: 0.0,
            radius: 0.0,
            rim_distance: f64::INFINITY,
        }
    }
}

impl Patches {
    /// The cells among these that are loaded, between pillars given as discs. None are at the border of the grid.
    pub(crate) fn of(
        cells: &Cells,
        is_loaded: impl Iterator<Item = bool>,
        pillars: &Neighbours,
    ) -> Self {
        let mut patches = Self::default();
        let grid = cells.grid();
        let ([width, height], columns) = (grid.cell(), grid.columns());
        let mut loaded = vec![false; grid.cell_count()];
        for (index, own) in cells.indices().zip(is_loaded) {
            loaded[index] = own;
        }
        // Nothing is touched beyond the last column and row, because the window ends before them.
        let neighbours = |index: usize| {
            [
                (index.wrapping_sub(1), height),
                (index + 1, height),
                (index.wrapping_sub(columns), width),
                (index + columns, width),
            ]
        };
        let mut seen = vec![false; loaded.len()];
        let mut open = Vec::new();
        let mut radius_squared: f64 = 0.0;
        for index in 0..loaded.len() {
            if !loaded[index] {
                continue;
            }
            patches.cells += 1;
            let mut on_border = false;
            for (neighbour, side) in neighbours(index) {
                if !loaded.get(neighbour).is_some_and(|loaded| *loaded) {
                    patches.perimeter += side;
                    on_border = true;
                }
            }
            let [x, y] = grid.centre(index % columns, index / columns);
            let distance = |point: Point| {
                let nearest = pillars.nearest(point, Nearest::Edge, 0.0, None);
                nearest.map_or(f64::INFINITY, |(_, distance)| distance)
            };
            // From a corner between four cells in contact, the next corner towards a pillar is closer to it.
            let may_be_nearest =
                on_border && distance([x, y]) - 0.6 * width.hypot(height) < patches.rim_distance;
            for (u, v) in [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)] {
                let corner = [x + u * width, y + v * height];
                radius_squared = radius_squared.max(corner[0] * corner[0] + corner[1] * corner[1]);
                if may_be_nearest {
                    patches.rim_distance = patches.rim_distance.min(distance(corner));
                }
            }
            if seen[index] {
                continue;
            }
            patches.count += 1;
            seen[index] = true;
            open.push(index);
            while let Some(place) = open.pop() {
                for (neighbour, _) in neighbours(place) {
                    if loaded.get(neighbour).is_some_and(|loaded| *loaded) && !seen[neighbour] {
                        seen[neighbour] = true;
                        open.push(neighbour);
                    }
                }
            }
        }
        patches.radius = radius_squared.sqrt();
        patches
    }

    /// Length of the border; the sides of cells are longer by `4/pi` on average over all directions.
    fn border(&self) -> f64 {
        std::f64::consts::FRAC_PI_4 * self.perimeter
    }

    /// Area of cells of this area, minus the mean excess of cells along the border.
    pub(crate) fn area(&self, cell: f64) -> f64 {
        self.cells as f64 * cell - BORDER_BIAS * cell.sqrt() * self.border()
    }

    /// Uncertainty of this area because cells are in contact or not.
    pub(crate) fn area_error(&self, cell: f64) -> f64 {
        BORDER_ERROR * cell.sqrt() * self.border()
    }
}
