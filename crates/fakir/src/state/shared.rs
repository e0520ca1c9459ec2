//! What all contacts have in common, pillar by pillar or cell by cell.

use super::cap_contact::CapContact;
use super::contact::{ContactState, Termination, Warning};
use super::resolution::Unresolved;
use super::surface::SurfaceContact;

/// A contact of a lens or plate with pillars, rounded or flat, or a general surface. Loadings, their figures and warnings ask for no more
/// than this, and so are the same for all.
pub trait Contact {
    /// Indentation, m.
    fn indentation(&self) -> f64;
    /// Normal force, N.
    fn force(&self) -> f64;
    /// Contact radius, m; none under a plate.
    fn contact_radius(&self) -> Option<f64>;
    /// Why the solver stopped.
    fn termination(&self) -> Termination;
    /// What to be careful about.
    fn warnings(&self) -> &[Warning];

    /// The first number of a solution that is not resolved, if there is one.
    fn unresolved(&self) -> Option<Unresolved>;

    /// Whether the numbers are the solution.
    fn converged(&self) -> bool {
        self.termination() == Termination::Converged
    }

    /// Whether the numbers are an answer: the solution, and resolved.
    fn is_answer(&self) -> bool {
        self.converged() && self.unresolved().is_none()
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

    fn termination(&self) -> Termination {
        self.termination
    }

    fn unresolved(&self) -> Option<Unresolved> {
        ContactState::unresolved(self)
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

    fn termination(&self) -> Termination {
        self.termination
    }

    fn unresolved(&self) -> Option<Unresolved> {
        SurfaceContact::unresolved(self)
    }

    fn warnings(&self) -> &[Warning] {
        &self.warnings
    }
}

impl Contact for CapContact {
    fn indentation(&self) -> f64 {
        self.indentation
    }

    fn force(&self) -> f64 {
        self.force
    }

    fn contact_radius(&self) -> Option<f64> {
        self.contact_radius
    }

    fn termination(&self) -> Termination {
        self.termination
    }

    fn unresolved(&self) -> Option<Unresolved> {
        CapContact::unresolved(self)
    }

    fn warnings(&self) -> &[Warning] {
        &[]
    }
}
