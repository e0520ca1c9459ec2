//! Why a sweep or a merge gives no tables.

use crate::output::OutputError;
use crate::plan::Shard;
use fakir_case::CaseError;
use std::io;
use std::path::{Path, PathBuf};

/// Why a sweep or a merge gives no tables.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A study in a journal that cannot be.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The sweep was cancelled.
    #[error("interrupted after {done} of {cases} cases")]
    Interrupted {
        /// Cases that have a row.
        done: usize,
        /// Cases in all.
        cases: usize,
    },
    /// A file or folder that cannot be read or written.
    #[error("{action} {}: {error}", .path.display())]
    File {
        /// What was attempted: `"cannot write"`.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// Files that cannot be saved.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Tables that cannot be saved at the end of a sweep.
    #[error("{0}; all cases are safe in the journal, and --resume writes the tables")]
    Tables(OutputError),
    /// A journal that cannot be written any more.
    #[error(
        "cannot write {}: {error}; the cases before are safe in it, and --resume goes on from there",
        .path.display()
    )]
    Journal {
        /// The journal.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// A folder that something is in already.
    #[error(
        "the folder {} is not empty: choose another, or --resume a sweep that was interrupted, or \
         --overwrite what is there", .0.display()
    )]
    NotEmpty(PathBuf),
    /// A folder in which there is no sweep.
    #[error("there is no sweep in {}: it has no journal.jsonl", .0.display())]
    NoSweep(PathBuf),
    /// A folder that another sweep is writing to.
    #[error("another sweep is running in {}", .0.display())]
    InUse(PathBuf),
    /// A journal that cannot be gone on with, as its first line or all of it is damaged.
    #[error(
        "{}:{line}: the journal is damaged: {problem}; --overwrite begins anew", .journal.display()
    )]
    Damaged {
        /// The journal.
        journal: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// A journal of the time before lines had checksums.
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
        /// The shard that was asked for.
        here: Shard,
    },
    /// A journal of a sweep with another limit on memory, by which cases may have failed.
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
    /// An answer from elsewhere that is none to a case of the study.
    #[error("not an answer to a case of this study: {0}")]
    Answer(String),
    /// A sweep that is to be finished before all cases have an answer.
    #[error("{missing} of {cases} cases have no answer yet")]
    Incomplete {
        /// Cases without a row.
        missing: usize,
        /// Cases in all.
        cases: usize,
    },
    /// Shards that are not one sweep.
    #[error("{0}")]
    Shards(String),
}

/// So many bytes, exactly: `8 GB`.
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
