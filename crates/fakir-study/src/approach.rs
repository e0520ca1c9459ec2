//! Quasi-static loading from first touch to the critical state.

use crate::VERSION;
use crate::numbers::{DIGITS, with_unit};
use crate::result::{
    ApproachSummary, LoadingRow, SurfaceApproachSummary, SurfaceLoadingRow, TransitionSummary,
    surface_warnings, warnings,
};
use fakir::problem::{Floor, Load, Method, SurfaceSystem, System};
use fakir::state::{
    ContactState, CriticalState, Run, SolveError, SurfaceContact, SurfaceTransition,
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

/// A loading.
#[derive(Debug, Clone)]
pub struct Approach {
    /// The loading as a JSON object and as a table.
    pub summary: ApproachSummary,
    /// The critical state, also if the loading ends before it.
    pub critical: CriticalState,
    /// How long the critical state took, s.
    pub critical_time: f64,
    /// What to be careful about, with the indentations.
    pub warnings: Vec<String>,
}

/// Computes all states of a loading. `next` is told what comes next, `keep` gets the states but for the
/// critical one, each with the time it took, s.
///
/// # Errors
/// See [`ApproachError`].
pub fn approach(
    system: &System,
    method: Method,
    path: &LoadingPath,
    run: &Run<'_>,
    next: &dyn Fn(&str),
    keep: &mut dyn FnMut(ContactState, f64),
) -> Result<Approach, ApproachError> {
    let start = Instant::now();
    next("critical state");
    let critical = fakir::transition(system, method, run)?;
    let critical_time = start.elapsed().as_secs_f64();
    let mut warned = warnings(&critical.contact);
    let rows = load(path, Some(critical.contact.indentation), next, |step| {
        let Step::At(indentation) = step else {
            return Ok(LoadingRow::new(&critical.contact, true));
        };
        let begun = Instant::now();
        let state = fakir::press(system, Load::Indentation(indentation), method, run)?;
        warned.extend(warnings(&state).iter().map(|text| at(indentation, text)));
        let row = LoadingRow::new(&state, false);
        keep(state, begun.elapsed().as_secs_f64());
        Ok(row)
    })?;
    Ok(Approach {
        summary: ApproachSummary {
            method: method.name(),
            critical: TransitionSummary::new(&critical, critical_time),
            converged: critical.contact.converged() && rows.iter().all(|row| row.converged),
            states: rows,
            wall_time_s: start.elapsed().as_secs_f64(),
            fakir_version: VERSION,
        },
        critical,
        critical_time,
        warnings: warned,
    })
}

/// A loading on a general surface.
#[derive(Debug, Clone)]
pub struct SurfaceApproach {
    /// The loading as a JSON object and as a table.
    pub summary: SurfaceApproachSummary,
    /// The critical state, also if the loading ends before it; none of a surface without a floor.
    pub critical: Option<SurfaceTransition>,
    /// How long the critical state took, s.
    pub critical_time: f64,
    /// What to be careful about, with the indentations.
    pub warnings: Vec<String>,
}

/// The same on a general surface. Past the critical state the floor bears load as well. Where it is not
/// known what the floor is, the path must say where it ends.
///
/// # Errors
/// See [`ApproachError`].
pub fn approach_surface(
    system: &SurfaceSystem,
    floor: Option<Floor>,
    path: &LoadingPath,
    run: &Run<'_>,
    next: &dyn Fn(&str),
    keep: &mut dyn FnMut(SurfaceContact, f64),
) -> Result<SurfaceApproach, ApproachError> {
    let start = Instant::now();
    if floor.is_none() && path.until.is_none() {
        return Err(ApproachError::NoEnd);
    }
    let critical = match floor {
        Some(floor) => {
            next("critical state");
            Some(system.transition(floor, run)?)
        }
        None => None,
    };
    let critical_time = start.elapsed().as_secs_f64();
    let known = critical.as_ref();
    let critical_indentation = known.map(|critical| critical.contact.indentation);
    let row = |contact: &SurfaceContact, critical: bool| {
        let shares = floor.map(|floor| contact.shares(system.surface(), floor));
        let beyond = critical_indentation.map(|reached| contact.indentation > reached);
        SurfaceLoadingRow::new(contact, shares, critical, beyond)
    };
    let mut warned = known.map_or(Vec::new(), |critical| surface_warnings(&critical.contact));
    let rows = load(path, critical_indentation, next, |step| {
        let indentation = match (step, known) {
            (Step::Critical, Some(critical)) => return Ok(row(&critical.contact, true)),
            (Step::Critical, None) => return Err(ApproachError::NoEnd),
            (Step::At(indentation), _) => indentation,
        };
        let begun = Instant::now();
        let contact = system.press(Load::Indentation(indentation), run)?;
        let of_contact = surface_warnings(&contact);
        warned.extend(of_contact.iter().map(|text| at(indentation, text)));
        let row = row(&contact, false);
        keep(contact, begun.elapsed().as_secs_f64());
        Ok(row)
    })?;
    let summary = SurfaceApproachSummary::new(
        system,
        known.map(|critical| (critical, critical_time)),
        rows,
        start.elapsed().as_secs_f64(),
    );
    Ok(SurfaceApproach {
        summary,
        critical,
        critical_time,
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

/// The rows of all states of a path.
fn load<R>(
    path: &LoadingPath,
    critical: Option<f64>,
    next: &dyn Fn(&str),
    mut row: impl FnMut(Step) -> Result<R, ApproachError>,
) -> Result<Vec<R>, ApproachError> {
    let steps = steps(path, critical)?;
    let mut rows = Vec::with_capacity(steps.len());
    for (number, step) in steps.iter().enumerate() {
        if *step != Step::Critical {
            next(&format!("state {} of {}", number + 1, steps.len()));
        }
        rows.push(row(*step)?);
    }
    Ok(rows)
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
