//! A pressure on floor cells, and what it does anywhere.

use crate::halfspace::elements::rectangle::Rectangle;
use crate::problem::{Cells, Grid, Point};
use std::f64::consts::PI;

/// Pressures on some cells of a grid.
#[derive(Debug, Clone)]
pub(crate) struct FloorLoad {
    cells: Cells,
    pressure: Vec<f64>,
    /// Place of every cell of the grid in the vector.
    place: Vec<u32>,
    rectangle: Rectangle,
}

impl FloorLoad {
    pub(crate) fn new(cells: Cells, pressure: Vec<f64>) -> Self {
        let mut place = vec![u32::MAX; cells.grid().cell_count()];
        for (number, index) in cells.indices().enumerate() {
            place[index] = number as u32;
        }
        let [width, height] = cells.grid().cell();
        Self {
            rectangle: Rectangle::new(width, height),
            place,
            pressure,
            cells,
        }
    }

    /// Cells and pressures in units of which these are the numbers of the present ones.
    pub(crate) fn in_metres(&self, length: f64, pressure: f64) -> (Cells, Vec<f64>) {
        let pressures = self.pressure.iter().map(|p| p * pressure).collect();
        (self.cells.scaled(length), pressures)
    }

    /// The pressure at a point.
    pub(crate) fn pressure(&self, [x, y]: Point) -> f64 {
        let grid: &Grid = self.cells.grid();
        let ([left, low], [width, height]) = (grid.origin(), grid.cell());
        let (column, row) = (((x - left) / width).floor(), ((y - low) / height).floor());
        let inside = (0.0..grid.columns() as f64).contains(&column)
            && (0.0..grid.rows() as f64).contains(&row);
        if !inside {
            return 0.0;
        }
        let place = self.place[row as usize * grid.columns() + column as usize];
        self.pressure.get(place as usize).copied().unwrap_or(0.0)
    }

    /// The displacement at a point, on a half-space of unit compliance.
    pub(crate) fn displacement(&self, [x, y]: Point) -> f64 {
        let centres = self.cells.centres().zip(&self.pressure);
        let sum: f64 = centres
            .map(|([u, v], pressure)| pressure * self.rectangle.potential(x - u, y - v))
            .sum();
        sum / PI
    }
}
