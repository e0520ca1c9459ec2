//! Transforms of arrays that are mirrored at their first row and at their first column.
//!
//! An array of `m` rows and `n` columns that is continued by its mirror images, half a spacing before its first row and its first column,
//! has a period of `2 m` rows and `2 n` columns. Up to a phase of half a spacing, its Fourier transform is real and even, and is determined
//! by the `m n` numbers
//!
//! ```text
//! X_jk = 4 sum_rc x_rc cos(pi j (2 r + 1)/(2 m)) cos(pi k (2 c + 1)/(2 n)),
//! ```
//!
//! a quarter of all. Along one direction, they follow from the transform of `n` numbers: those at even indices, then those at odd indices
//! in reverse order. After a multiplication by the phases `exp(-i pi k/(2 n))`, the real part is column `k` and the imaginary part is minus
//! column `n - k` (J. Makhoul, IEEE Trans. Acoust. Speech Signal Process. 28, 27 (1980)). Rows therefore become complex numbers that
//! contain two real columns each, and columns are transformed in pairs.

use super::fft::{Real, RealPlans};
use super::vector::widest;
use num_complex::{Complex, Complex64};
use std::f64::consts::PI;

/// Transforms of an array of rows and columns, with two real columns in every complex column.
#[derive(Clone)]
pub(crate) struct CosinePlans<R = f64> {
    columns: usize,
    rows: usize,
    plans: RealPlans<R>,
    /// `exp(-i pi k/(2 n))` for every complex column, and the same for every row.
    of_columns: Vec<Complex<R>>,
    of_rows: Vec<Complex<R>>,
}

impl<R: Real> CosinePlans<R> {
    /// Plans transforms of an array of this size.
    pub(crate) fn new(rows: usize, columns: usize) -> Self {
        let phases = |count: usize, length: usize| {
            let phase = |k: usize| {
                let phase = Complex64::from_polar(1.0, -0.5 * PI * k as f64 / length as f64);
                Complex::new(R::of(phase.re), R::of(phase.im))
            };
            (0..count).map(phase).collect()
        };
        Self {
            columns,
            rows,
            plans: RealPlans::new(rows, columns),
            of_columns: phases(columns / 2 + 1, columns),
            of_rows: phases(rows, rows),
        }
    }

    /// Number of complex columns.
    pub(crate) fn column_count(&self) -> usize {
        self.columns / 2 + 1
    }

    /// The real columns in a complex column; `None` where the second one is redundant.
    pub(crate) fn columns_of(&self, complex: usize) -> (usize, Option<usize>) {
        let other = self.columns - complex;
        (complex, (complex > 0 && other != complex).then_some(other))
    }

    /// Length of the scratch buffer for each of the transforms, in complex values.
    pub(crate) fn scratch_len(&self) -> usize {
        self.plans.scratch_len()
    }

    /// Position of a row in a column that is passed to [`column_forward`](Self::column_forward).
    pub(crate) fn place_of(&self, row: usize) -> usize {
        if row.is_multiple_of(2) {
            row / 2
        } else {
            self.rows - 1 - row / 2
        }
    }

    /// Transforms a row, which is overwritten.
    pub(crate) fn row_forward(
        &self,
        row: &mut [R],
        spectrum: &mut [Complex<R>],
        scratch: &mut [Complex<R>],
    ) {
        let length = row.len();
        for (pair, values) in spectrum.iter_mut().zip(row.chunks(2)) {
            *pair = Complex::new(values[0], values.get(1).copied().unwrap_or_default());
        }
        let (even, odd) = row.split_at_mut(length.div_ceil(2));
        for (value, pair) in even.iter_mut().zip(&*spectrum) {
            *value = pair.re;
        }
        for (value, pair) in odd.iter_mut().rev().zip(&*spectrum) {
            *value = pair.im;
        }
        self.plans.row_forward(row, spectrum, scratch);
        for (value, phase) in spectrum.iter_mut().zip(&self.of_columns) {
            let turned = *value * *phase;
            *value = turned + turned;
        }
    }

    /// Evaluates the sum of cosines of a spectrum, which is overwritten.
    pub(crate) fn row_back(
        &self,
        spectrum: &mut [Complex<R>],
        row: &mut [R],
        scratch: &mut [Complex<R>],
    ) {
        for (value, phase) in spectrum.iter_mut().zip(&self.of_columns) {
            *value = *value * phase.conj();
        }
        self.plans.row_back(spectrum, row, scratch);
        let (even, odd) = row.split_at(self.columns.div_ceil(2));
        for (pair, value) in spectrum.iter_mut().zip(even) {
            pair.re = *value;
        }
        for (pair, value) in spectrum.iter_mut().zip(odd.iter().rev()) {
            pair.im = *value;
        }
        for (values, pair) in row.chunks_mut(2).zip(&*spectrum) {
            values[0] = pair.re;
            if let Some(value) = values.get_mut(1) {
                *value = pair.im;
            }
        }
    }

    /// Transforms a complex column, whose rows are at their [positions](Self::place_of), and returns the real columns.
    pub(crate) fn column_forward(
        &self,
        column: &mut [Complex<R>],
        [first, second]: [&mut [R]; 2],
        scratch: &mut [Complex<R>],
    ) {
        self.plans.column.process_with_scratch(column, scratch);
        let rows = self.rows;
        widest(
            #[inline(always)]
            || {
                first[0] = column[0].re + column[0].re;
                second[0] = -(column[0].im + column[0].im);
                for row in 1..=rows / 2 {
                    let (near, far) = (column[row], column[rows - row]);
                    let phase = self.of_rows[row];
                    let [a, b] = [near * phase, far * phase.conj()];
                    let (sum, difference) = (a + b, a - b);
                    first[row] = sum.re;
                    second[row] = -sum.im;
                    // i times the difference; both are the same in the middle.
                    first[rows - row] = -difference.im;
                    second[rows - row] = -difference.re;
                    if 2 * row == rows {
                        first[row] = sum.re;
                        second[row] = -sum.im;
                    }
                }
            },
        );
    }

    /// Inverse transform of two real columns to a complex column, whose rows are at their [positions](Self::place_of).
    pub(crate) fn column_back(
        &self,
        [first, second]: [&[R]; 2],
        column: &mut [Complex<R>],
        scratch: &mut [Complex<R>],
    ) {
        let rows = self.rows;
        widest(
            #[inline(always)]
            || {
                let value = |row: usize| Complex::new(first[row], -second[row]);
                column[0] = value(0);
                for row in 1..=rows / 2 {
                    let (near, far) = (value(row), value(rows - row));
                    let phase = self.of_rows[row];
                    // i times the number in the mirrored row.
                    let far = Complex::new(-far.im, far.re);
                    column[rows - row] = (near + far) * phase;
                    column[row] = (near - far) * phase.conj();
                }
            },
        );
        self.plans.column_back.process_with_scratch(column, scratch);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected: the sums of the definition, and, after the inverse transform with its weights, the array times `4 m n`.
    #[test]
    fn transforms_are_sums_of_cosines() {
        for (rows, columns) in [(4, 6), (6, 5), (2, 2), (10, 12), (12, 9)] {
            let array: Vec<f64> = (0..rows * columns)
                .map(|k| (1.7 * k as f64 + 0.2).sin())
                .collect();
            let plans = CosinePlans::<f64>::new(rows, columns);
            let count = plans.column_count();
            let mut scratch = vec![Complex64::default(); plans.scratch_len()];
            let mut complex = vec![vec![Complex64::default(); rows]; count];
            let mut spectrum = vec![Complex64::default(); count];
            for row in 0..rows {
                let mut values = array[row * columns..][..columns].to_vec();
                plans.row_forward(&mut values, &mut spectrum, &mut scratch);
                for (column, value) in complex.iter_mut().zip(&spectrum) {
                    column[plans.place_of(row)] = *value;
                }
            }
            let cosine = |k: usize, at: usize, length: usize| {
                (PI * k as f64 * (2 * at + 1) as f64 / (2 * length) as f64).cos()
            };
            for (k, column) in complex.iter_mut().enumerate() {
                let (mut first, mut second) = (vec![0.0; rows], vec![0.0; rows]);
                plans.column_forward(column, [&mut first, &mut second], &mut scratch);
                let (one, other) = plans.columns_of(k);
                let found = std::iter::once((one, &first)).chain(other.map(|k| (k, &second)));
                for (k, values) in found {
                    for (j, value) in values.iter().enumerate() {
                        let terms = array.iter().enumerate().map(|(index, x)| {
                            let (row, place) = (index / columns, index % columns);
                            4.0 * x * cosine(j, row, rows) * cosine(k, place, columns)
                        });
                        let expected: f64 = terms.sum();
                        assert!(
                            (value - expected).abs() < 1e-12,
                            "{j} {k}: {value} {expected}"
                        );
                    }
                }
                plans.column_back([&first, &second], column, &mut scratch);
            }
            for row in 0..rows {
                for (value, column) in spectrum.iter_mut().zip(&complex) {
                    *value = column[plans.place_of(row)];
                }
                let mut values = vec![0.0; columns];
                plans.row_back(&mut spectrum, &mut values, &mut scratch);
                for (value, expected) in values.iter().zip(&array[row * columns..]) {
                    let expected = expected * (4 * rows * columns) as f64;
                    assert!((value - expected).abs() < 1e-10, "{value} {expected}");
                }
            }
        }
    }
}
