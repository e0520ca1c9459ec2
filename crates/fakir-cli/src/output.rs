//! Standard output, and files that are there whole or not at all.

use crate::failure::Failure;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file to be saved.
#[derive(Debug, Clone)]
pub(crate) struct File {
    name: &'static str,
    contents: Vec<u8>,
}

impl File {
    pub(crate) fn new(name: &'static str, contents: impl Into<Vec<u8>>) -> Self {
        Self {
            name,
            contents: contents.into(),
        }
    }
}

/// Prints a result.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    let written = stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.write_all(if text.ends_with('\n') { b"" } else { b"\n" }))
        .and_then(|()| stdout.flush());
    written.map_err(|error| match error.kind() {
        ErrorKind::BrokenPipe => Failure::OutputClosed,
        _ => Failure::file("cannot write", "standard output".as_ref(), error),
    })
}

/// Whether files can be saved in `folder`, or in a folder to be made there: better known before
/// a long computation than after it.
pub(crate) fn check_folder(folder: &Path) -> Result<(), Failure> {
    let existing = folder
        .ancestors()
        .find(|ancestor| ancestor.exists())
        .unwrap_or(Path::new("."));
    NamedTempFile::new_in(existing)
        .map(drop)
        .map_err(|error| Failure::file("cannot write in", existing, error))
}

/// Saves all files in `folder`, which is made if need be. Every file is first written in full
/// under a temporary name next to its place; only then are they renamed.
pub(crate) fn save(folder: &Path, files: &[File]) -> Result<(), Failure> {
    std::fs::create_dir_all(folder)
        .map_err(|error| Failure::file("cannot make the folder", folder, error))?;
    let written: Result<Vec<_>, Failure> = files
        .iter()
        .map(|file| {
            let path = folder.join(file.name);
            Ok((write_beside(&path, &file.contents)?, path))
        })
        .collect();
    for (temporary, path) in written? {
        rename(temporary, &path, Replace::Allowed)?;
    }
    Ok(())
}

/// Whether a file that is there already may be replaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Replace {
    Allowed,
    Refused,
}

/// Saves one file.
pub(crate) fn save_file(path: &Path, contents: &str, replace: Replace) -> Result<(), Failure> {
    rename(write_beside(path, contents.as_bytes())?, path, replace)
}

/// A temporary file in the folder of `path`, removed again unless it is renamed.
fn write_beside(path: &Path, contents: &[u8]) -> Result<NamedTempFile, Failure> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    };
    let write = || {
        let mut file = readable_by_all().tempfile_in(&folder)?;
        file.write_all(contents)?;
        file.as_file().sync_all()?;
        Ok(file)
    };
    write().map_err(|error| Failure::file("cannot write", path, error))
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

fn rename(file: NamedTempFile, path: &Path, replace: Replace) -> Result<(), Failure> {
    let renamed = match replace {
        Replace::Allowed => file.persist(path),
        Replace::Refused => file.persist_noclobber(path),
    };
    match renamed {
        Ok(_) => Ok(()),
        Err(error) if error.error.kind() == ErrorKind::AlreadyExists => {
            Err(Failure::Argument(format!(
                "{} is there already: choose another name, or --force to replace it",
                path.display()
            )))
        }
        Err(error) => Err(Failure::file("cannot write", path, error.error)),
    }
}
