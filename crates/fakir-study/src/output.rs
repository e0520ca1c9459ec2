//! Files that are there whole or not at all.

use crate::error::StudyError;
use std::io::Write;
use std::path::Path;
use tempfile::NamedTempFile;

/// Saves files in a folder. All of them are first written in full under temporary names next to
/// their places; only then are they renamed.
pub(crate) fn save(folder: &Path, files: &[(&str, Vec<u8>)]) -> Result<(), StudyError> {
    let written: Result<Vec<_>, StudyError> = files
        .iter()
        .map(|(name, contents)| {
            let path = folder.join(name);
            let file = write_beside(folder, contents)
                .map_err(|error| StudyError::file("cannot write", &path, error))?;
            Ok((file, path))
        })
        .collect();
    for (file, path) in written? {
        file.persist(&path)
            .map_err(|error| StudyError::file("cannot write", &path, error.error))?;
    }
    Ok(())
}

/// A temporary file, removed again unless it is renamed.
fn write_beside(folder: &Path, contents: &[u8]) -> std::io::Result<NamedTempFile> {
    #[allow(unused_mut)]
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Temporary files are private by default.
        builder.permissions(std::fs::Permissions::from_mode(0o666)); // less the umask
    }
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(contents)?;
    file.as_file().sync_all()?;
    Ok(file)
}
