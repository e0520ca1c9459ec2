//! Adhesion of pillar tops and floor to the lens.

use super::quantity::{InvalidQuantity, Quantity, Requirement};
use std::f64::consts::PI;

/// The work of adhesion between the lens and the pillar tops, and optionally the floor between them: the energy per area that is required
/// to separate them. The range of the attraction is assumed to be small compared with all other lengths (the limit of Johnson, Kendall and
/// Roberts).
///
/// ```
/// use fakir::problem::Adhesion;
///
/// let silicone = Adhesion::new(50e-3);
/// assert_eq!(silicone.receding(), 50e-3);
/// let harder_to_part = Adhesion { work_receding: Some(80e-3), ..silicone };
/// assert_eq!(harder_to_part.receding(), 80e-3);
/// assert!(Adhesion::NONE.is_none());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Adhesion {
    /// Work of adhesion where contact is made, J/m^2. Zero means no adhesion.
    pub work: f64,
    /// Work of adhesion where contact is broken, J/m^2, if it is larger.
    pub work_receding: Option<f64>,
    /// Whether the floor is adhesive as well. The lens then jumps into contact with the floor when it first touches it, and detaches from
    /// it at a smaller indentation. Otherwise the floor carries load without pulling.
    pub floor: bool,
}

/// Elongation of the surfaces at the pull-off of a contact with a radius of curvature (m), for the receding work of adhesion over the reduced modulus (m),
/// to which the range of the attraction is compared: `(R w^2/E*^2)^(1/3)`.
pub(crate) fn elongation_of_curved(radius: f64, elastic: f64) -> f64 {
    (radius * elastic * elastic).cbrt()
}

/// The same of a flat top of a radius: `(8 w a/(pi E*))^(1/2)`.
pub(crate) fn elongation_of_flat(radius: f64, elastic: f64) -> f64 {
    (8.0 * radius * elastic / PI).sqrt()
}

impl Adhesion {
    /// Smallest work of adhesion that is not zero, J/m^2: many orders of magnitude below known values.
    pub const SMALLEST_WORK: f64 = 1e-12;

    /// No adhesion.
    pub const NONE: Self = Self {
        work: 0.0,
        work_receding: None,
        floor: false,
    };

    /// The same work of adhesion (J/m^2) where contact is made and where it is broken.
    #[must_use]
    pub const fn new(work: f64) -> Self {
        Self {
            work,
            work_receding: None,
            floor: false,
        }
    }

    /// The same, with an adhesive floor.
    #[must_use]
    pub const fn with_floor(self) -> Self {
        Self {
            floor: true,
            ..self
        }
    }

    /// Work of adhesion where contact is broken, J/m^2.
    #[must_use]
    pub fn receding(self) -> f64 {
        self.work_receding.unwrap_or(self.work)
    }

    /// The same with all works of adhesion multiplied by a factor.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self {
            work: factor * self.work,
            work_receding: self.work_receding.map(|work| factor * work),
            ..self
        }
    }

    /// Whether there is no adhesion.
    #[must_use]
    pub fn is_none(self) -> bool {
        self.receding() <= 0.0
    }

    /// Validates the works of adhesion.
    pub(super) fn checked(self) -> Result<Self, InvalidQuantity> {
        let smallest = Requirement::ZeroOrWork(Self::SMALLEST_WORK);
        smallest.check(Quantity::WorkOfAdhesion, self.work)?;
        if let Some(receding) = self.work_receding {
            smallest.check(Quantity::RecedingWorkOfAdhesion, receding)?;
            Requirement::AtLeastWork(self.work)
                .check(Quantity::RecedingWorkOfAdhesion, receding)?;
        }
        // Adding zero removes the sign of a negative zero.
        Ok(Self {
            work: self.work + 0.0,
            work_receding: self.work_receding.map(|work| work + 0.0),
            floor: self.floor,
        })
    }
}
