//! Results of a cycle of loading and unloading with adhesion.

use super::contact::{ContactState, PillarState, Termination, Warning};
use super::critical::CriticalState;
use super::fields::Fields;
use super::floor_contact::FloorContact;
use super::limit::{Limit, limits_of_adhesion};
use super::resolution::{Remedy, Unresolved};
use crate::problem::{Accuracy, CyclePlan, LoadingMode, Point, System};
use std::sync::Arc;

/// Direction of the cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Branch {
    /// Increasing indentation.
    Loading,
    /// Decreasing indentation.
    Unloading,
}

impl Branch {
    /// `"loading"` or `"unloading"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Loading => "loading",
            Self::Unloading => "unloading",
        }
    }
}

/// A point of the force-indentation curve. The force is linear between consecutive points, which therefore define the complete curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CycleLoadStep {
    /// The branch of the point.
    pub branch: Branch,
    /// Indentation, m; negative if tops are in contact above their undeformed height.
    pub indentation: f64,
    /// Normal force, N; negative for tension.
    pub force: f64,
    /// Distance of the farthest point in contact from the lens axis, m.
    pub contact_radius: f64,
    /// Number of pillars in contact.
    pub pillars_in_contact: usize,
    /// Number of pillars in partial contact.
    pub pillars_partially_in_contact: usize,
    /// Area in contact, m^2.
    pub contact_area: f64,
    /// Number of [`Cycle::events`] up to this point.
    pub events: usize,
    /// The contact with an adhesive floor.
    pub floor: Option<HeldFloor>,
}

/// The contact with the floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldFloor {
    /// Force on the floor, N; negative for tension.
    pub force: f64,
    /// Area in contact, m^2.
    pub area: f64,
    /// Distance of the farthest cell in contact from the lens axis, m.
    pub radius: f64,
    /// Number of centres of three pillars of a hexagonal lattice in contact; `None` for other arrangements.
    pub holes: Option<usize>,
}

/// Resolution of the floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FloorResolution {
    /// Root of the area of a cell, m.
    pub cell: f64,
    /// Number of cells across the narrowest free annulus around a pillar, from the closed form of an annulus without pressure. With fewer than
    /// [`ENOUGH`](Self::ENOUGH), the results are correct in order of magnitude only: the floor detaches too late. `None` for a floor without
    /// adhesion.
    pub cells_across_ring: Option<f64>,
    /// Number of cells along the radius of the first patch, from its energy; `None` for a floor without adhesion.
    pub cells_along_patch: Option<f64>,
    /// Errors of the results due to the cell size and the model of fronts.
    pub errors: AdhesiveFloorErrors,
}

/// Estimated relative errors of results for the floor. Without adhesion of the floor they are twice the largest difference from two
/// additional cycles on cells 1.5 and 2 times as large. For an adhesive floor they are the largest differences from two additional cycles
/// on cells 1.5 times as large, with a work of adhesion for fronts on the floor that is 7 % smaller and 7 % larger. This is the uncertainty of the work of
/// adhesion at which fronts move; close to a barrier between rings of holes it determines whether one ring more is in contact. The error is
/// 1 (unknown) for results that are not found in both cycles, and for all results on [coarse](FloorResolution::is_coarse) cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdhesiveFloorErrors {
    /// Error of the force at the end of loading; 0 if it is prescribed.
    pub turn_force: f64,
    /// Error of the indentation at the end of loading; 0 if it is prescribed.
    pub turn_indentation: f64,
    /// Error of the force on the floor at the end of loading.
    pub turn_floor_force: f64,
    /// Error of the fraction of the load carried by the floor there.
    pub turn_share: f64,
    /// Error of the area of the floor in contact at the end of loading.
    pub turn_area: f64,
    /// Error of the force after the jump.
    pub jump_force: f64,
    /// Error of the area in contact after the jump.
    pub jump_area: f64,
    /// Error of the indentation at which the floor detaches.
    pub lost_indentation: f64,
    /// Error of the pull-off force.
    pub pull_off_force: f64,
    /// Error of the loop area.
    pub loop_area: f64,
}

impl AdhesiveFloorErrors {
    /// Only orders of magnitude are known.
    pub(crate) const UNKNOWN: Self = Self {
        turn_force: 1.0,
        turn_indentation: 1.0,
        turn_floor_force: 1.0,
        turn_share: 1.0,
        turn_area: 1.0,
        jump_force: 1.0,
        jump_area: 1.0,
        lost_indentation: 1.0,
        pull_off_force: 1.0,
        loop_area: 1.0,
    };

    #[cfg(test)]
    pub(crate) fn all(&self) -> [f64; 10] {
        [
            self.turn_force,
            self.turn_indentation,
            self.turn_floor_force,
            self.turn_share,
            self.turn_area,
            self.jump_force,
            self.jump_area,
            self.lost_indentation,
            self.pull_off_force,
            self.loop_area,
        ]
    }
}

impl FloorResolution {
    /// Number of cells across the annulus for which the error of the fronts is a few per cent.
    pub const ENOUGH: f64 = 3.0;
    /// Number of cells across the annulus that are used if affordable.
    pub const WANTED: f64 = 5.0;
    /// Side of the largest cells, in pillar radii.
    pub const LARGEST_CELL: f64 = 0.7;
    /// Approximate number of cells under the contact in the critical state that are affordable by default: the limit applies to the points
    /// of a transform, of which there are nine for every such cell.
    pub const MOST_CELLS: f64 = 2e6 / 9.0;

    /// Whether results are correct in order of magnitude only.
    #[must_use]
    pub fn is_coarse(self) -> bool {
        self.cells_across_ring
            .is_some_and(|cells| cells < Self::ENOUGH)
    }
}

/// Kind of an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CycleEventKind {
    /// A pillar jumps into contact.
    SnapIn,
    /// The contact with a pillar grows.
    Growth,
    /// The contact with a pillar recedes.
    Recession,
    /// A pillar detaches.
    Release,
    /// The lens touches the floor.
    FloorContact,
}

impl CycleEventKind {
    /// `"snap_in"`, `"growth"`, `"recession"`, `"release"` or `"floor_contact"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::SnapIn => "snap_in",
            Self::Growth => "growth",
            Self::Recession => "recession",
            Self::Release => "release",
            Self::FloorContact => "floor_contact",
        }
    }
}

/// A change of the contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CycleEvent {
    /// The branch of the event.
    pub branch: Branch,
    /// Kind of the event.
    pub kind: CycleEventKind,
    /// Indentation after the event, m; equal for all events of a cascade.
    pub indentation: f64,
    /// Force after the event, N.
    pub force: f64,
    /// The pillar, with the fraction of its top in contact after the event; `None` for floor contact.
    pub pillar: Option<HeldPillar>,
    /// The fraction of its top in contact before the event.
    pub covered_before: f64,
}

/// A pillar in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldPillar {
    /// Lattice indices `(i, j)` of [`HexagonalLattice::centre`](crate::problem::lattice::HexagonalLattice::centre).
    pub index: (i64, i64),
    /// Centre, m from the lens axis.
    pub centre: Point,
    /// Fraction of its top in contact, 0 to 1.
    pub covered: f64,
}

/// The contact at a load step.
#[derive(Debug, Clone)]
pub struct HeldContact {
    /// The pillars in contact with their forces, by increasing distance from the lens axis.
    pub pillars: Vec<PillarState>,
    /// Displacement, gap and pressure as functions of position.
    pub fields: Arc<Fields>,
    /// The contact with an adhesive floor. Its errors are available only after the complete cycle.
    pub floor: Option<FloorContact>,
}

/// A load step of a cycle in progress: see [`follow_cycle`](crate::follow_cycle).
pub struct Passage<'a> {
    /// Its index in [`Cycle::stations`].
    pub place: usize,
    /// The load step.
    pub station: CycleLoadStep,
    pub(crate) held: &'a dyn Fn() -> HeldContact,
}

impl Passage<'_> {
    /// The contact at this load step. Takes about as long as copying the pressures on all pillars.
    #[must_use]
    pub fn held(&self) -> HeldContact {
        (self.held)()
    }
}

/// The state of largest tension during unloading.
#[derive(Debug, Clone)]
pub struct PullOff {
    /// Force, N: the minimum during unloading, negative.
    pub force: f64,
    /// Indentation, m.
    pub indentation: f64,
    /// Its index in [`Cycle::stations`].
    pub station: usize,
    /// The pillars in contact with their forces, by increasing distance from the lens axis.
    pub pillars: Vec<PillarState>,
    /// Displacement, gap and pressure as functions of position.
    pub fields: Arc<Fields>,
}

/// Estimated relative errors of one result, by their origin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CycleError {
    /// Due to the discrete positions of fronts on pillar tops.
    pub levels: f64,
    /// Due to the discrete angles at which rims are evaluated.
    pub rim_angles: f64,
    /// Due to the degree of the pressure on pillar tops.
    pub degree: f64,
    /// Model error due to the assumed shapes of fronts.
    pub fronts: f64,
    /// Model error due to the tilt of pillars under eccentric tension, which [columns](crate::problem::PillarCompliance::Column) neglect.
    pub columns: f64,
    /// Model error due to the stress at the corner of [elastic pillars](crate::problem::PillarCompliance::Elastic), which is less singular
    /// than that at the rim of a punch on a half-space: how much larger the result would be for pillars whose rims have flaws of 1 % of their
    /// radius.
    pub corners: f64,
}

impl CycleError {
    /// Error of the numerical solution of the model.
    #[must_use]
    pub fn numerical(&self) -> f64 {
        self.levels + self.rim_angles + self.degree
    }

    /// Model error.
    #[must_use]
    pub fn model(&self) -> f64 {
        self.fronts + self.columns + self.corners
    }
}

/// Estimated relative errors of the results of a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CycleErrors {
    /// Error of the critical force.
    pub critical_force: CycleError,
    /// Error of the critical indentation.
    pub critical_indentation: CycleError,
    /// Error of the pull-off force.
    pub pull_off_force: CycleError,
    /// Error of the loop area.
    pub loop_area: CycleError,
}

/// A cycle of loading and unloading with adhesion on the pillar tops.
#[derive(Debug, Clone)]
pub struct Cycle {
    /// The system.
    pub system: System,
    /// The plan of the cycle.
    pub plan: CyclePlan,
    /// Accuracy setting.
    pub accuracy: Accuracy,
    /// The force-indentation curve in order; two points at the same indentation where contacts snap.
    pub stations: Vec<CycleLoadStep>,
    /// Changes of the contact, in order.
    pub events: Vec<CycleEvent>,
    /// Index of the first load step with contact.
    pub first_contact: Option<usize>,
    /// Indentation at which the force first increases through zero during loading, with contact, m: the equilibrium of a lens without load.
    pub zero_load_indentation: Option<f64>,
    /// The critical state, if the cycle reaches it.
    pub critical: Option<CriticalState>,
    /// The contact at the end of loading.
    pub turn: ContactState,
    /// Resolution of the floor; `None` if the floor is not touched.
    pub floor: Option<FloorResolution>,
    /// The state of largest tension during unloading; `None` without unloading or without tension.
    pub pull_off: Option<PullOff>,
    /// Indentation of the last detachment, m; `None` if some contact remains.
    pub separation: Option<f64>,
    /// Separation work, J: the tensile part of the work of the force during unloading.
    pub work_of_separation: f64,
    /// The hysteresis: area enclosed by the force-indentation curve, J. For an open path, the work done.
    pub loop_area: f64,
    /// Energy dissipated by all changes of contact, J: the released elastic energy minus the work of separation, and the difference between
    /// the work of adhesion for breaking and for making contact. It is summed independently, and equals the loop area of a closed path.
    pub dissipation: f64,
    /// Estimated relative errors.
    pub errors: CycleErrors,
    /// Why the path ended.
    pub termination: Termination,
    /// Validity warnings.
    pub warnings: Vec<Warning>,
}

/// Difference between loop area and dissipation, divided by the larger one.
pub(super) fn energy_balance(loop_area: f64, dissipation: f64) -> f64 {
    let largest = loop_area.abs().max(dissipation.abs());
    if largest > 0.0 {
        (loop_area - dissipation).abs() / largest
    } else {
        0.0
    }
}

impl Cycle {
    /// The jump into contact with an adhesive floor: the load steps before and after it, at the same indentation.
    #[must_use]
    pub fn floor_jump(&self) -> Option<[&CycleLoadStep; 2]> {
        let sticks = self.system.adhesion().floor;
        let on_floor = |station: &CycleLoadStep| sticks && station.floor.is_some();
        let after = self.stations.iter().position(on_floor)?;
        Some([&self.stations[after.checked_sub(1)?], &self.stations[after]])
    }

    /// The last load step with contact with the floor, and the following one.
    #[must_use]
    pub fn floor_lost(&self) -> Option<[&CycleLoadStep; 2]> {
        let last = self.stations.iter().rposition(|s| s.floor.is_some())?;
        Some([&self.stations[last], self.stations.get(last + 1)?])
    }

    /// Whether the solver converged.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.termination == Termination::Converged
    }

    /// The first result of a converged solution that is [not resolved](Unresolved), among the end of loading, the critical state, pull-off,
    /// hysteresis, and the results for an adhesive floor. Results for such a floor whose error is unknown are not checked; a warning
    /// reports them.
    #[must_use]
    pub fn unresolved(&self) -> Option<Unresolved> {
        if !self.converged() {
            return None;
        }
        let errors = &self.errors;
        let of = |there: bool, error: CycleError| if there { error.numerical() } else { 0.0 };
        let critical = self.critical.is_some();
        // The results for the floor have separate errors.
        let turn = self.turn.unresolved().filter(|_| self.turn.floor.is_none());
        let numbers = [
            Unresolved::at_the_end_of_loading(turn),
            ("critical force", of(critical, errors.critical_force)),
            (
                "critical indentation",
                of(critical, errors.critical_indentation),
            ),
            (
                "pull-off force",
                of(self.pull_off.is_some(), errors.pull_off_force),
            ),
            (
                "hysteresis",
                of(self.hysteresis().is_some(), errors.loop_area),
            ),
        ];
        let (lost, jumped) = (self.floor_lost().is_some(), self.floor_jump().is_some());
        // If the floor is partly in tension and partly in compression, its force is a small difference of large forces; its error is
        // relative to the total force.
        let share = self.turn.floor.as_ref().map_or(1.0, |it| it.share.abs());
        let of_floor = self.available_floor_errors().into_iter().flat_map(|it| {
            [
                ("force at the end of loading", it.turn_force),
                ("indentation at the end of loading", it.turn_indentation),
                (
                    "force on the floor at the end of loading",
                    share.min(1.0) * it.turn_floor_force,
                ),
                (
                    "force after the jump onto the floor",
                    if jumped { it.jump_force } else { 0.0 },
                ),
                (
                    "indentation at which the floor detaches",
                    if lost { it.lost_indentation } else { 0.0 },
                ),
            ]
        });
        Unresolved::among(numbers.into_iter().chain(of_floor), self.finer())
    }

    /// The area of the floor in contact after the jump, if it is [not resolved](Unresolved). The choice of holes in a jump may depend on a
    /// detail, so that the error of this area may be large although all other results are accurate: in this case, the area alone is not a
    /// result.
    #[must_use]
    pub fn unresolved_jump_area(&self) -> Option<Unresolved> {
        self.floor_jump()?;
        let error = self.available_floor_errors()?.jump_area;
        let quantity = "contact area on the floor after the jump onto it";
        Unresolved::among([(quantity, error)], self.finer())
    }

    /// Errors of the results for an adhesive floor that are known.
    fn available_floor_errors(&self) -> Option<AdhesiveFloorErrors> {
        let errors = self.floor?.errors;
        (errors != AdhesiveFloorErrors::UNKNOWN).then_some(errors)
    }

    /// The remedy for a result that is not resolved.
    fn finer(&self) -> Remedy {
        match self.accuracy {
            // The fronts on adhesive tops do not depend on the accuracy setting.
            _ if self.floor.is_none() => Remedy::HigherLoad,
            Accuracy::Default => Remedy::AccurateSetting,
            Accuracy::Accurate if !self.system.adhesion().floor => Remedy::HigherLoad,
            Accuracy::Accurate => Remedy::CollapsedFloor,
        }
    }

    /// Area of the loop of force over indentation, J. `None` for a path that is not closed, and under a prescribed force, where the lens leaves at once.
    #[must_use]
    pub fn hysteresis(&self) -> Option<f64> {
        self.separation?;
        (self.plan.drive != LoadingMode::Force).then_some(self.loop_area)
    }

    /// Work against tensile forces during unloading, J, but for a prescribed force, where the lens leaves at once.
    #[must_use]
    pub fn work_of_separation(&self) -> Option<f64> {
        (self.plan.drive != LoadingMode::Force).then_some(self.work_of_separation)
    }

    /// Energy balance error of a closed path: difference between loop area and dissipation, divided by the loop area. It consists of
    /// rounding and solver errors; `None` if the path is not closed.
    #[must_use]
    pub fn certificate(&self) -> Option<f64> {
        self.separation?;
        Some(energy_balance(self.loop_area, self.dissipation))
    }

    /// The pillars in contact at a load step, in the order in which they came into contact.
    #[must_use]
    pub fn holding(&self, station: usize) -> Vec<HeldPillar> {
        let happened = self.stations.get(station).map_or(0, |at| at.events);
        let mut attached: Vec<HeldPillar> = Vec::new();
        let mut place = std::collections::HashMap::new();
        for pillar in self.events[..happened].iter().filter_map(|e| e.pillar) {
            let at = *place.entry(pillar.index).or_insert_with(|| {
                attached.push(pillar);
                attached.len() - 1
            });
            attached[at] = pillar;
        }
        attached.retain(|pillar| pillar.covered > 0.0);
        attached
    }

    /// The detachments of pillars, in order.
    #[must_use]
    pub fn release_order(&self) -> Vec<&CycleEvent> {
        let released = |event: &&CycleEvent| event.kind == CycleEventKind::Release;
        self.events.iter().filter(released).collect()
    }

    /// The validity limits of the model, and the corresponding values in this cycle. `range` is that of the attraction (m), if it is known.
    #[must_use]
    pub fn limits(&self, range: Option<f64>) -> Vec<Limit> {
        let reach = |s: &CycleLoadStep| {
            s.floor
                .map_or(0.0, |floor| floor.radius)
                .max(s.contact_radius)
        };
        let farthest = self.stations.iter().map(reach);
        limits_of_adhesion(&self.system, farthest.fold(0.0, f64::max), range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Adhesion, Method, UnloadingPoint};
    use crate::state::{ErrorEstimate, Run, Solution};
    use crate::theory::reference::intermediate;

    /// A cycle that turns at an indentation of 10 nm, on one pillar.
    fn cycle() -> Cycle {
        let system = intermediate(0.01).with_adhesion(Adhesion::new(50e-3));
        let plan = CyclePlan {
            turn: UnloadingPoint::Indentation(10e-9),
            ..CyclePlan::default()
        };
        crate::cycle(&system.unwrap(), plan, Method::default(), &Run::default()).unwrap()
    }

    #[test]
    fn a_part_without_a_first_digit_is_no_answer() {
        type Place = (&'static str, fn(&mut Cycle) -> &mut f64);
        let cycle = cycle();
        assert!(cycle.is_answer());
        let places: [Place; 3] = [
            ("force at the end of loading", |cycle| {
                &mut cycle.turn.error.force
            }),
            ("pull-off force", |cycle| {
                &mut cycle.errors.pull_off_force.levels
            }),
            ("hysteresis", |cycle| &mut cycle.errors.loop_area.degree),
        ];
        for (quantity, place) in places {
            let mut doubtful = cycle.clone();
            *place(&mut doubtful) = 0.6;
            assert!(doubtful.converged() && !doubtful.is_answer());
            assert_eq!(doubtful.unresolved().unwrap().quantity, quantity);
        }
    }

    /// A contact that is smaller than the first position of fronts on a top: a force of 0 with an error of 1.
    #[test]
    fn a_turn_of_which_nothing_is_known_is_no_answer() {
        let mut cycle = cycle();
        cycle.turn = ContactState {
            error: ErrorEstimate {
                force: 1.0,
                indentation: 1.0,
            },
            ..ContactState::untouched(&cycle.system, Method::default(), 1e-12)
        };
        cycle.pull_off = None;
        cycle.separation = None;
        assert_eq!(
            cycle.unresolved().unwrap().quantity,
            "force at the end of loading"
        );
    }
}
