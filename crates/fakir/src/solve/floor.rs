//! The smallest gap between the lens and the floor.
//!
//! If the pressure is linear in the indentation, `c = zeta c1 + c0`, the floor gap `Delta(x) = h + f(x) + w(x) - zeta` vanishes at `x` for
//! `zeta(x) = (h + f + w0)/(1 - w1)`. The smallest of these values over the floor is the critical indentation of the linearized contact.
//! With `c1 = 0` the same function is the gap plus `zeta`.

use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::disc::basis::{UNIT_FORCE, mode_count};
use crate::halfspace::disc::exterior::{Exterior, LaneJets, MAXIMUM_DEGREE};
use crate::halfspace::jet::FieldJet;
use crate::numerics::neighbours::Neighbours;
use crate::numerics::vector::{LANES, Lanes, widest};
use crate::numerics::workers::CancelToken;
use crate::problem::lens::LensJet;
use crate::problem::{HexagonalLattice, Point, ShapedLens};
use crate::state::Run;
use std::borrow::Cow;
use std::f64::consts::PI;
use std::ops::Range;

/// Largest number of Newton steps from one starting point.
const STEP_LIMIT: usize = 60;

/// Step, in pillar radii, at which the search ends: the error of the value is of the order of its square.
const STEP_TOLERANCE: f64 = 1e-9;

/// Predicted relative decrease of the value at which the search ends: the step is taken and the decrease is applied without another
/// evaluation.
const LAST_DESCENT: f64 = 1e-12;

/// Number of starting points taken from a scan, in addition to the holes, and their smallest distance, in pitches.
const SCANNED: usize = 8;
const SEPARATION: f64 = 0.12;

/// Pitch (pillar radii) above which the lowest point may be anywhere around a pillar; in denser patterns it is in a hole.
const WIDE_PITCH: f64 = 8.0;

/// Number of holes that are searched in dense patterns: those with the lowest gap at their centre, which hardly differs from that at the
/// lowest point. Equivalent holes count once.
const LOWEST_HOLES: usize = 6;

/// Number of lowest points from which the next search starts.
const REMEMBERED: usize = 3;

/// Relative difference of contact indentations up to which a low point may become the lowest as the pressures change: upper bound, and
/// factor on the last relative change of the lowest value. Images are always kept. (A point beyond this limit that becomes the lowest is
/// found by the final search from scratch.)
const MOST_RIVALS: f64 = 1e-2;
const RIVALS: f64 = 10.0;

/// Relative difference of contact indentations up to which two holes are equivalent, as copies of each other under a symmetry of the
/// lattice.
const ALIKE: f64 = 1e-9;

/// Largest relative difference of the contact indentations of images.
const UNLIKE: f64 = 1e-4;

/// Discs with their loads, in groups of [`LANES`]; the last group is padded with unloaded discs.
pub(crate) struct Discs {
    count: usize,
    /// Number of coefficients of each disc.
    modes: usize,
    centres: Vec<[Lanes; 2]>,
    /// Radii of the discs, or the single radius of all.
    radii: Vec<Lanes>,
    differ: bool,
    /// Radii of the discs, or the single radius of all.
    coefficients: [Vec<Lanes>; 2],
}

/// A coefficient of a disc, as a function of the disc index and the mode index.
type Coefficient<'c> = &'c dyn Fn(usize, usize) -> f64;

/// Loaded discs, from which the displacement of the floor is computed.
pub(crate) struct LoadedDiscs<'a> {
    pub(crate) exterior: &'a Exterior,
    pub(crate) discs: Discs,
    pub(crate) run: &'a Run<'a>,
}

/// A point of the floor with its contact indentation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FloorPoint {
    pub(crate) position: Point,
    /// Indentation at which the floor would be touched there, or gap plus indentation.
    pub(crate) indentation: f64,
}

/// The pillars around the floor.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Surroundings<'a> {
    /// A lattice of pillars of unit radius.
    Lattice(&'a HexagonalLattice),
    /// Sites of which those within `reach` of the lens axis are touched, or none.
    Sites {
        sites: &'a Sites,
        spacing: f64,
        reach: f64,
    },
}

/// Candidate starting points of a search.
#[derive(Debug, Clone)]
struct Starts {
    /// Centres between pillars, and whether the search starts from all of them.
    holes: Vec<Point>,
    every_hole: bool,
    /// Other points, of which the search uses the lowest, and their smallest distance.
    others: Vec<Point>,
    separation: f64,
}

/// Number of pillars of arbitrary sites around which the floor is scanned if they are far apart.
const SURROUNDED: usize = 8;

/// Distance beyond the touched pillars up to which the floor of arbitrary sites is searched, in units of the spacing, and distances of the
/// starting points beside the outermost pillars.
const BEYOND: f64 = 1.5;
const BESIDE: [f64; 2] = [0.6, 1.2];

impl<'a> Surroundings<'a> {
    pub(crate) fn of_sites(sites: &'a Sites, spacing: f64, reach: f64) -> Self {
        sites.hexagonal_lattice().map_or(
            Self::Sites {
                sites,
                spacing,
                reach,
            },
            Self::Lattice,
        )
    }

    /// Distance from the edge of the nearest pillar; negative inside it.
    pub(crate) fn clearance(&self, position: Point) -> f64 {
        match self {
            Self::Lattice(lattice) => {
                let (i, j) = lattice.nearest_pillar(position);
                distance(lattice.centre(i, j), position) - 1.0
            }
            Self::Sites { sites, .. } => sites.clearance(position),
        }
    }

    /// Images of the lowest points under the symmetries of a wide lattice. Partially touched pillars, of which there are few there, limit
    /// the symmetry of a solution to that of their nodes, so that the values at images differ by discretisation errors.
    fn images_of_lowest(&self, minima: &[FloorPoint]) -> Vec<Point> {
        let Self::Lattice(lattice) = self else {
            return Vec::new();
        };
        if lattice.pitch <= WIDE_PITCH {
            return Vec::new();
        }
        let lowest = minima.iter().map(|point| point.indentation);
        let lowest = lowest.fold(f64::INFINITY, f64::min);
        let near = |point: &&FloorPoint| point.indentation - lowest <= UNLIKE * lowest.abs();
        let symmetry = lattice.symmetry();
        let points = minima.iter().filter(near).map(|point| point.position);
        points
            .flat_map(|point| symmetry.images(point).skip(1).collect::<Vec<_>>())
            .collect()
    }

    fn starts(&self) -> Starts {
        match self {
            Self::Lattice(lattice) => starts_on_lattice(lattice),
            Self::Sites {
                sites,
                spacing,
                reach,
            } => starts_among(sites, *spacing, *reach),
        }
    }
}

fn starts_on_lattice(lattice: &HexagonalLattice) -> Starts {
    let pitch = lattice.pitch;
    let (i0, j0) = lattice.nearest_pillar([0.0, 0.0]);
    let mut pillars: Vec<Point> = (-2..=2)
        .flat_map(|i| (-2..=2).map(move |j| (i0 + i, j0 + j)))
        .map(|(i, j)| lattice.centre(i, j))
        .collect();
    pillars.sort_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])));
    let near = |[x, y]: &Point| x.hypot(*y) < 1.6 * pitch;
    let middles = pillars
        .iter()
        .flat_map(|centre| lattice.middles_beside(*centre));
    let holes: Vec<Point> = middles.filter(near).collect();
    let others = others(pitch, pillars[..3].iter().map(|centre| (*centre, 1.0)));
    Starts {
        holes: one_of_alike(lattice, &holes),
        every_hole: pitch > WIDE_PITCH,
        others: one_of_alike(lattice, &others),
        separation: SEPARATION * pitch,
    }
}

/// One representative of each set of equivalent points under the symmetries of the lattice.
fn one_of_alike(lattice: &HexagonalLattice, points: &[Point]) -> Vec<Point> {
    let rounding = 1e-9 * lattice.pitch;
    let symmetry = lattice.symmetry();
    let mut folded: Vec<Point> = points.iter().map(|point| symmetry.fold(*point)).collect();
    // Points that agree up to rounding are adjacent when sorted by distance.
    let away = |[x, y]: &Point| x.hypot(*y);
    folded.sort_by(|a, b| away(a).total_cmp(&away(b)));
    let mut kept: Vec<Point> = Vec::with_capacity(folded.len());
    for point in folded {
        let nearest = away(&point) - rounding;
        let mut as_far = kept.iter().rev().take_while(|other| away(other) > nearest);
        if !as_far.any(|other| distance(*other, point) <= rounding) {
            kept.push(point);
        }
    }
    kept
}

/// Points other than holes at which the floor may be lowest: the lens axis, and in wide patterns rings around the given pillars (centre and
/// radius).
fn others(pitch: f64, pillars: impl Iterator<Item = (Point, f64)>) -> Vec<Point> {
    let mut others = vec![[0.0, 0.0]];
    if pitch > WIDE_PITCH {
        for ([x, y], size) in pillars {
            let [least, most] = [1.1 * size, pitch - 1.5 * size];
            for ring in 0..12 {
                let radius = least * (most / least).powf(f64::from(ring) / 11.0);
                for step in 0..12 {
                    let angle = PI / 6.0 * f64::from(step);
                    others.push([x + radius * angle.cos(), y + radius * angle.sin()]);
                }
            }
        }
    }
    others
}

/// Circumcentres of neighbouring pillars, and points beside the outermost pillars, where the floor may be lower than between them.
fn starts_among(sites: &Sites, spacing: f64, reach: f64) -> Starts {
    let centres = sites.centres();
    let corners: Vec<delaunator::Point> = centres
        .iter()
        .map(|[x, y]| delaunator::Point { x: *x, y: *y })
        .collect();
    let triangulation = delaunator::triangulate(&corners);
    let corner = |number: usize| centres[triangulation.triangles[number]];
    let mut holes: Vec<Point> = (0..triangulation.triangles.len())
        .step_by(3)
        .map(|first| circumcentre([0, 1, 2].map(|k| corner(first + k))))
        .collect();
    // Collinear pillars have no triangulation: all of them are outermost, and the floor between two of them may be the lowest.
    let outermost: Vec<Point> = if triangulation.triangles.is_empty() {
        let mut row = centres.to_vec();
        row.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        let pairs = row.windows(2);
        holes.extend(pairs.map(|pair| [0, 1].map(|k| 0.5 * (pair[0][k] + pair[1][k]))));
        row
    } else {
        triangulation.hull.iter().map(|&k| centres[k]).collect()
    };
    for [x, y] in outermost {
        for step in 0..12 {
            let (sin, cos) = (PI / 6.0 * f64::from(step)).sin_cos();
            holes.extend(BESIDE.map(|part| {
                let away = part * spacing;
                [x + away * cos, y + away * sin]
            }));
        }
    }
    let farthest = reach + BEYOND * spacing;
    // The circumcentre of collinear pillars may be NaN.
    holes.retain(|[x, y]| x.hypot(*y) <= farthest);
    let mut pillars: Vec<(Point, f64)> = centres
        .iter()
        .enumerate()
        .map(|(pillar, centre)| (*centre, sites.body(pillar).radius))
        .collect();
    let away = |(centre, _): &(Point, f64)| centre[0].hypot(centre[1]);
    pillars.sort_by(|a, b| away(a).total_cmp(&away(b)));
    pillars.truncate(SURROUNDED);
    Starts {
        holes,
        every_hole: false,
        others: others(spacing, pillars.into_iter()),
        separation: SEPARATION * spacing,
    }
}

fn circumcentre([[x, y], b, c]: [Point; 3]) -> Point {
    let [[bx, by], [cx, cy]] = [b, c].map(|[u, v]| [u - x, v - y]);
    let twice_area = 2.0 * (bx * cy - by * cx);
    let [bb, cc] = [bx * bx + by * by, cx * cx + cy * cy];
    [
        x + (cy * bb - by * cc) / twice_area,
        y + (bx * cc - cx * bb) / twice_area,
    ]
}

/// The floor beside the pillars, and the lens above it.
#[derive(Debug, Clone)]
pub(crate) struct Uncovered<'a> {
    pub(crate) lens: ShapedLens,
    /// Depth of the floor.
    pub(crate) height: f64,
    pub(crate) around: Surroundings<'a>,
}

/// Displacement of the floor by the pressures.
pub(crate) trait FloorDisplacement {
    /// `w1` and `w0` at a point outside the pillars, with derivatives.
    fn displacement(&self, position: Point) -> [FieldJet; 2];

    /// The same without derivatives, which may be faster.
    fn value(&self, position: Point) -> [f64; 2] {
        self.displacement(position).map(|jet| jet.value)
    }

    /// Both at many points to about two digits, if that is much faster.
    fn rough_displacements(&self, _: &[Point]) -> Option<Vec<[f64; 2]>> {
        None
    }
}

impl Discs {
    /// One disc around the lens axis, whose pressure does not depend on the indentation.
    pub(crate) fn around_axis(radius: f64, coefficients: &[f64]) -> Self {
        let load_of = |_: usize, mode: usize| coefficients[mode];
        Self::new(
            [1, coefficients.len()],
            |_| [0.0; 2],
            |_| radius,
            [None, Some(&load_of)],
        )
    }

    /// `count` discs; the coefficients of both sets are `None` if all are zero.
    pub(crate) fn new(
        [count, modes]: [usize; 2],
        centre: impl Fn(usize) -> Point,
        radius: impl Fn(usize) -> f64,
        coefficients: [Option<Coefficient<'_>>; 2],
    ) -> Self {
        let lanes = |first: usize, of_disc: &dyn Fn(usize) -> f64| {
            Lanes(std::array::from_fn(|lane| of_disc(first + lane)))
        };
        let firsts = || (0..count).step_by(LANES);
        // Padding repeats the last disc.
        let last = count.saturating_sub(1);
        let centres = firsts()
            .map(|first| [0, 1].map(|along| lanes(first, &|disc| centre(disc.min(last))[along])));
        let is_other = |disc: usize| radius(disc).to_bits() != radius(0).to_bits();
        let differ = (0..count).any(is_other);
        let radii = firsts()
            .take(if differ { count } else { 1 })
            .map(|first| lanes(first, &|disc| radius(disc.min(last))));
        let coefficients = coefficients.map(|set| {
            set.map_or_else(Vec::new, |of_disc| {
                let load_of = |disc: usize, mode: usize| {
                    if disc < count {
                        of_disc(disc, mode)
                    } else {
                        0.0
                    }
                };
                let modes = |first: usize| {
                    (0..modes).map(move |mode| lanes(first, &|disc| load_of(disc, mode)))
                };
                firsts().flat_map(modes).collect()
            })
        });
        Self {
            count,
            modes,
            centres: centres.collect(),
            radii: radii.collect(),
            differ,
            coefficients,
        }
    }

    fn centre_of(&self, disc: usize) -> Point {
        self.centres[disc / LANES].map(|along| along.0[disc % LANES])
    }

    fn radius_of(&self, disc: usize) -> f64 {
        self.radius_at(disc / LANES).0[disc % LANES]
    }

    /// The radius of all discs, if equal.
    fn common_radius(&self) -> Option<f64> {
        (!self.differ && self.count > 0).then(|| self.radius_of(0))
    }

    fn coefficient_of(&self, set: usize, disc: usize, mode: usize) -> f64 {
        let lanes = self.coefficients[set].get(disc / LANES * self.modes + mode);
        lanes.map_or(0.0, |lanes| lanes.0[disc % LANES])
    }

    /// Radii of a group of discs.
    #[inline(always)]
    fn radius_at(&self, place: usize) -> Lanes {
        self.radii.get(place).copied().unwrap_or(self.radii[0])
    }

    /// Vectors from the centres of a group to a point, times a scale.
    #[inline(always)]
    fn offsets(&self, place: usize, scale: Lanes, [x, y]: Point) -> [Lanes; 2] {
        let [u, v] = self.centres[place];
        [(Lanes::splat(x) - u) * scale, (Lanes::splat(y) - v) * scale]
    }

    /// Coefficients of a group, of both sets.
    #[inline(always)]
    fn coefficients_at(&self, place: usize) -> [&[Lanes]; 2] {
        let modes = place * self.modes..(place + 1) * self.modes;
        self.coefficients
            .each_ref()
            .map(|set| set.get(modes.clone()).unwrap_or_default())
    }
}

impl LoadedDiscs<'_> {
    /// Sum of the fields of several groups of discs; with a common radius, in units of that radius.
    #[inline(always)]
    fn sums(&self, places: Range<usize>, position: Point) -> [LaneJets; 2] {
        let mut sums = [LaneJets::default(); 2];
        let exterior = self.exterior;
        let differ = self.discs.differ;
        for place in places {
            let radius = self.discs.radius_at(place);
            let scale = radius.map(f64::recip);
            let offsets = self.discs.offsets(place, scale, position);
            let coefficients = self.discs.coefficients_at(place);
            if differ {
                let mut own = [LaneJets::default(); 2];
                exterior.add_jets(offsets, radius, coefficients, &mut own);
                for (sum, own) in sums.iter_mut().zip(&own) {
                    sum.add_scaled(radius, scale, own);
                }
            } else {
                exterior.add_jets(offsets, radius, coefficients, &mut sums);
            }
        }
        sums
    }

    /// The same without derivatives, for at most `M` modes.
    #[inline(always)]
    fn values<const M: usize>(&self, places: Range<usize>, position: Point) -> [Lanes; 2] {
        let mut sums = [Lanes::default(); 2];
        let mut workspace = [Lanes::default(); M];
        let of_modes = &mut workspace[..self.discs.modes];
        let differ = self.discs.differ;
        for place in places {
            let radius = self.discs.radius_at(place);
            let offsets = self.discs.offsets(place, radius.map(f64::recip), position);
            self.exterior.lane_values(offsets, radius, of_modes);
            for (sum, coefficients) in sums.iter_mut().zip(self.discs.coefficients_at(place)) {
                let mut own = Lanes::default();
                for (coefficient, value) in coefficients.iter().zip(&*of_modes) {
                    own += *coefficient * *value;
                }
                *sum += if differ { radius * own } else { own };
            }
        }
        sums
    }

    /// Sums over all discs, block by block.
    fn by_blocks<S: Send>(&self, of_block: impl Fn(Range<usize>) -> S + Sync) -> Vec<S> {
        let count = self.discs.centres.len();
        let block = |(): &mut (), number: usize| {
            let first = number * BLOCK;
            of_block(first..count.min(first + BLOCK))
        };
        let workers = self.run.workers();
        workers.map(count.div_ceil(BLOCK), BLOCKS, || (), block)
    }
}

/// Buffers for all modes are slower than a sum over a few discs with this many.
const FEW_MODES: usize = mode_count(4);

/// Number of groups of [`LANES`] discs that are summed in one block.
const BLOCK: usize = 256;

/// Smallest number of blocks per thread.
const BLOCKS: usize = 4;

impl FloorDisplacement for LoadedDiscs<'_> {
    fn displacement(&self, position: Point) -> [FieldJet; 2] {
        let blocks = self.by_blocks(|discs| {
            widest(
                #[inline(always)]
                || self.sums(discs.clone(), position),
            )
            .map(|sums| sums.sum())
        });
        let mut total = [FieldJet::default(); 2];
        for block in blocks {
            for (sum, part) in total.iter_mut().zip(block) {
                sum.add_scaled(1.0, &part);
            }
        }
        if let Some(radius) = self.discs.common_radius() {
            for sum in &mut total {
                sum.value *= radius;
                sum.hessian = sum.hessian.map(|h| h / radius);
            }
        }
        total
    }

    fn value(&self, position: Point) -> [f64; 2] {
        let blocks = self.by_blocks(|discs| {
            widest(
                #[inline(always)]
                || {
                    if self.discs.modes <= FEW_MODES {
                        self.values::<FEW_MODES>(discs.clone(), position)
                    } else {
                        self.values::<{ mode_count(MAXIMUM_DEGREE) }>(discs.clone(), position)
                    }
                },
            )
            .map(Lanes::sum)
        });
        let scale = self.discs.common_radius().unwrap_or(1.0);
        [0, 1].map(|set| scale * blocks.iter().map(|block| block[set]).sum::<f64>())
    }

    /// Neighbouring points share the contribution of distant discs: there, discs close to each other are combined into one point force at
    /// their centroid, and their field is expanded around the centre of the points to second order.
    fn rough_displacements(&self, points: &[Point]) -> Option<Vec<[f64; 2]>> {
        let discs = &self.discs;
        if points.len() * discs.count < MANY {
            return None;
        }
        let all = 0..discs.count;
        let tree = Neighbours::new(all.map(|disc| (discs.centre_of(disc), discs.radius_of(disc))));
        let of_disc = |disc: usize| {
            let [x, y] = discs.centre_of(disc);
            let square = UNIT_FORCE * discs.radius_of(disc).powi(2);
            let [unit, rest] = [0, 1].map(|set| square * discs.coefficient_of(set, disc, 0));
            [unit, rest, 1.0, x, y]
        };
        let forces: Vec<_> = (0..discs.count).map(of_disc).collect();
        let sums = tree.sums(|disc| forces[disc]);
        let beside = |disc: usize, [x, y]: Point, values: &mut Vec<f64>| {
            let (centre, radius) = (discs.centre_of(disc), discs.radius_of(disc));
            let offset = [(x - centre[0]) / radius, (y - centre[1]) / radius];
            let square = offset[0] * offset[0] + offset[1] * offset[1];
            // There is no floor on a pillar.
            if square <= 1.0 {
                return [0.0; 2];
            }
            if square > BESIDE_DISC * BESIDE_DISC {
                let of_force = self.exterior.of_force(offset.map(|along| along * radius));
                let [unit, rest, ..] = forces[disc];
                return [unit, rest].map(|force| force * of_force.value);
            }
            self.exterior.values(offset, radius, values);
            [0, 1].map(|set| {
                let of_modes = values.iter().enumerate();
                let sum =
                    of_modes.map(|(mode, value)| value * discs.coefficient_of(set, disc, mode));
                radius * sum.sum::<f64>()
            })
        };
        let holes = Neighbours::new(points.iter().map(|point| (*point, 0.0)));
        let groups = holes.groups(TOGETHER);
        let add = |forces: [f64; 2], offset: Point, sums: &mut [FieldJet; 2]| {
            let of_force = self.exterior.of_force(offset);
            for (sum, force) in sums.iter_mut().zip(forces) {
                sum.add_scaled(force, &of_force);
            }
        };
        let work = || (vec![0.0; discs.modes], Vec::new());
        let of_group = |(values, near): &mut (Vec<f64>, Vec<usize>), number: usize| {
            let (group, sides) = groups[number];
            let places = || group.iter().map(|place| points[*place as usize]);
            let first = places().fold([f64::INFINITY; 2], |low, at| {
                [0, 1].map(|k| f64::min(low[k], at[k]))
            });
            let middle = [0, 1].map(|k| first[k] + 0.5 * sides[k]);
            let extent = 0.5 * sides[0].hypot(sides[1]);
            let (mut boxes, mut single) = ([FieldJet::default(); 2], [FieldJet::default(); 2]);
            near.clear();
            let small = |place: usize| {
                let [unit, rest, count, u, v] = sums[place];
                let offset = [middle[0] - u / count, middle[1] - v / count];
                add([unit, rest], offset, &mut boxes);
            };
            let alone = |disc: usize| {
                let offset = [0, 1].map(|k| middle[k] - discs.centre_of(disc)[k]);
                let far = f64::max(extent / FAR_FROM_ALL, BESIDE_DISC * discs.radius_of(disc));
                if offset[0].hypot(offset[1]) > far {
                    let [unit, rest, ..] = forces[disc];
                    add([unit, rest], offset, &mut single);
                } else {
                    near.push(disc);
                }
            };
            tree.seen_from((middle, extent), SMALLNESS, small, alone);
            let of_point = |at: Point| {
                let step = [0, 1].map(|k| at[k] - middle[k]);
                let mut sum =
                    [0, 1].map(|set| boxes[set].expanded(step) + single[set].expanded(step));
                for disc in &*near {
                    let own = beside(*disc, at, values);
                    sum = [0, 1].map(|set| sum[set] + own[set]);
                }
                sum
            };
            places().map(of_point).collect::<Vec<_>>()
        };
        let workers = self.run.workers();
        let found = workers.map(groups.len(), ROUGH, work, of_group);
        let mut displacements = vec![[0.0; 2]; points.len()];
        for ((group, _), found) in groups.iter().zip(found) {
            for (place, found) in group.iter().zip(found) {
                displacements[*place as usize] = found;
            }
        }
        Some(displacements)
    }
}

/// Number of points times discs above which the fields are first summed approximately.
const MANY: usize = 300_000;

/// Ratio of size to distance up to which discs are combined.
const SMALLNESS: f64 = 0.5;

/// Largest number of points that share distant contributions, and largest ratio of the size of that group to the distance of a disc.
const TOGETHER: usize = 16;
const FAR_FROM_ALL: f64 = 0.3;

/// Distance, in radii, beyond which a single disc acts as a point force at its centre: the field is too small by 1/200 there.
const BESIDE_DISC: f64 = 6.0;

/// Smallest number of groups of points per thread.
const ROUGH: usize = 16;

/// Displacement of the floor per unit indentation above which approximate displacements are insufficient: the contact indentation depends
/// on the small remainder to 1.
const DEEP: f64 = 0.8;

/// Number of points with the lowest approximate values that are evaluated accurately.
const PROMISING: usize = 100;

/// Number of points of a ring that stand for it.
const OF_RING: usize = 3;

/// Search for the lowest points of the floor near the lens axis; keeps them as starts of the next search.
#[derive(Debug, Clone, Default)]
pub(crate) struct FloorSearch {
    /// Lowest points of the previous search, sorted by value.
    found: Vec<FloorPoint>,
    /// Candidate starting points on a lattice, once computed.
    on_lattice: Option<Starts>,
}

impl FloorSearch {
    /// Makes the next search start from scratch.
    pub(crate) fn forget(&mut self) {
        self.found.clear();
    }

    /// The same if a search from scratch takes hardly longer than one from the previous points: in dense patterns.
    pub(crate) fn forget_if_quick(&mut self) {
        if (self.on_lattice.as_ref()).is_some_and(|starts| !starts.every_hole) {
            self.forget();
        }
    }

    /// Starting points of a search from scratch; on a lattice the candidates are always the same.
    fn first_starts(
        &mut self,
        floor: &Uncovered<'_>,
        loaded: &impl FloorDisplacement,
        cancel: &CancelToken,
    ) -> Vec<Point> {
        let starts = (self.on_lattice.take()).unwrap_or_else(|| floor.around.starts());
        let lowest = lowest_starts(&starts, floor, loaded, cancel);
        if let Surroundings::Lattice(_) = floor.around {
            self.on_lattice = Some(starts);
        }
        lowest
    }

    /// The lowest point of `zeta(x)`. `None` if the floor cannot be reached anywhere (`w1 < 1` nowhere), if the indenter is a cylinder or a
    /// plate, which come closest to the floor far from all pillars, or if the run is cancelled.
    ///
    /// The first call searches everywhere near the lens axis; the following calls start from the lowest points found before, one for each
    /// set of equivalent points.
    pub(crate) fn lowest(
        &mut self,
        floor: &Uncovered<'_>,
        loaded: &impl FloorDisplacement,
        cancel: &CancelToken,
    ) -> Option<FloorPoint> {
        if floor.lens.is_flat() || !floor.lens.is_axisymmetric() {
            return None;
        }
        let before = self.found.first().map(|point| point.indentation);
        let starts = match before {
            Some(_) => self.found.iter().map(|point| point.position).collect(),
            None => self.first_starts(floor, loaded, cancel),
        };
        let mut minima = Vec::with_capacity(starts.len());
        add_minima(floor, loaded, &starts, &mut minima, cancel);
        if before.is_none() {
            let images = floor.around.images_of_lowest(&minima);
            add_minima(floor, loaded, &images, &mut minima, cancel);
        }
        minima.sort_by(|a, b| a.indentation.total_cmp(&b.indentation));
        minima.dedup_by(|b, a| b.indentation - a.indentation <= ALIKE * a.indentation.abs());
        let lowest = minima.first().copied();
        if let Some(FloorPoint { indentation, .. }) = lowest {
            let change = before.map_or(1.0, |before| (indentation / before - 1.0).abs());
            let rivals = (RIVALS * change).clamp(UNLIKE, MOST_RIVALS);
            let highest = indentation + rivals * indentation.abs();
            minima.retain(|point| point.indentation <= highest);
        }
        minima.truncate(REMEMBERED);
        self.found = minima;
        lowest
    }
}

/// Adds the local minima reached from the starts, each once.
fn add_minima(
    floor: &Uncovered<'_>,
    loaded: &impl FloorDisplacement,
    starts: &[Point],
    minima: &mut Vec<FloorPoint>,
    cancel: &CancelToken,
) {
    for start in starts {
        let Some(minimum) = descend(floor, loaded, *start, cancel) else {
            continue;
        };
        let same = |other: &FloorPoint| distance(other.position, minimum.position) < 1e-3;
        if !minima.iter().any(same) {
            minima.push(minimum);
        }
    }
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// `zeta(x)` with derivatives; `None` on pillars, where the floor recedes from the lens, and where a value is not finite.
fn indentation_of_contact(
    floor: &Uncovered<'_>,
    loaded: &impl FloorDisplacement,
    position: Point,
) -> Option<FieldJet> {
    if floor.around.clearance(position) <= 0.0 {
        return None;
    }
    let [unit, rest] = loaded.displacement(position);
    let sag = sag_jet(&floor.lens, position)?;
    let denominator = 1.0 - unit.value;
    if denominator <= 0.0 {
        return None;
    }
    let mut numerator = rest;
    numerator.value += floor.height;
    numerator.add_scaled(1.0, &sag);
    let value = numerator.value / denominator;
    // zeta (1 - w1) = N: derivatives by the product rule.
    let gradient = [0, 1].map(|k| (numerator.gradient[k] + value * unit.gradient[k]) / denominator);
    let cross = [
        2.0 * gradient[0] * unit.gradient[0],
        gradient[0] * unit.gradient[1] + gradient[1] * unit.gradient[0],
        2.0 * gradient[1] * unit.gradient[1],
    ];
    let hessian = [0, 1, 2]
        .map(|k| (numerator.hessian[k] + value * unit.hessian[k] + cross[k]) / denominator);
    // A sum is finite only if all of its terms are.
    let sum = value + gradient.iter().sum::<f64>() + hessian.iter().sum::<f64>();
    sum.is_finite().then_some(FieldJet {
        value,
        gradient,
        hessian,
    })
}

/// `zeta(x)` alone; `None` where [`indentation_of_contact`] is, or where it is NaN.
fn value_of_contact(
    floor: &Uncovered<'_>,
    loaded: &impl FloorDisplacement,
    position: Point,
) -> Option<f64> {
    if floor.around.clearance(position) <= 0.0 {
        return None;
    }
    let sag = sag_jet(&floor.lens, position)?.value;
    touched_at(floor, sag, loaded.value(position)).filter(|value| value.is_finite())
}

/// `(h + f + w0)/(1 - w1)` for a given height of the lens; `None` where the floor recedes from it.
fn touched_at(floor: &Uncovered<'_>, sag: f64, [unit, rest]: [f64; 2]) -> Option<f64> {
    (unit < 1.0).then(|| (floor.height + sag + rest) / (1.0 - unit))
}

fn sag_jet(lens: &ShapedLens, position: Point) -> Option<FieldJet> {
    let LensJet {
        value,
        gradient,
        hessian,
    } = lens.jet(position)?;
    Some(FieldJet {
        value,
        gradient,
        hessian,
    })
}

/// Newton's method with a positive definite modification of the Hessian; steps that do not descend are halved.
fn descend(
    floor: &Uncovered<'_>,
    loaded: &impl FloorDisplacement,
    start: Point,
    cancel: &CancelToken,
) -> Option<FloorPoint> {
    let mut position = start;
    let mut jet = indentation_of_contact(floor, loaded, position)?;
    for _ in 0..STEP_LIMIT {
        if cancel.is_cancelled() {
            return None;
        }
        let step = newton_step(&jet);
        let length = step[0].hypot(step[1]);
        // At most half-way to the nearest edge, beyond which there is a pillar.
        let longest = 0.5 * floor.around.clearance(position).max(1e-12);
        let descent = -0.5 * (step[0] * jet.gradient[0] + step[1] * jet.gradient[1]);
        if length <= longest && descent <= LAST_DESCENT * jet.value.abs() {
            position = [position[0] + step[0], position[1] + step[1]];
            jet.value -= descent;
            break;
        }
        let mut factor = if length > longest {
            longest / length
        } else {
            1.0
        };
        let mut moved = None;
        while factor * length > 0.1 * STEP_TOLERANCE {
            let trial = [
                position[0] + factor * step[0],
                position[1] + factor * step[1],
            ];
            if let Some(next) = indentation_of_contact(floor, loaded, trial)
                && next.value <= jet.value
            {
                moved = Some((trial, next));
                break;
            }
            factor *= 0.5;
        }
        let Some((trial, next)) = moved else { break };
        (position, jet) = (trial, next);
        if factor * length < STEP_TOLERANCE {
            break;
        }
    }
    Some(FloorPoint {
        position,
        indentation: jet.value,
    })
}

/// `- |H|^-1 g`, with `|H|` the Hessian with the absolute values of its eigenvalues.
fn newton_step(jet: &FieldJet) -> [f64; 2] {
    let [a, b, c] = jet.hessian;
    let [gx, gy] = jet.gradient;
    let mean = 0.5 * (a + c);
    let spread = (0.5 * (a - c)).hypot(b);
    let angle = 0.5 * (2.0 * b).atan2(a - c);
    let (sin, cos) = angle.sin_cos();
    let floor = 1e-6 * (mean.abs() + spread) + f64::MIN_POSITIVE;
    let along = (gx * cos + gy * sin) / (mean + spread).abs().max(floor);
    let across = (gy * cos - gx * sin) / (mean - spread).abs().max(floor);
    [-(along * cos - across * sin), -(along * sin + across * cos)]
}

/// Holes and other candidates with the lowest values.
fn lowest_starts(
    from: &Starts,
    floor: &Uncovered<'_>,
    loaded: &impl FloorDisplacement,
    cancel: &CancelToken,
) -> Vec<Point> {
    let mut starts = if from.every_hole {
        from.holes.clone()
    } else {
        let mut holes = rated(floor, loaded, &from.holes, cancel);
        holes.dedup_by(|b, a| b.indentation - a.indentation <= ALIKE * a.indentation.abs());
        holes.truncate(LOWEST_HOLES);
        holes.into_iter().map(|hole| hole.position).collect()
    };
    let mut added: Vec<Point> = Vec::new();
    for FloorPoint { position, .. } in rated(floor, loaded, &from.others, cancel) {
        if added.len() == SCANNED {
            break;
        }
        let is_apart = |other: &Point| distance(*other, position) > from.separation;
        if added.iter().all(is_apart) {
            added.push(position);
        }
    }
    starts.extend(added);
    starts
}

/// The points at which the floor can be touched, sorted by value.
fn rated(
    floor: &Uncovered<'_>,
    loaded: &impl FloorDisplacement,
    points: &[Point],
    cancel: &CancelToken,
) -> Vec<FloorPoint> {
    let mut rated: Vec<FloorPoint> = promising(floor, loaded, points)
        .iter()
        .take_while(|_| !cancel.is_cancelled())
        .filter_map(|&position| {
            let indentation = value_of_contact(floor, loaded, position)?;
            Some(FloorPoint {
                position,
                indentation,
            })
        })
        .collect();
    rated.sort_by(|a, b| a.indentation.total_cmp(&b.indentation));
    rated
}

/// The points with the lowest approximate values; all points if an accurate evaluation is as fast or if the approximation is insufficient.
fn promising<'p>(
    floor: &Uncovered<'_>,
    loaded: &impl FloorDisplacement,
    points: &'p [Point],
) -> Cow<'p, [Point]> {
    // On a hexagonal lattice there are few points.
    let Surroundings::Sites { sites, spacing, .. } = floor.around else {
        return Cow::Borrowed(points);
    };
    if points.len() * sites.len() >= MANY && sites.are_regular() {
        return Cow::Owned(lowest_along_radius(floor, loaded, points, 0.5 * spacing));
    }
    let rough = loaded.rough_displacements(points);
    let deep = |[unit, _]: &[f64; 2]| *unit > DEEP;
    let rough = rough.filter(|rough| !rough.iter().any(deep));
    rough.map_or(Cow::Borrowed(points), |rough| {
        Cow::Owned(lowest_roughly(floor, points, &rough))
    })
}

/// The points in the rings around the lens axis, of this width, with the lowest values at a few of their points. Between equal pillars of a
/// lattice under an axisymmetric lens, values depend almost on the distance from the axis alone.
fn lowest_along_radius(
    floor: &Uncovered<'_>,
    loaded: &impl FloorDisplacement,
    points: &[Point],
    width: f64,
) -> Vec<Point> {
    let ring = |[x, y]: &Point| (x.hypot(*y) / width) as usize;
    let mut sorted = points.to_vec();
    sorted.sort_by_cached_key(ring);
    let mut rings: Vec<(f64, &[Point])> = sorted
        .chunk_by(|one, other| ring(one) == ring(other))
        .map(|points| {
            let sampled = points.iter().step_by(points.len().div_ceil(OF_RING));
            let values = sampled.filter_map(|point| value_of_contact(floor, loaded, *point));
            (values.fold(f64::INFINITY, f64::min), points)
        })
        .collect();
    rings.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut lowest = Vec::new();
    for (_, points) in rings {
        if lowest.len() >= PROMISING {
            break;
        }
        lowest.extend_from_slice(points);
    }
    lowest
}

/// The points with the lowest values according to approximate displacements.
fn lowest_roughly(floor: &Uncovered<'_>, points: &[Point], rough: &[[f64; 2]]) -> Vec<Point> {
    let value = |(point, rough): (&Point, &[f64; 2])| {
        let value = touched_at(floor, floor.lens.sag_with_brim(*point), *rough)?;
        (floor.around.clearance(*point) > 0.0).then_some((value, *point))
    };
    let mut rated: Vec<(f64, Point)> = points.iter().zip(rough).filter_map(value).collect();
    rated.sort_by(|a, b| a.0.total_cmp(&b.0));
    rated.truncate(PROMISING);
    rated.into_iter().map(|(_, point)| point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::neighbours::tests::random_discs;
    use crate::problem::pillar_field::{
        ListedPillar, PillarBody, PillarField, PillarList, PlaneLattice,
    };
    use crate::problem::{Lens, Material};
    use std::sync::Arc;

    /// Mock displacement field that returns one value that is not finite.
    struct Odd(fn(&mut FieldJet));

    impl FloorDisplacement for Odd {
        fn displacement(&self, _: Point) -> [FieldJet; 2] {
            let mut jets = [FieldJet::default(); 2];
            self.0(&mut jets[1]);
            jets
        }
    }

    /// Expected: the holes of the lattice by their distances from the axis, counted by hand.
    #[test]
    fn of_holes_that_are_alike_one_is_rated() {
        let holes = |offset: f64, angle: f64| {
            let lattice = HexagonalLattice {
                pitch: 4.0,
                offset,
                offset_angle: angle,
            };
            starts_on_lattice(&lattice).holes.len()
        };
        // On a pillar: 6, 6 and 12 holes.
        assert_eq!(holes(0.0, 0.0), 3);
        // No symmetry.
        assert!((15..=40).contains(&holes(0.2, 0.1)));
        // In a hole three rotations and three reflections, half-way between two pillars two of each.
        for offset in [1.0 / 3f64.sqrt(), 0.5 * 3f64.sqrt()] {
            assert!((3..=8).contains(&holes(offset, 0.0)));
        }
    }

    #[test]
    fn no_point_is_the_lowest_among_undefined_ones() {
        let problem = crate::solve::newton::tests::problem();
        let cancel = CancelToken::default();
        let floor = Uncovered {
            lens: problem.lens.clone(),
            height: problem.height,
            around: Surroundings::Lattice(problem.hexagonal_lattice().unwrap()),
        };
        let lowest = |odd| FloorSearch::default().lowest(&floor, &Odd(odd), &cancel);
        assert!(lowest(|_| ()).is_some());
        for odd in [
            |jet: &mut FieldJet| jet.value = f64::NAN,
            |jet: &mut FieldJet| jet.value = f64::NEG_INFINITY,
            |jet: &mut FieldJet| jet.gradient[1] = f64::NAN,
            |jet: &mut FieldJet| jet.hessian[2] = f64::NAN,
        ] {
            assert!(lowest(odd).is_none());
        }
    }

    /// Displacements without an approximate evaluation.
    struct Closely<'a>(&'a LoadedDiscs<'a>);

    impl FloorDisplacement for Closely<'_> {
        fn displacement(&self, position: Point) -> [FieldJet; 2] {
            self.0.displacement(position)
        }
    }

    /// A ring that is pressed towards the lens, a little more on one side.
    struct Ring;

    impl FloorDisplacement for Ring {
        fn displacement(&self, [x, y]: Point) -> [FieldJet; 2] {
            let mut jets = [FieldJet::default(); 2];
            jets[1].value = 0.5 * ((x.hypot(y) - 30.0) / 20.0).powi(2) + 1e-4 * x;
            jets
        }
    }

    /// Expected: the lowest of all holes, and the points of one pair of rings at most in addition to those that are looked at in any case.
    #[test]
    fn the_lowest_hole_of_a_lattice_is_in_the_lowest_rings() {
        let body = PillarBody::of_column(0.0);
        let lattice = PlaneLattice::new([[3.0, 0.0], [0.4, 3.5]], [0.7, -0.2], body).unwrap();
        let field = PillarField::Lattice(Arc::new(lattice));
        let sites = Sites::within(&field, 70.0);
        let lens = Lens {
            radius: 1e6,
            material: Material::new(1.0, 0.5),
        };
        let floor = Uncovered {
            lens: lens.into(),
            height: 3.0,
            around: Surroundings::of_sites(&sites, field.spacing(), 65.0),
        };
        let holes = floor.around.starts().holes;
        let found = promising(&floor, &Ring, &holes);
        assert!(found.len() < 2 * PROMISING && found.len() < holes.len() / 4);
        let lowest = |points: &[Point]| {
            let values = points
                .iter()
                .filter_map(|at| value_of_contact(&floor, &Ring, *at));
            values.fold(f64::INFINITY, f64::min)
        };
        assert_eq!(lowest(&found).to_bits(), lowest(&holes).to_bits());
    }

    #[test]
    fn lowest_holes_roughly_are_the_lowest_closely() {
        let discs = random_discs(700, 0.2, 0.05, 7);
        let pillar = |&(centre, radius): &(Point, f64)| ListedPillar {
            centre,
            body: PillarBody {
                radius,
                ..PillarBody::of_column(0.0)
            },
        };
        let list = PillarList::new(discs.iter().map(pillar).collect()).unwrap();
        let field = PillarField::Listed(Arc::new(list));
        let sites = Sites::within(&field, f64::INFINITY);
        let centres: Vec<Point> = discs.iter().map(|disc| disc.0).collect();
        let coefficients: Vec<f64> = (0..6 * discs.len())
            .map(|k| match k % 6 {
                0 => 0.03 + 0.01 * (1.7 * k as f64).sin(),
                _ => 0.003 * (2.3 * k as f64).sin(),
            })
            .collect();
        // All discs have the radius 0.75 in this field.
        let load_of = |disc: usize, mode: usize| coefficients[6 * disc + mode];
        let loaded = LoadedDiscs {
            exterior: &Exterior::new(2),
            discs: Discs::new(
                [centres.len(), 6],
                |disc| centres[disc],
                |_| 0.75,
                [None, Some(&load_of)],
            ),
            run: &Run::default(),
        };
        let lens = Lens {
            radius: 1000.0,
            material: Material::new(1.0, 0.5),
        };
        let floor = Uncovered {
            lens: lens.into(),
            height: 3.0,
            around: Surroundings::of_sites(&sites, field.spacing(), 60.0),
        };
        let holes = floor.around.starts().holes;
        let rough = loaded.rough_displacements(&holes).unwrap();
        let [mut most, mut scale] = [0.0_f64; 2];
        for (hole, [_, rough]) in holes.iter().zip(&rough) {
            if sites.clearance(*hole) > 0.0 {
                let [_, jet] = loaded.displacement(*hole);
                most = most.max((jet.value - rough).abs());
                scale = scale.max(jet.value.abs());
            }
        }
        println!("{} holes: {:e}", holes.len(), most / scale);
        assert!(most < 0.01 * scale);
        let cancel = CancelToken::default();
        let found = FloorSearch::default().lowest(&floor, &loaded, &cancel);
        let closely = FloorSearch::default().lowest(&floor, &Closely(&loaded), &cancel);
        assert!(found.is_some() && found == closely, "{found:?} {closely:?}");
    }

    #[test]
    fn newton_step_descends_on_a_saddle() {
        let jet = FieldJet {
            value: 0.0,
            gradient: [1.0, -2.0],
            hessian: [3.0, 0.5, -1.0],
        };
        let step = newton_step(&jet);
        assert!(step[0] * jet.gradient[0] + step[1] * jet.gradient[1] < 0.0);
    }

    #[test]
    fn newton_step_is_exact_on_a_bowl() {
        let jet = FieldJet {
            value: 0.0,
            gradient: [0.8, -0.3],
            hessian: [2.0, 0.4, 1.0],
        };
        let [x, y] = newton_step(&jet);
        assert!((2.0 * x + 0.4 * y + 0.8).abs() < 1e-14);
        assert!((0.4 * x + 1.0 * y - 0.3).abs() < 1e-14);
    }
}
