//! Scaling laws in dimensionless groups: products of powers, and a sum.
//!
//! Slopes are small and the lens is flat, so that heights and lengths along the surface scale independently. With `E*` the reduced modulus, `a` the radius, `h` the height and `d` the diameter of
//! pillars and `R` the radius of the lens, the remaining groups are the surface fraction, `R h/d^2`, `kappa`, and one group with the work of adhesion: `w a/(E* h^2)` or `w/w_c`, where `w_c` is the
//! work of adhesion at which the flat lattice collapses.

use super::study::{FloorCase, OnCells};
use fakir::solve::collapsed_floor::{MODEL_ERROR_OF_AREA, NARROWEST_FRONT};
use fakir_study::{FloorJump, FloorLoss, FloorOutcome, Validity};
use std::f64::consts::PI;

/// Dimensionless quantity of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reduced {
    /// Withdrawal of the lens until the floor detaches: `1 - zeta_lost/zeta_c`.
    Withdrawal,
    /// Floor contact area after the jump over the area of the contact: `A/(pi a_c^2)`.
    Area,
    /// Relative force drop at the jump: `1 - F/F_c`.
    Drop,
    /// Pull-off force with the floor over that of a smooth sphere, `3/2 pi w R`.
    PullOff,
    /// Hysteresis of the floor over `F_c zeta_c`.
    Hysteresis,
}

impl Reduced {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Withdrawal,
        Self::Area,
        Self::Drop,
        Self::PullOff,
        Self::Hysteresis,
    ];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Withdrawal => "withdrawal",
            Self::Area => "area",
            Self::Drop => "force_drop",
            Self::PullOff => "pull_off",
            Self::Hysteresis => "hysteresis",
        }
    }

    /// Form of its law.
    #[must_use]
    pub fn form(self) -> Form {
        match self {
            // It vanishes at a finite work of adhesion.
            Self::PullOff => Form::Sum,
            _ => Form::Powers,
        }
    }

    /// Formula as written in figures.
    #[must_use]
    pub fn formula(self) -> &'static str {
        match self {
            Self::Withdrawal => "1 − *ζ*_{lost}/*ζ*_{c}",
            Self::Area => "*A*/(*π* *a*_{c}^{2})",
            Self::Drop => "1 − *F*/*F*_{c}",
            Self::PullOff => "*F*_{off}/(3*π* *w* *R*/2)",
            Self::Hysteresis => "*W*/(*F*_{c} *ζ*_{c})",
        }
    }

    /// Formula as written in the report.
    #[must_use]
    pub fn plain(self) -> &'static str {
        match self {
            Self::Withdrawal => "1 - ζ_lost/ζ_c",
            Self::Area => "A/(π a_c^2)",
            Self::Drop => "1 - F/F_c",
            Self::PullOff => "F_off/(3π w R/2)",
            Self::Hysteresis => "W/(F_c ζ_c)",
        }
    }

    /// Value in a case: from floor cells if they resolve it, otherwise from the fast model within its range. `None` in other cases and if the
    /// value is not positive.
    #[must_use]
    pub fn of(self, case: &FloorCase) -> Option<f64> {
        let on_cells = case.cells.and_then(|cells| self.on_cells(case, cells));
        let value = on_cells.or_else(|| self.by_model(case))?;
        (value > 0.0 && value.is_finite()).then_some(value)
    }

    /// Value from floor cells, if its estimated error is at most [`KNOWN_TO`]. Values after the jump require a bonded region as large as the fast
    /// model requires, because with fewer hollow sites their number causes steps. These cycles turn back at the first floor contact, so that their
    /// hysteresis cannot be compared with that of the model.
    fn on_cells(self, case: &FloorCase, cells: OnCells) -> Option<f64> {
        let held = case.fate() == Some(FloorOutcome::HeldThroughZero);
        let pull = cells.pull_off.filter(|_| held);
        let wide = cells.jump.front_radius >= NARROWEST_FRONT * cells.pitch;
        let quotient = self.quotient(&Figures {
            critical_indentation: cells.critical_indentation?,
            critical_contact_radius: cells.critical_contact_radius?,
            critical_force: cells.critical_force?,
            smooth_pull_off: 1.5 * PI * cells.work * case.lens_radius,
            jump: Some(cells.jump).filter(|_| wide),
            lost: cells.lost,
            pull_off: pull,
            hysteresis: None,
        })?;
        let relative_error = match self {
            Self::Withdrawal => cells.lost_indentation_error,
            Self::Area => cells.jump_area_error,
            Self::Drop => cells.jump_force_error,
            Self::PullOff | Self::Hysteresis => pull.map_or(0.0, |_| cells.pull_off_error),
        };
        let value = self.value_of(quotient);
        ((relative_error * quotient).abs() <= KNOWN_TO * value.abs()).then_some(value)
    }

    /// Value from the fast model within its range.
    fn by_model(self, case: &FloorCase) -> Option<f64> {
        let found = &case.found;
        let validity = match self {
            Self::Area | Self::Drop => found.jump_validity,
            _ => found.unloading_validity,
        };
        if validity != Validity::InRange {
            return None;
        }
        let quotient = self.quotient(&Figures {
            critical_indentation: found.critical_indentation,
            critical_contact_radius: found.critical_contact_radius,
            critical_force: found.critical_force,
            smooth_pull_off: 1.5 * PI * found.work * case.lens_radius,
            jump: found.jump,
            lost: found.lost,
            pull_off: found.pull_off,
            hysteresis: found.hysteresis,
        })?;
        Some(self.value_of(quotient))
    }

    /// A value and the scale that makes it dimensionless.
    fn quotient(self, figures: &Figures) -> Option<f64> {
        Some(match self {
            Self::Withdrawal => figures.lost?.indentation / figures.critical_indentation,
            Self::Area => figures.jump?.floor_area / (PI * figures.critical_contact_radius.powi(2)),
            Self::Drop => figures.jump?.force / figures.critical_force,
            Self::PullOff => -figures.pull_off? / figures.smooth_pull_off,
            Self::Hysteresis => {
                figures.hysteresis? / (figures.critical_force * figures.critical_indentation)
            }
        })
    }

    /// The dimensionless number: one minus the quotient, or the quotient.
    fn value_of(self, quotient: f64) -> f64 {
        match self {
            Self::Withdrawal | Self::Drop => 1.0 - quotient,
            Self::Area | Self::PullOff | Self::Hysteresis => quotient,
        }
    }
}

/// Results of a cycle, from floor cells or the fast model, in SI units.
struct Figures {
    critical_indentation: f64,
    critical_contact_radius: f64,
    critical_force: f64,
    /// The pull-off force of a smooth sphere.
    smooth_pull_off: f64,
    jump: Option<FloorJump>,
    lost: Option<FloorLoss>,
    pull_off: Option<f64>,
    hysteresis: Option<f64>,
}

/// Largest relative error of a value from floor cells that is used in laws: the error of areas of the
/// fast model.
const KNOWN_TO: f64 = MODEL_ERROR_OF_AREA;

/// Form of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Product of powers, fitted by least squares in logarithms; deviations are relative.
    Powers,
    /// Weighted sum, fitted by least squares; deviations are absolute.
    Sum,
}

impl Form {
    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Powers => "powers",
            Self::Sum => "sum",
        }
    }

    /// Transformation in which a law is linear, and its inverse.
    fn linear(self, value: f64) -> f64 {
        match self {
            Self::Powers => value.ln(),
            Self::Sum => value,
        }
    }

    fn value(self, linear: f64) -> f64 {
        match self {
            Self::Powers => linear.exp(),
            Self::Sum => linear,
        }
    }

    /// Converts a difference in the variable in which the law is linear into a deviation.
    fn distance(self, difference: f64) -> f64 {
        match self {
            Self::Powers => difference.abs().exp_m1(),
            Self::Sum => difference.abs(),
        }
    }
}

/// A dimensionless group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// `w/w_c`.
    Threshold,
    /// `w_c/w`.
    Collapse,
    /// `w a/(E* h^2)`.
    Work,
    /// The surface fraction.
    Fraction,
    /// `R h/d^2`.
    Lens,
    /// `1 + kappa`.
    Column,
}

impl Group {
    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Threshold => "w/w_c",
            Self::Collapse => "w_c/w",
            Self::Work => "w a/(E h^2)",
            Self::Fraction => "φ",
            Self::Lens => "R h/d^2",
            Self::Column => "1 + κ",
        }
    }

    /// Symbol as written in figures.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Threshold => "(*w*/*w*_{c})",
            Self::Collapse => "*w*_{c}/*w*",
            Self::Work => "(*w* *a*/*E* *h*^{2})",
            Self::Fraction => "*φ*",
            Self::Lens => "(*R* *h*/*d*^{2})",
            Self::Column => "(1+*κ*)",
        }
    }

    /// Its value.
    #[must_use]
    pub fn of(self, case: &FloorCase) -> f64 {
        let found = &case.found;
        match self {
            Self::Threshold => found.work_over_collapse_work,
            Self::Collapse => found.work_over_collapse_work.recip(),
            Self::Work => found.work_over_stiffness * (0.5 * case.diameter / case.height).powi(2),
            Self::Fraction => found.surface_fraction,
            Self::Lens => found.lens_number,
            Self::Column => 1.0 + found.column_number,
        }
    }
}

/// A law fitted by least squares.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// Its quantity.
    pub reduced: Reduced,
    /// The groups.
    pub groups: Vec<Group>,
    /// Exponent of each group, or its factor in a sum, with its standard error.
    pub exponents: Vec<[f64; 2]>,
    /// Range of each group in the cases.
    pub ranges: Vec<[f64; 2]>,
    /// Prefactor, or the constant of a sum.
    pub prefactor: f64,
    /// Number of cases.
    pub points: usize,
    /// Root mean square deviation of the cases from the law, with the remaining degrees of freedom.
    pub scatter: f64,
    /// Largest deviation.
    pub largest: f64,
    /// The same deviation by cross-validation: each system, with all its works of adhesion, is compared with a law fitted without it. The groups are chosen
    /// by this residual.
    pub left_out: f64,
    /// Deviation that 95 % of the cases do not exceed in this cross-validation.
    pub band: f64,
}

/// Linear equation for the coefficients of a law, from one case.
struct Equation {
    row: Vec<f64>,
    value: f64,
    system: [u64; 5],
}

impl Equation {
    fn residual(&self, coefficients: &[f64]) -> f64 {
        self.value - product(&self.row, coefficients)
    }
}

/// Normal matrix of least squares.
fn normal_matrix<'e>(
    size: usize,
    equations: impl IntoIterator<Item = &'e Equation>,
) -> Vec<Vec<f64>> {
    let mut normal = vec![vec![0.0; size]; size];
    for Equation { row, .. } in equations {
        for (line, x) in normal.iter_mut().zip(row) {
            for (sum, y) in line.iter_mut().zip(row) {
                *sum += x * y;
            }
        }
    }
    normal
}

/// Coefficients by least squares, from the inverse of the normal matrix.
fn solution<'e>(
    inverse: &[Vec<f64>],
    equations: impl IntoIterator<Item = &'e Equation>,
) -> Vec<f64> {
    let mut right = vec![0.0; inverse.len()];
    for Equation { row, value, .. } in equations {
        for (sum, x) in right.iter_mut().zip(row) {
            *sum += x * value;
        }
    }
    inverse.iter().map(|row| product(row, &right)).collect()
}

/// Fraction of the cases to which [`Law::band`] applies.
const IN_BAND: f64 = 0.95;

impl Law {
    /// Fits the law of a quantity in groups. `None` if there are too few cases or if groups do not vary
    /// independently.
    #[must_use]
    pub fn fit(reduced: Reduced, groups: &[Group], cases: &[&FloorCase]) -> Option<Self> {
        let form = reduced.form();
        let equation = |case: &&FloorCase| {
            let value = form.linear(reduced.of(case)?);
            let ones = std::iter::once(1.0);
            let others = groups.iter().map(|group| form.linear(group.of(case)));
            let row = ones.chain(others).collect();
            let system = case.system();
            Some(Equation { row, value, system })
        };
        let equations: Vec<Equation> = cases.iter().filter_map(equation).collect();
        let (count, size) = (equations.len(), groups.len() + 1);
        if count < size + 3 {
            return None;
        }
        let inverse = inverted(&normal_matrix(size, &equations))?;
        let coefficients = solution(&inverse, &equations);
        let mut squares = 0.0;
        let mut largest = 0.0f64;
        for equation in &equations {
            let residual = equation.residual(&coefficients);
            squares += residual * residual;
            largest = largest.max(residual.abs());
        }
        let mut left_out = Vec::with_capacity(count);
        let mut systems: Vec<_> = equations.iter().map(|equation| equation.system).collect();
        systems.sort_unstable();
        systems.dedup();
        for system in systems {
            let (own, others): (Vec<_>, Vec<_>) = equations
                .iter()
                .partition(|equation| equation.system == system);
            let inverse = inverted(&normal_matrix(size, others.iter().copied()))?;
            let coefficients = solution(&inverse, others);
            left_out.extend(own.iter().map(|it| it.residual(&coefficients).abs()));
        }
        let variance = squares / (count - size) as f64;
        let exponents = (1..size)
            .map(|k| [coefficients[k], (variance * inverse[k][k]).sqrt()])
            .collect();
        let ranges = (1..size).map(|k| {
            let all = equations.iter().map(|equation| equation.row[k]);
            let whole = [f64::INFINITY, f64::NEG_INFINITY];
            let range = all.fold(whole, |[low, high], x| [low.min(x), high.max(x)]);
            range.map(|linear| form.value(linear))
        });
        let of_left_out: f64 = left_out.iter().map(|x| x * x).sum();
        left_out.sort_by(f64::total_cmp);
        let last_in_band = (IN_BAND * count as f64).ceil() as usize - 1;
        Some(Self {
            reduced,
            groups: groups.to_vec(),
            exponents,
            ranges: ranges.collect(),
            prefactor: form.value(coefficients[0]),
            points: count,
            scatter: form.distance(variance.sqrt()),
            largest: form.distance(largest),
            left_out: form.distance((of_left_out / count as f64).sqrt()),
            band: form.distance(left_out[last_in_band]),
        })
    }

    /// Value of the law in a case.
    #[must_use]
    pub fn at(&self, case: &FloorCase) -> f64 {
        let form = self.reduced.form();
        let groups = self.groups.iter().zip(&self.exponents);
        let terms = groups.map(|(group, [exponent, _])| exponent * form.linear(group.of(case)));
        form.value(form.linear(self.prefactor) + terms.sum::<f64>())
    }

    /// Deviation of a case from the law.
    #[must_use]
    pub fn distance(&self, case: &FloorCase) -> Option<f64> {
        let form = self.reduced.form();
        let value = self.reduced.of(case)?;
        Some(form.distance(form.linear(value) - form.linear(self.at(case))))
    }

    /// As text: `0.9 (w/w_c)^(0.500 ± 0.010)`, or `1.1 - (0.600 ± 0.020) w_c/w`.
    #[must_use]
    pub fn words(&self) -> String {
        let form = self.reduced.form();
        let groups = self.groups.iter().zip(&self.exponents);
        let terms: Vec<String> = groups
            .map(|(group, [exponent, error])| match form {
                Form::Powers => format!("({})^({exponent:.3} ± {error:.3})", group.name()),
                Form::Sum => {
                    let sign = if *exponent < 0.0 { '-' } else { '+' };
                    format!(
                        "{sign} ({:.3} ± {error:.3}) {}",
                        exponent.abs(),
                        group.name()
                    )
                }
            })
            .collect();
        format!("{:.3} {}", self.prefactor, terms.join(" "))
    }

    /// Reference of its deviations.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        match self.reduced {
            Reduced::PullOff => " of 3π w R/2",
            _ => "",
        }
    }
}

/// All candidates for a quantity: for products of powers, one group with the work of adhesion and
/// any of the others.
#[must_use]
pub fn candidates(reduced: Reduced, cases: &[&FloorCase]) -> Vec<Law> {
    const OTHERS: [Group; 3] = [Group::Fraction, Group::Lens, Group::Column];
    if reduced.form() == Form::Sum {
        let law = Law::fit(reduced, &[Group::Collapse], cases);
        return law.into_iter().collect();
    }
    let mut laws = Vec::new();
    for work in [Group::Threshold, Group::Work] {
        for chosen in 0..8u32 {
            let others = OTHERS.iter().enumerate();
            let others = others.filter(|(place, _)| chosen & (1 << place) != 0);
            let mut groups = vec![work];
            groups.extend(others.map(|(_, group)| *group));
            laws.extend(Law::fit(reduced, &groups, cases));
        }
    }
    laws
}

/// Factor by which a residual may exceed the smallest one for a law with fewer groups.
pub const WORTH: f64 = 1.15;

/// Selects the candidate with the fewest groups whose residual is within [`WORTH`] of the smallest one; among these the one
/// with the smallest residual.
#[must_use]
pub fn chosen(candidates: &[Law]) -> Option<&Law> {
    let residuals = candidates.iter().map(|law| law.left_out);
    let least = residuals.fold(f64::INFINITY, f64::min);
    candidates
        .iter()
        .filter(|law| law.left_out <= WORTH * least)
        .min_by(|a, b| {
            let by_size = a.groups.len().cmp(&b.groups.len());
            by_size.then(a.left_out.total_cmp(&b.left_out))
        })
}

/// Test of a law on cases that were not used in its fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOut {
    /// Number of cases.
    pub points: usize,
    /// Number of cases within the [band](Law::band) of the law.
    pub in_band: usize,
    /// Root mean square deviation.
    pub scatter: f64,
    /// Largest deviation.
    pub largest: f64,
}

impl HeldOut {
    /// Tests a law on cases; `None` if it applies to none of them.
    #[must_use]
    pub fn new(law: &Law, cases: &[FloorCase]) -> Option<Self> {
        let distances: Vec<f64> = cases.iter().filter_map(|case| law.distance(case)).collect();
        let count = distances.len();
        if count == 0 {
            return None;
        }
        let squares: f64 = distances.iter().map(|x| x * x).sum();
        Some(Self {
            points: count,
            in_band: distances.iter().filter(|x| **x <= law.band).count(),
            scatter: (squares / count as f64).sqrt(),
            largest: distances.into_iter().fold(0.0, f64::max),
        })
    }
}

fn product(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// Inverse of a symmetric positive definite matrix, by elimination; `None` if it is nearly singular.
fn inverted(matrix: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let size = matrix.len();
    let mut left: Vec<Vec<f64>> = matrix.to_vec();
    let mut right: Vec<Vec<f64>> = (0..size)
        .map(|i| (0..size).map(|j| if i == j { 1.0 } else { 0.0 }).collect())
        .collect();
    for k in 0..size {
        let pivot = left[k][k];
        if pivot <= 1e-10 * matrix[k][k] {
            return None;
        }
        for j in 0..size {
            left[k][j] /= pivot;
            right[k][j] /= pivot;
        }
        for i in (0..size).filter(|i| *i != k) {
            let factor = left[i][k];
            for j in 0..size {
                let (of_left, of_right) = (left[k][j], right[k][j]);
                left[i][j] -= factor * of_left;
                right[i][j] -= factor * of_right;
            }
        }
    }
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Computed by hand: [[4, 2], [2, 3]] has the determinant 8.
    #[test]
    fn matrices_are_inverted() {
        let found = inverted(&[vec![4.0, 2.0], vec![2.0, 3.0]]).unwrap();
        let expected = [[0.375, -0.25], [-0.25, 0.5]];
        for (row, other) in found.iter().zip(expected) {
            assert!(row.iter().zip(other).all(|(x, y)| (x - y).abs() < 1e-14));
        }
        assert_eq!(inverted(&[vec![1.0, 2.0], vec![2.0, 4.0]]), None);
    }
}
