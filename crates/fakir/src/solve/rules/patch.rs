//! A contact that lies wholly inside one pillar top: the lens touches it in a circle around the
//! lens axis and nothing else.
//!
//! The pressure is expanded on the disc of contact itself instead of the pillar top (any disc
//! inside the top will do; its edge is then irrelevant), and the radius of contact is the one at
//! which the edge coefficient of the pressure vanishes. For a paraboloid this is Hertz's solution
//! with two modes; further modes carry the shape of the sphere.

use crate::halfspace::disc::basis::{BasisEvaluator, UNIT_FORCE, compliances, mode_count};
use crate::numerics::convergence::within;
use crate::numerics::quadrature::hemisphere;
use crate::numerics::roots;
use std::convert::Infallible;

/// Degree of the modes: those of the sphere fall by `(radius/2R)^2` for each step of two.
const DEGREE: usize = 8;

/// Relative error of a value to which the bracket of its radius may close.
const PATCH_TOLERANCE: f64 = 1e-10;

/// A circular contact in equilibrium, in scaled units.
#[derive(Debug, Clone)]
pub(crate) struct Patch {
    /// Radius of contact, pillar radii.
    pub(crate) radius: f64,
    /// Coefficients of `q` on the disc of contact.
    pub(crate) coefficients: Vec<f64>,
    /// Indentation, the shortening of the pillar included.
    pub(crate) indentation: f64,
    pub(crate) force: f64,
}

impl Patch {
    /// The same with lengths in another unit, given in the old one.
    pub(crate) fn scaled(&self, unit: f64) -> Self {
        Self {
            radius: self.radius * unit,
            coefficients: self.coefficients.clone(),
            indentation: self.indentation * unit,
            force: self.force * unit * unit,
        }
    }
}

/// What does not depend on the radius of contact.
pub(crate) struct PatchSolver {
    rule: Vec<([f64; 2], f64)>,
    /// Modes at the points of the rule, row by row.
    values: Vec<f64>,
    /// Modes at the edge.
    edge: Vec<f64>,
    compliance: Vec<f64>,
    column_compliance_ratio: f64,
}

impl PatchSolver {
    pub(crate) fn new(column_compliance_ratio: f64) -> Self {
        let count = mode_count(DEGREE);
        let mut basis = BasisEvaluator::new(DEGREE);
        let rule = hemisphere(DEGREE, 2 * DEGREE + 5);
        let mut values = vec![0.0; rule.len() * count];
        for ((point, _), row) in rule.iter().zip(values.chunks_exact_mut(count)) {
            basis.evaluate(*point, row);
        }
        let mut edge = vec![0.0; count];
        basis.evaluate_polar(0.0, 1.0, [1.0, 0.0], &mut edge);
        Self {
            rule,
            values,
            edge,
            compliance: compliances(DEGREE, 0.0),
            column_compliance_ratio,
        }
    }

    /// Number of modes.
    pub(crate) fn count(&self) -> usize {
        self.edge.len()
    }

    /// The contact of a given radius under a lens of the given shape.
    pub(crate) fn with_radius(&self, radius: f64, sag: impl Fn(f64) -> f64) -> Patch {
        let count = self.edge.len();
        let mut shape = vec![0.0; count];
        for ((point, weight), row) in self.rule.iter().zip(self.values.chunks_exact(count)) {
            let height = sag(radius * point[0].hypot(point[1]));
            for (b, y) in shape.iter_mut().zip(row) {
                *b -= weight * y * height;
            }
        }
        // u = radius lambda c = zeta b1 + shape, and q = 0 at the edge fixes zeta.
        let at_edge = |load: &[f64]| -> f64 {
            load.iter()
                .zip(&self.compliance)
                .zip(&self.edge)
                .map(|((b, lambda), y)| b * y / lambda)
                .sum()
        };
        let unit = UNIT_FORCE * self.edge[0] / self.compliance[0];
        let depth = -at_edge(&shape) / unit;
        shape[0] += depth * UNIT_FORCE;
        let coefficients: Vec<f64> = shape
            .iter()
            .zip(&self.compliance)
            .map(|(b, lambda)| b / (lambda * radius))
            .collect();
        let force = radius * radius * UNIT_FORCE * coefficients[0];
        Patch {
            radius,
            coefficients,
            indentation: depth + 0.5 * self.column_compliance_ratio * force,
            force,
        }
    }

    /// The contact in which a monotone `measure` (indentation, force, ...) takes a value; `None`
    /// if that needs a radius beyond `largest`, or is not found.
    pub(crate) fn find(
        &self,
        largest: f64,
        sag: impl Fn(f64) -> f64,
        measure: impl Fn(&Patch) -> f64,
        value: f64,
    ) -> Option<Patch> {
        let at = |square: f64| self.with_radius(square.max(f64::MIN_POSITIVE).sqrt(), &sag);
        let excess = |square: f64| measure(&at(square)) - value;
        // In the square of the radius indentation is all but linear.
        let largest_square = largest * largest;
        let ends = [(0.0, -value), (largest_square, excess(largest_square))];
        let ends = ends.map(|(position, value)| roots::Point { position, value });
        let found = roots::find(ends, 0.0, |square| Ok::<_, Infallible>(excess(square)));
        let root = found.unwrap_or_else(|never| match never {})?.closest();
        within(root.value.abs(), PATCH_TOLERANCE * value).then(|| at(root.position))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paraboloid_is_hertz() {
        // Johnson, Contact Mechanics, eq. 4.22 to 4.24 with E* = 1: a^2 = R zeta,
        // F = 4 a^3/(3R), q = p0 mu^2 with p0 = 2a/(pi R).
        let lens: f64 = 700.0;
        let solver = PatchSolver::new(0.0);
        for radius in [0.2, 0.5, 0.8] {
            let patch = solver.with_radius(radius, |r| r * r / (2.0 * lens));
            assert!((patch.indentation * lens / (radius * radius) - 1.0).abs() < 1e-13);
            assert!((patch.force * 3.0 * lens / (4.0 * radius.powi(3)) - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn finds_nothing_among_undefined_numbers() {
        let solver = PatchSolver::new(0.4);
        let sag = |r: f64| r * r / 1400.0;
        let find = |measure: &dyn Fn(&Patch) -> f64, value| solver.find(1.0, sag, measure, value);
        assert!(find(&|patch| patch.force, 1e-4).is_some());
        for odd in [f64::NAN, f64::NEG_INFINITY] {
            assert!(find(&|_| odd, 1e-4).is_none());
            assert!(find(&|patch| patch.force, odd).is_none());
            // Only small contacts have the odd value.
            let small = |patch: &Patch| if patch.radius < 0.5 { odd } else { patch.force };
            assert!(find(&small, 1e-9).is_none());
        }
        let none = |_: f64| f64::NAN;
        assert!(solver.find(1.0, none, |patch| patch.force, 1e-4).is_none());
    }

    #[test]
    fn finds_the_radius_of_an_indentation() {
        let lens: f64 = 700.0;
        let solver = PatchSolver::new(0.4);
        let sag = |r: f64| r * r / (lens + (lens * lens - r * r).sqrt());
        let wanted = solver.with_radius(0.37, sag);
        let found = solver
            .find(1.0, sag, |patch| patch.indentation, wanted.indentation)
            .unwrap();
        assert!((found.radius / 0.37 - 1.0).abs() < 1e-12);
        let by_force = solver
            .find(1.0, sag, |patch| patch.force, wanted.force)
            .unwrap();
        assert!((by_force.indentation / wanted.indentation - 1.0).abs() < 1e-12);
        assert!(
            solver
                .find(0.3, sag, |patch| patch.force, wanted.force)
                .is_none()
        );
    }
}
