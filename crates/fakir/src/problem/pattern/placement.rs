//! Positions of the pillars of a pattern.

use super::invalid::InvalidPattern;
use crate::problem::arrangement::{PlaneLattice, RandomPlaces, coordinates};
use crate::problem::grid::Grid;
use crate::problem::point::Point;
use crate::problem::scatter::Random;
use std::collections::HashMap;

/// Number of trials for each pillar before the placement fails. Random sequential addition of discs covers at most 0.547 of the plane (J.
/// Feder, J. Theor. Biol. 87, 237 (1980)), with slow convergence.
const TRIALS: usize = 2000;

/// A pillar to be drawn.
pub(super) struct Site {
    /// Identifies the pillar independently of the grid.
    pub(super) index: (i64, i64),
    /// Its centre, and those of its periodic images if it crosses the border of a period.
    pub(super) centres: Vec<Point>,
}

/// Sides of the grid, m.
pub(super) fn extent(grid: &Grid) -> Point {
    let [width, height] = grid.cell();
    [grid.columns() as f64 * width, grid.rows() as f64 * height]
}

/// The pillars of a lattice with centres on the grid or within `reach` of it, including missing ones, by rows along x if the lattice has
/// such rows.
pub(super) fn on_lattice(lattice: &PlaneLattice, grid: &Grid, reach: f64) -> Vec<Site> {
    let (start, sides) = (grid.origin(), extent(grid));
    let ends = [0, 1].map(|axis| [start[axis] - reach, start[axis] + sides[axis] + reach]);
    let (vectors, origin) = (lattice.vectors(), lattice.origin());
    let corners = ends[0].into_iter().flat_map(|x| ends[1].map(|y| [x, y]));
    let corners = corners.map(|[x, y]| coordinates([x - origin[0], y - origin[1]], vectors));
    let [first, last] = corners.fold(
        [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]],
        |[first, last], corner| {
            [
                [0, 1].map(|k| first[k].min(corner[k])),
                [0, 1].map(|k| last[k].max(corner[k])),
            ]
        },
    );
    let range = |k: usize| {
        let [mut first, mut end] = [first[k].floor() as i64, last[k].ceil() as i64 + 1];
        if let Some([least, most]) = lattice.ends() {
            (first, end) = (first.max(least), end.min(most));
        }
        first..end
    };
    // The coordinates of a hexagonal lattice have bitwise equal y along its rows if they are computed by its own sum.
    let hexagonal = lattice.hexagonal();
    let centre = |(i, j): (i64, i64)| {
        hexagonal.map_or_else(|| lattice.place((i, j)), |lattice| lattice.centre(i, j))
    };
    let is_near = |centre: &Point| (0..2).all(|k| (ends[k][0]..=ends[k][1]).contains(&centre[k]));
    let indices = range(0).flat_map(|i| range(1).map(move |j| (i, j)));
    let mut sites: Vec<_> = indices
        .map(|index| (index, centre(index)))
        .filter(|(_, centre)| is_near(centre))
        .collect();
    sites.sort_by(|(_, [x, y]), (_, [u, v])| y.total_cmp(v).then(x.total_cmp(u)));
    let site = |(index, centre)| Site {
        index,
        centres: vec![centre],
    };
    sites.into_iter().map(site).collect()
}

/// The sites whose centres are in the grid, continued periodically over its border.
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

/// Random sequential addition with the grid as a period.
pub(super) fn random(places: &RandomPlaces, grid: &Grid) -> Result<Vec<Site>, InvalidPattern> {
    let minimum_distance = places.minimum_distance;
    let area = grid.cell_count() as f64 * grid.cell_area();
    let count = (area / places.cell_area).round() as usize;
    let mut random = Random::new(places.disorder.heights.seed);
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
            index: (number, 0),
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

/// Points of a period, sorted into squares that are at least as large as the minimum distance.
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

    /// Whether a point keeps the minimum distance from all others, and from its own images.
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
    use crate::problem::arrangement::LatticeForm;
    use crate::problem::scatter::{Disorder, Scatter};
    use std::f64::consts::PI;

    #[test]
    fn random_pillars_keep_their_distance_over_the_border_too() {
        let grid = Grid::new(100, 60, [1.0, 1.0], [-20.0, 5.0]).unwrap();
        let random = |count: f64| {
            let places = RandomPlaces {
                cell_area: 6000.0 / count,
                minimum_distance: 4.0,
                disorder: Disorder {
                    heights: Scatter::uniform(0.0, 3),
                    missing: 0.0,
                },
            };
            random(&places, &grid)
        };
        // Discs of diameter 4 that cover 0.45 of the period.
        let count = (0.45 * 6000.0 / (4.0 * PI)).floor();
        let sites = random(count).unwrap();
        assert_eq!(sites.len(), count as usize);
        for (k, site) in sites.iter().enumerate() {
            let [x, y] = site.centres[0];
            assert!((-20.0..=80.0).contains(&x) && (5.0..=65.0).contains(&y));
            for other in &sites[..k] {
                for [u, v] in &other.centres {
                    assert!((x - u).hypot(y - v) >= 4.0);
                }
            }
        }
        let crowded = random(2.0 * count).err();
        let Some(InvalidPattern::TooCrowded { placed, wanted, .. }) = crowded else {
            panic!("too many pillars were placed");
        };
        // Close to the jamming limit of random sequential addition.
        let coverage = placed as f64 * 4.0 * PI / 6000.0;
        assert!(
            wanted == 2 * count as usize && coverage > 0.48 && coverage < 0.56,
            "{coverage}"
        );
    }

    #[test]
    fn lattices_are_complete_in_the_grid_and_around_it() {
        let grid = Grid::new(30, 20, [1.0, 1.0], [-3.0, -11.0]).unwrap();
        let inside = |[x, y]: &Point| (-4.0..=28.0).contains(x) && (-12.0..=10.0).contains(y);
        let (pitch, pitch_y, angle) = (2.3, 3.1, 0.8);
        let forms = [
            LatticeForm::Hexagonal { pitch },
            LatticeForm::Square { pitch },
            LatticeForm::Rectangular { pitch, pitch_y },
            LatticeForm::Oblique {
                pitch,
                pitch_y,
                angle,
            },
        ];
        for (form, rotation, columns) in forms.into_iter().flat_map(|form| {
            [(0.0, None), (0.0, Some(8)), (0.7, None)].map(|(angle, cut)| (form, angle, cut))
        }) {
            let lattice = PlaneLattice {
                offset: 0.4,
                offset_angle: 0.3,
                rotation,
                columns,
                ..PlaneLattice::new(form)
            };
            let sites = on_lattice(&lattice, &grid, 1.0);
            assert!(sites.iter().all(|site| inside(&site.centres[0])));
            let range = || columns.map_or(-80..80, |_| -4..4);
            let expected = range()
                .flat_map(|i| range().map(move |j| (i, j)))
                .filter(|index| inside(&lattice.place(*index)))
                .count();
            assert_eq!(sites.len(), expected, "{lattice:?}");
        }
    }
}
