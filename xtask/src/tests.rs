//! The tests of all crates.

use crate::python::run;
use std::ffi::OsStr;
use std::process::Command;

/// Tests at a time, for every processor: a long one that comes late does not leave the others idle.
const AT_A_TIME: usize = 2;

/// Builds and runs all of them.
pub(crate) fn check(cargo: &OsStr) -> Result<(), String> {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let at_a_time = (AT_A_TIME * processors).to_string();
    run(test(cargo).env("RUST_TEST_THREADS", at_a_time))
}

/// All tests and the program, up to date.
pub(crate) fn build(cargo: &OsStr) -> Result<(), String> {
    run(test(cargo).args(["--no-run", "--quiet"]))
}

fn test(cargo: &OsStr) -> Command {
    let mut command = Command::new(cargo);
    command.args(["test", "--workspace", "--locked"]);
    command
}
