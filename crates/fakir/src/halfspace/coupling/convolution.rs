//! The coupling of many pillars of a lattice as a convolution, by fast Fourier transform.
//!
//! The window is padded with zeros so that distances between pairs of pillars remain distinct when the array wraps around
//! ([`Differences`]): the lattice is finite, without periodic images. There is one kernel for every pair of modes. Since
//! `B_ij(-D) = (-1)^(l+l') B_ij(D)`, its transform is real or imaginary, and since `B_ji(D) = (-1)^(l+l') B_ij(D)`, the upper triangle is
//! sufficient.
//!
//! A product makes three passes. The first transforms the rows of all modes (only those of the window are non-zero). The second processes a
//! few columns at a time: it transforms all modes, multiplies them by the kernels and transforms them back while they are in the cache
//! ([`ColumnTransform`]). The third transforms the rows of the window back. Each pass is shared between threads. Between the passes, the
//! transformed rows are stored in tiles of a few rows and columns, so that both rows and columns consist of whole cache lines and use few
//! memory pages.
//!
//! Products are computed in double precision or in single precision, which takes about half the time. A kernel is stored as the sum of two
//! numbers in single precision; single-precision products read only the first of these.

use super::differences::Differences;
use super::pair::PairCoupling;
use super::window::Window;
use crate::halfspace::disc::basis::Mode;
use crate::numerics::column_transform::{
    COLUMNS, ColumnTransform, LINE, SideBySide, registers_of_line,
};
use crate::numerics::fft::Real;
use crate::numerics::row_pair::RowPair;
use crate::numerics::simd::{Aligned, InRegisters};
use crate::numerics::vector::{largest, widest};
use crate::numerics::workers::Workers;
use fakir_fft::{Fft, Transformable};
use num_complex::{Complex, Complex64};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;
use std::sync::Arc;

/// Number of rows in a tile.
const CHUNK: usize = 8;

/// Approximate number of lines in a block of rows for column transforms, so that a block fits the cache.
const LINES_AT_ONCE: usize = 384;

/// Number of points of a padded array below which threads are not worthwhile.
const PARALLEL_POINTS: usize = 40_000;

/// Approximate size in bytes of the transformed rows that are stored while kernels are computed.
pub(super) const TRANSFORMED: usize = 128 << 20;

/// Smallest number of distances that a thread processes at a time.
const DISTANCES: usize = 200;

/// Computes products for all pillars of a window.
pub(crate) struct LatticeConvolution {
    layout: Layout,
    /// Transformed kernels. For every [`COLUMNS`] columns: the high parts for every position of their transforms, every pair of modes and
    /// each of these columns, then the low parts in the same order. Modes of odd degree are multiplied by the imaginary unit, so that all
    /// kernels are real. Includes the normalisation of the inverse transform.
    kernel: Aligned<f32>,
    /// Buffer for the transformed rows of double- or single-precision products.
    tiles: Aligned<f64>,
    exact: Passes<f64>,
    rough: Passes<f32>,
}

/// Dimensions and indices of the arrays.
struct Layout {
    /// Number of modes.
    modes: usize,
    /// Rows and columns of the window.
    shape: (usize, usize),
    /// Rows and columns after padding.
    padded: (usize, usize),
    /// Number of complex columns of a real transform, `padded.1/2 + 1`.
    half: usize,
    /// The pillars of every row, which are in consecutive columns, and the column of the first one.
    ranges: Vec<Range<usize>>,
    first_columns: Vec<usize>,
    /// Whether a mode is of odd degree.
    odd: Vec<bool>,
    /// The index of the pair of every two modes.
    pairs: Vec<usize>,
    /// Number of distinct pairs of modes.
    entries: usize,
}

impl Layout {
    /// Smallest number of work items that a thread processes at a time.
    fn least(&self) -> usize {
        if self.padded.0 * self.padded.1 >= PARALLEL_POINTS {
            1
        } else {
            usize::MAX
        }
    }

    /// Number of strips of [`COLUMNS`] columns, which are transformed together.
    fn strips(&self) -> usize {
        self.half.div_ceil(COLUMNS)
    }

    /// Number of values of all kernels in a strip: high parts, and as many low parts.
    fn kernel_strip(&self) -> usize {
        2 * self.entries * COLUMNS * self.padded.0
    }

    /// Number of values in a tile, and in all tiles of a strip.
    fn tile_lengths(&self) -> (usize, usize) {
        let tile = self.modes * CHUNK * LINE;
        (tile, tile * self.shape.0.div_ceil(CHUNK))
    }

    /// Index of every second line of a tile, which contains all modes of each row in order.
    fn line_pairs(&self, tile: usize) -> impl Iterator<Item = usize> {
        let rows = CHUNK.min(self.shape.0 - tile * CHUNK);
        (0..rows * self.modes).step_by(2)
    }

    /// The range of the coefficients of a tile's pillars.
    fn numbers_of_tile(&self, tile: usize) -> Range<usize> {
        let rows = &self.ranges[tile * CHUNK..];
        let rows = &rows[..rows.len().min(CHUNK)];
        rows[0].start * self.modes..rows[rows.len() - 1].end * self.modes
    }

    /// For a line and the next one: the column of the first pillar, the range of the row in the coefficients of the tile, and the mode.
    fn two_lines(&self, tile: usize, line: usize) -> [(usize, Range<usize>, usize); 2] {
        let start = self.ranges[tile * CHUNK].start;
        [line, line + 1].map(|line| {
            let (row, mode) = (tile * CHUNK + line / self.modes, line % self.modes);
            // There are no pillars after the last row.
            let pillars = self.ranges.get(row).cloned().unwrap_or(start..start);
            let first = self.first_columns.get(row).copied().unwrap_or(0);
            let numbers = (pillars.start - start) * self.modes..(pillars.end - start) * self.modes;
            (first, numbers, mode)
        })
    }

    /// Copies coefficients of a tile to a line, as real parts, and to the next line, as imaginary parts.
    fn read<R: Precision>(
        &self,
        values: &mut [Complex<R>],
        (tile, line): (usize, usize),
        numbers: &[f64],
        factor: f64,
    ) {
        let of = |number: f64| R::of(factor * number);
        let [(first, row, mode), (next_first, next_row, next_mode)] = self.two_lines(tile, line);
        values[..first].fill(Complex::default());
        values[first + row.len() / self.modes..].fill(Complex::default());
        let pillars = numbers[row.clone()].chunks_exact(self.modes);
        let row_values = values[first..].iter_mut().zip(pillars);
        if next_row == row {
            for (value, pillar) in row_values {
                *value = Complex::new(of(pillar[mode]), of(pillar[next_mode]));
            }
        } else {
            for (value, pillar) in row_values {
                *value = Complex::from(of(pillar[mode]));
            }
            let pillars = numbers[next_row].chunks_exact(self.modes);
            for (value, pillar) in values[next_first..].iter_mut().zip(pillars) {
                value.im = of(pillar[next_mode]);
            }
        }
    }

    /// Writes the coefficients that [`read`](Self::read) reads.
    fn write<R: Precision>(
        &self,
        values: &[Complex<R>],
        (tile, line): (usize, usize),
        numbers: &mut [f64],
        factor: f64,
    ) {
        let of = |value: R| factor * value.double();
        let [(first, row, mode), (next_first, next_row, next_mode)] = self.two_lines(tile, line);
        let pillars = numbers[row.clone()].chunks_exact_mut(self.modes);
        let row_values = values[first..].iter().zip(pillars);
        if next_row == row {
            for (value, pillar) in row_values {
                pillar[mode] = of(value.re);
                pillar[next_mode] = of(value.im);
            }
        } else {
            for (value, pillar) in row_values {
                pillar[mode] = of(value.re);
            }
            let pillars = numbers[next_row].chunks_exact_mut(self.modes);
            for (value, pillar) in values[next_first..].iter().zip(pillars) {
                pillar[next_mode] = of(value.im);
            }
        }
    }

    /// Number of values in all tiles.
    fn tile_length(&self) -> usize {
        self.strips() * self.tile_lengths().1
    }
}

/// The index of a pair of modes: pairs are ordered by the first mode, then by the second, each once.
const fn pair(modes: usize, a: usize, b: usize) -> usize {
    let (a, b) = if a < b { (a, b) } else { (b, a) };
    a * (2 * modes - a - 1) / 2 + b
}

impl LatticeConvolution {
    /// The kernels are undefined after cancellation; solvers check for it before they compute a product.
    pub(crate) fn new(window: &Window, pair: &PairCoupling, workers: Workers<'_>) -> Self {
        let shape = window.shape();
        let first_column =
            |row: &Range<usize>| window.places().get(row.start).map_or(0, |place| place.1);
        let differences = Differences::new(window);
        let padded = differences.small_array(shape.0.next_multiple_of(CHUNK));
        let modes = pair.modes().len();
        let layout = Layout {
            modes,
            shape,
            padded,
            half: padded.1 / 2 + 1,
            ranges: window.rows().to_vec(),
            first_columns: window.rows().iter().map(first_column).collect(),
            odd: pair.modes().iter().map(Mode::is_odd).collect(),
            pairs: (0..modes * modes)
                .map(|k| self::pair(modes, k / modes, k % modes))
                .collect(),
            entries: pair.entry_count(),
        };
        let exact = Passes::<f64>::new(&layout);
        Self {
            kernel: kernels(&layout, &differences, pair, &exact, workers),
            tiles: Aligned::new(layout.tile_length()),
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
        // The range of single precision is small: scales the largest coefficient to 1.
        let largest = largest(coefficients);
        let unit = if largest.is_normal() { largest } else { 1.0 };
        let tiles = bytemuck::cast_slice_mut(&mut self.tiles);
        let tiles = &mut tiles[..self.layout.tile_length()];
        let parts = (&self.layout, &self.kernel[..], tiles);
        self.rough.apply(parts, coefficients, far, unit, workers);
    }

    /// Minimum number of operations of a product, and the number of bytes transferred if every array is read or written once. Transforms of
    /// length `n` take `5 n log2 n` operations, transforms of real numbers half of that. For a double-precision product, or a
    /// single-precision one if `rough`.
    #[cfg(feature = "kernels")]
    pub(crate) fn least_work(&self, rough: bool) -> [f64; 2] {
        let layout = &self.layout;
        let [modes, rows, half] = [layout.modes, layout.shape.0, layout.half].map(|n| n as f64);
        let [long, wide] = [layout.padded.0, layout.padded.1].map(|n| n as f64);
        let rows_there_and_back = 2.0 * rows * modes * 2.5 * wide * wide.log2();
        let columns_there_and_back = 2.0 * half * modes * 5.0 * long * long.log2();
        let multiplied = 4.0 * modes * modes * half * long;
        let operations = rows_there_and_back + columns_there_and_back + multiplied;
        // Tiles are written, read, written again, and read again.
        let numbers = layout.tile_length();
        let bytes = if rough {
            2 * self.kernel.len() + 4 * 4 * numbers
        } else {
            4 * self.kernel.len() + 4 * 8 * numbers
        };
        [operations, bytes as f64]
    }

    /// Executes only the transforms of a product, with values that stay in the cache.
    #[cfg(feature = "kernels")]
    pub(crate) fn transforms_alone(&self, rough: bool) {
        if rough {
            self.rough.transforms_alone(&self.layout);
        } else {
            self.exact.transforms_alone(&self.layout);
        }
    }
}

/// Transformed kernels of all pairs of modes. Since `B_ij(-D) = (-1)^(l+l') B_ij(D)`, rows on one side are sufficient until the columns are
/// transformed.
fn kernels(
    layout: &Layout,
    differences: &Differences,
    pair: &PairCoupling,
    exact: &Passes<f64>,
    workers: Workers<'_>,
) -> Aligned<f32> {
    let (_, columns) = layout.padded;
    let (entries, half) = (layout.entries, layout.half);
    let least = layout.least();
    let distances = differences.distances();
    let radial = radial_parts(pair, &distances, workers);
    let mut kernel = Aligned::new(layout.strips() * layout.kernel_strip());
    // The transformed rows of the lattice take as much memory as the kernels: large lattices are processed in groups of columns.
    let of_strip = size_of::<Complex64>() * layout.shape.0 * entries * COLUMNS;
    let at_a_time = COLUMNS * (TRANSFORMED / of_strip).min(layout.strips()).max(1);
    let of_columns = at_a_time / COLUMNS * layout.kernel_strip();
    let mut transformed =
        vec![Complex64::default(); layout.shape.0 * entries * at_a_time.min(half)];
    for (number, kernel) in kernel.chunks_mut(of_columns).enumerate() {
        let first = number * at_a_time;
        let kept = first..(first + at_a_time).min(half);
        let transformed = &mut transformed[..layout.shape.0 * entries * kept.len()];
        let work = || RowWork {
            pairs: (0..entries.div_ceil(2))
                .map(|_| RowPair::new(columns))
                .collect(),
            block: vec![0.0; entries],
            spare: vec![Complex64::default(); half],
            scratch: vec![Complex64::default(); exact.row.get_inplace_scratch_len()],
        };
        let of_row = |work: &mut RowWork, row: usize, output: &mut [Complex64]| {
            if workers.cancel.is_cancelled() {
                return;
            }
            work.fill_row(pair, (&distances, &radial), (row, differences), columns);
            let RowWork {
                pairs,
                spare,
                scratch,
                ..
            } = work;
            for (rows, output) in pairs.iter_mut().zip(output.chunks_mut(2 * kept.len())) {
                rows.forward(exact.row.as_ref(), scratch);
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
        let frequencies = exact.columns.frequencies();
        fill_strips(layout, transformed, &frequencies, kernel, workers);
    }
    kernel
}

/// Computes the kernels of some strips from their transformed rows. The frequency at every position of the transforms is given.
fn fill_strips(
    layout: &Layout,
    transformed: &[Complex64],
    frequencies: &[usize],
    kernel: &mut [f32],
    workers: Workers<'_>,
) {
    let (rows, columns) = layout.padded;
    let entries = layout.entries;
    let of_rows = transformed.len() / layout.shape.0;
    let at_a_time = of_rows / entries;
    // Rows contain twice their transforms.
    let scale = 0.5 / (rows * columns) as f64;
    let transform = f64::forward(rows);
    let modes = |a: usize| (a..layout.modes).map(move |b| [layout.odd[a], layout.odd[b]]);
    let odd: Vec<[bool; 2]> = (0..layout.modes).flat_map(modes).collect();
    let work = || {
        let scratch = vec![Complex64::default(); transform.get_inplace_scratch_len()];
        (vec![Complex64::default(); COLUMNS * rows], scratch)
    };
    let one = |(strip, scratch): &mut (Vec<Complex64>, Vec<Complex64>),
               number: usize,
               kernel: &mut [f32]| {
        if workers.cancel.is_cancelled() {
            return;
        }
        let first = number * COLUMNS;
        let kept = first..at_a_time.min(first + COLUMNS);
        let (high, low) = kernel.split_at_mut(kernel.len() / 2);
        for (entry, [a, b]) in odd.iter().enumerate() {
            let sign = if a == b { 1.0 } else { -1.0 };
            for (values, column) in strip.chunks_exact_mut(rows).zip(kept.clone()) {
                values.fill(Complex64::default());
                for (row, spectra) in transformed.chunks_exact(of_rows).enumerate() {
                    let value = spectra[entry * at_a_time + column];
                    values[row] += value;
                    if row > 0 {
                        values[rows - row] += sign * value.conj();
                    }
                }
                transform.process_with_scratch(values, scratch);
            }
            let places = high
                .chunks_exact_mut(entries * COLUMNS)
                .zip(low.chunks_exact_mut(entries * COLUMNS))
                .zip(frequencies);
            for ((high, low), frequency) in places {
                let high = &mut high[entry * COLUMNS..][..kept.len()];
                let low = &mut low[entry * COLUMNS..][..kept.len()];
                let values = strip.chunks_exact(rows);
                for ((high, low), values) in high.iter_mut().zip(low).zip(values) {
                    // If one of the two modes is odd, the kernel is multiplied by the imaginary unit.
                    let value = values[*frequency];
                    let value = scale
                        * match [a, b] {
                            [false, true] => value.im,
                            [true, false] => -value.im,
                            [false, false] | [true, true] => value.re,
                        };
                    *high = value as f32;
                    *low = (value - f64::from(*high)) as f32;
                }
            }
        }
    };
    workers.fill(kernel, layout.kernel_strip(), layout.least(), work, one);
}

/// Precision of products.
trait Precision: InRegisters + bytemuck::Pod {
    /// Kernels from their high and low parts; `workspace` is a buffer for kernels that are computed from both.
    fn kernels<'a>(high: &'a [f32], low: &[f32], workspace: &'a mut [Self]) -> &'a [Self];
}

impl Precision for f64 {
    #[inline(always)]
    fn kernels<'a>(high: &'a [f32], low: &[f32], workspace: &'a mut [Self]) -> &'a [Self] {
        for (kernel, (high, low)) in workspace.iter_mut().zip(high.iter().zip(low)) {
            *kernel = Self::from(*high) + Self::from(*low);
        }
        workspace
    }
}

impl Precision for f32 {
    #[inline(always)]
    fn kernels<'a>(high: &'a [f32], _: &[f32], _: &'a mut [Self]) -> &'a [Self] {
        high
    }
}

/// The passes of a product in one precision.
///
/// Transformed rows, and the results computed from them, are stored in tiles. For every [`COLUMNS`] columns and every row of the window,
/// there are the lines of all modes; [`CHUNK`] rows form a tile.
struct Passes<R: Precision> {
    row: Arc<dyn Fft<R>>,
    row_back: Arc<dyn Fft<R>>,
    columns: ColumnTransform<R>,
}

impl<R: Precision> Passes<R> {
    fn new(layout: &Layout) -> Self {
        Self {
            row: R::forward(layout.padded.1),
            row_back: R::inverse(layout.padded.1),
            columns: ColumnTransform::new(layout.padded.0, LINES_AT_ONCE / layout.modes),
        }
    }

    /// Computes the product; coefficients are divided by `unit`.
    fn apply(
        &self,
        (layout, kernel, tiles): (&Layout, &[f32], &mut [R]),
        coefficients: &[f64],
        far: &mut [f64],
        unit: f64,
        workers: Workers<'_>,
    ) {
        self.rows_forward((layout, tiles), coefficients, unit.recip(), workers);
        self.columns((layout, tiles), kernel, workers);
        self.rows_back((layout, tiles), far, unit, workers);
    }

    #[cfg(feature = "kernels")]
    fn transforms_alone(&self, layout: &Layout) {
        let mut rows = vec![Complex::default(); layout.padded.1];
        for _ in 0..layout.shape.0.div_ceil(2) * layout.modes {
            self.row.process(&mut rows);
            self.row_back.process(&mut rows);
        }
        let (_, strip) = layout.tile_lengths();
        let mut strip = Aligned::new(strip);
        let mut work = ColumnWork::new(layout);
        for number in 0..layout.strips() {
            Arch::new().dispatch(Strip {
                layout,
                transform: &self.columns,
                number,
                values: &mut strip,
                kernels: None,
                work: &mut work,
            });
        }
    }

    fn rows_forward(
        &self,
        (layout, tiles): (&Layout, &mut [R]),
        coefficients: &[f64],
        factor: f64,
        workers: Workers<'_>,
    ) {
        let (tile, strip) = layout.tile_lengths();
        // The tiles of each group of rows.
        let mut blocks: Vec<Vec<&mut [R]>> = layout
            .ranges
            .chunks(CHUNK)
            .map(|_| Vec::with_capacity(layout.strips()))
            .collect();
        for strip in tiles.chunks_exact_mut(strip) {
            for (block, tile) in blocks.iter_mut().zip(strip.chunks_exact_mut(tile)) {
                block.push(tile);
            }
        }
        // `read` returns twice the transforms of a pair of rows.
        let factor = 0.5 * factor;
        workers.fill(
            &mut blocks,
            1,
            layout.least(),
            || RowWorkspace::new(self.row.as_ref()),
            |RowWorkspace { pair, scratch }, number, block| {
                if workers.cancel.is_cancelled() {
                    return;
                }
                let coefficients = &coefficients[layout.numbers_of_tile(number)];
                for line in layout.line_pairs(number) {
                    layout.read(pair.rows(), (number, line), coefficients, factor);
                    pair.forward(self.row.as_ref(), scratch);
                    widest(
                        #[inline(always)]
                        || {
                            for (strip, tile) in block[0].iter_mut().enumerate() {
                                let lines = &mut tile[line * LINE..][..2 * LINE];
                                pair.twice_lines(strip * COLUMNS, lines);
                            }
                        },
                    );
                }
            },
        );
    }

    fn rows_back(
        &self,
        (layout, tiles): (&Layout, &[R]),
        far: &mut [f64],
        unit: f64,
        workers: Workers<'_>,
    ) {
        let mut blocks = Vec::with_capacity(layout.ranges.len().div_ceil(CHUNK));
        let mut rest = far;
        for tile in 0..layout.ranges.len().div_ceil(CHUNK) {
            let (block, after) = rest.split_at_mut(layout.numbers_of_tile(tile).len());
            blocks.push(block);
            rest = after;
        }
        workers.fill(
            &mut blocks,
            1,
            layout.least(),
            || RowWorkspace::new(self.row_back.as_ref()),
            |workspace, number, block| {
                if !workers.cancel.is_cancelled() {
                    self.block_back((layout, tiles), number, (block[0], unit), workspace);
                }
            },
        );
    }

    /// Transforms the rows of a block back; `far` are the loads on their pillars.
    fn block_back(
        &self,
        (layout, tiles): (&Layout, &[R]),
        number: usize,
        (far, unit): (&mut [f64], f64),
        workspace: &mut RowWorkspace<R>,
    ) {
        let (tile, strip) = layout.tile_lengths();
        let RowWorkspace { pair, scratch } = workspace;
        for line in layout.line_pairs(number) {
            widest(
                #[inline(always)]
                || {
                    for (place, strip) in tiles.chunks_exact(strip).enumerate() {
                        let lines = &strip[number * tile + line * LINE..][..2 * LINE];
                        pair.set_lines(place * COLUMNS, lines);
                    }
                },
            );
            pair.back(self.row_back.as_ref(), scratch);
            layout.write(pair.rows(), (number, line), far, unit);
        }
    }

    fn columns(&self, (layout, tiles): (&Layout, &mut [R]), kernels: &[f32], workers: Workers<'_>) {
        let (_, strip) = layout.tile_lengths();
        let one = |work: &mut ColumnWork<R>, number: usize, values: &mut [R]| {
            if !workers.cancel.is_cancelled() {
                let of_strip = layout.kernel_strip();
                Arch::new().dispatch(Strip {
                    layout,
                    transform: &self.columns,
                    number,
                    values,
                    kernels: Some(&kernels[number * of_strip..][..of_strip]),
                    work,
                });
            }
        };
        workers.fill(
            tiles,
            strip,
            layout.least(),
            || ColumnWork::new(layout),
            one,
        );
    }
}

/// Buffers for a strip.
struct ColumnWork<R> {
    /// All rows, each with the lines of all modes.
    rows: Aligned<R>,
    /// Kernels of one row.
    kernels: Aligned<R>,
    /// Products of one row.
    products: Aligned<R>,
}

impl<R: Precision> ColumnWork<R> {
    fn new(layout: &Layout) -> Self {
        Self {
            rows: Aligned::new(layout.modes * layout.padded.0 * LINE),
            kernels: Aligned::new(layout.entries * COLUMNS),
            products: Aligned::new(layout.modes * LINE),
        }
    }
}

/// Processes the columns of a strip: transforms them, multiplies them by kernels if there are any, and transforms them back.
struct Strip<'a, R: Precision> {
    layout: &'a Layout,
    transform: &'a ColumnTransform<R>,
    number: usize,
    /// The tiles of the strip.
    values: &'a mut [R],
    kernels: Option<&'a [f32]>,
    work: &'a mut ColumnWork<R>,
}

impl<R: Precision> WithSimd for Strip<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            layout,
            transform,
            number,
            values,
            kernels,
            work,
        } = self;
        let width = registers_of_line::<R, S>(simd);
        let columns = COLUMNS.min(layout.half - number * COLUMNS);
        let used = (columns * width).div_ceil(LINE);
        let lines = layout.modes;
        let modes = SideBySide { lines, used };
        let of_row = lines * width;
        let values = &mut R::registers_mut(simd, values)[..layout.shape.0 * of_row];
        let all = R::registers_mut(simd, &mut work.rows);
        let workspace: &mut [R] = &mut work.kernels;
        let products = R::registers_mut(simd, &mut work.products);
        transform.enter(simd, values, all, modes);
        let of_block = transform.inner_length() * of_row;
        let of_kernels = layout.entries * COLUMNS;
        for (number, block) in all.chunks_exact_mut(of_block).enumerate() {
            transform.forward(simd, block, modes);
            if let Some(kernels) = kernels {
                let (high, low) = kernels.split_at(kernels.len() / 2);
                let first = number * transform.inner_length() * of_kernels;
                let high = high[first..].chunks_exact(of_kernels);
                let low = low[first..].chunks_exact(of_kernels);
                for (row, (high, low)) in block.chunks_exact_mut(of_row).zip(high.zip(low)) {
                    let meeting = Meeting::<R, S> {
                        layout,
                        kernels: R::registers(simd, R::kernels(high, low, workspace)),
                    };
                    meeting.multiply(simd, row, products, used);
                }
            }
            transform.back(simd, block, modes);
        }
        transform.leave(simd, all, values, modes);
    }
}

/// The lines of all modes in a row, and their kernels.
struct Meeting<'a, R: Precision, S: Simd> {
    layout: &'a Layout,
    kernels: &'a [R::Register<S>],
}

/// Number of modes up to degree 2, which nearly all products use.
const SIX: usize = 6;

/// The pair indices of these modes.
const PAIRS_OF_SIX: [[usize; SIX]; SIX] = {
    let mut pairs = [[0; SIX]; SIX];
    let mut k = 0;
    while k < SIX * SIX {
        pairs[k / SIX][k % SIX] = pair(SIX, k / SIX, k % SIX);
        k += 1;
    }
    pairs
};

impl<R: Precision, S: Simd> Meeting<'_, R, S> {
    /// `row = K row`
    #[inline(always)]
    fn multiply(
        &self,
        simd: S,
        row: &mut [R::Register<S>],
        products: &mut [R::Register<S>],
        used: usize,
    ) {
        let width = registers_of_line::<R, S>(simd);
        for k in 0..used.min(width / 2) {
            if self.layout.modes == SIX {
                self.three_of_six::<0>(simd, (row, k), products);
                self.three_of_six::<3>(simd, (row, k), products);
            } else {
                // As many modes at a time as the number of registers permits.
                let mut first = 0;
                while first < self.layout.modes {
                    first += match self.layout.modes - first {
                        3.. => self.some::<3>(simd, (row, k, first), products),
                        _ => self.some::<1>(simd, (row, k, first), products),
                    };
                }
            }
            for line in (0..self.layout.modes).map(|mode| mode * width) {
                row[line + k] = products[line];
                row[line + k + width / 2] = products[line + 1];
            }
        }
    }

    /// The products of three of six modes, from `FIRST` on, in one register. All indices are compile-time constants.
    #[inline(always)]
    fn three_of_six<const FIRST: usize>(
        &self,
        simd: S,
        (row, k): (&[R::Register<S>], usize),
        products: &mut [R::Register<S>],
    ) {
        let width = registers_of_line::<R, S>(simd);
        let row = &row[..SIX * width];
        let kernels = &self.kernels[..SIX * (SIX + 1) / 2 * (width / 2)];
        let zero = R::splat(simd, R::default());
        let mut sums = [[zero; 2]; 3];
        macro_rules! add {
            ($b:literal) => {
                let [re, im] = self.turned(simd, (row, k), $b);
                for a in 0..3 {
                    let kernel = kernels[PAIRS_OF_SIX[FIRST + a][$b] * (width / 2) + k];
                    sums[a][0] = R::times_plus(simd, kernel, re, sums[a][0]);
                    sums[a][1] = R::times_plus(simd, kernel, im, sums[a][1]);
                }
            };
        }
        add!(0);
        add!(1);
        add!(2);
        add!(3);
        add!(4);
        add!(5);
        self.put(simd, FIRST, &sums, products);
    }

    /// The products of `M` modes from `first` on, in one register. Returns their number.
    #[inline(always)]
    fn some<const M: usize>(
        &self,
        simd: S,
        (row, k, first): (&[R::Register<S>], usize, usize),
        products: &mut [R::Register<S>],
    ) -> usize {
        let modes = self.layout.modes;
        let width = registers_of_line::<R, S>(simd);
        let zero = R::splat(simd, R::default());
        let mut sums = [[zero; 2]; M];
        for b in 0..modes {
            let [re, im] = self.turned(simd, (row, k), b);
            let pairs = &self.layout.pairs[b * modes + first..][..M];
            for a in 0..M {
                let kernel = self.kernels[pairs[a] * (width / 2) + k];
                sums[a][0] = R::times_plus(simd, kernel, re, sums[a][0]);
                sums[a][1] = R::times_plus(simd, kernel, im, sums[a][1]);
            }
        }
        self.put(simd, first, &sums, products);
        M
    }

    /// Real and imaginary parts of a mode; odd modes are multiplied by the imaginary unit.
    #[inline(always)]
    fn turned(
        &self,
        simd: S,
        (row, k): (&[R::Register<S>], usize),
        mode: usize,
    ) -> [R::Register<S>; 2] {
        let width = registers_of_line::<R, S>(simd);
        let (re, im) = (row[mode * width + k], row[mode * width + width / 2 + k]);
        if self.layout.odd[mode] {
            [R::negative(simd, im), re]
        } else {
            [re, im]
        }
    }

    /// Writes the products of some modes to the beginning of their lines; odd modes are divided by the imaginary unit.
    #[inline(always)]
    fn put(
        &self,
        simd: S,
        first: usize,
        sums: &[[R::Register<S>; 2]],
        products: &mut [R::Register<S>],
    ) {
        let width = registers_of_line::<R, S>(simd);
        for (a, [re, im]) in sums.iter().enumerate() {
            let product = &mut products[(first + a) * width..][..2];
            if self.layout.odd[first + a] {
                product[0] = *im;
                product[1] = R::negative(simd, *re);
            } else {
                product[0] = *re;
                product[1] = *im;
            }
        }
    }
}

struct RowWork {
    /// One row of every pair of modes, in groups of two.
    pairs: Vec<RowPair<f64>>,
    block: Vec<f64>,
    /// Placeholder for a missing second row.
    spare: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl RowWork {
    /// Computes the kernels between pillars that are this many rows and columns apart, from all distances and the radial parts at these.
    fn fill_row(
        &mut self,
        pair: &PairCoupling,
        (distances, radial): (&[f64], &[f64]),
        (row, differences): (usize, &Differences),
        columns: usize,
    ) {
        for rows in &mut self.pairs {
            rows.rows().fill(Complex64::default());
        }
        let parts = pair.radial_count();
        for column in differences.columns(row) {
            if (row, column) == (0, 0) {
                // The effect of layers on the pillar itself has no direction.
                if let Some(own) = pair.own_block(1.0) {
                    let modes = pair.modes().len();
                    let upper = (0..modes).flat_map(|row| &own[row * modes + row..][..modes - row]);
                    self.block.clear();
                    self.block.extend(upper);
                    self.place_block(0);
                }
                continue;
            }
            let [x, y] = differences.vector(row as i64, column);
            let number = differences.number(row, column);
            let inverse = distances[number].recip();
            let direction = [x * inverse, y * inverse];
            let radial = &radial[number * parts..][..parts];
            pair.upper_block(radial, direction, &mut self.block);
            self.place_block(column.rem_euclid(columns as i64) as usize);
        }
    }

    /// Copies the block to this position in all rows.
    fn place_block(&mut self, place: usize) {
        for (rows, values) in self.pairs.iter_mut().zip(self.block.chunks(2)) {
            let value = &mut rows.rows()[place];
            value.re = values[0];
            value.im = values.get(1).copied().unwrap_or(0.0);
        }
    }
}

/// Buffer for two rows.
struct RowWorkspace<R> {
    pair: RowPair<R>,
    scratch: Vec<Complex<R>>,
}

impl<R: Real> RowWorkspace<R> {
    fn new(transform: &dyn Fft<R>) -> Self {
        Self {
            pair: RowPair::new(transform.len()),
            scratch: vec![Complex::default(); transform.get_inplace_scratch_len()],
        }
    }
}

/// The parts of the coupling that depend on the distance alone, for each of these distances that is not 0.
fn radial_parts(pair: &PairCoupling, distances: &[f64], workers: Workers<'_>) -> Vec<f64> {
    let parts = pair.radial_count();
    let mut radial = vec![0.0; distances.len() * parts];
    let one = |(): &mut (), number: usize, radial: &mut [f64]| {
        if distances[number] > 0.0 && !workers.cancel.is_cancelled() {
            pair.radial(distances[number], radial);
        }
    };
    workers.fill(&mut radial, parts, DISTANCES, || (), one);
    radial
}
