//! The one place where a question goes to a method.

use crate::problem::{Control, Method, System};
use crate::solve::answers;
use crate::solve::assembled::PillarMethod;
use crate::state::{ContactState, CriticalState, Run, SolveError};
use crate::theory;

/// The contact under what is prescribed, by the given method.
///
/// Past the transition the spectral method has the floor bear its part: [`ContactState::floor`]. By the other methods, and where the
/// [system](System::with_floor) ignores the floor, such a load is answered as if that were not there; the smallest floor gap is
/// then negative.
///
/// # Errors
/// A load that cannot be, a contact too large for the lens or for memory, or interruption:
/// see [`SolveError`]. A solution that did not converge is not an error: it says so in
/// [`ContactState::termination`].
pub fn press(
    system: &System,
    control: Control,
    method: Method,
    run: &Run<'_>,
) -> Result<ContactState, SolveError> {
    let control = control.checked(0.5 * system.pillar().diameter, system.reduced_modulus())?;
    match method {
        Method::Spectral(accuracy) => {
            answers::press(system, control, PillarMethod::Spectral(accuracy), run)
        }
        Method::Punch(form) => answers::press(system, control, PillarMethod::Punch(form), run),
        Method::Love(mesh) => answers::press(system, control, PillarMethod::Love(mesh), run),
        Method::Homogenised => theory::homogenised::press(system, control, run),
    }?
    .checked()
}

/// The critical state, in which the lens just reaches the floor, by the given method: [`press`] with
/// [`Control::FloorContact`], and where the floor is touched.
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
    let contact = press(system, Control::FloorContact, method, run)?;
    CriticalState::new(contact).checked()
}
