//! Cholesky factors of the matrices of one pillar, most of which are so small that a library spends its
//! time on getting started.
//!
//! Matrices are kept column by column, of which the lower triangle counts.

use super::vector::{Lanes, inner_dot, widest};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor as llt;
use faer::{MatMut, Par};

/// Larger matrices are left to the library, which works on blocks that fit the caches.
const LARGE: usize = 64;

/// Columns whose part in those behind them is subtracted at once.
const PANEL: usize = 4;

/// Factorises a symmetric matrix in place. `false` if it is not positive definite.
pub(crate) fn factorise(matrix: &mut [f64], size: usize) -> bool {
    if size > LARGE {
        factorise_large(matrix, size)
    } else {
        factorise_small(matrix, size)
    }
}

fn factorise_large(matrix: &mut [f64], size: usize) -> bool {
    let scratch = llt::cholesky_in_place_scratch::<f64>(size, Par::Seq, faer::Spec::default());
    llt::cholesky_in_place(
        MatMut::from_column_major_slice_mut(matrix, size, size),
        llt::LltRegularization::default(),
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(scratch)),
        faer::Spec::default(),
    )
    .is_ok()
}

fn factorise_small(matrix: &mut [f64], size: usize) -> bool {
    widest(
        #[inline(always)]
        || {
            for first in (0..size).step_by(PANEL) {
                let end = size.min(first + PANEL);
                let (done, behind) = matrix.split_at_mut(end * size);
                let panel = &mut done[first * size..];
                if !factorise_panel(panel, size, first) {
                    return false;
                }
                let mut columns = panel.chunks_exact(size);
                let (Some(a), Some(b), Some(c), Some(d)) = (
                    columns.next(),
                    columns.next(),
                    columns.next(),
                    columns.next(),
                ) else {
                    break;
                };
                for (number, target) in behind.chunks_exact_mut(size).enumerate() {
                    let row = end + number;
                    let factors = [a[row], b[row], c[row], d[row]];
                    let pairs = a[row..].iter().zip(&b[row..]);
                    let others = c[row..].iter().zip(&d[row..]);
                    let places = target[row..].iter_mut().zip(pairs.zip(others));
                    for (value, ((a, b), (c, d))) in places {
                        *value -=
                            (factors[0] * a + factors[1] * b) + (factors[2] * c + factors[3] * d);
                    }
                }
            }
            true
        },
    )
}

/// Factorises some columns, the first of which has its diagonal in row `first`, and from which those before
/// them have been subtracted.
#[inline(always)]
fn factorise_panel(panel: &mut [f64], size: usize, first: usize) -> bool {
    for number in 0..panel.len() / size {
        let row = first + number;
        let (done, column) = panel.split_at_mut(number * size);
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

/// Solves `L x = b` in place for several right sides side by side.
pub(crate) fn solve_lower_lanes(factor: &[f64], size: usize, right: &mut [Lanes]) {
    widest(
        #[inline(always)]
        || {
            for (k, column) in factor.chunks_exact(size.max(1)).enumerate() {
                let value = right[k] * Lanes::splat(column[k].recip());
                right[k] = value;
                for (b, l) in right[k + 1..].iter_mut().zip(&column[k + 1..]) {
                    *b = *b - Lanes::splat(*l) * value;
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
        for size in [0, 1, 2, 5, 20, LARGE, LARGE + 1, 150] {
            // Diagonally dominant, so positive definite.
            let matrix: Vec<f64> = (0..size * size)
                .map(|k| {
                    let (i, j) = (k / size, k % size);
                    1.0 / (1.0 + (i + j) as f64) + if i == j { size as f64 } else { 0.0 }
                })
                .collect();
            let wanted: Vec<f64> = (0..size).map(|k| (1.3 * k as f64).sin()).collect();
            let mut right: Vec<f64> = (0..size)
                .map(|i| (0..size).map(|j| matrix[i * size + j] * wanted[j]).sum())
                .collect();
            let mut factor = matrix;
            assert!(factorise(&mut factor, size));
            let mut lanes: Vec<Lanes> = right.iter().map(|b| Lanes([*b, 0.0, 2.0, -b])).collect();
            solve_lower_lanes(&factor, size, &mut lanes);
            solve_lower(&factor, size, &mut right);
            for (lanes, alone) in lanes.iter().zip(&right) {
                assert!((lanes.0[0] - alone).abs() < 1e-13 && lanes.0[1] == 0.0);
                assert!((lanes.0[3] + alone).abs() < 1e-13);
            }
            solve_upper(&factor, size, &mut right);
            for (found, wanted) in right.iter().zip(&wanted) {
                assert!((found - wanted).abs() < 1e-12, "{size}: {found} {wanted}");
            }
        }
    }

    #[test]
    fn tells_what_is_not_positive_definite() {
        assert!(!factorise(&mut [1.0, 2.0, 2.0, 1.0], 2));
        assert!(!factorise(&mut [f64::NAN], 1));
    }
}
