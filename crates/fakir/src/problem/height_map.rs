//! A surface given by its height on the cells of a grid.

use super::grid::{Grid, InvalidGrid};
use super::point::Point;

/// Heights of a rough or patterned surface at the centres of the cells of a [`Grid`], m.
///
/// Cells are rectangles and need not be square. Heights are relative to an arbitrary level, positive upwards, and row-major with x fastest,
/// as all arrays over a grid. The lens axis is the origin of the grid's coordinates.
///
/// Cells may belong to pillars, which are then compressed as columns by the force on all of their cells; cells that belong to no pillar are
/// floor.
///
/// ```
/// use fakir::problem::{Grid, HeightMap};
///
/// // A bump of radius of curvature 1 mm.
/// let grid = Grid::centred(64, 64, 1.0e-6)?;
/// let surface = HeightMap::from_height(grid, |[x, y]| -(x * x + y * y) / 2.0e-3)?;
/// assert!(surface.highest() < 0.0 && surface.highest() > -1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct HeightMap {
    grid: Grid,
    heights: Vec<f64>,
    /// Height of the highest point, if it is known to be above the centres of all cells.
    summit: f64,
    pillars: Option<PillarColumns>,
}

/// The pillars of a [`HeightMap`].
#[derive(Debug, Clone, PartialEq)]
pub struct PillarColumns {
    /// Pillar of every cell, counted from zero; [`HeightMap::NO_PILLAR`] for the floor.
    pub labels: Vec<u32>,
    /// Uniform displacement of each pillar per unit force, m/N; for a cylinder of height `h` and diameter `d`, `4 h/(pi E d^2)`.
    pub compliance: Vec<f64>,
}

/// The reason why a height map is invalid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidHeightMap {
    /// The grid is invalid.
    #[error(transparent)]
    Grid(#[from] InvalidGrid),
    /// The number of heights is not the number of cells.
    #[error("{found} heights for {columns} by {rows} cells")]
    HeightCount {
        /// Cells along x.
        columns: usize,
        /// Cells along y.
        rows: usize,
        /// Number of heights given.
        found: usize,
    },
    /// A height is not finite.
    #[error(
        "the height in column {column}, row {row} (counted from 0) is {value}: it must be finite"
    )]
    NotFinite {
        /// Column of the cell.
        column: usize,
        /// Row of the cell.
        row: usize,
        /// The height given.
        value: f64,
    },
    /// The number of pillar labels is not the number of cells.
    #[error("{found} pillar labels for {expected} cells")]
    LabelCount {
        /// Number of cells.
        expected: usize,
        /// Number of labels given.
        found: usize,
    },
    /// A label does not belong to a pillar.
    #[error(
        "the cell in column {column}, row {row} (counted from 0) is labelled {label}, but there \
         are {pillars} pillars"
    )]
    UnknownPillar {
        /// Column of the cell.
        column: usize,
        /// Row of the cell.
        row: usize,
        /// The label given.
        label: u32,
        /// Number of pillars.
        pillars: usize,
    },
    /// A compliance is invalid.
    #[error(
        "the compliance of pillar {pillar} is {value} m/N: it must be a finite number, 0 or greater"
    )]
    Compliance {
        /// The pillar.
        pillar: usize,
        /// The compliance given, m/N.
        value: f64,
    },
}

impl HeightMap {
    /// Label of cells that belong to no pillar.
    pub const NO_PILLAR: u32 = u32::MAX;

    /// A surface with the given heights (m), one for every cell.
    ///
    /// # Errors
    /// A number of heights that is not the number of cells, or a height that is not finite.
    pub fn new(grid: Grid, heights: Vec<f64>) -> Result<Self, InvalidHeightMap> {
        if heights.len() != grid.cell_count() {
            return Err(InvalidHeightMap::HeightCount {
                columns: grid.columns(),
                rows: grid.rows(),
                found: heights.len(),
            });
        }
        if let Some(cell) = heights.iter().position(|height| !height.is_finite()) {
            return Err(InvalidHeightMap::NotFinite {
                column: cell % grid.columns(),
                row: cell / grid.columns(),
                value: heights[cell],
            });
        }
        Ok(Self {
            grid,
            heights,
            summit: f64::NEG_INFINITY,
            pillars: None,
        })
    }

    /// A surface of the given height (m) at the centres (m) of the cells.
    ///
    /// # Errors
    /// A height that is not finite.
    pub fn from_height(
        grid: Grid,
        height: impl FnMut(Point) -> f64,
    ) -> Result<Self, InvalidHeightMap> {
        Self::new(grid, grid.centres().map(height).collect())
    }

    /// The same surface with pillars that are compressed as columns.
    ///
    /// # Errors
    /// A number of labels that is not the number of cells, a label without a pillar, or a compliance that is negative or not finite.
    pub fn with_pillars(self, pillars: PillarColumns) -> Result<Self, InvalidHeightMap> {
        let PillarColumns { labels, compliance } = &pillars;
        if labels.len() != self.heights.len() {
            return Err(InvalidHeightMap::LabelCount {
                expected: self.heights.len(),
                found: labels.len(),
            });
        }
        let unknown =
            |label: &u32| *label != Self::NO_PILLAR && *label as usize >= compliance.len();
        if let Some(cell) = labels.iter().position(unknown) {
            return Err(InvalidHeightMap::UnknownPillar {
                column: cell % self.grid.columns(),
                row: cell / self.grid.columns(),
                label: labels[cell],
                pillars: compliance.len(),
            });
        }
        let possible = |value: &f64| value.is_finite() && *value >= 0.0;
        if let Some(pillar) = compliance.iter().position(|value| !possible(value)) {
            return Err(InvalidHeightMap::Compliance {
                pillar,
                value: compliance[pillar],
            });
        }
        Ok(Self {
            pillars: Some(pillars),
            ..self
        })
    }

    /// The same surface with the lens axis at `point`, given in the present coordinates, m.
    ///
    /// # Errors
    /// A point that is not finite.
    pub fn with_axis_at(self, point: Point) -> Result<Self, InvalidHeightMap> {
        let [x, y] = self.grid.origin();
        let origin = [x - point[0], y - point[1]];
        let grid = Grid::new(
            self.grid.columns(),
            self.grid.rows(),
            self.grid.cell(),
            origin,
        )?;
        Ok(Self { grid, ..self })
    }

    /// The grid of cells.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Height of every cell, m.
    #[must_use]
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// The pillars, if there are any.
    #[must_use]
    pub fn pillars(&self) -> Option<&PillarColumns> {
        self.pillars.as_ref()
    }

    /// The same surface with a highest point of this height (m), such as the apex of a cone between the centres of cells.
    pub(crate) fn with_summit(self, summit: f64) -> Self {
        Self { summit, ..self }
    }

    /// Height of the highest point, m: that of the highest cell, or of the apex of a pillar above the centres of all cells.
    #[must_use]
    pub fn highest(&self) -> f64 {
        self.heights.iter().copied().fold(self.summit, f64::max)
    }

    /// Height of the lowest cell, m.
    #[must_use]
    pub fn lowest(&self) -> f64 {
        self.heights.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Pillar of a cell.
    pub(crate) fn label(&self, cell: usize) -> u32 {
        self.pillars
            .as_ref()
            .map_or(Self::NO_PILLAR, |pillars| pillars.labels[cell])
    }

    /// The surface on cells twice as large; the last row or column is left out if its number is odd. Returns `None` if no cell would be
    /// left.
    ///
    /// Steps remain sharp: a large cell belongs to the pillar of most of its four cells, or to the two pillars alternately if they share it
    /// equally, and has the mean height of the cells of this pillar. Without pillars, the height is the mean of the two middle heights.
    pub(crate) fn coarsened(&self) -> Option<Self> {
        let [width, height] = self.grid.cell();
        let (columns, rows) = (self.grid.columns() / 2, self.grid.rows() / 2);
        let cell = [2.0 * width, 2.0 * height];
        let grid = Grid::new(columns, rows, cell, self.grid.origin()).ok()?;
        let mut heights = Vec::with_capacity(grid.cell_count());
        let mut labels = Vec::with_capacity(grid.cell_count());
        for row in 0..rows {
            for column in 0..columns {
                let first = 2 * (row * self.grid.columns() + column);
                let above = first + self.grid.columns();
                let cells = [first, first + 1, above, above + 1];
                let label = majority(cells.map(|cell| self.label(cell)), (row + column) % 2 == 1);
                labels.push(label);
                heights.push(if self.pillars.is_some() {
                    let own = cells.into_iter().filter(|cell| self.label(*cell) == label);
                    mean(own.map(|cell| self.heights[cell]))
                } else {
                    let mut heights = cells.map(|cell| self.heights[cell]);
                    heights.sort_by(f64::total_cmp);
                    0.5 * (heights[1] + heights[2])
                });
            }
        }
        let pillars = self.pillars.as_ref().map(|pillars| PillarColumns {
            labels,
            compliance: pillars.compliance.clone(),
        });
        Some(Self {
            grid,
            heights,
            summit: f64::NEG_INFINITY,
            pillars,
        })
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
    sum / count
}

/// The most frequent of four labels; for equal frequencies, the first or the last one.
fn majority(labels: [u32; 4], last: bool) -> u32 {
    let count = |label: u32| labels.iter().filter(|other| **other == label).count();
    let most = labels.into_iter().map(count).max().unwrap_or(0);
    let mut frequent = labels.into_iter().filter(|label| count(*label) == most);
    let chosen = if last {
        frequent.next_back()
    } else {
        frequent.next()
    };
    chosen.unwrap_or(labels[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(columns: usize, rows: usize) -> Grid {
        Grid::new(columns, rows, [1.0, 2.0], [0.0, 0.0]).unwrap()
    }

    #[test]
    fn what_cannot_be_is_refused_with_its_value() {
        assert_eq!(
            HeightMap::new(grid(3, 2), vec![0.0; 5]),
            Err(InvalidHeightMap::HeightCount {
                columns: 3,
                rows: 2,
                found: 5
            })
        );
        for value in [f64::NAN, f64::INFINITY] {
            let mut heights = vec![0.0; 6];
            heights[4] = value;
            let error = HeightMap::new(grid(3, 2), heights).unwrap_err();
            assert!(matches!(
                error,
                InvalidHeightMap::NotFinite {
                    column: 1,
                    row: 1,
                    ..
                }
            ));
        }
        let flat = || HeightMap::new(grid(3, 2), vec![0.0; 6]).unwrap();
        let labels = |label: u32| {
            let mut labels = vec![HeightMap::NO_PILLAR; 6];
            labels[5] = label;
            labels
        };
        let pillars = |labels: Vec<u32>, compliance: f64| PillarColumns {
            labels,
            compliance: vec![compliance],
        };
        assert!(flat().with_pillars(pillars(labels(0), 1.0)).is_ok());
        assert_eq!(
            flat().with_pillars(pillars(labels(1), 1.0)),
            Err(InvalidHeightMap::UnknownPillar {
                column: 2,
                row: 1,
                label: 1,
                pillars: 1
            })
        );
        assert_eq!(
            flat().with_pillars(pillars(labels(0), -1.0)),
            Err(InvalidHeightMap::Compliance {
                pillar: 0,
                value: -1.0
            })
        );
        assert!(matches!(
            flat().with_pillars(pillars(vec![0; 5], 1.0)),
            Err(InvalidHeightMap::LabelCount { found: 5, .. })
        ));
    }

    #[test]
    fn a_slope_is_the_same_on_larger_cells() {
        let height = |[x, y]: Point| 0.3 * x - 0.1 * y;
        let fine = HeightMap::from_height(grid(7, 6), height).unwrap();
        let coarse = fine.coarsened().unwrap();
        assert_eq!((coarse.grid().columns(), coarse.grid().rows()), (3, 3));
        for (centre, found) in coarse.grid().centres().zip(coarse.heights()) {
            assert!((found - height(centre)).abs() < 1e-14);
        }
        assert!(
            HeightMap::new(grid(1, 4), vec![0.0; 4])
                .unwrap()
                .coarsened()
                .is_none()
        );
    }

    #[test]
    fn a_step_is_a_step_on_larger_cells() {
        let inside = |[x, _]: Point| x < 3.0;
        let labels = grid(6, 4)
            .centres()
            .map(|at| if inside(at) { 0 } else { HeightMap::NO_PILLAR })
            .collect();
        let height = |at| if inside(at) { 1.0 } else { 0.0 };
        let fine = HeightMap::from_height(grid(6, 4), height)
            .unwrap()
            .with_pillars(PillarColumns {
                labels,
                compliance: vec![0.0],
            })
            .unwrap();
        let coarse = fine.coarsened().unwrap();
        assert_eq!(coarse.heights(), [1.0, 0.0, 0.0, 1.0, 1.0, 0.0]);
        assert_eq!(
            coarse.pillars().unwrap().labels[..2],
            [0, HeightMap::NO_PILLAR]
        );
    }
}
