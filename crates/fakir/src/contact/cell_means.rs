//! Means of the pressure over the cells of a grid.
//!
//! With `x = sqrt(1 - y^2) sin s` on a disc, `p dx = q/mu dx = q ds`: along a row of cells the pressure is
//! integrated without its singularity at the edge, and all cells of a row that hold a disc together have its
//! force.

use super::SolveError;
use super::fields::{Density, Disc, Fields};
use super::run::Run;
use crate::quadrature::gauss_legendre;
use rayon::prelude::*;

/// Points of the rule on a piece, and longest pieces, in disc radii or rad.
const POINTS: usize = 4;
const PIECE: f64 = 0.3;

/// Cells across a pillar where there is only one point.
const LONE_CELLS: f64 = 12.0;

/// Cells along one direction, in rising order, in pillar radii.
struct Cells {
    bounds: Vec<[f64; 2]>,
    /// Of every coordinate, its cell.
    place: Vec<usize>,
}

impl Cells {
    fn narrowest(coordinates: &[f64]) -> Option<f64> {
        let mut sorted = coordinates.to_vec();
        sorted.sort_by(f64::total_cmp);
        let steps = sorted.windows(2).map(|pair| pair[1] - pair[0]);
        steps.filter(|step| *step > 0.0).min_by(f64::total_cmp)
    }

    /// `width` is that of a cell without neighbours.
    fn around(coordinates: &[f64], width: f64) -> Self {
        let mut sorted = coordinates.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        let middles: Vec<f64> = sorted.windows(2).map(|p| 0.5 * (p[0] + p[1])).collect();
        let bounds = (0..sorted.len())
            .map(|k| {
                let below = k.checked_sub(1).map(|k| sorted[k + 1] - middles[k]);
                let above = middles.get(k).map(|middle| middle - sorted[k]);
                let half = 0.5 * width;
                [
                    sorted[k] - below.or(above).unwrap_or(half),
                    sorted[k] + above.or(below).unwrap_or(half),
                ]
            })
            .collect();
        let place = coordinates
            .iter()
            .map(|x| sorted.partition_point(|other| other.total_cmp(x).is_lt()))
            .collect();
        Self { bounds, place }
    }

    /// The cells that overlap a piece.
    fn over(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let start = self.bounds.partition_point(|[_, end]| *end <= low);
        let end = self.bounds.partition_point(|[start, _]| *start < high);
        start..end.max(start)
    }
}

impl Fields {
    /// Mean pressure, Pa, over the cells of a grid, `x` fastest.
    pub(super) fn mean_pressures(
        &self,
        x: &[f64],
        y: &[f64],
        run: &Run<'_>,
    ) -> Result<Vec<f64>, SolveError> {
        let scaled = |coordinates: &[f64]| -> Vec<f64> {
            coordinates
                .iter()
                .map(|x| x / self.problem.length)
                .collect()
        };
        let (x, y) = (scaled(x), scaled(y));
        let narrowest = |a, b| Cells::narrowest(a).or_else(|| Cells::narrowest(b));
        let lone = 2.0 / LONE_CELLS;
        let columns = Cells::around(&x, narrowest(&x, &y).unwrap_or(lone));
        let rows = Cells::around(&y, narrowest(&y, &x).unwrap_or(lone));
        let mut discs_of = vec![Vec::new(); rows.bounds.len()];
        for (k, disc) in self.discs.iter().enumerate() {
            for row in rows.over(disc.centre[1] - disc.radius, disc.centre[1] + disc.radius) {
                discs_of[row].push(k);
            }
        }
        let rule = gauss_legendre(POINTS);
        let one = |(row, discs): (usize, &Vec<usize>)| -> Result<Vec<f64>, SolveError> {
            run.check_cancelled()?;
            let mut means = vec![0.0; columns.bounds.len()];
            for disc in discs {
                let density = self.density_on(*disc);
                add_row(
                    &self.discs[*disc],
                    density,
                    rows.bounds[row],
                    &columns,
                    &rule,
                    &mut means,
                );
            }
            let height = rows.bounds[row][1] - rows.bounds[row][0];
            for (mean, [left, right]) in means.iter_mut().zip(&columns.bounds) {
                *mean *= self.problem.pressure / (height * (right - left));
            }
            Ok(means)
        };
        let means: Result<Vec<_>, SolveError> = match run.pool {
            Some(pool) => pool.install(|| discs_of.par_iter().enumerate().map(one).collect()),
            None => discs_of.iter().enumerate().map(one).collect(),
        };
        let means = means?;
        let values = rows
            .place
            .iter()
            .flat_map(|row| columns.place.iter().map(|column| means[*row][*column]));
        Ok(values.collect())
    }
}

/// Adds the forces of a disc on the cells of a row.
fn add_row(
    disc: &Disc,
    mut density: Density<'_>,
    [bottom, top]: [f64; 2],
    columns: &Cells,
    rule: &[(f64, f64)],
    forces: &mut [f64],
) {
    let [x, y] = disc.centre;
    let radius = disc.radius;
    let of_disc = |y_on_grid: f64| ((y_on_grid - y) / radius).clamp(-1.0, 1.0);
    let area = radius * radius;
    over_pieces(of_disc(bottom), of_disc(top), rule, |up, weight| {
        let half = (1.0 - up * up).sqrt();
        let angle = |x_on_grid: f64| {
            let across = (x_on_grid - x) / radius;
            (across / half).clamp(-1.0, 1.0).asin()
        };
        for column in columns.over(x - radius * half, x + radius * half) {
            let [left, right] = columns.bounds[column];
            over_pieces(angle(left), angle(right), rule, |s, weight_along| {
                let q = density.at([half * s.sin(), up]).max(0.0);
                forces[column] += area * weight * weight_along * q;
            });
        }
    });
}

/// Visits the points of the rule on pieces of an interval.
fn over_pieces(low: f64, high: f64, rule: &[(f64, f64)], mut visit: impl FnMut(f64, f64)) {
    if high <= low {
        return;
    }
    let pieces = ((high - low) / PIECE).ceil().max(1.0);
    let half = 0.5 * (high - low) / pieces;
    for piece in 0..pieces as usize {
        let middle = low + half * (2.0 * piece as f64 + 1.0);
        for (node, weight) in rule {
            visit(middle + half * node, half * weight);
        }
    }
}
