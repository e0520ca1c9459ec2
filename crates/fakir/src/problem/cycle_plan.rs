//! Loading and unloading of a lens on adhesive pillars.

use super::load::Load;
use super::quantity::{InvalidQuantity, Quantity, Requirement};

/// A cycle of loading and unloading. By default, the lens is loaded to the critical state and unloaded to detachment, at controlled
/// displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CyclePlan {
    /// End of loading.
    pub turn: UnloadingPoint,
    /// The quantity that is controlled while tops snap into contact and out of contact.
    pub drive: LoadingMode,
    /// Whether the lens is unloaded.
    pub retract: bool,
}

/// End of loading. Past the critical state the floor carries load too, unless it is ignored. On an
/// [adhesive floor](crate::problem::Adhesion::floor), fraction 1 of the critical indentation is the state after the lens has jumped into
/// contact with the floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UnloadingPoint {
    /// At this fraction of the critical indentation, above 0 and at most 1.
    Critical(f64),
    /// At an indentation, m.
    Indentation(f64),
    /// When this force (N) is first reached.
    Force(f64),
}

/// The quantity that is controlled. The modes differ only in the behaviour at instabilities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoadingMode {
    /// Constant indentation.
    Displacement,
    /// Constant force.
    Force,
    /// Constant crosshead position of a machine with this stiffness (N/m): indentation plus force divided by stiffness.
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

    /// Stiffness of the machine, N/m; `None` in the other modes.
    #[must_use]
    pub fn stiffness(self) -> Option<f64> {
        match self {
            Self::Machine(stiffness) => Some(stiffness),
            Self::Displacement | Self::Force => None,
        }
    }
}

impl CyclePlan {
    /// Validates the plan; `length` and `modulus` as in [`Load::checked`].
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
