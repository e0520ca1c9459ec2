//! Two rows of real numbers, transformed together: one is the real part of complex numbers, the other the imaginary one.
//!
//! Of rows with the transforms `A` and `B` the transform together is `Z = A + i B`, and as those of real numbers are `A_(N-k) = conj(A_k)`,
//! `2 A_k = Z_k + conj(Z_(N-k))` and `2 i B_k = Z_k - conj(Z_(N-k))`. That takes less than half the time of transforms that are real by themselves.

use super::column_transform::COLUMNS;
use super::fft::Real;
use super::vector::widest;
use fakir_fft::Fft;
use num_complex::Complex;
use std::array::from_fn;

/// The last column of a line.
const LAST: usize = COLUMNS - 1;

pub(crate) struct RowPair<R> {
    values: Vec<Complex<R>>,
    /// Real parts of their transform, and imaginary ones. Before them is room for a line, behind them is the first once more and room for another
    /// line, as there may be fewer frequencies than a line has columns.
    parts: [Vec<R>; 2],
}

impl<R: Real> RowPair<R> {
    /// Of so many numbers each.
    pub(crate) fn new(length: usize) -> Self {
        Self {
            values: vec![Complex::default(); length],
            parts: [(); 2].map(|()| vec![R::default(); length + 1 + 2 * COLUMNS]),
        }
    }

    /// Both rows, as real and imaginary parts.
    pub(crate) fn rows(&mut self) -> &mut [Complex<R>] {
        &mut self.values
    }

    /// Transforms them.
    pub(crate) fn forward(&mut self, plan: &dyn Fft<R>, scratch: &mut [Complex<R>]) {
        plan.process_with_scratch(&mut self.values, scratch);
        let (values, [re, im]) = (&self.values, &mut self.parts);
        widest(
            #[inline(always)]
            || {
                let parts = re[COLUMNS..].iter_mut().zip(&mut im[COLUMNS..]);
                for ((re, im), value) in parts.zip(values) {
                    (*re, *im) = (value.re, value.im);
                }
            },
        );
        for part in &mut self.parts {
            part[COLUMNS + self.values.len()] = part[COLUMNS];
        }
    }

    /// Where a frequency is among the parts, and where minus that is.
    #[inline(always)]
    fn places(&self, frequency: usize) -> [usize; 2] {
        [COLUMNS + frequency, COLUMNS + self.values.len() - frequency]
    }

    /// Twice the transforms of both rows at the frequencies from one on.
    pub(crate) fn twice_spectra(&self, first: usize, [one, other]: [&mut [Complex<R>]; 2]) {
        let [re, im] = &self.parts;
        for ((one, other), frequency) in one.iter_mut().zip(other).zip(first..) {
            let [own, image] = self.places(frequency);
            *one = Complex::new(re[own] + re[image], im[own] - im[image]);
            *other = Complex::new(im[own] + im[image], re[image] - re[own]);
        }
    }

    /// Twice the transforms of both rows at as many frequencies as a line has columns, from one on, line after line: real parts, then imaginary ones.
    #[inline(always)]
    pub(crate) fn twice_lines(&self, first: usize, lines: &mut [R]) {
        let [own, image] = self.places(first);
        let [re, im] = self.parts.each_ref();
        let (re, image_re) = (&re[own..][..COLUMNS], &re[image - LAST..][..COLUMNS]);
        let (im, image_im) = (&im[own..][..COLUMNS], &im[image - LAST..][..COLUMNS]);
        let lines = &mut lines[..4 * COLUMNS];
        for k in 0..COLUMNS {
            lines[k] = re[k] + image_re[LAST - k];
            lines[COLUMNS + k] = im[k] - image_im[LAST - k];
            lines[2 * COLUMNS + k] = im[k] + image_im[LAST - k];
            lines[3 * COLUMNS + k] = image_re[LAST - k] - re[k];
        }
    }

    /// Sets the transforms of both rows at as many frequencies, up to half the length.
    #[inline(always)]
    pub(crate) fn set_lines(&mut self, first: usize, lines: &[R]) {
        let mut four = [[R::default(); COLUMNS]; 4];
        for (line, values) in four.iter_mut().zip(lines.as_chunks().0) {
            *line = *values;
        }
        let left = self.values.len() / 2 + 1 - first;
        if first > 0 && left > COLUMNS {
            self.put(first, four, COLUMNS);
        } else {
            // Beyond half the length there are the images of what is before it.
            self.put_ends(first, four, left.min(COLUMNS));
        }
    }

    /// The same of the first line and of the last, of which there are so many columns.
    #[cold]
    fn put_ends(&mut self, first: usize, mut four: [[R; COLUMNS]; 4], columns: usize) {
        // Transforms of real numbers are real at their ends; rounding must not say otherwise.
        let is_end = |k: &usize| (2 * (first + k)).is_multiple_of(self.values.len());
        for k in (0..columns).filter(is_end) {
            (four[1][k], four[3][k]) = Default::default();
        }
        self.put(first, four, columns);
    }

    /// Puts the first few columns of both lines, each real parts and imaginary ones, to their places, and what they say of their images, which are turned around.
    #[inline(always)]
    fn put(
        &mut self,
        first: usize,
        [one, one_im, other, other_im]: [[R; COLUMNS]; 4],
        columns: usize,
    ) {
        let [own, image] = self.places(first);
        let values: [[R; COLUMNS]; 2] = [
            from_fn(|k| one[k] - other_im[k]),
            from_fn(|k| one_im[k] + other[k]),
        ];
        let mut images: [[R; COLUMNS]; 2] = [
            from_fn(|k| one[k] + other_im[k]),
            from_fn(|k| other[k] - one_im[k]),
        ];
        for (part, (values, images)) in self.parts.iter_mut().zip(values.iter().zip(&mut images)) {
            images.reverse();
            part[own..][..columns].copy_from_slice(&values[..columns]);
            part[image + 1 - columns..=image].copy_from_slice(&images[COLUMNS - columns..]);
        }
    }

    /// Transforms them back, without normalisation.
    pub(crate) fn back(&mut self, plan: &dyn Fft<R>, scratch: &mut [Complex<R>]) {
        let (values, [re, im]) = (&mut self.values, &self.parts);
        widest(
            #[inline(always)]
            || {
                let parts = re[COLUMNS..].iter().zip(&im[COLUMNS..]);
                for (value, (re, im)) in values.iter_mut().zip(parts) {
                    *value = Complex::new(*re, *im);
                }
            },
        );
        plan.process_with_scratch(&mut self.values, scratch);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::column_transform::LINE;
    use fakir_fft::Transformable;

    /// Against the sums that define them, of even lengths and odd ones, some shorter than a line, some frequencies at a time; lines against these; and there and back.
    #[test]
    fn both_rows_have_their_own_transforms() {
        for length in [1, 2, 5, 12, 15, 16, 18, 40] {
            let (plan, plan_back) = (f64::forward(length), f64::inverse(length));
            let mut scratch = vec![Complex::default(); 2 * length];
            let row = |which: f64, k: usize| (1.3 + which) * ((2.0 + which) * k as f64).sin();
            let mut pair = RowPair::new(length);
            for (k, value) in pair.rows().iter_mut().enumerate() {
                *value = Complex::new(row(0.0, k), row(1.0, k));
            }
            pair.forward(plan.as_ref(), &mut scratch);
            let half = length / 2 + 1;
            for first in (0..half).step_by(3) {
                let mut spectra = [[Complex::default(); 3]; 2];
                let [one, other] = &mut spectra;
                pair.twice_spectra(first, [one, other]);
                for (which, spectrum) in [0.0, 1.0].into_iter().zip(&spectra) {
                    for (frequency, found) in (first..half).zip(spectrum) {
                        let sum: Complex<f64> = (0..length)
                            .map(|k| {
                                let turn = -std::f64::consts::TAU * (frequency * k) as f64;
                                row(which, k) * Complex::cis(turn / length as f64)
                            })
                            .sum();
                        assert!((*found - 2.0 * sum).norm() < 1e-13 * length as f64);
                    }
                }
            }
            let mut back = RowPair::new(length);
            for first in (0..half).step_by(COLUMNS) {
                let mut spectra = [[Complex::default(); COLUMNS]; 2];
                let [one, other] = &mut spectra;
                pair.twice_spectra(first, [one, other]);
                let mut lines = [0.0; 2 * LINE];
                pair.twice_lines(first, &mut lines);
                for (line, spectrum) in lines.chunks_exact_mut(LINE).zip(&spectra) {
                    let (re, im) = line.split_at_mut(COLUMNS);
                    for (frequency, k) in (first..half).zip(0..COLUMNS) {
                        assert_eq!(Complex::new(re[k], im[k]), spectrum[k]);
                        // What is imaginary at the ends does not count.
                        if 2 * frequency % length == 0 {
                            im[k] = 7.0;
                        }
                    }
                }
                back.set_lines(first, &lines);
            }
            back.back(plan_back.as_ref(), &mut scratch);
            for (k, value) in back.rows().iter().enumerate() {
                let expected = Complex::new(row(0.0, k), row(1.0, k)) * (2 * length) as f64;
                assert!((*value - expected).norm() < 1e-12 * length as f64);
            }
        }
    }
}
