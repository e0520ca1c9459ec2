//! Convolutions over the cells of a grid by fast Fourier transform, for the non-periodic and the periodic half-space.
//!
//! A product makes three passes. The first transforms rows that contain cells. The second processes a block of columns at a time: it
//! transforms the columns, multiplies them by the kernel and transforms them back while they are in the cache. The third transforms the
//! rows that contain cells back. Rows without cells are neither stored nor transformed.

use super::operator::check_lengths;
use crate::numerics::fft::Real;
use crate::numerics::workers::{for_each, share};
use crate::problem::{Cells, Segment};
use num_complex::{Complex, Complex64};
use rayon::ThreadPool;
use std::mem;
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock};

/// Number of columns that are transformed together: two cache lines of each row.
pub(crate) const BLOCK_WIDTH: usize = 8;

/// Number of rows that are transformed together, so that each access to a block of columns writes a contiguous range.
const ROW_BLOCK: usize = 8;

/// Padding of lines in workspaces: lines whose distance is a power of two would map to few sets of the cache.
const LINE_PADDING: usize = 4;

/// Number of spectrum points below which threads are not worthwhile.
const PARALLEL_POINTS: usize = 10_000;

/// The one-dimensional transforms of a convolution, and its kernel.
pub(crate) trait Transform: Send + Sync {
    /// Precision of the computation.
    type Real: Real;

    /// Number of cells along x and y.
    fn shape(&self) -> [usize; 2];

    /// Number of complex values in the transform of a real row.
    fn column_count(&self) -> usize;

    /// Transforms a row, which may be overwritten.
    fn row_forward(
        &self,
        row: &mut [Self::Real],
        spectrum: &mut [Complex<Self::Real>],
        scratch: &mut [Complex<Self::Real>],
    );

    /// Transforms a row back; the spectrum may be overwritten.
    fn row_back(
        &self,
        spectrum: &mut [Complex<Self::Real>],
        row: &mut [Self::Real],
        scratch: &mut [Complex<Self::Real>],
    );

    /// Convolves a block of columns along y in place: transform, kernel, inverse transform.
    fn convolve(&self, block: &mut ColumnBlock<'_, Self::Real>, work: &mut Workspace<Self::Real>);

    /// Length of the scratch buffer for each of the transforms, in complex values.
    fn scratch_len(&self) -> usize;

    /// Number of columns of full length that `convolve` needs at once, for each column of the block.
    fn columns_at_once(&self) -> usize;

    /// Number of additional real values in the workspace of `convolve`.
    fn real_count(&self) -> usize {
        0
    }
}

/// Adjacent columns of the spectrum, of which only some rows are stored.
pub(crate) struct ColumnBlock<'a, R = f64> {
    /// First column.
    pub(crate) first: usize,
    /// Number of columns.
    pub(crate) width: usize,
    /// Stored rows, in increasing order.
    pub(super) rows: &'a [usize],
    /// For each stored row, the columns.
    pub(super) values: &'a mut [Complex<R>],
}

impl<R: Real> ColumnBlock<'_, R> {
    /// Writes the columns to lines with `rows` rows, `stride` apart; zero in rows that are not stored.
    pub(crate) fn read(&self, lines: &mut [Complex<R>], stride: usize, rows: usize) {
        let mut next = 0;
        for (&row, values) in self.rows.iter().zip(self.values.chunks_exact(self.width)) {
            clear_rows(lines, stride, next..row);
            next = row + 1;
            for (value, place) in values.iter().zip(lines[row..].iter_mut().step_by(stride)) {
                *place = *value;
            }
        }
        clear_rows(lines, stride, next..rows);
    }

    /// The same for lines with a different order of rows.
    pub(crate) fn read_to(
        &self,
        lines: &mut [Complex<R>],
        stride: usize,
        place: impl Fn(usize) -> usize,
    ) {
        lines.fill(Complex::default());
        for (&row, values) in self.rows.iter().zip(self.values.chunks_exact(self.width)) {
            let places = lines[place(row)..].iter_mut().step_by(stride);
            for (value, place) in values.iter().zip(places) {
                *place = *value;
            }
        }
    }

    /// Reads the stored rows from lines with this order of rows.
    pub(crate) fn write_from(
        &mut self,
        lines: &[Complex<R>],
        stride: usize,
        place: impl Fn(usize) -> usize,
    ) {
        let rows = self.rows.iter();
        for (&row, values) in rows.zip(self.values.chunks_exact_mut(self.width)) {
            let places = lines[place(row)..].iter().step_by(stride);
            for (value, place) in values.iter_mut().zip(places) {
                *value = *place;
            }
        }
    }

    /// Reads the stored rows from such lines.
    pub(crate) fn write(&mut self, lines: &[Complex<R>], stride: usize) {
        self.write_from(lines, stride, |row| row);
    }
}

/// Workspace of one thread.
pub(crate) struct Workspace<R = f64> {
    /// Rows or columns, [`line_stride`] apart.
    pub(crate) lines: Vec<Complex<R>>,
    /// Scratch buffer of the transforms.
    pub(crate) scratch: Vec<Complex<R>>,
    /// Buffer for real values.
    pub(crate) reals: Vec<R>,
    row: Vec<R>,
}

impl<R: Real> Workspace<R> {
    fn new(transform: &impl Transform<Real = R>) -> Self {
        let lines = line_memory(transform) / size_of::<Complex64>();
        Self {
            lines: vec![Complex::default(); lines],
            scratch: vec![Complex::default(); transform.scratch_len()],
            reals: vec![R::default(); transform.real_count()],
            row: vec![R::default(); transform.shape()[0]],
        }
    }
}

/// Distance of lines of the given length in a workspace.
pub(crate) fn line_stride(length: usize) -> usize {
    length + LINE_PADDING
}

/// Memory in bytes of the rows or columns that one thread processes at once.
fn line_memory(transform: &impl Transform) -> usize {
    line_memory_of(
        transform.column_count(),
        transform.shape()[1],
        transform.columns_at_once(),
    )
}

fn line_memory_of(columns: usize, rows: usize, columns_at_once: usize) -> usize {
    let for_rows = ROW_BLOCK * line_stride(columns);
    let for_columns = columns_at_once * BLOCK_WIDTH * line_stride(rows);
    size_of::<Complex64>() * for_rows.max(for_columns)
}

/// Memory in bytes of the spectrum of `stored` rows of `columns` complex numbers, and of the workspaces of `threads` threads.
pub(crate) fn memory_estimate(
    columns: usize,
    rows: usize,
    stored: usize,
    columns_at_once: usize,
    threads: usize,
) -> usize {
    let scratch = 2 * size_of::<Complex64>() * columns.max(rows);
    let lines = line_memory_of(columns, rows, columns_at_once);
    size_of::<Complex64>() * stored * columns + threads * (lines + scratch)
}

/// The bounding rectangle of cells in a grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Bounds {
    /// First column and row.
    pub(super) first: [usize; 2],
    /// Number of columns and rows; at least one.
    pub(super) shape: [usize; 2],
    /// Number of rows that contain cells.
    pub(super) stored_rows: usize,
}

impl Bounds {
    pub(super) fn of(cells: &Cells) -> Self {
        let segments = cells.segments();
        let (Some(lowest), Some(highest)) = (segments.first(), segments.last()) else {
            return Self {
                first: [0, 0],
                shape: [1, 1],
                stored_rows: 0,
            };
        };
        let left = segments
            .iter()
            .map(|segment| segment.column)
            .min()
            .unwrap_or(0);
        let right = segments
            .iter()
            .map(|segment| segment.column + segment.count)
            .max();
        Self {
            first: [left, lowest.row],
            shape: [
                right.map_or(1, |right| right - left),
                highest.row + 1 - lowest.row,
            ],
            stored_rows: segments.chunk_by(|a, b| a.row == b.row).count(),
        }
    }
}

/// A convolution over some cells of a grid.
pub(crate) struct Convolution<'p, T: Transform> {
    cells: Cells,
    transform: Arc<T>,
    /// The first column of the transform in the grid.
    first_column: usize,
    /// Rows that contain cells, relative to the first row of the transform.
    rows: Vec<usize>,
    /// Index of the first segment of each of these rows, and the end.
    row_segments: Vec<usize>,
    /// The spectrum, by blocks of columns; each block contains its columns of every stored row. The locks let threads that process rows
    /// write to blocks, and are locked only briefly.
    spectrum: Vec<RwLock<Vec<Complex<T::Real>>>>,
    /// One workspace for each thread.
    workspaces: Vec<Mutex<Workspace<T::Real>>>,
    pool: Option<&'p ThreadPool>,
}

impl<'p, T: Transform> Convolution<'p, T> {
    /// Prepares the convolution. Cell `first` of the grid is the first of the transform, which must include all cells.
    pub(crate) fn new(
        cells: Cells,
        first: [usize; 2],
        transform: Arc<T>,
        pool: Option<&'p ThreadPool>,
    ) -> Self {
        let mut rows = Vec::new();
        let mut row_segments = vec![0];
        for segments in cells.segments().chunk_by(|a, b| a.row == b.row) {
            rows.push(segments[0].row - first[1]);
            row_segments.push(row_segments[rows.len() - 1] + segments.len());
        }
        let columns = transform.column_count();
        let spectrum: Vec<_> = (0..columns)
            .step_by(BLOCK_WIDTH)
            .map(|first| {
                let width = BLOCK_WIDTH.min(columns - first);
                RwLock::new(vec![Complex::default(); width * rows.len()])
            })
            .collect();
        let pool = pool.filter(|pool| {
            pool.current_num_threads() > 1 && columns * rows.len() >= PARALLEL_POINTS
        });
        let threads = pool.map_or(1, ThreadPool::current_num_threads);
        Self {
            workspaces: (0..threads)
                .map(|_| Mutex::new(Workspace::new(&*transform)))
                .collect(),
            first_column: first[0],
            cells,
            transform,
            rows,
            row_segments,
            spectrum,
            pool,
        }
    }

    pub(crate) fn cells(&self) -> &Cells {
        &self.cells
    }

    pub(crate) fn transform(&self) -> &Arc<T> {
        &self.transform
    }

    /// Number of rows that contain cells.
    #[cfg(any(test, feature = "kernels"))]
    pub(crate) fn stored_rows(&self) -> usize {
        self.rows.len()
    }

    pub(super) fn pool(&self) -> Option<&'p ThreadPool> {
        self.pool
    }

    /// Memory in bytes of the spectrum and the workspaces.
    #[cfg(test)]
    pub(super) fn memory(&self) -> usize {
        let spectrum: usize = self
            .spectrum
            .iter()
            .map(|block| size_of_val(&**block.read().unwrap()))
            .sum();
        let work: usize = self
            .workspaces
            .iter()
            .map(|work| {
                let work = work.lock().unwrap();
                size_of_val(&*work.lines) + size_of_val(&*work.scratch) + size_of_val(&*work.row)
            })
            .sum();
        spectrum + work
    }

    pub(crate) fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        let transform = Arc::clone(&self.transform);
        self.apply_by(&*transform, pressure, displacement);
    }

    /// Applies another transform of the same shape.
    pub(super) fn apply_by(&mut self, transform: &T, pressure: &[f64], displacement: &mut [f64]) {
        check_lengths(&self.cells, pressure, displacement);
        let blocks = self.rows.len().div_ceil(ROW_BLOCK);
        for_each(self.pool, blocks, &|block| {
            self.row_block_forward(transform, block, pressure);
        });
        self.columns(transform);
        self.rows_back(transform, displacement);
    }

    /// The workspace of this thread. Each thread has a separate one, so that the lock is free.
    fn workspace(&self) -> MutexGuard<'_, Workspace<T::Real>> {
        let thread = self.pool.and_then(ThreadPool::current_thread_index);
        self.workspaces[thread.unwrap_or(0)]
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }

    fn row_block(&self, block: usize) -> Range<usize> {
        block * ROW_BLOCK..((block + 1) * ROW_BLOCK).min(self.rows.len())
    }

    /// Segments of a stored row.
    fn segments(&self, row: usize) -> &[Segment] {
        &self.cells.segments()[self.row_segments[row]..self.row_segments[row + 1]]
    }

    /// Range of the cells of some stored rows in vectors.
    fn unknowns(&self, rows: &Range<usize>) -> Range<usize> {
        let start = |row: usize| {
            let segments = &self.cells.segments()[self.row_segments[row]..];
            segments
                .first()
                .map_or(self.cells.len(), |segment| segment.start)
        };
        start(rows.start)..start(rows.end)
    }

    fn row_block_forward(&self, transform: &T, block: usize, pressure: &[f64]) {
        let rows = self.row_block(block);
        let columns = transform.column_count();
        let stride = line_stride(columns);
        let work = &mut *self.workspace();
        for (row, line) in rows.clone().zip(work.lines.chunks_exact_mut(stride)) {
            work.row.fill(T::Real::default());
            for segment in self.segments(row) {
                let column = segment.column - self.first_column;
                let own = &mut work.row[column..column + segment.count];
                let pressure = &pressure[segment.start..segment.start + segment.count];
                for (own, pressure) in own.iter_mut().zip(pressure) {
                    *own = T::Real::of(*pressure);
                }
            }
            transform.row_forward(&mut work.row, &mut line[..columns], &mut work.scratch);
        }
        for (index, block) in self.spectrum.iter().enumerate() {
            let first = index * BLOCK_WIDTH;
            let width = BLOCK_WIDTH.min(columns - first);
            let mut values = block.write().unwrap_or_else(PoisonError::into_inner);
            let values = &mut values[rows.start * width..rows.end * width];
            for (values, line) in values
                .chunks_exact_mut(width)
                .zip(work.lines.chunks_exact(stride))
            {
                values.copy_from_slice(&line[first..first + width]);
            }
        }
    }

    fn columns(&self, transform: &T) {
        let columns = transform.column_count();
        for_each(self.pool, self.spectrum.len(), &|index| {
            let first = index * BLOCK_WIDTH;
            let values = self.spectrum[index].write();
            let mut block = ColumnBlock {
                first,
                width: BLOCK_WIDTH.min(columns - first),
                rows: &self.rows,
                values: &mut values.unwrap_or_else(PoisonError::into_inner),
            };
            transform.convolve(&mut block, &mut self.workspace());
        });
    }

    /// Transforms the rows back, block by block; each block splits its part of the displacement from the front of the remainder.
    fn rows_back(&self, transform: &T, displacement: &mut [f64]) {
        let blocks = self.rows.len().div_ceil(ROW_BLOCK);
        let left = Mutex::new((0..blocks, displacement));
        let next = || {
            let mut left = left.lock().unwrap_or_else(PoisonError::into_inner);
            let rows = self.row_block(left.0.next()?);
            let (part, rest) = mem::take(&mut left.1).split_at_mut(self.unknowns(&rows).len());
            left.1 = rest;
            Some((rows, part))
        };
        share(self.pool, &|| {
            while let Some((rows, part)) = next() {
                self.row_block_back(transform, rows, part);
            }
        });
    }

    fn row_block_back(&self, transform: &T, rows: Range<usize>, displacement: &mut [f64]) {
        let columns = transform.column_count();
        let stride = line_stride(columns);
        let work = &mut *self.workspace();
        for (index, block) in self.spectrum.iter().enumerate() {
            let first = index * BLOCK_WIDTH;
            let width = BLOCK_WIDTH.min(columns - first);
            let values = block.read().unwrap_or_else(PoisonError::into_inner);
            let values = &values[rows.start * width..rows.end * width];
            for (values, line) in values
                .chunks_exact(width)
                .zip(work.lines.chunks_exact_mut(stride))
            {
                line[first..first + width].copy_from_slice(values);
            }
        }
        let offset = self.unknowns(&rows).start;
        for (row, line) in rows.zip(work.lines.chunks_exact_mut(stride)) {
            transform.row_back(&mut line[..columns], &mut work.row, &mut work.scratch);
            for segment in self.segments(row) {
                let column = segment.column - self.first_column;
                let start = segment.start - offset;
                let own = &work.row[column..column + segment.count];
                for (displacement, own) in displacement[start..].iter_mut().zip(own) {
                    *displacement = own.double();
                }
            }
        }
    }
}

/// Sets some rows of columns that are `stride` apart to zero.
pub(super) fn clear_rows<R: Real>(columns: &mut [Complex<R>], stride: usize, rows: Range<usize>) {
    if rows.is_empty() {
        return;
    }
    for column in columns.chunks_exact_mut(stride) {
        column[rows.clone()].fill(Complex::default());
    }
}

/// Multiplies a transformed column by its kernel, which is real.
pub(super) fn multiply<R: Real>(values: &mut [Complex<R>], kernel: &[R]) {
    for (value, kernel) in values.iter_mut().zip(kernel) {
        *value = *value * *kernel;
    }
}
