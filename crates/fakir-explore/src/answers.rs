//! Responses: contacts with their pillars and section, curves over the surface fraction, and the
//! phase diagram. All values are in SI units, with the unit in the name.

use crate::clock::Moment;
use crate::floor::FloorCells;
use crate::lines;
use crate::refusal::Refusal;
use crate::request::{self, FARTHEST, LoadPoint, at_fraction, expected_pillars, without_adhesion};
use crate::worker::{Failure, Worker};
use fakir::problem::{
    Accuracy, Arrangement, Disorder, FloorModel, Load, Method, PlaneLattice, Point, System,
};
use fakir::state::{ContactState, CriticalState, Normalized, PillarStatus, Run};
use fakir::theory::closed_forms;
use fakir::theory::closed_forms::{Form, TransitionEstimate};
use fakir_case::Case;
use fakir_figure::{FigureError, SectionDetail};
use fakir_study::record::{Object, of_floor};
use fakir_study::result::{press, transition, warnings};
use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering};

/// Number of pillars beyond which an estimate is shown until the contact is solved.
const PREVIEW_PILLARS: f64 = 800.0;

/// Largest number of pillars in a background computation.
const CURVE_PILLARS: f64 = 4000.0;

/// Largest number of pillars in a background computation with floor contact.
const FLOOR_PILLARS: f64 = 1500.0;

/// Number of points of the exact curves, a power of two plus one.
const CURVE_POINTS: usize = 33;

/// Surface fractions of the curves, as in the paper.
const FRACTIONS: [f64; 2] = [3e-4, 0.25];

/// Loads at which the loading is computed, coarse first, as fractions of the path to the critical state and beyond.
/// With floor contact, the largest loads take longest.
const PATH_FRACTIONS: [f64; 21] = [
    0.5, 0.1, 1.25, 0.02, 0.25, 0.75, 1.5, 0.05, 0.9, 1.1, 0.35, 0.6, 2.0, 0.15, 0.8, 0.005, 0.001,
    FARTHEST, 1.75, 1.04, 2.25,
];

/// A critical state, a contact under another load, or both.
pub(crate) struct Solved {
    /// Critical state, and its computing time, s.
    pub(crate) critical: Option<(CriticalState, f64)>,
    /// A state other than the critical one, and its computing time, s.
    pub(crate) pressed: Option<(ContactState, f64)>,
}

impl Solved {
    /// Displayed state, and its computing time, s.
    pub(crate) fn state(&self) -> Option<(&ContactState, f64)> {
        let critical = self.critical.as_ref().map(|(c, time)| (&c.contact, *time));
        let pressed = self.pressed.as_ref().map(|(state, time)| (state, *time));
        pressed.or(critical)
    }

    /// First floor contact, if the displayed state is the critical state.
    pub(crate) fn floor_contact(&self) -> Option<Point> {
        match (&self.critical, &self.pressed) {
            (Some((critical, _)), None) => Some(critical.floor_contact),
            _ => None,
        }
    }
}

/// Receives an intermediate state, and its computing time, s.
type Interim<'a> = dyn Fn(&ContactState, f64) + Sync + 'a;

/// Solves a state before, at or past the critical state. `interim` receives intermediate states for
/// display, and `found` the critical state; both with the computing time so far, s.
pub(crate) fn solve(
    case: &Case,
    load: LoadPoint,
    worker: &Worker,
    interim: Option<&Interim<'_>>,
    found: impl FnOnce(&CriticalState, f64),
) -> Result<Solved, Failure> {
    let known = load.critical_indentation_m;
    let is_critical = load.is_critical();
    let start = Moment::now();
    let listener = interim
        .map(|interim| move |state: &ContactState| interim(state, start.elapsed().as_secs_f64()));
    let listener = listener
        .as_ref()
        .map(|it| it as &(dyn Fn(&ContactState) + Sync));
    let with = |is_shown: bool| Run {
        interim: listener.filter(|_| is_shown),
        ..worker.run()
    };
    let critical = if is_critical || known.is_none() {
        let critical = fakir::transition(&case.system, case.method, &with(is_critical))?;
        let wall_time = start.elapsed().as_secs_f64();
        found(&critical, wall_time);
        Some((critical, wall_time))
    } else {
        None
    };
    let target = match &critical {
        Some((critical, _)) => critical.contact.indentation,
        None => known.unwrap_or_default(),
    };
    let pressed = if is_critical {
        None
    } else {
        let control = Load::Indentation(indentation(case, target, load.fraction));
        let state = fakir::press(&case.system, control, case.method, &with(true))?;
        Some((state, start.elapsed().as_secs_f64()))
    };
    Ok(Solved { critical, pressed })
}

/// Whether the floor is in contact under a load.
fn meets_floor(case: &Case, load: LoadPoint) -> bool {
    floor_carries_load(case) && load.fraction > 1.0
}

/// Whether the floor carries load past the transition and its force is computed.
pub(crate) fn floor_carries_load(case: &Case) -> bool {
    let applies = case.system.floor_model() == FloorModel::Contact;
    matches!(case.method, Method::Spectral(_)) && applies
}

/// Indentation, m, at a fraction of the path from first contact to the critical state.
pub(crate) fn indentation(case: &Case, critical: f64, fraction: f64) -> f64 {
    let touch = first_touch(case);
    let touch = if touch < critical { touch } else { 0.0 };
    touch + fraction * (critical - touch)
}

/// Fraction of the path from first contact to the critical state at an indentation, m; 0 before contact.
pub(crate) fn position(case: &Case, critical: f64, indentation: f64) -> f64 {
    let touch = first_touch(case);
    let touch = if touch < critical { touch } else { 0.0 };
    ((indentation - touch) / (critical - touch)).max(0.0)
}

/// Indentation, m, at which the nearest pillar comes into contact.
fn first_touch(case: &Case) -> f64 {
    let system = &case.system;
    if case.method == Method::Homogenised {
        return 0.0;
    }
    system.first_touch()
}

#[derive(Serialize)]
pub(crate) struct CriticalLine {
    pub(crate) critical: Object,
}

#[derive(Serialize)]
pub(crate) struct StateLine {
    state: State,
}

impl StateLine {
    /// Critical state of a cycle, with its computing time in seconds.
    pub(crate) fn of_critical(state: &ContactState, wall_time: f64) -> Self {
        Self {
            state: drawn(state, wall_time, 1.0, false),
        }
    }
}

/// A state for display.
#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct State {
    /// Estimate by the punch lattice, or for the pillar tops alone, until the complete state is
    /// solved.
    approximate: bool,
    /// Fraction of the path to the critical state.
    fraction: f64,
    /// The errors are `null` if the state is sent before they are estimated; a [`SummaryLine`] follows.
    summary: Object,
    normalized: [f64; 3],
    pitch_m: f64,
    diameter_m: f64,
    lattice: DrawnLattice,
    /// Lattice indices of the pillars in contact, in a flat list.
    pillars: Vec<i64>,
    pillar_forces_N: Vec<f64>,
    /// One letter for every pillar: `f` for full, `p` for partial contact.
    pillar_statuses: String,
    /// First floor contact with its symmetric copies; empty if the floor carries load.
    floor_contacts_m: Vec<Point>,
    /// Floor cells in contact, if the floor carries load.
    floor: Option<FloorCells>,
    warnings: Vec<String>,
}

/// Summary of a state, with the errors of force and indentation, which were not available when the state was sent.
#[derive(Serialize)]
struct SummaryLine {
    summary: Object,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct PreviewLine {
    preview: Preview,
}

/// The same by the homogenised lattice, with an error of one or two per cent, in a few ms:
/// displayed until the state is solved. Forces on pillars are approximated by `F_n = F_0 sqrt(1 -
/// (r_n/a)^2)`.
#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct Preview {
    fraction: f64,
    critical_force_N: f64,
    critical_indentation_m: f64,
    critical_contact_radius_m: f64,
    force_N: f64,
    contact_radius_m: f64,
    pitch_m: f64,
    diameter_m: f64,
    lattice: DrawnLattice,
}

#[derive(Serialize)]
pub(crate) struct SectionLine {
    pub(crate) section: Option<Section>,
}

/// Heights above the undeformed floor along x through the lens axis.
#[derive(Serialize)]
pub(crate) struct Section {
    x_m: Vec<f64>,
    lens_m: Vec<f64>,
    surface_m: Vec<f64>,
    /// First floor contact in this plane, if there is one: x and height.
    floor_contacts_m: Vec<Point>,
    /// Floor contact: the ends of every interval along x.
    floor_m: Vec<[f64; 2]>,
}

impl From<fakir_figure::Section> for Section {
    fn from(section: fakir_figure::Section) -> Self {
        Self {
            x_m: section.x,
            lens_m: section.lens,
            surface_m: section.surface,
            floor_contacts_m: section.floor_contacts,
            floor_m: section.floor_patches,
        }
    }
}

#[derive(Serialize)]
pub(crate) struct CaseLine {
    pub(crate) case: lines::Texts,
}

/// `POST /api/contact`
pub(crate) fn contact(request: &request::AtLoad, worker: &Worker) -> Result<(), Failure> {
    let case = request::case(&request.case, request.table.as_ref())?;
    request.load.check()?;
    preview(&case, request.load, worker);
    let fraction = request.load.fraction;
    let shown = AtomicBool::new(false);
    let meets_floor = meets_floor(&case, request.load);
    let show = |state: &ContactState, wall_time: f64| {
        let approximate = state.method != case.method || (meets_floor && state.floor.is_none());
        if !approximate {
            shown.store(true, Ordering::Relaxed);
        }
        worker.send(&StateLine {
            state: drawn(state, wall_time, fraction, approximate),
        });
    };
    let solved = solve(
        &case,
        request.load,
        worker,
        Some(&show),
        |critical, wall_time| {
            worker.send(&CriticalLine {
                critical: transition(critical, None, None, wall_time),
            });
        },
    )?;
    let Some((state, wall_time)) = solved.state() else {
        return Err(Failure::Cancelled);
    };
    if shown.load(Ordering::Relaxed) {
        worker.send(&SummaryLine {
            summary: press(state, None, None, wall_time),
            warnings: warnings(state),
        });
    } else {
        // Sends the result, whatever it is.
        worker.send(&StateLine {
            state: drawn(state, wall_time, fraction, false),
        });
    }
    let pressed = solved.pressed.as_ref().map(|(state, _)| state.indentation);
    worker.send(&CaseLine {
        case: lines::texts(&case, pressed),
    });
    worker.send(&SectionLine {
        section: section(
            state,
            fakir_figure::Section::half_width(state),
            solved.floor_contact(),
            worker,
        )?,
    });
    Ok(())
}

/// Sends a preview if solving takes long enough.
pub(crate) fn preview(case: &Case, load: LoadPoint, worker: &Worker) {
    let system = &case.system;
    if expected_pillars(system) < PREVIEW_PILLARS || case.method == Method::Homogenised {
        return;
    }
    let run = worker.run();
    // Without a preview if the homogenised lattice does not apply.
    let Ok(critical) = fakir::transition(system, Method::Homogenised, &run) else {
        return;
    };
    let critical = critical.contact;
    let state = if load.is_critical() {
        critical.clone()
    } else {
        let indentation = indentation(case, critical.indentation, load.fraction);
        match fakir::press(
            system,
            Load::Indentation(indentation),
            Method::Homogenised,
            &run,
        ) {
            Ok(state) => state,
            Err(_) => return,
        }
    };
    worker.send(&PreviewLine {
        preview: Preview {
            fraction: load.fraction,
            critical_force_N: critical.force,
            critical_indentation_m: critical.indentation,
            critical_contact_radius_m: critical.contact_radius,
            force_N: state.force,
            contact_radius_m: state.contact_radius,
            pitch_m: system.pitch(),
            diameter_m: system.pillar().diameter,
            lattice: drawn_lattice(system, critical.contact_radius),
        },
    });
}

fn drawn(state: &ContactState, wall_time: f64, fraction: f64, approximate: bool) -> State {
    let system = &state.system;
    let floor = state.smallest_gap_position;
    let reduced = Normalized::new(system, state.force, state.contact_radius, state.indentation);
    State {
        approximate,
        fraction,
        summary: press(state, None, None, wall_time),
        normalized: [reduced.force, reduced.contact_radius, reduced.indentation],
        pitch_m: system.pitch(),
        diameter_m: system.pillar().diameter,
        lattice: drawn_lattice(system, state.whole_contact_radius()),
        pillars: indices(state),
        pillar_forces_N: state.pillars.iter().map(|pillar| pillar.force).collect(),
        pillar_statuses: state
            .pillars
            .iter()
            .map(|pillar| match pillar.status {
                PillarStatus::Partial => 'p',
                _ => 'f',
            })
            .collect(),
        floor_contacts_m: match state.floor {
            None => system.symmetric_copies(floor),
            Some(_) => Vec::new(),
        },
        floor: state.floor.as_ref().map(FloorCells::new),
        warnings: warnings(state),
    }
}

/// Lattice indices of the pillars in contact, in a flat list.
pub(crate) fn indices(state: &ContactState) -> Vec<i64> {
    let pillars = state.pillars.iter();
    pillars
        .flat_map(|pillar| [pillar.index.0, pillar.index.1])
        .collect()
}

/// Positions of the pillars of a lattice: `(i, j)` at `origin + i a + j b`.
#[derive(Serialize)]
pub(crate) struct DrawnLattice {
    /// `a` and `b`.
    vectors_m: [Point; 2],
    origin_m: Point,
    /// First index and end along both directions, if the lattice is finite.
    range: Option<[i64; 2]>,
    /// Indices of missing pillars in view, in a flat list.
    missing: Vec<i64>,
    /// Position and diameter of each pillar of a table, m, whose index is (i, 0).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    listed: Vec<[f64; 3]>,
}

/// Radius within which missing pillars are sent, in multiples of the contact radius or the pitch.
const VIEW: f64 = 3.0;

/// The lattice with the missing pillars around a contact of the given radius (m).
pub(crate) fn drawn_lattice(system: &System, contact_radius: f64) -> DrawnLattice {
    let (vectors, origin, cut) = match system.arrangement() {
        Arrangement::Lattice(lattice) => (lattice.vectors(), lattice.origin(), Some(lattice)),
        Arrangement::Hexagonal(lattice) => {
            let vectors = [lattice.lattice_vector(1, 0), lattice.lattice_vector(0, 1)];
            (vectors, lattice.centre(0, 0), None)
        }
        _ => ([[0.0; 2]; 2], [0.0; 2], None),
    };
    let gappy = cut.filter(|lattice| lattice.disorder.missing > 0.0);
    let missing = gappy.map_or(Vec::new(), |lattice| {
        let radius = VIEW * contact_radius.max(2.0 * system.pitch());
        let whole = PlaneLattice {
            disorder: Disorder::default(),
            ..*lattice
        };
        let all = system.with_arrangement(whole).ok();
        let pillars = all.map_or(Vec::new(), |system| system.pillars_within(radius));
        let indices = pillars.into_iter().map(|pillar| pillar.index);
        indices
            .filter(|index| lattice.disorder.height_ratio(*index).is_none())
            .flat_map(|(i, j)| [i, j])
            .collect()
    });
    let listed = match system.arrangement() {
        Arrangement::Listed(list) => {
            let pillars = list.pillars().iter();
            pillars
                .map(|pillar| [pillar.centre[0], pillar.centre[1], pillar.diameter])
                .collect()
        }
        _ => Vec::new(),
    };
    DrawnLattice {
        listed,
        vectors_m: vectors,
        origin_m: origin,
        range: cut.and_then(PlaneLattice::ends),
        missing,
    }
}

/// Section of the displayed state, with the given half-width (m); `None` for methods that do not resolve
/// it.
pub(crate) fn section(
    state: &ContactState,
    half_width: f64,
    floor_contact: Option<Point>,
    worker: &Worker,
) -> Result<Option<Section>, Failure> {
    let detail = SectionDetail::Screen;
    let run = worker.run();
    match fakir_figure::Section::new(state, half_width, floor_contact, detail, &run) {
        Ok(section) => Ok(Some(section.into())),
        Err(FigureError::NoPillars { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

/// A point of a curve.
#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct CurvePoint {
    surface_fraction: f64,
    force_N: f64,
    contact_radius_m: f64,
    indentation_m: f64,
    /// `a/e` and `F gamma_int/(h d)`, for the phase diagram.
    normalized: [f64; 2],
}

impl CurvePoint {
    fn of_state(critical: &CriticalState) -> Self {
        let state = &critical.contact;
        let reduced = critical.normalized();
        Self {
            surface_fraction: state.system.pattern().surface_fraction(),
            force_N: state.force,
            contact_radius_m: critical.contact_radius(),
            indentation_m: state.indentation,
            normalized: [reduced.contact_radius, reduced.force],
        }
    }

    fn of_formula(system: &System, estimate: &TransitionEstimate) -> Self {
        let reduced = Normalized::new(
            system,
            estimate.force,
            estimate.contact_radius(),
            estimate.indentation,
        );
        Self {
            surface_fraction: system.pattern().surface_fraction(),
            force_N: estimate.force,
            contact_radius_m: estimate.contact_radius(),
            indentation_m: estimate.indentation,
            normalized: [reduced.contact_radius, reduced.force],
        }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
enum CurveLine {
    Formulas {
        method: &'static str,
        small_contact: Vec<CurvePoint>,
        large_contact: Vec<CurvePoint>,
    },
    Homogenised(Vec<CurvePoint>),
    Point(CurvePoint),
    Complete {
        largest_surface_fraction: f64,
    },
}

/// `POST /api/curves`: sends the fast curves first, then the exact one, coarse points first. All are without adhesion; the page
/// states this.
pub(crate) fn curves(request: &request::Curves, worker: &Worker) -> Result<(), Failure> {
    let case = without_adhesion(&request::case(&request.case, request.table.as_ref())?);
    let system = &case.system;
    if matches!(system.arrangement(), Arrangement::Listed(_)) {
        return Err(
            Refusal::impossible("a table of pillars has no surface fraction to vary")
                .accepted("a lattice")
                .into(),
        );
    }
    let present = system.pattern().surface_fraction();
    let range = [FRACTIONS[0].min(0.5 * present), FRACTIONS[1].max(present)];
    let smooth: Vec<System> = spaced(range, 64)
        .into_iter()
        .filter_map(|fraction| at_fraction(system, fraction))
        .collect();
    let method = curve_method(case.method);
    // The closed forms apply to the infinite hexagonal lattice on half-spaces.
    let formulas = if system.has_layers() {
        &[]
    } else {
        &smooth[..]
    };
    let limit = match system.hexagonal_lattice() {
        Some(_) => closed_forms::small_contact_limit(system),
        None => f64::NAN,
    };
    let formula = |applies: &dyn Fn(f64) -> bool,
                   formula: &dyn Fn(&System) -> TransitionEstimate| {
        formulas
            .iter()
            .filter(|system| applies(system.pattern().surface_fraction()))
            .map(|system| CurvePoint::of_formula(system, &formula(system)))
            .collect()
    };
    worker.send(&CurveLine::Formulas {
        method: method.name(),
        small_contact: formula(&|fraction| fraction <= limit, &closed_forms::small_contact),
        large_contact: formula(&|fraction| fraction >= limit, &|system| {
            closed_forms::large_contact(system, Form::Corrected)
        }),
    });
    let run = worker.run();
    let mut points = Vec::new();
    // At smaller surface fractions a single pillar is in contact, to which the homogenised lattice does not
    // apply.
    let many = |system: &&System| system.pattern().surface_fraction() >= limit;
    for system in smooth.iter().step_by(2).filter(many) {
        worker.give_way()?;
        if let Ok(critical) = fakir::transition(system, Method::Homogenised, &run) {
            points.push(CurvePoint::of_state(&critical));
        }
    }
    worker.send(&CurveLine::Homogenised(points));
    let exact = spaced(range, CURVE_POINTS);
    let mut largest: f64 = 0.0;
    for index in coarse_first(CURVE_POINTS) {
        let Some(system) = at_fraction(system, exact[index]) else {
            continue;
        };
        if expected_pillars(&system) > CURVE_PILLARS {
            continue;
        }
        worker.give_way()?;
        match fakir::transition(&system, method, &run) {
            Ok(critical) if critical.contact.converged() => {
                largest = largest.max(exact[index]);
                worker.send(&CurveLine::Point(CurvePoint::of_state(&critical)));
            }
            Ok(_) => {}
            Err(fakir::state::SolveError::Interrupted) => return Err(Failure::Cancelled),
            // There is no result at this surface fraction, but possibly at others.
            Err(_) => {}
        }
    }
    worker.send(&CurveLine::Complete {
        largest_surface_fraction: largest,
    });
    Ok(())
}

/// Boundary elements take too long for a whole curve.
fn curve_method(method: Method) -> Method {
    match method {
        Method::Love(_) | Method::Spectral(_) => Method::Spectral(Accuracy::Default),
        other => other,
    }
}

/// Numbers equally spaced on a logarithmic scale, including both ends.
fn spaced([first, last]: [f64; 2], count: usize) -> Vec<f64> {
    let steps = count.saturating_sub(1) as f64;
    (0..count)
        .map(|k| first * (last / first).powf(k as f64 / steps))
        .collect()
}

/// Numbers below `count`, which is a power of two plus one: every 8th first, then those in between.
fn coarse_first(count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).step_by(8).collect();
    for stride in [8, 4, 2] {
        order.extend((stride / 2..count).step_by(stride));
    }
    order
}

#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
enum PhaseLine {
    /// `a/e` and `F gamma_int/(h d)` on the transition curve.
    Transition(Vec<[f64; 2]>),
    /// A state of the loading.
    Path(PathState),
}

/// A state of the loading for curves.
#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct PathState {
    /// Fraction of the path to the critical state.
    fraction: f64,
    indentation_m: f64,
    force_N: f64,
    /// Floor force; `None` if floor contact is ignored.
    floor_force_N: Option<f64>,
    /// `a/e` and `F gamma_int/(h d)`, for the phase diagram.
    normalized: [f64; 2],
}

/// A point in the phase diagram: `a/e` and `F gamma_int/(h d)`.
fn reduced(system: &System, force: f64, radius: f64) -> [f64; 2] {
    let reduced = Normalized::new(system, force, radius, 0.0);
    [reduced.contact_radius, reduced.force]
}

/// The transition curve of the phase diagram.
pub(crate) fn transition_line(system: &System) -> impl Serialize + use<> {
    // It is a closed form, which applies only to the infinite hexagonal lattice on half-spaces.
    let known = system.hexagonal_lattice().is_some() && !system.has_layers();
    let ratios = spaced([0.01, 1000.0], if known { 200 } else { 0 });
    let curve = ratios.into_iter().map(|ratio| {
        let radius = ratio * system.pitch();
        let force = closed_forms::transition_force(system, radius);
        reduced(system, force, radius)
    });
    PhaseLine::Transition(curve.collect())
}

/// `POST /api/phase`: the transition curve, and the loading of the case, also past the critical
/// state.
pub(crate) fn phase(request: &request::AtLoad, worker: &Worker) -> Result<(), Failure> {
    let case = request::case(&request.case, request.table.as_ref())?;
    request.load.check()?;
    let system = &case.system;
    worker.send(&transition_line(system));
    let run = worker.run();
    let method = curve_method(case.method);
    let critical = match request.load.critical_indentation_m {
        Some(critical) => critical,
        None => {
            worker.give_way()?;
            fakir::transition(system, method, &run)?.contact.indentation
        }
    };
    // The same method as for displayed states: only the spectral method supports the floor.
    let system = &match floor_carries_load(&case) {
        true => system.clone(),
        false => system.with_floor(FloorModel::Ignored),
    };
    let pillars = expected_pillars(system);
    for fraction in PATH_FRACTIONS {
        if floor_carries_load(&case) && fraction > 1.0 && fraction * pillars > FLOOR_PILLARS {
            continue;
        }
        worker.give_way()?;
        let load = Load::Indentation(indentation(&case, critical, fraction));
        match fakir::press(system, load, method, &run) {
            Ok(state) => {
                worker.send(&PhaseLine::Path(PathState {
                    fraction,
                    indentation_m: state.indentation,
                    force_N: state.force,
                    floor_force_N: of_floor(&state, |floor| floor.force),
                    normalized: reduced(system, state.force, state.contact_radius),
                }));
            }
            Err(fakir::state::SolveError::Interrupted) => return Err(Failure::Cancelled),
            Err(_) => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_of_a_curve_comes_once() {
        let mut order = coarse_first(CURVE_POINTS);
        assert_eq!(order[..5], [0, 8, 16, 24, 32]);
        order.sort_unstable();
        assert_eq!(order, (0..CURVE_POINTS).collect::<Vec<_>>());
    }
}
