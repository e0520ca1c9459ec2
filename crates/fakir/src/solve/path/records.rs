//! Quantities that a path keeps fixed, its ends, and its records.

use crate::problem::Point;
use crate::solve::floor::FloorPoint;
use crate::solve::rules::bonded_floor::FloorStation;
use crate::solve::rules::fronts::{Course, Domain};
use crate::state::Termination;

/// Distance of the lens axis from the centre of a top, in top radii, below which the contact is centred: the disc fills the top.
pub(super) const CENTRED: f64 = 1e-6;

/// Relative distance from the rim within which a detaching disc counts as detaching at the rim.
pub(super) const AT_RIM: f64 = 1e-3;

/// Quantity that is fixed while tops change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum FixedQuantity {
    Indentation,
    /// The crosshead position of a testing machine of this stiffness, in solver units.
    Crosshead(f64),
    Force,
}

impl FixedQuantity {
    /// Weights of the fixed quantity `alpha zeta + beta F`.
    pub(super) fn weights(self) -> [f64; 2] {
        match self {
            Self::Indentation => [1.0, 0.0],
            Self::Crosshead(stiffness) => [1.0, stiffness.recip()],
            Self::Force => [0.0, 1.0],
        }
    }
}

/// A state on the path, in solver units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LoadStep {
    pub(crate) course: Course,
    pub(crate) indentation: f64,
    pub(crate) force: f64,
    /// Number of tops in contact, and of partially bonded ones.
    pub(crate) touched: [usize; 2],
    /// Contact area.
    pub(crate) area: f64,
    /// Distance of the farthest point in contact from the lens axis.
    pub(crate) radius: f64,
    /// Number of events so far.
    pub(crate) events: usize,
    /// The part of the floor in contact, if it is adhesive.
    pub(crate) floor: Option<FloorStation>,
}

/// A top that changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TopEvent {
    pub(crate) course: Course,
    pub(crate) indentation: f64,
    pub(crate) force: f64,
    pub(crate) index: (i64, i64),
    pub(crate) centre: Point,
    /// Fractions of the top in contact before and after the event.
    pub(crate) parts: [f64; 2],
}

/// End of a segment of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum End {
    /// A prescribed indentation.
    Indentation(f64),
    /// A prescribed force with something in contact.
    Force(f64),
    /// No end before the floor.
    Floor,
    /// Nothing is in contact.
    Separation,
}

/// Reason for the end of a segment of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stop {
    /// The requested end.
    End,
    /// The floor was reached.
    Floor(FloorPoint),
    /// There is no solution.
    Failed(Termination),
}

/// Energies accumulated along the path.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Energies {
    /// `∫ F d zeta` along the path.
    pub(crate) work: f64,
    /// Separation work: the tensile part of `∫ F d zeta` during unloading.
    pub(crate) separation: f64,
    /// Energy dissipated by changes of contact.
    pub(crate) dissipation: f64,
    /// Part of the dissipation due to fronts that move by a single level and stop: without levels they would move gradually.
    pub(crate) between_levels: f64,
    /// Detached area.
    pub(crate) receded: f64,
}

/// A top in contact, with its load.
#[derive(Debug, Clone)]
pub(crate) struct AttachedTop {
    pub(crate) index: (i64, i64),
    pub(crate) centre: Point,
    /// Radius of the top, and its height above the common level.
    pub(crate) radius: f64,
    pub(crate) raised: f64,
    pub(crate) domain: Domain,
    /// Coefficients of `q`.
    pub(crate) coefficients: Vec<f64>,
    /// Radius of the disc around the lens axis that the coefficients refer to, if a disc and not a region up to a front is in contact.
    pub(crate) disc: Option<f64>,
}

impl AttachedTop {
    /// Whether a disc inside the rim is in contact that touches the rim nowhere, or all around.
    pub(crate) fn has_free_disc(&self) -> bool {
        let from_centre = self.centre[0].hypot(self.centre[1]);
        self.disc.is_some_and(|radius| {
            from_centre < CENTRED || radius < (1.0 - AT_RIM) * (self.radius - from_centre)
        })
    }
}

/// The largest tensile force so far on unloading.
#[derive(Debug, Clone)]
pub(crate) struct StrongestPull {
    pub(crate) station: usize,
    pub(crate) tops: Vec<AttachedTop>,
}

/// A top whose bonded region changed, with the fractions before and after and the number of levels between them.
#[derive(Debug, Clone, Copy)]
pub(super) struct ChangedTop {
    pub(super) index: (i64, i64),
    pub(super) centre: Point,
    pub(super) parts: [f64; 2],
    pub(super) levels: usize,
}

/// Changes made by a cascade.
#[derive(Debug, Default)]
pub(super) struct Change {
    /// Area that attached, and area that detached.
    pub(super) gained: f64,
    pub(super) lost: f64,
    pub(super) tops: Vec<ChangedTop>,
}
