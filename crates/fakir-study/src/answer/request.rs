//! Questions on a case, options of the output, and errors.

use crate::approach::{ApproachError, LoadingPath};
use crate::history::HistoryPlan;
use fakir::problem::{Adhesion, CyclePlan, Load};
use fakir::state::{Run, SolveError};
use fakir_case::CaseError;

/// A question about one case.
#[derive(Debug, Clone, PartialEq)]
pub enum Request {
    /// The contact at a load, or the critical state.
    Contact(Load),
    /// Loading step by step.
    Loading(LoadingPath),
    /// Loading and unloading with adhesion.
    Cycle(CyclePlan),
    /// The contact of viscoelastic bodies over time.
    History(HistoryPlan),
}

/// Options of the output in addition to the numbers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Details {
    /// Range of the attraction, m, if it is given.
    pub range: Option<f64>,
    /// Whether the exact derivatives of a contact are computed.
    pub gradient: bool,
    /// Files of the answer.
    pub maps: Maps,
}

impl Details {
    /// Refuses a range of the attraction without adhesion.
    pub(super) fn check_range(&self, adhesion: Adhesion) -> Result<(), AnswerError> {
        if self.range.is_some() && adhesion.is_none() {
            return Err(AnswerError::Refused(
                "the range of the attraction has no meaning without adhesion: give a work of adhesion",
            ));
        }
        Ok(())
    }
}

/// Selection of tables, maps and figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Maps {
    /// None.
    #[default]
    None,
    /// All, with maps of this number of points across, or a number that suits the pillars.
    Points(Option<usize>),
}

/// Execution of a request: the options of the solver, and a function that is called with the name of each part of the computation.
pub struct Running<'a> {
    /// Memory, threads, progress and cancellation.
    pub run: Run<'a>,
    /// Called with the name of the next part.
    pub next: &'a dyn Fn(&str),
}

/// Errors of a request.
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
    /// A request that the case does not support.
    #[error("{0}")]
    Refused(&'static str),
}

impl AnswerError {
    /// The sufficient width of a grid that is too narrow for the contact, m.
    pub(crate) fn needed_width(&self) -> Option<f64> {
        match self {
            Self::Solve(error) => error.needed_width(),
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
