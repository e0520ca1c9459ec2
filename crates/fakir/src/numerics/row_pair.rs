//! Transforms two real rows together: one is the real part of a complex row, the other its imaginary part.
//!
//! If the transforms of the rows are `A` and `B`, that of the complex row is `Z = A + i B`. Since `A_(N-k) = conj(A_k)` for real rows,
//! `2 A_k = Z_k + conj(Z_(N-k))` and `2 i B_k = Z_k - conj(Z_(N-k))`. This takes less than half the time of separate transforms of real
//! rows.

use super::column_transform::COLUMNS;
use super::fft::Real;
use super::vector::widest;
use fakir_fft::Fft;
use num_complex::Complex;
use std::array::from_fn;

/// Index of the last column of a line.
const LAST: usize = COLUMNS - 1;

pub(crate) struct RowPair<R> {
    values: Vec<Complex<R>>,
    /// Real and imaginary parts of the transform. They are preceded by space for a line and followed by a copy of the first number and
    /// space for another line, since there may be fewer frequencies than columns in a line.
    parts: [Vec<R>; 2],
}

impl<R: Real> RowPair<R> {
    /// Allocates two rows of this length.
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

    /// Transforms both rows.
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

    /// Indices of a frequency and of its negative in `parts`.
    #[inline(always)]
    fn places(&self, frequency: usize) -> [usize; 2] {
        [COLUMNS + frequency, COLUMNS + self.values.len() - frequency]
    }

    /// Twice the transforms of both rows at the frequencies from `first` on.
    pub(crate) fn twice_spectra(&self, first: usize, [one, other]: [&mut [Complex<R>]; 2]) {
        let [re, im] = &self.parts;
        for ((one, other), frequency) in one.iter_mut().zip(other).zip(first..) {
            let [own, image] = self.places(frequency);
            *one = Complex::new(re[own] + re[image], im[own] - im[image]);
            *other = Complex::new(im[own] + im[image], re[image] - re[own]);
        }
    }

    /// Twice the transforms of both rows at the frequencies of a line, from `first` on, line by line: real parts, then imaginary parts.
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

    /// Sets the transforms of both rows at the frequencies of a line, up to half the length.
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
            // Frequencies above half the length are mirror images of those below.
            self.put_ends(first, four, left.min(COLUMNS));
        }
    }

    /// Sets the first line or the last one, which has the given number of columns.
    #[cold]
    fn put_ends(&mut self, first: usize, mut four: [[R; COLUMNS]; 4], columns: usize) {
        // The first and, for even lengths, the last coefficient of the transform of real data are real; removes their rounding errors.
        let is_end = |k: &usize| (2 * (first + k)).is_multiple_of(self.values.len());
        for k in (0..columns).filter(is_end) {
            (four[1][k], four[3][k]) = Default::default();
        }
        self.put(first, four, columns);
    }

    /// Writes the first columns of both lines, each consisting of real and imaginary parts, and their mirror images in reverse order.
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

    /// Inverse transform of both rows, without normalisation.
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

    /// Compares with the defining sums for even and odd lengths, including some shorter than a line; compares lines with these; and checks
    /// the round trip.
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
                        // Imaginary parts at the ends are ignored.
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
