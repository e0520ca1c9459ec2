//! Correction for layers between discs of any radii, and around them.
//!
//! The correction around a force is analytic, with branch points at the distance `2i t` from the real axis. A pressure on a disc is therefore
//! replaced by forces at the points of a rule on the hemisphere: the error decreases exponentially with their number, faster for discs
//! that are smaller relative to the thickness or to their distance. Blocks between discs are sums over the points of both rules, and so is the effect of a
//! disc on itself.

use super::force::AroundForce;
use crate::halfspace::disc::basis::mode_count;
use crate::halfspace::disc::mode_rule::ModeRule;
use crate::halfspace::jet::FieldJet;
use crate::problem::Point;
use crate::problem::layer::WeightedLayer;
use std::f64::consts::PI;
use std::sync::Arc;

/// Degrees of the polynomials in the offset of two points for which there are rules.
const DEGREES: [usize; 5] = [5, 9, 13, 21, 33];

/// Relative size of the neglected terms of the correction.
const TOLERANCE: f64 = 1e-9;

/// Exact for modes times polynomials of these degrees.
fn exact_rule(modes: usize, polynomial: usize) -> ModeRule {
    let sum = modes + polynomial + 1;
    ModeRule::new(modes, sum.div_ceil(4), sum)
}

/// The correction for layers of discs with modes up to a degree.
#[derive(Debug, Clone)]
pub(crate) struct LayeredDiscs {
    around: Arc<AroundForce>,
    modes: usize,
    rules: Vec<ModeRule>,
}

/// Sums for every mode of a source at a point of the receiver.
struct AtPoint {
    value: Vec<f64>,
    gradient: [Vec<f64>; 2],
    /// Derivative with respect to the radius of the source.
    by_source: Vec<f64>,
}

impl LayeredDiscs {
    pub(crate) fn new(around: Arc<AroundForce>, degree: usize) -> Self {
        Self {
            around,
            modes: mode_count(degree),
            rules: DEGREES.map(|of| exact_rule(degree, of)).into(),
        }
    }

    /// The rule for offsets of points up to a fraction of the distance from the branch points.
    fn rule(&self, part: f64) -> &ModeRule {
        let is_enough = |degree: &usize| part.powi(*degree as i32 + 1) < TOLERANCE;
        let place = DEGREES.iter().position(is_enough);
        &self.rules[place.unwrap_or(DEGREES.len() - 1)]
    }

    /// Adds the correction to a block by rows, and to its derivatives with respect to the offset of the receiver from the source along x and y, to the radius
    /// of the receiver, and to that of the source.
    pub(crate) fn add(
        &self,
        offset: Point,
        [receiver, source]: [f64; 2],
        block: &mut [f64],
        slopes: &mut [Vec<f64>; 4],
    ) {
        let count = self.modes;
        let distance = self.around.smoothness(offset[0].hypot(offset[1]));
        let rule = self.rule((receiver + source) / distance);
        let zero = || vec![0.0; count];
        let mut sums = AtPoint {
            value: zero(),
            gradient: [zero(), zero()],
            by_source: zero(),
        };
        let [along_x, along_y, of_receiver, of_source] = slopes;
        for (point, row) in rule.rows() {
            let from = [0, 1].map(|k| offset[k] + receiver * point[k]);
            self.fill_at(rule, from, source, &mut sums);
            for (line, weight) in row.iter().enumerate() {
                let weight = weight / PI;
                let line = line * count;
                for column in 0..count {
                    let place = line + column;
                    let [x, y] = [0, 1].map(|k| sums.gradient[k][column]);
                    block[place] += weight * sums.value[column];
                    along_x[place] += weight * x;
                    along_y[place] += weight * y;
                    of_receiver[place] += weight * (x * point[0] + y * point[1]);
                    of_source[place] += weight * sums.by_source[column];
                }
            }
        }
    }

    fn fill_at(&self, rule: &ModeRule, [x, y]: Point, source: f64, sums: &mut AtPoint) {
        let AtPoint {
            value,
            gradient: [along_x, along_y],
            by_source,
        } = sums;
        for all in [&mut *value, along_x, along_y, by_source] {
            all.fill(0.0);
        }
        for (point, row) in rule.rows() {
            let [u, v] = [x - source * point[0], y - source * point[1]];
            let [at, slope] = self.around.value_and_slope(u.hypot(v));
            let [u, v] = [slope * u, slope * v];
            let outwards = -(u * point[0] + v * point[1]);
            for (mode, weight) in row.iter().enumerate() {
                value[mode] += weight * at;
                along_x[mode] += weight * u;
                along_y[mode] += weight * v;
                by_source[mode] += weight * outwards;
            }
        }
    }

    /// The forces that replace the pressure with these moments on a disc, divided by pi.
    fn forces(&self, (centre, radius): (Point, f64), moments: &[f64]) -> Vec<(Point, f64)> {
        let rule = self.rule(radius / self.around.smoothness(0.0));
        let force = |(point, row): (&Point, &[f64])| {
            let force: f64 = row.iter().zip(moments).map(|(w, m)| w * m).sum();
            ([0, 1].map(|k| centre[k] + radius * point[k]), force / PI)
        };
        rule.rows().map(force).collect()
    }
}

/// Correction of the displacement by pressures on discs.
#[derive(Debug, Clone)]
pub(crate) struct LayerField {
    around: Arc<AroundForce>,
    forces: Vec<(Point, f64)>,
}

impl LayerField {
    /// Of discs with their centres, radii and moments of the modes up to a degree.
    pub(crate) fn of_discs<'m>(
        around: &Arc<AroundForce>,
        degree: usize,
        discs: impl Iterator<Item = ((Point, f64), &'m [f64])>,
    ) -> Self {
        let layered = LayeredDiscs::new(Arc::clone(around), degree);
        Self {
            around: Arc::clone(around),
            forces: discs
                .flat_map(|(disc, moments)| layered.forces(disc, moments))
                .collect(),
        }
    }

    /// Of forces, divided by pi.
    pub(crate) fn of_forces(around: &Arc<AroundForce>, forces: Vec<(Point, f64)>) -> Self {
        Self {
            around: Arc::clone(around),
            forces,
        }
    }

    pub(crate) fn value(&self, [x, y]: Point) -> f64 {
        let forces = self.forces.iter();
        let of_force =
            |([u, v], force): &(Point, f64)| force * self.around.value((x - u).hypot(y - v));
        forces.map(of_force).sum()
    }

    pub(crate) fn jet(&self, [x, y]: Point) -> FieldJet {
        let mut sum = FieldJet::default();
        for ([u, v], force) in &self.forces {
            sum.add_scaled(*force, &self.around.jet([x - u, y - v]));
        }
        sum
    }
}

/// The correction around a force on layers, in a unit of length; `None` on half-spaces.
pub(crate) fn around_force(layers: &[WeightedLayer]) -> Option<Arc<AroundForce>> {
    AroundForce::at_point(layers).map(Arc::new)
}
