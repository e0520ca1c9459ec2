//! A cycle of loading and unloading with adhesion.

use super::warnings_of;
use crate::VERSION;
use crate::record::LimitObject;
use fakir::problem::Method;
use fakir::state::{Cycle, CycleError, CycleEvent, CycleStation, HeldFloor};
use serde::Serialize;

/// A point of the curve of force over indentation, which is linear between one and the next: a row of `cycle.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct StationRow {
    /// `loading` or `unloading`.
    pub branch: &'static str,
    /// Indentation, m; negative where the lens pulls at the tops above their height.
    pub indentation_m: f64,
    /// Normal force, N; negative where the lens is held back.
    pub force_N: f64,
    /// Distance of the farthest point in contact from the lens axis, m.
    pub contact_radius_m: f64,
    /// Number of pillars in contact.
    pub pillars_in_contact: usize,
    /// Number of those in contact in part.
    pub pillars_partially_in_contact: usize,
    /// Area in contact, m^2.
    pub contact_area_m2: f64,
    /// How many events had happened.
    pub events: usize,
}

impl From<&CycleStation> for StationRow {
    fn from(station: &CycleStation) -> Self {
        Self {
            branch: station.branch.name(),
            indentation_m: station.indentation,
            force_N: station.force,
            contact_radius_m: station.contact_radius,
            pillars_in_contact: station.pillars_in_contact,
            pillars_partially_in_contact: station.pillars_partially_in_contact,
            contact_area_m2: station.contact_area,
            events: station.events,
        }
    }
}

/// A change of what is in contact: a row of `events.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct EventRow {
    /// `loading` or `unloading`.
    pub branch: &'static str,
    /// `snap_in`, `growth`, `recession`, `release` or `floor_contact`.
    pub event: &'static str,
    /// Indentation after it, m.
    pub indentation_m: f64,
    /// Force after it, N.
    pub force_N: f64,
    /// First index of the pillar; none where the floor is reached, as all that follows.
    pub i: Option<i64>,
    /// Second index of the pillar.
    pub j: Option<i64>,
    /// Its centre, m from the lens axis.
    pub x_m: Option<f64>,
    /// Its centre, m from the lens axis.
    pub y_m: Option<f64>,
    /// Part of its top that was in contact before.
    pub covered_before: Option<f64>,
    /// Part of its top that is in contact afterwards.
    pub covered: Option<f64>,
}

impl From<&CycleEvent> for EventRow {
    fn from(event: &CycleEvent) -> Self {
        let pillar = event.pillar;
        Self {
            branch: event.branch.name(),
            event: event.kind.name(),
            indentation_m: event.indentation,
            force_N: event.force,
            i: pillar.map(|pillar| pillar.index.0),
            j: pillar.map(|pillar| pillar.index.1),
            x_m: pillar.map(|pillar| pillar.centre[0]),
            y_m: pillar.map(|pillar| pillar.centre[1]),
            covered_before: pillar.map(|_| event.covered_before),
            covered: pillar.map(|pillar| pillar.covered),
        }
    }
}

/// A station at which the floor sticks to the lens: a row of `floor.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct FloorRow {
    /// Its place among the stations, from 0 on.
    pub station: usize,
    /// `loading` or `unloading`.
    pub branch: &'static str,
    /// Indentation, m.
    pub indentation_m: f64,
    /// Normal force, N.
    pub force_N: f64,
    /// Force on the floor, N; negative where it pulls.
    pub floor_force_N: f64,
    /// That over the normal force.
    pub floor_share: f64,
    /// Area of the floor in contact, m^2.
    pub floor_contact_area_m2: f64,
    /// Distance of its farthest point in contact from the lens axis, m.
    pub floor_radius_m: f64,
    /// Middles between three pillars that are in contact.
    pub filled_holes: usize,
}

impl FloorRow {
    fn new(station: usize, state: &CycleStation, floor: &HeldFloor) -> Self {
        Self {
            station,
            branch: state.branch.name(),
            indentation_m: state.indentation,
            force_N: state.force,
            floor_force_N: floor.force,
            floor_share: floor.force / state.force,
            floor_contact_area_m2: floor.area,
            floor_radius_m: floor.radius,
            filled_holes: floor.holes,
        }
    }

    /// The stations of a cycle at which the floor sticks to the lens.
    pub fn of(cycle: &Cycle) -> impl Iterator<Item = Self> + '_ {
        let stations = cycle.stations.iter().enumerate();
        stations.filter_map(|(place, it)| Some(Self::new(place, it, it.floor.as_ref()?)))
    }
}

/// A floor that sticks, in a cycle.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct FloorObject {
    /// Force before the lens jumps onto it, N; at the indentation of the jump.
    force_before_jump_N: Option<f64>,
    /// The state after the jump.
    jump: Option<FloorRow>,
    /// The last state with the floor in contact; none if it still is.
    last: Option<FloorRow>,
    /// Indentation at the station after it is lost, m: it is lost between that and the last one.
    indentation_after_loss_m: Option<f64>,
    /// Force after it is lost, N.
    force_after_loss_N: Option<f64>,
    /// Root of the area of a cell, m.
    cell_m: f64,
    /// Cells across the free ring round a pillar, and along the radius of the first patch.
    cells_across_ring: f64,
    cells_along_patch: f64,
    /// Whether cells are so coarse that the figures are orders of magnitude.
    coarse: bool,
    relative_error_estimate: FloorErrorsObject,
    stations: Vec<FloorRow>,
}

/// Estimated relative errors by the model of the fronts and by the cells: of two more cycles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct FloorErrorsObject {
    /// At the end of loading.
    turn_force: f64,
    turn_share: f64,
    turn_contact_area: f64,
    jump_force: f64,
    jump_contact_area: f64,
    /// Of the indentation at which the floor is lost.
    lost_indentation: f64,
}

impl FloorObject {
    fn new(cycle: &Cycle) -> Option<Self> {
        let resolution = cycle.floor?;
        let stations: Vec<FloorRow> = FloorRow::of(cycle).collect();
        let errors = resolution.errors;
        Some(Self {
            force_before_jump_N: cycle.floor_jump().map(|[before, _]| before.force),
            jump: stations.first().copied(),
            last: cycle.floor_lost().and(stations.last().copied()),
            indentation_after_loss_m: cycle.floor_lost().map(|[_, after]| after.indentation),
            force_after_loss_N: cycle.floor_lost().map(|[_, after]| after.force),
            cell_m: resolution.cell,
            cells_across_ring: resolution.cells_across_ring,
            cells_along_patch: resolution.cells_along_patch,
            coarse: resolution.is_coarse(),
            relative_error_estimate: FloorErrorsObject {
                turn_force: errors.turn_force,
                turn_share: errors.turn_share,
                turn_contact_area: errors.turn_area,
                jump_force: errors.jump_force,
                jump_contact_area: errors.jump_area,
                lost_indentation: errors.lost_indentation,
            },
            stations,
        })
    }
}

/// Estimated relative errors of a figure of a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CycleErrorObject {
    /// Of the numerical solution: the sum of the next three.
    pub numerical: f64,
    /// From the levels at which fronts on pillar tops stop.
    pub levels: f64,
    /// From the angles at which rims are looked at.
    pub rim_angles: f64,
    /// From the degree of the pressure on pillar tops.
    pub degree: f64,
    /// Of the model: from the shapes that fronts can take.
    pub model_fronts: f64,
    /// Of the model: from pillars that lean where they are pulled on one side, which columns do not.
    pub model_columns: f64,
}

impl From<CycleError> for CycleErrorObject {
    fn from(error: CycleError) -> Self {
        Self {
            numerical: error.numerical(),
            levels: error.levels,
            rim_angles: error.rim_angles,
            degree: error.degree,
            model_fronts: error.fronts,
            model_columns: error.columns,
        }
    }
}

/// Estimated relative errors of the figures of a cycle; none of what the cycle does not have.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct CycleErrorsObject {
    critical_force: Option<CycleErrorObject>,
    critical_indentation: Option<CycleErrorObject>,
    pull_off_force: Option<CycleErrorObject>,
    hysteresis: Option<CycleErrorObject>,
}

/// A cycle: what `fakir approach --retract --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct CycleSummary {
    method: &'static str,
    work_of_adhesion_J_per_m2: f64,
    receding_work_of_adhesion_J_per_m2: f64,
    drive: &'static str,
    /// None unless a machine drives the lens.
    machine_stiffness_N_per_m: Option<f64>,
    first_contact_indentation_m: Option<f64>,
    first_contact_force_N: Option<f64>,
    /// Where a lens without load comes to rest.
    zero_load_indentation_m: Option<f64>,
    /// None, as all of the critical state, if the lens does not go down so far.
    critical_force_N: Option<f64>,
    critical_indentation_m: Option<f64>,
    critical_contact_radius_m: Option<f64>,
    critical_pillars_in_contact: Option<usize>,
    critical_pillars_partially_in_contact: Option<usize>,
    turn_force_N: f64,
    turn_indentation_m: f64,
    turn_contact_radius_m: f64,
    turn_pillars_in_contact: usize,
    turn_pillars_partially_in_contact: usize,
    /// Whether the floor ended the loading before what was planned.
    stopped_by_floor: bool,
    /// None if nothing pulls.
    pull_off_force_N: Option<f64>,
    pull_off_indentation_m: Option<f64>,
    pull_off_pillars_in_contact: Option<usize>,
    /// None if something is still in contact.
    last_release_indentation_m: Option<f64>,
    work_of_separation_J: f64,
    /// Area of the loop of force over indentation; none of a path that is not closed.
    hysteresis_J: Option<f64>,
    dissipation_J: f64,
    /// Relative difference of the last two; none of a path that is not closed.
    certificate: Option<f64>,
    relative_error_estimate: CycleErrorsObject,
    /// None if the floor does not stick, or was not touched.
    #[serde(skip_serializing_if = "Option::is_none")]
    floor: Option<FloorObject>,
    limits: Vec<LimitObject>,
    stations: Vec<StationRow>,
    events: Vec<EventRow>,
    warnings: Vec<String>,
    converged: bool,
    /// The quantity that is not resolved, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    unresolved: Option<&'static str>,
    wall_time_s: f64,
    fakir_version: &'static str,
}

impl CycleSummary {
    /// A cycle that took so many seconds.
    #[must_use]
    pub fn new(cycle: &Cycle, wall_time: f64) -> Self {
        let adhesion = cycle.system.adhesion();
        let first = cycle
            .first_contact
            .and_then(|place| cycle.stations.get(place));
        let critical = cycle.critical.as_ref();
        let turn = &cycle.turn;
        let pull_off = cycle.pull_off.as_ref();
        let certificate = cycle.certificate();
        let errors = &cycle.errors;
        Self {
            method: Method::Spectral(cycle.accuracy).name(),
            work_of_adhesion_J_per_m2: adhesion.work,
            receding_work_of_adhesion_J_per_m2: adhesion.receding(),
            drive: cycle.plan.drive.name(),
            machine_stiffness_N_per_m: cycle.plan.drive.stiffness(),
            first_contact_indentation_m: first.map(|station| station.indentation),
            first_contact_force_N: first.map(|station| station.force),
            zero_load_indentation_m: cycle.zero_load_indentation,
            critical_force_N: critical.map(|it| it.contact.force),
            critical_indentation_m: critical.map(|it| it.contact.indentation),
            critical_contact_radius_m: critical.map(fakir::state::CriticalState::contact_radius),
            critical_pillars_in_contact: critical.map(|it| it.contact.pillars_in_contact),
            critical_pillars_partially_in_contact: critical
                .map(|it| it.contact.pillars_partially_in_contact),
            turn_force_N: turn.force,
            turn_indentation_m: turn.indentation,
            turn_contact_radius_m: turn.contact_radius,
            turn_pillars_in_contact: turn.pillars_in_contact,
            turn_pillars_partially_in_contact: turn.pillars_partially_in_contact,
            stopped_by_floor: cycle.stopped_by_floor,
            pull_off_force_N: pull_off.map(|it| it.force),
            pull_off_indentation_m: pull_off.map(|it| it.indentation),
            pull_off_pillars_in_contact: pull_off.map(|it| it.pillars.len()),
            last_release_indentation_m: cycle.separation,
            work_of_separation_J: cycle.work_of_separation,
            hysteresis_J: certificate.map(|_| cycle.loop_area),
            dissipation_J: cycle.dissipation,
            certificate,
            relative_error_estimate: CycleErrorsObject {
                critical_force: critical.map(|_| errors.critical_force.into()),
                critical_indentation: critical.map(|_| errors.critical_indentation.into()),
                pull_off_force: pull_off.map(|_| errors.pull_off_force.into()),
                hysteresis: certificate.map(|_| errors.loop_area.into()),
            },
            floor: FloorObject::new(cycle),
            limits: LimitObject::all(cycle.limits(None)),
            stations: cycle.stations.iter().map(StationRow::from).collect(),
            events: cycle.events.iter().map(EventRow::from).collect(),
            warnings: cycle_warnings(cycle),
            converged: cycle.converged(),
            unresolved: cycle.unresolved().map(|it| it.quantity),
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }

    /// The same where the range of the attraction (m) is known, or is not.
    #[must_use]
    pub fn with_range(self, cycle: &Cycle, range: Option<f64>) -> Self {
        Self {
            limits: LimitObject::all(cycle.limits(range)),
            ..self
        }
    }
}

/// What to be careful about, of a cycle.
#[must_use]
pub fn cycle_warnings(cycle: &Cycle) -> Vec<String> {
    warnings_of(&cycle.warnings, cycle.termination, cycle.unresolved())
}
