//! A paraboloid pressed on an elastic half-space covered by a layer of springs.
//!
//! On the unit disc, with `K p (x) = (1/pi) ∫ p(x')/|x - x'| dA'` and the spring compliance `b`, in units of the contact radius and the
//! half-space compliance, the pressure satisfies
//!
//! ```text
//! K p + b p = Z - rho^2  for rho < 1,   p(1) = 0,
//! ```
//!
//! where the edge condition determines `Z`. Hertz's contact is `b = 0`, a Winkler foundation `b -> infinity`.
//!
//! *Operator.* Copson's transform `g(t) = (2/pi) ∫_t^1 p(r) r/sqrt(r^2 - t^2) dr` converts the energy to
//! `∫ p K p dA = 2 pi^2 ∫_0^1 g^2 dt`, and the load terms to `∫ p dA = 2 pi ∫ g dt` and `∫ p rho^2 dA = 4 pi ∫ g t^2 dt` (I. N. Sneddon,
//! Mixed Boundary Value Problems in Potential Theory, 1966, chapters 3 and 4).
//!
//! *Basis.* Polynomials in `s = (1 - rho^2)^(1/6)`: they represent Hertz's pressure (`s^3`) and Winkler's (`s^6`) exactly, and the power
//! resolves the logarithms and the boundary layer, of width `b`, at the edge. Orthonormalised on the disc, they are Jacobi polynomials. The
//! singular values of `p -> sqrt2 pi g` diagonalise `K` once for all `b`; a contact then costs one pass over the modes.
//!
//! *Edge condition.* `p(1)` itself converges slowly. Under a dilation, `K` scales as a length; with `(K + b) q_1 = 1`,
//! `(K + b) q_2 = rho^2` and `p = Z q_1 - q_2`, testing the dilated equation with `q_1` gives, exactly when `p(1) = 0`,
//!
//! ```text
//! Z = (3 ∫ q_2 dA + b ∫ q_1 q_2 dA) / (∫ q_1 dA + b ∫ q_1^2 dA),
//! ```
//!
//! in which every term converges fast.
//!
//! *Layers.* If bodies are [layers](crate::halfspace::layer), an operator `D` is added to `K`. With `P(k) = ∫ g cos(k t) dt`, the transform
//! of the pressure, `∫ p D p dA = 4 pi ∫ (Phi(k t/a) - 1) P^2 dk`, a full matrix in the modes of `K`. It depends on the contact radius,
//! with `D' = a dD/da`, so that under a dilation
//!
//! ```text
//! Z = (3 ∫ q_2 dA + b ∫ q_1 q_2 dA - ∫ q_1 D' q_2 dA) / (∫ q_1 dA + b ∫ q_1^2 dA - ∫ q_1 D' q_1 dA).
//! ```

use crate::halfspace::layer::LayerResponse;
use crate::numerics::dense::{Lu, Matrix};
use crate::numerics::quadrature::gauss_legendre;
use crate::numerics::svd::orthogonalise;
use crate::numerics::vector::dot;
use crate::problem::layer::WeightedLayer;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// The basis is polynomials in `(1 - rho^2)^(1/(2 EDGE_POWER))`.
const EDGE_POWER: i32 = 3;

/// Number of modes for results: errors of 2e-9 in force and indentation and 1e-8 in central pressure for any spring compliance, and 1e-12
/// for `b >= 0.1`.
const MODES: usize = 28;

/// Number of modes of the coarser solution, for the error estimate.
const COARSE_MODES: usize = 24;

/// Number of polynomials for an initial guess.
const ROUGH_MODES: usize = 8;

/// A contact of unit radius: lengths, forces and pressures are scaled so that neither the contact radius `a`, nor the lens radius `R`, nor
/// the half-space compliance `c` appears.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct UnitContact {
    /// `zeta R/a^2`: 1 for Hertz, 1/2 for Winkler.
    pub(super) indentation: f64,
    /// `F c R/a^3`: 4/3 for Hertz, `pi/(4 b)` for Winkler.
    pub(super) force: f64,
    /// `p(0) c R/a`: `2/pi` for Hertz, `1/(2 b)` for Winkler.
    pub(super) central_pressure: f64,
}

/// A mode of `K`: an eigenfunction, orthonormal on the unit disc, represented by the quantities that a contact needs.
#[derive(Debug, Clone, Copy)]
struct Mode {
    eigenvalue: f64,
    /// Integral over the disc.
    uniform: f64,
    /// Integral over the disc, weighted with `rho^2`.
    parabolic: f64,
    /// Value at the centre.
    centre: f64,
}

/// The operator `K` in a finite basis, diagonalised.
#[derive(Debug)]
pub(super) struct LayerModes {
    modes: Vec<Mode>,
    /// `t`, and the factor that converts the columns to terms of `∫ g dt`.
    nodes: Vec<[f64; 2]>,
    /// `sqrt2 pi g` of every mode at the nodes, times the square root of the weights.
    columns: Matrix,
}

impl LayerModes {
    /// The table for results, created on first use.
    pub(super) fn fine() -> &'static Self {
        static TABLE: OnceLock<LayerModes> = OnceLock::new();
        TABLE.get_or_init(|| Self::new(MODES))
    }

    /// The table for error estimates, created on first use.
    pub(super) fn coarse() -> &'static Self {
        static TABLE: OnceLock<LayerModes> = OnceLock::new();
        TABLE.get_or_init(|| Self::new(COARSE_MODES))
    }

    /// The table for an initial guess: four digits, at a fiftieth of the time to create it.
    pub(super) fn rough() -> &'static Self {
        static TABLE: OnceLock<LayerModes> = OnceLock::new();
        TABLE.get_or_init(|| Self::new(ROUGH_MODES))
    }

    /// `K` in polynomials of degree below `count`.
    fn new(count: usize) -> Self {
        let Discretised {
            nodes,
            mut columns,
            uniform,
            parabolic,
        } = Discretised::new(count);
        let rotation = orthogonalise(&mut columns);
        let mut at_centre = vec![0.0; count];
        basis_values(1.0, &mut at_centre);
        let modes = (0..count)
            .map(|k| (columns.column(k), rotation.column(k)))
            .map(|(column, weights)| Mode {
                eigenvalue: dot(column, column),
                uniform: dot(weights, &uniform),
                parabolic: dot(weights, &parabolic),
                centre: dot(weights, &at_centre),
            })
            .collect();
        Self {
            modes,
            nodes,
            columns,
        }
    }

    /// The contact on layers, with thicknesses in contact radii.
    pub(super) fn contact_on_layers(
        &self,
        relative_compliance: f64,
        layers: &[WeightedLayer],
    ) -> UnitContact {
        let b = relative_compliance;
        let count = self.modes.len();
        let [added, changing] = self.layer_matrices(layers);
        let operator = Matrix::from_fn(count, count, |row, column| {
            let own = if row == column {
                self.modes[row].eigenvalue + b
            } else {
                0.0
            };
            own + added[(row, column)]
        });
        let mut q = Matrix::from_fn(count, 2, |row, load| {
            let mode = &self.modes[row];
            [mode.uniform, mode.parabolic][load]
        });
        let factors = Lu::new(operator);
        (0..2).for_each(|load| factors.solve(q.column_mut(load)));
        let turned = &changing * &q;
        let sum = |of: &dyn Fn(usize) -> f64| (0..count).map(of).sum::<f64>();
        let whole = |load| sum(&|row| self.modes[row].uniform * q[(row, load)]);
        let centre = |load| sum(&|row| self.modes[row].centre * q[(row, load)]);
        let edge = |load| sum(&|row| q[(row, 0)] * (b * q[(row, load)] - turned[(row, load)]));
        let load = (3.0 * whole(1) + edge(1)) / (whole(0) + edge(0));
        UnitContact {
            indentation: 0.5 * load,
            force: 0.5 * (load * whole(0) - whole(1)),
            central_pressure: 0.5 * (load * centre(0) - centre(1)),
        }
    }

    /// `D` and `D'` in the basis of the modes.
    fn layer_matrices(&self, layers: &[WeightedLayer]) -> [Matrix; 2] {
        let count = self.modes.len();
        let mut matrices = [0, 1].map(|_| Matrix::zeros(count, count));
        for layer in layers {
            let response = LayerResponse::of(layer);
            let inverse = layer.thickness.recip();
            let rule = response.nodes(2.0 * inverse);
            let waves = Matrix::from_fn(rule.len(), self.nodes.len(), |k, node| {
                let [t, factor] = self.nodes[node];
                factor * (rule[k].0 * inverse * t).cos()
            });
            let transforms = &waves * &self.columns;
            let transposed = transforms.transposed();
            let factor = 4.0 * PI * layer.weight * inverse;
            let weights: [&dyn Fn(f64) -> f64; 2] =
                [&|x| response.deficit(x), &|x| -x * response.slope(x)];
            for (matrix, of) in matrices.iter_mut().zip(weights) {
                let of_wave = |(x, weight): &(f64, f64)| factor * weight * of(*x);
                let of_waves: Vec<f64> = rule.iter().map(of_wave).collect();
                let weighted = Matrix::from_fn(rule.len(), count, |k, mode| {
                    of_waves[k] * transforms[(k, mode)]
                });
                matrix.add_product(1.0, &transposed, &weighted);
            }
        }
        matrices
    }

    /// The contact with springs of the compliance `b = relative_compliance`, at least 0.
    pub(super) fn contact(&self, relative_compliance: f64) -> UnitContact {
        let b = relative_compliance;
        let mut q1_sum = 0.0; // ∫ q_1 dA; likewise below
        let mut q2_sum = 0.0;
        let mut b_q1_q1 = 0.0;
        let mut b_q1_q2 = 0.0;
        let mut q1_centre = 0.0;
        let mut q2_centre = 0.0;
        for mode in &self.modes {
            let response = 1.0 / (b + mode.eigenvalue);
            let springs = b * response; // b/(b + lambda): does not overflow
            let q1 = mode.uniform * response;
            let q2 = mode.parabolic * response;
            q1_sum += mode.uniform * q1;
            q2_sum += mode.uniform * q2;
            b_q1_q1 += springs * mode.uniform * q1;
            b_q1_q2 += springs * mode.uniform * q2;
            q1_centre += mode.centre * q1;
            q2_centre += mode.centre * q2;
        }
        let load = (3.0 * q2_sum + b_q1_q2) / (q1_sum + b_q1_q1);
        UnitContact {
            indentation: 0.5 * load,
            force: 0.5 * (load * q1_sum - q2_sum),
            central_pressure: 0.5 * (load * q1_centre - q2_centre),
        }
    }

    /// `(dF/dzeta) c/a`, the stiffness of a flat punch of unit radius: 2 without springs.
    #[cfg(test)]
    fn stiffness(&self, relative_compliance: f64) -> f64 {
        self.modes
            .iter()
            .map(|mode| mode.uniform * mode.uniform / (relative_compliance + mode.eigenvalue))
            .sum()
    }
}

/// `sqrt2 pi g` of every basis function at the nodes, times the square root of the weights, so that products of columns are
/// `∫ phi_i K phi_j dA`; and the load integrals.
struct Discretised {
    nodes: Vec<[f64; 2]>,
    columns: Matrix,
    uniform: Vec<f64>,
    parabolic: Vec<f64>,
}

impl Discretised {
    fn new(count: usize) -> Self {
        let rule = arc_rule(2 * count + 12);
        let mut columns = Matrix::zeros(rule.len(), count);
        let mut uniform = vec![0.0; count];
        let mut parabolic = vec![0.0; count];
        let mut nodes = Vec::with_capacity(rule.len());
        let mut values = vec![0.0; count];
        let mut transform = vec![0.0; count];
        for (node, &[z, weight]) in rule.iter().enumerate() {
            // t = sqrt(1 - z^(2k)), g = (2 z^k/pi) ∫_0^1 phi(z v) dw(v)
            transform.fill(0.0);
            for &[v, inner_weight] in &rule {
                basis_values(z * v, &mut values);
                for (sum, value) in transform.iter_mut().zip(&values) {
                    *sum += inner_weight * value;
                }
            }
            let t_squared = 1.0 - z.powi(2 * EDGE_POWER);
            nodes.push([t_squared.sqrt(), (0.5 * weight).sqrt() / PI]);
            for j in 0..count {
                let g = 2.0 / PI * z.powi(EDGE_POWER) * transform[j];
                columns[(node, j)] = PI * (2.0 * weight).sqrt() * g;
                uniform[j] += 2.0 * PI * weight * g;
                parabolic[j] += 4.0 * PI * weight * g * t_squared;
            }
        }
        Self {
            nodes,
            columns,
            uniform,
            parabolic,
        }
    }
}

/// Nodes `v` in (0, 1) and weights of `∫ f(v) k v^(2k-1)/sqrt(1 - v^(2k)) dv`, `k` the edge power: Gauss-Legendre in `sqrt(1 - v)`, where
/// the integrand is smooth.
fn arc_rule(count: usize) -> Vec<[f64; 2]> {
    gauss_legendre(count)
        .into_iter()
        .map(|(x, weight)| {
            let (tau, weight) = (0.5 * (1.0 + x), 0.5 * weight);
            let v = 1.0 - tau * tau;
            let geometric: f64 = (0..2 * EDGE_POWER).map(|power| v.powi(power)).sum();
            let density = 2.0 * f64::from(EDGE_POWER) * v.powi(2 * EDGE_POWER - 1);
            [v, weight * density / geometric.sqrt()]
        })
        .collect()
}

/// The basis at `s`: Jacobi polynomials `P_j^(0, 2k-1)(2s - 1)`, orthonormal with the area element `2 pi k s^(2k-1) ds` of the disc, `k`
/// the edge power.
///
/// Recurrence: NIST Digital Library of Mathematical Functions, 18.9.2.
fn basis_values(s: f64, values: &mut [f64]) {
    let edge_power = f64::from(EDGE_POWER);
    let beta = 2.0 * edge_power - 1.0;
    let x = 2.0 * s - 1.0;
    let (mut previous, mut current) = (0.0, 1.0);
    for (j, value) in values.iter_mut().enumerate() {
        let j = j as f64;
        *value = current * ((j + edge_power) / (PI * edge_power)).sqrt();
        let c = 2.0 * j + beta;
        // The general step divides by j: its j = 0 form is P_1 = 1 + (beta + 2)(x - 1)/2.
        let next = if j < 0.5 {
            1.0 + 0.5 * (beta + 2.0) * (x - 1.0)
        } else {
            ((c + 1.0) * (c * (c + 2.0) * x - beta * beta) * current
                - 2.0 * j * (j + beta) * (c + 2.0) * previous)
                / (2.0 * (j + 1.0) * (j + 1.0 + beta) * c)
        };
        previous = current;
        current = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compliances from zero (no springs) over twenty decades to springs alone.
    fn compliances() -> impl Iterator<Item = f64> {
        std::iter::once(0.0).chain((-50..=30).map(|step| 10f64.powf(0.2 * f64::from(step))))
    }

    fn largest_difference(one: UnitContact, other: UnitContact) -> f64 {
        let relative = |x: f64, y: f64| (x / y - 1.0).abs();
        relative(one.indentation, other.indentation)
            .max(relative(one.force, other.force))
            .max(relative(one.central_pressure, other.central_pressure))
    }

    #[test]
    fn hertz_without_springs() {
        // K. L. Johnson, Contact Mechanics, section 4.2: zeta = a^2/R, F = 4 a^3/(3 c R),
        // p(0) = 2 a/(pi c R).
        let hertz = UnitContact {
            indentation: 1.0,
            force: 4.0 / 3.0,
            central_pressure: 2.0 / PI,
        };
        assert!(largest_difference(LayerModes::fine().contact(0.0), hertz) < 2e-9);
        assert!(largest_difference(LayerModes::fine().contact(1e-12), hertz) < 2e-9);
    }

    #[test]
    fn hertz_on_layers() {
        // A sphere on a layer without springs, by the equation of `theory::layer`, which shares only `phi`. The error of the modes is 2e-9
        // on half-spaces.
        use crate::problem::layer::WeightedLayer;
        use crate::problem::{Base, Layer, Material};
        use crate::theory::layer::Layers;
        let rubber = Material::new(1.0, 0.5);
        let soft = Material::new(0.3, 0.4);
        let frictionless = |thickness| Layer {
            thickness,
            base: Base::Frictionless,
        };
        for thickness in [20.0, 2.0, 1.0, 0.5] {
            for lens in [None, Some(frictionless(1.3))] {
                let bodies = [(rubber, Some(Layer::new(thickness))), (soft, lens)];
                let compliance = rubber.plane_strain_compliance() + soft.plane_strain_compliance();
                // Contact radius 1 under a lens of radius 1e3.
                let exact = Layers::new(bodies).sphere(1e3, 1.0);
                let layers = WeightedLayer::among(&bodies, 1.0);
                let found = LayerModes::fine().contact_on_layers(0.0, &layers);
                let force = found.force / (exact.force * compliance * 1e3) - 1.0;
                let indentation = found.indentation / (1e3 * exact.indentation) - 1.0;
                assert!(force.abs() < 3e-8, "{thickness} {force:e}");
                assert!(indentation.abs() < 3e-8, "{thickness} {indentation:e}");
            }
        }
        // Layers so thick that their backing has no effect.
        let bodies = [(rubber, Some(Layer::new(1e9))), (soft, None)];
        let layers = WeightedLayer::among(&bodies, 1.0);
        for b in [0.0, 0.3, 10.0] {
            let found = LayerModes::fine().contact_on_layers(b, &layers);
            assert!(largest_difference(found, LayerModes::fine().contact(b)) < 2e-9);
        }
    }

    #[test]
    fn pressure_ends_at_the_edge_on_layers() {
        // At fixed indentation, the force has a maximum with respect to the contact radius at the true contact, because a wider contact
        // would be in tension at its edge. The maximum is computed with springs alone on the layer, from two radii around the contact.
        use crate::problem::layer::WeightedLayer;
        use crate::problem::{Layer, Material};
        let rubber = Material::new(1.0, 0.5);
        let layers = |radius: f64| {
            let bodies = [(rubber, Some(Layer::new(0.8 / radius)))];
            WeightedLayer::among(&bodies, 1.0)
        };
        let modes = LayerModes::fine();
        // dF/dzeta at the contact is that of the flat punch of the same radius: the total derivative along contacts of growing radius
        // equals the partial one.
        let at = |radius: f64| {
            let contact = modes.contact_on_layers(0.2 / radius, &layers(radius));
            [
                contact.indentation * radius.powi(2),
                contact.force * radius.powi(3),
            ]
        };
        let step = 1e-3;
        let ([z1, f1], [z0, f0]) = (at(1.0 + step), at(1.0 - step));
        let stiffness = (f1 - f0) / (z1 - z0);
        let count = modes.modes.len();
        let [added, _] = modes.layer_matrices(&layers(1.0));
        let operator = Matrix::from_fn(count, count, |row, column| {
            let own = modes.modes[row].eigenvalue + 0.2;
            added[(row, column)] + if row == column { own } else { 0.0 }
        });
        let load: Vec<f64> = modes.modes.iter().map(|mode| mode.uniform).collect();
        let mut q = load.clone();
        Lu::new(operator).solve(&mut q);
        let punch = dot(&load, &q);
        assert!(
            (stiffness / punch - 1.0).abs() < 1e-5,
            "{stiffness} {punch}"
        );
    }

    #[test]
    fn winkler_with_springs_only() {
        // p = (zeta - r^2/2R)/beta with p(a) = 0; the half-space is a perturbation of order 1/b.
        for b in [1e10, 1e150, 1e300] {
            let winkler = UnitContact {
                indentation: 0.5,
                force: PI / (4.0 * b),
                central_pressure: 0.5 / b,
            };
            assert!(largest_difference(LayerModes::fine().contact(b), winkler) < 1e-9);
        }
    }

    #[test]
    fn converged_for_every_spring_compliance() {
        let finest = LayerModes::new(40);
        for b in compliances() {
            let difference = largest_difference(LayerModes::fine().contact(b), finest.contact(b));
            assert!(difference < 1e-8, "b = {b:e}: {difference:e}");
            if b >= 0.1 {
                assert!(difference < 1e-12, "b = {b:e}: {difference:e}");
            }
            let coarse = largest_difference(LayerModes::coarse().contact(b), finest.contact(b));
            assert!(coarse < 2e-7, "b = {b:e}: {coarse:e}");
            let rough = largest_difference(LayerModes::rough().contact(b), finest.contact(b));
            assert!(rough < 1e-4, "b = {b:e}: {rough:e}");
        }
    }

    #[test]
    fn force_grows_with_indentation_by_the_punch_stiffness() {
        // An increment of a contact whose pressure vanishes at the edge is a flat punch: dF/dzeta = (a/c) stiffness(b), with b = b_1/a.
        // This does not use the edge identity.
        let modes = LayerModes::fine();
        for b in [1e-4, 1e-2, 0.3, 1.0, 7.0, 1e3] {
            let at = |a: f64| {
                let contact = modes.contact(b / a);
                (contact.force * a.powi(3), contact.indentation * a * a)
            };
            // Five-point derivative, error h^4: 1e-10 here.
            let h = 3e-3;
            let derivative = |f: &dyn Fn(f64) -> f64| {
                (f(1.0 - 2.0 * h) - 8.0 * f(1.0 - h) + 8.0 * f(1.0 + h) - f(1.0 + 2.0 * h))
                    / (12.0 * h)
            };
            let slope = derivative(&|a| at(a).0) / derivative(&|a| at(a).1);
            assert!((slope / modes.stiffness(b) - 1.0).abs() < 1e-8, "b = {b:e}");
        }
    }

    #[test]
    fn softer_than_half_space_or_springs_alone() {
        for b in compliances() {
            let contact = LayerModes::fine().contact(b);
            assert!(contact.force <= (4.0 / 3.0f64).min(PI / (4.0 * b)) * (1.0 + 1e-9));
            assert!(contact.central_pressure <= (2.0 / PI).min(0.5 / b) * (1.0 + 1e-8));
            assert!((0.5..=1.0 + 1e-9).contains(&contact.indentation));
        }
    }
}
