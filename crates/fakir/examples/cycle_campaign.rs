//! Random cycles of loading and unloading with adhesion: whether each ends with nothing in contact, and how well its certificate holds.
//!
//! `cargo run --release --example cycle_campaign -- [first] [count]` prints a row for each: what was drawn, the results, and the difference
//! between loop area and dissipation over the loop area. It fails if one does not come off, or if one differs by more than 1e-4.

use fakir::problem::{
    Adhesion, CyclePlan, HexagonalLattice, Lens, Material, Method, Pillar, PillarCompliance,
    System, Texture,
};
use fakir::state::Run;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::error::Error;

/// Difference between loop area and dissipation that is allowed, over the loop area.
const CERTIFICATE: f64 = 1e-4;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<u64> = std::env::args()
        .skip(1)
        .map(|word| word.parse())
        .collect::<Result<_, _>>()?;
    let first = arguments.first().copied().unwrap_or(0);
    let count = arguments.get(1).copied().unwrap_or(200);
    println!(
        "seed phi E_s offset angle work work_receding F_c pillars partial pull_off separation loop certificate events seconds closed"
    );
    let mut failures = 0;
    for seed in first..first + count {
        failures += usize::from(!holds(seed)?);
    }
    if failures > 0 {
        return Err(format!("{failures} of {count} cycles do not hold what is promised").into());
    }
    Ok(())
}

/// Prints a row; whether it holds what is promised.
fn holds(seed: u64) -> Result<bool, Box<dyn Error>> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = |low: f64, high: f64| {
        let unit = (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low) * unit
    };
    let phi = 10f64.powf(uniform(0.003f64.log10(), -1.0));
    let modulus = 2e6 * 10f64.powf(uniform(-2.0, 3.0));
    let (offset, angle) = (uniform(0.0, 1.0), uniform(0.0, std::f64::consts::TAU));
    let work = 10f64.powf(uniform(-5.0, 0.5f64.log10()));
    // Half of them take more to part than they gain.
    let receding = (uniform(0.0, 1.0) < 0.5).then(|| work * 10f64.powf(uniform(0.0, 1.0)));
    let pillar = Pillar {
        diameter: 6e-6,
        height: 2.2e-6,
        compliance: PillarCompliance::Column,
    };
    let lattice = HexagonalLattice {
        offset_angle: angle,
        ..HexagonalLattice::with_surface_fraction(phi, 6e-6).offset_by(offset)
    };
    let lens = Lens {
        radius: 2.2e-3,
        material: Material::new(2e6, 0.5),
    };
    let substrate = Material::new(modulus, 0.5);
    let adhesion = Adhesion {
        work,
        work_receding: receding,
        floor: false,
    };
    let system = System::new(lens, substrate, Texture::new(pillar, lattice))?;
    let system = system.with_adhesion(adhesion)?;
    let start = std::time::Instant::now();
    let cycle = fakir::cycle(
        &system,
        CyclePlan::default(),
        Method::default(),
        &Run::default(),
    )?;
    let seconds = start.elapsed().as_secs_f64();
    let certificate = cycle.certificate().unwrap_or(f64::INFINITY);
    let closed = cycle.converged() && cycle.separation.is_some();
    println!(
        "{seed} {phi:.5} {modulus:.2e} {offset:.3} {angle:.3} {work:.2e} {:.2e} {:.5e} {} {} {:.4e} {:.4e} {:.4e} {certificate:.1e} {} {seconds:.2} {closed} {:?}",
        adhesion.receding(),
        cycle.turn.force,
        cycle.turn.pillars_in_contact,
        cycle.turn.pillars_partially_in_contact,
        cycle.pull_off.as_ref().map_or(0.0, |pull| pull.force),
        cycle.separation.unwrap_or(f64::NAN),
        cycle.loop_area,
        cycle.events.len(),
        cycle.termination,
    );
    Ok(closed && certificate < CERTIFICATE)
}
