//! The coupling of any pillars, block by block: of all with each other, or of those that are near.

use super::pair::PairCoupling;
use crate::numerics::vector::widest;
use crate::numerics::workers::Workers;
use crate::problem::Point;

/// Pillars whose blocks a thread makes at a time, at the least.
const ROWS: usize = 16;

/// Blocks of pairs of pillars. One half is kept: the other is that transposed.
pub(crate) struct PairBlocks {
    modes: usize,
    rows: Vec<Row>,
}

/// What some of the pillars after it do to a pillar.
struct Row {
    sources: Vec<u32>,
    /// Column by column.
    blocks: Vec<f64>,
}

impl PairBlocks {
    /// `sources` are those of a pillar, all after it; `fill` writes the block of a receiver and a source row by row. If it is
    /// cancelled the blocks are nothing; solvers look before they ask for a product.
    pub(crate) fn new(
        pillars: usize,
        modes: usize,
        sources: impl Fn(usize) -> Vec<u32> + Sync,
        fill: impl Fn([usize; 2], &mut [f64]) + Sync,
        workers: Workers<'_>,
    ) -> Self {
        let size = modes * modes;
        let work = || vec![0.0; size];
        let rows = workers.map(pillars, ROWS, work, |block, receiver| {
            let sources = sources(receiver);
            let mut blocks = vec![0.0; sources.len() * size];
            for (columns, source) in blocks.chunks_exact_mut(size).zip(&sources) {
                if workers.cancel.is_cancelled() {
                    break;
                }
                fill([receiver, *source as usize], block);
                for (k, value) in block.iter().enumerate() {
                    columns[k % modes * modes + k / modes] = *value;
                }
            }
            Row { sources, blocks }
        });
        Self { modes, rows }
    }

    /// Adds what the pillars do to each other.
    pub(crate) fn add(&self, coefficients: &[f64], far: &mut [f64]) {
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
            let next = (receiver + 1) * modes;
            let (before, after) = far.split_at_mut(next);
            let own_far = &mut before[receiver * modes..];
            let own = &coefficients[receiver * modes..next];
            let blocks = row.blocks.chunks_exact(modes * modes);
            for (block, source) in blocks.zip(&row.sources) {
                let place = *source as usize * modes;
                let source = &coefficients[place..place + modes];
                let source_far = &mut after[place - next..place - next + modes];
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

/// All pairs: one dense matrix.
pub(crate) struct DirectCoupling {
    blocks: PairBlocks,
}

impl DirectCoupling {
    pub(crate) fn new(
        centres: &[Point],
        radius: impl Fn(usize) -> f64 + Sync,
        pair: &PairCoupling,
        workers: Workers<'_>,
    ) -> Self {
        let count = centres.len();
        let after = |receiver: usize| (receiver as u32 + 1..count as u32).collect();
        let fill = |[receiver, source]: [usize; 2], block: &mut [f64]| {
            let offset = [0, 1].map(|k| centres[receiver][k] - centres[source][k]);
            pair.block_of(offset, [radius(receiver), radius(source)], block);
        };
        Self {
            blocks: PairBlocks::new(count, pair.modes().len(), after, fill, workers),
        }
    }

    /// About how many bytes that many pillars take.
    pub(crate) fn memory_estimate(pillars: f64, modes: usize) -> f64 {
        let of_pillar = modes as f64;
        4.0 * pillars * pillars * of_pillar * of_pillar + 12.0 * 8.0 * of_pillar * pillars
    }

    pub(crate) fn apply(&self, coefficients: &[f64], far: &mut [f64]) {
        far.fill(0.0);
        self.blocks.add(coefficients, far);
    }
}
