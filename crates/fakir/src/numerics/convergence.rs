//! Decides whether a solution is accurate enough, for every solver, search and error bound.
//!
//! A comparison with NaN is false, so that the opposite condition seems to be met, and `max` and `min` drop NaN. The functions of this
//! module never accept an undefined number: `judge` distinguishes small errors, large errors and NaN, and [`larger`], `smaller` and
//! `largest` propagate NaN where the functions of `f64` lose it.

/// Result of comparing an error with its bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[must_use]
pub(crate) enum Judgement {
    /// The error is within its bound.
    Good,
    /// The error exceeds its bound, or is infinite.
    TooLarge,
    /// The error or its bound is NaN: the accuracy of the solution is unknown.
    Undefined,
}

/// Compares an error with its bound, both in the same unit.
#[inline]
pub(crate) fn judge(error: f64, bound: f64) -> Judgement {
    if error.is_nan() || error == f64::NEG_INFINITY || !bound.is_finite() {
        Judgement::Undefined
    } else if error <= bound {
        Judgement::Good
    } else {
        Judgement::TooLarge
    }
}

/// Returns whether an error is within its bound; `false` if one of them is NaN.
#[inline]
#[must_use]
pub fn within(error: f64, bound: f64) -> bool {
    judge(error, bound) == Judgement::Good
}

/// The larger of two numbers; NaN if one of them is NaN.
#[inline]
#[must_use]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// The smaller of two numbers; NaN if one of them is NaN.
#[inline]
#[must_use]
pub(crate) fn smaller(a: f64, b: f64) -> f64 {
    if a < b || a.is_nan() { a } else { b }
}

/// Restricts a number to the interval from `least` to `greatest`. Returns NaN if one of the three is NaN, and `greatest` if it is below
/// `least`, where `f64::clamp` panics.
///
/// ```
/// use fakir::numerics::convergence::clamped;
///
/// assert_eq!(clamped(3.0, 1.0, 2.0), 2.0);
/// assert!(clamped(3.0, 1.0, f64::NAN).is_nan());
/// ```
#[inline]
#[must_use]
pub fn clamped(value: f64, least: f64, greatest: f64) -> f64 {
    smaller(larger(value, least), greatest)
}

/// The largest absolute value; NaN if a value is NaN, 0 for an empty sequence.
#[must_use]
pub(crate) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values
        .into_iter()
        .fold(0.0, |largest, value| larger(largest, value.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ODD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

    #[test]
    fn nothing_undefined_is_good() {
        for odd in ODD {
            assert!(!within(odd, 1.0) && !within(0.5, odd) && !within(odd, odd));
        }
        assert!(within(0.0, 0.0) && within(0.5, 1.0) && !within(1.5, 1.0));
        assert_eq!(judge(f64::NEG_INFINITY, 1.0), Judgement::Undefined);
        assert_eq!(judge(f64::INFINITY, 1.0), Judgement::TooLarge);
    }

    #[test]
    fn nan_is_not_dropped() {
        for (a, b) in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::NAN, f64::NAN)] {
            assert!(larger(a, b).is_nan() && smaller(a, b).is_nan());
        }
        for odd in 0..3 {
            let [value, least, greatest] = [0, 1, 2].map(|k| if k == odd { f64::NAN } else { 1.0 });
            assert!(clamped(value, least, greatest).is_nan());
        }
        let clamped = [(0.0, 1.0), (1.5, 1.5), (3.0, 2.0)].map(|(x, y)| clamped(x, 1.0, 2.0) - y);
        assert!(clamped.iter().all(|off| *off == 0.0));
        for place in 0..3 {
            let mut values = [1.0, -7.0, 2.0];
            assert_eq!(largest(values).to_bits(), 7f64.to_bits());
            values[place] = f64::NAN;
            assert!(largest(values).is_nan());
        }
        assert_eq!(larger(-1.0, 2.0).to_bits(), 2f64.to_bits());
        assert_eq!(smaller(-1.0, 2.0).to_bits(), (-1f64).to_bits());
    }
}
