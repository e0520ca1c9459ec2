//! Plans of fast Fourier transforms in two dimensions, and lengths that are fast to transform.

use fakir_fft::{ComplexToReal, Fft, RealToComplex, Transformable};
use num_complex::Complex;
use std::sync::Arc;

/// Precision of a transform: double, or single, which takes half the time.
pub(crate) trait Real: Transformable + Default {
    /// Rounds a number to this precision.
    fn of(value: f64) -> Self;

    fn double(self) -> f64;
}

impl Real for f64 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn double(self) -> f64 {
        self
    }
}

impl Real for f32 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value as Self
    }

    #[inline(always)]
    fn double(self) -> f64 {
        f64::from(self)
    }
}

/// Transforms of a real array: first its rows, to the non-negative half of their frequencies, then the columns of these.
#[derive(Clone)]
pub(crate) struct RealPlans<R = f64> {
    pub(crate) row: Arc<dyn RealToComplex<R>>,
    pub(crate) row_back: Arc<dyn ComplexToReal<R>>,
    pub(crate) column: Arc<dyn Fft<R>>,
    pub(crate) column_back: Arc<dyn Fft<R>>,
}

impl<R: Real> RealPlans<R> {
    /// Plans transforms of an array of this size.
    pub(crate) fn new(rows: usize, columns: usize) -> Self {
        Self {
            row: R::real_forward(columns),
            row_back: R::real_inverse(columns),
            column: R::forward(rows),
            column_back: R::inverse(rows),
        }
    }

    /// Transforms a row, which is overwritten.
    pub(crate) fn row_forward(
        &self,
        row: &mut [R],
        spectrum: &mut [Complex<R>],
        scratch: &mut [Complex<R>],
    ) {
        // The lengths are those of the plans, so this does not fail.
        let _ = self.row.process_with_scratch(row, spectrum, scratch);
    }

    /// Inverse transform of a row; its spectrum is overwritten.
    pub(crate) fn row_back(
        &self,
        spectrum: &mut [Complex<R>],
        row: &mut [R],
        scratch: &mut [Complex<R>],
    ) {
        // The first and, for even lengths, the last coefficient of the transform of real data are real; removes their rounding errors.
        spectrum[0].im = R::default();
        if row.len().is_multiple_of(2) {
            spectrum[row.len() / 2].im = R::default();
        }
        let _ = self.row_back.process_with_scratch(spectrum, row, scratch);
    }

    /// Length of the scratch buffer for each of the transforms, in complex values.
    pub(crate) fn scratch_len(&self) -> usize {
        let of_rows = self.row.get_scratch_len();
        of_rows
            .max(self.row_back.get_scratch_len())
            .max(self.column.get_inplace_scratch_len())
            .max(self.column_back.get_inplace_scratch_len())
    }
}

/// Transforms of a complex array.
#[derive(Clone)]
pub(crate) struct ComplexPlans<R: Real = f64> {
    pub(crate) row: Arc<dyn Fft<R>>,
    pub(crate) row_back: Arc<dyn Fft<R>>,
    pub(crate) column: Arc<dyn Fft<R>>,
    pub(crate) column_back: Arc<dyn Fft<R>>,
}

impl<R: Real> ComplexPlans<R> {
    /// Plans transforms of an array of this size.
    pub(crate) fn new(rows: usize, columns: usize) -> Self {
        Self {
            row: R::forward(columns),
            row_back: R::inverse(columns),
            column: R::forward(rows),
            column_back: R::inverse(rows),
        }
    }

    /// Length of the scratch buffer for each of the transforms, in complex values.
    pub(crate) fn scratch_len(&self) -> usize {
        [&self.row, &self.row_back, &self.column, &self.column_back]
            .map(|plan| plan.get_inplace_scratch_len())
            .into_iter()
            .fold(0, usize::max)
    }
}

/// Smallest even number not below `least` that is fast to transform: `2^a 3^b`, or five times that if it is divisible by 8.
///
/// Most other numbers without larger prime factors take 1.4 to 4 times as long per point (measured from 8 to 640 points, in single
/// precision).
pub(crate) fn smooth_size(least: usize) -> usize {
    let mut size = least.max(2);
    let is_quick = |size: usize| {
        let fives = if size.is_multiple_of(40) { 5 } else { 1 };
        size.is_multiple_of(2) && is_product_of(&[2, 3], size / fives)
    };
    while !is_quick(size) {
        size += 1;
    }
    size
}

/// Smallest number not below `least` without prime factors above 11, for which the transforms have specialised code.
pub(crate) fn smooth_number(least: usize) -> usize {
    let mut number = least.max(1);
    while !is_product_of(&[2, 3, 5, 7, 11], number) {
        number += 1;
    }
    number
}

fn is_product_of(primes: &[usize], mut number: usize) -> bool {
    for prime in primes {
        while number.is_multiple_of(*prime) {
            number /= prime;
        }
    }
    number == 1
}

/// A length not below `least` that is fast to transform: the smallest of the form `2^a 3^b` or `5 2^a 3^b`, unless a power of two is at
/// most a tenth larger.
///
/// Per point, powers of two take 0.65 to 0.8 of the time of the others, and lengths with more factors 5 take 1.2 to 2 times as long
/// (measured between 30 and 2200 points).
pub(crate) fn quick_length(least: usize) -> usize {
    let without = |mut n: usize, prime: usize| {
        while n.is_multiple_of(prime) {
            n /= prime;
        }
        n
    };
    let least = least.max(1);
    let power_of_two = least.next_power_of_two();
    (least..power_of_two)
        .find(|length| matches!(without(without(*length, 2), 3), 1 | 5))
        .filter(|length| 10 * power_of_two > 11 * length)
        .unwrap_or(power_of_two)
}

/// Transposes an array of `rows` and `columns`.
pub(crate) fn transpose<T: Copy>(from: &[T], to: &mut [T], rows: usize, columns: usize) {
    transpose_part(from, columns, to, rows, [rows, columns]);
}

/// Side of the tiles of a transposition: two cache lines of complex numbers. Rows of a power of two share few places of the cache, so that single columns
/// would evict each other.
const TILE: usize = 8;

/// Transposes the first `rows` and `columns` of an array whose rows begin every `from_stride` values, to one whose rows begin every `to_stride` values.
pub(crate) fn transpose_part<T: Copy>(
    from: &[T],
    from_stride: usize,
    to: &mut [T],
    to_stride: usize,
    [rows, columns]: [usize; 2],
) {
    for first_row in (0..rows).step_by(TILE) {
        let tile_rows = first_row..(first_row + TILE).min(rows);
        for first_column in (0..columns).step_by(TILE) {
            for column in first_column..(first_column + TILE).min(columns) {
                let to = &mut to[column * to_stride..][tile_rows.clone()];
                let from = from[first_row * from_stride + column..].iter();
                for (to, from) in to.iter_mut().zip(from.step_by(from_stride)) {
                    *to = *from;
                }
            }
        }
    }
}
