//! Fast Fourier transforms of columns that are stored side by side, for convolutions.
//!
//! A convolution does not depend on the order of frequencies if the kernels have the same order. Frequencies are therefore not permuted:
//! the forward transform leaves them where its butterflies put them ([`ColumnTransform::frequencies`]), and the inverse transform starts
//! from this order. A *line* contains the numbers of [`COLUMNS`] columns in one row: their real parts, then their imaginary parts. A
//! butterfly is the same few sums of registers for all columns of a line in every stage.
//!
//! A row consists of one or more lines. The first forward stage reads only the rows that exist and takes the others as zeros; the last
//! inverse stage writes only the rows that are requested. The inner stages run block by block. The blocks of the last few stages are short
//! and stay in the cache, so that products with kernels can be computed between the forward and the inverse transform of a block.

use super::simd::InRegisters;
use pulp::Simd;
use std::cell::Cell;
use std::f64::consts::TAU;

/// Number of columns in a line.
pub(crate) const COLUMNS: usize = 8;

/// Number of real numbers in a line.
pub(crate) const LINE: usize = 2 * COLUMNS;

pub(crate) struct ColumnTransform<R> {
    length: usize,
    /// The forward stages; the inverse transform uses them in reverse order.
    stages: Vec<Stage<R>>,
    /// Index of the first stage that runs block by block.
    inner: usize,
}

/// Number of lines in a row, and number of registers of each part of a line that are processed together.
#[derive(Clone, Copy)]
pub(crate) struct SideBySide {
    pub(crate) lines: usize,
    pub(crate) used: usize,
}

impl<R: InRegisters> ColumnTransform<R> {
    /// Plans transforms of columns whose length is a product of powers of 2, 3 and 5. Blocks have at most `at_once` rows.
    pub(crate) fn new(length: usize, at_once: usize) -> Self {
        let mut stages: Vec<Stage<R>> = Vec::new();
        let mut span = length;
        while span > 1 {
            let radix = [4, 2, 3, 5].into_iter().find(|r| span.is_multiple_of(*r));
            debug_assert!(radix.is_some(), "a column of {length} numbers");
            let radix = radix.unwrap_or(span);
            stages.push(Stage::new(radix, span));
            span /= radix;
        }
        let inner = (1..stages.len())
            .find(|stage| stages[*stage].span <= at_once)
            .unwrap_or(stages.len());
        Self {
            length,
            stages,
            inner,
        }
    }

    /// The frequency at every position of the transformed column.
    pub(crate) fn frequencies(&self) -> Vec<usize> {
        let frequency = |place: usize| {
            let (mut frequency, mut unit, mut rest) = (0, 1, place);
            for stage in &self.stages {
                let part = stage.span / stage.radix;
                frequency += unit * (rest / part);
                rest %= part;
                unit *= stage.radix;
            }
            frequency
        };
        (0..self.length).map(frequency).collect()
    }

    /// Number of rows in a block.
    pub(crate) fn inner_length(&self) -> usize {
        self.stages.get(self.inner).map_or(1, |stage| stage.span)
    }

    /// Runs the forward stages that precede the blocks, from the existing rows to all rows.
    #[inline(always)]
    pub(crate) fn enter<S: Simd>(
        &self,
        simd: S,
        source: &mut [R::Register<S>],
        target: &mut [R::Register<S>],
        side_by_side: SideBySide,
    ) {
        let Some((first, rest)) = self.stages[..self.inner].split_first() else {
            // The transform of a column of one number is this number.
            target.copy_from_slice(source);
            return;
        };
        let from = Cell::from_mut(source).as_slice_of_cells();
        let to = Cell::from_mut(&mut *target).as_slice_of_cells();
        first.run::<S, false, false>(simd, from, to, side_by_side);
        for stage in rest {
            stage.in_place::<S, false>(simd, target, side_by_side);
        }
    }

    /// Runs the forward stages of one block.
    #[inline(always)]
    pub(crate) fn forward<S: Simd>(
        &self,
        simd: S,
        block: &mut [R::Register<S>],
        side_by_side: SideBySide,
    ) {
        for stage in &self.stages[self.inner..] {
            stage.in_place::<S, false>(simd, block, side_by_side);
        }
    }

    /// Runs the inverse stages of one block.
    #[inline(always)]
    pub(crate) fn back<S: Simd>(
        &self,
        simd: S,
        block: &mut [R::Register<S>],
        side_by_side: SideBySide,
    ) {
        for stage in self.stages[self.inner..].iter().rev() {
            stage.in_place::<S, true>(simd, block, side_by_side);
        }
    }

    /// Runs the inverse stages that follow the blocks, without normalisation, and writes the requested rows.
    #[inline(always)]
    pub(crate) fn leave<S: Simd>(
        &self,
        simd: S,
        source: &mut [R::Register<S>],
        target: &mut [R::Register<S>],
        side_by_side: SideBySide,
    ) {
        let Some((first, rest)) = self.stages[..self.inner].split_first() else {
            target.copy_from_slice(source);
            return;
        };
        for stage in rest.iter().rev() {
            stage.in_place::<S, true>(simd, source, side_by_side);
        }
        let from = Cell::from_mut(source).as_slice_of_cells();
        let to = Cell::from_mut(target).as_slice_of_cells();
        first.run::<S, true, false>(simd, from, to, side_by_side);
    }
}

/// Number of registers in a line: twice the number for its real parts.
#[inline(always)]
pub(crate) fn registers_of_line<R: InRegisters, S: Simd>(simd: S) -> usize {
    R::registers(simd, &[R::default(); LINE]).len()
}

/// Complex numbers, one for each column of a register.
struct Numbers<R: InRegisters, S: Simd> {
    re: R::Register<S>,
    im: R::Register<S>,
}

impl<R: InRegisters, S: Simd> Clone for Numbers<R, S> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<R: InRegisters, S: Simd> Copy for Numbers<R, S> {}

impl<R: InRegisters, S: Simd> Numbers<R, S> {
    #[inline(always)]
    fn plus(self, simd: S, other: Self) -> Self {
        Self {
            re: R::plus(simd, self.re, other.re),
            im: R::plus(simd, self.im, other.im),
        }
    }

    #[inline(always)]
    fn minus(self, simd: S, other: Self) -> Self {
        Self {
            re: R::minus(simd, self.re, other.re),
            im: R::minus(simd, self.im, other.im),
        }
    }

    /// `self + factor other`
    #[inline(always)]
    fn plus_times(self, simd: S, factor: f64, other: Self) -> Self {
        let factor = R::splat(simd, R::of(factor));
        Self {
            re: R::times_plus(simd, factor, other.re, self.re),
            im: R::times_plus(simd, factor, other.im, self.im),
        }
    }

    #[inline(always)]
    fn scaled(self, simd: S, factor: f64) -> Self {
        let factor = R::splat(simd, R::of(factor));
        Self {
            re: R::times(simd, factor, self.re),
            im: R::times(simd, factor, self.im),
        }
    }

    /// `self - i other` and `self + i other`; exchanged in the inverse transform.
    #[inline(always)]
    fn with_turned<const BACK: bool>(self, simd: S, other: Self) -> [Self; 2] {
        let clockwise = Self {
            re: R::plus(simd, self.re, other.im),
            im: R::minus(simd, self.im, other.re),
        };
        let counterclockwise = Self {
            re: R::minus(simd, self.re, other.im),
            im: R::plus(simd, self.im, other.re),
        };
        if BACK {
            [counterclockwise, clockwise]
        } else {
            [clockwise, counterclockwise]
        }
    }

    /// Product with a complex number, or with its conjugate in the inverse transform.
    #[inline(always)]
    fn times<const BACK: bool>(self, simd: S, [re, im]: [R; 2]) -> Self {
        let im = R::splat(simd, if BACK { R::default() - im } else { im });
        let re = R::splat(simd, re);
        let minus_im = R::negative(simd, im);
        Self {
            re: R::times_plus(simd, self.im, minus_im, R::times(simd, self.re, re)),
            im: R::times_plus(simd, self.re, im, R::times(simd, self.im, re)),
        }
    }
}

/// Discrete Fourier transform of `RADIX` numbers.
#[inline(always)]
fn butterfly<R: InRegisters, S: Simd, const RADIX: usize, const BACK: bool>(
    simd: S,
    x: [Numbers<R, S>; RADIX],
) -> [Numbers<R, S>; RADIX] {
    let mut y = x;
    match RADIX {
        2 => {
            y[0] = x[0].plus(simd, x[1]);
            y[1] = x[0].minus(simd, x[1]);
        }
        3 => {
            let sum = x[1].plus(simd, x[2]);
            let difference = x[1].minus(simd, x[2]).scaled(simd, 0.5 * 3f64.sqrt());
            y[0] = x[0].plus(simd, sum);
            let middle = x[0].plus_times(simd, -0.5, sum);
            [y[1], y[2]] = middle.with_turned::<BACK>(simd, difference);
        }
        4 => {
            let (a, b) = (x[0].plus(simd, x[2]), x[0].minus(simd, x[2]));
            let (c, d) = (x[1].plus(simd, x[3]), x[1].minus(simd, x[3]));
            y[0] = a.plus(simd, c);
            y[2] = a.minus(simd, c);
            [y[1], y[3]] = b.with_turned::<BACK>(simd, d);
        }
        _ => {
            let (cos, cos_twice) = ((TAU / 5.0).cos(), (2.0 * TAU / 5.0).cos());
            let (sin, sin_twice) = ((TAU / 5.0).sin(), (2.0 * TAU / 5.0).sin());
            let (a, b) = (x[1].plus(simd, x[4]), x[2].plus(simd, x[3]));
            let (c, d) = (x[1].minus(simd, x[4]), x[2].minus(simd, x[3]));
            y[0] = x[0].plus(simd, a).plus(simd, b);
            let even = x[0].plus_times(simd, cos, a).plus_times(simd, cos_twice, b);
            let odd = c.scaled(simd, sin).plus_times(simd, sin_twice, d);
            [y[1], y[4]] = even.with_turned::<BACK>(simd, odd);
            let even = x[0].plus_times(simd, cos_twice, a).plus_times(simd, cos, b);
            let odd = c.scaled(simd, sin_twice).plus_times(simd, -sin, d);
            [y[2], y[3]] = even.with_turned::<BACK>(simd, odd);
        }
    }
    y
}

/// A stage: transforms blocks of `span` rows, each divided into as many parts as the radix.
struct Stage<R> {
    radix: usize,
    span: usize,
    /// Twiddle factors of all parts but the first, for every row of a part.
    factors: Vec<[R; 2]>,
}

impl<R: InRegisters> Stage<R> {
    fn new(radix: usize, span: usize) -> Self {
        let of_row = |row: usize| {
            (1..radix).map(move |part| {
                let angle = -TAU * (row * part) as f64 / span as f64;
                [R::of(angle.cos()), R::of(angle.sin())]
            })
        };
        Self {
            radix,
            span,
            factors: (0..span / radix).flat_map(of_row).collect(),
        }
    }

    #[inline(always)]
    fn in_place<S: Simd, const BACK: bool>(
        &self,
        simd: S,
        rows: &mut [R::Register<S>],
        side_by_side: SideBySide,
    ) {
        let rows = Cell::from_mut(rows).as_slice_of_cells();
        self.run::<S, BACK, true>(simd, rows, rows, side_by_side);
    }

    /// Runs the stage out of place or in place: on all blocks if they are whole, or on one that may be incomplete.
    #[inline(always)]
    fn run<S: Simd, const BACK: bool, const WHOLE: bool>(
        &self,
        simd: S,
        source: &[Cell<R::Register<S>>],
        target: &[Cell<R::Register<S>>],
        side_by_side: SideBySide,
    ) {
        match self.radix {
            2 => self.blocks::<S, 2, BACK, WHOLE>(simd, source, target, side_by_side),
            3 => self.blocks::<S, 3, BACK, WHOLE>(simd, source, target, side_by_side),
            4 => self.blocks::<S, 4, BACK, WHOLE>(simd, source, target, side_by_side),
            _ => self.blocks::<S, 5, BACK, WHOLE>(simd, source, target, side_by_side),
        }
    }

    #[inline(always)]
    fn blocks<S: Simd, const RADIX: usize, const BACK: bool, const WHOLE: bool>(
        &self,
        simd: S,
        source: &[Cell<R::Register<S>>],
        target: &[Cell<R::Register<S>>],
        side_by_side: SideBySide,
    ) {
        if !WHOLE {
            self.block::<S, RADIX, BACK, WHOLE>(simd, source, target, side_by_side);
            return;
        }
        let of_block = self.span * side_by_side.lines * registers_of_line::<R, S>(simd);
        // `zip` is not always inlined here, and would then cost a call for each short block.
        let mut first = 0;
        while first + of_block <= source.len() {
            let (source, target) = (&source[first..][..of_block], &target[first..][..of_block]);
            self.block::<S, RADIX, BACK, WHOLE>(simd, source, target, side_by_side);
            first += of_block;
        }
    }

    /// Transforms a block out of place or in place. Unless source and target are whole, missing rows of the source are zeros, and missing
    /// rows of the target are skipped.
    #[inline(always)]
    fn block<S: Simd, const RADIX: usize, const BACK: bool, const WHOLE: bool>(
        &self,
        simd: S,
        source: &[Cell<R::Register<S>>],
        target: &[Cell<R::Register<S>>],
        SideBySide { lines, used }: SideBySide,
    ) {
        let width = registers_of_line::<R, S>(simd);
        let used = used.min(width / 2);
        let of_row = lines * width;
        let part = self.span / RADIX * of_row;
        let zero = R::splat(simd, R::default());
        for (row, factors) in self.factors.chunks_exact(RADIX - 1).enumerate() {
            let (mut from, mut to) = ([&source[..0]; RADIX], [&target[..0]; RADIX]);
            for p in 0..RADIX {
                let first = p * part + row * of_row;
                if WHOLE || first < source.len() {
                    from[p] = &source[first..][..of_row];
                }
                if WHOLE || first < target.len() {
                    to[p] = &target[first..][..of_row];
                }
            }
            // The factors of the last stage are 1.
            let has_factors = part > of_row;
            // Indices are compared with the end of the row, so that the compiler can remove bounds checks.
            let mut line = 0;
            while line + width <= of_row {
                for k in 0..used {
                    let (re, im) = (line + k, line + width / 2 + k);
                    let mut x = [Numbers { re: zero, im: zero }; RADIX];
                    for p in 0..RADIX {
                        if WHOLE || !from[p].is_empty() {
                            x[p] = Numbers {
                                re: from[p][re].get(),
                                im: from[p][im].get(),
                            };
                        }
                    }
                    if BACK && has_factors {
                        for p in 1..RADIX {
                            x[p] = x[p].times::<BACK>(simd, factors[p - 1]);
                        }
                    }
                    let mut y = butterfly::<R, S, RADIX, BACK>(simd, x);
                    if !BACK && has_factors {
                        for p in 1..RADIX {
                            y[p] = y[p].times::<BACK>(simd, factors[p - 1]);
                        }
                    }
                    for p in 0..RADIX {
                        if WHOLE || !to[p].is_empty() {
                            to[p][re].set(y[p].re);
                            to[p][im].set(y[p].im);
                        }
                    }
                }
                line += width;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir_fft::Transformable;
    use num_complex::Complex64;
    use pulp::{Arch, WithSimd};

    /// Number of lines in a row.
    const SIDE_BY_SIDE: usize = 2;

    /// Forward and inverse transform through blocks, with the spectrum between them.
    struct ThereAndBack<'a, R> {
        transform: &'a ColumnTransform<R>,
        values: &'a mut [R],
        spectrum: &'a mut [R],
    }

    impl<R: InRegisters> WithSimd for ThereAndBack<'_, R> {
        type Output = ();

        fn with_simd<S: Simd>(self, simd: S) {
            let width = registers_of_line::<R, S>(simd);
            let (lines, used) = (SIDE_BY_SIDE, width / 2);
            let values = R::registers_mut(simd, self.values);
            let all = R::registers_mut(simd, self.spectrum);
            let both = SideBySide { lines, used };
            let transform = self.transform;
            transform.enter(simd, values, all, both);
            let block = transform.inner_length() * lines * width;
            for block in all.chunks_exact_mut(block) {
                transform.forward(simd, block, both);
            }
            let mut copy = all.to_vec();
            for block in copy.chunks_exact_mut(block) {
                transform.back(simd, block, both);
            }
            transform.leave(simd, &mut copy, values, both);
        }
    }

    fn check<R: InRegisters>(length: usize, rows: usize, at_once: usize, precision: f64) {
        let transform = ColumnTransform::<R>::new(length, at_once);
        let number = |k: usize| (0.7 * k as f64 + 0.3 * (k as f64).sqrt()).sin();
        let of_row = SIDE_BY_SIDE * LINE;
        let before: Vec<R> = (0..rows * of_row).map(|k| R::of(number(k))).collect();
        let mut values = before.clone();
        let mut spectrum = vec![R::default(); length * of_row];
        Arch::new().dispatch(ThereAndBack {
            transform: &transform,
            values: &mut values,
            spectrum: &mut spectrum,
        });
        let frequencies = transform.frequencies();
        for (line, column) in
            (0..SIDE_BY_SIDE).flat_map(|line| (0..COLUMNS).map(move |k| (line, k)))
        {
            let complex = |row: &[R]| {
                let line = &row[line * LINE..];
                Complex64::new(line[column].double(), line[COLUMNS + column].double())
            };
            let mut expected: Vec<Complex64> = before.chunks_exact(of_row).map(complex).collect();
            expected.resize(length, Complex64::default());
            f64::forward(length).process(&mut expected);
            for (row, frequency) in spectrum.chunks_exact(of_row).zip(&frequencies) {
                let error = (complex(row) - expected[*frequency]).norm();
                assert!(error < precision * length as f64, "{length}: {error}");
            }
        }
        for (found, expected) in values.iter().zip(&before) {
            let error = (found.double() / length as f64 - expected.double()).abs();
            assert!(error < 8.0 * precision, "{length}: {error}");
        }
    }

    /// Compares with the transforms of the library, for all radices, for columns with and without zeros at their ends, with and without
    /// blocks.
    #[test]
    fn columns_have_their_transforms() {
        for (length, rows) in [
            (1, 1),
            (2, 1),
            (3, 3),
            (4, 2),
            (5, 2),
            (8, 5),
            (16, 16),
            (18, 7),
            (48, 27),
            (80, 33),
            (128, 71),
            (720, 383),
        ] {
            for at_once in [1, 50, 1000] {
                check::<f64>(length, rows, at_once, 4e-16);
                check::<f32>(length, rows, at_once, 2e-7);
            }
        }
    }
}
