//! Random systems over all valid parameters, and whether every estimate covers its error: the example
//! `campaign` of the crate `fakir`; and all combinations of question, lens, arrangement and physics:
//! `tests/combinations.py`, with the command.

use crate::shell::run;
use crate::{python, tests};
use std::ffi::OsStr;
use std::process::Command;

/// Systems of the check, always the same; `cargo xtask campaign` draws others.
const SYSTEMS: &str = "300";

/// Number of combinations of the check.
const CELLS: &str = "60";

/// The option for combinations.
const COMBINATIONS: &str = "--combinations";

/// The short campaigns of the checks.
pub(crate) fn check(cargo: &OsStr) -> Result<(), String> {
    let campaign = tests::built_example(cargo, "campaign")?;
    run(Command::new(campaign).args(["--systems", SYSTEMS, "--seed", "1"]))?;
    combinations(cargo, &["--cells", CELLS, "--seed", "1"])
}

fn combinations(cargo: &OsStr, options: &[&str]) -> Result<(), String> {
    let (python, program) = python::prepare(cargo, python::TESTS)?;
    let mut command = Command::new(python);
    command
        .arg("tests/combinations.py")
        .arg("--fakir")
        .arg(program);
    run(command.args(options))
}

/// A campaign with the given options.
pub(crate) fn long(cargo: &OsStr, options: &[&str]) -> Result<(), String> {
    if let [COMBINATIONS, options @ ..] = options {
        return combinations(cargo, options);
    }
    let mut command = Command::new(cargo);
    command.args(["run", "--release", "--locked", "--package", "fakir"]);
    command.args(["--example", "campaign", "--"]).args(options);
    run(&mut command)
}
