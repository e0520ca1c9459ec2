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
//! shared between threads. Between them the transformed rows lie in tiles of a few rows and columns, so
//! that rows and columns both are whole cache lines, and few pages.

use super::pair::PairCoupling;
use super::window::Window;
use crate::numerics::fft::{RealPlans, smooth_size};
use crate::numerics::vector::widest;
use crate::numerics::workers::Workers;
use rustfft::num_complex::Complex64;
use std::ops::Range;

/// Rows and columns of a tile: a row of it is a cache line.
const TILE: (usize, usize) = (8, 4);

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
    /// Transformed rows, and what becomes of them. In tiles: for every [`TILE`]`.1` columns, every
    /// [`TILE`]`.0` rows of the window, every mode, these rows of these columns.
    tiles: Vec<Complex64>,
    transforms: RealPlans,
}

impl LatticeConvolution {
    /// If it is cancelled the kernels are nothing; solvers look before they ask for a product.
    pub(crate) fn new(window: &Window, pair: &PairCoupling, workers: Workers<'_>) -> Self {
        let modes = pair.modes().len();
        let shape = window.shape();
        let padded = (smooth_size(2 * shape.0 - 1), smooth_size(2 * shape.1 - 1));
        let half = padded.1 / 2 + 1;
        let transforms = RealPlans::new(padded.0, padded.1);
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
            tiles: Vec::new(),
            transforms,
        };
        let (_, strip) = convolution.lengths();
        convolution.tiles = vec![Complex64::default(); half.div_ceil(TILE.1) * strip];
        convolution.fill_kernels(pair, workers);
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
    fn fill_kernels(&mut self, pair: &PairCoupling, workers: Workers<'_>) {
        let (rows, columns) = self.padded;
        let (entries, half) = (pair.entry_count(), self.half);
        let reach = (self.shape.0 as i64 - 1, self.shape.1 as i64 - 1);
        let least = self.least();
        let radial = radial_parts(pair, reach.0.max(reach.1), workers);
        // The columns of every pair, row after row of the lattice.
        let mut transformed = vec![Complex64::default(); self.shape.0 * entries * half];
        let transform = &self.transforms.row;
        let work = || RowWork {
            grids: vec![0.0; entries * columns],
            block: vec![0.0; entries],
            scratch: transform.make_scratch_vec(),
        };
        workers.fill(
            &mut transformed,
            entries * half,
            least,
            work,
            |work, row, output| {
                if workers.cancel.is_cancelled() {
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
        workers.fill(
            &mut self.kernel,
            entries * rows,
            least,
            work,
            |(input, scratch), column, kernel| {
                if workers.cancel.is_cancelled() {
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

    pub(crate) fn apply(&mut self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        self.rows_forward(coefficients, workers);
        self.columns(workers);
        self.rows_back(far, workers);
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
        // Tiles are written, read and written again, and read.
        let bytes = 8 * self.kernel.len() + 4 * 16 * self.tiles.len();
        [operations, bytes as f64]
    }

    /// The transforms of a product and nothing else, of numbers that stay in the cache.
    pub(crate) fn transforms_alone(&self) {
        let RealPlans {
            row,
            row_back,
            column,
            column_back,
        } = &self.transforms;
        let (mut real, mut complex) = (row.make_input_vec(), row.make_output_vec());
        for _ in 0..self.shape.0 * self.modes {
            let _ = row.process(&mut real, &mut complex);
            let _ = row_back.process(&mut complex, &mut real);
        }
        let mut columns = vec![Complex64::default(); self.modes * self.padded.0];
        for _ in 0..self.half {
            column.process(&mut columns);
            column_back.process(&mut columns);
        }
    }

    /// Length of a tile, and of all tiles of a few columns.
    fn lengths(&self) -> (usize, usize) {
        let tile = self.modes * TILE.0 * TILE.1;
        (tile, tile * self.shape.0.div_ceil(TILE.0))
    }

    fn rows_forward(&mut self, coefficients: &[f64], workers: Workers<'_>) {
        let (modes, half, least) = (self.modes, self.half, self.least());
        let (tile, strip) = self.lengths();
        let (transform, places, ranges) = (&self.transforms.row, &self.places, &self.ranges);
        // The tiles of every few rows.
        let mut blocks: Vec<Vec<&mut [Complex64]>> = ranges
            .chunks(TILE.0)
            .map(|_| Vec::with_capacity(half.div_ceil(TILE.1)))
            .collect();
        for strip in self.tiles.chunks_exact_mut(strip) {
            for (block, tile) in blocks.iter_mut().zip(strip.chunks_exact_mut(tile)) {
                block.push(tile);
            }
        }
        let work = || {
            let input = transform.make_input_vec();
            let output = transform.make_output_vec();
            (input, output, transform.make_scratch_vec())
        };
        workers.fill(
            &mut blocks,
            1,
            least,
            work,
            |(input, output, scratch), number, block| {
                if workers.cancel.is_cancelled() {
                    return;
                }
                let ranges = ranges.iter().skip(number * TILE.0).take(TILE.0);
                for (row, range) in ranges.enumerate() {
                    for mode in 0..modes {
                        input.fill(0.0);
                        for pillar in range.clone() {
                            input[places[pillar].1] = coefficients[pillar * modes + mode];
                        }
                        let _ = transform.process_with_scratch(input, output, scratch);
                        let line = (mode * TILE.0 + row) * TILE.1;
                        for (tile, values) in block[0].iter_mut().zip(output.chunks(TILE.1)) {
                            tile[line..line + values.len()].copy_from_slice(values);
                        }
                    }
                }
            },
        );
    }

    fn rows_back(&self, far: &mut [f64], workers: Workers<'_>) {
        let transform = &self.transforms.row_back;
        let work = || BackWork {
            input: transform.make_input_vec(),
            output: transform.make_output_vec(),
            scratch: transform.make_scratch_vec(),
        };
        let mut blocks = Vec::with_capacity(self.ranges.len().div_ceil(TILE.0));
        let mut rest = far;
        for ranges in self.ranges.chunks(TILE.0) {
            let pillars: usize = ranges.iter().map(ExactSizeIterator::len).sum();
            let (block, after) = rest.split_at_mut(pillars * self.modes);
            blocks.push(block);
            rest = after;
        }
        workers.fill(&mut blocks, 1, self.least(), work, |work, number, block| {
            if !workers.cancel.is_cancelled() {
                self.block_back(number, block[0], work);
            }
        });
    }

    /// Transforms the rows of a block back; `far` are the loads on the pillars in them.
    fn block_back(&self, number: usize, far: &mut [f64], work: &mut BackWork) {
        let (modes, half) = (self.modes, self.half);
        let (tile, strip) = self.lengths();
        let BackWork {
            input,
            output,
            scratch,
        } = work;
        let first = number * TILE.0;
        let ranges = &self.ranges[first..self.shape.0.min(first + TILE.0)];
        let start = ranges[0].start;
        for (row, range) in ranges.iter().enumerate() {
            for mode in 0..modes {
                let line = number * tile + (mode * TILE.0 + row) * TILE.1;
                let strips = self.tiles.chunks_exact(strip);
                for (values, strip) in input.chunks_mut(TILE.1).zip(strips) {
                    values.copy_from_slice(&strip[line..line + values.len()]);
                }
                // The transform of real data has real ends; rounding must not say otherwise.
                input[0].im = 0.0;
                input[half - 1].im = 0.0;
                let _ = self
                    .transforms
                    .row_back
                    .process_with_scratch(input, output, scratch);
                for pillar in range.clone() {
                    far[(pillar - start) * modes + mode] = output[self.places[pillar].1];
                }
            }
        }
    }

    fn columns(&mut self, workers: Workers<'_>) {
        let (modes, rows) = (self.modes, self.shape.0);
        let (tile, strip) = self.lengths();
        let padded = self.padded.0;
        let (least, entries) = (self.least(), self.odd.len());
        let (transforms, odd, kernels) = (&self.transforms, &self.odd, &self.kernel);
        let scratch_len = transforms
            .column
            .get_inplace_scratch_len()
            .max(transforms.column_back.get_inplace_scratch_len());
        let work = || ColumnWork {
            columns: vec![Complex64::default(); TILE.1 * modes * padded],
            product: vec![Complex64::default(); modes * padded],
            scratch: vec![Complex64::default(); scratch_len],
        };
        let one = |work: &mut ColumnWork, number: usize, strip: &mut [Complex64]| {
            if workers.cancel.is_cancelled() {
                return;
            }
            let ColumnWork {
                columns,
                product,
                scratch,
            } = work;
            let first = number * TILE.1;
            let lines = |tile: usize| {
                (0..modes).flat_map(move |mode| {
                    (0..TILE.0.min(rows - tile * TILE.0)).map(move |row| {
                        let line = (mode * TILE.0 + row) * TILE.1;
                        (line, mode * padded + tile * TILE.0 + row)
                    })
                })
            };
            for (number, tile) in strip.chunks_exact(tile).enumerate() {
                for (line, place) in lines(number) {
                    for (k, value) in tile[line..line + TILE.1].iter().enumerate() {
                        columns[k * modes * padded + place] = *value;
                    }
                }
            }
            let kernels = kernels[first * entries * padded..].chunks_exact(entries * padded);
            for (column, kernel) in columns.chunks_exact_mut(modes * padded).zip(kernels) {
                for values in column.chunks_exact_mut(padded) {
                    values[rows..].fill(Complex64::default());
                }
                transforms.column.process_with_scratch(column, scratch);
                multiply(kernel, odd, modes, padded, column, product);
                transforms
                    .column_back
                    .process_with_scratch(product, scratch);
                let products = product.chunks_exact(padded);
                for (values, product) in column.chunks_exact_mut(padded).zip(products) {
                    values[..rows].copy_from_slice(&product[..rows]);
                }
            }
            for (number, tile) in strip.chunks_exact_mut(tile).enumerate() {
                for (line, place) in lines(number) {
                    for (k, value) in tile[line..line + TILE.1].iter_mut().enumerate() {
                        *value = columns[k * modes * padded + place];
                    }
                }
            }
        };
        workers.fill(&mut self.tiles, strip, least, work, one);
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
                // What layers do to a pillar by itself has no direction.
                if let Some(own) = pair.own_block() {
                    let modes = pair.modes().len();
                    let upper = (0..modes).flat_map(|row| &own[row * modes + row..][..modes - row]);
                    for (grid, value) in self.grids.chunks_exact_mut(columns).zip(upper) {
                        grid[0] = *value;
                    }
                }
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
    /// A few columns of all modes, one after the other.
    columns: Vec<Complex64>,
    product: Vec<Complex64>,
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
fn radial_parts(pair: &PairCoupling, most: i64, workers: Workers<'_>) -> Vec<f64> {
    let parts = pair.radial_count();
    let count = distance_number(most + 1, 0);
    let mut radial = vec![0.0; count * parts];
    // Numbers of distances by rows: `(i, j)` for all `0 <= j <= i`.
    let row_of = |number: usize| (((8 * number + 1) as f64).sqrt() as i64 - 1) / 2;
    let one = |(): &mut (), number: usize, radial: &mut [f64]| {
        if number == 0 || workers.cancel.is_cancelled() {
            return;
        }
        let i = row_of(number);
        let j = number as i64 - i * (i + 1) / 2;
        let norm = ((i * i + i * j + j * j) as f64).sqrt();
        pair.radial(norm * pair.pitch(), radial);
    };
    workers.fill(&mut radial, parts, DISTANCES, || (), one);
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
