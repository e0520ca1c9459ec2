//! Dual numbers: values with exact derivatives, for forward-mode automatic differentiation.

use std::ops::{Add, Div, Mul, Sub};

/// Operations of formulas that are evaluated with or without derivatives.
pub(crate) trait Number:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Mul<f64, Output = Self>
{
    /// A constant.
    fn constant(value: f64) -> Self;

    /// The value without its derivatives.
    fn value(self) -> f64;

    fn powi(self, exponent: i32) -> Self;

    fn exp(self) -> Self;

    /// Whether the number is smaller than a fraction of a sum, and each of its derivatives smaller than this fraction of that of the sum.
    fn is_below(self, part: f64, sum: Self) -> bool;

    /// The same number with its value multiplied by one factor and its derivatives by another.
    fn scaled_apart(self, value: f64, derivatives: f64) -> Self;
}

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn powi(self, exponent: i32) -> Self {
        self.powi(exponent)
    }

    fn exp(self) -> Self {
        self.exp()
    }

    fn is_below(self, part: f64, sum: Self) -> bool {
        self < part * sum
    }

    fn scaled_apart(self, value: f64, _: f64) -> Self {
        self * value
    }
}

/// A number and its derivatives with respect to `K` variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Dual<const K: usize> {
    pub(crate) value: f64,
    pub(crate) derivatives: [f64; K],
}

impl<const K: usize> Dual<K> {
    /// The independent variable with this index.
    pub(crate) fn variable(value: f64, number: usize) -> Self {
        let mut derivatives = [0.0; K];
        derivatives[number] = 1.0;
        Self { value, derivatives }
    }

    /// `value` with the derivatives `a` times those of the first number plus `b` times those of the second.
    fn combined(value: f64, this: (Self, f64), other: (Self, f64)) -> Self {
        let ((x, a), (y, b)) = (this, other);
        Self {
            value,
            derivatives: std::array::from_fn(|k| a * x.derivatives[k] + b * y.derivatives[k]),
        }
    }
}

impl<const K: usize> Add for Dual<K> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::combined(self.value + other.value, (self, 1.0), (other, 1.0))
    }
}

impl<const K: usize> Sub for Dual<K> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::combined(self.value - other.value, (self, 1.0), (other, -1.0))
    }
}

impl<const K: usize> Mul for Dual<K> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (x, y) = (self.value, other.value);
        Self::combined(x * y, (self, y), (other, x))
    }
}

impl<const K: usize> Div for Dual<K> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let ratio = self.value / other.value;
        let inverse = other.value.recip();
        Self::combined(ratio, (self, inverse), (other, -ratio * inverse))
    }
}

impl<const K: usize> Mul<f64> for Dual<K> {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        self.scaled_apart(factor, factor)
    }
}

impl<const K: usize> Number for Dual<K> {
    fn constant(value: f64) -> Self {
        Self {
            value,
            derivatives: [0.0; K],
        }
    }

    fn value(self) -> f64 {
        self.value
    }

    fn powi(self, exponent: i32) -> Self {
        if exponent == 0 {
            return Self::constant(1.0);
        }
        let slope = f64::from(exponent) * self.value.powi(exponent - 1);
        self.scaled_apart(1.0, slope)
            .with_value(self.value.powi(exponent))
    }

    fn exp(self) -> Self {
        let value = self.value.exp();
        self.scaled_apart(1.0, value).with_value(value)
    }

    fn is_below(self, part: f64, sum: Self) -> bool {
        let mut pairs = self.derivatives.iter().zip(&sum.derivatives);
        self.value < part * sum.value && pairs.all(|(d, sum)| d.abs() <= part * sum.abs())
    }

    fn scaled_apart(self, value: f64, derivatives: f64) -> Self {
        Self {
            value: self.value * value,
            derivatives: self.derivatives.map(|d| d * derivatives),
        }
    }
}

impl<const K: usize> Dual<K> {
    fn with_value(self, value: f64) -> Self {
        Self { value, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_formula() {
        fn formula<N: Number>([x, y]: [N; 2]) -> N {
            (x * y + N::constant(2.0) - y.powi(3)) / (x * x * 0.5 + y.powi(0)) + (x * y).exp()
        }
        let (x, y) = (1.3, -0.7);
        let found = formula([Dual::<2>::variable(x, 0), Dual::variable(y, 1)]);
        assert!((found.value - formula([x, y])).abs() < 1e-15);
        let step = 1e-5;
        let along_x = (formula([x + step, y]) - formula([x - step, y])) / (2.0 * step);
        let along_y = (formula([x, y + step]) - formula([x, y - step])) / (2.0 * step);
        for (found, expected) in found.derivatives.into_iter().zip([along_x, along_y]) {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }
}
