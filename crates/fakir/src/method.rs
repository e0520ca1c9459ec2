//! The one place where a question goes to a method.

use crate::problem::{Accuracy, Load, Method, System};
use crate::solve::answers;
use crate::solve::answers::{FloorModel, PillarMethod};
use crate::state::{ContactState, CriticalState, Run, SolveError};
use crate::theory;

/// The contact under a load, by the given method.
///
/// A load past the transition is answered as if the floor were not there; the smallest floor
/// gap is then negative.
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
    let load = load.checked(0.5 * system.pillar().diameter, system.reduced_modulus())?;
    let ignored = FloorModel::Ignored;
    match method {
        Method::Spectral(accuracy) => {
            answers::press(system, load, PillarMethod::Spectral(accuracy), ignored, run)
        }
        Method::Punch(form) => {
            answers::press(system, load, PillarMethod::Punch(form), ignored, run)
        }
        Method::Love(mesh) => answers::press(system, load, PillarMethod::Love(mesh), ignored, run),
        Method::Homogenised => theory::homogenised::pressed(system, load, run),
    }?
    .checked()
}

/// The contact under a load with pillar tops and floor, by the spectral method.
///
/// As long as the lens does not reach the floor this is [`press`]. Past the transition the floor between the pillars bears its part,
/// which is in [`ContactState::floor`]; and where the lens reaches the floor before any pillar, it rests on the floor until it comes down
/// to the pillars.
///
/// # Errors
/// As [`press`], and [`SolveError::TooManyCells`] where the floor in contact takes more memory than is allowed.
pub fn press_with_floor(
    system: &System,
    load: Load,
    accuracy: Accuracy,
    run: &Run<'_>,
) -> Result<ContactState, SolveError> {
    let load = load.checked(0.5 * system.pillar().diameter, system.reduced_modulus())?;
    let method = PillarMethod::Spectral(accuracy);
    answers::press(system, load, method, FloorModel::Contact, run)?.checked()
}

/// The critical state, in which the lens just reaches the floor, by the given method.
///
/// Where the lens reaches the floor before any pillar, that is a valid answer: the critical
/// indentation is the pillar height and the critical force zero.
///
/// # Errors
/// As [`press`].
pub fn transition(
    system: &System,
    method: Method,
    run: &Run<'_>,
) -> Result<CriticalState, SolveError> {
    match method {
        Method::Spectral(accuracy) => {
            answers::transition(system, PillarMethod::Spectral(accuracy), run)
        }
        Method::Punch(form) => answers::transition(system, PillarMethod::Punch(form), run),
        Method::Love(mesh) => answers::transition(system, PillarMethod::Love(mesh), run),
        Method::Homogenised => theory::homogenised::critical(system, run),
    }?
    .checked()
}
