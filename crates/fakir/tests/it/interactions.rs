//! Contact areas, on which interactions act, of every kind of contact.

use crate::common::{INTERMEDIATE, paper_lattice, paper_pillar, paper_system};
use fakir::problem::{
    ElementMesh, FlatSystem, LensShape, ListedPillar, Load, Material, Method, PillarCompliance,
    PillarList, PillarPattern, ShapedLens, System,
};
use fakir::state::Run;
use std::f64::consts::PI;

const RUBBER: Material = Material {
    young_modulus: 2e6,
    poisson_ratio: 0.5,
};

/// `E*` of rubber on rubber, Pa.
const REDUCED: f64 = 4e6 / 3.0;

fn intermediate(surface_fraction: f64) -> System {
    let lattice = paper_lattice(surface_fraction, 0.0);
    paper_system(lattice, INTERMEDIATE, PillarCompliance::Column)
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found / expected - 1.0).abs() < tolerance,
        "{found:e} {expected:e}"
    );
}

/// A circular punch, and Hertz: `a^3 = 3 F R/(4 E*)`.
#[test]
fn flat_surfaces() {
    let run = Run::default();
    let punch = FlatSystem::punch(50e-6, RUBBER, RUBBER).unwrap();
    let areas = punch.press(Load::Force(1e-4), &run).unwrap().areas();
    close(areas.tops.value, PI * 50e-6 * 50e-6, 1e-14);
    assert!(areas.floor.is_none());
    let shape = LensShape::Paraboloid { radius: 2e-3 };
    let sphere = FlatSystem::new(ShapedLens::new(shape, RUBBER), RUBBER).unwrap();
    let areas = sphere.press(Load::Force(1e-3), &run).unwrap().areas();
    close(
        areas.tops.value,
        PI * (0.75 * 1e-3 * 2e-3 / REDUCED).powf(2.0 / 3.0),
        1e-9,
    );
}

/// A level plate covers all pillars: the sum of the areas of their tops.
#[test]
fn pillars_that_are_covered() {
    let pillar = paper_pillar(PillarCompliance::Column);
    let pillars = (0..5).map(|k| ListedPillar {
        centre: [20e-6 * f64::from(k), 0.0],
        height: pillar.height,
        diameter: pillar.diameter,
    });
    let list = PillarList::new(pillars.collect()).unwrap();
    let plate = ShapedLens::new(
        LensShape::Plate {
            tilt: 0.0,
            direction: 0.0,
        },
        RUBBER,
    );
    let system = System::new(plate, RUBBER, PillarPattern::new(pillar, list)).unwrap();
    let contact = fakir::press(
        &system,
        Load::Force(1e-5),
        Method::default(),
        &Run::default(),
    );
    let areas = contact.unwrap().areas();
    close(areas.tops.value, 5.0 * PI * 9e-12, 1e-12);
    assert_eq!(areas.floor.unwrap().value.to_bits(), 0);
}

/// A contact inside a single top: the disc of its radius.
#[test]
fn a_contact_inside_a_top() {
    let run = Run::default();
    let contact = fakir::press(
        &intermediate(0.01),
        Load::Force(1e-8),
        Method::default(),
        &run,
    );
    let contact = contact.unwrap();
    assert_eq!(contact.pillars.len(), 1);
    close(
        contact.areas().tops.value,
        PI * contact.contact_radius.powi(2),
        1e-12,
    );
}

/// The spectral method and elements on a fine mesh agree within the sum of their errors, where the edge crosses many tops.
#[test]
#[ignore = "slow: six loads on a fine mesh of elements"]
fn areas_of_both_methods_agree() {
    let run = Run::default();
    let mesh = ElementMesh {
        cells_per_diameter: 32,
        ..ElementMesh::default()
    };
    for fraction in [0.03, 0.1] {
        let system = intermediate(fraction);
        for force in [3e-6, 1e-5, 3e-5] {
            let [spectral, elements] = [Method::default(), Method::Love(mesh)].map(|method| {
                fakir::press(&system, Load::Force(force), method, &run)
                    .unwrap()
                    .areas()
                    .tops
            });
            let allowed = spectral.error.unwrap() + elements.error.unwrap();
            let difference = spectral.value - elements.value;
            println!(
                "{fraction} {force:e}: {:e} {:e} {allowed:e}",
                spectral.value, difference
            );
            // Tops that are touched completely have the same area in both.
            assert!(difference.abs() <= allowed, "{fraction} {force:e}");
            // Three tops carry the lightest load.
            assert!(spectral.error.unwrap() < 0.2 * spectral.value);
        }
    }
}
