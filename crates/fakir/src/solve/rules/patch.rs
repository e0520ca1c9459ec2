//! A contact inside one pillar top: the lens touches it in a circle around the lens axis and nothing else.
//!
//! The pressure is expanded on the contact disc itself instead of the pillar top (any disc inside the top would do; its edge is then
//! irrelevant). The contact radius is that at which the edge coefficient of the pressure vanishes. For a paraboloid on half-spaces this is
//! Hertz's solution with two modes; further modes represent the shape of the sphere and, on layers, the pressure that a layer much thinner
//! than the contact concentrates around the axis.

use crate::halfspace::disc::basis::{
    BasisEvaluator, UNIT_FORCE, compliances, degree_with, equator_value, mode_count,
};
use crate::halfspace::disc::exterior::Exterior;
use crate::halfspace::layer::LayerResponse;
use crate::numerics::cholesky;
use crate::numerics::convergence::within;
use crate::numerics::quadrature::hemisphere;
use crate::numerics::roots;
use crate::numerics::special::spherical_bessel;
use crate::problem::layer::WeightedLayer;
use std::convert::Infallible;
use std::f64::consts::PI;

/// Degree of the modes on half-spaces: those of the sphere decrease by `(radius/2R)^2` per two degrees.
const DEGREE: usize = 8;

/// Degree of the modes on layers, the highest for which the displacement outside the disc is available.
const LAYERED_DEGREE: usize = 16;

/// Lower degree for the error estimate on layers.
const LOWER_DEGREE: usize = 12;

/// Highest degree of the pressure that is used for the displacement outside of the top, where the higher modes of layers have decayed.
const OUTSIDE_DEGREE: usize = 8;

/// Relative error of a value to which the bracket of its radius may close.
const PATCH_TOLERANCE: f64 = 1e-10;

/// A circular contact in equilibrium, in solver units.
#[derive(Debug, Clone)]
pub(crate) struct Patch {
    /// Contact radius, in pillar radii.
    pub(crate) radius: f64,
    /// Coefficients of `q` on the contact disc.
    pub(crate) coefficients: Vec<f64>,
    /// Indentation, including the shortening of the pillar.
    pub(crate) indentation: f64,
    pub(crate) force: f64,
}

impl Patch {
    /// Converts lengths to another unit, given in the previous unit.
    pub(crate) fn scaled(&self, unit: f64) -> Self {
        Self {
            radius: self.radius * unit,
            coefficients: self.coefficients.clone(),
            indentation: self.indentation * unit,
            force: self.force * unit * unit,
        }
    }

    /// The displacement field around it, on layers in the same unit.
    pub(crate) fn exterior(&self, layers: &[WeightedLayer]) -> Exterior {
        let degree = degree_with(self.coefficients.len()).min(OUTSIDE_DEGREE);
        Exterior::new(degree).with_layers(layers, &[self.radius])
    }
}

/// Quantities that do not depend on the contact radius. Lengths are in units of the radius of the pillar top.
pub(crate) struct PatchSolver {
    degree: usize,
    rule: Vec<([f64; 2], f64)>,
    /// Indices of the axisymmetric modes among all modes of the degree. A contact around the axis has no others.
    places: Vec<usize>,
    /// These modes at the points of the quadrature rule, row by row.
    values: Vec<f64>,
    /// These modes at the edge.
    edge: Vec<f64>,
    compliance: Vec<f64>,
    layers: Vec<(WeightedLayer, LayerResponse)>,
    column_compliance_ratio: f64,
}

impl PatchSolver {
    pub(crate) fn new(column_compliance_ratio: f64, layers: &[WeightedLayer]) -> Self {
        let degree = if layers.is_empty() {
            DEGREE
        } else {
            LAYERED_DEGREE
        };
        Self::of_degree(degree, column_compliance_ratio, layers)
    }

    /// The same with fewer modes, on layers.
    fn coarser(&self) -> Self {
        let layers: Vec<WeightedLayer> = self.layers.iter().map(|(layer, _)| *layer).collect();
        Self::of_degree(LOWER_DEGREE, self.column_compliance_ratio, &layers)
    }

    fn of_degree(degree: usize, column_compliance_ratio: f64, layers: &[WeightedLayer]) -> Self {
        let mut basis = BasisEvaluator::new(degree);
        let rule = hemisphere(degree, 2 * degree + 5);
        let is_round = |place: &usize| basis.modes()[*place].order == 0;
        let places: Vec<usize> = (0..mode_count(degree)).filter(is_round).collect();
        let mut all = vec![0.0; mode_count(degree)];
        let mut values = Vec::with_capacity(rule.len() * places.len());
        for (point, _) in &rule {
            basis.evaluate(*point, &mut all);
            values.extend(places.iter().map(|place| all[*place]));
        }
        basis.evaluate_polar(0.0, 1.0, [1.0, 0.0], &mut all);
        let lambda = compliances(degree, 0.0);
        Self {
            degree,
            rule,
            values,
            edge: places.iter().map(|place| all[*place]).collect(),
            compliance: places.iter().map(|place| lambda[*place]).collect(),
            places,
            layers: layers
                .iter()
                .map(|layer| (*layer, LayerResponse::of(layer)))
                .collect(),
            column_compliance_ratio,
        }
    }

    /// Degree of the coefficients of the patches.
    pub(crate) fn degree(&self) -> usize {
        self.degree
    }

    /// Displacement of every mode by every other, divided by the contact radius, as a lower triangle column by column: `lambda`, and on
    /// layers `4 pi y_l y_l' (-1)^((l - l')/2) sum_b w_b ∫ (phi_b(k t_b) - 1) j_l(k) j_l'(k) dk` with thicknesses in units of that radius,
    /// as for [two discs](crate::halfspace::coupling::pair) at the distance 0.
    fn influence(&self, radius: f64) -> Vec<f64> {
        let count = self.places.len();
        let mut matrix = vec![0.0; count * count];
        for (k, lambda) in self.compliance.iter().enumerate() {
            matrix[k * count + k] = *lambda;
        }
        let mut bessel = vec![0.0; self.degree + 1];
        let mut modes = vec![0.0; count];
        for (layer, response) in &self.layers {
            let inverse = radius / layer.thickness;
            for (x, weight) in response.rule(2.0 * inverse) {
                spherical_bessel(x * inverse, &mut bessel);
                for (k, mode) in modes.iter_mut().enumerate() {
                    // The sign of the equator values is (-1)^(l/2) too.
                    *mode = equator_value(2 * k, 0).abs() * bessel[2 * k];
                }
                let scale = 4.0 * PI * layer.weight * inverse * weight;
                for column in 0..count {
                    for row in column..count {
                        matrix[column * count + row] += scale * modes[column] * modes[row];
                    }
                }
            }
        }
        matrix
    }

    /// The contact of a given radius under a lens of the given shape.
    pub(crate) fn with_radius(&self, radius: f64, sag: impl Fn(f64) -> f64) -> Patch {
        self.with_edge(radius, sag, 0.0)
    }

    /// The same with a given edge coefficient: `-q_c` if the rim is about to detach.
    pub(crate) fn with_edge(&self, radius: f64, sag: impl Fn(f64) -> f64, edge: f64) -> Patch {
        let answers = self.answers(radius, sag);
        let [of_shape, of_unit] = [&answers[0], &answers[1]].map(|answer| {
            let terms = answer.iter().zip(&self.edge);
            terms.map(|(c, y)| c * y).sum::<f64>()
        });
        self.at_depth(radius, &answers, (edge * radius - of_shape) / of_unit)
    }

    /// The contact of a given radius at which `alpha` times its indentation plus `beta` times its force equals `fixed`, for any edge
    /// coefficient.
    pub(crate) fn with_fixed(
        &self,
        radius: f64,
        sag: impl Fn(f64) -> f64,
        [alpha, beta]: [f64; 2],
        fixed: f64,
    ) -> Patch {
        let answers = self.answers(radius, sag);
        let measure = |depth: f64| {
            let patch = self.at_depth(radius, &answers, depth);
            alpha * patch.indentation + beta * patch.force
        };
        // Linear in the depth.
        let start = measure(0.0);
        self.at_depth(radius, &answers, (fixed - start) / (measure(1.0) - start))
    }

    /// Responses, times the radius, to the lens shape and to a unit depth: the influence matrix times these is `shape` and `b1`.
    fn answers(&self, radius: f64, sag: impl Fn(f64) -> f64) -> [Vec<f64>; 2] {
        let count = self.edge.len();
        let mut shape = vec![0.0; count];
        for ((point, weight), row) in self.rule.iter().zip(self.values.chunks_exact(count)) {
            let height = sag(radius * point[0].hypot(point[1]));
            for (b, y) in shape.iter_mut().zip(row) {
                *b -= weight * y * height;
            }
        }
        let mut unit = vec![0.0; count];
        unit[0] = UNIT_FORCE;
        let mut factor = self.influence(radius);
        if cholesky::factorise(&mut factor, count) {
            for load in [&mut shape, &mut unit] {
                cholesky::solve_lower(&factor, count, load);
                cholesky::solve_upper(&factor, count, load);
            }
        } else {
            shape.fill(f64::NAN);
        }
        [shape, unit]
    }

    fn at_depth(&self, radius: f64, [shape, unit]: &[Vec<f64>; 2], depth: f64) -> Patch {
        let mut coefficients = vec![0.0; mode_count(self.degree)];
        for ((place, shape), unit) in self.places.iter().zip(shape).zip(unit) {
            coefficients[*place] = (shape + depth * unit) / radius;
        }
        let force = radius * radius * UNIT_FORCE * coefficients[0];
        Patch {
            radius,
            coefficients,
            indentation: depth + 0.5 * self.column_compliance_ratio * force,
            force,
        }
    }

    /// Elastic energy of a contact: half the work of the pressure on the displacement that it causes, including that of the column.
    pub(crate) fn energy(&self, patch: &Patch) -> f64 {
        let count = self.places.len();
        let influence = self.influence(patch.radius);
        let c: Vec<f64> = (self.places.iter().map(|place| patch.coefficients[*place])).collect();
        let mut twice = 0.0;
        for column in 0..count {
            twice += influence[column * count + column] * c[column] * c[column];
            for row in column + 1..count {
                twice += 2.0 * influence[column * count + row] * c[column] * c[row];
            }
        }
        let column = 0.5 * self.column_compliance_ratio * patch.force * patch.force;
        0.5 * (patch.radius.powi(3) * twice + column)
    }

    /// Relative errors of force and radius at an indentation due to the degree of the modes on layers: the change with fewer modes. The
    /// force is at most proportional to the square of the indentation.
    pub(crate) fn errors(&self, patch: &Patch, sag: impl Fn(f64) -> f64) -> [f64; 2] {
        if self.layers.is_empty() {
            return [0.0; 2];
        }
        let coarser = self.coarser().with_radius(patch.radius, sag);
        let deeper = (coarser.indentation / patch.indentation - 1.0).abs();
        let force = (coarser.force / patch.force - 1.0).abs();
        [force + 2.0 * deeper, deeper]
    }

    /// The contact at which a monotone `measure` (indentation, force, ...) has a value; `None` if that needs a radius beyond `largest`, or
    /// is not found.
    pub(crate) fn find(
        &self,
        largest: f64,
        sag: impl Fn(f64) -> f64,
        measure: impl Fn(&Patch) -> f64,
        value: f64,
    ) -> Option<Patch> {
        let at = |square: f64| self.with_radius(square.max(f64::MIN_POSITIVE).sqrt(), &sag);
        let excess = |square: f64| measure(&at(square)) - value;
        // The indentation is almost linear in the square of the radius.
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
    use crate::halfspace::coupling::pair::PairCoupling;
    use crate::halfspace::layer::tests::film;
    use crate::problem::{Layer, Material};

    #[test]
    fn paraboloid_is_hertz() {
        // Johnson, Contact Mechanics, eq. 4.22 to 4.24 with E* = 1: a^2 = R zeta, F = 4 a^3/(3R), q = p0 mu^2 with p0 = 2a/(pi R).
        let lens: f64 = 700.0;
        let solver = PatchSolver::new(0.0, &[]);
        for radius in [0.2, 0.5, 0.8] {
            let patch = solver.with_radius(radius, |r| r * r / (2.0 * lens));
            assert!((patch.indentation * lens / (radius * radius) - 1.0).abs() < 1e-13);
            assert!((patch.force * 3.0 * lens / (4.0 * radius.powi(3)) - 1.0).abs() < 1e-13);
        }
    }

    /// The influence of the modes compared to that of a pillar on itself, which is tabulated for lattices on layers.
    #[test]
    fn layers_act_on_the_patch_as_on_a_pillar() {
        let film = film();
        let solver = PatchSolver::of_degree(8, 0.0, &[film]);
        let pair = PairCoupling::new(8).with_layers(&[film]);
        let block = pair.own_block(1.0).unwrap();
        let count = solver.places.len();
        let influence = solver.influence(1.0);
        for (column, place) in solver.places.iter().enumerate() {
            for (row, other) in solver.places.iter().enumerate().skip(column) {
                let own = if row == column {
                    solver.compliance[row]
                } else {
                    0.0
                };
                let expected = own + block[other * mode_count(8) + place];
                let found = influence[column * count + row];
                assert!(
                    (found - expected).abs() < 1e-12,
                    "{row} {column}: {found} {expected}"
                );
            }
        }
    }

    /// Clapeyron's theorem: `dU/dzeta = F` along contacts in equilibrium without adhesion.
    #[test]
    fn energy_is_the_work_of_the_force() {
        let film = film();
        for layers in [&[][..], &[film]] {
            let solver = PatchSolver::new(0.7, layers);
            let sag = |r: f64| r * r / 1400.0;
            let [low, middle, high] = [0.4999, 0.5, 0.5001].map(|a| solver.with_radius(a, sag));
            let work = solver.energy(&high) - solver.energy(&low);
            let force = work / (high.indentation - low.indentation);
            assert!(
                (force / middle.force - 1.0).abs() < 1e-6,
                "{force} {}",
                middle.force
            );
        }
    }

    /// A contact much larger than the thickness of a compressible layer behaves like independent springs: `F = pi M zeta^2 R/t`,
    /// `a^2 = 2 R zeta`, with the confined modulus `M` (K. L. Johnson, Contact Mechanics, section 5.8).
    #[test]
    fn a_thin_layer_is_a_bed_of_springs() {
        let layer = (Material::new(1.0, 0.3), Some(Layer::new(0.02)));
        let thin = WeightedLayer::among(&[layer], 1.0)[0];
        let solver = PatchSolver::new(0.0, &[thin]);
        let lens = 700.0;
        let patch = solver.with_radius(0.5, |r| r * r / (2.0 * lens));
        let squeezed = 0.5 * 0.5 / (2.0 * lens);
        let force = PI * squeezed * squeezed * lens / thin.squeeze();
        assert!(
            (patch.indentation / squeezed - 1.0).abs() < 0.05,
            "{}",
            patch.indentation / squeezed
        );
        assert!(
            (patch.force / force - 1.0).abs() < 0.1,
            "{}",
            patch.force / force
        );
        let [error, _] = solver.errors(&patch, |r| r * r / (2.0 * lens));
        assert!(error < 0.01, "{error}");
    }

    #[test]
    fn finds_nothing_among_undefined_numbers() {
        let solver = PatchSolver::new(0.4, &[]);
        let sag = |r: f64| r * r / 1400.0;
        let find = |measure: &dyn Fn(&Patch) -> f64, value| solver.find(1.0, sag, measure, value);
        assert!(find(&|patch| patch.force, 1e-4).is_some());
        for odd in [f64::NAN, f64::NEG_INFINITY] {
            assert!(find(&|_| odd, 1e-4).is_none());
            assert!(find(&|patch| patch.force, odd).is_none());
            // Only small contacts have the non-finite value.
            let small = |patch: &Patch| if patch.radius < 0.5 { odd } else { patch.force };
            assert!(find(&small, 1e-9).is_none());
        }
        let none = |_: f64| f64::NAN;
        assert!(solver.find(1.0, none, |patch| patch.force, 1e-4).is_none());
    }

    #[test]
    fn finds_the_radius_of_an_indentation() {
        let lens: f64 = 700.0;
        let solver = PatchSolver::new(0.4, &[]);
        let sag = |r: f64| r * r / (lens + (lens * lens - r * r).sqrt());
        let target = solver.with_radius(0.37, sag);
        let found = solver
            .find(1.0, sag, |patch| patch.indentation, target.indentation)
            .unwrap();
        assert!((found.radius / 0.37 - 1.0).abs() < 1e-12);
        let by_force = solver
            .find(1.0, sag, |patch| patch.force, target.force)
            .unwrap();
        assert!((by_force.indentation / target.indentation - 1.0).abs() < 1e-12);
        assert!(
            solver
                .find(0.3, sag, |patch| patch.force, target.force)
                .is_none()
        );
    }
}
