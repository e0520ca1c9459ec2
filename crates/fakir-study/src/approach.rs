//! Quasi-static loading from first touch to the critical state.

use crate::numbers::{DIGITS, with_unit};
use crate::result::{LoadingRow, SurfaceLoadingRow, warnings};
use fakir::problem::{Control, Method, SurfaceSystem, System};
use fakir::state::{
    Contact, ContactState, Critical, CriticalState, Run, SolveError, SurfaceContact,
    SurfaceTransition,
};
use fakir_case::unit::{Dimension, format_quantity};
use std::time::Instant;

/// The most states of a loading. More are asked for only by a step in the wrong unit.
const MOST_STATES: f64 = 1e4;

/// The indentations of a loading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadingPath {
    /// The indentation between two states, m; greater than 0.
    pub step: f64,
    /// The last indentation, m, if the loading is to end before the critical state, or past it.
    pub until: Option<f64>,
    /// Whether it goes on past the critical state.
    pub past_transition: bool,
}

impl LoadingPath {
    /// The loading in words: `loading in steps of 1 um, up to the critical state`.
    #[must_use]
    pub fn words(&self) -> String {
        let length = |value| format_quantity(value, Dimension::Length);
        let end = match self.until {
            None => "up to the critical state".to_owned(),
            Some(until) if self.past_transition => {
                format!("past the critical state to {}", length(until))
            }
            Some(until) => format!("up to {} or the critical state", length(until)),
        };
        format!("loading in steps of {}, {end}", length(self.step))
    }
}

/// Why there is no loading.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ApproachError {
    /// A contact that cannot be computed.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// A loading up to the critical state of a surface of which nobody knows what is floor.
    #[error(
        "up to where the loading goes is not known: a height map has no pillars that would tell which \
         part of it is the floor; give surface.floor, the height at or below which it is, or the last \
         indentation (until)"
    )]
    NoEnd,
    /// A step so short that the loading would have too many states.
    #[error(
        "a step of {} makes {states:.0} states up to an indentation of {}: at most {MOST_STATES} are \
         computed", rounded_length(*step), rounded_length(*end)
    )]
    TooManyStates {
        /// The step, m.
        step: f64,
        /// The last indentation, m.
        end: f64,
        /// The number of states that it makes.
        states: f64,
    },
}

/// A length in the digits that are shown of numbers.
fn rounded_length(value: f64) -> String {
    with_unit(value, Dimension::Length, DIGITS)
}

/// What a loading can be computed of.
pub trait Loadable {
    /// Its contacts.
    type Contact: Contact;
    /// What is told of each in a table.
    type Row;

    /// The contact under what is prescribed.
    ///
    /// # Errors
    /// As [`fakir::press`].
    fn press(&self, control: Control, run: &Run<'_>) -> Result<Self::Contact, SolveError>;

    /// The critical state; none where it is not known what the floor is.
    ///
    /// # Errors
    /// As [`fakir::transition`].
    fn transition(&self, run: &Run<'_>) -> Result<Option<Critical<Self::Contact>>, SolveError>;

    /// Whether it is known what the floor is.
    fn has_floor(&self) -> bool;

    /// The row of a contact: whether it is the critical state, and whether it is past that, if that is known.
    fn row(contact: &Self::Contact, critical: bool, beyond: Option<bool>) -> Self::Row;
}

/// A texture, with the method that solves it.
impl Loadable for (System, Method) {
    type Contact = ContactState;
    type Row = LoadingRow;

    fn press(&self, control: Control, run: &Run<'_>) -> Result<ContactState, SolveError> {
        fakir::press(&self.0, control, self.1, run)
    }

    fn transition(&self, run: &Run<'_>) -> Result<Option<CriticalState>, SolveError> {
        fakir::transition(&self.0, self.1, run).map(Some)
    }

    fn has_floor(&self) -> bool {
        true
    }

    fn row(contact: &ContactState, critical: bool, _: Option<bool>) -> LoadingRow {
        LoadingRow::new(contact, critical)
    }
}

impl Loadable for SurfaceSystem {
    type Contact = SurfaceContact;
    type Row = SurfaceLoadingRow;

    fn press(&self, control: Control, run: &Run<'_>) -> Result<SurfaceContact, SolveError> {
        SurfaceSystem::press(self, control, run)
    }

    fn transition(&self, run: &Run<'_>) -> Result<Option<SurfaceTransition>, SolveError> {
        let known = self.floor().map(|_| SurfaceSystem::transition(self, run));
        known.transpose()
    }

    fn has_floor(&self) -> bool {
        self.floor().is_some()
    }

    fn row(contact: &SurfaceContact, critical: bool, beyond: Option<bool>) -> SurfaceLoadingRow {
        SurfaceLoadingRow::new(contact, critical, beyond)
    }
}

/// A loading.
#[derive(Debug, Clone)]
pub struct Approach<P: Loadable> {
    /// The states, by rising indentation.
    pub rows: Vec<P::Row>,
    /// The critical state, also if the loading ends before it; none where it is not known what the floor is.
    pub critical: Option<Critical<P::Contact>>,
    /// How long that took, s.
    pub critical_time: f64,
    /// Whether all states are solutions, the critical one too.
    pub converged: bool,
    /// How long all took, s.
    pub wall_time: f64,
    /// What to be careful about, with the indentations.
    pub warnings: Vec<String>,
}

/// Computes all states of a loading. Where it is not known what the floor is, the path must say where it ends. `next`
/// is told what comes next, `keep` gets the states but for the critical one, each with the time it took, s.
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
    if !problem.has_floor() && path.until.is_none() {
        return Err(ApproachError::NoEnd);
    }
    if problem.has_floor() {
        next("critical state");
    }
    let critical = problem.transition(run)?;
    let critical_time = start.elapsed().as_secs_f64();
    let reached = critical.as_ref().map(|critical| &critical.contact);
    let critical_indentation = reached.map(Contact::indentation);
    let row = |contact: &P::Contact, is_critical: bool| {
        let beyond = critical_indentation.map(|reached| contact.indentation() > reached);
        P::row(contact, is_critical, beyond)
    };
    let mut converged = reached.is_none_or(Contact::converged);
    let mut warned = reached.map_or(Vec::new(), warnings);
    let steps = steps(path, critical_indentation)?;
    let mut rows = Vec::with_capacity(steps.len());
    for (number, step) in steps.iter().enumerate() {
        let indentation = match (step, reached) {
            (Step::Critical, Some(contact)) => {
                rows.push(row(contact, true));
                continue;
            }
            (Step::Critical, None) => return Err(ApproachError::NoEnd),
            (Step::At(indentation), _) => *indentation,
        };
        next(&format!("state {} of {}", number + 1, steps.len()));
        let begun = Instant::now();
        let contact = problem.press(Control::Indentation(indentation), run)?;
        let of_contact = warnings(&contact);
        warned.extend(of_contact.iter().map(|text| at(indentation, text)));
        converged &= contact.converged();
        rows.push(row(&contact, false));
        keep(contact, begun.elapsed().as_secs_f64());
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

/// A warning about a state of the loading.
fn at(indentation: f64, text: &str) -> String {
    format!(
        "at an indentation of {}: {text}",
        rounded_length(indentation)
    )
}

/// A state of the loading that is to be computed.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    At(f64),
    Critical,
}

/// Multiples of the step, with the critical state in its place among them and the end of the path
/// last.
fn steps(path: &LoadingPath, critical: Option<f64>) -> Result<Vec<Step>, ApproachError> {
    let step = path.step;
    let end = match (path.until, critical) {
        (Some(until), None) => until,
        (Some(until), Some(critical)) if path.past_transition || until < critical => until,
        (_, Some(critical)) => critical,
        (None, None) => return Err(ApproachError::NoEnd),
    };
    // Where there is no critical state none of the indentations is taken for one.
    let critical = critical.unwrap_or(f64::INFINITY);
    if end / step > MOST_STATES {
        return Err(ApproachError::TooManyStates {
            step,
            end,
            states: end / step,
        });
    }
    // What differs by rounding only is the same state.
    let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * step;
    let multiples = (0..)
        .map(|k| f64::from(k) * step)
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

    fn path(step: f64, until: Option<f64>, past_transition: bool) -> Vec<Step> {
        let path = LoadingPath {
            step,
            until,
            past_transition,
        };
        steps(&path, Some(2.5)).unwrap()
    }

    #[test]
    fn the_critical_state_ends_the_path_or_has_its_place_in_it() {
        use Step::{At, Critical};
        assert_eq!(
            path(1.0, None, false),
            [At(0.0), At(1.0), At(2.0), Critical]
        );
        assert_eq!(path(1.25, None, false), [At(0.0), At(1.25), Critical]);
        assert_eq!(path(1.0, Some(1.5), false), [At(0.0), At(1.0), At(1.5)]);
        assert_eq!(
            path(1.0, Some(9.0), false),
            [At(0.0), At(1.0), At(2.0), Critical]
        );
        assert_eq!(
            path(1.0, Some(3.5), true),
            [At(0.0), At(1.0), At(2.0), Critical, At(3.0), At(3.5)]
        );
        assert_eq!(path(2.0, Some(2.5), true), [At(0.0), At(2.0), Critical]);
    }

    #[test]
    fn steps_in_the_wrong_unit_are_refused() {
        let path = LoadingPath {
            step: 1e-9,
            until: None,
            past_transition: false,
        };
        assert!(steps(&path, Some(2.5)).is_err());
    }

    #[test]
    fn without_a_critical_state_the_path_ends_where_it_is_told_to() {
        use Step::At;
        let mut path = LoadingPath {
            step: 1.0,
            until: Some(2.5),
            past_transition: false,
        };
        let found = steps(&path, None).unwrap();
        assert_eq!(found, [At(0.0), At(1.0), At(2.0), At(2.5)]);
        path.until = None;
        assert_eq!(steps(&path, None), Err(ApproachError::NoEnd));
    }
}
