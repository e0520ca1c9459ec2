//! Results as JSON objects and as tables, defined once for the command line, the Python package and the page. The names are a contract, and
//! end with the unit of the number.
//!
//! There is a file for every kind of result. The rows of a study with many cases are in [`Table`](crate::Table).

mod adhesion;
mod approach;
mod asperities;
mod compare;
mod cycle;
mod history;
mod pillars;
mod sweep;
mod theory;
mod verify;

pub use adhesion::{ANNULI_ALONE, AdhesionObject, AdhesiveFloorObject, PullOffRow};
pub use approach::{ApproachSummary, approach_table};
pub use asperities::{
    AsperityEventRow, AsperityStepRow, asperity_cycle_warnings, asperity_pillars,
    asperity_warnings, left_out_words,
};
pub use compare::{CompareSummary, MethodRow};
pub use cycle::{CycleSummary, EventRow, FloorRow, LoadStepRow, cycle_warnings};
pub use history::HistorySummary;
pub(crate) use history::csv_of;
pub use pillars::{pillars, pillars_of};
pub use sweep::SweepSummary;
pub use theory::{
    CoefficientRow, Constants, CurveRow, FormulaRow, SumRow, TheorySummary, constants,
};
pub use verify::{AnswerRow, MeshRow, SurfaceVerifySummary, VerifySummary};

/// Former name of [`AdhesiveFloorObject`].
#[deprecated(note = "renamed to `AdhesiveFloorObject`")]
pub type StuckFloorObject = AdhesiveFloorObject;

use crate::output::File;
use crate::record::{
    AsperityAnswer, AsperityCritical, FlatAnswer, GradientObject, Object, SurfaceAnswer,
};
use fakir::problem::{AsperityArray, FlatSystem, Load};
use fakir::state::{
    AsperityCycle, Contact, ContactState, CriticalState, FlatCycle, SurfaceContact, SurfaceCycle,
    SurfaceTransition, Termination, Unresolved, Warning,
};
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

/// A result as a JSON object with warnings about the case as written in its last key, `case_warnings`.
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

/// Warnings of a contact of any kind.
#[must_use]
pub fn warnings(contact: &impl Contact) -> Vec<String> {
    warnings_of(
        contact.warnings(),
        contact.termination(),
        contact.unresolved(),
    )
}

/// Texts of the warnings, and the reason for a missing result.
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

/// Description of a load: `contact under a force of 20 uN`, `critical state`.
#[must_use]
pub fn control_words(control: Load) -> String {
    match control {
        Load::Force(force) => format!(
            "contact under a force of {}",
            format_quantity(force, Dimension::Force)
        ),
        Load::Indentation(indentation) => format!(
            "contact at an indentation of {}",
            format_quantity(indentation, Dimension::Length)
        ),
        Load::FloorContact => "critical state".to_owned(),
    }
}

/// A contact under a load, with optional derivatives: what `fakir press --json` prints. The range of the attraction is in m, the time in s.
#[must_use]
pub fn press(
    state: &ContactState,
    range: Option<f64>,
    gradient: Option<GradientObject>,
    wall_time: f64,
) -> Object {
    Object::of(state)
        .with_limits(state.limits(range))
        .with_gradient(gradient)
        .timed(wall_time)
}

/// The critical state, likewise: what `fakir transition --json` prints.
#[must_use]
pub fn transition(
    critical: &CriticalState,
    range: Option<f64>,
    gradient: Option<GradientObject>,
    wall_time: f64,
) -> Object {
    Object::of(critical)
        .with_limits(critical.contact.limits(range))
        .with_gradient(gradient)
        .timed(wall_time)
}

/// A contact with a height map.
#[must_use]
pub fn surface_press(answer: &SurfaceAnswer<'_, SurfaceContact>, wall_time: f64) -> Object {
    Object::of(answer)
        .with_limits(answer.answer.limits(answer.system, None))
        .timed(wall_time)
}

/// The critical state with a height map.
#[must_use]
pub fn surface_transition(answer: &SurfaceAnswer<'_, SurfaceTransition>, wall_time: f64) -> Object {
    Object::of(answer)
        .with_limits(answer.answer.contact.limits(answer.system, None))
        .timed(wall_time)
}

/// A cycle with a height map: what `fakir cycle --json` prints. Limits are those of the end of the loading.
#[must_use]
pub fn surface_cycle(
    answer: &SurfaceAnswer<'_, SurfaceCycle>,
    range: Option<f64>,
    wall_time: f64,
) -> Object {
    Object::of(answer)
        .with_limits(answer.answer.turn.limits(answer.system, range))
        .timed(wall_time)
}

/// Warnings of a cycle with a height map.
#[must_use]
pub fn surface_cycle_warnings(cycle: &SurfaceCycle) -> Vec<String> {
    warnings_of(&cycle.turn.warnings, cycle.termination, cycle.unresolved())
}

/// The critical state with rounded tops.
#[must_use]
pub fn asperity_transition(critical: AsperityCritical<'_>, wall_time: f64) -> Object {
    Object::of(&critical).timed(wall_time)
}

/// A contact with a flat surface, likewise.
#[must_use]
pub fn flat_press(answer: &FlatAnswer<'_>, range: Option<f64>, wall_time: f64) -> Object {
    Object::of(answer)
        .with_limits(answer.contact.limits(answer.system, range))
        .timed(wall_time)
}

/// A cycle with a flat surface: what `fakir cycle --json` prints.
#[must_use]
pub fn flat_cycle(
    cycle: &FlatCycle,
    system: &FlatSystem,
    range: Option<f64>,
    wall_time: f64,
) -> Object {
    Object::of(cycle)
        .with_limits(cycle.turn.limits(system, range))
        .timed(wall_time)
}

/// A cycle of rounded tops: what `fakir cycle --json` prints. Limits are those of the end of the loading.
#[must_use]
pub fn asperity_cycle(
    cycle: &AsperityCycle,
    field: &AsperityArray,
    range: Option<f64>,
    wall_time: f64,
) -> Object {
    Object::of(cycle)
        .with_limits(cycle.turn.limits(field, range))
        .timed(wall_time)
}

/// A contact with rounded tops.
#[must_use]
pub fn asperity_press(answer: AsperityAnswer<'_>, wall_time: f64) -> Object {
    Object::of(&answer)
        .with_limits(answer.contact.limits(answer.field, None))
        .timed(wall_time)
}
