//! Spatial search for discs in the plane: a tree of boxes, each of which contains half of the discs of its parent.
//!
//! Memory and the number of steps of a search do not depend on the arrangement: in clusters, in a row, or far apart.

use std::ops::Range;

/// A disc: its centre and its radius.
pub(crate) type Disc = ([f64; 2], f64);

/// Largest number of discs in a box that is not divided further.
const LEAF: usize = 8;

/// Discs, arranged for spatial search.
#[derive(Debug, Clone)]
pub(crate) struct Neighbours {
    /// The discs; those of a box are contiguous.
    discs: Vec<Disc>,
    /// Indices of the discs in the input.
    numbers: Vec<u32>,
    /// The boxes, in depth-first order: each precedes the two boxes into which it is divided.
    boxes: Vec<Bounds>,
}

/// Bounding rectangle of the centres of some discs.
#[derive(Debug, Clone)]
struct Bounds {
    low: [f64; 2],
    high: [f64; 2],
    /// The largest radius.
    largest: f64,
    /// Range of the discs in `Neighbours::discs`.
    discs: Range<u32>,
    /// The second of the two boxes into which the box is divided; the first follows immediately.
    second: Option<u32>,
}

impl Bounds {
    /// Distance of a point from the rectangle, and from its farthest point.
    fn distances(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [[a, b], [c, d]] = [(0, x), (1, y)].map(|(k, at)| {
            let (below, above) = (self.low[k] - at, at - self.high[k]);
            [below.max(above).max(0.0), below.abs().max(above.abs())]
        });
        [length([a, c]), length([b, d])]
    }
}

/// Length of a vector whose squares neither overflow nor underflow: faster than `hypot`.
fn length([x, y]: [f64; 2]) -> f64 {
    let square = x * x + y * y;
    square.sqrt()
}

fn between(a: [f64; 2], b: [f64; 2]) -> f64 {
    length([a[0] - b[0], a[1] - b[1]])
}

/// Criterion of a nearest-disc search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Nearest {
    Centre,
    /// Distance from the edge of a disc; negative inside of it.
    Edge,
}

impl Neighbours {
    /// Builds the tree. Centres and radii must be finite.
    pub(crate) fn new(discs: impl Iterator<Item = Disc>) -> Self {
        let mut numbered: Vec<(Disc, u32)> = discs.zip(0..).collect();
        let mut boxes = Vec::new();
        divide(&mut numbered, 0, &mut boxes);
        Self {
            discs: numbered.iter().map(|(disc, _)| *disc).collect(),
            numbers: numbered.iter().map(|(_, number)| *number).collect(),
            boxes,
        }
    }

    fn of(&self, leaf: &Bounds) -> impl Iterator<Item = (&Disc, usize)> {
        let places = leaf.discs.start as usize..leaf.discs.end as usize;
        let numbers = self.numbers[places.clone()].iter().map(|n| *n as usize);
        self.discs[places].iter().zip(numbers)
    }

    /// Returns the indices of the discs whose centres are within `distance` of a point, in increasing order.
    pub(crate) fn within(&self, point: [f64; 2], distance: f64) -> Vec<u32> {
        let mut found = Vec::new();
        let mut open = vec![0];
        while let Some(place) = open.pop() {
            let Some(own) = self.boxes.get(place as usize) else {
                continue;
            };
            if own.distances(point)[0] > distance {
                continue;
            }
            if let Some(second) = own.second {
                open.extend([place + 1, second]);
                continue;
            }
            let near = self
                .of(own)
                .filter(|((centre, _), _)| between(*centre, point) <= distance);
            found.extend(near.map(|(_, number)| number as u32));
        }
        found.sort_unstable();
        found
    }

    /// Counts the discs whose centres are within `distance` of a point.
    pub(crate) fn count_within(&self, point: [f64; 2], distance: f64) -> usize {
        let mut count = 0;
        let mut open = vec![0];
        while let Some(place) = open.pop() {
            let Some(own) = self.boxes.get(place as usize) else {
                continue;
            };
            let [least, most] = own.distances(point);
            if most <= distance {
                count += own.discs.len();
            } else if least <= distance {
                match own.second {
                    Some(second) => open.extend([place + 1, second]),
                    None => {
                        let near = self
                            .of(own)
                            .filter(|((centre, _), _)| between(*centre, point) <= distance);
                        count += near.count();
                    }
                }
            }
        }
        count
    }

    /// Returns the disc nearest to a point among those with at least the given radius, excluding one, and its distance; the first of
    /// several equal ones.
    pub(crate) fn nearest(
        &self,
        point: [f64; 2],
        what: Nearest,
        least_radius: f64,
        but: Option<usize>,
    ) -> Option<(usize, f64)> {
        let less = |radius: f64| match what {
            Nearest::Centre => 0.0,
            Nearest::Edge => radius,
        };
        let mut best: Option<(usize, f64)> = None;
        let may_hold = |own: &Bounds, best: Option<(usize, f64)>| {
            let bound = own.distances(point)[0] - less(own.largest);
            own.largest >= least_radius && best.is_none_or(|(_, distance)| bound <= distance)
        };
        let mut open = vec![0_u32];
        while let Some(place) = open.pop() {
            let Some(own) = self.boxes.get(place as usize) else {
                continue;
            };
            if !may_hold(own, best) {
                continue;
            }
            if let Some(second) = own.second {
                // Searches the nearer box first.
                let mut both = [place + 1, second];
                let distance = |place: u32| self.boxes[place as usize].distances(point)[0];
                if distance(both[0]) < distance(both[1]) {
                    both.reverse();
                }
                open.extend(both);
                continue;
            }
            for (&(centre, radius), number) in self.of(own) {
                let distance = between(centre, point) - less(radius);
                let is_nearer = best.is_none_or(|(other, least)| {
                    distance.total_cmp(&least).then(number.cmp(&other)).is_lt()
                });
                if radius >= least_radius && Some(number) != but && is_nearer {
                    best = Some((number, distance));
                }
            }
        }
        best
    }

    /// Divides all discs into boxes of at most `most` discs, each with the indices of its discs and its width and height.
    pub(crate) fn groups(&self, most: usize) -> Vec<(&[u32], [f64; 2])> {
        let mut groups = Vec::new();
        let mut open = vec![0];
        while let Some(place) = open.pop() {
            let Some(own) = self.boxes.get(place) else {
                continue;
            };
            match own.second {
                Some(second) if own.discs.len() > most => open.extend([second as usize, place + 1]),
                _ => {
                    let places = own.discs.start as usize..own.discs.end as usize;
                    let sides = [0, 1].map(|k| own.high[k] - own.low[k]);
                    groups.push((&self.numbers[places], sides));
                }
            }
        }
        groups
    }

    /// Sums of `N` numbers per disc, over the discs of every box.
    pub(crate) fn sums<const N: usize>(&self, of: impl Fn(usize) -> [f64; N]) -> Vec<[f64; N]> {
        let mut sums = vec![[0.0; N]; self.boxes.len()];
        for (place, own) in self.boxes.iter().enumerate().rev() {
            sums[place] = match own.second {
                Some(second) => {
                    let [one, other] = [place + 1, second as usize].map(|part| sums[part]);
                    std::array::from_fn(|k| one[k] + other[k])
                }
                None => self.of(own).fold([0.0; N], |sum, (_, number)| {
                    let more = of(number);
                    std::array::from_fn(|k| sum[k] + more[k])
                }),
            };
        }
        sums
    }

    /// Approximation of all discs for points within a distance of `point`: boxes whose size is at most `smallness` times their distance, as
    /// indices into the [sums](Self::sums), and the remaining discs as indices.
    pub(crate) fn seen_from(
        &self,
        (point, around): ([f64; 2], f64),
        smallness: f64,
        mut small: impl FnMut(usize),
        mut near: impl FnMut(usize),
    ) {
        let mut open = vec![0];
        while let Some(place) = open.pop() {
            let Some(own) = self.boxes.get(place) else {
                continue;
            };
            let [least, most] = own.distances(point);
            if most - least <= smallness * (least - around) {
                small(place);
                continue;
            }
            match own.second {
                Some(second) => open.extend([place + 1, second as usize]),
                None => self.of(own).for_each(|(_, number)| near(number)),
            }
        }
    }

    /// Two overlapping discs and the distance of their centres: the first disc that overlaps another, and the one that overlaps it most.
    pub(crate) fn overlapping(&self) -> Option<(usize, usize, f64)> {
        let first = self
            .discs
            .iter()
            .zip(&self.numbers)
            .filter_map(|(disc, number)| {
                let (centre, radius) = *disc;
                let own = *number as usize;
                let (other, edge) = self.nearest(centre, Nearest::Edge, 0.0, Some(own))?;
                (edge < radius).then_some((own, other))
            });
        let (own, other) = first.min()?;
        let place = |number: usize| self.numbers.iter().position(|n| *n as usize == number);
        let [a, b] = [place(own)?, place(other)?].map(|place| self.discs[place].0);
        Some((own, other, between(a, b)))
    }

    /// The smallest gap between two discs divided by the smaller of their radii; infinite for a single disc.
    pub(crate) fn least_gap(&self) -> f64 {
        let gaps = self.discs.iter().zip(&self.numbers).map(|(disc, number)| {
            let (centre, radius) = *disc;
            let larger = self.nearest(centre, Nearest::Edge, radius, Some(*number as usize));
            larger.map_or(f64::INFINITY, |(_, edge)| (edge - radius) / radius)
        });
        gaps.fold(f64::INFINITY, f64::min)
    }

    /// The distance of every centre from the nearest other one, in unspecified order; empty for one disc.
    pub(crate) fn distances(&self) -> impl Iterator<Item = f64> {
        let each = self.discs.iter().zip(&self.numbers);
        each.filter_map(|(disc, number)| {
            let (_, distance) =
                self.nearest(disc.0, Nearest::Centre, 0.0, Some(*number as usize))?;
            Some(distance)
        })
    }

    /// The largest of these distances.
    pub(crate) fn spacing(&self) -> Option<f64> {
        self.distances().reduce(f64::max)
    }
}

/// Appends the box of some discs and, recursively, the boxes into which it is divided. `first` is the position of the first disc.
fn divide(discs: &mut [(Disc, u32)], first: usize, boxes: &mut Vec<Bounds>) {
    if discs.is_empty() {
        return;
    }
    let bounds = |k: usize| {
        let values = discs.iter().map(|((centre, _), _)| centre[k]);
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| {
            [a.min(x), b.max(x)]
        })
    };
    let [[left, right], [low, high]] = [bounds(0), bounds(1)];
    let place = boxes.len();
    boxes.push(Bounds {
        low: [left, low],
        high: [right, high],
        largest: discs
            .iter()
            .map(|((_, radius), _)| *radius)
            .fold(0.0, f64::max),
        discs: first as u32..(first + discs.len()) as u32,
        second: None,
    });
    if discs.len() <= LEAF {
        return;
    }
    let along = usize::from(high - low > right - left);
    let half = discs.len() / 2;
    discs.select_nth_unstable_by(half, |((a, _), m), ((b, _), n)| {
        a[along].total_cmp(&b[along]).then(m.cmp(n))
    });
    let (one, other) = discs.split_at_mut(half);
    divide(one, first, boxes);
    boxes[place].second = Some(boxes.len() as u32);
    divide(other, first + half, boxes);
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use chacha20::ChaCha8Rng;
    use chacha20::rand_core::{Rng, SeedableRng};
    use proptest::prelude::*;

    /// Discs with radii between 0.75 and 1.25 at random positions in a square, with a minimum gap, that cover the given fraction of it.
    pub(crate) fn random_discs(count: usize, covered: f64, gap: f64, seed: u64) -> Vec<Disc> {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let mut uniform = || f64::from(generator.next_u32()) / 4_294_967_296.0;
        let side = (count as f64 * std::f64::consts::PI * 1.02 / covered).sqrt();
        let mut discs: Vec<Disc> = Vec::new();
        while discs.len() < count {
            let centre = [(); 2].map(|()| side * (uniform() - 0.5));
            let radius = 0.75 + 0.5 * uniform();
            let is_apart = |disc: &Disc| between(disc.0, centre) >= radius + disc.1 + gap;
            if discs.iter().all(is_apart) {
                discs.push((centre, radius));
            }
        }
        discs
    }

    /// Compares every search with an exhaustive search.
    fn check(discs: &[Disc], at: [f64; 2], reach: f64) {
        let tree = Neighbours::new(discs.iter().copied());
        let near: Vec<u32> = (0..discs.len())
            .filter(|&k| between(discs[k].0, at) <= reach)
            .map(|k| k as u32)
            .collect();
        assert_eq!(tree.within(at, reach), near);
        assert_eq!(tree.count_within(at, reach), near.len());
        let nearest = |at: [f64; 2], what: Nearest, least: f64, but: Option<usize>| {
            let rated = discs
                .iter()
                .enumerate()
                .filter(|(k, disc)| Some(*k) != but && disc.1 >= least);
            let rated = rated.map(|(k, (centre, radius))| match what {
                Nearest::Centre => (k, between(*centre, at)),
                Nearest::Edge => (k, between(*centre, at) - radius),
            });
            rated.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
        };
        for what in [Nearest::Centre, Nearest::Edge] {
            for least in [0.0, reach] {
                let but = Some(discs.len() / 2);
                assert_eq!(
                    tree.nearest(at, what, least, None),
                    nearest(at, what, least, None)
                );
                assert_eq!(
                    tree.nearest(at, what, least, but),
                    nearest(at, what, least, but)
                );
            }
        }
        let pairs = || (0..discs.len()).flat_map(|i| (0..discs.len()).map(move |j| (i, j)));
        let pairs = || {
            pairs()
                .filter(|(i, j)| i != j)
                .map(|(i, j)| (discs[i], discs[j], i))
        };
        let gap = pairs()
            .map(|(one, other, _)| {
                let gap = between(one.0, other.0) - one.1 - other.1;
                gap / one.1.min(other.1)
            })
            .fold(f64::INFINITY, f64::min);
        let found = tree.least_gap();
        assert!(
            found.total_cmp(&gap).is_eq() || (found - gap).abs() <= 1e-9 * (1.0 + gap.abs()),
            "{found} {gap}"
        );
        let overlap = pairs().find(|(one, other, _)| between(other.0, one.0) - other.1 < one.1);
        match (tree.overlapping(), overlap) {
            (None, None) => {}
            (Some((one, other, far)), Some((_, _, first))) => {
                assert_eq!(one, first);
                assert_eq!(
                    far.to_bits(),
                    between(discs[one].0, discs[other].0).to_bits()
                );
                assert!(far < discs[one].1 + discs[other].1);
            }
            other => panic!("{other:?}"),
        }
        let groups = tree.groups(LEAF + 3);
        assert!(groups.iter().all(|(group, _)| group.len() <= LEAF + 3));
        let mut grouped: Vec<u32> = groups
            .iter()
            .flat_map(|(group, _)| *group)
            .copied()
            .collect();
        grouped.sort_unstable();
        assert!(grouped.into_iter().eq(0..discs.len() as u32));
        // Every disc is counted once, in a box or individually.
        let sums = tree.sums(|number| [1.0, discs[number].1]);
        let (mut small, mut alone) = ([0.0; 2], [0.0; 2]);
        tree.seen_from(
            (at, 0.05),
            0.7,
            |place| small = [0, 1].map(|k| small[k] + sums[place][k]),
            |number| alone = [alone[0] + 1.0, alone[1] + discs[number].1],
        );
        let radii: f64 = discs.iter().map(|disc| disc.1).sum();
        assert!((small[0] + alone[0] - discs.len() as f64).abs() < 1e-9);
        assert!((small[1] + alone[1] - radii).abs() <= 1e-12 * radii);
        let spacing = (0..discs.len())
            .filter_map(|k| nearest(discs[k].0, Nearest::Centre, 0.0, Some(k)))
            .map(|(_, distance)| distance)
            .reduce(f64::max);
        assert_eq!(tree.spacing(), spacing);
    }

    /// Random positions, distant clusters, positions on one line, and coincident positions.
    fn discs() -> impl Strategy<Value = Vec<Disc>> {
        let disc = (0..4_u8, -1.0..1.0_f64, -1.0..1.0_f64, 0.001..0.2_f64);
        (0..5_u8, prop::collection::vec(disc, 0..120)).prop_map(|(kind, discs)| {
            let place = |(cluster, x, y, radius): (u8, f64, f64, f64)| {
                let centre = match kind {
                    0 | 1 => [x, y],
                    2 => [
                        1e6 * f64::from(cluster) + x,
                        y - 1e6 * f64::from(cluster / 2),
                    ],
                    3 => [x, 0.5],
                    _ => [0.3, 0.3],
                };
                (centre, if kind == 1 { 0.01 * radius } else { radius })
            };
            discs.into_iter().map(place).collect()
        })
    }

    proptest! {
        #[test]
        fn searches_find_what_looking_at_all_finds(
            discs in discs(), x in -1.2..1.2_f64, y in -1.2..1.2_f64, reach in 0.0..1.0_f64
        ) {
            check(&discs, [x, y], reach);
            check(&discs, discs.first().map_or([x, y], |disc| disc.0), 0.1 * reach);
        }
    }
}
