//! The pillars that may be touched: those within a radius of the lens axis.

use crate::problem::{HexagonalLattice, Point};
use std::ops::Range;

/// The pillars of a lattice whose centres are within a radius of the lens axis, as a list and as positions in a rectangular array of lattice
/// indices.
#[derive(Debug, Clone)]
pub(crate) struct Window {
    /// Vectors between adjacent rows, and between adjacent columns.
    vectors: [Point; 2],
    /// Lattice indices of the corner of the array.
    origin: (i64, i64),
    /// Rows and columns of the array.
    shape: (usize, usize),
    /// Row and column of every pillar; row by row.
    places: Vec<(usize, usize)>,
    /// The pillars of every row, which are in consecutive columns.
    rows: Vec<Range<usize>>,
    centres: Vec<Point>,
    radius: f64,
}

impl Window {
    /// All lengths are in the unit of `lattice.pitch`.
    pub(crate) fn new(lattice: &HexagonalLattice, radius: f64) -> Self {
        let nearest = lattice.nearest_pillar([0.0, 0.0]);
        // |a1 i + a2 j| <= r implies |i|, |j| <= 2 r/(sqrt3 e).
        let reach = (radius / lattice.pitch * 2.0 / 3f64.sqrt() + 1.0).ceil() as i64;
        let mut indexed = Vec::new();
        for i in nearest.0 - reach..=nearest.0 + reach {
            for j in nearest.1 - reach..=nearest.1 + reach {
                let [x, y] = lattice.centre(i, j);
                if x.hypot(y) <= radius {
                    indexed.push(((i, j), [x, y]));
                }
            }
        }
        if indexed.is_empty() {
            indexed.push((nearest, lattice.centre(nearest.0, nearest.1)));
        }
        Self::of_pillars(lattice.vectors(), &indexed, radius)
    }

    /// The pillars of a lattice with these vectors, by increasing index, which are not empty; `None` if positions between the pillars of a
    /// row are vacant.
    pub(crate) fn without_gaps(
        vectors: [Point; 2],
        indexed: &[((i64, i64), Point)],
        radius: f64,
    ) -> Option<Self> {
        let are_next = |pair: &[((i64, i64), Point)]| {
            let [(i, j), (u, v)] = [pair[0].0, pair[1].0];
            i != u || j + 1 == v
        };
        let has_no_gap = indexed.windows(2).all(are_next);
        has_no_gap.then(|| Self::of_pillars(vectors, indexed, radius))
    }

    /// Pillars by increasing index, without gaps in any row.
    fn of_pillars(vectors: [Point; 2], indexed: &[((i64, i64), Point)], radius: f64) -> Self {
        let bounds = |pick: fn(&(i64, i64)) -> i64| {
            indexed
                .iter()
                .map(|(index, _)| pick(index))
                .fold((i64::MAX, i64::MIN), |(low, high), v| {
                    (low.min(v), high.max(v))
                })
        };
        let ((low_i, high_i), (low_j, high_j)) = (bounds(|v| v.0), bounds(|v| v.1));
        let shape = ((high_i - low_i + 1) as usize, (high_j - low_j + 1) as usize);
        let places: Vec<(usize, usize)> = indexed
            .iter()
            .map(|((i, j), _)| ((i - low_i) as usize, (j - low_j) as usize))
            .collect();
        let from_row = |row: usize| places.partition_point(|place| place.0 < row);
        Self {
            vectors,
            origin: (low_i, low_j),
            shape,
            rows: (0..shape.0)
                .map(|row| from_row(row)..from_row(row + 1))
                .collect(),
            places,
            // Copied to a separate list, since the one with the indices takes much more memory.
            centres: indexed.iter().map(|(_, centre)| *centre).collect(),
            radius,
        }
    }

    /// Approximate number of pillars in a window of this radius.
    pub(crate) fn expected_len(lattice: &HexagonalLattice, radius: f64) -> f64 {
        std::f64::consts::PI * radius * radius / lattice.cell_area()
    }

    /// Number of pillars.
    pub(crate) fn len(&self) -> usize {
        self.places.len()
    }

    /// Vectors between adjacent rows, and between adjacent columns.
    pub(crate) fn vectors(&self) -> [Point; 2] {
        self.vectors
    }

    /// Rows and columns of the array of lattice indices.
    pub(crate) fn shape(&self) -> (usize, usize) {
        self.shape
    }

    /// Row and column of every pillar, row by row.
    pub(crate) fn places(&self) -> &[(usize, usize)] {
        &self.places
    }

    /// The pillars of every row.
    pub(crate) fn rows(&self) -> &[Range<usize>] {
        &self.rows
    }

    /// Centre of every pillar.
    pub(crate) fn centres(&self) -> &[Point] {
        &self.centres
    }

    /// Lattice indices of a pillar.
    pub(crate) fn index(&self, pillar: usize) -> (i64, i64) {
        let (row, column) = self.places[pillar];
        (self.origin.0 + row as i64, self.origin.1 + column as i64)
    }

    /// Position in the list of the pillar with the given lattice indices.
    pub(crate) fn find(&self, (i, j): (i64, i64)) -> Option<usize> {
        let row = usize::try_from(i - self.origin.0).ok()?;
        let column = usize::try_from(j - self.origin.1).ok()?;
        let pillars = self.rows.get(row)?;
        let first = self.places.get(pillars.start)?.1;
        let pillar = pillars.start + column.checked_sub(first)?;
        pillars.contains(&pillar).then_some(pillar)
    }

    /// Radius that contains all pillars, relative to the lens axis.
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contains_every_pillar_within_its_radius_once() {
        let lattice = HexagonalLattice {
            pitch: 1.3,
            offset: 0.8,
            offset_angle: 1.1,
        };
        let window = Window::new(&lattice, 7.0);
        let mut count = 0;
        for i in -20..20 {
            for j in -20..20 {
                let [x, y] = lattice.centre(i, j);
                if x.hypot(y) <= 7.0 {
                    count += 1;
                    let pillar = window.find((i, j)).unwrap();
                    assert_eq!(window.index(pillar), (i, j));
                }
            }
        }
        assert_eq!(window.len(), count);
        assert!(window.find((1000, 0)).is_none());
    }
}
