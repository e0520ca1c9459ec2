//! Linear algebra of a weighted linear least-squares problem with few unknowns.

use fakir::numerics::dense::Matrix;
use fakir::numerics::svd::Svd;

/// Singular values below this fraction of the largest, with the columns scaled to the same norm,
/// are set to zero: derivatives are differences with errors of about 1e-4.
const RANK: f64 = 1e-4;

/// Decomposition of the weighted derivatives of the model at a point.
pub(super) struct Linear {
    /// Euclidean norms of the columns, by which they are divided before the decomposition.
    lengths: Vec<f64>,
    left: Matrix,
    singular: Vec<f64>,
    right: Matrix,
}

impl Linear {
    /// `rows` contain the derivatives of each value with respect to every unknown, divided by the
    /// standard error of the value. `None` if they are not finite.
    pub(super) fn new(rows: &[Vec<f64>], unknowns: usize) -> Option<Self> {
        let lengths: Vec<f64> = (0..unknowns)
            .map(|j| rows.iter().map(|row| row[j] * row[j]).sum::<f64>().sqrt())
            .collect();
        if lengths.iter().any(|length| !length.is_finite()) {
            return None;
        }
        // Rows of zeros are added so that there are at least as many rows as columns.
        let matrix = Matrix::from_fn(rows.len().max(unknowns), unknowns, |i, j| {
            match rows.get(i) {
                Some(row) if lengths[j] > 0.0 => row[j] / lengths[j],
                _ => 0.0,
            }
        });
        let Svd {
            left,
            singular,
            right,
        } = Svd::new(matrix);
        Some(Self {
            lengths,
            left,
            singular,
            right,
        })
    }

    fn unknowns(&self) -> usize {
        self.lengths.len()
    }

    fn is_seen(&self, k: usize) -> bool {
        self.singular[k] > RANK * self.singular[0]
    }

    /// Levenberg-Marquardt step for these residuals; a damping of 0 gives the Gauss-Newton step.
    /// There is no step in undetermined directions.
    pub(super) fn step(&self, residuals: &[f64], damping: f64) -> Vec<f64> {
        let mut step = vec![0.0; self.unknowns()];
        for k in (0..self.unknowns()).filter(|k| self.is_seen(*k)) {
            let s = self.singular[k];
            let along: f64 = residuals
                .iter()
                .enumerate()
                .map(|(i, r)| self.left[(i, k)] * r)
                .sum();
            let amount = along * s / (s * s + damping);
            for (j, step) in step.iter_mut().enumerate() {
                if self.lengths[j] > 0.0 {
                    *step += self.right[(j, k)] * amount / self.lengths[j];
                }
            }
        }
        step
    }

    /// Projects a vector, with one number for each value, orthogonally to the effects of the
    /// unknowns.
    pub(super) fn rest(&self, vector: &[f64]) -> Vec<f64> {
        let mut rest = vector.to_vec();
        for k in (0..self.unknowns()).filter(|k| self.is_seen(*k)) {
            let along: f64 = vector
                .iter()
                .enumerate()
                .map(|(i, value)| self.left[(i, k)] * value)
                .sum();
            for (i, rest) in rest.iter_mut().enumerate() {
                *rest -= along * self.left[(i, k)];
            }
        }
        rest
    }

    /// Leverage of each datum, from 0 to 1.
    pub(super) fn leverages(&self, count: usize) -> Vec<f64> {
        let seen = || (0..self.unknowns()).filter(|k| self.is_seen(*k));
        (0..count)
            .map(|i| seen().map(|k| self.left[(i, k)].powi(2)).sum())
            .collect()
    }

    /// Covariance of the unknowns, without undetermined directions.
    pub(super) fn covariance(&self) -> Vec<Vec<f64>> {
        let entry = |a: usize, b: usize| {
            if self.lengths[a] <= 0.0 || self.lengths[b] <= 0.0 {
                return 0.0;
            }
            let seen = (0..self.unknowns()).filter(|k| self.is_seen(*k));
            let sum: f64 = seen
                .map(|k| self.right[(a, k)] * self.right[(b, k)] / self.singular[k].powi(2))
                .sum();
            sum / (self.lengths[a] * self.lengths[b])
        };
        let unknowns = self.unknowns();
        (0..unknowns)
            .map(|a| (0..unknowns).map(|b| entry(a, b)).collect())
            .collect()
    }

    /// Undetermined directions: the unknowns involved in each.
    pub(super) fn unseen(&self) -> Vec<Vec<usize>> {
        /// Smallest component of an unknown that is involved in a direction.
        const PART: f64 = 0.05;
        let alone = (0..self.unknowns()).filter(|j| self.lengths[*j] <= 0.0);
        let mut directions: Vec<Vec<usize>> = alone.map(|j| vec![j]).collect();
        for k in (0..self.unknowns()).filter(|k| !self.is_seen(*k)) {
            let parts: Vec<usize> = (0..self.unknowns())
                .filter(|j| self.lengths[*j] > 0.0 && self.right[(*j, k)].abs() > PART)
                .collect();
            if !parts.is_empty() {
                directions.push(parts);
            }
        }
        directions
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_by_hand() {
        // y = a + b x at x = 0, 1, 2, 3 with unit errors: the normal matrix is [[4, 6], [6, 14]],
        // its inverse [[0.7, -0.3], [-0.3, 0.2]].
        let rows: Vec<Vec<f64>> = (0..4).map(|x| vec![1.0, f64::from(x)]).collect();
        let linear = Linear::new(&rows, 2).unwrap();
        let covariance = linear.covariance();
        for (a, b, value) in [(0, 0, 0.7), (0, 1, -0.3), (1, 1, 0.2)] {
            assert!((covariance[a][b] - value).abs() < 1e-12);
        }
        let step = linear.step(&[1.0, 3.0, 5.0, 7.0], 0.0);
        assert!((step[0] - 1.0).abs() < 1e-12 && (step[1] - 2.0).abs() < 1e-12);
        let leverages = linear.leverages(4);
        for (leverage, expected) in leverages.iter().zip([0.7, 0.3, 0.3, 0.7]) {
            assert!((leverage - expected).abs() < 1e-12);
        }
        assert!(linear.unseen().is_empty());
        // The residuals of a straight line through 0, 1, 4, 9 are 1, -1, -1, 1.
        let rest = linear.rest(&[0.0, 1.0, 4.0, 9.0]);
        for (rest, expected) in rest.iter().zip([1.0, -1.0, -1.0, 1.0]) {
            assert!((rest - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn what_the_data_do_not_see() {
        // Only the sum of the first two unknowns is determined, the last one not at all.
        let rows: Vec<Vec<f64>> = (1..5)
            .map(|x| vec![f64::from(x), f64::from(x), 1.0, 0.0])
            .collect();
        let linear = Linear::new(&rows, 4).unwrap();
        assert_eq!(linear.unseen(), [vec![3], vec![0, 1]]);
        let step = linear.step(&[2.0, 4.0, 6.0, 8.0], 0.0);
        assert!((step[0] + step[1] - 2.0).abs() < 1e-12 && step[3] == 0.0);
    }
}
