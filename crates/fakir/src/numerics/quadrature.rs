//! Gauss-Legendre quadrature.

use std::f64::consts::PI;

/// Nodes in (-1, 1) and weights of the Gauss-Legendre rule with `count` points.
///
/// Newton iteration on `P_n` from Tricomi's estimate of its roots; exact for polynomials of degree `2 count - 1`.
pub(crate) fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    (0..count)
        .map(|k| {
            let mut x = -((PI * (k as f64 + 0.75)) / (n + 0.5)).cos();
            let mut derivative = 1.0;
            for _ in 0..12 {
                let (value, slope) = legendre(count, x);
                derivative = slope;
                let step = value / slope;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * derivative * derivative))
        })
        .collect()
}

/// `P_n(x)` and its derivative.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut value) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (previous, value) = (
            value,
            ((2.0 * k - 1.0) * x * value - (k - 1.0) * previous) / k,
        );
    }
    (value, n as f64 * (x * value - previous) / (x * x - 1.0))
}

/// Product rule on the unit disc for the hemisphere measure `dOmega`: points and weights.
///
/// `radial` Gauss points in `mu` (the positive half of a rule with twice as many points) times `angular` equally spaced angles; exact for
/// products of modes whose degrees add up to less than `min(4 radial, angular)`.
pub(crate) fn hemisphere(radial: usize, angular: usize) -> Vec<([f64; 2], f64)> {
    let turn = 2.0 * PI / angular as f64;
    gauss_legendre(2 * radial)[radial..]
        .iter()
        .flat_map(|&(mu, weight)| {
            let rho = (1.0 - mu * mu).sqrt();
            (0..angular).map(move |k| {
                let (sin, cos) = (turn * k as f64).sin_cos();
                ([rho * cos, rho * sin], weight * turn)
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrates_monomials_exactly() {
        let rule = gauss_legendre(12);
        for power in (0..24).step_by(2) {
            let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(power)).sum();
            assert!((sum - 2.0 / f64::from(power + 1)).abs() < 1e-14);
        }
    }

    #[test]
    fn hemisphere_has_its_area() {
        let area: f64 = hemisphere(4, 9).iter().map(|(_, weight)| weight).sum();
        assert!((area - 2.0 * PI).abs() < 1e-13);
    }
}
