//! Files that are there whole or not at all.
//!
//! Every file is first written in full under a temporary name next to its place, and only then
//! renamed; what is interrupted leaves nothing behind.

use std::borrow::Cow;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file to be saved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Its name in the folder it is saved in; with a `/`, in a folder in there.
    pub name: Cow<'static, str>,
    /// All of it.
    pub contents: Vec<u8>,
}

impl File {
    /// A file of a text or of bytes.
    pub fn new(name: impl Into<Cow<'static, str>>, contents: impl Into<Vec<u8>>) -> Self {
        Self {
            name: name.into(),
            contents: contents.into(),
        }
    }
}

/// Why files could not be saved.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The system refused.
    #[error("{action} {}: {error}", path.display())]
    System {
        /// What was tried: `"cannot write"`.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// Why it was refused.
        error: std::io::Error,
    },
    /// There is a file already, which may not be replaced.
    #[error("{} is there already", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
}

impl OutputError {
    fn system(action: &'static str, path: &Path, error: std::io::Error) -> Self {
        Self::System {
            action,
            path: path.to_owned(),
            error,
        }
    }
}

/// Whether a file that is there already may be replaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Replace {
    /// It may.
    Allowed,
    /// It stays, and saving fails with [`OutputError::Exists`].
    Refused,
}

/// Whether files can be saved in `folder`, or in a folder to be made there: better known before
/// a long computation than after it.
///
/// # Errors
/// [`OutputError::System`] if not.
pub fn check_folder(folder: &Path) -> Result<(), OutputError> {
    let existing = folder
        .ancestors()
        .find(|ancestor| ancestor.exists())
        .unwrap_or(Path::new("."));
    NamedTempFile::new_in(existing)
        .map(drop)
        .map_err(|error| OutputError::system("cannot write in", existing, error))
}

/// Saves all files in `folder`, which is made if need be, replacing what has their names. All are
/// written in full before the first gets its name.
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

/// Saves one file, in a folder that is there.
///
/// # Errors
/// [`OutputError`] if it cannot be written, or is there already and may not be replaced.
pub fn save_file(path: &Path, contents: &[u8], replace: Replace) -> Result<(), OutputError> {
    rename(write_beside(path, contents)?, path, replace)
}

/// A temporary file in the folder of `path`, removed again unless it is renamed.
fn write_beside(path: &Path, contents: &[u8]) -> Result<NamedTempFile, OutputError> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let write = || {
        let mut file = readable_by_all().tempfile_in(folder)?;
        file.write_all(contents)?;
        file.as_file().sync_all()?;
        Ok(file)
    };
    write().map_err(|error| OutputError::system("cannot write", path, error))
}

/// Temporary files are private by default; results get the permissions of ordinary new files.
fn readable_by_all() -> tempfile::Builder<'static, 'static> {
    #[allow(unused_mut)]
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666)); // less the umask
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
        assert!(check_folder(&folder).is_ok());
        assert!(names(root.path()).is_empty());
        let error = save(&folder, &[good.clone(), bad]).unwrap_err();
        let told = error.to_string();
        assert!(told.starts_with("cannot make the folder "), "{told}");
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
