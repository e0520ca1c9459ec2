//! Contact on the cells of one size, with unknowns only on an active set.
//!
//! The active set consists of the cells that carry pressure in the start or interpenetrate under it, and their neighbours. After the
//! contact is solved on these cells, the gap of all others is checked. Cells that interpenetrate become active together with their
//! neighbours, and the contact is solved again until the [duality gap](super::solver), computed with the lowest gap of all cells, is within
//! the tolerance. The result therefore does not depend on the choice of the active set.
//!
//! Transforms extend over the active cells only. Where displacements cannot be negative, only cells with a separation below the indentation
//! are checked.

use super::solver::{self, ElementContact, Prescribed, Settings};
use crate::halfspace::elements::half_space::HalfSpace;
use crate::halfspace::elements::{Columns, FreeSpaceConvolution, Operator, Preconditioned};
use crate::numerics::workers::CancelToken;
use crate::problem::layer::WeightedLayer;
use crate::problem::{Boundary, Cells, Grid};
use crate::state::{SolveError, Termination};
use rayon::ThreadPool;

/// Memory of a solution per unknown, besides the operator, bytes: twelve arrays of the solver, labels, segments.
const BYTES_PER_UNKNOWN: usize = 150;

/// Memory per checked cell, besides the operator, bytes: pressure, displacement, and the flag for the active set.
const BYTES_PER_LOOK: usize = 17;

/// Fraction of the tolerance that is reserved for inactive cells.
const SHARE_OF_OTHERS: f64 = 0.1;

/// The surface on cells of one size.
pub(super) struct Surface<'s, 'a> {
    pub(super) grid: Grid,
    /// Separation of the undeformed surfaces at every cell, m.
    pub(super) separation: &'s [f64],
    /// Whether a cell may carry pressure. Such cells must have a finite separation.
    pub(super) may_carry_load: &'s dyn Fn(usize) -> bool,
    /// Whether displacements can be negative.
    pub(super) rises: bool,
    pub(super) boundary: Boundary,
    pub(super) compliance: f64,
    pub(super) layers: &'s [WeightedLayer],
    /// Pillar of every cell, and displacement of a pillar by a unit sum of the pressures on it, m/Pa.
    pub(super) pillar: &'s dyn Fn(usize) -> u32,
    pub(super) influence: &'s [f64],
    /// Returns an error if so many bytes for so many cells exceed the memory limit.
    pub(super) check_memory: &'s dyn Fn(usize, usize) -> Result<(), SolveError>,
    pub(super) pool: Option<&'a ThreadPool>,
    pub(super) cancel: &'s CancelToken,
}

/// Pressures on some cells; zero on all others.
#[derive(Debug, Clone)]
pub(super) struct Pressures {
    pub(super) cells: Cells,
    pub(super) values: Vec<f64>,
}

impl Pressures {
    /// Pressures on a grid of half the cell size: four cells take the pressure of one.
    pub(super) fn refined(&self, grid: &Grid) -> Self {
        let [columns, rows] = [self.cells.grid().columns(), self.cells.grid().rows()];
        let mut known = vec![0.0; columns * rows];
        self.cells.scatter(&self.values, &mut known);
        let pressure = |cell: usize| {
            let (column, row) = (cell % grid.columns() / 2, cell / grid.columns() / 2);
            // The last column or row of an odd number belongs to no larger cell.
            let inside = column < columns && row < rows;
            if inside {
                known[row * columns + column]
            } else {
                0.0
            }
        };
        let cells = Cells::where_true(grid, |cell| pressure(cell) > 0.0);
        let values = cells.indices().map(pressure).collect();
        Self { cells, values }
    }

    /// Pressures on other cells of the same grid.
    fn on(&self, cells: &Cells) -> Vec<f64> {
        let mut values = vec![0.0; cells.len()];
        let mut known = self.cells.indices().zip(&self.values).peekable();
        for (cell, value) in cells.indices().zip(&mut values) {
            while known.next_if(|(other, _)| *other < cell).is_some() {}
            if let Some((_, pressure)) = known.next_if(|(other, _)| *other == cell) {
                *value = *pressure;
            }
        }
        values
    }
}

/// Kernels for the active cells of a surface, kept between solutions.
#[derive(Default)]
pub(super) struct ActiveCells<'a> {
    /// Operators without cells.
    kernels: Vec<HalfSpace<'a>>,
}

/// Result of the check of inactive cells.
struct Seen {
    /// The lowest gap, m.
    lowest: f64,
    /// Cells that interpenetrate, and their neighbours.
    near: Vec<bool>,
}

impl<'a> ActiveCells<'a> {
    /// Solves from a start, or on all cells that may carry pressure.
    ///
    /// `expected` is the expected indentation under a prescribed force, if available.
    pub(super) fn solve(
        &mut self,
        surface: &Surface<'_, 'a>,
        start: Option<Pressures>,
        expected: Option<f64>,
        load: Prescribed,
        settings: &Settings,
    ) -> Result<(Cells, ElementContact), SolveError> {
        let allowed = Cells::where_true(&surface.grid, surface.may_carry_load);
        let mut products = 0;
        let indentation = match load {
            Prescribed::Indentation(indentation) => Some(indentation),
            Prescribed::Force(_) => expected,
        };
        let (mut cells, mut values) = match (start, indentation) {
            (Some(start), Some(indentation)) => {
                let mut seen = self.look(surface, &allowed, &start, indentation)?;
                products += 1;
                for (cell, value) in start.cells.indices().zip(&start.values) {
                    if *value > 0.0 {
                        mark(surface, cell, &mut seen.near);
                    }
                }
                let cells = Cells::where_true(&surface.grid, |cell| {
                    seen.near[cell] && (surface.may_carry_load)(cell)
                });
                let values = start.on(&cells);
                (cells, values)
            }
            (start, _) => {
                let values = start.map_or_else(|| vec![0.0; allowed.len()], |s| s.on(&allowed));
                (allowed.clone(), values)
            }
        };
        loop {
            let inner = Settings {
                tolerance: if cells.len() == allowed.len() {
                    settings.tolerance
                } else {
                    (1.0 - SHARE_OF_OTHERS) * settings.tolerance
                },
                product_limit: settings.product_limit.saturating_sub(products),
            };
            let mut contact = self.solve_on(surface, &cells, values, load, &inner)?;
            products += contact.products;
            contact.products = products;
            if cells.len() == allowed.len() || contact.termination == Termination::Interrupted {
                return Ok((cells, contact));
            }
            let known = Pressures {
                values: std::mem::take(&mut contact.pressure),
                cells,
            };
            let mut seen = self.look(surface, &allowed, &known, contact.indentation)?;
            products += 1;
            contact.pressure = known.values;
            contact.products = products;
            cells = known.cells;
            contact.take_in(
                seen.lowest,
                load,
                cells.indices().map(|cell| surface.separation[cell]),
            );
            let converged = contact.termination == Termination::Converged;
            if !converged || contact.certificate.energy_bound <= settings.tolerance {
                return Ok((cells, contact));
            }
            for cell in cells.indices() {
                seen.near[cell] = true;
            }
            let more = Cells::where_true(&surface.grid, |cell| {
                seen.near[cell] && (surface.may_carry_load)(cell)
            });
            if more.len() == cells.len() {
                // The bound is NaN or affected by rounding: no cell can be added.
                contact.termination = Termination::Stagnated;
                return Ok((cells, contact));
            }
            let known = Pressures {
                cells,
                values: contact.pressure,
            };
            values = known.on(&more);
            cells = more;
        }
    }

    fn solve_on(
        &mut self,
        surface: &Surface<'_, 'a>,
        cells: &Cells,
        start: Vec<f64>,
        load: Prescribed,
        settings: &Settings,
    ) -> Result<ElementContact, SolveError> {
        (surface.check_memory)(cells.len(), surface.solution_memory(cells))?;
        surface.check_cancelled()?;
        let half_space = self.half_space(surface, cells);
        let operator = half_space.preconditioned(cells.clone(), surface.pool);
        let mut operator = surface.on_columns(operator, cells);
        let separation: Vec<f64> = cells
            .indices()
            .map(|cell| surface.separation[cell])
            .collect();
        Ok(solver::solve_from(
            &mut operator,
            &separation,
            surface.grid.cell_area(),
            load,
            start,
            settings,
            surface.cancel,
        ))
    }

    /// Determines which of the cells that may carry pressure interpenetrate under the given pressures.
    fn look(
        &mut self,
        surface: &Surface<'_, 'a>,
        allowed: &Cells,
        known: &Pressures,
        indentation: f64,
    ) -> Result<Seen, SolveError> {
        let mut near = vec![false; surface.grid.cell_count()];
        let cells = if surface.rises {
            allowed.clone()
        } else {
            // All cells that may interpenetrate, and all that carry pressure.
            for (cell, pressure) in known.cells.indices().zip(&known.values) {
                near[cell] = *pressure > 0.0;
            }
            let cells = Cells::where_true(&surface.grid, |cell| {
                (surface.separation[cell] < indentation && (surface.may_carry_load)(cell))
                    || near[cell]
            });
            near.fill(false);
            cells
        };
        let bytes = surface.half_space_memory(&cells) + BYTES_PER_LOOK * cells.len();
        // The next solution needs about as much memory as the last one: check the larger of both.
        let bytes = bytes.max(surface.solution_memory(&known.cells));
        (surface.check_memory)(cells.len(), bytes)?;
        surface.check_cancelled()?;
        let half_space = self.half_space(surface, &cells);
        let mut operator = surface.on_columns(half_space, &cells);
        let pressure = known.on(&cells);
        let mut displacement = vec![0.0; cells.len()];
        operator.apply(&pressure, &mut displacement);
        let mut lowest = f64::INFINITY;
        for (cell, displacement) in cells.indices().zip(&displacement) {
            let gap = surface.separation[cell] + displacement - indentation;
            if gap < 0.0 {
                lowest = lowest.min(gap);
                mark(surface, cell, &mut near);
            }
        }
        Ok(Seen { lowest, near })
    }

    /// Operator on cells, from an existing kernel, or from a new one that is kept.
    fn half_space(&mut self, surface: &Surface<'_, 'a>, cells: &Cells) -> HalfSpace<'a> {
        let known = self.kernels.iter();
        let mut fitting = known.filter(|kernel| !kernel.is_wide_for(cells));
        if let Some(operator) = fitting.find_map(|kernel| kernel.on_cells(cells.clone())) {
            return operator;
        }
        let operator = HalfSpace::new(
            surface.boundary,
            cells.clone(),
            surface.compliance,
            surface.layers,
            surface.pool,
        );
        let none = Cells::where_true(&surface.grid, |_| false);
        if self.kernels.len() == KERNELS {
            self.kernels.remove(0);
        }
        self.kernels.extend(operator.on_cells(none));
        operator
    }
}

/// Largest number of kernels kept: one for the active cells and one for the check.
const KERNELS: usize = 2;

impl<'a> Surface<'_, 'a> {
    fn half_space_memory(&self, cells: &Cells) -> usize {
        let threads = self.pool.map_or(1, ThreadPool::current_num_threads);
        HalfSpace::memory_estimate(self.boundary, cells, threads)
    }

    fn solution_memory(&self, cells: &Cells) -> usize {
        self.half_space_memory(cells)
            + Preconditioned::<FreeSpaceConvolution<'_>>::memory_estimate(cells)
            + BYTES_PER_UNKNOWN * cells.len()
    }

    fn on_columns<O: Operator>(&self, operator: O, cells: &Cells) -> Columns<O> {
        let pillars = cells.indices().map(self.pillar).collect();
        Columns::new(operator, pillars, self.influence.to_vec())
    }

    fn check_cancelled(&self) -> Result<(), SolveError> {
        if self.cancel.is_cancelled() {
            Err(SolveError::Interrupted)
        } else {
            Ok(())
        }
    }
}

/// Marks a cell and its eight neighbours, also across a periodic border.
fn mark(surface: &Surface<'_, '_>, cell: usize, near: &mut [bool]) {
    let (columns, rows) = (surface.grid.columns(), surface.grid.rows());
    let goes_on = surface.boundary == Boundary::Periodic;
    let around = |at: usize, count: usize| {
        let sides = [
            (at > 0).then(|| at - 1).or(goes_on.then_some(count - 1)),
            Some(at),
            (at + 1 < count).then_some(at + 1).or(goes_on.then_some(0)),
        ];
        sides.into_iter().flatten()
    };
    for row in around(cell / columns, rows) {
        for column in around(cell % columns, columns) {
            near[row * columns + column] = true;
        }
    }
}
