//! A contact with rounded tops as discs, and with boundary elements.

use super::{Difference, InconclusiveReason, Verdict};
use crate::numerics::convergence::larger;
use crate::problem::{Accuracy, AsperityArray, Load};
use crate::solve::elements::asperities::press_asperities;
use crate::solve::elements::asperity_map::press_on_map;
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
    /// Relative difference of the contact area on the tops with elements from that with discs.
    pub area: Difference,
    /// Relative difference of the fraction of the load carried by the floor; `None` if the floor carries no load with discs.
    pub floor_share: Option<Difference>,
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
        let differences = [self.force, self.indentation, self.area].into_iter();
        let differences: Vec<Difference> = differences.chain(self.floor_share).collect();
        Verdict::of(failed, &differences)
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
/// Past the transition and with adhesion, elements cover tops and floor on one grid, and the fraction of the load carried by the floor is compared
/// as well. `cells` is then their number across a contact of mean radius, weighted with the forces, or with the areas if the tops are adhesive.
///
/// # Errors
/// As [`AsperityArray::press`] and [`SurfaceSystem::press`](crate::problem::SurfaceSystem::press).
pub fn verify_asperities(
    array: &AsperityArray,
    load: Load,
    cells: usize,
    run: &Run<'_>,
) -> Result<AsperityVerification, SolveError> {
    let discs = array.press(load, Accuracy::Accurate, run)?;
    let is_adhesive = !array.adhesion().is_none() && discs.touched() > 0;
    let elements = match discs.floor.is_some() || is_adhesive {
        true => press_on_map(array, load, &discs, cells, run)?,
        false => press_asperities(array, load, &discs, cells, run)?,
    };
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
    let on_floor = (discs.floor.as_ref()).zip(fine.floor);
    Ok(AsperityVerification {
        force: Difference::of(fine.force, discs.force, fine.error.force + error.force),
        indentation: Difference {
            relative: relative(fine.indentation - discs.indentation),
            allowed: fine.error.indentation + relative(error.indentation),
        },
        area: Difference::of(fine.area, discs.area, fine.area_error + error.area),
        floor_share: on_floor.map(|(floor, other)| {
            let allowed = other.error.share + floor.error.share;
            Difference::of(other.share, floor.share, allowed)
        }),
        elements,
        discs,
    })
}
