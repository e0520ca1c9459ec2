//! Results with adhesive pillar tops, assembled from the [path](super::path) of loading and unloading.

use super::assembled::floor_gap;
use super::bonded_floor_errors::{Figures, PLAIN, PLAIN_FLOOR, PLAIN_VARIATIONS, VARIATIONS};
use super::estimate::unknowns_only;
use super::floor::FloorPoint;
use super::mixed::patches;
use super::path::{
    AttachedTop, End, FixedQuantity, LONG_STEP, LoadStep, PLAIN_STEP, Path, SAME_FORCE, Stop,
    TopEvent,
};
use super::rules::fronts::{Course, Fronts, LEVELS, Works};
use super::spectral::degrees;
use super::touched::nearest_first;
use crate::halfspace::disc::basis::{BasisEvaluator, TILT_MODE, UNIT_FORCE, degree_with};
use crate::numerics::vector::dot;
use crate::problem::scaled::Scene;
use crate::problem::{
    Accuracy, CyclePlan, FloorModel, Load, LoadingMode, Method, PillarCompliance, System,
    UnloadingPoint,
};
use crate::state::contact::contact_warnings;
use crate::state::fields::{BondedRegion, Disc, FRONT_PLACE_ERROR};
use crate::state::limit::LARGEST_STRAIN;
use crate::state::{
    AdhesiveFloorErrors, Branch, ContactState, CriticalState, Cycle, CycleError, CycleErrors,
    CycleEvent, CycleEventKind, CycleLoadStep, ErrorEstimate, Fields, FloorContact, FloorErrors,
    FloorResolution, HeldContact, HeldFloor, HeldPillar, Passage, PillarState, PillarStatus,
    PullOff, Run, SolveError, Termination, Warning,
};
use crate::theory::adhesion::corner_ratio;
use crate::theory::stuck_floor::BondedFloorPillar;
use std::f64::consts::PI;
use std::sync::Arc;

/// Relative error of the force on a partially bonded top, due to the assumed front shapes: measured against a cohesive zone on boundary
/// elements.
const PARTIAL_ERROR: f64 = 0.05;

/// Error of the critical indentation relative to that of the force, if tops are partially bonded.
const INDENTATION_SHARE: f64 = 0.3;

/// Relative error of the pull-off force due to the assumed front shapes.
const FRONT_ERROR: f64 = 0.05;

/// Relative error of the pull-off force due to the 360 sampled angles around a rim.
const ANGLE_ERROR: f64 = 2e-5;

/// Relative error of the forces on tops due to the degree `p` of the pressure, divided by `pitch^-(2p + 2)`.
const DEGREE_ERROR: f64 = 2e-3;

/// The same of a critical state, where the gap at the floor depends on the pressures that the degree leaves out: three times what 25 tops of a
/// square lattice at a pitch of 4.8 pillar radii lack for degree 2 (4e-6 of the force, 3e-6 of the indentation).
const FLOOR_GAP_DEGREE_ERROR: f64 = 0.14;

/// The same due to layers of thickness `t` and weight `w` under the tops, divided by `w t^-(2p + 5)`, and that of the stress intensity factor divided by
/// `w t^-(p + 3)`: three times what one top on a film lacks at `t` of 2 to 10 top radii, for degrees 2 and 4.
const LAYER_DEGREE_ERROR: f64 = 1e-3;
const LAYER_RIM_ERROR: f64 = 0.5;

/// Relative error of the stress intensity factor along the rim at which a top detaches, divided by `pitch^-(p + 2)`: unlike the forces it
/// does not average out. 1e-3 for degree 2 at a pitch of 6 pillar radii, where seven tops on a flat lens give 6e-4.
const RIM_DEGREE_ERROR: f64 = 1.3;

/// Relative errors of the pull-off force and of the loop area due to the 16 front levels. From 8 to 16 levels the pull-off force changes by
/// 0.4 to 2.5 % (6 % at 1 mJ/m^2), the loop area by 0.4 to 1.5 %.
const LEVEL_ERROR: f64 = 0.03;
const LEVEL_ERROR_OF_LOOP: f64 = 0.015;

/// Change of the force on a partially bonded top when its front advances by a level, as a fraction of the pull of the whole top: the
/// adhesive force is proportional to the area to the power 3/4.
const LEVEL_STEP: f64 = 0.75 / LEVELS as f64;

/// Safety factor on the force [left open](Path::left_open) by the front levels. That force is the difference, at one load, between a disc
/// and the front that replaces it; the error grows along the path by a factor of up to 1.7, measured on contacts without adhesion against
/// the spectral method.
const LEFT_OPEN: f64 = 2.0;

/// Width of the cells of a floor without adhesion, in pillar radii times [`FloorResolution::WANTED`].
const PLAIN_CELLS: f64 = 0.2 * FloorResolution::WANTED;

/// Distance by which the first window of an adhesive floor extends beyond the first patch, in units of the pillar spacing.
const FIRST_WINDOW: f64 = 1.5;

/// Relative error of the linear solver and of the overshoot past events.
const SOLVER_ERROR: f64 = 1e-6;

/// Computes the contact at a prescribed load on the loading branch, which starts at first contact.
pub(crate) fn press(
    system: &System,
    control: Load,
    accuracy: Accuracy,
    run: &Run<'_>,
) -> Result<ContactState, SolveError> {
    let scene = Scene::new(system);
    let end = match control {
        Load::Indentation(indentation) => End::Indentation(indentation / scene.length),
        Load::Force(force) => End::Force(force / scene.force()),
        Load::FloorContact => End::Floor,
    };
    let route = Route {
        drive: LoadingMode::Displacement,
        end,
        jumps: false,
        retract: false,
    };
    let loaded = route.followed(system, &scene, accuracy, run, &|_| {})?;
    let ErrorEstimate { force, indentation } = loaded.turn.error;
    let mut error = unknowns_only(control, loaded.turn.termination, [force, indentation]);
    if let Load::Force(force) = control {
        // Fronts on an adhesive floor move by cells, so that not every force is met.
        let missed = (loaded.turn.force / force - 1.0).abs();
        if missed > SAME_FORCE && missed.is_finite() {
            error.force = error.force.max(missed);
        }
        error.indentation += loaded.indentation_of_a_level();
    }
    Ok(ContactState {
        error,
        ..loaded.turn
    })
}

/// Computes a cycle of loading and unloading. The plan must have been validated.
pub(crate) fn cycle(
    system: &System,
    plan: CyclePlan,
    accuracy: Accuracy,
    run: &Run<'_>,
    follower: &dyn Fn(&Passage<'_>),
) -> Result<Cycle, SolveError> {
    let scene = Scene::new(system);
    let follow = |path: &Path<'_>| {
        if let Some(station) = path.stations.last() {
            follower(&Passage {
                place: path.stations.len() - 1,
                station: in_si(path.scene, station),
                held: &|| current_contact(path),
            });
        }
    };
    let end = match plan.turn {
        UnloadingPoint::Critical(part) if part < 1.0 => {
            let critical = press(system, Load::FloorContact, accuracy, run)?;
            End::Indentation(part * critical.indentation / scene.length)
        }
        UnloadingPoint::Critical(_) => End::Floor,
        UnloadingPoint::Indentation(indentation) => End::Indentation(indentation / scene.length),
        UnloadingPoint::Force(force) => End::Force(force / scene.force()),
    };
    let route = Route {
        drive: plan.drive,
        end,
        jumps: true,
        retract: plan.retract,
    };
    let loaded = route.followed(system, &scene, accuracy, run, &follow)?;
    Ok(loaded.cycle(plan))
}

/// The requested path.
#[derive(Clone, Copy)]
struct Route {
    drive: LoadingMode,
    /// End of the loading.
    end: End,
    /// Whether a path that ends at an adhesive floor continues to the state after jump-in.
    jumps: bool,
    /// Whether the lens is retracted after loading.
    retract: bool,
}

impl Route {
    /// Follows the path. With an adhesive floor, also estimates the floor errors by repeating the path with varied numerical parameters.
    fn followed<'a>(
        self,
        system: &'a System,
        scene: &'a Scene,
        accuracy: Accuracy,
        run: &'a Run<'a>,
        follow: &'a dyn Fn(&Path<'a>),
    ) -> Result<Loaded<'a>, SolveError> {
        let varied = |variation, follow| {
            let mut loading = Loading::new(system, scene, accuracy, self.drive, run)?;
            loading.path.variation = variation;
            if !self.jumps {
                let step = loading.path.floor_works.map_or(PLAIN_STEP, |_| LONG_STEP);
                // Shorter on larger cells, so that their difference contains that of the steps.
                loading.path.floor_step = step / variation.cells;
            }
            loading.path.followed_by(follow);
            let mut loaded = loading.until(self.end, self.jumps)?;
            let path = &mut loaded.loading.path;
            if self.retract
                && loaded.turn.converged()
                && let Stop::Failed(termination) =
                    path.go(Course::Unloading, End::Separation, false)?
            {
                loaded.turn.termination = termination;
            }
            Ok::<_, SolveError>(loaded)
        };
        let mut loaded = varied(PLAIN, follow)?;
        if let Some(floor) = loaded.loading.floor {
            if !floor.is_coarse() && loaded.turn.converged() {
                let (variations, safety) = match loaded.loading.path.floor_works {
                    Some(_) => (VARIATIONS, 1.0),
                    None => (PLAIN_VARIATIONS, PLAIN_FLOOR),
                };
                let others = variations.map(|variation| Ok(varied(variation, &|_| {})?.figures()));
                let others: Vec<Figures> = others.into_iter().collect::<Result<_, SolveError>>()?;
                let mut errors = loaded.figures().errors(&others).times(safety);
                let left_out = loaded.left_out();
                errors.turn_force += left_out;
                let share = loaded
                    .turn
                    .floor
                    .as_ref()
                    .map_or(1.0, |floor| floor.share.abs());
                errors.turn_floor_force += left_out / share;
                errors.turn_share += left_out / share;
                loaded.loading.floor = Some(FloorResolution { errors, ..floor });
            }
            loaded.weigh();
        }
        Ok(loaded)
    }
}

/// A loading on adhesive tops.
struct Loading<'a> {
    system: &'a System,
    accuracy: Accuracy,
    drive: LoadingMode,
    path: Path<'a>,
    /// Numerical resolution of the floor; `None` unless it was touched.
    floor: Option<FloorResolution>,
    /// Work of adhesion of the floor that is left out, as the cells do not resolve it.
    left_out: f64,
    /// Whether a jump of a top into contact brought the lens to the floor, so that the critical state is where the top jumps.
    floor_in_jump: bool,
}

/// The state at the end of a loading.
struct Loaded<'a> {
    loading: Loading<'a>,
    /// The contact at the end.
    turn: ContactState,
    critical: Option<CriticalState>,
    /// Number of events before the floor was reached.
    events_before_floor: Option<usize>,
}

impl<'a> Loading<'a> {
    fn new(
        system: &'a System,
        scene: &'a Scene,
        accuracy: Accuracy,
        drive: LoadingMode,
        run: &'a Run<'a>,
    ) -> Result<Self, SolveError> {
        let adhesion = system.adhesion();
        let scale = scene.pressure * scene.length;
        let works = Works {
            advancing: adhesion.work / scale,
            receding: adhesion.receding() / scale,
        };
        let degree = degrees(accuracy, scene).coupling;
        let fronts = Fronts::new(degree, scene.field.column(), works, true);
        let fixed = match drive {
            LoadingMode::Displacement => FixedQuantity::Indentation,
            LoadingMode::Force => FixedQuantity::Force,
            LoadingMode::Machine(stiffness) => {
                FixedQuantity::Crosshead(stiffness * scene.length / scene.force())
            }
        };
        let mut path = Path::new(scene, run, fronts, fixed)?;
        path.floor_works = adhesion.floor.then_some(works);
        Ok(Self {
            system,
            accuracy,
            drive,
            path,
            floor: None,
            left_out: 0.0,
            floor_in_jump: false,
        })
    }

    /// Loads to a prescribed end, also past the first contact with the floor, or to that. If loading ends at an adhesive floor, continues to
    /// the state after jump-in if `jumps` is set.
    fn until(mut self, end: End, jumps: bool) -> Result<Loaded<'a>, SolveError> {
        let ignored = self.system.floor_model() == FloorModel::Ignored;
        let (mut critical, mut events_before_floor) = (None, None);
        loop {
            match self
                .path
                .go(Course::Loading, end, events_before_floor.is_none())?
            {
                Stop::Floor(lowest) => {
                    events_before_floor = Some(self.path.events.len());
                    let indentation = self.path.indentation();
                    self.floor_in_jump = lowest.indentation < (1.0 - SOLVER_ERROR) * indentation;
                    let state = self.state(Termination::Converged);
                    let [force, indentation] = self.critical_errors();
                    let contact = ContactState {
                        smallest_floor_gap: 0.0, // exact up to rounding
                        error: ErrorEstimate {
                            force: state.error.force + force,
                            indentation: state.error.indentation + indentation,
                        },
                        ..state
                    };
                    critical = Some(CriticalState::new(contact.clone()));
                    let jumps = jumps && self.path.floor_works.is_some();
                    if !ignored && (jumps || end != End::Floor) {
                        if let Some(listener) = self.path.run.interim
                            && self.path.variation == PLAIN
                        {
                            listener(&contact);
                        }
                        self.attach_floor(lowest, end)?;
                        if end != End::Floor {
                            continue;
                        }
                        return Ok(Loaded {
                            turn: self.state(self.path.termination()),
                            loading: self,
                            critical,
                            events_before_floor,
                        });
                    }
                    if ignored && end != End::Floor {
                        continue;
                    }
                    return Ok(Loaded {
                        loading: self,
                        turn: contact,
                        critical,
                        events_before_floor,
                    });
                }
                stop => {
                    let termination = match stop {
                        Stop::Failed(termination) => termination,
                        _ => Termination::Converged,
                    };
                    return Ok(Loaded {
                        turn: self.state(termination),
                        loading: self,
                        critical,
                        events_before_floor,
                    });
                }
            }
        }
    }

    /// Starts adhesion on the floor, from its lowest point, in a loading to a prescribed end.
    fn attach_floor(&mut self, lowest: FloorPoint, end: End) -> Result<(), SolveError> {
        let (scene, spacing) = (self.path.scene, self.path.scene.field.spacing());
        // The widths of the narrowest free ring around a pillar and of the first patch, if the floor is adhesive.
        let widths = self.path.floor_works.map(|works| {
            let ring = self.narrowest_ring(end).unwrap_or(spacing);
            let curvature = self.path.gap_radius(&lowest);
            let patch = (2.0 * PI * works.advancing * curvature * curvature).cbrt();
            [ring, patch]
        });
        let [ring, patch] = widths.unwrap_or([PLAIN_CELLS, f64::INFINITY]);
        let division = self.path.bonded_division(self.accuracy, end, ring, patch);
        let cell = division.cell_area().sqrt();
        self.floor = Some(FloorResolution {
            cell: cell * scene.length,
            cells_across_ring: widths.map(|[ring, _]| ring / cell),
            cells_along_patch: widths.map(|[_, patch]| patch / cell),
            errors: AdhesiveFloorErrors::UNKNOWN,
        });
        let patch = widths.map_or(0.0, |[_, patch]| patch);
        let radius = lowest.position[0].hypot(lowest.position[1]) + patch;
        let window = radius + FIRST_WINDOW * scene.field.spacing();
        self.path.attach_floor(lowest, division, window)?;
        match self.path.floor_works {
            // The first patch is smaller than the cells: so little adhesion is left out, with an error that covers it.
            Some(works) if !self.path.touches_floor() && self.path.failed.is_none() => {
                self.left_out = works.advancing;
                self.path.floor_works = None;
                self.attach_floor(lowest, end)
            }
            _ => Ok(()),
        }
    }

    /// Width of the narrowest free ring around a pillar that the lens may touch in a loading to a prescribed end, from the closed form
    /// without pressure. Pillars that are pressed down to the floor have no ring; 0 if all are. `None` if the floor detaches from all others.
    fn narrowest_ring(&self, end: End) -> Option<f64> {
        let (system, scene) = (self.system, self.path.scene);
        // Farther pillars of an infinite lattice are like the near ones.
        let reach = match (end, scene.field.extent()) {
            (End::Indentation(indentation), Some(_)) => scene.farthest_reached(indentation),
            _ => self.path.sites.radius(),
        };
        let (pillars, _) = scene.field.listed_within(reach);
        let mut bodies: Vec<[f64; 2]> = pillars
            .iter()
            .map(|(_, pillar)| [pillar.body.radius, pillar.body.raised])
            .collect();
        bodies.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        // The lower of two pillars of one radius has the narrower ring.
        bodies.dedup_by(|next, kept| next[0].to_bits() == kept[0].to_bits());
        let work = system.adhesion().receding();
        let rings = bodies.into_iter().filter_map(|[radius, raised]| {
            let [radius, height] = [radius, scene.height + raised].map(|x| x * scene.length);
            let compliance = system.column_compliance_of(height, 2.0 * radius);
            let modulus = system.reduced_modulus();
            let pillar = BondedFloorPillar::new(modulus, radius, height, compliance).ok()?;
            pillar.free_ring(work).ok().flatten()
        });
        // Narrowest first, closed ones last.
        let by_width = |a: &f64, b: &f64| (*a == 0.0).cmp(&(*b == 0.0)).then(a.total_cmp(b));
        rings.min_by(by_width).map(|ring| ring / scene.length)
    }

    /// Returns the current contact.
    fn state(&self, termination: Termination) -> ContactState {
        let (system, scene) = (self.system, self.path.scene);
        let path = &self.path;
        let HeldContact {
            pillars,
            fields,
            floor,
        } = current_contact(path);
        let lowest = if floor.is_some() {
            None
        } else {
            path.lowest_floor()
        };
        let indentation = path.indentation();
        let radius = path.contact_radius();
        let force = path.force();
        let error = if termination == Termination::Converged && !path.is_below_first_level() {
            let share = if path.inside.is_some() {
                0.0
            } else {
                let [levels, shapes] = self.errors_of_parts(&pillars, force * scene.force());
                levels.max(shapes)
            };
            let [degree, _] = self.degree_errors();
            ErrorEstimate {
                force: degree + share,
                indentation: degree + INDENTATION_SHARE * share,
            }
        } else {
            ErrorEstimate {
                force: 1.0,
                indentation: 1.0,
            }
        };
        let partial = pillars
            .iter()
            .filter(|pillar| pillar.status == PillarStatus::Partial)
            .count();
        let radius_error = match (termination, partial) {
            (Termination::Converged, _) if path.inside.is_some() => SOLVER_ERROR * radius,
            (Termination::Converged, 0) => 0.0,
            (Termination::Converged, _) => FRONT_PLACE_ERROR,
            _ => radius,
        };
        let state = ContactState {
            force: force * scene.force(),
            contact_radius: radius * scene.length,
            contact_radius_error: radius_error * scene.length,
            pillars_in_contact: pillars.len(),
            pillars_partially_in_contact: partial,
            pillars,
            fields: Some(fields),
            smallest_floor_gap: 0.0, // the floor is in contact
            floor,
            error,
            termination,
            iterations: path.events.len(),
            warnings: self.warnings(scene.lens.slope_at(radius)),
            ..ContactState::untouched(
                system,
                Method::Spectral(self.accuracy),
                indentation * scene.length,
            )
        };
        floor_gap(scene, state, indentation, lowest)
    }

    /// Relative errors of a force (N) due to partially bonded tops: due to the number of front levels, and due to the front shapes.
    fn errors_of_parts(&self, pillars: &[PillarState], force: f64) -> [f64; 2] {
        let partial_load = load_of_partial_tops(pillars);
        let left_open = if partial_load > 0.0 {
            LEFT_OPEN * self.path.left_open * self.path.scene.force()
        } else {
            0.0
        };
        [left_open, PARTIAL_ERROR * partial_load].map(|error| relative(error, force))
    }

    fn warnings(&self, contact_ratio: f64) -> Vec<Warning> {
        let mut warnings = warnings(self.system, contact_ratio);
        if let Some(floor) = self.floor.filter(|floor| floor.is_coarse())
            && let Some(cells) = floor.cells_across_ring
        {
            warnings.push(Warning::CoarseFloor { cells });
        }
        warnings
    }

    /// Relative errors of force and indentation of a critical state due to the degree of the pressure, besides that of forces: the floor gap
    /// depends on it, and where a top jumps into contact the place of the jump depends on the gap at its rim, as the load at which a rim
    /// detaches.
    fn critical_errors(&self) -> [f64; 2] {
        let [_, rim] = self.degree_errors();
        let jump = if self.floor_in_jump { rim } else { 0.0 };
        let of_gap = FLOOR_GAP_DEGREE_ERROR * self.pitch_power(2 * self.path.tops.degree() + 2);
        [of_gap + jump, of_gap + INDENTATION_SHARE * jump]
    }

    /// Relative errors due to the degree of the pressure: of forces, and of the load at which a rim detaches.
    fn degree_errors(&self) -> [f64; 2] {
        let degree = self.path.tops.degree();
        let of_layers = |power: usize| -> f64 {
            let [largest, _] = self.path.scene.field.bounds();
            let layers = self.path.scene.layers.iter();
            layers
                .map(|layer| layer.weight * (layer.thickness / largest).powi(-(power as i32)))
                .sum()
        };
        [
            SOLVER_ERROR
                + DEGREE_ERROR * self.pitch_power(2 * degree + 2)
                + LAYER_DEGREE_ERROR * of_layers(2 * degree + 5),
            SOLVER_ERROR
                + RIM_DEGREE_ERROR * self.pitch_power(degree + 2)
                + LAYER_RIM_ERROR * of_layers(degree + 3),
        ]
    }

    /// A negative power of the pitch of equal tops whose rims are as close as the closest ones here, in pillar radii.
    fn pitch_power(&self, power: usize) -> f64 {
        let pitch = self.path.scene.field.least_gap() + 2.0;
        pitch.powi(-(power as i32))
    }
}

impl Loaded<'_> {
    /// Floor results; empty if the solution did not converge.
    fn figures(&self) -> Figures {
        let (path, turn) = (&self.loading.path, &self.turn);
        if !turn.converged() {
            return Figures::default();
        }
        let stations = &path.stations;
        let after_jump = stations.iter().find(|station| station.floor.is_some());
        let last = stations.iter().rposition(|station| station.floor.is_some());
        let lost = last.and_then(|last| Some([&stations[last], stations.get(last + 1)?]));
        let strongest = path.strongest.as_ref();
        let floor = turn.floor.as_ref();
        let closed = path.counts()[0] == 0 && path.floor.is_none();
        Figures {
            turn: [
                Some(turn.force),
                Some(turn.indentation),
                floor.map(|it| it.share),
                floor.map(|it| it.area),
            ],
            jump: [
                after_jump.map(|it| it.force),
                after_jump.and_then(|it| Some(it.floor?.area)),
            ],
            // Under a prescribed force nothing holds the lens after it has left.
            lost: lost.map(|[last, after]| match after.touched[0] {
                0 if self.loading.drive == LoadingMode::Force => [last.indentation; 2],
                _ => [last, after].map(|it| it.indentation),
            }),
            pull_off: strongest.map(|pull| stations[pull.station].force),
            loop_area: closed.then_some(path.energies.work),
        }
    }

    /// Relative change of the indentation under a prescribed force if all fronts on partially bonded tops were a level further: the force decreases
    /// where fronts advance, so that it may be reached before or after such a step.
    fn indentation_of_a_level(&self) -> f64 {
        /// Part of the loading curve over which its slope is taken, longer than the steps of the fronts.
        const PART: f64 = 0.02;
        let (path, turn) = (&self.loading.path, &self.turn);
        let scene = path.scene;
        let partial = turn.pillars.iter();
        let partial = partial.filter(|pillar| pillar.status == PillarStatus::Partial);
        let radii = partial.map(|pillar| 0.5 * pillar.diameter / scene.length);
        let pulls = radii.map(|radius| (8.0 * PI * path.works.advancing * radius.powi(3)).sqrt());
        let step = LEVEL_STEP * pulls.sum::<f64>();
        let (end, force) = (turn.indentation / scene.length, turn.force / scene.force());
        let mut before = path.stations.iter().rev();
        let before = before.find(|station| station.indentation < (1.0 - PART) * end);
        let slope = before.map_or(0.0, |it| (force - it.force) / (end - it.indentation));
        if step > 0.0 && slope > 0.0 {
            step / (slope * end)
        } else {
            0.0
        }
    }

    /// Bound of the force that the adhesion of the floor that is left out adds, relative to the force: that of a whole contact of the radius on the
    /// floor at the same indentation (Johnson, Kendall, Roberts).
    fn left_out(&self) -> f64 {
        let (turn, scene) = (&self.turn, self.loading.path.scene);
        let radius = turn.floor.as_ref().map_or(0.0, |floor| floor.radius) / scene.length;
        let force = (8.0 * PI * self.loading.left_out * radius.powi(3)).sqrt();
        force * scene.force() / turn.force.abs()
    }

    /// Adds the floor errors to the error estimates of the contact at the end of loading.
    fn weigh(&mut self) {
        let (Some(resolution), Some(floor)) = (self.loading.floor, &mut self.turn.floor) else {
            return;
        };
        let errors = resolution.errors;
        floor.error = FloorErrors {
            force: errors.turn_floor_force,
            share: errors.turn_share,
            area: errors.turn_area,
        };
        if self.turn.converged() {
            self.turn.error.force += errors.turn_force;
            self.turn.error.indentation += errors.turn_indentation;
        }
    }

    fn cycle(self, plan: CyclePlan) -> Cycle {
        let Self {
            loading,
            turn,
            critical,
            events_before_floor,
        } = self;
        let path = &loading.path;
        let scene = path.scene;
        let (metres, newtons) = (scene.length, scene.force());
        let mut stations: Vec<CycleLoadStep> = path
            .stations
            .iter()
            .map(|station| {
                let floor = events_before(events_before_floor, station);
                CycleLoadStep {
                    events: station.events + floor,
                    ..in_si(scene, station)
                }
            })
            .collect();
        // Under a prescribed force the lens leaves where it detaches: there is no place where it comes to rest.
        if plan.drive == LoadingMode::Force
            && let [.., held, free] = &mut stations[..]
            && free.branch == Branch::Unloading
            && free.pillars_in_contact == 0
        {
            free.indentation = held.indentation;
        }
        let mut events: Vec<CycleEvent> = path.events.iter().map(|e| loading.event(e)).collect();
        if let (Some(place), Some(critical)) = (events_before_floor, &critical) {
            let floor = CycleEvent {
                branch: Branch::Loading,
                kind: CycleEventKind::FloorContact,
                indentation: critical.contact.indentation,
                force: critical.contact.force,
                pillar: None,
                covered_before: 0.0,
            };
            events.insert(place, floor);
        }
        let pull_off = path.strongest.as_ref().map(|pull| {
            let indentation = path.stations[pull.station].indentation;
            let HeldContact {
                pillars, fields, ..
            } = contact_of(path, indentation, &pull.tops);
            PullOff {
                force: stations[pull.station].force,
                indentation: stations[pull.station].indentation,
                station: pull.station,
                pillars,
                fields,
            }
        });
        let last = stations.last().filter(|_| plan.retract && turn.converged());
        let energies = path.energies;
        let joules = newtons * metres;
        let works = path.works;
        let dissipation =
            energies.dissipation + (works.receding - works.advancing) * energies.receded;
        Cycle {
            system: loading.system.clone(),
            plan,
            accuracy: loading.accuracy,
            first_contact: stations.iter().position(|s| s.pillars_in_contact > 0),
            zero_load_indentation: zero_load(&stations),
            separation: last
                .filter(|station| station.pillars_in_contact == 0)
                .map(|station| station.indentation),
            errors: loading.errors(critical.as_ref(), pull_off.as_ref()),
            work_of_separation: energies.separation * joules,
            loop_area: energies.work * joules,
            dissipation: dissipation * joules,
            termination: turn.termination,
            floor: loading.floor,
            warnings: turn.warnings.clone(),
            stations,
            events,
            critical,
            turn,
            pull_off,
        }
    }
}

impl Loading<'_> {
    fn event(&self, event: &TopEvent) -> CycleEvent {
        let scene = self.path.scene;
        let [before, after] = event.parts;
        CycleEvent {
            branch: event.course.branch(),
            kind: if before == 0.0 {
                CycleEventKind::SnapIn
            } else if after == 0.0 {
                CycleEventKind::Release
            } else if after > before {
                CycleEventKind::Growth
            } else {
                CycleEventKind::Recession
            },
            indentation: event.indentation * scene.length,
            force: event.force * scene.force(),
            pillar: Some(HeldPillar {
                index: event.index,
                centre: scene.metres(event.centre),
                covered: after,
            }),
            covered_before: before,
        }
    }

    /// Relative increase of the pull-off force that tilting of columns would cause.
    fn leaning(&self) -> f64 {
        let of_columns = self.system.pillar().compliance == PillarCompliance::Column;
        let pull = self.path.strongest.as_ref().filter(|_| of_columns);
        let common = self.path.scene.height;
        let slenderness = |top: &AttachedTop| (1.0 + top.raised / common) / top.radius;
        pull.map_or(0.0, |pull| {
            let rocking = self.system.column_law().beam_rocking();
            leaning_error(&pull.tops, |top| rocking * slenderness(top))
        })
    }

    /// Relative increases of the pull-off force and of the loop area due to the stress at the corners of elastic pillars; that of the pillar
    /// with the largest one.
    fn corner(&self) -> [f64; 2] {
        let system = self.system;
        let of_elastic = system.pillar().compliance == PillarCompliance::Elastic;
        let Some(pull) = self.path.strongest.as_ref().filter(|_| of_elastic) else {
            return [0.0; 2];
        };
        let share = system.substrate().plane_strain_compliance() / system.contact_compliance();
        let height = |top: &AttachedTop| (self.path.scene.height + top.raised) / top.radius;
        let rims = pull.tops.iter().filter(|top| top.disc.is_none());
        let ratio = rims
            .map(|top| corner_ratio(share, height(top)))
            .fold(1.0, f64::max);
        // The energy that a top stores at its detachment is the square of its force.
        [ratio - 1.0, ratio * ratio - 1.0]
    }

    /// Contributions to the errors of the results.
    fn errors(&self, critical: Option<&CriticalState>, pull_off: Option<&PullOff>) -> CycleErrors {
        let [degree, rim] = self.degree_errors();
        let of_floor =
            |error: fn(&AdhesiveFloorErrors) -> f64| self.floor.map_or(0.0, |it| error(&it.errors));
        let of_critical = critical.map_or([0.0; 2], |critical| {
            self.errors_of_parts(&critical.contact.pillars, critical.contact.force)
        });
        let jumps = self.critical_errors();
        let [critical_force, critical_indentation] = [0, 1].map(|which| {
            let part = [1.0, INDENTATION_SHARE][which];
            let [levels, fronts] = of_critical.map(|error| part * error);
            CycleError {
                degree: degree + jumps[which],
                levels,
                fronts,
                ..CycleError::default()
            }
        });
        // A single top that is fully bonded, or has a free disc inside, depends on no other top's rim.
        let whole = self.path.strongest.as_ref().is_some_and(|pull| {
            let [top] = pull.tops.as_slice() else {
                return false;
            };
            top.domain.is_full() || top.has_free_disc()
        });
        let left_open = LEFT_OPEN * self.path.left_open * self.path.scene.force();
        let columns = self.leaning();
        let corners = self.corner();
        let pull_off_force = pull_off.map_or_else(CycleError::default, |pull| CycleError {
            levels: if whole {
                0.0
            } else {
                LEVEL_ERROR.max(relative(left_open, pull.force))
            },
            rim_angles: ANGLE_ERROR,
            degree: rim,
            fronts: if whole { 0.0 } else { FRONT_ERROR }.max(of_floor(|it| it.pull_off_force)),
            columns,
            corners: corners[0],
        });
        let energies = self.path.energies;
        let loop_area = CycleError {
            levels: LEVEL_ERROR_OF_LOOP + relative(energies.between_levels, energies.work),
            rim_angles: 2.0 * ANGLE_ERROR,
            degree: 2.0 * rim,
            fronts: FRONT_ERROR.max(of_floor(|it| it.loop_area)),
            columns,
            corners: corners[1],
        };
        CycleErrors {
            critical_force,
            critical_indentation,
            pull_off_force,
            loop_area,
        }
    }
}

/// Pull-off forces change by up to 1.3 times the single-top estimate if all tops tilt together (test of [`leaning_error`]).
const LEANING_MARGIN: f64 = 1.5;

/// Relative increase of the total pull-off force that tilting of the tops would cause. Tilting relieves a fraction of the uneven pressure
/// that detaches a rim, so that a top would carry `1/(1 - relieved)` times its force. `rocking` is that of the column of a top.
fn leaning_error(tops: &[AttachedTop], rocking: impl Fn(&AttachedTop) -> f64) -> f64 {
    let [mut more, mut all] = [0.0; 2];
    for top in tops {
        let [mean, x, y] = [0, 1, 2].map(|mode| top.coefficients[mode]);
        let (tilt, pull) = (TILT_MODE * x.hypot(y), -mean / UNIT_FORCE);
        let area = top.radius * top.radius;
        all += area * pull;
        if pull > 0.0 {
            let rocking = rocking(top);
            let relieved = tilt / (tilt + pull) * rocking / (1.0 + rocking);
            more += area * pull * relieved / (1.0 - relieved);
        }
    }
    if more > SOLVER_ERROR * all {
        LEANING_MARGIN * more / all
    } else {
        0.0
    }
}

/// Number of floor events before a load step: 1 if the floor had been reached, otherwise 0.
fn events_before(floor: Option<usize>, station: &LoadStep) -> usize {
    let after_floor = |events: usize| {
        station.events > events || (station.events == events && station.course == Course::Unloading)
    };
    usize::from(floor.is_some_and(after_floor))
}

/// The contact in which the tops carry these loads at an indentation, in solver units.
fn contact_of(path: &Path<'_>, indentation: f64, tops: &[AttachedTop]) -> HeldContact {
    let degree = path.tops.degree();
    let scene = path.scene;
    let disc = |top: &AttachedTop| {
        let (centre, bonded) = match top.disc {
            Some(_) => ([0.0; 2], BondedRegion::All),
            None => (top.centre, Fronts::bonded_region(top.domain)),
        };
        Disc {
            index: top.index,
            centre,
            radius: top.disc.unwrap_or(top.radius),
            coefficients: top.coefficients.clone(),
            gap: None,
            bonded: Some(bonded),
            rim_contact: None,
        }
    };
    let close_degree = tops
        .iter()
        .map(|top| degree_with(top.coefficients.len()))
        .fold(degree, usize::max);
    let discs = tops.iter().map(|top| disc(top).turned(scene.rotation));
    let fields = Fields::new(
        scene.as_asked(),
        indentation,
        discs.collect(),
        close_degree,
        close_degree,
    );
    HeldContact {
        pillars: pillars(path, tops),
        fields: Arc::new(fields),
        floor: None,
    }
}

/// The current contact, including the floor.
fn current_contact(path: &Path<'_>) -> HeldContact {
    let tops = contact_of(path, path.indentation(), &path.attached_tops());
    let Some(load) = path.bonded_load() else {
        return tops;
    };
    let fields = (*tops.fields).clone();
    HeldContact {
        fields: Arc::new(fields.with_floor(load.turned(path.scene.rotation))),
        floor: floor_contact(path),
        ..tops
    }
}

/// The adhering region of the floor, in SI units.
fn floor_contact(path: &Path<'_>) -> Option<FloorContact> {
    let scene = path.scene;
    let floor = path.floor.as_ref()?;
    let patches = patches(Some(&floor.cells));
    let (cells, pressure) = path.bonded_load()?.in_metres(scene.length, scene.pressure);
    let force = path.contact.floor_force();
    Some(FloorContact {
        force: force * scene.force(),
        share: force / path.force(),
        area: floor.area() * scene.length * scene.length,
        patches: patches.count,
        patches_agree: false,
        radius: patches.radius * scene.length,
        smallest_distance_to_rim: patches.rim_distance * scene.length,
        error: FloorErrors::UNKNOWN, // estimated later
        energy_bound: 0.0,
        cells,
        rotation: scene.rotation,
        pressure,
    })
}

/// Pillars in contact with the force on each, sorted by distance from the lens axis.
fn pillars(path: &Path<'_>, tops: &[AttachedTop]) -> Vec<PillarState> {
    let scene = path.scene;
    // The stress at the corner of an elastic pillar differs from that at the rim of a punch.
    let is_known = scene.field.column().rocking == 0.0;
    let pillar = |top: &AttachedTop| {
        let coefficients = &top.coefficients;
        // Centre of the top relative to the centre of the loaded disc.
        let middle = top
            .disc
            .map_or([0.0; 2], |radius| top.centre.map(|x| x / radius));
        let place = middle[0].hypot(middle[1]);
        let centre_is_bonded = match top.disc {
            Some(_) => place < 1.0,
            None => Fronts::bonds_centre(top.domain),
        };
        let centre_density = || {
            let mut values = vec![0.0; coefficients.len()];
            BasisEvaluator::new(degree_with(values.len())).evaluate(middle, &mut values);
            dot(&values, coefficients) / (1.0 - place * place).sqrt()
        };
        let radius = top.disc.unwrap_or(top.radius);
        let edge = || {
            path.tops
                .edge_range(coefficients)
                .map(|q| q * scene.pressure)
        };
        PillarState {
            diameter: 2.0 * top.radius * scene.length,
            height: (scene.height + top.raised) * scene.length,
            index: top.index,
            centre: scene.metres(top.centre),
            status: if top.domain.is_full() {
                PillarStatus::Full
            } else {
                PillarStatus::Partial
            },
            force: UNIT_FORCE * coefficients[0] * radius * radius * scene.force(),
            centre_pressure: if centre_is_bonded {
                centre_density() * scene.pressure
            } else {
                0.0
            },
            stress_intensity_factor: (is_known && top.domain.is_full()).then(edge),
        }
    };
    let mut pillars: Vec<PillarState> = tops.iter().map(pillar).collect();
    nearest_first(&mut pillars, |pillar| pillar, scene.length);
    pillars
}

/// Converts a load step to SI units.
fn in_si(scene: &Scene, station: &LoadStep) -> CycleLoadStep {
    CycleLoadStep {
        branch: station.course.branch(),
        indentation: station.indentation * scene.length,
        force: station.force * scene.force(),
        contact_radius: station.radius * scene.length,
        pillars_in_contact: station.touched[0],
        pillars_partially_in_contact: station.touched[1],
        contact_area: station.area * scene.length * scene.length,
        events: station.events,
        floor: station.floor.map(|floor| HeldFloor {
            force: floor.force * scene.force(),
            area: floor.area * scene.length * scene.length,
            radius: floor.radius * scene.length,
            holes: floor.holes,
        }),
    }
}

/// Sum of the absolute forces on partially bonded tops, N.
fn load_of_partial_tops(pillars: &[PillarState]) -> f64 {
    let partial = pillars.iter().filter(|p| p.status == PillarStatus::Partial);
    partial.map(|pillar| pillar.force.abs()).sum()
}

fn relative(error: f64, value: f64) -> f64 {
    if value == 0.0 {
        0.0
    } else {
        (error / value).abs()
    }
}

/// Indentation at which the force first rises through zero on loading while something is in contact.
fn zero_load(stations: &[CycleLoadStep]) -> Option<f64> {
    let loading = stations.iter().filter(|s| s.branch == Branch::Loading);
    let touched: Vec<&CycleLoadStep> = loading.filter(|s| s.pillars_in_contact > 0).collect();
    if let Some(first) = touched.first()
        && first.force >= 0.0
    {
        return Some(first.indentation);
    }
    let pairs = touched.windows(2);
    let mut rising = pairs.filter(|pair| pair[0].force < 0.0 && pair[1].force >= 0.0);
    rising.next().map(|pair| {
        let part = -pair[0].force / (pair[1].force - pair[0].force);
        pair[0].indentation + part * (pair[1].indentation - pair[0].indentation)
    })
}

fn warnings(system: &System, contact_ratio: f64) -> Vec<Warning> {
    let mut warnings = contact_warnings(contact_ratio);
    let ratio = system.kendall_strain();
    if ratio > LARGEST_STRAIN {
        warnings.push(Warning::AdhesiveStretch { ratio });
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Adhesion;
    use crate::problem::column::Column;
    use crate::theory::reference;

    /// Cells are chosen for the narrowest ring: that of the lowest pillar of the diameter with the narrowest rings. A pillar that is beyond
    /// the reach of the lens, or is pressed down to the floor, does not count.
    #[test]
    fn cells_follow_the_narrowest_ring_of_any_pillar() {
        use crate::problem::{ListedPillar, PillarList};

        let run = Run::default();
        let bodies = [
            (0.0, 6e-6, 2.2e-6),
            (20e-6, 3e-6, 2.4e-6),
            (-20e-6, 3e-6, 2.2e-6),
            (-35e-6, 4e-6, 2.2e-6),
            // Hardly above the floor.
            (45e-6, 5e-6, 1e-12),
            (900e-6, 1e-6, 2.2e-6),
        ];
        let pillar = |(x, diameter, height)| ListedPillar {
            centre: [x, 0.0],
            height,
            diameter,
        };
        for compliance in [
            PillarCompliance::None,
            PillarCompliance::Column,
            PillarCompliance::Elastic,
        ] {
            // The compliance of elastic pillars is available for slender ones.
            let count = match compliance {
                PillarCompliance::Elastic => 4,
                _ => bodies.len(),
            };
            let list = PillarList::new(bodies[..count].iter().copied().map(pillar).collect());
            let lattice = reference::lattice(0.03);
            let system = reference::on_lattice(lattice, reference::INTERMEDIATE, compliance)
                .with_arrangement(list.unwrap())
                .unwrap()
                .with_adhesion(Adhesion::new(0.01).with_floor())
                .unwrap();
            let scene = Scene::new(&system);
            let drive = LoadingMode::Displacement;
            let loading = Loading::new(&system, &scene, Accuracy::Default, drive, &run).unwrap();
            let of = |(_, diameter, height): (f64, f64, f64)| {
                let compliance = system.column_compliance_of(height, diameter);
                let modulus = system.reduced_modulus();
                let pillar = BondedFloorPillar::new(modulus, 0.5 * diameter, height, compliance);
                pillar.unwrap().free_ring(0.01).unwrap().unwrap()
            };
            let expected = bodies[..4]
                .iter()
                .copied()
                .map(of)
                .fold(f64::INFINITY, f64::min);
            let indentation = 4e-6 / scene.length;
            let found = loading
                .narrowest_ring(End::Indentation(indentation))
                .unwrap();
            let found = found * scene.length;
            println!("{compliance:?}: {found:e} {expected:e}");
            assert!((found / expected - 1.0).abs() < 1e-9);
            assert!(expected < 0.9 * of(bodies[0]) && expected < of(bodies[1]));
        }
    }

    /// Compares the stated error with the same path on tilting columns.
    #[test]
    fn the_error_by_columns_that_do_not_lean_covers_the_change() {
        let run = Run::default();
        for (surface_fraction, work) in [(0.03, 0.05), (0.1, 0.05), (0.03, 0.01)] {
            let lattice = reference::lattice(surface_fraction);
            let compliance = PillarCompliance::Column;
            let system = reference::on_lattice(lattice, reference::INTERMEDIATE, compliance);
            let scene = Scene::new(&system);
            let work = work / (scene.pressure * scene.length);
            let works = Works {
                advancing: work,
                receding: work,
            };
            let rocking = system.column_law().beam_rocking();
            let pull_off = |rocking: f64| {
                let column = Column {
                    rocking,
                    ..scene.field.column()
                };
                let fronts = Fronts::new(2, column, works, true);
                let mut path = Path::new(&scene, &run, fronts, FixedQuantity::Indentation).unwrap();
                let depth = End::Indentation(1e-6 / scene.length);
                path.go(Course::Loading, depth, false).unwrap();
                path.go(Course::Unloading, End::Separation, false).unwrap();
                let pull = path.strongest.clone().unwrap();
                (path.stations[pull.station].force, pull.tops)
            };
            let (stiff, tops) = pull_off(0.0);
            let (leaning, _) = pull_off(rocking);
            let (change, stated) = (leaning / stiff - 1.0, leaning_error(&tops, |_| rocking));
            println!("{surface_fraction} {work}: {change:.3} stated {stated:.3}");
            assert!(change.abs() < stated, "{change} {stated}");
            assert!(stated < 4.0 * change.abs() + 0.1, "{change} {stated}");
        }
    }
}
