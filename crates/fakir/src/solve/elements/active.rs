//! Contact on the cells of one size, with unknowns only where pressure is likely.
//!
//! With pressures to start from, the cells that bear them or interpenetrate under them are active, and their neighbours. The contact is
//! solved on these, and then the gap of all others is looked at. Those that interpenetrate become active with their neighbours, and the
//! contact is solved again, until the [certificate](super::solver) is good with the lowest gap anywhere: nothing is left out unseen.
//!
//! Transforms reach over the active cells only, and where displacements cannot be negative only cells with a separation below the
//! indentation are looked at.

use super::solver::{self, ElementContact, Prescribed, Settings};
use crate::halfspace::elements::half_space::HalfSpace;
use crate::halfspace::elements::{Columns, FreeSpaceConvolution, Operator, Preconditioned};
use crate::numerics::workers::CancelToken;
use crate::problem::layer::WeightedLayer;
use crate::problem::{Boundary, Cells, Grid};
use crate::state::{SolveError, Termination};
use rayon::ThreadPool;

/// Bytes of a solution for every unknown, besides the operator: twelve arrays of the solver, labels, segments.
const BYTES_PER_UNKNOWN: usize = 150;

/// Bytes for every cell that is looked at, besides the operator: pressure, displacement, whether it becomes active.
const BYTES_PER_LOOK: usize = 17;

/// Part of the tolerance left to the cells that are not active.
const SHARE_OF_OTHERS: f64 = 0.1;

/// The surface on cells of one size.
pub(super) struct Surface<'s, 'a> {
    pub(super) grid: Grid,
    /// Separation of the undeformed surfaces of every cell, m.
    pub(super) separation: &'s [f64],
    /// Whether a cell may bear pressure at all; such cells have a finite separation.
    pub(super) may_bear: &'s dyn Fn(usize) -> bool,
    /// Whether displacements can be negative.
    pub(super) rises: bool,
    pub(super) boundary: Boundary,
    pub(super) compliance: f64,
    pub(super) layers: &'s [WeightedLayer],
    /// Pillar of every cell, and displacement of a pillar by a unit sum of the pressures on it, m/Pa.
    pub(super) pillar: &'s dyn Fn(usize) -> u32,
    pub(super) influence: &'s [f64],
    /// Refuses so many bytes for so many cells.
    pub(super) check_memory: &'s dyn Fn(usize, usize) -> Result<(), SolveError>,
    pub(super) pool: Option<&'a ThreadPool>,
    pub(super) cancel: &'s CancelToken,
}

/// Pressures on some cells; there are none on others.
#[derive(Debug, Clone)]
pub(super) struct Pressures {
    pub(super) cells: Cells,
    pub(super) values: Vec<f64>,
}

impl Pressures {
    /// On the cells of a grid that are half as large: all of one have its pressure.
    pub(super) fn refined(&self, grid: &Grid) -> Self {
        let [columns, rows] = [self.cells.grid().columns(), self.cells.grid().rows()];
        let mut known = vec![0.0; columns * rows];
        self.cells.scatter(&self.values, &mut known);
        let pressure = |cell: usize| {
            let (column, row) = (cell % grid.columns() / 2, cell / grid.columns() / 2);
            // A last odd column or row belongs to no larger cell.
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

    /// On other cells, of the same grid.
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

/// The kernels made for the active cells of a surface, kept from one solution to the next.
#[derive(Default)]
pub(super) struct ActiveCells<'a> {
    /// Operators on no cells.
    kernels: Vec<HalfSpace<'a>>,
}

/// What was found by looking at cells that are not active.
struct Seen {
    /// The lowest gap, m.
    lowest: f64,
    /// Cells that interpenetrate, and their neighbours.
    near: Vec<bool>,
}

impl<'a> ActiveCells<'a> {
    /// Solves from the pressures given, or on all cells that may bear any.
    ///
    /// `expected` is the indentation that is expected under a force, if it is known.
    pub(super) fn solve(
        &mut self,
        surface: &Surface<'_, 'a>,
        start: Option<Pressures>,
        expected: Option<f64>,
        load: Prescribed,
        settings: &Settings,
    ) -> Result<(Cells, ElementContact), SolveError> {
        let allowed = Cells::where_true(&surface.grid, surface.may_bear);
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
                    seen.near[cell] && (surface.may_bear)(cell)
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
                seen.near[cell] && (surface.may_bear)(cell)
            });
            if more.len() == cells.len() {
                // A bound that is no number, or rounding: there is nothing more to take in.
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

    /// Finds what interpenetrates under the pressures, of the cells that may bear any.
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
            // All that can interpenetrate, and all that press.
            for (cell, pressure) in known.cells.indices().zip(&known.values) {
                near[cell] = *pressure > 0.0;
            }
            let cells = Cells::where_true(&surface.grid, |cell| {
                (surface.separation[cell] < indentation && (surface.may_bear)(cell)) || near[cell]
            });
            near.fill(false);
            cells
        };
        let bytes = surface.half_space_memory(&cells) + BYTES_PER_LOOK * cells.len();
        // What is to be solved takes about as much as on the cells known: what is refused is refused for the larger of both.
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

    /// The operator on cells, with a kernel that there is, or a new one that is kept.
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

/// Most kernels kept: for the active cells, and for those to look at.
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

/// Marks a cell and its eight neighbours, across the border of a period too.
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
