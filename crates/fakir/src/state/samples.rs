//! Evaluation of fields at many points.
//!
//! Pillars within two pitches of the lattice cell of a point are summed directly, exactly as at a single point. The contribution of all
//! others is smooth within a cell: it is computed at Chebyshev points of every cell, where it is a convolution over the lattice, and
//! interpolated. Its nearest singularity is `sqrt7` pitches from the centre of the cell, `4.58` times the half width `e/sqrt3` of the
//! square of nodes, so that `n` nodes per side leave an error of about `9.05^-n` of the contribution of one pillar there (L. N. Trefethen,
//! Approximation Theory and Approximation Practice, theorem 8.2).

use super::contact::ContactState;
use super::error::SolveError;
use super::fields::{Disc, Fields};
use super::run::Run;
use crate::numerics::fft::{ComplexPlans, smooth_size, transpose};
use crate::numerics::vector::{LANES, Lanes, widest};
use crate::problem::pillar_field::PillarField;
use crate::problem::{HexagonalLattice, Point};
use num_complex::Complex64;
use std::f64::consts::PI;
use std::ops::Range;

/// Displacement, gap and pressure at points.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FieldSamples {
    /// Relative normal displacement of the two surfaces, m, as in [`Fields::displacement`].
    pub displacement: Vec<f64>,
    /// Gap between the lens and the surface below it, m, as in [`Fields::gap`].
    pub gap: Vec<f64>,
    /// Contact pressure, Pa: at the point, as in [`Fields::pressure`], from [`Fields::sample`]; the mean over the cell of the point from
    /// [`Fields::on_grid`].
    pub pressure: Vec<f64>,
}

/// Memory per point while fields are sampled, bytes: the point twice, once scaled, and the three fields twice.
const BYTES_PER_POINT: usize = 80;

impl FieldSamples {
    /// Checks that fields at this number of points do not exceed the memory limit, if the caller stores `more` additional bytes per point.
    ///
    /// # Errors
    /// [`SolveError::TooManyPoints`]
    pub fn check_memory(points: usize, more: usize, run: &Run<'_>) -> Result<(), SolveError> {
        let (each, limit) = (BYTES_PER_POINT + more, run.memory_limit());
        let bytes = points.saturating_mul(each);
        if bytes <= limit {
            return Ok(());
        }
        Err(SolveError::TooManyPoints {
            points,
            bytes,
            limit,
            most: limit / each,
        })
    }
}

/// Number of Chebyshev points along a side of a cell.
const NODES: usize = 10;

/// Distance in pitches from the centre of a cell within which pillars are summed directly: the cell's pillar and two rings.
const NEAR: f64 = 2.1;

/// Buffers for the modes of a disc, and for the modes through which pillars interact, of several discs.
struct Workspace {
    modes: Vec<f64>,
    lanes: Vec<Lanes>,
}

/// Number of points between checks for cancellation.
const BATCH: usize = 1024;

/// Number of pillars whose direct summation at a point takes about as long as kernel values and transforms per array element.
const CONVOLUTION_COST: usize = 300;

impl Fields {
    /// Displacement, gap and pressure at points (m from the lens axis), in the same order.
    ///
    /// The result is the same as for single points, up to an error in the displacement of about 1e-10 of it, but the time hardly depends on
    /// the number of pillars.
    ///
    /// # Errors
    /// [`SolveError::Interrupted`] if `run` is cancelled, and [`SolveError::TooManyPoints`] if the memory limit is exceeded.
    pub fn sample(&self, points: &[Point], run: &Run<'_>) -> Result<FieldSamples, SolveError> {
        let mut samples = self.displacement_and_gap(points, run)?;
        let pressure = |point: &Point| self.pressure(*point);
        let batch = |points: &[Point]| -> Result<Vec<f64>, SolveError> {
            run.check_cancelled()?;
            Ok(points.iter().map(pressure).collect())
        };
        samples.pressure = in_batches(points, batch, run)?;
        Ok(samples)
    }

    /// Displacement and gap at some points; the pressure is omitted.
    fn displacement_and_gap(
        &self,
        points: &[Point],
        run: &Run<'_>,
    ) -> Result<FieldSamples, SolveError> {
        FieldSamples::check_memory(points.len(), 0, run)?;
        let scaled: Vec<Point> = points.iter().map(|point| self.scaled(*point)).collect();
        let far = FarField::worthwhile(self, &scaled, run)?;
        let one = |point: &Point, workspace: &mut Workspace| {
            let displacement = match &far {
                Some(far) => far.displacement(self, *point, workspace),
                None => self.scaled_displacement(*point),
            };
            [
                displacement * self.scene.length,
                self.gap_with(*point, displacement),
            ]
        };
        let batch = |points: &[Point]| -> Result<Vec<[f64; 2]>, SolveError> {
            run.check_cancelled()?;
            let mut workspace = Workspace {
                modes: vec![0.0; self.compliance.len()],
                lanes: vec![Lanes::default(); self.exterior.count()],
            };
            Ok(points
                .iter()
                .map(|point| one(point, &mut workspace))
                .collect())
        };
        let values = in_batches(&scaled, batch, run)?;
        let pick = |field: usize| values.iter().map(|value| value[field]).collect();
        Ok(FieldSamples {
            displacement: pick(0),
            gap: pick(1),
            pressure: Vec::new(),
        })
    }

    /// Fields on a grid of the given coordinates (m), by rows: `x` varies fastest.
    ///
    /// Displacement and gap are those at the points. The pressure, which is infinite at the edge of a covered pillar top, is its mean over
    /// the cell of the point. Cells end half-way to the adjacent coordinates, and extend as far beyond the outermost ones. If there is only
    /// one coordinate, the width of the cell is that of the narrowest cell in the other direction. The pressure of a point that is not in
    /// contact is zero: the force on the part of its cell in contact is assigned to the nearest point in contact. The sum of pressure times
    /// area over the cells of a pillar is the force on it, to 1e-6 if it is covered and to 0.003 if the edge of the contact crosses it.
    ///
    /// # Errors
    /// As for [`sample`](Self::sample).
    pub fn on_grid(&self, x: &[f64], y: &[f64], run: &Run<'_>) -> Result<FieldSamples, SolveError> {
        FieldSamples::check_memory(x.len().saturating_mul(y.len()), 0, run)?;
        let mut samples = self.displacement_and_gap(&grid_points(x, y), run)?;
        samples.pressure = self.mean_pressures(x, y, run)?;
        Ok(samples)
    }
}

impl ContactState {
    /// Displacement, gap and pressure at points (m from the lens axis), as in [`Fields::sample`]; without contact, those of the undeformed
    /// lens. Returns `None` for methods that do not resolve pillars.
    ///
    /// # Errors
    /// As for [`Fields::sample`].
    pub fn sample(
        &self,
        points: &[Point],
        run: &Run<'_>,
    ) -> Result<Option<FieldSamples>, SolveError> {
        match &self.fields {
            Some(fields) => fields.sample(points, run).map(Some),
            None => self.undeformed(points, run),
        }
    }

    /// The same on a grid of the given coordinates (m), as in [`Fields::on_grid`].
    ///
    /// # Errors
    /// As for [`Fields::on_grid`].
    pub fn sample_on_grid(
        &self,
        x: &[f64],
        y: &[f64],
        run: &Run<'_>,
    ) -> Result<Option<FieldSamples>, SolveError> {
        match &self.fields {
            Some(fields) => fields.on_grid(x, y, run).map(Some),
            None => self.undeformed(&grid_points(x, y), run),
        }
    }

    fn undeformed(
        &self,
        points: &[Point],
        run: &Run<'_>,
    ) -> Result<Option<FieldSamples>, SolveError> {
        if self.pillars_in_contact > 0 {
            return Ok(None);
        }
        FieldSamples::check_memory(points.len(), 0, run)?;
        let (system, tops) = (&self.system, self.system.tops());
        let gap = |point: &Point| {
            let below = if tops.holds(*point) {
                0.0
            } else {
                system.pillar().height
            };
            system.lens().sag(*point) + below - self.indentation
        };
        let zero = vec![0.0; points.len()];
        Ok(Some(FieldSamples {
            displacement: zero.clone(),
            gap: points.iter().map(gap).collect(),
            pressure: zero,
        }))
    }
}

/// The points of a grid, by rows.
fn grid_points(x: &[f64], y: &[f64]) -> Vec<Point> {
    let row = |&y: &f64| x.iter().map(move |&x| [x, y]);
    y.iter().flat_map(row).collect()
}

/// Values at points, computed in batches on the threads of a run.
fn in_batches<T: Copy + Send>(
    points: &[Point],
    batch: impl Fn(&[Point]) -> Result<Vec<T>, SolveError> + Sync + Send,
    run: &Run<'_>,
) -> Result<Vec<T>, SolveError> {
    let batches: Vec<&[Point]> = points.chunks(BATCH).collect();
    let values = run
        .workers()
        .map(batches.len(), 1, || (), |(), number| batch(batches[number]));
    let values: Result<Vec<_>, SolveError> = values.into_iter().collect();
    Ok(values?.concat())
}

/// Number of points across a cell whose mean pressure is computed.
const PER_CELL: usize = 4;

/// Displacement and gap, and pressure, at points, from functions of a point.
pub(crate) fn sample_points(
    points: &[Point],
    displacement_and_gap: impl Fn(Point) -> [f64; 2] + Sync + Send,
    pressure: impl Fn(Point) -> f64 + Sync + Send,
    run: &Run<'_>,
) -> Result<FieldSamples, SolveError> {
    FieldSamples::check_memory(points.len(), 0, run)?;
    let batch = |points: &[Point]| {
        run.check_cancelled()?;
        let of_point = |point: &Point| (displacement_and_gap(*point), pressure(*point));
        Ok(points.iter().map(of_point).collect())
    };
    let mut samples = FieldSamples::default();
    for ([displacement, gap], pressure) in in_batches(points, batch, run)? {
        samples.displacement.push(displacement);
        samples.gap.push(gap);
        samples.pressure.push(pressure);
    }
    Ok(samples)
}

/// The same on a grid of equidistant points, x fastest: displacement and gap at the points, and the mean of the pressure at 16 points in the cell
/// around each.
pub(crate) fn sample_cells(
    [x, y]: [&[f64]; 2],
    displacement_and_gap: impl Fn(Point) -> [f64; 2] + Sync + Send,
    pressure: impl Fn(Point) -> f64 + Sync + Send,
    run: &Run<'_>,
) -> Result<FieldSamples, SolveError> {
    let side = |axis: &[f64]| axis.get(1).map_or(0.0, |next| next - axis[0]);
    let cell = [side(x), side(y)];
    let inside = |place: usize| (place as f64 + 0.5) / PER_CELL as f64 - 0.5;
    let mean = |at: Point| {
        let places = (0..PER_CELL).flat_map(|row| (0..PER_CELL).map(move |it| [it, row]));
        let pressures =
            places.map(|place| pressure([0, 1].map(|k| at[k] + cell[k] * inside(place[k]))));
        pressures.sum::<f64>() / (PER_CELL * PER_CELL) as f64
    };
    FieldSamples::check_memory(x.len().saturating_mul(y.len()), 0, run)?;
    sample_points(&grid_points(x, y), displacement_and_gap, mean, run)
}

/// A rectangle of lattice indices.
#[derive(Debug, Clone)]
struct Block {
    i: Range<i64>,
    j: Range<i64>,
}

impl Block {
    /// The smallest rectangle that contains all indices; `None` if there are none.
    fn around(indices: impl Iterator<Item = (i64, i64)>) -> Option<Self> {
        let one = |(i, j): (i64, i64)| Self {
            i: i..i + 1,
            j: j..j + 1,
        };
        let joined = |a: &Range<i64>, b: &Range<i64>| a.start.min(b.start)..a.end.max(b.end);
        indices.map(one).reduce(|a, b| Self {
            i: joined(&a.i, &b.i),
            j: joined(&a.j, &b.j),
        })
    }

    fn shape(&self) -> (usize, usize) {
        let length = |range: &Range<i64>| (range.end - range.start) as usize;
        (length(&self.i), length(&self.j))
    }

    fn place(&self, (i, j): (i64, i64)) -> Option<(usize, usize)> {
        (self.i.contains(&i) && self.j.contains(&j))
            .then(|| ((i - self.i.start) as usize, (j - self.j.start) as usize))
    }
}

/// Whether a pillar is near the centre of a cell.
fn is_near(lattice: &HexagonalLattice, [x, y]: Point) -> bool {
    x * x + y * y < (NEAR * lattice.pitch).powi(2)
}

/// Displacement due to pillars that are not near, in every cell that contains points.
struct FarField {
    lattice: HexagonalLattice,
    cells: Block,
    pillars: Block,
    /// For every position in `pillars`, the index of its disc plus one.
    disc_at: Vec<u32>,
    nodes: [f64; NODES],
    /// Weights of the barycentric formula.
    weights: [f64; NODES],
    /// Offsets from a pillar to the near ones.
    near: Vec<(i64, i64)>,
    /// For every cell, the values at its nodes, by rows.
    values: Vec<f64>,
}

impl FarField {
    /// The far field, if there are enough pillars and points to save time.
    fn worthwhile(
        fields: &Fields,
        points: &[Point],
        run: &Run<'_>,
    ) -> Result<Option<Self>, SolveError> {
        let discs = &fields.discs;
        // Discs that do not cover a whole pillar top are isolated.
        if discs.len() < 20 || discs.iter().any(|disc| disc.radius < 1.0) {
            return Ok(None);
        }
        let PillarField::Hexagonal { lattice, .. } = fields.scene.field else {
            return Ok(None);
        };
        let inside = points.iter().all(|p| p[0].is_finite() && p[1].is_finite());
        if !inside {
            return Ok(None);
        }
        let cells = points.iter().map(|point| lattice.nearest_pillar(*point));
        let pillars = discs.iter().map(|disc| disc.index);
        let (Some(cells), Some(pillars)) = (Block::around(cells), Block::around(pillars)) else {
            return Ok(None);
        };
        let (cell_shape, pillar_shape) = (cells.shape(), pillars.shape());
        let size = |cells: usize, pillars: usize| smooth_size(cells + pillars);
        let padded = (
            size(cell_shape.0, pillar_shape.0),
            size(cell_shape.1, pillar_shape.1),
        );
        if padded.0 * padded.1 * CONVOLUTION_COST > points.len() * discs.len() {
            return Ok(None);
        }
        // Transforms of all modes: once for the loads, and on every thread for their effect at a node.
        let threads = run.pool.map_or(1, rayon::ThreadPool::current_num_threads);
        let arrays = 2 + fields.exterior.count() * (1 + threads);
        let at_nodes = 2 * 8 * NODES * NODES * cell_shape.0 * cell_shape.1;
        let bytes = 16 * arrays * padded.0 * padded.1 + at_nodes;
        if bytes > run.memory_limit() - BYTES_PER_POINT * points.len() {
            return Ok(None);
        }
        let mut disc_at = vec![0; pillar_shape.0 * pillar_shape.1];
        for (disc, number) in discs.iter().zip(1..) {
            if let Some((row, column)) = pillars.place(disc.index) {
                disc_at[row * pillar_shape.1 + column] = number;
            }
        }
        let half_width = lattice.pitch / 3f64.sqrt();
        let angle = |k: usize| PI * (k as f64 + 0.5) / NODES as f64;
        let nodes = std::array::from_fn(|k| half_width * angle(k).cos());
        let mut sign = 1.0;
        let weights = std::array::from_fn(|k| {
            sign = -sign;
            sign * angle(k).sin()
        });
        let near = (-3..=3).flat_map(|i| (-3..=3).map(move |j| (i, j)));
        let near = near.filter(|(i, j)| is_near(&lattice, lattice.lattice_vector(*i, *j)));
        let mut far = Self {
            lattice,
            cells,
            pillars,
            disc_at,
            nodes,
            weights,
            near: near.collect(),
            values: Vec::new(),
        };
        far.values = Convolution::new(&far, padded).far_values(&far, fields, run)?;
        Ok(Some(far))
    }

    /// The displacement at a scaled position in one of the cells.
    fn displacement(&self, fields: &Fields, point: Point, workspace: &mut Workspace) -> f64 {
        let (i, j) = self.lattice.nearest_pillar(point);
        let Some((row, column)) = self.cells.place((i, j)) else {
            return fields.scaled_displacement(point);
        };
        let [x, y] = self.lattice.centre(i, j);
        let start = (row * self.cells.shape().1 + column) * NODES * NODES;
        let (in_x, in_y) = (
            self.interpolation(point[0] - x),
            self.interpolation(point[1] - y),
        );
        let far: f64 = self.values[start..start + NODES * NODES]
            .chunks_exact(NODES)
            .zip(in_y)
            .map(|(row, weight)| {
                weight
                    * row
                        .iter()
                        .zip(&in_x)
                        .map(|(value, w)| value * w)
                        .sum::<f64>()
            })
            .sum();
        let near = self.near.iter().map(|(di, dj)| (i + di, j + dj));
        let near = near.filter_map(|index| self.disc(fields, index));
        let near = widest(
            #[inline(always)]
            || displacement_by_near(fields, near, point, workspace),
        );
        near + far + fields.displacement_by_floor(point)
    }

    fn disc<'f>(&self, fields: &'f Fields, index: (i64, i64)) -> Option<&'f Disc> {
        let (row, column) = self.pillars.place(index)?;
        let number = self.disc_at[row * self.pillars.shape().1 + column] as usize;
        fields.discs.get(number.checked_sub(1)?)
    }

    /// Weights of the nodes for the value at `x`, by the barycentric formula.
    fn interpolation(&self, x: f64) -> [f64; NODES] {
        let hit = |node: &f64| (x - node).abs() < f64::MIN_POSITIVE;
        if let Some(hit) = self.nodes.iter().position(hit) {
            return std::array::from_fn(|k| if k == hit { 1.0 } else { 0.0 });
        }
        let mut weights: [f64; NODES] =
            std::array::from_fn(|k| self.weights[k] / (x - self.nodes[k]));
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        weights
    }
}

/// Displacement due to near discs; those that are not close are processed in groups of [`LANES`].
#[inline(always)]
fn displacement_by_near<'f>(
    fields: &Fields,
    near: impl Iterator<Item = &'f Disc>,
    point: Point,
    workspace: &mut Workspace,
) -> f64 {
    let mut sum = 0.0;
    let mut some = [None; LANES];
    let mut count = 0;
    for disc in near {
        if disc.is_close(point) {
            sum += fields.displacement_by(disc, point, &mut workspace.modes);
            continue;
        }
        some[count] = Some(disc);
        count += 1;
        if count == LANES {
            sum += fields.displacement_by_some(&some, point, &mut workspace.lanes);
            (some, count) = ([None; LANES], 0);
        }
    }
    if count > 0 {
        sum += fields.displacement_by_some(&some, point, &mut workspace.lanes);
    }
    sum
}

/// Convolution over the lattice of the loads on pillars with their displacement at a node of a cell.
struct Convolution {
    padded: (usize, usize),
    plans: ComplexPlans,
    /// For every position of the array, the vector from a pillar to the centre of a cell; `None` if the pillar is near, or if there is no
    /// such pair.
    vectors: Vec<Option<Point>>,
}

impl Convolution {
    fn new(far: &FarField, padded: (usize, usize)) -> Self {
        let shape = (far.cells.shape(), far.pillars.shape());
        // Position k of the array contains the difference k, or k - padded if this is negative.
        let difference = |k: usize, cells: usize, pillars: usize, padded: usize| -> Option<i64> {
            if k < cells {
                Some(k as i64)
            } else if k + pillars > padded {
                Some(k as i64 - padded as i64)
            } else {
                None
            }
        };
        let origin = (
            far.cells.i.start - far.pillars.i.start,
            far.cells.j.start - far.pillars.j.start,
        );
        let vectors = (0..padded.0 * padded.1)
            .map(|place| {
                let (row, column) = (place / padded.1, place % padded.1);
                let di = difference(row, shape.0.0, shape.1.0, padded.0)? + origin.0;
                let dj = difference(column, shape.0.1, shape.1.1, padded.1)? + origin.1;
                let vector = far.lattice.lattice_vector(di, dj);
                (!is_near(&far.lattice, vector)).then_some(vector)
            })
            .collect();
        Self {
            padded,
            plans: ComplexPlans::new(padded.0, padded.1),
            vectors,
        }
    }

    /// The far field at the nodes of every cell.
    fn far_values(
        &self,
        far: &FarField,
        fields: &Fields,
        run: &Run<'_>,
    ) -> Result<Vec<f64>, SolveError> {
        let loads: Vec<Vec<Complex64>> = (0..fields.exterior.count())
            .map(|mode| self.transformed_load(far, fields, mode))
            .collect();
        // Two nodes at a time, as real and imaginary part.
        let pair = |pair: usize| -> Result<Vec<Complex64>, SolveError> {
            run.check_cancelled()?;
            let node = |k: usize| [far.nodes[k % NODES], far.nodes[k / NODES]];
            Ok(self.at_nodes(far, fields, &loads, [node(2 * pair), node(2 * pair + 1)]))
        };
        let pairs = NODES * NODES / 2;
        let by_pair = run
            .workers()
            .map(pairs, 1, || (), |(), number| pair(number));
        let by_pair: Result<Vec<_>, SolveError> = by_pair.into_iter().collect();
        let by_pair = by_pair?;
        let (rows, columns) = far.cells.shape();
        Ok((0..rows * columns)
            .flat_map(|cell| by_pair.iter().flat_map(move |v| [v[cell].re, v[cell].im]))
            .collect())
    }

    /// Transformed coefficients of a mode on all pillars.
    fn transformed_load(&self, far: &FarField, fields: &Fields, mode: usize) -> Vec<Complex64> {
        let mut array = vec![Complex64::default(); self.padded.0 * self.padded.1];
        for disc in &fields.discs {
            if let (Some((row, column)), Some(c)) =
                (far.pillars.place(disc.index), disc.coefficients.get(mode))
            {
                array[row * self.padded.1 + column].re = *c;
            }
        }
        self.transform(array)
    }

    /// Far field in every cell at two nodes.
    fn at_nodes(
        &self,
        far: &FarField,
        fields: &Fields,
        loads: &[Vec<Complex64>],
        nodes: [Point; 2],
    ) -> Vec<Complex64> {
        let (size, modes) = (self.vectors.len(), loads.len());
        let mut kernels = vec![vec![Complex64::default(); size]; modes];
        let mut values = [vec![0.0; modes], vec![0.0; modes]];
        for (place, vector) in self.vectors.iter().enumerate() {
            let Some([x, y]) = vector else { continue };
            for (values, node) in values.iter_mut().zip(nodes) {
                let at = [x + node[0], y + node[1]];
                fields.exterior.values_of_first(modes, at, 1.0, values);
            }
            for (mode, kernel) in kernels.iter_mut().enumerate() {
                kernel[place] = Complex64::new(values[0][mode], values[1][mode]);
            }
        }
        let mut product = vec![Complex64::default(); size];
        for (kernel, load) in kernels.into_iter().zip(loads) {
            let kernel = self.transform(kernel);
            for ((sum, k), l) in product.iter_mut().zip(&kernel).zip(load) {
                *sum += k * l;
            }
        }
        let result = self.transform_back(product);
        let (rows, columns) = far.cells.shape();
        (0..rows)
            .flat_map(|row| &result[row * self.padded.1..row * self.padded.1 + columns])
            .map(|value| value / size as f64)
            .collect()
    }

    /// Transform of an array; the result has rows and columns exchanged.
    fn transform(&self, mut array: Vec<Complex64>) -> Vec<Complex64> {
        let (rows, columns) = self.padded;
        self.plans.row.process(&mut array);
        let mut turned = vec![Complex64::default(); array.len()];
        transpose(&array, &mut turned, rows, columns);
        self.plans.column.process(&mut turned);
        turned
    }

    fn transform_back(&self, mut array: Vec<Complex64>) -> Vec<Complex64> {
        let (rows, columns) = self.padded;
        self.plans.column_back.process(&mut array);
        let mut turned = vec![Complex64::default(); array.len()];
        transpose(&array, &mut turned, columns, rows);
        self.plans.row_back.process(&mut turned);
        turned
    }
}

#[cfg(test)]
mod tests {
    use super::{BYTES_PER_POINT, ContactState, Fields, SolveError};
    use crate::problem::{Load, Method, PillarCompliance, Point};
    use crate::state::Run;
    use crate::theory::reference;
    use std::sync::Arc;

    #[test]
    fn where_nothing_is_touched_the_lens_is_undeformed() {
        let system = reference::intermediate(0.1);
        let mut state = ContactState::untouched(&system, Method::Homogenised, -1e-6);
        let beside = [0.5 * system.pitch(), 0.0];
        let samples = state.sample(&[[0.0, 0.0], beside], &Run::default());
        let gap = samples.unwrap().unwrap().gap;
        let expected = [0.0, system.pillar().height + system.lens().sag(beside)];
        for (gap, expected) in gap.iter().zip(expected) {
            assert!((gap - expected - 1e-6).abs() < 1e-18, "{gap}");
        }
        state.pillars_in_contact = 1;
        let samples = state.sample_on_grid(&[0.0], &[0.0], &Run::default());
        assert_eq!(samples, Ok(None));
    }

    /// Fields with at least this number of pillars in contact.
    fn fields(surface_fraction: f64, offset: f64, touched: usize) -> Arc<Fields> {
        let lattice = reference::lattice(surface_fraction).offset_by(offset);
        let compliance = PillarCompliance::Column;
        let system = reference::on_lattice(lattice, reference::INTERMEDIATE, compliance);
        let load = Load::Indentation(4e-6);
        let state = crate::press(&system, load, Method::default(), &Run::default()).unwrap();
        assert!(state.pillars_in_contact > touched);
        state.fields.unwrap()
    }

    /// Compares fields at many points with the same fields at single points, on pillars and on the floor, in and out of contact, including
    /// pillars that the contact edge crosses.
    #[track_caller]
    fn check_points(fields: &Fields) {
        let points: Vec<Point> = (0..12_000)
            .map(|k| {
                let (radius, angle) = (1e-8 * f64::from(k), 2.4 * f64::from(k));
                [radius * angle.cos(), radius * angle.sin()]
            })
            .collect();
        let samples = fields.sample(&points, &Run::default()).unwrap();
        let size = fields.displacement([0.0, 0.0]);
        // Without spare memory, pillars are summed directly.
        let little = Run {
            memory_limit: Some(points.len() * BYTES_PER_POINT),
            ..Run::default()
        };
        let summed = fields.sample(&points, &little).unwrap();
        assert!(samples.displacement != summed.displacement);
        for (k, point) in points.iter().enumerate().take(1000) {
            let displacement = fields.displacement(*point);
            assert_eq!(summed.displacement[k].to_bits(), displacement.to_bits());
        }
        for (k, point) in points.iter().enumerate().step_by(11) {
            let displacement = fields.displacement(*point);
            assert!((samples.displacement[k] - displacement).abs() < 1e-10 * size);
            assert!((samples.gap[k] - fields.gap(*point)).abs() < 1e-10 * size);
            assert_eq!(
                samples.pressure[k].to_bits(),
                fields.pressure(*point).to_bits()
            );
        }
    }

    #[test]
    fn many_points_agree_with_single_ones() {
        check_points(&fields(0.1, 0.3, 100));
    }

    #[test]
    fn many_points_between_many_pillars_agree_with_single_ones() {
        check_points(&fields(0.4, 0.0, 300));
    }

    #[test]
    fn too_many_points_are_refused() {
        let fields = fields(0.03, 0.0, 20);
        let little = Run {
            memory_limit: Some(40_000 * BYTES_PER_POINT),
            ..Run::default()
        };
        let refused = fields.sample(&vec![[0.0; 2]; 40_001], &little);
        let message = refused.unwrap_err().to_string();
        assert_eq!(
            message,
            "fields at 40001 points take 3.2 MB of memory; the limit is 3.2 MB: raise the limit, or \
             request at most 40000 points, such as 200 by 200"
        );
        let many = vec![0.0; 100_000];
        let refused = fields.on_grid(&many, &many, &Run::default());
        assert!(matches!(refused, Err(SolveError::TooManyPoints { .. })));
    }
}
