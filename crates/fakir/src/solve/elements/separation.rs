//! Contact of two surfaces given by their separation at every cell of a grid.
//!
//! The contact is solved on successively smaller cells, starting with the largest. Each solution provides the initial pressures, and hence
//! the active set, on cells of half the size; all other cells are checked at the end. For a contact that is a small part of the grid, time
//! and memory are about those of its bounding rectangle on a free half-space.

use super::active::{ActiveCells, Pressures, Surface};
use super::solver::{ElementContact, Prescribed, Settings};
use crate::halfspace::elements::Columns;
use crate::problem::{Boundary, Cells, Grid};
use crate::state::{Run, SolveError, Termination};

/// Two surfaces on a half-space, without friction.
#[derive(Debug, Clone, Copy)]
pub struct Separation<'s> {
    /// The cells.
    pub grid: Grid,
    /// Separation of the undeformed surfaces at the centre of every cell at zero indentation, m, row by row. Cells with infinite separation
    /// are never touched.
    pub values: &'s [f64],
    /// Boundary condition of the grid.
    pub boundary: Boundary,
    /// Sum of `(1 - nu^2)/E` of both bodies, 1/Pa.
    pub compliance: f64,
}

/// A contact with its active cells. All other cells carry no pressure.
#[derive(Debug, Clone)]
pub struct ActiveContact {
    /// The active cells.
    pub cells: Cells,
    /// Pressures and gaps of the active cells. The duality gap covers all cells.
    pub contact: ElementContact,
}

impl Separation<'_> {
    /// Presses the surfaces together.
    ///
    /// # Errors
    /// The memory limit would be exceeded, or the run was interrupted. A solution that did not converge is not an error: see
    /// [`ElementContact::termination`].
    ///
    /// # Panics
    /// If the number of separations differs from the number of cells.
    pub fn press(
        &self,
        load: Prescribed,
        settings: &Settings,
        run: &Run<'_>,
    ) -> Result<ActiveContact, SolveError> {
        assert_eq!(self.values.len(), self.grid.cell_count());
        let mut coarser = Vec::new();
        while let Some(next) = coarsened(
            coarser.last().map_or(
                (&self.grid, self.values),
                |(grid, values): &(Grid, Vec<f64>)| (grid, values),
            ),
            self.boundary,
        ) {
            coarser.push(next);
        }
        let rough = Settings {
            tolerance: settings.tolerance.max(COARSE_TOLERANCE),
            product_limit: settings.product_limit.min(COARSE_PRODUCTS),
        };
        let mut start = None;
        while let Some((grid, values)) = coarser.pop() {
            let solved = self.press_level(grid, &values, start, load, &rough, run)?;
            let converged = solved.contact.termination == Termination::Converged;
            start = converged.then_some(solved);
        }
        let solved = self.press_level(self.grid, self.values, start, load, settings, run)?;
        if solved.contact.termination == Termination::Interrupted {
            return Err(SolveError::Interrupted);
        }
        Ok(solved)
    }

    /// Solves on cells of one size, starting from the contact on cells of twice the size.
    fn press_level(
        &self,
        grid: Grid,
        separation: &[f64],
        coarse: Option<ActiveContact>,
        load: Prescribed,
        settings: &Settings,
        run: &Run<'_>,
    ) -> Result<ActiveContact, SolveError> {
        let rises = self.boundary == Boundary::Periodic;
        let bound = match load {
            Prescribed::Indentation(indentation) if !rises => indentation,
            _ => f64::MAX,
        };
        let check_memory = |cells: usize, bytes: usize| {
            let limit = run.memory_limit();
            let [width, height] = self.grid.cell();
            if bytes <= limit {
                return Ok(());
            }
            Err(SolveError::TooManyCells {
                cells,
                bytes,
                limit,
                cell: width.max(height),
                suggested_cell: 1.1 * width.max(height) * (bytes as f64 / limit as f64).sqrt(),
            })
        };
        let surface = Surface {
            grid,
            separation,
            may_carry_load: &|cell| separation[cell] <= bound,
            rises,
            boundary: self.boundary,
            compliance: self.compliance,
            layers: &[],
            pillar: &|_| Columns::NO_PILLAR,
            influence: &[],
            check_memory: &check_memory,
            pool: run.pool,
            cancel: &run.cancel,
        };
        let expected = coarse.as_ref().map(|coarse| coarse.contact.indentation);
        let start = coarse.map(|coarse| {
            let coarse = Pressures {
                cells: coarse.cells,
                values: coarse.contact.pressure,
            };
            coarse.refined(&grid)
        });
        let mut active = ActiveCells::default();
        let (cells, contact) = active.solve(&surface, start, expected, load, settings)?;
        Ok(ActiveContact { cells, contact })
    }
}

/// Tolerance and largest number of products on larger cells: the change from one cell size to the next exceeds it.
const COARSE_TOLERANCE: f64 = 1e-3;
const COARSE_PRODUCTS: usize = 200;

/// Smallest number of cells along a side of the coarsest grid.
const FEWEST_CELLS: usize = 16;

/// Separation on cells of twice the size, if enough of them remain: the mean of the two middle values of four. A last odd column or row is
/// dropped.
fn coarsened((grid, separation): (&Grid, &[f64]), boundary: Boundary) -> Option<(Grid, Vec<f64>)> {
    let (columns, rows) = (grid.columns() / 2, grid.rows() / 2);
    let whole = grid.columns().is_multiple_of(2) && grid.rows().is_multiple_of(2);
    if columns.min(rows) < FEWEST_CELLS || (boundary == Boundary::Periodic && !whole) {
        return None;
    }
    let cell = grid.cell().map(|side| 2.0 * side);
    let coarse = Grid::new(columns, rows, cell, grid.origin()).ok()?;
    let mut values = Vec::with_capacity(coarse.cell_count());
    for row in 0..rows {
        let (low, high) = separation[2 * row * grid.columns()..].split_at(grid.columns());
        for (low, high) in low
            .as_chunks()
            .0
            .iter()
            .zip(high.as_chunks().0)
            .take(columns)
        {
            values.push(middle(*low, *high));
        }
    }
    Some((coarse, values))
}

/// Mean of the two middle values of four; the lowest value if they are not finite.
fn middle([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    let (low, high) = ((a.min(b)).max(c.min(d)), (a.max(b)).min(c.max(d)));
    let mean = 0.5 * (low + high);
    if mean.is_finite() {
        mean
    } else {
        a.min(b).min(c).min(d)
    }
}
