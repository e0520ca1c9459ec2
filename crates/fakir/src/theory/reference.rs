//! The systems of the paper and the reference critical states, for tests.

use crate::problem::{
    HexagonalLattice, Lens, Material, Pillar, PillarCompliance, PillarPattern, System,
};

/// Young's moduli of the rigid, intermediate and soft substrates of the paper, Pa.
pub(crate) const RIGID: f64 = 1e9;
pub(crate) const INTERMEDIATE: f64 = 2e6;
pub(crate) const SOFT: f64 = 2e3;

/// Diameter of the paper's pillars, m.
const DIAMETER: f64 = 6.0e-6;

/// The lens and pillars of the paper on a lattice with the given surface fraction.
pub(crate) fn paper(
    surface_fraction: f64,
    substrate_modulus: f64,
    compliance: PillarCompliance,
) -> System {
    on_lattice(lattice(surface_fraction), substrate_modulus, compliance)
}

/// The lattice of the paper's pillars at a surface fraction.
pub(crate) fn lattice(surface_fraction: f64) -> HexagonalLattice {
    HexagonalLattice::with_surface_fraction(surface_fraction, DIAMETER)
}

/// [`paper`] on any lattice.
pub(crate) fn on_lattice(
    lattice: HexagonalLattice,
    substrate_modulus: f64,
    compliance: PillarCompliance,
) -> System {
    let pillar = Pillar {
        diameter: DIAMETER,
        height: 2.2e-6,
        compliance,
    };
    System::new(
        Lens {
            radius: 2.2e-3,
            material: Material::new(2e6, 0.5),
        },
        Material::new(substrate_modulus, 0.5),
        PillarPattern::new(pillar, lattice),
    )
    .unwrap()
}

/// [`paper`] with the intermediate substrate and its column compliance.
pub(crate) fn intermediate(surface_fraction: f64) -> System {
    paper(surface_fraction, INTERMEDIATE, PillarCompliance::Column)
}

/// A critical state from `tests/reference/critical_states.csv`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reference {
    pub(crate) force: f64,
    pub(crate) indentation: f64,
    pub(crate) floor_contact_distance: f64,
    pub(crate) top_contact_radius: f64,
}

/// The reference for one of the systems of the paper, with the lens axis on a pillar.
pub(crate) fn reference(system: &System) -> Reference {
    let table = include_str!("../../tests/reference/critical_states.csv");
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let compliance = match system.pillar().compliance {
        PillarCompliance::Column => "column",
        PillarCompliance::Elastic => "elastic",
        PillarCompliance::None => "none",
    };
    reader
        .records()
        .map(|record| record.unwrap())
        .find_map(|record| {
            let number = |column: usize| record[column].parse::<f64>().unwrap();
            let near = |value: f64, wanted: f64| (value - wanted).abs() <= 1e-9 * wanted;
            let wanted = near(number(0), system.pattern().surface_fraction())
                && near(number(1), system.hexagonal_lattice().unwrap().offset)
                && near(number(2), system.substrate().young_modulus)
                && &record[3] == compliance;
            wanted.then(|| Reference {
                force: number(4),
                indentation: number(5),
                floor_contact_distance: number(6).hypot(number(7)),
                top_contact_radius: number(8),
            })
        })
        .unwrap()
}
