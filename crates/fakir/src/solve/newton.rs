//! Semismooth Newton method for all pillars of some sites, with exact solutions on each, and for the floor between them.
//!
//! A step [freezes](super::linearized) the states of the pillars and of the floor's cells, solves for the response of all, closes the indentation
//! by what is [wanted](Target), and lets the [rules](super::rules) say from the loads which states come next. It ends when none
//! changes. The derivative of a pillar's solution is the `P` of its linearized state, so that this is Newton's method on
//! the solutions of all pillars.

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
use crate::halfspace::floor::coupling::{FloorKernels, SurfaceCoupling};
use crate::halfspace::floor::grid::FloorGrid;
use crate::halfspace::floor::load::FloorLoad;
use crate::numerics::convergence::{Judgement, clamped, judge, larger, within};
use crate::problem::scaled::Scene;
use crate::problem::{Load, Point};
use crate::state::{PillarStatus, Progress, Run, SolveError, Stage, Termination};
use std::sync::Arc;

/// Relative energy of the residual at which a linear solution counts as exact.
pub(super) const LINEAR_TOLERANCE: f64 = 1e-10;

/// Where products have an error of their own, part of that which a linear solution may add.
const PART_OF_PRODUCTS: f64 = 0.2;

/// The same with the floor, and on a coarse grid of that.
const FLOOR_LINEAR_TOLERANCE: f64 = 1e-9;
const LEVEL_LINEAR_TOLERANCE: f64 = 1e-6;

/// Tolerance of the first linear solution with the floor, and by how much it goes down from step to step: the cells that change in a step
/// leave a residual of about a tenth of that before.
const FLOOR_FIRST_TOLERANCE: f64 = 5e-3;
const FLOOR_DECREASE: f64 = 0.1;

/// The same after steps in which few places changed: one in so many of those that bear pressure.
const FLOOR_FAST_DECREASE: f64 = 0.01;
const FLOOR_FEW: usize = 100;

/// The same without the floor.
const DECREASE: f64 = 0.03;

/// A floor share is met from this tolerance on: which of many cells bear pressure is known well enough then.
const SHARE_TOLERANCE: f64 = 1e-4;

/// Largest tolerance of the response to a unit indentation where a floor share is wanted, which depends on what it does to the floor and to the tops.
const SHARE_UNIT_TOLERANCE: f64 = 5e-3;

/// Part of the relative change of the indentation below which the tolerance does not go after a step to a floor share.
const PART_OF_CHANGE: f64 = 0.01;

/// On a coarse grid few places may change their state in the end: one in so many of those that bear pressure.
const LEVEL_CHANGES: usize = 200;

/// Relative error of the indentation by the punch lattice, about.
const START_ERROR: f64 = 0.02;

/// A start is good enough when a step changes the status of one pillar in so many; and of one in so many, or two, if the step changes no fewer than one
/// before it: pillars at the edge may be touched and untouched in turns.
const START_CHANGES: usize = 300;
const STALLED_CHANGES: usize = 100;

/// Largest tolerance of the response to a unit indentation.
const UNIT_TOLERANCE: f64 = 1e-2;

/// Tolerance of the first linear solution, when the statuses are still a guess, and of a start.
const FIRST_LINEAR_TOLERANCE: f64 = 1e-3;

/// Largest difference, relative to the largest coefficient, between the local and the global
/// solution on any pillar.
pub(crate) const MISMATCH_TOLERANCE: f64 = 1e-7;

/// Tolerance of the linear solutions, and of the difference on any pillar, of a solution that is to be differentiated, and most steps to it. On
/// slivers a step takes two digits off the difference.
const SHARP_TOLERANCE: f64 = 1e-12;
const SHARP_STEPS: usize = 6;

/// Relative difference in the indentation of first contact between floor points that count as
/// equally low.
const FLOOR_TOLERANCE: f64 = 1e-10;

/// Newton steps before giving up. One to six are typical, up to eleven with the floor.
const STEP_LIMIT: usize = 60;

/// What a Newton solution ended with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Outcome {
    pub(crate) indentation: f64,
    pub(crate) termination: Termination,
    pub(crate) steps: usize,
    /// Lowest point of the floor, if it fixed the indentation.
    pub(crate) floor: Option<FloorPoint>,
    /// Largest difference between local and global coefficients, relative to the largest.
    pub(crate) mismatch: f64,
}

/// What a solution is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// To be handed out.
    Answer,
    /// To start another one from.
    Start,
    /// The contact with the floor on a coarse grid, which the next one starts from and is compared with.
    Level,
}

/// Degrees of the discretisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Degrees {
    /// Modes by which pillars act on each other.
    pub(crate) coupling: usize,
    /// Of the unilateral condition.
    pub(crate) tops: Resolution,
}

/// How exactly the linear problems of a step are solved: no more than the states deserve.
struct Tolerances {
    present: f64,
    /// That at which a step is exact.
    exact: f64,
    /// The smallest that is asked for in the end.
    finest: f64,
    /// By how much it goes down from step to step, and after those that changed few places.
    decrease: f64,
    fast_decrease: f64,
    /// Fewest changes of states in any step so far.
    fewest: usize,
    /// By how much the indentation changed, relatively: nothing is known of a start from none.
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

    /// Of the response to a unit indentation, which is multiplied by the change of the indentation.
    fn unit(&self) -> f64 {
        let unit = self.present / self.change_of_indentation;
        clamped(unit, self.present, UNIT_TOLERANCE)
    }

    /// Whether a step with these, whose unit response had the tolerance `unit`, is exact.
    fn are_exact(&self, unit: f64) -> bool {
        within(self.present, self.exact) && within(unit * self.change_of_indentation, self.exact)
    }

    /// Asks for exact responses. Whether they were not already.
    fn sharpen(&mut self) -> bool {
        let rough = self.present > self.exact;
        (self.finest, self.present) = (self.exact, self.exact);
        self.change_of_indentation = 1.0;
        rough
    }

    /// For the step after one along which many states change.
    fn widen(&mut self) {
        let of_change = PART_OF_CHANGE * self.change_of_indentation;
        self.present = self.present.max(of_change.min(FLOOR_FIRST_TOLERANCE));
    }

    /// For the step after one that changed the states of so many places, with so many that bear pressure.
    fn follow(&mut self, changes: usize, bearing: usize) {
        let decrease = if changes == 0 {
            0.0
        } else if changes < self.fewest && changes * FLOOR_FEW <= bearing {
            self.fast_decrease
        } else {
            self.decrease
        };
        self.fewest = self.fewest.min(changes);
        self.present = (decrease * self.present).max(self.finest);
    }
}

/// Pillars so much farther from the lens axis than those touched are coupled with the floor, in pitches.
const REACH_MARGIN: f64 = 1.0;

/// The contact has come near to pillars that are not coupled with the floor, in pitches.
const NEAR_REACH: f64 = 0.5;

/// Modes of a pillar that the floor sees and that see the floor, by their degree: 3 changes the force by 7e-8, also where
/// the floor is touched 0.6 pillar radii from a rim.
pub(crate) const FLOOR_DEGREE: usize = 2;

/// All pillars of some sites, and the floor where it is touched, with their states and responses.
pub(crate) struct Newton<'a> {
    pub(crate) scene: Scene,
    pub(crate) run: &'a Run<'a>,
    stage: Stage,
    pub(crate) tops: Tops,
    /// The floor's cells; none as long as it is not touched, or is to be ignored.
    pub(crate) cells: Option<FloorCells<'a>>,
    pub(crate) contact: LinearizedContact<'a, SurfaceCoupling<'a>>,
    /// Pillars up to this distance from the lens axis are coupled with the floor.
    reach: f64,
    /// Of the floor's last grid.
    kernels: Option<FloorKernels>,
    pub(crate) exterior: Exterior,
    /// Which pillars are images of each other, where there are any.
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
            exterior: Exterior::new(degree).with_layers(&scene.layers),
            copies,
            floor: FloorSearch::default(),
        }
    }

    /// Pillars act at their centre only: the lens meets them there, not on the average.
    pub(crate) fn load_at_centres(&mut self) {
        let modes = self.contact.modes();
        let loads = self.contact.own_load_mut().chunks_exact_mut(modes);
        for (centre, load) in self.tops.sites.centres().iter().zip(loads) {
            load.fill(0.0);
            load[0] = -UNIT_FORCE * self.scene.lens.sag_with_brim(*centre);
        }
    }

    /// Iterates from the present states until the contact conditions hold; for a start, on
    /// most pillars.
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
                // A response to three digits may make the floor recede from the lens where an
                // exact one does not.
                if tolerances.sharpen() {
                    continue;
                }
                outcome.termination = Termination::Stagnated;
                return Ok(outcome);
            };
            let before = self.contact.indentation();
            // An indentation may be none where some pillars are higher.
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

    /// Goes on from a solution until nothing is left but rounding. Whether no place changed its state in the last step.
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

    /// Whether and how the iteration ends after a step, with the fewest changes in any step before.
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

    /// Responses with the present states.
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

    /// A response with the present states, whose groups are given.
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

    /// The indentation that meets the target with the present responses.
    fn close(&mut self, target: Target) -> Option<(f64, Option<FloorPoint>)> {
        let reaches = target == Target::Prescribed(Load::FloorContact);
        let lowest = reaches.then(|| self.search_floor(true)).flatten();
        target.close(&self.contact, lowest)
    }

    /// Takes over the states that the pillars and the floor's cells have under the present loads.
    fn update(&mut self) -> Change {
        let incident = self.contact.incident();
        let coefficients = self.contact.coefficients();
        let bounded = self.cells.is_some() && self.scene.layers.is_empty();
        let farthest = bounded.then_some(self.reach);
        let workers = self.run.workers();
        let mut change = self.tops.update(&incident, coefficients, farthest, workers);
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

    /// Replaces the floor's cells by those of another grid; `start` has the pressure at a point under the present load and under a unit
    /// indentation. If it has none anywhere, all cells that the lens would enter bear pressure.
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
        if !cells.bears().contains(&true) {
            cells.set(self.contact.floor_load().map(|load| load > 0.0));
        }
        self.cells = Some(cells);
    }

    /// Distance of pillar centres from the lens axis up to which they are coupled with the floor: those touched at present, and some more.
    ///
    /// Those beyond are not touched: on half-spaces the floor only moves the lens away from them, and as it takes load from the tops within, nothing else would
    /// tell them so. A thin layer rises around what is pressed; that it does to those next to the touched ones first.
    ///
    /// If none is touched yet: as far as the undeformed lens is below the tops, with a margin for the indentation, where that is to be found.
    pub(crate) fn pillar_reach(&self) -> f64 {
        if self.touched() > 0 {
            let reach = self.tops.reach() + REACH_MARGIN * self.scene.field.spacing();
            // Tall pillars beyond lower ones come and go with the floor's grid.
            return if self.scene.field.has_unlike_heights() {
                reach.max(self.reach)
            } else {
                reach
            };
        }
        let depth = 1.1 * self.contact.indentation();
        self.scene.farthest_reached(depth)
    }

    /// Whether pillars are touched that are not coupled with the floor, or may be because the contact has come near to them.
    pub(crate) fn touches_beyond_reach(&self) -> bool {
        let near = if self.scene.layers.is_empty() {
            NEAR_REACH * self.scene.field.spacing()
        } else {
            0.0
        };
        self.cells.is_some() && self.touched() > 0 && self.tops.reach() > self.reach - near
    }

    /// The pressure on the floor, where it bears any.
    pub(crate) fn floor_load(&self) -> Option<FloorLoad> {
        let cells = self.cells.as_ref()?;
        let scale = cells.unit_cell().recip();
        let pressures = cells.bears().iter().zip(self.contact.floor_coefficients());
        let pressure: Vec<f64> = pressures
            .filter_map(|(bears, c)| bears.then_some(c.max(0.0) * scale))
            .collect();
        (!pressure.is_empty())
            .then(|| FloorLoad::new(cells.bearing(), pressure).with_layers(&self.scene.layers))
    }

    /// Whether a search from scratch finds a lower point of the floor than the one that closed
    /// the last step. The next step then starts from it.
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

    /// Number of floor cells that bear pressure.
    pub(crate) fn pressed(&self) -> usize {
        let cells = self.cells.as_ref();
        cells.map_or(0, |cells| cells.bears().iter().filter(|b| **b).count())
    }

    /// Force at the solved indentation.
    pub(crate) fn force(&self) -> f64 {
        self.contact.force()
    }

    /// Degree of the coupling.
    pub(crate) fn degree(&self) -> usize {
        self.exterior.degree()
    }

    /// The degree by which two pillars act on each other, by their gap over the smaller radius.
    pub(crate) fn pair_degree(&self, gap: f64) -> usize {
        self.contact.coupling().tops.pair_degree(gap, self.degree())
    }

    /// Gives back the memory of the coupling: nothing can be solved any more, but another solution started from this.
    pub(crate) fn release_coupling(&mut self) {
        self.contact.coupling_mut().tops = LatticeCoupling::Released;
    }

    /// Whether a pillar counts as touched, or as untouched, only because the modes of the coupling
    /// leave out a part of the lens shape.
    pub(crate) fn has_marginal_pillars(&self) -> bool {
        let incident = self.contact.incident();
        self.tops
            .has_marginal_pillars(&incident, self.run.workers())
    }

    /// By how much a pillar top is asked to come down on the average, as under a flat punch.
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

    /// Response to a unit indentation for the present states, to the given tolerance.
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

    /// `W(x)` of every pillar: what its coefficients move a point of the floor by.
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

    /// What the moments of a pillar, each by itself, move a point beside it by.
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
        exterior.values([0, 1].map(|k| (position[k] - centre[k]) / radius), values);
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

    /// The point of the smallest floor gap at the solved indentation, with the gap plus the
    /// indentation.
    pub(crate) fn lowest_gap(&mut self) -> Option<FloorPoint> {
        self.search_floor(false)
    }

    /// The lowest point of the floor under pressures that go with the indentation, or do not.
    fn search_floor(&mut self, with_indentation: bool) -> Option<FloorPoint> {
        let mut floor = std::mem::take(&mut self.floor);
        let lowest = self.with_loaded(with_indentation, |discs| {
            floor.lowest(&self.uncovered(), discs, &self.run.cancel)
        });
        self.floor = floor;
        lowest
    }

    /// The floor beside the pillars, and the lens over it.
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

    /// The touched pillars, each with the force that it bears.
    pub(crate) fn forces(&self) -> Vec<(Point, f64)> {
        let modes = self.contact.modes();
        let moments = self.contact.coefficients().chunks_exact(modes);
        let centres = self.tops.sites.centres().iter();
        let all = centres.zip(moments).zip(&self.tops.status);
        all.filter(|(_, status)| **status != PillarStatus::Untouched)
            .map(|((centre, moments), _)| (*centre, UNIT_FORCE * moments[0]))
            .collect()
    }

    /// Gaps to the floor at points beside pillars, by the pressures on the pillars and those on the [floor](Self::floor_load). These are summed in groups,
    /// whose making takes longer than many points do.
    pub(crate) fn gaps(&self, points: &[Point], floor: Option<&FloorLoad>) -> Vec<f64> {
        let mut gaps = self.gaps_under_tops(points);
        if let Some(load) = floor {
            for (gap, point) in gaps.iter_mut().zip(points) {
                *gap += load.displacement(*point);
            }
        }
        gaps
    }

    /// Gaps to the floor at points beside pillars, by the pressures on the pillars alone.
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

    /// What the touched pillars bear, as discs: under pressures that go with the indentation, or do not.
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

    /// The same on other sites and with other degrees, without the floor's cells.
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

    /// Its degrees.
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

/// How the iteration ends where a linear problem could not be solved.
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

    /// The paper's pillars of rubber, the lens axis beside one of them.
    pub(crate) fn problem() -> Scene {
        let lattice = reference::lattice(0.03).offset_by(0.2);
        let compliance = PillarCompliance::Column;
        let rubber = reference::INTERMEDIATE;
        Scene::new(&reference::on_lattice(lattice, rubber, compliance))
    }

    fn newton<'a>(scene: &Scene, run: &'a Run<'a>) -> Newton<'a> {
        let pitch = scene.field.spacing();
        let pair = PairCoupling::new(2, pitch);
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

    /// One number of the data that is none, on any pillar, touched or not, in any mode.
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

    /// Pillars of other heights are other loads of the lens shape, and nothing else: all higher by as much are
    /// met so much earlier, and one that is higher bears what the lens then asks of it.
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
        // A refusal is no solution either.
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
