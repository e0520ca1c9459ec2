//! Root finding for functions of one variable: one bracketing method for all searches.
//!
//! The method is that of T. R. Chandrupatla, Adv. Eng. Softw. 28, 145 (1997): inverse quadratic interpolation where the last three points
//! permit it, bisection otherwise. It needs no derivative, stays within the bracket, and needs about ten evaluations to find a root of a
//! smooth function to full precision.

use crate::numerics::convergence::{clamped, within};

/// Limit of evaluations. Bisection alone takes 52 evaluations per factor of two between the ends of the bracket.
const LIMIT: usize = 2200;

/// A point and the value of the function there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// The argument.
    pub position: f64,
    /// The function value.
    pub value: f64,
}

/// Two adjacent points between which a function changes its sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Root {
    /// Point with a negative value or zero.
    pub below: Point,
    /// Point with a positive value or zero.
    pub above: Point,
    /// Number of function evaluations.
    pub evaluations: usize,
}

/// Kind of a sign change between two adjacent points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// The function is zero at this point, within the tolerance.
    Crossing(Point),
    /// The function jumps over zero, or is infinite on one side.
    Jump,
}

impl Root {
    /// Distinguishes a crossing, where the function is within `tolerance` of zero (in its own units), from a jump over zero.
    #[must_use]
    pub fn change(&self, tolerance: f64) -> Change {
        let closest = self.closest();
        if within(closest.value.abs(), tolerance) {
            Change::Crossing(closest)
        } else {
            Change::Jump
        }
    }

    /// The point with the smaller absolute value.
    #[must_use]
    pub fn closest(&self) -> Point {
        if self.below.value.abs() < self.above.value.abs() {
            self.below
        } else {
            self.above
        }
    }
}

/// Narrows a bracket with different signs at its ends until its width is `tolerance` relative to the position, or the spacing of
/// floating-point numbers. Returns `None` if the signs are the same, or if the function is undefined somewhere.
///
/// The function may jump over zero, and may be infinite: [`Root::change`] distinguishes these cases. The bracket is bisected while the
/// function is infinite at one of its ends.
///
/// # Errors
/// Returns the first error of the function.
///
/// ```
/// use fakir::numerics::roots::{Point, find};
///
/// let end = |position: f64| Point { position, value: position * position - 2.0 };
/// let root = find([end(0.0), end(2.0)], 0.0, |x| Ok::<_, ()>(x * x - 2.0))?.expect("a root");
/// assert!((root.closest().position - 2f64.sqrt()).abs() < 1e-15);
/// # Ok::<(), ()>(())
/// ```
pub fn find<E>(
    ends: [Point; 2],
    tolerance: f64,
    mut function: impl FnMut(f64) -> Result<f64, E>,
) -> Result<Option<Root>, E> {
    let [mut newest, mut opposite] = ends;
    let root = |one: Point, other: Point, evaluations: usize| {
        let [below, above] = if one.value <= 0.0 && other.value >= 0.0 {
            [one, other]
        } else {
            [other, one]
        };
        Root {
            below,
            above,
            evaluations,
        }
    };
    if newest.value == 0.0 || opposite.value == 0.0 {
        let zero = if newest.value == 0.0 {
            newest
        } else {
            opposite
        };
        return Ok(Some(root(zero, zero, 0)));
    }
    // A product of the values could overflow. These comparisons also reject NaN.
    if !(newest.value < 0.0 && opposite.value > 0.0 || newest.value > 0.0 && opposite.value < 0.0) {
        return Ok(None);
    }
    let mut part = 0.5;
    for evaluations in 1..=LIMIT {
        let position = newest.position + part * (opposite.position - newest.position);
        let trial = Point {
            position,
            value: function(position)?,
        };
        if trial.value.is_nan() {
            return Ok(None);
        }
        if trial.value == 0.0 {
            return Ok(Some(root(trial, trial, evaluations)));
        }
        let before;
        if (trial.value > 0.0) == (newest.value > 0.0) {
            before = newest;
        } else {
            (before, opposite) = (opposite, newest);
        }
        newest = trial;
        let width = (opposite.position - newest.position).abs();
        let size = newest.position.abs().max(opposite.position.abs());
        let narrowest = size * tolerance.max(2.0 * f64::EPSILON);
        if width <= narrowest || width <= f64::MIN_POSITIVE {
            return Ok(Some(root(newest, opposite, evaluations)));
        }
        part = next_part(newest, opposite, before);
        // Keeps a minimum distance from the ends, so that every evaluation narrows the bracket.
        let least = (0.5 * narrowest / width).min(0.5);
        part = clamped(part, least, 1.0 - least);
    }
    Ok(None)
}

/// The next position, as a fraction of the way from the newest point to the opposite one.
fn next_part(newest: Point, opposite: Point, before: Point) -> f64 {
    let [f1, f2, f3] = [newest, opposite, before].map(|point| point.value);
    let [x1, x2, x3] = [newest, opposite, before].map(|point| point.position);
    let position = (x1 - x2) / (x3 - x2);
    let value = (f1 - f2) / (f3 - f2);
    // Within these bounds, inverse quadratic interpolation is monotone.
    if value * value < position && (1.0 - value) * (1.0 - value) < 1.0 - position {
        f1 / (f2 - f1) * f3 / (f2 - f3) + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
    } else {
        0.5
    }
}

/// Minimum of a function that decreases and then increases between two positions, by the given number of golden-section steps; each reduces
/// the bracket to 0.618 of its width.
pub(crate) fn least(
    [mut low, mut high]: [f64; 2],
    sections: usize,
    function: impl Fn(f64) -> f64,
) -> f64 {
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..sections {
        let (left, right) = (high - ratio * (high - low), low + ratio * (high - low));
        if function(left) < function(right) {
            high = right;
        } else {
            low = left;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn golden_sections_close_in_on_the_least_value() {
        let found = least([0.0, 3.0], 45, |x| (x - 1.0).powi(2));
        assert!((found - 1.0).abs() < 1e-7, "{found}");
    }

    fn solve(low: f64, high: f64, function: impl Fn(f64) -> f64) -> Option<Root> {
        let ends = [low, high].map(|position| Point {
            position,
            value: function(position),
        });
        let found = find(ends, 0.0, |x| Ok::<_, Infallible>(function(x)));
        match found {
            Ok(root) => root,
        }
    }

    /// Known roots of smooth, steep, flat and discontinuous functions.
    #[test]
    fn finds_all_digits() {
        type Function = fn(f64) -> f64;
        let cases: [(f64, f64, Function, f64); 6] = [
            (0.0, 2.0, |x| x * x - 2.0, 2f64.sqrt()),
            (0.0, 4.0, |x| x.cos(), std::f64::consts::FRAC_PI_2),
            (1e-300, 1e300, |x| x.ln() - 1.0, std::f64::consts::E),
            (-1.0, 3.0, |x| (x - 0.25).powi(9), 0.25),
            (
                0.0,
                1.0,
                |x| if x < 1.0 / 3.0 { -1e9 } else { 1e-9 },
                1.0 / 3.0,
            ),
            (0.0, 1e-20, |x| 1e-25 - x, 1e-25),
        ];
        for (low, high, function, expected) in cases {
            for [low, high] in [[low, high], [high, low]] {
                let root = solve(low, high, function).unwrap();
                let found = root.closest().position;
                assert!((found / expected - 1.0).abs() < 4e-3, "{found} {expected}");
                assert!(root.below.value <= 0.0 && root.above.value >= 0.0);
                let width = (root.below.position - root.above.position).abs();
                assert!(
                    width <= 2.0 * f64::EPSILON * found.abs(),
                    "{width} at {found}"
                );
            }
        }
    }

    /// A crossing at 1/3, a jump there, and a function that is undefined below it.
    #[test]
    fn crossings_are_distinguished_from_jumps() {
        let third = 1.0 / 3.0;
        let crossing = solve(0.0, 1.0, |x| x - third).unwrap();
        assert_eq!(crossing.change(1e-15), Change::Crossing(crossing.closest()));
        let jump = solve(0.0, 1.0, |x| if x < third { -0.5 } else { 0.25 }).unwrap();
        assert_eq!(jump.change(0.2), Change::Jump);
        assert_eq!(jump.change(0.25), Change::Crossing(jump.above));
        let end = solve(0.0, 1.0, |x| if x < third { f64::NEG_INFINITY } else { x }).unwrap();
        assert_eq!(end.change(0.2), Change::Jump);
        assert!((end.above.position - third).abs() < 1e-15);
        assert!(end.evaluations < 60, "{}", end.evaluations);
    }

    #[test]
    fn is_quick_where_functions_are_smooth() {
        let root = solve(0.0, 2.0, |x| x.exp() - 2.0).unwrap();
        assert!((root.closest().position - 2f64.ln()).abs() < 4e-16);
        assert!(root.evaluations < 15, "{}", root.evaluations);
    }

    #[test]
    fn undefined_functions_have_no_root() {
        assert_eq!(solve(0.0, 1.0, |x| x + 1.0), None);
        assert_eq!(solve(0.0, 1.0, |_| f64::NAN), None);
        assert_eq!(
            solve(0.0, 1.0, |x| if x > 0.0 && x < 1.0 {
                f64::NAN
            } else {
                x - 0.5
            }),
            None
        );
        let failing = find(
            [(0.0, -1.0), (1.0, 1.0)].map(|(position, value)| Point { position, value }),
            0.0,
            |_| Err("stopped"),
        );
        assert_eq!(failing, Err("stopped"));
    }
}
