//! What a path holds, where it ends, and what it records on the way.

use crate::problem::Point;
use crate::solve::floor::FloorPoint;
use crate::solve::rules::fronts::{Course, Domain};
use crate::solve::rules::stuck_floor::FloorStation;
use crate::state::Termination;

/// A lens axis so near the middle of a top, in its radii, is there: the disc fills the top.
pub(super) const CENTRED: f64 = 1e-6;

/// A disc that detaches within this part of the radius at which it comes to the rim detaches there.
pub(super) const AT_RIM: f64 = 1e-3;

/// What is held while tops change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Held {
    Indentation,
    /// The crosshead of a machine of this stiffness, in units of the solvers.
    Crosshead(f64),
    Force,
}

impl Held {
    /// What is held is `alpha zeta + beta F`.
    pub(super) fn weights(self) -> [f64; 2] {
        match self {
            Self::Indentation => [1.0, 0.0],
            Self::Crosshead(stiffness) => [1.0, stiffness.recip()],
            Self::Force => [0.0, 1.0],
        }
    }
}

/// A state on the path, in units of the solvers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LoadStep {
    pub(crate) course: Course,
    pub(crate) indentation: f64,
    pub(crate) force: f64,
    /// Tops in contact, and those in contact in part.
    pub(crate) touched: [usize; 2],
    /// Area in contact.
    pub(crate) area: f64,
    /// Distance of the farthest point in contact from the lens axis.
    pub(crate) radius: f64,
    /// Events so far.
    pub(crate) events: usize,
    /// What of the floor is in contact, if it sticks.
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
    /// The parts of the top in contact before and after it.
    pub(crate) parts: [f64; 2],
}

/// Where a part of the path ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum End {
    /// At an indentation.
    Indentation(f64),
    /// Where a force is borne by something in contact.
    Force(f64),
    /// Nowhere before the floor.
    Floor,
    /// Where nothing is in contact any more.
    Separation,
}

/// What a part of the path ended at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stop {
    /// What was asked.
    End,
    /// The floor is reached.
    Floor(FloorPoint),
    /// There is no solution.
    Failed(Termination),
}

/// What the path has added up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Energies {
    /// `∫ F d zeta` along the path.
    pub(crate) work: f64,
    /// What of that was done against pulls on unloading.
    pub(crate) separation: f64,
    /// Energy dissipated by what changed.
    pub(crate) dissipation: f64,
    /// What of that was dissipated by fronts that went from one level to the next and stayed there: without levels
    /// they would go there gradually.
    pub(crate) between_levels: f64,
    /// Area that came out of contact.
    pub(crate) receded: f64,
}

/// A top in contact with what it bears.
#[derive(Debug, Clone)]
pub(crate) struct HeldTop {
    pub(crate) index: (i64, i64),
    pub(crate) centre: Point,
    /// By how much it is higher than the common one.
    pub(crate) raised: f64,
    pub(crate) domain: Domain,
    pub(crate) coefficients: Vec<f64>,
    /// The radius of the disc around the lens axis that the coefficients are of, if that is in contact and not a part up to a front.
    pub(crate) disc: Option<f64>,
}

impl HeldTop {
    /// Whether a disc inside the rim is in contact that is nowhere at the rim, or all around.
    pub(crate) fn has_free_disc(&self) -> bool {
        let from_centre = self.centre[0].hypot(self.centre[1]);
        self.disc.is_some_and(|radius| {
            from_centre < CENTRED || radius < (1.0 - AT_RIM) * (1.0 - from_centre)
        })
    }
}

/// The strongest pull so far on unloading.
#[derive(Debug, Clone)]
pub(crate) struct StrongestPull {
    pub(crate) station: usize,
    pub(crate) tops: Vec<HeldTop>,
}

/// A top of which another part is in contact, with both parts and the levels between them.
#[derive(Debug, Clone, Copy)]
pub(super) struct ChangedTop {
    pub(super) index: (i64, i64),
    pub(super) centre: Point,
    pub(super) parts: [f64; 2],
    pub(super) levels: usize,
}

/// What a cascade changed.
#[derive(Debug, Default)]
pub(super) struct Change {
    /// Area that came into contact, and out of it.
    pub(super) gained: f64,
    pub(super) lost: f64,
    pub(super) tops: Vec<ChangedTop>,
}
