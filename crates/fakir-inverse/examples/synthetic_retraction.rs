//! Writes synthetic measurements of loading and unloading with adhesion to a folder, as examples for `fakir fit`:
//!
//! * `retraction.csv`: the paper's intermediate substrate at a surface fraction of 0.03, with a modulus of 1.4 MPa and a work of adhesion of 35 mJ/m^2 on
//!   the tops; the lens axis is beside a pillar. The contact point is at 3 um, the reading without any force is 2 uN, and the normal noise 0.5 uN;
//! * `reference.txt` and `sample.txt`, as a nanoindenter writes them: a flat and a patterned sample of one rubber, both with a modulus of 1.7 MPa and works of
//!   adhesion of 30 mJ/m^2 and 55 mJ/m^2, under one glass lens of radius 2 mm. The machine compliance is 1.5 mm/N, the contact points are at 800 nm and
//!   650 nm, and the normal noise is 0.5 uN.
//!
//! `cargo run -p fakir-inverse --example synthetic_retraction examples/fit`

use chacha20::ChaCha12Rng;
use chacha20::rand_core::SeedableRng;
use fakir::problem::{CyclePlan, LoadingMode, UnloadingPoint};
use fakir::state::{Branch, CycleLoadStep, Run};
use fakir_case::{Case, CaseFile};
use rand_distr::{Distribution, Normal};
use std::error::Error;
use std::fmt::Write;
use std::path::Path;

const CONTACT_POINT: f64 = 3e-6;
const FORCE_OFFSET: f64 = 2e-6;
const NOISE: f64 = 0.5e-6;
const TURN: f64 = 3.5e-6;
const STEP: f64 = 0.08e-6;

/// Machine compliance of the nanoindenter, m/N.
const MACHINE_COMPLIANCE: f64 = 1.5e-3;

fn retraction() -> Result<String, Box<dyn Error>> {
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
    let mut text =
        "# Synthetic: crates/fakir-inverse/examples/synthetic_retraction.rs has the truth.\n\
         branch,displacement_m,force_N\n"
            .to_owned();
    for branch in [Branch::Loading, Branch::Unloading] {
        // From 0.3 um before contact to the unloading point, and back until long after the last
        // detachment.
        let readings: Vec<f64> = match branch {
            Branch::Loading => (0..48).rev().map(|k| TURN - STEP * f64::from(k)).collect(),
            Branch::Unloading => (1..72).map(|k| TURN - STEP * f64::from(k)).collect(),
        };
        for indentation in readings {
            let force = force_at(&cycle.stations, branch, indentation, 0.0);
            let measured = force + FORCE_OFFSET + noise.sample(&mut random);
            let displacement = indentation + CONTACT_POINT;
            writeln!(text, "{},{displacement:.4e},{measured:.3e}", branch.name())?;
        }
    }
    Ok(text)
}

/// Displacements of the nanoindenter from the first contact, m: down to the last one and back.
fn down_and_up(deepest: f64, steps: i32, apart: i32) -> Vec<(Branch, f64)> {
    let at = |k: i32| deepest * f64::from(k) / f64::from(steps);
    let down = (-apart / 4..=steps).map(|k| (Branch::Loading, at(k)));
    let up = (-apart..steps).rev().map(|k| (Branch::Unloading, at(k)));
    down.chain(up).collect()
}

/// A table as the nanoindenter writes it.
fn indenter(
    test: &str,
    contact_point: f64,
    seed: u64,
    readings: &[(f64, f64)],
) -> Result<String, Box<dyn Error>> {
    let mut random = ChaCha12Rng::seed_from_u64(seed);
    let noise = Normal::new(0.0, NOISE)?;
    let mut text = format!(
        "{test}\r\nSynthetic\tsynthetic_retraction.rs has the truth\r\nTip\tglass lens\r\n\r\nDepth (nm)\tLoad (uN)\r\n"
    );
    for (displacement, force) in readings {
        let measured = force + noise.sample(&mut random);
        let depth = displacement + contact_point;
        write!(text, "{:.1}\t{:.3}\r\n", depth * 1e9, measured * 1e6)?;
    }
    Ok(text)
}

/// The bodies and the adhesion of both samples.
const RUBBER: &str = "[lens]\nradius = \"2 mm\"\nyoung_modulus = \"70 GPa\"\npoisson_ratio = 0.22\n\
                      [substrate]\nyoung_modulus = \"1.7 MPa\"\npoisson_ratio = 0.5\n\
                      [adhesion]\nwork = \"30 mJ/m2\"\nwork_receding = \"55 mJ/m2\"\n";

fn reference() -> Result<String, Box<dyn Error>> {
    let case = CaseFile::parse("reference", RUBBER)?.flat_case()?;
    let steps = down_and_up(5e-6, 40, 48);
    let mode = LoadingMode::Machine(MACHINE_COMPLIANCE.recip());
    let run = Run::default();
    let branches = case.system.branches(mode, 5e-6, &run)?;
    let mut readings = Vec::new();
    for (branch, displacement) in steps {
        readings.push((displacement, branches.at(branch, displacement)?.force));
    }
    indenter("Test 7 of batch 2: flat", 800e-9, 21, &readings)
}

fn sample() -> Result<String, Box<dyn Error>> {
    let pattern = "[pattern]\nsurface_fraction = 0.05\n[pattern.pillar]\ndiameter = \"6 um\"\nheight = \"2.2 um\"\n";
    let case = CaseFile::parse("sample", &format!("{RUBBER}{pattern}"))?.case()?;
    let plan = CyclePlan {
        turn: UnloadingPoint::Indentation(2.6e-6),
        drive: LoadingMode::Machine(MACHINE_COMPLIANCE.recip()),
        ..CyclePlan::default()
    };
    let cycle = fakir::cycle(&case.system, plan, case.method, &Run::default())?;
    let place = |step: &CycleLoadStep| step.indentation + MACHINE_COMPLIANCE * step.force;
    let deepest = cycle.stations.iter().map(place).fold(0.0, f64::max);
    let steps = down_and_up(deepest * (1.0 - 1e-9), 40, 32).into_iter();
    let readings: Vec<(f64, f64)> = steps
        .map(|(branch, displacement)| {
            let force = force_at(&cycle.stations, branch, displacement, MACHINE_COMPLIANCE);
            (displacement, force)
        })
        .collect();
    indenter("Test 8 of batch 2: pillars", 650e-9, 22, &readings)
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("give the folder")?;
    let folder = Path::new(&folder);
    std::fs::write(folder.join("retraction.csv"), retraction()?)?;
    std::fs::write(folder.join("reference.txt"), reference()?)?;
    std::fs::write(folder.join("sample.txt"), sample()?)?;
    Ok(())
}

/// Force on a branch of a curve that is linear between load steps, at a displacement `zeta + compliance F` (m); zero outside the contact.
fn force_at(stations: &[CycleLoadStep], branch: Branch, displacement: f64, compliance: f64) -> f64 {
    let ends =
        |pair: &[CycleLoadStep]| [0, 1].map(|k| pair[k].indentation + compliance * pair[k].force);
    let between = |pair: &&[CycleLoadStep]| {
        let [first, last] = ends(pair);
        pair[1].branch == branch
            && first.min(last) <= displacement
            && displacement <= first.max(last)
    };
    stations.windows(2).find(between).map_or(0.0, |pair| {
        let [first, last] = ends(pair);
        let length = last - first;
        let part = if length == 0.0 {
            1.0
        } else {
            (displacement - first) / length
        };
        pair[0].force + part * (pair[1].force - pair[0].force)
    })
}
