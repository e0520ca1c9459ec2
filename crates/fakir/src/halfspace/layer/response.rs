//! The compliance of one layer relative to that of a half-space.

use crate::numerics::quadrature::gauss_legendre;
use crate::numerics::special::bessel;
use crate::problem::layer::{LayerBase, WeightedLayer};
use crate::problem::{Layer, Material};
use std::sync::LazyLock;

/// Argument above which `phi` is 1.
const END: f64 = 26.0;

/// Number of Gauss points in an interval of integration.
const POINTS: usize = 64;

/// Ratio of the shear moduli of layer and base above which `phi` varies so quickly near 0 that shorter intervals are required there.
const SOFT_BASE: f64 = 10.0;

/// Length of the intervals in this case beyond the refined range.
const PIECE: f64 = 0.5;

/// The compliance of one layer relative to that of a half-space of its material, for all wave numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LayerResponse {
    form: Form,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Form {
    Frictionless,
    /// `L`, `kappa`, their differences from 1, and the ratio of the shear moduli.
    Bonded {
        numbers: [f64; 2],
        complements: [f64; 2],
        shear_ratio: f64,
    },
}

impl LayerResponse {
    /// Creates the response of a layer of this material.
    #[must_use]
    pub fn new(material: &Material, layer: &Layer) -> Self {
        let body = [(*material, Some(*layer))];
        let layers = WeightedLayer::among(&body, 1.0);
        Self::of(&layers[0])
    }

    pub(crate) fn of(layer: &WeightedLayer) -> Self {
        let form = match layer.base {
            LayerBase::Frictionless => Form::Frictionless,
            LayerBase::Bonded {
                shear_ratio: m,
                poisson_ratio,
            } => {
                let nu = layer.poisson_ratio;
                let complements = [
                    4.0 * (1.0 - nu) / (1.0 + m * (3.0 - 4.0 * poisson_ratio)),
                    4.0 * (1.0 - nu) / (m + 3.0 - 4.0 * nu),
                ];
                Form::Bonded {
                    numbers: complements.map(|complement| 1.0 - complement),
                    complements,
                    shear_ratio: m,
                }
            }
        };
        Self { form }
    }

    /// `phi(x) - 1` at `x = k t >= 0`, in a form without cancellation and overflow.
    #[must_use]
    pub fn deficit(&self, x: f64) -> f64 {
        let e = (-2.0 * x).exp();
        let one_less = -(-2.0 * x).exp_m1();
        match self.form {
            Form::Frictionless => {
                // -E (2 + 4x - 2E)/(1 + 4xE - E^2)
                if x <= 0.0 {
                    return -1.0;
                }
                let square_less = -(-4.0 * x).exp_m1();
                -e * (2.0 * one_less + 4.0 * x) / (square_less + 4.0 * x * e)
            }
            Form::Bonded {
                numbers: [l, k],
                complements,
                ..
            } => {
                // E (L + k + 4kx + 4kx^2 - 2LkE)/(1 - (L + k + 4kx^2) E + LkE^2)
                let [of_l, of_k] = complements.map(|complement| one_less + complement * e);
                let above = l * of_k + k * of_l + 4.0 * k * x * (1.0 + x);
                let below = of_l * of_k - 4.0 * k * x * x * e;
                e * above / below
            }
        }
    }

    /// `d phi/dx`.
    pub(crate) fn slope(&self, x: f64) -> f64 {
        let e = (-2.0 * x).exp();
        // phi - 1 = E A/B, and E' = -2 E.
        let [above, below, above_slope, below_slope] = match self.form {
            Form::Frictionless => {
                // phi is proportional to x/2.
                if x < 1e-6 {
                    return 0.5;
                }
                let one_less = -(-2.0 * x).exp_m1();
                [
                    -2.0 * one_less - 4.0 * x,
                    -(-4.0 * x).exp_m1() + 4.0 * x * e,
                    -4.0 * e - 4.0,
                    4.0 * e * (1.0 + e - 2.0 * x),
                ]
            }
            Form::Bonded {
                numbers: [l, k], ..
            } => {
                let (of_l, of_k) = (1.0 - l * e, 1.0 - k * e);
                [
                    l * of_k + k * of_l + 4.0 * k * x * (1.0 + x),
                    of_l * of_k - 4.0 * k * x * x * e,
                    4.0 * k * (l * e + 1.0 + 2.0 * x),
                    2.0 * e * (l * of_k + k * of_l - 4.0 * k * x * (1.0 - x)),
                ]
            }
        };
        e / below * (above_slope - above * (2.0 + below_slope / below))
    }

    /// `phi(x)`: the compliance of the layer relative to that of a half-space.
    #[must_use]
    pub fn relative_compliance(&self, x: f64) -> f64 {
        1.0 + self.deficit(x)
    }

    /// `Psi(s) = ∫_0^∞ (phi(x) - 1) J_0(x s) dx` to 1e-14, at the distance `s >= 0` in thicknesses.
    #[must_use]
    pub fn far_displacement(&self, s: f64) -> f64 {
        let mut value = [0.0];
        let terms = self.rule(s).into_iter().map(|(x, weight)| {
            bessel(x * s, &mut value);
            weight * value[0]
        });
        terms.sum()
    }

    /// `Psi_0 = Psi(0)`: uniform displacement near a force on a small part of the surface.
    #[must_use]
    pub fn shift(&self) -> f64 {
        self.rule(0.0).iter().map(|(_, weight)| weight).sum()
    }

    /// `Psi_2` in `Psi = Psi_0 + Psi_2 s^2 + ..`: curvature of the displacement near the force.
    #[must_use]
    pub fn curvature(&self) -> f64 {
        let terms = self.rule(0.0).into_iter();
        terms.map(|(x, weight)| -0.25 * weight * x * x).sum()
    }

    /// Nodes `x`, and weights times `phi(x) - 1`, for integrals with functions that oscillate at most `reach` times as fast as the cosine.
    pub(crate) fn rule(&self, reach: f64) -> Vec<(f64, f64)> {
        let with_deficit = |(x, weight)| (x, weight * self.deficit(x));
        self.nodes(reach).into_iter().map(with_deficit).collect()
    }

    /// The same nodes with unmodified weights.
    pub(crate) fn nodes(&self, reach: f64) -> Vec<(f64, f64)> {
        // An interval has 14.3 points per oscillation in the total length, and enough points for the variation with the thickness.
        let mut longest = END / ((90.0 + 14.3 * reach) / POINTS as f64).ceil();
        let mut graded = vec![0.0];
        if let Form::Bonded { shear_ratio, .. } = self.form
            && shear_ratio > SOFT_BASE
        {
            graded.extend((-30..=-2).map(|power| 2f64.powi(power)));
            longest = longest.min(PIECE);
        }
        graded.push(END);
        let mut ends = vec![0.0];
        for part in graded.windows(2) {
            let length = part[1] - part[0];
            let pieces = (length / longest).ceil().max(1.0);
            let within = 1..=pieces as usize;
            ends.extend(within.map(|piece| part[0] + length * (piece as f64 / pieces)));
        }
        static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(POINTS));
        let points = &*RULE;
        let of_piece = |ends: &[f64]| {
            let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
            points
                .iter()
                .map(move |&(node, weight)| (middle + half * node, half * weight))
        };
        ends.windows(2).flat_map(of_piece).collect()
    }
}
