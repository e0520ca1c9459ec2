//! Common properties of all results, and of all contacts by pillars or by cells.

use super::asperity_contact::AsperityContact;
use super::asperity_cycle::AsperityCycle;
use super::contact::{ContactState, Termination, Warning};
use super::cycle::Cycle;
use super::flat::{FlatContact, FlatCycle};
use super::resolution::Unresolved;
use super::surface::SurfaceContact;

/// A solution of any kind: contacts and cycles. Decides whether it is a valid result.
pub trait Solution {
    /// Why the solver stopped.
    fn termination(&self) -> Termination;

    /// The first number of a solution that is not resolved, if there is one.
    fn unresolved(&self) -> Option<Unresolved>;

    /// Whether the solver converged.
    fn converged(&self) -> bool {
        self.termination() == Termination::Converged
    }

    /// Whether the numbers are a valid result: converged and resolved.
    fn is_answer(&self) -> bool {
        self.converged() && self.unresolved().is_none()
    }

    /// The reason why the numbers are not a valid result; `None` if they are.
    fn problem(&self) -> Option<String> {
        if self.converged() {
            self.unresolved().map(|it| it.to_string())
        } else {
            Some(self.termination().description().to_owned())
        }
    }
}

/// A contact of a lens or plate with a pillar pattern or a general surface. Loading curves, their figures and warnings use only this trait, so
/// that they are the same for all contacts.
pub trait Contact: Solution {
    /// Indentation, m.
    fn indentation(&self) -> f64;
    /// Normal force, N.
    fn force(&self) -> f64;
    /// Contact radius, m; `None` for a plate.
    fn contact_radius(&self) -> Option<f64>;
    /// Validity warnings.
    fn warnings(&self) -> &[Warning];
}

impl Solution for ContactState {
    fn termination(&self) -> Termination {
        self.termination
    }

    fn unresolved(&self) -> Option<Unresolved> {
        ContactState::unresolved(self)
    }
}

impl Solution for SurfaceContact {
    fn termination(&self) -> Termination {
        self.termination
    }

    fn unresolved(&self) -> Option<Unresolved> {
        SurfaceContact::unresolved(self)
    }
}

impl Solution for AsperityContact {
    fn termination(&self) -> Termination {
        self.termination
    }

    fn unresolved(&self) -> Option<Unresolved> {
        AsperityContact::unresolved(self)
    }
}

impl Solution for AsperityCycle {
    fn termination(&self) -> Termination {
        self.termination
    }

    fn unresolved(&self) -> Option<Unresolved> {
        AsperityCycle::unresolved(self)
    }
}

impl Solution for FlatContact {
    fn termination(&self) -> Termination {
        self.termination
    }

    fn unresolved(&self) -> Option<Unresolved> {
        FlatContact::unresolved(self)
    }
}

impl Solution for FlatCycle {
    fn termination(&self) -> Termination {
        self.turn.termination
    }

    fn unresolved(&self) -> Option<Unresolved> {
        FlatCycle::unresolved(self)
    }
}

impl Solution for Cycle {
    fn termination(&self) -> Termination {
        self.termination
    }

    fn unresolved(&self) -> Option<Unresolved> {
        Cycle::unresolved(self)
    }
}

impl Contact for ContactState {
    fn indentation(&self) -> f64 {
        self.indentation
    }

    fn force(&self) -> f64 {
        self.force
    }

    fn contact_radius(&self) -> Option<f64> {
        Some(self.whole_contact_radius())
    }

    fn warnings(&self) -> &[Warning] {
        &self.warnings
    }
}

impl Contact for SurfaceContact {
    fn indentation(&self) -> f64 {
        self.indentation
    }

    fn force(&self) -> f64 {
        self.force
    }

    fn contact_radius(&self) -> Option<f64> {
        self.contact_radius
    }

    fn warnings(&self) -> &[Warning] {
        &self.warnings
    }
}

impl Contact for AsperityContact {
    fn indentation(&self) -> f64 {
        self.indentation
    }

    fn force(&self) -> f64 {
        self.force
    }

    fn contact_radius(&self) -> Option<f64> {
        self.contact_radius
    }

    fn warnings(&self) -> &[Warning] {
        &[]
    }
}

impl Contact for FlatContact {
    fn indentation(&self) -> f64 {
        self.indentation
    }

    fn force(&self) -> f64 {
        self.force
    }

    fn contact_radius(&self) -> Option<f64> {
        Some(self.contact_radius)
    }

    fn warnings(&self) -> &[Warning] {
        &self.warnings
    }
}
