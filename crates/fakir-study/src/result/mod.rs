//! Results as JSON objects and as tables, made once: what the command line, the Python package and
//! the page show. The names are a contract, and end in the unit of the number.
//!
//! There is a file for every kind of result. Of a study with many cases [`Table`](crate::Table) has
//! the rows.

mod adhesion;
mod approach;
mod compare;
mod contact;
mod critical;
mod cycle;
mod gradient;
mod pillars;
mod rounded;
mod surface;
mod sweep;
mod theory;
mod verify;

pub use adhesion::{ANNULI_ALONE, AdhesionObject, LimitObject, PullOffRow, StuckFloorObject};
pub use approach::{ApproachSummary, LoadingRow, SurfaceApproachSummary, SurfaceLoadingRow};
pub use compare::{CompareSummary, MethodRow};
pub use contact::{FloorObject, PressSummary, of_floor};
pub use critical::TransitionSummary;
pub use cycle::{CycleErrorObject, CycleSummary, EventRow, FloorRow, StationRow, cycle_warnings};
pub use gradient::GradientObject;
pub use pillars::{pillars, pillars_of};
pub use rounded::{RoundedPressSummary, left_out_words, rounded_pillars, rounded_warnings};
pub(crate) use surface::METHOD as SURFACE_METHOD;
pub use surface::{SurfacePressSummary, SurfaceTransitionSummary, indenter_name};
pub use sweep::SweepSummary;
pub use theory::{
    CoefficientRow, Constants, CurveRow, FormulaRow, SumRow, TheorySummary, constants,
};
pub use verify::{AnswerRow, MeshRow, SurfaceVerifySummary, VerifySummary};

use crate::output::File;
use fakir::problem::Control;
use fakir::state::{Contact, ErrorEstimate, Normalized, Termination, Unresolved, Warning};
use fakir_case::unit::{Dimension, format_quantity};
use serde::Serialize;

/// A result as a JSON object, with its keys in the order of the contract.
///
/// # Panics
/// Never: all results of this module have named fields.
#[must_use]
pub fn json(result: &impl Serialize) -> String {
    serde_json::to_string_pretty(result).expect("structs with named fields are JSON objects")
}

/// A result as a JSON object that has warnings about the case as it is written besides: its last key, `case_warnings`.
#[must_use]
pub fn with_case_warnings(object: &str, warnings: &[String]) -> String {
    #[derive(Serialize)]
    struct Warnings<'a> {
        case_warnings: &'a [String],
    }
    let last = json(&Warnings {
        case_warnings: warnings,
    });
    let own = object.strip_suffix('}').unwrap_or(object).trim_end();
    format!("{own},{}", last.trim_start_matches('{'))
}

/// Rows of a result as CSV, with the names of their fields as heading.
///
/// # Panics
/// Never: all rows of this module are flat.
pub fn csv<T: Serialize>(name: &'static str, rows: impl IntoIterator<Item = T>) -> File {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).expect("flat structs are CSV records");
    }
    let bytes = writer.into_inner().expect("memory takes every byte");
    File::new(name, bytes)
}

/// What to be careful about, of a contact of either kind.
#[must_use]
pub fn warnings(contact: &impl Contact) -> Vec<String> {
    warnings_of(
        contact.warnings(),
        contact.termination(),
        contact.unresolved(),
    )
}

/// Warnings in words, and why there is no answer if there is none.
fn warnings_of(
    warnings: &[Warning],
    termination: Termination,
    unresolved: Option<Unresolved>,
) -> Vec<String> {
    let mut words: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    if termination != Termination::Converged {
        words.push(format!("the solution {}", termination.description()));
    }
    words.extend(unresolved.map(|it| it.to_string()));
    words
}

/// What is asked in words: `contact under a force of 20 uN`, `critical state`.
#[must_use]
pub fn control_words(control: Control) -> String {
    match control {
        Control::Force(force) => format!(
            "contact under a force of {}",
            format_quantity(force, Dimension::Force)
        ),
        Control::Indentation(indentation) => format!(
            "contact at an indentation of {}",
            format_quantity(indentation, Dimension::Length)
        ),
        Control::FloorContact => "critical state".to_owned(),
    }
}

/// Estimated relative errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RelativeErrors {
    /// Relative error of the force.
    pub force: f64,
    /// Relative error of the indentation.
    pub indentation: f64,
    /// Relative error of the contact radius, of a critical state the larger one; `None` under a plate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_radius: Option<f64>,
    /// Relative error of the radius of the contact on the pillar tops, of a critical state.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub top_contact_radius: Option<f64>,
    /// Relative error of the floor's share, where it is compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor_share: Option<f64>,
}

impl RelativeErrors {
    /// Errors with that of the contact radius.
    #[must_use]
    pub fn new(error: ErrorEstimate, contact_radius: Option<f64>) -> Self {
        Self {
            force: error.force,
            indentation: error.indentation,
            contact_radius,
            top_contact_radius: None,
            floor_share: None,
        }
    }
}

/// The paper's reduced variables.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ReducedVariables {
    /// `F gamma_int/(h d)`.
    pub force: f64,
    /// `a/e`.
    pub contact_radius: f64,
    /// `zeta/h`.
    pub indentation: f64,
}

impl From<Normalized> for ReducedVariables {
    fn from(normalized: Normalized) -> Self {
        Self {
            force: normalized.force,
            contact_radius: normalized.contact_radius,
            indentation: normalized.indentation,
        }
    }
}
