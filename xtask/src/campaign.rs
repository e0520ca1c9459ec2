//! Random systems over all valid parameters, and whether every estimate covers its error: the example
//! `campaign` of the crate `fakir`.

use crate::shell::run;
use crate::tests;
use std::ffi::OsStr;
use std::process::Command;

/// Systems of the check, always the same; `cargo xtask campaign` draws others.
const SYSTEMS: &str = "300";

/// The short campaign of the checks.
pub(crate) fn check(cargo: &OsStr) -> Result<(), String> {
    let campaign = tests::built_example(cargo, "campaign", &[])?;
    run(Command::new(campaign).args(["--systems", SYSTEMS, "--seed", "1"]))
}

/// A campaign with the given options.
pub(crate) fn long(cargo: &OsStr, options: &[&str]) -> Result<(), String> {
    let mut command = Command::new(cargo);
    command.args(["run", "--release", "--locked", "--package", "fakir"]);
    command.args(["--example", "campaign", "--"]).args(options);
    run(&mut command)
}
