//! Model values that correspond to the measured values, and their derivatives with respect to the
//! parameters.

use super::attachment::attached;
use super::curve::Curve;
use super::error::FitError;
use super::measurements::{Measurement, Measurements, Position};
use super::options::FitOptions;
use super::over_time::{CaseCurve, Curves, Reach};
use super::parameter::Parameter;
use super::radius::smooth_radius;
use super::subject::{FittedCycle, Subject, some};
use crate::derivative::ByKey;
use fakir::numerics::convergence::{clamped, larger, within};
use fakir::numerics::roots;
use fakir::problem::{
    Adhesion, CyclePlan, Load, LoadingMode, Method, Quantity, Relaxation, UnloadingPoint,
};
use fakir::solve::elastic_curve::ElasticCurve;
use fakir::solve::viscoelastic::{MeasuredBy, MeasuredLoad, measured_history};
use fakir::state::{
    Branch, ContactState, Gradient, LARGEST_ERROR, Limit, Run, Solution, SolveError,
};
use fakir_case::{Case, CaseFile, FlatCase, Key};
use fakir_study::approach::Loadable;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

/// Relative step of differences. The error of a difference is the square of the step. Kinks of the
/// curve, where pillars come into contact, are smoothed over the step, as measurement errors do.
const DIFFERENCE: f64 = 1e-2;

/// The same for a work of adhesion, which is larger because pillars detach in groups.
const DIFFERENCE_OF_WORK: f64 = 5e-2;

/// The same for elastic bodies on a flat surface, whose states are accurate to 1e-10. The curve of an attached lens ends like a square root; with a longer step,
/// derivatives of rows beside this end are those of the other side, and a search stops beside the best fit.
const DIFFERENCE_ON_FLAT: f64 = 1e-5;

/// The same for a size on a height map: two solved curves differ by their errors, a few thousandths, too.
const DIFFERENCE_ON_CELLS: f64 = 1e-1;

/// Fraction of these steps below which a step is too short for a difference.
const SHORTEST: f64 = 0.1;

/// Distance within which rows share the variance of jumps, as a fraction of the range of the loads.
const AROUND: f64 = 0.125;

/// Relative tolerance of the solution for the indentation at a reading.
const BALANCE: f64 = 1e-9;

/// Largest number of steps of this solution.
const MOST_STEPS: usize = 40;

/// The computed state that corresponds to a measured one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct State {
    /// Indentation, m.
    pub(super) indentation: f64,
    /// Force, N.
    pub(super) force: f64,
    /// Force that the instrument would read, N: with its offset, and on unloading with adhesion from the line through an interval of the
    /// curve.
    pub(super) read_force: f64,
    /// Mean square deviation of the force from such lines, averaged over neighbouring rows, N^2.
    pub(super) force_variance: f64,
    /// Number of rows in its interval, which share its jumps.
    pub(super) sharing: f64,
    /// Slopes of that line and of the line through the contact radius.
    pub(super) slopes: [f64; 2],
    /// Contact radius, m.
    pub(super) contact_radius: f64,
    /// [Contact radius without jumps](smooth_radius), m, or that of a line through an interval.
    pub(super) smooth_radius: f64,
    /// Smallest gap between lens and floor, m; not available along a cycle.
    pub(super) smallest_floor_gap: Option<f64>,
    /// Whether the state is past the transition.
    pub(super) past_transition: bool,
    pub(super) converged: bool,
    /// Reason why the model has no such state, and therefore no values.
    pub(super) problem: Option<String>,
}

/// A work of adhesion is linear below the first of these unknowns, and zero at the second.
const LINEAR: f64 = -1.0;
pub(super) const ZERO: f64 = LINEAR - 1.0;

/// Unknown of a work of adhesion, given in units.
fn unknown_of(units: f64) -> f64 {
    if units > LINEAR.exp() {
        units.ln()
    } else {
        units / LINEAR.exp() + ZERO
    }
}

impl State {
    /// State at an indentation (m) without contact, or without a solution.
    pub(super) fn without_contact(indentation: f64) -> Self {
        Self {
            indentation,
            force: 0.0,
            read_force: 0.0,
            force_variance: 0.0,
            sharing: 1.0,
            slopes: [0.0; 2],
            contact_radius: 0.0,
            smooth_radius: 0.0,
            smallest_floor_gap: None,
            past_transition: false,
            converged: true,
            problem: None,
        }
    }
}

/// Derivatives of force and contact radius in a row.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Derivatives {
    /// With respect to each unknown.
    pub(super) force: Vec<f64>,
    pub(super) contact_radius: Vec<f64>,
    /// With respect to the position: of the force in N/m, of the contact radius dimensionless.
    pub(super) force_by_position: f64,
    pub(super) radius_by_position: f64,
    /// Of the contact radius with respect to the force if the force is the load, m/N.
    pub(super) radius_by_force: f64,
}

impl Derivatives {
    /// Derivatives of a row that is outside the model.
    pub(super) fn none(unknowns: usize) -> Self {
        let none = vec![0.0; unknowns];
        Self {
            force: none.clone(),
            contact_radius: none,
            ..Self::default()
        }
    }
}

/// Values that correspond to a set of unknowns.
#[derive(Debug, Clone)]
pub(super) struct Settings {
    pub(super) case: Subject,
    /// Contact point, m.
    pub(super) contact_point: f64,
    /// Machine compliance, m/N.
    pub(super) machine_compliance: f64,
    /// Reading of the instrument without any force at the first row, N.
    pub(super) force_offset: f64,
    /// Drift of the displacement (m) and the force (N) from the first row to the last.
    pub(super) displacement_drift: f64,
    pub(super) force_drift: f64,
    /// Slope of the reading without any force over the displacement, N/m.
    pub(super) force_slope: f64,
    /// Relaxation of viscoelastic bodies, if the data contain times.
    pub(super) relaxation: Option<Relaxation>,
}

impl Settings {
    /// Measured load minus the contributions of the instrument at a time, which is 0 at the first row and 1 at the last.
    pub(super) fn load(&self, position: Position, measured: f64, moment: f64) -> f64 {
        match position {
            Position::Displacement => {
                measured - self.contact_point - self.displacement_drift * moment
            }
            Position::Indentation => measured,
            Position::None => measured - self.offset(moment),
        }
    }

    /// Compliance between the measured position and the lens, m/N.
    pub(super) fn compliance(&self, position: Position) -> f64 {
        match position {
            Position::Displacement => self.machine_compliance,
            Position::Indentation | Position::None => 0.0,
        }
    }

    /// The case with pillars.
    ///
    /// # Errors
    /// Other surfaces have none; their states are not interpolated between rows.
    pub(super) fn pillars(&self) -> Result<&Case, FitError> {
        match &self.case {
            Subject::Pillars(case) => Ok(case),
            _ => Err(FitError::NoDerivatives),
        }
    }

    /// Reading of the instrument without any force at a time and at a distance from the displacement of the first row, N.
    pub(super) fn base_line(&self, moment: f64, travel: f64) -> f64 {
        self.offset(moment) + self.force_slope * travel
    }

    /// Reading of the instrument without any force at a time, at the displacement of the first row, N.
    pub(super) fn offset(&self, moment: f64) -> f64 {
        self.force_offset + self.force_drift * moment
    }
}

/// Relation between the value of a parameter and its unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Scale {
    /// A multiple of the unknown.
    Multiple(f64),
    /// The absolute value of the unknown.
    Distance,
    /// A multiple of the exponential of the unknown.
    Logarithm(f64),
    /// The same if the unknown is above -1; below, the tangent, which reaches zero at -2: for works of adhesion.
    FromZero(f64),
    /// A constant over the unknown: for a half-space, whose thickness is infinite.
    Inverse(f64),
}

/// A bound of the unknowns that a step would violate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum RangeEnd {
    /// This unknown is at a bound of its range.
    Of(usize),
    /// The work of adhesion and the receding work, which cannot be smaller, are equal.
    Equal([usize; 2]),
}

/// Valid cases on both sides of a set of unknowns, and their distances in one of the unknowns.
pub(super) type Sides = [Option<(Subject, f64)>; 2];

pub(super) struct Model<'a> {
    file: CaseFile,
    pub(super) data: &'a Measurements,
    pub(super) free: &'a [Parameter],
    /// Start of the fit.
    start: Settings,
    scales: Vec<Scale>,
    pub(super) single: Run<'a>,
    pub(super) pool: Option<&'a rayon::ThreadPool>,
    /// Computes loading curves of height maps, with all threads and progress.
    whole: Run<'a>,
    pub(super) wants_radius: bool,
    /// Whether pillar tops are adhesive: then all rows belong to one cycle of loading and
    /// unloading.
    pub(super) is_adhesive: bool,
    /// Whether the bodies are viscoelastic and the data contain times: then all rows belong to one history.
    pub(super) is_viscoelastic: bool,
    /// Elastic curves for it.
    curves: Arc<Curves>,
    /// The branch of every row.
    pub(super) branches: Vec<Branch>,
    /// For every row, whether the lens is attached, if the data show it.
    attached: Vec<Option<bool>>,
    /// Rows of each branch in the order of increasing load.
    orders: [Vec<usize>; 2],
    /// For every row, the difference of the loads of its neighbours on its branch.
    stretches: Vec<f64>,
    /// Time of every row, from 0 at the first to 1 at the last.
    pub(super) moments: Vec<f64>,
    /// Number of contacts and cycles solved.
    pub(super) solved: AtomicUsize,
    /// Unit of the inverse thickness of a half-space, once it is known.
    scale_of_thickness: Arc<OnceLock<f64>>,
}

impl<'a> Model<'a> {
    pub(super) fn new(
        file: &'a CaseFile,
        data: &'a Measurements,
        free: &'a [Parameter],
        options: &FitOptions,
        run: &Run<'a>,
    ) -> Result<Self, FitError> {
        let mut file = file.clone();
        if free.iter().any(|free| free.is_of_relaxation()) {
            // The terms of a table begin at the series that is fitted to it.
            file.write_relaxation_terms()?;
        }
        let case = Subject::of(&file)?;
        let wants_radius = data.rows().iter().any(|row| row.contact_radius.is_some());
        let is_adhesive = !case.adhesion().is_none() || free.iter().any(|free| free.is_work());
        if is_adhesive {
            data.check_cycles()?;
        }
        let relaxation = relaxation_over_time(&file, data)?;
        if relaxation.is_some() {
            case.check_history()?;
            check_history(data)?;
        }
        let branches = data.branches();
        let orders = [Branch::Loading, Branch::Unloading].map(|branch| {
            let rows = 0..branches.len();
            let mut order: Vec<usize> = rows.filter(|row| branches[*row] == branch).collect();
            order.sort_by(|a, b| load_of(&data.rows()[*a]).total_cmp(&load_of(&data.rows()[*b])));
            order
        });
        let mut model = Self {
            file,
            data,
            free,
            start: Settings {
                case,
                contact_point: options.contact_point.unwrap_or(0.0),
                machine_compliance: options.machine_compliance,
                force_offset: options.force_offset,
                displacement_drift: options.displacement_drift,
                force_drift: options.force_drift,
                force_slope: options.force_slope,
                relaxation: relaxation.clone(),
            },
            scales: Vec::new(),
            is_viscoelastic: relaxation.is_some(),
            curves: Arc::default(),
            // Threads share the rows; every row is computed by one thread.
            single: Run {
                pool: None,
                progress: None,
                ..run.clone()
            },
            pool: run.pool,
            whole: run.clone(),
            wants_radius,
            is_adhesive,
            stretches: stretches(data, &orders),
            attached: {
                let is_known = !free.contains(&Parameter::ForceOffset);
                attached(data, &orders, is_known.then_some(options.force_offset))
            },
            orders,
            branches,
            moments: moments(data),
            solved: AtomicUsize::new(0),
            scale_of_thickness: Arc::default(),
        };
        if free.contains(&Parameter::ForceOffset) {
            model.begin_at_rest();
        }
        if free.contains(&Parameter::ContactPoint) && options.contact_point.is_none() {
            model.start.contact_point = model.likely_contact_point()?;
            model.begin_within_model()?;
        }
        if let Some(infinite) = free.iter().find(|free| model.is_infinite(**free)) {
            return Err(FitError::NotGiven(*infinite));
        }
        model.begin_with_work()?;
        model.scales = model.scales_of(free)?;
        Ok(model)
    }

    /// The model at a set of unknowns, with other free parameters.
    pub(super) fn with<'b>(
        &self,
        unknowns: &[f64],
        free: &'b [Parameter],
    ) -> Result<Model<'b>, FitError>
    where
        'a: 'b,
    {
        let mut model: Model<'b> = Model {
            file: self.file(unknowns),
            data: self.data,
            free,
            start: self.settings(unknowns)?,
            scales: Vec::new(),
            single: self.single.clone(),
            pool: self.pool,
            whole: self.whole.clone(),
            wants_radius: self.wants_radius,
            is_adhesive: self.is_adhesive,
            is_viscoelastic: self.is_viscoelastic,
            curves: Arc::clone(&self.curves),
            branches: self.branches.clone(),
            attached: self.attached.clone(),
            orders: self.orders.clone(),
            stretches: self.stretches.clone(),
            moments: self.moments.clone(),
            solved: AtomicUsize::new(0),
            scale_of_thickness: Arc::clone(&self.scale_of_thickness),
        };
        model.scales = model.scales_of(free)?;
        Ok(model)
    }

    /// Number of contacts and cycles solved so far.
    pub(super) fn solved(&self) -> usize {
        self.solved.load(Ordering::Relaxed)
    }

    fn scales_of(&self, free: &[Parameter]) -> Result<Vec<Scale>, FitError> {
        let range = self.load_range();
        // Both works of adhesion have the same unit, so that their unknowns can be compared.
        let works = free.iter().filter(|parameter| parameter.is_work());
        let works: Vec<f64> = works
            .map(|work| self.start_of(*work))
            .collect::<Result<_, _>>()?;
        let largest_work = works.into_iter().fold(0.0, larger);
        let scales = free.iter().map(|parameter| {
            Ok(match parameter {
                Parameter::Key(_) if parameter.is_work() => Scale::FromZero(largest_work),
                Parameter::Key(_) if self.is_infinite(*parameter) => {
                    Scale::Inverse(self.largest_contact()?)
                }
                Parameter::Key(_) if parameter.is_positive() => {
                    Scale::Logarithm(self.start_of(*parameter)?)
                }
                Parameter::Key(Key::Offset) => Scale::Distance,
                Parameter::Key(_) => Scale::Multiple(1.0),
                Parameter::ContactPoint | Parameter::DisplacementDrift => Scale::Multiple(range),
                Parameter::MachineCompliance => Scale::Multiple(range / self.largest_force()),
                Parameter::ForceOffset | Parameter::ForceDrift => {
                    Scale::Multiple(self.largest_force())
                }
                Parameter::ForceSlope => Scale::Multiple(self.largest_force() / range),
                Parameter::RelaxationStrength(_) | Parameter::RelaxationTime(_) => {
                    Scale::Logarithm(self.start_of(*parameter)?)
                }
            })
        });
        scales.collect()
    }

    /// Whether the surface is flat.
    pub(super) fn is_flat(&self) -> bool {
        matches!(self.start.case, Subject::Flat(_))
    }

    /// Whether there are pillars with flat tops.
    pub(super) fn has_pillars(&self) -> bool {
        self.start.case.has_pillars()
    }

    /// Whether pillar tops are rounded.
    pub(super) fn is_rounded(&self) -> bool {
        matches!(self.start.case, Subject::Asperities(_))
    }

    /// Whether the surface is a height map.
    pub(super) fn is_map(&self) -> bool {
        matches!(self.start.case, Subject::HeightMap(_))
    }

    /// Whether all states are on one elastic curve.
    pub(super) fn uses_curve(&self) -> bool {
        (self.is_rounded() || self.is_map()) && !self.is_adhesive && !self.is_viscoelastic
    }

    /// Whether a key has a value in the case.
    pub(super) fn is_given(&self, key: Key) -> bool {
        self.start.case.has(key)
    }

    /// Gives a free parameter, by its number, the unknown that it has in another model.
    pub(super) fn scale_as(&mut self, other: &Model<'_>, number: usize) {
        self.scales[number] = other.scales[number];
    }

    /// Whether it is the thickness of a half-space.
    pub(super) fn is_infinite(&self, parameter: Parameter) -> bool {
        matches!(parameter, Parameter::Key(key) if parameter.is_thickness() && !self.start.case.has(key))
    }

    /// Contact radius of the row with the largest load, m; computed once for this model and those made from it, since it is only a scale.
    fn largest_contact(&self) -> Result<f64, FitError> {
        if let Some(known) = self.scale_of_thickness.get() {
            return Ok(*known);
        }
        let rows = self.data.rows().iter().zip(&self.moments);
        let last = rows.max_by(|a, b| load_of(a.0).total_cmp(&load_of(b.0)));
        let radius = match last {
            Some((row, moment)) => self.row_state(&self.start, row, *moment)?.contact_radius,
            None => 0.0,
        };
        let radius = larger(radius, self.start.case.least_radius());
        Ok(*self.scale_of_thickness.get_or_init(|| radius))
    }

    /// Takes this radius from the computed states of all rows.
    pub(super) fn know_largest_contact(&self, states: &[State]) {
        let rows = self.data.rows().iter().zip(states);
        let last = rows.max_by(|a, b| load_of(a.0).total_cmp(&load_of(b.0)));
        let radius = last.map(|(_, state)| state.contact_radius);
        if let Some(radius) = radius.filter(|radius| radius.is_finite()) {
            let radius = larger(radius, self.start.case.least_radius());
            self.scale_of_thickness.get_or_init(|| radius);
        }
    }

    /// Displacement of a row from that of the first row, m; 0 without displacements.
    pub(super) fn travel(&self, row: &Measurement) -> f64 {
        self.travel_to(load_of(row))
    }

    /// The same of any reading of the displacement.
    pub(super) fn travel_to(&self, reading: f64) -> f64 {
        match (self.data.position(), self.data.rows().first()) {
            (Position::Displacement, Some(first)) => reading - load_of(first),
            _ => 0.0,
        }
    }

    fn load_range(&self) -> f64 {
        let loads = self.data.rows().iter().map(load_of);
        let (low, high) = loads.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), load| {
            (low.min(load), high.max(load))
        });
        if high > low { high - low } else { 1e-6 }
    }

    /// Smallest force on unloading, N, minus the initial offset of the fit.
    pub(super) fn measured_pull(&self, settings: &Settings) -> Option<f64> {
        let rows = self.data.rows().iter().zip(&self.branches);
        let unloading = rows.filter(|(_, branch)| **branch == Branch::Unloading);
        let slope = settings.force_slope;
        let forces =
            unloading.filter_map(|(row, _)| Some(row.force?.value - slope * self.travel(row)));
        forces.reduce(f64::min)
    }

    /// Chooses the initial work of adhesion so that the pull-off force is that of the data.
    fn begin_with_work(&mut self) -> Result<(), FitError> {
        /// Relative difference of forces, largest number of trials, and a guess (J/m^2).
        const NEAR: f64 = 0.02;
        const TRIALS: usize = 8;
        const GUESS: f64 = 0.05;
        /// The pull-off force increases approximately with this power of the work.
        const POWER: f64 = 0.6;
        /// Smallest initial work, J/m^2.
        const LEAST: f64 = 1e-6;
        let works = [Key::WorkOfAdhesion, Key::RecedingWorkOfAdhesion];
        let free: Vec<Key> = works
            .into_iter()
            .filter(|key| self.free.contains(&Parameter::Key(*key)))
            .collect();
        // Separation requires the receding work.
        let Some(key) = free.last().copied() else {
            return Ok(());
        };
        let given = self.start.case.number(key).filter(|work| *work > 0.0);
        let parts_by_another =
            key == Key::WorkOfAdhesion && self.start.case.adhesion().work_receding.is_some();
        let pull = self
            .measured_pull(&self.start)
            .map(|force| force - self.start.force_offset);
        let (Some(pull), false) = (pull.filter(|pull| *pull < 0.0), parts_by_another) else {
            return match given {
                Some(_) => Ok(()),
                None => Err(FitError::NoStart {
                    name: self.data.name().to_owned(),
                    parameter: Parameter::Key(key),
                }),
            };
        };
        let least = match key {
            Key::RecedingWorkOfAdhesion => self.start.case.adhesion().work,
            _ => 0.0,
        };
        let mut work = given.unwrap_or(GUESS).max(least);
        for _ in 0..TRIALS {
            for key in &free {
                let missing = self.start.case.number(*key).is_none_or(|work| work <= 0.0);
                if *key == works[1] || free.len() == 1 || missing {
                    self.file.set_number(*key, work);
                }
            }
            self.start.case = Subject::of(&self.file)?;
            let pull_off = self
                .cycle(&self.start)?
                .and_then(|(_, cycle)| cycle.pull_off());
            let computed = pull_off.map_or(0.0, |[force, _]| force);
            let ratio = (pull / computed).clamp(0.01, 100.0);
            if within(ratio.ln().abs(), NEAR) {
                break;
            }
            work = (work * ratio.powf(1.0 / POWER)).max(least).max(LEAST);
        }
        Ok(())
    }

    /// Smallest and largest reading of the force, N.
    fn force_range(&self) -> [f64; 2] {
        let forces = self.data.rows().iter().filter_map(|row| row.force);
        forces.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], force| {
            [low.min(force.value), high.max(force.value)]
        })
    }

    /// Largest force without the initial offset, N; if there is none above it, the range of the readings. It is the unit of forces in the search.
    pub(super) fn largest_force(&self) -> f64 {
        let [low, high] = self.force_range();
        let sizes = [high - self.start.force_offset, high - low, 1e-6];
        let positive = |size: &f64| *size > 0.0 && size.is_finite();
        sizes.into_iter().find(positive).unwrap_or(1e-6)
    }

    /// Begins with the mean force of the rows before contact, if the given offset is far from it: a search that begins so far away does not end. These
    /// rows are the tenth with the smallest positions, on loading if there is any.
    fn begin_at_rest(&mut self) {
        /// Distance that a search covers, as a fraction of the range of the forces.
        const FAR: f64 = 0.5;
        /// Fraction of the rows, and the least number of them.
        const ROWS: f64 = 0.1;
        const LEAST: usize = 3;
        let [loading, unloading] = &self.orders;
        let order = if loading.is_empty() {
            unloading
        } else {
            loading
        };
        let forces: Vec<f64> = order
            .iter()
            .map(|row| &self.data.rows()[*row])
            .filter(|row| row.position.is_some())
            .filter_map(|row| Some(row.force?.value))
            .collect();
        let count = ((ROWS * forces.len() as f64) as usize).max(LEAST);
        let Some(first) = forces.get(..count) else {
            return;
        };
        let rest = first.iter().sum::<f64>() / count as f64;
        let [low, high] = self.force_range();
        // Forces that are all the same contain no rest.
        if high > low && (rest - self.start.force_offset).abs() > FAR * (high - low) {
            self.start.force_offset = rest;
        }
    }

    /// Contact point for the case as in its file, estimated from the state nearest to a tenth of
    /// the largest force, where an error of the modulus has little effect.
    fn likely_contact_point(&self) -> Result<f64, FitError> {
        let wanted = 0.1 * self.largest_force();
        let rows = self.data.rows().iter().zip(&self.branches);
        let is_cycle = self.is_adhesive || self.is_viscoelastic;
        let rows = rows.filter(|(_, branch)| !is_cycle || **branch == Branch::Loading);
        let offset = self.start.force_offset;
        // Viscoelastic bodies are stiffer the earlier they are loaded.
        let begin = self.data.rows().first().and_then(|row| row.time);
        let stiffer = |row: &Measurement| match (&self.start.relaxation, row.time, begin) {
            (Some(relaxation), Some(time), Some(begin)) => relaxation.at(time - begin),
            _ => 1.0,
        };
        let loaded = rows.filter_map(|(row, _)| {
            Some((
                row.position?.value,
                (row.force?.value - offset) / stiffer(row),
            ))
        });
        let away = |force: f64| (force / wanted).ln().abs();
        let nearest = loaded
            .filter(|(_, force)| *force > 0.0)
            .min_by(|a, b| away(a.1).total_cmp(&away(b.1)));
        let positions = self.data.rows().iter().filter_map(|row| row.position);
        let smallest = positions.map(|p| p.value).fold(f64::INFINITY, f64::min);
        let Some((position, force)) = nearest else {
            return Ok(smallest);
        };
        let indentation = if self.is_map() {
            // Up to the largest force, so that the curve need not be extended.
            let largest = larger(force, self.largest_force());
            self.curve(&self.start.case, Reach::Force(largest))?;
            self.state_of_map(&self.start, MeasuredBy::Force, force)?
                .indentation
        } else {
            match self
                .solve(&self.start.case, Load::Force(force))
                .map_err(FitError::from)
            {
                Ok(state) => state.indentation,
                // Bodies much softer than the measured ones have no contact under this force.
                Err(error) if error.is_out_of_reach() => return Ok(smallest),
                Err(error) => return Err(error),
            }
        };
        Ok(position - self.start.machine_compliance * force - indentation)
    }

    /// Moves the initial contact point by quarters of the range of the data until most rows can be modelled: an unknown force offset may have led to a much
    /// too large estimate.
    fn begin_within_model(&mut self) -> Result<(), FitError> {
        const STEPS: usize = 3;
        /// Required fraction of the rows.
        const MOST: f64 = 0.75;
        let mut rows: Vec<_> = self.data.rows().iter().zip(&self.moments).collect();
        rows.sort_by(|a, b| load_of(a.0).total_cmp(&load_of(b.0)));
        let last = (MOST * rows.len() as f64) as usize;
        let Some((row, moment)) = rows.get(last).filter(|_| !self.is_adhesive) else {
            return Ok(());
        };
        let mut settings = self.start.clone();
        for _ in 0..STEPS {
            if self.row_state(&settings, row, **moment)?.problem.is_none() {
                break;
            }
            settings.contact_point += 0.25 * self.load_range();
        }
        self.start.contact_point = settings.contact_point;
        Ok(())
    }

    /// Initial value of a parameter, in SI units.
    fn start_of(&self, parameter: Parameter) -> Result<f64, FitError> {
        match parameter {
            Parameter::Key(key) => {
                let number = self.start.case.number(key);
                number.ok_or(FitError::NotGiven(parameter))
            }
            Parameter::ContactPoint => Ok(self.start.contact_point),
            Parameter::MachineCompliance => Ok(self.start.machine_compliance),
            Parameter::ForceOffset => Ok(self.start.force_offset),
            Parameter::DisplacementDrift => Ok(self.start.displacement_drift),
            Parameter::ForceDrift => Ok(self.start.force_drift),
            Parameter::ForceSlope => Ok(self.start.force_slope),
            Parameter::RelaxationStrength(_) | Parameter::RelaxationTime(_) => {
                let given = parameter.of_relaxation(&self.file)?;
                given.ok_or(FitError::NotGiven(parameter))
            }
        }
    }

    /// Initial unknowns.
    pub(super) fn start(&self) -> Result<Vec<f64>, FitError> {
        let unknowns = self.free.iter().zip(&self.scales);
        let unknowns = unknowns.map(|(parameter, scale)| match scale {
            Scale::Logarithm(_) | Scale::Inverse(_) => Ok(0.0),
            Scale::Multiple(unit) => Ok(self.start_of(*parameter)? / unit),
            Scale::FromZero(unit) => Ok(unknown_of(self.start_of(*parameter)? / unit)),
            // With the lens axis on a pillar, derivatives with respect to its position vanish: the
            // fit starts beside the pillar.
            Scale::Distance => {
                let value = self.start_of(*parameter)?;
                Ok(if value.abs() < 0.05 { 0.25 } else { value })
            }
        });
        unknowns.collect()
    }

    /// The value of a parameter, in SI units.
    pub(super) fn value(&self, number: usize, unknown: f64) -> f64 {
        match self.scales[number] {
            Scale::Multiple(unit) => unit * unknown,
            Scale::Distance => unknown.abs(),
            Scale::Logarithm(unit) => unit * unknown.exp(),
            Scale::FromZero(unit) if unknown < LINEAR => {
                unit * LINEAR.exp() * larger(unknown - ZERO, 0.0)
            }
            Scale::FromZero(unit) => unit * unknown.exp(),
            Scale::Inverse(unit) => unit / larger(unknown, 0.0),
        }
    }

    /// Index of a key among the free parameters.
    fn place(&self, key: Key) -> Option<usize> {
        let mut free = self.free.iter();
        free.position(|free| *free == Parameter::Key(key))
    }

    /// Range of an unknown for given values of the others: works of adhesion are not negative, and the receding work is not smaller than the other.
    pub(super) fn range(&self, number: usize, unknowns: &[f64]) -> [f64; 2] {
        /// Tolerance for rounding when works are compared.
        const ROUNDING: f64 = 1e-12;
        let Scale::FromZero(unit) = self.scales[number] else {
            return [f64::NEG_INFINITY, f64::INFINITY];
        };
        let adhesion = self.start.case.adhesion();
        let other = |key: Key, given: Option<f64>| match self.place(key) {
            Some(place) => Some(unknowns[place]),
            None => Some(unknown_of(given? / unit)),
        };
        if self.free[number] == Parameter::Key(Key::WorkOfAdhesion) {
            let most =
                other(Key::RecedingWorkOfAdhesion, adhesion.work_receding).unwrap_or(f64::INFINITY);
            [ZERO, most - ROUNDING]
        } else {
            let least =
                other(Key::WorkOfAdhesion, Some(adhesion.work)).filter(|least| *least > ZERO);
            [least.map_or(ZERO, |least| least + ROUNDING), f64::INFINITY]
        }
    }

    /// Unknowns after a step; unknowns that would leave their range are set to its bound.
    pub(super) fn moved(&self, unknowns: &[f64], step: &[f64]) -> Vec<f64> {
        let pairs = unknowns.iter().zip(step);
        let mut moved: Vec<f64> = pairs.map(|(unknown, step)| unknown + step).collect();
        for number in 0..moved.len() {
            let [least, greatest] = self.range(number, &moved);
            moved[number] = clamped(moved[number], least, greatest.max(least));
        }
        moved
    }

    /// The first bound at which unknowns are and which a step would violate.
    pub(super) fn left_by(&self, unknowns: &[f64], step: &[f64]) -> Option<RangeEnd> {
        /// Distance below which an unknown is at a bound.
        const NEAR: f64 = 1e-9;
        let both = self.place(Key::WorkOfAdhesion);
        let both = both.zip(self.place(Key::RecedingWorkOfAdhesion));
        let equal = both.filter(|(work, receding)| {
            unknowns[*receding] <= unknowns[*work] + NEAR && step[*receding] < step[*work]
        });
        let at_end = |number: &usize| {
            let [least, greatest] = self.range(*number, unknowns);
            let unknown = unknowns[*number];
            // A bound set by the other work is not a separate bound.
            let least = if both.is_some() { ZERO } else { least };
            step[*number] < 0.0 && unknown <= least + NEAR
                || both.is_none() && step[*number] > 0.0 && unknown >= greatest - NEAR
        };
        let works = |number: &usize| matches!(self.scales[*number], Scale::FromZero(_));
        let ended = (0..unknowns.len()).filter(works).find(at_end);
        ended
            .map(RangeEnd::Of)
            .or(equal.map(|(work, receding)| RangeEnd::Equal([work, receding])))
    }

    /// Another start: moduli and sizes differ by up to a factor of 3, contact point and machine compliance by up to a quarter of the range of the
    /// data. The starts are distributed evenly, by multiples of irrational numbers (H. Weyl, Math. Ann. 77, 313 (1916)), and are the same for all
    /// fits.
    pub(super) fn other_start(&self, begin: &[f64], number: usize) -> Vec<f64> {
        let places = begin.iter().zip(self.free).enumerate();
        places
            .map(|(place, (begin, parameter))| {
                const GOLDEN: f64 = 1.618_033_988_749_895;
                let step = 1.0 / GOLDEN + place as f64 * std::f64::consts::SQRT_2;
                let part = (number as f64 * step).fract();
                let reach = match parameter {
                    _ if parameter.is_positive() => 3f64.ln(),
                    _ => 0.25,
                };
                begin + reach * (2.0 * part - 1.0)
            })
            .collect()
    }

    pub(super) fn file(&self, unknowns: &[f64]) -> CaseFile {
        let mut file = self.file.clone();
        for (number, unknown) in unknowns.iter().enumerate() {
            if self.free[number].is_of_relaxation() {
                self.free[number].set(&mut file, self.value(number, *unknown));
            }
            if let Parameter::Key(key) = self.free[number] {
                let mut value = self.value(number, *unknown);
                if self.free[number].is_work() && value < Adhesion::SMALLEST_WORK {
                    value = 0.0;
                }
                // An infinite thickness means a half-space and is not set.
                if value.is_finite() || !self.free[number].is_thickness() {
                    file.set_number(key, value);
                }
            }
        }
        file
    }

    pub(super) fn settings(&self, unknowns: &[f64]) -> Result<Settings, FitError> {
        let file = self.file(unknowns);
        let mut settings = Settings {
            case: Subject::of(&file)?,
            relaxation: match &self.start.relaxation {
                Some(_) => relaxation_over_time(&file, self.data)?,
                None => None,
            },
            ..self.start.clone()
        };
        for (number, unknown) in unknowns.iter().enumerate() {
            match self.free[number] {
                Parameter::ContactPoint => settings.contact_point = self.value(number, *unknown),
                Parameter::MachineCompliance => {
                    settings.machine_compliance = self.value(number, *unknown);
                }
                Parameter::ForceOffset => settings.force_offset = self.value(number, *unknown),
                Parameter::DisplacementDrift => {
                    settings.displacement_drift = self.value(number, *unknown);
                }
                Parameter::ForceDrift => settings.force_drift = self.value(number, *unknown),
                Parameter::ForceSlope => settings.force_slope = self.value(number, *unknown),
                Parameter::Key(_)
                | Parameter::RelaxationStrength(_)
                | Parameter::RelaxationTime(_) => {}
            }
        }
        Ok(settings)
    }

    /// Computed states that correspond to the measured ones. With adhesion they are averages over intervals of the curve,
    /// of at least the given fraction of the range of the loads.
    pub(super) fn states(&self, unknowns: &[f64], stretch: f64) -> Result<Vec<State>, FitError> {
        let settings = self.settings(unknowns)?;
        if let Some(relaxation) = &settings.relaxation {
            return self.states_over_time(&settings, relaxation);
        }
        if let Subject::Flat(case) = &settings.case {
            return self.states_on_flat(case, &settings);
        }
        if self.uses_curve() {
            return self.states_on_curve(&settings);
        }
        if self.is_adhesive {
            return self.states_of_cycle(&settings, stretch * self.load_range());
        }
        self.for_each_row(|number, row| {
            let moment = self.moments[number];
            let state = self.row_state(&settings, row, moment)?;
            Ok(State {
                read_force: state.force + settings.base_line(moment, self.travel(row)),
                ..state
            })
        })
    }

    /// The loads of all rows over time, without the contributions of the instrument, and what they are.
    fn history(&self, settings: &Settings) -> History {
        let position = self.data.position();
        let by = match position {
            Position::None => MeasuredBy::Force,
            _ => MeasuredBy::Position {
                compliance: settings.compliance(position),
            },
        };
        let rows = self.data.rows().iter().zip(&self.moments);
        let loads = rows.map(|(row, moment)| MeasuredLoad {
            time: row.time.unwrap_or(0.0),
            load: settings.load(position, load_of(row), *moment),
        });
        let loads: Vec<MeasuredLoad> = loads.collect();
        History {
            by,
            largest: loads
                .iter()
                .map(|load| load.load)
                .fold(f64::NEG_INFINITY, larger),
            loads,
        }
    }

    /// The elastic curve for a history; `None` if it contains no load.
    fn curve_over_time(
        &self,
        settings: &Settings,
        &History { by, largest, .. }: &History,
    ) -> Result<Option<CaseCurve>, FitError> {
        let touch = match by {
            MeasuredBy::Force => 0.0,
            MeasuredBy::Position { .. } => settings.case.first_touch(),
        };
        if largest <= touch {
            return Ok(None);
        }
        let reach = match by {
            MeasuredBy::Force => Reach::Force(largest),
            // A negative compliance moves the lens further than it was measured.
            MeasuredBy::Position { compliance } => {
                Reach::Indentation(largest + larger(-compliance, 0.0) * self.largest_force())
            }
        };
        Ok(Some(self.curve(&settings.case, reach)?))
    }

    fn curve(&self, case: &Subject, reach: Reach) -> Result<CaseCurve, FitError> {
        let run = if self.is_map() {
            &self.whole
        } else {
            &self.single
        };
        self.curves.of(case, reach, run, &self.solved)
    }

    /// The states of viscoelastic bodies: those of the whole history of the measured loads.
    fn states_over_time(
        &self,
        settings: &Settings,
        relaxation: &Relaxation,
    ) -> Result<Vec<State>, FitError> {
        /// Relative step of the level of the contact for its stiffness.
        const STEP: f64 = 1e-3;
        let measured = self.history(settings);
        let without = |load: &MeasuredLoad| State::without_contact(load.load);
        let Some(curve) = self.curve_over_time(settings, &measured)? else {
            return Ok(measured.loads.iter().map(without).collect());
        };
        let History { by, loads, largest } = measured;
        let elastic = &curve.elastic;
        let history = measured_history(elastic, relaxation, by, &loads);
        let history = history.ok_or(FitError::NoBalance {
            compliance: match by {
                MeasuredBy::Force => 0.0,
                MeasuredBy::Position { compliance } => compliance,
            },
            reading: largest + settings.contact_point,
        })?;
        let rows = self.data.rows().iter().zip(&self.moments).zip(&history);
        let states = rows.map(|((row, moment), state)| {
            let level = state.contact_indentation;
            let depth = level - elastic.first_touch();
            let radius = |level| elastic.contact_radius_at(level).unwrap_or(0.0);
            let slope = |of: &dyn Fn(f64) -> f64| {
                let [below, above] = [-STEP, STEP].map(|step| of(level + step * depth));
                if depth > 0.0 {
                    (above - below) / (2.0 * STEP * depth)
                } else {
                    0.0
                }
            };
            // Of a fast change of the load.
            let stiffness =
                relaxation.instantaneous() * slope(&|level: f64| elastic.force_at(level));
            let of_radius = slope(&radius);
            let slopes = match by {
                MeasuredBy::Force if stiffness > 0.0 => [0.0, of_radius / stiffness],
                MeasuredBy::Force => [0.0; 2],
                MeasuredBy::Position { compliance } => {
                    [stiffness, of_radius].map(|slope| slope / (1.0 + compliance * stiffness))
                }
            };
            State {
                force: state.force,
                read_force: state.force + settings.base_line(*moment, self.travel(row)),
                slopes,
                contact_radius: radius(level),
                smooth_radius: radius(level),
                past_transition: curve.through_floor.is_some_and(|floor| level > floor),
                converged: curve.converged,
                ..State::without_contact(state.indentation)
            }
        });
        Ok(states.collect())
    }

    /// The elastic states on one curve, also on unloading. Contacts that merge within the measured loads are an error.
    fn states_on_curve(&self, settings: &Settings) -> Result<Vec<State>, FitError> {
        let measured = self.history(settings);
        let Some(curve) = self.curve_over_time(settings, &measured)? else {
            let without = |load: &MeasuredLoad| State::without_contact(load.load);
            return Ok(measured.loads.iter().map(without).collect());
        };
        let rows = self.data.rows().iter().zip(&self.moments);
        let state = |((row, moment), load): ((&Measurement, &f64), &MeasuredLoad)| {
            let state = state_on(&curve, measured.by, load.load)?;
            Ok(State {
                read_force: state.force + settings.base_line(*moment, self.travel(row)),
                ..state
            })
        };
        rows.zip(&measured.loads).map(state).collect()
    }

    /// State of a height map under a load without the contributions of the instrument: on its curve, since a contact takes seconds.
    fn state_of_map(
        &self,
        settings: &Settings,
        by: MeasuredBy,
        load: f64,
    ) -> Result<State, FitError> {
        let reach = match by {
            MeasuredBy::Force => Reach::Force(larger(load, 0.0)),
            MeasuredBy::Position { compliance } => {
                Reach::Indentation(load + larger(-compliance, 0.0) * self.largest_force())
            }
        };
        state_on(&self.curve(&settings.case, reach)?, by, load)
    }

    /// Estimated relative error of the forces of viscoelastic bodies, on rounded tops and on height maps, due to the interpolation of the elastic curve and to
    /// its contacts; NaN if that of a height map is unknown.
    pub(super) fn error_over_time(&self, settings: &Settings) -> Result<f64, FitError> {
        let curve = self.curve_over_time(settings, &self.history(settings))?;
        Ok(curve.map_or(0.0, |curve| {
            // Of rounded tops without an estimate, that of the interpolation is given.
            let is_known = curve.has_errors || !self.is_map();
            if is_known {
                curve.elastic.error()
            } else {
                f64::NAN
            }
        }))
    }

    /// Whether the model has no state for any row, and the first reason.
    pub(super) fn first_problem(&self, unknowns: &[f64]) -> Result<(), FitError> {
        let settings = self.settings(unknowns)?;
        let mut rows = self.data.rows().iter().zip(&self.moments);
        rows.try_for_each(|(row, moment)| {
            let place = || format!("{}:{}", self.data.name(), row.line);
            let state = self.state(&settings, row, *moment);
            state.map(drop).map_err(|error| error.within(&place()))
        })
    }

    /// The cycle up to the largest measured load, with its curve; `None` if that load is before contact.
    pub(super) fn cycle(
        &self,
        settings: &Settings,
    ) -> Result<Option<(Curve, FittedCycle)>, FitError> {
        let position = self.data.position();
        let largest = self.largest_load(settings);
        let touch = match position {
            Position::None => 0.0,
            _ => settings.case.first_touch(),
        };
        if largest <= touch {
            return Ok(None);
        }
        let compliance = settings.compliance(self.data.position());
        let solve =
            |turn: UnloadingPoint, drive: LoadingMode, retract: bool| -> Result<_, SolveError> {
                let plan = CyclePlan {
                    turn,
                    drive,
                    retract,
                };
                self.solved.fetch_add(1, Ordering::Relaxed);
                let cycle = settings.case.cycle(plan, &self.single)?;
                Ok((Curve::new(&cycle, compliance), cycle))
            };
        let retract = self.branches.contains(&Branch::Unloading);
        let solved = match position {
            Position::None => solve(UnloadingPoint::Force(largest), LoadingMode::Force, retract),
            _ if compliance == 0.0 => solve(
                UnloadingPoint::Indentation(largest),
                LoadingMode::Displacement,
                retract,
            ),
            _ => {
                let drive = if compliance > 0.0 {
                    LoadingMode::Machine(1.0 / compliance)
                } else {
                    LoadingMode::Displacement
                };
                // The lens moves less than the crosshead because of the machine compliance. The unloading point is
                // therefore on the curve of a loading to that crosshead position.
                let far = largest + (-compliance).max(0.0) * 2.0 * self.largest_force();
                let (loading, _) = solve(UnloadingPoint::Indentation(far), drive, false)?;
                let turn = loading.at(Branch::Loading, largest).indentation;
                solve(UnloadingPoint::Indentation(turn), drive, retract)
            }
        };
        Ok(Some(solved?))
    }

    /// Largest load in the measurements, minus the contributions of the instrument.
    fn largest_load(&self, settings: &Settings) -> f64 {
        let rows = self.data.rows().iter().zip(&self.moments);
        let position = self.data.position();
        let loads = rows.map(|(row, moment)| settings.load(position, load_of(row), *moment));
        let largest = loads.fold(f64::NEG_INFINITY, f64::max);
        match self.data.unloading_point() {
            Some(turn) => {
                largest.max(settings.load(position, turn, self.moment_of_unloading_point()))
            }
            None => largest,
        }
    }

    /// The line of the first row if the data contain no loading, so that the unloading is assumed to begin there; `None` without adhesion.
    pub(super) fn assumed_unloading_point(&self) -> Option<u64> {
        let is_loading = |branch: &&Branch| **branch == Branch::Loading;
        let is_alone =
            self.branches.len() > 2 && self.branches.iter().filter(is_loading).count() < 2;
        let is_assumed = self.is_adhesive && is_alone && self.data.unloading_point().is_none();
        let first = self.data.rows().first().filter(|_| is_assumed);
        first.map(|row| row.line)
    }

    /// The time of an unloading point that is not among the rows: that of the first row of the unloading.
    fn moment_of_unloading_point(&self) -> f64 {
        let rows = self.branches.iter().zip(&self.moments);
        let mut unloading = rows.filter(|(branch, _)| **branch == Branch::Unloading);
        unloading.next().map_or(1.0, |(_, moment)| *moment)
    }

    /// The states on a flat surface. Its curve has no jumps but those of touching and detaching, and the data show [on which side of them](attached) a
    /// row is: the attached ones are on the branch of the attached lens, which is continued at its end.
    fn states_on_flat(&self, case: &FlatCase, settings: &Settings) -> Result<Vec<State>, FitError> {
        /// Relative step of the load for slopes.
        const STEP: f64 = 1e-3;
        /// Up to this number of rows, every contact is solved.
        const SOLVED: usize = 64;
        let position = self.data.position();
        let compliance = settings.compliance(self.data.position());
        let mode = match position {
            Position::None => LoadingMode::Force,
            _ if compliance == 0.0 => LoadingMode::Displacement,
            _ => LoadingMode::Machine(compliance.recip()),
        };
        let mut system = case.system.clone();
        if self.is_adhesive {
            let adhesion = some(system.adhesion());
            system = system.with_adhesion(adhesion).map_err(SolveError::from)?;
        }
        let largest = self.largest_load(settings);
        let mut branches = system.branches(mode, largest, &self.single)?;
        if self.data.rows().len() > SOLVED {
            branches = branches.interpolated();
        }
        self.solved.fetch_add(1, Ordering::Relaxed);
        let needs_slopes = {
            let mut rows = self.data.rows().iter();
            rows.any(|row| {
                row.position
                    .or(row.force)
                    .is_some_and(|load| load.error.is_some())
            })
        };
        let step_at = |number: usize, load: f64| {
            let branch = self.branches[number];
            match self.attached[number] {
                Some(true) if self.is_adhesive => branches.attached(branch, load),
                Some(false) if self.is_adhesive => Ok(branches.apart(branch, load)),
                _ => branches.at(branch, load),
            }
        };
        let state = |(number, row): (usize, &Measurement)| {
            let moment = self.moments[number];
            let load = settings.load(position, load_of(row), moment);
            let step = match step_at(number, load).map_err(FitError::Solve) {
                Ok(step) => step,
                Err(error) if error.is_out_of_reach() => {
                    return Ok(State {
                        problem: Some(error.to_string()),
                        ..State::without_contact(f64::NAN)
                    });
                }
                Err(error) => return Err(error),
            };
            let mut slopes = [0.0; 2];
            if needs_slopes {
                let reach = STEP * largest.abs();
                let [below, above] = [-reach, reach].map(|step| step_at(number, load + step));
                if let (Ok(below), Ok(above)) = (below, above) {
                    slopes = [
                        (above.force - below.force) / (2.0 * reach),
                        (above.contact_radius - below.contact_radius) / (2.0 * reach),
                    ];
                }
            }
            Ok(State {
                force: step.force,
                read_force: step.force + settings.base_line(moment, self.travel(row)),
                slopes,
                contact_radius: step.contact_radius,
                smooth_radius: step.contact_radius,
                ..State::without_contact(step.indentation)
            })
        };
        self.data.rows().iter().enumerate().map(state).collect()
    }

    fn states_of_cycle(
        &self,
        settings: &Settings,
        least_stretch: f64,
    ) -> Result<Vec<State>, FitError> {
        /// Relative distance from the end of the loading that is attributed to rounding.
        const ROUNDING: f64 = 1e-6;
        let cycle = self.cycle(settings)?;
        let nothing = Curve::nothing();
        let curve = cycle.as_ref().map_or(&nothing, |(curve, _)| curve);
        let cycle = cycle.as_ref().map(|(_, cycle)| cycle);
        let end = cycle
            .and(curve.turn())
            .map_or(f64::INFINITY, |turn| turn.position);
        let deepest = cycle.and_then(FittedCycle::critical_indentation);
        let deepest = deepest.unwrap_or(f64::INFINITY);
        let state = |(number, row): (usize, &Measurement)| {
            let branch = self.branches[number];
            let moment = self.moments[number];
            let position = settings.load(self.data.position(), load_of(row), moment);
            let place = curve.at(branch, position);
            let stretch = self.stretches[number].max(least_stretch);
            let average = curve.average(branch, position, stretch);
            // On loading the force has kinks but hardly any jumps.
            let (force, force_variance) = match branch {
                Branch::Loading => (place.force, 0.0),
                Branch::Unloading => (average.force, average.force_variance),
            };
            let is_beyond = |value: f64, end: f64| value > end * (1.0 + ROUNDING);
            State {
                indentation: place.indentation,
                force: place.force,
                read_force: force + settings.base_line(moment, self.travel(row)),
                force_variance,
                sharing: larger(2.0 * stretch / self.stretches[number], 1.0)
                    .min(self.branches.len() as f64),
                slopes: [average.force_slope, average.radius_slope],
                contact_radius: place.contact_radius,
                smooth_radius: average.contact_radius,
                smallest_floor_gap: None,
                past_transition: is_beyond(position, end) || is_beyond(place.indentation, deepest),
                converged: cycle.is_none_or(FittedCycle::converged),
                problem: None,
            }
        };
        let mut states: Vec<State> = self.data.rows().iter().enumerate().map(state).collect();
        for order in &self.orders {
            self.share_variances(order, &mut states);
        }
        Ok(states)
    }

    /// Assigns the mean variance of the neighbouring rows to every row of a branch, because it is not known which of them
    /// contains the jump.
    fn share_variances(&self, order: &[usize], states: &mut [State]) {
        let rows = self.data.rows();
        let loads: Vec<f64> = order.iter().map(|number| load_of(&rows[*number])).collect();
        let mut sums = vec![0.0];
        for number in order {
            sums.push(sums[sums.len() - 1] + states[*number].force_variance);
        }
        let reach = AROUND * self.load_range();
        for (number, load) in order.iter().zip(&loads) {
            let first = loads.partition_point(|other| *other < load - reach);
            let end = loads.partition_point(|other| *other <= load + reach);
            let sum = larger(sums[end] - sums[first], 0.0);
            states[*number].force_variance = sum / (end - first) as f64;
        }
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

    /// State of a row; it contains a problem if it is outside the model.
    fn row_state(
        &self,
        settings: &Settings,
        row: &Measurement,
        moment: f64,
    ) -> Result<State, FitError> {
        match self.state(settings, row, moment) {
            Err(error) if error.is_out_of_reach() => Ok(State {
                problem: Some(error.to_string()),
                ..State::without_contact(f64::NAN)
            }),
            answer => answer,
        }
    }

    fn state(
        &self,
        settings: &Settings,
        row: &Measurement,
        moment: f64,
    ) -> Result<State, FitError> {
        match (row.position, row.force) {
            (Some(position), force) => {
                let base_line = settings.base_line(moment, self.travel(row));
                let guess = force.map_or(0.0, |force| force.value - base_line);
                self.state_at(settings, position.value, moment, guess)
            }
            (None, force) => {
                let reading = force.map_or(0.0, |force| force.value);
                self.state_under(settings, reading, moment)
            }
        }
    }

    /// State under a force that was read at a time.
    pub(super) fn state_under(
        &self,
        settings: &Settings,
        reading: f64,
        moment: f64,
    ) -> Result<State, FitError> {
        let force = settings.load(Position::None, reading, moment);
        if self.is_map() {
            return self.state_of_map(settings, MeasuredBy::Force, force);
        }
        Ok(self.solve(&settings.case, Load::Force(force.max(0.0)))?)
    }

    /// State at a reading: solves `zeta + machine_compliance F(zeta) = reading - contact_point -
    /// drift` for the indentation `zeta` by the secant method.
    pub(super) fn state_at(
        &self,
        settings: &Settings,
        reading: f64,
        moment: f64,
        likely_force: f64,
    ) -> Result<State, FitError> {
        let position = self.data.position();
        let target = settings.load(position, reading, moment);
        let compliance = settings.compliance(self.data.position());
        if self.is_map() {
            return self.state_of_map(settings, MeasuredBy::Position { compliance }, target);
        }
        let solve = |zeta: f64| self.solve(&settings.case, Load::Indentation(zeta));
        let touch = settings.case.first_touch();
        let depth = target - touch;
        if compliance == 0.0 || depth <= 0.0 {
            return Ok(solve(target)?);
        }
        let excess = |state: &State| state.indentation + compliance * state.force - target;
        let met = |state: &State| within(excess(state).abs(), BALANCE * depth);
        let mut last = solve(clamped(
            target - compliance * likely_force,
            touch + 0.1 * depth,
            target,
        ))?;
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

    pub(super) fn solve(&self, case: &Subject, load: Load) -> Result<State, SolveError> {
        if let Load::Indentation(zeta) = load
            && zeta <= case.first_touch()
        {
            return Ok(State {
                smallest_floor_gap: case.gap_before_contact(zeta),
                ..State::without_contact(zeta)
            });
        }
        match case {
            Subject::Pillars(case) => {
                let contact = self.contact(case, load)?;
                Ok(State {
                    force: contact.force,
                    read_force: contact.force,
                    contact_radius: contact.contact_radius,
                    smooth_radius: smooth_radius(&contact),
                    smallest_floor_gap: Some(contact.smallest_floor_gap),
                    past_transition: contact.smallest_floor_gap < 0.0,
                    converged: self.is_known(&contact),
                    ..State::without_contact(contact.indentation)
                })
            }
            Subject::Asperities(tops) => {
                self.solved.fetch_add(1, Ordering::Relaxed);
                let contact = Loadable::press(&tops.case, load, &self.single)?;
                let radius = contact.contact_radius.unwrap_or(0.0);
                Ok(State {
                    force: contact.force,
                    read_force: contact.force,
                    contact_radius: radius,
                    smooth_radius: radius,
                    converged: contact.is_answer(),
                    ..State::without_contact(contact.indentation)
                })
            }
            // Its states are on its curve.
            Subject::HeightMap(_) => Ok(State::without_contact(f64::NAN)),
            Subject::Flat(case) => {
                self.solved.fetch_add(1, Ordering::Relaxed);
                let contact = case.system.press(load, &self.single)?;
                Ok(State {
                    force: contact.force,
                    read_force: contact.force,
                    contact_radius: contact.contact_radius,
                    smooth_radius: contact.contact_radius,
                    converged: contact.is_answer(),
                    ..State::without_contact(contact.indentation)
                })
            }
        }
    }

    /// Whether a contact is solved, and its force known well enough for a row. The first force on the floor may have no digit, as only the whole force is
    /// compared; nor the force of a row close to the first contact, if its error is small beside the measured forces.
    pub(super) fn is_known(&self, contact: &ContactState) -> bool {
        /// Fraction of the largest measured force.
        const NEGLIGIBLE: f64 = 1e-4;
        let error = contact.error.force;
        let is_small =
            contact.force > 0.0 && within(error * contact.force, NEGLIGIBLE * self.largest_force());
        contact.is_answer() || contact.converged() && (within(error, LARGEST_ERROR) || is_small)
    }

    pub(super) fn contact(&self, case: &Case, load: Load) -> Result<ContactState, SolveError> {
        self.solved.fetch_add(1, Ordering::Relaxed);
        fakir::press(&case.system, load, case.method, &self.single)
    }

    /// Limits of the model at an indentation, m.
    pub(super) fn limits(
        &self,
        settings: &Settings,
        indentation: f64,
    ) -> Result<Vec<Limit>, FitError> {
        self.solved.fetch_add(1, Ordering::Relaxed);
        settings
            .case
            .limits(Load::Indentation(indentation), &self.single)
    }

    /// Derivatives at fixed indentation, and from these at fixed reading: with `F' = dF/dzeta` and `C` the machine compliance, `dzeta =
    /// (d(reading) - d(contact_point) - d(drift) - F dC - C dF|_zeta)/(1 + C F')`. The derivatives of the force are exact if the contact has a
    /// [gradient](fakir::gradient), otherwise central differences.
    pub(super) fn derivatives(
        &self,
        unknowns: &[f64],
        states: &[State],
        stretch: f64,
    ) -> Result<Vec<Derivatives>, FitError> {
        let settings = self.settings(unknowns)?;
        let pillars = match &settings.case {
            Subject::Pillars(case) if !self.is_adhesive && !self.is_viscoelastic => case,
            _ => return self.derivatives_of_cycle(unknowns, states, stretch),
        };
        let by_key = ByKey::new(&self.file(unknowns), pillars)?;
        let cases = self.sides(unknowns);
        self.for_each_row(|row_number, row| {
            let state = &states[row_number];
            if state.problem.is_some() {
                return Ok(Derivatives::none(self.free.len()));
            }
            let load = match row.position {
                Some(_) => Load::Indentation(state.indentation),
                None => Load::Force(state.force),
            };
            let gradient = self.gradient(pillars, load, false)?;
            let along = match &gradient {
                Some(gradient) => self.with_radius(gradient.stiffness, || {
                    self.along_load(&settings.case, load, state)
                })?,
                None => self.along_load(&settings.case, load, state)?,
            };
            let mut held = vec![[0.0; 2]; self.free.len()];
            for (number, parameter) in self.free.iter().enumerate() {
                let (Parameter::Key(key), Some(sides)) = (parameter, &cases[number]) else {
                    continue;
                };
                let exact = gradient
                    .as_ref()
                    .and_then(|gradient| by_key.exactly(gradient.force.as_ref()?, *key));
                let differences = || self.between(sides, load, state);
                held[number] = match exact {
                    Some(slope) => {
                        let unit = self.slope(number, unknowns[number]);
                        self.with_radius(slope * unit, differences)?
                    }
                    None => differences()?,
                };
            }
            Ok(self.at_reading(&settings, unknowns, row_number, state, along, &held))
        })
    }

    /// For every unknown that belongs to the case, the cases on both sides.
    pub(super) fn sides(&self, unknowns: &[f64]) -> Vec<Option<Sides>> {
        let of = |(number, parameter): (usize, &Parameter)| {
            let side = |step: f64| -> Option<(Subject, f64)> {
                let mut moved = unknowns.to_vec();
                moved[number] += step;
                // There is no body thicker than the half-space.
                let is_beyond = matches!(self.scales[number], Scale::Inverse(_)) && step < 0.0;
                let settings = self.settings(&moved).ok().filter(|_| !is_beyond);
                settings.map(|settings| (settings.case, step.abs()))
            };
            match parameter {
                Parameter::Key(_) => Some([side(-DIFFERENCE), side(DIFFERENCE)]),
                _ => None,
            }
        };
        self.free.iter().enumerate().map(of).collect()
    }

    /// Derivatives at a fixed reading, from those of force and smooth contact radius along the load and, under a fixed load, with respect to
    /// the unknowns of the case.
    pub(super) fn at_reading(
        &self,
        settings: &Settings,
        unknowns: &[f64],
        row_number: usize,
        state: &State,
        along: [f64; 2],
        held: &[[f64; 2]],
    ) -> Derivatives {
        let row = &self.data.rows()[row_number];
        let moment = self.moments[row_number];
        let mut all = Derivatives::default();
        let compliance = match (row.position, self.data.position()) {
            (Some(_), Position::Displacement) => settings.machine_compliance,
            _ => 0.0,
        };
        // Derivative of the indentation with respect to the position.
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
            let unit = self.slope(number, unknowns[number]);
            let ([force, radius], moved) = match parameter {
                Parameter::Key(_) => {
                    let held = held[number];
                    (held, -compliance * held[0] * follow)
                }
                Parameter::ContactPoint => ([0.0; 2], -unit * follow),
                Parameter::DisplacementDrift => ([0.0; 2], -unit * moment * follow),
                Parameter::ForceOffset => ([unit, -unit * all.radius_by_force], 0.0),
                Parameter::ForceDrift => {
                    let unit = unit * moment;
                    ([unit, -unit * all.radius_by_force], 0.0)
                }
                Parameter::ForceSlope => ([unit * self.travel(row), 0.0], 0.0),
                Parameter::MachineCompliance => ([0.0; 2], -unit * state.force * follow),
                // Only states over time depend on them, whose derivatives are differences.
                Parameter::RelaxationStrength(_) | Parameter::RelaxationTime(_) => ([0.0; 2], 0.0),
            };
            all.force.push(force + along[0] * moved);
            all.contact_radius.push(radius + along[1] * moved);
        }
        all
    }

    /// Derivative of a value with respect to its unknown.
    pub(super) fn slope(&self, number: usize, unknown: f64) -> f64 {
        match self.scales[number] {
            Scale::Multiple(unit) => unit,
            Scale::Distance => 1.0,
            Scale::Logarithm(_) => self.value(number, unknown),
            Scale::FromZero(unit) => unit * larger(unknown, LINEAR).exp(),
            Scale::Inverse(unit) => -self.value(number, unknown).powi(2) / unit,
        }
    }

    /// Exact derivatives of the force, if the contact has them: with respect to the free parameters, or to all.
    pub(super) fn gradient(
        &self,
        case: &Case,
        load: Load,
        wants_all: bool,
    ) -> Result<Option<Gradient>, SolveError> {
        let Load::Indentation(zeta) = load else {
            return Ok(None); // a force that is the load is not compared
        };
        if zeta <= 0.0 || !matches!(case.method, Method::Spectral(_)) {
            return Ok(None);
        }
        self.solved.fetch_add(1, Ordering::Relaxed);
        // Those that take as long as all others together.
        let slow = [Quantity::Pitch, Quantity::PillarDiameter];
        let scales = |free: &Parameter| {
            let keys = [Key::SurfaceFraction, Key::Pitch, Key::PillarDiameter];
            keys.into_iter().any(|key| *free == Parameter::Key(key))
        };
        let wanted = if wants_all || self.free.iter().any(scales) {
            &slow[..]
        } else {
            &[]
        };
        let of = (&case.system, load, case.method);
        match fakir::gradient_by(of.0, of.1, of.2, wanted, &self.single) {
            Ok(gradient) => Ok(Some(gradient)),
            Err(SolveError::Interrupted) => Err(SolveError::Interrupted),
            Err(_) => Ok(None),
        }
    }

    /// A derivative of the force and, if contact radii were measured, that of the contact radius by differences.
    fn with_radius(
        &self,
        force: f64,
        differences: impl FnOnce() -> Result<[f64; 2], SolveError>,
    ) -> Result<[f64; 2], SolveError> {
        let radius = if self.wants_radius {
            differences()?[1]
        } else {
            0.0
        };
        Ok([force, radius])
    }

    /// Derivatives by central differences of all states: of whole cycles, of histories of viscoelastic bodies, and on a flat surface.
    fn derivatives_of_cycle(
        &self,
        unknowns: &[f64],
        states: &[State],
        stretch: f64,
    ) -> Result<Vec<Derivatives>, FitError> {
        let side = |(number, sign): (usize, f64)| {
            let step = match self.scales[number] {
                _ if self.is_flat() && self.start.relaxation.is_none() => DIFFERENCE_ON_FLAT,
                Scale::FromZero(_) => DIFFERENCE_OF_WORK,
                _ if self.is_map() && self.free[number].is_size() => DIFFERENCE_ON_CELLS,
                _ => DIFFERENCE,
            };
            let mut moved = unknowns.to_vec();
            let [least, greatest] = self.range(number, unknowns);
            moved[number] = clamped(moved[number] + sign * step, least, greatest.max(least));
            // At a bound of its range or of the model, a one-sided difference is used.
            let apart = (moved[number] - unknowns[number]).abs();
            if apart < SHORTEST * step {
                return Ok((states.to_vec(), 0.0));
            }
            match self.states(&moved, stretch) {
                Ok(there) => Ok((there, apart)),
                Err(error) if error.is_interruption() => Err(error),
                Err(_) => Ok((states.to_vec(), 0.0)),
            }
        };
        let sides: Vec<(usize, f64)> = (0..unknowns.len())
            .flat_map(|number| [(number, -1.0), (number, 1.0)])
            .collect();
        let solved: Vec<_> = match self.pool {
            Some(pool) => pool.install(|| {
                sides
                    .into_par_iter()
                    .map(side)
                    .collect::<Result<_, FitError>>()
            }),
            None => sides.into_iter().map(side).collect(),
        }?;
        let of_row = |(number, state): (usize, &State)| {
            let by = |value: fn(&State) -> f64| {
                let pairs = solved.chunks_exact(2);
                pairs
                    .map(|pair| {
                        let [(below, down), (above, up)] = [&pair[0], &pair[1]];
                        (value(&above[number]) - value(&below[number])) / (up + down)
                    })
                    .collect()
            };
            let [force_slope, radius_slope] = state.slopes;
            let by_force = self.data.position() == Position::None;
            Derivatives {
                force: by(|state| state.read_force),
                contact_radius: by(|state| state.smooth_radius),
                force_by_position: force_slope,
                radius_by_position: radius_slope,
                radius_by_force: if by_force { radius_slope } else { 0.0 },
            }
        };
        Ok(states.iter().enumerate().map(of_row).collect())
    }

    /// Derivatives of force and smooth contact radius with respect to the load, at the state under
    /// it.
    pub(super) fn along_load(
        &self,
        case: &Subject,
        load: Load,
        state: &State,
    ) -> Result<[f64; 2], SolveError> {
        let value = value_of(load);
        if value <= 0.0 {
            return Ok([0.0; 2]);
        }
        let side = |step: f64| self.side(case, scaled(load, 1.0 + step), DIFFERENCE * value);
        Ok(difference([side(-DIFFERENCE)?, side(DIFFERENCE)?], state))
    }

    /// Derivatives of force and smooth contact radius between two cases, at the state under the load.
    pub(super) fn between(
        &self,
        sides: &Sides,
        load: Load,
        state: &State,
    ) -> Result<[f64; 2], SolveError> {
        let side = |side: &Option<(Subject, f64)>| match side {
            Some((case, away)) => self.side(case, load, *away),
            None => Ok(None),
        };
        let [below, above] = sides;
        Ok(difference([side(below)?, side(above)?], state))
    }

    /// A state on one side of another, at a given distance; `None` outside the model.
    fn side(
        &self,
        case: &Subject,
        load: Load,
        away: f64,
    ) -> Result<Option<(State, f64)>, SolveError> {
        match self.solve(case, load) {
            Ok(state) => Ok(Some((state, away))),
            Err(SolveError::Interrupted) => Err(SolveError::Interrupted),
            Err(_) => Ok(None),
        }
    }
}

/// State on an elastic curve under a load without the contributions of the instrument.
fn state_on(curve: &CaseCurve, by: MeasuredBy, load: f64) -> Result<State, FitError> {
    /// Relative step of the depth for slopes.
    const STEP: f64 = 1e-3;
    let elastic = &curve.elastic;
    let compliance = match by {
        MeasuredBy::Force => 0.0,
        MeasuredBy::Position { compliance } => compliance,
    };
    let indentation = match by {
        MeasuredBy::Force => elastic.indentation_at(load),
        MeasuredBy::Position { .. } => {
            balanced(elastic, compliance, load).ok_or(FitError::NoBalance {
                compliance,
                reading: load,
            })?
        }
    };
    let depth = indentation - elastic.first_touch();
    let force = elastic.force_at(indentation);
    let [below, above] = [-STEP, STEP].map(|step| elastic.force_at(indentation + step * depth));
    let stiffness = if depth > 0.0 {
        (above - below) / (2.0 * STEP * depth)
    } else {
        0.0
    };
    let radius = elastic.contact_radius_at(indentation).unwrap_or(0.0);
    Ok(State {
        force,
        read_force: force,
        slopes: [stiffness / (1.0 + compliance * stiffness), 0.0],
        contact_radius: radius,
        smooth_radius: radius,
        past_transition: curve.through_floor.is_some_and(|floor| indentation > floor),
        converged: curve.converged,
        ..State::without_contact(indentation)
    })
}

/// The indentation at which it and the machine take a position together, `zeta + C F(zeta) = position`; `None` if there is none.
fn balanced(elastic: &ElasticCurve, compliance: f64, position: f64) -> Option<f64> {
    let touch = elastic.first_touch();
    if compliance == 0.0 || position <= touch {
        return Some(position);
    }
    let excess =
        |indentation: f64| indentation + compliance * elastic.force_at(indentation) - position;
    let point = |position: f64| roots::Point {
        position,
        value: excess(position),
    };
    // A negative compliance moves the lens further than it was measured.
    let far = if compliance > 0.0 {
        position
    } else {
        larger(elastic.last(), position)
    };
    let ends = [point(touch), point(far)];
    let off = |indentation: f64| Ok::<_, std::convert::Infallible>(excess(indentation));
    match roots::find(ends, 0.0, off) {
        Ok(Some(root)) => Some(root.closest().position),
        _ => None,
    }
}

/// The history of the measured loads.
struct History {
    by: MeasuredBy,
    loads: Vec<MeasuredLoad>,
    /// The largest load, N or m.
    largest: f64,
}

/// The relaxation of a case for data that contain times.
fn relaxation_over_time(
    file: &CaseFile,
    data: &Measurements,
) -> Result<Option<Relaxation>, FitError> {
    if !data.has_times() {
        return Ok(None);
    }
    Ok(file.relaxation()?.map(|of| of.relaxation))
}

/// Checks that data contain the history of viscoelastic bodies: a load in every row, and times in order.
fn check_history(data: &Measurements) -> Result<(), FitError> {
    let wrong = |row: &Measurement, problem| FitError::History {
        name: data.name().to_owned(),
        line: row.line,
        problem,
    };
    let mut before = f64::NEG_INFINITY;
    for row in data.rows() {
        let time = row.time.unwrap_or(before);
        if time < before {
            return Err(wrong(
                row,
                "the time is smaller than in the row before, and viscoelastic bodies depend on the order: sort the rows, or fit one test at a time",
            ));
        }
        before = time;
        let is_there = match data.position() {
            Position::None => row.force.is_some(),
            _ => row.position.is_some(),
        };
        if !is_there {
            return Err(wrong(
                row,
                "there is no load, and viscoelastic bodies depend on all loads before: give it in every row",
            ));
        }
    }
    Ok(())
}

/// A load times a factor.
fn scaled(load: Load, factor: f64) -> Load {
    load.map(|value| factor * value, |value| factor * value)
}

fn value_of(load: Load) -> f64 {
    match load {
        Load::Indentation(value) | Load::Force(value) => value,
        Load::FloorContact => 0.0, // nothing to go along
    }
}

/// Time of every row, from 0 at the first to 1 at the last: from the times if all rows have one, otherwise from the row numbers.
fn moments(data: &Measurements) -> Vec<f64> {
    let rows = data.rows();
    let times: Option<Vec<f64>> = rows.iter().map(|row| row.time).collect();
    let times = times.filter(|_| data.has_times());
    let times = times.unwrap_or_else(|| (0..rows.len()).map(|number| number as f64).collect());
    let ends = [times.first(), times.last()].map(|end| end.copied().unwrap_or(0.0));
    let length = ends[1] - ends[0];
    let moment = |time: &f64| {
        if length > 0.0 {
            (time - ends[0]) / length
        } else {
            0.0
        }
    };
    times.iter().map(moment).collect()
}

/// Differences of force and smooth contact radius; one-sided if there is no state on the other side.
fn difference([below, above]: [Option<(State, f64)>; 2], middle: &State) -> [f64; 2] {
    let end = |side: &Option<(State, f64)>| {
        let (state, away) = side
            .as_ref()
            .map_or((middle, 0.0), |(state, away)| (state, *away));
        (state.force, state.smooth_radius, away)
    };
    let (low, high) = (end(&below), end(&above));
    let apart = low.2 + high.2;
    [(high.0 - low.0) / apart, (high.1 - low.1) / apart]
}

/// Load of a row: its position if measured, otherwise its force.
pub(super) fn load_of(row: &Measurement) -> f64 {
    row.position.or(row.force).map_or(0.0, |load| load.value)
}

/// For every row, the difference of the loads of its neighbours on its branch; at an end, twice the difference to its
/// neighbour.
fn stretches(data: &Measurements, orders: &[Vec<usize>; 2]) -> Vec<f64> {
    let load = |number: &usize| load_of(&data.rows()[*number]);
    let mut stretches = vec![0.0; data.rows().len()];
    for order in orders {
        for (place, number) in order.iter().enumerate() {
            let step = |neighbour: Option<&usize>| Some((load(neighbour?) - load(number)).abs());
            let below = step(place.checked_sub(1).and_then(|place| order.get(place)));
            let above = step(order.get(place + 1));
            let steps = [below.or(above), above.or(below)];
            stretches[*number] = steps.into_iter().flatten().sum();
        }
    }
    stretches
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::column::Column;

    #[test]
    fn exact_derivatives_are_those_of_the_states() {
        // Central differences of the states themselves, with a step whose square is the relative error.
        const STEP: f64 = 1e-3;
        let mut file = CaseFile::parse("case", &Case::example().to_toml()).unwrap();
        for given in [
            "pattern.surface_fraction=0.01",
            "substrate.thickness=0.5 mm",
            "lens.thickness=1 mm",
        ] {
            file.set(given).unwrap();
        }
        // Between contacts of new pillars. The forces only set the step of the compliance.
        let displacement = vec![0.5e-6, 1.0e-6, 2.0e-6];
        let columns = [
            (Column::Displacement, displacement),
            (Column::Force, vec![1e-4; 3]),
        ];
        let data = Measurements::new(&columns).unwrap();
        let mut free = Parameter::ALL.to_vec();
        free.retain(|free| !free.is_work() && !free.is_of_relaxation());
        let others = [
            Key::Offset,
            Key::OffsetAngle,
            Key::TopRadius,
            Key::HeightUnit,
            Key::HeightRange,
        ];
        let others = others.map(Parameter::Key);
        free.retain(|free| !others.contains(free));
        let options = FitOptions {
            contact_point: Some(0.1e-6),
            machine_compliance: 2e-3,
            ..FitOptions::default()
        };
        let run = Run::default();
        let model = Model::new(&file, &data, &free, &options, &run).unwrap();
        let begin = model.start().unwrap();
        let states = model.states(&begin, 0.0).unwrap();
        let before = model.solved();
        let derivatives = model.derivatives(&begin, &states, 0.0).unwrap();
        // One gradient for every row; differences would require 2 solutions along the load and 2 for each of 6
        // keys.
        assert_eq!(model.solved() - before, 3);
        for (number, parameter) in free.iter().enumerate() {
            let moved = |step: f64| {
                let mut moved = begin.clone();
                moved[number] += step;
                model.states(&moved, 0.0).unwrap()
            };
            let (below, above) = (moved(-STEP), moved(STEP));
            for (row, derivative) in derivatives.iter().enumerate() {
                let slope = (above[row].read_force - below[row].read_force) / (2.0 * STEP);
                let scale = slope.abs().max(1e-3 * states[row].force);
                assert!(
                    (derivative.force[number] - slope).abs() < 1e-3 * scale,
                    "{} {row}: {} {slope}",
                    parameter.name(),
                    derivative.force[number]
                );
            }
        }
    }
}
