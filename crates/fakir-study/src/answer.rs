//! The answer to one case, as it is kept: numbers only, each of which JSON gives back bit for bit.

use crate::collapsed::Collapsed;
use crate::cycled::Cycled;
use crate::result::of_floor;
use crate::surface_answer::{SurfaceCritical, SurfacePressed};
use fakir::state::{ContactState, CriticalState, FloorContact, Normalized, Regime};
use fakir_case::study::Coordinate;
use serde::{Deserialize, Serialize};

/// One case of a sweep, with its answer or the reason why there is none.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Number of the case in its study, from 0.
    pub index: usize,
    /// The value of every axis.
    pub coordinates: Vec<Coordinate>,
    /// The answer, also if it did not converge.
    pub answer: Option<Answer>,
    /// Why there is no answer, or none to be relied on.
    pub problem: Option<String>,
    /// How long it took, s. All other numbers are the same each time the case is solved.
    pub wall_time: f64,
}

/// What a case answers: the numbers of `fakir transition --json`, `fakir press --json` or `fakir approach --retract --json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// The critical state.
    Transition(Critical),
    /// The contact under a load.
    Press(Pressed),
    /// Loading and unloading with adhesion.
    Cycle(Cycled),
    /// How a floor that sticks collapses and lets go.
    Collapse(Collapsed),
    /// The critical state of a general surface.
    SurfaceTransition(SurfaceCritical),
    /// The contact with a general surface under a load.
    SurfacePress(SurfacePressed),
}

/// A critical state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Critical {
    /// Name of the method.
    pub method: String,
    /// What the lens meets first.
    #[serde(with = "RegimeName")]
    pub regime: Regime,
    /// Fraction of the surface that is pillar top.
    #[serde(with = "exact")]
    pub surface_fraction: f64,
    /// Distance of neighbouring pillars, m.
    #[serde(rename = "pitch_m", with = "exact")]
    pub pitch: f64,
    /// Critical force, N.
    #[serde(rename = "critical_force_N", with = "exact")]
    pub force: f64,
    /// Critical indentation, m.
    #[serde(rename = "critical_indentation_m", with = "exact")]
    pub indentation: f64,
    /// Critical contact radius, m: the larger of the next one and the distance of the floor contact.
    #[serde(rename = "critical_contact_radius_m", with = "exact")]
    pub contact_radius: f64,
    /// Radius of the contact on the pillar tops, m.
    #[serde(rename = "top_contact_radius_m", with = "exact")]
    pub top_contact_radius: f64,
    /// Where the floor is touched, m from the lens axis.
    #[serde(rename = "bottom_contact_m")]
    pub floor_contact: [f64; 2],
    /// Number of pillars touched.
    pub pillars_in_contact: usize,
    /// Number of pillars crossed by the edge of the contact.
    pub pillars_partially_in_contact: usize,
    /// `F gamma_int/(h d)`.
    #[serde(with = "exact")]
    pub normalized_force: f64,
    /// `a/e`.
    #[serde(with = "exact")]
    pub normalized_contact_radius: f64,
    /// `zeta/h`.
    #[serde(with = "exact")]
    pub normalized_indentation: f64,
    /// Estimated relative error of the force.
    #[serde(with = "exact")]
    pub relative_error_estimate_force: f64,
    /// Estimated relative error of the indentation.
    #[serde(with = "exact")]
    pub relative_error_estimate_indentation: f64,
    /// Estimated relative error of the contact radius.
    #[serde(with = "exact")]
    pub relative_error_estimate_contact_radius: f64,
    /// Whether the numbers are the solution.
    pub converged: bool,
    /// Steps of the solver.
    pub iterations: usize,
}

/// A contact under a load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pressed {
    /// Name of the method.
    pub method: String,
    /// Normal force, N.
    #[serde(rename = "force_N", with = "exact")]
    pub force: f64,
    /// Indentation, m.
    #[serde(rename = "indentation_m", with = "exact")]
    pub indentation: f64,
    /// Contact radius, m.
    #[serde(rename = "contact_radius_m", with = "exact")]
    pub contact_radius: f64,
    /// Number of pillars touched.
    pub pillars_in_contact: usize,
    /// Number of pillars crossed by the edge of the contact.
    pub pillars_partially_in_contact: usize,
    /// Smallest gap between lens and floor, m; past the transition negative if the floor was to be ignored.
    #[serde(rename = "smallest_floor_gap_m", with = "exact")]
    pub smallest_floor_gap: f64,
    /// Whether the floor is touched, or would be if it was not to be ignored.
    pub beyond_transition: bool,
    /// What the floor bears; none past the transition if it was to be ignored, and in journals of before it could bear anything.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floor: Option<OnFloor>,
    /// Estimated relative error of the force.
    #[serde(with = "exact")]
    pub relative_error_estimate_force: f64,
    /// Estimated relative error of the indentation.
    #[serde(with = "exact")]
    pub relative_error_estimate_indentation: f64,
    /// Estimated relative error of the contact radius.
    #[serde(with = "exact")]
    pub relative_error_estimate_contact_radius: f64,
    /// Whether the numbers are the solution.
    pub converged: bool,
    /// Steps of the solver.
    pub iterations: usize,
}

/// What the floor bears: nothing before the transition.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OnFloor {
    /// Force, N.
    #[serde(rename = "force_N", with = "exact")]
    pub force: f64,
    /// That over the whole force.
    #[serde(with = "exact")]
    pub share: f64,
    /// Contact area, m^2.
    #[serde(rename = "contact_area_m2", with = "exact")]
    pub area: f64,
    /// Estimated relative error of the share.
    #[serde(with = "exact")]
    pub relative_error_estimate_share: f64,
    /// Estimated relative error of the area.
    #[serde(with = "exact")]
    pub relative_error_estimate_area: f64,
}

impl OnFloor {
    fn of(state: &ContactState) -> Option<Self> {
        let number = |of: fn(&FloorContact) -> f64| of_floor(state, of);
        Some(Self {
            force: number(|floor| floor.force)?,
            share: number(|floor| floor.share)?,
            area: number(|floor| floor.area)?,
            relative_error_estimate_share: number(|floor| floor.error.share)?,
            relative_error_estimate_area: number(|floor| floor.error.area)?,
        })
    }
}

impl From<&CriticalState> for Critical {
    fn from(critical: &CriticalState) -> Self {
        let state = &critical.contact;
        let Normalized {
            force,
            contact_radius,
            indentation,
        } = critical.normalized();
        Self {
            method: state.method.name().to_owned(),
            regime: critical.regime,
            surface_fraction: state.system.texture().surface_fraction(),
            pitch: state.system.pitch(),
            force: state.force,
            indentation: state.indentation,
            contact_radius: critical.contact_radius(),
            top_contact_radius: state.contact_radius,
            floor_contact: critical.floor_contact,
            pillars_in_contact: state.pillars_in_contact,
            pillars_partially_in_contact: state.pillars_partially_in_contact,
            normalized_force: force,
            normalized_contact_radius: contact_radius,
            normalized_indentation: indentation,
            relative_error_estimate_force: state.error.force,
            relative_error_estimate_indentation: state.error.indentation,
            relative_error_estimate_contact_radius: critical.relative_contact_radius_error(),
            converged: state.converged(),
            iterations: state.iterations,
        }
    }
}

impl From<&ContactState> for Pressed {
    fn from(state: &ContactState) -> Self {
        Self {
            method: state.method.name().to_owned(),
            force: state.force,
            indentation: state.indentation,
            contact_radius: state.whole_contact_radius(),
            pillars_in_contact: state.pillars_in_contact,
            pillars_partially_in_contact: state.pillars_partially_in_contact,
            smallest_floor_gap: state.smallest_floor_gap,
            beyond_transition: state.beyond_transition(),
            floor: OnFloor::of(state),
            relative_error_estimate_force: state.error.force,
            relative_error_estimate_indentation: state.error.indentation,
            relative_error_estimate_contact_radius: state.relative_whole_contact_radius_error(),
            converged: state.converged(),
            iterations: state.iterations,
        }
    }
}

/// [`Regime`] in JSON.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Regime", rename_all = "snake_case")]
pub(crate) enum RegimeName {
    TopFirst,
    BottomFirst,
}

/// Numbers in JSON, which has no infinity and no NaN: those are texts.
pub(crate) mod exact {
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Number {
        Finite(f64),
        Text(String),
    }

    // serde hands over references.
    #[allow(clippy::trivially_copy_pass_by_ref)]
    pub(crate) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        if value.is_finite() {
            value.serialize(serializer)
        } else {
            value.to_string().serialize(serializer)
        }
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        match Number::deserialize(deserializer)? {
            Number::Finite(value) => Ok(value),
            Number::Text(text) => text.parse().map_err(de::Error::custom),
        }
    }
}
