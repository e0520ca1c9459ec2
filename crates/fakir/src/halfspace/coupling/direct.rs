//! The coupling of any pillars, block by block: of all with each other, or of those that are near.

use super::pair::PairCoupling;
use crate::numerics::fft::Real;
use crate::numerics::vector::{LANES, Lanes, widest};
use crate::numerics::workers::Workers;
use crate::problem::Point;
use std::ops::Range;

/// Pillars whose blocks a thread makes at a time, at the least.
const ROWS: usize = 16;

/// Pillars in a band.
const BAND: usize = 512;

/// All bands together may reach over so many pillars for each that there is.
const OVERLAP: usize = 6;

/// Blocks of pairs of pillars, in single precision or double. One half is kept: the other is that transposed.
pub(crate) struct PairBlocks<R> {
    modes: usize,
    rows: Vec<Row<R>>,
    /// Receivers whose products are summed up by themselves, with the end of the sources of each.
    bands: Vec<(Range<usize>, usize)>,
}

/// What some of the pillars after it do to a pillar.
struct Row<R> {
    /// The sources, and by how many leading modes each acts.
    sources: Vec<(u32, u8)>,
    /// Column by column.
    blocks: Vec<R>,
}

impl<R: Real> PairBlocks<R> {
    /// Of so many pillars and modes of each. `sources` are those of a pillar, all after it, by rising number; `pair_modes` tells by how many modes a
    /// receiver and a source act on each other, and `fill` writes their block row by row. If it is cancelled the blocks are nothing; solvers look
    /// before they ask for a product.
    pub(crate) fn new(
        [pillars, modes]: [usize; 2],
        sources: impl Fn(usize) -> Vec<u32> + Sync + Send,
        pair_modes: impl Fn([usize; 2]) -> usize + Sync + Send,
        fill: impl Fn([usize; 2], &mut [f64]) + Sync + Send,
        workers: Workers<'_>,
    ) -> Self {
        let work = || vec![0.0; modes * modes];
        let rows = workers.map(pillars, ROWS, work, |block, receiver| {
            let of_source = |source: u32| (source, pair_modes([receiver, source as usize]) as u8);
            let sources: Vec<_> = sources(receiver).into_iter().map(of_source).collect();
            let sizes = sources.iter().map(|(_, modes)| usize::from(*modes).pow(2));
            let mut blocks = Vec::with_capacity(sizes.sum());
            for &(source, modes) in &sources {
                if workers.cancel.is_cancelled() {
                    break;
                }
                let modes = usize::from(modes);
                let block = &mut block[..modes * modes];
                fill([receiver, source as usize], block);
                let places = (0..modes).flat_map(|column| (0..modes).map(move |row| [row, column]));
                blocks.extend(places.map(|[row, column]| R::of(block[row * modes + column])));
            }
            Row { sources, blocks }
        });
        let bands = bands(&rows);
        Self { modes, rows, bands }
    }

    /// Adds what the pillars do to each other.
    pub(crate) fn add(&self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        let modes = self.modes;
        // Summed up band by band, however many threads there are.
        let sums = workers.map(
            self.bands.len(),
            1,
            || (),
            |(), number| {
                let (receivers, end) = &self.bands[number];
                let reach = receivers.start * modes..end * modes;
                let mut sums = vec![0.0; reach.len()];
                let coefficients = &coefficients[reach];
                widest(
                    #[inline(always)]
                    || self.add_products(receivers, coefficients, &mut sums),
                );
                sums
            },
        );
        for ((receivers, _), sums) in self.bands.iter().zip(sums) {
            let far = &mut far[receivers.start * modes..];
            for (far, sum) in far.iter_mut().zip(sums) {
                *far += sum;
            }
        }
    }

    /// Those of some receivers; the first coefficient is of the first of them.
    #[inline(always)]
    fn add_products(&self, receivers: &Range<usize>, coefficients: &[f64], far: &mut [f64]) {
        let modes = self.modes;
        for (receiver, row) in self.rows[receivers.clone()].iter().enumerate() {
            let next = (receiver + 1) * modes;
            let (before, after) = far.split_at_mut(next);
            let own_far = &mut before[receiver * modes..];
            let own = &coefficients[receiver * modes..next];
            let mut blocks = &row.blocks[..];
            for &(source, of_pair) in &row.sources {
                let of_pair = usize::from(of_pair);
                let Some((block, rest)) = blocks.split_at_checked(of_pair * of_pair) else {
                    break;
                };
                blocks = rest;
                let place = (source as usize - receivers.start) * modes;
                let source = &coefficients[place..place + of_pair];
                let back = &mut after[place - next..place - next + of_pair];
                let (own, own_far) = (&own[..of_pair], &mut own_far[..of_pair]);
                match of_pair {
                    1 => add_known::<1, R>(block, [own, source], [own_far, back]),
                    6 => add_known::<6, R>(block, [own, source], [own_far, back]),
                    10 => add_known::<10, R>(block, [own, source], [own_far, back]),
                    15 => add_known::<15, R>(block, [own, source], [own_far, back]),
                    _ => add_block(block, [own, source], [own_far, back]),
                }
            }
        }
    }
}

/// As [`add_block`], of a number of modes that the compiler knows.
#[inline(always)]
fn add_known<const MODES: usize, R: Real>(
    block: &[R],
    [own, source]: [&[f64]; 2],
    [own_far, back]: [&mut [f64]; 2],
) {
    // Whole lanes, then what is left.
    let (mut whole, mut rest) = ([Lanes::default(); MOST_LANES], [0.0; LANES]);
    let (own_lanes, own_rest) = own.as_chunks::<LANES>();
    let count = MODES / LANES;
    let columns = block.as_chunks::<MODES>().0.iter();
    for ((column, c), back) in columns.zip(source).zip(back) {
        let (lanes, left) = column.as_chunks::<LANES>();
        let mut products = Lanes::default();
        for k in 0..count {
            let mut values = [0.0; LANES];
            for (value, b) in values.iter_mut().zip(lanes[k]) {
                *value = b.double();
            }
            whole[k] += Lanes(values) * Lanes::splat(*c);
            products += Lanes(values) * Lanes(own_lanes[k]);
        }
        let mut sum = products.sum();
        for k in 0..MODES % LANES {
            let b = left[k].double();
            rest[k] += b * c;
            sum += b * own_rest[k];
        }
        *back += sum;
    }
    let sums = whole.iter().flat_map(|lanes| lanes.0).take(count * LANES);
    let sums = sums.chain(rest).take(MODES);
    for (far, sum) in own_far.iter_mut().zip(sums) {
        *far += sum;
    }
}

/// Enough for the modes that [`add_known`] knows.
const MOST_LANES: usize = 4;

/// What a source does to a receiver, and the receiver to the source.
fn add_block<R: Real>(block: &[R], [own, source]: [&[f64]; 2], [own_far, back]: [&mut [f64]; 2]) {
    let columns = block.chunks_exact(own.len());
    for ((column, c), back) in columns.zip(source).zip(back) {
        for ((far, b), own) in own_far.iter_mut().zip(column).zip(own) {
            let b = b.double();
            *far += b * c;
            *back += b * own;
        }
    }
}

/// Some receivers after the other as long as their sources are not many more pillars; otherwise all together.
fn bands<R>(rows: &[Row<R>]) -> Vec<(Range<usize>, usize)> {
    let count = rows.len();
    let of_some = (0..count).step_by(BAND).map(|start| {
        let receivers = start..count.min(start + BAND);
        let last = rows[receivers.clone()]
            .iter()
            .filter_map(|row| row.sources.last());
        let end = last
            .map(|(source, _)| *source as usize + 1)
            .fold(receivers.end, usize::max);
        (receivers, end)
    });
    let bands: Vec<_> = of_some.collect();
    let reach: usize = bands
        .iter()
        .map(|(receivers, end)| end - receivers.start)
        .sum();
    if reach > OVERLAP * count {
        return vec![(0..count, count)];
    }
    bands
}

/// All pairs: one dense matrix.
pub(crate) struct DirectCoupling {
    blocks: PairBlocks<f64>,
    /// What each does to itself, row by row; nothing on half-spaces.
    own: Option<Vec<f64>>,
}

impl DirectCoupling {
    pub(crate) fn new(
        centres: &[Point],
        radius: impl Fn(usize) -> f64 + Sync + Send,
        pair: &PairCoupling,
        workers: Workers<'_>,
    ) -> Self {
        let (count, modes) = (centres.len(), pair.modes().len());
        let after = |receiver: usize| (receiver as u32 + 1..count as u32).collect();
        let fill = |[receiver, source]: [usize; 2], block: &mut [f64]| {
            let offset = [0, 1].map(|k| centres[receiver][k] - centres[source][k]);
            pair.block_of(offset, [radius(receiver), radius(source)], block);
        };
        Self {
            blocks: PairBlocks::new([count, modes], after, |_| modes, fill, workers),
            own: pair.own_block(),
        }
    }

    /// About how many bytes that many pillars take.
    pub(crate) fn memory_estimate(pillars: f64, modes: usize) -> f64 {
        let of_pillar = modes as f64;
        4.0 * pillars * pillars * of_pillar * of_pillar + 12.0 * 8.0 * of_pillar * pillars
    }

    pub(crate) fn apply(&self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        far.fill(0.0);
        self.blocks.add(coefficients, far, workers);
        if let Some(own) = &self.own {
            let modes = own.len().isqrt();
            let pillars = far.chunks_exact_mut(modes);
            for (far, coefficients) in pillars.zip(coefficients.chunks_exact(modes)) {
                for (far, row) in far.iter_mut().zip(own.chunks_exact(modes)) {
                    *far += row
                        .iter()
                        .zip(coefficients)
                        .map(|(b, c)| b * c)
                        .sum::<f64>();
                }
            }
        }
    }
}
