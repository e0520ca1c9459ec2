//! Transfers the pressure on the floor from one grid to another as a start.

use super::linearized::LinearizedContact;
use super::rules::floor::FloorCells;
use crate::halfspace::coupling::operator::Coupling;
use crate::halfspace::floor::grid::FloorGrid;
use crate::problem::Point;

/// The pressure on the cells of a grid, for lookup by position.
pub(super) struct FloorPressures {
    pub(super) grid: FloorGrid,
    /// At every point of the grid: the pressure, and that at unit indentation; `None` at cells without pressure.
    pressure: Vec<Option<[f64; 2]>>,
}

impl FloorPressures {
    pub(super) fn of(
        cells: &FloorCells<'_>,
        contact: &LinearizedContact<'_, impl Coupling>,
    ) -> Self {
        let scale = cells.unit_cell().recip();
        let coefficients = contact.floor_coefficients().iter();
        let coefficients = coefficients.zip(contact.floor_unit_coefficients());
        let mut pressure = vec![None; cells.grid.cells.grid().cell_count()];
        for ((index, loaded), (present, unit)) in cells
            .grid
            .cells
            .indices()
            .zip(cells.loaded())
            .zip(coefficients)
        {
            pressure[index] = loaded.then_some([scale * present, scale * unit]);
        }
        Self {
            grid: cells.grid.clone(),
            pressure,
        }
    }

    /// The pressure at a point, and that at unit indentation; `None` outside the cells that carry pressure.
    pub(super) fn at(&self, point: Point) -> Option<[f64; 2]> {
        let columns = self.grid.cells.grid().columns();
        let [column, row] = self.grid.position_of(point)?;
        self.pressure[row * columns + column]
    }
}
