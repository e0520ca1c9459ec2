//! Laws in the groups without dimension: products of powers, and a sum.
//!
//! Slopes are small and the lens is flat, so that heights and lengths along the surface scale apart from each other: with `E*` the reduced modulus, `a` the radius,
//! `h` the height and `d` the diameter of pillars and `R` the radius of the lens, what is left are the surface fraction, `R h/d^2`, `kappa`, and one group with the work of adhesion: `w a/(E* h^2)`
//! or `w/w_c`, where `w_c` is that of collapse of the flat lattice.

use super::study::{FloorCase, OnCells};
use fakir::solve::collapsed_floor::{MODEL_ERROR_OF_AREA, NARROWEST_FRONT};
use fakir_study::{Fate, FloorJump, FloorLoss, Validity};
use std::f64::consts::PI;

/// What a law is of, without dimension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reduced {
    /// How far the lens goes back until the floor is lost: `1 - zeta_lost/zeta_c`.
    Withdrawal,
    /// Area of the floor after the jump over that of the contact: `A/(pi a_c^2)`.
    Area,
    /// What the jump takes from the force: `1 - F/F_c`.
    Drop,
    /// Pull-off with the floor over that of a smooth sphere, `3/2 pi w R`.
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

    /// How its law puts groups together.
    #[must_use]
    pub fn form(self) -> Form {
        match self {
            // It goes down to nothing at a finite work of adhesion.
            Self::PullOff => Form::Sum,
            _ => Form::Powers,
        }
    }

    /// Its formula, as figures write it.
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

    /// The same as the report writes it.
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

    /// The value of a case: on cells, as far as they tell it, or by the fast model in its range. None elsewhere, and where it is not positive.
    #[must_use]
    pub fn of(self, case: &FloorCase) -> Option<f64> {
        let on_cells = case.cells.and_then(|cells| self.on_cells(case, cells));
        let value = on_cells.or_else(|| self.by_model(case))?;
        (value > 0.0 && value.is_finite()).then_some(value)
    }

    /// On cells, to [`KNOWN_TO`] by their own estimate; after the jump where as much is stuck as the fast model asks for, since in fewer holes their
    /// number makes steps. Their cycles turn back where they touch the floor, so that they tell no hysteresis beside that of the model.
    fn on_cells(self, case: &FloorCase, cells: OnCells) -> Option<f64> {
        let held = case.fate() == Some(Fate::HeldThroughZero);
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

    /// By the fast model in its range.
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

    /// What was measured over what makes it a number without dimension.
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

    /// The number itself: what the quotient lacks to 1, or the quotient.
    fn value_of(self, quotient: f64) -> f64 {
        match self {
            Self::Withdrawal | Self::Drop => 1.0 - quotient,
            Self::Area | Self::PullOff | Self::Hysteresis => quotient,
        }
    }
}

/// What a cycle came to, on cells or by the fast model, in SI units.
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

/// Relative error up to which a number on cells has a part in laws: that of the areas of the fast model.
const KNOWN_TO: f64 = MODEL_ERROR_OF_AREA;

/// How a law puts its groups together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A product of powers, by least squares in logarithms: distances from it are relative.
    Powers,
    /// A sum, each with a factor, by least squares: distances from it are those of the values.
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

    /// In what a law is linear, and back.
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

    /// The distance that a difference is in what the law is linear in.
    fn distance(self, difference: f64) -> f64 {
        match self {
            Self::Powers => difference.abs().exp_m1(),
            Self::Sum => difference.abs(),
        }
    }
}

/// A group without dimension.
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

    /// As figures write it.
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

/// A law by least squares.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// What it is of.
    pub reduced: Reduced,
    /// The groups.
    pub groups: Vec<Group>,
    /// The exponent of each, or in a sum its factor, with its standard error.
    pub exponents: Vec<[f64; 2]>,
    /// From where to where each group goes in the cases.
    pub ranges: Vec<[f64; 2]>,
    /// The factor in front, or in a sum the constant.
    pub prefactor: f64,
    /// Number of cases.
    pub points: usize,
    /// Root of the mean square of the distance of cases from the law, with the degrees of freedom that are left.
    pub scatter: f64,
    /// The largest distance.
    pub largest: f64,
    /// The same root where every system, with all works of adhesion, is left out of the law that it is held against: the residual by which groups are chosen.
    pub left_out: f64,
    /// Nineteen in twenty cases of systems left out like this are nearer to their law than this.
    pub band: f64,
}

/// A linear equation for the coefficients of a law, from a case.
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

/// The matrix of least squares.
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

/// The coefficients by least squares, from the inverse of their matrix.
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

/// The part of the cases that [`Law::band`] is for.
const IN_BAND: f64 = 0.95;

impl Law {
    /// The law of a quantity in groups. `None` with too few cases, or groups that do not vary apart from each other.
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

    /// The law at a case.
    #[must_use]
    pub fn at(&self, case: &FloorCase) -> f64 {
        let form = self.reduced.form();
        let groups = self.groups.iter().zip(&self.exponents);
        let terms = groups.map(|(group, [exponent, _])| exponent * form.linear(group.of(case)));
        form.value(form.linear(self.prefactor) + terms.sum::<f64>())
    }

    /// The distance of a case from it.
    #[must_use]
    pub fn distance(&self, case: &FloorCase) -> Option<f64> {
        let form = self.reduced.form();
        let value = self.reduced.of(case)?;
        Some(form.distance(form.linear(value) - form.linear(self.at(case))))
    }

    /// In words: `0.9 (w/w_c)^(0.500 ± 0.010)`, or `1.1 - (0.600 ± 0.020) w_c/w`.
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

    /// Of what its distances are parts.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        match self.reduced {
            Reduced::PullOff => " of 3π w R/2",
            _ => "",
        }
    }
}

/// All candidates for a quantity: of powers one group with the work, and any of the others.
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

/// How much larger than the least a residual may be for the sake of fewer groups.
pub const WORTH: f64 = 1.15;

/// The candidate with the fewest groups whose residual is within [`WORTH`] of the least, and among those that with the least.
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

/// How a law does on cases that it does not come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOut {
    /// Number of cases.
    pub points: usize,
    /// Those within the [band](Law::band) of the law.
    pub in_band: usize,
    /// Root of the mean square of distances.
    pub scatter: f64,
    /// The largest.
    pub largest: f64,
}

impl HeldOut {
    /// Of a law on cases; `None` if it says nothing about any of them.
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

/// The inverse of a symmetric positive definite matrix, by elimination; `None` of one that is nearly singular.
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

    /// By hand: [[4, 2], [2, 3]] has the determinant 8.
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
