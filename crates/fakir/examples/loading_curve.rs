//! Prints force, contact radius and floor gap during loading of a lens on a pillar pattern, up to the load at which it reaches the floor, as
//! comma-separated values on standard output.

use fakir::problem::{
    HexagonalLattice, Lens, Load, Material, Method, Pillar, PillarCompliance, PillarPattern, System,
};
use fakir::state::Run;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rubber = Material::new(2e6, 0.5);
    let lens = Lens {
        radius: 2.2e-3,
        material: rubber,
    };
    let pillar = Pillar {
        diameter: 6e-6,
        height: 2.2e-6,
        compliance: PillarCompliance::Column,
    };
    let lattice =
        HexagonalLattice::with_surface_fraction(0.03, pillar.diameter).offset_by(1.0 / 3.0);
    let system = System::new(lens, rubber, PillarPattern::new(pillar, lattice))?;

    let (method, run) = (Method::default(), Run::default());
    let critical = fakir::transition(&system, method, &run)?
        .contact
        .indentation;
    println!("indentation_m,force_N,contact_radius_m,pillars_in_contact,smallest_floor_gap_m");
    for step in 0..=40 {
        let load = Load::Indentation(critical * f64::from(step) / 40.0);
        let state = fakir::press(&system, load, method, &run)?;
        println!(
            "{:.6e},{:.6e},{:.6e},{},{:.6e}",
            state.indentation,
            state.force,
            state.contact_radius,
            state.pillars_in_contact,
            state.smallest_floor_gap
        );
    }
    Ok(())
}
