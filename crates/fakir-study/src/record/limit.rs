//! How near an answer comes to where the model ends.

use fakir::state::Limit;
use serde::Serialize;

/// A condition of the model, and how near this case comes to where it ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LimitObject {
    /// As [`ContactState::limits`](fakir::state::ContactState::limits) has it.
    pub name: &'static str,
    /// Its value here.
    pub value: f64,
    /// From where on the model is doubtful; none of what only would change the answer.
    pub threshold: Option<f64>,
    /// Whether it is doubtful here.
    pub strained: bool,
}

impl LimitObject {
    /// All of these.
    #[must_use]
    pub fn all(limits: Vec<Limit>) -> Vec<Self> {
        let object = |limit: Limit| Self {
            name: limit.name,
            value: limit.value,
            threshold: limit.threshold,
            strained: limit.strained,
        };
        limits.into_iter().map(object).collect()
    }
}
