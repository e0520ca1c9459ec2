//! The contact problem on elements, as a quadratic problem with bounds.
//!
//! At an indentation `zeta` the pressures minimise the energy
//!
//! ```text
//! E(p) = A (1/2 p·Wp + p·(s - zeta)),   p >= 0,
//! ```
//!
//! with `A` the area of an element, `W` its [`Operator`] and `s` the separation of the undeformed surfaces. The gradient
//! `v = Wp + s - zeta` is the gap. Under a force `F` they minimise the same function without `zeta` among all `p >= 0` with `A Σp = F`, and
//! `zeta` is the multiplier.
//!
//! # Duality gap
//!
//! For any `p >= 0` and any lower bound `m` of `v`, the energy of `p` at the indentation `zeta + m` is at most `A Σ p (v - m)` above the
//! minimum. This is the duality gap, since `W` is positive definite and `v - m >= 0` makes `p` dual feasible. Under a force it is the gap
//! of M. Frank and P. Wolfe (Nav. Res. Logist. Q. 3, 95 (1956)). At a prescribed indentation the work `-m A Σ p` over the distance by which
//! the indentation is missed is added. The bound depends only on the gap, so that neither small steps nor a wrong contact area can make it
//! too small. The iteration converges if and only if the bound falls below a fraction of the elastic energy.
//!
//! # Method
//!
//! Conjugate gradients on the elements that carry pressure or interpenetrate, projected onto `p >= 0` (I. A. Polonsky and L. M. Keer, Wear
//! 231, 206 (1999)) and preconditioned by the operator's own approximate inverse. Directions stay conjugate, after E. Polak and G. Ribiere,
//! while elements enter and leave the contact: a restart for every element that enters would turn nearly all steps into steepest descents
//! if many elements are in contact. Under a force, the mean over these elements is subtracted from residuals and directions, so that the
//! sum of the pressures is constant. The displacement of a step may be computed in [single precision](Operator::apply_to_step); before the
//! duality gap is accepted, the displacement is recomputed from the pressures. Steps that do not lower the energy, which projection can
//! cause, are replaced by projected gradient steps that are halved until they do.

use crate::halfspace::elements::Operator;
use crate::numerics::convergence::{Judgement, judge, larger, largest, smaller, within};
use crate::numerics::workers::CancelToken;
use crate::state::{DualityGap, Termination};

pub use crate::problem::load::Prescribed;

/// Stopping criteria.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Largest accepted bound on the energy error, relative to the elastic energy.
    pub tolerance: f64,
    /// Largest number of products with the operator.
    pub product_limit: usize,
}

impl Default for Settings {
    /// A tolerance of 1e-8: the relative error of forces is about the same, which is below the discretisation error.
    fn default() -> Self {
        Self {
            tolerance: 1e-8,
            product_limit: 5000,
        }
    }
}

/// Pressures on elements that press two surfaces together.
#[derive(Debug, Clone)]
pub struct ElementContact {
    /// Pressure on every element, Pa.
    pub pressure: Vec<f64>,
    /// Gap at the centre of every element, m.
    pub gap: Vec<f64>,
    /// Indentation, m.
    pub indentation: f64,
    /// Force, N.
    pub force: f64,
    /// Bound on the energy error, and largest violation of the contact conditions.
    pub certificate: DualityGap,
    /// Reason for the end of the iteration.
    pub termination: Termination,
    /// Number of products with the operator.
    pub products: usize,
}

impl ElementContact {
    /// Extends the duality gap to elements that were not part of the solution, whose lowest gap (m) is given.
    ///
    /// `separation` is that of the elements of the solution.
    pub(super) fn take_in(
        &mut self,
        lowest: f64,
        load: Prescribed,
        separation: impl Iterator<Item = f64>,
    ) {
        let deeper = -lowest - self.certificate.interpenetration;
        if deeper <= 0.0 {
            return;
        }
        self.certificate.interpenetration += deeper;
        let (mut sum, mut work) = (0.0, 0.0);
        for ((p, gap), s) in self.pressure.iter().zip(&self.gap).zip(separation) {
            sum += p;
            work += p * (gap + self.indentation - s);
        }
        // As in the solution: the depth, plus the work over the distance by which a prescribed indentation is missed.
        let times = match load {
            Prescribed::Indentation(_) => 2.0,
            Prescribed::Force(_) => 1.0,
        };
        self.certificate.energy_bound += if work > 0.0 {
            2.0 * times * sum * deeper / work
        } else {
            f64::INFINITY
        };
    }
}

/// Number of products within which the duality gap must decrease; otherwise the solver has stagnated.
const PATIENCE: usize = 200;

/// Factor by which the duality gap must decrease.
const IMPROVEMENT: f64 = 0.9;

/// Largest number of halvings of a projected gradient step.
const HALVINGS: usize = 40;

/// Solves the contact problem.
///
/// `separation` is that of the undeformed surfaces at each element (m) at zero indentation, `area` that of an element (m^2), `start` the
/// initial pressures (Pa), if any. All values must be finite; elements that can never be touched must be left out. Otherwise the solution
/// ends with [`Termination::NotFinite`].
///
/// # Panics
/// If a length differs from that of the operator.
pub fn solve<O: Operator + ?Sized>(
    operator: &mut O,
    separation: &[f64],
    area: f64,
    load: Prescribed,
    start: Option<&[f64]>,
    settings: &Settings,
    cancel: &CancelToken,
) -> ElementContact {
    let start = start.map_or_else(|| vec![0.0; separation.len()], <[f64]>::to_vec);
    solve_from(operator, separation, area, load, start, settings, cancel)
}

/// [Solves](solve) from initial pressures, which are overwritten by the solution.
pub(super) fn solve_from<O: Operator + ?Sized>(
    operator: &mut O,
    separation: &[f64],
    area: f64,
    load: Prescribed,
    start: Vec<f64>,
    settings: &Settings,
    cancel: &CancelToken,
) -> ElementContact {
    assert_eq!(separation.len(), operator.len());
    let mut iteration = Iteration::new(operator, separation, area, load, start);
    let termination = iteration.run(settings, cancel);
    if matches!(
        termination,
        Termination::IterationLimit | Termination::Stagnated
    ) {
        // Steps in single precision may have left errors in the displacement, which the duality gap must include.
        iteration.refresh_displacement();
        iteration.assess();
    }
    iteration.finish(termination)
}

struct Iteration<'a, O: ?Sized> {
    operator: &'a mut O,
    separation: &'a [f64],
    area: f64,
    load: Prescribed,
    /// Sum of the pressures under a prescribed force, Pa.
    total: f64,
    pressure: Vec<f64>,
    /// `W p`.
    displacement: Vec<f64>,
    /// Preconditioned residual.
    search: Vec<f64>,
    direction: Vec<f64>,
    /// The residual while a direction is computed; then `W` times the direction; then, in a step that reaches a bound, the pressures to
    /// restore.
    response: Vec<f64>,
    free: Vec<bool>,
    /// Number of free elements, and under a prescribed force the mean gap of these.
    free_count: usize,
    mean_gap: f64,
    /// Residual times preconditioned residual, of the previous iteration.
    slope: f64,
    products: usize,
    certificate: DualityGap,
    indentation: f64,
}

impl<'a, O: Operator + ?Sized> Iteration<'a, O> {
    fn new(
        operator: &'a mut O,
        separation: &'a [f64],
        area: f64,
        load: Prescribed,
        mut pressure: Vec<f64>,
    ) -> Self {
        let count = separation.len();
        assert_eq!(pressure.len(), count);
        for value in &mut pressure {
            *value = larger(*value, 0.0);
        }
        let total = match load {
            Prescribed::Force(force) => force / area,
            Prescribed::Indentation(_) => 0.0,
        };
        let mut iteration = Self {
            operator,
            separation,
            area,
            load,
            total,
            pressure,
            displacement: vec![0.0; count],
            search: vec![0.0; count],
            direction: vec![0.0; count],
            response: vec![0.0; count],
            free: vec![false; count],
            free_count: 0,
            mean_gap: 0.0,
            slope: 0.0,
            products: 0,
            certificate: DualityGap {
                energy_bound: f64::INFINITY,
                interpenetration: 0.0,
                gap_under_pressure: 0.0,
            },
            indentation: 0.0,
        };
        iteration.carry_the_force();
        iteration
    }

    /// Under a prescribed force, scales the pressures to that force. If all pressures are zero, the elements with the smallest separation
    /// are loaded.
    fn carry_the_force(&mut self) {
        let Prescribed::Force(_) = self.load else {
            return;
        };
        let sum: f64 = self.pressure.iter().sum();
        if !within(sum, 0.0) {
            let scale = self.total / sum;
            self.pressure.iter_mut().for_each(|p| *p *= scale);
            return;
        }
        let nearest = self
            .separation
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        let touching = |s: f64| s <= nearest;
        let count = self.separation.iter().filter(|s| touching(**s)).count();
        for (pressure, separation) in self.pressure.iter_mut().zip(self.separation) {
            if touching(*separation) {
                *pressure = self.total / count as f64;
            }
        }
    }

    fn run(&mut self, settings: &Settings, cancel: &CancelToken) -> Termination {
        self.refresh_displacement();
        let mut best = f64::INFINITY;
        let mut best_at = 0;
        let mut fresh = true;
        let mut restart = true;
        loop {
            self.assess();
            match judge(self.certificate.energy_bound, settings.tolerance) {
                Judgement::Good if fresh => return Termination::Converged,
                Judgement::Good => {
                    // The displacement was accumulated by increments: recompute it before accepting the result.
                    self.refresh_displacement();
                    fresh = true;
                    continue;
                }
                Judgement::Undefined => return Termination::NotFinite,
                Judgement::TooLarge => {}
            }
            if self.certificate.energy_bound < IMPROVEMENT * best {
                best = self.certificate.energy_bound;
                best_at = self.products;
            }
            if cancel.is_cancelled() {
                return Termination::Interrupted;
            }
            if self.products >= settings.product_limit {
                return Termination::IterationLimit;
            }
            if self.products > best_at + PATIENCE {
                return Termination::Stagnated;
            }
            self.find_free();
            let slope = self.find_direction(restart);
            match self.advance(slope) {
                Step::Plain => (fresh, restart) = (false, false),
                Step::Projected => (fresh, restart) = (true, false),
                Step::Gradient => (fresh, restart) = (true, true),
                Step::Failed => return Termination::Stagnated,
            }
        }
    }

    fn refresh_displacement(&mut self) {
        self.operator.apply(&self.pressure, &mut self.displacement);
        self.products += 1;
    }

    fn gap(&self, element: usize) -> f64 {
        self.displacement[element] + self.separation[element] - self.indentation
    }

    /// Computes the indentation that belongs to a force, and the duality gap.
    fn assess(&mut self) {
        let mut weighted = 0.0;
        let mut lowest = f64::INFINITY;
        let mut sum = 0.0;
        let mut work = 0.0;
        for ((p, u), s) in self
            .pressure
            .iter()
            .zip(&self.displacement)
            .zip(self.separation)
        {
            weighted += p * (u + s);
            lowest = smaller(lowest, u + s);
            sum += p;
            work += p * u;
        }
        self.indentation = match self.load {
            Prescribed::Indentation(indentation) => indentation,
            Prescribed::Force(_) if sum > 0.0 => weighted / sum,
            Prescribed::Force(_) => lowest,
        };
        let depth = larger(self.indentation - lowest, 0.0);
        // A Σ p (v - m) over the elastic energy A/2 Σ p u, plus the work over the distance by which a prescribed indentation is missed.
        let missed = match self.load {
            Prescribed::Indentation(_) => depth,
            Prescribed::Force(_) => 0.0,
        };
        let bound = larger(weighted - sum * (self.indentation - depth - missed), 0.0);
        self.certificate = DualityGap {
            energy_bound: if work > 0.0 {
                2.0 * bound / work
            } else if depth > 0.0 {
                f64::INFINITY
            } else if (work + depth + bound).is_finite() {
                0.0
            } else {
                f64::NAN
            },
            interpenetration: depth,
            gap_under_pressure: 0.0,
        };
    }

    /// Determines the elements that carry pressure or interpenetrate.
    fn find_free(&mut self) {
        let mut sum = 0.0;
        self.free_count = 0;
        for element in 0..self.pressure.len() {
            let gap = self.gap(element);
            let free = self.pressure[element] > 0.0 || gap < 0.0;
            self.free[element] = free;
            if free {
                self.free_count += 1;
                sum += gap;
            }
        }
        self.mean_gap = self.mean_of_free(sum);
    }

    /// Under a prescribed force, the mean over the free elements, which is subtracted from directions, of values with this sum; otherwise
    /// zero.
    fn mean_of_free(&self, sum: f64) -> f64 {
        match self.load {
            Prescribed::Force(_) => sum / self.free_count as f64,
            Prescribed::Indentation(_) => 0.0,
        }
    }

    /// Negative gradient on a free element.
    fn residual(&self, element: usize) -> f64 {
        if self.free[element] {
            self.mean_gap - self.gap(element)
        } else {
            0.0
        }
    }

    /// Computes the conjugate direction, or after a `restart` the preconditioned gradient. Returns the slope along it, the residual times
    /// the direction.
    fn find_direction(&mut self, restart: bool) -> f64 {
        // The residual times the previous preconditioned residual. Because preconditioners are symmetric, on the same elements it equals
        // the previous residual times the next preconditioned one.
        let mut mixed = 0.0;
        for element in 0..self.pressure.len() {
            let residual = self.residual(element);
            mixed += residual * self.search[element];
            self.response[element] = residual;
        }
        self.operator.precondition(&self.response, &mut self.search);
        clear_bound(&mut self.search, &self.free);
        let mean = self.mean_of_free(sum(&self.search));
        let slope = subtract_mean(&mut self.search, mean, &self.free, &self.response);
        // Polak and Ribiere, restarting where the factor is negative.
        let memory = if restart || self.slope <= 0.0 {
            0.0
        } else {
            larger((slope - mixed) / self.slope, 0.0)
        };
        self.slope = slope;
        for ((direction, search), free) in
            self.direction.iter_mut().zip(&self.search).zip(&self.free)
        {
            *direction = if *free {
                search + memory * *direction
            } else {
                0.0
            };
        }
        // Restores the mean after elements left the contact.
        let mean = self.mean_of_free(sum(&self.direction));
        let along = subtract_mean(&mut self.direction, mean, &self.free, &self.response);
        if along > 0.0 {
            return along;
        }
        self.direction.copy_from_slice(&self.search);
        slope
    }

    /// Slope of the energy, divided by the area of an element, from the saved pressures to the current ones.
    fn slope_from_kept(&self) -> f64 {
        let pressures = self.pressure.iter().zip(&self.response);
        pressures
            .enumerate()
            .map(|(element, (pressure, kept))| (pressure - kept) * self.gap(element))
            .sum()
    }

    /// Moves to the minimum along the direction, on which the energy decreases with the given slope, projected onto non-negative pressures.
    fn advance(&mut self, slope: f64) -> Step {
        self.operator
            .apply_to_step(&self.direction, &mut self.response);
        self.products += 1;
        let stiffness = dot(&self.direction, &self.response);
        if stiffness.is_nan() || stiffness <= 0.0 {
            return Step::Failed;
        }
        let length = slope / stiffness;
        let inside = self
            .pressure
            .iter()
            .zip(&self.direction)
            .all(|(p, t)| p + length * t >= 0.0);
        if inside {
            add_scaled(&mut self.pressure, length, &self.direction);
            add_scaled(&mut self.displacement, length, &self.response);
            return Step::Plain;
        }
        self.response.copy_from_slice(&self.pressure);
        if self.project(length) {
            return Step::Projected;
        }
        self.go_back();
        let mut length = self.turn_to_gradient();
        for _ in 0..HALVINGS {
            if self.project(length) {
                return Step::Gradient;
            }
            self.go_back();
            length *= 0.5;
        }
        Step::Failed
    }

    /// Restores the saved pressures.
    fn go_back(&mut self) {
        self.pressure.copy_from_slice(&self.response);
        self.refresh_displacement();
    }

    /// Sets the direction to the gradient; returns the step length to the minimum along it, without projection.
    fn turn_to_gradient(&mut self) -> f64 {
        for element in 0..self.pressure.len() {
            self.direction[element] = self.residual(element);
        }
        self.operator
            .apply_to_step(&self.direction, &mut self.search);
        self.products += 1;
        dot(&self.direction, &self.direction) / dot(&self.direction, &self.search)
    }

    /// Sets the pressures to the positive part of a step from the saved pressures along the direction. Returns whether the energy
    /// decreased.
    fn project(&mut self, length: f64) -> bool {
        for ((pressure, kept), t) in self
            .pressure
            .iter_mut()
            .zip(&self.response)
            .zip(&self.direction)
        {
            *pressure = larger(kept + length * t, 0.0);
        }
        self.carry_the_force();
        let before = self.slope_from_kept();
        self.refresh_displacement();
        // The energy is quadratic: its change is the mean of the slopes at both ends. Near the solution, the difference of two energies
        // would be lost in rounding.
        before + self.slope_from_kept() < 0.0
    }

    fn finish(mut self, termination: Termination) -> ElementContact {
        for element in 0..self.pressure.len() {
            self.displacement[element] = self.gap(element);
        }
        let gap = self.displacement;
        let under_pressure = gap
            .iter()
            .zip(&self.pressure)
            .filter(|(_, pressure)| **pressure > 0.0)
            .map(|(gap, _)| *gap);
        self.certificate.gap_under_pressure = largest(under_pressure);
        ElementContact {
            indentation: self.indentation,
            force: self.area * sum(&self.pressure),
            certificate: self.certificate,
            termination,
            products: self.products,
            gap,
            pressure: self.pressure,
        }
    }
}

/// Result of a step.
enum Step {
    /// The step reached the minimum, and no pressure became negative.
    Plain,
    /// Negative pressures were set to zero, and the energy decreased.
    Projected,
    /// The projected gradient was used instead.
    Gradient,
    /// No step decreases the energy.
    Failed,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn sum(values: &[f64]) -> f64 {
    values.iter().sum()
}

fn add_scaled(sum: &mut [f64], factor: f64, values: &[f64]) {
    for (sum, value) in sum.iter_mut().zip(values) {
        *sum += factor * value;
    }
}

/// Sets the values of elements that are not free to zero.
fn clear_bound(values: &mut [f64], free: &[bool]) {
    for (value, free) in values.iter_mut().zip(free) {
        if !free {
            *value = 0.0;
        }
    }
}

/// Subtracts a mean from the free values; returns their product with the residual.
fn subtract_mean(values: &mut [f64], mean: f64, free: &[bool], residual: &[f64]) -> f64 {
    let mut product = 0.0;
    for ((value, free), residual) in values.iter_mut().zip(free).zip(residual) {
        if *free {
            *value -= mean;
        }
        product += *value * residual;
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::elements::Dense;
    use crate::problem::{Cells, Grid};

    /// A sphere of radius 1 on 31 by 31 cells of a half-space of compliance 1.
    fn sphere() -> (Dense, Vec<f64>, f64) {
        let grid = Grid::centred(31, 31, 0.01).unwrap();
        let cells = Cells::all(&grid);
        let separation = cells
            .centres()
            .map(|[x, y]| 0.5 * (x * x + y * y))
            .collect();
        (Dense::new(cells, 1.0), separation, grid.cell_area())
    }

    fn press(load: Prescribed, start: Option<&[f64]>) -> ElementContact {
        let (mut operator, separation, area) = sphere();
        solve(
            &mut operator,
            &separation,
            area,
            load,
            start,
            &Settings::default(),
            &CancelToken::default(),
        )
    }

    #[test]
    fn sphere_as_hertz() {
        // Johnson, Contact Mechanics, section 4.2: a^2 = R zeta, F = 4/3 E* sqrt(R) zeta^(3/2).
        let indentation = 0.01;
        let contact = press(Prescribed::Indentation(indentation), None);
        assert_eq!(contact.termination, Termination::Converged);
        let hertz = 4.0 / 3.0 * f64::powf(indentation, 1.5);
        assert!(
            (contact.force / hertz - 1.0).abs() < 5e-3,
            "{}",
            contact.force / hertz
        );
        let area = contact.pressure.iter().filter(|p| **p > 0.0).count() as f64 * 1e-4;
        assert!((area / (std::f64::consts::PI * indentation) - 1.0).abs() < 0.05);
        assert!(contact.pressure.iter().all(|p| *p >= 0.0));
        assert!(contact.certificate.interpenetration < 1e-7 * indentation);
        assert!(contact.certificate.gap_under_pressure < 1e-7 * indentation);
    }

    #[test]
    fn force_and_indentation_belong_together() {
        let first = press(Prescribed::Indentation(0.007), None);
        let second = press(Prescribed::Force(first.force), None);
        assert_eq!(second.termination, Termination::Converged);
        assert!((second.force / first.force - 1.0).abs() < 1e-12);
        assert!((second.indentation / first.indentation - 1.0).abs() < 1e-7);
        let largest = first.pressure.iter().copied().fold(0.0, f64::max);
        for (a, b) in first.pressure.iter().zip(&second.pressure) {
            assert!((a - b).abs() < 1e-3 * largest);
        }
    }

    #[test]
    fn any_start_leads_to_the_same_pressures() {
        let cold = press(Prescribed::Indentation(0.01), None);
        let wild: Vec<f64> = (0..961).map(|k| f64::from(k % 7) - 2.0).collect();
        let warm = press(Prescribed::Indentation(0.01), Some(&wild));
        assert_eq!(warm.termination, Termination::Converged);
        assert!((warm.force / cold.force - 1.0).abs() < 1e-7);
    }

    #[test]
    fn certificate_bounds_the_energy_error() {
        // Compared to a solution with a tolerance smaller by a factor of ten thousand.
        let energy = |contact: &ElementContact| -> f64 {
            let (_, separation, _) = sphere();
            contact
                .pressure
                .iter()
                .zip(&contact.gap)
                .zip(&separation)
                .map(|((p, gap), s)| 0.5 * p * (gap + s - contact.indentation))
                .sum()
        };
        let (mut operator, separation, area) = sphere();
        let mut at = |tolerance| {
            let settings = Settings {
                tolerance,
                ..Settings::default()
            };
            let load = Prescribed::Indentation(0.01);
            let cancel = CancelToken::default();
            solve(
                &mut operator,
                &separation,
                area,
                load,
                None,
                &settings,
                &cancel,
            )
        };
        let exact = at(1e-12);
        for tolerance in [1e-1, 1e-2, 1e-4, 1e-6] {
            let rough = at(tolerance);
            let elastic: f64 = rough
                .pressure
                .iter()
                .zip(&rough.gap)
                .zip(&separation)
                .map(|((p, gap), s)| 0.5 * p * (gap - s + rough.indentation))
                .sum();
            let error = (energy(&rough) - energy(&exact)) / elastic;
            assert!(error <= rough.certificate.energy_bound + 1e-12);
            assert!(error >= -1e-12);
        }
    }

    #[test]
    fn nothing_is_touched_without_indentation() {
        let contact = press(Prescribed::Indentation(0.0), None);
        assert_eq!(contact.termination, Termination::Converged);
        assert!(contact.pressure.iter().all(|p| p.abs() < f64::MIN_POSITIVE));
    }

    /// Mock operator that returns one displacement that is not a number.
    struct Odd(Dense, f64);

    impl Operator for Odd {
        fn len(&self) -> usize {
            self.0.len()
        }

        fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]) {
            self.0.apply(pressure, displacement);
            displacement[7] = self.1;
        }

        fn precondition(&mut self, residual: &[f64], direction: &mut [f64]) {
            self.0.precondition(residual, direction);
        }
    }

    #[test]
    fn undefined_numbers_never_converge() {
        for load in [Prescribed::Indentation(0.01), Prescribed::Force(1e-3)] {
            for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let solve =
                    |operator: &mut dyn Operator, separation: &[f64], start: Option<&[f64]>| {
                        let settings = Settings {
                            product_limit: 100,
                            ..Settings::default()
                        };
                        let cancel = CancelToken::default();
                        let contact =
                            solve(operator, separation, 1e-4, load, start, &settings, &cancel);
                        contact.termination
                    };
                // Under the lens, and far from it, where nothing is touched.
                for element in [480, 0] {
                    let (mut operator, mut separation, _) = sphere();
                    separation[element] = odd;
                    let ended = solve(&mut operator, &separation, None);
                    assert_ne!(ended, Termination::Converged, "{load:?} {odd}");
                    let (mut operator, separation, _) = sphere();
                    let mut start = vec![1.0; separation.len()];
                    start[element] = odd;
                    let ended = solve(&mut operator, &separation, Some(start.as_slice()));
                    // Negative initial pressures are set to zero.
                    assert!(
                        odd < 0.0 || ended == Termination::NotFinite,
                        "{load:?} {odd}"
                    );
                }
                let (operator, separation, _) = sphere();
                let ended = solve(&mut Odd(operator, odd), &separation, None);
                assert_ne!(ended, Termination::Converged, "{load:?} {odd}");
            }
        }
        for load in [
            Prescribed::Indentation(f64::NAN),
            Prescribed::Force(f64::NAN),
        ] {
            assert_eq!(press(load, None).termination, Termination::NotFinite);
        }
    }

    #[test]
    fn stops_when_cancelled() {
        let (mut operator, separation, area) = sphere();
        let cancel = CancelToken::default();
        cancel.cancel();
        let contact = solve(
            &mut operator,
            &separation,
            area,
            Prescribed::Indentation(0.01),
            None,
            &Settings::default(),
            &cancel,
        );
        assert_eq!(contact.termination, Termination::Interrupted);
    }

    #[test]
    fn reports_that_it_did_not_converge() {
        let (mut operator, separation, area) = sphere();
        let settings = Settings {
            product_limit: 3,
            ..Settings::default()
        };
        let load = Prescribed::Force(1e-3);
        let cancel = CancelToken::default();
        let contact = solve(
            &mut operator,
            &separation,
            area,
            load,
            None,
            &settings,
            &cancel,
        );
        assert_eq!(contact.termination, Termination::IterationLimit);
        assert!(contact.certificate.energy_bound > settings.tolerance);
    }
}
