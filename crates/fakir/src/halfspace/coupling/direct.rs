//! Direct coupling of pillars, block by block: between all pillars, or between near ones.

use super::pair::PairCoupling;
use crate::numerics::fft::Real;
use crate::numerics::vector::{LANES, Lanes, widest};
use crate::numerics::workers::Workers;
use crate::problem::Point;
use std::collections::HashMap;
use std::ops::Range;

/// Smallest number of pillars whose blocks a thread computes at a time.
const ROWS: usize = 16;

/// Number of pillars in a band.
const BAND: usize = 512;

/// Limit of the total extent of all bands, relative to the number of pillars.
const OVERLAP: usize = 6;

/// Blocks of pairs of pillars, in single or double precision. Each pair is stored once, since its second block is the transposed first one.
pub(crate) struct PairBlocks<R> {
    modes: usize,
    rows: Vec<Row<R>>,
    /// Receivers whose products are summed separately, with the end of the range of their sources.
    bands: Vec<(Range<usize>, usize)>,
}

/// The effect of some of the following pillars on a pillar.
struct Row<R> {
    /// The sources, and the number of leading modes with which each acts.
    sources: Vec<(u32, u8)>,
    /// The blocks, stored by columns.
    blocks: Vec<R>,
}

impl<R: Real> PairBlocks<R> {
    /// Creates the blocks for `count` pillars with `modes` modes each. `sources` are those of a pillar, all after it, in increasing order;
    /// `pair_modes` returns the number of modes with which a receiver and a source interact, and `fill` writes their block by rows. The
    /// blocks are undefined after cancellation; solvers check for it before they compute a product.
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

    /// Adds the loads due to the interaction of the pillars.
    pub(crate) fn add(&self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        let modes = self.modes;
        // Summed band by band, independent of the number of threads.
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

    /// Adds the products for some receivers; the first coefficient is that of the first receiver.
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

/// [`add_block`] for a number of modes that is known at compile time.
#[inline(always)]
fn add_known<const MODES: usize, R: Real>(
    block: &[R],
    [own, source]: [&[f64]; 2],
    [own_far, back]: [&mut [f64]; 2],
) {
    // First complete lanes, then the remaining modes.
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

/// Number of lanes that is sufficient for the numbers of modes in [`add_known`].
const MOST_LANES: usize = 4;

/// Adds the load that a source causes on a receiver, and that of the receiver on the source.
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

/// Bands of consecutive receivers, provided that the extent of their sources is limited; otherwise one band.
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
    /// The effect of each pillar on itself; `None` on half-spaces.
    own: Option<OwnBlocks>,
}

/// The effect of pillars on themselves, for every different radius.
struct OwnBlocks {
    /// By rows.
    blocks: Vec<Vec<f64>>,
    /// The block of each pillar.
    of_pillars: Vec<u32>,
}

impl OwnBlocks {
    fn new(radii: impl Iterator<Item = f64>, pair: &PairCoupling) -> Option<Self> {
        let mut blocks = Vec::new();
        let mut known: HashMap<u64, u32> = HashMap::new();
        let mut of_pillars = Vec::new();
        for radius in radii {
            let place = match known.get(&radius.to_bits()) {
                Some(place) => *place,
                None => {
                    blocks.push(pair.own_block(radius)?);
                    let place = blocks.len() as u32 - 1;
                    known.insert(radius.to_bits(), place);
                    place
                }
            };
            of_pillars.push(place);
        }
        Some(Self { blocks, of_pillars })
    }
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
            own: OwnBlocks::new((0..count).map(radius), pair),
        }
    }

    /// Approximate memory in bytes for this number of pillars.
    pub(crate) fn memory_estimate(pillars: f64, modes: usize) -> f64 {
        let of_pillar = modes as f64;
        4.0 * pillars * pillars * of_pillar * of_pillar + 12.0 * 8.0 * of_pillar * pillars
    }

    pub(crate) fn apply(&self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        far.fill(0.0);
        self.blocks.add(coefficients, far, workers);
        if let Some(own) = &self.own {
            let modes = self.blocks.modes;
            let pillars = far.chunks_exact_mut(modes).zip(&own.of_pillars);
            for ((far, block), coefficients) in pillars.zip(coefficients.chunks_exact(modes)) {
                let own = &own.blocks[*block as usize];
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
