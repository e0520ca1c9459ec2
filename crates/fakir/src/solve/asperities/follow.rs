//! The path of contacts with adhesion while the lens comes down and goes up.
//!
//! A contact begins where an asperity touches the lens, and has the radius of the solution of Johnson, Kendall and Roberts from then on. It
//! ends where the derivative of the equations with respect to all unknowns, among them the radii, becomes singular: beyond, there is no
//! equilibrium at a smaller indentation, and the contact whose radius changes most is lost. In between, the path is followed in steps of the
//! radius that changes most, along which the indentation may turn back. Both kinds of change are located to rounding errors, and are cascades
//! at a constant indentation, as the gaps and forces of all other asperities change.
//!
//! The path is that of a controlled indentation. A controlled force or a machine skips parts of it: see [`cycle`](super::cycle).

use super::equations::Equations;
use super::load::LoadRule;
use super::newton::{Aim, Settled, Trouble};
use crate::halfspace::disc::basis::UNIT_FORCE;
use crate::numerics::convergence::{larger, smaller};
use crate::numerics::dense::Lu;
use crate::numerics::roots::{Point, find};
use crate::numerics::vector::dot;
use crate::problem::load::Prescribed;
use crate::state::discs::{Contacts, Hold};
use crate::state::{Branch, Run, SolveError};
use std::f64::consts::PI;

/// Largest change of the logarithm of a radius in a step, and the smallest one before the path is given up.
const STRIDE: f64 = 0.05;
const SHORTEST: f64 = 1e-7;

/// Relative accuracy of the radius at which a contact begins or ends.
const LOCATED: f64 = 1e-10;

/// Contacts whose radii change at least this fraction as fast as the fastest one at an instability are lost together.
const TOGETHER: f64 = 0.999;

/// Asperities begin contact together whose overlaps differ by less than this fraction of the overlap of an adhesive contact without load.
const SAME_TOUCH: f64 = 1e-9;

/// Largest number of steps of a branch.
const STEP_LIMIT: usize = 100_000;

/// Derivatives of a state with respect to the indentation, and its stability.
#[derive(Debug, Clone)]
pub(crate) struct Rates {
    /// Changes of all components of a step.
    pub(crate) lowering: Vec<f64>,
    /// Change of the force.
    pub(crate) stiffness: f64,
    /// Sign of the determinant of the equations: it changes where a contact becomes unstable.
    negative: bool,
    /// The disc whose radius changes fastest, and the change of its logarithm.
    fastest: Option<(usize, f64)>,
}

/// A state of the path.
pub(crate) struct Here {
    pub(crate) settled: Settled,
    pub(crate) rates: Rates,
    pub(crate) force: f64,
    /// Overlap with an adhesive floor that is not in contact; minus infinity without one, or in contact.
    pub(crate) floor_overlap: f64,
}

/// A point of the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pub(crate) branch: Branch,
    pub(crate) indentation: f64,
    pub(crate) force: f64,
    pub(crate) area: f64,
    pub(crate) reach: f64,
    pub(crate) touched: usize,
    /// Number of changes up to this point.
    pub(crate) changes: usize,
    /// The curve since the point before; none after a jump.
    pub(crate) segment: Option<Segment>,
}

/// A contact that begins or ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Change {
    pub(crate) branch: Branch,
    pub(crate) begins: bool,
    pub(crate) asperity: usize,
    pub(crate) indentation: f64,
    /// Force after the cascade.
    pub(crate) force: f64,
    /// Radius after the cascade of a contact that begins, and before it of one that ends.
    pub(crate) radius: f64,
    /// Energy that the cascade dissipates, of its first change; zero of the others.
    pub(crate) dissipated: f64,
}

/// States of a jump, for error estimates of its energy.
pub(crate) struct Jump {
    pub(crate) before: Contacts,
    /// The disc whose radius defines an unstable state; none of a state at which an asperity is touched.
    pub(crate) unstable: Option<usize>,
    pub(crate) after: Contacts,
    pub(crate) dissipated: f64,
}

/// The end of a branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stop {
    Indentation(f64),
    /// Where this force is first reached from below.
    Force(f64),
    /// Where the indentation plus the force times this compliance first reaches a value from below.
    Machine {
        compliance: f64,
        value: f64,
    },
    /// Where all contacts are lost.
    Apart,
}

impl From<Prescribed> for Stop {
    fn from(load: Prescribed) -> Self {
        match load {
            Prescribed::Indentation(indentation) => Self::Indentation(indentation),
            Prescribed::Force(force) => Self::Force(force),
        }
    }
}

impl Stop {
    /// How far a state is beyond the load; none without a load.
    fn beyond(self, here: &Here) -> Option<f64> {
        let indentation = here.settled.contacts.indentation;
        match self {
            Self::Indentation(end) => Some(indentation - end),
            Self::Force(force) => Some(here.force - force),
            Self::Machine { compliance, value } => {
                Some(indentation + compliance * here.force - value)
            }
            Self::Apart => None,
        }
    }

    fn aim(self) -> Option<Aim> {
        match self {
            Self::Indentation(end) => Some(Aim::Load(Prescribed::Indentation(end))),
            Self::Force(force) => Some(Aim::Load(Prescribed::Force(force))),
            Self::Machine { compliance, value } => Some(Aim::Machine { compliance, value }),
            Self::Apart => None,
        }
    }
}

/// Why a path ended before its end.
#[derive(Debug)]
pub(crate) enum Ended {
    Trouble(Trouble),
    Error(SolveError),
}

impl From<SolveError> for Ended {
    fn from(error: SolveError) -> Self {
        Self::Error(error)
    }
}

/// What a step is measured by.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Measure {
    Radius(usize),
    Indentation,
}

impl Measure {
    fn of(self, contacts: &Contacts) -> f64 {
        match self {
            Self::Radius(disc) => contacts.discs[disc].radius,
            Self::Indentation => contacts.indentation,
        }
    }

    fn aim(self, value: f64) -> Aim {
        match self {
            Self::Radius(disc) => Aim::Radius { disc, value },
            Self::Indentation => Aim::Load(Prescribed::Indentation(value)),
        }
    }

    /// Change of the measure with the indentation.
    fn rate(self, rates: &Rates, modes: usize) -> f64 {
        match self {
            Self::Radius(disc) => rates.lowering[disc * modes + 2],
            Self::Indentation => 1.0,
        }
    }
}

/// A path.
pub(crate) struct Path<'e, 'l, 'r> {
    pub(crate) equations: &'e mut Equations<'l>,
    pub(super) run: &'e Run<'r>,
    pub(crate) here: Here,
    pub(crate) places: Vec<Place>,
    pub(crate) changes: Vec<Change>,
    pub(crate) jumps: Vec<Jump>,
    /// The state of the smallest force of the unloading, and its place.
    pub(crate) lowest: Option<(Contacts, usize)>,
    pub(super) branch: Branch,
    stride: f64,
    rule: LoadRule,
    /// Sign of the determinant of a single stable contact.
    pub(super) sign: bool,
    /// Indentation at which the first asperity is touched.
    first: f64,
    /// Unit of steps of the indentation while all contacts fill their tops, if that is larger than the overlap of an adhesive contact.
    pub(crate) extent: f64,
}

impl<'e, 'l, 'r> Path<'e, 'l, 'r> {
    /// A path that begins without contact. If the floor is part of the equations, it contains all indentations up to a bound.
    pub(crate) fn new(
        equations: &'e mut Equations<'l>,
        bound: Option<f64>,
        run: &'e Run<'r>,
    ) -> Result<Self, SolveError> {
        let first = match bound {
            Some(bound) => equations.first_touch(bound, run)?,
            None => equations.layout.first_touch(),
        };
        let start = equations.layout.first_touch();
        let untouched = equations
            .layout
            .untouched(if first.is_finite() { first } else { start });
        let sign = equations.sign_of_one(run)?;
        let rule = equations.rule.clone();
        let here = equations.state(Settled {
            contacts: untouched,
            factors: None,
            steps: 0,
        });
        Ok(Self {
            equations,
            run,
            here,
            places: Vec::new(),
            changes: Vec::new(),
            jumps: Vec::new(),
            lowest: None,
            branch: Branch::Loading,
            stride: STRIDE,
            rule,
            sign,
            first,
            extent: 0.0,
        })
    }

    /// A path from a state on.
    pub(crate) fn from(
        equations: &'e mut Equations<'l>,
        here: Here,
        run: &'e Run<'r>,
    ) -> Result<Self, SolveError> {
        let path = Self::new(equations, None, run)?;
        Ok(Self { here, ..path })
    }

    /// Follows a branch to its end.
    pub(crate) fn follow(&mut self, branch: Branch, stop: Stop) -> Result<(), Ended> {
        self.branch = branch;
        self.stride = STRIDE;
        let first = self.first;
        if self.here.settled.contacts.discs.is_empty() {
            if branch == Branch::Unloading {
                return Ok(());
            }
            if let Stop::Indentation(end) = stop
                && end < first
            {
                self.here = self.apart(end)?;
                self.mark(None);
                return Ok(());
            }
            self.here = self.apart(self.here.settled.contacts.indentation)?;
            let is_beyond = stop.beyond(&self.here).is_some_and(|beyond| beyond >= 0.0);
            let on_floor = self.equations.force_on_floor() > 0.0;
            if first.is_infinite() || (on_floor && is_beyond) {
                // The floor alone carries the load.
                return Err(Ended::Trouble(Trouble::Unsettled));
            }
            self.mark(None);
            self.snap_in()?;
            self.rest()?;
        }
        for _ in 0..STEP_LIMIT {
            let ends = self.step(stop)?;
            // Where the floor pulls the lens, the load is reached later.
            let is_short = self.rest()? && stop.beyond(&self.here).is_some_and(|it| it < 0.0);
            if ends && !is_short {
                return Ok(());
            }
        }
        Err(Ended::Trouble(Trouble::Unsettled))
    }

    /// Records the state as the first point of a branch.
    pub(crate) fn remark(&mut self, branch: Branch) {
        self.branch = branch;
        self.mark(None);
    }

    fn direction(&self) -> f64 {
        match self.branch {
            Branch::Loading => 1.0,
            Branch::Unloading => -1.0,
        }
    }

    /// Records the state as a point of the curve.
    fn mark(&mut self, segment: Option<Segment>) {
        let contacts = &self.here.settled.contacts;
        let area: f64 = contacts.discs.iter().map(|disc| disc.radius.powi(2)).sum();
        self.places.push(Place {
            branch: self.branch,
            indentation: contacts.indentation,
            force: self.here.force,
            area: PI * area,
            reach: contacts.reach(),
            touched: contacts.discs.len(),
            changes: self.changes.len(),
            segment,
        });
    }

    /// Elastic energy less the work of adhesion of all contacts.
    pub(super) fn energy(&mut self) -> f64 {
        let contacts = &self.here.settled.contacts;
        // The last floor may be that of an attempt.
        self.equations.close_floor(contacts);
        self.equations.energy(contacts, &self.rule)
    }

    /// The state without contacts at an indentation.
    fn apart(&mut self, indentation: f64) -> Result<Here, Ended> {
        let mut untouched = self.equations.layout.untouched(indentation);
        untouched.bonded = self.here.settled.contacts.bonded.clone();
        if self.equations.ground.is_none() {
            return Ok(self.equations.state(Settled {
                contacts: untouched,
                factors: None,
                steps: 0,
            }));
        }
        self.at(&untouched, Aim::Load(Prescribed::Indentation(indentation)))
    }

    /// The state with the same contacts at this value of the measure.
    pub(super) fn at(&mut self, from: &Contacts, aim: Aim) -> Result<Here, Ended> {
        let settled = self
            .equations
            .settle_same(from.clone(), aim, self.run)?
            .map_err(Ended::Trouble)?;
        Ok(self.equations.state(settled))
    }

    /// Takes a step. Returns whether the end of the branch is reached.
    fn step(&mut self, stop: Stop) -> Result<bool, Ended> {
        let direction = self.direction();
        let modes = self.equations.modes();
        let contacts = &self.here.settled.contacts;
        if contacts.discs.is_empty() && !self.is_on_floor() {
            return self.step_without_contact(stop);
        }
        let left = match stop {
            Stop::Indentation(end) => direction * (end - contacts.indentation),
            Stop::Force(_) | Stop::Machine { .. } | Stop::Apart => f64::INFINITY,
        };
        let is_beyond = stop.beyond(&self.here).is_some_and(|beyond| beyond >= 0.0);
        if self.branch == Branch::Loading && is_beyond {
            return Ok(true);
        }
        let (measure, change, last) = match self.here.rates.fastest {
            Some((disc, rate)) if rate.abs() * left > self.stride => {
                let radius = contacts.discs[disc].radius;
                let grown = radius * (self.stride * (direction * rate).signum()).exp();
                let rate = self.here.rates.lowering[disc * modes + 2];
                let change = (grown - radius) / rate;
                // A contact has no larger radius than its rim.
                let fills = grown >= self.equations.rim(contacts.discs[disc].asperity);
                let measure = match fills {
                    true => Measure::Indentation,
                    false => Measure::Radius(disc),
                };
                (measure, change, false)
            }
            fastest => {
                let scale = self.equations.adhesive_overlap().max(self.extent);
                let most = if fastest.is_some() {
                    f64::INFINITY
                } else {
                    self.stride * scale
                };
                let taken = left.min(most);
                (Measure::Indentation, direction * taken, taken >= left)
            }
        };
        let start = measure.of(contacts);
        let goal = match (measure, stop) {
            (Measure::Indentation, Stop::Indentation(end)) if last => end,
            _ => start + change * measure.rate(&self.here.rates, modes),
        };
        let predicted = self
            .equations
            .predicted(contacts, &self.here.rates.lowering, change);
        let next = match self.at(&predicted, measure.aim(goal)) {
            Ok(next) => next,
            Err(Ended::Trouble(trouble)) => {
                self.stride *= 0.5;
                if self.stride > SHORTEST {
                    return Ok(false);
                }
                return match (trouble, self.here.rates.fastest) {
                    (Trouble::Crowded(_) | Trouble::NotFinite, _) | (_, None) => {
                        Err(Ended::Trouble(trouble))
                    }
                    // No equilibrium is found any nearer: a contact is lost.
                    (Trouble::Unsettled, Some((disc, _))) => {
                        self.stride = STRIDE;
                        self.release(disc).map(|()| false)
                    }
                };
            }
            Err(error) => return Err(error),
        };
        let alike = next.is_held_as(&self.here);
        // Contacts that become unstable together may leave the sign of the determinant.
        let turns = match measure {
            Measure::Radius(disc) => {
                let place = disc * modes + 2;
                let rates = [&self.here, &next].map(|here| here.rates.lowering[place]);
                rates[0].signum() != rates[1].signum()
            }
            Measure::Indentation => false,
        };
        let here = self.here.settled.contacts.indentation;
        let back = direction * (next.settled.contacts.indentation - here) < 0.0;
        if !alike && (back || turns) {
            // A contact that reaches or leaves its rim while another is lost: the step is repeated with half its length.
            self.stride *= 0.5;
            if self.stride > SHORTEST {
                return Ok(false);
            }
            let disc = self.here.rates.fastest.map_or(0, |(disc, _)| disc);
            self.stride = STRIDE;
            return self.release(disc).map(|()| false);
        }
        let mut step = Step {
            measure,
            next,
            end: if last { Event::End } else { Event::None },
        };
        let unstable = step.next.rates.negative != self.here.rates.negative;
        if alike && (unstable || turns || back) {
            step = self.until_unstable(step)?;
        }
        let Some(mut step) = self.until_touched(step)? else {
            return self.snap_in().map(|()| false);
        };
        let ends = [&self.here, &step.next].map(|here| stop.beyond(here));
        if self.branch == Branch::Loading
            && let [Some(before), Some(after)] = ends
            && before < 0.0
            && after >= 0.0
            && let Some(aim) = stop.aim()
        {
            let part = before / (before - after);
            let from = &self.here.settled.contacts;
            let from = from.between(&step.next.settled.contacts, part);
            step.next = self.at(&from, aim)?;
            step.end = Event::End;
        }
        self.stop_at_lowest(&step)?;
        self.take(step.measure, step.next);
        self.stride = (1.6 * self.stride).min(STRIDE);
        match step.end {
            Event::None => Ok(false),
            Event::End => Ok(true),
            Event::Touched => self.snap_in().map(|()| false),
            Event::Unstable(disc) => self.release(disc).map(|()| false),
        }
    }

    /// Above all asperities, after the last contact was lost.
    fn step_without_contact(&mut self, stop: Stop) -> Result<bool, Ended> {
        if self.branch == Branch::Unloading {
            return match self.here.force > 0.0 {
                // The floor still carries load.
                true => Err(Ended::Trouble(Trouble::Unsettled)),
                false => Ok(true),
            };
        }
        // A contact that was lost during loading begins again where its asperity is touched.
        let first = self.first;
        let here = self.here.settled.contacts.indentation;
        if let Stop::Indentation(end) = stop
            && (end < first || here >= end)
        {
            return Ok(true);
        }
        if here > first {
            return Err(Ended::Trouble(Trouble::Unsettled));
        }
        self.here = self.apart(first)?;
        self.snap_in().map(|()| false)
    }

    /// Shortens a step that ends beyond an instability.
    fn until_unstable(&mut self, step: Step) -> Result<Step, Ended> {
        let modes = self.equations.modes();
        let Measure::Radius(disc) = step.measure else {
            // The indentation of a stable path is monotonic: the step is too long to see how the contact is lost.
            return Ok(Step {
                end: Event::Unstable(self.fastest_of(&step.next)),
                ..step
            });
        };
        let place = disc * modes + 2;
        let turned = |here: &Here| here.rates.lowering[place].recip();
        let ends = [&self.here, &step.next].map(|here| Point {
            position: here.settled.contacts.discs[disc].radius,
            value: turned(here),
        });
        let from = step.next.settled.contacts.clone();
        let mut nearest = from;
        let root = find(ends, LOCATED, |radius| {
            let here = self.at(
                &nearest,
                Aim::Radius {
                    disc,
                    value: radius,
                },
            )?;
            let value = turned(&here);
            nearest = here.settled.contacts;
            Ok::<_, Ended>(value)
        })?;
        let Some(root) = root else {
            return Ok(step);
        };
        let radius = root.closest().position;
        let next = self.at(
            &nearest,
            Aim::Radius {
                disc,
                value: radius,
            },
        )?;
        let end = Event::Unstable(self.fastest_of(&next));
        Ok(Step { next, end, ..step })
    }

    pub(super) fn fastest_of(&self, here: &Here) -> usize {
        here.rates.fastest.map_or(0, |(disc, _)| disc)
    }

    /// Shortens a step that ends beyond the first touch of another asperity; none if it is touched where the step begins.
    fn until_touched(&mut self, step: Step) -> Result<Option<Step>, Ended> {
        let tiny = SAME_TOUCH * self.equations.adhesive_overlap();
        // Fronts begin by themselves on a floor that the lens has entered already.
        let may_begin = self.here.floor_overlap < -tiny;
        let overlap = |equations: &Equations<'_>, here: &Here| {
            let of_tops = equations.largest_overlap(&here.settled.contacts);
            let of_floor = may_begin.then_some(here.floor_overlap);
            larger(of_tops, of_floor.unwrap_or(f64::NEG_INFINITY))
        };
        let [before, after] = [&self.here, &step.next].map(|here| overlap(self.equations, here));
        if after <= 0.0 {
            return Ok(Some(step));
        }
        let measure = step.measure;
        if before >= -tiny {
            return Ok(None);
        }
        let place = |here: &Here, value: f64| Point {
            position: measure.of(&here.settled.contacts),
            value,
        };
        let ends = [place(&self.here, before), place(&step.next, after)];
        let [start, end] = [&self.here, &step.next].map(|here| here.settled.contacts.clone());
        let at = |value: f64| {
            let part = (value - ends[0].position) / (ends[1].position - ends[0].position);
            start.between(&end, part)
        };
        let root = find(ends, LOCATED, |value| {
            let here = self.at(&at(value), measure.aim(value))?;
            let overlap = overlap(self.equations, &here);
            // Rounding errors of the solution end the search.
            Ok::<_, Ended>(if overlap.abs() < 1e-4 * tiny {
                0.0
            } else {
                overlap
            })
        })?;
        let Some(root) = root else {
            return Ok(Some(step));
        };
        let value = root.closest().position;
        let next = self.at(&at(value), measure.aim(value))?;
        Ok(Some(Step {
            next,
            end: Event::Touched,
            ..step
        }))
    }

    /// Takes a part of a step up to the smallest force of an unloading, if it is in the step.
    fn stop_at_lowest(&mut self, step: &Step) -> Result<(), Ended> {
        if self.branch == Branch::Loading {
            return Ok(());
        }
        let modes = self.equations.modes();
        let measure = step.measure;
        let slope = |here: &Here| here.rates.stiffness / measure.rate(&here.rates, modes);
        let place = |here: &Here| Point {
            position: measure.of(&here.settled.contacts),
            value: slope(here),
        };
        let ends = [place(&self.here), place(&step.next)];
        let known = self
            .lowest
            .as_ref()
            .map_or(0.0, |(_, number)| self.places[*number].force);
        let lower = self.here.force.min(step.next.force);
        let turns = self.here.rates.stiffness > 0.0 && ends[0].value * ends[1].value < 0.0;
        if !turns || lower - 0.1 * lower.abs() > known {
            return Ok(());
        }
        let [start, end] = [&self.here, &step.next].map(|here| here.settled.contacts.clone());
        let at = |value: f64| {
            let part = (value - ends[0].position) / (ends[1].position - ends[0].position);
            start.between(&end, part)
        };
        let root = find(ends, LOCATED, |value| {
            let here = self.at(&at(value), measure.aim(value))?;
            Ok::<_, Ended>(slope(&here))
        })?;
        if let Some(root) = root {
            let value = root.closest().position;
            let next = self.at(&at(value), measure.aim(value))?;
            self.take(measure, next);
        }
        Ok(())
    }

    /// Moves to a state and records it.
    fn take(&mut self, measure: Measure, next: Here) {
        let modes = self.equations.modes();
        let end = |here: &Here| {
            let rate = measure.rate(&here.rates, modes);
            End {
                at: measure.of(&here.settled.contacts),
                indentation: here.settled.contacts.indentation,
                force: here.force,
                slopes: [rate.recip(), here.rates.stiffness / rate],
            }
        };
        let segment = Segment([end(&self.here), end(&next)]);
        self.here = next;
        self.mark(Some(segment));
        self.remember_lowest();
    }

    fn remember_lowest(&mut self) {
        let number = self.places.len() - 1;
        let known = self
            .lowest
            .as_ref()
            .map_or(0.0, |(_, place)| self.places[*place].force);
        if self.branch == Branch::Unloading && self.places[number].force < known {
            self.lowest = Some((self.here.settled.contacts.clone(), number));
        }
    }

    /// Begins contact on all asperities that are touched, or on the floor, at a constant indentation.
    fn snap_in(&mut self) -> Result<(), Ended> {
        let before = self.energy();
        let old = self.here.settled.contacts.clone();
        let number = self.changes.len();
        let tiny = SAME_TOUCH * self.equations.adhesive_overlap();
        // The first one is touched up to rounding errors.
        let most = self.equations.largest_overlap(&old);
        if self.here.floor_overlap > most {
            self.touch_floor()?;
        } else {
            self.touch_all(most.min(0.0) - tiny)?;
        }
        self.finish_jump(before, old, None, number);
        Ok(())
    }

    /// Adds contacts until no asperity overlaps with the lens.
    pub(super) fn touch_all(&mut self, least: f64) -> Result<(), Ended> {
        let mut least = least;
        loop {
            let contacts = &self.here.settled.contacts;
            let waiting = self.equations.waiting(contacts).into_iter();
            let fresh: Vec<(usize, f64)> = waiting
                .map(|asperity| (asperity, -contacts.gaps[asperity]))
                .filter(|(_, overlap)| *overlap > least)
                .filter(|(asperity, _)| {
                    self.equations
                        .is_inside(*asperity, contacts.nearest[*asperity])
                })
                .map(|(asperity, overlap)| (asperity, overlap.max(0.0)))
                .collect();
            if fresh.is_empty() {
                return Ok(());
            }
            let indentation = contacts.indentation;
            let start = self.equations.with_contacts(contacts, &fresh);
            let aim = Aim::Load(Prescribed::Indentation(indentation));
            let next = self.at(&start, aim)?;
            if next.is_stable(self.sign) == Some(false) {
                return Err(Ended::Trouble(Trouble::Unsettled));
            }
            for (asperity, _) in fresh {
                self.changes.push(Change {
                    branch: self.branch,
                    begins: true,
                    asperity,
                    indentation,
                    force: 0.0,
                    radius: 0.0,
                    dissipated: 0.0,
                });
            }
            self.here = next;
            least = 0.0;
        }
    }

    /// Ends contacts at a constant indentation: that of this disc and of all that change as fast, then others as long as there is no stable
    /// equilibrium.
    fn release(&mut self, disc: usize) -> Result<(), Ended> {
        let before = self.energy();
        let number = self.changes.len();
        let old = self.here.settled.contacts.clone();
        self.detach(&old, disc)?;
        self.touch_all(0.0)?;
        self.finish_jump(before, old, Some(disc), number);
        Ok(())
    }

    /// Ends the contact of a disc and of others, until there is a stable equilibrium with the rest of these contacts.
    pub(super) fn detach(&mut self, old: &Contacts, disc: usize) -> Result<(), Ended> {
        let modes = self.equations.modes();
        let indentation = old.indentation;
        let rate = |k: usize| (self.here.rates.lowering[k * modes + 2] / old.discs[k].radius).abs();
        let rates: Vec<f64> = (0..old.discs.len()).map(rate).collect();
        let mut order: Vec<usize> = (0..rates.len()).collect();
        order.sort_by(|a, b| rates[*b].total_cmp(&rates[*a]).then(a.cmp(b)));
        let most = rates[disc];
        let mut count = order
            .iter()
            .filter(|k| rates[**k] >= TOGETHER * most)
            .count();
        count = count.max(1);
        let next = loop {
            let lost = &order[..count];
            let rest = self.equations.without(old, lost);
            if rest.discs.is_empty() {
                break self.apart(indentation)?;
            }
            let aim = Aim::Load(Prescribed::Indentation(indentation));
            match self.at(&rest, aim) {
                Ok(next) if next.is_stable(self.sign) != Some(false) => break next,
                Ok(_) | Err(Ended::Trouble(_)) => {}
                Err(error) => return Err(error),
            }
            let last = rates[order[count]];
            let same = order[count..]
                .iter()
                .take_while(|k| rates[**k] >= TOGETHER * last);
            count += same.count().max(1);
        };
        for k in &order[..count] {
            self.changes.push(Change {
                branch: self.branch,
                begins: false,
                asperity: old.discs[*k].asperity,
                indentation,
                force: 0.0,
                radius: old.discs[*k].radius,
                dissipated: 0.0,
            });
        }
        self.here = next;
        Ok(())
    }

    /// Completes the changes of a cascade, from the number of the first one.
    pub(super) fn finish_jump(
        &mut self,
        before: f64,
        old: Contacts,
        unstable: Option<usize>,
        first: usize,
    ) {
        let dissipated = before - self.energy();
        let contacts = &self.here.settled.contacts;
        for (k, change) in self.changes[first..].iter_mut().enumerate() {
            change.force = self.here.force;
            if change.begins {
                let disc = contacts
                    .discs
                    .iter()
                    .find(|disc| disc.asperity == change.asperity);
                change.radius = disc.map_or(0.0, |disc| disc.radius);
            }
            if k == 0 {
                change.dissipated = dissipated;
            }
        }
        self.jumps.push(Jump {
            before: old,
            unstable,
            after: contacts.clone(),
            dissipated,
        });
        self.mark(None);
        self.remember_lowest();
    }
}

/// A step and what is at its end.
struct Step {
    measure: Measure,
    next: Here,
    end: Event,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Event {
    None,
    End,
    Touched,
    Unstable(usize),
}

/// An end of a step: the measure, indentation and force, and the derivatives of the last two with respect to the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct End {
    at: f64,
    indentation: f64,
    force: f64,
    slopes: [f64; 2],
}

/// A part of the curve: cubics through values and derivatives of indentation and force at both ends, as functions of a number from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Segment([End; 2]);

impl Segment {
    /// Coefficients of indentation and force.
    fn cubics(&self) -> [[f64; 4]; 2] {
        let Self(ends) = self;
        let width = ends[1].at - ends[0].at;
        let cubic = |values: [f64; 2], k: usize| {
            let slopes = ends.map(|end| width * end.slopes[k]);
            let rise = values[1] - values[0];
            [
                values[0],
                slopes[0],
                3.0 * rise - 2.0 * slopes[0] - slopes[1],
                slopes[0] + slopes[1] - 2.0 * rise,
            ]
        };
        [
            cubic(ends.map(|end| end.indentation), 0),
            cubic(ends.map(|end| end.force), 1),
        ]
    }

    /// Indentation and force.
    pub(crate) fn at(&self, s: f64) -> [f64; 2] {
        self.cubics()
            .map(|c| c[0] + s * (c[1] + s * (c[2] + s * c[3])))
    }

    /// Work of the force on the lens between two places.
    pub(crate) fn work(&self, from: f64, to: f64) -> f64 {
        let [indentation, force] = self.cubics();
        let at = |c: [f64; 4], s: f64| c[0] + s * (c[1] + s * (c[2] + s * c[3]));
        let slope = |c: [f64; 4], s: f64| c[1] + s * (2.0 * c[2] + s * 3.0 * c[3]);
        let half = 0.5 * (to - from);
        let root = 0.6f64.sqrt();
        // Gauss's rule with three points is exact for this polynomial.
        [(-root, 5.0 / 9.0), (0.0, 8.0 / 9.0), (root, 5.0 / 9.0)]
            .map(|(x, weight)| {
                let s = from + half * (1.0 + x);
                half * weight * at(force, s) * slope(indentation, s)
            })
            .iter()
            .sum()
    }

    /// The part of the work between two places under tension.
    pub(crate) fn tension(&self, from: f64, to: f64) -> f64 {
        let force = |s: f64| self.at(s)[1];
        match [from, to].map(|s| force(s) < 0.0) {
            [true, true] => self.work(from, to),
            [false, false] => 0.0,
            [first, _] => {
                let zero = crossing([from, to], |s| force(s) < 0.0);
                if first {
                    self.work(from, zero)
                } else {
                    self.work(zero, to)
                }
            }
        }
    }
}

/// Where a condition changes between two places.
pub(crate) fn crossing([mut low, mut high]: [f64; 2], is: impl Fn(f64) -> bool) -> f64 {
    let first = is(low);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if is(middle) == first {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

impl Here {
    /// Whether all contacts are held at their edges as in another state.
    fn is_held_as(&self, other: &Self) -> bool {
        let holds = |here: &Self| -> Vec<_> {
            let discs = here.settled.contacts.discs.iter();
            discs
                .map(|disc| std::mem::discriminant(&disc.hold))
                .collect()
        };
        holds(self) == holds(other)
    }

    /// Whether the contacts are stable, as far as the sign of the determinant tells; unknown if some are held at rims.
    pub(super) fn is_stable(&self, sign_of_one: bool) -> Option<bool> {
        let discs = &self.settled.contacts.discs;
        let free = discs.iter().all(|disc| disc.hold == Hold::Free);
        let expected = sign_of_one && discs.len() % 2 == 1;
        free.then_some(self.rates.negative == expected)
    }
}

impl Equations<'_> {
    /// A solution with its derivatives.
    pub(crate) fn state(&self, settled: Settled) -> Here {
        let contacts = &settled.contacts;
        let modes = self.modes();
        let force = self.force(contacts);
        let rates = match &settled.factors {
            Some(factors) if !contacts.discs.is_empty() => {
                let lowering = self.lowering(factors, contacts.moments.len());
                let discs = contacts.discs.iter().enumerate();
                let fastest = discs
                    .filter(|(_, disc)| disc.hold != Hold::Whole)
                    .map(|(k, disc)| (k, lowering[k * modes + 2] / disc.radius))
                    .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
                Rates {
                    stiffness: self.stiffness(contacts, &lowering),
                    negative: factors.has_negative_determinant(),
                    fastest,
                    lowering,
                }
            }
            _ => Rates {
                lowering: Vec::new(),
                stiffness: self.floor_rates().map_or(0.0, |floor| floor.force),
                negative: false,
                fastest: None,
            },
        };
        Here {
            settled,
            rates,
            force,
            floor_overlap: self.floor_overlap(),
        }
    }

    /// The largest overlap of an asperity that is not in contact; minus infinity if all are.
    pub(super) fn largest_overlap(&self, contacts: &Contacts) -> f64 {
        let waiting = self.waiting(contacts).into_iter();
        let inside = waiting.filter(|k| self.is_inside(*k, contacts.nearest[*k]));
        inside
            .map(|asperity| -contacts.gaps[asperity])
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// The largest overlap of an isolated contact with adhesion and no load, as a scale.
    pub(crate) fn adhesive_overlap(&self) -> f64 {
        let pull = PI * self.grip;
        let summits = self.layout.summits.iter();
        let overlaps = summits.map(|summit| {
            let radius = (2.0 * pull / summit.curvature).powf(2.0 / 3.0);
            summit.curvature * radius * radius
        });
        overlaps.fold(0.0, f64::max)
    }

    /// Elastic energy less the work of adhesion of all contacts, in units of modulus and length. The floor must be closed under these contacts.
    pub(crate) fn energy(&self, contacts: &Contacts, rule: &LoadRule) -> f64 {
        let size = self.modes();
        let mut load = rule.workspace();
        let discs = contacts.discs.iter();
        let parts = discs
            .zip(contacts.moments.chunks_exact(size))
            .map(|(disc, moments)| {
                let overlap = |point| self.overlap(disc.asperity, point);
                rule.fill(overlap, (disc.centre, disc.radius), &mut load);
                load.value[0] += UNIT_FORCE * contacts.indentation;
                // The work of adhesion is pi grip^2/2 in units of the modulus.
                let area = PI * disc.radius * disc.radius;
                0.5 * dot(&load.value, moments) - 0.5 * PI * disc.grip * disc.grip * area
            });
        let on_floor = self.ground.as_ref();
        let on_floor = on_floor.map_or(0.0, |ground| ground.energy(contacts.indentation));
        parts.sum::<f64>() + on_floor
    }

    /// Indentation at which the first asperity is touched; infinite if the floor carries all of the load up to the bound.
    fn first_touch(&mut self, bound: f64, run: &Run<'_>) -> Result<f64, SolveError> {
        let first = self.layout.first_touch();
        if let Some(ground) = self.ground.as_ref().filter(|ground| ground.is_adhesive()) {
            return Ok(smaller(first, ground.first_touch()));
        }
        let mut overlap = |indentation: f64| {
            let untouched = self.layout.untouched(indentation);
            let aim = Aim::Load(Prescribed::Indentation(indentation));
            let settled = self.settle_same(untouched, aim, run)?;
            let overlap = settled.map(|settled| self.largest_overlap(&settled.contacts));
            Ok::<_, SolveError>((overlap.unwrap_or(f64::NAN), self.force_on_floor()))
        };
        // A pressure on the floor lowers the tops.
        let (_, force) = overlap(first)?;
        if force <= 0.0 {
            return Ok(first);
        }
        let (mut low, mut high) = (first, bound);
        if overlap(high)?.0 < 0.0 {
            return Ok(f64::INFINITY);
        }
        while high - low > LOCATED * (high - first) {
            let middle = 0.5 * (low + high);
            match overlap(middle)?.0 < 0.0 {
                true => low = middle,
                false => high = middle,
            }
        }
        Ok(high)
    }

    /// Sign of the determinant of a single stable contact.
    fn sign_of_one(&self, run: &Run<'_>) -> Result<bool, SolveError> {
        let layout = self.layout.only_first();
        let mut one = Equations::new(&layout, self.degree());
        let alone = layout.untouched(layout.first_touch());
        let start = one.with_contacts(&alone, &[(0, 0.0)]);
        let aim = Aim::Load(Prescribed::Indentation(alone.indentation));
        let factors = one.settle_same(start, aim, run)?.ok();
        let factors: Option<Lu> = factors.and_then(|settled| settled.factors);
        Ok(factors.is_some_and(|factors| factors.has_negative_determinant()))
    }
}
