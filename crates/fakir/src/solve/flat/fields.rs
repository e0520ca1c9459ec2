//! Displacement, gap and pressure at any point of a contact with a flat surface.

use super::Bench;
use crate::halfspace::layer::LayerResponse;
use crate::numerics::convergence::larger;
use crate::numerics::special::bessel;
use crate::problem::layer::WeightedLayer;
use crate::problem::{FlatSystem, Point};
use crate::state::{FieldSamples, FlatContact, Run, SolveError, sample_cells, sample_points};
use crate::theory::layer::Disc;
use std::f64::consts::PI;

/// The contact with a flat surface as functions of position, in m from the lens axis.
///
/// Inside the contact the displacement is what the shape of the lens requires and the pressure is that of the disc; outside, the displacement is the
/// integral of the disc's solution over the response of the bodies.
pub struct FlatFields {
    system: FlatSystem,
    /// Contact radius and indentation, m.
    radius: f64,
    indentation: f64,
    disc: Disc,
    /// `pi theta` at the points of the disc, m.
    solution: Vec<f64>,
    /// Wave numbers of the layers (1/m), with the displacement of each wave on the axis (m). None on half-spaces.
    waves: Vec<[f64; 2]>,
}

impl FlatSystem {
    /// The fields of a contact, for points up to a distance from the lens axis (m): beyond it, the displacement on bodies with layers loses digits.
    #[must_use]
    pub fn fields(&self, contact: &FlatContact, farthest: f64) -> FlatFields {
        FlatFields::of_disc(self, contact.contact_radius, contact.indentation, farthest)
    }

    /// Pressure of a contact at distances from the lens axis (m), Pa. Zero outside of the contact; at the rim of an adhesive contact and of a punch it is
    /// infinite.
    #[must_use]
    pub fn pressure(&self, contact: &FlatContact, distances: &[f64]) -> Vec<f64> {
        self.pressure_of_disc(contact.contact_radius, contact.indentation, distances)
    }

    /// The same of the contact with a radius at an indentation, m.
    #[must_use]
    pub fn pressure_of_disc(&self, radius: f64, indentation: f64, distances: &[f64]) -> Vec<f64> {
        let fields = FlatFields::of_disc(self, radius, indentation, 0.0);
        let at = |distance: &f64| fields.pressure([*distance, 0.0]);
        distances.iter().map(at).collect()
    }

    /// Relative normal displacement of the two surfaces at distances from the lens axis (m), m, positive apart.
    #[must_use]
    pub fn displacement(&self, contact: &FlatContact, distances: &[f64]) -> Vec<f64> {
        let farthest = distances
            .iter()
            .fold(0.0, |most: f64, it| larger(most, it.abs()));
        let fields = self.fields(contact, farthest);
        let at = |distance: &f64| fields.displacement([*distance, 0.0]);
        distances.iter().map(at).collect()
    }
}

impl FlatFields {
    /// The fields of the contact with a radius at an indentation (m), up to a distance from the axis (m).
    #[must_use]
    pub fn of_disc(system: &FlatSystem, radius: f64, indentation: f64, farthest: f64) -> Self {
        let bench = Bench::new(system, 1.0);
        let disc = bench.disc(radius);
        let [one, bent] = bench.solutions(&disc, radius);
        let parts = one.iter().zip(&bent);
        let solution: Vec<f64> = parts.map(|(one, bent)| indentation * one + bent).collect();
        let layers = match radius > 0.0 && farthest > radius {
            true => WeightedLayer::among(&system.bodies(), 1.0),
            false => Vec::new(),
        };
        let waves_of = |layer: &WeightedLayer| {
            let scale = radius / layer.thickness;
            // The waves oscillate over the distance of a point and over the radius.
            let reach = larger(2.0 * radius, radius + farthest) / layer.thickness;
            let factor = 2.0 / PI * layer.weight * scale;
            let rule = LayerResponse::of(layer).rule(reach).into_iter();
            let wave = |(wave, weight): (f64, f64)| {
                let part = disc.transformed(&solution, wave * scale);
                [wave / layer.thickness, factor * weight * part]
            };
            rule.map(wave).collect::<Vec<_>>()
        };
        let waves = layers.iter().flat_map(waves_of).collect();
        Self {
            system: system.clone(),
            radius,
            indentation,
            disc,
            solution,
            waves,
        }
    }

    /// Distance from the lens axis in contact radii; infinite without contact.
    fn place(&self, [x, y]: Point) -> f64 {
        match self.radius > 0.0 {
            true => x.hypot(y) / self.radius,
            false => f64::INFINITY,
        }
    }

    /// Height of the lens above its lowest point, m; infinite beyond the rim of a punch.
    fn sag(&self, position: Point) -> f64 {
        self.system.lens().sag_with_brim(position)
    }

    /// Whether a position is in the contact.
    #[must_use]
    pub fn is_in_contact(&self, position: Point) -> bool {
        self.place(position) <= 1.0
    }

    /// Relative normal displacement of the two surfaces due to the pressure, m, positive apart.
    #[must_use]
    pub fn displacement(&self, position: Point) -> f64 {
        let place = self.place(position);
        if place <= 1.0 {
            return self.indentation - self.sag(position);
        }
        if place.is_infinite() {
            return 0.0;
        }
        let mut value = [0.0];
        let by_layers = self.waves.iter().map(|[wave, displacement]| {
            bessel(wave * place * self.radius, &mut value);
            displacement * value[0]
        });
        let by_layers: f64 = by_layers.sum();
        by_layers + self.disc.displacement_outside(&self.solution, place)
    }

    /// Gap between the lens and the flat surface, m; zero in contact, and infinite beyond the rim of a punch.
    #[must_use]
    pub fn gap(&self, position: Point) -> f64 {
        let [_, gap] = self.displacement_and_gap(position);
        gap
    }

    fn displacement_and_gap(&self, position: Point) -> [f64; 2] {
        let displacement = self.displacement(position);
        let gap = match self.is_in_contact(position) {
            true => 0.0,
            false => self.sag(position) + displacement - self.indentation,
        };
        [displacement, gap]
    }

    /// Contact pressure, Pa: zero outside of the contact, negative where adhesion pulls; infinite at the rim of an adhesive contact and of a punch.
    #[must_use]
    pub fn pressure(&self, position: Point) -> f64 {
        let place = self.place(position);
        if place >= 1.0 {
            return 0.0;
        }
        let factor = self.system.reduced_modulus() / (PI * self.radius);
        factor * self.disc.pressure(&self.solution, place)
    }

    /// Displacement, gap and pressure at points, in the same order.
    ///
    /// # Errors
    /// [`SolveError::TooManyPoints`] if the memory limit would be exceeded; interruption.
    pub fn sample(&self, points: &[Point], run: &Run<'_>) -> Result<FieldSamples, SolveError> {
        sample_points(
            points,
            |at| self.displacement_and_gap(at),
            |at| self.pressure(at),
            run,
        )
    }

    /// The same on a grid of equidistant points, x fastest; the pressure is the mean of 16 points in the cell around each point.
    ///
    /// # Errors
    /// As [`sample`](Self::sample).
    pub fn on_grid(&self, x: &[f64], y: &[f64], run: &Run<'_>) -> Result<FieldSamples, SolveError> {
        let others = |at| self.displacement_and_gap(at);
        sample_cells([x, y], others, |at| self.pressure(at), run)
    }
}

/// Omits the tables used for evaluation.
impl std::fmt::Debug for FlatFields {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FlatFields")
            .field("radius", &self.radius)
            .field("indentation", &self.indentation)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Adhesion, Layer, Lens, LensShape, Load, Material, ShapedLens};

    const RADIUS: f64 = 1e-3;
    const RUBBER: Material = Material {
        young_modulus: 2e6,
        poisson_ratio: 0.5,
    };

    fn close(found: f64, expected: f64, tolerance: f64) {
        let off = (found - expected).abs();
        assert!(off <= tolerance * expected.abs(), "{found:e}, {expected:e}");
    }

    fn paraboloid() -> FlatSystem {
        let shape = LensShape::Paraboloid { radius: RADIUS };
        FlatSystem::new(ShapedLens::new(shape, RUBBER), RUBBER).unwrap()
    }

    fn pressed(system: &FlatSystem) -> FlatContact {
        let load = Load::Indentation(2e-6);
        system.press(load, &Run::default()).unwrap()
    }

    /// Displacement beside the contact and gap of Hertz (K. L. Johnson, Contact Mechanics, eq. 3.42a): `u = ((2 a^2 - r^2) arcsin(a/r) + a sqrt(r^2 -
    /// a^2))/(pi R)`.
    #[test]
    fn a_paraboloid_is_hertz() {
        let system = paraboloid();
        let contact = pressed(&system);
        let (a, depth) = (contact.contact_radius, contact.indentation);
        let fields = system.fields(&contact, 10.0 * a);
        for part in [0.0, 0.5, 0.999] {
            let at = [0.6 * part * a, 0.8 * part * a];
            close(
                fields.displacement(at),
                depth - (part * a).powi(2) / (2.0 * RADIUS),
                1e-12,
            );
            assert!(fields.gap(at) == 0.0 && fields.is_in_contact(at));
        }
        for part in [1.01, 1.5, 4.0] {
            let r: f64 = part * a;
            let root = (r * r - a * a).sqrt();
            let expected = ((2.0 * a * a - r * r) * (a / r).asin() + a * root) / (PI * RADIUS);
            let at = [-0.6 * r, 0.8 * r];
            close(fields.displacement(at), expected, 1e-6);
            assert!(fields.gap(at) > 0.0 && fields.pressure(at) == 0.0);
        }
    }

    /// The displacement by half-spaces and layers together is what the shape of the lens requires, at the rim, and is continuous there. Far from a
    /// contact that is small beside the thickness it is that of a force: `F (1/r + Psi(r))/(pi E*)`.
    #[test]
    fn layers_move_the_surface_beside_the_contact() {
        let film = |thickness: f64| {
            let layers = [Some(Layer::new(thickness)), None];
            paraboloid().with_layers(layers[0], layers[1]).unwrap()
        };
        let thick = film(50e-6);
        let contact = pressed(&thick);
        let a = contact.contact_radius;
        let fields = thick.fields(&contact, 3.0 * a);
        let [inside, outside] =
            [1.0 - 1e-9, 1.0 + 1e-7].map(|part| fields.displacement([part * a, 0.0]));
        close(outside, inside, 1e-3);
        let wide = film(2e-3);
        let contact = pressed(&wide);
        let away = 30.0 * contact.contact_radius;
        let fields = wide.fields(&contact, away);
        let layers = crate::theory::layer::Layers::new(wide.bodies());
        let response = away.recip() + layers.far_displacement(away);
        let expected = contact.force * response / (PI * wide.reduced_modulus());
        // The extent of the contact changes this by 0.4 a^2/(4 r^2).
        close(fields.displacement([0.0, away]), expected, 5e-4);
    }

    /// Sums over cells are the force, to their size; maps are symmetric; under a punch, and with adhesion, whose tension at the rim is infinite.
    #[test]
    fn pressures_on_a_grid_carry_the_force() {
        let adhesive = paraboloid().with_adhesion(Adhesion::new(50e-3)).unwrap();
        let punch = FlatSystem::punch(50e-6, RUBBER, RUBBER).unwrap();
        let sphere = Lens {
            radius: RADIUS,
            material: RUBBER,
        };
        let sphere = FlatSystem::new(sphere, RUBBER).unwrap();
        for (system, tolerance) in [
            (paraboloid(), 1e-3),
            (sphere, 1e-3),
            (adhesive, 0.02),
            (punch, 0.02),
        ] {
            let contact = pressed(&system);
            let side = 1.3 * contact.contact_radius / 40.0;
            let axis: Vec<f64> = (-40..=40).map(|k| side * f64::from(k)).collect();
            let fields = system.fields(&contact, 2.0 * contact.contact_radius);
            let samples = fields.on_grid(&axis, &axis, &Run::default()).unwrap();
            let force: f64 = samples.pressure.iter().sum::<f64>() * side * side;
            // Relative to what the largest pressure carries, as the force of an adhesive contact passes through zero.
            let scale = contact.punch_stiffness * contact.indentation;
            println!("{:e}", (force - contact.force) / scale);
            assert!((force - contact.force).abs() < tolerance * scale);
            let count = axis.len();
            for (cell, gap) in samples.gap.iter().enumerate() {
                let mirrored = (cell % count) * count + cell / count;
                close(samples.pressure[mirrored], samples.pressure[cell], 1e-9);
                let at = [axis[cell % count], axis[cell / count]];
                assert_eq!(*gap == 0.0, fields.is_in_contact(at));
            }
        }
    }
}
