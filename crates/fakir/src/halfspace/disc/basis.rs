//! Modes of the pressure on a disc, orthonormal on the hemisphere.
//!
//! `Y_lm = Pbar_lm(mu) {1 | sqrt2 cos(m theta) | sqrt2 sin(m theta)}` with `0 <= m <= l`,
//! `l - m` even and `mu = sqrt(1 - rho^2)`; `Pbar_lm` are the associated Legendre functions
//! without Condon-Shortley sign, normalised to `∫ Y^2 dOmega = 1` over the hemisphere. The
//! pressures `Y/mu` are the eigenfunctions of the disc: `∫ (Y/mu)/|x - x'| dA'/pi = lambda Y`
//! (E. T. Copson, Proc. Edinb. Math. Soc. 8, 14 (1947); V. I. Fabrikant, Mixed Boundary Value
//! Problems of Potential Theory, 1991).

use crate::numerics::special::gamma_half;
use crate::problem::column::Column;
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

/// `∫ Y_00 dOmega = sqrt(2 pi)`: the force of a unit coefficient of the lowest mode.
pub(crate) const UNIT_FORCE: f64 = 2.506_628_274_631_000_7;

/// `lambda_11` of the tilt modes, which follow the lowest mode.
pub(crate) const TILT_COMPLIANCE: f64 = FRAC_PI_2;

/// `sqrt(3/(2 pi))`: the tilt modes are this times x and y.
pub(crate) const TILT_MODE: f64 = 0.690_988_298_942_670_9;

/// One mode of the pressure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Mode {
    /// `l`
    pub(crate) degree: usize,
    /// `m`
    pub(crate) order: usize,
    /// Whether the mode is proportional to `sin(m theta)`.
    pub(crate) sine: bool,
}

impl Mode {
    /// Whether the mode changes its sign under a rotation by 180 degrees.
    pub(crate) fn is_odd(&self) -> bool {
        self.degree % 2 == 1
    }

    /// Whether the mode is odd in x, and in y.
    pub(crate) fn parities(&self) -> [bool; 2] {
        [(self.order + usize::from(self.sine)) % 2 == 1, self.sine]
    }
}

/// `(p + 1)(p + 2)/2`, the number of modes up to degree `p`.
pub(crate) const fn mode_count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// The lowest degree with at least this number of modes.
pub(crate) fn degree_with(count: usize) -> usize {
    (0..)
        .find(|&degree| mode_count(degree) >= count)
        .unwrap_or(0)
}

/// All modes up to `degree`, by increasing degree: a lower degree is a leading block.
pub(crate) fn modes(degree: usize) -> Vec<Mode> {
    let mut modes = Vec::with_capacity(mode_count(degree));
    for l in 0..=degree {
        for m in (l % 2..=l).step_by(2) {
            for sine in [false, true] {
                if m > 0 || !sine {
                    modes.push(Mode {
                        degree: l,
                        order: m,
                        sine,
                    });
                }
            }
        }
    }
    modes
}

/// Rotates an expansion by an angle (rad).
pub(crate) fn turn(coefficients: &mut [f64], angle: f64) {
    let modes = modes(degree_with(coefficients.len()));
    UnloadingPoint::new(&modes, angle, false).apply(coefficients);
}

/// Transformation of mode coefficients under a rotation, optionally preceded by a reflection of y.
#[derive(Debug, Clone)]
pub(crate) struct UnloadingPoint {
    reflected: bool,
    /// The index of every cosine mode (the sine mode follows it), with the cosine and sine of the angle times its order.
    cosines: Vec<(usize, [f64; 2])>,
}

impl UnloadingPoint {
    /// Rotation by an angle (rad).
    pub(crate) fn new(modes: &[Mode], angle: f64, reflected: bool) -> Self {
        let are_cosines = |(_, mode): &(usize, &Mode)| mode.order > 0 && !mode.sine;
        let turned = |(number, mode): (usize, &Mode)| {
            let (sine, cosine) = (mode.order as f64 * angle).sin_cos();
            (number, [cosine, sine].map(whole))
        };
        let all = modes.iter().enumerate().filter(are_cosines);
        Self {
            reflected,
            cosines: all.map(turned).collect(),
        }
    }

    /// The inverse transformation.
    pub(crate) fn inverse(mut self) -> Self {
        // A reflection is its own inverse.
        if !self.reflected {
            for (_, [_, sine]) in &mut self.cosines {
                *sine = -*sine;
            }
        }
        self
    }

    pub(crate) fn apply(&self, coefficients: &mut [f64]) {
        let sign = if self.reflected { -1.0 } else { 1.0 };
        for (number, [cosine, sine]) in &self.cosines {
            let [of_cosine, of_sine] = [coefficients[*number], sign * coefficients[number + 1]];
            coefficients[*number] = cosine * of_cosine - sine * of_sine;
            coefficients[number + 1] = sine * of_cosine + cosine * of_sine;
        }
    }
}

/// Removes rounding from multiples of a quarter turn.
fn whole(value: f64) -> f64 {
    let nearest = value.round();
    if (value - nearest).abs() < 1e-14 {
        nearest
    } else {
        value
    }
}

/// `lambda_lm = G((l+m+1)/2) G((l-m+1)/2) / (G((l+m+2)/2) G((l-m+2)/2))`: the displacement inside the disc is `lambda Y` under the pressure
/// `Y/mu`.
pub(crate) fn eigenvalue(degree: usize, order: usize) -> f64 {
    let ratio = |n: usize| gamma_ratio(n);
    ratio(degree + order) * ratio(degree - order)
}

/// `Gamma((n+1)/2)/Gamma((n+2)/2)`, stable for any `n`.
fn gamma_ratio(n: usize) -> f64 {
    let (mut value, mut k) = if n.is_multiple_of(2) {
        (PI.sqrt(), 0)
    } else {
        (2.0 / PI.sqrt(), 1)
    };
    while k < n {
        k += 2;
        value *= (k - 1) as f64 / k as f64;
    }
    value
}

/// Evaluates all modes up to a degree at points of the disc.
#[derive(Debug, Clone)]
pub(crate) struct BasisEvaluator {
    degree: usize,
    modes: Vec<Mode>,
    /// `Pbar_lm`, at index `l (l+1)/2 + m`.
    legendre: Vec<f64>,
    /// Recurrence coefficients `(alpha, beta)` at the same index, for `m <= l - 2`.
    recurrence: Vec<(f64, f64)>,
    /// The `mu` and `rho` for which `legendre` was evaluated; points on one ring have these in common.
    ring: Option<(f64, f64)>,
    cosines: Vec<f64>,
    sines: Vec<f64>,
}

const fn triangle(l: usize, m: usize) -> usize {
    l * (l + 1) / 2 + m
}

impl BasisEvaluator {
    pub(crate) fn new(degree: usize) -> Self {
        let mut recurrence = vec![(0.0, 0.0); triangle(degree + 1, 0)];
        for l in 2..=degree {
            for m in 0..=l - 2 {
                let (lf, mf) = (l as f64, m as f64);
                let alpha = ((4.0 * lf * lf - 1.0) / (lf * lf - mf * mf)).sqrt();
                let k = lf - 1.0;
                let beta = ((k * k - mf * mf) / (4.0 * k * k - 1.0)).sqrt();
                recurrence[triangle(l, m)] = (alpha, beta);
            }
        }
        Self {
            degree,
            modes: modes(degree),
            legendre: vec![0.0; triangle(degree + 1, 0)],
            recurrence,
            ring: None,
            cosines: vec![0.0; degree + 1],
            sines: vec![0.0; degree + 1],
        }
    }

    pub(crate) fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// Computes the value of every mode at `point` (in pillar radii from the centre) into `values`.
    pub(crate) fn evaluate(&mut self, point: [f64; 2], values: &mut [f64]) {
        let rho = point[0].hypot(point[1]);
        let mu = (1.0 - rho * rho).max(0.0).sqrt();
        let direction = if rho > 0.0 {
            [point[0] / rho, point[1] / rho]
        } else {
            [1.0, 0.0]
        };
        self.evaluate_polar(mu, rho, direction, values);
    }

    /// [`Self::evaluate`] with `mu`, `rho` and the unit vector of the angle given.
    pub(crate) fn evaluate_polar(
        &mut self,
        mu: f64,
        rho: f64,
        direction: [f64; 2],
        values: &mut [f64],
    ) {
        if self.ring != Some((mu, rho)) {
            self.fill_legendre(mu, rho);
            self.ring = Some((mu, rho));
        }
        let [cos, sin] = direction;
        (self.cosines[0], self.sines[0]) = (1.0, 0.0);
        for m in 1..=self.degree {
            let (c, s) = (self.cosines[m - 1], self.sines[m - 1]);
            (self.cosines[m], self.sines[m]) = (c * cos - s * sin, s * cos + c * sin);
        }
        for (value, mode) in values.iter_mut().zip(&self.modes) {
            let radial = self.legendre[triangle(mode.degree, mode.order)];
            *value = radial
                * match (mode.order, mode.sine) {
                    (0, _) => 1.0,
                    (m, false) => SQRT_2 * self.cosines[m],
                    (m, true) => SQRT_2 * self.sines[m],
                };
        }
    }

    fn fill_legendre(&mut self, mu: f64, rho: f64) {
        let table = &mut self.legendre;
        table[0] = (2.0 * PI).sqrt().recip();
        for m in 1..=self.degree {
            let mf = m as f64;
            table[triangle(m, m)] =
                ((2.0 * mf + 1.0) / (2.0 * mf)).sqrt() * rho * table[triangle(m - 1, m - 1)];
        }
        for m in 0..self.degree {
            table[triangle(m + 1, m)] = (2.0 * m as f64 + 3.0).sqrt() * mu * table[triangle(m, m)];
        }
        for l in 2..=self.degree {
            for m in 0..=l - 2 {
                let (alpha, beta) = self.recurrence[triangle(l, m)];
                table[triangle(l, m)] =
                    alpha * (mu * table[triangle(l - 1, m)] - beta * table[triangle(l - 2, m)]);
            }
        }
    }
}

/// `y_lm = Pbar_lm(0)`, the modes without their angular factor at the edge of the disc.
pub(crate) fn equator_value(degree: usize, order: usize) -> f64 {
    // |y_lm| follows from lambda = 2 pi^2 y^2/(2l + 1); the sign is that of P_lm(0).
    let magnitude = ((2 * degree + 1) as f64 * eigenvalue(degree, order) / (2.0 * PI * PI)).sqrt();
    if ((degree - order) / 2).is_multiple_of(2) {
        magnitude
    } else {
        -magnitude
    }
}

/// Displacement inside the disc per coefficient: `lambda` of every mode up to `degree`, including the compliance of the pillar in the mean
/// and in the tilts: `lambda_00 = pi (1 + kappa)`, and both `lambda_11` likewise.
pub(crate) fn compliances(degree: usize, column: impl Into<Column>) -> Vec<f64> {
    let mut compliances: Vec<f64> = modes(degree)
        .iter()
        .map(|mode| eigenvalue(mode.degree, mode.order))
        .collect();
    for (compliance, factor) in compliances.iter_mut().zip(column_factors(column.into())) {
        *compliance *= factor;
    }
    compliances
}

/// Factors by which an elastic pillar increases the compliances of the first modes: of the mean and of the tilts along x and y.
pub(crate) fn column_factors(column: Column) -> [f64; 3] {
    let tilt = 1.0 + column.rocking;
    [1.0 + column.shortening, tilt, tilt]
}

/// `Gamma(l + 3/2)`.
pub(crate) fn gamma_degree(degree: usize) -> f64 {
    gamma_half(2 * degree + 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turned_expansions_have_their_values_elsewhere() {
        let mut coefficients: Vec<f64> =
            (0..mode_count(5)).map(|k| (1.3 * k as f64).sin()).collect();
        let before = coefficients.clone();
        turn(&mut coefficients, 0.7);
        let mut basis = BasisEvaluator::new(5);
        let mut value = |coefficients: &[f64], [x, y]: [f64; 2]| {
            let mut values = vec![0.0; coefficients.len()];
            basis.evaluate([x, y], &mut values);
            values
                .iter()
                .zip(coefficients)
                .map(|(y, c)| y * c)
                .sum::<f64>()
        };
        let (sin, cos) = 0.7_f64.sin_cos();
        for [x, y] in [[0.3, -0.2], [0.9, 0.1], [-0.5, 0.6]] {
            let there = [cos * x - sin * y, sin * x + cos * y];
            let difference = value(&coefficients, there) - value(&before, [x, y]);
            assert!(difference.abs() < 1e-14, "{difference:e}");
        }
    }
    use crate::numerics::quadrature::{gauss_legendre, hemisphere};

    #[test]
    fn modes_are_orthonormal_on_the_hemisphere() {
        let degree = 10;
        let count = mode_count(degree);
        let mut basis = BasisEvaluator::new(degree);
        let mut gram = vec![0.0; count * count];
        let mut values = vec![0.0; count];
        for (point, weight) in hemisphere(12, 48) {
            basis.evaluate(point, &mut values);
            for i in 0..count {
                for j in 0..count {
                    gram[i * count + j] += weight * values[i] * values[j];
                }
            }
        }
        for i in 0..count {
            for j in 0..count {
                let expected = f64::from(u8::from(i == j));
                assert!((gram[i * count + j] - expected).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn equator_values_match_the_recurrence() {
        let mut basis = BasisEvaluator::new(14);
        let mut values = vec![0.0; mode_count(14)];
        basis.evaluate_polar(0.0, 1.0, [1.0, 0.0], &mut values);
        for (value, mode) in values.iter().zip(modes(14)) {
            if !mode.sine {
                let factor = if mode.order == 0 { 1.0 } else { SQRT_2 };
                let expected = factor * equator_value(mode.degree, mode.order);
                assert!((value - expected).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn eigenvalues_of_the_flat_and_the_tilted_punch() {
        assert!((eigenvalue(0, 0) - PI).abs() < 1e-15);
        assert!((eigenvalue(1, 1) - PI / 2.0).abs() < 1e-15);
    }

    /// Displacement at a point of the disc under `Y/mu`, by quadrature in polar coordinates around that point, which removes the
    /// singularity 1/distance. The substitution s = s_max sin(t) removes the edge singularity of `1/mu`.
    fn displacement_by_quadrature(mode: Mode, point: [f64; 2]) -> f64 {
        let mut basis = BasisEvaluator::new(mode.degree);
        let index = modes(mode.degree).iter().position(|m| *m == mode).unwrap();
        let mut values = vec![0.0; mode_count(mode.degree)];
        let rule = gauss_legendre(64);
        let angles = 256;
        let mut sum = 0.0;
        for k in 0..angles / 2 {
            // One chord through the point, its two halves joined: along the chord,
            // mu^2 = (s - s1)(s2 - s), an exact Chebyshev weight.
            let angle = 2.0 * PI * k as f64 / angles as f64;
            let (sin, cos) = angle.sin_cos();
            let along = point[0] * cos + point[1] * sin;
            let across_squared = point[0].powi(2) + point[1].powi(2) - along * along;
            let half_chord = (1.0 - across_squared).sqrt();
            for &(node, weight) in &rule {
                let t = 0.5 * PI * node;
                let s = -along + half_chord * t.sin();
                let at = [point[0] + s * cos, point[1] + s * sin];
                basis.evaluate(at, &mut values);
                sum += 0.5 * PI * weight * values[index];
            }
        }
        sum * 2.0 * PI / angles as f64 / PI
    }

    #[test]
    fn eigenvalues_by_direct_quadrature() {
        let points = [[0.0, 0.0], [0.31, -0.17], [-0.55, 0.62]];
        let mut basis = BasisEvaluator::new(10);
        let mut values = vec![0.0; mode_count(10)];
        for point in points {
            basis.evaluate(point, &mut values);
            for (index, mode) in modes(10).into_iter().enumerate() {
                let expected = eigenvalue(mode.degree, mode.order) * values[index];
                let found = displacement_by_quadrature(mode, point);
                assert!(
                    (found - expected).abs() < 1e-12,
                    "{mode:?} at {point:?}: {found} is not {expected}"
                );
            }
        }
    }
}
