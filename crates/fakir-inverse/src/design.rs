//! The inverse question: which pitch, height, diameter, lens radius or modulus gives a wanted
//! critical force or contact radius.
//!
//! The answer is sought as a root of `g(x) = ln(answer(x)/wanted)` over `ln x`: bracketed by
//! strides that double, from where the homogenised lattice (a thousand times cheaper) has its
//! root, or from the value in the case file; then closed in on by the [bracketing method](fakir::numerics::roots)
//! that all searches share, which tells a root from a jump. Where the lens would sink in too far to
//! be solved the answer counts as too large; where it meets the floor first, as zero.

use fakir::numerics::convergence::within;
use fakir::numerics::roots::{self, Change, Point, Root};
use fakir::problem::Method;
use fakir::state::{CriticalState, Run, SolveError};
use fakir_case::unit::Dimension;
use fakir_case::{Case, CaseError, CaseFile, Key, TextureOnly};
use fakir_study::numbers::{DIGITS, LENGTH_DIGITS, with_unit};
use std::ops::Bound;

/// What is wanted of the critical state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wanted {
    /// Critical force `F_c`, N.
    Force(f64),
    /// Critical contact radius `a_c`, m.
    ContactRadius(f64),
}

impl Wanted {
    /// The value, N or m.
    #[must_use]
    pub fn value(self) -> f64 {
        match self {
            Self::Force(value) | Self::ContactRadius(value) => value,
        }
    }

    /// The same quantity of a critical state.
    #[must_use]
    pub fn of(self, critical: &CriticalState) -> f64 {
        match self {
            Self::Force(_) => critical.contact.force,
            Self::ContactRadius(_) => critical.contact_radius(),
        }
    }

    /// Its name in a sentence.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Force(_) => "critical force",
            Self::ContactRadius(_) => "critical contact radius",
        }
    }
}

/// A value of the free quantity and the critical state it gives.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// Value of the free key, in SI units.
    pub value: f64,
    /// The case with this value.
    pub case: Case,
    /// Its critical state.
    pub critical: CriticalState,
}

/// What came of a search.
#[derive(Debug, Clone)]
pub enum Design {
    /// A value that gives what is wanted, to within [`TOLERANCE`].
    Found {
        /// The value and its critical state.
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
}

/// A question with its answer.
#[derive(Debug, Clone)]
pub struct Answer {
    /// The key that was sought.
    pub free: Key,
    /// The critical force or contact radius that was wanted.
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
                let away = |side: &Candidate| {
                    (self.wanted.of(&side.critical) / self.wanted.value())
                        .ln()
                        .abs()
                };
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

    fn wanted_dimension(&self) -> (Dimension, usize) {
        match self.wanted {
            Wanted::Force(_) => (Dimension::Force, DIGITS),
            Wanted::ContactRadius(_) => (Dimension::Length, LENGTH_DIGITS),
        }
    }

    fn answer_of(&self, candidate: &Candidate) -> String {
        let (dimension, digits) = self.wanted_dimension();
        with_unit(self.wanted.of(&candidate.critical), dimension, digits)
    }

    /// The answer in a sentence.
    #[must_use]
    pub fn statement(&self) -> String {
        let (dimension, digits) = self.wanted_dimension();
        let wanted = with_unit(self.wanted.value(), dimension, digits);
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
            Design::OutOfReach { limit, .. } => {
                let why = match limit {
                    Limit::Range => "which is as near as it comes".to_owned(),
                    Limit::FloorFirst => {
                        "beyond which the lens meets the floor before any pillar".to_owned()
                    }
                    Limit::Solver(error) => format!("beyond which {error}"),
                };
                format!(
                    "No {path} gives a {name} of {wanted}: the nearest is {}, at {}, {why}",
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
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// A key that cannot be sought.
    #[error("{} cannot be sought: give one of {}", .0.path(), free_names())]
    NotFree(Key),
    /// A wanted value that cannot be.
    #[error("the wanted {} must be greater than 0", .0.name())]
    NotPositive(Wanted),
    /// A solution that did not converge kept the search from its end.
    #[error(
        "the critical state at {} = {value:e} (SI units) did not converge: try another accuracy \
         or an offset that is a little different", .key.path()
    )]
    NotConverged {
        /// The free key.
        key: Key,
        /// Its value.
        value: f64,
    },
}

/// Keys that can be sought: all sizes and moduli of a case with a texture.
#[must_use]
pub fn free_keys() -> Vec<Key> {
    let keys = Key::ALL.into_iter();
    keys.filter(|key| key.is_positive() && !key.is_of_surface())
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
    file.refuse_surface_for(TextureOnly::Design)?;
    if !free_keys().contains(&free) {
        return Err(DesignError::NotFree(free));
    }
    let target = wanted.value();
    if !(target > 0.0 && target.is_finite()) {
        return Err(DesignError::NotPositive(wanted));
    }
    let first = first_value(file, free)?;
    let mut search = Search {
        file,
        free,
        wanted,
        run,
        range: range(free, first, &with(file, free, first)?),
        method: Some(Method::Homogenised),
    };
    let estimate = match search.find(first, STRIDES[1]) {
        Ok(Ending::Found(candidate) | Ending::OutOfReach(candidate, _)) => Some(candidate.value),
        Err(DesignError::Solve(SolveError::Interrupted)) => {
            return Err(SolveError::Interrupted.into());
        }
        _ => None,
    };
    search.method = None;
    let ending = match estimate {
        Some(value) => search.find(value, STRIDES[0])?,
        None => search.find(first, STRIDES[1])?,
    };
    Ok(match ending {
        Ending::Found(candidate) => Design::Found {
            sensitivity: search.sensitivity(&candidate)?,
            candidate,
        },
        Ending::Jump(sides) => Design::Jump(sides),
        Ending::OutOfReach(nearest, limit) => Design::OutOfReach {
            nearest: search.exactly(nearest)?,
            limit,
        },
    })
}

/// How a search ends.
enum Ending {
    Found(Candidate),
    Jump(Box<[Candidate; 2]>),
    OutOfReach(Candidate, Limit),
}

/// The case with a key set to a value in SI units.
pub(crate) fn with(file: &CaseFile, key: Key, value: f64) -> Result<Case, CaseError> {
    let mut file = file.clone();
    file.set_number(key, value);
    file.case()
}

/// Where to begin: the value in the case file, or one in proportion to the others.
fn first_value(file: &CaseFile, free: Key) -> Result<f64, DesignError> {
    match file.case() {
        Ok(case) => case.number(free),
        // It may be just the free key that is missing.
        Err(error) => {
            let guess = GUESSES
                .iter()
                .find(|guess| with(file, free, **guess).is_ok());
            Some(*guess.ok_or(error)?)
        }
    }
    .ok_or(DesignError::NotFree(free))
}

/// Values, in SI units, one of which is within reach of any quantity of a texture.
const GUESSES: [f64; 9] = [1e6, 0.1, 1e-3, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 1e-7];

/// Values between which a free quantity is sought: all that are allowed, as far as a factor of a million from the first.
fn range(free: Key, first: f64, case: &Case) -> [f64; 2] {
    const FARTHEST: f64 = 1e6;
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
    let widest = case.system.lens().radius;
    match free {
        Key::Pitch | Key::PillarDiameter => [least, greatest.min(widest)],
        Key::SurfaceFraction => {
            let part = case.system.pillar().diameter / widest;
            [greatest * part * part, greatest]
        }
        _ => [least, greatest],
    }
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

/// The critical state at one value.
#[derive(Clone)]
struct Trial {
    /// The logarithm of the value, `ln x`.
    position: f64,
    outcome: Result<Candidate, SolveError>,
    /// `ln(answer/wanted)`: infinite where there is none.
    excess: f64,
}

impl Trial {
    fn is_met(&self) -> bool {
        within(self.excess.abs(), TOLERANCE)
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
            Err(error) => Limit::Solver(error.clone()),
            Ok(candidate) if candidate.critical.contact.force <= 0.0 => Limit::FloorFirst,
            Ok(_) => Limit::Range,
        }
    }
}

impl Search<'_> {
    fn trial(&self, position: f64) -> Result<Trial, DesignError> {
        let value = position.exp().clamp(self.range[0], self.range[1]);
        if self.method.is_none()
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
                let pillars = candidate.critical.contact.pillars_in_contact;
                pillars > MANY_PILLARS && outline.excess.abs() > CLEAR
            }
            // With that many pillars it knows the contact radius to a per cent.
            Err(SolveError::ContactExceedsLens { lens_radius, .. }) => {
                let case = with(self.file, self.free, value)?;
                let widest = 0.5 * lens_radius / case.system.lattice().pitch;
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
        let outcome = match fakir::transition(&case.system, case.method, self.run) {
            Ok(critical) if !critical.contact.converged() => {
                return Err(DesignError::NotConverged {
                    key: self.free,
                    value,
                });
            }
            Ok(critical) => Ok(Candidate {
                value,
                case,
                critical,
            }),
            Err(
                error @ (SolveError::ContactExceedsLens { .. }
                | SolveError::TooLarge { .. }
                | SolveError::TextureTooDense { .. }),
            ) => Err(error),
            Err(error) => return Err(error.into()),
        };
        let excess = match &outcome {
            Ok(candidate) => (self.wanted.of(&candidate.critical) / self.wanted.value()).ln(),
            Err(_) => f64::INFINITY,
        };
        Ok(Trial {
            position: value.ln(),
            outcome,
            excess,
        })
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
                Err(error @ SolveError::ContactExceedsLens { .. }) => failure = Some(error),
                Err(error) => return Err(error.into()),
            }
        }
        Err(failure.map_or(DesignError::NotPositive(self.wanted), DesignError::Solve))
    }

    fn find(&self, first: f64, stride: f64) -> Result<Ending, DesignError> {
        let start = self.trial(first.clamp(self.range[0], self.range[1]).ln())?;
        if start.is_met()
            && let Ok(candidate) = start.outcome
        {
            return Ok(Ending::Found(candidate));
        }
        match self.bracket(start, stride)? {
            Ok(bracket) => self.close_in(bracket),
            Err(trials) => self.nearest(trials),
        }
    }

    /// Two neighbouring trials with the wanted value between them; or, if there are none, all
    /// the trials between the ends of the range.
    fn bracket(
        &self,
        start: Trial,
        stride: f64,
    ) -> Result<Result<[Trial; 2], Vec<Trial>>, DesignError> {
        let ends = self.range.map(f64::ln);
        let mut trials = vec![start.clone()];
        let mut fronts = [start.clone(), start]; // downwards and upwards
        let mut strides = [stride; 2];
        let side_done = |fronts: &[Trial; 2], side: usize| match side {
            0 => fronts[0].position <= ends[0],
            _ => fronts[1].position >= ends[1],
        };
        // Upwards first; then whichever front is nearer to what is wanted.
        let mut side = 1;
        while !(side_done(&fronts, 0) && side_done(&fronts, 1)) {
            if side_done(&fronts, side) {
                side = 1 - side;
            }
            let sign = if side == 1 { 1.0 } else { -1.0 };
            let next = (fronts[side].position + sign * strides[side]).clamp(ends[0], ends[1]);
            strides[side] *= 2.0;
            let trial = self.trial(next)?;
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
        Ok(Err(trials))
    }

    /// Closes in on the wanted value between two trials. Where contacts end, a rough search is enough; between
    /// two values it goes on.
    fn close_in(&self, mut sides: [Trial; 2]) -> Result<Ending, DesignError> {
        let mut root = self.narrow(&mut sides, EDGE)?;
        if sides.iter().all(|trial| trial.excess.is_finite()) {
            root = self.narrow(&mut sides, JUMP)?;
        }
        if let Some(Change::Crossing(_)) = root.map(|root| root.change(TOLERANCE))
            && let Some(met) = sides.iter().find(|side| side.is_met())
            && let Ok(candidate) = &met.outcome
        {
            return Ok(Ending::Found(candidate.clone()));
        }
        Self::edge(&sides)
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
    fn edge([low, high]: &[Trial; 2]) -> Result<Ending, DesignError> {
        match (low.outcome.clone(), high.outcome.clone()) {
            (Ok(a), Ok(b)) if low.excess.is_finite() && high.excess.is_finite() => {
                Ok(Ending::Jump(Box::new([a, b])))
            }
            (Ok(nearest), _) if low.excess.is_finite() => {
                Ok(Ending::OutOfReach(nearest, high.limit()))
            }
            (_, Ok(nearest)) => Ok(Ending::OutOfReach(nearest, low.limit())),
            (_, Err(error)) => Err(error.into()),
        }
    }

    /// The outcome where the wanted value is on one side of all trials: the nearest, sought
    /// between the neighbours of the nearest trial.
    fn nearest(&self, mut trials: Vec<Trial>) -> Result<Ending, DesignError> {
        trials.sort_by(|a, b| a.position.total_cmp(&b.position));
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
        match best.outcome {
            Ok(candidate) => Ok(Ending::OutOfReach(candidate, Limit::Range)),
            Err(error) => Err(error.into()),
        }
    }

    /// The sensitivity `d ln(answer)/d ln(x)` by a central difference.
    fn sensitivity(&self, found: &Candidate) -> Result<f64, DesignError> {
        const STEP: f64 = 1e-3;
        let middle = found.value.ln();
        let [low, high] = [self.trial(middle - STEP)?, self.trial(middle + STEP)?];
        let at = |trial: &Trial| trial.outcome.as_ref().ok().map(|c| c.value.ln());
        Ok(match (at(&low), at(&high)) {
            (Some(a), Some(b)) if b > a => (high.excess - low.excess) / (b - a),
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

    /// Takes the critical force of a case, forgets one quantity, finds it again.
    #[test]
    fn every_free_quantity_is_found_again() {
        let run = Run::default();
        for surface_fraction in [1e-3, 0.05] {
            let by_pitch = {
                let case = paper(surface_fraction).case().unwrap();
                let mut file = paper(surface_fraction);
                file.set_number(Key::Pitch, case.system.lattice().pitch);
                file
            };
            for free in free_keys() {
                let file = match free {
                    Key::SurfaceFraction => paper(surface_fraction),
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
                if alone && [Key::Pitch, Key::SurfaceFraction].contains(&free) {
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
                assert!((found.critical.contact_radius() / 100e-6 - 1.0).abs() < 2.0 * TOLERANCE);
            }
            // The contact radius jumps where the next pillars are touched.
            Design::Jump(sides) => {
                let [a, b] = sides.map(|side| side.critical.contact_radius());
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
        let Design::OutOfReach { nearest, limit } =
            design(&file, Key::Pitch, wanted, &run).unwrap()
        else {
            panic!("half the least force cannot be had");
        };
        assert_eq!(limit, Limit::Range);
        let force = nearest.critical.contact.force;
        assert!(force < least * 1.001 && force > 0.9 * least);
    }

    #[test]
    fn what_is_no_number_is_never_met() {
        let trial = |excess| Trial {
            position: 0.0,
            outcome: Err(SolveError::Interrupted),
            excess,
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
                "substrate.young_modulus",
                "texture.surface_fraction",
                "texture.pitch",
                "texture.pillar.diameter",
                "texture.pillar.height"
            ]
        );
        for free in free_keys() {
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
