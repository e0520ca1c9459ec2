//! Sums over the rows of transformed columns, with separate vectors of real and imaginary parts.

use crate::numerics::fft::Real;
use num_complex::Complex;

/// Product of the phase of a column with those of rows, in parts.
#[inline(always)]
pub(super) fn turn<R: Real>(
    phase: Complex<R>,
    along: &[Complex<R>],
    real: &mut [R],
    imaginary: &mut [R],
) {
    for ((along, real), imaginary) in along.iter().zip(real).zip(imaginary) {
        *real = phase.re * along.re - phase.im * along.im;
        *imaginary = phase.re * along.im + phase.im * along.re;
    }
}

/// Reads a line, multiplied by conjugate phases, in parts.
#[inline(always)]
pub(super) fn take<R: Real>(
    line: &[Complex<R>],
    phase_real: &[R],
    phase_imaginary: &[R],
    real: &mut [R],
    imaginary: &mut [R],
) {
    let phases = phase_real.iter().zip(phase_imaginary);
    for (((value, (re, im)), real), imaginary) in line.iter().zip(phases).zip(real).zip(imaginary) {
        *real = value.re * *re + value.im * *im;
        *imaginary = value.im * *re - value.re * *im;
    }
}

/// Multiplies a line by a kernel, and adds sums that are multiplied by phases.
#[inline(always)]
pub(super) fn put<R: Real>(
    line: &mut [Complex<R>],
    kernel: &[R],
    real: &[R],
    imaginary: &[R],
    phase_real: &[R],
    phase_imaginary: &[R],
) {
    let sums = real.iter().zip(imaginary);
    let phases = phase_real.iter().zip(phase_imaginary);
    for (((value, kernel), (re, im)), (along_re, along_im)) in
        line.iter_mut().zip(kernel).zip(sums).zip(phases)
    {
        value.re = value.re * *kernel + (*re * *along_re - *im * *along_im);
        value.im = value.im * *kernel + (*re * *along_im + *im * *along_re);
    }
}

/// The real and the imaginary parts, one after the other.
#[inline(always)]
pub(super) fn halves<R>(values: &mut [R]) -> [&mut [R]; 2] {
    values.split_at_mut(values.len() / 2).into()
}

/// Expands the stored rows of a kernel to all rows.
#[inline(always)]
pub(super) fn unfold<R: Real>(stored: &[R], sign: R, whole: &mut [R]) {
    let (first, second) = whole.split_at_mut(stored.len());
    first.copy_from_slice(stored);
    for (value, mirrored) in second.iter_mut().rev().zip(&stored[1..]) {
        *value = sign * *mirrored;
    }
}

/// Modes of pillars and the rows of a column, which are a multiple of those of the coarse grid.
#[derive(Clone, Copy)]
pub(super) struct Meeting<'a, R> {
    /// Number of all rows, and of those of the coarse grid.
    pub(super) rows: usize,
    pub(super) coarse: usize,
    /// The stored rows of the kernel of every mode, and the sign of the others, which are mirror images.
    pub(super) kernels: &'a [R],
    pub(super) mirrored: &'a [R],
    /// Coefficients of every mode: the real parts of its rows, then the imaginary parts.
    pub(super) tops: &'a [R],
    /// The real and the imaginary parts of the floor.
    pub(super) floor: [&'a [R]; 2],
}

impl<R: Real> Meeting<'_, R> {
    /// `sums += kernel tops` over `N` modes and `folded += kernel floor` for each in all rows. The rows of `tops` and `folded`, which have
    /// the same layout, repeat; their number is a multiple of `L`.
    ///
    /// All products for one chunk of rows of the coarse grid are computed together, so that its sums stay in registers.
    #[inline(always)]
    pub(super) fn multiply_add<const L: usize, const N: usize>(
        &self,
        modes: [usize; N],
        [sum_real, sum_imaginary]: [&mut [R]; 2],
        folded: &mut [R],
    ) {
        let stored = self.rows / 2 + 1;
        let kernels = modes.map(|mode| &self.kernels[mode * stored..][..stored]);
        let signs = modes.map(|mode| self.mirrored[mode]);
        for first in (0..self.coarse).step_by(L) {
            let mut tops = [[[R::default(); L]; 2]; N];
            for (tops, mode) in tops.iter_mut().zip(modes) {
                let real = 2 * mode * self.coarse + first;
                *tops = [chunk(self.tops, real), chunk(self.tops, real + self.coarse)];
            }
            let mut folds = [[[R::default(); L]; 2]; N];
            let mut rows = [[R::default(); L]; N];
            for row in (first..self.rows).step_by(self.coarse) {
                if row + L <= stored {
                    for n in 0..N {
                        rows[n] = chunk(kernels[n], row);
                    }
                } else if row >= stored {
                    for n in 0..N {
                        rows[n] = mirror(kernels[n], signs[n], self.rows + 1 - row - L);
                    }
                } else {
                    for n in 0..N {
                        for k in 0..L {
                            rows[n][k] = if row + k < stored {
                                kernels[n][row + k]
                            } else {
                                signs[n] * kernels[n][self.rows - row - k]
                            };
                        }
                    }
                }
                let floor = [chunk(self.floor[0], row), chunk(self.floor[1], row)];
                let sums = [chunk_mut(sum_real, row), chunk_mut(sum_imaginary, row)];
                meet_rows(&rows, &tops, &floor, sums, &mut folds);
            }
            for (mode, folds) in modes.into_iter().zip(&folds) {
                let real = 2 * mode * self.coarse + first;
                *chunk_mut(folded, real) = folds[0];
                *chunk_mut(folded, real + self.coarse) = folds[1];
            }
        }
    }
}

/// The same for some rows.
#[inline(always)]
fn meet_rows<R: Real, const L: usize, const N: usize>(
    kernels: &[[R; L]; N],
    tops: &[[[R; L]; 2]; N],
    floor: &[[R; L]; 2],
    sums: [&mut [R; L]; 2],
    folds: &mut [[[R; L]; 2]; N],
) {
    let [real, imaginary] = sums;
    let mut totals = [*real, *imaginary];
    for n in 0..N {
        for part in 0..2 {
            add_product(&mut totals[part], &kernels[n], &tops[n][part]);
            add_product(&mut folds[n][part], &kernels[n], &floor[part]);
        }
    }
    [*real, *imaginary] = totals;
}

/// `L` values from an index on.
#[inline(always)]
fn chunk<R: Real, const L: usize>(values: &[R], first: usize) -> [R; L] {
    let mut chunk = [R::default(); L];
    chunk.copy_from_slice(&values[first..first + L]);
    chunk
}

#[inline(always)]
fn chunk_mut<R, const L: usize>(values: &mut [R], first: usize) -> &mut [R; L] {
    let chunks = values[first..first + L].as_chunks_mut().0;
    &mut chunks[0]
}

/// The same in reverse order and times a sign.
#[inline(always)]
fn mirror<R: Real, const L: usize>(values: &[R], sign: R, first: usize) -> [R; L] {
    let chunk: [R; L] = chunk(values, first);
    let mut mirrored = [R::default(); L];
    for k in 0..L {
        mirrored[k] = sign * chunk[L - 1 - k];
    }
    mirrored
}

#[inline(always)]
fn add_product<R: Real, const L: usize>(sum: &mut [R; L], a: &[R; L], b: &[R; L]) {
    for k in 0..L {
        sum[k] = sum[k] + a[k] * b[k];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(count: usize, turn: f64) -> Vec<f64> {
        (0..count).map(|k| (turn * k as f64).sin()).collect()
    }

    fn agrees<const L: usize, const N: usize>(modes: [usize; N], coarse: usize, copies: usize) {
        let rows = coarse * copies;
        let stored = rows / 2 + 1;
        let mut kernels = numbers(6 * stored, 1.3);
        let mirrored = [1.0, -1.0, 1.0, -1.0, -1.0, 1.0];
        if rows.is_multiple_of(2) {
            // The middle row is its own mirror image.
            for (kernel, sign) in kernels.chunks_exact_mut(stored).zip(mirrored) {
                kernel[stored - 1] *= 0.5 * (1.0 + sign);
            }
        }
        let tops = numbers(12 * coarse, 0.7);
        let floor = [numbers(rows, 0.3), numbers(rows, 0.2)];
        let meeting = Meeting {
            rows,
            coarse,
            kernels: &kernels,
            mirrored: &mirrored,
            tops: &tops,
            floor: [&floor[0], &floor[1]],
        };
        let mut sums = numbers(2 * rows, 0.9);
        let mut folded = vec![0.0; tops.len()];
        let mut expected = (sums.clone(), folded.clone());
        for mode in modes {
            for row in 0..rows {
                let kernel = match row < stored {
                    true => kernels[mode * stored + row],
                    false => mirrored[mode] * kernels[mode * stored + rows - row],
                };
                for part in 0..2 {
                    let place = (2 * mode + part) * coarse + row % coarse;
                    expected.0[part * rows + row] += kernel * tops[place];
                    expected.1[place] += kernel * floor[part][row];
                }
            }
        }
        meeting.multiply_add::<L, N>(modes, halves(&mut sums), &mut folded);
        let pairs = sums.iter().zip(&expected.0);
        for (value, expected) in pairs.chain(folded.iter().zip(&expected.1)) {
            assert!((value - expected).abs() < 1e-13, "{value} {expected}");
        }
    }

    #[test]
    fn rows_on_both_sides_of_the_middle_meet_every_mode() {
        // Expected: the sums of the definition, row by row.
        for copies in 1..5 {
            agrees::<4, 1>([2], 4, copies);
            agrees::<4, 2>([1, 2], 12, copies);
            agrees::<8, 4>([0, 3, 4, 5], 8, copies);
            agrees::<8, 2>([1, 5], 24, copies);
        }
    }
}
