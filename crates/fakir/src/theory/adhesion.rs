//! Closed forms of single adhesive contacts.
//!
//! `E*` is the reduced modulus (Pa), `w` the work of adhesion (J/m^2), `a` the radius of a flat top or of a contact (m). Forces are
//! positive in compression. [`System::kendall_strain`](crate::problem::System::kendall_strain) and
//! [`System::tabor_number`](crate::problem::System::tabor_number) indicate how far a system is from the range of validity.
#![doc = include_str!("../../doc/rendered/adhesion.md")]
//!
//! Sources: K. Kendall, J. Phys. D 4, 1186 (1971) (flat punch); K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301 (1971)
//! (sphere); D. Maugis, J. Colloid Interface Sci. 150, 243 (1992) (range of attraction); D. Tabor, J. Colloid Interface Sci. 58, 2 (1977).

use crate::numerics::roots::{Point, find, least};
use crate::problem::quantity::Requirement;
use crate::problem::{InvalidQuantity, Quantity};
use std::f64::consts::{PI, TAU};

/// Pull-off force of a flat punch, N, negative: `-sqrt(8 pi w E* a^3)`. It is independent of the compliance of a column below the punch and
/// of the machine.
#[must_use]
pub fn kendall_pull_off(modulus: f64, radius: f64, work: f64) -> f64 {
    -(8.0 * PI * work * modulus * radius.powi(3)).sqrt()
}

/// Pull-off force of a flat top centred under a sphere of radius `R`, in full contact: `2 a E* (2 a^2/(3 R)) - sqrt(8 pi w E* a^3)`, N.
#[must_use]
pub fn pull_off_under_lens(modulus: f64, radius: f64, work: f64, lens_radius: f64) -> f64 {
    4.0 * modulus * radius.powi(3) / (3.0 * lens_radius) + kendall_pull_off(modulus, radius, work)
}

/// Force at which the rim of a flat top that is tilted by an angle (rad) relative to the other surface first detaches, N. The edge
/// coefficient there is `F/(2 pi a^2)` minus `2 E* theta/pi` on the side in tension, and reaches `-q_c` with `q_c = sqrt(2 w E*/(pi a))`:
/// `F = -sqrt(8 pi w E* a^3) (1 - 2 E* theta/(pi q_c))`. Beyond this force the top peels.
#[must_use]
pub fn first_yield_of_tilted_top(modulus: f64, radius: f64, work: f64, tilt: f64) -> f64 {
    let critical = (2.0 * work * modulus / (PI * radius)).sqrt();
    let relative = 2.0 * modulus * tilt.abs() / (PI * critical);
    kendall_pull_off(modulus, radius, work) * (1.0 - relative)
}

/// Size of the flaw at the rim of a pillar for which [`corner_ratio`] is stated, and depth up to which the corner determines the stress at
/// a flaw, in pillar radii. For a rigid lens, `G = 1.1215^2 pi l sigma^2/E'` of an edge crack of length `l` (H. Tada, P. C. Paris, G. R.
/// Irwin, The Stress Analysis of Cracks Handbook, 1973) is that of a flat punch, `pi a sigma^2/8 E'`, at `l = 0.1 a`.
const FLAW: f64 = 0.01;
const CORNER_DEPTH: f64 = 1.0 / (8.0 * 1.1215 * 1.1215);

/// Exponent `lambda` of the displacement `r^lambda` at the rim of the frictionless contact of a pillar with a flat lens, where a
/// right-angled corner meets a half-space; the pressure is `r^(lambda - 1)`. `share` is the fraction of the pillar in the contact
/// compliance: 1/2 on rigid pillars, 0.774 for equal bodies, 1 under a rigid lens (J. Dundurs, M. S. Lee, J. Elasticity 2, 109 (1972)). It is
/// the root of `(1 - S) cot(pi lambda) + S sin(pi lambda)/(2 sin^2(pi lambda/2) - 2 lambda^2) = 0`.
pub(crate) fn corner_exponent(share: f64) -> f64 {
    let slope = |lambda: f64| {
        let (sin, cos) = (PI * lambda).sin_cos();
        let (half, _) = (0.5 * PI * lambda).sin_cos();
        let of_corner = sin * sin / (2.0 * (half * half - lambda * lambda));
        (1.0 - share) * cos + share * of_corner
    };
    // Positive at 1/2 and negative at 1, unless one of the bodies is rigid.
    let [mut low, mut high] = [0.5, 1.0];
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if slope(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Bisections of an interval of length 1/2, to rounding.
const HALVINGS: usize = 52;

/// Pull-off force of a pillar with a flaw of 1 % of its radius at the rim, divided by that with the edge of a punch on a half-space. The
/// energy release rate at a flaw of length `l` grows as `l^(2 lambda - 1)`, since the stress at a [corner](corner_exponent) is less
/// singular than at a crack, up to that of the punch at a depth of a tenth of the radius, or at the height of the pillar where that is
/// smaller. `height` is in pillar radii.
pub(crate) fn corner_ratio(share: f64, height: f64) -> f64 {
    let depth = height.min(CORNER_DEPTH);
    (depth / FLAW).max(1.0).powf(corner_exponent(share) - 0.5)
}

/// A circular contact of an adhesive sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdhesiveSphere {
    /// Contact radius, m.
    pub radius: f64,
    /// Force, N.
    pub force: f64,
    /// Indentation, m.
    pub indentation: f64,
}

/// Former name of [`AdhesiveSphere`].
#[deprecated(note = "renamed to `AdhesiveSphere`")]
pub type StickySphere = AdhesiveSphere;

/// The contact of a sphere (approximated by a paraboloid) of radius `R` with a flat surface, within one pillar top:
/// `F = 4 E* a^3/(3 R) - sqrt(8 pi w E* a^3)`, `zeta = a^2/R - sqrt(2 pi w a/E*)`.
#[must_use]
pub fn adhesive_sphere(modulus: f64, lens_radius: f64, work: f64, radius: f64) -> AdhesiveSphere {
    AdhesiveSphere {
        radius,
        force: pull_off_under_lens(modulus, radius, work, lens_radius),
        indentation: radius * radius / lens_radius - (2.0 * PI * work * radius / modulus).sqrt(),
    }
}

/// Former name of [`adhesive_sphere`].
#[deprecated(note = "renamed to `adhesive_sphere`")]
#[must_use]
pub fn sticky_sphere(modulus: f64, lens_radius: f64, work: f64, radius: f64) -> AdhesiveSphere {
    adhesive_sphere(modulus, lens_radius, work, radius)
}

/// Pull-off of a sphere at controlled force: `F = -(3/2) pi w R`.
#[must_use]
pub fn sphere_pull_off_by_force(modulus: f64, lens_radius: f64, work: f64) -> AdhesiveSphere {
    let cube = 9.0 * PI * work * lens_radius * lens_radius / (8.0 * modulus);
    adhesive_sphere(modulus, lens_radius, work, cube.cbrt())
}

/// Pull-off of a sphere at controlled displacement: at 5/9 of the largest tension.
#[must_use]
pub fn sphere_pull_off_by_displacement(
    modulus: f64,
    lens_radius: f64,
    work: f64,
) -> AdhesiveSphere {
    let cube = PI * work * lens_radius * lens_radius / (8.0 * modulus);
    adhesive_sphere(modulus, lens_radius, work, cube.cbrt())
}

/// Former name of [`adhesive_sphere_at_indentation`].
///
/// # Errors
/// Those of the function with the new name.
#[deprecated(note = "renamed to `adhesive_sphere_at_indentation`")]
pub fn sticky_sphere_at_indentation(
    modulus: f64,
    lens_radius: f64,
    work: f64,
    indentation: f64,
) -> Result<Option<AdhesiveSphere>, InvalidQuantity> {
    adhesive_sphere_at_indentation(modulus, lens_radius, work, indentation)
}

/// The contact of a sphere at an indentation (m) on the stable branch: the larger of the two radii of [`adhesive_sphere`] at this
/// indentation. Returns `None` if the sphere is detached, below the indentation of [`sphere_pull_off_by_displacement`]. At indentation 0,
/// where the sphere first touches, it jumps to the radius `(2 pi w R^2/E*)^(1/3)` under a tension of `(4/3) pi w R`.
///
/// # Errors
/// A modulus, lens radius or work of adhesion that is not positive and finite, and an indentation that is not finite.
pub fn adhesive_sphere_at_indentation(
    modulus: f64,
    lens_radius: f64,
    work: f64,
    indentation: f64,
) -> Result<Option<AdhesiveSphere>, InvalidQuantity> {
    Requirement::Positive.check(Quantity::ReducedModulus, modulus)?;
    Requirement::Positive.check(Quantity::LensRadius, lens_radius)?;
    Requirement::Positive.check(Quantity::WorkOfAdhesion, work)?;
    Requirement::Finite.check(Quantity::Indentation, indentation)?;
    let last = sphere_pull_off_by_displacement(modulus, lens_radius, work);
    if indentation < last.indentation {
        return Ok(None);
    }
    let at = |radius: f64| adhesive_sphere(modulus, lens_radius, work, radius).indentation;
    // The sum of Hertz's radius and the radius at first touch is an upper bound.
    let first = (2.0 * PI * work * lens_radius * lens_radius / modulus).cbrt();
    let most = (indentation.max(0.0) * lens_radius).sqrt() + 1.01 * first;
    let ends = [last.radius, most].map(|position| Point {
        position,
        value: at(position) - indentation,
    });
    let root = find(ends, 0.0, |radius| {
        Ok::<_, InvalidQuantity>(at(radius) - indentation)
    })?;
    let radius = root.map_or(last.radius, |root| root.closest().position);
    Ok(Some(adhesive_sphere(modulus, lens_radius, work, radius)))
}

/// Pull-off force of a sphere of radius `R` with a constant attraction over a range `h0 = w/sigma_0` (Maugis's Dugdale model), N, negative.
///
/// It varies from `-2 pi w R` (rigid, long range) to `-(3/2) pi w R` (soft, short range). In Maugis's reduced quantities (`P = F/(pi w R)`,
/// `A = a/(pi w R^2/K)^(1/3)`, `lambda = 2 sigma_0/(pi w K^2/R)^(1/3)`, `K = 4 E*/3`), with `m` the ratio of outer to inner radius of the
/// zone of attraction and `s = sqrt(m^2 - 1)`, `t = atan(s)`:
///
/// ```text
/// (lambda A^2/2) (s + (m^2 - 2) t) + (4 lambda^2 A/3) (s t - m + 1) = 1,
/// P = A^3 - lambda A^2 (s + m^2 t).
/// ```
///
/// # Errors
/// A range that is not positive and finite.
pub fn dugdale_pull_off(
    modulus: f64,
    lens_radius: f64,
    work: f64,
    range: f64,
) -> Result<f64, InvalidQuantity> {
    Requirement::Positive.check(Quantity::AttractionRange, range)?;
    let rigidity = 4.0 / 3.0 * modulus;
    let stress = work / range;
    let lambda = 2.0 * stress / (PI * work * rigidity * rigidity / lens_radius).cbrt();
    let places =
        (0..=SCAN).map(|k| LEAST_ZONE + (MOST_ZONE - LEAST_ZONE) * f64::from(k) / f64::from(SCAN));
    let value = |logarithm: f64| reduced_dugdale_force(lambda, logarithm.exp());
    let start = places
        .min_by(|a, b| value(*a).total_cmp(&value(*b)))
        .unwrap_or(0.0);
    // Refined by golden-section search.
    let step = (MOST_ZONE - LEAST_ZONE) / f64::from(SCAN);
    let best = least([start - step, start + step], SECTIONS, value);
    Ok(PI * work * lens_radius * value(best))
}

/// Logarithms of the width `s` of the zone of attraction that bound the search for the largest tension, number of initial samples, and
/// number of golden-section steps.
const LEAST_ZONE: f64 = -14.0;
const MOST_ZONE: f64 = 14.0;
const SCAN: i32 = 280;
const SECTIONS: usize = 60;

/// `P` in Maugis's model for a width of the zone of attraction.
fn reduced_dugdale_force(lambda: f64, s: f64) -> f64 {
    let (m, t) = (s.hypot(1.0), s.atan());
    // s - t and s t - m + 1 suffer from cancellation for small s.
    let difference = if s < 0.1 {
        let square = s * s;
        s * square
            * (1.0 / 3.0
                - square * (0.2 - square * (1.0 / 7.0 - square * (1.0 / 9.0 - square / 11.0))))
    } else {
        s - t
    };
    let quadratic = 0.5 * lambda * (difference + s * s * t);
    let linear = 4.0 / 3.0 * lambda * lambda * (s * t - s * s / (m + 1.0));
    let radius = 2.0 / (linear + (linear * linear + 4.0 * quadratic).sqrt());
    radius.powi(3) - lambda * radius * radius * (s + m * m * t)
}

/// Height to which the edge of a contact of this radius of curvature is pulled up at a depth, and the depth over which adhesion acts, for a work of
/// adhesion `ratio` relative to the modulus (Johnson, Kendall & Roberts).
pub(crate) fn edge_rise(ratio: f64, radius: f64, depth: f64) -> f64 {
    (TAU * ratio * (radius * (depth + ratio)).sqrt()).sqrt() + (ratio * ratio * radius).cbrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::disc::basis::{BasisEvaluator, UNIT_FORCE, compliances, mode_count};
    use crate::numerics::quadrature::hemisphere;

    const MODULUS: f64 = 4e6 / 3.0;

    /// The disc solved in the modes of a circle of the contact's radius, with the edge coefficient `-q_c`: force and indentation.
    fn disc(radius: f64, work: f64, shape: impl Fn([f64; 2]) -> f64) -> (Vec<f64>, f64) {
        let degree = 2;
        let count = mode_count(degree);
        let mut basis = BasisEvaluator::new(degree);
        let mut load = vec![0.0; count];
        let mut values = vec![0.0; count];
        for (point, weight) in hemisphere(degree, 9) {
            basis.evaluate(point, &mut values);
            let height = shape(point.map(|x| radius * x));
            for (b, y) in load.iter_mut().zip(&values) {
                *b -= weight * y * height;
            }
        }
        let lambda = compliances(degree, 0.0);
        basis.evaluate([1.0, 0.0], &mut values);
        let at_edge = |load: &[f64]| -> f64 {
            let terms = load.iter().zip(&lambda).zip(&values);
            terms.map(|((b, lambda), y)| b / lambda * y).sum::<f64>() * MODULUS / radius
        };
        let critical = (2.0 * work * MODULUS / (PI * radius)).sqrt();
        let unit = UNIT_FORCE * values[0] / lambda[0] * MODULUS / radius;
        let indentation = (-critical - at_edge(&load)) / unit;
        load[0] += UNIT_FORCE * indentation;
        let coefficients = load
            .iter()
            .zip(&lambda)
            .map(|(b, lambda)| b / lambda * MODULUS / radius);
        (coefficients.collect(), indentation)
    }

    fn force_of(coefficients: &[f64], radius: f64) -> f64 {
        UNIT_FORCE * coefficients[0] * radius * radius
    }

    /// The exponent of a square punch of the material of the half-space is 0.774, as in the literature on contact edges (J. Dundurs, M. S. Lee,
    /// J. Elasticity 2, 109 (1972)); the limits are the rigid punch and the free surface that a symmetry plane is to a rigid lens.
    #[test]
    fn corners_are_less_singular_than_punches() {
        for (share, expected) in [(0.0, 0.5), (0.5, 0.7740), (1.0, 1.0)] {
            let found = corner_exponent(share);
            assert!((found - expected).abs() < 5e-5, "{share}: {found}");
        }
        // To first order on a stiff substrate: cot(pi lambda) = -2 S.
        let found = corner_exponent(1e-6) - 0.5;
        assert!((found / (2e-6 / PI) - 1.0).abs() < 1e-5, "{found:e}");
        // Without a pillar there is no corner; an edge crack under a rigid lens is as far from a punch as its depth is small.
        assert!((corner_ratio(0.5, 0.0) - 1.0).abs() < 1e-15);
        let crack = 1.1215_f64.powi(2) * PI * FLAW;
        let expected = (PI / 8.0 / crack).sqrt();
        assert!((corner_ratio(1.0, 3.0) / expected - 1.0).abs() < 1e-12);
    }

    /// Compares Johnson, Kendall and Roberts with the modes of the disc, whose edge satisfies Griffith's criterion, along the whole branch.
    #[test]
    fn adhesive_spheres_agree_with_the_modes_of_a_disc() {
        let (lens, work) = (2.2e-3, 1e-5);
        let largest = sphere_pull_off_by_force(MODULUS, lens, work).radius;
        for part in [0.3, 0.481, 0.63, 1.0, 1.5, 3.0] {
            let radius = part * largest;
            let expected = adhesive_sphere(MODULUS, lens, work, radius);
            let (coefficients, indentation) =
                disc(radius, work, |[x, y]| (x * x + y * y) / (2.0 * lens));
            let force = force_of(&coefficients, radius);
            let scale = 1.5 * PI * work * lens;
            assert!((force - expected.force).abs() < 1e-8 * scale, "{part}");
            let scale = radius * radius / lens;
            assert!(
                (indentation - expected.indentation).abs() < 1e-8 * scale,
                "{part}"
            );
        }
    }

    #[test]
    fn spheres_detach_at_three_halves_and_at_five_ninths_of_it() {
        let (lens, work) = (2.2e-3, 1e-5);
        let by_force = sphere_pull_off_by_force(MODULUS, lens, work);
        let by_displacement = sphere_pull_off_by_displacement(MODULUS, lens, work);
        assert!((by_force.force / (-1.5 * PI * work * lens) - 1.0).abs() < 1e-12);
        assert!((by_displacement.force / by_force.force - 5.0 / 9.0).abs() < 1e-12);
        for (state, measure) in [
            (
                by_force,
                (|s: AdhesiveSphere| s.force) as fn(AdhesiveSphere) -> f64,
            ),
            (by_displacement, |s: AdhesiveSphere| s.indentation),
        ] {
            // Minimum of the branch.
            for part in [0.99, 1.01] {
                let other = adhesive_sphere(MODULUS, lens, work, part * state.radius);
                assert!(measure(other) > measure(state));
            }
        }
    }

    /// First touch by hand: `a^3 = 2 pi w R^2/E*`, `F = -(4/3) pi w R`; round trip for other indentations.
    #[test]
    fn spheres_are_found_at_their_indentation() {
        let (lens, work) = (2.2e-3, 1e-2);
        let at =
            |indentation| adhesive_sphere_at_indentation(MODULUS, lens, work, indentation).unwrap();
        let first = at(0.0).unwrap();
        let by_hand = (2.0 * PI * work * lens * lens / MODULUS).cbrt();
        assert!((first.radius / by_hand - 1.0).abs() < 1e-12);
        assert!((first.force / (-4.0 / 3.0 * PI * work * lens) - 1.0).abs() < 1e-12);
        let last = sphere_pull_off_by_displacement(MODULUS, lens, work);
        for part in [1.0, 1.001, 1.2, 3.0, 300.0] {
            let there = adhesive_sphere(MODULUS, lens, work, part * last.radius);
            let found = at(there.indentation).unwrap();
            assert!((found.radius / there.radius - 1.0).abs() < 1e-7, "{part}");
        }
        assert_eq!(at(1.001 * last.indentation), None);
        assert!(adhesive_sphere_at_indentation(MODULUS, lens, 0.0, 0.0).is_err());
        assert!(adhesive_sphere_at_indentation(MODULUS, lens, work, f64::NAN).is_err());
    }

    /// A tilted flat top in the modes of its disc.
    #[test]
    fn tilted_tops_yield_at_their_rim_first() {
        let (radius, work) = (3e-6, 50e-3);
        for tilt in [0.0, 0.02, 0.1] {
            let (mut coefficients, _) = disc(radius, work, |[x, _]| tilt * x);
            let critical = (2.0 * work * MODULUS / (PI * radius)).sqrt();
            // After a rotation by half a turn, the rim at x = -1 has the former value at x = 1.
            let mut basis = BasisEvaluator::new(2);
            let mut values = vec![0.0; coefficients.len()];
            let mut edge = |coefficients: &[f64], x: f64| -> f64 {
                basis.evaluate([x, 0.0], &mut values);
                coefficients.iter().zip(&values).map(|(c, y)| c * y).sum()
            };
            let least = edge(&coefficients, 1.0).min(edge(&coefficients, -1.0));
            coefficients[0] += (-critical - least) / edge(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0], 1.0);
            let force = force_of(&coefficients, radius);
            let expected = first_yield_of_tilted_top(MODULUS, radius, work, tilt);
            assert!((force / expected - 1.0).abs() < 1e-12, "{force} {expected}");
        }
    }

    /// The limits of Bradley and of Johnson, Kendall and Roberts; between these the tension decreases with the range.
    #[test]
    fn the_range_of_attraction_leads_from_rigid_to_soft() {
        let (lens, work) = (2.2e-3, 1e-3);
        let pull =
            |range: f64| dugdale_pull_off(MODULUS, lens, work, range).unwrap() / (PI * work * lens);
        assert!((pull(1.0) + 2.0).abs() < 1e-6);
        assert!((pull(1e-12) + 1.5).abs() < 1e-6);
        let ranges = (-11..-2).map(|power| pull(10f64.powi(power)));
        let pulls: Vec<f64> = ranges.collect();
        assert!(pulls.windows(2).all(|pair| pair[1] <= pair[0] + 1e-12));
        assert!(dugdale_pull_off(MODULUS, lens, work, 0.0).is_err());
    }
}
