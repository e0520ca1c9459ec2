//! The hexagonal lattice of pillar centres relative to the lens axis.

use super::point::Point;
use std::f64::consts::PI;

/// `pi/(2 sqrt 3)`: the surface fraction at which adjacent pillars touch.
pub const MAXIMUM_SURFACE_FRACTION: f64 = 0.906_899_682_117_108_9;

pub(super) const HALF_SQRT_3: f64 = 0.866_025_403_784_438_6;

/// A hexagonal lattice with vectors `a1 = e (sqrt3/2, 1/2)` and `a2 = e (sqrt3/2, -1/2)`.
///
/// Pillar `(i, j)` is at `a1 i + a2 j - o`, where `o` points from a pillar centre to the lens axis, which is the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HexagonalLattice {
    /// Distance `e` between the centres of neighbouring pillars, m.
    pub pitch: f64,
    /// Distance of the lens axis from a pillar centre, in pitches (`dx/e` of the paper).
    pub offset: f64,
    /// Direction of the offset from x, rad.
    pub offset_angle: f64,
}

impl HexagonalLattice {
    /// Lattice of the given pitch (m), with the lens axis on a pillar centre.
    #[must_use]
    pub fn new(pitch: f64) -> Self {
        Self {
            pitch,
            offset: 0.0,
            offset_angle: 0.0,
        }
    }

    /// Lattice on which pillars of `diameter` (m) cover the fraction `surface_fraction` of the surface: `e = d sqrt(pi/(2 sqrt3 phi))`.
    #[must_use]
    pub fn with_surface_fraction(surface_fraction: f64, diameter: f64) -> Self {
        Self::new(diameter * (MAXIMUM_SURFACE_FRACTION / surface_fraction).sqrt())
    }

    /// The same lattice with the lens axis `offset` pitches away from a pillar
    /// centre, along x.
    #[must_use]
    pub fn offset_by(self, offset: f64) -> Self {
        Self { offset, ..self }
    }

    /// The vector from a pillar centre to the lens axis, m.
    #[must_use]
    pub fn offset_vector(&self) -> Point {
        let (sin, cos) = self.offset_angle.sin_cos();
        let length = self.offset * self.pitch;
        [length * cos, length * sin]
    }

    /// Centre of pillar `(i, j)`, m from the lens axis.
    #[must_use]
    pub fn centre(&self, i: i64, j: i64) -> Point {
        let [x, y] = self.lattice_vector(i, j);
        let [offset_x, offset_y] = self.offset_vector();
        [x - offset_x, y - offset_y]
    }

    /// `a1 i + a2 j`, m.
    #[must_use]
    pub fn lattice_vector(&self, i: i64, j: i64) -> Point {
        [
            self.pitch * HALF_SQRT_3 * (i + j) as f64,
            self.pitch * 0.5 * (i - j) as f64,
        ]
    }

    /// The vectors to the next pillar along the first index, and along the second, m.
    pub(crate) fn vectors(&self) -> [Point; 2] {
        [(1, 0), (0, 1)].map(|(i, j)| self.lattice_vector(i, j))
    }

    /// Indices of the pillar whose centre is nearest to `point` (m from the lens axis). If several are equally near, one of these.
    #[must_use]
    pub fn nearest_pillar(&self, point: Point) -> (i64, i64) {
        let [offset_x, offset_y] = self.offset_vector();
        let sum = (point[0] + offset_x) / (self.pitch * HALF_SQRT_3);
        let difference = (point[1] + offset_y) / (self.pitch * 0.5);
        let (i, j) = (0.5 * (sum + difference), 0.5 * (sum - difference));
        let (low_i, low_j) = (i.floor() as i64, j.floor() as i64);
        let mut nearest = (low_i, low_j);
        let mut smallest = f64::INFINITY;
        for (i, j) in [
            (low_i, low_j),
            (low_i + 1, low_j),
            (low_i, low_j + 1),
            (low_i + 1, low_j + 1),
        ] {
            let [x, y] = self.centre(i, j);
            let square = (x - point[0]).powi(2) + (y - point[1]).powi(2);
            if square < smallest {
                smallest = square;
                nearest = (i, j);
            }
        }
        nearest
    }

    /// The two centres of triangles of pillars that are adjacent to a pillar centre along x, at `e/sqrt3` from it, m. Over all pillars,
    /// each of these centres occurs once.
    #[must_use]
    pub fn middles_beside(&self, [x, y]: Point) -> [Point; 2] {
        let aside = self.pitch / 3f64.sqrt();
        [[x + aside, y], [x - aside, y]]
    }

    /// Area of the lattice cell, `sqrt3/2 e^2`, m^2.
    #[must_use]
    pub fn cell_area(&self) -> f64 {
        HALF_SQRT_3 * self.pitch * self.pitch
    }

    /// The rotations and mirrors about the lens axis that leave the lattice unchanged.
    #[must_use]
    pub fn symmetry(&self) -> LatticeSymmetry {
        LatticeSymmetry::of(self)
    }
}

/// The point group of a lattice about the lens axis.
///
/// The group contains those of the twelve operations of the hexagonal lattice (rotations by multiples of 60 degrees, mirrors through lines
/// at multiples of 30 degrees) that map the pillar centres onto themselves with the lens axis fixed: all twelve on a pillar, six on a
/// hollow site, four between two pillars, two on a mirror line, and one elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct LatticeSymmetry {
    operations: Vec<Operation>,
}

/// A rotation or mirror, as a matrix.
type Operation = [[f64; 2]; 2];

/// Whether all products of the operations are among them.
fn is_group(operations: &[(f64, Operation)]) -> bool {
    let product = |g: &Operation, h: &Operation| {
        let column = |k: usize| apply(g, [h[0][k], h[1][k]]);
        let ([a, c], [b, d]) = (column(0), column(1));
        [[a, b], [c, d]]
    };
    let same = |g: &Operation, h: &Operation| {
        g.iter()
            .flatten()
            .zip(h.iter().flatten())
            .all(|(a, b)| (a - b).abs() < 1e-9)
    };
    operations.iter().all(|(_, g)| {
        operations.iter().all(|(_, h)| {
            let gh = product(g, h);
            operations.iter().any(|(_, other)| same(other, &gh))
        })
    })
}

impl LatticeSymmetry {
    fn of(lattice: &HexagonalLattice) -> Self {
        // An operation g is a symmetry if g o - o is a lattice vector.
        let offset = lattice.offset_vector();
        let on_lattice = HexagonalLattice::new(lattice.pitch);
        let misfit = |operation: &Operation| {
            let image = apply(operation, offset);
            let shift = [image[0] - offset[0], image[1] - offset[1]];
            let (i, j) = on_lattice.nearest_pillar(shift);
            let [x, y] = on_lattice.lattice_vector(i, j);
            (x - shift[0]).hypot(y - shift[1])
        };
        let all = [1.0, -1.0].into_iter().flat_map(|mirror| {
            (0..6).map(move |sixth| {
                let (sin, cos) = (PI / 3.0 * f64::from(sixth)).sin_cos();
                [[cos, -sin * mirror], [sin, cos * mirror]]
            })
        });
        let mut candidates: Vec<(f64, Operation)> = all.map(|g| (misfit(&g), g)).collect();
        let tolerance = 1e-9 * lattice.pitch * (1.0 + lattice.offset);
        candidates.retain(|(misfit, _)| *misfit <= tolerance);
        // Near a special site some operations may be within the tolerance while their products are not: the worst are removed until the
        // rest is a group. The identity, whose misfit is zero, always remains.
        while !is_group(&candidates) {
            let worst = candidates.iter().map(|c| c.0).fold(0.0, f64::max);
            candidates.retain(|(misfit, _)| *misfit < worst);
        }
        Self {
            operations: candidates.into_iter().map(|(_, g)| g).collect(),
        }
    }

    /// Number of operations, 1 to 12.
    #[must_use]
    pub fn order(&self) -> usize {
        self.operations.len()
    }

    /// The images of `point` under every operation.
    pub fn images(&self, point: Point) -> impl Iterator<Item = Point> + '_ {
        self.operations
            .iter()
            .map(move |operation| apply(operation, point))
    }

    /// The representative image of `point` for output: among the images with y >= 0, the one farthest along x. With a pillar under the lens
    /// axis it is in the sector of 0 to 30 degrees; between two pillars, in the first quadrant; on the mirror line x, it has y >= 0.
    #[must_use]
    pub fn fold(&self, point: Point) -> Point {
        let size = point[0].hypot(point[1]);
        // Points close to an axis are set on it, to avoid rounding errors of either sign. The floor is flat about its lowest point, whose
        // position is less accurate than its height.
        let clean = |point: Point| point.map(|v| if v.abs() < 1e-9 * size { 0.0 } else { v });
        let mut folded = clean(point);
        for image in self.images(point) {
            let candidate = clean(image);
            let better_side = candidate[1] >= 0.0 && folded[1] < 0.0;
            let same_side = (candidate[1] >= 0.0) == (folded[1] >= 0.0);
            if better_side || (same_side && candidate[0] > folded[0]) {
                folded = candidate;
            }
        }
        folded
    }
}

fn apply(operation: &Operation, point: Point) -> Point {
    [
        operation[0][0] * point[0] + operation[0][1] * point[1],
        operation[1][0] * point[0] + operation[1][1] * point[1],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_neighbours_at_one_pitch() {
        let lattice = HexagonalLattice::new(2.0);
        for (i, j) in [(1, 0), (0, 1), (-1, 0), (0, -1), (1, -1), (-1, 1)] {
            let [x, y] = lattice.centre(i, j);
            assert!((x.hypot(y) - 2.0).abs() < 1e-15);
        }
        assert!((lattice.centre(1, 1)[0] - 2.0 * 3f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn nearest_pillar_beats_its_neighbours() {
        let lattice = HexagonalLattice {
            pitch: 1.7,
            offset: 0.4,
            offset_angle: 0.3,
        };
        for step in 0..200 {
            let t = f64::from(step);
            let point = [3.0 * (0.7 * t).sin(), 2.0 * (1.3 * t).cos()];
            let (i, j) = lattice.nearest_pillar(point);
            let distance = |(i, j)| {
                let [x, y] = lattice.centre(i, j);
                (x - point[0]).hypot(y - point[1])
            };
            // The distance to the nearest lattice point is at most that of the hollow site.
            assert!(distance((i, j)) <= 1.7 / 3f64.sqrt() + 1e-12);
            for (di, dj) in [(1, 0), (0, 1), (-1, 0), (0, -1), (1, -1), (-1, 1)] {
                assert!(distance((i, j)) <= distance((i + di, j + dj)) + 1e-12);
            }
        }
    }

    #[test]
    fn symmetry_of_the_special_sites() {
        let order = |offset: f64, degrees: f64| {
            HexagonalLattice {
                pitch: 1.3,
                offset,
                offset_angle: degrees.to_radians(),
            }
            .symmetry()
            .order()
        };
        assert_eq!(order(0.0, 0.0), 12);
        assert_eq!(order(3f64.sqrt(), 0.0), 12); // the next pillar along x
        assert_eq!(order(HALF_SQRT_3, 0.0), 4);
        assert_eq!(order(0.5, 30.0), 4);
        assert_eq!(order(1.0 / 3f64.sqrt(), 0.0), 6); // hollow site
        assert_eq!(order(1.0 / 3.0, 0.0), 2);
        assert_eq!(order(0.3, 11.0), 1);
    }

    #[test]
    fn symmetries_beside_a_special_site_are_a_group() {
        for site in [0.0, HALF_SQRT_3, 1.0 / 3f64.sqrt()] {
            for step in 0..400 {
                let lattice = HexagonalLattice {
                    pitch: 1.3,
                    offset: site + 1e-12 * f64::from(step * step),
                    offset_angle: 1e-10 * f64::from(step % 7),
                };
                let order = lattice.symmetry().order();
                assert!([1, 2, 3, 4, 6, 12].contains(&order), "{order}");
            }
        }
    }

    #[test]
    fn folding_picks_the_documented_sector() {
        let on_pillar = HexagonalLattice::new(1.0).symmetry();
        let between = HexagonalLattice::new(1.0).offset_by(HALF_SQRT_3).symmetry();
        let on_mirror = HexagonalLattice::new(1.0).offset_by(0.2).symmetry();
        for step in 0..36 {
            let angle = f64::from(step) * PI / 18.0;
            let point = [angle.cos(), angle.sin()];
            let [x, y] = on_pillar.fold(point);
            let folded = y.atan2(x);
            assert!((-1e-9..=PI / 6.0 + 1e-9).contains(&folded));
            let [x, y] = between.fold(point);
            assert!(x >= -1e-9 && y >= 0.0);
            let [x, y] = on_mirror.fold(point);
            assert!((x - point[0]).abs() < 1e-12 && (y - point[1].abs()).abs() < 1e-12);
        }
    }
}
