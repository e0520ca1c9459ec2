//! What is prescribed to a contact.

use super::quantity::{InvalidQuantity, Quantity, Requirement};

/// What is prescribed, and with it how far the lens comes down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Load {
    /// Indentation `zeta`, m: zero, or at least 1e-20 of a pillar radius.
    Indentation(f64),
    /// Normal force `F`, N: zero, or at least 1e-30 of `E*` times a pillar radius squared.
    Force(f64),
    /// That the lens just reaches the floor: the critical state.
    FloorContact,
}

/// Smallest contact radius that has a meaning, over the size of what is touched: of a pillar a
/// metre wide it is the size of an atom, 1e-10 m, and of all others less.
const SMALLEST_CONTACT: f64 = 1e-10;

/// A load for a solver that has no floor to reach, in any units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Prescribed {
    /// An indentation.
    Indentation(f64),
    /// A normal force.
    Force(f64),
}

impl Load {
    /// The load of an indentation (m) or else of a force (N), if either is given, such as by the arguments of a command.
    #[must_use]
    pub fn given(indentation: Option<f64>, force: Option<f64>) -> Option<Self> {
        indentation
            .map(Self::Indentation)
            .or(force.map(Self::Force))
    }

    /// The same load with another value, such as the value in other units.
    #[must_use]
    pub fn map(self, indentation: impl FnOnce(f64) -> f64, force: impl FnOnce(f64) -> f64) -> Self {
        match self {
            Self::Indentation(value) => Self::Indentation(indentation(value)),
            Self::Force(value) => Self::Force(force(value)),
            Self::FloorContact => self,
        }
    }

    /// The indentation or the force; none of the critical state.
    pub(crate) fn prescribed(self) -> Option<Prescribed> {
        match self {
            Self::Indentation(value) => Some(Prescribed::Indentation(value)),
            Self::Force(value) => Some(Prescribed::Force(value)),
            Self::FloorContact => None,
        }
    }

    /// What is prescribed, if it can be. A load is a finite number, zero or large enough for a contact of
    /// [`SMALLEST_CONTACT`] under a lens as small as what is touched. By Hertz's solution that
    /// takes an indentation of `length SMALLEST_CONTACT^2` and a force of about
    /// `modulus length^2 SMALLEST_CONTACT^3`. `length` is half the width of what is touched (m),
    /// `modulus` is `E*` (Pa).
    pub(crate) fn checked(self, length: f64, modulus: f64) -> Result<Self, InvalidQuantity> {
        // Adding zero takes the sign from a negative one.
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
