//! Newton's method, with the full Jacobian, for discs that satisfy all conditions.
//!
//! Contacts are added and removed between steps: a contact that would shrink to zero is removed, and an asperity that starts to overlap
//! with the indenter is added with the radius of Hertz's solution. Steps are shortened if a radius would change too much or discs would
//! come too close to each other. If this does not converge, the contact is followed from first contact, in [`climb`](super::climb).

use super::edge::LEANING;
use super::equations::Equations;
use super::load::{Layout, to_summit};
use super::start::{PointForces, free_radius, pressed_adhesive, pressed_with_column};
use crate::halfspace::coupling::moving::PairBlock;
use crate::halfspace::disc::basis::UNIT_FORCE;
use crate::numerics::convergence::clamped;
use crate::numerics::dense::{Lu, Matrix};
use crate::numerics::vector::{add_scaled, dot};
use crate::problem::Point;
use crate::problem::load::Prescribed;
use crate::state::discs::{Contacts, Disc, Hold};
use crate::state::{Progress, Run, SolveError, Stage};

/// Largest number of Newton steps.
pub(crate) const STEP_LIMIT: usize = 40;

/// Largest change of radii and positions in the last step, as a fraction of the largest radius, and of moments, as a fraction of the
/// largest moment. Newton's method converges quadratically, so that the error is of the order of the square.
const TOLERANCE: f64 = 1e-9;

/// Fraction of the distance between two centres that the radii of the discs may fill. Discs beyond the first value are refused; steps are
/// shortened to slightly beyond it.
pub(crate) const MERGING: f64 = 0.95;
const CLIPPED: f64 = 0.96;

/// Smallest and largest factor by which the square of a radius may change in a step.
const SHRINKING: f64 = 0.15;
const GROWING: f64 = 5.0;

/// Smallest contact: fraction of the square of the largest radius.
const NOTHING: f64 = 1e-13;

/// Radius of the disc on which the far field at an untouched asperity is evaluated, as a fraction of the largest radius.
const FEELER: f64 = 1e-3;

/// Distance of a point just inside the rim from the axis of its pillar, in radii.
const INSIDE: f64 = 0.999_999;

/// Distance from the rim of a contact that no longer fills its top, as a fraction of the radius of the top. It is halved every second step:
/// if the contact reaches the rim again from there, its radius is larger.
const LOOSENED: f64 = 0.03;

/// Contacts that satisfy all conditions.
pub(crate) struct Settled {
    pub(crate) contacts: Contacts,
    pub(crate) factors: Option<Lu>,
    pub(crate) steps: usize,
}

/// Reason why the iteration failed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Trouble {
    /// The contacts of two asperities would merge.
    Crowded([usize; 2]),
    /// The step limit was reached.
    Unsettled,
    /// A number became infinite or NaN.
    NotFinite,
}

/// The quantity that a solution is required to have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Aim {
    Load(Prescribed),
    /// The indentation plus the force times a compliance.
    Machine {
        compliance: f64,
        value: f64,
    },
    /// The radius of a disc that does not fill its top. Along a path with adhesion the indentation is not monotonic, but this radius is.
    Radius {
        disc: usize,
        value: f64,
    },
}

/// Result of a step.
#[derive(Default)]
struct Stepped {
    /// Whether the step was shortened, or a contact was added, removed or changed its edge condition.
    changed: bool,
    crowded: Option<[usize; 2]>,
    /// The largest change divided by the tolerance.
    change: f64,
}

/// An asperity that is not in contact.
struct Feeling {
    place: Point,
    overlap: f64,
    swallowed: Option<usize>,
}

impl Equations<'_> {
    /// The whole force. That on the floor is the last one that was computed.
    pub(crate) fn force(&self, contacts: &Contacts) -> f64 {
        self.force_on_tops(contacts) + self.force_on_floor()
    }

    /// Force on all asperities.
    pub(crate) fn force_on_tops(&self, contacts: &Contacts) -> f64 {
        let means = contacts.moments.iter().step_by(self.modes());
        UNIT_FORCE * means.sum::<f64>()
    }

    /// Force on every asperity.
    pub(crate) fn forces(&self, contacts: &Contacts) -> Vec<f64> {
        let mut forces = vec![0.0; self.layout.asperities.len()];
        let means = contacts.moments.iter().step_by(self.modes());
        for (disc, mean) in contacts.discs.iter().zip(means) {
            forces[disc.asperity] += UNIT_FORCE * mean;
        }
        forces
    }

    /// Contacts with the radii given by point forces.
    pub(crate) fn contacts_of(&self, start: &PointForces) -> Contacts {
        let layout = self.layout;
        let mut contacts = Contacts {
            indentation: start.indentation,
            discs: Vec::new(),
            moments: Vec::new(),
            nearest: layout.summits.iter().map(|summit| summit.place).collect(),
            gaps: layout.gaps(start.indentation),
            bonded: [].into(),
        };
        let most = start.pressed.iter().fold(0.0_f64, |a, b| a.max(*b));
        for (asperity, pressed) in start.pressed.iter().enumerate() {
            let place = layout.summits[asperity].place;
            if *pressed > 1e-6 * most && self.is_inside(asperity, place) {
                let (disc, moments) = self.seed(asperity, place, *pressed);
                contacts.discs.push(disc);
                contacts.moments.extend(moments);
            }
        }
        self.part_discs(&mut contacts);
        contacts
    }

    pub(crate) fn is_inside(&self, asperity: usize, [x, y]: Point) -> bool {
        let apex = self.layout.asperities[asperity].apex;
        (x - apex[0]).hypot(y - apex[1]) < self.rim(asperity)
    }

    /// The point, moved to just inside the rim if it is beyond it.
    fn within_rim(&self, asperity: usize, place: Point) -> Point {
        if self.is_inside(asperity, place) {
            return place;
        }
        let apex = self.layout.asperities[asperity].apex;
        let [x, y] = [0, 1].map(|k| place[k] - apex[k]);
        let part = INSIDE * self.rim(asperity) / x.hypot(y);
        [apex[0] + part * x, apex[1] + part * y]
    }

    /// The contact of an isolated asperity with this overlap at a point.
    fn seed(&self, asperity: usize, place: Point, pressed: f64) -> (Disc, Vec<f64>) {
        let curvature = self.layout.summits[asperity].curvature;
        let mut disc = Disc {
            asperity,
            centre: place,
            radius: free_radius(pressed, curvature, self.grip),
            hold: Hold::Free,
            grip: self.grip,
        };
        self.constrain_at_rim(&mut disc);
        self.filled(disc, place, pressed)
    }

    /// The contact of an asperity whose highest point is beyond the rim, with this overlap at the point of the rim next to it: larger in proportion to
    /// the overlap, up to the whole top. A flat punch on a half-space that is tilted by `t` at its rim is in full contact from an overlap of `3 t` at the
    /// rim on (K. L. Johnson, Contact Mechanics, 1985, sec. 3.8 and 5.5).
    fn seed_at_rim(&self, asperity: usize, feeling: &Feeling) -> (Disc, Vec<f64>) {
        let (rim, apex) = (self.rim(asperity), self.layout.asperities[asperity].apex);
        let place = self.within_rim(asperity, feeling.place);
        let beyond = (feeling.place[0] - place[0]).hypot(feeling.place[1] - place[1]);
        let tilt = self.layout.summits[asperity].curvature * beyond * rim;
        let part = (feeling.overlap / (3.0 * tilt)).min(1.0);
        let mut disc = Disc {
            asperity,
            centre: apex,
            radius: part * rim,
            hold: Hold::Whole,
            grip: self.grip,
        };
        if part < 1.0 {
            let angle = (place[1] - apex[1]).atan2(place[0] - apex[0]);
            disc.hold = Hold::Leaning { angle, edge: 0.0 };
            self.lean(&mut disc, angle);
        }
        let compliance = self.layout.asperities[asperity].column_compliance;
        let pressed = feeling.overlap / (1.0 + 2.0 * compliance * disc.radius);
        self.filled(disc, place, pressed)
    }

    /// A disc with the moments that an isolated asperity with this overlap at a point would have.
    fn filled(&self, disc: Disc, place: Point, pressed: f64) -> (Disc, Vec<f64>) {
        let asperity = disc.asperity;
        let mut load = self.rule.workspace();
        self.fill_load(&disc, &mut load);
        load.value[0] += UNIT_FORCE * (pressed - self.overlap(asperity, place).value);
        let mut moments: Vec<f64> = load
            .value
            .iter()
            .zip(&self.eigenvalues)
            .map(|(load, eigenvalue)| disc.radius * load / eigenvalue)
            .collect();
        self.edge.enforce(&disc, &mut moments);
        (disc, moments)
    }

    /// Keeps a free contact within the rim. Returns whether it was changed.
    fn constrain_at_rim(&self, disc: &mut Disc) -> bool {
        let rim = self.rim(disc.asperity);
        let apex = self.layout.asperities[disc.asperity].apex;
        let [x, y] = [0, 1].map(|k| disc.centre[k] - apex[k]);
        let away = x.hypot(y);
        if away + disc.radius <= rim {
            return false;
        }
        let radius = 0.5 * (rim + disc.radius - away);
        if away < 1e-9 * rim || radius >= rim {
            (disc.centre, disc.radius, disc.hold) = (apex, rim, Hold::Whole);
        } else {
            let angle = y.atan2(x);
            disc.radius = radius.max(1e-3 * rim);
            disc.hold = Hold::Leaning { angle, edge: 0.0 };
            self.lean(disc, angle);
        }
        true
    }

    fn lean(&self, disc: &mut Disc, angle: f64) {
        let apex = self.layout.asperities[disc.asperity].apex;
        let away = self.rim(disc.asperity) - disc.radius;
        let (sin, cos) = angle.sin_cos();
        disc.centre = [apex[0] + away * cos, apex[1] + away * sin];
    }

    /// Iterates from these contacts to contacts that satisfy all conditions.
    pub(crate) fn settle(
        &mut self,
        contacts: Contacts,
        target: Prescribed,
        run: &Run<'_>,
    ) -> Result<Result<Settled, Trouble>, SolveError> {
        self.iterate(contacts, Aim::Load(target), true, run)
    }

    /// The same with the asperities that are in contact already, whether others overlap with the indenter or not: their gaps are computed
    /// at the end.
    pub(crate) fn settle_same(
        &mut self,
        contacts: Contacts,
        aim: Aim,
        run: &Run<'_>,
    ) -> Result<Result<Settled, Trouble>, SolveError> {
        let mut settled = self.iterate(contacts, aim, false, run)?;
        if let Ok(settled) = &mut settled
            && let Some(asperities) = self.survey(&mut settled.contacts)
        {
            return Ok(Err(Trouble::Crowded(asperities)));
        }
        Ok(settled)
    }

    fn iterate(
        &mut self,
        mut contacts: Contacts,
        aim: Aim,
        adding: bool,
        run: &Run<'_>,
    ) -> Result<Result<Settled, Trouble>, SolveError> {
        if let Aim::Load(Prescribed::Indentation(indentation)) = aim {
            contacts.indentation = indentation;
        }
        let mut crowded = None;
        for steps in 0..STEP_LIMIT {
            run.check_cancelled()?;
            run.report(Progress {
                stage: Stage::Spectral,
                step: steps,
                pillars: self.layout.asperities.len(),
                touched: contacts.discs.len(),
            });
            if !self.close_floor(&contacts) {
                return Ok(Err(Trouble::Unsettled));
            }
            let (mut stepped, factors) = if contacts.discs.is_empty() {
                self.linearise_floor(&contacts, &mut Matrix::zeros(0, 0));
                (Stepped::default(), None)
            } else {
                self.check_memory(&contacts, run)?;
                let loosened = LOOSENED * 0.5f64.powi(steps as i32 / 2);
                let (stepped, factors) = self.step(&mut contacts, aim, loosened);
                (stepped, Some(factors))
            };
            if !stepped.change.is_finite() || !contacts.indentation.is_finite() {
                return Ok(Err(Trouble::NotFinite));
            }
            let swallowed = if adding {
                self.take_up(&mut contacts, &mut stepped)
            } else {
                None
            };
            crowded = stepped.crowded.or(swallowed);
            if let Some(asperities) = swallowed {
                return Ok(Err(Trouble::Crowded(asperities)));
            }
            if !stepped.changed && stepped.change <= 1.0 {
                let closest = contacts.closest();
                if let Some((pair, part)) = closest
                    && part > MERGING
                {
                    return Ok(Err(Trouble::Crowded(
                        pair.map(|disc| contacts.discs[disc].asperity),
                    )));
                }
                return Ok(match self.close_floor(&contacts) {
                    true => Ok(Settled {
                        contacts,
                        factors,
                        steps: steps + 1,
                    }),
                    false => Err(Trouble::Unsettled),
                });
            }
        }
        Ok(Err(crowded.map_or(Trouble::Unsettled, Trouble::Crowded)))
    }

    fn check_memory(&self, contacts: &Contacts, run: &Run<'_>) -> Result<(), SolveError> {
        let (bytes, limit) = (self.memory(contacts.discs.len()), run.memory_limit());
        if bytes <= limit {
            return Ok(());
        }
        Err(SolveError::TooLarge {
            pillars: contacts.discs.len(),
            bytes,
            limit,
        })
    }

    /// Derivatives of the force and of the area with respect to every component of a step.
    pub(crate) fn rows_of_totals(&self, contacts: &Contacts) -> [Vec<f64>; 2] {
        let size = self.modes();
        let mut rows = [0, 1].map(|_| vec![0.0; contacts.moments.len()]);
        for (number, disc) in contacts.discs.iter().enumerate() {
            let place = number * size..(number + 1) * size;
            let of_area = 2.0 * std::f64::consts::PI * disc.radius;
            self.edge
                .reduce_row(disc, UNIT_FORCE, 0.0, &mut rows[0][place.clone()]);
            self.edge
                .reduce_row(disc, 0.0, of_area, &mut rows[1][place]);
        }
        if let Some(floor) = self.floor_rates() {
            add_scaled(&mut rows[0], 1.0, &floor.row);
        }
        rows
    }

    /// Changes of all components of a step per unit indentation.
    pub(crate) fn lowering(&self, factors: &Lu, size: usize) -> Vec<f64> {
        let mut lowering = vec![0.0; size];
        for mean in lowering.iter_mut().step_by(self.modes()) {
            *mean = UNIT_FORCE;
        }
        if let Some(floor) = self.floor_rates() {
            add_scaled(&mut lowering, -1.0, &floor.residual);
        }
        factors.solve(&mut lowering);
        lowering
    }

    /// Change of the whole force with the indentation.
    pub(crate) fn stiffness(&self, contacts: &Contacts, lowering: &[f64]) -> f64 {
        let [row, _] = self.rows_of_totals(contacts);
        dot(&row, lowering) + self.floor_rates().map_or(0.0, |floor| floor.force)
    }

    /// Contacts changed along a direction by this much, as the start of an iteration.
    pub(crate) fn predicted(&self, contacts: &Contacts, along: &[f64], part: f64) -> Contacts {
        let mut next = contacts.clone();
        let step: Vec<f64> = along.iter().map(|value| part * value).collect();
        next.indentation += part;
        self.apply(&mut next, &step, LOOSENED);
        next
    }

    /// Performs one step of Newton's method. A contact that no longer fills its top is reduced by the fraction `loosened` of its radius.
    fn step(&mut self, contacts: &mut Contacts, aim: Aim, loosened: f64) -> (Stepped, Lu) {
        let linearised = self.linearised(contacts);
        let factors = Lu::new(linearised.matrix);
        let mut step: Vec<f64> = linearised.missing.iter().map(|x| -x).collect();
        factors.solve(&mut step);
        let lowering = self.lowering(&factors, step.len());
        let lower = match aim {
            Aim::Load(Prescribed::Indentation(_)) => 0.0,
            Aim::Load(Prescribed::Force(force)) => {
                let [row, _] = self.rows_of_totals(contacts);
                (force - self.force(contacts) - dot(&row, &step))
                    / self.stiffness(contacts, &lowering)
            }
            Aim::Machine { compliance, value } => {
                let [row, _] = self.rows_of_totals(contacts);
                let reached =
                    contacts.indentation + compliance * (self.force(contacts) + dot(&row, &step));
                (value - reached) / (1.0 + compliance * self.stiffness(contacts, &lowering))
            }
            Aim::Radius { disc, value } => {
                let place = disc * self.modes() + 2;
                (value - contacts.discs[disc].radius - step[place]) / lowering[place]
            }
        };
        add_scaled(&mut step, lower, &lowering);
        contacts.indentation += lower;
        (self.apply(contacts, &step, loosened), factors)
    }

    fn apply(&self, contacts: &mut Contacts, step: &[f64], loosened: f64) -> Stepped {
        let size = self.modes();
        let largest = contacts.largest_radius();
        let square = largest * largest;
        let most = contacts.moments.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let mut stepped = Stepped::default();
        let mut kept = vec![true; contacts.discs.len()];
        for (number, disc) in contacts.discs.iter_mut().enumerate() {
            let place = number * size..(number + 1) * size;
            let moments = &mut contacts.moments[place.clone()];
            let step = &step[place];
            for (moment, change) in moments.iter_mut().zip(step).skip(3) {
                *moment += change;
                stepped.change = stepped.change.max(change.abs() / (TOLERANCE * most));
            }
            if step.iter().any(|value| !value.is_finite()) {
                stepped.change = f64::NAN;
                return stepped;
            }
            if disc.hold == Hold::Whole {
                for (moment, change) in moments.iter_mut().zip(step).take(3) {
                    *moment += change;
                    stepped.change = stepped.change.max(change.abs() / (TOLERANCE * most));
                }
                stepped.changed |= self.loosen(disc, moments, loosened);
                continue;
            }
            let radius = disc.radius;
            let wanted = radius * radius + 2.0 * radius * step[2];
            let moved = match disc.hold {
                Hold::Leaning { .. } => (self.rim(disc.asperity) - radius) * step[1].abs(),
                _ => step[0].hypot(step[1]),
            };
            let change = radius * step[2].abs().max(moved);
            stepped.change = stepped.change.max(change / (TOLERANCE * square));
            if wanted <= NOTHING * square && disc.grip <= 0.0 {
                kept[number] = false;
                stepped.changed = true;
                continue;
            }
            let taken = clamped(
                wanted,
                SHRINKING * radius * radius,
                GROWING * radius * radius,
            );
            stepped.changed |= taken.to_bits() != wanted.to_bits();
            disc.radius = taken.sqrt();
            match &mut disc.hold {
                Hold::Leaning { angle, edge } => {
                    *angle += step[1].clamp(-0.5, 0.5);
                    *edge += step[0];
                    let (angle, edge) = (*angle, *edge);
                    if disc.radius >= self.rim(disc.asperity) {
                        disc.hold = Hold::Whole;
                        disc.radius = self.rim(disc.asperity);
                        disc.centre = self.layout.asperities[disc.asperity].apex;
                        stepped.changed = true;
                        continue;
                    }
                    self.lean(disc, angle);
                    if edge < 0.0 {
                        disc.hold = Hold::Free;
                        stepped.changed = true;
                    }
                }
                _ => {
                    let part = (0.7 * radius / moved).min(1.0);
                    stepped.changed |= part < 1.0;
                    disc.centre = [0, 1].map(|k| disc.centre[k] + part * step[k]);
                    stepped.changed |= self.constrain_at_rim(disc);
                }
            }
            self.edge.enforce(disc, moments);
        }
        if kept.contains(&false) {
            let mut number = kept.iter();
            contacts.discs.retain(|_| number.next() == Some(&true));
            let mut place = 0;
            contacts.moments.retain(|_| {
                place += 1;
                kept[(place - 1) / size]
            });
        }
        stepped.crowded = self.part_discs(contacts);
        stepped.changed |= stepped.crowded.is_some();
        stepped
    }

    /// Detaches a contact that fills its top from the rim where its edge would be in tension. Returns whether it was changed.
    fn loosen(&self, disc: &mut Disc, moments: &mut [f64], loosened: f64) -> bool {
        let [mean, x, y] = self.edge.excess(disc, moments);
        let uneven = x.hypot(y);
        let scale = moments[0].abs();
        if LEANING * mean - uneven >= -1e-12 * scale {
            return false;
        }
        disc.radius *= 1.0 - loosened;
        if mean <= 0.0 {
            disc.hold = Hold::Free;
        } else {
            let angle = y.atan2(x);
            disc.hold = Hold::Leaning { angle, edge: mean };
            self.lean(disc, angle);
        }
        self.edge.enforce(disc, moments);
        true
    }

    /// Shrinks discs that come too close to each other. Returns the asperities of one such pair, if any.
    fn part_discs(&self, contacts: &mut Contacts) -> Option<[usize; 2]> {
        let mut crowded = None;
        for one in 0..contacts.discs.len() {
            for two in one + 1..contacts.discs.len() {
                let [first, second] = [one, two].map(|k| contacts.discs[k]);
                let filled = (first.radius + second.radius) / first.distance(second.centre);
                if filled <= CLIPPED {
                    continue;
                }
                crowded = Some([first.asperity, second.asperity]);
                for number in [one, two] {
                    let disc = &mut contacts.discs[number];
                    disc.radius *= CLIPPED / filled;
                    match disc.hold {
                        Hold::Leaning { angle, .. } => self.lean(disc, angle),
                        Hold::Whole => disc.hold = Hold::Free,
                        Hold::Free => {}
                    }
                }
            }
        }
        crowded
    }

    /// Adds contacts on asperities that overlap with the indenter and are not yet in contact. Returns two asperities if the contact of one
    /// has grown over the other.
    fn take_up(&mut self, contacts: &mut Contacts, stepped: &mut Stepped) -> Option<[usize; 2]> {
        let waiting = self.waiting(contacts);
        let largest = contacts.largest_radius();
        let feeler = FEELER * largest;
        self.prepare_feeler(contacts, &waiting, feeler);
        let mut block = self.pair.workspace();
        let mut fresh = Vec::new();
        for asperity in waiting {
            let feeling = self.feel(contacts, asperity, feeler, &mut block);
            if let Some(other) = feeling.swallowed {
                return Some([other, asperity]);
            }
            contacts.nearest[asperity] = feeling.place;
            contacts.gaps[asperity] = -feeling.overlap;
            let curvature = self.layout.summits[asperity].curvature;
            if feeling.overlap * curvature.recip() > NOTHING * largest * largest
                && feeling.overlap > 0.0
            {
                if !self.is_inside(asperity, feeling.place) {
                    fresh.push(self.seed_at_rim(asperity, &feeling));
                    continue;
                }
                let compliance = self.layout.asperities[asperity].column_compliance;
                let pressed = pressed_with_column(feeling.overlap, curvature, compliance);
                fresh.push(self.seed(asperity, feeling.place, pressed));
            }
        }
        if fresh.is_empty() {
            return None;
        }
        stepped.changed = true;
        self.insert(contacts, fresh);
        stepped.crowded = stepped.crowded.or(self.part_discs(contacts));
        None
    }

    /// Computes the gaps of all asperities that are not in contact. Returns two asperities if the contact of one has grown over the other.
    fn survey(&mut self, contacts: &mut Contacts) -> Option<[usize; 2]> {
        let feeler = FEELER * contacts.largest_radius();
        let waiting = self.waiting(contacts);
        self.prepare_feeler(contacts, &waiting, feeler);
        let mut block = self.pair.workspace();
        for asperity in waiting {
            // The second evaluation is at the highest point according to the first.
            for _ in 0..2 {
                let feeling = self.feel(contacts, asperity, feeler, &mut block);
                if let Some(other) = feeling.swallowed {
                    return Some([other, asperity]);
                }
                contacts.nearest[asperity] = feeling.place;
                contacts.gaps[asperity] = -feeling.overlap;
            }
        }
        None
    }

    /// The asperities that are not in contact.
    pub(crate) fn waiting(&self, contacts: &Contacts) -> Vec<usize> {
        let touched: Vec<usize> = contacts.discs.iter().map(|disc| disc.asperity).collect();
        (0..self.layout.asperities.len())
            .filter(|asperity| touched.binary_search(asperity).is_err())
            .collect()
    }

    fn prepare_feeler(&mut self, contacts: &Contacts, waiting: &[usize], feeler: f64) {
        let mut reach: f64 = 0.0;
        for asperity in waiting {
            for disc in &contacts.discs {
                let place = self.within_rim(*asperity, contacts.nearest[*asperity]);
                let part = (disc.radius + feeler) / disc.distance(place);
                reach = reach.max(part);
            }
        }
        self.pair.prepare(reach.min(0.98));
    }

    /// Adds contacts on these asperities, as on isolated asperities of these overlaps.
    pub(crate) fn with_contacts(&self, contacts: &Contacts, fresh: &[(usize, f64)]) -> Contacts {
        let seeds = fresh.iter().map(|&(asperity, overlap)| {
            let curvature = self.layout.summits[asperity].curvature;
            let compliance = self.layout.asperities[asperity].column_compliance;
            let pressed = pressed_adhesive(overlap, curvature, compliance, self.grip);
            self.seed(asperity, contacts.nearest[asperity], pressed)
        });
        let seeds: Vec<_> = seeds.collect();
        let mut all = contacts.clone();
        self.insert(&mut all, seeds);
        all
    }

    /// Inserts contacts with their moments in the order of the asperities.
    fn insert(&self, contacts: &mut Contacts, fresh: Vec<(Disc, Vec<f64>)>) {
        let size = self.modes();
        let old = contacts.discs.iter().copied();
        let mut all: Vec<(Disc, Vec<f64>)> = old
            .zip(contacts.moments.chunks_exact(size).map(<[f64]>::to_vec))
            .chain(fresh)
            .collect();
        all.sort_by_key(|(disc, _)| disc.asperity);
        contacts.discs = all.iter().map(|(disc, _)| *disc).collect();
        contacts.moments = all.into_iter().flat_map(|(_, moments)| moments).collect();
    }

    /// The same contacts without some of them.
    pub(crate) fn without(&self, contacts: &Contacts, lost: &[usize]) -> Contacts {
        let size = self.modes();
        let keeps = |number: &usize| !lost.contains(number);
        let kept: Vec<usize> = (0..contacts.discs.len()).filter(keeps).collect();
        Contacts {
            discs: kept.iter().map(|k| contacts.discs[*k]).collect(),
            moments: kept
                .iter()
                .flat_map(|k| contacts.moments[k * size..(k + 1) * size].to_vec())
                .collect(),
            ..contacts.clone()
        }
    }

    /// Overlap of an asperity that is not in contact, at its highest point; if that is beyond its rim, at the point of the rim next to it.
    fn feel(
        &self,
        contacts: &Contacts,
        asperity: usize,
        feeler: f64,
        block: &mut PairBlock,
    ) -> Feeling {
        let size = self.modes();
        let place = self.within_rim(asperity, contacts.nearest[asperity]);
        let mut jet = self.overlap(asperity, place);
        jet.value += contacts.indentation;
        let discs = contacts.discs.iter();
        for (disc, moments) in discs.zip(contacts.moments.chunks_exact(size)) {
            if disc.distance(place) * MERGING < disc.radius {
                return Feeling {
                    place,
                    overlap: 0.0,
                    swallowed: Some(disc.asperity),
                };
            }
            let offset = [0, 1].map(|k| place[k] - disc.centre[k]);
            self.pair.fill(offset, [feeler, disc.radius], block);
            let far = |row: usize| -> f64 {
                let row = &block.value[row * size..(row + 1) * size];
                row.iter().zip(moments).map(|(c, m)| c * m).sum()
            };
            // Coefficients of a mean and of a slope.
            jet.value -= far(0) / UNIT_FORCE;
            let scale = 3f64.sqrt() / (UNIT_FORCE * feeler);
            jet.slope[0] -= scale * far(1);
            jet.slope[1] -= scale * far(2);
        }
        let step = to_summit(&jet);
        let summit = [place[0] + step[0], place[1] + step[1]];
        let gained = match self.is_inside(asperity, summit) {
            true => 0.5 * (jet.slope[0] * step[0] + jet.slope[1] * step[1]),
            false => 0.0,
        };
        Feeling {
            place: summit,
            overlap: jet.value + gained,
            swallowed: None,
        }
    }

    /// Returns an asperity that is touched at its rim before its top, if any.
    pub(crate) fn touched_at_rim(&mut self, contacts: &Contacts) -> Option<usize> {
        let waiting = (0..self.layout.asperities.len())
            .filter(|asperity| contacts.discs.iter().all(|disc| disc.asperity != *asperity));
        let outside: Vec<usize> = waiting
            .filter(|asperity| !self.is_inside(*asperity, contacts.nearest[*asperity]))
            .collect();
        if outside.is_empty() {
            return None;
        }
        let feeler = FEELER * contacts.largest_radius();
        self.pair.prepare(0.98);
        let mut block = self.pair.workspace();
        outside
            .into_iter()
            .find(|&asperity| self.feel(contacts, asperity, feeler, &mut block).overlap > 0.0)
    }
}

impl Layout {
    /// A state without contacts.
    pub(crate) fn untouched(&self, indentation: f64) -> Contacts {
        Contacts {
            indentation,
            discs: Vec::new(),
            moments: Vec::new(),
            nearest: self.summits.iter().map(|summit| summit.place).collect(),
            gaps: self.gaps(indentation),
            bonded: [].into(),
        }
    }

    /// Gaps of asperities without load.
    fn gaps(&self, indentation: f64) -> Vec<f64> {
        let summits = self.summits.iter();
        summits.map(|summit| -summit.height - indentation).collect()
    }
}
