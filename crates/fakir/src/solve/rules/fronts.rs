//! Adhesive pillar tops: bonded region of a top, and its evolution.
//!
//! A top is out of contact, in full contact, or bonded up to a front: the part `x < s - b y^2` of the unit disc, with `x` along the
//! direction in which the load decreases. A front has one of 16 levels of area and one of five curvatures `b`. The pressure on the bonded
//! region may have either sign, so that the top responds linearly to its load, `c = P l`, with a matrix `P` from a table
//! (`front_table.csv`, created by the example `front_table`).
//!
//! A front moves according to its energy release rate (Griffith): from level `k` to the next one, with an area larger by `dA`, this is
//! `G = (e_{k+1} - e_k)/dA` with `e = l'P l/2`, at the curvature that minimises `e`. The front advances if `G` is below the work of
//! adhesion and recedes if `G` exceeds it. If the next strip would be under compression rather than tension, `G` counts as negative: the
//! front must advance. Without adhesion, fronts then stop where the edge is under neither compression nor tension, as required. The rim of
//! a top in full contact is stable up to the edge coefficient `q = -q_c`, `q_c = sqrt(2 w/pi)`: the stress intensity factor there is
//! `-q sqrt(pi a)` (K. Kendall, J. Phys. D 4, 1186 (1971), for the single punch).
//!
//! Lengths are in common pillar radii, pressures in `E*`, so that works of adhesion are in `E*` times this radius. A top of another radius
//! `a` responds like one of unit radius with moments larger by a factor of `a` and works of adhesion larger by the same factor: under equal
//! loads its pressures are lower by `1/a`, and `q_c` by `1/sqrt a`.

use crate::halfspace::disc::basis::{
    BasisEvaluator, TILT_COMPLIANCE, compliances, degree_with, mode_count,
};
use crate::halfspace::disc::exterior::MAXIMUM_DEGREE;
use crate::problem::column::Column;
use crate::state::Branch;
use crate::state::fields::{BondedRegion, Front};
use std::f64::consts::{PI, TAU};
use std::sync::{Arc, LazyLock};

/// Number of area levels, not counting the empty one; the last is the whole top.
pub(crate) const LEVELS: usize = 16;

/// Number of front curvatures.
const CURVATURES: usize = 5;

/// Number of modes of the response of partially bonded tops: those up to degree 2.
const MODES: usize = 6;

/// Number of modes of the highest degree available.
const MOST_MODES: usize = mode_count(MAXIMUM_DEGREE);

/// Number of angles at which the edge of a top is evaluated.
const RIM_ANGLES: usize = 360;

/// Number of points around the bonded region of a top: the farthest point is found to 6e-4 pillar radii.
const OUTLINE_ANGLES: usize = 90;

/// Radii of the circles on which contact with a top is checked, and number of points on each.
const RINGS: [f64; 4] = [0.3, 0.6, 0.85, 1.0];
const RING_POINTS: usize = 72;

/// Angle between a front and its load above which the front is rotated, rad.
const DIRECTION_TOLERANCE: f64 = 0.02;

/// Entries of the table in its order: modes 0, 1, 3, 4 are even across the direction of the front, 2 and 5 odd.
const ENTRIES: [(usize, usize); 13] = [
    (0, 0),
    (0, 1),
    (0, 3),
    (0, 4),
    (1, 1),
    (1, 3),
    (1, 4),
    (2, 2),
    (2, 5),
    (3, 3),
    (3, 4),
    (4, 4),
    (5, 5),
];

/// `P` of one front, in its own frame: the entries of the table.
type Entries = [f64; ENTRIES.len()];

/// Bonded region of a top.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Domain {
    /// 0 is no contact, [`LEVELS`] full contact.
    pub(crate) level: usize,
    curvature: usize,
    /// Direction relative to x in which the load decreases, rad.
    direction: f64,
}

impl Domain {
    pub(crate) const OUT: Self = Self {
        level: 0,
        curvature: 0,
        direction: 0.0,
    };

    pub(crate) const FULL: Self = Self {
        level: LEVELS,
        ..Self::OUT
    };

    pub(crate) fn is_out(self) -> bool {
        self.level == 0
    }

    pub(crate) fn is_full(self) -> bool {
        self.level == LEVELS
    }

    pub(crate) fn is_partial(self) -> bool {
        !self.is_out() && !self.is_full()
    }
}

/// Works of adhesion, in `E* a`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Works {
    /// On attachment.
    pub(crate) advancing: f64,
    /// On detachment.
    pub(crate) receding: f64,
}

impl Works {
    /// Multiplies both by a factor.
    pub(crate) fn times(self, factor: f64) -> Self {
        Self {
            advancing: factor * self.advancing,
            receding: factor * self.receding,
        }
    }
}

/// `q_c` for a work of adhesion: the stress intensity factor, over the root of `pi a`, at which the rim of a top detaches.
pub(crate) fn critical_stress_intensity_factor(work: f64) -> f64 {
    (2.0 * work / PI).sqrt()
}

/// Direction of the indentation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Course {
    Loading,
    Unloading,
}

impl Course {
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::Loading => 1.0,
            Self::Unloading => -1.0,
        }
    }

    /// The branch in results.
    pub(crate) fn branch(self) -> Branch {
        match self {
            Self::Loading => Branch::Loading,
            Self::Unloading => Branch::Unloading,
        }
    }
}

/// A load along a straight line: `l(t) = start + t along`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line<'l> {
    pub(crate) start: &'l [f64],
    pub(crate) along: &'l [f64],
}

impl<'l> Line<'l> {
    /// A constant load.
    fn at(load: &'l [f64]) -> Self {
        Self {
            start: load,
            along: &[0.0; MOST_MODES][..load.len()],
        }
    }
}

/// Responses of tops of one radius on equal columns, and their criteria of change.
pub(crate) struct Fronts {
    /// Works of adhesion, and the same times the radius of the tops.
    works: Works,
    own: Works,
    /// Radius of the tops.
    radius: f64,
    /// `P` by level and curvature for a top of unit radius, including columns.
    responses: Vec<[Entries; CURVATURES]>,
    /// `1/lambda` of the modes of the coupling.
    full: Vec<f64>,
    /// Bounds of the edge coefficients per unit load in every mode.
    rim_bounds: Vec<f64>,
    modes: Arc<Modes>,
    /// Whether fronts may stop at intermediate levels; otherwise tops are out of contact or in full contact.
    partial: bool,
}

/// The modes of the coupling at the points of a top at which it is checked, for tops of any radius on any column.
struct Modes {
    /// At every angle of the rim.
    rim: Vec<f64>,
    /// At the points where contact is checked.
    points: Vec<f64>,
    /// Bounds of the modes at the angles, and at the points.
    rim_bounds: Vec<f64>,
    bounds: Vec<f64>,
}

impl Modes {
    fn new(degree: usize) -> Self {
        let count = mode_count(degree);
        let mut basis = BasisEvaluator::new(degree);
        let mut rim = vec![0.0; RIM_ANGLES * count];
        for (number, row) in rim.chunks_exact_mut(count).enumerate() {
            let (sin, cos) = (TAU * number as f64 / RIM_ANGLES as f64).sin_cos();
            basis.evaluate([cos, sin], row);
        }
        let ring = |rho: f64| {
            (0..RING_POINTS).map(move |number| {
                let (sin, cos) = (TAU * number as f64 / RING_POINTS as f64).sin_cos();
                [rho * cos, rho * sin]
            })
        };
        let places = std::iter::once([0.0, 0.0]).chain(RINGS.into_iter().flat_map(ring));
        let mut points = Vec::new();
        for place in places {
            let mut row = vec![0.0; count];
            basis.evaluate(place, &mut row);
            points.extend(row);
        }
        let bounds = |rows: &[f64]| {
            let mut bounds = vec![0.0_f64; count];
            for row in rows.chunks_exact(count) {
                for (bound, value) in bounds.iter_mut().zip(row) {
                    *bound = bound.max(value.abs());
                }
            }
            bounds
        };
        Self {
            rim_bounds: bounds(&rim),
            bounds: bounds(&points),
            rim,
            points,
        }
    }
}

impl Fronts {
    /// For tops of unit radius whose pressure has the modes up to `degree`, at least 2.
    pub(crate) fn new(
        degree: usize,
        column: impl Into<Column>,
        works: Works,
        partial: bool,
    ) -> Self {
        let modes = Arc::new(Modes::new(degree));
        Self::of(modes, degree, 1.0, column.into(), works, partial)
    }

    /// The same for tops of another radius, on other columns.
    pub(crate) fn on(&self, radius: f64, column: Column) -> Self {
        let modes = self.modes.clone();
        Self::of(
            modes,
            self.degree(),
            radius,
            column,
            self.works,
            self.partial,
        )
    }

    fn of(
        modes: Arc<Modes>,
        degree: usize,
        radius: f64,
        column: Column,
        works: Works,
        partial: bool,
    ) -> Self {
        let full: Vec<f64> = compliances(degree, column)
            .iter()
            .map(|lambda| lambda.recip())
            .collect();
        let bounds = modes.rim_bounds.iter().zip(&full);
        Self {
            works,
            own: works.times(radius),
            radius,
            responses: TABLE.on(column),
            rim_bounds: bounds.map(|(bound, full)| bound * full).collect(),
            full,
            modes,
            partial,
        }
    }

    fn count(&self) -> usize {
        self.full.len()
    }

    /// Degree of the pressure on tops in full contact.
    pub(crate) fn degree(&self) -> usize {
        degree_with(self.full.len())
    }

    pub(crate) fn works(&self) -> Works {
        self.works
    }

    /// Smallest and largest edge coefficient of a top in full contact with these coefficients of `q`.
    pub(crate) fn edge_range(&self, coefficients: &[f64]) -> [f64; 2] {
        let rows = self.modes.rim.chunks_exact(self.count());
        rows.map(|row| sum(row, coefficients))
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], q| {
                [least.min(q), most.max(q)]
            })
    }

    /// Contact area of a top.
    pub(crate) fn area(&self, domain: Domain) -> f64 {
        self.radius * self.radius * TABLE.area[domain.level]
    }

    /// Radius of the tops.
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    /// The front, of level 1 at least, whose contact area is closest to an area under a load.
    pub(crate) fn nearest(&self, area: f64, load: &[f64]) -> Domain {
        let area = area / (self.radius * self.radius);
        let off = |level: &usize| (TABLE.area[*level] - area).abs();
        let level = (1..LEVELS)
            .min_by(|a, b| off(a).total_cmp(&off(b)))
            .unwrap_or(1);
        let direction = direction(load);
        let (level, curvature) = self.best(level, &turned(load, direction));
        Domain {
            level,
            curvature,
            direction,
        }
    }

    /// Bonded fraction of the top at a level.
    pub(crate) fn part(level: usize) -> f64 {
        TABLE.area[level] / PI
    }

    /// Whether the centre of the top is in contact.
    pub(crate) fn bonds_centre(domain: Domain) -> bool {
        domain.is_full()
            || domain.is_partial() && TABLE.shapes[domain.level][domain.curvature][1] > 0.0
    }

    /// Bonded region of a top in contact.
    pub(crate) fn bonded_region(domain: Domain) -> BondedRegion {
        if domain.is_full() {
            return BondedRegion::All;
        }
        let [curvature, place] = TABLE.shapes[domain.level][domain.curvature];
        BondedRegion::Before(Front {
            curvature,
            place,
            direction: domain.direction,
            area: TABLE.area[domain.level],
        })
    }

    /// Distance of the farthest point in contact from a point, both relative to the centre of the top.
    pub(crate) fn farthest_from(&self, domain: Domain, [x, y]: [f64; 2]) -> f64 {
        if domain.is_full() {
            return self.radius + x.hypot(y);
        }
        let [x, y] = [x, y].map(|x| x / self.radius);
        // In the frame of the front.
        let (sin, cos) = domain.direction.sin_cos();
        let from = [cos * x + sin * y, cos * y - sin * x];
        let outline = &TABLE.outlines[domain.level][domain.curvature];
        let squares = outline
            .iter()
            .map(|at| (at[0] - from[0]).powi(2) + (at[1] - from[1]).powi(2));
        self.radius * squares.fold(0.0, f64::max).sqrt()
    }

    /// Moments `a P l` of the pressure under a load.
    pub(crate) fn respond(&self, domain: Domain, load: &[f64], coefficients: &mut [f64]) {
        if domain.is_out() {
            coefficients.fill(0.0);
        } else if domain.is_full() {
            for ((c, l), full) in coefficients.iter_mut().zip(load).zip(&self.full) {
                *c = self.radius * l * full;
            }
        } else {
            let local = turned(load, domain.direction);
            let answer = product(self.response(domain), &local);
            let back = turned(&answer, -domain.direction);
            coefficients.fill(0.0);
            for (c, back) in coefficients.iter_mut().zip(back) {
                *c = self.radius * back;
            }
        }
    }

    /// `a P_00`: mean response of a top to a mean load; zero out of contact.
    pub(crate) fn mean_compliance(&self, domain: Domain) -> f64 {
        let of_unit = if domain.is_out() {
            0.0
        } else if domain.is_full() {
            self.full[0]
        } else {
            self.response(domain)[0]
        };
        self.radius * of_unit
    }

    /// The load times `1/lambda`: coefficients of the edge of a top in full contact.
    fn in_full(&self, load: &[f64]) -> [f64; MOST_MODES] {
        let mut answer = [0.0; MOST_MODES];
        for ((c, l), full) in answer.iter_mut().zip(load).zip(&self.full) {
            *c = l * full;
        }
        answer
    }

    fn response(&self, domain: Domain) -> &Entries {
        &self.responses[domain.level][domain.curvature]
    }

    /// Whether the lens touches a top that is out of contact, under its load.
    fn is_touched(&self, load: &[f64]) -> bool {
        if self.highest_point(Line::at(load), 0.0) < 0.0 {
            return false;
        }
        let mut rows = self.modes.points.chunks_exact(self.count());
        rows.any(|row| sum(row, load) >= 0.0)
    }

    /// Upper bound of the load at all points of a top, at a position of a line.
    fn highest_point(&self, load: Line<'_>, t: f64) -> f64 {
        let loads = load
            .start
            .iter()
            .zip(load.along)
            .map(|(l, along)| l + t * along);
        let mut terms = loads.zip(&self.modes.bounds);
        let mean = terms.next().map_or(0.0, |(l, bound)| l * bound);
        mean + terms.map(|(l, bound)| l.abs() * bound).sum::<f64>()
    }

    /// Lower bound of the edge coefficient at all angles, for the load at a position of a line.
    fn lowest_edge(&self, load: Line<'_>, t: f64) -> f64 {
        let loads = load
            .start
            .iter()
            .zip(load.along)
            .map(|(l, along)| l + t * along);
        let mut terms = loads.zip(&self.rim_bounds);
        let mean = terms.next().map_or(0.0, |(l, bound)| l * bound);
        mean - terms.map(|(l, bound)| l.abs() * bound).sum::<f64>()
    }

    /// Whether the whole rim of a top in full contact stays attached.
    fn holds(&self, load: &[f64], work: f64) -> bool {
        let critical = critical_stress_intensity_factor(work);
        if self.lowest_edge(Line::at(load), 0.0) > -critical {
            return true;
        }
        let edge = self.in_full(load);
        let mut rows = self.modes.rim.chunks_exact(self.count());
        rows.all(|row| sum(row, &edge) >= -critical)
    }

    /// State of a top under its load with all others linearized: the front moves until it neither advances nor recedes.
    pub(crate) fn march(&self, domain: Domain, load: &[f64]) -> Domain {
        if !self.partial {
            return self.march_whole(domain, load);
        }
        if domain.is_out() && !self.is_touched(load) {
            return domain;
        }
        let mut present = if domain.is_partial() {
            domain
        } else {
            Domain {
                direction: direction(load),
                ..domain
            }
        };
        let local = turned(load, present.direction);
        let grown = |present: &mut Domain| {
            if present.level == LEVELS - 1 {
                let holds = self.holds(load, self.own.advancing);
                if holds {
                    *present = Domain::FULL;
                }
                return holds;
            }
            let next = self.best(present.level + 1, &local);
            let advances = self.release(*present, next, &local) < self.own.advancing;
            if advances {
                (present.level, present.curvature) = next;
            }
            advances
        };
        let before = present.level;
        while !present.is_full() && grown(&mut present) {}
        if present.level > before {
            return present;
        }
        let shrunk = |present: &mut Domain| {
            if present.is_full() {
                let lets_go = !self.holds(load, self.own.receding);
                if lets_go {
                    (present.level, present.curvature) = self.best(LEVELS - 1, &local);
                }
                return lets_go;
            }
            let last = self.best(present.level - 1, &local);
            let smaller = Domain {
                level: last.0,
                curvature: last.1,
                ..*present
            };
            let energy = (present.level, present.curvature);
            let recedes = self.release(smaller, energy, &local) > self.own.receding;
            if recedes {
                *present = smaller;
            }
            recedes
        };
        while !present.is_out() && shrunk(&mut present) {}
        if present.is_out() {
            Domain::OUT
        } else if present.level == before {
            domain
        } else {
            present
        }
    }

    /// The same if tops are out of contact or in full contact.
    fn march_whole(&self, domain: Domain, load: &[f64]) -> Domain {
        if domain.is_out() && self.is_touched(load) && self.holds(load, self.own.advancing) {
            Domain::FULL
        } else if domain.is_full() && !self.holds(load, self.own.receding) {
            Domain::OUT
        } else {
            domain
        }
    }

    /// The updated front of a partial contact, if it differs: its direction follows the load, and its curvature minimises the energy.
    pub(crate) fn adjusted(&self, domain: Domain, load: &[f64]) -> Option<Domain> {
        if !domain.is_partial() {
            return None;
        }
        let target = direction(load);
        let turn = (target - domain.direction + PI).rem_euclid(TAU) - PI;
        let direction = if turn.abs() > DIRECTION_TOLERANCE {
            target
        } else {
            domain.direction
        };
        let (level, curvature) = self.best(domain.level, &turned(load, direction));
        let adjusted = Domain {
            level,
            curvature,
            direction,
        };
        (adjusted != domain).then_some(adjusted)
    }

    /// The front at a level whose contact has the least elastic energy.
    fn best(&self, level: usize, local: &[f64; MODES]) -> (usize, usize) {
        let energy = |curvature: &usize| elastic(&self.responses[level][*curvature], local);
        let curvature = (0..CURVATURES)
            .min_by(|a, b| energy(a).total_cmp(&energy(b)))
            .unwrap_or(0);
        (level, curvature)
    }

    /// Energy release rate from one front to the next, with its sign: negative if the strip in between would be under compression.
    fn release(&self, domain: Domain, next: (usize, usize), local: &[f64; MODES]) -> f64 {
        let (level, curvature) = next;
        let change = difference(&self.responses[level][curvature], self.response(domain));
        let area = TABLE.area[level] - TABLE.area[domain.level];
        let released = elastic(&change, local) / area;
        if product(&change, local)[0] > 0.0 {
            -released.abs()
        } else {
            released
        }
    }

    /// Position along the line of loads at which the top first changes in the direction of the course; `None` if it does not, or if that is
    /// certainly beyond `within`.
    pub(crate) fn next_event(
        &self,
        domain: Domain,
        load: Line<'_>,
        course: Course,
        within: f64,
    ) -> Option<f64> {
        let ends = [0.0, within];
        let stays = match course {
            Course::Loading if domain.is_out() => ends
                .map(|t| self.highest_point(load, t))
                .into_iter()
                .all(|l| l < 0.0),
            Course::Unloading if domain.is_full() => {
                let smallest = -critical_stress_intensity_factor(self.own.receding);
                ends.map(|t| self.lowest_edge(load, t))
                    .into_iter()
                    .all(|q| q > smallest)
            }
            _ => false,
        };
        if stays {
            return None;
        }
        let event = match course {
            Course::Loading => self.next_gain(domain, load),
            Course::Unloading => self.next_loss(domain, load),
        };
        event.map(|distance| distance.max(0.0))
    }

    fn next_gain(&self, domain: Domain, load: Line<'_>) -> Option<f64> {
        if domain.is_full() {
            return None;
        }
        let touched = if domain.is_out() {
            self.touching(load)?
        } else {
            0.0
        };
        if !self.partial {
            let holding = self.holding(load, self.own.advancing)?;
            return Some(touched.max(holding));
        }
        if domain.level == LEVELS - 1 {
            return self.holding(load, self.own.advancing);
        }
        // The direction is that at the position where the top is first touched.
        let frame = if domain.is_out() {
            let at = |(start, along): (&f64, &f64)| start + touched * along;
            let there: Vec<f64> = load.start.iter().zip(load.along).map(at).collect();
            direction(&there)
        } else {
            domain.direction
        };
        let line = [load.start, load.along].map(|part| turned(part, frame));
        let area = TABLE.area[domain.level + 1] - TABLE.area[domain.level];
        let work = self.own.advancing;
        let event = (0..CURVATURES).filter_map(|curvature| {
            let next = &self.responses[domain.level + 1][curvature];
            let change = difference(next, self.response(domain));
            let [energy, pressed] = polynomials(&change, &line, area);
            let advances = |t: f64| at(&pressed, t) > 0.0 || at(&energy, t) < work;
            first_time(touched, &[shifted(energy, work), pressed], advances)
        });
        event.min_by(f64::total_cmp)
    }

    fn next_loss(&self, domain: Domain, load: Line<'_>) -> Option<f64> {
        if domain.is_out() {
            return None;
        }
        if domain.is_full() {
            return self.releasing(load, self.own.receding);
        }
        let line = [load.start, load.along].map(|part| turned(part, domain.direction));
        let area = TABLE.area[domain.level] - TABLE.area[domain.level - 1];
        let work = self.own.receding;
        let event = (0..CURVATURES).filter_map(|curvature| {
            let last = &self.responses[domain.level - 1][curvature];
            let change = difference(self.response(domain), last);
            let [energy, pressed] = polynomials(&change, &line, area);
            let recedes = |t: f64| at(&pressed, t) <= 0.0 && at(&energy, t) > work;
            first_time(0.0, &[shifted(energy, work), pressed], recedes)
        });
        event.min_by(f64::total_cmp)
    }

    /// Position along the line at which the top is first touched.
    fn touching(&self, load: Line<'_>) -> Option<f64> {
        let rows = self.modes.points.chunks_exact(self.count());
        let times = rows.filter_map(|row| {
            let (start, along) = (sum(row, load.start), sum(row, load.along));
            if start >= 0.0 {
                Some(0.0)
            } else {
                (along > 0.0).then(|| -start / along)
            }
        });
        times.min_by(f64::total_cmp)
    }

    /// Position along the line at which the first point of the rim exceeds the critical tension.
    fn releasing(&self, load: Line<'_>, work: f64) -> Option<f64> {
        let critical = critical_stress_intensity_factor(work);
        let [start, along] = [load.start, load.along].map(|part| self.in_full(part));
        let rows = self.modes.rim.chunks_exact(self.count());
        let times = rows.filter_map(|row| {
            let (start, along) = (sum(row, &start) + critical, sum(row, &along));
            if start < 0.0 {
                Some(0.0)
            } else {
                (along < 0.0).then(|| -start / along)
            }
        });
        times.min_by(f64::total_cmp)
    }

    /// Position along the line from which the whole rim would stay attached.
    fn holding(&self, load: Line<'_>, work: f64) -> Option<f64> {
        let critical = critical_stress_intensity_factor(work);
        let [start, along] = [load.start, load.along].map(|part| self.in_full(part));
        let mut last = 0.0_f64;
        for row in self.modes.rim.chunks_exact(self.count()) {
            let (start, along) = (sum(row, &start) + critical, sum(row, &along));
            if start >= 0.0 {
                continue;
            }
            if along <= 0.0 {
                return None;
            }
            last = last.max(-start / along);
        }
        Some(last)
    }
}

/// Points around the part of the disc that is behind the front `x < s - b y^2`.
fn outline([curvature, place]: [f64; 2]) -> Vec<[f64; 2]> {
    (0..OUTLINE_ANGLES)
        .map(|number| {
            let (y, x) = (TAU * number as f64 / OUTLINE_ANGLES as f64).sin_cos();
            // The rim, or the front where that is closer.
            [x.min(place - curvature * y * y), y]
        })
        .filter(|[x, y]| x * x + y * y <= 1.0 + 1e-9)
        .collect()
}

/// Direction in which a load decreases: opposite to its gradient at the centre.
fn direction(load: &[f64]) -> f64 {
    (-load[2]).atan2(-load[1])
}

/// The leading modes of a load in a frame rotated by an angle.
fn turned(load: &[f64], angle: f64) -> [f64; MODES] {
    let (sin, cos) = angle.sin_cos();
    let (double_sin, double_cos) = (2.0 * sin * cos, cos * cos - sin * sin);
    [
        load[0],
        cos * load[1] + sin * load[2],
        cos * load[2] - sin * load[1],
        load[3],
        double_cos * load[4] + double_sin * load[5],
        double_cos * load[5] - double_sin * load[4],
    ]
}

fn sum(row: &[f64], load: &[f64]) -> f64 {
    row.iter().zip(load).map(|(value, l)| value * l).sum()
}

/// `P l`
fn product(entries: &Entries, load: &[f64; MODES]) -> [f64; MODES] {
    let mut answer = [0.0; MODES];
    for (entry, (i, j)) in entries.iter().zip(ENTRIES) {
        answer[i] += entry * load[j];
        if i != j {
            answer[j] += entry * load[i];
        }
    }
    answer
}

/// `a'P b`
fn bilinear(entries: &Entries, a: &[f64; MODES], b: &[f64; MODES]) -> f64 {
    let answer = product(entries, b);
    a.iter().zip(&answer).map(|(a, c)| a * c).sum()
}

/// `l'P l/2`
fn elastic(entries: &Entries, load: &[f64; MODES]) -> f64 {
    0.5 * bilinear(entries, load, load)
}

fn difference(a: &Entries, b: &Entries) -> Entries {
    std::array::from_fn(|k| a[k] - b[k])
}

/// A polynomial `p0 + p1 t + p2 t^2`.
type Quadratic = [f64; 3];

fn at(polynomial: &Quadratic, t: f64) -> f64 {
    polynomial[0] + t * (polynomial[1] + t * polynomial[2])
}

fn shifted(polynomial: Quadratic, by: f64) -> Quadratic {
    [polynomial[0] - by, polynomial[1], polynomial[2]]
}

/// Energy release rate, and the force on the strip, along a line of loads.
fn polynomials(change: &Entries, line: &[[f64; MODES]; 2], area: f64) -> [Quadratic; 2] {
    let [start, along] = line;
    let energy = [
        elastic(change, start) / area,
        bilinear(change, start, along) / area,
        elastic(change, along) / area,
    ];
    let pressed = [product(change, start)[0], product(change, along)[0], 0.0];
    [energy, pressed]
}

/// First time from `start` at which a condition is satisfied that can change only at the zeros of the polynomials.
fn first_time(
    start: f64,
    polynomials: &[Quadratic; 2],
    holds: impl Fn(f64) -> bool,
) -> Option<f64> {
    if holds(start) {
        return Some(start);
    }
    let mut times: Vec<f64> = polynomials
        .iter()
        .flat_map(roots)
        .filter(|time| *time > start && time.is_finite())
        .collect();
    times.sort_by(f64::total_cmp);
    let ends = times.iter().skip(1).copied();
    let between = times.iter().zip(ends.chain([f64::INFINITY]));
    between
        .map(|(begin, end)| {
            let inside = if end.is_finite() {
                0.5 * (begin + end)
            } else {
                begin + (begin - start).max(f64::MIN_POSITIVE)
            };
            (*begin, inside)
        })
        .find(|(_, inside)| holds(*inside))
        .map(|(begin, _)| begin)
}

/// The real roots of a polynomial, infinite or NaN if there is none.
fn roots(&[constant, linear, square]: &Quadratic) -> [f64; 2] {
    if square == 0.0 {
        return [-constant / linear, f64::NAN];
    }
    let discriminant = linear * linear - 4.0 * square * constant;
    let half = -0.5 * (linear + linear.signum() * discriminant.sqrt());
    [half / square, constant / half]
}

/// Content of `front_table.csv`, by level and curvature.
struct Table {
    /// Area of the levels on a top of unit radius.
    area: [f64; LEVELS + 1],
    /// `b` and `s` of every front.
    shapes: Vec<[[f64; 2]; CURVATURES]>,
    /// Points around the bonded region, in the frame of the front.
    outlines: Vec<[Vec<[f64; 2]>; CURVATURES]>,
    /// `P` of a top on a half-space.
    responses: Vec<[Entries; CURVATURES]>,
}

static TABLE: LazyLock<Table> = LazyLock::new(Table::read);

impl Table {
    fn read() -> Self {
        let mut area = [0.0; LEVELS + 1];
        let mut shapes = vec![[[0.0; 2]; CURVATURES]; LEVELS];
        let mut responses = vec![[[0.0; ENTRIES.len()]; CURVATURES]; LEVELS];
        area[LEVELS] = PI;
        for (number, line) in FILE.lines().skip(1).enumerate() {
            let (level, curvature) = (1 + number / CURVATURES, number % CURVATURES);
            let mut numbers = line
                .split(',')
                .map(|cell| cell.parse().unwrap_or(f64::NAN))
                .skip(1);
            let mut next = || numbers.next().unwrap_or(f64::NAN);
            area[level] = PI * next();
            shapes[level][curvature] = [next(), next()];
            responses[level][curvature].fill_with(next);
        }
        let outlines = shapes.iter().map(|of_level| of_level.map(outline));
        Self {
            area,
            outlines: outlines.collect(),
            shapes,
            responses,
        }
    }

    /// The responses including columns as springs in series: `K` for the mean and for both tilts, `pi kappa` and `pi/2` times the rocking.
    /// `P` becomes `P - P E (1 + K E'P E)^-1 K E'P` with `E` these modes.
    fn on(&self, column: Column) -> Vec<[Entries; CURVATURES]> {
        let springs = [PI * column.shortening, TILT_COMPLIANCE * column.rocking];
        let unit = |mode: usize| std::array::from_fn(|k| f64::from(u8::from(k == mode)));
        let units: [[f64; MODES]; 3] = [0, 1, 2].map(unit);
        let softened = |entries: &Entries| {
            let [mean, tilt, across] = units.map(|unit| product(entries, &unit));
            // The tilt across the front is odd and decouples from the other two.
            let softening = softening(springs, [mean[0], mean[1], tilt[1]]);
            let of_across = springs[1] / (1.0 + springs[1] * across[2]);
            let mut entries = *entries;
            for (entry, (i, j)) in entries.iter_mut().zip(ENTRIES) {
                let of_mean = softening[0] * mean[j] + softening[1] * tilt[j];
                let of_tilt = softening[1] * mean[j] + softening[2] * tilt[j];
                *entry -= mean[i] * of_mean + tilt[i] * of_tilt + of_across * across[i] * across[j];
            }
            entries
        };
        let of_level = |level: &[Entries; CURVATURES]| level.each_ref().map(softened);
        self.responses.iter().map(of_level).collect()
    }
}

/// `(1 + K G)^-1 K` of two springs and a symmetric matrix, each as the entries 00, 01 and 11.
fn softening([k, l]: [f64; 2], [a, b, c]: [f64; 3]) -> [f64; 3] {
    let determinant = (1.0 + k * a) * (1.0 + l * c) - k * l * b * b;
    [
        k * (1.0 + l * c) / determinant,
        -k * l * b / determinant,
        l * (1.0 + k * a) / determinant,
    ]
}

/// Created by the example `front_table`, which documents the method.
const FILE: &str = include_str!("front_table.csv");

#[cfg(test)]
mod tests {
    use super::*;

    /// Results of an independent program on 256 elements across the disc, not extrapolated: accurate to 0.5 % of a response of up to one,
    /// because narrow strips are only 16 elements wide.
    const INDEPENDENT: &str = include_str!("../../../tests/reference/front_table.csv");

    /// Springs in series with a top reduce its load, `c = P (l - K c)`, in every direction of the front.
    #[test]
    fn columns_are_springs_in_series() {
        let column = Column {
            shortening: 0.7,
            rocking: 1.3,
        };
        let works = Works {
            advancing: 0.0,
            receding: 0.0,
        };
        let [stiff, soft] = [Column::default(), column].map(|it| Fronts::new(2, it, works, true));
        let load = [1.0, 0.3, -0.8, 0.2, 0.5, -0.1];
        for domain in [
            stiff.nearest(1.0, &load),
            stiff.nearest(2.5, &load),
            Domain::FULL,
        ] {
            let mut found = [0.0; MODES];
            soft.respond(domain, &load, &mut found);
            let mut left = load;
            left[0] -= PI * column.shortening * found[0];
            left[1] -= TILT_COMPLIANCE * column.rocking * found[1];
            left[2] -= TILT_COMPLIANCE * column.rocking * found[2];
            let mut expected = [0.0; MODES];
            stiff.respond(domain, &left, &mut expected);
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-12, "{found} {expected}");
            }
        }
    }

    #[test]
    fn fronts_answer_as_in_an_independent_table() {
        let numbers = |line: &str| -> Vec<f64> {
            line.split(',').map(|cell| cell.parse().unwrap()).collect()
        };
        let expected: Vec<Vec<f64>> = INDEPENDENT.lines().skip(1).map(numbers).collect();
        let mut rows = 0;
        for line in FILE.lines().skip(1) {
            let row = numbers(line);
            let front = |row: &[f64]| [row[0], row[2]].map(f64::to_bits);
            let same = |other: &&Vec<f64>| front(other) == front(&row);
            let expected = expected.iter().find(same).unwrap();
            for (number, (a, b)) in row.iter().zip(expected).enumerate() {
                let tolerance = if number < 4 { 2e-5 } else { 5e-3 };
                assert!((a - b).abs() < tolerance, "{row:?} {expected:?}");
            }
            rows += 1;
        }
        assert_eq!(rows, (LEVELS - 1) * CURVATURES);
    }
}
