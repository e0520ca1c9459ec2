//! Atomic writing of files.
//!
//! Every file is first written completely under a temporary name in the same folder, and then renamed; an interruption leaves nothing
//! behind.

use serde::Serialize;
use std::borrow::Cow;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file to be saved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Its path in the folder where it is saved; a `/` separates subfolders.
    pub name: Cow<'static, str>,
    /// All its bytes.
    pub contents: Vec<u8>,
}

impl File {
    /// Creates a file from a text or from bytes.
    pub fn new(name: impl Into<Cow<'static, str>>, contents: impl Into<Vec<u8>>) -> Self {
        Self {
            name: name.into(),
            contents: contents.into(),
        }
    }
}

/// Errors of saving files.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// Error of the operating system.
    #[error("{action} {}: {error}", path.display())]
    System {
        /// The attempted action: `"cannot write"`.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The error.
        error: std::io::Error,
    },
    /// The folder is not empty.
    #[error(
        "the folder {} is not empty: choose another, or --overwrite results that are there",
        folder.display()
    )]
    NotEmpty {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder to be overwritten contains no results of fakir.
    #[error(
        "{} is not overwritten: it is no folder of results, as it has no provenance.json that fakir \
         wrote", folder.display()
    )]
    NoResults {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder to be overwritten contains more than results of fakir.
    #[error(
        "nothing is overwritten: {} is not among the files that fakir lists in provenance.json; move \
         it away, or choose another folder", path.display()
    )]
    Foreign {
        /// A file that is not from fakir, or from a version without a list of files.
        path: PathBuf,
    },
    /// A sweep is running in the folder to be overwritten.
    #[error("{} is not overwritten: a sweep is running there", folder.display())]
    InUse {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder to be overwritten is the current one, or contains it.
    #[error(
        "{} is not overwritten: it is the current folder, or contains it; choose another",
        folder.display()
    )]
    Inside {
        /// The folder.
        folder: PathBuf,
    },
    /// The old results were moved aside, but neither the new nor the old ones could be moved to their place.
    #[error("{} could not be replaced; what was there is in {}", folder.display(), old.display())]
    Aside {
        /// The folder.
        folder: PathBuf,
        /// Location of the old results.
        old: PathBuf,
    },
    /// A file exists where a folder is required.
    #[error("{} is a file, not a folder: name a folder that is empty or to be made", path.display())]
    NoFolder {
        /// The file.
        path: PathBuf,
    },
    /// The folder of the file does not exist.
    #[error("cannot write {}: there is no folder {}; make it first, or name a file in another folder", path.display(), folder.display())]
    MissingFolder {
        /// The file.
        path: PathBuf,
        /// The folder.
        folder: PathBuf,
    },
    /// The file exists and must not be replaced.
    #[error("{} is there already", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
}

impl OutputError {
    pub(crate) fn system(action: &'static str, path: &Path, error: std::io::Error) -> Self {
        Self::System {
            action,
            path: path.to_owned(),
            error,
        }
    }
}

/// Whether an existing file, or folder of results, may be replaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Replace {
    /// It may be replaced.
    Allowed,
    /// It is kept, and saving fails.
    Refused,
}

/// Whether a folder is empty or does not exist.
pub(crate) fn is_empty(folder: &Path) -> Result<bool, OutputError> {
    match folder.read_dir() {
        Ok(mut entries) => Ok(entries.next().is_none()),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(true),
        Err(error) => Err(file_in_place_of(folder)
            .unwrap_or_else(|| OutputError::system("cannot read the folder", folder, error))),
    }
}

/// Refuses a folder that is a file, or is below one.
fn file_in_place_of(folder: &Path) -> Option<OutputError> {
    let file = folder.ancestors().find(|ancestor| ancestor.is_file())?;
    Some(OutputError::NoFolder {
        path: file.to_owned(),
    })
}

/// A CSV file of flat records, with a heading of their names.
///
/// # Panics
/// If a record is not flat.
pub fn csv_file<T: Serialize>(name: &'static str, rows: impl Iterator<Item = T>) -> File {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).expect("flat structs are CSV records");
    }
    File::new(name, writer.into_inner().expect("memory takes every byte"))
}

/// Saves all files in `folder`, which is created if necessary, replacing files of the same names. All are written completely before the
/// first is renamed.
///
/// # Errors
/// [`OutputError::System`] if a file cannot be written or renamed.
pub fn save(folder: &Path, files: &[File]) -> Result<(), OutputError> {
    let make = |folder: &Path| {
        std::fs::create_dir_all(folder)
            .map_err(|error| OutputError::system("cannot make the folder", folder, error))
    };
    make(folder)?;
    let written: Result<Vec<_>, OutputError> = files
        .iter()
        .map(|file| {
            let path = folder.join(file.name.as_ref());
            if let Some(inner) = path.parent() {
                make(inner)?;
            }
            Ok((write_beside(&path, &file.contents)?, path))
        })
        .collect();
    for (temporary, path) in written? {
        rename(temporary, &path, Replace::Allowed)?;
    }
    Ok(())
}

/// Saves one file in an existing folder.
///
/// # Errors
/// [`OutputError`] if it cannot be written, or exists and must not be replaced.
pub fn save_file(path: &Path, contents: &[u8], replace: Replace) -> Result<(), OutputError> {
    rename(write_beside(path, contents)?, path, replace)
}

/// Creates a temporary file in the folder of `path`, which is deleted unless it is renamed.
fn write_beside(path: &Path, contents: &[u8]) -> Result<NamedTempFile, OutputError> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let write = || {
        let mut file = readable_by_all(&mut temporary()).tempfile_in(folder)?;
        file.write_all(contents)?;
        file.as_file().sync_all()?;
        Ok(file)
    };
    write().map_err(|error: std::io::Error| {
        file_in_place_of(folder).unwrap_or_else(|| match error.kind() {
            ErrorKind::NotFound => OutputError::MissingFolder {
                path: path.to_owned(),
                folder: folder.to_owned(),
            },
            _ => OutputError::system("cannot write", path, error),
        })
    })
}

/// Prefix of the names of temporary files and folders.
pub(crate) const TEMPORARY: &str = ".fakir-";

/// Builder of temporary files and folders.
pub(crate) fn temporary() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY);
    builder
}

/// Temporary files are private by default; results get the permissions of ordinary new files.
fn readable_by_all<'b>(
    builder: &'b mut tempfile::Builder<'static, 'static>,
) -> &'b mut tempfile::Builder<'static, 'static> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666)); // minus the umask
    }
    builder
}

fn rename(file: NamedTempFile, path: &Path, replace: Replace) -> Result<(), OutputError> {
    let renamed = match replace {
        Replace::Allowed => file.persist(path),
        Replace::Refused => file.persist_noclobber(path),
    };
    match renamed {
        Ok(_) => Ok(()),
        Err(error) if error.error.kind() == ErrorKind::AlreadyExists => Err(OutputError::Exists {
            path: path.to_owned(),
        }),
        Err(error) => Err(OutputError::system("cannot write", path, error.error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_folder_gets_all_files_or_none() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("new/results");
        let good = File::new("a.txt", "a");
        let bad = File::new(format!("{}/b.txt", "long".repeat(100)), "b");
        let error = save(&folder, &[good.clone(), bad]).unwrap_err();
        let message = error.to_string();
        assert!(message.starts_with("cannot make the folder "), "{message}");
        assert!(names(&folder).is_empty());
        save(&folder, &[good, File::new(format!("{}.txt", "b"), "b")]).unwrap();
        assert_eq!(names(&folder), ["a.txt", "b.txt"]);
    }

    #[test]
    fn what_may_not_be_replaced_stays() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a.txt");
        save_file(&path, b"first", Replace::Refused).unwrap();
        let error = save_file(&path, b"second", Replace::Refused).unwrap_err();
        assert!(matches!(error, OutputError::Exists { .. }), "{error}");
        assert_eq!(std::fs::read(&path).unwrap(), b"first");
        save_file(&path, b"third", Replace::Allowed).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"third");
        assert_eq!(names(root.path()), ["a.txt"]);
    }
}
