//! A grid of equal rectangles, and the subset of cells that can carry a pressure.

use super::point::Point;

/// A rectangular grid of equal cells.
///
/// Arrays over a grid are row-major with x fastest: cell `(column, row)` has index
/// `row * columns + column`, columns count along x and rows along y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    columns: usize,
    rows: usize,
    cell: [f64; 2],
    origin: Point,
}

/// The reason why a grid is invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidGrid {
    /// No cells, or more than the supported number.
    #[error("a grid of {columns} by {rows} cells: it must have at least one cell and at most 2^32")]
    CellCount {
        /// Cells along x.
        columns: usize,
        /// Cells along y.
        rows: usize,
    },
    /// The sides of a cell, m, are not positive numbers.
    #[error("cells of {0:e} m by {1:e} m: both sides must be finite and greater than 0")]
    CellSize(f64, f64),
    /// The origin, m, is not a point.
    #[error("grid origin ({0}, {1}): both coordinates must be finite")]
    Origin(f64, f64),
}

impl Grid {
    /// A grid of `columns` by `rows` cells with sides `cell = [along x, along y]` (m), whose lower left corner is `origin` (m).
    ///
    /// # Errors
    /// No cells or more than 2^32 of them, sides that are not finite and positive, or an origin that is not finite.
    pub fn new(
        columns: usize,
        rows: usize,
        cell: [f64; 2],
        origin: Point,
    ) -> Result<Self, InvalidGrid> {
        let countable = columns
            .checked_mul(rows)
            .is_some_and(|count| count > 0 && u64::try_from(count).is_ok_and(|n| n <= 1 << 32));
        if !countable {
            return Err(InvalidGrid::CellCount { columns, rows });
        }
        if !cell.iter().all(|side| side.is_finite() && *side > 0.0) {
            return Err(InvalidGrid::CellSize(cell[0], cell[1]));
        }
        if !origin.iter().all(|coordinate| coordinate.is_finite()) {
            return Err(InvalidGrid::Origin(origin[0], origin[1]));
        }
        Ok(Self {
            columns,
            rows,
            cell,
            origin,
        })
    }

    /// A grid of square cells with side `size` (m), centred at the origin.
    ///
    /// # Errors
    /// As for [`Grid::new`].
    pub fn centred(columns: usize, rows: usize, size: f64) -> Result<Self, InvalidGrid> {
        let origin = [-0.5 * size * columns as f64, -0.5 * size * rows as f64];
        Self::new(columns, rows, [size, size], origin)
    }

    /// Cells along x.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Cells along y.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of cells.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.columns * self.rows
    }

    /// Sides of a cell along x and y, m.
    #[must_use]
    pub fn cell(&self) -> [f64; 2] {
        self.cell
    }

    /// Area of a cell, m^2.
    #[must_use]
    pub fn cell_area(&self) -> f64 {
        self.cell[0] * self.cell[1]
    }

    /// Lower left corner, m.
    #[must_use]
    pub fn origin(&self) -> Point {
        self.origin
    }

    /// Centre of the cell in the given column and row, m.
    #[must_use]
    pub fn centre(&self, column: usize, row: usize) -> Point {
        [
            self.origin[0] + (column as f64 + 0.5) * self.cell[0],
            self.origin[1] + (row as f64 + 0.5) * self.cell[1],
        ]
    }

    /// Centres of all cells, m, in the order of arrays.
    pub fn centres(&self) -> impl Iterator<Item = Point> + '_ {
        (0..self.rows)
            .flat_map(move |row| (0..self.columns).map(move |column| self.centre(column, row)))
    }
}

/// Adjacent cells of one row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Segment {
    /// Row of the cells.
    pub row: usize,
    /// First column.
    pub column: usize,
    /// Number of cells.
    pub count: usize,
    /// Index of the first cell in vectors.
    pub start: usize,
}

/// The cells of a grid that can carry a pressure, in the order of the grid.
///
/// Vectors of unknowns have one entry for each of these cells and none for the others. The cells are stored as [`Segment`]s, since patterns
/// consist of patches.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    grid: Grid,
    segments: Vec<Segment>,
    len: usize,
}

impl Cells {
    /// The same cells of a grid whose sides and origin are multiplied by a factor.
    pub(crate) fn stretched(&self, factor: f64) -> Self {
        let grid = Grid {
            cell: self.grid.cell.map(|side| side * factor),
            origin: self.grid.origin.map(|at| at * factor),
            ..self.grid
        };
        Self {
            grid,
            ..self.clone()
        }
    }

    /// All cells of a grid.
    #[must_use]
    pub fn all(grid: &Grid) -> Self {
        Self::where_true(grid, |_| true)
    }

    /// The cells whose centre (m) is in the pattern.
    #[must_use]
    pub fn where_centre(grid: &Grid, mut in_pattern: impl FnMut(Point) -> bool) -> Self {
        Self::where_true(grid, |index| {
            in_pattern(grid.centre(index % grid.columns, index / grid.columns))
        })
    }

    /// The cells whose index in the grid is selected; `selected` is called in increasing order.
    #[must_use]
    pub fn where_true(grid: &Grid, mut selected: impl FnMut(usize) -> bool) -> Self {
        let mut segments: Vec<Segment> = Vec::new();
        let mut len = 0;
        for row in 0..grid.rows {
            let first = segments.len();
            for column in 0..grid.columns {
                if !selected(row * grid.columns + column) {
                    continue;
                }
                match segments[first..].last_mut() {
                    Some(segment) if segment.column + segment.count == column => segment.count += 1,
                    _ => segments.push(Segment {
                        row,
                        column,
                        count: 1,
                        start: len,
                    }),
                }
                len += 1;
            }
        }
        Self {
            grid: *grid,
            segments,
            len,
        }
    }

    /// The same cells of a grid that is scaled by a factor.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        scaled.grid.cell = scaled.grid.cell.map(|side| side * factor);
        scaled.grid.origin = scaled.grid.origin.map(|x| x * factor);
        scaled
    }

    /// The grid of the cells.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether the set is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The cells in segments along the rows, in the order of the grid.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Columns and rows of the cells, in the order of vectors.
    pub fn positions(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.segments.iter().flat_map(|segment| {
            (segment.column..segment.column + segment.count).map(|column| (column, segment.row))
        })
    }

    /// Indices of the cells in the grid, in the order of vectors.
    pub fn indices(&self) -> impl Iterator<Item = usize> + '_ {
        self.positions()
            .map(|(column, row)| row * self.grid.columns + column)
    }

    /// Centres of the cells, m, in the order of vectors.
    pub fn centres(&self) -> impl Iterator<Item = Point> + '_ {
        self.positions()
            .map(|(column, row)| self.grid.centre(column, row))
    }

    /// Writes a vector into an array over the whole grid; other cells remain unchanged.
    ///
    /// # Panics
    /// If the lengths are not those of the cells and of the grid.
    pub fn scatter(&self, vector: &[f64], array: &mut [f64]) {
        assert_eq!(vector.len(), self.len);
        assert_eq!(array.len(), self.grid.cell_count());
        for segment in &self.segments {
            let place = segment.row * self.grid.columns + segment.column;
            array[place..place + segment.count]
                .copy_from_slice(&vector[segment.start..segment.start + segment.count]);
        }
    }

    /// Reads a vector from an array over the whole grid.
    ///
    /// # Panics
    /// If the lengths are not those of the cells and of the grid.
    pub fn gather(&self, array: &[f64], vector: &mut [f64]) {
        assert_eq!(vector.len(), self.len);
        assert_eq!(array.len(), self.grid.cell_count());
        for segment in &self.segments {
            let place = segment.row * self.grid.columns + segment.column;
            vector[segment.start..segment.start + segment.count]
                .copy_from_slice(&array[place..place + segment.count]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_grids_are_refused() {
        assert!(matches!(
            Grid::new(0, 3, [1.0, 1.0], [0.0, 0.0]),
            Err(InvalidGrid::CellCount { .. })
        ));
        assert!(matches!(
            Grid::new(usize::MAX, 2, [1.0, 1.0], [0.0, 0.0]),
            Err(InvalidGrid::CellCount { .. })
        ));
        for side in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                Grid::new(2, 3, [1.0, side], [0.0, 0.0]),
                Err(InvalidGrid::CellSize(..))
            ));
        }
        assert!(matches!(
            Grid::new(2, 3, [1.0, 1.0], [f64::NAN, 0.0]),
            Err(InvalidGrid::Origin(..))
        ));
    }

    #[test]
    fn x_runs_fastest_and_points_are_centres() {
        let grid = Grid::new(3, 2, [2.0, 1.0], [10.0, 20.0]).unwrap();
        let centres: Vec<Point> = grid.centres().collect();
        let close = |a: Point, b: Point| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-14;
        assert!(close(centres[0], [11.0, 20.5]));
        assert!(close(centres[1], [13.0, 20.5]));
        assert!(close(centres[3], [11.0, 21.5]));
        assert_eq!(centres.len(), grid.cell_count());
        let centred = Grid::centred(4, 2, 0.5).unwrap();
        assert!(close(centred.centre(0, 0), [-0.75, -0.25]));
        assert!(close(centred.centre(3, 1), [0.75, 0.25]));
    }

    #[test]
    fn runs_cover_the_pattern_and_no_more() {
        let grid = Grid::new(7, 5, [1.0, 1.0], [0.0, 0.0]).unwrap();
        let pattern = |index: usize| !index.is_multiple_of(3) || index > 28;
        let cells = Cells::where_true(&grid, pattern);
        let expected: Vec<usize> = (0..35).filter(|&index| pattern(index)).collect();
        assert_eq!(cells.indices().collect::<Vec<_>>(), expected);
        assert_eq!(cells.len(), expected.len());

        let vector: Vec<f64> = expected.iter().map(|&index| index as f64).collect();
        let mut array = vec![-1.0; 35];
        cells.scatter(&vector, &mut array);
        for (index, value) in array.iter().enumerate() {
            let expected = if pattern(index) { index as f64 } else { -1.0 };
            assert!((value - expected).abs() < f64::EPSILON);
        }
        let mut back = vec![0.0; cells.len()];
        cells.gather(&array, &mut back);
        assert_eq!(back, vector);
        assert_eq!(Cells::all(&grid).len(), 35);
        assert!(Cells::where_true(&grid, |_| false).is_empty());
    }
}
