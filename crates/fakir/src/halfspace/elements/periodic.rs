//! A periodic half-space by fast Fourier transform.

use super::convolution::{
    Bounds, ColumnBlock, Convolution, Transform, Workspace, line_stride, memory_estimate, multiply,
};
use super::operator::Operator;
use crate::halfspace::layer::LayerResponse;
use crate::numerics::cosine::CosinePlans;
use crate::numerics::fft::{Real, RealPlans, quick_length};
use crate::problem::Cells;
use crate::problem::layer::WeightedLayer;
use num_complex::Complex;
use rayon::ThreadPool;
use std::f64::consts::PI;
use std::sync::Arc;

/// The operator of a half-space with a grid that is periodic along x and y.
///
/// A pressure of wave vector `q` causes the displacement `2 c p/|q|` (Johnson, Contact Mechanics, section 13.2; `2 pi/|q|` is the transform
/// of `1/|x|`, and the factor of the potential is `c/pi`). The waves are those that the grid resolves, with the exact `|q|`, as is usual
/// for periodic contacts: the pressure is the trigonometric interpolant of the values on the cells. This differs from the periodic sum of
/// Love's rectangles, which include all shorter waves; the two converge to each other as the cells become small.
///
/// The displacement of a half-space under a mean pressure is unbounded. The mean displacement is therefore set to zero: displacements are
/// relative to the mean of the period.
pub struct PeriodicConvolution<'p> {
    convolution: Convolution<'p, Periodic>,
}

impl<'p> PeriodicConvolution<'p> {
    /// The operator on `cells`, whose grid is the period, of a half-space with the given `compliance` in 1/Pa. The work is shared between
    /// the threads of `pool`.
    ///
    /// Any size is supported; sizes of the form `2^a 3^b 5^c` are fastest.
    #[must_use]
    pub fn new(cells: Cells, compliance: f64, pool: Option<&'p ThreadPool>) -> Self {
        Self::on_layers(cells, compliance, &[], pool)
    }

    /// The same if bodies are layers, in the unit of length of the cells: the displacement of a wave is multiplied by `Phi(|q|)`. The mean
    /// pressure compresses a layer uniformly.
    pub(crate) fn on_layers(
        cells: Cells,
        compliance: f64,
        layers: &[WeightedLayer],
        pool: Option<&'p ThreadPool>,
    ) -> Self {
        let grid = cells.grid();
        let shape = [grid.columns(), grid.rows()];
        let responses: Vec<_> = layers
            .iter()
            .map(|layer| (layer, LayerResponse::of(layer)))
            .collect();
        let mut periodic = Periodic::new(shape, grid.cell(), |[x, y]| {
            let wave = x.hypot(y);
            let of_layers = responses
                .iter()
                .map(|(layer, response)| layer.weight * response.deficit(wave * layer.thickness));
            2.0 * compliance / wave * (1.0 + of_layers.sum::<f64>())
        });
        let squeezed = layers.iter().map(WeightedLayer::squeeze);
        let count = (shape[0] * shape[1]) as f64;
        periodic.kernel[0] = compliance * squeezed.sum::<f64>() / count;
        Self {
            convolution: Convolution::new(cells, [0, 0], Arc::new(periodic), pool),
        }
    }

    /// The operator on other cells of the same grid, sharing the kernel.
    pub(super) fn on_cells(&self, cells: Cells) -> Self {
        let (transform, pool) = (self.convolution.transform(), self.convolution.pool());
        Self {
            convolution: Convolution::new(cells, [0, 0], Arc::clone(transform), pool),
        }
    }

    /// The same in single precision, if the cells extend over more than half of the period.
    pub(super) fn in_single_precision(&self) -> Option<Periodic<f32>> {
        let cells = self.cells();
        let [columns, rows] = Bounds::of(cells).shape;
        let wide = 2 * columns * rows > cells.grid().cell_count();
        wide.then(|| self.convolution.transform().in_single_precision())
    }

    /// Approximate memory in bytes of the operator on `cells`, without the cells themselves, for `threads` threads.
    #[must_use]
    pub fn memory_estimate(cells: &Cells, threads: usize) -> usize {
        let grid = cells.grid();
        let columns = grid.columns() / 2 + 1;
        let stored = cells.segments().chunk_by(|a, b| a.row == b.row).count();
        let spectrum = memory_estimate(columns, grid.rows(), stored, 1, threads);
        size_of::<f64>() * columns * (grid.rows() / 2 + 1) + spectrum
    }
}

impl PeriodicConvolution<'_> {
    /// The cells on which the operator acts.
    #[must_use]
    pub fn cells(&self) -> &Cells {
        self.convolution.cells()
    }
}

impl Operator for PeriodicConvolution<'_> {
    fn len(&self) -> usize {
        self.cells().len()
    }

    fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        self.convolution.apply(pressure, displacement);
    }
}

/// An operator with the inverse of the periodic half-space as its preconditioner.
///
/// On the non-periodic half-space, the preconditioner is inaccurate only for the longest waves, so that the number of iterations hardly
/// increases with the number of cells (J. Zhao, E. A. H. Vollebregt, C. W. Oosterlee, J. Comput. Phys. 292, 1 (2015) use a similar
/// preconditioner for one contact).
///
/// `R` is the precision of the preconditioner.
#[allow(private_bounds, reason = "only the precisions that are transformed")]
pub struct Preconditioned<'p, O, R: Real = f64> {
    operator: O,
    inverse: PeriodicInverse<'p, R>,
    /// The operator in single precision, with the shape of the inverse.
    rough: Option<Periodic<R>>,
}

/// The inverse of the periodic half-space, up to a factor, on the smallest grid that contains the cells: multiplication by the wave number.
pub(crate) struct PeriodicInverse<'p, R: Real = f64> {
    convolution: Convolution<'p, Periodic<R>>,
}

impl<'p, R: Real> PeriodicInverse<'p, R> {
    /// The inverse for displacements at cell centres: the wave number.
    pub(crate) fn new(cells: Cells, pool: Option<&'p ThreadPool>) -> Self {
        Self::of(cells, |[x, y]| x.hypot(y), pool)
    }

    /// The inverse for mean displacements of cells under constant pressures on them, on a half-space of unit compliance.
    pub(crate) fn of_means(cells: Cells, pool: Option<&'p ThreadPool>) -> Self {
        let cell = cells.grid().cell();
        Self::of(cells, |wave| of_means(wave, cell).recip(), pool)
    }

    /// The same for cells with mirror images along x and along y at the corner of their grid.
    pub(crate) fn of_mirrored_means(cells: Cells, pool: Option<&'p ThreadPool>) -> Self {
        let cell = cells.grid().cell();
        let Bounds { first, shape, .. } = Bounds::of(&cells);
        let shape = [0, 1].map(|k| quick_length(first[k] + shape[k]));
        let inverse = Periodic::mirrored(shape, cell, |wave| of_means(wave, cell).recip());
        Self {
            convolution: Convolution::new(cells, [0, 0], Arc::new(inverse), pool),
        }
    }

    fn of(cells: Cells, of_wave: impl Fn([f64; 2]) -> f64, pool: Option<&'p ThreadPool>) -> Self {
        let bounds = Bounds::of(&cells);
        let shape = bounds.shape.map(quick_length);
        let inverse = Periodic::new(shape, cells.grid().cell(), of_wave);
        Self {
            convolution: Convolution::new(cells, bounds.first, Arc::new(inverse), pool),
        }
    }

    /// Computes a pressure that approximately causes this displacement.
    pub(crate) fn apply(&mut self, displacement: &[f64], pressure: &mut [f64]) {
        self.convolution.apply(displacement, pressure);
    }
}

impl<'p, O: Operator> Preconditioned<'p, O> {
    /// Preconditions `operator`, which acts on `cells`.
    ///
    /// # Panics
    /// If the number of unknowns of the operator is not the number of cells.
    #[must_use]
    pub fn new(operator: O, cells: Cells, pool: Option<&'p ThreadPool>) -> Self {
        assert_eq!(operator.len(), cells.len(), "the cells of the operator");
        Self {
            operator,
            inverse: PeriodicInverse::new(cells, pool),
            rough: None,
        }
    }

    /// Approximate additional memory in bytes.
    #[must_use]
    pub fn memory_estimate(cells: &Cells) -> usize {
        let bounds = Bounds::of(cells);
        let [columns, rows] = bounds.shape.map(quick_length);
        let spectrum = memory_estimate(columns / 2 + 1, rows, bounds.stored_rows, 1, 1);
        size_of::<f64>() * (columns / 2 + 1) * (rows / 2 + 1) + spectrum
    }
}

impl<'p, O: Operator> Preconditioned<'p, O, f32> {
    /// Creates the operator with a preconditioner in single precision, which takes half of the memory and about half of the time. The
    /// accuracy of the solution is the same, since residuals are computed with the operator.
    ///
    /// If the operator is also available in single precision, it is used for [steps](Operator::apply_to_step), and shares the transforms
    /// and the memory of the preconditioner.
    pub(super) fn in_single_precision(
        operator: O,
        cells: Cells,
        rough: Option<Periodic<f32>>,
        pool: Option<&'p ThreadPool>,
    ) -> Self {
        assert_eq!(operator.len(), cells.len(), "the cells of the operator");
        let inverse = match &rough {
            Some(rough) => {
                let inverse = rough.with_kernel(cells.grid().cell(), |[x, y]| x.hypot(y));
                PeriodicInverse {
                    convolution: Convolution::new(cells, [0, 0], Arc::new(inverse), pool),
                }
            }
            None => PeriodicInverse::new(cells, pool),
        };
        Self {
            operator,
            inverse,
            rough,
        }
    }
}

impl<O: Operator, R: Real> Operator for Preconditioned<'_, O, R> {
    fn len(&self) -> usize {
        self.operator.len()
    }

    fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        self.operator.apply(pressure, displacement);
    }

    fn apply_to_step(&mut self, step: &[f64], displacement: &mut [f64]) {
        match &self.rough {
            Some(rough) => self.inverse.convolution.apply_by(rough, step, displacement),
            None => self.operator.apply_to_step(step, displacement),
        }
    }

    fn precondition(&mut self, residual: &[f64], direction: &mut [f64]) {
        self.inverse.apply(residual, direction);
    }
}

/// Mean displacement of cells due to constant pressures on them that follow a wave, without the aliased waves: `2/|q|` times the squared
/// mean of a wave over a cell in each direction.
fn of_means(wave: [f64; 2], cell: [f64; 2]) -> f64 {
    const ALIASES: [f64; 3] = [0.0, -1.0, 1.0];
    let along = |k: usize| {
        let sine = (0.5 * wave[k] * cell[k]).sin();
        ALIASES.map(|alias| {
            let wave = wave[k] + 2.0 * PI * alias / cell[k];
            let phase = 0.5 * wave * cell[k];
            let mean = if phase.abs() > 0.0 { sine / phase } else { 1.0 };
            (wave, mean * mean)
        })
    };
    let [of_x, of_y] = [along(0), along(1)];
    let pairs = of_x.iter().flat_map(|x| of_y.iter().map(move |y| (x, y)));
    pairs
        .map(|((x, of_x), (y, of_y))| {
            let square = x * x + y * y;
            2.0 * of_x * of_y / square.sqrt()
        })
        .sum()
}

/// Transforms and kernel of the periodic half-space.
pub(super) struct Periodic<R = f64> {
    shape: [usize; 2],
    plans: Plans<R>,
    /// For every column of the transform, its rows without mirror images, `rows/2 + 1`; for a quarter of the period: for both real columns
    /// of every complex column, all rows. Includes the normalisation of the transforms.
    kernel: Vec<R>,
}

#[derive(Clone)]
enum Plans<R> {
    /// Plans for the whole period.
    Whole(RealPlans<R>),
    /// Plans for a quarter of the period; the others are mirror images.
    Mirrored(CosinePlans<R>),
}

impl<R: Real> Periodic<R> {
    /// Plans transforms with a [`kernel`] as a function of the wave vector.
    fn new(shape: [usize; 2], cell: [f64; 2], of_wave: impl Fn([f64; 2]) -> f64) -> Self {
        Self {
            shape,
            plans: Plans::Whole(RealPlans::new(shape[1], shape[0])),
            kernel: kernel(shape, cell, of_wave),
        }
    }

    /// The same for a quarter of the period.
    fn mirrored(shape: [usize; 2], cell: [f64; 2], of_wave: impl Fn([f64; 2]) -> f64) -> Self {
        let [columns, rows] = shape;
        let plans = CosinePlans::new(rows, columns);
        let whole: Vec<R> = kernel(shape.map(|length| 2 * length), cell, of_wave);
        let own = |column: usize| &whole[column * (rows + 1)..][..rows];
        let kernel = (0..plans.column_count())
            .flat_map(|complex| [complex, columns - complex])
            .flat_map(|column| own(column).iter().copied());
        Self {
            shape,
            kernel: kernel.collect(),
            plans: Plans::Mirrored(plans),
        }
    }

    /// The same transforms with another kernel.
    fn with_kernel(&self, cell: [f64; 2], of_wave: impl Fn([f64; 2]) -> f64) -> Self {
        Self {
            shape: self.shape,
            plans: self.plans.clone(),
            kernel: kernel(self.shape, cell, of_wave),
        }
    }

    fn in_single_precision(&self) -> Periodic<f32> {
        let [columns, rows] = self.shape;
        Periodic {
            shape: self.shape,
            plans: match self.plans {
                Plans::Whole(_) => Plans::Whole(RealPlans::new(rows, columns)),
                Plans::Mirrored(_) => Plans::Mirrored(CosinePlans::new(rows, columns)),
            },
            kernel: self
                .kernel
                .iter()
                .map(|value| f32::of(value.double()))
                .collect(),
        }
    }
}

/// A function of the wave vector; the mean is evaluated at half the smallest wave vector. Includes the normalisation of the transforms.
fn kernel<R: Real>(
    [columns, rows]: [usize; 2],
    [width, height]: [f64; 2],
    of_wave: impl Fn([f64; 2]) -> f64,
) -> Vec<R> {
    let wave = |index: usize, period: f64| 2.0 * PI * index as f64 / period;
    let longest = (width * columns as f64).max(height * rows as f64);
    let smallest = PI / longest;
    let scale = 1.0 / (columns * rows) as f64;
    (0..=columns / 2)
        .flat_map(|column| (0..=rows / 2).map(move |row| (column, row)))
        .map(|(column, row)| {
            let x = wave(column, width * columns as f64);
            let y = wave(row, height * rows as f64);
            let wave = if (column, row) == (0, 0) {
                [smallest, 0.0]
            } else {
                [x, y]
            };
            R::of(scale * of_wave(wave))
        })
        .collect()
}

/// Multiplies a transformed column by a kernel of half of its rows; the others are mirror images.
fn multiply_whole<R: Real>(line: &mut [Complex<R>], kernel: &[R]) {
    let (low, high) = line.split_at_mut(kernel.len());
    multiply(low, kernel);
    for (value, kernel) in high.iter_mut().rev().zip(&kernel[1..]) {
        *value = *value * *kernel;
    }
}

impl<R: Real> Transform for Periodic<R> {
    type Real = R;

    fn shape(&self) -> [usize; 2] {
        self.shape
    }

    fn column_count(&self) -> usize {
        self.shape[0] / 2 + 1
    }

    fn row_forward(&self, row: &mut [R], spectrum: &mut [Complex<R>], scratch: &mut [Complex<R>]) {
        match &self.plans {
            Plans::Whole(plans) => plans.row_forward(row, spectrum, scratch),
            Plans::Mirrored(plans) => plans.row_forward(row, spectrum, scratch),
        }
    }

    fn row_back(&self, spectrum: &mut [Complex<R>], row: &mut [R], scratch: &mut [Complex<R>]) {
        match &self.plans {
            Plans::Whole(plans) => plans.row_back(spectrum, row, scratch),
            Plans::Mirrored(plans) => plans.row_back(spectrum, row, scratch),
        }
    }

    fn convolve(&self, block: &mut ColumnBlock<'_, R>, work: &mut Workspace<R>) {
        let rows = self.shape[1];
        let stride = line_stride(rows);
        let lines = &mut work.lines[..block.width * stride];
        match &self.plans {
            Plans::Whole(plans) => {
                block.read(lines, stride, rows);
                let half = rows / 2 + 1;
                let kernel = self.kernel[block.first * half..].chunks_exact(half);
                for (line, kernel) in lines.chunks_exact_mut(stride).zip(kernel) {
                    let line = &mut line[..rows];
                    plans.column.process_with_scratch(line, &mut work.scratch);
                    multiply_whole(line, kernel);
                    let back = &plans.column_back;
                    back.process_with_scratch(line, &mut work.scratch);
                }
                block.write(lines, stride);
            }
            Plans::Mirrored(plans) => {
                block.read_to(lines, stride, |row| plans.place_of(row));
                let kernel = self.kernel[2 * block.first * rows..].chunks_exact(2 * rows);
                let (first, second) = work.reals.split_at_mut(rows);
                for (line, kernel) in lines.chunks_exact_mut(stride).zip(kernel) {
                    let line = &mut line[..rows];
                    let parts = [&mut *first, &mut *second];
                    plans.column_forward(line, parts, &mut work.scratch);
                    let (of_first, of_second) = kernel.split_at(rows);
                    for (value, kernel) in first.iter_mut().zip(of_first) {
                        *value = *value * *kernel;
                    }
                    for (value, kernel) in second.iter_mut().zip(of_second) {
                        *value = *value * *kernel;
                    }
                    plans.column_back([&*first, &*second], line, &mut work.scratch);
                }
                block.write_from(lines, stride, |row| plans.place_of(row));
            }
        }
    }

    fn scratch_len(&self) -> usize {
        match &self.plans {
            Plans::Whole(plans) => plans.scratch_len(),
            Plans::Mirrored(plans) => plans.scratch_len(),
        }
    }

    fn columns_at_once(&self) -> usize {
        1
    }

    fn real_count(&self) -> usize {
        match &self.plans {
            Plans::Whole(_) => 0,
            Plans::Mirrored(_) => 2 * self.shape[1],
        }
    }
}
