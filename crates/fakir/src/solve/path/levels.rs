//! What the levels of fronts leave open of the force where one contact is all that there is.
//!
//! A front has one of a few areas. Where many tops are in contact what that rounds is little of the force. A first contact is smaller than the
//! lowest level for a while, and a disc is no shape that a front can take: what the force differs by then is there in the same size as long as
//! some top is in contact in part.

use super::Path;
use crate::solve::rules::fronts::LEVELS;

/// What half a level changes of the adhesive force of a contact, which goes with the power 3/4 of the area, times the level.
const HALF_LEVEL: f64 = 0.4;

/// A lens that touched a top by this much of its indentation, or of the unit of length, may touch it by rounding alone.
const ROUNDING: f64 = 1e-9;

impl Path<'_> {
    /// Whether the lens is down on a top and nothing is in contact: even the lowest level takes more.
    pub(crate) fn is_below_first_level(&self) -> bool {
        let first = self.scene.first_touch();
        let rounding = ROUNDING * first.abs().max(self.indentation().abs());
        self.counts()[0] == 0 && self.floor.is_none() && self.indentation() > first + rounding
    }

    /// Adds what the first contact leaves open: what smaller ones would bear before it, half of what punches of the lowest level do, and half a level.
    pub(super) fn open_by_first_contact(&mut self) {
        let fronts = &self.tops.fronts;
        let held = self.tops.domains.iter().filter(|domain| !domain.is_out());
        let levels: Vec<usize> = held.map(|domain| domain.level).collect();
        let Some(lowest) = levels.iter().copied().min().filter(|level| *level < LEVELS) else {
            return;
        };
        let depth = (self.indentation() - self.scene.first_touch()).max(0.0);
        let radius = fronts.part(1).sqrt();
        let before = levels.len() as f64 * radius * depth;
        let of_level = HALF_LEVEL / lowest as f64 * self.force().abs();
        self.left_open = self.left_open.max(before).max(of_level);
    }

    /// Adds what the force differs by at one indentation as a disc takes the place of a front or of a whole top, or these of a disc. Before that it had an
    /// indentation and a force.
    pub(super) fn open_by_change(&mut self, [indentation, force]: [f64; 2]) {
        let stiffness = match &self.inside {
            Some(inside) => 2.0 * inside.radius(),
            None if self.counts()[0] == 0 => 0.0,
            None => self.stiffness(),
        };
        let way = self.indentation() - indentation;
        let difference = self.force() - force - stiffness * way;
        self.left_open = self.left_open.max(difference.abs());
    }
}
