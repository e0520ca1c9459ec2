//! Checks side by side: each in a separate process, whose output is printed when it has ended.

use crate::shell::target_folder;
use std::fs::{self, File};
use std::io::Write;
use std::path::Path;
use std::process::{Command, ExitStatus};
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs the checks of each lane, by their names, one after another, and the lanes side by side. After a failure no further check is started.
/// Returns whether all passed.
pub(crate) fn run<const LANES: usize>(lanes: [Vec<&'static str>; LANES]) -> bool {
    let failed = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for lane in lanes {
            scope.spawn(|| {
                for name in lane {
                    if failed.load(Ordering::Relaxed) {
                        return;
                    }
                    if !passes(name) {
                        failed.store(true, Ordering::Relaxed);
                    }
                }
            });
        }
    });
    !failed.into_inner()
}

/// Runs a check and prints its output.
fn passes(name: &str) -> bool {
    let result = target_folder().and_then(|target| {
        let folder = target.join("checks");
        let log = folder.join(format!("{name}.txt"));
        println!("== {name} has started; its output is in {}", log.display());
        let status = fs::create_dir_all(&folder).and_then(|()| run_check(name, &log));
        let status = status.map_err(|error| format!("cannot run it: {error}"))?;
        let output = fs::read(&log).map_err(|error| format!("{}: {error}", log.display()))?;
        // At once, so that outputs do not mix. What cannot be printed is in the file.
        let _ = std::io::stdout().lock().write_all(&output);
        Ok(status.success())
    });
    result.unwrap_or_else(|problem| {
        eprintln!("== {name} failed: {problem}");
        false
    })
}

/// Runs a check by this program, with its output in a file.
fn run_check(name: &str, log: &Path) -> std::io::Result<ExitStatus> {
    let output = File::create(log)?;
    Command::new(std::env::current_exe()?)
        .args(["test", name])
        .stderr(output.try_clone()?)
        .stdout(output)
        .status()
}
