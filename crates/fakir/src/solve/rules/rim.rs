//! A narrow contact at the rim of a pillar top, with boundary elements.
//!
//! A lens beside a pillar first touches its rim and, for a range of loads, only a narrow region along it, too small for the nodes of
//! [`unilateral`](super::unilateral) to resolve. The contact is inside the part of the top with a positive required displacement, which is
//! divided into rings and sectors. Along the covered rim the pressure is singular as the inverse square root of the distance; rings are
//! therefore graded quadratically towards it. Every cell carries a constant, non-negative pressure. With `f` the forces on the cells, `H`
//! the mean displacement of one cell per force on another and `V` the modes at the cells,
//!
//! ```text
//! f >= 0,   gap = H f - V b >= 0,   f·gap = 0,   c = V' f,
//! ```
//!
//! where `b` is the load and `c` are the coefficients of the pressure, `c_i = ∫ p Y_i dA`.
//!
//! `H` is a Galerkin mean over both cells. For their interaction, cells are treated as aligned rectangles at the true distance of their
//! centres; the mean of `1/r` over two such rectangles is a fourth difference of `x^2 y ln(y + r)/2 + x y^2 ln(x + r)/2 - r^3/6`.

use crate::halfspace::disc::basis::{BasisEvaluator, TILT_COMPLIANCE, TILT_MODE, mode_count};
use crate::halfspace::disc::nodes::Resolution;
use crate::numerics::pivoting::{PivotSolver, Pivoting};
use crate::numerics::roots;
use crate::numerics::special::natural_logarithm;
use crate::numerics::vector::{Lanes, widest};
use crate::problem::Point;
use crate::problem::column::Column;
use crate::state::fields::RimContactEdge;
use std::convert::Infallible;
use std::f64::consts::{PI, TAU};

/// Number of positions around the rim that are checked for contact.
const RIM_PLACES: usize = 48;

/// Largest half angle of a narrow contact, rad, and its largest depth from the rim inwards, in pillar radii.
const LARGEST: [f64; 2] = [1.5, 0.7];

/// Factor on these limits for a contact that was narrow before, so that no pillar alternates between both treatments.
const HYSTERESIS: f64 = 1.1;

/// Depth below which nothing is resolved, due to rounding of the mean displacements of cells.
const SHALLOWEST: f64 = 1e-9;

/// The region along the rim of a pillar top with a positive required displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RimContact {
    /// Direction of its centre from the centre of the pillar, rad.
    direction: f64,
    half_angle: f64,
    depth: f64,
}

/// Change of the contact on a narrow region with one of its measures, and change of that measure with the load.
#[derive(Debug, Clone)]
pub(crate) struct Motion {
    /// Derivative of the leading coefficients with respect to the measure, at constant load and cells in contact.
    pub(crate) coefficients: Vec<f64>,
    /// Derivative of the measure with respect to the load.
    pub(crate) by_load: Vec<f64>,
}

impl RimContact {
    /// Changes one measure by a fraction of the half angle, or of the depth.
    fn moved(&self, measure: usize, part: f64) -> (Self, f64) {
        let mut moved = *self;
        let (value, size) = match measure {
            0 => (&mut moved.direction, self.half_angle),
            1 => (&mut moved.half_angle, self.half_angle),
            _ => (&mut moved.depth, self.depth),
        };
        *value += part * size;
        (moved, size)
    }
}

/// Step of finite differences, relative to the size of the argument: their error is proportional to its fourth power.
const STEP: f64 = 1e-3;

/// Derivative at zero from values at four points.
fn derivative<E>(mut function: impl FnMut(f64) -> Result<Vec<f64>, E>) -> Result<Vec<f64>, E> {
    let mut sum = Vec::new();
    for (place, weight) in [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)] {
        let values = function(place * STEP)?;
        sum.resize(values.len(), 0.0);
        for (sum, value) in sum.iter_mut().zip(values) {
            *sum += weight / (12.0 * STEP) * value;
        }
    }
    Ok(sum)
}

/// The modes along the rim.
pub(crate) struct Rim {
    basis: BasisEvaluator,
    values: Vec<f64>,
    /// The modes at the positions around the rim, position by position.
    places: Vec<f64>,
    /// Upper bound of the amount by which each mode between two positions exceeds the larger of both values.
    between: Vec<f64>,
}

impl Rim {
    pub(crate) fn new(degree: usize) -> Self {
        let mut basis = BasisEvaluator::new(degree);
        let count = basis.modes().len();
        let mut places = vec![0.0; RIM_PLACES * count];
        for (place, values) in places.chunks_exact_mut(count).enumerate() {
            let (sin, cos) = Self::angle(place).sin_cos();
            basis.evaluate_polar(0.0, 1.0, [cos, sin], values);
        }
        // Half the square of half a step times the second derivative.
        let half_step = 0.5 * Self::angle(1);
        let modes = basis.modes().iter().enumerate();
        let between = modes
            .map(|(index, mode)| {
                let column = places.iter().skip(index).step_by(count);
                let largest = column.fold(0.0_f64, |largest, value| largest.max(value.abs()));
                0.5 * (half_step * mode.order as f64).powi(2) * largest
            })
            .collect();
        Self {
            basis,
            values: vec![0.0; count],
            places,
            between,
        }
    }

    fn angle(place: usize) -> f64 {
        TAU * place as f64 / RIM_PLACES as f64
    }

    /// Required displacement of a point.
    fn required(&mut self, load: &[f64], angle: f64, depth: f64) -> f64 {
        let (sin, cos) = angle.sin_cos();
        let mu = (depth * (2.0 - depth)).sqrt();
        self.basis
            .evaluate_polar(mu, 1.0 - depth, [cos, sin], &mut self.values);
        self.values.iter().zip(load).map(|(y, b)| y * b).sum()
    }

    /// The position with the largest required displacement, and that displacement.
    fn highest_place(&self, load: &[f64]) -> (f64, f64) {
        let count = self.values.len();
        let of_place =
            |values: &[f64]| -> f64 { values.iter().zip(load).map(|(y, b)| y * b).sum() };
        let required = self.places.chunks_exact(count).map(of_place);
        let (place, required) =
            required
                .enumerate()
                .fold((0, f64::NEG_INFINITY), |best, (place, required)| {
                    if required > best.1 {
                        (place, required)
                    } else {
                        best
                    }
                });
        (Self::angle(place), required)
    }

    /// Derivative of the required displacement of the rim with respect to the angle.
    fn slope(&mut self, load: &[f64], angle: f64) -> f64 {
        let (sin, cos) = angle.sin_cos();
        self.basis
            .evaluate_polar(0.0, 1.0, [cos, sin], &mut self.values);
        let (modes, values) = (self.basis.modes(), &self.values);
        // A cosine mode directly precedes its sine mode.
        (1..load.len().min(values.len()))
            .filter(|&k| modes[k].sine)
            .map(|k| modes[k].order as f64 * (load[k] * values[k - 1] - load[k - 1] * values[k]))
            .sum()
    }

    /// The maximum next to a position, where the derivative changes its sign.
    fn maximum_near(&mut self, load: &[f64], angle: f64) -> (f64, f64) {
        let step = Self::angle(1);
        let start = angle - step;
        let rises = |rim: &mut Self, along: f64| rim.slope(load, start + along);
        let along = first_zero(2.0 * step, |along| rises(self, along)).unwrap_or(step);
        (start + along, self.required(load, start + along, 0.0))
    }

    /// Whether the required displacement is positive anywhere on the rim.
    pub(crate) fn is_touched(&mut self, load: &[f64]) -> bool {
        let (angle, required) = self.highest_place(load);
        let between = self.between.iter().zip(load);
        let between: f64 = between.map(|(most, b)| most * b.abs()).sum();
        required > 0.0 || (required + between > 0.0 && self.maximum_near(load, angle).1 > 0.0)
    }

    /// The narrow region along the rim with a positive required displacement, if that is the whole contact. The limits are slightly larger
    /// if it was narrow `before`.
    pub(crate) fn rim_contact(&mut self, load: &[f64], before: bool) -> Option<RimContact> {
        let [direction, left, right, depth] = self.ends(load, before)?;
        Some(RimContact {
            direction,
            half_angle: left.max(right),
            depth,
        })
    }

    /// Direction, angular extent to either side, and depth of the region.
    fn ends(&mut self, load: &[f64], before: bool) -> Option<[f64; 4]> {
        let slack = if before { HYSTERESIS } else { 1.0 };
        let [largest_angle, largest_depth] = LARGEST.map(|largest| largest * slack);
        let (place, _) = self.highest_place(load);
        // Most contacts extend farther inwards.
        if self.required(load, place, largest_depth) > 0.0 {
            return None;
        }
        let (direction, required) = self.maximum_near(load, place);
        if required.is_nan() || required <= 0.0 {
            return None;
        }
        let depth = first_zero(largest_depth, |depth| self.required(load, direction, depth))?;
        let [left, right] = [-1.0_f64, 1.0].map(|side| {
            first_zero(largest_angle, |angle| {
                self.required(load, direction + side * angle, 0.0)
            })
        });
        (depth > SHALLOWEST).then_some([direction, left?, right?, depth])
    }
}

impl Rim {
    /// The narrow region of a load, and the derivatives of its measures; `None` if it has only just formed.
    fn moving_rim_contact(&mut self, load: &[f64]) -> Option<(RimContact, [Vec<f64>; 3])> {
        let rim_contact = self.rim_contact(load, true)?;
        // The wider side is the same for all steps.
        let [_, left, right, _] = self.ends(load, true)?;
        let side = if left > right { 1 } else { 2 };
        let (place, _) = self.highest_place(load);
        let (_, height) = self.maximum_near(load, place);
        let mut derivatives = [(); 3].map(|()| vec![0.0; load.len()]);
        let mut moved = load.to_vec();
        for mode in 0..load.len() {
            let measures = derivative(|part| {
                moved[mode] = load[mode] + part * height;
                let ends = self.ends(&moved, true).ok_or(())?;
                Ok::<_, ()>(vec![ends[0], ends[side], ends[3]])
            });
            moved[mode] = load[mode];
            for (derivative, value) in derivatives.iter_mut().zip(measures.ok()?) {
                derivative[mode] = value / height;
            }
        }
        Some((rim_contact, derivatives))
    }
}

/// The zero of a function that is positive at zero and decreases; `None` if it is positive at the largest argument.
fn first_zero(largest: f64, mut function: impl FnMut(f64) -> f64) -> Option<f64> {
    let ends = [0.0, largest].map(|position| roots::Point {
        position,
        value: function(position),
    });
    let found = roots::find(ends, 0.0, |argument| {
        Ok::<_, Infallible>(function(argument))
    });
    let root = found.unwrap_or_else(|never| match never {});
    root.map(|root| root.below.position)
}

/// Solver for the contact on the cells of a narrow region.
pub(crate) struct RimSolver {
    /// Numbers of sectors and rings.
    shape: [usize; 2],
    column: Column,
    basis: BasisEvaluator,
    pivot: PivotSolver,
    /// `H`
    influence: Vec<f64>,
    /// `V`, cell by cell.
    values: Vec<f64>,
    /// Number of modes, and number of modes by which pillars interact.
    count: usize,
    lead: usize,
    cells: Vec<Cell>,
    /// Whether cells of two rings some sectors apart are treated as distant.
    far: Vec<bool>,
    /// Mean displacement of the cells of one ring per force on a cell of another, by their distance in sectors, of either sign.
    by_distance: Vec<f64>,
}

/// A cell, given by its centre in polar coordinates of the pillar and its extents.
#[derive(Debug, Clone, Copy)]
struct Cell {
    angle: f64,
    radius: f64,
    /// Along the rim, and across.
    sides: [f64; 2],
}

impl RimSolver {
    /// With the given resolution, for a pillar top with as many modes as its nodes have, the leading `lead` of which act on other pillars.
    pub(crate) fn new(resolution: Resolution, lead: usize, column: Column) -> Self {
        let shape = Self::shape(resolution);
        let size = shape[0] * shape[1];
        let count = mode_count(resolution.nodes);
        Self {
            shape,
            column,
            basis: BasisEvaluator::new(resolution.nodes),
            pivot: PivotSolver::new(size, lead),
            influence: vec![0.0; size * size],
            values: vec![0.0; size * count],
            count,
            lead,
            cells: Vec::with_capacity(size),
            far: vec![false; across_pairs(resolution.rings) * shape[0]],
            by_distance: vec![0.0; (2 * shape[0]).saturating_sub(1)],
        }
    }

    /// Numbers of sectors and rings.
    fn shape(resolution: Resolution) -> [usize; 2] {
        [2 * resolution.rings, resolution.rings]
    }

    /// Divides a region into cells, ring by ring. If `as_before` is set, the classification of near and distant cells is kept, so that
    /// influences change smoothly.
    fn divide(&mut self, rim_contact: &RimContact, as_before: bool) {
        let [along, across] = self.shape;
        let step = 2.0 * rim_contact.half_angle / along as f64;
        let depth = |ring: usize| rim_contact.depth * (ring as f64 / across as f64).powi(2);
        self.cells.clear();
        for ring in 0..across {
            let (outer, inner) = (depth(ring), depth(ring + 1));
            let radius = 1.0 - 0.5 * (outer + inner);
            for sector in 0..along {
                let angle =
                    rim_contact.direction - rim_contact.half_angle + step * (sector as f64 + 0.5);
                self.cells.push(Cell {
                    angle,
                    radius,
                    sides: [radius * step, inner - outer],
                });
            }
        }
        for (cell, values) in self
            .cells
            .iter()
            .zip(self.values.chunks_exact_mut(self.count))
        {
            let (sin, cos) = cell.angle.sin_cos();
            let depth = 1.0 - cell.radius;
            let mu = (depth * (2.0 - depth)).sqrt();
            self.basis
                .evaluate_polar(mu, cell.radius, [cos, sin], values);
        }
        // The same for all pairs of sectors at equal distance.
        let size = along * across;
        let shortening = 0.5 * self.column.shortening;
        // A force at a distance `s` from the centre tilts the top, whose displacement at a distance `r` is `lambda_11 Y(r) Y(s)` for both
        // tilts.
        let rocking = TILT_COMPLIANCE * TILT_MODE * TILT_MODE * self.column.rocking;
        let (cells, far) = (&self.cells, &mut self.far);
        let mut pairs = far.chunks_exact_mut(along);
        let (by_distance, influence) = (&mut self.by_distance, &mut self.influence);
        widest(
            #[inline(always)]
            || {
                for ring in 0..across {
                    for other in ring..across {
                        let (a, b) = (cells[ring * along], cells[other * along]);
                        let Some(far) = pairs.next() else {
                            continue;
                        };
                        for (apart, far) in far.iter_mut().enumerate() {
                            let angle = step * apart as f64;
                            if !as_before {
                                *far = are_far(&a, &b, angle);
                            }
                            let leaning = rocking * a.radius * b.radius * angle.cos();
                            let value = mean_influence(&a, &b, angle, *far) + shortening + leaning;
                            by_distance[along - 1 + apart] = value;
                            by_distance[along - 1 - apart] = value;
                        }
                        for [rows, columns] in [[ring, other], [other, ring]] {
                            for sector in 0..along {
                                let row = (rows * along + sector) * size + columns * along;
                                influence[row..row + along]
                                    .copy_from_slice(&by_distance[along - 1 - sector..][..along]);
                            }
                        }
                    }
                }
            },
        );
    }

    /// Solves for a load. `active` marks the cells in contact: the initial guess on entry, if the number of cells matches, the solution on
    /// return.
    pub(crate) fn solve(
        &mut self,
        rim_contact: &RimContact,
        load: &[f64],
        active: &mut Vec<bool>,
    ) -> Pivoting {
        self.divide(rim_contact, false);
        self.prepare(load);
        if active.len() != self.cells.len() {
            *active = self.pivot.constant.iter().map(|gap| *gap < 0.0).collect();
        }
        self.pivot.solve(&self.influence, None, active)
    }

    /// Coefficients at another load for the cells of the last solution, with those in contact held fixed.
    pub(crate) fn respond_fixed(
        &mut self,
        load: &[f64],
        active: &[bool],
        coefficients: &mut [f64],
    ) {
        self.prepare(load);
        self.pivot.solve_active(&self.influence, None, active);
        self.coefficients(coefficients);
    }

    /// Motion of the contact region of a load with the load, with the cells in contact held fixed; `None` if it has only just formed.
    /// Afterwards the cells are those of another region.
    pub(crate) fn motions(
        &mut self,
        rim: &mut Rim,
        load: &[f64],
        active: &[bool],
    ) -> Option<Vec<Motion>> {
        let (rim_contact, by_load) = rim.moving_rim_contact(load)?;
        self.divide(&rim_contact, false);
        let of_measure = |(measure, by_load): (usize, Vec<f64>)| {
            let (_, size) = rim_contact.moved(measure, 0.0);
            let change = derivative(|part| {
                self.divide(&rim_contact.moved(measure, part).0, true);
                let mut coefficients = vec![0.0; self.lead];
                self.respond_fixed(load, active, &mut coefficients);
                Ok::<_, Infallible>(coefficients)
            });
            let change = change.unwrap_or_else(|never| match never {});
            Motion {
                coefficients: change.into_iter().map(|c| c / size).collect(),
                by_load,
            }
        };
        Some(by_load.into_iter().enumerate().map(of_measure).collect())
    }

    /// Gaps without forces, `-V b`.
    fn prepare(&mut self, load: &[f64]) {
        let required = self.values.chunks_exact(self.count).map(|values| {
            let terms = values.iter().zip(load);
            terms.map(|(y, b)| y * b).sum::<f64>()
        });
        for (constant, required) in self.pivot.constant.iter_mut().zip(required) {
            *constant = -required;
        }
    }

    /// `c = V' f`, as many as `coefficients` contains.
    pub(crate) fn coefficients(&self, coefficients: &mut [f64]) {
        coefficients.fill(0.0);
        for (cell, force) in self.pivot.multipliers() {
            let values = &self.values[cell * self.count..(cell + 1) * self.count];
            for (c, value) in coefficients.iter_mut().zip(values) {
                *c += value * force;
            }
        }
    }

    /// Derivative of the leading coefficients with respect to the leading load with the cells in contact held fixed, `V' H^-1 V` over
    /// these, row by row.
    pub(crate) fn derivative(&mut self, derivative: &mut [f64]) {
        let (values, count) = (&self.values, self.count);
        self.pivot
            .projected_inverse(self.lead, derivative, |cell, mode| {
                values[cell * count + mode]
            });
    }

    /// The edge of the contact, and its largest distance from an axis given relative to the centre of the pillar.
    pub(crate) fn edge(&self, [x, y]: Point) -> RimContactEdge {
        let [along, _] = self.shape;
        let mut edge = RimContactEdge {
            points: Vec::new(),
            reach: 0.0,
            error: 0.0,
        };
        // The innermost cell in contact of every sector.
        let mut innermost: Vec<Option<Cell>> = vec![None; along];
        for (cell, force) in self.pivot.multipliers() {
            if force > 0.0 {
                innermost[cell % along] = Some(self.cells[cell]);
            }
        }
        for cell in innermost.iter().flatten() {
            let corners = cell.corners();
            let [_, _, inner, other_inner] = corners;
            let middle = [0, 1].map(|axis| 0.5 * (inner[axis] + other_inner[axis]));
            edge.points.push(middle);
            let distances = corners.map(|[u, v]| (u - x).hypot(v - y));
            let farthest = distances.into_iter().fold(0.0, f64::max);
            let nearest = distances.into_iter().fold(f64::INFINITY, f64::min);
            if farthest > edge.reach {
                (edge.reach, edge.error) = (farthest, farthest - nearest);
            }
        }
        let ends = [
            innermost.iter().flatten().next(),
            innermost.iter().flatten().last(),
        ];
        for (cell, side) in ends.into_iter().zip([-1.0, 1.0]) {
            let Some(cell) = cell else { continue };
            let angle = cell.angle + side * 0.5 * cell.sides[0] / cell.radius;
            let (sin, cos) = angle.sin_cos();
            edge.points.push([cos, sin]);
        }
        edge
    }
}

/// Marks of the cells of a narrow region for its mirror image, whose sectors have the opposite order.
pub(crate) fn mirrored(marks: &[bool], resolution: Resolution) -> Vec<bool> {
    let sectors = RimSolver::shape(resolution)[0].max(1);
    let rings = marks.chunks(sectors);
    rings.flat_map(|ring| ring.iter().rev().copied()).collect()
}

impl Cell {
    /// Two corners on the outer side, two on the inner.
    fn corners(&self) -> [Point; 4] {
        let turn = 0.5 * self.sides[0] / self.radius;
        [(-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(along, across)| {
            let (sin, cos) = (self.angle + along * turn).sin_cos();
            let radius = self.radius + 0.5 * across * self.sides[1];
            [radius * cos, radius * sin]
        })
    }
}

/// Length that replaces zero in a quotient.
const TINY: f64 = 1e-200;

/// Number of pairs of rings.
fn across_pairs(rings: usize) -> usize {
    rings * (rings + 1) / 2
}

/// Distance between the centres of two cells, whose sectors are `angle` apart, along the rim and across.
#[inline(always)]
fn apart(one: &Cell, other: &Cell, angle: f64) -> Point {
    let along = 2.0 * (one.radius * other.radius).sqrt() * (0.5 * angle).sin();
    [along, one.radius - other.radius]
}

/// Whether the second moments of the cells are sufficient.
#[inline(always)]
fn are_far(one: &Cell, other: &Cell, angle: f64) -> bool {
    /// Distance, relative to the longest side, above which they are.
    const FAR: f64 = 4.0;
    let [x, y] = apart(one, other, angle);
    let sides = [one, other].into_iter().flat_map(|cell| cell.sides);
    x.hypot(y) > FAR * sides.fold(0.0, f64::max)
}

/// Mean displacement of one cell per force on another whose sector is `angle` away: the mean of `1/(pi r)`.
#[inline(always)]
fn mean_influence(one: &Cell, other: &Cell, angle: f64, far: bool) -> f64 {
    let [x, y] = apart(one, other, angle);
    let mean = if far {
        let distance = x.hypot(y);
        // 1/r plus its second derivatives times the variances of the coordinate differences.
        let [x_variance, y_variance] =
            [0, 1].map(|axis| (one.sides[axis].powi(2) + other.sides[axis].powi(2)) / 12.0);
        let inverse_square = distance.powi(-2);
        let second = |along: f64| 3.0 * along * along * inverse_square - 1.0;
        let correction = 0.5 * inverse_square * (x_variance * second(x) + y_variance * second(y));
        (1.0 + correction) / distance
    } else {
        mean_inverse_distance([x, y], one.sides, other.sides)
    };
    mean / PI
}

/// Mean of `1/r` over two aligned rectangles whose centres are `[x, y]` apart.
#[inline(always)]
fn mean_inverse_distance([x, y]: [f64; 2], one: [f64; 2], other: [f64; 2]) -> f64 {
    // The corners of the difference, with the signs +, -, - and +.
    let corners = |offset: f64, axis: usize| {
        let (half_sum, half_difference) = (
            0.5 * (one[axis] + other[axis]),
            0.5 * (one[axis] - other[axis]),
        );
        [
            (offset + half_sum).abs(),
            (offset + half_difference).abs(),
            (offset - half_difference).abs(),
            (offset - half_sum).abs(),
        ]
    };
    let across = Lanes(corners(y, 1));
    let [a, b, c, d] = corners(x, 0).map(|x| fourth_integrals(x, across));
    let Lanes([e, f, g, h]) = (a - b) + (d - c);
    ((e - f) + (h - g)) / (one[0] * one[1] * other[0] * other[1])
}

/// A function whose second derivative along both axes is `1/r`, at `x >= 0` and several `y >= 0`.
#[inline(always)]
#[allow(clippy::imprecise_flops)] // a hypotenuse without overflow would be a call for every lane
fn fourth_integrals(x: f64, across: Lanes) -> Lanes {
    across.map(|y| {
        let r = (x * x + y * y).sqrt();
        // asinh(b/a); it differs from the logarithm of b + r by terms that cancel in the difference. At a = 0 its factor is zero.
        let inverse_sinh = |b: f64, a: f64| natural_logarithm((b + r).max(TINY) / a.max(TINY));
        0.5 * x * y * (x * inverse_sinh(y, x) + y * inverse_sinh(x, y)) - r * r * r / 6.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::disc::basis::UNIT_FORCE;
    use crate::halfspace::disc::nodes::Resolution;
    use crate::numerics::quadrature::hemisphere;
    use crate::solve::rules::unilateral::{LocalSolver, PillarTop};

    /// Load of a paraboloid of radius `lens` whose axis is `distance` from the pillar and which is lower by `depth` than at first contact
    /// with the rim.
    fn beside(lens: f64, distance: f64, depth: f64) -> Vec<f64> {
        let mut basis = BasisEvaluator::new(2);
        let mut values = vec![0.0; 6];
        let mut load = vec![0.0; 6];
        let at_rim = (distance - 1.0).powi(2) / (2.0 * lens);
        for ([x, y], weight) in hemisphere(6, 13) {
            basis.evaluate([x, y], &mut values);
            let sag = ((x - distance).powi(2) + y * y) / (2.0 * lens);
            for (b, value) in load.iter_mut().zip(&values) {
                *b += weight * (at_rim + depth - sag) * value;
            }
        }
        load
    }

    fn force(rings: usize, load: &[f64]) -> f64 {
        let resolution = Resolution {
            nodes: 2,
            turn: 0.0,
            rings,
        };
        let top = PillarTop::new(resolution, 2, 0.0);
        let mut solver = LocalSolver::new(&top);
        let mut active = Vec::new();
        assert!(solver.solve(&top, load, &mut active).converged);
        assert!(solver.cells().is_some());
        let mut coefficients = vec![0.0; 6];
        solver.coefficients(&top, load, &mut coefficients);
        UNIT_FORCE * coefficients[0]
    }

    #[test]
    fn mean_over_rectangles_by_quadrature() {
        // Gauss-Legendre points of rectangles apart from each other, and a square with itself: its mean of 1/r is 4 (ln(1 + sqrt 2) + (1 -
        // sqrt 2)/3) divided by its side.
        let own = mean_inverse_distance([0.0, 0.0], [1.0, 1.0], [1.0, 1.0]);
        let root = 2.0_f64.sqrt();
        let expected = 4.0 * (root.ln_1p() + (1.0 - root) / 3.0);
        assert!((own / expected - 1.0).abs() < 1e-13, "{own}");
        let points = |side: f64| {
            let a = (0.6_f64).sqrt() * 0.5 * side;
            [(-a, 5.0 / 18.0), (0.0, 8.0 / 18.0), (a, 5.0 / 18.0)]
        };
        let (one, other, [x, y]) = ([0.5, 0.1], [0.4, 0.2], [1.9, 0.7]);
        let mut mean = 0.0;
        for (x0, a) in points(one[0]) {
            for (y0, b) in points(one[1]) {
                for (x1, c) in points(other[0]) {
                    for (y1, d) in points(other[1]) {
                        mean += a * b * c * d / (x + x0 - x1).hypot(y + y0 - y1);
                    }
                }
            }
        }
        let found = mean_inverse_distance([x, y], one, other);
        assert!((found / mean - 1.0).abs() < 1e-7, "{found} {mean}");
    }

    #[test]
    fn narrow_contacts_at_a_rim_converge_and_join_the_nodes() {
        // The depth of the lens at the rim determines the size of the region; the largest one is also resolved by nodes, within their
        // accuracy.
        for depth in [1e-10, 1e-7, 1e-5, 1e-4] {
            let load = beside(700.0, 4.0, depth);
            let [coarse, middle, fine] = [6, 10, 20].map(|rings| force(rings, &load));
            println!(
                "{depth:e}: {:e} {:e} of {fine:e}",
                coarse / fine - 1.0,
                middle / fine - 1.0
            );
            assert!((coarse / fine - 1.0).abs() < 0.03);
            assert!((middle / fine - 1.0).abs() < 0.012);
        }
        let load = beside(700.0, 4.0, 1e-3);
        let fine = force(20, &load);
        let resolution = Resolution::of_nodes(32);
        let top = PillarTop::new(resolution, 2, 0.0);
        let mut solver = LocalSolver::new(&top);
        let mut active = Vec::new();
        assert!(solver.solve(&top, &load, &mut active).converged);
        let mut coefficients = vec![0.0; 6];
        solver.coefficients(&top, &load, &mut coefficients);
        let nodes = UNIT_FORCE * coefficients[0];
        assert!((nodes / fine - 1.0).abs() < 0.03, "{nodes} {fine}");
    }
}
