//! Loading of a case of any kind, from first touch to the critical state or another end.

use super::kind::{Context, Found, Kind, Saved};
use super::request::{AnswerError, Running};
use crate::approach::{Approach, LoadingPath, approach};
use crate::figures::saved;
use crate::numbers::digits;
use crate::provenance::Provenance;
use crate::record::Record;
use crate::report::state::{further_on, loading_remark, radius_digits};
use crate::report::table::{Column, table};
use crate::result::{ApproachSummary, approach_table, json};
use fakir::state::{Contact, Limit};
use fakir_case::unit::Dimension;
use fakir_figure::LoadingPoint;

/// Digits shown of quantities that change by whole cells, and have no error estimate on too few cells.
const CELL_DIGITS: usize = 4;

/// A loading.
struct Loaded<K: Kind> {
    path: LoadingPath,
    found: Approach<K::Problem>,
}

/// The loading of a case.
pub(super) fn loading<K: Kind>(
    case: &K,
    path: &LoadingPath,
    running: &Running<'_>,
) -> Result<Box<dyn Found<K>>, AnswerError> {
    let Running { run, next } = running;
    let found = approach(case.problem(), path, run, next, &mut |_, _| {})?;
    Ok(Box::new(Loaded { path: *path, found }))
}

impl<K: Kind> Found<K> for Loaded<K> {
    fn question(&self) -> String {
        self.path.words()
    }

    fn records(&self, _: &K) -> Vec<Record> {
        self.found.rows.clone()
    }

    fn is_answer(&self) -> bool {
        self.found.converged
    }

    fn problem(&self) -> Option<String> {
        (!self.found.converged).then(|| "a state of the loading did not converge".to_owned())
    }

    fn json(&self, of: &Context<'_, K>) -> String {
        json(&ApproachSummary::new(of.case.problem(), &self.found))
    }

    fn text(&self, of: &Context<'_, K>) -> String {
        let rows = &self.found.rows;
        let further = match &self.found.critical {
            Some(critical) if !rows.iter().any(|row| row.is("critical")) => {
                further_on(critical.contact.indentation(), critical.contact.force())
            }
            _ => String::new(),
        };
        format!(
            "Approach of the {}\n{}\n\n{}{further}",
            of.case.indenter(),
            of.case.lines().join("\n"),
            table(rows, &columns(rows))
        )
    }

    fn limits(&self, _: &Context<'_, K>) -> Vec<Limit> {
        Vec::new()
    }

    fn warnings(&self, _: &Context<'_, K>, _: &Running<'_>) -> Result<Vec<String>, AnswerError> {
        Ok(self.found.warnings.clone())
    }

    /// The table, and a figure if there are several states.
    fn files(
        &self,
        _: &K,
        _: Option<usize>,
        provenance: &Provenance,
        _: &Running<'_>,
    ) -> Result<Saved, AnswerError> {
        let points: Vec<LoadingPoint> = self.found.rows.iter().map(point).collect();
        let critical = self.found.critical.as_ref().map(|critical| LoadingPoint {
            indentation: critical.contact.indentation(),
            force: critical.contact.force(),
            floor_force: None,
            contact_radius: critical.contact.contact_radius(),
            pillars: None,
            without_floor: false,
        });
        let mut files = vec![approach_table(&self.found)];
        if let Ok(figure) = fakir_figure::approach(&points, critical) {
            files.extend(saved(figure, provenance));
        }
        Ok(Saved {
            files,
            warnings: Vec::new(),
        })
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

/// Columns with a value for some of the states.
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
                // Cells without an estimate, or rounded tops, whose radius is as accurate as their area.
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
