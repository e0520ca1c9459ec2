//! The coupling of many pillars at arbitrary positions on a grid: the pre-corrected fast Fourier transform (J. R. Phillips and J. K. White,
//! IEEE Trans. Comput.-Aided Des. 16, 1059 (1997)).
//!
//! Every pillar is replaced by charges on the grid points around it, `rho = P' m`, whose far field equals that of the pillar. Their
//! potential `u = K rho` results from a convolution with `1/(pi r)`, zero at `r = 0`, and its effect on a pillar is `P u`: the average of
//! the interpolated potential with every mode. Since the same `P` distributes and collects, the product is symmetric. Between near pillars,
//! and from a pillar to itself, the charges are inaccurate: there `C - P K P'` is added, with the exact `C` for pairs and zero for the
//! pillar itself.
//!
//! Modes beyond degree 2 act on near pillars only; the degree for two near pillars depends on [their gap](pair_degree).
//!
//! The number of near pairs depends on the grid step, the error hardly does. The [step](Plan) with the lowest cost is therefore chosen:
//! small for clustered pillars, which would otherwise have many near pairs, and large where the grid would otherwise be mostly empty.

use super::direct::PairBlocks;
use super::pair::PairCoupling;
use super::sites::Sites;
use crate::halfspace::disc::basis::{BasisEvaluator, mode_count};
use crate::halfspace::elements::{FreeSpaceConvolution, Operator};
use crate::numerics::quadrature::hemisphere;
use crate::numerics::vector::{LANES, Lanes, widest};
use crate::numerics::workers::Workers;
use crate::problem::{Cells, Grid, Point};
use std::f64::consts::PI;

/// Number of points along each side of the square of charges of a pillar.
const STENCIL: usize = 8;

/// Distance up to which pillars are near, in grid steps.
const NEAR: f64 = 12.0;

/// The smallest such distance relative to the largest radius: beyond it pillars interact with degree [`FAR_DEGREE`] only.
const NEAR_RADII: f64 = 6.0;

/// Degree of the modes that the charges represent.
const FAR_DEGREE: usize = 2;

/// Smallest number of pillars, and of rows of the grid, that a thread processes at a time.
const PILLARS: usize = 200;
const ROWS: usize = 16;

/// The degree to which two pillars interact, by the gap relative to the smaller radius: the next degree changes the force on two equal
/// pillars by less than 1e-6. Each degree applies from its gap on; in order of decreasing gap.
const DEGREES: [(f64, usize); 3] = [(5.0, 2), (2.5, 3), (1.0, 4)];

/// The degree to which two pillars with this gap, relative to the smaller radius, interact, if `most` is the highest degree of any pillar.
pub(crate) fn pair_degree(gap: f64, most: usize) -> usize {
    let of_gap = DEGREES.iter().find(|(from, _)| gap >= *from);
    of_gap.map_or(most, |(_, degree)| most.min(*degree))
}

/// Memory per point of the grid in bytes.
const POINT_BYTES: f64 = 64.0;

/// Approximate time in nanoseconds per point of the grid and per near pair, over a whole solution, for one mode and for several modes.
const COSTS: [[f64; 2]; 2] = [[700.0, 2000.0], [2500.0, 8000.0]];

/// Number of pillars whose neighbours are counted for a plan, and the ratio of consecutive steps that are tried.
const COUNTED: usize = 200;
const STEP_RATIO: f64 = 1.2;

/// The step of the grid, and the quantities that follow from it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plan {
    step: f64,
    /// The first point, and the number of points along x and y.
    first: Point,
    sides: [usize; 2],
    /// Approximate number of near pairs.
    pairs: f64,
    cost: f64,
}

impl Plan {
    /// Chooses the step with the lowest cost for this number of modes per pillar.
    pub(crate) fn new(sites: &Sites, modes: usize) -> Self {
        let (centres, count) = (sites.centres(), sites.len());
        let bounds = |k: usize| {
            let values = centres.iter().map(|centre| centre[k]);
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| {
                [a.min(x), b.max(x)]
            })
        };
        let ([left, right], [low, high]) = (bounds(0), bounds(1));
        let radii = (0..count).map(|pillar| sites.body(pillar).radius);
        let largest = radii.fold(0.0, f64::max);
        let half = (STENCIL / 2 - 1) as f64;
        let [of_point, of_pair] = COSTS[usize::from(modes > 1)];
        let plan = |step: f64| {
            let sides = [right - left, high - low].map(|side| (side / step) as usize + STENCIL + 1);
            let every = count.div_ceil(COUNTED);
            let counted = (0..count).step_by(every);
            let near: usize = counted
                .clone()
                .map(|pillar| {
                    sites
                        .neighbours()
                        .count_within(centres[pillar], NEAR * step)
                        - 1
                })
                .sum();
            let pairs = 0.5 * near as f64 * count as f64 / counted.count() as f64;
            Self {
                step,
                first: [left, low].map(|x| x - half * step),
                sides,
                pairs,
                cost: sides[0] as f64 * sides[1] as f64 * of_point + pairs * of_pair,
            }
        };
        // The discs must be inside their stencils.
        let least = largest * (NEAR_RADII / NEAR).max(half.recip());
        let mut best = plan(least);
        let mut step = least;
        // With a single step across the whole extent, all pairs are near.
        while step * NEAR < (right - left).hypot(high - low) {
            step *= STEP_RATIO;
            let other = plan(step);
            if other.cost < best.cost {
                best = other;
            } else if other.pairs * of_pair > best.cost {
                break;
            }
        }
        best
    }

    /// Approximate memory in bytes for the solution of this number of pillars.
    pub(crate) fn memory(&self, pillars: usize, modes: usize) -> f64 {
        let of_pillar = modes as f64;
        let far_modes = modes.min(mode_count(FAR_DEGREE)) as f64;
        let stencil = far_modes * (4.0 * (STENCIL * STENCIL) as f64 + 8.0 * (far_modes + 1.0));
        // Adjacent pairs have all modes.
        let close = 4.0 * of_pillar * of_pillar;
        let vectors = 20.0 * 8.0 * of_pillar;
        let of_pairs = self.pairs * (4.0 * far_modes * far_modes + 16.0);
        let points = self.sides[0] as f64 * self.sides[1] as f64;
        pillars as f64 * (stencil + close + vectors) + of_pairs + points * POINT_BYTES
    }
}

pub(crate) struct GridCoupling<'p> {
    modes: usize,
    /// The pillars in the order of the row, then the column, of their charges.
    order: Vec<u32>,
    stencils: Stencils,
    /// Number of points along x.
    columns: usize,
    convolution: FreeSpaceConvolution<'p>,
    near: PairBlocks<f32>,
    charges: Vec<f64>,
    potential: Vec<f64>,
    /// Moments in this order.
    moments: Vec<f64>,
    far: Vec<f64>,
}

/// Largest number of weights of a pillar.
const WEIGHTS: usize = mode_count(FAR_DEGREE) * STENCIL * STENCIL;
type Weights = [f64; WEIGHTS];

/// The charges of all pillars, in the order of the grid.
struct Stencils {
    /// Number of leading modes that the charges represent.
    modes: usize,
    /// Column and row of the first charge of each pillar.
    corners: Vec<[u32; 2]>,
    /// For every row of points, the first pillar whose charges start there or later.
    rows: Vec<u32>,
    /// `P`: for every pillar, row and far mode, the charges in this row, as integer multiples of a unit.
    weights: Vec<i32>,
    /// These units, for every pillar and far mode. The errors of fixed-point numbers are smaller than those of floating-point numbers with
    /// the same number of bits.
    units: Vec<f64>,
    /// `P K P'` of each pillar with itself, by rows.
    own: Vec<f64>,
}

impl Stencils {
    fn weights(&self, pillar: usize) -> &[i32] {
        let size = self.modes * STENCIL * STENCIL;
        &self.weights[pillar * size..][..size]
    }

    fn units(&self, pillar: usize) -> &[f64] {
        &self.units[pillar * self.modes..][..self.modes]
    }

    /// Converts the weights of a pillar to floating-point numbers.
    fn decode<'w>(&self, pillar: usize, weights: &'w mut Weights) -> &'w [f64] {
        let (encoded, units) = (self.weights(pillar), self.units(pillar));
        let weights = &mut weights[..encoded.len()];
        let lines = weights
            .chunks_exact_mut(STENCIL)
            .zip(encoded.chunks_exact(STENCIL));
        for ((weights, encoded), unit) in lines.zip(units.iter().cycle()) {
            for (weight, parts) in weights.iter_mut().zip(encoded) {
                *weight = unit * f64::from(*parts);
            }
        }
        weights
    }

    /// Distance in grid steps from a source to a receiver.
    fn steps(&self, receiver: usize, source: usize) -> [i64; 2] {
        let [a, b] = [receiver, source].map(|pillar| self.corners[pillar]);
        [0, 1].map(|k| i64::from(a[k]) - i64::from(b[k]))
    }

    /// Adds the charges to a row of points.
    #[inline(always)]
    fn charge<const MODES: usize>(
        &self,
        row: usize,
        stride: usize,
        moments: &[f64],
        charges: &mut [f64],
    ) {
        charges.fill(0.0);
        let first = self.rows[(row + 1).saturating_sub(STENCIL)] as usize;
        let line = MODES * STENCIL;
        for pillar in first..self.rows[row + 1] as usize {
            let [column, corner] = self.corners[pillar].map(|x| x as usize);
            let weights = &self.weights[(pillar * STENCIL + row - corner) * line..][..line];
            let moments = moments[pillar * stride..][..MODES]
                .iter()
                .zip(self.units(pillar));
            let mut sums = [0.0; STENCIL];
            for (weights, (moment, unit)) in weights.as_chunks::<STENCIL>().0.iter().zip(moments) {
                let moment = moment * unit;
                for (sum, weight) in sums.iter_mut().zip(weights) {
                    *sum += moment * f64::from(*weight);
                }
            }
            for (charge, sum) in charges[column..column + STENCIL].iter_mut().zip(sums) {
                *charge += sum;
            }
        }
    }

    /// Computes the loads on a pillar due to the potential, except that of the charges on the pillar.
    #[inline(always)]
    fn gather<const MODES: usize>(
        &self,
        pillar: usize,
        columns: usize,
        potential: &[f64],
        moments: &[f64],
        far: &mut [f64],
    ) {
        let [column, row] = self.corners[pillar].map(|x| x as usize);
        let weights = self.weights(pillar).as_chunks::<STENCIL>().0;
        // Functions that are not inlined would not use the widest vector instructions: avoids closures that create arrays.
        let mut sums = [[0.0; STENCIL]; MODES];
        for (line, weights) in weights.chunks_exact(MODES).enumerate() {
            let start = (row + line) * columns + column;
            let Some(potential) = potential[start..].first_chunk::<STENCIL>() else {
                continue;
            };
            for (sums, weights) in sums.iter_mut().zip(weights) {
                for k in 0..STENCIL {
                    sums[k] += f64::from(weights[k]) * potential[k];
                }
            }
        }
        let own = &self.own[pillar * MODES * MODES..][..MODES * MODES];
        let of_modes = sums
            .iter()
            .zip(self.units(pillar))
            .zip(own.chunks_exact(MODES));
        for (far, ((sums, unit), own)) in far.iter_mut().zip(of_modes) {
            let itself: f64 = own.iter().zip(moments).map(|(a, b)| a * b).sum();
            *far = unit * sum_of(sums) - itself;
        }
    }
}

#[inline(always)]
fn sum_of(values: &[f64; STENCIL]) -> f64 {
    let mut sums = Lanes::default();
    for part in values.as_chunks::<LANES>().0 {
        sums += Lanes(*part);
    }
    sums.sum()
}

/// The potential between points of the grid.
struct Kernel {
    /// For every distance along y up to [`REACH`](Self::REACH), the values along x, beginning with the negative distances.
    values: Vec<f64>,
}

impl Kernel {
    /// Largest distance in grid steps between two charges of near pillars.
    const REACH: usize = NEAR as usize + STENCIL + 1;
    const WIDTH: usize = 2 * Self::REACH + 1;

    fn new(step: f64) -> Self {
        let count = Self::WIDTH * (Self::REACH + 1);
        let along = |k: usize| (k % Self::WIDTH).abs_diff(Self::REACH);
        let values = (0..count).map(|k| kernel(step, [along(k), k / Self::WIDTH]));
        Self {
            values: values.collect(),
        }
    }

    /// `P_n K P_k'` of two stencils at this distance in grid steps, by rows.
    fn between(
        &self,
        modes: usize,
        [receiver, source]: [&[f64]; 2],
        steps: [i64; 2],
        block: &mut [f64],
    ) {
        widest(
            #[inline(always)]
            || match modes {
                1 => self.between_modes::<1>(receiver, source, steps, block),
                3 => self.between_modes::<3>(receiver, source, steps, block),
                _ => self.between_modes::<6>(receiver, source, steps, block),
            },
        );
    }

    #[inline(always)]
    fn between_modes<const MODES: usize>(
        &self,
        receiver: &[f64],
        source: &[f64],
        steps: [i64; 2],
        block: &mut [f64],
    ) {
        let halves = self.halves(steps);
        let source = shares::<MODES>(source);
        let mut potential = [[[[0.0; STENCIL]; MODES]; HALF]; 2];
        for (down, (kernels, source)) in halves.iter().zip(&source).enumerate() {
            for (along, (kernel, source)) in kernels.iter().zip(source).enumerate() {
                for y in 0..HALF {
                    let mut sums = [[0.0; HALF]; MODES];
                    for (row, weights) in source.iter().enumerate() {
                        let values = &kernel[HALF - 1 + y - row];
                        for column in 0..HALF {
                            for (sums, weights) in sums.iter_mut().zip(weights) {
                                for x in 0..HALF {
                                    sums[x] += weights[column] * values[HALF - 1 + x - column];
                                }
                            }
                        }
                    }
                    for half in RECEIVING[down] {
                        for (potential, sums) in potential[*half][y].iter_mut().zip(&sums) {
                            for other in RECEIVING[along] {
                                for x in 0..HALF {
                                    potential[other * HALF + x] += sums[x];
                                }
                            }
                        }
                    }
                }
            }
        }
        let (receiver, potential) = (
            receiver.as_chunks::<STENCIL>().0,
            potential.as_flattened().as_flattened(),
        );
        for i in 0..MODES {
            for j in 0..MODES {
                let mut products = [0.0; STENCIL];
                for row in 0..STENCIL {
                    let (weights, potential) =
                        (&receiver[row * MODES + i], &potential[row * MODES + j]);
                    for k in 0..STENCIL {
                        products[k] += weights[k] * potential[k];
                    }
                }
                block[i * MODES + j] = sum_of(&products);
            }
        }
    }

    /// The potential between two stencils at this distance, by the offset between their halves along y and along x: between a half and
    /// itself, then the differences of the potentials to the preceding and the following half from this.
    #[inline(always)]
    fn halves(&self, steps: [i64; 2]) -> [[HalfKernel; 3]; 3] {
        let last = STENCIL as i64 - 1;
        let from = (steps[0] - last + Self::REACH as i64) as usize;
        let mut all = [[0.0; 2 * STENCIL]; 2 * STENCIL - 1];
        for (row, values) in all.iter_mut().enumerate() {
            let down = (steps[1] + row as i64 - last).unsigned_abs() as usize;
            let known = &self.values[down * Self::WIDTH + from..][..2 * STENCIL - 1];
            values[..2 * STENCIL - 1].copy_from_slice(known);
        }
        let mut halves = [[[[0.0; STENCIL]; STENCIL - 1]; 3]; 3];
        for row in 0..STENCIL - 1 {
            let [before, own, after] = [0, HALF, STENCIL].map(|half| &all[row + half]);
            let mut lines = [[0.0; 2 * STENCIL]; 3];
            for k in 0..2 * STENCIL {
                lines[0][k] = own[k];
                lines[1][k] = before[k] - own[k];
                lines[2][k] = after[k] - own[k];
            }
            for (halves, line) in halves.iter_mut().zip(&lines) {
                for k in 0..STENCIL - 1 {
                    let own = line[k + HALF];
                    halves[0][row][k] = own;
                    halves[1][row][k] = line[k] - own;
                    halves[2][row][k] = line[k + STENCIL] - own;
                }
            }
        }
        halves
    }
}

/// Number of points along each side of half a stencil.
const HALF: usize = STENCIL / 2;

/// The potential as a function of the steps from a point of one half to a point of another.
type HalfKernel = [[f64; STENCIL]; STENCIL - 1];

/// The halves that receive each of the products of [`shares`].
const RECEIVING: [&[usize]; 3] = [&[0, 1], &[0], &[1]];

/// Weights, by rows, of the sum of both halves, of the second half and of the first, along y and along x. With the potential `A` between
/// points of one half, `B` from the second to the first and `C` back, `u1 = A (q1 + q2) + (B - A) q2` and `u2 = A (q1 + q2) + (C - A) q1`:
/// three products instead of four, and nine instead of sixteen in two dimensions (S. Winograd, Arithmetic Complexity of Computations, SIAM
/// 1980).
#[inline(always)]
fn shares<const MODES: usize>(weights: &[f64]) -> [[[[[f64; HALF]; MODES]; HALF]; 3]; 3] {
    let weights = weights.as_chunks::<STENCIL>().0;
    let mut shares = [[[[[0.0; HALF]; MODES]; HALF]; 3]; 3];
    for row in 0..HALF {
        for mode in 0..MODES {
            let [first, second] = [row, row + HALF].map(|row| &weights[row * MODES + mode]);
            let mut lines = [[0.0; STENCIL]; 3];
            for k in 0..STENCIL {
                lines[0][k] = first[k] + second[k];
                lines[1][k] = second[k];
                lines[2][k] = first[k];
            }
            for (shares, line) in shares.iter_mut().zip(&lines) {
                for k in 0..HALF {
                    shares[0][row][mode][k] = line[k] + line[k + HALF];
                    shares[1][row][mode][k] = line[k + HALF];
                    shares[2][row][mode][k] = line[k];
                }
            }
        }
    }
    shares
}

fn kernel(step: f64, [x, y]: [usize; 2]) -> f64 {
    if [x, y] == [0, 0] {
        return 0.0;
    }
    (PI * step * ((x * x + y * y) as f64).sqrt()).recip()
}

/// Lagrange polynomials of the points 0, 1, 2, ... at a position.
#[inline(always)]
fn lagrange(place: f64) -> [f64; STENCIL] {
    // The products of the distances from the points before and after each point.
    let mut values = [1.0; STENCIL];
    let (mut before, mut after) = (1.0, 1.0);
    for k in 0..STENCIL {
        values[k] *= before * INVERSES[k];
        before *= place - k as f64;
        values[STENCIL - 1 - k] *= after;
        after *= place - (STENCIL - 1 - k) as f64;
    }
    values
}

/// For every point, the inverse of the product of its distances from the others.
const INVERSES: [f64; STENCIL] = {
    let mut inverses = [1.0; STENCIL];
    let mut k = 0;
    while k < STENCIL {
        let mut j = 0;
        while j < STENCIL {
            if j != k {
                inverses[k] /= k as f64 - j as f64;
            }
            j += 1;
        }
        k += 1;
    }
    inverses
};

impl<'p> GridCoupling<'p> {
    /// Returns `None` if no grid can be created.
    pub(crate) fn new(sites: &Sites, pair: &PairCoupling, workers: Workers<'p>) -> Option<Self> {
        let (centres, count) = (sites.centres(), sites.len());
        let radius = |pillar: usize| sites.body(pillar).radius;
        let (modes, most) = (pair.modes().len(), pair.degree());
        let far_modes = modes.min(mode_count(FAR_DEGREE));
        let Plan {
            step, first, sides, ..
        } = Plan::new(sites, modes);
        let grid = Grid::new(sides[0], sides[1], [step; 2], first).ok()?;
        let cells = Cells::all(&grid);
        let convolution =
            FreeSpaceConvolution::of_kernel(cells, |steps| kernel(step, steps), workers.pool);
        let near_kernel = Kernel::new(step);
        let place = |pillar: u32| [0, 1].map(|k| (centres[pillar as usize][k] - first[k]) / step);
        let corner = |pillar: u32| {
            place(pillar).map(|x| (x as usize).saturating_sub(STENCIL / 2 - 1) as u32)
        };
        let mut order: Vec<u32> = (0..count as u32).collect();
        order.sort_by_cached_key(|&pillar| {
            let [column, row] = corner(pillar);
            (row, column, pillar)
        });
        let corners: Vec<[u32; 2]> = order.iter().map(|&pillar| corner(pillar)).collect();
        let starts = |row: usize| corners.partition_point(|[_, corner]| (*corner as usize) < row);
        let rows = (0..=sides[1]).map(|row| starts(row) as u32).collect();
        let rule = Rule::new(far_modes);
        let encode = |weights: &mut Weights, number: usize| {
            let [x, y] = place(order[number]);
            let [column, row] = corners[number].map(f64::from);
            let size = radius(order[number] as usize) / step;
            rule.weights([x - column, y - row], size, weights)
        };
        let work = || [0.0; WEIGHTS];
        let (weights, units): (Vec<_>, Vec<_>) = workers
            .map(count, PILLARS, work, encode)
            .into_iter()
            .unzip();
        let mut stencils = Stencils {
            modes: far_modes,
            corners,
            rows,
            weights: weights.concat(),
            units: units.concat(),
            own: Vec::new(),
        };
        let mut own = vec![0.0; count * far_modes * far_modes];
        let itself = |weights: &mut Weights, number: usize, block: &mut [f64]| {
            let weights = stencils.decode(number, weights);
            near_kernel.between(far_modes, [weights; 2], [0, 0], block);
        };
        workers.fill(&mut own, far_modes * far_modes, PILLARS, work, itself);
        stencils.own = own;
        let mut places = vec![0; count];
        for (number, pillar) in order.iter().enumerate() {
            places[*pillar as usize] = number as u32;
        }
        let sources = |receiver: usize| {
            let at = centres[order[receiver] as usize];
            let near = sites.neighbours().within(at, NEAR * step);
            let near = near.into_iter().map(|pillar| places[pillar as usize]);
            let mut after: Vec<u32> = near.filter(|&other| other as usize > receiver).collect();
            after.sort_unstable();
            after
        };
        // Couplings with fewer modes, by degree; flat punches are not truncated.
        let fewer: Vec<PairCoupling> = (0..most).map(PairCoupling::new).collect();
        let offset = |[receiver, source]: [usize; 2]| {
            let [a, b] = [receiver, source].map(|number| order[number] as usize);
            let offset = [0, 1].map(|k| centres[a][k] - centres[b][k]);
            (offset, [radius(a), radius(b)])
        };
        let degree = |pair: [usize; 2]| {
            let ([x, y], radii) = offset(pair);
            pair_degree(
                (x.hypot(y) - radii[0] - radii[1]) / radii[0].min(radii[1]),
                most,
            )
        };
        let fill = |between: [usize; 2], block: &mut [f64]| {
            let (offset, radii) = offset(between);
            let own = fewer.get(degree(between)).unwrap_or(pair);
            own.block_of(offset, radii, block);
            let [receiver, source] = between;
            let mut charged = [0.0; mode_count(FAR_DEGREE) * mode_count(FAR_DEGREE)];
            let charged = &mut charged[..far_modes * far_modes];
            let mut weights = [[0.0; WEIGHTS]; 2];
            let [first, second] = &mut weights;
            let weights = [
                stencils.decode(receiver, first),
                stencils.decode(source, second),
            ];
            near_kernel.between(
                far_modes,
                weights,
                stencils.steps(receiver, source),
                charged,
            );
            let rows = block.chunks_exact_mut(own.modes().len());
            for (row, charged) in rows.zip(charged.chunks_exact(far_modes)) {
                for (value, charged) in row.iter_mut().zip(charged) {
                    *value -= charged;
                }
            }
        };
        let pair_modes = |pair: [usize; 2]| mode_count(degree(pair));
        let near = PairBlocks::new([count, modes], sources, pair_modes, fill, workers);
        let points = sides[0] * sides[1];
        Some(Self {
            modes,
            order,
            stencils,
            columns: sides[0],
            convolution,
            near,
            charges: vec![0.0; points],
            potential: vec![0.0; points],
            moments: vec![0.0; count * modes],
            far: vec![0.0; count * modes],
        })
    }

    pub(crate) fn apply(&mut self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        self.apply_by(FreeSpaceConvolution::apply, coefficients, far, workers);
    }

    /// The same with transforms in single precision.
    pub(crate) fn apply_roughly(
        &mut self,
        coefficients: &[f64],
        far: &mut [f64],
        workers: Workers<'_>,
    ) {
        let convolve = FreeSpaceConvolution::apply_roughly;
        self.apply_by(convolve, coefficients, far, workers);
    }

    fn apply_by(
        &mut self,
        convolve: impl FnOnce(&mut FreeSpaceConvolution<'p>, &[f64], &mut [f64]),
        coefficients: &[f64],
        far: &mut [f64],
        workers: Workers<'_>,
    ) {
        match self.stencils.modes {
            1 => self.apply_modes::<1>(convolve, coefficients, far, workers),
            3 => self.apply_modes::<3>(convolve, coefficients, far, workers),
            _ => self.apply_modes::<6>(convolve, coefficients, far, workers),
        }
    }

    fn apply_modes<const MODES: usize>(
        &mut self,
        convolve: impl FnOnce(&mut FreeSpaceConvolution<'p>, &[f64], &mut [f64]),
        coefficients: &[f64],
        far: &mut [f64],
        workers: Workers<'_>,
    ) {
        let (modes, columns) = (self.modes, self.columns);
        let (stencils, potential) = (&self.stencils, &mut self.potential);
        let moments = &mut self.moments;
        for (moments, pillar) in moments.chunks_exact_mut(modes).zip(&self.order) {
            moments.copy_from_slice(&coefficients[*pillar as usize * modes..][..modes]);
        }
        let charge = |(): &mut (), row: usize, charges: &mut [f64]| {
            widest(
                #[inline(always)]
                || stencils.charge::<MODES>(row, modes, moments, charges),
            );
        };
        workers.fill(&mut self.charges, columns, ROWS, || (), charge);
        convolve(&mut self.convolution, &self.charges, potential);
        let gather = |(): &mut (), number: usize, far: &mut [f64]| {
            let moments = &moments[number * modes..][..MODES];
            far[MODES..].fill(0.0);
            widest(
                #[inline(always)]
                || stencils.gather::<MODES>(number, columns, potential, moments, far),
            );
        };
        workers.fill(&mut self.far, modes, PILLARS, || (), gather);
        self.near.add(moments, &mut self.far, workers);
        for (own, pillar) in self.far.chunks_exact(modes).zip(&self.order) {
            far[*pillar as usize * modes..][..modes].copy_from_slice(own);
        }
    }
}

/// Number of points of a rule in radial and angular direction.
const RULE_SHAPE: [usize; 2] = {
    let degree = FAR_DEGREE + 2 * (STENCIL - 1);
    [degree / 4 + 1, degree + 1]
};
const RULE_POINTS: usize = RULE_SHAPE[0] * RULE_SHAPE[1];

/// Points of a disc and the modes at these points times their weights.
struct Rule {
    points: Vec<(Point, Vec<f64>)>,
    far_modes: usize,
}

impl Rule {
    /// Exact for products of the modes with the polynomials of the stencil.
    fn new(far_modes: usize) -> Self {
        let [radial, around] = RULE_SHAPE;
        let mut basis = BasisEvaluator::new(FAR_DEGREE);
        let mut values = vec![0.0; mode_count(FAR_DEGREE)];
        let points = hemisphere(radial, around)
            .into_iter()
            .map(|(point, weight)| {
                basis.evaluate(point, &mut values);
                let weighted = values[..far_modes].iter().map(|y| y * weight).collect();
                (point, weighted)
            })
            .collect();
        Self { points, far_modes }
    }

    /// Computes the charges of a pillar for all modes, by rows.
    #[inline(always)]
    fn integrate<const MODES: usize>(&self, centre: Point, radius: f64, weights: &mut [f64]) {
        let mut along = [[[0.0; STENCIL]; 2]; RULE_POINTS];
        for (along, (point, _)) in along.iter_mut().zip(&self.points) {
            for k in 0..2 {
                along[k] = lagrange(centre[k] + radius * point[k]);
            }
        }
        for (row, weights) in weights.chunks_exact_mut(MODES * STENCIL).enumerate() {
            let mut sums = [[0.0; STENCIL]; MODES];
            for ([x, y], (_, values)) in along.iter().zip(&self.points) {
                let down = y[row];
                for (sums, value) in sums.iter_mut().zip(values) {
                    for (sum, along) in sums.iter_mut().zip(x) {
                        *sum += value * (along * down);
                    }
                }
            }
            weights.copy_from_slice(sums.as_flattened());
        }
    }

    /// Weights of a pillar from its radius and its centre, relative to the first of its charges, in grid steps: as integers, and the unit
    /// of every mode.
    fn weights(&self, centre: Point, radius: f64, workspace: &mut Weights) -> (Vec<i32>, Vec<f64>) {
        let modes = self.far_modes;
        let weights = &mut workspace[..modes * STENCIL * STENCIL];
        widest(
            #[inline(always)]
            || match modes {
                1 => self.integrate::<1>(centre, radius, weights),
                3 => self.integrate::<3>(centre, radius, weights),
                _ => self.integrate::<6>(centre, radius, weights),
            },
        );
        let mut units = vec![f64::MIN_POSITIVE; modes];
        for (number, weights) in weights.chunks_exact(STENCIL).enumerate() {
            let unit = &mut units[number % modes];
            *unit = weights
                .iter()
                .fold(*unit, |most, weight| most.max(weight.abs()));
        }
        units
            .iter_mut()
            .for_each(|unit| *unit /= f64::from(i32::MAX));
        let parts = weights
            .iter()
            .enumerate()
            .map(|(number, weight)| (weight / units[number / STENCIL % modes]).round() as i32);
        (parts.collect(), units)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::neighbours::Disc;
    use crate::numerics::neighbours::tests::random_discs;
    use crate::numerics::workers::CancelToken;
    use crate::problem::pillar_field::{
        ListedPillar, PillarBody, PillarField, PillarList, PlaneLattice,
    };
    use std::sync::Arc;

    fn sites(discs: impl IntoIterator<Item = Disc>) -> Sites {
        let pillar = |(centre, radius)| ListedPillar {
            centre,
            body: PillarBody {
                radius,
                ..PillarBody::of_column(0.0)
            },
        };
        let list = PillarList::new(discs.into_iter().map(pillar).collect()).unwrap();
        Sites::within(&PillarField::Listed(Arc::new(list)), f64::INFINITY)
    }

    /// Pillars at random positions on a tenth to a sixth of the plane, with radii between 0.75 and 1.25.
    fn scattered(side: i32, pitch: f64) -> Vec<Disc> {
        let mut discs = Vec::new();
        for i in 0..side {
            for j in 0..side {
                let number = f64::from(i * side + j);
                let any = |turn: f64| (turn * number + 0.3 * number.sqrt()).sin();
                let centre = [
                    pitch * (f64::from(i) + 0.22 * any(1.7) - 0.5 * f64::from(side)),
                    pitch * (f64::from(j) + 0.22 * any(2.3) - 0.5 * f64::from(side)),
                ];
                discs.push((centre, 1.0 + 0.25 * any(3.1)));
            }
        }
        discs
    }

    /// The same in four distant clusters.
    fn clustered(side: i32, pitch: f64) -> Vec<Disc> {
        let places = [
            [0.0, 0.0],
            [900.0, 100.0],
            [400.0, 1300.0],
            [-2000.0, 700.0],
        ];
        let cluster = |[x, y]: Point| {
            let discs = scattered(side, pitch).into_iter();
            discs.map(move |([u, v], radius)| ([u + x, v + y], radius))
        };
        places.into_iter().flat_map(cluster).collect()
    }

    #[test]
    fn interpolation_is_exact_for_polynomials() {
        let place = 2.81;
        let powers: [f64; 2] = [0, 1].map(|k| {
            let weights = lagrange(place);
            let of_point = |(point, weight): (usize, &f64)| weight * (point as f64).powi(6 + k);
            weights.iter().enumerate().map(of_point).sum()
        });
        assert!((powers[0] / place.powi(6) - 1.0).abs() < 1e-11);
        assert!((powers[1] / place.powi(7) - 1.0).abs() < 1e-11);
    }

    /// The products of all pairs, with as many modes as between near pillars on a grid.
    fn all_pairs(
        sites: &Sites,
        degree: usize,
        coefficients: &[f64],
        workers: Workers<'_>,
    ) -> Vec<f64> {
        let pairs: Vec<_> = (0..=degree).map(PairCoupling::new).collect();
        let offset = |[a, b]: [usize; 2]| {
            let offset = [0, 1].map(|k| sites.centres()[a][k] - sites.centres()[b][k]);
            (offset, [a, b].map(|pillar| sites.body(pillar).radius))
        };
        let of_pair = |pair: [usize; 2]| {
            let ([x, y], [a, b]) = offset(pair);
            &pairs[pair_degree((x.hypot(y) - a - b) / a.min(b), degree)]
        };
        let blocks = PairBlocks::<f64>::new(
            [sites.len(), mode_count(degree)],
            |receiver| (receiver as u32 + 1..sites.len() as u32).collect(),
            |pair| of_pair(pair).modes().len(),
            |pair, block| {
                let (offset, radii) = offset(pair);
                of_pair(pair).block_of(offset, radii, block);
            },
            workers,
        );
        let mut far = vec![0.0; coefficients.len()];
        blocks.add(coefficients, &mut far, workers);
        far
    }

    /// Checks products relative to the largest displacement.
    fn check_products(sites: &Sites, degree: usize, bar: f64) {
        let pair = PairCoupling::new(degree);
        let (cancel, modes) = (CancelToken::default(), mode_count(degree));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
        let pool = pool.unwrap();
        let [alone, together] = [None, Some(&pool)].map(|pool| Workers {
            pool,
            cancel: &cancel,
        });
        let size = sites.len() * modes;
        // Realistic coefficients, which decrease with increasing degree.
        let coefficients = |turn: f64| -> Vec<f64> {
            let of_mode = |k: usize| 0.2_f64.powi(pair.modes()[k % modes].degree as i32);
            let value = |k: usize| 0.6 + (turn * k as f64 + 0.3 * (k as f64).sqrt()).sin();
            (0..size).map(|k| of_mode(k) * value(k)).collect()
        };
        let (a, c) = (coefficients(1.7), coefficients(0.9));
        let product = |coefficients: &[f64], workers| {
            let mut far = vec![0.0; size];
            let mut grid = GridCoupling::new(sites, &pair, workers).unwrap();
            grid.apply(coefficients, &mut far, workers);
            far
        };
        let (of_a, by_grid) = (product(&a, alone), product(&c, alone));
        let threads = product(&c, together);
        assert!(
            by_grid
                .iter()
                .zip(&threads)
                .all(|(a, b)| a.to_bits() == b.to_bits())
        );
        let by_pairs = all_pairs(sites, degree, &c, alone);
        let scale = by_pairs.iter().fold(0.0_f64, |most, b| most.max(b.abs()));
        // Loads on the modes that the charges represent, and on the higher modes, which are small.
        let mut error = [0.0_f64; 2];
        for (k, (a, b)) in by_grid.iter().zip(&by_pairs).enumerate() {
            let beyond = pair.modes()[k % modes].degree > FAR_DEGREE;
            let error = &mut error[usize::from(beyond)];
            *error = error.max((a - b).abs() / scale);
        }
        println!("{} pillars, degree {degree}: {error:?}", sites.len());
        assert!(error[0] < bar, "degree {degree}: {error:?}");
        assert!(error[1] < 3e-5, "degree {degree}: {error:?}");
        let dot = |x: &[f64], y: &[f64]| -> f64 { x.iter().zip(y).map(|(x, y)| x * y).sum() };
        let (there, back) = (dot(&a, &by_grid), dot(&c, &of_a));
        assert!((there / back - 1.0).abs() < 1e-13, "{there} {back}");
    }

    #[test]
    fn products_are_those_of_all_pairs() {
        for (degree, side, pitch) in [(0, 12, 4.6), (2, 17, 4.6), (4, 12, 5.6)] {
            // The far field of the higher modes is neglected.
            let bar = if degree > FAR_DEGREE { 2e-7 } else { 5e-9 };
            check_products(&sites(scattered(side, pitch)), degree, bar);
        }
        check_products(&sites(random_discs(400, 0.2, 0.05, 3)), 4, 2e-7);
    }

    #[test]
    fn products_in_clusters_and_on_lattices() {
        for degree in [1, 2] {
            // Near pairs in single precision contribute most of the error.
            check_products(&sites(clustered(9, 4.6)), degree, 3e-8);
        }
        let lattice = PlaneLattice::new(
            [[4.6, 0.3], [0.2, 5.1]],
            [0.4, 1.0],
            PillarBody::of_column(0.0),
        );
        let lattice = PillarField::Lattice(Arc::new(lattice.unwrap()));
        check_products(&Sites::within(&lattice, 45.0), 2, 5e-9);
    }

    /// If clusters are far apart, the grid is so coarse that all pairs within a cluster are near.
    #[test]
    fn grids_of_clusters_are_bounded() {
        let even = Plan::new(&sites(scattered(30, 4.6)), 6);
        assert!(even.pairs < 20.0 * 900.0 && even.memory(900, 6) < 2e7);
        let clusters = Plan::new(&sites(clustered(15, 4.6)), 6);
        assert!(clusters.memory(900, 6) < 4e7, "{clusters:?}");
        // On one line; and two pillars at a very large distance.
        let row = (0..900).map(|k| ([3.0 * f64::from(k), 0.0], 1.0));
        assert!(Plan::new(&sites(row), 6).memory(900, 6) < 2e7);
        let far = [[0.0, 0.0], [1e12, 0.0]].map(|centre| (centre, 1.0));
        assert!(Plan::new(&sites(far), 6).memory(2, 6) < 1e7);
    }
}
