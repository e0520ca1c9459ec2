//! Quadrature of modes times functions over a disc.

use super::basis::{BasisEvaluator, mode_count};
use crate::numerics::quadrature::hemisphere;
use crate::problem::Point;

/// Points on the unit disc, with the weight times every mode.
#[derive(Debug, Clone)]
pub(crate) struct ModeRule {
    points: Vec<Point>,
    /// One row per point.
    weights: Vec<f64>,
    count: usize,
}

impl ModeRule {
    /// For the modes up to a degree, on these numbers of radii and of angles.
    pub(crate) fn new(degree: usize, radial: usize, angular: usize) -> Self {
        let count = mode_count(degree);
        let mut basis = BasisEvaluator::new(degree);
        let rule = hemisphere(radial, angular);
        let mut weights = vec![0.0; rule.len() * count];
        for ((point, weight), row) in rule.iter().zip(weights.chunks_exact_mut(count)) {
            basis.evaluate(*point, row);
            row.iter_mut().for_each(|value| *value *= weight);
        }
        Self {
            points: rule.into_iter().map(|(point, _)| point).collect(),
            weights,
            count,
        }
    }

    /// Number of modes.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The points, each with the weight times every mode.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (&Point, &[f64])> {
        self.points
            .iter()
            .zip(self.weights.chunks_exact(self.count))
    }

    /// `∫ Y_i g dOmega` of a function `g` of the position on a disc with this centre and radius, which is given absolutely and on the unit disc, for
    /// as many modes as the length of `projected`.
    pub(crate) fn project(
        &self,
        (centre, radius): (Point, f64),
        function: impl Fn(Point, Point) -> f64,
        projected: &mut [f64],
    ) {
        projected.fill(0.0);
        for (point, row) in self.rows() {
            let at = [0, 1].map(|k| centre[k] + radius * point[k]);
            let target = function(at, *point);
            for (value, weight) in projected.iter_mut().zip(row) {
                *value += weight * target;
            }
        }
    }
}
