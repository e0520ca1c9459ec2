//! Tables of the smooth corrections for layers as functions of distance.
//!
//! Every function is `factor r^(-power) sum_b w_b ∫ (phi_b(k t_b) - 1) j_l(k a) j_l'(k a') .. J_M(k r) dk`, with one spherical Bessel
//! function for each disc, of radius `a`, `a'`, ... It is analytic except for branch points at `r = ±s ± 2i t`, with `s` the sum of the
//! radii. Chebyshev polynomials on intervals whose length grows with the distance from the branch points therefore represent it to full
//! precision. Intervals are computed on first use and divided into cells with a short polynomial each.

use super::response::LayerResponse;
use crate::numerics::special::{bessel, spherical_bessel};
use crate::problem::layer::WeightedLayer;
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// Number of Chebyshev points in an interval: the error is 1e-15 for intervals at this distance from the branch points.
const POINTS: usize = 24;

/// Number of cells in an interval, and of coefficients of the polynomial in each: the accuracy is the same.
const CELLS: usize = 16;
const TERMS: usize = 9;

/// Number of functions that are evaluated together.
const GROUP: usize = 4;

/// Largest length of an interval relative to its distance from the branch points.
const GROWTH: f64 = 1.5;

/// Distance up to which there are intervals, in pillar radii: far beyond the radius of any lens.
const FARTHEST: f64 = 1e8;

/// One function of the distance.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RadialPart {
    pub(crate) factor: f64,
    /// Degrees of the modes of the discs.
    pub(crate) degrees: Vec<usize>,
    /// `M`
    pub(crate) order: usize,
    /// Power of the distance by which the function is divided.
    pub(crate) power: usize,
}

/// Largest number of discs in a function.
const MOST_DISCS: usize = 2;

/// A set of functions of the distance.
#[derive(Debug)]
pub(crate) struct RadialTable {
    parts: Arc<[RadialPart]>,
    layers: Vec<(WeightedLayer, LayerResponse)>,
    /// Radii of the discs.
    radii: [f64; MOST_DISCS],
    /// Sum of the radii of the discs in a function.
    discs: f64,
    /// Coefficient of a Gaussian factor: the integrands are multiplied by `exp(-blur k^2)`.
    blur: f64,
    /// Boundaries of the intervals.
    ends: Vec<f64>,
    pieces: Vec<OnceLock<Piece>>,
}

#[derive(Debug)]
struct Piece {
    start: f64,
    /// Half the length of a cell.
    half: f64,
    /// For every cell and every group of functions, the coefficients in powers of the distance from the middle of the cell in units of its
    /// half length.
    coefficients: Vec<[f64; GROUP]>,
}

impl RadialTable {
    /// Discs of unit radius; layers are given in this radius.
    pub(crate) fn new(layers: &[WeightedLayer], parts: Vec<RadialPart>) -> Self {
        Self::of_radii(layers, &parts.into(), [1.0; MOST_DISCS])
    }

    /// Discs of these radii, in the unit of length of the layers.
    pub(crate) fn of_radii(
        layers: &[WeightedLayer],
        parts: &Arc<[RadialPart]>,
        radii: [f64; MOST_DISCS],
    ) -> Self {
        let discs = parts.iter().map(|part| part.degrees.len()).max();
        let discs = radii.iter().take(discs.unwrap_or(0)).sum();
        let thinnest = WeightedLayer::thinnest(layers).unwrap_or(f64::INFINITY);
        let mut ends = vec![0.0];
        let mut end = 0.0;
        while end < FARTHEST {
            end += (2.0 * thinnest).max(GROWTH * (end - discs));
            ends.push(end);
        }
        Self {
            pieces: ends.windows(2).map(|_| OnceLock::new()).collect(),
            layers: layers
                .iter()
                .map(|layer| (*layer, LayerResponse::of(layer)))
                .collect(),
            parts: Arc::clone(parts),
            radii,
            discs,
            blur: 0.0,
            ends,
        }
    }

    /// The same with integrands multiplied by `exp(-blur k^2)`. Must be called before the first evaluation.
    pub(crate) fn blurred(self, blur: f64) -> Self {
        Self { blur, ..self }
    }

    /// Number of functions.
    pub(crate) fn count(&self) -> usize {
        self.parts.len()
    }

    /// The polynomials of the cell that contains a distance, by groups, their variable, and its derivative with respect to the distance.
    #[inline(always)]
    fn cell(&self, distance: f64) -> (&[[f64; GROUP]], f64, f64) {
        let number = self.ends.partition_point(|end| *end <= distance);
        let number = number.min(self.pieces.len()).max(1) - 1;
        let piece = self.pieces[number].get_or_init(|| self.piece(number));
        let inverse = piece.half.recip();
        let place = (distance - piece.start) * inverse;
        let cell = ((0.5 * place) as usize).min(CELLS - 1);
        let size = TERMS * self.count().div_ceil(GROUP);
        let variable = place - (2 * cell + 1) as f64;
        (
            &piece.coefficients[cell * size..][..size],
            variable,
            inverse,
        )
    }

    /// The functions at a distance by their integrals, for a single evaluation.
    pub(crate) fn integrals_at(&self, distance: f64) -> Vec<f64> {
        self.integrals(&[distance], distance)
    }

    /// The functions at a distance.
    pub(crate) fn values(&self, distance: f64, values: &mut [f64]) {
        let (coefficients, x, _) = self.cell(distance);
        let groups = coefficients.chunks_exact(TERMS);
        for (terms, values) in groups.zip(values[..self.count()].chunks_mut(GROUP)) {
            let mut sums = [0.0; GROUP];
            for row in terms.iter().rev() {
                for (sum, coefficient) in sums.iter_mut().zip(row) {
                    *sum = *sum * x + coefficient;
                }
            }
            values.copy_from_slice(&sums[..values.len()]);
        }
    }

    /// The functions at a distance with their first two derivatives.
    #[inline(always)]
    pub(crate) fn jets(&self, distance: f64, [value, first, second]: [&mut [f64]; 3]) {
        let (coefficients, x, inverse) = self.cell(distance);
        let count = self.count();
        let [value, first, second] =
            [value, first, second].map(|all| all[..count].chunks_mut(GROUP));
        let groups = coefficients
            .chunks_exact(TERMS)
            .zip(value)
            .zip(first)
            .zip(second);
        for (((terms, value), first), second) in groups {
            let [mut f, mut f1, mut half_f2] = [[0.0; GROUP]; 3];
            for row in terms.iter().rev() {
                for k in 0..GROUP {
                    half_f2[k] = half_f2[k] * x + f1[k];
                    f1[k] = f1[k] * x + f[k];
                    f[k] = f[k] * x + row[k];
                }
            }
            let there = value.len();
            value.copy_from_slice(&f[..there]);
            first.copy_from_slice(&f1.map(|f1| f1 * inverse)[..there]);
            let twice = 2.0 * inverse * inverse;
            second.copy_from_slice(&half_f2.map(|f2| f2 * twice)[..there]);
        }
    }

    fn piece(&self, number: usize) -> Piece {
        let (start, end) = (self.ends[number], self.ends[number + 1]);
        let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
        let count = self.count();
        let nodes = chebyshev_points(POINTS).map(|x| middle + half * x);
        let at_nodes = self.integrals(&nodes.collect::<Vec<f64>>(), end);
        let of_piece = chebyshev_coefficients(&at_nodes, count);
        let cell_half = 1.0 / CELLS as f64;
        let mut coefficients = Vec::with_capacity(CELLS * TERMS * count.div_ceil(GROUP));
        for cell in 0..CELLS {
            let centre = -1.0 + cell_half * (2 * cell + 1) as f64;
            let mut at_points = Vec::with_capacity(TERMS * count);
            for x in chebyshev_points(TERMS) {
                at_points.extend(chebyshev_sums(&of_piece, count, centre + cell_half * x));
            }
            let powers = monomials(&chebyshev_coefficients(&at_points, count), count);
            for first in (0..count).step_by(GROUP) {
                coefficients.extend(powers.chunks_exact(count).map(|row| {
                    std::array::from_fn(|k| row.get(first + k).copied().unwrap_or(0.0))
                }));
            }
        }
        Piece {
            start,
            half: half * cell_half,
            coefficients,
        }
    }

    /// The functions at distances up to `largest`, one distance after another.
    fn integrals(&self, distances: &[f64], largest: f64) -> Vec<f64> {
        let count = self.count();
        let highest = |of: fn(&RadialPart) -> usize| self.parts.iter().map(of).max().unwrap_or(0);
        let order = highest(|part| part.order);
        let degree = highest(|part| part.degrees.iter().copied().max().unwrap_or(0));
        let mut around = vec![0.0; order + 1];
        let mut along = [(); MOST_DISCS].map(|()| vec![0.0; degree + 1]);
        let alike = self.radii[0].to_bits() == self.radii[1].to_bits();
        let mut sums = vec![0.0; distances.len() * count];
        let mut products = vec![0.0; count];
        for (layer, response) in &self.layers {
            let inverse = layer.thickness.recip();
            for (x, weight) in response.rule((largest + self.discs) * inverse) {
                let k = x * inverse;
                let [first, second] = &mut along;
                spherical_bessel(k * self.radii[0], first);
                if alike {
                    second.copy_from_slice(first);
                } else {
                    spherical_bessel(k * self.radii[1], second);
                }
                let scale = layer.weight * weight * inverse * (-self.blur * k * k).exp();
                for (product, part) in products.iter_mut().zip(&*self.parts) {
                    let discs = part.degrees.iter().zip(&along);
                    let discs = discs.map(|(degree, along)| along[*degree]);
                    *product = scale * part.factor * discs.product::<f64>();
                }
                for (distance, sums) in distances.iter().zip(sums.chunks_exact_mut(count)) {
                    bessel(k * distance, &mut around);
                    for ((sum, product), part) in sums.iter_mut().zip(&products).zip(&*self.parts) {
                        *sum += product * around[part.order];
                    }
                }
            }
        }
        for (distance, sums) in distances.iter().zip(sums.chunks_exact_mut(count)) {
            for (sum, part) in sums.iter_mut().zip(&*self.parts) {
                *sum /= distance.powi(part.power as i32);
            }
        }
        sums
    }
}

/// The zeros of the Chebyshev polynomial of degree `count`.
fn chebyshev_points(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |k| (PI * (k as f64 + 0.5) / count as f64).cos())
}

/// Chebyshev coefficients from values of functions at these points.
fn chebyshev_coefficients(values: &[f64], count: usize) -> Vec<f64> {
    let points = values.len() / count;
    let mut coefficients = vec![0.0; values.len()];
    for (degree, sums) in coefficients.chunks_exact_mut(count).enumerate() {
        for (k, values) in values.chunks_exact(count).enumerate() {
            let angle = PI * degree as f64 * (k as f64 + 0.5) / points as f64;
            let weight = if degree == 0 { 1.0 } else { 2.0 } / points as f64 * angle.cos();
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += weight * value;
            }
        }
    }
    coefficients
}

/// Evaluates Chebyshev series.
fn chebyshev_sums(coefficients: &[f64], count: usize, x: f64) -> Vec<f64> {
    // T_0, and T_(-1) = T_1.
    let (mut value, mut before) = (1.0, x);
    let mut sums = vec![0.0; count];
    for row in coefficients.chunks_exact(count) {
        for (sum, coefficient) in sums.iter_mut().zip(row) {
            *sum += value * coefficient;
        }
        (before, value) = (value, 2.0 * x * value - before);
    }
    sums
}

/// Converts Chebyshev coefficients to powers.
fn monomials(coefficients: &[f64], count: usize) -> Vec<f64> {
    let terms = coefficients.len() / count;
    let mut powers = vec![0.0; coefficients.len()];
    // T_n in powers, and T_(n-1).
    let (mut present, mut before) = (vec![0.0; terms], vec![0.0; terms]);
    present[0] = 1.0;
    for (degree, row) in coefficients.chunks_exact(count).enumerate() {
        for (power, factor) in powers.chunks_exact_mut(count).zip(&present) {
            for (value, coefficient) in power.iter_mut().zip(row) {
                *value += factor * coefficient;
            }
        }
        let twice = if degree == 0 { 1.0 } else { 2.0 };
        let next: Vec<f64> = (0..terms)
            .map(|k| twice * if k > 0 { present[k - 1] } else { 0.0 } - before[k])
            .collect();
        before = std::mem::replace(&mut present, next);
    }
    powers
}
