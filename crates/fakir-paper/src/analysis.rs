//! Analysis of the curves: power laws, the surface fraction at which the offsets merge, and that at
//! which one pillar no longer carries the lens.

use crate::grid::Critical;
use crate::grid::{Curve, Grid, Substrate};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// A quantity of the critical state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// The critical force `F_c`, N.
    Force,
    /// The critical contact radius `a_c`, m.
    ContactRadius,
    /// The critical indentation `zeta_c`, m.
    Indentation,
}

impl Quantity {
    /// All three quantities.
    pub const ALL: [Self; 3] = [Self::Force, Self::ContactRadius, Self::Indentation];

    /// The quantity of a critical state, in SI units.
    #[must_use]
    pub fn of(self, critical: &Critical) -> f64 {
        match self {
            Self::Force => critical.force,
            Self::ContactRadius => critical.contact_radius,
            Self::Indentation => critical.indentation,
        }
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Force => "critical force",
            Self::ContactRadius => "critical contact radius",
            Self::Indentation => "critical indentation",
        }
    }

    /// The exponents of the surface fraction in the paper's large-contact formulas far beyond
    /// `k phi = 1`, as printed: `F_c ~ (a_c/e)^2`, `a_c = e k phi`,
    /// `zeta_c ~ phi^(1/2) (k phi)^2`.
    #[must_use]
    pub fn printed_exponent(self) -> f64 {
        match self {
            Self::Force => 2.0,
            Self::ContactRadius => 0.5,
            Self::Indentation => 2.5,
        }
    }

    /// The exponents of the limit of dense pillar patterns, a lens on a half-space: `a_c ~ phi`,
    /// `F_c ~ a_c^3`, `zeta_c ~ a_c^2`.
    #[must_use]
    pub fn dense_exponent(self) -> f64 {
        match self {
            Self::Force => 3.0,
            Self::ContactRadius => 1.0,
            Self::Indentation => 2.0,
        }
    }
}

/// A power law found by least squares in logarithms: `y = prefactor phi^exponent`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// The exponent.
    pub exponent: f64,
    /// Half-width of the 95 % interval (Student's t) of the exponent under the assumption that the
    /// deviations from the law were random. They are systematic.
    pub uncertainty: f64,
    /// Largest relative deviation of a point from the law.
    pub largest_deviation: f64,
    /// The prefactor, in SI units.
    pub prefactor: f64,
    /// Surface fractions of the first and the last point.
    pub range: [f64; 2],
    /// Number of points.
    pub points: usize,
}

impl PowerLaw {
    /// Fits the law of a curve between two surface fractions; `None` for fewer than three points.
    #[must_use]
    pub fn of(curve: &Curve, quantity: Quantity, [from, to]: [f64; 2]) -> Option<Self> {
        let inside: Vec<&Critical> = curve
            .states
            .iter()
            .filter(|state| (from..=to).contains(&state.surface_fraction))
            .filter(|state| quantity.of(state) > 0.0)
            .collect();
        let points: Vec<[f64; 2]> = inside
            .iter()
            .map(|state| [state.surface_fraction.ln(), quantity.of(state).ln()])
            .collect();
        let [slope, intercept, uncertainty] = least_squares(&points)?;
        Some(Self {
            exponent: slope,
            uncertainty,
            largest_deviation: points
                .iter()
                .map(|[x, y]| (y - intercept - slope * x).exp_m1().abs())
                .fold(0.0, f64::max),
            prefactor: intercept.exp(),
            range: [
                inside.first()?.surface_fraction,
                inside.last()?.surface_fraction,
            ],
            points: points.len(),
        })
    }

    /// Value of the law at a surface fraction.
    #[must_use]
    pub fn at(&self, surface_fraction: f64) -> f64 {
        self.prefactor * surface_fraction.powf(self.exponent)
    }
}

/// Slope, intercept, and half the 95 % confidence interval of the slope, of a straight line.
fn least_squares(points: &[[f64; 2]]) -> Option<[f64; 3]> {
    let count = points.len();
    if count < 3 {
        return None;
    }
    let mean = |k: usize| points.iter().map(|point| point[k]).sum::<f64>() / count as f64;
    let [mean_x, mean_y] = [mean(0), mean(1)];
    let moment = |f: fn(f64, f64) -> f64| -> f64 {
        points.iter().map(|[x, y]| f(x - mean_x, y - mean_y)).sum()
    };
    let squares = moment(|x, _| x * x);
    let slope = moment(|x, y| x * y) / squares;
    let rest: f64 = points
        .iter()
        .map(|[x, y]| (y - mean_y - slope * (x - mean_x)).powi(2))
        .sum();
    let freedom = (count - 2) as f64;
    let deviation = (rest / freedom / squares).sqrt();
    let student = StudentsT::new(0.0, 1.0, freedom).ok()?.inverse_cdf(0.975);
    Some([slope, mean_y - slope * mean_x, student * deviation])
}

/// Spread of the curves of different offsets at one surface fraction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OffsetSpread {
    /// The surface fraction.
    pub surface_fraction: f64,
    /// Largest value over smallest, minus 1; infinite if one of them is zero.
    pub spread: f64,
}

/// Spread over all offsets of a substrate, along the surface fraction.
#[must_use]
pub fn offset_spread(grid: &Grid, substrate: Substrate, quantity: Quantity) -> Vec<OffsetSpread> {
    grid.on_pillar(substrate)
        .states
        .iter()
        .map(|state| {
            let phi = state.surface_fraction;
            let values = grid.of(substrate).filter_map(|curve| {
                let same = |other: &&Critical| (other.surface_fraction / phi - 1.0).abs() < 1e-9;
                curve
                    .states
                    .iter()
                    .find(same)
                    .map(|other| quantity.of(other))
            });
            let (low, high) = values.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| {
                (low.min(v), high.max(v))
            });
            OffsetSpread {
                surface_fraction: phi,
                spread: high / low - 1.0,
            }
        })
        .collect()
}

/// Smallest surface fraction beyond which the spread is below a bound.
#[must_use]
pub fn merged_from(spreads: &[OffsetSpread], bound: f64) -> Option<f64> {
    let last_apart = spreads.iter().rposition(|at| at.spread >= bound);
    let first = last_apart.map_or(0, |k| k + 1);
    spreads.get(first).map(|at| at.surface_fraction)
}

/// Value at the surface fraction nearest to the given one.
#[must_use]
pub fn nearest_to(spreads: &[OffsetSpread], surface_fraction: f64) -> Option<OffsetSpread> {
    spreads.iter().copied().min_by(|a, b| {
        let away = |at: &OffsetSpread| (at.surface_fraction / surface_fraction).ln().abs();
        away(a).total_cmp(&away(b))
    })
}

/// Neighbouring surface fractions between which the number of pillars increases from one: at the
/// first, one pillar is in contact in the critical state, at the second more.
#[must_use]
pub fn one_pillar_end(curve: &Curve) -> Option<[f64; 2]> {
    let first = curve
        .states
        .iter()
        .position(|state| state.pillars_in_contact > 1)?;
    let before = curve.states.get(first.checked_sub(1)?)?;
    Some([
        before.surface_fraction,
        curve.states[first].surface_fraction,
    ])
}

/// State of a curve whose surface fraction is nearest to the given one.
#[must_use]
pub fn state_near(curve: &Curve, surface_fraction: f64) -> Option<&Critical> {
    curve.states.iter().min_by(|a, b| {
        let away = |state: &Critical| (state.surface_fraction / surface_fraction).ln().abs();
        away(a).total_cmp(&away(b))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_with_given_scatter() {
        // Computed by hand: x = 0, 1, 2, 3, y = 0, 1, 1, 2 has slope 0.6, intercept 0.1, residual
        // sum of squares 0.2, so a standard error of sqrt(0.1/5), and t(0.975, 2) = 4.302653.
        let points = [[0.0, 0.0], [1.0, 1.0], [2.0, 1.0], [3.0, 2.0]];
        let [slope, intercept, interval] = least_squares(&points).unwrap();
        assert!((slope - 0.6).abs() < 1e-14);
        assert!((intercept - 0.1).abs() < 1e-14);
        assert!((interval - 4.302_653 * 0.02f64.sqrt()).abs() < 1e-6);
    }

    #[test]
    fn curves_have_merged_where_they_stay_together() {
        let at = |(surface_fraction, spread)| OffsetSpread {
            surface_fraction,
            spread,
        };
        let spreads = [(0.001, 1.0), (0.01, 0.04), (0.02, 0.06), (0.03, 0.03)].map(at);
        assert_eq!(merged_from(&spreads, 0.05), Some(0.03));
        assert_eq!(merged_from(&spreads, 0.01), None);
        let nearest = nearest_to(&spreads, 0.012).unwrap();
        assert!((nearest.surface_fraction - 0.01).abs() < 1e-15);
    }
}
