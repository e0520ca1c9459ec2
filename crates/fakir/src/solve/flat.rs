//! Contacts with a flat surface: one disc, whose radius changes until the condition at its edge is satisfied.
//!
//! With the equation of [`theory::layer`](crate::theory::layer) at a contact radius `a`, the solution for an indentation `delta` is
//! `pi theta = delta one + bent`, the solutions for `g = 1` and for `g = -G(u)`, where `G(u) = u ∫_0^u f'(r)/sqrt(u^2 - r^2) dr` for a lens of height `f`.
//! At the rim `pi theta(a) = -sqrt(2 pi w a/E*)`: zero without adhesion, and Griffith's condition `K_I^2 = 2 E* w` with it (K. L. Johnson, K. Kendall,
//! A. D. Roberts, Proc. R. Soc. A 324, 301 (1971)). Layers leave it as it is, since near the rim they are half-spaces. So every contact radius has its
//! indentation and force in closed form, and a prescribed load is met by a search over the radius.

mod chart;
pub mod fields;
mod gradient;

use crate::numerics::convergence::{larger, smaller};
use crate::numerics::line::integral_and_negative_part;
use crate::numerics::quadrature::gauss_legendre;
use crate::numerics::roots::{Point, find, least};
use crate::problem::layer::Layer;
use crate::problem::load::Prescribed;
use crate::problem::{CyclePlan, FlatSystem, LensShape, Load, LoadingMode, UnloadingPoint};
use crate::state::contact::contact_warnings;
use crate::state::limit::DEEPEST_IN_LAYER;
use crate::state::{
    Branch, FlatContact, FlatCycle, FlatErrors, FlatLoadStep, Run, SolveError, Termination, Warning,
};
use crate::theory::layer::{Disc, Layers};
use chart::Chart;
use std::cell::RefCell;
use std::f64::consts::PI;

/// Relative step in the contact radius of the difference quotient for the stiffness. Its error is the fourth power.
const STEP: f64 = 1e-3;

/// Ratio of neighbouring radii in the scan for the radius at which the lens detaches, and how far below the length of adhesion it begins.
const SCAN: f64 = 1.4;
const BELOW_ADHESION: f64 = 0.05;

/// Golden sections of that search: the smallest value has all digits.
const SECTIONS: usize = 44;

/// Intervals of each branch of a cycle; a multiple of two, as the error of the loop area is from every other one.
const INTERVALS: usize = 64;

/// Largest radius over the thickness of the thinnest layer.
const WIDEST: f64 = 40.0;

/// Errors of this relative size and below are rounding errors.
const ROUNDING: f64 = 1e-12;

/// A contact with a given radius and work of adhesion.
#[derive(Debug, Clone, Copy)]
struct Settled {
    radius: f64,
    indentation: f64,
    force: f64,
    /// Change of the force with the indentation at this radius.
    punch: f64,
    /// The solution for `g = 1` at the rim.
    one_at_rim: f64,
    /// `pi theta` at the rim.
    at_rim: f64,
    pressure_on_axis: f64,
    /// Smallest value of `pi theta` inside the rim.
    least: f64,
}

impl Settled {
    fn reached(&self) -> Reached {
        Reached {
            radius: self.radius,
            indentation: self.indentation,
            force: self.force,
        }
    }
}

/// A point of the curve of contacts.
#[derive(Debug, Clone, Copy)]
struct Reached {
    radius: f64,
    indentation: f64,
    force: f64,
}

/// What drives a search over the radius.
#[derive(Debug, Clone, Copy)]
enum Driver {
    Indentation,
    Force,
    /// Indentation plus force times this compliance.
    Machine(f64),
}

impl Driver {
    fn of(self, state: Reached) -> f64 {
        match self {
            Self::Indentation => state.indentation,
            Self::Force => state.force,
            Self::Machine(compliance) => state.indentation + compliance * state.force,
        }
    }

    /// The indentation at which it has a value while the rim is fixed, where the force is linear in the indentation; `level` is the contact at indentation 0.
    fn pinned(self, target: f64, level: &Settled) -> f64 {
        match self {
            Self::Indentation => target,
            Self::Force => (target - level.force) / level.punch,
            Self::Machine(compliance) => {
                (target - compliance * level.force) / (1.0 + compliance * level.punch)
            }
        }
    }
}

impl From<LoadingMode> for Driver {
    fn from(mode: LoadingMode) -> Self {
        match mode {
            LoadingMode::Displacement => Self::Indentation,
            LoadingMode::Force => Self::Force,
            LoadingMode::Machine(stiffness) => Self::Machine(stiffness.recip()),
        }
    }
}

/// A system at a resolution.
struct Bench<'a> {
    system: &'a FlatSystem,
    layers: Layers,
    /// Factor of the number of points.
    finer: f64,
    /// The Gauss rule of the last contact: most contacts have as many points as the one before.
    rule: RefCell<Vec<(f64, f64)>>,
    /// Interpolation over the radius, if there are many loads.
    chart: Option<Chart>,
}

impl<'a> Bench<'a> {
    fn new(system: &'a FlatSystem, finer: f64) -> Self {
        Self {
            system,
            layers: Layers::new(system.bodies()),
            finer,
            rule: RefCell::default(),
            chart: None,
        }
    }

    fn disc(&self, radius: f64) -> Disc {
        let rows = match &self.system.lens().shape {
            LensShape::Profile(profile) => profile.radii().len().min(100),
            _ => 0,
        };
        let points = (self.layers.points(radius) + rows) as f64 * self.finer;
        let points = points as usize;
        let mut rule = self.rule.borrow_mut();
        if rule.len() != points {
            *rule = gauss_legendre(points);
        }
        self.layers.disc(radius, &rule)
    }

    /// The solutions for `g = 1` and for the depth of the lens.
    fn solutions(&self, disc: &Disc, radius: f64) -> [Vec<f64>; 2] {
        let one = disc.solve(|_| 1.0);
        let bent = match self.system.is_punch() {
            true => vec![0.0; one.len()],
            false => disc.solve(|u| -self.system.depth(u * radius)),
        };
        [one, bent]
    }

    /// The contact of a radius whose rim has a work of adhesion.
    fn at(&self, radius: f64, work: f64) -> Settled {
        let disc = self.disc(radius);
        let [one, bent] = self.solutions(&disc, radius);
        let at_rim = -(2.0 * PI * work * radius / self.system.reduced_modulus()).sqrt();
        let indentation = (at_rim - disc.at_rim(&bent)) / disc.at_rim(&one);
        self.settled(&disc, [&one, &bent], radius, indentation)
    }

    /// The point of the curve at a radius, interpolated if there are many loads.
    fn reached(&self, radius: f64, work: f64) -> Reached {
        let solved = |radius: f64| self.at(radius, work).reached();
        let charted = self.chart.as_ref().and_then(|chart| {
            chart.at((radius, work), self.largest(), |radius| {
                let contact = solved(radius);
                [contact.indentation, contact.force]
            })
        });
        match charted {
            Some([indentation, force]) => Reached {
                radius,
                indentation,
                force,
            },
            None => solved(radius),
        }
    }

    /// The contact of a radius at an indentation.
    fn with_radius(&self, radius: f64, indentation: f64) -> Settled {
        let disc = self.disc(radius);
        let [one, bent] = self.solutions(&disc, radius);
        self.settled(&disc, [&one, &bent], radius, indentation)
    }

    fn settled(
        &self,
        disc: &Disc,
        [one, bent]: [&[f64]; 2],
        radius: f64,
        indentation: f64,
    ) -> Settled {
        let modulus = self.system.reduced_modulus();
        let sum: Vec<f64> = one
            .iter()
            .zip(bent)
            .map(|(one, bent)| indentation * one + bent)
            .collect();
        Settled {
            radius,
            indentation,
            force: 2.0 * radius * modulus * disc.integral(&sum),
            punch: 2.0 * radius * modulus * disc.integral(one),
            one_at_rim: disc.at_rim(one),
            at_rim: disc.at_rim(&sum),
            pressure_on_axis: modulus / (PI * radius) * disc.on_axis(&sum),
            least: disc.least(&sum),
        }
    }

    /// Change of the force with the indentation while the rim moves.
    fn stiffness(&self, state: &Settled, work: f64) -> f64 {
        if self.system.is_punch() || work <= 0.0 {
            return state.punch;
        }
        state.punch + self.force_by_radius(state) / self.indentation_by_radius(state, work)
    }

    /// Change of the indentation with the radius at which the rim is in equilibrium.
    fn indentation_by_radius(&self, state: &Settled, work: f64) -> f64 {
        let at = |steps: f64| {
            self.at(state.radius * (1.0 + steps * STEP), work)
                .indentation
        };
        let step = 12.0 * STEP * state.radius;
        (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / step
    }

    /// Change of the force with the radius at a fixed indentation: `2 E* pi theta(a)` times the solution for `g = 1` at the rim.
    fn force_by_radius(&self, state: &Settled) -> f64 {
        2.0 * self.system.reduced_modulus() * state.at_rim * state.one_at_rim
    }

    /// The largest radius for which the system is solved.
    fn largest(&self) -> f64 {
        let layers = self.system.layers().into_iter().flatten();
        let thinnest = layers
            .map(|layer| layer.thickness)
            .fold(f64::INFINITY, smaller);
        smaller(self.system.lens().largest_contact(), WIDEST * thinnest)
    }

    fn exceeded(&self) -> SolveError {
        let reach = self.largest();
        let lens = self.system.lens();
        match &lens.shape {
            LensShape::Profile(profile) if reach >= profile.range() => SolveError::ProfileEnds {
                reach,
                end: profile.range(),
            },
            _ if reach >= lens.largest_contact() => SolveError::ContactExceedsLens {
                contact_radius: reach,
                lens_radius: 2.0 * reach,
            },
            _ => SolveError::LayerTooThin {
                contact_radius: reach,
                thickness: reach / WIDEST,
            },
        }
    }

    /// Length of adhesion: the radius of a small sphere's contact without load is about this.
    fn length_of_adhesion(&self, work: f64) -> f64 {
        let radius = self.system.length();
        (work * radius * radius / self.system.reduced_modulus()).cbrt()
    }

    /// The radius at which the driver is smallest: there a lens detaches. Zero without adhesion.
    fn detachment(&self, driver: Driver, work: f64) -> Result<f64, SolveError> {
        if work <= 0.0 {
            return Ok(0.0);
        }
        let most = self.largest();
        let value = |radius: f64| driver.of(self.at(radius, work).reached());
        let mut radius = smaller(BELOW_ADHESION * self.length_of_adhesion(work), 0.1 * most);
        let mut best = (radius, value(radius));
        while radius < most {
            radius = smaller(radius * SCAN, most);
            let here = value(radius);
            if here < best.1 {
                best = (radius, here);
            } else if radius > best.0 * SCAN.powi(6) {
                break;
            }
        }
        if best.0 >= most {
            return Err(self.exceeded());
        }
        let ends = [(best.0 / SCAN).ln(), smaller(best.0 * SCAN, most).ln()];
        Ok(least(ends, SECTIONS, |log| value(log.exp())).exp())
    }

    /// The radius of the contact at which the driver has a value, beyond the radius at which the lens detaches; none if it is below the value there.
    fn meet(
        &self,
        driver: Driver,
        target: f64,
        work: f64,
        from: f64,
    ) -> Result<Option<f64>, SolveError> {
        let most = self.largest();
        let off = |radius: f64| driver.of(self.reached(radius, work)) - target;
        let at = |position: f64, value: f64| Point { position, value };
        // Up from a radius that is certainly too small, in steps that grow.
        let mut low = if from > 0.0 {
            at(from, off(from))
        } else {
            at(0.0, -target)
        };
        if low.value > 0.0 {
            return Ok(None);
        }
        let mut radius = if from > 0.0 {
            from * SCAN
        } else {
            smaller(self.hertz_guess(driver, target), 0.5 * most)
        };
        let high = loop {
            radius = smaller(radius, most);
            let value = off(radius);
            if value.is_nan() {
                return Err(SolveError::NotFinite {
                    what: "contact radius",
                });
            }
            if value >= 0.0 {
                break at(radius, value);
            }
            if radius >= most {
                return Err(self.exceeded());
            }
            low = at(radius, value);
            radius *= 2.0;
        };
        let root = find([low, high], 0.0, |radius| Ok::<_, SolveError>(off(radius)))?;
        Ok(Some(
            root.map_or(high.position, |root| root.closest().position),
        ))
    }

    /// Half of Hertz's radius of contact, as the start of a search.
    fn hertz_guess(&self, driver: Driver, target: f64) -> f64 {
        let radius = self.system.length();
        0.5 * match driver {
            Driver::Force => (0.75 * target * radius / self.system.reduced_modulus()).cbrt(),
            Driver::Indentation | Driver::Machine(_) => (target * radius).sqrt(),
        }
    }

    /// The contact on loading; none where there is no contact.
    fn loaded(&self, load: Prescribed) -> Result<Option<Settled>, SolveError> {
        let work = self.system.adhesion().work;
        let (driver, target) = match load {
            Prescribed::Indentation(value) => (Driver::Indentation, value),
            Prescribed::Force(value) => (Driver::Force, value),
        };
        if let Some(radius) = self.punch()? {
            let is_pressed = target > 0.0 || work > 0.0;
            return Ok(is_pressed.then(|| self.pinned(driver, target, radius)));
        }
        if target <= 0.0 && work <= 0.0 {
            return Ok(None);
        }
        let from = self.detachment(driver, work)?;
        let radius = self.meet(driver, target, work, from)?;
        Ok(radius.map(|radius| self.at(radius, work)))
    }

    /// The radius of a punch; none of a lens.
    fn punch(&self) -> Result<Option<f64>, SolveError> {
        match self.system.lens().punch_radius() {
            Some(radius) if radius > self.largest() => Err(self.exceeded()),
            punch => Ok(punch),
        }
    }

    /// The contact of a radius at which the driver has a value. With a fixed rim the force is linear in the indentation.
    fn pinned(&self, driver: Driver, target: f64, radius: f64) -> Settled {
        let level = self.with_radius(radius, 0.0);
        self.with_radius(radius, driver.pinned(target, &level))
    }

    fn contact(&self, state: &Settled, work: f64) -> FlatContact {
        let system = self.system;
        let mut warnings = Vec::new();
        if let Some(radius) = system.lens().curvature_radius() {
            warnings.extend(contact_warnings(state.radius / radius));
        }
        let thicknesses = system.layers().into_iter().flatten().map(of_layer);
        let thinnest = thicknesses.fold(f64::INFINITY, smaller);
        let strain = state.indentation / thinnest;
        if strain > DEEPEST_IN_LAYER {
            warnings.push(Warning::LayerStrain { ratio: strain });
        }
        // Without adhesion theta falls towards the rim; where it is negative inside, the contact is not one disc.
        let is_disc =
            work > 0.0 || system.is_punch() || state.least > -1e-9 * state.indentation.abs();
        FlatContact {
            indentation: state.indentation,
            force: state.force,
            contact_radius: state.radius,
            contact_area: PI * state.radius * state.radius,
            pressure_on_axis: state.pressure_on_axis,
            stiffness: self.stiffness(state, work),
            punch_stiffness: state.punch,
            error: FlatErrors::default(),
            termination: if is_disc {
                Termination::Converged
            } else {
                Termination::Stagnated
            },
            warnings,
        }
    }
}

fn of_layer(layer: &Layer) -> f64 {
    layer.thickness
}

/// A contact without load.
fn untouched(indentation: f64) -> FlatContact {
    FlatContact {
        indentation,
        force: 0.0,
        contact_radius: 0.0,
        contact_area: 0.0,
        pressure_on_axis: 0.0,
        stiffness: 0.0,
        punch_stiffness: 0.0,
        error: FlatErrors::default(),
        termination: Termination::Converged,
        warnings: Vec::new(),
    }
}

/// Relative difference, at least a rounding error.
fn difference(one: f64, other: f64, scale: f64) -> f64 {
    if scale > 0.0 {
        larger((one - other).abs() / scale, ROUNDING)
    } else {
        ROUNDING
    }
}

/// The contact with errors from one with more points.
fn with_errors(contact: FlatContact, fine: &Settled, load: Option<Prescribed>) -> FlatContact {
    // The force of an adhesive contact passes through zero: its error is relative to that of the punch that comes down as far.
    let depth = larger(
        contact.indentation.abs(),
        contact.force.abs() / contact.punch_stiffness,
    );
    let force = larger(
        contact.force.abs(),
        contact.punch_stiffness * contact.indentation.abs(),
    );
    let mut error = FlatErrors {
        force: 2.0 * difference(fine.force, contact.force, force),
        indentation: 2.0 * difference(fine.indentation, contact.indentation, depth),
        contact_radius: 2.0
            * difference(fine.radius, contact.contact_radius, contact.contact_radius),
    };
    match load {
        Some(Prescribed::Indentation(_)) => error.indentation = 0.0,
        Some(Prescribed::Force(_)) => error.force = 0.0,
        None => {}
    }
    FlatContact { error, ..contact }
}

/// Factor of the number of points for error estimates.
const FINER: f64 = 1.5;

impl FlatSystem {
    /// The contact on loading, with error estimates.
    ///
    /// With adhesion the lens jumps into contact where it first touches, at indentation 0, and the contact is the one on the loading branch at this load; a
    /// force of 0 is the contact at rest after the jump.
    ///
    /// # Errors
    /// An invalid load, a contact too large for the lens, its table of heights or a layer, or interruption. [`Load::FloorContact`] is
    /// [`SolveError::NoFloor`].
    pub fn press(&self, load: Load, run: &Run<'_>) -> Result<FlatContact, SolveError> {
        run.check_cancelled()?;
        let load = load.checked(self.length(), self.reduced_modulus())?;
        let load = load.prescribed().ok_or(SolveError::NoFloor)?;
        let bench = Bench::new(self, 1.0);
        let Some(state) = bench.loaded(load)? else {
            return Ok(untouched(0.0));
        };
        run.check_cancelled()?;
        let work = self.adhesion().work;
        let mut contact = bench.contact(&state, work);
        // The search ends next to the prescribed load, by rounding.
        match load {
            Prescribed::Indentation(indentation) => contact.indentation = indentation,
            Prescribed::Force(force) => contact.force = force,
        }
        let fine = Bench::new(self, FINER).loaded(load)?.unwrap_or(state);
        with_errors(contact, &fine, Some(load)).checked()
    }

    /// The branches of a cycle whose loading ends at `turn`, for contacts at given loads: see [`FlatBranches`].
    ///
    /// # Errors
    /// As [`press`](Self::press).
    pub fn branches<'a>(
        &'a self,
        mode: LoadingMode,
        turn: f64,
        run: &'a Run<'a>,
    ) -> Result<FlatBranches<'a>, SolveError> {
        FlatBranches::new(self, Driver::from(mode), turn, run)
    }

    /// Loading and unloading with adhesion.
    ///
    /// The lens touches, jumps into contact, and is pressed to the end of loading. If the plan includes unloading, it is then withdrawn. With a larger receding
    /// work of adhesion the contact radius remains constant at first; then the contact shrinks until no contact is stable in the loading mode.
    ///
    /// # Errors
    /// As [`press`](Self::press); [`SolveError::NoAdhesion`] without adhesion, and [`SolveError::NoFloor`] for a part of the critical indentation.
    pub fn cycle(&self, plan: &CyclePlan, run: &Run<'_>) -> Result<FlatCycle, SolveError> {
        if self.adhesion().is_none() {
            return Err(SolveError::NoAdhesion);
        }
        let plan = plan.checked(self.length(), self.reduced_modulus())?;
        run.check_cancelled()?;
        let [bench, finer] = [1.0, FINER].map(|finer| Bench::new(self, finer));
        let path = Path::new(&bench, &plan)?;
        run.check_cancelled()?;
        path.cycle(&Path::new(&finer, &plan)?, plan)
    }
}

/// The branches of a cycle: the loading to a turn, and the unloading from there. Without adhesion both are the same curve.
///
/// The turn and the loads are what the loading mode prescribes: indentations `zeta` (m), forces (N), or with a machine of stiffness `k` displacements
/// `zeta + F/k` (m). A [`FlatCycle`] has the curve at equal steps of the contact radius; here any load has its contact to all digits.
pub struct FlatBranches<'a> {
    bench: Bench<'a>,
    run: &'a Run<'a>,
    driver: Driver,
    /// A punch at indentation 0; none of a lens.
    punch: Option<Settled>,
    /// Smallest radius of an attached lens on loading, and what the driver has there.
    least: f64,
    least_load: f64,
    unloading: Option<Receding>,
}

/// The unloading of a contact with adhesion.
struct Receding {
    /// The contact at indentation 0 whose radius is that at the end of the loading, at which the rim stays at first.
    level: Settled,
    /// What the driver has where the rim begins to move, and where the contact ends.
    moves: f64,
    ends: f64,
    /// Smallest radius.
    least: f64,
}

impl<'a> FlatBranches<'a> {
    fn new(
        system: &'a FlatSystem,
        driver: Driver,
        turn: f64,
        run: &'a Run<'a>,
    ) -> Result<Self, SolveError> {
        run.check_cancelled()?;
        let bench = Bench::new(system, 1.0);
        let punch = bench.punch()?;
        let punch = punch.map(|radius| bench.with_radius(radius, 0.0));
        let adhesion = system.adhesion();
        let least = match &punch {
            Some(punch) => punch.radius,
            None => bench.detachment(driver, adhesion.work)?,
        };
        let least_load = match least > 0.0 {
            true => driver.of(bench.at(least, adhesion.work).reached()),
            false => 0.0,
        };
        let mut branches = Self {
            bench,
            run,
            driver,
            punch,
            least,
            least_load,
            unloading: None,
        };
        // An adhesive lens jumps into contact where it touches.
        if !adhesion.is_none()
            && turn >= 0.0
            && let Some(turn) = branches.loaded(turn)?
        {
            branches.unloading = Some(branches.receding(turn.radius)?);
        }
        Ok(branches)
    }

    /// The same contacts, for thousands of loads: interpolated over the radius, to 1e-11 of the largest force and indentation.
    #[must_use]
    pub fn interpolated(mut self) -> Self {
        self.bench.chart = Some(Chart::default());
        self
    }

    fn receding(&self, turn: f64) -> Result<Receding, SolveError> {
        let (bench, work) = (&self.bench, self.bench.system.adhesion().receding());
        let start = bench.at(turn, work);
        let least = match &self.punch {
            Some(punch) => punch.radius,
            None => smaller(bench.detachment(self.driver, work)?, turn),
        };
        Ok(Receding {
            level: bench.with_radius(turn, 0.0),
            moves: self.driver.of(start.reached()),
            ends: self.driver.of(bench.at(least, work).reached()),
            least,
        })
    }

    /// A contact with a fixed rim, from the one at indentation 0.
    fn pinned(&self, load: f64, level: &Settled) -> Reached {
        let indentation = self.driver.pinned(load, level);
        Reached {
            radius: level.radius,
            indentation,
            force: level.force + indentation * level.punch,
        }
    }

    /// The contact on loading; none where there is none.
    fn loaded(&self, load: f64) -> Result<Option<Reached>, SolveError> {
        let work = self.bench.system.adhesion().work;
        if let Some(punch) = &self.punch {
            return Ok(Some(self.pinned(load, punch)));
        }
        let radius = self.bench.meet(self.driver, load, work, self.least)?;
        Ok(radius.map(|radius| self.bench.reached(radius, work)))
    }

    /// The same on unloading.
    fn unloaded(&self, load: f64) -> Result<Option<Reached>, SolveError> {
        let Some(receding) = &self.unloading else {
            return Ok(None);
        };
        if load >= receding.moves {
            return Ok(Some(self.pinned(load, &receding.level)));
        }
        if load < receding.ends || self.punch.is_some() {
            return Ok(None);
        }
        let work = self.bench.system.adhesion().receding();
        let radius = self.bench.meet(self.driver, load, work, receding.least)?;
        Ok(radius.map(|radius| self.bench.reached(radius, work)))
    }

    /// Load below which there is no contact on a branch: the lens touches at 0, and detaches where no contact is stable. Infinite for the unloading if the
    /// turn is before contact.
    #[must_use]
    pub fn end(&self, branch: Branch) -> f64 {
        match (branch, &self.unloading) {
            (Branch::Unloading, Some(receding)) => receding.ends,
            (Branch::Unloading, None) if !self.bench.system.adhesion().is_none() => f64::INFINITY,
            _ => 0.0,
        }
    }

    /// The contact at a load on a branch. Without contact its force and radius are 0.
    ///
    /// # Errors
    /// A contact too large for the lens, its table of heights or a layer, or interruption.
    pub fn at(&self, branch: Branch, load: f64) -> Result<FlatLoadStep, SolveError> {
        self.run.check_cancelled()?;
        let is_adhesive = !self.bench.system.adhesion().is_none();
        let state = match branch {
            // Without adhesion both branches are the same, and there is no contact at a load of 0.
            _ if !is_adhesive && load <= 0.0 => None,
            Branch::Loading if load < 0.0 => None,
            Branch::Unloading if is_adhesive => self.unloaded(load)?,
            _ => self.loaded(load)?,
        };
        Ok(state.map_or_else(|| self.apart(branch, load), |state| step(branch, state)))
    }

    /// The contact at a load on a branch of a lens that is attached: on loading also at loads below 0, which a lens that comes down does not have. At loads
    /// below the smallest one of an attached lens it is the contact at that load.
    ///
    /// # Errors
    /// As [`at`](Self::at).
    pub fn attached(&self, branch: Branch, load: f64) -> Result<FlatLoadStep, SolveError> {
        self.run.check_cancelled()?;
        let adhesion = self.bench.system.adhesion();
        let (found, least, work) = match (branch, &self.unloading) {
            (Branch::Unloading, Some(receding)) => {
                let found = self.unloaded(larger(load, receding.ends))?;
                (found, receding.least, adhesion.receding())
            }
            _ => {
                let found = self.loaded(larger(load, self.least_load))?;
                (found, self.least, adhesion.work)
            }
        };
        let at_end = || (least > 0.0).then(|| self.bench.reached(least, work));
        let state = found.or_else(at_end);
        Ok(state.map_or_else(|| self.apart(branch, load), |state| step(branch, state)))
    }

    /// The lens without contact at a load.
    #[must_use]
    pub fn apart(&self, branch: Branch, load: f64) -> FlatLoadStep {
        FlatLoadStep {
            branch,
            indentation: match self.driver {
                Driver::Force => 0.0,
                Driver::Indentation | Driver::Machine(_) => load,
            },
            force: 0.0,
            contact_radius: 0.0,
        }
    }
}

/// A point of the curve.
fn step(branch: Branch, state: Reached) -> FlatLoadStep {
    FlatLoadStep {
        branch,
        indentation: state.indentation,
        force: state.force,
        contact_radius: state.radius,
    }
}

/// The contacts at which a cycle changes, at a resolution, and its curve.
struct Path<'a, 'b> {
    bench: &'b Bench<'a>,
    jump: Settled,
    turn: Settled,
    pull_off: Option<Settled>,
    steps: Vec<FlatLoadStep>,
    separation: Option<f64>,
}

impl<'a, 'b> Path<'a, 'b> {
    fn new(bench: &'b Bench<'a>, plan: &CyclePlan) -> Result<Self, SolveError> {
        let work = bench.system.adhesion().work;
        let driver = Driver::from(plan.drive);
        let punch = bench.punch()?;
        let jump = match punch {
            Some(radius) => bench.with_radius(radius, 0.0),
            None => {
                let from = bench.detachment(driver, work)?;
                let radius = bench.meet(driver, 0.0, work, from)?;
                let radius = radius.ok_or(SolveError::NotFinite {
                    what: "jump into contact",
                })?;
                let met = bench.at(radius, work);
                // What is constant in the jump is exactly 0.
                match driver {
                    Driver::Force => Settled { force: 0.0, ..met },
                    Driver::Indentation => Settled {
                        indentation: 0.0,
                        ..met
                    },
                    Driver::Machine(_) => met,
                }
            }
        };
        let (by, target) = match plan.turn {
            UnloadingPoint::Critical(_) => return Err(SolveError::NoFloor),
            UnloadingPoint::Indentation(value) => (Driver::Indentation, value),
            UnloadingPoint::Force(value) => (Driver::Force, value),
        };
        let turn = match punch {
            Some(radius) => bench.pinned(by, target, radius),
            None if by.of(jump.reached()) >= target => jump,
            None => {
                let radius = bench.meet(by, target, work, jump.radius)?;
                radius.map_or(jump, |radius| bench.at(radius, work))
            }
        };
        let mut path = Self {
            bench,
            jump,
            turn,
            pull_off: None,
            steps: Vec::new(),
            separation: None,
        };
        path.record(Branch::Loading, [jump, turn], work);
        if plan.retract {
            path.unload(driver)?;
        }
        Ok(path)
    }

    /// Adds the curve between two contacts: in steps of the radius where they differ in it, and else of the indentation.
    fn record(&mut self, branch: Branch, [from, to]: [Settled; 2], work: f64) {
        for k in 0..=INTERVALS {
            let part = k as f64 / INTERVALS as f64;
            let state = if (from.radius - to.radius).abs() > 0.0 {
                self.bench
                    .at(from.radius + part * (to.radius - from.radius), work)
            } else {
                let way = to.indentation - from.indentation;
                self.bench
                    .with_radius(from.radius, from.indentation + part * way)
            };
            self.steps.push(step(branch, state.reached()));
        }
    }

    fn unload(&mut self, driver: Driver) -> Result<(), SolveError> {
        let receding = self.bench.system.adhesion().receding();
        let turn = self.turn;
        // The rim stays until the receding work of adhesion is reached.
        let start = self.bench.at(turn.radius, receding);
        if start.indentation < turn.indentation {
            self.record(Branch::Unloading, [turn, start], receding);
        }
        let end = if self.bench.system.is_punch() {
            start
        } else {
            let last = self.bench.detachment(driver, receding)?;
            if last < start.radius {
                let end = self.bench.at(last, receding);
                self.record(Branch::Unloading, [start, end], receding);
                end
            } else {
                start
            }
        };
        // The largest pull: at the smallest force, which under a prescribed force is the last contact.
        let pull = if self.bench.system.is_punch() {
            start
        } else {
            let last = self.bench.detachment(Driver::Force, receding)?;
            let radius = smaller(larger(last, end.radius), start.radius);
            self.bench.at(radius, receding)
        };
        self.pull_off = Some(pull);
        self.separation = Some(end.indentation);
        Ok(())
    }

    /// The curve with what closes it: the jump into contact from rest and the way after detachment. None under a prescribed force.
    fn closed(&self, plan: &CyclePlan, every: usize) -> Option<Vec<[f64; 2]>> {
        let compliance = match plan.drive {
            LoadingMode::Displacement => 0.0,
            LoadingMode::Machine(stiffness) => stiffness.recip(),
            LoadingMode::Force => return None,
        };
        self.separation?;
        let last = self.steps.last()?;
        let steps = self.steps.chunks(INTERVALS + 1);
        let of_branch = |steps: &[FlatLoadStep]| {
            let picked = steps.iter().step_by(every);
            picked
                .map(|step| [step.indentation, step.force])
                .collect::<Vec<_>>()
        };
        let mut curve = vec![[0.0, 0.0]];
        curve.extend(steps.flat_map(of_branch));
        curve.push([last.indentation + compliance * last.force, 0.0]);
        Some(curve)
    }

    fn cycle(self, fine: &Path<'_, '_>, plan: CyclePlan) -> Result<FlatCycle, SolveError> {
        let bench = self.bench;
        let [work, receding] = {
            let adhesion = bench.system.adhesion();
            [adhesion.work, adhesion.receding()]
        };
        let of = |state: &Settled, fine: &Settled, work: f64| {
            with_errors(bench.contact(state, work), fine, None).checked()
        };
        let curves = [1, 2].map(|every| self.closed(&plan, every));
        let [loop_area, coarse] = curves
            .each_ref()
            .map(|curve| curve.as_deref().map(enclosed));
        let area = loop_area
            .zip(coarse)
            .map(|(fine, coarse)| (4.0 * fine - coarse) / 3.0);
        let away = match loop_area.zip(area) {
            Some((fine, area)) => difference(fine, area, area.abs()),
            None => 0.0,
        };
        let pull_off = self.pull_off.as_ref().zip(fine.pull_off.as_ref());
        let pull_off = pull_off
            .map(|(state, fine)| of(state, fine, receding))
            .transpose()?;
        Ok(FlatCycle {
            jump: of(&self.jump, &fine.jump, work)?,
            turn: of(&self.turn, &fine.turn, work)?,
            pull_off,
            separation: self.separation,
            work_of_separation: self.closed(&plan, 1).map(|_| pulled(&self.steps)),
            loop_area: area,
            loop_area_error: away,
            interactions: *bench.system.interactions(),
            load_steps: self.steps,
            plan,
        })
    }
}

/// Area enclosed by a curve of indentation and force that is traversed clockwise: `∮F dδ`.
fn enclosed(curve: &[[f64; 2]]) -> f64 {
    let parts = curve.windows(2);
    parts
        .map(|pair| 0.5 * (pair[0][1] + pair[1][1]) * (pair[1][0] - pair[0][0]))
        .sum()
}

/// The tensile part of `∫F dδ` of the unloading.
fn pulled(steps: &[FlatLoadStep]) -> f64 {
    let unloading: Vec<&FlatLoadStep> = steps
        .iter()
        .filter(|step| step.branch == Branch::Unloading)
        .collect();
    let point = |step: &FlatLoadStep| [step.indentation, step.force];
    let part = |pair: &[&FlatLoadStep]| {
        let [_, tensile] = integral_and_negative_part([point(pair[0]), point(pair[1])]);
        tensile
    };
    unloading.windows(2).map(part).sum()
}
