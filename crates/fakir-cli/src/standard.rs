//! Standard input and output.

use crate::failure::Failure;
use fakir_case::CaseFile;
use fakir_case::input::{self, LARGEST_CASE};
use std::io::{ErrorKind, Write};
use std::path::Path;

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

/// Name of standard input in error messages.
pub(crate) const INPUT: &str = "standard input";

/// Reads all of standard input, up to a number of bytes.
pub(crate) fn read(most: u64) -> Result<Vec<u8>, Failure> {
    input::read_all(std::io::stdin(), most)
        .map_err(|error| Failure::file("cannot read", INPUT.as_ref(), error))
}

/// The case of a file, or of standard input, with overrides.
pub(crate) fn case_file(path: &Path, set: &[String]) -> Result<CaseFile, Failure> {
    let mut file = if path.as_os_str() == "-" {
        CaseFile::from_bytes(INPUT, read(LARGEST_CASE)?)?
    } else {
        CaseFile::read(path)?
    };
    for argument in set {
        file.set(argument)?;
    }
    Ok(file)
}
