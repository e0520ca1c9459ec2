//! Writes three synthetic loading curves of one sample into a folder, as examples for `fakir fit` with several files: the paper's
//! intermediate substrate at a surface fraction of 0.01, with a modulus of 1.4 MPa. The machine compliance is 2 mm/N, the contact points
//! are at 3 um, 3.4 um and 2.2 um, and the normal noise of the force is 0.5 uN. All states are before the transition.
//!
//! `cargo run -p fakir-inverse --example synthetic_curves examples/fit`

use chacha20::ChaCha12Rng;
use chacha20::rand_core::SeedableRng;
use fakir::problem::Load;
use fakir::state::Run;
use fakir_case::{Case, CaseFile};
use rand_distr::{Distribution, Normal};
use std::fmt::Write;
use std::path::PathBuf;

const CONTACT_POINTS: [f64; 3] = [3e-6, 3.4e-6, 2.2e-6];
const MACHINE_COMPLIANCE: f64 = 2e-3;
const NOISE: f64 = 0.5e-6;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or("give the folder to write")?;
    let mut file = CaseFile::parse("example", &Case::example().to_toml())?;
    file.set("pattern.surface_fraction=0.01")?;
    file.set("substrate.young_modulus=1.4MPa")?;
    let case = file.case()?;
    let mut random = ChaCha12Rng::seed_from_u64(11);
    let noise = Normal::new(0.0, NOISE)?;
    for (number, contact_point) in CONTACT_POINTS.into_iter().enumerate() {
        let mut text =
            "# Synthetic: crates/fakir-inverse/examples/synthetic_curves.rs has the truth.\n"
                .to_owned();
        text += "displacement_m,force_N\n";
        for step in 0..18 {
            let indentation = f64::from(step) * 0.17e-6 - 0.34e-6;
            let force = if indentation > 0.0 {
                let load = Load::Indentation(indentation);
                fakir::press(&case.system, load, case.method, &Run::default())?.force
            } else {
                0.0
            };
            let displacement = indentation + contact_point + MACHINE_COMPLIANCE * force;
            let measured = force + noise.sample(&mut random);
            writeln!(text, "{displacement:.4e},{measured:.3e}")?;
        }
        let name = format!("spot-{}.csv", number + 1);
        std::fs::write(PathBuf::from(&folder).join(name), text)?;
    }
    Ok(())
}
