//! Dilogarithm, complete elliptic integrals and Legendre functions of the second kind.

use std::f64::consts::PI;

/// `Li2(z)`, the sum of `z^k/k^2`, for `0 <= z <= 1`.
///
/// The series takes all of `z <= 1/2`; above, `Li2(z) = pi^2/6 - ln z ln(1 - z) - Li2(1 - z)` (Abramowitz & Stegun 27.7.3).
pub(crate) fn dilogarithm(z: f64) -> f64 {
    debug_assert!((0.0..=1.0).contains(&z));
    if z >= 1.0 {
        return PI * PI / 6.0;
    }
    if z > 0.5 {
        return PI * PI / 6.0 - z.ln() * (-z).ln_1p() - dilogarithm(1.0 - z);
    }
    let mut sum = 0.0;
    let mut power = z;
    for k in 1..=60 {
        let k = f64::from(k);
        sum += power / (k * k);
        power *= z;
    }
    sum
}

/// `K(k)/K(k')` of complete elliptic integrals of the first kind, `k' = sqrt(1 - k^2)`, for `0 < k < 1`: each is `pi/2` over the
/// arithmetic-geometric mean of 1 and the other modulus (Abramowitz & Stegun 17.6.3).
pub(crate) fn elliptic_ratio(k: f64) -> f64 {
    arithmetic_geometric_mean(k) / arithmetic_geometric_mean(((1.0 - k) * (1.0 + k)).sqrt())
}

/// The arithmetic-geometric mean of 1 and another number in (0, 1].
fn arithmetic_geometric_mean(other: f64) -> f64 {
    let (mut a, mut b) = (1.0, other);
    for _ in 0..40 {
        if (a - b).abs() <= 2.0 * f64::EPSILON * a {
            break;
        }
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

/// Legendre functions of the second kind `Q_0(x)` to `Q_n(x)` at `x > 1`, with `n + 1` the length of `values`.
///
/// They are the solution of the recurrence `(n + 1) Q_{n+1} = (2 n + 1) x Q_n - n Q_{n-1}` that falls with `n`, so that their ratios come
/// out of it downward (W. Gautschi, SIAM Rev. 9, 24 (1967)), from `Q_0 = ln((x + 1)/(x - 1))/2`.
pub(crate) fn legendre_q(x: f64, values: &mut [f64]) {
    debug_assert!(x > 1.0);
    let Some(highest) = values.len().checked_sub(1) else {
        return;
    };
    // Each step downward takes the square of this from the error of the first ratio.
    let falloff = x - ((x - 1.0) * (x + 1.0)).sqrt();
    let extra = (-20.0 / falloff.ln()).ceil() as usize;
    let mut ratio = falloff;
    for n in (1..=highest + extra).rev() {
        let k = n as f64;
        ratio = k / ((2.0 * k + 1.0) * x - (k + 1.0) * ratio);
        if n <= highest {
            values[n] = ratio;
        }
    }
    values[0] = 0.5 * (2.0 / (x - 1.0)).ln_1p();
    for n in 1..=highest {
        values[n] *= values[n - 1];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz & Stegun 27.7.7 and table 27.7 (`f(x) = Li2(1 - x)`).
    #[test]
    fn dilogarithms() {
        let half = PI * PI / 12.0 - 0.5 * 2f64.ln().powi(2);
        assert!((dilogarithm(0.5) - half).abs() < 1e-15);
        assert!((dilogarithm(0.500_000_1) - half).abs() < 2e-7);
        assert!((dilogarithm(1.0) - PI * PI / 6.0).abs() < 1e-15);
        assert!((dilogarithm(0.9) - 1.299_714_723).abs() < 1e-9);
        assert!(dilogarithm(0.0).abs() < 1e-15);
    }

    /// Singular values: `K(k')/K(k) = sqrt(n)` at `k = 1/sqrt 2` and `sqrt 2 - 1` (Abramowitz & Stegun 17.3, singular values of order 1,
    /// 2).
    #[test]
    fn ratios_of_elliptic_integrals() {
        assert!((elliptic_ratio(0.5f64.sqrt()) - 1.0).abs() < 1e-15);
        assert!((elliptic_ratio(2f64.sqrt() - 1.0) - 0.5f64.sqrt()).abs() < 1e-15);
    }

    /// `Q_1 = x Q_0 - 1`, `Q_2 = (3 x^2 - 1)/2 Q_0 - 3 x/2`, and `Q_n ~ n! x^(-n-1)/(2 n + 1)!!` far away.
    #[test]
    fn legendre_functions_of_the_second_kind() {
        let mut values = [0.0; 6];
        for x in [1.0001, 1.1, 1.7] {
            legendre_q(x, &mut values);
            let first = x * values[0] - 1.0;
            let second = 0.5 * (3.0 * x * x - 1.0) * values[0] - 1.5 * x;
            assert!((values[1] - first).abs() < 1e-14, "{x}");
            assert!((values[2] - second).abs() < 1e-14, "{x}");
        }
        let x: f64 = 1e4;
        legendre_q(x, &mut values);
        let far = 120.0 / 10395.0 * x.powi(-6);
        assert!((values[5] / far - 1.0).abs() < 1e-7);
    }
}
