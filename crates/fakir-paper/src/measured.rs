//! Measured critical states, to be drawn on the computed curves.
//!
//! A CSV file with a heading. `surface_fraction` must be there, and any of `critical_force_N`,
//! `critical_contact_radius_m`, `critical_indentation_m`; standard errors in columns of the same
//! name with `_error` before the unit, as in `critical_force_error_N`; and `substrate` (`rigid`,
//! `intermediate` or `soft`), `intermediate` if it is left out. Empty cells are not drawn.

use crate::grid::{Substrate, system};
use fakir::contact::Normalized;
use fakir_figure::Measured;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Why measured points cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {problem}", .path.display(), .line.map_or(String::new(), |line| format!(":{line}")))]
pub struct MeasuredError {
    path: PathBuf,
    line: Option<u64>,
    problem: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct Record {
    substrate: Option<String>,
    surface_fraction: f64,
    surface_fraction_error: Option<f64>,
    critical_force_N: Option<f64>,
    critical_force_error_N: Option<f64>,
    critical_contact_radius_m: Option<f64>,
    critical_contact_radius_error_m: Option<f64>,
    critical_indentation_m: Option<f64>,
    critical_indentation_error_m: Option<f64>,
}

/// Reads measured points.
///
/// # Errors
/// [`MeasuredError`] names file and line.
pub fn read(path: &Path) -> Result<Vec<(Substrate, Measured)>, MeasuredError> {
    let fail = |line, problem: String| MeasuredError {
        path: path.to_owned(),
        line,
        problem,
    };
    let bytes = std::fs::read(path).map_err(|error| fail(None, format!("cannot read: {error}")))?;
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(&bytes[..]);
    let mut points = Vec::new();
    for record in reader.deserialize() {
        let record: Record = record.map_err(|error| {
            let line = error.position().map(csv::Position::line);
            fail(line, error.to_string())
        })?;
        let line = Some(points.len() as u64 + 2);
        points.push(point(&record).map_err(|problem| fail(line, problem))?);
    }
    Ok(points)
}

fn point(record: &Record) -> Result<(Substrate, Measured), String> {
    let substrate = match record.substrate.as_deref() {
        None | Some("") => Substrate::Intermediate,
        Some(name) => Substrate::ALL
            .into_iter()
            .find(|substrate| substrate.name() == name)
            .ok_or_else(|| {
                format!("the substrate \"{name}\" is not known: give rigid, intermediate or soft")
            })?,
    };
    let phi = record.surface_fraction;
    let system = system(substrate, 0.0, phi).map_err(|error| error.one_line())?;
    let unit = Normalized::new(&system, 1.0, 1.0, 1.0);
    let scaled = |value: Option<f64>, error: Option<f64>, unit: f64| {
        value.map(|value| [value * unit, error.unwrap_or(0.0) * unit])
    };
    Ok((
        substrate,
        Measured {
            surface_fraction: [phi, record.surface_fraction_error.unwrap_or(0.0)],
            force: scaled(
                record.critical_force_N,
                record.critical_force_error_N,
                unit.force,
            ),
            contact_radius: scaled(
                record.critical_contact_radius_m,
                record.critical_contact_radius_error_m,
                unit.contact_radius,
            ),
            indentation: scaled(
                record.critical_indentation_m,
                record.critical_indentation_error_m,
                unit.indentation,
            ),
        },
    ))
}
