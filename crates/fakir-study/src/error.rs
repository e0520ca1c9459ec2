//! Errors of a sweep or a merge.

use crate::output::OutputError;
use crate::plan::Shard;
use fakir_case::CaseError;
use std::io;
use std::path::{Path, PathBuf};

/// Errors of a sweep or a merge.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A journal contains an invalid study.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The sweep was cancelled.
    #[error("interrupted after {done} of {cases} cases")]
    Interrupted {
        /// Number of cases with a row.
        done: usize,
        /// Total number of cases.
        cases: usize,
    },
    /// A file or folder cannot be read or written.
    #[error("{action} {}: {error}", .path.display())]
    File {
        /// What was attempted: `"cannot write"`.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
    /// Files cannot be saved.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Tables cannot be saved at the end of a sweep.
    #[error("{0}; all cases are safe in the journal, and --resume writes the tables")]
    Tables(OutputError),
    /// A journal can no longer be written.
    #[error(
        "cannot write {}: {error}; it contains the cases before, and --resume continues from there",
        .path.display()
    )]
    Journal {
        /// The journal.
        path: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The folder is not empty.
    #[error(
        "the folder {} is not empty: choose another, or --resume a sweep that was interrupted, or \
         --overwrite what is there", .0.display()
    )]
    NotEmpty(PathBuf),
    /// There is no sweep in the folder.
    #[error("there is no sweep in {}: it has no journal.jsonl", .0.display())]
    NoSweep(PathBuf),
    /// Another sweep is writing to the folder.
    #[error("another sweep is running in {}", .0.display())]
    InUse(PathBuf),
    /// The journal cannot be continued, because its first line or all of it is damaged.
    #[error(
        "{}:{line}: the journal is damaged: {problem}; --overwrite starts again", .journal.display()
    )]
    Damaged {
        /// The journal.
        journal: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// A journal of a format without checksums.
    #[error(
        "{} was begun by an earlier fakir that wrote no checksums, so that damage to it cannot be \
         noticed: finish it with that version, or --overwrite", .0.display()
    )]
    NoChecksums(PathBuf),
    /// A journal of another study.
    #[error(
        "{} is of another study: line {line} of the study was\n  {there}\nand is now\n  {here}",
        .journal.display()
    )]
    OtherStudy {
        /// The journal.
        journal: PathBuf,
        /// The first line in which the studies differ, from 1.
        line: usize,
        /// The line in the journal.
        there: String,
        /// The line now.
        here: String,
    },
    /// A journal of another version.
    #[error(
        "{} is by fakir {there}, and this is {here}: results of both would be mixed; resume with \
         version {there}, or --overwrite", .journal.display()
    )]
    OtherVersion {
        /// The journal.
        journal: PathBuf,
        /// The version of the journal.
        there: String,
        /// This version.
        here: &'static str,
    },
    /// A journal of another shard.
    #[error("{} is of shard {there}, not of {here}", .journal.display())]
    OtherShard {
        /// The journal.
        journal: PathBuf,
        /// The shard of the journal.
        there: Shard,
        /// The requested shard.
        here: Shard,
    },
    /// A journal of a sweep with another memory limit, which may have caused cases to fail.
    #[error(
        "{} is of a sweep with {} of memory for a case, and this has {}: give the same limit, or \
         --overwrite", .journal.display(), memory(*.there), memory(*.here)
    )]
    OtherMemory {
        /// The journal.
        journal: PathBuf,
        /// The limit then, bytes.
        there: usize,
        /// The limit now, bytes.
        here: usize,
    },
    /// A result from elsewhere that does not belong to a case of the study.
    #[error("not an answer to a case of this study: {0}")]
    Answer(String),
    /// The sweep is incomplete.
    #[error("{missing} of {cases} cases have no answer yet")]
    Incomplete {
        /// Number of cases without a row.
        missing: usize,
        /// Total number of cases.
        cases: usize,
    },
    /// Shards do not form one sweep.
    #[error("{0}")]
    Shards(String),
}

/// A number of bytes, exactly: `8 GB`.
pub(crate) fn memory(bytes: usize) -> String {
    let units = [(1_000_000_000, "GB"), (1_000_000, "MB"), (1000, "kB")];
    match units.iter().find(|(size, _)| bytes.is_multiple_of(*size)) {
        Some((size, unit)) => format!("{} {unit}", bytes / size),
        None => format!("{bytes} bytes"),
    }
}

impl StudyError {
    pub(crate) fn file(action: &'static str, path: &Path, error: io::Error) -> Self {
        Self::File {
            action,
            path: path.to_owned(),
            error,
        }
    }
}
