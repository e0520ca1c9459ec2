//! Contacts with a flat surface.

use super::contact::{Termination, Warning};
use super::cycle::Branch;
use super::error::SolveError;
use super::finite::check_number;
use super::resolution::{Remedy, Unresolved};
use crate::problem::{CyclePlan, Interactions};

/// Estimated relative errors of a contact with a flat surface, from a solution with more points. On half-spaces under a sphere or a paraboloid they are
/// rounding errors.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FlatErrors {
    /// Relative error of the force; of a prescribed force 0.
    pub force: f64,
    /// Relative error of the indentation; of a prescribed indentation 0.
    pub indentation: f64,
    /// Relative error of the contact radius.
    pub contact_radius: f64,
}

/// The contact of a [`FlatSystem`](crate::problem::FlatSystem): a disc.
#[derive(Debug, Clone, PartialEq)]
pub struct FlatContact {
    /// Indentation: displacement of the lens since its lowest point touched the undeformed surface, m. Negative if adhesion keeps the lens attached
    /// under tension.
    pub indentation: f64,
    /// Normal force, N; negative for tension.
    pub force: f64,
    /// Contact radius, m.
    pub contact_radius: f64,
    /// Contact area, m^2.
    pub contact_area: f64,
    /// Pressure on the lens axis, Pa. Without adhesion under a lens it is the largest.
    pub pressure_on_axis: f64,
    /// Change of the force with the indentation, N/m, the rim moving as it does on loading.
    pub stiffness: f64,
    /// Change of the force with the indentation with a fixed rim, N/m: the initial slope of an unloading whose rim stays.
    pub punch_stiffness: f64,
    /// Estimated errors.
    pub error: FlatErrors,
    /// Why the solver stopped.
    pub termination: Termination,
    /// What to be careful about.
    pub warnings: Vec<Warning>,
}

impl FlatContact {
    /// Area over which the surfaces are in contact divided into the force: the mean pressure, Pa; 0 without contact.
    #[must_use]
    pub fn mean_pressure(&self) -> f64 {
        if self.contact_area > 0.0 {
            self.force / self.contact_area
        } else {
            0.0
        }
    }

    /// Whether the numbers are the solution.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.termination == Termination::Converged
    }

    /// The first number of a solution that is [not resolved](Unresolved).
    #[must_use]
    pub fn unresolved(&self) -> Option<Unresolved> {
        if !self.converged() {
            return None;
        }
        let numbers = [
            ("force", self.error.force),
            ("indentation", self.error.indentation),
            ("contact radius", self.error.contact_radius),
        ];
        Unresolved::among(numbers, Remedy::HigherLoad)
    }

    /// The contact with all numbers checked to be finite.
    pub(crate) fn checked(mut self) -> Result<Self, SolveError> {
        check_number("indentation", &mut self.indentation)?;
        check_number("force", &mut self.force)?;
        check_number("contact radius", &mut self.contact_radius)?;
        check_number("contact area", &mut self.contact_area)?;
        check_number("pressure on the axis", &mut self.pressure_on_axis)?;
        check_number("stiffness", &mut self.punch_stiffness)?;
        check_number("error estimate of the force", &mut self.error.force)?;
        check_number(
            "error estimate of the indentation",
            &mut self.error.indentation,
        )?;
        check_number(
            "error estimate of the contact radius",
            &mut self.error.contact_radius,
        )?;
        Ok(self)
    }
}

/// A point of the curve of a [`FlatCycle`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlatLoadStep {
    /// Its branch.
    pub branch: Branch,
    /// Indentation, m.
    pub indentation: f64,
    /// Normal force, N.
    pub force: f64,
    /// Contact radius, m.
    pub contact_radius: f64,
}

/// Loading and unloading of a flat surface with adhesion.
#[derive(Debug, Clone, PartialEq)]
pub struct FlatCycle {
    /// What was prescribed.
    pub plan: CyclePlan,
    /// Interactions of the system that do not change the normal contact.
    pub interactions: Interactions,
    /// The curve of force over indentation in its order.
    pub load_steps: Vec<FlatLoadStep>,
    /// The contact right after the jump into contact.
    pub jump: FlatContact,
    /// The contact where the loading ended.
    pub turn: FlatContact,
    /// The contact with the largest tensile force of the unloading; none without unloading.
    pub pull_off: Option<FlatContact>,
    /// Indentation of the detachment, m; none without unloading.
    pub separation: Option<f64>,
    /// The tensile part of `∫F dδ` during unloading, J; none without unloading, and under a prescribed force, where the lens leaves at once.
    pub work_of_separation: Option<f64>,
    /// Area of the loop of force over indentation, J; none where the loop is not closed.
    pub loop_area: Option<f64>,
    /// Estimated relative error of the loop area, from half as many points of the curve.
    pub loop_area_error: f64,
}

impl FlatCycle {
    /// Whether the numbers are the solution.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.turn.converged()
    }
    /// The first result of a converged solution that is [not resolved](Unresolved), among the jump into contact, the end of loading, pull-off and
    /// the hysteresis.
    #[must_use]
    pub fn unresolved(&self) -> Option<Unresolved> {
        if !self.converged() {
            return None;
        }
        let of = |contact: &FlatContact| contact.unresolved().map_or(0.0, |found| found.error);
        let numbers = [
            ("force at the jump into contact", of(&self.jump)),
            ("force at the end of loading", of(&self.turn)),
            ("pull-off force", self.pull_off.as_ref().map_or(0.0, of)),
            (
                "hysteresis",
                self.loop_area.map_or(0.0, |_| self.loop_area_error),
            ),
        ];
        Unresolved::among(numbers, Remedy::HigherLoad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Adhesion, FlatSystem, Lens, Load, Material, UnloadingPoint};
    use crate::state::{Run, Solution};

    /// A number of a result and its error.
    type Place<T> = (&'static str, fn(&mut T) -> &mut f64);

    fn system() -> FlatSystem {
        let material = Material::new(2e6, 0.5);
        let lens = Lens {
            radius: 2e-3,
            material,
        };
        FlatSystem::new(lens, material).unwrap()
    }

    #[test]
    fn a_contact_without_a_first_digit_is_no_answer() {
        let contact = system()
            .press(Load::Indentation(1e-6), &Run::default())
            .unwrap();
        assert!(contact.is_answer());
        let places: [Place<FlatErrors>; 3] = [
            ("force", |error| &mut error.force),
            ("indentation", |error| &mut error.indentation),
            ("contact radius", |error| &mut error.contact_radius),
        ];
        for (quantity, place) in places {
            let mut doubtful = contact.clone();
            *place(&mut doubtful.error) = 0.6;
            assert!(!doubtful.is_answer());
            assert_eq!(doubtful.unresolved().unwrap().quantity, quantity);
        }
    }

    #[test]
    fn a_cycle_with_a_part_without_a_first_digit_is_no_answer() {
        let system = system().with_adhesion(Adhesion::new(50e-3)).unwrap();
        let plan = CyclePlan {
            turn: UnloadingPoint::Indentation(1e-6),
            ..CyclePlan::default()
        };
        let cycle = system.cycle(&plan, &Run::default()).unwrap();
        assert!(cycle.is_answer());
        let places: [Place<FlatCycle>; 4] = [
            ("force at the jump into contact", |cycle| {
                &mut cycle.jump.error.force
            }),
            ("force at the end of loading", |cycle| {
                &mut cycle.turn.error.force
            }),
            ("pull-off force", |cycle| {
                &mut cycle.pull_off.as_mut().unwrap().error.force
            }),
            ("hysteresis", |cycle| &mut cycle.loop_area_error),
        ];
        for (quantity, place) in places {
            let mut doubtful = cycle.clone();
            *place(&mut doubtful) = 0.6;
            assert!(doubtful.converged() && !doubtful.is_answer());
            assert_eq!(doubtful.unresolved().unwrap().quantity, quantity);
        }
    }
}
