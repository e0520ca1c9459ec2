//! The tests of all crates.

use crate::python::run;
use std::ffi::OsStr;
use std::process::Command;

/// Builds all of them, and runs those in folders of their own beside those in libraries and in the documentation: the last few tests
/// of a program leave processors idle.
pub(crate) fn check(cargo: &OsStr) -> Result<(), String> {
    let test = |arguments: &[&str]| {
        let mut command = Command::new(cargo);
        command.args(["test", "--workspace", "--locked"]);
        command.args(arguments);
        command
    };
    run(&mut test(&["--no-run"]))?;
    std::thread::scope(|scope| {
        let inside = scope.spawn(|| {
            [&["--lib", "--bins"][..], &["--doc"]]
                .iter()
                .try_for_each(|targets| captured(&mut test(targets)))
        });
        let beside = run(&mut test(&["--test", "*"]));
        let inside = inside.join().map_err(|_| "a thread ended".to_owned())?;
        beside.and(inside)
    })
}

/// All tests and the program, up to date.
pub(crate) fn build(cargo: &OsStr) -> Result<(), String> {
    run(Command::new(cargo).args(["test", "--workspace", "--locked", "--no-run", "--quiet"]))
}

/// Prints what a command has to say when it has ended.
fn captured(command: &mut Command) -> Result<(), String> {
    let output = command
        .output()
        .map_err(|error| format!("cargo could not be started: {error}"))?;
    let [said, complained] =
        [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    print!("{said}");
    eprint!("{complained}");
    if output.status.success() {
        Ok(())
    } else {
        Err(format!("cargo: {}", output.status))
    }
}
