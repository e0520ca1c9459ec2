//! The processor times of all tests.

use crate::shell::run;
use crate::{python, tests};
use std::ffi::OsStr;
use std::process::Command;

/// Prints every test with its processor time; each runs in a separate process.
pub(crate) fn print(cargo: &OsStr) -> Result<(), String> {
    let python = python::environment(python::TESTS)?;
    let programs = tests::build(cargo, &tests::light())?;
    let mut timer = Command::new(python);
    timer.arg("tests/times.py");
    for program in &programs {
        timer.args([
            program.executable.as_os_str(),
            program.folder.as_os_str(),
            program.name.as_ref(),
        ]);
    }
    run(&mut timer)
}
