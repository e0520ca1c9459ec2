//! What all contacts have in common, pillar by pillar or cell by cell.

use super::contact::{ContactState, ErrorEstimate, Termination, Warning};
use super::surface::{Shares, SurfaceContact};

/// A contact, of whatever with whatever surface. Studies, comparisons and tables that ask for no more than this are the
/// same for all.
pub trait Contact {
    /// Indentation, m.
    fn indentation(&self) -> f64;
    /// Normal force, N.
    fn force(&self) -> f64;
    /// Contact radius, m; none under a plate.
    fn contact_radius(&self) -> Option<f64>;
    /// Estimated error of the contact radius relative to it; none under a plate.
    fn relative_contact_radius_error(&self) -> Option<f64>;
    /// Estimated relative errors of force and indentation; none where there is nothing to compare with.
    fn error(&self) -> Option<ErrorEstimate>;
    /// Smallest gap to the floor, m; none where it is not known what the floor is.
    fn smallest_floor_gap(&self) -> Option<f64>;
    /// What tops and floor bear, where that is known.
    fn shares(&self) -> Option<Shares>;
    /// Why the solver stopped.
    fn termination(&self) -> Termination;
    /// Newton steps, or products of the operator with pressures.
    fn iterations(&self) -> usize;
    /// What to be careful about.
    fn warnings(&self) -> &[Warning];

    /// Whether the numbers are the solution.
    fn converged(&self) -> bool {
        self.termination() == Termination::Converged
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
        Some(self.contact_radius)
    }

    fn relative_contact_radius_error(&self) -> Option<f64> {
        Some(self.relative_contact_radius_error())
    }

    fn error(&self) -> Option<ErrorEstimate> {
        Some(self.error)
    }

    fn smallest_floor_gap(&self) -> Option<f64> {
        Some(self.smallest_floor_gap)
    }

    fn shares(&self) -> Option<Shares> {
        None
    }

    fn termination(&self) -> Termination {
        self.termination
    }

    fn iterations(&self) -> usize {
        self.iterations
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

    fn relative_contact_radius_error(&self) -> Option<f64> {
        self.relative_contact_radius_error()
    }

    fn error(&self) -> Option<ErrorEstimate> {
        self.error
    }

    fn smallest_floor_gap(&self) -> Option<f64> {
        self.nearest_floor.map(|(gap, _)| gap)
    }

    fn shares(&self) -> Option<Shares> {
        self.shares
    }

    fn termination(&self) -> Termination {
        self.termination
    }

    fn iterations(&self) -> usize {
        self.products
    }

    fn warnings(&self) -> &[Warning] {
        &self.warnings
    }
}
