//! The coupling coefficients between the modes of two pillars, in closed form.
//!
//! For a receiver at `D` from the source, `delta = |D| > 2` (in pillar radii) and `Phi` the angle
//! of `D`, complex modes of azimuthal difference or sum `M` couple by
//! `g(l,m; l',m'; M) = 4 pi y_lm y_l'm' i^(l-l'+M) ∫ j_l(k) j_l'(k) J_M(k delta) dk`
//! (the Fourier transform of `Y_lm/mu` is `2 pi (-i)^l j_l(k) Y_lm(equator)`), which is a 4F3 series
//! in `4/delta^2` with terms of one sign:
//! `(-1)^l pi y y' G((1+L+M)/2) G((1+L-M)/2)/(G(l+3/2) G(l'+3/2)) delta^(-L-1)
//! 4F3((L+2)/2, (L+3)/2, (1+L+M)/2, (1+L-M)/2; L+2, l+3/2, l'+3/2; 4/delta^2)`, `L = l + l'`
//! (the Weber-Schafheitlin integral with a product of two Bessel functions; Watson, Theory
//! of Bessel Functions, 5.41 and 13.4).

use crate::halfspace::disc::basis::{
    Mode, UNIT_FORCE, equator_value, gamma_degree, mode_count, modes,
};
use crate::halfspace::disc::exterior::RadialFunction;
use crate::numerics::special::gamma_half;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Relative size of the terms at which the series is cut.
const SERIES_TOLERANCE: f64 = 1e-17;

/// Most terms of a series. Reached only for pillars that all but touch, where the rest is
/// added from the algebraic decay of the terms.
const SERIES_LIMIT: usize = 20_000;

/// One series: a pair of complex modes with one `M`.
#[derive(Debug, Clone)]
struct Series {
    factor: f64,
    /// `L = l + l'`
    degree_sum: usize,
    /// Numerator parameters of the 4F3 ...
    upper: [f64; 4],
    /// ... and denominator parameters.
    lower: [f64; 3],
}

impl Series {
    /// `receiver` and `source` are `(degree, order)`.
    fn new(receiver: (usize, usize), source: (usize, usize), azimuthal: usize) -> Self {
        let ((l, m), (k, n)) = (receiver, source);
        let sum = l + k;
        let sign = if l % 2 == 0 { 1.0 } else { -1.0 };
        let factor = sign
            * PI
            * equator_value(l, m)
            * equator_value(k, n)
            * gamma_half(1 + sum + azimuthal)
            * gamma_half(1 + sum - azimuthal)
            / (gamma_degree(l) * gamma_degree(k));
        let half = |n: usize| 0.5 * n as f64;
        Self {
            factor,
            degree_sum: sum,
            upper: [
                half(sum + 2),
                half(sum + 3),
                half(1 + sum + azimuthal),
                half(1 + sum - azimuthal),
            ],
            lower: [(sum + 2) as f64, l as f64 + 1.5, k as f64 + 1.5],
        }
    }

    fn value(&self, delta: f64) -> f64 {
        let z = 4.0 / (delta * delta);
        let (mut term, mut sum) = (1.0, 1.0);
        for s in 0..SERIES_LIMIT {
            let s = s as f64;
            let up: f64 = self.upper.iter().map(|a| a + s).product();
            let down: f64 = self.lower.iter().map(|b| b + s).product::<f64>() * (s + 1.0);
            term *= z * up / down;
            sum += term;
            if term < SERIES_TOLERANCE * sum {
                return self.factor * delta.powi(-(self.degree_sum as i32) - 1) * sum;
            }
        }
        // At z -> 1 terms go as s^(-5/2) (parametric excess 3/2): the rest is term s/(3/2).
        sum += term * SERIES_LIMIT as f64 / 1.5;
        self.factor * delta.powi(-(self.degree_sum as i32) - 1) * sum
    }
}

/// Which series make up one entry of the block between two pillars.
#[derive(Debug, Clone, Copy)]
struct Entry {
    receiver: Mode,
    source: Mode,
    /// Index of the series with `M = |m - m'|`; the next one has `M = m + m'`.
    series: usize,
    weight: f64,
}

/// Coupling between two pillars of a lattice, for the modes up to a degree.
#[derive(Debug, Clone)]
pub(crate) struct PairCoupling {
    modes: Vec<Mode>,
    pitch: f64,
    series: Vec<Series>,
    /// Whether pillars act as flat punches on the centres of the others, without series.
    flat_punches: Option<RadialFunction>,
    /// Entries with source index >= receiver index, row by row.
    entries: Vec<Entry>,
}

impl PairCoupling {
    /// `pitch` in pillar radii.
    pub(crate) fn new(degree: usize, pitch: f64) -> Self {
        let modes = modes(degree);
        let mut series = Vec::new();
        let mut known: Vec<((usize, usize), (usize, usize))> = Vec::new();
        let mut entries = Vec::with_capacity(mode_count(degree) * (mode_count(degree) + 1) / 2);
        for (row, &receiver) in modes.iter().enumerate() {
            for &source in &modes[row..] {
                let key = (
                    (receiver.degree, receiver.order),
                    (source.degree, source.order),
                );
                let index = known.iter().position(|k| *k == key).unwrap_or_else(|| {
                    let (m, n) = (receiver.order, source.order);
                    series.push(Series::new(key.0, key.1, m.abs_diff(n)));
                    series.push(Series::new(key.0, key.1, m + n));
                    known.push(key);
                    known.len() - 1
                });
                let axial = |mode: Mode| if mode.order == 0 { FRAC_1_SQRT_2 } else { 1.0 };
                entries.push(Entry {
                    receiver,
                    source,
                    series: 2 * index,
                    weight: axial(receiver) * axial(source),
                });
            }
        }
        Self {
            modes,
            pitch,
            series,
            flat_punches: None,
            entries,
        }
    }

    /// Degree 0 with the displacement `(2/pi) zeta arcsin(1/delta)` of a flat punch at the centre
    /// of the receiving pillar instead of its average over the pillar, as in the paper.
    pub(crate) fn of_flat_punches(pitch: f64) -> Self {
        Self {
            flat_punches: Some(RadialFunction::new(0, 0)),
            ..Self::new(0, pitch)
        }
    }

    pub(crate) fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// Pitch in pillar radii.
    pub(crate) fn pitch(&self) -> f64 {
        self.pitch
    }

    /// Number of entries of a block on and above its diagonal.
    pub(crate) fn entry_count(&self) -> usize {
        self.entries.len()
    }

    /// Number of radial functions of [`Self::radial`].
    pub(crate) fn radial_count(&self) -> usize {
        self.series.len()
    }

    /// The parts that depend on the distance alone (`delta` in pillar radii), into `radial`.
    pub(crate) fn radial(&self, delta: f64, radial: &mut [f64]) {
        if let Some(punch) = &self.flat_punches {
            radial.fill(UNIT_FORCE * punch.value(delta.recip()));
            return;
        }
        for (value, series) in radial.iter_mut().zip(&self.series) {
            *value = series.value(delta);
        }
    }

    /// Entries on and above the diagonal of the block for the unit vector `direction` from
    /// source to receiver, row by row.
    pub(crate) fn upper_block(&self, radial: &[f64], direction: [f64; 2], block: &mut [f64]) {
        for (value, entry) in block.iter_mut().zip(&self.entries) {
            *value = entry.value(radial, direction);
        }
    }

    /// The whole block for receiver minus source `= [x, y]`, in pillar radii, row by row: a
    /// row is a mode of the receiver.
    pub(crate) fn block(&self, [x, y]: [f64; 2], block: &mut [f64]) {
        let delta = x.hypot(y);
        let mut radial = vec![0.0; self.radial_count()];
        self.radial(delta, &mut radial);
        let count = self.modes.len();
        let mut entries = self.entries.iter();
        for row in 0..count {
            for column in row..count {
                let Some(entry) = entries.next() else { return };
                let value = entry.value(&radial, [x / delta, y / delta]);
                // B_ji(D) = (-1)^(l + l') B_ij(D)
                let odd = (entry.receiver.degree + entry.source.degree) % 2 == 1;
                block[row * count + column] = value;
                block[column * count + row] = if odd && row != column { -value } else { value };
            }
        }
    }
}

impl Entry {
    fn value(&self, radial: &[f64], direction: [f64; 2]) -> f64 {
        let (m, n) = (self.receiver.order as i32, self.source.order as i32);
        let difference = angle_multiple(direction, n - m);
        let sum = angle_multiple(direction, n + m);
        let (minus, plus) = (radial[self.series], radial[self.series + 1]);
        self.weight
            * match (self.receiver.sine, self.source.sine) {
                (false, false) => minus * difference[0] + plus * sum[0],
                (true, true) => minus * difference[0] - plus * sum[0],
                (false, true) => minus * difference[1] + plus * sum[1],
                (true, false) => -minus * difference[1] + plus * sum[1],
            }
    }
}

/// Cosine and sine of `multiple` times the angle of the unit vector `direction`.
fn angle_multiple([cos, sin]: [f64; 2], multiple: i32) -> [f64; 2] {
    let mut result = [1.0, 0.0];
    for _ in 0..multiple.unsigned_abs() {
        result = [
            result[0] * cos - result[1] * sin,
            result[0] * sin + result[1] * cos,
        ];
    }
    if multiple < 0 {
        result[1] = -result[1];
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::disc::basis::BasisEvaluator;
    use crate::numerics::quadrature::hemisphere;

    /// `∫∫ Y_i Y_j/(pi |x - x'|) dOmega dOmega'` over two discs, by product quadrature.
    fn by_quadrature(degree: usize, offset: [f64; 2]) -> Vec<f64> {
        let count = mode_count(degree);
        let mut basis = BasisEvaluator::new(degree);
        let rule: Vec<_> = hemisphere(22, 80)
            .into_iter()
            .map(|(point, weight)| {
                let mut values = vec![0.0; count];
                basis.evaluate(point, &mut values);
                (point, weight, values)
            })
            .collect();
        let mut block = vec![0.0; count * count];
        let mut field = vec![0.0; count];
        for (at, weight, receiver) in &rule {
            field.fill(0.0);
            for (from, weight, source) in &rule {
                let distance = (at[0] + offset[0] - from[0]).hypot(at[1] + offset[1] - from[1]);
                for (sum, value) in field.iter_mut().zip(source) {
                    *sum += weight * value / (PI * distance);
                }
            }
            for (row, value) in receiver.iter().enumerate() {
                for (column, field) in field.iter().enumerate() {
                    block[row * count + column] += weight * value * field;
                }
            }
        }
        block
    }

    #[test]
    fn blocks_by_double_quadrature() {
        let degree = 4;
        let count = mode_count(degree);
        let pair = PairCoupling::new(degree, 4.0);
        for offset in [[3.7, 0.0], [2.9, 2.5], [-6.0, 1.0]] {
            let expected = by_quadrature(degree, offset);
            let mut block = vec![0.0; count * count];
            pair.block(offset, &mut block);
            for (k, (found, expected)) in block.iter().zip(&expected).enumerate() {
                assert!(
                    (found - expected).abs() < 1e-12,
                    "entry {k} at {offset:?}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn action_equals_reaction() {
        let degree = 5;
        let count = mode_count(degree);
        let pair = PairCoupling::new(degree, 4.0);
        let (mut there, mut back) = (vec![0.0; count * count], vec![0.0; count * count]);
        pair.block([2.2, -1.9], &mut there);
        pair.block([-2.2, 1.9], &mut back);
        for i in 0..count {
            for j in 0..count {
                let difference = there[i * count + j] - back[j * count + i];
                assert!(difference.abs() < 1e-15);
            }
        }
    }

    #[test]
    fn touching_pillars_are_the_limit_of_close_ones() {
        let series = Series::new((0, 0), (0, 0), 0);
        let (close, touching) = (series.value(2.0 + 1e-6), series.value(2.0));
        assert!((close / touching - 1.0).abs() < 1e-5, "{close} {touching}");
    }
}
