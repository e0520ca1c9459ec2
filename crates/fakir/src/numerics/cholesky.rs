//! Cholesky factorisation of general dense matrices. Systems of single pillars use [`super::elimination`].
//!
//! Matrices are stored by columns; only the lower triangle is used.

use super::product::{Part, Product};
use super::vector::{inner_dot, widest};

/// Width of a panel that is factorised column by column. The contribution of the preceding columns is subtracted by a matrix product.
const PANEL: usize = 32;

/// Factorises a symmetric matrix in place. Returns `false` if it is not positive definite. The part above the diagonal is left undefined.
pub(crate) fn factorise(matrix: &mut [f64], size: usize) -> bool {
    if size <= PANEL {
        return factorise_panel(matrix, size, 0);
    }
    let mut product = Product::new();
    for first in (0..size).step_by(PANEL) {
        let (done, panel) = matrix.split_at_mut(first * size);
        let panel = &mut panel[..PANEL.min(size - first) * size];
        let row = |k: usize, column: usize| done[k * size + first + column];
        product.set_right(first, panel.len() / size, row);
        let left = Part {
            values: done.get(first..).unwrap_or_default(),
            stride: size,
        };
        product.add(-1.0, left, size - first, &mut panel[first..], size);
        if !factorise_panel(panel, size, first) {
            return false;
        }
    }
    true
}

/// Factorises a panel; row `first` contains the diagonal element of its first column.
fn factorise_panel(panel: &mut [f64], size: usize, first: usize) -> bool {
    widest(
        #[inline(always)]
        || {
            for (k, row) in (first..size).take(PANEL).enumerate() {
                let (done, column) = panel.split_at_mut(k * size);
                let column = &mut column[row..size];
                for before in done.chunks_exact(size) {
                    let factor = before[row];
                    for (value, l) in column.iter_mut().zip(&before[row..]) {
                        *value -= factor * l;
                    }
                }
                let pivot = column[0];
                if pivot.is_nan() || pivot <= 0.0 {
                    return false;
                }
                let scale = pivot.sqrt().recip();
                column.iter_mut().for_each(|value| *value *= scale);
            }
            true
        },
    )
}

/// Solves `L x = b` in place.
pub(crate) fn solve_lower(factor: &[f64], size: usize, right: &mut [f64]) {
    widest(
        #[inline(always)]
        || {
            for (k, column) in factor.chunks_exact(size.max(1)).enumerate() {
                let value = right[k] / column[k];
                right[k] = value;
                for (b, l) in right[k + 1..].iter_mut().zip(&column[k + 1..]) {
                    *b -= value * l;
                }
            }
        },
    );
}

/// Solves `L' x = b` in place.
pub(crate) fn solve_upper(factor: &[f64], size: usize, right: &mut [f64]) {
    widest(
        #[inline(always)]
        || {
            for (k, column) in factor.chunks_exact(size.max(1)).enumerate().rev() {
                let sum = inner_dot(&column[k + 1..size], &right[k + 1..size]);
                right[k] = (right[k] - sum) / column[k];
            }
        },
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_what_it_was_made_from() {
        for size in [0, 1, 2, 5, 20, PANEL, PANEL + 1, 64, 65, 150] {
            // Diagonally dominant, so positive definite.
            let matrix: Vec<f64> = (0..size * size)
                .map(|k| {
                    let (i, j) = (k / size, k % size);
                    1.0 / (1.0 + (i + j) as f64) + if i == j { size as f64 } else { 0.0 }
                })
                .collect();
            let expected: Vec<f64> = (0..size).map(|k| (1.3 * k as f64).sin()).collect();
            let mut right: Vec<f64> = (0..size)
                .map(|i| (0..size).map(|j| matrix[i * size + j] * expected[j]).sum())
                .collect();
            let mut factor = matrix;
            assert!(factorise(&mut factor, size));
            solve_lower(&factor, size, &mut right);
            solve_upper(&factor, size, &mut right);
            for (found, expected) in right.iter().zip(&expected) {
                assert!(
                    (found - expected).abs() < 1e-12,
                    "{size}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn reports_a_matrix_that_is_not_positive_definite() {
        assert!(!factorise(&mut [1.0, 2.0, 2.0, 1.0], 2));
        assert!(!factorise(&mut [f64::NAN], 1));
        // In the first panel, and in columns after it.
        for place in [0, PANEL - 1, PANEL, 100] {
            for value in [-1e-3, f64::NAN] {
                let mut matrix = vec![0.0; 101 * 101];
                for k in 0..101 {
                    matrix[k * 101 + k] = if k == place { value } else { 1.0 };
                }
                assert!(!factorise(&mut matrix, 101), "{place}");
            }
        }
    }
}
