//! Contacts from start to answer: critical states of the paper's pillar patterns, and lenses of growing
//! size pressed to touch a thousand to a hundred thousand pillars.

use divan::Bencher;
use fakir::problem::{
    Accuracy, HexagonalLattice, Lens, Load, Material, Method, Pillar, PillarCompliance,
    PillarPattern, System,
};
use fakir::state::Run;
use std::f64::consts::PI;

fn main() {
    divan::main();
}

/// The paper's lens and pillars on the intermediate substrate, with another lens radius (m).
fn system(lens_radius: f64, surface_fraction: f64) -> System {
    let rubber = Material::new(2e6, 0.5);
    let lens = Lens {
        radius: lens_radius,
        material: rubber,
    };
    let pillar = Pillar {
        diameter: 6e-6,
        height: 2.2e-6,
        compliance: PillarCompliance::Column,
    };
    let lattice = HexagonalLattice::with_surface_fraction(surface_fraction, pillar.diameter);
    System::new(lens, rubber, PillarPattern::new(pillar, lattice)).expect("a valid system")
}

#[divan::bench(args = [0.03, 0.1, 0.2])]
fn transition(bencher: Bencher<'_, '_>, surface_fraction: f64) {
    let system = system(2.2e-3, surface_fraction);
    bencher.bench(|| fakir::transition(&system, Method::default(), &Run::default()));
}

#[divan::bench(args = [0.03, 0.1], sample_count = 10)]
fn accurate_transition(bencher: Bencher<'_, '_>, surface_fraction: f64) {
    let system = system(2.2e-3, surface_fraction);
    let method = Method::Spectral(Accuracy::Accurate);
    bencher.bench(|| fakir::transition(&system, method, &Run::default()));
}

/// At a surface fraction of 0.2, a lens of ten times the contact radius: nearly Hertz's contact,
/// `zeta = a^2/R`, so that about `pillars` lie within `a`.
fn press(bencher: Bencher<'_, '_>, pillars: usize) {
    let cell = system(1e-3, 0.2).arrangement().cell_area();
    let contact_radius = (pillars as f64 * cell / PI).sqrt();
    let system = system(10.0 * contact_radius, 0.2);
    let load = Load::Indentation(0.1 * contact_radius);
    bencher.bench(|| fakir::press(&system, load, Method::default(), &Run::default()));
}

#[divan::bench(args = [1_000, 10_000], sample_count = 10)]
fn pressed(bencher: Bencher<'_, '_>, pillars: usize) {
    press(bencher, pillars);
}

#[divan::bench(args = [100_000], sample_count = 1)]
fn pressed_far(bencher: Bencher<'_, '_>, pillars: usize) {
    press(bencher, pillars);
}
