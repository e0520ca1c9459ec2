//! `fakir approach`: quasi-static loading from first touch to the critical state.

use crate::arguments::LoadingPath;
use crate::failure::Failure;
use crate::numbers::{digits, with_unit};
use crate::report::state::{VERSION, radius_digits, texture_line, warnings};
use crate::report::table::{Column, table};
use crate::report::{Report, csv, json};
use crate::session::Session;
use fakir::problem::Load;
use fakir::state::{ContactState, CriticalState};
use fakir_case::Case;
use fakir_case::unit::{Dimension, format_quantity};
use fakir_study::citations::Topic;
use fakir_study::provenance::{Provenance, method_words};
use fakir_study::summary::TransitionSummary;
use serde::Serialize;
use std::time::Instant;

/// More states than anybody wants; a step in the wrong unit asks for this many.
const MOST_STATES: f64 = 1e4;

/// A state of the loading, in JSON and CSV.
#[derive(Debug, Clone, Copy, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct StateRow {
    indentation_m: f64,
    force_N: f64,
    contact_radius_m: f64,
    pillars_in_contact: usize,
    pillars_partially_in_contact: usize,
    smallest_floor_gap_m: f64,
    force_error_estimate: f64,
    contact_radius_error_estimate: f64,
    critical: bool,
    beyond_transition: bool,
    converged: bool,
}

#[derive(Debug, Serialize)]
struct ApproachJson<'a> {
    method: &'static str,
    critical: TransitionSummary,
    states: &'a [StateRow],
    converged: bool,
    wall_time_s: f64,
    fakir_version: &'static str,
}

pub(crate) fn run(case: &Case, path: &LoadingPath, session: &Session) -> Result<Report, Failure> {
    let start = Instant::now();
    session.part("critical state");
    let critical = fakir::transition(&case.system, case.method, &session.run())?;
    let critical_time = start.elapsed().as_secs_f64();
    let indentations = indentations(path, critical.contact.indentation)?;
    let mut warnings = warnings(&critical.contact);
    let mut rows = Vec::with_capacity(indentations.len());
    for (number, step) in indentations.iter().enumerate() {
        let row = match step {
            Step::Critical => row(&critical.contact, true),
            Step::At(indentation) => {
                session.part(&format!("state {} of {}", number + 1, indentations.len()));
                let load = Load::Indentation(*indentation);
                let state = fakir::press(&case.system, load, case.method, &session.run())?;
                warnings.extend(self::warnings(&state).into_iter().map(|text| {
                    let at = with_unit(*indentation, Dimension::Length, 6);
                    format!("at an indentation of {at}: {text}")
                }));
                row(&state, false)
            }
        };
        rows.push(row);
    }
    let converged = critical.contact.converged() && rows.iter().all(|row| row.converged);
    let wall_time = start.elapsed().as_secs_f64();
    Ok(Report {
        json: json(&ApproachJson {
            method: case.method.name(),
            critical: TransitionSummary::new(&critical, critical_time),
            states: &rows,
            converged,
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }),
        text: text(case, &critical, &rows),
        provenance: Provenance::new(
            question(path),
            method_words(case.method),
            &[Topic::Method(case.method)],
            case.to_toml(),
        ),
        tables: vec![csv("approach.csv", &rows)],
        warnings,
        converged,
    })
}

/// The loading in words: `loading in steps of 1 um, up to the critical state`.
fn question(path: &LoadingPath) -> String {
    let length = |value| format_quantity(value, Dimension::Length);
    let end = match path.until {
        None => "up to the critical state".to_owned(),
        Some(until) if path.past_transition => {
            format!("past the critical state to {}", length(until))
        }
        Some(until) => format!("up to {} or the critical state", length(until)),
    };
    format!("loading in steps of {}, {end}", length(path.step))
}

/// A state of the loading that is to be computed.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    At(f64),
    Critical,
}

/// Multiples of the step, with the critical state in its place among them and the end of the path
/// last.
fn indentations(path: &LoadingPath, critical: f64) -> Result<Vec<Step>, Failure> {
    let step = path.step;
    let end = match path.until {
        Some(until) if path.past_transition || until < critical => until,
        _ => critical,
    };
    if end / step > MOST_STATES {
        return Err(Failure::Argument(format!(
            "--step {} makes {:.0} states up to an indentation of {}: at most {MOST_STATES} are \
             computed",
            with_unit(step, Dimension::Length, 6),
            end / step,
            with_unit(end, Dimension::Length, 6),
        )));
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

fn row(state: &ContactState, critical: bool) -> StateRow {
    StateRow {
        indentation_m: state.indentation,
        force_N: state.force,
        contact_radius_m: state.contact_radius,
        contact_radius_error_estimate: state.relative_contact_radius_error(),
        pillars_in_contact: state.pillars_in_contact,
        pillars_partially_in_contact: state.pillars_partially_in_contact,
        smallest_floor_gap_m: state.smallest_floor_gap,
        force_error_estimate: state.error.force,
        critical,
        beyond_transition: state.beyond_transition(),
        converged: state.converged(),
    }
}

fn text(case: &Case, critical: &CriticalState, rows: &[StateRow]) -> String {
    let reached = if rows.iter().any(|row| row.critical) {
        String::new()
    } else {
        format!(
            "\nThe critical state is further on, at an indentation of {} and a force of {}.\n",
            with_unit(critical.contact.indentation, Dimension::Length, 6),
            with_unit(critical.contact.force, Dimension::Force, 6)
        )
    };
    format!(
        "Approach of the lens\n{}\n{}\n\n{}{reached}",
        texture_line(&case.system),
        method_words(case.method),
        table(rows, &columns(rows))
    )
}

fn columns(rows: &[StateRow]) -> [Column<StateRow>; 7] {
    [
        Column::quantity("indentation", Dimension::Length, rows, |row| {
            Some(row.indentation_m)
        }),
        Column::force(
            "force",
            rows,
            |row| Some(row.force_N),
            |row| digits(row.force_error_estimate),
        ),
        Column::radius(
            "contact radius",
            rows,
            |row| Some(row.contact_radius_m),
            |row| radius_digits(row.contact_radius_error_estimate),
        ),
        Column::length("floor gap", rows, |row| Some(row.smallest_floor_gap_m)),
        Column::right("pillars", |row: &StateRow| {
            row.pillars_in_contact.to_string()
        }),
        Column::right("partial", |row| {
            row.pillars_partially_in_contact.to_string()
        }),
        Column::text("", |row| remark(row).to_owned()),
    ]
}

fn remark(row: &StateRow) -> &'static str {
    match row {
        StateRow {
            converged: false, ..
        } => "not converged",
        StateRow { critical: true, .. } => "critical",
        StateRow {
            beyond_transition: true,
            ..
        } => "past it",
        _ => "",
    }
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
        indentations(&path, 2.5).unwrap()
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
        assert!(indentations(&path, 2.5).is_err());
    }
}
