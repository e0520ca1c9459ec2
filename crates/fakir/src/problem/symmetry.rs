//! Rotations and reflections about the lens axis that map pillars to pillars.

use super::pillar_field::{ON_AXIS, PillarField};
use super::point::{Point, turned};
use std::f64::consts::PI;

/// A rotation, optionally preceded by a reflection, that maps every pillar of a lattice to another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Symmetry {
    /// Angle of the rotation, rad.
    pub(crate) angle: f64,
    /// Whether `y` is reflected to `-y` before the rotation.
    pub(crate) reflected: bool,
    /// Images of a step along the first index, and along the second.
    steps: [[i64; 2]; 2],
    /// The image of pillar (0, 0).
    first: [i64; 2],
}

/// Relative rounding error of the vectors of a lattice.
const ROUNDING: f64 = 1e-12;

impl Symmetry {
    /// All symmetries of a field of pillars, beginning with the identity. Only infinite lattices of equal pillars are considered.
    pub(crate) fn of(field: &PillarField) -> Vec<Self> {
        let Some((vectors, origin)) = field.infinite_lattice() else {
            return Vec::new();
        };
        let sixths = (0..6).map(|step| PI / 3.0 * f64::from(step));
        let quarters = [0.5 * PI, 1.5 * PI];
        let angles = sixths.chain(quarters);
        let all = angles.flat_map(|angle| [false, true].map(|reflected| (angle, reflected)));
        all.filter_map(|(angle, reflected)| Self::new(vectors, origin, angle, reflected))
            .collect()
    }

    /// The symmetry with this rotation, of the lattice with these vectors and a pillar at `origin`, if it is one.
    fn new(vectors: [Point; 2], origin: Point, angle: f64, reflected: bool) -> Option<Self> {
        let [[ax, ay], [bx, by]] = vectors;
        let area = ax * by - ay * bx;
        let whole = |[x, y]: Point, rounding: f64| {
            let steps = [(x * by - y * bx) / area, (ax * y - ay * x) / area];
            let near = steps
                .iter()
                .all(|step| (step - step.round()).abs() < rounding);
            near.then(|| steps.map(|step| step.round() as i64))
        };
        let [one, other] = vectors.map(|vector| whole(image(vector, angle, reflected), ROUNDING));
        let moved = image(origin, angle, reflected);
        let shift = [moved[0] - origin[0], moved[1] - origin[1]];
        Some(Self {
            angle,
            reflected,
            steps: [one?, other?],
            first: whole(shift, ON_AXIS)?,
        })
    }

    /// The image of a pillar.
    pub(crate) fn index(&self, (i, j): (i64, i64)) -> (i64, i64) {
        let [one, other] = self.steps;
        let [first, second] = [0, 1].map(|k| self.first[k] + one[k] * i + other[k] * j);
        (first, second)
    }

    /// The image of a point.
    pub(crate) fn image(&self, point: Point) -> Point {
        image(point, self.angle, self.reflected)
    }
}

fn image([x, y]: Point, angle: f64, reflected: bool) -> Point {
    turned([x, if reflected { -y } else { y }], angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::HexagonalLattice;

    fn field(offset: f64, offset_angle: f64) -> PillarField {
        PillarField::Hexagonal {
            lattice: HexagonalLattice {
                pitch: 4.3,
                offset,
                offset_angle,
            },
            column: 0.0.into(),
        }
    }

    /// Expected: the orders of the point groups of the hexagonal lattice (International Tables for Crystallography A, plane group 17).
    #[test]
    fn orders_are_those_of_the_special_positions() {
        let right_angle = 0.5 * PI;
        for (offset, angle, order) in [
            (0.0, 0.0, 12),
            (1.0 / 3f64.sqrt(), 0.0, 6),
            (0.5 * 3f64.sqrt(), 0.0, 4),
            (0.5, right_angle, 4),
            (0.5, 0.0, 2),
            (0.3, right_angle, 2),
            (0.3, PI / 6.0, 2),
            (0.3, 0.4, 1),
            // Close to the middle between two pillars, on the line through both.
            (0.5 * 3f64.sqrt() + 3e-10, 0.0, 2),
        ] {
            let found = Symmetry::of(&field(offset, angle));
            assert_eq!(found.len(), order, "{offset} {angle}");
            assert_eq!((found[0].angle, found[0].reflected), (0.0, false));
        }
    }

    #[test]
    fn mirrored_pillars_are_pillars() {
        for (offset, angle) in [(0.0, 0.0), (1.0 / 3f64.sqrt(), 0.0), (0.3, PI / 6.0)] {
            let field = field(offset, angle);
            let PillarField::Hexagonal { lattice, .. } = &field else {
                return;
            };
            for symmetry in Symmetry::of(&field) {
                for index in [(0, 0), (3, -1), (-2, 7)] {
                    let (i, j) = symmetry.index(index);
                    let [x, y] = symmetry.image(lattice.centre(index.0, index.1));
                    let [to_x, to_y] = lattice.centre(i, j);
                    assert!((x - to_x).hypot(y - to_y) < 1e-12, "{symmetry:?}");
                }
            }
        }
    }
}
