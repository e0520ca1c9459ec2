//! The coupling coefficients between the modes of two pillars of any two radii, in closed form.
//!
//! The unknowns are moments: `a^2` times the coefficients of the pressure, so that the work of each pillar on the displacement due to the
//! other is the same. For a receiver of radius `a` at `D` from a source of radius `a'`, `delta = |D| > a + a'`, and `Phi` the angle of `D`,
//! complex modes of azimuthal difference or sum `M` couple by
//! `g(l,m; l',m'; M) = 4 pi y_lm y_l'm' i^(l-l'+M) ∫ j_l(k a) j_l'(k a') J_M(k delta) dk` (the Fourier transform of `Y_lm/mu` is
//! `2 pi (-i)^l j_l(k) Y_lm(equator)`). With `alpha = a/delta` and `beta = a'/delta` this is (W. N. Bailey, Proc. Lond. Math. Soc. s2-40,
//! 37 (1936))
//!
//! ```text
//! (-1)^l pi y y' G((1+L+M)/2) G((1+L-M)/2)/(G(l+3/2) G(l'+3/2)) alpha^l beta^l'/delta F4,      L = l + l',
//! ```
//!
//! with Appell's `F4((1+L-M)/2, (1+L+M)/2; l+3/2, l'+3/2; alpha^2, beta^2)`. Its terms of one degree add up to a Jacobi polynomial of an
//! argument above 1, which three-term recurrences evaluate; all terms are positive. Radius 0 is a point that interacts by its mean alone.
//!
//! For pillars of equal radius, this radius is the unit of length, and the moments are the coefficients.
//!
//! If bodies are [layers](crate::halfspace::layer), `(Phi(k) - 1)` times the integrand is added. The correction is smooth, so that it also
//! acts between a pillar and itself, at the distance 0. It is tabulated as a function of the distance for every two radii, or integrated for
//! every two pillars if nearly all of them differ.

use crate::halfspace::disc::basis::{
    Mode, UNIT_FORCE, equator_value, gamma_degree, mode_count, modes,
};
use crate::halfspace::disc::exterior::{MAXIMUM_DEGREE, RadialFunction};
use crate::halfspace::layer::table::{RadialPart, RadialTable};
use crate::numerics::dual::{Dual, Number};
use crate::numerics::special::gamma_half;
use crate::numerics::vector::widest;
use crate::problem::layer::WeightedLayer;
use crate::problem::scaled::Scene;
use std::f64::consts::{FRAC_1_SQRT_2, PI};
use std::sync::{Arc, OnceLock};

/// Relative size of the terms at which the series is truncated.
pub(super) const SERIES_TOLERANCE: f64 = 1e-17;

/// Largest number of terms of a series. Reached only for pillars that nearly touch; the remainder is then added from the algebraic decay of
/// the terms.
const SERIES_LIMIT: usize = 20_000;

/// Number of terms that all series of a pair sum together, with coefficients from a table: sufficient for gaps of a seventh of the radius.
/// Series that have not converged by then are continued separately.
const TABLE: usize = 256;

/// Number of pillars per radius from which on the corrections for layers are tabulated: a table takes as long as some tens of integrals for
/// each of a few intervals of the distance.
const TABULATED: f64 = 8.0;

/// Number of steps between convergence checks.
const STRIDE: usize = 4;

/// Two discs: the radii of receiver and source, and the distance of their centres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Discs {
    pub(crate) receiver: f64,
    pub(crate) source: f64,
    pub(crate) distance: f64,
}

/// One series: a pair of complex modes with one `M`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Series {
    pub(super) factor: f64,
    /// `l` and `l'`
    pub(super) degrees: [i32; 2],
    /// `(1 + L - M)/2` and `(1 + L + M)/2`
    pub(super) upper: [f64; 2],
}

impl Series {
    /// `receiver` and `source` are `(degree, order)`.
    pub(super) fn new(receiver: (usize, usize), source: (usize, usize), azimuthal: usize) -> Self {
        let ((l, m), (k, n)) = (receiver, source);
        let sum = l + k;
        let sign = if l % 2 == 0 { 1.0 } else { -1.0 };
        let factor = sign
            * PI
            * equator_value(l, m)
            * equator_value(k, n)
            * gamma_half(1 + sum + azimuthal)
            * gamma_half(1 + sum - azimuthal)
            / (gamma_degree(l) * gamma_degree(k));
        let half = |n: usize| 0.5 * n as f64;
        Self {
            factor,
            degrees: [l as i32, k as i32],
            upper: [half(1 + sum - azimuthal), half(1 + sum + azimuthal)],
        }
    }

    /// Derivatives with respect to the logarithms of the distance, of the receiver's radius, and of the source's radius.
    fn derivatives(&self, discs: Discs) -> [f64; 3] {
        let values = [discs.receiver, discs.source, discs.distance];
        let variables = std::array::from_fn(|k| Dual::variable(values[k], k));
        let [receiver, source, distance] = self.value_of(variables).derivatives;
        [
            discs.distance * distance,
            discs.receiver * receiver,
            discs.source * source,
        ]
    }

    fn value_of<N: Number>(&self, [receiver, source, distance]: [N; 3]) -> N {
        let (alpha, beta) = (receiver / distance, source / distance);
        let powers = alpha.powi(self.degrees[0]) * self.factor * beta.powi(self.degrees[1]);
        let first = [1.0, 1.0, 0.0].map(N::constant);
        let sum = self.appell_from(1, first, [alpha * alpha, beta * beta]);
        powers / distance * sum
    }

    /// `A`, `B`, `p = l + 1/2` and `q = l' + 1/2` of the function.
    pub(super) fn parameters(&self) -> [f64; 4] {
        let [a, b] = self.upper;
        let [p, q] = self.degrees.map(|degree| f64::from(degree) + 0.5);
        [a, b, p, q]
    }

    /// `F4`, continued from the terms before `first`: their sum and the last two of them. Uses the sums of its terms of one degree,
    /// `U_s = f_s (c1 U_(s-1) - c2 f_(s-1) U_(s-2))` with `f_s = (A+s-1)(B+s-1)/((p+s)(q+s))`, `p = l+1/2`, `q = l'+1/2` and the
    /// coefficients of the recurrence of Jacobi polynomials (NIST Digital Library of Mathematical Functions, 18.9.2).
    fn appell_from<N: Number>(&self, first: usize, known: [N; 3], [x, y]: [N; 2]) -> N {
        let parameters = self.parameters();
        let [mut sum, mut term, mut before] = known;
        let (both, difference) = (x + y, y - x);
        let square = difference * difference;
        let mut half_way = term.value();
        for number in first..=SERIES_LIMIT {
            if term.is_below(SERIES_TOLERANCE, sum) {
                return sum;
            }
            let [of_sum, of_difference, of_square] = step(parameters, number as f64);
            let next =
                (both * of_sum + difference * of_difference) * term - square * of_square * before;
            (before, term) = (term, next);
            sum = sum + term;
            if number == SERIES_LIMIT / 2 {
                half_way = term.value();
            }
        }
        // For touching discs the terms are proportional to s^(-5/2) (1 + c/s), and the remainder is approximated by their integral from s +
        // 1/2 on. Their derivatives are proportional to s^(-3/2).
        let s = SERIES_LIMIT as f64;
        let c = s * (1.0 - 0.5_f64.powf(-2.5) * term.value() / half_way);
        let from = s + 0.5;
        let rest = from.powf(-1.5) / 1.5 + c * from.powf(-2.5) / 2.5;
        let of_value = s.powf(2.5) / (1.0 + c / s) * rest;
        sum + term.scaled_apart(of_value, 2.0 * s.powf(1.5) * from.powf(-0.5))
    }
}

/// Coefficients of the step to the term `s` of [Appell's function](Series::appell_from) from its `A`, `B`, `p` and `q`: those of `x + y`,
/// of `y - x` and of `(y - x)^2`.
pub(super) fn step([a, b, p, q]: [f64; 4], s: f64) -> [f64; 3] {
    let w = p + q;
    let ratio = |s: f64| (a + s - 1.0) * (b + s - 1.0) / ((p + s) * (q + s));
    let factor = ratio(s);
    if s < 1.5 {
        // From the sum p + q + 2 of the factors of x and y, and their difference.
        return [factor * (0.5 * w + 1.0), 0.5 * factor * (p - q), 0.0];
    }
    let twice = 2.0 * s + w;
    let scale = factor / (2.0 * s * (s + w) * (twice - 2.0));
    [
        scale * (twice - 1.0) * twice * (twice - 2.0),
        scale * (twice - 1.0) * (p * p - q * q),
        scale * 2.0 * (s + p - 1.0) * (s + q - 1.0) * twice * ratio(s - 1.0),
    ]
}

/// All series of a pair, whose first terms are summed together.
#[derive(Debug, Clone)]
struct SeriesTable {
    series: Vec<Series>,
    /// For every term from the first on: the coefficients of a [`step`], each for all series.
    steps: Vec<f64>,
}

impl SeriesTable {
    fn new(series: Vec<Series>) -> Self {
        let parameters: Vec<[f64; 4]> = series.iter().map(Series::parameters).collect();
        let mut steps = Vec::with_capacity(3 * TABLE * series.len());
        for number in 1..=TABLE {
            let of_series: Vec<[f64; 3]> = parameters
                .iter()
                .map(|of_series| step(*of_series, number as f64))
                .collect();
            for k in 0..3 {
                steps.extend(of_series.iter().map(|step| step[k]));
            }
        }
        Self { series, steps }
    }

    /// Evaluates the series.
    fn values(&self, discs: Discs, values: &mut [f64]) {
        let count = self.series.len();
        let [x, y] = [discs.receiver, discs.source].map(|r| (r / discs.distance).powi(2));
        let mut workspace = vec![0.0; 2 * count];
        let (term, before) = workspace.split_at_mut(count);
        term.fill(1.0);
        values.fill(1.0);
        let added = widest(
            #[inline(always)]
            || self.add_terms([x, y], [values, term, before]),
        );
        let powers = [discs.receiver, discs.source].map(|radius| {
            let mut powers = [discs.distance.recip(); MAXIMUM_DEGREE + 1];
            for degree in 1..=MAXIMUM_DEGREE {
                powers[degree] = powers[degree - 1] * (radius / discs.distance);
            }
            powers
        });
        for (k, (value, series)) in values.iter_mut().zip(&self.series).enumerate() {
            if added == TABLE {
                let known = [*value, term[k], before[k]];
                *value = series.appell_from(TABLE + 1, known, [x, y]);
            }
            let [l, n] = series.degrees.map(|degree| degree as usize);
            *value *= series.factor * powers[0][l] * (powers[1][n] * discs.distance);
        }
    }

    /// Adds terms until all are negligible or the table ends. Returns the number of terms.
    #[inline(always)]
    fn add_terms(&self, [x, y]: [f64; 2], [sum, term, before]: [&mut [f64]; 3]) -> usize {
        let count = sum.len();
        let (both, difference) = (x + y, y - x);
        let square = difference * difference;
        for (number, steps) in self.steps.chunks_exact(3 * count).enumerate() {
            let (of_sum, rest) = steps.split_at(count);
            let (of_difference, of_square) = rest.split_at(count);
            for k in 0..count {
                let next = (of_sum[k] * both + of_difference[k] * difference) * term[k]
                    - of_square[k] * square * before[k];
                before[k] = term[k];
                term[k] = next;
                sum[k] += next;
            }
            let is_done = |(term, sum): (&f64, &f64)| *term < SERIES_TOLERANCE * sum;
            if number % STRIDE == STRIDE - 1 && term.iter().zip(&*sum).all(is_done) {
                return number + 1;
            }
        }
        TABLE
    }
}

/// Degree and order of the mode of a receiver, and of that of a source.
type Orders = [(usize, usize); 2];

/// The series of one entry of the block between two pillars.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) receiver: Mode,
    pub(super) source: Mode,
    /// Indices of the series with `M = |m - m'|` and `M = m + m'`.
    pub(super) series: [usize; 2],
    pub(super) weight: f64,
}

/// Coupling between two pillars of a lattice, for the modes up to a degree.
#[derive(Debug, Clone)]
pub(crate) struct PairCoupling {
    modes: Vec<Mode>,
    series: SeriesTable,
    /// Radial function for pillars that act as flat punches on the centres of the others, without series.
    flat_punches: Option<RadialFunction>,
    /// Correction of every series for layers; `None` on half-spaces.
    layers: Option<Arc<PairTables>>,
    part: Part,
    /// Entries with source index >= receiver index, by rows.
    entries: Vec<Entry>,
}

/// Corrections of every series for layers, for every receiver and source.
#[derive(Debug)]
struct PairTables {
    layers: Vec<WeightedLayer>,
    parts: Arc<[RadialPart]>,
    /// The radii, in increasing order.
    radii: Vec<f64>,
    /// For every receiver and source; none if there are too many radii.
    tables: Vec<OnceLock<RadialTable>>,
}

impl PairTables {
    fn new(
        layers: &[WeightedLayer],
        parts: Vec<RadialPart>,
        radii: &[f64],
        tabulated: bool,
    ) -> Self {
        let tables = if tabulated {
            radii.len() * radii.len()
        } else {
            0
        };
        Self {
            layers: layers.to_vec(),
            parts: parts.into(),
            radii: radii.to_vec(),
            tables: (0..tables).map(|_| OnceLock::new()).collect(),
        }
    }

    /// A table without evaluated intervals.
    fn empty_table(&self, radii: [f64; 2]) -> RadialTable {
        RadialTable::of_radii(&self.layers, &self.parts, radii)
    }

    /// The table for these radii; `None` without one.
    fn table(&self, radii: [f64; 2]) -> Option<&RadialTable> {
        let find = |radius: f64| {
            self.radii
                .binary_search_by(|known| known.total_cmp(&radius))
        };
        let [Ok(receiver), Ok(source)] = radii.map(find) else {
            return None;
        };
        let table = self.tables.get(receiver * self.radii.len() + source)?;
        Some(table.get_or_init(|| self.empty_table(radii)))
    }

    fn values(&self, discs: Discs, values: &mut [f64]) {
        let radii = [discs.receiver, discs.source];
        match self.table(radii) {
            Some(table) => table.values(discs.distance, values),
            None => {
                let integrals = self.empty_table(radii).integrals_at(discs.distance);
                values.copy_from_slice(&integrals);
            }
        }
    }

    /// The derivatives with respect to the logarithm of the distance.
    fn by_distance(&self, discs: Discs, values: &mut [f64]) {
        let radii = [discs.receiver, discs.source];
        let [mut value, mut second] = [0; 2].map(|_| vec![0.0; values.len()]);
        let jets = [&mut value[..], &mut *values, &mut second];
        match self.table(radii) {
            Some(table) => table.jets(discs.distance, jets),
            None => self.empty_table(radii).jets(discs.distance, jets),
        }
        for value in values {
            *value *= discs.distance;
        }
    }
}

/// The part of the coupling that is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Whole,
    /// The derivative with respect to the logarithm of the distance.
    ByDistance,
    /// The correction for layers.
    Layers,
}

impl PairCoupling {
    /// The coupling of modes up to a degree.
    pub(crate) fn new(degree: usize) -> Self {
        let modes = modes(degree);
        let mut series = Vec::new();
        let mut known: Vec<(Orders, [usize; 2])> = Vec::new();
        let mut entries = Vec::with_capacity(mode_count(degree) * (mode_count(degree) + 1) / 2);
        for (row, &receiver) in modes.iter().enumerate() {
            for &source in &modes[row..] {
                let key = [receiver, source].map(|mode| (mode.degree, mode.order));
                let places = match known.iter().find(|known| known.0 == key) {
                    Some((_, places)) => *places,
                    None => {
                        let [m, n] = key.map(|(_, order)| order);
                        let mut orders = vec![m.abs_diff(n), m + n];
                        orders.dedup();
                        let first = series.len();
                        let of_order = |order| Series::new(key[0], key[1], order);
                        series.extend(orders.into_iter().map(of_order));
                        known.push((key, [first, series.len() - 1]));
                        [first, series.len() - 1]
                    }
                };
                entries.push(Entry::new(receiver, source, places));
            }
        }
        Self {
            modes,
            series: SeriesTable::new(series),
            flat_punches: None,
            layers: None,
            part: Part::Whole,
            entries,
        }
    }

    /// The coupling of the pillars of a scene, with layers if there are any.
    pub(crate) fn of_scene(degree: usize, scene: &Scene) -> Self {
        Self::new(degree).on_layers_of(scene)
    }

    /// The same on the layers of a scene, if there are any, for the radii of its pillars.
    pub(crate) fn on_layers_of(self, scene: &Scene) -> Self {
        if scene.layers.is_empty() {
            return self;
        }
        let radii = scene.field.radii();
        let pillars = scene.field.expected_len(f64::INFINITY);
        let tabulated = radii.len() == 1 || TABULATED * radii.len() as f64 <= pillars;
        self.on_layers(&scene.layers, &radii, tabulated)
    }

    /// Degree 0 with the displacement `(2/pi) zeta arcsin(1/delta)` of a flat punch at the centre of the receiving pillar instead of its
    /// average over the pillar, as in the paper.
    pub(crate) fn of_flat_punches() -> Self {
        Self {
            flat_punches: Some(RadialFunction::new(0, 0)),
            ..Self::new(0)
        }
    }

    /// The same for pillars of unit radius on layers.
    #[cfg(test)]
    pub(crate) fn with_layers(&self, layers: &[WeightedLayer]) -> Self {
        self.on_layers(layers, &[1.0], true)
    }

    /// The same on layers, for pillars of these radii in increasing order; with tables of the corrections for every two radii, or with
    /// integrals for every two pillars.
    fn on_layers(&self, layers: &[WeightedLayer], radii: &[f64], tabulated: bool) -> Self {
        if layers.is_empty() {
            return self.clone();
        }
        // For flat punches, the displacement of a point due to a point force: 2 is the square of their force divided by pi.
        let of_points = RadialPart {
            factor: 2.0,
            degrees: Vec::new(),
            order: 0,
            power: 0,
        };
        let mut parts = vec![of_points; self.radial_count()];
        if self.flat_punches.is_none() {
            for entry in &self.entries {
                let Entry {
                    receiver, source, ..
                } = entry;
                let [m, n] = [receiver.order, source.order];
                for (series, order) in entry.series.into_iter().zip([m.abs_diff(n), m + n]) {
                    let sign = (receiver.degree + order) as i64 - source.degree as i64;
                    let sign = if sign % 4 == 0 { 1.0 } else { -1.0 };
                    let values = [receiver, source]
                        .map(|mode| equator_value(mode.degree, mode.order))
                        .into_iter();
                    parts[series] = RadialPart {
                        factor: sign * 4.0 * PI * values.product::<f64>(),
                        degrees: vec![receiver.degree, source.degree],
                        order,
                        power: 0,
                    };
                }
            }
        }
        Self {
            layers: Some(Arc::new(PairTables::new(layers, parts, radii, tabulated))),
            ..self.clone()
        }
    }

    /// Whether there are layers, through which a pillar acts on itself.
    pub(crate) fn has_layers(&self) -> bool {
        self.layers.is_some()
    }

    /// The effect of a pillar of this radius on itself due to layers, by rows.
    pub(crate) fn own_block(&self, radius: f64) -> Option<Vec<f64>> {
        let layers = self.layers.as_ref()?;
        if self.part == Part::ByDistance {
            return None;
        }
        let discs = Discs {
            receiver: radius,
            source: radius,
            distance: 0.0,
        };
        let mut radial = vec![0.0; self.radial_count()];
        layers.values(discs, &mut radial);
        let mut block = vec![0.0; self.modes.len() * self.modes.len()];
        self.fill_block([&radial; 2], [1.0, 0.0], &mut block);
        Some(block)
    }

    /// The derivative of the coupling with respect to the logarithm of the distance, for changes of the pitch. It has the same symmetries.
    pub(crate) fn by_distance(&self) -> Self {
        Self {
            part: Part::ByDistance,
            ..self.clone()
        }
    }

    /// The correction for layers without the half-spaces: for [changes](WeightedLayer::change) of layers.
    pub(crate) fn of_layers_alone(&self, layers: &[WeightedLayer]) -> Self {
        let present = self.layers.as_deref();
        let (radii, tabulated) = present.map_or((&[1.0][..], true), |tables| {
            (&tables.radii, !tables.tables.is_empty())
        });
        Self {
            part: Part::Layers,
            ..self.on_layers(layers, radii, tabulated)
        }
    }

    pub(crate) fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// Highest degree of the modes.
    pub(crate) fn degree(&self) -> usize {
        self.modes.last().map_or(0, |mode| mode.degree)
    }

    /// Number of entries of a block on and above its diagonal.
    pub(crate) fn entry_count(&self) -> usize {
        self.entries.len()
    }

    /// Number of radial functions of [`Self::radial`].
    pub(crate) fn radial_count(&self) -> usize {
        self.series.series.len()
    }

    /// Computes the parts that depend on the distance alone (`delta` in pillar radii) into `radial`.
    pub(crate) fn radial(&self, delta: f64, radial: &mut [f64]) {
        let discs = Discs {
            receiver: 1.0,
            source: 1.0,
            distance: delta,
        };
        self.radial_of(discs, radial);
    }

    /// The same for discs of any radii.
    pub(crate) fn radial_of(&self, discs: Discs, radial: &mut [f64]) {
        match (&self.flat_punches, self.part) {
            (_, Part::Layers) => radial.fill(0.0),
            (Some(punch), _) => {
                radial.fill(UNIT_FORCE * punch.value(discs.distance.recip()));
            }
            (None, Part::ByDistance) => {
                for (value, series) in radial.iter_mut().zip(&self.series.series) {
                    *value = series.derivatives(discs)[0];
                }
            }
            (None, Part::Whole) => self.series.values(discs, radial),
        }
        if let Some(layers) = &self.layers {
            let mut more = vec![0.0; radial.len()];
            if self.part == Part::ByDistance {
                layers.by_distance(discs, &mut more);
            } else {
                layers.values(discs, &mut more);
            }
            for (value, more) in radial.iter_mut().zip(more) {
                *value += more;
            }
        }
    }

    /// Entries on and above the diagonal of the block for the unit vector `direction` from source to receiver, by rows.
    pub(crate) fn upper_block(&self, radial: &[f64], direction: [f64; 2], block: &mut [f64]) {
        let angles = Angles::new(direction, self.degree());
        for (value, entry) in block.iter_mut().zip(&self.entries) {
            *value = entry.value(radial, &angles);
        }
    }

    /// The complete block for receiver minus source `= [x, y]`, in pillar radii, by rows: a row is a mode of the receiver.
    pub(crate) fn block(&self, offset: [f64; 2], block: &mut [f64]) {
        self.block_of(offset, [1.0; 2], block);
    }

    /// The same for moments of discs of two radii, that of the receiver first, which must not overlap.
    pub(crate) fn block_of(
        &self,
        [x, y]: [f64; 2],
        [receiver, source]: [f64; 2],
        block: &mut [f64],
    ) {
        let distance = x.hypot(y);
        let direction = [x / distance, y / distance];
        let radial_of = |receiver: f64, source: f64| {
            let mut radial = vec![0.0; self.radial_count()];
            let discs = Discs {
                receiver,
                source,
                distance,
            };
            self.radial_of(discs, &mut radial);
            radial
        };
        let radial = radial_of(receiver, source);
        let differ = receiver.to_bits() != source.to_bits();
        let exchanged = differ.then(|| radial_of(source, receiver));
        let exchanged = exchanged.as_ref().unwrap_or(&radial);
        self.fill_block([&radial, exchanged], direction, block);
    }

    /// The derivatives of this block with respect to the logarithm of the distance, and to that of the receiver's radius, on half-spaces.
    pub(crate) fn block_derivatives(
        &self,
        [x, y]: [f64; 2],
        [receiver, source]: [f64; 2],
        [by_distance, by_receiver]: [&mut [f64]; 2],
    ) {
        let distance = x.hypot(y);
        let direction = [x / distance, y / distance];
        let radial_of = |receiver: f64, source: f64| -> Vec<[f64; 3]> {
            let discs = Discs {
                receiver,
                source,
                distance,
            };
            let of_series = |series: &Series| series.derivatives(discs);
            self.series.series.iter().map(of_series).collect()
        };
        let radial = radial_of(receiver, source);
        let exchanged = radial_of(source, receiver);
        let part = |of: &[[f64; 3]], k: usize| -> Vec<f64> { of.iter().map(|d| d[k]).collect() };
        let parts =
            |k: usize, exchanged_k: usize| [part(&radial, k), part(&exchanged, exchanged_k)];
        for (block, [radial, exchanged]) in [(by_distance, parts(0, 0)), (by_receiver, parts(1, 2))]
        {
            self.fill_block([&radial, &exchanged], direction, block);
        }
    }

    /// Computes a block from its radial parts, and from those with receiver and source exchanged.
    fn fill_block(&self, [radial, exchanged]: [&[f64]; 2], direction: [f64; 2], block: &mut [f64]) {
        let count = self.modes.len();
        let angles = Angles::new(direction, self.degree());
        let mut entries = self.entries.iter();
        for row in 0..count {
            for column in row..count {
                let Some(entry) = entries.next() else { return };
                block[row * count + column] = entry.value(radial, &angles);
                if column > row {
                    // C_ji(D; a, a') = C_ij(-D; a', a) = (-1)^(l + l') C_ij(D; a', a)
                    let odd = (entry.receiver.degree + entry.source.degree) % 2 == 1;
                    let value = entry.value(exchanged, &angles);
                    block[column * count + row] = if odd { -value } else { value };
                }
            }
        }
    }
}

impl Entry {
    pub(super) fn new(receiver: Mode, source: Mode, series: [usize; 2]) -> Self {
        let axial = |mode: Mode| if mode.order == 0 { FRAC_1_SQRT_2 } else { 1.0 };
        Self {
            receiver,
            source,
            series,
            weight: axial(receiver) * axial(source),
        }
    }

    fn value(&self, radial: &[f64], angles: &Angles) -> f64 {
        let (m, n) = (self.receiver.order, self.source.order);
        let difference = angles.of(n as isize - m as isize);
        let sum = angles.0[n + m];
        let [minus, plus] = self.series.map(|series| radial[series]);
        self.weight
            * match (self.receiver.sine, self.source.sine) {
                (false, false) => minus * difference[0] + plus * sum[0],
                (true, true) => minus * difference[0] - plus * sum[0],
                (false, true) => minus * difference[1] + plus * sum[1],
                (true, false) => -minus * difference[1] + plus * sum[1],
            }
    }
}

/// Cosine and sine of the multiples of an angle.
pub(super) struct Angles([[f64; 2]; 2 * MAXIMUM_DEGREE + 1]);

impl Angles {
    /// Multiples of the angle of a unit vector, up to twice a degree.
    pub(super) fn new([cos, sin]: [f64; 2], degree: usize) -> Self {
        let mut angles = [[1.0, 0.0]; 2 * MAXIMUM_DEGREE + 1];
        for multiple in 1..=2 * degree {
            let [before, across] = angles[multiple - 1];
            angles[multiple] = [before * cos - across * sin, before * sin + across * cos];
        }
        Self(angles)
    }

    /// Cosine and sine of a multiple, which may be negative.
    #[inline]
    pub(super) fn of(&self, multiple: isize) -> [f64; 2] {
        let [cos, sin] = self.0[multiple.unsigned_abs()];
        [cos, if multiple < 0 { -sin } else { sin }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::disc::basis::BasisEvaluator;
    use crate::halfspace::layer::tests::{film, modes_of, rows};
    use crate::numerics::quadrature::hemisphere;

    /// `∫∫ Y_i Y_j/(pi |x - x'|) dOmega dOmega'` over two discs, by product quadrature.
    fn by_quadrature(degree: usize, offset: [f64; 2], [a, b]: [f64; 2]) -> Vec<f64> {
        let count = mode_count(degree);
        let mut basis = BasisEvaluator::new(degree);
        let rule: Vec<_> = hemisphere(22, 80)
            .into_iter()
            .map(|(point, weight)| {
                let mut values = vec![0.0; count];
                basis.evaluate(point, &mut values);
                (point, weight, values)
            })
            .collect();
        let mut block = vec![0.0; count * count];
        let mut field = vec![0.0; count];
        for (at, weight, receiver) in &rule {
            field.fill(0.0);
            for (from, weight, source) in &rule {
                let distance = (a * at[0] + offset[0] - b * from[0])
                    .hypot(a * at[1] + offset[1] - b * from[1]);
                for (sum, value) in field.iter_mut().zip(source) {
                    *sum += weight * value / (PI * distance);
                }
            }
            for (row, value) in receiver.iter().enumerate() {
                for (column, field) in field.iter().enumerate() {
                    block[row * count + column] += weight * value * field;
                }
            }
        }
        block
    }

    #[test]
    fn layers_add_what_the_table_has() {
        // In um for a radius of 3 um.
        let (half_spaces, film) = (PairCoupling::new(2), film());
        let layered = half_spaces.with_layers(&[film]);
        for (case, value) in rows("Delta g") {
            let (modes, distance) = modes_of(&case);
            let order: usize = case.split("M=").nth(1).unwrap()[..1].parse().unwrap();
            let is_it = |entry: &&Entry| {
                let pair = [entry.receiver, entry.source];
                let own = pair.map(|mode| (mode.degree, mode.order));
                own == [modes[0], modes[1]] || own == [modes[1], modes[0]]
            };
            let entry = half_spaces.entries.iter().find(is_it).unwrap();
            let [m, n] = [entry.receiver.order, entry.source.order];
            let series = entry.series[usize::from(order != m.abs_diff(n))];
            assert!(order == m.abs_diff(n) || order == m + n);
            let radial = |pair: &PairCoupling| {
                let mut radial = vec![0.0; pair.radial_count()];
                pair.radial(distance / 3.0, &mut radial);
                radial[series]
            };
            let found = if distance > 0.0 {
                radial(&layered) - radial(&half_spaces)
            } else {
                layered.own_block(1.0).unwrap()[0]
            };
            let tolerance = 1e-12 + 1e-12 * value.abs();
            assert!(
                (3.0 * found - value).abs() < tolerance,
                "{case}: {}",
                3.0 * found
            );
        }
    }

    #[test]
    fn discs_on_a_layer_by_double_quadrature() {
        // The far displacement of the layer between all points of two discs, and of one disc with itself.
        let degree = 4;
        let count = mode_count(degree);
        let film = film();
        let response = crate::halfspace::layer::LayerResponse::of(&film);
        let mut basis = BasisEvaluator::new(degree);
        let rule: Vec<_> = hemisphere(6, 24)
            .into_iter()
            .map(|(point, weight)| {
                let mut values = vec![0.0; count];
                basis.evaluate(point, &mut values);
                (point, weight, values)
            })
            .collect();
        // Even polynomials: accurate to 1e-9 for the distances in this test.
        let samples: Vec<f64> = (0..=2000)
            .map(|k| response.far_displacement(f64::from(k) * 1e-3) / 2.0)
            .collect();
        let at = |distance: f64| {
            let place = 0.5 * distance * 1e3;
            let k = (place as usize).clamp(1, 1997);
            let x = place - k as f64;
            let [a, b, c, d] = [k - 1, k, k + 1, k + 2].map(|k| samples[k]);
            // Cubic through four points.
            -a * x * (x - 1.0) * (x - 2.0) / 6.0 + b * (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0
                - c * (x + 1.0) * x * (x - 2.0) / 2.0
                + d * (x + 1.0) * x * (x - 1.0) / 6.0
        };
        let pair = PairCoupling::new(degree);
        let unlike = [0.6, 0.9, 1.3];
        let tabulated = pair.on_layers(&[film], &unlike, true);
        let integrated = pair.on_layers(&[film], &unlike, false);
        let alike = pair.with_layers(&[film]);
        for (layered, offset, [a, b]) in [
            (&alike, [0.0, 0.0], [1.0; 2]),
            (&alike, [1.6, 1.4], [1.0; 2]),
            (&tabulated, [0.0, 0.0], [0.6; 2]),
            (&tabulated, [1.5, 1.2], [0.6, 1.3]),
            (&integrated, [-1.2, 1.5], [1.3, 0.6]),
            (&integrated, [0.0, 0.0], [1.3; 2]),
        ] {
            let mut expected = vec![0.0; count * count];
            for (to, weight, receiver) in &rule {
                for (from, of_source, source) in &rule {
                    let distance = (a * to[0] + offset[0] - b * from[0])
                        .hypot(a * to[1] + offset[1] - b * from[1]);
                    let value = weight * of_source * at(distance) / PI;
                    for (row, y) in receiver.iter().enumerate() {
                        for (column, x) in source.iter().enumerate() {
                            expected[row * count + column] += value * y * x;
                        }
                    }
                }
            }
            let found = if offset == [0.0, 0.0] {
                layered.own_block(a).unwrap()
            } else {
                let blocks = [layered, &pair].map(|pair| {
                    let mut block = vec![0.0; count * count];
                    pair.block_of(offset, [a, b], &mut block);
                    block
                });
                blocks[0]
                    .iter()
                    .zip(&blocks[1])
                    .map(|(a, b)| a - b)
                    .collect()
            };
            for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
                assert!(
                    (found - expected).abs() < 1e-8,
                    "entry {k}: {found} {expected}"
                );
            }
        }
    }

    /// Tables and integrals are the same functions, also as derivatives with respect to the distance.
    #[test]
    fn tables_are_integrals() {
        let degree = 4;
        let count = mode_count(degree);
        let pair = PairCoupling::new(degree);
        let [tables, integrals] =
            [true, false].map(|tabulated| pair.on_layers(&[film()], &[0.4, 1.0], tabulated));
        for offset in [[1.9, 0.4], [-30.0, 17.0]] {
            for part in [Part::Whole, Part::ByDistance] {
                let [table, integral] = [&tables, &integrals].map(|pair| {
                    let mut block = vec![0.0; count * count];
                    let pair = PairCoupling {
                        part,
                        ..pair.clone()
                    };
                    pair.block_of(offset, [0.4, 1.0], &mut block);
                    block
                });
                for (table, integral) in table.iter().zip(&integral) {
                    assert!((table - integral).abs() < 2e-14, "{table} {integral}");
                }
            }
        }
    }

    /// Far discs are point forces with the second moment of a flat punch, `2/3 a^2`, on the layer's Green's function.
    #[test]
    fn far_discs_on_a_layer_are_forces() {
        let film = film();
        let around = crate::halfspace::layer::force::AroundForce::at_point(&[film]).unwrap();
        let pair = PairCoupling::new(0).on_layers(&[film], &[0.4, 1.2], true);
        for distance in [8.0, 20.0] {
            let [value, laplacian] = around.value_and_laplacian(distance);
            let of_size = (0.4_f64.powi(2) + 1.2_f64.powi(2)) / 6.0;
            let expected = distance.recip() + value + of_size * (distance.powi(-3) + laplacian);
            let mut block = [0.0];
            pair.block_of([distance, 0.0], [0.4, 1.2], &mut block);
            let found = block[0] * PI / (UNIT_FORCE * UNIT_FORCE);
            let error = (found - expected).abs() * distance;
            assert!(error < 3.0 * distance.powi(-4), "{distance}: {error:e}");
        }
    }

    #[test]
    fn blocks_by_double_quadrature() {
        let degree = 4;
        let count = mode_count(degree);
        let pair = PairCoupling::new(degree);
        for offset in [[3.7, 0.0], [2.9, 2.5], [-6.0, 1.0]] {
            let expected = by_quadrature(degree, offset, [1.0; 2]);
            let mut block = vec![0.0; count * count];
            pair.block(offset, &mut block);
            for (k, (found, expected)) in block.iter().zip(&expected).enumerate() {
                assert!(
                    (found - expected).abs() < 1e-12,
                    "entry {k} at {offset:?}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn action_equals_reaction() {
        let degree = 5;
        let count = mode_count(degree);
        let pair = PairCoupling::new(degree);
        let (mut there, mut back) = (vec![0.0; count * count], vec![0.0; count * count]);
        pair.block([2.2, -1.9], &mut there);
        pair.block([-2.2, 1.9], &mut back);
        for i in 0..count {
            for j in 0..count {
                let difference = there[i * count + j] - back[j * count + i];
                assert!(difference.abs() < 1e-15);
            }
        }
    }

    #[test]
    fn blocks_of_two_radii_by_double_quadrature() {
        let degree = 4;
        let count = mode_count(degree);
        let pair = PairCoupling::new(degree);
        for (offset, radii) in [([2.3, 0.4], [1.0, 0.3]), ([-1.9, 2.5], [0.7, 1.2])] {
            let expected = by_quadrature(degree, offset, radii);
            let mut block = vec![0.0; count * count];
            pair.block_of(offset, radii, &mut block);
            for (k, (found, expected)) in block.iter().zip(&expected).enumerate() {
                assert!(
                    (found - expected).abs() < 1e-12,
                    "entry {k} at {offset:?}: {found} {expected}"
                );
            }
        }
    }

    /// Receiver radius 1, source radius 0.3. Reference: the series in a separate program; for touching discs, with 30 digits up to terms
    /// 256 to 16384 and Richardson extrapolation in their number.
    #[test]
    fn two_radii_are_those_of_the_reference() {
        let pair = PairCoupling::new(2);
        let mut block = vec![0.0; 36];
        for (distance, expected, tolerance) in [
            (1.3, [1.828_542_998_793_686, -0.147_835_354_740_613], 1e-12),
            (1.31, [1.803_157_767_7, -0.131_681_992_12], 1e-10),
            (2.0, [1.053_096_703_43, -0.009_933_320_397_87], 1e-11),
        ] {
            pair.block_of([distance, 0.0], [1.0, 0.3], &mut block);
            for (place, expected) in [0, 10].into_iter().zip(expected) {
                let found: f64 = block[place];
                assert!(
                    (found - expected).abs() < tolerance,
                    "{distance}: {found} {expected}"
                );
            }
        }
    }

    /// Reciprocity, and `C(s D; s a, s a') = C(D; a, a')/s`.
    #[test]
    fn exchanged_and_scaled_discs() {
        let degree = 3;
        let count = mode_count(degree);
        let pair = PairCoupling::new(degree);
        let block = |pair: &PairCoupling, offset: [f64; 2], radii: [f64; 2]| {
            let mut block = vec![0.0; count * count];
            pair.block_of(offset, radii, &mut block);
            block
        };
        let film = film();
        let thicker = WeightedLayer {
            thickness: 2.5 * film.thickness,
            ..film
        };
        let layered = |film, radii: [f64; 2]| pair.on_layers(&[film], &radii, true);
        let on_layers = [layered(film, [0.4, 0.9]), layered(thicker, [1.0, 2.25])];
        for [pair, larger] in [[&pair, &pair], [&on_layers[0], &on_layers[1]]] {
            let there = block(pair, [1.4, -0.6], [0.9, 0.4]);
            let back = block(pair, [-1.4, 0.6], [0.4, 0.9]);
            let scaled = block(larger, [3.5, -1.5], [2.25, 1.0]);
            for i in 0..count {
                for j in 0..count {
                    let value = there[i * count + j];
                    assert!((value - back[j * count + i]).abs() < 1e-15);
                    assert!((value - 2.5 * scaled[i * count + j]).abs() < 1e-14);
                }
            }
        }
    }

    /// A point receives the displacement at its position divided by the root of `2 pi`: `arcsin(1/delta)/pi` times `sqrt(2 pi)` for the
    /// lowest mode (Copson).
    #[test]
    fn a_point_is_a_disc_without_radius() {
        let pair = PairCoupling::new(2);
        let mut block = vec![0.0; 36];
        pair.block_of([1.7, 0.0], [0.0, 1.0], &mut block);
        let exterior = RadialFunction::new(0, 0);
        let expected = UNIT_FORCE * exterior.value(1.0 / 1.7);
        assert!(
            (block[0] / expected - 1.0).abs() < 1e-14,
            "{} {expected}",
            block[0]
        );
        assert!(block[6..].iter().all(|value| *value == 0.0));
    }

    /// Compares with central differences of blocks, and checks `C(s D; s a, s a') = C/s` for the derivatives.
    #[test]
    fn derivatives_of_blocks() {
        let degree = 4;
        let count = mode_count(degree);
        let pair = PairCoupling::new(degree);
        for (offset, [a, b]) in [([1.4, -0.6], [0.9, 0.4]), ([2.9, 2.5], [1.0, 1.0])] {
            let at = |distance: f64, receiver: f64, source: f64| {
                let mut block = vec![0.0; count * count];
                let offset = offset.map(|x: f64| x * distance.exp());
                pair.block_of(offset, [a * receiver.exp(), b * source.exp()], &mut block);
                block
            };
            let difference = |step: &dyn Fn(f64) -> Vec<f64>| -> Vec<f64> {
                let h = 1e-3;
                let ends = [step(h), step(-h), step(2.0 * h), step(-2.0 * h)];
                (0..count * count)
                    .map(|k| {
                        let [near, far] = [0, 2].map(|n| ends[n][k] - ends[n + 1][k]);
                        (8.0 * near - far) / (12.0 * h)
                    })
                    .collect()
            };
            let (mut distance, mut receiver) = (at(0.0, 0.0, 0.0), at(0.0, 0.0, 0.0));
            let block = distance.clone();
            pair.block_derivatives(offset, [a, b], [&mut distance, &mut receiver]);
            let mut alone = vec![0.0; count * count];
            pair.by_distance().block_of(offset, [a, b], &mut alone);
            assert!(
                distance
                    .iter()
                    .zip(&alone)
                    .all(|(x, y)| (x - y).abs() < 1e-14)
            );
            let source: Vec<f64> = (0..count * count)
                .map(|k| -block[k] - distance[k] - receiver[k])
                .collect();
            for (found, expected) in [
                (distance, difference(&|h| at(h, 0.0, 0.0))),
                (receiver, difference(&|h| at(0.0, h, 0.0))),
                (source, difference(&|h| at(0.0, 0.0, h))),
            ] {
                for (found, expected) in found.iter().zip(&expected) {
                    let error = (found - expected).abs();
                    assert!(error < 1e-9, "{found} {expected}");
                }
            }
        }
    }

    #[test]
    fn touching_pillars_are_the_limit_of_close_ones() {
        let pair = PairCoupling::new(0);
        let at = |distance: f64| {
            let mut block = [0.0];
            pair.block([distance, 0.0], &mut block);
            block[0]
        };
        let (close, touching) = (at(2.0 + 1e-6), at(2.0));
        assert!((close / touching - 1.0).abs() < 1e-5, "{close} {touching}");
    }
}
