//! The lattice vectors between pillars of a window, and a small array in which they remain distinct when they wrap around.
//!
//! A convolution with pillars in a window needs the kernel only at these vectors. The periodic images of an array may overlap each other's
//! corners, provided that no two of these vectors have the same position. The vectors of a disc of radius `R` fill a disc of radius `2 R`.
//! On a hexagonal lattice, the periodic images of a rhombus of lattice cells form such a lattice as well, on which the packing of discs is
//! closest: a side of `4 R` is sufficient, whereas a rhombus twice as long as the window would have a side of `4 R 2/sqrt(3)`, with a third
//! more points.

use super::window::Window;
use crate::numerics::fft::smooth_size;
use crate::problem::Point;
use crate::problem::point::combined;
use std::ops::RangeInclusive;

/// The lattice vectors between pillars of a window.
pub(crate) struct Differences {
    /// Vectors between adjacent rows, and between adjacent columns.
    vectors: [Point; 2],
    /// Whether they are two sides of a triangle with equal sides.
    hexagonal: bool,
    /// Rows and columns of the window.
    shape: (usize, usize),
    /// For every number of rows between two pillars, from 0 on, the range of columns between these. The range has the opposite sign for
    /// negative numbers of rows.
    columns: Vec<RangeInclusive<i64>>,
    /// Number of vectors in the rows before.
    starts: Vec<usize>,
}

/// No columns.
const NONE: RangeInclusive<i64> = RangeInclusive::new(1, 0);

impl Differences {
    pub(crate) fn new(window: &Window) -> Self {
        let column_of = |pillar: usize| window.places()[pillar].1 as i64;
        // The first and last column of every row that is not empty.
        let ends: Vec<(usize, [i64; 2])> = window
            .rows()
            .iter()
            .enumerate()
            .filter(|(_, pillars)| !pillars.is_empty())
            .map(|(row, pillars)| (row, [pillars.start, pillars.end - 1].map(column_of)))
            .collect();
        let mut columns = vec![None; window.shape().0];
        for (number, (row, [first, last])) in ends.iter().enumerate() {
            for (other, [other_first, other_last]) in &ends[number..] {
                let here = (other_first - last, other_last - first);
                let (least, most) = columns[other - row].get_or_insert(here);
                *least = here.0.min(*least);
                *most = here.1.max(*most);
            }
        }
        let columns: Vec<RangeInclusive<i64>> = columns
            .into_iter()
            .map(|ends| ends.map_or(NONE, |(least, most)| least..=most))
            .collect();
        let vectors = window.vectors();
        Self {
            vectors,
            hexagonal: are_hexagonal(vectors),
            shape: window.shape(),
            starts: columns
                .iter()
                .scan(0, |next, columns| {
                    let start = *next;
                    *next += (columns.end() - columns.start() + 1) as usize;
                    Some(start)
                })
                .collect(),
            columns,
        }
    }

    /// The range of columns between pillars that are this many rows apart, from 0 on.
    pub(crate) fn columns(&self, rows: usize) -> RangeInclusive<i64> {
        self.columns[rows].clone()
    }

    /// The vector between pillars this many rows and columns apart.
    pub(crate) fn vector(&self, rows: i64, columns: i64) -> Point {
        combined(self.vectors, [rows as f64, columns as f64])
    }

    /// Index of the distance of pillars this many rows, from 0 on, and columns apart among all [distances](Self::distances).
    pub(crate) fn number(&self, rows: usize, column: i64) -> usize {
        if self.hexagonal {
            distance_number(rows as i64, column)
        } else {
            self.starts[rows] + (column - self.columns[rows].start()) as usize
        }
    }

    /// All distances between pillars, by their numbers; 0 for numbers without vectors.
    pub(crate) fn distances(&self) -> Vec<f64> {
        let mut distances = Vec::new();
        for (rows, columns) in self.columns.iter().enumerate() {
            for column in columns.clone() {
                let number = self.number(rows, column);
                if distances.len() <= number {
                    distances.resize(number + 1, 0.0);
                }
                // On a hexagonal lattice the first of twelve.
                if distances[number] <= 0.0 {
                    let [x, y] = self.vector(rows as i64, column);
                    distances[number] = x.hypot(y);
                }
            }
        }
        distances
    }

    /// A small array with at least this number of rows in which all vectors have distinct positions. Its sides are fast to transform. (For
    /// a few windows in a hundred, an array with the same number of rows and fewer columns would also be sufficient.)
    pub(crate) fn small_array(&self, least_rows: usize) -> (usize, usize) {
        // Twice as long and wide: nothing wraps around.
        let whole = [self.shape.0, self.shape.1].map(|side| 2 * side - 1);
        let mut smallest = (smooth_size(whole[0].max(least_rows)), smooth_size(whole[1]));
        let mut rows = smooth_size(least_rows.max(self.shape.0));
        while rows < smallest.0 {
            let mut columns = smooth_size(self.shape.1);
            while rows * columns < smallest.0 * smallest.1 {
                if self.fit(rows, columns) {
                    smallest = (rows, columns);
                    break;
                }
                columns = smooth_size(columns + 1);
            }
            rows = smooth_size(rows + 1);
        }
        smallest
    }

    /// Whether all vectors have distinct positions in an array that is not smaller than the window.
    fn fit(&self, rows: usize, columns: usize) -> bool {
        let columns = columns as i64;
        let in_a_row = |apart: &RangeInclusive<i64>| apart.end() - apart.start() < columns;
        // Rows at the same position are `row` rows apart in one direction and the rest of the array in the other.
        let of_two_rows = |row: usize| {
            let [one, other] = [row, rows - row].map(|row| &self.columns[row]);
            if one.is_empty() || other.is_empty() {
                return true;
            }
            let (least, most) = (one.start() + other.start(), one.end() + other.end());
            most.div_euclid(columns) * columns < least
        };
        let first = (rows + 1).saturating_sub(self.shape.0);
        self.columns.iter().all(in_a_row) && (first..self.shape.0).all(of_two_rows)
    }
}

/// Whether two vectors are adjacent sides of a triangle with equal sides, the vectors of [`HexagonalLattice`](crate::problem::HexagonalLattice).
fn are_hexagonal([[a, b], [c, d]]: [Point; 2]) -> bool {
    const ROUNDING: f64 = 1e-12;
    let square = a * a + b * b;
    let of_square = |length: f64, factor: f64| (length - factor * square).abs() < ROUNDING * square;
    of_square(c * c + d * d, 1.0) && of_square(a * c + b * d, 0.5)
}

/// Index of the distance of pillars of a hexagonal lattice. Pillars `(u, v)` and `(i, j)` rows and columns apart have the same distance if
/// they are images of each other under the rotations and mirrors of the lattice. One of twelve (or six) images has `0 <= j <= i`; it
/// determines the index.
fn distance_number(u: i64, v: i64) -> usize {
    let [a, b, c] = [u.abs(), v.abs(), (u + v).abs()];
    // The largest is the sum of the other two.
    let largest = a.max(b).max(c);
    let smallest = a.min(b).min(c);
    let i = largest - smallest;
    (i * (i + 1) / 2 + smallest) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::HexagonalLattice;
    use std::collections::HashMap;

    /// Compares with all pairs of pillars.
    #[test]
    fn no_two_differences_have_one_place() {
        for (radius, offset, angle) in [
            (0.0, 0.0, 0.0),
            (4.4, 0.0, 0.0),
            (9.0, 0.3, 0.5),
            (12.2, 1.0, 2.0),
            (33.0, 0.8, 0.1),
            (61.0, 0.0, 0.0),
        ] {
            let lattice = HexagonalLattice {
                pitch: 3.7,
                offset,
                offset_angle: angle,
            };
            let window = Window::new(&lattice, radius);
            let differences = Differences::new(&window);
            let (rows, columns) = differences.small_array(8);
            assert!(rows >= window.shape().0 && columns >= window.shape().1);
            let mut place_of: HashMap<(i64, i64), (i64, i64)> = HashMap::new();
            let places = || window.places().iter().map(|(i, j)| (*i as i64, *j as i64));
            for (i, j) in places() {
                for (u, v) in places() {
                    let apart = (u - i, v - j);
                    let (down, right) = if apart.0 < 0 {
                        (-apart.0, -apart.1)
                    } else {
                        apart
                    };
                    assert!(differences.columns(down as usize).contains(&right));
                    let place = (
                        apart.0.rem_euclid(rows as i64),
                        apart.1.rem_euclid(columns as i64),
                    );
                    assert_eq!(*place_of.entry(place).or_insert(apart), apart);
                }
            }
        }
    }

    /// Expected: twice the diameter of a disc, in pitches; lengths that are fast to transform are a few percent larger.
    #[test]
    fn arrays_around_discs_are_twice_their_diameter_long() {
        for pitches in [11.5, 29.5, 59.0, 121.0] {
            let window = Window::new(&HexagonalLattice::new(1.0), pitches);
            let (rows, columns) = Differences::new(&window).small_array(8);
            let least = 16.0 * pitches * pitches;
            let places = (rows * columns) as f64;
            assert!((1.0..1.18).contains(&(places / least)), "{rows} {columns}");
        }
    }
}
