//! Writes a synthetic measurement of loading and unloading to standard output, as an example for `fakir fit`: the paper's
//! intermediate substrate at a surface fraction of 0.03, with a modulus of 1.4 MPa and a work of adhesion of 35 mJ/m^2 on
//! the tops; the lens axis is beside a pillar. The contact point is at 3 um, the reading without any force is 2 uN, and
//! the normal noise 0.5 uN.
//!
//! `cargo run -p fakir-inverse --example synthetic_retraction > examples/fit/retraction.csv`

use chacha20::ChaCha12Rng;
use chacha20::rand_core::SeedableRng;
use fakir::problem::{CyclePlan, UnloadingPoint};
use fakir::state::{Branch, CycleLoadStep, Run};
use fakir_case::{Case, CaseFile};
use rand_distr::{Distribution, Normal};

const CONTACT_POINT: f64 = 3e-6;
const FORCE_OFFSET: f64 = 2e-6;
const NOISE: f64 = 0.5e-6;
const TURN: f64 = 3.5e-6;
const STEP: f64 = 0.08e-6;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut file = CaseFile::parse("example", &Case::example().to_toml())?;
    for truth in [
        "pattern.surface_fraction=0.03",
        "pattern.offset=0.3",
        "substrate.young_modulus=1.4MPa",
        "adhesion.work=35mJ/m2",
    ] {
        file.set(truth)?;
    }
    let case = file.case()?;
    // Rounding must not move the last reading beyond the curve.
    let plan = CyclePlan {
        turn: UnloadingPoint::Indentation(TURN * (1.0 + 1e-9)),
        ..CyclePlan::default()
    };
    let cycle = fakir::cycle(&case.system, plan, case.method, &Run::default())?;
    let mut random = ChaCha12Rng::seed_from_u64(7);
    let noise = Normal::new(0.0, NOISE)?;
    println!("# Synthetic: crates/fakir-inverse/examples/synthetic_retraction.rs has the truth.");
    println!("branch,displacement_m,force_N");
    for branch in [Branch::Loading, Branch::Unloading] {
        // From 0.3 um before contact to the unloading point, and back until long after the last
        // detachment.
        let readings: Vec<f64> = match branch {
            Branch::Loading => (0..48).rev().map(|k| TURN - STEP * f64::from(k)).collect(),
            Branch::Unloading => (1..72).map(|k| TURN - STEP * f64::from(k)).collect(),
        };
        for indentation in readings {
            let force = force_at(&cycle.stations, branch, indentation);
            let measured = force + FORCE_OFFSET + noise.sample(&mut random);
            let displacement = indentation + CONTACT_POINT;
            println!("{},{displacement:.4e},{measured:.3e}", branch.name());
        }
    }
    Ok(())
}

/// Force on a branch of a curve that is linear between load steps; zero outside the contact.
fn force_at(stations: &[CycleLoadStep], branch: Branch, indentation: f64) -> f64 {
    let between = |pair: &&[CycleLoadStep]| {
        let ends = [pair[0].indentation, pair[1].indentation];
        pair[1].branch == branch
            && ends[0].min(ends[1]) <= indentation
            && indentation <= ends[0].max(ends[1])
    };
    stations.windows(2).find(between).map_or(0.0, |pair| {
        let length = pair[1].indentation - pair[0].indentation;
        let part = if length == 0.0 {
            1.0
        } else {
            (indentation - pair[0].indentation) / length
        };
        pair[0].force + part * (pair[1].force - pair[0].force)
    })
}
