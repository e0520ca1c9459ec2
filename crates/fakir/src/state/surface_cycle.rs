//! Results of a cycle of loading and unloading of a height map with adhesion.

use super::contact::Termination;
use super::cycle::Branch;
use super::resolution::{Remedy, Unresolved};
use super::surface::{SurfaceContact, SurfaceTransition};
use crate::problem::CyclePlan;

/// A point of the curve of a [`SurfaceCycle`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceLoadStep {
    /// Its branch.
    pub branch: Branch,
    /// Indentation, m.
    pub indentation: f64,
    /// Normal force, N; negative for tension.
    pub force: f64,
    /// Area of the cells in contact, m^2.
    pub contact_area: f64,
}

/// Estimated relative errors of the results of a cycle due to the cell size, from the same cycle on larger cells, and from forces on unloading that are
/// above those on loading, which only cells cause.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceCycleErrors {
    /// Relative error of the pull-off force.
    pub pull_off_force: f64,
    /// Relative error of the work of separation.
    pub work_of_separation: f64,
    /// Relative error of the loop area.
    pub loop_area: f64,
}

/// Loading and unloading of a height map with adhesion, at a controlled indentation.
#[derive(Debug, Clone)]
pub struct SurfaceCycle {
    /// What was prescribed.
    pub plan: CyclePlan,
    /// The curve of force over indentation in its order. Parts of the contact attach and detach between its points.
    pub load_steps: Vec<SurfaceLoadStep>,
    /// Index of the first load step with contact.
    pub first_contact: Option<usize>,
    /// The critical state, of a loading that ends at a fraction of the critical indentation.
    pub critical: Option<SurfaceTransition>,
    /// The contact at the end of loading.
    pub turn: SurfaceContact,
    /// The contact with the largest tensile force of the unloading, without error estimate; none without unloading or without tension.
    pub pull_off: Option<SurfaceContact>,
    /// Indentation of the last detachment, m; none without unloading.
    pub separation: Option<f64>,
    /// The tensile part of `∫F dδ` during unloading, J; none without unloading.
    pub work_of_separation: Option<f64>,
    /// Area of the loop of force over indentation, J: the energy that is dissipated; none without unloading.
    pub loop_area: Option<f64>,
    /// Estimated relative errors.
    pub errors: Option<SurfaceCycleErrors>,
    /// Pull-off force, N, and area of the loop, J, on cells of twice the size; none without unloading.
    pub larger_cells: Option<[f64; 2]>,
    /// Why the solver stopped.
    pub termination: Termination,
}

impl SurfaceCycle {
    /// Whether the solver converged.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.termination == Termination::Converged
    }

    /// The first result of a converged solution that is [not resolved](Unresolved), among the end of loading, pull-off, the work of separation
    /// and the hysteresis.
    #[must_use]
    pub fn unresolved(&self) -> Option<Unresolved> {
        if !self.converged() {
            return None;
        }
        let turn = self.turn.error.map_or(0.0, |error| error.force);
        let area = self.turn.area_error.unwrap_or_default();
        let mut numbers = vec![
            ("force at the end of loading", turn),
            ("contact area at the end of loading", area),
        ];
        if let Some(errors) = self.errors.filter(|_| self.separation.is_some()) {
            numbers.extend([
                ("pull-off force", errors.pull_off_force),
                ("work of separation", errors.work_of_separation),
                ("hysteresis", errors.loop_area),
            ]);
        }
        Unresolved::among(numbers, Remedy::SmallerCells)
    }
}
