//! The critical state, in which the lens first touches the floor.

use super::asperity_contact::AsperityContact;
use super::contact::{ContactState, relative};
use crate::problem::{Method, Point, PunchForm, System};

/// The part of the surface that the lens touches first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regime {
    /// Pillar tops: there is contact on tops before the transition.
    TopFirst,
    /// The floor: it is touched before any pillar, at zero force.
    BottomFirst,
}

impl Regime {
    /// `"top_first"` or `"bottom_first"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::TopFirst => "top_first",
            Self::BottomFirst => "bottom_first",
        }
    }
}

/// The state in which the indenter first touches the floor, with a contact of either kind.
#[derive(Debug, Clone)]
pub struct Critical<C> {
    /// Whether other parts of the surface were in contact before.
    pub regime: Regime,
    /// The contact at the transition: critical force `F_c`, critical indentation `zeta_c`,
    /// top contact radius, pillars or cells.
    pub contact: C,
    /// Position of the floor contact, m from the lens axis. On a lattice, the representative of its symmetric copies according to
    /// [`LatticeSymmetry::fold`](crate::problem::lattice::LatticeSymmetry::fold); on a surface, the position may be between the centres of
    /// cells.
    pub floor_contact: Point,
}

/// The critical state of a lens on a lattice of pillars.
pub type CriticalState = Critical<ContactState>;

impl CriticalState {
    /// The critical state with this contact, solved for [`Load::FloorContact`](crate::problem::Load).
    #[must_use]
    pub fn new(contact: ContactState) -> Self {
        let system = &contact.system;
        let on_axis = |[x, y]: Point| x.hypot(y) < 1e-9 * system.pillar().diameter;
        // With a single pillar under the axis, the floor is touched along a circle.
        let round = contact.pillars.len() == 1 && on_axis(contact.pillars[0].centre);
        let [x, y] = contact.smallest_gap_position;
        Self {
            regime: if system.touches_floor_first() {
                Regime::BottomFirst
            } else {
                Regime::TopFirst
            },
            floor_contact: if round {
                [x.hypot(y), 0.0]
            } else {
                system
                    .hexagonal_lattice()
                    .map_or([x, y], |lattice| lattice.symmetry().fold([x, y]))
            },
            contact,
        }
    }

    /// Critical contact radius `a_c`: the larger of the top contact radius and the distance
    /// `r_c` of the floor contact from the lens axis, m.
    #[must_use]
    pub fn contact_radius(&self) -> f64 {
        self.contact
            .contact_radius
            .max(self.floor_contact_distance())
    }

    /// Estimated error of [`contact_radius`](Self::contact_radius) relative to it.
    #[must_use]
    pub fn relative_contact_radius_error(&self) -> f64 {
        let (top, floor) = (self.contact.contact_radius, self.floor_contact_distance());
        let error = if self.contact.converged() {
            let of_top = top + self.contact.contact_radius_error - self.contact_radius();
            let of_floor = floor + self.floor_contact_error() - self.contact_radius();
            let certain = if top > floor {
                self.contact.contact_radius_error
            } else {
                self.floor_contact_error()
            };
            certain.max(of_top).max(of_floor)
        } else {
            self.contact_radius()
        };
        relative(error, self.contact_radius())
    }

    /// Estimated error of the position of the floor contact, m: its variation between methods and accuracy settings, relative to the pitch.
    #[must_use]
    pub fn floor_contact_error(&self) -> f64 {
        let part = match self.contact.method {
            Method::Spectral(_) => 1e-3,
            Method::Love(_) => 1e-2,
            Method::Punch(PunchForm::Corrected) => 2e-2,
            Method::Punch(PunchForm::Plain) => 5e-2,
            Method::Homogenised => 1.0,
        };
        match self.regime {
            Regime::TopFirst => part * self.contact.system.pitch(),
            Regime::BottomFirst => 0.0,
        }
    }

    /// `r_c`, the distance of the floor contact from the lens axis, m.
    #[must_use]
    pub fn floor_contact_distance(&self) -> f64 {
        self.floor_contact[0].hypot(self.floor_contact[1])
    }

    /// Force, contact radius and indentation in the paper's reduced variables.
    #[must_use]
    pub fn normalized(&self) -> Normalized {
        Normalized::new(
            &self.contact.system,
            self.contact.force,
            self.contact_radius(),
            self.contact.indentation,
        )
    }
}

impl Critical<AsperityContact> {
    /// Critical contact radius `a_c`: the larger of the contact radius on the tops and the distance of the floor contact from the lens
    /// axis, m.
    #[must_use]
    pub fn contact_radius(&self) -> f64 {
        let [x, y] = self.floor_contact;
        self.contact.contact_radius.unwrap_or(0.0).max(x.hypot(y))
    }
}

/// The paper's reduced variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normalized {
    /// `F gamma_int/(h d)`.
    pub force: f64,
    /// `a/e`.
    pub contact_radius: f64,
    /// `zeta/h`.
    pub indentation: f64,
}

impl Normalized {
    /// Reduces a force (N), a contact radius (m) and an indentation (m).
    #[must_use]
    pub fn new(system: &System, force: f64, contact_radius: f64, indentation: f64) -> Self {
        let pillar = system.pillar();
        Self {
            force: force * system.internal_compliance() / (pillar.height * pillar.diameter),
            contact_radius: contact_radius / system.pitch(),
            indentation: indentation / pillar.height,
        }
    }
}
