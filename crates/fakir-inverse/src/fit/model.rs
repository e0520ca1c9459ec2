//! What the model says in place of every measured value, and how that changes with the
//! parameters.

use super::measurements::{Measurement, Measurements, Position};
use super::parameter::Parameter;
use super::{FitError, FitOptions};
use fakir::numerics::convergence::within;
use fakir::problem::{Control, Method};
use fakir::state::{ContactState, Run, SolveError};
use fakir_case::{Case, CaseFile, Key};
use rayon::prelude::*;

/// Relative step of derivatives: the error of a difference is its square, and kinks of the curve,
/// where pillars are touched first, are spread as errors of measurement spread them.
const DIFFERENCE: f64 = 1e-2;

/// Relative error at which reading, force and indentation agree.
const BALANCE: f64 = 1e-9;

/// The most steps in which they must agree.
const MOST_STEPS: usize = 40;

/// A state in place of a measured one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct State {
    /// Indentation, m.
    pub(super) indentation: f64,
    /// Force, N.
    pub(super) force: f64,
    /// Contact radius, m.
    pub(super) contact_radius: f64,
    /// Contact radius of the homogenised lattice, m: it has no jumps, and so a derivative.
    pub(super) smooth_radius: f64,
    /// Smallest gap between lens and floor, m.
    pub(super) smallest_floor_gap: f64,
    pub(super) converged: bool,
}

/// Derivatives of force and contact radius in a row.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Derivatives {
    /// By each unknown.
    pub(super) force: Vec<f64>,
    pub(super) contact_radius: Vec<f64>,
    /// By the position: of the force in N/m, of the contact radius without unit.
    pub(super) force_by_position: f64,
    pub(super) radius_by_position: f64,
    /// Of the contact radius by the force where the force is the load, m/N.
    pub(super) radius_by_force: f64,
}

/// The values that go with some unknowns.
#[derive(Debug, Clone)]
pub(super) struct Settings {
    pub(super) case: Case,
    /// Contact point, m.
    pub(super) contact_point: f64,
    /// Machine compliance, m/N.
    pub(super) machine_compliance: f64,
}

pub(super) struct Model<'a> {
    file: &'a CaseFile,
    pub(super) data: &'a Measurements,
    pub(super) free: &'a [Parameter],
    /// Where the fit begins.
    start: Settings,
    /// What an unknown of 1 stands for; of logarithms, the starting value.
    units: Vec<f64>,
    single: Run<'a>,
    pool: Option<&'a rayon::ThreadPool>,
    wants_radius: bool,
}

impl<'a> Model<'a> {
    pub(super) fn new(
        file: &'a CaseFile,
        data: &'a Measurements,
        free: &'a [Parameter],
        options: &FitOptions,
        run: &Run<'a>,
    ) -> Result<Self, FitError> {
        let case = file.case()?;
        let wants_radius = data.rows().iter().any(|row| row.contact_radius.is_some());
        let mut model = Self {
            file,
            data,
            free,
            start: Settings {
                case,
                contact_point: options.contact_point.unwrap_or(0.0),
                machine_compliance: options.machine_compliance,
            },
            units: Vec::new(),
            // Threads share the rows, and every row is computed by one thread.
            single: Run {
                pool: None,
                progress: None,
                ..run.clone()
            },
            pool: run.pool,
            wants_radius,
        };
        if free.contains(&Parameter::ContactPoint) && options.contact_point.is_none() {
            model.start.contact_point = model.likely_contact_point()?;
        }
        let range = model.position_range();
        let units = free.iter().map(|parameter| {
            Ok(match parameter {
                Parameter::Key(_) if parameter.is_positive() => model.start_of(*parameter)?,
                Parameter::Key(_) => 1.0,
                Parameter::ContactPoint => range,
                Parameter::MachineCompliance => range / model.largest_force(),
            })
        });
        model.units = units.collect::<Result<_, FitError>>()?;
        Ok(model)
    }

    fn position_range(&self) -> f64 {
        let positions = self.data.rows().iter().filter_map(|row| row.position);
        let (low, high) = positions.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
            (low.min(p.value), high.max(p.value))
        });
        if high > low { high - low } else { 1e-6 }
    }

    fn largest_force(&self) -> f64 {
        let forces = self.data.rows().iter().filter_map(|row| row.force);
        let largest = forces.fold(0.0, |largest: f64, force| largest.max(force.value));
        if largest > 0.0 { largest } else { 1e-6 }
    }

    /// Where contact begins if the case is as in its file: from the state nearest to a tenth of
    /// the largest force, where a wrong modulus moves it little.
    fn likely_contact_point(&self) -> Result<f64, FitError> {
        let wanted = 0.1 * self.largest_force();
        let rows = self.data.rows().iter();
        let loaded = rows.filter_map(|row| Some((row.position?.value, row.force?.value)));
        let away = |force: f64| (force / wanted).ln().abs();
        let nearest = loaded
            .filter(|(_, force)| *force > 0.0)
            .min_by(|a, b| away(a.1).total_cmp(&away(b.1)));
        match nearest {
            Some((position, force)) => {
                let state = self.solve(&self.start.case, Control::Force(force))?;
                Ok(position - self.start.machine_compliance * force - state.indentation)
            }
            None => {
                let positions = self.data.rows().iter().filter_map(|row| row.position);
                Ok(positions.map(|p| p.value).fold(f64::INFINITY, f64::min))
            }
        }
    }

    /// The value of a parameter where the fit begins, in SI units.
    fn start_of(&self, parameter: Parameter) -> Result<f64, FitError> {
        match parameter {
            Parameter::Key(key) => {
                let number = self.start.case.number(key);
                number.ok_or(FitError::NotFree(parameter))
            }
            Parameter::ContactPoint => Ok(self.start.contact_point),
            Parameter::MachineCompliance => Ok(self.start.machine_compliance),
        }
    }

    /// The unknowns where the fit begins.
    pub(super) fn start(&self) -> Result<Vec<f64>, FitError> {
        let unknowns = self.free.iter().zip(&self.units).map(|(parameter, unit)| {
            if parameter.is_positive() {
                return Ok(0.0);
            }
            let value = self.start_of(*parameter)?;
            // With the lens axis on a pillar every direction looks the same: begin beside it.
            let is_on_pillar = *parameter == Parameter::Key(Key::Offset) && value.abs() < 0.05;
            Ok(if is_on_pillar { 0.25 } else { value / unit })
        });
        unknowns.collect()
    }

    /// The value of a parameter, in SI units.
    pub(super) fn value(&self, number: usize, unknown: f64) -> f64 {
        let (parameter, unit) = (self.free[number], self.units[number]);
        match parameter {
            Parameter::Key(Key::Offset) => unknown.abs(), // by symmetry
            _ if parameter.is_positive() => unit * unknown.exp(),
            _ => unit * unknown,
        }
    }

    /// What an unknown of 1 stands for, if it is no logarithm.
    pub(super) fn unit(&self, number: usize) -> f64 {
        self.units[number]
    }

    pub(super) fn file(&self, unknowns: &[f64]) -> CaseFile {
        let mut file = self.file.clone();
        for (number, unknown) in unknowns.iter().enumerate() {
            if let Parameter::Key(key) = self.free[number] {
                file.set_number(key, self.value(number, *unknown));
            }
        }
        file
    }

    pub(super) fn settings(&self, unknowns: &[f64]) -> Result<Settings, FitError> {
        let mut settings = Settings {
            case: self.file(unknowns).case()?,
            ..self.start.clone()
        };
        for (number, unknown) in unknowns.iter().enumerate() {
            match self.free[number] {
                Parameter::ContactPoint => settings.contact_point = self.value(number, *unknown),
                Parameter::MachineCompliance => {
                    settings.machine_compliance = self.value(number, *unknown);
                }
                Parameter::Key(_) => {}
            }
        }
        Ok(settings)
    }

    /// The states in place of the measured ones.
    pub(super) fn states(&self, unknowns: &[f64]) -> Result<Vec<State>, FitError> {
        let settings = self.settings(unknowns)?;
        self.for_each_row(|_, row| self.state(&settings, row))
    }

    fn for_each_row<T: Send>(
        &self,
        answer: impl Fn(usize, &Measurement) -> Result<T, FitError> + Sync,
    ) -> Result<Vec<T>, FitError> {
        let rows = self.data.rows();
        let answer = |(number, row): (usize, &Measurement)| answer(number, row);
        match self.pool {
            Some(pool) => pool.install(|| rows.par_iter().enumerate().map(answer).collect()),
            None => rows.iter().enumerate().map(answer).collect(),
        }
    }

    fn state(&self, settings: &Settings, row: &Measurement) -> Result<State, FitError> {
        match (row.position, row.force) {
            (Some(position), force) => {
                let guess = force.map_or(0.0, |force| force.value);
                self.state_at(settings, position.value, guess)
            }
            (None, force) => self.state_under(settings, force.map_or(0.0, |force| force.value)),
        }
    }

    /// The state under a force.
    pub(super) fn state_under(&self, settings: &Settings, force: f64) -> Result<State, FitError> {
        Ok(self.solve(&settings.case, Control::Force(force))?)
    }

    /// The state at a reading: the indentation `zeta` with
    /// `zeta + machine_compliance F(zeta) = reading - contact_point`, by secants.
    pub(super) fn state_at(
        &self,
        settings: &Settings,
        reading: f64,
        likely_force: f64,
    ) -> Result<State, FitError> {
        let (compliance, target) = match self.data.position() {
            Position::Displacement => (
                settings.machine_compliance,
                reading - settings.contact_point,
            ),
            _ => (0.0, reading),
        };
        let solve = |zeta: f64| self.solve(&settings.case, Control::Indentation(zeta));
        if compliance == 0.0 || target <= 0.0 {
            return Ok(solve(target)?);
        }
        let excess = |state: &State| state.indentation + compliance * state.force - target;
        let met = |state: &State| within(excess(state).abs(), BALANCE * target);
        let mut last = solve((target - compliance * likely_force).clamp(0.1 * target, target))?;
        let mut state = solve(target - compliance * last.force)?;
        for _ in 0..MOST_STEPS {
            if met(&state) {
                return Ok(state);
            }
            let change = state.indentation - last.indentation;
            let slope = (excess(&state) - excess(&last)) / change;
            let next = state.indentation - excess(&state) / slope;
            if !next.is_finite() {
                break;
            }
            last = state;
            state = solve(next)?;
        }
        if met(&state) {
            Ok(state)
        } else {
            Err(FitError::NoBalance {
                compliance,
                reading,
            })
        }
    }

    fn solve(&self, case: &Case, load: Control) -> Result<State, SolveError> {
        if let Control::Indentation(zeta) = load
            && zeta <= 0.0
        {
            return Ok(State {
                indentation: zeta,
                force: 0.0,
                contact_radius: 0.0,
                smooth_radius: 0.0,
                smallest_floor_gap: case.system.pillar().height - zeta,
                converged: true,
            });
        }
        let press = |method: Method| fakir::press(&case.system, load, method, &self.single);
        let contact: ContactState = press(case.method)?;
        let smooth_radius = if !self.wants_radius || case.method == Method::Homogenised {
            contact.contact_radius
        } else {
            press(Method::Homogenised)?.contact_radius
        };
        Ok(State {
            indentation: contact.indentation,
            force: contact.force,
            contact_radius: contact.contact_radius,
            smooth_radius,
            smallest_floor_gap: contact.smallest_floor_gap,
            converged: contact.converged(),
        })
    }

    /// Derivatives by central differences, at fixed indentation, and from these at fixed reading:
    /// with `F' = dF/dzeta` and `C` the machine compliance,
    /// `dzeta = (d(reading) - d(contact_point) - F dC - C dF|_zeta)/(1 + C F')`.
    pub(super) fn derivatives(
        &self,
        unknowns: &[f64],
        states: &[State],
    ) -> Result<Vec<Derivatives>, FitError> {
        let settings = self.settings(unknowns)?;
        let mut sides = Vec::new();
        for (number, parameter) in self.free.iter().enumerate() {
            sides.push(match parameter {
                Parameter::Key(_) => Some([-DIFFERENCE, DIFFERENCE].map(|step| {
                    let mut moved = unknowns.to_vec();
                    moved[number] += step;
                    self.settings(&moved).map(|settings| settings.case)
                })),
                _ => None,
            });
        }
        let mut cases = Vec::new();
        for side in sides {
            cases.push(match side {
                Some([below, above]) => Some([below?, above?]),
                None => None,
            });
        }
        self.for_each_row(|number, row| {
            let state = &states[number];
            let load = match row.position {
                Some(_) => Control::Indentation(state.indentation),
                None => Control::Force(state.force),
            };
            let along = self.along_load(&settings.case, load)?;
            let mut all = Derivatives::default();
            let compliance = match (row.position, self.data.position()) {
                (Some(_), Position::Displacement) => settings.machine_compliance,
                _ => 0.0,
            };
            // The derivative of the indentation by the position.
            let follow = match row.position {
                Some(_) => 1.0 / (1.0 + compliance * along[0]),
                None => {
                    all.radius_by_force = along[1];
                    0.0
                }
            };
            all.force_by_position = along[0] * follow;
            all.radius_by_position = along[1] * follow;
            for (number, parameter) in self.free.iter().enumerate() {
                let ([force, radius], moved) = match (parameter, &cases[number]) {
                    (Parameter::Key(_), Some(cases)) => {
                        let held = self.between(cases, load)?;
                        (held, -compliance * held[0] * follow)
                    }
                    (Parameter::ContactPoint, _) => ([0.0; 2], -self.units[number] * follow),
                    _ => ([0.0; 2], -self.units[number] * state.force * follow),
                };
                all.force.push(force + along[0] * moved);
                all.contact_radius.push(radius + along[1] * moved);
            }
            Ok(all)
        })
    }

    /// Derivatives of force and smooth contact radius by the load.
    fn along_load(&self, case: &Case, load: Control) -> Result<[f64; 2], SolveError> {
        let at = |factor: f64| match load {
            Control::Indentation(value) => Control::Indentation(factor * value),
            Control::Force(value) => Control::Force(factor * value),
            Control::FloorContact => Control::FloorContact,
        };
        let value = match load {
            Control::Indentation(value) | Control::Force(value) => value,
            Control::FloorContact => 0.0, // nothing to go along
        };
        if value <= 0.0 {
            return Ok([0.0; 2]);
        }
        let below = self.solve(case, at(1.0 - DIFFERENCE))?;
        let above = self.solve(case, at(1.0 + DIFFERENCE))?;
        Ok(difference(&below, &above, DIFFERENCE * value))
    }

    /// Derivatives of force and smooth contact radius from one case to another.
    fn between(&self, [below, above]: &[Case; 2], load: Control) -> Result<[f64; 2], SolveError> {
        let (below, above) = (self.solve(below, load)?, self.solve(above, load)?);
        Ok(difference(&below, &above, DIFFERENCE))
    }
}

fn difference(below: &State, above: &State, step: f64) -> [f64; 2] {
    [
        (above.force - below.force) / (2.0 * step),
        (above.smooth_radius - below.smooth_radius) / (2.0 * step),
    ]
}
