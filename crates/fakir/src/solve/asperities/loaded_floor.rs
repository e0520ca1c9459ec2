//! The cells of the floor under rounded tops, which are [part of their equations](super::floor_equations).
//!
//! With adhesion the contact depends on the path, and its stability on the floor: the floor is not solved in turn with the tops
//! ([`mixed`](super::mixed)), but eliminated from their equations. The pressures on the floor are constant on square cells. At given tops the
//! cells in contact follow from the unilateral condition: their forces `f >= 0` close the gap, `K f = zeta - separation - sunk`. The
//! residual of the tops is that under these forces, and its derivatives include their changes, `df = K^-1 (dzeta - dsunk)`, as long as the same
//! cells are in contact. The determinant of these equations changes its sign where tops and floor together become unstable.
//!
//! On an adhesive floor the cells in contact, of either sign of force, are given: they are part of the contacts, and change where their
//! [fronts](crate::solve::rules::floor_fronts) move, at a constant indentation and together with the tops, as between flat tops and on height maps.
//!
//! A cell acts on a top as a point force at its centre, projected onto the modes of the disc. The displacement of a cell by the tops is the
//! transpose of this, so that forces are derivatives of one energy.

use super::load::FloorForces;
use crate::halfspace::elements::Operator;
use crate::halfspace::elements::half_space::HalfSpace;
use crate::numerics::cholesky::{factorise, solve_lower, solve_upper};
use crate::numerics::convergence::smaller;
use crate::numerics::dense::Matrix;
use crate::numerics::vector::add_scaled;
use crate::problem::layer::WeightedLayer;
use crate::problem::{Boundary, Cells, Grid, Point};
use crate::solve::rules::bonded_floor::{ENTERED, Rounds};
use crate::solve::rules::floor_fronts::{FloorFronts, FloorMove, OF_CENTRES};
use crate::solve::rules::fronts::Works;
use crate::state::discs::Contacts;
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
    /// Gap of every cell; zero in contact.
    gaps: Vec<f64>,
    /// The fronts of an adhesive floor.
    bonding: Option<Bonding>,
}

/// The fronts of an adhesive floor: the cells in contact depend on the path, and are part of the [contacts](Contacts).
#[derive(Debug, Clone)]
struct Bonding {
    fronts: FloorFronts,
    is_bonded: Vec<bool>,
    /// Work of adhesion of a cell.
    work: f64,
    cell_area: f64,
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
            gaps: vec![0.0; count],
            bonding: None,
        })
    }

    /// The same floor with adhesion, between pillars.
    pub(super) fn with_adhesion(
        self,
        works: Works,
        cells: &Cells,
        pillars: &[(Point, f64)],
    ) -> Self {
        let cell_area = cells.grid().cell_area();
        let side = cell_area.sqrt();
        let fronts = FloorFronts::on_cells(cells, side, Some(works), &OF_CENTRES);
        let bonding = Bonding {
            fronts: fronts.beside(cells, side, pillars),
            is_bonded: vec![false; self.cells.len()],
            work: works.advancing * cell_area,
            cell_area,
        };
        Self {
            bonding: Some(bonding),
            ..self
        }
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

    /// Elastic energy of the forces on the floor, without their displacement of the tops, which is part of the overlap, less its work of
    /// adhesion.
    pub(super) fn energy(&self, indentation: f64) -> f64 {
        let cells = self.cells.iter().zip(&self.sunk).zip(&self.forces);
        let elastic: f64 = cells
            .map(|((cell, sunk), force)| 0.5 * force * (indentation + sunk - cell.separation))
            .sum();
        let of_cell = self.bonding.as_ref().map_or(0.0, |it| it.work);
        elastic - of_cell * self.touched.len() as f64
    }

    pub(super) fn point_forces(&self) -> impl Iterator<Item = (Point, f64)> + '_ {
        let touched = self.touched.iter();
        touched.map(|cell| (self.cells[*cell].centre, self.forces[*cell]))
    }

    /// Solves the floor under these contacts, which displace it by these forces. Returns whether the cells in contact were found.
    pub(super) fn close(&mut self, tops: &FloorForces, contacts: &Contacts) -> bool {
        let indentation = contacts.indentation;
        for (sunk, cell) in self.sunk.iter_mut().zip(&*self.cells) {
            *sunk = tops.displacement(cell.centre);
        }
        let cells = self.cells.iter().zip(&self.sunk);
        let closed: Vec<f64> = cells
            .map(|(cell, sunk)| indentation - cell.separation - sunk)
            .collect();
        if self.bonding.is_some() {
            let is_known = *self.touched == *contacts.bonded || self.attach(&contacts.bonded);
            self.press(&closed);
            return is_known;
        }
        for _ in 0..CHANGES {
            self.press(&closed);
            let least = -PENETRATION * self.depth;
            let is_in = |cell: &usize| match self.touched.binary_search(cell) {
                Ok(_) => self.forces[*cell] >= 0.0,
                Err(_) => self.gaps[*cell] < least,
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

    /// The forces that close the cells in contact, and the gaps of all cells.
    fn press(&mut self, closed: &[f64]) {
        let mut forces: Vec<f64> = self.touched.iter().map(|cell| closed[*cell]).collect();
        self.solve(&mut forces);
        self.forces.fill(0.0);
        for (gap, closed) in self.gaps.iter_mut().zip(closed) {
            *gap = -closed;
        }
        for (cell, force) in self.touched.iter().zip(&forces) {
            self.forces[*cell] = *force;
            add_scaled(&mut self.gaps, *force, self.compliance.column(*cell));
        }
    }

    /// Brings these cells of an adhesive floor into contact, and no others. Returns whether their compliance is factorised.
    fn attach(&mut self, bonded: &[usize]) -> bool {
        self.touched = bonded.to_vec();
        if let Some(Bonding {
            fronts, is_bonded, ..
        }) = &mut self.bonding
        {
            for cell in 0..self.cells.len() {
                fronts.set(is_bonded, cell, bonded.binary_search(&cell).is_ok());
            }
        }
        self.refactor()
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

    /// Whether the floor is adhesive.
    pub(super) fn is_adhesive(&self) -> bool {
        self.bonding.is_some()
    }

    /// The cells in contact after the next round in which fronts of an adhesive floor move; `None` if they rest.
    pub(super) fn next_round(&mut self, rounds: &mut Rounds) -> Option<Arc<[usize]>> {
        let bonding = self.bonding.as_mut()?;
        let Bonding {
            fronts,
            is_bonded,
            cell_area,
            ..
        } = bonding;
        let mut advances = false;
        let (gaps, forces) = (&self.gaps, &self.forces);
        let moves = |which: FloorMove| {
            advances = which == FloorMove::Advance;
            let loads = gaps.iter().map(|gap| -gap);
            let pressures = forces.iter().map(|force| force / *cell_area);
            fronts.round(is_bonded, which, (loads, pressures), ENTERED * self.depth)
        };
        let moves = rounds.next(moves, Vec::is_empty);
        for cell in &moves {
            fronts.set(is_bonded, *cell, advances);
        }
        let cells = is_bonded.iter().enumerate();
        let bonded = cells.filter_map(|(cell, is_bonded)| is_bonded.then_some(cell));
        (!moves.is_empty()).then(|| bonded.collect())
    }

    /// Allows all cells to attach again.
    pub(super) fn lift_bans(&mut self) {
        if let Some(bonding) = &mut self.bonding {
            bonding.fronts.lift_bans();
        }
    }

    /// The cell of an adhesive floor without contact in which the lens is deepest, and this depth.
    pub(super) fn deepest(&self) -> Option<(usize, f64)> {
        if !self.is_adhesive() || !self.touched.is_empty() {
            return None;
        }
        let depths = self.gaps.iter().map(|gap| -gap).enumerate();
        depths.max_by(|one, other| one.1.total_cmp(&other.1))
    }

    /// A cell with those around it.
    pub(super) fn around(&self, cell: usize) -> Arc<[usize]> {
        let bonding = self.bonding.iter();
        let mut cells: Vec<usize> = bonding.flat_map(|it| it.fronts.around(cell)).collect();
        cells.sort_unstable();
        cells.into()
    }

    /// Indentation at which the floor is touched if the tops carry no load.
    pub(super) fn first_touch(&self) -> f64 {
        let separations = self.cells.iter().map(|cell| cell.separation);
        separations.fold(f64::INFINITY, smaller)
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
