//! Fits of many rows: the contact is solved under few loads, and the values of the rows are interpolated.
//!
//! For a given case the force depends on the indentation alone; contact point, machine compliance, offsets and drifts only shift the loads of
//! the rows. Therefore the states of a case belong to one [`Table`], and are used again as long as the case does not change. Further loads are
//! solved until the estimated interpolation error of every row is below a fraction of its error; they are those of rows, so that few rows in an
//! interval are solved directly. Rows before contact need no solution.
//!
//! The search begins with larger interpolation errors. After a small change of the case, of many rows, the states follow from those before by their
//! derivatives; two of them are solved again as a check.

use super::error::FitError;
use super::measurements::{Measurements, Position};
use super::model::{self, Derivatives, Model, Settings, State};
use super::parameter::Parameter;
use super::radius::smooth_radius;
use super::table::{Knot, Monotone, NEAR, Table};
use crate::derivative::ByKey;
use fakir::numerics::convergence::{clamped, larger, within};
use fakir::problem::{FloorModel, Load};
use fakir::state::{ContactState, Derivatives as ForceDerivatives, SolveError};
use fakir_case::Case;
use rayon::prelude::*;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Up to this number of rows, each is solved in every step.
pub(super) const DIRECT: usize = 24;

/// Up to this number of rows, the states of the result are solved for each of them.
pub(super) const SOLVED_AT_END: usize = 64;

/// Largest interpolation error of a row, as a fraction of its error over the root of the number of rows: even if the errors of all rows had
/// one sign, the parameters would change by less than this fraction of their standard errors.
const FRACTION: f64 = 0.1;

/// Largest fraction of the error of a row.
const MOST_OF_ERROR: f64 = 0.05;

/// Factor of the tolerance during the search, whose last step is taken with the states of the result.
const SEARCHING: f64 = 30.0;

/// Largest error of states that follow from others by their derivatives, as a fraction of the tolerance.
const MOVED: f64 = 0.5;

/// Error of such a change relative to the change itself, beside its second order: near kinks, and of derivatives between states.
const OF_CHANGE: f64 = 0.02;

/// Smallest tolerance, as a fraction of the largest value: below it the errors of the solver contribute.
const LEAST: f64 = 1e-7;

/// Number of loads solved first.
const FIRST: usize = 8;

/// Largest number of states of a table.
const MOST: usize = 400;

/// Largest number of states for derivatives by differences: before floor contact, and with load on the floor, where each takes about ten
/// times as long.
const DIFFERENCES: [usize; 2] = [SOLVED_AT_END, 6];

/// The same for the thickness of a layer, whose relative effect on the indentation changes slowly with the load.
const DIFFERENCES_OF_THICKNESS: [usize; 2] = [8, 2];

/// Change of the unknowns of the case up to which relative derivatives of states with load on the floor are used again.
const REUSED: f64 = 0.05;

/// The same for the result.
const REUSED_AT_END: f64 = 2e-3;

/// What derivatives are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Steps of the search.
    Search,
    /// The last steps, and standard errors.
    Result,
}

/// Largest tolerated interpolation errors.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tolerance {
    /// Of the force, N.
    pub(super) force: f64,
    /// Of the contact radius, m.
    pub(super) radius: f64,
    /// Whether every row is solved.
    pub(super) every_row: bool,
    /// Whether the states are those of the result, for which slopes with load on the floor are solved too.
    pub(super) is_result: bool,
}

impl Tolerance {
    /// Tolerances for these errors of force and contact radius, these largest values, and a number of rows.
    pub(super) fn new(errors: [f64; 2], largest: [f64; 2], rows: usize) -> Self {
        let fraction = (FRACTION / (rows as f64).sqrt()).min(MOST_OF_ERROR);
        let of = |quantity: usize| (fraction * errors[quantity]).max(LEAST * largest[quantity]);
        Self {
            force: of(0),
            radius: of(1),
            every_row: false,
            is_result: false,
        }
    }

    /// For the steps of the search.
    pub(super) fn of_search(self, errors: [f64; 2]) -> Self {
        let of = |full: f64, quantity: usize| {
            (SEARCHING * full)
                .min(MOST_OF_ERROR * errors[quantity])
                .max(full)
        };
        Self {
            force: of(self.force, 0),
            radius: of(self.radius, 1),
            ..self
        }
    }

    /// For the states of the result.
    pub(super) fn of_result(self) -> Self {
        Self {
            is_result: true,
            ..self
        }
    }

    /// Solves every row.
    pub(super) fn exact(self) -> Self {
        Self {
            every_row: true,
            ..self
        }
    }
}

/// A row in contact.
struct Reading {
    row: usize,
    /// Indentation plus compliance times force, m, or force, N.
    target: f64,
    /// Estimate of its indentation, or its force.
    guess: f64,
}

/// Relative derivatives of the force with load on the floor with respect to an unknown.
struct OnFloor {
    unknowns: Vec<f64>,
    purpose: Purpose,
    /// Part of the way from first floor contact to the largest load, and derivative over force.
    points: Vec<Vec<(f64, f64)>>,
}

struct Entry {
    unknowns: Vec<f64>,
    table: Arc<Table>,
    /// Rows whose loads were solved.
    rows: Vec<usize>,
}

/// States and derivatives by interpolation.
#[derive(Default)]
pub(super) struct Sampled {
    /// The last tables.
    entries: RefCell<Vec<Entry>>,
    on_floor: RefCell<Option<OnFloor>>,
    /// Derivatives of the force under a fixed indentation at the last unknowns of the case, over the load.
    held: RefCell<Option<(Vec<f64>, Vec<Monotone>)>>,
    /// Computed forces of the rows in the last states, N, from which the next indentations are estimated.
    forces: RefCell<Vec<f64>>,
}

impl Sampled {
    /// Whether the rows of a fit are interpolated if up to `direct` are not: not with adhesion or over time, where a cycle or a history
    /// already contains them.
    pub(super) fn suits(model: &Model<'_>, direct: usize) -> bool {
        let rows = model.data.rows();
        let by_force = model.data.position() == Position::None;
        rows.len() > direct
            && !model.is_adhesive
            && !model.is_viscoelastic
            && model.has_pillars()
            && rows.iter().all(|row| row.position.is_some() != by_force)
            && rows.iter().all(|row| !by_force || row.force.is_some())
    }

    /// Unknowns on which the table depends.
    fn of_case(model: &Model<'_>, unknowns: &[f64]) -> Vec<f64> {
        let pairs = model.free.iter().zip(unknowns);
        let of_case = pairs.filter(|(free, _)| matches!(free, Parameter::Key(_)));
        of_case.map(|(_, unknown)| *unknown).collect()
    }

    /// Rows in contact, by increasing load.
    fn readings(&self, model: &Model<'_>, settings: &Settings) -> Vec<Reading> {
        let computed = self.forces.borrow();
        let position = model.data.position();
        let compliance = settings.compliance(model.data.position());
        let rows = model.data.rows().iter().zip(&model.moments).enumerate();
        let mut readings: Vec<Reading> = rows
            .filter_map(|(number, (row, moment))| {
                let target = settings.load(position, model::load_of(row), *moment);
                let base_line = settings.base_line(*moment, model.travel(row));
                let measured = row.force.map_or(0.0, |force| force.value - base_line);
                let computed = computed.get(number).copied();
                let force = computed
                    .filter(|force| force.is_finite())
                    .unwrap_or(measured);
                let guess = match compliance == 0.0 {
                    true => target,
                    false => clamped(target - compliance * force, 0.1 * target, target),
                };
                (target > 0.0).then_some(Reading {
                    row: number,
                    target,
                    guess,
                })
            })
            .collect();
        readings.sort_by(|a, b| a.target.total_cmp(&b.target));
        readings
    }

    /// The table of a set of unknowns, refined for its rows.
    pub(super) fn table(
        &self,
        model: &Model<'_>,
        unknowns: &[f64],
        tolerance: Tolerance,
    ) -> Result<Arc<Table>, FitError> {
        /// Number of tables kept.
        const KEPT: usize = 4;
        let settings = model.settings(unknowns)?;
        let of_case = Self::of_case(model, unknowns);
        let readings = self.readings(model, &settings);
        let same = |entry: &Entry| {
            let pairs = entry.unknowns.iter().zip(&of_case);
            let mut pairs = pairs.map(|(a, b)| a.total_cmp(b).is_eq());
            pairs.all(|equal| equal)
        };
        let (known, seeds) = {
            let entries = self.entries.borrow();
            let known = entries.iter().rev().find(|entry| same(entry));
            let seeds = entries.last().map(|entry| entry.rows.clone());
            (known.map(|entry| Arc::clone(&entry.table)), seeds)
        };
        let mut refining = Refining::new(model, &settings, &readings, tolerance)?;
        let is_exact = |table: &Arc<Table>| {
            let most = if tolerance.every_row { 0.0 } else { MOVED };
            within(table.moved_error, most * tolerance.force)
        };
        let known = known.filter(is_exact);
        let moved = match known {
            Some(_) => None,
            None => self.moved(&refining, &of_case, same)?,
        };
        let (mut table, first) = match (known, moved) {
            (Some(table), _) => (Arc::unwrap_or_clone(table), Vec::new()),
            (None, Some(table)) => (table, Vec::new()),
            (None, None) => (
                Table::new(refining.origin()),
                refining.first_loads(seeds.as_deref()),
            ),
        };
        refining.solve(&mut table, first)?;
        refining.run(&mut table)?;
        let rows = refining.rows_of(&table);
        let table = Arc::new(table);
        let mut entries = self.entries.borrow_mut();
        entries.retain(|entry| !same(entry));
        entries.push(Entry {
            unknowns: of_case,
            table: Arc::clone(&table),
            rows,
        });
        if entries.len() > KEPT {
            entries.remove(0);
        }
        Ok(table)
    }

    /// The table of the last unknowns with derivatives, changed by these; `None` if the estimated error of this is too large, or if two states that
    /// are solved again differ by more than this error. Contact radii and gaps are those before: they are not compared with
    /// data, and with a floor that carries load they select no rows.
    fn moved(
        &self,
        refining: &Refining<'_, '_>,
        of_case: &[f64],
        is_here: impl Fn(&Entry) -> bool,
    ) -> Result<Option<Table>, FitError> {
        let (model, tolerance) = (refining.model, refining.tolerance);
        let suits = model.data.rows().len() > SOLVED_AT_END
            && !refining.by_force
            && !model.wants_radius
            && refining.case.system.floor_model() == FloorModel::Contact
            && !model.free.iter().any(|free| free.is_thickness());
        let held = self.held.borrow();
        let Some((before, curves)) = held.as_ref().filter(|_| suits) else {
            return Ok(None);
        };
        let table = {
            let entries = self.entries.borrow();
            let of_held = |entry: &&Entry| entry.unknowns == *before && !is_here(entry);
            entries
                .iter()
                .rev()
                .find(of_held)
                .map(|entry| Arc::clone(&entry.table))
        };
        let Some(table) = table else {
            return Ok(None);
        };
        let steps: Vec<f64> = of_case.iter().zip(before).map(|(a, b)| a - b).collect();
        let change = |load: f64| {
            let terms = curves.iter().zip(&steps);
            terms.fold([0.0; 2], |[force, slope], (curve, step)| {
                [
                    force + step * curve.at(load),
                    slope + step * curve.slope_at(load),
                ]
            })
        };
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, larger);
        let step = largest(&mut steps.iter().map(|step| step.abs()));
        let knots = table.knots();
        let by = largest(&mut knots.iter().map(|knot| change(knot.load)[0].abs()));
        let error = (OF_CHANGE + step) * by;
        if knots.len() < 3 || !within(table.moved_error + error, MOVED * tolerance.force) {
            return Ok(None);
        }
        let loads = [knots[knots.len() / 2].load, table.end()];
        let mut moved = table.moved(change, error);
        let solved = each(model, &loads, |load| match refining.knot(*load, true) {
            Ok(knot) => Ok(Some(knot)),
            Err(SolveError::Interrupted) => Err(SolveError::Interrupted.into()),
            Err(_) => Ok(None),
        })?;
        for knot in solved {
            let difference = knot.and_then(|knot| moved.replace(knot));
            if !difference.is_some_and(|it| within(it.abs(), moved.moved_error)) {
                return Ok(None);
            }
        }
        Ok(Some(moved))
    }

    /// States of some rows alone, at the loads of the interpolated states, with their slopes and the derivatives of their forces.
    pub(super) fn table_of(
        &self,
        model: &Model<'_>,
        unknowns: &[f64],
        rows: &BTreeSet<usize>,
        tolerance: Tolerance,
    ) -> Result<Arc<Table>, FitError> {
        let known = self.table(model, unknowns, tolerance)?;
        let settings = model.settings(unknowns)?;
        let mut readings = self.readings(model, &settings);
        readings.retain(|reading| rows.contains(&reading.row));
        let refining = Refining {
            wants_all: true,
            ..Refining::new(model, &settings, &readings, tolerance)?
        };
        let mut table = Table::new(refining.origin());
        refining.solve(&mut table, refining.loads(&known))?;
        if !refining.by_force {
            refining.add_slopes(&mut table)?;
        }
        Ok(Arc::new(table))
    }

    /// States of all rows.
    pub(super) fn states(
        &self,
        model: &Model<'_>,
        unknowns: &[f64],
        tolerance: Tolerance,
    ) -> Result<Vec<State>, FitError> {
        let settings = model.settings(unknowns)?;
        let table = self.table(model, unknowns, tolerance)?;
        let rows = model.data.rows().iter().zip(&model.moments);
        let states = rows.map(|(row, moment)| {
            let reading = model::load_of(row);
            let state = state_at(model.data, &settings, &table, reading, *moment);
            State {
                read_force: state.force + settings.base_line(*moment, model.travel(row)),
                ..state
            }
        });
        let states: Vec<State> = states.collect();
        let force = |state: &State| match state.problem {
            Some(_) => f64::NAN,
            None => state.force,
        };
        *self.forces.borrow_mut() = states.iter().map(force).collect();
        Ok(states)
    }

    /// Estimated interpolation errors of force and contact radius of every row, of the force at least the tolerance.
    pub(super) fn errors(
        &self,
        model: &Model<'_>,
        unknowns: &[f64],
        states: &[State],
        tolerance: Tolerance,
    ) -> Result<Vec<[f64; 2]>, FitError> {
        let table = self.table(model, unknowns, tolerance)?;
        let by_force = model.data.position() == Position::None;
        let of = |state: &State| {
            let load = if by_force {
                state.force
            } else {
                state.indentation
            };
            if load > 0.0 && state.problem.is_none() {
                // An estimate from differences of states can be zero by chance; intervals are refined to the tolerance.
                let [force, radius] = table.errors_at(load);
                [larger(force, tolerance.force) + table.moved_error, radius]
            } else {
                [0.0; 2]
            }
        };
        Ok(states.iter().map(of).collect())
    }

    /// Derivatives of all rows at states of [`states`](Self::states); `table` is theirs. During a search, derivatives with load on the floor
    /// are used again after small steps.
    pub(super) fn derivatives(
        &self,
        model: &Model<'_>,
        unknowns: &[f64],
        states: &[State],
        table: &Table,
        purpose: Purpose,
    ) -> Result<Vec<Derivatives>, FitError> {
        let settings = model.settings(unknowns)?;
        let by_force = model.data.position() == Position::None;
        let held = self.held(model, unknowns, &settings, table, purpose)?;
        let is_of_case =
            |(_, free): &(&[Monotone; 2], &Parameter)| matches!(free, Parameter::Key(_));
        let of_case = held.iter().zip(model.free).filter(is_of_case);
        *self.held.borrow_mut() = Some((
            Self::of_case(model, unknowns),
            of_case.map(|([force, _], _)| force.clone()).collect(),
        ));
        let of_row = |(number, state): (usize, &State)| {
            if state.problem.is_some() {
                return Derivatives::none(model.free.len());
            }
            let load = if by_force {
                state.force
            } else {
                state.indentation
            };
            if load <= 0.0 {
                let none = vec![[0.0; 2]; model.free.len()];
                return model.at_reading(&settings, unknowns, number, state, [0.0; 2], &none);
            }
            let at = table.at(load);
            let [slope, radius_slope] = at.slopes;
            let along = if by_force {
                [1.0, radius_slope]
            } else {
                [slope, radius_slope]
            };
            let pairs = held.iter().zip(model.free);
            let held: Vec<[f64; 2]> = pairs
                .map(|(curves, parameter)| {
                    let [force, radius] = curves.each_ref().map(|curve| curve.at(load));
                    if parameter.is_thickness() && !by_force {
                        [force * slope * at.answer, radius]
                    } else {
                        [force, radius]
                    }
                })
                .collect();
            model.at_reading(&settings, unknowns, number, state, along, &held)
        };
        Ok(states.iter().enumerate().map(of_row).collect())
    }

    /// Derivatives of force and smooth contact radius with respect to every unknown under a fixed load, as curves over the load.
    fn held(
        &self,
        model: &Model<'_>,
        unknowns: &[f64],
        settings: &Settings,
        table: &Table,
        purpose: Purpose,
    ) -> Result<Vec<[Monotone; 2]>, FitError> {
        let by_force = model.data.position() == Position::None;
        let by_key = ByKey::new(&model.file(unknowns), settings.pillars()?)?;
        let sides = model.sides(unknowns);
        let knots = &table.knots()[1..];
        let of_case = Self::of_case(model, unknowns);
        let is_near = |kept: &OnFloor| {
            let pairs = kept.unknowns.iter().zip(&of_case);
            let far = pairs.fold(0.0, |far: f64, (a, b)| far.max((a - b).abs()));
            match purpose {
                Purpose::Search => far < REUSED,
                Purpose::Result => far < REUSED_AT_END && kept.purpose == Purpose::Result,
            }
        };
        let kept = self.on_floor.borrow_mut().take();
        let kept = kept.filter(|kept| !model.wants_radius && is_near(kept));
        let onset = onset(table);
        let part = |load: f64| (load - onset) / (table.end() - onset).max(f64::MIN_POSITIVE);
        let of_floor = match kept {
            Some(_) => vec![None; knots.len()],
            None => derivatives_on_floor(model, settings, knots)?,
        };
        let mut curves = Vec::new();
        let mut on_floor = Vec::new();
        for (number, parameter) in model.free.iter().enumerate() {
            let (Parameter::Key(key), Some(sides)) = (parameter, &sides[number]) else {
                curves.push([Monotone::new(Vec::new()), Monotone::new(Vec::new())]);
                on_floor.push(Vec::new());
                continue;
            };
            let unit = model.slope(number, unknowns[number]);
            let exact = |k: usize| {
                let known = knots[k].derivatives.as_ref().or(of_floor[k].as_ref())?;
                Some(by_key.exactly(known, *key)? * unit)
            };
            // The effect of a layer on the indentation under a fixed force is smooth, also where pillars come into contact. That of a thick
            // layer is the same under every load, relative to the force.
            let is_thickness = parameter.is_thickness() && !by_force;
            let most = if is_thickness {
                DIFFERENCES_OF_THICKNESS
            } else {
                DIFFERENCES
            };
            let is_exact: Vec<usize> = (0..knots.len()).filter(|k| exact(*k).is_some()).collect();
            let has_exact_floor = is_exact.iter().any(|k| knots[*k].contacts.1);
            let needs = |k: &usize| {
                let between_exact = has_exact_floor && knots[*k].contacts.1;
                model.wants_radius || !between_exact && exact(*k).is_none()
            };
            let needing: Vec<usize> = (0..knots.len()).filter(needs).collect();
            let (floor, above): (Vec<usize>, Vec<usize>) =
                needing.into_iter().partition(|k| knots[*k].contacts.1);
            let mut picked = spread(knots, &above, most[0]);
            let reused = kept.as_ref().map(|kept| &kept.points[number]);
            if reused.is_none() {
                picked.extend(spread(knots, &floor, most[1]));
            }
            let differences = each(model, &picked, |k| {
                let knot = &knots[*k];
                let (load, state) = match by_force {
                    true => (Load::Force(knot.load), (knot.answer, knot.load)),
                    false => (Load::Indentation(knot.load), (knot.load, knot.answer)),
                };
                let state = State {
                    force: state.1,
                    smooth_radius: knot.smooth_radius,
                    ..State::without_contact(state.0)
                };
                Ok(model.between(sides, load, &state)?)
            })?;
            let mut forces = Vec::new();
            let mut radii = vec![(0.0, 0.0)];
            let mut ratios = Vec::new();
            let mut add = |k: usize, force: f64| {
                let knot = &knots[k];
                forces.push((knot.load, force));
                if knot.contacts.1 && !by_force {
                    ratios.push((part(knot.load), force / knot.answer));
                }
            };
            for k in is_exact {
                if let Some(force) = exact(k) {
                    add(k, force);
                }
            }
            for (k, [force, radius]) in picked.iter().zip(differences) {
                if exact(*k).is_none() {
                    add(*k, force);
                }
                radii.push((knots[*k].load, radius));
            }
            if let Some(reused) = reused {
                for k in &floor {
                    let knot = &knots[*k];
                    let ratio = Monotone::new(reused.clone()).at(part(knot.load));
                    forces.push((knot.load, ratio * knot.answer));
                }
                ratios.clone_from(reused);
            }
            if is_thickness {
                for (load, force) in &mut forces {
                    let at = table.at(*load);
                    *force /= at.slopes[0] * at.answer;
                }
                forces.retain(|(_, ratio)| ratio.is_finite());
            } else {
                // Without contact there are no derivatives.
                forces.push((0.0, 0.0));
            }
            forces.sort_by(|a, b| a.0.total_cmp(&b.0));
            radii.sort_by(|a, b| a.0.total_cmp(&b.0));
            curves.push([Monotone::new(forces), Monotone::new(radii)]);
            on_floor.push(ratios);
        }
        let (unknowns, purpose) =
            kept.map_or((of_case, purpose), |kept| (kept.unknowns, kept.purpose));
        *self.on_floor.borrow_mut() = Some(OnFloor {
            unknowns,
            purpose,
            points: on_floor,
        });
        Ok(curves)
    }
}

/// Derivatives of the force of some states with load on the floor that have none, where the contact has them: by knot.
fn derivatives_on_floor(
    model: &Model<'_>,
    settings: &Settings,
    knots: &[Knot],
) -> Result<Vec<Option<ForceDerivatives>>, FitError> {
    let mut found = vec![None; knots.len()];
    let by_force = model.data.position() == Position::None;
    let lacks = |k: &usize| knots[*k].contacts.1 && knots[*k].derivatives.is_none();
    let lacking: Vec<usize> = (0..knots.len()).filter(lacks).collect();
    let of_case = |parameter: &Parameter| matches!(parameter, Parameter::Key(_));
    if by_force || !model.free.iter().any(of_case) {
        return Ok(found);
    }
    let picked = spread(knots, &lacking, DIFFERENCES[1]);
    let case = settings.pillars()?;
    let gradients = each(model, &picked, |k| {
        let gradient = model.gradient(case, Load::Indentation(knots[*k].load), false)?;
        Ok(gradient.and_then(|gradient| gradient.force))
    })?;
    for (k, derivatives) in picked.into_iter().zip(gradients) {
        found[k] = derivatives;
    }
    Ok(found)
}

/// State at a reading, by interpolation.
pub(super) fn state_at(
    data: &Measurements,
    settings: &Settings,
    table: &Table,
    reading: f64,
    moment: f64,
) -> State {
    let target = settings.load(data.position(), reading, moment);
    let by_force = data.position() == Position::None;
    if target <= 0.0 {
        return State {
            smallest_floor_gap: Some(
                table.knots()[0].floor_gap - if by_force { 0.0 } else { target },
            ),
            ..State::without_contact(if by_force { 0.0 } else { target })
        };
    }
    let load = table.load_at(target, settings.compliance(data.position()));
    if let Some((wall, why)) = table.wall()
        && load > table.end()
        && !within(load, 0.5 * (table.end() + wall))
    {
        return State {
            problem: Some(why.to_owned()),
            ..State::without_contact(f64::NAN)
        };
    }
    let at = table.at(load);
    let (indentation, force) = match by_force {
        true => (at.answer, load),
        false => (load, at.answer),
    };
    State {
        force,
        read_force: force,
        contact_radius: at.contact_radius,
        smooth_radius: at.smooth_radius,
        smallest_floor_gap: Some(at.floor_gap),
        past_transition: at.floor_gap < 0.0,
        converged: at.converged,
        ..State::without_contact(indentation)
    }
}

/// The load in the middle between the last state before floor contact and the first one with it; the largest load without any.
fn onset(table: &Table) -> f64 {
    let first = table.knots().iter().position(|knot| knot.contacts.1);
    match first.and_then(|first| Some((first.checked_sub(1)?, first))) {
        Some((below, above)) => f64::midpoint(table.knots()[below].load, table.knots()[above].load),
        None => table.end(),
    }
}

/// Up to `most` of the states, including the first and the last, evenly over the load.
fn spread(knots: &[Knot], of: &[usize], most: usize) -> Vec<usize> {
    let (Some(first), Some(last)) = (of.first(), of.last()) else {
        return Vec::new();
    };
    // States that nearly coincide count once.
    let apart = 200.0 * NEAR * knots[*last].load;
    let mut distinct: Vec<usize> = Vec::new();
    for k in of {
        let previous = distinct.last().map(|previous| knots[*previous].load);
        if previous.is_none_or(|previous| knots[*k].load > previous + apart) {
            distinct.push(*k);
        }
    }
    let of = distinct;
    if of.len() <= most {
        return of;
    }
    let (low, high) = (knots[*first].load, knots[*last].load);
    let mut picked: Vec<usize> = (0..most)
        .filter_map(|part| {
            let wanted = low + (high - low) * part as f64 / (most - 1) as f64;
            let away = |k: &usize| (knots[*k].load - wanted).abs();
            of.iter()
                .copied()
                .min_by(|a, b| away(a).total_cmp(&away(b)))
        })
        .collect();
    picked.sort_unstable();
    picked.dedup();
    picked
}

/// Answers for all items, on the threads of the model.
fn each<T: Sync, A: Send>(
    model: &Model<'_>,
    items: &[T],
    answer: impl Fn(&T) -> Result<A, FitError> + Send + Sync,
) -> Result<Vec<A>, FitError> {
    match model.pool {
        Some(pool) => pool.install(|| items.par_iter().map(answer).collect()),
        None => items.iter().map(answer).collect(),
    }
}

/// Refinement of a table for the rows at a set of unknowns.
struct Refining<'m, 'a> {
    model: &'m Model<'a>,
    case: &'m Case,
    settings: &'m Settings,
    readings: &'m [Reading],
    tolerance: Tolerance,
    compliance: f64,
    by_force: bool,
    /// Whether derivatives with load on the floor are those with respect to all quantities.
    wants_all: bool,
}

impl<'m, 'a> Refining<'m, 'a> {
    fn new(
        model: &'m Model<'a>,
        settings: &'m Settings,
        readings: &'m [Reading],
        tolerance: Tolerance,
    ) -> Result<Self, FitError> {
        let position = model.data.position();
        Ok(Self {
            model,
            case: settings.pillars()?,
            settings,
            readings,
            tolerance,
            compliance: settings.compliance(position),
            by_force: position == Position::None,
            // The states of the result are used for the tests of fixed parameters too.
            wants_all: model.data.rows().len() <= SOLVED_AT_END,
        })
    }

    /// Loads of a new table: those of the rows of the last table, or of rows at equal distances.
    fn first_loads(&self, seeds: Option<&[usize]>) -> Vec<f64> {
        let (Some(first), Some(last)) = (self.readings.first(), self.readings.last()) else {
            return Vec::new();
        };
        let mut loads: Vec<f64> = match seeds {
            Some(rows) if !rows.is_empty() => self
                .readings
                .iter()
                .filter(|reading| rows.contains(&reading.row))
                .map(|reading| reading.guess)
                .collect(),
            _ => (1..FIRST)
                .map(|part| {
                    let reach = last.target - first.target;
                    let wanted = first.target + reach * part as f64 / FIRST as f64;
                    let above = self.readings.partition_point(|other| other.target < wanted);
                    self.readings[above.min(self.readings.len() - 1)].guess
                })
                .collect(),
        };
        loads.push(last.guess);
        loads
    }

    /// The state without contact; the force on a lens that touches nothing does not change.
    fn origin(&self) -> Knot {
        let slope = (!self.by_force).then_some(0.0);
        Knot::origin(self.case.system.pillar().height, slope)
    }

    /// Rows at the states of a table.
    fn rows_of(&self, table: &Table) -> Vec<usize> {
        let loads = self.loads(table);
        let nearest = |knot: &Knot| {
            let away = |k: &usize| (loads[*k] - knot.load).abs();
            let above = loads.partition_point(|load| *load < knot.load);
            let around = [
                above.checked_sub(1),
                Some(above).filter(|k| *k < loads.len()),
            ];
            let nearest = around
                .into_iter()
                .flatten()
                .min_by(|a, b| away(a).total_cmp(&away(b)));
            nearest.map(|k| self.readings[k].row)
        };
        let mut rows: Vec<usize> = table.knots()[1..].iter().filter_map(nearest).collect();
        rows.dedup();
        rows
    }

    /// Loads of the rows on the curve so far.
    fn loads(&self, table: &Table) -> Vec<f64> {
        let readings = self.readings.iter();
        readings
            .map(|reading| table.load_at(reading.target, self.compliance))
            .collect()
    }

    /// Solves under loads and adds the states.
    fn solve(&self, table: &mut Table, mut loads: Vec<f64>) -> Result<(), FitError> {
        loads.retain(|load| *load > 0.0);
        loads.sort_by(f64::total_cmp);
        loads.dedup();
        let floor = table.knots().iter().find(|knot| knot.contacts.1);
        let floor = floor.map_or(f64::INFINITY, |knot| knot.load);
        let has_gradient = |load: f64| !self.wants_all || self.tolerance.is_result || load < floor;
        let solved = each(self.model, &loads, |load| {
            match self.knot(*load, has_gradient(*load)) {
                Ok(knot) => Ok(Ok(knot)),
                Err(error) => {
                    let error = FitError::from(error);
                    if error.is_out_of_reach() {
                        Ok(Err(error.to_string()))
                    } else {
                        Err(error)
                    }
                }
            }
        })?;
        for (load, solved) in loads.into_iter().zip(solved) {
            match solved {
                Ok(knot) => table.insert(knot),
                Err(why) => table.set_wall(load, why),
            }
        }
        Ok(())
    }

    /// State of a contact under an indentation.
    fn knot_of(&self, contact: &ContactState) -> Knot {
        let pillars = contact.pillars_in_contact;
        Knot {
            load: contact.indentation,
            answer: contact.force,
            slope: None,
            contact_radius: contact.contact_radius,
            smooth_radius: smooth_radius(contact),
            floor_gap: contact.smallest_floor_gap,
            contacts: (
                // Up to full contact of the first top, the curve is another one.
                2 * pillars
                    - usize::from(pillars == 1 && contact.pillars_partially_in_contact == 1),
                contact.smallest_floor_gap <= 0.0,
            ),
            converged: self.model.is_known(contact),
            derivatives: None,
        }
    }

    fn knot(&self, load: f64, may_have_gradient: bool) -> Result<Knot, SolveError> {
        let case = self.case;
        if self.by_force {
            let contact = self.model.contact(case, Load::Force(load))?;
            return Ok(Knot {
                load,
                answer: contact.indentation,
                ..self.knot_of(&contact)
            });
        }
        let control = Load::Indentation(load);
        if may_have_gradient
            && let Some(gradient) = self.model.gradient(case, control, self.wants_all)?
        {
            return Ok(Knot {
                slope: Some(gradient.stiffness),
                derivatives: gradient.force,
                ..self.knot_of(&gradient.contact)
            });
        }
        let contact = self.model.contact(case, control)?;
        Ok(Knot {
            load,
            ..self.knot_of(&contact)
        })
    }

    /// Solves further loads until the interpolation error of every row is tolerated.
    fn run(&mut self, table: &mut Table) -> Result<(), FitError> {
        /// Largest number of rounds, each of which may halve every interval.
        const ROUNDS: usize = 40;
        for _ in 0..ROUNDS {
            let further = self.further(table);
            if further.is_empty() || table.knots().len() > MOST.max(SOLVED_AT_END) {
                break;
            }
            self.solve(table, further)?;
        }
        if self.tolerance.is_result && !self.by_force {
            self.add_slopes(table)?;
        }
        Ok(())
    }

    /// Slopes of states with load on the floor, and derivatives of the force, as in fits that solve every row.
    fn add_slopes(&self, table: &mut Table) -> Result<(), FitError> {
        let lacking = |k: &usize| table.knots()[*k].contacts.1 && table.knots()[*k].slope.is_none();
        let lacking: Vec<usize> = (0..table.knots().len()).filter(lacking).collect();
        let case = &self.settings.case;
        let slopes = each(self.model, &lacking, |k| {
            let knot = &table.knots()[*k];
            let state = State {
                force: knot.answer,
                smooth_radius: knot.smooth_radius,
                ..State::without_contact(knot.load)
            };
            let load = Load::Indentation(knot.load);
            if let Some(gradient) = self.model.gradient(self.case, load, self.wants_all)? {
                return Ok((gradient.stiffness, gradient.force));
            }
            let along = self.model.along_load(case, load, &state)?;
            Ok((along[0], None))
        })?;
        for (k, (slope, derivatives)) in lacking.into_iter().zip(slopes) {
            table.set_slope(k, slope, derivatives);
        }
        Ok(())
    }

    /// Loads at which further states are required.
    fn further(&self, table: &Table) -> Vec<f64> {
        let loads = self.loads(table);
        let (end, mut further) = (table.end(), Vec::new());
        let near = NEAR * end;
        // So close to a state its slope suffices.
        let close = 100.0 * near;
        let is_solved = |load: f64| {
            let distance = table.distance(load);
            let is_close = || within(table.errors_at(load)[0], 0.1 * self.tolerance.force);
            distance <= near || !self.by_force && distance <= close && is_close()
        };
        // Beyond the largest state.
        let first_beyond = loads.partition_point(|load| *load <= end + near);
        match table.wall() {
            _ if first_beyond == loads.len() => {}
            None => further.push(loads[loads.len() - 1]),
            Some((wall, _)) => {
                let below_wall = loads.partition_point(|load| *load < wall - near);
                if below_wall > first_beyond {
                    further.push(loads[usize::midpoint(first_beyond, below_wall)]);
                }
            }
        }
        let mut from = 0;
        for interval in 0..table.intervals() {
            let [_, high] = table.interval(interval);
            let until = from + loads[from..].partition_point(|load| *load < high);
            let rows = &loads[from..until];
            from = until;
            let open: Vec<f64> = rows
                .iter()
                .copied()
                .filter(|load| !is_solved(*load))
                .collect();
            let (Some(first), Some(last)) = (open.first(), open.last()) else {
                continue;
            };
            if self.tolerance.every_row {
                further.extend(&open);
                continue;
            }
            let bad_force = !self.by_force
                && open
                    .iter()
                    .any(|load| !within(table.errors_at(*load)[0], self.tolerance.force));
            // A jump of the radius is located between few rows, which it affects.
            let few = loads.len() / 500;
            let bad_radius = self.model.wants_radius
                && !within(table.radius_error(interval), self.tolerance.radius)
                && open.len() > few;
            if bad_force || bad_radius {
                let best = if bad_force {
                    table.best(interval)
                } else {
                    open[open.len() / 2]
                };
                let wanted = clamped(best, *first, *last);
                let away = |load: &f64| (load - wanted).abs();
                let nearest = open
                    .iter()
                    .copied()
                    .min_by(|a, b| away(a).total_cmp(&away(b)));
                further.extend(nearest);
            }
        }
        further
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::column::Column;
    use crate::fit::options::FitOptions;
    use chacha20::ChaCha12Rng;
    use chacha20::rand_core::{Rng, SeedableRng};
    use fakir::state::Run;
    use fakir_case::CaseFile;

    /// Random cases, with the axis anywhere, of two methods: at rows that are not solved the difference from a solution is below the
    /// estimated error. A hundredth of the tolerance is allowed for the solver.
    #[test]
    fn estimated_errors_cover_the_differences() {
        const ROWS: u32 = 60;
        let mut random = ChaCha12Rng::seed_from_u64(11);
        let mut uniform = |low: f64, high: f64| {
            low + (high - low) * f64::from(random.next_u32()) / f64::from(u32::MAX)
        };
        let (mut compared, mut worst) = (0, 0.0f64);
        for number in 0..8 {
            let method = ["spectral", "punch"][number % 2];
            let mut file = CaseFile::parse("case", &Case::example().to_toml()).unwrap();
            for given in [
                format!("method.name={method}"),
                "floor.contact=false".to_owned(),
                format!("pattern.surface_fraction={}", uniform(0.005, 0.03)),
                format!("pattern.offset={}", uniform(0.0, 0.5)),
                format!("substrate.young_modulus={}", uniform(0.5e6, 5e6)),
            ] {
                file.set(&given).unwrap();
            }
            let depth = |row: u32| 2.5e-6 * f64::from(row + 1) / f64::from(ROWS);
            let columns = [
                (Column::Indentation, (0..ROWS).map(depth).collect()),
                (Column::Force, vec![1e-4; ROWS as usize]),
            ];
            let data = Measurements::new(&columns).unwrap();
            let free = [Parameter::Key(fakir_case::Key::SubstrateYoungModulus)];
            let (options, run) = (FitOptions::default(), Run::default());
            let model = Model::new(&file, &data, &free, &options, &run).unwrap();
            let begin = model.start().unwrap();
            let sampled = Sampled::default();
            let tolerance = Tolerance {
                force: 1e-3 * 1e-4,
                radius: 0.0,
                every_row: false,
                is_result: false,
            };
            let states = sampled.states(&model, &begin, tolerance).unwrap();
            let errors = sampled.errors(&model, &begin, &states, tolerance).unwrap();
            let solved = model.states(&begin, 0.0).unwrap();
            for (row, ((state, exact), [error, _])) in
                states.iter().zip(&solved).zip(&errors).enumerate()
            {
                let difference = (state.force - exact.force).abs();
                // Errors far below the tolerance are those of the solver.
                let allowed = error + 0.01 * tolerance.force;
                assert!(
                    difference <= allowed,
                    "{method} {number} row {row}: {difference:e} {error:e}"
                );
                assert!(*error <= tolerance.force, "{error:e}");
                if *error > 0.0 {
                    compared += 1;
                    worst = worst.max(difference / allowed);
                }
            }
        }
        assert!(compared > 100, "{compared}");
        eprintln!("largest difference over estimate {worst:.2} in {compared} rows");
    }
}
