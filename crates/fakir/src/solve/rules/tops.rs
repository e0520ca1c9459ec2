//! Pillar tops without adhesion, for all sites: the first rule of the [linearized contact](super::super::linearized).
//!
//! The state of a top is untouched, fully touched, or partially touched; in the last case it includes which of its nodes or cells carry
//! pressure. At fixed states the top responds linearly to its load. [`update`](Tops::update) solves every top under its current load and
//! adopts its new state.

use super::rim::{Motion, Rim, mirrored};
use super::unilateral::{LocalSolver, PillarTop};
use crate::halfspace::coupling::copies::Copies;
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::disc::basis::{UNIT_FORCE, UnloadingPoint, degree_with, mode_count, modes};
use crate::halfspace::disc::projection::LensProjector;
use crate::numerics::convergence::{larger, within};
use crate::numerics::vector::{dot, subtract};
use crate::numerics::workers::Workers;
use crate::problem::{Point, ShapedLens};
use crate::solve::linearized::Rule;
use crate::state::PillarStatus;
use std::borrow::Cow;
use std::sync::Arc;

/// Smallest number of pillars per thread for cheap operations.
const PILLARS: usize = 4000;

/// The same for expensive operations.
pub(crate) const COSTLY_PILLARS: usize = 200;

/// A partially touched pillar.
#[derive(Debug, Clone)]
struct Partial {
    pillar: usize,
    /// Nodes without pressure, or cells with pressure.
    active: Vec<bool>,
    /// `P`, row by row.
    derivative: Vec<f64>,
    /// `cb`: the leading coefficients at zero leading load.
    constant: Vec<f64>,
    converged: bool,
}

impl Partial {
    /// Placeholder after cancellation.
    fn unsolved(pillar: usize, modes: usize) -> Self {
        Self {
            pillar,
            active: Vec::new(),
            derivative: vec![0.0; modes * modes],
            constant: vec![0.0; modes],
            converged: false,
        }
    }
}

/// State of a solved pillar, its leading moments, and whether its active nodes or cells changed.
type Solved = (Partial, Vec<f64>, bool);

/// Largest effect of a difference of the loads of symmetric copies on the moments of a pillar with a narrow contact at the rim, relative to
/// the largest one.
const ALIKE: f64 = 1e-10;

/// Images of pillars under symmetries.
struct Images {
    /// Of every pillar: a representative, and the number of a symmetry that maps it to this pillar.
    sources: Vec<(usize, usize)>,
    /// Transformation of the leading moments, and whether it is a reflection.
    symmetries: Vec<(UnloadingPoint, bool)>,
}

impl Images {
    fn new(copies: &Copies, degree: usize) -> Self {
        let reflected = copies
            .symmetries()
            .iter()
            .map(|symmetry| symmetry.reflected);
        Self {
            sources: copies.sources(),
            symmetries: copies
                .turns(&modes(degree))
                .into_iter()
                .zip(reflected)
                .collect(),
        }
    }

    /// Whether a pillar is a representative.
    fn is_own(&self, pillar: usize) -> bool {
        self.sources[pillar].0 == pillar
    }
}

/// The incident load on a pillar in the leading modes, written to the slice.
pub(crate) type Incident<'l> = dyn Fn(usize, &mut [f64]) + Sync + 'l;

/// The pillar tops of all sites and their states.
///
/// A top of radius `a` responds like one of radius 1, with moments larger by a factor of `a`.
pub(crate) struct Tops {
    lens: ShapedLens,
    pub(crate) sites: Sites,
    /// Top of unit radius on the common column.
    pub(crate) top: Arc<PillarTop>,
    projector: LensProjector,
    /// Moments of a fully touched top of the common body under unit loads in the leading modes.
    answers_in_full: Vec<f64>,
    /// Number of leading modes per pillar, and their degree.
    modes: usize,
    degree: usize,
    pub(crate) status: Vec<PillarStatus>,
    partial: Vec<Partial>,
    /// Index into `partial` for every partially touched pillar.
    partial_of: Vec<u32>,
}

/// Result of an update.
pub(crate) struct Change {
    /// Number of pillars and of floor cells whose state changed.
    pub(crate) pillars: usize,
    pub(crate) cells: usize,
    /// Largest difference between the coefficients of the tops' own solutions and those of the linearized contact, relative to the largest
    /// coefficient.
    pub(crate) mismatch: f64,
    /// Number of pillars without a solution.
    pub(crate) failures: usize,
}

impl Change {
    /// Number of places whose state changed.
    pub(crate) fn places(&self) -> usize {
        self.pillars + self.cells
    }
}

/// `b`: the lens shape over a pillar top and the height of the top, in as many modes as `load` contains.
pub(crate) fn lens_over(
    lens: &ShapedLens,
    projector: &LensProjector,
    sites: &Sites,
    pillar: usize,
    load: &mut [f64],
) {
    let body = sites.body(pillar);
    projector.project(lens, sites.centres()[pillar], body.radius, load);
    load[0] += UNIT_FORCE * body.raised;
}

const NOT_PARTIAL: u32 = u32::MAX;

impl Tops {
    /// All pillars untouched; they interact through the modes up to a degree.
    pub(crate) fn new(lens: &ShapedLens, sites: Sites, top: Arc<PillarTop>, degree: usize) -> Self {
        let common = sites.common_body();
        let ratios = top.ratios(common.column);
        let ratios = ratios.into_iter().chain(std::iter::repeat(1.0));
        let answers = top.lead_compliance().iter().zip(ratios);
        Self {
            answers_in_full: answers
                .map(|(lambda, ratio)| ratio * common.radius / lambda)
                .collect(),
            lens: lens.clone(),
            projector: LensProjector::new(lens, degree),
            modes: mode_count(degree),
            degree,
            status: vec![PillarStatus::Untouched; sites.len()],
            partial: Vec::new(),
            partial_of: vec![NOT_PARTIAL; sites.len()],
            top,
            sites,
        }
    }

    /// The top of a pillar, on its own column.
    pub(crate) fn top_of(&self, pillar: usize) -> Cow<'_, PillarTop> {
        self.top.on_column(self.sites.body(pillar).column)
    }

    /// The lens shape and the height of a pillar, in as many modes as `load` contains.
    fn project(&self, pillar: usize, load: &mut [f64]) {
        lens_over(&self.lens, &self.projector, &self.sites, pillar, load);
    }

    /// Converts the load on a fully touched pillar to its moments.
    fn respond_in_full(&self, pillar: usize, load: &mut [f64]) {
        if self.sites.are_alike() {
            for (value, answer) in load.iter_mut().zip(&self.answers_in_full) {
                *value *= answer;
            }
            return;
        }
        let body = self.sites.body(pillar);
        for (value, lambda) in load.iter_mut().zip(self.top.lead_compliance()) {
            *value = body.radius * *value / lambda;
        }
        let ratios = self.top.ratios(body.column);
        for (value, ratio) in load.iter_mut().zip(ratios) {
            *value *= ratio;
        }
    }

    /// `bs`: the lens shape over every pillar top, in the leading modes; computed once for symmetric images.
    pub(crate) fn lens_load(&self, copies: Option<&Copies>, workers: Workers<'_>) -> Vec<f64> {
        let own = copies.map(Copies::own);
        let count = own.map_or(self.sites.len(), <[u32]>::len);
        let mut load = vec![0.0; count * self.modes];
        let project = |(): &mut (), number: usize, load: &mut [f64]| {
            self.project(own.map_or(number, |own| own[number] as usize), load);
        };
        workers.fill(&mut load, self.modes, COSTLY_PILLARS, || (), project);
        match copies {
            Some(copies) => copies.spread(&modes(self.degree), &load),
            None => load,
        }
    }

    /// Number of leading modes per pillar.
    pub(crate) fn modes(&self) -> usize {
        self.modes
    }

    /// Number of touched pillars.
    pub(crate) fn touched(&self) -> usize {
        self.status
            .iter()
            .filter(|status| **status != PillarStatus::Untouched)
            .count()
    }

    /// Distance from the lens axis of the farthest touched pillar centre.
    pub(crate) fn reach(&self) -> f64 {
        self.sites
            .centres()
            .iter()
            .zip(&self.status)
            .filter(|(_, status)| **status != PillarStatus::Untouched)
            .map(|([x, y], _)| x.hypot(*y))
            .fold(0.0, f64::max)
    }

    /// Distance of the farthest touched pillar centre from the lowest point of the lens.
    pub(crate) fn reach_from_lowest(&self) -> f64 {
        self.sites
            .centres()
            .iter()
            .zip(&self.status)
            .filter(|(_, status)| **status != PillarStatus::Untouched)
            .map(|(centre, _)| self.lens.distance(*centre))
            .fold(0.0, f64::max)
    }

    /// Marks the pillars as touched whose centre the undeformed lens penetrates at an indentation, or at least the first one.
    pub(crate) fn touch_entered(&mut self, indentation: f64) {
        let mut first = (f64::INFINITY, 0);
        for (pillar, centre) in self.sites.centres().iter().enumerate() {
            let touched_at = self.lens.sag_with_brim(*centre) - self.sites.body(pillar).raised;
            if touched_at < first.0 {
                first = (touched_at, pillar);
            }
            if touched_at < indentation {
                self.status[pillar] = PillarStatus::Full;
            }
        }
        if let Some(status) = self.status.get_mut(first.1) {
            *status = PillarStatus::Full;
        }
    }

    /// Marks the pillars within a radius of the lens axis as touched, or at least the nearest one.
    pub(crate) fn touch_within(&mut self, radius: f64) {
        let mut nearest = (f64::INFINITY, 0);
        for (pillar, [x, y]) in self.sites.centres().iter().enumerate() {
            let distance = x.hypot(*y);
            if distance < nearest.0 {
                nearest = (distance, pillar);
            }
            if distance < radius {
                self.status[pillar] = PillarStatus::Full;
            }
        }
        self.status[nearest.1] = PillarStatus::Full;
    }

    /// Takes statuses from a coarser solution; partially touched pillars count as fully touched at first.
    pub(crate) fn start_from(&mut self, coarse: &Self) {
        for pillar in 0..self.sites.len() {
            if let Some(from) = coarse.sites.find(self.sites.index(pillar)) {
                self.status[pillar] = match coarse.status[from] {
                    PillarStatus::Partial => PillarStatus::Full,
                    status => status,
                };
            }
        }
    }

    /// Degree of the load of the lens shape.
    pub(crate) fn load_degree(&self) -> usize {
        degree_with(self.projector.count())
    }

    /// Load on a pillar with all modes of the lens shape over its top.
    pub(crate) fn full_load(&self, incident: &Incident<'_>, pillar: usize) -> Vec<f64> {
        let count = self.projector.count().min(self.top.count());
        let mut load = vec![0.0; count];
        self.project(pillar, &mut load);
        incident(pillar, &mut load[..self.modes]);
        load
    }

    /// For every partially touched pillar, its nodes without pressure, or its cells with pressure.
    #[cfg(test)]
    pub(crate) fn partial_states(&self) -> Vec<(usize, Vec<bool>)> {
        let of = |partial: &Partial| (partial.pillar, partial.active.clone());
        self.partial.iter().map(of).collect()
    }

    /// All moments of a partially touched pillar under a load, starting from its state.
    pub(crate) fn partial_coefficients(
        &self,
        pillar: usize,
        load: &[f64],
        solver: &mut LocalSolver,
    ) -> Vec<f64> {
        self.fixed_responses(pillar, load, &[], solver).0
    }

    /// The same, and the changes of all moments due to changes of the leading load with the state of the pillar held fixed.
    pub(crate) fn fixed_responses(
        &self,
        pillar: usize,
        load: &[f64],
        changes: &[&[f64]],
        solver: &mut LocalSolver,
    ) -> (Vec<f64>, Vec<Vec<f64>>) {
        let (top, active) = self.solve_again(pillar, load, solver);
        let radius = self.sites.body(pillar).radius;
        let mut coefficients = vec![0.0; top.count()];
        solver.coefficients(&top, load, &mut coefficients);
        scale(&mut coefficients, radius);
        let mut respond = |change: &&[f64]| {
            let mut response = vec![0.0; top.count()];
            solver.respond_fixed(&top, change, &active, &mut response);
            scale(&mut response, radius);
            response
        };
        (coefficients, changes.iter().map(&mut respond).collect())
    }

    /// The top of a partially touched pillar with its state, solved under a load starting from that state.
    fn solve_again(
        &self,
        pillar: usize,
        load: &[f64],
        solver: &mut LocalSolver,
    ) -> (Cow<'_, PillarTop>, Vec<bool>) {
        let top = self.top_of(pillar);
        let partial = self.partial.get(self.partial_of[pillar] as usize);
        let mut active = partial.map_or_else(Vec::new, |partial| partial.active.clone());
        solver.solve(&top, load, &mut active);
        (top, active)
    }

    /// Pillars with a narrow contact at their rim.
    pub(crate) fn rim_contacts(&self) -> impl Iterator<Item = usize> {
        let on_cells = |partial: &&Partial| partial.active.len() != self.top.count();
        self.partial
            .iter()
            .filter(on_cells)
            .map(|partial| partial.pillar)
    }

    /// Change of the moments of a pillar with a narrow contact at the rim as that contact moves with its load; `None` if it has only just
    /// formed.
    pub(crate) fn rim_contact_motions(
        &self,
        pillar: usize,
        load: &[f64],
        solver: &mut LocalSolver,
    ) -> Option<Vec<Motion>> {
        let (_, active) = self.solve_again(pillar, load, solver);
        let mut motions = solver.motions(load, &active)?;
        for motion in &mut motions {
            scale(&mut motion.coefficients, self.sites.body(pillar).radius);
        }
        Some(motions)
    }

    /// `∫ Y_i g dOmega` over the top of a pillar, in as many modes as `load` contains, for a function of the position relative to the lens
    /// axis and on the unit disc.
    pub(crate) fn project_function(
        &self,
        pillar: usize,
        function: impl Fn(Point, Point) -> f64,
        load: &mut [f64],
    ) {
        let (centre, radius) = (self.sites.centres()[pillar], self.sites.body(pillar).radius);
        self.projector
            .project_function(centre, radius, function, load);
    }

    /// Coefficients of the gap over a pillar top, `Lam m/a - b` with its moments `m`.
    pub(crate) fn gap_coefficients(
        &self,
        incident: &Incident<'_>,
        pillar: usize,
        coefficients: &[f64],
    ) -> Vec<f64> {
        let load = self.full_load(incident, pillar);
        let radius = self.sites.body(pillar).radius;
        let mut gap: Vec<f64> = coefficients
            .iter()
            .zip(self.top_of(pillar).compliance())
            .map(|(c, lambda)| c * lambda / radius)
            .collect();
        subtract(&mut gap, &load);
        gap
    }

    /// Solves every pillar under its incident load and adopts its state. `coefficients` are those of the linearized contact. Pillars
    /// farther from the lens axis than `farthest`, if given, stay untouched regardless of their load. Of symmetric copies with a narrow
    /// contact at the rim, one is solved.
    pub(crate) fn update(
        &mut self,
        incident: &Incident<'_>,
        coefficients: &[f64],
        farthest: Option<f64>,
        copies: Option<&Copies>,
        workers: Workers<'_>,
    ) -> Change {
        let statuses = self.statuses(incident, farthest, workers);
        let before = std::mem::replace(&mut self.status, statuses);
        let partial: Vec<usize> = (0..self.sites.len())
            .filter(|&p| self.status[p] == PillarStatus::Partial)
            .collect();
        let guess = |pillar: usize| -> Option<&Partial> {
            self.partial.get(self.partial_of[pillar] as usize)
        };
        let solver = || LocalSolver::new(&self.top);
        let solve = |solver: &mut LocalSolver, pillar: usize| {
            if workers.cancel.is_cancelled() {
                return (
                    Partial::unsolved(pillar, self.modes),
                    vec![0.0; self.modes],
                    true,
                );
            }
            self.solve_partial(incident, solver, pillar, guess(pillar))
        };
        let images = copies.filter(|_| self.top.resolution().rings > 0);
        let images = images.map(|copies| Images::new(copies, self.degree));
        let is_own = |pillar: &usize| images.as_ref().is_none_or(|images| images.is_own(*pillar));
        let (own, others): (Vec<usize>, Vec<usize>) = partial.iter().partition(|p| is_own(p));
        let mut solved = workers.map(own.len(), 1, solver, |solver, number| {
            solve(solver, own[number])
        });
        if let Some(images) = &images {
            let of_others = workers.map(others.len(), 1, solver, |solver, number| {
                let pillar = others[number];
                let image = self.image(incident, images, &solved, pillar);
                image.map_or_else(
                    || solve(solver, pillar),
                    |(partial, coefficients)| {
                        let guess = guess(pillar);
                        let moved = guess.is_none_or(|guess| guess.active != partial.active);
                        (partial, coefficients, moved)
                    },
                )
            });
            solved.extend(of_others);
            solved.sort_by_key(|(partial, ..)| partial.pillar);
        }
        let changed = before
            .iter()
            .zip(&self.status)
            .filter(|(before, after)| before != after)
            .count();
        let moved = solved.iter().filter(|(_, _, moved)| *moved).count();
        let mismatch = self.mismatch(incident, coefficients, &solved, workers);
        self.partial_of.fill(NOT_PARTIAL);
        self.partial = solved.into_iter().map(|(partial, _, _)| partial).collect();
        for (index, partial) in self.partial.iter().enumerate() {
            self.partial_of[partial.pillar] = index as u32;
        }
        Change {
            pillars: changed + moved,
            cells: 0,
            mismatch,
            failures: self.partial.iter().filter(|p| !p.converged).count(),
        }
    }

    fn statuses(
        &self,
        incident: &Incident<'_>,
        farthest: Option<f64>,
        workers: Workers<'_>,
    ) -> Vec<PillarStatus> {
        let work = || (vec![0.0; self.modes], Rim::new(self.degree));
        let count = self.sites.len();
        workers.map(count, PILLARS, work, |(load, rim), pillar| {
            let [x, y] = self.sites.centres()[pillar];
            if farthest.is_some_and(|farthest| x.hypot(y) > farthest) {
                return PillarStatus::Untouched;
            }
            incident(pillar, load);
            self.status_under(pillar, load, rim)
        })
    }

    fn status_under(&self, pillar: usize, load: &[f64], rim: &mut Rim) -> PillarStatus {
        let column = self.sites.body(pillar).column;
        self.top
            .plain_status(load, column)
            .unwrap_or_else(|| self.top_of(pillar).status(load, rim))
    }

    /// Whether the touched status of a pillar depends on the part of the lens shape that the modes of the coupling omit.
    pub(crate) fn has_marginal_pillars(
        &self,
        incident: &Incident<'_>,
        workers: Workers<'_>,
    ) -> bool {
        if self.degree >= self.load_degree() {
            return false;
        }
        let work = || Rim::new(self.load_degree());
        let count = self.sites.len();
        let marginal = workers.map(count, COSTLY_PILLARS, work, |rim, pillar| {
            let in_full = self.status_under(pillar, &self.full_load(incident, pillar), rim);
            let untouched = PillarStatus::Untouched;
            (in_full == untouched) != (self.status[pillar] == untouched)
        });
        marginal.contains(&true)
    }

    /// The state and the leading moments of a pillar as the image of another one with a narrow contact at the rim; `None` if that is not
    /// solved or has none, or if the loads of both are not symmetric.
    fn image(
        &self,
        incident: &Incident<'_>,
        images: &Images,
        solved: &[Solved],
        pillar: usize,
    ) -> Option<(Partial, Vec<f64>)> {
        let modes = self.modes;
        let (own, symmetry) = images.sources[pillar];
        let place = solved.binary_search_by_key(&own, |(partial, ..)| partial.pillar);
        let (of_own, coefficients, _) = &solved[place.ok()?];
        if of_own.active.len() == self.top.count() {
            return None;
        }
        let (turn, reflected) = &images.symmetries[symmetry];
        let mut constant = of_own.constant.clone();
        turn.apply(&mut constant);
        // The derivative is symmetric: its rows, and then its columns.
        let mut derivative = of_own.derivative.clone();
        for _ in 0..2 {
            derivative
                .chunks_exact_mut(modes)
                .for_each(|row| turn.apply(row));
            transpose(&mut derivative, modes);
        }
        let mut load = vec![0.0; modes];
        incident(pillar, &mut load);
        let rows = constant.iter().zip(derivative.chunks_exact(modes));
        let found: Vec<f64> = rows.map(|(c, row)| c + dot(row, &load)).collect();
        let mut expected = coefficients.clone();
        turn.apply(&mut expected);
        let most = expected.iter().fold(0.0, |most, c| larger(most, c.abs()));
        let alike =
            |(found, expected): (&f64, &f64)| within((found - expected).abs(), ALIKE * most);
        let alike = found.iter().zip(&expected).all(alike);
        let active = if *reflected {
            mirrored(&of_own.active, self.top.resolution())
        } else {
            of_own.active.clone()
        };
        let image = Partial {
            pillar,
            active,
            derivative,
            constant,
            converged: of_own.converged,
        };
        alike.then_some((image, found))
    }

    /// Solves the unilateral problem of one pillar. Returns its new state, its leading moments, and whether its active nodes changed.
    fn solve_partial(
        &self,
        incident: &Incident<'_>,
        solver: &mut LocalSolver,
        pillar: usize,
        guess: Option<&Partial>,
    ) -> Solved {
        let modes = self.modes;
        let load = self.full_load(incident, pillar);
        let top = self.top_of(pillar);
        let mut active = match guess {
            Some(partial) if partial.pillar == pillar => partial.active.clone(),
            _ => Vec::new(),
        };
        let pivoting = solver.solve(&top, &load, &mut active);
        let mut coefficients = vec![0.0; modes];
        solver.coefficients(&top, &load, &mut coefficients);
        let mut derivative = vec![0.0; modes * modes];
        solver.derivative(&top, &mut derivative);
        let radius = self.sites.body(pillar).radius;
        scale(&mut coefficients, radius);
        scale(&mut derivative, radius);
        let constant = coefficients
            .iter()
            .zip(derivative.chunks_exact(modes))
            .map(|(c, row)| c - dot(row, &load[..modes]))
            .collect();
        let moved = guess.is_none_or(|partial| partial.active != active);
        let partial = Partial {
            pillar,
            active,
            derivative,
            constant,
            converged: pivoting.converged,
        };
        (partial, coefficients, moved)
    }

    /// Largest difference between the coefficients of the local problems and those of the linear solution, relative to the largest
    /// coefficient.
    fn mismatch(
        &self,
        incident: &Incident<'_>,
        coefficients: &[f64],
        solved: &[Solved],
        workers: Workers<'_>,
    ) -> f64 {
        let modes = self.modes;
        let of_pillar = |local: &mut Vec<f64>, pillar: usize| {
            match self.status[pillar] {
                PillarStatus::Untouched => local.fill(0.0),
                PillarStatus::Full => {
                    incident(pillar, local);
                    self.respond_in_full(pillar, local);
                }
                PillarStatus::Partial => {
                    let found =
                        solved.binary_search_by_key(&pillar, |(partial, ..)| partial.pillar);
                    if let Ok(place) = found {
                        local.copy_from_slice(&solved[place].1);
                    }
                }
            }
            let global = &coefficients[pillar * modes..(pillar + 1) * modes];
            local
                .iter()
                .zip(global)
                .fold([0.0_f64; 2], |[largest, difference], (c, global)| {
                    [
                        larger(largest, c.abs()),
                        larger(difference, (c - global).abs()),
                    ]
                })
        };
        let local = || vec![0.0; modes];
        let count = self.sites.len();
        let of_pillars = workers.map(count, PILLARS, local, of_pillar);
        let [largest, difference] = of_pillars
            .into_iter()
            .fold([f64::MIN_POSITIVE, 0.0], |[a, b], [c, d]| {
                [larger(a, c), larger(b, d)]
            });
        difference / largest
    }
}

/// Transposes a square matrix.
fn transpose(matrix: &mut [f64], size: usize) {
    for row in 0..size {
        for column in 0..row {
            matrix.swap(row * size + column, column * size + row);
        }
    }
}

fn scale(values: &mut [f64], factor: f64) {
    for value in values {
        *value *= factor;
    }
}

impl Rule for Tops {
    fn respond(&self, load: &[f64], result: &mut [f64], workers: Workers<'_>) {
        let modes = self.modes;
        let one = |(): &mut (), pillar: usize, result: &mut [f64]| {
            let load = &load[pillar * modes..(pillar + 1) * modes];
            match self.status[pillar] {
                PillarStatus::Untouched => result.fill(0.0),
                PillarStatus::Full => {
                    result.copy_from_slice(load);
                    self.respond_in_full(pillar, result);
                }
                PillarStatus::Partial => {
                    let partial = &self.partial[self.partial_of[pillar] as usize];
                    for (c, row) in result
                        .iter_mut()
                        .zip(partial.derivative.chunks_exact(modes))
                    {
                        *c = row.iter().zip(load).map(|(p, s)| p * s).sum();
                    }
                }
            }
        };
        workers.fill(result, modes, PILLARS, || (), one);
    }

    fn add_constants(&self, coefficients: &mut [f64]) {
        for partial in &self.partial {
            let start = partial.pillar * self.modes;
            for (c, constant) in coefficients[start..].iter_mut().zip(&partial.constant) {
                *c += constant;
            }
        }
    }
}
