//! The non-periodic half-space by fast Fourier transform.
//!
//! A linear convolution of `n` points is exact in any ring of polynomials modulo one of degree at least `2 n - 1`. Modulo `x^(2n) - 1` it
//! is the cyclic convolution, padded with zeros to `2 n`. Here the modulus is `x^(2n) + 1 = (x^n - i)(x^n + i)`: each factor is a transform
//! of length `n` of the data times powers of a root of unity, so that no zeros are stored or transformed. Real data have conjugate values
//! at the roots of the two factors, and one factor is sufficient: a row of `n` real numbers becomes `n` complex numbers, whose columns need
//! both. (R. E. Crandall and B. Fagin, Discrete weighted transforms and large-integer arithmetic, Math. Comp. 62, 305 (1994).)
//!
//! With `theta_k = pi (4 k + 1)/(2 n)` the roots of the first factor are `exp(-i theta_k)`. The kernel is even in x and in y, so that its
//! transform is real, and equal at the roots of the second factor: `n_x n_y` real numbers.

use super::convolution::{
    BLOCK_WIDTH, Bounds, ColumnBlock, Convolution, Transform, Workspace, clear_rows, line_stride,
    memory_estimate, multiply,
};
use super::operator::Operator;
use super::potential::CellPotential;
use crate::numerics::fft::{Real, quick_length};
use crate::numerics::workers::fill;
use crate::problem::Cells;
use crate::problem::layer::WeightedLayer;
use fakir_fft::Fft;
use num_complex::{Complex, Complex64};
use rayon::ThreadPool;
use std::f64::consts::PI;
use std::sync::Arc;

/// Relative difference of cell sides below which they are equal up to rounding.
const SAME_SIDE: f64 = 1e-13;

/// The operator of a non-periodic half-space, by fast convolution.
///
/// The work of a product is that of the bounding rectangle of the cells, `N log N` in its number of cells, without the rows that contain no
/// cells. A product allocates no arrays.
///
/// ```
/// use fakir::halfspace::elements::{FreeSpaceConvolution, Operator};
/// use fakir::problem::{Cells, Grid};
///
/// // The centre of a square of side 2 under uniform pressure sinks by (8/pi) ln(1 + sqrt 2) c p
/// // (Love's closed form at x = y = 0, a = b = 1).
/// let grid = Grid::centred(101, 101, 2.0 / 101.0)?;
/// let mut operator = FreeSpaceConvolution::new(Cells::all(&grid), 1.0, None);
/// let pressure = vec![1.0; operator.len()];
/// let mut displacement = vec![0.0; operator.len()];
/// operator.apply(&pressure, &mut displacement);
/// let exact = 8.0 / std::f64::consts::PI * (1.0 + 2f64.sqrt()).ln();
/// assert!((displacement[101 * 50 + 50] / exact - 1.0).abs() < 1e-13);
/// # Ok::<(), fakir::problem::InvalidGrid>(())
/// ```
pub struct FreeSpaceConvolution<'p> {
    convolution: Convolution<'p, FreeSpace>,
    /// The same in single precision, if requested.
    rough: Option<Convolution<'p, FreeSpace<f32>>>,
}

impl<'p> FreeSpaceConvolution<'p> {
    /// The operator on `cells` of a half-space with the given `compliance` in 1/Pa: for two bodies, the sum of their `(1 - nu^2)/E`. The
    /// work is shared between the threads of `pool`.
    #[must_use]
    pub fn new(cells: Cells, compliance: f64, pool: Option<&'p ThreadPool>) -> Self {
        Self::on_layers(cells, compliance, &[], pool)
    }

    /// The same if bodies are layers, in the unit of length of the cells.
    pub(crate) fn on_layers(
        cells: Cells,
        compliance: f64,
        layers: &[WeightedLayer],
        pool: Option<&'p ThreadPool>,
    ) -> Self {
        let bounds = Bounds::of(&cells);
        let cell = cells.grid().cell();
        let free_space = FreeSpace::new(bounds.shape, cell, compliance, layers, pool);
        Self {
            convolution: Convolution::new(cells, bounds.first, Arc::new(free_space), pool),
            rough: None,
        }
    }

    /// The convolution with a kernel as an even function of the number of cells along x and along y, optionally also in
    /// [single precision](Self::apply_roughly).
    pub(crate) fn of_kernel(
        cells: Cells,
        kernel: impl Fn([usize; 2]) -> f64 + Sync,
        pool: Option<&'p ThreadPool>,
    ) -> Self {
        let bounds = Bounds::of(&cells);
        let free_space = FreeSpace::of_kernel(bounds.shape, 1.0, kernel, pool);
        let rough = Arc::new(free_space.in_single_precision());
        Self {
            rough: Some(Convolution::new(cells.clone(), bounds.first, rough, pool)),
            convolution: Convolution::new(cells, bounds.first, Arc::new(free_space), pool),
        }
    }

    /// The operator on other cells, of a grid with the same cell sides, sharing the kernel. Returns `None` if they extend over more columns
    /// or rows than the original cells.
    ///
    /// For the cells of a pattern and those between them, it computes the displacement outside the pattern.
    #[must_use]
    pub fn on_cells(&self, cells: Cells) -> Option<Self> {
        let free_space = self.convolution.transform();
        let bounds = Bounds::of(&cells);
        let [columns, rows] = free_space.shape;
        let fits = bounds.shape[0] <= columns && bounds.shape[1] <= rows;
        let mut sides = cells
            .grid()
            .cell()
            .into_iter()
            .zip(self.cells().grid().cell());
        let same = sides.all(|(side, own)| (side - own).abs() <= SAME_SIDE * own);
        (fits && same).then(|| Self {
            convolution: Convolution::new(
                cells,
                bounds.first,
                Arc::clone(free_space),
                self.convolution.pool(),
            ),
            rough: None,
        })
    }

    /// Approximate memory in bytes of the operator on `cells`, without the cells themselves, for `threads` threads.
    #[must_use]
    pub fn memory_estimate(cells: &Cells, threads: usize) -> usize {
        let bounds = Bounds::of(cells);
        let [columns, rows] = bounds.shape.map(quick_length);
        let spectrum = memory_estimate(columns, rows, bounds.stored_rows, 2, threads);
        // The partly transformed kernel is released before the spectrum is allocated.
        let preparation = size_of::<f64>() * columns * bounds.shape[1];
        size_of::<f64>() * columns * rows + spectrum.max(preparation)
    }
}

impl FreeSpaceConvolution<'_> {
    /// The cells on which the operator acts.
    #[must_use]
    pub fn cells(&self) -> &Cells {
        self.convolution.cells()
    }

    /// Number of columns and rows of the kernel.
    pub(super) fn shape(&self) -> [usize; 2] {
        self.convolution.transform().shape
    }

    /// A product to about seven digits, in half the time if it was prepared in single precision.
    pub(crate) fn apply_roughly(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        match &mut self.rough {
            Some(rough) => rough.apply(pressure, displacement),
            None => self.convolution.apply(pressure, displacement),
        }
    }
}

impl Operator for FreeSpaceConvolution<'_> {
    fn len(&self) -> usize {
        self.cells().len()
    }

    fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        self.convolution.apply(pressure, displacement);
    }
}

/// The transform along one dimension.
struct Axis<R = f64> {
    forward: Arc<dyn Fft<R>>,
    back: Arc<dyn Fft<R>>,
    /// `exp(-i pi j/(2 n))`.
    twist: Vec<Complex<R>>,
}

impl<R: Real> Axis<R> {
    fn new(length: usize) -> Self {
        let twist = |j: usize| {
            let (sin, cos) = (-PI * j as f64 / (2 * length) as f64).sin_cos();
            Complex::new(R::of(cos), R::of(sin))
        };
        Self {
            forward: R::forward(length),
            back: R::inverse(length),
            twist: (0..length).map(twist).collect(),
        }
    }

    fn len(&self) -> usize {
        self.twist.len()
    }

    fn scratch_len(&self) -> usize {
        let forward = self.forward.get_inplace_scratch_len();
        forward.max(self.back.get_inplace_scratch_len())
    }

    /// `Σ_j values[j] exp(-i theta_k j)` for all `k`.
    fn real_forward(&self, values: &[R], spectrum: &mut [Complex<R>], scratch: &mut [Complex<R>]) {
        for ((spectrum, value), twist) in spectrum.iter_mut().zip(values).zip(&self.twist) {
            *spectrum = twist * value;
        }
        spectrum[values.len()..].fill(Complex::default());
        self.forward.process_with_scratch(spectrum, scratch);
    }
}

impl Axis {
    /// `k_0 + 2 Σ_(j>0) k_j cos(theta_k j)`, the transform of an even kernel from its half.
    fn even_forward(
        &self,
        kernel: &[f64],
        spectrum: &mut [Complex64],
        scratch: &mut [Complex64],
        values: &mut [f64],
    ) {
        self.real_forward(kernel, spectrum, scratch);
        for (value, spectrum) in values.iter_mut().zip(spectrum) {
            *value = 2.0 * spectrum.re - kernel[0];
        }
    }
}

/// Transforms and kernel of the non-periodic half-space.
struct FreeSpace<R = f64> {
    /// Number of columns and rows of cells.
    shape: [usize; 2],
    x: Axis<R>,
    y: Axis<R>,
    /// For every column, its rows; includes the normalisation of the transforms.
    kernel: Vec<R>,
}

impl FreeSpace {
    fn new(
        shape: [usize; 2],
        cell: [f64; 2],
        compliance: f64,
        layers: &[WeightedLayer],
        pool: Option<&ThreadPool>,
    ) -> Self {
        let potential = CellPotential::new(cell, layers);
        let potential = |[column, row]: [usize; 2]| {
            potential.at([column as f64 * cell[0], row as f64 * cell[1]])
        };
        Self::of_kernel(shape, compliance / PI, potential, pool)
    }

    /// Plans transforms with `factor` times a kernel as an even function of the number of cells along x and along y.
    fn of_kernel(
        shape: [usize; 2],
        factor: f64,
        kernel: impl Fn([usize; 2]) -> f64 + Sync,
        pool: Option<&ThreadPool>,
    ) -> Self {
        let [x, y] = shape.map(|count| Axis::new(quick_length(count)));
        let scale = factor / (2 * x.len() * y.len()) as f64;
        let rows = kernel_rows(shape, kernel, &x, pool);
        let kernel = kernel_columns(&rows, &x, &y, scale, pool);
        Self {
            shape,
            x,
            y,
            kernel,
        }
    }

    fn in_single_precision(&self) -> FreeSpace<f32> {
        let [x, y] = [&self.x, &self.y].map(|axis| Axis::new(axis.len()));
        FreeSpace {
            shape: self.shape,
            x,
            y,
            kernel: self.kernel.iter().map(|value| f32::of(*value)).collect(),
        }
    }
}

/// The kernel transformed along x, for every row of cells.
fn kernel_rows(
    shape: [usize; 2],
    kernel: impl Fn([usize; 2]) -> f64 + Sync,
    x: &Axis,
    pool: Option<&ThreadPool>,
) -> Vec<f64> {
    let mut rows = vec![0.0; x.len() * shape[1]];
    fill(
        pool,
        &mut rows,
        x.len(),
        1,
        || (),
        |(), row, values| {
            let kernel: Vec<f64> = (0..shape[0]).map(|column| kernel([column, row])).collect();
            let mut spectrum = vec![Complex64::default(); x.len()];
            let mut scratch = vec![Complex64::default(); x.scratch_len()];
            x.even_forward(&kernel, &mut spectrum, &mut scratch, values);
        },
    );
    rows
}

/// The kernel transformed along both directions, times `scale`: for every column, its rows.
fn kernel_columns(
    rows: &[f64],
    x: &Axis,
    y: &Axis,
    scale: f64,
    pool: Option<&ThreadPool>,
) -> Vec<f64> {
    let mut columns = vec![0.0; x.len() * y.len()];
    fill(
        pool,
        &mut columns,
        BLOCK_WIDTH * y.len(),
        1,
        || (),
        |(), block, values| {
            let count = rows.len() / x.len();
            let first = block * BLOCK_WIDTH;
            let width = values.len() / y.len();
            let mut kernel = vec![0.0; width * count];
            for (row, values) in rows.chunks_exact(x.len()).enumerate() {
                for (c, value) in values[first..first + width].iter().enumerate() {
                    kernel[c * count + row] = scale * value;
                }
            }
            let mut spectrum = vec![Complex64::default(); y.len()];
            let mut scratch = vec![Complex64::default(); y.scratch_len()];
            for (kernel, values) in kernel
                .chunks_exact(count)
                .zip(values.chunks_exact_mut(y.len()))
            {
                y.even_forward(kernel, &mut spectrum, &mut scratch, values);
            }
        },
    );
    columns
}

impl<R: Real> Transform for FreeSpace<R> {
    type Real = R;

    fn shape(&self) -> [usize; 2] {
        [self.x.len(), self.y.len()]
    }

    fn column_count(&self) -> usize {
        self.x.len()
    }

    fn row_forward(&self, row: &mut [R], spectrum: &mut [Complex<R>], scratch: &mut [Complex<R>]) {
        self.x.real_forward(row, spectrum, scratch);
    }

    fn row_back(&self, spectrum: &mut [Complex<R>], row: &mut [R], scratch: &mut [Complex<R>]) {
        self.x.back.process_with_scratch(spectrum, scratch);
        for ((value, spectrum), twist) in row.iter_mut().zip(spectrum).zip(&self.x.twist) {
            // The real part of the product with the conjugate.
            *value = spectrum.re * twist.re + spectrum.im * twist.im;
        }
    }

    fn convolve(&self, block: &mut ColumnBlock<'_, R>, work: &mut Workspace<R>) {
        let rows = self.y.len();
        let stride = line_stride(rows);
        let lines = &mut work.lines[..2 * block.width * stride];
        let (first, second) = lines.split_at_mut(block.width * stride);
        self.gather(block, first, second);
        let kernel = self.kernel[block.first * rows..].chunks_exact(rows);
        for ((first, second), kernel) in first
            .chunks_exact_mut(stride)
            .zip(second.chunks_exact_mut(stride))
            .zip(kernel)
        {
            let (first, second) = (&mut first[..rows], &mut second[..rows]);
            let Axis { forward, back, .. } = &self.y;
            forward.process_with_scratch(first, &mut work.scratch);
            multiply(first, kernel);
            back.process_with_scratch(first, &mut work.scratch);
            // The roots of the second factor are the conjugates of those of the first.
            back.process_with_scratch(second, &mut work.scratch);
            multiply(second, kernel);
            forward.process_with_scratch(second, &mut work.scratch);
        }
        self.scatter(block, first, second);
    }

    fn scratch_len(&self) -> usize {
        self.x.scratch_len().max(self.y.scratch_len())
    }

    fn columns_at_once(&self) -> usize {
        2
    }
}

impl<R: Real> FreeSpace<R> {
    /// Multiplies columns by the powers of the roots of the two factors; zero in rows that are not stored.
    fn gather(
        &self,
        block: &ColumnBlock<'_, R>,
        first: &mut [Complex<R>],
        second: &mut [Complex<R>],
    ) {
        let length = self.y.len();
        let stride = line_stride(length);
        let mut next = 0;
        for (&row, values) in block
            .rows
            .iter()
            .zip(block.values.chunks_exact(block.width))
        {
            clear_rows(first, stride, next..row);
            clear_rows(second, stride, next..row);
            next = row + 1;
            let twist = self.y.twist[row];
            let columns = first[row..]
                .iter_mut()
                .step_by(stride)
                .zip(second[row..].iter_mut().step_by(stride));
            for (value, (first, second)) in values.iter().zip(columns) {
                let (a, b) = (value.re * twist.re, value.im * twist.im);
                let (c, d) = (value.re * twist.im, value.im * twist.re);
                *first = Complex::new(a - b, d + c);
                *second = Complex::new(a + b, d - c);
            }
        }
        clear_rows(first, stride, next..length);
        clear_rows(second, stride, next..length);
    }

    /// Computes the stored rows from the sum of the contributions of the two factors.
    fn scatter(&self, block: &mut ColumnBlock<'_, R>, first: &[Complex<R>], second: &[Complex<R>]) {
        let stride = line_stride(self.y.len());
        for (&row, values) in block
            .rows
            .iter()
            .zip(block.values.chunks_exact_mut(block.width))
        {
            let twist = self.y.twist[row];
            let columns = first[row..]
                .iter()
                .step_by(stride)
                .zip(second[row..].iter().step_by(stride));
            for (value, (first, second)) in values.iter_mut().zip(columns) {
                let (sum, difference) = (first + second, first - second);
                // first conj(twist) + second twist
                *value = Complex::new(
                    sum.re * twist.re + difference.im * twist.im,
                    sum.im * twist.re - difference.re * twist.im,
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Grid;

    #[test]
    fn memory_is_what_was_estimated() {
        let grid = Grid::centred(300, 200, 1.0).unwrap();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(2)
            .build()
            .unwrap();
        let all = Cells::all(&grid);
        let striped = Cells::where_centre(&grid, |[_, y]| (y / 20.0).rem_euclid(1.0) < 0.6);
        for cells in [all, striped] {
            for (threads, pool) in [(1, None), (2, Some(&pool))] {
                let estimate = FreeSpaceConvolution::memory_estimate(&cells, threads) as f64;
                let operator = FreeSpaceConvolution::new(cells.clone(), 1.0, pool);
                let kernel = size_of_val(&*operator.convolution.transform().kernel);
                let stored = (kernel + operator.convolution.memory()) as f64;
                assert!(
                    (stored / estimate - 1.0).abs() < 0.03,
                    "{stored} {estimate}"
                );
            }
        }
    }

    #[test]
    fn lengths_are_quick_to_transform() {
        let lengths = [0, 1, 2, 7, 11, 13, 33, 121, 496, 1024, 1025].map(quick_length);
        assert_eq!(lengths, [1, 1, 2, 8, 12, 16, 36, 128, 512, 1024, 1080]);
    }
}
