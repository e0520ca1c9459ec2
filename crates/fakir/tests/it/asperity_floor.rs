//! Rounded tops and the floor in contact at the same time: closed forms, limits, derivatives, and boundary elements.

use fakir::problem::{
    Accuracy, Asperity, AsperityArray, Boundary, Floor, FloorModel, Grid, HeightMap, Indenter,
    LensShape, ListedPillar, Load, Material, Method, Pillar, PillarCompliance, PillarList,
    PillarPattern, Point, ShapedLens, SurfaceSystem, System,
};
use fakir::state::{AsperityContact, FloorContact, PillarStatus, Run, SurfaceContact};
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

/// The same pillars as a height map with cells of a size in um.
fn on_cells(tops: &[Top], depth: f64, indentation: f64, half: f64, cell: f64) -> SurfaceContact {
    let count = (2.0 * half / cell) as usize;
    let grid = Grid::new(count, count, [cell * UM; 2], [-half * UM; 2]).unwrap();
    let height = |[x, y]: Point| {
        let heights = tops.iter().map(|([u, v], rim, raised)| {
            let away = (x / UM - u).hypot(y / UM - v);
            let top = raised - away * away / (2.0 * TOP);
            if away < *rim { top } else { -depth }
        });
        UM * heights.fold(-depth, f64::max)
    };
    let map = HeightMap::from_height(grid, height).unwrap();
    let highest = map.highest();
    let system = SurfaceSystem::new(lens(), Material::new(1.0, 0.0), map, Boundary::FreeSpace)
        .unwrap()
        .with_floor(Floor::AtOrBelow(-(depth - 1e-6) * UM));
    let load = Load::Indentation(indentation * UM + highest);
    system.press(load, &Run::default()).unwrap()
}

/// Expected: boundary elements on the height map of the same pillars, which share the half-space only, within both estimates.
fn check_with_boundary_elements(depth: f64, tops: &[Top], indentation: f64, cell: f64, least: f64) {
    let array = array(depth, tops);
    let load = Load::Indentation(indentation * UM);
    let found = pressed(&array, load, Accuracy::Default);
    let on_floor = floor(&found);
    let other = on_cells(tops, depth, indentation, 80.0, cell);
    let share = other.shares.as_ref().unwrap().floor.force / other.force;
    let [force, shared] = [found.force / other.force, on_floor.share / share].map(|x| x - 1.0);
    let [own, of_other] = [found.error.unwrap().force, other.error.unwrap().force];
    println!(
        "force {force:e} ({own:e}, {of_other:e}), share {share:.5}: {shared:e} ({:e}, {:e}), floor {:e} of {:e}",
        on_floor.error.share,
        other.floor_error.unwrap().share,
        on_floor.area,
        other.shares.as_ref().unwrap().floor.area,
    );
    assert!(share > least, "{share}");
    assert!(own < 0.01 && on_floor.error.share < 0.02);
    assert!(force.abs() < own + of_other);
    assert!(shared.abs() < on_floor.error.share + other.floor_error.unwrap().share);
    let area = on_floor.area / other.shares.as_ref().unwrap().floor.area - 1.0;
    assert!(
        area.abs() < on_floor.error.area + other.floor_error.unwrap().area + 0.02,
        "{area}"
    );
}

/// All tops are filled.
#[test]
fn three_full_tops_and_the_floor_are_those_of_coarse_boundary_elements() {
    check_with_boundary_elements(1.5, &THREE, 4.0, 0.8, 0.2);
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
    check_with_boundary_elements(1.0, &WIDE, 2.3, 0.8, 0.05);
}

#[test]
#[ignore = "slow: finer boundary elements, at more loads"]
fn tops_and_the_floor_are_those_of_boundary_elements() {
    for indentation in [3.0, 4.0, 5.0] {
        check_with_boundary_elements(1.5, &THREE, indentation, 0.4, 0.02);
    }
    for indentation in [2.0, 2.3, 3.0] {
        check_with_boundary_elements(1.0, &WIDE, indentation, 0.4, 0.01);
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
    // Tops beside the axis would be touched at their rims first.
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
