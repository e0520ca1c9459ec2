//! The prescribed load of a contact.

use super::quantity::{InvalidQuantity, Quantity, Requirement};

/// The prescribed quantity, which determines the position of the lens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Load {
    /// Indentation `zeta`, m: zero, or at least 1e-20 of a pillar radius.
    Indentation(f64),
    /// Normal force `F`, N: zero, or at least 1e-30 of `E*` times a pillar radius squared.
    Force(f64),
    /// Contact of the lens with the floor: the critical state.
    FloorContact,
}

/// Smallest contact radius that is meaningful, relative to the size of the pattern: for a pillar one metre wide it is the size of an atom,
/// 1e-10 m; for smaller pillars it is less.
const SMALLEST_CONTACT: f64 = 1e-10;

/// A load without floor contact, in arbitrary units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Prescribed {
    /// An indentation.
    Indentation(f64),
    /// A normal force.
    Force(f64),
}

impl Load {
    /// The load from an indentation (m) or otherwise a force (N), if one is given, for example by the arguments of a command.
    #[must_use]
    pub fn given(indentation: Option<f64>, force: Option<f64>) -> Option<Self> {
        indentation
            .map(Self::Indentation)
            .or(force.map(Self::Force))
    }

    /// Maps the value of the load, for example to other units.
    #[must_use]
    pub fn map(self, indentation: impl FnOnce(f64) -> f64, force: impl FnOnce(f64) -> f64) -> Self {
        match self {
            Self::Indentation(value) => Self::Indentation(indentation(value)),
            Self::Force(value) => Self::Force(force(value)),
            Self::FloorContact => self,
        }
    }

    /// The indentation or the force; `None` for the critical state.
    pub(crate) fn prescribed(self) -> Option<Prescribed> {
        match self {
            Self::Indentation(value) => Some(Prescribed::Indentation(value)),
            Self::Force(value) => Some(Prescribed::Force(value)),
            Self::FloorContact => None,
        }
    }

    /// Validates the load. It must be a finite number, either zero or large enough for a contact of [`SMALLEST_CONTACT`] under a lens of
    /// the same size as the pattern. According to Hertz's solution, this requires an indentation of `length SMALLEST_CONTACT^2` and a force
    /// of about `modulus length^2 SMALLEST_CONTACT^3`. `length` is half the width of a pillar or pattern (m), `modulus` is `E*` (Pa).
    pub(crate) fn checked(self, length: f64, modulus: f64) -> Result<Self, InvalidQuantity> {
        // Adding zero removes the sign of a negative zero.
        match self {
            Self::Indentation(value) => {
                let smallest = length * SMALLEST_CONTACT.powi(2);
                Requirement::ZeroOrIndentation(smallest).check(Quantity::Indentation, value)?;
                Ok(Self::Indentation(value + 0.0))
            }
            Self::Force(value) => {
                let smallest = modulus * length * length * SMALLEST_CONTACT.powi(3);
                Requirement::ZeroOrForce(smallest).check(Quantity::Force, value)?;
                Ok(Self::Force(value + 0.0))
            }
            Self::FloorContact => Ok(self),
        }
    }
}
