//! Formatting of numbers: engineering units, and significant digits.

use fakir_case::unit::{Dimension, Unit};

/// Digits of a value that is exact, or nearly so.
pub const DIGITS: usize = 6;

/// Digits of lengths with negligible errors: positions and gaps of the floor, periods.
pub const LENGTH_DIGITS: usize = 4;

/// Number of significant digits of a value with this relative error, two to six.
#[must_use]
pub fn digits(relative_error: f64) -> usize {
    let digits = (-relative_error.log10()).ceil();
    if digits.is_nan() || digits <= 2.0 {
        2
    } else {
        (digits as usize).min(DIGITS)
    }
}

/// A number with a number of significant digits; in scientific notation if zeros would obscure them.
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return "-".to_owned();
    }
    let scientific = format!("{value:.*e}", digits - 1);
    let exponent = scientific.rsplit_once('e').map(|(_, e)| e.parse::<i32>());
    match exponent {
        Some(Ok(exponent)) if (-3..digits.max(DIGITS) as i32).contains(&exponent) => {
            // Insignificant digits before the point become zeros, as in 1200.
            let rounded: f64 = scientific.parse().unwrap_or(value);
            let decimals = (digits as i32 - 1 - exponent).max(0);
            format!("{rounded:.*}", decimals as usize)
        }
        _ => scientific,
    }
}

/// A value in a suitable unit: the number, and the symbol of the unit.
#[must_use]
pub fn scaled(value: f64, dimension: Dimension, digits: usize) -> (String, &'static str) {
    match dimension.unit_for(value) {
        Some(unit) => (significant(value / unit.in_si(), digits), unit.symbol),
        None => (significant(value, digits), ""),
    }
}

/// A value with its unit: `92.3061 uN`.
#[must_use]
pub fn with_unit(value: f64, dimension: Dimension, digits: usize) -> String {
    let (number, unit) = scaled(value, dimension, digits);
    format!("{number} {unit}").trim_end().to_owned()
}

/// The unit of a column of values: the one that suits the largest.
#[must_use]
pub fn column_unit(values: impl Iterator<Item = f64>, dimension: Dimension) -> Option<Unit> {
    let largest = values
        .filter(|value| value.is_finite())
        .fold(0.0, |largest: f64, value| largest.max(value.abs()));
    dimension.unit_for(largest)
}

/// A duration: `0.31 s`, `12 ms`.
#[must_use]
pub fn seconds(value: f64) -> String {
    if value < 1.0 {
        format!("{} ms", significant((value * 1e3).max(1e-3), 2))
    } else {
        format!("{} s", significant(value, 3))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_follow_the_error() {
        assert_eq!(digits(0.0), 6);
        assert_eq!(digits(1e-12), 6);
        assert_eq!(digits(3e-5), 5);
        assert_eq!(digits(0.02), 2);
        assert_eq!(digits(0.5), 2);
        assert_eq!(digits(f64::NAN), 2);
    }

    #[test]
    fn significant_digits() {
        assert_eq!(significant(92.306_12, 6), "92.3061");
        assert_eq!(significant(999_999.6, 6), "1.00000e6");
        assert_eq!(significant(1234.5, 2), "1200");
        assert_eq!(significant(0.001_234_56, 3), "0.00123");
        assert_eq!(significant(1.234e-5, 3), "1.23e-5");
        assert_eq!(significant(-0.5, 2), "-0.50");
        assert_eq!(significant(9.9999, 2), "10");
        assert_eq!(significant(f64::NAN, 3), "-");
    }

    #[test]
    fn engineering_units() {
        assert_eq!(with_unit(92.3061e-6, Dimension::Force, 6), "92.3061 uN");
        assert_eq!(with_unit(999.999_9e-6, Dimension::Force, 6), "1.00000 mN");
        assert_eq!(with_unit(0.0, Dimension::Force, 6), "0 N");
        assert_eq!(with_unit(1.5e5, Dimension::Pressure, 2), "150 kPa");
    }
}
