//! Error estimates of contacts with height maps: whether they cover the differences from closed forms, finer cells and another method.

use crate::common::{INTERMEDIATE, paper_system};
use fakir::problem::pattern::{Pattern, PillarShape, Top};
use fakir::problem::{
    Accuracy, Boundary, FloorModel, Grid, HeightMap, HexagonalLattice, Indenter, LatticeForm, Lens,
    Load, Material, Method, PillarCompliance, PlaneLattice, SurfaceSystem,
};
use fakir::state::{Run, SurfaceContact};
use std::f64::consts::PI;

fn rubber() -> Material {
    Material::new(2.0e6, 0.5)
}

fn press(system: &SurfaceSystem, indentation: f64) -> SurfaceContact {
    let load = Load::Indentation(indentation);
    let contact = system.press(load, &Run::default()).expect("a contact");
    assert!(contact.converged());
    contact
}

/// Random numbers from 0 to 1 (the generator of D. H. Lehmer with the multiplier of S. K. Park and K. W. Miller).
struct Drawn(u64);

impl Drawn {
    fn within(&mut self, least: f64, most: f64) -> f64 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        least + (most - least) * self.0 as f64 / 2_147_483_647.0
    }
}

/// A sphere on a flat surface: the contact is a disc of area `pi R zeta` (Hertz; Johnson, Contact Mechanics, section 4.2; for the sphere,
/// smaller by `zeta/(3 R)`).
#[test]
fn areas_under_a_sphere_are_within_their_errors() {
    const RADIUS: f64 = 1.0e-3;
    let lens = Indenter::from(Lens {
        radius: RADIUS,
        material: rubber(),
    });
    let mut drawn = Drawn(7);
    let mut largest: f64 = 0.0;
    for _ in 0..40 {
        let cells = [32, 40, 48, 64][drawn.within(0.0, 3.999) as usize];
        let grid = Grid::centred(cells, cells, 40.0e-6 / cells as f64).expect("a grid");
        let axis = [drawn.within(0.0, 1e-6), drawn.within(0.0, 1e-6)];
        let surface = HeightMap::from_height(grid, |_| 0.0).expect("a valid surface");
        let surface = surface.with_axis_at(axis).expect("a valid surface");
        let system =
            SurfaceSystem::new(lens.clone(), rubber(), surface, Boundary::FreeSpace).unwrap();
        let indentation = drawn.within(8e-6, 17e-6).powi(2) / RADIUS;
        let contact = press(&system, indentation);
        let exact = PI * RADIUS * indentation;
        let error = (contact.contact_area / exact - 1.0).abs();
        let stated = contact.area_error.unwrap();
        println!("{cells} cells: {error:.3} stated {stated:.3}");
        assert!(error <= stated, "{error} {stated}");
        assert!(stated < 0.4, "{stated}");
        largest = largest.max(error / stated);
    }
    // The estimates are not too large by a large factor.
    assert!(largest > 0.25, "{largest}");
}

/// The contact ends on the slope along the edge of the top; compared with cells a fifth as large.
#[test]
fn areas_on_chamfers_are_within_their_errors() {
    const DIAMETER: f64 = 6.0e-6;
    let mut drawn = Drawn(11);
    for _ in 0..8 {
        let top = Top::Chamfer {
            width: drawn.within(0.5e-6, 1.5e-6),
            drop: drawn.within(20e-9, 100e-9),
        };
        let pillar = PillarShape {
            top,
            ..PillarShape::cylinder(DIAMETER, 1.0e-6)
        };
        let lattice = PlaneLattice::new(LatticeForm::Square { pitch: 40.0e-6 });
        let pattern = Pattern::new(pillar, lattice);
        let indentation = drawn.within(20e-9, 80e-9);
        let on_cells = |across: usize| {
            // The number of cells that an estimate requires.
            let cells = (4 * across / 3).max(32);
            let grid = Grid::centred(cells, cells, DIAMETER / across as f64).expect("a grid");
            let surface = pattern.height_map(&grid, &rubber()).expect("a surface");
            let plate = Indenter::Flat(Some(rubber()));
            let system = SurfaceSystem::new(plate, rubber(), surface, Boundary::FreeSpace);
            press(&system.expect("a valid system"), indentation)
        };
        let across = [9, 12, 15, 24][drawn.within(0.0, 3.999) as usize];
        let (coarse, fine) = (on_cells(across), on_cells(5 * across));
        let error = (coarse.contact_area / fine.contact_area - 1.0).abs();
        let (stated, finer) = (coarse.area_error.unwrap(), fine.area_error.unwrap());
        println!("{across} across: {error:.3} stated {stated:.3} and {finer:.3}");
        assert!(error <= stated, "{error} {stated}");
    }
}

/// Round flat tops under a lens, compared with the spectral method: both state the errors of force and indentation.
fn check_circles(count: usize, seed: u64) {
    let mut drawn = Drawn(seed);
    let mut beyond = Vec::new();
    for _ in 0..count {
        let pitch = 6.0e-6 * drawn.within(1.5, 5.0);
        let lattice = HexagonalLattice {
            offset_angle: drawn.within(0.0, PI),
            ..HexagonalLattice::new(pitch).offset_by(drawn.within(0.0, 1.0))
        };
        let across = drawn.within(8.0, 17.0) as usize;
        let modulus = INTERMEDIATE * drawn.within(0.3, 30.0);
        let system = paper_system(lattice, modulus, PillarCompliance::Column);
        let system = system.with_floor(FloorModel::Ignored);
        // The undeformed lens penetrates the tops within this distance of its axis.
        let reach = pitch * drawn.within(0.7, 1.5);
        let Lens { radius, material } = system.lens().sphere().expect("a sphere");
        let indentation = reach * reach / (2.0 * radius);
        let load = Load::Indentation(indentation);
        let accurate = Method::Spectral(Accuracy::Accurate);
        let exact = fakir::press(&system, load, accurate, &Run::default()).expect("a contact");
        let cells = (((reach + 0.5 * pitch + 3.0e-6) / 6.0e-6 * across as f64).ceil() as usize) * 2;
        let grid = Grid::centred(cells.max(64), cells.max(64), 6.0e-6 / across as f64);
        let pillar = PillarShape::cylinder(6.0e-6, 2.2e-6);
        let pattern = Pattern::new(pillar, lattice);
        let substrate = *system.substrate();
        let surface = pattern
            .height_map(&grid.expect("a grid"), &substrate)
            .expect("a surface");
        let lens = Indenter::from(Lens { radius, material });
        let surface = SurfaceSystem::new(lens, substrate, surface, Boundary::FreeSpace);
        let surface = surface.and_then(|surface| surface.with_round_tops(6.0e-6));
        let found = press(&surface.expect("a valid system"), indentation);
        let error = (found.force / exact.force - 1.0).abs();
        let stated = found.error.expect("enough cells").force;
        println!(
            "{across} across, {} pillars: {error:.1e} stated {stated:.1e} and {:.1e}",
            exact.pillars_in_contact, exact.error.force
        );
        if error > stated + exact.error.force {
            beyond.push([error, stated]);
        }
    }
    assert!(beyond.is_empty(), "{} of {count}: {beyond:?}", beyond.len());
}

#[test]
fn forces_on_circles_are_within_their_errors() {
    check_circles(4, 3);
}

#[test]
#[ignore = "slow: sixty circles"]
fn forces_on_sixty_circles_are_within_their_errors() {
    check_circles(60, 5);
}
