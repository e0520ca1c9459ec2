//! Names of the files in the folder of a sweep.

/// The journal.
pub(crate) const JOURNAL: &str = "journal.jsonl";

/// The study in the folder of a sweep.
pub(crate) const STUDY: &str = "study.toml";

/// The table in the folder of a sweep.
pub(crate) const CSV: &str = "table.csv";

/// The table in the folder of a sweep, written by builds with the feature `parquet`.
pub(crate) const PARQUET: &str = "table.parquet";

/// The tables that a complete sweep saves in its folder.
pub const TABLES: &[&str] = &[
    CSV,
    #[cfg(feature = "parquet")]
    PARQUET,
];
