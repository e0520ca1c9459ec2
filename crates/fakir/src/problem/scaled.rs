//! The problem in the units of the solvers: lengths in pillar radii, pressures in units of the
//! reduced modulus, so that forces are in units of `E* (d/2)^2`.

use super::lattice::HexagonalLattice;
use super::layer::WeightedLayer;
use super::lens::{LensShape, ShapedLens};
use super::load::Load;
use super::pillar_field::{IndexedPillar, ListedPillar, PillarField};
use super::point::{Point, turned};
use super::symmetry::Symmetry;
use super::system::System;
use crate::numerics::convergence::smaller;

/// Largest ratio of the contact radius to the radius of the circle in which the undeformed bodies overlap: for a sphere on a thin
/// incompressible layer, `a^2 = 4 R zeta` (K. L. Johnson, Contact Mechanics, section 5.8), twice the square of the circle's radius.
pub(crate) const RISING: f64 = std::f64::consts::SQRT_2;

/// Lens radius, in pillar radii, below which the sphere differs from a paraboloid over a single pillar top: by `1/(2R)^2`, so that
/// truncation at degree 2 causes an error of 2e-5 at a radius of 8 and 1e-6 at this radius.
pub(crate) const SMALL_LENS: f64 = 40.0;

/// A lens above pillars in any arrangement on a floor. Lengths are in units of the common pillar radius.
#[derive(Debug, Clone)]
pub(crate) struct Scene {
    pub(crate) lens: ShapedLens,
    /// Common height of the pillars: the depth of the floor.
    pub(crate) height: f64,
    pub(crate) field: PillarField,
    /// The bodies that are layers instead of half-spaces.
    pub(crate) layers: Vec<WeightedLayer>,
    /// Unit of length, m.
    pub(crate) length: f64,
    /// Unit of pressure, `E*`, Pa.
    pub(crate) pressure: f64,
    /// Rotation about the lens axis that restores the orientation of the input, rad. Lattices are solved in a standard orientation, so that
    /// the result for a rotated lattice is bitwise the same.
    pub(crate) rotation: f64,
}

impl Scene {
    pub(crate) fn new(system: &System) -> Self {
        let length = 0.5 * system.pillar().diameter;
        let (field, rotation) = PillarField::new(system, length);
        let mut lens = system.lens().in_unit(length).turned(-rotation);
        if lens.punch_radius().is_some() {
            // The field contains only the pillars that it covers: on these it is a plate.
            lens.shape = LensShape::Plate {
                tilt: 0.0,
                direction: 0.0,
            };
        }
        Self {
            lens,
            height: system.pillar().height / length,
            field,
            layers: system.weighted_layers(length),
            length,
            pressure: system.reduced_modulus(),
            rotation,
        }
    }

    /// The same scene in the orientation of the input.
    pub(crate) fn as_asked(&self) -> Self {
        Self {
            lens: self.lens.turned(self.rotation),
            field: self.field.turned(self.rotation),
            rotation: 0.0,
            ..self.clone()
        }
    }

    /// The largest height of a pillar above the common height, m.
    pub(crate) fn highest(&self) -> f64 {
        let [_, highest] = self.field.bounds();
        highest * self.length
    }

    /// Unit of force, N.
    pub(crate) fn force(&self) -> f64 {
        self.pressure * self.length * self.length
    }

    /// Converts a load to units of the scene.
    pub(crate) fn scaled(&self, load: Load) -> Load {
        load.map(
            |indentation| indentation / self.length,
            |force| force / self.force(),
        )
    }

    /// Converts a point to metres.
    pub(crate) fn metres(&self, point: Point) -> Point {
        turned(point, self.rotation).map(|x| x * self.length)
    }

    /// Height of the undeformed lens at a point, above its lowest point.
    pub(crate) fn sag(&self, point: Point) -> f64 {
        self.lens.sag(point)
    }

    /// The lattice under a sphere, if it is the infinite hexagonal lattice of equal pillars.
    pub(crate) fn hexagonal_lattice(&self) -> Option<&HexagonalLattice> {
        match &self.field {
            PillarField::Hexagonal { lattice, .. } if self.lens.sphere().is_some() => Some(lattice),
            _ => None,
        }
    }

    /// Whether floor contact is included in the load: for a lens that is lowest at its axis only.
    pub(crate) fn floor_carries_load(&self) -> bool {
        self.lens.is_axisymmetric()
    }

    /// Columns and rows of the grid of pillars from pillar (0, 0) to the lens axis, if lens and pillars are symmetric under reflections of
    /// x and of y there.
    pub(crate) fn mirrored_at(&self) -> Option<[i64; 2]> {
        let axis = self.field.mirrored_at();
        axis.filter(|_| self.lens.is_axisymmetric())
    }

    /// Rotations and reflections about the lens axis that leave the scene unchanged.
    pub(crate) fn symmetries(&self) -> Vec<Symmetry> {
        if self.lens.is_axisymmetric() {
            Symmetry::of(&self.field)
        } else {
            Vec::new()
        }
    }

    /// Whether the lens reaches the floor before any pillar.
    pub(crate) fn touches_floor_first(&self) -> bool {
        self.first_touch() >= self.height
    }

    /// Whether the undeformed lens touches a pillar other than the given one at an indentation.
    pub(crate) fn reaches_another(&self, one: (i64, i64), indentation: f64) -> bool {
        if let PillarField::Hexagonal { lattice, .. } = &self.field {
            let next = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, -1), (-1, 1)].map(|(i, j)| {
                let [x, y] = lattice.centre(one.0 + i, one.1 + j);
                x.hypot(y)
            });
            let nearest = next.into_iter().fold(f64::INFINITY, smaller);
            return self.lens.sag([(nearest - 1.0).max(0.0), 0.0]) <= indentation;
        }
        let (pillars, _) = self.listed_within(self.farthest_reached(indentation));
        pillars.iter().any(|(index, pillar)| {
            let least = self.lens.least_over(pillar.centre, pillar.body.radius);
            *index != one && least - pillar.body.raised <= indentation
        })
    }

    /// Distance of the nearest pillar top from the lens axis; 0 if the axis is on one.
    pub(crate) fn nearest_edge(&self) -> f64 {
        if let PillarField::Hexagonal { lattice, .. } = &self.field {
            return nearest_edge(lattice);
        }
        let mut radius = self.field.spacing();
        loop {
            let (pillars, all) = self.listed_within(radius);
            let edges = pillars
                .iter()
                .map(|(_, ListedPillar { centre, body })| centre[0].hypot(centre[1]) - body.radius);
            let nearest = edges.fold(f64::INFINITY, smaller);
            if all || nearest.is_finite() {
                return nearest.max(0.0);
            }
            radius *= 2.0;
        }
    }

    /// Distance from the lens axis within which the undeformed lens may touch a top above the common height at an indentation; 0 if it
    /// touches none.
    pub(crate) fn reach_of_tops(&self, indentation: f64) -> f64 {
        let [_, highest] = self.field.bounds();
        if highest <= 0.0 {
            return 0.0;
        }
        self.farthest_reached(indentation)
    }

    /// Distance from the lens axis beyond which the undeformed lens touches no pillar at an indentation; on layers, whose surface may rise
    /// around the load, increased by the largest ratio of contact radii.
    pub(crate) fn farthest_reached(&self, indentation: f64) -> f64 {
        let [largest, highest] = self.field.bounds();
        let reach = self.lens.distance_of_rise(indentation + highest);
        let rising = if self.layers.is_empty() { 1.0 } else { RISING };
        rising * reach.unwrap_or(self.lens.widest()) + largest
    }

    /// The indentation at which the first top is touched.
    pub(crate) fn first_touch(&self) -> f64 {
        if let PillarField::Hexagonal { lattice, .. } = &self.field {
            return self.lens.sag([nearest_edge(lattice), 0.0]);
        }
        let [largest, highest] = self.field.bounds();
        let among = |pillars: &[IndexedPillar]| {
            let tops = pillars.iter().map(|(_, ListedPillar { centre, body })| {
                self.lens.least_over(*centre, body.radius) - body.raised
            });
            tops.fold(f64::INFINITY, smaller)
        };
        if !self.lens.is_axisymmetric() {
            return among(&self.listed_within(f64::INFINITY).0);
        }
        let mut radius = self.field.spacing();
        let near = loop {
            let (pillars, all) = self.field.listed_within(radius);
            let near = among(&pillars);
            if all {
                return near;
            }
            if !pillars.is_empty() {
                break near;
            }
            radius *= 2.0;
        };
        // A more distant pillar is touched earlier only if it is higher by at least the rise of the lens.
        if self.lens.is_flat() {
            return near.min(-highest);
        }
        match self.lens.distance_of_rise(near + highest) {
            None => near.min(-highest),
            Some(radius) => among(&self.field.listed_within(radius + largest).0).min(near),
        }
    }

    /// The pillars that a lens may touch if it touches none farther than `distance` from its lowest point or line: those within this
    /// distance of the lens axis, or all pillars if the lens is not axisymmetric; and whether these are all pillars.
    fn listed_within(&self, distance: f64) -> (Vec<IndexedPillar>, bool) {
        let all = self.field.extent().filter(|_| !self.lens.is_axisymmetric());
        self.field.listed_within(all.unwrap_or(distance))
    }
}

/// Distance of the nearest pillar top from the lens axis; 0 if the axis is on one.
fn nearest_edge(lattice: &HexagonalLattice) -> f64 {
    let (i, j) = lattice.nearest_pillar([0.0, 0.0]);
    let [x, y] = lattice.centre(i, j);
    (x.hypot(y) - 1.0).max(0.0)
}
