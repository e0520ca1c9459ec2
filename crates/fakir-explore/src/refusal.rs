//! Error responses: what is wrong, at which key, and what is accepted.

use fakir::state::SolveError;
use fakir_case::{CaseError, Key};
use fakir_figure::FigureError;
use serde::Serialize;

/// Status of an invalid request.
const BAD_REQUEST: u16 = 400;

/// Status of a request that a newer one replaced.
#[cfg(feature = "server")]
const CONFLICT: u16 = 409;

/// Status of a valid request without a result.
const UNPROCESSABLE_ENTITY: u16 = 422;

/// Reason why a request is refused.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Refusal {
    /// Status of HTTP.
    #[serde(skip)]
    pub(crate) status: u16,
    /// Key of the case that causes the error, if any.
    key: Option<String>,
    message: String,
    accepted: Option<String>,
}

impl Refusal {
    pub(crate) fn new(status: u16, message: impl Into<String>) -> Self {
        Self {
            status,
            key: None,
            message: message.into(),
            accepted: None,
        }
    }

    /// An invalid request.
    pub(crate) fn malformed(message: impl Into<String>) -> Self {
        Self::new(BAD_REQUEST, message)
    }

    /// A valid request for a case without a result.
    pub(crate) fn impossible(message: impl Into<String>) -> Self {
        Self::new(UNPROCESSABLE_ENTITY, message)
    }

    /// A newer request of the same kind was received.
    #[cfg(feature = "server")]
    pub(crate) fn stale() -> Self {
        Self::new(CONFLICT, "a newer request took its place")
    }

    pub(crate) fn at(mut self, key: impl Into<String>) -> Self {
        self.key = Some(key.into());
        self
    }

    pub(crate) fn accepted(mut self, accepted: impl Into<String>) -> Self {
        self.accepted = Some(accepted.into());
        self
    }

    #[cfg(feature = "server")]
    pub(crate) fn message(&self) -> &str {
        &self.message
    }

    /// Response to a computation that failed; `None` if it was cancelled.
    pub(crate) fn of(error: &SolveError) -> Option<Self> {
        let refusal = Self::impossible(error.to_string());
        match error {
            SolveError::Interrupted => None,
            SolveError::PatternTooDense { .. } => Some(refusal.at(Key::MethodName.path())),
            SolveError::MeshTooCoarse { .. } => Some(refusal.at(Key::CellsPerDiameter.path())),
            _ => Some(refusal),
        }
    }

    /// Response to a figure that could not be drawn.
    pub(crate) fn of_figure(error: &FigureError) -> Option<Self> {
        match error {
            FigureError::Solve(error) => Self::of(error),
            other => Some(Self::impossible(other.to_string())),
        }
    }
}

impl From<CaseError> for Refusal {
    fn from(error: CaseError) -> Self {
        Self {
            status: UNPROCESSABLE_ENTITY,
            key: error.key_path().map(str::to_owned),
            message: error.problem().to_owned(),
            accepted: error.what_is_accepted().map(str::to_owned),
        }
    }
}
