//! Other programs, and the target folder.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs a program.
pub(crate) fn run(command: &mut Command) -> Result<(), String> {
    let name = command.get_program().to_string_lossy().into_owned();
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{name}: {status}")),
        Err(error) => Err(format!("{name} could not be started: {error}")),
    }
}

/// Runs cargo with arguments, none of which contains a blank.
pub(crate) fn run_cargo(cargo: &OsStr, arguments: &str) -> Result<(), String> {
    run(Command::new(cargo)
        .args(arguments.split(' '))
        .env("RUSTDOCFLAGS", "-D warnings"))
}

/// The cargo that started this program.
pub(crate) fn cargo() -> OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// The target folder, which this program is in.
pub(crate) fn target_folder() -> Result<PathBuf, String> {
    let executable = std::env::current_exe().map_err(|error| format!("own path: {error}"))?;
    let target = executable.ancestors().nth(2).map(Path::to_owned);
    target.ok_or_else(|| "the target folder was not found".to_owned())
}
