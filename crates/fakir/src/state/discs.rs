//! Contacts as discs, in the units of the solver.

use crate::problem::Point;

/// What limits a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Hold {
    /// Nothing: its edge is free all around.
    Free,
    /// The rim of the pillar, at this angle, with half the edge moment there.
    Leaning { angle: f64, edge: f64 },
    /// The rim of the pillar, all around.
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

/// A contact of discs, which may be the solution or not yet.
#[derive(Debug, Clone)]
pub(crate) struct Contacts {
    pub(crate) indentation: f64,
    /// Those that are touched, by rising asperity.
    pub(crate) discs: Vec<Disc>,
    /// Of every disc so many.
    pub(crate) moments: Vec<f64>,
    /// Of every asperity, the point where it is next to be touched.
    pub(crate) nearest: Vec<Point>,
    /// Of every asperity that is not touched, the gap there.
    pub(crate) gaps: Vec<f64>,
}

impl Contacts {
    pub(crate) fn largest_radius(&self) -> f64 {
        self.discs
            .iter()
            .map(|disc| disc.radius)
            .fold(0.0, f64::max)
    }

    /// The two discs that fill most of the distance between their centres, and which part of it.
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
