//! Presses a sphere onto many discs of several radii at random positions, on one thread, and prints the cost of every stage:
//! `cargo run --release -p fakir --features kernels --example arrangement -- 100000`.
//!
//! Times are processor times; times and memory are available on Linux only.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};
use fakir::kernels::press_discs;
use fakir::state::Run;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::process::ExitCode;

/// Fraction of the plane that the discs cover, and their smallest and largest radius.
const COVERED: f64 = 0.15;
const RADII: [f64; 2] = [0.75, 1.25];

/// Smallest gap between two discs.
const GAP: f64 = 0.1;

/// Fraction of the total area in which the undeformed lens penetrates the discs.
const PRESSED: f64 = 0.9;

/// Discs at random positions in a circle that do not overlap.
fn discs(count: usize, covered: f64) -> Vec<[f64; 3]> {
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    let mut uniform = || f64::from(generator.next_u32()) / 4_294_967_296.0;
    let [least, most] = RADII;
    let square = (least * least + least * most + most * most) / 3.0;
    let region = (count as f64 * square / covered).sqrt();
    let side = 2.0 * most + GAP;
    let bin = |x: f64| (x / side).floor() as i64;
    let mut bins: HashMap<[i64; 2], Vec<[f64; 3]>> = HashMap::new();
    let mut discs = Vec::with_capacity(count);
    while discs.len() < count {
        let (distance, angle) = (region * uniform().sqrt(), 2.0 * PI * uniform());
        let (x, y) = (distance * angle.cos(), distance * angle.sin());
        let radius = least + (most - least) * uniform();
        let [i, j] = [bin(x), bin(y)];
        let mut around = (-1..=1).flat_map(|k| (-1..=1).map(move |l| [i + k, j + l]));
        let overlaps = around.any(|place| {
            bins.get(&place).is_some_and(|others| {
                others
                    .iter()
                    .any(|[u, v, other]| (x - u).hypot(y - v) < radius + other + GAP)
            })
        });
        if !overlaps {
            bins.entry([i, j]).or_default().push([x, y, radius]);
            discs.push([x, y, radius]);
        }
    }
    discs
}

/// Processor time of the process in seconds.
fn processor_time() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = text.rsplit(')').next().unwrap_or_default();
    let ticks = after_name.split_whitespace().skip(11).take(2);
    0.01 * ticks.filter_map(|t| t.parse::<f64>().ok()).sum::<f64>()
}

/// Peak memory of the process, MB.
fn most_memory() -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let number = line.and_then(|rest| rest.split_whitespace().next()?.parse::<f64>().ok());
    number.unwrap_or(f64::NAN) / 1024.0
}

fn main() -> ExitCode {
    let mut numbers = std::env::args()
        .skip(1)
        .map(|word| word.parse::<f64>().ok());
    let count = numbers.next().flatten().unwrap_or(1000.0) as usize;
    let covered = numbers.next().flatten().unwrap_or(COVERED);
    let pressed = numbers.next().flatten().unwrap_or(PRESSED);
    let discs = discs(count, covered);
    let farthest = discs
        .iter()
        .fold(0.0_f64, |most, [x, y, _]| most.max(x.hypot(*y)));
    let lens = 10.0 * farthest;
    let indentation = pressed * farthest * farthest / lens;
    let mut before = processor_time();
    let state = press_discs(&discs, lens, indentation, &Run::default(), &processor_time);
    let state = match state {
        Ok(Some(state)) => state,
        Ok(None) => {
            eprintln!("the discs overlap");
            return ExitCode::FAILURE;
        }
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    let [sites, touched] = state.discs;
    println!(
        "{count} discs, {sites} looked at, {touched} touched, degree {}",
        state.degree
    );
    println!(
        "force {:.12e}, relative error {:.1e}",
        state.force, state.error
    );
    for (stage, clock, products) in &state.stages {
        println!("{stage:10} {:8.2} s {products:5} products", clock - before);
        before = *clock;
    }
    let all = state.stages.last().map_or(0.0, |(_, clock, _)| *clock);
    println!(
        "{:.1} us for each, {:.0} MB",
        1e6 * all / count as f64,
        most_memory()
    );
    ExitCode::SUCCESS
}
