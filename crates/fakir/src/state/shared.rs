//! Common properties of all results, and of all contacts by pillars or by cells.

use super::asperity_contact::AsperityContact;
use super::asperity_cycle::AsperityCycle;
use super::contact::{ContactState, Termination, Warning};
use super::cycle::Cycle;
use super::flat::{FlatContact, FlatCycle};
use super::history::ElasticSample;
use super::resolution::Unresolved;
use super::surface::SurfaceContact;
use super::surface_cycle::SurfaceCycle;
use crate::problem::ContactAreas;

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
    /// Areas in contact, on which interactions act.
    fn areas(&self) -> ContactAreas;
    /// Force on the floor, N; 0 before the transition and without a floor.
    fn floor_force(&self) -> f64 {
        0.0
    }
    /// Number of pillars in contact, if there are pillars.
    fn pillars_in_contact(&self) -> Option<usize> {
        None
    }
    /// Estimated relative error of the force.
    fn force_error(&self) -> f64;
    /// A point of the elastic loading curve.
    fn elastic_sample(&self) -> ElasticSample {
        ElasticSample {
            indentation: self.indentation(),
            force: self.force(),
            floor_force: self.floor_force(),
            contact_radius: self.contact_radius().unwrap_or(f64::NAN),
            pillars_in_contact: self.pillars_in_contact(),
            error: self.force_error(),
        }
    }
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

impl Solution for SurfaceCycle {
    fn termination(&self) -> Termination {
        self.termination
    }

    fn unresolved(&self) -> Option<Unresolved> {
        SurfaceCycle::unresolved(self)
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

    fn areas(&self) -> ContactAreas {
        ContactState::areas(self)
    }

    fn floor_force(&self) -> f64 {
        self.floor.as_ref().map_or(0.0, |floor| floor.force)
    }

    fn pillars_in_contact(&self) -> Option<usize> {
        Some(self.pillars_in_contact)
    }

    fn force_error(&self) -> f64 {
        self.error.force
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

    fn areas(&self) -> ContactAreas {
        SurfaceContact::areas(self)
    }

    fn floor_force(&self) -> f64 {
        self.shares.map_or(0.0, |shares| shares.floor.force)
    }

    fn force_error(&self) -> f64 {
        self.error.map_or(f64::NAN, |error| error.force)
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

    fn areas(&self) -> ContactAreas {
        AsperityContact::areas(self)
    }

    fn pillars_in_contact(&self) -> Option<usize> {
        Some(self.touched())
    }

    fn force_error(&self) -> f64 {
        self.error.as_ref().map_or(f64::NAN, |error| error.force)
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

    fn areas(&self) -> ContactAreas {
        FlatContact::areas(self)
    }

    fn force_error(&self) -> f64 {
        self.error.force
    }
}
