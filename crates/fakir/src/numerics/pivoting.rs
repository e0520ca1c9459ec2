//! Linear complementarity problems by block principal pivoting.
//!
//! Given a symmetric positive definite matrix `G` and a constant `q0`, find `s >= 0` with `q = q0 + G s >= 0` and `q's = 0`. Every index is
//! *active* (`q = 0`) or inactive (`s = 0`). All indices that violate a sign are exchanged at once. If this does not reduce their number,
//! indices are exchanged one at a time by Murty's rule, which is finite (J. J. Júdice, F. M. Pires, Comput. Oper. Res. 21, 587 (1994)).

use super::convergence::largest;
use super::elimination::{BLOCK, Elimination};
use super::vector::{LANES, widest};

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

/// Working storage and solution.
pub(crate) struct PivotSolver {
    /// `q0`; must be set before solving.
    pub(crate) constant: Vec<f64>,
    /// `q`
    slack: Vec<f64>,
    /// `s`
    multiplier: Vec<f64>,
    /// The active indices.
    indices: Vec<usize>,
    /// Factors of `G` on the active indices.
    factor: Elimination,
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
            right: Vec::with_capacity(count.next_multiple_of(BLOCK)),
        }
    }

    /// Solves the problem for a matrix that is stored by rows. `active` contains the initial guess of the active indices on entry and the
    /// solution on return.
    pub(crate) fn solve(&mut self, matrix: &[f64], active: &mut [bool]) -> Pivoting {
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
            if !self.solve_active(matrix, active) {
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
        self.indices.iter().map(|&k| (k, self.multiplier[k]))
    }

    /// Computes `W' G_II^-1 W` by rows into `product`, with `G_II` the matrix on the active indices and `W` the given number of columns of
    /// values at them.
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
    pub(crate) fn solve_active(&mut self, matrix: &[f64], active: &[bool]) -> bool {
        let count = self.constant.len();
        self.indices.clear();
        self.indices.extend((0..count).filter(|&k| active[k]));
        if !self.factor.factorise(matrix, count, &self.indices) {
            return false;
        }
        let size = self.indices.len();
        self.right.clear();
        self.right
            .extend(self.indices.iter().map(|&k| -self.constant[k]));
        self.right.resize(size.next_multiple_of(BLOCK), 0.0);
        self.factor.solve(&mut self.right);
        self.multiplier.fill(0.0);
        for (&s, &k) in self.right.iter().zip(&self.indices) {
            self.multiplier[k] = s;
        }
        self.slack.copy_from_slice(&self.constant);
        add_rows(&mut self.slack, matrix, &self.indices, &self.right[..size]);
        for &k in &self.indices {
            self.slack[k] = 0.0;
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
