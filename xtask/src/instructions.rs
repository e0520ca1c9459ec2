//! Compares counts of instructions of hot kernels and whole runs with the committed ones.
//!
//! Counts do not depend on other processes, and so detect changes of speed that a clock would not. They are comparable
//! for one compiler and one kind of processor only; otherwise the check prints this and compares nothing.

use crate::{package, tests};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The committed counts: a line with the compiler, then `name,instructions`.
const RECORDED: &str = "bench/instructions.csv";

/// Largest relative change that is accepted.
const BAND: f64 = 0.05;

/// Kernels of `crates/fakir/examples/kernels.rs`.
const KERNELS: [&str; 6] = [
    "coupling",
    "products",
    "rough_products",
    "one_pillar",
    "floor",
    "elements",
];

/// Whole runs of the program: name and arguments.
const RUNS: [(&str, &[&str]); 3] = [
    (
        "run_transition",
        &["transition", "examples/paper-intermediate.toml"],
    ),
    (
        "run_press",
        &[
            "press",
            "examples/paper-intermediate.toml",
            "--set",
            "pattern.surface_fraction=0.2",
            "--indentation",
            "100um",
            // The tops alone, for which the count was recorded.
            "--without-floor",
        ],
    ),
    (
        "run_elements",
        &[
            "press",
            "examples/square-pillars.toml",
            "--set",
            "surface.grid.cells_per_diameter=8",
            "--indentation",
            "2um",
        ],
    ),
];

/// Compares the counts with those that are committed.
pub(crate) fn check(cargo: &OsStr) -> Result<(), String> {
    let recorded = std::fs::read_to_string(RECORDED)
        .map_err(|error| format!("cannot read {RECORDED}: {error}"))?;
    let (compiler, expected) = parse(&recorded)?;
    let present = compiler_here()?;
    if compiler != present {
        println!("{RECORDED} was counted with {compiler}; this is {present}: nothing is compared");
        return Ok(());
    }
    let counted = count(cargo)?;
    let mut changed = Vec::new();
    for (name, count) in &counted {
        let Some(expected) = expected.get(name) else {
            return Err(format!("{RECORDED} has no line for {name}: {RECORD_IT}"));
        };
        let change = *count as f64 / *expected as f64 - 1.0;
        println!("{name:16} {count:>14} {:+7.2} %", 100.0 * change);
        if change.abs() > BAND {
            changed.push(format!("{name} by {:+.1} %", 100.0 * change));
        }
    }
    if changed.is_empty() {
        return Ok(());
    }
    Err(format!(
        "instructions changed: {}; if that is meant, {RECORD_IT}",
        changed.join(", ")
    ))
}

const RECORD_IT: &str =
    "run cargo xtask record instructions and give the reason in a line of bench/LEDGER.md";

/// Replaces the committed counts by the present ones.
pub(crate) fn record(cargo: &OsStr) -> Result<(), String> {
    let mut text = format!("{}\n", compiler_here()?);
    for (name, count) in count(cargo)? {
        println!("{name:16} {count:>14}");
        text += &format!("{name},{count}\n");
    }
    std::fs::write(RECORDED, text).map_err(|error| format!("cannot write {RECORDED}: {error}"))
}

fn parse(recorded: &str) -> Result<(&str, BTreeMap<String, u64>), String> {
    let mut lines = recorded.lines();
    let compiler = lines.next().unwrap_or_default();
    let counts = lines.map(|line| {
        let fields = line.split_once(',');
        fields
            .and_then(|(name, count)| Some((name.to_owned(), count.parse().ok()?)))
            .ok_or_else(|| format!("{RECORDED}: \"{line}\" is not a name and a number"))
    });
    Ok((compiler, counts.collect::<Result<_, _>>()?))
}

/// Conditions of the counts: the compiler, and the vector instructions of the processor.
fn compiler_here() -> Result<String, String> {
    let output = Command::new("rustc")
        .arg("--version")
        .output()
        .map_err(|error| format!("rustc could not be started: {error}"))?;
    let version = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    Ok(format!(
        "{version} for {} {}",
        std::env::consts::ARCH,
        vectors()
    ))
}

#[cfg(target_arch = "x86_64")]
fn vectors() -> &'static str {
    let wide = std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma");
    if wide { "with AVX2" } else { "without AVX2" }
}

#[cfg(not(target_arch = "x86_64"))]
fn vectors() -> &'static str {
    ""
}

fn count(cargo: &OsStr) -> Result<Vec<(String, u64)>, String> {
    let valgrind = valgrind()?;
    let program = tests::built_command(cargo)?;
    let kernels = tests::kernels(cargo)?;
    let mut counts = Vec::new();
    for kernel in KERNELS {
        counts.push((
            kernel.to_owned(),
            instructions(&valgrind, &kernels, &[kernel])?,
        ));
    }
    for (name, arguments) in RUNS {
        let arguments = [arguments, &["--threads", "1", "--quiet", "--json"]].concat();
        counts.push((
            name.to_owned(),
            instructions(&valgrind, &program, &arguments)?,
        ));
    }
    Ok(counts)
}

pub(crate) fn valgrind() -> Result<PathBuf, String> {
    package::program(&["valgrind"], "valgrind").map_err(|why| {
        format!("valgrind counts instructions, and is not installed{why}: install the package")
    })
}

fn instructions(valgrind: &Path, program: &Path, arguments: &[&str]) -> Result<u64, String> {
    let output = Command::new(valgrind)
        .args(["--tool=cachegrind", "--cache-sim=no"])
        .arg("--cachegrind-out-file=/dev/null")
        .arg(program)
        .args(arguments)
        .output()
        .map_err(|error| format!("valgrind could not be started: {error}"))?;
    let log = String::from_utf8_lossy(&output.stderr);
    let refs = log
        .lines()
        .find_map(|line| line.split_once("refs:"))
        .map(|(_, count)| count.replace(',', ""));
    match refs.and_then(|count| count.trim().parse().ok()) {
        Some(count) if output.status.success() => Ok(count),
        _ => Err(format!("{} {arguments:?}:\n{log}", program.display())),
    }
}
