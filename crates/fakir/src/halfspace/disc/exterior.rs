//! Surface displacement outside a loaded disc.
//!
//! Outside the disc, the mode `Y_lm/mu` displaces the surface by `W_lm = {1|sqrt2 cos m Phi|sqrt2 sin m Phi} y_lm/sqrt(pi) G((1+l+m)/2)
//! G((1+l-m)/2)/G(l+3/2) delta^(-l-1) 2F1((1+l+m)/2, (1+l-m)/2; l+3/2; 1/delta^2)`, with `delta` the distance from the centre in pillar
//! radii. For `l = 0` this is `arcsin(1/delta)` up to its factor, the flat punch (Johnson, Contact Mechanics, eq. 3.37).
//!
//! If bodies are [layers](crate::halfspace::layer), `2 y_lm (-1)^((l-m)/2) ∫ (Phi(k) - 1) j_l(k) J_m(k delta) dk` is added, with the same
//! angular factor. This correction also applies inside the disc.

use super::basis::{Mode, equator_value, gamma_degree, modes};
use crate::halfspace::jet::FieldJet;
use crate::halfspace::layer::force::AroundForce;
use crate::halfspace::layer::table::{RadialPart, RadialTable};
use crate::numerics::special::gamma_half;
use crate::numerics::vector::{LANES, Lanes};
use crate::problem::layer::WeightedLayer;
use std::f64::consts::{PI, SQRT_2};
use std::sync::Arc;

/// Above this `z = 1/delta^2` the hypergeometric series is expanded about `z = 1`.
const NEAR: f64 = 0.75;

/// Number of terms about `z = 0`: sufficient for 1e-16 at `z = NEAR`.
const FAR_TERMS: usize = 140;

/// Number of terms about `z = 1`: sufficient for 1e-16 at `1 - z = 1 - NEAR`.
const NEAR_TERMS: usize = 40;

/// Number of terms with a truncation error of about 1e-16, 1e-15 at degree 16, for `z` up to the bound.
const TERMS_FOR: [(f64, usize); 14] = [
    (1.0 / 4096.0, 5),
    (1.0 / 1024.0, 6),
    (1.0 / 256.0, 7),
    (1.0 / 128.0, 9),
    (1.0 / 64.0, 10),
    (1.0 / 32.0, 12),
    (1.0 / 16.0, 15),
    (1.0 / 8.0, 20),
    (0.18, 24),
    (1.0 / 4.0, 29),
    (0.35, 38),
    (1.0 / 2.0, 56),
    (0.6, 78),
    (0.68, 104),
];

/// Radial part of `W_lm` without `cos`/`sin`, as a function of `t = delta^2`, divided by
/// `delta^m`: `W = Re|Im (x + iy)^m S(t)`.
#[derive(Debug, Clone)]
pub(crate) struct RadialFunction {
    order: usize,
    /// `2 alpha = l + m + 1`: `S = z^alpha F(z)`, `z = 1/t`.
    twice_power: usize,
    /// Coefficients of `F` in powers of `z`.
    far: Vec<f64>,
    /// Coefficients of the regular part of `F` in powers of `1 - z` ...
    regular: Vec<f64>,
    /// ... and of the part proportional to `sqrt(1 - z)`.
    singular: Vec<f64>,
}

/// A function of one variable with its first two derivatives, at [`LANES`] points.
#[derive(Debug, Clone, Copy)]
struct Jets {
    value: Lanes,
    first: Lanes,
    second: Lanes,
}

/// A polynomial and two derivatives, by Horner's rule.
#[inline(always)]
fn horner_jets(coefficients: &[f64], x: Lanes) -> Jets {
    let mut value = Lanes::default();
    let mut first = Lanes::default();
    let mut half_second = Lanes::default();
    for coefficient in coefficients.iter().rev() {
        half_second = half_second * x + first;
        first = first * x + value;
        value = value * x + Lanes::splat(*coefficient);
    }
    Jets {
        value,
        first,
        second: half_second + half_second,
    }
}

/// A polynomial, by Horner's rule.
fn horner(coefficients: &[f64], x: f64) -> f64 {
    coefficients
        .iter()
        .rev()
        .fold(0.0, |value, coefficient| value * x + coefficient)
}

/// Number of terms about `z = 0` that are sufficient at `z`.
fn far_terms(z: f64) -> usize {
    TERMS_FOR
        .iter()
        .find(|(bound, _)| z <= *bound)
        .map_or(FAR_TERMS, |(_, terms)| *terms)
}

/// Coefficients of `factor 2F1(a, b; c; x)` in powers of `x`.
fn hypergeometric(factor: f64, a: f64, b: f64, c: f64, terms: usize) -> Vec<f64> {
    let mut coefficients = Vec::with_capacity(terms);
    let mut term = factor;
    for k in 0..terms {
        coefficients.push(term);
        let k = k as f64;
        term *= (a + k) * (b + k) / ((c + k) * (k + 1.0));
    }
    coefficients
}

impl RadialFunction {
    pub(crate) fn new(degree: usize, order: usize) -> Self {
        let (a2, b2) = (1 + degree + order, 1 + degree - order);
        let (a, b, c) = (0.5 * a2 as f64, 0.5 * b2 as f64, degree as f64 + 1.5);
        let angular = if order == 0 { 1.0 } else { SQRT_2 };
        let (gamma_a, gamma_b, gamma_c) = (gamma_half(a2), gamma_half(b2), gamma_degree(degree));
        let factor =
            angular * equator_value(degree, order) / PI.sqrt() * gamma_a * gamma_b / gamma_c;
        // Abramowitz & Stegun 15.3.6 with c - a - b = 1/2.
        let gamma_c_a = gamma_half(2 * degree + 3 - a2);
        let gamma_c_b = gamma_half(2 * degree + 3 - b2);
        let regular = gamma_c * PI.sqrt() / (gamma_c_a * gamma_c_b);
        let singular = gamma_c * (-2.0 * PI.sqrt()) / (gamma_a * gamma_b);
        Self {
            order,
            twice_power: degree + order + 1,
            far: hypergeometric(factor, a, b, c, FAR_TERMS),
            regular: hypergeometric(factor * regular, a, b, 0.5, NEAR_TERMS),
            singular: hypergeometric(factor * singular, c - a, c - b, 1.5, NEAR_TERMS),
        }
    }

    /// `F(z)`
    fn series(&self, z: f64) -> f64 {
        if z <= NEAR {
            return horner(&self.far[..far_terms(z)], z);
        }
        let u = (1.0 - z).max(0.0);
        horner(&self.regular, u) + u.sqrt() * horner(&self.singular, u)
    }

    /// `F` with its derivatives with respect to `z`, with separate expansions near the disc and far from it. At `z = 1` the derivatives are
    /// infinite.
    #[inline(always)]
    fn series_jets(&self, z: Lanes) -> Jets {
        let (least, most) =
            z.0.iter()
                .fold((f64::INFINITY, 0.0_f64), |(least, most), z| {
                    (least.min(*z), most.max(*z))
                });
        if most <= NEAR {
            return horner_jets(&self.far[..far_terms(most)], z);
        }
        let near = self.series_jets_near(z);
        if least > NEAR {
            return near;
        }
        // Both expansions are evaluated, since lanes may differ.
        let far = horner_jets(&self.far, z.map(|z| z.min(NEAR)));
        let pick = |near: Lanes, far: Lanes| {
            Lanes(std::array::from_fn(|k| {
                if z.0[k] <= NEAR { far.0[k] } else { near.0[k] }
            }))
        };
        Jets {
            value: pick(near.value, far.value),
            first: pick(near.first, far.first),
            second: pick(near.second, far.second),
        }
    }

    fn series_jets_near(&self, z: Lanes) -> Jets {
        let u = z.map(|z| (1.0 - z.max(NEAR)).max(0.0));
        let root = u.map(f64::sqrt);
        let inverse_root = root.map(f64::recip);
        let regular = horner_jets(&self.regular, u);
        let singular = horner_jets(&self.singular, u);
        let (s0, s1, s2) = (singular.value, singular.first, singular.second);
        let first = regular.first + root * s1 + 0.5 * (s0 * inverse_root);
        let inverse = u.map(f64::recip);
        Jets {
            value: regular.value + root * s0,
            first: -1.0 * first,
            second: regular.second + root * s2 + s1 * inverse_root
                - 0.25 * (s0 * inverse_root * inverse),
        }
    }

    /// `S` with its derivatives with respect to `t`; `powers` are those of the inverse distance.
    #[inline(always)]
    fn jets(&self, z: Lanes, powers: &[Lanes]) -> Jets {
        // S = z^alpha F(z); z dS/dz and z^2 d2S/dz2 follow, and dz/dt = -z^2.
        let series = self.series_jets(z);
        let alpha = 0.5 * self.twice_power as f64;
        let power = powers[self.twice_power];
        let (f, zf1, z2f2) = (series.value, z * series.first, z * z * series.second);
        let zg1 = power * (alpha * f + zf1);
        let z2g2 = power * (alpha * (alpha - 1.0) * f + 2.0 * alpha * zf1 + z2f2);
        Jets {
            value: power * f,
            first: -1.0 * (z * zg1),
            second: z * z * (z2g2 + 2.0 * zg1),
        }
    }

    /// `S` alone at [`LANES`] points.
    #[inline(always)]
    fn lane_values(&self, z: Lanes, inverse_distance: Lanes) -> Lanes {
        let most = z.0.iter().fold(0.0_f64, |most, z| most.max(*z));
        let mut value = Lanes::default();
        if most <= NEAR {
            for coefficient in self.far[..far_terms(most)].iter().rev() {
                value = value * z + Lanes::splat(*coefficient);
            }
        } else {
            value = z.map(|z| self.series(z));
        }
        for _ in 0..self.twice_power {
            value = value * inverse_distance;
        }
        value
    }

    /// `S` alone.
    pub(crate) fn value(&self, inverse_distance: f64) -> f64 {
        let z = inverse_distance * inverse_distance;
        inverse_distance.powi(self.twice_power as i32) * self.series(z)
    }
}

/// The displacement outside a disc, for all modes up to a degree.
#[derive(Debug, Clone)]
pub(crate) struct Exterior {
    modes: Vec<Mode>,
    /// One function per (degree, order), and the index of the function of every mode.
    radial: Vec<RadialFunction>,
    radial_of: Vec<usize>,
    /// Corrections for layers of each function and of a point force; `None` on half-spaces.
    layers: Option<Arc<OnLayers>>,
}

/// Corrections for layers.
#[derive(Debug)]
struct OnLayers {
    /// The radii of the discs in increasing order, and a table of the corrections for each of them.
    radii: Vec<f64>,
    tables: Vec<RadialTable>,
    force: AroundForce,
}

impl OnLayers {
    /// The table for discs of a radius.
    #[inline(always)]
    fn table(&self, radius: f64) -> &RadialTable {
        if let [only] = &self.tables[..] {
            return only;
        }
        let place = self.radii.partition_point(|known| *known < radius);
        debug_assert_eq!(self.radii.get(place), Some(&radius));
        &self.tables[place.min(self.tables.len() - 1)]
    }
}

/// Highest degree for which derivatives are evaluated.
pub(crate) const MAXIMUM_DEGREE: usize = 16;

/// Number of radial functions up to degree 6, and up to `MAXIMUM_DEGREE`.
const FEW_RADIAL: usize = 16;
const MOST_RADIAL: usize = (MAXIMUM_DEGREE / 2 + 1) * (MAXIMUM_DEGREE / 2 + 1);

impl Exterior {
    pub(crate) fn new(degree: usize) -> Self {
        let modes = modes(degree);
        let mut radial = Vec::new();
        let mut radial_of = Vec::with_capacity(modes.len());
        for mode in &modes {
            if !mode.sine {
                radial.push(RadialFunction::new(mode.degree, mode.order));
            }
            radial_of.push(radial.len() - 1);
        }
        Self {
            modes,
            radial,
            radial_of,
            layers: None,
        }
    }

    /// The same on layers, for discs of these different radii in increasing order, in the unit of length of the layers.
    pub(crate) fn with_layers(self, layers: &[WeightedLayer], radii: &[f64]) -> Self {
        let Some(force) = AroundForce::at_point(layers).filter(|_| !radii.is_empty()) else {
            return self;
        };
        let of_mode = |mode: &Mode| {
            let angular = if mode.order == 0 { 1.0 } else { SQRT_2 };
            let half = (mode.degree - mode.order) / 2;
            let sign = if half.is_multiple_of(2) { 1.0 } else { -1.0 };
            RadialPart {
                factor: sign * angular * 2.0 * equator_value(mode.degree, mode.order),
                degrees: vec![mode.degree],
                order: mode.order,
                power: mode.order,
            }
        };
        let parts = self.modes.iter().filter(|mode| !mode.sine).map(of_mode);
        let parts: Arc<[RadialPart]> = parts.collect();
        let table = |radius: &f64| {
            let own = WeightedLayer::in_unit(layers, *radius);
            RadialTable::of_radii(&own, &parts, [1.0; 2])
        };
        let layers = OnLayers {
            tables: radii.iter().map(table).collect(),
            radii: radii.to_vec(),
            force,
        };
        Self {
            layers: Some(Arc::new(layers)),
            ..self
        }
    }

    /// Highest degree.
    pub(crate) fn degree(&self) -> usize {
        self.modes.last().map_or(0, |mode| mode.degree)
    }

    /// Number of modes.
    pub(crate) fn count(&self) -> usize {
        self.modes.len()
    }

    /// Adds to `sums` the displacement at [`LANES`] points (in pillar radii from the centres of as many discs, and outside of these) for
    /// two sets of coefficients at once. The radii are those of the discs, which matter on layers. Supports degrees up to
    /// [`MAXIMUM_DEGREE`].
    #[inline(always)]
    pub(crate) fn add_jets(
        &self,
        [x, y]: [Lanes; 2],
        radii: Lanes,
        coefficients: [&[Lanes]; 2],
        sums: &mut [LaneJets; 2],
    ) {
        let degree = self.degree().min(MAXIMUM_DEGREE);
        let inverse_square = (x * x + y * y).map(f64::recip);
        let inverse_distance = inverse_square.map(f64::sqrt);
        let mut powers = [Lanes::splat(1.0); 2 * MAXIMUM_DEGREE + 2];
        for k in 1..2 * degree + 2 {
            powers[k] = powers[k - 1] * inverse_distance;
        }
        let mut harmonics = [[Lanes::splat(1.0), Lanes::default()]; MAXIMUM_DEGREE + 1];
        for k in 1..=degree {
            let [re, im] = harmonics[k - 1];
            harmonics[k] = [re * x - im * y, re * y + im * x];
        }
        let (mut few, mut many);
        let mut of_layers: &mut [[Lanes; 3]] = &mut [];
        if let Some(layers) = self.layers.as_deref() {
            let count = self.radial.len();
            let is_loaded = |lane: usize| {
                let mut of_disc = coefficients.iter().copied().flatten();
                of_disc.any(|c| c.0[lane] != 0.0)
            };
            let lanes = (0..LANES).filter(|lane| is_loaded(*lane));
            let places = lanes.map(|lane| (lane, inverse_square.0[lane].sqrt().recip()));
            if count <= FEW_RADIAL {
                few = [[Lanes::default(); 3]; FEW_RADIAL];
                of_layers = &mut few[..count];
                for place in places {
                    let table = layers.table(radii.0[place.0]);
                    add_layer_jets::<FEW_RADIAL>(table, place, of_layers);
                }
            } else {
                many = [[Lanes::default(); 3]; MOST_RADIAL];
                of_layers = &mut many[..count];
                for place in places {
                    let table = layers.table(radii.0[place.0]);
                    add_layer_jets::<MOST_RADIAL>(table, place, of_layers);
                }
            }
        }
        let mut evaluated = usize::MAX;
        let mut radial = Jets {
            value: Lanes::default(),
            first: Lanes::default(),
            second: Lanes::default(),
        };
        for (number, mode) in self.modes.iter().enumerate() {
            if self.radial_of[number] != evaluated {
                evaluated = self.radial_of[number];
                radial = self.radial[evaluated].jets(inverse_square, &powers);
                if let Some([value, first, second]) = of_layers.get(evaluated).copied() {
                    radial.value += value;
                    radial.first += first;
                    radial.second += second;
                }
            }
            let field = harmonic_times(mode, [x, y], &harmonics, &radial);
            for (sum, coefficients) in sums.iter_mut().zip(coefficients) {
                if let Some(coefficient) = coefficients.get(number) {
                    sum.add_product(*coefficient, &field);
                }
            }
        }
    }

    /// Displacement of the first modes, as many as `values`, at [`LANES`] points, due to discs of these radii.
    #[inline(always)]
    pub(crate) fn lane_values(&self, [x, y]: [Lanes; 2], radii: Lanes, values: &mut [Lanes]) {
        let inverse_square = (x * x + y * y).map(f64::recip);
        let inverse_distance = inverse_square.map(f64::sqrt);
        let mut radial = Lanes::default();
        let mut harmonic = [Lanes::default(); 2];
        let of_layers = self.layers.as_deref().map(|layers| {
            let count = self.radial.len();
            let mut of_layers = [Lanes::default(); MOST_RADIAL];
            let mut values = [0.0; MOST_RADIAL];
            for lane in 0..LANES {
                let table = layers.table(radii.0[lane]);
                table.values(inverse_distance.0[lane].recip(), &mut values);
                for (lanes, value) in of_layers[..count].iter_mut().zip(values) {
                    lanes.0[lane] = value;
                }
            }
            of_layers
        });
        let modes = self.modes.iter().zip(&self.radial_of);
        for (value, (mode, &which)) in values.iter_mut().zip(modes) {
            if !mode.sine {
                radial = self.radial[which].lane_values(inverse_square, inverse_distance);
                if let Some(of_layers) = &of_layers {
                    radial += of_layers[which];
                }
                harmonic = [Lanes::splat(1.0), Lanes::default()];
                for _ in 0..mode.order {
                    let [re, im] = harmonic;
                    harmonic = [re * x - im * y, re * y + im * x];
                }
            }
            *value = radial * harmonic[usize::from(mode.sine)];
        }
    }

    /// Computes the displacement of every mode at `point`, in units of the radius of the disc, into `values`.
    pub(crate) fn values(&self, point: [f64; 2], radius: f64, values: &mut [f64]) {
        self.values_of_first(self.modes.len(), point, radius, values);
    }

    /// [`Self::values`] for at most the first `count` modes.
    pub(crate) fn values_of_first(
        &self,
        count: usize,
        point: [f64; 2],
        radius: f64,
        values: &mut [f64],
    ) {
        let square = point[0] * point[0] + point[1] * point[1];
        let inverse_distance = square.sqrt().recip();
        self.fill_values(count, point, radius, values, |radial| {
            radial.value(inverse_distance)
        });
    }

    /// The displacement due to a unit point force, at an offset from it in the unit of length of the layers: `1/(pi r)` and the correction
    /// for layers.
    pub(crate) fn of_force(&self, [x, y]: [f64; 2]) -> FieldJet {
        let square = (x * x + y * y).recip();
        let value = square.sqrt() / PI;
        let third = value * square;
        let fifth = 3.0 * third * square;
        let mut jet = FieldJet {
            value,
            gradient: [-third * x, -third * y],
            hessian: [fifth * x * x - third, fifth * x * y, fifth * y * y - third],
        };
        if let Some(layers) = &self.layers {
            jet.add_scaled(PI.recip(), &layers.force.jet([x, y]));
        }
        jet
    }

    /// Corrections for layers of the first modes at any point, also inside the disc: zero on half-spaces.
    pub(crate) fn layer_values(
        &self,
        count: usize,
        point: [f64; 2],
        radius: f64,
        values: &mut [f64],
    ) {
        let values = &mut values[..count.min(self.modes.len())];
        if self.layers.is_none() {
            values.fill(0.0);
            return;
        }
        self.fill_values(count, point, radius, values, |_| 0.0);
    }

    fn fill_values(
        &self,
        count: usize,
        point: [f64; 2],
        radius: f64,
        values: &mut [f64],
        of_half_spaces: impl Fn(&RadialFunction) -> f64,
    ) {
        let of_layers = self.layers.as_deref().map(|layers| {
            let mut values = vec![0.0; self.radial.len()];
            let distance = point[0].hypot(point[1]);
            layers.table(radius).values(distance, &mut values);
            values
        });
        let mut radial = 0.0;
        for ((value, mode), &which) in values
            .iter_mut()
            .zip(&self.modes)
            .zip(&self.radial_of)
            .take(count)
        {
            if !mode.sine {
                radial = of_half_spaces(&self.radial[which]);
                if let Some(of_layers) = &of_layers {
                    radial += of_layers[which];
                }
            }
            let [re, im] = power(point, self.radial[which].order);
            *value = radial * if mode.sine { im } else { re };
        }
    }
}

/// Adds the corrections for layers of all radial functions, of which there are at most `N`, at the point of a lane, with derivatives with
/// respect to the square of the distance.
#[inline(always)]
fn add_layer_jets<const N: usize>(
    layers: &RadialTable,
    (lane, distance): (usize, f64),
    jets: &mut [[Lanes; 3]],
) {
    let [mut value, mut first, mut second] = [[0.0; N]; 3];
    layers.jets(distance, [&mut value, &mut first, &mut second]);
    let half = 0.5 / distance;
    for (number, jet) in jets.iter_mut().enumerate() {
        // d/d(r^2) = (1/2r) d/dr
        jet[0].0[lane] = value[number];
        jet[1].0[lane] = half * first[number];
        jet[2].0[lane] = half * half * (second[number] - first[number] / distance);
    }
}

/// `(x + iy)^m`
fn power([x, y]: [f64; 2], exponent: usize) -> [f64; 2] {
    let mut result = [1.0, 0.0];
    for _ in 0..exponent {
        result = [result[0] * x - result[1] * y, result[0] * y + result[1] * x];
    }
    result
}

/// Fields at [`LANES`] points, or due to as many discs.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LaneJets {
    value: Lanes,
    gradient: [Lanes; 2],
    hessian: [Lanes; 3],
}

impl LaneJets {
    #[inline(always)]
    fn add_product(&mut self, factor: Lanes, other: &Self) {
        self.value += factor * other.value;
        for k in 0..2 {
            self.gradient[k] += factor * other.gradient[k];
        }
        for k in 0..3 {
            self.hessian[k] += factor * other.hessian[k];
        }
    }

    /// Adds fields in units of a separate radius for every lane; `scale` is the inverse radius.
    #[inline(always)]
    pub(crate) fn add_scaled(&mut self, radius: Lanes, scale: Lanes, other: &Self) {
        self.value += radius * other.value;
        for k in 0..2 {
            self.gradient[k] += other.gradient[k];
        }
        for k in 0..3 {
            self.hessian[k] += scale * other.hessian[k];
        }
    }

    /// Sum over the lanes.
    pub(crate) fn sum(&self) -> FieldJet {
        FieldJet {
            value: self.value.sum(),
            gradient: self.gradient.map(Lanes::sum),
            hessian: self.hessian.map(Lanes::sum),
        }
    }
}

/// `H(x, y) S(t)` with `H` the real or imaginary part of `(x + iy)^m` and `t = x^2 + y^2`;
/// `harmonics` the powers of `x + iy`, `radial` is `S` with its two derivatives.
#[inline(always)]
fn harmonic_times(
    mode: &Mode,
    [x, y]: [Lanes; 2],
    harmonics: &[[Lanes; 2]],
    radial: &Jets,
) -> LaneJets {
    let m = mode.order;
    let pick = |[re, im]: [Lanes; 2]| if mode.sine { im } else { re };
    // d/dx (x+iy)^m = m (x+iy)^(m-1), d/dy = i d/dx.
    let times_i = |[re, im]: [Lanes; 2]| [-1.0 * im, re];
    let derivative = |order: usize, factor: f64| {
        if m >= order {
            harmonics[m - order].map(|v| factor * v)
        } else {
            [Lanes::default(); 2]
        }
    };
    let h = pick(harmonics[m]);
    let first = derivative(1, m as f64);
    let second = derivative(2, (m * m.saturating_sub(1)) as f64);
    let (hx, hy) = (pick(first), pick(times_i(first)));
    let (hxx, hxy) = (pick(second), pick(times_i(second)));
    let (s, twice_s1, four_s2) = (radial.value, 2.0 * radial.first, 4.0 * radial.second);
    let (h_s1, h_s2) = (h * twice_s1, h * four_s2);
    let (x_s1, y_s1) = (x * twice_s1, y * twice_s1);
    LaneJets {
        value: h * s,
        gradient: [hx * s + h * x_s1, hy * s + h * y_s1],
        hessian: [
            hxx * s + 2.0 * (hx * x_s1) + h_s1 + x * x * h_s2,
            hxy * s + hy * x_s1 + hx * y_s1 + x * y * h_s2,
            2.0 * (hy * y_s1) + h_s1 + y * y * h_s2 - hxx * s,
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::super::basis::BasisEvaluator;
    use super::super::basis::mode_count;
    use super::*;
    use crate::numerics::quadrature::hemisphere;

    #[test]
    fn layers_add_what_the_table_has() {
        use crate::halfspace::layer::tests::{film, modes_of, rows};
        let exterior = Exterior::new(2).with_layers(&[film()], &[1.0]);
        for (case, value) in rows("Delta W") {
            let (wanted, distance) = modes_of(&case);
            let mut values = vec![0.0; exterior.count()];
            exterior.layer_values(usize::MAX, [distance / 3.0, 0.0], 1.0, &mut values);
            let is_it = |mode: &Mode| (mode.degree, mode.order) == wanted[0] && !mode.sine;
            let which = exterior.modes.iter().position(is_it).unwrap();
            let angular = if wanted[0].1 == 0 { 1.0 } else { SQRT_2 };
            let found = 3.0 * values[which] / angular;
            assert!((found - value).abs() < 2e-12, "{case}: {found}");
        }
    }

    /// Coefficients of the first of several discs; the others are unloaded.
    fn of_first(coefficients: &[f64]) -> Vec<Lanes> {
        let lanes = coefficients.iter().map(|c| Lanes([*c, 0.0, 0.0, 0.0]));
        lanes.collect()
    }

    #[test]
    fn layers_have_their_derivatives() {
        let film = crate::halfspace::layer::tests::film();
        let exterior = Exterior::new(4).with_layers(&[film], &[1.0]);
        let count = exterior.count();
        let step = 1e-4;
        for point in [[1.3, 0.4], [-2.1, 3.3], [8.0, -5.0], [30.0, 2.0]] {
            let coefficients: Vec<f64> = (0..count).map(|k| (1.3 * k as f64).cos()).collect();
            let at = |dx: f64, dy: f64| {
                let mut sums = [LaneJets::default(); 2];
                let [x, y] = [point[0] + dx, point[1] + dy].map(Lanes::splat);
                exterior.add_jets(
                    [x, y],
                    Lanes::splat(1.0),
                    [&of_first(&coefficients); 2],
                    &mut sums,
                );
                sums[0].sum()
            };
            let jet = at(0.0, 0.0);
            let mut values = vec![0.0; count];
            exterior.values(point, 1.0, &mut values);
            let value: f64 = values.iter().zip(&coefficients).map(|(w, c)| w * c).sum();
            assert!((jet.value - value).abs() < 1e-13, "{} {value}", jet.value);
            let mut lanes = vec![Lanes::default(); count];
            exterior.lane_values(point.map(Lanes::splat), Lanes::splat(1.0), &mut lanes);
            for (lane, value) in lanes.iter().zip(&values) {
                assert!((lane.0[0] - value).abs() < 1e-13);
            }
            let (left, right, down, up) =
                (at(-step, 0.0), at(step, 0.0), at(0.0, -step), at(0.0, step));
            let slope = |a: f64, b: f64| (b - a) / (2.0 * step);
            assert!((slope(left.value, right.value) - jet.gradient[0]).abs() < 1e-7);
            assert!((slope(down.value, up.value) - jet.gradient[1]).abs() < 1e-7);
            assert!((slope(left.gradient[0], right.gradient[0]) - jet.hessian[0]).abs() < 1e-6);
            assert!((slope(left.gradient[1], right.gradient[1]) - jet.hessian[1]).abs() < 1e-6);
            assert!((slope(down.gradient[1], up.gradient[1]) - jet.hessian[2]).abs() < 1e-6);
        }
    }

    #[test]
    fn flat_punch_outside() {
        // Johnson 3.37: u = (2/pi) zeta arcsin(1/delta) with c_00 Y_00 lambda = zeta = 1.
        let radial = RadialFunction::new(0, 0);
        let coefficient = (2.0 * PI).sqrt() / PI;
        for delta in [1.0, 1.0 + 1e-9, 1.01, 1.15, 1.2, 1.5, 4.0, 17.0, 300.0_f64] {
            let expected = 2.0 / PI * delta.recip().asin();
            let found = coefficient * radial.value(delta.recip());
            assert!(
                (found / expected - 1.0).abs() < 1e-14,
                "{delta}: {found} {expected}"
            );
        }
    }

    #[test]
    fn every_mode_by_quadrature() {
        let degree = 6;
        let mut basis = BasisEvaluator::new(degree);
        let exterior = Exterior::new(degree);
        let count = mode_count(degree);
        for point in [[2.0, 0.9], [-1.3, 2.2], [4.0, -3.0], [25.0, 7.0]] {
            let mut expected = vec![0.0; count];
            let mut modes = vec![0.0; count];
            for (at, weight) in hemisphere(30, 120) {
                basis.evaluate(at, &mut modes);
                let distance = (at[0] - point[0]).hypot(at[1] - point[1]);
                for (sum, mode) in expected.iter_mut().zip(&modes) {
                    *sum += weight * mode / (PI * distance);
                }
            }
            let mut found = vec![0.0; count];
            exterior.values(point, 1.0, &mut found);
            for (index, (found, expected)) in found.iter().zip(&expected).enumerate() {
                assert!(
                    (found - expected).abs() < 1e-13,
                    "mode {index} at {point:?}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn continuous_with_the_displacement_inside() {
        // At the edge W = lambda y for every mode: the two closed forms must agree.
        let degree = 12;
        let exterior = Exterior::new(degree);
        let mut basis = BasisEvaluator::new(degree);
        let count = mode_count(degree);
        let (mut outside, mut inside) = (vec![0.0; count], vec![0.0; count]);
        let direction = [0.6_f64, 0.8];
        exterior.values(direction, 1.0, &mut outside);
        basis.evaluate_polar(0.0, 1.0, direction, &mut inside);
        for ((outside, inside), mode) in outside.iter().zip(&inside).zip(modes(degree)) {
            let expected = inside * super::super::basis::eigenvalue(mode.degree, mode.order);
            assert!(
                (outside - expected).abs() < 1e-9,
                "{mode:?}: {outside} {expected}"
            );
        }
    }

    #[test]
    fn derivatives_are_those_of_the_value() {
        for degree in [0, 1, 3] {
            check_derivatives(degree);
        }
    }

    fn check_derivatives(degree: usize) {
        let exterior = Exterior::new(degree);
        let count = mode_count(degree);
        let step = 1e-5;
        for point in [[1.05, 0.1], [1.4, -0.7], [-3.0, 2.0], [9.0, 20.0]] {
            for which in 0..count {
                let mut unit = vec![0.0; count];
                unit[which] = 1.0;
                // With three additional unloaded discs, far and near.
                let at = |dx: f64, dy: f64| {
                    let mut sums = [LaneJets::default(); 2];
                    let x = Lanes([point[0] + dx, 1.01, 30.0, -2.0]);
                    let y = Lanes([point[1] + dy, 0.0, 4.0, 3.0]);
                    exterior.add_jets([x, y], Lanes::splat(1.0), [&of_first(&unit); 2], &mut sums);
                    sums[0].sum()
                };
                let jet = at(0.0, 0.0);
                let mut values = vec![0.0; count];
                exterior.values(point, 1.0, &mut values);
                assert!((jet.value - values[which]).abs() < 1e-14);
                let scale = 1e-4 * (jet.value.abs() + 1e-3);
                let dx = (at(step, 0.0).value - at(-step, 0.0).value) / (2.0 * step);
                let dy = (at(0.0, step).value - at(0.0, -step).value) / (2.0 * step);
                assert!((dx - jet.gradient[0]).abs() < scale);
                assert!((dy - jet.gradient[1]).abs() < scale);
                let xx = (at(step, 0.0).gradient[0] - at(-step, 0.0).gradient[0]) / (2.0 * step);
                let xy = (at(step, 0.0).gradient[1] - at(-step, 0.0).gradient[1]) / (2.0 * step);
                let yy = (at(0.0, step).gradient[1] - at(0.0, -step).gradient[1]) / (2.0 * step);
                let scale = 1e-3 * (1.0 + jet.hessian[0].abs());
                assert!((xx - jet.hessian[0]).abs() < scale);
                assert!((xy - jet.hessian[1]).abs() < scale);
                assert!((yy - jet.hessian[2]).abs() < scale);
            }
        }
    }
}
