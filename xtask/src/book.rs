//! The manual: executes its pages, converts its formulas, and builds the book in `target/book`.

use crate::browser;
use crate::python;
use crate::shell::{run, run_cargo, target_folder};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The pages, the program that builds the book, and the script that executes the blocks of pages.
const BOOK: &str = "book";

/// The pages of theory, and their versions with formulas for rustdoc.
const THEORY: [&str; 2] = ["crates/fakir/doc", "crates/fakir/doc/rendered"];

/// Builds the book, and checks that every page agrees with the output of its commands.
pub(crate) fn check(cargo: &OsStr) -> Result<(), String> {
    make(cargo, false)
}

/// Builds the book, and writes the output of commands into its pages.
pub(crate) fn update(cargo: &OsStr) -> Result<(), String> {
    make(cargo, true)
}

fn make(cargo: &OsStr, update: bool) -> Result<(), String> {
    let target = target_folder()?;
    let manual = manual(cargo, &target)?;
    let mut theory = Command::new(&manual);
    theory.arg("theory").args(THEORY);
    if !update {
        theory.arg("--check");
    }
    run(&mut theory)?;

    let (python, program, _) = python::package(cargo)?;
    let pages = target.join("book-pages");
    if pages.exists() {
        std::fs::remove_dir_all(&pages)
            .map_err(|error| format!("cannot remove {}: {error}", pages.display()))?;
    }
    let mut runner = Command::new(&python);
    runner
        .arg(format!("{BOOK}/pages.py"))
        .arg(format!("{BOOK}/pages"))
        .arg(&pages)
        .env("PATH", path_with([&program, &python])?)
        .env("CHROMIUM", browser::chromium()?)
        .env("PYTHONDONTWRITEBYTECODE", "1");
    if update {
        runner.arg("--update");
    }
    run(&mut runner).map_err(|_| {
        "pages differ from the output of their commands: if the output is right, run \
         cargo xtask book --update"
            .to_owned()
    })?;
    let output = target.join("book");
    run(Command::new(&manual)
        .arg("build")
        .arg(format!("{BOOK}/book.toml"))
        .arg(&pages)
        .arg(&output))?;
    println!("the manual: {}", output.join("index.html").display());
    Ok(())
}

/// The program that builds the book.
fn manual(cargo: &OsStr, target: &Path) -> Result<PathBuf, String> {
    run_cargo(cargo, "build --release --locked --package fakir-manual")?;
    let name = format!("release/fakir-manual{}", std::env::consts::EXE_SUFFIX);
    Ok(target.join(name))
}

/// The search path for programs, with the folders of these first.
fn path_with(programs: [&Path; 2]) -> Result<std::ffi::OsString, String> {
    let first = programs.iter().filter_map(|program| program.parent());
    let others = std::env::var_os("PATH").unwrap_or_default();
    let all = first
        .map(Path::to_path_buf)
        .chain(std::env::split_paths(&others));
    std::env::join_paths(all).map_err(|error| error.to_string())
}
