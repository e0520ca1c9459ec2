//! Why a figure cannot be drawn.

use fakir::state::SolveError;

/// Why a figure cannot be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// The state has no fields: nothing is in contact, or the method does not resolve pillars.
    #[error(
        "this figure shows single pillars, but in this state none is touched, or the {method} \
         method does not resolve them"
    )]
    NoPillars {
        /// Name of the method.
        method: &'static str,
    },
    /// The floor is not in contact, or floor contact is ignored.
    #[error("this figure shows the load of the floor, which is zero in this state")]
    NoFloorContact,
    /// Too few data for the figure.
    #[error("this figure needs at least {fewest} values, but there are {given}")]
    TooFewData {
        /// Smallest number required.
        fewest: usize,
        /// Number given.
        given: usize,
    },
    /// The computation of fields was cancelled.
    #[error(transparent)]
    Solve(#[from] SolveError),
}
