//! Rounded tops with adhesion and the floor between them in contact at the same time.
//!
//! The floor carries pressures only, unless it is adhesive too, and is [part of the equations](super::loaded_floor) of the tops. The contact depends on the path: it is
//! [followed](super::follow) from first touch on a grid of cells, with all jumps of the tops. During a jump of a top the lens may reach the
//! floor or leave it: the state after the jump is the equilibrium of both. On an adhesive floor [fronts move](super::moving_fronts) after every step.
//!
//! The cells are those that the lens would penetrate at the largest indentation if the tops alone carried load, on their path without the floor.
//! Tops that jump may differ from these. A margin of cells is added until the lens penetrates no other cell in the solution.
//!
//! # Error estimate
//!
//! The contact with the same tops is solved on grids with twice and half the size of the cells. If another top overlaps with the lens on the
//! finest grid, it jumps into contact there. Errors are estimated as those without adhesion. The fronts of an adhesive floor move on all grids from
//! where they are on the first one; a larger work of adhesion gives the error that is due to the laws of the fronts.

use super::answer::{Bench, degree, with_modes};
use super::equations::Equations;
use super::follow::{Here, Path, Stop};
use super::loaded_floor::LoadedFloor;
use super::mixed::{GROWTHS, Ground, Level, MARGIN, MISSED, Mesh, Pressed, Rates, Solved};
use super::newton::{Aim, Settled};
use super::transition::bodies;
use crate::halfspace::disc::basis::{UNIT_FORCE, mode_count};
use crate::numerics::convergence::larger;
use crate::numerics::neighbours::Neighbours;
use crate::numerics::vector::dot;
use crate::problem::load::Prescribed;
use crate::solve::patches::Patches;
use crate::state::discs::Contacts;
use crate::state::{AsperityContact, Branch, Run, SolveError, Termination};
use crate::theory::adhesion::edge_rise;

/// Penetrated cells of the grid on which the path is followed, as a part of the number without adhesion.
const PART: f64 = 1.0 / 8.0;

/// Sizes of cells for both branches of a cycle, in units of the size of those for the loading.
const OF_CYCLE: [f64; 2] = [1.4, 2.1];

/// The same if the floor is adhesive: on large cells its fronts stay where they are.
const OF_ADHESIVE_CYCLE: [f64; 2] = [0.6, 0.9];

/// Error of the energy release rate at fronts on the floor: their stress intensity factor is accurate to 3.5 %.
const WORK_ERROR: f64 = 0.07;

/// Unit of steps while all contacts fill their tops, as a part of the whole path: the state at the end does not depend on their length.
const EXTENT: f64 = 0.4;

/// Largest number of times that the bound of the indentation is enlarged.
const ENLARGED: usize = 8;

/// The cells that the lens penetrates at an indentation, with a side, if these contacts alone carry load.
pub(super) struct FloorGrid {
    alone: Contacts,
    pub(super) bound: f64,
    side: f64,
}

impl FloorGrid {
    /// The same with cells that are larger by a factor.
    fn with_cells(&self, factor: f64) -> (&Contacts, f64, f64) {
        (&self.alone, self.bound, factor * self.side)
    }
}

/// A state on a grid.
pub(super) struct OnGrid<'a> {
    equations: Equations<'a>,
    mesh: Mesh<'a>,
    contacts: Contacts,
    termination: Termination,
    steps: usize,
    rates: Option<Rates>,
}

impl OnGrid<'_> {
    /// Whether no cell of the floor is in contact.
    fn is_off_floor(&self) -> bool {
        let floor = self.equations.ground.as_ref();
        floor.is_none_or(|floor| floor.touched().len() == 0)
    }
}

impl<'a> Ground<'a> {
    /// The contact with tops and floor on loading, with its derivatives. `alone` are the contacts with the tops alone under this load, or those at
    /// a lower indentation. `None` if the floor carries no load.
    pub(super) fn follow(
        &mut self,
        target: Prescribed,
        alone: &Contacts,
    ) -> Result<Option<(Solved<'a>, Option<Rates>)>, SolveError> {
        let Some((grid, middle)) = self.grid(target, alone)? else {
            return Ok(None);
        };
        self.check(&middle)?;
        if middle.termination != Termination::Converged {
            let levels = vec![self.level(&middle)];
            let solved = Solved {
                levels,
                of_degree: None,
                of_works: None,
                equations: middle.equations,
                mesh: middle.mesh,
            };
            return Ok(Some((solved, None)));
        }
        let same =
            |part: f64, works: f64| self.same_tops(target, (grid.with_cells(part), works), &middle);
        let (Some(coarse), Some(fine)) = (same(2.0, 1.0)?, same(0.5, 1.0)?) else {
            return Ok(None);
        };
        if fine.is_off_floor() && fine.termination == Termination::Converged {
            return Ok(None);
        }
        let of_works = match self.bench.floor_works {
            Some(_) => same(1.0, 1.0 + WORK_ERROR)?,
            None => None,
        };
        let mut others = std::iter::once(&coarse).chain(&of_works);
        let is_solved = others.all(|other| other.termination == Termination::Converged);
        // Without one of them there is no error estimate.
        let of_degree = match is_solved {
            true => self.with_higher_degree(&middle)?,
            false => None,
        };
        let levels = [&coarse, &middle, &fine].map(|found| self.level(found));
        let rates = fine.rates;
        let solved = Solved {
            levels: levels.into(),
            of_degree,
            of_works: of_works.map(|found| self.level(&found).pressed),
            equations: fine.equations,
            mesh: fine.mesh,
        };
        Ok(Some((solved, rates)))
    }

    /// The grid on which the path is followed, with the state at its end.
    pub(super) fn grid(
        &mut self,
        target: Prescribed,
        alone: &Contacts,
    ) -> Result<Option<(FloorGrid, OnGrid<'a>)>, SolveError> {
        let first = self.first_touch();
        let mut bound = match target {
            Prescribed::Indentation(indentation) => indentation,
            Prescribed::Force(_) => alone.indentation,
        };
        let mut alone = alone.clone();
        let (mut growths, mut enlarged) = (0, 0);
        if let Some(works) = self.bench.floor_works {
            let depth = larger(bound - self.depth, 0.0);
            let rise = edge_rise(works.receding, self.lens.apex_radius(), depth);
            self.margin = larger(self.margin, rise);
        }
        loop {
            if alone.indentation < bound {
                alone = self.alone_at(bound)?;
            }
            let side = self.side_for(&alone, bound, PART)?;
            let Some(found) = self.path(target, (&alone, bound, side))? else {
                return Ok(None);
            };
            if found.contacts.indentation > bound && enlarged < ENLARGED {
                bound += larger(bound - first, self.depth);
                enlarged += 1;
                continue;
            }
            if found.termination == Termination::Converged {
                let missed = self.missed(&found.equations, &found.mesh.cells, &found.contacts);
                if (missed > MISSED || self.is_at_border(&found)) && growths < GROWTHS {
                    self.margin = larger(2.0 * self.margin, MARGIN * missed * self.depth);
                    growths += 1;
                    continue;
                }
            }
            let grid = FloorGrid { alone, bound, side };
            return Ok(Some((grid, found)));
        }
    }

    /// The contacts with the tops alone at an indentation, or where their path ends before.
    fn alone_at(&self, indentation: f64) -> Result<Contacts, SolveError> {
        let mut equations = self.equations();
        let mut path = Path::new(&mut equations, None, self.run)?;
        // A path without floor may end where that with the floor does not.
        let _ = path.follow(Branch::Loading, Stop::Indentation(indentation));
        self.run.check_cancelled()?;
        let mut contacts = path.here.settled.contacts;
        contacts.indentation = indentation;
        Ok(contacts)
    }

    /// The floor on cells of a side as part of equations; with adhesion, its works are multiplied by a factor. `None` without cells.
    fn on_grid(
        &self,
        mut equations: Equations<'a>,
        (alone, bound, side): (&Contacts, f64, f64),
        works: f64,
    ) -> Result<Option<(Equations<'a>, Mesh<'a>)>, SolveError> {
        let Some(mesh) = self.mesh(alone, bound, side)? else {
            return Ok(None);
        };
        let (count, limit) = (mesh.cells.len(), self.run.memory_limit());
        let bytes = LoadedFloor::memory(count);
        if bytes > limit {
            let length = self.bench.units.length;
            return Err(SolveError::TooManyCells {
                cells: count,
                bytes,
                limit,
                cell: side * length,
                suggested_cell: side * length * (bytes as f64 / limit as f64).powf(0.25),
            });
        }
        equations.ground = self.loaded(&mesh, works);
        Ok(Some((equations, mesh)))
    }

    /// The equations on a grid and on one with larger cells, for paths up to an indentation or a force.
    fn two_grids(
        &mut self,
        target: Prescribed,
        alone: &Contacts,
    ) -> Result<Option<[(Equations<'a>, f64); 2]>, SolveError> {
        let Some((grid, _)) = self.grid(target, alone)? else {
            return Ok(None);
        };
        let on = |factor: f64| self.on_grid(self.equations(), grid.with_cells(factor), 1.0);
        let [fine, coarse] = match self.bench.floor_works {
            Some(_) => OF_ADHESIVE_CYCLE,
            None => OF_CYCLE,
        };
        let (Some((fine, _)), Some((coarse, _))) = (on(fine)?, on(coarse)?) else {
            return Ok(None);
        };
        Ok(Some(
            [fine, coarse].map(|equations| (equations, grid.bound)),
        ))
    }

    /// The floor on cells; with adhesion, its works are multiplied by a factor.
    fn loaded(&self, mesh: &Mesh<'_>, works: f64) -> Option<LoadedFloor> {
        let Mesh {
            cells, separation, ..
        } = mesh;
        let floor = LoadedFloor::new(cells, separation, self.depth, &self.bench.layers)?;
        Some(match self.bench.floor_works {
            Some(of) => {
                let pillars = bodies(self.bench, self.depth);
                floor.with_adhesion(of.times(works), cells, &pillars)
            }
            None => floor,
        })
    }

    /// Whether an adhesive floor is in contact beside floor that is not among the cells.
    fn is_at_border(&self, found: &OnGrid<'_>) -> bool {
        let (cells, bonded) = (&found.mesh.cells, &found.contacts.bonded);
        let grid = cells.grid();
        let columns = grid.columns();
        let mut is_in = vec![false; grid.cell_count()];
        let indices: Vec<usize> = cells.indices().collect();
        indices.iter().for_each(|index| is_in[*index] = true);
        bonded.iter().any(|cell| {
            let index = indices[*cell];
            // None of the cells are at the border of the grid.
            [index - 1, index + 1, index - columns, index + columns]
                .into_iter()
                .any(|at| {
                    let centre = grid.centre(at % columns, at / columns);
                    !is_in[at] && self.is_free(centre, grid.cell()[0])
                })
        })
    }

    /// The path on a grid.
    fn path(
        &self,
        target: Prescribed,
        grid: (&Contacts, f64, f64),
    ) -> Result<Option<OnGrid<'a>>, SolveError> {
        let Some((mut equations, mesh)) = self.on_grid(self.equations(), grid, 1.0)? else {
            return Ok(None);
        };
        let mut path = Path::new(&mut equations, Some(grid.1), self.run)?;
        path.extent = EXTENT * (grid.1 - self.first_touch());
        let ended = path.follow(Branch::Loading, target.into()).err();
        let here = path.here;
        let termination = match ended {
            None => Termination::Converged,
            Some(ended) => (self.bench).ended(ended, &here.settled.contacts, here.force)?,
        };
        equations.close_floor(&here.settled.contacts);
        Ok(Some(OnGrid {
            contacts: here.settled.contacts.clone(),
            steps: here.settled.steps,
            rates: None,
            termination,
            equations,
            mesh,
        }))
    }

    /// The contact with the same tops on another grid, and with those that overlap with the lens on it.
    fn same_tops(
        &self,
        target: Prescribed,
        (grid, works): ((&Contacts, f64, f64), f64),
        known: &OnGrid<'_>,
    ) -> Result<Option<OnGrid<'a>>, SolveError> {
        let Some((mut equations, mesh)) = self.on_grid(self.equations(), grid, works)? else {
            return Ok(None);
        };
        let mut is_bonded = vec![0.0; known.mesh.cells.len()];
        for cell in &*known.contacts.bonded {
            is_bonded[*cell] = 1.0;
        }
        let is_bonded = mesh.values_of(&known.mesh.cells, &is_bonded);
        let bonded = (0..is_bonded.len()).filter(|cell| is_bonded[*cell] > 0.0);
        let contacts = &Contacts {
            bonded: bonded.collect(),
            ..known.contacts.clone()
        };
        let aim = Aim::Load(target);
        let settled = equations.settle_same(contacts.clone(), aim, self.run)?;
        let mut termination = Termination::Converged;
        let (here, steps) = match settled {
            Ok(settled) => {
                let steps = settled.steps;
                let here = equations.state(settled);
                let mut path = Path::from(&mut equations, here, self.run)?;
                if path.until_rest(Some(aim)).is_err() {
                    termination = Termination::Stagnated;
                }
                (path.here, steps)
            }
            Err(_) => {
                termination = Termination::Stagnated;
                equations.close_floor(contacts);
                let settled = Settled {
                    contacts: contacts.clone(),
                    factors: None,
                    steps: 0,
                };
                (equations.state(settled), 0)
            }
        };
        let is_solved = termination == Termination::Converged;
        let rates = is_solved.then(|| rates(&equations, &here));
        Ok(Some(OnGrid {
            contacts: here.settled.contacts,
            termination,
            steps,
            rates,
            equations,
            mesh,
        }))
    }

    /// The same contact with a pressure of higher degree on the tops.
    fn with_higher_degree(&self, middle: &OnGrid<'_>) -> Result<Option<Pressed>, SolveError> {
        let low = degree(self.accuracy);
        let mut fine = Equations::new(&self.bench.layout, low + 2);
        fine.ground = self.loaded(&middle.mesh, 1.0);
        let start = with_modes(&middle.contacts, mode_count(low), fine.modes());
        // The differences of all results are those at the same indentation.
        let aim = Aim::Load(Prescribed::Indentation(middle.contacts.indentation));
        let settled = fine.settle_same(start, aim, self.run)?.ok();
        Ok(settled.map(|settled| pressed(&fine, settled.contacts, &middle.mesh)))
    }

    fn level(&self, found: &OnGrid<'_>) -> Level {
        let pressed = Pressed {
            termination: found.termination,
            steps: found.steps,
            ..pressed(&found.equations, found.contacts.clone(), &found.mesh)
        };
        let loaded = pressed.pressure.iter().map(|pressure| *pressure != 0.0);
        Level {
            indentation: found.contacts.indentation,
            patches: Patches::of(&found.mesh.cells, loaded, &self.pillars),
            cell: found.mesh.cells.grid().cell_area(),
            pressed,
        }
    }

    /// Refuses contacts that reach too far.
    fn check(&self, found: &OnGrid<'a>) -> Result<(), SolveError> {
        let mut equations = self.equations();
        equations.floor = found.equations.floor.clone();
        self.bench.check(&mut equations, &found.contacts)?;
        let radius = self.level(found).patches.radius;
        if radius > self.lens.largest_contact() {
            let length = self.bench.units.length;
            return Err(SolveError::beyond(self.lens, radius, length));
        }
        Ok(())
    }
}

impl Bench {
    /// The equations of tops and floor, at this depth (m), on two grids, for a cycle whose end of loading on the tops alone is known; with the
    /// largest indentation on the grid. `None` if the lens penetrates no cell.
    pub(super) fn grids<'a>(
        &'a self,
        target: Prescribed,
        alone: &AsperityContact,
        depth: f64,
        run: &'a Run<'a>,
    ) -> Result<Option<[(Equations<'a>, f64); 2]>, SolveError> {
        let Some(lens) = &self.layout.shape.0 else {
            return Ok(None);
        };
        let depth = depth / self.units.length;
        let pillars = Neighbours::new(bodies(self, depth).into_iter());
        let mut ground = Ground::new(self, lens, pillars, (depth, alone.accuracy), run);
        ground.two_grids(target, &alone.contacts)
    }
}

/// Tops and floor of a solution.
fn pressed(equations: &Equations<'_>, contacts: Contacts, mesh: &Mesh<'_>) -> Pressed {
    let area = mesh.cells.grid().cell_area();
    let (forces, sunk) = equations
        .ground
        .as_ref()
        .map_or((&[][..], &[][..]), |ground| {
            (ground.forces(), ground.sunk())
        });
    Pressed {
        pressure: forces.iter().map(|force| force / area).collect(),
        sunk: sunk.to_vec(),
        force_on_tops: equations.force_on_tops(&contacts),
        force_on_floor: equations.force_on_floor(),
        contacts,
        energy_bound: 0.0,
        termination: Termination::Converged,
        steps: 0,
    }
}

/// Derivatives of a solution with respect to the indentation.
fn rates(equations: &Equations<'_>, here: &Here) -> Rates {
    let (contacts, lowering) = (&here.settled.contacts, &here.rates.lowering);
    if lowering.is_empty() {
        let floor = equations.floor_rates();
        return Rates {
            force: floor.map_or(0.0, |floor| floor.force),
            force_on_floor: floor.map_or(0.0, |floor| floor.force),
            area: 0.0,
            forces: vec![0.0; equations.layout.asperities.len()],
        };
    }
    let [_, area] = equations.rows_of_totals(contacts);
    let size = equations.modes();
    let mut forces = vec![0.0; equations.layout.asperities.len()];
    let mut row = vec![0.0; size];
    for (disc, step) in contacts.discs.iter().zip(lowering.chunks_exact(size)) {
        equations.edge.reduce_row(disc, UNIT_FORCE, 0.0, &mut row);
        forces[disc.asperity] = dot(&row, step);
    }
    Rates {
        force: here.rates.stiffness,
        force_on_floor: here.rates.stiffness - forces.iter().sum::<f64>(),
        area: dot(&area, lowering),
        forces,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{
        Accuracy, Adhesion, Asperity, AsperityArray, LensShape, Material, ShapedLens,
    };

    /// The force is the derivative of the energy, and the stiffness that of the force, on one grid: the contacts end within the tops, where
    /// the energy is stationary with respect to their radii. Steps are so small that no cell comes into contact.
    #[test]
    fn the_force_is_the_derivative_of_the_energy() {
        let run = Run::default();
        let rubber = Material::new(1.0, 0.0);
        let shape = LensShape::Paraboloid { radius: 1e-3 };
        let lens = ShapedLens::new(shape, Material::new(1e300, 0.0));
        let top = |at: [f64; 2]| Asperity {
            rim_radius: Some(18e-6),
            ..Asperity::new(at, 1e-4)
        };
        let tops = vec![top([16e-6, 0.0]), top([-24e-6, 4e-6])];
        let array = AsperityArray::new(lens.into(), rubber, tops).expect("an array");
        let array = array.with_adhesion(Adhesion::new(1e-9)).expect("a work");
        let bench = Bench::new(&array);
        let lens = bench.layout.shape.0.as_ref().expect("a lens");
        let depth = 0.01;
        let pillars = Neighbours::new(bodies(&bench, depth).into_iter());
        let ground = Ground::new(&bench, lens, pillars, (depth, Accuracy::Default), &run);
        let indentation = 0.022;
        let alone = ground.alone_at(indentation).expect("contacts");
        let grid = (&alone, 1.01 * indentation, 0.02);
        let target = Prescribed::Indentation(indentation);
        let mut found = ground.path(target, grid).expect("a path").expect("cells");
        assert_eq!(found.termination, Termination::Converged);
        let step = 1e-6;
        let rule = found.equations.rule.clone();
        let mut at = |indentation: f64| {
            let aim = Aim::Load(Prescribed::Indentation(indentation));
            let start = found.contacts.clone();
            let settled = found.equations.settle_same(start, aim, &run);
            let Ok(here) = settled.expect("no interruption") else {
                panic!("no state");
            };
            let here = found.equations.state(here);
            let energy = found.equations.energy(&here.settled.contacts, &rule);
            let share = found.equations.force_on_floor() / here.force;
            [energy, here.force, here.rates.stiffness, share]
        };
        let [low, middle, high] = [-step, 0.0, step].map(|by| at(indentation + by));
        let slope = |k: usize| (high[k] - low[k]) / (2.0 * step);
        let of_energy = slope(0) / middle[1] - 1.0;
        let of_force = slope(1) / middle[2] - 1.0;
        println!("{of_energy:e} {of_force:e}, share {}", middle[3]);
        assert!(middle[3] > 0.1 && middle[3] < 0.9);
        assert!(of_energy.abs() < 1e-4, "{of_energy:e}");
        assert!(of_force.abs() < 1e-6, "{of_force:e}");
    }
}
