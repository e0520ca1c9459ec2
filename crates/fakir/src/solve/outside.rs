//! High pillars far from the others: whether the lens penetrates any beyond those that are solved.
//!
//! Candidate pillars are searched outwards from the lens axis. If all have the same height, those beyond untouched ones are not touched. If
//! heights differ, a high one may be.

use crate::halfspace::layer::force::AroundForce;
use crate::problem::Point;
use crate::problem::scaled::Scene;
use std::f64::consts::PI;

/// Distance from the lens axis of the farthest pillar, with its centre beyond a radius, that the lens penetrates at an indentation under
/// given forces at given positions. `None` if there is no such pillar.
///
/// Each force acts at a point, which is accurate to a few per cent at a distance of one pitch.
pub(super) fn farthest_entered(
    scene: &Scene,
    beyond: f64,
    indentation: f64,
    forces: &[(Point, f64)],
) -> Option<f64> {
    if beyond.is_infinite() || !scene.field.has_unlike_heights() {
        return None;
    }
    let reached = scene.farthest_reached(indentation);
    if reached <= beyond {
        return None;
    }
    let (pillars, _) = scene.field.listed_within(reached);
    let around = AroundForce::at_point(&scene.layers);
    let distances = pillars.iter().filter_map(|(_, pillar)| {
        let [x, y] = pillar.centre;
        let distance = x.hypot(y);
        let least = scene.lens.least_over(pillar.centre, pillar.body.radius);
        let entered = indentation + pillar.body.raised - least;
        if distance <= beyond || (entered <= 0.0 && around.is_none()) {
            return None;
        }
        let away = forces.iter().map(|([u, v], force)| {
            let distance = (x - u).hypot(y - v);
            let of_layers = around.as_ref().map_or(0.0, |around| around.value(distance));
            force / (PI * distance) + force / PI * of_layers
        });
        (entered > away.sum()).then_some(distance)
    });
    distances.reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::pillar_field::{ListedPillar, PillarBody, PillarField, PillarList};
    use crate::problem::{Lens, Material};
    use std::sync::Arc;

    #[test]
    fn a_tall_pillar_beyond_others_is_seen() {
        let pillar = |x: f64, raised: f64| ListedPillar {
            centre: [x, 0.0],
            body: PillarBody {
                raised,
                ..PillarBody::of_column(0.0)
            },
        };
        let scene = |pillars: Vec<ListedPillar>| Scene {
            layers: Vec::new(),
            lens: Lens {
                radius: 1000.0,
                material: Material::new(1.0, 0.5),
            }
            .into(),
            height: 1.0,
            field: PillarField::Listed(Arc::new(PillarList::new(pillars).unwrap())),
            length: 1.0,
            pressure: 1.0,
            rotation: 0.0,
        };
        // A sphere of radius 1000 is 4.9 higher at 99, the edge of the farthest pillar.
        let near = [pillar(0.0, 0.0), pillar(5.0, 0.0), pillar(95.0, 0.0)];
        let found = |raised: f64, forces: &[(Point, f64)]| {
            let mut pillars = near.to_vec();
            pillars.push(pillar(100.0, raised));
            farthest_entered(&scene(pillars), 20.0, 0.5, forces)
        };
        assert_eq!(found(0.0, &[]), None);
        assert_eq!(found(4.3, &[]), None);
        assert_eq!(found(4.5, &[]), Some(100.0));
        // The surface is displaced by 0.1 at a distance of 100 under a force of 10 pi.
        let pressed = [([0.0; 2], 10.0 * PI)];
        assert_eq!(found(4.47, &pressed), None);
        assert_eq!(found(4.53, &pressed), Some(100.0));
    }
}
