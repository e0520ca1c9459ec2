//! The coupling of many pillars of a lattice as a convolution, by fast Fourier transform.
//!
//! The window is padded with zeros to at least twice its size, so that nothing wraps around:
//! the lattice is finite and stands free. One kernel for every pair of modes; as
//! `B_ij(-D) = (-1)^(l+l') B_ij(D)`, its transform is real or imaginary, and as
//! `B_ji(D) = (-1)^(l+l') B_ij(D)`, the upper triangle is enough.
//!
//! A product makes three passes: rows of all modes are transformed (only those of the window
//! hold anything); then, column by column, all modes are transformed, multiplied by the kernels
//! and transformed back while they are in the cache; then the rows of the window back. Each pass is
//! shared between threads, and turns its array over in pieces of whole cache lines as it reads it.

use super::pair::PairCoupling;
use super::window::Window;
use crate::contact::{CancelToken, Run};
use crate::vector::widest;
use rayon::ThreadPool;
use rayon::prelude::*;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};
use std::ops::Range;
use std::sync::Arc;

/// Rows transformed back together, so that whole cache lines of the transposed array are read.
const ROW_BLOCK: usize = 8;

/// Columns taken from the transformed rows together, for the same reason.
const COLUMN_BLOCK: usize = 4;

/// Padded arrays of fewer points than this are not worth sharing between threads.
const PARALLEL_POINTS: usize = 40_000;

pub(crate) struct LatticeConvolution {
    /// Number of modes.
    modes: usize,
    /// Rows and columns of the window.
    shape: (usize, usize),
    /// Rows and columns after padding.
    padded: (usize, usize),
    /// Complex columns kept of a real transform, `padded.1/2 + 1`.
    half: usize,
    places: Vec<(usize, usize)>,
    /// The pillars of every row.
    ranges: Vec<Range<usize>>,
    /// Whether the kernel of an upper-triangle pair of modes is odd.
    odd: Vec<bool>,
    /// Transformed kernels: for every column, every pair of modes, every row; its real part
    /// where even, its imaginary part where odd. With the normalisation of the inverse.
    kernel: Vec<f64>,
    /// Transformed rows: for every row of the window, every mode, the columns.
    rows: Vec<Complex64>,
    /// The same turned over, multiplied: for every column, every mode, the rows of the window.
    spectrum: Vec<Complex64>,
    transforms: Transforms,
}

#[derive(Clone)]
struct Transforms {
    row: Arc<dyn RealToComplex<f64>>,
    row_back: Arc<dyn ComplexToReal<f64>>,
    column: Arc<dyn Fft<f64>>,
    column_back: Arc<dyn Fft<f64>>,
}

/// Smallest even number of the form 2^a 3^b 5^c not below `least`.
pub(crate) fn smooth_size(least: usize) -> usize {
    let smooth = |mut n: usize| {
        for prime in [2, 3, 5] {
            while n.is_multiple_of(prime) {
                n /= prime;
            }
        }
        n == 1
    };
    let mut size = least.max(2);
    while size % 2 == 1 || !smooth(size) {
        size += 1;
    }
    size
}

impl LatticeConvolution {
    /// If it is cancelled the kernels are nothing; solvers look before they ask for a product.
    pub(crate) fn new(window: &Window, pair: &PairCoupling, run: &Run<'_>) -> Self {
        let modes = pair.modes().len();
        let shape = window.shape();
        let padded = (smooth_size(2 * shape.0 - 1), smooth_size(2 * shape.1 - 1));
        let half = padded.1 / 2 + 1;
        let mut real = RealFftPlanner::new();
        let mut complex = FftPlanner::new();
        let transforms = Transforms {
            row: real.plan_fft_forward(padded.1),
            row_back: real.plan_fft_inverse(padded.1),
            column: complex.plan_fft_forward(padded.0),
            column_back: complex.plan_fft_inverse(padded.0),
        };
        let mut odd = Vec::with_capacity(pair.entry_count());
        for (row, receiver) in pair.modes().iter().enumerate() {
            for source in &pair.modes()[row..] {
                odd.push((receiver.degree + source.degree) % 2 == 1);
            }
        }
        let mut convolution = Self {
            modes,
            shape,
            padded,
            half,
            places: window.places().to_vec(),
            ranges: row_ranges(window.places(), shape.0),
            odd,
            kernel: vec![0.0; pair.entry_count() * half * padded.0],
            rows: vec![Complex64::default(); shape.0 * modes * half],
            spectrum: vec![Complex64::default(); half * modes * shape.0],
            transforms,
        };
        convolution.fill_kernels(pair, run);
        convolution
    }

    fn shared<'p>(&self, pool: Option<&'p ThreadPool>) -> Option<&'p ThreadPool> {
        pool.filter(|pool| {
            pool.current_num_threads() > 1 && self.padded.0 * self.padded.1 >= PARALLEL_POINTS
        })
    }

    /// Kernels of all pairs of modes, transformed one after the other.
    fn fill_kernels(&mut self, pair: &PairCoupling, run: &Run<'_>) {
        let (rows, columns) = self.padded;
        let entries = pair.entry_count();
        let mut grids = vec![0.0; entries * rows * columns];
        fill_grids(pair, self.shape, self.padded, &mut grids, &run.cancel);
        let scale = 1.0 / (rows * columns) as f64;
        let (half, transforms, odd) = (self.half, &self.transforms, &self.odd);
        let transformed = |(entry, grid): (usize, &mut [f64])| -> Vec<f64> {
            if run.cancel.is_cancelled() {
                return Vec::new();
            }
            transform_kernel(transforms, grid, rows, columns, odd[entry], scale)
        };
        let transformed: Vec<Vec<f64>> = match self.shared(run.pool) {
            Some(pool) => pool.install(|| {
                grids
                    .par_chunks_mut(rows * columns)
                    .enumerate()
                    .map(transformed)
                    .collect()
            }),
            None => grids
                .chunks_mut(rows * columns)
                .enumerate()
                .map(transformed)
                .collect(),
        };
        if run.cancel.is_cancelled() {
            return;
        }
        for column in 0..half {
            for (entry, values) in transformed.iter().enumerate() {
                let start = (column * entries + entry) * rows;
                self.kernel[start..start + rows]
                    .copy_from_slice(&values[column * rows..(column + 1) * rows]);
            }
        }
    }

    pub(crate) fn apply(&mut self, coefficients: &[f64], far: &mut [f64], run: &Run<'_>) {
        let pool = self.shared(run.pool);
        self.rows_forward(coefficients, pool, &run.cancel);
        self.columns(pool, &run.cancel);
        self.rows_back(far, pool, &run.cancel);
    }

    fn rows_forward(
        &mut self,
        coefficients: &[f64],
        pool: Option<&ThreadPool>,
        cancel: &CancelToken,
    ) {
        let (modes, half) = (self.modes, self.half);
        let (transform, places) = (&self.transforms.row, &self.places);
        let work = || (transform.make_input_vec(), transform.make_scratch_vec());
        type Work = (Vec<f64>, Vec<Complex64>);
        let one = |(input, scratch): &mut Work, (row, range): (&mut [Complex64], &Range<usize>)| {
            if cancel.is_cancelled() {
                return;
            }
            for (mode, output) in row.chunks_exact_mut(half).enumerate() {
                input.fill(0.0);
                for pillar in range.clone() {
                    input[places[pillar].1] = coefficients[pillar * modes + mode];
                }
                // Lengths are those the plan was made for, so this cannot fail.
                let _ = transform.process_with_scratch(input, output, scratch);
            }
        };
        match pool {
            Some(pool) => pool.install(|| {
                self.rows
                    .par_chunks_mut(modes * half)
                    .zip(&self.ranges)
                    .for_each_init(work, one);
            }),
            None => {
                let mut work = work();
                self.rows
                    .chunks_mut(modes * half)
                    .zip(&self.ranges)
                    .for_each(|row| one(&mut work, row));
            }
        }
    }

    fn rows_back(&self, far: &mut [f64], pool: Option<&ThreadPool>, cancel: &CancelToken) {
        let transform = &self.transforms.row_back;
        let work = || BackWork {
            input: vec![Complex64::default(); self.half * ROW_BLOCK],
            output: transform.make_output_vec(),
            scratch: transform.make_scratch_vec(),
        };
        let mut blocks = Vec::with_capacity(self.ranges.len().div_ceil(ROW_BLOCK));
        let mut rest = far;
        for ranges in self.ranges.chunks(ROW_BLOCK) {
            let pillars: usize = ranges.iter().map(ExactSizeIterator::len).sum();
            let (block, after) = rest.split_at_mut(pillars * self.modes);
            blocks.push(block);
            rest = after;
        }
        let one = |work: &mut BackWork, (block, far): (usize, &mut [f64])| {
            if !cancel.is_cancelled() {
                self.block_back(block * ROW_BLOCK, far, work);
            }
        };
        match pool {
            Some(pool) => pool.install(|| {
                blocks.into_par_iter().enumerate().for_each_init(work, one);
            }),
            None => {
                let mut work = work();
                let blocks = blocks.into_iter().enumerate();
                blocks.for_each(|block| one(&mut work, block));
            }
        }
    }

    /// Transforms some rows back; `far` are the loads on the pillars in them.
    fn block_back(&self, first: usize, far: &mut [f64], work: &mut BackWork) {
        let (modes, rows, half) = (self.modes, self.shape.0, self.half);
        let BackWork {
            input,
            output,
            scratch,
        } = work;
        let ranges = &self.ranges[first..rows.min(first + ROW_BLOCK)];
        let start = ranges[0].start;
        for mode in 0..modes {
            for column in 0..half {
                let place = (column * modes + mode) * rows + first;
                let values = &self.spectrum[place..place + ranges.len()];
                for (k, value) in values.iter().enumerate() {
                    input[k * half + column] = *value;
                }
            }
            for (range, row) in ranges.iter().zip(input.chunks_exact_mut(half)) {
                // The transform of real data has real ends; rounding must not say otherwise.
                row[0].im = 0.0;
                row[half - 1].im = 0.0;
                let _ = self
                    .transforms
                    .row_back
                    .process_with_scratch(row, output, scratch);
                for pillar in range.clone() {
                    far[(pillar - start) * modes + mode] = output[self.places[pillar].1];
                }
            }
        }
    }

    fn columns(&mut self, pool: Option<&ThreadPool>, cancel: &CancelToken) {
        let (modes, rows, half) = (self.modes, self.shape.0, self.half);
        let padded = self.padded.0;
        let entries = self.odd.len();
        let (transforms, odd, transformed) = (&self.transforms, &self.odd, &self.rows);
        let scratch_len = transforms
            .column
            .get_inplace_scratch_len()
            .max(transforms.column_back.get_inplace_scratch_len());
        let work = || ColumnWork {
            input: vec![Complex64::default(); modes * padded],
            output: vec![Complex64::default(); modes * padded],
            scratch: vec![Complex64::default(); scratch_len],
        };
        let one = |work: &mut ColumnWork, spectrum: &mut [Complex64], kernel: &[f64]| {
            for (values, column) in spectrum
                .chunks_exact(rows)
                .zip(work.input.chunks_exact_mut(padded))
            {
                column[..rows].copy_from_slice(values);
                column[rows..].fill(Complex64::default());
            }
            transforms
                .column
                .process_with_scratch(&mut work.input, &mut work.scratch);
            multiply(kernel, odd, modes, padded, &work.input, &mut work.output);
            transforms
                .column_back
                .process_with_scratch(&mut work.output, &mut work.scratch);
            for (values, column) in spectrum
                .chunks_exact_mut(rows)
                .zip(work.output.chunks_exact(padded))
            {
                values.copy_from_slice(&column[..rows]);
            }
        };
        let some =
            |work: &mut ColumnWork,
             (block, (spectrum, kernel)): (usize, (&mut [Complex64], &[f64]))| {
                if cancel.is_cancelled() {
                    return;
                }
                let first = block * COLUMN_BLOCK;
                let count = COLUMN_BLOCK.min(half - first);
                for (place, row) in transformed.chunks_exact(half).enumerate() {
                    let (row_number, mode) = (place / modes, place % modes);
                    for (k, value) in row[first..first + count].iter().enumerate() {
                        spectrum[(k * modes + mode) * rows + row_number] = *value;
                    }
                }
                for (spectrum, kernel) in spectrum
                    .chunks_exact_mut(modes * rows)
                    .zip(kernel.chunks_exact(entries * padded))
                {
                    one(work, spectrum, kernel);
                }
            };
        let (spectra, kernels) = (COLUMN_BLOCK * modes * rows, COLUMN_BLOCK * entries * padded);
        let kernel = &self.kernel;
        match pool {
            Some(pool) => pool.install(|| {
                self.spectrum
                    .par_chunks_mut(spectra)
                    .zip(kernel.par_chunks(kernels))
                    .enumerate()
                    .for_each_init(work, some);
            }),
            None => {
                let mut work = work();
                self.spectrum
                    .chunks_mut(spectra)
                    .zip(kernel.chunks(kernels))
                    .enumerate()
                    .for_each(|block| some(&mut work, block));
            }
        }
    }
}

/// The pillars of every row of the window.
fn row_ranges(places: &[(usize, usize)], rows: usize) -> Vec<Range<usize>> {
    let mut start = 0;
    (0..rows)
        .map(|row| {
            let end = start + places[start..].partition_point(|place| place.0 == row);
            let range = start..end;
            start = end;
            range
        })
        .collect()
}

struct BackWork {
    input: Vec<Complex64>,
    output: Vec<f64>,
    scratch: Vec<Complex64>,
}

struct ColumnWork {
    input: Vec<Complex64>,
    output: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

/// `output = K input` for one column of all modes.
fn multiply(
    kernel: &[f64],
    odd: &[bool],
    modes: usize,
    padded: usize,
    input: &[Complex64],
    output: &mut [Complex64],
) {
    widest(
        #[inline(always)]
        || {
            let mut pairs = kernel.chunks_exact(padded).zip(odd);
            for a in 0..modes {
                for b in a..modes {
                    let Some((kernel, &odd)) = pairs.next() else {
                        return;
                    };
                    // The first row of pairs meets every mode once, before anything else does.
                    let first = a == 0;
                    let (of_a, of_b) = (a * padded..(a + 1) * padded, b * padded..(b + 1) * padded);
                    let signs = if odd { Some([1.0, -1.0]) } else { None };
                    add(
                        kernel,
                        signs.map(|signs| signs[0]),
                        first && b == 0,
                        &input[of_b.clone()],
                        &mut output[of_a.clone()],
                    );
                    if a != b {
                        let sign = signs.map(|signs| signs[1]);
                        add(kernel, sign, first, &input[of_a], &mut output[of_b]);
                    }
                }
            }
        },
    );
}

/// Adds the product with a kernel that is real, or imaginary with a sign; if it is the first, in
/// place of what was there.
#[inline(always)]
fn add(
    kernel: &[f64],
    imaginary: Option<f64>,
    first: bool,
    source: &[Complex64],
    target: &mut [Complex64],
) {
    let places = target.iter_mut().zip(source).zip(kernel);
    match (imaginary, first) {
        (None, true) => {
            for ((target, source), k) in places {
                *target = Complex64::new(k * source.re, k * source.im);
            }
        }
        (None, false) => {
            for ((target, source), k) in places {
                target.re += k * source.re;
                target.im += k * source.im;
            }
        }
        (Some(sign), true) => {
            for ((target, source), k) in places {
                *target = Complex64::new(-sign * k * source.im, sign * k * source.re);
            }
        }
        (Some(sign), false) => {
            for ((target, source), k) in places {
                let k = sign * k;
                target.re -= k * source.im;
                target.im += k * source.re;
            }
        }
    }
}

/// Kernels on the padded array, one grid for every entry: each distinct distance is computed
/// once and used for its twelve (or six) places.
fn fill_grids(
    pair: &PairCoupling,
    shape: (usize, usize),
    padded: (usize, usize),
    grids: &mut [f64],
    cancel: &CancelToken,
) {
    let entries = pair.entry_count();
    let (rows, columns) = padded;
    let reach = (shape.0 as i64 - 1, shape.1 as i64 - 1);
    let most = reach.0.max(reach.1);
    let mut radial = vec![0.0; pair.radial_count()];
    let mut block = vec![0.0; entries];
    for i in 1..=most {
        if cancel.is_cancelled() {
            return;
        }
        for j in 0..=i {
            let norm = ((i * i + i * j + j * j) as f64).sqrt();
            pair.radial(norm * pair.pitch(), &mut radial);
            for (u, v) in images(i, j) {
                if u.abs() > reach.0 || v.abs() > reach.1 {
                    continue;
                }
                let direction = [
                    0.5 * 3f64.sqrt() * (u + v) as f64 / norm,
                    0.5 * (u - v) as f64 / norm,
                ];
                pair.upper_block(&radial, direction, &mut block);
                let row = u.rem_euclid(rows as i64) as usize;
                let column = v.rem_euclid(columns as i64) as usize;
                for (entry, value) in block.iter().enumerate() {
                    grids[(entry * rows + row) * columns + column] = *value;
                }
            }
        }
    }
}

/// The images of a lattice vector under the rotations and mirrors of the lattice. Some
/// coincide on mirror lines.
fn images(i: i64, j: i64) -> [(i64, i64); 12] {
    let mut images = [(0, 0); 12];
    let (mut u, mut v) = (i, j);
    for k in 0..6 {
        images[2 * k] = (u, v);
        images[2 * k + 1] = (v, u);
        (u, v) = (-v, u + v);
    }
    images
}

/// Two-dimensional transform of one kernel: for every column kept, its rows.
fn transform_kernel(
    transforms: &Transforms,
    grid: &mut [f64],
    rows: usize,
    columns: usize,
    odd: bool,
    scale: f64,
) -> Vec<f64> {
    let half = columns / 2 + 1;
    let mut spectrum = vec![Complex64::default(); half * rows];
    let mut output = transforms.row.make_output_vec();
    let mut scratch = transforms.row.make_scratch_vec();
    for (row, input) in grid.chunks_exact_mut(columns).enumerate() {
        let _ = transforms
            .row
            .process_with_scratch(input, &mut output, &mut scratch);
        for (column, value) in output.iter().enumerate() {
            spectrum[column * rows + row] = *value;
        }
    }
    transforms.column.process(&mut spectrum);
    spectrum
        .iter()
        .map(|value| scale * if odd { value.im } else { value.re })
        .collect()
}
