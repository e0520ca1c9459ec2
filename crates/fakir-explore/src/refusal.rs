//! Error responses: what is wrong, at which key, and what is accepted.

use crate::http::{self, Response};
use fakir::state::SolveError;
use fakir_case::{CaseError, Key};
use fakir_figure::FigureError;
use hyper::StatusCode;
use serde::Serialize;

/// Reason why a request is refused.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Refusal {
    #[serde(skip)]
    pub(crate) status: StatusCode,
    /// Key of the case that causes the error, if any.
    key: Option<String>,
    message: String,
    accepted: Option<String>,
}

impl Refusal {
    pub(crate) fn new(status: StatusCode, message: impl Into<String>) -> Self {
        Self {
            status,
            key: None,
            message: message.into(),
            accepted: None,
        }
    }

    /// An invalid request.
    pub(crate) fn malformed(message: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, message)
    }

    /// A valid request for a case without a result.
    pub(crate) fn impossible(message: impl Into<String>) -> Self {
        Self::new(StatusCode::UNPROCESSABLE_ENTITY, message)
    }

    /// A newer request of the same kind was received.
    pub(crate) fn stale() -> Self {
        Self::new(StatusCode::CONFLICT, "a newer request took its place")
    }

    pub(crate) fn at(mut self, key: impl Into<String>) -> Self {
        self.key = Some(key.into());
        self
    }

    pub(crate) fn accepted(mut self, accepted: impl Into<String>) -> Self {
        self.accepted = Some(accepted.into());
        self
    }

    pub(crate) fn message(&self) -> &str {
        &self.message
    }

    /// The refusal as JSON.
    pub(crate) fn response(&self) -> Response {
        let text = serde_json::to_vec(self).unwrap_or_default();
        let mut response = http::whole("application/json", text);
        *response.status_mut() = self.status;
        response
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
            status: StatusCode::UNPROCESSABLE_ENTITY,
            key: error.key_path().map(str::to_owned),
            message: error.problem().to_owned(),
            accepted: error.what_is_accepted().map(str::to_owned),
        }
    }
}
