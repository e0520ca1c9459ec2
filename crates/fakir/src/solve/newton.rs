//! Semismooth Newton method for all pillars of a window, with exact solutions on each.
//!
//! The unknowns are the leading pressure coefficients `c` of every pillar. A pillar under the
//! load `s = zeta b1 + bs - B c` answers with the solution of its own unilateral problem, whose
//! derivative is `P` (see [`unilateral`](crate::solve::rules::unilateral)). With the status and active nodes
//! of every pillar frozen, `c + P B c = P b + cb` is linear in the indentation: `c = c* + (zeta - zeta*) c1`.
//! It is solved for the response `c*` at the last indentation `zeta*` and for that to a unit indentation,
//! `c1`; the indentation follows from what is prescribed, and the local problems give the next statuses
//! and active nodes. `c*` changes little from step to step, and `c1` need not be exact, as `zeta - zeta*`
//! tends to zero.

use super::floor::{FloorPoint, FloorSearch, LoadedDiscs};
use super::rules::rim::Rim;
use super::rules::unilateral::{LocalSolver, PillarTop};
use crate::halfspace::coupling::lattice::LatticeCoupling;
use crate::halfspace::coupling::pair::PairCoupling;
use crate::halfspace::coupling::window::Window;
use crate::halfspace::disc::basis::{UNIT_FORCE, degree_with};
use crate::halfspace::disc::exterior::Exterior;
use crate::halfspace::disc::nodes::Resolution;
use crate::halfspace::disc::projection::LensProjector;
use crate::numerics::convergence::{Judgement, judge, larger, within};
use crate::numerics::vector::{Vectors, add_scaled, dot, subtract};
use crate::problem::Point;
use crate::problem::scaled::Problem;
use crate::state::{PillarStatus, Progress, Run, SolveError, Stage, Termination};

/// Relative energy of the residual at which a linear solution counts as exact.
const LINEAR_TOLERANCE: f64 = 1e-10;

/// Relative error of the indentation by the punch lattice, about.
const START_ERROR: f64 = 0.02;

/// A start is good enough when a step changes the status of one pillar in so many.
const START_CHANGES: usize = 300;

/// Largest tolerance of the response to a unit indentation.
const UNIT_TOLERANCE: f64 = 1e-2;

/// Tolerance of the first linear solution, when the statuses are still a guess, and of a start.
const FIRST_LINEAR_TOLERANCE: f64 = 1e-3;

/// Largest difference, relative to the largest coefficient, between the local and the global
/// solution on any pillar.
pub(crate) const MISMATCH_TOLERANCE: f64 = 1e-7;

/// Relative difference in the indentation of first contact between floor points that count as
/// equally low.
const FLOOR_TOLERANCE: f64 = 1e-10;

/// Newton steps before giving up. One to six are typical.
const STEP_LIMIT: usize = 60;

/// Pillars a thread takes at a time, at the least, where little is done for each ...
const PILLARS: usize = 4000;

/// ... and where more is.
pub(crate) const COSTLY_PILLARS: usize = 200;

/// Iterations of the conjugate gradient method before giving up; 10 to 25 are typical.
const LINEAR_LIMIT: usize = 600;

/// What fixes the indentation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Target {
    /// The indentation itself.
    Indentation(f64),
    /// The force.
    Force(f64),
    /// First contact with the floor.
    Floor,
}

/// A pillar that is touched in part.
#[derive(Debug, Clone)]
struct Partial {
    pillar: usize,
    /// Nodes without pressure, or cells with it.
    active: Vec<bool>,
    /// `P`, row by row.
    derivative: Vec<f64>,
    /// `cb`: the leading coefficients without leading load.
    constant: Vec<f64>,
    converged: bool,
}

impl Partial {
    /// Of a computation that is to stop.
    fn unsolved(pillar: usize, modes: usize) -> Self {
        Self {
            pillar,
            active: Vec::new(),
            derivative: vec![0.0; modes * modes],
            constant: vec![0.0; modes],
            converged: false,
        }
    }
}

/// Coefficients and the loads they make on the other pillars.
#[derive(Debug, Clone, Default)]
pub(crate) struct Response {
    /// `c`
    pub(crate) coefficients: Vec<f64>,
    /// `B c`
    pub(crate) far: Vec<f64>,
}

impl Response {
    /// None at all.
    pub(crate) fn none(size: usize) -> Self {
        Self {
            coefficients: vec![0.0; size],
            far: vec![0.0; size],
        }
    }
}

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
    /// To be told.
    Answer,
    /// To start another one from.
    Start,
}

/// Degrees of the discretisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Degrees {
    /// Modes by which pillars act on each other.
    pub(crate) coupling: usize,
    /// Of the unilateral condition.
    pub(crate) tops: Resolution,
}

/// All pillars of a window with their statuses and responses.
pub(crate) struct Newton<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) run: &'a Run<'a>,
    stage: Stage,
    pub(crate) window: Window,
    coupling: LatticeCoupling,
    pub(crate) top: PillarTop,
    pub(crate) exterior: Exterior,
    projector: LensProjector,
    /// Leading modes per pillar.
    pub(crate) modes: usize,
    /// `bs`, pillar by pillar.
    own_load: Vec<f64>,
    pub(crate) status: Vec<PillarStatus>,
    partial: Vec<Partial>,
    /// Index into `partial` of every pillar that is there.
    partial_of: Vec<u32>,
    /// Response to a unit indentation.
    pub(crate) unit: Response,
    /// Response at the indentation `base`.
    present: Response,
    base: f64,
    floor: FloorSearch,
    work: Work,
}

#[derive(Default)]
struct Work {
    load: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    direction_load: Vec<f64>,
    preconditioned: Vec<f64>,
    product: Vec<f64>,
}

/// What the local problems changed.
struct Change {
    pillars: usize,
    mismatch: f64,
    local_failures: usize,
}

const NOT_PARTIAL: u32 = u32::MAX;

impl<'a> Newton<'a> {
    /// All pillars of the window untouched.
    pub(crate) fn new(
        problem: &'a Problem,
        run: &'a Run<'a>,
        stage: Stage,
        window: Window,
        pair: &PairCoupling,
        top: PillarTop,
    ) -> Self {
        let modes = pair.modes().len();
        let degree = pair.modes().last().map_or(0, |mode| mode.degree);
        let projector = LensProjector::new(problem, degree);
        let size = window.len() * modes;
        let mut own_load = vec![0.0; size];
        let project = |(): &mut (), pillar: usize, load: &mut [f64]| {
            projector.project(problem, window.centres()[pillar], load);
        };
        run.workers()
            .fill(&mut own_load, modes, COSTLY_PILLARS, || (), project);
        run.report(Progress {
            stage: Stage::Coupling,
            step: 0,
            pillars: window.len(),
            touched: 0,
        });
        let work = Work {
            load: vec![0.0; size],
            residual: vec![0.0; size],
            direction: vec![0.0; size],
            direction_load: vec![0.0; size],
            preconditioned: vec![0.0; size],
            product: vec![0.0; size],
        };
        Self {
            problem,
            run,
            stage,
            coupling: LatticeCoupling::new(&window, pair, run.workers()),
            exterior: Exterior::new(degree),
            projector,
            modes,
            own_load,
            status: vec![PillarStatus::Untouched; window.len()],
            partial: Vec::new(),
            partial_of: vec![NOT_PARTIAL; window.len()],
            unit: Response::none(size),
            present: Response::none(size),
            base: 0.0,
            floor: FloorSearch::default(),
            work,
            top,
            window,
        }
    }

    /// Pillars act at their centre only: the lens meets them there, not on the average.
    pub(crate) fn load_at_centres(&mut self) {
        for (centre, load) in self
            .window
            .centres()
            .iter()
            .zip(self.own_load.chunks_exact_mut(self.modes))
        {
            load.fill(0.0);
            load[0] = -UNIT_FORCE * self.problem.sag_with_brim(*centre);
        }
    }

    /// Number of touched pillars.
    pub(crate) fn touched(&self) -> usize {
        self.status
            .iter()
            .filter(|status| **status != PillarStatus::Untouched)
            .count()
    }

    /// Force at the solved indentation.
    pub(crate) fn force(&self) -> f64 {
        self.force_of(&self.present)
    }

    /// Change of the force with the indentation, statuses and active nodes frozen.
    pub(crate) fn stiffness(&self) -> f64 {
        self.force_of(&self.unit)
    }

    fn force_of(&self, response: &Response) -> f64 {
        let firsts = response.coefficients.iter().step_by(self.modes);
        UNIT_FORCE * firsts.sum::<f64>()
    }

    /// Distance from the lens axis of the farthest touched pillar centre.
    pub(crate) fn reach(&self) -> f64 {
        self.window
            .centres()
            .iter()
            .zip(&self.status)
            .filter(|(_, status)| **status != PillarStatus::Untouched)
            .map(|([x, y], _)| x.hypot(*y))
            .fold(0.0, f64::max)
    }

    /// Iterates from the present statuses until the contact conditions hold; for a start, on
    /// most pillars.
    pub(crate) fn solve(
        &mut self,
        target: Target,
        purpose: Purpose,
    ) -> Result<Outcome, SolveError> {
        let mut tolerance = FIRST_LINEAR_TOLERANCE;
        let mut finest = match purpose {
            Purpose::Answer => LINEAR_TOLERANCE,
            Purpose::Start => FIRST_LINEAR_TOLERANCE,
        };
        let mut fewest = usize::MAX;
        let mut outcome = Outcome {
            indentation: self.base,
            termination: Termination::IterationLimit,
            steps: 0,
            floor: None,
            mismatch: f64::INFINITY,
        };
        // By how much the indentation changed, relatively: nothing is known of a start from none.
        let mut change_of_indentation = if self.base > 0.0 { START_ERROR } else { 1.0 };
        for step in 1..=STEP_LIMIT {
            outcome.steps = step;
            self.run.check_cancelled()?;
            self.report(step);
            let unit_tolerance =
                (tolerance / change_of_indentation).clamp(tolerance, UNIT_TOLERANCE);
            outcome.termination = match self.linear_step(target, tolerance, unit_tolerance)? {
                Judgement::Good => Termination::IterationLimit,
                Judgement::TooLarge => Termination::Stagnated,
                Judgement::Undefined => Termination::NotFinite,
            };
            if outcome.termination != Termination::IterationLimit {
                return Ok(outcome);
            }
            let Some((indentation, floor)) = self.close(target) else {
                // A response to three digits may make the floor recede from the lens where an
                // exact one does not.
                if tolerance > LINEAR_TOLERANCE {
                    finest = LINEAR_TOLERANCE;
                    tolerance = finest;
                    change_of_indentation = 1.0;
                    continue;
                }
                outcome.termination = Termination::Stagnated;
                return Ok(outcome);
            };
            change_of_indentation = (indentation / self.base - 1.0).abs().clamp(1e-12, 1.0);
            self.rebase(indentation);
            (outcome.indentation, outcome.floor) = (indentation, floor);
            let change = self.local_pass();
            self.run.check_cancelled()?;
            outcome.mismatch = change.mismatch;
            if purpose == Purpose::Start && change.pillars * START_CHANGES <= self.touched() {
                outcome.termination = Termination::Converged;
                return Ok(outcome);
            }
            let mismatch = judge(change.mismatch, MISMATCH_TOLERANCE);
            if mismatch == Judgement::Undefined {
                outcome.termination = Termination::NotFinite;
                return Ok(outcome);
            }
            let exact = within(tolerance, LINEAR_TOLERANCE)
                && within(unit_tolerance * change_of_indentation, LINEAR_TOLERANCE);
            if change.pillars == 0
                && exact
                && mismatch == Judgement::Good
                && !self.found_lower_floor(&outcome)
            {
                outcome.termination = if change.local_failures == 0 && self.bears(target) {
                    Termination::Converged
                } else {
                    Termination::Stagnated
                };
                return Ok(outcome);
            }
            tolerance = if change.pillars == 0 {
                finest
            } else if change.pillars < fewest {
                fewest = change.pillars;
                (0.03 * tolerance).max(finest)
            } else {
                finest
            };
        }
        Ok(outcome)
    }

    /// Whether the pillars bear a prescribed force. So small a one that it changes the indentation by
    /// less than its rounding, they do not.
    fn bears(&self, target: Target) -> bool {
        match target {
            Target::Force(force) => {
                within((self.force() - force).abs(), MISMATCH_TOLERANCE * force)
            }
            Target::Indentation(_) | Target::Floor => true,
        }
    }

    /// Whether a search from scratch finds a lower point of the floor than the one that closed
    /// the last step. The next step then starts from it.
    fn found_lower_floor(&mut self, outcome: &Outcome) -> bool {
        let Some(present) = outcome.floor else {
            return false;
        };
        self.floor = FloorSearch::default();
        self.lowest_floor_point().is_some_and(|lowest| {
            lowest.indentation < present.indentation * (1.0 - FLOOR_TOLERANCE)
        })
    }

    fn report(&self, step: usize) {
        self.run.report(Progress {
            stage: self.stage,
            step,
            pillars: self.window.len(),
            touched: self.touched(),
        });
    }

    /// Degree of the coupling.
    pub(crate) fn degree(&self) -> usize {
        self.exterior.degree()
    }

    /// Degree of the load of the lens shape.
    pub(crate) fn load_degree(&self) -> usize {
        degree_with(self.projector.count())
    }

    /// `c` at the solved indentation, pillar by pillar.
    pub(crate) fn coefficients(&self) -> &[f64] {
        &self.present.coefficients
    }

    /// Makes `present` the response at another indentation.
    fn rebase(&mut self, indentation: f64) {
        let change = indentation - self.base;
        let vectors = Vectors(self.run.workers());
        let Response { coefficients, far } = &mut self.present;
        vectors.add_scaled(coefficients, change, &self.unit.coefficients);
        vectors.add_scaled(far, change, &self.unit.far);
        self.base = indentation;
    }

    /// Responses with the present statuses and active nodes.
    fn linear_step(
        &mut self,
        target: Target,
        tolerance: f64,
        unit_tolerance: f64,
    ) -> Result<Judgement, SolveError> {
        if let Target::Indentation(indentation) = target {
            self.rebase(indentation);
            return self.solve_linear(Part::Present, tolerance);
        }
        match self.solve_linear(Part::Unit, unit_tolerance)? {
            Judgement::Good => self.solve_linear(Part::Present, tolerance),
            failed => Ok(failed),
        }
    }

    /// Response to a unit indentation for the present statuses, to the given tolerance.
    pub(crate) fn solve_unit(&mut self, tolerance: f64) -> Result<bool, SolveError> {
        Ok(self.solve_linear(Part::Unit, tolerance)? == Judgement::Good)
    }

    /// Response of the pillars to a given load, with statuses and active nodes frozen.
    pub(crate) fn respond_to(
        &mut self,
        load: &[f64],
        tolerance: f64,
    ) -> Result<Response, SolveError> {
        let mut response = Response::none(load.len());
        let mut work = std::mem::take(&mut self.work);
        let solved =
            self.conjugate_gradients(Part::Source(load), tolerance, &mut response, &mut work);
        self.work = work;
        solved.map(|_| response)
    }

    /// `b1 - B c1`: what a unit change of a local answer does to the force.
    pub(crate) fn unit_sensitivity(&self) -> Vec<f64> {
        let mut load = vec![0.0; self.unit.far.len()];
        self.right_side(Part::Unit, &mut load);
        subtract(&mut load, &self.unit.far);
        load
    }

    /// `W(x)` of every pillar: what its coefficients move a point of the floor by.
    pub(crate) fn point_load(&self, position: Point) -> Vec<f64> {
        let mut load = vec![0.0; self.unit.far.len()];
        let one = |(): &mut (), pillar: usize, load: &mut [f64]| {
            let [x, y] = self.window.centres()[pillar];
            self.exterior
                .values([position[0] - x, position[1] - y], load);
        };
        self.run
            .workers()
            .fill(&mut load, self.modes, COSTLY_PILLARS, || (), one);
        load
    }

    /// Preconditioned conjugate gradients on `(P^-1 + B) c = b + P^-1 cb`, in the dual variable
    /// `s = P^-1 (c - cb)`, so that the singular `P` is never inverted.
    fn solve_linear(&mut self, part: Part<'_>, tolerance: f64) -> Result<Judgement, SolveError> {
        let mut work = std::mem::take(&mut self.work);
        let mut response = std::mem::take(match part {
            Part::Unit => &mut self.unit,
            _ => &mut self.present,
        });
        let solved = self.conjugate_gradients(part, tolerance, &mut response, &mut work);
        match part {
            Part::Unit => self.unit = response,
            _ => self.present = response,
        }
        self.work = work;
        solved
    }

    fn conjugate_gradients(
        &mut self,
        part: Part<'_>,
        tolerance: f64,
        response: &mut Response,
        work: &mut Work,
    ) -> Result<Judgement, SolveError> {
        let Response { coefficients, far } = response;
        let vectors = Vectors(self.run.workers());
        // s = b - B c of the previous solution; c = P s + cb; r = b - B c - s.
        self.right_side(part, &mut work.load);
        vectors.subtract(&mut work.load, far);
        self.precondition(&work.load, coefficients);
        self.add_constants(part, coefficients);
        let scale = vectors.dot(&work.load, coefficients).abs();
        work.residual.copy_from_slice(far);
        self.coupling.apply(coefficients, far, self.run.workers());
        self.run.check_cancelled()?;
        vectors.subtract(&mut work.residual, far);
        self.precondition(&work.residual, &mut work.preconditioned);
        work.direction.copy_from_slice(&work.preconditioned);
        work.direction_load.copy_from_slice(&work.residual);
        let mut energy = vectors.dot(&work.residual, &work.preconditioned);
        for _ in 0..LINEAR_LIMIT {
            let bound = tolerance * tolerance * larger(scale, f64::MIN_POSITIVE);
            match judge(energy, bound) {
                Judgement::TooLarge => {}
                ended => return Ok(ended),
            }
            self.coupling
                .apply(&work.direction, &mut work.product, self.run.workers());
            self.run.check_cancelled()?;
            // A p = B p_z + p_s, and B p_z is kept up to date in `far`.
            let curvature = vectors.dot(&work.direction, &work.product)
                + vectors.dot(&work.direction, &work.direction_load);
            if within(curvature, 0.0) {
                return Ok(Judgement::TooLarge);
            }
            let length = energy / curvature;
            vectors.add_scaled(coefficients, length, &work.direction);
            vectors.add_scaled(far, length, &work.product);
            vectors.add_scaled(&mut work.residual, -length, &work.product);
            vectors.add_scaled(&mut work.residual, -length, &work.direction_load);
            self.precondition(&work.residual, &mut work.preconditioned);
            let next = vectors.dot(&work.residual, &work.preconditioned);
            let ratio = next / energy;
            energy = next;
            vectors.scale_and_add(&mut work.direction, ratio, &work.preconditioned);
            vectors.scale_and_add(&mut work.direction_load, ratio, &work.residual);
        }
        Ok(Judgement::TooLarge)
    }

    fn right_side(&self, part: Part<'_>, load: &mut [f64]) {
        match part {
            Part::Unit => {
                load.fill(0.0);
                load.iter_mut()
                    .step_by(self.modes)
                    .for_each(|b| *b = UNIT_FORCE);
            }
            Part::Present => {
                load.copy_from_slice(&self.own_load);
                load.iter_mut()
                    .step_by(self.modes)
                    .for_each(|b| *b += self.base * UNIT_FORCE);
            }
            Part::Source(source) => load.copy_from_slice(source),
        }
    }

    fn add_constants(&self, part: Part<'_>, coefficients: &mut [f64]) {
        if matches!(part, Part::Unit | Part::Source(_)) {
            return;
        }
        for partial in &self.partial {
            let start = partial.pillar * self.modes;
            for (c, constant) in coefficients[start..].iter_mut().zip(&partial.constant) {
                *c += constant;
            }
        }
    }

    /// `z = P s`
    fn precondition(&self, load: &[f64], result: &mut [f64]) {
        let modes = self.modes;
        let compliance = self.top.lead_compliance();
        let one = |(): &mut (), pillar: usize, result: &mut [f64]| {
            let load = &load[pillar * modes..(pillar + 1) * modes];
            match self.status[pillar] {
                PillarStatus::Untouched => result.fill(0.0),
                PillarStatus::Full => {
                    for ((c, s), lambda) in result.iter_mut().zip(load).zip(compliance) {
                        *c = s / lambda;
                    }
                }
                PillarStatus::Partial => {
                    let partial = &self.partial[self.partial_of[pillar] as usize];
                    for (c, row) in result
                        .iter_mut()
                        .zip(partial.derivative.chunks_exact(modes))
                    {
                        *c = row.iter().zip(load).map(|(p, s)| p * s).sum();
                    }
                }
            }
        };
        self.run.workers().fill(result, modes, PILLARS, || (), one);
    }

    /// The indentation that meets the target with the present responses.
    fn close(&mut self, target: Target) -> Option<(f64, Option<FloorPoint>)> {
        match target {
            Target::Indentation(indentation) => Some((indentation, None)),
            Target::Force(force) => {
                let stiffness = self.stiffness();
                let missing = force - self.force();
                (stiffness > 0.0).then(|| (self.base + missing / stiffness, None))
            }
            Target::Floor => {
                let lowest = self.lowest_floor_point()?;
                Some((lowest.indentation, Some(lowest)))
            }
        }
    }

    /// The lowest point of the floor, with its indentation of contact.
    fn lowest_floor_point(&mut self) -> Option<FloorPoint> {
        self.search_floor(true)
    }

    /// The point of the smallest floor gap at the solved indentation, with the gap plus the
    /// indentation.
    pub(crate) fn lowest_gap(&mut self) -> Option<FloorPoint> {
        self.search_floor(false)
    }

    /// Searches the floor with pressures that go with the indentation, or do not.
    fn search_floor(&mut self, with_indentation: bool) -> Option<FloorPoint> {
        let modes = self.modes;
        let touched: Vec<usize> = (0..self.window.len())
            .filter(|&p| self.status[p] != PillarStatus::Untouched)
            .collect();
        let gather = |coefficients: &[f64]| -> Vec<f64> {
            touched
                .iter()
                .flat_map(|p| &coefficients[p * modes..(p + 1) * modes])
                .copied()
                .collect()
        };
        let mut without = gather(&self.present.coefficients);
        let along = if with_indentation {
            let unit = gather(&self.unit.coefficients);
            add_scaled(&mut without, -self.base, &unit);
            unit
        } else {
            vec![0.0; without.len()]
        };
        let centres: Vec<Point> = touched.iter().map(|&p| self.window.centres()[p]).collect();
        let discs = LoadedDiscs {
            exterior: &self.exterior,
            modes,
            centres: &centres,
            radius: 1.0,
            coefficients: [&along, &without],
            run: self.run,
        };
        self.floor.lowest(self.problem, &discs, &self.run.cancel)
    }

    /// Leading load on a pillar at the solved indentation, `zeta b1 + bs - B c`.
    fn load(&self, pillar: usize, load: &mut [f64]) {
        for (k, slot) in (pillar * self.modes..).zip(load.iter_mut()) {
            *slot = self.own_load[k] - self.present.far[k];
        }
        load[0] += self.base * UNIT_FORCE;
    }

    /// By how much a pillar top is asked to come down on the average, as under a flat punch.
    pub(crate) fn mean_load(&self, pillar: usize) -> f64 {
        let mut load = vec![0.0; self.modes];
        self.load(pillar, &mut load);
        load[0] / UNIT_FORCE
    }

    /// Load on a pillar with all modes of the lens shape over its top.
    pub(crate) fn full_load(&self, pillar: usize) -> Vec<f64> {
        let count = self.projector.count().min(self.top.count());
        let mut load = vec![0.0; count];
        self.projector
            .project(self.problem, self.window.centres()[pillar], &mut load);
        self.load(pillar, &mut load[..self.modes]);
        load
    }

    /// All coefficients of a partially touched pillar.
    pub(crate) fn partial_coefficients(&self, pillar: usize, solver: &mut LocalSolver) -> Vec<f64> {
        let load = self.full_load(pillar);
        let mut active = match self.partial.get(self.partial_of[pillar] as usize) {
            Some(partial) => partial.active.clone(),
            None => solver.first_guess(&self.top, &load),
        };
        solver.solve(&self.top, &load, &mut active);
        let mut coefficients = vec![0.0; self.top.count()];
        solver.coefficients(&self.top, &load, &mut coefficients);
        coefficients
    }

    /// Coefficients of the gap over a pillar top, `Lam c - b`.
    pub(crate) fn gap_coefficients(&self, pillar: usize, coefficients: &[f64]) -> Vec<f64> {
        let load = self.full_load(pillar);
        let mut gap: Vec<f64> = coefficients
            .iter()
            .zip(self.top.compliance())
            .map(|(c, lambda)| c * lambda)
            .collect();
        subtract(&mut gap, &load);
        gap
    }

    /// Solves every pillar under its present load, and takes over statuses and active nodes.
    fn local_pass(&mut self) -> Change {
        let before = std::mem::take(&mut self.status);
        self.status = self.statuses();
        let partial: Vec<usize> = (0..self.window.len())
            .filter(|&p| self.status[p] == PillarStatus::Partial)
            .collect();
        let guess = |pillar: usize| -> Option<&Partial> {
            self.partial.get(self.partial_of[pillar] as usize)
        };
        let solver = || LocalSolver::new(&self.top);
        let solved = self
            .run
            .workers()
            .map(partial.len(), 1, solver, |solver, number| {
                let pillar = partial[number];
                self.solve_partial(solver, pillar, guess(pillar))
            });
        let changed = before
            .iter()
            .zip(&self.status)
            .filter(|(before, after)| before != after)
            .count();
        let moved = solved.iter().filter(|(_, _, moved)| *moved).count();
        let mismatch = self.mismatch(&solved);
        self.partial_of.fill(NOT_PARTIAL);
        self.partial = solved.into_iter().map(|(partial, _, _)| partial).collect();
        for (index, partial) in self.partial.iter().enumerate() {
            self.partial_of[partial.pillar] = index as u32;
        }
        Change {
            pillars: changed + moved,
            mismatch,
            local_failures: self.partial.iter().filter(|p| !p.converged).count(),
        }
    }

    fn statuses(&self) -> Vec<PillarStatus> {
        let work = || (vec![0.0; self.modes], Rim::new(self.degree()));
        let count = self.window.len();
        self.run
            .workers()
            .map(count, PILLARS, work, |(load, rim), pillar| {
                self.load(pillar, load);
                self.top.status(load, rim)
            })
    }

    /// Whether a pillar counts as touched, or as untouched, only because the modes of the coupling
    /// leave out a part of the lens shape.
    pub(crate) fn has_marginal_pillars(&self) -> bool {
        if self.degree() >= self.load_degree() {
            return false;
        }
        let work = || Rim::new(self.load_degree());
        let count = self.window.len();
        let marginal = self
            .run
            .workers()
            .map(count, COSTLY_PILLARS, work, |rim, pillar| {
                let in_full = self.top.status(&self.full_load(pillar), rim);
                let untouched = PillarStatus::Untouched;
                (in_full == untouched) != (self.status[pillar] == untouched)
            });
        marginal.contains(&true)
    }

    /// The unilateral problem of one pillar: its new state, its leading coefficients, and
    /// whether its active nodes changed.
    fn solve_partial(
        &self,
        solver: &mut LocalSolver,
        pillar: usize,
        guess: Option<&Partial>,
    ) -> (Partial, Vec<f64>, bool) {
        let modes = self.modes;
        if self.run.cancel.is_cancelled() {
            return (Partial::unsolved(pillar, modes), vec![0.0; modes], true);
        }
        let load = self.full_load(pillar);
        let mut active = match guess {
            Some(partial) if partial.pillar == pillar => partial.active.clone(),
            _ => solver.first_guess(&self.top, &load),
        };
        let pivoting = solver.solve(&self.top, &load, &mut active);
        let mut coefficients = vec![0.0; modes];
        solver.coefficients(&self.top, &load, &mut coefficients);
        let mut derivative = vec![0.0; modes * modes];
        solver.derivative(&self.top, &mut derivative);
        let constant = coefficients
            .iter()
            .zip(derivative.chunks_exact(modes))
            .map(|(c, row)| c - dot(row, &load[..modes]))
            .collect();
        let moved = guess.is_none_or(|partial| partial.active != active);
        let partial = Partial {
            pillar,
            active,
            derivative,
            constant,
            converged: pivoting.converged,
        };
        (partial, coefficients, moved)
    }

    /// Largest difference between the coefficients of the local problems and those of the
    /// linear solution, relative to the largest coefficient.
    fn mismatch(&self, solved: &[(Partial, Vec<f64>, bool)]) -> f64 {
        let modes = self.modes;
        let of_pillar = |local: &mut Vec<f64>, pillar: usize| {
            match self.status[pillar] {
                PillarStatus::Untouched => local.fill(0.0),
                PillarStatus::Full => {
                    self.load(pillar, local);
                    for (c, lambda) in local.iter_mut().zip(self.top.lead_compliance()) {
                        *c /= lambda;
                    }
                }
                PillarStatus::Partial => {
                    let found =
                        solved.binary_search_by_key(&pillar, |(partial, ..)| partial.pillar);
                    if let Ok(place) = found {
                        local.copy_from_slice(&solved[place].1);
                    }
                }
            }
            let global = &self.present.coefficients[pillar * modes..(pillar + 1) * modes];
            local
                .iter()
                .zip(global)
                .fold([0.0_f64; 2], |[largest, difference], (c, global)| {
                    [
                        larger(largest, c.abs()),
                        larger(difference, (c - global).abs()),
                    ]
                })
        };
        let local = || vec![0.0; modes];
        let count = self.window.len();
        let of_pillars = self.run.workers().map(count, PILLARS, local, of_pillar);
        let [largest, difference] = of_pillars
            .into_iter()
            .fold([f64::MIN_POSITIVE, 0.0], |[a, b], [c, d]| {
                [larger(a, c), larger(b, d)]
            });
        difference / largest
    }

    /// Takes statuses and leading coefficients of full contact from a coarser solution.
    pub(crate) fn start_from(&mut self, coarse: &Self) {
        for pillar in 0..self.window.len() {
            let Some(from) = coarse.window.find(self.window.index(pillar)) else {
                continue;
            };
            self.status[pillar] = match coarse.status[from] {
                PillarStatus::Partial => PillarStatus::Full,
                status => status,
            };
            for (fine, coarse_response) in [
                (&mut self.unit, &coarse.unit),
                (&mut self.present, &coarse.present),
            ] {
                let shared = self.modes.min(coarse.modes);
                fine.coefficients[pillar * self.modes..][..shared].copy_from_slice(
                    &coarse_response.coefficients[from * coarse.modes..][..shared],
                );
            }
        }
        self.base = coarse.base;
        for response in [&mut self.unit, &mut self.present] {
            let Response { coefficients, far } = response;
            self.coupling.apply(coefficients, far, self.run.workers());
        }
    }

    /// Marks the pillars within a radius of the lens axis as touched, and at least the nearest.
    pub(crate) fn touch_within(&mut self, radius: f64) {
        let mut nearest = (f64::INFINITY, 0);
        for (pillar, [x, y]) in self.window.centres().iter().enumerate() {
            let distance = x.hypot(*y);
            if distance < nearest.0 {
                nearest = (distance, pillar);
            }
            if distance < radius {
                self.status[pillar] = PillarStatus::Full;
            }
        }
        self.status[nearest.1] = PillarStatus::Full;
    }
}

/// Which part of the response is solved for.
#[derive(Debug, Clone, Copy)]
enum Part<'a> {
    /// `c1`
    Unit,
    /// `c*`
    Present,
    /// The response to a given load.
    Source(&'a [f64]),
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::halfspace::coupling::window::Window;
    use crate::problem::{
        HexagonalLattice, Lens, Material, Pillar, PillarCompliance, PunchForm, System, Texture,
    };
    use crate::solve::spectral::solve_punch;

    /// The paper's pillars of rubber, the lens axis beside one of them.
    pub(crate) fn problem() -> Problem {
        let material = Material::new(2e6, 0.5);
        let pillar = Pillar {
            diameter: 6e-6,
            height: 2.2e-6,
            compliance: PillarCompliance::Column,
        };
        let lens = Lens {
            radius: 2.2e-3,
            material,
        };
        let lattice = HexagonalLattice::with_surface_fraction(0.03, 6e-6).offset_by(0.2);
        let system = System::new(lens, material, Texture { pillar, lattice });
        Problem::new(&system.expect("a valid system"))
    }

    fn newton<'a>(problem: &'a Problem, run: &'a Run<'a>) -> Newton<'a> {
        let pair = PairCoupling::new(2, problem.lattice.pitch);
        let window = Window::new(&problem.lattice, 3.0 * problem.lattice.pitch);
        let resolution = Resolution {
            nodes: 8,
            turn: 0.0,
            rings: 10,
        };
        let top = PillarTop::new(resolution, 2, problem.column_compliance_ratio);
        let mut newton = Newton::new(problem, run, Stage::Spectral, window, &pair, top);
        newton.touch_within(0.9 * problem.lattice.pitch);
        newton
    }

    const TARGETS: [Target; 3] = [Target::Indentation(0.3), Target::Force(0.3), Target::Floor];

    /// One number of the data that is none, on any pillar, touched or not, in any mode.
    #[test]
    fn undefined_loads_never_converge() {
        let (problem, run) = (problem(), Run::default());
        for target in TARGETS {
            let outcome = newton(&problem, &run).solve(target, Purpose::Answer);
            assert_eq!(outcome.unwrap().termination, Termination::Converged);
        }
        let size = newton(&problem, &run).own_load.len();
        for place in (0..size).step_by(5) {
            for target in TARGETS {
                let mut newton = newton(&problem, &run);
                newton.own_load[place] = f64::NAN;
                let outcome = newton.solve(target, Purpose::Answer).unwrap();
                assert_ne!(
                    outcome.termination,
                    Termination::Converged,
                    "{place} {target:?}"
                );
            }
        }
    }

    #[test]
    fn undefined_starts_never_converge() {
        let (problem, run) = (problem(), Run::default());
        for target in TARGETS {
            for odd in [f64::NAN, f64::INFINITY] {
                let mut newton = newton(&problem, &run);
                newton.present.far[3] = odd;
                newton.unit.far[3] = odd;
                let outcome = newton.solve(target, Purpose::Answer).unwrap();
                assert_eq!(outcome.termination, Termination::NotFinite, "{target:?}");
            }
        }
    }

    #[test]
    fn undefined_targets_and_pillars_never_converge() {
        let run = Run::default();
        // A refusal is no solution either.
        let solve = |problem: &Problem, target| -> Option<Termination> {
            let (form, purpose) = (PunchForm::Corrected, Purpose::Answer);
            let solution = solve_punch(problem, target, Some(20.0), form, purpose, &run);
            solution.ok().map(|solution| solution.outcome.termination)
        };
        let converged = Some(Termination::Converged);
        for target in TARGETS {
            assert_eq!(solve(&problem(), target), converged);
        }
        for target in [Target::Indentation(f64::NAN), Target::Force(f64::NAN)] {
            assert_ne!(solve(&problem(), target), converged);
        }
        let soft = Problem {
            column_compliance_ratio: f64::NAN,
            ..problem()
        };
        let tall = Problem {
            height: f64::NAN,
            ..problem()
        };
        for target in TARGETS {
            assert_ne!(solve(&soft, target), converged);
        }
        assert_ne!(solve(&tall, Target::Floor), converged);
    }
}
