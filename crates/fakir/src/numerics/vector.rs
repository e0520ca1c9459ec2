//! Loops that are compiled for the vector instructions of the processor.
//!
//! Results do not depend on the processor: sums have the same order everywhere, and products are rounded before they are added.

use super::convergence::{self, larger};
use super::workers::Workers;
use pulp::Arch;
use std::ops::{Add, AddAssign, Mul, Sub};

/// Executes `work` with the widest vector instructions available. This affects only functions that are inlined into it.
#[inline(always)]
pub(crate) fn widest<R>(work: impl FnOnce() -> R) -> R {
    Arch::new().dispatch(work)
}

/// Number of values in a [`Lanes`].
pub(crate) const LANES: usize = 4;

/// Values that are processed together.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Lanes(pub(crate) [f64; LANES]);

impl Lanes {
    #[inline(always)]
    pub(crate) fn splat(value: f64) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    pub(crate) fn map(mut self, each: impl Fn(f64) -> f64) -> Self {
        for value in &mut self.0 {
            *value = each(*value);
        }
        self
    }

    #[inline(always)]
    pub(crate) fn sum(self) -> f64 {
        let [a, b, c, d] = self.0;
        (a + b) + (c + d)
    }

    #[inline(always)]
    fn with(mut self, other: Self, each: impl Fn(f64, f64) -> f64) -> Self {
        // `array::from_fn` is not always inlined.
        for (value, other) in self.0.iter_mut().zip(other.0) {
            *value = each(*value, other);
        }
        self
    }
}

impl Add for Lanes {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
}

impl Mul<Lanes> for f64 {
    type Output = Lanes;

    #[inline(always)]
    fn mul(self, other: Lanes) -> Lanes {
        other.map(|value| self * value)
    }
}

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// Number of vector elements that are summed together.
const CHUNK: usize = 16_384;

/// Smallest number of chunks that a thread processes at a time.
const CHUNKS: usize = 4;

/// Operations on vectors that are distributed over threads if the vectors are long and threads are available. Sums are computed in chunks
/// in both cases, so that results do not depend on the number of threads.
#[derive(Clone, Copy)]
pub(crate) struct Vectors<'r>(pub(crate) Workers<'r>);

impl Vectors<'_> {
    /// Sum of products.
    pub(crate) fn dot(self, a: &[f64], b: &[f64]) -> f64 {
        let count = a.len().div_ceil(CHUNK);
        if count < 2 * CHUNKS {
            return dot(a, b);
        }
        let chunk = |(): &mut (), number: usize| {
            let elements = number * CHUNK..a.len().min((number + 1) * CHUNK);
            dot_of_chunk(&a[elements.clone()], &b[elements])
        };
        self.0.map(count, CHUNKS, || (), chunk).iter().sum()
    }

    /// `a -= b`
    pub(crate) fn subtract(self, a: &mut [f64], b: &[f64]) {
        self.each(a, b, subtract);
    }

    /// `a += factor b`
    pub(crate) fn add_scaled(self, a: &mut [f64], factor: f64, b: &[f64]) {
        self.each(a, b, |a, b| add_scaled(a, factor, b));
    }

    /// `a = factor a + b`
    pub(crate) fn scale_and_add(self, a: &mut [f64], factor: f64, b: &[f64]) {
        self.each(a, b, |a, b| {
            widest(
                #[inline(always)]
                || {
                    for (x, y) in a.iter_mut().zip(b) {
                        *x = factor * *x + y;
                    }
                },
            );
        });
    }

    fn each(self, a: &mut [f64], b: &[f64], one: impl Fn(&mut [f64], &[f64]) + Sync + Send) {
        let chunk = |(): &mut (), number: usize, a: &mut [f64]| {
            one(a, &b[number * CHUNK..][..a.len()]);
        };
        self.0.fill(a, CHUNK, CHUNKS, || (), chunk);
    }
}

/// Sum of products.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let chunks = a.chunks(CHUNK).zip(b.chunks(CHUNK));
    chunks.map(|(a, b)| dot_of_chunk(a, b)).sum()
}

/// The dot product of two chunks.
fn dot_of_chunk(a: &[f64], b: &[f64]) -> f64 {
    widest(
        #[inline(always)]
        || inner_dot(a, b),
    )
}

/// Dot product with [`LANES`] partial sums, for loops that are compiled by [`widest`].
#[inline(always)]
pub(crate) fn inner_dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = Lanes::default();
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    for (x, y) in a.iter().zip(b) {
        sums += Lanes(*x) * Lanes(*y);
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum();
    sums.sum() + rest
}

/// The largest absolute value; NaN if a value is NaN, 0 for an empty slice.
pub(crate) fn largest(a: &[f64]) -> f64 {
    widest(
        #[inline(always)]
        || {
            let (chunks, rest) = a.as_chunks::<{ 4 * LANES }>();
            let mut most = [0.0; 4 * LANES];
            for chunk in chunks {
                for (most, value) in most.iter_mut().zip(chunk) {
                    *most = larger(*most, value.abs());
                }
            }
            convergence::largest(most.iter().chain(rest).copied())
        },
    )
}

/// `a -= b`
pub(crate) fn subtract(a: &mut [f64], b: &[f64]) {
    widest(
        #[inline(always)]
        || {
            for (x, y) in a.iter_mut().zip(b) {
                *x -= y;
            }
        },
    );
}

/// `a += factor b`
pub(crate) fn add_scaled(a: &mut [f64], factor: f64, b: &[f64]) {
    widest(
        #[inline(always)]
        || {
            for (x, y) in a.iter_mut().zip(b) {
                *x += factor * y;
            }
        },
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::workers::CancelToken;

    #[test]
    fn the_largest_is_found_wherever_it_is() {
        for length in [0usize, 1, 15, 16, 17, 50] {
            let numbers: Vec<f64> = (0..length).map(|k| (k as f64).sin()).collect();
            let expected = numbers.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            assert_eq!(largest(&numbers).to_bits(), expected.to_bits());
            for place in 0..length {
                let mut numbers = numbers.clone();
                numbers[place] = -7.0;
                assert_eq!(largest(&numbers).to_bits(), 7f64.to_bits());
                numbers[place] = f64::NAN;
                assert!(largest(&numbers).is_nan(), "{length} {place}");
            }
        }
    }

    #[test]
    fn every_element_counts_once() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
        let pool = pool.unwrap();
        for length in [0, 1, 3, 4, 5, 8, 11, 2 * CHUNKS * CHUNK + 7] {
            let a: Vec<f64> = (0..length).map(|k| (k % 97) as f64 + 1.0).collect();
            let squares: f64 = a.iter().map(|x| x * x).sum();
            let sums = [None, Some(&pool)].map(|pool| {
                let workers = Workers {
                    pool,
                    cancel: &CancelToken::default(),
                };
                let vectors = Vectors(workers);
                let mut b = a.clone();
                vectors.add_scaled(&mut b, 2.0, &a);
                vectors.subtract(&mut b, &a);
                vectors.scale_and_add(&mut b, -0.5, &a);
                assert!(b.iter().all(|x| x.abs() < 1e-12), "{length}");
                vectors.dot(&a, &a)
            });
            assert!((sums[0] - squares).abs() <= 1e-12 * squares);
            assert_eq!(sums[0].to_bits(), sums[1].to_bits());
        }
    }
}
