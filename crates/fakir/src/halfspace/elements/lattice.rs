//! Elements on a lattice of equal grids, one centred on each pillar.
//!
//! The displacement of a cell depends on the distance of the pressure in lattice vectors and in cells: a convolution over four indices,
//! computed by fast Fourier transforms over the cells of each grid and over the lattice. All pillars then have the same cells for any
//! pitch, which is impossible with a single grid over the whole pattern.
//!
//! Between distant pillars the potential is smooth. If fewer nodes than cells are sufficient for it, the pressures on each grid are replaced by
//! charges on these nodes, and displacements are interpolated from them by polynomials: the convolution over the lattice then has fewer
//! local frequencies, and the displacement of every grid by its own pressures is added.

use super::operator::Operator;
use super::potential::CellPotential;
use crate::numerics::fft::{ComplexPlans, Real, RealPlans, smooth_size, transpose, transpose_part};
use crate::numerics::workers::{fill, map};
use crate::problem::layer::WeightedLayer;
use crate::problem::point::combined;
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
    /// Approximate inverse on every grid alone.
    inverse: OnGrids<f64>,
    coarse: CoarseInverse,
}

/// Largest error of the displacements that pillars cause on their neighbours, by interpolation, relative to these displacements: in exact products,
/// far below the discretisation error, and in steps.
const INTERPOLATION: [f64; 2] = [1e-7, 1e-5];

/// The cells in the arrays that are transformed.
struct Layout<'a> {
    /// Indices of the cells of one grid in its array, and in the padded one.
    cells: Vec<usize>,
    places: Vec<usize>,
    /// Rows and columns of every pillar in the array of lattice indices.
    pillars: Vec<(usize, usize)>,
    shape: (usize, usize),
    pool: Option<&'a ThreadPool>,
}

/// The convolution in a precision.
struct Convolution<R: Real> {
    /// Over the cells of the grids, or over their nodes.
    local: LocalTransform<R>,
    nodes: Option<Nodes<R>>,
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

/// Convolution of every grid with itself.
struct OnGrids<R: Real> {
    local: LocalTransform<R>,
    /// Transformed kernel, including the normalisation.
    kernel: Vec<R>,
}

/// Nodes of grids, in rows and columns, between which the grids interact.
struct Nodes<R: Real> {
    /// Rows and columns of nodes, and of cells.
    shape: [usize; 2],
    cells: [usize; 2],
    /// The polynomial of every row of nodes at all rows of cells, and the polynomials of all columns of nodes at every column of cells.
    of_rows: Vec<R>,
    of_columns: Vec<R>,
    own: OnGrids<R>,
}

/// Correction of the inverse on every grid alone for the interaction of the forces of the grids.
///
/// If `B` is that inverse and `K` the displacement of grids by forces on others, the operator is about `B^-1 + 1 K 1'`, with the inverse
/// `B - B 1 (K^-1 + 1' B 1)^-1 1' B` (M. A. Woodbury, Inverting modified matrices, 1950). It is computed as if the lattice were periodic.
struct CoarseInverse {
    /// `B 1` on a grid.
    shape: Vec<f64>,
    /// Transform of `(K^-1 + 1' B 1)^-1`, including the normalisation.
    spectrum: Vec<f64>,
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
        Self::on_columns(cells, pillars, vectors, [compliance, 0.0], &[], pool)
    }

    /// The same if bodies are layers, in the unit of length of the cells. The preconditioner includes columns whose displacement per sum of the
    /// pressures on a pillar is `column`, m/Pa: [`Columns`](super::Columns) adds them to products.
    pub(crate) fn on_columns(
        cells: &Cells,
        pillars: Vec<(usize, usize)>,
        vectors: [Point; 2],
        [compliance, column]: [f64; 2],
        layers: &[WeightedLayer],
        pool: Option<&'a ThreadPool>,
    ) -> Self {
        let extent =
            |pick: fn(&(usize, usize)) -> usize| pillars.iter().map(pick).max().unwrap_or(0) + 1;
        let shape = (extent(|p| p.0), extent(|p| p.1));
        let grid = cells.grid();
        let across = [grid.rows(), grid.columns()];
        let local = LocalTransform::over(across);
        let lattice = LatticeTransform::new(padded(shape.0), padded(shape.1));
        let layout = Layout {
            places: cells
                .positions()
                .map(|(column, row)| row * local.columns + column)
                .collect(),
            cells: cells
                .positions()
                .map(|(column, row)| row * grid.columns() + column)
                .collect(),
            pillars,
            shape,
            pool,
        };
        let influence = Influence {
            potential: &CellPotential::new(grid.cell(), layers),
            cell: grid.cell(),
            vectors,
            scale: compliance / PI,
        };
        let own = OnGrids::new(&local, &influence);
        let inverse = OnGrids {
            kernel: local.inverse(&own.kernel),
            local,
        };
        let half =
            0.5 * (across[0] as f64 * influence.cell[1]).max(across[1] as f64 * influence.cell[0]);
        let distance = layout.distance(&influence) / half;
        let [exact, rough] = INTERPOLATION.map(|tolerance| {
            let [rows, columns] = across.map(|cells| node_count(cells, distance, tolerance));
            Some([rows?, columns?])
        });
        let kernel = layout.kernel(exact, across, &lattice, &influence);
        let of_steps = if rough == exact {
            kernel.iter().map(|value| f32::of(*value)).collect()
        } else {
            let kernel = layout.kernel(rough, across, &lattice, &influence);
            kernel.into_iter().map(f32::of).collect()
        };
        let coarse = CoarseInverse::new(&layout, [&own, &inverse], &lattice, &influence, column);
        let (padding, count) = ([lattice.rows, lattice.columns], layout.pillars.len());
        Self {
            exact: Convolution::new(exact, across, &own, padding, kernel, count),
            rough: Convolution::new(rough, across, &own, padding, of_steps, count),
            inverse,
            coarse,
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
    /// Smallest distance of two pillars on the lattice; zero if there is one.
    fn distance(&self, influence: &Influence<'_>) -> f64 {
        let (rows, columns) = (self.shape.0 as i64, self.shape.1 as i64);
        let offsets = (0..rows).flat_map(|i| (1 - columns..columns).map(move |j| (i, j)));
        let distances = offsets.filter(|offset| *offset != (0, 0)).map(|offset| {
            let [x, y] = influence.offset(offset);
            x.hypot(y)
        });
        distances.reduce(f64::min).unwrap_or(0.0)
    }

    /// Transforms the potential over the cells or nodes for every lattice offset, then over the lattice for every local frequency. Between
    /// nodes, the displacement of a grid by itself is left out.
    fn kernel(
        &self,
        nodes: Option<[usize; 2]>,
        across: [usize; 2],
        lattice: &LatticeTransform<f64>,
        influence: &Influence<'_>,
    ) -> Vec<f64> {
        let local = &LocalTransform::over(nodes.unwrap_or(across));
        let influence = &influence.between(nodes, across);
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
                (Some(0), Some(0)) if nodes.is_some() => Vec::new(),
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
        kernel
    }

    /// The threads, if they are worthwhile for this number of local frequencies.
    fn shared_pool(&self, frequencies: usize) -> Option<&'a ThreadPool> {
        self.pool.filter(|pool| {
            pool.current_num_threads() > 1 && frequencies * self.pillars.len() >= PARALLEL_VALUES
        })
    }
}

impl OnGrids<f64> {
    fn new(local: &LocalTransform<f64>, influence: &Influence<'_>) -> Self {
        let normalisation = 1.0 / (local.rows * local.columns) as f64;
        let spectrum = local.kernel_spectrum(influence, (0, 0));
        Self {
            kernel: spectrum
                .iter()
                .map(|value| normalisation * value.re)
                .collect(),
            local: local.clone(),
        }
    }
}

impl<R: Real> OnGrids<R> {
    fn of(other: &OnGrids<f64>) -> Self {
        Self {
            local: LocalTransform::new(other.local.rows, other.local.columns),
            kernel: other.kernel.iter().map(|value| R::of(*value)).collect(),
        }
    }

    /// Adds the convolution of every grid with itself to the result.
    fn add(&self, places: &[usize], values: &[f64], result: &mut [f64]) {
        let mut work = LocalWork::new(&self.local);
        let mut spectrum = vec![Complex::default(); self.local.frequencies()];
        let grids = values.chunks_exact(places.len());
        for (values, result) in grids.zip(result.chunks_exact_mut(places.len())) {
            if values.iter().all(|value| *value == 0.0) {
                continue;
            }
            work.array.fill(R::default());
            for (place, value) in places.iter().zip(values) {
                work.array[*place] = R::of(*value);
            }
            self.local.forward(&mut work, &mut spectrum);
            for (value, kernel) in spectrum.iter_mut().zip(&self.kernel) {
                *value = Complex::new(value.re * *kernel, value.im * *kernel);
            }
            self.local.backward(&mut spectrum, &mut work);
            for (place, value) in places.iter().zip(result) {
                *value += work.array[*place].double();
            }
        }
    }
}

impl<R: Real> Nodes<R> {
    fn new(shape: [usize; 2], cells: [usize; 2], own: &OnGrids<f64>) -> Self {
        let weight = |axis: usize, cell: usize, node: usize| {
            let step = (cells[axis] - 1) as f64 / (shape[axis] - 1) as f64;
            let others = (0..shape[axis]).filter(|other| *other != node);
            let factor =
                |other: usize| (cell as f64 / step - other as f64) / (node as f64 - other as f64);
            R::of(others.map(factor).product())
        };
        let of_rows = (0..shape[0]).flat_map(|node| (0..cells[0]).map(move |row| (row, node)));
        let of_columns =
            (0..cells[1]).flat_map(|column| (0..shape[1]).map(move |node| (column, node)));
        Self {
            of_rows: of_rows.map(|(row, node)| weight(0, row, node)).collect(),
            of_columns: of_columns
                .map(|(column, node)| weight(1, column, node))
                .collect(),
            own: OnGrids::of(own),
            shape,
            cells,
        }
    }

    fn work(&self) -> NodeWork<R> {
        NodeWork {
            cells: vec![R::default(); self.cells[0] * self.cells[1]],
            columns: vec![R::default(); self.cells[1]],
        }
    }

    /// Sets the charges on the nodes, in rows that begin every `stride` values, from the pressures of the cells.
    fn gather(&self, work: &mut NodeWork<R>, nodes: &mut [R], stride: usize) {
        let rows = self.of_rows.chunks_exact(self.cells[0]);
        for (nodes, weights) in nodes.chunks_mut(stride).zip(rows) {
            work.columns.fill(R::default());
            for (cells, weight) in work.cells.chunks_exact(self.cells[1]).zip(weights) {
                add_product(&mut work.columns, *weight, cells);
            }
            let columns = self.of_columns.chunks_exact(self.shape[1]);
            for (value, weights) in work.columns.iter().zip(columns) {
                add_product(nodes, *value, weights);
            }
        }
    }

    /// Interpolates the displacements of the cells from those of the nodes.
    fn spread(&self, nodes: &[R], stride: usize, work: &mut NodeWork<R>) {
        work.cells.fill(R::default());
        let rows = self.of_rows.chunks_exact(self.cells[0]);
        for (nodes, weights) in nodes.chunks(stride).zip(rows) {
            let columns = self.of_columns.chunks_exact(self.shape[1]);
            for (value, weights) in work.columns.iter_mut().zip(columns) {
                let products = nodes
                    .iter()
                    .zip(weights)
                    .map(|(node, weight)| *node * *weight);
                *value = products.fold(R::default(), |sum, product| sum + product);
            }
            for (cells, weight) in work.cells.chunks_exact_mut(self.cells[1]).zip(weights) {
                add_product(cells, *weight, &work.columns);
            }
        }
    }
}

/// Adds the product of a factor with values.
#[inline(always)]
fn add_product<R: Real>(sums: &mut [R], factor: R, values: &[R]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum = *sum + factor * *value;
    }
}

/// Values of all cells of a grid, and of a row of nodes at every column of cells.
struct NodeWork<R> {
    cells: Vec<R>,
    columns: Vec<R>,
}

/// Number of nodes that replace `cells` in a row, for pillars at a distance in half-widths of their grids; `None` if that many cells are
/// not more expensive.
///
/// The error of interpolation of `1/(z - x)`, `z` the distance of the nearest points, is largest in the middle between the first nodes.
fn node_count(cells: usize, distance: f64, tolerance: f64) -> Option<usize> {
    // Pillars are round, but the corners of their grids are nodes as well.
    let nearest = distance - std::f64::consts::SQRT_2;
    let error = |nodes: usize| -> f64 {
        let step = 2.0 / (nodes - 1) as f64;
        let factor = |node: usize| {
            let node = step * node as f64;
            (node - 0.5 * step).abs() / (nearest + 1.0 - node)
        };
        (0..nodes).map(factor).product()
    };
    let padded = smooth_size(2 * cells - 1);
    let fewer = (2..cells).take_while(|nodes| smooth_size(2 * nodes - 1) < padded);
    let mut fewer = fewer.filter(|nodes| nearest > 1.0 && error(*nodes) <= tolerance);
    // All numbers of nodes with the same padding take the same time.
    fewer.next().map(|nodes| smooth_size(2 * nodes - 1) / 2)
}

impl CoarseInverse {
    fn new(
        layout: &Layout<'_>,
        [own, inverse]: [&OnGrids<f64>; 2],
        lattice: &LatticeTransform<f64>,
        influence: &Influence<'_>,
        column: f64,
    ) -> Self {
        let places = &layout.places;
        let [mut shape, mut response] = [0; 2].map(|_| vec![0.0; places.len()]);
        inverse.add(places, &vec![1.0; places.len()], &mut shape);
        own.add(places, &shape, &mut response);
        let stiffness: f64 = shape.iter().sum();
        let work: f64 = shape.iter().zip(&response).map(|(p, u)| p * u).sum();
        // By how much the compliance of a pillar with these pressures exceeds that of its approximate inverse.
        let excess = work / (stiffness * stiffness) - 1.0 / stiffness + column;
        let (rows, columns) = (lattice.rows, lattice.columns);
        let mut transform = LatticeWork::new(lattice);
        for (place, entry) in transform.array.iter_mut().enumerate() {
            let row = wrapped(place / columns, layout.shape.0, rows);
            let column = wrapped(place % columns, layout.shape.1, columns);
            *entry = Complex::from(match (row, column) {
                (Some(0), Some(0)) => excess,
                (Some(i), Some(j)) => influence.at(influence.offset((i, j))),
                _ => 0.0,
            });
        }
        lattice.forward(rows, &mut transform);
        let normalisation = 1.0 / (rows * columns) as f64;
        let spectrum = transform.array.iter().map(|value| {
            // The lattice is cut off at its end: a positive lower bound.
            let factor = (1.0 + stiffness * value.re).max(LEAST_FACTOR);
            normalisation * (1.0 - 1.0 / factor) / stiffness
        });
        Self {
            spectrum: spectrum.collect(),
            shape,
        }
    }

    /// Corrects the result of the inverse on every grid alone.
    fn correct(&self, lattice: &LatticeTransform<f64>, layout: &Layout<'_>, direction: &mut [f64]) {
        let mut work = LatticeWork::new(lattice);
        let Layout { pillars, shape, .. } = layout;
        let per_pillar = self.shape.len();
        let place = |(row, column): &(usize, usize)| row * lattice.columns + column;
        for (pillar, direction) in pillars.iter().zip(direction.chunks_exact(per_pillar)) {
            work.array[place(pillar)] = Complex::from(direction.iter().sum::<f64>());
        }
        lattice.forward(shape.0, &mut work);
        for (value, factor) in work.array.iter_mut().zip(&self.spectrum) {
            *value *= factor;
        }
        lattice.backward(shape.0, &mut work);
        for (pillar, direction) in pillars.iter().zip(direction.chunks_exact_mut(per_pillar)) {
            let correction = work.array[place(pillar)].re;
            for (direction, shape) in direction.iter_mut().zip(&self.shape) {
                *direction -= correction * shape;
            }
        }
    }
}

/// Smallest ratio of the compliance of the lattice to that of a grid alone.
const LEAST_FACTOR: f64 = 0.1;

impl<R: Real> Convolution<R> {
    fn new(
        nodes: Option<[usize; 2]>,
        across: [usize; 2],
        own: &OnGrids<f64>,
        lattice: [usize; 2],
        kernel: Vec<R>,
        pillars: usize,
    ) -> Self {
        let local = LocalTransform::over(nodes.unwrap_or(across));
        Self {
            spectra: vec![Complex::default(); local.frequencies() * pillars],
            nodes: nodes.map(|shape| Nodes::new(shape, across, own)),
            lattice: LatticeTransform::new(lattice[0], lattice[1]),
            local,
            kernel,
        }
    }

    /// The displacement of all cells.
    fn apply(&mut self, layout: &Layout<'_>, pressure: &[f64], displacement: &mut [f64]) {
        self.spread(layout, pressure);
        self.convolve(layout);
        self.collect(layout, displacement);
        if let Some(nodes) = &self.nodes {
            nodes.own.add(&layout.places, pressure, displacement);
        }
    }

    /// Computes the local spectra of all grids.
    fn spread(&mut self, layout: &Layout<'_>, values: &[f64]) {
        let count = layout.pillars.len();
        let local = &self.local;
        let per_pillar = layout.places.len();
        let frequencies = local.frequencies();
        let mut on_cells = self.nodes.as_ref().map(|nodes| (nodes, nodes.work()));
        // A few pillars at a time, whose spectra are then written next to each other.
        let mut block = vec![Complex::default(); BLOCK * frequencies];
        let mut work = LocalWork::new(local);
        for first in (0..count).step_by(BLOCK) {
            let size = BLOCK.min(count - first);
            for (k, spectrum) in block.chunks_exact_mut(frequencies).take(size).enumerate() {
                let pillar = first + k;
                let values = &values[pillar * per_pillar..(pillar + 1) * per_pillar];
                if values.iter().all(|value| *value == 0.0) {
                    spectrum.fill(Complex::default());
                    continue;
                }
                work.array.fill(R::default());
                match &mut on_cells {
                    Some((nodes, cells)) => {
                        scatter(&layout.cells, values, &mut cells.cells);
                        nodes.gather(cells, &mut work.array, local.columns);
                    }
                    None => scatter(&layout.places, values, &mut work.array),
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
        let local = &self.local;
        let per_pillar = layout.places.len();
        let frequencies = local.frequencies();
        let mut on_cells = self.nodes.as_ref().map(|nodes| (nodes, nodes.work()));
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
                let (places, found) = match &mut on_cells {
                    Some((nodes, cells)) => {
                        nodes.spread(&work.array, local.columns, cells);
                        (&layout.cells, &cells.cells)
                    }
                    None => (&layout.places, &work.array),
                };
                let values = &mut values[pillar * per_pillar..(pillar + 1) * per_pillar];
                for (place, value) in places.iter().zip(values) {
                    *value = found[*place].double();
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

/// Sets values at these places of an array.
fn scatter<R: Real>(places: &[usize], values: &[f64], array: &mut [R]) {
    for (place, value) in places.iter().zip(values) {
        array[*place] = R::of(*value);
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

    /// Preconditioner of every grid separately, corrected for the interaction of their forces, both with periodic wrap-around.
    fn precondition(&mut self, residual: &[f64], direction: &mut [f64]) {
        direction.fill(0.0);
        self.inverse.add(&self.layout.places, residual, direction);
        self.coarse
            .correct(&self.exact.lattice, &self.layout, direction);
    }
}

/// The potential of one cell at another, by lattice and cell offset.
struct Influence<'a> {
    potential: &'a CellPotential,
    cell: [f64; 2],
    vectors: [Point; 2],
    scale: f64,
}

impl Influence<'_> {
    /// The distance of pillars by their offset on the lattice.
    fn offset(&self, (i, j): (i64, i64)) -> Point {
        combined(self.vectors, [i as f64, j as f64])
    }

    /// Displacement at a distance from a cell under unit pressure.
    fn at(&self, distance: Point) -> f64 {
        self.scale * self.potential.at(distance)
    }

    /// The same influence between the nodes, in rows and columns, instead of the cells.
    fn between(&self, nodes: Option<[usize; 2]>, across: [usize; 2]) -> Self {
        let cell = nodes.map_or(self.cell, |nodes| {
            let step = |axis: usize| (across[axis] - 1) as f64 / (nodes[axis] - 1) as f64;
            [self.cell[0] * step(1), self.cell[1] * step(0)]
        });
        Self { cell, ..*self }
    }
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

    /// Transforms of grids with this number of rows and columns.
    fn over(across: [usize; 2]) -> Self {
        let [rows, columns] = across.map(|count| smooth_size(2 * count - 1));
        Self::new(rows, columns)
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
    /// Inverse of a transformed kernel, both including the normalisation of the transforms.
    ///
    /// The kernel is truncated at the end of the grid, so that small values of its spectrum may have any sign; they are replaced by a
    /// positive lower bound.
    fn inverse(&self, kernel: &[f64]) -> Vec<f64> {
        let largest = kernel.iter().map(|k| k.abs()).fold(0.0, f64::max);
        let points = (self.rows * self.columns) as f64;
        kernel
            .iter()
            .map(|k| 1.0 / (points * points * k.abs().max(1e-6 * largest)))
            .collect()
    }

    /// Spectrum of the potential at all cell offsets of grids separated by this number of lattice vectors.
    fn kernel_spectrum(&self, influence: &Influence<'_>, offset: (i64, i64)) -> Vec<Complex64> {
        let mut work = LocalWork::new(self);
        let origin = influence.offset(offset);
        let (row_extent, column_extent) = (self.rows.div_ceil(2), self.columns.div_ceil(2));
        for row in 0..self.rows {
            let Some(v) = wrapped(row, row_extent, self.rows) else {
                continue;
            };
            for place in 0..self.columns {
                let Some(u) = wrapped(place, column_extent, self.columns) else {
                    continue;
                };
                let distance = [
                    origin[0] + u as f64 * influence.cell[0],
                    origin[1] + v as f64 * influence.cell[1],
                ];
                work.array[row * self.columns + place] = influence.at(distance);
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
    use crate::halfspace::elements::{Columns, Rectangle};
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

    /// Three by three pillars of radius 1 at a pitch.
    fn at_pitch(pitch: f64, cells: &Cells) -> LatticeOfGrids<'static> {
        let pillars = (0..3).flat_map(|i| (0..3).map(move |j| (i, j))).collect();
        let vectors = [0.5, -0.5].map(|side| [0.75_f64.sqrt() * pitch, side * pitch]);
        LatticeOfGrids::on_columns(cells, pillars, vectors, [COMPLIANCE, 0.0], &[], None)
    }

    /// Interpolation is used for exact products and for steps where the pillars are far enough apart, with the stated errors.
    #[test]
    fn interpolated_displacements_are_as_accurate_as_stated() {
        let cells = cells(16);
        let [size, _] = cells.grid().cell();
        let rectangle = Rectangle::new(size, size);
        let centres: Vec<Point> = cells.centres().collect();
        for (pitch, expected) in [(2.05, [false; 2]), (3.2, [false, true]), (6.0, [true; 2])] {
            let mut operator = at_pitch(pitch, &cells);
            let nodes = [
                operator.exact.nodes.is_some(),
                operator.rough.nodes.is_some(),
            ];
            assert_eq!(nodes, expected, "{pitch}");
            // The pillar in the middle has six neighbours, and two at a larger distance.
            let own = 4 * centres.len()..5 * centres.len();
            let mut pressure = vec![0.0; operator.len()];
            for (k, pressure) in pressure[own.clone()].iter_mut().enumerate() {
                *pressure = 2.0 + (1.3 * k as f64).sin();
            }
            let summed = |[x, y]: Point| -> f64 {
                let cells = centres.iter().zip(&pressure[own.clone()]);
                let potential = cells.map(|([u, v], p)| p * rectangle.potential(x - u, y - v));
                COMPLIANCE / PI * potential.sum::<f64>()
            };
            let [mut exact, mut rough] = [0; 2].map(|_| vec![0.0; operator.len()]);
            operator.apply(&pressure, &mut exact);
            operator.apply_to_step(&pressure, &mut rough);
            for pillar in 0..9 {
                let (i, j) = ((pillar / 3) as f64 - 1.0, (pillar % 3) as f64 - 1.0);
                let [dx, dy] = [0.75_f64.sqrt() * pitch * (i + j), 0.5 * pitch * (i - j)];
                let expected = centres.iter().map(|[x, y]| summed([x + dx, y + dy]));
                let expected: Vec<f64> = expected.collect();
                let largest = expected.iter().copied().fold(0.0, f64::max);
                for (found, tolerance) in [&exact, &rough].into_iter().zip(INTERPOLATION) {
                    let found = &found[pillar * centres.len()..][..centres.len()];
                    let errors = found.iter().zip(&expected).map(|(a, b)| (a - b).abs());
                    let error = errors.fold(0.0, f64::max) / largest;
                    println!("pitch {pitch}, pillar {pillar}: {error:.1e} of {tolerance:e}");
                    assert!(error < tolerance, "{pitch} {pillar} {error:e}");
                }
            }
        }
    }

    /// The interaction of 400 pillars increases the displacement under equal pressures by an order of magnitude.
    #[test]
    fn preconditioner_includes_the_interaction_of_pillars() {
        let cells = cells(8);
        let pillars: Vec<_> = (0..400).map(|k| (k / 20, k % 20)).collect();
        for column in [0.0, 0.1] {
            let compliances = [1.0, column];
            let vectors = [[5.2, 3.0], [5.2, -3.0]];
            let places = pillars.clone();
            let operator =
                LatticeOfGrids::on_columns(&cells, places, vectors, compliances, &[], None);
            let labels = (0..operator.len()).map(|k| (k / cells.len()) as u32);
            let labels = labels.collect();
            let mut operator = Columns::new(operator, labels, vec![column; pillars.len()]);
            let mut apply = |values: &[f64], inverse: bool| {
                let mut result = vec![0.0; values.len()];
                if inverse {
                    operator.precondition(values, &mut result);
                } else {
                    operator.apply(values, &mut result);
                }
                result
            };
            let count = cells.len() * pillars.len();
            let (a, b) = (numbers(count), vec![1.0; count]);
            let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
            let (pa, pb) = (apply(&a, true), apply(&b, true));
            assert!((dot(&a, &pb) / dot(&b, &pa) - 1.0).abs() < 1e-10);
            assert!(dot(&a, &pa) > 0.0 && dot(&b, &pb) > 0.0);
            for values in [a, b] {
                let response = apply(&values, false);
                let ratio = dot(&apply(&response, true), &values) / dot(&values, &values);
                println!("column {column}: {ratio}");
                assert!((0.3..3.0).contains(&ratio), "{ratio}");
            }
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
