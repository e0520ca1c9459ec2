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
//!
//! Products are exact or rough: in double precision, or in single, which takes about half the time. A kernel is kept as the sum of two numbers in
//! single precision, of which rough products read the first alone.

use super::pair::PairCoupling;
use super::window::Window;
use crate::numerics::convergence::larger;
use crate::numerics::fft::{Real, RealPlans, smooth_size};
use crate::numerics::vector::widest;
use crate::numerics::workers::Workers;
use num_complex::{Complex, Complex64};
use std::ops::Range;

/// Rows of a tile.
const TILE_ROWS: usize = 8;

/// Bytes of a row of a tile: a cache line.
const CACHE_LINE: usize = 64;

/// Padded arrays of fewer points than this are not worth sharing between threads.
const PARALLEL_POINTS: usize = 40_000;

/// Bytes of transformed rows that are kept while kernels are made, about.
pub(super) const TRANSFORMED: usize = 128 << 20;

/// Distances a thread takes at a time, at the least.
const DISTANCES: usize = 200;

/// Products of all pillars of a window.
pub(crate) struct LatticeConvolution {
    layout: Layout,
    /// Transformed kernels: for every column, the high parts of every pair of modes, every row, then the low parts of the same. The real part
    /// where even, the imaginary part where odd. With the normalisation of the inverse.
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
    /// Whether the kernel of an upper-triangle pair of modes is odd.
    odd: Vec<bool>,
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

    /// Numbers of all kernels in a column: high parts, and as many low ones.
    fn kernel_column(&self) -> usize {
        2 * self.odd.len() * self.padded.0
    }
}

impl LatticeConvolution {
    /// If it is cancelled the kernels are nothing; solvers look before they ask for a product.
    pub(crate) fn new(window: &Window, pair: &PairCoupling, workers: Workers<'_>) -> Self {
        let shape = window.shape();
        let first_column =
            |row: &Range<usize>| window.places().get(row.start).map_or(0, |place| place.1);
        let padded = (smooth_size(2 * shape.0 - 1), smooth_size(2 * shape.1 - 1));
        let mut odd = Vec::with_capacity(pair.entry_count());
        for (row, receiver) in pair.modes().iter().enumerate() {
            for source in &pair.modes()[row..] {
                odd.push((receiver.degree + source.degree) % 2 == 1);
            }
        }
        let layout = Layout {
            modes: pair.modes().len(),
            shape,
            padded,
            half: padded.1 / 2 + 1,
            ranges: window.rows().to_vec(),
            first_columns: window.rows().iter().map(first_column).collect(),
            odd,
        };
        let exact = Passes::<f64>::new(&layout);
        Self {
            kernel: kernels(&layout, pair, &exact.transforms, workers),
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
    pair: &PairCoupling,
    transforms: &RealPlans,
    workers: Workers<'_>,
) -> Vec<f32> {
    let (_, columns) = layout.padded;
    let (entries, half) = (pair.entry_count(), layout.half);
    let reach = (layout.shape.0 as i64 - 1, layout.shape.1 as i64 - 1);
    let least = layout.least();
    let radial = radial_parts(pair, reach.0.max(reach.1), workers);
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
            grids: vec![0.0; entries * columns],
            block: vec![0.0; entries],
            spectrum: transforms.row.make_output_vec(),
            scratch: transforms.row.make_scratch_vec(),
        };
        let of_row = |work: &mut RowWork, row: usize, output: &mut [Complex64]| {
            if workers.cancel.is_cancelled() {
                return;
            }
            work.fill_row(pair, &radial, row as i64, reach.1, columns);
            let RowWork {
                grids,
                spectrum,
                scratch,
                ..
            } = work;
            let grids = grids.chunks_exact_mut(columns);
            for (grid, output) in grids.zip(output.chunks_exact_mut(kept.len())) {
                transforms.row_forward(grid, spectrum, scratch);
                output.copy_from_slice(&spectrum[kept.clone()]);
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
    transforms: &RealPlans,
    kernel: &mut [f32],
    workers: Workers<'_>,
) {
    let (rows, columns) = layout.padded;
    let entries = layout.odd.len();
    let of_rows = transformed.len() / layout.shape.0;
    let at_a_time = of_rows / entries;
    let scale = 1.0 / (rows * columns) as f64;
    let (odd, transform) = (&layout.odd, &transforms.column);
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
            for (entry, (input, &odd)) in input.chunks_exact_mut(rows).zip(odd).enumerate() {
                let sign = if odd { -1.0 } else { 1.0 };
                input.fill(Complex64::default());
                for (row, values) in transformed.chunks_exact(of_rows).enumerate() {
                    let value = values[entry * at_a_time + column];
                    input[row] = value;
                    if row > 0 {
                        input[rows - row] = sign * value.conj();
                    }
                }
            }
            transform.process_with_scratch(input, scratch);
            let (high, low) = kernel.split_at_mut(entries * rows);
            let parts = high.chunks_exact_mut(rows).zip(low.chunks_exact_mut(rows));
            for ((high, low), (values, &odd)) in parts.zip(input.chunks_exact(rows).zip(odd)) {
                for ((high, low), value) in high.iter_mut().zip(low).zip(values) {
                    let value = scale * if odd { value.im } else { value.re };
                    *high = value as f32;
                    *low = (value - f64::from(*high)) as f32;
                }
            }
        },
    );
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
/// Transformed rows, and what becomes of them, lie in tiles: for every few columns, every [`TILE_ROWS`] rows of the window, every mode, these rows of
/// these columns.
struct Passes<R: Real> {
    transforms: RealPlans<R>,
}

impl<R: Precision> Passes<R> {
    /// Columns of a tile.
    const TILE_COLUMNS: usize = CACHE_LINE / size_of::<Complex<R>>();

    fn new(layout: &Layout) -> Self {
        Self {
            transforms: RealPlans::new(layout.padded.0, layout.padded.1),
        }
    }

    /// Numbers in all tiles.
    fn room(layout: &Layout) -> usize {
        let (_, strip) = Self::lengths(layout);
        layout.half.div_ceil(Self::TILE_COLUMNS) * strip
    }

    /// Length of a tile, and of all tiles of a few columns.
    fn lengths(layout: &Layout) -> (usize, usize) {
        let tile = layout.modes * TILE_ROWS * Self::TILE_COLUMNS;
        (tile, tile * layout.shape.0.div_ceil(TILE_ROWS))
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
        let RealPlans {
            row,
            row_back,
            column,
            column_back,
        } = &self.transforms;
        let (mut real, mut complex) = (row.make_input_vec(), row.make_output_vec());
        for _ in 0..layout.shape.0 * layout.modes {
            let _ = row.process(&mut real, &mut complex);
            let _ = row_back.process(&mut complex, &mut real);
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
            .chunks(TILE_ROWS)
            .map(|_| Vec::with_capacity(half.div_ceil(Self::TILE_COLUMNS)))
            .collect();
        for strip in tiles.chunks_exact_mut(strip) {
            for (block, tile) in blocks.iter_mut().zip(strip.chunks_exact_mut(tile)) {
                block.push(tile);
            }
        }
        let work = || RowRoom::new(transforms);
        workers.fill(
            &mut blocks,
            1,
            layout.least(),
            work,
            |room, number, block| {
                if workers.cancel.is_cancelled() {
                    return;
                }
                let RowRoom {
                    values,
                    spectrum,
                    scratch,
                } = room;
                let ranges = layout.ranges.iter().zip(&layout.first_columns);
                let ranges = ranges.skip(number * TILE_ROWS).take(TILE_ROWS);
                for (row, (range, first)) in ranges.enumerate() {
                    for mode in 0..modes {
                        values.fill(R::default());
                        let of_row = values[*first..].iter_mut();
                        for (value, pillar) in of_row.zip(range.clone()) {
                            *value = R::of(factor * coefficients[pillar * modes + mode]);
                        }
                        transforms.row_forward(values, spectrum, scratch);
                        let line = (mode * TILE_ROWS + row) * Self::TILE_COLUMNS;
                        let pieces = spectrum.chunks(Self::TILE_COLUMNS);
                        for (tile, values) in block[0].iter_mut().zip(pieces) {
                            tile[line..line + values.len()].copy_from_slice(values);
                        }
                    }
                }
            },
        );
    }

    fn rows_back(
        &self,
        (layout, tiles): (&Layout, &[Complex<R>]),
        far: &mut [f64],
        unit: f64,
        workers: Workers<'_>,
    ) {
        let mut blocks = Vec::with_capacity(layout.ranges.len().div_ceil(TILE_ROWS));
        let mut rest = far;
        for ranges in layout.ranges.chunks(TILE_ROWS) {
            let pillars: usize = ranges.iter().map(ExactSizeIterator::len).sum();
            let (block, after) = rest.split_at_mut(pillars * layout.modes);
            blocks.push(block);
            rest = after;
        }
        let work = || RowRoom::new(&self.transforms);
        workers.fill(
            &mut blocks,
            1,
            layout.least(),
            work,
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
        let RowRoom {
            values,
            spectrum,
            scratch,
        } = room;
        let first = number * TILE_ROWS;
        let ranges = &layout.ranges[first..layout.shape.0.min(first + TILE_ROWS)];
        let start = ranges[0].start;
        let columns = &layout.first_columns[first..];
        for (row, (range, first)) in ranges.iter().zip(columns).enumerate() {
            for mode in 0..modes {
                let line = number * tile + (mode * TILE_ROWS + row) * Self::TILE_COLUMNS;
                let strips = tiles.chunks_exact(strip);
                for (values, strip) in spectrum.chunks_mut(Self::TILE_COLUMNS).zip(strips) {
                    values.copy_from_slice(&strip[line..line + values.len()]);
                }
                self.transforms.row_back(spectrum, values, scratch);
                for (value, pillar) in values[*first..].iter().zip(range.clone()) {
                    far[(pillar - start) * modes + mode] = unit * value.double();
                }
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
        let columns_of_tile = Self::TILE_COLUMNS;
        let (tile, strip) = Self::lengths(layout);
        let (transforms, odd) = (&self.transforms, &layout.odd);
        let scratch_len = transforms.scratch_len();
        let work = || ColumnWork {
            columns: vec![Complex::default(); columns_of_tile * modes * padded],
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
            let first = number * columns_of_tile;
            let lines = |tile: usize| {
                (0..modes).flat_map(move |mode| {
                    (0..TILE_ROWS.min(rows - tile * TILE_ROWS)).map(move |row| {
                        let line = (mode * TILE_ROWS + row) * columns_of_tile;
                        (line, mode * padded + tile * TILE_ROWS + row)
                    })
                })
            };
            for (number, tile) in strip.chunks_exact(tile).enumerate() {
                for (line, place) in lines(number) {
                    for (k, value) in tile[line..line + columns_of_tile].iter().enumerate() {
                        columns[k * modes * padded + place] = *value;
                    }
                }
            }
            let of_column = layout.kernel_column();
            let kernels = kernels[first * of_column..].chunks_exact(of_column);
            for (column, kernel) in columns.chunks_exact_mut(modes * padded).zip(kernels) {
                for values in column.chunks_exact_mut(padded) {
                    values[rows..].fill(Complex::default());
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
                    for (k, value) in tile[line..line + columns_of_tile].iter_mut().enumerate() {
                        *value = columns[k * modes * padded + place];
                    }
                }
            }
        };
        workers.fill(tiles, strip, layout.least(), work, one);
    }
}

struct RowWork {
    /// One row of every pair.
    grids: Vec<f64>,
    block: Vec<f64>,
    spectrum: Vec<Complex64>,
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

/// A row, and what it is transformed to.
struct RowRoom<R> {
    values: Vec<R>,
    spectrum: Vec<Complex<R>>,
    scratch: Vec<Complex<R>>,
}

impl<R: Real> RowRoom<R> {
    fn new(transforms: &RealPlans<R>) -> Self {
        Self {
            values: transforms.row.make_input_vec(),
            spectrum: transforms.row.make_output_vec(),
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
    odd: &[bool],
    modes: usize,
    padded: usize,
    input: &[Complex<R>],
    output: &mut [Complex<R>],
) {
    widest(
        #[inline(always)]
        || {
            let (high, low) = kernel.split_at(odd.len() * padded);
            let parts = high.chunks_exact(padded).zip(low.chunks_exact(padded));
            let mut pairs = parts.zip(odd);
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
fn add<R: Precision>(
    (high, low): (&[f32], &[f32]),
    imaginary: Option<f64>,
    first: bool,
    source: &[Complex<R>],
    target: &mut [Complex<R>],
) {
    let kernel = high.iter().zip(low).map(|(high, low)| R::sum(*high, *low));
    let places = target.iter_mut().zip(source).zip(kernel);
    match (imaginary, first) {
        (None, true) => {
            for ((target, source), k) in places {
                *target = Complex::new(k * source.re, k * source.im);
            }
        }
        (None, false) => {
            for ((target, source), k) in places {
                target.re = target.re + k * source.re;
                target.im = target.im + k * source.im;
            }
        }
        (Some(sign), true) => {
            let sign = R::of(sign);
            for ((target, source), k) in places {
                *target = Complex::new(-sign * k * source.im, sign * k * source.re);
            }
        }
        (Some(sign), false) => {
            let sign = R::of(sign);
            for ((target, source), k) in places {
                let k = sign * k;
                target.re = target.re - k * source.im;
                target.im = target.im + k * source.re;
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
