//! The floor as part of the equations of the tops.
//!
//! With adhesion the contact depends on the path, and its stability on the floor: the floor is not solved in turn with the tops
//! ([`mixed`](super::mixed)), but eliminated from their equations. The pressures on the floor are constant on square cells. At given tops the
//! cells in contact follow from the unilateral condition: their forces `f >= 0` close the gap, `K f = zeta - separation - sunk`. The
//! residual of the tops is that under these forces, and its derivatives include their changes, `df = K^-1 (dzeta - dsunk)`, as long as the same
//! cells are in contact. The determinant of these equations changes its sign where tops and floor together become unstable.
//!
//! A cell acts on a top as a point force at its centre, projected onto the modes of the disc. The displacement of a cell by the tops is the
//! transpose of this, so that forces are derivatives of one energy.

use super::equations::Equations;
use super::load::{FloorForces, Jet, Layout};
use crate::halfspace::disc::basis::UNIT_FORCE;
use crate::halfspace::elements::Operator;
use crate::halfspace::elements::half_space::HalfSpace;
use crate::numerics::cholesky::{factorise, solve_lower, solve_upper};
use crate::numerics::dense::Matrix;
use crate::numerics::vector::dot;
use crate::problem::layer::WeightedLayer;
use crate::problem::{Boundary, Cells, Grid, Point};
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

    fn point_forces(&self) -> impl Iterator<Item = (Point, f64)> + '_ {
        let touched = self.touched.iter();
        touched.map(|cell| (self.cells[*cell].centre, self.forces[*cell]))
    }

    /// Solves the floor under these tops. Returns whether the cells in contact were found.
    fn close(&mut self, equations: &Equations<'_>, contacts: &Contacts) -> bool {
        let tops = equations.as_forces(contacts);
        for (sunk, cell) in self.sunk.iter_mut().zip(&*self.cells) {
            *sunk = tops.displacement(cell.centre);
        }
        let cells = self.cells.iter().zip(&self.sunk);
        let closed: Vec<f64> = cells
            .map(|(cell, sunk)| contacts.indentation - cell.separation - sunk)
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

    /// The forces on the cells in contact that displace these by `right`, in its place.
    fn solve(&self, right: &mut [f64]) {
        let size = self.touched.len();
        solve_lower(&self.factor, size, right);
        solve_upper(&self.factor, size, right);
    }

    /// Subtracts the effect of the floor from the derivatives of the residual of the tops.
    fn linearise(&mut self, equations: &Equations<'_>, contacts: &Contacts, matrix: &mut Matrix) {
        let (size, unknowns) = (equations.modes(), contacts.moments.len());
        let count = self.touched.len();
        // By rows: those of the residual for every cell, and by columns: the displacement of every cell with every component of a step.
        let mut acting = Matrix::zeros(unknowns, count);
        let mut sinking = Matrix::zeros(count, unknowns);
        let mut load = equations.rule.workspace();
        let mut reduced = vec![0.0; size];
        for (k, cell) in self.touched.iter().enumerate() {
            let one = std::iter::once((self.cells[*cell].centre, 1.0));
            let force = FloorForces::new(equations.layout, one);
            let potential = |at| force.potential(at);
            for (number, (disc, moments)) in (contacts
                .discs
                .iter()
                .zip(contacts.moments.chunks_exact(size)))
            .enumerate()
            {
                equations
                    .rule
                    .fill(potential, (disc.centre, disc.radius), &mut load);
                let place = number * size..(number + 1) * size;
                acting.column_mut(k)[place.clone()].copy_from_slice(&load.value);
                let moved = [0, 1, 2].map(|along| dot(&load.slopes[along], moments));
                let rim = equations.rim(disc.asperity);
                (equations.edge).reduce_scalar(disc, rim, (&load.value, moved), &mut reduced);
                for (column, value) in place.zip(&reduced) {
                    sinking.column_mut(column)[k] = *value;
                }
            }
        }
        let mut row = vec![0.0; unknowns];
        for (column, row) in row.iter_mut().enumerate() {
            let column = sinking.column_mut(column);
            self.solve(column);
            *row = -column.iter().sum::<f64>();
        }
        matrix.add_product(-1.0, &acting, &sinking);
        let mut by_indentation = vec![1.0; count];
        self.solve(&mut by_indentation);
        self.rates = FloorRates {
            residual: acting.times(&by_indentation),
            force: by_indentation.iter().sum(),
            row,
        };
    }
}

impl Equations<'_> {
    /// The pressures on all discs as point forces at the points of the rule.
    fn as_forces(&self, contacts: &Contacts) -> FloorForces {
        let of_disc = |((centre, radius), moments): ((Point, f64), &[f64])| {
            let force = |(point, row): (&Point, &[f64])| {
                let at = [0, 1].map(|k| centre[k] + radius * point[k]);
                (at, dot(row, moments))
            };
            self.rule.rows().map(force).collect::<Vec<_>>()
        };
        FloorForces::new(self.layout, contacts.loaded().flat_map(of_disc))
    }

    /// Solves the floor, if it is part of the equations, under these tops. Returns whether the cells in contact were found.
    pub(crate) fn close_floor(&mut self, contacts: &Contacts) -> bool {
        let Some(mut ground) = self.ground.take() else {
            return true;
        };
        let is_closed = ground.close(self, contacts);
        self.floor = FloorForces::new(self.layout, ground.point_forces());
        self.ground = Some(ground);
        is_closed
    }

    /// Adds the changes of the forces on the floor to the derivatives of the residual.
    pub(super) fn linearise_floor(&mut self, contacts: &Contacts, matrix: &mut Matrix) {
        if let Some(mut ground) = self.ground.take() {
            ground.linearise(self, contacts, matrix);
            self.ground = Some(ground);
        }
    }

    /// Derivatives of the force on the floor, if it is part of the equations.
    pub(crate) fn floor_rates(&self) -> Option<&FloorRates> {
        self.ground.as_ref().map(|ground| &ground.rates)
    }

    /// Force on the floor, if it is part of the equations.
    pub(crate) fn force_on_floor(&self) -> f64 {
        self.ground.as_ref().map_or(0.0, LoadedFloor::force)
    }
}

impl FloorForces {
    /// Their displacement at a point, with its derivatives.
    fn potential(&self, at: Point) -> Jet {
        let mut jet = Jet {
            value: 0.0,
            slope: [0.0; 2],
            bend: [0.0; 3],
        };
        self.subtract(at, &mut jet);
        Jet {
            value: -jet.value,
            slope: jet.slope.map(|x| -x),
            bend: jet.bend.map(|x| -x),
        }
    }
}

impl Layout {
    /// Largest height to which the surface is lifted beside these contacts: that of the edge of one of them, where it is highest.
    pub(super) fn lifted_edges(&self, contacts: &Contacts) -> f64 {
        let discs = contacts.discs.iter().zip(contacts.loaded());
        let edges = discs.map(|(disc, (_, moments))| {
            let middle = self.overlap(disc.asperity, disc.centre).value + contacts.indentation;
            let curvature = self.summits[disc.asperity].curvature;
            let column = self.asperities[disc.asperity].column_compliance;
            let shortened = column * UNIT_FORCE * moments[0].abs();
            0.5 * curvature * disc.radius * disc.radius + shortened - middle
        });
        edges.fold(0.0, f64::max)
    }
}
