//! The areas of contacts on which interactions act.
//!
//! On pillars the area of a covered top is that of the top. On a top that the edge of the contact crosses it is that of the [covered
//! region](crate::halfspace::disc::covered), and its error is the length of the edge times the error of its position. The errors of all tops
//! are added, since those of symmetric copies are equal.

use super::asperity_contact::AsperityContact;
use super::contact::{ContactState, PillarState, PillarStatus};
use super::flat::FlatContact;
use super::surface::SurfaceContact;
use crate::problem::{Area, ContactAreas, Method};

/// Area of a narrow opening at the rim of a top that is about to lift off, in squares of its radius: a segment whose depth is the position
/// error of such a rim, two hundredths of the radius.
const LIFTED: f64 = 0.0053;

/// Fraction of the largest stress intensity factor around a rim below which it may have lifted off between two nodes.
const NEAR_LIFT_OFF: f64 = 0.05;

impl ContactState {
    /// Areas in contact on pillar tops and floor.
    ///
    /// The floor is `None` past the transition if its contact is ignored.
    #[must_use]
    pub fn areas(&self) -> ContactAreas {
        let floor = match &self.floor {
            Some(floor) => Some(floor.contact_area()),
            None => (!self.beyond_transition()).then_some(Area::exact(0.0)),
        };
        let tops = self.tops();
        ContactAreas { tops, floor }
    }

    fn tops(&self) -> Area {
        let mut area = match (&self.top_area, &self.fields) {
            (Some(area), _) => *area,
            (None, Some(fields)) => fields.top_area(),
            (None, None) => Area::exact(0.0),
        };
        let of_radius = 2.0 * self.relative_contact_radius_error().min(0.5) * area.value;
        let is_inside = matches!(&self.pillars[..], [only] if only.status == PillarStatus::Partial);
        area.error = area.error.map(|error| match self.method {
            // Pillars are touched completely or not at all: those between the radius and its error may be.
            Method::Punch(_) => of_radius,
            // A contact inside a top, without an edge that crosses it.
            _ if is_inside && error == 0.0 => of_radius,
            _ => error,
        });
        let lifted = self
            .pillars
            .iter()
            .filter(|pillar| may_have_lifted_off(pillar));
        let lifted: f64 = lifted
            .map(|pillar| LIFTED * (0.5 * pillar.diameter).powi(2))
            .sum();
        area.error = area.error.map(|error| error + lifted);
        if !self.converged() {
            area.error = Some(area.value);
        }
        area
    }
}

/// Whether a part of the rim of a fully touched top may have lifted off between two nodes.
fn may_have_lifted_off(pillar: &PillarState) -> bool {
    let near = |[least, most]: [f64; 2]| least < NEAR_LIFT_OFF * most;
    pillar.status == PillarStatus::Full && pillar.stress_intensity_factor.is_some_and(near)
}

impl SurfaceContact {
    /// Areas in contact on tops and floor; the floor is `None` if it is not defined.
    #[must_use]
    pub fn areas(&self) -> ContactAreas {
        // The error of the whole area is also that of a part of it.
        let whole = self.area_error.map(|error| error * self.contact_area);
        let tops = self
            .shares
            .map_or(self.contact_area, |shares| shares.tops.area);
        ContactAreas {
            tops: Area {
                value: tops,
                error: whole.map(|error| if tops > 0.0 { error } else { 0.0 }),
            },
            floor: self.shares.map(|shares| Area {
                value: shares.floor.area,
                error: match self.floor_error {
                    _ if shares.floor.area == 0.0 => whole.map(|_| 0.0),
                    Some(error) => Some(error.area * shares.floor.area),
                    None => whole,
                },
            }),
        }
    }
}

impl AsperityContact {
    /// The areas in contact on rounded tops and the floor.
    ///
    /// The floor is `None` where it may be reached and its contact is not computed.
    #[must_use]
    pub fn areas(&self) -> ContactAreas {
        ContactAreas {
            tops: Area {
                value: self.area,
                error: self.error.map(|error| error.area * self.area),
            },
            floor: match &self.floor {
                Some(floor) => Some(floor.contact_area()),
                None => (self.beyond_transition() == Some(false)).then_some(Area::exact(0.0)),
            },
        }
    }
}

impl FlatContact {
    /// The area in contact, which counts as that of tops; there is no floor.
    #[must_use]
    pub fn areas(&self) -> ContactAreas {
        ContactAreas {
            tops: Area {
                value: self.contact_area,
                error: Some(2.0 * self.error.contact_radius * self.contact_area),
            },
            floor: None,
        }
    }
}
