//! A cycle of loading and unloading with adhesion.

use super::warnings_of;
use crate::VERSION;
use crate::record::{LimitObject, Object, SCHEMA_VERSION};
use fakir::state::{Cycle, CycleEvent, CycleLoadStep, HeldFloor};
use serde::Serialize;

/// A point of the force-indentation curve, which is linear between points: a row of `cycle.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct LoadStepRow {
    /// `loading` or `unloading`.
    pub branch: &'static str,
    /// Indentation, m; negative if tops are stretched above their height.
    pub indentation_m: f64,
    /// Normal force, N; negative in tension.
    pub force_N: f64,
    /// Distance of the farthest point in contact from the lens axis, m.
    pub contact_radius_m: f64,
    /// Number of pillars in contact.
    pub pillars_in_contact: usize,
    /// Number of partially bonded pillars.
    pub pillars_partially_in_contact: usize,
    /// Contact area, m^2.
    pub contact_area_m2: f64,
    /// Number of events so far.
    pub events: usize,
}

impl From<&CycleLoadStep> for LoadStepRow {
    fn from(station: &CycleLoadStep) -> Self {
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

/// A change of contact: a row of `events.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct EventRow {
    /// `loading` or `unloading`.
    pub branch: &'static str,
    /// `snap_in`, `growth`, `recession`, `release` or `floor_contact`.
    pub event: &'static str,
    /// Indentation after the event, m.
    pub indentation_m: f64,
    /// Force after the event, N.
    pub force_N: f64,
    /// First index of the pillar; `None`, like all following fields, if the floor is reached.
    pub i: Option<i64>,
    /// Second index of the pillar.
    pub j: Option<i64>,
    /// Its centre, m from the lens axis.
    pub x_m: Option<f64>,
    /// Its centre, m from the lens axis.
    pub y_m: Option<f64>,
    /// Bonded fraction of the top before the event.
    pub covered_before: Option<f64>,
    /// Bonded fraction of the top after the event.
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

/// A load step at which the floor adheres to the lens: a row of `floor.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct FloorRow {
    /// Index among the load steps, from 0.
    pub station: usize,
    /// `loading` or `unloading`.
    pub branch: &'static str,
    /// Indentation, m.
    pub indentation_m: f64,
    /// Normal force, N.
    pub force_N: f64,
    /// Force on the floor, N; negative in tension.
    pub floor_force_N: f64,
    /// Ratio of the floor force to the normal force.
    pub floor_share: f64,
    /// Contact area of the floor, m^2; `None` after a jump-in that does not resolve it.
    pub floor_contact_area_m2: Option<f64>,
    /// Distance of its farthest point in contact from the lens axis, m.
    pub floor_radius_m: f64,
    /// Number of centres between three pillars of a hexagonal lattice that are in contact.
    pub filled_holes: Option<usize>,
}

impl FloorRow {
    fn new(station: usize, state: &CycleLoadStep, floor: &HeldFloor) -> Self {
        Self {
            station,
            branch: state.branch.name(),
            indentation_m: state.indentation,
            force_N: state.force,
            floor_force_N: floor.force,
            floor_share: floor.force / state.force,
            floor_contact_area_m2: Some(floor.area),
            floor_radius_m: floor.radius,
            filled_holes: floor.holes,
        }
    }

    /// The load steps of a cycle at which the floor adheres to the lens.
    pub fn of(cycle: &Cycle) -> impl Iterator<Item = Self> + '_ {
        let stations = cycle.stations.iter().enumerate();
        let rows =
            stations.filter_map(|(place, it)| Some(Self::new(place, it, it.floor.as_ref()?)));
        let after_jump = cycle.unresolved_jump_area().map(|_| 0);
        rows.enumerate().map(move |(number, row)| Self {
            floor_contact_area_m2: row
                .floor_contact_area_m2
                .filter(|_| Some(number) != after_jump),
            ..row
        })
    }
}

/// An adhesive floor in a cycle.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
struct FloorObject {
    /// Force before jump-in to the floor, N; at the indentation of the jump-in.
    force_before_jump_N: Option<f64>,
    /// The state after jump-in.
    jump: Option<FloorRow>,
    /// The last state with floor contact; `None` if the contact persists.
    last: Option<FloorRow>,
    /// Indentation at the load step after detachment, m: the floor detaches between that and the last one.
    indentation_after_loss_m: Option<f64>,
    /// Force after detachment, N.
    force_after_loss_N: Option<f64>,
    /// Square root of the area of a cell, m.
    cell_m: f64,
    /// Number of cells across the detached ring around a pillar, and along the radius of the first patch.
    cells_across_ring: Option<f64>,
    cells_along_patch: Option<f64>,
    /// Whether the cells are so coarse that only orders of magnitude are meaningful.
    coarse: bool,
    relative_error_estimate: FloorErrorsObject,
    stations: Vec<FloorRow>,
}

/// Estimated relative errors due to the model of the fronts and the cells, from two more cycles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct FloorErrorsObject {
    /// At the end of loading.
    turn_force: f64,
    turn_indentation: f64,
    turn_share: f64,
    turn_contact_area: f64,
    jump_force: f64,
    jump_contact_area: f64,
    /// Of the indentation at which the floor detaches.
    lost_indentation: f64,
}

impl FloorObject {
    fn new(cycle: &Cycle) -> Option<Self> {
        let resolution = cycle.floor?;
        let stations: Vec<FloorRow> = FloorRow::of(cycle).collect();
        let errors = resolution.errors;
        Some(Self {
            force_before_jump_N: cycle.floor_jump().map(|[before, _]| before.force),
            jump: (cycle.floor_jump()).and(stations.first().copied()),
            last: cycle.floor_lost().and(stations.last().copied()),
            indentation_after_loss_m: cycle.floor_lost().map(|[_, after]| after.indentation),
            force_after_loss_N: cycle.floor_lost().map(|[_, after]| after.force),
            cell_m: resolution.cell,
            cells_across_ring: resolution.cells_across_ring,
            cells_along_patch: resolution.cells_along_patch,
            coarse: resolution.is_coarse(),
            relative_error_estimate: FloorErrorsObject {
                turn_force: errors.turn_force,
                turn_indentation: errors.turn_indentation,
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

/// A cycle: what `fakir cycle --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct CycleSummary {
    #[serde(flatten)]
    numbers: Object,
    /// `None` if the floor is not adhesive, or was not touched.
    #[serde(skip_serializing_if = "Option::is_none")]
    floor: Option<FloorObject>,
    limits: Vec<LimitObject>,
    stations: Vec<LoadStepRow>,
    events: Vec<EventRow>,
    warnings: Vec<String>,
    wall_time_s: f64,
    fakir_version: &'static str,
    schema_version: u32,
}

impl CycleSummary {
    /// A cycle with its computing time, s.
    #[must_use]
    pub fn new(cycle: &Cycle, wall_time: f64) -> Self {
        Self {
            numbers: Object::of(cycle),
            floor: FloorObject::new(cycle),
            limits: LimitObject::all(cycle.limits(None)),
            stations: cycle.stations.iter().map(LoadStepRow::from).collect(),
            events: cycle.events.iter().map(EventRow::from).collect(),
            warnings: cycle_warnings(cycle),
            wall_time_s: wall_time,
            fakir_version: VERSION,
            schema_version: SCHEMA_VERSION,
        }
    }

    /// The same with an optional range of the attraction (m).
    #[must_use]
    pub fn with_range(self, cycle: &Cycle, range: Option<f64>) -> Self {
        Self {
            limits: LimitObject::all(cycle.limits(range)),
            ..self
        }
    }
}

/// Warnings of a cycle.
#[must_use]
pub fn cycle_warnings(cycle: &Cycle) -> Vec<String> {
    let mut words = warnings_of(&cycle.warnings, cycle.termination, cycle.unresolved());
    words.extend(cycle.unresolved_jump_area().map(|it| it.to_string()));
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Record;
    use fakir::problem::CyclePlan;
    use fakir::state::{AdhesiveFloorErrors, FloorResolution, Run, Solution};
    use fakir_case::{Case, CaseFile};

    /// The holes filled by a jump-in may depend on a detail: then only its area is unresolved.
    #[test]
    fn a_jump_without_a_resolved_area_keeps_the_cycle() {
        let mut file = CaseFile::parse("case", &Case::example().to_toml()).unwrap();
        for setting in ["pattern.surface_fraction=0.003", "adhesion.work=20mJ/m2"] {
            file.set(setting).unwrap();
        }
        let case = file.case().unwrap();
        let plan = CyclePlan::default();
        let mut cycle = fakir::cycle(&case.system, plan, case.method, &Run::default()).unwrap();
        // As if its floor were adhesive.
        let adhesion = case.system.adhesion().with_floor();
        cycle.system = cycle.system.with_adhesion(adhesion).unwrap();
        let area = 4e-12;
        let place = cycle.stations.len() / 2;
        cycle.stations[place].floor = Some(HeldFloor {
            force: 1e-6,
            area,
            radius: 1e-5,
            holes: Some(3),
        });
        let mut with = |jump_area: f64| {
            cycle.floor = Some(FloorResolution {
                cell: 1e-7,
                cells_across_ring: Some(5.0),
                cells_along_patch: Some(5.0),
                errors: AdhesiveFloorErrors {
                    turn_force: 0.01,
                    turn_indentation: 0.0,
                    turn_floor_force: 0.01,
                    turn_share: 0.01,
                    turn_area: 0.01,
                    jump_force: 0.01,
                    jump_area,
                    lost_indentation: 0.01,
                    pull_off_force: 0.01,
                    loop_area: 0.01,
                },
            });
            assert!(cycle.is_answer());
            let summary = serde_json::to_value(CycleSummary::new(&cycle, 1.0)).unwrap();
            assert_eq!(summary["floor"]["jump"]["filled_holes"], 3);
            let table = Record::of(&cycle).number("jump_floor_area_m2");
            (summary, table)
        };
        let words = |summary: &serde_json::Value| summary["warnings"].to_string();
        let (known, table) = with(0.4);
        assert_eq!(known["floor"]["jump"]["floor_contact_area_m2"], area);
        assert_eq!(table, Some(area));
        assert!(!words(&known).contains("not resolved"));
        let (unknown, table) = with(0.8);
        assert!(unknown["floor"]["jump"]["floor_contact_area_m2"].is_null());
        assert_eq!((table, &unknown["converged"]), (None, &true.into()));
        let message = words(&unknown);
        assert!(
            message.contains("contact area on the floor after the jump onto it is not resolved"),
            "{message}"
        );
    }
}
