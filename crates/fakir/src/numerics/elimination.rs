//! Solves the symmetric positive definite systems of single pillars, most of which are so small that the call overhead of a library would
//! dominate.
//!
//! A matrix is factorised as `L D L'` with ones on the diagonal of `L`, by blocks of four rows and columns. A block of rows contains four
//! numbers of every column, column by column, so that loops over columns read memory sequentially. The last block is padded with rows and
//! columns of a unit matrix.

use super::simd::{Aligned, InRegisters};
use pulp::{Arch, Simd, WithSimd};

/// Number of rows and columns in a block.
pub(crate) const BLOCK: usize = 4;

/// Numbers in a square block.
const SQUARE: usize = BLOCK * BLOCK;

/// A factorised matrix, with space for rows below it.
pub(crate) struct Elimination {
    /// Number of blocks of rows in the matrix.
    blocks: usize,
    /// `L` below the diagonal blocks, one block of rows after another, each without trailing zeros. Contains `L D` during the
    /// factorisation.
    rows: Aligned<f64>,
    corners: Vec<Corner>,
    /// A block of rows before the division by the diagonal.
    undivided: Vec<f64>,
    /// Blocks of rows below the matrix, in the same format.
    below: Aligned<f64>,
}

/// The diagonal block of a block of rows.
#[derive(Debug, Clone, Copy, Default)]
struct Corner {
    /// `1/D`
    inverses: [f64; BLOCK],
    /// Elements of `L` in the second row, in the third and in the last.
    second: f64,
    third: [f64; 2],
    last: [f64; 3],
}

impl Elimination {
    /// Allocates space for at most `most` unknowns and `most_below` rows below them.
    pub(crate) fn new(most: usize, most_below: usize) -> Self {
        let [blocks, below] = [most, most_below].map(|count| count.div_ceil(BLOCK));
        Self {
            blocks: 0,
            rows: Aligned::new(start(blocks)),
            corners: vec![Corner::default(); blocks],
            undivided: vec![0.0; blocks * SQUARE],
            below: Aligned::new(below * blocks * SQUARE),
        }
    }

    /// Factorises the rows and columns `indices` of a matrix whose row `k` begins at `k count`. Returns `false` if they are not positive
    /// definite.
    pub(crate) fn factorise(&mut self, matrix: &[f64], count: usize, indices: &[usize]) -> bool {
        self.blocks = indices.len().div_ceil(BLOCK);
        self.take(matrix, count, indices);
        Arch::new().dispatch(Factorisation {
            rows: &mut self.rows[..start(self.blocks)],
            corners: &mut self.corners[..self.blocks],
            undivided: &mut self.undivided,
        })
    }

    /// Copies the lower triangle, including complete blocks on the diagonal.
    fn take(&mut self, matrix: &[f64], count: usize, indices: &[usize]) {
        for block in 0..self.blocks {
            let row = &mut self.rows[start(block)..start(block + 1)];
            let (columns, _) = row.as_chunks_mut::<BLOCK>();
            let others = &indices[BLOCK * block..];
            if let Some((others, _)) = others.split_first_chunk::<BLOCK>() {
                for (column, own) in columns.iter_mut().zip(indices) {
                    let from = &matrix[own * count..(own + 1) * count];
                    *column = others.map(|other| from[other]);
                }
            } else {
                for (number, column) in columns.iter_mut().enumerate() {
                    *column =
                        std::array::from_fn(|lane| match (indices.get(number), others.get(lane)) {
                            (Some(own), Some(other)) => matrix[own * count + other],
                            _ => f64::from(u8::from(number == BLOCK * block + lane)),
                        });
                }
            }
        }
    }

    /// Solves the system in place. The length of `right` is a multiple of four; the numbers after the unknowns are left undefined.
    pub(crate) fn solve(&self, right: &mut [f64]) {
        let rows = &self.rows[..start(self.blocks)];
        let corners = &self.corners[..self.blocks];
        Arch::new().dispatch(Solution {
            rows,
            corners,
            right,
        });
    }

    /// Computes `W' G^-1 W` by rows. The columns of `W` must be zero after the unknowns.
    pub(crate) fn projected_inverse(
        &mut self,
        columns: usize,
        product: &mut [f64],
        value: impl Fn(usize, usize) -> f64,
    ) {
        let length = self.blocks * SQUARE;
        let below = &mut self.below[..columns.div_ceil(BLOCK) * length];
        for (group, row) in below.chunks_exact_mut(length.max(1)).enumerate() {
            let first = BLOCK * group;
            for (number, values) in row.as_chunks_mut::<BLOCK>().0.iter_mut().enumerate() {
                let at = |lane: usize| {
                    if first + lane < columns {
                        value(number, first + lane)
                    } else {
                        0.0
                    }
                };
                *values = [at(0), at(1), at(2), at(3)];
            }
        }
        // Without unknowns, the product is zero.
        product.fill(0.0);
        Arch::new().dispatch(Projection {
            rows: &self.rows[..start(self.blocks)],
            corners: &self.corners[..self.blocks],
            below,
            columns,
            product,
        });
    }
}

/// Start of a block of rows.
const fn start(block: usize) -> usize {
    SQUARE * block * (block + 1) / 2
}

struct Factorisation<'a> {
    rows: &'a mut [f64],
    corners: &'a mut [Corner],
    undivided: &'a mut [f64],
}

impl WithSimd for Factorisation<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        for block in 0..self.corners.len() {
            let (done, behind) = self.rows.split_at_mut(start(block + 1));
            let (before, corner) = self.corners.split_at_mut(block);
            let own = &mut done[start(block)..];
            let undivided = &mut self.undivided[..own.len()];
            undivided.copy_from_slice(own);
            let (ratios, _) = own.split_at_mut(block * SQUARE);
            divide(ratios, before);
            eliminate(simd, ratios, &Corner::default(), [&mut *undivided]);
            let Some(found) = Corner::of(&undivided[block * SQUARE..]) else {
                return false;
            };
            corner[0] = found;
            let length = (block + 2) * SQUARE;
            eliminate_all(simd, ratios, &found, behind, [length, SQUARE]);
        }
        true
    }
}

/// Divides every column by its element on the diagonal.
#[inline(always)]
fn divide(row: &mut [f64], corners: &[Corner]) {
    for (columns, corner) in row.chunks_exact_mut(SQUARE).zip(corners) {
        let columns = columns.as_chunks_mut::<BLOCK>().0.iter_mut();
        for (column, inverse) in columns.zip(corner.inverses) {
            for value in column {
                *value *= inverse;
            }
        }
    }
}

/// Applies [`eliminate`] to consecutive blocks of rows. The first has the given length, and each is longer than the preceding one by the
/// given number.
#[inline(always)]
fn eliminate_all<S: Simd>(
    simd: S,
    ratios: &[f64],
    corner: &Corner,
    mut rows: &mut [f64],
    [mut length, more]: [usize; 2],
) {
    // Two blocks at a time, limited by the number of registers.
    while !rows.is_empty() {
        let (one, rest) = rows.split_at_mut(length);
        if rest.is_empty() {
            eliminate(simd, ratios, corner, [one]);
            return;
        }
        let (other, rest) = rest.split_at_mut(length + more);
        eliminate(simd, ratios, corner, [one, other]);
        rows = rest;
        length += 2 * more;
    }
}

/// Subtracts the contributions of the preceding columns, and of the four columns among each other, from four columns of some blocks of
/// rows. `ratios` contains the preceding columns of the rows in which the diagonal block of these four columns is located.
#[inline(always)]
fn eliminate<S: Simd, const N: usize>(
    simd: S,
    ratios: &[f64],
    corner: &Corner,
    rows: [&mut [f64]; N],
) {
    // Number of registers for four numbers.
    let parts = const {
        assert!(S::F64_LANES <= BLOCK);
        BLOCK / S::F64_LANES
    };
    let rows = rows.map(|row| row[..ratios.len() + SQUARE].split_at_mut(ratios.len()));
    let rows = rows.map(|(before, own)| {
        let before = f64::registers(simd, before);
        (before, f64::registers_mut(simd, own))
    });
    let minus = |value: f64, a, b| simd.mul_add_e_f64s(simd.splat_f64s(-value), a, b);
    for part in 0..parts {
        let mut sums = [[simd.splat_f64s(0.0); BLOCK]; N];
        for (column, ratios) in ratios.as_chunks::<BLOCK>().0.iter().enumerate() {
            let here: [S::f64s; N] = std::array::from_fn(|row| rows[row].0[column * parts + part]);
            for lane in 0..BLOCK {
                let ratio = simd.splat_f64s(ratios[lane]);
                for row in 0..N {
                    sums[row][lane] = simd.mul_add_e_f64s(ratio, here[row], sums[row][lane]);
                }
            }
        }
        for (row, sums) in sums.into_iter().enumerate() {
            let own = std::array::from_fn(|lane| {
                simd.sub_f64s(rows[row].1[lane * parts + part], sums[lane])
            });
            let [x, y, z, w]: [S::f64s; BLOCK] = own;
            let y = minus(corner.second, x, y);
            let z = minus(corner.third[1], y, minus(corner.third[0], x, z));
            let w = minus(corner.last[1], y, minus(corner.last[0], x, w));
            let w = minus(corner.last[2], z, w);
            for (lane, value) in [x, y, z, w].into_iter().enumerate() {
                rows[row].1[lane * parts + part] = value;
            }
        }
    }
}

impl Corner {
    /// Factorises a square that is stored by columns; only its lower triangle is used. Returns `None` if it is not positive definite.
    #[inline(always)]
    fn of(square: &[f64]) -> Option<Self> {
        let [a, b, c, d] = square[..BLOCK] else {
            return None;
        };
        let [_, e, f, g] = square[BLOCK..2 * BLOCK] else {
            return None;
        };
        let [_, _, h, i] = square[2 * BLOCK..3 * BLOCK] else {
            return None;
        };
        let j = square[SQUARE - 1];
        let of_a = a.recip();
        let [b_of_a, c_of_a, d_of_a] = [b, c, d].map(|value| value * of_a);
        let e = e - b * b_of_a;
        let of_e = e.recip();
        let [f, g] = [f - c * b_of_a, g - d * b_of_a];
        let [f_of_e, g_of_e] = [f, g].map(|value| value * of_e);
        let h = (h - c * c_of_a) - f * f_of_e;
        let of_h = h.recip();
        let i = (i - d * c_of_a) - g * f_of_e;
        let i_of_h = i * of_h;
        let j = ((j - d * d_of_a) - g * g_of_e) - i * i_of_h;
        let positive = [a, e, h, j].iter().all(|pivot| *pivot > 0.0);
        positive.then_some(Self {
            inverses: [of_a, of_e, of_h, j.recip()],
            second: b_of_a,
            third: [c_of_a, f_of_e],
            last: [d_of_a, g_of_e, i_of_h],
        })
    }
}

struct Solution<'a> {
    rows: &'a [f64],
    corners: &'a [Corner],
    right: &'a mut [f64],
}

impl WithSimd for Solution<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            rows,
            corners,
            right,
        } = self;
        let parts = BLOCK / S::F64_LANES;
        for (block, corner) in corners.iter().enumerate() {
            let (known, own) = right.split_at_mut(block * BLOCK);
            let row = f64::registers(simd, &rows[start(block)..][..block * SQUARE]);
            let own = &mut own[..BLOCK];
            for part in 0..parts {
                let mut sums = [simd.splat_f64s(0.0); BLOCK];
                let fours = row.chunks_exact(BLOCK * parts);
                for (columns, known) in fours.zip(known.as_chunks::<BLOCK>().0) {
                    for lane in 0..BLOCK {
                        let known = simd.splat_f64s(known[lane]);
                        let column = columns[lane * parts + part];
                        sums[lane] = simd.mul_add_e_f64s(known, column, sums[lane]);
                    }
                }
                let [a, b, c, d] = sums;
                let sum = simd.add_f64s(simd.add_f64s(a, b), simd.add_f64s(c, d));
                let own = f64::registers_mut(simd, own);
                own[part] = simd.sub_f64s(own[part], sum);
            }
            own[1] -= corner.second * own[0];
            own[2] -= corner.third[0] * own[0] + corner.third[1] * own[1];
            own[3] -= (corner.last[0] * own[0] + corner.last[1] * own[1]) + corner.last[2] * own[2];
        }
        for (block, corner) in corners.iter().enumerate().rev() {
            let (own, known) = right.split_at_mut((block + 1) * BLOCK);
            let own = &mut own[block * BLOCK..];
            let known = f64::registers(simd, &known[..(corners.len() - block - 1) * BLOCK]);
            let mut sums = [simd.splat_f64s(0.0); BLOCK];
            for (number, known) in known.chunks_exact(parts).enumerate() {
                let row = &rows[start(block + 1 + number) + block * SQUARE..][..SQUARE];
                let row = f64::registers(simd, row);
                for lane in 0..BLOCK {
                    for part in 0..parts {
                        let column = row[lane * parts + part];
                        sums[lane] = simd.mul_add_e_f64s(known[part], column, sums[lane]);
                    }
                }
            }
            let sums = sums.map(|sum| simd.reduce_sum_f64s(sum));
            for lane in 0..BLOCK {
                own[lane] = own[lane] * corner.inverses[lane] - sums[lane];
            }
            own[2] -= corner.last[2] * own[3];
            own[1] -= corner.last[1] * own[3] + corner.third[1] * own[2];
            own[0] -= (corner.last[0] * own[3] + corner.third[0] * own[2]) + corner.second * own[1];
        }
    }
}

struct Projection<'a> {
    rows: &'a [f64],
    corners: &'a [Corner],
    below: &'a mut [f64],
    columns: usize,
    product: &'a mut [f64],
}

impl WithSimd for Projection<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let length = self.corners.len() * SQUARE;
        for (block, corner) in self.corners.iter().enumerate() {
            let ratios = &self.rows[start(block)..][..block * SQUARE];
            eliminate_all(simd, ratios, corner, self.below, [length, 0]);
        }
        let parts = BLOCK / S::F64_LANES;
        let rows = || self.below.chunks_exact(length.max(1));
        for (one, products) in rows().zip(self.product.chunks_mut(BLOCK * self.columns)) {
            for (group, other) in rows().enumerate() {
                let mut sums = [[simd.splat_f64s(0.0); BLOCK]; BLOCK];
                let fours = one.as_chunks::<BLOCK>().0.iter();
                let inverses = self.corners.iter().flat_map(|corner| &corner.inverses);
                let columns = f64::registers(simd, other).chunks_exact(parts);
                for ((own, inverse), column) in fours.zip(inverses).zip(columns) {
                    for (lane, sums) in sums.iter_mut().enumerate() {
                        let own = simd.splat_f64s(own[lane] * inverse);
                        for part in 0..parts {
                            sums[part] = simd.mul_add_e_f64s(own, column[part], sums[part]);
                        }
                    }
                }
                for (product, sums) in products.chunks_exact_mut(self.columns).zip(sums) {
                    let slots = product[BLOCK * group..].iter_mut();
                    let mut values = [0.0; BLOCK];
                    let registers = f64::registers_mut(simd, &mut values);
                    registers.copy_from_slice(&sums[..parts]);
                    for (slot, value) in slots.zip(values) {
                        *slot = value;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::Scalar;

    /// A diagonally dominant, hence positive definite, matrix, with indices of all of its rows and columns or of two in three.
    fn matrix(count: usize, some: bool) -> (Vec<f64>, Vec<usize>) {
        let numbers = (0..count * count).map(|k| {
            let (i, j) = (k / count, k % count);
            let own = if i == j { count as f64 } else { 0.0 };
            own + ((i + j) as f64).sin() + ((i * j) as f64).cos()
        });
        let indices = (0..count).filter(|k| !some || k % 3 != 1).collect();
        (numbers.collect(), indices)
    }

    /// Expected: the matrix times the solution is the right-hand side; the projection is the product of the columns with solutions.
    #[test]
    fn solves_what_it_was_made_from() {
        for count in [0, 1, 2, 3, 4, 5, 7, 8, 13, 45, 66] {
            for some in [false, true] {
                let (matrix, indices) = matrix(count, some);
                let size = indices.len();
                let mut factor = Elimination::new(count, 9);
                assert!(factor.factorise(&matrix, count, &indices));
                let solve = |right: &[f64]| -> Vec<f64> {
                    let mut solution = right.to_vec();
                    solution.resize(size.next_multiple_of(BLOCK), 0.0);
                    factor.solve(&mut solution);
                    solution.truncate(size);
                    solution
                };
                let right: Vec<f64> = (0..size).map(|k| (1.3 * k as f64).sin()).collect();
                let solution = solve(&right);
                for (own, right) in indices.iter().zip(&right) {
                    let terms = indices.iter().zip(&solution);
                    let product: f64 = terms.map(|(k, x)| matrix[own * count + k] * x).sum();
                    assert!((product - right).abs() < 1e-13, "{count}");
                }
                for columns in [1, 3, 4, 6, 9] {
                    let value = |k: usize, column: usize| {
                        if k < size {
                            ((k + 2 * column) as f64).cos()
                        } else {
                            0.0
                        }
                    };
                    let column = |column| (0..size).map(|k| value(k, column)).collect::<Vec<_>>();
                    let solutions: Vec<Vec<f64>> =
                        (0..columns).map(|c| solve(&column(c))).collect();
                    let mut factor = Elimination::new(count, columns);
                    assert!(factor.factorise(&matrix, count, &indices));
                    let mut product = vec![f64::NAN; columns * columns];
                    factor.projected_inverse(columns, &mut product, value);
                    for (place, found) in product.iter().enumerate() {
                        let (one, other) = (column(place / columns), &solutions[place % columns]);
                        let expected: f64 = one.iter().zip(other).map(|(x, y)| x * y).sum();
                        assert!((found - expected).abs() < 1e-13, "{count} {columns}");
                    }
                }
            }
        }
    }

    /// Expected: the result with the widest registers, up to rounding.
    #[test]
    fn number_by_number() {
        let (matrix, indices) = matrix(45, true);
        let factor = |by_number: bool| {
            let mut factor = Elimination::new(45, 6);
            factor.blocks = indices.len().div_ceil(BLOCK);
            factor.take(&matrix, 45, &indices);
            let blocks = factor.blocks;
            let work = Factorisation {
                rows: &mut factor.rows[..start(blocks)],
                corners: &mut factor.corners[..blocks],
                undivided: &mut factor.undivided,
            };
            assert!(if by_number {
                work.with_simd(Scalar)
            } else {
                Arch::new().dispatch(work)
            });
            let mut right: Vec<f64> = (0..blocks * BLOCK).map(|k| (k as f64).cos()).collect();
            let solution = Solution {
                rows: &factor.rows[..start(blocks)],
                corners: &factor.corners[..blocks],
                right: &mut right,
            };
            if by_number {
                solution.with_simd(Scalar);
            } else {
                Arch::new().dispatch(solution);
            }
            let mut below: Vec<f64> = (0..2 * blocks * SQUARE)
                .map(|k| (0.7 * k as f64).sin())
                .collect();
            let mut product = vec![0.0; 36];
            let projection = Projection {
                rows: &factor.rows[..start(blocks)],
                corners: &factor.corners[..blocks],
                below: &mut below,
                columns: 6,
                product: &mut product,
            };
            if by_number {
                projection.with_simd(Scalar);
            } else {
                Arch::new().dispatch(projection);
            }
            right.extend(product);
            right
        };
        for (one, other) in factor(true).iter().zip(factor(false)) {
            assert!((one - other).abs() < 1e-13);
        }
    }

    #[test]
    fn reports_a_matrix_that_is_not_positive_definite() {
        let indefinite = [1.0, 2.0, 2.0, 1.0];
        for (matrix, count) in [(&indefinite[..], 2), (&[f64::NAN], 1), (&[0.0], 1)] {
            let indices: Vec<usize> = (0..count).collect();
            assert!(!Elimination::new(count, 0).factorise(matrix, count, &indices));
        }
        // In a block other than the first.
        let (mut matrix, indices) = matrix(9, false);
        matrix[80] = -1.0;
        assert!(!Elimination::new(9, 0).factorise(&matrix, 9, &indices));
    }
}
