//! The contact of viscoelastic bodies for any history of force or indentation, from the elastic loading curve.
#![doc = ""]
#![doc = include_str!("../../doc/rendered/viscoelastic.md")]

use super::elastic_curve::ElasticCurve;
use crate::numerics::convergence::larger;
use crate::numerics::quadrature::gauss_legendre;
use crate::numerics::roots::{self, Point};
use crate::problem::{Creep, Prescribed, Protocol, Relaxation, RelaxationTerm};
use crate::state::{Approximation, History, HistoryEvent, HistoryEventKind, HistoryState};

/// Nodes of the quadrature over a time step. The integrands are analytic in the steps, except for kinks of the elastic curve.
const NODES: usize = 12;

/// Ends of the intervals of the quadrature before the end of a step, in relaxation times: the memories decay over these.
const DECAYS: [f64; 6] = [30.0, 14.0, 6.0, 2.5, 1.0, 0.3];

/// Relative rounding of indentations.
const ROUNDING: f64 = 1e-12;

/// Errors of force and indentation, relative to the largest, at which the steps are short enough.
const TOLERANCE: f64 = 1e-4;

/// Steps in a segment with which the computation starts, and the largest number.
const FEWEST_STEPS: usize = 24;
const MOST_STEPS: usize = 384;

/// Number of steps of all segments up to which they are made shorter.
const MOST_STEPS_IN_ALL: usize = 6000;

/// Levels that the solution starts with for every step of a segment.
const LEVELS_PER_STEP: usize = 4;

/// Distance from equilibrium at which it counts as reached.
const SETTLED: f64 = 0.01;

/// Beginning of a logarithmic division of a segment, relative to the shortest relaxation time.
const FIRST_STEP: f64 = 0.1;

/// Error of linear interpolation at which a level is left out.
const LEFT_OUT: f64 = 1e-7;

/// The same for measured loads.
const LEFT_OUT_OF_MEASURED: f64 = 1e-5;

/// A contact under measured loads recedes if it is smaller than the largest one by this part of the range of the loads; smaller reversals are
/// noise. Superposition is continued over these, with a relative error of the force of the order of the square.
const REVERSAL: f64 = 0.02;

/// Steps that determine the levels with which the time steps of measured loads begin, and the largest number of measured ones among them.
const STEPS_OF_MEASURED: usize = 24;
const MEASURED_LEVELS: usize = 60;

/// Largest change of a measured position in a time step, relative to the range, and longest time step, relative to the shortest relaxation time;
/// and the largest number of steps between two measured loads.
const LONGEST_CHANGE: f64 = 0.02;
const LONGEST_STEP: f64 = 0.5;
const MOST_PARTS_OF_STEP: f64 = 8.0;

/// Times that a bracket of the indentation is widened.
const WIDENINGS: usize = 60;

/// Computes the contact over time from the elastic curve at the relaxed modulus. `critical` is the indentation at which the lens reaches the
/// floor, m, if there is a floor.
#[must_use]
pub fn history(
    curve: &ElasticCurve,
    relaxation: &Relaxation,
    protocol: &Protocol,
    critical: Option<f64>,
) -> History {
    let body = Body::new(curve, relaxation, critical);
    let mut steps = FEWEST_STEPS;
    let mut coarse = body.solved(protocol, steps, true);
    let count = protocol.segments().len().max(1);
    loop {
        let mut fine = body.solved(protocol, 2 * steps, true);
        let [force_error, indentation_error] = fine.differences(&coarse);
        steps *= 2;
        let is_enough = force_error.max(indentation_error) <= TOLERANCE;
        if is_enough || 2 * steps > MOST_STEPS || 2 * steps * count > MOST_STEPS_IN_ALL {
            fine.set_time_errors(&coarse);
            return body.finished(protocol, fine, [force_error, indentation_error]);
        }
        coarse = fine;
    }
}

/// A load measured at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredLoad {
    /// Time, s.
    pub time: f64,
    /// The force, N, or the position of the machine from which the indentation follows, m.
    pub load: f64,
}

/// What was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MeasuredBy {
    /// The force.
    Force,
    /// A position, which is the indentation plus this compliance (m/N) times the force.
    Position {
        /// Compliance, m/N.
        compliance: f64,
    },
}

/// Computes the states at measured loads, in the order of their times: the indentation, or the force, is linear in time between them. Before the
/// first load there is no contact; a first load in contact is reached in a step. By superposition until the contact recedes by more than noise, by
/// time steps from the largest contact on. `None` if no indentation belongs to a position, as the compliance is negative.
#[must_use]
pub fn measured_history(
    curve: &ElasticCurve,
    relaxation: &Relaxation,
    by: MeasuredBy,
    loads: &[MeasuredLoad],
) -> Option<Vec<HistoryState>> {
    Body::new(curve, relaxation, None).measured(by, loads)
}

/// The same by time steps alone, of which there are `steps` in every segment. For comparisons.
#[doc(hidden)]
#[must_use]
pub fn history_by_steps(
    curve: &ElasticCurve,
    relaxation: &Relaxation,
    protocol: &Protocol,
    critical: Option<f64>,
    steps: usize,
) -> History {
    let body = Body::new(curve, relaxation, critical);
    let mut fine = body.solved(protocol, steps, false);
    let coarse = body.solved(protocol, steps.div_ceil(2), false);
    let errors = fine.differences(&coarse);
    fine.set_time_errors(&coarse);
    body.finished(protocol, fine, errors)
}

/// The elastic curve, and the relaxation with everything that follows from it.
struct Body<'a> {
    curve: &'a ElasticCurve,
    critical: Option<f64>,
    terms: Vec<RelaxationTerm>,
    creep: Creep,
    instantaneous: f64,
    longest: f64,
    shortest: f64,
    /// From the memories of stress to those of strain, and back.
    to_strain: Vec<Vec<f64>>,
    to_stress: Vec<Vec<f64>>,
    quadrature: Vec<(f64, f64)>,
}

/// States with the events, and what is needed to continue.
struct Solved {
    states: Vec<HistoryState>,
    events: Vec<HistoryEvent>,
    /// The memories of the force if the contact has only grown.
    grown: Option<Growing>,
    steps: usize,
}

/// The state of a contact that has only grown.
#[derive(Debug, Clone)]
struct Growing {
    time: f64,
    force: f64,
    /// Indentation, and level of the front.
    indentation: f64,
    /// `∫ exp(-(t - s)/tau_k) F^(s) ds/tau_k` of every term, for the force and the floor force.
    memory: [Vec<f64>; 2],
    /// What was prescribed so far.
    parts: Vec<Part>,
}

/// A time step of growing contact: the indentation changes linearly, or the force.
#[derive(Debug, Clone)]
struct Part {
    times: [f64; 2],
    levels: [f64; 2],
    /// With a prescribed force: the force at both ends, and the memories of it at the beginning.
    force: Option<([f64; 2], Vec<f64>)>,
}

/// What a state must fulfil.
#[derive(Debug, Clone, Copy)]
enum Target {
    /// A force, N.
    Force(f64),
    /// An indentation plus a compliance (m/N) times the force, m.
    Position { value: f64, compliance: f64 },
}

impl Target {
    fn of(prescribed: Prescribed, value: f64) -> Self {
        match prescribed {
            Prescribed::Force => Self::Force(value),
            Prescribed::Indentation => Self::Position {
                value,
                compliance: 0.0,
            },
        }
    }
}

impl<'a> Body<'a> {
    fn new(curve: &'a ElasticCurve, relaxation: &Relaxation, critical: Option<f64>) -> Self {
        let (terms, creep) = (relaxation.distinct(), relaxation.creep());
        let to_strain = terms.iter().map(|term| {
            let of = |slow: &RelaxationTerm| slow.strength * slow.time / (slow.time - term.time);
            creep.terms().iter().map(of).collect()
        });
        let to_stress = creep.terms().iter().map(|slow| {
            let of = |term: &RelaxationTerm| term.strength * term.time / (slow.time - term.time);
            terms.iter().map(of).collect()
        });
        Self {
            to_strain: to_strain.collect(),
            to_stress: to_stress.collect(),
            curve,
            critical: critical.filter(|critical| critical.is_finite()),
            instantaneous: relaxation.instantaneous(),
            longest: creep.longest_time(),
            shortest: relaxation.shortest_time(),
            terms,
            creep,
            quadrature: gauss_legendre(NODES),
        }
    }

    /// The states at the ends of `steps` steps in every segment.
    fn solved(&self, protocol: &Protocol, steps: usize, superpose: bool) -> Solved {
        let mut growing = self.untouched(0.0);
        let mut bed = (!superpose).then(|| Bed::new(self, &growing, steps, usize::MAX));
        let mut solved = Solved {
            states: vec![self.state_of(&growing)],
            events: Vec::new(),
            grown: None,
            steps: 0,
        };
        let mut time = 0.0;
        for segment in protocol.segments() {
            let last = solved.states[solved.states.len() - 1];
            let from = match segment.prescribed {
                Prescribed::Force => last.force,
                Prescribed::Indentation => last.indentation,
            };
            let times = self.division(segment.duration, steps);
            for pair in times.windows(2) {
                let value = |t: f64| from + t / segment.duration * (segment.to - from);
                let ends = [time + pair[0], time + pair[1]];
                let values = if segment.duration > 0.0 {
                    [value(pair[0]), value(pair[1])]
                } else {
                    [from, segment.to]
                };
                solved.steps += 1;
                let bed = match &mut bed {
                    Some(bed) => bed,
                    None => {
                        match self.grow(&mut growing, segment.prescribed, ends, values) {
                            None => {
                                solved.push_grown(self, &growing);
                                continue;
                            }
                            Some(end) => {
                                // The contact grew up to this time, and recedes from there on.
                                if end > growing.time {
                                    let part = (end - ends[0]) / (ends[1] - ends[0]);
                                    let middle = values[0] + part * (values[1] - values[0]);
                                    let ended = self.grow(
                                        &mut growing,
                                        segment.prescribed,
                                        [ends[0], end],
                                        [values[0], middle],
                                    );
                                    if ended.is_none() {
                                        solved.push_grown(self, &growing);
                                    }
                                }
                                bed.insert(Bed::new(self, &growing, steps, usize::MAX))
                            }
                        }
                    }
                };
                let target = |at: f64| {
                    let part = (at - ends[0]) / (ends[1] - ends[0]);
                    let value = if at < ends[1] {
                        values[0] + part * (values[1] - values[0])
                    } else {
                        values[1]
                    };
                    Target::of(segment.prescribed, value)
                };
                let change = bed.contact_change(self, &target, ends[1]);
                for end in change.into_iter().chain([ends[1]]) {
                    bed.step(self, target(end), end);
                    solved.push(bed.state(self, target(end)), self);
                }
            }
            time += segment.duration;
        }
        if bed.is_none() {
            solved.grown = Some(growing);
        }
        solved
    }

    /// Times from 0 to a duration: fine at the beginning, where the memories change fastest, and fine everywhere.
    fn division(&self, duration: f64, steps: usize) -> Vec<f64> {
        if duration <= 0.0 {
            return vec![0.0, 0.0];
        }
        let first = FIRST_STEP * self.shortest;
        let half = steps.div_ceil(2);
        let growth = (duration / first).ln_1p();
        let part = |k: usize| k as f64 / half as f64;
        let even = (0..=half).map(|k| duration * part(k));
        let fine = (1..half).map(|k| first * (growth * part(k)).exp_m1());
        let mut times: Vec<f64> = even.chain(fine).collect();
        times.sort_by(f64::total_cmp);
        times.dedup_by(|one, other| (*one - *other).abs() < 1e-9 * duration);
        if let Some(last) = times.last_mut() {
            *last = duration;
        }
        times
    }

    /// Continues a growing contact to the end of a step. If the contact does not grow up to there, nothing changes, and the time of the
    /// largest contact is returned.
    fn grow(
        &self,
        growing: &mut Growing,
        prescribed: Prescribed,
        times: [f64; 2],
        values: [f64; 2],
    ) -> Option<f64> {
        let part = match prescribed {
            Prescribed::Indentation => {
                if values[1] < growing.indentation {
                    // Above first touch there is no contact yet.
                    if growing.indentation > self.curve.first_touch() || growing.force > 0.0 {
                        return Some(times[0]);
                    }
                }
                Part {
                    times,
                    levels: [values[0], values[1]],
                    force: None,
                }
            }
            Prescribed::Force => {
                let memory = self.transformed(&self.to_stress, &growing.memory[0]);
                let end = self.strain_of_force(times, values, &memory, times[1]);
                let rate = |time: f64| self.rate_of_strain(times, values, &memory, time);
                let begin = self.strain_of_force(times, values, &memory, times[0]);
                let is_step = times[1] <= times[0];
                let recedes = if is_step {
                    values[1] < values[0]
                } else {
                    rate(times[1]) < 0.0 && values[1] <= values[0]
                };
                if recedes {
                    if is_step || rate(times[0]) <= 0.0 {
                        return Some(times[0]);
                    }
                    let ends = [times[0], times[1]].map(|position| Point {
                        position,
                        value: rate(position),
                    });
                    let zero = roots::find(ends, 0.0, |time| Ok::<_, ()>(rate(time)));
                    return match zero {
                        Ok(Some(root)) => Some(root.closest().position),
                        _ => Some(times[0]),
                    };
                }
                let begin = if is_step {
                    growing.indentation
                } else {
                    self.curve.indentation_at(begin)
                };
                Part {
                    times,
                    levels: [begin, self.curve.indentation_at(end)],
                    force: Some((values, memory)),
                }
            }
        };
        self.extend(growing, part, values[1]);
        None
    }

    /// The memories at the end of a part that follows a growing contact.
    fn memory_after(&self, growing: &Growing, part: &Part) -> [Vec<f64>; 2] {
        let times = part.times;
        let width = times[1] - times[0];
        let mut memory = growing.memory.clone();
        if width > 0.0 {
            for (place, term) in self.terms.iter().enumerate() {
                let decay = (-width / term.time).exp();
                for of in &mut memory {
                    of[place] *= decay;
                }
            }
            for (time, weight) in self.nodes(times) {
                let level = self.level_of(part, time);
                let forces = [
                    match &part.force {
                        Some((values, memory)) => {
                            self.strain_of_force(times, *values, memory, time)
                        }
                        None => self.curve.force_at(level),
                    },
                    self.curve.floor_force_at(level),
                ];
                for (place, term) in self.terms.iter().enumerate() {
                    let kernel = weight * (-(times[1] - time) / term.time).exp() / term.time;
                    for (of, force) in memory.iter_mut().zip(forces) {
                        of[place] += kernel * force;
                    }
                }
            }
            if let Some((values, before)) = &part.force {
                // Exactly.
                let after = self.memory_of_force(times, *values, before, times[1]);
                memory[0] = self.transformed(&self.to_strain, &after);
            }
        }
        memory
    }

    /// Continues a growing contact by a part that ends at a value of what is prescribed.
    fn extend(&self, growing: &mut Growing, part: Part, value: f64) {
        growing.memory = self.memory_after(growing, &part);
        growing.time = part.times[1];
        if part.force.is_some() {
            growing.indentation = part.levels[1];
            growing.force = value;
        } else {
            growing.indentation = value;
            growing.force = self.stress(self.curve.force_at(value), &growing.memory[0]);
        }
        growing.parts.push(part);
    }

    /// The states at measured loads.
    fn measured(&self, by: MeasuredBy, loads: &[MeasuredLoad]) -> Option<Vec<HistoryState>> {
        let first = self.curve.first_touch();
        let level = |load: &MeasuredLoad| match by {
            MeasuredBy::Force => self
                .curve
                .indentation_at(load.load * self.creep.instantaneous()),
            MeasuredBy::Position { .. } => load.load,
        };
        let range = loads.iter().map(level).fold(first, f64::max) - first;
        let mut growing = self.untouched(loads.first().map_or(0.0, |load| load.time));
        // The largest contact: the number of its load, and the number of parts up to it.
        let mut largest = (0, growing.clone(), 0);
        let mut states: Vec<HistoryState> = Vec::with_capacity(loads.len());
        let mut bed: Option<Bed> = None;
        let target = |load: &MeasuredLoad| match by {
            MeasuredBy::Force => Target::Force(load.load.max(0.0)),
            MeasuredBy::Position { compliance } => Target::Position {
                value: load.load,
                compliance,
            },
        };
        for (number, load) in loads.iter().enumerate() {
            if bed.is_none() {
                let part = self.measured_part(&growing, target(load), load.time)?;
                if number == 0 || part.0.levels[1] > largest.1.indentation - REVERSAL * range {
                    self.extend(&mut growing, part.0, part.1);
                    states.push(self.state_of(&growing));
                    if number == 0 || growing.indentation >= largest.1.indentation {
                        let parts = std::mem::take(&mut growing.parts);
                        largest = (number, growing.clone(), parts.len());
                        growing.parts = parts;
                    }
                    continue;
                }
                // From the largest contact on.
                let (_, mut at_largest, count) = largest.clone();
                growing.parts.truncate(count);
                at_largest.parts = std::mem::take(&mut growing.parts);
                states.truncate(largest.0 + 1);
                let mut fresh = Bed::new(self, &at_largest, STEPS_OF_MEASURED, MEASURED_LEVELS);
                fresh.left_out = LEFT_OUT_OF_MEASURED;
                fresh.crowded = 2 * fresh.levels.len();
                for number in largest.0 + 1..number {
                    self.step_to(&mut fresh, &loads[number - 1..=number], range, &target);
                    states.push(fresh.state(self, target(&loads[number])));
                }
                bed = Some(fresh);
            }
            if let Some(bed) = &mut bed {
                self.step_to(bed, &loads[number - 1..=number], range, &target);
                states.push(bed.state(self, target(load)));
            }
        }
        Some(states)
    }

    /// Time steps from a measured load to the next one, short enough for the change of the load and of the memories.
    fn step_to(
        &self,
        bed: &mut Bed,
        loads: &[MeasuredLoad],
        range: f64,
        target: &dyn Fn(&MeasuredLoad) -> Target,
    ) {
        let [Some(from), Some(to)] = [loads.first(), loads.last()] else {
            return;
        };
        let change = (to.load - from.load).abs() / (LONGEST_CHANGE * range);
        let duration = to.time - from.time;
        let of_time = duration / (LONGEST_STEP * self.shortest);
        let is_position = matches!(target(to), Target::Position { .. });
        let wanted = if is_position {
            change.max(of_time)
        } else {
            of_time
        };
        let count = wanted.clamp(1.0, MOST_PARTS_OF_STEP).ceil() as usize;
        for k in 1..=count {
            let part = k as f64 / count as f64;
            let load = MeasuredLoad {
                time: from.time + part * duration,
                load: from.load + part * (to.load - from.load),
            };
            bed.step(self, target(if k == count { to } else { &load }), load.time);
        }
    }

    /// A contact before first touch.
    fn untouched(&self, time: f64) -> Growing {
        Growing {
            time,
            force: 0.0,
            indentation: self.curve.first_touch(),
            memory: [0, 1].map(|_| vec![0.0; self.terms.len()]),
            parts: Vec::new(),
        }
    }

    /// The part from a growing contact to a measured load at a time, and the value that it ends at.
    fn measured_part(&self, growing: &Growing, target: Target, time: f64) -> Option<(Part, f64)> {
        let times = [growing.time, time.max(growing.time)];
        let to = |level: f64| Part {
            times,
            levels: [growing.indentation, level],
            force: None,
        };
        match target {
            Target::Force(force) => {
                let memory = self.transformed(&self.to_stress, &growing.memory[0]);
                let values = [growing.force, force];
                let end = self.strain_of_force(times, values, &memory, times[1]);
                let part = Part {
                    levels: [growing.indentation, self.curve.indentation_at(end)],
                    force: Some((values, memory)),
                    times,
                };
                Some((part, force))
            }
            Target::Position { value, compliance } => {
                let free = value <= self.curve.first_touch() && growing.force.abs() <= 0.0;
                if compliance.abs() <= 0.0 || free {
                    return Some((to(value), value));
                }
                let off = |level: f64| {
                    let memory = self.memory_after(growing, &to(level));
                    let force = self.stress(self.curve.force_at(level), &memory[0]);
                    level + compliance * force - value
                };
                let guess = value - compliance * growing.force;
                let mut reach = (guess - growing.indentation)
                    .abs()
                    .max(1e-3 * (value - self.curve.first_touch()).abs());
                let end = |position: f64| Point {
                    position,
                    value: off(position),
                };
                let mut ends = [end(guess - reach), end(guess + reach)];
                for _ in 0..WIDENINGS {
                    reach *= 2.0;
                    if ends[0].value > 0.0 {
                        ends[0] = end(guess - reach);
                    } else if ends[1].value < 0.0 {
                        ends[1] = end(guess + reach);
                    } else {
                        break;
                    }
                }
                let found = roots::find(ends, ROUNDING, |level| Ok::<_, ()>(off(level)));
                let level = found.ok().flatten()?.closest().position;
                Some((to(level), level))
            }
        }
    }

    /// Nodes and weights of the quadrature over a step.
    fn nodes(&self, [start, end]: [f64; 2]) -> Vec<(f64, f64)> {
        let mut ends: Vec<f64> = self
            .terms
            .iter()
            .flat_map(|term| DECAYS.map(|decay| end - decay * term.time))
            .filter(|time| *time > start && *time < end)
            .chain([start, end])
            .collect();
        ends.sort_by(f64::total_cmp);
        let mut nodes = Vec::with_capacity(self.quadrature.len() * ends.len());
        for pair in ends.windows(2) {
            let width = pair[1] - pair[0];
            for (node, weight) in &self.quadrature {
                // Quadratic in the node, so that power laws at first touch are smooth.
                let u = 0.5 * (node + 1.0);
                nodes.push((pair[0] + width * u * u, weight * width * u));
            }
        }
        nodes
    }

    /// The level of the front in a step.
    fn level_of(&self, part: &Part, time: f64) -> f64 {
        let [t0, t1] = part.times;
        match &part.force {
            Some((values, memory)) => {
                let strain = self.strain_of_force(part.times, *values, memory, time);
                self.curve.indentation_at(strain)
            }
            None if t1 > t0 => {
                let [low, high] = part.levels;
                low + (time - t0) / (t1 - t0) * (high - low)
            }
            None => part.levels[1],
        }
    }

    /// The stress of a strain with these memories.
    fn stress(&self, strain: f64, memory: &[f64]) -> f64 {
        let kept = self.terms.iter().zip(memory);
        self.instantaneous * strain - kept.map(|(term, of)| term.strength * of).sum::<f64>()
    }

    /// The strain without stress, of these memories.
    fn free_strain(&self, memory: &[f64]) -> f64 {
        let kept = self.terms.iter().zip(memory);
        kept.map(|(term, of)| term.strength * of).sum::<f64>() / self.instantaneous
    }

    fn transformed(&self, matrix: &[Vec<f64>], memory: &[f64]) -> Vec<f64> {
        let row = |row: &Vec<f64>| row.iter().zip(memory).map(|(a, b)| a * b).sum();
        matrix.iter().map(row).collect()
    }

    /// The memories `∫ exp(-(t - s)/theta_j) F(s) ds/theta_j` of a force that changes linearly.
    fn memory_of_force(
        &self,
        times: [f64; 2],
        values: [f64; 2],
        before: &[f64],
        time: f64,
    ) -> Vec<f64> {
        let width = times[1] - times[0];
        if width <= 0.0 {
            return before.to_vec();
        }
        let rate = (values[1] - values[0]) / width;
        let passed = time - times[0];
        let creeping = self.creep.terms().iter().zip(before);
        creeping
            .map(|(term, before)| {
                // The particular solution is F - rate theta.
                let lag = rate * term.time;
                values[0] + rate * passed - lag
                    + (before - values[0] + lag) * (-passed / term.time).exp()
            })
            .collect()
    }

    /// `J * dF`: the elastic force of the contact under a force that changes linearly.
    fn strain_of_force(&self, times: [f64; 2], values: [f64; 2], before: &[f64], time: f64) -> f64 {
        let width = times[1] - times[0];
        let force = if width > 0.0 {
            values[0] + (values[1] - values[0]) * (time - times[0]) / width
        } else {
            values[1]
        };
        let memory = self.memory_of_force(times, values, before, time);
        let creeping = self.creep.terms().iter().zip(memory);
        self.creep.instantaneous() * force
            + creeping.map(|(term, of)| term.strength * of).sum::<f64>()
    }

    fn rate_of_strain(&self, times: [f64; 2], values: [f64; 2], before: &[f64], time: f64) -> f64 {
        let rate = (values[1] - values[0]) / (times[1] - times[0]);
        let force = values[0] + rate * (time - times[0]);
        let memory = self.memory_of_force(times, values, before, time);
        let creeping = self.creep.terms().iter().zip(memory);
        self.creep.instantaneous() * rate
            + creeping
                .map(|(term, of)| term.strength * (force - of) / term.time)
                .sum::<f64>()
    }

    fn state_of(&self, growing: &Growing) -> HistoryState {
        let floor = self.curve.floor_force_at(growing.indentation);
        HistoryState {
            time: growing.time,
            force: growing.force,
            indentation: growing.indentation,
            contact_indentation: growing.indentation.max(self.curve.first_touch()),
            floor_force: if self.critical.is_some_and(|it| growing.indentation > it) {
                self.stress(floor, &growing.memory[1]).max(0.0)
            } else {
                0.0
            },
            by: Approximation::Superposition,
        }
    }

    /// Time at which a growing contact reached a level.
    fn time_of(&self, growing: &Growing, level: f64) -> f64 {
        let part = growing.parts.iter().find(|part| part.levels[1] >= level);
        let Some(part) = part else {
            return growing.time;
        };
        let [t0, t1] = part.times;
        let [low, high] = part.levels;
        if !(t1 > t0 && high > low) || level <= low {
            return t0;
        }
        if part.force.is_none() {
            return t0 + (level - low) / (high - low) * (t1 - t0);
        }
        let off = |time: f64| self.level_of(part, time) - level;
        let ends = [t0, t1].map(|position| Point {
            position,
            value: off(position),
        });
        match roots::find(ends, 0.0, |time| Ok::<_, ()>(off(time))) {
            Ok(Some(root)) => root.closest().position,
            _ => t1,
        }
    }

    /// The answer of the steps.
    fn finished(
        &self,
        protocol: &Protocol,
        solved: Solved,
        [force_error, indentation_error]: [f64; 2],
    ) -> History {
        let equilibrium = self.equilibrium(protocol, &solved);
        let reached = solved
            .events
            .iter()
            .find(|event| event.kind == HistoryEventKind::FloorContact);
        let reached = reached.map(|event| event.time);
        let later = || self.floor_contact_while_held(protocol, &solved, &equilibrium);
        History {
            time_to_floor_contact: reached.or_else(later),
            time_to_equilibrium: self.time_to_equilibrium(protocol, &solved, &equilibrium),
            equilibrium,
            states: solved.states,
            events: solved.events,
            force_error,
            indentation_error,
            steps: solved.steps,
        }
    }

    /// The relaxed state under the last load: elastic, whatever came before.
    fn equilibrium(&self, protocol: &Protocol, solved: &Solved) -> HistoryState {
        let last = solved.states[solved.states.len() - 1];
        let prescribed = protocol.segments().last().map(|last| last.prescribed);
        let curve = self.curve;
        let indentation = match prescribed {
            Some(Prescribed::Force) => curve.indentation_at(last.force),
            _ => last.indentation,
        };
        HistoryState {
            time: f64::INFINITY,
            force: curve.force_at(indentation),
            indentation,
            contact_indentation: indentation.max(curve.first_touch()),
            floor_force: match self.critical {
                Some(critical) if indentation > critical => curve.floor_force_at(indentation),
                _ => 0.0,
            },
            by: last.by,
        }
    }

    /// Time at which the lens reaches the floor after the protocol, if its last force is held.
    fn floor_contact_while_held(
        &self,
        protocol: &Protocol,
        solved: &Solved,
        equilibrium: &HistoryState,
    ) -> Option<f64> {
        let critical = self.critical?;
        let last = protocol.segments().last()?;
        if last.prescribed != Prescribed::Force || equilibrium.indentation <= critical {
            return None;
        }
        match &solved.grown {
            Some(growing) => {
                self.reached_while_held(growing, last.to, self.curve.force_at(critical))
            }
            None => {
                let mut segments = protocol.segments().to_vec();
                segments.push(crate::problem::ProtocolSegment {
                    prescribed: Prescribed::Force,
                    to: last.to,
                    duration: 40.0 * self.longest,
                });
                let longer = Protocol::new(segments).ok()?;
                let longer = self.solved(&longer, MOST_STEPS / 2, true);
                let mut events = longer.events.iter();
                let reached = events.find(|it| it.kind == HistoryEventKind::FloorContact)?;
                Some(reached.time)
            }
        }
    }

    /// Time at which the elastic force of a growing contact reaches a value if a force is held from its last state on.
    fn reached_while_held(&self, growing: &Growing, force: f64, wanted: f64) -> Option<f64> {
        let memory = self.transformed(&self.to_stress, &growing.memory[0]);
        let later = self.time_of_zero(|time| {
            let span = [0.0, time.max(f64::MIN_POSITIVE)];
            self.strain_of_force(span, [force; 2], &memory, time) - wanted
        })?;
        Some(growing.time + later)
    }

    /// Time from which force and indentation are near equilibrium if the last load is held after a protocol in which the contact has only
    /// grown.
    fn settled_while_held(&self, protocol: &Protocol, growing: &Growing) -> Option<f64> {
        let last = protocol.segments().last()?;
        match last.prescribed {
            Prescribed::Force => {
                self.reached_while_held(growing, last.to, self.near_equilibrium(last.to))
            }
            Prescribed::Indentation => {
                let elastic = self.curve.force_at(growing.indentation);
                let kept = |time: f64| {
                    let terms = self.terms.iter().zip(&growing.memory[0]);
                    terms
                        .map(|(term, memory)| {
                            term.strength * (elastic - memory) * (-time / term.time).exp()
                        })
                        .sum::<f64>()
                };
                let later = self.time_of_zero(|time| SETTLED * elastic - kept(time))?;
                Some(growing.time + later)
            }
        }
    }

    /// Elastic force of the contact near the equilibrium under a force.
    fn near_equilibrium(&self, force: f64) -> f64 {
        let first = self.curve.first_touch();
        let depth = self.curve.indentation_at(force).max(first) - first;
        self.curve.force_at(first + (1.0 - SETTLED) * depth)
    }

    fn time_to_equilibrium(
        &self,
        protocol: &Protocol,
        solved: &Solved,
        equilibrium: &HistoryState,
    ) -> Option<f64> {
        if let [step, hold] = protocol.segments()
            && step.duration <= 0.0
            && hold.prescribed == step.prescribed
            && (hold.to - step.to).abs() <= 0.0
        {
            // In closed form.
            return match hold.prescribed {
                Prescribed::Force if hold.to > 0.0 => {
                    self.creep.time_to(self.near_equilibrium(hold.to) / hold.to)
                }
                Prescribed::Indentation if equilibrium.force > 0.0 => self.relaxed_to(SETTLED),
                _ => Some(0.0),
            };
        }
        let distance = |state: &HistoryState| {
            let from = |value: f64, end: f64| (value - end).abs() - SETTLED * end.abs();
            let [force, indentation] = [
                from(state.force, equilibrium.force)
                    / equilibrium.force.abs().max(f64::MIN_POSITIVE),
                from(state.indentation, equilibrium.indentation)
                    / equilibrium.indentation.abs().max(f64::MIN_POSITIVE),
            ];
            larger(force, indentation)
        };
        let states = &solved.states;
        let far = states.iter().rposition(|state| distance(state) > 0.0);
        let Some(far) = far else {
            return states.first().map(|state| state.time);
        };
        let Some(near) = states.get(far + 1) else {
            return self.settled_while_held(protocol, solved.grown.as_ref()?);
        };
        // Within the time step: the distance from equilibrium decreases exponentially.
        let [before, after] = [&states[far], near].map(|state| distance(state) + SETTLED);
        let part = (before / SETTLED).ln() / (before / after.max(f64::MIN_POSITIVE)).ln();
        Some(states[far].time + part.clamp(0.0, 1.0) * (near.time - states[far].time))
    }

    /// Time after which the modulus is no more than this part above the relaxed one.
    fn relaxed_to(&self, part: f64) -> Option<f64> {
        self.time_of_zero(|time| {
            let terms = self.terms.iter();
            part - terms
                .map(|term| term.strength * (-time / term.time).exp())
                .sum::<f64>()
        })
    }

    /// Time at which a function that increases over the relaxation times reaches 0.
    fn time_of_zero(&self, function: impl Fn(f64) -> f64) -> Option<f64> {
        if function(0.0) >= 0.0 {
            return Some(0.0);
        }
        let mut end = self.longest;
        while function(end) < 0.0 && end.is_finite() {
            end *= 2.0;
        }
        let ends = [0.0, end].map(|position| Point {
            position,
            value: function(position),
        });
        let root = roots::find(ends, 0.0, |time| Ok::<_, ()>(function(time)));
        Some(root.ok().flatten()?.closest().position)
    }
}

impl Solved {
    /// Adds a state of growing contact. The time at which the floor is reached is exact.
    fn push_grown(&mut self, body: &Body<'_>, growing: &Growing) {
        let known = self.events.len();
        self.push(body.state_of(growing), body);
        for event in &mut self.events[known..] {
            if let (HistoryEventKind::FloorContact, Some(critical)) = (event.kind, body.critical) {
                event.time = body.time_of(growing, critical);
                event.indentation = critical;
            }
        }
    }

    /// Adds a state, and the events since the one before.
    fn push(&mut self, state: HistoryState, body: &Body<'_>) {
        let before = self.states[self.states.len() - 1];
        let first = body.curve.first_touch();
        let mut found: Vec<(f64, HistoryEventKind)> = Vec::new();
        let [from, to] = [before.contact_indentation, state.contact_indentation];
        let part_at = |level: f64| {
            if (to - from).abs() > 0.0 {
                (level - from) / (to - from)
            } else {
                1.0
            }
        };
        let rounding = ROUNDING * (body.curve.last() - first);
        use HistoryEventKind as Kind;
        if from <= first && to > first {
            let has_left = self.events.iter().any(|it| it.kind == Kind::Detachment);
            // A surface that has been touched recovers while the lens approaches: the time step begins at the contact.
            let event = if has_left {
                (0.0, Kind::Recontact)
            } else if before.indentation < first {
                let approach =
                    (first - before.indentation) / (state.indentation - before.indentation);
                (approach, Kind::FirstContact)
            } else {
                (0.0, Kind::FirstContact)
            };
            found.push(event);
        }
        if let Some(critical) = body.critical {
            if from < critical && to >= critical {
                found.push((part_at(critical), Kind::FloorContact));
            }
            if from >= critical && to < critical {
                found.push((part_at(critical), Kind::FloorLost));
            }
        }
        let turned = self.events.iter().rev().find_map(|event| match event.kind {
            Kind::LargestContact => Some(true),
            Kind::FirstContact | Kind::Recontact | Kind::SmallestContact => Some(false),
            _ => None,
        });
        let recedes = turned.unwrap_or(false);
        if !recedes && from > first && to < from - rounding {
            found.push((0.0, Kind::LargestContact));
        }
        if recedes && from > first && to > from + rounding {
            found.push((0.0, Kind::SmallestContact));
        }
        if from > first && to <= first {
            found.push((1.0, Kind::Detachment));
        }
        found.sort_by(|one, other| one.0.total_cmp(&other.0));
        for (part, kind) in found {
            let between = |a: f64, b: f64| a + part * (b - a);
            self.events.push(HistoryEvent {
                time: between(before.time, state.time),
                time_error: 0.0,
                kind,
                force: between(before.force, state.force),
                indentation: between(before.indentation, state.indentation),
            });
        }
        self.states.push(state);
    }

    /// Sets the errors of the times of events: their differences from a solution with longer steps, and without the same event there, the
    /// longer of the time steps beside it.
    fn set_time_errors(&mut self, coarse: &Self) {
        let times: Vec<f64> = self.states.iter().map(|state| state.time).collect();
        let is_same = self.events.len() == coarse.events.len();
        for (place, event) in self.events.iter_mut().enumerate() {
            let same = coarse.events.get(place);
            let same = same.filter(|it| is_same && it.kind == event.kind);
            event.time_error = match same {
                Some(same) => (event.time - same.time).abs(),
                None => {
                    let above = times.partition_point(|time| *time < event.time);
                    let from = above.saturating_sub(1);
                    let to = (above + 1).min(times.len() - 1);
                    let steps = times[from..=to].windows(2);
                    steps.map(|pair| pair[1] - pair[0]).fold(0.0, f64::max)
                }
            };
        }
    }

    /// The largest differences of force and indentation from a solution with longer steps, as an estimate of the own errors: of second
    /// order, a third.
    fn differences(&self, coarse: &Self) -> [f64; 2] {
        let mut largest = [0.0_f64; 3];
        let mut off = [0.0_f64; 3];
        let numbers = |state: &HistoryState| [state.force, state.indentation, state.floor_force];
        for state in &self.states {
            for (most, value) in largest.iter_mut().zip(numbers(state)) {
                *most = most.max(value.abs());
            }
        }
        let mut fine = self.states.iter().peekable();
        for state in &coarse.states {
            // The same time, of a step the same side.
            let same = |it: &&HistoryState| {
                it.by == state.by && (it.time - state.time).abs() <= 1e-9 * state.time
            };
            while fine
                .peek()
                .is_some_and(|it| !same(it) && it.time <= state.time)
            {
                fine.next();
            }
            let Some(same) = fine.peek().filter(|it| same(it)) else {
                continue;
            };
            for ((off, a), b) in off.iter_mut().zip(numbers(same)).zip(numbers(state)) {
                *off = off.max((a - b).abs());
            }
            fine.next();
        }
        // The force on the floor is compared with the whole force.
        largest[2] = largest[0];
        let [force, indentation, floor] = [0, 1, 2].map(|k| {
            if largest[k] > 0.0 {
                off[k] / largest[k] / 3.0
            } else {
                0.0
            }
        });
        [force.max(floor), indentation]
    }
}

/// The levels as elements with memories.
struct Bed {
    time: f64,
    levels: Vec<f64>,
    /// For every level, the memories of its strain.
    memories: Vec<Vec<f64>>,
    /// Number of levels in contact. The next one is the front again, on the other side of it.
    inside: usize,
    /// Whether the lens is off the surface.
    is_off: bool,
    /// Number of levels from which those that can be interpolated are left out.
    crowded: usize,
    /// Error of this interpolation.
    left_out: f64,
}

impl Bed {
    /// The levels of a contact that has only grown, among them up to a number of those at which its parts ended.
    fn new(body: &Body<'_>, growing: &Growing, steps: usize, most_of_parts: usize) -> Self {
        let first = body.curve.first_touch();
        let front = growing.indentation.max(first);
        let count = LEVELS_PER_STEP * steps;
        let every = growing.parts.len().div_ceil(most_of_parts).max(1);
        let mut levels: Vec<f64> = (0..=count)
            .map(|k| {
                let angle = std::f64::consts::PI * k as f64 / count as f64;
                first + (front - first) * 0.5 * (1.0 - angle.cos())
            })
            .chain(
                growing
                    .parts
                    .iter()
                    .step_by(every)
                    .map(|part| part.levels[1]),
            )
            .chain(body.critical)
            .chain(body.curve.samples().iter().map(|it| it.indentation))
            .filter(|level| *level >= first && *level < front)
            .collect();
        levels.push(first);
        levels.sort_by(f64::total_cmp);
        levels.dedup_by(|one, other| (*one - *other).abs() <= ROUNDING * (front - first));
        if front > first {
            levels.push(front);
        }
        let memories: Vec<Vec<f64>> = levels
            .iter()
            .map(|level| {
                let age = growing.time - body.time_of(growing, *level);
                let terms = body.terms.iter();
                terms.map(|term| -(-age / term.time).exp_m1()).collect()
            })
            .collect();
        let inside = levels.len();
        let mut bed = Self {
            time: growing.time,
            levels,
            memories,
            inside,
            is_off: growing.indentation < first,
            crowded: 3 * inside + 400,
            left_out: LEFT_OUT,
        };
        // Beyond the front nothing was touched.
        bed.levels.push(front);
        bed.memories.push(vec![0.0; body.terms.len()]);
        bed
    }

    fn front(&self) -> f64 {
        self.levels[self.inside]
    }

    /// Time within the next step at which the lens leaves or touches the surface; `None` if it does neither. This is where a prescribed
    /// indentation equals that at which the lens just touches the recovering surface. A prescribed force vanishes at the ends of segments only.
    fn contact_change(
        &self,
        body: &Body<'_>,
        target: &dyn Fn(f64) -> Target,
        end: f64,
    ) -> Option<f64> {
        let first = body.curve.first_touch();
        // Distance of the lens from the surface without contact.
        let gap = |time: f64| match target(time) {
            Target::Position { value, .. } => {
                let moved = Moved::new(self, body, time - self.time);
                moved.with_front(first).indentation(body) - value
            }
            Target::Force(_) => f64::NAN,
        };
        if matches!(target(end), Target::Force(_)) || end <= self.time {
            return None;
        }
        let was_off = self.is_off || self.front() <= first;
        let at_end = gap(end);
        if was_off == (at_end >= 0.0) {
            return None;
        }
        let ends = [(self.time, gap(self.time)), (end, at_end)];
        let ends = ends.map(|(position, value)| Point { position, value });
        let root = roots::find(ends, 0.0, |time| Ok::<_, ()>(gap(time)));
        // On the side without contact, so that the next step begins or ends there.
        let time = root.ok().flatten()?.above.position;
        (time > self.time && time < end).then_some(time)
    }

    /// Continues to a time, at which the target is met.
    fn step(&mut self, body: &Body<'_>, target: Target, time: f64) {
        let first = body.curve.first_touch();
        let moved = Moved::new(self, body, time - self.time);
        let off = |front: f64| {
            let evolved = moved.with_front(front);
            let force = || evolved.force(body, &|level| body.curve.force_at(level));
            match target {
                Target::Force(value) => force() - value,
                Target::Position { value, compliance } => {
                    let of_machine = if compliance.abs() > 0.0 {
                        compliance * force()
                    } else {
                        0.0
                    };
                    evolved.indentation(body) + of_machine - value
                }
            }
        };
        let at_first = off(first);
        let off_at_first = match target {
            Target::Force(value) => value <= 0.0,
            Target::Position { .. } => at_first >= 0.0,
        };
        let front = if off_at_first {
            first
        } else {
            let mut high = match target {
                Target::Position { value, .. } => value,
                Target::Force(_) => self.front().max(first + 1e-3 * (body.curve.last() - first)),
            };
            let mut at_high = off(high);
            while at_high < 0.0 && high.is_finite() {
                high = first + 1.5 * (high - first);
                at_high = off(high);
            }
            let ends = [
                Point {
                    position: first,
                    value: at_first,
                },
                Point {
                    position: high,
                    value: at_high,
                },
            ];
            // To rounding errors of the level.
            match roots::find(ends, 1e-15, |front| Ok::<_, ()>(off(front))) {
                Ok(Some(root)) => root.closest().position,
                _ => self.front(),
            }
        };
        let evolved = moved.with_front(front);
        self.levels = evolved.levels;
        self.memories = evolved.memories;
        self.inside = evolved.inside;
        self.time = time;
        self.is_off = off_at_first;
        if self.levels.len() > self.crowded {
            self.thin_out(body);
        }
    }

    fn state(&self, body: &Body<'_>, target: Target) -> HistoryState {
        let evolved = Evolved {
            levels: self.levels.clone(),
            memories: self.memories.clone(),
            inside: self.inside,
        };
        let curve = body.curve;
        let force = match target {
            _ if self.is_off => 0.0,
            Target::Force(value) => value,
            Target::Position { .. } => evolved.force(body, &|level| curve.force_at(level)),
        };
        let floor_force = match body.critical {
            Some(critical) if self.front() > critical && !self.is_off => {
                evolved.force(body, &|level| curve.floor_force_at(level))
            }
            _ => 0.0,
        };
        HistoryState {
            time: self.time,
            force,
            indentation: match target {
                Target::Position { value, compliance } => value - compliance * force,
                Target::Force(_) => evolved.indentation(body),
            },
            contact_indentation: self.front(),
            floor_force: floor_force.max(0.0),
            by: Approximation::Steps,
        }
    }

    /// Leaves out levels whose memories are those of their neighbours, interpolated.
    fn thin_out(&mut self, body: &Body<'_>) {
        let count = self.levels.len();
        let mut keep = vec![true; count];
        let mut before = 0;
        for place in 1..count - 1 {
            let is_front = place + 1 == self.inside || place == self.inside;
            let is_critical = Some(self.levels[place]) == body.critical;
            let [low, level, high] = [before, place, place + 1].map(|k| self.levels[k]);
            let can_go = high > low && level > low && level < high && !is_front && !is_critical;
            let part = (level - low) / (high - low);
            let off = |k: usize| {
                let [a, b, c] = [before, place, place + 1].map(|place| self.memories[place][k]);
                (a + part * (c - a) - b).abs()
            };
            // The force is interpolated between levels too.
            let is_narrow = high - low < 0.02 * (self.levels[count - 1] - self.levels[0]);
            if can_go && is_narrow && (0..body.terms.len()).all(|k| off(k) < self.left_out) {
                keep[place] = false;
            } else {
                before = place;
            }
        }
        let inside = keep[..self.inside].iter().filter(|keep| **keep).count();
        let mut flags = keep.iter();
        self.levels.retain(|_| *flags.next().unwrap_or(&true));
        let mut flags = keep.iter();
        self.memories.retain(|_| *flags.next().unwrap_or(&true));
        self.inside = inside;
        self.crowded = self.crowded.max(2 * self.levels.len());
    }
}

/// A bed and its elements after a step, in contact and free.
struct Moved<'a> {
    bed: &'a Bed,
    body: &'a Body<'a>,
    duration: f64,
    held: Vec<Vec<f64>>,
    free: Vec<Vec<f64>>,
}

/// The levels after a step.
struct Evolved {
    levels: Vec<f64>,
    memories: Vec<Vec<f64>>,
    inside: usize,
}

impl<'a> Moved<'a> {
    fn new(bed: &'a Bed, body: &'a Body<'a>, duration: f64) -> Self {
        let (held, free) = (body.decays(duration), body.free_decays(duration));
        Self {
            held: bed.memories[..bed.inside]
                .iter()
                .map(|memory| in_contact(memory, &held))
                .collect(),
            free: bed.memories[bed.inside..]
                .iter()
                .map(|memory| body.released(memory, &free))
                .collect(),
            bed,
            body,
            duration,
        }
    }

    /// An element that is in contact for a part of the step, first or last.
    fn crossed(&self, memory: &[f64], contact: f64, is_released: bool) -> Vec<f64> {
        let body = self.body;
        let held = body.decays(contact * self.duration);
        let free = body.free_decays((1.0 - contact) * self.duration);
        if is_released {
            body.released(&in_contact(memory, &held), &free)
        } else {
            in_contact(&body.released(memory, &free), &held)
        }
    }

    /// The memories at a level before the step.
    fn memory_at(&self, level: f64) -> Vec<f64> {
        let levels = &self.bed.levels;
        let above = levels.partition_point(|other| *other < level);
        if above >= levels.len() {
            return vec![0.0; self.body.terms.len()];
        }
        if above == 0 || levels[above] <= level {
            return self.bed.memories[above].clone();
        }
        let [low, high] = [levels[above - 1], levels[above]];
        let part = (level - low) / (high - low);
        let [a, b] = [above - 1, above].map(|k| &self.bed.memories[k]);
        a.iter().zip(b).map(|(a, b)| a + part * (b - a)).collect()
    }

    /// The levels after the step, in which the front moves evenly to a level.
    fn with_front(&self, front: f64) -> Evolved {
        let bed = self.bed;
        let before = bed.front();
        let count = bed.levels.len();
        let mut levels = Vec::with_capacity(count + 2);
        let mut memories = Vec::with_capacity(count + 2);
        let still = ROUNDING * (before - bed.levels[0]).abs();
        if (front - before).abs() <= still {
            return Evolved {
                levels: bed.levels.clone(),
                memories: [self.held.clone(), self.free.clone()].concat(),
                inside: bed.inside,
            };
        }
        let part = |level: f64| (level - before) / (front - before);
        if front < before {
            let stay = bed.levels[..bed.inside].partition_point(|level| *level <= front);
            levels.extend_from_slice(&bed.levels[..stay]);
            memories.extend_from_slice(&self.held[..stay]);
            let own = in_contact(&self.memory_at(front), &self.body.decays(self.duration));
            levels.push(front);
            memories.push(own.clone());
            let inside = levels.len();
            levels.push(front);
            memories.push(own);
            for place in stay..bed.inside {
                levels.push(bed.levels[place]);
                let contact = part(bed.levels[place]);
                memories.push(self.crossed(&bed.memories[place], contact, true));
            }
            levels.extend_from_slice(&bed.levels[bed.inside..]);
            memories.extend_from_slice(&self.free);
            Evolved {
                levels,
                memories,
                inside,
            }
        } else {
            levels.extend_from_slice(&bed.levels[..bed.inside]);
            memories.extend_from_slice(&self.held);
            let outside = &bed.levels[bed.inside..];
            let stay = bed.inside + outside.partition_point(|level| *level < front);
            for place in bed.inside..stay {
                levels.push(bed.levels[place]);
                let contact = 1.0 - part(bed.levels[place]);
                memories.push(self.crossed(&bed.memories[place], contact, false));
            }
            if stay == count {
                // Beyond all levels that were ever in contact: a first touch from the last one on.
                let last = bed.levels[count - 1];
                let contact = 1.0 - part(last);
                let fresh = vec![0.0; self.body.terms.len()];
                levels.push(last);
                memories.push(self.crossed(&fresh, contact, false));
            }
            let free = self.body.free_decays(self.duration);
            let own = self.body.released(&self.memory_at(front), &free);
            levels.push(front);
            memories.push(own.clone());
            let inside = levels.len();
            levels.push(front);
            memories.push(own);
            levels.extend_from_slice(&bed.levels[stay..]);
            memories.extend_from_slice(&self.free[stay - bed.inside..]);
            Evolved {
                levels,
                memories,
                inside,
            }
        }
    }
}

impl Body<'_> {
    /// Decay of each memory of an element in contact in a time.
    fn decays(&self, duration: f64) -> Vec<f64> {
        let terms = self.terms.iter();
        terms.map(|term| (-duration / term.time).exp()).collect()
    }

    /// Decay of each memory of the stress of a free element in a time.
    fn free_decays(&self, duration: f64) -> Vec<f64> {
        let terms = self.creep.terms().iter();
        terms.map(|term| (-duration / term.time).exp()).collect()
    }

    /// An element without stress after some time: the memories of its stress decay.
    fn released(&self, memory: &[f64], decays: &[f64]) -> Vec<f64> {
        let mut stress = self.transformed(&self.to_stress, memory);
        for (of, decay) in stress.iter_mut().zip(decays) {
            *of *= decay;
        }
        self.transformed(&self.to_strain, &stress)
    }
}

/// An element in contact after some time: the memories of its strain approach 1.
fn in_contact(memory: &[f64], decays: &[f64]) -> Vec<f64> {
    let pairs = memory.iter().zip(decays);
    pairs.map(|(of, decay)| 1.0 - (1.0 - of) * decay).collect()
}

impl Evolved {
    /// The force of the levels in contact, or that on the floor, from the elastic one over the level.
    fn force(&self, body: &Body<'_>, elastic: &dyn Fn(f64) -> f64) -> f64 {
        let mut sum = 0.0;
        let mut before: Option<[f64; 2]> = None;
        for (level, memory) in self.levels.iter().zip(&self.memories).take(self.inside) {
            let own = [elastic(*level), body.stress(1.0, memory)];
            if let Some([force, stress]) = before {
                sum += 0.5 * (stress + own[1]) * (own[0] - force);
            }
            before = Some(own);
        }
        sum
    }

    /// The indentation: the level of the front, and the strains of the levels outside.
    fn indentation(&self, body: &Body<'_>) -> f64 {
        let mut sum = self.levels[self.inside];
        let mut before: Option<[f64; 2]> = None;
        for (level, memory) in self.levels.iter().zip(&self.memories).skip(self.inside) {
            let own = [*level, body.free_strain(memory)];
            if let Some([below, strain]) = before {
                sum += 0.5 * (strain + own[1]) * (own[0] - below);
            }
            before = Some(own);
        }
        sum
    }
}
