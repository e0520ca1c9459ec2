//! Positions and bodies of pillars in the units of the solvers: a hexagonal lattice of equal pillars, any other lattice, or a list.

use super::arrangement::{self, Arrangement, coordinates, reduced, rows_within};
use super::column::{Column, ColumnLaw};
use super::lattice::HexagonalLattice;
use super::point::{Point, turned};
use super::scatter::Disorder;
use super::system::System;
use crate::numerics::neighbours::{Nearest, Neighbours};
use std::f64::consts::PI;
use std::sync::Arc;

const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// The properties of a pillar without its position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PillarBody {
    /// Radius of the top.
    pub(crate) radius: f64,
    /// Height above the common height of pillars.
    pub(crate) raised: f64,
    /// Compliance, according to its height and radius.
    pub(crate) column: Column,
}

impl PillarBody {
    /// A pillar of unit radius and common height.
    pub(crate) fn of_column(column: impl Into<Column>) -> Self {
        Self {
            radius: 1.0,
            raised: 0.0,
            column: column.into(),
        }
    }
}

/// A pillar of a list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ListedPillar {
    /// Centre relative to the lens axis.
    pub(crate) centre: Point,
    pub(crate) body: PillarBody,
}

/// Points of a lattice as rows and columns of an array that begins at the first row and column.
#[derive(Debug, Clone)]
pub(crate) struct Counted {
    pub(crate) places: Vec<(usize, usize)>,
    /// Vectors between adjacent rows, and between adjacent columns.
    pub(crate) vectors: [Point; 2],
}

/// Points at integer numbers of columns and rows along x and y, a subset of which are the pillars of a lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PillarGrid {
    /// Distances of adjacent columns, and of adjacent rows.
    pub(crate) sides: [f64; 2],
    /// Position of pillar (0, 0) relative to the lens axis.
    pub(crate) origin: Point,
    /// Numbers of columns and rows between adjacent pillars along the first index, and along the second.
    steps: [[i64; 2]; 2],
}

/// Largest number of columns, or rows, between adjacent points of a lattice.
const MOST_STEPS: i64 = 4;

impl PillarGrid {
    /// The grid of a lattice; `None` if one of its sides would be shorter than `shortest`.
    fn new([a, b]: [Point; 2], origin: Point, shortest: f64) -> Option<Self> {
        let longest = a[0].hypot(a[1]).max(b[0].hypot(b[1]));
        let [(width, columns), (height, rows)] = [
            common_side([a[0], b[0]], longest)?,
            common_side([a[1], b[1]], longest)?,
        ];
        let is_wide = |side: f64| side >= shortest * (1.0 - ROUNDING);
        (is_wide(width) && is_wide(height)).then_some(Self {
            sides: [width, height],
            origin,
            steps: [0, 1].map(|k| [columns[k], rows[k]]),
        })
    }

    /// Columns and rows from pillar (0, 0) to another pillar.
    pub(crate) fn place(&self, (i, j): (i64, i64)) -> [i64; 2] {
        let [one, other] = self.steps;
        [0, 1].map(|k| one[k] * i + other[k] * j)
    }

    /// Columns and rows from pillar (0, 0) to the lens axis, if the positions of pillars are symmetric under reflections of x and of y
    /// there.
    fn mirrored_at(&self) -> Option<[i64; 2]> {
        let [u, v] = [0, 1].map(|k| -self.origin[k] / self.sides[k]);
        let axis = [u.round(), v.round()];
        let is_point = (u - axis[0]).abs() < ON_AXIS && (v - axis[1]).abs() < ON_AXIS;
        let axis = axis.map(|x| x as i64);
        let images = self.steps.iter().flat_map(|[u, v]| [[-u, *v], [*u, -v]]);
        // Images of pillar (0, 0).
        let shifts = [[2 * axis[0], 0], [0, 2 * axis[1]]];
        let mut all = images.chain(shifts);
        (is_point && all.all(|place| self.index(place).is_some())).then_some(axis)
    }

    /// The pillar this number of columns and rows from pillar (0, 0), if there is one.
    pub(crate) fn index(&self, [u, v]: [i64; 2]) -> Option<(i64, i64)> {
        let [[a, b], [c, d]] = self.steps;
        let area = a * d - b * c;
        let [first, second] = [u * d - v * c, a * v - b * u];
        let stands = area != 0 && first % area == 0 && second % area == 0;
        stands.then(|| (first / area, second / area))
    }
}

/// Largest number of rows of a lattice on each side of the lens axis that are counted; finite lattices are smaller.
const MOST_ROWS: f64 = 1e15;

/// Relative differences of lengths below this are rounding errors.
const ROUNDING: f64 = 1e-9;

/// Distance of the lens axis from a grid point, relative to the grid sides, below which the axis is considered to be on this point: the
/// symmetry is then exact to rounding.
pub(super) const ON_AXIS: f64 = 1e-13;

/// The length of which two others are small integer multiples, and these multiples. If one length is 0, the other length.
fn common_side(lengths: [f64; 2], longest: f64) -> Option<(f64, [i64; 2])> {
    let is_none = |length: f64| length.abs() < ROUNDING * longest;
    let [a, b] = lengths;
    let signed = |length: f64, count: i64| if length < 0.0 { -count } else { count };
    match [is_none(a), is_none(b)] {
        [true, true] => None,
        [true, false] => Some((b.abs(), [0, signed(b, 1)])),
        [false, true] => Some((a.abs(), [signed(a, 1), 0])),
        [false, false] => (1..=MOST_STEPS).find_map(|count| {
            let side = b.abs() / count as f64;
            let other = (a.abs() / side).round();
            let fits = (a.abs() - other * side).abs() < ROUNDING * longest;
            (fits && (1.0..=MOST_STEPS as f64).contains(&other))
                .then(|| (side, [signed(a, other as i64), signed(b, count)]))
        }),
    }
}

/// Index of a pillar, and the pillar.
pub(crate) type IndexedPillar = ((i64, i64), ListedPillar);

/// Pillars on any plane lattice that differ only by their disorder.
#[derive(Debug, Clone)]
pub(crate) struct PlaneLattice {
    /// The vectors that define the pillar indices.
    vectors: [Point; 2],
    /// The reduced vectors.
    basis: [Point; 2],
    /// Position of the pillar with index (0, 0) relative to the lens axis.
    origin: Point,
    body: PillarBody,
    scatter: Option<Scattered>,
    /// Rotation relative to the standard orientation of its type: the first vector along x, or, for a hexagonal lattice in any description,
    /// at 30 degrees to it.
    rotation: f64,
    /// First index along each of the vectors and index after the last one, for a finite lattice.
    ends: Option<[i64; 2]>,
    /// Radius of a disc around the lens axis: only pillars within it are considered.
    disc: Option<f64>,
}

/// Rotation of the vectors of a hexagonal lattice relative to those of the paper, rad; `None` for another lattice.
fn from_hexagonal(vectors: [Point; 2]) -> f64 {
    const ROUNDING: f64 = 1e-12;
    let [a, b] = reduced(vectors);
    let square = a[0] * a[0] + a[1] * a[1];
    let longer = (b[0] * b[0] + b[1] * b[1]) / square - 1.0;
    let product = (a[0] * b[0] + a[1] * b[1]).abs() / square - 0.5;
    if longer.abs() > ROUNDING || product.abs() > ROUNDING {
        return 0.0;
    }
    let sixth = PI / 3.0;
    let from_paper = (a[1].atan2(a[0]) - 0.5 * sixth) / sixth;
    let turned = (from_paper - from_paper.round()) * sixth;
    if turned.abs() < ROUNDING { 0.0 } else { turned }
}

/// Disorder of the pillars of a lattice.
#[derive(Debug, Clone)]
struct Scattered {
    disorder: Disorder,
    /// The common height.
    height: f64,
    law: ColumnLaw,
}

impl PlaneLattice {
    /// Returns `None` if the vectors do not span the plane.
    pub(crate) fn new(vectors: [Point; 2], origin: Point, body: PillarBody) -> Option<Self> {
        let [[a, b], [c, d]] = vectors;
        let area = (a * d - b * c).abs();
        let longest = a.hypot(b).max(c.hypot(d));
        // Rejects areas that are rounding errors or NaN.
        (area > 1e-9 * longest * longest && area.is_finite()).then(|| Self {
            vectors,
            basis: reduced(vectors),
            origin,
            body,
            scatter: None,
            rotation: 0.0,
            ends: None,
            disc: None,
        })
    }

    /// The pillars whose tops are within a disc around the lens axis.
    fn within_disc(self, radius: f64) -> Self {
        let [most, other] = self.most_rows(radius);
        let most = most.max(other);
        let [first, end] = self.ends.unwrap_or([i64::MIN, i64::MAX]);
        Self {
            ends: Some([first.max(-most), end.min(most + 1)]),
            disc: Some(radius),
            ..self
        }
    }

    /// The largest index along each of the vectors of a point within a radius of the lens axis.
    fn most_rows(&self, radius: f64) -> [i64; 2] {
        let reach = radius + self.origin[0].hypot(self.origin[1]);
        rows_within(self.vectors, reach).map(|most| most.min(MOST_ROWS) as i64)
    }

    /// Converts a lattice to units of a length (m), with common pillars of the given height.
    fn of(
        lattice: &arrangement::PlaneLattice,
        length: f64,
        height: f64,
        law: ColumnLaw,
    ) -> Option<Self> {
        let scaled = |[x, y]: Point| [x / length, y / length];
        let [one, other] = lattice.vectors();
        let disorder = lattice.disorder;
        let body = PillarBody::of_column(law.of_common());
        let whole = Self::new([scaled(one), scaled(other)], scaled(lattice.origin()), body)?;
        let rotation = lattice.rotation + from_hexagonal(lattice.form.vectors());
        Some(Self {
            rotation,
            scatter: (!disorder.is_none()).then_some(Scattered {
                disorder,
                height,
                law,
            }),
            ends: lattice.ends(),
            ..whole
        })
    }

    /// The pillar with an index, if there is one.
    fn body_at(&self, (i, j): (i64, i64)) -> Option<PillarBody> {
        if let Some([first, end]) = self.ends {
            let inside = first..end;
            if !(inside.contains(&i) && inside.contains(&j)) {
                return None;
            }
        }
        if let Some(disc) = self.disc {
            let [x, y] = self.centre((i, j));
            // Pillars that the disc just covers have been accepted.
            if x.hypot(y) + self.body.radius > disc * (1.0 + ROUNDING) {
                return None;
            }
        }
        match &self.scatter {
            None => Some(self.body),
            Some(Scattered {
                disorder,
                height,
                law,
            }) => {
                let ratio = disorder.height_ratio((i, j))?;
                Some(PillarBody {
                    raised: self.body.raised + (ratio - 1.0) * height,
                    column: law.of(ratio, 1.0),
                    ..self.body
                })
            }
        }
    }

    /// The index of the lattice point nearest to a point, whether or not it has a pillar.
    fn nearest(&self, near: Point) -> (i64, i64) {
        let from_origin = [near[0] - self.origin[0], near[1] - self.origin[1]];
        let [u, v] = coordinates(from_origin, self.basis).map(f64::round);
        let [a, b] = self.basis;
        let around = (-1..=1).flat_map(|k| (-1..=1).map(move |l| [k, l].map(f64::from)));
        let points = around.map(|[k, l]| [0, 1].map(|axis| (u + k) * a[axis] + (v + l) * b[axis]));
        let away = |[x, y]: &Point| (x - from_origin[0]).hypot(y - from_origin[1]);
        let nearest = points.min_by(|one, other| away(one).total_cmp(&away(other)));
        let [i, j] = coordinates(nearest.unwrap_or(from_origin), self.vectors);
        (i.round() as i64, j.round() as i64)
    }

    fn centre(&self, (i, j): (i64, i64)) -> Point {
        let [one, other] = self.vectors;
        [0, 1].map(|k| self.origin[k] + one[k] * i as f64 + other[k] * j as f64)
    }

    fn cell_area(&self) -> f64 {
        let [[a, b], [c, d]] = self.vectors;
        (a * d - b * c).abs()
    }

    /// All pillars with centres within a radius of the lens axis, by increasing index.
    fn within(&self, radius: f64) -> Vec<IndexedPillar> {
        let [rows, columns] = self.most_rows(radius);
        let side = |most: i64| match self.ends {
            Some([first, end]) => first.max(-most)..end.min(most + 1),
            None => -most..most + 1,
        };
        let mut pillars = Vec::new();
        for i in side(rows) {
            for j in side(columns) {
                let centre = self.centre((i, j));
                if centre[0].hypot(centre[1]) <= radius
                    && let Some(body) = self.body_at((i, j))
                {
                    pillars.push(((i, j), ListedPillar { centre, body }));
                }
            }
        }
        pillars
    }

    /// Distance of the farthest position from the lens axis; `None` for an infinite lattice.
    fn farthest(&self) -> Option<f64> {
        self.ends.map(|[first, end]| {
            let sides = [first, end - 1];
            let corners = sides
                .iter()
                .flat_map(|&i| sides.map(|j| self.centre((i, j))));
            corners.map(|[x, y]| x.hypot(y)).fold(0.0, f64::max)
        })
    }

    /// Whether all pillars are within a radius of the lens axis.
    fn is_within(&self, radius: f64) -> bool {
        self.farthest().is_some_and(|farthest| farthest <= radius)
    }

    /// The largest height above the common height.
    fn highest(&self) -> f64 {
        let scattered = self.scatter.as_ref().map_or(0.0, |scatter| {
            scatter.disorder.heights.most() * scatter.height
        });
        self.body.raised + scattered
    }
}

/// The pillars of a list only.
#[derive(Debug, Clone)]
pub(crate) struct PillarList {
    pillars: Vec<ListedPillar>,
    /// The largest distance of a pillar from its nearest neighbour.
    spacing: f64,
    /// The smallest gap between two tops divided by the smaller of their radii.
    least_gap: f64,
    /// Search structure of the tops.
    tops: Neighbours,
}

impl PillarList {
    /// Returns `None` for an empty list, overlapping pillars, and invalid positions or sizes.
    pub(crate) fn new(pillars: Vec<ListedPillar>) -> Option<Self> {
        let largest = pillars.iter().map(|p| p.body.radius).fold(0.0, f64::max);
        let are_numbers = pillars.iter().all(|ListedPillar { centre, body }| {
            let values = [centre[0], centre[1], body.raised];
            body.radius > 0.0
                && body.radius.is_finite()
                && body.column.is_valid()
                && values.iter().all(|value| value.is_finite())
        });
        if pillars.is_empty() || !are_numbers {
            return None;
        }
        let neighbours = neighbours_of(&pillars);
        let least_gap = neighbours.least_gap();
        // For a single pillar, as if there were another at twice the diameter.
        let spacing = neighbours.spacing().unwrap_or(4.0 * largest);
        // Touching pillars may overlap due to rounding.
        (least_gap >= -1e-9).then_some(Self {
            pillars,
            spacing,
            least_gap: least_gap.max(0.0),
            tops: neighbours,
        })
    }
}

fn neighbours_of(pillars: &[ListedPillar]) -> Neighbours {
    Neighbours::new(
        pillars
            .iter()
            .map(|pillar| (pillar.centre, pillar.body.radius)),
    )
}

/// The different ones of these values, in increasing order.
pub(crate) fn different(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut different: Vec<f64> = values.collect();
    different.sort_unstable_by(f64::total_cmp);
    different.dedup_by_key(|value| value.to_bits());
    different
}

/// Positions and bodies of pillars.
#[derive(Debug, Clone)]
pub(crate) enum PillarField {
    /// All pillars have unit radius and the common height.
    Hexagonal {
        lattice: HexagonalLattice,
        column: Column,
    },
    Lattice(Arc<PlaneLattice>),
    Listed(Arc<PillarList>),
}

impl PillarField {
    /// Converts the pillars to units of a length (m), the common pillar radius. Also returns the rotation about the lens axis (rad) that
    /// restores the orientation of the input.
    pub(super) fn new(system: &System, length: f64) -> (Self, f64) {
        let law = system.column_law();
        let height = system.pillar().height / length;
        let on_plane = |lattice: &arrangement::PlaneLattice| {
            let lattice = PlaneLattice::of(lattice, length, height, law)
                .expect("a lattice with a checked angle");
            let lattice = match system.lens().punch_radius() {
                Some(radius) => lattice.within_disc(radius / length),
                None => lattice,
            };
            let rotation = lattice.rotation;
            let field = Self::Lattice(Arc::new(lattice));
            (field.turned(-rotation), rotation)
        };
        let field = match system.arrangement() {
            // Under a table of heights the floor is looked at in all holes, not in those next to the lens axis. A punch covers a part.
            Arrangement::Hexagonal(lattice)
                if system.lens().bends_unevenly() || system.lens().punch_radius().is_some() =>
            {
                return on_plane(&(*lattice).into());
            }
            Arrangement::Hexagonal(lattice) => Self::Hexagonal {
                lattice: HexagonalLattice {
                    pitch: lattice.pitch / length,
                    ..*lattice
                },
                column: law.of_common(),
            },
            Arrangement::Lattice(lattice) => return on_plane(lattice),
            Arrangement::Listed(list) => {
                let pillar = |pillar: &arrangement::ListedPillar| {
                    let radius = 0.5 * pillar.diameter / length;
                    let own_height = pillar.height / length;
                    ListedPillar {
                        centre: pillar.centre.map(|x| x / length),
                        body: PillarBody {
                            radius,
                            raised: own_height - height,
                            column: law.of(own_height, height * radius),
                        },
                    }
                };
                let pillars = list.pillars().iter().map(pillar).collect();
                let list = PillarList::new(pillars);
                Self::Listed(Arc::new(list.expect("a list of checked pillars")))
            }
            Arrangement::Random(_) => unreachable!("a system has no random positions"),
        };
        (field, 0.0)
    }

    /// The same field rotated about the lens axis by an angle (rad). Only lattices are rotated.
    pub(super) fn turned(&self, angle: f64) -> Self {
        match self {
            Self::Lattice(lattice) if angle != 0.0 => {
                let around = |point: Point| turned(point, angle);
                Self::Lattice(Arc::new(PlaneLattice {
                    vectors: lattice.vectors.map(around),
                    basis: lattice.basis.map(around),
                    origin: around(lattice.origin),
                    ..(**lattice).clone()
                }))
            }
            other => other.clone(),
        }
    }

    /// The grid along x and y that contains all pillars, if they are on a lattice and the grid is not too fine.
    pub(crate) fn pillar_grid(&self) -> Option<PillarGrid> {
        let half = 0.5 * self.shortest_distance();
        match self {
            Self::Hexagonal { lattice, .. } => {
                let [x, y] = lattice.offset_vector();
                Some(PillarGrid {
                    sides: [0.5 * SQRT_3 * lattice.pitch, 0.5 * lattice.pitch],
                    origin: [-x, -y],
                    steps: [[1, 1], [1, -1]],
                })
            }
            Self::Lattice(lattice) => PillarGrid::new(lattice.vectors, lattice.origin, half),
            Self::Listed(_) => None,
        }
    }

    /// Columns and rows of the [grid of pillars](Self::pillar_grid) from pillar (0, 0) to the lens axis, if all pillars are symmetric under
    /// reflections of x and of y there.
    pub(crate) fn mirrored_at(&self) -> Option<[i64; 2]> {
        self.infinite_lattice()?;
        self.pillar_grid()?.mirrored_at()
    }

    /// The vectors of an infinite lattice of equal pillars, and the position of pillar (0, 0).
    pub(super) fn infinite_lattice(&self) -> Option<([Point; 2], Point)> {
        match self {
            Self::Hexagonal { lattice, .. } => Some((lattice.vectors(), lattice.centre(0, 0))),
            Self::Lattice(lattice) => {
                let alike = lattice.scatter.is_none() && lattice.ends.is_none();
                alike.then_some((lattice.vectors, lattice.origin))
            }
            Self::Listed(_) => None,
        }
    }

    /// The vectors that define the indices of a lattice of tops of unit radius, of any heights and not necessarily infinite.
    pub(crate) fn vectors_of_unit_tops(&self) -> Option<[Point; 2]> {
        match self {
            Self::Hexagonal { lattice, .. } => Some(lattice.vectors()),
            Self::Lattice(lattice) => {
                let is_unit = (lattice.body.radius - 1.0).abs() < f64::EPSILON;
                is_unit.then_some(lattice.vectors)
            }
            Self::Listed(_) => None,
        }
    }

    /// Distance of nearest neighbours on a lattice; the spacing of a list.
    pub(crate) fn shortest_distance(&self) -> f64 {
        match self {
            Self::Hexagonal { lattice, .. } => lattice.pitch,
            Self::Lattice(lattice) => lattice.basis[0][0].hypot(lattice.basis[0][1]),
            Self::Listed(list) => list.spacing,
        }
    }

    /// Typical distance between neighbours.
    pub(crate) fn spacing(&self) -> f64 {
        match self {
            Self::Hexagonal { lattice, .. } => lattice.pitch,
            Self::Lattice(lattice) => lattice.basis[1][0].hypot(lattice.basis[1][1]),
            Self::Listed(list) => list.spacing,
        }
    }

    /// Approximate area per pillar.
    pub(crate) fn cell_area(&self) -> f64 {
        match self {
            Self::Hexagonal { lattice, .. } => lattice.cell_area(),
            Self::Lattice(lattice) => lattice.cell_area(),
            Self::Listed(list) => list.spacing * list.spacing,
        }
    }

    /// The smallest gap between two tops divided by the smaller of their radii; an upper bound for a lattice.
    pub(crate) fn least_gap(&self) -> f64 {
        match self {
            Self::Hexagonal { lattice, .. } => lattice.pitch - 2.0,
            Self::Lattice(lattice) => {
                let shortest = lattice.basis[0][0].hypot(lattice.basis[0][1]);
                shortest / lattice.body.radius - 2.0
            }
            Self::Listed(list) => list.least_gap,
        }
    }

    /// The compliance of the pillars, or of the first one.
    pub(crate) fn column(&self) -> Column {
        match self {
            Self::Hexagonal { column, .. } => *column,
            Self::Lattice(lattice) => lattice.body.column,
            Self::Listed(list) => list.pillars[0].body.column,
        }
    }

    /// The largest radius of a top, and the largest height above the common height.
    pub(crate) fn bounds(&self) -> [f64; 2] {
        let largest = |[radius, raised]: [f64; 2], body: &PillarBody| {
            [radius.max(body.radius), raised.max(body.raised)]
        };
        let least = [0.0, f64::NEG_INFINITY];
        match self {
            Self::Hexagonal { .. } => [1.0, 0.0],
            Self::Lattice(lattice) => [lattice.body.radius, lattice.highest()],
            Self::Listed(list) => {
                let bodies = list.pillars.iter().map(|pillar| &pillar.body);
                bodies.fold(least, largest)
            }
        }
    }

    /// A distance from the lens axis that includes all pillars; `None` for an infinite lattice.
    pub(crate) fn extent(&self) -> Option<f64> {
        let farthest = match self {
            Self::Hexagonal { .. } => None,
            Self::Lattice(lattice) => lattice.farthest(),
            Self::Listed(list) => {
                let away = |pillar: &ListedPillar| pillar.centre[0].hypot(pillar.centre[1]);
                Some(list.pillars.iter().map(away).fold(0.0, f64::max))
            }
        };
        farthest.map(|farthest| (1.0 + ROUNDING) * farthest + self.spacing())
    }

    /// Whether pillars may differ in height.
    pub(crate) fn has_unlike_heights(&self) -> bool {
        match self {
            Self::Hexagonal { .. } => false,
            Self::Lattice(lattice) => lattice.highest() > lattice.body.raised,
            Self::Listed(list) => {
                let first = list.pillars[0].body.raised;
                let is_other = |pillar: &ListedPillar| pillar.body.raised.total_cmp(&first).is_ne();
                list.pillars.iter().any(is_other)
            }
        }
    }

    /// The smallest radius of a top.
    pub(crate) fn smallest_radius(&self) -> f64 {
        match self {
            Self::Hexagonal { .. } => 1.0,
            Self::Lattice(lattice) => lattice.body.radius,
            Self::Listed(list) => {
                let radii = list.pillars.iter().map(|pillar| pillar.body.radius);
                radii.fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// The different radii of the tops, in increasing order.
    pub(crate) fn radii(&self) -> Vec<f64> {
        match self {
            Self::Hexagonal { .. } => vec![1.0],
            Self::Lattice(lattice) => vec![lattice.body.radius],
            Self::Listed(list) => different(list.pillars.iter().map(|pillar| pillar.body.radius)),
        }
    }

    /// Points of any lattice but the hexagonal one; `None` for a list.
    pub(crate) fn counted(&self, points: &[Point]) -> Option<Counted> {
        let Self::Lattice(lattice) = self else {
            return None;
        };
        let indices: Vec<[i64; 2]> = points
            .iter()
            .map(|point| {
                let from_origin = [0, 1].map(|k| point[k] - lattice.origin[k]);
                coordinates(from_origin, lattice.basis).map(|number| number.round() as i64)
            })
            .collect();
        let first = [0, 1].map(|k| indices.iter().map(|index| index[k]).min().unwrap_or(0));
        let place = |[i, j]: &[i64; 2]| ((i - first[0]) as usize, (j - first[1]) as usize);
        Some(Counted {
            places: indices.iter().map(place).collect(),
            vectors: lattice.basis,
        })
    }

    /// Approximate number of pillars within a radius of the lens axis.
    pub(crate) fn expected_len(&self, radius: f64) -> f64 {
        let on_lattice = |area: f64| PI * radius * radius / area;
        match self {
            Self::Hexagonal { lattice, .. } => on_lattice(lattice.cell_area()),
            Self::Lattice(lattice) => {
                let side = lattice
                    .ends
                    .map_or(f64::INFINITY, |[first, end]| (end - first) as f64);
                on_lattice(lattice.cell_area()).min(side * side)
            }
            Self::Listed(list) => list.pillars.len() as f64,
        }
    }

    /// The pillar whose top contains a point, if there is one.
    pub(crate) fn under(&self, point: Point) -> Option<IndexedPillar> {
        let holds = |(_, pillar): &IndexedPillar| {
            let [x, y] = pillar.centre;
            (x - point[0]).hypot(y - point[1]) <= pillar.body.radius
        };
        let pillar = match self {
            Self::Hexagonal {
                lattice, column, ..
            } => {
                let (i, j) = lattice.nearest_pillar(point);
                let centre = lattice.centre(i, j);
                let body = PillarBody::of_column(*column);
                Some(((i, j), ListedPillar { centre, body }))
            }
            Self::Lattice(lattice) => {
                let index = lattice.nearest(point);
                let centre = lattice.centre(index);
                let body = lattice.body_at(index);
                body.map(|body| (index, ListedPillar { centre, body }))
            }
            Self::Listed(list) => {
                let nearest = list.tops.nearest(point, Nearest::Edge, 0.0, None);
                nearest.map(|(number, _)| ((number as i64, 0), list.pillars[number]))
            }
        };
        pillar.filter(holds)
    }

    /// The pillars within a radius of the lens axis, by increasing index, and whether these are all pillars.
    pub(crate) fn listed_within(&self, radius: f64) -> (Vec<IndexedPillar>, bool) {
        match self {
            Self::Hexagonal {
                lattice, column, ..
            } => {
                let (near_i, near_j) = lattice.nearest_pillar([0.0, 0.0]);
                // Lattice points within a distance r have indices within 2 r/(sqrt3 e).
                let reach = (1.2 * radius / lattice.pitch).ceil() as i64 + 1;
                let indices = (-reach..=reach)
                    .flat_map(|i| (-reach..=reach).map(move |j| (near_i + i, near_j + j)));
                let body = PillarBody::of_column(*column);
                let pillars = indices.map(|(i, j)| {
                    let centre = lattice.centre(i, j);
                    ((i, j), ListedPillar { centre, body })
                });
                let near = |(_, pillar): &IndexedPillar| {
                    pillar.centre[0].hypot(pillar.centre[1]) <= radius
                };
                (pillars.filter(near).collect(), false)
            }
            Self::Lattice(lattice) => (lattice.within(radius), lattice.is_within(radius)),
            Self::Listed(list) => {
                let near = |(_, pillar): &IndexedPillar| {
                    pillar.centre[0].hypot(pillar.centre[1]) <= radius
                };
                let numbered = list.pillars.iter().enumerate();
                let pillars: Vec<_> = numbered
                    .map(|(number, pillar)| ((number as i64, 0), *pillar))
                    .filter(near)
                    .collect();
                let all = pillars.len() == list.pillars.len();
                (pillars, all)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reduced_vectors_are_short_and_span_the_same_lattice() {
        let [a, b] = reduced([[7.0, 1.0], [15.0, 3.0]]);
        let lengths = [a, b].map(|[x, y]| x * x + y * y);
        let product = a[0] * b[0] + a[1] * b[1];
        assert!(2.0 * product.abs() <= lengths[0] && lengths[0] <= lengths[1]);
        assert!(((a[0] * b[1] - a[1] * b[0]).abs() - 6.0).abs() < 1e-12);
    }

    #[test]
    fn lattices_contain_every_pillar_within_a_radius() {
        let body = PillarBody::of_column(0.0);
        let lattice = PlaneLattice::new([[1.3, 0.2], [0.9, 1.7]], [0.3, -0.6], body).unwrap();
        let found = lattice.within(9.0);
        let mut count = 0;
        for i in -40..=40 {
            for j in -40..=40 {
                let [x, y] = [1.3, 0.2].map(|v| v * f64::from(i));
                let centre = [x + 0.9 * f64::from(j) + 0.3, y + 1.7 * f64::from(j) - 0.6];
                if centre[0].hypot(centre[1]) <= 9.0 {
                    count += 1;
                    let near = |p: &&IndexedPillar| {
                        (p.1.centre[0] - centre[0]).hypot(p.1.centre[1] - centre[1]) < 1e-12
                    };
                    assert_eq!(found.iter().filter(near).count(), 1);
                }
            }
        }
        assert_eq!(found.len(), count);
        assert!(found.is_sorted_by_key(|(index, _)| *index));
    }

    /// Square, rectangular and centred lattices have grids along x and y, others do not.
    #[test]
    fn some_lattices_are_on_grids() {
        let body = PillarBody::of_column(0.0);
        let field = |vectors: [Point; 2]| {
            let lattice = PlaneLattice::new(vectors, [0.3, -0.6], body).unwrap();
            PillarField::Lattice(Arc::new(lattice))
        };
        for (vectors, sides) in [
            ([[5.0, 0.0], [0.0, 5.0]], [5.0, 5.0]),
            ([[5.0, 0.0], [0.0, 8.0]], [5.0, 8.0]),
            ([[6.0, 0.0], [3.0, 4.0]], [3.0, 4.0]),
            ([[6.0, 0.0], [-3.0, 4.0]], [3.0, 4.0]),
            ([[6.0, 0.0], [2.0, 7.0]], [2.0, 7.0]),
            (
                [[3f64.sqrt(), 1.0], [3f64.sqrt(), -1.0]],
                [3f64.sqrt(), 1.0],
            ),
        ] {
            let field = field(vectors);
            let grid = field.pillar_grid();
            if (sides[0] - 2.0).abs() < 1e-12 {
                // Columns closer to each other than half the pillar distance.
                assert!(grid.is_none());
                continue;
            }
            let grid = grid.unwrap();
            for (index, pillar) in field.listed_within(40.0).0 {
                let place = grid.place(index);
                for k in 0..2 {
                    assert!((grid.sides[k] - sides[k]).abs() < 1e-12);
                    let at = grid.origin[k] + grid.sides[k] * place[k] as f64;
                    assert!((at - pillar.centre[k]).abs() < 1e-12);
                }
            }
        }
        assert!(field([[5.0, 0.0], [1.234, 5.0]]).pillar_grid().is_none());
    }

    #[test]
    fn what_is_no_arrangement_is_refused() {
        let body = PillarBody::of_column(0.0);
        assert!(PlaneLattice::new([[1.0, 2.0], [2.0, 4.0]], [0.0; 2], body).is_none());
        assert!(PlaneLattice::new([[1.0, f64::NAN], [2.0, 4.0]], [0.0; 2], body).is_none());
        let at = |x: f64, radius: f64| ListedPillar {
            centre: [x, 0.0],
            body: PillarBody { radius, ..body },
        };
        assert!(PillarList::new(Vec::new()).is_none());
        assert!(PillarList::new(vec![at(0.0, 1.0), at(1.5, 1.0)]).is_none());
        assert!(PillarList::new(vec![at(0.0, 1.0), at(f64::INFINITY, 1.0)]).is_none());
        assert!(PillarList::new(vec![at(0.0, 1.0), at(4.0, -1.0)]).is_none());
        let list = PillarList::new(vec![at(0.0, 1.0), at(4.0, 0.5), at(9.0, 0.5)]).unwrap();
        assert!((list.spacing - 5.0).abs() < 1e-12 && (list.least_gap - 5.0).abs() < 1e-12);
    }
}
