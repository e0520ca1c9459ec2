//! What can be asked of a case, what is wanted besides the numbers, and why there is no answer.

use crate::approach::{ApproachError, LoadingPath};
use fakir::problem::{CyclePlan, Load};
use fakir::state::{Run, SolveError};
use fakir_case::CaseError;

/// A question about one case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Request {
    /// The contact at a load, or the critical state.
    Contact(Load),
    /// Loading step by step.
    Loading(LoadingPath),
    /// Loading and unloading with adhesion.
    Cycle(CyclePlan),
}

/// What is wanted besides the numbers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Details {
    /// Range of the attraction, m, where it is known.
    pub range: Option<f64>,
    /// Whether the exact derivatives of a contact are wanted.
    pub gradient: bool,
    /// Files of the answer.
    pub maps: Maps,
}

/// Which tables, maps and figures are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Maps {
    /// None.
    #[default]
    None,
    /// All, with maps of so many points across, or as many as suit the pillars.
    Points(Option<usize>),
}

/// How a question is answered: the options of the solver, and a function that is called with the name of each part of the computation.
pub struct Running<'a> {
    /// Memory, threads, progress and cancellation.
    pub run: Run<'a>,
    /// Called with the name of the next part.
    pub next: &'a dyn Fn(&str),
}

/// Why a question has no answer.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum AnswerError {
    /// An invalid case.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// A contact that cannot be computed.
    #[error("{}", fakir_case::with_keys(.0))]
    Solve(#[from] SolveError),
    /// A loading that cannot be computed.
    #[error(transparent)]
    Loading(ApproachError),
    /// A request that does not go with the case.
    #[error("{0}")]
    Refused(&'static str),
}

impl AnswerError {
    /// The width that a grid needs which is too narrow for the contact, m.
    pub(crate) fn needed_width(&self) -> Option<f64> {
        match self {
            Self::Solve(SolveError::SurfaceEnds { needed, .. }) => Some(*needed),
            _ => None,
        }
    }
}

impl From<ApproachError> for AnswerError {
    fn from(error: ApproachError) -> Self {
        match error {
            ApproachError::Solve(error) => Self::Solve(error),
            other => Self::Loading(other),
        }
    }
}
