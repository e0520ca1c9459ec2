//! Quasi-static loading from first touch to the critical state.

use crate::numbers::{DIGITS, with_unit};
use crate::record::{
    AsperityAnswer, AsperityCritical, DISC, FlatAnswer, LoadingState, Object, Place, Record,
    SurfaceAnswer, asperity_head, surface_head,
};
use crate::result::{self, asperity_warnings, warnings};
use fakir::problem::{
    Accuracy, Feature, InvalidProtocol, Load, Method, Question, Solver, SurfaceSystem, Unsupported,
};
use fakir::state::{
    AsperityContact, Contact, ContactState, Critical, CriticalState, FlatContact, Run, Solution,
    SolveError, SurfaceContact, SurfaceTransition,
};
use fakir_case::unit::{Dimension, format_quantity};
use fakir_case::{AsperityCase, Case, FlatCase};
use std::time::Instant;

/// Largest number of states of a loading. Only a step in a wrong unit exceeds it.
const MOST_STATES: f64 = 1e4;

/// Number of contacts from which the curve of a height map is interpolated, at most, if it has this number of cells; with fewer cells up to four
/// times as many.
const FEW_CONTACTS: usize = 14;
const CELLS_OF_FEW_CONTACTS: usize = 1 << 18;

/// Indentations of a loading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadingPath {
    /// Indentation step between two states, m; greater than 0.
    pub step: f64,
    /// The last state.
    pub end: LoadingEnd,
}

/// End of a loading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoadingEnd {
    /// A load before, at or past the critical state.
    At(Load),
    /// This indentation, m, or the critical state if that is reached earlier.
    CriticalOr(f64),
}

impl LoadingEnd {
    /// Selects the end from the given arguments: an indentation up to which the loading continues unless it reaches the critical state, or
    /// past that; an indentation (m); a force (N).
    ///
    /// # Errors
    /// [`ApproachError::Ends`] if several are given, [`ApproachError::NotPositive`] for a value that is not greater than 0.
    pub fn of(
        until: Option<f64>,
        past_transition: bool,
        to: Option<f64>,
        to_force: Option<f64>,
    ) -> Result<Self, ApproachError> {
        for (name, value) in [("until", until), ("to", to), ("to_force", to_force)] {
            if value.is_some_and(|value| !(value > 0.0 && value.is_finite())) {
                return Err(ApproachError::NotPositive { name });
            }
        }
        match (until, to, to_force) {
            (Some(until), None, None) if past_transition => Ok(Self::At(Load::Indentation(until))),
            (Some(until), None, None) => Ok(Self::CriticalOr(until)),
            (None, None, _) | (None, _, None) => {
                let load = Load::given(to, to_force);
                Ok(Self::At(load.unwrap_or(Load::FloorContact)))
            }
            _ => Err(ApproachError::Ends),
        }
    }
}

impl LoadingPath {
    /// Description of the loading: `loading in steps of 1 um, up to the critical state`.
    #[must_use]
    pub fn words(&self) -> String {
        let length = |value| format_quantity(value, Dimension::Length);
        let end = match self.end {
            LoadingEnd::At(Load::FloorContact) => "up to the critical state".to_owned(),
            LoadingEnd::CriticalOr(until) => {
                format!("up to {} or the critical state", length(until))
            }
            LoadingEnd::At(Load::Indentation(to)) => {
                format!("up to an indentation of {}", length(to))
            }
            LoadingEnd::At(Load::Force(force)) => {
                let force = format_quantity(force, Dimension::Force);
                format!("up to a force of {force}")
            }
        };
        format!("loading in steps of {}, {end}", length(self.step))
    }
}

/// Errors of a loading.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ApproachError {
    /// A contact that cannot be computed.
    #[error("{}", fakir_case::with_keys(.0))]
    Solve(#[from] SolveError),
    /// The loading ends at a critical state that does not exist.
    #[error("the loading has no end by itself, as {why}: give the last indentation (to)")]
    NoEnd {
        /// Why there is no critical state.
        why: &'static str,
    },
    /// Several ends are given.
    #[error("a loading has one end: give one of until, to and to_force")]
    Ends,
    /// A rate of one quantity up to a load of another.
    #[error(
        "a rate of the indentation, such as 1 um/s, ends at an indentation (to), a rate of the force, such as 10 uN/s, at a force (to_force), \
         and both may end at the critical state"
    )]
    Rate,
    /// A protocol that cannot be followed.
    #[error(transparent)]
    Protocol(InvalidProtocol),
    /// A length or force must be greater than 0.
    #[error("{name} must be greater than 0")]
    NotPositive {
        /// Name of the quantity.
        name: &'static str,
    },
    /// The loading ends before first contact.
    #[error(
        "the lens first touches the surface at an indentation of {}: up to {} there is no contact; give a larger load",
        rounded_length(*first_touch), rounded_length(*end)
    )]
    BelowFirstTouch {
        /// Indentation at its end, m.
        end: f64,
        /// Indentation of first contact, m.
        first_touch: f64,
    },
    /// The step is so short that the loading would have too many states.
    #[error(
        "a step of {} makes {states:.0} states up to an indentation of {}: at most {MOST_STATES} are \
         computed", rounded_length(*step), rounded_length(*end)
    )]
    TooManyStates {
        /// The step, m.
        step: f64,
        /// The last indentation, m.
        end: f64,
        /// Number of states.
        states: f64,
    },
}

/// A length with the default number of digits.
fn rounded_length(value: f64) -> String {
    with_unit(value, Dimension::Length, DIGITS)
}

/// The reason that a solver does not support a question for any problem.
pub(crate) fn unsupported(question: Question, solver: Solver) -> SolveError {
    let reason = question.check(solver, &[]).err();
    SolveError::Unsupported(reason.unwrap_or(Unsupported {
        why: "this question has no answer for this kind of surface",
        instead: "use another kind of surface",
        with: &[],
    }))
}

/// A case of which a loading can be computed.
pub trait Loadable {
    /// Type of its contacts.
    type Contact: Contact;

    /// Computes the contact at a prescribed load.
    ///
    /// # Errors
    /// As [`fakir::press`].
    fn press(&self, control: Load, run: &Run<'_>) -> Result<Self::Contact, SolveError>;

    /// The critical state.
    ///
    /// # Errors
    /// As [`fakir::transition`]; [`SolveError::Unsupported`] if the surface defines no floor.
    fn transition(&self, run: &Run<'_>) -> Result<Critical<Self::Contact>, SolveError>;

    /// Whether a loading up to this load may contain the critical state. If not, that is not computed for a loading that ends there.
    ///
    /// # Errors
    /// Cancellation.
    fn may_reach_floor(&self, _: Load, _: &Run<'_>) -> Result<bool, SolveError> {
        Ok(true)
    }

    /// Whether the load of the floor is part of contacts past the critical state.
    fn computes_floor_load(&self) -> bool {
        true
    }

    /// Why there is no critical state at which a loading could end; `None` if there is one.
    fn no_end(&self) -> Option<&'static str>;

    /// An indentation below which nothing is touched, m.
    fn first_touch(&self) -> f64;

    /// Refuses a history of viscoelastic bodies that is not supported.
    ///
    /// # Errors
    /// [`SolveError::Unsupported`] with adhesion.
    fn check_history(&self) -> Result<(), SolveError> {
        Ok(())
    }

    /// Accuracy of the elastic curve for histories of viscoelastic bodies: the tolerance of forces, relative to the largest, and the largest
    /// number of contacts.
    fn curve_accuracy(&self) -> (f64, usize) {
        (2e-4, 40)
    }

    /// The numbers of a state.
    fn state(&self, state: LoadingState<&Self::Contact>) -> Record;

    /// Warnings about a state.
    fn warnings(&self, contact: &Self::Contact) -> Vec<String> {
        warnings(contact)
    }

    /// Method, indenter and surface, for a summary.
    fn head(&self) -> Object;

    /// The critical state for a summary.
    fn critical(&self, critical: &Critical<Self::Contact>, wall_time: f64) -> Object;
}

/// Pillars with flat tops.
impl Loadable for Case {
    type Contact = ContactState;

    fn press(&self, control: Load, run: &Run<'_>) -> Result<ContactState, SolveError> {
        fakir::press(&self.system, control, self.method, run)
    }

    fn transition(&self, run: &Run<'_>) -> Result<CriticalState, SolveError> {
        fakir::transition(&self.system, self.method, run)
    }

    fn no_end(&self) -> Option<&'static str> {
        let features = Feature::of(&self.system);
        let answered = Question::Transition.check(self.method.into(), &features);
        answered.err().map(|unsupported| unsupported.why)
    }

    fn first_touch(&self) -> f64 {
        self.system.first_touch().min(self.system.pillar().height)
    }

    fn check_history(&self) -> Result<(), SolveError> {
        let features = Feature::of(&self.system);
        Ok(Question::Hold.check(self.method.into(), &features)?)
    }

    // Kinks at each ring of pillars. Contacts take milliseconds where many are needed: with few pillars.
    fn curve_accuracy(&self) -> (f64, usize) {
        match self.method {
            Method::Spectral(Accuracy::Default) => (2e-4, 160),
            Method::Spectral(Accuracy::Accurate) => (2e-5, 500),
            _ => (2e-4, 40),
        }
    }

    fn state(&self, state: LoadingState<&ContactState>) -> Record {
        let place = Place {
            beyond: Some(state.answer.beyond_transition()),
            ..state.place
        };
        Record::of(&LoadingState { place, ..state })
    }

    fn head(&self) -> Object {
        Object::word("method", self.method.name())
    }

    fn critical(&self, critical: &CriticalState, wall_time: f64) -> Object {
        result::transition(critical, None, None, wall_time)
    }
}

impl Loadable for SurfaceSystem {
    type Contact = SurfaceContact;

    fn press(&self, control: Load, run: &Run<'_>) -> Result<SurfaceContact, SolveError> {
        SurfaceSystem::press(self, control, run)
    }

    fn transition(&self, run: &Run<'_>) -> Result<SurfaceTransition, SolveError> {
        SurfaceSystem::transition(self, run)
    }

    fn no_end(&self) -> Option<&'static str> {
        self.floor().is_none().then_some(
            "a height map has no pillars that define which part of it is the floor: give surface.floor, the height at or below which it is",
        )
    }

    fn first_touch(&self) -> f64 {
        SurfaceSystem::first_touch(self)
    }

    fn check_history(&self) -> Result<(), SolveError> {
        if self.adhesion().is_none() {
            return Ok(());
        }
        Ok(Question::Hold.check(Solver::HeightMap, &[Feature::AdhesiveTops])?)
    }

    // Contacts take seconds on many cells and tens of milliseconds on few, and change by whole cells.
    fn curve_accuracy(&self) -> (f64, usize) {
        let fewer = CELLS_OF_FEW_CONTACTS / self.surface().grid().cell_count();
        (2e-4, FEW_CONTACTS * fewer.clamp(1, 4))
    }

    fn state(&self, state: LoadingState<&SurfaceContact>) -> Record {
        let answer = SurfaceAnswer {
            system: self,
            answer: state.answer,
        };
        Record::of(&state.of(answer))
    }

    fn head(&self) -> Object {
        surface_head(self)
    }

    fn critical(&self, critical: &SurfaceTransition, wall_time: f64) -> Object {
        let answer = SurfaceAnswer {
            system: self,
            answer: critical,
        };
        result::surface_transition(&answer, wall_time)
    }
}

/// Pillars with rounded tops.
impl Loadable for AsperityCase {
    type Contact = AsperityContact;

    fn press(&self, control: Load, run: &Run<'_>) -> Result<AsperityContact, SolveError> {
        self.field.press(control, self.accuracy, run)
    }

    fn transition(&self, run: &Run<'_>) -> Result<Critical<AsperityContact>, SolveError> {
        self.field.transition(self.accuracy, run)
    }

    fn computes_floor_load(&self) -> bool {
        self.field.is_floor_loaded()
    }

    // Tops high above the floor merge before it is reached, so that the critical state does not exist.
    fn may_reach_floor(&self, end: Load, run: &Run<'_>) -> Result<bool, SolveError> {
        match self.field.press(end, self.accuracy, run) {
            Ok(contact) => Ok(contact.beyond_transition() == Some(true)),
            Err(SolveError::Interrupted) => Err(SolveError::Interrupted),
            // The loading may end at the critical state before.
            Err(_) => Ok(true),
        }
    }

    fn no_end(&self) -> Option<&'static str> {
        let features = Feature::of_asperities(&self.field);
        let answered = Question::Transition.check(Solver::Asperities, &features);
        answered.err().map(|unsupported| unsupported.why)
    }

    fn first_touch(&self) -> f64 {
        -self.field.highest()
    }

    fn check_history(&self) -> Result<(), SolveError> {
        if self.field.adhesion().is_none() {
            return Ok(());
        }
        Ok(Question::Hold.check(Solver::Asperities, &[Feature::AdhesiveTops])?)
    }

    fn state(&self, state: LoadingState<&AsperityContact>) -> Record {
        let place = Place {
            beyond: state.answer.beyond_transition(),
            ..state.place
        };
        let answer = AsperityAnswer::of(self, state.answer);
        Record::of(&LoadingState { place, ..state }.of(answer))
    }

    fn warnings(&self, contact: &AsperityContact) -> Vec<String> {
        asperity_warnings(AsperityAnswer::of(self, contact))
    }

    fn head(&self) -> Object {
        asperity_head(&self.field)
    }

    fn critical(&self, critical: &Critical<AsperityContact>, wall_time: f64) -> Object {
        result::asperity_transition(AsperityCritical::of(self, critical), wall_time)
    }
}

/// A flat surface.
impl Loadable for FlatCase {
    type Contact = FlatContact;

    fn press(&self, control: Load, run: &Run<'_>) -> Result<FlatContact, SolveError> {
        self.system.press(control, run)
    }

    fn transition(&self, _: &Run<'_>) -> Result<Critical<FlatContact>, SolveError> {
        Err(unsupported(Question::Transition, Solver::Flat))
    }

    fn no_end(&self) -> Option<&'static str> {
        let answered = Question::Transition.check(Solver::Flat, &[]);
        answered.err().map(|unsupported| unsupported.why)
    }

    fn first_touch(&self) -> f64 {
        0.0
    }

    fn check_history(&self) -> Result<(), SolveError> {
        if self.system.adhesion().is_none() {
            return Ok(());
        }
        Ok(Question::Hold.check(Solver::Flat, &[Feature::AdhesiveTops])?)
    }

    // Closed forms, or an integral equation on layers.
    fn curve_accuracy(&self) -> (f64, usize) {
        (1e-8, 60)
    }

    fn state(&self, state: LoadingState<&FlatContact>) -> Record {
        let answer = FlatAnswer {
            system: &self.system,
            contact: state.answer,
        };
        Record::of(&state.of(answer))
    }

    fn head(&self) -> Object {
        Object::word("method", DISC)
    }

    fn critical(&self, _: &Critical<FlatContact>, _: f64) -> Object {
        Object::default()
    }
}

/// A loading.
#[derive(Debug, Clone)]
pub struct Approach<P: Loadable> {
    /// The states, by increasing indentation.
    pub rows: Vec<Record>,
    /// The critical state, even if the loading ends before it; `None` if the surface defines no floor, and for rounded tops if the loading
    /// ends before it.
    pub critical: Option<Critical<P::Contact>>,
    /// Computing time of the critical state, s.
    pub critical_time: f64,
    /// Whether all states are [answers](Solution::is_answer), the critical one too.
    pub converged: bool,
    /// Total computing time, s.
    pub wall_time: f64,
    /// Warnings, with the indentations.
    pub warnings: Vec<String>,
}

/// Computes all states of a loading. If the surface defines no floor, the path must give the end. `next` is called with a description of
/// the next part, `keep` with the states except the critical one, each with its computing time, s.
///
/// # Errors
/// See [`ApproachError`].
pub fn approach<P: Loadable>(
    problem: &P,
    path: &LoadingPath,
    run: &Run<'_>,
    next: &dyn Fn(&str),
    keep: &mut dyn FnMut(P::Contact, f64),
) -> Result<Approach<P>, ApproachError> {
    let start = Instant::now();
    let no_end = || ApproachError::NoEnd {
        why: problem.no_end().unwrap_or_default(),
    };
    let has_critical = problem.no_end().is_none();
    match path.end {
        LoadingEnd::At(Load::FloorContact) if !has_critical => return Err(no_end()),
        LoadingEnd::At(Load::Indentation(end)) | LoadingEnd::CriticalOr(end)
            if end <= problem.first_touch() =>
        {
            let first_touch = problem.first_touch();
            return Err(ApproachError::BelowFirstTouch { end, first_touch });
        }
        _ => {}
    }
    let may_contain_critical = match path.end {
        LoadingEnd::At(Load::FloorContact) => true,
        LoadingEnd::At(end) => has_critical && problem.may_reach_floor(end, run)?,
        LoadingEnd::CriticalOr(until) => {
            has_critical && problem.may_reach_floor(Load::Indentation(until), run)?
        }
    };
    let critical = if may_contain_critical {
        next("critical state");
        Some(problem.transition(run)?)
    } else {
        None
    };
    let critical_time = start.elapsed().as_secs_f64();
    let reached = critical.as_ref().map(|critical| &critical.contact);
    let critical_indentation = reached.map(Contact::indentation);
    let row = |contact: &P::Contact, is_critical: bool| {
        problem.state(LoadingState {
            answer: contact,
            place: Place {
                critical: is_critical,
                beyond: match critical_indentation {
                    Some(reached) => Some(contact.indentation() > reached),
                    None => has_critical.then_some(false),
                },
            },
        })
    };
    let mut converged = reached.is_none_or(Solution::is_answer);
    let mut warned = reached.map_or(Vec::new(), |contact| problem.warnings(contact));
    // The last state of a loading up to a force determines the indentations.
    let begun = Instant::now();
    let mut last = None;
    if let LoadingEnd::At(load @ Load::Force(_)) = path.end {
        next("state under the last force");
        let contact = problem.press(load, run)?;
        last = Some((contact, begun.elapsed()));
    }
    let end = match (path.end, &last, critical_indentation) {
        (LoadingEnd::At(Load::Force(_)), Some((contact, _)), _) => contact.indentation(),
        (LoadingEnd::At(Load::Indentation(to)), ..) => to,
        (LoadingEnd::CriticalOr(until), _, critical) => {
            critical.map_or(until, |critical| critical.min(until))
        }
        (_, _, Some(critical)) => critical,
        (_, _, None) => return Err(no_end()),
    };
    let steps = steps(
        path.step,
        [problem.first_touch(), end],
        critical_indentation,
    )?;
    let mut rows = Vec::with_capacity(steps.len());
    for (number, step) in steps.iter().enumerate() {
        let indentation = match (step, reached) {
            (Step::Critical, Some(contact)) => {
                rows.push(row(contact, true));
                continue;
            }
            (Step::Critical, None) => return Err(no_end()),
            (Step::At(indentation), _) => *indentation,
        };
        next(&format!("state {} of {}", number + 1, steps.len()));
        let begun = Instant::now();
        let (contact, time) = match last.take() {
            Some(found) if number + 1 == steps.len() => found,
            later => {
                last = later;
                let contact = problem.press(Load::Indentation(indentation), run)?;
                (contact, begun.elapsed())
            }
        };
        let of_contact = problem.warnings(&contact);
        warned.extend(of_contact.iter().map(|text| at(indentation, text)));
        converged &= contact.is_answer();
        rows.push(row(&contact, false));
        keep(contact, time.as_secs_f64());
    }
    Ok(Approach {
        rows,
        critical,
        critical_time,
        converged,
        wall_time: start.elapsed().as_secs_f64(),
        warnings: warned,
    })
}

/// Text of a warning about a state of the loading.
pub(crate) fn at(indentation: f64, text: &str) -> String {
    format!(
        "at an indentation of {}: {text}",
        rounded_length(indentation)
    )
}

/// A state of the loading to compute.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    At(f64),
    Critical,
}

/// Multiples of the step, with the critical state inserted in order and the end of the path last.
///
/// They start at 0, or at the first multiple in contact if the first touched point is higher than the level from which indentations are
/// measured.
fn steps(
    step: f64,
    [first_touch, end]: [f64; 2],
    critical: Option<f64>,
) -> Result<Vec<Step>, ApproachError> {
    // Without a critical state no indentation is treated as critical.
    let critical = critical.unwrap_or(f64::INFINITY);
    let first = (first_touch.min(0.0) / step).ceil();
    let states = end / step - first;
    if states > MOST_STATES {
        return Err(ApproachError::TooManyStates { step, end, states });
    }
    // Indentations that differ only by rounding are the same state.
    let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * step;
    let multiples = (0..)
        .map(|k| (first + f64::from(k)) * step)
        .take_while(|value| *value < end && !same(*value, end))
        .filter(|value| !same(*value, critical));
    let mut indentations: Vec<f64> = multiples.chain([end]).collect();
    if critical <= end {
        indentations.retain(|value| !same(*value, critical));
        indentations.push(critical);
        indentations.sort_by(f64::total_cmp);
    }
    Ok(indentations
        .into_iter()
        .map(|value| {
            if value.to_bits() == critical.to_bits() {
                Step::Critical
            } else {
                Step::At(value)
            }
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(step: f64, end: f64) -> Vec<Step> {
        steps(step, [0.0, end], Some(2.5)).unwrap()
    }

    #[test]
    fn the_critical_state_ends_the_path_or_has_its_place_in_it() {
        use Step::{At, Critical};
        assert_eq!(path(1.0, 2.5), [At(0.0), At(1.0), At(2.0), Critical]);
        assert_eq!(path(1.25, 2.5), [At(0.0), At(1.25), Critical]);
        assert_eq!(path(1.0, 1.5), [At(0.0), At(1.0), At(1.5)]);
        assert_eq!(
            path(1.0, 3.5),
            [At(0.0), At(1.0), At(2.0), Critical, At(3.0), At(3.5)]
        );
        assert_eq!(path(2.0, 2.5), [At(0.0), At(2.0), Critical]);
    }

    #[test]
    fn steps_in_the_wrong_unit_are_refused() {
        assert!(steps(1e-9, [0.0, 2.5], Some(2.5)).is_err());
    }

    #[test]
    fn without_a_critical_state_the_path_ends_at_the_given_load() {
        use Step::At;
        let found = steps(1.0, [0.0, 2.5], None).unwrap();
        assert_eq!(found, [At(0.0), At(1.0), At(2.0), At(2.5)]);
    }

    #[test]
    fn a_loading_has_one_end() {
        let of = |until, past, to, force| LoadingEnd::of(until, past, to, force).ok();
        assert_eq!(
            of(None, false, None, None),
            Some(LoadingEnd::At(Load::FloorContact))
        );
        let until = Some(LoadingEnd::CriticalOr(2.0));
        assert_eq!(of(Some(2.0), false, None, None), until);
        let to = Some(LoadingEnd::At(Load::Indentation(2.0)));
        assert_eq!(of(Some(2.0), true, None, None), to);
        assert_eq!(of(None, false, Some(2.0), None), to);
        let force = Some(LoadingEnd::At(Load::Force(3.0)));
        assert_eq!(of(None, false, None, Some(3.0)), force);
        assert_eq!(of(None, false, Some(2.0), Some(3.0)), None);
        assert_eq!(of(None, false, Some(-2.0), None), None);
    }
}
