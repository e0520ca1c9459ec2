//! Loading and unloading with adhesion: sends the curve while it is computed, then states along it, so that the page can move back and
//! forth without another request.

use crate::answers::{self, CaseLine, CriticalLine, SectionLine, StateLine};
use crate::clock::Moment;
use crate::floor::{ExpectedCells, FloorCells};
use crate::refusal::Refusal;
use crate::request::{self, without_adhesion};
use crate::shown::{self, DrawnLattice, Section};
use crate::worker::{Failure, Way, Worker};
use fakir::problem::{CyclePlan, Point, System};
use fakir::state::{
    Branch, ContactState, CriticalState, Cycle, CycleLoadStep, HeldContact, Passage, PillarStatus,
    Progress, Run, Stage,
};
use fakir_case::{Case, Key};
use fakir_figure::Section as Cut;
use fakir_study::result::{CycleSummary, transition};
use serde::Serialize;
use std::cell::LazyCell;
use std::collections::{BTreeMap, HashMap};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Approximate number of states of the loading; fewer if all states together would have more than `PILLARS` pillars. The unloading
/// has more states.
const STATES: f64 = 60.0;
const FEWEST_STATES: f64 = 20.0;
const PILLARS: f64 = 60_000.0;

/// Factor by which states are closer under tension.
const CLOSER: f64 = 8.0;

/// Largest number of states relative to the loading: on soft pillars the unloading is many times as long.
const MOST_TIMES: f64 = 4.0;

/// Smallest time between two transmissions of load steps.
const CURVE_INTERVAL: Duration = Duration::from_millis(120);

/// Number of corners of the outline of the bonded region of a top.
const CORNERS: usize = 12;

/// A cycle, with the contact at some of its load steps.
pub(crate) struct SolvedCycle {
    pub(crate) cycle: Cycle,
    /// Computing time, s.
    pub(crate) wall_time: f64,
    /// Contacts by the index of the load step, in order. They include first contact, critical state, unloading point, the last step on an
    /// adhesive floor and the one after it, pull-off and last detachment.
    kept: BTreeMap<usize, HeldContact>,
    /// Index of the critical state, if it was reached.
    pub(crate) critical: Option<usize>,
    turn: usize,
}

impl SolvedCycle {
    /// Computes the cycle to the critical state and back. The critical state without adhesion is computed first, to estimate the length
    /// of the path. Intermediate results are sent to the page, if `page` is given.
    pub(crate) fn of_page(
        case: &Case,
        worker: &Worker,
        page: Option<&Page<'_>>,
    ) -> Result<(Self, ContactState), Failure> {
        let plain = without_adhesion(case);
        let without = fakir::transition(&plain.system, plain.method, &worker.run())?.contact;
        refuse_many_cells(case, &without, worker)?;
        let start = Moment::now();
        let keeper = Mutex::new(Keeper::new(&case.system, without.indentation));
        if let Some(page) = page {
            page.begin(&case.system, &without);
        }
        let follower = |passage: &Passage<'_>| {
            unpoisoned(&keeper).pass(passage);
            if let Some(page) = page {
                page.pass(&passage.station);
            }
        };
        // Receives the state before the jump onto an adhesive floor.
        let critical = |contact: &ContactState| {
            unpoisoned(&keeper).keep_critical(contact);
            if let Some(page) = page {
                page.reach_critical(contact);
            }
        };
        let listener = |progress: Progress| {
            if let Some(page) = page {
                page.progress(progress);
            }
        };
        let run = Run {
            interim: Some(&critical),
            progress: page.is_some().then_some(&listener),
            ..worker.run()
        };
        let plan = CyclePlan::default();
        let cycle = fakir::follow_cycle(&case.system, plan, case.method, &run, &follower)?;
        drop(run);
        let loading = |station: &CycleLoadStep| station.branch == Branch::Loading;
        let turn = cycle.stations.iter().rposition(loading).unwrap_or(0);
        let keeper = keeper.into_inner().unwrap_or_else(PoisonError::into_inner);
        let at_turn = cycle.critical.as_ref().map(|_| turn);
        let critical = keeper.critical.or(at_turn);
        let mut kept = keeper.kept();
        kept.retain(|place, _| *place < cycle.stations.len());
        if let Some(contact) = contact_in(&cycle.turn) {
            kept.insert(turn, contact);
        }
        let solved = Self {
            cycle,
            wall_time: start.elapsed().as_secs_f64(),
            kept,
            critical,
            turn,
        };
        Ok((solved, without))
    }

    /// Load steps with a state, each with its position on the path: from 0 at first contact to 1 at the unloading point, and to 2 at the
    /// last detachment. The states of each branch are equally spaced.
    fn places(&self) -> Vec<(usize, f64)> {
        let down = self.kept.range(..self.turn).count();
        let up = self.kept.len().saturating_sub(down + 1);
        let load = |number: usize| {
            if number == down {
                1.0
            } else if number < down {
                number as f64 / down as f64
            } else {
                1.0 + (number - down) as f64 / up as f64
            }
        };
        let places = self.kept.keys().enumerate();
        places
            .map(|(number, place)| (*place, load(number)))
            .collect()
    }

    /// Load steps with a state, those nearest to a load first.
    fn nearest_first(&self, load: f64) -> Vec<(usize, f64)> {
        let mut places = self.places();
        places.sort_by(|(_, a), (_, b)| (a - load).abs().total_cmp(&(b - load).abs()));
        places
    }

    /// Load step with a state nearest to a load; the unloading point if there is none.
    pub(crate) fn place_at(&self, load: f64) -> usize {
        let nearest = self.nearest_first(load);
        nearest.first().map_or(self.turn, |(place, _)| *place)
    }

    /// The contact at a load step; values that are not stored are those of the unloading point.
    pub(crate) fn state(&self, place: usize) -> ContactState {
        let mut state = self.cycle.turn.clone();
        let (Some(kept), Some(station)) = (self.kept.get(&place), self.cycle.stations.get(place))
        else {
            return state;
        };
        if place == self.turn {
            return state;
        }
        state.indentation = station.indentation;
        state.force = station.force;
        state.contact_radius = station.contact_radius;
        state.pillars_in_contact = station.pillars_in_contact;
        state.pillars_partially_in_contact = station.pillars_partially_in_contact;
        state.pillars.clone_from(&kept.pillars);
        state.fields = Some(kept.fields.clone());
        state.floor.clone_from(&kept.floor);
        state
    }

    /// First floor contact at a load step, if it is the critical state.
    pub(crate) fn floor_contact(&self, place: usize) -> Option<Point> {
        let critical = self.cycle.critical.as_ref();
        let critical = critical.filter(|_| self.critical == Some(place));
        critical.map(|critical| critical.floor_contact)
    }
}

/// Refuses an adhesive floor with more cells than the worker allows, with the command that computes it.
fn refuse_many_cells(case: &Case, without: &ContactState, worker: &Worker) -> Result<(), Failure> {
    let expected = ExpectedCells::new(&case.system, without.contact_radius);
    let Some(cells) = expected.map(|expected| expected.cells) else {
        return Ok(());
    };
    if cells <= worker.most_cells() {
        return Ok(());
    }
    let words = format!(
        "the adhesive floor has about {cells:.1e} cells, which takes minutes in the browser"
    );
    let command = crate::lines::cycle_texts(case).command;
    Err(Refusal::impossible(words)
        .at(Key::AdhesiveFloor.path())
        .accepted(format!(
            "at most {:.0e} cells: fewer pillars, or no adhesion on the floor; fakir explore has no such limit, nor has\n{}",
            worker.most_cells(),
            command.trim_end()
        ))
        .into())
}

/// The contact in a state, if it is completely known.
fn contact_in(state: &ContactState) -> Option<HeldContact> {
    Some(HeldContact {
        pillars: state.pillars.clone(),
        fields: state.fields.clone()?,
        floor: state.floor.clone(),
    })
}

fn unpoisoned<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Stores the contact at some load steps.
struct Keeper {
    /// Distance between them, m.
    spacing: f64,
    most: usize,
    /// Indentation of the last stored contact, m.
    last: Option<f64>,
    kept: BTreeMap<usize, HeldContact>,
    /// Contacts that are always stored.
    marked: BTreeMap<usize, HeldContact>,
    /// Last load step.
    passed: usize,
    critical: Option<usize>,
    /// Last load step on an adhesive floor.
    on_floor: Option<(usize, HeldContact)>,
    /// Largest tensile force of the unloading so far.
    strongest: Option<(usize, f64, HeldContact)>,
}

impl Keeper {
    /// For loading to the given indentation, m.
    fn new(system: &System, critical_indentation: f64) -> Self {
        let states = (PILLARS / request::expected_pillars(system)).clamp(FEWEST_STATES, STATES);
        let way = critical_indentation - system.first_touch().min(system.pillar().height);
        Self {
            spacing: way.max(1e-3 * system.pillar().height) / states,
            most: (MOST_TIMES * states) as usize,
            last: None,
            kept: BTreeMap::new(),
            marked: BTreeMap::new(),
            passed: 0,
            critical: None,
            on_floor: None,
            strongest: None,
        }
    }

    fn pass(&mut self, passage: &Passage<'_>) {
        let station = &passage.station;
        self.passed = passage.place;
        let kept = LazyCell::new(|| passage.held());
        let is_touched = station.pillars_in_contact > 0 || station.floor.is_some();
        let is_unloading = station.branch == Branch::Unloading;
        let is_released = is_unloading && !is_touched;
        if is_unloading && station.floor.is_some() {
            self.on_floor = Some((passage.place, kept.clone()));
        } else if let Some((last, on_floor)) = self.on_floor.take() {
            self.marked.insert(last, on_floor);
            self.marked.insert(passage.place, kept.clone());
        }
        let strongest = self.strongest.as_ref().map_or(0.0, |(_, force, _)| *force);
        if is_unloading && station.force < strongest {
            self.strongest = Some((passage.place, station.force, kept.clone()));
        }
        let spacing = if station.force < 0.0 {
            self.spacing / CLOSER
        } else {
            self.spacing
        };
        let is_far = self
            .last
            .is_none_or(|last| (station.indentation - last).abs() >= spacing);
        if is_released || (is_touched && is_far) {
            self.last = Some(station.indentation);
            self.kept.insert(passage.place, kept.clone());
        }
        if self.kept.len() > self.most {
            // Keeps every second contact, including the first.
            let mut stays = false;
            self.kept.retain(|_, _| {
                stays = !stays;
                stays
            });
            self.spacing *= 2.0;
        }
    }

    /// The last load step is the critical state, and the jump onto the floor follows.
    fn keep_critical(&mut self, contact: &ContactState) {
        self.critical = Some(self.passed);
        if let Some(kept) = contact_in(contact) {
            self.marked.insert(self.passed, kept);
        }
    }

    fn kept(self) -> BTreeMap<usize, HeldContact> {
        let strongest = self.strongest.map(|(place, _, kept)| (place, kept));
        let mut all = self.kept;
        all.extend(self.marked.into_iter().chain(strongest));
        all
    }
}

/// Intermediate results of a cycle for the page.
pub(crate) struct Page<'a> {
    case: &'a Case,
    worker: &'a Worker,
    reported: Mutex<Reported>,
}

struct Reported {
    start: Moment,
    /// Cumulative fractions of the total time.
    parts: [f64; 4],
    /// Indentations of first contact and, approximately, of the critical state, m.
    ends: [f64; 2],
    /// Load steps that have not been sent yet, and the time of the last transmission.
    curve: Vec<CurveStation>,
    sent: Moment,
    /// Current position of the lens.
    at: Option<CycleLoadStep>,
    /// Iterations of the jump onto the floor so far.
    rounds: f64,
    /// Time at which the cycle was solved and only its errors remained.
    closed: Option<Moment>,
    critical: bool,
}

/// Approximate cumulative fractions of the time for loading, the jump onto an adhesive floor, unloading, and the error estimate; no errors are
/// estimated for a floor on coarse cells.
const WITHOUT_FLOOR: [f64; 4] = [0.4, 0.4, 1.0, 1.0];
const ON_FINE_CELLS: [f64; 4] = [0.05, 0.2, 0.55, 1.0];
const ON_COARSE_CELLS: [f64; 4] = [0.02, 0.35, 1.0, 1.0];

/// Number of iterations of the jump that count as half of its progress.
const HALF_JUMP: f64 = 100.0;

/// Approximate time of the error estimate relative to the time of everything before.
const ERRORS_TIME: f64 = 0.8;

impl Reported {
    /// Approximate progress.
    fn share(&self) -> f64 {
        let [loaded, jumped, unloaded, all] = self.parts;
        if let Some(closed) = self.closed {
            let before = closed.since(self.start).as_secs_f64();
            let part = closed.elapsed().as_secs_f64() / (ERRORS_TIME * before);
            return unloaded + (all - unloaded) * part.min(1.0);
        }
        let Some(at) = &self.at else {
            return 0.0;
        };
        let [first, critical] = self.ends;
        let part = ((at.indentation - first) / (critical - first)).clamp(0.0, 1.0);
        match at.branch {
            Branch::Loading if at.floor.is_some() => jumped,
            Branch::Loading => {
                loaded * part + (jumped - loaded) * self.rounds / (self.rounds + HALF_JUMP)
            }
            Branch::Unloading => jumped + (unloaded - jumped) * (1.0 - part),
        }
    }
}

impl<'a> Page<'a> {
    fn new(case: &'a Case, worker: &'a Worker) -> Self {
        let now = Moment::now();
        Self {
            case,
            worker,
            reported: Mutex::new(Reported {
                start: now,
                parts: WITHOUT_FLOOR,
                ends: [0.0, 1.0],
                curve: Vec::new(),
                sent: now,
                at: None,
                rounds: 0.0,
                closed: None,
                critical: false,
            }),
        }
    }

    /// Start of the path, whose length without adhesion is known.
    fn begin(&self, system: &System, without: &ContactState) {
        let mut reported = unpoisoned(&self.reported);
        let expected = ExpectedCells::new(system, without.contact_radius);
        reported.start = Moment::now();
        reported.parts = match &expected {
            None => WITHOUT_FLOOR,
            Some(cells) if cells.coarse => ON_COARSE_CELLS,
            Some(_) => ON_FINE_CELLS,
        };
        reported.ends = [
            system.first_touch().min(system.pillar().height),
            without.indentation,
        ];
        if let Some(expected_cells) = expected {
            self.worker.send(&ExpectedCellsLine { expected_cells });
        }
    }

    fn pass(&self, station: &CycleLoadStep) {
        let mut reported = unpoisoned(&self.reported);
        reported.at = Some(*station);
        reported.curve.push(CurveStation {
            loading: station.branch == Branch::Loading,
            indentation_m: station.indentation,
            force_N: station.force,
        });
        self.report(&mut reported, CURVE_INTERVAL);
    }

    /// Sends the curve so far, if enough time has passed since the last transmission.
    fn report(&self, reported: &mut Reported, interval: Duration) {
        if let Some(at) = reported.at {
            self.worker.is_at(Way {
                loading: at.branch == Branch::Loading,
                indentation_m: at.indentation,
                share: reported.share(),
            });
        }
        if reported.sent.elapsed() >= interval && !reported.curve.is_empty() {
            reported.sent = Moment::now();
            self.worker.send(&CurveLine {
                curve: std::mem::take(&mut reported.curve),
            });
        }
    }

    fn progress(&self, progress: Progress) {
        let mut reported = unpoisoned(&self.reported);
        match progress.stage {
            Stage::FloorFronts => reported.rounds = progress.step as f64,
            Stage::ErrorEstimate if reported.closed.is_none() => {
                reported.closed = Some(Moment::now());
            }
            _ => {}
        }
        self.report(&mut reported, CURVE_INTERVAL);
        drop(reported);
        if let Some(listener) = self.worker.run().progress {
            listener(progress);
        }
    }

    /// The jump onto the floor follows. It takes longer than everything before; therefore the results so far are
    /// shown.
    fn reach_critical(&self, contact: &ContactState) {
        let mut reported = unpoisoned(&self.reported);
        self.report(&mut reported, Duration::ZERO);
        reported.critical = true;
        let wall_time = reported.start.elapsed().as_secs_f64();
        drop(reported);
        let critical = CriticalState::new(contact.clone());
        self.report_critical(&critical, wall_time);
        self.report_texts();
        let state = StateLine::of_critical(self.case, contact, wall_time);
        self.worker.send(&state);
        let half_width = Cut::half_width(contact);
        let touched = Some(critical.floor_contact);
        // There is none if the computation was cancelled.
        if let Ok(section) = shown::section(contact, half_width, touched, self.worker) {
            self.worker.send(&SectionLine { section });
        }
    }

    fn report_critical(&self, critical: &CriticalState, wall_time: f64) {
        self.worker.send(&CriticalLine {
            critical: transition(critical, None, None, wall_time),
        });
        let system = &critical.contact.system;
        self.worker.send(&answers::transition_line(system));
    }

    fn report_texts(&self) {
        self.worker.send(&CaseLine {
            case: crate::lines::cycle_texts(self.case),
        });
    }
}

#[derive(Serialize)]
struct CurveLine {
    /// Load steps since the last such line.
    curve: Vec<CurveStation>,
}

#[derive(Serialize)]
struct ExpectedCellsLine {
    expected_cells: ExpectedCells,
}

/// A load step.
#[derive(Clone, Copy, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct CurveStation {
    loading: bool,
    indentation_m: f64,
    force_N: f64,
}

#[derive(Serialize)]
struct CycleLine<'a> {
    cycle: DrawnCycle<'a>,
}

/// A cycle for display.
#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct DrawnCycle<'a> {
    /// As `fakir cycle --json` prints it.
    summary: &'a CycleSummary,
    /// Critical force without adhesion.
    critical_force_without_adhesion_N: f64,
    /// Number of the following states.
    states: usize,
    /// Largest force on a pillar in all states, and the largest tensile force, which is negative.
    largest_force_N: f64,
    largest_pull_N: f64,
    pitch_m: f64,
    diameter_m: f64,
    lattice: DrawnLattice,
}

#[derive(Serialize)]
struct LoadStepLine {
    station: LoadStepState,
}

/// The contact at a load step.
#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct LoadStepState {
    /// Index in `stations` of the summary.
    place: usize,
    /// Position on the path: 0 at first contact, 1 at the unloading point, 2 at the last
    /// detachment.
    load: f64,
    /// Lattice indices of the pillars in contact, in a flat list.
    pillars: Vec<i64>,
    pillar_forces_N: Vec<f64>,
    /// Pillars in partial contact.
    parts: Vec<PartialTop>,
    floor_contacts_m: Vec<Point>,
    /// Floor cells in contact, if the floor is adhesive.
    floor: Option<FloorCells>,
    section: Option<Section>,
}

/// A pillar in partial contact.
#[derive(Serialize)]
struct PartialTop {
    /// Index among the pillars in contact.
    pillar: usize,
    /// Fraction of its top that is in contact.
    covered: f64,
    /// Outline of the contact: x and y of its corners relative to the centre of the top, in pillar
    /// radii.
    outline: Vec<f32>,
}

/// `POST /api/cycle`: sends the curve while it is computed, then the critical state and the whole cycle, then states along it, starting with
/// the one at the requested load.
pub(crate) fn cycle(request: &request::AtLoad, worker: &Worker) -> Result<(), Failure> {
    let case = request::case(&request.case, request.table.as_ref())?;
    request.load.check()?;
    shown::preview(
        &without_adhesion(&case),
        request::LoadPoint::default(),
        worker,
    );
    let page = Page::new(&case, worker);
    let (solved, without) = SolvedCycle::of_page(&case, worker, Some(&page))?;
    let is_reported = unpoisoned(&page.reported).critical;
    if let Some(critical) = solved.cycle.critical.as_ref().filter(|_| !is_reported) {
        page.report_critical(critical, solved.wall_time);
    }
    let system = &case.system;
    let states = || solved.kept.values();
    let forces = || states().flat_map(|kept| kept.pillars.iter().map(|pillar| pillar.force));
    worker.send(&CycleLine {
        cycle: DrawnCycle {
            summary: &CycleSummary::new(&solved.cycle, solved.wall_time),
            critical_force_without_adhesion_N: without.force,
            states: solved.kept.len(),
            largest_force_N: forces().fold(0.0, f64::max),
            largest_pull_N: forces().fold(0.0, f64::min),
            pitch_m: system.pitch(),
            diameter_m: system.pillar().diameter,
            lattice: shown::drawn_lattice(system, solved.cycle.turn.contact_radius),
        },
    });
    page.report_texts();
    for (place, load) in solved.nearest_first(request.load.fraction) {
        worker.send(&LoadStepLine {
            station: station_state(&solved, place, load, worker)?,
        });
    }
    Ok(())
}

fn station_state(
    solved: &SolvedCycle,
    place: usize,
    load: f64,
    worker: &Worker,
) -> Result<LoadStepState, Failure> {
    let state = solved.state(place);
    let floor_contact = solved.floor_contact(place);
    // The width is the same for all states of the path.
    let half_width = Cut::half_width(&solved.cycle.turn);
    Ok(LoadStepState {
        place,
        load,
        pillars: shown::indices(&state),
        pillar_forces_N: state.pillars.iter().map(|pillar| pillar.force).collect(),
        parts: parts(solved, place, &state),
        floor_contacts_m: floor_contact
            .map_or_else(Vec::new, |point| state.system.symmetric_copies(point)),
        floor: state.floor.as_ref().map(FloorCells::new),
        section: shown::section(&state, half_width, floor_contact, worker)?,
    })
}

/// Bonded regions of the tops in partial contact.
fn parts(solved: &SolvedCycle, place: usize, state: &ContactState) -> Vec<PartialTop> {
    let attached = solved.cycle.holding(place);
    let covered: HashMap<(i64, i64), f64> =
        attached.iter().map(|it| (it.index, it.covered)).collect();
    let radius = 0.5 * state.system.pillar().diameter;
    let pillars = state.pillars.iter().enumerate();
    pillars
        .filter(|(_, pillar)| pillar.status == PillarStatus::Partial)
        .map(|(number, pillar)| {
            let outline = state.fields.as_ref().map_or_else(Vec::new, |fields| {
                fields.covered_outline(pillar.index, CORNERS)
            });
            let [x, y] = pillar.centre;
            PartialTop {
                pillar: number,
                covered: covered.get(&pillar.index).copied().unwrap_or_default(),
                outline: outline
                    .iter()
                    .flat_map(|at| [at[0] - x, at[1] - y])
                    .map(|distance| (distance / radius) as f32)
                    .collect(),
            }
        })
        .collect()
}
