//! Force error due to the finite number of front levels in a single contact.
//!
//! A front has one of a few areas. If many tops are in contact, the effect of this rounding on the force is small. A first contact,
//! however, is smaller than the lowest level for a while, and a disc is not among the shapes of fronts: the resulting difference of the
//! force remains as long as some top is partially bonded.

use super::Path;
use crate::solve::rules::fronts::{Fronts, LEVELS};

/// Relative change of the adhesive force of a contact by half a level, times the level number: the force is proportional to the area to the
/// power 3/4.
const HALF_LEVEL: f64 = 0.4;

/// Overlap of the lens with a top, relative to the indentation or the unit of length, up to which contact may be due to rounding.
const ROUNDING: f64 = 1e-9;

impl Path<'_> {
    /// Whether the lens overlaps with a top although nothing is in contact, because the lowest level needs more overlap.
    pub(crate) fn is_below_first_level(&self) -> bool {
        let first = self.scene.first_touch();
        let rounding = ROUNDING * first.abs().max(self.indentation().abs());
        self.counts()[0] == 0 && self.floor.is_none() && self.indentation() > first + rounding
    }

    /// Adds the force error due to the first contact: the force of smaller contacts before it, half the force of punches of the lowest
    /// level, and half a level.
    pub(super) fn open_by_first_contact(&mut self) {
        let all = self.tops.domains.iter().enumerate();
        let attached = all.filter(|(_, domain)| !domain.is_out());
        let attached: Vec<(f64, usize)> = attached
            .map(|(top, domain)| (self.tops.fronts(top).radius(), domain.level))
            .collect();
        let levels = attached.iter().map(|(_, level)| *level);
        let Some(lowest) = levels.min().filter(|level| *level < LEVELS) else {
            return;
        };
        let depth = (self.indentation() - self.scene.first_touch()).max(0.0);
        let radii: f64 = attached.iter().map(|(radius, _)| radius).sum();
        let before = Fronts::part(1).sqrt() * radii * depth;
        let of_level = HALF_LEVEL / lowest as f64 * self.force().abs();
        self.left_open = self.left_open.max(before).max(of_level);
    }

    /// Adds the change of the force, at one indentation, when a disc replaces a front or a full contact, or vice versa. The arguments are
    /// indentation and force before the change.
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
