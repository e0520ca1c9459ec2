//! Collapse of an adhesive floor onto the lens and its detachment, by the fast model of a [collapsed floor](crate::solve::collapsed_floor).

use crate::problem::{Load, Method, System};
use crate::solve::collapsed_floor::{
    CollapsedCycle, CollapsedFloor, CollapsedPoint, MODEL_ERROR_OF_AREA, MODEL_ERROR_OF_FORCE,
    NARROWEST_FRONT, WIDEST_ANNULUS,
};
use crate::state::{CriticalState, Run, SolveError};
use crate::theory::stuck_floor::{AdhesiveFloor, AnnulusEdge};

/// Largest indentation of the cycle, relative to the critical indentation.
pub const LARGEST_INDENTATION: f64 = 1.2;

/// Step of the indentation during unloading, relative to the critical indentation: the detachment of the floor is located within half of
/// it.
pub const STEP: f64 = 0.02;

/// Model error of the indentation at which the floor detaches, relative to the critical indentation, within the range of validity: compared
/// with cells on the floor, the difference is 0.02 to 0.08 at surface fractions of 0.03 and 0.1 with 10 and 50 mJ/m^2.
pub const MODEL_ERROR_OF_LOSS: f64 = 0.08;

/// Last indentation of the unloading, relative to the critical indentation: above the level of the tops.
const LAST_INDENTATION: f64 = -1.2;

/// Number of loading steps past the critical state.
const LOADING_STEPS: u32 = 4;

/// Largest radius of annuli without pressure, in pitches, for which the fast model is used: beyond, it is outside its range of validity,
/// and slower with increasing radius.
const ANNULI_MEET: f64 = 0.33;

/// Number of states of the tops alone between the detachment of the floor and the critical state; even.
const TOP_STEPS: u32 = 8;

/// Behaviour of the adhesive floor during unloading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FloorOutcome {
    /// Outside the range of validity of the model: see the validity.
    Unknown,
    /// No connected patch exists at the largest indentation.
    NoPatch,
    /// The floor detaches under compressive load.
    LostUnderLoad,
    /// The floor is still attached at zero load, and is in tension.
    HeldThroughZero,
}

/// Former name of [`FloorOutcome`].
#[deprecated(note = "renamed to `FloorOutcome`")]
pub type Fate = FloorOutcome;

impl FloorOutcome {
    /// Name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::NoPatch => "no_patch",
            Self::LostUnderLoad => "lost_under_load",
            Self::HeldThroughZero => "held_through_zero",
        }
    }
}

/// Whether the fast model is valid for a result, with the reason if not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Validity {
    /// Valid.
    InRange,
    /// The radius of the bonded region is below two pitches: it is not a disc.
    FrontNarrow,
    /// Free annuli are wider than 0.3 pitches: they interact.
    AnnuliWide,
    /// Annuli without pressure nearly meet: the floor bonds hole by hole, if at all, and the model was not evaluated.
    AnnuliMeet,
    /// No front is in equilibrium: the whole floor bonds, or annuli are too narrow to be distinguished from the pillars.
    NoFront,
}

impl Validity {
    /// Name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::InRange => "in_range",
            Self::FrontNarrow => "front_narrow",
            Self::AnnuliWide => "annuli_wide",
            Self::AnnuliMeet => "annuli_meet",
            Self::NoFront => "no_front",
        }
    }

    fn of(point: &CollapsedPoint, pitch: f64) -> Self {
        let wide = |radius| radius > WIDEST_ANNULUS * pitch;
        if point.in_range {
            Self::InRange
        } else if point.front_radius < NARROWEST_FRONT * pitch {
            Self::FrontNarrow
        } else if point.widest_annulus.is_some_and(wide) {
            Self::AnnuliWide
        } else {
            Self::NoFront
        }
    }
}

/// The critical state of the tops, and the subsequent behaviour of an adhesive floor.
///
/// The cycle consists of loading to [`LARGEST_INDENTATION`] times the critical indentation, and unloading. The contact of the tops is
/// computed without adhesion up to the critical state; this changes its force by less than 1 %.
#[derive(Debug, Clone)]
pub struct Collapse {
    /// The critical state.
    pub critical: CriticalState,
    /// Outer radius of the free annulus around a pillar without pressure, m; `None` if no edge is in equilibrium.
    pub annulus_radius: Option<f64>,
    /// The state after the jump into contact with the floor; `None` if the model has no solution.
    pub jump: Option<CollapsedPoint>,
    /// Number of centres of three pillars inside the front of this state.
    pub holes: usize,
    /// Largest indentation of the cycle, m; `None` if the model has no solution for loading.
    pub turn_indentation: Option<f64>,
    /// Behaviour of the floor.
    pub fate: FloorOutcome,
    /// Detachment of the floor: indentation (m), within half a step, and force before it (N). `None` if the floor does not bond or does not
    /// detach.
    pub lost: Option<[f64; 2]>,
    /// Largest tension while the floor is bonded, N, negative; `None` if it detaches under compressive load.
    pub pull_off: Option<f64>,
    /// Area between loading and unloading while the floor is bonded, J. Does not include the dissipation of adhesive tops.
    pub hysteresis: Option<f64>,
    /// Validity of the model for the jump.
    pub jump_validity: Validity,
    /// Validity of the model at the largest indentation, which applies to the detachment of the floor and to all results that follow from
    /// it.
    pub unloading_validity: Validity,
    /// Model error of the force after the jump, relative to this force; `None` outside the range of validity.
    pub force_error: Option<f64>,
    /// Relative model error of the area after the jump; `None` outside the range of validity.
    pub area_error: Option<f64>,
}

/// Computes the critical state of a system with a method, and the subsequent behaviour of an adhesive floor.
///
/// # Errors
/// Those of [`transition`](crate::transition) and [`CollapsedFloor::new`]. A front without equilibrium is not an error, but a [`Validity`].
pub fn collapse(system: &System, method: Method, run: &Run<'_>) -> Result<Collapse, SolveError> {
    let floor = AdhesiveFloor::of(system)?;
    let bare = system.without_adhesion();
    let critical = crate::transition(&bare, method, run)?;
    let annulus_radius = match floor.pillar().edge(system.adhesion().work, 0.0)? {
        AnnulusEdge::At(edge) => Some(edge),
        AnnulusEdge::Closed | AnnulusEdge::Runs => None,
    };
    let indentation = critical.contact.indentation;
    let mut found = Collapse {
        critical,
        annulus_radius,
        jump: None,
        holes: 0,
        turn_indentation: None,
        fate: FloorOutcome::Unknown,
        lost: None,
        pull_off: None,
        hysteresis: None,
        jump_validity: Validity::AnnuliMeet,
        unloading_validity: Validity::AnnuliMeet,
        force_error: None,
        area_error: None,
    };
    if annulus_radius.is_some_and(|edge| edge < ANNULI_MEET * system.pitch()) {
        match collapse_path(system, indentation, run) {
            Ok(cycle) => found.follow(system, &bare, method, &cycle, run)?,
            Err(SolveError::NoFront { .. }) => {
                found.jump_validity = Validity::NoFront;
                found.unloading_validity = Validity::NoFront;
            }
            Err(error) => return Err(error),
        }
    }
    Ok(found)
}

/// Loading from the critical indentation (m), and unloading, by the fast model, as in [`collapse`].
///
/// # Errors
/// Those of [`CollapsedFloor::new`] and [`CollapsedFloor::cycle`].
pub fn collapse_path(
    system: &System,
    critical_indentation: f64,
    run: &Run<'_>,
) -> Result<CollapsedCycle, SolveError> {
    let floor = CollapsedFloor::new(system, LARGEST_INDENTATION * critical_indentation)?;
    let beyond = LARGEST_INDENTATION - 1.0;
    let steps = 0..=LOADING_STEPS;
    let loading: Vec<f64> = steps
        .map(|k| 1.0 + beyond * f64::from(k) / f64::from(LOADING_STEPS))
        .map(|part| part * critical_indentation)
        .collect();
    let steps = ((LARGEST_INDENTATION - LAST_INDENTATION) / STEP).round() as usize;
    let unloading: Vec<f64> = (0..=steps)
        .map(|k| (LARGEST_INDENTATION - STEP * k as f64) * critical_indentation)
        .collect();
    floor.cycle(&loading, &unloading, run)
}

impl Collapse {
    fn follow(
        &mut self,
        system: &System,
        bare: &System,
        method: Method,
        cycle: &CollapsedCycle,
        run: &Run<'_>,
    ) -> Result<(), SolveError> {
        let (loading, unloading): (Vec<CollapsedPoint>, Vec<CollapsedPoint>) =
            cycle.points.iter().copied().partition(|it| !it.unloading);
        let (Some(first), Some(turn)) = (loading.first(), loading.last()) else {
            return Ok(());
        };
        self.jump_validity = Validity::of(first, system.pitch());
        self.jump = Some(*first);
        self.holes = holes_within(system, first.front_radius);
        if self.jump_validity == Validity::InRange {
            self.force_error =
                Some(MODEL_ERROR_OF_FORCE * self.critical.contact.force / first.force.abs());
            self.area_error = Some(MODEL_ERROR_OF_AREA);
        }
        self.turn_indentation = Some(turn.indentation);
        let Some(last) = unloading.last() else {
            self.fate = FloorOutcome::NoPatch;
            self.unloading_validity = self.jump_validity;
            return Ok(());
        };
        self.unloading_validity = Validity::of(&unloading[0], system.pitch());
        let half = 0.5 * STEP * self.critical.contact.indentation;
        let lost = cycle.floor_lost.map(|_| last.indentation - half);
        self.lost = lost.map(|indentation| [indentation, last.force]);
        let least = unloading.iter().map(|point| point.force);
        let least = least.fold(f64::INFINITY, f64::min);
        self.fate = if least <= 0.0 {
            FloorOutcome::HeldThroughZero
        } else {
            FloorOutcome::LostUnderLoad
        };
        // If the floor does not detach, the largest tension may not have been reached.
        self.pull_off = (least < 0.0 && lost.is_some()).then_some(least);
        if let Some(end) = lost {
            let up = self.tops_alone(bare, method, end, run)? + area(&loading);
            // The force before the detachment acts over half a step.
            self.hysteresis = Some(up + area(&unloading) - last.force * half);
        }
        Ok(())
    }

    /// Work on the tops alone between an indentation and the critical one, J, by Simpson's rule; there is no contact below zero.
    fn tops_alone(
        &self,
        bare: &System,
        method: Method,
        from: f64,
        run: &Run<'_>,
    ) -> Result<f64, SolveError> {
        let from = from.max(0.0);
        let to = self.critical.contact.indentation;
        if from >= to {
            return Ok(0.0);
        }
        let width = (to - from) / f64::from(TOP_STEPS);
        let mut sum = self.critical.contact.force;
        for k in 0..TOP_STEPS {
            let weight = if k == 0 {
                1.0
            } else {
                f64::from(2 + 2 * (k % 2))
            };
            let control = Load::Indentation(from + width * f64::from(k));
            sum += weight * crate::press(bare, control, method, run)?.force;
        }
        Ok(sum * width / 3.0)
    }
}

/// Work between points by the trapezoidal rule, J; negative for decreasing indentation.
fn area(points: &[CollapsedPoint]) -> f64 {
    let pairs = points.windows(2);
    pairs
        .map(|pair| {
            0.5 * (pair[0].force + pair[1].force) * (pair[1].indentation - pair[0].indentation)
        })
        .sum()
}

/// Number of centres of three pillars within a radius (m) of the lens axis.
fn holes_within(system: &System, radius: f64) -> usize {
    let Some(lattice) = system.hexagonal_lattice() else {
        return 0;
    };
    let most = (2.0 * radius / lattice.pitch).ceil() as i64 + 3;
    let middle = lattice.nearest_pillar([0.0, 0.0]);
    let all = (-most..=most).flat_map(|i| (-most..=most).map(move |j| (i, j)));
    let centres = all.map(|(i, j)| lattice.centre(middle.0 + i, middle.1 + j));
    centres
        .flat_map(|centre| lattice.middles_beside(centre))
        .filter(|[x, y]| x.hypot(*y) < radius)
        .count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theory::reference::intermediate;

    /// Six of these points surround a pillar at 0.577 pitches, and six more at 1.155.
    #[test]
    fn middles_are_counted() {
        let system = intermediate(0.1);
        let within = |pitches: f64| holes_within(&system, pitches * system.pitch());
        assert_eq!([0.57, 0.58, 1.15, 1.16].map(within), [0, 6, 6, 12]);
    }
}
