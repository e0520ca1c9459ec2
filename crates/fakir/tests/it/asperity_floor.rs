//! Rounded tops and the floor in contact at the same time: closed forms, limits, derivatives, and boundary elements.

use fakir::problem::{
    Accuracy, Asperity, AsperityArray, FloorModel, Indenter, Layer, LensShape, ListedPillar, Load,
    Material, Method, Pillar, PillarCompliance, PillarList, PillarPattern, Point, ShapedLens,
    System,
};
use fakir::state::{AsperityContact, FloorContact, PillarStatus, Run};
use fakir::{Verdict, verify_asperities};
use std::f64::consts::PI;

/// A micrometre, and the unit of force for lengths in micrometres and a reduced modulus of 1 Pa.
const UM: f64 = 1e-6;
const FORCE: f64 = 1e-12;

/// Radius of the lens, and radius of curvature of the tops, in um.
const LENS: f64 = 1000.0;
const TOP: f64 = 100.0;

/// Position, radius of the pillar and height of a top, in um.
type Top = (Point, f64, f64);

fn lens() -> Indenter {
    let shape = LensShape::Paraboloid { radius: LENS * UM };
    ShapedLens::new(shape, Material::new(1e300, 0.0)).into()
}

/// A rigid paraboloid above tops, with a reduced modulus of 1 Pa.
fn array(depth: f64, tops: &[Top]) -> AsperityArray {
    let tops = tops.iter().map(|([x, y], rim, raised)| Asperity {
        rim_radius: Some(rim * UM),
        ..Asperity::new([x * UM, y * UM], TOP * UM).raised_by(raised * UM)
    });
    let array = AsperityArray::new(lens(), Material::new(1.0, 0.0), tops.collect());
    array.unwrap().with_floor(depth * UM).unwrap()
}

fn pressed(array: &AsperityArray, load: Load, accuracy: Accuracy) -> AsperityContact {
    let contact = array.press(load, accuracy, &Run::default()).unwrap();
    assert!(contact.converged(), "{:?}", contact.termination);
    contact
}

fn floor(contact: &AsperityContact) -> &FloorContact {
    contact.floor.as_ref().expect("a floor in contact")
}

const THREE: [Top; 3] = [
    ([9.0, 4.0], 12.0, 0.0),
    ([-24.0, 0.0], 12.0, 0.2),
    ([2.0, 33.0], 12.0, 0.0),
];

/// Expected: boundary elements on the height map of the same pillars, which share the half-space only, within both estimates.
fn check_with_boundary_elements(array: &AsperityArray, load: Load, cells: usize, least: f64) {
    let found = verify_asperities(array, load, cells, &Run::default()).unwrap();
    let share = found.floor_share.expect("a floor that carries load");
    let (of_discs, fine) = (floor(&found.discs), found.elements[1].floor.unwrap());
    println!(
        "{:?} {:?} {:?} {share:?}, share {:.5}, {} cells along a side",
        found.force, found.indentation, found.area, of_discs.share, fine.columns
    );
    assert_eq!(found.verdict(), Verdict::Agree);
    assert_eq!(found.discs.touched(), found.elements[1].touched());
    assert!(of_discs.share > least, "{}", of_discs.share);
    assert!(found.force.allowed < 0.03 && share.allowed < 0.08);
    let area = of_discs.area / fine.area - 1.0;
    assert!(area.abs() < of_discs.error.area + fine.error.area, "{area}");
}

/// All tops are filled.
#[test]
fn three_full_tops_and_the_floor_are_those_of_coarse_boundary_elements() {
    let array = array(1.5, &THREE);
    check_with_boundary_elements(&array, Load::Indentation(4.0 * UM), 32, 0.2);
    let force = pressed(&array, Load::Indentation(4.0 * UM), Accuracy::Default).force;
    check_with_boundary_elements(&array, Load::Force(force), 32, 0.2);
}

/// Tops as far from the axis as the lens would touch the floor.
#[test]
fn the_floor_among_tops_is_that_of_coarse_boundary_elements() {
    let places = [
        [0.0, 0.0],
        [42.0, 0.0],
        [-42.0, 0.0],
        [0.0, 42.0],
        [0.0, -42.0],
    ];
    let tops = places.map(|at| (at, 6.0, 0.0));
    let load = Load::Indentation(2.5 * UM);
    check_with_boundary_elements(&array(1.0, &tops), load, 32, 0.1);
}

const WIDE: [Top; 3] = [
    ([9.0, 4.0], 16.0, 0.0),
    ([-24.0, 0.0], 15.0, 0.2),
    ([2.0, 43.0], 16.0, 0.0),
];

/// Contacts are within the tops, off their centres, or at a rim.
#[test]
fn three_tops_in_part_and_the_floor_are_those_of_coarse_boundary_elements() {
    let found = pressed(
        &array(1.0, &WIDE),
        Load::Indentation(2.3 * UM),
        Accuracy::Default,
    );
    println!("{:?}", found.asperities);
    let states = found.asperities.iter().map(|top| top.status);
    assert!(
        states
            .filter(|status| *status == PillarStatus::Partial)
            .count()
            >= 2
    );
    check_with_boundary_elements(&array(1.0, &WIDE), Load::Indentation(2.3 * UM), 32, 0.05);
}

/// Pillars of the height of the floor that shorten, and a rubber lens.
fn shortening() -> AsperityArray {
    let rubber = Material::new(1.0, 0.3);
    let shape = LensShape::Sphere { radius: LENS * UM };
    let tops = array(1.5, &THREE).asperities().to_vec();
    let tops = tops.iter().map(|top| Asperity {
        // 4 h/(pi E d^2) of a cylinder.
        column_compliance: 4.0 * 1.5 / (PI * 24.0 * 24.0 * UM),
        ..*top
    });
    let lens = ShapedLens::new(shape, rubber).into();
    let array = AsperityArray::new(lens, rubber, tops.collect());
    array.unwrap().with_floor(1.5 * UM).unwrap()
}

#[test]
fn shortening_pillars_and_the_floor_are_those_of_boundary_elements() {
    check_with_boundary_elements(&shortening(), Load::Indentation(4.0 * UM), 32, 0.1);
}

#[test]
#[ignore = "slow: a film as thick as the pillars are wide"]
fn tops_and_the_floor_on_a_film_are_those_of_boundary_elements() {
    let film = shortening().with_layers(Some(Layer::new(24.0 * UM)), None);
    check_with_boundary_elements(&film.unwrap(), Load::Indentation(4.0 * UM), 32, 0.1);
}

#[test]
#[ignore = "slow: finer boundary elements, at more loads"]
fn tops_and_the_floor_are_those_of_boundary_elements() {
    for indentation in [3.0, 4.0, 5.0] {
        let load = Load::Indentation(indentation * UM);
        check_with_boundary_elements(&array(1.5, &THREE), load, 64, 0.02);
    }
    for indentation in [2.0, 2.3, 3.0] {
        let load = Load::Indentation(indentation * UM);
        check_with_boundary_elements(&array(1.0, &WIDE), load, 64, 0.01);
    }
}

/// Expected: Hertz's contact with the floor, `F = 4/3 E* sqrt(R) d^(3/2)` and `A = pi R d`, as the only top is not reached.
#[test]
fn the_floor_alone_is_that_of_hertz() {
    let array = array(1.0, &[([200.0, 0.0], 12.0, 0.0)]);
    let depth = 0.5;
    let load = Load::Indentation((1.0 + depth) * UM);
    for accuracy in [Accuracy::Default, Accuracy::Accurate] {
        let found = pressed(&array, load, accuracy);
        let force = found.force / (4.0 / 3.0 * LENS.sqrt() * depth.powf(1.5) * FORCE) - 1.0;
        let area = floor(&found).area / (PI * LENS * depth * UM * UM) - 1.0;
        let stiffness = found.slopes.force_with_indentation
            / (2.0 * (LENS * depth).sqrt() * UM * FORCE / UM / UM)
            - 1.0;
        println!(
            "{force:e} {area:e} {stiffness:e} {:?} {:?}",
            found.error,
            floor(&found).error
        );
        assert_eq!(floor(&found).share.to_bits(), 1f64.to_bits());
        assert!(force.abs() < found.error.unwrap().force && found.error.unwrap().force < 5e-3);
        assert!(area.abs() < floor(&found).error.area);
        assert!(stiffness.abs() < 0.02);
        assert_eq!(found.touched(), 0);
    }
    let force = 4.0 / 3.0 * LENS.sqrt() * depth.powf(1.5) * FORCE;
    let found = pressed(&array, Load::Force(force), Accuracy::Default);
    let error = found.error.unwrap().indentation;
    println!("{:e} {error:e}", found.indentation / UM - 1.5);
    assert!((found.indentation - 1.5 * UM).abs() < error && error < 0.005 * UM);
}

/// Expected: at the critical state the floor carries nothing; just past it the force exceeds that of the tops alone, and little.
#[test]
fn the_share_of_the_floor_begins_at_zero() {
    let array = array(1.5, &THREE);
    let critical = array
        .transition(Accuracy::Default, &Run::default())
        .unwrap()
        .contact;
    let mut last = f64::INFINITY;
    for past in [1e-1, 1e-2, 1e-3] {
        let load = Load::Indentation((1.0 + past) * critical.indentation);
        let found = pressed(&array, load, Accuracy::Default);
        let alone = array
            .press_quickly(load, Accuracy::Default, None, &Run::default())
            .unwrap();
        let share = floor(&found).share;
        let error = floor(&found).error.share;
        println!(
            "{past:e}: {share:e} ({error:e}), {:e} above the tops alone, {} cells",
            found.force / alone.force - 1.0,
            floor(&found).cells.len()
        );
        assert!(share < 0.5 * last && share < 0.5 * past + 0.02);
        assert!(found.force >= alone.force && found.force < (1.0 + share) * alone.force);
        last = share;
    }
    let load = Load::Indentation((1.0 - 1e-6) * critical.indentation);
    assert!(pressed(&array, load, Accuracy::Default).floor.is_none());
}

/// Just past the transition the floor is displaced by 1e-5 of the indentation: expected is convergence, with a force that begins with that of the
/// critical state and grows with the stiffness.
#[test]
fn the_floor_is_solved_where_its_load_is_small() {
    let run = Run::default();
    let rows = (0..9).map(|k| [f64::from(k % 3) - 1.0, f64::from(k / 3) - 1.0]);
    let tops: Vec<Top> = rows.map(|at| (at.map(|x| 25.0 * x), 4.0, 0.0)).collect();
    let array = array(2.2, &tops);
    let critical = array.transition(Accuracy::Default, &run).unwrap().contact;
    for past in [3e-5, 1e-4] {
        let load = Load::Indentation((1.0 + past) * critical.indentation);
        let found = pressed(&array, load, Accuracy::Default);
        let expected =
            critical.force + past * critical.indentation * critical.slopes.force_with_indentation;
        let off = found.force / expected - 1.0;
        let share = floor(&found).share;
        println!("{past:e} {off:e}, {share:e}");
        // The floor relieves the tops, whose stiffness changes in proportion to the indentation.
        assert!(off > 0.0 && off < share + past * past);
        assert!(share < past);
    }
}

/// Expected: the indentation under the force of a prescribed indentation is that indentation.
#[test]
fn derivatives_end_where_the_floor_carries_load() {
    let array = array(1.0, &[([200.0, 0.0], 12.0, 0.0), ([0.0, 10.0], 4.0, 0.0)]);
    let (load, run) = (Load::Indentation(1.6 * UM), Run::default());
    let refused = |array: &AsperityArray| array.gradient(load, Accuracy::Default, &run).err();
    let why = refused(&array).map(|error| error.to_string());
    assert!(why.is_some_and(|why| why.contains("the floor carries load")));
    let ignored = array.with_floor_model(FloorModel::Ignored);
    assert_eq!(refused(&ignored), None);
}

#[test]
fn a_prescribed_force_is_that_at_its_indentation() {
    let array = array(1.5, &THREE);
    let found = pressed(&array, Load::Indentation(4.0 * UM), Accuracy::Default);
    let again = pressed(&array, Load::Force(found.force), Accuracy::Default);
    let off = again.indentation / found.indentation - 1.0;
    println!(
        "{off:e} {:e} {:e}",
        floor(&again).share / floor(&found).share - 1.0,
        again.error.unwrap().indentation
    );
    assert_eq!(again.force.to_bits(), found.force.to_bits());
    assert!((again.indentation - found.indentation).abs() < again.error.unwrap().indentation);
    assert!((floor(&again).share / floor(&found).share - 1.0).abs() < floor(&again).error.share);
}

/// Expected: flat pillars, of which the tops are the limit of a large radius of curvature.
#[test]
fn tops_without_curvature_are_flat() {
    let depth = 0.8;
    let places = [[0.0, 0.0]];
    let rubber = Material::new(2e6, 0.5);
    let tops = places.map(|[x, y]| Asperity {
        rim_radius: Some(5.0 * UM),
        ..Asperity::new([x * UM, y * UM], 1.0)
    });
    let rounded = AsperityArray::new(lens(), rubber, tops.to_vec()).unwrap();
    let rounded = rounded.with_floor(depth * UM).unwrap();
    let pillars = places.map(|at| ListedPillar {
        centre: at.map(|x| x * UM),
        height: depth * UM,
        diameter: 10.0 * UM,
    });
    let pillar = Pillar {
        diameter: 10.0 * UM,
        height: depth * UM,
        compliance: PillarCompliance::None,
    };
    let list = PillarList::new(pillars.to_vec()).unwrap();
    let lens = lens().lens().unwrap().clone();
    let flat = System::new(lens, rubber, PillarPattern::new(pillar, list)).unwrap();
    for indentation in [2.0, 3.0] {
        let load = Load::Indentation(indentation * UM);
        let flat = fakir::press(&flat, load, Method::default(), &Run::default()).unwrap();
        let found = pressed(&rounded, load, Accuracy::Default);
        let [force, share] = [
            found.force / flat.force - 1.0,
            floor(&found).share / flat.floor.as_ref().unwrap().share - 1.0,
        ];
        println!(
            "{force:e} {:?} {:?}, {share:e} {:?} {:?}, share {}",
            found.error,
            flat.error,
            floor(&found).error,
            flat.floor.as_ref().unwrap().error,
            floor(&found).share
        );
        assert_eq!(found.asperities[0].status, PillarStatus::Full);
        assert!(force.abs() < found.error.unwrap().force + flat.error.force);
        assert!(share.abs() < floor(&found).error.share + flat.floor.as_ref().unwrap().error.share);
    }
}
