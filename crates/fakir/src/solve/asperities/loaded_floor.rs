//! The cells of the floor under rounded tops, which are [part of their equations](super::floor_equations).
//!
//! With adhesion the contact depends on the path, and its stability on the floor: the floor is not solved in turn with the tops
//! ([`mixed`](super::mixed)), but eliminated from their equations. The pressures on the floor are constant on square cells. At given tops the
//! cells in contact follow from the unilateral condition: their forces `f >= 0` close the gap, `K f = zeta - separation - sunk`. The
//! residual of the tops is that under these forces, and its derivatives include their changes, `df = K^-1 (dzeta - dsunk)`, as long as the same
//! cells are in contact. The determinant of these equations changes its sign where tops and floor together become unstable.
//!
//! A cell acts on a top as a point force at its centre, projected onto the modes of the disc. The displacement of a cell by the tops is the
//! transpose of this, so that forces are derivatives of one energy.

use super::load::FloorForces;
use crate::halfspace::elements::Operator;
use crate::halfspace::elements::half_space::HalfSpace;
use crate::numerics::cholesky::{factorise, solve_lower, solve_upper};
use crate::numerics::dense::Matrix;
use crate::problem::layer::WeightedLayer;
use crate::problem::{Boundary, Cells, Grid, Point};
use std::sync::Arc;

/// Largest number of changes of the cells in contact.
const CHANGES: usize = 60;

/// Penetration of a cell without contact that is neglected, relative to the depth of the floor.
const PENETRATION: f64 = 1e-12;

/// Cells of the floor, which is below the reference level by a depth. Lengths are in units of the contacts, and forces in those of the
/// modulus.
#[derive(Debug, Clone)]
pub(crate) struct LoadedFloor {
    cells: Arc<[Cell]>,
    /// Displacement of a cell per unit force on another.
    compliance: Arc<Matrix>,
    depth: f64,
    /// Displacement of every cell by the tops.
    sunk: Vec<f64>,
    /// Force on every cell.
    forces: Vec<f64>,
    /// The cells in contact, in increasing order.
    touched: Vec<usize>,
    /// The Cholesky factor of their compliance.
    factor: Vec<f64>,
    /// Derivatives of the last linearised equations.
    pub(super) rates: FloorRates,
}

#[derive(Debug, Clone, Copy)]
struct Cell {
    centre: Point,
    /// Depth below the undeformed lens at zero indentation.
    separation: f64,
}

/// Changes of the force on the floor, and of its effect on the tops.
#[derive(Debug, Clone, Default)]
pub(crate) struct FloorRates {
    /// Change of the residual of the tops with the indentation.
    pub(super) residual: Vec<f64>,
    /// Change of the force on the floor with the indentation, at fixed contacts.
    pub(super) force: f64,
    /// Changes of the force on the floor with every component of a step.
    pub(super) row: Vec<f64>,
}

impl LoadedFloor {
    /// The floor on cells with their separations, of a half-space or of layers. `None` without cells.
    pub(super) fn new(
        cells: &Cells,
        separation: &[f64],
        depth: f64,
        layers: &[WeightedLayer],
    ) -> Option<Self> {
        let positions: Vec<(usize, usize)> = cells.positions().collect();
        let [columns, rows] = [0, 1].map(|k| {
            let along = positions.iter().map(|at| if k == 0 { at.0 } else { at.1 });
            let ends = along.fold([usize::MAX, 0], |[a, b], at| [a.min(at), b.max(at)]);
            (ends[1] + 1).saturating_sub(ends[0])
        });
        let grid = cells.grid();
        let whole = Grid::new(columns, rows, grid.cell(), [0.0; 2]).ok()?;
        // The displacement by a pressure on the first cell contains all that differ.
        let mut pressure = vec![0.0; columns * rows];
        pressure[0] = grid.cell_area().recip();
        let mut kernel = vec![0.0; columns * rows];
        HalfSpace::new(Boundary::FreeSpace, Cells::all(&whole), 1.0, layers, None)
            .apply(&pressure, &mut kernel);
        let count = positions.len();
        let compliance = Matrix::from_fn(count, count, |i, j| {
            let (one, two) = (positions[i], positions[j]);
            kernel[one.1.abs_diff(two.1) * columns + one.0.abs_diff(two.0)]
        });
        let of_cell = |(centre, separation): (Point, &f64)| Cell {
            centre,
            separation: *separation,
        };
        Some(Self {
            cells: cells.centres().zip(separation).map(of_cell).collect(),
            compliance: Arc::new(compliance),
            depth,
            sunk: vec![0.0; count],
            forces: vec![0.0; count],
            touched: Vec::new(),
            factor: Vec::new(),
            rates: FloorRates::default(),
        })
    }

    /// Memory of the floor on this many cells, bytes.
    pub(super) fn memory(cells: usize) -> usize {
        // The compliance, and the factor of that of all cells.
        2 * 8 * cells * cells
    }

    /// Force on the floor.
    pub(crate) fn force(&self) -> f64 {
        self.forces.iter().sum()
    }

    /// Force on every cell.
    pub(super) fn forces(&self) -> &[f64] {
        &self.forces
    }

    /// Displacement of every cell by the tops.
    pub(super) fn sunk(&self) -> &[f64] {
        &self.sunk
    }

    /// Twice the elastic energy of the forces on the floor, without their displacement of the tops: this is part of the overlap.
    pub(super) fn work(&self, indentation: f64) -> f64 {
        let cells = self.cells.iter().zip(&self.sunk).zip(&self.forces);
        cells
            .map(|((cell, sunk), force)| force * (indentation + sunk - cell.separation))
            .sum()
    }

    pub(super) fn point_forces(&self) -> impl Iterator<Item = (Point, f64)> + '_ {
        let touched = self.touched.iter();
        touched.map(|cell| (self.cells[*cell].centre, self.forces[*cell]))
    }

    /// Solves the floor under tops that displace it by these forces. Returns whether the cells in contact were found.
    pub(super) fn close(&mut self, tops: &FloorForces, indentation: f64) -> bool {
        for (sunk, cell) in self.sunk.iter_mut().zip(&*self.cells) {
            *sunk = tops.displacement(cell.centre);
        }
        let cells = self.cells.iter().zip(&self.sunk);
        let closed: Vec<f64> = cells
            .map(|(cell, sunk)| indentation - cell.separation - sunk)
            .collect();
        for _ in 0..CHANGES {
            let mut forces: Vec<f64> = self.touched.iter().map(|cell| closed[*cell]).collect();
            self.solve(&mut forces);
            self.forces.fill(0.0);
            for (cell, force) in self.touched.iter().zip(&forces) {
                self.forces[*cell] = *force;
            }
            let mut gap: Vec<f64> = closed.iter().map(|closed| -closed).collect();
            for (cell, force) in self.touched.iter().zip(&forces) {
                let column = self.compliance.column(*cell);
                gap.iter_mut()
                    .zip(column)
                    .for_each(|(gap, w)| *gap += force * w);
            }
            let least = -PENETRATION * self.depth;
            let is_in = |cell: &usize| match self.touched.binary_search(cell) {
                Ok(place) => forces[place] >= 0.0,
                Err(_) => gap[*cell] < least,
            };
            let next: Vec<usize> = (0..self.cells.len()).filter(is_in).collect();
            if next == self.touched {
                return true;
            }
            self.touched = next;
            if !self.refactor() {
                return false;
            }
        }
        false
    }

    /// Factorises the compliance of the cells in contact.
    fn refactor(&mut self) -> bool {
        let size = self.touched.len();
        self.factor.clear();
        for column in &self.touched {
            let column = self.compliance.column(*column);
            self.factor
                .extend(self.touched.iter().map(|row| column[*row]));
        }
        factorise(&mut self.factor, size)
    }

    /// The centres of the cells in contact.
    pub(super) fn touched(&self) -> impl ExactSizeIterator<Item = Point> + '_ {
        self.touched.iter().map(|cell| self.cells[*cell].centre)
    }

    /// The forces on the cells in contact that displace these by `right`, in its place.
    pub(super) fn solve(&self, right: &mut [f64]) {
        let size = self.touched.len();
        solve_lower(&self.factor, size, right);
        solve_upper(&self.factor, size, right);
    }
}
