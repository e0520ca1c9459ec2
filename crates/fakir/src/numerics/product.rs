//! Products of dense matrices, in blocks that fit the caches and tiles that fit the registers (K. Goto, R. A. van de Geijn, ACM Trans.
//! Math. Softw. 34, 12 (2008)).
//!
//! Matrices are stored by columns. All sums have the same order on every processor.

use super::simd::{Aligned, InRegisters};
use pulp::{Arch, Simd, WithSimd};

/// Number of columns of the left factor in a block.
const INNER: usize = 256;

/// Number of rows of the left factor in a block: a multiple of the height of a tile. A block takes 200 kB, which fits the second-level
/// cache.
const ROWS: usize = 96;

/// Height of a tile of the product in registers, and its width in columns: twelve registers of sums, two of the left factor and one of the
/// right factor leave one of the sixteen registers of a processor free. Without a free register the compiler spills sums to memory.
const REGISTERS: usize = 2;
const COLUMNS: usize = 6;

/// Largest number of rows in a tile.
const TALLEST: usize = 8 * REGISTERS;

/// A submatrix: its first element is the first of `values`, its columns are `stride` apart.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    pub(super) values: &'a [f64],
    pub(super) stride: usize,
}

/// The right factor of a product, packed by blocks and tiles, and a buffer for a block of the left factor.
pub(super) struct Product {
    left: Aligned<f64>,
    right: Vec<f64>,
    inner: usize,
    columns: usize,
}

impl Product {
    pub(super) fn new() -> Self {
        Self {
            left: Aligned::new(0),
            right: Vec::new(),
            inner: 0,
            columns: 0,
        }
    }

    /// Sets the right factor, of `inner` rows.
    pub(super) fn set_right(
        &mut self,
        inner: usize,
        columns: usize,
        value: impl Fn(usize, usize) -> f64,
    ) {
        (self.inner, self.columns) = (inner, columns);
        self.right.clear();
        self.right
            .reserve(inner * columns.next_multiple_of(COLUMNS));
        for start in (0..inner).step_by(INNER) {
            for first in (0..columns).step_by(COLUMNS) {
                for k in start..inner.min(start + INNER) {
                    let columns = first..first + COLUMNS;
                    let values = columns.map(|j| if j < self.columns { value(k, j) } else { 0.0 });
                    self.right.extend(values);
                }
            }
        }
    }

    /// Adds `factor` times the product of the first `rows` rows of `left` with the right factor to the matrix that begins with `result`,
    /// whose columns are `stride` apart.
    pub(super) fn add(
        &mut self,
        factor: f64,
        left: Part<'_>,
        rows: usize,
        result: &mut [f64],
        stride: usize,
    ) {
        let workspace = rows.min(ROWS).next_multiple_of(TALLEST) * self.inner.min(INNER);
        if self.left.len() < workspace {
            self.left = Aligned::new(workspace);
        }
        Arch::new().dispatch(Addition {
            factor,
            left,
            rows,
            workspace: &mut self.left,
            right: &self.right,
            inner: self.inner,
            columns: self.columns,
            result,
            stride,
        });
    }
}

struct Addition<'a> {
    factor: f64,
    left: Part<'a>,
    rows: usize,
    /// Buffer for a block of the left factor.
    workspace: &'a mut [f64],
    right: &'a [f64],
    inner: usize,
    columns: usize,
    result: &'a mut [f64],
    stride: usize,
}

impl WithSimd for Addition<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let height = REGISTERS * S::F64_LANES;
        let width = self.columns.next_multiple_of(COLUMNS);
        for start in (0..self.inner).step_by(INNER) {
            let inner = INNER.min(self.inner - start);
            let right = &self.right[start * width..][..inner * width];
            let left = Part {
                values: &self.left.values[start * self.left.stride..],
                ..self.left
            };
            for first in (0..self.rows).step_by(ROWS) {
                let rows = ROWS.min(self.rows - first);
                let tiles = rows.div_ceil(height);
                let workspace = &mut self.workspace[..tiles * height * inner];
                for (tile, workspace) in workspace.chunks_exact_mut(height * inner).enumerate() {
                    let row = first + tile * height;
                    pack::<S>(left, row, height.min(self.rows - row), workspace);
                }
                for (group, right) in right.chunks_exact(COLUMNS * inner).enumerate() {
                    let columns = group * COLUMNS..self.columns.min((group + 1) * COLUMNS);
                    for (tile, left) in workspace.chunks_exact(height * inner).enumerate() {
                        let sums = sums(simd, left, right);
                        let row = first + tile * height;
                        let filled = height.min(self.rows - row);
                        for (column, sums) in columns.clone().zip(&sums) {
                            let start = column * self.stride + row;
                            let result = &mut self.result[start..start + filled];
                            add_scaled(simd, self.factor, sums, result);
                        }
                    }
                }
            }
        }
    }
}

/// Copies rows of the left factor by columns, padded with zeros.
#[inline(always)]
fn pack<S: Simd>(left: Part<'_>, row: usize, filled: usize, workspace: &mut [f64]) {
    let height = REGISTERS * S::F64_LANES;
    for (k, workspace) in workspace.chunks_exact_mut(height).enumerate() {
        let values = &left.values[k * left.stride + row..];
        if filled == height {
            workspace.copy_from_slice(&values[..height]);
        } else {
            workspace[..filled].copy_from_slice(&values[..filled]);
            workspace[filled..].fill(0.0);
        }
    }
}

/// Computes a tile: the product of two packed factors.
#[inline(always)]
fn sums<S: Simd>(simd: S, left: &[f64], right: &[f64]) -> [[S::f64s; REGISTERS]; COLUMNS] {
    let mut sums = [[simd.splat_f64s(0.0); REGISTERS]; COLUMNS];
    let (left, _) = f64::registers(simd, left).as_chunks::<REGISTERS>();
    let (right, _) = right.as_chunks::<COLUMNS>();
    for (left, right) in left.iter().zip(right) {
        for (sums, right) in sums.iter_mut().zip(right) {
            let right = simd.splat_f64s(*right);
            for (sum, left) in sums.iter_mut().zip(left) {
                *sum = simd.mul_add_e_f64s(*left, right, *sum);
            }
        }
    }
    sums
}

/// Adds the scaled sums to the result, up to the length of the result.
#[inline(always)]
fn add_scaled<S: Simd>(simd: S, factor: f64, sums: &[S::f64s; REGISTERS], result: &mut [f64]) {
    const { assert!(REGISTERS * S::F64_LANES <= TALLEST) };
    let add = |result: &mut [f64]| {
        let factor = simd.splat_f64s(factor);
        for (result, sum) in f64::registers_mut(simd, result).iter_mut().zip(sums) {
            *result = simd.mul_add_e_f64s(factor, *sum, *result);
        }
    };
    if result.len() == REGISTERS * S::F64_LANES {
        add(result);
    } else {
        let mut whole = [0.0; TALLEST];
        whole[..result.len()].copy_from_slice(result);
        add(&mut whole);
        result.copy_from_slice(&whole[..result.len()]);
    }
}
