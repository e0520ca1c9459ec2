//! Computes the load at which a lens on pillars first touches the floor between them.

use fakir::problem::{
    HexagonalLattice, Lens, Material, Method, Pillar, PillarCompliance, PillarPattern, System,
};
use fakir::state::Run;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rubber = Material::new(2e6, 0.5); // Pa
    let lens = Lens {
        radius: 2.2e-3,
        material: rubber,
    }; // m
    let pillar = Pillar {
        diameter: 6e-6,
        height: 2.2e-6,
        compliance: PillarCompliance::Column,
    };
    let lattice = HexagonalLattice::with_surface_fraction(0.03, pillar.diameter);
    let system = System::new(lens, rubber, PillarPattern::new(pillar, lattice))?;
    let critical = fakir::transition(&system, Method::default(), &Run::default())?;

    let contact = &critical.contact;
    println!(
        "{}, {}",
        critical.regime.name(),
        contact.termination.description()
    );
    println!("critical force        {:.4} uN", contact.force * 1e6);
    println!("critical indentation  {:.4} um", contact.indentation * 1e6);
    println!(
        "top contact radius    {:.2} um",
        contact.contact_radius * 1e6
    );
    let [x, y] = critical.floor_contact;
    println!("floor contact at      ({:.2}, {:.2}) um", x * 1e6, y * 1e6);
    println!(
        "error estimate        {:.0e} of the force",
        contact.error.force
    );

    println!("\nforce on pillars, from the lens axis outwards:");
    for pillar in contact.pillars.iter().step_by(6) {
        let distance = pillar.centre[0].hypot(pillar.centre[1]);
        let (status, force) = (pillar.status.name(), pillar.force * 1e6);
        println!("{:8.2} um  {force:8.4} uN  {status}", distance * 1e6);
    }

    // Pressure and gap at any point: here half-way between the lens axis and the floor contact.
    if let Some(fields) = &contact.fields {
        let point = [0.5 * x, 0.5 * y];
        println!(
            "\nfloor gap half-way to the floor contact: {:.4} um",
            fields.gap(point) * 1e6
        );
    }
    Ok(())
}
