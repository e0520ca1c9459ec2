//! Sums over the pillars of a centred hexagonal lattice with a Hertz-like load distribution.
//!
//! In the paper the force on a pillar at distance `r_n` from the central one, inside the contact radius `a`, is `F_n = F_0 w_n` with
//! `w_n = sqrt(1 - r_n^2/a^2)`. Three sums over `n != 0`, with distances in pitches, then determine its effect at the centre:
//!
//! ```text
//! G0 = sum w_n/r_n        displacement of the central pillar
//! G  = sum w_n            total force, less that of the central pillar
//! G1 = (1/2) sum w_n/r_n^3    curvature of the displacement around the centre
//! ```
//!
//! The paper fits them with one coefficient each: `G0 ~ C01 (a/e - 1)`,
//! `G ~ C1 ((a/e)^2 - 1)`, `G1 ~ C11 (1 - e/a)`.

use std::f64::consts::PI;

/// The three lattice sums at one contact radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LatticeSums {
    /// `G0`, effect on the displacement of the central pillar.
    pub displacement: f64,
    /// `G`, forces relative to that on the central pillar.
    pub force: f64,
    /// `G1`, effect on the curvature of the gap around the central pillar.
    pub curvature: f64,
}

impl LatticeSums {
    /// A single pillar: all sums are 0.
    pub const ONE_PILLAR: Self = Self {
        displacement: 0.0,
        force: 0.0,
        curvature: 0.0,
    };

    /// The exact sums over every pillar nearer than `contact_radius` (in pitches). The cost is proportional to its square. NaN for a radius
    /// that is not finite.
    #[must_use]
    pub fn exact(contact_radius: f64) -> Self {
        if !contact_radius.is_finite() {
            return Self {
                displacement: f64::NAN,
                force: f64::NAN,
                curvature: f64::NAN,
            };
        }
        let mut sums = Self::ONE_PILLAR;
        let squared_radius = contact_radius * contact_radius;
        // The nearest point to the origin in row j is at the height (sqrt3/2) j.
        let rows = (contact_radius / 0.75f64.sqrt()).floor() as i64;
        for j in -rows..=rows {
            let row = j as f64;
            let half_width = (squared_radius - 0.75 * row * row).max(0.0).sqrt();
            let first = (-half_width - 0.5 * row).ceil() as i64;
            let last = (half_width - 0.5 * row).floor() as i64;
            for i in first..=last {
                let squared = (i * i + i * j + j * j) as f64;
                if squared > 0.0 && squared < squared_radius {
                    sums.add(squared, squared_radius);
                }
            }
        }
        sums
    }

    fn add(&mut self, squared_distance: f64, squared_radius: f64) {
        let weight = (1.0 - squared_distance / squared_radius).sqrt();
        let inverse = 1.0 / squared_distance.sqrt();
        self.displacement += weight * inverse;
        self.force += weight;
        self.curvature += 0.5 * weight * inverse / squared_distance;
    }
}

/// The coefficients of the one-parameter approximations to [`LatticeSums`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SumCoefficients {
    /// `C01` in `G0 ~ C01 (a/e - 1)`.
    pub displacement: f64,
    /// `C1` in `G ~ C1 ((a/e)^2 - 1)`.
    pub force: f64,
    /// `C11` in `G1 ~ C11 (1 - e/a)`.
    pub curvature: f64,
}

impl SumCoefficients {
    /// The values printed in the paper.
    pub const PAPER: Self = Self {
        displacement: 5.770,
        force: 2.421,
        curvature: 5.519,
    };

    /// The limits of the coefficients for wide contacts: `pi^2/sqrt3` and `4 pi/(3 sqrt3)`, the integrals of the first two sums, and half
    /// the lattice sum of `1/r^3`.
    #[must_use]
    pub fn wide_contact_limit() -> Self {
        Self {
            displacement: PI * PI / 3f64.sqrt(),
            force: 4.0 * PI / (3.0 * 3f64.sqrt()),
            curvature: 0.5 * inverse_power_sum(3.0),
        }
    }

    /// The approximations at `contact_radius` (in pitches); all 0 below one pitch.
    #[must_use]
    pub fn sums(&self, contact_radius: f64) -> LatticeSums {
        let [displacement, force, curvature] = shapes(contact_radius.max(1.0));
        LatticeSums {
            displacement: self.displacement * displacement,
            force: self.force * force,
            curvature: self.curvature * curvature,
        }
    }
}

/// The factors of the coefficients `C01`, `C1`, `C11` at a contact radius in pitches.
fn shapes(contact_radius: f64) -> [f64; 3] {
    [
        contact_radius - 1.0,
        contact_radius * contact_radius - 1.0,
        1.0 - 1.0 / contact_radius,
    ]
}

/// A fit of the approximations to the sums, with the data used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SumFit {
    /// The fitted coefficients.
    pub coefficients: SumCoefficients,
    /// Range of contact radii, in pitches.
    pub range: [f64; 2],
    /// Number of contact radii, equally spaced over the range, ends included.
    pub samples: usize,
}

impl SumFit {
    /// Unweighted least squares on `samples` contact radii, equally spaced over `range` (in pitches, the second the larger).
    ///
    /// Reproduces the coefficients of the paper on [1, 32]; the fourth digit depends on the number of samples. Returns `None` for fewer
    /// than two samples or if the range does not exceed one pitch, below which all sums are 0.
    #[must_use]
    pub fn least_squares(range: [f64; 2], samples: usize) -> Option<Self> {
        let [first, last] = range;
        if samples < 2 || !(first >= 0.0 && last > first.max(1.0) && last.is_finite()) {
            return None;
        }
        let mut products = [0.0; 3];
        let mut squares = [0.0; 3];
        let step = (last - first) / (samples - 1) as f64;
        for k in 0..samples {
            let contact_radius = (first + step * k as f64).max(1.0);
            let sums = LatticeSums::exact(contact_radius);
            let shapes = shapes(contact_radius);
            for (k, sum) in [sums.displacement, sums.force, sums.curvature]
                .into_iter()
                .enumerate()
            {
                products[k] += shapes[k] * sum;
                squares[k] += shapes[k] * shapes[k];
            }
        }
        Some(Self {
            coefficients: SumCoefficients {
                displacement: products[0] / squares[0],
                force: products[1] / squares[1],
                curvature: products[2] / squares[2],
            },
            range,
            samples,
        })
    }
}

/// Sum of `r^-exponent` over a hexagonal lattice of unit pitch without the origin; continued analytically where the sum diverges.
///
/// It is `6 zeta(s) L(s)` with `s = exponent/2` and `L` the Dirichlet series of the character modulo 3 (L. Lorenz, 1871; J. M. Borwein et
/// al., Lattice Sums Then and Now, 2013, section 1.4). An exponent of 1 gives the potential of a lattice of unit charges in a neutralising
/// background. Infinite at 2.
#[must_use]
pub fn inverse_power_sum(exponent: f64) -> f64 {
    let s = 0.5 * exponent;
    let character = 3f64.powf(-s) * (hurwitz_zeta(s, 1.0 / 3.0) - hurwitz_zeta(s, 2.0 / 3.0));
    6.0 * hurwitz_zeta(s, 1.0) * character
}

/// `sum (n + shift)^-s` over `n >= 0`, continued analytically, by Euler-Maclaurin summation
/// (NIST Digital Library of Mathematical Functions, 25.11.5).
fn hurwitz_zeta(s: f64, shift: f64) -> f64 {
    // B_2k/(2k)! for k = 1...8. With 15 terms before it, the remainder is below 1e-17.
    const BERNOULLI: [f64; 8] = [
        1.0 / 12.0,
        -1.0 / 720.0,
        1.0 / 30_240.0,
        -1.0 / 1_209_600.0,
        1.0 / 47_900_160.0,
        -691.0 / 1_307_674_368_000.0,
        1.0 / 74_724_249_600.0,
        -3617.0 / 10_670_622_842_880_000.0,
    ];
    const TERMS: u8 = 15;
    let sum: f64 = (0..TERMS).map(|n| (f64::from(n) + shift).powf(-s)).sum();
    let end = f64::from(TERMS) + shift;
    let mut derivative = s * end.powf(-s - 1.0);
    let mut correction = 0.0;
    let mut order = s;
    for coefficient in BERNOULLI {
        correction += coefficient * derivative;
        derivative *= (order + 1.0) * (order + 2.0) / (end * end);
        order += 2.0;
    }
    sum + end.powf(1.0 - s) / (s - 1.0) + 0.5 * end.powf(-s) + correction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_two_shells_by_hand() {
        // Six neighbours at 1, six at sqrt3.
        let sums = LatticeSums::exact(1.9);
        let near = (1.0 - 1.0 / 3.61f64).sqrt();
        let far = (1.0 - 3.0 / 3.61f64).sqrt();
        let root = 3f64.sqrt();
        assert!((sums.force - 6.0 * (near + far)).abs() < 1e-13);
        assert!((sums.displacement - 6.0 * (near + far / root)).abs() < 1e-13);
        assert!((sums.curvature - 3.0 * (near + far / root.powi(3))).abs() < 1e-13);
        assert_eq!(LatticeSums::exact(1.0), LatticeSums::ONE_PILLAR);
        assert_eq!(LatticeSums::exact(0.3), LatticeSums::ONE_PILLAR);
        assert!(LatticeSums::exact(f64::INFINITY).force.is_nan());
    }

    #[test]
    fn every_pillar_inside_is_counted_once() {
        for radius in [1.5f64, 2.1, 5.3, 17.77] {
            let mut plain = 0.0;
            for i in -25i64..=25 {
                for j in -25i64..=25 {
                    let squared = (i * i + i * j + j * j) as f64;
                    if squared > 0.0 && squared < radius * radius {
                        plain += (1.0 - squared / (radius * radius)).sqrt();
                    }
                }
            }
            assert!((LatticeSums::exact(radius).force / plain - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn least_squares_gives_the_coefficients_of_the_paper() {
        // 497 radii, in steps of 1/16, reproduce every printed digit.
        let fit = SumFit::least_squares([1.0, 32.0], 497)
            .unwrap()
            .coefficients;
        assert!((fit.displacement - SumCoefficients::PAPER.displacement).abs() < 5e-4);
        assert!((fit.force - SumCoefficients::PAPER.force).abs() < 5e-4);
        assert!((fit.curvature - SumCoefficients::PAPER.curvature).abs() < 5e-4);
    }

    #[test]
    fn a_fit_of_nothing_is_none() {
        assert!(SumFit::least_squares([1.0, 32.0], 1).is_none());
        assert!(SumFit::least_squares([0.0, 1.0], 10).is_none());
        assert!(SumFit::least_squares([5.0, 2.0], 10).is_none());
        assert!(SumFit::least_squares([1.0, f64::NAN], 10).is_none());
    }

    #[test]
    fn wide_contacts_approach_the_limits() {
        let limit = SumCoefficients::wide_contact_limit();
        assert!((limit.displacement - 5.698).abs() < 5e-4); // by hand from the formulas
        assert!((limit.force - 2.418).abs() < 5e-4);
        assert!((limit.curvature - 5.517).abs() < 5e-4);
        let radius = 400.0;
        let sums = LatticeSums::exact(radius);
        assert!((sums.force / (limit.force * radius * radius) - 1.0).abs() < 1e-4);
        // G0 approaches its limit minus a constant, the potential of the lattice.
        let constant = inverse_power_sum(1.0);
        let expected = limit.displacement * radius + constant;
        assert!((sums.displacement / expected - 1.0).abs() < 1e-5);
        // The missing tail of G1 is the integral (2/sqrt3) 2 pi ∫ (1 - w) r^-2 dr / 2 = 2 pi/sqrt3 (pi/2)/a
        let tail = PI * PI / 3f64.sqrt() / radius;
        assert!((sums.curvature - (limit.curvature - tail)).abs() < 1e-3 * tail);
    }

    #[test]
    fn fit_of_the_displacement_is_poor_for_narrow_contacts() {
        // 36 % low at 1.5 pitches (by hand: 5.770 * 0.5 for 6 sqrt(1 - 1/2.25)), 4.5 % at 5.
        let deviation = |radius: f64| {
            SumCoefficients::PAPER.sums(radius).displacement
                / LatticeSums::exact(radius).displacement
                - 1.0
        };
        assert!((deviation(1.5) + 0.36).abs() < 0.01);
        assert!((deviation(5.0) + 0.045).abs() < 0.001);
    }

    #[test]
    fn zeta_functions_at_points_with_closed_forms() {
        // zeta(2) = pi^2/6; zeta(3/2) and zeta(1/2): OEIS A078434, A059750.
        assert!((hurwitz_zeta(2.0, 1.0) - PI * PI / 6.0).abs() < 1e-15);
        assert!((hurwitz_zeta(1.5, 1.0) - 2.612_375_348_685_488).abs() < 1e-14);
        assert!((hurwitz_zeta(0.5, 1.0) + 1.460_354_508_809_587).abs() < 1e-14);
        // zeta(s, 1/2) = (2^s - 1) zeta(s)
        let half = (2f64.sqrt() - 1.0) * hurwitz_zeta(0.5, 1.0);
        assert!((hurwitz_zeta(0.5, 0.5) - half).abs() < 1e-14);
    }

    #[test]
    fn inverse_cubes_against_the_sum_itself() {
        // Sum to 2000 pitches; the rest is (2/sqrt3) 2 pi/2000 to about 1e-3 of itself.
        let mut sum = 0.0;
        let reach = 2000i64;
        for i in -2400i64..=2400 {
            for j in -2400i64..=2400 {
                let squared = i * i + i * j + j * j;
                if squared > 0 && squared < reach * reach {
                    let squared = squared as f64;
                    sum += 1.0 / (squared * squared.sqrt());
                }
            }
        }
        let rest = 4.0 * PI / 3f64.sqrt() / reach as f64;
        assert!((inverse_power_sum(3.0) - sum - rest).abs() < 1e-5);
    }
}
