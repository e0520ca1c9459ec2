//! The coupling of many pillars at any places, by a grid: the pre-corrected fast Fourier transform
//! (J. R. Phillips and J. K. White, IEEE Trans. Comput.-Aided Des. 16, 1059 (1997)).
//!
//! Every pillar is replaced by charges on the points of a grid around it, `rho = P' m`, such that they act far away as it does. Their
//! potential `u = K rho` comes from a convolution with `1/(pi r)`, zero at `r = 0`, and what it does to a pillar is `P u`: the mean of its
//! interpolation with every mode. As the same `P` spreads and gathers, the product is symmetric. Between near pillars,
//! and from a pillar to itself, the charges are wrong: there `C - P K P'` is added, with the exact `C`, or nothing.
//!
//! The modes beyond degree 2 act on near pillars alone.

use super::direct::PairBlocks;
use super::pair::PairCoupling;
use super::sites::Sites;
use crate::halfspace::disc::basis::{BasisEvaluator, mode_count};
use crate::halfspace::elements::{FreeSpaceConvolution, Operator};
use crate::numerics::quadrature::hemisphere;
use crate::numerics::workers::Workers;
use crate::problem::{Cells, Grid, Point};
use std::collections::HashMap;
use std::f64::consts::PI;

/// Points along each side of the square of charges of a pillar.
const STENCIL: usize = 8;

/// Grid steps over the distance that each of as many evenly spread pillars would have.
const STEPS: f64 = 4.0;

/// Distance up to which pillars are near, in grid steps.
const NEAR: f64 = 12.0;

/// Degree of the modes that the charges stand for.
const FAR_DEGREE: usize = 2;

/// Pillars a thread takes at a time, at the least.
const PILLARS: usize = 200;

pub(crate) struct GridCoupling {
    modes: usize,
    /// Leading modes that the charges stand for.
    far_modes: usize,
    stencils: Vec<Stencil>,
    /// Points along x.
    columns: usize,
    convolution: FreeSpaceConvolution<'static>,
    near: PairBlocks,
    charges: Vec<f64>,
    potential: Vec<f64>,
}

/// The charges of a pillar.
struct Stencil {
    /// Column and row of the first.
    corner: [usize; 2],
    /// `P`: for every far mode, its charges row by row.
    weights: Vec<f64>,
    /// `P K P'` of the pillar itself, row by row.
    own: Vec<f64>,
}

/// The potential between points of the grid.
struct Kernel {
    /// For every distance along x and along y, up to [`REACH`](Self::REACH).
    values: Vec<f64>,
}

impl Kernel {
    /// Grid steps between two charges of near pillars, at the most.
    const REACH: usize = NEAR as usize + STENCIL + 1;

    fn new(step: f64) -> Self {
        let side = Self::REACH + 1;
        let values = (0..side * side).map(|k| kernel(step, [k % side, k / side]));
        Self {
            values: values.collect(),
        }
    }

    /// `P_n K P_k'` of two stencils, row by row.
    fn between(&self, receiver: &Stencil, source: &Stencil, block: &mut [f64]) {
        let size = STENCIL * STENCIL;
        let steps = [0, 1].map(|k| receiver.corner[k] as i64 - source.corner[k] as i64);
        let far_modes = source.weights.len() / size;
        let mut potential = vec![0.0; size];
        for (column, weights) in source.weights.chunks_exact(size).enumerate() {
            for (place, potential) in potential.iter_mut().enumerate() {
                let [x, y] = [place % STENCIL, place / STENCIL];
                let mut sum = 0.0;
                for (row, weights) in weights.chunks_exact(STENCIL).enumerate() {
                    let down = (steps[1] + y as i64 - row as i64).unsigned_abs() as usize;
                    let values = &self.values[down * (Self::REACH + 1)..];
                    for (other, weight) in weights.iter().enumerate() {
                        let along = (steps[0] + x as i64 - other as i64).unsigned_abs() as usize;
                        sum += weight * values[along];
                    }
                }
                *potential = sum;
            }
            for (row, weights) in receiver.weights.chunks_exact(size).enumerate() {
                let products = weights.iter().zip(&potential);
                block[row * far_modes + column] = products.map(|(p, u)| p * u).sum();
            }
        }
    }
}

fn kernel(step: f64, [x, y]: [usize; 2]) -> f64 {
    if [x, y] == [0, 0] {
        return 0.0;
    }
    (PI * step * (x as f64).hypot(y as f64)).recip()
}

/// Lagrange's polynomials of the points 0, 1, 2, ... at a place.
fn lagrange(place: f64) -> [f64; STENCIL] {
    std::array::from_fn(|k| {
        (0..STENCIL)
            .filter(|j| *j != k)
            .map(|j| (place - j as f64) / (k as f64 - j as f64))
            .product()
    })
}

impl GridCoupling {
    /// `None` where no grid can be made.
    pub(crate) fn new(sites: &Sites, pair: &PairCoupling, workers: Workers<'_>) -> Option<Self> {
        let (centres, count) = (sites.centres(), sites.len());
        let radius = |pillar: usize| sites.body(pillar).radius;
        let modes = pair.modes().len();
        let far_modes = modes.min(mode_count(FAR_DEGREE));
        let bounds = |k: usize| {
            let values = centres.iter().map(|centre| centre[k]);
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| {
                [a.min(x), b.max(x)]
            })
        };
        let ([left, right], [low, high]) = (bounds(0), bounds(1));
        let largest = (0..count).map(radius).fold(0.0, f64::max);
        // The discs have to lie within their stencils, and pillars in a row take some room too.
        let [width, height] = [right - left, high - low].map(|side| side.max(2.0 * largest));
        let even = (width * height / count as f64).sqrt();
        let half = (STENCIL / 2 - 1) as f64;
        let step = (even / STEPS).max(largest / half);
        let first = [left, low].map(|x| x - half * step);
        let sides = [right - left, high - low].map(|side| (side / step) as usize + STENCIL + 1);
        let grid = Grid::new(sides[0], sides[1], [step; 2], first).ok()?;
        let cells = Cells::all(&grid);
        let convolution = FreeSpaceConvolution::of_kernel(cells, |steps| kernel(step, steps));
        let near_kernel = Kernel::new(step);
        let rule = Rule::new(far_modes);
        let make = |(): &mut (), pillar: usize| {
            let place = [0, 1].map(|k| (centres[pillar][k] - first[k]) / step);
            rule.stencil(place, radius(pillar) / step, &near_kernel)
        };
        let stencils = workers.map(count, PILLARS, || (), make);
        let reach = NEAR * step;
        let bins = Bins::new(centres, reach);
        let fill = |[receiver, source]: [usize; 2], block: &mut [f64]| {
            let offset = [0, 1].map(|k| centres[receiver][k] - centres[source][k]);
            pair.block_of(offset, [radius(receiver), radius(source)], block);
            let mut charged = vec![0.0; far_modes * far_modes];
            near_kernel.between(&stencils[receiver], &stencils[source], &mut charged);
            let rows = block.chunks_exact_mut(modes);
            for (row, charged) in rows.zip(charged.chunks_exact(far_modes)) {
                for (value, charged) in row.iter_mut().zip(charged) {
                    *value -= charged;
                }
            }
        };
        let sources = |receiver: usize| bins.after(centres, receiver, reach);
        let near = PairBlocks::new(count, modes, sources, fill, workers);
        Some(Self {
            modes,
            far_modes,
            stencils,
            columns: sides[0],
            convolution,
            near,
            charges: vec![0.0; sides[0] * sides[1]],
            potential: vec![0.0; sides[0] * sides[1]],
        })
    }

    /// About how many bytes that many pillars take.
    pub(crate) fn memory_estimate(pillars: f64, modes: usize) -> f64 {
        let of_pillar = modes as f64;
        let stencil = 8.0 * (STENCIL * STENCIL * mode_count(FAR_DEGREE)) as f64;
        // Half of the neighbours within the near distance, and of the grid two arrays, the kernel and the spectrum.
        let neighbours = 0.5 * PI * (NEAR / STEPS).powi(2);
        let blocks = 8.0 * neighbours * of_pillar * of_pillar;
        let grid = 6.0 * 8.0 * STEPS * STEPS;
        pillars * (stencil + blocks + grid + 12.0 * 8.0 * of_pillar)
    }

    pub(crate) fn apply(&mut self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        let (modes, far_modes, columns) = (self.modes, self.far_modes, self.columns);
        self.charges.fill(0.0);
        let moments = coefficients.chunks_exact(modes);
        for (stencil, moments) in self.stencils.iter().zip(moments) {
            let of_modes = stencil.weights.chunks_exact(STENCIL * STENCIL);
            for (weights, moment) in of_modes.zip(moments) {
                for (row, weights) in weights.chunks_exact(STENCIL).enumerate() {
                    let start = (stencil.corner[1] + row) * columns + stencil.corner[0];
                    let charges = &mut self.charges[start..start + STENCIL];
                    for (charge, weight) in charges.iter_mut().zip(weights) {
                        *charge += moment * weight;
                    }
                }
            }
        }
        self.convolution.apply(&self.charges, &mut self.potential);
        let (stencils, potential) = (&self.stencils, &self.potential);
        let gather = |(): &mut (), pillar: usize, far: &mut [f64]| {
            let stencil = &stencils[pillar];
            let moments = &coefficients[pillar * modes..][..far_modes];
            far.fill(0.0);
            let of_modes = stencil.weights.chunks_exact(STENCIL * STENCIL);
            for ((far, weights), own) in far
                .iter_mut()
                .zip(of_modes)
                .zip(stencil.own.chunks_exact(far_modes))
            {
                for (row, weights) in weights.chunks_exact(STENCIL).enumerate() {
                    let start = (stencil.corner[1] + row) * columns + stencil.corner[0];
                    for (weight, u) in weights.iter().zip(&potential[start..]) {
                        *far += weight * u;
                    }
                }
                *far -= own.iter().zip(moments).map(|(a, b)| a * b).sum::<f64>();
            }
        };
        workers.fill(far, modes, PILLARS, || (), gather);
        self.near.add(coefficients, far);
    }
}

/// Points of a disc with the modes there times their weights.
struct Rule {
    points: Vec<(Point, Vec<f64>)>,
    far_modes: usize,
}

impl Rule {
    /// Exact for products of the modes with the polynomials of the stencil.
    fn new(far_modes: usize) -> Self {
        let degree = FAR_DEGREE + 2 * (STENCIL - 1);
        let mut basis = BasisEvaluator::new(FAR_DEGREE);
        let mut values = vec![0.0; mode_count(FAR_DEGREE)];
        let points = hemisphere(degree / 4 + 1, degree + 1)
            .into_iter()
            .map(|(point, weight)| {
                basis.evaluate(point, &mut values);
                let weighted = values[..far_modes].iter().map(|y| y * weight).collect();
                (point, weighted)
            })
            .collect();
        Self { points, far_modes }
    }

    /// Of a pillar with its centre and radius in grid steps.
    fn stencil(&self, centre: Point, radius: f64, kernel: &Kernel) -> Stencil {
        let size = STENCIL * STENCIL;
        let corner = centre.map(|x| (x as usize).saturating_sub(STENCIL / 2 - 1));
        let mut weights = vec![0.0; self.far_modes * size];
        for (point, values) in &self.points {
            let [x, y] = [0, 1].map(|k| lagrange(centre[k] + radius * point[k] - corner[k] as f64));
            for (weights, value) in weights.chunks_exact_mut(size).zip(values) {
                for (row, down) in weights.chunks_exact_mut(STENCIL).zip(y) {
                    for (weight, along) in row.iter_mut().zip(x) {
                        *weight += value * down * along;
                    }
                }
            }
        }
        let mut stencil = Stencil {
            corner,
            weights,
            own: vec![0.0; self.far_modes * self.far_modes],
        };
        let mut own = std::mem::take(&mut stencil.own);
        kernel.between(&stencil, &stencil, &mut own);
        Stencil { own, ..stencil }
    }
}

/// Pillars by the square of the plane that they stand in.
struct Bins {
    side: f64,
    pillars: HashMap<[i64; 2], Vec<u32>>,
}

impl Bins {
    fn new(centres: &[Point], side: f64) -> Self {
        let mut pillars: HashMap<_, Vec<u32>> = HashMap::new();
        for (pillar, centre) in centres.iter().enumerate() {
            let bin = centre.map(|x| (x / side).floor() as i64);
            pillars.entry(bin).or_default().push(pillar as u32);
        }
        Self { side, pillars }
    }

    /// Those after a pillar that are within a distance of it, of a side at the most, in their order.
    fn after(&self, centres: &[Point], pillar: usize, distance: f64) -> Vec<u32> {
        let [x, y] = centres[pillar];
        let [i, j] = [x, y].map(|x| (x / self.side).floor() as i64);
        let around = (-1..=1).flat_map(|k| (-1..=1).map(move |l| [i + k, j + l]));
        let mut found: Vec<u32> = around
            .filter_map(|bin| self.pillars.get(&bin))
            .flatten()
            .copied()
            .filter(|&other| {
                let [u, v] = centres[other as usize];
                other as usize > pillar && (u - x).hypot(v - y) < distance
            })
            .collect();
        found.sort_unstable();
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::coupling::direct::DirectCoupling;
    use crate::numerics::workers::CancelToken;
    use crate::problem::pillar_field::{ListedPillar, PillarBody, PillarField, PillarList};
    use std::sync::Arc;

    /// Pillars on about a tenth to a sixth of the plane, at any places, of radii between 0.75 and 1.25.
    fn scattered(side: i32, pitch: f64) -> PillarField {
        let mut pillars = Vec::new();
        for i in 0..side {
            for j in 0..side {
                let number = f64::from(i * side + j);
                let any = |turn: f64| (turn * number + 0.3 * number.sqrt()).sin();
                let centre = [
                    pitch * (f64::from(i) + 0.22 * any(1.7) - 0.5 * f64::from(side)),
                    pitch * (f64::from(j) + 0.22 * any(2.3) - 0.5 * f64::from(side)),
                ];
                let body = PillarBody {
                    radius: 1.0 + 0.25 * any(3.1),
                    ..PillarBody::of_column(0.0)
                };
                pillars.push(ListedPillar { centre, body });
            }
        }
        PillarField::Listed(Arc::new(PillarList::new(pillars).unwrap()))
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

    #[test]
    fn products_are_those_of_all_pairs() {
        for (degree, side, pitch) in [(0, 12, 4.6), (2, 17, 4.6), (4, 12, 5.6)] {
            let sites = Sites::within(&scattered(side, pitch), f64::INFINITY);
            let pair = PairCoupling::new(degree, pitch);
            let cancel = CancelToken::default();
            let workers = Workers {
                pool: None,
                cancel: &cancel,
            };
            let size = sites.len() * mode_count(degree);
            // As they are: the higher the degree, the smaller.
            let coefficients = |turn: f64| -> Vec<f64> {
                let of_mode =
                    |k: usize| 0.2_f64.powi(pair.modes()[k % mode_count(degree)].degree as i32);
                let value = |k: usize| 0.6 + (turn * k as f64 + 0.3 * (k as f64).sqrt()).sin();
                (0..size).map(|k| of_mode(k) * value(k)).collect()
            };
            let (a, c) = (coefficients(1.7), coefficients(0.9));
            let mut grid = GridCoupling::new(&sites, &pair, workers).unwrap();
            let radius = |pillar: usize| sites.body(pillar).radius;
            let direct = DirectCoupling::new(sites.centres(), radius, &pair, workers);
            let [mut by_grid, mut of_a, mut by_pairs] = [(); 3].map(|()| vec![0.0; size]);
            grid.apply(&a, &mut of_a, workers);
            grid.apply(&c, &mut by_grid, workers);
            direct.apply(&c, &mut by_pairs);
            let scale = by_pairs.iter().fold(0.0_f64, |most, b| most.max(b.abs()));
            // Loads on the modes that the charges stand for, and on those beyond, which excite little.
            let mut error = [0.0_f64; 2];
            for (k, (a, b)) in by_grid.iter().zip(&by_pairs).enumerate() {
                let beyond = pair.modes()[k % mode_count(degree)].degree > FAR_DEGREE;
                let error = &mut error[usize::from(beyond)];
                *error = error.max((a - b).abs() / scale);
            }
            println!("degree {degree}: {error:?}");
            // What the modes beyond do from afar is left out.
            let bar = if degree > FAR_DEGREE { 2e-7 } else { 5e-9 };
            assert!(error[0] < bar, "degree {degree}: {error:?}");
            assert!(error[1] < 3e-5, "degree {degree}: {error:?}");
            let dot = |x: &[f64], y: &[f64]| -> f64 { x.iter().zip(y).map(|(x, y)| x * y).sum() };
            let (there, back) = (dot(&a, &by_grid), dot(&c, &of_a));
            assert!((there / back - 1.0).abs() < 1e-13, "{there} {back}");
        }
    }
}
