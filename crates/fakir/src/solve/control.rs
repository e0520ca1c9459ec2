//! What fixes the indentation, and the indentation that meets it with the frozen contact.

use super::floor::FloorPoint;
use super::frozen::FrozenContact;
use crate::halfspace::coupling::operator::Coupling;
use crate::numerics::convergence::within;

/// What fixes the indentation, in units of the solvers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Target {
    /// The indentation itself.
    Indentation(f64),
    /// The force.
    Force(f64),
    /// First contact with the floor.
    Floor,
}

impl Target {
    /// The indentation at which the frozen contact meets the target, with the floor point that decides it, if one does.
    /// `lowest` is the lowest point of the floor, where that is the target. `None` if no indentation does.
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
            Self::Floor => lowest.map(|point| (point.indentation, lowest)),
        }
    }

    /// Whether a force is the prescribed one, if one is, within a relative tolerance. So small a one that it changes the
    /// indentation by less than its rounding is not.
    pub(crate) fn is_borne(self, force: f64, tolerance: f64) -> bool {
        match self {
            Self::Force(prescribed) => within((force - prescribed).abs(), tolerance * prescribed),
            Self::Indentation(_) | Self::Floor => true,
        }
    }
}
