//! Contact inside the rim of one top: a disc around the lens axis that grows and shrinks like the contact of a sphere on a flat.
//!
//! The pressure is expanded on the disc itself ([`PatchSolver`]), at whose edge `q = -q_c`, `q_c = sqrt(2 w/(pi a))`, while it advances or
//! recedes (K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301 (1971)). If the works of adhesion differ, the edge is pinned
//! in between. The path continues with fronts as soon as the disc reaches the rim of the top or another top is touched; it switches from
//! fronts to the disc when the rim of the last top in contact detaches.

use super::Path;
use super::disc::{Edge, InsideTop};
use super::records::{AT_RIM, CENTRED, Change, End, Stop};
use crate::halfspace::disc::exterior::Exterior;
use crate::numerics::roots;
use crate::problem::pillar_field::{ListedPillar, PillarBody};
use crate::solve::floor::{FloorDisplacement, FloorPoint, FloorSearch};
use crate::solve::rules::fronts::{Course, Domain, Fronts};
use crate::solve::rules::patch::{Patch, PatchSolver};
use crate::state::{SolveError, Stage};
use std::convert::Infallible;

/// Factor on the largest contact of a lens up to which a disc is followed.
const FARTHER: f64 = 1.01;

/// Smallest change of the bonded fraction of a top that counts.
const NO_CHANGE: f64 = 1e-4;

/// Largest relative change of the radius in a step, and that in top radii for a first contact.
const STEP: f64 = 0.05;
const FIRST_STEP: f64 = 0.02;

/// Relative tolerance of the radius at which the floor is reached.
const FLOOR_TOLERANCE: f64 = 1e-9;

impl Path<'_> {
    /// The top under the lens axis, if a contact disc inside it is possible.
    fn top_under_axis(&self) -> Option<InsideTop> {
        if !self.scene.lens.is_axisymmetric() || self.scene.lens.is_flat() {
            return None; // the first contact is no disc
        }
        let (index, ListedPillar { centre, body }) = self.scene.field.under([0.0, 0.0])?;
        let from_centre = centre[0].hypot(centre[1]);
        if body.column.rocking > 0.0 && from_centre > CENTRED {
            // The top tilts, which moves the disc off the axis.
            return None;
        }
        // A contact that is too large for the lens is refused before it reaches the rim.
        let too_large = FARTHER * self.scene.lens.largest_contact();
        let largest = (body.radius - from_centre).min(too_large);
        let shortening = body.column.shortening / body.radius;
        let solver = PatchSolver::new(shortening, &self.scene.layers);
        (largest > 0.0).then(|| InsideTop {
            exterior: Exterior::new(if self.scene.layers.is_empty() {
                solver.degree()
            } else {
                0 // not used
            }),
            layers: self.scene.layers.clone(),
            patch: solver.with_radius(largest, |_| 0.0),
            solver,
            index,
            centre,
            top: body.radius,
            raised: body.raised,
            largest,
        })
    }

    /// The quantity that the drive keeps fixed, for a disc.
    fn held_by(&self, inside: &InsideTop, patch: &Patch) -> f64 {
        let [alpha, beta] = self.fixed.weights();
        alpha * inside.indentation(patch) + beta * patch.force
    }

    /// The edge of a disc that advances on loading, and recedes on unloading.
    fn edge_of<'e>(
        &self,
        inside: &'e InsideTop,
        sag: &'e dyn Fn(f64) -> f64,
        course: Course,
    ) -> Edge<'e> {
        let work = match course {
            Course::Loading => self.works.advancing,
            Course::Unloading => self.works.receding,
        };
        Edge { inside, sag, work }
    }

    fn sag_at(&self) -> impl Fn(f64) -> f64 + use<'_> {
        |radius: f64| self.scene.lens.sag([radius, 0.0])
    }

    /// Radius at which a disc detaches completely: the minimum of the quantity that the drive keeps fixed.
    fn detaching_radius(&self, edge: Edge<'_>) -> f64 {
        edge.least(|patch| self.held_by(edge.inside, patch))
    }

    /// Jump-in where the lens first touches a top inside its rim, if the disc after jump-in is inside the rim too. Returns whether it is.
    pub(super) fn snap_inside(&mut self, end: End) -> Result<bool, SolveError> {
        if self.counts()[0] > 0 || self.floor.is_some() {
            return Ok(false);
        }
        let Some(mut inside) = self.top_under_axis() else {
            return Ok(false);
        };
        let touched_at = -inside.raised;
        let first_touch = self.scene.first_touch();
        if touched_at > first_touch + f64::EPSILON * first_touch.abs()
            || touched_at < self.indentation()
            || matches!(end, End::Indentation(indentation) if indentation <= touched_at)
        {
            return Ok(false);
        }
        let sag = self.sag_at();
        let edge = self.edge_of(&inside, &sag, Course::Loading);
        let [alpha, _] = self.fixed.weights();
        let fixed = alpha * touched_at;
        let measure = |patch: &Patch| self.held_by(&inside, patch);
        let least = self.detaching_radius(edge);
        let snaps_to_rim = measure(&edge.at(inside.largest)) <= fixed;
        if snaps_to_rim && least > (1.0 - AT_RIM) * inside.largest {
            // The top is too small for a disc inside it.
            return Ok(false);
        }
        let patch = if snaps_to_rim {
            self.pinned_at_rim(&inside, &sag, fixed)
        } else {
            edge.at(edge.find([least, inside.largest], fixed, measure))
        };
        drop(sag);
        self.advance(touched_at - self.indentation());
        self.record(Course::Loading);
        let before = [touched_at, self.force()];
        let part = inside.part(patch.radius);
        inside.patch = patch;
        self.move_disc(inside);
        self.account_disc(Course::Loading, before, 0.0, [0.0, part]);
        if snaps_to_rim {
            self.leave_inside(true)?;
        }
        Ok(true)
    }

    /// The largest disc at a fixed quantity of the drive, with an edge that is not loaded enough to move.
    fn pinned_at_rim(&self, inside: &InsideTop, sag: &impl Fn(f64) -> f64, fixed: f64) -> Patch {
        let [alpha, beta] = self.fixed.weights();
        let own = fixed + alpha * inside.raised;
        inside
            .solver
            .with_fixed(inside.largest, sag, [alpha, beta], own)
    }

    /// Replaces the front by a disc where the rim of the only top in contact is about to detach and a disc inside it would not: as soon as
    /// that disc does not touch the rim. Returns whether it does.
    pub(super) fn recede_inside(&mut self) -> Result<bool, SolveError> {
        if self.counts()[0] != 1 || self.floor.is_some() {
            return Ok(false);
        }
        let Some(mut inside) = self.top_under_axis() else {
            return Ok(false);
        };
        let Some(pillar) = self.sites.find(inside.index) else {
            return Ok(false);
        };
        let before = self.tops.domains[pillar];
        // The energy belongs to the current loads.
        self.find_loads();
        let sag = self.sag_at();
        let edge = self.edge_of(&inside, &sag, Course::Unloading);
        let least = self.detaching_radius(edge);
        let [alpha, beta] = self.fixed.weights();
        let (start, energy) = ([self.indentation(), self.force()], self.elastic_energy());
        let fixed = alpha * start[0] + beta * start[1];
        let measure = |patch: &Patch| self.held_by(&inside, patch);
        // A rim that detaches on all sides leaves a disc, or no contact if the disc is unstable. A rim that detaches on one side leaves a
        // front.
        let is_stable =
            least < (1.0 - AT_RIM) * inside.largest && measure(&edge.at(least)) <= fixed;
        let is_at_rim = measure(&edge.at(inside.largest)) < fixed;
        let recedes = if before.is_full() {
            inside.is_centred() || is_stable
        } else {
            is_stable && !is_at_rim
        };
        if !recedes {
            return Ok(false);
        }
        let patch = if is_at_rim {
            self.pinned_at_rim(&inside, &sag, fixed)
        } else if !is_stable {
            edge.at(inside.largest)
        } else {
            edge.at(edge.find([least, inside.largest], fixed, measure))
        };
        drop(sag);
        let part = inside.part(patch.radius);
        let is_centred = inside.is_centred();
        inside.patch = patch;
        self.tops.domains[pillar] = Domain::OUT;
        self.solve_unit()?;
        self.solve_present(Course::Unloading)?;
        self.move_disc(inside);
        if is_stable {
            let parts = [Fronts::part(before.level), part];
            self.account_disc(Course::Unloading, start, energy, parts);
            if !is_centred {
                self.open_by_change(start);
            }
        } else {
            self.detach_disc()?;
        }
        Ok(true)
    }

    /// Moves to a disc and its indentation.
    fn move_disc(&mut self, inside: InsideTop) {
        self.contact.move_to(inside.indentation(&inside.patch));
        self.inside = Some(inside);
    }

    /// Records the event in which the disc appeared or disappeared, with the bonded fractions of the top before and after.
    fn account_disc(&mut self, course: Course, start: [f64; 2], energy: f64, parts: [f64; 2]) {
        let Some(inside) = &self.inside else { return };
        let mut change = inside.changed(parts);
        let [before, after] = parts;
        if (after - before).abs() <= NO_CHANGE {
            change.tops.clear();
        }
        if course == Course::Unloading && !inside.is_centred() {
            // On the way there were fronts, or would be.
            change.tops.iter_mut().for_each(|top| top.levels = 1);
        }
        self.account(course, start, energy, &change);
    }

    /// Performs one step with a disc inside a top. Returns the reason for stopping, if any.
    pub(super) fn step_inside(
        &mut self,
        course: Course,
        end: End,
        watch_floor: bool,
    ) -> Result<Option<Stop>, SolveError> {
        self.report(Stage::Cycle, self.events.len());
        self.run.check_cancelled()?;
        match course {
            Course::Loading => self.grow_inside(end, watch_floor),
            Course::Unloading => self.shrink_inside(end),
        }
    }

    fn grow_inside(&mut self, end: End, watch_floor: bool) -> Result<Option<Stop>, SolveError> {
        let Some(inside) = &self.inside else {
            return Ok(None);
        };
        let sag = self.sag_at();
        let edge = self.edge_of(inside, &sag, Course::Loading);
        let (present, radius) = (self.indentation(), inside.patch.radius);
        let target = present + self.longest_step(Course::Loading);
        let target = match end {
            End::Indentation(indentation) => target.min(indentation),
            _ => target,
        };
        let depth = |patch: &Patch| inside.indentation(patch);
        let force = |patch: &Patch| patch.force;
        let farthest = ((1.0 + STEP) * radius).max(FIRST_STEP * inside.largest);
        let farthest = farthest.min(inside.largest);
        let last = edge.at(farthest);
        let passes = depth(&last) > target;
        let mut leaves = !passes && farthest >= inside.largest;
        let mut next = if passes {
            edge.find([radius, farthest], target, depth)
        } else {
            farthest
        };
        let mut stop = match end {
            End::Indentation(indentation) if passes || depth(&last) >= indentation => {
                (target >= indentation).then_some(Stop::End)
            }
            End::Force(wanted) if edge.at(next).force >= wanted => {
                if inside.patch.force < wanted {
                    next = edge.find([radius, next], wanted, force);
                }
                Some(Stop::End)
            }
            _ => None,
        };
        if watch_floor {
            let reached = |radius: f64| {
                let patch = edge.at(radius);
                let lowest = self.floor_under(inside, &patch);
                (
                    lowest,
                    lowest.map_or(-1.0, |it| depth(&patch) - it.indentation),
                )
            };
            let (lowest, past) = reached(next);
            if past >= 0.0 {
                // The overshoot past the floor increases with the radius.
                let ends = [(radius, reached(radius).1), (next, past)];
                let ends = ends.map(|(position, value)| roots::Point { position, value });
                let find = |radius| Ok::<_, Infallible>(reached(radius).1);
                let root = roots::find(ends, FLOOR_TOLERANCE * next, find);
                let root = root.unwrap_or_else(|never| match never {});
                next = root.map_or(next, |root| root.closest().position);
                stop = reached(next).0.or(lowest).map(Stop::Floor);
            }
        }
        if stop.is_some() {
            leaves = false;
        }
        let patch = edge.at(next);
        drop(sag);
        if next > self.scene.lens.largest_contact() {
            return Err(self.too_large(next));
        }
        self.move_to_patch(Course::Loading, patch);
        if stop.is_none() && (leaves || self.touches_another()) {
            self.leave_inside(leaves)?;
        }
        Ok(stop)
    }

    fn shrink_inside(&mut self, end: End) -> Result<Option<Stop>, SolveError> {
        let Some(inside) = &self.inside else {
            return Ok(None);
        };
        let sag = self.sag_at();
        let edge = self.edge_of(inside, &sag, Course::Unloading);
        let (present, radius) = (self.indentation(), inside.patch.radius);
        let farthest = match end {
            End::Indentation(indentation) => indentation,
            _ => f64::NEG_INFINITY,
        };
        let target = farthest.max(present - self.longest_step(Course::Unloading));
        let stop = |at: f64| (at <= farthest).then_some(Stop::End);
        let depth = |patch: &Patch| inside.indentation(patch);
        // The edge is pinned until it carries the tension at which it detaches.
        let recedes_at = depth(&edge.at(radius));
        if present > recedes_at + f64::EPSILON * present.abs() {
            let at = target.max(recedes_at);
            let own = at + inside.raised;
            let patch = inside.solver.with_fixed(radius, &sag, [1.0, 0.0], own);
            drop(sag);
            self.move_to_patch(Course::Unloading, patch);
            return Ok(stop(at));
        }
        // A load step is placed at the strongest pull.
        let detaching = self.detaching_radius(edge).min(radius);
        let strongest = edge.least(|patch| patch.force);
        let mut next = detaching.max((1.0 - STEP) * radius);
        if next < strongest && strongest < radius {
            next = strongest;
        }
        if depth(&edge.at(next)) < target {
            next = edge.find([next, radius], target, depth);
        }
        let patch = edge.at(next);
        drop(sag);
        self.move_to_patch(Course::Unloading, patch);
        if next <= detaching {
            self.detach_disc()?;
        }
        Ok(stop(self.indentation()))
    }

    /// Detaches the disc completely; nothing is in contact afterwards.
    fn detach_disc(&mut self) -> Result<(), SolveError> {
        let start = [self.indentation(), self.force()];
        let energy = self.elastic_energy();
        let Some(inside) = self.inside.take() else {
            return Ok(());
        };
        let change = inside.changed([inside.part(inside.patch.radius), 0.0]);
        let [alpha, beta] = self.fixed.weights();
        if alpha > 0.0 {
            // A testing machine moves the lens until the force is zero.
            let fixed = alpha * start[0] + beta * start[1];
            self.contact.move_to(fixed / alpha);
        }
        self.respond()?;
        self.account(Course::Unloading, start, energy, &change);
        self.report(Stage::Cycle, self.events.len());
        Ok(())
    }

    /// Moves to another disc in equilibrium; the force is interpolated linearly in between.
    fn move_to_patch(&mut self, course: Course, patch: Patch) {
        let start = [self.indentation(), self.force()];
        let Some(inside) = &mut self.inside else {
            return;
        };
        let lost = inside.area();
        inside.patch = patch;
        let lost = lost - inside.area();
        let indentation = inside.indentation(&inside.patch);
        self.contact.move_to(indentation);
        self.energies.receded += lost.max(0.0);
        self.add_work(indentation - start[0], [start[1], self.force()]);
        self.record(course);
    }

    /// The lowest point of the floor under a disc.
    fn floor_under(&self, inside: &InsideTop, patch: &Patch) -> Option<FloorPoint> {
        let floor = self.uncovered(patch.radius);
        inside.with_patch(patch, self.run, |discs| {
            FloorSearch::default().lowest(&floor, discs, &self.run.cancel)
        })
    }

    /// Whether the lens touches another top.
    fn touches_another(&self) -> bool {
        let Some(inside) = &self.inside else {
            return false;
        };
        let (lens, indentation) = (&self.scene.lens, self.indentation());
        let reached = self.scene.farthest_reached(indentation);
        inside.with_discs(self.run, |discs| {
            (0..self.sites.len()).any(|site| {
                let centre = self.sites.centres()[site];
                let distance = centre[0].hypot(centre[1]);
                if self.sites.index(site) == inside.index || distance > reached {
                    return false;
                }
                let PillarBody { radius, raised, .. } = *self.sites.body(site);
                [-radius, 0.0, radius].iter().any(|beside| {
                    let at = centre.map(|x| x * (1.0 + beside / distance));
                    let [_, displaced] = discs.displacement(at);
                    lens.sag_with_brim(at) + displaced.value - raised <= indentation
                })
            })
        })
    }

    /// Replaces the disc by a front, or by full contact if the disc fills the top.
    fn leave_inside(&mut self, at_rim: bool) -> Result<(), SolveError> {
        let start = [self.indentation(), self.force()];
        let energy = self.elastic_energy();
        let Some(inside) = self.inside.take() else {
            return Ok(());
        };
        let Some(pillar) = self.sites.find(inside.index) else {
            return Ok(());
        };
        let fills = at_rim && inside.is_centred();
        self.tops.domains[pillar] = if fills {
            Domain::FULL
        } else {
            self.find_loads();
            let modes = self.contact.modes();
            let load = &self.loads[pillar * modes..][..modes];
            self.tops.fronts(pillar).nearest(inside.area(), load)
        };
        self.solve_present(Course::Loading)?;
        self.respond()?;
        let area = self.tops.fronts(pillar).area(self.tops.domains[pillar]);
        let change = Change {
            gained: (area - inside.area()).max(0.0),
            lost: 0.0,
            tops: Vec::new(),
        };
        self.account(Course::Loading, start, energy, &change);
        if !fills {
            self.cascade(Course::Loading)?;
            self.open_by_change(start);
        }
        Ok(())
    }
}
