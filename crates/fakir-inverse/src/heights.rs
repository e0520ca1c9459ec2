//! Heights of rounded tops for a target curve: area over force, force over indentation, or area over indentation.
//!
//! The search starts from heights for asperities without interactions. They follow an exponential distribution, for which the area is proportional to the force (J. A. Greenwood
//! and J. B. P. Williamson, Proc. R. Soc. Lond. A 295, 300 (1966)), truncated so that every asperity is in contact under the largest load, because an asperity without contact does
//! not affect the curve. They are assigned to the positions at random. Least squares on the relative differences at all loads adapts them to the target curve, first
//! without interactions, in closed form, then with interactions and the exact derivatives of every contact. Caps that are not in contact under the largest load are raised
//! until they are. If a search ends before the curve is met, others follow from more random heights, and the closest result is returned. There are usually fewer loads
//! than asperities: of all equivalent changes the smallest is made.

use chacha20::ChaCha12Rng;
use chacha20::rand_core::{Rng, SeedableRng};
use fakir::numerics::dense::{Lu, Matrix};
use fakir::problem::{Accuracy, Asperity, AsperityArray, InvalidAsperities, Load};
use fakir::state::{AsperityContact, Run, SolveError};
use std::f64::consts::PI;

/// Largest number of least-squares steps, for independent asperities and with interactions.
const INDEPENDENT_STEPS: usize = 200;
const STEPS: usize = 60;

/// Largest number of searches, and number of starts of each for independent asperities.
const SEARCHES: usize = 4;
const STARTS: usize = 16;

/// Number of previous sums of squares with which a step is compared.
const MEMORY: usize = 4;

/// Smallest damping, relative to the largest square of a gradient.
const LEAST_DAMPING: f64 = 1e-12;

/// Largest relative differences at which the search ends, and at which the curve counts as met.
const EXACT: f64 = 1e-8;
const REACHED: f64 = 1e-5;

/// Relative decrease of the sum of squares that is required within a number of steps.
const WORTHWHILE: f64 = 1e-2;
const PATIENCE: usize = 4;

/// Largest number of times that asperities without contact are raised.
const LIFTS: usize = 8;

/// Fractions of the largest overlap: limit of the change of a height in the first step, and distance by which an asperity is
/// raised beyond contact.
const FIRST_STEP: f64 = 0.05;
const LIFTED: f64 = 0.02;

/// Fraction of the largest load at which the last asperity of the start comes into contact.
const TOUCHED_AT: f64 = 0.9;

/// For exponential heights of scale `s`, the area over the force, times the reduced modulus, is `sqrt(pi
/// rho/s)`.
const EXPONENTIAL: f64 = PI;

/// Largest relative change of the area under a force due to interactions.
const INTERACTIONS: f64 = 0.05;

/// Kind of target curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Curve {
    /// Area (m^2) over force (N).
    AreaOfForce,
    /// Force (N) over indentation (m), which is measured from the common level.
    ForceOfIndentation,
    /// Area (m^2) over indentation (m).
    AreaOfIndentation,
}

impl Curve {
    /// Prescribed load: `"force"` or `"indentation"`.
    #[must_use]
    pub fn load_name(self) -> &'static str {
        match self {
            Self::AreaOfForce => "force",
            Self::ForceOfIndentation | Self::AreaOfIndentation => "indentation",
        }
    }

    /// Target quantity: `"area"` or `"force"`.
    #[must_use]
    pub fn value_name(self) -> &'static str {
        match self {
            Self::AreaOfForce | Self::AreaOfIndentation => "area",
            Self::ForceOfIndentation => "force",
        }
    }

    /// Description: `"area of the force"`.
    #[must_use]
    pub fn words(self) -> String {
        format!("{} of the {}", self.value_name(), self.load_name())
    }

    /// Prescribed load.
    #[must_use]
    pub fn control(self, load: f64) -> Load {
        match self {
            Self::AreaOfForce => Load::Force(load),
            Self::ForceOfIndentation | Self::AreaOfIndentation => Load::Indentation(load),
        }
    }

    /// The value of a contact.
    #[must_use]
    pub fn value(self, contact: &AsperityContact) -> f64 {
        match self {
            Self::AreaOfForce | Self::AreaOfIndentation => contact.area,
            Self::ForceOfIndentation => contact.force,
        }
    }
}

/// A load with its target value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WantedPoint {
    /// Force (N) or indentation (m).
    pub load: f64,
    /// Area (m^2) or force (N).
    pub value: f64,
}

/// Designed heights and their values.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightDesign {
    /// Height of every asperity above the common level, m. For area over force, where a common shift has no effect, the highest asperity is on that
    /// level.
    pub heights: Vec<f64>,
    /// Values at every load.
    pub points: Vec<DesignedPoint>,
    /// Number of least-squares steps with interactions.
    pub rounds: usize,
}

/// A load of a design.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesignedPoint {
    /// Target.
    pub wanted: WantedPoint,
    /// Value of the designed heights.
    pub value: f64,
    /// Value, with interactions, of heights that are designed without interactions.
    pub of_independent_design: f64,
    /// Value of these heights in the model without interactions.
    pub independent: f64,
    /// Number of asperities in contact.
    pub touched: usize,
    /// Root of the sum of squares of the derivatives of the value with respect to all heights, m^2/m or N/m: standard deviation of the value per standard
    /// deviation of independent height errors.
    pub with_heights: f64,
}

impl DesignedPoint {
    /// Relative standard deviation of the value if all heights have independent errors of the given standard deviation (m). The errors must be so
    /// small that no asperity comes into contact or detaches.
    #[must_use]
    pub fn scatter(&self, height_error: f64) -> f64 {
        self.with_heights * height_error / self.value
    }

    /// Relative difference of the value from the target.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.value / self.wanted.value - 1.0
    }
}

impl HeightDesign {
    /// Largest relative difference from the target.
    #[must_use]
    pub fn largest_residual(&self) -> f64 {
        let residuals = self.points.iter().map(|point| point.residual().abs());
        residuals.fold(0.0, f64::max)
    }

    /// Root mean square of the relative differences.
    #[must_use]
    pub fn rms_residual(&self) -> f64 {
        let squares = self.points.iter().map(|point| point.residual().powi(2));
        (squares.sum::<f64>() / self.points.len() as f64).sqrt()
    }

    /// Whether the curve is met at all loads, to 1e-5. Otherwise these are the closest heights found: the target curve is unattainable with these asperities.
    #[must_use]
    pub fn is_reached(&self) -> bool {
        self.largest_residual() <= REACHED
    }

    /// Number of asperities that are in contact at some load.
    #[must_use]
    pub fn touched(&self) -> usize {
        let touched = self.points.iter().map(|point| point.touched);
        touched.max().unwrap_or(0)
    }

    /// Result as a sentence.
    #[must_use]
    pub fn verdict(&self) -> String {
        let largest = 100.0 * self.largest_residual();
        if self.is_reached() {
            return format!("the curve is met to {largest:.1e} % at every load");
        }
        let rms = 100.0 * self.rms_residual();
        format!(
            "the curve is out of reach of these asperities: the nearest found is off by {rms:.2} % (root of the mean square) and {largest:.2} % at most"
        )
    }
}

/// Errors of a design of heights.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HeightDesignError {
    /// No loads, or loads or values that are not positive, not finite, or not in increasing order.
    #[error(
        "point {number} (counted from 0) of the target curve is a load of {load} and a value of {value}: loads and values must be finite and above 0, and \
         loads must increase"
    )]
    WantedPoint {
        /// Index of the load.
        number: usize,
        /// Load, N or m.
        load: f64,
        /// Value, m^2 or N.
        value: f64,
    },
    /// No target.
    #[error("the target curve has no points: give at least one")]
    NoPoints,
    /// A curve that does not increase.
    #[error(
        "the target {} does not increase from {before:e} to {value:e} between the {} {from:e} and {load:e} (SI units): contacts only \
         grow with the load; give a curve that increases slightly there", .curve.value_name(), .curve.load_name()
    )]
    Falls {
        /// Which curve.
        curve: Curve,
        /// Index of the second of the two points, from 0.
        number: usize,
        /// The load before.
        from: f64,
        /// The value before.
        before: f64,
        /// The load.
        load: f64,
        /// The value, which is not larger.
        value: f64,
    },
    /// An area under a force that is unattainable with these asperities for any heights.
    #[error(
        "an area of {value:e} m^2 under a force of {load:e} N is unattainable: for any heights, the area of these {asperities} asperities is from \
         {least:.4e} m^2, if one carries the load, to {most:.4e} m^2, if all carry the same; change the radius of curvature, \
         the number of asperities or the modulus"
    )]
    AreaOutOfReach {
        /// Index of the point, from 0.
        number: usize,
        /// Its force, N.
        load: f64,
        /// The target area, m^2.
        value: f64,
        /// Number of asperities.
        asperities: usize,
        /// Smallest possible area, m^2.
        least: f64,
        /// Largest possible area, m^2.
        most: f64,
    },
    /// Heights that are not finite.
    #[error(transparent)]
    Caps(#[from] InvalidAsperities),
    /// The start cannot be solved.
    #[error("the heights that independent asperities would need cannot be solved: {0}")]
    Start(#[source] SolveError),
    /// The computation was cancelled.
    #[error("interrupted")]
    Interrupted,
}

/// Finds heights of the asperities of a field for a target curve. The given heights are ignored. The assignment of heights to positions, which affects the result by about
/// one per cent, is random with a seed.
///
/// # Errors
/// See [`HeightDesignError`]. An unattainable curve is not an error: see
/// [`HeightDesign::is_reached`].
pub fn design_heights(
    field: &AsperityArray,
    curve: Curve,
    wanted: &[WantedPoint],
    seed: u64,
    run: &Run<'_>,
) -> Result<HeightDesign, HeightDesignError> {
    check(curve, wanted)?;
    let independent = Independent::new(field, curve);
    independent.check_areas(wanted)?;
    let mut random = ChaCha12Rng::seed_from_u64(seed);
    let mut best: Option<Search<'_>> = None;
    let mut first_error = None;
    let mut rounds = 0;
    for number in 0..SEARCHES {
        let (alone, overlap) = independent.design(wanted, number > 0, &mut random, run)?;
        let mut solver = Interacting {
            field,
            curve,
            wanted,
            last: Vec::new(),
            run,
        };
        let rows = match solver.rows(&alone.heights)? {
            Ok(rows) => rows,
            Err(error) => {
                first_error.get_or_insert(error);
                continue;
            }
        };
        let of_independent_design = rows.iter().map(|row| row.value).collect();
        let designed = Fitted::new(wanted, alone.heights.clone(), rows);
        let designed =
            designed.least_squares(STEPS, overlap, |heights| Ok(solver.rows(heights)?.ok()))?;
        rounds += designed.rounds;
        let search = Search {
            alone,
            of_independent_design,
            designed,
        };
        if best
            .as_ref()
            .is_none_or(|best| search.designed.sum() < best.designed.sum())
        {
            best = Some(search);
        }
        let is_found = |search: &Search<'_>| search.designed.largest() <= REACHED;
        if best.as_ref().is_some_and(is_found) {
            break;
        }
    }
    let Some(Search {
        alone,
        of_independent_design,
        designed,
    }) = best
    else {
        let error = first_error.unwrap_or(SolveError::NotFinite { what: "contact" });
        return Err(HeightDesignError::Start(error));
    };
    let points = (0..wanted.len()).map(|k| DesignedPoint {
        wanted: wanted[k],
        value: designed.rows[k].value,
        of_independent_design: of_independent_design[k],
        independent: alone.rows[k].value,
        touched: designed.rows[k].touched,
        with_heights: {
            let squares = designed.rows[k].slopes.iter().map(|slope| slope * slope);
            squares.sum::<f64>().sqrt()
        },
    });
    let mut heights = designed.heights;
    if curve == Curve::AreaOfForce {
        // A common shift has no effect: the highest asperity defines the common level.
        let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        heights.iter_mut().for_each(|height| *height -= highest);
    }
    Ok(HeightDesign {
        points: points.collect(),
        heights,
        rounds,
    })
}

/// One search: heights for independent asperities, their values with interactions, and the heights found from there.
struct Search<'a> {
    alone: Fitted<'a>,
    of_independent_design: Vec<f64>,
    designed: Fitted<'a>,
}

fn check(curve: Curve, wanted: &[WantedPoint]) -> Result<(), HeightDesignError> {
    if wanted.is_empty() {
        return Err(HeightDesignError::NoPoints);
    }
    let mut before = 0.0;
    let mut last = WantedPoint {
        load: 0.0,
        value: 0.0,
    };
    for (number, WantedPoint { load, value }) in wanted.iter().copied().enumerate() {
        let possible = load > before && load.is_finite() && value > 0.0 && value.is_finite();
        if !possible {
            return Err(HeightDesignError::WantedPoint {
                number,
                load,
                value,
            });
        }
        if value <= last.value {
            return Err(HeightDesignError::Falls {
                curve,
                number,
                from: last.load,
                before: last.value,
                load,
                value,
            });
        }
        last = WantedPoint { load, value };
        before = load;
    }
    Ok(())
}

/// Value at a load, with its derivatives.
struct Row {
    value: f64,
    slopes: Vec<f64>,
    touched: usize,
    /// Gaps of the asperities without contact, m.
    gaps: Vec<f64>,
}

/// Heights with their values.
struct Fitted<'a> {
    wanted: &'a [WantedPoint],
    heights: Vec<f64>,
    rows: Vec<Row>,
    rounds: usize,
}

impl<'a> Fitted<'a> {
    fn new(wanted: &'a [WantedPoint], heights: Vec<f64>, rows: Vec<Row>) -> Self {
        Self {
            wanted,
            heights,
            rows,
            rounds: 0,
        }
    }

    fn residuals(wanted: &[WantedPoint], rows: &[Row]) -> Vec<f64> {
        let pairs = rows.iter().zip(wanted);
        pairs
            .map(|(row, wanted)| row.value / wanted.value - 1.0)
            .collect()
    }

    fn sum(&self) -> f64 {
        let residuals = Self::residuals(self.wanted, &self.rows);
        residuals.iter().map(|residual| residual * residual).sum()
    }

    fn largest(&self) -> f64 {
        let residuals = Self::residuals(self.wanted, &self.rows);
        residuals
            .iter()
            .fold(0.0, |most, residual| residual.abs().max(most))
    }

    fn is_exact(&self) -> bool {
        self.largest() <= EXACT
    }

    /// Minimises the residuals. When they no longer decrease, asperities without contact are raised, if there are any, and the search continues; the best result
    /// is returned. `rows` are the rows of the initial heights, if they are known.
    fn least_squares(
        mut self,
        steps: usize,
        overlap: f64,
        mut rows: impl FnMut(&[f64]) -> Result<Option<Vec<Row>>, HeightDesignError>,
    ) -> Result<Self, HeightDesignError> {
        let mut rounds = 0;
        self.descend(steps, overlap, &mut rows)?;
        rounds += self.rounds;
        let mut last = self.lifted(overlap);
        for _ in 0..LIFTS {
            let Some(heights) = last.take().filter(|_| !self.is_exact()) else {
                break;
            };
            let Some(found) = rows(&heights)? else {
                break;
            };
            let mut lifted = Self::new(self.wanted, heights, found);
            lifted.descend(steps, overlap, &mut rows)?;
            rounds += lifted.rounds;
            last = lifted.lifted(overlap);
            if lifted.sum() < self.sum() {
                self = lifted;
            }
        }
        self.rounds = rounds;
        Ok(self)
    }

    /// Gauss-Newton method with a trust region. The area has a kink where an asperity comes into contact, so that a step may have to increase the sum of squares to pass it: a
    /// step is accepted if the sum is below those of a few previous steps.
    fn descend(
        &mut self,
        steps: usize,
        overlap: f64,
        rows: &mut impl FnMut(&[f64]) -> Result<Option<Vec<Row>>, HeightDesignError>,
    ) -> Result<(), HeightDesignError> {
        let mut trusted = FIRST_STEP * overlap;
        let mut sums = [f64::INFINITY; MEMORY];
        let mut here = Self::new(
            self.wanted,
            self.heights.clone(),
            std::mem::take(&mut self.rows),
        );
        sums[0] = here.sum();
        let mut since_best = 0;
        let mut best: Option<Self> = None;
        let mut number = 0;
        while number < steps && since_best < PATIENCE && !here.is_exact() {
            number += 1;
            let before = here.sum();
            let Some((step, predicted)) = here.step(trusted) else {
                break;
            };
            let next = here.heights.iter().zip(&step).map(|(h, d)| h + d);
            let next: Vec<f64> = next.collect();
            let largest = step
                .iter()
                .fold(0.0_f64, |most, value| most.max(value.abs()));
            since_best += 1;
            let Some(found) = rows(&next)? else {
                trusted = 0.25 * largest;
                continue;
            };
            let next = Self::new(self.wanted, next, found);
            let after = next.sum();
            let gain = (before - after) / (before - predicted);
            if gain < 0.25 {
                trusted = 0.25 * largest;
            } else if gain > 0.75 {
                trusted = trusted.max(2.0 * largest);
            }
            let highest = sums.iter().copied().filter(|sum| sum.is_finite());
            if after < highest.fold(before, f64::max) {
                let left = std::mem::replace(&mut here, next);
                if best.as_ref().is_none_or(|best| left.sum() < best.sum()) {
                    best = Some(left);
                }
                if best
                    .as_ref()
                    .is_none_or(|best| after < (1.0 - WORTHWHILE) * best.sum())
                {
                    since_best = 0;
                }
                sums.rotate_right(1);
                sums[0] = after;
            }
        }
        let best = best.filter(|best| best.sum() < here.sum()).unwrap_or(here);
        (self.heights, self.rows) = (best.heights, best.rows);
        self.rounds += number;
        Ok(())
    }

    /// Smallest changes that remove the residuals within the trust region, and the remaining sum of squares in linear approximation.
    fn step(&self, trusted: f64) -> Option<(Vec<f64>, f64)> {
        let residuals = Self::residuals(self.wanted, &self.rows);
        let slope =
            |k: usize, asperity: usize| self.rows[k].slopes[asperity] / self.wanted[k].value;
        let (count, asperities) = (residuals.len(), self.heights.len());
        let slopes = Matrix::from_fn(count, asperities, slope);
        let transposed = slopes.transposed();
        let matrix = &slopes * &transposed;
        let most = (0..count).map(|k| matrix[(k, k)]).fold(0.0, f64::max);
        let mut damping = LEAST_DAMPING;
        while damping < 1e9 {
            let mut damped = matrix.clone();
            for k in 0..count {
                damped[(k, k)] += damping * most;
            }
            let mut weights: Vec<f64> = residuals.iter().map(|residual| -residual).collect();
            Lu::new(damped).solve(&mut weights);
            let step = transposed.times(&weights);
            if step.iter().all(|change| change.abs() <= trusted) {
                let changes = slopes.times(&step);
                let left = residuals.iter().zip(changes);
                let left = left.map(|(residual, change)| (residual + change).powi(2));
                let left = left.sum();
                return Some((step, left));
            }
            damping *= 3.0;
        }
        None
    }

    /// Raises the asperities that are not in contact under the largest load, if there are any.
    fn lifted(&self, overlap: f64) -> Option<Vec<f64>> {
        let last = self.rows.last()?;
        let away = |gap: &f64| *gap > 0.0;
        last.gaps.iter().any(away).then(|| {
            let pairs = self.heights.iter().zip(&last.gaps);
            pairs
                .map(|(height, gap)| {
                    if away(gap) {
                        height + gap + LIFTED * overlap
                    } else {
                        *height
                    }
                })
                .collect()
        })
    }
}

/// Caps with interactions.
struct Interacting<'a> {
    field: &'a AsperityArray,
    curve: Curve,
    wanted: &'a [WantedPoint],
    /// Last contact at every load.
    last: Vec<AsperityContact>,
    run: &'a Run<'a>,
}

impl Interacting<'_> {
    fn rows(&mut self, heights: &[f64]) -> Result<Result<Vec<Row>, SolveError>, HeightDesignError> {
        let field = self.field.with_heights(heights)?;
        let mut contacts: Vec<AsperityContact> = Vec::with_capacity(self.wanted.len());
        for (number, wanted) in self.wanted.iter().enumerate() {
            let control = self.curve.control(wanted.load);
            let near = self.last.get(number).or(contacts.last());
            let contact = field.press_quickly(control, Accuracy::Default, near, self.run);
            match contact {
                // A solution that did not converge has no value.
                Ok(contact) if !contact.converged() => {
                    return Ok(Err(SolveError::NotFinite { what: "contact" }));
                }
                Ok(contact) => contacts.push(contact),
                Err(SolveError::Interrupted) => return Err(HeightDesignError::Interrupted),
                Err(other) => return Ok(Err(other)),
            }
        }
        let rows = contacts.iter().map(|contact| self.row(contact)).collect();
        self.last = contacts;
        Ok(Ok(rows))
    }

    fn row(&self, contact: &AsperityContact) -> Row {
        let slopes = &contact.slopes;
        let asperities = 0..contact.asperities.len();
        let slopes = match self.curve {
            Curve::AreaOfForce => asperities
                .map(|asperity| slopes.area_with_height_at_force(asperity))
                .collect(),
            Curve::ForceOfIndentation => slopes.force_with_height.clone(),
            Curve::AreaOfIndentation => slopes.area_with_height.clone(),
        };
        Row {
            value: self.curve.value(contact),
            slopes,
            touched: contact.touched(),
            gaps: contact
                .asperities
                .iter()
                .map(|asperity| asperity.gap)
                .collect(),
        }
    }
}

/// Caps without interactions: each is a Hertz contact.
struct Independent {
    curve: Curve,
    modulus: f64,
    asperities: Vec<Lone>,
}

/// A single asperity.
struct Lone {
    /// Height of the lens above it relative to its axis, m.
    sunk: f64,
    /// Sum of its curvature and that of the lens, 1/m.
    curvature: f64,
    /// m/N
    compliance: f64,
}

/// Force and area of an asperity with their derivatives.
type Pressed = [[f64; 2]; 2];

impl Lone {
    fn new(field: &AsperityArray, asperity: &Asperity) -> Self {
        Self {
            sunk: field.level_of_touch(asperity),
            curvature: field.relative_curvature(asperity),
            compliance: asperity.column_compliance,
        }
    }

    /// Values at an overlap with the undeformed lens.
    fn pressed(&self, overlap: f64, modulus: f64) -> Pressed {
        if overlap <= 0.0 {
            return [[0.0; 2]; 2];
        }
        let hertz = |depth: f64| {
            let root = (depth / self.curvature).sqrt();
            [4.0 / 3.0 * modulus * depth * root, 2.0 * modulus * root]
        };
        // Newton's method from above, on a convex function.
        let mut depth = overlap;
        for _ in 0..60 {
            let [force, stiffness] = hertz(depth);
            let step =
                (depth + self.compliance * force - overlap) / (1.0 + self.compliance * stiffness);
            depth -= step;
            if step <= 1e-15 * depth {
                break;
            }
        }
        let [force, stiffness] = hertz(depth);
        let of_overlap = (1.0 + self.compliance * stiffness).recip();
        let area = PI / self.curvature;
        [
            [force, stiffness * of_overlap],
            [area * depth, area * of_overlap],
        ]
    }
}

impl Independent {
    fn new(field: &AsperityArray, curve: Curve) -> Self {
        Self {
            curve,
            modulus: field.reduced_modulus(),
            asperities: field
                .asperities()
                .iter()
                .map(|asperity| Lone::new(field, asperity))
                .collect(),
        }
    }

    /// Refuses areas that are unattainable under a force. Without interactions the area on an asperity is `pi (3 F_n/(4 E* k_n))^(2/3)` (Hertz). The sum of
    /// these areas is largest if the forces are proportional to `k_n^-2`, and smallest if the asperity with the largest curvature carries the whole load.
    /// Interactions change them by some per cent.
    fn check_areas(&self, wanted: &[WantedPoint]) -> Result<(), HeightDesignError> {
        if self.curve != Curve::AreaOfForce {
            return Ok(());
        }
        let curvatures = || self.asperities.iter().map(|asperity| asperity.curvature);
        let sharpest = curvatures().fold(0.0, f64::max);
        let widest: f64 = curvatures().map(|curvature| curvature.powi(-2)).sum();
        for (number, WantedPoint { load, value }) in wanted.iter().copied().enumerate() {
            let of_one = PI * (0.75 * load / self.modulus).powf(2.0 / 3.0);
            let least = of_one * sharpest.powf(-2.0 / 3.0);
            let most = of_one * widest.cbrt();
            if value < (1.0 - INTERACTIONS) * least || value > (1.0 + INTERACTIONS) * most {
                return Err(HeightDesignError::AreaOutOfReach {
                    number,
                    load,
                    value,
                    asperities: self.asperities.len(),
                    least,
                    most,
                });
            }
        }
        Ok(())
    }

    fn total(&self, overlaps: impl Iterator<Item = f64>) -> Pressed {
        let mut total = [[0.0; 2]; 2];
        for (asperity, overlap) in self.asperities.iter().zip(overlaps) {
            let pressed = asperity.pressed(overlap, self.modulus);
            for (total, pressed) in total.iter_mut().flatten().zip(pressed.iter().flatten()) {
                *total += pressed;
            }
        }
        total
    }

    /// Heights for asperities without interactions, and the largest overlap under the largest load, m: the first exact ones, or the closest of several starts. If
    /// the first start is random, all are.
    fn design<'w>(
        &self,
        wanted: &'w [WantedPoint],
        at_random: bool,
        random: &mut ChaCha12Rng,
        run: &Run<'_>,
    ) -> Result<(Fitted<'w>, f64), HeightDesignError> {
        let by_itself = |heights: &[f64]| {
            if run.cancel.is_cancelled() {
                return Err(HeightDesignError::Interrupted);
            }
            Ok(Some(self.rows(wanted, heights)))
        };
        let mut best: Option<(Fitted<'w>, f64)> = None;
        for number in 0..STARTS {
            let (start, overlap) = self.start(wanted, at_random || number > 0, random);
            let rows = self.rows(wanted, &start);
            let found = Fitted::new(wanted, start, rows);
            let found = found.least_squares(INDEPENDENT_STEPS, overlap, by_itself)?;
            let is_exact = found.is_exact();
            if best
                .as_ref()
                .is_none_or(|(best, _)| found.sum() < best.sum())
            {
                best = Some((found, overlap));
            }
            if is_exact {
                break;
            }
        }
        best.ok_or(HeightDesignError::NoPoints)
    }

    /// Initial heights, and the largest overlap under the largest load, m.
    fn start(
        &self,
        wanted: &[WantedPoint],
        at_random: bool,
        random: &mut ChaCha12Rng,
    ) -> (Vec<f64>, f64) {
        let count = self.asperities.len();
        let mut shift = || {
            if at_random {
                (random.next_u64() >> 11) as f64 * 2f64.powi(-53)
            } else {
                0.5
            }
        };
        // From half the slope to twice the slope.
        let steepness = 4f64.powf(shift() - 0.5);
        let places: Vec<f64> = (0..count)
            .map(|k| (k as f64 + shift()) / count as f64)
            .collect();
        let places = places.into_iter();
        let last = wanted[wanted.len() - 1];
        let (depths, overlap): (Vec<f64>, f64) = match self.curve {
            Curve::AreaOfForce => {
                let ratios = wanted.iter().map(|point| point.value / point.load);
                let ratio = self.modulus * ratios.sum::<f64>() / wanted.len() as f64;
                let radii = self
                    .asperities
                    .iter()
                    .map(|asperity| asperity.curvature.recip());
                let radius = radii.sum::<f64>() / count as f64;
                let scale = steepness * EXPONENTIAL * radius / (ratio * ratio);
                let depths = |most: f64| -> Vec<f64> {
                    let all = (most / scale).exp_m1();
                    places.clone().map(|u| scale * (u * all).ln_1p()).collect()
                };
                // As deep as the load requires.
                let force = |most: f64| {
                    let overlaps = depths(most).into_iter().map(|depth| most - depth);
                    self.total(overlaps)[0][0]
                };
                let (mut low, mut high) = (0.0, scale);
                while force(high) < TOUCHED_AT * last.load && high < 500.0 * scale {
                    high *= 2.0;
                }
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if force(middle) < TOUCHED_AT * last.load {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                (depths(high), high)
            }
            Curve::ForceOfIndentation | Curve::AreaOfIndentation => {
                let deepest = TOUCHED_AT * last.load;
                let power = 2.0 * steepness;
                (places.map(|u| deepest * u.powf(power)).collect(), last.load)
            }
        };
        let mut order: Vec<usize> = (0..count).collect();
        for k in (1..count).rev() {
            order.swap(k, (random.next_u64() % (k as u64 + 1)) as usize);
        }
        let heights = self.asperities.iter().zip(order);
        let heights = heights.map(|(asperity, place)| asperity.sunk - depths[place]);
        (heights.collect(), overlap)
    }

    fn rows(&self, wanted: &[WantedPoint], heights: &[f64]) -> Vec<Row> {
        let mut indentation = f64::NEG_INFINITY;
        let tops = self.asperities.iter().zip(heights);
        let tops: Vec<f64> = tops
            .map(|(asperity, height)| height - asperity.sunk)
            .collect();
        let highest = tops.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let rows = wanted.iter().map(|point| {
            indentation = match self.curve {
                Curve::AreaOfForce => self.lowered(&tops, point.load, indentation.max(-highest)),
                Curve::ForceOfIndentation | Curve::AreaOfIndentation => point.load,
            };
            let overlaps = tops.iter().map(|top| indentation + top);
            let [force, area] = self.total(overlaps.clone());
            let pressed = self.asperities.iter().zip(overlaps.clone());
            let slopes = pressed.map(|(asperity, overlap)| {
                let [of_force, of_area] =
                    asperity.pressed(overlap, self.modulus).map(|part| part[1]);
                match self.curve {
                    Curve::AreaOfForce if force[1] > 0.0 => of_area - area[1] / force[1] * of_force,
                    Curve::AreaOfForce => 0.0,
                    Curve::ForceOfIndentation => of_force,
                    Curve::AreaOfIndentation => of_area,
                }
            });
            Row {
                value: match self.curve {
                    Curve::ForceOfIndentation => force[0],
                    Curve::AreaOfForce | Curve::AreaOfIndentation => area[0],
                },
                slopes: slopes.collect(),
                touched: overlaps.clone().filter(|overlap| *overlap > 0.0).count(),
                gaps: overlaps.map(|overlap| (-overlap).max(0.0)).collect(),
            }
        });
        rows.collect()
    }

    /// Indentation under a force, starting from a smaller one.
    fn lowered(&self, tops: &[f64], load: f64, from: f64) -> f64 {
        let force = |indentation: f64| self.total(tops.iter().map(|top| indentation + top))[0];
        let (mut low, mut step) = (from, self.asperities[0].curvature.recip() * 1e-6);
        while force(low + step)[0] < load {
            low += step;
            step *= 2.0;
        }
        // Newton's method converges from above.
        let mut indentation = low + step;
        for _ in 0..100 {
            let [value, slope] = force(indentation);
            let change = (value - load) / slope;
            indentation -= change;
            if change.abs() <= 1e-15 * step || value <= load {
                break;
            }
        }
        indentation
    }
}
