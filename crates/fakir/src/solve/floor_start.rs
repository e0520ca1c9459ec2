//! The pressure on the floor of one grid as the start on another.

use super::newton::Newton;
use crate::halfspace::floor::grid::FloorGrid;
use crate::problem::Point;

/// The pressure on the cells of a grid, to be looked up.
pub(super) struct FloorPressures {
    grid: FloorGrid,
    /// Of every point of the grid: the pressure, and that under a unit indentation; zero where no cell bears any.
    pressure: Vec<[f64; 2]>,
}

impl FloorPressures {
    pub(super) fn of(newton: &Newton<'_>) -> Option<Self> {
        let cells = newton.cells.as_ref()?;
        let scale = cells.unit_cell().recip();
        let contact = &newton.contact;
        let coefficients = contact.floor_coefficients().iter();
        let coefficients = coefficients.zip(contact.floor_unit_coefficients());
        let mut pressure = vec![[0.0; 2]; cells.grid.cells.grid().cell_count()];
        for ((index, bears), (present, unit)) in cells
            .grid
            .cells
            .indices()
            .zip(cells.bears())
            .zip(coefficients)
        {
            if *bears {
                pressure[index] = [scale * present, scale * unit];
            }
        }
        Some(Self {
            grid: cells.grid.clone(),
            pressure,
        })
    }

    /// The pressure at a point, and that under a unit indentation; zero outside of the cells.
    pub(super) fn at(&self, point: Point) -> [f64; 2] {
        let columns = self.grid.cells.grid().columns();
        let place = self.grid.position_of(point);
        place.map_or([0.0; 2], |[column, row]| {
            self.pressure[row * columns + column]
        })
    }
}
