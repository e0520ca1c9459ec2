//! Where pillars stand and how they are made: a hexagonal lattice of equal ones, any other lattice, or a list. In the units of the solvers.

#![cfg_attr(
    not(test),
    expect(
        dead_code,
        reason = "problems ask for lattices of equal pillars so far"
    )
)]

use super::lattice::HexagonalLattice;
use super::point::Point;
use crate::numerics::neighbours::Neighbours;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A pillar without its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PillarBody {
    /// Radius of its top.
    pub(crate) radius: f64,
    /// By how much it is higher than the common height over the floor.
    pub(crate) raised: f64,
    /// `kappa`, by its own height and radius: shortening of the column over the indentation of its top, as a flat punch.
    pub(crate) column_compliance_ratio: f64,
}

impl PillarBody {
    /// Of the unit radius and the common height.
    pub(crate) fn of_column(column_compliance_ratio: f64) -> Self {
        Self {
            radius: 1.0,
            raised: 0.0,
            column_compliance_ratio,
        }
    }
}

/// A pillar of a list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ListedPillar {
    /// From the lens axis.
    pub(crate) centre: Point,
    pub(crate) body: PillarBody,
}

/// What a pillar is known by, and the pillar.
pub(crate) type IndexedPillar = ((i64, i64), ListedPillar);

/// Lattice vectors whose shorter diagonals are not shorter than themselves (Gauss), so that near pillars have small indices.
pub(crate) fn reduced([mut a, mut b]: [Point; 2]) -> [Point; 2] {
    let dot = |a: Point, b: Point| a[0] * b[0] + a[1] * b[1];
    loop {
        if dot(a, a) > dot(b, b) {
            (a, b) = (b, a);
        }
        let steps = (dot(a, b) / dot(a, a)).round();
        let next = [b[0] - steps * a[0], b[1] - steps * a[1]];
        // The strict decrease ends the loop whatever the rounding.
        if steps == 0.0 || dot(next, next) >= dot(b, b) {
            return [a, b];
        }
        b = next;
    }
}

/// Pillars on any plane lattice, but for some that are missing or made otherwise.
#[derive(Debug, Clone)]
pub(crate) struct PlaneLattice {
    /// Reduced.
    basis: [Point; 2],
    /// From the lens axis to the pillar of index (0, 0).
    origin: Point,
    body: PillarBody,
    /// By index: what stands there instead, if anything does.
    others: BTreeMap<(i64, i64), Option<PillarBody>>,
}

impl PlaneLattice {
    /// The indices of its pillars are those in the [reduced] basis. `None` if the vectors do not span the plane.
    pub(crate) fn new(vectors: [Point; 2], origin: Point, body: PillarBody) -> Option<Self> {
        let [[a, b], [c, d]] = vectors;
        let area = (a * d - b * c).abs();
        let longest = a.hypot(b).max(c.hypot(d));
        // An area of rounding errors is none; nor is one that is no number.
        (area > 1e-9 * longest * longest && area.is_finite()).then(|| Self {
            basis: reduced(vectors),
            origin,
            body,
            others: BTreeMap::new(),
        })
    }

    /// The same with the pillar nearest to a point taken away or replaced.
    pub(crate) fn with_other(mut self, near: Point, body: Option<PillarBody>) -> Self {
        let [x, y] = [near[0] - self.origin[0], near[1] - self.origin[1]];
        let [[a, b], [c, d]] = self.basis;
        let area = a * d - b * c;
        let [i, j] = [
            ((x * d - y * c) / area).round() as i64,
            ((a * y - b * x) / area).round() as i64,
        ];
        let distance = |index: &(i64, i64)| {
            let [u, v] = self.centre(*index);
            (u - near[0]).hypot(v - near[1])
        };
        let around = (-1..=1).flat_map(|k| (-1..=1).map(move |l| (i + k, j + l)));
        if let Some(index) = around.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
            self.others.insert(index, body);
        }
        self
    }

    fn centre(&self, (i, j): (i64, i64)) -> Point {
        [0, 1].map(|k| self.origin[k] + self.basis[0][k] * i as f64 + self.basis[1][k] * j as f64)
    }

    fn cell_area(&self) -> f64 {
        let [[a, b], [c, d]] = self.basis;
        (a * d - b * c).abs()
    }

    /// All pillars with centres within a radius of the lens axis, by rising index.
    fn within(&self, radius: f64) -> Vec<IndexedPillar> {
        let lengths = self.basis.map(|[x, y]| x.hypot(y));
        let reach = radius + self.origin[0].hypot(self.origin[1]);
        // The distance of rows i = constant is the area of the cell over the length of the other vector.
        let most = |other: usize| (reach * lengths[other] / self.cell_area()).ceil() as i64;
        let (rows, columns) = (most(1), most(0));
        let mut pillars = Vec::new();
        for i in -rows..=rows {
            for j in -columns..=columns {
                let centre = self.centre((i, j));
                let body = self.others.get(&(i, j)).copied();
                if let Some(body) = body.unwrap_or(Some(self.body))
                    && centre[0].hypot(centre[1]) <= radius
                {
                    pillars.push(((i, j), ListedPillar { centre, body }));
                }
            }
        }
        pillars
    }

    fn bodies(&self) -> impl Iterator<Item = &PillarBody> {
        std::iter::once(&self.body).chain(self.others.values().flatten())
    }
}

/// Pillars of a list, and no others.
#[derive(Debug, Clone)]
pub(crate) struct PillarList {
    pillars: Vec<ListedPillar>,
    /// The largest distance of a pillar from its nearest neighbour.
    spacing: f64,
    /// The least gap between two tops over the smaller of their radii.
    least_gap: f64,
}

impl PillarList {
    /// `None` of no pillars, of some that overlap, and of places or sizes that are none.
    pub(crate) fn new(pillars: Vec<ListedPillar>) -> Option<Self> {
        let largest = pillars.iter().map(|p| p.body.radius).fold(0.0, f64::max);
        let are_numbers = pillars.iter().all(|ListedPillar { centre, body }| {
            let values = [centre[0], centre[1], body.raised];
            body.radius > 0.0
                && body.radius.is_finite()
                && body.column_compliance_ratio >= 0.0
                && values.iter().all(|value| value.is_finite())
        });
        if pillars.is_empty() || !are_numbers {
            return None;
        }
        let neighbours = neighbours_of(&pillars);
        let least_gap = neighbours.least_gap();
        // Without neighbours, as if one stood twice the diameter away.
        let spacing = neighbours.spacing().unwrap_or(4.0 * largest);
        (least_gap >= 0.0).then_some(Self {
            pillars,
            spacing,
            least_gap,
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

/// Two pillars that overlap, if any do, by their numbers, with the distance of their centres: the first that does, and that which reaches farthest
/// into it.
pub(crate) fn overlapping(pillars: &[ListedPillar]) -> Option<(usize, usize, f64)> {
    neighbours_of(pillars).overlapping()
}

/// Where pillars stand and how they are made.
#[derive(Debug, Clone)]
pub(crate) enum PillarField {
    /// All of the unit radius and the common height.
    Hexagonal {
        lattice: HexagonalLattice,
        column_compliance_ratio: f64,
    },
    Lattice(Arc<PlaneLattice>),
    Listed(Arc<PillarList>),
}

impl PillarField {
    /// How far apart neighbours stand.
    pub(crate) fn spacing(&self) -> f64 {
        match self {
            Self::Hexagonal { lattice, .. } => lattice.pitch,
            Self::Lattice(lattice) => lattice.basis[1][0].hypot(lattice.basis[1][1]),
            Self::Listed(list) => list.spacing,
        }
    }

    /// Area for each, about.
    pub(crate) fn cell_area(&self) -> f64 {
        match self {
            Self::Hexagonal { lattice, .. } => lattice.cell_area(),
            Self::Lattice(lattice) => lattice.cell_area(),
            Self::Listed(list) => list.spacing * list.spacing,
        }
    }

    /// The least gap between two tops over the smaller of their radii; of a lattice, at the most that.
    pub(crate) fn least_gap(&self) -> f64 {
        match self {
            Self::Hexagonal { lattice, .. } => lattice.pitch - 2.0,
            Self::Lattice(lattice) => {
                let shortest = lattice.basis[0][0].hypot(lattice.basis[0][1]);
                let radii = lattice.bodies().map(|body| body.radius);
                let (least, most) = radii.fold((f64::INFINITY, 0.0_f64), |(a, b), radius| {
                    (a.min(radius), b.max(radius))
                });
                (shortest - 2.0 * most) / least
            }
            Self::Listed(list) => list.least_gap,
        }
    }

    /// The column compliance that is common, or that of the first pillar.
    pub(crate) fn column_compliance_ratio(&self) -> f64 {
        match self {
            Self::Hexagonal {
                column_compliance_ratio,
                ..
            } => *column_compliance_ratio,
            Self::Lattice(lattice) => lattice.body.column_compliance_ratio,
            Self::Listed(list) => list.pillars[0].body.column_compliance_ratio,
        }
    }

    /// The largest radius of a top, and the largest height over the common one.
    pub(crate) fn bounds(&self) -> [f64; 2] {
        let largest = |[radius, raised]: [f64; 2], body: &PillarBody| {
            [radius.max(body.radius), raised.max(body.raised)]
        };
        let least = [0.0, f64::NEG_INFINITY];
        match self {
            Self::Hexagonal { .. } => [1.0, 0.0],
            Self::Lattice(lattice) => lattice.bodies().fold(least, largest),
            Self::Listed(list) => {
                let bodies = list.pillars.iter().map(|pillar| &pillar.body);
                bodies.fold(least, largest)
            }
        }
    }

    /// About how many pillars stand within a radius of the lens axis.
    pub(crate) fn expected_len(&self, radius: f64) -> f64 {
        let on_lattice = |area: f64| std::f64::consts::PI * radius * radius / area;
        match self {
            Self::Hexagonal { lattice, .. } => on_lattice(lattice.cell_area()),
            Self::Lattice(lattice) => on_lattice(lattice.cell_area()),
            Self::Listed(list) => list.pillars.len() as f64,
        }
    }

    /// The pillars within a radius of the lens axis, by rising index; of a hexagonal lattice, none. Whether these are all that there are.
    pub(crate) fn listed_within(&self, radius: f64) -> (Vec<IndexedPillar>, bool) {
        match self {
            Self::Hexagonal { .. } => (Vec::new(), false),
            Self::Lattice(lattice) => (lattice.within(radius), false),
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
    fn lattices_hold_every_pillar_within_a_radius() {
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
        let missing = lattice.clone().with_other(found[7].1.centre, None);
        assert_eq!(missing.within(9.0).len(), count - 1);
        assert!(missing.within(9.0).iter().all(|p| p.0 != found[7].0));
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
        let three = [at(0.0, 1.0), at(7.0, 2.0), at(5.5, 1.0)];
        assert_eq!(overlapping(&three), Some((1, 2, 1.5)));
        assert_eq!(overlapping(&three[..2]), None);
        assert!(PillarList::new(vec![at(0.0, 1.0), at(f64::INFINITY, 1.0)]).is_none());
        assert!(PillarList::new(vec![at(0.0, 1.0), at(4.0, -1.0)]).is_none());
        let list = PillarList::new(vec![at(0.0, 1.0), at(4.0, 0.5), at(9.0, 0.5)]).unwrap();
        assert!((list.spacing - 5.0).abs() < 1e-12 && (list.least_gap - 5.0).abs() < 1e-12);
    }
}
