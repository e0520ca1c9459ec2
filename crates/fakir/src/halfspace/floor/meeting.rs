//! Sums over the rows of a column of transforms, as vectors of real and imaginary parts.

use crate::numerics::fft::Real;
use rustfft::num_complex::Complex;

/// The phase of a column times those of rows, in parts.
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

/// A line, turned back by phases, in parts.
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

/// Multiplies a line by a kernel, and adds sums turned by phases.
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

/// All rows of a kernel, from those that are held.
#[inline(always)]
pub(super) fn unfold<R: Real>(held: &[R], sign: R, whole: &mut [R]) {
    let (first, second) = whole.split_at_mut(held.len());
    first.copy_from_slice(held);
    for (value, mirrored) in second.iter_mut().rev().zip(&held[1..]) {
        *value = sign * *mirrored;
    }
}

/// `sums += kernel tops` and `folded += kernel turned` in all rows, real and imaginary parts; the rows of `tops` and `folded` repeat. Their number
/// is a multiple of `L`.
#[inline(always)]
pub(super) fn multiply_add<R: Real, const L: usize>(
    kernel: &[R],
    turned: [&[R]; 2],
    tops: [&[R]; 2],
    [sum_real, sum_imaginary]: [&mut [R]; 2],
    [fold_real, fold_imaginary]: [&mut [R]; 2],
) {
    let coarse = fold_real.len();
    let [top_real, top_imaginary] = tops.map(|tops| tops.as_chunks::<L>().0);
    let fold_real = fold_real.as_chunks_mut::<L>().0;
    let fold_imaginary = fold_imaginary.as_chunks_mut::<L>().0;
    let sums = sum_real
        .chunks_exact_mut(coarse)
        .zip(sum_imaginary.chunks_exact_mut(coarse));
    let turned = turned[0]
        .chunks_exact(coarse)
        .zip(turned[1].chunks_exact(coarse));
    for ((kernel, sums), turned) in kernel.chunks_exact(coarse).zip(sums).zip(turned) {
        let sums = sums
            .0
            .as_chunks_mut::<L>()
            .0
            .iter_mut()
            .zip(sums.1.as_chunks_mut::<L>().0);
        let folds = fold_real.iter_mut().zip(&mut *fold_imaginary);
        let turned = turned
            .0
            .as_chunks::<L>()
            .0
            .iter()
            .zip(turned.1.as_chunks::<L>().0);
        let tops = top_real.iter().zip(top_imaginary);
        let kernel = kernel.as_chunks::<L>().0.iter();
        for ((((kernel, sum), fold), top), turned) in
            kernel.zip(sums).zip(folds).zip(tops).zip(turned)
        {
            add_product(sum.0, kernel, top.0);
            add_product(sum.1, kernel, top.1);
            add_product(fold.0, kernel, turned.0);
            add_product(fold.1, kernel, turned.1);
        }
    }
}

/// Reads all before it writes, so that it is done at once.
#[inline(always)]
fn add_product<R: Real, const L: usize>(sum: &mut [R; L], a: &[R; L], b: &[R; L]) {
    let (mut value, a, b) = (*sum, *a, *b);
    for k in 0..L {
        value[k] = value[k] + a[k] * b[k];
    }
    *sum = value;
}
