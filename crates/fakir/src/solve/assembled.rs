//! Assembles results from a solution: the state of all pillars, and of the floor if it is in contact.

use super::estimate::{estimate, unknowns_only};
use super::floor::FloorPoint;
use super::newton::MISMATCH_TOLERANCE;
use super::reach::{Reach, contact_reach, punch_reach};
use super::spectral::{Solution, exceeds_lens};
use super::touched::{TouchedPillar, touched_pillars};
use crate::halfspace::disc::basis::degree_with;
use crate::problem::scaled::Scene;
use crate::problem::{
    Accuracy, ElementMesh, Load, Method, PillarCompliance, Point, PunchForm, System,
};
use crate::state::contact::contact_warnings;
use crate::state::{
    ContactState, ErrorEstimate, Fields, FloorContact, PillarState, PillarStatus, Progress, Run,
    SolveError, Stage, Termination,
};
use std::sync::Arc;

/// Method that solves the pillars.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PillarMethod {
    Spectral(Accuracy),
    Punch(PunchForm),
    Love(ElementMesh),
}

impl From<PillarMethod> for Method {
    fn from(method: PillarMethod) -> Self {
        match method {
            PillarMethod::Spectral(accuracy) => Self::Spectral(accuracy),
            PillarMethod::Punch(form) => Self::Punch(form),
            PillarMethod::Love(mesh) => Self::Love(mesh),
        }
    }
}

/// Error estimate of the spectral method, from a different node array and a higher degree.
pub(super) fn refined(
    solution: &mut Solution<'_>,
    target: Load,
    run: &Run<'_>,
) -> Result<ErrorEstimate, SolveError> {
    let termination = solution.outcome.termination;
    if termination != Termination::Converged {
        return Ok(unknowns_only(target, termination, [1.0; 2]));
    }
    run.report(Progress {
        stage: Stage::ErrorEstimate,
        step: solution.steps,
        pillars: solution.newton.tops.sites.len(),
        touched: solution.newton.touched(),
    });
    estimate(&mut solution.newton, &solution.outcome, target)
}

/// Returns the state with its smallest floor gap.
pub(super) fn floor_gap(
    scene: &Scene,
    state: ContactState,
    indentation: f64,
    lowest: Option<FloorPoint>,
) -> ContactState {
    match lowest {
        None if !scene.lens.is_axisymmetric() => {
            let (place, sag) = lowest_over_pillars(scene);
            ContactState {
                smallest_floor_gap: (scene.height + sag - indentation) * scene.length,
                smallest_gap_position: scene.metres(place),
                ..state
            }
        }
        None => state,
        Some(point) => ContactState {
            smallest_floor_gap: (point.indentation - indentation) * scene.length,
            smallest_gap_position: scene.metres(point.position),
            ..state
        },
    }
}

/// Position and undeformed height of the lowest point of a lens that is not axisymmetric over the centre of a pillar. The gap to the floor
/// tends to this height far along the axis of a cylinder, and beyond the outermost pillars under a plate.
fn lowest_over_pillars(scene: &Scene) -> (Point, f64) {
    let (pillars, _) = scene
        .field
        .listed_within(scene.field.extent().unwrap_or(0.0));
    let is_flat = scene.lens.is_flat();
    let sag = |centre: Point| if is_flat { scene.lens.sag(centre) } else { 0.0 };
    let places = pillars.iter().map(|(_, pillar)| pillar.centre);
    let lowest = places.min_by(|one, other| {
        let [a, b] = [one, other].map(|at| (sag(*at), scene.lens.distance(*at)));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let place = lowest.unwrap_or([0.0; 2]);
    (place, sag(place))
}

/// State of the floor.
pub(super) enum OfFloor {
    /// Not in contact: its lowest point.
    Lowest(Option<FloorPoint>),
    /// In contact; `None` if no part of it is.
    Contact(Option<FloorContact>),
}

/// Assembles the result of a solution of all pillars, and of the floor if it is in contact.
pub(super) fn assemble(
    system: &System,
    scene: &Scene,
    target: Load,
    method: PillarMethod,
    solution: &Solution<'_>,
    floor: OfFloor,
    error: ErrorEstimate,
) -> Result<ContactState, SolveError> {
    let (lowest, floor) = match floor {
        OfFloor::Lowest(lowest) => (lowest, None),
        OfFloor::Contact(floor) => (None, floor),
    };
    let Solution {
        newton,
        outcome,
        steps,
    } = solution;
    let indentation = outcome.indentation;
    newton.run.check_cancelled()?;
    let mut touched = touched_pillars(newton);
    let on_floor = floor.as_ref().map_or(0.0, |floor| floor.force);
    let force = share_force(&mut touched, on_floor, target, scene);
    // Relative to the reported force, so that both agree to the last digit.
    let floor = floor.map(|floor| FloorContact {
        share: floor.force / force,
        ..floor
    });
    let Reach {
        radius: contact_radius,
        error: radius_error,
    } = match method {
        PillarMethod::Punch(form) => punch_reach(newton, form, indentation, &touched),
        _ => contact_reach(newton, indentation, &touched),
    };
    let radius_error = if outcome.termination == Termination::Converged {
        radius_error
    } else {
        contact_radius
    };
    let floor_radius = floor.as_ref().map_or(0.0, |floor| floor.radius) / scene.length;
    let farthest = from_lowest(scene, contact_radius.max(floor_radius), &touched);
    if farthest > scene.lens.largest_contact() {
        return Err(exceeds_lens(scene, farthest));
    }
    let partial = touched
        .iter()
        .filter(|pillar| pillar.state.status == PillarStatus::Partial)
        .count();
    let close_degree = touched
        .iter()
        .map(|pillar| degree_with(pillar.disc.coefficients.len()))
        .max()
        .unwrap_or(0);
    let (pillars, discs): (Vec<_>, Vec<_>) = touched
        .into_iter()
        .map(|p| (as_known(p.state, system), p.disc.turned(scene.rotation)))
        .unzip();
    let fields = Fields::new(
        scene.as_asked(),
        indentation,
        discs,
        newton.degree(),
        close_degree,
    );
    let fields = match newton.floor_load() {
        Some(load) if floor.is_some() => fields.with_floor(load.turned(scene.rotation)),
        _ => fields,
    };
    let state = ContactState {
        floor,
        force,
        contact_radius: contact_radius * scene.length,
        contact_radius_error: radius_error * scene.length,
        pillars_in_contact: pillars.len(),
        pillars_partially_in_contact: partial,
        pillars,
        fields: Some(Arc::new(fields)),
        error,
        termination: outcome.termination,
        iterations: *steps,
        warnings: contact_warnings(scene.lens.slope_at(farthest)),
        ..ContactState::untouched(system, method.into(), indentation * scene.length)
    };
    Ok(floor_gap(scene, state, indentation, lowest))
}

/// Removes the stress intensity factors of elastic pillars, which the model does not provide: the stress at the corner of an elastic pillar
/// differs from that at the edge of a punch on a half-space.
fn as_known(pillar: PillarState, system: &System) -> PillarState {
    match system.pillar().compliance {
        PillarCompliance::Elastic => PillarState {
            stress_intensity_factor: None,
            ..pillar
        },
        PillarCompliance::Column | PillarCompliance::None => pillar,
    }
}

/// Distance from the lowest point of the lens to the edge of the contact. A height table must cover all touched tops.
fn from_lowest(scene: &Scene, contact_radius: f64, touched: &[TouchedPillar]) -> f64 {
    if scene.lens.is_axisymmetric() && scene.lens.profile().is_none() {
        return contact_radius;
    }
    let end = |pillar: &TouchedPillar| scene.lens.distance(pillar.disc.centre) + pillar.disc.radius;
    touched.iter().map(end).fold(0.0, f64::max)
}

/// Relative difference between the prescribed force and the sum over pillars that is attributed to rounding in the solver: several times
/// its residual on one pillar.
const PILLARS_MISMATCH: f64 = 100.0 * MISMATCH_TOLERANCE;

/// Returns the total force on pillars and floor. The solver meets a prescribed force within its tolerance; the remainder is distributed
/// over the pillars, so that their sum is exact to the last digit.
fn share_force(touched: &mut [TouchedPillar], on_floor: f64, target: Load, scene: &Scene) -> f64 {
    let on_tops: f64 = touched.iter().map(|pillar| pillar.state.force).sum();
    let sum = on_tops + on_floor;
    let Load::Force(force) = target else {
        return sum;
    };
    let prescribed = force * scene.force();
    let close = (prescribed - sum).abs() <= PILLARS_MISMATCH * prescribed;
    if !close {
        return sum;
    }
    for pillar in touched {
        pillar.state.force *= (prescribed - on_floor) / on_tops;
    }
    prescribed
}
