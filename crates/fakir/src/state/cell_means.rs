//! Means of the pressure over the cells of a grid.
//!
//! With `x = sqrt(1 - y^2) sin s` on a disc, `p dx = q/mu dx = q ds`: along a row of cells the pressure is integrated without its
//! singularity at the edge, and the cells of a row that contain a disc add up to its force.
//!
//! The pressure of a cell whose centre is not in contact is zero, since the gap is open there: the force on its part in contact is assigned
//! to the nearest cells whose centre is in contact.

use super::error::SolveError;
use super::fields::{Density, Disc, Fields};
use super::run::Run;
use crate::halfspace::floor::load::FloorLoad;
use crate::numerics::quadrature::gauss_legendre;
use crate::problem::Point;
use std::ops::Range;

/// Number of points of the rule on a subinterval, and largest length of subintervals in disc radii or rad.
const POINTS: usize = 4;
const PIECE: f64 = 0.3;

/// Number of cells across a pillar if there is only one point.
const LONE_CELLS: f64 = 12.0;

/// Cells along one direction in increasing order, in pillar radii.
struct Cells {
    bounds: Vec<[f64; 2]>,
    /// The coordinates of the cells.
    middles: Vec<f64>,
    /// The cell of every coordinate.
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
        let between: Vec<f64> = sorted.windows(2).map(|p| 0.5 * (p[0] + p[1])).collect();
        let bounds = (0..sorted.len())
            .map(|k| {
                let below = k.checked_sub(1).map(|k| sorted[k + 1] - between[k]);
                let above = between.get(k).map(|end| end - sorted[k]);
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
        Self {
            bounds,
            middles: sorted,
            place,
        }
    }

    /// The coordinate of a cell.
    fn middle(&self, cell: usize) -> f64 {
        self.middles[cell]
    }

    /// The cells that overlap an interval.
    fn over(&self, low: f64, high: f64) -> Range<usize> {
        let start = self.bounds.partition_point(|[_, end]| *end <= low);
        let end = self.bounds.partition_point(|[start, _]| *start < high);
        start..end.max(start)
    }
}

impl Fields {
    /// Mean pressure, Pa, over the cells of a grid; `x` varies fastest.
    pub(super) fn mean_pressures(
        &self,
        x: &[f64],
        y: &[f64],
        run: &Run<'_>,
    ) -> Result<Vec<f64>, SolveError> {
        let scaled = |coordinates: &[f64]| -> Vec<f64> {
            coordinates.iter().map(|x| x / self.scene.length).collect()
        };
        let (x, y) = (scaled(x), scaled(y));
        let narrowest = |a, b| Cells::narrowest(a).or_else(|| Cells::narrowest(b));
        let lone = 2.0 / LONE_CELLS;
        let columns = Cells::around(&x, narrowest(&x, &y).unwrap_or(lone));
        let rows = Cells::around(&y, narrowest(&y, &x).unwrap_or(lone));
        let rule = gauss_legendre(POINTS);
        let one = |(): &mut (), disc: usize| -> Result<Block, SolveError> {
            run.check_cancelled()?;
            let mut block = Block::around(&self.discs[disc], &columns, &rows);
            let mut density = self.density_on(disc);
            block.fill(&self.discs[disc], &mut density, &columns, &rows, &rule);
            block.gather(&self.discs[disc], &mut density, &columns, &rows);
            Ok(block)
        };
        let blocks = run.workers().map(self.discs.len(), 1, || (), one);
        let width = columns.bounds.len();
        let mut means = vec![0.0; width * rows.bounds.len()];
        for block in blocks {
            for (row, column, force) in block?.cells() {
                means[row * width + column] += force;
            }
        }
        if let Some(floor) = &self.floor {
            add_floor(floor, &columns, &rows, &mut means);
        }
        for (means, [bottom, top]) in means.chunks_exact_mut(width.max(1)).zip(&rows.bounds) {
            for (mean, [left, right]) in means.iter_mut().zip(&columns.bounds) {
                *mean *= self.scene.pressure / ((top - bottom) * (right - left));
            }
        }
        let values = rows.place.iter().flat_map(|row| {
            columns
                .place
                .iter()
                .map(|column| means[*row * width + *column])
        });
        Ok(values.collect())
    }
}

/// Number of parts along the side of a rotated floor cell; the force on each part acts at its centre.
const PARTS: usize = 4;

/// Adds the forces on the floor: the force on every floor cell is distributed over grid cells by area.
fn add_floor(floor: &FloorLoad, columns: &Cells, rows: &Cells, forces: &mut [f64]) {
    if floor.is_turned() {
        return add_turned_floor(floor, columns, rows, forces);
    }
    let width = columns.bounds.len();
    let [wide, high] = floor.cell().map(|side| 0.5 * side);
    let shared =
        |[low, end]: [f64; 2], [start, stop]: [f64; 2]| (end.min(stop) - low.max(start)).max(0.0);
    for ([x, y], pressure) in floor.loaded_cells() {
        let (across, along) = ([x - wide, x + wide], [y - high, y + high]);
        for row in rows.over(along[0], along[1]) {
            for column in columns.over(across[0], across[1]) {
                let area = shared(across, columns.bounds[column]) * shared(along, rows.bounds[row]);
                forces[row * width + column] += pressure * area;
            }
        }
    }
}

/// The same for rotated floor cells: by parts of these.
fn add_turned_floor(floor: &FloorLoad, columns: &Cells, rows: &Cells, forces: &mut [f64]) {
    let width = columns.bounds.len();
    let sides = floor.cell().map(|side| side / PARTS as f64);
    let part = |k: usize| k as f64 + 0.5 - 0.5 * PARTS as f64;
    for ([x, y], pressure) in floor.loaded_cells() {
        for k in 0..PARTS * PARTS {
            let at = [
                x + part(k % PARTS) * sides[0],
                y + part(k / PARTS) * sides[1],
            ];
            let [x, y] = floor.placed(at);
            for row in rows.over(y, y.next_up()) {
                for column in columns.over(x, x.next_up()) {
                    forces[row * width + column] += pressure * sides[0] * sides[1];
                }
            }
        }
    }
}

/// The forces on the cells that a disc overlaps, by rows.
struct Block {
    rows: Range<usize>,
    columns: Range<usize>,
    forces: Vec<f64>,
}

impl Block {
    fn around(disc: &Disc, columns: &Cells, rows: &Cells) -> Self {
        let [x, y] = disc.centre;
        let columns = columns.over(x - disc.radius, x + disc.radius);
        let rows = rows.over(y - disc.radius, y + disc.radius);
        let forces = vec![0.0; rows.len() * columns.len()];
        Self {
            rows,
            columns,
            forces,
        }
    }

    fn cells(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let places = self
            .rows
            .clone()
            .flat_map(|row| self.columns.clone().map(move |column| (row, column)));
        places
            .zip(&self.forces)
            .map(|((row, column), force)| (row, column, *force))
    }

    fn fill(
        &mut self,
        disc: &Disc,
        density: &mut Density<'_>,
        columns: &Cells,
        rows: &Cells,
        rule: &[(f64, f64)],
    ) {
        let [x, y] = disc.centre;
        let radius = disc.radius;
        let area = radius * radius;
        let of_disc = |y_on_grid: f64| ((y_on_grid - y) / radius).clamp(-1.0, 1.0);
        for (row, forces) in self
            .rows
            .clone()
            .zip(self.forces.chunks_exact_mut(self.columns.len().max(1)))
        {
            let [bottom, top] = rows.bounds[row].map(of_disc);
            over_pieces(bottom, top, rule, |up, weight| {
                let half = (1.0 - up * up).sqrt();
                let angle = |x_on_grid: f64| {
                    let across = (x_on_grid - x) / radius;
                    (across / half).clamp(-1.0, 1.0).asin()
                };
                for (column, force) in self.columns.clone().zip(forces.iter_mut()) {
                    let [left, right] = columns.bounds[column].map(angle);
                    over_pieces(left, right, rule, |s, weight_along| {
                        let q = density.at([half * s.sin(), up]);
                        *force += area * weight * weight_along * q;
                    });
                }
            });
        }
    }

    /// Distributes the forces on cells whose centre is not in contact to the nearest cells whose centre is, if any.
    fn gather(&mut self, disc: &Disc, density: &mut Density<'_>, columns: &Cells, rows: &Cells) {
        let places: Vec<(Point, f64)> = self
            .cells()
            .map(|(row, column, force)| ([columns.middle(column), rows.middle(row)], force))
            .collect();
        let covered: Vec<bool> = places
            .iter()
            .map(|(middle, _)| {
                let at = disc.offset(*middle);
                at[0].hypot(at[1]) < 1.0 && density.at(at) != 0.0
            })
            .collect();
        let (height, width) = (self.rows.len(), self.columns.len());
        for (k, (_, force)) in places.iter().enumerate() {
            if covered[k] || *force == 0.0 {
                continue;
            }
            let (row, column) = (k / width, k % width);
            // Nearly always among the adjacent cells.
            let nearest = (1..height.max(width)).find_map(|reach| {
                let near = |place: usize, end: usize| {
                    place.saturating_sub(reach)..(place + reach + 1).min(end)
                };
                let around = near(row, height)
                    .flat_map(|row| near(column, width).map(move |column| row * width + column));
                let in_contact: Vec<usize> = around.filter(|other| covered[*other]).collect();
                (!in_contact.is_empty()).then_some(in_contact)
            });
            if let Some(nearest) = nearest {
                self.forces[k] = 0.0;
                for other in &nearest {
                    self.forces[*other] += force / nearest.len() as f64;
                }
            }
        }
    }
}

/// Visits the points of the rule on subintervals of an interval.
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
