//! The problem in the units of the solvers: lengths in pillar radii, pressures in units of the
//! reduced modulus, so that forces are in units of `E* (d/2)^2`.

use crate::convergence::smaller;
use crate::disc::basis::{BasisEvaluator, mode_count};
use crate::quadrature::hemisphere;
use crate::system::{HexagonalLattice, Lens, Point, System};

/// Lens radius, in pillar radii, below which the sphere differs from a paraboloid over a single pillar top:
/// by `1/(2R)^2`, so that truncation at degree 2 makes an error of 2e-5 at 8 and 1e-6 here.
pub(crate) const SMALL_LENS: f64 = 40.0;

/// Degree up to which the lens shape is projected on the modes of a pillar top. The sag is
/// quadratic over a pillar top but for terms of order `(d/2R)^2`, which degree 4 carries, and of `(d/2R)^4` and
/// more, which matter for small lenses only.
fn load_degree(problem: &Problem) -> usize {
    if problem.lens.radius < SMALL_LENS {
        8
    } else {
        4
    }
}

/// A system in scaled units.
#[derive(Debug, Clone)]
pub(crate) struct Problem {
    /// Lens radius.
    pub(crate) lens: Lens,
    /// Pillar height.
    pub(crate) height: f64,
    pub(crate) lattice: HexagonalLattice,
    /// `kappa`
    pub(crate) column_compliance_ratio: f64,
    /// Unit of length, `d/2`, m.
    pub(crate) length: f64,
    /// Unit of pressure, `E*`, Pa.
    pub(crate) pressure: f64,
}

impl Problem {
    pub(crate) fn new(system: &System) -> Self {
        let length = 0.5 * system.pillar().diameter;
        Self {
            lens: Lens {
                radius: system.lens().radius / length,
                ..*system.lens()
            },
            height: system.pillar().height / length,
            lattice: HexagonalLattice {
                pitch: system.lattice().pitch / length,
                ..*system.lattice()
            },
            column_compliance_ratio: system.column_compliance_ratio(),
            length,
            pressure: system.reduced_modulus(),
        }
    }

    /// Unit of force, N.
    pub(crate) fn force(&self) -> f64 {
        self.pressure * self.length * self.length
    }

    /// Height of the undeformed lens at a point, above its lowest point.
    pub(crate) fn sag(&self, [x, y]: Point) -> f64 {
        self.lens.sag_at_square(x * x + y * y)
    }

    /// The same with a level brim around the lens at its equator, beyond which it has no lower
    /// side: what presses on pillars. It is a number everywhere, and no contact that is allowed
    /// comes near the brim.
    pub(crate) fn sag_with_brim(&self, point: Point) -> f64 {
        smaller(self.sag(point), self.lens.radius)
    }

    /// Distance of the nearest pillar top from the lens axis; 0 if the axis is on one.
    pub(crate) fn nearest_edge(&self) -> f64 {
        let (i, j) = self.lattice.nearest_pillar([0.0, 0.0]);
        let [x, y] = self.lattice.centre(i, j);
        (x.hypot(y) - 1.0).max(0.0)
    }

    /// Whether the lens reaches the floor before any pillar.
    pub(crate) fn touches_floor_first(&self) -> bool {
        self.lens.sag(self.nearest_edge()) >= self.height
    }

    /// A point in metres.
    pub(crate) fn metres(&self, point: Point) -> Point {
        [point[0] * self.length, point[1] * self.length]
    }
}

/// Projects the lens shape over pillar tops on their modes.
pub(crate) struct LensProjector {
    points: Vec<Point>,
    /// Weight times mode, one row per point.
    weights: Vec<f64>,
    count: usize,
}

impl LensProjector {
    pub(crate) fn new(problem: &Problem, degree: usize) -> Self {
        let degree = degree.max(load_degree(problem));
        let count = mode_count(degree);
        let mut basis = BasisEvaluator::new(degree);
        let rule = hemisphere(degree / 2 + 3, 2 * degree + 5);
        let mut weights = vec![0.0; rule.len() * count];
        for ((point, weight), row) in rule.iter().zip(weights.chunks_exact_mut(count)) {
            basis.evaluate(*point, row);
            row.iter_mut().for_each(|value| *value *= weight);
        }
        Self {
            points: rule.into_iter().map(|(point, _)| point).collect(),
            weights,
            count,
        }
    }

    /// Number of modes it projects on.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// `- ∫ Y_i f dOmega` over the pillar top at `centre`, for as many modes as `load` holds.
    pub(crate) fn project(&self, problem: &Problem, centre: Point, load: &mut [f64]) {
        load.fill(0.0);
        for (point, row) in self
            .points
            .iter()
            .zip(self.weights.chunks_exact(self.count))
        {
            let sag = problem.sag_with_brim([centre[0] + point[0], centre[1] + point[1]]);
            for (value, weight) in load.iter_mut().zip(row) {
                *value -= weight * sag;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disc::basis::UNIT_FORCE;

    #[test]
    fn mean_sag_over_a_pillar_top() {
        // The mean of r^2 with weight 1/mu over the unit disc is 2/3: X^2 + 2/3, over 2R.
        let pillar = crate::system::Pillar {
            diameter: 2.0,
            height: 0.7,
            compliance: crate::system::PillarCompliance::None,
        };
        let material = crate::system::Material::new(1.0, 0.3);
        let radius = 1.0e7;
        let system = System::new(
            Lens { radius, material },
            material,
            crate::system::Texture {
                pillar,
                lattice: HexagonalLattice::new(5.0),
            },
        )
        .unwrap();
        let problem = Problem::new(&system);
        let projector = LensProjector::new(&problem, 2);
        let mut load = vec![0.0; projector.count()];
        projector.project(&problem, [30.0, 40.0], &mut load);
        let expected = -UNIT_FORCE * (2500.0 + 2.0 / 3.0) / (2.0 * radius);
        assert!((load[0] / expected - 1.0).abs() < 1e-9);
        assert!(load[6..].iter().all(|b| b.abs() < 1e-12));
    }
}
