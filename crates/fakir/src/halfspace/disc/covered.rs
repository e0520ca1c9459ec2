//! The region in contact on a partially covered pillar top.
//!
//! The pressure expansion of such a pillar has the correct force and moments. Between its nodes, however, it oscillates about zero outside
//! the contact, and it cannot reproduce the square root with which the pressure vanishes at the edge of the contact. The gap is smooth and
//! determines the edge:
//!
//! * along lines from the centre of pressure, the gap opens as the distance from the edge of the contact to the power 3/2 (K. L. Johnson,
//!   Contact Mechanics, section 5.1);
//! * around the rim of the pillar top it opens faster at first, since the pressure that ends there is infinite at the rim: as the power
//!   5/4, found on meshes of 256 cells across a pillar.
//!
//! A conic through these points, `l(x) = 0`, is the edge of the contact. Inside it the pressure is approximated by
//! `p = A(x) sqrt(l(x))/mu(x)`: non-negative, vanishing as a square root at the edge of the contact, infinite at the covered rim, with the
//! force and, provided that `A` remains positive, the first moments of the expansion.

use super::basis::{BasisEvaluator, UNIT_FORCE, mode_count};
use super::nodes::{Node, bos_array};
use crate::numerics::cholesky::{factorise, solve_lower, solve_upper};
use crate::numerics::quadrature::gauss_legendre;
use crate::numerics::vector::dot;
use crate::problem::Point;
use std::f64::consts::PI;

/// Levels, relative to the largest gap on a pillar top, at which the gap is located. Closer to the contact the oscillations dominate.
const LEVELS: [f64; 2] = [0.1, 0.3];

/// Power of the gap that grows linearly with the distance from the contact, along lines and around the rim.
const OPENING: f64 = 2.0 / 3.0;
const OPENING_AT_RIM: f64 = 0.8;

/// Number of lines from the centre of pressure, and of points around the rim.
const RAYS: usize = 24;
const RIM: usize = 120;

/// Weight of the points on the rim, which are the most accurate, relative to those on lines.
const RIM_WEIGHT: f64 = 4.0;

/// Position error of the edge of a region by degree of the nodes, in pillar radii: the largest differences from boundary elements of a 192nd
/// of the diameter over 150 random loads.
const EDGE_ERROR: [(usize, f64); 3] = [(8, 0.12), (12, 0.06), (usize::MAX, 0.04)];

/// Position error of the edge of a region found from nodes of a degree, in pillar radii.
pub(crate) fn edge_error(degree: usize) -> f64 {
    let known = EDGE_ERROR.iter().find(|(most, _)| degree <= *most);
    known.map_or(1.0, |(_, error)| *error)
}

/// Smallest distance from the centre of pressure to the edge of the contact, in pillar radii.
const SMALLEST: f64 = 0.02;

/// Regularisation weight that favours a straight edge of the contact over a curved one.
const STRAIGHTNESS: f64 = 0.2;

/// First moment along x or y of the tilt mode in this direction, `sqrt(2 pi/3)`.
const FIRST_MOMENT: f64 = 1.447_202_509_116_535_3;

/// Smallest value of `A` relative to its mean.
const LEAST_AMPLITUDE: f64 = 0.2;

/// Finds covered regions from expansions up to one degree.
pub(crate) struct CoverFinder {
    count: usize,
    basis: BasisEvaluator,
    nodes: Vec<Node>,
    /// Modes at the nodes, and at the points of the rim, point by point.
    at_nodes: Vec<f64>,
    at_rim: Vec<f64>,
    line: RayLine,
    /// Positions on a line from the centre to its end, as fractions, with weights.
    rule: Vec<(f64, f64)>,
}

/// The covered region of a pillar top, in pillar radii from its centre.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Region {
    /// Centre of pressure.
    middle: Point,
    /// `l = 1 + k0 x + k1 y + k2 x^2 + k3 x y + k4 y^2` relative to this centre.
    conic: [f64; 5],
}

/// Directions distributed as if a region were stretched to be as wide as it is long.
struct Stretch {
    /// Direction of the depth.
    outwards: Point,
    /// Extents along it and across it.
    depth: f64,
    length: f64,
}

impl Stretch {
    /// The direction that corresponds to an angle in the stretched region, and the angle of a step there; in rad.
    fn direction(&self, angle: f64, step: f64) -> (Point, f64) {
        let Self {
            outwards,
            depth,
            length,
        } = self;
        let along = [-outwards[1], outwards[0]];
        let (sin, cos) = angle.sin_cos();
        let (a, b) = (depth * cos, length * sin);
        let stretched = a.hypot(b);
        let direction = [0, 1].map(|i| (a * outwards[i] + b * along[i]) / stretched);
        (direction, step * depth * length / (stretched * stretched))
    }
}

/// The covered region of a pillar top and the pressure on it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CoveredPart {
    pub(crate) region: Region,
    /// `A = a0 + a1 x + a2 y` relative to the centre of pressure.
    amplitude: [f64; 3],
}

impl CoverFinder {
    pub(crate) fn new(degree: usize) -> Self {
        let count = mode_count(degree);
        let mut basis = BasisEvaluator::new(degree);
        let nodes = bos_array(degree, 0.0);
        let mut at_nodes = vec![0.0; nodes.len() * count];
        for (node, row) in nodes.iter().zip(at_nodes.chunks_exact_mut(count)) {
            basis.evaluate_polar(node.mu, node.rho, node.direction, row);
        }
        let mut at_rim = vec![0.0; RIM * count];
        for (k, row) in at_rim.chunks_exact_mut(count).enumerate() {
            let (sin, cos) = rim_angle(k as f64).sin_cos();
            basis.evaluate_polar(0.0, 1.0, [cos, sin], row);
        }
        Self {
            count,
            basis,
            nodes,
            at_nodes,
            at_rim,
            line: RayLine::new(degree),
            rule: rule_to_roots(),
        }
    }

    /// Finds the covered region of a pillar top from the coefficients of `q` and of the gap. Returns `None` if no contact is detected.
    pub(crate) fn find(&mut self, density: &[f64], gap: &[f64]) -> Option<CoveredPart> {
        let region = self.region(density, gap)?;
        let amplitude = self.amplitude(&region, density)?;
        Some(CoveredPart { region, amplitude })
    }

    /// [`find`](Self::find) without the pressure.
    pub(crate) fn region(&mut self, density: &[f64], gap: &[f64]) -> Option<Region> {
        let (middle, widest) = self.middle(density, gap)?;
        let corners = self.corners(gap);
        let mut points = self.edge_points(middle, gap, widest, !corners.is_empty());
        points.extend(corners.into_iter().map(|corner| (corner, RIM_WEIGHT)));
        Some(Region {
            middle,
            conic: conic_through(middle, &points),
        })
    }

    /// The covered region between a known edge and the rim.
    pub(crate) fn inside(&self, density: &[f64], edge: &[Point]) -> Option<CoveredPart> {
        let force = UNIT_FORCE * density.first()?;
        if force <= 0.0 {
            return None;
        }
        let middle = [1, 2].map(|mode| FIRST_MOMENT * density.get(mode).unwrap_or(&0.0) / force);
        let points: Vec<_> = edge.iter().map(|point| (*point, 1.0)).collect();
        let region = Region {
            middle,
            conic: conic_through(middle, &points),
        };
        let amplitude = self.amplitude(&region, density)?;
        Some(CoveredPart { region, amplitude })
    }

    /// Distance from an axis, given relative to the centre of the pillar, of the farther of the two points of the rim at which the contact
    /// ends; `None` if the contact does not end on the rim.
    pub(crate) fn farthest_corner(&self, gap: &[f64], axis: Point) -> Option<f64> {
        self.corners(gap)
            .into_iter()
            .map(|[x, y]| (x - axis[0]).hypot(y - axis[1]))
            .max_by(f64::total_cmp)
    }

    /// The centre of pressure, and the largest gap at a node.
    fn middle(&self, density: &[f64], gap: &[f64]) -> Option<(Point, f64)> {
        let (mut sum, mut at, mut widest) = (0.0, [0.0; 2], 0.0_f64);
        for (node, row) in self
            .nodes
            .iter()
            .zip(self.at_nodes.chunks_exact(self.count))
        {
            let pressure = dot(row, density).max(0.0);
            let weight = pressure * pressure;
            sum += weight;
            at[0] += weight * node.rho * node.direction[0];
            at[1] += weight * node.rho * node.direction[1];
            widest = widest.max(dot(row, gap));
        }
        (sum > 0.0).then(|| (at.map(|x| x / sum), widest))
    }

    /// The two points of the rim at which the contact ends; empty if it does not end there.
    fn corners(&self, gap: &[f64]) -> Vec<Point> {
        let gaps: Vec<f64> = self
            .at_rim
            .chunks_exact(self.count)
            .map(|row| dot(row, gap))
            .collect();
        let (start, widest) =
            gaps.iter()
                .copied()
                .enumerate()
                .fold(
                    (0, 0.0),
                    |(place, most), (k, gap)| if gap > most { (k, gap) } else { (place, most) },
                );
        if widest <= 0.0 {
            return Vec::new();
        }
        let end = |forward: bool| -> Option<f64> {
            let at = |steps: usize| {
                let steps = steps % RIM;
                gaps[(start + if forward { steps } else { RIM - steps }) % RIM]
            };
            let passed = |level: f64| {
                let steps = (1..RIM).find(|steps| at(*steps) < level * widest)?;
                let (before, after) = (at(steps - 1), at(steps));
                Some(steps as f64 - (level * widest - after) / (before - after))
            };
            let steps = [passed(LEVELS[0])?, passed(LEVELS[1])?];
            Some(closing(
                LEVELS.map(|level| level.powf(OPENING_AT_RIM)),
                steps,
            ))
        };
        let (Some(forward), Some(back)) = (end(true), end(false)) else {
            return Vec::new();
        };
        if forward + back >= RIM as f64 {
            return Vec::new();
        }
        [start as f64 + forward, start as f64 - back]
            .map(|place| {
                let (sin, cos) = rim_angle(place).sin_cos();
                [cos, sin]
            })
            .into()
    }

    /// Points of the edge of the contact on the top, with weights.
    fn edge_points(
        &mut self,
        middle: Point,
        gap: &[f64],
        widest: f64,
        has_corners: bool,
    ) -> Vec<(Point, f64)> {
        /// Smallest opening of the gap along a line that is used.
        const LEAST_OPENING: f64 = 0.15;
        /// Beyond this radius the points on the rim are more accurate.
        const CLOSE_TO_RIM: f64 = 0.97;
        let mut values = vec![0.0; self.count];
        let Self { basis, line, .. } = self;
        let on_ray = |ray: usize| -> Option<(Point, f64)> {
            let (sin, cos) = (2.0 * PI * (ray as f64 + 0.5) / RAYS as f64).sin_cos();
            let ray = line.ray(rim_distance(middle, [cos, sin]), |s| {
                basis.evaluate([middle[0] + s * cos, middle[1] + s * sin], &mut values);
                dot(&values, gap)
            });
            let last = ray.gaps[Ray::SAMPLES - 1];
            if last < LEAST_OPENING * widest || last <= 0.0 {
                return None;
            }
            let levels = LEVELS.map(|level| {
                let level = level * widest;
                if level < 0.7 * last {
                    level
                } else {
                    level / widest * last
                }
            });
            let end = match levels.map(|level| ray.last_below(level)) {
                [Some(first), Some(second)] => closing(
                    levels.map(|level| (level / widest).powf(OPENING)),
                    [first, second],
                ),
                // The contact is too small to resolve its edge.
                _ => 0.0,
            };
            let end = end.max(SMALLEST);
            let point = [middle[0] + end * cos, middle[1] + end * sin];
            let hidden = has_corners && point[0].hypot(point[1]) > CLOSE_TO_RIM;
            (!hidden).then_some((point, last / widest))
        };
        (0..RAYS).filter_map(on_ray).collect()
    }

    /// `A` with the force of the expansion, and with its first moments if `A` remains positive.
    fn amplitude(&self, part: &Region, density: &[f64]) -> Option<[f64; 3]> {
        // Moments of 1, x, y (relative to the centre) and of their products, with the weight sqrt(l)/mu.
        let mut moments = [[0.0; 3]; 3];
        part.integrate(&self.rule, |[x, y], weight| {
            let powers = [1.0, x, y];
            for (row, a) in moments.iter_mut().zip(powers) {
                for (sum, b) in row.iter_mut().zip(powers) {
                    *sum += weight * a * b;
                }
            }
        });
        let [area, across, up] = moments[0];
        if area <= 0.0 {
            return None;
        }
        // Forces and first moments of the modes of degree 0 and 1 in the expansion.
        let force = UNIT_FORCE * density[0];
        let moment = |mode: usize| density.get(mode).map_or(0.0, |c| FIRST_MOMENT * c);
        let target = [
            force,
            moment(1) - part.middle[0] * force,
            moment(2) - part.middle[1] * force,
        ];
        let even = [force / area, 0.0, 0.0];
        let Some([_, a1, a2]) = solve_3(moments, target) else {
            return Some(even);
        };
        // Limits the slope so that the amplitude remains positive; keeps the force.
        let centre = [across / area, up / area];
        let mut least = 0.0_f64;
        part.integrate(&self.rule, |[x, y], _| {
            least = least.min(a1 * (x - centre[0]) + a2 * (y - centre[1]));
        });
        let margin = (1.0 - LEAST_AMPLITUDE) * even[0];
        let scale = if -least > margin {
            margin / -least
        } else {
            1.0
        };
        let (a1, a2) = (scale * a1, scale * a2);
        Some([even[0] - a1 * centre[0] - a2 * centre[1], a1, a2])
    }
}

impl CoveredPart {
    /// `q = p mu` at a point of the top, in pillar radii from its centre; zero outside the contact.
    pub(crate) fn density(&self, point: Point) -> f64 {
        let [middle_x, middle_y] = self.region.middle;
        let [x, y] = [point[0] - middle_x, point[1] - middle_y];
        let [linear, square] = self.region.along([x, y]);
        if first_root(linear, square) <= 1.0 {
            return 0.0;
        }
        let [a0, a1, a2] = self.amplitude;
        let level = (1.0 + linear + square).max(0.0);
        (a0 + a1 * x + a2 * y).max(0.0) * level.sqrt()
    }
}

impl Region {
    /// Outline of the region as a polygon.
    pub(crate) fn outline(&self, corners: usize) -> Vec<Point> {
        (0..corners)
            .map(|k| {
                let (sin, cos) = (2.0 * PI * k as f64 / corners as f64).sin_cos();
                let end = self.end([cos, sin]);
                [self.middle[0] + end * cos, self.middle[1] + end * sin]
            })
            .collect()
    }

    /// Area of the region, and length of its edge on the top, without the rim; in squares of the pillar radius, and in pillar radii.
    pub(crate) fn area_and_edge(&self) -> [f64; 2] {
        // As in `integrate`, directions are distributed as if the region were stretched to be as wide as it is long.
        let (stretch, directions) = self.stretch();
        let step = 2.0 * PI / f64::from(directions);
        let end = |k: u32| {
            let (direction, angle) = stretch.direction(step * (f64::from(k) + 0.5), step);
            let [linear, square] = self.along(direction);
            let (edge, rim) = (
                first_root(linear, square),
                rim_distance(self.middle, direction),
            );
            (direction, angle, edge, rim)
        };
        let [mut area, mut length] = [0.0; 2];
        let mut last: Option<Point> = None;
        for k in 0..=directions {
            let ([cos, sin], angle, edge, rim) = end(k);
            let reach = edge.min(rim);
            if k < directions {
                area += 0.5 * angle * reach * reach;
            }
            let point = (edge < rim).then_some([edge * cos, edge * sin]);
            if let (Some([x, y]), Some([a, b])) = (point, last) {
                length += (x - a).hypot(y - b);
            }
            last = point;
        }
        [area, length]
    }

    /// Directions around the centre for a region that may be narrow, and their number.
    fn stretch(&self) -> (Stretch, u32) {
        let [x, y] = self.middle;
        let distance = x.hypot(y);
        let outwards = if distance > 0.0 {
            [x / distance, y / distance]
        } else {
            [1.0, 0.0]
        };
        let along = [-outwards[1], outwards[0]];
        let extent = |axis: Point| self.end(axis) + self.end(axis.map(|x| -x));
        let (depth, length) = (extent(outwards), extent(along));
        // The ends of a narrow region subtend a small angle at its centre.
        let directions = if depth < 0.25 * length { 8192 } else { 1024 };
        let stretch = Stretch {
            outwards,
            depth,
            length,
        };
        (stretch, directions)
    }

    /// Distance of the farthest point of the region from an axis, given relative to the centre of the pillar.
    pub(crate) fn farthest_from(&self, axis: Point) -> f64 {
        const DIRECTIONS: usize = 90;
        let step = 2.0 * PI / DIRECTIONS as f64;
        let distance = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let end = self.end([cos, sin]);
            let [x, y] = self.middle;
            (x + end * cos - axis[0]).hypot(y + end * sin - axis[1])
        };
        let (best, _) = (0..DIRECTIONS)
            .map(|k| (k as f64 * step, distance(k as f64 * step)))
            .fold(
                (0.0, 0.0),
                |best, next| if next.1 > best.1 { next } else { best },
            );
        // The boundary may have a kink where the contact ends on the rim: no derivatives are used.
        let (mut low, mut high) = (best - step, best + step);
        for _ in 0..60 {
            let third = (high - low) / 3.0;
            if distance(low + third) < distance(high - third) {
                low += third;
            } else {
                high -= third;
            }
        }
        distance(0.5 * (low + high)).max(distance(best))
    }

    /// Coefficients of the linear and quadratic part of `l` along a vector from the centre.
    fn along(&self, [x, y]: Point) -> [f64; 2] {
        let [k0, k1, k2, k3, k4] = self.conic;
        [k0 * x + k1 * y, (k2 * x + k3 * y) * x + k4 * y * y]
    }

    /// Distance from the centre to the edge of the contact in a direction.
    fn end(&self, direction: Point) -> f64 {
        let [linear, square] = self.along(direction);
        first_root(linear, square).min(rim_distance(self.middle, direction))
    }

    /// Visits points of the region (relative to its centre) with the weights `sqrt(l) dA/mu`.
    fn integrate(&self, rule: &[(f64, f64)], mut visit: impl FnMut(Point, f64)) {
        let (stretch, directions) = self.stretch();
        let step = 2.0 * PI / f64::from(directions);
        for k in 0..directions {
            let (direction, angle) = stretch.direction(step * (f64::from(k) + 0.5), step);
            let ahead = rim_distance(self.middle, direction);
            let behind = rim_distance(self.middle, direction.map(|x| -x));
            let end = self.end(direction);
            let [linear, square] = self.along(direction);
            for (part, weight) in rule {
                let t = end * part;
                let mu = ((ahead - t) * (behind + t)).max(f64::MIN_POSITIVE).sqrt();
                let level = (1.0 + (linear + square * t) * t).max(0.0);
                let area = angle * t * end * weight;
                visit(direction.map(|x| t * x), area * level.sqrt() / mu);
            }
        }
    }
}

/// Gauss rule in `t = sin(s)`, which removes a square-root singularity at `t = 1`, in numerator or denominator.
fn rule_to_roots() -> Vec<(f64, f64)> {
    gauss_legendre(12)
        .into_iter()
        .map(|(node, weight)| {
            let (sin, cos) = (0.25 * PI * (node + 1.0)).sin_cos();
            (sin, 0.25 * PI * weight * cos)
        })
        .collect()
}

fn rim_angle(place: f64) -> f64 {
    2.0 * PI * place / RIM as f64
}

/// Distance from a point of the top to the rim in a direction.
fn rim_distance([x, y]: Point, [cos, sin]: Point) -> f64 {
    let along = x * cos + y * sin;
    let left = (1.0 - x * x - y * y).max(0.0);
    (along * along + left).sqrt() - along
}

/// The first positive root of `1 + b t + c t^2`; infinite if there is none.
fn first_root(b: f64, c: f64) -> f64 {
    let discriminant = b * b - 4.0 * c;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    let below = discriminant.sqrt() - b;
    if below > 0.0 {
        2.0 / below
    } else {
        f64::INFINITY
    }
}

/// Value at zero of the straight line through two points.
fn closing(x: [f64; 2], y: [f64; 2]) -> f64 {
    y[0] - x[0] * (y[1] - y[0]) / (x[1] - x[0])
}

/// The conic `1 + k0 x + ... = 0` around the centre that fits weighted points best; all coefficients are zero without points.
fn conic_through(middle: Point, points: &[(Point, f64)]) -> [f64; 5] {
    let from_middle = |point: &Point| [point[0] - middle[0], point[1] - middle[1]];
    let squares: f64 = points
        .iter()
        .map(|(point, _)| from_middle(point).map(|x| x * x).iter().sum::<f64>())
        .sum();
    if points.is_empty() || squares <= 0.0 {
        return [0.0; 5];
    }
    let scale = (squares / points.len() as f64).sqrt();
    let mut matrix = [[0.0; 5]; 5];
    let mut right = [0.0; 5];
    for (point, weight) in points {
        let [x, y] = from_middle(point).map(|x| x / scale);
        let row = [x, y, x * x, x * y, y * y];
        for (i, a) in row.iter().enumerate() {
            for (j, b) in row.iter().enumerate() {
                matrix[i][j] += weight * a * b;
            }
            right[i] -= weight * a;
        }
    }
    for (k, row) in matrix.iter_mut().enumerate() {
        row[k] += if k < 2 { 1e-9 } else { STRAIGHTNESS };
    }
    let mut flat = matrix.concat();
    if !factorise(&mut flat, 5) {
        return [0.0; 5];
    }
    solve_lower(&flat, 5, &mut right);
    solve_upper(&flat, 5, &mut right);
    let [k0, k1, k2, k3, k4] = right;
    let square = scale * scale;
    [
        k0 / scale,
        k1 / scale,
        k2 / square,
        k3 / square,
        k4 / square,
    ]
}

/// Solution of three equations with a symmetric matrix.
fn solve_3(matrix: [[f64; 3]; 3], mut right: [f64; 3]) -> Option<[f64; 3]> {
    let mut flat = matrix.concat();
    factorise(&mut flat, 3).then(|| {
        solve_lower(&flat, 3, &mut right);
        solve_upper(&flat, 3, &mut right);
        right
    })
}

/// Interpolation along a line of functions that are polynomials in the plane, such as the modes of a disc (their degree and order have the
/// same parity). The function is evaluated at the smallest sufficient number of points.
struct RayLine {
    /// Chebyshev points between 0 and 1.
    nodes: Vec<f64>,
    /// The weights of the nodes, sample by sample.
    weights: Vec<f64>,
}

impl RayLine {
    fn new(degree: usize) -> Self {
        let count = degree + 1;
        let angle = |k: usize| PI * (k as f64 + 0.5) / count as f64;
        let nodes: Vec<f64> = (0..count).map(|k| 0.5 - 0.5 * angle(k).cos()).collect();
        let mut weights = Vec::with_capacity(Ray::SAMPLES * count);
        for sample in 0..Ray::SAMPLES {
            let x = sample as f64 / (Ray::SAMPLES - 1) as f64;
            // Lagrange polynomials as products, since there are few nodes.
            weights.extend((0..count).map(|k| -> f64 {
                let others = (0..count).filter(|j| *j != k);
                others
                    .map(|j| (x - nodes[j]) / (nodes[k] - nodes[j]))
                    .product()
            }));
        }
        Self { nodes, weights }
    }

    /// Samples the gap at equal distances from 0 to `length`.
    fn ray(&self, length: f64, mut gap: impl FnMut(f64) -> f64) -> Ray {
        let at_nodes: Vec<f64> = self.nodes.iter().map(|x| gap(length * x)).collect();
        let mut rows = self.weights.chunks_exact(at_nodes.len());
        Ray {
            step: length / (Ray::SAMPLES - 1) as f64,
            gaps: std::array::from_fn(|_| rows.next().map_or(0.0, |row| dot(row, &at_nodes))),
        }
    }
}

/// The gap along a line.
struct Ray {
    /// Distance between samples.
    step: f64,
    gaps: [f64; Ray::SAMPLES],
}

impl Ray {
    const SAMPLES: usize = 40;

    /// The last position at which the gap crosses a level from below.
    fn last_below(&self, level: f64) -> Option<f64> {
        let below = self.gaps.iter().rposition(|gap| *gap < level)?;
        let after = self.gaps.get(below + 1)?;
        let fraction = (level - self.gaps[below]) / (after - self.gaps[below]);
        Some(self.step * (below as f64 + fraction))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::disc::basis::compliances;
    use crate::halfspace::disc::nodes::Resolution;
    use crate::numerics::quadrature::hemisphere;
    use crate::solve::rules::unilateral::{LocalSolver, PillarTop};

    /// A lens with its axis at `(-distance, 0)` whose undeformed surface would penetrate the top up to `x = end`: solved with square
    /// elements, 256 across the top, by conjugate gradients with FFTs, in a separate program.
    struct Reference {
        distance: f64,
        end: f64,
        kappa: f64,
        force: f64,
        /// Covered fraction of the top.
        covered: f64,
        /// Distance of the farthest contact point from the lens axis.
        reach: f64,
    }

    const REFERENCES: [Reference; 4] = [
        Reference {
            distance: 30.0,
            end: -0.5,
            kappa: 0.3,
            force: 0.19640,
            covered: 0.0781,
            reach: 30.0 - 0.6438,
        },
        Reference {
            distance: 30.0,
            end: 0.0,
            kappa: 0.3,
            force: 0.58508,
            covered: 0.2183,
            reach: 30.0 - 0.3270,
        },
        Reference {
            distance: 5.0,
            end: 0.5,
            kappa: 0.3,
            force: 1.06371,
            covered: 0.3990,
            reach: 5.0 - 0.0068,
        },
        Reference {
            distance: 8.0,
            end: -0.8,
            kappa: 0.0,
            force: 0.04305,
            covered: 0.0199,
            reach: 8.0 - 0.8466,
        },
    ];

    impl Reference {
        /// The solution on nodes of a degree: coefficients of `q` and of the gap.
        fn solve(&self, degree: usize) -> (Vec<f64>, Vec<f64>) {
            let resolution = Resolution::of_nodes(degree);
            let top = PillarTop::new(resolution, 2, self.kappa);
            let mut basis = BasisEvaluator::new(4);
            let mut values = vec![0.0; mode_count(4)];
            let mut load = vec![0.0; mode_count(4)];
            for ([x, y], weight) in hemisphere(8, 25) {
                basis.evaluate([x, y], &mut values);
                let curved = self.end * self.end - x * x - y * y;
                let target = self.end - x + curved / (2.0 * self.distance);
                for (b, value) in load.iter_mut().zip(&values) {
                    *b += weight * target * value;
                }
            }
            let mut solver = LocalSolver::new(&top);
            let mut active = Vec::new();
            assert!(solver.solve(&top, &load, &mut active).converged);
            let mut density = vec![0.0; top.count()];
            solver.coefficients(&top, &load, &mut density);
            let mut gap: Vec<f64> = density
                .iter()
                .zip(compliances(degree, self.kappa))
                .map(|(c, lambda)| c * lambda)
                .collect();
            for (gap, load) in gap.iter_mut().zip(&load) {
                *gap -= load;
            }
            (density, gap)
        }
    }

    #[test]
    fn the_edge_of_the_contact_is_where_fine_elements_have_it() {
        for (degree, allowed) in [(8, 0.1), (12, 0.06), (24, 0.04)] {
            let mut finder = CoverFinder::new(degree);
            for reference in &REFERENCES {
                let (density, gap) = reference.solve(degree);
                let part = finder.find(&density, &gap).unwrap();
                let reach = part.region.farthest_from([-reference.distance, 0.0]);
                let off = reach - reference.reach;
                let points = 400;
                let inside = (0..points * points)
                    .map(|k| [k % points, k / points])
                    .map(|place| place.map(|k| (k as f64 + 0.5) * 2.0 / points as f64 - 1.0))
                    .filter(|point| point[0].hypot(point[1]) < 1.0)
                    .filter(|point| part.density(*point) > 0.0)
                    .count();
                let covered = inside as f64 * 4.0 / (points * points) as f64 / PI;
                println!(
                    "degree {degree}: reach {off:.4}, covered {covered:.4}, {:.4}",
                    reference.covered
                );
                assert!(off.abs() < allowed, "degree {degree}: {reach}");
                assert!(
                    (covered - reference.covered).abs() < 0.03,
                    "degree {degree}: {covered}"
                );
            }
        }
    }

    /// The pressure of the expansion covers up to five times the contact area.
    #[test]
    fn the_pressure_is_nowhere_negative_and_has_the_force_of_the_expansion() {
        let mut finder = CoverFinder::new(8);
        for reference in &REFERENCES {
            let (density, gap) = reference.solve(8);
            let part = finder.find(&density, &gap).unwrap();
            let force = UNIT_FORCE * density[0];
            assert!((force / reference.force - 1.0).abs() < 0.1);
            let mut sum = 0.0;
            for ([x, y], weight) in hemisphere(600, 4801) {
                let q = part.density([x, y]);
                assert!(q >= 0.0);
                sum += weight * q;
            }
            // A region of 2 % of the top, narrow along its rim, is the most difficult case.
            assert!((sum / force - 1.0).abs() < 3e-3, "{sum} {force}");
        }
    }

    #[test]
    fn a_polynomial_is_found_again_on_a_ray() {
        let gap = |s: f64| 0.3 - 2.0 * s + s.powi(3) - 0.01 * s.powi(8);
        let ray = RayLine::new(8).ray(1.7, gap);
        for (k, found) in ray.gaps.iter().enumerate() {
            let expected = gap(ray.step * k as f64);
            assert!((found - expected).abs() < 1e-13, "{k}");
        }
    }
}
