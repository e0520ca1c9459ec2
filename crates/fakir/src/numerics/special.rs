//! Gamma function at half-integers.

use std::f64::consts::PI;

/// `Gamma(n/2)` for `n >= 1`, by `Gamma(x + 1) = x Gamma(x)` from `Gamma(1/2) = sqrt(pi)`
/// or `Gamma(1) = 1`.
pub(crate) fn gamma_half(n: usize) -> f64 {
    debug_assert!(n >= 1);
    let (mut value, mut k) = if n % 2 == 1 { (PI.sqrt(), 1) } else { (1.0, 2) };
    while k < n {
        value *= 0.5 * k as f64;
        k += 2;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_integer_values() {
        // Abramowitz & Stegun 6.1.8 to 6.1.12.
        assert!((gamma_half(1) - PI.sqrt()).abs() < 1e-15);
        assert!((gamma_half(5) - 0.75 * PI.sqrt()).abs() < 1e-15);
        assert!((gamma_half(10) - 24.0).abs() < 1e-13);
    }
}
