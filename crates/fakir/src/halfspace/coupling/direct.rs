//! The coupling of any pillars as one dense matrix, of which one half is kept.

use super::pair::PairCoupling;
use crate::numerics::vector::widest;
use crate::numerics::workers::Workers;
use crate::problem::Point;

/// Pillars whose blocks a thread makes at a time, at the least.
const ROWS: usize = 16;

pub(crate) struct DirectCoupling {
    modes: usize,
    /// For every pillar the blocks of those after it: what they do to it, column by column.
    rows: Vec<Vec<f64>>,
}

impl DirectCoupling {
    /// If it is cancelled the blocks are nothing; solvers look before they ask for a product.
    pub(crate) fn new(
        centres: &[Point],
        radius: impl Fn(usize) -> f64 + Sync,
        pair: &PairCoupling,
        workers: Workers<'_>,
    ) -> Self {
        let modes = pair.modes().len();
        let size = modes * modes;
        let work = || vec![0.0; size];
        let rows = workers.map(centres.len(), ROWS, work, |block, receiver| {
            let mut row = vec![0.0; (centres.len() - receiver - 1) * size];
            if workers.cancel.is_cancelled() {
                return row;
            }
            let at = centres[receiver];
            for (columns, source) in row.chunks_exact_mut(size).zip(receiver + 1..) {
                let from = centres[source];
                let radii = [radius(receiver), radius(source)];
                pair.block_of([at[0] - from[0], at[1] - from[1]], radii, block);
                for (k, value) in block.iter().enumerate() {
                    columns[k % modes * modes + k / modes] = *value;
                }
            }
            row
        });
        Self { modes, rows }
    }

    /// About how many bytes that many pillars take.
    pub(crate) fn memory_estimate(pillars: f64, modes: usize) -> f64 {
        let of_pillar = modes as f64;
        4.0 * pillars * pillars * of_pillar * of_pillar + 12.0 * 8.0 * of_pillar * pillars
    }

    pub(crate) fn apply(&self, coefficients: &[f64], far: &mut [f64]) {
        far.fill(0.0);
        widest(
            #[inline(always)]
            || match self.modes {
                // The usual number, known to the compiler.
                6 => self.add_products(6, coefficients, far),
                modes => self.add_products(modes, coefficients, far),
            },
        );
    }

    #[inline(always)]
    fn add_products(&self, modes: usize, coefficients: &[f64], far: &mut [f64]) {
        for (receiver, row) in self.rows.iter().enumerate() {
            let (before, after) = far.split_at_mut((receiver + 1) * modes);
            let own_far = &mut before[receiver * modes..];
            let (_, from_own) = coefficients.split_at(receiver * modes);
            let (own, others) = from_own.split_at(modes);
            let sources = others.chunks_exact(modes);
            let blocks = row.chunks_exact(modes * modes);
            for ((block, source), source_far) in
                blocks.zip(sources).zip(after.chunks_exact_mut(modes))
            {
                let columns = block.chunks_exact(modes);
                for ((column, c), back) in columns.zip(source).zip(source_far) {
                    // What the source does to the receiver, and the receiver to the source.
                    for ((far, b), own) in own_far.iter_mut().zip(column).zip(own) {
                        *far += b * c;
                        *back += b * own;
                    }
                }
            }
        }
    }
}
