//! One pillar whose top varies from much smaller to much larger than the contact, compared with closed forms: the flat punch, the contact
//! inside the top, and the contact pinned at the rim, with adhesion and on layers.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};
use fakir::problem::{
    Accuracy, Adhesion, Base, CyclePlan, FlatSystem, FloorModel, Layer, Lens, LensShape,
    ListedPillar, Load, LoadingMode, Material, Method, Pillar, PillarCompliance, PillarList,
    PillarPattern, ShapedLens, System, UnloadingPoint,
};
use fakir::state::{ContactState, Cycle, PillarStatus, Run, Solution, Termination};
use fakir::theory::adhesion::{
    AdhesiveSphere, adhesive_sphere, adhesive_sphere_at_indentation, sphere_pull_off_by_force,
};
use fakir::theory::layer::Layers;

/// One pillar under a lens, without a column.
fn one_pillar(lens: ShapedLens, substrate: Material, diameter: f64, centre: [f64; 2]) -> System {
    let pillar = Pillar {
        diameter,
        height: 0.1 * diameter,
        compliance: PillarCompliance::None,
    };
    let listed = ListedPillar {
        centre,
        diameter,
        height: pillar.height,
    };
    let list = PillarList::new(vec![listed]).unwrap();
    System::new(lens, substrate, PillarPattern::new(pillar, list)).unwrap()
}

/// A number between two bounds, uniformly distributed in its logarithm.
fn between(random: &mut ChaCha8Rng, [low, high]: [f64; 2]) -> f64 {
    let part = random.next_u32() as f64 / f64::from(u32::MAX);
    low * (high / low).powf(part)
}

const LENS: f64 = 2e-3;
const RUBBER: Material = Material {
    young_modulus: 1e6,
    poisson_ratio: 0.5,
};

fn adhesive(diameter: f64, work: f64, centre: [f64; 2]) -> System {
    let lens = Lens {
        radius: LENS,
        material: Material::new(70e9, 0.2),
    };
    let system = one_pillar(lens.into(), RUBBER, diameter, centre);
    system.with_adhesion(Adhesion::new(work)).unwrap()
}

fn cycle(system: &System, depth: f64, drive: LoadingMode) -> Cycle {
    let plan = CyclePlan {
        turn: UnloadingPoint::Indentation(depth),
        drive,
        ..CyclePlan::default()
    };
    let cycle = fakir::cycle(system, plan, Method::default(), &Run::default()).unwrap();
    assert!(cycle.converged());
    cycle
}

/// The contact at an indentation during loading: JKR inside the top, and pinned at the rim beyond. The lens is approximated by a
/// paraboloid.
fn exact(modulus: f64, work: f64, radius: f64, indentation: f64) -> AdhesiveSphere {
    let rim = adhesive_sphere(modulus, LENS, work, radius);
    if indentation <= rim.indentation {
        let inside = adhesive_sphere_at_indentation(modulus, LENS, work, indentation).unwrap();
        return inside.unwrap();
    }
    AdhesiveSphere {
        force: rim.force + 2.0 * radius * modulus * (indentation - rim.indentation),
        ..rim
    }
}

/// K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301 (1971), pinned at the rim of the top.
#[test]
fn a_top_wider_than_an_adhesive_contact() {
    let mut random = ChaCha8Rng::seed_from_u64(44);
    for number in 0..100 {
        let work = between(&mut random, [1e-4, 0.2]);
        let modulus = adhesive(1e-6, work, [0.0; 2]).reduced_modulus();
        let natural = sphere_pull_off_by_force(modulus, LENS, work).radius;
        let radius = natural * between(&mut random, [0.01, 20.0]);
        if radius > 0.02 * LENS {
            continue;
        }
        let system = adhesive(2.0 * radius, work, [0.0; 2]);
        let depth = natural * natural / LENS * between(&mut random, [0.05, 20.0]);
        let depth = depth.min(0.05 * radius);
        let expected = exact(modulus, work, radius, depth);
        let control = Load::Indentation(depth);
        let contact = fakir::press(&system, control, Method::default(), &Run::default()).unwrap();
        assert_eq!(contact.termination, Termination::Converged);
        let scale = expected.force.abs().max(work * LENS);
        // A sphere differs from a paraboloid by the square of the slope.
        let allowed = contact.error.force + 5.0 * (expected.radius / LENS).powi(2) + 1e-5;
        let off = (contact.force - expected.force).abs() / scale;
        assert!(
            off < allowed,
            "{number}: R_top {radius:e}, {depth:e}: {:e} {:e}, {off:e} beside {allowed:e}",
            contact.force,
            expected.force
        );
        assert!((contact.contact_radius / expected.radius - 1.0).abs() < 1e-4 + allowed);
    }
}

/// The pull-off force does not depend on the loading mode, and approaches that of a sphere on a flat surface if the top is wider than that
/// contact.
#[test]
fn the_pull_off_of_a_wide_top_is_that_of_a_sphere() {
    let work = 50e-3;
    for diameter in [20e-6, 60e-6, 100e-6, 160e-6, 200e-6, 300e-6, 1e-3] {
        let system = adhesive(diameter, work, [0.0; 2]);
        let modulus = system.reduced_modulus();
        let natural = sphere_pull_off_by_force(modulus, LENS, work);
        let radius = (0.5 * diameter).min(natural.radius);
        let expected = adhesive_sphere(modulus, LENS, work, radius).force;
        for drive in [
            LoadingMode::Displacement,
            LoadingMode::Force,
            LoadingMode::Machine(10.0),
        ] {
            let cycle = cycle(&system, 1e-6, drive);
            let pull = cycle.pull_off.as_ref().unwrap();
            let off = (pull.force / expected - 1.0).abs();
            // A sphere differs from a paraboloid by the square of the slope.
            let error = cycle.errors.pull_off_force.numerical() + (radius / LENS).powi(2);
            assert!(off < error, "{diameter:e} {drive:?}: {off:e}, {error:e}");
        }
        let cycle = cycle(&system, 1e-6, LoadingMode::Displacement);
        let certificate = cycle.certificate().unwrap();
        assert!(certificate < 1e-2, "{diameter:e}: {certificate:e}");
        // The last contact is that from which a sphere detaches at this indentation, unless the rim detaches earlier.
        let last = (0.5 * diameter).min(natural.radius / 9f64.cbrt());
        let expected = adhesive_sphere(modulus, LENS, work, last).indentation;
        let separation = cycle.separation.unwrap();
        assert!((separation / expected - 1.0).abs() < 1e-3, "{diameter:e}");
    }
}

/// The force at an indentation, and the pull-off force, vary continuously while the top grows past the contact.
#[test]
fn the_diameter_may_pass_the_contact() {
    let work = 10e-3;
    let modulus = adhesive(1e-6, work, [0.0; 2]).reduced_modulus();
    let depth = 0.2e-6;
    let contact = adhesive_sphere_at_indentation(modulus, LENS, work, depth)
        .unwrap()
        .unwrap();
    let force = |part: f64| {
        let system = adhesive(2.0 * part * contact.radius, work, [0.0; 2]);
        let control = Load::Indentation(depth);
        fakir::press(&system, control, Method::default(), &Run::default()).unwrap()
    };
    let [smaller, larger] = [0.99, 1.01].map(force);
    assert_eq!(smaller.pillars[0].status, PillarStatus::Full);
    assert_eq!(larger.pillars[0].status, PillarStatus::Partial);
    let pinned = exact(modulus, work, 0.99 * contact.radius, depth).force;
    assert!(
        (smaller.force / pinned - 1.0).abs() < 5e-3,
        "{} {pinned}",
        smaller.force
    );
    assert!((larger.force / contact.force - 1.0).abs() < 5e-3);
    let far = force(30.0);
    assert!((far.force / larger.force - 1.0).abs() < 1e-6);
}

/// The lens axis may be at any position on the top.
#[test]
fn an_adhesive_contact_anywhere_inside_a_top() {
    let (work, depth) = (10e-3, 0.2e-6);
    let pressed = |centre| {
        let control = Load::Indentation(depth);
        let system = adhesive(400e-6, work, centre);
        fakir::press(&system, control, Method::default(), &Run::default()).unwrap()
    };
    let [middle, beside] = [[0.0; 2], [60e-6, -50e-6]].map(pressed);
    assert!((middle.force / beside.force - 1.0).abs() < 1e-9);
    let centre = beside.fields.as_ref().unwrap();
    let expected = middle.fields.as_ref().unwrap().pressure([0.0; 2]);
    assert!((centre.pressure([0.0; 2]) / expected - 1.0).abs() < 1e-6);
    let system = adhesive(400e-6, work, [60e-6, -50e-6]);
    let cycle = cycle(&system, depth, LoadingMode::Displacement);
    let pull = cycle.pull_off.as_ref().unwrap().force;
    let expected = sphere_pull_off_by_force(system.reduced_modulus(), LENS, work).force;
    assert!((pull / expected - 1.0).abs() < 1e-3, "{pull} {expected}");
}

/// A larger work of adhesion during unloading pins the contact until its edge reaches it.
#[test]
fn a_contact_inside_a_top_is_pinned_where_the_works_differ() {
    let (advancing, receding, depth) = (2e-3, 40e-3, 0.5e-6);
    let adhesion = Adhesion {
        work_receding: Some(receding),
        ..Adhesion::new(advancing)
    };
    let system = adhesive(600e-6, advancing, [0.0; 2])
        .with_adhesion(adhesion)
        .unwrap();
    let modulus = system.reduced_modulus();
    let cycle = cycle(&system, depth, LoadingMode::Displacement);
    let turn = adhesive_sphere_at_indentation(modulus, LENS, advancing, depth)
        .unwrap()
        .unwrap();
    let off = (cycle.turn.force / turn.force - 1.0).abs();
    assert!(off < 1e-3, "{off:e}");
    // Pinned at the largest radius, if this is smaller than that of the free pull-off, until it detaches.
    let natural = sphere_pull_off_by_force(modulus, LENS, receding);
    let radius = turn.radius.min(natural.radius);
    let expected = adhesive_sphere(modulus, LENS, receding, radius).force;
    let pull = cycle.pull_off.as_ref().unwrap().force;
    assert!((pull / expected - 1.0).abs() < 1e-3, "{pull} {expected}");
    assert!(cycle.certificate().unwrap() < 1e-2);
}

/// A lens axis at such a distance from the centre of the top, in its radii, that the disc first reaches the rim on one side. From there on
/// there are fronts.
fn beside(part: f64, work: f64) -> System {
    adhesive(2.0 * TOP, work, [part * TOP, 0.0])
}

const TOP: f64 = 30e-6;

/// Whether a force differs from another by less than its stated error, or is not a valid result.
#[track_caller]
fn covered(contact: &ContactState, expected: f64, margin: f64) -> bool {
    let off = (contact.force - expected).abs();
    let stated = contact.error.force * contact.force.abs();
    assert!(
        off <= stated + margin || !contact.is_answer(),
        "{:e} for {expected:e}: {off:e} beside {stated:e}",
        contact.force
    );
    contact.is_answer()
}

/// The contact without adhesion is solved on nodes; for this small adhesion, the force is the same. Axes are on the top, at its rim and
/// outside.
#[test]
fn a_disc_that_comes_to_the_rim_on_one_side_states_its_error() {
    const WORK: f64 = 1e-7;
    let run = Run::default();
    let mut answers = 0;
    for part in [0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0, 1.1, 1.6] {
        let at_rim = ((1.0 - part) * TOP).powi(2);
        for times in [1.02, 1.1, 1.7, 4.0, 16.0] {
            let depth = if part < 1.0 {
                times * at_rim / LENS
            } else {
                0.5 * at_rim / LENS + times * 10e-9
            };
            let load = Load::Indentation(depth.min(0.6e-6));
            let accurate = Method::Spectral(Accuracy::Accurate);
            let without = fakir::press(&beside(part, 0.0), load, accurate, &run).unwrap();
            let with = fakir::press(&beside(part, WORK), load, Method::default(), &run).unwrap();
            let margin = without.error.force * without.force + 10.0 * WORK * LENS;
            answers += usize::from(covered(&with, without.force, margin));
        }
    }
    println!("{answers} answers");
    assert!(answers > 22, "{answers}");
}

/// Expected: Hertz's radius, where the contact on a top of 100 um exceeds the rim by less than 1 um on one side.
#[test]
fn the_radius_of_a_disc_that_comes_to_the_rim_states_its_error() {
    let rubber = Material::new(2e6, 0.5);
    for [offset, indentation] in [[25e-6, 0.3e-6], [25e-6, 0.31e-6], [30e-6, 0.2e-6]] {
        let lens = ShapedLens::new(LensShape::Sphere { radius: 2.2e-3 }, rubber);
        let system = one_pillar(lens, rubber, 1e-4, [offset, 0.0]);
        for accuracy in [Accuracy::Default, Accuracy::Accurate] {
            let load = Load::Indentation(indentation);
            let method = Method::Spectral(accuracy);
            let found = fakir::press(&system, load, method, &Run::default()).unwrap();
            let expected = (2.2e-3 * indentation).sqrt();
            let off = (found.contact_radius - expected).abs();
            println!("{offset:e} {off:e} {:e}", found.contact_radius_error);
            assert!(off <= found.contact_radius_error + 1e-3 * expected);
            assert!(found.contact_radius_error < 0.35 * expected);
        }
    }
}

/// At the rim the force is still that of the disc (K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301 (1971)).
#[test]
fn an_adhesive_disc_that_reaches_the_rim_on_one_side_states_its_error() {
    let run = Run::default();
    let mut answers = 0;
    for work in [1e-5, 3e-4, 1e-3, 5e-3] {
        for part in [0.1, 0.2, 0.4, 0.6, 0.8, 0.9] {
            let system = beside(part, work);
            let modulus = system.reduced_modulus();
            let at_rim = adhesive_sphere(modulus, LENS, work, (1.0 - part) * TOP);
            if at_rim.indentation <= 0.0 {
                continue;
            }
            for beyond in [1e-12, 1e-10] {
                let load = Load::Indentation(at_rim.indentation + beyond);
                let contact = fakir::press(&system, load, Method::default(), &run).unwrap();
                // The disc grows slightly further, and a sphere is not a paraboloid.
                let margin = 1e-3 * at_rim.force.abs() + 4.0 * modulus * TOP * beyond;
                answers += usize::from(covered(&contact, at_rim.force, margin));
            }
            // During unloading it is the same disc, independent of its previous growth.
            let natural = sphere_pull_off_by_force(modulus, LENS, work);
            if natural.radius < 0.9 * (1.0 - part) * TOP {
                let cycle = cycle(&system, 1.1 * at_rim.indentation, LoadingMode::Displacement);
                if !cycle.is_answer() {
                    continue;
                }
                let pull = cycle.pull_off.as_ref().unwrap().force;
                let error = &cycle.errors.pull_off_force;
                let stated = error.numerical() + error.model();
                let off = (pull / natural.force - 1.0).abs();
                assert!(off < stated + 1e-3, "{work} {part}: {off} {stated}");
            }
        }
    }
    println!("{answers} answers");
    assert!(answers > 10, "{answers}");
}

fn layered(diameter: f64, layer: Option<Layer>) -> System {
    let lens = ShapedLens::new(
        LensShape::Paraboloid { radius: LENS },
        Material::new(70e9, 0.2),
    );
    let system = one_pillar(lens, RUBBER, diameter, [0.0; 2]);
    system.with_layers(layer, None).unwrap()
}

/// A lens on a film, compared with the integral equation of the axisymmetric contact.
#[test]
fn a_top_of_any_width_on_a_layer() {
    press_onto_layers(0..10);
}

#[test]
#[ignore = "slow: 90 more layers, tops and contacts"]
fn many_tops_of_any_width_on_layers() {
    press_onto_layers(10..100);
}

fn press_onto_layers(numbers: std::ops::Range<u64>) {
    for number in numbers {
        let mut random = ChaCha8Rng::seed_from_u64(number);
        let contact = between(&mut random, [5e-6, 60e-6]);
        let thickness = contact * between(&mut random, [0.3, 30.0]);
        let base = match number % 3 {
            0 => Base::Rigid,
            1 => Base::Frictionless,
            _ => Base::Elastic(Material::new(3e6, 0.4)),
        };
        let layer = Layer { thickness, base };
        let layers = Layers::new([(Material::new(70e9, 0.2), None), (RUBBER, Some(layer))]);
        // The top is at most four times as wide as the layer is thick.
        let radius = contact * between(&mut random, [0.05, 20.0]);
        let radius = radius.min(1.99 * thickness);
        let (inside, rim) = (layers.sphere(LENS, contact), layers.sphere(LENS, radius));
        let expected = if radius > contact {
            inside.force
        } else {
            let stiffness = layers.flat_punch_stiffness(radius);
            rim.force + stiffness * (inside.indentation - rim.indentation)
        };
        let system = layered(2.0 * radius, Some(layer)).with_floor(FloorModel::Ignored);
        let control = Load::Indentation(inside.indentation);
        let found = fakir::press(&system, control, Method::default(), &Run::default()).unwrap();
        assert!(found.converged());
        let off = (found.force / expected - 1.0).abs();
        let allowed = found.error.force + 1e-6;
        assert!(
            off < allowed,
            "{number}: top {:.2}, layer {:.2} of {contact:e}: {off:e} beside {allowed:e}",
            radius / contact,
            thickness / contact
        );
        assert!(allowed < 0.05, "{number}: {allowed}");
        if radius > contact && number % 4 == 0 {
            assert!((found.contact_radius / contact - 1.0).abs() < allowed);
            // The force results in the same indentation.
            let control = Load::Force(found.force);
            let back = fakir::press(&system, control, Method::default(), &Run::default()).unwrap();
            assert!((back.indentation / inside.indentation - 1.0).abs() < 1e-6);
        }
    }
}

/// Layers that are much thicker than the contact are equivalent to half-spaces, and the floor is reached inside the top in the same way.
#[test]
fn a_thick_layer_is_a_half_space() {
    let critical = |layer| {
        let system = layered(60e-6, layer);
        fakir::transition(&system, Method::default(), &Run::default()).unwrap()
    };
    let half_space = critical(None).contact;
    let thick = critical(Some(Layer::new(1.0))).contact;
    assert!((thick.force / half_space.force - 1.0).abs() < 1e-3);
    let pressed = |layer| {
        let control = Load::Indentation(20e-9);
        let system = layered(60e-6, layer);
        fakir::press(&system, control, Method::default(), &Run::default()).unwrap()
    };
    let [half_space, thick] = [None, Some(Layer::new(1.0))].map(pressed);
    assert!((thick.force / half_space.force - 1.0).abs() < 1e-4);
    let fields = thick.fields.as_ref().unwrap();
    let edge = [0.5 * thick.contact_radius, 0.0];
    assert!(fields.gap(edge).abs() < 1e-6 * thick.indentation);
}

/// A disc inside a wide top on a film is the contact of the same lens with the flat film, which is another solver.
#[test]
fn a_disc_inside_a_top_on_a_film_is_that_on_the_flat_film() {
    let film = || Some(Layer::new(150e-6));
    let system = adhesive(600e-6, 50e-3, [0.0; 2])
        .with_layers(film(), None)
        .unwrap();
    let flat = FlatSystem::new(system.lens().clone(), RUBBER).unwrap();
    let flat = flat.with_layers(film(), None).unwrap();
    let flat = flat.with_adhesion(Adhesion::new(50e-3)).unwrap();
    let plan = CyclePlan {
        turn: UnloadingPoint::Indentation(1e-6),
        ..CyclePlan::default()
    };
    let expected = flat.cycle(&plan, &Run::default()).unwrap();
    let found = cycle(&system, 1e-6, LoadingMode::Displacement);
    let near = |one: f64, other: f64| {
        assert!((one / other - 1.0).abs() < 1e-5, "{one:e} {other:e}");
    };
    near(found.turn.force, expected.turn.force);
    near(found.turn.contact_radius, expected.turn.contact_radius);
    let pull_off = |force: Option<f64>| force.expect("a pull");
    near(
        pull_off(found.pull_off.as_ref().map(|pull| pull.force)),
        pull_off(expected.pull_off.map(|pull| pull.force)),
    );
    // As on half-spaces: the steps of the path.
    assert!(found.certificate().unwrap() < 2e-3);
}
