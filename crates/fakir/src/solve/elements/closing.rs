//! Search for the indentation at which the lens just reaches the floor.

use crate::numerics::convergence::{Judgement, clamped, judge};

/// Secant method for the gap between lens and floor as a function of the indentation, restricted to a bracket once that exists.
pub(super) struct Closing {
    indentation: f64,
    /// The largest indentation without floor contact, and the smallest with interpenetration.
    bracket: [f64; 2],
    /// Previous indentation and its gap.
    previous: Option<[f64; 2]>,
    slope: Option<f64>,
}

impl Closing {
    /// Starts at an indentation; there is no floor contact up to `least`. `slope` is the derivative of the gap with respect to the
    /// indentation, if available from cells of another size.
    pub(super) fn new(indentation: f64, least: f64, slope: Option<f64>) -> Self {
        Self {
            indentation,
            bracket: [least, f64::INFINITY],
            previous: None,
            slope,
        }
    }

    /// The next indentation to evaluate; after convergence, the result.
    pub(super) fn indentation(&self) -> f64 {
        self.indentation
    }

    /// Derivative of the gap with respect to the indentation, if available.
    pub(super) fn slope(&self) -> Option<f64> {
        self.slope
    }

    /// Adds the gap at the current indentation. Unless it is within the tolerance, selects the next indentation.
    pub(super) fn take(&mut self, gap: f64, tolerance: f64) -> Judgement {
        let indentation = self.indentation;
        if let Some([other, other_gap]) = self.previous
            && (indentation - other).abs() > 1e-13 * indentation
        {
            self.slope = Some((gap - other_gap) / (indentation - other));
        }
        let judged = judge(gap.abs(), tolerance);
        if judged == Judgement::TooLarge {
            self.bracket[usize::from(gap < 0.0)] = indentation;
            self.previous = Some([indentation, gap]);
            self.indentation = self.next(gap);
        }
        judged
    }

    fn next(&self, gap: f64) -> f64 {
        let [low, high] = self.bracket;
        let guess = match self.slope {
            Some(slope) if slope < 0.0 => self.indentation - gap / slope,
            // The floor follows the lens: assume that a descent by the gap closes half of it.
            _ => self.indentation + 2.0 * gap,
        };
        if high.is_finite() {
            if guess > low && guess < high {
                guess
            } else {
                0.5 * (low + high)
            }
        } else {
            // No upper bound yet: at most double.
            clamped(guess, 1.001 * self.indentation, 2.0 * self.indentation)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn next_trial_stays_in_the_bracket() {
        let unbounded = [1.0, f64::INFINITY];
        for (gap, slope, bracket, expected) in [
            (0.5, Some(-1.0), unbounded, 1.5),
            (5.0, Some(-1.0), unbounded, 2.0),
            (-0.1, Some(-0.01), [0.6, 1.0], 0.8),
            (-0.1, None, [0.5, 1.0], 0.8),
        ] {
            let closing = Closing {
                indentation: 1.0,
                bracket,
                previous: None,
                slope,
            };
            let next = closing.next(gap);
            assert!((next - expected).abs() < 1e-12, "{next}");
        }
    }
}
