//! Folders of results, which contain nothing else and can be replaced: only files written by fakir are removed.
//!
//! A folder of results has a `provenance.json` with the list of its files; an incomplete sweep has its journal instead. A folder with any
//! other file is not changed.

use crate::journal::{is_journal, is_running};
use crate::names::{CSV, JOURNAL, PARQUET, STUDY};
use crate::output::{File, OutputError, Replace, TEMPORARY, is_empty, save, temporary};
use crate::provenance::{FILE_NAME, Provenance};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Files of a sweep in its folder, for builds with any features.
const SWEEP: [&str; 5] = [JOURNAL, STUDY, CSV, PARQUET, FILE_NAME];

/// Checks that results can be saved in `folder`, or in a folder to be created there, before a long computation.
///
/// # Errors
/// [`OutputError`] if not; this includes a folder that is not empty unless it may be replaced, and, if it may, a folder that is not a
/// folder of results or contains other files.
pub fn check_folder(folder: &Path, replace: Replace) -> Result<(), OutputError> {
    if !is_empty(folder)? {
        match replace {
            Replace::Allowed => check(folder),
            Replace::Refused => Err(OutputError::NotEmpty {
                folder: folder.to_owned(),
            }),
        }?;
    }
    let existing = folder
        .ancestors()
        .find(|ancestor| ancestor.exists())
        .unwrap_or(Path::new("."));
    NamedTempFile::new_in(existing)
        .map(drop)
        .map_err(|error| OutputError::system("cannot write in", existing, error))
}

/// Saves results, including their provenance, in a separate folder: an empty or new one, or one of earlier results that is replaced as a
/// whole.
///
/// # Errors
/// As [`check_folder`], and if a file cannot be written.
pub fn save_results(folder: &Path, files: &[File], replace: Replace) -> Result<(), OutputError> {
    check_folder(folder, replace)?;
    if is_empty(folder)? {
        save(folder, files)
    } else {
        replace_folder(folder, files)
    }
}

/// Removes results from a folder. `parts` are subfolders that may contain separate results.
///
/// # Errors
/// [`OutputError`] if the folder contains files that fakir did not write, or if a sweep is running there; then nothing is removed.
pub fn remove_results(folder: &Path, parts: &[&str]) -> Result<(), OutputError> {
    if is_empty(folder)? {
        return Ok(());
    }
    let found = contents(folder, parts)?;
    remove(folder, &found, None)
}

/// All files of a folder of results, by relative path, folders after their content. `parts` are subfolders that may be separate folders of
/// results.
///
/// # Errors
/// [`OutputError`] if it is not a folder of results, contains files that fakir did not write, or if a sweep is running there.
pub(crate) fn contents(folder: &Path, parts: &[&str]) -> Result<Vec<PathBuf>, OutputError> {
    let mut written = BTreeSet::new();
    for part in std::iter::once(&"").chain(parts) {
        let part = Path::new(part);
        let files = files_of_results(&folder.join(part))?;
        written.extend(files.into_iter().map(|file| part.join(file)));
    }
    if written.is_empty() {
        return Err(OutputError::NoResults {
            folder: folder.to_owned(),
        });
    }
    let mut found = Vec::new();
    collect(folder, Path::new(""), &written, &mut found)?;
    Ok(found)
}

/// Files that fakir wrote in a folder, or may have written; empty if it is not a folder of results.
fn files_of_results(folder: &Path) -> Result<Vec<PathBuf>, OutputError> {
    let mut files = Vec::new();
    if let Ok(provenance) = Provenance::read(&folder.join(FILE_NAME)) {
        files.push(PathBuf::from(FILE_NAME));
        files.extend(provenance.files.into_iter().map(PathBuf::from));
    }
    let journal = folder.join(JOURNAL);
    if is_journal(&journal) {
        if is_running(&journal) {
            return Err(OutputError::InUse {
                folder: folder.to_owned(),
            });
        }
        files.extend(SWEEP.map(PathBuf::from));
    }
    Ok(files)
}

/// Adds the content of `inner` in a folder to `found`, if fakir wrote all of it.
fn collect(
    folder: &Path,
    inner: &Path,
    written: &BTreeSet<PathBuf>,
    found: &mut Vec<PathBuf>,
) -> Result<(), OutputError> {
    let place = folder.join(inner);
    let unreadable = |error| OutputError::system("cannot read the folder", &place, error);
    for entry in fs::read_dir(&place).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let kind = entry.file_type().map_err(unreadable)?;
        let path = inner.join(entry.file_name());
        if kind.is_dir() && written.iter().any(|file| file.starts_with(&path)) {
            collect(folder, &path, written, found)?;
        } else {
            let is_temporary = entry.file_name().to_string_lossy().starts_with(TEMPORARY);
            if !(kind.is_file() && (written.contains(&path) || is_temporary)) {
                return Err(OutputError::Foreign { path: entry.path() });
            }
        }
        found.push(path);
    }
    Ok(())
}

/// Removes the files found by [`contents`], except one.
pub(crate) fn remove(
    folder: &Path,
    found: &[PathBuf],
    except: Option<&str>,
) -> Result<(), OutputError> {
    for path in found
        .iter()
        .filter(|path| Some(path.as_path()) != except.map(Path::new))
    {
        let path = folder.join(path);
        let removed = if path.is_dir() {
            fs::remove_dir(&path)
        } else {
            fs::remove_file(&path)
        };
        removed.map_err(|error| OutputError::system("cannot remove", &path, error))?;
    }
    Ok(())
}

/// Checks whether [`replace_folder`] is possible.
fn check(folder: &Path) -> Result<(), OutputError> {
    contents(folder, &[])?;
    let unusable = |error| OutputError::system("cannot replace the folder", folder, error);
    let place = folder.canonicalize().map_err(unusable)?;
    // A process working in the folder would be left in a deleted one.
    let here = std::env::current_dir().and_then(|here| here.canonicalize());
    if here.is_ok_and(|here| here.starts_with(&place)) {
        return Err(OutputError::Inside {
            folder: folder.to_owned(),
        });
    }
    let beside = temporary().tempfile_in(beside(&place));
    beside.map(drop).map_err(unusable)
}

/// The parent of a folder.
fn beside(place: &Path) -> &Path {
    place.parent().unwrap_or(place)
}

/// Replaces a folder of results completely by a new folder with these files. The new one is complete before the old one is changed.
fn replace_folder(folder: &Path, files: &[File]) -> Result<(), OutputError> {
    let unusable = |error| OutputError::system("cannot replace the folder", folder, error);
    let place = folder.canonicalize().map_err(unusable)?;
    let found = contents(&place, &[])?;
    let parent = beside(&place);
    let fresh = temporary().tempdir_in(parent).map_err(unusable)?;
    save(fresh.path(), files)?;
    let permissions = fs::metadata(&place).map_err(unusable)?.permissions();
    fs::set_permissions(fresh.path(), permissions).map_err(unusable)?;
    let aside = temporary().tempdir_in(parent).map_err(unusable)?;
    let old = aside.path().join("old");
    fs::rename(&place, &old).map_err(unusable)?;
    if let Err(error) = fs::rename(fresh.path(), &place) {
        fs::rename(&old, &place).map_err(|_| OutputError::Aside {
            folder: folder.to_owned(),
            old: aside.keep().join("old"),
        })?;
        return Err(unusable(error));
    }
    let _ = fresh.keep(); // it has been moved to its place
    let emptied = remove(&old, &found, None).and_then(|()| {
        fs::remove_dir(&old).map_err(|error| OutputError::system("cannot remove", &old, error))
    });
    if emptied.is_err() {
        let _ = aside.keep(); // files added in the meantime are not lost
    }
    emptied
}

#[cfg(test)]
mod tests {
    use super::*;

    fn results(names: &[&str]) -> Vec<File> {
        let mut files: Vec<File> = names
            .iter()
            .map(|name| File::new((*name).to_owned(), *name))
            .collect();
        files.push(Provenance::new("q", "m", &[], "").file(names.iter().copied()));
        files
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn old_results_are_replaced_whole() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("results");
        let old = results(&["old.csv", "figures/old.svg", "both.csv"]);
        save_results(&folder, &old, Replace::Refused).unwrap();
        fs::write(folder.join(".fakir-left-over"), "").unwrap();
        let new = results(&["both.csv", "tables/new.csv"]);
        let error = save_results(&folder, &new, Replace::Refused).unwrap_err();
        assert!(matches!(error, OutputError::NotEmpty { .. }), "{error}");
        assert!(folder.join("figures/old.svg").exists());
        save_results(&folder, &new, Replace::Allowed).unwrap();
        assert_eq!(names(&folder), ["both.csv", "provenance.json", "tables"]);
        assert_eq!(names(root.path()), ["results"]);
    }

    #[test]
    fn what_fakir_did_not_write_is_left_alone() {
        let root = tempfile::tempdir().unwrap();
        let new = results(&["new.csv"]);
        let refused = |folder: &Path| {
            let before = names(folder);
            let checked = check_folder(folder, Replace::Allowed).unwrap_err();
            let saved = save_results(folder, &new, Replace::Allowed).unwrap_err();
            assert_eq!(checked.to_string(), saved.to_string());
            assert_eq!(names(folder), before);
            checked
        };
        let home = root.path().join("home");
        fs::create_dir(&home).unwrap();
        fs::write(home.join("letter.txt"), "mine").unwrap();
        assert!(matches!(refused(&home), OutputError::NoResults { .. }));
        // Neither the user's own files among results, nor a folder, a link, or results in it.
        for name in ["notes.txt", "folder", "link", "inner"] {
            let folder = root.path().join(format!("with-{name}"));
            save_results(&folder, &results(&["old.csv"]), Replace::Refused).unwrap();
            let path = folder.join(name);
            match name {
                "folder" => fs::create_dir(&path).unwrap(),
                "inner" => save_results(&path, &results(&["a.csv"]), Replace::Refused).unwrap(),
                #[cfg(unix)]
                "link" => std::os::unix::fs::symlink(&home, &path).unwrap(),
                _ => fs::write(&path, "mine").unwrap(),
            }
            let error = refused(&folder);
            assert!(error.to_string().contains(name), "{error}");
        }
        // Results of versions without lists of files.
        let folder = root.path().join("earlier");
        save_results(&folder, &results(&["old.csv"]), Replace::Refused).unwrap();
        fs::write(
            folder.join(FILE_NAME),
            Provenance::new("q", "m", &[], "").to_json(),
        )
        .unwrap();
        assert!(matches!(refused(&folder), OutputError::Foreign { .. }));
        assert!(home.join("letter.txt").exists());
    }
}
