//! Responses: contacts with their pillars and section, curves over the surface fraction, and the
//! phase diagram. All values are in SI units, with the unit in the name.

use crate::clock::Moment;
use crate::lines;
use crate::refusal::Refusal;
use crate::request::{self, FARTHEST, LoadPoint, at_fraction, expected_pillars, without_adhesion};
use crate::shown::{
    Drawn, Section, Shown, Stage, curve_method, indentation, spaced, transition_curve,
};
use crate::worker::{Failure, Worker};
use fakir::problem::{Arrangement, Load, Method, Point, System};
use fakir::state::{Contact, ContactState, Critical, CriticalState, Normalized};
use fakir::theory::closed_forms;
use fakir::theory::closed_forms::{Form, TransitionEstimate};
use fakir_case::{AnyCase, Case};
use fakir_study::record::Object;
use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering};

/// Largest number of pillars in a background computation.
const CURVE_PILLARS: f64 = 4000.0;

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
pub(crate) struct Solved<C> {
    /// Critical state, and its computing time, s.
    pub(crate) critical: Option<(Critical<C>, f64)>,
    /// A state other than the critical one, and its computing time, s.
    pub(crate) pressed: Option<(C, f64)>,
}

impl<C> Solved<C> {
    /// Displayed state, and its computing time, s.
    pub(crate) fn state(&self) -> Option<(&C, f64)> {
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

/// Receives an intermediate contact, and the computing time so far, s.
type Listener<'a, C> = &'a (dyn Fn(&C, f64) + Sync);

/// Solves a state before, at or past the critical state. `interim` receives intermediate states for
/// display, and `found` the critical state; both with the computing time so far, s.
pub(crate) fn solve<S: Shown>(
    case: &S,
    load: LoadPoint,
    worker: &Worker,
    interim: Option<Listener<'_, S::Contact>>,
    found: impl FnOnce(&Critical<S::Contact>, f64),
) -> Result<Solved<S::Contact>, Failure> {
    let known = match case.no_end() {
        // Loads are relative to another indentation.
        Some(_) => Some(case.reference()),
        None => load.critical_indentation_m,
    };
    let is_critical = load.is_critical() && case.no_end().is_none();
    let start = Moment::now();
    let listener = interim
        .map(|interim| move |state: &S::Contact| interim(state, start.elapsed().as_secs_f64()));
    let listener = listener
        .as_ref()
        .map(|it| it as &(dyn Fn(&S::Contact) + Sync));
    let critical = if is_critical || known.is_none() {
        let listener = listener.filter(|_| is_critical);
        let critical = case.find_critical(worker, listener)?;
        let wall_time = start.elapsed().as_secs_f64();
        found(&critical, wall_time);
        Some((critical, wall_time))
    } else {
        None
    };
    let target = match &critical {
        Some((critical, _)) => critical.contact.indentation(),
        None => known.unwrap_or_default(),
    };
    let pressed = if is_critical {
        None
    } else {
        let control = Load::Indentation(indentation(case, target, load.fraction));
        let state = case.find_contact(control, worker, listener)?;
        Some((state, start.elapsed().as_secs_f64()))
    };
    Ok(Solved { critical, pressed })
}

#[derive(Serialize)]
pub(crate) struct CriticalLine {
    pub(crate) critical: Object,
}

/// The indentation to which loads are relative where there is no critical state, m, and why there is none.
#[derive(Serialize)]
struct ReferenceLine {
    reference: Reference,
}

#[derive(Serialize)]
struct Reference {
    indentation_m: f64,
    why: &'static str,
}

#[derive(Serialize)]
pub(crate) struct StateLine {
    state: State,
}

impl StateLine {
    /// Critical state of a cycle, with its computing time in seconds.
    pub(crate) fn of_critical(case: &Case, state: &ContactState, wall_time: f64) -> Self {
        Self::of(case, state, wall_time, Stage::Requested, Some(1.0))
    }

    /// A state of a load. The errors of an intermediate one are not known yet.
    fn of<S: Shown>(
        case: &S,
        contact: &S::Contact,
        wall_time: f64,
        stage: Stage,
        fraction: Option<f64>,
    ) -> Self {
        Self {
            state: State {
                approximate: stage != Stage::Requested,
                fraction: fraction.filter(|_| stage != Stage::OnTheWay),
                summary: case.summary(contact, wall_time),
                drawn: case.drawn(contact),
                warnings: case.warnings(contact),
            },
        }
    }
}

/// A state for display.
#[derive(Serialize)]
struct State {
    /// Estimate by the punch lattice, for the pillar tops alone, or for a smaller load, until the complete state is
    /// solved.
    approximate: bool,
    /// Fraction of the path to the critical state; `None` if that is not known.
    fraction: Option<f64>,
    /// The errors are `null` if the state is sent before they are estimated; a [`SummaryLine`] follows.
    summary: Object,
    #[serde(flatten)]
    drawn: Drawn,
    warnings: Vec<String>,
}

/// Summary of a state, with the errors of force and indentation, which were not available when the state was sent.
#[derive(Serialize)]
struct SummaryLine {
    summary: Object,
    warnings: Vec<String>,
}

#[derive(Serialize)]
pub(crate) struct SectionLine {
    pub(crate) section: Option<Section>,
}

#[derive(Serialize)]
pub(crate) struct CaseLine {
    pub(crate) case: lines::Texts,
}

/// `POST /api/contact`
pub(crate) fn contact(request: &request::AtLoad, worker: &Worker) -> Result<(), Failure> {
    request.load.check()?;
    match request::any_case(&request.case, request.table.as_ref())? {
        AnyCase::Pillars(case) => contact_of(&*case, request.load, worker),
        AnyCase::Asperities(case) => contact_of(&*case, request.load, worker),
        AnyCase::Flat(case) => contact_of(&*case, request.load, worker),
        AnyCase::HeightMap(_) => Err(request::on_a_height_map().into()),
    }
}

fn contact_of<S: Shown>(case: &S, load: LoadPoint, worker: &Worker) -> Result<(), Failure> {
    if let Some(why) = case.no_end() {
        let indentation_m = case.reference();
        let reference = Reference { indentation_m, why };
        worker.send(&ReferenceLine { reference });
    }
    case.preview(load, worker);
    let shown = AtomicBool::new(false);
    let show = |state: &S::Contact, wall_time: f64| {
        let stage = case.stage(state, load);
        if stage == Stage::Requested {
            shown.store(true, Ordering::Relaxed);
        }
        let fraction = Some(load.fraction);
        let mut line = StateLine::of(case, state, wall_time, stage, fraction);
        // Those of the final state follow.
        line.state.warnings.clear();
        worker.send(&line);
    };
    let solved = solve(case, load, worker, Some(&show), |critical, wall_time| {
        worker.send(&CriticalLine {
            critical: case.critical(critical, wall_time),
        });
    })?;
    let Some((state, wall_time)) = solved.state() else {
        return Err(Failure::Cancelled);
    };
    if shown.load(Ordering::Relaxed) {
        worker.send(&SummaryLine {
            summary: case.summary(state, wall_time),
            warnings: case.warnings(state),
        });
    } else {
        // Sends the result, whatever it is.
        let (stage, fraction) = (Stage::Requested, Some(load.fraction));
        worker.send(&StateLine::of(case, state, wall_time, stage, fraction));
    }
    let pressed = solved.pressed.as_ref();
    worker.send(&CaseLine {
        case: case.texts(pressed.map(|(state, _)| state.indentation())),
    });
    worker.send(&SectionLine {
        section: case.section(state, solved.floor_contact(), worker)?,
    });
    Ok(())
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
    /// Indentation, m, and force, N, on unloading from the critical state, or from the reference.
    Unloading(Vec<[f64; 2]>),
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
    /// `a/e` and `F gamma_int/(h d)`, for the phase diagram; `None` for other surfaces.
    normalized: Option<[f64; 2]>,
}

/// The transition curve of the phase diagram.
pub(crate) fn transition_line(system: &System) -> impl Serialize + use<> {
    PhaseLine::Transition(transition_curve(system))
}

/// `POST /api/phase`: the transition curve, and the loading of the case, also past the critical
/// state.
pub(crate) fn phase(request: &request::AtLoad, worker: &Worker) -> Result<(), Failure> {
    request.load.check()?;
    let critical = request.load.critical_indentation_m;
    match request::any_case(&request.case, request.table.as_ref())? {
        AnyCase::Pillars(case) => phase_of(&*case, critical, worker),
        AnyCase::Asperities(case) => phase_of(&*case, critical, worker),
        AnyCase::Flat(case) => phase_of(&*case, critical, worker),
        AnyCase::HeightMap(_) => Err(request::on_a_height_map().into()),
    }
}

fn phase_of<S: Shown>(case: &S, critical: Option<f64>, worker: &Worker) -> Result<(), Failure> {
    worker.send(&PhaseLine::Transition(case.transition_curve()));
    let run = worker.run();
    let case = &case.of_curves();
    let critical = match critical {
        _ if case.no_end().is_some() => case.reference(),
        Some(critical) => critical,
        None => {
            worker.give_way()?;
            case.transition(&run)?.contact.indentation()
        }
    };
    for fraction in PATH_FRACTIONS {
        if case.is_slow_at(fraction) {
            continue;
        }
        worker.give_way()?;
        let load = Load::Indentation(indentation(case, critical, fraction));
        match case.point_of_curve(load, fraction, &run) {
            Ok(state) => worker.send(&PhaseLine::Path(PathState {
                fraction,
                indentation_m: state.indentation(),
                force_N: state.force(),
                floor_force_N: case.floor_force(&state),
                normalized: case
                    .normalized(&state)
                    .map(|[force, radius, _]| [radius, force]),
            })),
            Err(fakir::state::SolveError::Interrupted) => return Err(Failure::Cancelled),
            Err(_) => {}
        }
    }
    let end = indentation(case, critical, 1.0);
    if let Some(unloading) = case.unloading(end, worker)? {
        worker.send(&PhaseLine::Unloading(unloading));
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
