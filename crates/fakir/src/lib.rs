//! Contact between a smooth elastic lens and a surface patterned with pillars.
pub mod contact;
mod coupling;
mod disc;
pub mod system;
pub mod theory;

use contact::{ContactState, CriticalState, Load, Method, Run, SolveError};
use system::System;

/// The contact under a load, by the given method.
///
/// # Errors
/// A load that cannot be, a contact too large for the lens or for memory, or interruption:
/// see [`SolveError`]. A solution that did not converge is not an error: it says so in
/// [`ContactState::termination`].
pub fn press(
    system: &System,
    load: Load,
    method: Method,
    run: &Run<'_>,
) -> Result<ContactState, SolveError> {
    let _ = (system, load, method, run);
    Err(SolveError::Interrupted)
}

/// The critical state, in which the lens just reaches the floor, by the given method.
///
/// # Errors
/// As [`press`].
pub fn transition(
    system: &System,
    method: Method,
    run: &Run<'_>,
) -> Result<CriticalState, SolveError> {
    let _ = (system, method, run);
    Err(SolveError::Interrupted)
}
