//! SIMD arithmetic in either precision.
//!
//! Multiplications and additions are fused where the processor supports it, as in the transforms of the library: the last digits depend on
//! the processor.

use super::fft::Real;
use pulp::Simd;
use std::ops::{Deref, DerefMut, Range};

/// Numbers that can be stored in SIMD registers.
pub(crate) trait InRegisters: Real {
    /// A register of numbers.
    type Register<S: Simd>: Copy;

    /// Views numbers as registers; an incomplete last register is left out.
    fn registers<S: Simd>(simd: S, values: &[Self]) -> &[Self::Register<S>];

    fn registers_mut<S: Simd>(simd: S, values: &mut [Self]) -> &mut [Self::Register<S>];

    fn splat<S: Simd>(simd: S, value: Self) -> Self::Register<S>;

    fn plus<S: Simd>(simd: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;

    fn minus<S: Simd>(simd: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;

    fn times<S: Simd>(simd: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;

    fn negative<S: Simd>(simd: S, a: Self::Register<S>) -> Self::Register<S>;

    /// `a b + c`
    fn times_plus<S: Simd>(
        simd: S,
        a: Self::Register<S>,
        b: Self::Register<S>,
        c: Self::Register<S>,
    ) -> Self::Register<S>;
}

macro_rules! in_registers {
    ($number:ty, $register:ident, $as:ident, $as_mut:ident, $splat:ident, $add:ident, $sub:ident, $mul:ident, $xor:ident, $mul_add:ident) => {
        impl InRegisters for $number {
            type Register<S: Simd> = S::$register;

            #[inline(always)]
            fn registers<S: Simd>(_: S, values: &[Self]) -> &[S::$register] {
                S::$as(values).0
            }

            #[inline(always)]
            fn registers_mut<S: Simd>(_: S, values: &mut [Self]) -> &mut [S::$register] {
                S::$as_mut(values).0
            }

            #[inline(always)]
            fn splat<S: Simd>(simd: S, value: Self) -> S::$register {
                simd.$splat(value)
            }

            #[inline(always)]
            fn plus<S: Simd>(simd: S, a: S::$register, b: S::$register) -> S::$register {
                simd.$add(a, b)
            }

            #[inline(always)]
            fn minus<S: Simd>(simd: S, a: S::$register, b: S::$register) -> S::$register {
                simd.$sub(a, b)
            }

            #[inline(always)]
            fn times<S: Simd>(simd: S, a: S::$register, b: S::$register) -> S::$register {
                simd.$mul(a, b)
            }

            #[inline(always)]
            fn negative<S: Simd>(simd: S, a: S::$register) -> S::$register {
                // `Simd::neg_f64s` is not always inlined, and would then be a call in the innermost loops.
                simd.$xor(simd.$splat(-0.0), a)
            }

            #[inline(always)]
            fn times_plus<S: Simd>(
                simd: S,
                a: S::$register,
                b: S::$register,
                c: S::$register,
            ) -> S::$register {
                simd.$mul_add(a, b, c)
            }
        }
    };
}

in_registers!(
    f64,
    f64s,
    as_simd_f64s,
    as_mut_simd_f64s,
    splat_f64s,
    add_f64s,
    sub_f64s,
    mul_f64s,
    xor_f64s,
    mul_add_e_f64s
);
in_registers!(
    f32,
    f32s,
    as_simd_f32s,
    as_mut_simd_f32s,
    splat_f32s,
    add_f32s,
    sub_f32s,
    mul_f32s,
    xor_f32s,
    mul_add_e_f32s
);

/// Size of a cache line in bytes.
const CACHE_LINE: usize = 64;

/// Numbers aligned to cache lines: loads of registers that straddle two lines take twice as long.
pub(crate) struct Aligned<T> {
    values: Vec<T>,
    range: Range<usize>,
}

impl<T: Copy + Default> Aligned<T> {
    pub(crate) fn new(count: usize) -> Self {
        let values = vec![T::default(); count + CACHE_LINE / size_of::<T>()];
        // If the offset cannot be determined, any start is valid.
        let first = values.as_ptr().align_offset(CACHE_LINE);
        let first = first.min(values.len() - count);
        Self {
            values,
            range: first..first + count,
        }
    }
}

impl<T> Deref for Aligned<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.values[self.range.clone()]
    }
}

impl<T> DerefMut for Aligned<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.values[self.range.clone()]
    }
}
