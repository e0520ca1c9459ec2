//! Prony series of measured relaxation moduli.

use crate::numerics::dense::{Lu, Matrix};
use crate::problem::Relaxation;

/// Relaxation times of the series for every factor of ten in time. More of them make the strengths of neighbours arbitrary.
const TIMES_PER_DECADE: f64 = 4.0;

/// Largest number of relaxation times.
const MOST_TERMS: usize = 30;

/// Strengths below this part of the largest modulus are left out.
const NEGLIGIBLE: f64 = 1e-9;

/// Regularisation of the normal equations, relative to their diagonal: rounding errors of nearly equal exponentials.
const RIDGE: f64 = 1e-13;

/// Rounds of the active-set method, for every term.
const ROUNDS: usize = 6;

/// Why a table of moduli has no Prony series.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidModuli {
    /// Too few rows.
    #[error("{0} rows are too few: at least 3 are needed")]
    TooFew(usize),
    /// A time that is not positive or not larger than the one before.
    #[error("the times must be greater than 0 and increase, and row {0} does not")]
    Time(usize),
    /// A modulus that is not positive.
    #[error("the modulus of row {0} must be greater than 0")]
    Modulus(usize),
    /// The modulus does not decrease, or does not approach a positive value.
    #[error("the moduli do not decrease to a relaxed modulus greater than 0")]
    NoRelaxation,
}

/// A Prony series that was fitted to moduli.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedRelaxation {
    /// The relaxed modulus, Pa.
    pub relaxed_modulus: f64,
    /// The terms relative to it.
    pub relaxation: Relaxation,
    /// Root mean square of the relative differences from the table.
    pub rms_error: f64,
    /// Largest relative difference from the table.
    pub largest_error: f64,
}

/// Fits a Prony series to relaxation moduli (Pa) at times (s) after a step of strain: non-negative least squares (C. L. Lawson, R. J. Hanson,
/// Solving Least Squares Problems (1974), ch. 23) with relaxation times evenly spaced on a logarithmic scale and relative residuals.
///
/// # Errors
/// [`InvalidModuli`].
pub fn fit_relaxation(times: &[f64], moduli: &[f64]) -> Result<FittedRelaxation, InvalidModuli> {
    let count = times.len().min(moduli.len());
    if count < 3 {
        return Err(InvalidModuli::TooFew(count));
    }
    let mut before = 0.0;
    for (row, (time, modulus)) in times.iter().zip(moduli).enumerate() {
        if !(*time > before && time.is_finite()) {
            return Err(InvalidModuli::Time(row));
        }
        if !(*modulus > 0.0 && modulus.is_finite()) {
            return Err(InvalidModuli::Modulus(row));
        }
        before = *time;
    }
    let (first, last) = (times[0], times[count - 1]);
    let spaces = (TIMES_PER_DECADE * (last / first).log10()).ceil() as usize;
    let most = (MOST_TERMS - 1).min(count.saturating_sub(2));
    let spaces = spaces.min(most).max(1);
    let taus: Vec<f64> = (0..=spaces)
        .map(|k| first * (last / first).powf(k as f64 / spaces as f64))
        .collect();
    // The relaxed modulus is the first column.
    let columns = 1 + taus.len();
    let value = |row: usize, column: usize| {
        let decay = match column {
            0 => 1.0,
            term => (-times[row] / taus[term - 1]).exp(),
        };
        decay / moduli[row]
    };
    let matrix = Matrix::from_fn(count, columns, value);
    let found = non_negative(&matrix, &vec![1.0; count]);
    let relaxed_modulus = found[0];
    let largest = found.iter().copied().fold(0.0, f64::max);
    let kept: Vec<usize> = (1..columns)
        .filter(|term| found[*term] > NEGLIGIBLE * largest)
        .collect();
    if relaxed_modulus.is_nan() || relaxed_modulus <= NEGLIGIBLE * largest {
        return Err(InvalidModuli::NoRelaxation);
    }
    let strengths: Vec<f64> = kept.iter().map(|k| found[*k] / relaxed_modulus).collect();
    let kept_taus: Vec<f64> = kept.iter().map(|k| taus[*k - 1]).collect();
    let relaxation = Relaxation::new(&strengths, &kept_taus);
    let relaxation = relaxation.map_err(|_| InvalidModuli::NoRelaxation)?;
    let off = times
        .iter()
        .zip(moduli)
        .map(|(time, modulus)| (relaxed_modulus * relaxation.at(*time) / modulus - 1.0).abs());
    let (mut squares, mut largest_error) = (0.0, 0.0_f64);
    for off in off {
        squares += off * off;
        largest_error = largest_error.max(off);
    }
    Ok(FittedRelaxation {
        relaxed_modulus,
        relaxation,
        rms_error: (squares / count as f64).sqrt(),
        largest_error,
    })
}

/// Non-negative least squares.
fn non_negative(matrix: &Matrix, right: &[f64]) -> Vec<f64> {
    let columns = matrix.columns();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let normal: Vec<Vec<f64>> = (0..columns)
        .map(|i| {
            let row = |j: usize| dot(matrix.column(i), matrix.column(j));
            (0..columns).map(row).collect()
        })
        .collect();
    let target: Vec<f64> = (0..columns).map(|k| dot(matrix.column(k), right)).collect();
    let mut solution = vec![0.0; columns];
    let mut free = vec![false; columns];
    for _ in 0..ROUNDS * columns {
        // The column that lowers the residual most.
        let slope = |k: usize| {
            let all = normal[k].iter().zip(&solution);
            target[k] - all.map(|(a, x)| a * x).sum::<f64>()
        };
        let next = (0..columns)
            .filter(|k| !free[*k])
            .map(|k| (k, slope(k) / normal[k][k].sqrt()))
            .max_by(|one, other| one.1.total_cmp(&other.1));
        match next {
            Some((k, gain)) if gain > 1e-12 * dot(right, right).sqrt() => free[k] = true,
            _ => break,
        }
        for _ in 0..columns {
            let set: Vec<usize> = (0..columns).filter(|k| free[*k]).collect();
            let mut trial: Vec<f64> = set.iter().map(|k| target[*k]).collect();
            let inner = Matrix::from_fn(set.len(), set.len(), |i, j| {
                let ridge = if i == j { 1.0 + RIDGE } else { 1.0 };
                ridge * normal[set[i]][set[j]]
            });
            Lu::new(inner).solve(&mut trial);
            // As far as all of them stay positive.
            let part = set
                .iter()
                .zip(&trial)
                .filter(|(_, trial)| **trial <= 0.0)
                .map(|(k, trial)| solution[*k] / (solution[*k] - trial))
                .fold(1.0, f64::min);
            let part = if part.is_finite() { part.max(0.0) } else { 0.0 };
            let mut is_inside = true;
            for (k, trial) in set.iter().zip(&trial) {
                solution[*k] += part * (trial - solution[*k]);
                if *trial <= 0.0 && solution[*k] <= 1e-14 * trial.abs().max(1e-300) {
                    solution[*k] = 0.0;
                    free[*k] = false;
                    is_inside = false;
                } else if *trial <= 0.0 {
                    is_inside = false;
                }
            }
            if is_inside {
                break;
            }
        }
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected: the series from which the table was made, to better than the spacing of the relaxation times allows by itself.
    #[test]
    fn a_series_is_found_again() {
        let exact = Relaxation::new(&[1.0, 0.5], &[10.0, 120.0]).unwrap();
        let times: Vec<f64> = (0..60)
            .map(|k| 10f64.powf(-0.5 + 4.0 * f64::from(k) / 59.0))
            .collect();
        let moduli: Vec<f64> = times.iter().map(|time| 2e6 * exact.at(*time)).collect();
        let found = fit_relaxation(&times, &moduli).unwrap();
        assert!(
            (found.relaxed_modulus / 2e6 - 1.0).abs() < found.largest_error,
            "{found:?}"
        );
        assert!(found.largest_error < 5e-3, "{found:?}");
        let instantaneous = found.relaxed_modulus * found.relaxation.instantaneous();
        assert!((instantaneous / 5e6 - 1.0).abs() < 0.02, "{found:?}");
    }

    #[test]
    fn tables_without_relaxation_are_refused() {
        let times = [1.0, 2.0, 3.0, 4.0];
        assert!(fit_relaxation(&times[..2], &[1.0; 2]).is_err());
        assert!(fit_relaxation(&[1.0, 1.0, 2.0], &[1.0; 3]).is_err());
        assert!(fit_relaxation(&[0.0, 1.0, 2.0], &[1.0; 3]).is_err());
        assert!(fit_relaxation(&times, &[3.0, 2.0, -1.0, 1.0]).is_err());
        assert!(fit_relaxation(&times, &[f64::NAN; 4]).is_err());
    }
}
