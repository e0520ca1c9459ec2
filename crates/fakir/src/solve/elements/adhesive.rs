//! Adhesion on a height map, in the limit of a short range of the attraction (Johnson, Kendall and Roberts).
//!
//! The cells in contact, of either sign of pressure, follow the indenter; the others carry no load. The border of this set is a crack front,
//! which moves according to its energy release rate ([`FloorFronts`]), one cell in each round, until it rests. The contact depends on the
//! path: loading begins at the first touch and proceeds in steps of the indentation, and unloading continues from there.
//!
//! At a step of the surface, such as the edge of a pillar, a front stays until the whole edge detaches: the cells below the step are no part
//! of the crack. A step is a gap that is several times wider than that of a crack that is about to grow, one cell from its front.
//!
//! A floor without adhesion carries pressure like a surface without adhesion: its cells attach where the indenter would penetrate them, and
//! detach where they are in tension.

use super::solver::Prescribed;
use super::surface_level::{FLOOR_TOLERANCE, Level, Pressed};
use crate::halfspace::elements::half_space::HalfSpace;
use crate::halfspace::elements::{Columns, Operator, Preconditioned};
use crate::numerics::line::integral_and_negative_part;
use crate::numerics::workers::CancelToken;
use crate::problem::{Adhesion, Cells, Floor, Load, ShapedLens, Unsupported};
use crate::solve::rules::bonded_floor::Rounds;
use crate::solve::rules::floor_fronts::{FloorFronts, FloorMove, OF_CENTRES};
use crate::solve::rules::fronts::{Course, Works};
use crate::state::{
    Branch, DualityGap, Progress, SolveError, Stage, SurfaceContact, SurfaceLoadStep, Termination,
};
use crate::theory::adhesion::edge_rise;

/// Largest residual of the displacement of cells in contact, relative to the gap of a crack that is about to grow, one cell from its front:
/// while fronts move, and when they rest.
const MOVING: f64 = 1e-2;
const AT_REST: f64 = 1e-5;

/// A gap of this many times that of a crack that is about to grow, one cell from its front, is a step of the surface.
const STEEP: f64 = 3.0;

/// Depth of a cell in the indenter, relative to the same gap, from which it is touched.
const ENTERED: f64 = 1e-4;

/// Cells are left out if their separation exceeds the indentation without adhesion by more than this many times the rise of an edge of the
/// contact. If cells beside them are touched, the loading is repeated with more cells.
const RISE: f64 = 2.0;

/// Number of steps of a loading of which only the end is asked for, of one whose curve is asked for, and of an unloading to first touch.
const FEW_STEPS: f64 = 4.0;
const STEPS: f64 = 16.0;

/// A step is repeated in halves if more than this fraction of the contact detaches in it, down to this fraction of a step.
const MUCH: f64 = 0.25;
const SHORTEST: f64 = 1.0 / 64.0;

/// Largest number of rounds at one indentation, of steps, and of products of one solution.
const ROUND_LIMIT: usize = 4000;
const STEP_LIMIT: usize = 4000;
const PRODUCT_LIMIT: usize = 500;

/// Largest number of solutions in the search for the end of a loading, and the accuracy of a prescribed force.
const SEARCH_LIMIT: usize = 40;
const FORCE_TOLERANCE: f64 = 1e-6;

/// A cell of a floor without adhesion that has detached this many times at one indentation stays detached there, so that cells do not alternate.
const MOST_PARTINGS: u8 = 3;

/// Largest ratio of the sides of a cell: the laws of fronts hold on square cells.
const LONGEST_CELL: f64 = 1.1;

/// Memory per cell besides the operator, bytes: states, workspaces and the data of the fronts.
const BYTES_PER_CELL: usize = 260;

/// A contact with adhesion.
#[derive(Clone)]
pub(super) struct Held {
    pub(super) indentation: f64,
    bonded: Vec<bool>,
    /// Pressure and displacement of every cell that may be touched.
    pressure: Vec<f64>,
    displacement: Vec<f64>,
}

/// Contact with adhesion on the cells of one size.
pub(super) struct AdhesiveCells<'a> {
    cells: Cells,
    operator: Columns<Preconditioned<'a, HalfSpace<'a>, f32>>,
    separation: Vec<f64>,
    /// Cells of a floor without adhesion, and how many times each has detached at this indentation.
    plain: Option<Vec<bool>>,
    parted: Vec<u8>,
    fronts: FloorFronts,
    cell_area: f64,
    modulus: f64,
    /// Gap of a crack that is about to grow, one cell from its front, m.
    opening: f64,
    pub(super) held: Held,
    direction: Vec<f64>,
    residual: Vec<f64>,
    response: Vec<f64>,
    pub(super) products: usize,
    /// Cells beside cells that are left out and could be touched.
    at_bound: Vec<usize>,
    cancel: CancelToken,
    /// Why there is no solution, if there is none.
    failed: Option<Termination>,
}

impl Held {
    fn count(&self) -> usize {
        self.bonded.iter().filter(|bonded| **bonded).count()
    }
}

impl AdhesiveCells<'_> {
    fn side(&self) -> f64 {
        self.cell_area.sqrt()
    }

    pub(super) fn force(&self) -> f64 {
        self.cell_area * self.held.pressure.iter().sum::<f64>()
    }

    pub(super) fn area(&self) -> f64 {
        self.cell_area * self.held.count() as f64
    }

    fn gap(&self, cell: usize) -> f64 {
        self.separation[cell] + self.held.displacement[cell] - self.held.indentation
    }

    /// Returns to an earlier contact.
    fn restore(&mut self, held: &Held) {
        for (cell, bonded) in held.bonded.iter().enumerate() {
            self.fronts.set(&mut self.held.bonded, cell, *bonded);
        }
        self.held.clone_from(held);
    }

    /// Solves for the pressures of the cells in contact up to a residual of their displacement, m: conjugate gradients.
    fn settle(&mut self, tolerance: f64) {
        for (pressure, bonded) in self.held.pressure.iter_mut().zip(&self.held.bonded) {
            if !bonded {
                *pressure = 0.0;
            }
        }
        self.operator
            .apply(&self.held.pressure, &mut self.held.displacement);
        let mut slope = 0.0;
        for product in 1..PRODUCT_LIMIT {
            self.products += 1;
            let mut largest = 0.0_f64;
            for cell in 0..self.residual.len() {
                let residual = if self.held.bonded[cell] {
                    -self.gap(cell)
                } else {
                    0.0
                };
                self.residual[cell] = residual;
                largest = largest.max(residual.abs());
            }
            if largest <= tolerance {
                return;
            }
            self.operator
                .precondition(&self.residual, &mut self.response);
            let mut next = 0.0;
            for ((response, residual), bonded) in self
                .response
                .iter_mut()
                .zip(&self.residual)
                .zip(&self.held.bonded)
            {
                *response = if *bonded { *response } else { 0.0 };
                next += *response * residual;
            }
            let turned = if product == 1 { 0.0 } else { next / slope };
            slope = next;
            for (direction, response) in self.direction.iter_mut().zip(&self.response) {
                *direction = response + turned * *direction;
            }
            self.operator.apply(&self.direction, &mut self.response);
            let along: f64 = self
                .direction
                .iter()
                .zip(&self.response)
                .map(|(direction, response)| direction * response)
                .sum();
            if along.is_nan() || along <= 0.0 {
                break;
            }
            let length = slope / along;
            for (pressure, direction) in self.held.pressure.iter_mut().zip(&self.direction) {
                *pressure += length * direction;
            }
            for (displacement, response) in self.held.displacement.iter_mut().zip(&self.response) {
                *displacement += length * response;
            }
        }
        self.failed = Some(Termination::Stagnated);
    }

    /// Cells that attach, and cells that detach, in one round.
    fn moves(&mut self, which: FloorMove) -> [Vec<usize>; 2] {
        let (side, modulus) = (self.side(), self.modulus);
        let held = &self.held;
        let gaps = self.separation.iter().zip(&held.displacement);
        let gaps = gaps.map(|(s, u)| (held.indentation - s - u) / side);
        let pressures = held.pressure.iter().map(|pressure| pressure / modulus);
        let entered = ENTERED * self.opening;
        let data = (gaps, pressures);
        let at_fronts = (self.fronts).round(&held.bonded, which, data, entered / side);
        let attaches = which == FloorMove::Advance;
        let Some(plain) = &self.plain else {
            return if attaches {
                [at_fronts, Vec::new()]
            } else {
                [Vec::new(), at_fronts]
            };
        };
        let of_tops = at_fronts.into_iter().filter(|cell| !plain[*cell]);
        let of_floor = |cell: &usize, attach: bool| {
            plain[*cell]
                && held.bonded[*cell] != attach
                && if attach {
                    self.gap(*cell) < -entered && self.parted[*cell] < MOST_PARTINGS
                } else {
                    held.pressure[*cell] < 0.0
                }
        };
        let all = 0..held.bonded.len();
        let [mut joined, mut parted] = [true, false].map(|attach| {
            all.clone()
                .filter(|cell| of_floor(cell, attach))
                .collect::<Vec<_>>()
        });
        if attaches {
            joined.extend(of_tops);
        } else {
            parted.extend(of_tops);
        }
        [joined, parted]
    }

    /// Moves the indenter, and the fronts until they rest.
    ///
    /// Ends early if fewer than `least` cells are left in contact, or if the run is cancelled.
    pub(super) fn advance(&mut self, indentation: f64, course: Course, least: usize) {
        self.held.indentation = indentation;
        self.settle(MOVING * self.opening);
        self.fronts.lift_bans();
        self.parted.fill(0);
        let mut rounds = Rounds::new(course);
        let mut is_fine = false;
        for _ in 0..ROUND_LIMIT {
            let is_rest = |moves: &[Vec<usize>; 2]| moves.iter().all(Vec::is_empty);
            let moves = rounds.next(|which| self.moves(which), is_rest);
            if moves.iter().all(Vec::is_empty) {
                if is_fine {
                    return;
                }
                is_fine = true;
                self.settle(AT_REST * self.opening);
                continue;
            }
            is_fine = false;
            if self.held.count() < least || self.cancel.is_cancelled() {
                return;
            }
            for cell in &moves[1] {
                self.parted[*cell] = self.parted[*cell].saturating_add(1);
            }
            for (cells, bonds) in moves.iter().zip([true, false]) {
                let near = self.fronts.shift(&mut self.held.bonded, cells, bonds);
                for (cell, factor) in near {
                    self.held.pressure[cell] *= factor;
                }
            }
            self.settle(MOVING * self.opening);
            if self.failed.is_some() {
                return;
            }
        }
        self.failed = Some(Termination::IterationLimit);
    }

    fn deepest(&self) -> f64 {
        let gaps = (0..self.separation.len()).map(|cell| -self.gap(cell));
        gaps.fold(0.0, f64::max)
    }
}

/// A loading, and an unloading if there is one.
pub(super) struct Followed<'a> {
    pub(super) level: Level<'a>,
    pub(super) cells: AdhesiveCells<'a>,
    pub(super) steps: Vec<SurfaceLoadStep>,
    step: f64,
    /// The contact with the largest tensile force of the unloading.
    pub(super) pull_off: Option<(f64, Held)>,
}

impl<'a> Level<'a> {
    /// The cells with adhesion whose separation is up to a bound, before the first touch.
    fn adhesive(&self, adhesion: Adhesion, bound: f64) -> Result<AdhesiveCells<'a>, SolveError> {
        let grid = *self.surface.grid();
        let [width, height] = grid.cell();
        if width.max(height) > LONGEST_CELL * width.min(height) {
            return Err(SolveError::Unsupported(Unsupported::BUT_FOR_SQUARE_CELLS));
        }
        let farthest = self.farthest_allowed();
        let could_be_touched = |cell: usize| {
            self.separation[cell] <= farthest
                && self.floor.as_ref().is_none_or(|floor| !floor[cell])
        };
        let is_in = |cell: usize| self.separation[cell] <= bound && could_be_touched(cell);
        let cells = Cells::where_true(&grid, is_in);
        let bytes = self.half_space_memory(&cells)
            + Preconditioned::<HalfSpace<'_>>::memory_estimate(&cells)
            + BYTES_PER_CELL * cells.len();
        self.check_memory(cells.len(), bytes)?;
        self.check_cancelled()?;
        let operator = self
            .half_space(cells.clone())
            .preconditioned(cells.clone(), self.run.pool);
        let operator = self.on_columns(operator, &cells);
        let modulus = self.system.reduced_modulus();
        let side = grid.cell_area().sqrt();
        let unit = (modulus * side).recip();
        let works = Works {
            advancing: unit * adhesion.work,
            receding: unit * adhesion.receding(),
        };
        let opening = (2.0 * works.receding).sqrt() * OF_CENTRES.gap_at(1.0);
        let plain = self.system.floor().filter(|_| !adhesion.floor);
        let plain = plain.map(|floor: Floor| {
            let is_floor = |cell| floor.contains(&self.surface, cell);
            cells.indices().map(is_floor).collect()
        });
        let count = cells.len();
        let steep = STEEP * opening * side;
        let is_at_bound = |[column, row]: [usize; 2], cell: usize| {
            let columns = grid.columns();
            let sides = [
                (column > 0).then(|| cell - 1),
                (column + 1 < columns).then_some(cell + 1),
                (row > 0).then(|| cell - columns),
                (row + 1 < grid.rows()).then_some(cell + columns),
            ];
            sides.into_iter().flatten().any(|other| {
                let step = self.separation[other] - self.separation[cell];
                !is_in(other) && could_be_touched(other) && step <= steep
            })
        };
        let places = cells.indices().zip(cells.positions()).enumerate();
        let at_bound = places
            .filter(|(_, (cell, (column, row)))| is_at_bound([*column, *row], *cell))
            .map(|(place, _)| place);
        Ok(AdhesiveCells {
            at_bound: at_bound.collect(),
            separation: cells.indices().map(|cell| self.separation[cell]).collect(),
            fronts: FloorFronts::on_cells(&cells, 1.0, Some(works), &OF_CENTRES)
                .with_steps(STEEP * opening),
            operator,
            plain,
            parted: vec![0; count],
            cell_area: grid.cell_area(),
            modulus,
            opening: opening * side,
            held: Held {
                indentation: f64::NEG_INFINITY,
                bonded: vec![false; count],
                pressure: vec![0.0; count],
                displacement: vec![0.0; count],
            },
            direction: vec![0.0; count],
            residual: vec![0.0; count],
            response: vec![0.0; count],
            products: 0,
            cancel: self.run.cancel.clone(),
            failed: None,
            cells,
        })
    }

    /// Loads from the first touch; the whole curve is found in a `cycle`, otherwise only its end.
    ///
    /// Adhesion only widens the contact. The cells that are in contact without it attach first, and the fronts advance from there: fewer rounds
    /// than from a point.
    pub(super) fn follow(
        mut self,
        load: Load,
        adhesion: Adhesion,
        cycle: bool,
    ) -> Result<(Followed<'a>, Pressed), SolveError> {
        let first = self.nearest(1);
        let mut without_adhesion = None;
        if let (Load::Indentation(indentation), false) = (load, cycle)
            && indentation > first
        {
            self.press(Prescribed::Indentation(indentation))?;
            without_adhesion = Some(std::mem::take(&mut self.pressure));
            self.pressure = vec![0.0; self.separation.len()];
        }
        // The depth without adhesion, and that over which adhesion acts.
        let depth = match load {
            Load::Indentation(indentation) => indentation - first,
            Load::Force(force) => {
                let depth = self.press(Prescribed::Force(force))?.indentation - first;
                self.pressure.fill(0.0);
                depth
            }
            Load::FloorContact => self.lowest_of_floor() - first,
        };
        // A flat end, level or tilted, has no edge that rises with the load.
        let lens = self.system.indenter().lens();
        let radius = lens.map(ShapedLens::apex_radius);
        let radius = radius.filter(|it| it.is_finite()).unwrap_or(0.0);
        let ratio = adhesion.receding() / self.system.reduced_modulus();
        let adhesive = (ratio * ratio * radius).cbrt();
        let edge = edge_rise(ratio, radius, depth.max(0.0));
        let mut margin = RISE * (edge + (ratio * self.surface.grid().cell()[0]).sqrt());
        let mut level = self;
        loop {
            let cells = level.adhesive(adhesion, first + depth.max(0.0) + margin)?;
            let mut followed = Followed {
                step: depth.max(adhesive).max(cells.opening)
                    / if cycle { STEPS } else { FEW_STEPS },
                level,
                cells,
                steps: Vec::new(),
                pull_off: None,
            };
            if let Some(pressure) = &without_adhesion {
                followed.attach(pressure);
            }
            let pressed = followed.load(first, load)?;
            let held = &followed.cells.held.bonded;
            if !followed.cells.at_bound.iter().any(|cell| held[*cell]) {
                return Ok((followed, pressed));
            }
            // Cells that are left out could be touched.
            margin *= 2.0;
            level = followed.level;
        }
    }
}

impl<'a> Followed<'a> {
    /// Attaches the cells that carry pressure without adhesion.
    fn attach(&mut self, pressure: &[f64]) {
        let AdhesiveCells {
            cells,
            fronts,
            held,
            ..
        } = &mut self.cells;
        for (place, cell) in cells.indices().enumerate() {
            if pressure[cell] > 0.0 {
                fronts.set(&mut held.bonded, place, true);
                held.pressure[place] = pressure[cell];
            }
        }
    }

    fn load(&mut self, first: f64, target: Load) -> Result<Pressed, SolveError> {
        // The first cell attaches as soon as it is touched.
        let mut next = first + 2.0 * ENTERED * self.cells.opening;
        if let Load::Indentation(end) = target
            && (end <= next || self.cells.held.count() > 0)
        {
            next = end;
        }
        self.cells.held.indentation = first.min(next);
        self.record(Course::Loading);
        for _ in 0..STEP_LIMIT {
            let before = self.cells.held.clone();
            self.move_to(next, Course::Loading, 0)?;
            if self.cells.failed.is_some() {
                break;
            }
            let missing = self.missing(target)?;
            if missing <= 0.0 {
                self.search(target, before, missing)?;
                self.record(Course::Loading);
                return self.pressed(target);
            }
            self.record(Course::Loading);
            next += self.step;
            if let Load::Indentation(end) = target {
                next = next.min(end);
            }
        }
        self.cells.failed.get_or_insert(Termination::IterationLimit);
        self.pressed(target)
    }

    /// Distance to the end of the loading; not positive if it is reached.
    fn missing(&mut self, target: Load) -> Result<f64, SolveError> {
        Ok(match target {
            Load::Indentation(end) => end - self.cells.held.indentation,
            Load::Force(force) => force - self.cells.force(),
            Load::FloorContact => {
                self.show();
                self.level.floor_gap(self.cells.held.indentation)?.0
            }
        })
    }

    /// Finds the end of a loading within the last step, from the contact before it.
    fn search(&mut self, target: Load, mut before: Held, missing: f64) -> Result<(), SolveError> {
        let tolerance = match target {
            Load::Indentation(_) => return Ok(()),
            Load::Force(force) => FORCE_TOLERANCE * force,
            Load::FloorContact => FLOOR_TOLERANCE * self.cells.held.indentation.abs(),
        };
        let mut after = self.cells.held.clone();
        let mut ends = [before.indentation, after.indentation];
        self.cells.restore(&before);
        let mut values = [self.missing(target)?, missing];
        for _ in 0..SEARCH_LIMIT {
            let share = (values[0] / (values[0] - values[1])).clamp(0.05, 0.95);
            let between = ends[0] + share * (ends[1] - ends[0]);
            self.cells.restore(&before);
            self.move_to(between, Course::Loading, 0)?;
            let value = self.missing(target)?;
            if value.abs() <= tolerance || self.cells.failed.is_some() {
                return Ok(());
            }
            if value > 0.0 {
                (ends[0], values[0]) = (between, value);
                values[1] *= 0.5;
                before = self.cells.held.clone();
            } else {
                (ends[1], values[1]) = (between, value);
                values[0] *= 0.5;
                after = self.cells.held.clone();
            }
            if ends[1] - ends[0] < FORCE_TOLERANCE * self.step {
                // A jump: the end is reached in it.
                break;
            }
        }
        self.cells.restore(&after);
        Ok(())
    }

    /// Unloads to the last detachment.
    pub(super) fn unload(&mut self, first: f64) -> Result<(), SolveError> {
        let whole = ((self.cells.held.indentation - first) / STEPS).max(self.step);
        let mut step = whole;
        self.record(Course::Unloading);
        for _ in 0..STEP_LIMIT {
            if self.cells.held.count() == 0 || self.cells.failed.is_some() {
                return Ok(());
            }
            let before = self.cells.held.clone();
            let least = ((1.0 - MUCH) * before.count() as f64) as usize;
            let is_short = step <= SHORTEST * whole;
            let bound = if is_short { 0 } else { least };
            self.move_to(before.indentation - step, Course::Unloading, bound)?;
            let is_much = self.cells.held.count() < least;
            if is_much && !is_short {
                self.cells.restore(&before);
                step *= 0.5;
                continue;
            }
            self.record(Course::Unloading);
            let force = self.cells.force();
            if force < self.pull_off.as_ref().map_or(0.0, |(least, _)| *least) {
                self.pull_off = Some((force, self.cells.held.clone()));
            }
            if !is_much {
                step = (2.0 * step).min(whole);
            }
        }
        self.cells.failed.get_or_insert(Termination::IterationLimit);
        Ok(())
    }

    /// The surface with the present pressures.
    pub(super) fn copy(&self) -> Level<'a> {
        let of = &self.level;
        let mut level = Level::new(of.system, of.surface.clone(), None, of.run);
        level.pressure.clone_from(&of.pressure);
        level.products = of.products;
        level
    }

    /// The contact with the largest tensile force.
    pub(super) fn strongest(&mut self) -> Result<Option<SurfaceContact>, SolveError> {
        let Some((_, held)) = self.pull_off.take() else {
            return Ok(None);
        };
        self.cells.restore(&held);
        let pressed = self.pressed(Load::Force(0.0))?;
        self.copy().finish(&pressed)?.checked().map(Some)
    }

    /// Why there is no solution, if there is none.
    pub(super) fn termination(&self) -> Option<Termination> {
        self.cells.failed
    }

    /// Work of the force over the whole cycle, and the tensile part of that on unloading, as a positive number.
    pub(super) fn work(&self) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for pair in self.steps.windows(2) {
            let ends = [&pair[0], &pair[1]].map(|step| [step.indentation, step.force]);
            let [work, tensile] = integral_and_negative_part(ends);
            sums[0] += work;
            if pair[1].branch == Branch::Unloading {
                sums[1] += tensile;
            }
        }
        sums
    }

    fn move_to(
        &mut self,
        indentation: f64,
        course: Course,
        least: usize,
    ) -> Result<(), SolveError> {
        self.level.check_cancelled()?;
        self.cells.advance(indentation, course, least);
        self.level.check_cancelled()?;
        self.level.products = self.cells.products;
        self.level.run.report(Progress {
            stage: Stage::Surface,
            step: self.cells.products,
            pillars: self.cells.cells.len(),
            touched: self.cells.held.count(),
        });
        self.show();
        self.level.check_extent()?;
        self.level.check_inside()
    }

    /// Copies the pressures to all cells of the surface.
    fn show(&mut self) {
        self.level.pressure.fill(0.0);
        let pressure = &self.cells.held.pressure;
        self.cells.cells.scatter(pressure, &mut self.level.pressure);
    }

    fn record(&mut self, course: Course) {
        self.steps.push(SurfaceLoadStep {
            branch: course.branch(),
            indentation: self.cells.held.indentation,
            force: self.cells.force(),
            contact_area: self.cells.area(),
        });
    }

    fn pressed(&mut self, target: Load) -> Result<Pressed, SolveError> {
        self.show();
        let indentation = self.cells.held.indentation;
        let floor_cell = match target {
            Load::FloorContact => Some(self.level.floor_gap(indentation)?.1),
            _ => None,
        };
        let residual = AT_REST * self.cells.opening;
        let depth = self.cells.deepest();
        Ok(Pressed {
            indentation,
            force: self.cells.force(),
            certificate: DualityGap {
                energy_bound: residual / indentation.abs().max(self.cells.opening),
                interpenetration: depth,
                gap_under_pressure: residual,
            },
            termination: self.cells.failed.unwrap_or(Termination::Converged),
            floor_cell,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{
        Boundary, CyclePlan, Grid, HeightMap, Indenter, Lens, Material, SurfaceSystem,
        UnloadingPoint,
    };
    use crate::solve::rules::floor_fronts::tests::{LawCheck, PUNCHES, Ratios};
    use crate::state::{Run, SurfaceCycle};
    use std::f64::consts::PI;

    const RADIUS: f64 = 0.2e-3;
    const WORK: f64 = 50e-3;

    fn rubber() -> Material {
        Material::new(2e6, 0.5)
    }

    fn system(cells: usize, cell: f64, heights: impl Fn([f64; 2]) -> f64) -> SurfaceSystem {
        let lens = Indenter::from(Lens {
            radius: RADIUS,
            material: rubber(),
        });
        let grid = Grid::centred(cells, cells, cell).unwrap();
        let map = HeightMap::from_height(grid, heights).unwrap();
        let system = SurfaceSystem::new(lens, rubber(), map, Boundary::FreeSpace).unwrap();
        system.with_adhesion(Adhesion::new(WORK)).unwrap()
    }

    /// A flat round punch in tension on cells of side 1 with prescribed cells in contact.
    fn punch(cells: usize, centre: [f64; 2], radius: f64) -> (SurfaceSystem, Vec<bool>) {
        let grid = Grid::centred(cells, cells, 1.0).unwrap();
        let map = HeightMap::from_height(grid, |_| 0.0).unwrap();
        let material = Material::new(1.0, 0.0);
        let system =
            SurfaceSystem::new(Indenter::Flat(None), material, map, Boundary::FreeSpace).unwrap();
        let near = |[x, y]: [f64; 2]| (x - centre[0]).hypot(y - centre[1]) < radius;
        let bonded = grid.centres().map(near).collect();
        (system.with_adhesion(Adhesion::new(1.0)).unwrap(), bonded)
    }

    fn settled<'a>(
        system: &'a SurfaceSystem,
        bonded: &[bool],
        run: &'a Run<'a>,
    ) -> AdhesiveCells<'a> {
        let level = Level::new(system, system.surface().clone(), None, run);
        let mut cells = level.adhesive(system.adhesion(), f64::MAX).unwrap();
        for (cell, bonded) in bonded.iter().enumerate() {
            cells.fronts.set(&mut cells.held.bonded, cell, *bonded);
        }
        cells.held.indentation = -1.0;
        cells.settle(1e-7);
        cells
    }

    #[test]
    fn tables_are_those_of_flat_punches() {
        let run = Run::default();
        let mut check = LawCheck::new(&OF_CENTRES);
        for (k, radius) in PUNCHES.into_iter().enumerate() {
            let centre = [0.37 * k as f64, 0.21 * k as f64];
            let (system, bonded) = punch(96, centre, radius);
            let cells = settled(&system, &bonded, &run);
            let effective = (cells.held.count() as f64 / PI).sqrt();
            for (cell, distance) in cells.fronts.distances().into_iter().enumerate() {
                let values = [cells.held.pressure[cell], cells.gap(cell)];
                check.add(effective, distance, bonded[cell], values);
            }
        }
        check.finish();
    }

    /// `K = 1/sqrt(pi a)` of a flat punch (Johnson, Contact Mechanics, section 3.9), on a flat surface and at the edge of a pillar.
    #[test]
    fn intensities_of_flat_punches() {
        let run = Run::default();
        for radius in [5.0, 7.6, 10.0, 16.0, 31.0] {
            for is_edge in [false, true] {
                let mut ratios = Ratios::default();
                for k in 0..6 {
                    let centre = [0.37 * f64::from(k), 0.21 * f64::from(k)];
                    let (system, bonded) = punch(80, centre, radius);
                    let mut cells = settled(&system, &bonded, &run);
                    let a = (cells.held.count() as f64 / PI).sqrt();
                    if is_edge {
                        let displacement = cells.held.displacement.iter_mut().zip(&bonded);
                        let outside = displacement.filter(|(_, bonded)| !**bonded);
                        outside.for_each(|(displacement, _)| *displacement += 1e6);
                    }
                    let _ = cells.moves(FloorMove::Recede);
                    let exact = 1.0 / (PI * a).sqrt();
                    ratios.add(&cells.fronts, &cells.held.bonded, exact);
                }
                let [mean, deviation] = ratios.moments();
                assert!((mean - 1.0).abs() < 0.02, "{radius} {is_edge}: {mean}");
                assert!(deviation < 0.03, "{radius} {is_edge}: {deviation}");
            }
        }
    }

    fn cycle_to(system: &SurfaceSystem, indentation: f64) -> SurfaceCycle {
        let plan = CyclePlan {
            turn: UnloadingPoint::Indentation(indentation),
            ..CyclePlan::default()
        };
        let cycle = system.cycle(plan, &Run::default()).unwrap();
        assert_eq!(cycle.termination, Termination::Converged);
        cycle
    }

    /// Largest tensile force of a cycle over the expected one, and its estimated error.
    fn pull_off(cycle: &SurfaceCycle, expected: f64) -> [f64; 2] {
        let found = cycle.pull_off.as_ref().unwrap().force / expected;
        let error = cycle.errors.unwrap().pull_off_force;
        println!("pull-off {found:.4}, estimated error {error:.3}");
        [found, error]
    }

    /// Johnson, Kendall & Roberts, Proc. R. Soc. A 324, 301 (1971): `F = -3/2 pi w R`; at the first touch `F = -4/3 pi w R`, and
    /// `a^3 = 2 pi w R^2/E*`.
    #[test]
    fn a_sphere_as_johnson_kendall_and_roberts() {
        let unit = PI * WORK * RADIUS;
        for (cells, tolerance) in [(64, 0.06_f64), (128, 0.03)] {
            let system = system(cells, 128e-6 / cells as f64, |_| 0.0);
            let cycle = cycle_to(&system, 0.2e-6);
            let [found, error] = pull_off(&cycle, -1.5 * unit);
            assert!(
                (found - 1.0).abs() < tolerance.min(error),
                "{found} {error}"
            );
            let touch = cycle.load_steps[cycle.first_contact.unwrap()];
            let radius = (2.0 * unit * RADIUS / system.reduced_modulus()).cbrt();
            let ratios = [
                touch.force / (-4.0 / 3.0 * unit),
                (touch.contact_area / PI).sqrt() / radius,
            ];
            assert!(
                ratios.iter().all(|it| (it - 1.0).abs() < 0.05),
                "{ratios:?}"
            );
        }
    }

    /// Kendall, J. Phys. D 4, 1186 (1971): `F = -sqrt(8 pi E* w a^3)`, of a flat pillar under a plate. It detaches where the estimated
    /// stress intensity factor is largest along the edge, so that its pull-off is too small.
    #[test]
    fn a_pillar_as_kendall() {
        let a = 10e-6;
        for cells in [64, 128] {
            let grid = Grid::centred(cells, cells, 32e-6 / cells as f64).unwrap();
            let height = |[x, y]: [f64; 2]| if x.hypot(y) < a { 6e-6 } else { 0.0 };
            let map = HeightMap::from_height(grid, height).unwrap();
            let plate = Indenter::Flat(Some(rubber()));
            let system = SurfaceSystem::new(plate, rubber(), map, Boundary::FreeSpace).unwrap();
            let system = system.with_adhesion(Adhesion::new(WORK)).unwrap();
            let cycle = cycle_to(&system, 0.1e-6);
            assert!((cycle.turn.contact_area / (PI * a * a) - 1.0).abs() < 0.01);
            let kendall = -(8.0 * PI * system.reduced_modulus() * WORK * a.powi(3)).sqrt();
            let [found, _] = pull_off(&cycle, kendall);
            assert!((found - 1.0).abs() < 0.05, "{found}");
        }
    }

    /// Forces on loading end where the force is reached, and the loop of a cycle is the energy that its jumps dissipate: never negative.
    #[test]
    fn forces_are_reached_on_loading() {
        let system = system(64, 2e-6, |[x, y]| {
            0.3e-6 * (x / 15e-6).cos() * (y / 15e-6).cos()
        });
        let run = Run::default();
        for force in [0.0, 50e-6] {
            let contact = system.press(Load::Force(force), &run).unwrap();
            // Reached, or passed in a jump, which is stated.
            let passed = contact.error.unwrap().force * contact.force.abs();
            let difference = contact.force - force;
            assert!(
                difference > -1e-9 && difference < passed + 1e-9,
                "{difference}"
            );
            assert!(passed < 10e-6, "{passed}");
            assert!(contact.pressure.iter().any(|p| *p < 0.0));
        }
        let cycle = cycle_to(&system, 0.2e-6);
        assert!(cycle.loop_area.unwrap() > 0.0);
    }
}
