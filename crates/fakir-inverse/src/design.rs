//! The inverse question: which pitch, height, diameter, lens radius or modulus gives a wanted
//! critical force, contact radius or pull-off force, or has the floor bear a wanted share of the force under a load.
//!
//! The answer is sought as a root of `g(x) = ln(answer(x)/wanted)` over `ln x`: bracketed by
//! strides that double, from where the homogenised lattice (a thousand times cheaper) has its
//! root, or from the value in the case file; then closed in on by the [bracketing method](fakir::numerics::roots)
//! that all searches share, which tells a root from a jump. Where the lens would sink in too far to
//! be solved the answer counts as too large; where it meets the floor first, as zero.
//!
//! A floor share begins at the transition with the power 3/2 of how far the lens is past it. So
//! `g(x) = (share(x)/wanted)^(2/3) - 1` is nearly straight there; before the transition, where the share is zero, it
//! goes on with the gap to the floor. The search starts where the homogenised lattice has its transition under the load. What cannot be
//! solved says nothing of the share there, and is an end of the range.
//!
//! A pull-off force is that of a whole cycle up to the critical state, which only tops that stick have and only the spectral method
//! solves: there is no estimate to begin with, and the range ends where a cycle has very many pillars. It is met to within its own
//! numerical error, as pillars that are held in part move in steps.

use fakir::numerics::convergence::{clamped, larger, within};
use fakir::numerics::roots::{self, Change, Point, Root};
use fakir::problem::{CyclePlan, Feature, Load, Method, Question};
use fakir::state::{ContactState, CriticalState, Cycle, Run, Solution, SolveError};
use fakir_case::unit::{Dimension, format_quantity};
use fakir_case::{Case, CaseError, CaseFile, Key};
use fakir_study::numbers::{DIGITS, LENGTH_DIGITS, digits, with_unit};
use fakir_study::result::control_words;
use std::ops::Bound;

/// What is wanted of the critical state, or of the contact under a load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wanted {
    /// Critical force `F_c`, N.
    Force(f64),
    /// Critical contact radius `a_c`, m.
    ContactRadius(f64),
    /// The part of the force that the floor bears.
    FloorShare {
        /// That part, more than 0 and less than 1.
        share: f64,
        /// Under this force or at this indentation.
        load: Load,
    },
    /// The largest pull on the way back from the critical state, N, as a positive number.
    PullOff(f64),
}

impl Wanted {
    /// The value: N, m, or a part of the force.
    #[must_use]
    pub fn value(self) -> f64 {
        match self {
            Self::Force(value)
            | Self::ContactRadius(value)
            | Self::PullOff(value)
            | Self::FloorShare { share: value, .. } => value,
        }
    }

    /// The same quantity of a contact. The share of a floor that is not touched is zero.
    #[must_use]
    pub fn of(self, reached: &Reached) -> f64 {
        match (self, reached) {
            (Self::PullOff(_), Reached::PulledOff(cycle)) => {
                let pull_off = cycle.pull_off.as_ref();
                pull_off.map_or(0.0, |pull_off| -pull_off.force)
            }
            (Self::Force(_) | Self::PullOff(_), _) => reached.contact().force,
            (Self::ContactRadius(_), Reached::Critical(critical)) => critical.contact_radius(),
            (Self::ContactRadius(_), _) => reached.contact().contact_radius,
            (Self::FloorShare { .. }, _) => {
                let floor = reached.contact().floor.as_ref();
                floor.map_or(0.0, |floor| floor.share)
            }
        }
    }

    /// What kind of number it is.
    #[must_use]
    pub fn dimension(self) -> Dimension {
        match self {
            Self::Force(_) | Self::PullOff(_) => Dimension::Force,
            Self::ContactRadius(_) => Dimension::Length,
            Self::FloorShare { .. } => Dimension::Fraction,
        }
    }

    /// The contact of which it is wanted in words: ` in the contact under a force of 1 mN`; nothing for the critical state.
    #[must_use]
    pub fn load_words(self) -> String {
        match self {
            Self::FloorShare { load, .. } => format!(" in the {}", control_words(load)),
            Self::Force(_) | Self::ContactRadius(_) | Self::PullOff(_) => String::new(),
        }
    }

    /// Whether it is a floor share.
    fn is_share(self) -> bool {
        matches!(self, Self::FloorShare { .. })
    }

    /// Whether it is a pull-off force.
    fn is_pull_off(self) -> bool {
        matches!(self, Self::PullOff(_))
    }

    /// Whether what cannot be solved says nothing of it, and whether it is known no better than its own error.
    fn is_coarse(self) -> bool {
        self.is_share() || self.is_pull_off()
    }

    /// How far a contact is from what is wanted: zero where it is met, positive where there is too much.
    fn excess(self, reached: &Reached) -> f64 {
        let ratio = self.of(reached) / self.value();
        if !self.is_share() {
            return ratio.ln();
        }
        match &reached.contact().floor {
            Some(_) => ratio.powf(SHARE_POWER) - 1.0,
            // A lens that is below the floor while that carries nothing is not nearer to the share.
            None => -1.0 - larger(reached.to_the_floor(), 0.0),
        }
    }

    /// By how much the excess of a contact may be wrong by the contact's own estimate, as far as it
    /// matters: critical states are known far better than samples can be made.
    fn excess_error(self, reached: &Reached) -> f64 {
        if let Reached::PulledOff(cycle) = reached {
            return cycle.errors.pull_off_force.numerical();
        }
        match &reached.contact().floor {
            Some(floor) if self.is_share() => {
                let slope = (self.of(reached) / self.value()).powf(SHARE_POWER) * SHARE_POWER;
                slope * floor.error.share
            }
            _ => 0.0,
        }
    }

    /// Its name in a sentence.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Force(_) => "critical force",
            Self::ContactRadius(_) => "critical contact radius",
            Self::FloorShare { .. } => "floor share",
            Self::PullOff(_) => "pull-off force",
        }
    }
}

/// The contact of which something is wanted.
#[derive(Debug, Clone)]
pub enum Reached {
    /// The critical state.
    Critical(CriticalState),
    /// The contact under the load for which a floor share is wanted.
    Pressed(ContactState),
    /// The cycle for whose pull-off force a value is wanted.
    PulledOff(Box<Cycle>),
}

impl Reached {
    /// The contact, critical or not; of a cycle that where the lens turns.
    #[must_use]
    pub fn contact(&self) -> &ContactState {
        match self {
            Self::Critical(critical) => &critical.contact,
            Self::Pressed(contact) => contact,
            Self::PulledOff(cycle) => &cycle.turn,
        }
    }

    /// Smallest gap between lens and floor over the height of the pillars.
    fn to_the_floor(&self) -> f64 {
        let contact = self.contact();
        contact.smallest_floor_gap / contact.system.pillar().height
    }

    fn solution(&self) -> &dyn Solution {
        match self {
            Self::PulledOff(cycle) => cycle.as_ref(),
            _ => self.contact(),
        }
    }

    /// Whether its numbers are an answer: the solution, and resolved.
    #[must_use]
    pub fn is_answer(&self) -> bool {
        self.solution().is_answer()
    }
}

/// A value of the free quantity and the contact it gives.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// Value of the free key, in SI units.
    pub value: f64,
    /// The case with this value.
    pub case: Case,
    /// Its critical state, its contact under the load, or its cycle.
    pub reached: Reached,
}

/// What came of a search.
#[derive(Debug, Clone)]
pub enum Design {
    /// A value that gives what is wanted, to within [`TOLERANCE`]; a floor share or pull-off force to within its own estimated error.
    Found {
        /// The value and its contact.
        candidate: Candidate,
        /// Relative change of the answer over that of the value, `d ln(answer)/d ln(x)`: how
        /// exactly the value has to be made. Near zero the answer hardly depends on it, and many
        /// values do.
        sensitivity: f64,
    },
    /// What is wanted lies in a jump of the answer: these are its two sides.
    Jump(Box<[Candidate; 2]>),
    /// No value gives it; this is the nearest, and why there is none nearer.
    OutOfReach {
        /// The nearest that can be had.
        nearest: Candidate,
        /// What stands in the way.
        limit: Limit,
        /// The least and the greatest that was found of a pull-off force, N.
        reach: Option<[f64; 2]>,
    },
}

/// Why an answer cannot come nearer to what is wanted.
#[derive(Debug, Clone, PartialEq)]
pub enum Limit {
    /// The free quantity is at the end of its range.
    Range,
    /// Beyond, no contact can be computed.
    Solver(SolveError),
    /// Beyond, the lens meets the floor before any pillar.
    FloorFirst,
    /// Beyond, so many pillars are in contact that a cycle takes too long.
    ManyPillars,
}

/// A question with its answer.
#[derive(Debug, Clone)]
pub struct Answer {
    /// The key that was sought.
    pub free: Key,
    /// What was wanted.
    pub wanted: Wanted,
    /// What came of it.
    pub design: Design,
}

/// Changes of the answer with the value below this hardly say which value it is.
const INSENSITIVE: f64 = 1e-3;

impl Answer {
    /// What was found, or comes nearest to it.
    #[must_use]
    pub fn nearest(&self) -> &Candidate {
        match &self.design {
            Design::Found { candidate, .. } => candidate,
            Design::OutOfReach { nearest, .. } => nearest,
            Design::Jump(sides) => {
                let away = |side: &Candidate| self.wanted.excess(&side.reached).abs();
                let [a, b] = sides.as_ref();
                if away(a) <= away(b) { a } else { b }
            }
        }
    }

    /// What kind of number the value is.
    #[must_use]
    pub fn dimension(&self) -> Dimension {
        self.free.dimension()
    }

    fn value(&self, candidate: &Candidate) -> String {
        with_unit(candidate.value, self.dimension(), 8)
    }

    /// What the candidate has of what is wanted, with the digits that are known of it.
    fn answer_of(&self, candidate: &Candidate) -> String {
        let floor = candidate.reached.contact().floor.as_ref();
        let digits = match self.wanted {
            Wanted::Force(_) => DIGITS,
            Wanted::ContactRadius(_) => LENGTH_DIGITS,
            Wanted::PullOff(_) => match &candidate.reached {
                Reached::PulledOff(cycle) => digits(cycle.errors.pull_off_force.numerical()),
                _ => 1,
            },
            Wanted::FloorShare { .. } => {
                floor.map_or(1, |floor| digits(floor.error.share).min(DIGITS))
            }
        };
        with_unit(
            self.wanted.of(&candidate.reached),
            self.wanted.dimension(),
            digits,
        )
    }

    fn wanted_words(&self) -> String {
        let dimension = self.wanted.dimension();
        match self.wanted {
            Wanted::Force(force) => with_unit(force, dimension, DIGITS),
            Wanted::ContactRadius(radius) => with_unit(radius, dimension, LENGTH_DIGITS),
            Wanted::PullOff(force) => format_quantity(force, dimension),
            Wanted::FloorShare { share, .. } => {
                let load = self.wanted.load_words();
                format!("{}{load}", format_quantity(share, dimension))
            }
        }
    }

    /// The answer in a sentence.
    #[must_use]
    pub fn statement(&self) -> String {
        let wanted = self.wanted_words();
        let (path, name) = (self.free.path(), self.wanted.name());
        let nearest = self.nearest();
        match &self.design {
            Design::Found { candidate, .. } => {
                format!(
                    "{path} = {} gives a {name} of {wanted}",
                    self.value(candidate)
                )
            }
            Design::Jump(sides) => {
                let [a, b] = sides.as_ref();
                format!(
                    "No {path} gives a {name} of {wanted}: at {} it jumps from {} to {}",
                    self.value(nearest),
                    self.answer_of(a),
                    self.answer_of(b)
                )
            }
            Design::OutOfReach { limit, reach, .. } => {
                let reach = reach.map_or(String::new(), |ends| {
                    let [least, greatest] = ends.map(|end| with_unit(end, Dimension::Force, 3));
                    format!("it is from {least} to {greatest}, and ")
                });
                let why = match limit {
                    Limit::Range => "which is as near as it comes".to_owned(),
                    Limit::FloorFirst => {
                        "beyond which the lens meets the floor before any pillar".to_owned()
                    }
                    Limit::Solver(error) => format!("beyond which {error}"),
                    Limit::ManyPillars => format!(
                        "beyond which the lens touches more than {MANY_PILLARS} pillars, whose cycles take too long"
                    ),
                };
                format!(
                    "No {path} gives a {name} of {wanted}: {reach}the nearest is {}, at {}, {why}",
                    self.answer_of(nearest),
                    self.value(nearest),
                )
            }
        }
    }

    /// What to be careful about: a value on which the answer hardly depends.
    #[must_use]
    pub fn caution(&self) -> Option<String> {
        match &self.design {
            Design::Found { sensitivity, .. } if sensitivity.abs() < INSENSITIVE => Some(format!(
                "the {} hardly depends on {} there: other values do as well",
                self.wanted.name(),
                self.free.path()
            )),
            _ => None,
        }
    }
}

/// Why there is no design.
#[derive(Debug, thiserror::Error)]
pub enum DesignError {
    /// A case that cannot be.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// No contact could be computed.
    #[error("{}", fakir_case::with_keys(.0))]
    Solve(#[from] SolveError),
    /// A key that cannot be sought.
    #[error("{} cannot be sought: give one of {}", .0.path(), free_names())]
    NotFree(Key),
    /// A wanted value that cannot be.
    #[error("the wanted {} must be greater than 0", .0.name())]
    NotPositive(Wanted),
    /// A floor share that cannot be.
    #[error("the wanted floor share must be greater than 0 and less than 1 (100 %): it is {0}")]
    NotAShare(f64),
    /// A floor share under no load, or one that cannot be.
    #[error(
        "a floor share is wanted at a load: give a force or an indentation that is a number greater than 0"
    )]
    NotALoad,
    /// A pull-off force of tops that do not stick.
    #[error(
        "a pull-off force needs pillar tops that stick: give adhesion.work in the case, as in adhesion.work = \"50 mJ/m2\""
    )]
    NoAdhesion,
    /// A case with so many pillars in contact that there is no cycle to begin with.
    #[error(
        "the lens touches more than {MANY_PILLARS} pillars, whose cycles take too long: begin with another {}", .0.path()
    )]
    TooManyPillars(Key),
    /// A solution that did not converge kept the search from its end.
    #[error(
        "the contact at {} = {value:e} (SI units) did not converge: try another accuracy \
         or an offset that is a little different", .key.path()
    )]
    NotConverged {
        /// The free key.
        key: Key,
        /// Its value.
        value: f64,
    },
}

/// Keys that can be sought: all sizes and moduli of a case with a texture, but no work of adhesion.
#[must_use]
pub fn free_keys() -> Vec<Key> {
    let keys = Key::ALL.into_iter();
    let is_made = |key: &Key| {
        let dimension = key.dimension();
        // Systems of this search have flat tops.
        key.is_positive()
            && ![Dimension::EnergyPerArea, Dimension::Angle].contains(&dimension)
            && *key != Key::TopRadius
    };
    keys.filter(|key| is_made(key) && !key.is_of_surface())
        .collect()
}

/// The key that can be sought of that path, or of that last name if only one has it.
///
/// # Errors
/// The paths of the keys that it may have been.
pub fn free_key(name: &str) -> Result<Key, String> {
    let mut named = free_keys();
    named.retain(|key| key.path() == name || key.name() == name);
    match named[..] {
        [key] => Ok(key),
        [] => Err(format!("give one of {}", free_names())),
        _ => {
            let paths: Vec<_> = named.iter().map(|key| key.path()).collect();
            Err(format!("give one of {}", paths.join(", ")))
        }
    }
}

fn free_names() -> String {
    let names: Vec<&str> = free_keys().into_iter().map(Key::path).collect();
    names.join(", ")
}

/// Relative difference from what is wanted at which a search ends.
pub const TOLERANCE: f64 = 1e-9;

/// Relative width of a bracket within which an answer that is still not met is a jump.
const JUMP: f64 = 1e-12;

/// The same of floor shares, which jump by their error where the grid on the floor changes, and of pull-off forces.
const COARSE_JUMP: f64 = 1e-7;

/// A floor share to this power is nearly straight in what is left of the load past the transition.
const SHARE_POWER: f64 = 2.0 / 3.0;

/// Part of the estimated error of a floor share or pull-off force to which it is met, unless it jumps by more.
const SHARPNESS: f64 = 0.1;

/// Relative width of a bracket that is narrow enough to say beyond which value there is no contact.
const EDGE: f64 = 1e-3;

/// Where the homogenised lattice has this many pillars in contact, it is within a few per cent, and
/// where it is farther from what is wanted than a factor of 2, that is all the search has to know.
const MANY_PILLARS: usize = 1000;
const CLEAR: f64 = std::f64::consts::LN_2;

/// First strides in `ln x`: from an estimate of the value, and from a mere guess.
const STRIDES: [f64; 2] = [0.02, 0.4];

/// Finds the value of `free` that gives what is wanted; everything else is as in the case file,
/// whose own value of `free`, if it has any, is where the search begins.
///
/// With a pitch in the case file the pitch stays as it is, with a surface fraction that.
///
/// # Errors
/// See [`DesignError`]. That there is no such value is not an error: see [`Design`].
pub fn design(
    file: &CaseFile,
    free: Key,
    wanted: Wanted,
    run: &Run<'_>,
) -> Result<Design, DesignError> {
    file.check_surface(&[Question::Design])?;
    if !free_keys().contains(&free) {
        return Err(DesignError::NotFree(free));
    }
    let target = wanted.value();
    if let Wanted::FloorShare { share, load } = wanted {
        if !(share > 0.0 && share < 1.0) {
            return Err(DesignError::NotAShare(share));
        }
        let (Load::Force(size) | Load::Indentation(size)) = load else {
            return Err(DesignError::NotALoad);
        };
        if !(size > 0.0 && size.is_finite()) {
            return Err(DesignError::NotALoad);
        }
    } else if !(target > 0.0 && target.is_finite()) {
        return Err(DesignError::NotPositive(wanted));
    }
    let first = first_value(file, free)?;
    let case = with(file, free, first)?;
    if wanted.is_pull_off() && case.system.adhesion().is_none() {
        return Err(DesignError::NoAdhesion);
    }
    let asked = match wanted.is_share() {
        true => &[Question::FloorShare, Question::Design][..],
        false => &[Question::Design],
    };
    let features = Feature::of(&case.system);
    for question in asked {
        let answered = question.check(case.method.into(), &features);
        answered.map_err(SolveError::from)?;
    }
    let mut search = Search {
        file,
        free,
        wanted,
        run,
        range: range(free, first, &case),
        method: Some(Method::Homogenised),
    };
    let estimate = if wanted.is_pull_off() {
        // The homogenised lattice has no adhesion.
        None
    } else {
        search.estimate(first)?
    };
    search.method = None;
    let ending = match estimate {
        Some(value) => match search.find(value, STRIDES[0]) {
            Err(DesignError::Solve(error))
                if wanted.is_share() && error != SolveError::Interrupted =>
            {
                search.find(first, STRIDES[1])?
            }
            ending => ending?,
        },
        None => search.find(first, STRIDES[1])?,
    };
    Ok(match ending {
        Ending::Found(candidate) => Design::Found {
            sensitivity: search.sensitivity(&candidate)?,
            candidate,
        },
        Ending::Jump(sides) => Design::Jump(sides),
        Ending::OutOfReach(nearest, limit, reach) => Design::OutOfReach {
            nearest: search.exactly(nearest)?,
            limit,
            reach: reach.filter(|_| wanted.is_pull_off()),
        },
    })
}

/// How a search ends.
enum Ending {
    Found(Candidate),
    Jump(Box<[Candidate; 2]>),
    /// The nearest, what limits it, and the least and the greatest answer, if the whole range was searched.
    OutOfReach(Candidate, Limit, Option<[f64; 2]>),
}

/// The case with a key set to a value in SI units.
pub(crate) fn with(file: &CaseFile, key: Key, value: f64) -> Result<Case, CaseError> {
    let mut file = file.clone();
    file.set_number(key, value);
    file.case()
}

/// Where to begin: the value in the case file, or one in proportion to the others.
fn first_value(file: &CaseFile, free: Key) -> Result<f64, DesignError> {
    let case = file.case();
    let given = case.as_ref().ok().and_then(|case| case.number(free));
    if let Some(value) = given {
        return Ok(value);
    }
    if let (Ok(case), Key::SubstrateThickness | Key::LensThickness) = (&case, free) {
        // A half-space is thicker than the lens is wide.
        return Ok(widest(case));
    }
    // It may be just the free key that is missing.
    let guess = GUESSES
        .iter()
        .find(|guess| with(file, free, **guess).is_ok());
    match (guess, case) {
        (Some(guess), _) => Ok(*guess),
        (None, Err(error)) => Err(error.into()),
        (None, Ok(_)) => {
            with(file, free, GUESSES[0])?;
            Err(DesignError::NotFree(free))
        }
    }
}

/// Values, in SI units, one of which is within reach of any quantity of a texture.
const GUESSES: [f64; 9] = [1e6, 0.1, 1e-3, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 1e-7];

/// Values between which a free quantity is sought: all that are allowed, as far as a factor of a million from the first.
fn range(free: Key, first: f64, case: &Case) -> [f64; 2] {
    const FARTHEST: f64 = 1e6;
    /// Beyond so many widths of the lens nothing is known of a thickness.
    const THICKEST: f64 = 1e3;
    /// Relative distance from an end of the range that is not allowed itself.
    const MARGIN: f64 = 1e-3;
    let (least, greatest) = case.allowed(free);
    let least = match least {
        Bound::Included(least) => least,
        Bound::Excluded(least) if least > 0.0 => least * (1.0 + MARGIN),
        Bound::Excluded(_) | Bound::Unbounded => first / FARTHEST,
    };
    let greatest = match greatest {
        Bound::Included(greatest) => greatest,
        Bound::Excluded(greatest) => greatest * (1.0 - MARGIN),
        Bound::Unbounded => first * FARTHEST,
    };
    // Pillars as wide as the lens, or as far apart, are no texture.
    let widest = widest(case);
    match free {
        Key::SubstrateThickness | Key::LensThickness => {
            [least, greatest.min(THICKEST * widest).max(first)]
        }
        Key::Pitch | Key::PillarDiameter => [least, greatest.min(widest.max(first))],
        Key::SurfaceFraction => {
            let part = case.system.pillar().diameter / widest;
            [(greatest * part * part).min(first), greatest]
        }
        _ => [least, greatest],
    }
}

/// How wide the lens is, m.
fn widest(case: &Case) -> f64 {
    /// Of a plate, which is as wide as it likes.
    const LARGEST_PITCHES: f64 = 1e6;
    let widest = case.system.lens().widest();
    widest.min(LARGEST_PITCHES * case.system.pitch())
}

struct Search<'a> {
    file: &'a CaseFile,
    free: Key,
    wanted: Wanted,
    run: &'a Run<'a>,
    range: [f64; 2],
    /// The method that solves the trials instead of that of the case.
    method: Option<Method>,
}

/// The contact at one value.
#[derive(Clone)]
struct Trial {
    /// The logarithm of the value, `ln x`.
    position: f64,
    outcome: Result<Candidate, Limit>,
    /// How far it is from what is wanted: infinite where there is no contact.
    excess: f64,
    /// By how much the excess may be wrong.
    error: f64,
}

impl Trial {
    fn is_met(&self) -> bool {
        within(self.excess.abs(), TOLERANCE.max(SHARPNESS * self.error))
    }

    /// Whether it may be what is wanted, as far as it is known itself.
    fn may_be_met(&self) -> bool {
        within(self.excess.abs(), TOLERANCE.max(self.error))
    }

    /// For the search of roots: what meets the wanted value is a root.
    fn point(&self) -> Point {
        Point {
            position: self.position,
            value: if self.is_met() { 0.0 } else { self.excess },
        }
    }

    fn limit(&self) -> Limit {
        match &self.outcome {
            Err(limit) => limit.clone(),
            Ok(candidate) if candidate.reached.contact().force <= 0.0 => Limit::FloorFirst,
            Ok(_) => Limit::Range,
        }
    }
}

/// A search between the ends of the range that found the wanted value nowhere.
struct Missed {
    trials: Vec<Trial>,
    /// Where no floor share can be computed, right beyond the last trials downwards and upwards.
    unsolved: [Option<Trial>; 2],
}

/// Why there is no contact where one is needed.
fn no_contact(limit: Limit, key: Key) -> DesignError {
    match limit {
        Limit::Solver(error) => error.into(),
        _ => DesignError::TooManyPillars(key),
    }
}

impl Search<'_> {
    /// The value that the homogenised lattice gives, if it gives any.
    fn estimate(&self, first: f64) -> Result<Option<f64>, DesignError> {
        match self.find(first, STRIDES[1]) {
            Ok(Ending::Found(candidate) | Ending::OutOfReach(candidate, ..)) => {
                Ok(Some(candidate.value))
            }
            Err(DesignError::Solve(SolveError::Interrupted)) => Err(SolveError::Interrupted.into()),
            _ => Ok(None),
        }
    }

    fn trial(&self, position: f64) -> Result<Trial, DesignError> {
        let value = clamped(position.exp(), self.range[0], self.range[1]);
        if self.method.is_none()
            && !self.wanted.is_coarse()
            && let Ok(outline) = self.trial_by(Some(Method::Homogenised), value)
            && self.is_clear(&outline, value)?
        {
            return Ok(Trial {
                position,
                ..outline
            });
        }
        let trial = self.trial_by(self.method, value)?;
        Ok(Trial { position, ..trial })
    }

    /// Whether an answer by the homogenised lattice is all that the search has to know.
    fn is_clear(&self, outline: &Trial, value: f64) -> Result<bool, DesignError> {
        Ok(match &outline.outcome {
            Ok(candidate) => {
                let pillars = candidate.reached.contact().pillars_in_contact;
                pillars > MANY_PILLARS && outline.excess.abs() > CLEAR
            }
            // With that many pillars it knows the contact radius to a per cent.
            Err(Limit::Solver(SolveError::ContactExceedsLens { lens_radius, .. })) => {
                let case = with(self.file, self.free, value)?;
                let widest = 0.5 * lens_radius / case.system.pitch();
                widest * widest > MANY_PILLARS as f64
            }
            Err(_) => false,
        })
    }

    fn trial_by(&self, method: Option<Method>, value: f64) -> Result<Trial, DesignError> {
        let mut case = with(self.file, self.free, value)?;
        if let Some(method) = method {
            case.method = method;
        }
        if self.wanted.is_pull_off() && self.has_many_pillars(&case)? {
            return Ok(Trial {
                position: value.ln(),
                outcome: Err(Limit::ManyPillars),
                excess: f64::INFINITY,
                error: 0.0,
            });
        }
        let reached = match self.wanted {
            Wanted::FloorShare { load, .. } => {
                fakir::press(&case.system, load, case.method, self.run).map(Reached::Pressed)
            }
            Wanted::PullOff(_) => {
                fakir::cycle(&case.system, CyclePlan::default(), case.method, self.run)
                    .map(|cycle| Reached::PulledOff(Box::new(cycle)))
            }
            _ => fakir::transition(&case.system, case.method, self.run).map(Reached::Critical),
        };
        let outcome = match reached {
            Ok(reached) if !reached.solution().converged() => {
                return Err(DesignError::NotConverged {
                    key: self.free,
                    value,
                });
            }
            Ok(reached) => Ok(Candidate {
                value,
                case,
                reached,
            }),
            Err(
                error @ (SolveError::ContactExceedsLens { .. }
                | SolveError::ProfileEnds { .. }
                | SolveError::TooLarge { .. }
                | SolveError::TextureTooDense { .. }),
            ) => Err(Limit::Solver(error)),
            // The grid on the floor of wide lattices.
            Err(error @ SolveError::TooManyCells { .. }) if self.wanted.is_share() => {
                Err(Limit::Solver(error))
            }
            Err(error) => return Err(error.into()),
        };
        let (excess, error) = match &outcome {
            // A method without a floor finds the transition, where the share begins.
            Ok(candidate) if self.wanted.is_share() && method.is_some() => {
                (-candidate.reached.to_the_floor(), 0.0)
            }
            Ok(candidate) => (
                self.wanted.excess(&candidate.reached),
                self.wanted.excess_error(&candidate.reached),
            ),
            Err(_) => (f64::INFINITY, 0.0),
        };
        Ok(Trial {
            position: value.ln(),
            outcome,
            excess,
            error,
        })
    }

    /// Whether, by the homogenised lattice, so many pillars are in contact at the transition that a cycle takes too long.
    fn has_many_pillars(&self, case: &Case) -> Result<bool, DesignError> {
        let system = case.system.without_adhesion();
        match fakir::transition(&system, Method::Homogenised, self.run) {
            Ok(critical) => Ok(critical.contact.pillars_in_contact > MANY_PILLARS),
            Err(SolveError::Interrupted) => Err(SolveError::Interrupted.into()),
            // Whether the contact can be solved is for the method of the case to say.
            Err(_) => Ok(false),
        }
    }

    /// The candidate by the method of the case, where an estimate did for the search. Where the
    /// contact is a little wider than estimated and no longer solved, one nearby.
    fn exactly(&self, candidate: Candidate) -> Result<Candidate, DesignError> {
        if candidate.case.method == with(self.file, self.free, candidate.value)?.method {
            return Ok(candidate);
        }
        let mut failure = None;
        for shift in [0.0, -EDGE, EDGE, -10.0 * EDGE, 10.0 * EDGE] {
            let value = candidate.value * (1.0 + shift);
            if !(self.range[0]..=self.range[1]).contains(&value) {
                continue;
            }
            match self.trial_by(None, value)?.outcome {
                Ok(candidate) => return Ok(candidate),
                Err(Limit::Solver(
                    error
                    @ (SolveError::ContactExceedsLens { .. } | SolveError::ProfileEnds { .. }),
                )) => {
                    failure = Some(error);
                }
                Err(limit) => return Err(no_contact(limit, self.free)),
            }
        }
        Err(failure.map_or(DesignError::NotPositive(self.wanted), DesignError::Solve))
    }

    fn find(&self, first: f64, stride: f64) -> Result<Ending, DesignError> {
        let start = self.trial(clamped(first, self.range[0], self.range[1]).ln())?;
        if start.is_met()
            && let Ok(candidate) = start.outcome
        {
            return Ok(Ending::Found(candidate));
        }
        if self.wanted.is_coarse()
            && let Err(limit) = start.outcome
        {
            return Err(no_contact(limit, self.free));
        }
        match self.bracket(start, stride)? {
            Ok(bracket) => self.close_in(bracket),
            Err(missed) => self.nearest(missed),
        }
    }

    /// Two neighbouring trials with the wanted value between them; or, if there are none, all
    /// the trials between the ends of the range.
    fn bracket(
        &self,
        start: Trial,
        stride: f64,
    ) -> Result<Result<[Trial; 2], Missed>, DesignError> {
        let ends = self.range.map(f64::ln);
        let mut trials = vec![start.clone()];
        let mut fronts = [start.clone(), start]; // downwards and upwards
        let mut strides = [stride; 2];
        let mut unsolved: [Option<Trial>; 2] = [None, None];
        let side_done = |fronts: &[Trial; 2], unsolved: &[Option<Trial>; 2], side: usize| {
            let front = fronts[side].position;
            match (&unsolved[side], side) {
                (Some(beyond), _) => (beyond.position - front).abs() < EDGE,
                (None, 0) => front <= ends[0],
                (None, _) => front >= ends[1],
            }
        };
        // Upwards first; then whichever front is nearer to what is wanted.
        let mut side = 1;
        while !(side_done(&fronts, &unsolved, 0) && side_done(&fronts, &unsolved, 1)) {
            if side_done(&fronts, &unsolved, side) {
                side = 1 - side;
            }
            let front = fronts[side].position;
            let next = match &unsolved[side] {
                Some(beyond) => f64::midpoint(front, beyond.position),
                None => {
                    let sign = if side == 1 { 1.0 } else { -1.0 };
                    clamped(front + sign * strides[side], ends[0], ends[1])
                }
            };
            strides[side] *= 2.0;
            let trial = self.trial(next)?;
            // What cannot be solved has no floor share or pull-off: the range ends before it.
            if self.wanted.is_coarse() && trial.outcome.is_err() {
                unsolved[side] = Some(trial);
                continue;
            }
            if trial.excess.signum() != fronts[side].excess.signum() || trial.is_met() {
                let mut bracket = [fronts[side].clone(), trial];
                if side == 0 {
                    bracket.reverse();
                }
                return Ok(Ok(bracket));
            }
            trials.push(trial.clone());
            let nearer = trial.excess.abs() < fronts[side].excess.abs();
            fronts[side] = trial;
            if !nearer {
                side = 1 - side;
            }
        }
        Ok(Err(Missed { trials, unsolved }))
    }

    /// Closes in on the wanted value between two trials. Where contacts end, a rough search is enough; between
    /// two values it goes on.
    fn close_in(&self, mut sides: [Trial; 2]) -> Result<Ending, DesignError> {
        let mut root = self.narrow(&mut sides, EDGE)?;
        if sides.iter().all(|trial| trial.excess.is_finite()) {
            let width = if self.wanted.is_coarse() {
                COARSE_JUMP
            } else {
                JUMP
            };
            root = self.narrow(&mut sides, width)?;
        }
        if let Some(Change::Crossing(_)) = root.map(|root| root.change(TOLERANCE))
            && let Some(met) = sides.iter().find(|side| side.is_met())
            && let Ok(candidate) = &met.outcome
        {
            return Ok(Ending::Found(candidate.clone()));
        }
        let nearer = usize::from(sides[1].excess.abs() < sides[0].excess.abs());
        if sides[nearer].may_be_met()
            && let Ok(candidate) = &sides[nearer].outcome
        {
            return Ok(Ending::Found(candidate.clone()));
        }
        self.edge(&sides)
    }

    /// Moves two trials on either side of the wanted value together, until their values differ by this part of them or
    /// one of them meets it.
    fn narrow(&self, sides: &mut [Trial; 2], width: f64) -> Result<Option<Root>, DesignError> {
        let ends = [sides[0].point(), sides[1].point()];
        let size = ends[0].position.abs().max(ends[1].position.abs());
        roots::find(ends, width / size, |position| {
            let trial = self.trial(position)?;
            let point = trial.point();
            let side = usize::from((point.value > 0.0) == (sides[1].excess > 0.0));
            sides[side] = trial;
            Ok(point.value)
        })
    }

    /// The outcome where a bracket has become narrow and the wanted value is not in it.
    fn edge(&self, [low, high]: &[Trial; 2]) -> Result<Ending, DesignError> {
        match (low.outcome.clone(), high.outcome.clone()) {
            (Ok(a), Ok(b)) if low.excess.is_finite() && high.excess.is_finite() => {
                Ok(Ending::Jump(Box::new([a, b])))
            }
            (Ok(nearest), _) if low.excess.is_finite() => {
                Ok(Ending::OutOfReach(nearest, high.limit(), None))
            }
            (_, Ok(nearest)) => Ok(Ending::OutOfReach(nearest, low.limit(), None)),
            (_, Err(limit)) => Err(no_contact(limit, self.free)),
        }
    }

    /// The outcome where the wanted value is on one side of all trials: the nearest, sought
    /// between the neighbours of the nearest trial.
    fn nearest(&self, missed: Missed) -> Result<Ending, DesignError> {
        let Missed {
            mut trials,
            unsolved,
        } = missed;
        trials.sort_by(|a, b| a.position.total_cmp(&b.position));
        let answers = trials
            .iter()
            .filter_map(|trial| trial.outcome.as_ref().ok());
        let answers = answers.map(|candidate| self.wanted.of(&candidate.reached));
        let (least, greatest) = answers
            .fold((f64::INFINITY, 0.0f64), |(least, greatest), answer| {
                (least.min(answer), greatest.max(answer))
            });
        let farness = |trial: &Trial| trial.excess.abs();
        let Some(best) =
            (0..trials.len()).min_by(|a, b| farness(&trials[*a]).total_cmp(&farness(&trials[*b])))
        else {
            return Err(DesignError::NotPositive(self.wanted));
        };
        let last = trials.len() - 1;
        let (mut low, mut high) = (
            trials[best.saturating_sub(1)].clone(),
            trials[(best + 1).min(last)].clone(),
        );
        let mut best = trials[best].clone();
        while high.position - low.position > EDGE {
            // The larger of the two gaps, by the golden section.
            let (gaps, golden) = (
                [best.position - low.position, high.position - best.position],
                0.381_966,
            );
            let position = if gaps[1] > gaps[0] {
                best.position + golden * gaps[1]
            } else {
                best.position - golden * gaps[0]
            };
            let trial = self.trial(position)?;
            if trial.excess.signum() != best.excess.signum() {
                let mut bracket = [best, trial];
                bracket.sort_by(|a, b| a.position.total_cmp(&b.position));
                return self.close_in(bracket);
            }
            let (inner, outer) = if farness(&trial) < farness(&best) {
                (trial, best)
            } else {
                (best, trial)
            };
            if outer.position < inner.position {
                low = outer;
            } else {
                high = outer;
            };
            best = inner;
        }
        let mut unsolved = unsolved.iter().flatten();
        let beyond = unsolved.find(|trial| (trial.position - best.position).abs() < 2.0 * EDGE);
        let limit = beyond.map_or(Limit::Range, Trial::limit);
        match best.outcome {
            Ok(candidate) => {
                let answer = self.wanted.of(&candidate.reached);
                let reach = [least.min(answer), greatest.max(answer)];
                Ok(Ending::OutOfReach(candidate, limit, Some(reach)))
            }
            Err(limit) => Err(no_contact(limit, self.free)),
        }
    }

    /// The sensitivity `d ln(answer)/d ln(x)` by a central difference.
    fn sensitivity(&self, found: &Candidate) -> Result<f64, DesignError> {
        // Floor shares and pull-off forces are known to fewer digits: a longer step leaves more of their difference.
        let step = if self.wanted.is_coarse() { 1e-2 } else { 1e-3 };
        let middle = found.value.ln();
        let sides = [self.trial(middle - step)?, self.trial(middle + step)?];
        let logarithms = sides.map(|trial| {
            let candidate = trial.outcome.ok()?;
            let answer = self.wanted.of(&candidate.reached) / self.wanted.value();
            (answer > 0.0).then(|| (candidate.value.ln(), answer.ln()))
        });
        Ok(match logarithms {
            [Some(low), Some(high)] if high.0 > low.0 => (high.1 - low.1) / (high.0 - low.0),
            _ => f64::NAN,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper(surface_fraction: f64) -> CaseFile {
        let mut file = CaseFile::parse("paper", &Case::example().to_toml()).unwrap();
        file.set_number(Key::SurfaceFraction, surface_fraction);
        file
    }

    /// The same as a rectangular lattice, which has a second pitch.
    fn rectangular(surface_fraction: f64) -> CaseFile {
        let mut file = paper(surface_fraction);
        let pitch = file.case().unwrap().system.pitch();
        file.set("texture.lattice=rectangular").unwrap();
        file.set_number(Key::Pitch, pitch);
        file.set_number(Key::PitchY, 1.1 * pitch);
        file
    }

    /// Takes the critical force of a case, forgets one quantity, finds it again.
    #[test]
    fn every_free_quantity_is_found_again() {
        let run = Run::default();
        for surface_fraction in [1e-3, 0.05] {
            let by_pitch = {
                let case = paper(surface_fraction).case().unwrap();
                let mut file = paper(surface_fraction);
                file.set_number(Key::Pitch, case.system.pitch());
                file
            };
            for free in free_keys().into_iter().filter(|key| !key.is_of_layers()) {
                let file = match free {
                    Key::SurfaceFraction => paper(surface_fraction),
                    Key::PitchY => rectangular(surface_fraction),
                    _ => by_pitch.clone(),
                };
                let case = file.case().unwrap();
                let truth = file.given(free).unwrap().unwrap();
                let critical = fakir::transition(&case.system, case.method, &run).unwrap();
                let mut other = file.clone();
                other.set_number(free, truth * 0.7);
                let wanted = Wanted::Force(critical.contact.force);
                let Design::Found {
                    candidate: found,
                    sensitivity,
                } = design(&other, free, wanted, &run).unwrap()
                else {
                    panic!("{} at {surface_fraction}", free.path());
                };
                // A lone pillar hardly knows the pitch.
                let alone = critical.contact.pillars_in_contact == 1;
                if alone && [Key::Pitch, Key::PitchY, Key::SurfaceFraction].contains(&free) {
                    assert!(sensitivity.abs() < 0.1);
                } else {
                    let error = (found.value / truth - 1.0).abs();
                    assert!(error < 1e-6, "{}: {error:e}", free.path());
                }
                // The case as it is written down gives the wanted force.
                let written = CaseFile::parse("found", &found.case.to_toml())
                    .unwrap()
                    .case()
                    .unwrap();
                assert_eq!(
                    written.number(free).map(f64::to_bits),
                    Some(found.value.to_bits())
                );
                let again = fakir::transition(&written.system, written.method, &run).unwrap();
                assert!((again.contact.force / critical.contact.force - 1.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn a_contact_radius_can_be_wanted_and_a_key_be_missing() {
        let text = Case::example().to_toml();
        let without: String = text
            .lines()
            .filter(|line| !line.starts_with("surface_fraction"))
            .map(|line| format!("{line}\n"))
            .collect();
        let file = CaseFile::parse("without", &without).unwrap();
        let run = Run::default();
        let wanted = Wanted::ContactRadius(100e-6);
        match design(&file, Key::Pitch, wanted, &run).unwrap() {
            Design::Found {
                candidate: found, ..
            } => {
                let radius = wanted.of(&found.reached);
                assert!((radius / 100e-6 - 1.0).abs() < 2.0 * TOLERANCE);
            }
            // The contact radius jumps where the next pillars are touched.
            Design::Jump(sides) => {
                let [a, b] = sides.map(|side| wanted.of(&side.reached));
                assert!((a - 100e-6) * (b - 100e-6) < 0.0);
            }
            Design::OutOfReach { .. } => panic!("100 um can be had"),
        }
    }

    /// However wide the pitch, one pillar under the axis bears something: less cannot be had.
    #[test]
    fn what_cannot_be_had_is_answered_with_the_nearest() {
        let run = Run::default();
        // A small lens, which pillars side by side do not carry far.
        let mut file = paper(0.01);
        file.set_number(Key::LensRadius, 3e-4);
        let forces: Vec<f64> = (0..40)
            .filter_map(|k| {
                let case = with(&file, Key::Pitch, 6e-6 * 1.1f64.powi(k)).unwrap();
                fakir::transition(&case.system, case.method, &run).ok()
            })
            .map(|critical| critical.contact.force)
            .collect();
        let least = forces.iter().copied().fold(f64::INFINITY, f64::min);
        let wanted = Wanted::Force(0.5 * least);
        let Design::OutOfReach { nearest, limit, .. } =
            design(&file, Key::Pitch, wanted, &run).unwrap()
        else {
            panic!("half the least force cannot be had");
        };
        assert_eq!(limit, Limit::Range);
        let force = nearest.reached.contact().force;
        assert!(force < least * 1.001 && force > 0.9 * least);
    }

    fn found(file: &CaseFile, free: Key, wanted: Wanted) -> Candidate {
        match design(file, free, wanted, &Run::default()).unwrap() {
            Design::Found { candidate, .. } => candidate,
            other => panic!("{wanted:?} can be had, but: {other:?}"),
        }
    }

    /// The case as it is written down, pressed again, has the wanted share to within the error that it states itself.
    #[test]
    #[ignore = "slow: searches with mixed contact"]
    fn a_floor_share_is_had_by_the_case_that_is_found() {
        let run = Run::default();
        for (free, share, load) in [
            (Key::Pitch, 0.2, Load::Force(1e-3)),
            (Key::SurfaceFraction, 0.002, Load::Force(1e-3)),
            (Key::PillarHeight, 0.05, Load::Indentation(8e-6)),
            (Key::LensRadius, 0.5, Load::Indentation(12e-6)),
            (Key::SubstrateYoungModulus, 0.1, Load::Force(1e-3)),
        ] {
            let candidate = found(&paper(0.03), free, Wanted::FloorShare { share, load });
            let written = CaseFile::parse("found", &candidate.case.to_toml()).unwrap();
            let case = written.case().unwrap();
            assert_eq!(
                case.number(free).map(f64::to_bits),
                Some(candidate.value.to_bits())
            );
            let again = fakir::press(&case.system, load, case.method, &run).unwrap();
            let floor = again.floor.unwrap();
            let off = (floor.share / share - 1.0).abs();
            assert!(
                off <= floor.error.share,
                "{free}: {off:e}, known to {:e}",
                floor.error.share
            );
            // An estimate of no value would meet anything.
            assert!(floor.error.share < 0.05, "{free}: {:e}", floor.error.share);
        }
    }

    /// Pillars farther apart bear less of the same force. The smallest share is hardly past the transition: there the
    /// pitch is nearly that of a critical force equal to the load.
    #[test]
    #[ignore = "slow: searches with mixed contact"]
    fn a_larger_floor_share_takes_a_wider_pitch() {
        let load = 1e-3;
        let critical = found(&paper(0.03), Key::Pitch, Wanted::Force(load)).value;
        let mut last = critical;
        for share in [1e-5, 0.01, 0.1, 0.5, 0.9] {
            let load = Load::Force(load);
            let wanted = Wanted::FloorShare { share, load };
            let pitch = found(&paper(0.03), Key::Pitch, wanted).value;
            assert!(pitch > last, "{share}: {pitch:e} after {last:e}");
            last = pitch;
            if share < 1e-4 {
                assert!(
                    (pitch / critical - 1.0).abs() < 0.01,
                    "{pitch:e}, {critical:e}"
                );
            }
        }
    }

    /// What was found is an answer only if its numbers are resolved.
    #[test]
    fn a_contact_that_is_not_resolved_is_no_answer() {
        let case = paper(0.01).case().unwrap();
        let load = Load::Indentation(1e-6);
        let mut contact = fakir::press(&case.system, load, case.method, &Run::default()).unwrap();
        assert!(Reached::Pressed(contact.clone()).is_answer());
        contact.error.force = 0.6;
        assert!(!Reached::Pressed(contact).is_answer());
    }

    /// All lengths a thousand times as large with a force a million times as large are the same contact.
    #[test]
    fn a_floor_share_knows_no_scale() {
        const TIMES: f64 = 1000.0;
        let small = paper(0.03);
        let mut large = small.clone();
        let case = small.case().unwrap();
        for key in [Key::LensRadius, Key::PillarDiameter, Key::PillarHeight] {
            large.set_number(key, TIMES * case.number(key).unwrap());
        }
        let of = |force: f64| Wanted::FloorShare {
            share: 0.1,
            load: Load::Force(force),
        };
        let [small, large] = [
            found(&small, Key::Pitch, of(1e-3)),
            found(&large, Key::Pitch, of(1e-3 * TIMES * TIMES)),
        ];
        // The share is known to 1e-3 of itself, and changes five times as fast as the pitch.
        let ratio = large.value / small.value / TIMES;
        assert!((ratio - 1.0).abs() < 1e-4, "{ratio}");
    }

    /// With pillars that do not shorten, the contact at an indentation is the same by any modulus, up to a factor of all forces.
    #[test]
    #[ignore = "slow: searches with mixed contact"]
    fn a_floor_share_that_cannot_be_had_is_answered_with_the_nearest() {
        let text = Case::example().to_toml().replace("\"column\"", "\"none\"");
        let mut file = CaseFile::parse("rigid", &text).unwrap();
        file.set_number(Key::SurfaceFraction, 0.03);
        let (run, load) = (Run::default(), Load::Indentation(8e-6));
        let case = file.case().unwrap();
        let pressed = fakir::press(&case.system, load, case.method, &run).unwrap();
        let floor = pressed.floor.unwrap();
        for share in [0.5 * floor.share, 2.0 * floor.share] {
            let wanted = Wanted::FloorShare { share, load };
            let free = Key::LensYoungModulus;
            let Design::OutOfReach { nearest, limit, .. } =
                design(&file, free, wanted, &run).unwrap()
            else {
                panic!("the modulus cannot change the share");
            };
            assert_eq!(limit, Limit::Range);
            let off = (wanted.of(&nearest.reached) / floor.share - 1.0).abs();
            assert!(off <= floor.error.share, "{off:e}");
        }
    }

    #[test]
    fn a_floor_share_that_makes_no_sense_is_refused() {
        let refused = |file: &CaseFile, share: f64, load: Load| {
            let wanted = Wanted::FloorShare { share, load };
            design(file, Key::Pitch, wanted, &Run::default())
                .unwrap_err()
                .to_string()
        };
        let file = paper(0.03);
        for share in [0.0, 1.0, -0.1, 20.0, f64::NAN] {
            let told = refused(&file, share, Load::Force(1e-3));
            assert!(told.contains("greater than 0 and less than 1"), "{told}");
        }
        let infinite = Load::Indentation(f64::INFINITY);
        for load in [Load::FloorContact, Load::Force(0.0), infinite] {
            let told = refused(&file, 0.2, load);
            assert!(told.contains("give a force or an indentation"), "{told}");
        }
        let mut other = file.case().unwrap();
        other.method = Method::Homogenised;
        let other = CaseFile::parse("homogenised", &other.to_toml()).unwrap();
        let told = refused(&other, 0.2, Load::Force(1e-3));
        assert!(told.contains("this method leaves the floor out"), "{told}");
        let mut ignored = file.case().unwrap();
        ignored.system = ignored
            .system
            .with_floor(fakir::problem::FloorModel::Ignored);
        let ignored = ignored.to_toml();
        let ignored = CaseFile::parse("ignored", &ignored).unwrap();
        let told = refused(&ignored, 0.2, Load::Force(1e-3));
        assert!(told.contains("the floor is ignored"), "{told}");
    }

    /// The cycle of the case as it is written down has the wanted pull-off force to within its own numerical error.
    #[test]
    fn a_pull_off_force_is_had_by_the_case_that_is_found() {
        let mut file = paper(0.02);
        file.set("adhesion.work=50mJ/m2").unwrap();
        let force = 40e-6;
        for free in [Key::Pitch, Key::SubstrateYoungModulus] {
            let candidate = found(&file, free, Wanted::PullOff(force));
            let written = CaseFile::parse("found", &candidate.case.to_toml()).unwrap();
            let case = written.case().unwrap();
            let plan = CyclePlan::default();
            let cycle = fakir::cycle(&case.system, plan, case.method, &Run::default()).unwrap();
            let pull_off = cycle.pull_off.as_ref().unwrap();
            let off = (-pull_off.force / force - 1.0).abs();
            assert!(
                off <= cycle.errors.pull_off_force.numerical(),
                "{free}: {off:e}"
            );
        }
    }

    #[test]
    fn a_pull_off_force_that_cannot_be_had_is_answered_with_the_range() {
        let run = Run::default();
        let file = paper(0.005);
        let refused = design(&file, Key::PillarHeight, Wanted::PullOff(1e-6), &run);
        assert!(matches!(refused, Err(DesignError::NoAdhesion)));
        let mut sticky = file.clone();
        sticky.set("adhesion.work=50mJ/m2").unwrap();
        // Of stiffer and stiffer pillars on a soft lens the pull-off force does not grow any more.
        let free = Key::SubstrateYoungModulus;
        let wanted = Wanted::PullOff(1.0);
        let answer = Answer {
            free,
            wanted,
            design: design(&sticky, free, wanted, &run).unwrap(),
        };
        let Design::OutOfReach { nearest, reach, .. } = &answer.design else {
            panic!("1 N cannot be had: {answer:?}");
        };
        let [least, greatest] = reach.unwrap();
        let nearest = wanted.of(&nearest.reached);
        assert!(0.0 < least && least < greatest && nearest <= greatest && greatest < 1.0);
        assert!(nearest > 0.99 * greatest, "{nearest:e} of {greatest:e}");
        let told = answer.statement();
        assert!(
            told.contains("it is from ") && told.contains("the nearest is"),
            "{told}"
        );
    }

    /// Under a cylinder or a plate the floor carries nothing, however low the lens is beside the pillars.
    #[test]
    fn a_floor_that_carries_nothing_has_no_share() {
        for shape in ["cylinder", "plate"] {
            let mut file = paper(0.03);
            file.set("texture.columns=3").unwrap();
            file.set(&format!("lens.shape={shape}")).unwrap();
            let case = file.case().unwrap();
            let load = Load::Indentation(8e-6);
            let wanted = Wanted::FloorShare { share: 0.15, load };
            let state = fakir::press(&case.system, load, case.method, &Run::default()).unwrap();
            assert!(state.floor.is_none() && state.smallest_floor_gap < 0.0);
            assert!(wanted.excess(&Reached::Pressed(state)) <= -1.0);
            for free in [Key::PillarHeight, Key::Pitch] {
                let told = design(&file, free, wanted, &Run::default()).unwrap_err();
                assert!(
                    told.to_string().contains("the floor carries no load"),
                    "{told}"
                );
            }
        }
    }

    /// Of a lens without a radius, and of pillars wider than the lens.
    #[test]
    fn every_case_has_ranges() {
        let mut wide = paper(0.03);
        wide.set("lens.radius=50um").unwrap();
        wide.set("texture.pillar.diameter=120um").unwrap();
        let mut plate = paper(0.03);
        for given in ["lens.shape=plate", "texture.columns=3"] {
            plate.set(given).unwrap();
        }
        for file in [wide, plate] {
            let case = file.case().unwrap();
            for free in free_keys() {
                if let Some(first) = case.number(free) {
                    let [least, greatest] = range(free, first, &case);
                    assert!(least <= first && first <= greatest, "{free}");
                }
            }
        }
    }

    #[test]
    fn what_is_no_number_is_never_met() {
        let trial = |excess| Trial {
            position: 0.0,
            outcome: Err(Limit::Range),
            excess,
            error: 0.0,
        };
        assert!(trial(0.0).is_met() && trial(-0.5 * TOLERANCE).is_met());
        for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(!trial(odd).is_met());
        }
    }

    /// The keys are those that can be sought, taken from the key table; ranges are what it allows.
    #[test]
    fn ranges_are_those_of_the_key_table() {
        let file = paper(0.1);
        let case = file.case().unwrap();
        let names: Vec<&str> = free_keys().into_iter().map(Key::path).collect();
        assert_eq!(
            names,
            [
                "lens.radius",
                "lens.young_modulus",
                "lens.thickness",
                "lens.base_young_modulus",
                "substrate.young_modulus",
                "substrate.thickness",
                "substrate.base_young_modulus",
                "texture.surface_fraction",
                "texture.pitch",
                "texture.pitch_y",
                "texture.pillar.diameter",
                "texture.pillar.height"
            ]
        );
        let mut layered = paper(0.1);
        for body in ["lens", "substrate"] {
            for given in [
                "thickness=1 mm",
                "base=elastic",
                "base_young_modulus=1 GPa",
                "base_poisson_ratio=0.3",
            ] {
                layered.set(&format!("{body}.{given}")).unwrap();
            }
        }
        for free in free_keys() {
            let (file, case) = match free {
                Key::PitchY => (rectangular(0.1), rectangular(0.1).case().unwrap()),
                _ if free.is_of_layers() => (layered.clone(), layered.case().unwrap()),
                _ => (file.clone(), case.clone()),
            };
            let first = case.number(free).unwrap();
            let [least, greatest] = range(free, first, &case);
            assert!(least < first && first < greatest, "{free}");
            for end in [least, greatest] {
                assert!(with(&file, free, end).is_ok(), "{free} = {end}");
            }
        }
        // The pitch of the case is the farthest that its pillars can grow.
        let mut held = file.clone();
        held.set_number(Key::Pitch, 18e-6);
        let [_, widest] = range(Key::PillarDiameter, 6e-6, &held.case().unwrap());
        assert!((widest / 18e-6 - 1.0).abs() < 1e-15);
    }

    #[test]
    fn what_cannot_be_asked_is_refused() {
        let run = Run::default();
        let file = paper(0.01);
        let refused = design(&file, Key::Offset, Wanted::Force(1e-5), &run);
        assert!(matches!(refused, Err(DesignError::NotFree(Key::Offset))));
        let refused = design(&file, Key::Pitch, Wanted::Force(-1.0), &run);
        assert!(matches!(refused, Err(DesignError::NotPositive(_))));
    }
}
