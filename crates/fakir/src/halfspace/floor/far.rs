//! The far part of the effect of pillars on the floor, on a wider and coarser grid than that of the floor.
//!
//! A contact with the floor is often much smaller than the contact with the tops around it, and a transform that contains both is as wide
//! as both together, on cells as fine as the floor needs. The displacement `W` by a mode of a pillar is therefore divided by a smooth
//! [step](Step) `S` from 0 at its rim to 1 at a distance `D`,
//!
//! ```text
//! W = (1 - S) W + S W.
//! ```
//!
//! The near part is zero beyond `D`, so that the grid of the floor contains the cells and their surroundings up to `D` only. The far part
//! varies over lengths of the order of `D`. It is computed at nodes that are at most `D/28` apart, and interpolated between
//! them by polynomials; the load on the pillars is computed by the transposed operations, so that the product remains symmetric.

use super::grid::{Division, FloorGrid, GAUSS};
use crate::numerics::fft::smooth_number;
use crate::numerics::vector::{Lanes, inner_dot, widest};
use crate::problem::{Cells, Grid, Segment};

/// Nodes of the interpolation along x, and along y.
const STENCIL: usize = 12;

/// Smallest number of nodes along the distance of a step. With these two numbers the error is at most 1e-8 of the displacement at the rim of
/// the pillar, and as it oscillates, a few 1e-9 of the displacement by all pillars. With ten nodes and twenty along a step it is 25 times as large.
const NODES_TO_STEP: f64 = 28.0;

/// Distances of steps that are tried, in pillar radii.
const DISTANCES: [f64; 8] = [10.0, 12.0, 14.0, 17.0, 20.0, 24.0, 28.0, 34.0];

/// Largest number of points on both grids, relative to that on a single grid, for which the effect of pillars is divided.
const WORTHWHILE: f64 = 0.75;

/// A polynomial step of the distance from 0 at 1 to 1 at `distance`, with eight continuous derivatives:
/// the integral of `(1 - t^2)^8` over `t` from -1 to 1, normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    distance: f64,
    /// Coefficients of the odd polynomial in `t`.
    odd: [f64; 9],
}

impl Step {
    fn new(distance: f64) -> Self {
        let binomial = [1.0, -8.0, 28.0, -56.0, 70.0, -56.0, 28.0, -8.0, 1.0];
        let mut odd = binomial;
        for (k, term) in odd.iter_mut().enumerate() {
            *term /= (2 * k + 1) as f64;
        }
        let sum: f64 = odd.iter().sum();
        Self {
            distance,
            odd: odd.map(|term| 0.5 * term / sum),
        }
    }

    #[inline(always)]
    fn value(&self, squared_distance: Lanes) -> Lanes {
        let (middle, half) = (0.5 * (self.distance + 1.0), 0.5 * (self.distance - 1.0));
        let t = squared_distance.map(|square| ((square.sqrt() - middle) / half).clamp(-1.0, 1.0));
        let square = t * t;
        let mut sum = Lanes::default();
        for term in self.odd.iter().rev() {
            sum = sum * square + Lanes::splat(*term);
        }
        Lanes::splat(0.5) + t * sum
    }
}

/// The part of the displacement by a pillar that kernels contain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Part {
    Whole,
    Near(Step),
    Far(Step),
}

impl Part {
    /// Whether the values are those at the centres of cells, for interpolation, instead of means over cells; without the effect of cells
    /// on each other.
    pub(super) fn is_at_centres(&self) -> bool {
        matches!(self, Self::Far(_))
    }

    /// Whether the part is zero at this distance of the nearest corner of a cell from the centre of the pillar.
    pub(super) fn is_zero_from(&self, distance: f64) -> bool {
        matches!(self, Self::Near(step) if distance >= step.distance)
    }

    #[inline(always)]
    pub(super) fn weight(&self, squared_distance: Lanes) -> Lanes {
        match self {
            Self::Whole => Lanes::splat(1.0),
            Self::Near(step) => Lanes::splat(1.0) - step.value(squared_distance),
            Self::Far(step) => step.value(squared_distance),
        }
    }
}

/// The grids on which the two parts are computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Split {
    pub(super) step: Step,
    /// The cells around the nodes.
    pub(super) nodes: Division,
    /// Number of cells of the coarse grid on each side of the floor that contain nodes as well.
    margin: [usize; 2],
    /// Periods of the fine grid and of that of the nodes.
    pub(super) periods: [[usize; 2]; 2],
}

impl Split {
    /// The split with the fewest points, if it is worthwhile, of a floor with pillars up to these distances from the lens axis along x and y.
    pub(super) fn of(division: &Division, radius: f64, farthest: [f64; 2]) -> Option<Self> {
        let sides = division.coarse_sides();
        let with = |distance: f64| {
            let parts =
                sides.map(|side| smooth_number((side * NODES_TO_STEP / distance).ceil() as usize));
            let nodes = Division {
                fineness: division.fineness,
                parts,
                cell: [0, 1].map(|k| sides[k] / parts[k] as f64),
            };
            let margin = parts.map(|parts| (STENCIL / 2).div_ceil(parts));
            let wider = radius + (margin[0] as f64 * sides[0]).max(margin[1] as f64 * sides[1]);
            let near = [distance + division.longest(); 2];
            Self {
                step: Step::new(distance),
                nodes,
                margin,
                periods: [
                    FloorGrid::period(division, radius, near),
                    FloorGrid::period(&nodes, wider, farthest),
                ],
            }
        };
        let all =
            |split: &Self| division.points(split.periods[0]) + split.nodes.points(split.periods[1]);
        let whole = division.points(FloorGrid::period(division, radius, farthest));
        DISTANCES
            .map(with)
            .into_iter()
            .min_by(|a, b| all(a).total_cmp(&all(b)))
            .filter(|best| all(best) < WORTHWHILE * whole)
    }

    /// Largest distance from the lens axis of pillars that affect cells within a radius by the near part.
    pub(super) fn near_reach(&self, radius: f64) -> f64 {
        radius + self.step.distance
    }

    /// The position of a pillar relative to the first node, from that relative to the first cell, in cells of the coarse grid.
    pub(super) fn place(&self, place: [i64; 2], mirrored: bool) -> [i64; 2] {
        let before = self.before(mirrored);
        [0, 1].map(|k| place[k] + before[k] as i64)
    }

    /// Cells of the coarse grid before the first cell: none at the lens axis of symmetric systems.
    fn before(&self, mirrored: bool) -> [usize; 2] {
        if mirrored { [0; 2] } else { self.margin }
    }
}

/// First node of the interpolation at a column or row, and the weights of this node and the following ones.
type Weights = (usize, [f64; STENCIL]);

/// Interpolation from nodes to the cells of a floor.
pub(super) struct Interpolation {
    /// All nodes.
    pub(super) nodes: Cells,
    columns: Vec<Weights>,
    rows: Vec<Weights>,
    /// The nodes of one row.
    line: Vec<f64>,
}

impl Interpolation {
    /// For the cells of a grid, or of a quadrant of it, whose nodes are mirror images of those beyond its first column and row.
    pub(super) fn new(split: &Split, cells: &Grid, mirrored: bool) -> Option<Self> {
        let (nodes, before) = (&split.nodes, split.before(mirrored));
        let cells_along = [cells.columns(), cells.rows()];
        let node_count = [0, 1].map(|k| {
            let beside = before[k] + split.margin[k];
            let covered = cells_along[k] as f64 * cells.cell()[k] / nodes.cell[k];
            (covered.ceil() as usize + beside * nodes.parts[k]).max(STENCIL)
        });
        let grid = Grid::new(node_count[0], node_count[1], nodes.cell, [0.0; 2]).ok()?;
        let [columns, rows] = [0, 1].map(|k| {
            let sides = [cells.cell()[k], nodes.cell[k]];
            let before = (before[k] * nodes.parts[k]) as f64;
            (0..cells_along[k])
                .map(|cell| weights(cell, sides, before))
                .collect()
        });
        Some(Self {
            nodes: Cells::all(&grid),
            columns,
            rows,
            line: vec![0.0; node_count[0]],
        })
    }

    /// Distributes values of cells to the nodes: the transpose of [`add`](Self::add).
    pub(super) fn distribute(&mut self, cells: &Cells, values: &[f64], nodes: &mut [f64]) {
        nodes.fill(0.0);
        for (row, segments) in rows(cells) {
            self.line.fill(0.0);
            for Segment {
                column,
                count,
                start,
                ..
            } in segments
            {
                let values = &values[*start..][..*count];
                for (value, (first, weights)) in values.iter().zip(&self.columns[*column..]) {
                    if *value != 0.0 {
                        let line = &mut self.line[*first..][..STENCIL];
                        for (node, weight) in line.iter_mut().zip(weights) {
                            *node += weight * value;
                        }
                    }
                }
            }
            let (first, weights) = &self.rows[row];
            let lines = nodes.chunks_exact_mut(self.line.len()).skip(*first);
            for (nodes, weight) in lines.zip(weights) {
                for (node, value) in nodes.iter_mut().zip(&self.line) {
                    *node += weight * value;
                }
            }
        }
    }

    /// Adds interpolated values of the nodes to those of cells.
    pub(super) fn add(&mut self, nodes: &[f64], cells: &Cells, values: &mut [f64]) {
        for (row, segments) in rows(cells) {
            self.line.fill(0.0);
            let (first, weights) = &self.rows[row];
            let lines = nodes.chunks_exact(self.line.len()).skip(*first);
            for (nodes, weight) in lines.zip(weights) {
                for (value, node) in self.line.iter_mut().zip(nodes) {
                    *value += weight * node;
                }
            }
            for Segment {
                column,
                count,
                start,
                ..
            } in segments
            {
                let values = &mut values[*start..][..*count];
                let of_columns = self.columns[*column..].iter();
                let line = &self.line[..];
                widest(
                    #[inline(always)]
                    || {
                        for (value, (first, weights)) in values.iter_mut().zip(of_columns) {
                            *value += inner_dot(weights, &line[*first..][..STENCIL]);
                        }
                    },
                );
            }
        }
    }
}

/// The rows that contain cells, with their segments.
fn rows(cells: &Cells) -> impl Iterator<Item = (usize, &[Segment])> {
    let rows = cells.segments().chunk_by(|a, b| a.row == b.row);
    rows.map(|segments| (segments[0].row, segments))
}

/// The mean over two Gauss points of a column or row of cells by Lagrange's interpolation, for cells and nodes of these `sides`, with `before`
/// nodes before the first cell; or with mirror images if there are none. Includes the ratio of the roots of the sides: the kernels of nodes contain
/// the roots of the areas of their cells.
fn weights(cell: usize, [side, node_side]: [f64; 2], before: f64) -> Weights {
    let at = |along: f64| (cell as f64 + along) * side / node_side + before - 0.5;
    let first = at(0.5).floor() as i64 - (STENCIL / 2 - 1) as i64;
    let start = first.max(0);
    let mut weights = [0.0; STENCIL];
    for along in [0.5 * (1.0 - GAUSS), 0.5 * (1.0 + GAUSS)] {
        let from_first = at(along) - first as f64;
        for node in 0..STENCIL {
            let others = (0..STENCIL).filter(|other| *other != node);
            let factors =
                others.map(|other| (from_first - other as f64) / (node as f64 - other as f64));
            let place = first + node as i64;
            // The mirror image of a node before the first one.
            let place = if place < 0 { -1 - place } else { place };
            weights[(place - start) as usize] += 0.5 * factors.product::<f64>();
        }
    }
    let root = (side / node_side).sqrt();
    (start as usize, weights.map(|weight| root * weight))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The integral of `(1 - t^2)^8`, by the antisymmetry about its middle and by differences.
    #[test]
    fn steps_are_smooth() {
        let step = Step::new(9.0);
        let value = |r: f64| step.value(Lanes::splat(r * r)).0[0];
        assert!(value(0.5).abs() + value(1.0).abs() < 1e-14);
        assert!((value(9.0) - 1.0).abs() + (value(20.0) - 1.0).abs() < 1e-14);
        for r in [1.5, 2.0, 3.7, 4.9] {
            assert!((value(r) + value(10.0 - r) - 1.0).abs() < 1e-14, "{r}");
            let t: f64 = (r - 5.0) / 4.0;
            let slope = (value(r + 1e-4) - value(r - 1e-4)) / 2e-4;
            // 0.5 divided by the integral from 0 to 1, which is 2^16 8!^2/17!, and by half the width.
            let expected = 0.5 * 3.338_470_458_984_375 / 4.0 * (1.0 - t * t).powi(8);
            assert!((slope - expected).abs() < 1e-7, "{r}: {slope} {expected}");
        }
        let parts = [Part::Near(step), Part::Far(step), Part::Whole];
        for r in [1.2, 4.0, 8.0] {
            let [near, far, whole] = parts.map(|part| part.weight(Lanes::splat(r * r)).0[0]);
            assert!((near + far - whole).abs() < 1e-15);
        }
        assert!(Part::Near(step).is_zero_from(9.0) && !Part::Far(step).is_zero_from(9.0));
    }

    /// Polynomials of a lower degree than the number of nodes are interpolated exactly, and even ones next to a mirror too.
    #[test]
    fn polynomials_are_interpolated() {
        for (before, cell) in [(6.0, 0), (6.0, 3), (6.0, 11), (0.0, 0), (0.0, 4), (0.0, 40)] {
            let sides = [0.3, 0.7];
            let (first, weights) = weights(cell, sides, before);
            for power in [0, 2, 4, 8] {
                let node = |k: usize| (k as f64 - before + 0.5) * sides[1];
                let found: f64 = (0..STENCIL)
                    .map(|k| weights[k] * (node(first + k) / 9.0).powi(power))
                    .sum();
                let gauss =
                    [1.0 - GAUSS, 1.0 + GAUSS].map(|at| (cell as f64 + 0.5 * at) * sides[0]);
                let mean = gauss
                    .iter()
                    .map(|x| 0.5 * (x / 9.0).powi(power))
                    .sum::<f64>();
                let expected = (sides[0] / sides[1]).sqrt() * mean;
                assert!((found - expected).abs() < 1e-11, "{before} {cell} {power}");
            }
        }
    }
}
