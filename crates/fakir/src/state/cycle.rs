//! What comes back of a cycle of loading and unloading with adhesion.

use super::contact::{ContactState, PillarState, Termination, Warning};
use super::critical::CriticalState;
use super::fields::Fields;
use super::floor_contact::FloorContact;
use super::limit::{Limit, limits_of_adhesion};
use super::resolution::{Remedy, Unresolved};
use crate::problem::{Accuracy, CyclePlan, Point, System};
use std::sync::Arc;

/// Which way the lens goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Branch {
    /// Down.
    Loading,
    /// Up.
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

/// A point of the curve of force over indentation. Between one and the next the force is linear, so that these are the whole curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CycleLoadStep {
    /// Which branch it is on.
    pub branch: Branch,
    /// Indentation, m; negative where the lens pulls at the tops above their height.
    pub indentation: f64,
    /// Normal force, N; negative where the lens is held back.
    pub force: f64,
    /// Distance of the farthest point in contact from the lens axis, m.
    pub contact_radius: f64,
    /// Number of pillars in contact.
    pub pillars_in_contact: usize,
    /// Number of those in contact in part.
    pub pillars_partially_in_contact: usize,
    /// Area in contact, m^2.
    pub contact_area: f64,
    /// How many of [`Cycle::events`] had happened.
    pub events: usize,
    /// What of the floor is in contact, if it sticks.
    pub floor: Option<HeldFloor>,
}

/// What of a floor that sticks is in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldFloor {
    /// Force on it, N; negative where it pulls.
    pub force: f64,
    /// Area in contact, m^2.
    pub area: f64,
    /// Distance of the farthest cell in contact from the lens axis, m.
    pub radius: f64,
    /// Middles between three pillars of a hexagonal lattice that are in contact.
    pub holes: usize,
}

/// How a floor that sticks was resolved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FloorResolution {
    /// Root of the area of a cell, m.
    pub cell: f64,
    /// Cells across the free ring round a pillar, by the closed form of a ring without pressure. With fewer than
    /// [`ENOUGH`](Self::ENOUGH) the numbers are orders of magnitude: the floor sticks too long.
    pub cells_across_ring: f64,
    /// Cells along the radius of the first patch, by its energy.
    pub cells_along_patch: f64,
    /// What that and the model of its fronts do to the figures.
    pub errors: StuckFloorErrors,
}

/// Estimated relative errors of what a floor that sticks does: the largest differences from two more cycles, on cells 1.5 times as large, whose fronts
/// on the floor move at 7 % less and 7 % more work. So right are the works at which fronts move, and next to a barrier between rings of holes that decides whether
/// one ring more is in contact. What is not found in both is not known, 1; nor is anything on [coarse](FloorResolution::is_coarse) cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StuckFloorErrors {
    /// Of the force at the end of loading.
    pub turn_force: f64,
    /// Of the floor's share of it.
    pub turn_share: f64,
    /// Of the area of the floor in contact there.
    pub turn_area: f64,
    /// Of the force after the jump.
    pub jump_force: f64,
    /// Of the area in contact after the jump.
    pub jump_area: f64,
    /// Of the indentation at which the floor is lost.
    pub lost_indentation: f64,
    /// Of the pull-off force.
    pub pull_off_force: f64,
    /// Of the loop area.
    pub loop_area: f64,
}

impl StuckFloorErrors {
    /// Nothing is known but orders of magnitude.
    pub(crate) const UNKNOWN: Self = Self {
        turn_force: 1.0,
        turn_share: 1.0,
        turn_area: 1.0,
        jump_force: 1.0,
        jump_area: 1.0,
        lost_indentation: 1.0,
        pull_off_force: 1.0,
        loop_area: 1.0,
    };

    #[cfg(test)]
    pub(crate) fn all(&self) -> [f64; 8] {
        [
            self.turn_force,
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
    /// Cells across the ring with which the error of the fronts is a few per cent.
    pub const ENOUGH: f64 = 3.0;
    /// Cells across the ring that are laid where they are affordable.
    pub const WANTED: f64 = 5.0;
    /// Side of the largest cells, pillar radii.
    pub const LARGEST_CELL: f64 = 0.7;
    /// Cells under the contact in the critical state that are affordable by default, about: their limit is one of the points of a transform, of which
    /// there are nine for every such cell.
    pub const MOST_CELLS: f64 = 2e6 / 9.0;

    /// Whether the numbers are orders of magnitude.
    #[must_use]
    pub fn is_coarse(self) -> bool {
        self.cells_across_ring < Self::ENOUGH
    }
}

/// What happens at an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CycleEventKind {
    /// A pillar comes into contact.
    SnapIn,
    /// The contact with a pillar grows.
    Growth,
    /// The contact with a pillar recedes.
    Recession,
    /// A pillar comes out of contact.
    Release,
    /// The lens reaches the floor.
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

/// A change of what is in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CycleEvent {
    /// On which branch.
    pub branch: Branch,
    /// What happened.
    pub kind: CycleEventKind,
    /// Indentation after it, m. Events of one cascade share it.
    pub indentation: f64,
    /// Force after it, N.
    pub force: f64,
    /// The pillar, with the part of its top in contact afterwards; none where the floor is reached.
    pub pillar: Option<HeldPillar>,
    /// The part of its top that was in contact before.
    pub covered_before: f64,
}

/// A pillar that is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldPillar {
    /// Lattice indices `(i, j)` of [`HexagonalLattice::centre`](crate::problem::lattice::HexagonalLattice::centre).
    pub index: (i64, i64),
    /// Centre, m from the lens axis.
    pub centre: Point,
    /// Part of its top that is in contact, 0 to 1.
    pub covered: f64,
}

/// What is in contact at a station.
#[derive(Debug, Clone)]
pub struct HeldContact {
    /// The pillars in contact with what each bears, those nearest to the lens axis first.
    pub pillars: Vec<PillarState>,
    /// Displacement, gap and pressure as functions of position.
    pub fields: Arc<Fields>,
    /// What of the floor is in contact, if it sticks. Its errors are known at the end of the cycle only.
    pub floor: Option<FloorContact>,
}

/// A station that a cycle under way has come to: see [`follow_cycle`](crate::follow_cycle).
pub struct Passage<'a> {
    /// Its place in [`Cycle::stations`].
    pub place: usize,
    /// The station.
    pub station: CycleLoadStep,
    pub(crate) held: &'a dyn Fn() -> HeldContact,
}

impl Passage<'_> {
    /// What is in contact there. It takes about as long as copying what every pillar bears.
    #[must_use]
    pub fn held(&self) -> HeldContact {
        (self.held)()
    }
}

/// The largest pull of the unloading.
#[derive(Debug, Clone)]
pub struct PullOff {
    /// Force, N: the least of the unloading, negative.
    pub force: f64,
    /// Indentation, m.
    pub indentation: f64,
    /// Its place in [`Cycle::stations`].
    pub station: usize,
    /// The pillars in contact with what each bears, those nearest to the lens axis first.
    pub pillars: Vec<PillarState>,
    /// Displacement, gap and pressure there as functions of position.
    pub fields: Arc<Fields>,
}

/// Estimated relative errors of one figure, by where they come from.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CycleError {
    /// From the levels at which fronts on pillar tops stop.
    pub levels: f64,
    /// From the angles at which rims are looked at.
    pub rim_angles: f64,
    /// From the degree of the pressure on pillar tops.
    pub degree: f64,
    /// Of the model: from the shapes that fronts can take.
    pub fronts: f64,
    /// Of the model: from pillars that lean where they are pulled on one side, which [columns](crate::problem::PillarCompliance::Column) do not.
    pub columns: f64,
}

impl CycleError {
    /// That of the numerical solution of the model.
    #[must_use]
    pub fn numerical(&self) -> f64 {
        self.levels + self.rim_angles + self.degree
    }

    /// That of the model.
    #[must_use]
    pub fn model(&self) -> f64 {
        self.fronts + self.columns
    }
}

/// Estimated relative errors of the figures of a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CycleErrors {
    /// Of the critical force.
    pub critical_force: CycleError,
    /// Of the critical indentation.
    pub critical_indentation: CycleError,
    /// Of the pull-off force.
    pub pull_off_force: CycleError,
    /// Of the loop area.
    pub loop_area: CycleError,
}

/// A cycle of loading and unloading with adhesion on the pillar tops.
#[derive(Debug, Clone)]
pub struct Cycle {
    /// What was solved.
    pub system: System,
    /// What was planned.
    pub plan: CyclePlan,
    /// How finely.
    pub accuracy: Accuracy,
    /// The curve of force over indentation in its order; two at one indentation where contacts snap.
    pub stations: Vec<CycleLoadStep>,
    /// What changed, in order.
    pub events: Vec<CycleEvent>,
    /// The first station with something in contact.
    pub first_contact: Option<usize>,
    /// Where the force on loading first rises through zero with something in contact, m: a lens without load comes to rest there.
    pub zero_load_indentation: Option<f64>,
    /// The critical state, if the lens went down so far.
    pub critical: Option<CriticalState>,
    /// The contact where the loading ended.
    pub turn: ContactState,
    /// Whether the floor ended the loading before what was planned.
    pub stopped_by_floor: bool,
    /// How a floor that sticks was resolved; none if it does not, or was not touched.
    pub floor: Option<FloorResolution>,
    /// The largest pull of the unloading; none without unloading, or if nothing pulls.
    pub pull_off: Option<PullOff>,
    /// Indentation of the last release, m; none if something is still in contact.
    pub separation: Option<f64>,
    /// Work done against the pull of the pillars while the lens was withdrawn, J.
    pub work_of_separation: f64,
    /// The hysteresis: area of the loop of force over indentation, J. Of a path that is not closed, the work done.
    pub loop_area: f64,
    /// Energy dissipated by all changes of contact, J: what they release, less what it takes to part the surfaces, and what parting takes
    /// more than contact gains. It is summed up independently, and is equal to the loop area of a closed path.
    pub dissipation: f64,
    /// Estimated relative errors.
    pub errors: CycleErrors,
    /// Why the path ended.
    pub termination: Termination,
    /// What to be careful about.
    pub warnings: Vec<Warning>,
}

impl Cycle {
    /// The jump onto a floor that sticks: the stations before and after it, at one indentation.
    #[must_use]
    pub fn floor_jump(&self) -> Option<[&CycleLoadStep; 2]> {
        let after = self.stations.iter().position(|s| s.floor.is_some())?;
        Some([&self.stations[after.checked_sub(1)?], &self.stations[after]])
    }

    /// The last station with a contact with a floor that sticks, and the one after it.
    #[must_use]
    pub fn floor_lost(&self) -> Option<[&CycleLoadStep; 2]> {
        let last = self.stations.iter().rposition(|s| s.floor.is_some())?;
        Some([&self.stations[last], self.stations.get(last + 1)?])
    }

    /// Whether the numbers are the solution.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.termination == Termination::Converged
    }

    /// The first number of a solution that is [not resolved](Unresolved), of the end of loading, critical state, pull-off, hysteresis, and of what a floor that sticks does. What is
    /// not known of such a floor is not looked at: a warning says it.
    #[must_use]
    pub fn unresolved(&self) -> Option<Unresolved> {
        if !self.converged() {
            return None;
        }
        let errors = &self.errors;
        let of = |there: bool, error: CycleError| if there { error.numerical() } else { 0.0 };
        let critical = self.critical.is_some();
        // What a floor that sticks does there has its own errors.
        let turn = self.turn.unresolved().filter(|_| self.turn.floor.is_none());
        let numbers = [
            (
                "force at the end of loading",
                turn.map_or(0.0, |found| found.error),
            ),
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
                of(self.separation.is_some(), errors.loop_area),
            ),
        ];
        let lost = self.floor_lost().is_some();
        // A floor that is pulled and pressed carries a small difference of large forces, which counts beside the whole force.
        let share = self.turn.floor.as_ref().map_or(1.0, |it| it.share.abs());
        let of_floor = self.known_floor_errors().into_iter().flat_map(|it| {
            [
                ("force at the end of loading", it.turn_force),
                (
                    "force on the floor at the end of loading",
                    share.min(1.0) * it.turn_share,
                ),
                ("force after the jump onto the floor", it.jump_force),
                (
                    "indentation at which the floor is lost",
                    if lost { it.lost_indentation } else { 0.0 },
                ),
            ]
        });
        Unresolved::among(numbers.into_iter().chain(of_floor), self.finer())
    }

    /// The area of the floor in contact after the jump onto it, if it is [not resolved](Unresolved). Which holes a jump takes may depend on a detail,
    /// so that the area has a large error where all else is known: it alone is no answer then.
    #[must_use]
    pub fn unresolved_jump_area(&self) -> Option<Unresolved> {
        self.floor_jump()?;
        let error = self.known_floor_errors()?.jump_area;
        let quantity = "contact area on the floor after the jump onto it";
        Unresolved::among([(quantity, error)], self.finer())
    }

    /// Errors of what a floor that sticks does, where they are known.
    fn known_floor_errors(&self) -> Option<StuckFloorErrors> {
        let errors = self.floor?.errors;
        (errors != StuckFloorErrors::UNKNOWN).then_some(errors)
    }

    /// What a number that is not resolved needs.
    fn finer(&self) -> Remedy {
        match self.accuracy {
            // The fronts of adhesive tops are the same with every accuracy.
            _ if self.floor.is_none() => Remedy::HigherLoad,
            Accuracy::Default => Remedy::AccurateSetting,
            Accuracy::Accurate => Remedy::CollapsedFloor,
        }
    }

    /// The certificate of a closed path: difference between loop area and dissipation, over the loop area. It is made of
    /// rounding and of what the solver leaves; none if the path is not closed.
    #[must_use]
    pub fn certificate(&self) -> Option<f64> {
        let largest = self.loop_area.abs().max(self.dissipation.abs());
        let difference = (self.loop_area - self.dissipation).abs();
        self.separation?;
        Some(if largest > 0.0 {
            difference / largest
        } else {
            0.0
        })
    }

    /// The pillars in contact at a station, in the order in which they came.
    #[must_use]
    pub fn holding(&self, station: usize) -> Vec<HeldPillar> {
        let happened = self.stations.get(station).map_or(0, |at| at.events);
        let mut held: Vec<HeldPillar> = Vec::new();
        let mut place = std::collections::HashMap::new();
        for pillar in self.events[..happened].iter().filter_map(|e| e.pillar) {
            let at = *place.entry(pillar.index).or_insert_with(|| {
                held.push(pillar);
                held.len() - 1
            });
            held[at] = pillar;
        }
        held.retain(|pillar| pillar.covered > 0.0);
        held
    }

    /// Pillars in the order of their last release.
    #[must_use]
    pub fn release_order(&self) -> Vec<&CycleEvent> {
        let released = |event: &&CycleEvent| event.kind == CycleEventKind::Release;
        self.events.iter().filter(released).collect()
    }

    /// The conditions of the model, and how near this case comes to where they end. `range` is that of the attraction (m),
    /// if it is known.
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
