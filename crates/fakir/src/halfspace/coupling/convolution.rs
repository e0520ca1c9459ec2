//! The coupling of many pillars of a lattice as a convolution, by fast Fourier transform.
//!
//! The window is padded with zeros so far that no two pairs of pillars fall on each other as it wraps around
//! ([`Differences`]): the lattice is finite and stands free. One kernel for every pair of modes; as
//! `B_ij(-D) = (-1)^(l+l') B_ij(D)`, its transform is real or imaginary, and as
//! `B_ji(D) = (-1)^(l+l') B_ij(D)`, the upper triangle is enough.
//!
//! A product makes three passes: rows of all modes are transformed (only those of the window
//! hold anything); then, column by column, all modes are transformed, multiplied by the kernels
//! and transformed back while they are in the cache; then the rows of the window back. Each pass is
//! shared between threads. Between them the transformed rows lie in tiles of a few rows and columns, so
//! that rows and columns both are whole cache lines, and few pages.
//!
//! Products are exact or rough: in double precision, or in single, which takes about half the time. A kernel is kept as the sum of two numbers in
//! single precision, of which rough products read the first alone.

use super::differences::{Differences, square};
use super::pair::PairCoupling;
use super::window::Window;
use crate::halfspace::disc::basis::Mode;
use crate::numerics::convergence::larger;
use crate::numerics::fft::{ComplexPlans, Real};
use crate::numerics::row_pair::RowPair;
use crate::numerics::vector::widest;
use crate::numerics::workers::Workers;
use num_complex::{Complex, Complex64};
use std::ops::{Range, RangeInclusive};

/// Bytes of a row of a tile: a cache line.
const CACHE_LINE: usize = 64;

/// Rows of a tile, and those that meet at a time, of which the last ones are joined by some before them.
const CHUNK: usize = 8;

/// Padded arrays of fewer points than this are not worth sharing between threads.
const PARALLEL_POINTS: usize = 40_000;

/// Bytes of transformed rows that are kept while kernels are made, about.
pub(super) const TRANSFORMED: usize = 128 << 20;

/// Distances a thread takes at a time, at the least.
const DISTANCES: usize = 200;

/// Products of all pillars of a window.
pub(crate) struct LatticeConvolution {
    layout: Layout,
    /// Transformed kernels: for every column, the high parts of every [`CHUNK`] rows, every pair of modes, each of these rows, then the low parts of the
    /// same. With modes of odd degree times the imaginary unit all are real. With the normalisation of the inverse.
    kernel: Vec<f32>,
    /// Room for the transformed rows of products, exact ones or rough.
    tiles: Vec<Complex64>,
    exact: Passes<f64>,
    rough: Passes<f32>,
}

/// Where everything lies.
struct Layout {
    /// Number of modes.
    modes: usize,
    /// Rows and columns of the window.
    shape: (usize, usize),
    /// Rows and columns after padding.
    padded: (usize, usize),
    /// Complex columns kept of a real transform, `padded.1/2 + 1`.
    half: usize,
    /// The pillars of every row, which stand in columns that follow each other, and the column of the first.
    ranges: Vec<Range<usize>>,
    first_columns: Vec<usize>,
    /// Whether a mode is of odd degree.
    odd: Vec<bool>,
    /// Of every mode with every other the number of the pair.
    pairs: Vec<usize>,
    /// Pairs of modes, each once.
    entries: usize,
}

impl Layout {
    /// Pieces of work a thread takes at a time, at the least.
    fn least(&self) -> usize {
        if self.padded.0 * self.padded.1 >= PARALLEL_POINTS {
            1
        } else {
            usize::MAX
        }
    }

    /// The column of the first pillar of a row, and its pillars: none beyond the last row.
    fn row(&self, row: usize) -> (usize, Range<usize>) {
        let pillars = self.ranges.get(row).cloned().unwrap_or_default();
        (self.first_columns.get(row).copied().unwrap_or(0), pillars)
    }

    /// Numbers of all kernels in a column: high parts, and as many low ones.
    fn kernel_column(&self) -> usize {
        2 * self.entries * CHUNK * self.padded.0.div_ceil(CHUNK)
    }
}

/// Numbers of the pairs of so many modes, of all with all: pairs are in the order of the first, then of the second, each once.
fn pairs(modes: usize) -> Vec<usize> {
    let of = |a: usize, b: usize| {
        let [a, b] = [a.min(b), a.max(b)];
        a * (2 * modes - a - 1) / 2 + b
    };
    (0..modes)
        .flat_map(|b| (0..modes).map(move |a| of(a, b)))
        .collect()
}

impl LatticeConvolution {
    /// If it is cancelled the kernels are nothing; solvers look before they ask for a product.
    pub(crate) fn new(window: &Window, pair: &PairCoupling, workers: Workers<'_>) -> Self {
        let shape = window.shape();
        let first_column =
            |row: &Range<usize>| window.places().get(row.start).map_or(0, |place| place.1);
        let differences = Differences::new(window);
        let padded = differences.small_array(shape.0.next_multiple_of(CHUNK));
        let layout = Layout {
            modes: pair.modes().len(),
            shape,
            padded,
            half: padded.1 / 2 + 1,
            ranges: window.rows().to_vec(),
            first_columns: window.rows().iter().map(first_column).collect(),
            odd: pair.modes().iter().map(Mode::is_odd).collect(),
            pairs: pairs(pair.modes().len()),
            entries: pair.entry_count(),
        };
        let exact = Passes::<f64>::new(&layout);
        Self {
            kernel: kernels(&layout, &differences, pair, &exact.transforms, workers),
            tiles: vec![Complex64::default(); Passes::<f64>::room(&layout)],
            rough: Passes::new(&layout),
            exact,
            layout,
        }
    }

    /// `far = B c`
    pub(crate) fn apply(&mut self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        let parts = (&self.layout, &self.kernel[..], &mut self.tiles[..]);
        self.exact.apply(parts, coefficients, far, 1.0, workers);
    }

    /// The same in single precision.
    pub(crate) fn apply_roughly(
        &mut self,
        coefficients: &[f64],
        far: &mut [f64],
        workers: Workers<'_>,
    ) {
        // Single precision knows no small numbers: the largest is made one.
        let largest = coefficients
            .iter()
            .fold(0.0, |most, c| larger(most, c.abs()));
        let unit = if largest.is_normal() { largest } else { 1.0 };
        let tiles = bytemuck::cast_slice_mut(&mut self.tiles);
        let tiles = &mut tiles[..Passes::<f32>::room(&self.layout)];
        let parts = (&self.layout, &self.kernel[..], tiles);
        self.rough.apply(parts, coefficients, far, unit, workers);
    }

    /// Operations of a product at the least, and the bytes it moves if every array is read or written
    /// once: transforms of length `n` take `5 n log2 n`, of real numbers half of that. Of an exact product, or of a rough one.
    pub(crate) fn least_work(&self, rough: bool) -> [f64; 2] {
        let layout = &self.layout;
        let [modes, rows, half] = [layout.modes, layout.shape.0, layout.half].map(|n| n as f64);
        let [long, wide] = [layout.padded.0, layout.padded.1].map(|n| n as f64);
        let rows_there_and_back = 2.0 * rows * modes * 2.5 * wide * wide.log2();
        let columns_there_and_back = 2.0 * half * modes * 5.0 * long * long.log2();
        let multiplied = 4.0 * modes * modes * half * long;
        let operations = rows_there_and_back + columns_there_and_back + multiplied;
        // Tiles are written, read and written again, and read.
        let bytes = if rough {
            2 * self.kernel.len() + 4 * 8 * Passes::<f32>::room(layout)
        } else {
            4 * self.kernel.len() + 4 * 16 * Passes::<f64>::room(layout)
        };
        [operations, bytes as f64]
    }

    /// The transforms of a product and nothing else, of numbers that stay in the cache.
    pub(crate) fn transforms_alone(&self, rough: bool) {
        if rough {
            self.rough.transforms_alone(&self.layout);
        } else {
            self.exact.transforms_alone(&self.layout);
        }
    }
}

/// Transformed kernels of all pairs of modes. As `B_ij(-D) = (-1)^(l+l') B_ij(D)`, rows on one
/// side are enough until the columns are transformed.
fn kernels(
    layout: &Layout,
    differences: &Differences,
    pair: &PairCoupling,
    transforms: &ComplexPlans,
    workers: Workers<'_>,
) -> Vec<f32> {
    let (_, columns) = layout.padded;
    let (entries, half) = (layout.entries, layout.half);
    let least = layout.least();
    let radial = radial_parts(pair, differences.square_of_largest(), workers);
    let mut kernel = vec![0.0; half * layout.kernel_column()];
    // Rows of the lattice and the columns that are kept of them take as much room as the kernels: of large lattices a part of the columns at a time.
    let of_column = size_of::<Complex64>() * layout.shape.0 * entries;
    let at_a_time = (TRANSFORMED / of_column).clamp(1, half);
    let mut transformed = vec![Complex64::default(); layout.shape.0 * entries * at_a_time];
    for (number, kernel) in kernel
        .chunks_mut(at_a_time * layout.kernel_column())
        .enumerate()
    {
        let first = number * at_a_time;
        let kept = first..(first + at_a_time).min(half);
        let transformed = &mut transformed[..layout.shape.0 * entries * kept.len()];
        let work = || RowWork {
            pairs: (0..entries.div_ceil(2))
                .map(|_| RowPair::new(columns))
                .collect(),
            block: vec![0.0; entries],
            spare: vec![Complex64::default(); half],
            scratch: vec![Complex64::default(); transforms.scratch_len()],
        };
        let of_row = |work: &mut RowWork, row: usize, output: &mut [Complex64]| {
            if workers.cancel.is_cancelled() {
                return;
            }
            work.fill_row(pair, &radial, (row, differences.columns(row)), columns);
            let RowWork {
                pairs,
                spare,
                scratch,
                ..
            } = work;
            for (rows, output) in pairs.iter_mut().zip(output.chunks_mut(2 * kept.len())) {
                rows.forward(transforms.row.as_ref(), scratch);
                let (one, other) = output.split_at_mut(kept.len());
                let other = if other.is_empty() {
                    &mut spare[..kept.len()]
                } else {
                    other
                };
                rows.twice_spectra(kept.start, [one, other]);
            }
        };
        workers.fill(transformed, entries * kept.len(), least, work, of_row);
        fill_columns(layout, transformed, transforms, kernel, workers);
    }
    kernel
}

/// The kernels of some columns from the rows of these.
fn fill_columns(
    layout: &Layout,
    transformed: &[Complex64],
    transforms: &ComplexPlans,
    kernel: &mut [f32],
    workers: Workers<'_>,
) {
    let (rows, columns) = layout.padded;
    let entries = layout.entries;
    let of_rows = transformed.len() / layout.shape.0;
    let at_a_time = of_rows / entries;
    // Rows are twice their transforms.
    let scale = 0.5 / (rows * columns) as f64;
    let transform = &transforms.column;
    let modes = |a: usize| (a..layout.modes).map(move |b| [layout.odd[a], layout.odd[b]]);
    let odd: Vec<[bool; 2]> = (0..layout.modes).flat_map(modes).collect();
    let work = || {
        let scratch = vec![Complex64::default(); transform.get_inplace_scratch_len()];
        (vec![Complex64::default(); entries * rows], scratch)
    };
    workers.fill(
        kernel,
        layout.kernel_column(),
        layout.least(),
        work,
        |(input, scratch), column, kernel| {
            if workers.cancel.is_cancelled() {
                return;
            }
            for (entry, (input, [a, b])) in input.chunks_exact_mut(rows).zip(&odd).enumerate() {
                let sign = if a == b { 1.0 } else { -1.0 };
                input.fill(Complex64::default());
                for (row, values) in transformed.chunks_exact(of_rows).enumerate() {
                    let value = values[entry * at_a_time + column];
                    input[row] += value;
                    if row > 0 {
                        input[rows - row] += sign * value.conj();
                    }
                }
            }
            transform.process_with_scratch(input, scratch);
            let (high, low) = kernel.split_at_mut(kernel.len() / 2);
            let chunks = high
                .chunks_exact_mut(CHUNK)
                .zip(low.chunks_exact_mut(CHUNK));
            for (number, (high, low)) in chunks.enumerate() {
                let (chunk, entry) = (number / entries, number % entries);
                let values = &input[entry * rows + first_of_chunk(chunk, rows)..][..CHUNK];
                for ((high, low), value) in high.iter_mut().zip(low).zip(values) {
                    // The one of the two modes that is odd is times the imaginary unit.
                    let value = scale
                        * match odd[entry] {
                            [false, true] => value.im,
                            [true, false] => -value.im,
                            [false, false] | [true, true] => value.re,
                        };
                    *high = value as f32;
                    *low = (value - f64::from(*high)) as f32;
                }
            }
        },
    );
}

/// The first of the rows of a chunk, of so many.
#[inline(always)]
fn first_of_chunk(chunk: usize, rows: usize) -> usize {
    (chunk * CHUNK).min(rows - CHUNK)
}

/// Numbers in which products are made.
trait Precision: Real {
    /// What a sum of two is of kernels.
    fn sum(high: f32, low: f32) -> Self;
}

impl Precision for f64 {
    #[inline(always)]
    fn sum(high: f32, low: f32) -> Self {
        Self::from(high) + Self::from(low)
    }
}

impl Precision for f32 {
    #[inline(always)]
    fn sum(high: f32, _: f32) -> Self {
        high
    }
}

/// The passes of a product, in a precision.
///
/// Transformed rows, and what becomes of them, lie in tiles: for every few columns, every [`CHUNK`] rows of the window, every mode, these rows of
/// these columns.
struct Passes<R: Real> {
    transforms: ComplexPlans<R>,
}

impl<R: Precision> Passes<R> {
    /// Columns of a tile.
    const TILE_COLUMNS: usize = CACHE_LINE / size_of::<Complex<R>>();

    fn new(layout: &Layout) -> Self {
        Self {
            transforms: ComplexPlans::new(layout.padded.0, layout.padded.1),
        }
    }

    /// Numbers in all tiles.
    fn room(layout: &Layout) -> usize {
        let (_, strip) = Self::lengths(layout);
        layout.half.div_ceil(Self::TILE_COLUMNS) * strip
    }

    /// Length of a tile, and of all tiles of a few columns.
    fn lengths(layout: &Layout) -> (usize, usize) {
        let tile = layout.modes * CHUNK * Self::TILE_COLUMNS;
        (tile, tile * layout.shape.0.div_ceil(CHUNK))
    }

    /// The product, of coefficients in that unit.
    fn apply(
        &self,
        (layout, kernel, tiles): (&Layout, &[f32], &mut [Complex<R>]),
        coefficients: &[f64],
        far: &mut [f64],
        unit: f64,
        workers: Workers<'_>,
    ) {
        self.rows_forward((layout, tiles), coefficients, unit.recip(), workers);
        self.columns((layout, tiles), kernel, workers);
        self.rows_back((layout, tiles), far, unit, workers);
    }

    fn transforms_alone(&self, layout: &Layout) {
        let ComplexPlans {
            row,
            row_back,
            column,
            column_back,
        } = &self.transforms;
        let mut rows = vec![Complex::default(); layout.padded.1];
        for _ in 0..layout.shape.0.div_ceil(2) * layout.modes {
            row.process(&mut rows);
            row_back.process(&mut rows);
        }
        let mut columns = vec![Complex::default(); layout.modes * layout.padded.0];
        for _ in 0..layout.half {
            column.process(&mut columns);
            column_back.process(&mut columns);
        }
    }

    fn rows_forward(
        &self,
        (layout, tiles): (&Layout, &mut [Complex<R>]),
        coefficients: &[f64],
        factor: f64,
        workers: Workers<'_>,
    ) {
        let Layout { modes, half, .. } = *layout;
        let (tile, strip) = Self::lengths(layout);
        let transforms = &self.transforms;
        // The tiles of every few rows.
        let mut blocks: Vec<Vec<&mut [Complex<R>]>> = layout
            .ranges
            .chunks(CHUNK)
            .map(|_| Vec::with_capacity(half.div_ceil(Self::TILE_COLUMNS)))
            .collect();
        for strip in tiles.chunks_exact_mut(strip) {
            for (block, tile) in blocks.iter_mut().zip(strip.chunks_exact_mut(tile)) {
                block.push(tile);
            }
        }
        // What is read of a pair of rows is twice its transforms.
        let factor = 0.5 * factor;
        workers.fill(
            &mut blocks,
            1,
            layout.least(),
            || RowRoom::new(transforms),
            |RowRoom { pair, scratch }, number, block| {
                if workers.cancel.is_cancelled() {
                    return;
                }
                let rows = number * CHUNK..layout.shape.0.min((number + 1) * CHUNK);
                for (row, mode) in row_pairs(rows, modes) {
                    let values = pair.rows();
                    values.fill(Complex::default());
                    let coefficient =
                        |pillar: usize| R::of(factor * coefficients[pillar * modes + mode]);
                    let (first, pillars) = layout.row(row);
                    for (value, pillar) in values[first..].iter_mut().zip(pillars) {
                        value.re = coefficient(pillar);
                    }
                    let (first, pillars) = layout.row(row + 1);
                    for (value, pillar) in values[first..].iter_mut().zip(pillars) {
                        value.im = coefficient(pillar);
                    }
                    pair.forward(transforms.row.as_ref(), scratch);
                    let line = Self::line(row, mode);
                    widest(
                        #[inline(always)]
                        || {
                            for (strip, tile) in block[0].iter_mut().enumerate() {
                                let lines = &mut tile[line..][..2 * Self::TILE_COLUMNS];
                                let (one, other) = lines.split_at_mut(Self::TILE_COLUMNS);
                                pair.twice_spectra(strip * Self::TILE_COLUMNS, [one, other]);
                            }
                        },
                    );
                }
            },
        );
    }

    /// Where the line of a row and a mode begins in its tile; that of the next row follows.
    fn line(row: usize, mode: usize) -> usize {
        (mode * CHUNK + row % CHUNK) * Self::TILE_COLUMNS
    }

    fn rows_back(
        &self,
        (layout, tiles): (&Layout, &[Complex<R>]),
        far: &mut [f64],
        unit: f64,
        workers: Workers<'_>,
    ) {
        let mut blocks = Vec::with_capacity(layout.ranges.len().div_ceil(CHUNK));
        let mut rest = far;
        for ranges in layout.ranges.chunks(CHUNK) {
            let pillars: usize = ranges.iter().map(ExactSizeIterator::len).sum();
            let (block, after) = rest.split_at_mut(pillars * layout.modes);
            blocks.push(block);
            rest = after;
        }
        workers.fill(
            &mut blocks,
            1,
            layout.least(),
            || RowRoom::new(&self.transforms),
            |room, number, block| {
                if !workers.cancel.is_cancelled() {
                    self.block_back((layout, tiles), number, (block[0], unit), room);
                }
            },
        );
    }

    /// Transforms the rows of a block back; `far` are the loads on the pillars in them.
    fn block_back(
        &self,
        (layout, tiles): (&Layout, &[Complex<R>]),
        number: usize,
        (far, unit): (&mut [f64], f64),
        room: &mut RowRoom<R>,
    ) {
        let modes = layout.modes;
        let (tile, strip) = Self::lengths(layout);
        let RowRoom { pair, scratch } = room;
        let rows = number * CHUNK..layout.shape.0.min((number + 1) * CHUNK);
        let start = layout.ranges[rows.start].start;
        for (row, mode) in row_pairs(rows, modes) {
            let line = number * tile + Self::line(row, mode);
            widest(
                #[inline(always)]
                || {
                    for (place, strip) in tiles.chunks_exact(strip).enumerate() {
                        let lines = &strip[line..][..2 * Self::TILE_COLUMNS];
                        let (one, other) = lines.split_at(Self::TILE_COLUMNS);
                        pair.set_spectra(place * Self::TILE_COLUMNS, [one, other]);
                    }
                },
            );
            pair.back(self.transforms.row_back.as_ref(), scratch);
            let values = pair.rows();
            let target = |pillar: usize| (pillar - start) * modes + mode;
            let (first, pillars) = layout.row(row);
            for (value, pillar) in values[first..].iter().zip(pillars) {
                far[target(pillar)] = unit * value.re.double();
            }
            let (first, pillars) = layout.row(row + 1);
            for (value, pillar) in values[first..].iter().zip(pillars) {
                far[target(pillar)] = unit * value.im.double();
            }
        }
    }

    fn columns(
        &self,
        (layout, tiles): (&Layout, &mut [Complex<R>]),
        kernels: &[f32],
        workers: Workers<'_>,
    ) {
        let (modes, rows, padded) = (layout.modes, layout.shape.0, layout.padded.0);
        let (tile, strip) = Self::lengths(layout);
        let transforms = &self.transforms;
        let scratch_len = transforms.scratch_len();
        let of_column = layout.kernel_column();
        let work = || ColumnWork {
            columns: vec![Complex::default(); Self::TILE_COLUMNS * modes * padded],
            product: vec![Complex::default(); modes * padded],
            scratch: vec![Complex::default(); scratch_len],
        };
        let one = |work: &mut ColumnWork<R>, number: usize, strip: &mut [Complex<R>]| {
            if workers.cancel.is_cancelled() {
                return;
            }
            let ColumnWork {
                columns,
                product,
                scratch,
            } = work;
            let lengths = [tile, modes * padded, padded];
            Self::turn(strip, columns, lengths, |line, value| *value = *line);
            let kernels =
                kernels[number * Self::TILE_COLUMNS * of_column..].chunks_exact(of_column);
            for (column, kernel) in columns.chunks_exact_mut(modes * padded).zip(kernels) {
                for values in column.chunks_exact_mut(padded) {
                    values[rows..].fill(Complex::default());
                }
                transforms.column.process_with_scratch(column, scratch);
                multiply(kernel, layout, column, product);
                transforms
                    .column_back
                    .process_with_scratch(product, scratch);
                let products = product.chunks_exact(padded);
                for (values, product) in column.chunks_exact_mut(padded).zip(products) {
                    values[..rows].copy_from_slice(&product[..rows]);
                    // The last row may have none to go back with.
                    values[rows..rows.next_multiple_of(CHUNK)].fill(Complex::default());
                }
            }
            Self::turn(strip, columns, lengths, |line, value| *line = *value);
        };
        workers.fill(tiles, strip, layout.least(), work, one);
    }

    /// Goes through lines of tiles and columns together. Lengths of a tile, of all modes in a column, and of one.
    #[inline(always)]
    fn turn(
        strip: &mut [Complex<R>],
        columns: &mut [Complex<R>],
        [tile, column, mode]: [usize; 3],
        each: impl Fn(&mut Complex<R>, &mut Complex<R>),
    ) {
        for (number, tile) in strip.chunks_exact_mut(tile).enumerate() {
            let of_modes = tile.chunks_exact_mut(CHUNK * Self::TILE_COLUMNS);
            for (place, lines) in of_modes.enumerate() {
                for k in 0..Self::TILE_COLUMNS {
                    let first = k * column + place * mode + number * CHUNK;
                    let rows = &mut columns[first..][..CHUNK];
                    for row in 0..CHUNK {
                        each(&mut lines[row * Self::TILE_COLUMNS + k], &mut rows[row]);
                    }
                }
            }
        }
    }
}

struct RowWork {
    /// One row of every pair of modes, two by two.
    pairs: Vec<RowPair<f64>>,
    block: Vec<f64>,
    /// For the transform of no row.
    spare: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl RowWork {
    /// The kernels between pillars that many rows and columns apart.
    fn fill_row(
        &mut self,
        pair: &PairCoupling,
        radial: &[f64],
        (row, apart): (usize, RangeInclusive<i64>),
        columns: usize,
    ) {
        for rows in &mut self.pairs {
            rows.rows().fill(Complex64::default());
        }
        let (row, parts) = (row as i64, pair.radial_count());
        for column in apart {
            if (row, column) == (0, 0) {
                // What layers do to a pillar by itself has no direction.
                if let Some(own) = pair.own_block() {
                    let modes = pair.modes().len();
                    let upper = (0..modes).flat_map(|row| &own[row * modes + row..][..modes - row]);
                    self.block.clear();
                    self.block.extend(upper);
                    self.place_block(0);
                }
                continue;
            }
            let norm = (square(row, column) as f64).sqrt();
            let direction = [
                0.5 * 3f64.sqrt() * (row + column) as f64 / norm,
                0.5 * (row - column) as f64 / norm,
            ];
            let radial = &radial[distance_number(row, column) * parts..][..parts];
            pair.upper_block(radial, direction, &mut self.block);
            self.place_block(column.rem_euclid(columns as i64) as usize);
        }
    }

    /// Puts the block to its place in all rows.
    fn place_block(&mut self, place: usize) {
        for (rows, values) in self.pairs.iter_mut().zip(self.block.chunks(2)) {
            let value = &mut rows.rows()[place];
            value.re = values[0];
            value.im = values.get(1).copied().unwrap_or(0.0);
        }
    }
}

/// The first of every two rows, once for every mode.
fn row_pairs(rows: Range<usize>, modes: usize) -> impl Iterator<Item = (usize, usize)> {
    rows.step_by(2)
        .flat_map(move |row| (0..modes).map(move |mode| (row, mode)))
}

/// Room for two rows.
struct RowRoom<R> {
    pair: RowPair<R>,
    scratch: Vec<Complex<R>>,
}

impl<R: Real> RowRoom<R> {
    fn new(transforms: &ComplexPlans<R>) -> Self {
        Self {
            pair: RowPair::new(transforms.row.len()),
            scratch: vec![Complex::default(); transforms.scratch_len()],
        }
    }
}

struct ColumnWork<R> {
    /// A few columns of all modes, one after the other.
    columns: Vec<Complex<R>>,
    product: Vec<Complex<R>>,
    scratch: Vec<Complex<R>>,
}

/// `output = K input` for one column of all modes.
fn multiply<R: Precision>(
    kernel: &[f32],
    layout: &Layout,
    input: &[Complex<R>],
    output: &mut [Complex<R>],
) {
    widest(
        #[inline(always)]
        || {
            let (high, low) = kernel.split_at(kernel.len() / 2);
            let kernel = (high.as_chunks().0, low.as_chunks().0);
            let mut first = 0;
            // As many modes at a time as there are registers for.
            while first < layout.modes {
                let meeting = Meeting {
                    kernel,
                    layout,
                    input,
                    first,
                };
                first += match layout.modes - first {
                    6.. => meeting.multiply::<6>(output),
                    3.. => meeting.multiply::<3>(output),
                    _ => meeting.multiply::<1>(output),
                };
            }
        },
    );
}

/// High and low parts of kernels in chunks of rows.
type Chunks<'a> = (&'a [[f32; CHUNK]], &'a [[f32; CHUNK]]);

/// All modes of a column, and the first of those whose product is made.
struct Meeting<'a, R> {
    kernel: Chunks<'a>,
    layout: &'a Layout,
    input: &'a [Complex<R>],
    first: usize,
}

impl<R: Precision> Meeting<'_, R> {
    /// The product of `M` modes. Returns how many these are.
    #[inline(always)]
    fn multiply<const M: usize>(&self, output: &mut [Complex<R>]) -> usize {
        // As many rows at a time as are in a register.
        if size_of::<R>() == size_of::<f32>() {
            self.in_chunks::<M, 8>(output);
        } else {
            self.in_chunks::<M, 4>(output);
        }
        M
    }

    #[inline(always)]
    fn in_chunks<const M: usize, const N: usize>(&self, output: &mut [Complex<R>]) {
        let (high, low) = self.kernel;
        let entries = self.layout.entries;
        let kernels = high.chunks_exact(entries).zip(low.chunks_exact(entries));
        for (chunk, kernel) in kernels.enumerate() {
            let first = first_of_chunk(chunk, self.layout.padded.0);
            for part in (0..CHUNK).step_by(N) {
                self.rows::<M, N>(kernel, part, first + part, output);
            }
        }
    }

    /// The product of `M` modes in `N` rows, whose sums stay in registers.
    #[inline(always)]
    fn rows<const M: usize, const N: usize>(
        &self,
        (high, low): Chunks<'_>,
        part: usize,
        row: usize,
        output: &mut [Complex<R>],
    ) {
        let (modes, padded) = (self.layout.modes, self.layout.padded.0);
        let mut real = [[R::default(); N]; M];
        let mut imaginary = [[R::default(); N]; M];
        for (b, odd) in self.layout.odd.iter().enumerate() {
            let source = &self.input[b * padded + row..][..N];
            let (mut re, mut im) = ([R::default(); N], [R::default(); N]);
            for i in 0..N {
                (re[i], im[i]) = (source[i].re, source[i].im);
            }
            if *odd {
                for i in 0..N {
                    (re[i], im[i]) = (-im[i], re[i]);
                }
            }
            let pairs = &self.layout.pairs[b * modes + self.first..][..M];
            for k in 0..M {
                let (high, low) = (&high[pairs[k]][part..][..N], &low[pairs[k]][part..][..N]);
                for i in 0..N {
                    let kernel = R::sum(high[i], low[i]);
                    real[k][i] = real[k][i] + kernel * re[i];
                    imaginary[k][i] = imaginary[k][i] + kernel * im[i];
                }
            }
        }
        for k in 0..M {
            let a = self.first + k;
            let target = &mut output[a * padded + row..][..N];
            for i in 0..N {
                target[i] = if self.layout.odd[a] {
                    Complex::new(imaginary[k][i], -real[k][i])
                } else {
                    Complex::new(real[k][i], imaginary[k][i])
                };
            }
        }
    }
}

/// The parts of the coupling that depend on distances alone, for each distance in the lattice up to one, by [`distance_number`]. Of that one the
/// square is given, in pitches.
fn radial_parts(pair: &PairCoupling, square_of_largest: i64, workers: Workers<'_>) -> Vec<f64> {
    let parts = pair.radial_count();
    let most = (square_of_largest as f64).sqrt() as i64 + 1;
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
        let square = square(i, j);
        if square <= square_of_largest {
            pair.radial((square as f64).sqrt() * pair.pitch(), radial);
        }
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
