//! Contact radius around the lens axis, and its error.
//!
//! If the farthest pillar is fully touched, its rim defines the radius. If the contact edge crosses it, the covered part is computed from
//! the gap (see [`covered`](crate::halfspace::disc::covered)) of a solution on more nodes, for the candidates that reach farthest. A pillar
//! that is about to be touched, or just is, makes the radius uncertain by the change that it would cause.

use super::newton::Newton;
use super::rules::unilateral::{LocalSolver, PillarTop};
use super::touched::TouchedPillar;
use crate::halfspace::disc::basis::{BasisEvaluator, degree_with};
use crate::halfspace::disc::covered::{CoverFinder, Region, edge_error};
use crate::halfspace::disc::nodes::Resolution;
use crate::numerics::vector::{dot, subtract};
use crate::problem::PunchForm;
use crate::state::PillarStatus;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Degree of the nodes on which the farthest pillars are solved again, if they were coarser.
const FINE_DEGREE: usize = 12;

/// Number of candidates that are solved again.
const CANDIDATES: usize = 3;

/// Error of a rim that lifts off between two nodes, in pillar radii.
const LIFT_OFF: f64 = 0.02;

/// Fraction of the largest stress intensity factor below which the sign may change between nodes.
const NEAR_LIFT_OFF: f64 = 0.05;

/// Factor on the difference from the radius of Hertz's contact under the same force, which the contact exceeds if it is cut by the rim.
const EDGE_SAFETY: f64 = 1.2;

/// Error of the gap over a pillar: this fraction of the indentation, plus the opening of the lens over this fraction of the pillar radius.
const GAP_ERROR: f64 = 1e-4;
const PLACE_ERROR: f64 = 0.03;

/// Distance from the lens axis of the farthest point in contact and its error, in pillar radii.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reach {
    pub(crate) radius: f64,
    pub(crate) error: f64,
}

/// The contact radius due to one pillar.
struct Candidate<'p> {
    pillar: &'p TouchedPillar,
    reach: f64,
    error: f64,
}

/// The contact radius. The pillars must be sorted by distance.
pub(super) fn contact_reach(
    newton: &Newton<'_>,
    indentation: f64,
    touched: &[TouchedPillar],
) -> Reach {
    let degree = degree_with(newton.tops.top.count());
    let mut finder = CoverFinder::new(degree);
    let mut candidates: Vec<Candidate<'_>> = Vec::new();
    let mut farthest = 0.0_f64;
    let radii = touched.iter().map(|pillar| pillar.disc.radius);
    let largest = radii.fold(0.0, f64::max);
    let coarse_error = largest * edge_error(degree);
    for pillar in touched.iter().rev() {
        let distance = distance_of(pillar);
        // Pillars are sorted by rounded distances.
        let radius = pillar.disc.radius;
        if distance + largest < farthest - coarse_error - 1e-3 {
            break;
        }
        let (reach, error) = match (&pillar.disc.rim_contact, &pillar.disc.gap) {
            (Some(edge), _) => (edge.reach, edge.error),
            (None, None) => (distance + radius, radius * full_error(pillar)),
            (None, Some(gap)) => {
                let axis = pillar.disc.centre.map(|x| -x / radius);
                let at_rim = finder.farthest_corner(gap, axis);
                let reach = at_rim.or_else(|| {
                    let region = finder.region(&pillar.disc.coefficients, gap)?;
                    Some(region.farthest_from(axis))
                });
                // If the contact is too small to be resolved, use the nearest point of the pillar.
                let nearest = (distance - radius).max(0.0);
                let reach = radius * reach.unwrap_or(0.0);
                (reach.max(nearest), radius * edge_error(degree))
            }
        };
        farthest = farthest.max(reach);
        candidates.push(Candidate {
            pillar,
            reach,
            error,
        });
    }
    candidates.retain(|candidate| candidate.reach >= farthest - 2.0 * coarse_error);
    candidates.sort_by(|a, b| b.reach.total_cmp(&a.reach));
    refine(newton, &mut candidates, &mut finder);
    if let ([only], [candidate]) = (touched, &mut candidates[..])
        && let Some(radius) = hertz_radius(newton, only)
    {
        candidate.error = (EDGE_SAFETY * (candidate.reach - radius).abs()).max(candidate.error);
    }
    let Some(best) = candidates
        .iter()
        .max_by(|a, b| (a.reach - a.error).total_cmp(&(b.reach - b.error)))
    else {
        return Reach {
            radius: 0.0,
            error: 0.0,
        };
    };
    let radius = best.reach;
    // Other candidates may reach farther.
    let error = candidates
        .iter()
        .map(|other| other.reach + other.error - radius)
        .fold(best.error, f64::max);
    Reach {
        radius,
        error: error.max(marginal(newton, indentation, touched, radius)),
    }
}

/// Radius of Hertz's contact under the force on the only touched top, if a part of it around the lens axis is touched. It is that of a contact that
/// hardly reaches the rim: the gap opens so slowly beside its edge that the covered part of a wide top is too large.
fn hertz_radius(newton: &Newton<'_>, only: &TouchedPillar) -> Option<f64> {
    let scene = &newton.scene;
    let is_around_axis = distance_of(only) < only.disc.radius;
    let is_hertzian =
        scene.lens.is_axisymmetric() && !scene.lens.is_flat() && scene.layers.is_empty();
    (only.disc.gap.is_some() && is_around_axis && is_hertzian)
        .then(|| (0.75 * scene.lens.apex_radius() * newton.force()).cbrt())
}

fn distance_of(pillar: &TouchedPillar) -> f64 {
    let [x, y] = pillar.disc.centre;
    x.hypot(y)
}

/// The rim of a fully touched pillar is exact unless it is about to lift off.
fn full_error(pillar: &TouchedPillar) -> f64 {
    match pillar.state.stress_intensity_factor {
        Some([least, most]) if least < NEAR_LIFT_OFF * most => LIFT_OFF,
        _ => 0.0,
    }
}

/// Recomputes the first partially touched candidates on more nodes, if they had few.
fn refine(newton: &Newton<'_>, candidates: &mut [Candidate<'_>], finder: &mut CoverFinder) {
    let mut partial = candidates
        .iter_mut()
        .filter(|candidate| {
            let disc = &candidate.pillar.disc;
            disc.gap.is_some() && disc.rim_contact.is_none()
        })
        .take(CANDIDATES)
        .peekable();
    if partial.peek().is_none() {
        return;
    }
    let mut finer =
        (degree_with(newton.tops.top.count()) < FINE_DEGREE).then(|| Finer::new(newton));
    for candidate in partial {
        let radius = candidate.pillar.disc.radius;
        let axis = candidate.pillar.disc.centre.map(|x| -x / radius);
        let region = match (&mut finer, &candidate.pillar.disc.gap) {
            (Some(finer), _) => finer.region(newton, candidate.pillar.place),
            (None, Some(gap)) => finder.region(&candidate.pillar.disc.coefficients, gap),
            (None, None) => None,
        };
        if let Some(region) = region {
            let reach = radius * region.farthest_from(axis);
            // If two solutions differ by more than usual, the exact solution may too.
            let change = (reach - candidate.reach).abs();
            let degree = degree_with(newton.tops.top.count()).max(FINE_DEGREE);
            candidate.error = radius * edge_error(degree) + change;
            candidate.reach = reach;
        }
    }
}

/// Solutions of single pillars on more nodes.
struct Finer {
    top: Arc<PillarTop>,
    solver: LocalSolver,
    finder: CoverFinder,
}

impl Finer {
    fn new(newton: &Newton<'_>) -> Self {
        let kappa = newton.tops.sites.common_body().column;
        let resolution = Resolution::of_nodes(FINE_DEGREE);
        let top = PillarTop::shared(resolution, newton.degree(), kappa);
        Self {
            solver: LocalSolver::new(&top),
            finder: CoverFinder::new(FINE_DEGREE),
            top,
        }
    }

    /// The covered region of a pillar; `None` if it is not found.
    fn region(&mut self, newton: &Newton<'_>, pillar: usize) -> Option<Region> {
        let load = newton.full_load(pillar);
        let body = newton.tops.sites.body(pillar);
        let top = self.top.on_column(body.column);
        let mut active = Vec::new();
        if !self.solver.solve(&top, &load, &mut active).converged {
            return None;
        }
        // For a disc of unit radius under this load; for another radius the pressure is scaled uniformly.
        let mut density = vec![0.0; top.count()];
        self.solver.coefficients(&top, &load, &mut density);
        let modes = density.iter().zip(top.compliance());
        let mut gap: Vec<f64> = modes.map(|(c, lambda)| c * lambda).collect();
        subtract(&mut gap, &load);
        self.finder.region(&density, &gap)
    }
}

/// Change of the radius if pillars that are about to be touched were touched, and those that just are were not.
fn marginal(newton: &Newton<'_>, indentation: f64, touched: &[TouchedPillar], radius: f64) -> f64 {
    let margin = GAP_ERROR * indentation;
    let rim = RimGap::new(newton);
    let may_touch = |pillar: usize| {
        let [gap, unknown] = rim.least(newton, pillar);
        gap < margin + unknown
    };
    let may_not_touch = |pillar: usize| {
        let [gap, unknown] = rim.least(newton, pillar);
        gap > -margin - unknown
    };
    let mut change = 0.0_f64;
    let outer = radius + 1.0 + 1.2 * newton.scene.field.spacing();
    for (pillar, centre) in newton.tops.sites.centres().iter().enumerate() {
        let nearest = centre[0].hypot(centre[1]) - newton.tops.sites.body(pillar).radius;
        if newton.tops.status[pillar] != PillarStatus::Untouched
            || nearest <= radius
            || nearest > outer
        {
            continue;
        }
        if nearest - radius > change && may_touch(pillar) {
            change = nearest - radius;
        }
    }
    // The farthest pillars that are just touched, and the first that is certainly touched.
    let mut just = false;
    for pillar in touched.iter().rev() {
        let distance = distance_of(pillar);
        let own = pillar.disc.radius;
        if distance + own <= radius - change {
            break;
        }
        let marginal = pillar.state.status == PillarStatus::Partial && may_not_touch(pillar.place);
        if marginal {
            just = true;
        } else if just {
            // The radius extends at least to its nearest point.
            let reach = (distance - own).max(0.0);
            return change.max(radius - reach);
        } else {
            break;
        }
    }
    change
}

/// The gap around the rim of a pillar without contact.
struct RimGap {
    /// Modes around the rim, angle by angle.
    values: Vec<f64>,
    count: usize,
}

impl RimGap {
    fn new(newton: &Newton<'_>) -> Self {
        const PLACES: usize = 48;
        let mut basis = BasisEvaluator::new(newton.tops.load_degree());
        let count = basis.modes().len();
        let mut values = vec![0.0; PLACES * count];
        for (k, row) in values.chunks_exact_mut(count).enumerate() {
            let (sin, cos) = (TAU * k as f64 / PLACES as f64).sin_cos();
            basis.evaluate_polar(0.0, 1.0, [cos, sin], row);
        }
        Self { values, count }
    }

    /// The smallest gap, and its uncertainty due to the position.
    fn least(&self, newton: &Newton<'_>, pillar: usize) -> [f64; 2] {
        let load = newton.full_load(pillar);
        let (least, most) = self
            .values
            .chunks_exact(self.count)
            .map(|row| -dot(&row[..load.len()], &load))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), gap| {
                (least.min(gap), most.max(gap))
            });
        [least, 0.5 * PLACE_ERROR * (most - least)]
    }
}

/// Model error of the punch lattices in the gap over a pillar, relative to the indentation, plain and corrected.
const PUNCH_GAP_ERROR: [f64; 2] = [0.1, 0.02];

/// Distance of the nearest pillar top from the lens axis.
fn nearest_edge(newton: &Newton<'_>) -> f64 {
    newton.tops.sites.clearance([0.0, 0.0]).max(0.0)
}

/// The contact radius of a punch lattice, in which pillars are touched completely or not at all.
pub(super) fn punch_reach(
    newton: &Newton<'_>,
    form: PunchForm,
    indentation: f64,
    touched: &[TouchedPillar],
) -> Reach {
    let Some(farthest) = touched.last() else {
        // The nearest pillar may be partially touched.
        return Reach {
            radius: 0.0,
            error: nearest_edge(newton) + 2.0,
        };
    };
    let radius = distance_of(farthest) + 1.0;
    let [plain, corrected] = PUNCH_GAP_ERROR;
    let margin = indentation
        * match form {
            PunchForm::Plain => plain,
            PunchForm::Corrected => corrected,
        };
    // Loads are evaluated at centres; the lens is lower over the nearest point of the rim.
    let sag = |distance: f64| newton.scene.lens.sag([distance, 0.0]);
    let outer = radius + 2.0 * newton.scene.field.spacing();
    let mut error = 2.0_f64;
    for (pillar, [x, y]) in newton.tops.sites.centres().iter().enumerate() {
        let distance = x.hypot(*y);
        let untouched = newton.tops.status[pillar] == PillarStatus::Untouched;
        if untouched && distance > radius - 1.0 && distance < outer {
            let mean = newton.mean_load(pillar);
            if mean + sag(distance) - sag((distance - 1.0).max(0.0)) > -margin {
                error = error.max(distance + 1.0 - radius);
            }
        }
    }
    // The first pillar that is certainly touched.
    for pillar in touched.iter().rev() {
        let distance = distance_of(pillar);
        error = error.max(radius - (distance - 1.0).max(0.0));
        if newton.mean_load(pillar.place) > margin {
            break;
        }
    }
    Reach { radius, error }
}
