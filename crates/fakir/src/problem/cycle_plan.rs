//! How a lens is brought down onto pillars that stick, and off again.

use super::load::Load;
use super::quantity::{InvalidQuantity, Quantity, Requirement};

/// A cycle of loading and unloading. The default goes to the critical state and back until nothing is in contact, by displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CyclePlan {
    /// Where loading ends.
    pub turn: UnloadingPoint,
    /// What is held while tops snap into contact and out of it.
    pub drive: LoadingMode,
    /// Whether the lens is pulled off again.
    pub retract: bool,
}

/// Where loading ends. With a floor that is neither ignored nor [sticks](crate::problem::Adhesion::floor) it ends at the critical state at the latest:
/// what follows with tops that stick alone is not solved. On a floor that sticks the critical indentation itself, the part 1, is where the lens has jumped onto it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UnloadingPoint {
    /// At this part of the critical indentation, above 0 and at most 1.
    Critical(f64),
    /// At an indentation, m.
    Indentation(f64),
    /// Where a force (N) is first borne.
    Force(f64),
}

/// What drives the lens. Between events all are the same; they differ in what happens at one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoadingMode {
    /// The indentation is held.
    Displacement,
    /// The force is held.
    Force,
    /// The crosshead of a machine of this stiffness (N/m) is held: the indentation plus force over stiffness.
    Machine(f64),
}

impl Default for CyclePlan {
    fn default() -> Self {
        Self {
            turn: UnloadingPoint::Critical(1.0),
            drive: LoadingMode::Displacement,
            retract: true,
        }
    }
}

impl From<Load> for UnloadingPoint {
    fn from(load: Load) -> Self {
        match load {
            Load::Indentation(indentation) => Self::Indentation(indentation),
            Load::Force(force) => Self::Force(force),
            Load::FloorContact => Self::Critical(1.0),
        }
    }
}

impl LoadingMode {
    /// The name used in case files and results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Force => "force",
            Self::Machine(_) => "machine",
        }
    }

    /// Stiffness of the machine, N/m; none unless one drives the lens.
    #[must_use]
    pub fn stiffness(self) -> Option<f64> {
        match self {
            Self::Machine(stiffness) => Some(stiffness),
            Self::Displacement | Self::Force => None,
        }
    }
}

impl CyclePlan {
    /// What is planned, if it can be; `length` and `modulus` as for [`Load::checked`].
    pub(crate) fn checked(self, length: f64, modulus: f64) -> Result<Self, InvalidQuantity> {
        let turn = match self.turn {
            UnloadingPoint::Critical(part) => UnloadingPoint::Critical(
                Requirement::PartOfWhole.check(Quantity::CriticalPart, part)?,
            ),
            UnloadingPoint::Indentation(indentation) => Load::Indentation(indentation)
                .checked(length, modulus)?
                .into(),
            UnloadingPoint::Force(force) => Load::Force(force).checked(length, modulus)?.into(),
        };
        if let Some(stiffness) = self.drive.stiffness() {
            Requirement::Positive.check(Quantity::MachineStiffness, stiffness)?;
        }
        Ok(Self { turn, ..self })
    }
}
