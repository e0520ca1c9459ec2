//! The indentation that meets what is wanted with the linearized contact. Here loads are in units of the solvers.

use super::floor::FloorPoint;
use super::linearized::LinearizedContact;
use crate::halfspace::coupling::operator::Coupling;
use crate::numerics::convergence::within;
use crate::problem::Load;

/// What a solution is to meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Target {
    /// What is prescribed.
    Prescribed(Load),
    /// That the floor bears this part of the force. It is first `reached` at that indentation, in units of the solvers.
    FloorShare { share: f64, reached: f64 },
}

impl From<Load> for Target {
    fn from(control: Load) -> Self {
        Self::Prescribed(control)
    }
}

/// Largest change in a step of the logarithm of how far the lens is past the transition.
const LONGEST_SHARE_STEP: f64 = 1.0;

impl Target {
    /// The indentation, if it is prescribed.
    pub(crate) fn indentation(self) -> Option<f64> {
        match self {
            Self::Prescribed(Load::Indentation(indentation)) => Some(indentation),
            Self::Prescribed(Load::Force(_) | Load::FloorContact) | Self::FloorShare { .. } => None,
        }
    }

    /// While the states are hardly known: a floor share would lead far away, and the present indentation is kept.
    pub(crate) fn at_first(self, present: f64) -> Self {
        match self {
            Self::Prescribed(_) => self,
            Self::FloorShare { .. } => Self::Prescribed(Load::Indentation(present)),
        }
    }

    /// The indentation at which the linearized contact meets it, with the floor point that decides it, if one does.
    /// `lowest` is the lowest point of the floor, where that is what is to be reached. `None` if no indentation does.
    ///
    /// A floor share is met to first order. What the floor bears over what the tops bear goes as a power of how far the lens is past the
    /// transition that falls slowly, from 3/2, so that a step is one of logarithms.
    pub(crate) fn close<O: Coupling>(
        self,
        contact: &LinearizedContact<'_, O>,
        lowest: Option<FloorPoint>,
    ) -> Option<(f64, Option<FloorPoint>)> {
        match self {
            Self::Prescribed(Load::Indentation(indentation)) => Some((indentation, None)),
            Self::Prescribed(Load::Force(force)) => {
                let stiffness = contact.stiffness();
                let missing = force - contact.force();
                (stiffness > 0.0).then(|| (contact.indentation() + missing / stiffness, None))
            }
            Self::Prescribed(Load::FloorContact) => lowest.map(|point| (point.indentation, lowest)),
            // Cells may be too coarse for the first patches.
            Self::FloorShare { .. } if contact.floor_force() <= 0.0 => {
                Some((contact.indentation(), None))
            }
            Self::FloorShare { share, reached } => {
                let past = contact.indentation() - reached;
                let power = past * slope_of_odds(contact);
                let missing = log_of_odds(share) - log_of_odds(share_of(contact));
                let step = missing / power;
                (past > 0.0 && power > 0.0 && step.is_finite()).then(|| {
                    let step = step.clamp(-LONGEST_SHARE_STEP, LONGEST_SHARE_STEP);
                    (reached + past * step.exp(), None)
                })
            }
        }
    }

    /// Whether a contact meets it within a relative tolerance: the force or the floor share, where one is wanted. So small a force that it changes the
    /// indentation by less than its rounding it does not.
    pub(crate) fn is_met<O: Coupling>(
        self,
        contact: &LinearizedContact<'_, O>,
        tolerance: f64,
    ) -> bool {
        let meets = |value: f64, wanted: f64| within((value - wanted).abs(), tolerance * wanted);
        match self {
            Self::Prescribed(Load::Force(force)) => meets(contact.force(), force),
            Self::FloorShare { share, .. } => meets(share_of(contact), share),
            Self::Prescribed(Load::Indentation(_) | Load::FloorContact) => true,
        }
    }
}

/// Of a part and what is left of one.
pub(crate) fn log_of_odds(part: f64) -> f64 {
    (part / (1.0 - part)).ln()
}

/// What the floor bears, over the force.
pub(crate) fn share_of<O: Coupling>(contact: &LinearizedContact<'_, O>) -> f64 {
    contact.floor_force() / contact.force()
}

/// The change with the indentation of the logarithm of what the floor bears over what the tops bear.
pub(crate) fn slope_of_odds<O: Coupling>(contact: &LinearizedContact<'_, O>) -> f64 {
    let [force, stiffness] = [contact.floor_force(), contact.floor_stiffness()];
    stiffness / force - (contact.stiffness() - stiffness) / (contact.force() - force)
}
