//! Random states past the transition: tests how well their error estimates cover the difference from accurate solutions.
//!
//! `cargo run --release --example mixed_campaign -- [first] [count]` prints a row for each: parameters, results with the default accuracy,
//! and the differences from the accurate ones divided by the estimates.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};
use fakir::problem::{
    Accuracy, HexagonalLattice, Lens, Load, Material, Method, Pillar, PillarCompliance,
    PillarPattern, System,
};
use fakir::state::{ContactState, Run};

/// Number of touched pillars above which another state is drawn.
const MOST_PILLARS: usize = 1500;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<u64> = std::env::args()
        .skip(1)
        .map(|word| word.parse())
        .collect::<Result<_, _>>()?;
    let first = arguments.first().copied().unwrap_or(0);
    let count = arguments.get(1).copied().unwrap_or(20);
    println!(
        "seed phi E_s offset angle ratio force error_F difference_F share error_share difference_share error_area difference_area cells patches seconds converged"
    );
    for seed in first..first + count {
        row(seed)?;
    }
    Ok(())
}

fn row(seed: u64) -> Result<(), Box<dyn std::error::Error>> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = |low: f64, high: f64| {
        let unit = (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low) * unit
    };
    loop {
        let phi = 10f64.powf(uniform(-3.0, 0.2f64.log10()));
        let modulus = 2e6 * 10f64.powf(uniform(-3.0, 3.0));
        let (offset, angle) = (uniform(0.0, 1.0), uniform(0.0, std::f64::consts::TAU));
        let ratio = 1.0 + 10f64.powf(uniform(-2.0, 4f64.log10()));
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
        let system = System::new(
            lens,
            Material::new(modulus, 0.5),
            PillarPattern::new(pillar, lattice),
        )?;
        let run = Run::default();
        let critical = fakir::transition(&system, Method::default(), &run)?;
        let load = Load::Indentation(ratio * critical.contact.indentation);
        let tops = fakir::press(&system, load, Method::default(), &run)?;
        if tops.pillars_in_contact > MOST_PILLARS {
            continue;
        }
        let start = std::time::Instant::now();
        let state = fakir::press(&system, load, Method::Spectral(Accuracy::Default), &run)?;
        let seconds = start.elapsed().as_secs_f64();
        let truth = fakir::press(&system, load, Method::Spectral(Accuracy::Accurate), &run)?;
        let of_floor = |state: &ContactState| {
            state.floor.as_ref().map_or([0.0; 4], |floor| {
                [floor.share, floor.error.share, floor.area, floor.error.area]
            })
        };
        let [share, error_share, area, error_area] = of_floor(&state);
        let [true_share, _, true_area, _] = of_floor(&truth);
        let (cells, patches) = state
            .floor
            .as_ref()
            .map_or((0, 0), |floor| (floor.cells.len(), floor.patches));
        println!(
            "{seed} {phi:.5} {modulus:.2e} {offset:.3} {angle:.3} {ratio:.4} {:.4e} {:.1e} {:.1e} {share:.5} {error_share:.1e} {:.1e} {error_area:.1e} {:.1e} {cells} {patches} {seconds:.2} {}",
            state.force,
            state.error.force,
            state.force / truth.force - 1.0,
            share / true_share - 1.0,
            area / true_area - 1.0,
            state.converged() && truth.converged()
        );
        return Ok(());
    }
}
