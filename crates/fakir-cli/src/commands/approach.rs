//! `fakir approach`: quasi-static loading from first touch to the critical state.

use crate::failure::Failure;
use crate::numbers::digits;
use crate::report::Report;
use crate::report::figures::of_loading;
use crate::report::state::{further_on, loading_remark, radius_digits, texture_line};
use crate::report::table::{Column, table};
use crate::session::Session;
use fakir::state::CriticalState;
use fakir_case::Case;
use fakir_case::unit::Dimension;
use fakir_figure::LoadingPoint;
use fakir_study::approach::{LoadingPath, approach};
use fakir_study::citations::Topic;
use fakir_study::provenance::{Provenance, method_words};
use fakir_study::result::{ApproachSummary, LoadingRow, csv, json};

pub(crate) fn run(
    case: &Case,
    path: &LoadingPath,
    saves: bool,
    session: &Session,
) -> Result<Report, Failure> {
    let next = |part: &str| session.part(part);
    let run = session.run();
    let problem = (case.system.clone(), case.method);
    let found = approach(&problem, path, &run, &next, &mut |_, _| {})?;
    let rows = &found.rows;
    let provenance = Provenance::new(
        path.words(),
        method_words(case.method),
        &Topic::of_case(case),
        case.to_toml(),
    );
    let mut tables = vec![csv("approach.csv", rows)];
    if saves {
        let point = |row: &LoadingRow| LoadingPoint {
            indentation: row.indentation_m,
            force: row.force_N,
            floor_force: row.floor_force_N,
            contact_radius: Some(row.contact_radius_m),
            pillars: Some([row.pillars_in_contact, row.pillars_partially_in_contact]),
            without_floor: row.smallest_floor_gap_m < 0.0,
        };
        tables.extend(of_loading(&found, point, &provenance));
    }
    Ok(Report {
        json: json(&ApproachSummary::new(case.method, &found)),
        text: text(case, found.critical.as_ref(), rows),
        provenance,
        tables,
        converged: found.converged,
        strained: Vec::new(),
        warnings: found.warnings,
    })
}

fn text(case: &Case, critical: Option<&CriticalState>, rows: &[LoadingRow]) -> String {
    let reached = match critical {
        Some(critical) if !rows.iter().any(|row| row.critical) => {
            further_on(critical.contact.indentation, critical.contact.force)
        }
        _ => String::new(),
    };
    format!(
        "Approach of the lens\n{}\n{}\n\n{}{reached}",
        texture_line(&case.system),
        method_words(case.method),
        table(rows, &columns(rows))
    )
}

fn columns(rows: &[LoadingRow]) -> Vec<Column<LoadingRow>> {
    let mut columns = vec![
        Column::quantity("indentation", Dimension::Length, rows, |row| {
            Some(row.indentation_m)
        }),
        Column::force(
            "force",
            rows,
            |row| Some(row.force_N),
            |row| digits(row.force_error_estimate),
        ),
    ];
    if rows.iter().any(|row| row.beyond_transition) {
        columns.push(Column::force(
            "on the floor",
            rows,
            |row| row.floor_force_N,
            |row| digits(row.floor_share_error_estimate.unwrap_or(0.0)),
        ));
    }
    columns.extend([
        Column::radius(
            "contact radius",
            rows,
            |row| Some(row.contact_radius_m),
            |row| radius_digits(row.contact_radius_error_estimate),
        ),
        Column::length("floor gap", rows, |row| Some(row.smallest_floor_gap_m)),
        Column::right("pillars", |row: &LoadingRow| {
            row.pillars_in_contact.to_string()
        }),
        Column::right("partial", |row| {
            row.pillars_partially_in_contact.to_string()
        }),
        Column::text("", |row| {
            loading_remark(row.converged, row.critical, row.beyond_transition).to_owned()
        }),
    ]);
    columns
}
