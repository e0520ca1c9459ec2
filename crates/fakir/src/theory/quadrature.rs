//! Gauss-Legendre quadrature.

use std::f64::consts::PI;

/// Nodes and weights of the Gauss-Legendre rule of `count` points on (0, 1), ascending.
///
/// Newton's method on the Legendre polynomial, from the asymptotic positions of its zeros
/// (P. J. Davis and P. Rabinowitz, Methods of Numerical Integration, section 2.7).
pub(super) fn gauss_legendre(count: usize) -> Vec<[f64; 2]> {
    (0..count)
        .map(|k| {
            let mut x = -((k as f64 + 0.75) / (count as f64 + 0.5) * PI).cos();
            // Quadratic convergence from a start good to O(count^-2): a handful of steps.
            for _ in 0..6 {
                let (value, slope) = legendre(count, x);
                x -= value / slope;
            }
            let (_, slope) = legendre(count, x);
            [0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope)]
        })
        .collect()
}

/// Legendre polynomial of the given degree and its derivative at `x` in (-1, 1).
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut value) = (0.0, 1.0);
    for l in 0..degree {
        let l = l as f64;
        let next = ((2.0 * l + 1.0) * x * value - l * previous) / (l + 1.0);
        previous = value;
        value = next;
    }
    let slope = degree as f64 * (previous - x * value) / (1.0 - x * x);
    (value, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_for_polynomials_up_to_twice_the_count() {
        for count in [1, 2, 5, 16, 60] {
            let rule = gauss_legendre(count);
            for power in 0..(2 * count as i32) {
                let sum: f64 = rule.iter().map(|[x, weight]| weight * x.powi(power)).sum();
                let exact = 1.0 / f64::from(power + 1); // integral of x^power over (0, 1)
                assert!(
                    (sum / exact - 1.0).abs() < 1e-12,
                    "{count} points, x^{power}"
                );
            }
        }
    }
}
