//! Loading and unloading with adhesion: an exact path of events.
//!
//! At a fixed contact state of every top the response is [linear](super::linearized) in the indentation, so that the next indentation at
//! which a top changes follows in closed form ([`next_event`](AdhesiveTops::next_event)). There, all tops that are unstable change, which
//! changes the loads on the others: a *cascade*, at fixed indentation, force, or crosshead position of a testing machine. In a cascade,
//! changes in the direction of the course come first (attachment on loading, detachment on unloading). A top that has changed in this
//! direction does not change back, and a front rotates or bends once, so that every cascade ends. Unloading does not depend on the order of
//! changes, because the detachment of tops in tension increases the tension on the others. The energy released in a cascade is dissipated.

mod disc;
mod inside;
mod levels;
mod records;

pub(crate) use self::records::{
    AttachedTop, End, Energies, FixedQuantity, LoadStep, Stop, TopEvent,
};

use self::disc::InsideTop;
use self::records::{Change, ChangedTop, StrongestPull};
use super::bonded_floor_errors::{PLAIN, Variation};
use super::floor::{
    Discs, FloorDisplacement, FloorPoint, FloorSearch, LoadedDiscs, Surroundings, Uncovered,
};
use super::linearized::{LinearizedContact, Remainder, Rule, Source};
use super::rules::adhesive_tops::AdhesiveTops;
use super::rules::bonded_floor::{BondedFloor, TAKE_BACKS, natural};
use super::rules::floor::Places;
use super::rules::floor_fronts::FloorMove;
use super::rules::fronts::{Course, Domain, Fronts, Works};
use super::rules::tops::lens_over;
use super::spectral::{checked_sites, limited};
use crate::halfspace::coupling::lattice::LatticeCoupling;
use crate::halfspace::coupling::pair::PairCoupling;
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::disc::basis::mode_count;
use crate::halfspace::disc::exterior::Exterior;
use crate::halfspace::disc::projection::LensProjector;
use crate::halfspace::floor::coupling::SurfaceCoupling;
use crate::halfspace::floor::grid::Division;
use crate::numerics::convergence::Judgement;
use crate::numerics::line::integral_and_negative_part;
use crate::numerics::vector::{dot, subtract};
use crate::problem::pillar_field::PillarBody;
use crate::problem::scaled::Scene;
use crate::state::{Progress, Run, SolveError, Stage, Termination};

/// Part of the height of a pillar by which the end of a path is passed in a jump, beyond rounding.
const PASSED: f64 = 1e-6;

/// Relative residuals of the responses: to a unit indentation and at the current one if the indentation is prescribed, and of both
/// otherwise.
const UNIT_TOLERANCE: f64 = 1e-5;
const PRESENT_TOLERANCE: f64 = 1e-7;
const TOLERANCE: f64 = 1e-9;

/// Relative residuals at the current indentation while fronts move on the floor: relative to the load, and to the residual caused by the
/// last moves, because further moves follow. Most unloading steps move a few cells many times. The last two apply after the moves: at the
/// current indentation, and to a unit one; they start the next step, and the force depends only on their product.
const BONDED_TOLERANCE: f64 = 3e-4;
const BONDED_PART_LOADING: f64 = 0.02;
const BONDED_PART_UNLOADING: f64 = 0.05;
const BONDED_STATE_TOLERANCE: f64 = 3e-6;
const BONDED_UNIT_TOLERANCE: f64 = 3e-4;

/// Overshoot past an event, relative to the larger of the unit of length and the indentation, so that rounding does not hide the event.
const BEYOND: f64 = 1e-8;

/// Growth factor of the overshoot while no status changes.
const FURTHER: f64 = 4.0;

/// Longest step without a check of all tops, relative to the pillar height and to the indentation; the larger of the two applies.
const LONGEST_STEP: f64 = 0.02;
const LONGEST_RELATIVE_STEP: f64 = 0.01;

/// Step of the finite differences for the curvature of the gap, in pillar spacings.
const GAP_STEP: f64 = 0.02;

/// Relative difference from a prescribed force that is left, and largest number of corrections until then.
pub(super) const SAME_FORCE: f64 = 1e-6;
const MOST_CORRECTIONS: usize = 12;

/// Step while the floor adheres, in pillar heights: after each step all unstable places change, on tops and floor.
const BONDED_STEP: f64 = 0.04;

/// The same for a contact under a load, whose states before are not part of the answer: on an adhesive floor, where fronts do not recede after a
/// step that was too long, and on a floor without adhesion, whose pressures do not depend on those before.
pub(super) const LONG_STEP: f64 = 0.25;
pub(super) const PLAIN_STEP: f64 = 0.5;

/// Longest step on an adhesive floor relative to the distance to the end, as long as that is longer than [`BONDED_STEP`]: fronts that stay before a
/// barrier after a long step pass it after short ones.
const PART_OF_WAY: f64 = 0.5;

/// Radius of the adhering region, in pillar spacings, below which unloading steps are shorter, because the floor detaches there.
const NEAR_LOSS: f64 = 2.5;

/// A force is reached if the remaining distance is less than this fraction of a step.
const NEAR_END: f64 = 0.02;

/// The floor is checked again after this fraction of the distance to the estimated contact; at every step if that is closer than
/// `NEAR_FLOOR` times the indentation. The search starts from scratch, because another point may have become the lowest.
const LOOK_AGAIN: f64 = 0.5;
const NEAR_FLOOR: f64 = 0.02;

/// Largest number of rounds of a cascade.
const ROUND_LIMIT: usize = 2000;

/// On loading, pillars are included up to this many pitches beyond the farthest one in contact. Their radius grows at least by the factor
/// `GROWTH`.
const MARGIN: f64 = 1.5;
const GROWTH: f64 = 1.25;

/// On unloading, no further pillars attach: pillars are removed if less than this fraction of their radius is needed.
const SHRINKAGE: f64 = 0.88;

/// Number of pillars up to which none are removed.
const FEW_PILLARS: usize = 24;

/// First-order corrections of the force and the stiffness for the residuals, at an indentation.
#[derive(Debug, Clone, Copy, Default)]
struct Refined {
    indentation: f64,
    force: f64,
    stiffness: f64,
}

/// Loading and unloading of a lens on adhesive tops.
pub(crate) struct Path<'a> {
    pub(crate) scene: &'a Scene,
    pub(super) run: &'a Run<'a>,
    /// Called with every load step, the last one of [`stations`](Self::stations), when it has been reached.
    follower: &'a dyn Fn(&Self),
    pair: PairCoupling,
    projector: LensProjector,
    pub(crate) sites: Sites,
    pub(crate) tops: AdhesiveTops,
    pub(crate) contact: LinearizedContact<'a, SurfaceCoupling<'a>>,
    /// The part of the floor in contact.
    pub(crate) floor: Option<BondedFloor<'a>>,
    /// The disc inside a top that is the only one in contact, if there is one. All tops then count as out of contact.
    pub(crate) inside: Option<InsideTop>,
    exterior: Exterior,
    pub(super) works: Works,
    /// Works of adhesion of the floor; `None` if it is not adhesive.
    pub(super) floor_works: Option<Works>,
    /// Numerical variation of the floor solution.
    pub(super) variation: Variation,
    /// Step after the first contact with the floor, in pillar heights.
    pub(super) floor_step: f64,
    fixed: FixedQuantity,
    /// Indentation from which the floor is checked again.
    look_again: f64,
    refined: Refined,
    /// The step before a cascade; the force is interpolated linearly over this step.
    spread: f64,
    /// Loads on all tops at the current indentation, and their derivative with respect to it.
    loads: Vec<f64>,
    along: Vec<f64>,
    pub(crate) stations: Vec<LoadStep>,
    pub(crate) events: Vec<TopEvent>,
    pub(crate) energies: Energies,
    /// Force error due to the finite number of front levels while tops are partially bonded.
    pub(crate) left_open: f64,
    pub(crate) strongest: Option<StrongestPull>,
    /// Why there is no solution, if there is none.
    pub(super) failed: Option<Termination>,
}

impl<'a> Path<'a> {
    /// Starts with the lens above all tops, at an indentation without contact.
    pub(crate) fn new(
        scene: &'a Scene,
        run: &'a Run<'a>,
        fronts: Fronts,
        fixed: FixedQuantity,
    ) -> Result<Self, SolveError> {
        let degree = fronts.degree();
        let modes = mode_count(degree);
        let pitch = scene.field.spacing();
        let pair = PairCoupling::of_scene(degree, scene);
        let projector = LensProjector::new(&scene.lens, degree);
        let first_touch = scene.first_touch();
        let [largest, _] = scene.field.bounds();
        let radius = scene.nearest_edge() + largest + MARGIN * pitch;
        let radius = match scene.field.extent() {
            Some(extent) if !scene.lens.is_axisymmetric() => extent,
            _ => limited(scene, radius.max(scene.reach_of_tops(first_touch))),
        };
        let sites = checked_sites(scene, radius, modes, run)?;
        let coupling = LatticeCoupling::of_sites(&sites, &pair, run.workers());
        let coupling = SurfaceCoupling::of_tops(coupling);
        let own_load = own_load(scene, &projector, &sites, modes);
        let mut path = Self {
            scene,
            run,
            follower: &|_| {},
            works: fronts.works(),
            floor_works: Some(fronts.works()),
            variation: PLAIN,
            floor_step: BONDED_STEP,
            tops: AdhesiveTops::new(fronts, scene.field.column(), &sites),
            loads: vec![0.0; own_load.len()],
            along: vec![0.0; own_load.len()],
            contact: LinearizedContact::new(run, coupling, modes, own_load),
            floor: None,
            inside: None,
            sites,
            pair,
            projector,
            exterior: Exterior::new(degree).with_layers(&scene.layers, &scene.field.radii()),
            fixed,
            look_again: f64::NEG_INFINITY,
            refined: Refined::default(),
            spread: 0.0,
            stations: Vec::new(),
            events: Vec::new(),
            energies: Energies::default(),
            left_open: 0.0,
            strongest: None,
            failed: None,
        };
        let start = first_touch.min(scene.height);
        path.contact
            .move_to(start - path.longest_step(Course::Loading));
        path.record(Course::Loading);
        Ok(path)
    }

    pub(crate) fn indentation(&self) -> f64 {
        self.contact.indentation()
    }

    /// How the solution ended so far.
    pub(crate) fn termination(&self) -> Termination {
        self.failed.unwrap_or(Termination::Converged)
    }

    /// Number of tops in contact, and of partially bonded ones.
    pub(crate) fn counts(&self) -> [usize; 2] {
        match self.inside {
            Some(_) => [1, 1],
            None => self.tops.counts(),
        }
    }

    pub(crate) fn force(&self) -> f64 {
        if let Some(inside) = &self.inside {
            return inside.force();
        }
        let Refined {
            indentation,
            force,
            stiffness,
        } = self.refined;
        self.contact.force() + force + stiffness * (self.indentation() - indentation)
    }

    fn stiffness(&self) -> f64 {
        self.contact.stiffness() + self.refined.stiffness
    }

    /// Distance from the lens axis of the farthest point in contact.
    pub(crate) fn contact_radius(&self) -> f64 {
        if let Some(inside) = &self.inside {
            return inside.radius();
        }
        let mut farthest = self.floor.as_ref().map_or(0.0, BondedFloor::radius);
        let tops = self.tops.domains.iter().zip(self.sites.centres());
        for (top, (domain, centre)) in tops.enumerate() {
            let fronts = self.tops.fronts(top);
            if !domain.is_out() && centre[0].hypot(centre[1]) + fronts.radius() > farthest {
                let axis = centre.map(|x| -x);
                farthest = farthest.max(fronts.farthest_from(*domain, axis));
            }
        }
        farthest
    }

    /// Distance from the lens axis of the farthest centre of a top in contact.
    pub(super) fn reach(&self) -> f64 {
        let pillars = self.tops.domains.iter().zip(self.sites.centres());
        let touched = pillars.filter(|(domain, _)| !domain.is_out());
        touched.map(|(_, [x, y])| x.hypot(*y)).fold(0.0, f64::max)
    }

    fn longest_step(&self, course: Course) -> f64 {
        if let Some(floor) = &self.floor {
            let is_near_loss = course == Course::Unloading
                && floor.radius() < NEAR_LOSS * self.scene.field.spacing();
            let part = if is_near_loss {
                self.variation.loss_step
            } else {
                1.0
            };
            return part * self.floor_step * self.scene.height;
        }
        let part_of_path = LONGEST_RELATIVE_STEP * self.indentation().abs();
        (LONGEST_STEP * self.scene.height).max(part_of_path)
    }

    /// Continues to the end. If `watch_floor` is set, loading stops at the floor too.
    pub(crate) fn go(
        &mut self,
        course: Course,
        end: End,
        watch_floor: bool,
    ) -> Result<Stop, SolveError> {
        let sign = course.sign();
        let mut beyond = BEYOND;
        if self.inside.is_none() && !(course == Course::Loading && self.snap_inside(end)?) {
            // Changes caused by the reversal of the course.
            self.cascade(course)?;
        }
        loop {
            if let Some(termination) = self.failed {
                return Ok(Stop::Failed(termination));
            }
            if end == End::Separation && self.counts()[0] == 0 && self.floor.is_none() {
                return Ok(Stop::End);
            }
            if self.inside.is_some() {
                match self.step_inside(course, end, watch_floor)? {
                    Some(stop) => return Ok(stop),
                    None => continue,
                }
            }
            if course == Course::Unloading && self.counts() == [1, 1] && self.recede_inside()? {
                continue;
            }
            let longest = self.longest_step(course);
            if self.floor.is_some() {
                if self.step_with_floor(course, end, longest)? {
                    return Ok(Stop::End);
                }
                continue;
            }
            let along = self.along.iter_mut();
            along.for_each(|load| *load *= sign);
            let loads = [self.loads.as_slice(), self.along.as_slice()];
            let event = self.tops.next_event(loads, course, longest);
            let to_event = event.unwrap_or(f64::INFINITY);
            let to_end = self.distance(sign, end);
            let step = to_event.min(longest).min(to_end);
            if watch_floor
                && course == Course::Loading
                && let Some(lowest) = self.lowest_floor_within(step)
            {
                self.sharpen()?;
                let lowest = self.lowest_floor().unwrap_or(lowest);
                // In a cascade the lens may have come closer to the floor.
                self.advance((lowest.indentation - self.indentation()).max(0.0));
                self.record(course);
                return Ok(Stop::Floor(lowest));
            }
            if to_end <= step {
                self.sharpen()?;
                self.advance(sign * self.distance(sign, end));
                self.record(course);
                return Ok(Stop::End);
            }
            self.advance(sign * step);
            self.record(course);
            if self.indentation() > self.scene.lens.largest_contact() {
                return Err(self.too_large(self.indentation()));
            }
            if to_event <= longest && course == Course::Unloading && self.recede_inside()? {
                continue;
            }
            let past = beyond * self.indentation().abs().max(1.0);
            if to_event <= longest {
                self.advance(sign * past);
            }
            let changes = self.cascade(course)?;
            beyond = if changes == 0 && to_event <= longest {
                beyond * FURTHER
            } else {
                BEYOND
            };
            self.report(Stage::Cycle, self.events.len());
        }
    }

    /// Performs a step while the floor adheres, and all changes that follow. Returns whether the end is reached. The force is interpolated
    /// linearly between the states after all changes.
    fn step_with_floor(
        &mut self,
        course: Course,
        end: End,
        longest: f64,
    ) -> Result<bool, SolveError> {
        let sign = course.sign();
        let to_end = self.distance(sign, end);
        let longest = match self.floor_works {
            Some(_) => longest.min((PART_OF_WAY * to_end).max(BONDED_STEP * self.scene.height)),
            None => longest,
        };
        self.spread = sign * longest.min(to_end);
        let stations = self.stations.len();
        self.advance(self.spread);
        let changed = self.cascade(course)? > 0 || self.stations.len() > stations;
        self.spread = 0.0;
        if !changed {
            self.record(course);
        }
        if self.indentation() > self.scene.lens.largest_contact() {
            return Err(self.too_large(self.indentation()));
        }
        self.report(Stage::Cycle, self.events.len());
        if to_end > longest {
            return Ok(false);
        }
        // Changes of contact change the force.
        match end {
            End::Force(force) if self.floor_works.is_none() => {
                self.meet(force, course).map(|()| true)
            }
            End::Force(_) => Ok(!changed || to_end < NEAR_END * longest),
            _ => Ok(true),
        }
    }

    /// Corrects the indentation until the force is the given one, on a floor without adhesion.
    fn meet(&mut self, force: f64, course: Course) -> Result<(), SolveError> {
        for _ in 0..MOST_CORRECTIONS {
            let missing = force - self.force();
            if missing.abs() <= SAME_FORCE * force.abs() {
                break;
            }
            self.advance(missing / self.stiffness());
            if self.cascade(course)? == 0 {
                self.record(course);
            }
        }
        Ok(())
    }

    /// Starts contact with the floor at its lowest point, on the cells of a division in a window of a radius. On an adhesive floor, computes
    /// the state after jump-in.
    pub(crate) fn attach_floor(
        &mut self,
        lowest: FloorPoint,
        division: Division,
        radius: f64,
    ) -> Result<(), SolveError> {
        self.lay_floor(Course::Loading, division, radius, &|_| None)?;
        self.contact.all_loads(&mut self.loads);
        if self.floor_works.is_none() {
            return Ok(());
        }
        let start = [self.indentation(), self.force()];
        let energy = self.elastic_energy();
        self.seed_floor(lowest);
        self.solve_present(Course::Loading)?;
        self.contact.all_loads(&mut self.loads);
        self.cascade_from(Course::Loading, start, energy, 0.0)?;
        Ok(())
    }

    /// Change of the indentation up to an end along the linearized response.
    fn distance(&self, sign: f64, end: End) -> f64 {
        match end {
            End::Indentation(indentation) => {
                let way = sign * (indentation - self.indentation());
                // A jump under a prescribed force may pass the end: the lens does not go back to it.
                if way < -PASSED * self.scene.height {
                    0.0
                } else {
                    way
                }
            }
            End::Force(force) if self.tops.counts()[0] > 0 => {
                let missing = sign * (force - self.force());
                missing.max(0.0) / self.stiffness()
            }
            End::Force(_) | End::Floor | End::Separation => f64::INFINITY,
        }
    }

    /// Reports the progress of a stage; in a variation, progress of the error estimate.
    fn report(&self, stage: Stage, step: usize) {
        let is_plain = self.variation == PLAIN;
        self.run.report(Progress {
            stage: if is_plain {
                stage
            } else {
                Stage::ErrorEstimate
            },
            step,
            pillars: self.sites.len(),
            touched: self.tops.counts()[0],
        });
    }

    /// Moves along the linearized response.
    fn advance(&mut self, step: f64) {
        let force = self.force();
        self.contact.move_to(self.indentation() + step);
        self.add_work(step, [force, self.force()]);
    }

    /// Adds the work of a step along which the force is linear.
    fn add_work(&mut self, step: f64, [before, after]: [f64; 2]) {
        let [work, tensile] = integral_and_negative_part([[0.0, before], [step, after]]);
        self.energies.work += work;
        if step < 0.0 {
            self.energies.separation += tensile;
        }
    }

    fn record(&mut self, course: Course) {
        let station = LoadStep {
            course,
            indentation: self.indentation(),
            force: self.force(),
            touched: self.counts(),
            area: self.tops.area()
                + self.floor.as_ref().map_or(0.0, BondedFloor::area)
                + self.inside.as_ref().map_or(0.0, InsideTop::area),
            radius: self.contact_radius(),
            events: self.events.len(),
            floor: self.floor_station(),
        };
        let strongest = self.strongest.as_ref();
        let before = strongest.map_or(0.0, |pull| self.stations[pull.station].force);
        if course == Course::Unloading && station.force < before {
            self.strongest = Some(StrongestPull {
                station: self.stations.len(),
                tops: self.attached_tops(),
            });
        }
        self.stations.push(station);
        (self.follower)(self);
    }

    /// Reports all further load steps to a function.
    pub(crate) fn followed_by(&mut self, follower: &'a dyn Fn(&Self)) {
        self.follower = follower;
    }

    /// All tops in contact.
    pub(crate) fn attached_tops(&self) -> Vec<AttachedTop> {
        if let Some(inside) = &self.inside {
            return vec![inside.attached_top()];
        }
        let modes = self.contact.modes();
        let attached = |pillar: usize| {
            let PillarBody { radius, raised, .. } = *self.sites.body(pillar);
            let moments = &self.contact.coefficients()[pillar * modes..][..modes];
            AttachedTop {
                index: self.sites.index(pillar),
                centre: self.sites.centres()[pillar],
                radius,
                raised,
                domain: self.tops.domains[pillar],
                coefficients: moments.iter().map(|m| m / (radius * radius)).collect(),
                disc: None,
            }
        };
        let touched = (0..self.sites.len()).filter(|p| !self.tops.domains[*p].is_out());
        touched.map(attached).collect()
    }

    /// Solves for the response to a unit indentation at the current domains. If the indentation is prescribed, residuals must only be so
    /// small that their product is negligible: see [`refine`](Self::refine).
    fn solve_unit(&mut self) -> Result<(), SolveError> {
        let tolerance = match (self.fixed, &self.floor) {
            (FixedQuantity::Indentation, Some(_)) => BONDED_UNIT_TOLERANCE,
            (FixedQuantity::Indentation, None) => UNIT_TOLERANCE,
            _ => TOLERANCE,
        };
        self.solve_within(Source::Unit, tolerance)
    }

    /// The same at the current indentation.
    fn solve_present(&mut self, course: Course) -> Result<(), SolveError> {
        let of_start = match course {
            Course::Loading => BONDED_PART_LOADING,
            Course::Unloading => BONDED_PART_UNLOADING,
        };
        let tolerance = match (self.fixed, &self.floor) {
            (_, Some(_)) => Remainder {
                of_load: BONDED_TOLERANCE,
                of_start,
            },
            (FixedQuantity::Indentation, None) => PRESENT_TOLERANCE.into(),
            _ => TOLERANCE.into(),
        };
        self.solve_within(Source::Present, tolerance)
    }

    /// Solves the current state to the accuracy of results.
    fn sharpen(&mut self) -> Result<(), SolveError> {
        self.solve_within(Source::Present, TOLERANCE)?;
        self.solve_within(Source::Unit, TOLERANCE)?;
        self.find_loads();
        self.refine();
        Ok(())
    }

    pub(super) fn solve_within(
        &mut self,
        source: Source<'_>,
        tolerance: impl Into<Remainder>,
    ) -> Result<(), SolveError> {
        self.tops.prepare(&self.sites);
        let mut places = Places {
            tops: &mut self.tops,
            floor: self.floor.as_mut().map(|floor| &mut floor.cells),
        };
        let judgement = self.contact.solve(&mut places, source, tolerance)?;
        if judgement != Judgement::Good {
            self.failed = Some(match judgement {
                Judgement::TooLarge => Termination::Stagnated,
                _ => Termination::NotFinite,
            });
        }
        Ok(())
    }

    /// Solves for the response to a unit indentation, and updates the loads and the corrections for residuals.
    fn respond(&mut self) -> Result<(), SolveError> {
        if self.floor.is_some() {
            self.solve_within(Source::Present, BONDED_STATE_TOLERANCE)?;
        }
        self.solve_unit()?;
        if self.floor.is_none() {
            // The correction for residuals requires exact products.
            self.contact.make_exact();
        }
        self.find_loads();
        self.refine();
        Ok(())
    }

    pub(super) fn find_loads(&mut self) {
        self.loads.resize(self.contact.len(), 0.0);
        self.along.resize(self.contact.len(), 0.0);
        self.contact.all_loads(&mut self.loads);
        self.contact.unit_loads(&mut self.along);
    }

    /// Work of the residual `P l - c` of coefficients under loads `l` on another load, given as `work`: that load on the tops, and its
    /// response on the floor. With the same load twice it is the energy norm of the residual.
    fn lacking(&self, loads: &[f64], coefficients: &[f64], work: [&[f64]; 2]) -> f64 {
        let tops = self.contact.tops();
        let mut missing = vec![0.0; tops];
        self.tops
            .respond(&loads[..tops], &mut missing, self.run.workers());
        subtract(&mut missing, &coefficients[..tops]);
        let [along, unit] = work;
        // On floor cells in contact the residual is the remaining load; out of contact the coefficients are zero.
        dot(&along[..tops], &missing) + dot(&unit[tops..], &loads[tops..])
    }

    /// Corrects the force for the residual of the response, to first order: with the response `c1` to a unit indentation `b1`, the exact
    /// force `b1'c` is `b1'c + c1'r` with `r` the residual, up to the product of both residuals.
    fn refine(&mut self) {
        let [present, unit] = self.contact.parts();
        let of = [self.along.as_slice(), unit];
        self.refined = Refined {
            indentation: self.indentation(),
            force: self.lacking(&self.loads, present, of),
            stiffness: self.lacking(&self.along, unit, of),
        };
    }

    /// The elastic energy with the same correction.
    fn elastic_energy(&self) -> f64 {
        if let Some(inside) = &self.inside {
            return inside.energy();
        }
        let [present, _] = self.contact.parts();
        let missing = self.lacking(&self.loads, present, [&self.loads, present]);
        self.contact.elastic_energy() + 0.5 * missing
    }

    /// Performs all changes at a fixed drive. Returns how many tops changed.
    fn cascade(&mut self, course: Course) -> Result<usize, SolveError> {
        self.contact.all_loads(&mut self.loads);
        let start = [self.indentation(), self.force()];
        let energy = self.elastic_energy();
        let floor = self.floor.as_ref().map_or(0.0, BondedFloor::area);
        let is_first = course == Course::Loading && self.counts()[0] == 0;
        let changes = self.cascade_from(course, start, energy, floor)?;
        if is_first && changes > 0 {
            self.open_by_first_contact();
        }
        Ok(changes)
    }

    /// The same, starting from a state with this indentation and force, elastic energy and floor contact area; parts of the floor may have
    /// changed already.
    fn cascade_from(
        &mut self,
        course: Course,
        start: [f64; 2],
        energy: f64,
        floor: f64,
    ) -> Result<usize, SolveError> {
        let mut change = Change::default();
        let mut changed = false;
        loop {
            let before = self.tops.domains.clone();
            if !self.change(course)? {
                break;
            }
            changed = true;
            for (pillar, before) in before.iter().enumerate() {
                let after = self.tops.domains[pillar];
                let fronts = self.tops.fronts(pillar);
                let area = fronts.area(after) - fronts.area(*before);
                change.gained += area.max(0.0);
                change.lost += (-area).max(0.0);
                if before.level != after.level {
                    change.tops.push(ChangedTop {
                        index: self.sites.index(pillar),
                        centre: self.sites.centres()[pillar],
                        parts: [before.level, after.level].map(Fronts::part),
                        levels: before.level.abs_diff(after.level),
                    });
                }
            }
            // Pillars that were outside the window may be touched immediately.
            if !self.fit_sites(course)? || self.floor.is_none() {
                break;
            }
        }
        let area = self.floor.as_ref().map_or(0.0, BondedFloor::area) - floor;
        if !changed && area == 0.0 {
            self.find_loads();
            return Ok(0);
        }
        if self.floor_works.is_some() {
            change.gained += area.max(0.0);
            change.lost += (-area).max(0.0);
        }
        // A floor without adhesion is touched as soon as the lens penetrates it.
        let may_touch = self.floor_works.is_none() && course == Course::Loading;
        if !may_touch && self.floor.is_some() && !self.touches_floor() {
            self.lift_floor();
        }
        self.respond()?;
        Ok(self.account(course, start, energy, &change))
    }

    /// Changes all unstable tops until none is left. Returns whether any changed.
    fn change(&mut self, course: Course) -> Result<bool, SolveError> {
        let [alpha, beta] = self.fixed.weights();
        let fixed = alpha * self.indentation() + beta * self.contact.force();
        let mut grown = vec![false; self.tops.domains.len()];
        let mut adjusted = grown.clone();
        let workers = self.run.workers();
        let mut take_backs = 0;
        self.lift_bans();
        for round in 0..ROUND_LIMIT {
            if self.floor.is_some() {
                // Most of the computing time is spent in these rounds.
                self.report(Stage::FloorFronts, round);
            }
            let floor_moved = self.move_fronts(natural(course));
            let moves = self.tops.marched(&self.loads, workers);
            let is_natural = |(pillar, next): &(usize, Domain)| {
                let grows = next.level > self.tops.domains[*pillar].level;
                grows == (course == Course::Loading)
            };
            let mut chosen: Vec<(usize, Domain)> =
                moves.iter().filter(|m| is_natural(m)).copied().collect();
            let mut moved = floor_moved;
            if chosen.is_empty() && !moved {
                let others = moves.into_iter().filter(|(pillar, _)| !grown[*pillar]);
                chosen = others.collect();
                if course == Course::Loading && take_backs < TAKE_BACKS {
                    moved = self.move_fronts(FloorMove::TakeBack);
                    take_backs += usize::from(moved);
                }
            } else {
                for (pillar, _) in &chosen {
                    grown[*pillar] = true;
                }
            }
            if chosen.is_empty() && !moved {
                chosen = self.tops.adjusted(&self.loads, workers);
                chosen.retain(|(pillar, _)| !adjusted[*pillar]);
                for (pillar, _) in &chosen {
                    adjusted[*pillar] = true;
                }
            }
            if chosen.is_empty() && !moved {
                if self.floor.is_some() && self.contact.remainder() > BONDED_TOLERANCE {
                    // Nothing moves with an approximate solution: repeat with a more accurate one.
                    self.solve_within(Source::Present, BONDED_TOLERANCE)?;
                    self.contact.all_loads(&mut self.loads);
                    continue;
                }
                return Ok(round > 0);
            }
            let present: Vec<Domain> = chosen.iter().map(|(p, _)| self.tops.domains[*p]).collect();
            let coupled = self
                .floor
                .as_ref()
                .map_or(f64::INFINITY, |floor| floor.reach);
            for (pillar, next) in &chosen {
                self.tops.domains[*pillar] = *next;
            }
            let is_coupled = self.reach() <= coupled;
            self.fit_floor(course)?;
            if !is_coupled {
                // The loads of these tops lacked the displacement by the floor, with which they may not be touched.
                for ((pillar, _), present) in chosen.iter().zip(present) {
                    self.tops.domains[*pillar] = present;
                }
            }
            if beta != 0.0 {
                self.solve_unit()?;
            }
            self.solve_present(course)?;
            if beta != 0.0 {
                let missing = fixed - alpha * self.indentation() - beta * self.contact.force();
                let rate = alpha + beta * self.contact.stiffness();
                if rate <= 0.0 {
                    // No contact is left to carry the force.
                    return Ok(true);
                }
                self.contact.move_to(self.indentation() + missing / rate);
            }
            self.contact.all_loads(&mut self.loads);
            if self.failed.is_some() {
                return Ok(true);
            }
        }
        self.failed = Some(Termination::IterationLimit);
        Ok(true)
    }

    /// Records the events of a cascade and the dissipated energy. Returns the number of events.
    fn account(
        &mut self,
        course: Course,
        [start, force]: [f64; 2],
        energy: f64,
        change: &Change,
    ) -> usize {
        let (indentation, after) = (self.indentation(), self.force());
        let mut farthest = 0;
        for ChangedTop {
            index,
            centre,
            parts,
            levels,
        } in &change.tops
        {
            farthest = farthest.max(*levels);
            self.events.push(TopEvent {
                course,
                indentation,
                force: after,
                index: *index,
                centre: *centre,
                parts: *parts,
            });
        }
        // Work of the drive during the cascade; zero at fixed indentation.
        let way = indentation - start;
        self.add_work(way, [force, after]);
        let done = 0.5 * way * (force + after);
        let stored = self.elastic_energy() - energy;
        let parted = self.works.receding * change.lost - self.works.advancing * change.gained;
        let dissipated = done - stored - parted;
        // Contribution of the preceding step, along which the force is interpolated linearly.
        let spread = 0.5 * self.spread * (after - force);
        self.energies.work += spread;
        self.energies.dissipation += dissipated + spread;
        if farthest <= 1 && self.floor.is_none() {
            self.energies.between_levels += dissipated.abs();
        }
        self.energies.receded += change.lost;
        self.record(course);
        change.tops.len()
    }

    /// Adds pillars if the contact is close to the farthest ones, and removes some if it needs much fewer. Returns whether the pillars
    /// changed.
    fn fit_sites(&mut self, course: Course) -> Result<bool, SolveError> {
        if !self.scene.lens.is_axisymmetric() {
            return Ok(false); // all pillars there are
        }
        let (reach, pitch) = (self.reach(), self.scene.field.spacing());
        let [largest, _] = self.scene.field.bounds();
        if reach - largest > self.scene.lens.largest_contact() {
            return Err(self.too_large(reach));
        }
        let present = self.sites.radius();
        let higher = self.scene.reach_of_tops(self.indentation());
        let radius = match course {
            Course::Loading if (reach + pitch).max(higher) > present => (reach + MARGIN * pitch)
                .max(GROWTH * present)
                .max(GROWTH * higher),
            // With a margin for rounding.
            Course::Unloading if reach < self.needed() && self.sites.len() > FEW_PILLARS => {
                reach + 0.1 * pitch
            }
            _ => return Ok(false),
        };
        let radius = limited(self.scene, radius);
        if course == Course::Loading && radius <= present {
            return Ok(false);
        }
        let modes = self.contact.modes();
        let sites = checked_sites(self.scene, radius, modes, self.run)?;
        let coupling = LatticeCoupling::of_sites(&sites, &self.pair, self.run.workers());
        let coupling = SurfaceCoupling::of_tops(coupling);
        let own_load = own_load(self.scene, &self.projector, &sites, modes);
        let mut contact = LinearizedContact::new(self.run, coupling, modes, own_load);
        let pressures = self.floor_pressures();
        let [present, unit] = self.contact.parts();
        let before = |pillar: usize| self.sites.find(sites.index(pillar));
        contact.start_from(self.indentation(), |pillar| {
            let range = before(pillar)? * modes..;
            Some([&present[range.clone()][..modes], &unit[range][..modes]])
        });
        let domain = |pillar| before(pillar).map_or(Domain::OUT, |p| self.tops.domains[p]);
        let domains = (0..sites.len()).map(domain).collect();
        self.tops.move_to(&sites, domains);
        self.loads.resize(sites.len() * modes, 0.0);
        self.along.resize(sites.len() * modes, 0.0);
        self.contact = contact;
        self.sites = sites;
        if let Some(pressures) = pressures {
            self.lay_floor_again(course, &pressures, pressures.grid.radius)?;
        }
        Ok(true)
    }

    /// Pillars are kept as long as the contact radius exceeds this.
    fn needed(&self) -> f64 {
        let mut radius = self.sites.radius();
        if radius.is_infinite() {
            let centres = self.sites.centres().iter();
            radius = centres.map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
        }
        SHRINKAGE * radius
    }

    fn too_large(&self, radius: f64) -> SolveError {
        SolveError::beyond(&self.scene.lens, radius, self.scene.length)
    }

    /// The lowest point of the floor, if it is reached within a step.
    fn lowest_floor_within(&mut self, step: f64) -> Option<FloorPoint> {
        if self.indentation() + step < self.look_again {
            return None;
        }
        let lowest = self.lowest_floor()?;
        let ahead = lowest.indentation - self.indentation();
        if ahead > step + NEAR_FLOOR * lowest.indentation {
            self.look_again = self.indentation() + LOOK_AGAIN * ahead;
            return None;
        }
        (lowest.indentation <= self.indentation() + step).then_some(lowest)
    }

    /// The lowest point of the floor along the linearized response.
    pub(crate) fn lowest_floor(&self) -> Option<FloorPoint> {
        let floor = self.uncovered(self.contact_radius());
        self.with_discs(|discs| FloorSearch::default().lowest(&floor, discs, &self.run.cancel))
    }

    /// The floor around a contact of a radius.
    fn uncovered(&self, contact_radius: f64) -> Uncovered<'_> {
        let spacing = self.scene.field.spacing();
        Uncovered {
            lens: self.scene.lens.clone(),
            height: self.scene.height,
            around: Surroundings::of_sites(&self.sites, spacing, contact_radius),
        }
    }

    /// Geometric mean of the radii of curvature of the gap at its lowest point, by second differences.
    pub(crate) fn gap_radius(&self, lowest: &FloorPoint) -> f64 {
        let step = GAP_STEP * self.scene.field.spacing();
        self.with_discs(|discs| {
            let gap = |u: f64, v: f64| {
                let [x, y] = lowest.position;
                let point = [x + u * step, y + v * step];
                let [along, without] = discs.displacement(point);
                let displaced = along.value * self.indentation() + without.value;
                self.scene.lens.sag_with_brim(point) + displaced
            };
            let middle = 2.0 * gap(0.0, 0.0);
            let xx = gap(1.0, 0.0) + gap(-1.0, 0.0) - middle;
            let yy = gap(0.0, 1.0) + gap(0.0, -1.0) - middle;
            let xy = 0.25 * (gap(1.0, 1.0) + gap(-1.0, -1.0) - gap(1.0, -1.0) - gap(-1.0, 1.0));
            step * step / (xx * yy - xy * xy).max(f64::MIN_POSITIVE).sqrt()
        })
    }

    /// Passes the loads on the tops in contact to a function, as discs.
    fn with_discs<R>(&self, ask: impl FnOnce(&LoadedDiscs<'_>) -> R) -> R {
        if let Some(inside) = &self.inside {
            return inside.with_discs(self.run, ask);
        }
        let modes = self.contact.modes();
        let touched: Vec<usize> = (0..self.sites.len())
            .filter(|pillar| !self.tops.domains[*pillar].is_out())
            .collect();
        let ([present, unit], indentation) = (self.contact.parts(), self.contact.indentation());
        let radius = |disc: usize| self.tops.fronts(touched[disc]).radius();
        let density = |moments: &[f64], disc: usize, mode: usize| {
            moments[touched[disc] * modes + mode] / radius(disc).powi(2)
        };
        let along = |disc: usize, mode: usize| density(unit, disc, mode);
        let without = |disc: usize, mode: usize| {
            density(present, disc, mode) - indentation * along(disc, mode)
        };
        let discs = LoadedDiscs {
            exterior: &self.exterior,
            discs: Discs::new(
                [touched.len(), modes],
                |disc| self.sites.centres()[touched[disc]],
                radius,
                [Some(&along), Some(&without)],
            ),
            run: self.run,
        };
        ask(&discs)
    }
}

/// `bs`: the lens shape over every top, and its height.
fn own_load(scene: &Scene, projector: &LensProjector, sites: &Sites, modes: usize) -> Vec<f64> {
    let mut own_load = vec![0.0; sites.len() * modes];
    let loads = own_load.chunks_exact_mut(modes);
    for (pillar, load) in loads.enumerate() {
        lens_over(&scene.lens, projector, sites, pillar, load);
    }
    own_load
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::PillarCompliance;
    use crate::theory::reference;

    /// The paper's intermediate system.
    fn scene(surface_fraction: f64, offset: f64, compliance: PillarCompliance) -> Scene {
        let lattice = reference::lattice(surface_fraction).offset_by(offset);
        let system = reference::on_lattice(lattice, reference::INTERMEDIATE, compliance);
        Scene::new(&system)
    }

    /// Fronts for a work of adhesion (J/m^2).
    fn fronts(scene: &Scene, degree: usize, work: f64, partial: bool) -> Fronts {
        let work = work / (scene.pressure * scene.length);
        let works = Works {
            advancing: work,
            receding: work,
        };
        Fronts::new(degree, scene.field.column().shortening, works, partial)
    }

    fn least_force(path: &Path<'_>) -> f64 {
        path.stations.iter().map(|s| s.force).fold(0.0, f64::min)
    }

    /// Seven tops at the pitch of a surface fraction of 0.1 (18.07 um) on a flat lens, out of contact or in full contact. An independent
    /// program with the same modes: 0.89620, 0.89674 and 0.89674 of seven Kendall punches at degree 2, 3 and 4.
    #[test]
    fn seven_tops_pull_each_other_off() {
        let run = Run::default();
        let mut scene = scene(0.1, 0.0, PillarCompliance::None);
        let material = scene.lens.material;
        scene.lens = crate::problem::Lens {
            radius: 1e9,
            material,
        }
        .into();
        for (degree, expected) in [(2, 0.89620), (3, 0.89674), (4, 0.89674)] {
            let fronts = fronts(&scene, degree, 0.05, false);
            let work = fronts.works().receding;
            let mut path = Path::new(&scene, &run, fronts, FixedQuantity::Indentation).unwrap();
            // The first window contains these tops and no others.
            assert_eq!(path.tops.domains.len(), 7);
            path.tops.domains.fill(Domain::FULL);
            path.contact.move_to(0.0);
            path.solve_present(Course::Unloading).unwrap();
            path.respond().unwrap();
            path.go(Course::Unloading, End::Separation, false).unwrap();
            // Kendall's sqrt(8 pi w).
            let kendall = (8.0 * std::f64::consts::PI * work).sqrt();
            let ratio = -least_force(&path) / (7.0 * kendall);
            assert!((ratio - expected).abs() < 2e-5, "{degree}: {ratio}");
        }
    }

    /// Two distant tops in full contact tilt each other by `F/(pi E* s^2)`, which their columns relieve by `1 + rocking`: their rims detach at
    /// `F = F_K (1 - 4/(pi s^2 (1 + rocking)))` with `s` in top radii, to the order of `1/s` of this.
    #[test]
    fn rocking_columns_relieve_the_rims() {
        use crate::problem::{LensShape, ListedPillar, PillarList, ShapedLens};

        let run = Run::default();
        let far = 20.0;
        let pillar = |side: f64| ListedPillar {
            centre: [side * far * 1.5e-6, 0.0],
            height: 3e-6,
            diameter: 6e-6,
        };
        let list = PillarList::new(vec![pillar(-1.0), pillar(1.0)]).unwrap();
        let compliance = PillarCompliance::Elastic;
        let lattice = reference::lattice(0.03);
        let of_paper = reference::on_lattice(lattice, reference::INTERMEDIATE, compliance);
        let plate = LensShape::Plate {
            tilt: 0.0,
            direction: 0.0,
        };
        let lens = ShapedLens::new(plate, of_paper.lens().material);
        let pattern = crate::problem::PillarPattern::new(*of_paper.pillar(), list);
        let system = crate::problem::System::new(lens, *of_paper.substrate(), pattern).unwrap();
        let scene = Scene::new(&system);
        let reduction = |column: crate::problem::column::Column| {
            let work = 0.05 / (scene.pressure * scene.length);
            let works = Works {
                advancing: work,
                receding: work,
            };
            let fronts = Fronts::new(4, column, works, false);
            let mut path = Path::new(&scene, &run, fronts, FixedQuantity::Indentation).unwrap();
            path.go(Course::Loading, End::Indentation(0.05), false)
                .unwrap();
            path.go(Course::Unloading, End::Separation, false).unwrap();
            let kendall = (8.0 * std::f64::consts::PI * work).sqrt();
            1.0 + least_force(&path) / (2.0 * kendall)
        };
        let column = scene.field.column();
        assert!(column.rocking > 0.5);
        let stiff = reduction(column.shortening.into());
        let leaning = reduction(column);
        let expected = 4.0 / (std::f64::consts::PI * far * far);
        assert!((stiff / expected - 1.0).abs() < 0.15, "{stiff} {expected}");
        let relieved = leaning / stiff * (1.0 + column.rocking);
        assert!((relieved - 1.0).abs() < 0.1, "{relieved}");
    }

    /// Detachments at an indentation, one top after the other in any order, lead to the same state as all at once, except for the
    /// directions of fronts, which follow the load within 0.02 rad.
    #[test]
    fn tops_may_detach_in_any_order() {
        use chacha20::ChaCha8Rng;
        use chacha20::rand_core::{Rng, SeedableRng};

        let run = Run::default();
        let scene = scene(0.03, 0.3, PillarCompliance::Column);
        let unloaded = |partial: bool, seed: Option<u64>| {
            let fronts = fronts(&scene, 2, 0.01, partial);
            let mut path = Path::new(&scene, &run, fronts, FixedQuantity::Indentation).unwrap();
            path.go(Course::Loading, End::Indentation(1.0), false)
                .unwrap();
            // Unload by a step in which many tops detach.
            path.advance(-0.9);
            let Some(seed) = seed else {
                path.cascade(Course::Unloading).unwrap();
                return path;
            };
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            loop {
                path.find_loads();
                let moves = path.tops.marched(&path.loads, run.workers());
                let shrink =
                    |(p, next): &&(usize, Domain)| next.level < path.tops.domains[*p].level;
                let moves: Vec<_> = moves.iter().filter(shrink).copied().collect();
                if moves.is_empty() {
                    path.cascade(Course::Unloading).unwrap();
                    path.respond().unwrap();
                    return path;
                }
                let (pillar, next) = moves[random.next_u64() as usize % moves.len()];
                path.tops.domains[pillar] = next;
                path.solve_present(Course::Unloading).unwrap();
            }
        };
        for (partial, tolerance) in [(false, 1e-10), (true, 1e-3)] {
            let expected = unloaded(partial, None);
            for seed in 0..3 {
                let path = unloaded(partial, Some(seed));
                let attached = |path: &Path<'_>| -> Vec<((i64, i64), usize)> {
                    let tops = path.attached_tops();
                    let of_top = |top: &AttachedTop| (top.index, top.domain.level);
                    tops.iter().map(of_top).collect()
                };
                assert_eq!(attached(&path), attached(&expected));
                let difference = (path.force() / expected.force() - 1.0).abs();
                assert!(difference < tolerance, "{partial}: {difference:e}");
            }
            assert!(expected.tops.counts()[0] > 5);
        }
    }
}
