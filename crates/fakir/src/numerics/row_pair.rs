//! Two rows of real numbers, transformed together: one is the real part of complex numbers, the other the imaginary one.
//!
//! Of rows with the transforms `A` and `B` the transform together is `Z = A + i B`, and as those of real numbers are `A_(N-k) = conj(A_k)`,
//! `2 A_k = Z_k + conj(Z_(N-k))` and `2 i B_k = Z_k - conj(Z_(N-k))`. That takes less than half the time of transforms that are real by themselves.

use super::column_transform::COLUMNS;
use super::fft::Real;
use super::vector::widest;
use num_complex::Complex;
use rustfft::Fft;

pub(crate) struct RowPair<R> {
    /// The numbers, and in the end the first of their transform once more.
    values: Vec<Complex<R>>,
    /// Their real parts, and their imaginary ones.
    apart: [Vec<R>; 2],
    /// Real and imaginary parts of the transform of one row, then of the other, at half of the frequencies.
    spectra: [Vec<R>; 4],
}

impl<R: Real> RowPair<R> {
    /// Of so many numbers each.
    pub(crate) fn new(length: usize) -> Self {
        let frequencies = (length / 2 + 1).next_multiple_of(COLUMNS);
        Self {
            values: vec![Complex::default(); length + 1],
            apart: [(); 2].map(|()| vec![R::default(); length + 1]),
            spectra: [(); 4].map(|()| vec![R::default(); frequencies]),
        }
    }

    fn length(&self) -> usize {
        self.values.len() - 1
    }

    /// Both rows, as real and imaginary parts.
    #[inline(always)]
    pub(crate) fn rows(&mut self) -> &mut [Complex<R>] {
        let length = self.length();
        &mut self.values[..length]
    }

    /// Transforms them, and tells their transforms apart.
    pub(crate) fn forward(&mut self, plan: &dyn Fft<R>, scratch: &mut [Complex<R>]) {
        plan.process_with_scratch(self.rows(), scratch);
        let length = self.length();
        self.values[length] = self.values[0];
        widest(
            #[inline(always)]
            || self.separate(),
        );
    }

    #[inline(always)]
    fn separate(&mut self) {
        let [re, im] = &mut self.apart;
        for ((re, im), value) in re.iter_mut().zip(im.iter_mut()).zip(&self.values) {
            (*re, *im) = (value.re, value.im);
        }
        let [one, one_im, other, other_im] = &mut self.spectra;
        let numbers = re.iter().zip(re.iter().rev());
        for ((one, other_im), (a, b)) in one.iter_mut().zip(other_im).zip(numbers) {
            (*one, *other_im) = (*a + *b, *b - *a);
        }
        let numbers = im.iter().zip(im.iter().rev());
        for ((one_im, other), (a, b)) in one_im.iter_mut().zip(other).zip(numbers) {
            (*one_im, *other) = (*a - *b, *a + *b);
        }
    }

    /// Twice the transforms of both rows at the frequencies from one on.
    #[inline(always)]
    pub(crate) fn twice_spectra(&self, first: usize, spectra: [&mut [Complex<R>]; 2]) {
        for (spectrum, [re, im]) in spectra.into_iter().zip(self.spectra.as_chunks().0) {
            let parts = re[first..].iter().zip(&im[first..]);
            for (value, (re, im)) in spectrum.iter_mut().zip(parts) {
                *value = Complex::new(*re, *im);
            }
        }
    }

    /// Twice the transforms of both rows at as many frequencies as a line has columns, from one on, line after line: real parts, then imaginary ones.
    #[inline(always)]
    pub(crate) fn twice_lines(&self, first: usize, lines: &mut [R]) {
        for (target, part) in lines.chunks_exact_mut(COLUMNS).zip(&self.spectra) {
            target.copy_from_slice(&part[first..][..COLUMNS]);
        }
    }

    /// Sets the transforms of both rows at as many frequencies, up to half the length.
    #[inline(always)]
    pub(crate) fn set_lines(&mut self, first: usize, lines: &[R]) {
        for (source, part) in lines.chunks_exact(COLUMNS).zip(&mut self.spectra) {
            part[first..][..COLUMNS].copy_from_slice(source);
        }
    }

    /// Makes one transform of both.
    #[inline(always)]
    fn join(&mut self) {
        let length = self.length();
        let [one, one_im, other, other_im] = &mut self.spectra;
        // Transforms of real numbers are real at their ends; rounding must not say otherwise.
        for im in [&mut *one_im, &mut *other_im] {
            im[0] = R::default();
            if length.is_multiple_of(2) {
                im[length / 2] = R::default();
            }
        }
        let [re, im] = &mut self.apart;
        let half = length / 2 + 1;
        // The images first, from the end: that in the middle of an even length is its own.
        let images = length + 1 - half..length + 1;
        let parts = one.iter().zip(other_im.iter());
        for (re, (one, other_im)) in re[images.clone()].iter_mut().rev().zip(parts) {
            *re = *one + *other_im;
        }
        let parts = one_im.iter().zip(other.iter());
        for (im, (one_im, other)) in im[images].iter_mut().rev().zip(parts) {
            *im = *other - *one_im;
        }
        for (re, (one, other_im)) in re[..half].iter_mut().zip(one.iter().zip(other_im)) {
            *re = *one - *other_im;
        }
        for (im, (one_im, other)) in im[..half].iter_mut().zip(one_im.iter().zip(other)) {
            *im = *one_im + *other;
        }
        for ((re, im), value) in re.iter().zip(im).zip(&mut self.values) {
            *value = Complex::new(*re, *im);
        }
    }

    /// Transforms them back, without normalisation.
    pub(crate) fn back(&mut self, plan: &dyn Fft<R>, scratch: &mut [Complex<R>]) {
        widest(
            #[inline(always)]
            || self.join(),
        );
        plan.process_with_scratch(self.rows(), scratch);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::column_transform::LINE;
    use rustfft::FftPlanner;

    /// Against the sums that define them, of even lengths and an odd one, some frequencies at a time; lines against these; and there and back.
    #[test]
    fn both_rows_have_their_own_transforms() {
        for length in [12, 15, 16, 18, 40] {
            let mut planner = FftPlanner::<f64>::new();
            let (plan, plan_back) = (
                planner.plan_fft_forward(length),
                planner.plan_fft_inverse(length),
            );
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
