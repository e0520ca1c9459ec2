//! The [coupling](super::coupling) of a floor and pillars that are symmetric under reflections of x and of y at the lens axis: on the cells
//! of one quadrant.
//!
//! After a shift by half a cell, the transforms of even functions are real and even. The transform of the floor is therefore a
//! [cosine transform](CosinePlans) of a quarter of the values. The interaction of floor cells, `S^ F^`, and the effect of a mode of the
//! pillars on the floor are transforms of this kind as well. The coefficients of a mode are even or odd in x and y as the mode is; of their
//! transform, only the real part is used if the kernel is real, and only minus the imaginary part if it is imaginary.

use super::coarse::{BesidePillars, Coarse};
use super::far::Part;
use super::grid::Division;
use super::whole::{Together, folded_buffers};
use crate::halfspace::disc::basis::{Mode, modes};
use crate::halfspace::elements::convolution::{
    BLOCK_WIDTH, ColumnBlock, Transform, Workspace, line_stride,
};
use crate::numerics::cosine::CosinePlans;
use crate::numerics::fft::Real;
use crate::numerics::vector::{LANES, widest};
use num_complex::Complex;
use std::sync::{Arc, Mutex, PoisonError, RwLock};

/// The number of stored rows is a multiple of this.
const TOGETHER: usize = 2 * LANES;

/// Transforms and kernels of a quadrant.
pub(super) struct Mirrored<R> {
    pub(super) division: Division,
    pub(super) degree: Option<usize>,
    pub(super) part: Part,
    /// Number of columns and rows of the quadrant, and of the coarse grid.
    shape: [usize; 2],
    pub(super) coarse: [usize; 2],
    plans: CosinePlans<R>,
    /// Whether the kernels of modes are imaginary, and whether the modes are odd in x, and in y.
    odd: Vec<bool>,
    parities: Vec<[bool; 2]>,
    /// For both real columns of every complex column and every kernel, that of the floor first: its [stored](Self::held) rows.
    pub(super) kernel: Arc<Vec<R>>,
    /// The coefficients of the pillars: for every coarse column and every mode, its rows.
    tops: RwLock<Vec<R>>,
    /// For both real columns of every complex column and every mode: folded rows, in blocks.
    folded: Vec<Mutex<Vec<R>>>,
}

impl<R: Real> Mirrored<R> {
    /// Derives the quadrant from the whole.
    pub(super) fn of(whole: &Together<f64>) -> Self {
        let modes = whole.degree.map_or_else(Vec::new, modes);
        let parities: Vec<[bool; 2]> = modes.iter().map(Mode::parities).collect();
        let shape = whole.shape.map(|length| length / 2);
        let [columns, rows] = shape;
        let plans = CosinePlans::new(rows, columns);
        let stored = rows.next_multiple_of(TOGETHER);
        let kernels = 1 + parities.len();
        let stride = whole.kernel.len() / (columns + 1);
        let mut kernel = vec![R::default(); 2 * plans.column_count() * kernels * stored];
        let mut columns_of = kernel.chunks_exact_mut(kernels * stored);
        for complex in 0..plans.column_count() {
            for column in [complex, columns - complex] {
                let Some(to) = columns_of.next() else {
                    continue;
                };
                let from = &whole.kernel[column * stride..][..stride];
                for (to, from) in to
                    .chunks_exact_mut(stored)
                    .zip(from.chunks_exact(stride / kernels))
                {
                    for (to, from) in to.iter_mut().zip(&from[..rows]) {
                        *to = R::of(*from);
                    }
                }
            }
        }
        Self {
            division: whole.division,
            degree: whole.degree,
            part: whole.part,
            shape,
            coarse: whole.coarse,
            odd: whole.odd.clone(),
            kernel: Arc::new(kernel),
            tops: RwLock::default(),
            folded: Vec::new(),
            parities,
            plans,
        }
        .with_own_buffers()
    }

    /// The same kernels with separate buffers, for another solution.
    pub(super) fn with_own_buffers(&self) -> Self {
        let of_column = self.parities.len() * self.coarse[1];
        Self {
            division: self.division,
            degree: self.degree,
            part: self.part,
            shape: self.shape,
            coarse: self.coarse,
            plans: self.plans.clone(),
            odd: self.odd.clone(),
            parities: self.parities.clone(),
            kernel: Arc::clone(&self.kernel),
            tops: RwLock::new(vec![R::default(); self.coarse[0] * of_column]),
            folded: folded_buffers(self.plans.column_count(), 2 * of_column),
        }
    }

    /// Number of stored rows of a column: those of the quadrant, and padding.
    fn stored(&self) -> usize {
        self.shape[1].next_multiple_of(TOGETHER)
    }

    /// Combines one real column of the floor's transform with that of the pillars.
    #[inline(always)]
    fn meet(&self, kernel: &[R], tops: &[R], values: &mut [R], sums: &mut [R], folded: &mut [R]) {
        let coarse = self.coarse[1];
        let (of_floor, of_modes) = kernel.split_at(values.len());
        for ((sum, value), kernel) in sums.iter_mut().zip(&*values).zip(of_floor) {
            *sum = *value * *kernel;
        }
        // Folded rows also receive contributions from the mirror images of the rows; the first row is its own mirror image.
        values[0] = values[0] * R::of(0.5);
        let column = Column {
            rows: self.shape[1],
            coarse,
            kernels: of_modes,
            tops,
            floor: values,
        };
        if coarse.is_multiple_of(2 * LANES) {
            column.meet_all::<{ 2 * LANES }>(self.odd.len(), sums, folded);
        } else {
            column.meet_all::<LANES>(self.odd.len(), sums, folded);
        }
    }
}

/// Modes of pillars and the rows of a real column, which are a multiple of those of the coarse grid.
struct Column<'a, R> {
    /// Number of rows, and of those of the coarse grid.
    rows: usize,
    coarse: usize,
    /// The kernel of every mode.
    kernels: &'a [R],
    /// Coefficients of every mode.
    tops: &'a [R],
    floor: &'a [R],
}

impl<R: Real> Column<'_, R> {
    /// Processes all modes in groups of four, two or one.
    #[inline(always)]
    fn meet_all<const L: usize>(&self, modes: usize, sums: &mut [R], folded: &mut [R]) {
        let mut mode = 0;
        while mode + 4 <= modes {
            self.multiply_add::<L, 4>(mode, sums, folded);
            mode += 4;
        }
        while mode + 2 <= modes {
            self.multiply_add::<L, 2>(mode, sums, folded);
            mode += 2;
        }
        if mode < modes {
            self.multiply_add::<L, 1>(mode, sums, folded);
        }
    }

    /// `sums += kernel tops` over `N` modes from `first` on and `folded = kernel floor` for each in all rows. The rows of `tops` and
    /// `folded` repeat; their number is a multiple of `L`.
    #[inline(always)]
    fn multiply_add<const L: usize, const N: usize>(
        &self,
        mode: usize,
        sums: &mut [R],
        folded: &mut [R],
    ) {
        let stored = self.floor.len();
        let kernels: [&[R]; N] =
            std::array::from_fn(|n| &self.kernels[(mode + n) * stored..][..stored]);
        for first in (0..self.coarse).step_by(L) {
            let place = |n: usize| (mode + n) * self.coarse + first;
            let mut tops = [[R::default(); L]; N];
            for (n, tops) in tops.iter_mut().enumerate() {
                tops.copy_from_slice(&self.tops[place(n)..][..L]);
            }
            let mut folds = [[R::default(); L]; N];
            for row in (first..self.rows).step_by(self.coarse) {
                let mut floor = [R::default(); L];
                floor.copy_from_slice(&self.floor[row..][..L]);
                let mut total = [R::default(); L];
                total.copy_from_slice(&sums[row..][..L]);
                for n in 0..N {
                    let kernel = &kernels[n][row..][..L];
                    for k in 0..L {
                        total[k] = total[k] + kernel[k] * tops[n][k];
                        folds[n][k] = folds[n][k] + kernel[k] * floor[k];
                    }
                }
                sums[row..][..L].copy_from_slice(&total);
            }
            for (n, folds) in folds.iter().enumerate() {
                folded[place(n)..][..L].copy_from_slice(folds);
            }
        }
    }
}

impl<R: Real> Transform for Mirrored<R> {
    type Real = R;

    fn shape(&self) -> [usize; 2] {
        self.shape
    }

    fn column_count(&self) -> usize {
        self.plans.column_count()
    }

    fn row_forward(&self, row: &mut [R], spectrum: &mut [Complex<R>], scratch: &mut [Complex<R>]) {
        self.plans.row_forward(row, spectrum, scratch);
    }

    fn row_back(&self, spectrum: &mut [Complex<R>], row: &mut [R], scratch: &mut [Complex<R>]) {
        self.plans.row_back(spectrum, row, scratch);
    }

    fn convolve(&self, block: &mut ColumnBlock<'_, R>, work: &mut Workspace<R>) {
        let [_, rows] = self.shape;
        let [coarse_columns, coarse] = self.coarse;
        let (modes, stored) = (self.odd.len(), self.stored());
        let stride = line_stride(rows);
        let lines = &mut work.lines[..block.width * stride];
        block.read_to(lines, stride, |row| self.plans.place_of(row));
        let tops = self.tops.read().unwrap_or_else(PoisonError::into_inner);
        let mut folded = self.folded[block.first / BLOCK_WIDTH]
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let folded = folded.chunks_exact_mut((2 * modes * coarse).max(1));
        let kernels = (1 + modes) * stored;
        let (values, sums) = work.reals.split_at_mut(2 * stored);
        for (k, (line, folded)) in lines.chunks_exact_mut(stride).zip(folded).enumerate() {
            let (line, complex) = (&mut line[..rows], block.first + k);
            let (first, second) = values.split_at_mut(stored);
            for values in [&mut *first, &mut *second] {
                values[rows..].fill(R::default());
            }
            let parts = [&mut first[..rows], &mut second[..rows]];
            self.plans.column_forward(line, parts, &mut work.scratch);
            let (one, other) = self.plans.columns_of(complex);
            let (first_sums, second_sums) = sums.split_at_mut(stored);
            let (first_folded, second_folded) = folded.split_at_mut(modes * coarse);
            let columns = [
                (Some(one), first, &mut *first_sums, first_folded),
                (other, second, &mut *second_sums, second_folded),
            ];
            for (part, (column, values, sums, folded)) in columns.into_iter().enumerate() {
                let Some(column) = column else {
                    continue;
                };
                let kernel = &self.kernel[(2 * complex + part) * kernels..][..kernels];
                let tops = &tops[column % coarse_columns * modes * coarse..][..modes * coarse];
                widest(
                    #[inline(always)]
                    || self.meet(kernel, tops, values, sums, folded),
                );
            }
            if other.is_none() {
                if complex == 0 {
                    second_sums.fill(R::default());
                } else {
                    second_sums.copy_from_slice(first_sums);
                }
            }
            let parts = [&first_sums[..rows], &second_sums[..rows]];
            self.plans.column_back(parts, line, &mut work.scratch);
        }
        block.write_from(lines, stride, |row| self.plans.place_of(row));
    }

    fn scratch_len(&self) -> usize {
        self.plans.scratch_len()
    }

    fn columns_at_once(&self) -> usize {
        1
    }

    fn real_count(&self) -> usize {
        4 * self.stored()
    }
}

impl<R: Real> BesidePillars for Mirrored<R> {
    fn odd(&self) -> &[bool] {
        &self.odd
    }

    fn take_mode(&self, coarse: &mut Coarse, mode: usize) {
        let mut spectra = self.tops.write().unwrap_or_else(PoisonError::into_inner);
        coarse.mirror(self.parities[mode]);
        coarse.transform();
        coarse.write_real(mode, self.odd[mode], &mut spectra);
    }

    #[cfg(any(test, feature = "kernels"))]
    fn kernel_count(&self) -> usize {
        self.kernel.len()
    }

    fn gather(&self, coarse: &mut Coarse) {
        let columns = |complex: usize| self.plans.columns_of(complex);
        coarse.gather_real(columns, &self.parities, &self.folded);
    }
}
