//! Loading and unloading of rounded tops with adhesion, in SI units.
//!
//! The [path](super::follow) is that of a controlled indentation. With a controlled force, or a machine of finite stiffness, the lens moves by
//! itself from where the controlled quantity would have to turn back to where the path reaches its value again: the same path, with the part in
//! between replaced by a straight line of constant controlled quantity. The work on this line less that on the path is dissipated.

use super::answer::{Bench, degree, with_modes};
use super::equations::Equations;
use super::follow::{Change, Ended, Path, Place, Segment, Stop, crossing};
use super::newton::{Aim, Settled};
use crate::halfspace::disc::basis::mode_count;
use crate::numerics::line::integral_and_negative_part;
use crate::problem::load::Prescribed;
use crate::problem::{
    Accuracy, AsperityArray, CyclePlan, Feature, Load, LoadingMode, Question, Solver,
    UnloadingPoint, Unsupported,
};
use crate::state::asperity_contact::AsperityContact;
use crate::state::asperity_cycle::{
    AsperityCycle, AsperityCycleErrors, AsperityEvent, AsperityLoadStep,
};
use crate::state::discs::{Contacts, Disc};
use crate::state::{
    Branch, Critical, CycleEventKind, Progress, Run, SolveError, Stage, Termination,
};

/// Number of jumps, those that dissipate most, whose energy is computed with a pressure of a higher degree for the error estimate.
const MOST_JUMPS: usize = 6;

/// What a cycle controls, in units of modulus and length.
#[derive(Debug, Clone, Copy)]
struct Driver {
    indentation: f64,
    force: f64,
}

impl Driver {
    fn new(mode: LoadingMode, stiffness_unit: f64) -> Self {
        let [indentation, force] = match mode {
            LoadingMode::Displacement => [1.0, 0.0],
            LoadingMode::Force => [0.0, 1.0],
            LoadingMode::Machine(stiffness) => [1.0, stiffness_unit / stiffness],
        };
        Self { indentation, force }
    }

    fn of(self, [indentation, force]: [f64; 2]) -> f64 {
        self.indentation * indentation + self.force * force
    }

    fn at(self, place: &Place) -> f64 {
        self.of([place.indentation, place.force])
    }

    /// Where the quantity next reaches its value at a place on the path.
    fn stop(self, value: f64) -> Stop {
        if self.indentation > 0.0 {
            Stop::Machine {
                compliance: self.force,
                value,
            }
        } else {
            Stop::Force(value)
        }
    }
}

/// The path that a driver takes.
#[derive(Default)]
struct Driven {
    /// Points of the curve, and for each the work since the one before and its tensile part.
    places: Vec<Place>,
    work: f64,
    tension: f64,
    /// Work of the jumps less that on the path that they replace.
    dissipated: f64,
    /// Whether the lens leaves without reaching the path again.
    leaves: bool,
}

impl Driven {
    /// Takes the parts of a path along which the driver increases to a new largest value, or decreases to a new smallest one if the sign is
    /// negative.
    fn add(&mut self, path: &[Place], driver: Driver, changes: &mut [Change]) {
        let Some(start) = path.first() else {
            return;
        };
        let sign = match start.branch {
            Branch::Loading => 1.0,
            Branch::Unloading => -1.0,
        };
        let value = |place: &Place| sign * driver.at(place);
        let mut best = value(start);
        // The last point before a jump, and the work on the path since then.
        let mut jump: Option<([f64; 2], f64)> = None;
        let point = |place: &Place| [place.indentation, place.force];
        let mut last = *start;
        if start.branch == Branch::Loading {
            self.places.push(*start);
        }
        for place in &path[1..] {
            let whole = place.segment.map_or(0.0, |segment| segment.work(0.0, 1.0));
            let size = best.abs().max(f64::MIN_POSITIVE);
            let goes_on = value(place) >= best - 1e-13 * size;
            match (jump, goes_on) {
                (None, true) => {
                    self.work += whole;
                    self.tension += tension(place, [0.0, 1.0]);
                    self.places.push(*place);
                }
                (None, false) => {
                    jump = Some((point(&last), whole));
                }
                (Some((from, skipped)), false) => jump = Some((from, skipped + whole)),
                (Some((from, skipped)), true) => {
                    // The path reaches the value again within this segment.
                    let part = place.segment.map_or(1.0, |segment| {
                        crossing([0.0, 1.0], |s| sign * driver.of(segment.at(s)) >= best)
                    });
                    let landed = place
                        .segment
                        .map_or(point(place), |segment| segment.at(part));
                    let work =
                        |from, to| place.segment.map_or(0.0, |it: Segment| it.work(from, to));
                    let [of_line, tensile] = integral_and_negative_part([from, landed]);
                    self.dissipated += of_line - skipped - work(0.0, part);
                    self.work += of_line + work(part, 1.0);
                    self.tension += tensile + tension(place, [part, 1.0]);
                    let at = Place {
                        indentation: landed[0],
                        force: landed[1],
                        segment: None,
                        ..*place
                    };
                    let first = self.places.last().map_or(0, |place| place.changes);
                    for change in &mut changes[first..at.changes] {
                        (change.indentation, change.force) = (landed[0], landed[1]);
                    }
                    self.places.extend([at, *place]);
                    jump = None;
                }
            }
            best = best.max(value(place));
            last = *place;
        }
        if let Some((from, skipped)) = jump {
            // The path ends without contact: a machine stops where the force is zero, under a prescribed force the lens leaves.
            let first = self.places.last().map_or(0, |place| place.changes);
            let mut landed = from[0];
            if driver.indentation > 0.0 && last.touched == 0 {
                landed = sign * best;
                let [of_line, tensile] = integral_and_negative_part([from, [landed, 0.0]]);
                self.work += of_line;
                self.tension += tensile;
                self.dissipated += of_line - skipped;
                self.places.push(Place {
                    indentation: landed,
                    segment: None,
                    ..last
                });
            } else {
                self.leaves = true;
            }
            for change in &mut changes[first..last.changes] {
                (change.indentation, change.force) = (landed, 0.0);
            }
        }
    }
}

fn tension(place: &Place, [from, to]: [f64; 2]) -> f64 {
    place
        .segment
        .map_or(0.0, |segment| segment.tension(from, to))
}

impl AsperityArray {
    /// Computes a cycle of loading and unloading with adhesion of the tops.
    ///
    /// A contact begins where an asperity touches the lens, and ends where its equilibrium becomes unstable.
    ///
    /// If the lens reaches the floor before unloading, the floor is part of the equations: it carries pressures, and
    /// detaches without a jump of its own; with [adhesion](crate::problem::Adhesion::floor) the lens jumps onto it, and its fronts dissipate energy. The cycle is then computed on two grids of cells, whose difference is part of the errors.
    ///
    /// ```
    /// use fakir::problem::{
    ///     Accuracy, Adhesion, Asperity, AsperityArray, CyclePlan, Indenter, Material, UnloadingPoint,
    /// };
    /// use fakir::state::Run;
    /// use std::f64::consts::PI;
    ///
    /// // One asperity under a rigid plate: F = -3/2 pi w R (Johnson, Kendall and Roberts).
    /// let asperities = vec![Asperity::new([0.0, 0.0], 1.0e-4)];
    /// let array = AsperityArray::new(Indenter::Flat(None), Material::new(2.0e6, 0.5), asperities)?;
    /// let array = array.with_adhesion(Adhesion::new(50e-3))?;
    /// let plan = CyclePlan { turn: UnloadingPoint::Indentation(1e-6), ..CyclePlan::default() };
    /// let cycle = array.cycle(plan, Accuracy::Default, &Run::default())?;
    /// let pull_off = cycle.pull_off.ok_or("no tension")?.force;
    /// assert!((pull_off / (-1.5 * PI * 50e-3 * 1.0e-4) - 1.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`press`](Self::press); [`SolveError::NoAdhesion`] without adhesion. A part of the critical indentation requires the
    /// [critical state](Self::transition), with its errors.
    pub fn cycle(
        &self,
        plan: CyclePlan,
        accuracy: Accuracy,
        run: &Run<'_>,
    ) -> Result<AsperityCycle, SolveError> {
        let adhesion = self.adhesion();
        if adhesion.is_none() {
            return Err(SolveError::NoAdhesion);
        }
        if adhesion.receding() > adhesion.work {
            return Err(SolveError::Unsupported(Unsupported::BUT_FOR_ONE_WORK));
        }
        Question::Cycle.check(Solver::Asperities, &Feature::of_asperities(self))?;
        let bench = Bench::new(self);
        let plan = bench.checked_plan(plan)?;
        let critical = match plan.turn {
            UnloadingPoint::Critical(_) => Some(self.transition(accuracy, run)?),
            _ => None,
        };
        let of = Cycling {
            bench: &bench,
            plan,
            critical,
            accuracy,
            run,
        };
        let mut equations = Equations::new(&bench.layout, degree(accuracy));
        let mut alone = of.cycle(&mut equations, None)?;
        let Some(depth) = self.floor().filter(|_| self.is_floor_loaded()) else {
            return Ok(alone);
        };
        // The floor is reached at the largest indentation, if anywhere.
        let reached = bench.floor_gap(&alone.turn, depth, run)?;
        alone.turn.floor_gap = alone.turn.floor_gap.or(reached);
        if !alone.converged() || reached.is_none_or(|floor| floor.gap >= 0.0) {
            return Ok(alone);
        }
        let target = match plan.turn {
            UnloadingPoint::Force(force) => Prescribed::Force(force / bench.units.force()),
            _ => Prescribed::Indentation(alone.turn.contacts.indentation),
        };
        let grids = bench.grids(target, &alone.turn, depth, run)?;
        let Some([(mut fine, bound), (mut coarse, _)]) = grids else {
            return Ok(alone);
        };
        let mut found = of.cycle(&mut fine, Some(bound))?;
        let other = of.cycle(&mut coarse, Some(bound))?;
        // Fronts stay until the next cell, which dissipates an energy in proportion to its size.
        let remains = match self.adhesion().floor {
            true => 2.0,
            false => 1.0,
        };
        found.compare(&other, remains);
        if found.converged() {
            // The end of loading, with the floor and with error estimates from three grids.
            let load = Load::Indentation(found.turn.indentation);
            found.turn = self.press(load, accuracy, run)?;
        }
        Ok(found)
    }
}

/// The cycle of an array.
struct Cycling<'a> {
    bench: &'a Bench,
    plan: CyclePlan,
    critical: Option<Critical<AsperityContact>>,
    accuracy: Accuracy,
    run: &'a Run<'a>,
}

impl Cycling<'_> {
    /// The cycle with these equations, of which the floor may be a part, on cells up to a bound of the indentation.
    fn cycle(
        &self,
        equations: &mut Equations<'_>,
        bound: Option<f64>,
    ) -> Result<AsperityCycle, SolveError> {
        let Self {
            bench,
            plan,
            critical,
            accuracy,
            run,
        } = self;
        let (plan, accuracy) = (*plan, *accuracy);
        let mut path = Path::new(equations, bound, run)?;
        let driver = Driver::new(plan.drive, bench.units.stiffness());
        let stop = match plan.turn {
            UnloadingPoint::Indentation(value) => Stop::Indentation(value / bench.units.length),
            UnloadingPoint::Force(value) => Stop::Force(value / bench.units.force()),
            UnloadingPoint::Critical(part) => {
                let found = critical.as_ref().ok_or(SolveError::NoFloor)?;
                Stop::Indentation(part * found.contact.indentation / bench.units.length)
            }
        };
        let mut ended = path.follow(Branch::Loading, stop).err();
        if ended.is_none() {
            // A driver that has been further ahead on the path comes back to it there.
            let places = path.places.iter().map(|place| driver.at(place));
            let most = places.fold(f64::NEG_INFINITY, f64::max);
            let reached = path.places.last().map_or(most, |place| driver.at(place));
            if reached < most - 1e-12 * most.abs() {
                ended = path.follow(Branch::Loading, driver.stop(most)).err();
            }
        }
        let turned = path.places.len();
        let at_turn = path.here.settled.contacts.clone();
        path.equations.close_floor(&at_turn);
        let turn = bench.contact_of(path.equations, &path.here, accuracy);
        let target = match plan.turn {
            UnloadingPoint::Force(_) => Aim::Load(Prescribed::Force(path.here.force)),
            _ => Aim::Load(Prescribed::Indentation(at_turn.indentation)),
        };
        if plan.retract && ended.is_none() {
            // The branch begins where the loading ends.
            path.remark(Branch::Unloading);
            ended = path.follow(Branch::Unloading, Stop::Apart).err();
        }
        let termination = match ended {
            None => (critical.as_ref()).map_or(Termination::Converged, |it| it.contact.termination),
            Some(ended) => bench.termination(ended, &path)?,
        };
        bench.check(path.equations, &at_turn)?;
        let mut driven = Driven::default();
        let mut changes = path.changes.clone();
        let (loading, unloading) = path.places.split_at(turned);
        driven.add(loading, driver, &mut changes);
        let zero_load = zero_load(&driven.places);
        driven.tension = 0.0;
        driven.add(unloading, driver, &mut changes);
        let lowest = path.lowest.take();
        let pull_off = match &lowest {
            Some((contacts, _)) => {
                let settled = Settled {
                    contacts: contacts.clone(),
                    factors: None,
                    steps: 0,
                };
                path.equations.close_floor(contacts);
                let state = path.equations.state(settled);
                Some(bench.contact_of(path.equations, &state, accuracy))
            }
            None => None,
        };
        let closed = plan.retract && termination == Termination::Converged && !driven.leaves;
        let dissipation: f64 = path.jumps.iter().map(|jump| jump.dissipated).sum();
        let energy = bench.units.energy();
        let ends = driven.places.last().map(|place| place.indentation);
        let separation = ends.filter(|_| plan.retract);
        run.report(Progress {
            stage: Stage::ErrorEstimate,
            step: 0,
            pillars: bench.layout.asperities.len(),
            touched: at_turn.discs.len(),
        });
        let mut turn = turn;
        if let (Some(found), UnloadingPoint::Critical(part)) = (critical, plan.turn)
            && part >= 1.0
        {
            turn.floor_gap = found.contact.floor_gap;
        }
        let mut errors = AsperityCycleErrors::default();
        if termination == Termination::Converged {
            if bound.is_none() {
                turn.error = bench.errors_of(&turn, target, run)?;
            }
            errors = bench.cycle_errors(&path, lowest.as_ref().map(|(it, _)| it), accuracy, run)?;
        }
        let mut cycle = AsperityCycle {
            plan,
            accuracy,
            load_steps: driven
                .places
                .iter()
                .map(|place| bench.load_step(place))
                .collect(),
            events: changes.iter().map(|change| bench.event(change)).collect(),
            first_contact: driven.places.iter().position(|place| place.touched > 0),
            zero_load_indentation: zero_load.map(|value| value * bench.units.length),
            critical: critical.clone(),
            turn: turn.checked()?,
            pull_off,
            separation: separation.map(|value| value * bench.units.length),
            work_of_separation: closed.then_some(driven.tension * energy),
            loop_area: closed.then_some(driven.work * energy),
            dissipation: (dissipation + driven.dissipated) * energy,
            errors,
            termination,
        };
        if let Some(balance) = cycle.certificate() {
            cycle.errors.loop_area += balance;
        }
        Ok(cycle)
    }
}

/// Indentation at which the force increases through zero.
fn zero_load(places: &[Place]) -> Option<f64> {
    let pair = places
        .windows(2)
        .find(|pair| pair[0].force < 0.0 && pair[1].force >= 0.0)?;
    let Some(segment) = pair[1].segment else {
        return Some(pair[1].indentation);
    };
    let place = crossing([0.0, 1.0], |s| segment.at(s)[1] < 0.0);
    Some(segment.at(place)[0])
}

impl Bench {
    /// The plan, with its loads checked.
    fn checked_plan(&self, plan: CyclePlan) -> Result<CyclePlan, SolveError> {
        let turn = plan.turn;
        // An indentation may be negative, as its level is arbitrary.
        let plan = match turn {
            UnloadingPoint::Indentation(value) => {
                self.target(Load::Indentation(value))?;
                let checked = CyclePlan {
                    turn: UnloadingPoint::Force(0.0),
                    ..plan
                };
                CyclePlan {
                    turn,
                    ..checked.checked(self.units.length, self.units.pressure)?
                }
            }
            _ => plan.checked(self.units.length, self.units.pressure)?,
        };
        Ok(plan)
    }

    fn load_step(&self, place: &Place) -> AsperityLoadStep {
        let length = self.units.length;
        AsperityLoadStep {
            branch: place.branch,
            indentation: place.indentation * length,
            force: place.force * self.units.force(),
            contact_area: place.area * length * length,
            contact_radius: place.reach * length,
            pillars_in_contact: place.touched,
            events: place.changes,
        }
    }

    fn event(&self, change: &Change) -> AsperityEvent {
        let length = self.units.length;
        AsperityEvent {
            branch: change.branch,
            kind: if change.begins {
                CycleEventKind::SnapIn
            } else {
                CycleEventKind::Release
            },
            asperity: change.asperity,
            apex: self.layout.asperities[change.asperity]
                .apex
                .map(|x| x * length),
            indentation: change.indentation * length,
            force: change.force * self.units.force(),
            radius: change.radius * length,
        }
    }

    /// Errors of the pull-off force and of the energy of jumps, from a pressure of a higher degree.
    fn cycle_errors(
        &self,
        path: &Path<'_, '_, '_>,
        lowest: Option<&Contacts>,
        accuracy: Accuracy,
        run: &Run<'_>,
    ) -> Result<AsperityCycleErrors, SolveError> {
        let low = degree(accuracy);
        let coarse = &*path.equations;
        let mut fine = Equations::new(&self.layout, low + 2);
        fine.ground = coarse.ground.clone();
        let more = |contacts: &Contacts| with_modes(contacts, mode_count(low), mode_count(low + 2));
        let mut errors = AsperityCycleErrors::default();
        // Where the floor alone holds the lens, the error is that of its cells.
        if let Some(contacts) = lowest.filter(|it| !it.discs.is_empty()) {
            let force = coarse.force(contacts);
            let [shape, _] = coarse.shape_errors(contacts);
            let disc = smallest_relative(coarse, contacts);
            let aim = Aim::Radius {
                disc,
                value: contacts.discs[disc].radius,
            };
            errors.pull_off_force = match fine.settle_same(more(contacts), aim, run)? {
                Ok(settled) => {
                    let other = fine.force(&settled.contacts);
                    1.5 * (other / force - 1.0).abs() + (shape / force).abs()
                }
                Err(_) => 1.0,
            };
        }
        let mut jumps: Vec<_> = path.jumps.iter().collect();
        jumps.sort_by(|a, b| b.dissipated.total_cmp(&a.dissipated));
        let rule = fine.rule.clone();
        let (mut off, mut whole) = (0.0, 0.0);
        for jump in jumps.into_iter().take(MOST_JUMPS) {
            whole += jump.dissipated;
            let mut energy = |contacts: &Contacts, aim| {
                if contacts.discs.is_empty() && contacts.bonded.is_empty() {
                    return Ok(Some((0.0, contacts.indentation)));
                }
                let settled = fine.settle_same(more(contacts), aim, run)?.ok();
                Ok::<_, SolveError>(settled.map(|settled| {
                    let energy = fine.energy(&settled.contacts, &rule);
                    (energy, settled.contacts.indentation)
                }))
            };
            let at = |indentation| Aim::Load(Prescribed::Indentation(indentation));
            let aim = match jump.unstable {
                Some(disc) => Aim::Radius {
                    disc,
                    value: jump.before.discs[disc].radius,
                },
                None => at(jump.before.indentation),
            };
            let before = energy(&jump.before, aim)?;
            let after = match before {
                Some((_, indentation)) => energy(&jump.after, at(indentation))?,
                None => None,
            };
            off += match (before, after) {
                (Some((before, _)), Some((after, _))) => before - after - jump.dissipated,
                _ => jump.dissipated,
            };
        }
        if whole > 0.0 {
            errors.loop_area = 1.5 * (off / whole).abs();
        }
        Ok(errors)
    }

    fn termination(
        &self,
        ended: Ended,
        path: &Path<'_, '_, '_>,
    ) -> Result<Termination, SolveError> {
        self.ended(ended, &path.here.settled.contacts, path.here.force)
    }
}

/// The disc that is closest to losing contact: the smallest one in units of that of an isolated contact without load.
fn smallest_relative(equations: &Equations<'_>, contacts: &Contacts) -> usize {
    let relative = |disc: &Disc| {
        let curvature = equations.layout.summits[disc.asperity].curvature;
        disc.radius * curvature.powf(2.0 / 3.0)
    };
    let discs = contacts.discs.iter().enumerate();
    discs
        .min_by(|a, b| relative(a.1).total_cmp(&relative(b.1)))
        .map_or(0, |(number, _)| number)
}
