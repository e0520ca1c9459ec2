//! Rounded tops and the floor in contact at the same time: closed forms, limits, derivatives, and boundary elements.

use fakir::problem::{
    Accuracy, Asperity, AsperityArray, Boundary, Floor, Grid, HeightMap, Indenter, LensShape, Load,
    Material, Point, ShapedLens, SurfaceSystem,
};
use fakir::state::{AsperityContact, FloorContact, Run, SurfaceContact};

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

/// Expected: boundary elements on the height map of the same pillars, which share the half-space only.
fn check_with_boundary_elements(tops: &[Top], depth: f64, indentation: f64, half: f64, cell: f64) {
    let start = std::time::Instant::now();
    let array = array(depth, tops);
    let load = Load::Indentation(indentation * UM);
    let found = pressed(&array, load, Accuracy::Default);
    let took = start.elapsed();
    println!("{:?} {:?}", found.floor_gap, found.floor.is_some());
    let on_floor = floor(&found);
    let other = on_cells(tops, depth, indentation, half, cell);
    let share = other.shares.as_ref().unwrap().floor.force / other.force;
    println!(
        "{took:?} force {:e} ({:e}), share {:.5} {share:.5} ({:e}), floor area {:.5e}, tops {:.5e} of {:.5e}",
        found.force / other.force - 1.0,
        found.error.unwrap().force,
        on_floor.share,
        on_floor.error.share,
        on_floor.area,
        found.area,
        other.contact_area,
    );
    println!("{:?} {:?} {:?}", found.error, on_floor.error, other.error);
    println!("{} cells {} patches {}", on_floor.cells.len(), found.iterations, on_floor.patches);
}

#[test]
fn three_tops_and_the_floor_are_those_of_coarse_boundary_elements() {
    let critical = array(1.5, &THREE)
        .transition(Accuracy::Default, &Run::default())
        .unwrap();
    println!("{:?} {:e}", critical.contact.indentation, critical.contact.force);
    for indentation in [4.0, 5.0, 2.6, 3.5] {
        check_with_boundary_elements(&THREE, 1.5, indentation, 80.0, 0.8);
    }
}
