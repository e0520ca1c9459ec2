//! The contact of viscoelastic bodies over time.

use crate::VERSION;
use crate::approach::Loadable;
use crate::history::Followed;
use crate::output::File;
use crate::record::{HistoryAnswer, Object, Record, SCHEMA_VERSION};
use serde::Serialize;

/// A history: what `fakir hold --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HistorySummary {
    /// Its numbers.
    #[serde(flatten)]
    numbers: Object,
    events: Vec<Object>,
    states: Vec<Object>,
    /// Method, indenter and surface.
    #[serde(flatten)]
    head: Object,
    warnings: Vec<String>,
    wall_time_s: f64,
    fakir_version: &'static str,
    schema_version: u32,
}

impl HistorySummary {
    /// A history of any problem.
    #[must_use]
    pub fn new<P: Loadable>(problem: &P, found: &Followed<P>) -> Self {
        let numbers = HistoryAnswer::of(found);
        let events = found.history.events.iter();
        Self {
            numbers: numbers.map_or_else(Object::default, |numbers| Object::of(&numbers)),
            events: events.map(|event| Record::of(event).object()).collect(),
            states: found.rows().iter().map(Record::object).collect(),
            head: problem.head(),
            warnings: found.warnings.clone(),
            wall_time_s: found.wall_time,
            fakir_version: VERSION,
            schema_version: SCHEMA_VERSION,
        }
    }
}

/// Records of one kind as a table.
pub(crate) fn csv_of(name: &'static str, rows: &[Record]) -> File {
    File::new(name, Record::csv(rows))
}
