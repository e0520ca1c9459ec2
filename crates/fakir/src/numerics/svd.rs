//! Singular value decomposition by one-sided Jacobi rotations.

use super::dense::Matrix;
use super::vector::dot;

/// Limit of sweeps over all pairs of columns. Convergence is quadratic; ten sweeps are sufficient.
const SWEEPS: usize = 30;

/// The decomposition `A = U S V'` of a matrix, with as many singular values as it has columns.
#[derive(Debug, Clone)]
pub struct Svd {
    /// Left singular vectors, in columns; zero for singular values that are zero.
    pub left: Matrix,
    /// Singular values in decreasing order.
    pub singular: Vec<f64>,
    /// Right singular vectors, in columns.
    pub right: Matrix,
}

impl Svd {
    /// Decomposes a matrix. If the matrix contains numbers that are not finite, so does the decomposition.
    #[must_use]
    pub fn new(mut matrix: Matrix) -> Self {
        let turned = orthogonalise(&mut matrix);
        let lengths: Vec<f64> = (0..matrix.columns())
            .map(|k| dot(matrix.column(k), matrix.column(k)).sqrt())
            .collect();
        let mut order: Vec<usize> = (0..lengths.len()).collect();
        order.sort_by(|one, other| lengths[*other].total_cmp(&lengths[*one]));
        let unit = |row, k: usize| match lengths[order[k]] {
            length if length > 0.0 => matrix[(row, order[k])] / length,
            // Zero or NaN.
            length => length,
        };
        Self {
            left: Matrix::from_fn(matrix.rows(), order.len(), unit),
            right: Matrix::from_fn(order.len(), order.len(), |row, k| turned[(row, order[k])]),
            singular: order.iter().map(|k| lengths[*k]).collect(),
        }
    }
}

/// Makes the columns of a matrix orthogonal by an orthogonal matrix on its right, which is returned (G. H. Golub and C. F. Van Loan, Matrix
/// Computations, section 8.6.3).
///
/// Small singular values have a high relative accuracy even if the columns have very different lengths.
#[must_use]
pub(crate) fn orthogonalise(matrix: &mut Matrix) -> Matrix {
    let count = matrix.columns();
    let mut rotation = Matrix::identity(count);
    // Rounding of a scalar product of unit columns.
    let tolerance = f64::EPSILON * (matrix.rows() as f64).sqrt();
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for j in 1..count {
            for i in 0..j {
                let [ii, jj, ij] =
                    [(i, i), (j, j), (i, j)].map(|(l, r)| dot(matrix.column(l), matrix.column(r)));
                if ij.abs() <= tolerance * ii.sqrt() * jj.sqrt() {
                    continue;
                }
                rotated = true;
                let cotangent = (jj - ii) / (2.0 * ij);
                let tangent = cotangent.signum() / (cotangent.abs() + cotangent.hypot(1.0));
                rotate(matrix.two_columns_mut([i, j]), tangent);
                rotate(rotation.two_columns_mut([i, j]), tangent);
            }
        }
        if !rotated {
            break;
        }
    }
    rotation
}

fn rotate([one, other]: [&mut [f64]; 2], tangent: f64) {
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = cosine * tangent;
    for (left, right) in one.iter_mut().zip(other) {
        (*left, *right) = (
            cosine * *left - sine * *right,
            sine * *left + cosine * *right,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected: `U S V'` is the matrix and `V' V` the unit matrix, within a few roundings in every column; `U' U` is the unit matrix for
    /// singular values that are not zero.
    fn check(matrix: &Matrix, rank: usize) -> Svd {
        let svd = Svd::new(matrix.clone());
        let [rows, columns] = [matrix.rows(), matrix.columns()];
        let size = (rows * columns).max(1) as f64;
        let tolerance = 4.0 * f64::EPSILON * size.sqrt();
        assert!(svd.singular.is_sorted_by(|a, b| a >= b));
        let is_unit = |product: &Matrix, count: usize| {
            for i in 0..count {
                for j in 0..count {
                    let unit = f64::from(u8::from(i == j));
                    assert!((product[(i, j)] - unit).abs() < tolerance, "{rows} {i} {j}");
                }
            }
        };
        is_unit(&(&svd.right.transposed() * &svd.right), columns);
        is_unit(&(&svd.left.transposed() * &svd.left), rank);
        let scaled = Matrix::from_fn(rows, columns, |i, k| svd.left[(i, k)] * svd.singular[k]);
        let again = &scaled * &svd.right.transposed();
        for j in 0..columns {
            let length = dot(matrix.column(j), matrix.column(j)).sqrt();
            for i in 0..rows {
                let error = (again[(i, j)] - matrix[(i, j)]).abs();
                assert!(error <= tolerance * length, "{i} {j} {error:e}");
            }
        }
        svd
    }

    fn element(i: usize, j: usize) -> f64 {
        ((3 * i * i + 7 * j) as f64).sin() + ((i * j) as f64).cos()
    }

    #[test]
    fn decomposes_what_it_was_made_from() {
        for (rows, columns) in [(0, 0), (1, 1), (4, 1), (5, 5), (40, 7), (150, 20), (600, 5)] {
            let _ = check(&Matrix::from_fn(rows, columns, element), columns);
        }
    }

    #[test]
    fn a_matrix_by_hand() {
        // [[3, 0], [4, 5]] has the singular values sqrt 45 and sqrt 5.
        let svd = check(
            &Matrix::from_fn(2, 2, |i, j| [[3.0, 0.0], [4.0, 5.0]][i][j]),
            2,
        );
        for (found, square) in svd.singular.iter().zip([45.0, 5.0]) {
            assert!((found * found - square).abs() < 1e-13);
        }
    }

    #[test]
    fn counts_the_rank() {
        // Linear combinations of two columns, and a column of zeros.
        let matrix = Matrix::from_fn(30, 5, |i, j| {
            [1.0, 2.0, -3.0, 0.5, 0.0][j] * element(i, 1)
                + [1.0, 0.0, 4.0, 2.0, 0.0][j] * element(i, 2)
        });
        let svd = check(&matrix, 2);
        let largest = svd.singular[0];
        assert!(svd.singular[1] > 1e-3 * largest);
        assert!(svd.singular[2] < 1e-15 * largest && svd.singular[4] == 0.0);
        assert!(svd.left.column(4).iter().all(|value| *value == 0.0));
        let svd = check(&Matrix::zeros(4, 3), 0);
        assert_eq!(svd.singular, [0.0; 3]);
    }

    /// Expected: for columns with lengths over 200 decades, the singular values of columns that are orthogonalised one after the other,
    /// since they hardly interact.
    #[test]
    fn small_singular_values_of_graded_columns() {
        let scales = [1.0, 1e-50, 1e-100, 1e-140];
        let matrix = Matrix::from_fn(12, 4, |i, j| scales[j] * element(i, j));
        let svd = check(&matrix, 4);
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for (j, scale) in scales.iter().enumerate() {
            let mut column: Vec<f64> = (0..12).map(|i| element(i, j)).collect();
            for other in &basis {
                let along = dot(other, &column);
                column
                    .iter_mut()
                    .zip(other)
                    .for_each(|(x, y)| *x -= along * y);
            }
            let length = dot(&column, &column).sqrt();
            assert!(
                (svd.singular[j] / (length * scale) - 1.0).abs() < 1e-13,
                "{j}"
            );
            basis.push(column.iter().map(|x| x / length).collect());
        }
    }

    #[test]
    fn passes_on_what_is_no_number() {
        let svd = Svd::new(Matrix::from_fn(
            3,
            2,
            |i, j| if i == j { f64::NAN } else { 1.0 },
        ));
        assert!(svd.singular.iter().all(|value| value.is_nan()));
    }
}
