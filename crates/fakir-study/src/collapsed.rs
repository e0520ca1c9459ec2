//! Collapse and detachment of an adhesive floor, by the fast model of a collapsed floor and by closed forms.

use crate::exact;
use fakir::problem::{Method, System};
use fakir::state::{Run, SolveError, Termination};
use fakir::theory::stuck_floor::AdhesiveFloor;
use serde::{Deserialize, Serialize};

pub use fakir::collapse::{
    FloorOutcome, LARGEST_INDENTATION, MODEL_ERROR_OF_LOSS, STEP, Validity, collapse_path,
};

/// Serialised form of [`FloorOutcome`].
#[derive(Serialize, Deserialize)]
#[serde(remote = "FloorOutcome", rename_all = "snake_case")]
enum WrittenOutcome {
    Unknown,
    NoPatch,
    LostUnderLoad,
    HeldThroughZero,
}

/// Serialised form of [`Validity`].
#[derive(Serialize, Deserialize)]
#[serde(remote = "Validity", rename_all = "snake_case")]
enum WrittenValidity {
    InRange,
    FrontNarrow,
    AnnuliWide,
    AnnuliMeet,
    NoFront,
}

/// The state just after jump-in to the floor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FloorJump {
    /// Force, N.
    #[serde(rename = "force_N", with = "exact")]
    pub force: f64,
    /// Adhering area of the floor, m^2.
    #[serde(rename = "floor_area_m2", with = "exact")]
    pub floor_area: f64,
    /// Radius of the front, m.
    #[serde(rename = "front_radius_m", with = "exact")]
    pub front_radius: f64,
    /// Number of centres between three pillars inside the front.
    pub holes: usize,
}

/// Detachment of the floor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FloorLoss {
    /// Indentation, m, within half a step.
    #[serde(rename = "indentation_m", with = "exact")]
    pub indentation: f64,
    /// Force just before detachment, N.
    #[serde(rename = "force_N", with = "exact")]
    pub force: f64,
}

/// The critical state of the tops, the behaviour of an adhesive floor from there, and the closed forms.
///
/// The lens is loaded to [`LARGEST_INDENTATION`] times the critical indentation and unloaded. The tops are computed without adhesion up to
/// the critical state, which changes its force by less than 1 %.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Collapsed {
    /// Name of the method.
    pub method: String,
    /// Fraction of the surface covered by pillar tops.
    #[serde(with = "exact")]
    pub surface_fraction: f64,
    /// Distance of neighbouring pillars, m.
    #[serde(rename = "pitch_m", with = "exact")]
    pub pitch: f64,
    /// Work of adhesion, J/m^2.
    #[serde(rename = "work_of_adhesion_J_per_m2", with = "exact")]
    pub work: f64,
    /// Work of adhesion divided by the reduced modulus and the radius of a pillar.
    #[serde(with = "exact")]
    pub work_over_stiffness: f64,
    /// Work of adhesion above which the flat lattice collapses at zero load, J/m^2.
    #[serde(rename = "collapse_work_J_per_m2", with = "exact")]
    pub collapse_work: f64,
    /// Ratio of the work of adhesion to that of collapse.
    #[serde(with = "exact")]
    pub work_over_collapse_work: f64,
    /// Outer radius of the detached annulus around a pillar at zero pressure, m; `None` if no edge is stable.
    #[serde(rename = "annulus_radius_m")]
    pub annulus_radius: Option<f64>,
    /// Ratio of the pillar height to the width of that annulus: above about 1 linear elasticity is doubtful.
    pub annulus_slope: Option<f64>,
    /// Energy gain per area of the adhering floor of a flat lattice, J/m^2; `None` if annuli fill the cells.
    #[serde(rename = "net_work_J_per_m2")]
    pub net_work: Option<f64>,
    /// Pull-off force from an adhering floor approximated as smooth, N, negative; `None` if it detaches before.
    #[serde(rename = "smooth_floor_pull_off_force_N")]
    pub smooth_pull_off: Option<f64>,
    /// `R h/d^2`: the lens radius in units of the pillars.
    #[serde(with = "exact")]
    pub lens_number: f64,
    /// `kappa`: ratio of the compliance of a pillar as a column to that as a punch.
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
    /// The state after jump-in; `None` if the model has none.
    pub jump: Option<FloorJump>,
    /// Largest indentation, m; `None` if the model has no loading.
    #[serde(rename = "turn_indentation_m")]
    pub turn_indentation: Option<f64>,
    /// Behaviour of the floor during unloading.
    #[serde(with = "WrittenOutcome")]
    pub fate: FloorOutcome,
    /// Detachment of the floor; `None` if it does not adhere, or still adheres at the end.
    pub lost: Option<FloorLoss>,
    /// The largest tensile force while the floor adheres, N, negative; `None` if the floor detaches under compression.
    #[serde(rename = "floor_pull_off_force_N")]
    pub pull_off: Option<f64>,
    /// Area between loading and unloading while the floor adheres, J. Does not include the losses of adhesive tops.
    #[serde(rename = "floor_hysteresis_J")]
    pub hysteresis: Option<f64>,
    /// Validity of the model for the jump-in.
    #[serde(with = "WrittenValidity")]
    pub jump_validity: Validity,
    /// Validity at the largest indentation, which applies to the detachment of the floor and all later results.
    #[serde(with = "WrittenValidity")]
    pub unloading_validity: Validity,
    /// Model error of the force after jump-in, relative to that force; `None` out of range.
    pub force_error: Option<f64>,
    /// Relative model error of the area after jump-in; `None` out of range.
    pub area_error: Option<f64>,
}

/// Computes the critical state of a system, and the behaviour of an adhesive floor from there. The method applies to the critical state.
///
/// # Errors
/// Those of [`fakir::collapse::collapse`].
pub fn collapse(
    system: &System,
    method: Method,
    run: &Run<'_>,
) -> Result<(Collapsed, Termination), SolveError> {
    let found = fakir::collapse::collapse(system, method, run)?;
    let floor = AdhesiveFloor::of(system)?;
    let contact = &found.critical.contact;
    let work = system.adhesion().work;
    let shape = system.pillar();
    let radius = 0.5 * shape.diameter;
    let lens = system.lens().sphere_radius();
    let threshold = floor.collapse_threshold();
    let collapsed = Collapsed {
        method: "collapsed_floor".to_owned(),
        surface_fraction: system.pattern().surface_fraction(),
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
