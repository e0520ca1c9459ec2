//! The lens shape over a pillar top, expanded in its pressure modes.

use super::mode_rule::ModeRule;
use crate::problem::scaled::SMALL_LENS;
use crate::problem::{Point, ShapedLens};

/// Degree up to which the lens shape is projected on the modes of a pillar top. The sag is quadratic over a pillar top, except for terms of
/// order `(d/2R)^2`, which degree 4 includes, and terms of order `(d/2R)^4` and higher, which are significant for small lenses only.
fn load_degree(lens: &ShapedLens) -> usize {
    if lens.quadratic_radius() < SMALL_LENS {
        8
    } else {
        4
    }
}

/// Projects the lens shape over pillar tops on their modes.
pub(crate) struct LensProjector {
    rule: ModeRule,
}

impl LensProjector {
    pub(crate) fn new(lens: &ShapedLens, degree: usize) -> Self {
        let degree = degree.max(load_degree(lens));
        Self {
            rule: ModeRule::new(degree, degree / 2 + 3, 2 * degree + 5),
        }
    }

    /// Number of modes in the projection.
    pub(crate) fn count(&self) -> usize {
        self.rule.count()
    }

    /// Computes `- ∫ Y_i f dOmega` over the pillar top with this centre and radius, for as many modes as the length of `load`.
    pub(crate) fn project(&self, lens: &ShapedLens, centre: Point, radius: f64, load: &mut [f64]) {
        self.project_function(centre, radius, |at, _| -lens.sag_with_brim(at), load);
    }

    /// `∫ Y_i g dOmega` of a function `g` of the position on this top, which is given relative to the lens axis and on the unit disc.
    pub(crate) fn project_function(
        &self,
        centre: Point,
        radius: f64,
        function: impl Fn(Point, Point) -> f64,
        load: &mut [f64],
    ) {
        self.rule.project((centre, radius), function, load);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::disc::basis::UNIT_FORCE;
    use crate::problem::scaled::Scene;
    use crate::problem::{HexagonalLattice, Lens, System};

    #[test]
    fn mean_sag_over_a_pillar_top() {
        // The mean of r^2 with weight 1/mu over the unit disc is 2/3: X^2 + 2/3, over 2R.
        let pillar = crate::problem::Pillar {
            diameter: 2.0,
            height: 0.7,
            compliance: crate::problem::PillarCompliance::None,
        };
        let material = crate::problem::Material::new(1.0, 0.3);
        let radius = 1.0e7;
        let system = System::new(
            Lens { radius, material },
            material,
            crate::problem::system::PillarPattern::new(pillar, HexagonalLattice::new(5.0)),
        )
        .unwrap();
        let problem = Scene::new(&system);
        let projector = LensProjector::new(&problem.lens, 2);
        let mut load = vec![0.0; projector.count()];
        projector.project(&problem.lens, [30.0, 40.0], 1.0, &mut load);
        let expected = -UNIT_FORCE * (2500.0 + 2.0 / 3.0) / (2.0 * radius);
        assert!((load[0] / expected - 1.0).abs() < 1e-9);
        assert!(load[6..].iter().all(|b| b.abs() < 1e-12));
    }
}
