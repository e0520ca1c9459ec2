//! A pressure on floor cells, and the displacement that it causes at any point.
//!
//! Cells near a point are treated as rectangles, more distant cells in groups by their multipoles: with `(rho, phi)` about the centre of a
//! group,
//!
//! ```text
//! 1/|x - x'| = sum_l rho'^l/rho^(l+1) sum_k c_k c_(l-k) cos((l - 2k)(phi - phi')),    c_k = (2k)!/(4^k k!^2)
//! ```
//!
//! (E. T. Whittaker and G. N. Watson, A Course of Modern Analysis, section 15.1). Groups are halved until they are small compared with
//! their distance.
//!
//! The correction for [layers](crate::halfspace::layer) is smooth over a thickness, even near a point: groups that are small compared with
//! this scale act as forces at Chebyshev nodes.

use crate::halfspace::elements::rectangle::Rectangle;
use crate::halfspace::elements::scattered::{NODES, chebyshev_nodes, weights};
use crate::halfspace::layer::force::AroundForce;
use crate::numerics::quadrature::gauss_legendre;
use crate::problem::layer::WeightedLayer;
use crate::problem::point::turned;
use crate::problem::{Cells, Grid, Point};
use num_complex::Complex64;
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// Number of degrees of the multipoles, and of multipoles of all orders.
const DEGREES: usize = 10;
const MULTIPOLES: usize = DEGREES * (DEGREES + 2) / 4;

/// Largest radius of a group, relative to its distance, for which multipoles are used: the truncation error is then less than 1e-6 of the
/// displacement due to the group, and a tenth of this on average.
const SMALL: f64 = 0.28;

/// The same for the correction for layers with Chebyshev nodes, relative to the length over which it is smooth.
const SMOOTH: f64 = 0.2;

/// Number of cells up to which groups are not divided.
const FEW_CELLS: usize = 12;

/// Pressures on some cells of a grid.
#[derive(Debug, Clone)]
pub(crate) struct FloorLoad {
    cells: Cells,
    pressure: Vec<f64>,
    /// Index in the vector of every cell of the grid.
    place: Vec<u32>,
    rectangle: Rectangle,
    /// Correction for layers around a force on a cell; `None` on half-spaces.
    layers: Option<Arc<AroundForce>>,
    /// Rotation of the grid about the lens axis, rad.
    rotation: f64,
    /// Computed for the first displacement.
    groups: OnceLock<Groups>,
}

/// Cells in an order in which groups are contiguous.
#[derive(Debug, Clone)]
struct Groups {
    /// Centre and pressure.
    cells: Vec<(Point, f64)>,
    /// The group of all cells is the first; the two halves of a group follow it.
    groups: Vec<Group>,
}

#[derive(Debug, Clone)]
struct Group {
    centre: Point,
    radius: f64,
    multipoles: [Complex64; MULTIPOLES],
    parts: Parts,
    /// Positions and pressures (times a cell area) that represent the group where the correction is smooth.
    nodes: Vec<(Point, f64)>,
}

#[derive(Debug, Clone, Copy)]
enum Parts {
    Halves([usize; 2]),
    Cells { first: usize, end: usize },
}

impl FloorLoad {
    pub(crate) fn new(cells: Cells, pressure: Vec<f64>) -> Self {
        let mut place = vec![u32::MAX; cells.grid().cell_count()];
        for (number, index) in cells.indices().enumerate() {
            place[index] = number as u32;
        }
        let [width, height] = cells.grid().cell();
        Self {
            rectangle: Rectangle::new(width, height),
            layers: None,
            rotation: 0.0,
            place,
            pressure,
            cells,
            groups: OnceLock::new(),
        }
    }

    /// The same on layers, in the unit of length of the cells.
    pub(crate) fn with_layers(mut self, layers: &[WeightedLayer]) -> Self {
        self.layers = AroundForce::on_cell(layers, self.cell()).map(Arc::new);
        self.groups = OnceLock::new();
        self
    }

    /// The same, rotated about the lens axis, rad.
    pub(crate) fn turned(mut self, angle: f64) -> Self {
        self.rotation += angle;
        self
    }

    /// Whether the grid is rotated.
    pub(crate) fn is_turned(&self) -> bool {
        self.rotation != 0.0
    }

    /// Position of a point of the grid after the rotation.
    pub(crate) fn placed(&self, point: Point) -> Point {
        turned(point, self.rotation)
    }

    /// Position of a point in the grid before the rotation.
    fn turned_back(&self, point: Point) -> Point {
        if self.rotation == 0.0 {
            point
        } else {
            turned(point, -self.rotation)
        }
    }

    /// Cells and pressures in SI units; the current values are in units of `length` and `pressure`.
    pub(crate) fn in_metres(&self, length: f64, pressure: f64) -> (Cells, Vec<f64>) {
        let pressures = self.pressure.iter().map(|p| p * pressure).collect();
        (self.cells.scaled(length), pressures)
    }

    /// Centre, before the rotation, and pressure of every cell.
    pub(crate) fn loaded_cells(&self) -> impl Iterator<Item = (Point, f64)> + '_ {
        self.cells.centres().zip(self.pressure.iter().copied())
    }

    /// Sides of a cell.
    pub(crate) fn cell(&self) -> [f64; 2] {
        self.cells.grid().cell()
    }

    /// The pressure at a point.
    pub(crate) fn pressure(&self, point: Point) -> f64 {
        let [x, y] = self.turned_back(point);
        let grid: &Grid = self.cells.grid();
        let ([left, low], [width, height]) = (grid.origin(), grid.cell());
        let (column, row) = (((x - left) / width).floor(), ((y - low) / height).floor());
        let inside = (0.0..grid.columns() as f64).contains(&column)
            && (0.0..grid.rows() as f64).contains(&row);
        if !inside {
            return 0.0;
        }
        let place = self.place[row as usize * grid.columns() + column as usize];
        self.pressure.get(place as usize).copied().unwrap_or(0.0)
    }

    /// The displacement at a point, for unit compliance.
    pub(crate) fn displacement(&self, point: Point) -> f64 {
        let groups = self.groups.get_or_init(|| {
            Groups::new(
                self.loaded_cells().collect(),
                self.cell(),
                self.layers.is_some(),
            )
        });
        if groups.groups.is_empty() {
            0.0
        } else {
            let point = self.turned_back(point);
            let area: f64 = self.cell().into_iter().product();
            let of_layers = self.layers.as_ref().map_or(0.0, |around| {
                area * groups.added_by_layers(0, point, around)
            });
            (groups.potential(0, point, &self.rectangle) + of_layers) / PI
        }
    }
}

impl Groups {
    /// Creates groups, with or without nodes.
    fn new(cells: Vec<(Point, f64)>, cell: [f64; 2], with_nodes: bool) -> Self {
        let mut building = Building {
            moments: moments_of_cell(cell),
            cell,
            groups: Vec::new(),
            cells,
        };
        let count = building.cells.len();
        if count > 0 {
            building.divide(0, count);
        }
        let Building {
            mut groups, cells, ..
        } = building;
        if with_nodes {
            for group in 0..groups.len() {
                if let Parts::Cells { .. } = groups[group].parts {
                    continue;
                }
                groups[group].nodes = Self::nodes(&groups, group, &cells);
            }
        }
        Self { cells, groups }
    }

    /// Pressures at Chebyshev nodes of the square around a group, from those of its cells.
    fn nodes(groups: &[Group], group: usize, cells: &[(Point, f64)]) -> Vec<(Point, f64)> {
        let Group { centre, radius, .. } = groups[group];
        let (mut first, mut last) = (group, group);
        while let Parts::Halves([low, _]) = groups[first].parts {
            first = low;
        }
        while let Parts::Halves([_, high]) = groups[last].parts {
            last = high;
        }
        let (Parts::Cells { first, .. }, Parts::Cells { end, .. }) =
            (groups[first].parts, groups[last].parts)
        else {
            return Vec::new();
        };
        let mut sums = [[0.0; NODES]; NODES];
        for (at, pressure) in &cells[first..end] {
            let [along, across] = [0, 1].map(|k| weights((at[k] - centre[k]) / radius));
            for (sums, along) in sums.iter_mut().zip(along) {
                for (sum, across) in sums.iter_mut().zip(across) {
                    *sum += pressure * along * across;
                }
            }
        }
        let places = chebyshev_nodes();
        let node = |k: usize| {
            let (i, j) = (k / NODES, k % NODES);
            let at = [
                centre[0] + radius * places[i],
                centre[1] + radius * places[j],
            ];
            (at, sums[i][j])
        };
        (0..NODES * NODES).map(node).collect()
    }

    /// Correction for layers of the displacement at a point, per cell area.
    fn added_by_layers(&self, group: usize, point: Point, around: &AroundForce) -> f64 {
        let group = &self.groups[group];
        let distance = |at: &Point| (point[0] - at[0]).hypot(point[1] - at[1]);
        let sum = |charges: &[(Point, f64)]| -> f64 {
            let parts = charges
                .iter()
                .map(|(at, pressure)| pressure * around.value(distance(at)));
            parts.sum()
        };
        match group.parts {
            Parts::Cells { first, end } => sum(&self.cells[first..end]),
            Parts::Halves(_)
                if group.radius < SMOOTH * around.smoothness(distance(&group.centre)) =>
            {
                sum(&group.nodes)
            }
            Parts::Halves(halves) => halves
                .iter()
                .map(|half| self.added_by_layers(*half, point, around))
                .sum(),
        }
    }

    fn potential(&self, group: usize, point: Point, rectangle: &Rectangle) -> f64 {
        let group = &self.groups[group];
        let [x, y] = [point[0] - group.centre[0], point[1] - group.centre[1]];
        let distance = x.hypot(y);
        if group.radius < SMALL * distance {
            return group.far_potential([x, y], distance);
        }
        match group.parts {
            Parts::Halves(halves) => halves
                .iter()
                .map(|half| self.potential(*half, point, rectangle))
                .sum(),
            Parts::Cells { first, end } => self.cells[first..end]
                .iter()
                .map(|([u, v], pressure)| {
                    pressure * rectangle.potential(point[0] - u, point[1] - v)
                })
                .sum(),
        }
    }
}

/// Groups during their construction.
struct Building {
    /// Sides of a cell, and the moments about its centre of a unit pressure on it.
    cell: [f64; 2],
    moments: RealMoments,
    cells: Vec<(Point, f64)>,
    groups: Vec<Group>,
}

impl Building {
    /// Creates the group of a range of cells and its parts. Returns its index and its moments, in units of its radius.
    fn divide(&mut self, first: usize, end: usize) -> (usize, Moments) {
        let place = self.groups.len();
        let own = &mut self.cells[first..end];
        let bounds = |k: usize| {
            own.iter().fold(
                (f64::INFINITY, f64::NEG_INFINITY),
                |(low, high), (at, _)| (low.min(at[k]), high.max(at[k])),
            )
        };
        let bounds = [bounds(0), bounds(1)];
        let centre = bounds.map(|(low, high)| 0.5 * (low + high));
        let sides = [0, 1].map(|k| bounds[k].1 - bounds[k].0 + self.cell[k]);
        let radius = 0.5 * sides[0].hypot(sides[1]);
        self.groups.push(Group {
            centre,
            radius,
            multipoles: [Complex64::default(); MULTIPOLES],
            parts: Parts::Cells { first, end },
            nodes: Vec::new(),
        });
        let mut moments = Moments::default();
        if end - first > FEW_CELLS {
            let along = usize::from(sides[1] > sides[0]);
            let middle = own.len() / 2;
            own.select_nth_unstable_by(middle, |a, b| a.0[along].total_cmp(&b.0[along]));
            let halves = [(first, first + middle), (first + middle, end)].map(|(first, end)| {
                let (half, of_half) = self.divide(first, end);
                let Group {
                    centre: from,
                    radius: unit,
                    ..
                } = self.groups[half];
                let shift = [0, 1].map(|k| (from[k] - centre[k]) / radius);
                moments.add(&of_half.moved(unit / radius, shift));
                half
            });
            self.groups[place].parts = Parts::Halves(halves);
        } else {
            let mut at_centres = Moments::default();
            for ([x, y], pressure) in own {
                let at = [(*x - centre[0]) / radius, (*y - centre[1]) / radius];
                at_centres.add_force(*pressure, at);
            }
            moments = at_centres.spread(&self.moments, radius.recip());
        }
        self.groups[place].multipoles = moments.multipoles();
        (place, moments)
    }
}

/// Points around the centre of a cell that represent it, with weights whose sum is its area.
fn quadrature([width, height]: [f64; 2]) -> Vec<(Point, f64)> {
    let rule = gauss_legendre(3);
    let point = |(u, weight_u): (f64, f64), (v, weight_v): (f64, f64)| {
        let weight = 0.25 * weight_u * weight_v * width * height;
        ([0.5 * u * width, 0.5 * v * height], weight)
    };
    let rows = rule.iter();
    rows.flat_map(|u| rule.iter().map(move |v| point(*u, *v)))
        .collect()
}

/// [`Moments`] that are real because the forces are symmetric under reflections of x and of y; those with odd `a + b` are zero.
type RealMoments = [[f64; DEGREES]; DEGREES];

/// The moments about its centre of a unit pressure on a cell.
fn moments_of_cell(cell: [f64; 2]) -> RealMoments {
    let mut moments = Moments::default();
    for (at, weight) in quadrature(cell) {
        moments.add_force(weight, at);
    }
    moments.0.map(|row| row.map(|moment| moment.re))
}

/// `binomials[n][k]`, `n!/(k! (n - k)!)`.
fn binomials() -> [[f64; DEGREES]; DEGREES] {
    let mut binomials = [[0.0; DEGREES]; DEGREES];
    for n in 0..DEGREES {
        binomials[n][0] = 1.0;
        for k in 1..=n {
            binomials[n][k] = binomials[n - 1][k - 1] + binomials[n - 1][k];
        }
    }
    binomials
}

/// Sums of `p z^a conj(z)^b` over forces `p` at `z = x + i y`, in row `a` and column `b`, for `a + b` less than the number of degrees.
#[derive(Default)]
struct Moments([[Complex64; DEGREES]; DEGREES]);

impl Moments {
    fn add_force(&mut self, force: f64, [x, y]: Point) {
        let z = Complex64::new(x, y);
        let mut row = Complex64::from(force);
        for (a, moments) in self.0.iter_mut().enumerate() {
            let mut power = row;
            for moment in &mut moments[..DEGREES - a] {
                *moment += power;
                power *= z.conj();
            }
            row *= z;
        }
    }

    fn add(&mut self, other: &Self) {
        for (own, other) in self.0.iter_mut().flatten().zip(other.0.iter().flatten()) {
            *own += other;
        }
    }

    /// The moments after every force is distributed like the forces with the given moments, whose positions are scaled by a factor: the
    /// powers of `z + factor u` by the binomial theorem.
    fn spread(&self, of_each: &RealMoments, factor: f64) -> Self {
        let binomials = binomials();
        let mut scaled = *of_each;
        for (i, row) in scaled.iter_mut().enumerate() {
            for (j, moment) in row[..DEGREES - i].iter_mut().enumerate() {
                *moment *= factor.powi((i + j) as i32);
            }
        }
        let mut spread = Self::default();
        for a in 0..DEGREES {
            for b in 0..DEGREES - a {
                let mut sum = Complex64::default();
                for i in 0..=a {
                    for j in (i % 2..=b).step_by(2) {
                        let weight = binomials[a][i] * binomials[b][j] * scaled[i][j];
                        sum += weight * self.0[a - i][b - j];
                    }
                }
                spread.0[a][b] = sum;
            }
        }
        spread
    }

    /// The moments after all positions are scaled by a factor and then shifted: the powers of `factor z + shift` by the binomial theorem.
    fn moved(mut self, factor: f64, [x, y]: Point) -> Self {
        let shift = Complex64::new(x, y);
        let mut powers = [1.0; DEGREES];
        for degree in 1..DEGREES {
            powers[degree] = powers[degree - 1] * factor;
        }
        for (a, row) in self.0.iter_mut().enumerate() {
            for (moment, power) in row[..DEGREES - a].iter_mut().zip(&powers[a..]) {
                *moment *= power;
            }
            // Pascal's triangle: after `k` rounds the powers are those of `(z + shift)^k z^(b - k)`.
            for k in 1..DEGREES - a {
                for b in (k..DEGREES - a).rev() {
                    row[b] += shift.conj() * row[b - 1];
                }
            }
        }
        for k in 1..DEGREES {
            for a in (k..DEGREES).rev() {
                let (below, from) = self.0.split_at_mut(a);
                for (moment, lower) in from[0][..DEGREES - a].iter_mut().zip(&below[a - 1]) {
                    *moment += shift * lower;
                }
            }
        }
        self
    }

    /// The multipoles with their factors, by degree and increasing order.
    fn multipoles(&self) -> [Complex64; MULTIPOLES] {
        let mut central = [1.0; DEGREES];
        for k in 1..DEGREES {
            central[k] = central[k - 1] * (2 * k - 1) as f64 / (2 * k) as f64;
        }
        let mut multipoles = [Complex64::default(); MULTIPOLES];
        let mut number = 0;
        for degree in 0..DEGREES {
            for order in (degree % 2..=degree).step_by(2) {
                let twice = if order == 0 { 1.0 } else { 2.0 };
                let k = (degree - order) / 2;
                // rho^l exp(i m phi) = z^(l - k) conj(z)^k
                multipoles[number] =
                    twice * central[k] * central[degree - k] * self.0[degree - k][k];
                number += 1;
            }
        }
        multipoles
    }
}

impl Group {
    fn far_potential(&self, [x, y]: Point, distance: f64) -> f64 {
        let turn = Complex64::new(x / distance, y / distance);
        let mut turns = [Complex64::new(1.0, 0.0); DEGREES];
        for order in 1..DEGREES {
            turns[order] = turns[order - 1] * turn;
        }
        let ratio = self.radius / distance;
        let (mut power, mut sum, mut number) = (1.0, 0.0, 0);
        for degree in 0..DEGREES {
            let mut of_degree = 0.0;
            for order in (degree % 2..=degree).step_by(2) {
                let multipole = self.multipoles[number];
                of_degree += multipole.re * turns[order].re + multipole.im * turns[order].im;
                number += 1;
            }
            sum += power * of_degree;
            power *= ratio;
        }
        sum / distance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected: the sums over all points of all cells.
    #[test]
    fn moments_of_cells_are_those_of_their_points() {
        let cell = [0.31, 0.27];
        let cells = [([0.4, -1.1], 0.7), ([-0.8, 0.3], -0.2), ([1.3, 0.9], 1.9)];
        let unit = 1.7;
        let (mut centres, mut expected) = (Moments::default(), Moments::default());
        for ([x, y], pressure) in cells {
            centres.add_force(pressure, [x / unit, y / unit]);
            for ([u, v], weight) in quadrature(cell) {
                expected.add_force(weight * pressure, [(x + u) / unit, (y + v) / unit]);
            }
        }
        let found = centres.spread(&moments_of_cell(cell), 1.0 / unit);
        for a in 0..DEGREES {
            for b in 0..DEGREES - a {
                let (found, expected) = (found.0[a][b], expected.0[a][b]);
                assert!(
                    (found - expected).norm() < 1e-14,
                    "{a} {b}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn groups_do_what_their_cells_do() {
        let grid = Grid::new(90, 80, [0.31, 0.27], [-13.0, -11.0]).unwrap();
        let cells = Cells::where_centre(&grid, |[x, y]| (x * x + 1.3 * y * y).sin() > -0.2);
        let pressure: Vec<f64> = (0..cells.len())
            .map(|k| 1.0 + (0.37 * k as f64).sin())
            .collect();
        let load = FloorLoad::new(cells.clone(), pressure.clone());
        let rectangle = Rectangle::new(0.31, 0.27);
        let mut worst = 0.0_f64;
        for k in 0..200 {
            let k = f64::from(k);
            let point = [20.0 * (1.3 * k).sin(), 20.0 * (0.7 * k).cos()];
            let direct: f64 = cells
                .centres()
                .zip(&pressure)
                .map(|([x, y], p)| p / PI * rectangle.potential(point[0] - x, point[1] - y))
                .sum();
            worst = worst.max((load.displacement(point) / direct - 1.0).abs());
        }
        println!("worst {worst:e}");
        assert!(worst < 1e-7, "{worst:e}");
        // On layers that are thinner and thicker than the extent of the load.
        for thickness in [1.0, 30.0] {
            let film = WeightedLayer {
                thickness,
                ..crate::halfspace::layer::tests::film()
            };
            let load = load.clone().with_layers(&[film]);
            let around = AroundForce::on_cell(&[film], [0.31, 0.27]).unwrap();
            for k in 0..50 {
                let k = f64::from(k);
                let point = [20.0 * (1.3 * k).sin(), 20.0 * (0.7 * k).cos()];
                let parts = cells.centres().zip(&pressure).map(|([x, y], p)| {
                    let (x, y) = (point[0] - x, point[1] - y);
                    let of_layers = 0.31 * 0.27 * around.value(x.hypot(y));
                    let of_half_spaces = rectangle.potential(x, y);
                    [
                        p / PI * (of_half_spaces + of_layers),
                        p / PI * of_half_spaces,
                    ]
                });
                let [direct, scale] =
                    parts.fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]]);
                let error = (FloorLoad::displacement(&load, point) - direct) / scale;
                assert!(error.abs() < 2e-6, "{thickness} {error:e}");
            }
        }
        let middle = cells.centres().nth(777).unwrap();
        assert!((load.pressure(middle) - pressure[777]).abs() < 1e-15);
        assert!(load.pressure([100.0, 0.0]).abs() < 1e-15);
    }
}
