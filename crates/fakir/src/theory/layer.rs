//! Layers of finite thickness: axisymmetric contacts to full precision, and the effect of a thick layer on any contact.
//!
//! Under an axisymmetric pressure `p` within a radius `a`, write `∫ p J_0(k r) r dr = ∫_0^a theta(u) cos(k u) du` (in units of `E*`). Then
//! `theta(u) + (2/pi) ∫_0^a theta(v) [∫_0^∞ (Phi(k) - 1) cos(k u) cos(k v) dk] dv = g(u)/pi`, with `g = delta` under a flat punch and
//! `g = delta - u^2/R`, `theta(a) = 0` under a sphere (approximated by a paraboloid), and the force is `2 pi ∫ theta` (N. N. Lebedev, Ya.
//! S. Ufliand, J. Appl. Math. Mech. 22, 442 (1958)). The kernel is smooth, so that Gauss quadrature converges faster than any power.

pub use crate::halfspace::layer::LayerResponse;
use crate::numerics::convergence::smaller;
use crate::numerics::dense::{Lu, Matrix};
use crate::numerics::quadrature::gauss_legendre;
use crate::problem::layer::WeightedLayer;
use crate::problem::{Layer, Material};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Two bodies in contact, at least one of which is a layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Layers {
    /// `1/E*`, 1/Pa.
    contact_compliance: f64,
    bodies: Vec<(WeightedLayer, LayerResponse)>,
}

/// A sphere on layers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereOnLayers {
    /// `F`, N.
    pub force: f64,
    /// Approach of the backs, m.
    pub indentation: f64,
}

/// Effect of thick layers on a contact compared with half-spaces: a shift and a curvature of the displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LayerShift {
    /// Added to the curvature `1/R` of the lens, 1/m.
    pub curvature: f64,
    /// Added to the indentation for half-spaces and a lens with this additional curvature, m.
    pub indentation: f64,
}

impl Layers {
    /// Creates the pair of bodies; those without a layer are half-spaces.
    #[must_use]
    pub fn new(bodies: [(Material, Option<Layer>); 2]) -> Self {
        let compliance = |body: &(Material, _)| body.0.plane_strain_compliance();
        let layers = WeightedLayer::among(&bodies, 1.0).into_iter();
        Self {
            contact_compliance: bodies.iter().map(compliance).sum(),
            bodies: layers
                .map(|layer| (layer, LayerResponse::of(&layer)))
                .collect(),
        }
    }

    /// `K(r) - 1/(pi r)`, times `pi`: the contribution of the layers to the displacement per force at a distance `r` (m), 1/m.
    #[must_use]
    pub fn far_displacement(&self, distance: f64) -> f64 {
        let of_body = |(layer, response): &(WeightedLayer, LayerResponse)| {
            let t = layer.thickness;
            layer.weight / t * response.far_displacement(distance / t)
        };
        self.bodies.iter().map(of_body).sum()
    }

    /// Ratio of force to indentation of a flat punch of this radius (m), N/m: `2 a E*` on half-spaces.
    #[must_use]
    pub fn flat_punch_stiffness(&self, radius: f64) -> f64 {
        let [(force, _), _] = self.solve(radius);
        2.0 * radius / self.contact_compliance * force
    }

    /// The contact of a sphere with the first radius that has the second one as its contact radius (both m), which must be much smaller.
    #[must_use]
    pub fn sphere(&self, lens_radius: f64, contact_radius: f64) -> SphereOnLayers {
        // Under delta = 1, and under -u^2/R with a^2/R = 1, relative to the flat punch on a half-space.
        let [(flat, at_edge), (bent, bent_at_edge)] = self.solve(contact_radius);
        let sag = contact_radius * contact_radius / lens_radius;
        let indentation = -bent_at_edge / at_edge * sag;
        let stiffness = 2.0 * contact_radius / self.contact_compliance;
        SphereOnLayers {
            force: stiffness * (indentation * flat + sag * bent),
            indentation,
        }
    }

    /// Effect to lowest order in the ratio of contact size to thickness: inside the contact, `Psi` is `Psi_0 + Psi_2 s^2`, of which the
    /// first term is a rigid shift and the second a curvature. `force` is in N; `second_moment` is the integral of the pressure times the
    /// squared distance from the lens axis (N m^2). The error of the force is 2e-4 at a contact radius of a fifth of the thickness and 4e-3
    /// at two fifths; not valid beyond.
    #[must_use]
    pub fn shift(&self, force: f64, second_moment: f64) -> LayerShift {
        let mut shift = LayerShift {
            curvature: 0.0,
            indentation: 0.0,
        };
        for (layer, response) in &self.bodies {
            let (t, weight) = (layer.thickness, layer.weight * self.contact_compliance / PI);
            let bend = weight * response.curvature() / t.powi(3);
            shift.curvature += 2.0 * bend * force;
            shift.indentation += weight * response.shift() / t * force + bend * second_moment;
        }
        shift
    }

    /// For `g = 1` and `g = -u^2` on `0 < u < 1` in units of the radius: the force relative to that of the flat punch on half-spaces, and
    /// `pi theta(1)`.
    fn solve(&self, radius: f64) -> [(f64, f64); 2] {
        let disc = self.disc(radius, &gauss_legendre(self.points(radius)));
        let shapes: [fn(f64) -> f64; 2] = [|_| 1.0, |u| -u * u];
        shapes.map(|shape| {
            let solution = disc.solve(shape);
            (disc.integral(&solution), disc.at_rim(&solution))
        })
    }

    /// Number of Gauss points that resolve the kernel under a disc of this radius (m). The kernel changes over a thickness.
    pub(crate) fn points(&self, radius: f64) -> usize {
        let reaches = self.bodies.iter().map(|body| radius / body.0.thickness);
        40 + (8.0 * reaches.fold(0.0, f64::max)).ceil() as usize
    }

    /// The equation for `theta` under a disc of a radius (m), at the points of a Gauss rule.
    pub(crate) fn disc(&self, radius: f64, rule: &[(f64, f64)]) -> Disc {
        let mut nodes: Vec<(f64, f64)> = rule
            .iter()
            .map(|(node, weight)| (0.5 * (1.0 + node), 0.5 * weight))
            .collect();
        // The rim is not a point of the rule, but its value is needed.
        nodes.push((1.0, 0.0));
        if self.bodies.is_empty() {
            return Disc {
                nodes,
                factors: None,
            };
        }
        let size = nodes.len();
        let mut matrix = Matrix::identity(size);
        for (layer, response) in &self.bodies {
            let scale = radius / layer.thickness;
            let rule = response.rule(2.0 * scale);
            let cosines = Matrix::from_fn(size, rule.len(), |row, k| {
                (rule[k].0 * scale * nodes[row].0).cos()
            });
            let weighted = Matrix::from_fn(rule.len(), size, |k, column| {
                rule[k].1 * cosines[(column, k)] * nodes[column].1
            });
            let factor = 2.0 / PI * layer.weight * scale;
            matrix.add_product(factor, &cosines, &weighted);
        }
        Disc {
            nodes,
            factors: Some(Lu::new(matrix)),
        }
    }
}

/// The equation for `theta` under a disc, discretised at Gauss points. Lengths are in units of the radius.
pub(crate) struct Disc {
    /// Positions and weights. The last is the rim, with weight 0.
    nodes: Vec<(f64, f64)>,
    /// Factors of the matrix; none on half-spaces, where it is the identity.
    factors: Option<Lu>,
}

impl Disc {
    /// `pi theta` at the points for a right-hand side `g`.
    pub(crate) fn solve(&self, shape: impl Fn(f64) -> f64) -> Vec<f64> {
        self.solved(self.nodes.iter().map(|node| shape(node.0)).collect())
    }

    /// The same for a right-hand side given at the points.
    pub(crate) fn solved(&self, mut theta: Vec<f64>) -> Vec<f64> {
        if let Some(factors) = &self.factors {
            factors.solve(&mut theta);
        }
        theta
    }

    /// What layers alone contribute to the left-hand side of the equation for a solution under a disc of a radius (m). They may be a
    /// [change](WeightedLayer::change) of the layers of the disc.
    pub(crate) fn of_layers(
        &self,
        layers: &[WeightedLayer],
        radius: f64,
        solution: &[f64],
    ) -> Vec<f64> {
        let mut sums = vec![0.0; self.nodes.len()];
        for layer in layers {
            let scale = radius / layer.thickness;
            let factor = 2.0 / PI * layer.weight * scale;
            for (wave, weight) in LayerResponse::of(layer).rule(2.0 * scale) {
                let part = self.transformed(solution, wave * scale);
                for (sum, node) in sums.iter_mut().zip(&self.nodes) {
                    *sum += factor * weight * part * (wave * scale * node.0).cos();
                }
            }
        }
        sums
    }

    /// `∫_0^1 pi theta(u) cos(k u) du` of a solution: the transform of its pressure at a wave number, in units of the radius.
    pub(crate) fn transformed(&self, solution: &[f64], wave: f64) -> f64 {
        let parts = self.nodes.iter().zip(solution);
        parts
            .map(|((u, weight), theta)| weight * (wave * u).cos() * theta)
            .sum()
    }

    /// Integral of a solution from the axis to the rim.
    pub(crate) fn integral(&self, solution: &[f64]) -> f64 {
        let parts = self.nodes.iter().zip(solution);
        parts.map(|(node, theta)| node.1 * theta).sum()
    }

    /// Relative displacement of two half-spaces at a distance from the axis (in units of the radius, above 1) for a solution:
    /// `2/pi ∫_0^1 pi theta(u)/sqrt(r^2 - u^2) du`. The value at the rim is integrated in closed form, as the rule is inaccurate near it.
    pub(crate) fn displacement_outside(&self, solution: &[f64], distance: f64) -> f64 {
        let at_rim = self.at_rim(solution);
        let parts = self.nodes.iter().zip(solution);
        let rest: f64 = parts
            .map(|((u, weight), theta)| {
                weight * (theta - at_rim) / (distance * distance - u * u).sqrt()
            })
            .filter(|part| part.is_finite())
            .sum();
        2.0 / PI * (rest + at_rim * distance.recip().asin())
    }

    /// Value of a solution at the rim.
    pub(crate) fn at_rim(&self, solution: &[f64]) -> f64 {
        solution[solution.len() - 1]
    }

    /// `theta(1) - ∫_0^1 theta'(u)/u du`: the pressure on the axis. Integrated by parts, with the solution continued evenly to the axis.
    pub(crate) fn on_axis(&self, solution: &[f64]) -> f64 {
        let [(first, _), (second, _)] = [self.nodes[0], self.nodes[1]];
        let [one, two] = [solution[0], solution[1]];
        // Nearly a parabola in between; what that misses is of the fourth order of the first point's distance from the axis.
        let curvature = (two - one) / (second * second - first * first);
        let middle = one - curvature * first * first;
        let parts = self.nodes.iter().zip(solution);
        let rest: f64 = parts
            .map(|((u, weight), theta)| weight * (theta - middle) / (u * u))
            .sum();
        middle - rest
    }

    /// The pressure at a distance from the axis (in units of the radius, below 1): `theta(1)/sqrt(1 - r^2) - ∫_r^1 theta'(u)/sqrt(u^2 - r^2) du`, with
    /// `u^2 = r^2 + (1 - r^2) t^2`, and the derivative that of the polynomial through all points.
    pub(crate) fn pressure(&self, solution: &[f64], distance: f64) -> f64 {
        const POINTS: usize = 32;
        let rest = (1.0 - distance * distance).sqrt();
        let slopes = |(node, weight): (f64, f64)| {
            let t = 0.5 * (1.0 + node);
            let u = distance.hypot(rest * t);
            0.5 * weight * self.slope(solution, u) / u
        };
        static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(POINTS));
        let inside: f64 = RULE.iter().copied().map(slopes).sum();
        self.at_rim(solution) / rest - rest * inside
    }

    /// The derivative at a place of the polynomial through the solution at the Gauss points, by barycentric interpolation (J.-P. Berrut,
    /// L. N. Trefethen, SIAM Rev. 46, 501 (2004)).
    fn slope(&self, solution: &[f64], place: f64) -> f64 {
        let gauss = self.nodes.len() - 1;
        let (mut sums, mut with_square) = ([0.0; 2], [0.0; 2]);
        let mut sign = 1.0;
        for ((node, weight), value) in self.nodes[..gauss].iter().zip(solution) {
            let away = place - node;
            if away.abs() < 1e-14 {
                return self.slope(solution, place + 1e-9);
            }
            let barycentric = sign * (node * (1.0 - node) * weight).sqrt();
            sums[0] += barycentric / away;
            sums[1] += barycentric / away * value;
            with_square[0] += barycentric / (away * away);
            with_square[1] += barycentric / (away * away) * value;
            sign = -sign;
        }
        let value = sums[1] / sums[0];
        (value * with_square[0] - with_square[1]) / sums[0]
    }

    /// The smallest value of a solution at the points inside of the rim.
    pub(crate) fn least(&self, solution: &[f64]) -> f64 {
        let inside = &solution[..solution.len() - 1];
        inside.iter().copied().fold(f64::INFINITY, smaller)
    }
}

/// Ratio of thickness to radius of a spherical asperity, and relative reduction of its shift compared with that of a flat layer with the
/// same central thickness: finite elements of an incompressible asperity bonded on its flat side, with an error of 2 %.
const CAPS: [[f64; 2]; 7] = [
    [0.0, 0.0],
    [0.136, 0.019],
    [0.227, 0.036],
    [0.341, 0.061],
    [0.455, 0.091],
    [0.682, 0.17],
    [0.909, 0.28],
];

/// Relative reduction of the shift `Psi_0` of a spherical asperity, bonded on its flat side, compared with a flat layer with the same
/// central thickness: interpolated between finite elements of incompressible asperities. `None` beyond their range, for asperities that are
/// nearly hemispheres.
#[must_use]
pub fn asperity_reduction(thickness_over_radius: f64) -> Option<f64> {
    let place = CAPS
        .windows(2)
        .find(|ends| (ends[0][0]..=ends[1][0]).contains(&thickness_over_radius))?;
    let [[x, low], [end, high]] = [place[0], place[1]];
    Some(low + (high - low) * (thickness_over_radius - x) / (end - x))
}
