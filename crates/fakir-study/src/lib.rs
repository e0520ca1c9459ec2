//! Many cases: sweeps along the axes of a study, with a journal that survives a killed process, and tables of their results.
//!
//! ```
//! use fakir_case::{Case, StudyFile};
//! use fakir_study::{Options, Table};
//!
//! let text = format!(
//!     "[axes]\nsurface_fraction = [1e-3, 3e-3]\n\"pattern.offset\" = [0, 0.5]\n{}",
//!     Case::example().to_toml()
//! );
//! let study = StudyFile::parse("study.toml", &text)?.study()?;
//! let rows = fakir_study::sweep(&study, &mut Options::default())?;
//! assert_eq!(rows.len(), 4);
//! assert!(rows.iter().all(|row| row.problem.is_none()));
//! let table = Table::new(&study, &rows);
//! assert!(table.to_csv().starts_with("case,pattern.surface_fraction,pattern.offset,method,"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! * [`sweep`] computes every case of a [`Study`](fakir_case::Study) in memory; [`sweep_into`] does so in a folder, with a journal from
//!   which an interrupted sweep continues; [`merge`] combines the shards of a sweep.
//! * [`Ledger`] collects the results of cases that are computed elsewhere, for instance by [`solve`] in other processes.
//! * The result of a case depends on the study alone: not on threads, shards or interruptions. The table of a sweep that was killed and
//!   resumed is therefore identical, byte for byte.
//! * A case without a result has a row in the [`Table`], with the reason.
//! * [`fields`]: pressure, gap and displacement on a grid, as netCDF and for ParaView.
//! * [`answer`](mod@answer) answers a question about a case of any kind: its numbers, and the [`report`] that a command prints and saves.
//! * [`approach`](mod@approach) loads a lens step by step, [`compare`](mod@compare) evaluates every method,
//!   [`closed_forms`](mod@closed_forms) is the list of formulas.
//! * [`workshop`] has surfaces with rounded pillar tops as solids and maps of heights.
//! * [`surfaces`] solves a case with a general surface on a grid that is wide enough.
//! * [`record`] has one row for every number of a contact; [`result`] is what every answer is as a JSON object and as tables:
//!   command line, Python package and page show it and make none of their own.
//! * [`provenance`] is written into every file, [`citations`] lists the references to cite, [`output`] saves files completely or not
//!   at all, and [`results`] replaces folders of results.
//!
//! # From a study to a table
//!
//! A [`Study`](fakir_case::Study) becomes a plan, a list of cases; each case is passed to [`solve`], which returns a [`Row`]; rows are
//! written to the journal as they arrive, and the [`Table`] is created from them at the end, in the order of the plan.

pub mod answer;
pub mod approach;
pub mod citations;
pub mod closed_forms;
mod collapsed;
pub mod compare;
mod error;
mod exact;
pub mod fields;
pub mod figures;
mod folder;
pub mod history;
mod journal;
mod names;
pub mod numbers;
pub mod output;
mod plan;
pub mod provenance;
pub mod record;
pub mod report;
pub mod result;
pub mod results;
mod row;
pub mod surfaces;
mod sweep;
mod table;
#[cfg(feature = "parquet")]
mod table_parquet;
pub mod workshop;

pub use collapsed::{
    Collapsed, FloorJump, FloorLoss, FloorOutcome, LARGEST_INDENTATION, MODEL_ERROR_OF_LOSS, STEP,
    Validity, collapse, collapse_path,
};
pub use error::StudyError;
pub use folder::{Existing, Ledger, Summary, merge, sweep_into};
pub use journal::DamagedLine;
pub use names::TABLES;
pub use plan::{InvalidShard, Shard};
pub use row::{Row, RowAnswer};
pub use sweep::{Options, Progress, solve, sweep};
pub use table::{Column, Table, Values};

/// Former name of [`FloorOutcome`].
#[deprecated(note = "renamed to `FloorOutcome`")]
pub type Fate = FloorOutcome;

/// The version of fakir, written into every result.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
