//! The linearized contact: the response of all contact places at fixed states.
//!
//! The unknowns are the coefficients `c` of the pressure on every place: the leading ones of every pillar top and, if the floor is touched,
//! one for every floor cell. A place with its own compliance, a pillar top, responds to the incident load `s = zeta b1 + bs - B c` with
//! `c = P s + cb` as long as its state is unchanged, where `b1` is the load of a unit indentation, `bs` that of the lens shape, and `B` the
//! [coupling](Coupling). `P` and `cb` are provided by the [rules](Rule). The response of all places is then linear in the indentation,
//! `c = c* + (zeta - zeta*) c1`, with
//!
//! ```text
//! (1 + P B) c* = P (zeta* b1 + bs) + cb,      (1 + P B) c1 = P b1.
//! ```
//!
//! Both are solved by preconditioned conjugate gradients on `(P^-1 + B) c = b + P^-1 cb`, in the dual variable `s = P^-1 (c - cb)`, so that
//! the singular `P` is never inverted. `c*` changes little from step to step, and `c1` need not be exact, as `zeta - zeta*` tends to zero.
//!
//! The compliance of a floor cell is part of `B`: `P^-1` is zero there. Cells that carry pressure must have zero incident load, all others
//! zero pressure; the same iteration computes their pressure, with a preconditioner in place of `P`.

use crate::halfspace::coupling::operator::Coupling;
use crate::halfspace::disc::basis::UNIT_FORCE;
use crate::numerics::convergence::{Judgement, judge, larger, within};
use crate::numerics::vector::{Vectors, dot, subtract};
use crate::numerics::workers::Workers;
use crate::state::{Run, SolveError};

/// Largest number of iterations of the conjugate gradient method; 10 to 25 are typical.
const ITERATION_LIMIT: usize = 600;

/// Tolerance above which the initial product of the iteration may be computed in single precision.
const ROUGH_TOLERANCE: f64 = 1e-5;

/// Largest number of starts from an exact product.
const MOST_STARTS: usize = 3;

/// Tolerance of the residual in the energy norm: the larger of two values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Remainder {
    /// Relative to the load.
    pub(crate) of_load: f64,
    /// Relative to the initial residual.
    pub(crate) of_start: f64,
}

impl From<f64> for Remainder {
    fn from(of_load: f64) -> Self {
        Self {
            of_load,
            of_start: 0.0,
        }
    }
}

/// Linearized response of the contact places to the loads on them.
pub(crate) trait Rule {
    /// `c = P s`, place by place. For places without their own compliance, `c` is unchanged, or set to zero if they carry no pressure.
    fn respond(&self, load: &[f64], coefficients: &mut [f64], workers: Workers<'_>);

    /// `c += cb`
    fn add_constants(&self, coefficients: &mut [f64]);

    /// Approximate solution for a residual: `P` times the residual, where that is defined; zero at places without pressure. `load` receives
    /// the load that corresponds to the result, for the places with their own compliance, which come first.
    fn precondition(
        &mut self,
        residual: &[f64],
        direction: &mut [f64],
        load: &mut [f64],
        workers: Workers<'_>,
    ) {
        load.copy_from_slice(&residual[..load.len()]);
        self.respond(residual, direction, workers);
    }
}

impl<R: Rule> Rule for &mut R {
    fn respond(&self, load: &[f64], coefficients: &mut [f64], workers: Workers<'_>) {
        R::respond(self, load, coefficients, workers);
    }

    fn add_constants(&self, coefficients: &mut [f64]) {
        R::add_constants(self, coefficients);
    }

    fn precondition(
        &mut self,
        residual: &[f64],
        direction: &mut [f64],
        load: &mut [f64],
        workers: Workers<'_>,
    ) {
        R::precondition(self, residual, direction, load, workers);
    }
}

/// Coefficients, and the loads that they cause on the other places.
#[derive(Debug, Clone, Default)]
pub(crate) struct Response {
    /// `c`
    pub(crate) coefficients: Vec<f64>,
    /// `B c`
    pub(crate) far: Vec<f64>,
}

impl Response {
    /// Zero pressure.
    pub(crate) fn none(size: usize) -> Self {
        Self {
            coefficients: vec![0.0; size],
            far: vec![0.0; size],
        }
    }
}

/// Load of a response.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Source<'a> {
    /// A unit indentation: `c1`.
    Unit,
    /// The lens at the current indentation: `c*`.
    Present,
    /// Any other load, without `cb`.
    Given(&'a [f64]),
}

/// All contact places with their loads and responses.
pub(crate) struct LinearizedContact<'a, O> {
    run: &'a Run<'a>,
    coupling: O,
    /// Leading modes per pillar.
    modes: usize,
    /// Number of coefficients of pillars, which come first; all others belong to floor cells.
    tops: usize,
    /// Load of a unit indentation on a floor cell, and force of a unit coefficient: the square root of its area.
    unit_cell: f64,
    /// `bs`, place by place.
    own_load: Vec<f64>,
    /// Response to a unit indentation.
    pub(crate) unit: Response,
    /// Response at the indentation `base`.
    pub(super) present: Response,
    base: f64,
    /// Number of products with the coupling so far.
    products: usize,
    /// Residual of the last solution.
    remainder: f64,
    workspace: Workspace,
}

/// Work vectors of the iteration.
#[derive(Default)]
struct Workspace {
    load: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    direction_load: Vec<f64>,
    /// The product with the direction, and then the preconditioned residual.
    product: Vec<f64>,
}

impl Workspace {
    /// Resizes all vectors.
    fn resize(&mut self, size: usize) {
        let Self {
            load,
            residual,
            direction,
            direction_load,
            product,
        } = self;
        for vector in [load, residual, direction, direction_load, product] {
            vector.resize(size, 0.0);
        }
    }
}

impl<'a, O: Coupling> LinearizedContact<'a, O> {
    /// Zero pressure at zero indentation.
    pub(crate) fn new(run: &'a Run<'a>, coupling: O, modes: usize, own_load: Vec<f64>) -> Self {
        let size = own_load.len();
        Self {
            run,
            coupling,
            modes,
            tops: size,
            unit_cell: 0.0,
            own_load,
            unit: Response::none(size),
            present: Response::none(size),
            base: 0.0,
            products: 0,
            remainder: 0.0,
            workspace: Workspace::default(),
        }
    }

    /// Replaces the floor cells. `unit_cell` is the square root of the cell area, `own_load` the lens shape over each cell, and `start` the
    /// coefficients of each at the current load and at unit indentation. `couple` must set the coupling for the new cells.
    pub(crate) fn set_floor(
        &mut self,
        unit_cell: f64,
        own_load: impl Iterator<Item = f64>,
        start: impl Fn(usize) -> [f64; 2],
        couple: impl FnOnce(&mut O),
    ) {
        let had_floor = self.own_load.len() > self.tops;
        self.own_load.truncate(self.tops);
        self.own_load.extend(own_load);
        self.unit_cell = unit_cell;
        let (tops, size) = (self.tops, self.own_load.len());
        for (which, response) in [&mut self.present, &mut self.unit].into_iter().enumerate() {
            let cells = (0..size - tops).map(|cell| start(cell)[which]);
            response.coefficients.truncate(tops);
            response.coefficients.extend(cells);
            response.far.truncate(tops);
            response.far.resize(size, 0.0);
        }
        couple(&mut self.coupling);
        if had_floor && self.present.coefficients[tops..].iter().any(|c| *c > 0.0) {
            // The loads on pillars change little, and no other loads are needed before the first product.
            return;
        }
        self.couple();
    }

    /// Recomputes the accumulated approximate products exactly, if there are any.
    pub(super) fn make_exact(&mut self) {
        if self.coupling.rough_error() > 0.0 {
            self.couple();
        }
    }

    /// Releases the work vectors until the next solution.
    pub(super) fn release_workspace(&mut self) {
        self.workspace = Workspace::default();
    }

    /// Recomputes the loads of all coefficients on each other.
    fn couple(&mut self) {
        for response in [&mut self.unit, &mut self.present] {
            let Response { coefficients, far } = response;
            if coefficients.iter().all(|c| *c == 0.0) {
                // Zeros are not written: memory pages that are only read need not be allocated.
                if far.iter().any(|far| *far != 0.0) {
                    far.fill(0.0);
                }
            } else {
                self.products += 1;
                self.coupling.apply(coefficients, far, self.run.workers());
            }
        }
    }

    /// Leading modes per pillar.
    pub(crate) fn modes(&self) -> usize {
        self.modes
    }

    /// Number of coefficients of pillars.
    pub(crate) fn tops(&self) -> usize {
        self.tops
    }

    /// Number of all coefficients.
    pub(crate) fn len(&self) -> usize {
        self.own_load.len()
    }

    /// The coupling between the places.
    pub(crate) fn coupling(&self) -> &O {
        &self.coupling
    }

    /// The coupling, for replacement.
    pub(crate) fn coupling_mut(&mut self) -> &mut O {
        &mut self.coupling
    }

    /// Number of products with the coupling so far.
    #[cfg(any(test, feature = "kernels"))]
    pub(crate) fn products(&self) -> usize {
        self.products
    }

    /// Residual of the last solution, relative to the load, in the energy norm.
    pub(crate) fn remainder(&self) -> f64 {
        self.remainder
    }

    /// The indentation of the current response.
    pub(crate) fn indentation(&self) -> f64 {
        self.base
    }

    /// `c` at that indentation, place by place.
    pub(crate) fn coefficients(&self) -> &[f64] {
        &self.present.coefficients
    }

    /// The current coefficients and those at unit indentation, place by place.
    pub(crate) fn parts(&self) -> [&[f64]; 2] {
        [&self.present.coefficients, &self.unit.coefficients]
    }

    /// Loads of the lens shape; to be changed only before the first solution.
    pub(crate) fn own_load_mut(&mut self) -> &mut [f64] {
        &mut self.own_load
    }

    /// Force at the current indentation.
    pub(crate) fn force(&self) -> f64 {
        self.force_of(&self.present)
    }

    /// Derivative of the force with respect to the indentation.
    pub(crate) fn stiffness(&self) -> f64 {
        self.force_of(&self.unit)
    }

    fn force_of(&self, response: &Response) -> f64 {
        let (tops, floor) = response.coefficients.split_at(self.tops);
        let of_tops = UNIT_FORCE * tops.iter().step_by(self.modes).sum::<f64>();
        if floor.is_empty() {
            return of_tops;
        }
        of_tops + self.unit_cell * floor.iter().sum::<f64>()
    }

    /// Force on the floor at the current indentation.
    pub(crate) fn floor_force(&self) -> f64 {
        self.unit_cell * self.floor_coefficients().iter().sum::<f64>()
    }

    /// Derivative of the floor force with respect to the indentation.
    pub(crate) fn floor_stiffness(&self) -> f64 {
        self.unit_cell * self.floor_unit_coefficients().iter().sum::<f64>()
    }

    /// Coefficients of the floor cells.
    pub(crate) fn floor_coefficients(&self) -> &[f64] {
        &self.present.coefficients[self.tops..]
    }

    /// Multiplies the coefficients of a floor cell by a factor, as a better start of the next solution.
    pub(crate) fn scale_floor(&mut self, cell: usize, factor: f64) {
        for response in [&mut self.present, &mut self.unit] {
            response.coefficients[self.tops + cell] *= factor;
        }
    }

    /// Coefficients of the floor cells at unit indentation.
    pub(crate) fn floor_unit_coefficients(&self) -> &[f64] {
        &self.unit.coefficients[self.tops..]
    }

    /// Load of a unit indentation on a floor cell.
    pub(crate) fn unit_cell(&self) -> f64 {
        self.unit_cell
    }

    /// Residual displacement of every floor cell: required minus actual displacement. Equals the gap with the opposite sign.
    pub(crate) fn floor_load(&self) -> impl Iterator<Item = f64> {
        let own = self.own_load[self.tops..].iter();
        let far = self.present.far[self.tops..].iter();
        let scale = self.unit_cell.recip();
        own.zip(far)
            .map(move |(own, far)| (own - far) * scale + self.base)
    }

    /// Energy of the current response, valid if the contact conditions are satisfied.
    pub(crate) fn energy(&self) -> f64 {
        let (coefficients, own) = (&self.present.coefficients, &self.own_load);
        let of_lens: f64 = coefficients.iter().zip(own).map(|(c, b)| c * b).sum();
        -0.5 * (of_lens + self.base * self.force())
    }

    /// Computes the incident load on a pillar, `zeta b1 + bs - B c`, in the leading modes.
    pub(crate) fn load(&self, place: usize, load: &mut [f64]) {
        for (k, slot) in (place * self.modes..).zip(load.iter_mut()) {
            *slot = self.own_load[k] - self.present.far[k];
        }
        load[0] += self.base * UNIT_FORCE;
    }

    /// [`load`](Self::load) as a closure for rules.
    pub(crate) fn incident(&self) -> impl Fn(usize, &mut [f64]) + Sync
    where
        O: Sync,
    {
        |place, load| self.load(place, load)
    }

    /// Incident loads on all places at the current indentation.
    pub(crate) fn all_loads(&self, loads: &mut [f64]) {
        self.right_side(Source::Present, loads);
        subtract(loads, &self.present.far);
    }

    /// Derivative of these loads with respect to the indentation.
    pub(crate) fn unit_loads(&self, loads: &mut [f64]) {
        self.right_side(Source::Unit, loads);
        subtract(loads, &self.unit.far);
    }

    /// Elastic energy: half the work of all pressures on their displacements.
    pub(crate) fn elastic_energy(&self) -> f64 {
        let shape = dot(&self.present.coefficients, &self.own_load);
        0.5 * (shape + self.base * self.force())
    }

    /// Moves along the linear response to another indentation.
    pub(crate) fn move_to(&mut self, indentation: f64) {
        let change = indentation - self.base;
        let vectors = Vectors(self.run.workers());
        let Response { coefficients, far } = &mut self.present;
        vectors.add_scaled(coefficients, change, &self.unit.coefficients);
        vectors.add_scaled(far, change, &self.unit.far);
        self.base = indentation;
    }

    /// Sets initial coefficients. For a pillar, `start` returns those of the current response and of the response to a unit indentation, if
    /// known.
    pub(crate) fn start_from<'s>(
        &mut self,
        indentation: f64,
        mut start: impl FnMut(usize) -> Option<[&'s [f64]; 2]>,
    ) {
        let modes = self.modes;
        for place in 0..self.tops / modes {
            let Some(known) = start(place) else {
                continue;
            };
            for (response, known) in [&mut self.present, &mut self.unit].into_iter().zip(known) {
                let shared = modes.min(known.len());
                response.coefficients[place * modes..][..shared].copy_from_slice(&known[..shared]);
            }
        }
        self.base = indentation;
        self.couple();
    }

    /// Solves for the response at the current indentation or to a unit indentation, starting from its previous value.
    pub(crate) fn solve(
        &mut self,
        rule: &mut impl Rule,
        source: Source<'_>,
        tolerance: impl Into<Remainder>,
    ) -> Result<Judgement, SolveError> {
        let mut response = std::mem::take(match source {
            Source::Unit => &mut self.unit,
            _ => &mut self.present,
        });
        let solved = self.conjugate_gradients(rule, source, tolerance.into(), &mut response);
        match source {
            Source::Unit => self.unit = response,
            _ => self.present = response,
        }
        solved
    }

    /// Response to a given load.
    pub(crate) fn respond_to(
        &mut self,
        rule: &mut impl Rule,
        load: &[f64],
        tolerance: f64,
    ) -> Result<Response, SolveError> {
        let mut response = Response::none(load.len());
        self.conjugate_gradients(rule, Source::Given(load), tolerance.into(), &mut response)
            .map(|_| response)
    }

    /// `B c`
    pub(crate) fn coupled(&mut self, coefficients: &[f64]) -> Vec<f64> {
        let mut far = vec![0.0; coefficients.len()];
        self.coupling
            .apply(coefficients, &mut far, self.run.workers());
        far
    }

    /// `b1 - B c1`: derivative of the force with respect to the coefficients of each place.
    pub(crate) fn unit_sensitivity(&self) -> Vec<f64> {
        let mut load = vec![0.0; self.unit.far.len()];
        self.right_side(Source::Unit, &mut load);
        subtract(&mut load, &self.unit.far);
        load
    }

    fn conjugate_gradients(
        &mut self,
        rule: &mut impl Rule,
        source: Source<'_>,
        tolerance: Remainder,
        response: &mut Response,
    ) -> Result<Judgement, SolveError> {
        let mut workspace = std::mem::take(&mut self.workspace);
        workspace.resize(self.len());
        let mut solved = Ok(Judgement::TooLarge);
        for _ in 0..MOST_STARTS {
            let mut before = 0.0;
            solved = self.iterate(
                rule,
                source,
                tolerance,
                response,
                &mut workspace,
                &mut before,
            );
            let rough = self.coupling.rough_error() * before > tolerance.of_load;
            if !(rough && matches!(solved, Ok(Judgement::Good))) {
                break;
            }
            // The residual of approximate products is too large: repeat from an exact product.
        }
        self.workspace = workspace;
        solved
    }

    /// Iterates from the previous response; `before` receives the relative residual at the start.
    fn iterate(
        &mut self,
        rule: &mut impl Rule,
        source: Source<'_>,
        tolerance: Remainder,
        response: &mut Response,
        workspace: &mut Workspace,
        before: &mut f64,
    ) -> Result<Judgement, SolveError> {
        let Response { coefficients, far } = response;
        let workers = self.run.workers();
        let vectors = Vectors(workers);
        // s = b - B c of the previous solution; c = P s + cb; r = b - B c - s.
        // On floor cells, which have no separate compliance: c unchanged; r = b - B c.
        let tops = self.tops;
        self.right_side(source, &mut workspace.load);
        workspace.residual[..tops].copy_from_slice(&far[..tops]);
        workspace.residual[tops..].copy_from_slice(&workspace.load[tops..]);
        vectors.subtract(&mut workspace.load[..tops], &far[..tops]);
        rule.respond(&workspace.load, coefficients, workers);
        if let Source::Present = source {
            rule.add_constants(coefficients);
        }
        let mut scale = vectors.dot(&workspace.load, coefficients).abs();
        self.products += 1;
        if tolerance.of_load > ROUGH_TOLERANCE {
            self.coupling.apply_roughly(coefficients, far, workers);
        } else {
            self.coupling.apply(coefficients, far, workers);
        }
        self.run.check_cancelled()?;
        vectors.subtract(&mut workspace.residual, far);
        let direction_load = &mut workspace.direction_load[..tops];
        let direction = &mut workspace.direction;
        rule.precondition(&workspace.residual, direction, direction_load, workers);
        workspace.direction_load[tops..].fill(0.0);
        let mut energy = vectors.dot(&workspace.residual, &workspace.direction);
        if tops < workspace.load.len() {
            // Before any cell carries pressure there is no other energy as a reference.
            scale = larger(scale, energy);
        }
        *before = (energy / larger(scale, f64::MIN_POSITIVE)).sqrt();
        let of_start = tolerance.of_start.powi(2) * energy;
        for _ in 0..ITERATION_LIMIT {
            let scale = larger(scale, f64::MIN_POSITIVE);
            let bound = larger(tolerance.of_load.powi(2) * scale, of_start);
            self.remainder = (energy / scale).sqrt();
            match judge(energy, bound) {
                Judgement::TooLarge => {}
                ended => return Ok(ended),
            }
            // Steps become small, and so do their rounding errors; every exact solution starts from an exact product.
            self.products += 1;
            self.coupling
                .apply_roughly(&workspace.direction, &mut workspace.product, workers);
            self.run.check_cancelled()?;
            // A p = B p_z + p_s; B p_z is accumulated in `far`.
            let curvature = vectors.dot(&workspace.direction, &workspace.product)
                + vectors.dot(
                    &workspace.direction[..tops],
                    &workspace.direction_load[..tops],
                );
            if within(curvature, 0.0) {
                return Ok(Judgement::TooLarge);
            }
            let length = energy / curvature;
            vectors.add_scaled(coefficients, length, &workspace.direction);
            vectors.add_scaled(far, length, &workspace.product);
            vectors.add_scaled(&mut workspace.residual, -length, &workspace.product);
            vectors.add_scaled(
                &mut workspace.residual[..tops],
                -length,
                &workspace.direction_load[..tops],
            );
            let preconditioned = &mut workspace.product;
            let load = &mut workspace.load[..tops];
            rule.precondition(&workspace.residual, preconditioned, load, workers);
            let next = vectors.dot(&workspace.residual, preconditioned);
            let ratio = next / energy;
            energy = next;
            vectors.scale_and_add(&mut workspace.direction, ratio, &workspace.product);
            vectors.scale_and_add(
                &mut workspace.direction_load[..tops],
                ratio,
                &workspace.load[..tops],
            );
        }
        Ok(Judgement::TooLarge)
    }

    fn right_side(&self, source: Source<'_>, load: &mut [f64]) {
        match source {
            Source::Unit => {
                load.fill(0.0);
                self.add_unit_load(1.0, load);
            }
            Source::Present => {
                load.copy_from_slice(&self.own_load);
                self.add_unit_load(self.base, load);
            }
            Source::Given(source) => load.copy_from_slice(source),
        }
    }

    /// Adds the load of an indentation.
    fn add_unit_load(&self, indentation: f64, load: &mut [f64]) {
        let (tops, floor) = load.split_at_mut(self.tops);
        tops.iter_mut()
            .step_by(self.modes)
            .for_each(|b| *b += indentation * UNIT_FORCE);
        floor
            .iter_mut()
            .for_each(|b| *b += indentation * self.unit_cell);
    }
}
