//! Effect of pillars with arbitrary radii and positions on the floor's cells: a table of every cell and every pillar.
//!
//! A pillar of radius `a` at `X` displaces a cell by the mean over the cell of `sum_i W_i((x - X)/a) c_i/a`, computed with two Gauss points
//! in each direction, as for a pillar on a corner of the grid.
//!
//! Far from a pillar this is a smooth function of the position of the cell. The [rough product](PillarTable::apply_roughly) computes the effect of
//! far pillars at the Chebyshev nodes of square blocks of cells and interpolates; its transpose collects the pressures of a block at the nodes, so
//! that the product remains symmetric.

use super::grid::{FloorGrid, GAUSS};
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::disc::basis::mode_count;
use crate::halfspace::disc::exterior::Exterior;
use crate::numerics::vector::{LANES, Lanes, add_scaled, dot, widest};
use crate::numerics::workers::Workers;
use crate::problem::Point;
use crate::problem::layer::WeightedLayer;
use crate::problem::pillar_field::different;
use std::f64::consts::PI;

/// Smallest number of cells that a thread processes at a time.
const CELLS_AT_ONCE: usize = 16;

/// Number of cells and of nodes along the side of a block, and distance of the rims of far pillars from its centre, in halves of its side. The
/// displacement is regular up to three halves beside the block, so that a polynomial on the nodes is accurate to `2/(3 + sqrt(10))^7` of it.
const BLOCK: usize = 24;
const NODES: usize = 7;
const FAR: f64 = 4.0;

/// Bound of the error of the rough product, relative to the load.
pub(super) const ROUGH_ERROR: f64 = 1e-5;

/// The pillars that are coupled to the floor, and their effect on every cell.
pub(super) struct PillarTable {
    /// Their indices among all pillars.
    pillars: Vec<usize>,
    /// Number of modes of each pillar that are coupled to the floor.
    modes: usize,
    /// For every cell, every pillar and each of its modes: mean displacement times the root of the area of a cell.
    values: Vec<f64>,
    /// All cells, in blocks.
    blocks: Vec<Block>,
    /// The same values for every node of every block and every far pillar; zero for near ones.
    at_nodes: Vec<f64>,
    /// Interpolation from the nodes to each cell along the side of a block.
    weights: Vec<[f64; NODES]>,
    /// Coefficients of these modes, and loads on them.
    coefficients: Vec<f64>,
    loads: Vec<f64>,
}

/// A square of cells.
#[derive(Default)]
struct Block {
    /// Its cells, with their column and row in it.
    cells: Vec<(usize, [usize; 2])>,
    /// The near pillars, by their places in the table.
    near: Vec<usize>,
    /// Their values, cell by cell: together, because those of the whole table are far apart in memory.
    values: Vec<f64>,
}

/// Chebyshev nodes in `[-1, 1]`.
fn nodes() -> [f64; NODES] {
    std::array::from_fn(|k| -(PI * (k as f64 + 0.5) / NODES as f64).cos())
}

/// Lagrange polynomials of the nodes at the centres of the cells along the side of a block.
fn weights() -> [[f64; NODES]; BLOCK] {
    let nodes = nodes();
    std::array::from_fn(|cell| {
        let x = (2.0 * cell as f64 + 1.0) / BLOCK as f64 - 1.0;
        std::array::from_fn(|node| {
            let others = (0..NODES).filter(|other| *other != node);
            let factors = others.map(|other| (x - nodes[other]) / (nodes[node] - nodes[other]));
            factors.product()
        })
    })
}

impl PillarTable {
    /// Computes the table for the modes up to a degree of the pillars within `reach` of the lens axis. The table is undefined after
    /// cancellation.
    pub(super) fn new(
        grid: &FloorGrid,
        (sites, reach): (&Sites, f64),
        degree: usize,
        layers: &[WeightedLayer],
        workers: Workers<'_>,
    ) -> Self {
        let near = |pillar: &usize| {
            let [x, y] = sites.centres()[*pillar];
            x.hypot(y) <= reach
        };
        let pillars: Vec<usize> = (0..sites.len()).filter(near).collect();
        let modes = mode_count(degree);
        let of_cell = pillars.len() * modes;
        let mut values = vec![0.0; grid.len() * of_cell];
        let centres: Vec<Point> = grid.cells.centres().collect();
        let [width, height] = grid.division.cell.map(|side| 0.5 * GAUSS * side);
        let root = grid.division.cell_area().sqrt();
        let radii = different(pillars.iter().map(|pillar| sites.body(*pillar).radius));
        let exterior = Exterior::new(degree).with_layers(layers, &radii);
        let [across, up] = [
            Lanes([-width, -width, width, width]),
            Lanes([-height, height, -height, height]),
        ];
        let mean = |workspace: &mut Vec<Lanes>, [x, y]: Point, values: &mut [f64]| {
            if workers.cancel.is_cancelled() {
                return;
            }
            widest(
                #[inline(always)]
                || {
                    for (pillar, values) in pillars.iter().zip(values.chunks_exact_mut(modes)) {
                        let centre = sites.centres()[*pillar];
                        let radius = sites.body(*pillar).radius;
                        let at = [
                            (Lanes::splat(x - centre[0]) + across) * Lanes::splat(radius.recip()),
                            (Lanes::splat(y - centre[1]) + up) * Lanes::splat(radius.recip()),
                        ];
                        exterior.lane_values(at, Lanes::splat(radius), workspace);
                        for (value, lanes) in values.iter_mut().zip(&*workspace) {
                            *value = root / (LANES as f64 * radius) * lanes.sum();
                        }
                    }
                },
            );
        };
        let workspace = || vec![Lanes::default(); modes];
        let fill = |workspace: &mut Vec<Lanes>, cell: usize, values: &mut [f64]| {
            mean(workspace, centres[cell], values);
        };
        workers.fill(&mut values, of_cell.max(1), CELLS_AT_ONCE, workspace, fill);
        let (blocks, middles) = blocks(grid, &centres);
        let half = grid.division.cell.map(|side| 0.5 * BLOCK as f64 * side);
        let nodes = nodes();
        let node = |node: usize| {
            let [x, y] = middles[node / (NODES * NODES)];
            let [column, row] = [node % NODES, node / NODES % NODES];
            [x + half[0] * nodes[column], y + half[1] * nodes[row]]
        };
        let mut at_nodes = vec![0.0; blocks.len() * NODES * NODES * of_cell];
        let fill = |workspace: &mut Vec<Lanes>, place: usize, values: &mut [f64]| {
            mean(workspace, node(place), values);
        };
        workers.fill(
            &mut at_nodes,
            of_cell.max(1),
            CELLS_AT_ONCE,
            workspace,
            fill,
        );
        let far = FAR * half[0].max(half[1]);
        let mut table = Self {
            coefficients: vec![0.0; of_cell],
            loads: vec![0.0; of_cell],
            weights: weights().to_vec(),
            pillars,
            modes,
            values,
            blocks,
            at_nodes,
        };
        for (block, [x, y]) in table.blocks.iter_mut().zip(middles) {
            let is_near = |place: &usize| {
                let pillar = table.pillars[*place];
                let [u, v] = sites.centres()[pillar];
                (u - x).hypot(v - y) - sites.body(pillar).radius < far
            };
            block.near = (0..table.pillars.len()).filter(is_near).collect();
            for (cell, _) in &block.cells {
                for place in &block.near {
                    let values = &table.values[cell * of_cell + place * modes..][..modes];
                    block.values.extend(values);
                }
            }
        }
        let rows = table
            .at_nodes
            .chunks_exact_mut((NODES * NODES * of_cell).max(1));
        for (rows, block) in rows.zip(&table.blocks) {
            for row in rows.chunks_exact_mut(of_cell) {
                for place in &block.near {
                    row[place * modes..][..modes].fill(0.0);
                }
            }
        }
        table
    }

    /// Adds to the loads on pillars, each of which has `modes` modes, and to those on cells.
    pub(super) fn apply(&mut self, modes: usize, coefficients: [&[f64]; 2], far: [&mut [f64]; 2]) {
        self.apply_by(Self::every_cell, modes, coefficients, far);
    }

    /// The same with the error of interpolation.
    pub(super) fn apply_roughly(
        &mut self,
        modes: usize,
        coefficients: [&[f64]; 2],
        far: [&mut [f64]; 2],
    ) {
        self.apply_by(Self::by_blocks, modes, coefficients, far);
    }

    fn apply_by(
        &mut self,
        couple: impl FnOnce(&mut Self, &[f64], &mut [f64]),
        modes: usize,
        [tops, floor]: [&[f64]; 2],
        [far_tops, far_floor]: [&mut [f64]; 2],
    ) {
        if self.pillars.is_empty() {
            return;
        }
        let own = self.coefficients.chunks_exact_mut(self.modes);
        for (own, pillar) in own.zip(&self.pillars) {
            own.copy_from_slice(&tops[pillar * modes..][..self.modes]);
        }
        self.loads.fill(0.0);
        couple(self, floor, far_floor);
        let loads = self.loads.chunks_exact(self.modes);
        for (loads, pillar) in loads.zip(&self.pillars) {
            for (far, load) in far_tops[pillar * modes..].iter_mut().zip(loads) {
                *far += load;
            }
        }
    }

    /// Adds to the loads on cells, and computes those on the pillars.
    fn every_cell(&mut self, floor: &[f64], far_floor: &mut [f64]) {
        let rows = self.values.chunks_exact(self.coefficients.len());
        for ((row, far), pressure) in rows.zip(far_floor).zip(floor) {
            *far += dot(row, &self.coefficients);
            if *pressure != 0.0 {
                add_scaled(&mut self.loads, *pressure, row);
            }
        }
    }

    fn by_blocks(&mut self, floor: &[f64], far_floor: &mut [f64]) {
        let (modes, of_cell) = (self.modes, self.coefficients.len());
        let rows = self.at_nodes.chunks_exact(NODES * NODES * of_cell);
        for (block, rows) in self.blocks.iter().zip(rows) {
            let nodes = rows.chunks_exact(of_cell);
            let mut values = [0.0; NODES * NODES];
            for (value, row) in values.iter_mut().zip(nodes.clone()) {
                *value = dot(row, &self.coefficients);
            }
            let mut pressures = [0.0; NODES * NODES];
            widest(
                #[inline(always)]
                || {
                    // From the nodes of a column to the rows of cells, and along them to the cells.
                    let mut along = [[0.0; NODES]; BLOCK];
                    for (along, weights) in along.iter_mut().zip(&self.weights) {
                        for (values, weight) in values.chunks_exact(NODES).zip(weights) {
                            for (along, value) in along.iter_mut().zip(values) {
                                *along += weight * value;
                            }
                        }
                    }
                    let mut back = [[0.0; NODES]; BLOCK];
                    let mut near = block.values.chunks_exact(modes);
                    for (cell, [column, row]) in &block.cells {
                        let weights = &self.weights[*column];
                        let pressure = floor[*cell];
                        let mut far = 0.0;
                        for (place, values) in block.near.iter().zip(&mut near) {
                            let places = place * modes..(place + 1) * modes;
                            let coefficients = &self.coefficients[places.clone()];
                            let loads = &mut self.loads[places];
                            for ((value, c), load) in values.iter().zip(coefficients).zip(loads) {
                                far += value * c;
                                *load += value * pressure;
                            }
                        }
                        let lines = along[*row].iter().zip(&mut back[*row]);
                        for ((along, back), weight) in lines.zip(weights) {
                            far += along * weight;
                            *back += pressure * weight;
                        }
                        far_floor[*cell] += far;
                    }
                    for (back, weights) in back.iter().zip(&self.weights) {
                        for (pressures, weight) in pressures.chunks_exact_mut(NODES).zip(weights) {
                            for (pressure, back) in pressures.iter_mut().zip(back) {
                                *pressure += weight * back;
                            }
                        }
                    }
                },
            );
            for (pressure, row) in pressures.iter().zip(nodes) {
                if *pressure != 0.0 {
                    add_scaled(&mut self.loads, *pressure, row);
                }
            }
        }
    }
}

/// The blocks that contain cells, without their pillars, and their middles.
fn blocks(grid: &FloorGrid, centres: &[Point]) -> (Vec<Block>, Vec<Point>) {
    let across = grid.cells.grid().columns().div_ceil(BLOCK);
    let down = grid.cells.grid().rows().div_ceil(BLOCK);
    let mut blocks: Vec<Block> = (0..across * down).map(|_| Block::default()).collect();
    for (cell, (column, row)) in grid.cells.positions().enumerate() {
        let cells = &mut blocks[row / BLOCK * across + column / BLOCK].cells;
        cells.push((cell, [column % BLOCK, row % BLOCK]));
    }
    blocks.retain(|block| !block.cells.is_empty());
    let middle = |block: &Block| {
        let (cell, at) = block.cells[0];
        let away = |k: usize| (0.5 * (BLOCK as f64 - 1.0) - at[k] as f64) * grid.division.cell[k];
        [centres[cell][0] + away(0), centres[cell][1] + away(1)]
    };
    let middles = blocks.iter().map(middle).collect();
    (blocks, middles)
}

#[cfg(test)]
mod tests {
    use super::super::grid::Division;
    use super::super::grid::tests::listed;
    use super::*;
    use crate::numerics::workers::CancelToken;

    /// Far pillars act through the nodes as they do at the cells, on blocks from the distance of pillars to much smaller ones; and the product is
    /// symmetric.
    #[test]
    fn nodes_carry_the_effect_of_far_pillars() {
        let field = listed();
        let sites = Sites::within(&field, 1e9);
        let cancel = CancelToken::default();
        let workers = Workers {
            pool: None,
            cancel: &cancel,
        };
        for fineness in [10, 40, 100] {
            let division = Division::new(&field, fineness);
            let grid = FloorGrid::new(&field, division, 2.0 * field.spacing()).unwrap();
            let mut table = PillarTable::new(&grid, (&sites, 1e9), 2, &[], workers);
            let far = |block: &Block| table.pillars.len() - block.near.len();
            let most = table.blocks.iter().map(far).max();
            assert!(fineness < 40 || most > Some(0), "{fineness}: {most:?}");
            let numbers = |count: usize, turn: f64| -> Vec<f64> {
                (0..count).map(|k| (turn * k as f64).sin()).collect()
            };
            let (tops, floor) = (numbers(6 * sites.len(), 1.7), numbers(grid.len(), 0.3));
            let mut product = |roughly: bool| {
                let mut far_tops = vec![0.0; tops.len()];
                let mut far_floor = vec![0.0; floor.len()];
                let (of, far) = ([&tops[..], &floor], [&mut far_tops[..], &mut far_floor]);
                if roughly {
                    table.apply_roughly(6, of, far);
                } else {
                    table.apply(6, of, far);
                }
                [far_tops, far_floor]
            };
            let [exact, rough] = [false, true].map(&mut product);
            for (exact, rough) in exact.iter().zip(&rough) {
                let largest = exact.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                let differences = exact.iter().zip(rough).map(|(a, b)| (a - b).abs());
                let difference = differences.fold(0.0, f64::max) / largest;
                println!("{fineness}: {difference:e}");
                assert!(difference < ROUGH_ERROR, "{fineness}: {difference:e}");
            }
            let [work, other] = [dot(&rough[0], &tops), dot(&rough[1], &floor)];
            let scale = dot(&tops, &tops).sqrt() * dot(&rough[0], &rough[0]).sqrt();
            assert!((work - other).abs() < 1e-12 * scale, "{work} {other}");
        }
    }
}
