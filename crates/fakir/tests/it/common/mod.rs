//! The systems of the paper, and an independent solution, for the integration tests.

pub(crate) mod squares;

use fakir::problem::{
    HexagonalLattice, Lens, Material, Pillar, PillarCompliance, PillarPattern, System,
};

/// Young's modulus of the lens and of the paper's intermediate substrate, Pa.
pub(crate) const INTERMEDIATE: f64 = 2.0e6;

/// The lens of the paper.
pub(crate) fn paper_lens() -> Lens {
    Lens {
        radius: 2.2e-3,
        material: Material::new(INTERMEDIATE, 0.5),
    }
}

/// The pillars of the paper.
pub(crate) fn paper_pillar(compliance: PillarCompliance) -> Pillar {
    Pillar {
        diameter: 6.0e-6,
        height: 2.2e-6,
        compliance,
    }
}

/// The lens and the pillars of the paper on a given lattice and substrate (Pa).
pub(crate) fn paper_system(
    lattice: HexagonalLattice,
    substrate_modulus: f64,
    compliance: PillarCompliance,
) -> System {
    let pillar = paper_pillar(compliance);
    System::new(
        paper_lens(),
        Material::new(substrate_modulus, 0.5),
        PillarPattern::new(pillar, lattice),
    )
    .expect("a system of the paper is valid")
}

/// A lattice of the paper's pillars.
pub(crate) fn paper_lattice(surface_fraction: f64, offset: f64) -> HexagonalLattice {
    HexagonalLattice::with_surface_fraction(surface_fraction, 6.0e-6).offset_by(offset)
}
