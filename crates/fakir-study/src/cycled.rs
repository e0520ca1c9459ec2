//! The answer to a case of which a cycle of loading and unloading with adhesion is asked.

use crate::collapsed::{FloorJump, FloorLoss};
use crate::exact;
use fakir::problem::Method;
use fakir::state::{Cycle, CycleError};
use fakir::theory::adhesion::kendall_pull_off;
use serde::{Deserialize, Serialize};

/// The numbers of a cycle: those of `fakir approach --retract --json`, and reduced ones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cycled {
    /// Name of the method.
    pub method: String,
    /// Fraction of the surface that is pillar top.
    #[serde(with = "exact")]
    pub surface_fraction: f64,
    /// Distance of neighbouring pillars, m.
    #[serde(rename = "pitch_m", with = "exact")]
    pub pitch: f64,
    /// Work of adhesion where contact is made, J/m^2.
    #[serde(rename = "work_of_adhesion_J_per_m2", with = "exact")]
    pub work: f64,
    /// Work of adhesion where contact is broken, J/m^2.
    #[serde(rename = "receding_work_of_adhesion_J_per_m2", with = "exact")]
    pub work_receding: f64,
    /// What is held while contacts snap: `displacement`, `force` or `machine`.
    pub drive: String,
    /// Stiffness of the machine, N/m; none unless one drives the lens.
    #[serde(rename = "machine_stiffness_N_per_m")]
    pub machine_stiffness: Option<f64>,
    /// What was found on loading.
    #[serde(flatten)]
    pub loading: Loading,
    /// The largest pull of the unloading; none if nothing pulls.
    pub pull_off: Option<Pull>,
    /// Pull-off force of one pillar with a flat top alone (Kendall), N, negative.
    #[serde(rename = "kendall_pull_off_force_N", with = "exact")]
    pub kendall_pull_off: f64,
    /// Indentation of the last release, m; none if something is still in contact.
    #[serde(rename = "last_release_indentation_m")]
    pub last_release: Option<f64>,
    /// Work done against the pull of the pillars while the lens was withdrawn, J.
    #[serde(rename = "work_of_separation_J", with = "exact")]
    pub work_of_separation: f64,
    /// The loop of force over indentation; none of a path that is not closed.
    pub hysteresis: Option<Hysteresis>,
    /// What a floor that sticks does; none if it does not, or was not touched.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floor: Option<OnStuckFloor>,
    /// Stress of Kendall's punch at pull-off over the modulus of the substrate.
    #[serde(with = "exact")]
    pub kendall_strain: f64,
    /// Whether the numbers are the solution.
    pub converged: bool,
}

/// What was found on loading.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Loading {
    /// Critical force, N; none, as all of the critical state, if the lens does not go down so far.
    #[serde(rename = "critical_force_N")]
    pub critical_force: Option<f64>,
    /// Critical indentation, m.
    #[serde(rename = "critical_indentation_m")]
    pub critical_indentation: Option<f64>,
    /// Critical contact radius, m.
    #[serde(rename = "critical_contact_radius_m")]
    pub critical_contact_radius: Option<f64>,
    /// Estimated relative error of the critical force.
    pub critical_force_error: Option<Errors>,
    /// Estimated relative error of the critical indentation.
    pub critical_indentation_error: Option<Errors>,
    /// Force where the lens turned back, N.
    #[serde(rename = "turn_force_N", with = "exact")]
    pub turn_force: f64,
    /// Indentation there, m.
    #[serde(rename = "turn_indentation_m", with = "exact")]
    pub turn_indentation: f64,
    /// Number of pillars in contact there.
    pub turn_pillars_in_contact: usize,
}

/// The largest pull of the unloading.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pull {
    /// Force, N, negative.
    #[serde(rename = "force_N", with = "exact")]
    pub force: f64,
    /// Indentation, m.
    #[serde(rename = "indentation_m", with = "exact")]
    pub indentation: f64,
    /// Number of pillars in contact.
    pub pillars_in_contact: usize,
    /// The force over that of one flat top alone: how many pillars would pull as much, each alone.
    #[serde(with = "exact")]
    pub normalized_force: f64,
    /// Estimated relative error of the force.
    pub error: Errors,
}

/// The loop of force over indentation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hysteresis {
    /// Its area, J.
    #[serde(rename = "area_J", with = "exact")]
    pub area: f64,
    /// That over what it takes to part the largest area of tops that was in contact.
    #[serde(with = "exact")]
    pub normalized: f64,
    /// Relative difference from the sum of what all changes of contact dissipate.
    #[serde(with = "exact")]
    pub certificate: f64,
    /// Estimated relative error of the area.
    pub error: Errors,
}

/// What a floor that sticks does, on cells.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OnStuckFloor {
    /// The state after the jump onto it.
    pub jump: FloorJump,
    /// Where it is lost: the last state with the floor in contact; none if it still is.
    pub lost: Option<FloorLoss>,
    /// Whether cells are so coarse that these are orders of magnitude.
    pub coarse: bool,
    /// Estimated relative error of the force after the jump.
    #[serde(with = "exact")]
    pub jump_force_error: f64,
    /// That of the area.
    #[serde(with = "exact")]
    pub jump_area_error: f64,
    /// That of the indentation at which the floor is lost.
    #[serde(with = "exact")]
    pub lost_indentation_error: f64,
}

impl OnStuckFloor {
    fn of(cycle: &Cycle) -> Option<Self> {
        let resolution = cycle.floor?;
        let [_, after] = cycle.floor_jump()?;
        let floor = after.floor?;
        let errors = resolution.errors;
        Some(Self {
            jump: FloorJump {
                force: after.force,
                floor_area: floor.area,
                front_radius: floor.radius,
                holes: floor.holes,
            },
            lost: cycle.floor_lost().map(|[last, _]| FloorLoss {
                indentation: last.indentation,
                force: last.force,
            }),
            coarse: resolution.is_coarse(),
            jump_force_error: errors.jump_force,
            jump_area_error: errors.jump_area,
            lost_indentation_error: errors.lost_indentation,
        })
    }
}

/// Estimated relative errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Of the numerical solution.
    #[serde(with = "exact")]
    pub numerical: f64,
    /// Of the model.
    #[serde(with = "exact")]
    pub model: f64,
}

impl From<CycleError> for Errors {
    fn from(error: CycleError) -> Self {
        Self {
            numerical: error.numerical(),
            model: error.model(),
        }
    }
}

impl From<&Cycle> for Cycled {
    fn from(cycle: &Cycle) -> Self {
        let system = &cycle.system;
        let adhesion = system.adhesion();
        let radius = 0.5 * system.pillar().diameter;
        let kendall = kendall_pull_off(system.reduced_modulus(), radius, adhesion.receding());
        let areas = cycle.stations.iter().map(|station| station.contact_area);
        let parting = adhesion.receding() * areas.fold(0.0, f64::max);
        Self {
            method: Method::Spectral(cycle.accuracy).name().to_owned(),
            surface_fraction: system.texture().surface_fraction(),
            pitch: system.pitch(),
            work: adhesion.work,
            work_receding: adhesion.receding(),
            drive: cycle.plan.drive.name().to_owned(),
            machine_stiffness: cycle.plan.drive.stiffness(),
            loading: Loading::from(cycle),
            pull_off: cycle.pull_off.as_ref().map(|pull_off| Pull {
                force: pull_off.force,
                indentation: pull_off.indentation,
                pillars_in_contact: pull_off.pillars.len(),
                normalized_force: pull_off.force / kendall,
                error: cycle.errors.pull_off_force.into(),
            }),
            kendall_pull_off: kendall,
            last_release: cycle.separation,
            work_of_separation: cycle.work_of_separation,
            hysteresis: cycle.certificate().map(|certificate| Hysteresis {
                area: cycle.loop_area,
                normalized: cycle.loop_area / parting,
                certificate,
                error: cycle.errors.loop_area.into(),
            }),
            floor: OnStuckFloor::of(cycle),
            kendall_strain: system.kendall_strain(),
            converged: cycle.converged(),
        }
    }
}

impl From<&Cycle> for Loading {
    fn from(cycle: &Cycle) -> Self {
        let (critical, errors) = (cycle.critical.as_ref(), &cycle.errors);
        Self {
            critical_force: critical.map(|it| it.contact.force),
            critical_indentation: critical.map(|it| it.contact.indentation),
            critical_contact_radius: critical.map(fakir::state::CriticalState::contact_radius),
            critical_force_error: critical.map(|_| errors.critical_force.into()),
            critical_indentation_error: critical.map(|_| errors.critical_indentation.into()),
            turn_force: cycle.turn.force,
            turn_indentation: cycle.turn.indentation,
            turn_pillars_in_contact: cycle.turn.pillars_in_contact,
        }
    }
}
