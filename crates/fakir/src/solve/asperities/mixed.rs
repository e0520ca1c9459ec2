//! Rounded tops and the floor between them in contact at the same time.
//!
//! The pressures on the floor are constant on square cells outside the pillars, those on the tops are discs as before. The two act on each
//! other through the half-space. At a fixed indentation both minimise one convex energy; they are solved in turn: the floor with the
//! displacement due to the tops as a gap, by conjugate gradients with bounds ([`solver`]), and the tops with the displacement due to the
//! floor, by [Newton's method](super::newton). The displacement of the floor by the tops is the fixed point of this sequence, which is
//! accelerated with the method of D. G. Anderson (J. ACM 12, 547 (1965)). A prescribed force is reached by secants.
//!
//! A cell acts on the tops as a point force at its centre, where the displacement due to the tops is evaluated: the interaction is symmetric,
//! so that the force is the derivative of the energy.
//!
//! Floor that the lens penetrates if only the tops carry load contains the contact: pressures elsewhere only lower the surface, so that the
//! solution with more obstacles is nowhere above that with fewer. These are the cells of a grid.
//!
//! Beside a pressure the surface of a layer may rise. On layers the cells are those that the lens would penetrate within a margin, which grows until
//! the lens penetrates no other cell in the solution on the two coarse grids.
//!
//! # Error estimate
//!
//! The contact is solved on three grids, the last with half the cell size of the one before. The larger of the last difference and of the one
//! before, in proportion to the cell size, and the difference of a pressure on the tops of higher degree on the second grid, estimate the error.

use super::answer::{Bench, DEGREES, degree, with_modes};
use super::climb::Found;
use super::equations::Equations;
use super::load::FloorForces;
use super::newton::Settled;
use super::transition::{bodies, loaded_tops};
use crate::halfspace::disc::basis::{UNIT_FORCE, mode_count};
use crate::halfspace::disc::exterior::Exterior;
use crate::halfspace::elements::half_space::HalfSpace;
use crate::halfspace::elements::{FreeSpaceConvolution, Preconditioned};
use crate::numerics::convergence::{larger, largest, smaller};
use crate::numerics::dense::{Lu, Matrix};
use crate::numerics::neighbours::{Nearest, Neighbours};
use crate::numerics::vector::{add_scaled, dot};
use crate::problem::layer::WeightedLayer;
use crate::problem::load::Prescribed;
use crate::problem::{Accuracy, Boundary, Cells, Grid, Point, ShapedLens};
use crate::solve::elements::solver::{self, Settings};
use crate::solve::floor::FloorDisplacement;
use crate::solve::patches::Patches;
use crate::state::asperity_contact::{
    AsperityContact, AsperityErrors, AsperityFloorGap, AsperitySlopes,
};
use crate::state::discs::Contacts;
use crate::state::{FloorContact, FloorErrors, Progress, Run, SolveError, Stage, Termination};
use std::f64::consts::PI;

/// Number of cells that the lens penetrates on the finest grid, in all and per pillar among them, and largest number of cells of the disc
/// that encloses them.
const CELLS: [f64; 2] = [3000.0, 9000.0];
const CELLS_PER_PILLAR: f64 = 60.0;
const MOST_POINTS: [f64; 2] = [1.0e5, 4.0e5];

/// Number of cells across that disc on the first grid, on which the penetrated part is found, and the smallest number of penetrated cells.
const FIRST_ACROSS: f64 = 80.0;
const FEWEST: usize = 24;

/// Smallest ratio of the cell sizes of the first two grids.
const REFINED: f64 = 1.5;

/// Part of the distance past the floor by which the indentation may exceed that of the coarser grid.
const BEYOND: f64 = 0.05;

/// Penetration, relative to the depth of the floor, up to which cells above the lens are included: far above rounding.
const NEAR: f64 = 1e-6;

/// First margin on layers in units of the largest penetration that is missed, largest number of times that it grows, and penetration, relative to the
/// depth of the floor, that is neglected.
pub(super) const MARGIN: f64 = 2.0;
pub(super) const GROWTHS: usize = 8;
pub(super) const MISSED: f64 = 1e-5;

/// Distances, in thicknesses of the thinnest layer, at which the largest rise of the surface beside a force is searched: the first, the ratio of
/// successive ones, and their number. At smaller distances the surface sinks.
const RISES: (f64, f64, usize) = (0.3, 1.1, 60);

/// Bound of the energy error of the floor, relative to its energy.
const FLOOR_TOLERANCE: f64 = 1e-12;

/// Change of the displacement of the floor by the tops at which the alternation ends, relative to the depth of the floor, and largest number
/// of turns.
const SUNK_TOLERANCE: f64 = 1e-8;
const TURNS: usize = 100;

/// Number of turns from which the next one is extrapolated.
const REMEMBERED: usize = 6;

/// Part of the diagonal that is added to the equations of an extrapolation.
const RIDGE: f64 = 1e-14;

/// Relative difference from a prescribed force, and largest number of secants.
const FORCE_TOLERANCE: f64 = 1e-8;
const SECANTS: usize = 30;

/// Step of the differences for derivatives, relative to the indentation past first contact.
const SLOPE_STEP: f64 = 1e-3;

/// Factor on the difference of two grids: forces converge about in proportion to the square of the cell size, irregularly at the edges of
/// contacts.
const SAFETY: f64 = 1.5;

/// Memory of a solution per cell, besides the operator, bytes.
const BYTES_PER_CELL: usize = 300;

/// The floor among tops. Lengths are in units of the contacts.
pub(super) struct Ground<'a> {
    pub(super) bench: &'a Bench,
    pub(super) lens: &'a ShapedLens,
    pub(super) pillars: Neighbours,
    pub(super) depth: f64,
    pub(super) accuracy: Accuracy,
    pub(super) run: &'a Run<'a>,
    /// Largest rise of the surface beside a unit force, on layers.
    rise: f64,
    /// Penetration up to which cells above the lens are included, on layers and with adhesion.
    pub(super) margin: f64,
}

/// The cells of a grid that the lens penetrates if the tops alone carry load.
pub(super) struct Mesh<'a> {
    pub(super) cells: Cells,
    /// Depth of the floor below the undeformed lens at zero indentation.
    pub(super) separation: Vec<f64>,
    operator: Preconditioned<'a, HalfSpace<'a>, f32>,
    /// Largest indentation for which these cells contain the contact.
    bound: f64,
}

impl Mesh<'_> {
    /// The values of other cells at the centres of these; zero outside of them.
    pub(super) fn values_of(&self, cells: &Cells, values: &[f64]) -> Vec<f64> {
        let grid = cells.grid();
        let mut whole = vec![0.0; grid.cell_count()];
        cells.scatter(values, &mut whole);
        let value = |at: Point| {
            let place = [0, 1].map(|k| (at[k] - grid.origin()[k]) / grid.cell()[k]);
            let [column, row] = place.map(|x| x.max(0.0) as usize);
            let is_in = column < grid.columns() && row < grid.rows();
            if is_in {
                whole[row * grid.columns() + column]
            } else {
                0.0
            }
        };
        self.cells.centres().map(value).collect()
    }
}

/// Pressures on tops and floor.
#[derive(Clone)]
pub(super) struct Pressed {
    pub(super) contacts: Contacts,
    /// Pressure on every cell.
    pub(super) pressure: Vec<f64>,
    /// Displacement of every cell by the tops.
    pub(super) sunk: Vec<f64>,
    pub(super) force_on_tops: f64,
    pub(super) force_on_floor: f64,
    /// Duality gap of the floor.
    pub(super) energy_bound: f64,
    pub(super) termination: Termination,
    pub(super) steps: usize,
}

impl Pressed {
    fn force(&self) -> f64 {
        self.force_on_tops + self.force_on_floor
    }

    /// Area of the contacts with the tops.
    fn area(&self) -> f64 {
        let discs = self.contacts.discs.iter();
        PI * discs.map(|disc| disc.radius * disc.radius).sum::<f64>()
    }

    /// Mean displacement of the floor by the tops, weighted with the pressure.
    fn mean_sunk(&self) -> f64 {
        let weights: Vec<f64> = self.pressure.iter().map(|it| it.abs()).collect();
        dot(&weights, &self.sunk) / weights.iter().sum::<f64>()
    }

    /// Fraction of the force on the floor; where the tops pull more than the floor carries, of the sum of both without sign.
    fn share(&self) -> f64 {
        let force = self.force();
        match force > 0.0 {
            true => self.force_on_floor / force,
            false => self.force_on_floor / (self.force_on_floor + self.force_on_tops.abs()),
        }
    }
}

/// The sequence of displacements and of their changes in a turn, extrapolated to the fixed point.
#[derive(Default)]
struct Extrapolation {
    past: Vec<[Vec<f64>; 2]>,
}

impl Extrapolation {
    /// The next displacement, from the last one and its change.
    fn next(&mut self, at: &[f64], change: Vec<f64>) -> Vec<f64> {
        let mut next: Vec<f64> = at.iter().zip(&change).map(|(x, r)| x + r).collect();
        let count = self.past.len();
        let differences: Vec<[Vec<f64>; 2]> = (self.past.iter())
            .map(|[x, r]| {
                let minus = |a: &[f64], b: &[f64]| -> Vec<f64> {
                    a.iter().zip(b).map(|(a, b)| a - b).collect()
                };
                [minus(at, x), minus(&change, r)]
            })
            .collect();
        if count > 0 {
            let gram = Matrix::from_fn(count, count, |i, j| {
                let product = dot(&differences[i][1], &differences[j][1]);
                let ridge = if i == j { 1.0 + RIDGE } else { 1.0 };
                product * ridge
            });
            let mut parts: Vec<f64> = (differences.iter()).map(|[_, r]| dot(r, &change)).collect();
            Lu::new(gram).solve(&mut parts);
            if parts.iter().all(|part| part.is_finite()) {
                for ([x, r], part) in differences.iter().zip(&parts) {
                    add_scaled(&mut next, -part, x);
                    add_scaled(&mut next, -part, r);
                }
            }
        }
        self.past.push([at.to_vec(), change]);
        if self.past.len() > REMEMBERED {
            self.past.remove(0);
        }
        next
    }
}

impl<'a> Ground<'a> {
    pub(super) fn new(
        bench: &'a Bench,
        lens: &'a ShapedLens,
        pillars: Neighbours,
        (depth, accuracy): (f64, Accuracy),
        run: &'a Run<'a>,
    ) -> Self {
        Self {
            bench,
            lens,
            pillars,
            depth,
            accuracy,
            run,
            rise: bench.rise(),
            margin: 0.0,
        }
    }

    fn index(&self) -> usize {
        usize::from(self.accuracy == Accuracy::Accurate)
    }

    pub(super) fn equations(&self) -> Equations<'a> {
        Equations::new(&self.bench.layout, degree(self.accuracy))
    }

    /// The contacts if the floor carries no load. If there is no solution, those at a lower indentation: they lower the floor less, so that
    /// the lens penetrates all of its part that it would otherwise.
    fn tops_alone(&self, indentation: f64, near: &Contacts) -> Result<Contacts, SolveError> {
        let target = Prescribed::Indentation(indentation);
        let found = self.equations().find(target, Some(near), self.run)?;
        Ok(match found {
            Found::Settled(settled) => settled.contacts,
            Found::Merging(_, contacts) | Found::Lost(_, contacts) => contacts,
        })
    }

    /// Indentation of the first contact with a top or the floor.
    pub(super) fn first_touch(&self) -> f64 {
        self.bench.layout.first_touch().min(self.depth)
    }

    /// Height up to which the tops may lift the floor.
    fn lifted(&self, contacts: &Contacts) -> f64 {
        let forces = contacts.loaded().map(|(_, moments)| moments[0].abs());
        let by_layers = self.rise * UNIT_FORCE * forces.sum::<f64>();
        match self.is_adhesive() {
            true => by_layers + self.bench.layout.lifted_edges(contacts),
            false => by_layers,
        }
    }

    pub(super) fn is_adhesive(&self) -> bool {
        self.bench.layout.grip > 0.0
    }

    /// Radius beyond which the undeformed lens is above the floor, by more than the tops may lift it.
    fn reach(&self, contacts: &Contacts, indentation: f64) -> f64 {
        let rise = indentation - self.depth + self.lifted(contacts) + self.margin;
        let reach = self.lens.distance_of_rise(rise);
        reach.unwrap_or(self.lens.widest())
    }

    /// Whether there is no pillar at the centre of a cell with this side; nor within half the side with an adhesive floor, whose fronts come close to
    /// pillars, where a force at the edge of a contact would act on it as on no other.
    pub(super) fn is_free(&self, at: Point, side: f64) -> bool {
        let least = self.bench.floor_works.map_or(0.0, |_| 0.5 * side);
        let nearest = (self.pillars).nearest(at, Nearest::Edge, 0.0, None);
        nearest.is_none_or(|(_, distance)| distance > least)
    }

    /// The largest penetration of floor outside of the cells, relative to the depth of the floor.
    pub(super) fn missed(
        &self,
        equations: &Equations<'_>,
        cells: &Cells,
        contacts: &Contacts,
    ) -> f64 {
        let exterior = Exterior::new(equations.degree());
        let tops = loaded_tops(self.bench, contacts, &exterior, 1.0, self.run);
        let grid = cells.grid();
        let mut is_in = vec![false; grid.cell_count()];
        cells.indices().for_each(|index| is_in[index] = true);
        let across = grid.columns();
        let penetration = |_: &mut (), index: usize| {
            let at = grid.centre(index % across, index / across);
            let above = self.depth + self.lens.sag_with_brim(at) - contacts.indentation;
            if is_in[index] || !self.is_free(at, grid.cell()[0]) {
                return 0.0;
            }
            -(above + tops.value(at)[1] + equations.floor.displacement(at))
        };
        let workers = self.run.workers();
        let all = workers.map(grid.cell_count(), 64, || (), penetration);
        all.into_iter().fold(0.0, larger) / self.depth
    }

    /// Cells with a side that are penetrated at an indentation by a lens on these contacts.
    fn penetrated(
        &self,
        contacts: &Contacts,
        indentation: f64,
        side: f64,
    ) -> Result<Cells, SolveError> {
        let reach = self.reach(contacts, indentation);
        // None of the cells are at the border.
        let across = 2 * ((reach / side).ceil() as usize + 1);
        let grid = Grid::centred(across, across, side);
        let grid = grid.map_err(|_| SolveError::NotFinite {
            what: "cell of the floor",
        })?;
        let exterior = Exterior::new(degree(self.accuracy));
        let tops = loaded_tops(self.bench, contacts, &exterior, 1.0, self.run);
        let near = NEAR * self.depth + self.margin;
        let lifted = self.lifted(contacts);
        let is_penetrated = |_: &mut (), index: usize| {
            let [x, y] = grid.centre(index % across, index / across);
            let above = self.depth + self.lens.sag_with_brim([x, y]) - indentation;
            if x.hypot(y) >= reach || above > near + lifted {
                return false;
            }
            self.is_free([x, y], side) && above + tops.value([x, y])[1] <= near
        };
        let workers = self.run.workers();
        let is_in = workers.map(grid.cell_count(), 256, || (), is_penetrated);
        self.run.check_cancelled()?;
        Ok(Cells::where_true(&grid, |index| is_in[index]))
    }

    /// Side of cells of which the lens penetrates this part of the final number.
    pub(super) fn side_for(
        &self,
        contacts: &Contacts,
        indentation: f64,
        part: f64,
    ) -> Result<f64, SolveError> {
        let reach = self.reach(contacts, indentation);
        let most = MOST_POINTS[self.index()];
        let smallest = reach * (PI / most).sqrt();
        let mut side = larger(2.0 * reach / FIRST_ACROSS, smallest);
        let count = loop {
            let count = self.penetrated(contacts, indentation, side)?.len();
            if count >= FEWEST || side <= smallest {
                break count;
            }
            side = larger(0.25 * side, smallest);
        };
        let pillars = self.pillars.within([0.0; 2], reach).len() as f64;
        let wanted = part * larger(CELLS[self.index()], CELLS_PER_PILLAR * pillars);
        Ok(larger(side * (count as f64 / wanted).sqrt(), smallest))
    }

    pub(super) fn mesh(
        &self,
        contacts: &Contacts,
        bound: f64,
        side: f64,
    ) -> Result<Option<Mesh<'a>>, SolveError> {
        let cells = self.penetrated(contacts, bound, side)?;
        if cells.is_empty() {
            return Ok(None);
        }
        let bytes = FreeSpaceConvolution::memory_estimate(&cells, 1) + BYTES_PER_CELL * cells.len();
        let limit = self.run.memory_limit();
        if bytes > limit {
            let length = self.bench.units.length;
            return Err(SolveError::TooManyCells {
                cells: cells.len(),
                bytes,
                limit,
                cell: side * length,
                suggested_cell: side * length * (bytes as f64 / limit as f64).sqrt(),
            });
        }
        let separation = cells
            .centres()
            .map(|at| self.depth + self.lens.sag_with_brim(at));
        let pool = self.run.pool;
        let layers = &self.bench.layers;
        let half_space = HalfSpace::new(Boundary::FreeSpace, cells.clone(), 1.0, layers, pool);
        Ok(Some(Mesh {
            separation: separation.collect(),
            operator: half_space.preconditioned(cells.clone(), pool),
            cells,
            bound,
        }))
    }

    /// The displacement of the cells by the tops.
    fn sunk(&self, equations: &Equations<'_>, mesh: &Mesh<'_>, contacts: &Contacts) -> Vec<f64> {
        let exterior = Exterior::new(equations.degree());
        let tops = loaded_tops(self.bench, contacts, &exterior, 1.0, self.run);
        let centres: Vec<_> = mesh.cells.centres().collect();
        let workers = self.run.workers();
        let value = |(): &mut (), cell: usize| tops.value(centres[cell])[1];
        workers.map(centres.len(), 256, || (), value)
    }

    /// The start on a mesh from contacts and a pressure on another.
    fn start(
        &self,
        equations: &Equations<'_>,
        mesh: &Mesh<'_>,
        contacts: Contacts,
        known: Option<(&Cells, &[f64])>,
    ) -> Pressed {
        let pressure = match known {
            Some((cells, values)) => mesh.values_of(cells, values),
            None => vec![0.0; mesh.cells.len()],
        };
        Pressed {
            sunk: self.sunk(equations, mesh, &contacts),
            force_on_tops: equations.force(&contacts),
            force_on_floor: 0.0,
            contacts,
            pressure,
            energy_bound: 0.0,
            termination: Termination::Converged,
            steps: 0,
        }
    }

    /// Tops and floor at an indentation.
    fn at(
        &self,
        equations: &mut Equations<'_>,
        mesh: &mut Mesh<'_>,
        indentation: f64,
        mut pressed: Pressed,
    ) -> Result<Pressed, SolveError> {
        let settings = Settings {
            tolerance: FLOOR_TOLERANCE,
            ..Settings::default()
        };
        let area = mesh.cells.grid().cell_area();
        let mut extrapolation = Extrapolation::default();
        for _ in 0..TURNS {
            // Relative to the indentation, which may exceed the displacements by the floor by more than their digits allow.
            let gap: Vec<f64> = (mesh.separation.iter())
                .zip(&pressed.sunk)
                .map(|(separation, sunk)| separation - indentation + sunk)
                .collect();
            let floor = solver::solve(
                &mut mesh.operator,
                &gap,
                area,
                Prescribed::Indentation(0.0),
                Some(&pressed.pressure),
                &settings,
                &self.run.cancel,
            );
            self.run.check_cancelled()?;
            pressed.force_on_floor = floor.force;
            pressed.energy_bound = floor.certificate.energy_bound;
            pressed.pressure = floor.pressure;
            let forces = mesh.cells.centres().zip(&pressed.pressure);
            let forces = forces.filter(|(_, pressure)| **pressure > 0.0);
            let forces = forces.map(|(at, pressure)| (at, area * pressure));
            equations.floor = FloorForces::new(equations.layout, forces);
            let target = Prescribed::Indentation(indentation);
            let found = equations.find(target, Some(&pressed.contacts), self.run)?;
            let (settled, termination) = self.bench.found(equations, found)?;
            pressed.contacts = settled.contacts;
            pressed.force_on_tops = equations.force(&pressed.contacts);
            pressed.steps += settled.steps;
            self.run.report(Progress {
                stage: Stage::Floor,
                step: pressed.steps,
                pillars: self.bench.layout.asperities.len(),
                touched: pressed.contacts.discs.len(),
            });
            for termination in [floor.termination, termination] {
                if termination != Termination::Converged {
                    pressed.termination = termination;
                    return Ok(pressed);
                }
            }
            let sunk = self.sunk(equations, mesh, &pressed.contacts);
            let change: Vec<f64> = (sunk.iter().zip(&pressed.sunk))
                .map(|(new, old)| new - old)
                .collect();
            let off = largest(change.iter().map(|x| x.abs()));
            if off <= SUNK_TOLERANCE * self.depth {
                pressed.termination = Termination::Converged;
                return Ok(pressed);
            }
            pressed.sunk = extrapolation.next(&pressed.sunk, change);
        }
        pressed.termination = Termination::IterationLimit;
        Ok(pressed)
    }

    /// Tops and floor under a load, from a guess of the indentation. Returns the indentation and the contact; `None` if the indentation
    /// exceeds the bound of the mesh.
    fn under(
        &self,
        equations: &mut Equations<'_>,
        mesh: &mut Mesh<'_>,
        target: Prescribed,
        (guess, mut pressed): (f64, Pressed),
    ) -> Result<Option<(f64, Pressed)>, SolveError> {
        let force = match target {
            Prescribed::Indentation(indentation) => {
                let pressed = self.at(equations, mesh, indentation, pressed)?;
                return Ok(Some((indentation, pressed)));
            }
            Prescribed::Force(force) => force,
        };
        let mut indentation = smaller(guess, mesh.bound);
        let mut last: Option<[f64; 2]> = None;
        for _ in 0..SECANTS {
            pressed = self.at(equations, mesh, indentation, pressed)?;
            let reached = pressed.force();
            let off = reached - force;
            if pressed.termination != Termination::Converged || off.abs() <= FORCE_TOLERANCE * force
            {
                return Ok(Some((indentation, pressed)));
            }
            if off < 0.0 && indentation >= mesh.bound {
                return Ok(None);
            }
            let secant = last.map(|[at, force]| (reached - force) / (indentation - at));
            // Without a secant, that of Hertz's solution.
            let first = self.first_touch();
            let slope = secant.filter(|slope| slope.is_finite() && *slope > 0.0);
            let slope = slope.unwrap_or(1.5 * reached / (indentation - first));
            last = Some([indentation, reached]);
            indentation = smaller(indentation - off / slope, mesh.bound);
        }
        pressed.termination = Termination::Stagnated;
        Ok(Some((indentation, pressed)))
    }
}

/// The contact on one grid.
pub(super) struct Level {
    pub(super) indentation: f64,
    pub(super) pressed: Pressed,
    pub(super) patches: Patches,
    /// Area of a cell.
    pub(super) cell: f64,
}

impl Level {
    fn floor_area(&self) -> f64 {
        self.patches.area(self.cell)
    }
}

/// Derivatives with respect to the indentation.
pub(super) struct Rates {
    pub(super) force: f64,
    pub(super) force_on_floor: f64,
    pub(super) area: f64,
    pub(super) forces: Vec<f64>,
}

impl<'a> Ground<'a> {
    /// The contact on three grids, and at the end of the second one with a pressure of higher degree on the tops.
    fn solve(
        &mut self,
        target: Prescribed,
        alone: &Contacts,
    ) -> Result<Option<Solved<'a>>, SolveError> {
        let mut equations = self.equations();
        let mut alone = alone.clone();
        let first = self.first_touch();
        let step = |indentation: f64| SLOPE_STEP * (indentation - first);
        let further = |bound: f64| bound + larger(bound - first, self.depth);
        let mut bound = match target {
            Prescribed::Indentation(indentation) => indentation,
            // At most that on the tops alone, if it was found.
            Prescribed::Force(force)
                if equations.force(&alone) < (1.0 - FORCE_TOLERANCE) * force =>
            {
                further(alone.indentation)
            }
            Prescribed::Force(_) => alone.indentation,
        };
        let mut guess = bound;
        let mut levels: Vec<Level> = Vec::new();
        let mut known: Option<(Cells, Pressed)> = None;
        let mut of_degree = None;
        let mut side = f64::INFINITY;
        let (mut number, mut growths, mut is_narrowed) = (0, 0, false);
        loop {
            // The derivatives are differences.
            let bound_of_mesh = bound + 2.0 * step(bound);
            alone = self.tops_alone(bound_of_mesh, &alone)?;
            side = match number {
                0 => self.side_for(&alone, bound_of_mesh, 1.0 / 16.0)?,
                1 => {
                    let wanted = self.side_for(&alone, bound_of_mesh, 1.0 / 4.0)?;
                    smaller(wanted, side / REFINED)
                }
                _ => 0.5 * side,
            };
            let Some(mut mesh) = self.mesh(&alone, bound_of_mesh, side)? else {
                return Ok(None);
            };
            mesh.bound = bound;
            let start = match &known {
                Some((cells, pressed)) => self.start(
                    &equations,
                    &mesh,
                    pressed.contacts.clone(),
                    Some((cells, &pressed.pressure)),
                ),
                None => self.start(&equations, &mesh, alone.clone(), None),
            };
            let found = self.under(&mut equations, &mut mesh, target, (guess, start))?;
            let Some((indentation, pressed)) = found else {
                // The grid is too small: start again with a larger one.
                bound = further(bound);
                continue;
            };
            let loaded = pressed.pressure.iter().map(|pressure| *pressure > 0.0);
            let mut level = Level {
                indentation,
                patches: Patches::of(&mesh.cells, loaded, &self.pillars),
                cell: mesh.cells.grid().cell_area(),
                pressed,
            };
            let is_solved = level.pressed.termination == Termination::Converged;
            if self.rise > 0.0 && number < 2 && is_solved {
                let missed = self.missed(&equations, &mesh.cells, &level.pressed.contacts);
                if missed > MISSED && growths < GROWTHS {
                    self.margin = larger(2.0 * self.margin, MARGIN * missed * self.depth);
                    growths += 1;
                    continue;
                }
                if missed > MISSED {
                    level.pressed.termination = Termination::IterationLimit;
                }
            }
            let is_solved = level.pressed.termination == Termination::Converged;
            // Cells may be too large for a small contact.
            if level.patches.cells == 0 && number == 2 && is_solved {
                return Ok(None);
            }
            if level.patches.radius > self.lens.largest_contact() {
                let length = self.bench.units.length;
                return Err(SolveError::beyond(self.lens, level.patches.radius, length));
            }
            if number == 1 && is_solved {
                of_degree = self.refined(&mut mesh, &level)?;
            }
            guess = indentation;
            if let Prescribed::Force(_) = target {
                let [beyond, past] = [bound - indentation, indentation - self.depth];
                bound = smaller(bound, indentation + BEYOND * larger(beyond, past));
                // Cells for a far larger contact, as of a distant top alone, would make all grids too coarse.
                if number == 0 && is_solved && beyond > past && !is_narrowed {
                    is_narrowed = true;
                    continue;
                }
            }
            levels.push(level);
            if number == 2 || !is_solved {
                return Ok(Some(Solved {
                    levels,
                    of_degree,
                    of_works: None,
                    equations,
                    mesh,
                }));
            }
            let level = &levels[number];
            known = Some((mesh.cells, level.pressed.clone()));
            number += 1;
        }
    }

    /// The same contact with a pressure of higher degree on the tops.
    fn refined(&self, mesh: &mut Mesh<'_>, level: &Level) -> Result<Option<Pressed>, SolveError> {
        let low = degree(self.accuracy);
        let mut fine = Equations::new(&self.bench.layout, low + 2);
        let mut start = level.pressed.clone();
        start.contacts = with_modes(&start.contacts, mode_count(low), fine.modes());
        let refined = self.at(&mut fine, mesh, level.indentation, start)?;
        Ok((refined.termination == Termination::Converged).then_some(refined))
    }

    /// Derivatives of the last contact, as differences.
    fn rates(&self, solved: &mut Solved<'_>) -> Result<Option<Rates>, SolveError> {
        let Solved {
            levels,
            equations,
            mesh,
            ..
        } = solved;
        let Some(level) = levels.last() else {
            return Ok(None);
        };
        let first = self.first_touch();
        let step = SLOPE_STEP * (level.indentation - first);
        let mut ends = Vec::new();
        for sign in [-1.0, 1.0] {
            let indentation = level.indentation + sign * step;
            let end = self.at(equations, mesh, indentation, level.pressed.clone())?;
            if end.termination != Termination::Converged {
                return Ok(None);
            }
            ends.push(end);
        }
        let [low, high] = &ends[..] else {
            return Ok(None);
        };
        let slope = |low: f64, high: f64| (high - low) / (2.0 * step);
        let rate = |of: &dyn Fn(&Pressed) -> f64| slope(of(low), of(high));
        let forces = [low, high].map(|end| equations.forces(&end.contacts));
        let ends = forces[0].iter().zip(&forces[1]);
        Ok(Some(Rates {
            force: rate(&Pressed::force),
            force_on_floor: rate(&|it| it.force_on_floor),
            area: rate(&Pressed::area),
            forces: ends.map(|(low, high)| slope(*low, *high)).collect(),
        }))
    }
}

/// The contact on all grids.
pub(super) struct Solved<'a> {
    pub(super) levels: Vec<Level>,
    pub(super) of_degree: Option<Pressed>,
    /// The contact on the second grid with a larger work of adhesion of the floor, if that is adhesive.
    pub(super) of_works: Option<Pressed>,
    pub(super) equations: Equations<'a>,
    /// The last grid.
    pub(super) mesh: Mesh<'a>,
}

impl Bench {
    /// The contact with tops and floor. `alone` are contacts with the tops alone under this load, in which the lens is below the floor, or
    /// those at a lower indentation if these are not found. `None` if the floor carries no load on the finest grid.
    pub(super) fn with_floor(
        &self,
        target: Prescribed,
        alone: &AsperityContact,
        depth: f64,
        run: &Run<'_>,
    ) -> Result<Option<AsperityContact>, SolveError> {
        let depth = depth / self.units.length;
        let Some(lens) = &self.layout.shape.0 else {
            return Ok(None);
        };
        let pillars = Neighbours::new(bodies(self, depth).into_iter());
        let mut ground = Ground::new(self, lens, pillars, (depth, alone.accuracy), run);
        if ground.is_adhesive() {
            let followed = ground.follow(target, &alone.contacts)?;
            return Ok(followed.and_then(|(solved, rates)| {
                self.assemble_with_floor(&solved, rates.as_ref(), target, alone.accuracy)
            }));
        }
        let Some(mut solved) = ground.solve(target, &alone.contacts)? else {
            return Ok(None);
        };
        let rates = match solved.levels.last() {
            Some(level) if level.pressed.termination == Termination::Converged => {
                ground.rates(&mut solved)?
            }
            _ => None,
        };
        Ok(self.assemble_with_floor(&solved, rates.as_ref(), target, alone.accuracy))
    }

    /// Largest rise of the surface of layers beside a unit force.
    fn rise(&self) -> f64 {
        let thinnest = WeightedLayer::thinnest(&self.layers);
        let Some((around, thinnest)) = self.layout.layers.as_ref().zip(thinnest) else {
            return 0.0;
        };
        let (first, ratio, count) = RISES;
        let rises = (0..count as i32).map(|k| {
            let distance = thinnest * first * ratio.powi(k);
            -(distance.recip() + around.value(distance)) / PI
        });
        rises.fold(0.0, f64::max)
    }

    fn assemble_with_floor(
        &self,
        solved: &Solved<'_>,
        rates: Option<&Rates>,
        target: Prescribed,
        accuracy: Accuracy,
    ) -> Option<AsperityContact> {
        let level = solved.levels.last()?;
        let pressed = &level.pressed;
        let units = self.units;
        let settled = Settled {
            contacts: pressed.contacts.clone(),
            factors: None,
            steps: pressed.steps,
        };
        let contact = self.contact(&solved.equations, settled, pressed.termination, accuracy);
        let errors = rates.and_then(|rates| solved.errors(rates, self, accuracy));
        let (error, of_floor) = errors.map_or((None, FloorErrors::UNKNOWN), |(error, floor)| {
            let mut error = AsperityErrors {
                indentation: error.indentation * units.length,
                ..error
            };
            match target {
                Prescribed::Indentation(_) => error.indentation = 0.0,
                Prescribed::Force(_) => error.force = 0.0,
            }
            (Some(error), floor)
        });
        let grid = solved.mesh.cells.grid();
        let mut whole = vec![0.0; grid.cell_count()];
        solved.mesh.cells.scatter(&pressed.pressure, &mut whole);
        let cells = Cells::where_true(grid, |index| whole[index] != 0.0);
        let loaded = pressed.pressure.iter().filter(|pressure| **pressure != 0.0);
        let before = solved.levels.iter().rev().nth(1);
        let floor = FloorContact {
            force: pressed.force_on_floor * units.force(),
            share: pressed.share(),
            area: level.floor_area() * units.length * units.length,
            patches: level.patches.count,
            patches_agree: before.is_some_and(|one| one.patches.count == level.patches.count),
            radius: level.patches.radius * units.length,
            smallest_distance_to_rim: level.patches.rim_distance * units.length,
            error: of_floor,
            energy_bound: pressed.energy_bound,
            cells: cells.scaled(units.length),
            rotation: 0.0,
            pressure: loaded.map(|pressure| pressure * units.pressure).collect(),
        };
        let slope = |value: f64| value * units.stiffness();
        let force = match target {
            // The secants end next to it.
            Prescribed::Force(force) if pressed.termination == Termination::Converged => force,
            _ => pressed.force(),
        };
        Some(AsperityContact {
            force: force * units.force(),
            slopes: AsperitySlopes {
                force_with_indentation: rates.map_or(0.0, |rates| slope(rates.force)),
                area_with_indentation: rates.map_or(0.0, |rates| rates.area * units.length),
                force_with_height: rates.map_or_else(Vec::new, |rates| {
                    rates.forces.iter().map(|rate| slope(*rate)).collect()
                }),
                area_with_height: Vec::new(),
            },
            error,
            floor_gap: Some(AsperityFloorGap {
                gap: 0.0,
                position: floor.largest_pressure().1,
            }),
            floor: Some(floor),
            ..contact
        })
    }
}

impl Solved<'_> {
    /// Errors of force, area and indentation, and of the floor, from the three grids and a pressure of higher degree.
    fn errors(
        &self,
        rates: &Rates,
        bench: &Bench,
        accuracy: Accuracy,
    ) -> Option<(AsperityErrors, FloorErrors)> {
        let (of_degree, [first, coarse, fine]) =
            (self.of_degree.as_ref()?, self.levels.last_chunk()?);
        // Differences at the same indentation, to first order.
        let change = |of: &dyn Fn(&Level) -> f64, rate: f64, from: &Level, to: &Level| {
            (of(to) - of(from) - rate * (to.indentation - from.indentation)).abs()
        };
        // The last change may be small by accident where cells are as large as pillars: the one before counts in proportion to the cell size.
        let [first_side, side, last_side] = [first, coarse, fine].map(|level| level.cell.sqrt());
        let part = (side - last_side) / (first_side - side);
        let of_cells = |of: &dyn Fn(&Level) -> f64, rate: f64| {
            let before = part * change(of, rate, first, coarse);
            SAFETY * larger(change(of, rate, coarse, fine), before)
        };
        let error = |of: &dyn Fn(&Pressed) -> f64, rate: f64| {
            let change = |other: &Pressed| (of(other) - of(&coarse.pressed)).abs();
            let of_works = self.of_works.as_ref().map_or(0.0, change);
            of_cells(&|level| of(&level.pressed), rate) + DEGREES * change(of_degree) + of_works
        };
        let pressed = &fine.pressed;
        let [on_shape, area_of_shape] = match pressed.contacts.discs.is_empty() {
            true => [0.0; 2],
            false => {
                Equations::new(&bench.layout, degree(accuracy)).shape_errors(&pressed.contacts)
            }
        };
        let force = error(&Pressed::force, rates.force) + on_shape;
        let pull_off = bench.pull_off_scale(&pressed.contacts) / bench.units.force();
        let scale = larger(
            larger(pressed.force().abs(), pull_off),
            pressed.force_on_floor.abs(),
        );
        let area = error(&Pressed::area, rates.area);
        let relative = |change: f64, value: f64| match value.abs() > 0.0 {
            true => change / value.abs(),
            false => 0.0,
        };
        let total = pressed.force().abs();
        let of_share = (rates.force_on_floor - pressed.share() * rates.force) / total;
        // The displacement of the floor by the tops is in proportion to the forces on these, and has at least their relative error.
        let sunk = relative(on_shape, pressed.force_on_tops) * pressed.mean_sunk();
        let shared = error(&Pressed::share, of_share) + (of_share * sunk).abs();
        let border = fine.patches.area_error(fine.cell);
        let of_area = SAFETY * (fine.floor_area() - coarse.floor_area()).abs();
        Some((
            AsperityErrors {
                force: relative(force, scale),
                area: relative(area, pressed.area()) + area_of_shape,
                indentation: force / rates.force.abs(),
            },
            FloorErrors::of_part(
                relative(shared, pressed.share()),
                larger(border, of_area) / fine.floor_area(),
            ),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Asperity, AsperityArray, LensShape, Material};
    use crate::state::discs::Hold;

    /// The derivative of the force with respect to the height of a top is that of the force on this top with respect to the indentation,
    /// because forces are derivatives of one energy: as differences on one grid. Tops are full, so that their discs do not change; contacts
    /// that end within a top are discs only approximately, and differ by some thousandths. So do longer steps, within which cells of the floor
    /// come into contact; on this one the displacements, which are found to 1e-10, give the derivatives to some 1e-5.
    #[test]
    fn forces_are_derivatives_of_an_energy() {
        let run = Run::default();
        let of = |raised: f64| {
            let rubber = Material::new(1.0, 0.0);
            let shape = LensShape::Paraboloid { radius: 1e-3 };
            let lens = ShapedLens::new(shape, Material::new(1e300, 0.0));
            let top = |at: [f64; 2], raised: f64| Asperity {
                rim_radius: Some(10e-6),
                ..Asperity::new(at, 1e-4).raised_by(raised)
            };
            let tops = vec![top([9e-6, 4e-6], raised), top([-24e-6, 0.0], 2e-7)];
            Bench::new(&AsperityArray::new(lens.into(), rubber, tops).expect("an array"))
        };
        let (indentation, step) = (0.029, 3e-6);
        let at = |raised: f64, indentation: f64| {
            let bench = of(raised * 1e-4);
            let lens = bench.layout.shape.0.as_ref().expect("a lens");
            let pillars = Neighbours::new(bodies(&bench, 0.01).into_iter());
            let ground = Ground::new(&bench, lens, pillars, (0.01, Accuracy::Default), &run);
            let mut equations = ground.equations();
            let untouched = bench.layout.untouched(indentation);
            let mut mesh = ground
                .mesh(&untouched, 0.03, 0.02)
                .expect("cells")
                .expect("a floor");
            let start = ground.start(&equations, &mesh, untouched, None);
            let found = ground.at(&mut equations, &mut mesh, indentation, start);
            let found = found.expect("a contact");
            assert_eq!(found.termination, Termination::Converged);
            assert!(found.share() > 0.1);
            let discs = &found.contacts.discs;
            assert!(discs.iter().all(|disc| disc.hold == Hold::Whole));
            [found.force(), equations.forces(&found.contacts)[0]]
        };
        let with = |raised: f64, moved: f64| at(raised, indentation + moved);
        let of_height = with(step, 0.0)[0] - with(-step, 0.0)[0];
        let [low, high] = [-step, step].map(|moved| with(0.0, moved));
        let off = of_height / (high[1] - low[1]) - 1.0;
        assert!(off.abs() < 1e-4, "{off:e}");
    }
}
