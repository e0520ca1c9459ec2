//! Writes a synthetic loading experiment to standard output, as an example for `fakir fit`: the
//! paper's intermediate substrate at a surface fraction of 0.01, with a modulus of 1.4 MPa. The
//! machine compliance is 2 mm/N, the contact point is at 3 um, and the normal noise of the force is
//! 0.5 uN.
//!
//! `cargo run -p fakir-inverse --example synthetic_loading > examples/fit/loading.csv`

use chacha20::ChaCha12Rng;
use chacha20::rand_core::SeedableRng;
use fakir::problem::Load;
use fakir::state::Run;
use fakir_case::{Case, CaseFile};
use rand_distr::{Distribution, Normal};

const CONTACT_POINT: f64 = 3e-6;
const MACHINE_COMPLIANCE: f64 = 2e-3;
const NOISE: f64 = 0.5e-6;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut file = CaseFile::parse("example", &Case::example().to_toml())?;
    file.set("pattern.surface_fraction=0.01")?;
    file.set("substrate.young_modulus=1.4MPa")?;
    let case = file.case()?;
    let mut random = ChaCha12Rng::seed_from_u64(7);
    let noise = Normal::new(0.0, NOISE)?;
    println!("# Synthetic: crates/fakir-inverse/examples/synthetic_loading.rs has the truth.");
    println!("displacement_m,force_N");
    // The last four are past the transition.
    for step in 0..36 {
        let indentation = f64::from(step) * 0.1e-6 - 0.35e-6;
        let force = if indentation > 0.0 {
            let load = Load::Indentation(indentation);
            fakir::press(&case.system, load, case.method, &Run::default())?.force
        } else {
            0.0
        };
        let displacement = indentation + CONTACT_POINT + MACHINE_COMPLIANCE * force;
        let measured = force + noise.sample(&mut random);
        println!("{displacement:.4e},{measured:.3e}");
    }
    Ok(())
}
