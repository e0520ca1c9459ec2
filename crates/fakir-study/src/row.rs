//! The answer to one case, as it is kept: numbers only, each of which JSON gives back bit for bit.

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
    /// Why there is no answer, or none to be relied on.
    pub problem: Option<String>,
    /// How long it took, s. All other numbers are the same each time the case is solved.
    pub wall_time: f64,
}

/// What a case answers: the numbers of `fakir transition --json`, `fakir press --json` or `fakir cycle --json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RowAnswer {
    /// A contact under a load, the critical state, or a cycle.
    Numbers(Record),
    /// How a floor that sticks collapses and lets go.
    Collapse(Box<Collapsed>),
}
