//! Two rows of real numbers, transformed together: one is the real part of complex numbers, the other the imaginary one.
//!
//! Of rows with the transforms `A` and `B` the transform together is `Z = A + i B`, and as those of real numbers are `A_(N-k) = conj(A_k)`,
//! `2 A_k = Z_k + conj(Z_(N-k))` and `2 i B_k = Z_k - conj(Z_(N-k))`. That takes less than half the time of transforms that are real by themselves.

use super::fft::Real;
use num_complex::Complex;
use rustfft::Fft;

pub(crate) struct RowPair<R> {
    /// The numbers, and in the end the first of their transform once more.
    values: Vec<Complex<R>>,
}

impl<R: Real> RowPair<R> {
    /// Of so many numbers each.
    pub(crate) fn new(length: usize) -> Self {
        Self {
            values: vec![Complex::default(); length + 1],
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

    /// Transforms them.
    pub(crate) fn forward(&mut self, plan: &dyn Fft<R>, scratch: &mut [Complex<R>]) {
        plan.process_with_scratch(self.rows(), scratch);
        let length = self.length();
        self.values[length] = self.values[0];
    }

    /// Twice the transforms of both rows at the frequencies from one on.
    #[inline(always)]
    pub(crate) fn twice_spectra(&self, first: usize, [one, other]: [&mut [Complex<R>]; 2]) {
        let count = one.len();
        let ahead = &self.values[first..][..count];
        let behind = &self.values[self.values.len() - first - count..][..count];
        for k in 0..count {
            let (a, b) = (ahead[k], behind[count - 1 - k]);
            one[k] = Complex::new(a.re + b.re, a.im - b.im);
            other[k] = Complex::new(a.im + b.im, b.re - a.re);
        }
    }

    /// Sets the transforms of both rows at the frequencies from one on, up to half the length.
    #[inline(always)]
    pub(crate) fn set_spectra(&mut self, first: usize, [one, other]: [&[Complex<R>]; 2]) {
        let length = self.length();
        let half = length / 2 + 1;
        let (low, high) = self.values.split_at_mut(half);
        let count = one.len().min(half - first);
        let (one, other) = (&one[..count], &other[..count]);
        let ahead = &mut low[first..][..count];
        for k in 0..count {
            let (a, b) = (one[k], other[k]);
            ahead[k] = Complex::new(a.re - b.im, a.im + b.re);
        }
        // Transforms of real numbers are real at their ends; rounding must not say otherwise.
        for end in [0, length / 2] {
            if let Some(k) = end.checked_sub(first)
                && k < count
                && (end == 0 || length.is_multiple_of(2))
            {
                ahead[k] = Complex::new(one[k].re, other[k].re);
            }
        }
        // That in the middle of an even length is its own image.
        let images = count.min((length + 1 - half).saturating_sub(first));
        let behind = &mut high[length + 1 - half - first - images..][..images];
        for k in 0..images {
            let (a, b) = (one[k], other[k]);
            behind[images - 1 - k] = Complex::new(a.re + b.im, b.re - a.im);
        }
    }

    /// Transforms them back, without normalisation.
    pub(crate) fn back(&mut self, plan: &dyn Fft<R>, scratch: &mut [Complex<R>]) {
        plan.process_with_scratch(self.rows(), scratch);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rustfft::FftPlanner;

    /// Against the sums that define them, of even lengths and an odd one, some frequencies at a time; and there and back.
    #[test]
    fn both_rows_have_their_own_transforms() {
        for length in [12, 15, 16, 18] {
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
            let mut back = RowPair::new(length);
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
                // What is imaginary at the ends does not count.
                for (k, frequency) in (first..half).take(3).enumerate() {
                    if 2 * frequency % length == 0 {
                        spectra.iter_mut().for_each(|row| row[k].im = 7.0);
                    }
                }
                back.set_spectra(first, [&spectra[0], &spectra[1]]);
            }
            back.back(plan_back.as_ref(), &mut scratch);
            for (k, value) in back.rows().iter().enumerate() {
                let expected = Complex::new(row(0.0, k), row(1.0, k)) * (2 * length) as f64;
                assert!((*value - expected).norm() < 1e-12 * length as f64);
            }
        }
    }
}
