//! Kinds of cases as the page shows them: pillars with flat tops, pillars with rounded tops, and flat surfaces.

use crate::floor::FloorCells;
use crate::lines::{self, Texts};
use crate::refusal::Refusal;
use crate::request::{LoadPoint, expected_pillars};
use crate::worker::{Failure, Worker};
use fakir::problem::{
    Accuracy, Arrangement, CyclePlan, Disorder, FloorModel, Load, Method, PlaneLattice, Point,
    System, UnloadingPoint,
};
use fakir::state::{
    AsperityContact, Branch, ContactState, Critical, FlatContact, Normalized, PillarStatus, Run,
    SolveError,
};
use fakir::theory::closed_forms;
use fakir_case::{AsperityCase, Case, FlatCase, Key};
use fakir_figure::{
    Figure, FigureError, PhaseDiagram, ProfileState, SectionDetail, Series, Style, Text, View,
    asperity_map, floor_gap_map, phase_diagram, phase_point, pressure_map, profiles, top_view,
};
use fakir_study::approach::Loadable;
use fakir_study::citations::Topic;
use fakir_study::figures::question_in_figure;
use fakir_study::provenance::method_words;
use fakir_study::record::{AsperityAnswer, FlatAnswer, Object, of_floor};
use fakir_study::result::{asperity_pillars, asperity_press, flat_press, pillars, press};
use serde::Serialize;

/// Number of pillars beyond which an estimate is shown until the contact is solved.
const PREVIEW_PILLARS: f64 = 800.0;

/// Largest number of pillars in a background computation with floor contact.
const FLOOR_PILLARS: f64 = 1500.0;

/// Indentation of the load 1 on a flat surface, relative to the radius of the lens or the punch.
const FLAT_REFERENCE: f64 = 1e-3;

/// How near a contact is to the requested one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stage {
    /// It is the requested one; its errors may not be estimated yet.
    Requested,
    /// It is computed by another method, or without the floor.
    Approximate,
    /// It is that of a smaller load, on the way to a critical state.
    OnTheWay,
}

/// Receives an intermediate contact.
pub(crate) type Interim<'a, C> = Option<&'a (dyn Fn(&C) + Sync)>;

/// A case that the page shows.
pub(crate) trait Shown: Loadable + Sized + Sync {
    /// Sends an estimate, if solving takes long enough.
    fn preview(&self, _: LoadPoint, _: &Worker) {}

    /// Indentation at which the nearest part of the surface comes into contact, m.
    fn touch(&self) -> f64;

    /// Indentation of the load 1 where there is no critical state, m.
    fn reference(&self) -> f64;

    /// The critical state.
    fn find_critical(
        &self,
        worker: &Worker,
        interim: Interim<'_, Self::Contact>,
    ) -> Result<Critical<Self::Contact>, SolveError>;

    /// The contact under a load.
    fn find_contact(
        &self,
        load: Load,
        worker: &Worker,
        interim: Interim<'_, Self::Contact>,
    ) -> Result<Self::Contact, SolveError>;

    /// How near an intermediate contact is to the requested one.
    fn stage(&self, contact: &Self::Contact, load: LoadPoint) -> Stage;

    /// As `fakir press --json` prints it.
    fn summary(&self, contact: &Self::Contact, wall_time: f64) -> Object;

    /// The contact as the map draws it.
    fn drawn(&self, contact: &Self::Contact) -> Drawn;

    /// Its section; `None` for methods that do not resolve it.
    fn section(
        &self,
        contact: &Self::Contact,
        floor_contact: Option<Point>,
        worker: &Worker,
    ) -> Result<Option<Section>, Failure>;

    /// The question for other uses of fakir, about the contact at an indentation (m) or about the critical state.
    fn texts(&self, indentation: Option<f64>) -> Texts;

    /// The case whose contacts are points of curves.
    fn of_curves(&self) -> Self;

    /// Whether a point of a curve takes too long.
    fn is_slow_at(&self, _: f64) -> bool {
        false
    }

    /// A point of a curve at a fraction of the path to the critical state.
    fn point_of_curve(
        &self,
        load: Load,
        _: f64,
        run: &Run<'_>,
    ) -> Result<Self::Contact, SolveError> {
        self.press(load, run)
    }

    /// Force on the floor, N; `None` if it is not computed.
    fn floor_force(&self, contact: &Self::Contact) -> Option<f64>;

    /// The reduced variables `F gamma_int/(h d)`, `a/e` and `zeta/h`, where they are defined.
    fn normalized(&self, _: &Self::Contact) -> Option<[f64; 3]> {
        None
    }

    /// The transition curve of the phase diagram, where it is known.
    fn transition_curve(&self) -> Vec<[f64; 2]> {
        Vec::new()
    }

    /// Indentations and forces on unloading from an indentation, m, where they differ from those of loading.
    fn unloading(&self, _: f64, _: &Worker) -> Result<Option<Vec<[f64; 2]>>, Failure> {
        Ok(None)
    }

    /// Every pillar in contact, as a table.
    fn pillar_table(&self, contact: &Self::Contact) -> Option<Vec<u8>>;

    /// A figure with its name; `question` is what it answers.
    fn figure(
        &self,
        name: &str,
        question: &str,
        contact: &Self::Contact,
        floor_contact: Option<Point>,
        run: &Run<'_>,
    ) -> Result<Figure, Failure>;

    /// Method, topics of its citations and text of the case, for the provenance of files.
    fn provenance(&self) -> (String, Vec<Topic>, String);
}

/// A contact as the map draws it.
#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub(crate) struct Drawn {
    normalized: Option<[f64; 3]>,
    pitch_m: f64,
    diameter_m: f64,
    lattice: DrawnLattice,
    /// Lattice indices of the pillars in contact, in a flat list.
    pillars: Vec<i64>,
    pillar_forces_N: Vec<f64>,
    /// One letter for every pillar: `f` for full, `p` for partial contact.
    pillar_statuses: String,
    /// Centre and radius of the contact on each of these pillars, m, where tops are round.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    contacts_m: Vec<[f64; 3]>,
    /// First floor contact with its symmetric copies; empty if the floor carries load.
    floor_contacts_m: Vec<Point>,
    /// Floor cells in contact, if the floor carries load.
    floor: Option<FloorCells>,
}

/// One letter for the extent of a contact.
fn letter(status: PillarStatus) -> char {
    match status {
        PillarStatus::Partial => 'p',
        _ => 'f',
    }
}

/// Whether the floor carries load past the transition and its force is computed.
pub(crate) fn floor_carries_load(case: &Case) -> bool {
    let applies = case.system.floor_model() == FloorModel::Contact;
    matches!(case.method, Method::Spectral(_)) && applies
}

/// Boundary elements take too long for a whole curve.
pub(crate) fn curve_method(method: Method) -> Method {
    match method {
        Method::Love(_) | Method::Spectral(_) => Method::Spectral(Accuracy::Default),
        other => other,
    }
}

/// Pillars with flat tops.
impl Shown for Case {
    fn preview(&self, load: LoadPoint, worker: &Worker) {
        preview(self, load, worker);
    }

    fn touch(&self) -> f64 {
        match self.method {
            Method::Homogenised => 0.0,
            _ => self.system.first_touch(),
        }
    }

    fn reference(&self) -> f64 {
        self.system.pillar().height
    }

    fn find_critical(
        &self,
        worker: &Worker,
        interim: Interim<'_, ContactState>,
    ) -> Result<Critical<ContactState>, SolveError> {
        let run = Run {
            interim,
            ..worker.run()
        };
        self.transition(&run)
    }

    fn find_contact(
        &self,
        load: Load,
        worker: &Worker,
        interim: Interim<'_, ContactState>,
    ) -> Result<ContactState, SolveError> {
        let run = Run {
            interim,
            ..worker.run()
        };
        self.press(load, &run)
    }

    fn stage(&self, state: &ContactState, load: LoadPoint) -> Stage {
        let meets_floor =
            floor_carries_load(self) && load.fraction > 1.0 && self.no_end().is_none();
        if state.method != self.method || (meets_floor && state.floor.is_none()) {
            Stage::Approximate
        } else {
            Stage::Requested
        }
    }

    fn summary(&self, state: &ContactState, wall_time: f64) -> Object {
        press(state, None, None, wall_time)
    }

    fn drawn(&self, state: &ContactState) -> Drawn {
        let system = &state.system;
        let all = || state.pillars.iter();
        Drawn {
            normalized: self.normalized(state),
            pitch_m: system.pitch(),
            diameter_m: system.pillar().diameter,
            lattice: drawn_lattice(system, state.whole_contact_radius()),
            pillars: indices(state),
            pillar_forces_N: all().map(|pillar| pillar.force).collect(),
            pillar_statuses: all().map(|pillar| letter(pillar.status)).collect(),
            contacts_m: Vec::new(),
            // Outside of the pillars, where other lenses are closest to the floor, there is none.
            floor_contacts_m: match state.floor {
                None if self.no_end().is_none() => {
                    system.symmetric_copies(state.smallest_gap_position)
                }
                _ => Vec::new(),
            },
            floor: state.floor.as_ref().map(FloorCells::new),
        }
    }

    fn section(
        &self,
        state: &ContactState,
        floor_contact: Option<Point>,
        worker: &Worker,
    ) -> Result<Option<Section>, Failure> {
        let mut half_width = fakir_figure::Section::half_width(state);
        if self.no_end().is_some() {
            // Outside of the pillars the floor is ignored.
            let farthest = state.system.pillars_within(half_width).into_iter();
            let reach = farthest.map(|pillar| pillar.centre[0].abs() + pillar.diameter);
            half_width = half_width.min(reach.fold(0.0, f64::max));
        }
        section(state, half_width, floor_contact, worker)
    }

    fn texts(&self, indentation: Option<f64>) -> Texts {
        lines::texts(self, indentation)
    }

    fn of_curves(&self) -> Self {
        // The same method as for displayed states: only the spectral method supports the floor.
        let system = match floor_carries_load(self) {
            true => self.system.clone(),
            false => self.system.with_floor(FloorModel::Ignored),
        };
        let mut case = self.clone();
        (case.system, case.method) = (system, curve_method(self.method));
        case
    }

    fn is_slow_at(&self, fraction: f64) -> bool {
        let pillars = expected_pillars(&self.system);
        floor_carries_load(self) && fraction > 1.0 && fraction * pillars > FLOOR_PILLARS
    }

    fn floor_force(&self, state: &ContactState) -> Option<f64> {
        of_floor(state, |floor| floor.force)
    }

    fn normalized(&self, state: &ContactState) -> Option<[f64; 3]> {
        let system = &state.system;
        let of = Normalized::new(system, state.force, state.contact_radius, state.indentation);
        Some([of.force, of.contact_radius, of.indentation])
    }

    fn transition_curve(&self) -> Vec<[f64; 2]> {
        transition_curve(&self.system)
    }

    fn unloading(&self, from: f64, worker: &Worker) -> Result<Option<Vec<[f64; 2]>>, Failure> {
        // Where there is a critical state, the whole cycle is shown in place of a curve.
        if self.system.adhesion().is_none() || self.no_end().is_none() {
            return Ok(None);
        }
        let plan = unloading_from(from);
        let cycle = fakir::follow_cycle(&self.system, plan, self.method, &worker.run(), &|_| {})?;
        let steps = cycle.stations.iter();
        let steps = steps.map(|step| (step.branch, [step.indentation, step.force]));
        Ok(Some(on_unloading(steps)))
    }

    fn pillar_table(&self, state: &ContactState) -> Option<Vec<u8>> {
        let table = pillars(state).some_csv("pillars.csv");
        table.map(|file| file.contents)
    }

    fn figure(
        &self,
        name: &str,
        question: &str,
        state: &ContactState,
        floor_contact: Option<Point>,
        run: &Run<'_>,
    ) -> Result<Figure, Failure> {
        Ok(match name {
            "profiles" => {
                let section = ProfileState {
                    label: question_in_figure(question),
                    state,
                    floor_contact,
                };
                profiles(&[section], run)
            }
            "top-view" => top_view(state, View::Contact, run),
            "floor-gap-map" => floor_gap_map(state, run),
            "phase-diagram" => Ok(phase_figure(self, state)),
            _ => pressure_map(state, floor_contact),
        }?)
    }

    fn provenance(&self) -> (String, Vec<Topic>, String) {
        let method = method_words(self.method);
        (method, Topic::of_case(self), self.to_toml())
    }
}

/// Pillars with rounded tops.
impl Shown for AsperityCase {
    fn touch(&self) -> f64 {
        self.field.first_touch()
    }

    fn reference(&self) -> f64 {
        self.height
    }

    fn find_critical(
        &self,
        worker: &Worker,
        interim: Interim<'_, AsperityContact>,
    ) -> Result<Critical<AsperityContact>, SolveError> {
        let run = worker.run();
        if let Some(interim) = interim {
            // Without tension the floor is not reached before the lens is that deep.
            let load = Load::Indentation(self.height.max(self.touch()));
            if let Ok(contact) = self.field.press_quickly(load, self.accuracy, None, &run) {
                interim(&contact);
            }
        }
        self.transition(&run)
    }

    fn find_contact(
        &self,
        load: Load,
        worker: &Worker,
        interim: Interim<'_, AsperityContact>,
    ) -> Result<AsperityContact, SolveError> {
        let run = worker.run();
        if let Some(interim) = interim
            && let Ok(contact) = self.field.press_quickly(load, self.accuracy, None, &run)
        {
            interim(&contact);
        }
        self.press(load, &run)
    }

    fn stage(&self, _: &AsperityContact, load: LoadPoint) -> Stage {
        if self.no_end().is_some() {
            Stage::Requested
        } else if load.is_critical() {
            Stage::OnTheWay
        } else if load.fraction > 1.0 && self.computes_floor_load() {
            Stage::Approximate
        } else {
            Stage::Requested
        }
    }

    fn summary(&self, contact: &AsperityContact, wall_time: f64) -> Object {
        asperity_press(AsperityAnswer::of(self, contact), wall_time)
    }

    fn drawn(&self, contact: &AsperityContact) -> Drawn {
        let tops = self.field.asperities();
        let touched = || {
            let all = contact.asperities.iter().enumerate();
            all.filter(|(_, top)| top.radius > 0.0)
        };
        let listed = tops.iter().map(|top| {
            let [x, y] = top.apex;
            [x, y, 2.0 * top.rim_radius.unwrap_or(0.0)]
        });
        let floor_contact = contact.floor_gap.map(|floor| floor.position);
        Drawn {
            normalized: None,
            pitch_m: self.number(Key::Pitch).unwrap_or_else(|| self.spacing()),
            diameter_m: self.number(Key::PillarDiameter).unwrap_or(0.0),
            lattice: DrawnLattice::of_list(listed.collect()),
            pillars: touched().flat_map(|(place, _)| [place as i64, 0]).collect(),
            pillar_forces_N: touched().map(|(_, top)| top.force).collect(),
            pillar_statuses: touched().map(|(_, top)| letter(top.status)).collect(),
            contacts_m: touched()
                .map(|(_, top)| [top.centre[0], top.centre[1], top.radius])
                .collect(),
            floor_contacts_m: match contact.floor {
                None => floor_contact.into_iter().collect(),
                Some(_) => Vec::new(),
            },
            floor: contact.floor.as_ref().map(FloorCells::new),
        }
    }

    fn section(
        &self,
        contact: &AsperityContact,
        floor_contact: Option<Point>,
        worker: &Worker,
    ) -> Result<Option<Section>, Failure> {
        let (array, run) = (&self.field, worker.run());
        let (depth, detail) = (self.height, SectionDetail::Screen);
        fakir_figure::Section::of_asperities(array, contact, depth, floor_contact, detail, &run)
            .map(|section| Some(section.into()))
            .map_err(Failure::from)
    }

    fn texts(&self, indentation: Option<f64>) -> Texts {
        lines::saved_texts(self.to_toml(), indentation)
    }

    fn of_curves(&self) -> Self {
        self.clone()
    }

    fn point_of_curve(
        &self,
        load: Load,
        fraction: f64,
        run: &Run<'_>,
    ) -> Result<AsperityContact, SolveError> {
        // Curves have no errors; past the transition the load of the floor is part of them.
        match fraction > 1.0 && self.computes_floor_load() {
            true => self.press(load, run),
            false => self.field.press_quickly(load, self.accuracy, None, run),
        }
    }

    fn floor_force(&self, contact: &AsperityContact) -> Option<f64> {
        of_floor(contact, |floor| floor.force)
    }

    fn unloading(&self, from: f64, worker: &Worker) -> Result<Option<Vec<[f64; 2]>>, Failure> {
        if self.field.adhesion().is_none() {
            return Ok(None);
        }
        let plan = unloading_from(from);
        let cycle = self.field.cycle(plan, self.accuracy, &worker.run())?;
        let steps = cycle.load_steps.iter();
        let steps = steps.map(|step| (step.branch, [step.indentation, step.force]));
        Ok(Some(on_unloading(steps)))
    }

    fn pillar_table(&self, contact: &AsperityContact) -> Option<Vec<u8>> {
        let table = asperity_pillars(AsperityAnswer::of(self, contact)).some_csv("pillars.csv");
        table.map(|file| file.contents)
    }

    fn figure(
        &self,
        name: &str,
        _: &str,
        contact: &AsperityContact,
        _: Option<Point>,
        _: &Run<'_>,
    ) -> Result<Figure, Failure> {
        match name {
            "top-view" | "pressure-map" => Ok(asperity_map(&self.field, contact)),
            _ => Err(no_such_figure("rounded tops", "pressure-map or top-view")),
        }
    }

    fn provenance(&self) -> (String, Vec<Topic>, String) {
        let topics = Topic::of_asperities(self, None);
        (
            "spectral method on rounded tops".to_owned(),
            topics,
            self.to_toml(),
        )
    }
}

/// A flat surface.
impl Shown for FlatCase {
    fn touch(&self) -> f64 {
        0.0
    }

    fn reference(&self) -> f64 {
        let lens = self.system.lens();
        FLAT_REFERENCE * lens.radius().unwrap_or_else(|| lens.widest())
    }

    fn find_critical(
        &self,
        worker: &Worker,
        _: Interim<'_, FlatContact>,
    ) -> Result<Critical<FlatContact>, SolveError> {
        self.transition(&worker.run())
    }

    fn find_contact(
        &self,
        load: Load,
        worker: &Worker,
        _: Interim<'_, FlatContact>,
    ) -> Result<FlatContact, SolveError> {
        self.press(load, &worker.run())
    }

    fn stage(&self, _: &FlatContact, _: LoadPoint) -> Stage {
        Stage::Requested
    }

    fn summary(&self, contact: &FlatContact, wall_time: f64) -> Object {
        let system = &self.system;
        flat_press(&FlatAnswer { system, contact }, None, wall_time)
    }

    fn drawn(&self, contact: &FlatContact) -> Drawn {
        let radius = contact.contact_radius;
        let disc = (radius > 0.0).then_some([0.0, 0.0, radius]);
        let disc = || disc.into_iter();
        Drawn {
            normalized: None,
            // The width of the map without contact.
            pitch_m: 0.03 * self.reference() / FLAT_REFERENCE,
            diameter_m: 0.0,
            lattice: DrawnLattice::of_list(disc().map(|[x, y, a]| [x, y, 2.0 * a]).collect()),
            pillars: disc().flat_map(|_| [0, 0]).collect(),
            pillar_forces_N: disc().map(|_| contact.force).collect(),
            pillar_statuses: disc().map(|_| 'f').collect(),
            contacts_m: disc().collect(),
            floor_contacts_m: Vec::new(),
            floor: None,
        }
    }

    fn section(
        &self,
        contact: &FlatContact,
        _: Option<Point>,
        _: &Worker,
    ) -> Result<Option<Section>, Failure> {
        let detail = SectionDetail::Screen;
        let section = fakir_figure::Section::of_flat(&self.system, contact, detail);
        Ok(Some(section.into()))
    }

    fn texts(&self, indentation: Option<f64>) -> Texts {
        lines::saved_texts(self.to_toml(), indentation)
    }

    fn of_curves(&self) -> Self {
        self.clone()
    }

    fn floor_force(&self, _: &FlatContact) -> Option<f64> {
        None
    }

    fn unloading(&self, from: f64, worker: &Worker) -> Result<Option<Vec<[f64; 2]>>, Failure> {
        if self.system.adhesion().is_none() {
            return Ok(None);
        }
        let cycle = self.system.cycle(&unloading_from(from), &worker.run())?;
        let steps = cycle.load_steps.iter();
        let steps = steps.map(|step| (step.branch, [step.indentation, step.force]));
        Ok(Some(on_unloading(steps)))
    }

    fn pillar_table(&self, _: &FlatContact) -> Option<Vec<u8>> {
        None
    }

    fn figure(
        &self,
        _: &str,
        _: &str,
        _: &FlatContact,
        _: Option<Point>,
        _: &Run<'_>,
    ) -> Result<Figure, Failure> {
        let accepted =
            "section and curve as they are shown, or `fakir press` of the saved case file";
        Err(no_such_figure("a flat surface", accepted))
    }

    fn provenance(&self) -> (String, Vec<Topic>, String) {
        let topics = Topic::of_flat(self, None);
        ("one disc of contact".to_owned(), topics, self.to_toml())
    }
}

/// Loading to an indentation, m, and unloading.
fn unloading_from(indentation: f64) -> CyclePlan {
    CyclePlan {
        turn: UnloadingPoint::Indentation(indentation),
        ..CyclePlan::default()
    }
}

/// Indentations and forces of the load steps on unloading.
fn on_unloading(steps: impl Iterator<Item = (Branch, [f64; 2])>) -> Vec<[f64; 2]> {
    steps
        .filter(|(branch, _)| *branch == Branch::Unloading)
        .map(|(_, point)| point)
        .collect()
}

fn no_such_figure(surface: &str, accepted: &str) -> Failure {
    Refusal::impossible(format!("there is no such figure of {surface}"))
        .at("file")
        .accepted(accepted)
        .into()
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

impl DrawnLattice {
    /// Pillars with these positions and diameters, m.
    fn of_list(listed: Vec<[f64; 3]>) -> Self {
        Self {
            vectors_m: [[0.0; 2]; 2],
            origin_m: [0.0; 2],
            range: None,
            missing: Vec::new(),
            listed,
        }
    }
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

/// Indentation, m, from which fractions of the path to the critical state are counted.
fn start<S: Shown>(case: &S, critical: f64) -> f64 {
    let touch = case.touch();
    if touch < critical { touch } else { 0.0 }
}

/// Indentation, m, at a fraction of the path from first contact to the critical state.
pub(crate) fn indentation<S: Shown>(case: &S, critical: f64, fraction: f64) -> f64 {
    let touch = start(case, critical);
    touch + fraction * (critical - touch)
}

/// Fraction of the path from first contact to the critical state at an indentation, m; 0 before contact.
pub(crate) fn position(case: &Case, critical: f64, indentation: f64) -> f64 {
    let touch = start(case, critical);
    ((indentation - touch) / (critical - touch)).max(0.0)
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

/// Numbers equally spaced on a logarithmic scale, including both ends.
pub(crate) fn spaced([first, last]: [f64; 2], count: usize) -> Vec<f64> {
    let steps = count.saturating_sub(1) as f64;
    (0..count)
        .map(|k| first * (last / first).powf(k as f64 / steps))
        .collect()
}

/// A point in the phase diagram: `a/e` and `F gamma_int/(h d)`.
fn reduced(system: &System, force: f64, radius: f64) -> [f64; 2] {
    let reduced = Normalized::new(system, force, radius, 0.0);
    [reduced.contact_radius, reduced.force]
}

/// Points of the transition curve of the phase diagram. It is a closed form, which applies only to the infinite hexagonal lattice on half-spaces.
pub(crate) fn transition_curve(system: &System) -> Vec<[f64; 2]> {
    let known = system.hexagonal_lattice().is_some() && !system.has_layers();
    let ratios = spaced([0.01, 1000.0], if known { 200 } else { 0 });
    let curve = ratios.into_iter().map(|ratio| {
        let radius = ratio * system.pitch();
        let force = closed_forms::transition_force(system, radius);
        reduced(system, force, radius)
    });
    curve.collect()
}

/// The phase diagram with the displayed state.
fn phase_figure(case: &Case, state: &ContactState) -> Figure {
    let fraction = case.system.pattern().surface_fraction();
    let label = format!("*φ* = {fraction:.4}");
    phase_diagram(&PhaseDiagram {
        system: case.system.clone(),
        critical: vec![Series::new(
            Text::from(label),
            vec![phase_point(&case.system, state.force, state.contact_radius)],
            Style::marks(0),
        )],
        paths: Vec::new(),
        shares: Vec::new(),
    })
}
