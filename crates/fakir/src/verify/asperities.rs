//! A contact with rounded tops as discs, and with boundary elements.

use super::{Difference, InconclusiveReason, Verdict};
use crate::numerics::convergence::larger;
use crate::problem::{Accuracy, AsperityArray, Feature, Load, Question, Solver};
use crate::solve::elements::asperities::press_asperities;
use crate::state::{
    AsperityContact, AsperityElements, AsperityErrors, Run, SolveError, Termination,
};

/// The contact with rounded tops by both methods, and their differences.
#[derive(Debug, Clone)]
pub struct AsperityVerification {
    /// The contact as discs, with the accurate setting.
    pub discs: AsperityContact,
    /// The contacts with boundary elements, with half as many cells across every contact and with all.
    pub elements: [AsperityElements; 2],
    /// Relative difference of the force with elements from that with discs.
    pub force: Difference,
    /// Difference of the indentation with elements from that with discs, relative to the indentation, or to the depth below first touch if
    /// that is larger.
    pub indentation: Difference,
    /// Relative difference of the contact area with elements from that with discs.
    pub area: Difference,
}

impl AsperityVerification {
    /// The verdict of the comparison.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let discs = (None, self.discs.termination);
        let elements = self.elements.iter();
        let elements = elements.map(|contact| (Some(contact.cells), contact.termination));
        let failed = std::iter::once(discs)
            .chain(elements)
            .find(|(_, termination)| *termination != Termination::Converged)
            .map(
                |(cells, termination)| InconclusiveReason::AsperitiesNotConverged {
                    cells,
                    termination,
                },
            );
        Verdict::of(failed, &[self.force, self.indentation, self.area])
    }

    /// Whether both methods converged and agree within their error estimates.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.verdict() == Verdict::Agree
    }
}

/// Solves a contact with rounded tops as discs, and with boundary elements on `cells` square cells across every contact and on half as many.
///
/// With elements, contacts may have any shape, and tops that are not touched according to the other method are checked. Both methods share
/// the undeformed gap and the elastic response of the half-space: the displacement due to modes of a disc, and due to a square.
///
/// # Errors
/// As [`AsperityArray::press`]; [`SolveError::Unsupported`] with adhesion, and past the transition.
pub fn verify_asperities(
    array: &AsperityArray,
    load: Load,
    cells: usize,
    run: &Run<'_>,
) -> Result<AsperityVerification, SolveError> {
    let features: &[Feature] = match array.adhesion().is_none() {
        true => &[],
        false => &[Feature::AdhesiveTops],
    };
    Question::Verify.check(Solver::Asperities, features)?;
    let discs = array.press(load, Accuracy::Accurate, run)?;
    if discs.floor.is_some() {
        Question::VerifyFloor.check(Solver::Asperities, &Feature::of_asperities(array))?;
    }
    let elements = press_asperities(array, load, &discs, cells, run)?;
    let fine = &elements[1];
    let unknown = AsperityErrors {
        force: f64::NAN,
        area: f64::NAN,
        indentation: f64::NAN,
    };
    let error = discs.error.unwrap_or(unknown);
    let touch = array.first_touch();
    let depth = larger(discs.indentation.abs(), discs.indentation - touch);
    let relative = |length: f64| if length == 0.0 { 0.0 } else { length / depth };
    Ok(AsperityVerification {
        force: Difference::of(fine.force, discs.force, fine.error.force + error.force),
        indentation: Difference {
            relative: relative(fine.indentation - discs.indentation),
            allowed: fine.error.indentation + relative(error.indentation),
        },
        area: Difference::of(fine.area, discs.area, fine.area_error + error.area),
        elements,
        discs,
    })
}
