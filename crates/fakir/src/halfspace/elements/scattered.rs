//! Elements on copies of one grid, at arbitrary positions and of arbitrary size.
//!
//! The cells of every grid are those of a pattern, shifted and scaled. The interaction of the cells of a grid is a convolution. The effect
//! on cells of other grids is summed cell by cell for near grids. Between distant parts of grids, the potential is interpolated by
//! Chebyshev polynomials on both sides, in a tree of boxes, so that the work grows approximately in proportion to the number of cells (W.
//! Fong and E. Darve, J. Comput. Phys. 228, 8712 (2009)).
//!
//! The interaction of cells of different sizes is not symmetric if displacements are evaluated at their centres. The mean of both
//! directions is used, which differs from either in proportion to the square of the cell size divided by the distance. For cells of equal
//! size the result equals that of the other operators.

use super::lattice::LatticeOfGrids;
use super::operator::Operator;
use super::potential::CellPotential;
use crate::halfspace::layer::force::AroundForce;
use crate::problem::layer::WeightedLayer;
use crate::problem::pillar_field::different;
use crate::problem::{Cells, Point};
use std::f64::consts::PI;
use std::ops::Range;

/// Number of Chebyshev nodes along a side of a box.
pub(crate) const NODES: usize = 7;

/// Number of nodes of a box.
const ALL_NODES: usize = NODES * NODES;

/// Largest number of cells of one grid in a box that is not divided further.
const LEAF: usize = 64;

/// Largest sum of the half diagonals of two boxes, relative to the distance of their centres, for which they are far from each other. The
/// interpolation error is then about 1e-7 of the displacement (measured).
const SMALLNESS: f64 = 0.5;

/// A copy of the grid: the position of its centre and its scale.
pub(crate) type PlacedGrid = (Point, f64);

/// Values at the nodes of a box: for `1/r`, and for its Laplacian, which accounts for the size of cells.
type NodeValues = [[f64; ALL_NODES]; 2];

const NO_VALUES: NodeValues = [[0.0; ALL_NODES]; 2];

/// A box around the centres of some cells.
struct Part {
    /// Range of the cells in the order of the tree.
    cells: Range<usize>,
    middle: Point,
    half: [f64; 2],
    /// The two boxes into which it is divided, which precede it.
    halves: Option<[usize; 2]>,
    of_one_grid: bool,
}

impl Part {
    fn around(cells: Range<usize>, points: impl Iterator<Item = Point>) -> Self {
        let nothing = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        let [low, high] = points.fold(nothing, |[low, high], point| {
            [
                [0, 1].map(|k| point[k].min(low[k])),
                [0, 1].map(|k| point[k].max(high[k])),
            ]
        });
        Self {
            cells,
            middle: [0, 1].map(|k| 0.5 * (low[k] + high[k])),
            half: [0, 1].map(|k| 0.5 * (high[k] - low[k])),
            halves: None,
            of_one_grid: false,
        }
    }

    fn half_diagonal(&self) -> f64 {
        self.half[0].hypot(self.half[1])
    }

    fn is_far_from(&self, other: &Self) -> bool {
        let [x, y] = [0, 1].map(|k| self.middle[k] - other.middle[k]);
        self.half_diagonal() + other.half_diagonal() <= SMALLNESS * x.hypot(y)
    }

    /// The weights of the nodes for the interpolated value at a point, along each side.
    fn weights(&self, point: Point) -> [[f64; NODES]; 2] {
        [0, 1].map(|k| {
            let away = point[k] - self.middle[k];
            // A side of zero length has its value at the centre.
            weights(if self.half[k] > 0.0 {
                away / self.half[k]
            } else {
                0.0
            })
        })
    }

    fn nodes(&self) -> [[f64; NODES]; 2] {
        let nodes = chebyshev_nodes();
        [0, 1].map(|k| nodes.map(|at| self.middle[k] + at * self.half[k]))
    }
}

/// Chebyshev nodes from -1 to 1.
pub(crate) fn chebyshev_nodes() -> [f64; NODES] {
    std::array::from_fn(|k| (PI * (k as f64 + 0.5) / NODES as f64).cos())
}

/// The weights of the Chebyshev nodes of an interval from -1 to 1: `1/p + 2/p Σ_n T_n(x_k) T_n(t)`.
pub(crate) fn weights(t: f64) -> [f64; NODES] {
    let polynomials = |x: f64| {
        let mut values = [1.0; NODES];
        values[1] = x;
        for n in 2..NODES {
            values[n] = 2.0 * x * values[n - 1] - values[n - 2];
        }
        values
    };
    let at = polynomials(t);
    chebyshev_nodes().map(|node| {
        let at_node = polynomials(node);
        let sum: f64 = at.iter().zip(&at_node).skip(1).map(|(a, b)| a * b).sum();
        (1.0 + 2.0 * sum) / NODES as f64
    })
}

/// Near and far pairs of parts of grids.
pub(crate) struct Interactions {
    /// Number of cells of the pattern.
    per_grid: usize,
    /// Centres of all cells, by grids.
    points: Vec<Point>,
    /// The cells in the order of the tree.
    order: Vec<u32>,
    /// The last part contains all cells.
    parts: Vec<Part>,
    /// Pairs of parts of different grids.
    far: Vec<[usize; 2]>,
    near: Vec<[usize; 2]>,
}

impl Interactions {
    /// Pairs between copies of a pattern, at least one.
    pub(crate) fn new(cells: &Cells, grids: &[PlacedGrid]) -> Self {
        let points: Vec<Point> = grids
            .iter()
            .flat_map(|(centre, scale)| {
                cells
                    .centres()
                    .map(move |at| [0, 1].map(|k| centre[k] + scale * at[k]))
            })
            .collect();
        let mut interactions = Self {
            per_grid: cells.len(),
            order: Vec::with_capacity(points.len()),
            points,
            parts: Vec::new(),
            far: Vec::new(),
            near: Vec::new(),
        };
        let mut numbers: Vec<usize> = (0..grids.len()).collect();
        let whole = interactions.divide_grids(&mut numbers, grids);
        interactions.pair(whole);
        interactions
    }

    /// Memory in bytes of the operator.
    pub(crate) fn memory_estimate(&self) -> usize {
        let count = |part: usize| self.parts[part].cells.len();
        let near: usize = self.near.iter().map(|&[a, b]| count(a) * count(b)).sum();
        let per_part = 2 * size_of::<NodeValues>() + size_of::<[Transfer; 2]>();
        let per_cell = size_of::<[[f64; NODES]; 2]>() + 64;
        let per_pair = 2 * size_of::<[usize; 2]>();
        8 * near
            + per_part * self.parts.len()
            + per_cell * self.points.len()
            + per_pair * (self.far.len() + self.near.len())
    }

    /// Divides grids until each part contains one; returns the index of the part with all of them.
    fn divide_grids(&mut self, numbers: &mut [usize], grids: &[PlacedGrid]) -> usize {
        if let [number] = numbers {
            let first = self.order.len();
            let unknowns = *number * self.per_grid..(*number + 1) * self.per_grid;
            self.order.extend(unknowns.map(|unknown| unknown as u32));
            return self.divide_cells(first..self.order.len());
        }
        let centres = numbers.iter().map(|number| grids[*number].0);
        let axis = longer_side(&Part::around(0..0, centres));
        numbers.sort_by(|a, b| grids[*a].0[axis].total_cmp(&grids[*b].0[axis]));
        let (low, high) = numbers.split_at_mut(numbers.len() / 2);
        let halves = [
            self.divide_grids(low, grids),
            self.divide_grids(high, grids),
        ];
        self.join(halves, false)
    }

    fn divide_cells(&mut self, cells: Range<usize>) -> usize {
        let points = &self.points;
        let at = |unknown: &u32| points[*unknown as usize];
        let own = &mut self.order[cells.clone()];
        let part = Part::around(cells.clone(), own.iter().map(at));
        if cells.len() <= LEAF {
            self.parts.push(Part {
                of_one_grid: true,
                ..part
            });
            return self.parts.len() - 1;
        }
        let axis = longer_side(&part);
        own.sort_by(|a, b| at(a)[axis].total_cmp(&at(b)[axis]));
        let middle = cells.start + cells.len() / 2;
        let halves = [
            self.divide_cells(cells.start..middle),
            self.divide_cells(middle..cells.end),
        ];
        self.join(halves, true)
    }

    fn join(&mut self, halves: [usize; 2], of_one_grid: bool) -> usize {
        let [low, high] = halves.map(|half| self.parts[half].cells.clone());
        let cells = low.start..high.end;
        let own = self.order[cells.clone()].iter();
        let part = Part::around(cells, own.map(|unknown| self.points[*unknown as usize]));
        self.parts.push(Part {
            halves: Some(halves),
            of_one_grid,
            ..part
        });
        self.parts.len() - 1
    }

    /// Finds the pairs within a part.
    fn pair(&mut self, whole: usize) {
        let mut open = vec![[whole; 2]];
        while let Some([one, other]) = open.pop() {
            let (a, b) = (&self.parts[one], &self.parts[other]);
            if one == other {
                // The interaction of the cells of one grid is computed separately.
                if !a.of_one_grid
                    && let Some([low, high]) = a.halves
                {
                    open.extend([[low, low], [high, high], [low, high]]);
                }
                continue;
            }
            if a.is_far_from(b) {
                self.far.push([one, other]);
                continue;
            }
            match (a.halves, b.halves) {
                (None, None) => self.near.push([one, other]),
                (Some([low, high]), None) => open.extend([[low, other], [high, other]]),
                (None, Some([low, high])) => open.extend([[one, low], [one, high]]),
                (Some(of_a), Some(of_b)) => {
                    if a.half_diagonal() >= b.half_diagonal() {
                        open.extend(of_a.map(|half| [half, other]));
                    } else {
                        open.extend(of_b.map(|half| [one, half]));
                    }
                }
            }
        }
    }
}

fn longer_side(part: &Part) -> usize {
    usize::from(part.half[1] > part.half[0])
}

/// For every node of a part along a side, the weights of the nodes of its parent.
type Transfer = [[f64; NODES]; NODES];

/// The non-periodic half-space under copies of one grid, at arbitrary positions and of arbitrary size.
///
/// Unknowns are ordered by grids, and for each grid in the order of the cells of the pattern. They are forces divided by the area of a cell
/// of the pattern, instead of pressures: on a grid of scale `s`, the pressure times `s^2`.
pub(crate) struct ScatteredGrids {
    interactions: Interactions,
    scales: Vec<f64>,
    /// On half-spaces, a grid of scale 1; on layers, one for every different scale, in units of that scale.
    patterns: Vec<Pattern>,
    /// The pattern of every grid.
    pattern_of: Vec<usize>,
    /// Displacement divided by the sums, which are those of force divided by the area of a cell of scale 1 times `1/r`.
    factor: f64,
    /// Area of a cell of scale 1.
    unit_area: f64,
    /// Correction for layers around a unit force on a cell of scale 1; `None` on half-spaces.
    layers: Option<AroundForce>,
    /// Cell area `A` of each grid divided by 48: the second moment of a square adds `A r^-3/24` to `r^-1`, half of it on either side.
    areas: Vec<f64>,
    /// Interaction of the cells of near parts, pair by pair.
    near: Vec<f64>,
    /// For every cell in the order of the tree, the weights of the nodes of its part.
    weights: Vec<[[f64; NODES]; 2]>,
    transfers: Vec<[Transfer; 2]>,
    /// Charges and potentials at the nodes of every part.
    charges: Vec<NodeValues>,
    potentials: Vec<NodeValues>,
    /// Charges and sums of all cells in the order of the tree.
    sorted: [Vec<f64>; 2],
}

/// One of the grids alone.
struct Pattern {
    alone: LatticeOfGrids<'static>,
    /// Potential of a cell.
    potential: CellPotential,
}

impl Pattern {
    /// With layers in the unit of length of the cells.
    fn new(cells: &Cells, compliance: f64, layers: &[WeightedLayer]) -> Self {
        let (places, vectors) = (vec![(0, 0)], [[0.0; 2]; 2]);
        Self {
            alone: LatticeOfGrids::on_columns(
                cells,
                places,
                vectors,
                [compliance, 0.0],
                layers,
                None,
            ),
            potential: CellPotential::new(cells.grid().cell(), layers),
        }
    }
}

impl ScatteredGrids {
    /// Copies of `cells` (around the origin) at all positions, on a half-space with the given `compliance` in 1/Pa or on layers, in the
    /// unit of length of the cells.
    pub(crate) fn new(
        cells: &Cells,
        grids: &[PlacedGrid],
        interactions: Interactions,
        compliance: f64,
        layers: &[WeightedLayer],
    ) -> Self {
        let area = cells.grid().cell_area();
        let scales: Vec<f64> = grids.iter().map(|(_, scale)| *scale).collect();
        let count = interactions.points.len();
        let parts = interactions.parts.len();
        let units = if layers.is_empty() {
            vec![1.0]
        } else {
            different(scales.iter().copied())
        };
        let pattern = |unit: &f64| {
            let layers = WeightedLayer::in_unit(layers, *unit);
            Pattern::new(cells, compliance, &layers)
        };
        let place = |scale: &f64| units.partition_point(|unit| unit < scale);
        let pattern_of = scales.iter().map(|scale| place(scale).min(units.len() - 1));
        let mut operator = Self {
            patterns: units.iter().map(pattern).collect(),
            pattern_of: pattern_of.collect(),
            layers: AroundForce::on_cell(layers, cells.grid().cell()),
            factor: compliance / PI * area,
            unit_area: area,
            areas: scales
                .iter()
                .map(|scale| area * scale * scale / 48.0)
                .collect(),
            near: Vec::new(),
            weights: vec![[[0.0; NODES]; 2]; count],
            transfers: vec![[[[0.0; NODES]; NODES]; 2]; parts],
            charges: vec![NO_VALUES; parts],
            potentials: vec![NO_VALUES; parts],
            sorted: [vec![0.0; count], vec![0.0; count]],
            scales,
            interactions,
        };
        operator.fill_near(area);
        operator.fill_weights();
        operator
    }

    fn grid_of(&self, unknown: u32) -> usize {
        unknown as usize / self.interactions.per_grid
    }

    fn fill_near(&mut self, area: f64) {
        let Interactions {
            near,
            parts,
            order,
            points,
            ..
        } = &self.interactions;
        let of_size = |grid: usize, x: f64, y: f64| {
            let (scale, pattern) = (self.scales[grid], &self.patterns[self.pattern_of[grid]]);
            pattern.potential.at([x / scale, y / scale]) / (area * scale)
        };
        let mut influence = Vec::new();
        for [one, other] in near {
            for a in &order[parts[*one].cells.clone()] {
                for b in &order[parts[*other].cells.clone()] {
                    let [from, to] = [a, b].map(|unknown| points[*unknown as usize]);
                    let (x, y) = (from[0] - to[0], from[1] - to[1]);
                    let [a, b] = [a, b].map(|unknown| self.grid_of(*unknown));
                    influence.push(0.5 * (of_size(a, x, y) + of_size(b, x, y)));
                }
            }
        }
        self.near = influence;
    }

    fn fill_weights(&mut self) {
        let Interactions {
            parts,
            order,
            points,
            ..
        } = &self.interactions;
        for (number, part) in parts.iter().enumerate() {
            let Some(halves) = part.halves else {
                for place in part.cells.clone() {
                    self.weights[place] = part.weights(points[order[place] as usize]);
                }
                continue;
            };
            debug_assert!(halves.iter().all(|half| *half < number));
            for half in halves {
                let [along_x, along_y] = parts[half].nodes();
                for (k, (x, y)) in along_x.into_iter().zip(along_y).enumerate() {
                    let [of_x, of_y] = part.weights([x, y]);
                    self.transfers[half][0][k] = of_x;
                    self.transfers[half][1][k] = of_y;
                }
            }
        }
    }

    /// Computes the charges at the nodes of all parts from those of the cells.
    fn gather(&mut self) {
        let parts = &self.interactions.parts;
        for (number, part) in parts.iter().enumerate() {
            let mut charges = NO_VALUES;
            match part.halves {
                None => {
                    for place in part.cells.clone() {
                        let charge = self.sorted[0][place];
                        let area = self.areas[self.grid_of(self.interactions.order[place])];
                        let [of_x, of_y] = &self.weights[place];
                        for (i, along) in of_x.iter().enumerate() {
                            for (j, across) in of_y.iter().enumerate() {
                                let part = along * across * charge;
                                charges[0][i * NODES + j] += part;
                                charges[1][i * NODES + j] += part * area;
                            }
                        }
                    }
                }
                Some(halves) => {
                    for half in halves {
                        for (own, of_half) in charges.iter_mut().zip(&self.charges[half]) {
                            up(&self.transfers[half], of_half, own);
                        }
                    }
                }
            }
            self.charges[number] = charges;
        }
    }

    /// Computes the interaction of far parts at their nodes.
    fn act_from_afar(&mut self) {
        for potentials in &mut self.potentials {
            *potentials = NO_VALUES;
        }
        let parts = &self.interactions.parts;
        let layers = self.layers.as_ref();
        // The correction is a mean over a cell of scale 1. Cells of other sizes differ by the Laplacian times the second moment.
        let differ = self
            .scales
            .iter()
            .any(|scale| scale.to_bits() != 1.0_f64.to_bits());
        let unit_size = self.unit_area / 24.0;
        for [one, other] in &self.interactions.far {
            let [[ax, ay], [bx, by]] = [one, other].map(|part| parts[*part].nodes());
            let (of_a, of_b) = (&self.charges[*one], &self.charges[*other]);
            let mut on_a = NO_VALUES;
            let mut on_b = self.potentials[*other];
            for s in 0..ALL_NODES {
                let (x, y) = (ax[s / NODES], ay[s % NODES]);
                let (charge, of_size) = (of_a[0][s], of_a[1][s]);
                let mut sums = [0.0; 2];
                for t in 0..ALL_NODES {
                    let (u, v) = (x - bx[t / NODES], y - by[t % NODES]);
                    let square = (u * u + v * v).recip();
                    let mut inverse = square.sqrt();
                    let mut cubed = inverse * square;
                    if let Some(layers) = layers {
                        if differ {
                            let [value, laplacian] = layers.value_and_laplacian(u.hypot(v));
                            inverse += value - unit_size * laplacian;
                            cubed += laplacian;
                        } else {
                            inverse += layers.value(u.hypot(v));
                        }
                    }
                    sums[0] += of_b[0][t] * inverse + of_b[1][t] * cubed;
                    sums[1] += of_b[0][t] * cubed;
                    on_b[0][t] += charge * inverse + of_size * cubed;
                    on_b[1][t] += charge * cubed;
                }
                on_a[0][s] = sums[0];
                on_a[1][s] = sums[1];
            }
            self.potentials[*other] = on_b;
            for (own, more) in self.potentials[*one].iter_mut().zip(&on_a) {
                own.iter_mut()
                    .zip(more)
                    .for_each(|(own, more)| *own += more);
            }
        }
    }

    /// Computes the interaction of near parts, cell by cell.
    fn act_nearby(&mut self) {
        let Interactions { parts, near, .. } = &self.interactions;
        let [charges, sums] = &mut self.sorted;
        let mut influence = self.near.iter();
        for [one, other] in near {
            for a in parts[*one].cells.clone() {
                let mut sum = 0.0;
                for (b, value) in parts[*other].cells.clone().zip(&mut influence) {
                    sum += value * charges[b];
                    sums[b] += value * charges[a];
                }
                sums[a] += sum;
            }
        }
    }

    /// Computes the potentials of all cells from those at the nodes.
    fn spread(&mut self) {
        let parts = &self.interactions.parts;
        for (number, part) in parts.iter().enumerate().rev() {
            let potentials = self.potentials[number];
            match part.halves {
                Some(halves) => {
                    for half in halves {
                        let transfer = &self.transfers[half];
                        let of_half = self.potentials[half].iter_mut();
                        for (own, from) in of_half.zip(&potentials) {
                            down(transfer, from, own);
                        }
                    }
                }
                None => {
                    for place in part.cells.clone() {
                        let area = self.areas[self.grid_of(self.interactions.order[place])];
                        let [of_x, of_y] = &self.weights[place];
                        let mut sum = 0.0;
                        for (i, along) in of_x.iter().enumerate() {
                            for (j, across) in of_y.iter().enumerate() {
                                let node = i * NODES + j;
                                let value = potentials[0][node] + area * potentials[1][node];
                                sum += along * across * value;
                            }
                        }
                        self.sorted[1][place] += sum;
                    }
                }
            }
        }
    }
}

/// Adds the charges of a half to those of its parent.
fn up(transfer: &[Transfer; 2], half: &[f64; ALL_NODES], whole: &mut [f64; ALL_NODES]) {
    for (k, row) in half.chunks_exact(NODES).enumerate() {
        let mut across = [0.0; NODES];
        for (value, weights) in row.iter().zip(&transfer[1]) {
            for (sum, weight) in across.iter_mut().zip(weights) {
                *sum += value * weight;
            }
        }
        for (weight, row) in transfer[0][k].iter().zip(whole.chunks_exact_mut(NODES)) {
            for (own, value) in row.iter_mut().zip(&across) {
                *own += weight * value;
            }
        }
    }
}

/// Adds the potentials of the parent to those of a half.
fn down(transfer: &[Transfer; 2], whole: &[f64; ALL_NODES], half: &mut [f64; ALL_NODES]) {
    for (k, row) in half.chunks_exact_mut(NODES).enumerate() {
        let mut across = [0.0; NODES];
        for (weight, values) in transfer[0][k].iter().zip(whole.chunks_exact(NODES)) {
            for (sum, value) in across.iter_mut().zip(values) {
                *sum += weight * value;
            }
        }
        for (own, weights) in row.iter_mut().zip(&transfer[1]) {
            *own += weights.iter().zip(&across).map(|(a, b)| a * b).sum::<f64>();
        }
    }
}

impl Operator for ScatteredGrids {
    fn len(&self) -> usize {
        self.interactions.points.len()
    }

    fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        assert_eq!(pressure.len(), self.len(), "one force for every cell");
        assert_eq!(
            displacement.len(),
            self.len(),
            "one displacement for every cell"
        );
        for (charge, unknown) in self.sorted[0].iter_mut().zip(&self.interactions.order) {
            *charge = pressure[*unknown as usize];
        }
        self.sorted[1].fill(0.0);
        self.gather();
        self.act_from_afar();
        self.act_nearby();
        self.spread();
        let per_grid = self.interactions.per_grid;
        let grids = pressure
            .chunks_exact(per_grid)
            .zip(displacement.chunks_exact_mut(per_grid));
        let own = self.scales.iter().zip(&self.pattern_of);
        for ((pressure, displacement), (scale, pattern)) in grids.zip(own) {
            self.patterns[*pattern].alone.apply(pressure, displacement);
            displacement.iter_mut().for_each(|value| *value /= scale);
        }
        for (sum, unknown) in self.sorted[1].iter().zip(&self.interactions.order) {
            displacement[*unknown as usize] += self.factor * sum;
        }
    }

    /// Preconditioner of every grid separately.
    fn precondition(&mut self, residual: &[f64], direction: &mut [f64]) {
        let per_grid = self.interactions.per_grid;
        if let [common] = &mut self.patterns[..] {
            common.alone.precondition(residual, direction);
        } else {
            let grids = residual
                .chunks_exact(per_grid)
                .zip(direction.chunks_exact_mut(per_grid));
            for ((residual, direction), pattern) in grids.zip(&self.pattern_of) {
                let alone = &mut self.patterns[*pattern].alone;
                alone.precondition(residual, direction);
            }
        }
        for (direction, scale) in direction.chunks_exact_mut(per_grid).zip(&self.scales) {
            direction.iter_mut().for_each(|value| *value *= scale);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::neighbours::tests::random_discs;
    use crate::problem::Grid;

    const COMPLIANCE: f64 = 0.7;

    fn numbers(count: usize) -> Vec<f64> {
        (0..count).map(|k| 1.0 + (1.3 * k as f64).sin()).collect()
    }

    fn disc(across: usize) -> Cells {
        let grid = Grid::centred(across, across, 2.0 / across as f64).unwrap();
        Cells::where_centre(&grid, |[x, y]| x.hypot(y) < 1.0)
    }

    fn operator(cells: &Cells, grids: &[PlacedGrid]) -> ScatteredGrids {
        on_layers(cells, grids, &[])
    }

    fn on_layers(cells: &Cells, grids: &[PlacedGrid], layers: &[WeightedLayer]) -> ScatteredGrids {
        let interactions = Interactions::new(cells, grids);
        ScatteredGrids::new(cells, grids, interactions, COMPLIANCE, layers)
    }

    fn applied(operator: &mut impl Operator, values: &[f64]) -> Vec<f64> {
        let mut result = vec![f64::NAN; values.len()];
        operator.apply(values, &mut result);
        result
    }

    #[test]
    fn agrees_with_direct_summation() {
        let film = [crate::halfspace::layer::tests::film()];
        for (count, across, gap, layers) in [
            (1, 5, 1.0, &[][..]),
            (2, 16, 0.01, &[]),
            (12, 8, 0.05, &[]),
            (6, 16, 0.5, &[]),
            (1, 5, 1.0, &film),
            (6, 16, 0.5, &film),
        ] {
            let cells = disc(across);
            let grids = random_discs(count, 0.2, gap, 3);
            let mut operator = on_layers(&cells, &grids, layers);
            let forces = numbers(operator.len());
            let found = applied(&mut operator, &forces);
            let points = operator.interactions.points.clone();
            // A force on a cell of the size of either grid.
            let squares: Vec<(CellPotential, f64)> = grids
                .iter()
                .map(|(_, scale)| {
                    let side = 2.0 / across as f64 * scale;
                    (CellPotential::new([side; 2], layers), scale * scale)
                })
                .collect();
            let (mut most, mut largest) = (0.0_f64, 0.0_f64);
            for (i, [x, y]) in points.iter().enumerate() {
                let sum: f64 = points
                    .iter()
                    .enumerate()
                    .map(|(j, [u, v])| {
                        let of = |cell: usize| {
                            let (square, area) = &squares[cell / cells.len()];
                            square.at([x - u, y - v]) / area
                        };
                        0.5 * forces[j] * (of(i) + of(j))
                    })
                    .sum();
                let exact = COMPLIANCE / PI * sum;
                most = most.max((found[i] - exact).abs());
                largest = largest.max(exact.abs());
            }
            let Interactions { far, near, .. } = &operator.interactions;
            println!(
                "{count} grids of {across}: {:e}; {} far and {} near pairs",
                most / largest,
                far.len(),
                near.len()
            );
            assert!(most < 3e-7 * largest, "{:e}", most / largest);
        }
    }

    #[test]
    fn symmetric_and_positive_with_its_preconditioner() {
        let cells = disc(12);
        let grids = random_discs(9, 0.3, 0.02, 5);
        let mut operator = operator(&cells, &grids);
        let count = operator.len();
        let (a, b) = (numbers(count), vec![1.0; count]);
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let (wa, wb) = (applied(&mut operator, &a), applied(&mut operator, &b));
        assert!((dot(&a, &wb) / dot(&b, &wa) - 1.0).abs() < 1e-13);
        assert!(dot(&a, &wa) > 0.0 && dot(&b, &wb) > 0.0);
        // Repeats the product: the previous one must not affect it.
        let again = applied(&mut operator, &a);
        assert!(again.iter().zip(&wa).all(|(a, b)| (a - b).abs() < 1e-300));
        let mut preconditioned = |values: &[f64]| {
            let mut result = vec![0.0; values.len()];
            operator.precondition(values, &mut result);
            result
        };
        let (pa, pb) = (preconditioned(&a), preconditioned(&b));
        assert!((dot(&a, &pb) / dot(&b, &pa) - 1.0).abs() < 1e-12);
        assert!(dot(&a, &pa) > 0.0 && dot(&b, &pb) > 0.0);
    }

    /// Compares both operators for equal grids on a lattice.
    #[test]
    fn grids_on_a_lattice_are_as_a_lattice_of_grids() {
        let cells = disc(16);
        let vectors = [[3.0, 0.4], [-0.7, 2.8]];
        let places: Vec<(usize, usize)> =
            (0..5).flat_map(|i| (0..4).map(move |j| (i, j))).collect();
        let at = |&(i, j): &(usize, usize)| {
            let centre = [0, 1].map(|k| vectors[0][k] * i as f64 + vectors[1][k] * j as f64);
            (centre, 1.0)
        };
        let grids: Vec<PlacedGrid> = places.iter().map(at).collect();
        let mut lattice = LatticeOfGrids::new(&cells, places, vectors, COMPLIANCE, None);
        let mut scattered = operator(&cells, &grids);
        let pressure = numbers(lattice.len());
        let (one, other) = (
            applied(&mut lattice, &pressure),
            applied(&mut scattered, &pressure),
        );
        let largest = one.iter().copied().fold(0.0, f64::max);
        let most = one.iter().zip(&other).map(|(a, b)| (a - b).abs());
        let most = most.fold(0.0, f64::max) / largest;
        println!("{most:e}");
        assert!(most < 3e-7);
    }
}
