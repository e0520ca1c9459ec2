//! What of the pillars of a system is where: what the lens meets first, and which pillars stand around it.

use super::arrangement::PlacedPillar;
use super::point::Point;
use super::scaled::Scene;
use super::system::System;

impl System {
    /// Indentation at which the lens touches the first pillar: its height above its lowest point over the nearest pillar edge less by what that
    /// pillar is higher than the common height, m. Zero with the lens axis on a pillar of that height, infinite if no pillar is under the lens.
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

    /// The pillars with centres within a distance (m) of the lens axis, by rising index.
    #[must_use]
    pub fn pillars_within(&self, distance: f64) -> Vec<PlacedPillar> {
        let common = self.pillar();
        if let Some(lattice) = self.hexagonal_lattice() {
            let (near_i, near_j) = lattice.nearest_pillar([0.0, 0.0]);
            // Lattice points within a distance r have indices within 2 r/(sqrt3 e).
            let reach = (1.2 * distance / lattice.pitch).ceil() as i64 + 1;
            let indices = (-reach..=reach)
                .flat_map(|i| (-reach..=reach).map(move |j| (near_i + i, near_j + j)));
            let placed = indices.map(|(i, j)| PlacedPillar {
                index: (i, j),
                centre: lattice.centre(i, j),
                height: common.height,
                diameter: common.diameter,
            });
            return placed
                .filter(|pillar| pillar.centre[0].hypot(pillar.centre[1]) <= distance)
                .collect();
        }
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

    /// The pillar tops, to ask which points they hold.
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
