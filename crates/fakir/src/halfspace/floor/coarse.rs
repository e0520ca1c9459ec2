//! Coefficients on the pillars and their transforms, on the coarse grid of half lattice cells.

use crate::halfspace::elements::convolution::BLOCK_WIDTH;
use crate::numerics::fft::{Real, RealPlans};
use num_complex::Complex64;
use std::sync::{Mutex, PoisonError};

/// Transforms of the floor that are combined with those of pillars on the coarse grid.
pub(super) trait BesidePillars {
    /// Whether the kernels of the coupled modes are imaginary.
    fn odd(&self) -> &[bool];

    /// Stores the coefficients of a mode of all pillars after they were placed on the coarse grid.
    fn take_mode(&self, coarse: &mut Coarse, mode: usize);

    /// Adds up the loads on pillars due to the floor.
    fn gather(&self, coarse: &mut Coarse);

    /// Number of values in all kernels.
    #[cfg(any(test, feature = "kernels"))]
    fn kernel_count(&self) -> usize;
}

/// Transforms over the coarse grid, with buffers.
pub(super) struct Coarse {
    shape: [usize; 2],
    plans: RealPlans,
    /// Values at all points, by rows.
    pub(super) grid: Vec<f64>,
    /// The non-redundant half of the columns, each with its rows.
    columns: Vec<Complex64>,
    line: Vec<Complex64>,
    scratch: Vec<Complex64>,
    /// Folded transforms: for every column and every mode, its rows, real and imaginary parts.
    folded: Vec<f64>,
}

impl Coarse {
    /// Number of columns and rows.
    #[cfg(any(test, feature = "kernels"))]
    pub(super) fn shape(&self) -> [usize; 2] {
        self.shape
    }

    pub(super) fn new(shape: [usize; 2], modes: usize) -> Self {
        let [columns, rows] = shape;
        let plans = RealPlans::new(rows, columns);
        let half = columns / 2 + 1;
        Self {
            shape,
            grid: vec![0.0; columns * rows],
            columns: vec![Complex64::default(); half * rows],
            line: vec![Complex64::default(); half],
            scratch: vec![Complex64::default(); plans.scratch_len()],
            folded: vec![0.0; 2 * columns * modes * rows],
            plans,
        }
    }

    /// Places the coefficients of all pillars on the grid.
    pub(super) fn put<'v>(
        &mut self,
        places: &[Option<usize>],
        values: impl Iterator<Item = &'v f64>,
    ) {
        self.grid.fill(0.0);
        for (place, value) in places.iter().zip(values) {
            if let Some(place) = place {
                self.grid[*place] = *value;
            }
        }
    }

    /// Replaces the values by the mean of mirror images about the first point, along x and along y, with a sign change for odd modes.
    pub(super) fn mirror(&mut self, odd: [bool; 2]) {
        let [columns, rows] = self.shape;
        let sign = odd.map(|odd| if odd { -1.0 } else { 1.0 });
        let image = |at: usize, length: usize| if at == 0 { 0 } else { length - at };
        for row in 0..=rows / 2 {
            for column in 0..=columns / 2 {
                let (far_row, far_column) = (image(row, rows), image(column, columns));
                let signs = [1.0, sign[0], sign[1], sign[0] * sign[1]];
                let places = [
                    row * columns + column,
                    row * columns + far_column,
                    far_row * columns + column,
                    far_row * columns + far_column,
                ];
                let terms = places.iter().zip(signs);
                let mean = 0.25
                    * terms
                        .map(|(place, sign)| sign * self.grid[*place])
                        .sum::<f64>();
                for (place, sign) in places.into_iter().zip(signs) {
                    self.grid[place] = sign * mean;
                }
            }
        }
    }

    /// Transforms the grid.
    pub(super) fn transform(&mut self) {
        let [columns, rows] = self.shape;
        for (row, values) in self.grid.chunks_exact_mut(columns).enumerate() {
            self.plans
                .row_forward(values, &mut self.line, &mut self.scratch);
            for (column, value) in self.columns.chunks_exact_mut(rows).zip(&self.line) {
                column[row] = *value;
            }
        }
        self.plans
            .column
            .process_with_scratch(&mut self.columns, &mut self.scratch);
    }

    /// Writes the transform into the columns of all modes.
    pub(super) fn write<R: Real>(&self, mode: usize, spectra: &mut [R]) {
        let [columns, rows] = self.shape;
        let stride = spectra.len() / columns;
        for (number, column) in self.columns.chunks_exact(rows).enumerate() {
            let at = number * stride + 2 * mode * rows;
            let (real, imaginary) = spectra[at..at + 2 * rows].split_at_mut(rows);
            for ((re, im), value) in real.iter_mut().zip(imaginary).zip(column) {
                (*re, *im) = (R::of(value.re), R::of(value.im));
            }
            let opposite = columns - number;
            if number > 0 && opposite != number {
                let at = opposite * stride + 2 * mode * rows;
                let (real, imaginary) = spectra[at..at + 2 * rows].split_at_mut(rows);
                for (row, value) in column.iter().enumerate() {
                    let mirrored = if row == 0 { 0 } else { rows - row };
                    (real[mirrored], imaginary[mirrored]) = (R::of(value.re), R::of(-value.im));
                }
            }
        }
    }

    /// Writes only the real part, or minus the imaginary part.
    pub(super) fn write_real<R: Real>(&self, mode: usize, imaginary: bool, spectra: &mut [R]) {
        let [columns, rows] = self.shape;
        let stride = spectra.len() / columns;
        let part = |value: Complex64| if imaginary { -value.im } else { value.re };
        for (number, column) in self.columns.chunks_exact(rows).enumerate() {
            let values = &mut spectra[number * stride + mode * rows..][..rows];
            for (to, value) in values.iter_mut().zip(column) {
                *to = R::of(part(*value));
            }
            let opposite = columns - number;
            if number > 0 && opposite != number {
                let values = &mut spectra[opposite * stride + mode * rows..][..rows];
                for (row, value) in column.iter().enumerate() {
                    let mirrored = if row == 0 { 0 } else { rows - row };
                    values[mirrored] = R::of(part(value.conj()));
                }
            }
        }
    }

    /// Adds up the folded real columns that are equivalent on the coarse grid; every complex column contains one or two. Only half of the
    /// rows are stored: each has a mirror image, and the first one has half its weight.
    pub(super) fn gather_real<R: Real>(
        &mut self,
        columns_of: impl Fn(usize) -> (usize, Option<usize>),
        parities: &[[bool; 2]],
        folded: &[Mutex<Vec<R>>],
    ) {
        let rows = self.shape[1];
        let stride = 2 * parities.len() * rows;
        self.folded.fill(0.0);
        if stride == 0 {
            return;
        }
        for (block, folded) in folded.iter().enumerate() {
            let folded = folded.lock().unwrap_or_else(PoisonError::into_inner);
            for (k, values) in folded.chunks_exact(stride).enumerate() {
                let (one, other) = columns_of(block * BLOCK_WIDTH + k);
                let parts = values.chunks_exact(stride / 2);
                for (column, values) in [Some(one), other].into_iter().zip(parts) {
                    let Some(column) = column else {
                        continue;
                    };
                    let weight = if column == 0 { 0.5 } else { 1.0 };
                    let sums = &mut self.folded[column % self.shape[0] * stride..][..stride];
                    let sums = sums.chunks_exact_mut(2 * rows);
                    let of_modes = sums.zip(values.chunks_exact(rows));
                    for (sum, values) in of_modes {
                        for (sum, value) in sum.iter_mut().zip(values) {
                            *sum += weight * value.double();
                        }
                    }
                }
            }
        }
        // Only now the mirror images of the rows, as there are fewer columns.
        for sums in self.folded.chunks_exact_mut(stride) {
            for (sum, [_, odd]) in sums.chunks_exact_mut(2 * rows).zip(parities) {
                let sign = if *odd { -1.0 } else { 1.0 };
                sum[0] += sign * sum[0];
                for row in 1..=rows / 2 {
                    let [one, other] = [sum[row], sum[rows - row]];
                    (sum[row], sum[rows - row]) = (one + sign * other, other + sign * one);
                }
            }
        }
    }

    /// Adds up the folded columns that are equivalent on the coarse grid. `columns` is their number on the fine grid. Only half of them are
    /// stored; the first and the last one are their own conjugates.
    pub(super) fn gather<R: Real>(&mut self, columns: usize, folded: &[Mutex<Vec<R>>]) {
        let stride = self.folded.len() / self.shape[0];
        let last = columns / 2;
        self.folded.fill(0.0);
        for (block, folded) in folded.iter().enumerate() {
            let folded = folded.lock().unwrap_or_else(PoisonError::into_inner);
            for (k, values) in folded.chunks_exact(stride).enumerate() {
                let column = block * BLOCK_WIDTH + k;
                let weight = if column == 0 || column == last {
                    0.5
                } else {
                    1.0
                };
                let sum = &mut self.folded[column % self.shape[0] * stride..][..stride];
                for (sum, value) in sum.iter_mut().zip(values) {
                    *sum += weight * value.double();
                }
            }
        }
    }

    /// Transforms one mode back to the grid: the sum over the stored half and over its conjugates.
    pub(super) fn back(&mut self, mode: usize, odd: bool) {
        let [columns, rows] = self.shape;
        let stride = self.folded.len() / columns;
        // conj(i) of imaginary kernels.
        let factor = if odd {
            Complex64::new(0.0, -1.0)
        } else {
            Complex64::new(1.0, 0.0)
        };
        for (number, column) in self.columns.chunks_exact_mut(rows).enumerate() {
            let of = |number: usize, row: usize| {
                let parts = &self.folded[number * stride + 2 * mode * rows..];
                factor * Complex64::new(parts[row], parts[rows + row])
            };
            for (row, value) in column.iter_mut().enumerate() {
                let opposite = if row == 0 { 0 } else { rows - row };
                *value = of(number, row) + of((columns - number) % columns, opposite).conj();
            }
        }
        self.plans
            .column_back
            .process_with_scratch(&mut self.columns, &mut self.scratch);
        for (row, values) in self.grid.chunks_exact_mut(columns).enumerate() {
            for (value, column) in self.line.iter_mut().zip(self.columns.chunks_exact(rows)) {
                *value = column[row];
            }
            self.plans
                .row_back(&mut self.line, values, &mut self.scratch);
        }
    }
}
