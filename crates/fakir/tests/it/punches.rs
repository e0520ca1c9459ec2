//! Flat punches on pillars, on rounded tops and on height maps; and height maps whose floor is ignored.

use fakir::problem::{
    Accuracy, Adhesion, Arrangement, Asperity, AsperityArray, Boundary, CyclePlan, Floor,
    FloorModel, Grid, HeightMap, HexagonalLattice, Indenter, LatticeForm, LensShape, ListedPillar,
    Load, Material, Method, Pillar, PillarCompliance, PillarList, PillarPattern, PlaneLattice,
    Requirement, ShapedLens, SurfaceSystem, System, UnloadingPoint,
};
use fakir::state::{Run, SolveError, Warning};

const RUBBER: Material = Material {
    young_modulus: 2e6,
    poisson_ratio: 0.5,
};
const PILLAR: Pillar = Pillar {
    diameter: 6e-6,
    height: 2.2e-6,
    compliance: PillarCompliance::Column,
};
const PITCH: f64 = 20e-6;
/// Between the pillars at 2 and at the square root of 8 pitches.
const PUNCH: f64 = 50e-6;

fn pillars(shape: LensShape, arrangement: impl Into<Arrangement>) -> System {
    let lens = ShapedLens::new(shape, RUBBER);
    System::new(lens, RUBBER, PillarPattern::new(PILLAR, arrangement)).expect("a valid system")
}

fn punch() -> LensShape {
    LensShape::Punch { radius: PUNCH }
}

const PLATE: LensShape = LensShape::Plate {
    tilt: 0.0,
    direction: 0.0,
};

/// The pillars of a square lattice under the punch.
fn covered() -> Vec<[f64; 2]> {
    let indices = (-2..=2).flat_map(|i| (-2..=2).map(move |j| (i, j)));
    let near = indices.filter(|(i, j)| i * i + j * j <= 5);
    near.map(|(i, j)| [f64::from(i) * PITCH, f64::from(j) * PITCH])
        .collect()
}

fn list() -> PillarList {
    let one = |centre: [f64; 2]| ListedPillar {
        centre,
        height: PILLAR.height,
        diameter: PILLAR.diameter,
    };
    PillarList::new(covered().into_iter().map(one).collect()).expect("pillars apart")
}

fn lattice() -> PlaneLattice {
    PlaneLattice::new(LatticeForm::Square { pitch: PITCH })
}

/// Pillars beyond the punch are never touched: it is a plate on those that it covers, of an infinite and a finite lattice, turned or not, and of a list.
#[test]
fn a_punch_is_a_plate_on_the_pillars_that_it_covers() {
    let run = Run::default();
    let load = Load::Indentation(0.5e-6);
    let force = |system: &System| {
        fakir::press(system, load, Method::default(), &run)
            .expect("a contact")
            .force
    };
    let expected = force(&pillars(PLATE, list()));
    let turned = PlaneLattice {
        rotation: 0.3,
        ..lattice()
    };
    let finite = PlaneLattice {
        columns: Some(9),
        ..lattice()
    };
    for arrangement in [
        Arrangement::from(lattice()),
        turned.into(),
        finite.into(),
        list().into(),
    ] {
        let system = pillars(punch(), arrangement);
        let away = force(&system) / expected - 1.0;
        assert!(away.abs() < 1e-9, "{away:e}");
        // Positions are those of the arrangement.
        let state = fakir::press(&system, load, Method::default(), &run).expect("a contact");
        assert_eq!(state.pillars.len(), 21);
        for pillar in &state.pillars {
            let centre = system.arrangement().centre(pillar.index).expect("a pillar");
            let distance = (centre[0] - pillar.centre[0]).hypot(centre[1] - pillar.centre[1]);
            assert!(distance < 1e-12, "{distance:e}");
        }
    }
}

/// The pull-off of equal far pillars under a rigid constraint is below the sum of Kendall's forces, and equal to that of the plate.
#[test]
fn adhesion_gradients_and_verification_under_a_punch() {
    let run = Run::default();
    let plan = CyclePlan {
        turn: UnloadingPoint::Indentation(0.3e-6),
        ..CyclePlan::default()
    };
    let pull_off = |system: System| {
        let adhesive = system.with_adhesion(Adhesion::new(0.01)).expect("a work");
        let cycle = fakir::cycle(&adhesive, plan, Method::default(), &run).expect("a cycle");
        cycle.pull_off.expect("tension").force
    };
    let [of_punch, of_plate] = [pillars(punch(), lattice()), pillars(PLATE, list())].map(pull_off);
    assert!(
        (of_punch / of_plate - 1.0).abs() < 1e-9,
        "{of_punch} {of_plate}"
    );
    let system = pillars(punch(), lattice());
    let gradient = |system: &System| {
        let load = Load::Indentation(0.5e-6);
        let found = fakir::gradient(system, load, Method::default(), &run).expect("a gradient");
        (found.contact.force, found.force.expect("not prescribed"))
    };
    let (_, by) = gradient(&system);
    // The radius changes nothing until the edge reaches a pillar.
    assert_eq!(by.by(fakir::problem::Quantity::LensRadius), Some(0.0));
    let verified = fakir::verify(&system, Load::Indentation(0.5e-6), Default::default(), &run)
        .expect("elements");
    assert!(verified.agrees(), "{verified:?}");
}

/// An edge above a pillar, and a punch between pillars.
#[test]
fn a_punch_whose_edge_crosses_a_pillar_is_refused_with_the_next_radius() {
    let refused = |radius: f64, arrangement: Arrangement| {
        let lens = ShapedLens::new(LensShape::Punch { radius }, RUBBER);
        System::new(lens, RUBBER, PillarPattern::new(PILLAR, arrangement)).expect_err("an edge")
    };
    // Pillars at two pitches are crossed, and at 43 um those at the square root of five; below 3 um no pillar is covered.
    for (radius, expected) in [(41e-6, 5f64.sqrt() * PITCH + 3e-6), (2e-6, 3e-6)] {
        let invalid = refused(radius, lattice().into());
        let Requirement::OverWholePillars { next } = invalid.requirement else {
            panic!("{invalid}");
        };
        assert!((next - expected).abs() < 1e-12, "{next:e} {expected:e}");
    }
    let invalid = refused(PITCH, HexagonalLattice::new(PITCH).into());
    assert!(
        invalid.to_string().contains("crosses none, as 2.3"),
        "{invalid}"
    );
}

/// Summits beyond the punch are never touched.
#[test]
fn a_punch_on_rounded_tops_is_a_plate_on_those_that_it_covers() {
    let tops = |centres: &[[f64; 2]]| {
        let top = |centre: &[f64; 2]| Asperity {
            rim_radius: Some(3e-6),
            ..Asperity::new(*centre, 30e-6)
        };
        centres.iter().map(top).collect::<Vec<_>>()
    };
    let mut all = covered();
    all.extend([[4.0 * PITCH, 0.0], [0.0, -5.0 * PITCH]]);
    let under = |indenter: Indenter, centres: &[[f64; 2]]| {
        AsperityArray::new(indenter, RUBBER, tops(centres))
    };
    let of_punch = Indenter::from(ShapedLens::new(punch(), RUBBER));
    let field = under(of_punch.clone(), &all).expect("a field");
    let plate = under(Indenter::Flat(Some(RUBBER)), &covered()).expect("a field");
    assert_eq!(field, plate);
    let crossed = under(of_punch, &[[0.0, 0.0], [PUNCH, 0.0]]).expect_err("an edge");
    assert!(crossed.to_string().contains("crosses none"), "{crossed}");
}

fn map(cells: usize, side: f64, height: impl Fn([f64; 2]) -> f64) -> HeightMap {
    let grid = Grid::centred(cells, cells, side).expect("a grid");
    HeightMap::from_height(grid, height).expect("heights")
}

/// Force of a flat punch, 2 E* a d (Sneddon 1965, eq. 6.2), on cells that cover it to their size.
#[test]
fn a_punch_on_a_flat_map_is_that_of_sneddon() {
    let run = Run::default();
    let indenter = Indenter::from(ShapedLens::new(LensShape::Punch { radius: 10e-6 }, RUBBER));
    let flat = map(96, 0.25e-6, |_| 0.0);
    let system = SurfaceSystem::new(indenter, RUBBER, flat, Boundary::FreeSpace).expect("bodies");
    let contact = system
        .press(Load::Indentation(0.1e-6), &run)
        .expect("a contact");
    let sneddon = 2.0 * system.reduced_modulus() * 10e-6 * 0.1e-6;
    let away = (contact.force / sneddon - 1.0).abs();
    let error = contact.error.expect("an estimate").force;
    assert!(away < error && error < 0.05, "{away:e} {error:e}");
    assert!(contact.warnings.is_empty(), "{:?}", contact.warnings);
}

/// Kendall's flat punch, F = sqrt(8 pi w E* a^3) (J. Phys. D 4, 1186 (1971)), as a lens that ends and as a plate that is tilted by nearly nothing on a pillar.
#[test]
fn adhesive_cycles_under_flat_ends_are_those_of_kendall() {
    let run = Run::default();
    let radius: f64 = 10e-6;
    let work = 10e-3;
    let top = |[x, y]: [f64; 2]| if x.hypot(y) <= radius { 0.0 } else { -2e-6 };
    let tilted = LensShape::Plate {
        tilt: 1e-7,
        direction: 0.0,
    };
    for (shape, heights) in [
        (LensShape::Punch { radius }, map(48, 0.5e-6, |_| 0.0)),
        (tilted, map(48, 0.5e-6, top)),
    ] {
        let lens = Indenter::from(ShapedLens::new(shape, RUBBER));
        let system = SurfaceSystem::new(lens, RUBBER, heights, Boundary::FreeSpace);
        let system = system.expect("bodies").with_adhesion(Adhesion::new(work));
        let system = system.expect("a work");
        let plan = CyclePlan {
            turn: UnloadingPoint::Indentation(0.1e-6),
            ..CyclePlan::default()
        };
        let cycle = system.cycle(plan, &run).expect("a cycle");
        let square = 8.0 * std::f64::consts::PI * work * system.reduced_modulus();
        let kendall = -(square * radius.powi(3)).sqrt();
        let found = cycle.pull_off.expect("tension").force;
        let error = cycle.errors.expect("an estimate").pull_off_force;
        let away = (found / kendall - 1.0).abs();
        assert!(away < error && error < 0.2, "{away:e} {error:e}");
    }
}

/// Without its floor a map carries what the spectral method gives without it, and says that the floor is passed; above it nothing changes.
#[test]
fn the_floor_of_a_map_can_be_ignored() {
    let run = Run::default();
    let radius = 0.2e-3;
    let in_pillar = |[x, y]: [f64; 2]| {
        covered()
            .iter()
            .any(|centre| (x - centre[0]).hypot(y - centre[1]) <= 3e-6)
    };
    let height = 0.6e-6;
    let heights = map(240, 0.5e-6, |at| if in_pillar(at) { height } else { 0.0 });
    let lens = ShapedLens::new(LensShape::Sphere { radius }, RUBBER);
    let whole = SurfaceSystem::new(lens.into(), RUBBER, heights, Boundary::FreeSpace)
        .expect("bodies")
        .with_floor(Floor::AtOrBelow(0.5 * height));
    let without = whole.clone().with_floor_model(FloorModel::Ignored);
    let pressed = |system: &SurfaceSystem, indentation: f64| {
        let load = Load::Indentation(indentation);
        system.press(load, &run).expect("a contact")
    };
    // The lens touches the floor at 0.8 um.
    let [small, large] = [0.3e-6, 1.5e-6];
    let forces = [&without, &whole].map(|system| pressed(system, small).force);
    assert!((forces[0] / forces[1] - 1.0).abs() < 1e-9, "{forces:?}");
    let contact = pressed(&without, large);
    let passed =
        |warning: &Warning| matches!(warning, Warning::IgnoredFloor { depth } if *depth > 0.0);
    assert!(
        contact.warnings.iter().any(passed),
        "{:?}",
        contact.warnings
    );
    assert!(contact.force < pressed(&whole, large).force);
    let shares = contact.shares.expect("a floor");
    assert!(shares.floor.force.abs() + shares.floor.area.abs() < f64::MIN_POSITIVE);
    let pillar = Pillar {
        height,
        compliance: PillarCompliance::None,
        ..PILLAR
    };
    let list = covered().into_iter().map(|centre| ListedPillar {
        centre,
        height,
        diameter: pillar.diameter,
    });
    let list = PillarList::new(list.collect()).expect("pillars apart");
    let system = System::new(
        ShapedLens::new(LensShape::Sphere { radius }, RUBBER),
        RUBBER,
        PillarPattern::new(pillar, list),
    )
    .expect("a system")
    .with_floor(FloorModel::Ignored);
    let load = Load::Indentation(large);
    let spectral = Method::Spectral(Accuracy::Default);
    let expected = fakir::press(&system, load, spectral, &run).expect("a contact");
    let away = (contact.force / expected.force - 1.0).abs();
    // Tops of 12 cells that do not fit a disc.
    let error = contact.error.expect("an estimate").force;
    assert!(away < error && away < 0.03, "{away:e} {error:e}");
    // Which cells are floor must be known.
    let heights = map(16, 1e-6, |[x, _]| x);
    let unknown = SurfaceSystem::new(Indenter::Flat(None), RUBBER, heights, Boundary::FreeSpace)
        .expect("bodies")
        .with_floor_model(FloorModel::Ignored);
    let refused = unknown.press(load, &run).expect_err("no floor");
    assert!(matches!(refused, SolveError::NoFloor), "{refused}");
}
