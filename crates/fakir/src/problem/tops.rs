//! First contact of the lens, and positions of pillar tops.

use super::arrangement::PlacedPillar;
use super::point::Point;
use super::scaled::Scene;
use super::system::System;

impl System {
    /// Indentation at which the lens touches the first pillar, m: the height of the lens at the nearest pillar edge above its lowest point,
    /// minus the height of this pillar above the common height. Zero if the lens axis is on a pillar of the common height, infinite if no
    /// pillar is under the lens.
    #[must_use]
    pub fn first_touch(&self) -> f64 {
        let scene = Scene::new(self);
        scene.first_touch() * scene.length
    }

    /// Whether the lens reaches the floor before any pillar.
    #[must_use]
    pub fn touches_floor_first(&self) -> bool {
        Scene::new(self).touches_floor_first()
    }

    /// The pillars with centres within a distance (m) of the lens axis, by increasing index.
    #[must_use]
    pub fn pillars_within(&self, distance: f64) -> Vec<PlacedPillar> {
        let common = self.pillar();
        let scene = Scene::new(self);
        let (pillars, _) = scene.field.listed_within(distance / scene.length);
        let placed = pillars.into_iter().map(|(index, pillar)| PlacedPillar {
            index,
            centre: scene.metres(pillar.centre),
            height: common.height + pillar.body.raised * scene.length,
            diameter: pillar.body.radius * common.diameter,
        });
        placed.collect()
    }

    /// A point (m from the lens axis) and its distinct images under the symmetries of the arrangement about the lens axis. Symmetries are
    /// evaluated only for infinite hexagonal lattices; for other arrangements the result is the point alone.
    #[must_use]
    pub fn symmetric_copies(&self, point: Point) -> Vec<Point> {
        let Some(lattice) = self.hexagonal_lattice() else {
            return vec![point];
        };
        let near = 1e-6 * lattice.pitch;
        let mut copies: Vec<Point> = Vec::new();
        for image in lattice.symmetry().images(point) {
            let same = |other: &Point| (other[0] - image[0]).hypot(other[1] - image[1]) < near;
            if !copies.iter().any(same) {
                copies.push(image);
            }
        }
        copies
    }

    /// The pillar tops, for queries by position.
    #[must_use]
    pub fn tops(&self) -> Tops {
        Tops(Scene::new(self).as_asked())
    }
}

/// The pillar tops of a [`System`].
#[derive(Debug, Clone)]
pub struct Tops(Scene);

impl Tops {
    /// Whether a point (m from the lens axis) is on a pillar top.
    #[must_use]
    pub fn holds(&self, point: Point) -> bool {
        let Scene { field, length, .. } = &self.0;
        field.under(point.map(|x| x / length)).is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::super::lattice::HexagonalLattice;
    use crate::problem::InvalidQuantity;
    use crate::problem::{Lens, Material, Pillar, PillarCompliance, PillarPattern, System};

    #[test]
    fn copies_of_a_hollow_site() -> Result<(), InvalidQuantity> {
        let rubber = Material::new(1.0, 0.5);
        let pillar = Pillar {
            diameter: 1.0,
            height: 1.0,
            compliance: PillarCompliance::None,
        };
        let lens = Lens {
            radius: 1e3,
            material: rubber,
        };
        let lattice = HexagonalLattice::new(1.0);
        let system = System::new(lens, rubber, PillarPattern::new(pillar, lattice))?;
        let hollow = [1.0 / 3f64.sqrt(), 0.0];
        assert_eq!(system.symmetric_copies(hollow).len(), 6);
        assert_eq!(system.symmetric_copies([0.5, 0.1]).len(), 12);
        assert_eq!(system.symmetric_copies([0.0, 0.0]).len(), 1);
        Ok(())
    }
}
