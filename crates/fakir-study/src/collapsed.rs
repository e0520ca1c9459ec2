//! How a floor that sticks collapses and lets go, by the fast model of a collapsed floor and by closed forms.

use crate::exact;
use fakir::problem::{Method, System};
use fakir::state::{Run, SolveError, Termination};
use fakir::theory::stuck_floor::StuckFloor;
use serde::{Deserialize, Serialize};

pub use fakir::collapse::{
    Fate, LARGEST_INDENTATION, MODEL_ERROR_OF_LOSS, STEP, Validity, collapse_path,
};

/// How [`Fate`] is written.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Fate", rename_all = "snake_case")]
enum WrittenFate {
    Unknown,
    NoPatch,
    LostUnderLoad,
    HeldThroughZero,
}

/// How [`Validity`] is written.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Validity", rename_all = "snake_case")]
enum WrittenValidity {
    InRange,
    FrontNarrow,
    AnnuliWide,
    AnnuliMeet,
    NoFront,
}

/// The state just after the floor was first touched.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FloorJump {
    /// Force, N.
    #[serde(rename = "force_N", with = "exact")]
    pub force: f64,
    /// Area of the floor that sticks, m^2.
    #[serde(rename = "floor_area_m2", with = "exact")]
    pub floor_area: f64,
    /// Radius of the front, m.
    #[serde(rename = "front_radius_m", with = "exact")]
    pub front_radius: f64,
    /// Middles between three pillars inside the front.
    pub holes: usize,
}

/// Where the floor lets go of the lens.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FloorLoss {
    /// Indentation, m, within half a step.
    #[serde(rename = "indentation_m", with = "exact")]
    pub indentation: f64,
    /// Force just before, N.
    #[serde(rename = "force_N", with = "exact")]
    pub force: f64,
}

/// The critical state of the tops, what a floor that sticks does from there, and the closed forms.
///
/// The lens goes down to [`LARGEST_INDENTATION`] times the critical indentation and up again. What the tops do is computed without adhesion
/// up to the critical state, which changes its force by less than 1 %.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Collapsed {
    /// Name of the method.
    pub method: String,
    /// Fraction of the surface that is pillar top.
    #[serde(with = "exact")]
    pub surface_fraction: f64,
    /// Distance of neighbouring pillars, m.
    #[serde(rename = "pitch_m", with = "exact")]
    pub pitch: f64,
    /// Work of adhesion, J/m^2.
    #[serde(rename = "work_of_adhesion_J_per_m2", with = "exact")]
    pub work: f64,
    /// That over the reduced modulus and the radius of a pillar.
    #[serde(with = "exact")]
    pub work_over_stiffness: f64,
    /// Work of adhesion above which the flat lattice collapses without load, J/m^2.
    #[serde(rename = "collapse_work_J_per_m2", with = "exact")]
    pub collapse_work: f64,
    /// The work of adhesion over that.
    #[serde(with = "exact")]
    pub work_over_collapse_work: f64,
    /// Outer radius of the free annulus round a pillar without pressure, m; none where no edge stands.
    #[serde(rename = "annulus_radius_m")]
    pub annulus_radius: Option<f64>,
    /// Height of a pillar over the width of that annulus: beyond about 1 linear elasticity is doubtful.
    pub annulus_slope: Option<f64>,
    /// What the stuck floor of a flat lattice has won, J/m^2; none where annuli fill the cells.
    #[serde(rename = "net_work_J_per_m2")]
    pub net_work: Option<f64>,
    /// Pull-off force from a stuck floor seen as smooth, N, negative; none where it lets go before.
    #[serde(rename = "smooth_floor_pull_off_force_N")]
    pub smooth_pull_off: Option<f64>,
    /// `R h/d^2`: the lens in the units of the pillars.
    #[serde(with = "exact")]
    pub lens_number: f64,
    /// `kappa`: how much a pillar gives way as a column, over how much as a punch.
    #[serde(with = "exact")]
    pub column_number: f64,
    /// Critical force, N.
    #[serde(rename = "critical_force_N", with = "exact")]
    pub critical_force: f64,
    /// Critical indentation, m.
    #[serde(rename = "critical_indentation_m", with = "exact")]
    pub critical_indentation: f64,
    /// Critical contact radius, m.
    #[serde(rename = "critical_contact_radius_m", with = "exact")]
    pub critical_contact_radius: f64,
    /// Estimated relative error of the critical force.
    #[serde(with = "exact")]
    pub relative_error_estimate_critical_force: f64,
    /// The state after the jump; none if the model has none.
    pub jump: Option<FloorJump>,
    /// Where the lens turned back, m; none if the model has no loading.
    #[serde(rename = "turn_indentation_m")]
    pub turn_indentation: Option<f64>,
    /// What becomes of the floor.
    #[serde(with = "WrittenFate")]
    pub fate: Fate,
    /// Where the floor is lost; none if it does not stick, or still does at the end.
    pub lost: Option<FloorLoss>,
    /// The largest pull while the floor sticks, N, negative; none if it lets go under load.
    #[serde(rename = "floor_pull_off_force_N")]
    pub pull_off: Option<f64>,
    /// Area between loading and unloading as far as the floor sticks, J. What tops lose that stick is not in it.
    #[serde(rename = "floor_hysteresis_J")]
    pub hysteresis: Option<f64>,
    /// Whether the model is good for the jump.
    #[serde(with = "WrittenValidity")]
    pub jump_validity: Validity,
    /// Whether it is where the lens turns back, from which the loss of the floor and what follows comes.
    #[serde(with = "WrittenValidity")]
    pub unloading_validity: Validity,
    /// Error of the force after the jump by the model over that force; none out of its range.
    pub force_error: Option<f64>,
    /// Relative error of the area after the jump by the model; none out of its range.
    pub area_error: Option<f64>,
}

/// The critical state of a system, and what a floor that sticks does from there. The method is that of the critical state.
///
/// # Errors
/// Those of [`fakir::collapse::collapse`].
pub fn collapse(
    system: &System,
    method: Method,
    run: &Run<'_>,
) -> Result<(Collapsed, Termination), SolveError> {
    let found = fakir::collapse::collapse(system, method, run)?;
    let floor = StuckFloor::of(system)?;
    let contact = &found.critical.contact;
    let work = system.adhesion().work;
    let shape = system.pillar();
    let radius = 0.5 * shape.diameter;
    let lens = system.lens().sphere_radius();
    let threshold = floor.collapse_threshold();
    let collapsed = Collapsed {
        method: "collapsed_floor".to_owned(),
        surface_fraction: system.texture().surface_fraction(),
        pitch: system.pitch(),
        work,
        work_over_stiffness: work / (system.reduced_modulus() * radius),
        collapse_work: threshold.work,
        work_over_collapse_work: work / threshold.work,
        annulus_radius: found.annulus_radius,
        annulus_slope: found
            .annulus_radius
            .map(|edge| shape.height / (edge - radius)),
        net_work: floor.net_work(work)?,
        smooth_pull_off: floor.pull_off(lens, work)?,
        lens_number: lens * shape.height / shape.diameter.powi(2),
        column_number: system.column_compliance_ratio(),
        critical_force: contact.force,
        critical_indentation: contact.indentation,
        critical_contact_radius: found.critical.contact_radius(),
        relative_error_estimate_critical_force: contact.error.force,
        jump: found.jump.map(|point| FloorJump {
            force: point.force,
            floor_area: point.floor_area,
            front_radius: point.front_radius,
            holes: found.holes,
        }),
        turn_indentation: found.turn_indentation,
        fate: found.fate,
        lost: found
            .lost
            .map(|[indentation, force]| FloorLoss { indentation, force }),
        pull_off: found.pull_off,
        hysteresis: found.hysteresis,
        jump_validity: found.jump_validity,
        unloading_validity: found.unloading_validity,
        force_error: found.force_error,
        area_error: found.area_error,
    };
    Ok((collapsed, contact.termination))
}
