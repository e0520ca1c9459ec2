//! The indentation that meets what is prescribed with the frozen contact. Here loads are in units of the solvers.

use super::floor::FloorPoint;
use super::frozen::FrozenContact;
use crate::halfspace::coupling::operator::Coupling;
use crate::numerics::convergence::within;
use crate::problem::Control;

impl Control {
    /// The indentation at which the frozen contact meets what is prescribed, with the floor point that decides it, if one does.
    /// `lowest` is the lowest point of the floor, where that is what is to be reached. `None` if no indentation does.
    pub(crate) fn close<O: Coupling>(
        self,
        contact: &FrozenContact<'_, O>,
        lowest: Option<FloorPoint>,
    ) -> Option<(f64, Option<FloorPoint>)> {
        match self {
            Self::Indentation(indentation) => Some((indentation, None)),
            Self::Force(force) => {
                let stiffness = contact.stiffness();
                let missing = force - contact.force();
                (stiffness > 0.0).then(|| (contact.indentation() + missing / stiffness, None))
            }
            Self::FloorContact => lowest.map(|point| (point.indentation, lowest)),
        }
    }

    /// Whether a force is the prescribed one, if one is, within a relative tolerance. So small a one that it changes the
    /// indentation by less than its rounding is not.
    pub(crate) fn is_borne(self, force: f64, tolerance: f64) -> bool {
        match self {
            Self::Force(prescribed) => within((force - prescribed).abs(), tolerance * prescribed),
            Self::Indentation(_) | Self::FloorContact => true,
        }
    }
}
