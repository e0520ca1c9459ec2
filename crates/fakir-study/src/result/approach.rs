//! Loading step by step.

use super::{LoadingRow, SurfaceLoadingRow, surface_transition, transition};
use crate::VERSION;
use crate::approach::Approach;
use crate::record::{METHOD, Object, SurfaceAnswer, boundary_name, grid_object, indenter_name};
use fakir::problem::{Method, SurfaceSystem, System};
use serde::Serialize;

/// A loading: what `fakir approach --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ApproachSummary {
    method: &'static str,
    /// None where it is not known what the floor is, which a texture never lacks.
    critical: Option<Object>,
    states: Vec<LoadingRow>,
    converged: bool,
    wall_time_s: f64,
    fakir_version: &'static str,
}

impl ApproachSummary {
    /// A loading of a texture by a method.
    #[must_use]
    pub fn new(method: Method, found: &Approach<(System, Method)>) -> Self {
        let critical = found.critical.as_ref();
        Self {
            method: method.name(),
            critical: critical
                .map(|critical| transition(critical, None, None, found.critical_time)),
            states: found.rows.clone(),
            converged: found.converged,
            wall_time_s: found.wall_time,
            fakir_version: VERSION,
        }
    }
}

/// A loading of a general surface: what `fakir approach --json` prints for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SurfaceApproachSummary {
    method: &'static str,
    indenter: &'static str,
    boundary: &'static str,
    #[serde(flatten)]
    grid: Object,
    /// None where it is not known what the floor is.
    critical: Option<Object>,
    states: Vec<SurfaceLoadingRow>,
    converged: bool,
    wall_time_s: f64,
    fakir_version: &'static str,
}

impl SurfaceApproachSummary {
    /// A loading of a surface.
    #[must_use]
    pub fn new(system: &SurfaceSystem, found: &Approach<SurfaceSystem>) -> Self {
        let critical = found.critical.as_ref();
        Self {
            method: METHOD,
            indenter: indenter_name(system.indenter()),
            boundary: boundary_name(system.boundary()),
            grid: grid_object(system.surface().grid()),
            critical: critical.map(|critical| {
                let answer = SurfaceAnswer {
                    system,
                    answer: critical,
                };
                surface_transition(&answer, found.critical_time)
            }),
            states: found.rows.clone(),
            converged: found.converged,
            wall_time_s: found.wall_time,
            fakir_version: VERSION,
        }
    }
}
