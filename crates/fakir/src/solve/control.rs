//! The indentation at which the linearized contact meets a target. Loads are in solver units.

use super::floor::FloorPoint;
use super::linearized::LinearizedContact;
use crate::halfspace::coupling::operator::Coupling;
use crate::numerics::convergence::within;
use crate::problem::Load;

/// Target of a solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Target {
    /// A prescribed load.
    Prescribed(Load),
    /// The fraction of the load carried by the floor. The floor is first `reached` at that indentation, in solver units.
    FloorShare { share: f64, reached: f64 },
}

impl From<Load> for Target {
    fn from(control: Load) -> Self {
        Self::Prescribed(control)
    }
}

/// Largest change per step of the logarithm of the indentation past the transition.
const LONGEST_SHARE_STEP: f64 = 1.0;

impl Target {
    /// The prescribed indentation, if any.
    pub(crate) fn indentation(self) -> Option<f64> {
        match self {
            Self::Prescribed(Load::Indentation(indentation)) => Some(indentation),
            Self::Prescribed(Load::Force(_) | Load::FloorContact) | Self::FloorShare { .. } => None,
        }
    }

    /// Target of the first iterations, while the states are inaccurate: a floor share keeps the present indentation, because a step towards
    /// it would be too large.
    pub(crate) fn at_first(self, present: f64) -> Self {
        match self {
            Self::Prescribed(_) => self,
            Self::FloorShare { .. } => Self::Prescribed(Load::Indentation(present)),
        }
    }

    /// Returns the indentation at which the linearized contact meets the target, with the floor point that determines it, if any. `lowest`
    /// is the lowest point of the floor, if that is the target. `None` if no indentation meets the target.
    ///
    /// A floor share is met to first order. The ratio of floor force to top force follows a power law of the indentation past the
    /// transition whose exponent decreases slowly from 3/2, so that the step is taken in logarithms.
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
            // The cells may be too coarse to resolve the first patches.
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

    /// Whether a contact meets the target force or floor share, if any, within a relative tolerance. A force so small that it changes the
    /// indentation by less than its rounding error is not met.
    pub(crate) fn is_met<O: Coupling>(
        self,
        contact: &LinearizedContact<'_, O>,
        tolerance: f64,
    ) -> bool {
        let meets = |value: f64, target: f64| within((value - target).abs(), tolerance * target);
        match self {
            Self::Prescribed(Load::Force(force)) => meets(contact.force(), force),
            Self::FloorShare { share, .. } => meets(share_of(contact), share),
            Self::Prescribed(Load::Indentation(_) | Load::FloorContact) => true,
        }
    }
}

/// Logarithm of the odds `part/(1 - part)`.
pub(crate) fn log_of_odds(part: f64) -> f64 {
    (part / (1.0 - part)).ln()
}

/// Floor force divided by the total force.
pub(crate) fn share_of<O: Coupling>(contact: &LinearizedContact<'_, O>) -> f64 {
    contact.floor_force() / contact.force()
}

/// Derivative, with respect to the indentation, of the logarithm of the ratio of floor force to top force.
pub(crate) fn slope_of_odds<O: Coupling>(contact: &LinearizedContact<'_, O>) -> f64 {
    let [force, stiffness] = [contact.floor_force(), contact.floor_stiffness()];
    stiffness / force - (contact.stiffness() - stiffness) / (contact.force() - force)
}
