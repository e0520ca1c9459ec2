//! Linear complementarity problems by block principal pivoting.
//!
//! Given a symmetric positive definite matrix `G` and a constant `q0`, find `s >= 0` with `q = q0 + G s >= 0` and `q's = 0`. Every index is
//! *active* (`q = 0`) or inactive (`s = 0`). All indices that violate a sign are exchanged at once. If this does not reduce their number,
//! indices are exchanged one at a time by Murty's rule, which is finite (J. J. Júdice, F. M. Pires, Comput. Oper. Res. 21, 587 (1994)).
//!
//! With `H = G^-1`, `s = H (q - q0)`: the same problem with `q` and `s` exchanged. If most indices are active and [`Inverse`] is given, it is
//! the inactive part of `H` that is factorised: at most half of the unknowns, hence at most an eighth of the work.

use super::convergence::largest;
use super::elimination::{BLOCK, Elimination};
use super::vector::{LANES, widest};
use std::sync::OnceLock;

/// Tolerance of `q >= 0` relative to the largest `|q0|`: smaller violations are rounding errors.
const TOLERANCE: f64 = 1e-11;

/// Number of steps without fewer violations after which indices are exchanged one at a time.
const PATIENCE: usize = 5;

/// Limit of pivoting steps, after which the problem counts as not converged. Murty's rule is finite but may need many steps; the largest
/// number observed at 561 unknowns is a few hundred.
const STEP_LIMIT: usize = 4000;

/// Outcome of pivoting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Pivoting {
    pub(crate) converged: bool,
    pub(crate) steps: usize,
}

/// The inverse `H` of a matrix, computed when it is first needed; empty if the matrix is not positive definite.
#[derive(Debug, Clone, Default)]
pub(crate) struct Inverse(OnceLock<Vec<f64>>);

impl Inverse {
    fn of(&self, matrix: &[f64], count: usize) -> Option<&[f64]> {
        let inverse = self.0.get_or_init(|| {
            let mut factor = Elimination::new(count, count);
            let all: Vec<usize> = (0..count).collect();
            if !factor.factorise(matrix, count, &all) {
                return Vec::new();
            }
            let mut inverse = vec![0.0; count * count];
            let identity = |row: usize, column: usize| f64::from(u8::from(row == column));
            factor.projected_inverse(count, &mut inverse, identity);
            inverse
        });
        (!inverse.is_empty()).then_some(inverse)
    }

    /// The inverse times rows of values, once it is known.
    pub(crate) fn times(&self, rows: &[f64], count: usize) -> Vec<f64> {
        let inverse = self.0.get().map_or(&[][..], Vec::as_slice);
        let all: Vec<usize> = (0..count).collect();
        let mut products = vec![0.0; rows.len()];
        for (row, product) in rows
            .chunks_exact(count)
            .zip(products.chunks_exact_mut(count))
        {
            add_rows(product, inverse, &all, row);
        }
        products
    }
}

/// Working storage and solution.
pub(crate) struct PivotSolver {
    /// `q0`; must be set before solving.
    pub(crate) constant: Vec<f64>,
    /// `q`
    slack: Vec<f64>,
    /// `s`
    multiplier: Vec<f64>,
    /// The active indices; the inactive ones if `q` and `s` are exchanged.
    indices: Vec<usize>,
    /// Factors of `G` on these indices, or of `H`.
    factor: Elimination,
    exchanged: bool,
    right: Vec<f64>,
}

impl PivotSolver {
    /// Allocates storage for `count` unknowns and for projections on at most `columns` columns.
    pub(crate) fn new(count: usize, columns: usize) -> Self {
        Self {
            constant: vec![0.0; count],
            slack: vec![0.0; count],
            multiplier: vec![0.0; count],
            indices: Vec::with_capacity(count),
            factor: Elimination::new(count, columns),
            exchanged: false,
            right: Vec::with_capacity(count.next_multiple_of(BLOCK)),
        }
    }

    /// Solves the problem for a matrix that is stored by rows, with its inverse if that may be used. `active` contains the initial guess of
    /// the active indices on entry and the solution on return.
    pub(crate) fn solve(
        &mut self,
        matrix: &[f64],
        inverse: Option<&Inverse>,
        active: &mut [bool],
    ) -> Pivoting {
        let count = self.constant.len();
        let scale = largest(self.constant.iter().copied());
        if !scale.is_finite() {
            return Pivoting {
                converged: false,
                steps: 0,
            };
        }
        let mut fewest = usize::MAX;
        let mut patience = PATIENCE;
        for steps in 1..=STEP_LIMIT {
            if !self.solve_active(matrix, inverse, active) {
                return Pivoting {
                    converged: false,
                    steps,
                };
            }
            let violated = |k: usize, active: &[bool], solver: &Self| {
                // Written so that NaN counts as a violation.
                let holds = if active[k] {
                    solver.multiplier[k] >= 0.0
                } else {
                    solver.slack[k] >= -TOLERANCE * scale
                };
                !holds
            };
            let violations = (0..count).filter(|&k| violated(k, active, self)).count();
            if violations == 0 {
                return Pivoting {
                    converged: true,
                    steps,
                };
            }
            if violations < fewest {
                (fewest, patience) = (violations, PATIENCE);
            } else if patience > 0 {
                patience -= 1;
            } else {
                if let Some(last) = (0..count).rev().find(|&k| violated(k, active, self)) {
                    active[last] = !active[last];
                }
                continue;
            }
            for k in 0..count {
                if violated(k, active, self) {
                    // Exchanging k alone leaves the other values unchanged.
                    active[k] = !active[k];
                    self.multiplier[k] = 0.0;
                    self.slack[k] = 0.0;
                }
            }
        }
        Pivoting {
            converged: false,
            steps: STEP_LIMIT,
        }
    }

    /// The active indices and their `s`.
    pub(crate) fn multipliers(&self) -> impl Iterator<Item = (usize, f64)> {
        let all = self.multiplier.iter().copied().enumerate();
        all.filter(|(_, s)| *s != 0.0)
    }

    /// Whether the last solution was that of the problem with `q` and `s` exchanged.
    pub(crate) fn is_exchanged(&self) -> bool {
        self.exchanged
    }

    /// Computes `W' G_II^-1 W` by rows into `product`, with `G_II` the matrix on the active indices and `W` the given number of columns of
    /// values at them. If `q` and `s` are exchanged, the same with `H` on the inactive indices.
    pub(crate) fn projected_inverse(
        &mut self,
        columns: usize,
        product: &mut [f64],
        value: impl Fn(usize, usize) -> f64,
    ) {
        let indices = &self.indices;
        let at = |number: usize, column: usize| {
            let index = indices.get(number);
            index.map_or(0.0, |index| value(*index, column))
        };
        self.factor.projected_inverse(columns, product, at);
    }

    /// Sets `q` to zero at the active indices and computes their multipliers, and `q` at the others.
    pub(crate) fn solve_active(
        &mut self,
        matrix: &[f64],
        inverse: Option<&Inverse>,
        active: &[bool],
    ) -> bool {
        let count = self.constant.len();
        let most = 2 * active.iter().filter(|active| **active).count() > count;
        let inverse = inverse.filter(|_| most);
        let inverse = inverse.and_then(|inverse| inverse.of(matrix, count));
        self.exchanged = inverse.is_some();
        let (matrix, unknown, other) = match inverse {
            None => {
                self.slack.copy_from_slice(&self.constant);
                (matrix, &mut self.multiplier, &mut self.slack)
            }
            Some(inverse) => {
                self.indices.clear();
                self.indices.extend(0..count);
                self.multiplier.fill(0.0);
                add_rows(&mut self.multiplier, inverse, &self.indices, &self.constant);
                self.multiplier.iter_mut().for_each(|s| *s = -*s);
                (inverse, &mut self.slack, &mut self.multiplier)
            }
        };
        self.indices.clear();
        let exchanged = self.exchanged;
        self.indices
            .extend((0..count).filter(|&k| active[k] != exchanged));
        if !self.factor.factorise(matrix, count, &self.indices) {
            return false;
        }
        let size = self.indices.len();
        self.right.clear();
        self.right.extend(self.indices.iter().map(|&k| -other[k]));
        self.right.resize(size.next_multiple_of(BLOCK), 0.0);
        self.factor.solve(&mut self.right);
        unknown.fill(0.0);
        for (&value, &k) in self.right.iter().zip(&self.indices) {
            unknown[k] = value;
        }
        add_rows(other, matrix, &self.indices, &self.right[..size]);
        for &k in &self.indices {
            other[k] = 0.0;
        }
        true
    }
}

/// Adds some rows of a matrix, each times a factor.
fn add_rows(sum: &mut [f64], matrix: &[f64], rows: &[usize], factors: &[f64]) {
    let count = sum.len();
    let row = |k: usize| &matrix[k * count..(k + 1) * count];
    widest(
        #[inline(always)]
        || {
            let (rows, few) = rows.as_chunks::<LANES>();
            let (factors, few_factors) = factors.as_chunks::<LANES>();
            for (rows, [s, t, u, v]) in rows.iter().zip(factors) {
                let [a, b, c, d] = rows.map(row);
                for ((((sum, a), b), c), d) in sum.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                    *sum += (s * a + t * b) + (u * c + v * d);
                }
            }
            for (k, s) in few.iter().zip(few_factors) {
                for (sum, a) in sum.iter_mut().zip(row(*k)) {
                    *sum += s * a;
                }
            }
        },
    );
}
