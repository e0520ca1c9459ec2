//! Plans of fast Fourier transforms for `f32` and `f64`.
//!
//! `rustfft` and `realfft` are generic: a crate that makes a plan compiles all of their algorithms, in every width of
//! vector, which takes longer than the contact solvers themselves. This crate makes the plans and returns them as trait
//! objects, so that these algorithms are compiled once, in parallel with the rest, and not again whenever a solver changes.

pub use realfft::{ComplexToReal, RealToComplex};
pub use rustfft::{Fft, FftNum};

use realfft::RealFftPlanner;
use rustfft::FftPlanner;
use std::sync::Arc;

/// A number type whose transforms are compiled here.
pub trait Transformable: FftNum {
    /// The transform of `length` complex numbers, `X[k] = sum_j x[j] exp(-2 pi i j k / length)`.
    fn forward(length: usize) -> Arc<dyn Fft<Self>>;

    /// Its inverse times `length`: the opposite sign in the exponent, not normalised.
    fn inverse(length: usize) -> Arc<dyn Fft<Self>>;

    /// The transform of `length` real numbers to their first `length / 2 + 1` frequencies.
    fn real_forward(length: usize) -> Arc<dyn RealToComplex<Self>>;

    /// Its inverse times `length`.
    fn real_inverse(length: usize) -> Arc<dyn ComplexToReal<Self>>;
}

macro_rules! transformable {
    ($number:ty) => {
        impl Transformable for $number {
            fn forward(length: usize) -> Arc<dyn Fft<Self>> {
                FftPlanner::new().plan_fft_forward(length)
            }

            fn inverse(length: usize) -> Arc<dyn Fft<Self>> {
                FftPlanner::new().plan_fft_inverse(length)
            }

            fn real_forward(length: usize) -> Arc<dyn RealToComplex<Self>> {
                RealFftPlanner::new().plan_fft_forward(length)
            }

            fn real_inverse(length: usize) -> Arc<dyn ComplexToReal<Self>> {
                RealFftPlanner::new().plan_fft_inverse(length)
            }
        }
    };
}

transformable!(f32);
transformable!(f64);

#[cfg(test)]
mod tests {
    use super::*;
    use rustfft::num_complex::Complex;
    use std::f64::consts::TAU;

    /// The sum that defines the transform, for lengths with and without large factors.
    #[test]
    fn transforms_are_their_definition() {
        for length in [1, 2, 12, 31, 40, 97] {
            let values: Vec<Complex<f64>> = (0..length)
                .map(|j| Complex::new((1.3 * j as f64).sin(), (0.7 * j as f64).cos()))
                .collect();
            let mut spectrum = values.clone();
            f64::forward(length).process(&mut spectrum);
            for (k, found) in spectrum.iter().enumerate() {
                let expected: Complex<f64> = values
                    .iter()
                    .enumerate()
                    .map(|(j, x)| {
                        x * Complex::from_polar(1.0, -TAU * (j * k) as f64 / length as f64)
                    })
                    .sum();
                assert!((found - expected).norm() < 1e-12 * length as f64);
            }
            f64::inverse(length).process(&mut spectrum);
            for (found, expected) in spectrum.iter().zip(&values) {
                assert!((found / length as f64 - expected).norm() < 1e-13);
            }
        }
    }

    /// Real transforms are those of complex numbers without imaginary parts.
    #[test]
    fn real_transforms_are_half_of_the_complex_ones() {
        for length in [2_usize, 9, 40] {
            let values: Vec<f32> = (0..length).map(|j| (0.9 * j as f32).sin()).collect();
            let mut complex: Vec<Complex<f32>> = values.iter().map(|x| Complex::from(*x)).collect();
            f32::forward(length).process(&mut complex);
            let plan = f32::real_forward(length);
            let mut half = plan.make_output_vec();
            assert!(plan.process(&mut values.clone(), &mut half).is_ok());
            assert_eq!(half.len(), length / 2 + 1);
            for (found, expected) in half.iter().zip(&complex) {
                assert!((found - expected).norm() < 1e-5);
            }
            let plan = f32::real_inverse(length);
            let mut back = plan.make_output_vec();
            half[0].im = 0.0;
            if length % 2 == 0 {
                half[length / 2].im = 0.0;
            }
            assert!(plan.process(&mut half, &mut back).is_ok());
            for (found, expected) in back.iter().zip(&values) {
                assert!((found / length as f32 - expected).abs() < 1e-6);
            }
        }
    }
}
