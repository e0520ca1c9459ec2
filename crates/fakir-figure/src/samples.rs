//! Systems whose figures are drawn in tests.

use fakir::problem::{
    HexagonalLattice, Lens, Material, Pillar, PillarCompliance, PillarPattern, System,
};

/// The diameter of the pillars, m.
pub(crate) const DIAMETER: f64 = 6e-6;

/// The paper's pillars on a lattice; lens and substrate are of the same soft material.
#[allow(clippy::unwrap_used)]
pub(crate) fn system(lattice: HexagonalLattice) -> System {
    let pillar = Pillar {
        diameter: DIAMETER,
        height: 2.2e-6,
        compliance: PillarCompliance::Column,
    };
    let rubber = Material::new(2e6, 0.5);
    let lens = Lens {
        radius: 2.2e-3,
        material: rubber,
    };
    System::new(lens, rubber, PillarPattern::new(pillar, lattice)).unwrap()
}
