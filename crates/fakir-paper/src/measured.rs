//! Measured critical states, drawn with the computed curves.
//!
//! The CSV file has a heading. The column `surface_fraction` is required, with any of
//! `critical_force_N`, `critical_contact_radius_m` and `critical_indentation_m`. Standard errors
//! are in columns of the same name with `_error` before the unit, as in `critical_force_error_N`.
//! The column `substrate` contains `rigid`, `intermediate` (default) or `soft`. Empty cells are not
//! drawn.

use crate::grid::{Substrate, system};
use fakir::state::Normalized;
use fakir_case::input::{self, LARGEST_TABLE};
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
    let bytes = input::read(path, LARGEST_TABLE)
        .map_err(|error| fail(None, format!("cannot read: {error}")))?;
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

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        std::fs::write(&path, text).unwrap();
        (folder, path)
    }

    #[test]
    fn points_are_reduced_with_their_errors() {
        let (_folder, path) = file(
            "surface_fraction, substrate, critical_force_N, critical_force_error_N\n\
             0.01, soft, 1.5e-7, 1e-8\n0.05, , ,\n",
        );
        let points = read(&path).unwrap();
        let (substrate, first) = points[0];
        assert_eq!(substrate, Substrate::Soft);
        // gamma_int/(h d) from its definition, gamma_int = 3/(4 E_l) + 3/(4 E_s) + 4h/(pi E_s d).
        let compliance = 0.75 / 2e6 + 0.75 / 2e3 + 4.0 * 2.2 / (6.0 * std::f64::consts::PI * 2e3);
        let unit = compliance / (2.2e-6 * 6e-6);
        let [force, error] = first.force.unwrap();
        assert!((force / (1.5e-7 * unit) - 1.0).abs() < 1e-12);
        assert!((error / (1e-8 * unit) - 1.0).abs() < 1e-12);
        assert_eq!(points[1].0, Substrate::Intermediate);
        assert!(points[1].1.force.is_none());
    }

    #[test]
    fn what_cannot_be_read_names_the_line() {
        for (text, message) in [
            ("surface_fraction\n0.01\nmuch\n", "points.csv:3: "),
            (
                "surface_fraction,substrate\n0.01,rubber\n",
                "points.csv:2: the substrate",
            ),
            ("surface_fraction\n1.5\n", "points.csv:2: "),
            ("fraction\n0.1\n", "points.csv:2: "),
        ] {
            let (_folder, path) = file(text);
            let error = read(&path).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
