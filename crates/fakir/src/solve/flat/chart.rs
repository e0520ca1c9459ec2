//! Contacts with a flat surface over their radius, by interpolation: for thousands of loads on one curve.
//!
//! Indentation and force are smooth in the contact radius, with a singularity at 0 alone. On an octave of radii they are therefore polynomials, through
//! Chebyshev points, to nearly all digits.

use crate::numerics::convergence::{larger, smaller, within};
use std::array::from_fn;
use std::cell::RefCell;
use std::collections::HashMap;
use std::f64::consts::PI;

/// Points on an octave. The interpolation converges as `(3 + sqrt(8))^-n`: 20 points leave rounding errors.
const POINTS: usize = 20;

/// Largest last coefficients of an octave, relative to the largest one. Where they are larger, as at the kinks of a profile, every contact is solved.
const RESOLVED: f64 = 1e-12;

/// Octaves of radii, for each work of adhesion; `None` where the curve is not smooth.
#[derive(Default)]
pub(super) struct Chart {
    octaves: RefCell<HashMap<(u64, i32), Option<Octave>>>,
}

impl Chart {
    /// Indentation and force of the contact of a radius whose rim has a work of adhesion, by contacts of radii up to the largest that are solved; `None`
    /// where it has to be solved itself.
    pub(super) fn at(
        &self,
        (radius, work): (f64, f64),
        largest: f64,
        solved: impl Fn(f64) -> [f64; 2],
    ) -> Option<[f64; 2]> {
        let number = radius.log2().floor();
        if !number.is_finite() {
            return None;
        }
        let mut octaves = self.octaves.borrow_mut();
        let octave = octaves
            .entry((work.to_bits(), number as i32))
            .or_insert_with(|| {
                let low = number.exp2();
                Octave::through([low, smaller(2.0 * low, largest)], solved)
            });
        octave.as_ref()?.at(radius)
    }
}

/// Indentation and force as sums of Chebyshev polynomials.
struct Octave {
    ends: [f64; 2],
    coefficients: [[f64; POINTS]; 2],
}

impl Octave {
    fn through(ends: [f64; 2], solved: impl Fn(f64) -> [f64; 2]) -> Option<Self> {
        let [low, high] = ends;
        let angle = |point: usize| PI * (point as f64 + 0.5) / POINTS as f64;
        let contacts: [[f64; 2]; POINTS] = from_fn(|point| {
            solved(f64::midpoint(low, high) + 0.5 * (high - low) * angle(point).cos())
        });
        let coefficients = [0, 1].map(|which| {
            from_fn(|degree| {
                let parts = contacts.iter().enumerate();
                let sum: f64 = parts
                    .map(|(point, of)| of[which] * (degree as f64 * angle(point)).cos())
                    .sum();
                sum * if degree == 0 { 1.0 } else { 2.0 } / POINTS as f64
            })
        });
        let is_resolved = |all: &[f64; POINTS]| {
            let largest = |of: &[f64]| of.iter().fold(0.0, |most, one| larger(most, one.abs()));
            within(largest(&all[POINTS - 2..]), RESOLVED * largest(all))
        };
        let is_smooth = coefficients.iter().all(is_resolved);
        is_smooth.then_some(Self { ends, coefficients })
    }

    fn at(&self, radius: f64) -> Option<[f64; 2]> {
        let [low, high] = self.ends;
        let place = (2.0 * radius - low - high) / (high - low);
        // Sum by C. W. Clenshaw, Math. Tables Aids Comput. 9, 118 (1955).
        let sum = |coefficients: &[f64; POINTS]| {
            let (mut next, mut beyond) = (0.0, 0.0);
            for coefficient in coefficients[1..].iter().rev() {
                (next, beyond) = (coefficient + 2.0 * place * next - beyond, next);
            }
            coefficients[0] + place * next - beyond
        };
        within(place.abs(), 1.0).then(|| self.coefficients.each_ref().map(sum))
    }
}
