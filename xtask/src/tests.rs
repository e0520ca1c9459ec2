//! The tests of all crates, in two tiers: those that are not ignored, and those that are.
//!
//! All are compiled by one call of cargo, in the profile of the command. The test programs run one after another.

use crate::passed;
use crate::shell::{run, target_folder};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Packages that are not compiled with the others: two have dependencies that the first tier does not need; the extension
/// module has no tests, and maturin compiles it in a separate environment, so that compiling it here too would compile
/// pyo3 again at every run.
const EXCLUDED: [&str; 3] = ["fakir-checks", "fakir-manual", "fakir-py"];

/// What has dependencies that the command does not have, or needs private parts of `fakir`: one call of cargo, so that `fakir` is compiled only
/// once more for all of it.
const HEAVY: [&str; 13] = [
    "build",
    "--package",
    "fakir",
    "--package",
    "fakir-checks",
    "--package",
    "fakir-study",
    "--features",
    "fakir/kernels,fakir-study/parquet",
    "--test=figures",
    "--test=parquet",
    "--example",
    KERNELS,
];

/// The example whose instructions are counted.
const KERNELS: &str = "kernels";

/// Folders with files that tests in Rust read.
const READ: [&str; 3] = ["crates", "checks", "examples"];

/// A compiled program of tests.
pub(crate) struct Program {
    /// The package and the target: `fakir it`.
    pub(crate) name: String,
    pub(crate) executable: PathBuf,
    /// The folder of its package, in which it runs.
    pub(crate) folder: PathBuf,
}

/// Compiles by a call of cargo; returns the test programs.
pub(crate) fn build(cargo: &OsStr, options: &[&str]) -> Result<Vec<Program>, String> {
    let output = Command::new(cargo)
        .args(options)
        .args(["--release", "--locked"])
        .arg("--message-format=json-render-diagnostics")
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("cargo could not be started: {error}"))?;
    if !output.status.success() {
        return Err(format!("cargo {}: {}", options[0], output.status));
    }
    let messages = String::from_utf8_lossy(&output.stdout).into_owned();
    let mut programs: Vec<Program> = messages.lines().filter_map(program).collect();
    programs.sort_by(|a, b| a.name.cmp(&b.name));
    if programs.is_empty() {
        return Err("cargo compiled no tests".to_owned());
    }
    Ok(programs)
}

/// The test program of a message of cargo, if it is about one.
fn program(message: &str) -> Option<Program> {
    let text = |name: &str| {
        let start = message.find(&format!("\"{name}\":\""))? + name.len() + 4;
        let length = message[start..].find('"')?;
        Some(message[start..start + length].replace("\\\\", "\\"))
    };
    if !message.contains("\"reason\":\"compiler-artifact\"") || !message.contains("\"test\":true}")
    {
        return None;
    }
    let executable = PathBuf::from(text("executable")?);
    let folder = Path::new(&text("manifest_path")?).parent()?.to_owned();
    let package = folder.file_name()?.to_string_lossy().into_owned();
    let stem = executable.file_stem()?.to_string_lossy().into_owned();
    let target = stem.rsplit_once('-').map_or(&*stem, |(target, _)| target);
    let name = format!("{package} {target}");
    Some(Program {
        name,
        executable,
        folder,
    })
}

/// The tests of the first tier, and the program `fakir`.
pub(crate) fn light() -> Vec<&'static str> {
    let excluded = EXCLUDED.iter().flat_map(|name| ["--exclude", *name]);
    let targets = [
        "test",
        "--no-run",
        "--workspace",
        "--lib",
        "--bins",
        "--tests",
    ];
    targets.into_iter().chain(excluded).collect()
}

/// The first tier.
pub(crate) fn quick(cargo: &OsStr) -> Result<(), String> {
    run_tests(&build(cargo, &light())?, &[], "")
}

/// The second tier: tests that are marked `ignore`, and those of packages with heavy dependencies.
pub(crate) fn slow(cargo: &OsStr) -> Result<(), String> {
    // Campaigns are run by hand.
    let slow = ["--ignored", "--skip", "campaign_of_"];
    run_tests(&build(cargo, &light())?, &slow, " slow")?;
    run_tests(&build(cargo, &HEAVY)?, &["--include-ignored"], "")
}

/// Runs test programs, except those that passed before and have not changed since.
fn run_tests(programs: &[Program], options: &[&str], tier: &str) -> Result<(), String> {
    let command = command()?;
    let data = passed::data_files();
    let mut failed = Vec::new();
    for program in programs {
        let name = format!("{}{tier}", program.name);
        let files = data.as_ref().ok().and_then(|data| {
            let ran = program.name.starts_with("fakir-cli").then_some(&command);
            let read = data
                .iter()
                .filter(|file| READ.iter().any(|top| file.starts_with(top)));
            let files = [&program.executable].into_iter().chain(ran).chain(read);
            let files = files.map(PathBuf::as_path);
            passed::fingerprint(options, files).ok()
        });
        let result = passed::unless_passed(&name, files, || {
            println!("-- {name}");
            run(Command::new(&program.executable)
                .args(options)
                .current_dir(&program.folder))
        });
        if result.is_err() {
            failed.push(name);
        }
    }
    if failed.is_empty() {
        Ok(())
    } else {
        Err(format!("tests failed in {}", failed.join(", ")))
    }
}

/// The program `fakir`, which the tests of the command run.
fn command() -> Result<PathBuf, String> {
    let name = format!("release/fakir{}", std::env::consts::EXE_SUFFIX);
    Ok(target_folder()?.join(name))
}

/// Compiles the tests and the command, if this has not been done; returns the path of the command.
pub(crate) fn built_command(cargo: &OsStr) -> Result<PathBuf, String> {
    build(cargo, &light())?;
    command()
}

/// Compiles the example whose instructions are counted.
pub(crate) fn kernels(cargo: &OsStr) -> Result<PathBuf, String> {
    build(cargo, &HEAVY)?;
    example(KERNELS)
}

/// Compiles an example with the features of the tests, so that nothing else is compiled for it.
pub(crate) fn built_example(cargo: &OsStr, name: &str) -> Result<PathBuf, String> {
    let excluded = EXCLUDED.iter().flat_map(|name| ["--exclude", *name]);
    run(Command::new(cargo)
        .args(["build", "--release", "--locked", "--workspace"])
        .args(excluded)
        .args(["--example", name]))?;
    example(name)
}

fn example(name: &str) -> Result<PathBuf, String> {
    let file = format!("release/examples/{name}{}", std::env::consts::EXE_SUFFIX);
    Ok(target_folder()?.join(file))
}

#[cfg(test)]
mod messages {
    use super::*;

    #[test]
    fn programs_are_read_from_messages() {
        let message = r#"{"reason":"compiler-artifact","manifest_path":"/a/crates/fakir/Cargo.toml","target":{"name":"it"},"profile":{"opt_level":"3","test":true},"executable":"/a/target/release/deps/it-0123"}"#;
        let found = program(message).expect("a program of tests");
        assert_eq!(found.name, "fakir it");
        assert_eq!(
            found.executable,
            Path::new("/a/target/release/deps/it-0123")
        );
        assert_eq!(found.folder, Path::new("/a/crates/fakir"));
        assert!(program(&message.replace("\"test\":true", "\"test\":false")).is_none());
    }
}
