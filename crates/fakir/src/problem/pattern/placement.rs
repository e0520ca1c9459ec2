//! Where the pillars of a pattern stand.

use super::invalid::InvalidPattern;
use crate::problem::grid::Grid;
use crate::problem::lattice::HexagonalLattice;
use crate::problem::point::Point;
use std::collections::HashMap;
use std::ops::RangeInclusive;

/// Places that are tried for each pillar before giving up: random addition of discs comes to
/// cover 0.547 of the plane (J. Feder, J. Theor. Biol. 87, 237 (1980)), very slowly at last.
const TRIALS: usize = 2000;

/// A pillar to be drawn.
pub(super) struct Site {
    /// Tells it from the others, whatever the grid.
    name: [i64; 2],
    /// Its centre; and those of its images, where it reaches over the border of a period.
    pub(super) centres: Vec<Point>,
}

impl Site {
    /// The random numbers that belong to this pillar alone.
    pub(super) fn random(&self, seed: u64) -> Random {
        let [i, j] = self.name.map(|index| index as u64);
        let mut random = Random::new(seed ^ i.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        Random::new(random.next() ^ j.wrapping_mul(0xd1b5_4a32_d192_ed03))
    }
}

/// A sequence of random numbers: SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014).
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// A number from 0 to below 1.
    pub(super) fn uniform(&mut self) -> f64 {
        // The 53 bits that a double holds.
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// The multiples of `step` in the extent of the grid along an axis, and `reach` beyond it, as
/// seen from `offset`.
fn multiples(
    grid: &Grid,
    axis: usize,
    step: f64,
    offset: Point,
    reach: f64,
) -> RangeInclusive<i64> {
    let start = grid.origin()[axis] + offset[axis];
    let end = start + extent(grid)[axis];
    ((start - reach) / step).ceil() as i64..=((end + reach) / step).floor() as i64
}

/// Sides of the grid, m.
pub(super) fn extent(grid: &Grid) -> Point {
    let [width, height] = grid.cell();
    [grid.columns() as f64 * width, grid.rows() as f64 * height]
}

pub(super) fn square(pitch: f64, offset: Point, grid: &Grid, reach: f64) -> Vec<Site> {
    let rows = multiples(grid, 1, pitch, offset, reach);
    let columns = multiples(grid, 0, pitch, offset, reach);
    rows.flat_map(|j| columns.clone().map(move |i| (i, j)))
        .map(|(i, j)| Site {
            name: [i, j],
            centres: vec![[pitch * i as f64 - offset[0], pitch * j as f64 - offset[1]]],
        })
        .collect()
}

pub(super) fn hexagonal(lattice: &HexagonalLattice, grid: &Grid, reach: f64) -> Vec<Site> {
    // x goes as the sum of the two indices and y as their difference.
    let offset = lattice.offset_vector();
    let [x_step, y_step] = [0, 1].map(|axis| lattice.lattice_vector(1, 0)[axis]);
    let differences = multiples(grid, 1, y_step, offset, reach);
    let sums = multiples(grid, 0, x_step, offset, reach);
    differences
        .flat_map(|difference| sums.clone().map(move |sum| (sum, difference)))
        .filter(|(sum, difference)| (sum + difference) % 2 == 0)
        .map(|(sum, difference)| {
            let (i, j) = ((sum + difference) / 2, (sum - difference) / 2);
            Site {
                name: [i, j],
                centres: vec![lattice.centre(i, j)],
            }
        })
        .collect()
}

/// The sites whose centres lie in the grid, continued over its border as over that of a period.
pub(super) fn continued(sites: Vec<Site>, grid: &Grid) -> Vec<Site> {
    let (origin, period) = (grid.origin(), extent(grid));
    let inside = |site: &Site| {
        let centre = site.centres[0];
        (0..2).all(|axis| (0.0..period[axis]).contains(&(centre[axis] - origin[axis])))
    };
    let continue_site = |site: Site| Site {
        centres: images(site.centres[0], period).collect(),
        ..site
    };
    sites
        .into_iter()
        .filter(inside)
        .map(continue_site)
        .collect()
}

/// Random sequential addition on the grid as a period.
pub(super) fn random(
    count: usize,
    minimum_distance: f64,
    grid: &Grid,
    random: &mut Random,
) -> Result<Vec<Site>, InvalidPattern> {
    let period = extent(grid);
    let mut bins = Bins::new(period, minimum_distance);
    let mut placed: Vec<Point> = Vec::with_capacity(count);
    while placed.len() < count {
        let free = (0..TRIALS).find_map(|_| {
            let place = period.map(|side| side * random.uniform());
            bins.is_free(place, &placed).then_some(place)
        });
        let Some(place) = free else {
            return Err(InvalidPattern::TooCrowded {
                placed: placed.len(),
                wanted: count,
                minimum_distance,
            });
        };
        bins.insert(place, placed.len());
        placed.push(place);
    }
    let origin = grid.origin();
    Ok(placed
        .into_iter()
        .zip(0..)
        .map(|(place, number)| Site {
            name: [number, 0],
            centres: images(place, period)
                .map(|[x, y]| [origin[0] + x, origin[1] + y])
                .collect(),
        })
        .collect())
}

/// A point and its eight nearest images.
fn images([x, y]: Point, [width, height]: Point) -> impl Iterator<Item = Point> {
    let shifts = [0.0, -1.0, 1.0];
    shifts
        .into_iter()
        .flat_map(move |i| shifts.map(|j| [x + i * width, y + j * height]))
}

/// Points of a period by squares no smaller than the distance they keep.
struct Bins {
    period: Point,
    distance: f64,
    counts: [i64; 2],
    members: HashMap<[i64; 2], Vec<usize>>,
}

impl Bins {
    fn new(period: Point, distance: f64) -> Self {
        Self {
            period,
            distance,
            counts: period.map(|side| ((side / distance).floor() as i64).max(1)),
            members: HashMap::new(),
        }
    }

    fn bin(&self, place: Point) -> [i64; 2] {
        [0, 1].map(|axis| {
            let bin = place[axis] / self.period[axis] * self.counts[axis] as f64;
            (bin as i64).min(self.counts[axis] - 1)
        })
    }

    fn insert(&mut self, place: Point, number: usize) {
        self.members
            .entry(self.bin(place))
            .or_default()
            .push(number);
    }

    /// Whether a point keeps its distance from all others, and from its own images.
    fn is_free(&self, place: Point, others: &[Point]) -> bool {
        if self.period.iter().any(|side| *side < self.distance) {
            return false;
        }
        let [column, row] = self.bin(place);
        let neighbours = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [column + i, row + j]));
        neighbours
            .map(|bin| [0, 1].map(|axis| bin[axis].rem_euclid(self.counts[axis])))
            .filter_map(|bin| self.members.get(&bin))
            .flatten()
            .all(|other| self.distance_between(place, others[*other]) >= self.distance)
    }

    fn distance_between(&self, a: Point, b: Point) -> f64 {
        let [x, y] = [0, 1].map(|axis| {
            let apart = a[axis] - b[axis];
            apart - self.period[axis] * (apart / self.period[axis]).round()
        });
        x.hypot(y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_pillars_keep_their_distance_over_the_border_too() {
        let grid = Grid::new(100, 60, [1.0, 1.0], [-20.0, 5.0]).unwrap();
        // Discs of diameter 4 that cover 0.45 of the period.
        let count = (0.45 * 6000.0 / (4.0 * std::f64::consts::PI)) as usize;
        let sites = random(count, 4.0, &grid, &mut Random::new(3)).unwrap();
        assert_eq!(sites.len(), count);
        for (k, site) in sites.iter().enumerate() {
            let [x, y] = site.centres[0];
            assert!((-20.0..=80.0).contains(&x) && (5.0..=65.0).contains(&y));
            for other in &sites[..k] {
                for [u, v] in &other.centres {
                    assert!((x - u).hypot(y - v) >= 4.0);
                }
            }
        }
        let crowded = random(2 * count, 4.0, &grid, &mut Random::new(3)).err();
        let Some(InvalidPattern::TooCrowded { placed, wanted, .. }) = crowded else {
            panic!("too many pillars were placed");
        };
        // Not far below the coverage at which random addition comes to an end.
        let coverage = placed as f64 * 4.0 * std::f64::consts::PI / 6000.0;
        assert!(
            wanted == 2 * count && coverage > 0.48 && coverage < 0.56,
            "{coverage}"
        );
    }

    #[test]
    fn lattices_are_complete_in_the_grid_and_around_it() {
        let grid = Grid::new(30, 20, [1.0, 1.0], [-3.0, -11.0]).unwrap();
        let lattice = HexagonalLattice {
            pitch: 2.3,
            offset: 0.4,
            offset_angle: 0.3,
        };
        let inside = |[x, y]: Point| (-4.0..=28.0).contains(&x) && (-12.0..=10.0).contains(&y);
        let sites = hexagonal(&lattice, &grid, 1.0);
        assert!(sites.iter().all(|site| inside(site.centres[0])));
        let expected = (-60..60)
            .flat_map(|i| (-60..60).map(move |j| (i, j)))
            .filter(|(i, j)| inside(lattice.centre(*i, *j)))
            .count();
        assert_eq!(sites.len(), expected);
        let sites = square(2.3, [0.7, -0.4], &grid, 1.0);
        let on_axis = |index: i64, offset: f64, range: RangeInclusive<f64>| {
            range.contains(&(2.3 * index as f64 - offset))
        };
        let columns = (-60..60).filter(|i| on_axis(*i, 0.7, -4.0..=28.0)).count();
        let rows = (-60..60)
            .filter(|j| on_axis(*j, -0.4, -12.0..=10.0))
            .count();
        assert_eq!(sites.len(), columns * rows);
    }
}
