//! Semismooth Newton method for all pillars of some sites, with exact solutions on each, and for the floor between them.
//!
//! A step [linearizes](super::linearized) the contact at fixed states of the pillars and floor cells, solves for the response of all
//! places, determines the indentation from the [target](Target), and updates the states from the loads by the [rules](super::rules). The
//! iteration ends when no state changes. The derivative of a pillar's solution is the `P` of its linearized state, so that this is Newton's
//! method on the solutions of all pillars.

use super::control::Target;
use super::floor::{
    Discs, FloorDisplacement, FloorPoint, FloorSearch, LoadedDiscs, Surroundings, Uncovered,
};
use super::linearized::{LinearizedContact, Response, Source};
use super::rules::floor::{FloorCells, Places};
use super::rules::groups::{GroupedTops, Groups};
use super::rules::tops::{COSTLY_PILLARS, Change, Tops};
use super::rules::unilateral::{LocalSolver, PillarTop};
use crate::halfspace::coupling::copies::Copies;
use crate::halfspace::coupling::lattice::LatticeCoupling;
use crate::halfspace::coupling::operator::Coupling;
use crate::halfspace::coupling::pair::PairCoupling;
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::disc::basis::UNIT_FORCE;
use crate::halfspace::disc::exterior::Exterior;
use crate::halfspace::disc::nodes::Resolution;
use crate::halfspace::floor::coupling::{FloorCoupling, FloorKernels, SurfaceCoupling};
use crate::halfspace::floor::grid::FloorGrid;
use crate::halfspace::floor::load::FloorLoad;
use crate::numerics::convergence::{Judgement, clamped, judge, larger, within};
use crate::problem::layer::WeightedLayer;
use crate::problem::scaled::Scene;
use crate::problem::{Load, Point};
use crate::state::{PillarStatus, Progress, Run, SolveError, Stage, Termination};
use std::sync::Arc;

/// Relative energy of the residual at which a linear solution counts as exact.
pub(super) const LINEAR_TOLERANCE: f64 = 1e-10;

/// If products are inexact, fraction of their error that a linear solution may add.
const PART_OF_PRODUCTS: f64 = 0.2;

/// The same with the floor, and on a coarse grid of the floor.
pub(super) const FLOOR_LINEAR_TOLERANCE: f64 = 1e-9;
const LEVEL_LINEAR_TOLERANCE: f64 = 1e-6;

/// Tolerance of the first linear solution with the floor, and the factor by which it decreases from step to step: the residual caused by
/// cells that change in a step is about a tenth of that before.
const FLOOR_FIRST_TOLERANCE: f64 = 5e-3;
const FLOOR_DECREASE: f64 = 0.1;

/// The same factor after steps with few changes: at most one in this many of the places that carry pressure.
const FLOOR_FAST_DECREASE: f64 = 0.01;
const FLOOR_FEW: usize = 100;

/// The same factor without the floor.
const DECREASE: f64 = 0.03;

/// Tolerance below which a floor share can be met: the set of loaded cells is then sufficiently accurate.
const SHARE_TOLERANCE: f64 = 1e-4;

/// Largest tolerance of the response to a unit indentation with a floor share as the target, which depends on the derivatives of both floor
/// force and top force.
const SHARE_UNIT_TOLERANCE: f64 = 5e-3;

/// Lower bound of the tolerance after a step to a floor share, as a fraction of the relative change of the indentation.
const PART_OF_CHANGE: f64 = 0.01;

/// On a coarse grid, a few places may still change their state at the end: at most one in this many of those that carry pressure.
const LEVEL_CHANGES: usize = 200;

/// Approximate relative error of the indentation from the punch lattice.
const START_ERROR: f64 = 0.02;

/// A start is sufficient if a step changes the status of at most one pillar in this many; or of one in this many, or of two pillars, if the
/// step changes at least as many as an earlier one: pillars at the edge may alternate between touched and untouched.
const START_CHANGES: usize = 300;
const STALLED_CHANGES: usize = 100;

/// Largest tolerance of the response to a unit indentation.
const UNIT_TOLERANCE: f64 = 1e-2;

/// Tolerance of the first linear solution, when the statuses are still a guess, and of a start.
const FIRST_LINEAR_TOLERANCE: f64 = 1e-3;

/// Largest difference between the local and the global solution on any pillar, relative to the largest coefficient.
pub(crate) const MISMATCH_TOLERANCE: f64 = 1e-7;

/// Tolerance of the linear solutions and of the difference on any pillar, for a solution that is differentiated, and the largest number of
/// steps to reach it. On narrow contacts at rims a step reduces the difference by two digits.
const SHARP_TOLERANCE: f64 = 1e-12;
const SHARP_STEPS: usize = 6;

/// Relative difference of contact indentations below which two floor points count as equally low.
const FLOOR_TOLERANCE: f64 = 1e-10;

/// Largest number of Newton steps. One to six are typical, up to eleven with the floor.
const STEP_LIMIT: usize = 60;

/// Result of a Newton solution.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Outcome {
    pub(crate) indentation: f64,
    pub(crate) termination: Termination,
    pub(crate) steps: usize,
    /// Lowest point of the floor, if it determined the indentation.
    pub(crate) floor: Option<FloorPoint>,
    /// Largest difference between local and global coefficients, relative to the largest coefficient.
    pub(crate) mismatch: f64,
}

/// Purpose of a solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// A result.
    Answer,
    /// The start of another solution.
    Start,
    /// The contact with the floor on a coarse grid: start of the next grid, and compared with it.
    Level,
}

/// Degrees of the discretisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Degrees {
    /// Degree of the modes by which pillars interact.
    pub(crate) coupling: usize,
    /// Resolution of the unilateral condition.
    pub(crate) tops: Resolution,
}

/// Tolerances of the linear problems of a step: no more exact than the current states justify.
struct Tolerances {
    present: f64,
    /// Tolerance at which a step is exact.
    exact: f64,
    /// Smallest tolerance required at the end.
    finest: f64,
    /// Factors by which the tolerance decreases after a step, and after a step with few changes.
    decrease: f64,
    fast_decrease: f64,
    /// Smallest number of state changes in any step so far.
    fewest: usize,
    /// Relative change of the indentation; 1 for a start without any information.
    change_of_indentation: f64,
}

impl Tolerances {
    /// `of_products` is their relative error.
    fn new(purpose: Purpose, with_floor: bool, indentation: f64, of_products: f64) -> Self {
        let exact = match purpose {
            Purpose::Answer if with_floor => FLOOR_LINEAR_TOLERANCE,
            Purpose::Answer | Purpose::Start => LINEAR_TOLERANCE,
            Purpose::Level => LEVEL_LINEAR_TOLERANCE,
        };
        let exact = exact.max(PART_OF_PRODUCTS * of_products);
        let [present, decrease, fast_decrease] = if with_floor {
            [FLOOR_FIRST_TOLERANCE, FLOOR_DECREASE, FLOOR_FAST_DECREASE]
        } else {
            [FIRST_LINEAR_TOLERANCE, DECREASE, DECREASE]
        };
        Self {
            present,
            decrease,
            fast_decrease,
            exact,
            finest: match purpose {
                Purpose::Answer | Purpose::Level => exact,
                Purpose::Start => FIRST_LINEAR_TOLERANCE,
            },
            fewest: usize::MAX,
            change_of_indentation: if indentation > 0.0 { START_ERROR } else { 1.0 },
        }
    }

    /// Tolerance of the response to a unit indentation, which is multiplied by the change of the indentation.
    fn unit(&self) -> f64 {
        let unit = self.present / self.change_of_indentation;
        clamped(unit, self.present, UNIT_TOLERANCE)
    }

    /// Whether a step with these tolerances, and `unit` for the unit response, is exact.
    fn are_exact(&self, unit: f64) -> bool {
        within(self.present, self.exact) && within(unit * self.change_of_indentation, self.exact)
    }

    /// Requires exact responses. Returns whether they were inexact before.
    fn sharpen(&mut self) -> bool {
        let rough = self.present > self.exact;
        (self.finest, self.present) = (self.exact, self.exact);
        self.change_of_indentation = 1.0;
        rough
    }

    /// Tolerance of a step during which many states change.
    fn widen(&mut self) {
        let of_change = PART_OF_CHANGE * self.change_of_indentation;
        self.present = self.present.max(of_change.min(FLOOR_FIRST_TOLERANCE));
    }

    /// Tolerance after a step with this many changes of state, given the number of places that carry pressure.
    fn follow(&mut self, changes: usize, loaded_cells: usize) {
        let decrease = if changes == 0 {
            0.0
        } else if changes < self.fewest && changes * FLOOR_FEW <= loaded_cells {
            self.fast_decrease
        } else {
            self.decrease
        };
        self.fewest = self.fewest.min(changes);
        self.present = (decrease * self.present).max(self.finest);
    }
}

/// Distance beyond the touched pillars within which pillars are coupled with the floor, in pitches.
const REACH_MARGIN: f64 = 1.0;

/// Distance from the limit of coupled pillars at which the contact counts as close to it, in pitches.
const NEAR_REACH: f64 = 0.5;

/// Degree of the pillar modes that are coupled with the floor: degree 3 changes the force by 7e-8, even if the floor is touched 0.6 pillar
/// radii from a rim.
pub(crate) const FLOOR_DEGREE: usize = 2;

/// All pillars of some sites, and the floor if it is touched, with their states and responses.
pub(crate) struct Newton<'a> {
    pub(crate) scene: Scene,
    pub(crate) run: &'a Run<'a>,
    stage: Stage,
    pub(crate) tops: Tops,
    /// The floor cells; `None` as long as the floor is not touched or is ignored.
    pub(crate) cells: Option<FloorCells<'a>>,
    pub(crate) contact: LinearizedContact<'a, SurfaceCoupling<'a>>,
    /// Pillars up to this distance from the lens axis are coupled with the floor.
    reach: f64,
    /// Kernels of the last floor grid.
    kernels: Option<FloorKernels>,
    pub(crate) exterior: Exterior,
    /// Symmetric images among the pillars, if any.
    pub(crate) copies: Option<Copies>,
    floor: FloorSearch,
}

impl<'a> Newton<'a> {
    /// All pillars of the sites untouched.
    pub(crate) fn new(
        scene: &Scene,
        run: &'a Run<'a>,
        stage: Stage,
        sites: Sites,
        pair: &PairCoupling,
        top: Arc<PillarTop>,
    ) -> Self {
        let degree = pair.modes().last().map_or(0, |mode| mode.degree);
        let tops = Tops::new(&scene.lens, sites, top, degree);
        let copies = Copies::of(scene.symmetries(), &tops.sites);
        let own_load = tops.lens_load(copies.as_ref(), run.workers());
        run.report(Progress {
            stage: Stage::Coupling,
            step: 0,
            pillars: tops.sites.len(),
            touched: 0,
        });
        let coupling = LatticeCoupling::of_sites(&tops.sites, pair, run.workers());
        let coupling = SurfaceCoupling::of_tops(coupling);
        Self {
            scene: scene.clone(),
            run,
            stage,
            cells: None,
            reach: 0.0,
            kernels: None,
            contact: LinearizedContact::new(run, coupling, pair.modes().len(), own_load),
            tops,
            exterior: Exterior::new(degree).with_layers(&scene.layers, &scene.field.radii()),
            copies,
            floor: FloorSearch::default(),
        }
    }

    /// Restricts the load to the lens height at the pillar centres instead of the average over each top.
    pub(crate) fn load_at_centres(&mut self) {
        let modes = self.contact.modes();
        let loads = self.contact.own_load_mut().chunks_exact_mut(modes);
        for (centre, load) in self.tops.sites.centres().iter().zip(loads) {
            load.fill(0.0);
            load[0] = -UNIT_FORCE * self.scene.lens.sag_with_brim(*centre);
        }
    }

    /// Iterates from the current states until the contact conditions are satisfied; for a start, on most pillars.
    pub(crate) fn solve(
        &mut self,
        target: impl Into<Target>,
        purpose: Purpose,
    ) -> Result<Outcome, SolveError> {
        let target = target.into();
        let mut tolerances = Tolerances::new(
            purpose,
            self.cells.is_some(),
            self.contact.indentation(),
            self.contact.coupling().error(),
        );
        let mut outcome = Outcome {
            indentation: self.contact.indentation(),
            termination: Termination::IterationLimit,
            steps: 0,
            floor: None,
            mismatch: f64::INFINITY,
        };
        for step in 1..=STEP_LIMIT {
            outcome.steps = step;
            self.run.check_cancelled()?;
            self.report(step);
            let unit_tolerance = match target {
                Target::Prescribed(_) => tolerances.unit(),
                Target::FloorShare { .. } => tolerances.unit().min(SHARE_UNIT_TOLERANCE),
            };
            let target = if tolerances.present > SHARE_TOLERANCE {
                target.at_first(self.contact.indentation())
            } else {
                target
            };
            let solved = self.respond(target, tolerances.present, unit_tolerance)?;
            if let Some(failure) = failure(solved) {
                outcome.termination = failure;
                return Ok(outcome);
            }
            let Some((indentation, floor)) = self.close(target) else {
                // A response to three digits may make the floor recede from the lens although the exact one does not.
                if tolerances.sharpen() {
                    continue;
                }
                outcome.termination = Termination::Stagnated;
                return Ok(outcome);
            };
            let before = self.contact.indentation();
            // The indentation may be zero if some pillars are higher than the common level.
            let change = if (indentation - before).abs() <= 0.0 {
                0.0
            } else {
                indentation / before - 1.0
            };
            tolerances.change_of_indentation = change.abs().clamp(1e-12, 1.0);
            self.contact.move_to(indentation);
            (outcome.indentation, outcome.floor) = (indentation, floor);
            let change = self.update();
            self.run.check_cancelled()?;
            outcome.mismatch = change.mismatch;
            let exact = tolerances.are_exact(unit_tolerance);
            if let Some(ending) =
                self.ending(target, purpose, exact, tolerances.fewest, &change, &outcome)
            {
                outcome.termination = ending;
                return Ok(outcome);
            }
            tolerances.follow(change.places(), self.touched() + self.pressed());
            if let Target::FloorShare { .. } = target {
                tolerances.widen();
            }
        }
        Ok(outcome)
    }

    /// Continues from a solution until only rounding errors are left. Returns whether no place changed its state in the last step.
    pub(crate) fn sharpen(
        &mut self,
        target: impl Into<Target>,
        outcome: &mut Outcome,
    ) -> Result<bool, SolveError> {
        let target = target.into();
        let mut settled = false;
        for _ in 0..SHARP_STEPS {
            self.run.check_cancelled()?;
            let solved = self.respond(target, SHARP_TOLERANCE, SHARP_TOLERANCE)?;
            let closed = self.close(target);
            let (Judgement::Good, Some((indentation, floor))) = (solved, closed) else {
                return Ok(false);
            };
            self.contact.move_to(indentation);
            (outcome.indentation, outcome.floor) = (indentation, floor);
            let change = self.update();
            outcome.mismatch = change.mismatch;
            settled = change.places() == 0;
            if settled && within(change.mismatch, SHARP_TOLERANCE) {
                break;
            }
        }
        Ok(settled)
    }

    /// Decides whether and how the iteration ends after a step, given the smallest number of changes in any earlier step.
    fn ending(
        &mut self,
        target: Target,
        purpose: Purpose,
        exact: bool,
        fewest: usize,
        change: &Change,
        outcome: &Outcome,
    ) -> Option<Termination> {
        if purpose == Purpose::Start {
            let few = (self.touched() / STALLED_CHANGES).max(2);
            let stalled = change.pillars <= few && change.places() >= fewest;
            if stalled || change.pillars * START_CHANGES <= self.touched() {
                return Some(Termination::Converged);
            }
        }
        if purpose == Purpose::Level
            && exact
            && change.places() * LEVEL_CHANGES <= self.touched() + self.pressed()
        {
            return Some(match judge(change.mismatch, 1.0) {
                Judgement::Undefined => Termination::NotFinite,
                _ => Termination::Converged,
            });
        }
        match judge(change.mismatch, MISMATCH_TOLERANCE) {
            Judgement::Undefined => return Some(Termination::NotFinite),
            Judgement::TooLarge => return None,
            Judgement::Good => {}
        }
        if change.places() > 0 || !exact || self.found_lower_floor(outcome) {
            return None;
        }
        let met = target.is_met(&self.contact, MISMATCH_TOLERANCE);
        Some(if change.failures == 0 && met {
            Termination::Converged
        } else {
            Termination::Stagnated
        })
    }

    /// Solves for the responses at the current states.
    fn respond(
        &mut self,
        target: Target,
        tolerance: f64,
        unit_tolerance: f64,
    ) -> Result<Judgement, SolveError> {
        let mut groups = Groups::new(&self.tops, self.run.workers());
        if let Some(indentation) = target.indentation() {
            self.contact.move_to(indentation);
        } else {
            let solved = self.solve_frozen(Source::Unit, unit_tolerance, groups.as_mut())?;
            if solved != Judgement::Good {
                return Ok(solved);
            }
        }
        self.solve_frozen(Source::Present, tolerance, groups.as_mut())
    }

    /// Solves for a response at fixed states, with given groups.
    fn solve_frozen(
        &mut self,
        source: Source<'_>,
        tolerance: f64,
        groups: Option<&mut Groups>,
    ) -> Result<Judgement, SolveError> {
        let mut places = Places {
            tops: GroupedTops::new(&self.tops, groups),
            floor: self.cells.as_mut(),
        };
        self.contact.solve(&mut places, source, tolerance)
    }

    /// The indentation that meets the target with the current responses.
    fn close(&mut self, target: Target) -> Option<(f64, Option<FloorPoint>)> {
        let reaches = target == Target::Prescribed(Load::FloorContact);
        let lowest = reaches.then(|| self.search_floor(true)).flatten();
        target.close(&self.contact, lowest)
    }

    /// Updates the states of the pillars and floor cells from the current loads.
    fn update(&mut self) -> Change {
        let incident = self.contact.incident();
        let coefficients = self.contact.coefficients();
        let bounded = self.cells.is_some() && self.scene.layers.is_empty();
        let farthest = bounded.then_some(self.reach);
        let workers = self.run.workers();
        let copies = self.copies.as_ref();
        let tops = &mut self.tops;
        let mut change = tops.update(&incident, coefficients, farthest, copies, workers);
        if let Some(cells) = &mut self.cells {
            let contact = &self.contact;
            let of_floor = cells.update(
                contact.floor_load(),
                contact.floor_coefficients(),
                contact.indentation(),
            );
            change.cells = of_floor.cells;
            change.mismatch = larger(change.mismatch, of_floor.mismatch);
        }
        change
    }

    /// Replaces the floor cells by those of another grid; `start` returns the pressure at a point under the current load and at unit
    /// indentation. If it is zero everywhere, all cells that the lens would penetrate carry pressure.
    pub(crate) fn set_floor(&mut self, grid: FloorGrid, start: &dyn Fn(Point) -> [f64; 2]) {
        let (run, modes) = (self.run, self.contact.modes());
        let mut cells = FloorCells::new(grid, run.pool);
        let unit_cell = cells.unit_cell();
        let centres: Vec<Point> = cells.grid.cells.centres().collect();
        let coefficients = |cell: usize| start(centres[cell]).map(|pressure| unit_cell * pressure);
        self.reach = self.pillar_reach();
        let (sites, reach) = (&self.tops.sites, self.reach);
        let degree = FLOOR_DEGREE.min(self.exterior.degree());
        let (kernels, layers) = (&mut self.kernels, &self.scene.layers[..]);
        let couple = |coupling: &mut SurfaceCoupling<'a>| {
            let threads = (run.workers(), run.pool);
            let (pillars, modes) = ((sites, reach), [modes, degree]);
            coupling.lay_floor(&cells.grid, pillars, modes, layers, kernels, threads);
        };
        let own_load = cells.lens_load(&self.scene);
        self.contact
            .set_floor(unit_cell, own_load, coefficients, couple);
        cells.set(self.contact.floor_coefficients().iter().map(|c| *c > 0.0));
        if !cells.loaded().contains(&true) {
            cells.set(self.contact.floor_load().map(|load| load > 0.0));
        }
        self.cells = Some(cells);
    }

    /// Distance of pillar centres from the lens axis up to which pillars are coupled with the floor: the touched ones plus a margin.
    ///
    /// Pillars beyond are not touched: on half-spaces floor pressure only moves the lens away from them. Without the coupling, however,
    /// they would appear to be touched as the floor takes load from the tops within. A thin layer rises around the contact, but first at
    /// the pillars next to the touched ones.
    ///
    /// If no pillar is touched yet: the depth of the undeformed lens below the tops, with a margin for the indentation if it is unknown.
    pub(crate) fn pillar_reach(&self) -> f64 {
        if self.touched() > 0 {
            let reach = self.tops.reach() + REACH_MARGIN * self.scene.field.spacing();
            // High pillars beyond lower ones may attach and detach as the floor grid changes.
            return if self.scene.field.has_unlike_heights() {
                reach.max(self.reach)
            } else {
                reach
            };
        }
        let depth = 1.1 * self.contact.indentation();
        self.scene.farthest_reached(depth)
    }

    /// Whether pillars are touched that are not coupled with the floor, or may be because the contact is close to them.
    pub(crate) fn touches_beyond_reach(&self) -> bool {
        let near = if self.scene.layers.is_empty() {
            NEAR_REACH * self.scene.field.spacing()
        } else {
            0.0
        };
        self.cells.is_some() && self.touched() > 0 && self.tops.reach() > self.reach - near
    }

    /// `v·B m` of the coefficients `m` and several `v` of the floor, as [`FloorCoupling::forms`], with all distances from the lens axis multiplied
    /// by a factor, and on other layers. Empty without floor cells.
    pub(crate) fn floor_forms(
        &self,
        factor: f64,
        layers: &[WeightedLayer],
        with: &[&[f64]],
    ) -> Vec<[f64; 2]> {
        let Some(cells) = &self.cells else {
            return Vec::new();
        };
        let (grid, sites) = (
            cells.grid.stretched(factor),
            self.tops.sites.stretched(factor),
        );
        let degree = FLOOR_DEGREE.min(self.exterior.degree());
        let mut coupling = FloorCoupling::undivided(
            &grid,
            (&sites, self.reach * factor),
            [self.contact.modes(), degree],
            layers,
            (self.run.workers(), self.run.pool),
        );
        coupling.forms(self.contact.coefficients(), with)
    }

    /// The pressure on the floor, where it is loaded.
    pub(crate) fn floor_load(&self) -> Option<FloorLoad> {
        let cells = self.cells.as_ref()?;
        let scale = cells.unit_cell().recip();
        let pressures = cells.loaded().iter().zip(self.contact.floor_coefficients());
        let pressure: Vec<f64> = pressures
            .filter_map(|(loaded, c)| loaded.then_some(c.max(0.0) * scale))
            .collect();
        (!pressure.is_empty())
            .then(|| FloorLoad::new(cells.loaded_cells(), pressure).with_layers(&self.scene.layers))
    }

    /// Whether a search from scratch finds a lower point of the floor than the one that closed the last step. If so, the next step starts
    /// from it.
    fn found_lower_floor(&mut self, outcome: &Outcome) -> bool {
        let Some(present) = outcome.floor else {
            return false;
        };
        self.floor.forget();
        self.search_floor(true).is_some_and(|lowest| {
            lowest.indentation < present.indentation * (1.0 - FLOOR_TOLERANCE)
        })
    }

    fn report(&self, step: usize) {
        let stage = if self.cells.is_some() {
            Stage::Floor
        } else {
            self.stage
        };
        self.run.report(Progress {
            stage,
            step,
            pillars: self.tops.sites.len(),
            touched: self.touched(),
        });
    }

    /// Number of touched pillars.
    pub(crate) fn touched(&self) -> usize {
        self.tops.touched()
    }

    /// Number of floor cells that carry pressure.
    pub(crate) fn pressed(&self) -> usize {
        let cells = self.cells.as_ref();
        cells.map_or(0, |cells| cells.loaded().iter().filter(|b| **b).count())
    }

    /// Force at the solved indentation.
    pub(crate) fn force(&self) -> f64 {
        self.contact.force()
    }

    /// Degree of the coupling.
    pub(crate) fn degree(&self) -> usize {
        self.exterior.degree()
    }

    /// Degree of the interaction of two pillars, as a function of their gap in units of the smaller radius.
    pub(crate) fn pair_degree(&self, gap: f64) -> usize {
        self.contact.coupling().tops.pair_degree(gap, self.degree())
    }

    /// Releases the memory of the coupling. Afterwards this can only serve as the start of another solution.
    pub(crate) fn release_coupling(&mut self) {
        self.contact.coupling_mut().tops = LatticeCoupling::Released;
    }

    /// Whether the touched status of a pillar depends on the part of the lens shape that the modes of the coupling omit.
    pub(crate) fn has_marginal_pillars(&self) -> bool {
        let incident = self.contact.incident();
        self.tops
            .has_marginal_pillars(&incident, self.run.workers())
    }

    /// Mean displacement required of a pillar top, as under a flat punch.
    pub(crate) fn mean_load(&self, pillar: usize) -> f64 {
        let mut load = vec![0.0; self.contact.modes()];
        self.contact.load(pillar, &mut load);
        load[0] / UNIT_FORCE
    }

    /// Load on a pillar with all modes of the lens shape over its top.
    pub(crate) fn full_load(&self, pillar: usize) -> Vec<f64> {
        let incident = self.contact.incident();
        self.tops.full_load(&incident, pillar)
    }

    /// All coefficients of a partially touched pillar.
    pub(crate) fn partial_coefficients(&self, pillar: usize, solver: &mut LocalSolver) -> Vec<f64> {
        self.tops
            .partial_coefficients(pillar, &self.full_load(pillar), solver)
    }

    /// Coefficients of the gap over a pillar top, `Lam c - b`.
    pub(crate) fn gap_coefficients(&self, pillar: usize, coefficients: &[f64]) -> Vec<f64> {
        let incident = self.contact.incident();
        self.tops.gap_coefficients(&incident, pillar, coefficients)
    }

    /// Solves for the response to a unit indentation at the current states, to the given tolerance.
    pub(crate) fn solve_unit(&mut self, tolerance: f64) -> Result<bool, SolveError> {
        let mut groups = Groups::new(&self.tops, self.run.workers());
        let solved = self.solve_frozen(Source::Unit, tolerance, groups.as_mut())?;
        Ok(solved == Judgement::Good)
    }

    /// Response of all places to a given load, with their states linearized.
    pub(crate) fn respond_to(
        &mut self,
        load: &[f64],
        tolerance: f64,
    ) -> Result<Response, SolveError> {
        let mut groups = Groups::new(&self.tops, self.run.workers());
        let mut places = Places {
            tops: GroupedTops::new(&self.tops, groups.as_mut()),
            floor: self.cells.as_mut(),
        };
        self.contact.respond_to(&mut places, load, tolerance)
    }

    /// `W(x)` of every pillar: displacement of a point of the floor per unit coefficient.
    pub(crate) fn point_load(&self, position: Point) -> Vec<f64> {
        let modes = self.contact.modes();
        let mut load = vec![0.0; self.tops.sites.len() * modes];
        let one = |(): &mut (), pillar: usize, load: &mut [f64]| {
            self.values_at(&self.exterior, pillar, position, load);
        };
        self.run
            .workers()
            .fill(&mut load, modes, COSTLY_PILLARS, || (), one);
        load
    }

    /// Displacement of a point beside a pillar by each moment of the pillar.
    pub(crate) fn values_at(
        &self,
        exterior: &Exterior,
        pillar: usize,
        position: Point,
        values: &mut [f64],
    ) {
        let (centre, radius) = (
            self.tops.sites.centres()[pillar],
            self.tops.sites.body(pillar).radius,
        );
        let at = [0, 1].map(|k| (position[k] - centre[k]) / radius);
        exterior.values(at, radius, values);
        values.iter_mut().for_each(|value| *value /= radius);
    }

    /// The indentation at which the floor would just be reached if the pillars kept their states.
    pub(crate) fn first_floor_contact(
        &mut self,
        tolerance: f64,
    ) -> Result<Option<f64>, SolveError> {
        let solved = self.solve_unit(tolerance)?;
        let lowest = solved.then(|| self.search_floor(true)).flatten();
        Ok(lowest.map(|point| point.indentation))
    }

    /// The point of the smallest floor gap at the solved indentation, with the gap plus the indentation.
    pub(crate) fn lowest_gap(&mut self) -> Option<FloorPoint> {
        self.search_floor(false)
    }

    /// The lowest point of the floor under pressures that change with the indentation or are constant.
    fn search_floor(&mut self, with_indentation: bool) -> Option<FloorPoint> {
        let mut floor = std::mem::take(&mut self.floor);
        let lowest = self.with_loaded(with_indentation, |discs| {
            floor.lowest(&self.uncovered(), discs, &self.run.cancel)
        });
        self.floor = floor;
        lowest
    }

    /// The floor beside the pillars, and the lens above it.
    fn uncovered(&self) -> Uncovered<'_> {
        Uncovered {
            lens: self.scene.lens.clone(),
            height: self.scene.height,
            around: Surroundings::of_sites(
                &self.tops.sites,
                self.scene.field.spacing(),
                self.tops.reach(),
            ),
        }
    }

    /// The touched pillars, each with its force.
    pub(crate) fn forces(&self) -> Vec<(Point, f64)> {
        let modes = self.contact.modes();
        let moments = self.contact.coefficients().chunks_exact(modes);
        let centres = self.tops.sites.centres().iter();
        let all = centres.zip(moments).zip(&self.tops.status);
        all.filter(|(_, status)| **status != PillarStatus::Untouched)
            .map(|((centre, moments), _)| (*centre, UNIT_FORCE * moments[0]))
            .collect()
    }

    /// Floor gaps at points beside pillars, under the pressures on the pillars and on the [floor](Self::floor_load). The latter are summed
    /// in groups; setting these up takes longer than the evaluation of many points.
    pub(crate) fn gaps(&self, points: &[Point], floor: Option<&FloorLoad>) -> Vec<f64> {
        let mut gaps = self.gaps_under_tops(points);
        if let Some(load) = floor {
            for (gap, point) in gaps.iter_mut().zip(points) {
                *gap += load.displacement(*point);
            }
        }
        gaps
    }

    /// Floor gaps at points beside pillars, under the pressures on the pillars alone.
    pub(crate) fn gaps_under_tops(&self, points: &[Point]) -> Vec<f64> {
        let above = self.scene.height - self.contact.indentation();
        self.with_loaded(false, |discs| {
            let gap = |point: &Point| {
                let [_, displacement] = discs.displacement(*point);
                above + self.scene.lens.sag_with_brim(*point) + displacement.value
            };
            points.iter().map(gap).collect()
        })
    }

    /// Passes the loads on the touched pillars as discs to a function: with pressures that change with the indentation, or constant ones.
    fn with_loaded<R>(&self, with_indentation: bool, ask: impl FnOnce(&LoadedDiscs<'_>) -> R) -> R {
        let modes = self.contact.modes();
        let sites = &self.tops.sites;
        let radius = |pillar: usize| sites.body(pillar).radius;
        let touched: Vec<usize> = (0..sites.len())
            .filter(|&p| self.tops.status[p] != PillarStatus::Untouched)
            .collect();
        let ([present, unit], indentation) = (self.contact.parts(), self.contact.indentation());
        let of_area = |disc: usize, mode: usize, moments: &[f64]| {
            moments[touched[disc] * modes + mode] / radius(touched[disc]).powi(2)
        };
        let along = |disc: usize, mode: usize| of_area(disc, mode, unit);
        let all = |disc: usize, mode: usize| of_area(disc, mode, present);
        let without = |disc: usize, mode: usize| all(disc, mode) - indentation * along(disc, mode);
        let discs = LoadedDiscs {
            exterior: &self.exterior,
            discs: Discs::new(
                [touched.len(), modes],
                |disc| sites.centres()[touched[disc]],
                |disc| radius(touched[disc]),
                if with_indentation {
                    [Some(&along), Some(&without)]
                } else {
                    [None, Some(&all)]
                },
            ),
            run: self.run,
        };
        ask(&discs)
    }

    /// The same on other sites and with other degrees, without the floor cells.
    pub(crate) fn rebuilt(&self, sites: Sites, degrees: Degrees) -> Self {
        let Degrees { coupling, tops } = degrees;
        let pair = PairCoupling::of_scene(coupling, &self.scene);
        let top = PillarTop::shared(tops, coupling, sites.common_body().column);
        let mut rebuilt = Self::new(&self.scene, self.run, self.stage, sites, &pair, top);
        rebuilt.kernels.clone_from(&self.kernels);
        rebuilt.reach = self.reach;
        rebuilt.start_from(self);
        rebuilt
    }

    /// Current degrees.
    pub(crate) fn degrees(&self) -> Degrees {
        Degrees {
            coupling: self.degree(),
            tops: self.tops.top.resolution(),
        }
    }

    /// Takes statuses and leading coefficients of full contact from a coarser solution.
    pub(crate) fn start_from(&mut self, coarse: &Self) {
        self.tops.start_from(&coarse.tops);
        self.floor = coarse.floor.clone();
        self.floor.forget_if_quick();
        let modes = coarse.contact.modes();
        let sites = &self.tops.sites;
        self.contact
            .start_from(coarse.contact.indentation(), |pillar| {
                let from = coarse.tops.sites.find(sites.index(pillar))?;
                let range = from * modes..(from + 1) * modes;
                Some(coarse.contact.parts().map(|part| &part[range.clone()]))
            });
    }
}

/// How the iteration ends if a linear problem could not be solved.
fn failure(solved: Judgement) -> Option<Termination> {
    match solved {
        Judgement::Good => None,
        Judgement::TooLarge => Some(Termination::Stagnated),
        Judgement::Undefined => Some(Termination::NotFinite),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::problem::pillar_field::PillarField;
    use crate::problem::{PillarCompliance, PunchForm};
    use crate::solve::spectral::solve_punch;
    use crate::theory::reference;

    /// The paper's rubber pillars, with the lens axis beside one of them.
    pub(crate) fn problem() -> Scene {
        let lattice = reference::lattice(0.03).offset_by(0.2);
        let compliance = PillarCompliance::Column;
        let rubber = reference::INTERMEDIATE;
        Scene::new(&reference::on_lattice(lattice, rubber, compliance))
    }

    fn newton<'a>(scene: &Scene, run: &'a Run<'a>) -> Newton<'a> {
        let pitch = scene.field.spacing();
        let pair = PairCoupling::new(2);
        let sites = Sites::within(&scene.field, 3.0 * pitch);
        let resolution = Resolution {
            nodes: 8,
            turn: 0.0,
            rings: 10,
        };
        let top = PillarTop::shared(resolution, 2, scene.field.column());
        let mut newton = Newton::new(scene, run, Stage::Spectral, sites, &pair, top);
        newton.tops.touch_within(0.9 * pitch);
        newton
    }

    const TARGETS: [Load; 3] = [Load::Indentation(0.3), Load::Force(0.3), Load::FloorContact];

    /// One NaN or infinite value in the data, on any pillar, touched or not, in any mode.
    #[test]
    fn undefined_loads_never_converge() {
        let (problem, run) = (problem(), Run::default());
        for target in TARGETS {
            let outcome = newton(&problem, &run).solve(target, Purpose::Answer);
            assert_eq!(outcome.unwrap().termination, Termination::Converged);
        }
        let size = newton(&problem, &run).contact.own_load_mut().len();
        for place in (0..size).step_by(5) {
            for target in TARGETS {
                let mut newton = newton(&problem, &run);
                newton.contact.own_load_mut()[place] = f64::NAN;
                let outcome = newton.solve(target, Purpose::Answer).unwrap();
                assert_ne!(
                    outcome.termination,
                    Termination::Converged,
                    "{place} {target:?}"
                );
            }
        }
    }

    /// Expected: every narrow contact at a rim solved separately, on a lattice with twelve symmetries about the lens axis.
    #[test]
    fn images_of_narrow_contacts_are_what_they_are_alone() {
        let lattice = reference::lattice(0.03);
        let (rubber, compliance) = (reference::INTERMEDIATE, PillarCompliance::Column);
        let scene = Scene::new(&reference::on_lattice(lattice, rubber, compliance));
        let run = Run::default();
        let mut compared = 0;
        for step in 0..12 {
            let target = Load::Indentation(0.25 + 0.01 * f64::from(step));
            let [with, alone] = [true, false].map(|with| {
                let mut newton = newton(&scene, &run);
                assert!(
                    newton
                        .copies
                        .as_ref()
                        .is_some_and(|copies| copies.symmetries().len() == 12)
                );
                newton.copies = newton.copies.filter(|_| with);
                let outcome = newton.solve(target, Purpose::Answer).unwrap();
                assert_eq!(outcome.termination, Termination::Converged);
                newton
            });
            compared += alone.tops.rim_contacts().count();
            assert_eq!(with.tops.partial_states(), alone.tops.partial_states());
            let [found, expected] = [&with, &alone].map(|newton| newton.contact.coefficients());
            let scale = expected.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
            for (found, expected) in found.iter().zip(expected) {
                assert!(
                    (found - expected).abs() < 1e-9 * scale,
                    "{found} {expected}"
                );
            }
        }
        assert!(compared >= 12, "{compared}");
    }

    /// Pillar heights change only the load of the lens shape: if all are raised by the same amount, they are touched earlier by that
    /// amount, and a single raised pillar carries the corresponding additional load.
    #[test]
    fn heights_are_a_shift_of_the_own_load() {
        let (problem, run) = (problem(), Run::default());
        let raise = |newton: &mut Newton<'_>, by: &dyn Fn(usize) -> f64| {
            let modes = newton.contact.modes();
            let loads = newton.contact.own_load_mut().chunks_exact_mut(modes);
            for (pillar, load) in loads.enumerate() {
                load[0] += UNIT_FORCE * by(pillar);
            }
        };
        let force = |indentation: f64, by: &dyn Fn(usize) -> f64| {
            let mut newton = newton(&problem, &run);
            raise(&mut newton, by);
            let target = Load::Indentation(indentation);
            let outcome = newton.solve(target, Purpose::Answer).unwrap();
            assert_eq!(outcome.termination, Termination::Converged);
            newton.force()
        };
        let level = force(0.3, &|_| 0.0);
        let all_higher = force(0.25, &|_| 0.05);
        assert!(
            (all_higher / level - 1.0).abs() < 1e-9,
            "{all_higher} {level}"
        );
        let window = newton(&problem, &run).tops.sites;
        let distance = |pillar: &usize| {
            let [x, y] = window.centres()[*pillar];
            x.hypot(y)
        };
        let nearest = (0..window.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let one_higher = |by: f64| {
            force(0.3, &|pillar| {
                if Some(pillar) == nearest { by } else { 0.0 }
            })
        };
        assert!(level < one_higher(0.05) && one_higher(0.05) < one_higher(0.1));
    }

    #[test]
    fn undefined_starts_never_converge() {
        let (problem, run) = (problem(), Run::default());
        for target in TARGETS {
            for odd in [f64::NAN, f64::INFINITY] {
                let mut newton = newton(&problem, &run);
                newton.contact.present.far[3] = odd;
                newton.contact.unit.far[3] = odd;
                let outcome = newton.solve(target, Purpose::Answer).unwrap();
                assert_eq!(outcome.termination, Termination::NotFinite, "{target:?}");
            }
        }
    }

    #[test]
    fn undefined_targets_and_pillars_never_converge() {
        let run = Run::default();
        // A refusal is not a solution either.
        let solve = |scene: &Scene, target| -> Option<Termination> {
            let (form, purpose) = (PunchForm::Corrected, Purpose::Answer);
            let solution = solve_punch(scene, target, Some(20.0), form, purpose, &run);
            solution.ok().map(|solution| solution.outcome.termination)
        };
        let converged = Some(Termination::Converged);
        for target in TARGETS {
            assert_eq!(solve(&problem(), target), converged);
        }
        for target in [Load::Indentation(f64::NAN), Load::Force(f64::NAN)] {
            assert_ne!(solve(&problem(), target), converged);
        }
        let soft = Scene {
            field: PillarField::Hexagonal {
                lattice: *problem().hexagonal_lattice().unwrap(),
                column: f64::NAN.into(),
            },
            ..problem()
        };
        let tall = Scene {
            height: f64::NAN,
            ..problem()
        };
        for target in TARGETS {
            assert_ne!(solve(&soft, target), converged);
        }
        assert_ne!(solve(&tall, Load::FloorContact), converged);
    }
}
