//! The stored answer to one case: numbers only, which JSON reproduces bit for bit.

use crate::collapsed::Collapsed;
use crate::record::Record;
use fakir_case::study::Coordinate;
use serde::{Deserialize, Serialize};

/// One case of a sweep, with its answer or the reason why there is none.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Number of the case in its study, from 0.
    pub index: usize,
    /// The value of every axis.
    pub coordinates: Vec<Coordinate>,
    /// The answer, also if it did not converge.
    pub answer: Option<RowAnswer>,
    /// The reason why there is no answer, or no reliable one.
    pub problem: Option<String>,
    /// Computing time, s. All other numbers are the same whenever the case is solved.
    pub wall_time: f64,
}

/// The answer to a case: the numbers of `fakir transition --json`, `fakir press --json` or `fakir cycle --json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RowAnswer {
    /// A contact under a load, the critical state, or a cycle.
    Numbers(Record),
    /// Collapse and detachment of an adhesive floor.
    Collapse(Box<Collapsed>),
}
