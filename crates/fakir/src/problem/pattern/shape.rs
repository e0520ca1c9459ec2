//! The shape of one pillar.

use super::invalid::{InvalidPattern, PatternQuantity};
use crate::problem::column::PillarCompliance;
use crate::problem::point::Point;
use std::f64::consts::PI;

/// Outline of a pillar before its rotation; its centre is the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CrossSection {
    /// A circle.
    Circle {
        /// Diameter, m.
        diameter: f64,
    },
    /// A square with its sides along x and y.
    Square {
        /// Side, m.
        side: f64,
    },
    /// A regular polygon with a corner on the positive x axis.
    Polygon {
        /// Number of sides, 3 or more.
        sides: u32,
        /// Diameter of the circle through the corners, m.
        diameter: f64,
    },
    /// An ellipse.
    Ellipse {
        /// Extent along x, m.
        length: f64,
        /// Extent along y, m.
        width: f64,
    },
}

impl CrossSection {
    /// Area, m^2.
    #[must_use]
    pub fn area(&self) -> f64 {
        match *self {
            Self::Circle { diameter } => 0.25 * PI * diameter * diameter,
            Self::Square { side } => side * side,
            Self::Polygon { sides, diameter } => {
                let count = f64::from(sides);
                0.125 * count * diameter * diameter * (2.0 * PI / count).sin()
            }
            Self::Ellipse { length, width } => 0.25 * PI * length * width,
        }
    }

    /// Diameter of the smallest circle around the centre that contains the outline, m.
    #[must_use]
    pub fn outer_diameter(&self) -> f64 {
        match *self {
            Self::Circle { diameter } | Self::Polygon { diameter, .. } => diameter,
            Self::Square { side } => side * 2f64.sqrt(),
            Self::Ellipse { length, width } => length.max(width),
        }
    }

    /// Diameter of the largest circle around the centre inside the outline, m.
    #[must_use]
    pub fn inner_diameter(&self) -> f64 {
        match *self {
            Self::Circle { diameter } => diameter,
            Self::Square { side } => side,
            Self::Polygon { sides, diameter } => diameter * (PI / f64::from(sides)).cos(),
            Self::Ellipse { length, width } => length.min(width),
        }
    }

    /// Relative distance of a point from the centre: 0 at the centre, 1 on the outline, linear between.
    #[must_use]
    pub fn eccentricity(&self, [x, y]: Point) -> f64 {
        match *self {
            Self::Circle { diameter } => 2.0 * x.hypot(y) / diameter,
            Self::Square { side } => 2.0 * x.abs().max(y.abs()) / side,
            Self::Polygon { sides, .. } => {
                let along = normals(sides).map(|[u, v]| u * x + v * y);
                2.0 * along.fold(0.0, f64::max) / self.inner_diameter()
            }
            Self::Ellipse { length, width } => 2.0 * (x / length).hypot(y / width),
        }
    }

    /// Whether the outline overlaps a copy that is translated by `shift`: two convex bodies overlap if the shift is in the Minkowski sum of
    /// one and the mirror image of the other.
    pub(super) fn overlaps(&self, shift: Point) -> bool {
        // Touching outlines may overlap due to rounding.
        let touching = 1.0 - 8.0 * f64::EPSILON;
        let apart = match *self {
            Self::Polygon { sides, diameter } if sides % 2 == 1 => {
                let [x, y] = shift;
                let along = normals(sides).map(|[u, v]| (u * x + v * y).abs());
                2.0 * along.fold(0.0, f64::max) / (self.inner_diameter() + diameter)
            }
            _ => 0.5 * self.eccentricity(shift),
        };
        apart < touching
    }

    fn check(&self) -> Result<(), InvalidPattern> {
        use PatternQuantity as Q;
        match *self {
            Self::Circle { diameter } => Q::Diameter.positive(diameter),
            Self::Square { side } => Q::Side.positive(side),
            Self::Polygon { sides, diameter } => {
                if sides < 3 {
                    return Err(Q::Sides.refused(f64::from(sides), "3 or more"));
                }
                Q::Diameter.positive(diameter)
            }
            Self::Ellipse { length, width } => {
                Q::Length.positive(length)?;
                Q::Width.positive(width)
            }
        }
    }
}

/// Outward normals of the sides of a polygon.
fn normals(sides: u32) -> impl Iterator<Item = Point> {
    (0..sides).map(move |side| {
        let (sin, cos) = (PI * f64::from(2 * side + 1) / f64::from(sides)).sin_cos();
        [cos, sin]
    })
}

/// Shape of a pillar's top. The distance from the edge is `(1 - e) d/2`, with `e` the [eccentricity](CrossSection::eccentricity) and `d`
/// the inner diameter: the distance from the nearest side of a circle, square or polygon; for an ellipse, the distance along the shorter
/// axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Top {
    /// Level.
    #[default]
    Flat,
    /// A cone or pyramid: the height decreases in proportion to the eccentricity, from the full height at the centre.
    Cone {
        /// Height difference between centre and edge, m.
        drop: f64,
    },
    /// Level except for a linear slope along the edge.
    Chamfer {
        /// Distance from the edge at which the slope begins, m.
        width: f64,
        /// Height difference between centre and edge, m.
        drop: f64,
    },
    /// Level except for an edge that is rounded by a quarter circle.
    Rounded {
        /// Radius of the circle, m.
        radius: f64,
    },
}

impl Top {
    /// Depth of the top below its centre at a distance from the edge, m.
    fn depth(&self, distance: f64, half_width: f64) -> f64 {
        match *self {
            Self::Flat => 0.0,
            Self::Cone { drop } => drop * (1.0 - distance / half_width),
            Self::Chamfer { width, drop } => drop * (1.0 - distance / width).max(0.0),
            Self::Rounded { radius } => {
                let beyond = (radius - distance).max(0.0);
                radius - (radius * radius - beyond * beyond).max(0.0).sqrt()
            }
        }
    }

    /// `height` is that of the lowest pillar.
    fn check(&self, half_width: f64, height: f64) -> Result<(), InvalidPattern> {
        use PatternQuantity as Q;
        let drop_is_possible = |drop: f64| {
            Q::Drop.within(
                drop,
                (0.0..=height).contains(&drop),
                "0 to the pillar height",
            )
        };
        match *self {
            Self::Flat => Ok(()),
            Self::Cone { drop } => drop_is_possible(drop),
            Self::Chamfer { width, drop } => {
                let possible = width > 0.0 && width <= half_width;
                Q::ChamferWidth.within(
                    width,
                    possible,
                    "above 0, at most half the inner diameter",
                )?;
                drop_is_possible(drop)
            }
            Self::Rounded { radius } => {
                let possible = radius > 0.0 && radius <= half_width.min(height);
                let wanted = "above 0, at most half the inner diameter and at most the height";
                Q::EdgeRadius.within(radius, possible, wanted)
            }
        }
    }
}

/// One pillar of a pattern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PillarShape {
    /// Outline.
    pub cross_section: CrossSection,
    /// Rotation of the outline, anticlockwise, rad.
    pub orientation: f64,
    /// Height of the centre of its top above the floor, m.
    pub height: f64,
    /// Shape of its top.
    pub top: Top,
    /// Compliance model; a column shortens by `h F/(E A)` with the area `A` of its outline.
    pub compliance: PillarCompliance,
}

impl PillarShape {
    /// A cylinder with a flat top and the compliance of a column.
    #[must_use]
    pub fn cylinder(diameter: f64, height: f64) -> Self {
        Self {
            cross_section: CrossSection::Circle { diameter },
            orientation: 0.0,
            height,
            top: Top::Flat,
            compliance: PillarCompliance::Column,
        }
    }

    /// The coordinates of a point relative to the outline before its rotation.
    pub(super) fn turned_back(&self, [x, y]: Point) -> Point {
        let (sin, cos) = self.orientation.sin_cos();
        [cos * x + sin * y, cos * y - sin * x]
    }

    /// Depth of the top below its centre at a point, m, relative to the pillar's axis; `None` outside the pillar.
    pub(super) fn depth_at(&self, point: Point) -> Option<f64> {
        let eccentricity = self.cross_section.eccentricity(self.turned_back(point));
        let half_width = 0.5 * self.cross_section.inner_diameter();
        let distance = (1.0 - eccentricity) * half_width;
        (eccentricity < 1.0).then(|| self.top.depth(distance, half_width))
    }

    /// `spread` is the largest relative deviation of heights.
    pub(super) fn check(&self, spread: f64) -> Result<(), InvalidPattern> {
        use PatternQuantity as Q;
        self.cross_section.check()?;
        Q::Orientation.within(self.orientation, true, "a finite number")?;
        Q::Height.positive(self.height)?;
        let half_width = 0.5 * self.cross_section.inner_diameter();
        self.top.check(half_width, self.height * (1.0 - spread))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OUTLINES: [CrossSection; 7] = [
        CrossSection::Circle { diameter: 2.0 },
        CrossSection::Square { side: 1.48 },
        CrossSection::Polygon {
            sides: 3,
            diameter: 2.0,
        },
        CrossSection::Polygon {
            sides: 4,
            diameter: 2.0,
        },
        CrossSection::Polygon {
            sides: 5,
            diameter: 2.0,
        },
        CrossSection::Polygon {
            sides: 6,
            diameter: 2.0,
        },
        CrossSection::Ellipse {
            length: 2.0,
            width: 0.8,
        },
    ];

    /// Points of a fine grid over the square of side 6.
    fn points() -> impl Iterator<Item = Point> {
        let at = |k: i32| 0.02 * (f64::from(k) + 0.5) - 3.0;
        (0..300).flat_map(move |j| (0..300).map(move |i| [at(i), at(j)]))
    }

    #[test]
    fn area_and_diameters_are_those_of_the_points_inside() {
        for outline in OUTLINES {
            let inside: Vec<Point> = points()
                .filter(|at| outline.eccentricity(*at) < 1.0)
                .collect();
            let area = inside.len() as f64 * 4e-4;
            assert!(
                (area / outline.area() - 1.0).abs() < 1e-2,
                "{outline:?} {area}"
            );
            let outer = inside
                .iter()
                .map(|[x, y]| 2.0 * x.hypot(*y))
                .fold(0.0, f64::max);
            assert!(
                (outer - outline.outer_diameter()).abs() < 0.08,
                "{outline:?} {outer}"
            );
            let outside = points().filter(|at| outline.eccentricity(*at) > 1.0);
            let inner = outside
                .map(|[x, y]| 2.0 * x.hypot(y))
                .fold(f64::INFINITY, f64::min);
            assert!(
                (inner - outline.inner_diameter()).abs() < 0.08,
                "{outline:?} {inner}"
            );
        }
    }

    #[test]
    fn overlap_is_that_of_points() {
        for outline in OUTLINES {
            let inside: Vec<Point> = points()
                .filter(|at| outline.eccentricity(*at) < 0.99)
                .collect();
            for step in 0..24 {
                let (sin, cos) = (PI / 12.0 * f64::from(step) + 0.02).sin_cos();
                let shared = |distance: f64| {
                    let shift = [distance * cos, distance * sin];
                    let covered = |at: &Point| {
                        outline.eccentricity([at[0] - shift[0], at[1] - shift[1]]) < 0.99
                    };
                    (outline.overlaps(shift), inside.iter().any(covered))
                };
                // Bisection for the smallest distance without overlap.
                let (mut near, mut far) = (0.0, 3.0);
                while far - near > 1e-3 {
                    let middle = 0.5 * (near + far);
                    *(if shared(middle).0 {
                        &mut near
                    } else {
                        &mut far
                    }) = middle;
                }
                assert!(shared(0.95 * near).1, "{outline:?} {step} {near}");
                assert!(!shared(far).1, "{outline:?} {step} {near}");
            }
        }
    }

    #[test]
    fn tops_have_their_profiles() {
        let depth = |top: Top, distance: f64| top.depth(distance, 2.0);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-14;
        let cone = Top::Cone { drop: 0.5 };
        assert!(close(depth(cone, 2.0), 0.0) && close(depth(cone, 0.5), 0.375));
        let chamfer = Top::Chamfer {
            width: 0.4,
            drop: 0.2,
        };
        assert!(close(depth(chamfer, 0.5), 0.0) && close(depth(chamfer, 0.1), 0.15));
        let rounded = Top::Rounded { radius: 0.5 };
        assert!(close(depth(rounded, 0.6), 0.0) && close(depth(rounded, 0.0), 0.5));
        // (0.3, 0.4) is on a circle of radius 0.5.
        assert!(close(depth(rounded, 0.2), 0.1));
    }
}
