//! The cells of the floor.
//!
//! A rectangular cell of a hexagonal lattice, `sqrt3 e` by `e`, holds two pillars. It is divided into even numbers of columns and
//! rows, so that every pillar stands on a corner of the grid, and pillars differ by whole half lattice cells. What pillars do to the
//! floor is then a convolution on the grid, wherever the lens axis is.

use crate::numerics::fft::smooth_number;
use crate::problem::{Cells, Grid, HexagonalLattice, Point};

const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// How finely a lattice is divided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Division {
    /// Cells along the sides of half a lattice cell, `sqrt3 e/2` by `e/2`.
    pub(crate) half: [usize; 2],
    /// Sides of a cell.
    pub(crate) cell: [f64; 2],
}

impl Division {
    /// Of a lattice of that pitch into `2 half` rows a pitch, and columns nearly as wide.
    pub(crate) fn new(pitch: f64, half: usize) -> Self {
        // Prime factors up to 11 alone: nearly the nearest, and quick to transform.
        let nearest = SQRT_3 * half as f64;
        let above = smooth_number(nearest.ceil() as usize);
        let below = (1..above).rev().find(|n| smooth_number(*n) == *n);
        let columns = below
            .filter(|below| nearest - (*below as f64) < above as f64 - nearest)
            .unwrap_or(above);
        Self {
            half: [columns, half],
            cell: [
                0.5 * SQRT_3 * pitch / columns as f64,
                0.5 * pitch / half as f64,
            ],
        }
    }

    /// Area of a cell.
    pub(crate) fn cell_area(&self) -> f64 {
        self.cell[0] * self.cell[1]
    }

    /// The longer side of a cell.
    pub(crate) fn longest(&self) -> f64 {
        self.cell[0].max(self.cell[1])
    }
}

/// The cells of the floor within a radius of the lens axis that no pillar top covers or cuts.
#[derive(Debug, Clone)]
pub(crate) struct FloorGrid {
    pub(crate) division: Division,
    /// Corner of the grid in half lattice cells from the pillar at (0, 0).
    corner: [i64; 2],
    pub(crate) cells: Cells,
    /// Radius within which all cells are that it may need.
    pub(crate) radius: f64,
}

impl FloorGrid {
    /// `None` if no cell is in reach.
    pub(crate) fn new(lattice: &HexagonalLattice, division: Division, radius: f64) -> Option<Self> {
        let [offset_x, offset_y] = lattice.offset_vector();
        let offset = [offset_x, offset_y];
        let sides = [0, 1].map(|k| division.half[k] as f64 * division.cell[k]);
        let corner = [0, 1].map(|k| ((offset[k] - radius) / sides[k]).floor() as i64);
        let far = [0, 1].map(|k| ((offset[k] + radius) / sides[k]).ceil() as i64);
        let shape = [0, 1].map(|k| (far[k] - corner[k]).max(1) as usize * division.half[k]);
        let origin = [0, 1].map(|k| corner[k] as f64 * sides[k] - offset[k]);
        let grid = Grid::new(shape[0], shape[1], division.cell, origin).ok()?;
        let covered = Covered::new(&division);
        let cells = Cells::where_true(&grid, |index| {
            let (column, row) = (index % shape[0], index / shape[0]);
            let [x, y] = grid.centre(column, row);
            x * x + y * y < radius * radius && !covered.holds(corner, [column, row])
        });
        (!cells.is_empty()).then_some(Self {
            division,
            corner,
            cells,
            radius,
        })
    }

    /// Number of cells.
    pub(crate) fn len(&self) -> usize {
        self.cells.len()
    }

    /// About how many cells there are within a radius, covered ones too.
    pub(crate) fn expected_len(division: &Division, radius: f64) -> f64 {
        std::f64::consts::PI * radius * radius / division.cell_area()
    }

    /// Place of a pillar in half lattice cells from the corner of the grid; it may lie before it.
    pub(crate) fn place_of(&self, (i, j): (i64, i64)) -> [i64; 2] {
        [i + j - self.corner[0], i - j - self.corner[1]]
    }

    /// The column and row of the grid that hold a point, if it has them.
    pub(crate) fn position_of(&self, point: Point) -> Option<[usize; 2]> {
        let grid = self.cells.grid();
        let ([x, y], [width, height]) = (grid.origin(), grid.cell());
        let column = ((point[0] - x) / width).floor();
        let row = ((point[1] - y) / height).floor();
        let inside = (0.0..grid.columns() as f64).contains(&column)
            && (0.0..grid.rows() as f64).contains(&row);
        inside.then_some([column as usize, row as usize])
    }

    /// Half lattice cells along x and y of a period in which nothing meets its images: twice as long as the
    /// farthest cell and the farthest pillar, `pillars`, or two cells, are from the lens axis together, along x and y.
    pub(crate) fn period(division: &Division, radius: f64, pillars: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|k| {
            let side = division.half[k] as f64 * division.cell[k];
            let farthest = radius + radius.max(pillars[k]);
            // The cells themselves begin and end with whole half lattice cells.
            let cells = (2.0 * radius / side).ceil() as usize + 1;
            let count = cells.max((2.0 * farthest / side).ceil() as usize);
            // Rows are taken four at a time, and columns two at a time.
            let together = if k == 1 { 4 } else { 2 };
            together * smooth_number(count.div_ceil(together))
        })
    }
}

/// Which cells of a lattice cell a pillar top covers or cuts.
struct Covered {
    shape: [usize; 2],
    covered: Vec<bool>,
}

impl Covered {
    fn new(division: &Division) -> Self {
        let shape = division.half.map(|n| 2 * n);
        let [width, height] = division.cell;
        let pillars = [[0, 0], [2, 0], [0, 2], [2, 2], [1, 1]].map(|[u, v]: [usize; 2]| {
            [
                (u * division.half[0]) as f64 * width,
                (v * division.half[1]) as f64 * height,
            ]
        });
        let covered = (0..shape[0] * shape[1])
            .map(|index| {
                let low = [
                    (index % shape[0]) as f64 * width,
                    (index / shape[0]) as f64 * height,
                ];
                pillars.iter().any(|[x, y]| {
                    let away =
                        |at: f64, low: f64, side: f64| (low - at).max(at - low - side).max(0.0);
                    away(*x, low[0], width).hypot(away(*y, low[1], height)) < 1.0
                })
            })
            .collect();
        Self { shape, covered }
    }

    /// Whether a cell is covered, counted from a corner of the grid.
    fn holds(&self, corner: [i64; 2], place: [usize; 2]) -> bool {
        let [column, row] = [0, 1].map(|k| {
            let from_pillar = place[k] as i64 + corner[k] * (self.shape[k] / 2) as i64;
            from_pillar.rem_euclid(self.shape[k] as i64) as usize
        });
        self.covered[row * self.shape[0] + column]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_the_floor_and_pillars_stand_on_corners() {
        for (pitch, half, offset, angle) in
            [(3.0, 4, 0.0, 0.0), (4.3, 6, 0.4, 0.7), (11.0, 3, 1.9, 2.0)]
        {
            let lattice = HexagonalLattice {
                pitch,
                offset,
                offset_angle: angle,
            };
            let division = Division::new(pitch, half);
            let radius = 2.3 * pitch;
            let floor = FloorGrid::new(&lattice, division, radius).unwrap();
            let [width, height] = division.cell;
            let mut area = 0.0;
            for ([x, y], (column, row)) in floor.cells.centres().zip(floor.cells.positions()) {
                assert!(x.hypot(y) < radius);
                for (sign_x, sign_y) in [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)] {
                    let corner = [x + sign_x * width, y + sign_y * height];
                    let (i, j) = lattice.nearest_pillar(corner);
                    let [cx, cy] = lattice.centre(i, j);
                    assert!((cx - corner[0]).hypot(cy - corner[1]) >= 1.0 - 1e-12);
                }
                assert_eq!(floor.position_of([x, y]), Some([column, row]));
                area += division.cell_area();
            }
            let circle = std::f64::consts::PI * radius * radius;
            assert!(area > 0.5 * circle * (1.0 - 3.7 / (pitch * pitch)) && area < circle);
            let grid = floor.cells.grid();
            for (i, j) in [(0, 0), (1, 0), (0, 1), (-1, 2)] {
                let [u, v] = floor.place_of((i, j));
                let [x, y] = lattice.centre(i, j);
                let at = [
                    grid.origin()[0] + u as f64 * division.half[0] as f64 * width,
                    grid.origin()[1] + v as f64 * division.half[1] as f64 * height,
                ];
                assert!((at[0] - x).hypot(at[1] - y) < 1e-12 * pitch);
            }
        }
    }
}
