//! Power laws in the groups without dimension.
//!
//! Slopes are small and the lens is flat, so that heights and lengths along the surface scale apart from each other: with `E*` the reduced modulus, `a` the radius,
//! `h` the height and `d` the diameter of pillars and `R` the radius of the lens, what is left are the surface fraction, `R h/d^2`, `kappa`, and one group with the work of adhesion: `w a/(E* h^2)`
//! or `w/w_c`, where `w_c` is that of collapse of the flat lattice.

use super::study::FloorCase;
use fakir_study::Validity;
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

    /// The value of a case where the model is in its range; none elsewhere, and where it is not positive.
    #[must_use]
    pub fn of(self, case: &FloorCase) -> Option<f64> {
        let found = &case.found;
        let validity = match self {
            Self::Area | Self::Drop => found.jump_validity,
            _ => found.unloading_validity,
        };
        if validity != Validity::InRange {
            return None;
        }
        let value = match self {
            Self::Withdrawal => 1.0 - found.lost?.indentation / found.critical_indentation,
            Self::Area => found.jump?.floor_area / (PI * found.critical_contact_radius.powi(2)),
            Self::Drop => 1.0 - found.jump?.force / found.critical_force,
            Self::PullOff => -found.pull_off? / (1.5 * PI * found.work * case.lens_radius),
            Self::Hysteresis => {
                found.hysteresis? / (found.critical_force * found.critical_indentation)
            }
        };
        (value > 0.0 && value.is_finite()).then_some(value)
    }
}

/// A group without dimension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// `w/w_c`.
    Threshold,
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
            Self::Work => found.work_over_stiffness * (0.5 * case.diameter / case.height).powi(2),
            Self::Fraction => found.surface_fraction,
            Self::Lens => found.lens_number,
            Self::Column => 1.0 + found.column_number,
        }
    }
}

/// A power law by least squares in logarithms.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// What it is of.
    pub reduced: Reduced,
    /// The groups.
    pub groups: Vec<Group>,
    /// The exponent of each, with its standard error.
    pub exponents: Vec<[f64; 2]>,
    /// From where to where each group goes in the cases.
    pub ranges: Vec<[f64; 2]>,
    /// The factor in front.
    pub prefactor: f64,
    /// Number of cases.
    pub points: usize,
    /// Root of the mean square of the relative distance of cases from the law, with the degrees of freedom that are left.
    pub scatter: f64,
    /// The largest of them.
    pub largest: f64,
    /// The same root where every case is left out of the law that it is held against: the residual by which groups are chosen.
    pub left_out: f64,
}

impl Law {
    /// The law of a quantity in groups. `None` with too few cases, or groups that do not vary apart from each other.
    #[must_use]
    pub fn fit(reduced: Reduced, groups: &[Group], cases: &[&FloorCase]) -> Option<Self> {
        let rows: Vec<(Vec<f64>, f64)> = cases
            .iter()
            .filter_map(|case| {
                let value = reduced.of(case)?.ln();
                let ones = std::iter::once(1.0);
                let logarithms = groups.iter().map(|group| group.of(case).ln());
                Some((ones.chain(logarithms).collect(), value))
            })
            .collect();
        let (count, size) = (rows.len(), groups.len() + 1);
        if count < size + 3 {
            return None;
        }
        let mut normal = vec![vec![0.0; size]; size];
        let mut right = vec![0.0; size];
        for (row, value) in &rows {
            for i in 0..size {
                right[i] += row[i] * value;
                for j in 0..size {
                    normal[i][j] += row[i] * row[j];
                }
            }
        }
        let inverse = inverted(&normal)?;
        let coefficients: Vec<f64> = inverse.iter().map(|row| product(row, &right)).collect();
        let (mut squares, mut left_out, mut largest) = (0.0, 0.0, 0.0f64);
        for (row, value) in &rows {
            let residual = value - product(row, &coefficients);
            let image: Vec<f64> = inverse.iter().map(|line| product(line, row)).collect();
            let leverage = product(row, &image);
            squares += residual * residual;
            left_out += (residual / (1.0 - leverage).max(1e-9)).powi(2);
            largest = largest.max(residual.abs());
        }
        let variance = squares / (count - size) as f64;
        let exponents = (1..size)
            .map(|k| [coefficients[k], (variance * inverse[k][k]).sqrt()])
            .collect();
        let ranges = (1..size).map(|k| {
            let logarithms = rows.iter().map(|(row, _)| row[k]);
            let whole = [f64::INFINITY, f64::NEG_INFINITY];
            let range = logarithms.fold(whole, |[low, high], x| [low.min(x), high.max(x)]);
            range.map(f64::exp)
        });
        Some(Self {
            reduced,
            groups: groups.to_vec(),
            exponents,
            ranges: ranges.collect(),
            prefactor: coefficients[0].exp(),
            points: count,
            scatter: variance.sqrt().exp_m1(),
            largest: largest.exp_m1(),
            left_out: (left_out / count as f64).sqrt().exp_m1(),
        })
    }

    /// The law at a case.
    #[must_use]
    pub fn at(&self, case: &FloorCase) -> f64 {
        let groups = self.groups.iter().zip(&self.exponents);
        groups.fold(self.prefactor, |value, (group, [exponent, _])| {
            value * group.of(case).powf(*exponent)
        })
    }

    /// In words: `0.9 (w/w_c)^0.50`.
    #[must_use]
    pub fn words(&self) -> String {
        let groups = self.groups.iter().zip(&self.exponents);
        let powers: Vec<String> = groups
            .map(|(group, [exponent, error])| {
                format!("({})^({exponent:.2} ± {error:.2})", group.name())
            })
            .collect();
        format!("{:.3} {}", self.prefactor, powers.join(" "))
    }
}

/// All candidates for a quantity: one group with the work, and any of the others.
#[must_use]
pub fn candidates(reduced: Reduced, cases: &[&FloorCase]) -> Vec<Law> {
    const OTHERS: [Group; 3] = [Group::Fraction, Group::Lens, Group::Column];
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
    /// Root of the mean square of relative distances.
    pub scatter: f64,
    /// The largest.
    pub largest: f64,
}

impl HeldOut {
    /// Of a law on cases; `None` if it says nothing about any of them.
    #[must_use]
    pub fn new(law: &Law, cases: &[FloorCase]) -> Option<Self> {
        let distances: Vec<f64> = cases
            .iter()
            .filter_map(|case| Some((law.reduced.of(case)? / law.at(case)).ln().abs()))
            .collect();
        let count = distances.len();
        if count == 0 {
            return None;
        }
        let squares: f64 = distances.iter().map(|x| x * x).sum();
        Some(Self {
            points: count,
            scatter: (squares / count as f64).sqrt().exp_m1(),
            largest: distances.into_iter().fold(0.0, f64::max).exp_m1(),
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
