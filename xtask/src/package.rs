//! Programs that checks need and that may not be installed.

use crate::shell::run;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Locked during an installation, as several checks may need the same package.
pub(crate) fn installing() -> MutexGuard<'static, ()> {
    static INSTALLING: Mutex<()> = Mutex::new(());
    INSTALLING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The first of the programs that is on the path; if there is none, the package of Debian is installed by
/// apt-get, if this is permitted.
pub(crate) fn program(names: &[&str], package: &str) -> Result<PathBuf, String> {
    let _one = installing();
    if let Some(found) = on_path(names) {
        return Ok(found);
    }
    println!("{package} is not installed: trying the package by apt-get");
    let apt = |arguments: &[&str]| {
        let mut command = Command::new("apt-get");
        command
            .args(arguments)
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdout(Stdio::null());
        run(&mut command)
    };
    let install = ["install", "--yes", "--no-install-recommends", package];
    // Lists of packages may be present already; if not, they are downloaded.
    let result = apt(&install).or_else(|_| apt(&["update"]).and_then(|()| apt(&install)));
    match (result, on_path(names)) {
        (Ok(()), Some(found)) => Ok(found),
        (result, _) => Err(result.err().map(|e| format!(" ({e})")).unwrap_or_default()),
    }
}

fn on_path(names: &[&str]) -> Option<PathBuf> {
    let paths = std::env::var_os("PATH")?;
    std::env::split_paths(&paths)
        .flat_map(|folder| names.iter().map(move |name| folder.join(name)))
        .find(|program| program.is_file())
}
