//! Dense matrices and their factors `L U`.

use super::product::{Part, Product};
use super::vector::{add_scaled, inner_dot, largest, widest};
use std::ops::{Index, IndexMut, Mul, Range};

/// Largest number of columns that is factorised without dividing it into two halves.
const NARROW: usize = 8;

/// A matrix, stored column by column.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

impl Matrix {
    /// Creates the matrix with the elements `value(row, column)`.
    #[must_use]
    pub fn from_fn(
        rows: usize,
        columns: usize,
        mut value: impl FnMut(usize, usize) -> f64,
    ) -> Self {
        let mut values = Vec::with_capacity(rows * columns);
        for column in 0..columns {
            values.extend((0..rows).map(|row| value(row, column)));
        }
        Self {
            rows,
            columns,
            values,
        }
    }

    /// Creates a matrix of zeros.
    #[must_use]
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self {
            rows,
            columns,
            values: vec![0.0; rows * columns],
        }
    }

    /// Creates the unit matrix.
    #[must_use]
    pub fn identity(size: usize) -> Self {
        let mut unit = Self::zeros(size, size);
        for k in 0..size {
            unit[(k, k)] = 1.0;
        }
        unit
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// One column.
    #[must_use]
    pub fn column(&self, column: usize) -> &[f64] {
        &self.values[column * self.rows..][..self.rows]
    }

    /// One column, mutable.
    pub fn column_mut(&mut self, column: usize) -> &mut [f64] {
        &mut self.values[column * self.rows..][..self.rows]
    }

    /// Two columns, mutable; the second index must be larger than the first.
    pub(super) fn two_columns_mut(&mut self, [one, two]: [usize; 2]) -> [&mut [f64]; 2] {
        let (head, tail) = self.values.split_at_mut(two * self.rows);
        [
            &mut head[one * self.rows..][..self.rows],
            &mut tail[..self.rows],
        ]
    }

    /// The transposed matrix.
    #[must_use]
    pub fn transposed(&self) -> Self {
        Self::from_fn(self.columns, self.rows, |row, column| self[(column, row)])
    }

    /// The product with a vector.
    #[must_use]
    pub fn times(&self, vector: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; self.rows];
        for (column, factor) in vector.iter().enumerate() {
            add_scaled(&mut product, *factor, self.column(column));
        }
        product
    }

    /// Adds `factor` times the product of two matrices.
    ///
    /// # Panics
    /// If the sizes do not match.
    pub fn add_product(&mut self, factor: f64, left: &Self, right: &Self) {
        assert_eq!(
            (self.rows, self.columns, left.columns),
            (left.rows, right.columns, right.rows),
            "sizes of a product"
        );
        let mut product = Product::new();
        product.set_right(right.rows, right.columns, |row, column| {
            right[(row, column)]
        });
        let part = Part {
            values: &left.values,
            stride: left.rows,
        };
        product.add(factor, part, left.rows, &mut self.values, self.rows);
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;

    #[inline]
    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        debug_assert!(row < self.rows);
        &self.values[column * self.rows + row]
    }
}

impl IndexMut<(usize, usize)> for Matrix {
    #[inline]
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut f64 {
        debug_assert!(row < self.rows);
        &mut self.values[column * self.rows + row]
    }
}

impl Mul for &Matrix {
    type Output = Matrix;

    fn mul(self, right: &Matrix) -> Matrix {
        let mut product = Matrix::zeros(self.rows, right.columns);
        product.add_product(1.0, self, right);
        product
    }
}

/// Factors `L U` of a square matrix, with ones on the diagonal of `L` and rows exchanged such that no element of `L` is larger than 1
/// (partial pivoting).
///
/// If a pivot is zero or an element is NaN, solutions are not finite.
#[derive(Debug, Clone)]
pub struct Lu {
    size: usize,
    /// `U`, and `L` below it, stored by columns.
    factors: Vec<f64>,
    /// The row with which each row was exchanged, in order.
    pivots: Vec<usize>,
}

impl Lu {
    /// Factorises a square matrix.
    ///
    /// Divides the columns recursively into two halves, so that most of the work consists of matrix products (S. Toledo, SIAM J. Matrix
    /// Anal. Appl. 18, 1065 (1997)).
    ///
    /// # Panics
    /// If the matrix is not square.
    #[must_use]
    pub fn new(matrix: Matrix) -> Self {
        assert_eq!(matrix.rows, matrix.columns, "a square matrix");
        let size = matrix.rows;
        let mut factors = matrix.values;
        let mut pivots = vec![0; size];
        let mut columns = Columns {
            height: size,
            product: Product::new(),
        };
        columns.factorise(&mut factors, 0, &mut pivots);
        Self {
            size,
            factors,
            pivots,
        }
    }

    /// Whether the determinant is negative.
    #[must_use]
    pub fn has_negative_determinant(&self) -> bool {
        let diagonal = self.columns().filter(|(k, column)| column[*k] < 0.0);
        let exchanges = self.pivots.iter().enumerate();
        let exchanges = exchanges.filter(|(row, other)| row != *other);
        (diagonal.count() + exchanges.count()) % 2 == 1
    }

    fn columns(&self) -> impl DoubleEndedIterator<Item = (usize, &[f64])> {
        self.factors.chunks_exact(self.size.max(1)).enumerate()
    }

    /// Solves `A x = b` in place.
    pub fn solve(&self, right: &mut [f64]) {
        exchange(right, 0, &self.pivots);
        widest(
            #[inline(always)]
            || {
                for (k, column) in self.columns() {
                    let value = right[k];
                    for (b, l) in right[k + 1..].iter_mut().zip(&column[k + 1..]) {
                        *b -= value * l;
                    }
                }
                for (k, column) in self.columns().rev() {
                    let value = right[k] / column[k];
                    right[k] = value;
                    for (b, u) in right[..k].iter_mut().zip(column) {
                        *b -= value * u;
                    }
                }
            },
        );
    }

    /// Solves `A' x = b` in place.
    pub fn solve_transposed(&self, right: &mut [f64]) {
        widest(
            #[inline(always)]
            || {
                for (k, column) in self.columns() {
                    let sum = inner_dot(&column[..k], &right[..k]);
                    right[k] = (right[k] - sum) / column[k];
                }
                for (k, column) in self.columns().rev() {
                    right[k] -= inner_dot(&column[k + 1..], &right[k + 1..]);
                }
            },
        );
        for (row, pivot) in self.pivots.iter().enumerate().rev() {
            right.swap(row, *pivot);
        }
    }
}

/// Applies row exchanges to a column, starting at row `first`.
fn exchange(column: &mut [f64], first: usize, pivots: &[usize]) {
    for (row, pivot) in pivots.iter().enumerate() {
        column.swap(first + row, *pivot);
    }
}

/// Operations on columns of this height that are stored in one slice.
struct Columns {
    height: usize,
    product: Product,
}

impl Columns {
    /// The number of columns in the first half of more than [`NARROW`] columns.
    fn half(count: usize) -> usize {
        (count / 2).next_multiple_of(NARROW)
    }

    /// Factorises the rows of some columns from `first` on.
    fn factorise(&mut self, columns: &mut [f64], first: usize, pivots: &mut [usize]) {
        if pivots.len() <= NARROW {
            self.factorise_narrow(columns, first, pivots);
            return;
        }
        let half = Self::half(pivots.len());
        let (left, right) = columns.split_at_mut(half * self.height);
        let (left_pivots, right_pivots) = pivots.split_at_mut(half);
        self.factorise(left, first, left_pivots);
        for column in right.chunks_exact_mut(self.height) {
            exchange(column, first, left_pivots);
        }
        self.solve_lower(left, first, right);
        self.subtract_product(left, first..first + half, self.height, right);
        self.factorise(right, first + half, right_pivots);
        for column in left.chunks_exact_mut(self.height) {
            exchange(column, first + half, right_pivots);
        }
    }

    /// Factorises column by column.
    fn factorise_narrow(&self, columns: &mut [f64], first: usize, pivots: &mut [usize]) {
        for (k, pivot) in pivots.iter_mut().enumerate() {
            let row = first + k;
            let (done, rest) = columns.split_at_mut((k + 1) * self.height);
            let (before, own) = done.split_at_mut(k * self.height);
            let most = largest(&own[row..]);
            // No position is found if an element is NaN.
            let place = own[row..].iter().position(|value| value.abs() >= most);
            *pivot = row + place.unwrap_or(0);
            for column in before
                .chunks_exact_mut(self.height)
                .chain([&mut *own])
                .chain(rest.chunks_exact_mut(self.height))
            {
                column.swap(row, *pivot);
            }
            // If the pivot is zero, so are all elements below it.
            if most == 0.0 {
                continue;
            }
            widest(
                #[inline(always)]
                || {
                    let (head, below) = own.split_at_mut(row + 1);
                    below.iter_mut().for_each(|value| *value /= head[row]);
                    for column in rest.chunks_exact_mut(self.height) {
                        let (head, others) = column.split_at_mut(row + 1);
                        for (value, l) in others.iter_mut().zip(&*below) {
                            *value -= head[row] * l;
                        }
                    }
                },
            );
        }
    }

    /// Solves `L x = b`, with `L` in the rows of `left` from `first` on, and `b` in the same rows of `right`.
    fn solve_lower(&mut self, left: &[f64], first: usize, right: &mut [f64]) {
        let count = left.len() / self.height;
        if count > NARROW {
            let half = Self::half(count);
            let (one, other) = left.split_at(half * self.height);
            self.solve_lower(one, first, right);
            self.subtract_product(one, first..first + half, first + count, right);
            self.solve_lower(other, first + half, right);
            return;
        }
        // The halves are multiples of `NARROW`.
        let lower: [[f64; NARROW]; NARROW] = std::array::from_fn(|k| {
            let column = &left[k * self.height + first..];
            std::array::from_fn(|row| if row > k { column[row] } else { 0.0 })
        });
        widest(
            #[inline(always)]
            || {
                for column in right.chunks_exact_mut(self.height) {
                    if let Some(values) = column[first..].first_chunk_mut::<NARROW>() {
                        for (k, lower) in lower.iter().enumerate() {
                            let value = values[k];
                            for (b, l) in values.iter_mut().zip(lower) {
                                *b -= value * l;
                            }
                        }
                    }
                }
            },
        );
    }

    /// Subtracts the product of `left` with the rows `rows` of `right` from the rows of `right` after this range, up to `end`.
    fn subtract_product(
        &mut self,
        left: &[f64],
        rows: Range<usize>,
        end: usize,
        right: &mut [f64],
    ) {
        let height = self.height;
        if rows.end == end {
            return;
        }
        let value = |k: usize, column: usize| right[column * height + rows.start + k];
        self.product
            .set_right(rows.len(), right.len() / height, value);
        let part = Part {
            values: &left[rows.end..],
            stride: height,
        };
        let result = &mut right[rows.end..];
        self.product.add(-1.0, part, end - rows.end, result, height);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sizes at the boundaries of blocks and tiles.
    const SIZES: [usize; 16] = [0, 1, 2, 3, 7, 8, 9, 15, 16, 17, 31, 64, 65, 97, 150, 300];

    fn element(i: usize, j: usize) -> f64 {
        ((3 * i * i + 7 * j) as f64).sin() + ((i * j) as f64).cos()
    }

    fn square(size: usize) -> Matrix {
        Matrix::from_fn(size, size, element)
    }

    fn largest_sum(matrix: &Matrix) -> f64 {
        let ones = Matrix::from_fn(matrix.rows, matrix.columns, |i, j| matrix[(i, j)].abs());
        let sums = ones.times(&vec![1.0; matrix.columns]);
        largest(&sums)
    }

    /// Expected: residuals of a few roundings of the matrix times the solution, for the matrix and its transpose.
    fn check_solutions(matrix: &Matrix) {
        let factors = Lu::new(matrix.clone());
        let size = matrix.rows;
        let transposed = matrix.transposed();
        for turn in [0.7, 1.3] {
            let right: Vec<f64> = (0..size).map(|k| (turn * k as f64).cos()).collect();
            let [mut solution, mut of_transposed] = [right.clone(), right.clone()];
            factors.solve(&mut solution);
            factors.solve_transposed(&mut of_transposed);
            for (matrix, solution) in [(matrix, &solution), (&transposed, &of_transposed)] {
                let scale = largest_sum(matrix) * largest(solution) + 1.0;
                for (product, right) in matrix.times(solution).iter().zip(&right) {
                    let residual = (product - right).abs();
                    assert!(
                        residual <= 2.0 * f64::EPSILON * (size as f64).sqrt() * scale,
                        "{size}: {residual:e} {scale:e}"
                    );
                }
            }
        }
    }

    /// Expected: sums of products, computed one by one.
    #[test]
    fn products_of_all_sizes() {
        for (rows, inner, columns) in [
            (0, 3, 2),
            (3, 0, 2),
            (2, 3, 0),
            (1, 1, 1),
            (11, 8, 3),
            (12, 255, 4),
            (13, 256, 5),
            (95, 257, 9),
            (97, 40, 7),
            (200, 520, 6),
        ] {
            let left = Matrix::from_fn(rows, inner, element);
            let right = Matrix::from_fn(inner, columns, |i, j| element(j + 1, i));
            let mut sum = Matrix::from_fn(rows, columns, |i, j| (i + j) as f64);
            sum.add_product(-0.5, &left, &right);
            for i in 0..rows {
                for j in 0..columns {
                    let product: f64 = (0..inner).map(|k| left[(i, k)] * right[(k, j)]).sum();
                    let error = sum[(i, j)] - ((i + j) as f64 - 0.5 * product);
                    assert!(error.abs() < 1e-12, "{rows} {inner} {columns} {error:e}");
                }
            }
        }
    }

    /// Expected: `L U` is the matrix with its rows exchanged, and no element of `L` is larger than 1.
    #[test]
    fn factors_of_all_sizes() {
        for size in SIZES {
            let matrix = square(size);
            let lu = Lu::new(matrix.clone());
            let at = |i: usize, j: usize| lu.factors[j * size + i];
            let lower = Matrix::from_fn(size, size, |i, j| match i.cmp(&j) {
                std::cmp::Ordering::Less => 0.0,
                std::cmp::Ordering::Equal => 1.0,
                std::cmp::Ordering::Greater => at(i, j),
            });
            let upper = Matrix::from_fn(size, size, |i, j| if i <= j { at(i, j) } else { 0.0 });
            assert!(lower.values.iter().all(|value| value.abs() <= 1.0));
            let product = &lower * &upper;
            let tolerance = 2.0 * f64::EPSILON * size as f64 * largest(&upper.values);
            for j in 0..size {
                let mut expected = matrix.column(j).to_vec();
                exchange(&mut expected, 0, &lu.pivots);
                for (found, expected) in product.column(j).iter().zip(&expected) {
                    assert!(
                        (found - expected).abs() <= tolerance,
                        "{size}: {found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn solutions_of_all_sizes() {
        for size in SIZES {
            check_solutions(&square(size));
        }
    }

    #[test]
    fn rows_are_exchanged_where_the_diagonal_is_zero() {
        for size in [2, 9, 40] {
            // Row `k` is a scaled row `k + 1` of the unit matrix.
            check_solutions(&Matrix::from_fn(size, size, |i, j| {
                f64::from(u8::from((i + 1) % size == j)) * 10f64.powi(j as i32 - 20)
            }));
        }
    }

    #[test]
    fn nearly_singular_matrices_leave_small_residuals() {
        // The Hilbert matrix, whose condition number exceeds the range of double precision; and a matrix with two rows that are equal up to
        // rounding.
        check_solutions(&Matrix::from_fn(20, 20, |i, j| {
            ((i + j + 1) as f64).recip()
        }));
        check_solutions(&Matrix::from_fn(50, 50, |i, j| {
            element(i.min(48), j) + if i == 49 && j == 3 { 1e-15 } else { 0.0 }
        }));
    }

    #[test]
    fn solutions_of_singular_matrices_are_not_finite() {
        let no_column = Matrix::from_fn(40, 40, |i, j| if j == 20 { 0.0 } else { element(i, j) });
        let no_row = no_column.transposed();
        let rank_one = Matrix::from_fn(20, 20, |_, j| (j + 1) as f64);
        for matrix in [
            Matrix::zeros(1, 1),
            Matrix::zeros(30, 30),
            no_column,
            no_row,
            rank_one,
        ] {
            let factors = Lu::new(matrix.clone());
            let ones = || vec![1.0; matrix.rows];
            let (mut solution, mut of_transposed) = (ones(), ones());
            factors.solve(&mut solution);
            factors.solve_transposed(&mut of_transposed);
            for values in [solution, of_transposed] {
                assert!(values.iter().any(|value| !value.is_finite()), "{matrix:?}");
            }
        }
    }

    #[test]
    fn what_is_no_number_is_passed_on() {
        for size in [1, 8, 9, 40] {
            for place in [(0, 0), (size - 1, 0), (0, size - 1), (size / 2, size / 2)] {
                let mut matrix = square(size);
                matrix[place] = f64::NAN;
                let factors = Lu::new(matrix);
                let mut right = vec![1.0; size];
                factors.solve(&mut right);
                assert!(right.iter().any(|value| value.is_nan()), "{size} {place:?}");
                right.fill(1.0);
                factors.solve_transposed(&mut right);
                assert!(right.iter().any(|value| value.is_nan()), "{size} {place:?}");
            }
        }
    }
}
