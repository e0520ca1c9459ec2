//! Loading and unloading with adhesion: the curve while the lens goes along it, then states all along it, so that the page can go forth
//! and back without another question.

use crate::answers::{self, CaseLine, CriticalLine, DrawnLattice, Section};
use crate::jobs::{Failure, Worker};
use crate::request;
use fakir::problem::{CyclePlan, Point, System};
use fakir::state::{Branch, ContactState, Cycle, HeldContact, Passage, PillarStatus};
use fakir_case::Case;
use fakir_figure::Section as Cut;
use fakir_study::result::{CycleSummary, TransitionSummary};
use serde::Serialize;
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};
use std::time::{Duration, Instant};

/// The loading has about so many states, fewer where that makes more pillars than `PILLARS` in all of them; the unloading has more.
const STATES: f64 = 60.0;
const FEWEST_STATES: f64 = 20.0;
const PILLARS: f64 = 60_000.0;

/// Where the lens is held back states are so many times closer.
const CLOSER: f64 = 8.0;

/// No more states than this many times those of the loading are kept: on soft pillars the way back is many times as long.
const MOST_TIMES: f64 = 4.0;

/// Stations are sent together, not more often than this.
const CURVE_INTERVAL: Duration = Duration::from_millis(120);

/// Corners of the outline of what is held of a top.
const CORNERS: usize = 12;

/// A cycle, with what is in contact at some of its stations.
pub(crate) struct SolvedCycle {
    pub(crate) cycle: Cycle,
    /// The time it took, s.
    pub(crate) wall_time: f64,
    /// By the place of the station, in order: first contact, turn, pull-off and last release are among them.
    held: BTreeMap<usize, HeldContact>,
    turn: usize,
}

impl SolvedCycle {
    /// Solves for the cycle to the critical state and back, and before that for the critical state that there is without adhesion, which
    /// says how far the way is. `told` is called at every station.
    pub(crate) fn of_page(
        case: &Case,
        worker: &Worker,
        told: impl Fn(&Passage<'_>),
    ) -> Result<(Self, ContactState), Failure> {
        let plain = without_adhesion(case);
        let without = fakir::transition(&plain.system, plain.method, &worker.run())?.contact;
        let start = Instant::now();
        let keeper = RefCell::new(Keeper::new(&case.system, without.indentation));
        let follower = |passage: &Passage<'_>| {
            told(passage);
            keeper.borrow_mut().pass(passage);
        };
        let (plan, run) = (CyclePlan::default(), worker.run());
        let cycle = fakir::follow_cycle(&case.system, plan, case.method, &run, &follower)?;
        let mut held = keeper.into_inner().held;
        held.retain(|place, _| *place < cycle.stations.len());
        let loading = |station: &fakir::state::CycleStation| station.branch == Branch::Loading;
        let turn = cycle.stations.iter().rposition(loading).unwrap_or(0);
        if let Some(fields) = &cycle.turn.fields {
            let (pillars, fields) = (cycle.turn.pillars.clone(), fields.clone());
            held.insert(turn, HeldContact { pillars, fields });
        }
        if let Some(pull_off) = &cycle.pull_off {
            let (pillars, fields) = (pull_off.pillars.clone(), pull_off.fields.clone());
            held.insert(pull_off.station, HeldContact { pillars, fields });
        }
        let solved = Self {
            cycle,
            wall_time: start.elapsed().as_secs_f64(),
            held,
            turn,
        };
        Ok((solved, without))
    }

    /// The stations with a state, each with its place on the way: from 0 at first contact to 1 at the turn, and on to 2 at the last release.
    /// Steps from one state to the next are even on each branch.
    fn places(&self) -> Vec<(usize, f64)> {
        let down = self.held.range(..self.turn).count();
        let up = self.held.len().saturating_sub(down + 1);
        let load = |number: usize| {
            if number == down {
                1.0
            } else if number < down {
                number as f64 / down as f64
            } else {
                1.0 + (number - down) as f64 / up as f64
            }
        };
        let places = self.held.keys().enumerate();
        places
            .map(|(number, place)| (*place, load(number)))
            .collect()
    }

    /// The stations with a state, those nearest to a load first.
    fn nearest_first(&self, load: f64) -> Vec<(usize, f64)> {
        let mut places = self.places();
        places.sort_by(|(_, a), (_, b)| (a - load).abs().total_cmp(&(b - load).abs()));
        places
    }

    /// The contact at the station nearest to a load; that at the turn if there is none.
    pub(crate) fn state_at(&self, load: f64) -> ContactState {
        let nearest = self.nearest_first(load);
        let found = nearest.first();
        found.map_or_else(|| self.cycle.turn.clone(), |(place, _)| self.state(*place))
    }

    /// The contact at a station; what it does not tell is that of the turn.
    fn state(&self, place: usize) -> ContactState {
        let mut state = self.cycle.turn.clone();
        let (Some(held), Some(station)) = (self.held.get(&place), self.cycle.stations.get(place))
        else {
            return state;
        };
        state.indentation = station.indentation;
        state.force = station.force;
        state.contact_radius = station.contact_radius;
        state.pillars_in_contact = station.pillars_in_contact;
        state.pillars_partially_in_contact = station.pillars_partially_in_contact;
        state.pillars.clone_from(&held.pillars);
        state.fields = Some(held.fields.clone());
        state
    }

    /// Where the floor is touched at a station, if it just is.
    fn floor_contact(&self, place: usize) -> Option<Point> {
        let critical = self.cycle.critical.as_ref();
        let critical = critical.filter(|_| place == self.turn);
        critical.map(|critical| critical.floor_contact)
    }

    /// Whether the state at a load is that at the turn.
    pub(crate) fn is_turn(&self, load: f64) -> bool {
        let nearest = self.nearest_first(load);
        nearest.first().is_none_or(|(place, _)| *place == self.turn)
    }
}

/// Keeps what is in contact at some stations.
struct Keeper {
    /// How far apart they are, m.
    spacing: f64,
    most: usize,
    /// Indentation where something was kept last, m.
    last: Option<f64>,
    held: BTreeMap<usize, HeldContact>,
}

impl Keeper {
    /// For a lens that goes down to this indentation, m.
    fn new(system: &System, critical_indentation: f64) -> Self {
        let states = (PILLARS / request::expected_pillars(system)).clamp(FEWEST_STATES, STATES);
        let way = critical_indentation - system.first_touch().min(system.pillar().height);
        Self {
            spacing: way.max(1e-3 * system.pillar().height) / states,
            most: (MOST_TIMES * states) as usize,
            last: None,
            held: BTreeMap::new(),
        }
    }

    fn pass(&mut self, passage: &Passage<'_>) {
        let station = &passage.station;
        let is_touched = station.pillars_in_contact > 0;
        let is_released = station.branch == Branch::Unloading && !is_touched;
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
            self.held.insert(passage.place, passage.held());
        }
        if self.held.len() > self.most {
            // Every second one stays, the first among them.
            let mut stays = false;
            self.held.retain(|_, _| {
                stays = !stays;
                stays
            });
            self.spacing *= 2.0;
        }
    }
}

/// The same without adhesion.
pub(crate) fn without_adhesion(case: &Case) -> Case {
    let mut plain = case.clone();
    plain.system = case.system.without_adhesion();
    plain
}

#[derive(Serialize)]
struct CurveLine {
    /// The stations since the last such line.
    curve: Vec<CurveStation>,
}

/// A station as it is passed.
#[derive(Clone, Copy, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct CurveStation {
    loading: bool,
    indentation_m: f64,
    force_N: f64,
}

#[derive(Serialize)]
struct CycleLine<'a> {
    cycle: Shown<'a>,
}

/// The cycle as it is shown.
#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct Shown<'a> {
    /// As `fakir approach --retract --json` prints it.
    summary: &'a CycleSummary,
    /// What the critical force would be if nothing stuck.
    critical_force_without_adhesion_N: f64,
    /// Number of states that follow.
    states: usize,
    /// The largest force on a pillar in all of them, and the largest pull, which is negative.
    largest_force_N: f64,
    largest_pull_N: f64,
    pitch_m: f64,
    diameter_m: f64,
    lattice: DrawnLattice,
}

#[derive(Serialize)]
struct StationLine {
    station: StationState,
}

/// What is in contact at a station.
#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct StationState {
    /// Its place in the summary's `stations`.
    place: usize,
    /// Its place on the way: 0 at first contact, 1 at the turn, 2 at the last release.
    load: f64,
    /// Lattice indices of the pillars in contact, one after the other.
    pillars: Vec<i64>,
    pillar_forces_N: Vec<f64>,
    /// Those in contact in part.
    parts: Vec<PartialTop>,
    floor_contacts_m: Vec<Point>,
    section: Option<Section>,
}

/// A pillar in contact in part.
#[derive(Serialize)]
struct PartialTop {
    /// Its place among the pillars in contact.
    pillar: usize,
    /// The part of its top that is in contact.
    covered: f64,
    /// Outline of that part: x and y of its corners from the middle of the top, pillar radii.
    outline: Vec<f32>,
}

/// `POST /api/cycle`: the curve as it is passed, then the critical state and the whole cycle, then states along it, the one at the load that
/// is asked for first.
pub(crate) fn cycle(request: &request::AtLoad, worker: &Worker) -> Result<(), Failure> {
    let case = request::case(&request.case)?;
    request.load.check()?;
    answers::preview(
        &without_adhesion(&case),
        request::LoadPoint::default(),
        worker,
    );
    let bundle = RefCell::new((Vec::new(), Instant::now()));
    let send = |stations: &mut Vec<CurveStation>| {
        worker.send(&CurveLine {
            curve: std::mem::take(stations),
        });
    };
    let told = |passage: &Passage<'_>| {
        let (stations, last) = &mut *bundle.borrow_mut();
        stations.push(CurveStation {
            loading: passage.station.branch == Branch::Loading,
            indentation_m: passage.station.indentation,
            force_N: passage.station.force,
        });
        if last.elapsed() >= CURVE_INTERVAL {
            *last = Instant::now();
            send(stations);
        }
    };
    let (solved, without) = SolvedCycle::of_page(&case, worker, told)?;
    if let Some(critical) = &solved.cycle.critical {
        worker.send(&CriticalLine {
            critical: TransitionSummary::new(critical, solved.wall_time),
        });
    }
    worker.send(&answers::transition_line(&case.system));
    let system = &case.system;
    let states = || solved.held.values();
    let forces = || states().flat_map(|held| held.pillars.iter().map(|pillar| pillar.force));
    worker.send(&CycleLine {
        cycle: Shown {
            summary: &CycleSummary::new(&solved.cycle, solved.wall_time),
            critical_force_without_adhesion_N: without.force,
            states: solved.held.len(),
            largest_force_N: forces().fold(0.0, f64::max),
            largest_pull_N: forces().fold(0.0, f64::min),
            pitch_m: system.pitch(),
            diameter_m: system.pillar().diameter,
            lattice: answers::drawn_lattice(system, solved.cycle.turn.contact_radius),
        },
    });
    worker.send(&CaseLine {
        case: crate::lines::cycle_texts(&case),
    });
    for (place, load) in solved.nearest_first(request.load.fraction) {
        worker.send(&StationLine {
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
) -> Result<StationState, Failure> {
    let state = solved.state(place);
    let floor_contact = solved.floor_contact(place);
    // The width stays while the lens goes along its way.
    let half_width = Cut::half_width(&solved.cycle.turn);
    Ok(StationState {
        place,
        load,
        pillars: answers::indices(&state),
        pillar_forces_N: state.pillars.iter().map(|pillar| pillar.force).collect(),
        parts: parts(solved, place, &state),
        floor_contacts_m: floor_contact
            .map_or_else(Vec::new, |point| state.system.symmetric_copies(point)),
        section: answers::section(&state, half_width, floor_contact, worker)?,
    })
}

/// What is held of those tops that are in contact in part.
fn parts(solved: &SolvedCycle, place: usize, state: &ContactState) -> Vec<PartialTop> {
    let held = solved.cycle.holding(place);
    let covered: HashMap<(i64, i64), f64> = held.iter().map(|it| (it.index, it.covered)).collect();
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
