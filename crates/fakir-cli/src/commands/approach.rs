//! `fakir approach`: quasi-static loading from first touch to the critical state.

use super::surface::on_wide_enough_a_grid;
use crate::failure::Failure;
use crate::numbers::digits;
use crate::report::Report;
use crate::report::asperities::{case_line, method_line};
use crate::report::figures::of_loading;
use crate::report::state::{further_on, loading_remark, radius_digits, texture_line};
use crate::report::surface;
use crate::report::table::{Column, table};
use crate::session::Session;
use fakir::state::Contact;
use fakir_case::AnyCase;
use fakir_case::unit::Dimension;
use fakir_figure::LoadingPoint;
use fakir_study::approach::{Approach, Loadable, LoadingPath, approach};
use fakir_study::citations::Topic;
use fakir_study::provenance::{Provenance, method_words};
use fakir_study::record::{Record, indenter_name};
use fakir_study::result::{ApproachSummary, approach_table, json};

/// Digits shown of what changes by whole cells, and has no error estimate on too few of them.
const CELL_DIGITS: usize = 4;

/// What a report says beside the states.
struct Words {
    indenter: &'static str,
    case: String,
    method: String,
}

/// The loading of a case of any kind.
pub(crate) fn run(
    case: &AnyCase,
    path: &LoadingPath,
    saves: bool,
    session: &Session,
) -> Result<Report, Failure> {
    let next = |part: &str| session.part(part);
    let run = session.run();
    match case {
        AnyCase::Pillars(case) => {
            let problem = (case.system.clone(), case.method);
            let found = approach(&problem, path, &run, &next, &mut |_, _| {})?;
            let words = Words {
                indenter: "lens",
                case: texture_line(&case.system),
                method: method_words(case.method),
            };
            let topics = Topic::of_case(case);
            let provenance =
                Provenance::new(path.words(), words.method.clone(), &topics, case.to_toml());
            Ok(report(&problem, found, &words, provenance, saves))
        }
        AnyCase::Asperities(case) => {
            let found = approach(&**case, path, &run, &next, &mut |_, _| {})?;
            let words = Words {
                indenter: indenter_name(case.field.indenter()),
                case: case_line(case),
                method: method_line(case.accuracy),
            };
            let topics = [Topic::Asperities];
            let provenance =
                Provenance::new(path.words(), words.method.clone(), &topics, case.to_toml());
            Ok(report(&**case, found, &words, provenance, saves))
        }
        AnyCase::HeightMap(file) => {
            let (case, found, widened) = on_wide_enough_a_grid(file, session, |case| {
                Ok(approach(&case.system, path, &run, &next, &mut |_, _| {})?)
            })?;
            let [surface, cells] = surface::description(&case);
            let words = Words {
                indenter: indenter_name(case.system.indenter()),
                case: surface,
                method: cells,
            };
            let provenance = surface::provenance(&case, &path.words());
            let mut report = report(&case.system, found, &words, provenance, saves);
            report.warnings.extend(widened);
            Ok(report)
        }
    }
}

fn report<P: Loadable>(
    problem: &P,
    found: Approach<P>,
    words: &Words,
    provenance: Provenance,
    saves: bool,
) -> Report {
    let rows = &found.rows;
    let mut tables = vec![approach_table(&found)];
    if saves {
        tables.extend(of_loading(&found, point, &provenance));
    }
    let further = match &found.critical {
        Some(critical) if !rows.iter().any(|row| row.is("critical")) => {
            further_on(critical.contact.indentation(), critical.contact.force())
        }
        _ => String::new(),
    };
    Report {
        json: json(&ApproachSummary::new(problem, &found)),
        text: format!(
            "Approach of the {}\n{}\n{}\n\n{}{further}",
            words.indenter,
            words.case,
            words.method,
            table(rows, &columns(rows))
        ),
        provenance,
        tables,
        converged: found.converged,
        strained: Vec::new(),
        warnings: found.warnings,
    }
}

/// A state in the figure of the loading.
fn point(row: &Record) -> LoadingPoint {
    let pillars = row.count("pillars_in_contact");
    let partial = row.count("pillars_partially_in_contact");
    LoadingPoint {
        indentation: row.number("indentation_m").unwrap_or(f64::NAN),
        force: row.number("force_N").unwrap_or(f64::NAN),
        floor_force: row.number("floor_force_N"),
        contact_radius: row.number("contact_radius_m"),
        pillars: pillars.zip(partial).map(|(all, partial)| [all, partial]),
        without_floor: row
            .number("smallest_floor_gap_m")
            .is_some_and(|gap| gap < 0.0),
    }
}

/// The columns that some of the states have.
fn columns(rows: &[Record]) -> Vec<Column<Record>> {
    let some = |name: &str| rows.iter().any(|row| row.number(name).is_some());
    let counted = |name: &str| rows.iter().any(|row| row.count(name).is_some());
    fn known(row: &Record, error: &str) -> usize {
        row.number(error).map_or(CELL_DIGITS, digits)
    }
    let mut columns = vec![
        Column::quantity("indentation", Dimension::Length, rows, |row| {
            row.number("indentation_m")
        }),
        Column::force(
            "force",
            rows,
            |row| row.number("force_N"),
            |row| known(row, "force_error_estimate"),
        ),
    ];
    let is_past = rows.iter().any(|row| row.is("beyond_transition"));
    if some("floor_force_N") && (is_past || some("tops_force_N")) {
        columns.push(Column::force(
            "on the floor",
            rows,
            |row| row.number("floor_force_N"),
            |row| match row.number("smallest_floor_gap_m") {
                Some(_) => digits(row.number("floor_share_error_estimate").unwrap_or(0.0)),
                None => CELL_DIGITS,
            },
        ));
    }
    if some("contact_area_m2") {
        columns.push(Column::number("contact area (um^2)", CELL_DIGITS, |row| {
            Some(1e12 * row.number("contact_area_m2")?)
        }));
    }
    if some("contact_radius_m") {
        columns.push(Column::radius(
            "contact radius",
            rows,
            |row| row.number("contact_radius_m"),
            |row| match (
                row.number("contact_radius_error_estimate"),
                row.number("contact_area_error_estimate"),
            ) {
                (Some(error), _) => radius_digits(error),
                // Cells without an estimate, or rounded tops, whose radius is as well known as their area.
                (None, error) => radius_digits(error.unwrap_or(f64::NAN)),
            },
        ));
    }
    if some("smallest_floor_gap_m") {
        columns.push(Column::length("floor gap", rows, |row| {
            row.number("smallest_floor_gap_m")
        }));
    }
    if counted("pillars_in_contact") {
        columns.push(Column::right("pillars", |row: &Record| {
            count(row, "pillars_in_contact")
        }));
    }
    if counted("pillars_partially_in_contact") {
        columns.push(Column::right("partial", |row| {
            count(row, "pillars_partially_in_contact")
        }));
    }
    columns.push(Column::text("", |row| {
        let is = |name| row.is(name);
        loading_remark(is("converged"), is("critical"), is("beyond_transition")).to_owned()
    }));
    columns
}

fn count(row: &Record, name: &str) -> String {
    row.count(name)
        .map_or(String::new(), |count| count.to_string())
}
