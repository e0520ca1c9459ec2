//! Computes a contact with pillar tops and floor past the transition, and its processor time.
//!
//! `cargo run --release --example mixed -- [phi] [indentation over critical] [offset] [default|accurate]`

use fakir::problem::{
    Accuracy, HexagonalLattice, Lens, Load, Material, Method, Pillar, PillarCompliance,
    PillarPattern, System,
};
use fakir::state::Run;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |place: usize, default: f64| -> Result<f64, std::num::ParseFloatError> {
        arguments
            .get(place)
            .map_or(Ok(default), |word| word.parse())
    };
    let (phi, ratio, offset) = (number(0, 0.03)?, number(1, 1.2)?, number(2, 0.0)?);
    let accuracy = match arguments.get(3).map(String::as_str) {
        Some("accurate") => Accuracy::Accurate,
        _ => Accuracy::Default,
    };
    let rubber = Material::new(2e6, 0.5);
    let substrate = Material::new(number(4, 2e6)?, 0.5);
    let pillar = Pillar {
        diameter: 6e-6,
        height: 2.2e-6,
        compliance: PillarCompliance::Column,
    };
    let lattice = HexagonalLattice::with_surface_fraction(phi, 6e-6).offset_by(offset);
    let lens = Lens {
        radius: 2.2e-3,
        material: rubber,
    };
    let system = System::new(lens, substrate, PillarPattern::new(pillar, lattice))?;
    let run = Run::default();
    let critical = fakir::transition(&system, Method::Spectral(accuracy), &run)?;
    let indentation = Load::Indentation(ratio * critical.contact.indentation);
    let start = Instant::now();
    let tops = fakir::press(&system, indentation, Method::Spectral(accuracy), &run)?;
    let on_tops = start.elapsed();
    let start = Instant::now();
    let state = fakir::press(&system, indentation, Method::Spectral(accuracy), &run)?;
    println!(
        "{:?} {} steps, {:.3} s (tops alone {:.3} s)",
        state.termination,
        state.iterations,
        start.elapsed().as_secs_f64(),
        on_tops.as_secs_f64()
    );
    println!(
        "zeta {:.7e} F {:.8e} N (error {:.1e}) over tops alone {:.6}, {} pillars, {} in part",
        state.indentation,
        state.force,
        state.error.force,
        state.force / tops.force,
        state.pillars_in_contact,
        state.pillars_partially_in_contact
    );
    if let Some(floor) = &state.floor {
        println!(
            "share {:.7} (error {:.1e}) area {:.1} um2 ({:.1e}) patches {} {} radius {:.2} um rim {:.2} um pmax {:.3e} cells {} of {:.2e}, bound {:.1e}",
            floor.share,
            floor.error.share,
            floor.area * 1e12,
            floor.error.area,
            floor.patches,
            floor.patches_agree,
            floor.radius * 1e6,
            floor.smallest_distance_to_rim * 1e6,
            floor.largest_pressure().0,
            floor.cells.len(),
            floor.cell()[1],
            floor.energy_bound
        );
    }
    Ok(())
}
