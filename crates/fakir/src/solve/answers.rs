//! Results of the methods that resolve pillars, assembled from their solutions.

use super::assembled::{OfFloor, PillarMethod, assemble, floor_gap, refined};
use super::control::log_of_odds;
use super::elements::pillars;
use super::elements::pillars::ElementSolution;
use super::estimate::unknowns_only;
use super::floor::{Discs, FloorPoint, FloorSearch, LoadedDiscs, Surroundings, Uncovered};
use super::homogenised;
use super::mixed;
use super::newton::{Newton, Purpose};
use super::rules::patch::{Patch, PatchSolver};
use super::spectral::{Solution, degrees, rough_contact_radius, solve_punch, solve_spectral};
use super::touched::nearest_first;
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::coupling::window::Window;
use crate::halfspace::disc::basis::degree_with;
use crate::halfspace::disc::exterior::Exterior;
use crate::numerics::convergence::{larger, smaller};
use crate::numerics::workers::CancelToken;
use crate::problem::layer::WeightedLayer;
use crate::problem::pillar_field::{IndexedPillar, ListedPillar, PillarBody, PillarField};
use crate::problem::scaled::{RISING, Scene};
use crate::problem::{Accuracy, Area, FloorModel, LensProfile, Load, PunchForm, System};
use crate::state::contact::contact_warnings;
use crate::state::fields::Disc;
use crate::state::{
    ContactState, ErrorEstimate, Fields, PillarState, PillarStatus, Run, SolveError, Termination,
    Warning,
};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// Relative error stated for a contact inside one pillar top.
const PATCH_ERROR: f64 = 1e-8;

/// Relative error of the force or the indentation above which the contact is solved again with more nodes. It occurs if one partially
/// filled top carries the contact on few nodes.
const UNRESOLVED: f64 = 0.1;

/// An error that has not been estimated.
const UNKNOWN: ErrorEstimate = ErrorEstimate {
    force: f64::NAN,
    indentation: f64::NAN,
};

/// Relative model error of the punch lattices, plain and corrected: the largest differences from the spectral method at surface fractions
/// from 0.01 to 0.2. The lattices cannot be refined, so that this error cannot be estimated from their own solutions.
const PUNCH_ERROR: [f64; 2] = [0.1, 0.02];

/// Computes the contact at a prescribed load, which must have been validated.
pub(crate) fn press(
    system: &System,
    control: Load,
    method: PillarMethod,
    run: &Run<'_>,
) -> Result<ContactState, SolveError> {
    let scene = Scene::new(system);
    let target = scene.scaled(control);
    let first_touch = scene.first_touch();
    let floor_first = first_touch >= scene.height;
    if let (FloorModel::Contact, PillarMethod::Spectral(accuracy)) = (system.floor_model(), method)
        && floor_first
    {
        match target {
            Load::Indentation(indentation) if indentation <= scene.height => {}
            Load::FloorContact => {}
            Load::Force(force) if force <= 0.0 => {
                return Ok(without_contact(system, &scene, method, scene.height));
            }
            _ if scene.floor_carries_load() => {
                return mixed::floor_first(system, &scene, target, accuracy, run);
            }
            _ => {}
        }
    }
    match target {
        Load::Indentation(indentation) if indentation <= first_touch => {
            Ok(without_contact(system, &scene, method, indentation))
        }
        Load::Force(force) if force <= 0.0 => {
            // A lens that cannot reach any pillar descends to the floor.
            let level = if first_touch.is_finite() {
                first_touch
            } else {
                scene.height
            };
            Ok(without_contact(system, &scene, method, level))
        }
        Load::FloorContact if floor_first => {
            let contact = without_contact(system, &scene, method, scene.height);
            Ok(ContactState {
                smallest_floor_gap: 0.0,
                smallest_gap_position: [0.0, 0.0],
                ..contact
            })
        }
        _ => solve(system, &scene, target, method, run),
    }
}

/// Computes the contacts past a critical state in which the floor carries these fractions of the load.
pub(crate) fn press_to_floor_shares(
    critical: &ContactState,
    shares: &[f64],
    accuracy: Accuracy,
    run: &Run<'_>,
) -> Result<Vec<ContactState>, SolveError> {
    let system = &critical.system;
    let scene = Scene::new(system);
    let reached = critical.indentation / scene.length;
    let mut known = Vec::new();
    let mut states = Vec::with_capacity(shares.len());
    for share in shares.iter().copied() {
        let near = reached * (1.0 + start_of_share(share, &known));
        let near = Load::Indentation(near);
        let guess = homogenised_guess(system, &scene, near).map(radius_of);
        let tops = mixed::on_tops_alone(&scene, near, guess, run)?;
        let of_share = [share, reached];
        let (state, power) = mixed::at_floor_share(system, &scene, of_share, accuracy, tops, run)?;
        if state.converged() {
            let past = state.indentation / critical.indentation - 1.0;
            known.push(KnownShare { share, past, power });
        }
        states.push(state);
    }
    Ok(states)
}

/// A solved floor share.
struct KnownShare {
    share: f64,
    /// Indentation past the transition, relative to the critical indentation.
    past: f64,
    /// Exponent with which the ratio of floor force to top force grows with `past`.
    power: f64,
}

/// Exponent as the floor force tends to zero.
const FIRST_POWER: f64 = 1.5;

/// The exponent is extrapolated linearly in the logarithm of the odds, but to no less than this fraction of its last value.
const LEAST_POWER: f64 = 0.3;

/// Estimates at what indentation past the transition, relative to the critical indentation, the floor carries a fraction of the load, from the fractions
/// solved before.
fn start_of_share(share: f64, known: &[KnownShare]) -> f64 {
    let odds = log_of_odds(share);
    let Some(last) = known.last() else {
        // On the lattices of the paper the share is a third at about twice the critical indentation.
        return ((odds + std::f64::consts::LN_2) / FIRST_POWER).exp();
    };
    let way = odds - log_of_odds(last.share);
    let bend = match known {
        [.., before, _] => {
            let between = log_of_odds(last.share) - log_of_odds(before.share);
            (last.power - before.power) / between
        }
        _ => 0.0,
    };
    let power = |part: f64| (last.power + part * way * bend).max(LEAST_POWER * last.power);
    // Simpson's rule for the integral of 1/power.
    let inverse = (1.0 / power(0.0) + 4.0 / power(0.5) + 1.0 / power(1.0)) / 6.0;
    last.past * (way * inverse).exp()
}

/// Solves a contact that touches pillars.
fn solve(
    system: &System,
    scene: &Scene,
    target: Load,
    method: PillarMethod,
    run: &Run<'_>,
) -> Result<ContactState, SolveError> {
    let floor_counts = system.floor_model() == FloorModel::Contact && target != Load::FloorContact;
    let floor_carries = floor_counts && scene.floor_carries_load();
    let warned = |mut state: ContactState| {
        if target == Load::FloorContact {
            state.smallest_floor_gap = 0.0; // exact up to rounding
        }
        let depth = -state.smallest_floor_gap;
        if floor_counts && !floor_carries && depth > 0.0 {
            state.warnings.push(Warning::FloorBeside { depth });
        }
        state
    };
    if let PillarMethod::Spectral(_) = method
        && let Some((pillar, patch)) = find_patch(scene, target)
    {
        let state = patch_state(system, scene, method, pillar, &patch);
        if !(floor_carries && state.smallest_floor_gap < 0.0) {
            return Ok(warned(state));
        }
    }
    let homogenised = homogenised_guess(system, scene, target);
    let guess = homogenised.map(radius_of);
    let assembled = |solution: &Solution<'_>, lowest, error| {
        let floor = OfFloor::Lowest(lowest);
        assemble(system, scene, target, method, solution, floor, error).map(warned)
    };
    match method {
        PillarMethod::Spectral(accuracy) => {
            if floor_carries
                && accuracy == Accuracy::Accurate
                && let Some(tops) = mixed::far_past_transition(scene, target, guess, run)?
            {
                return mixed::past_transition(system, scene, target, accuracy, tops, run);
            }
            let degrees = degrees(accuracy, scene);
            let form = PunchForm::Corrected;
            let mut punch = solve_punch(scene, target, guess, form, Purpose::Start, run)?;
            // With a prescribed force, assembling a state costs as much as the solution.
            let listener = run.interim.filter(|_| !matches!(target, Load::Force(_)));
            if let Some(listener) = listener
                && punch.newton.touched() > MANY_TO_WAIT_FOR
            {
                let lattice = PillarMethod::Punch(form);
                let error = punch_error(form, target, &punch);
                let state = {
                    let lowest = lowest_point(target, &mut punch);
                    assemble(
                        system,
                        scene,
                        target,
                        lattice,
                        &punch,
                        OfFloor::Lowest(lowest),
                        error,
                    )?
                };
                listener(&state);
            }
            let mut solution = solve_spectral(scene, target, punch, degrees, run)?;
            let lowest = lowest_point(target, &mut solution);
            let mut reported = None;
            if let Some(listener) = listener {
                let state = assembled(&solution, lowest, UNKNOWN)?;
                listener(&state);
                reported = Some(state);
            }
            let gap = lowest.map_or(0.0, |point| {
                point.indentation - solution.outcome.indentation
            });
            if floor_carries && gap < 0.0 {
                let indentation = solution.outcome.indentation;
                let state = mixed::past_transition(system, scene, target, accuracy, solution, run)?;
                if state.floor.is_some() {
                    return Ok(state);
                }
                // The cells do not resolve so small a contact: the tops alone carry load, and penetrate the floor by this gap.
                return Ok(floor_gap(scene, state, indentation, lowest));
            }
            let error = refined(&mut solution, target, run)?;
            if accuracy == Accuracy::Default && larger(error.force, error.indentation) > UNRESOLVED
            {
                // A contact this small is resolved with more nodes.
                drop(solution);
                let finer = PillarMethod::Spectral(Accuracy::Accurate);
                let state = solve(system, scene, target, finer, run)?;
                return Ok(ContactState {
                    method: method.into(),
                    ..state
                });
            }
            match reported {
                Some(state) => Ok(ContactState { error, ..state }),
                None => {
                    // Releases the memory of the coupling: the states of many pillars need it.
                    solution.newton.release_coupling();
                    assembled(&solution, lowest, error)
                }
            }
        }
        PillarMethod::Punch(form) => {
            let purpose = Purpose::Answer;
            let mut solution = solve_punch(scene, target, guess, form, purpose, run)?;
            let error = punch_error(form, target, &solution);
            let lowest = lowest_point(target, &mut solution);
            assembled(&solution, lowest, error)
        }
        PillarMethod::Love(mesh) => {
            let answer = |solution: &ElementSolution<'_>, mesh| {
                let method = PillarMethod::Love(mesh);
                warned(elements(system, scene, target, method, solution))
            };
            let coarser = |solution: &ElementSolution<'_>, mesh| {
                if let Some(listener) = run.interim {
                    listener(&answer(solution, mesh));
                }
            };
            let solution = pillars::solve(scene, target, homogenised, mesh, run, &coarser)?;
            Ok(answer(&solution, mesh))
        }
    }
}

/// Model error of a punch lattice.
fn punch_error(form: PunchForm, target: Load, solution: &Solution<'_>) -> ErrorEstimate {
    let error = match form {
        PunchForm::Plain => PUNCH_ERROR[0],
        PunchForm::Corrected => PUNCH_ERROR[1],
    };
    let error = larger(error, crossed_share(&solution.newton));
    unknowns_only(target, solution.outcome.termination, [error; 2])
}

/// Force on a tilted top whose centre just touches the lens, relative to the force that presses a flat punch down by the difference of the
/// lens heights at its centre and its rim. The value for independent springs would be 2/(3 pi) = 0.21. On half-spaces 0.4 covers the
/// differences of the critical force from the spectral method at surface fractions from 0.0025 to 0.05, on the three substrates of the
/// paper and for three landing positions; this value is a quarter larger.
const CROSSED: f64 = 0.5;

/// Fraction of the total force that is carried by tops crossed by the contact edge and that a punch lattice omits. It matters if few
/// pillars are touched.
///
/// A tilted flat punch whose rim is higher than its centre by `t` on one side is in full contact from a depth of `2 t`: its pressure is
/// proportional to `depth + 2 t x/a` (K. L. Johnson, Contact Mechanics, 1985, sec. 3.8 and 5.5). The fraction is assumed to decrease
/// linearly up to that depth.
fn crossed_share(newton: &Newton<'_>) -> f64 {
    let sag = |distance: f64| {
        newton
            .scene
            .lens
            .sag_with_brim([larger(distance, 0.0), 0.0])
    };
    let (mut crossed, mut all) = (0.0, 0.0);
    for (pillar, [x, y]) in newton.tops.sites.centres().iter().enumerate() {
        let distance = x.hypot(*y);
        let tilt = 0.5 * (sag(distance + 1.0) - sag(distance - 1.0));
        let depth = newton.mean_load(pillar);
        crossed += CROSSED * larger(tilt - 0.5 * depth.abs(), 0.0);
        all += larger(depth, 0.0);
    }
    if all > 0.0 { crossed / all } else { 1.0 }
}

/// Number of touched pillars above which the homogenised lattice predicts the contact radius accurately.
const MANY_PILLARS: f64 = 40.0;

/// Number of touched pillars up to which no intermediate punch-lattice state is reported: the solution takes only a few tens of
/// milliseconds.
const MANY_TO_WAIT_FOR: usize = 1000;

/// The contact radius of a [guess](homogenised_guess).
pub(super) fn radius_of([radius, _]: [f64; 2]) -> f64 {
    radius
}

/// Contact radius and indentation of the homogenised lattice, if they are accurate.
pub(super) fn homogenised_guess(system: &System, scene: &Scene, target: Load) -> Option<[f64; 2]> {
    let lattice = scene.hexagonal_lattice()?;
    let rough = rough_contact_radius(scene, target);
    if Window::expected_len(lattice, rough) < MANY_PILLARS {
        return None;
    }
    let control = target.map(
        |indentation| indentation * scene.length,
        |force| force * scene.force(),
    );
    let guess = homogenised::rough_contact(system, control)?.map(|value| value / scene.length);
    Some(guess).filter(|[radius, _]| *radius > 0.0)
}

/// The lowest point of the floor, or the point that determined the indentation.
pub(super) fn lowest_point(target: Load, solution: &mut Solution<'_>) -> Option<FloorPoint> {
    match target {
        Load::FloorContact => solution.outcome.floor,
        Load::Force(_) | Load::Indentation(_) => solution.newton.lowest_gap(),
    }
}

/// A state without contact: the lens is above the pillar tops or just reaches them.
pub(super) fn without_contact(
    system: &System,
    scene: &Scene,
    method: PillarMethod,
    indentation: f64,
) -> ContactState {
    let exterior = Exterior::new(0);
    let discs = LoadedDiscs {
        exterior: &exterior,
        discs: Discs::new([0, 1], |_| [0.0; 2], |_| 1.0, [None, None]),
        run: &Run::default(),
    };
    let lowest = lowest_floor(scene, 0.0, &discs);
    let fields = Fields::new(scene.as_asked(), indentation, Vec::new(), 0, 0);
    ContactState {
        fields: Some(Arc::new(fields)),
        ..floor_gap(
            scene,
            ContactState::untouched(system, method.into(), indentation * scene.length),
            indentation,
            lowest,
        )
    }
}

/// The lowest point of the floor, if pillars within a distance of the lens axis are touched.
fn lowest_floor(scene: &Scene, reach: f64, discs: &LoadedDiscs<'_>) -> Option<FloorPoint> {
    let spacing = scene.field.spacing();
    let sites;
    let around = match &scene.field {
        PillarField::Hexagonal { lattice, .. } => Surroundings::Lattice(lattice),
        PillarField::Lattice(_) | PillarField::Listed(_) => {
            sites = Sites::within(&scene.field, reach + SEARCHED * spacing);
            Surroundings::of_sites(&sites, spacing, reach)
        }
    };
    if scene.lens.is_axisymmetric() && reach == 0.0 && around.clearance([0.0; 2]) > 0.0 {
        return Some(FloorPoint {
            position: [0.0; 2],
            indentation: scene.height,
        });
    }
    let uncovered = Uncovered {
        lens: scene.lens.clone(),
        height: scene.height,
        around,
    };
    FloorSearch::default().lowest(&uncovered, discs, &CancelToken::default())
}

/// Distance from the lens axis within which pillars are included in the floor search if at most one is touched, in units of the pillar
/// spacing.
const SEARCHED: f64 = 4.0;

/// The contact as a circle inside the pillar top under the lens axis, with that pillar; `None` if the contact is not such a circle.
pub(super) fn find_patch(scene: &Scene, target: Load) -> Option<(IndexedPillar, Patch)> {
    if !scene.lens.is_axisymmetric() {
        return None;
    }
    let pillar = scene.field.under([0.0, 0.0])?;
    let (index, ListedPillar { centre, body }) = pillar;
    // In units of the radius of the top, with heights measured from the top itself.
    let unit = body.radius;
    let [x, y] = centre;
    let from_centre = x.hypot(y) / unit;
    // A top that tilts moves the contact off the lens axis.
    if body.column.rocking > 0.0 && from_centre > 1e-9 {
        return None;
    }
    let largest = smaller(1.0 - from_centre, scene.lens.widest() / unit);
    if largest <= 0.0 {
        return None;
    }
    let solver = patch_solver(scene, &body);
    let sag = |r: f64| scene.lens.sag([r * unit, 0.0]) / unit;
    let height = (scene.height + body.raised) / unit;
    let own = match target {
        Load::Indentation(value) => {
            let value = (value + body.raised) / unit;
            solver.find(largest, sag, |patch| patch.indentation, value)
        }
        Load::Force(value) => solver.find(largest, sag, |patch| patch.force, value / (unit * unit)),
        Load::FloorContact => {
            // On half-spaces the pressure moves the floor away from the lens, which must therefore descend by at least the floor depth.
            if scene.layers.is_empty() && solver.with_radius(largest, sag).indentation < height {
                return None;
            }
            let reached = |patch: &Patch| {
                let floor = patch_floor(scene, &patch.scaled(unit));
                floor.map_or(f64::NEG_INFINITY, |point| {
                    patch.indentation - (point.indentation - scene.height) / unit
                })
            };
            solver.find(largest, sag, reached, height)
        }
    }?;
    let mut patch = own.scaled(unit);
    patch.indentation -= body.raised;
    // No other pillar may be touched: the nearest edge of the next pillar must stay below the lens. Layers rise around the contact.
    let rising = if scene.layers.is_empty() {
        1.0
    } else {
        RISING * RISING
    };
    let touched = scene.reaches_another(index, rising * patch.indentation);
    (!touched).then_some((pillar, patch))
}

/// Solver for a contact inside the top of a pillar.
fn patch_solver(scene: &Scene, body: &PillarBody) -> PatchSolver {
    let layers = WeightedLayer::in_unit(&scene.layers, body.radius);
    PatchSolver::new(body.column.shortening, &layers)
}

/// The lowest point of the floor under a patch: its gap plus the indentation.
fn patch_floor(scene: &Scene, patch: &Patch) -> Option<FloorPoint> {
    let exterior = patch.exterior(&scene.layers);
    let discs = LoadedDiscs {
        exterior: &exterior,
        discs: Discs::around_axis(patch.radius, &patch.coefficients[..exterior.count()]),
        run: &Run::default(),
    };
    lowest_floor(scene, patch.radius, &discs)
}

/// Relative errors of force and radius of a contact inside one pillar top.
fn patch_errors(scene: &Scene, patch: &Patch, body: &PillarBody) -> [f64; 2] {
    let unit = body.radius;
    let sag = |r: f64| scene.lens.sag([r * unit, 0.0]) / unit;
    let own = Patch {
        indentation: patch.indentation + body.raised,
        ..patch.clone()
    };
    let own = own.scaled(unit.recip());
    let of_layers = patch_solver(scene, body).errors(&own, sag);
    let of_table = table_errors(scene, own.radius * unit);
    [0, 1].map(|k| larger(of_layers[k] + of_table[k], PATCH_ERROR))
}

/// Relative errors due to the breaks in the third derivative of a height table: the difference between the contact of that radius and
/// Sneddon's solution at the same depth on half-spaces (I. N. Sneddon, Int. J. Eng. Sci. 3, 47 (1965)).
fn table_errors(scene: &Scene, radius: f64) -> [f64; 2] {
    const STEPS: usize = 60;
    let Some(profile) = scene.lens.profile() else {
        return [0.0; 2];
    };
    let sag = |r: f64| scene.lens.sag([r, 0.0]);
    let patch = PatchSolver::new(0.0, &[]).with_radius(radius, sag);
    let depth = patch.indentation;
    let mut radius = radius;
    let [mut reached, mut force] = sneddon(profile, radius);
    for _ in 0..STEPS {
        // The depth grows with an exponent of the radius between 1 and 3.
        radius *= (depth / reached).sqrt();
        [reached, force] = sneddon(profile, radius);
    }
    let off = (reached / depth - 1.0).abs();
    let error = |own: f64, exact: f64| (own / exact - 1.0).abs() + off;
    [error(patch.force, force), error(patch.radius, radius)]
}

/// Depth and force of an axisymmetric contact of radius `a` on a half-space: `a ∫ f'(r)/sqrt(a^2 - r^2) dr` and
/// `2 ∫ r^2 f'(r)/sqrt(a^2 - r^2) dr`.
fn sneddon(profile: &LensProfile, a: f64) -> [f64; 2] {
    const POINTS: usize = 2000;
    let step = FRAC_PI_2 / POINTS as f64;
    let [mut depth, mut force] = [0.0; 2];
    for k in 0..POINTS {
        let sin = (step * (k as f64 + 0.5)).sin();
        let [_, slope, _] = profile.at(a * sin);
        depth += slope;
        force += sin * sin * slope;
    }
    [step * a * depth, 2.0 * step * a * a * force]
}

fn patch_state(
    system: &System,
    scene: &Scene,
    method: PillarMethod,
    (index, pillar): IndexedPillar,
    patch: &Patch,
) -> ContactState {
    let degree = degree_with(patch.coefficients.len());
    let lowest = patch_floor(scene, patch);
    let disc = Disc {
        index,
        centre: [0.0, 0.0],
        radius: patch.radius,
        coefficients: patch.coefficients.clone(),
        gap: None,
        bonded: None,
        rim_contact: None,
    };
    let fields = Fields::new(scene.clone(), patch.indentation, vec![disc], degree, degree);
    let centre = scene.metres(pillar.centre);
    let force = patch.force * scene.force();
    let body = pillar.body;
    let pillar = PillarState {
        index,
        centre,
        diameter: 2.0 * body.radius * scene.length,
        height: (scene.height + body.raised) * scene.length,
        status: PillarStatus::Partial,
        force,
        centre_pressure: fields.pressure(centre),
        stress_intensity_factor: Some([0.0; 2]),
    };
    let indentation = patch.indentation * scene.length;
    let [error, radius_error] = patch_errors(scene, patch, &body);
    floor_gap(
        scene,
        ContactState {
            force,
            contact_radius: patch.radius * scene.length,
            contact_radius_error: radius_error * patch.radius * scene.length,
            pillars_in_contact: 1,
            pillars_partially_in_contact: 1,
            pillars: vec![pillar],
            fields: Some(Arc::new(fields)),
            error: ErrorEstimate {
                force: error,
                indentation: error,
            },
            ..ContactState::untouched(system, method.into(), indentation)
        },
        patch.indentation,
        lowest,
    )
}

/// Assembles the result of a boundary-element solution.
fn elements(
    system: &System,
    scene: &Scene,
    target: Load,
    method: PillarMethod,
    solution: &ElementSolution<'_>,
) -> ContactState {
    let contact = &solution.contact;
    let touched = solution.touched_pillars();
    let contact_radius = touched.iter().map(|p| p.reach).fold(0.0, f64::max);
    let radius_error = if contact.termination == Termination::Converged {
        solution.reach_error(contact_radius, &touched)
    } else {
        contact_radius
    };
    let mut pillars: Vec<PillarState> = touched
        .iter()
        .map(|pillar| PillarState {
            diameter: 2.0 * pillar.pillar.body.radius * scene.length,
            height: system.pillar().height + pillar.pillar.body.raised * scene.length,
            index: pillar.index,
            centre: scene.metres(pillar.pillar.centre),
            status: pillar.status,
            force: pillar.force * scene.force(),
            centre_pressure: pillar.centre_pressure * scene.pressure,
            stress_intensity_factor: None,
        })
        .collect();
    nearest_first(&mut pillars, |pillar| pillar, scene.length);
    let partial = pillars
        .iter()
        .filter(|pillar| pillar.status == PillarStatus::Partial)
        .count();
    let indentation = contact.indentation;
    let cells_per_diameter = match method {
        PillarMethod::Love(mesh) => mesh.cells_per_diameter as f64,
        PillarMethod::Spectral(_) | PillarMethod::Punch(_) => 1.0,
    };
    let [area, area_error] = touched.iter().fold([0.0; 2], |[area, error], pillar| {
        let square = pillar.pillar.body.radius.powi(2);
        // On a top that the edge crosses, half a cell along at most a diameter.
        let cells = f64::from(pillar.status == PillarStatus::Partial) / cells_per_diameter;
        [
            area + PI * pillar.covered * square,
            error + 2.0 * cells * square,
        ]
    });
    let unit = scene.length * scene.length;
    let state = ContactState {
        top_area: Some(Area {
            value: area * unit,
            error: Some(area_error * unit),
        }),
        force: contact.force * scene.force(),
        contact_radius: contact_radius * scene.length,
        contact_radius_error: radius_error * scene.length,
        pillars_in_contact: pillars.len(),
        pillars_partially_in_contact: partial,
        pillars,
        error: unknowns_only(target, contact.termination, solution.errors()),
        termination: contact.termination,
        iterations: solution.products,
        warnings: contact_warnings(contact_radius / scene.lens.sphere_radius()),
        ..ContactState::untouched(system, method.into(), indentation * scene.length)
    };
    floor_gap(scene, state, indentation, solution.floor)
}
