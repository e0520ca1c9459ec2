//! Cholesky factors of matrices that are factorised now and then, most of which are so small that a library spends its
//! time on getting started. Those of pillars are left to [`super::elimination`].
//!
//! Matrices are kept column by column, of which the lower triangle counts.

use super::vector::{inner_dot, widest};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor as llt;
use faer::{MatMut, Par};

/// Larger matrices are left to the library, which works on blocks that fit the caches.
const LARGE: usize = 64;

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
            for row in 0..size {
                let (done, column) = matrix.split_at_mut(row * size);
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
            solve_lower(&factor, size, &mut right);
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
