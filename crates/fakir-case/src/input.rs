//! Reads files of limited size: neither reading nor memory exceeds the limit for the kind of file.
//!
//! The path may be anything, such as a device without an end, or a wrong file.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Largest case file, bytes.
pub const LARGEST_CASE: u64 = 4_000_000;

/// Largest study file, bytes: it may have long lists of values.
pub const LARGEST_STUDY: u64 = 16_000_000;

/// Largest table of measured values, bytes.
pub const LARGEST_TABLE: u64 = 16_000_000;

/// Reads a whole file, which may have at most `most` bytes.
///
/// # Errors
/// If the file cannot be read, or has more ([`ErrorKind::FileTooLarge`]).
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    read_all(File::open(path)?, most)
}

/// Reads a whole source, which may have at most `most` bytes.
///
/// # Errors
/// As [`read`].
pub fn read_all(source: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    source
        .take(most.saturating_add(1))
        .read_to_end(&mut bytes)?;
    if bytes.len() as u64 <= most {
        return Ok(bytes);
    }
    let problem = format!(
        "it has more than {} MB, the most that is read",
        most / 1_000_000
    );
    Err(io::Error::new(ErrorKind::FileTooLarge, problem))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_source_without_end_is_refused() {
        assert_eq!(read_all(&b"abc"[..], 3).unwrap(), b"abc");
        let error = read_all(io::repeat(0), 2_000_000).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::FileTooLarge);
        assert!(error.to_string().contains("more than 2 MB"), "{error}");
    }
}
