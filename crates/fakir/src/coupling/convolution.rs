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
use crate::contact::Run;
use crate::vector::widest;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};
use std::ops::Range;
use std::sync::Arc;

/// Rows transformed back together, so that whole cache lines of the transposed array are read.
const ROW_BLOCK: usize = 8;

/// Columns taken from the transformed rows together, for the same reason.
const COLUMN_BLOCK: usize = 8;

/// Padded arrays of fewer points than this are not worth sharing between threads.
const PARALLEL_POINTS: usize = 40_000;

/// Distances a thread takes at a time, at the least.
const DISTANCES: usize = 200;

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
            ranges: window.rows().to_vec(),
            odd,
            kernel: vec![0.0; pair.entry_count() * half * padded.0],
            rows: vec![Complex64::default(); shape.0 * modes * half],
            spectrum: vec![Complex64::default(); half * modes * shape.0],
            transforms,
        };
        convolution.fill_kernels(pair, run);
        convolution
    }

    /// Pieces of work a thread takes at a time, at the least.
    fn least(&self) -> usize {
        if self.padded.0 * self.padded.1 >= PARALLEL_POINTS {
            1
        } else {
            usize::MAX
        }
    }

    /// Transformed kernels of all pairs of modes. As `B_ij(-D) = (-1)^(l+l') B_ij(D)`, rows on one
    /// side are enough until the columns are transformed.
    fn fill_kernels(&mut self, pair: &PairCoupling, run: &Run<'_>) {
        let (rows, columns) = self.padded;
        let (entries, half) = (pair.entry_count(), self.half);
        let reach = (self.shape.0 as i64 - 1, self.shape.1 as i64 - 1);
        let least = self.least();
        let radial = radial_parts(pair, reach.0.max(reach.1), run);
        // For every row, every pair, the columns.
        let mut transformed = vec![Complex64::default(); self.shape.0 * entries * half];
        let transform = &self.transforms.row;
        let work = || RowWork {
            grids: vec![0.0; entries * columns],
            block: vec![0.0; entries],
            scratch: transform.make_scratch_vec(),
        };
        run.fill(
            &mut transformed,
            entries * half,
            least,
            work,
            |work, row, output| {
                if run.cancel.is_cancelled() {
                    return;
                }
                work.fill_row(pair, &radial, row as i64, reach.1, columns);
                let grids = work.grids.chunks_exact_mut(columns);
                for (grid, output) in grids.zip(output.chunks_exact_mut(half)) {
                    // Lengths are those the plan was made for, so this cannot fail.
                    let _ = transform.process_with_scratch(grid, output, &mut work.scratch);
                }
            },
        );
        let scale = 1.0 / (rows * columns) as f64;
        let (odd, transform) = (&self.odd, &self.transforms.column);
        let work = || {
            let scratch = vec![Complex64::default(); transform.get_inplace_scratch_len()];
            (vec![Complex64::default(); entries * rows], scratch)
        };
        run.fill(
            &mut self.kernel,
            entries * rows,
            least,
            work,
            |(input, scratch), column, kernel| {
                if run.cancel.is_cancelled() {
                    return;
                }
                for (entry, (input, &odd)) in input.chunks_exact_mut(rows).zip(odd).enumerate() {
                    let sign = if odd { -1.0 } else { 1.0 };
                    input.fill(Complex64::default());
                    for (row, values) in transformed.chunks_exact(entries * half).enumerate() {
                        let value = values[entry * half + column];
                        input[row] = value;
                        if row > 0 {
                            input[rows - row] = sign * value.conj();
                        }
                    }
                }
                transform.process_with_scratch(input, scratch);
                let values = input.chunks_exact(rows).zip(odd);
                for (kernel, (values, &odd)) in kernel.chunks_exact_mut(rows).zip(values) {
                    for (k, value) in kernel.iter_mut().zip(values) {
                        *k = scale * if odd { value.im } else { value.re };
                    }
                }
            },
        );
    }

    pub(crate) fn apply(&mut self, coefficients: &[f64], far: &mut [f64], run: &Run<'_>) {
        self.rows_forward(coefficients, run);
        self.columns(run);
        self.rows_back(far, run);
    }

    /// Operations of a product at the least, and the bytes it moves if every array is read or written
    /// once: transforms of length `n` take `5 n log2 n`, of real numbers half of that.
    pub(crate) fn least_work(&self) -> [f64; 2] {
        let [modes, rows, half] = [self.modes, self.shape.0, self.half].map(|n| n as f64);
        let [long, wide] = [self.padded.0, self.padded.1].map(|n| n as f64);
        let rows_there_and_back = 2.0 * rows * modes * 2.5 * wide * wide.log2();
        let columns_there_and_back = 2.0 * half * modes * 5.0 * long * long.log2();
        let multiplied = 4.0 * modes * modes * half * long;
        let operations = rows_there_and_back + columns_there_and_back + multiplied;
        let transformed = 16 * (self.rows.len() + self.spectrum.len());
        let bytes = 8 * self.kernel.len() + 2 * transformed;
        [operations, bytes as f64]
    }

    fn rows_forward(&mut self, coefficients: &[f64], run: &Run<'_>) {
        let (modes, half, least) = (self.modes, self.half, self.least());
        let (transform, places, ranges) = (&self.transforms.row, &self.places, &self.ranges);
        run.fill(
            &mut self.rows,
            modes * half,
            least,
            || (transform.make_input_vec(), transform.make_scratch_vec()),
            |(input, scratch), row, output| {
                if run.cancel.is_cancelled() {
                    return;
                }
                for (mode, output) in output.chunks_exact_mut(half).enumerate() {
                    input.fill(0.0);
                    for pillar in ranges[row].clone() {
                        input[places[pillar].1] = coefficients[pillar * modes + mode];
                    }
                    let _ = transform.process_with_scratch(input, output, scratch);
                }
            },
        );
    }

    fn rows_back(&self, far: &mut [f64], run: &Run<'_>) {
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
        run.fill(&mut blocks, 1, self.least(), work, |work, number, block| {
            if !run.cancel.is_cancelled() {
                self.block_back(number * ROW_BLOCK, block[0], work);
            }
        });
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

    fn columns(&mut self, run: &Run<'_>) {
        let (modes, rows, half) = (self.modes, self.shape.0, self.half);
        let padded = self.padded.0;
        let (least, entries) = (self.least(), self.odd.len());
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
        let kernels = &self.kernel;
        run.fill(
            &mut self.spectrum,
            COLUMN_BLOCK * modes * rows,
            least,
            work,
            |work, block, spectra| {
                if run.cancel.is_cancelled() {
                    return;
                }
                let first = block * COLUMN_BLOCK;
                let count = COLUMN_BLOCK.min(half - first);
                for (place, row) in transformed.chunks_exact(half).enumerate() {
                    let (row_number, mode) = (place / modes, place % modes);
                    for (k, value) in row[first..first + count].iter().enumerate() {
                        spectra[(k * modes + mode) * rows + row_number] = *value;
                    }
                }
                let kernels = kernels[first * entries * padded..].chunks_exact(entries * padded);
                for (spectrum, kernel) in spectra.chunks_exact_mut(modes * rows).zip(kernels) {
                    one(work, spectrum, kernel);
                }
            },
        );
    }
}

struct RowWork {
    /// One row of every pair.
    grids: Vec<f64>,
    block: Vec<f64>,
    scratch: Vec<Complex64>,
}

impl RowWork {
    /// The kernels between pillars that many rows and up to `reach` columns apart.
    fn fill_row(
        &mut self,
        pair: &PairCoupling,
        radial: &[f64],
        row: i64,
        reach: i64,
        columns: usize,
    ) {
        self.grids.fill(0.0);
        let parts = pair.radial_count();
        for column in -reach..=reach {
            if (row, column) == (0, 0) {
                continue;
            }
            let norm = ((row * row + row * column + column * column) as f64).sqrt();
            let direction = [
                0.5 * 3f64.sqrt() * (row + column) as f64 / norm,
                0.5 * (row - column) as f64 / norm,
            ];
            let radial = &radial[distance_number(row, column) * parts..][..parts];
            pair.upper_block(radial, direction, &mut self.block);
            let place = column.rem_euclid(columns as i64) as usize;
            for (grid, value) in self.grids.chunks_exact_mut(columns).zip(&self.block) {
                grid[place] = *value;
            }
        }
    }
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

/// The parts of the coupling that depend on distances alone, for each distance in the lattice between
/// pillars up to `most` rows and columns apart, by [`distance_number`].
fn radial_parts(pair: &PairCoupling, most: i64, run: &Run<'_>) -> Vec<f64> {
    let parts = pair.radial_count();
    let count = distance_number(most + 1, 0);
    let mut radial = vec![0.0; count * parts];
    // Numbers of distances by rows: `(i, j)` for all `0 <= j <= i`.
    let row_of = |number: usize| (((8 * number + 1) as f64).sqrt() as i64 - 1) / 2;
    let one = |(): &mut (), number: usize, radial: &mut [f64]| {
        if number == 0 || run.cancel.is_cancelled() {
            return;
        }
        let i = row_of(number);
        let j = number as i64 - i * (i + 1) / 2;
        let norm = ((i * i + i * j + j * j) as f64).sqrt();
        pair.radial(norm * pair.pitch(), radial);
    };
    run.fill(&mut radial, parts, DISTANCES, || (), one);
    radial
}

/// Pillars `(u, v)` and `(i, j)` rows and columns apart have the same distance if they are images of each
/// other under the rotations and mirrors of the lattice. One of twelve (or six) images has
/// `0 <= j <= i`; they are numbered by these.
fn distance_number(u: i64, v: i64) -> usize {
    let [a, b, c] = [u.abs(), v.abs(), (u + v).abs()];
    // The largest is the sum of the others.
    let largest = a.max(b).max(c);
    let smallest = a.min(b).min(c);
    let i = largest - smallest;
    (i * (i + 1) / 2 + smallest) as usize
}
