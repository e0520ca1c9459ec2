//! Contact of two surfaces of which the separation is known at every cell of a grid.
//!
//! It is solved on larger and larger cells first, the largest first. Each gives pressures to start from on cells half as large, and so
//! tells which of these are active; all others are looked at in the end. A contact that is a small part of the grid takes time and
//! memory about as the rectangle around it on a free half-space.

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
    /// Separation of the undeformed surfaces at the centre of every cell at no indentation, m, row by row. Cells where it is infinite are never touched.
    pub values: &'s [f64],
    /// What lies around the grid.
    pub boundary: Boundary,
    /// The sum of `(1 - nu^2)/E` of both bodies, 1/Pa.
    pub compliance: f64,
}

/// A contact, with the cells that it was solved on. No others bear pressure.
#[derive(Debug, Clone)]
pub struct ActiveContact {
    /// The active cells.
    pub cells: Cells,
    /// Pressures and gaps on these. The certificate is that of all cells.
    pub contact: ElementContact,
}

impl Separation<'_> {
    /// Presses the surfaces together.
    ///
    /// # Errors
    /// More memory than is allowed, or interruption. A solution that did not converge is not an error: see
    /// [`ElementContact::termination`].
    ///
    /// # Panics
    /// If there is not one separation for every cell.
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

    /// Presses cells of one size, starting from the contact on cells twice as large.
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
            may_bear: &|cell| separation[cell] <= bound,
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

/// Tolerance and most products on larger cells: cells of twice the size change the contact by more.
const COARSE_TOLERANCE: f64 = 1e-3;
const COARSE_PRODUCTS: usize = 200;

/// Fewest cells along a side of the coarsest grid.
const FEWEST_CELLS: usize = 16;

/// The separation on cells twice as large, of which there are enough: the mean of the two middle ones of four. A last odd column or row is left out.
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

/// The mean of the two middle ones of four values; the lowest if these are not finite.
fn middle([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    let (low, high) = ((a.min(b)).max(c.min(d)), (a.max(b)).min(c.max(d)));
    let mean = 0.5 * (low + high);
    if mean.is_finite() {
        mean
    } else {
        a.min(b).min(c).min(d)
    }
}
