//! Elements on a lattice of equal grids, one centred on each pillar.
//!
//! The displacement of a cell depends on the distance of the pressure in lattice vectors and in cells: a convolution over four indices,
//! computed by fast Fourier transforms over the cells of each grid and over the lattice. All pillars then have the same cells for any
//! pitch, which is impossible with a single grid over the whole pattern.

use super::operator::Operator;
use super::potential::CellPotential;
use crate::numerics::fft::{ComplexPlans, Real, RealPlans, smooth_size, transpose, transpose_part};
use crate::numerics::workers::{fill, map};
use crate::problem::layer::WeightedLayer;
use crate::problem::{Cells, Point};
use num_complex::{Complex, Complex64};
use rayon::ThreadPool;
use std::f64::consts::PI;

/// Number of complex values in all spectra below which threads are not worthwhile.
const PARALLEL_VALUES: usize = 20_000;

/// The non-periodic half-space under grids of equal cells at points of a lattice.
///
/// Unknowns are ordered by pillars, and for each pillar in the order of `cells`.
pub struct LatticeOfGrids<'a> {
    layout: Layout<'a>,
    exact: Convolution<f64>,
    /// The same for steps.
    rough: Convolution<f32>,
    /// Inverse of the transformed kernel of a single grid, including the normalisation.
    inverse: Vec<f64>,
}

/// The cells in the arrays that are transformed.
struct Layout<'a> {
    /// Indices of the cells of one grid in its padded array.
    places: Vec<usize>,
    /// Rows and columns of every pillar in the array of lattice indices.
    pillars: Vec<(usize, usize)>,
    shape: (usize, usize),
    pool: Option<&'a ThreadPool>,
}

/// The convolution in a precision.
struct Convolution<R: Real> {
    local: LocalTransform<R>,
    lattice: LatticeTransform<R>,
    /// Transformed kernel: for every local frequency, the padded lattice array; real, since the kernel is even. Includes the normalisation
    /// of all inverse transforms.
    kernel: Vec<R>,
    /// Local spectra: for every local frequency, all pillars.
    spectra: Vec<Complex<R>>,
}

/// Transforms over a grid padded to at least twice its size.
#[derive(Clone)]
struct LocalTransform<R: Real> {
    rows: usize,
    columns: usize,
    /// Number of complex columns of a real transform.
    half: usize,
    plans: RealPlans<R>,
}

/// Transforms over the array of lattice indices padded to at least twice its size.
#[derive(Clone)]
struct LatticeTransform<R: Real> {
    rows: usize,
    columns: usize,
    plans: ComplexPlans<R>,
}

impl<'a> LatticeOfGrids<'a> {
    /// `cells` are those of one grid; `pillars` the positions of the pillars in the array of lattice indices from (0, 0) on; `vectors` the
    /// lattice vectors (m) of the first and the second index; `compliance` that of the half-space, 1/Pa.
    #[must_use]
    pub fn new(
        cells: &Cells,
        pillars: Vec<(usize, usize)>,
        vectors: [Point; 2],
        compliance: f64,
        pool: Option<&'a ThreadPool>,
    ) -> Self {
        Self::on_layers(cells, pillars, vectors, compliance, &[], pool)
    }

    /// The same if bodies are layers, in the unit of length of the cells.
    pub(crate) fn on_layers(
        cells: &Cells,
        pillars: Vec<(usize, usize)>,
        vectors: [Point; 2],
        compliance: f64,
        layers: &[WeightedLayer],
        pool: Option<&'a ThreadPool>,
    ) -> Self {
        let extent =
            |pick: fn(&(usize, usize)) -> usize| pillars.iter().map(pick).max().unwrap_or(0) + 1;
        let shape = (extent(|p| p.0), extent(|p| p.1));
        let grid = cells.grid();
        let local = LocalTransform::new(
            smooth_size(2 * grid.rows() - 1),
            smooth_size(2 * grid.columns() - 1),
        );
        let lattice = LatticeTransform::new(padded(shape.0), padded(shape.1));
        let places = cells
            .positions()
            .map(|(column, row)| row * local.columns + column)
            .collect();
        let influence = Influence {
            potential: CellPotential::new(grid.cell(), layers),
            cell: grid.cell(),
            vectors,
            scale: compliance / PI,
        };
        let layout = Layout {
            places,
            pillars,
            shape,
            pool,
        };
        let (kernel, inverse) = layout.kernels(&local, &lattice, &influence);
        let rough = kernel.iter().map(|value| f32::of(*value)).collect();
        let (rows, columns) = (lattice.rows, lattice.columns);
        let rough = Convolution::new(
            LocalTransform::new(local.rows, local.columns),
            LatticeTransform::new(rows, columns),
            rough,
            layout.pillars.len(),
        );
        Self {
            exact: Convolution::new(local, lattice, kernel, layout.pillars.len()),
            rough,
            inverse,
            layout,
        }
    }

    /// Memory in bytes for this number of cells across each grid and this shape of the array of lattice indices.
    #[must_use]
    pub fn memory_estimate(cells_across: usize, pillars: usize, shape: (usize, usize)) -> usize {
        let across = smooth_size(2 * cells_across - 1);
        let frequencies = across * (across / 2 + 1);
        let lattice = padded(shape.0) * padded(shape.1);
        // The kernel, half of it as complex numbers during its construction, or in single precision after it; and the spectra in both precisions.
        frequencies * (16 * lattice + 24 * pillars)
    }

    /// Number of cells of one grid.
    #[must_use]
    pub fn cells_per_pillar(&self) -> usize {
        self.layout.places.len()
    }
}

impl LatticeOfGrids<'_> {
    fn check_lengths(&self, pressure: &[f64], displacement: &[f64]) {
        assert_eq!(pressure.len(), self.len(), "one pressure for every cell");
        assert_eq!(
            displacement.len(),
            self.len(),
            "one displacement for every cell"
        );
    }
}

impl<'a> Layout<'a> {
    /// Transforms the potential over the cells for every lattice offset, then over the lattice for every local frequency.
    /// Returns the result, and the inverse for a single grid.
    fn kernels(
        &self,
        local: &LocalTransform<f64>,
        lattice: &LatticeTransform<f64>,
        influence: &Influence,
    ) -> (Vec<f64>, Vec<f64>) {
        let frequencies = local.frequencies();
        let (rows, columns) = (lattice.rows, lattice.columns);
        let points = rows * columns;
        let normalisation = 1.0 / (points * local.rows * local.columns) as f64;
        let shape = self.shape;
        let pool = self.shared_pool(frequencies);
        let opposite = |place: usize| {
            let (row, column) = (place / columns, place % columns);
            ((rows - row) % rows) * columns + (columns - column) % columns
        };
        let opposites: Vec<usize> = (0..points).map(opposite).collect();
        // The spectrum at the opposite offset is the conjugate: half of them are sufficient.
        let offset_spectrum = |place: usize| -> Vec<Complex64> {
            let (row, column) = (place / columns, place % columns);
            let offset = (
                wrapped(row, shape.0, rows),
                wrapped(column, shape.1, columns),
            );
            match offset {
                (Some(i), Some(j)) if place <= opposites[place] => {
                    local.kernel_spectrum(influence, (i, j))
                }
                _ => Vec::new(),
            }
        };
        let spectra = map(pool, points, 1, || (), |(), place| offset_spectrum(place));
        let value = |place: usize, frequency: usize| {
            let half = place.min(opposites[place]);
            let value = spectra[half].get(frequency).copied().unwrap_or_default();
            if half == place { value } else { value.conj() }
        };
        let mut kernel = vec![0.0; frequencies * points];
        let work = || LatticeWork::new(lattice);
        fill(
            pool,
            &mut kernel,
            points,
            1,
            work,
            |work, frequency, kernel| {
                for (place, entry) in work.array.iter_mut().enumerate() {
                    *entry = value(place, frequency);
                }
                lattice.forward(rows, work);
                for (kernel, value) in kernel.iter_mut().zip(&work.array) {
                    *kernel = normalisation * value.re;
                }
            },
        );
        (kernel, local.inverse(&spectra[0]))
    }

    /// The threads, if they are worthwhile for this number of local frequencies.
    fn shared_pool(&self, frequencies: usize) -> Option<&'a ThreadPool> {
        self.pool.filter(|pool| {
            pool.current_num_threads() > 1 && frequencies * self.pillars.len() >= PARALLEL_VALUES
        })
    }
}

impl<R: Real> Convolution<R> {
    fn new(
        local: LocalTransform<R>,
        lattice: LatticeTransform<R>,
        kernel: Vec<R>,
        pillars: usize,
    ) -> Self {
        Self {
            spectra: vec![Complex::default(); local.frequencies() * pillars],
            local,
            lattice,
            kernel,
        }
    }

    /// The displacement of all cells.
    fn apply(&mut self, layout: &Layout<'_>, pressure: &[f64], displacement: &mut [f64]) {
        self.spread(layout, pressure);
        self.convolve(layout);
        self.collect(layout, displacement);
    }

    /// Computes the local spectra of all grids.
    fn spread(&mut self, layout: &Layout<'_>, values: &[f64]) {
        let count = layout.pillars.len();
        let (local, places) = (&self.local, &layout.places);
        let per_pillar = places.len();
        let frequencies = local.frequencies();
        // A few pillars at a time, whose spectra are then written next to each other.
        let mut block = vec![Complex::default(); BLOCK * frequencies];
        let mut work = LocalWork::new(local);
        for first in (0..count).step_by(BLOCK) {
            let size = BLOCK.min(count - first);
            for (k, spectrum) in block.chunks_exact_mut(frequencies).take(size).enumerate() {
                let pillar = first + k;
                work.array.fill(R::default());
                for (place, value) in places
                    .iter()
                    .zip(&values[pillar * per_pillar..(pillar + 1) * per_pillar])
                {
                    work.array[*place] = R::of(*value);
                }
                local.forward(&mut work, spectrum);
            }
            for frequency in 0..frequencies {
                for k in 0..size {
                    self.spectra[frequency * count + first + k] =
                        block[k * frequencies + frequency];
                }
            }
        }
    }

    /// Computes the values of all cells from the local spectra.
    fn collect(&mut self, layout: &Layout<'_>, values: &mut [f64]) {
        let count = layout.pillars.len();
        let (local, places) = (&self.local, &layout.places);
        let per_pillar = places.len();
        let frequencies = local.frequencies();
        let mut block = vec![Complex::default(); BLOCK * frequencies];
        let mut work = LocalWork::new(local);
        for first in (0..count).step_by(BLOCK) {
            let size = BLOCK.min(count - first);
            for frequency in 0..frequencies {
                for k in 0..size {
                    block[k * frequencies + frequency] =
                        self.spectra[frequency * count + first + k];
                }
            }
            for (k, spectrum) in block.chunks_exact_mut(frequencies).take(size).enumerate() {
                let pillar = first + k;
                local.backward(spectrum, &mut work);
                for (place, value) in places
                    .iter()
                    .zip(&mut values[pillar * per_pillar..(pillar + 1) * per_pillar])
                {
                    *value = work.array[*place].double();
                }
            }
        }
    }

    /// Convolves over the lattice, frequency by frequency.
    fn convolve(&mut self, layout: &Layout<'_>) {
        let pool = layout.shared_pool(self.local.frequencies());
        let points = self.lattice.rows * self.lattice.columns;
        let Layout { pillars, shape, .. } = layout;
        let (lattice, kernel) = (&self.lattice, &self.kernel);
        let one = |work: &mut LatticeWork<R>, frequency: usize, spectrum: &mut [Complex<R>]| {
            work.array.fill(Complex::default());
            for ((row, column), value) in pillars.iter().zip(spectrum.iter()) {
                work.array[row * lattice.columns + column] = *value;
            }
            lattice.forward(shape.0, work);
            let kernel = kernel[frequency * points..].iter();
            for (value, kernel) in work.array.iter_mut().zip(kernel) {
                *value = Complex::new(value.re * *kernel, value.im * *kernel);
            }
            lattice.backward(shape.0, work);
            for ((row, column), value) in pillars.iter().zip(spectrum.iter_mut()) {
                *value = work.array[row * lattice.columns + column];
            }
        };
        let work = || LatticeWork::new(lattice);
        fill(pool, &mut self.spectra, pillars.len(), 1, work, one);
    }
}

/// Number of grids whose spectra are transposed together.
const BLOCK: usize = 8;

fn padded(extent: usize) -> usize {
    if extent == 1 {
        1
    } else {
        smooth_size(2 * extent - 1)
    }
}

/// The signed offset of a position in a padded array; `None` in the padding.
fn wrapped(place: usize, extent: usize, padded: usize) -> Option<i64> {
    if place < extent {
        Some(place as i64)
    } else if place + extent > padded {
        Some(place as i64 - padded as i64)
    } else {
        None
    }
}

impl Operator for LatticeOfGrids<'_> {
    fn len(&self) -> usize {
        self.layout.places.len() * self.layout.pillars.len()
    }

    fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        self.check_lengths(pressure, displacement);
        self.exact.apply(&self.layout, pressure, displacement);
    }

    fn apply_to_step(&mut self, step: &[f64], displacement: &mut [f64]) {
        self.check_lengths(step, displacement);
        self.rough.apply(&self.layout, step, displacement);
    }

    /// Preconditioner of every grid separately, with periodic wrap-around.
    fn precondition(&mut self, residual: &[f64], direction: &mut [f64]) {
        let (local, places) = (&self.exact.local, &self.layout.places);
        let mut work = LocalWork::new(local);
        let mut spectrum = vec![Complex64::default(); local.frequencies()];
        for (residual, direction) in residual
            .chunks_exact(places.len())
            .zip(direction.chunks_exact_mut(places.len()))
        {
            if residual.iter().all(|value| *value == 0.0) {
                direction.fill(0.0);
                continue;
            }
            work.array.fill(0.0);
            for (place, value) in places.iter().zip(residual) {
                work.array[*place] = *value;
            }
            local.forward(&mut work, &mut spectrum);
            for (value, inverse) in spectrum.iter_mut().zip(&self.inverse) {
                *value *= inverse;
            }
            local.backward(&mut spectrum, &mut work);
            for (place, value) in places.iter().zip(direction) {
                *value = work.array[*place];
            }
        }
    }
}

/// The potential of one cell at another, by lattice and cell offset.
struct Influence {
    potential: CellPotential,
    cell: [f64; 2],
    vectors: [Point; 2],
    scale: f64,
}

struct LocalWork<R: Real> {
    array: Vec<R>,
    row: Vec<Complex<R>>,
    line: Vec<Complex<R>>,
    scratch: Vec<Complex<R>>,
}

impl<R: Real> LocalWork<R> {
    fn new(local: &LocalTransform<R>) -> Self {
        let scratch = local.plans.scratch_len();
        Self {
            array: vec![R::default(); local.rows * local.columns],
            row: vec![Complex::default(); local.rows * local.half],
            line: vec![Complex::default(); local.rows * local.half],
            scratch: vec![Complex::default(); scratch],
        }
    }
}

impl<R: Real> LocalTransform<R> {
    fn new(rows: usize, columns: usize) -> Self {
        Self {
            rows,
            columns,
            half: columns / 2 + 1,
            plans: RealPlans::new(rows, columns),
        }
    }

    fn frequencies(&self) -> usize {
        self.half * self.rows
    }

    /// Spectrum of `work.array`, which is overwritten; stored by columns.
    fn forward(&self, work: &mut LocalWork<R>, spectrum: &mut [Complex<R>]) {
        for (values, row) in work
            .array
            .chunks_exact_mut(self.columns)
            .zip(work.row.chunks_exact_mut(self.half))
        {
            if values.iter().all(|value| *value == R::default()) {
                row.fill(Complex::default());
                continue;
            }
            let done = self
                .plans
                .row
                .process_with_scratch(values, row, &mut work.scratch);
            debug_assert!(done.is_ok());
        }
        transpose(&work.row, spectrum, self.rows, self.half);
        self.plans
            .column
            .process_with_scratch(spectrum, &mut work.scratch);
    }

    /// `work.array` from its spectrum, which is overwritten; not normalised.
    fn backward(&self, spectrum: &mut [Complex<R>], work: &mut LocalWork<R>) {
        self.plans
            .column_back
            .process_with_scratch(spectrum, &mut work.scratch);
        transpose(spectrum, &mut work.line, self.half, self.rows);
        for (row, values) in work
            .line
            .chunks_exact_mut(self.half)
            .zip(work.array.chunks_exact_mut(self.columns))
        {
            // The imaginary parts of the first and, for even sizes, the last coefficient are rounding errors.
            row[0].im = R::default();
            if self.columns.is_multiple_of(2) {
                row[self.half - 1].im = R::default();
            }
            let done = self
                .plans
                .row_back
                .process_with_scratch(row, values, &mut work.scratch);
            debug_assert!(done.is_ok());
        }
    }
}

impl LocalTransform<f64> {
    /// Inverse of a kernel's spectrum, including the normalisation of the transforms.
    ///
    /// The kernel is truncated at the end of the grid, so that small values of its spectrum may have any sign; they are replaced by a
    /// positive lower bound.
    fn inverse(&self, spectrum: &[Complex64]) -> Vec<f64> {
        let largest = spectrum.iter().map(|k| k.re.abs()).fold(0.0, f64::max);
        let normalisation = 1.0 / (self.rows * self.columns) as f64;
        spectrum
            .iter()
            .map(|k| normalisation / k.re.abs().max(1e-6 * largest))
            .collect()
    }

    /// Spectrum of the potential at all cell offsets of grids separated by this number of lattice vectors.
    fn kernel_spectrum(&self, influence: &Influence, (i, j): (i64, i64)) -> Vec<Complex64> {
        let mut work = LocalWork::new(self);
        let [a, b] = influence.vectors;
        let (i, j) = (i as f64, j as f64);
        let origin = [a[0] * i + b[0] * j, a[1] * i + b[1] * j];
        let (row_extent, column_extent) = (self.rows.div_ceil(2), self.columns.div_ceil(2));
        for row in 0..self.rows {
            let Some(v) = wrapped(row, row_extent, self.rows) else {
                continue;
            };
            for column in 0..self.columns {
                let Some(u) = wrapped(column, column_extent, self.columns) else {
                    continue;
                };
                work.array[row * self.columns + column] = influence.scale
                    * influence.potential.at([
                        origin[0] + u as f64 * influence.cell[0],
                        origin[1] + v as f64 * influence.cell[1],
                    ]);
            }
        }
        let mut spectrum = vec![Complex64::default(); self.frequencies()];
        self.forward(&mut work, &mut spectrum);
        spectrum
    }
}

struct LatticeWork<R: Real> {
    array: Vec<Complex<R>>,
    line: Vec<Complex<R>>,
    scratch: Vec<Complex<R>>,
}

impl<R: Real> LatticeWork<R> {
    fn new(lattice: &LatticeTransform<R>) -> Self {
        let scratch = lattice.plans.scratch_len();
        Self {
            array: vec![Complex::default(); lattice.rows * lattice.columns],
            line: vec![Complex::default(); lattice.rows * lattice.columns],
            scratch: vec![Complex::default(); scratch],
        }
    }
}

impl<R: Real> LatticeTransform<R> {
    fn new(rows: usize, columns: usize) -> Self {
        Self {
            rows,
            columns,
            plans: ComplexPlans::new(rows, columns),
        }
    }

    /// Transforms `work.array`, of which only the first `used` rows are non-zero. The result is transposed.
    fn forward(&self, used: usize, work: &mut LatticeWork<R>) {
        self.plans
            .row
            .process_with_scratch(&mut work.array[..used * self.columns], &mut work.scratch);
        let part = [used, self.columns];
        transpose_part(&work.array, self.columns, &mut work.line, self.rows, part);
        for line in work.line.chunks_exact_mut(self.rows) {
            line[used..].fill(Complex::default());
        }
        self.plans
            .column
            .process_with_scratch(&mut work.line, &mut work.scratch);
        std::mem::swap(&mut work.array, &mut work.line);
    }

    /// Inverse of [`Self::forward`] for the first `used` rows; not normalised.
    fn backward(&self, used: usize, work: &mut LatticeWork<R>) {
        self.plans
            .column_back
            .process_with_scratch(&mut work.array, &mut work.scratch);
        let part = [self.columns, used];
        transpose_part(&work.array, self.rows, &mut work.line, self.columns, part);
        self.plans
            .row_back
            .process_with_scratch(&mut work.line[..used * self.columns], &mut work.scratch);
        std::mem::swap(&mut work.array, &mut work.line);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::elements::Rectangle;
    use crate::problem::Grid;

    const COMPLIANCE: f64 = 0.7;
    const VECTORS: [Point; 2] = [[3.0, 1.6], [2.9, -1.7]];

    fn numbers(count: usize) -> Vec<f64> {
        (0..count).map(|k| (1.3 * k as f64).sin()).collect()
    }

    fn cells(across: usize) -> Cells {
        let grid = Grid::centred(across, across, 2.0 / across as f64).unwrap();
        Cells::where_centre(&grid, |[x, y]| x.hypot(y) < 1.0)
    }

    fn places() -> Vec<Vec<(usize, usize)>> {
        vec![
            vec![(0, 0)],
            vec![(0, 0), (0, 1), (1, 0), (2, 3)],
            (0..5).flat_map(|i| (0..3).map(move |j| (i, j))).collect(),
        ]
    }

    #[test]
    fn agrees_with_direct_summation() {
        for across in [4, 5, 8] {
            let cells = cells(across);
            let [size, _] = cells.grid().cell();
            let rectangle = Rectangle::new(size, size);
            for pillars in places() {
                let mut operator =
                    LatticeOfGrids::new(&cells, pillars.clone(), VECTORS, COMPLIANCE, None);
                let centres: Vec<Point> = pillars
                    .iter()
                    .flat_map(|(i, j)| {
                        let (i, j) = (*i as f64, *j as f64);
                        cells.centres().map(move |[x, y]| {
                            [
                                x + i * VECTORS[0][0] + j * VECTORS[1][0],
                                y + i * VECTORS[0][1] + j * VECTORS[1][1],
                            ]
                        })
                    })
                    .collect();
                assert_eq!(operator.len(), centres.len());
                let pressure = numbers(centres.len());
                let mut displacement = vec![0.0; centres.len()];
                operator.apply(&pressure, &mut displacement);
                for ([x, y], displacement) in centres.iter().zip(&displacement) {
                    let sum: f64 = centres
                        .iter()
                        .zip(&pressure)
                        .map(|([u, v], p)| p * rectangle.potential(x - u, y - v))
                        .sum();
                    let error = displacement - COMPLIANCE / PI * sum;
                    assert!(error.abs() < 1e-13, "{error:e}");
                }
            }
        }
    }

    #[test]
    fn preconditioner_is_nearly_the_inverse_on_one_pillar() {
        // Symmetric and positive; the product with the operator is close to the identity.
        let cells = cells(12);
        let mut operator = LatticeOfGrids::new(&cells, vec![(0, 0)], VECTORS, COMPLIANCE, None);
        let (a, b) = (numbers(operator.len()), vec![1.0; operator.len()]);
        let mut apply = |values: &[f64]| {
            let mut result = vec![0.0; values.len()];
            operator.precondition(values, &mut result);
            result
        };
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let (pa, pb) = (apply(&a), apply(&b));
        assert!((dot(&a, &pb) / dot(&b, &pa) - 1.0).abs() < 1e-12);
        assert!(dot(&a, &pa) > 0.0 && dot(&b, &pb) > 0.0);
        for values in [a, b] {
            let mut response = vec![0.0; values.len()];
            operator.apply(&values, &mut response);
            let mut back = vec![0.0; values.len()];
            operator.precondition(&response, &mut back);
            let ratio = dot(&back, &values) / dot(&values, &values);
            assert!((0.3..3.0).contains(&ratio), "{ratio}");
        }
    }

    #[test]
    fn threads_change_nothing() {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(2)
            .build()
            .unwrap();
        let cells = cells(16);
        let pillars: Vec<_> = (0..9).flat_map(|i| (0..9).map(move |j| (i, j))).collect();
        let run = |pool| {
            let mut operator =
                LatticeOfGrids::new(&cells, pillars.clone(), VECTORS, COMPLIANCE, pool);
            let pressure = numbers(operator.len());
            let mut displacement = vec![0.0; operator.len()];
            operator.apply(&pressure, &mut displacement);
            displacement
        };
        assert_eq!(run(None), run(Some(&pool)));
    }
}
