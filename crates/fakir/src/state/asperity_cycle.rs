//! Results of a cycle of loading and unloading of rounded tops with adhesion.

use super::asperity_contact::AsperityContact;
use super::contact::Termination;
use super::critical::Critical;
use super::cycle::{Branch, CycleEventKind, energy_balance};
use super::resolution::{Remedy, Unresolved};
use crate::problem::{Accuracy, CyclePlan, Point};

/// A point of the curve of an [`AsperityCycle`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AsperityLoadStep {
    /// The branch of the point.
    pub branch: Branch,
    /// Indentation, m.
    pub indentation: f64,
    /// Normal force, N; negative for tension.
    pub force: f64,
    /// Area of all contacts, m^2.
    pub contact_area: f64,
    /// Distance of the farthest point in contact from the lens axis, m.
    pub contact_radius: f64,
    /// Number of asperities in contact.
    pub pillars_in_contact: usize,
    /// Number of [`AsperityCycle::events`] up to this point.
    pub events: usize,
}

/// A contact that begins or ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AsperityEvent {
    /// The branch of the event.
    pub branch: Branch,
    /// [`CycleEventKind::SnapIn`] or [`CycleEventKind::Release`].
    pub kind: CycleEventKind,
    /// Index of the asperity.
    pub asperity: usize,
    /// Its position, m.
    pub apex: Point,
    /// Indentation after the event, m; equal for all events of a cascade.
    pub indentation: f64,
    /// Force after the event, N.
    pub force: f64,
    /// Radius of the contact, m: after the event if it begins, before the event if it ends.
    pub radius: f64,
}

/// Estimated relative errors of the results of a cycle, from a pressure of a higher degree and from the ovality of the contacts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AsperityCycleErrors {
    /// Relative error of the pull-off force.
    pub pull_off_force: f64,
    /// Relative error of the loop area.
    pub loop_area: f64,
}

/// A cycle of loading and unloading of rounded tops with adhesion.
#[derive(Debug, Clone)]
pub struct AsperityCycle {
    /// The plan of the cycle.
    pub plan: CyclePlan,
    /// Accuracy setting.
    pub accuracy: Accuracy,
    /// The curve of force over indentation in its order; two points where contacts begin or end.
    pub load_steps: Vec<AsperityLoadStep>,
    /// Contacts that begin and end, in order.
    pub events: Vec<AsperityEvent>,
    /// Index of the first load step with contact.
    pub first_contact: Option<usize>,
    /// Indentation at which the force first increases through zero during loading, m: the equilibrium without load.
    pub zero_load_indentation: Option<f64>,
    /// The critical state, of a loading that ends at a fraction of the critical indentation.
    pub critical: Option<Critical<AsperityContact>>,
    /// The contact at the end of loading.
    pub turn: AsperityContact,
    /// The contact with the largest tensile force of the unloading, without error estimate and without the contact with the floor; none without unloading or without tension.
    pub pull_off: Option<AsperityContact>,
    /// Indentation of the last detachment, m; none without unloading.
    pub separation: Option<f64>,
    /// The tensile part of `∫F dδ` during unloading, J; none without unloading, and under a prescribed force, where the lens leaves at once.
    pub work_of_separation: Option<f64>,
    /// Area of the loop of force over indentation, J; none where the loop is not closed.
    pub loop_area: Option<f64>,
    /// Energy that all jumps dissipate, J: the elastic energy that they release less the work of adhesion of the area that they separate. It
    /// is summed independently of the loop area.
    pub dissipation: f64,
    /// Estimated relative errors.
    pub errors: AsperityCycleErrors,
    /// Why the path ended.
    pub termination: Termination,
}

impl AsperityCycle {
    /// Adds the differences from the same cycle on larger cells of the floor, times a factor, to the errors.
    pub(crate) fn compare(&mut self, other: &Self, factor: f64) {
        let relative = |one: Option<f64>, two: Option<f64>| match (one, two) {
            (Some(one), Some(two)) if other.converged() => (two / one - 1.0).abs(),
            (None, None) => 0.0,
            _ => 1.0,
        };
        let force = |cycle: &Self| cycle.pull_off.as_ref().map(|contact| contact.force);
        self.errors.pull_off_force += factor * relative(force(self), force(other));
        self.errors.loop_area += factor * relative(self.loop_area, other.loop_area);
    }

    /// Whether the solver converged.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.termination == Termination::Converged
    }

    /// The first result of a converged solution that is [not resolved](Unresolved), among the end of loading, pull-off and the hysteresis.
    #[must_use]
    pub fn unresolved(&self) -> Option<Unresolved> {
        if !self.converged() {
            return None;
        }
        let numbers = [
            Unresolved::at_the_end_of_loading(self.turn.unresolved()),
            (
                "pull-off force",
                self.pull_off
                    .as_ref()
                    .map_or(0.0, |_| self.errors.pull_off_force),
            ),
            (
                "hysteresis",
                self.loop_area.map_or(0.0, |_| self.errors.loop_area),
            ),
        ];
        let remedy = match self.accuracy {
            Accuracy::Default => Remedy::AccurateSetting,
            Accuracy::Accurate => Remedy::HigherLoad,
        };
        Unresolved::among(numbers, remedy)
    }

    /// Energy balance error of a closed loop: difference between loop area and dissipation, divided by the larger one. It is zero for the
    /// exact solution of contacts that are discs; here it includes the error of a pressure of finite degree.
    #[must_use]
    pub fn certificate(&self) -> Option<f64> {
        Some(energy_balance(self.loop_area?, self.dissipation))
    }
}
