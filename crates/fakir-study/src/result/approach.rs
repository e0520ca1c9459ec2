//! Loading in steps.

use crate::VERSION;
use crate::approach::{Approach, Loadable};
use crate::output::File;
use crate::record::{Object, Record};
use serde::Serialize;

/// A loading: what `fakir approach --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ApproachSummary {
    /// Method, indenter and surface.
    #[serde(flatten)]
    head: Object,
    /// `None` if the surface defines no floor.
    critical: Option<Object>,
    states: Vec<Object>,
    converged: bool,
    wall_time_s: f64,
    fakir_version: &'static str,
}

impl ApproachSummary {
    /// A loading of any problem.
    #[must_use]
    pub fn new<P: Loadable>(problem: &P, found: &Approach<P>) -> Self {
        let critical = found.critical.as_ref();
        Self {
            head: problem.head(),
            critical: critical.map(|critical| problem.critical(critical, found.critical_time)),
            states: found.rows.iter().map(Record::object).collect(),
            converged: found.converged,
            wall_time_s: found.wall_time,
            fakir_version: VERSION,
        }
    }
}

/// The states of a loading as a table.
#[must_use]
pub fn approach_table<P: Loadable>(found: &Approach<P>) -> File {
    File::new("approach.csv", Record::csv(&found.rows))
}
