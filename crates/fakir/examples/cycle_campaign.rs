//! Random cycles of loading and unloading with adhesion: tests whether each ends without contact, and the energy balance of each. With
//! `floor` the floor is adhesive as well, and every cycle is computed again on finer cells to test whether both agree within their error
//! estimates.
//!
//! `cargo run --release --example cycle_campaign -- [first] [count] [floor]` prints a row for each: parameters, results, and the difference
//! between loop area and dissipation divided by the loop area. It fails if a lens does not detach, if this difference exceeds 1e-4 (with
//! the floor 1e-3), or if the results on two cell sizes do not agree.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};
use fakir::problem::{
    Accuracy, Adhesion, CyclePlan, HexagonalLattice, Lens, Material, Method, Pillar,
    PillarCompliance, PillarPattern, System,
};
use fakir::state::{Cycle, Run, SolveError};
use std::error::Error;
use std::f64::consts::TAU;

/// Largest difference between loop area and dissipation, relative to the loop area, without and with the floor.
const CERTIFICATE: [f64; 2] = [1e-4, 1e-3];

fn main() -> Result<(), Box<dyn Error>> {
    let (words, numbers): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|word| word == "floor");
    let numbers: Vec<u64> = numbers
        .iter()
        .map(|word| word.parse())
        .collect::<Result<_, _>>()?;
    let floor = !words.is_empty();
    let first = numbers.first().copied().unwrap_or(0);
    let count = numbers
        .get(1)
        .copied()
        .unwrap_or(if floor { 30 } else { 200 });
    println!("{}", if floor { FLOOR_HEADING } else { HEADING });
    let mut failures = 0;
    for seed in first..first + count {
        let drawn = Drawn::new(seed, floor);
        failures += usize::from(!if floor {
            drawn.agrees()?
        } else {
            drawn.holds()?
        });
    }
    if failures > 0 {
        return Err(format!("{failures} of {count} cycles violate the requirements").into());
    }
    Ok(())
}

const HEADING: &str = "seed phi E_s offset angle work work_receding F_c pillars partial pull_off separation loop certificate events seconds closed";
const FLOOR_HEADING: &str = "seed phi E_s offset angle work cells; jump force, jump area, lost, pull-off, loop: difference over the sum of both errors; certificate seconds agree";

/// The random parameters of a case.
struct Drawn {
    seed: u64,
    phi: f64,
    modulus: f64,
    offset: f64,
    angle: f64,
    adhesion: Adhesion,
}

impl Drawn {
    fn new(seed: u64, floor: bool) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut uniform = |low: f64, high: f64| {
            let unit = (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
            low + (high - low) * unit
        };
        let [phis, moduli, works] = if floor {
            [[0.01, 0.06], [2e6, 1e9], [0.5e-3, 20e-3]]
        } else {
            [[0.003, 0.1], [2e4, 2e9], [1e-5, 0.5]]
        };
        let logarithmic = |[low, high]: [f64; 2], part: f64| low * (high / low).powf(part);
        let phi = logarithmic(phis, uniform(0.0, 1.0));
        let modulus = logarithmic(moduli, uniform(0.0, 1.0));
        let (offset, angle) = (uniform(0.0, 1.0), uniform(0.0, TAU));
        let work = logarithmic(works, uniform(0.0, 1.0));
        // In half of them, the work of adhesion is larger for breaking contact.
        let hysteretic = !floor && uniform(0.0, 1.0) < 0.5;
        let receding = hysteretic.then(|| work * 10f64.powf(uniform(0.0, 1.0)));
        Self {
            seed,
            phi,
            modulus,
            offset,
            angle,
            adhesion: Adhesion {
                work,
                work_receding: receding,
                floor,
            },
        }
    }

    fn cycle(&self, accuracy: Accuracy) -> Result<Cycle, SolveError> {
        let pillar = Pillar {
            diameter: 6e-6,
            height: 2.2e-6,
            compliance: PillarCompliance::Column,
        };
        let lattice = HexagonalLattice {
            offset_angle: self.angle,
            ..HexagonalLattice::with_surface_fraction(self.phi, 6e-6).offset_by(self.offset)
        };
        let lens = Lens {
            radius: 2.2e-3,
            material: Material::new(2e6, 0.5),
        };
        let substrate = Material::new(self.modulus, 0.5);
        let system = System::new(lens, substrate, PillarPattern::new(pillar, lattice))?;
        let system = system.with_adhesion(self.adhesion)?;
        let (plan, method) = (CyclePlan::default(), Method::Spectral(accuracy));
        fakir::cycle(&system, plan, method, &Run::default())
    }

    fn words(&self) -> String {
        let Self {
            seed,
            phi,
            modulus,
            offset,
            angle,
            adhesion,
        } = self;
        let work = adhesion.work;
        format!("{seed} {phi:.5} {modulus:.2e} {offset:.3} {angle:.3} {work:.2e}")
    }

    /// Prints a row; returns whether the requirements are satisfied.
    fn holds(&self) -> Result<bool, Box<dyn Error>> {
        let start = std::time::Instant::now();
        let cycle = self.cycle(Accuracy::Default)?;
        let seconds = start.elapsed().as_secs_f64();
        let certificate = cycle.certificate().unwrap_or(f64::INFINITY);
        let closed = cycle.converged() && cycle.separation.is_some();
        println!(
            "{} {:.2e} {:.5e} {} {} {:.4e} {:.4e} {:.4e} {certificate:.1e} {} {seconds:.2} {closed} {:?}",
            self.words(),
            self.adhesion.receding(),
            cycle.turn.force,
            cycle.turn.pillars_in_contact,
            cycle.turn.pillars_partially_in_contact,
            cycle.pull_off.as_ref().map_or(0.0, |pull| pull.force),
            cycle.separation.unwrap_or(f64::NAN),
            cycle.loop_area,
            cycle.events.len(),
            cycle.termination,
        );
        Ok(closed && certificate < CERTIFICATE[0])
    }

    /// Prints a row; returns whether the results on finer cells agree.
    fn agrees(&self) -> Result<bool, Box<dyn Error>> {
        let start = std::time::Instant::now();
        let cycles = [
            self.cycle(Accuracy::Default)?,
            self.cycle(Accuracy::Accurate)?,
        ];
        let seconds = start.elapsed().as_secs_f64();
        let certificates = cycles.each_ref().map(Cycle::certificate);
        let certificate = certificates
            .map(|it| it.unwrap_or(f64::INFINITY))
            .into_iter()
            .fold(0.0, f64::max);
        let cells = cycles
            .each_ref()
            .map(|cycle| cycle.floor.map_or(f64::NAN, |floor| 1e6 * floor.cell));
        let figures = cycles.each_ref().map(figures);
        let [coarse, fine] = &figures;
        let shares: Vec<f64> = coarse
            .iter()
            .zip(fine)
            .map(|(a, b)| (a.0 - b.0).abs() / (a.1 + b.1))
            .collect();
        let agree = shares.iter().all(|share| *share <= 1.0) && certificate < CERTIFICATE[1];
        println!(
            "{} {cells:.2?}; {shares:.2?} {certificate:.1e} {seconds:.1} {agree}",
            self.words()
        );
        Ok(agree)
    }
}

/// Force and area after the jump, indentation at which the floor detaches, pull-off force and loop area, each with its error.
fn figures(cycle: &Cycle) -> [(f64, f64); 5] {
    let errors = cycle.floor.map(|floor| floor.errors);
    let jump = cycle.floor_jump().map(|[_, after]| after);
    let known = |value: Option<f64>, error: Option<f64>| {
        let value = value.unwrap_or(f64::NAN);
        (value, error.map_or(f64::NAN, |error| error * value.abs()))
    };
    let lost = cycle.floor_lost().map(|[last, _]| last.indentation);
    let area = jump.and_then(|after| Some(after.floor?.area));
    let [of_pull, of_loop] = [cycle.errors.pull_off_force, cycle.errors.loop_area]
        .map(|error| error.numerical() + error.model());
    [
        known(jump.map(|after| after.force), errors.map(|e| e.jump_force)),
        known(area, errors.map(|e| e.jump_area)),
        known(lost, errors.map(|e| e.lost_indentation)),
        known(
            cycle.pull_off.as_ref().map(|pull| pull.force),
            Some(of_pull),
        ),
        known(Some(cycle.loop_area), Some(of_loop)),
    ]
}
