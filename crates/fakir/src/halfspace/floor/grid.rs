//! The cells of the floor.
//!
//! The pillars of many lattices are on a coarse rectangular grid: those of a square or rectangular lattice on all of its points, those of a
//! hexagonal lattice, whose rectangular cell `sqrt3 e` by `e` contains two pillars, on alternate corners of half such cells. The cells of
//! the coarse grid are divided into integer numbers of columns and rows, so that every pillar is on a corner of the fine grid. The effect
//! of pillars on the floor is then a convolution on the grid, for any position of the lens axis. For pillars at arbitrary positions, the
//! grid begins at the lens axis.

use crate::numerics::fft::smooth_number;
use crate::problem::pillar_field::{ListedPillar, PillarField, PillarGrid};
use crate::problem::{Cells, Grid, Point};
use std::sync::Arc;

/// Distances from the rim of a pillar below this are rounding errors.
const ROUNDING: f64 = 1e-12;

/// Half the distance of the two Gauss points, relative to half a side.
pub(super) const GAUSS: f64 = 0.577_350_269_189_625_8;

/// Ratio of numbers of rows up to which one that is divisible by eight is better.
const MORE_ROWS_IN_EIGHTS: f64 = 1.25;

/// Size of the floor cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Division {
    /// Number of cells along half the shortest distance of pillars, before rounding to integers.
    pub(crate) fineness: usize,
    /// Number of cells along the sides of a cell of the coarse grid; 1 without a coarse grid.
    pub(crate) parts: [usize; 2],
    /// Sides of a cell.
    pub(crate) cell: [f64; 2],
}

impl Division {
    /// Division of the floor between pillars.
    pub(crate) fn new(field: &PillarField, fineness: usize) -> Self {
        let target = 0.5 * field.shortest_distance() / fineness as f64;
        let Some(PillarGrid { sides, .. }) = field.pillar_grid() else {
            return Self {
                fineness,
                parts: [1, 1],
                cell: [target, target],
            };
        };
        // Prime factors up to 11 only: close to the nearest number, and fast to transform.
        let parts = sides.map(|side| {
            let nearest = (side / target).max(1.0);
            let above = smooth_number(nearest.ceil() as usize);
            let below = (1..above).rev().find(|n| smooth_number(*n) == *n);
            below
                .filter(|below| nearest - (*below as f64) < above as f64 - nearest)
                .unwrap_or(above)
        });
        Self {
            fineness,
            parts,
            cell: [0, 1].map(|k| sides[k] / parts[k] as f64),
        }
    }

    /// Area of a cell.
    pub(crate) fn cell_area(&self) -> f64 {
        self.cell[0] * self.cell[1]
    }

    /// Number of points of a transform with this period, in cells of the coarse grid.
    pub(super) fn points(&self, period: [usize; 2]) -> f64 {
        let sides = [0, 1].map(|k| (period[k] * self.parts[k]) as f64);
        sides[0] * sides[1]
    }

    /// The longer side of a cell.
    pub(crate) fn longest(&self) -> f64 {
        self.cell[0].max(self.cell[1])
    }

    /// Sides of a cell of the coarse grid.
    pub(super) fn coarse_sides(&self) -> [f64; 2] {
        [0, 1].map(|k| self.parts[k] as f64 * self.cell[k])
    }
}

/// The cells of the floor within a radius of the lens axis that are neither covered nor cut by a pillar top.
#[derive(Debug, Clone)]
pub(crate) struct FloorGrid {
    pub(crate) division: Division,
    /// The coarse grid of the pillars, if there is one.
    pillar_grid: Option<PillarGrid>,
    /// The pillars next to the cells; if there are none, the nearest pillar and some others.
    pub(crate) pillars: Vec<ListedPillar>,
    /// Corner of the grid in cells of the coarse grid, relative to pillar (0, 0), or to the lens axis.
    corner: [i64; 2],
    pub(crate) cells: Cells,
    /// Radius that contains all cells that may be needed.
    pub(crate) radius: f64,
    /// The mirror images of cells, if the system is symmetric.
    pub(crate) mirrors: Option<Arc<Mirrors>>,
}

/// Mirror images of cells under reflections of x and of y at the lens axis.
#[derive(Debug)]
pub(crate) struct Mirrors {
    /// Position of the lens axis, in cells of the coarse grid from the corner.
    axis: [i64; 2],
    /// The cells of one quadrant, on a grid that begins at the lens axis.
    pub(crate) quadrant: Cells,
    /// The index in the quadrant of every cell.
    images: Vec<u32>,
    /// The representative cell for every cell of the quadrant.
    own: Vec<u32>,
}

impl Mirrors {
    /// Position of a pillar relative to the lens axis, from its position relative to the corner, in cells of the coarse grid.
    pub(crate) fn place_from_axis(&self, place: [i64; 2]) -> [i64; 2] {
        [0, 1].map(|k| place[k] - self.axis[k])
    }

    /// Computes the means over mirror images.
    fn fold(&self, of_cells: &[f64], of_quadrant: &mut [f64]) {
        of_quadrant.fill(0.0);
        for (value, image) in of_cells.iter().zip(&self.images) {
            of_quadrant[*image as usize] += 0.25 * value;
        }
    }

    /// Copies the values of the quadrant to all mirror images.
    fn unfold<T: Copy>(&self, of_quadrant: &[T], of_cells: &mut [T]) {
        for (value, image) in of_cells.iter_mut().zip(&self.images) {
            *value = of_quadrant[*image as usize];
        }
    }

    /// Replaces the values of all cells by the means over mirror images.
    pub(crate) fn average(&self, of_cells: &mut [f64]) {
        let mut means = vec![0.0; self.own.len()];
        self.fold(of_cells, &mut means);
        self.unfold(&means, of_cells);
    }

    /// The cells that represent their mirror images.
    pub(crate) fn representatives(&self) -> impl Iterator<Item = usize> {
        self.own.iter().map(|cell| *cell as usize)
    }

    /// Copies the values of the representative cells to all their mirror images.
    pub(crate) fn mirror<T: Copy>(&self, of_cells: &mut [T]) {
        let own: Vec<T> = self
            .own
            .iter()
            .map(|cell| of_cells[*cell as usize])
            .collect();
        self.unfold(&own, of_cells);
    }
}

/// Maps values of all cells to those of the quadrant and back, if there is one.
pub(crate) struct Folding {
    mirrors: Option<Arc<Mirrors>>,
    /// Values on the quadrant: the argument of a transformation, and its result.
    values: Vec<f64>,
    transformed: Vec<f64>,
}

impl Folding {
    pub(crate) fn new(grid: &FloorGrid) -> Self {
        let quadrant = grid.mirrors.as_ref().map_or(0, |m| m.quadrant.len());
        Self {
            mirrors: grid.mirrors.clone(),
            values: vec![0.0; quadrant],
            transformed: vec![0.0; quadrant],
        }
    }

    /// Applies a transformation to values: on the quadrant, by the means over mirror images, if the system is symmetric.
    pub(crate) fn through(
        &mut self,
        of_cells: &[f64],
        transformed: &mut [f64],
        transform: impl FnOnce(&[f64], &mut [f64]),
    ) {
        let Some(mirrors) = &self.mirrors else {
            return transform(of_cells, transformed);
        };
        mirrors.fold(of_cells, &mut self.values);
        transform(&self.values, &mut self.transformed);
        mirrors.unfold(&self.transformed, transformed);
    }
}

impl FloorGrid {
    /// Returns `None` if the radius contains no cell.
    pub(crate) fn new(field: &PillarField, division: Division, radius: f64) -> Option<Self> {
        let pillar_grid = field.pillar_grid();
        let first = pillar_grid.map_or([0.0, 0.0], |grid| grid.origin);
        let sides = division.coarse_sides();
        let corner = [0, 1].map(|k| ((-first[k] - radius) / sides[k]).floor() as i64);
        let far = [0, 1].map(|k| ((-first[k] + radius) / sides[k]).ceil() as i64);
        let shape = [0, 1].map(|k| (far[k] - corner[k]).max(1) as usize * division.parts[k]);
        let origin = [0, 1].map(|k| corner[k] as f64 * sides[k] + first[k]);
        let grid = Grid::new(shape[0], shape[1], division.cell, origin).ok()?;
        let mut covered = vec![false; grid.cell_count()];
        let [largest, _] = field.bounds();
        let mut reach = radius + field.spacing() + largest;
        let listed = loop {
            let (listed, all) = field.listed_within(reach);
            if all || !listed.is_empty() {
                break listed;
            }
            reach *= 2.0;
        };
        for (index, pillar) in &listed {
            // In cells from the corner. These are integers on the grid, so that all pillars cover the same number of cells.
            let at = match &pillar_grid {
                Some(grid) => {
                    let place = grid.place(*index);
                    [0, 1].map(|k| ((place[k] - corner[k]) * division.parts[k] as i64) as f64)
                }
                None => [0, 1].map(|k| (pillar.centre[k] - origin[k]) / division.cell[k]),
            };
            cover(&mut covered, shape, division.cell, at, pillar);
        }
        let cells = Cells::where_true(&grid, |index| {
            let [x, y] = grid.centre(index % shape[0], index / shape[0]);
            x * x + y * y < radius * radius && !covered[index]
        });
        (!cells.is_empty()).then_some(Self {
            division,
            pillar_grid,
            pillars: listed.into_iter().map(|(_, pillar)| pillar).collect(),
            corner,
            cells,
            radius,
            mirrors: None,
        })
    }

    /// Adds mirror images of cells; `from_first` is the position of the lens axis relative to pillar (0, 0), in columns and rows of the
    /// coarse grid.
    pub(crate) fn with_mirrors(mut self, from_first: [i64; 2]) -> Self {
        self.mirrors = self.find_mirrors(from_first).map(Arc::new);
        self
    }

    fn find_mirrors(&self, from_first: [i64; 2]) -> Option<Mirrors> {
        let axis = [0, 1].map(|k| from_first[k] - self.corner[k]);
        let grid = self.cells.grid();
        let shape = [grid.columns(), grid.rows()];
        // The first column and row after the lens axis.
        let first = [0, 1].map(|k| axis[k] * self.division.parts[k] as i64);
        let sides = [0, 1].map(|k| usize::try_from(shape[k] as i64 - first[k]).ok());
        let [columns, rows] = [sides[0]?, sides[1]?];
        let quadrant = Grid::new(columns, rows, self.division.cell, [0.0; 2]).ok()?;
        let image = |at: usize, k: usize| {
            let beyond = at as i64 - first[k];
            beyond.max(-1 - beyond) as usize
        };
        let mut counts = vec![0_u8; quadrant.cell_count()];
        for (column, row) in self.cells.positions() {
            let (column, row) = (image(column, 0), image(row, 1));
            if column >= columns || row >= rows {
                return None;
            }
            counts[row * columns + column] += 1;
        }
        if !counts.iter().all(|count| [0, 4].contains(count)) {
            // Asymmetric due to rounding.
            return None;
        }
        let cells = Cells::where_true(&quadrant, |index| counts[index] > 0);
        let mut places = vec![0; counts.len()];
        for (place, index) in cells.indices().enumerate() {
            places[index] = place as u32;
        }
        let mut own = vec![0; cells.len()];
        let positions = self.cells.positions().enumerate();
        let images = positions.map(|(cell, (column, row))| {
            let place = places[image(row, 1) * columns + image(column, 0)];
            own[place as usize] = cell as u32;
            place
        });
        Some(Mirrors {
            axis,
            images: images.collect(),
            own,
            quadrant: cells,
        })
    }

    /// The same cells with all distances from the lens axis multiplied by a factor: those of a stretched arrangement.
    pub(crate) fn stretched(&self, factor: f64) -> Self {
        let mirrors = self.mirrors.as_ref().map(|mirrors| {
            Arc::new(Mirrors {
                axis: mirrors.axis,
                quadrant: mirrors.quadrant.stretched(factor),
                images: mirrors.images.clone(),
                own: mirrors.own.clone(),
            })
        });
        Self {
            division: Division {
                cell: self.division.cell.map(|side| side * factor),
                ..self.division
            },
            cells: self.cells.stretched(factor),
            radius: self.radius * factor,
            mirrors,
            ..self.clone()
        }
    }

    /// The cells of the quadrant if the system is symmetric, and otherwise all.
    pub(super) fn own_cells(&self) -> &Cells {
        match &self.mirrors {
            Some(mirrors) => &mirrors.quadrant,
            None => &self.cells,
        }
    }

    /// Number of cells.
    pub(crate) fn len(&self) -> usize {
        self.cells.len()
    }

    /// Approximate number of cells within a radius, including covered ones.
    pub(crate) fn expected_len(division: &Division, radius: f64) -> f64 {
        std::f64::consts::PI * radius * radius / division.cell_area()
    }

    /// Position of a pillar relative to the corner, in cells of the coarse grid; may be negative. `None` for pillars that are not on a
    /// coarse grid.
    pub(crate) fn place_of(&self, index: (i64, i64)) -> Option<[i64; 2]> {
        let place = self.pillar_grid.as_ref()?.place(index);
        Some([0, 1].map(|k| place[k] - self.corner[k]))
    }

    /// Whether the pillars are on corners of the grid.
    pub(crate) fn holds_pillars(&self) -> bool {
        self.pillar_grid.is_some()
    }

    /// The column and row of the cell that contains a point; `None` outside the grid.
    pub(crate) fn position_of(&self, point: Point) -> Option<[usize; 2]> {
        let grid = self.cells.grid();
        let ([x, y], [width, height]) = (grid.origin(), grid.cell());
        let column = ((point[0] - x) / width).floor();
        let row = ((point[1] - y) / height).floor();
        let inside = (0.0..grid.columns() as f64).contains(&column)
            && (0.0..grid.rows() as f64).contains(&row);
        inside.then_some([column as usize, row as usize])
    }

    /// Number of cells of the coarse grid, along x and y, in a period without interaction of periodic images: twice the sum of the largest
    /// distances from the lens axis of a cell and a pillar (`pillars`), or of two cells, along x and y.
    pub(crate) fn period(division: &Division, radius: f64, pillars: [f64; 2]) -> [usize; 2] {
        let sides = division.coarse_sides();
        [0, 1].map(|k| {
            let farthest = radius + radius.max(pillars[k]);
            // The cells begin and end with complete cells of the coarse grid.
            let cells = (2.0 * radius / sides[k]).ceil() as usize + 1;
            let count = cells.max((2.0 * farthest / sides[k]).ceil() as usize);
            let of_groups = |together: usize| together * smooth_number(count.div_ceil(together));
            if k == 0 {
                return of_groups(2);
            }
            // Rows are processed in groups of four, or of eight in single precision.
            let [fours, eights] = [4, 8].map(of_groups);
            if eights as f64 <= MORE_ROWS_IN_EIGHTS * fours as f64 {
                eights
            } else {
                fours
            }
        })
    }
}

/// Marks the cells of a grid that are covered or cut by a pillar with the centre `at`, in cells from the corner.
fn cover(
    covered: &mut [bool],
    [columns, rows]: [usize; 2],
    [width, height]: [f64; 2],
    at: Point,
    pillar: &ListedPillar,
) {
    let radius = pillar.body.radius;
    let range = |at: f64, side: f64, count: usize| {
        let reach = radius / side;
        let first = (at - reach).floor().max(0.0) as usize;
        let end = (at + reach).ceil().max(0.0) as usize;
        first.min(count)..end.min(count)
    };
    // Distance of a column or row from the centre.
    let away = |place: usize, at: f64, side: f64| {
        let low = (place as f64 - at) * side;
        low.max(-low - side).max(0.0)
    };
    for row in range(at[1], height, rows) {
        let up = away(row, at[1], height);
        for column in range(at[0], width, columns) {
            if away(column, at[0], width).hypot(up) < radius * (1.0 - ROUNDING) {
                covered[row * columns + column] = true;
            }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::problem::HexagonalLattice;
    use crate::problem::pillar_field::{PillarBody, PillarList, PlaneLattice};

    pub(in crate::halfspace::floor) fn hexagonal(lattice: HexagonalLattice) -> PillarField {
        PillarField::Hexagonal {
            lattice,
            column: 0.0.into(),
        }
    }

    /// Tops of unit radius on an arbitrary lattice.
    pub(in crate::halfspace::floor) fn plane(vectors: [Point; 2], origin: Point) -> PillarField {
        let body = PillarBody::of_column(0.0);
        PillarField::Lattice(Arc::new(
            PlaneLattice::new(vectors, origin, body).expect("vectors that span the plane"),
        ))
    }

    /// Tops of several radii at arbitrary positions.
    pub(in crate::halfspace::floor) fn listed() -> PillarField {
        let places = [
            (0.3, 0.4, 1.0),
            (4.1, -1.0, 0.7),
            (-3.0, 2.2, 1.3),
            (1.0, 5.0, 1.0),
        ];
        let pillar = |(x, y, radius)| ListedPillar {
            centre: [x, y],
            body: PillarBody {
                radius,
                ..PillarBody::of_column(0.0)
            },
        };
        let list = PillarList::new(places.map(pillar).to_vec());
        PillarField::Listed(Arc::new(list.expect("pillars that do not overlap")))
    }

    #[test]
    fn cells_are_the_floor_and_pillars_are_on_corners() {
        let paper = |pitch, offset, offset_angle| {
            hexagonal(HexagonalLattice {
                pitch,
                offset,
                offset_angle,
            })
        };
        for (field, fineness) in [
            (paper(3.0, 0.0, 0.0), 4),
            (paper(4.3, 0.4, 0.7), 6),
            (paper(11.0, 1.9, 2.0), 3),
            (plane([[4.0, 0.0], [0.0, 4.0]], [0.0, 0.0]), 4),
            (plane([[4.0, 0.0], [0.0, 7.3]], [1.1, -0.4]), 5),
            (plane([[5.0, 0.0], [2.5, 4.0]], [1.1, -0.4]), 6),
            (plane([[5.0, 0.0], [1.3, 4.0]], [1.1, -0.4]), 6),
            (listed(), 9),
        ] {
            let division = Division::new(&field, fineness);
            let radius = 2.3 * field.spacing();
            let floor = FloorGrid::new(&field, division, radius).unwrap();
            let pillars = field.listed_within(radius + 2.0).0;
            let [width, height] = division.cell;
            let target = 0.5 * field.shortest_distance() / fineness as f64;
            assert!((division.cell_area().sqrt() / target - 1.0).abs() < 0.1);
            let mut area = 0.0;
            for ([x, y], (column, row)) in floor.cells.centres().zip(floor.cells.positions()) {
                assert!(x.hypot(y) < radius);
                for (sign_x, sign_y) in [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)] {
                    let corner = [x + sign_x * width, y + sign_y * height];
                    for (_, ListedPillar { centre, body }) in &pillars {
                        let distance = (centre[0] - corner[0]).hypot(centre[1] - corner[1]);
                        assert!(distance >= body.radius - 1e-11);
                    }
                }
                assert_eq!(floor.position_of([x, y]), Some([column, row]));
                area += division.cell_area();
            }
            let circle = std::f64::consts::PI * radius * radius;
            // The area of the tops, and of the cells that they cut.
            let tops: f64 = pillars
                .iter()
                .map(|(_, pillar)| 3.2 + 8.0 * pillar.body.radius * division.longest())
                .sum();
            assert!(area > circle - tops - 8.0 * radius * division.longest() && area < circle);
            let grid = floor.cells.grid();
            for (index, pillar) in pillars {
                let Some(place) = floor.place_of(index) else {
                    assert!(!floor.holds_pillars());
                    continue;
                };
                for k in 0..2 {
                    let cells = place[k] as f64 * division.parts[k] as f64;
                    let at = grid.origin()[k] + cells * division.cell[k];
                    assert!((at - pillar.centre[k]).abs() < 1e-11);
                }
            }
        }
    }

    /// Two descriptions of the hexagonal lattice result in the same cells.
    #[test]
    fn hexagonal_lattices_are_centred_ones() {
        let lattice = HexagonalLattice {
            pitch: 5.3,
            offset: 0.3,
            offset_angle: 1.0,
        };
        let vectors = HexagonalLattice::new(5.3).vectors();
        let fields = [hexagonal(lattice), plane(vectors, lattice.centre(0, 0))];
        let [one, other] =
            fields.map(|field| FloorGrid::new(&field, Division::new(&field, 6), 13.0).unwrap());
        assert_eq!(one.division.parts, other.division.parts);
        assert_eq!(one.corner, other.corner);
        assert!(one.cells.indices().eq(other.cells.indices()));
    }
}
