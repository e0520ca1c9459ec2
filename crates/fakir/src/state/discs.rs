//! Disc-shaped contacts in the units of the solver.

use crate::problem::Point;
use std::sync::Arc;

/// The boundary of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Hold {
    /// Free edge all around.
    Free,
    /// The contact touches the rim of the pillar at this angle, with half the edge moment there.
    Leaning { angle: f64, edge: f64 },
    /// The rim of the pillar all around.
    Whole,
}

/// A contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Disc {
    pub(crate) asperity: usize,
    pub(crate) centre: Point,
    pub(crate) radius: f64,
    pub(crate) hold: Hold,
    /// Adhesion at a free edge, `sqrt(2 w/(pi E*))`: the edge has the moment `-grip r^(3/2)`. Zero without adhesion.
    pub(crate) grip: f64,
}

/// A set of disc-shaped contacts, which is not necessarily the solution.
#[derive(Debug, Clone)]
pub(crate) struct Contacts {
    pub(crate) indentation: f64,
    /// The asperities in contact, by increasing index.
    pub(crate) discs: Vec<Disc>,
    /// Moments of all discs, with the same number for each.
    pub(crate) moments: Vec<f64>,
    /// For every asperity, the point of the smallest gap.
    pub(crate) nearest: Vec<Point>,
    /// For every asperity without contact, the gap at this point.
    pub(crate) gaps: Vec<f64>,
    /// The cells of an adhesive floor that are in contact, in increasing order.
    pub(crate) bonded: Arc<[usize]>,
}

impl Contacts {
    /// Distance from the lens axis to the farthest point in contact.
    pub(crate) fn reach(&self) -> f64 {
        let reaches = self.discs.iter();
        let reaches = reaches.map(|disc| disc.centre[0].hypot(disc.centre[1]) + disc.radius);
        reaches.fold(0.0, f64::max)
    }

    /// Contacts between these and others on the same asperities, as the start of an iteration.
    pub(crate) fn between(&self, other: &Self, part: f64) -> Self {
        let mix = |a: f64, b: f64| a + part * (b - a);
        let discs = self.discs.iter().zip(&other.discs);
        let discs = discs.map(|(one, two)| Disc {
            centre: [0, 1].map(|k| mix(one.centre[k], two.centre[k])),
            radius: mix(one.radius, two.radius),
            ..*one
        });
        let moments = self.moments.iter().zip(&other.moments);
        Self {
            indentation: mix(self.indentation, other.indentation),
            discs: discs.collect(),
            moments: moments.map(|(one, two)| mix(*one, *two)).collect(),
            ..self.clone()
        }
    }

    /// Centre, radius and moments of every disc.
    pub(crate) fn loaded(&self) -> impl Iterator<Item = ((Point, f64), &[f64])> {
        let modes = self.moments.len() / self.discs.len().max(1);
        let moments = self.moments.chunks_exact(modes.max(1));
        let discs = self.discs.iter().zip(moments);
        discs.map(|(disc, moments)| ((disc.centre, disc.radius), moments))
    }

    pub(crate) fn largest_radius(&self) -> f64 {
        self.discs
            .iter()
            .map(|disc| disc.radius)
            .fold(0.0, f64::max)
    }

    /// The pair of discs with the largest ratio of the sum of radii to the distance of centres, and this ratio.
    pub(crate) fn closest(&self) -> Option<([usize; 2], f64)> {
        let mut closest: Option<([usize; 2], f64)> = None;
        for (number, one) in self.discs.iter().enumerate() {
            for (other, two) in self.discs.iter().enumerate().skip(number + 1) {
                let part = (one.radius + two.radius) / one.distance(two.centre);
                if closest.is_none_or(|(_, most)| part > most) {
                    closest = Some(([number, other], part));
                }
            }
        }
        closest
    }
}

impl Disc {
    /// Edge moment of the tension that adhesion holds, and its derivative with respect to the radius.
    pub(crate) fn pull(&self) -> [f64; 2] {
        let root = self.radius.sqrt();
        [self.grip * self.radius * root, 1.5 * self.grip * root]
    }

    pub(crate) fn distance(&self, [x, y]: Point) -> f64 {
        (self.centre[0] - x).hypot(self.centre[1] - y)
    }
}
