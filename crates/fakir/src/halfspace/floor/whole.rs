//! The [coupling](super::coupling) of a floor and pillars on its grid, by transforms of the whole period.

use super::coarse::{BesidePillars, Coarse};
use super::far::Part;
use super::grid::Division;
use super::kernels::{PillarMeans, Rectangles};
use super::meeting::{Meeting, halves, put, take, turn, unfold};
use crate::halfspace::disc::basis::{Mode, modes};
use crate::halfspace::elements::convolution::{
    BLOCK_WIDTH, ColumnBlock, Transform, Workspace, line_stride,
};
use crate::numerics::fft::{Real, RealPlans};
use crate::numerics::vector::{LANES, widest};
use crate::numerics::workers::Workers;
use crate::problem::layer::WeightedLayer;
use num_complex::{Complex, Complex64};
use std::f64::consts::PI;
use std::sync::{Arc, Mutex, PoisonError, RwLock};

/// Smallest number of kernel rows that a thread computes at a time.
const KERNEL_ROWS: usize = 4;

/// Number of stored rows of a kernel: the others are mirror images.
pub(super) fn kernel_rows(rows: usize) -> usize {
    rows / 2 + 1
}

/// Transforms and kernels of the fine grid, and their relation to the coarse grid.
pub(super) struct Together<R> {
    pub(super) division: Division,
    /// Degree of the modes of pillars on the coarse grid; `None` if they are not on it.
    pub(super) degree: Option<usize>,
    /// The part of their effect that the kernels contain.
    pub(super) part: Part,
    /// Number of columns and rows of the fine grid and of the coarse grid.
    pub(super) shape: [usize; 2],
    pub(super) coarse: [usize; 2],
    plans: RealPlans<R>,
    /// Whether the kernels of the coupled modes are imaginary, and the modes with real and with imaginary kernels.
    pub(super) odd: Vec<bool>,
    alike: [Vec<usize>; 2],
    /// Sign of each kernel in the second half of the rows, which are mirror images of the first half.
    mirrored: Vec<R>,
    /// For every column and every kernel, that of the floor first: its stored rows ([`kernel_rows`]). Includes the normalisation of all
    /// transforms.
    pub(super) kernel: Arc<Vec<R>>,
    /// `exp(i theta/2)` for every column and for every row.
    phases: [Vec<Complex<R>>; 2],
    /// Transforms of the coefficients of the pillars: for every coarse column and every mode, the real parts of its rows, then the
    /// imaginary parts.
    tops: RwLock<Vec<R>>,
    /// For every block of columns, every column and every mode: folded rows in the same format.
    folded: Vec<Mutex<Vec<R>>>,
}

impl<R: Real> BesidePillars for Together<R> {
    fn odd(&self) -> &[bool] {
        &self.odd
    }

    fn take_mode(&self, coarse: &mut Coarse, mode: usize) {
        let mut spectra = self.tops.write().unwrap_or_else(PoisonError::into_inner);
        coarse.transform();
        coarse.write(mode, &mut spectra);
    }

    #[cfg(any(test, feature = "kernels"))]
    fn kernel_count(&self) -> usize {
        self.kernel.len()
    }

    fn gather(&self, coarse: &mut Coarse) {
        coarse.gather(self.shape[0], &self.folded);
    }
}

/// Zeros for every column, in blocks.
pub(super) fn folded_buffers<R: Real>(columns: usize, of_column: usize) -> Vec<Mutex<Vec<R>>> {
    let of_column = of_column.max(1);
    (0..columns)
        .step_by(BLOCK_WIDTH)
        .map(|first| {
            let width = BLOCK_WIDTH.min(columns - first);
            Mutex::new(vec![R::default(); width * of_column])
        })
        .collect()
}

/// Whether the transform of the mode's kernel is imaginary.
fn is_imaginary(mode: &Mode) -> bool {
    mode.degree % 2 == 1
}

impl Together<f64> {
    pub(super) fn new(
        division: &Division,
        coarse: [usize; 2],
        (degree, part): (Option<usize>, Part),
        layers: &[WeightedLayer],
        workers: Workers<'_>,
    ) -> Self {
        let shape = [0, 1].map(|k| coarse[k] * division.parts[k]);
        let [columns, rows] = shape;
        let half = columns / 2 + 1;
        let phase =
            |k: usize, length: usize| Complex64::from_polar(1.0, PI * k as f64 / length as f64);
        let modes = degree.map_or_else(Vec::new, modes);
        let together = Self {
            division: *division,
            degree,
            part,
            shape,
            coarse,
            plans: RealPlans::new(rows, columns),
            odd: modes.iter().map(is_imaginary).collect(),
            alike: [false, true].map(|odd| {
                let alike = |mode: &usize| is_imaginary(&modes[*mode]) == odd;
                (0..modes.len()).filter(alike).collect()
            }),
            mirrored: modes
                .iter()
                .map(|mode| if mode.parities()[1] { 1.0 } else { -1.0 })
                .collect(),
            kernel: Arc::default(),
            phases: [
                (0..half).map(|k| phase(k, columns)).collect(),
                (0..rows).map(|k| phase(k, rows)).collect(),
            ],
            tops: RwLock::new(vec![0.0; 2 * coarse[0] * modes.len() * coarse[1]]),
            folded: folded_buffers(half, 2 * modes.len() * coarse[1]),
        };
        let kernel = together.kernels(&modes, layers, workers);
        Self {
            kernel: Arc::new(kernel),
            ..together
        }
    }

    /// The same in single precision.
    pub(super) fn rounded(&self) -> Together<f32> {
        let [columns, rows] = self.shape;
        let real = |values: &[f64]| values.iter().map(|value| f32::of(*value)).collect();
        let complex = |values: &Vec<Complex64>| {
            let of = |value: &Complex64| Complex::new(f32::of(value.re), f32::of(value.im));
            values.iter().map(of).collect()
        };
        Together {
            division: self.division,
            degree: self.degree,
            part: self.part,
            shape: self.shape,
            coarse: self.coarse,
            plans: RealPlans::new(rows, columns),
            odd: self.odd.clone(),
            alike: self.alike.clone(),
            mirrored: real(&self.mirrored),
            kernel: Arc::new(real(&self.kernel)),
            phases: self.phases.each_ref().map(complex),
            tops: RwLock::new(vec![
                0.0;
                2 * self.coarse[0] * self.odd.len() * self.coarse[1]
            ]),
            folded: folded_buffers(columns / 2 + 1, 2 * self.odd.len() * self.coarse[1]),
        }
    }

    fn kernels(&self, modes: &[Mode], layers: &[WeightedLayer], workers: Workers<'_>) -> Vec<f64> {
        let (division, degree, part) = (&self.division, self.degree, self.part);
        let [columns, rows] = self.shape;
        let half = columns / 2 + 1;
        let kernels = 1 + modes.len();
        // Rows of the quadrant, transformed along x: those of the floor at integer positions and those of pillars at half-integer
        // positions.
        let quadrant = rows / 2 + 1;
        let rectangles = (!part.is_at_centres()).then(|| Rectangles::new(division, layers));
        let mut transformed = vec![0.0; quadrant * kernels * half];
        let [phases_x, phases_y] = &self.phases;
        let plan = &self.plans.row;
        let work = || KernelWork {
            values: vec![0.0; kernels * columns],
            means: degree.map(|degree| PillarMeans::new(division, degree, layers, part)),
            spectrum: plan.make_output_vec(),
            scratch: plan.make_scratch_vec(),
        };
        workers.fill(
            &mut transformed,
            kernels * half,
            KERNEL_ROWS,
            work,
            |work, row, output| {
                if workers.cancel.is_cancelled() {
                    return;
                }
                work.fill_row(modes, rectangles.as_ref(), row);
                let values = work.values.chunks_exact_mut(columns);
                for (kernel, (values, output)) in
                    values.zip(output.chunks_exact_mut(half)).enumerate()
                {
                    if values.iter().all(|value| *value == 0.0) {
                        // Beyond the near part of pillars; or cells in the far part. The output is zero already.
                        continue;
                    }
                    let _ =
                        plan.process_with_scratch(values, &mut work.spectrum, &mut work.scratch);
                    let odd = kernel > 0 && modes[kernel - 1].parities()[0];
                    for ((value, spectrum), phase) in
                        output.iter_mut().zip(&work.spectrum).zip(phases_x)
                    {
                        *value = real_part(*spectrum, (kernel > 0).then_some(*phase), odd);
                    }
                }
            },
        );
        let root = division.cell_area().sqrt();
        let scale = 1.0 / (columns * rows) as f64;
        let plan = &self.plans.column;
        let stored = kernel_rows(rows);
        let (odd, even): (Vec<usize>, Vec<usize>) =
            (0..modes.len()).partition(|mode| modes[*mode].parities()[1]);
        let work = || {
            let scratch = vec![Complex64::default(); plan.get_inplace_scratch_len()];
            let line = vec![Complex64::default(); rows];
            (line, scratch, vec![0.0; BLOCK_WIDTH * kernels * quadrant])
        };
        type Work = (Vec<Complex64>, Vec<Complex64>, Vec<f64>);
        let several = |(line, scratch, columns): &mut Work, block: usize, output: &mut [f64]| {
            if workers.cancel.is_cancelled() {
                return;
            }
            let first = block * BLOCK_WIDTH;
            let width = BLOCK_WIDTH.min(half - first);
            for (place, values) in transformed.chunks_exact(half).enumerate() {
                let (row, kernel) = (place / kernels, place % kernels);
                let column = columns[kernel * quadrant + row..].iter_mut();
                let values = &values[first..first + width];
                for (column, value) in column.step_by(kernels * quadrant).zip(values) {
                    *column = *value;
                }
            }
            let columns = columns.chunks_exact(kernels * quadrant);
            for (output, columns) in output.chunks_exact_mut(kernels * stored).zip(columns) {
                let value = |kernel: usize, row: usize| columns[kernel * quadrant + row];
                for row in 0..quadrant {
                    line[row] = Complex64::new(value(0, row), 0.0);
                    line[(rows - row) % rows] = line[row];
                }
                plan.process_with_scratch(line, scratch);
                for (output, value) in output[..stored].iter_mut().zip(&*line) {
                    *output = scale * value.re;
                }
                // Transforms two modes of equal parity in y together, as real and imaginary part.
                for pair in even.chunks(2).chain(odd.chunks(2)) {
                    let odd_y = modes[pair[0]].parities()[1];
                    for row in 0..rows / 2 {
                        let of = |k: usize| pair.get(k).map_or(0.0, |mode| value(mode + 1, row));
                        let value = Complex64::new(of(0), of(1));
                        line[row] = value;
                        line[rows - 1 - row] = if odd_y { -value } else { value };
                    }
                    plan.process_with_scratch(line, scratch);
                    for (k, mode) in pair.iter().enumerate() {
                        let odd_x = modes[*mode].parities()[0];
                        // The product of two imaginary factors is negative.
                        let scale = root * if odd_x && odd_y { -scale } else { scale };
                        let output = &mut output[(mode + 1) * stored..][..stored];
                        for ((output, value), phase) in output.iter_mut().zip(&*line).zip(phases_y)
                        {
                            let value = value * phase.conj();
                            *output = scale
                                * match (k, odd_y) {
                                    (0, false) | (1, true) => value.re,
                                    _ => value.im,
                                };
                            if k == 1 && odd_y {
                                *output = -*output;
                            }
                        }
                    }
                }
            }
        };
        let mut kernel = vec![0.0; half * kernels * stored];
        workers.fill(
            &mut kernel,
            BLOCK_WIDTH * kernels * stored,
            1,
            work,
            several,
        );
        kernel
    }
}

/// The real or imaginary part of the transform of an even or odd sequence about its middle, which is half a cell before the first element
/// if there is a phase.
fn real_part(value: Complex64, phase: Option<Complex64>, odd: bool) -> f64 {
    let value = phase.map_or(value, |phase| value * phase.conj());
    if odd { value.im } else { value.re }
}

struct KernelWork {
    /// One row of every kernel.
    values: Vec<f64>,
    means: Option<PillarMeans>,
    spectrum: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl KernelWork {
    fn fill_row(&mut self, modes: &[Mode], rectangles: Option<&Rectangles>, row: usize) {
        let columns = self.values.len() / (1 + modes.len());
        let (of_floor, of_pillars) = self.values.split_at_mut(columns);
        match rectangles {
            Some(rectangles) => rectangles.fill_row(row, &mut of_floor[..columns / 2 + 1]),
            None => of_floor.fill(0.0),
        }
        let (first, second) = of_floor.split_at_mut(columns / 2 + 1);
        for (value, mirrored) in second.iter_mut().rev().zip(&first[1..]) {
            *value = *mirrored;
        }
        if let Some(means) = &mut self.means {
            means.fill_row(row, columns, of_pillars);
        }
        for (mode, values) in modes.iter().zip(of_pillars.chunks_exact_mut(columns)) {
            let sign = if mode.parities()[0] { -1.0 } else { 1.0 };
            let (first, second) = values.split_at_mut(columns / 2);
            for (value, mirrored) in second.iter_mut().rev().zip(first) {
                *value = sign * *mirrored;
            }
        }
    }
}

impl<R: Real> Transform for Together<R> {
    type Real = R;

    fn shape(&self) -> [usize; 2] {
        self.shape
    }

    fn column_count(&self) -> usize {
        self.shape[0] / 2 + 1
    }

    fn row_forward(&self, row: &mut [R], spectrum: &mut [Complex<R>], scratch: &mut [Complex<R>]) {
        self.plans.row_forward(row, spectrum, scratch);
    }

    fn row_back(&self, spectrum: &mut [Complex<R>], row: &mut [R], scratch: &mut [Complex<R>]) {
        self.plans.row_back(spectrum, row, scratch);
    }

    fn convolve(&self, block: &mut ColumnBlock<'_, R>, work: &mut Workspace<R>) {
        let rows = self.shape[1];
        let coarse = self.coarse[1];
        let stride = line_stride(rows);
        let lines = &mut work.lines[..block.width * stride];
        block.read(lines, stride, rows);
        let tops = self.tops.read().unwrap_or_else(PoisonError::into_inner);
        let mut folded = self.folded[block.first / BLOCK_WIDTH]
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let modes = self.odd.len();
        let kernels = (1 + modes) * kernel_rows(rows);
        let kernels = self.kernel[block.first * kernels..].chunks_exact(kernels);
        let folded = folded.chunks_exact_mut((2 * modes * coarse).max(1));
        for (k, ((line, kernel), folded)) in lines
            .chunks_exact_mut(stride)
            .zip(kernels)
            .zip(folded)
            .enumerate()
        {
            let line = &mut line[..rows];
            self.plans
                .column
                .process_with_scratch(line, &mut work.scratch);
            let column = block.first + k;
            let tops = &tops[column % self.coarse[0] * 2 * modes * coarse..][..2 * modes * coarse];
            widest(
                #[inline(always)]
                || {
                    self.meet(
                        self.phases[0][column],
                        line,
                        kernel,
                        tops,
                        folded,
                        &mut work.reals,
                    );
                },
            );
            self.plans
                .column_back
                .process_with_scratch(line, &mut work.scratch);
        }
        block.write(lines, stride);
    }

    fn scratch_len(&self) -> usize {
        self.plans.scratch_len()
    }

    fn columns_at_once(&self) -> usize {
        1
    }

    fn real_count(&self) -> usize {
        9 * self.shape[1]
    }
}

impl<R: Real> Together<R> {
    /// The same kernels with separate buffers, for another solution.
    pub(super) fn with_own_buffers(&self) -> Self {
        let (modes, columns) = (self.odd.len(), self.column_count());
        Self {
            division: self.division,
            degree: self.degree,
            part: self.part,
            shape: self.shape,
            coarse: self.coarse,
            plans: self.plans.clone(),
            odd: self.odd.clone(),
            alike: self.alike.clone(),
            mirrored: self.mirrored.clone(),
            kernel: Arc::clone(&self.kernel),
            phases: self.phases.clone(),
            tops: RwLock::new(vec![
                R::default();
                2 * self.coarse[0] * modes * self.coarse[1]
            ]),
            folded: folded_buffers(columns, 2 * modes * self.coarse[1]),
        }
    }

    /// Combines one column of the floor's transform with that of the pillars.
    #[inline(always)]
    fn meet(
        &self,
        phase: Complex<R>,
        line: &mut [Complex<R>],
        kernel: &[R],
        tops: &[R],
        folded: &mut [R],
        workspace: &mut [R],
    ) {
        let rows = line.len();
        let coarse = self.coarse[1];
        let (phases, workspace) = workspace.split_at_mut(2 * rows);
        let (turned, workspace) = workspace.split_at_mut(2 * rows);
        let (sums, whole) = workspace.split_at_mut(4 * rows);
        let [phase_real, phase_imaginary] = halves(phases);
        let [real, imaginary] = halves(turned);
        turn(phase, &self.phases[1], phase_real, phase_imaginary);
        take(line, phase_real, phase_imaginary, real, imaginary);
        sums.fill(R::default());
        let (even, uneven) = sums.split_at_mut(2 * rows);
        let (of_floor, of_modes) = kernel.split_at(kernel_rows(rows));
        let meeting = Meeting {
            rows,
            coarse,
            kernels: of_modes,
            mirrored: &self.mirrored,
            tops,
            floor: [real, imaginary],
        };
        for (modes, sums) in self.alike.iter().zip([&mut *even, &mut *uneven]) {
            let sums = halves(sums);
            // Lanes as wide as the registers in single precision, if the number of rows is divisible by this width.
            if coarse.is_multiple_of(2 * LANES) {
                meet_modes::<R, { 2 * LANES }>(&meeting, modes, sums, folded);
            } else {
                meet_modes::<R, LANES>(&meeting, modes, sums, folded);
            }
        }
        unfold(of_floor, R::of(1.0), whole);
        let [even_real, even_imaginary] = halves(even);
        let [uneven_real, uneven_imaginary] = halves(uneven);
        // i times the odd modes.
        for (sum, imaginary) in even_real.iter_mut().zip(&*uneven_imaginary) {
            *sum = *sum - *imaginary;
        }
        for (sum, real) in even_imaginary.iter_mut().zip(&*uneven_real) {
            *sum = *sum + *real;
        }
        put(
            line,
            whole,
            even_real,
            even_imaginary,
            phase_real,
            phase_imaginary,
        );
    }
}

/// Processes all modes of a group in the same loop, in groups of four, two or one.
#[inline(always)]
fn meet_modes<R: Real, const L: usize>(
    meeting: &Meeting<'_, R>,
    modes: &[usize],
    [real, imaginary]: [&mut [R]; 2],
    folded: &mut [R],
) {
    let (fours, rest) = modes.as_chunks::<4>();
    let (pairs, rest) = rest.as_chunks::<2>();
    for four in fours {
        meeting.multiply_add::<L, 4>(*four, [real, imaginary], folded);
    }
    for pair in pairs {
        meeting.multiply_add::<L, 2>(*pair, [real, imaginary], folded);
    }
    for mode in rest {
        meeting.multiply_add::<L, 1>([*mode], [real, imaginary], folded);
    }
}
