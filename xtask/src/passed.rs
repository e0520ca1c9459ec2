//! Records checks that have passed with the same inputs, which need not run again.
//!
//! A check's inputs are files: programs by their contents, and all files of the repository that are not Rust source, as tests
//! may read any of them. Rust source counts through the programs that are built from it.

use crate::shell::target_folder;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A hash of the contents of files.
pub(crate) fn fingerprint<'a>(
    words: &[&str],
    files: impl IntoIterator<Item = &'a Path>,
) -> Result<u64, String> {
    let mut hasher = DefaultHasher::new();
    words.hash(&mut hasher);
    for file in files {
        file.hash(&mut hasher);
        let contents =
            fs::read(file).map_err(|error| format!("cannot read {}: {error}", file.display()))?;
        contents.hash(&mut hasher);
    }
    Ok(hasher.finish())
}

/// The files of the repository, tracked or not ignored, that are not Rust source.
pub(crate) fn data_files() -> Result<Vec<PathBuf>, String> {
    let listed = Command::new("git")
        .args([
            "ls-files",
            "-z",
            "--cached",
            "--others",
            "--exclude-standard",
        ])
        .output()
        .map_err(|error| format!("git could not be started: {error}"))?;
    let mut files: Vec<PathBuf> = String::from_utf8_lossy(&listed.stdout)
        .split('\0')
        .filter(|name| !name.is_empty() && !name.ends_with(".rs"))
        .map(PathBuf::from)
        .filter(|file| file.is_file())
        .collect();
    files.sort();
    if files.is_empty() {
        // Not a checkout: nothing can be compared, so nothing has passed.
        return Err("git lists no files".to_owned());
    }
    Ok(files)
}

/// Runs a check unless it passed with the same fingerprint before; `None` always runs it.
pub(crate) fn unless_passed(
    name: &str,
    fingerprint: Option<u64>,
    check: impl FnOnce() -> Result<(), String>,
) -> Result<(), String> {
    let folder = target_folder()?.join("passed");
    let record = folder.join(name);
    let found = fingerprint.map(|number| format!("{number:016x}"));
    if found.is_some() && fs::read_to_string(&record).ok() == found {
        println!(
            "-- {name}: nothing changed since it passed (remove target/passed to run it again)"
        );
        return Ok(());
    }
    check()?;
    if let Some(found) = found {
        let written = fs::create_dir_all(&folder).and_then(|()| fs::write(&record, found));
        written.map_err(|error| format!("cannot write {}: {error}", record.display()))?;
    }
    Ok(())
}
