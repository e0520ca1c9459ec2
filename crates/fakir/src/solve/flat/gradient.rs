//! Derivatives of a contact with a flat surface.
//!
//! At a contact radius `a` the equation is `A theta = g`, with a matrix of the layers, and the condition at the rim is
//! `h = pi theta(a) + sqrt(2 pi w a/E*) = 0`. A quantity changes the force at a fixed radius and indentation by `A^-1 (dg - dA theta)`, and moves the rim by
//! `da = -dh/(dh/da)`. Since `h = 0` along the curve of equilibria, `dh/da` is minus the solution for `g = 1` at the rim times the change of the indentation
//! with the radius along this curve.

use super::Bench;
use crate::problem::layer::WeightedLayer;
use crate::problem::{FlatSystem, LensShape, Load, Material, Quantity};
use crate::state::{Derivatives, FlatContact, Gradient, Run, SolveError};
use std::f64::consts::PI;

/// Changes of the force and of the condition at the rim at a fixed contact radius and indentation, and of a given radius.
#[derive(Debug, Clone, Copy, Default)]
struct Change {
    force: f64,
    rim: f64,
    radius: f64,
}

impl FlatSystem {
    /// The contact on loading, with the derivatives of force, indentation and contact area by the numbers of the system.
    ///
    /// They are those of the solution: with adhesion, and of contact areas, to 1e-9, as the change of the indentation with the contact radius is a difference
    /// quotient of fourth order; by the numbers of layers to 1e-8, as the change of their kernel is one. The receding work of adhesion has no effect on
    /// loading.
    ///
    /// # Errors
    /// As [`press`](Self::press); [`SolveError::NoGradient`] if nothing is touched.
    pub fn gradient(&self, load: Load, run: &Run<'_>) -> Result<Gradient<FlatContact>, SolveError> {
        let contact = self.press(load, run)?;
        if contact.contact_radius <= 0.0 {
            return Err(SolveError::NoGradient {
                why: "the surface is not touched; raise the load",
            });
        }
        run.check_cancelled()?;
        let bench = Bench::new(self, 1.0);
        let gradient = bench.gradient(contact, matches!(load, Load::Force(_)));
        gradient.with_checked_derivatives()
    }
}

impl Bench<'_> {
    fn gradient(&self, contact: FlatContact, is_force_given: bool) -> Gradient<FlatContact> {
        let work = self.system.adhesion().work;
        let radius = contact.contact_radius;
        let state = self.with_radius(radius, contact.indentation);
        let force_by_radius = self.force_by_radius(&state);
        let stiffness = contact.stiffness;
        // What the rim moves by for a change of the condition there; nothing under a punch.
        let by_rim = match self.system.is_punch() {
            true => 0.0,
            false => (state.one_at_rim * self.indentation_by_radius(&state, work)).recip(),
        };
        let by_indentation = by_rim * state.one_at_rim;
        let (mut forces, mut indentations, mut areas) = (Vec::new(), Vec::new(), Vec::new());
        for (quantity, change) in self.changes(&contact) {
            let moved = change.radius + by_rim * change.rim;
            let force = change.force + force_by_radius * moved;
            let indentation = -force / stiffness;
            let moved = match is_force_given {
                true => moved + by_indentation * indentation,
                false => moved,
            };
            forces.push((quantity, force));
            indentations.push((quantity, indentation));
            areas.push((quantity, 2.0 * PI * radius * moved));
        }
        let of = |quantities| Derivatives {
            heights: Vec::new(),
            quantities,
            column_compliance: 0.0,
        };
        Gradient {
            stiffness,
            force: (!is_force_given).then(|| of(forces)),
            indentation: is_force_given.then(|| of(indentations)),
            area: Some(of(areas)),
            contact,
        }
    }

    /// Changes by every quantity.
    fn changes(&self, contact: &FlatContact) -> Vec<(Quantity, Change)> {
        let system = self.system;
        let (radius, indentation) = (contact.contact_radius, contact.indentation);
        let disc = self.disc(radius);
        let [one, bent] = self.solutions(&disc, radius);
        let parts = one.iter().zip(&bent);
        let theta: Vec<f64> = parts.map(|(one, bent)| indentation * one + bent).collect();
        let modulus = system.reduced_modulus();
        let unit = 2.0 * radius * modulus;
        let of_solution = |change: &[f64]| Change {
            force: unit * disc.integral(change),
            rim: disc.at_rim(change),
            radius: 0.0,
        };
        // The condition at the rim has the square root of the work of adhesion over the modulus.
        let tension = (2.0 * PI * system.adhesion().work * radius / modulus).sqrt();
        // By the logarithm of the reduced modulus.
        let by_modulus = Change {
            force: unit * disc.integral(&theta),
            rim: -0.5 * tension,
            radius: 0.0,
        };
        let mut changes: Vec<(Quantity, Change)> = Vec::new();
        match system.lens().shape {
            LensShape::Punch { .. } => {
                let change = Change {
                    radius: 1.0,
                    ..Change::default()
                };
                changes.push((Quantity::LensRadius, change));
            }
            LensShape::Sphere { .. } | LensShape::Paraboloid { .. } => {
                let change = disc.solve(|u| -system.depth_by_lens_radius(u * radius));
                changes.push((Quantity::LensRadius, of_solution(&change)));
            }
            _ => {}
        }
        let [lens, substrate] = [&system.lens().material, system.substrate()];
        let young = |material: &Material| {
            modulus * material.plane_strain_compliance() / material.young_modulus
        };
        let poisson =
            |material: &Material| modulus * 2.0 * material.poisson_ratio / material.young_modulus;
        changes.extend([
            (Quantity::LensYoungModulus, by_modulus.times(young(lens))),
            (Quantity::LensPoissonRatio, by_modulus.times(poisson(lens))),
            (
                Quantity::SubstrateYoungModulus,
                by_modulus.times(young(substrate)),
            ),
            (
                Quantity::SubstratePoissonRatio,
                by_modulus.times(poisson(substrate)),
            ),
        ]);
        for (quantity, layers) in WeightedLayer::changes(&system.bodies(), 1.0) {
            let mut change = disc.of_layers(&layers, radius, &theta);
            change.iter_mut().for_each(|value| *value = -*value);
            let change = of_solution(&disc.solved(change));
            match changes.iter_mut().find(|(known, _)| *known == quantity) {
                Some((_, known)) => *known = known.plus(change),
                None => changes.push((quantity, change)),
            }
        }
        let work = system.adhesion().work;
        if work > 0.0 {
            let change = Change {
                rim: 0.5 * tension / work,
                ..Change::default()
            };
            changes.push((Quantity::WorkOfAdhesion, change));
        }
        changes
    }
}

impl Change {
    fn times(self, factor: f64) -> Self {
        Self {
            force: factor * self.force,
            rim: factor * self.rim,
            radius: factor * self.radius,
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            force: self.force + other.force,
            rim: self.rim + other.rim,
            radius: self.radius + other.radius,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Adhesion, Base, Layer, LensProfile, ShapedLens};
    use std::sync::Arc;

    /// All numbers of a system.
    #[derive(Debug, Clone, Copy)]
    struct Numbers {
        shape: &'static str,
        radius: f64,
        lens: Material,
        substrate: Material,
        base: Material,
        /// Thicknesses of substrate and lens; infinite for half-spaces.
        thickness: [f64; 2],
        work: f64,
    }

    const NUMBERS: Numbers = Numbers {
        shape: "sphere",
        radius: 2e-3,
        lens: Material {
            young_modulus: 2e6,
            poisson_ratio: 0.45,
        },
        substrate: Material {
            young_modulus: 7e6,
            poisson_ratio: 0.3,
        },
        base: Material {
            young_modulus: 20e6,
            poisson_ratio: 0.2,
        },
        thickness: [f64::INFINITY; 2],
        work: 0.0,
    };

    impl Numbers {
        fn system(self) -> FlatSystem {
            let shape = match self.shape {
                "sphere" => LensShape::Sphere {
                    radius: self.radius,
                },
                "paraboloid" => LensShape::Paraboloid {
                    radius: self.radius,
                },
                _ => {
                    let radii: Vec<f64> = (0..100).map(|k| 5e-6 * f64::from(k)).collect();
                    let height = |r: &f64| r * r / 4e-3 + (r / 100e-6).powi(4) * 1e-7;
                    let heights = radii.iter().map(height).collect();
                    LensShape::Profile(Arc::new(LensProfile::new(radii, heights).unwrap()))
                }
            };
            let system = match self.shape {
                "punch" => FlatSystem::punch(self.radius, self.lens, self.substrate),
                _ => FlatSystem::new(ShapedLens::new(shape, self.lens), self.substrate),
            };
            let layer = |body: usize, base| {
                let thickness = self.thickness[body];
                thickness.is_finite().then_some(Layer { thickness, base })
            };
            let base = Base::Elastic(self.base);
            let system = system
                .unwrap()
                .with_layers(layer(0, base), layer(1, Base::Rigid));
            let adhesion = Adhesion::new(self.work);
            system.unwrap().with_adhesion(adhesion).unwrap()
        }
    }

    type Place = fn(&mut Numbers) -> &mut f64;

    const PLACES: [(Quantity, Place); 10] = [
        (Quantity::LensRadius, |it| &mut it.radius),
        (Quantity::LensYoungModulus, |it| &mut it.lens.young_modulus),
        (Quantity::LensPoissonRatio, |it| &mut it.lens.poisson_ratio),
        (Quantity::SubstrateYoungModulus, |it| {
            &mut it.substrate.young_modulus
        }),
        (Quantity::SubstratePoissonRatio, |it| {
            &mut it.substrate.poisson_ratio
        }),
        (Quantity::SubstrateThickness, |it| &mut it.thickness[0]),
        (Quantity::SubstrateBaseYoungModulus, |it| {
            &mut it.base.young_modulus
        }),
        (Quantity::SubstrateBasePoissonRatio, |it| {
            &mut it.base.poisson_ratio
        }),
        (Quantity::LensThickness, |it| &mut it.thickness[1]),
        (Quantity::WorkOfAdhesion, |it| &mut it.work),
    ];

    /// Differences of fourth order of presses, with steps of 1e-3.
    fn differences(numbers: Numbers, load: Load, place: Place, of: fn(&FlatContact) -> f64) -> f64 {
        let value = *place(&mut { numbers });
        let at = |steps: f64| {
            let mut other = numbers;
            *place(&mut other) = value * (1.0 + 1e-3 * steps);
            of(&other.system().press(load, &Run::default()).unwrap())
        };
        (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12e-3 * value)
    }

    fn check(numbers: Numbers, load: Load) {
        let found = numbers.system().gradient(load, &Run::default()).unwrap();
        let named = match load {
            Load::Force(_) => {
                assert!(found.force.is_none());
                (found.indentation.as_ref().unwrap(), true)
            }
            _ => {
                assert!(found.indentation.is_none());
                (found.force.as_ref().unwrap(), false)
            }
        };
        let (derivatives, is_force_given) = named;
        let area = found.area.as_ref().unwrap();
        let mut compared = 0;
        for (quantity, place) in PLACES {
            let value = *place(&mut { numbers });
            let Some(derivative) = derivatives.by(quantity) else {
                continue;
            };
            compared += 1;
            let of: fn(&FlatContact) -> f64 = match is_force_given {
                true => |contact| contact.indentation,
                false => |contact| contact.force,
            };
            let of_area: fn(&FlatContact) -> f64 = |contact| contact.contact_area;
            let results = [(derivative, of), (area.by(quantity).unwrap(), of_area)];
            for (found_by, of) in results {
                let expected = differences(numbers, load, place, of);
                let least = (of(&found.contact) / value).abs();
                let allowed = 1e-7 * (expected.abs() + least);
                assert!(
                    (found_by - expected).abs() < allowed,
                    "{numbers:?} {load:?} {quantity:?}: {found_by:e} {expected:e}"
                );
            }
        }
        assert_eq!(compared, derivatives.quantities.len(), "{derivatives:?}");
        assert!(compared >= 4);
    }

    #[test]
    #[ignore = "slow: derivatives for all lenses and bases"]
    fn derivatives_are_those_of_differences() {
        for shape in ["sphere", "paraboloid", "profile", "punch"] {
            let radius = if shape == "punch" { 50e-6 } else { 2e-3 };
            let plain = Numbers {
                shape,
                radius,
                ..NUMBERS
            };
            let adhesive = Numbers {
                work: 50e-3,
                ..plain
            };
            for numbers in [plain, adhesive] {
                for load in [Load::Indentation(2e-6), Load::Force(0.5e-3)] {
                    check(numbers, load);
                }
            }
        }
    }

    /// A film on an elastic base, and a lens on a rigid one.
    #[test]
    #[ignore = "slow: derivatives by every layer, for all lenses"]
    fn derivatives_by_layers_are_those_of_differences() {
        let films = Numbers {
            thickness: [60e-6, 300e-6],
            ..NUMBERS
        };
        check(films, Load::Indentation(2e-6));
        let adhesive = Numbers {
            work: 50e-3,
            shape: "paraboloid",
            ..films
        };
        check(adhesive, Load::Force(0.5e-3));
        let punch = Numbers {
            shape: "punch",
            radius: 50e-6,
            ..films
        };
        check(punch, Load::Force(0.1e-3));
    }

    /// H. Hertz: `F = 4/3 E* sqrt(R) zeta^(3/2)`, `A = pi R zeta`.
    #[test]
    fn derivatives_of_hertz_are_exact() {
        let numbers = Numbers {
            shape: "paraboloid",
            ..NUMBERS
        };
        let run = Run::default();
        let found = numbers.system().gradient(Load::Indentation(2e-6), &run);
        let found = found.unwrap();
        let [force, area] = [&found.force, &found.area].map(|it| it.clone().unwrap());
        let whole = numbers.system().reduced_modulus();
        let [lens, substrate] = [numbers.lens, numbers.substrate];
        let of = |body: Material| {
            let part = whole * body.plane_strain_compliance();
            let by_ratio = whole * 2.0 * body.poisson_ratio / body.young_modulus;
            [part / body.young_modulus, by_ratio]
        };
        for (quantity, expected) in [
            (Quantity::LensRadius, 0.5 / numbers.radius),
            (Quantity::LensYoungModulus, of(lens)[0]),
            (Quantity::LensPoissonRatio, of(lens)[1]),
            (Quantity::SubstrateYoungModulus, of(substrate)[0]),
            (Quantity::SubstratePoissonRatio, of(substrate)[1]),
        ] {
            let relative = force.by(quantity).unwrap() / found.contact.force;
            assert!((relative / expected - 1.0).abs() < 1e-11, "{quantity:?}");
        }
        let expected = PI * 2e-6;
        assert!((area.by(Quantity::LensRadius).unwrap() / expected - 1.0).abs() < 1e-9);
        assert!(area.by(Quantity::LensYoungModulus).unwrap().abs() < 1e-20);
        let stiffness = found.contact.stiffness;
        assert!((found.stiffness / stiffness - 1.0).abs() < 1e-15);
    }

    #[test]
    fn nothing_touched_has_no_gradient() {
        let run = Run::default();
        let refused = NUMBERS.system().gradient(Load::Force(0.0), &run);
        assert!(matches!(refused, Err(SolveError::NoGradient { .. })));
        let refused = NUMBERS.system().gradient(Load::FloorContact, &run);
        assert_eq!(refused.unwrap_err(), SolveError::NoFloor);
    }
}
