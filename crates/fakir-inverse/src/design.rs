//! Design: finds the pitch, height, diameter, lens radius or modulus that gives a target critical force, contact
//! radius, pull-off force, or floor share under a load.
//!
//! The value is a root of `g(x) = ln(result(x)/target)` over `ln x`. It is bracketed by steps of doubling length,
//! starting from the root for the homogenised lattice (a thousand times faster) or from the value in the case
//! file. The bracketing method that all searches share then refines it and
//! distinguishes a root from a jump. If the lens would penetrate too far to be solved, the result counts as too
//! large; if the lens touches the floor first, as zero.
//!
//! A floor share increases from the transition with the power 3/2 of the distance past it. Therefore `g(x) = (share(x)/target)^(2/3) -
//! 1` is nearly linear there; before the transition, where the share is zero, it is continued by the gap to the floor. The search
//! starts where the homogenised lattice has its transition under the load. A value whose contact cannot be solved gives no information
//! on the share and limits the range.
//!
//! On a height map every contact is solved again on its cells, on which it changes in small steps. The target is met to within the estimated error of the
//! cells, which [`Answer::error`] converts into that of the value; the range ends where a contact cannot be solved. With adhesion the whole loading is
//! followed at every value, and the steps of a cell are part of the estimated error.
//!
//! The force at an indentation, or the contact radius under a load, is searched in the same way, on every surface; on a flat surface, which has no critical
//! state, these and the pull-off force are the targets.
//!
//! A pull-off force requires a whole cycle up to the critical state or a given load, with adhesive tops and the spectral method. There is no
//! initial estimate, and the range ends where a cycle has too many pillars. The target is met to within the numerical error of the
//! force, because fronts on pillars that have partly detached move in steps.

use fakir::numerics::convergence::{clamped, larger, within};
use fakir::numerics::roots::{self, Change, Point, Root};
use fakir::problem::{CyclePlan, Load, Method, Question, ShapedLens, SurfaceSystem};
use fakir::state::{
    AsperityContact, AsperityCycle, ContactState, Critical, CriticalState, Cycle, FlatContact,
    FlatCycle, FloorContact, LARGEST_ERROR, Run, Solution, SolveError, SurfaceContact,
    SurfaceCycle, SurfaceTransition,
};
use fakir_case::unit::{Dimension, format_quantity};
use fakir_case::{AnyCase, CaseError, CaseFile, Key, SurfaceKind};
use fakir_study::numbers::{DIGITS, LENGTH_DIGITS, digits, with_unit};
use fakir_study::result::control_words;
use fakir_study::surfaces::{Answered, on_wide_enough_a_grid};
use std::f64::consts::SQRT_2;
use std::ops::Bound;

/// Target of a design, for the critical state or for the contact under a load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wanted {
    /// Critical force `F_c`, N.
    Force(f64),
    /// Critical contact radius `a_c`, m.
    ContactRadius(f64),
    /// Force of the contact under a load, or its contact radius.
    Pressed {
        /// The number of the contact.
        quantity: PressedQuantity,
        /// Its value, N or m.
        value: f64,
        /// Load at which it applies.
        load: Load,
    },
    /// Floor share: fraction of the load carried by the floor.
    FloorShare {
        /// Floor share, more than 0 and less than 1.
        share: f64,
        /// Load at which it applies.
        load: Load,
    },
    /// Pull-off force on unloading.
    PullOff {
        /// Force, N, as a positive number.
        force: f64,
        /// Load from which the lens is pulled off.
        load: Load,
    },
}

/// A number of a contact under a load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PressedQuantity {
    /// Force, N.
    Force,
    /// Contact radius, m.
    ContactRadius,
}

impl Wanted {
    /// Value: N, m, or a fraction of the load.
    #[must_use]
    pub fn value(self) -> f64 {
        match self {
            Self::Force(value)
            | Self::ContactRadius(value)
            | Self::Pressed { value, .. }
            | Self::PullOff { force: value, .. }
            | Self::FloorShare { share: value, .. } => value,
        }
    }

    /// The same quantity of a contact. Without floor contact the floor share is zero.
    #[must_use]
    pub fn of(self, reached: &Reached) -> f64 {
        match self.of_contact() {
            Some(PressedQuantity::Force) => reached.force(),
            Some(PressedQuantity::ContactRadius) => reached.contact_radius(),
            None if self.is_share() => reached.floor_share().map_or(0.0, |[share, _]| share),
            None => match reached.pull_off() {
                Some(PulledOff { force, .. }) => -force,
                None => reached.force(),
            },
        }
    }

    /// Dimension.
    #[must_use]
    pub fn dimension(self) -> Dimension {
        match (self.of_contact(), self) {
            (Some(PressedQuantity::ContactRadius), _) => Dimension::Length,
            (None, Self::FloorShare { .. }) => Dimension::Fraction,
            _ => Dimension::Force,
        }
    }

    /// Description of the contact to which the target applies: ` in the contact under a force of 1 mN`, ` after the contact under a force
    /// of 1 mN`; empty for the critical state.
    #[must_use]
    pub fn load_words(self) -> String {
        match self {
            Self::FloorShare { load, .. } | Self::Pressed { load, .. } => {
                format!(" in the {}", control_words(load))
            }
            Self::PullOff { .. } => self.load().map_or_else(String::new, |load| {
                format!(" after the {}", control_words(load))
            }),
            Self::Force(_) | Self::ContactRadius(_) => String::new(),
        }
    }

    /// Load to which the target applies; `None` for the critical state.
    #[must_use]
    pub fn load(self) -> Option<Load> {
        match self {
            Self::FloorShare { load, .. }
            | Self::PullOff { load, .. }
            | Self::Pressed { load, .. } => (load != Load::FloorContact).then_some(load),
            Self::Force(_) | Self::ContactRadius(_) => None,
        }
    }

    /// The number of a contact, critical or under a load, that is the target; none for a floor share and a pull-off force.
    fn of_contact(self) -> Option<PressedQuantity> {
        match self {
            Self::Force(_) => Some(PressedQuantity::Force),
            Self::ContactRadius(_) => Some(PressedQuantity::ContactRadius),
            Self::Pressed { quantity, .. } => Some(quantity),
            Self::FloorShare { .. } | Self::PullOff { .. } => None,
        }
    }

    /// Whether it is the force of a contact under a load, which must be an indentation.
    fn is_pressed_force(self) -> bool {
        let force = PressedQuantity::Force;
        matches!(self, Self::Pressed { quantity, .. } if quantity == force)
    }

    /// The loads at which it can be a target.
    fn loads(self) -> &'static str {
        match self.is_pressed_force() {
            true => "an indentation",
            false => "a force or an indentation",
        }
    }

    /// Questions whose answers it requires.
    fn questions(self) -> &'static [Question] {
        match self {
            Self::FloorShare { .. } => &[Question::FloorShare, Question::Design],
            Self::PullOff { .. } | Self::Pressed { .. } if self.load().is_some() => {
                &[Question::Design]
            }
            _ => &[Question::Transition, Question::Design],
        }
    }

    /// Whether it is a floor share.
    fn is_share(self) -> bool {
        matches!(self, Self::FloorShare { .. })
    }

    /// Whether it is a pull-off force.
    fn is_pull_off(self) -> bool {
        matches!(self, Self::PullOff { .. })
    }

    /// Whether an unsolved contact gives no information on it, and whether its accuracy is limited by its
    /// estimated error.
    fn is_coarse(self) -> bool {
        self.is_share() || self.is_pull_off()
    }

    /// Deviation of a contact from the target: zero if it is met, positive if the value is too large.
    fn excess(self, reached: &Reached) -> f64 {
        // A force may be tensile with adhesion: too small.
        let ratio = larger(self.of(reached) / self.value(), 0.0);
        if !self.is_share() {
            return ratio.ln();
        }
        match reached.floor_share() {
            Some(_) => ratio.powf(SHARE_POWER) - 1.0,
            // A lens below the level of the floor without floor force is not nearer to the floor
            // share.
            None => -1.0 - larger(reached.to_the_floor(), 0.0),
        }
    }

    /// Estimated error of the deviation, if it is relevant: critical states are far more accurate
    /// than samples can be manufactured.
    ///
    /// It is 0 of a pull-off force of which not even the first digit is known: no target is met by an error that covers everything. A floor
    /// share just past the transition has no digit either, but the value at which it begins is known well.
    fn excess_error(self, reached: &Reached) -> f64 {
        if let Some(pull_off) = reached.pull_off() {
            let is_known = within(pull_off.error, LARGEST_ERROR);
            return if is_known { pull_off.error } else { 0.0 };
        }
        match (self, reached.floor_share()) {
            (Self::FloorShare { .. }, Some([_, error])) => {
                let slope = (self.of(reached) / self.value()).powf(SHARE_POWER) * SHARE_POWER;
                slope * error
            }
            (Self::FloorShare { .. } | Self::PullOff { .. }, _) => 0.0,
            (Self::Force(_) | Self::ContactRadius(_) | Self::Pressed { .. }, _) => {
                let place = usize::from(self.dimension() == Dimension::Length);
                reached
                    .errors_of_cells()
                    .map_or(0.0, |errors| errors[place])
            }
        }
    }

    /// Estimated numerical error of the result relative to it; zero if it is unknown, and on a height map, on which errors of cells are nearly the same
    /// for all values.
    fn relative_error(self, reached: &Reached) -> f64 {
        let error = match (self, reached.pull_off()) {
            _ if reached.on_map().is_some() => 0.0,
            (_, Some(pull_off)) => pull_off.error,
            (Self::FloorShare { .. }, _) => reached.floor_share().map_or(0.0, |[_, error]| error),
            _ if self.dimension() == Dimension::Length => reached.radius_error(),
            _ => reached.force_error(),
        };
        error.max(0.0)
    }

    /// Estimated error of the deviation where the result jumps by less: a contact radius jumps where a pillar comes into contact, and by the error
    /// of the place of its edge.
    fn error_of_jump(self, reached: &Reached) -> f64 {
        match self.dimension() {
            Dimension::Length => reached.radius_error().min(LARGEST_ERROR),
            _ => 0.0,
        }
    }

    /// Name in a sentence.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Force(_) => "critical force",
            Self::ContactRadius(_) => "critical contact radius",
            Self::Pressed {
                quantity: PressedQuantity::Force,
                ..
            } => "force",
            Self::Pressed {
                quantity: PressedQuantity::ContactRadius,
                ..
            } => "contact radius",
            Self::FloorShare { .. } => "floor share",
            Self::PullOff { .. } => "pull-off force",
        }
    }
}

/// Contact to which a target applies.
#[derive(Debug, Clone)]
pub enum Reached {
    /// The critical state.
    Critical(CriticalState),
    /// The contact under the load of a target.
    Pressed(ContactState),
    /// The cycle of a target pull-off force.
    PulledOff(Box<Cycle>),
    /// The critical state of rounded tops.
    CriticalOfTops(Box<Critical<AsperityContact>>),
    /// The contact with rounded tops under the load of a target.
    PressedTops(Box<AsperityContact>),
    /// The cycle of rounded tops of a target pull-off force.
    PulledOffTops(Box<AsperityCycle>),
    /// The critical state on a height map.
    CriticalOnMap(Box<Answered<SurfaceTransition>>),
    /// The contact with a height map under the load of a target.
    PressedOnMap(Box<Answered<SurfaceContact>>),
    /// The cycle on a height map of a target pull-off force.
    PulledOffOnMap(Box<Answered<SurfaceCycle>>),
    /// The contact with a flat surface under the load of a target.
    PressedFlat(Box<FlatContact>),
    /// The cycle on a flat surface of a target pull-off force.
    PulledOffFlat(Box<FlatCycle>),
}

/// Pull-off of a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PulledOff {
    /// Force, N, negative; zero without tension.
    pub force: f64,
    /// Its estimated numerical error relative to it.
    pub error: f64,
}

impl Reached {
    /// The contact with flat tops, critical or not; for a cycle, the contact at the largest load. `None` for other surfaces.
    #[must_use]
    pub fn contact(&self) -> Option<&ContactState> {
        match self {
            Self::Critical(critical) => Some(&critical.contact),
            Self::Pressed(contact) => Some(contact),
            Self::PulledOff(cycle) => Some(&cycle.turn),
            Self::CriticalOfTops(_)
            | Self::PressedTops(_)
            | Self::PulledOffTops(_)
            | Self::CriticalOnMap(_)
            | Self::PressedOnMap(_)
            | Self::PulledOffOnMap(_)
            | Self::PressedFlat(_)
            | Self::PulledOffFlat(_) => None,
        }
    }

    /// The contact with a height map, of a cycle that at the end of loading; `None` for other surfaces.
    #[must_use]
    pub fn on_map(&self) -> Option<&SurfaceContact> {
        match self {
            Self::CriticalOnMap(critical) => Some(&critical.answer.contact),
            Self::PressedOnMap(contact) => Some(&contact.answer),
            Self::PulledOffOnMap(cycle) => Some(&cycle.answer.turn),
            _ => None,
        }
    }

    /// Estimated errors of critical force and contact radius relative to them, due to the cells of a height map; NaN if they are unknown.
    fn errors_of_cells(&self) -> Option<[f64; 2]> {
        let contact = self.on_map()?;
        let force = contact.error.map_or(f64::NAN, |error| error.force);
        let radius = contact.relative_contact_radius_error();
        Some([force, radius.unwrap_or(f64::NAN)])
    }

    /// Fraction of the load on the floor and its estimated relative error; `None` if the floor carries nothing.
    #[must_use]
    pub fn floor_share(&self) -> Option<[f64; 2]> {
        let Some(contact) = self.on_map() else {
            return self.floor().map(|floor| [floor.share, floor.error.share]);
        };
        let share = contact.shares?.floor.force / contact.force;
        let error = contact.floor_error.map_or(f64::NAN, |error| error.share);
        (share > 0.0).then_some([share, error])
    }

    /// Normal force of the contact, N; for a cycle, at the end of the loading.
    #[must_use]
    pub fn force(&self) -> f64 {
        match self {
            Self::Critical(critical) => critical.contact.force,
            Self::Pressed(contact) => contact.force,
            Self::PulledOff(cycle) => cycle.turn.force,
            Self::CriticalOfTops(critical) => critical.contact.force,
            Self::PressedTops(contact) => contact.force,
            Self::PulledOffTops(cycle) => cycle.turn.force,
            Self::CriticalOnMap(critical) => critical.answer.contact.force,
            Self::PressedOnMap(contact) => contact.answer.force,
            Self::PulledOffOnMap(cycle) => cycle.answer.turn.force,
            Self::PressedFlat(contact) => contact.force,
            Self::PulledOffFlat(cycle) => cycle.turn.force,
        }
    }

    /// Whether the lens touches the floor before any pillar: the contact has no force. A flat surface has no floor.
    fn is_floor_first(&self) -> bool {
        let is_flat = matches!(self, Self::PressedFlat(_) | Self::PulledOffFlat(_));
        !is_flat && self.force().abs() <= 0.0
    }

    /// Estimated error of its contact radius relative to it.
    fn radius_error(&self) -> f64 {
        match self {
            Self::Critical(critical) => critical.contact.relative_contact_radius_error(),
            Self::Pressed(contact) => contact.relative_contact_radius_error(),
            _ => 0.0,
        }
    }

    /// Estimated error of its force relative to it; zero if it is unknown.
    fn force_error(&self) -> f64 {
        let of_tops = |contact: &AsperityContact| contact.error.map_or(0.0, |error| error.force);
        match self {
            Self::Critical(critical) => critical.contact.error.force,
            Self::Pressed(contact) => contact.error.force,
            Self::CriticalOfTops(critical) => of_tops(&critical.contact),
            Self::PressedTops(contact) => of_tops(contact),
            Self::PressedFlat(contact) => contact.error.force,
            _ => 0.0,
        }
    }

    /// Its contact radius, m, which contains the floor contact of a critical state.
    #[must_use]
    pub fn contact_radius(&self) -> f64 {
        match self {
            Self::Critical(critical) => critical.contact_radius(),
            Self::Pressed(contact) => contact.contact_radius,
            Self::PulledOff(cycle) => cycle.turn.contact_radius,
            Self::CriticalOfTops(critical) => critical.contact_radius(),
            Self::PressedTops(contact) => contact.contact_radius.unwrap_or(0.0),
            Self::PulledOffTops(cycle) => cycle.turn.contact_radius.unwrap_or(0.0),
            Self::CriticalOnMap(critical) => critical.answer.contact_radius().unwrap_or(0.0),
            Self::PressedOnMap(contact) => contact.answer.contact_radius.unwrap_or(0.0),
            Self::PulledOffOnMap(cycle) => cycle.answer.turn.contact_radius.unwrap_or(0.0),
            Self::PressedFlat(contact) => contact.contact_radius,
            Self::PulledOffFlat(cycle) => cycle.turn.contact_radius,
        }
    }

    /// Pull-off of a cycle; `None` for a contact.
    #[must_use]
    pub fn pull_off(&self) -> Option<PulledOff> {
        let (force, error) = match self {
            Self::PulledOff(cycle) => (
                cycle.pull_off.as_ref().map(|pull_off| pull_off.force),
                cycle.errors.pull_off_force.numerical(),
            ),
            Self::PulledOffTops(cycle) => (
                cycle.pull_off.as_ref().map(|contact| contact.force),
                cycle.errors.pull_off_force,
            ),
            Self::PulledOffOnMap(cycle) => {
                let SurfaceCycle {
                    pull_off, errors, ..
                } = &cycle.answer;
                let error = errors.map_or(f64::NAN, |errors| errors.pull_off_force);
                (pull_off.as_ref().map(|contact| contact.force), error)
            }
            Self::PulledOffFlat(cycle) => {
                let pull_off = cycle.pull_off.as_ref();
                let error = pull_off.map_or(0.0, |contact| contact.error.force);
                (pull_off.map(|contact| contact.force), error)
            }
            _ => return None,
        };
        Some(PulledOff {
            force: force.unwrap_or(0.0),
            error,
        })
    }

    /// Contact on the floor; `None` without, and on a height map.
    #[must_use]
    pub fn floor(&self) -> Option<&FloorContact> {
        match self {
            Self::PressedTops(contact) => contact.floor.as_ref(),
            _ => self.contact()?.floor.as_ref(),
        }
    }

    /// Smallest gap between lens and floor over the height of the pillars, or of the relief of a height map; under rounded tops, over the sum of the
    /// gap and the indentation.
    fn to_the_floor(&self) -> f64 {
        if let Self::PressedTops(contact) = self {
            let gap = contact.floor_gap.map_or(f64::INFINITY, |floor| floor.gap);
            return gap / (gap + contact.indentation.abs());
        }
        if let Self::PressedOnMap(contact) = self {
            let surface = contact.case.system.surface();
            let gap = contact
                .answer
                .nearest_floor
                .map_or(f64::INFINITY, |it| it.0);
            return gap / (surface.highest() - surface.lowest());
        }
        self.contact().map_or(f64::INFINITY, |contact| {
            contact.smallest_floor_gap / contact.system.pillar().height
        })
    }

    fn solution(&self) -> &dyn Solution {
        match self {
            Self::Critical(critical) => &critical.contact,
            Self::Pressed(contact) => contact,
            Self::PulledOff(cycle) => cycle.as_ref(),
            Self::CriticalOfTops(critical) => &critical.contact,
            Self::PressedTops(contact) => contact.as_ref(),
            Self::PulledOffTops(cycle) => cycle.as_ref(),
            Self::CriticalOnMap(critical) => &critical.answer.contact,
            Self::PressedOnMap(contact) => &contact.answer,
            Self::PulledOffOnMap(cycle) => &cycle.answer,
            Self::PressedFlat(contact) => contact.as_ref(),
            Self::PulledOffFlat(cycle) => cycle.as_ref(),
        }
    }

    /// Whether its numbers are valid: solved and resolved.
    #[must_use]
    pub fn is_answer(&self) -> bool {
        self.solution().is_answer()
    }
}

/// A value of the free parameter and its contact.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// Value of the free parameter, in SI units.
    pub value: f64,
    /// The case with this value.
    pub case: AnyCase,
    /// Its critical state, its contact under the load, or its cycle.
    pub reached: Reached,
}

/// Result of a search.
#[derive(Debug, Clone)]
pub enum Design {
    /// A value that meets the target, to within [`TOLERANCE`]; a floor share or pull-off force to within its estimated error.
    Found {
        /// The value and its contact.
        candidate: Candidate,
        /// Sensitivity `d ln(result)/d ln(x)`: relative change of the result over that of the
        /// value. If it is near zero, the result hardly depends on the value, and many values meet
        /// the target.
        sensitivity: f64,
    },
    /// The target is inside a jump of the result; these are its two sides.
    Jump(Box<[Candidate; 2]>),
    /// Unattainable target: the closest attainable value, and the reason.
    OutOfReach {
        /// Closest attainable value.
        nearest: Candidate,
        /// Limit.
        limit: Limit,
        /// Smallest and largest pull-off force found, N.
        reach: Option<[f64; 2]>,
    },
}

/// Reason why a result cannot be closer to the target.
#[derive(Debug, Clone, PartialEq)]
pub enum Limit {
    /// The free parameter is at the end of its range.
    Range,
    /// Beyond this value, no contact can be computed.
    Solver(SolveError),
    /// Beyond this value, the lens touches the floor before any pillar.
    FloorFirst,
    /// Beyond this value, too many pillars are in contact for a cycle.
    ManyPillars,
    /// Beyond this value, the height map cannot be generated.
    Invalid(String),
    /// Beyond this value, the solution does not converge.
    NotConverged,
    /// The search ends at this value, the last valid one.
    SearchEnd,
    /// The search ends at this value, far from its start; it covers these values.
    Distance([f64; 2]),
    /// The value of another key in the case file limits the free one.
    Given(Key, f64),
    /// The result is the same for all values.
    NoEffect,
}

/// A design: question and result.
#[derive(Debug, Clone)]
pub struct Answer {
    /// Free parameter.
    pub free: Key,
    /// Target.
    pub wanted: Wanted,
    /// Result.
    pub design: Design,
}

/// Sensitivity below which the target hardly determines the value.
const INSENSITIVE: f64 = 1e-3;

impl Answer {
    /// Result, or the closest attainable value.
    #[must_use]
    pub fn nearest(&self) -> &Candidate {
        match &self.design {
            Design::Found { candidate, .. } => candidate,
            Design::OutOfReach { nearest, .. } => nearest,
            Design::Jump(sides) => {
                let away = |side: &Candidate| self.wanted.excess(&side.reached).abs();
                let [a, b] = sides.as_ref();
                if away(a) <= away(b) { a } else { b }
            }
        }
    }

    /// Dimension of the value.
    #[must_use]
    pub fn dimension(&self) -> Dimension {
        self.free.dimension()
    }

    /// Estimated relative error of the value, due to the cells of a height map; `None` for other surfaces, on which it is accurate, and if
    /// it is unknown.
    #[must_use]
    pub fn error(&self) -> Option<f64> {
        let Design::Found {
            candidate,
            sensitivity,
        } = &self.design
        else {
            return None;
        };
        candidate.reached.on_map()?;
        let of_excess = self.wanted.excess_error(&candidate.reached);
        let of_target = match self.wanted {
            Wanted::FloorShare { .. } => of_excess / SHARE_POWER,
            _ => of_excess,
        };
        // With adhesion the results at both ends of the step scatter by half of the estimate, and so does the sensitivity.
        let of_sensitivity = match candidate.case.is_adhesive() {
            true => SCATTER * of_excess * SQRT_2 / (2.0 * STEP_WITH_ADHESION * sensitivity.abs()),
            false => 0.0,
        };
        let error = of_target / sensitivity.abs() * (1.0 + of_sensitivity);
        Some(error).filter(|error| error.is_finite())
    }

    fn value(&self, candidate: &Candidate) -> String {
        let digits = match self.error() {
            Some(error) => digits(error),
            None if candidate.reached.on_map().is_some() => 3,
            None => 8,
        };
        with_unit(candidate.value, self.dimension(), digits)
    }

    /// Value of the target quantity for the candidate, with its significant digits, and with as many as distinguish it from the target.
    fn answer_of(&self, candidate: &Candidate) -> String {
        let share = candidate.reached.floor_share();
        let of_cells = candidate.reached.errors_of_cells();
        let digits = match self.wanted {
            Wanted::Force(_) | Wanted::ContactRadius(_) | Wanted::Pressed { .. } => {
                match self.wanted.dimension() {
                    Dimension::Length => of_cells.map_or(LENGTH_DIGITS, |it| digits(it[1])),
                    _ => of_cells.map_or(DIGITS, |it| digits(it[0])),
                }
            }
            Wanted::PullOff { .. } => {
                let pull_off = candidate.reached.pull_off();
                pull_off.map_or(1, |pull_off| digits(pull_off.error))
            }
            Wanted::FloorShare { .. } => share.map_or(1, |[_, error]| digits(error).min(DIGITS)),
        };
        let with = |value, digits| with_unit(value, self.wanted.dimension(), digits);
        let [answer, target] = [self.wanted.of(&candidate.reached), self.wanted.value()];
        let distinct = (digits..=f64::DIGITS as usize)
            .find(|digits| with(answer, *digits) != with(target, *digits));
        with(answer, distinct.unwrap_or(digits))
    }

    fn wanted_words(&self) -> String {
        let dimension = self.wanted.dimension();
        match self.wanted {
            Wanted::Force(force) => with_unit(force, dimension, DIGITS),
            Wanted::ContactRadius(radius) => with_unit(radius, dimension, LENGTH_DIGITS),
            Wanted::PullOff { .. } | Wanted::FloorShare { .. } | Wanted::Pressed { .. } => {
                let load = self.wanted.load_words();
                format!("{}{load}", format_quantity(self.wanted.value(), dimension))
            }
        }
    }

    /// Result as a sentence.
    #[must_use]
    pub fn statement(&self) -> String {
        let wanted = self.wanted_words();
        let (path, name) = (self.free.path(), self.wanted.name());
        let nearest = self.nearest();
        match &self.design {
            Design::Found { candidate, .. } => {
                format!(
                    "{path} = {} gives a {name} of {wanted}",
                    self.value(candidate)
                )
            }
            Design::Jump(sides) => {
                let [a, b] = sides.as_ref();
                format!(
                    "A {name} of {wanted} is unattainable with {path}: at {} it jumps from {} to {}",
                    self.value(nearest),
                    self.answer_of(a),
                    self.answer_of(b)
                )
            }
            Design::OutOfReach { limit, reach, .. } => {
                let reach = reach.map_or(String::new(), |ends| {
                    let [least, greatest] = ends.map(|end| with_unit(end, Dimension::Force, 3));
                    format!("it ranges from {least} to {greatest}, and ")
                });
                let why = match limit {
                    Limit::Range => String::new(),
                    Limit::NotConverged => {
                        ", beyond which the solution does not converge".to_owned()
                    }
                    Limit::SearchEnd => ", where the search ends".to_owned(),
                    Limit::Distance(range) => {
                        let [least, greatest] =
                            range.map(|end| with_unit(end, self.dimension(), 3));
                        return format!(
                            "No {path} from {least} to {greatest} gives a {name} of {wanted}: {reach}the closest value is {}, at {}, where the search \
                             ends; with another initial {path} it may find one",
                            self.answer_of(nearest),
                            self.value(nearest),
                        );
                    }
                    Limit::Given(key, value) => {
                        let is_too_small = self.wanted.of(&nearest.reached) < self.wanted.value();
                        let remedy = match (key, is_too_small) {
                            (Key::RecedingWorkOfAdhesion, true) => "raise or remove it",
                            _ => "lower it",
                        };
                        let value = format_quantity(*value, key.dimension());
                        format!(", limited by {} = {value}; {remedy}", key.path())
                    }
                    Limit::NoEffect => {
                        return format!(
                            "A {name} of {wanted} is unattainable with {path}, which has no effect on it: it is {} for all values",
                            self.answer_of(nearest)
                        );
                    }
                    Limit::FloorFirst => {
                        ", beyond which the lens reaches the floor before any pillar".to_owned()
                    }
                    Limit::Solver(error) => format!(", beyond which {error}"),
                    Limit::Invalid(problem) => format!(", beyond which {problem}"),
                    Limit::ManyPillars => format!(
                        ", beyond which the lens touches more than {MANY_PILLARS} pillars, whose cycles take too long"
                    ),
                };
                format!(
                    "A {name} of {wanted} is unattainable with {path}: {reach}the closest attainable value is {}, at {}{why}",
                    self.answer_of(nearest),
                    self.value(nearest),
                )
            }
        }
    }

    /// Warning if the result hardly depends on the value.
    #[must_use]
    pub fn caution(&self) -> Option<String> {
        match &self.design {
            Design::Found { sensitivity, .. } if sensitivity.abs() < INSENSITIVE => Some(format!(
                "the {} hardly depends on {} there: other values give nearly the same",
                self.wanted.name(),
                self.free.path()
            )),
            _ => None,
        }
    }
}

/// Errors of a design.
#[derive(Debug, thiserror::Error)]
pub enum DesignError {
    /// Invalid case.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The contact could not be computed.
    #[error("{}", fakir_case::with_keys(.0))]
    Solve(#[from] SolveError),
    /// A key that cannot be free.
    #[error("{} cannot be free: give one of {}", .0.path(), free_names())]
    NotFree(Key),
    /// A key of a height map or its bodies without a value to begin with.
    #[error("{} is not in the case: give it there, for the search to begin with", .0.path())]
    NotGiven(Key),
    /// A contact radius under a plate, which has no axis.
    #[error("a plate has no contact radius: give a critical force")]
    NoRadius,
    /// Invalid target.
    #[error("the target {} must be greater than 0", .0.name())]
    NotPositive(Wanted),
    /// Invalid floor share.
    #[error("the target floor share must be greater than 0 and less than 1 (100 %): it is {0}")]
    NotAShare(f64),
    /// A floor share without a valid load.
    #[error("{} needs a load: give {} greater than 0", .0.name(), .0.loads())]
    NotALoad(Wanted),
    /// A pull-off force without adhesion.
    #[error(
        "a pull-off force needs adhesion: give adhesion.work in the case, as in adhesion.work = \"50 mJ/m2\""
    )]
    NoAdhesion,
    /// Too many pillars in contact for an initial cycle.
    #[error(
        "the lens touches more than {MANY_PILLARS} pillars, whose cycles take too long: start with another {}", .0.path()
    )]
    TooManyPillars(Key),
    /// No contact of the search converged.
    #[error(
        "the contacts did not converge: begin with another {}, or try another accuracy or an offset that is a little different", .0.path()
    )]
    NotConverged(Key),
}

/// Keys that can be free: all sizes, moduli and works of adhesion of a case.
#[must_use]
pub fn free_keys() -> Vec<Key> {
    let keys = Key::ALL.into_iter();
    let is_made = |key: &Key| {
        // Their bounds contain zero, without adhesion or relief.
        let from_zero = [
            Key::HeightUnit,
            Key::WorkOfAdhesion,
            Key::RecedingWorkOfAdhesion,
        ]
        .contains(key);
        let is_made = key.dimension() != Dimension::Angle;
        is_made && (key.is_positive() || from_zero) && !NUMERICAL.contains(key)
    };
    keys.filter(is_made).collect()
}

/// Lengths of a height map that are not those of the sample.
const NUMERICAL: [Key; 2] = [Key::GridWidth, Key::MinimumDistance];

/// Returns the free key with that path, or with that last name if it is unique.
///
/// # Errors
/// The paths of possible keys.
pub fn free_key(name: &str) -> Result<Key, String> {
    let name: &str = Key::at(name).map_or(name, |key| key.path());
    let mut named = free_keys();
    named.retain(|key| key.path() == name || key.name() == name);
    // The last name of a key of a pattern is not that of a key of a surface.
    if named.iter().any(|key| !key.is_of_surface()) {
        named.retain(|key| !key.is_of_surface() || key.path() == name);
    }
    match named[..] {
        [key] => Ok(key),
        [] => Err(format!("give one of {}", free_names())),
        _ => {
            let paths: Vec<_> = named.iter().map(|key| key.path()).collect();
            Err(format!("give one of {}", paths.join(", ")))
        }
    }
}

/// The paths of all free keys, in a list with commas.
#[must_use]
pub fn free_names() -> String {
    let names: Vec<&str> = free_keys().into_iter().map(Key::path).collect();
    names.join(", ")
}

/// Relative deviation from the target at which a search ends.
pub const TOLERANCE: f64 = 1e-9;

/// Relative width of a bracket below which a target that is not met is considered to be inside a jump.
const JUMP: f64 = 1e-12;

/// The same for floor shares, which jump by their error where the grid on the floor changes, and for pull-off
/// forces.
const COARSE_JUMP: f64 = 1e-7;

/// The same on a height map, whose results jump by whole cells; much narrower than a sample can be made.
const JUMP_OF_CELLS: f64 = 1e-4;

/// Half of the step in `ln x` for the sensitivity on an adhesive height map, whose results scatter by some per cent.
const STEP_WITH_ADHESION: f64 = 0.4;

/// Scatter of results on adhesive height maps as a fraction of their estimated error, which is at least twice the difference between two sizes of cells.
const SCATTER: f64 = 0.5;

/// A floor share to this power is nearly linear in the load past the transition.
const SHARE_POWER: f64 = 2.0 / 3.0;

/// Fraction of its estimated error to which a floor share or pull-off force is met, unless it jumps by more.
const SHARPNESS: f64 = 0.1;

/// Relative width of a bracket that locates the value beyond which there is no contact with
/// sufficient accuracy.
const EDGE: f64 = 1e-3;

/// Largest relative change of a result over the whole range on which a quantity has no effect but rounding.
const NO_EFFECT: f64 = 1e-6;

/// The same if the estimated errors of the results are larger: a change of more than one per cent is an effect, however coarse the results are.
const MOST_NOISE: f64 = 1e-2;

/// Relative distance of a value that is tried instead of one whose contact does not converge.
const ASIDE: f64 = 1e-6;

/// With this many pillars in contact the homogenised lattice is accurate to a few per cent. If it
/// differs from the target by more than a factor of 2, this accuracy is sufficient for the search.
const MANY_PILLARS: usize = 1000;
const CLEAR: f64 = std::f64::consts::LN_2;

/// First steps in `ln x`: from an estimate of the value, and from a guess.
const STRIDES: [f64; 2] = [0.02, 0.4];

/// Finds the value of `free` that meets the target. Everything else is as in the case file; its
/// value of `free`, if any, is the start of the search.
///
/// If the case file contains the pitch, the pitch remains fixed; if it contains the surface
/// fraction, the surface fraction does.
///
/// # Errors
/// See [`DesignError`]. An unattainable target is not an error: see [`Design`].
pub fn design(
    file: &CaseFile,
    free: Key,
    wanted: Wanted,
    run: &Run<'_>,
) -> Result<Design, DesignError> {
    file.check_surface(&[Question::Design])?;
    let is_on_map = file.surface_kind() == SurfaceKind::HeightMap;
    if !free_keys().contains(&free) || free.is_of_surface() && !is_on_map {
        return Err(DesignError::NotFree(free));
    }
    let target = wanted.value();
    if let Wanted::FloorShare { share, .. } = wanted {
        if !(share > 0.0 && share < 1.0) {
            return Err(DesignError::NotAShare(share));
        }
    } else if !(target > 0.0 && target.is_finite()) {
        return Err(DesignError::NotPositive(wanted));
    }
    match wanted.load() {
        Some(Load::Force(_)) if wanted.is_pressed_force() => {
            return Err(DesignError::NotALoad(wanted));
        }
        None if wanted.is_share() || matches!(wanted, Wanted::Pressed { .. }) => {
            return Err(DesignError::NotALoad(wanted));
        }
        Some(Load::Force(size) | Load::Indentation(size)) if !(size > 0.0 && size.is_finite()) => {
            return Err(DesignError::NotALoad(wanted));
        }
        _ => {}
    }
    let first = first_value(file, free)?;
    let begin = changed(file, free, first);
    let case = begin.any_case(wanted.questions())?;
    if is_on_map {
        let indenter = begin.surface_case(run.memory_limit())?;
        let is_plate = indenter.system.indenter().lens().is_none();
        if is_plate && wanted.dimension() == Dimension::Length {
            return Err(DesignError::NoRadius);
        }
    }
    if wanted.is_pull_off() && !case.is_adhesive() {
        return Err(DesignError::NoAdhesion);
    }
    let is_flat = matches!(case, AnyCase::Pillars(_));
    let mut search = Search {
        file,
        free,
        wanted,
        run,
        range: range(&begin, free, first, &case),
        distance: distance(free, first, &case),
        method: Some(Method::Homogenised),
        has_outlines: is_flat && !wanted.is_coarse(),
        is_on_map,
        is_adhesive: case.is_adhesive(),
    };
    let estimate = if !is_flat || wanted.is_pull_off() {
        // The homogenised lattice has no adhesion and no rounded tops.
        None
    } else {
        search.estimate(first)?
    };
    search.method = None;
    let ending = match estimate {
        Some(value) => match search.find(value, STRIDES[0]) {
            Err(DesignError::Solve(error))
                if wanted.is_share() && error != SolveError::Interrupted =>
            {
                search.find(first, STRIDES[1])?
            }
            ending => ending?,
        },
        None => search.find(first, STRIDES[1])?,
    };
    Ok(match ending {
        Ending::Found(candidate) => Design::Found {
            sensitivity: search.sensitivity(&candidate)?,
            candidate,
        },
        Ending::Jump(sides) => Design::Jump(sides),
        Ending::OutOfReach(nearest, limit, reach) => Design::OutOfReach {
            nearest: search.exactly(nearest)?,
            limit,
            reach: reach.filter(|_| wanted.is_pull_off()),
        },
    })
}

/// End of a search.
enum Ending {
    Found(Candidate),
    Jump(Box<[Candidate; 2]>),
    /// Closest value, its limit, and the smallest and largest result if the whole range was searched.
    OutOfReach(Candidate, Limit, Option<[f64; 2]>),
}

/// Sets a key of the case to a value in SI units.
fn changed(file: &CaseFile, key: Key, value: f64) -> CaseFile {
    let mut file = file.clone();
    file.set_number(key, value);
    file
}

/// The case with such a value.
fn with(file: &CaseFile, key: Key, value: f64) -> Result<AnyCase, CaseError> {
    changed(file, key, value).any_case(&[])
}

/// Start: the value in the case file, or a value in proportion to the others.
fn first_value(file: &CaseFile, free: Key) -> Result<f64, DesignError> {
    let case = file.any_case(&[]);
    let given = case.as_ref().ok().and_then(|case| case.number(free));
    if let Some(value) = given.filter(|value| *value > 0.0) {
        return Ok(value);
    }
    if matches!(case, Ok(AnyCase::HeightMap(_))) {
        return Err(DesignError::NotGiven(free));
    }
    if let (Ok(case), Key::SubstrateThickness | Key::LensThickness) = (&case, free) {
        // A half-space is thicker than the lens is wide.
        return Ok(widest(case));
    }
    if free.dimension() == Dimension::EnergyPerArea {
        return Ok(USUAL_WORK);
    }
    // Only the free key may be missing.
    let guess = GUESSES
        .iter()
        .find(|guess| with(file, free, **guess).is_ok());
    match (guess, case) {
        (Some(guess), _) => Ok(*guess),
        (None, Err(error)) => Err(error.into()),
        (None, Ok(_)) => {
            with(file, free, GUESSES[0])?;
            Err(DesignError::NotFree(free))
        }
    }
}

/// Work of adhesion between a rubber and a smooth solid, J/m^2.
const USUAL_WORK: f64 = 0.05;

/// Values, in SI units; at least one is within the range of each quantity of a pattern.
const GUESSES: [f64; 9] = [1e6, 0.1, 1e-3, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 1e-7];

/// Ends of the search by the distance from its start. A start closer to the target may succeed where the search ends there.
fn distance(free: Key, first: f64, case: &AnyCase) -> [f64; 2] {
    let is_of_height = matches!(
        free,
        Key::PatternHeight | Key::HeightUnit | Key::HeightRange
    );
    let farthest = match case {
        AnyCase::HeightMap(_) if is_of_height || free.dimension() == Dimension::Pressure => 1e3,
        // Other lengths change the number of cells in contact, and with adhesion a loading takes minutes.
        AnyCase::HeightMap(_) => 30.0,
        _ => 1e6,
    };
    [first / farthest, first * farthest]
}

/// Value given in the case file for the key that limits this one, for a work of adhesion: the receding work is at least the other. A receding work that
/// is not given follows the work of adhesion and does not limit it.
fn limiting(file: &CaseFile, free: Key) -> Option<(Key, f64)> {
    let other = match free {
        Key::WorkOfAdhesion => Key::RecedingWorkOfAdhesion,
        Key::RecedingWorkOfAdhesion => Key::WorkOfAdhesion,
        _ => return None,
    };
    let given = file.given(other).ok().flatten();
    given.filter(|work| *work > 0.0).map(|work| (other, work))
}

/// Range of the search: all valid values, up to a [distance] from the start. The case file contains the start.
fn range(file: &CaseFile, free: Key, first: f64, case: &AnyCase) -> [f64; 2] {
    /// Modulus of very soft gels, Pa, which the search reaches from any modulus of the case.
    const SOFTEST: f64 = 100.0;
    /// Largest thickness in widths of the lens; beyond, a thickness has no measurable effect.
    const THICKEST: f64 = 1e3;
    /// Relative distance from a bound that is not valid itself.
    const MARGIN: f64 = 1e-3;
    let (least, greatest) = match case {
        AnyCase::Pillars(case) => case.allowed(free),
        AnyCase::Asperities(case) => case.allowed(free),
        AnyCase::HeightMap(_) | AnyCase::Flat(_) => free.bounds(),
    };
    let [nearest, farthest] = distance(free, first, case);
    let least = match least {
        Bound::Included(least) if least > 0.0 => least,
        Bound::Excluded(least) if least > 0.0 => least * (1.0 + MARGIN),
        Bound::Included(_) | Bound::Excluded(_) | Bound::Unbounded => {
            match (case, free.dimension()) {
                (AnyCase::HeightMap(_), _) => nearest,
                (_, Dimension::Pressure) => SOFTEST.min(nearest),
                _ => nearest,
            }
        }
    };
    let greatest = match greatest {
        Bound::Included(greatest) => greatest,
        Bound::Excluded(greatest) => greatest * (1.0 - MARGIN),
        Bound::Unbounded => farthest,
    };
    // Pillars as wide as the lens, or as far apart, are not a pattern.
    let widest = widest(case);
    match free {
        Key::SubstrateThickness | Key::LensThickness => {
            [least, greatest.min(THICKEST * widest).max(first)]
        }
        Key::WorkOfAdhesion => {
            let receding = limiting(file, free).map_or(f64::INFINITY, |(_, work)| work);
            [least, greatest.min(receding)]
        }
        Key::RecedingWorkOfAdhesion => {
            let work = limiting(file, free).map_or(0.0, |(_, work)| work);
            [least.max(work), greatest]
        }
        Key::Pitch | Key::PillarDiameter => [least, greatest.min(widest.max(first))],
        Key::SurfaceFraction => {
            let diameter = case.number(Key::PillarDiameter).unwrap_or(widest);
            let part = diameter / widest;
            [(greatest * part * part).min(first), greatest]
        }
        _ => [least, greatest],
    }
}

/// Width of the lens, m.
fn widest(case: &AnyCase) -> f64 {
    /// Assumed width of a plate, which is unlimited.
    const LARGEST_PITCHES: f64 = 1e6;
    let (widest, pitch) = match case {
        AnyCase::Pillars(case) => (case.system.lens().widest(), case.system.pitch()),
        AnyCase::Asperities(case) => {
            let lens = case.field.indenter().lens();
            let pitch = Some(case.spacing()).filter(|spacing| *spacing > 0.0);
            let widest = lens.map_or(f64::INFINITY, ShapedLens::widest);
            (widest, pitch.unwrap_or(2.0 * case.height))
        }
        AnyCase::HeightMap(_) => (f64::INFINITY, f64::INFINITY),
        AnyCase::Flat(flat) => {
            let widest = flat.system.lens().widest();
            let radius = case.number(Key::LensRadius).unwrap_or(widest);
            (radius.min(widest), f64::INFINITY)
        }
    };
    widest.min(LARGEST_PITCHES * pitch)
}

struct Search<'a> {
    file: &'a CaseFile,
    free: Key,
    wanted: Wanted,
    run: &'a Run<'a>,
    range: [f64; 2],
    /// Ends of the search by the [distance] from its start.
    distance: [f64; 2],
    /// Method of the trials if it differs from that of the case.
    method: Option<Method>,
    /// Whether the homogenised lattice is an estimate of the contacts of the case.
    has_outlines: bool,
    /// Whether the surface is a height map.
    is_on_map: bool,
    /// Whether the surface is adhesive.
    is_adhesive: bool,
}

/// The contact at one value.
#[derive(Clone)]
struct Trial {
    /// The logarithm of the value, `ln x`.
    position: f64,
    outcome: Result<Candidate, Limit>,
    /// Deviation from the target; infinite if there is no contact.
    excess: f64,
    /// Estimated error of the deviation.
    error: f64,
    /// Estimated error of the deviation where the result jumps.
    error_of_jump: f64,
}

impl Trial {
    fn is_met(&self) -> bool {
        within(self.excess.abs(), TOLERANCE.max(SHARPNESS * self.error))
    }

    /// Whether it meets the target within its error.
    fn may_be_met(&self) -> bool {
        within(
            self.excess.abs(),
            TOLERANCE.max(self.error).max(self.error_of_jump),
        )
    }

    /// For the root search: a trial that meets the target is a root.
    fn point(&self) -> Point {
        Point {
            position: self.position,
            value: if self.is_met() { 0.0 } else { self.excess },
        }
    }

    fn limit(&self) -> Limit {
        match &self.outcome {
            Err(limit) => limit.clone(),
            Ok(candidate) if candidate.reached.is_floor_first() => Limit::FloorFirst,
            Ok(_) => Limit::Range,
        }
    }
}

/// A search over the whole range that did not find the target.
struct Missed {
    trials: Vec<Trial>,
    /// Values just beyond the last trials, downwards and upwards, for which no floor share can be
    /// computed.
    unsolved: [Option<Trial>; 2],
}

/// Reason why a required contact does not exist.
fn no_contact(limit: Limit, key: Key) -> DesignError {
    match limit {
        Limit::Solver(error) => error.into(),
        Limit::Invalid(_) => DesignError::NotFree(key),
        Limit::NotConverged => DesignError::NotConverged(key),
        _ => DesignError::TooManyPillars(key),
    }
}

impl Search<'_> {
    /// Value for the homogenised lattice, if it exists.
    fn estimate(&self, first: f64) -> Result<Option<f64>, DesignError> {
        match self.find(first, STRIDES[1]) {
            Ok(Ending::Found(candidate) | Ending::OutOfReach(candidate, ..)) => {
                Ok(Some(candidate.value))
            }
            Err(DesignError::Solve(SolveError::Interrupted)) => Err(SolveError::Interrupted.into()),
            _ => Ok(None),
        }
    }

    fn trial(&self, position: f64) -> Result<Trial, DesignError> {
        let value = clamped(position.exp(), self.range[0], self.range[1]);
        if self.method.is_none()
            && self.has_outlines
            && let Ok(outline) = self.trial_by(Some(Method::Homogenised), value)
            && self.is_clear(&outline, value)?
        {
            return Ok(Trial {
                position,
                ..outline
            });
        }
        let mut trial = self.trial_by(self.method, value)?;
        // A contact that does not converge is rare; one beside it does.
        for shift in [-ASIDE, ASIDE] {
            if trial.outcome.as_ref().err() == Some(&Limit::NotConverged) {
                trial = self.trial_by(self.method, value * (1.0 + shift))?;
            }
        }
        Ok(Trial { position, ..trial })
    }

    /// Whether a result of the homogenised lattice is sufficient for the search.
    fn is_clear(&self, outline: &Trial, value: f64) -> Result<bool, DesignError> {
        Ok(match &outline.outcome {
            Ok(candidate) => {
                let contact = candidate.reached.contact();
                let is_wide = contact.is_some_and(|it| it.pillars_in_contact > MANY_PILLARS);
                is_wide && outline.excess.abs() > CLEAR
            }
            // With this many pillars its contact radius is accurate to one per cent.
            Err(Limit::Solver(SolveError::ContactExceedsLens { lens_radius, .. })) => {
                let case = with(self.file, self.free, value)?;
                case.pattern().is_some_and(|case| {
                    let widest = 0.5 * lens_radius / case.system.pitch();
                    widest * widest > MANY_PILLARS as f64
                })
            }
            Err(_) => false,
        })
    }

    fn trial_by(&self, method: Option<Method>, value: f64) -> Result<Trial, DesignError> {
        let mut case = with(self.file, self.free, value)?;
        if let (Some(method), AnyCase::Pillars(case)) = (method, &mut case) {
            case.method = method;
        }
        if self.wanted.is_pull_off() && self.has_many_pillars(&case)? {
            return Ok(Trial {
                position: value.ln(),
                outcome: Err(Limit::ManyPillars),
                excess: f64::INFINITY,
                error: 0.0,
                error_of_jump: 0.0,
            });
        }
        let outcome = match self.reached(&case) {
            Ok(reached) if !reached.solution().converged() => Err(Limit::NotConverged),
            Ok(reached) => Ok(Candidate {
                value,
                case,
                reached,
            }),
            Err(DesignError::Solve(
                error @ (SolveError::ContactExceedsLens { .. }
                | SolveError::ProfileEnds { .. }
                | SolveError::TooLarge { .. }
                | SolveError::PatternTooDense { .. }
                | SolveError::ContactsMerge { .. }
                | SolveError::TouchedAtRim { .. }
                | SolveError::LayerTooThin { .. }
                | SolveError::FloorCovered),
            )) => Err(Limit::Solver(error)),
            // Memory for the grid on the floor of wide lattices.
            Err(DesignError::Solve(error @ SolveError::TooManyCells { .. }))
                if self.wanted.is_share() =>
            {
                Err(Limit::Solver(error))
            }
            Err(DesignError::Solve(error))
                if self.is_on_map && error != SolveError::Interrupted =>
            {
                Err(Limit::Solver(error))
            }
            Err(DesignError::Case(error)) if self.is_on_map => {
                Err(Limit::Invalid(error.to_string()))
            }
            Err(error) => return Err(error),
        };
        let error_of_jump = outcome.as_ref().map_or(0.0, |candidate| {
            self.wanted.error_of_jump(&candidate.reached)
        });
        let (excess, error) = match &outcome {
            // A method without floor contact finds the transition, where the share starts from
            // zero.
            Ok(candidate) if self.wanted.is_share() && method.is_some() => {
                (-candidate.reached.to_the_floor(), 0.0)
            }
            Ok(candidate) => (
                self.wanted.excess(&candidate.reached),
                self.wanted.excess_error(&candidate.reached),
            ),
            Err(_) => (f64::INFINITY, 0.0),
        };
        Ok(Trial {
            position: value.ln(),
            outcome,
            excess,
            error,
            error_of_jump,
        })
    }

    /// The contact to which the target applies.
    fn reached(&self, case: &AnyCase) -> Result<Reached, DesignError> {
        let plan = |load: Load| CyclePlan {
            turn: load.into(),
            ..CyclePlan::default()
        };
        Ok(match (case, self.wanted) {
            (AnyCase::HeightMap(file), Wanted::FloorShare { load, .. }) => {
                let answered = self.on_map(file, |system| {
                    let contact = system.press(load, self.run)?;
                    contact.shares.map(|_| contact).ok_or(SolveError::NoFloor)
                })?;
                Reached::PressedOnMap(Box::new(answered))
            }
            (AnyCase::HeightMap(file), Wanted::PullOff { load, .. }) => {
                let answered = self.on_map(file, |system| system.cycle(plan(load), self.run))?;
                Reached::PulledOffOnMap(Box::new(answered))
            }
            (AnyCase::HeightMap(file), Wanted::Pressed { load, .. }) => {
                let answered = self.on_map(file, |system| system.press(load, self.run))?;
                Reached::PressedOnMap(Box::new(answered))
            }
            (AnyCase::HeightMap(file), _) => {
                let answered = self.on_map(file, |system| system.transition(self.run))?;
                Reached::CriticalOnMap(Box::new(answered))
            }
            (
                AnyCase::Pillars(case),
                Wanted::FloorShare { load, .. } | Wanted::Pressed { load, .. },
            ) => {
                let contact = fakir::press(&case.system, load, case.method, self.run)?;
                Reached::Pressed(contact)
            }
            (AnyCase::Pillars(case), Wanted::PullOff { load, .. }) => {
                let cycle = fakir::cycle(&case.system, plan(load), case.method, self.run)?;
                Reached::PulledOff(Box::new(cycle))
            }
            (AnyCase::Pillars(case), _) => {
                let critical = fakir::transition(&case.system, case.method, self.run)?;
                Reached::Critical(critical)
            }
            (AnyCase::Asperities(case), Wanted::PullOff { load, .. }) => {
                let cycle = case.field.cycle(plan(load), case.accuracy, self.run)?;
                Reached::PulledOffTops(Box::new(cycle))
            }
            (AnyCase::Asperities(case), Wanted::Force(_) | Wanted::ContactRadius(_)) => {
                let critical = case.field.transition(case.accuracy, self.run)?;
                Reached::CriticalOfTops(Box::new(critical))
            }
            (
                AnyCase::Asperities(case),
                Wanted::FloorShare { load, .. } | Wanted::Pressed { load, .. },
            ) => {
                let contact = case.field.press(load, case.accuracy, self.run)?;
                Reached::PressedTops(Box::new(contact))
            }
            (AnyCase::Flat(case), Wanted::Pressed { load, .. }) => {
                Reached::PressedFlat(Box::new(case.system.press(load, self.run)?))
            }
            (AnyCase::Flat(case), Wanted::PullOff { load, .. }) => {
                Reached::PulledOffFlat(Box::new(case.system.cycle(&plan(load), self.run)?))
            }
            // A flat surface has no critical state and no floor, and these targets are refused before.
            (AnyCase::Flat(_), _) => return Err(SolveError::NoFloor.into()),
        })
    }

    /// Solves a problem on a height map, on a grid that is wide enough.
    fn on_map<T>(
        &self,
        file: &CaseFile,
        ask: impl Fn(&SurfaceSystem) -> Result<T, SolveError>,
    ) -> Result<Answered<T>, DesignError> {
        let needed = |error: &DesignError| match error {
            DesignError::Solve(error) => error.needed_width(),
            _ => None,
        };
        on_wide_enough_a_grid(file, self.run.memory_limit(), needed, |case| {
            Ok(ask(&case.system)?)
        })
    }

    /// Whether an unsolved contact gives no information, and whether the accuracy is limited by an estimated error.
    fn is_coarse(&self) -> bool {
        self.wanted.is_coarse() || self.is_on_map
    }

    /// Whether, according to the homogenised lattice, too many pillars are in contact at the transition for a cycle.
    fn has_many_pillars(&self, case: &AnyCase) -> Result<bool, DesignError> {
        let Some(case) = case.pattern() else {
            return Ok(false);
        };
        let system = case.system.without_adhesion();
        match fakir::transition(&system, Method::Homogenised, self.run) {
            Ok(critical) => Ok(critical.contact.pillars_in_contact > MANY_PILLARS),
            Err(SolveError::Interrupted) => Err(SolveError::Interrupted.into()),
            // The method of the case decides whether the contact can be solved.
            Err(_) => Ok(false),
        }
    }

    /// Solves the candidate with the method of the case, if the search used an estimate. Returns a nearby
    /// candidate if the contact is slightly wider than estimated and cannot be solved.
    fn exactly(&self, candidate: Candidate) -> Result<Candidate, DesignError> {
        let method = |case: &AnyCase| case.pattern().map(|case| case.method);
        let case = with(self.file, self.free, candidate.value)?;
        if method(&candidate.case) == method(&case) {
            return Ok(candidate);
        }
        let mut failure = None;
        for shift in [0.0, -EDGE, EDGE, -10.0 * EDGE, 10.0 * EDGE] {
            let value = candidate.value * (1.0 + shift);
            if !(self.range[0]..=self.range[1]).contains(&value) {
                continue;
            }
            match self.trial_by(None, value)?.outcome {
                Ok(candidate) => return Ok(candidate),
                Err(Limit::Solver(
                    error
                    @ (SolveError::ContactExceedsLens { .. } | SolveError::ProfileEnds { .. }),
                )) => {
                    failure = Some(error);
                }
                Err(limit) => return Err(no_contact(limit, self.free)),
            }
        }
        Err(failure.map_or(DesignError::NotPositive(self.wanted), DesignError::Solve))
    }

    fn find(&self, first: f64, stride: f64) -> Result<Ending, DesignError> {
        let start = self.trial(clamped(first, self.range[0], self.range[1]).ln())?;
        if start.is_met()
            && let Ok(candidate) = start.outcome
        {
            return Ok(Ending::Found(candidate));
        }
        if self.is_coarse()
            && let Err(limit) = start.outcome
        {
            return Err(no_contact(limit, self.free));
        }
        match self.bracket(start, stride)? {
            Ok(bracket) => self.close_in_and_beside(bracket),
            Err(missed) => self.nearest(missed),
        }
    }

    /// Two neighbouring trials with the target between them; if there are none, all trials over the
    /// range.
    fn bracket(
        &self,
        start: Trial,
        stride: f64,
    ) -> Result<Result<[Trial; 2], Missed>, DesignError> {
        let ends = self.range.map(f64::ln);
        let mut trials = vec![start.clone()];
        let mut fronts = [start.clone(), start]; // downwards and upwards
        let mut strides = [stride; 2];
        let mut unsolved: [Option<Trial>; 2] = [None, None];
        let side_done = |fronts: &[Trial; 2], unsolved: &[Option<Trial>; 2], side: usize| {
            let front = fronts[side].position;
            match (&unsolved[side], side) {
                (Some(beyond), _) => (beyond.position - front).abs() < EDGE,
                (None, 0) => front <= ends[0],
                (None, _) => front >= ends[1],
            }
        };
        // Upwards first; then the side whose result is closer to the target.
        let mut side = 1;
        while !(side_done(&fronts, &unsolved, 0) && side_done(&fronts, &unsolved, 1)) {
            if side_done(&fronts, &unsolved, side) {
                side = 1 - side;
            }
            let front = fronts[side].position;
            let next = match &unsolved[side] {
                Some(beyond) => f64::midpoint(front, beyond.position),
                None => {
                    let sign = if side == 1 { 1.0 } else { -1.0 };
                    clamped(front + sign * strides[side], ends[0], ends[1])
                }
            };
            strides[side] *= 2.0;
            let trial = self.trial(next)?;
            // A contact that cannot be solved has no floor share or pull-off force: the range ends
            // before it.
            if self.is_coarse() && trial.outcome.is_err() {
                unsolved[side] = Some(trial);
                continue;
            }
            if trial.excess.signum() != fronts[side].excess.signum() || trial.is_met() {
                let mut bracket = [fronts[side].clone(), trial];
                if side == 0 {
                    bracket.reverse();
                }
                match self.end_of_contacts(&mut bracket)? {
                    // The range ends here, farther from the target than elsewhere.
                    Some([last, beyond])
                        if trials.iter().any(|it| it.excess.abs() < last.excess.abs()) =>
                    {
                        trials.push(last.clone());
                        fronts[side] = last;
                        unsolved[side] = Some(beyond);
                        side = 1 - side;
                        continue;
                    }
                    _ => {
                        return Ok(Ok(bracket));
                    }
                }
            }
            trials.push(trial.clone());
            let nearer = trial.excess.abs() < fronts[side].excess.abs();
            fronts[side] = trial;
            if !nearer {
                side = 1 - side;
            }
        }
        Ok(Err(Missed { trials, unsolved }))
    }

    /// Narrows a bracket one of whose ends has no contact. Returns the last contact and the trial beyond it; `None` if both ends have a contact, at first
    /// or after the bracket is narrowed.
    fn end_of_contacts(&self, bracket: &mut [Trial; 2]) -> Result<Option<[Trial; 2]>, DesignError> {
        if bracket.iter().all(|trial| trial.outcome.is_ok()) {
            return Ok(None);
        }
        self.narrow(bracket, EDGE)?;
        let [low, high] = bracket.clone();
        Ok(match (low.outcome.is_ok(), high.outcome.is_ok()) {
            (true, false) => Some([low, high]),
            (false, true) => Some([high, low]),
            _ => None,
        })
    }

    /// Refines the bracket between two trials. If the result jumps there past the target, it may have the target on one of the sides of the jump.
    fn close_in_and_beside(&self, sides: [Trial; 2]) -> Result<Ending, DesignError> {
        /// Distance from the jump and first step, in `ln x`.
        const FARTHEST: f64 = 1.4;
        const STEP: f64 = 0.05;
        let ending = self.close_in(sides)?;
        let Ending::Jump(jump) = &ending else {
            return Ok(ending);
        };
        if self.is_coarse() {
            return Ok(ending);
        }
        for (jumped, sign) in jump.iter().zip([-1.0, 1.0]) {
            let begin = jumped.value.ln();
            let excess = self.wanted.excess(&jumped.reached);
            let ends = self.range.map(f64::ln);
            let (mut last, mut step) = (begin, STEP);
            while (last - begin).abs() < FARTHEST {
                let next = clamped(last + sign * step, ends[0], ends[1]);
                let trial = self.trial(next)?;
                if trial.outcome.is_err() || next.to_bits() == last.to_bits() {
                    break;
                }
                if trial.excess.signum() != excess.signum() {
                    let mut bracket = [self.trial(last)?, trial];
                    bracket.sort_by(|a, b| a.position.total_cmp(&b.position));
                    let other = self.close_in(bracket)?;
                    if matches!(other, Ending::Found(_)) {
                        return Ok(other);
                    }
                    break;
                }
                (last, step) = (next, 2.0 * step);
            }
        }
        Ok(ending)
    }

    /// Refines the bracket between two trials. At the limit of contacts, a rough search is sufficient; between
    /// two values it continues.
    fn close_in(&self, mut sides: [Trial; 2]) -> Result<Ending, DesignError> {
        let mut root = self.narrow(&mut sides, EDGE)?;
        if sides.iter().all(|trial| trial.excess.is_finite()) {
            let width = match self.is_coarse() {
                true if self.is_on_map => JUMP_OF_CELLS,
                true => COARSE_JUMP,
                false => JUMP,
            };
            root = self.narrow(&mut sides, width)?;
        }
        if let Some(Change::Crossing(_)) = root.map(|root| root.change(TOLERANCE))
            && let Some(met) = sides.iter().find(|side| side.is_met())
            && let Ok(candidate) = &met.outcome
        {
            return Ok(Ending::Found(candidate.clone()));
        }
        let nearer = usize::from(sides[1].excess.abs() < sides[0].excess.abs());
        if sides[nearer].may_be_met()
            && let Ok(candidate) = &sides[nearer].outcome
        {
            return Ok(Ending::Found(candidate.clone()));
        }
        self.edge(&sides)
    }

    /// Narrows the bracket until the relative difference of the two values is at most the given one, or one of them
    /// meets the target.
    fn narrow(&self, sides: &mut [Trial; 2], width: f64) -> Result<Option<Root>, DesignError> {
        let ends = [sides[0].point(), sides[1].point()];
        let size = ends[0].position.abs().max(ends[1].position.abs());
        roots::find(ends, width / size, |position| {
            let trial = self.trial(position)?;
            let point = trial.point();
            let side = usize::from((point.value > 0.0) == (sides[1].excess > 0.0));
            sides[side] = trial;
            Ok(point.value)
        })
    }

    /// The outcome if a bracket has become narrow without a value that meets the target.
    fn edge(&self, [low, high]: &[Trial; 2]) -> Result<Ending, DesignError> {
        match (low.outcome.clone(), high.outcome.clone()) {
            (Ok(a), Ok(b)) if low.excess.is_finite() && high.excess.is_finite() => {
                Ok(Ending::Jump(Box::new([a, b])))
            }
            (Ok(nearest), _) if low.excess.is_finite() => {
                Ok(Ending::OutOfReach(nearest, high.limit(), None))
            }
            (_, Ok(nearest)) => Ok(Ending::OutOfReach(nearest, low.limit(), None)),
            (_, Err(limit)) => Err(no_contact(limit, self.free)),
        }
    }

    /// The outcome if the target is on one side of all trials: the closest value, searched for
    /// between the neighbours of the closest trial.
    fn nearest(&self, missed: Missed) -> Result<Ending, DesignError> {
        let Missed {
            mut trials,
            unsolved,
        } = missed;
        trials.sort_by(|a, b| a.position.total_cmp(&b.position));
        let answers = trials
            .iter()
            .filter_map(|trial| trial.outcome.as_ref().ok());
        let answer = |candidate: &Candidate| {
            let error = self.wanted.relative_error(&candidate.reached);
            [self.wanted.of(&candidate.reached), error]
        };
        let mut answers: Vec<[f64; 2]> = answers.map(answer).collect();
        let farness = |trial: &Trial| trial.excess.abs();
        let Some(best) =
            (0..trials.len()).min_by(|a, b| farness(&trials[*a]).total_cmp(&farness(&trials[*b])))
        else {
            return Err(DesignError::NotPositive(self.wanted));
        };
        let last = trials.len() - 1;
        let (mut low, mut high) = (
            trials[best.saturating_sub(1)].clone(),
            trials[(best + 1).min(last)].clone(),
        );
        let mut best = trials[best].clone();
        while high.position - low.position > EDGE {
            // Golden section in the larger of the two intervals.
            let (gaps, golden) = (
                [best.position - low.position, high.position - best.position],
                0.381_966,
            );
            let position = if gaps[1] > gaps[0] {
                best.position + golden * gaps[1]
            } else {
                best.position - golden * gaps[0]
            };
            let trial = self.trial(position)?;
            if trial.excess.signum() != best.excess.signum() {
                let mut bracket = [best, trial];
                bracket.sort_by(|a, b| a.position.total_cmp(&b.position));
                return self.close_in_and_beside(bracket);
            }
            let (inner, outer) = if farness(&trial) < farness(&best) {
                (trial, best)
            } else {
                (best, trial)
            };
            if outer.position < inner.position {
                low = outer;
            } else {
                high = outer;
            };
            best = inner;
        }
        let mut unsolved = unsolved.iter().flatten();
        let beyond = unsolved.find(|trial| (trial.position - best.position).abs() < 2.0 * EDGE);
        let at_end = |end: &f64| (end.ln() - best.position).abs() < 2.0 * EDGE;
        let limit = match (beyond, self.range.iter().position(at_end)) {
            (Some(trial), _) => trial.limit(),
            (None, Some(side)) => self.limit_at(side),
            (None, None) => Limit::Range,
        };
        match best.outcome {
            Ok(candidate) => {
                answers.push(answer(&candidate));
                answers.sort_by(|a, b| a[0].total_cmp(&b[0]));
                let [least, greatest] = [answers[0], answers[answers.len() - 1]];
                let noise = (least[1] + greatest[1]).clamp(NO_EFFECT, MOST_NOISE);
                let limit = match within(greatest[0] - least[0], noise * greatest[0]) {
                    true => self.no_effect(),
                    false => limit,
                };
                let reach = [least[0], greatest[0]];
                Ok(Ending::OutOfReach(candidate, limit, Some(reach)))
            }
            Err(limit) => Err(no_contact(limit, self.free)),
        }
    }

    /// Reason why the result is the same for all values: a given receding work alone determines the pull-off force.
    fn no_effect(&self) -> Limit {
        match limiting(self.file, self.free) {
            Some((key @ Key::RecedingWorkOfAdhesion, value)) if self.wanted.is_pull_off() => {
                Limit::Given(key, value)
            }
            _ => Limit::NoEffect,
        }
    }

    /// Reason why the search ends at the lower or upper end of its range.
    fn limit_at(&self, side: usize) -> Limit {
        let end = self.range[side];
        let is_far = match side {
            0 => end <= self.distance[0],
            _ => end >= self.distance[1],
        };
        match limiting(self.file, self.free) {
            _ if is_far => Limit::Distance(self.range),
            Some((key, value)) if (value / end - 1.0).abs() < EDGE => Limit::Given(key, value),
            _ => Limit::SearchEnd,
        }
    }

    /// Sensitivity `d ln(result)/d ln(x)` by a central difference.
    fn sensitivity(&self, found: &Candidate) -> Result<f64, DesignError> {
        // Floor shares and pull-off forces have fewer significant digits and require a longer step.
        let step = match self.is_coarse() {
            true if self.is_on_map && self.is_adhesive => STEP_WITH_ADHESION,
            true if self.is_on_map => 5e-2,
            true => 1e-2,
            false => 1e-3,
        };
        let middle = found.value.ln();
        let sides = [self.trial(middle - step)?, self.trial(middle + step)?];
        let logarithm = |candidate: &Candidate| {
            let answer = self.wanted.of(&candidate.reached) / self.wanted.value();
            (answer > 0.0).then(|| (candidate.value.ln(), answer.ln()))
        };
        let logarithms = sides.map(|trial| match &trial.outcome {
            Ok(candidate) => logarithm(candidate),
            // A long step may lead to a contact that cannot be solved.
            Err(_) if self.is_on_map => logarithm(found),
            Err(_) => None,
        });
        Ok(match logarithms {
            [Some(low), Some(high)] if high.0 > low.0 => (high.1 - low.1) / (high.0 - low.0),
            _ => f64::NAN,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir_case::Case;

    fn flat(case: &AnyCase) -> &Case {
        case.pattern().unwrap()
    }

    fn paper(surface_fraction: f64) -> CaseFile {
        let mut file = CaseFile::parse("paper", &Case::example().to_toml()).unwrap();
        file.set_number(Key::SurfaceFraction, surface_fraction);
        file
    }

    /// The same as a rectangular lattice, which has a second pitch.
    fn rectangular(surface_fraction: f64) -> CaseFile {
        let mut file = paper(surface_fraction);
        let pitch = file.case().unwrap().system.pitch();
        file.set("pattern.lattice=rectangular").unwrap();
        file.set_number(Key::Pitch, pitch);
        file.set_number(Key::PitchY, 1.1 * pitch);
        file
    }

    /// Takes the critical force of a case, removes one quantity, and finds it again.
    #[test]
    fn every_free_quantity_is_found_again() {
        let run = Run::default();
        for surface_fraction in [1e-3, 0.05] {
            let by_pitch = {
                let case = paper(surface_fraction).case().unwrap();
                let mut file = paper(surface_fraction);
                file.set_number(Key::Pitch, case.system.pitch());
                file
            };
            // The cases have no adhesion, layers or rounded tops.
            let is_here = |key: &Key| {
                let is_work = key.dimension() == Dimension::EnergyPerArea;
                let is_other = key.is_of_layers() || key.is_of_surface() || is_work;
                !is_other && *key != Key::TopRadius
            };
            for free in free_keys().into_iter().filter(is_here) {
                let file = match free {
                    Key::SurfaceFraction => paper(surface_fraction),
                    Key::PitchY => rectangular(surface_fraction),
                    _ => by_pitch.clone(),
                };
                let case = file.case().unwrap();
                let truth = file.given(free).unwrap().unwrap();
                let critical = fakir::transition(&case.system, case.method, &run).unwrap();
                let mut other = file.clone();
                other.set_number(free, truth * 0.7);
                let wanted = Wanted::Force(critical.contact.force);
                let Design::Found {
                    candidate: found,
                    sensitivity,
                } = design(&other, free, wanted, &run).unwrap()
                else {
                    panic!("{} at {surface_fraction}", free.path());
                };
                // The force on a single pillar hardly depends on the pitch.
                let alone = critical.contact.pillars_in_contact == 1;
                if alone && [Key::Pitch, Key::PitchY, Key::SurfaceFraction].contains(&free) {
                    assert!(sensitivity.abs() < 0.1);
                } else {
                    let error = (found.value / truth - 1.0).abs();
                    assert!(error < 1e-6, "{}: {error:e}", free.path());
                }
                // The case file of the result gives the target force.
                let written = CaseFile::parse("found", &flat(&found.case).to_toml())
                    .unwrap()
                    .case()
                    .unwrap();
                assert_eq!(
                    written.number(free).map(f64::to_bits),
                    Some(found.value.to_bits())
                );
                let again = fakir::transition(&written.system, written.method, &run).unwrap();
                assert!((again.contact.force / critical.contact.force - 1.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn a_contact_radius_can_be_the_target_and_a_key_can_be_missing() {
        let text = Case::example().to_toml();
        let without: String = text
            .lines()
            .filter(|line| !line.starts_with("surface_fraction"))
            .map(|line| format!("{line}\n"))
            .collect();
        let file = CaseFile::parse("without", &without).unwrap();
        let run = Run::default();
        let wanted = Wanted::ContactRadius(100e-6);
        match design(&file, Key::Pitch, wanted, &run).unwrap() {
            Design::Found {
                candidate: found, ..
            } => {
                let radius = wanted.of(&found.reached);
                assert!((radius / 100e-6 - 1.0).abs() < 2.0 * TOLERANCE);
            }
            // The contact radius jumps where further pillars come into contact.
            Design::Jump(sides) => {
                let [a, b] = sides.map(|side| wanted.of(&side.reached));
                assert!((a - 100e-6) * (b - 100e-6) < 0.0);
            }
            Design::OutOfReach { .. } => panic!("100 um can be had"),
        }
    }

    /// For any pitch, one pillar under the axis carries load: smaller forces are unattainable.
    #[test]
    fn what_cannot_be_had_is_answered_with_the_nearest() {
        let run = Run::default();
        // A small lens, for which even a dense pattern has a small critical force.
        let mut file = paper(0.01);
        file.set_number(Key::LensRadius, 3e-4);
        let forces: Vec<f64> = (0..40)
            .filter_map(|k| {
                let case = with(&file, Key::Pitch, 6e-6 * 1.1f64.powi(k)).unwrap();
                let case = flat(&case);
                fakir::transition(&case.system, case.method, &run).ok()
            })
            .map(|critical| critical.contact.force)
            .collect();
        let least = forces.iter().copied().fold(f64::INFINITY, f64::min);
        let wanted = Wanted::Force(0.5 * least);
        let Design::OutOfReach { nearest, limit, .. } =
            design(&file, Key::Pitch, wanted, &run).unwrap()
        else {
            panic!("half the least force cannot be had");
        };
        assert_eq!(limit, Limit::Range);
        let force = nearest.reached.force();
        assert!(force < least * 1.001 && force > 0.9 * least);
    }

    fn found(file: &CaseFile, free: Key, wanted: Wanted) -> Candidate {
        match design(file, free, wanted, &Run::default()).unwrap() {
            Design::Found { candidate, .. } => candidate,
            other => panic!("{wanted:?} is attainable, but: {other:?}"),
        }
    }

    /// The case file of the result, solved again, has the target share to within its estimated error.
    #[test]
    #[ignore = "slow: searches with mixed contact"]
    fn a_floor_share_is_had_by_the_case_that_is_found() {
        let run = Run::default();
        for (free, share, load) in [
            (Key::Pitch, 0.2, Load::Force(1e-3)),
            (Key::SurfaceFraction, 0.002, Load::Force(1e-3)),
            (Key::PillarHeight, 0.05, Load::Indentation(8e-6)),
            (Key::LensRadius, 0.5, Load::Indentation(12e-6)),
            (Key::SubstrateYoungModulus, 0.1, Load::Force(1e-3)),
        ] {
            let candidate = found(&paper(0.03), free, Wanted::FloorShare { share, load });
            let written = CaseFile::parse("found", &flat(&candidate.case).to_toml()).unwrap();
            let case = written.case().unwrap();
            assert_eq!(
                case.number(free).map(f64::to_bits),
                Some(candidate.value.to_bits())
            );
            let again = fakir::press(&case.system, load, case.method, &run).unwrap();
            let floor = again.floor.unwrap();
            let off = (floor.share / share - 1.0).abs();
            assert!(
                off <= floor.error.share,
                "{free}: {off:e}, known to {:e}",
                floor.error.share
            );
            // An infinite error estimate would meet any target.
            assert!(floor.error.share < 0.05, "{free}: {:e}", floor.error.share);
        }
    }

    /// The same with adhesion, where the contact is that on loading: on a floor without adhesion and on an adhesive one.
    #[test]
    #[ignore = "slow: searches with mixed contact"]
    fn a_floor_share_with_adhesion_is_had_by_the_case_that_is_found() {
        let run = Run::default();
        for floor in ["false", "true"] {
            let mut file = paper(0.02);
            for setting in [
                "pattern.lattice=square",
                "pattern.columns=3",
                "adhesion.work=5 mJ/m2",
                &format!("adhesion.floor={floor}"),
            ] {
                file.set(setting).unwrap();
            }
            let load = Load::Indentation(4e-6);
            let wanted = Wanted::FloorShare { share: 0.2, load };
            let candidate = found(&file, Key::PillarHeight, wanted);
            let case = flat(&candidate.case);
            let again = fakir::press(&case.system, load, case.method, &run).unwrap();
            let floor = again.floor.unwrap();
            let off = (floor.share / 0.2 - 1.0).abs();
            assert!(
                off <= floor.error.share && floor.error.share < 0.3,
                "{off:e}, known to {:e}",
                floor.error.share
            );
        }
    }

    /// Pillars farther apart carry less of the same force. The smallest share is just past the transition, where the
    /// pitch is nearly that of a critical force equal to the load.
    #[test]
    #[ignore = "slow: searches with mixed contact"]
    fn a_larger_floor_share_takes_a_wider_pitch() {
        let load = 1e-3;
        let critical = found(&paper(0.03), Key::Pitch, Wanted::Force(load)).value;
        let mut last = critical;
        for share in [1e-5, 0.01, 0.1, 0.5, 0.9] {
            let load = Load::Force(load);
            let wanted = Wanted::FloorShare { share, load };
            let pitch = found(&paper(0.03), Key::Pitch, wanted).value;
            assert!(pitch > last, "{share}: {pitch:e} after {last:e}");
            last = pitch;
            if share < 1e-4 {
                assert!(
                    (pitch / critical - 1.0).abs() < 0.01,
                    "{pitch:e}, {critical:e}"
                );
            }
        }
    }

    /// A candidate is a valid result only if its numbers are resolved.
    #[test]
    fn a_contact_that_is_not_resolved_is_no_answer() {
        let case = paper(0.01).case().unwrap();
        let load = Load::Indentation(1e-6);
        let mut contact = fakir::press(&case.system, load, case.method, &Run::default()).unwrap();
        assert!(Reached::Pressed(contact.clone()).is_answer());
        contact.error.force = 0.6;
        assert!(!Reached::Pressed(contact).is_answer());
    }

    /// A contact with all lengths larger by a factor of a thousand and a force larger by a million is
    /// equivalent.
    #[test]
    fn a_floor_share_is_independent_of_scale() {
        const TIMES: f64 = 1000.0;
        let small = paper(0.03);
        let mut large = small.clone();
        let case = small.case().unwrap();
        for key in [Key::LensRadius, Key::PillarDiameter, Key::PillarHeight] {
            large.set_number(key, TIMES * case.number(key).unwrap());
        }
        let of = |force: f64| Wanted::FloorShare {
            share: 0.1,
            load: Load::Force(force),
        };
        let [small, large] = [
            found(&small, Key::Pitch, of(1e-3)),
            found(&large, Key::Pitch, of(1e-3 * TIMES * TIMES)),
        ];
        // The relative error of the share is 1e-3, and its relative change is five times that of
        // the pitch.
        let ratio = large.value / small.value / TIMES;
        assert!((ratio - 1.0).abs() < 1e-4, "{ratio}");
    }

    /// With pillars that do not shorten, the contact at an indentation is the same for any modulus, up to a common factor of all
    /// forces.
    #[test]
    #[ignore = "slow: searches with mixed contact"]
    fn a_floor_share_that_cannot_be_had_is_answered_with_the_nearest() {
        let text = Case::example().to_toml().replace("\"column\"", "\"none\"");
        let mut file = CaseFile::parse("rigid", &text).unwrap();
        file.set_number(Key::SurfaceFraction, 0.03);
        let (run, load) = (Run::default(), Load::Indentation(8e-6));
        let case = file.case().unwrap();
        let pressed = fakir::press(&case.system, load, case.method, &run).unwrap();
        let floor = pressed.floor.unwrap();
        for share in [0.5 * floor.share, 2.0 * floor.share] {
            let wanted = Wanted::FloorShare { share, load };
            let free = Key::LensYoungModulus;
            let Design::OutOfReach { nearest, limit, .. } =
                design(&file, free, wanted, &run).unwrap()
            else {
                panic!("the modulus cannot change the share");
            };
            assert_eq!(limit, Limit::NoEffect);
            let off = (wanted.of(&nearest.reached) / floor.share - 1.0).abs();
            assert!(off <= floor.error.share, "{off:e}");
        }
    }

    #[test]
    fn a_floor_share_that_makes_no_sense_is_refused() {
        let refused = |file: &CaseFile, share: f64, load: Load| {
            let wanted = Wanted::FloorShare { share, load };
            design(file, Key::Pitch, wanted, &Run::default())
                .unwrap_err()
                .to_string()
        };
        let file = paper(0.03);
        for share in [0.0, 1.0, -0.1, 20.0, f64::NAN] {
            let message = refused(&file, share, Load::Force(1e-3));
            assert!(
                message.contains("greater than 0 and less than 1"),
                "{message}"
            );
        }
        let infinite = Load::Indentation(f64::INFINITY);
        for load in [Load::FloorContact, Load::Force(0.0), infinite] {
            let message = refused(&file, 0.2, load);
            assert!(
                message.contains("give a force or an indentation"),
                "{message}"
            );
        }
        let mut other = file.case().unwrap();
        other.method = Method::Homogenised;
        let other = CaseFile::parse("homogenised", &other.to_toml()).unwrap();
        let message = refused(&other, 0.2, Load::Force(1e-3));
        assert!(
            message.contains("this method ignores the floor"),
            "{message}"
        );
        let mut ignored = file.case().unwrap();
        ignored.system = ignored
            .system
            .with_floor(fakir::problem::FloorModel::Ignored);
        let ignored = ignored.to_toml();
        let ignored = CaseFile::parse("ignored", &ignored).unwrap();
        let message = refused(&ignored, 0.2, Load::Force(1e-3));
        assert!(message.contains("the floor is ignored"), "{message}");
    }

    /// A pull-off force after the critical state.
    fn from_critical(force: f64) -> Wanted {
        let load = Load::FloorContact;
        Wanted::PullOff { force, load }
    }

    /// Pillars far apart under a plate, which has no critical state, detach together with the force of K. Kendall, J. Phys. D 4, 1186 (1971), each:
    /// the diameter is the one with this force.
    #[test]
    fn a_plate_has_a_pull_off_force_after_a_load() {
        let mut file = paper(0.02);
        file.set_number(Key::Pitch, 20e-3);
        for given in [
            "adhesion.work=50mJ/m2",
            "pattern.columns=2",
            "lens.shape=plate",
        ] {
            file.set(given).unwrap();
        }
        let case = file.case().unwrap();
        let diameter = 9e-6;
        let modulus = case.system.reduced_modulus();
        let force = -4.0 * fakir::theory::adhesion::kendall_pull_off(modulus, 0.5 * diameter, 0.05);
        let load = Load::Indentation(0.1e-6);
        let wanted = Wanted::PullOff { force, load };
        let candidate = found(&file, Key::PillarDiameter, wanted);
        // Forces grow with the power 3/2 of the diameter, and are met to a tenth of their numerical error of 3 %.
        let off = candidate.value / diameter - 1.0;
        assert!(off.abs() < 2.5e-3, "{off:e}");
        let refused = design(
            &file,
            Key::PillarDiameter,
            from_critical(force),
            &Run::default(),
        );
        let message = refused.unwrap_err().to_string();
        assert!(message.contains("has no transition"), "{message}");
        let nowhere = Wanted::PullOff {
            force,
            load: Load::Force(-1.0),
        };
        let refused = design(&file, Key::PillarDiameter, nowhere, &Run::default());
        assert!(matches!(refused, Err(DesignError::NotALoad(_))));
    }

    /// Without `work_receding` the receding work follows the work of adhesion, and the pull-off force of Kendall, see above, of 120 mJ/m^2 is found from
    /// 50 mJ/m^2. A given receding work of 80 mJ/m^2 determines the force alone.
    #[test]
    fn a_receding_work_limits_the_work_of_adhesion_only_if_it_is_given() {
        const WORK: f64 = 0.12;
        let mut file = paper(0.02);
        file.set_number(Key::Pitch, 20e-3);
        for given in [
            "adhesion.work=50mJ/m2",
            "pattern.columns=2",
            "lens.shape=plate",
        ] {
            file.set(given).unwrap();
        }
        let case = file.case().unwrap();
        let (modulus, radius) = (
            case.system.reduced_modulus(),
            0.5 * case.system.largest_diameter(),
        );
        let force = -4.0 * fakir::theory::adhesion::kendall_pull_off(modulus, radius, WORK);
        let load = Load::Indentation(0.1e-6);
        let wanted = Wanted::PullOff { force, load };
        let free = Key::WorkOfAdhesion;
        let candidate = found(&file, free, wanted);
        // Forces grow with the square root of the work, and are met to a tenth of their numerical error of 3 %.
        let off = candidate.value / WORK - 1.0;
        assert!(off.abs() < 7e-3, "{off:e}");
        file.set("adhesion.work_receding=80mJ/m2").unwrap();
        let limited = |wanted, free| {
            let design = design(&file, free, wanted, &Run::default()).unwrap();
            Answer {
                free,
                wanted,
                design,
            }
            .statement()
        };
        let message = limited(wanted, free);
        let advice = "limited by adhesion.work_receding = 80 mJ/m2; raise or remove it";
        assert!(message.ends_with(advice), "{message}");
        let wanted = Wanted::PullOff {
            force: 0.1 * force,
            load,
        };
        let message = limited(wanted, Key::RecedingWorkOfAdhesion);
        let advice = "limited by adhesion.work = 50 mJ/m2; lower it";
        assert!(message.ends_with(advice), "{message}");
    }

    /// On loading, contacts with flat tops do not depend on the work of adhesion: forces differ by their estimated errors only, at small works 1.4e-3.
    #[test]
    #[ignore = "slow: searches a range of works of adhesion"]
    fn what_has_no_effect_beyond_the_errors_has_none() {
        let mut file = paper(0.03);
        file.set("adhesion.work=50mJ/m2").unwrap();
        let wanted = Wanted::Pressed {
            quantity: PressedQuantity::Force,
            value: 0.2e-3,
            load: Load::Indentation(3e-6),
        };
        let found = design(&file, Key::WorkOfAdhesion, wanted, &Run::default()).unwrap();
        let Design::OutOfReach { limit, .. } = found else {
            panic!("{found:?}");
        };
        assert_eq!(limit, Limit::NoEffect);
    }

    /// The cycle of the case file of the result has the target pull-off force to within its numerical error.
    #[test]
    fn a_pull_off_force_is_had_by_the_case_that_is_found() {
        let mut file = paper(0.02);
        file.set("adhesion.work=50mJ/m2").unwrap();
        let force = 40e-6;
        for free in [Key::Pitch, Key::SubstrateYoungModulus] {
            let candidate = found(&file, free, from_critical(force));
            let written = CaseFile::parse("found", &flat(&candidate.case).to_toml()).unwrap();
            let case = written.case().unwrap();
            let plan = CyclePlan::default();
            let cycle = fakir::cycle(&case.system, plan, case.method, &Run::default()).unwrap();
            let pull_off = cycle.pull_off.as_ref().unwrap();
            let off = (-pull_off.force / force - 1.0).abs();
            assert!(
                off <= cycle.errors.pull_off_force.numerical(),
                "{free}: {off:e}"
            );
        }
    }

    #[test]
    fn a_pull_off_force_that_cannot_be_had_is_answered_with_the_range() {
        let run = Run::default();
        let file = paper(0.005);
        let refused = design(&file, Key::PillarHeight, from_critical(1e-6), &run);
        assert!(matches!(refused, Err(DesignError::NoAdhesion)));
        let mut adhesive = file.clone();
        adhesive.set("adhesion.work=50mJ/m2").unwrap();
        // For increasingly stiff pillars under a soft lens the pull-off force approaches a limit.
        let free = Key::SubstrateYoungModulus;
        let wanted = from_critical(1.0);
        let answer = Answer {
            free,
            wanted,
            design: design(&adhesive, free, wanted, &run).unwrap(),
        };
        let Design::OutOfReach { nearest, reach, .. } = &answer.design else {
            panic!("1 N cannot be had: {answer:?}");
        };
        let [least, greatest] = reach.unwrap();
        let nearest = wanted.of(&nearest.reached);
        assert!(0.0 < least && least < greatest && nearest <= greatest && greatest < 1.0);
        assert!(nearest > 0.99 * greatest, "{nearest:e} of {greatest:e}");
        let message = answer.statement();
        assert!(
            message.contains("it ranges from ")
                && message.contains("the closest attainable value is"),
            "{message}"
        );
    }

    /// Under a cylinder or a plate floor contact is ignored, however low the lens is beside the pillars.
    #[test]
    fn a_floor_that_carries_nothing_has_no_share() {
        for shape in ["cylinder", "plate"] {
            let mut file = paper(0.03);
            file.set("pattern.columns=3").unwrap();
            file.set(&format!("lens.shape={shape}")).unwrap();
            let case = file.case().unwrap();
            let load = Load::Indentation(8e-6);
            let wanted = Wanted::FloorShare { share: 0.15, load };
            let state = fakir::press(&case.system, load, case.method, &Run::default()).unwrap();
            assert!(state.floor.is_none() && state.smallest_floor_gap < 0.0);
            assert!(wanted.excess(&Reached::Pressed(state)) <= -1.0);
            for free in [Key::PillarHeight, Key::Pitch] {
                let message = design(&file, free, wanted, &Run::default()).unwrap_err();
                assert!(
                    message.to_string().contains("the floor carries no load"),
                    "{message}"
                );
            }
        }
    }

    /// For a lens without a radius, and for pillars wider than the lens.
    #[test]
    fn every_case_has_ranges() {
        let mut wide = paper(0.03);
        wide.set("lens.radius=50um").unwrap();
        wide.set("pattern.pillar.diameter=120um").unwrap();
        let mut plate = paper(0.03);
        for given in ["lens.shape=plate", "pattern.columns=3"] {
            plate.set(given).unwrap();
        }
        for file in [wide, plate] {
            let case = file.case().unwrap();
            for free in free_keys() {
                if let Some(first) = case.number(free) {
                    let [least, greatest] = range(&file, free, first, &file.any_case(&[]).unwrap());
                    assert!(least <= first && first <= greatest, "{free}");
                }
            }
        }
    }

    #[test]
    fn what_is_no_number_is_never_met() {
        let trial = |excess| Trial {
            position: 0.0,
            outcome: Err(Limit::Range),
            excess,
            error: 0.0,
            error_of_jump: 0.0,
        };
        assert!(trial(0.0).is_met() && trial(-0.5 * TOLERANCE).is_met());
        for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(!trial(odd).is_met());
        }
    }

    /// The free keys are taken from the key table, and their ranges are those of the table.
    #[test]
    fn ranges_are_those_of_the_key_table() {
        let file = paper(0.1);
        let case = file.case().unwrap();
        let names: Vec<&str> = free_keys().into_iter().map(Key::path).collect();
        assert_eq!(
            names,
            [
                "lens.radius",
                "lens.young_modulus",
                "lens.thickness",
                "lens.base_young_modulus",
                "substrate.young_modulus",
                "substrate.thickness",
                "substrate.base_young_modulus",
                "pattern.surface_fraction",
                "pattern.pitch",
                "pattern.pitch_y",
                "pattern.top_radius",
                "pattern.pillar.diameter",
                "pattern.pillar.height",
                "adhesion.work",
                "adhesion.work_receding",
                "surface.height_unit",
                "surface.height_range",
                "surface.cell_size",
                "surface.width",
                "surface.surface_fraction",
                "surface.pitch",
                "surface.pillar.diameter",
                "surface.pillar.side",
                "surface.pillar.length",
                "surface.pillar.width",
                "surface.pillar.height",
                "surface.pillar.chamfer_width",
                "surface.pillar.edge_radius",
            ]
        );
        let mut layered = paper(0.1);
        for body in ["lens", "substrate"] {
            for given in [
                "thickness=1 mm",
                "base=elastic",
                "base_young_modulus=1 GPa",
                "base_poisson_ratio=0.3",
            ] {
                layered.set(&format!("{body}.{given}")).unwrap();
            }
        }
        let mut adhesive = paper(0.1);
        for given in ["adhesion.work=50mJ/m2", "adhesion.work_receding=80mJ/m2"] {
            adhesive.set(given).unwrap();
        }
        for free in free_keys() {
            let (file, case) = match free {
                // It makes the tops round.
                Key::TopRadius => continue,
                // Other surfaces.
                _ if free.is_of_surface() => continue,
                Key::PitchY => (rectangular(0.1), rectangular(0.1).case().unwrap()),
                Key::WorkOfAdhesion | Key::RecedingWorkOfAdhesion => {
                    (adhesive.clone(), adhesive.case().unwrap())
                }
                _ if free.is_of_layers() => (layered.clone(), layered.case().unwrap()),
                _ => (file.clone(), case.clone()),
            };
            let file_case = AnyCase::Pillars(Box::new(case.clone()));
            let first = case.number(free).unwrap();
            let [least, greatest] = range(&file, free, first, &file_case);
            assert!(least < first && first < greatest, "{free}");
            for end in [least, greatest] {
                assert!(with(&file, free, end).is_ok(), "{free} = {end}");
            }
        }
        // The pitch of the case is the largest possible pillar diameter.
        let mut held = file.clone();
        held.set_number(Key::Pitch, 18e-6);
        let [_, widest] = range(
            &held,
            Key::PillarDiameter,
            6e-6,
            &held.any_case(&[]).unwrap(),
        );
        assert!((widest / 18e-6 - 1.0).abs() < 1e-15);
    }

    #[test]
    fn invalid_questions_are_refused() {
        let run = Run::default();
        let file = paper(0.01);
        let refused = design(&file, Key::Offset, Wanted::Force(1e-5), &run);
        assert!(matches!(refused, Err(DesignError::NotFree(Key::Offset))));
        let refused = design(&file, Key::Pitch, Wanted::Force(-1.0), &run);
        assert!(matches!(refused, Err(DesignError::NotPositive(_))));
    }
}
