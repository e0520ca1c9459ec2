//! Derivatives of contacts with height maps, against differences of the same solution and closed forms.

use fakir::problem::pattern::{Pattern, PillarShape};
use fakir::problem::{
    Adhesion, Base, Boundary, Floor, Grid, HeightMap, Indenter, LatticeForm, Layer, Lens,
    LensShape, Load, Material, PlaneLattice, Quantity, ShapedLens, SurfaceSystem,
};
use fakir::state::{Gradient, Run, SolveError, SurfaceContact};

const RUBBER: Material = Material {
    young_modulus: 2e6,
    poisson_ratio: 0.4,
};

/// The numbers by which derivatives are taken.
#[derive(Clone, Copy)]
struct Numbers {
    lens: Material,
    substrate: Material,
    radius: f64,
    /// Layers of substrate and lens, if any.
    layers: [Option<Layer>; 2],
}

impl Numbers {
    const COMMON: Self = Self {
        lens: Material {
            young_modulus: 3e6,
            poisson_ratio: 0.45,
        },
        substrate: RUBBER,
        radius: 0.4e-3,
        layers: [None, None],
    };

    /// A film on a stiffer base, as thick as the pillars are wide, under a lens on glass.
    fn on_layers() -> Self {
        let base = Material::new(20e6, 0.3);
        Self {
            layers: [
                Some(Layer {
                    thickness: 8e-6,
                    base: Base::Elastic(base),
                }),
                Some(Layer::new(40e-6)),
            ],
            ..Self::COMMON
        }
    }

    fn layer(&mut self, body: usize) -> &mut Layer {
        self.layers[body].as_mut().expect("a layer")
    }

    fn base(&mut self) -> &mut Material {
        match &mut self.layer(0).base {
            Base::Elastic(base) => base,
            other => panic!("{other:?}"),
        }
    }

    fn of(&mut self, quantity: Quantity) -> &mut f64 {
        match quantity {
            Quantity::LensRadius => &mut self.radius,
            Quantity::LensYoungModulus => &mut self.lens.young_modulus,
            Quantity::LensPoissonRatio => &mut self.lens.poisson_ratio,
            Quantity::SubstrateYoungModulus => &mut self.substrate.young_modulus,
            Quantity::SubstratePoissonRatio => &mut self.substrate.poisson_ratio,
            Quantity::SubstrateThickness => &mut self.layer(0).thickness,
            Quantity::LensThickness => &mut self.layer(1).thickness,
            Quantity::SubstrateBaseYoungModulus => &mut self.base().young_modulus,
            Quantity::SubstrateBasePoissonRatio => &mut self.base().poisson_ratio,
            other => panic!("{other}"),
        }
    }
}

/// Round pillars that shorten, and the floor between them.
fn pillars(numbers: Numbers, boundary: Boundary) -> SurfaceSystem {
    let grid = Grid::centred(96, 96, 1e-6).expect("a grid");
    let lattice = PlaneLattice::new(LatticeForm::Square { pitch: 24e-6 });
    let map = Pattern::new(PillarShape::cylinder(8e-6, 1e-6), lattice)
        .height_map(&grid, &numbers.substrate)
        .expect("pillars");
    let shape = LensShape::Sphere {
        radius: numbers.radius,
    };
    let lens = ShapedLens::new(shape, numbers.lens);
    SurfaceSystem::new(lens.into(), numbers.substrate, map, boundary)
        .expect("bodies")
        .with_layers(numbers.layers[0], numbers.layers[1])
        .expect("layers")
        .with_round_tops(8e-6)
        .expect("a diameter")
        .with_floor(Floor::OffPillars)
}

/// Derivatives of force or indentation equal central differences, on tops and floor together.
#[test]
fn derivatives_are_those_of_differences() {
    check_differences(Numbers::COMMON, 5, Boundary::FreeSpace);
    check_differences(Numbers::COMMON, 5, Boundary::Periodic);
}

/// The same on layers, with the derivatives by both thicknesses and the base.
#[test]
fn derivatives_on_layers_are_those_of_differences() {
    check_differences(Numbers::on_layers(), 9, Boundary::FreeSpace);
}

#[test]
#[ignore = "slow: many contacts on periodic layers"]
fn derivatives_on_periodic_layers_are_those_of_differences() {
    check_differences(Numbers::on_layers(), 9, Boundary::Periodic);
}

fn check_differences(numbers: Numbers, count: usize, boundary: Boundary) {
    const STEP: f64 = 1e-5;
    let run = Run::default();
    let loads = match boundary {
        Boundary::FreeSpace => [Load::Indentation(3e-6), Load::Force(60e-6)],
        Boundary::Periodic => [Load::Indentation(0.4e-6), Load::Force(60e-6)],
    };
    for load in loads {
        let value = |numbers: Numbers| {
            let found = pillars(numbers, boundary)
                .press(load, &run)
                .expect("a contact");
            match load {
                Load::Force(_) => found.indentation,
                _ => found.force,
            }
        };
        let gradient: Gradient<SurfaceContact> = pillars(numbers, boundary)
            .gradient(load, &run)
            .expect("a gradient");
        if let (Boundary::FreeSpace, Load::Indentation(_)) = (boundary, load) {
            let shares = gradient.contact.shares.expect("a floor");
            assert!(shares.floor.force > 0.0 && shares.tops.force > 0.0);
        }
        let by = gradient.force.as_ref().or(gradient.indentation.as_ref());
        let by = by.expect("one of them");
        assert_eq!(by.quantities.len(), count);
        for (quantity, derivative) in &by.quantities {
            let shifted = |sign: f64| {
                let mut numbers = numbers;
                *numbers.of(*quantity) *= 1.0 + sign * STEP;
                value(numbers)
            };
            let mut numbers = numbers;
            let step = 2.0 * STEP * *numbers.of(*quantity);
            let expected = (shifted(1.0) - shifted(-1.0)) / step;
            let away = (derivative / expected - 1.0).abs();
            println!("{boundary:?} {load:?} {quantity}: {derivative:e} {away:e}");
            assert!(
                away < 2e-3,
                "{boundary:?} {load:?} {quantity}: {derivative:e} {expected:e}"
            );
        }
    }
}

/// Hertz: F = 4/3 E* sqrt(R) zeta^(3/2) (Johnson 1985, eq. 4.22), so that dF/dR = F/(2R), dF/dzeta = 3F/(2 zeta), and the moduli of equal bodies share F.
#[test]
fn derivatives_of_a_sphere_on_a_flat_map_are_those_of_hertz() {
    let run = Run::default();
    let flat = HeightMap::from_height(Grid::centred(96, 96, 1e-6).expect("a grid"), |_| 0.0);
    let lens = Lens {
        radius: 1e-3,
        material: RUBBER,
    };
    let flat = flat.expect("heights");
    let system =
        SurfaceSystem::new(lens.into(), RUBBER, flat, Boundary::FreeSpace).expect("bodies");
    let depth = 1.5e-6;
    let gradient = system
        .gradient(Load::Indentation(depth), &run)
        .expect("a gradient");
    let force = gradient.contact.force;
    let by = gradient.force.expect("it is not prescribed");
    let half = 0.5 * force / RUBBER.young_modulus;
    for quantity in [Quantity::LensYoungModulus, Quantity::SubstrateYoungModulus] {
        let away = by.by(quantity).expect("a modulus") / half - 1.0;
        assert!(away.abs() < 1e-9, "{away:e}");
    }
    // One per cent: cells of a fortieth of the contact radius.
    let away = by.by(Quantity::LensRadius).expect("a sphere") / (0.5 * force / 1e-3) - 1.0;
    assert!(away.abs() < 0.02, "{away:e}");
    let away = gradient.stiffness / (1.5 * force / depth) - 1.0;
    assert!(away.abs() < 0.02, "{away:e}");
}

#[test]
fn what_has_no_derivatives_is_refused_with_a_reason() {
    let run = Run::default();
    let load = Load::Indentation(1e-6);
    let whole = || pillars(Numbers::COMMON, Boundary::FreeSpace);
    let why = |system: SurfaceSystem, load: Load| {
        system
            .gradient(load, &run)
            .expect_err("no derivatives")
            .to_string()
    };
    let adhesive = whole().with_adhesion(Adhesion::new(1e-3)).expect("a work");
    assert!(why(adhesive, load).contains("adhesion"));
    assert!(why(whole(), Load::FloorContact).contains("critical state"));
    let plate = Indenter::Flat(None);
    let flat = HeightMap::from_height(Grid::centred(16, 16, 1e-6).expect("a grid"), |_| 0.0);
    let flat = flat.expect("heights");
    let system = SurfaceSystem::new(plate, RUBBER, flat, Boundary::FreeSpace).expect("bodies");
    let refused = system.gradient(Load::Force(0.0), &run);
    assert!(matches!(refused, Err(SolveError::NoGradient { .. })));
}
