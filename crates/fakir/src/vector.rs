//! Loops compiled for the vectors that the processor has.
//!
//! Results do not depend on the processor: sums are taken in the same order everywhere, and products
//! are rounded before they are added.

use pulp::Arch;
use std::ops::{Add, AddAssign, Mul, Sub};

/// Does the work with the widest vectors there are, as far as all that it calls is inlined.
#[inline(always)]
pub(crate) fn widest<R>(work: impl FnOnce() -> R) -> R {
    Arch::new().dispatch(work)
}

/// Numbers in a [`Lanes`].
pub(crate) const LANES: usize = 4;

/// Numbers on which the same is done.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Lanes(pub(crate) [f64; LANES]);

impl Lanes {
    #[inline(always)]
    pub(crate) fn splat(value: f64) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    pub(crate) fn map(self, each: impl Fn(f64) -> f64) -> Self {
        Self(self.0.map(each))
    }

    #[inline(always)]
    pub(crate) fn sum(self) -> f64 {
        let [a, b, c, d] = self.0;
        (a + b) + (c + d)
    }

    #[inline(always)]
    fn with(self, other: Self, each: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|k| each(self.0[k], other.0[k])))
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

/// Sum of products, in [`LANES`] partial sums.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    widest(
        #[inline(always)]
        || {
            let mut sums = Lanes::default();
            let (a, a_rest) = a.as_chunks::<LANES>();
            let (b, b_rest) = b.as_chunks::<LANES>();
            for (x, y) in a.iter().zip(b) {
                sums += Lanes(*x) * Lanes(*y);
            }
            let rest: f64 = a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum();
            sums.sum() + rest
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

/// `a = factor a + b`
pub(crate) fn scale_and_add(a: &mut [f64], factor: f64, b: &[f64]) {
    widest(
        #[inline(always)]
        || {
            for (x, y) in a.iter_mut().zip(b) {
                *x = factor * *x + y;
            }
        },
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_element_counts_once() {
        for length in [0, 1, 3, 4, 5, 8, 11] {
            let a: Vec<f64> = (0..length).map(|k| f64::from(k) + 1.0).collect();
            let squares: f64 = a.iter().map(|x| x * x).sum();
            assert!((dot(&a, &a) - squares).abs() < 1e-12);
            let mut b = a.clone();
            add_scaled(&mut b, 2.0, &a);
            subtract(&mut b, &a);
            scale_and_add(&mut b, -0.5, &a);
            assert!(b.iter().all(|x| x.abs() < 1e-12), "{length}");
        }
    }
}
