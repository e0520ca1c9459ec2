//! Effect of pillars with arbitrary radii and positions on the floor's cells: a table of every cell and every pillar.
//!
//! A pillar of radius `a` at `X` displaces a cell by the mean over the cell of `sum_i W_i((x - X)/a) c_i/a`, computed with two Gauss points
//! in each direction, as for a pillar on a corner of the grid.

use super::grid::FloorGrid;
use super::kernels::GAUSS;
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::disc::basis::mode_count;
use crate::halfspace::disc::exterior::Exterior;
use crate::numerics::vector::{LANES, Lanes, add_scaled, dot, widest};
use crate::numerics::workers::Workers;
use crate::problem::layer::WeightedLayer;
use crate::problem::pillar_field::different;

/// Smallest number of cells that a thread processes at a time.
const CELLS_AT_ONCE: usize = 16;

/// The pillars that are coupled to the floor, and their effect on every cell.
pub(super) struct PillarTable {
    /// Their indices among all pillars.
    pillars: Vec<usize>,
    /// Number of modes of each pillar that are coupled to the floor.
    modes: usize,
    /// For every cell, every pillar and each of its modes: mean displacement times the root of the area of a cell.
    values: Vec<f64>,
    /// Coefficients of these modes, and loads on them.
    coefficients: Vec<f64>,
    loads: Vec<f64>,
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
        let centres: Vec<[f64; 2]> = grid.cells.centres().collect();
        let [width, height] = grid.division.cell.map(|side| 0.5 * GAUSS * side);
        let root = grid.division.cell_area().sqrt();
        let radii = different(pillars.iter().map(|pillar| sites.body(*pillar).radius));
        let exterior = Exterior::new(degree).with_layers(layers, &radii);
        let [across, up] = [
            Lanes([-width, -width, width, width]),
            Lanes([-height, height, -height, height]),
        ];
        let fill = |workspace: &mut Vec<Lanes>, cell: usize, values: &mut [f64]| {
            if workers.cancel.is_cancelled() {
                return;
            }
            let [x, y] = centres[cell];
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
        workers.fill(&mut values, of_cell.max(1), CELLS_AT_ONCE, workspace, fill);
        Self {
            coefficients: vec![0.0; of_cell],
            loads: vec![0.0; of_cell],
            pillars,
            modes,
            values,
        }
    }

    /// Adds to the loads on pillars, each of which has `modes` modes, and to those on cells.
    pub(super) fn apply(
        &mut self,
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
        let rows = self.values.chunks_exact(self.coefficients.len());
        for ((row, far), pressure) in rows.zip(far_floor).zip(floor) {
            *far += dot(row, &self.coefficients);
            if *pressure != 0.0 {
                add_scaled(&mut self.loads, *pressure, row);
            }
        }
        let loads = self.loads.chunks_exact(self.modes);
        for (loads, pillar) in loads.zip(&self.pillars) {
            for (far, load) in far_tops[pillar * modes..].iter_mut().zip(loads) {
                *far += load;
            }
        }
    }
}
