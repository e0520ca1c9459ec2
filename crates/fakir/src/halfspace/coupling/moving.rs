//! The coupling of two discs with its derivatives, for variable positions and radii.
//!
//! The series are those of [`pair`](super::pair). The derivatives of Appell's function are functions of the same kind:
//! `dF4/dx = (A B/c) F4(A + 1, B + 1; c + 1, c')` (NIST Digital Library of Mathematical Functions, 16.14). The coefficients of the
//! recurrences depend on the modes alone and are stored, so that all series of a pair are summed together. On layers a smooth
//! [correction](crate::halfspace::layer::discs) is added, which also acts between a disc and itself.

use super::pair::{Angles, Entry, SERIES_TOLERANCE, Series, step};
use crate::halfspace::disc::basis::{Mode, modes};
use crate::halfspace::layer::discs::LayeredDiscs;
use crate::halfspace::layer::force::AroundForce;
use crate::numerics::vector::widest;
use std::sync::Arc;

/// Number of terms between convergence checks.
const LOOK: usize = 3;

/// `A`, `B`, `p` and `q` of the function of a series, and of its two derivatives.
fn parameters(series: &Series, derivative: usize) -> [f64; 4] {
    let [a, b, p, q] = series.parameters();
    match derivative {
        0 => [a, b, p, q],
        1 => [a + 1.0, b + 1.0, p + 1.0, q],
        _ => [a + 1.0, b + 1.0, p, q + 1.0],
    }
}

/// Blocks between two discs, by rows: a row is a mode of the receiver.
#[derive(Debug, Clone)]
pub(crate) struct PairBlock {
    /// The load coefficients of the receiver per moment of the source.
    pub(crate) value: Vec<f64>,
    /// Derivatives with respect to the position of the receiver along x and y (those with respect to the position of the source are the
    /// opposite), to the radius of the receiver, and to that of the source.
    pub(crate) slopes: [Vec<f64>; 4],
    /// Current terms of the series, preceding terms, and sums.
    work: [Vec<f64>; 3],
    /// Every series with its derivatives by `a d/da`, `a' d/da'` and `delta d/d(delta)`.
    radial: Vec<[f64; 4]>,
}

/// The modes of two discs of arbitrary radii up to a degree.
#[derive(Debug, Clone)]
pub(crate) struct MovingPair {
    degree: usize,
    modes: Vec<Mode>,
    series: Vec<Series>,
    entries: Vec<Entry>,
    /// For every term, the factors of `x + y`, `y - x` and `(y - x)^2` in its recurrence: of all series, then of all their first
    /// derivatives, then of the second derivatives.
    terms: Vec<Vec<[f64; 3]>>,
    /// Correction for layers; `None` on half-spaces.
    layers: Option<LayeredDiscs>,
}

impl MovingPair {
    pub(crate) fn new(degree: usize) -> Self {
        let modes = modes(degree);
        let mut series: Vec<Series> = Vec::new();
        let mut entries = Vec::with_capacity(modes.len() * modes.len());
        for &receiver in &modes {
            for &source in &modes {
                let (m, n) = (receiver.order, source.order);
                let numbers = [m.abs_diff(n), m + n].map(|azimuthal| {
                    let key = [receiver, source].map(|mode| (mode.degree, mode.order));
                    let target = Series::new(key[0], key[1], azimuthal);
                    series
                        .iter()
                        .position(|known| *known == target)
                        .unwrap_or_else(|| {
                            series.push(target);
                            series.len() - 1
                        })
                });
                entries.push(Entry::new(receiver, source, numbers));
            }
        }
        Self {
            degree,
            modes,
            series,
            entries,
            terms: Vec::new(),
            layers: None,
        }
    }

    /// The same on layers, with the correction around a force on them.
    pub(crate) fn on_layers(self, around: Option<&Arc<AroundForce>>) -> Self {
        let layers = around.map(|around| LayeredDiscs::new(Arc::clone(around), self.degree));
        Self { layers, ..self }
    }

    pub(crate) fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// Prepares coefficients for pairs whose radii add up to at most the fraction `reach` of their distance, below 1.
    pub(crate) fn prepare(&mut self, reach: f64) {
        let decay = 2.0 * reach.clamp(0.05, 0.999).ln();
        // The terms are a power of their index, up to the degree, times a geometric sequence.
        let enough = (SERIES_TOLERANCE.ln() / decay).ceil() as usize;
        let enough = enough + enough / 8 + 4 * self.degree + 12;
        for number in self.terms.len()..enough {
            let s = (number + 1) as f64;
            let mut row = Vec::with_capacity(3 * self.series.len());
            for derivative in 0..3 {
                row.extend(
                    self.series
                        .iter()
                        .map(|series| step(parameters(series, derivative), s)),
                );
            }
            self.terms.push(row);
        }
    }

    /// Allocates the blocks of a pair.
    pub(crate) fn workspace(&self) -> PairBlock {
        let size = self.modes.len() * self.modes.len();
        let work = || vec![0.0; 3 * self.series.len()];
        PairBlock {
            value: vec![0.0; size],
            slopes: std::array::from_fn(|_| vec![0.0; size]),
            work: [work(), work(), work()],
            radial: vec![[0.0; 4]; self.series.len()],
        }
    }

    /// Computes the block for receiver minus source, and the radii of receiver and source, which must not overlap. Must be
    /// [prepared](Self::prepare) for them.
    pub(crate) fn fill(
        &self,
        [x, y]: [f64; 2],
        [receiver, source]: [f64; 2],
        block: &mut PairBlock,
    ) {
        let distance = x.hypot(y);
        let [cos, sin] = [x / distance, y / distance];
        let angles = Angles::new([cos, sin], self.degree);
        self.sum([receiver / distance, source / distance], distance, block);
        for (place, entry) in self.entries.iter().enumerate() {
            let [minus, plus] = entry.series.map(|number| block.radial[number]);
            let (m, n) = (entry.receiver.order, entry.source.order);
            let difference = angles.of(n as isize - m as isize);
            let sum = angles.of((n + m) as isize);
            let k = n as f64 - m as f64;
            let total = (n + m) as f64;
            // The angular parts and their derivatives.
            let ([a, b], [da, db]) = match (entry.receiver.sine, entry.source.sine) {
                (false, false) => (
                    [difference[0], sum[0]],
                    [-k * difference[1], -total * sum[1]],
                ),
                (true, true) => (
                    [difference[0], -sum[0]],
                    [-k * difference[1], total * sum[1]],
                ),
                (false, true) => ([difference[1], sum[1]], [k * difference[0], total * sum[0]]),
                (true, false) => (
                    [-difference[1], sum[1]],
                    [-k * difference[0], total * sum[0]],
                ),
            };
            let jet: [f64; 4] =
                std::array::from_fn(|part| entry.weight * (minus[part] * a + plus[part] * b));
            let turned = entry.weight * (minus[0] * da + plus[0] * db) / distance;
            let outwards = jet[3] / distance;
            block.value[place] = jet[0];
            block.slopes[0][place] = cos * outwards - sin * turned;
            block.slopes[1][place] = sin * outwards + cos * turned;
            block.slopes[2][place] = jet[1] / receiver;
            block.slopes[3][place] = jet[2] / source;
        }
        if let Some(layers) = &self.layers {
            let radii = [receiver, source];
            layers.add([x, y], radii, &mut block.value, &mut block.slopes);
        }
    }

    /// Computes the effect of a disc on itself due to layers: the block, and its derivative with respect to the radius in the third of the
    /// slopes. Returns whether there are layers.
    pub(crate) fn fill_own(&self, radius: f64, block: &mut PairBlock) -> bool {
        let Some(layers) = &self.layers else {
            return false;
        };
        block.value.fill(0.0);
        block.slopes.iter_mut().for_each(|slope| slope.fill(0.0));
        layers.add([0.0; 2], [radius; 2], &mut block.value, &mut block.slopes);
        let [.., of_receiver, of_source] = &mut block.slopes;
        for (own, other) in of_receiver.iter_mut().zip(of_source) {
            *own += *other;
        }
        true
    }

    /// Sums the series and their derivatives, for radii divided by the distance.
    fn sum(&self, [alpha, beta]: [f64; 2], distance: f64, block: &mut PairBlock) {
        let (x, y) = (alpha * alpha, beta * beta);
        let (along, across) = (x + y, y - x);
        let square = across * across;
        let [terms, before, sums] = &mut block.work;
        terms.fill(1.0);
        before.fill(0.0);
        sums.fill(1.0);
        for rows in self.terms.chunks(LOOK) {
            widest(
                #[inline(always)]
                || {
                    for row in rows {
                        let places = terms.iter_mut().zip(before.iter_mut());
                        for ((factors, (term, before)), sum) in
                            row.iter().zip(places).zip(sums.iter_mut())
                        {
                            let next = (factors[0] * along + factors[1] * across) * *term
                                - factors[2] * square * *before;
                            *before = *term;
                            *term = next;
                            *sum += next;
                        }
                    }
                },
            );
            let mut pairs = terms.iter().zip(sums.iter());
            if pairs.all(|(term, sum)| *term < SERIES_TOLERANCE * sum) {
                break;
            }
        }
        let count = self.series.len();
        for (number, series) in self.series.iter().enumerate() {
            let [l, k] = series.degrees;
            let factor = series.factor * alpha.powi(l) * beta.powi(k) / distance;
            let [a, b] = series.upper;
            let [l, k] = [l, k].map(f64::from);
            let value = factor * sums[number];
            let of_first = factor * a * b / (l + 1.5) * sums[count + number];
            let of_second = factor * a * b / (k + 1.5) * sums[2 * count + number];
            let receiver = l * value + 2.0 * x * of_first;
            let source = k * value + 2.0 * y * of_second;
            block.radial[number] = [value, receiver, source, -value - receiver - source];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::coupling::pair::PairCoupling;

    /// Compares with the static blocks of `pair`, which are checked by quadrature.
    #[test]
    fn the_blocks_of_discs_at_rest() {
        for (degree, offset, radii) in [
            (2, [1.3, 0.0], [1.0, 0.28]),
            (3, [-2.0, 3.1], [0.4, 1.1]),
            (6, [0.7, -2.4], [1.1, 1.1]),
            (4, [0.9, 0.1], [0.01, 0.7]),
        ] {
            let mut moving = MovingPair::new(degree);
            moving.prepare((radii[0] + radii[1]) / f64::hypot(offset[0], offset[1]));
            let mut found = moving.workspace();
            moving.fill(offset, radii, &mut found);
            let mut expected = vec![0.0; found.value.len()];
            PairCoupling::new(degree).block_of(offset, radii, &mut expected);
            for (found, expected) in found.value.iter().zip(&expected) {
                assert!(
                    (found - expected).abs() < 1e-14 * expected.abs().max(1.0),
                    "{degree}: {found} {expected}"
                );
            }
        }
    }

    /// Compares with the static blocks of `pair` on a film, which are integrals over wave numbers, also between a disc and itself.
    #[test]
    fn blocks_on_layers() {
        let film = crate::halfspace::layer::tests::film();
        let around = crate::halfspace::layer::discs::around_force(&[film]);
        for (degree, offset) in [(2, [2.6, 0.9]), (4, [-7.0, 3.1])] {
            let mut moving = MovingPair::new(degree).on_layers(around.as_ref());
            moving.prepare(0.8);
            let mut found = moving.workspace();
            moving.fill(offset, [1.0; 2], &mut found);
            let still = PairCoupling::new(degree).with_layers(&[film]);
            let mut expected = vec![0.0; found.value.len()];
            still.block_of(offset, [1.0; 2], &mut expected);
            let agree = |found: &[f64], expected: &[f64]| {
                for (found, expected) in found.iter().zip(expected) {
                    let off = (found - expected).abs();
                    assert!(off < 1e-9, "{degree}: {found} {expected}");
                }
            };
            agree(&found.value, &expected);
            assert!(moving.fill_own(1.0, &mut found));
            agree(&found.value, &still.own_block(1.0).unwrap());
            let by_radius = found.slopes[2].clone();
            let at = |radius: f64| {
                let mut block = moving.workspace();
                moving.fill_own(radius, &mut block);
                block.value
            };
            let step = 1e-4;
            let (above, below) = (at(1.0 + step), at(1.0 - step));
            for (place, slope) in by_radius.iter().enumerate() {
                let expected = (above[place] - below[place]) / (2.0 * step);
                assert!((slope - expected).abs() < 1e-7, "{slope} {expected}");
            }
        }
    }

    #[test]
    fn slopes_are_those_of_central_differences() {
        let film = crate::halfspace::layer::tests::film();
        let around = crate::halfspace::layer::discs::around_force(&[film]);
        for (degree, offset, radii, around) in [
            (2, [1.9, 0.6], [1.0, 0.7], None),
            (5, [-1.6, 1.4], [0.5, 1.1], None),
            (2, [1.9, 0.6], [1.0, 0.7], around.as_ref()),
        ] {
            let mut moving = MovingPair::new(degree).on_layers(around);
            moving.prepare(0.95);
            let mut block = moving.workspace();
            moving.fill(offset, radii, &mut block);
            let step = 1e-5;
            for slope in 0..4 {
                let at = |step: f64| {
                    let (mut offset, mut radii) = (offset, radii);
                    match slope {
                        0 | 1 => offset[slope] += step,
                        k => radii[k - 2] += step,
                    }
                    let mut block = moving.workspace();
                    moving.fill(offset, radii, &mut block);
                    block.value
                };
                let (above, below) = (at(step), at(-step));
                for (place, slope) in block.slopes[slope].iter().enumerate() {
                    let expected = (above[place] - below[place]) / (2.0 * step);
                    assert!(
                        (slope - expected).abs() < 2e-8,
                        "entry {place}: {slope} {expected}"
                    );
                }
            }
        }
    }
}
