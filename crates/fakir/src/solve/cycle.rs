//! Loading and unloading with adhesion: an exact path of events.
//!
//! With what every top has in contact [frozen](super::frozen) all is linear in the indentation, so that the next indentation at which a
//! top changes follows in closed form ([`next_event`](StickyTops::next_event)). There all tops that change do, which changes the
//! loads on the others: a *cascade*, at a fixed indentation, or force, or crosshead of a machine. In a cascade changes in the sense of
//! the course come first (more contact on loading, less on unloading); a top that has made one does not go back, so that every
//! cascade ends. Unloading does not depend on the order: the releases of pulled tops pull the others more. What a cascade
//! sets free is dissipated.

use super::floor::{FloorPoint, FloorSearch, LoadedDiscs};
use super::frozen::{FrozenContact, Source};
use super::rules::fronts::{Course, Domain, Fronts, Works};
use super::rules::sticky::StickyTops;
use crate::halfspace::coupling::lattice::LatticeCoupling;
use crate::halfspace::coupling::pair::PairCoupling;
use crate::halfspace::coupling::window::Window;
use crate::halfspace::disc::basis::{UNIT_FORCE, mode_count};
use crate::halfspace::disc::exterior::Exterior;
use crate::halfspace::disc::projection::LensProjector;
use crate::numerics::convergence::Judgement;
use crate::numerics::vector::add_scaled;
use crate::problem::Point;
use crate::problem::scaled::Problem;
use crate::state::{Progress, Run, SolveError, Stage};

/// Relative energy of the residual of the response at the present indentation, and of that to a unit indentation,
/// which only says where to look next.
const TOLERANCE: f64 = 1e-9;
const UNIT_TOLERANCE: f64 = 1e-6;

/// The path goes this much beyond an event, in the unit of length, so that rounding does not hide it ...
const BEYOND: f64 = 1e-8;

/// ... and this many times further every time that nothing was found to change there.
const FURTHER: f64 = 4.0;

/// Longest way without looking at all tops again, pillar heights.
const LONGEST_STEP: f64 = 0.02;

/// The floor is looked at anew when it is nearer than this part of the indentation at which it would be reached, and
/// every so many steps.
const NEAR_FLOOR: f64 = 0.02;
const STEPS_REMEMBERED: usize = 10;

/// Rounds of a cascade before giving up.
const ROUND_LIMIT: usize = 2000;

/// What is held while tops change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Drive {
    /// The indentation.
    Displacement,
    /// The crosshead of a machine of this stiffness, in units of the solvers.
    Machine(f64),
    /// The force.
    Force,
}

impl Drive {
    /// What is held is `alpha zeta + beta F`.
    fn weights(self) -> [f64; 2] {
        match self {
            Self::Displacement => [1.0, 0.0],
            Self::Machine(stiffness) => [1.0, stiffness.recip()],
            Self::Force => [0.0, 1.0],
        }
    }
}

/// A state on the path, in units of the solvers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Station {
    pub(crate) course: Course,
    pub(crate) indentation: f64,
    pub(crate) force: f64,
    /// Tops in contact, and those in contact in part.
    pub(crate) touched: [usize; 2],
    /// Area in contact.
    pub(crate) area: f64,
}

/// A top that changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TopEvent {
    pub(crate) course: Course,
    pub(crate) indentation: f64,
    pub(crate) force: f64,
    pub(crate) index: (i64, i64),
    pub(crate) levels: [usize; 2],
}

/// Where a part of the path ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum End {
    /// At an indentation.
    Indentation(f64),
    /// Where the floor is reached.
    Floor,
    /// Where nothing is in contact any more.
    Separation,
}

/// What the path has added up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Energies {
    /// `∫ F d zeta` along the path.
    pub(crate) work: f64,
    /// Energy dissipated by what changed.
    pub(crate) dissipation: f64,
    /// Area that came out of contact.
    pub(crate) receded: f64,
}

/// A lens that goes up and down on tops that stick.
pub(crate) struct Cycle<'a> {
    problem: &'a Problem,
    run: &'a Run<'a>,
    pub(crate) window: Window,
    pub(crate) tops: StickyTops,
    pub(crate) contact: FrozenContact<'a, LatticeCoupling>,
    pub(crate) exterior: Exterior,
    floor: FloorSearch,
    works: Works,
    drive: Drive,
    /// Steps gone so far.
    steps: usize,
    /// Loads on all tops at the present indentation, and their change with it.
    loads: Vec<f64>,
    along: Vec<f64>,
    pub(crate) stations: Vec<Station>,
    pub(crate) events: Vec<TopEvent>,
    pub(crate) energies: Energies,
    /// Whether every linear problem was solved and every cascade ended.
    pub(crate) converged: bool,
}

impl<'a> Cycle<'a> {
    /// The lens above the tops within a radius of its axis, at an indentation at which it touches none.
    pub(crate) fn new(
        problem: &'a Problem,
        run: &'a Run<'a>,
        radius: f64,
        degree: usize,
        works: Works,
        partial: bool,
        start: f64,
    ) -> Self {
        let window = Window::new(&problem.lattice, radius);
        let pair = PairCoupling::new(degree, problem.lattice.pitch);
        let modes = mode_count(degree);
        let workers = run.workers();
        let projector = LensProjector::new(problem, degree);
        let mut own_load = vec![0.0; window.len() * modes];
        for (centre, load) in window
            .centres()
            .iter()
            .zip(own_load.chunks_exact_mut(modes))
        {
            projector.project(problem, *centre, load);
        }
        let coupling = LatticeCoupling::new(&window, &pair, workers);
        let fronts = Fronts::new(degree, problem.column_compliance_ratio, works, partial);
        let size = own_load.len();
        let mut contact = FrozenContact::new(run, coupling, modes, own_load);
        contact.move_to(start);
        let mut cycle = Self {
            problem,
            run,
            tops: StickyTops::new(fronts, window.len(), modes),
            window,
            contact,
            exterior: Exterior::new(degree),
            floor: FloorSearch::default(),
            works,
            drive: Drive::Displacement,
            steps: 0,
            loads: vec![0.0; size],
            along: vec![0.0; size],
            stations: Vec::new(),
            events: Vec::new(),
            energies: Energies::default(),
            converged: true,
        };
        cycle.record(Course::Loading);
        cycle
    }

    /// What is held from now on while tops change.
    pub(crate) fn drive_by(&mut self, drive: Drive) {
        self.drive = drive;
    }

    pub(crate) fn indentation(&self) -> f64 {
        self.contact.indentation()
    }

    pub(crate) fn force(&self) -> f64 {
        self.contact.force()
    }

    /// Distance from the lens axis of the farthest point in contact.
    pub(crate) fn contact_radius(&self) -> f64 {
        let pillars = self.tops.domains.iter().zip(self.window.centres());
        pillars
            .filter(|(domain, _)| !domain.is_out())
            .map(|(domain, centre)| {
                let axis = centre.map(|x| -x);
                self.tops.fronts.farthest_from(*domain, axis)
            })
            .fold(0.0, f64::max)
    }

    /// Distance from the lens axis of the farthest centre of a top in contact.
    fn reach(&self) -> f64 {
        let pillars = self.tops.domains.iter().zip(self.window.centres());
        let touched = pillars.filter(|(domain, _)| !domain.is_out());
        touched.map(|(_, [x, y])| x.hypot(*y)).fold(0.0, f64::max)
    }

    /// Whether the window is too small for what is in contact.
    pub(crate) fn is_too_small(&self) -> bool {
        self.reach() + self.problem.lattice.pitch > self.window.radius()
    }

    /// Goes on until the end. Returns the floor point where the floor was reached, which ends every loading.
    pub(crate) fn go(
        &mut self,
        course: Course,
        end: End,
    ) -> Result<Option<FloorPoint>, SolveError> {
        let sign = course.sign();
        let mut beyond = BEYOND;
        self.respond()?;
        loop {
            if end == End::Separation && self.tops.counts()[0] == 0 {
                return Ok(None);
            }
            let along: Vec<f64> = self.along.iter().map(|l| sign * l).collect();
            let loads = [self.loads.as_slice(), along.as_slice()];
            let event = self.tops.next_event(loads, course, self.run.workers());
            let longest = LONGEST_STEP * self.problem.height;
            let to_event = event.map_or(f64::INFINITY, |distance| distance + beyond);
            let to_end = match end {
                End::Indentation(indentation) => sign * (indentation - self.indentation()),
                End::Floor | End::Separation => f64::INFINITY,
            };
            let step = to_event.min(longest).min(to_end);
            if course == Course::Loading
                && let Some(lowest) = self.lowest_floor_within(step)
            {
                self.advance(course, lowest.indentation - self.indentation());
                return Ok(Some(lowest));
            }
            self.advance(course, sign * step);
            self.steps += 1;
            let changes = self.cascade(course)?;
            if !self.converged {
                return Ok(None);
            }
            beyond = if changes == 0 && to_event <= longest {
                beyond * FURTHER
            } else {
                BEYOND
            };
            if changes > 0 {
                self.respond()?;
            } else {
                self.find_loads();
            }
            if to_end <= step {
                return Ok(None);
            }
            self.report();
        }
    }

    fn report(&self) {
        self.run.report(Progress {
            stage: Stage::Cycle,
            step: self.events.len(),
            pillars: self.window.len(),
            touched: self.tops.counts()[0],
        });
    }

    /// Goes along the frozen response.
    fn advance(&mut self, course: Course, step: f64) {
        let force = self.force();
        self.contact.move_to(self.indentation() + step);
        self.energies.work += 0.5 * step * (force + self.force());
        self.record(course);
    }

    fn record(&mut self, course: Course) {
        self.stations.push(Station {
            course,
            indentation: self.indentation(),
            force: self.force(),
            touched: self.tops.counts(),
            area: self.tops.area(),
        });
    }

    /// Both responses with the present domains, and the loads.
    fn respond(&mut self) -> Result<(), SolveError> {
        let unit = self
            .contact
            .solve(&mut self.tops, Source::Unit, UNIT_TOLERANCE)?;
        let present = self.contact.solve(&mut self.tops, Source::Present, TOLERANCE)?;
        self.converged &= unit == Judgement::Good && present == Judgement::Good;
        self.find_loads();
        Ok(())
    }

    fn find_loads(&mut self) {
        self.contact.all_loads(&mut self.loads);
        self.contact.unit_loads(&mut self.along);
    }

    /// All that changes while what drives the lens stands still. Returns how many tops changed.
    fn cascade(&mut self, course: Course) -> Result<usize, SolveError> {
        let [alpha, beta] = self.drive.weights();
        let (start, force) = (self.indentation(), self.force());
        let held = alpha * start + beta * force;
        let (energy, area) = (self.contact.elastic_energy(), self.tops.area());
        let before = self.tops.domains.clone();
        let mut natural = vec![false; before.len()];
        let (mut gained, mut lost) = (0.0, 0.0);
        let workers = self.run.workers();
        for round in 0.. {
            if round == ROUND_LIMIT {
                self.converged = false;
                break;
            }
            self.contact.all_loads(&mut self.loads);
            let moves = self.tops.marched(&self.loads, workers);
            let is_natural = |(pillar, next): &(usize, Domain)| {
                let grows = next.level > self.tops.domains[*pillar].level;
                grows == (course == Course::Loading)
            };
            let mut chosen: Vec<(usize, Domain)> =
                moves.iter().filter(|m| is_natural(m)).copied().collect();
            if chosen.is_empty() {
                let others = moves.into_iter().filter(|(pillar, _)| !natural[*pillar]);
                chosen = others.collect();
            } else {
                for (pillar, _) in &chosen {
                    natural[*pillar] = true;
                }
            }
            if chosen.is_empty() {
                chosen = self.tops.adjusted(&self.loads, workers);
            }
            if chosen.is_empty() {
                break;
            }
            for (pillar, next) in chosen {
                let fronts = &self.tops.fronts;
                let change = fronts.area(next) - fronts.area(self.tops.domains[pillar]);
                gained += change.max(0.0);
                lost += (-change).max(0.0);
                self.tops.domains[pillar] = next;
            }
            if beta != 0.0 {
                let unit = self.contact.solve(&mut self.tops, Source::Unit, TOLERANCE)?;
                self.converged &= unit == Judgement::Good;
            }
            let present = self.contact.solve(&mut self.tops, Source::Present, TOLERANCE)?;
            self.converged &= present == Judgement::Good;
            if beta != 0.0 {
                let missing = held - alpha * self.indentation() - beta * self.force();
                let rate = alpha + beta * self.contact.stiffness();
                if rate <= 0.0 {
                    // Nothing is left to bear the force.
                    break;
                }
                let change = missing / rate;
                self.contact.move_to(self.indentation() + change);
            }
        }
        let (indentation, after) = (self.indentation(), self.force());
        let changed: Vec<usize> = (0..before.len())
            .filter(|pillar| before[*pillar].level != self.tops.domains[*pillar].level)
            .collect();
        for pillar in &changed {
            self.events.push(TopEvent {
                course,
                indentation,
                force: after,
                index: self.window.index(*pillar),
                levels: [before[*pillar].level, self.tops.domains[*pillar].level],
            });
        }
        if gained + lost > 0.0 {
            // What the drive does on the way; at a fixed indentation nothing.
            let done = 0.5 * (indentation - start) * (force + after);
            let stored = self.contact.elastic_energy() - energy;
            self.energies.work += done;
            self.energies.dissipation +=
                done - stored + self.works.advancing * gained - self.works.receding * lost;
            self.energies.receded += lost;
            debug_assert!((self.tops.area() - area - gained + lost).abs() < 1e-6);
            self.record(course);
        }
        Ok(changed.len())
    }

    /// The lowest point of the floor, if it is reached within a step. Low points are remembered from step to step; near the
    /// floor they are sought anew, as another may have become the lowest.
    fn lowest_floor_within(&mut self, step: f64) -> Option<FloorPoint> {
        let remembered = self.lowest_floor()?;
        let ahead = remembered.indentation - self.indentation();
        if ahead > step + NEAR_FLOOR * remembered.indentation && self.steps % STEPS_REMEMBERED > 0 {
            return None;
        }
        self.floor = FloorSearch::default();
        let lowest = self.lowest_floor()?;
        (lowest.indentation <= self.indentation() + step).then_some(lowest)
    }

    /// The lowest point of the floor along the frozen response.
    pub(crate) fn lowest_floor(&mut self) -> Option<FloorPoint> {
        let modes = self.contact.modes();
        let touched: Vec<usize> = (0..self.window.len())
            .filter(|pillar| !self.tops.domains[*pillar].is_out())
            .collect();
        let gather = |coefficients: &[f64]| -> Vec<f64> {
            let of_pillar = |p: &usize| &coefficients[p * modes..(p + 1) * modes];
            touched.iter().flat_map(of_pillar).copied().collect()
        };
        let [present, unit] = self.contact.parts();
        let (mut without, along) = (gather(present), gather(unit));
        add_scaled(&mut without, -self.contact.indentation(), &along);
        let centre = |p: &usize| self.window.centres()[*p];
        let centres: Vec<Point> = touched.iter().map(centre).collect();
        let discs = LoadedDiscs {
            exterior: &self.exterior,
            modes,
            centres: &centres,
            radius: 1.0,
            coefficients: [&along, &without],
            run: self.run,
        };
        self.floor.lowest(self.problem, &discs, &self.run.cancel)
    }
}

/// The indentation at which a lens is surely above all tops.
pub(crate) fn above(problem: &Problem) -> f64 {
    problem.lens.sag(problem.nearest_edge()) - LONGEST_STEP * problem.height
}

/// What a full top bears at a pull, for tests and limits: Kendall's `sqrt(8 pi w)`.
pub(crate) fn kendall_force(work: f64) -> f64 {
    UNIT_FORCE * (4.0 * work).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::PillarCompliance;
    use crate::theory::reference;

    /// The paper's intermediate system.
    fn problem(surface_fraction: f64, offset: f64, compliance: PillarCompliance) -> Problem {
        let lattice = reference::lattice(surface_fraction).offset_by(offset);
        let system = reference::on_lattice(lattice, reference::INTERMEDIATE, compliance);
        Problem::new(&system)
    }

    /// A work of adhesion (J/m^2) in units of the solvers.
    fn works(problem: &Problem, work: f64) -> Works {
        let work = work / (problem.pressure * problem.length);
        Works {
            advancing: work,
            receding: work,
        }
    }

    /// `F = 2a(2a^2/(3R) - sqrt(2 pi a w))` of one top on the lens (Kendall's punch with the lens shape).
    #[test]
    fn one_top_pulls_off_as_kendall_s_punch() {
        let run = Run::default();
        for compliance in [PillarCompliance::None, PillarCompliance::Column] {
            let problem = problem(0.001, 0.0, compliance);
            let works = works(&problem, 0.05);
            for drive in [Drive::Displacement, Drive::Machine(0.3)] {
                let mut cycle = Cycle::new(&problem, &run, 0.5, 2, works, true, above(&problem));
                cycle.drive_by(drive);
                cycle.go(Course::Loading, End::Indentation(0.1)).unwrap();
                assert!(cycle.tops.domains[0].is_full());
                cycle.go(Course::Unloading, End::Separation).unwrap();
                let lowest = cycle.stations.iter().map(|s| s.force).fold(0.0, f64::min);
                let radius = problem.lens.radius;
                let expected = 4.0 / (3.0 * radius) - kendall_force(works.receding);
                // The path goes 1e-8 beyond the event.
                assert!(
                    (lowest / expected - 1.0).abs() < 1e-6,
                    "{lowest} {expected}"
                );
                assert!(cycle.converged);
                let Energies {
                    work, dissipation, ..
                } = cycle.energies;
                println!("{compliance:?} {drive:?} work {work:e} dissipation {dissipation:e}");
            }
        }
    }

    /// Seven tops at the pitch of a surface fraction of 0.1 (18.07 um) on a flat lens, out of contact or in full. An
    /// independent program of the same modes: 0.89620, 0.89674 and 0.89674 of seven punches of Kendall at degree 2, 3 and 4.
    #[test]
    fn seven_tops_pull_each_other_off() {
        let run = Run::default();
        let mut problem = problem(0.1, 0.0, PillarCompliance::None);
        problem.lens.radius = 1e9;
        let works = works(&problem, 0.05);
        for (degree, expected) in [(2, 0.89620), (3, 0.89674), (4, 0.89674)] {
            let mut cycle = Cycle::new(&problem, &run, 6.5, degree, works, false, above(&problem));
            cycle.go(Course::Loading, End::Indentation(0.01)).unwrap();
            assert_eq!(cycle.tops.counts(), [7, 0]);
            cycle.go(Course::Unloading, End::Separation).unwrap();
            let lowest = cycle.stations.iter().map(|s| s.force).fold(0.0, f64::min);
            let ratio = -lowest / (7.0 * kendall_force(works.receding));
            assert!((ratio - expected).abs() < 2e-5, "{degree}: {ratio}");
        }
    }

    #[test]
    #[ignore = "measures"]
    fn measure() {
        let run = Run::default();
        for (fraction, offset, joules) in [
            (0.01, 0.0, 0.05),
            (0.03, 0.0, 0.001),
            (0.03, 0.0, 0.05),
            (0.1, 0.0, 0.01),
            (0.1, 0.0, 0.05),
            (0.1, 0.3, 0.05),
        ] {
            for degree in [2, 3] {
                let problem = problem(fraction, offset, PillarCompliance::Column);
                let works = works(&problem, joules);
                let radius = 215.0 / 3.0;
                let start = std::time::Instant::now();
                let mut cycle =
                    Cycle::new(&problem, &run, radius, degree, works, true, above(&problem));
                let floor = cycle.go(Course::Loading, End::Floor).unwrap();
                let loaded = start.elapsed().as_secs_f64();
                let events = cycle.events.len();
                let (force, zeta) = (cycle.force(), cycle.indentation());
                let counts = cycle.tops.counts();
                let radius = cycle.contact_radius();
                cycle.go(Course::Unloading, End::Separation).unwrap();
                let lowest = cycle.stations.iter().map(|s| s.force).fold(0.0, f64::min);
                let n = 1e-6 * 1.3333333333 * problem.length.powi(2) * 1e12;
                let um = problem.length * 1e6;
                println!(
                    "phi {fraction} dx {offset} w {joules} p {degree}: zeta_c {:.6} F_c {:.7e} {counts:?} r {:.2} pull {:.5e} loop {:.4e} diss {:.4e} events {events}+{} t {loaded:.2}+{:.2} converged {} last {:.4} small {}",
                    zeta * um,
                    force * n,
                    radius * um,
                    lowest * n,
                    cycle.energies.work * n * um * 1e-6,
                    cycle.energies.dissipation * n * um * 1e-6,
                    cycle.events.len() - events,
                    start.elapsed().as_secs_f64() - loaded,
                    cycle.converged,
                    cycle.indentation() * um,
                    cycle.is_too_small(),
                );
                let _ = floor;
            }
        }
    }
}
