//! Disc-shaped contacts in the units of the solver.

use crate::problem::Point;

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
}

impl Contacts {
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
    pub(crate) fn distance(&self, [x, y]: Point) -> f64 {
        (self.centre[0] - x).hypot(self.centre[1] - y)
    }
}
