//! Sweeps that are stored in a folder, and merging of the folders of shards.
//!
//! | file | content |
//! |---|---|
//! | `journal.jsonl` | the result of every case, with its computing time; an interrupted sweep continues from it |
//! | `study.toml` | the study in its canonical form |
//! | `table.csv` | one row per case |
//! | `table.parquet` | the same, in builds with the feature `parquet` |
//! | `pull-off.svg`, `pull-off.png` | for a complete sweep of cycles: pull-off force and hysteresis |
//! | `provenance.json` | version, study, methods, reference |

use crate::error::{StudyError, memory};
use crate::figures::{of_study, saved};
use crate::journal::{Contents, DamagedLine, Found, Header, Journal, first_difference, whole};
#[cfg(feature = "parquet")]
use crate::names::PARQUET;
use crate::names::{CSV, JOURNAL, STUDY};
use crate::output::{File, OutputError, Replace, is_empty, save};
use crate::plan::{Plan, Shard, longest_first};
use crate::provenance::Provenance;
use crate::results::{self, save_results};
use crate::row::Row;
use crate::sweep::{Options, complete};
use crate::table::Table;
use fakir_case::{Study, StudyFile};
use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Treatment of a folder that is not empty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Existing {
    /// Return an error.
    #[default]
    Refuse,
    /// Continue the sweep in the folder, if there is one.
    Resume,
    /// Start again, and replace existing results. A folder with files that fakir did not write is not changed: that is an error.
    Overwrite,
}

/// Result of a sweep or a merge.
#[derive(Debug, Clone)]
pub struct Summary {
    /// The study.
    pub study: Study,
    /// The rows of all cases, in the order of the study.
    pub rows: Vec<Row>,
    /// Number of rows found in the journal at the start.
    pub found: usize,
    /// Lines of journals that were skipped.
    pub damaged: Vec<DamagedLine>,
}

impl Summary {
    /// Rows without a reliable result.
    pub fn failed(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| row.problem.is_some())
    }
}

/// Computes every case of a study, or of a shard of it, in a folder, and writes the tables there.
///
/// Every case is added to the journal as soon as it has ended; after an interruption the sweep continues from there with
/// [`Existing::Resume`].
///
/// # Errors
/// [`StudyError`]: a folder that is not empty, a journal that does not belong to the study, files that cannot be written, and interruption.
pub fn sweep_into(
    study: &Study,
    folder: &Path,
    existing: Existing,
    options: &mut Options<'_>,
) -> Result<Summary, StudyError> {
    let mut ledger = Ledger::open(study, folder, existing, options)?;
    ledger.complete(options)?;
    ledger.finish()
}

/// Collects the results of a sweep in any order, wherever they are computed, in a folder or in memory.
///
/// Rows that are [appended](Self::append) are in the journal when that function returns.
///
/// ```
/// # use fakir_case::{Case, StudyFile};
/// # let text = format!("[axes]\nsurface_fraction = [1e-3, 3e-3]\n{}", Case::example().to_toml());
/// # let study = StudyFile::parse("study.toml", &text)?.study()?;
/// let mut ledger = fakir_study::Ledger::in_memory(&study);
/// for cases in ledger.remaining() {
///     // Here, or in another process:
///     let rows = fakir_study::solve(&study, &cases, None, &fakir::state::CancelToken::default())?;
///     let lines: Vec<String> = rows.iter().map(fakir_study::Row::to_json).collect();
///     ledger.append(&lines)?;
/// }
/// assert_eq!(ledger.finish()?.rows.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Ledger {
    study: Study,
    shard: Shard,
    folder: Option<(PathBuf, Journal)>,
    rows: BTreeMap<usize, Row>,
    found: usize,
    damaged: Vec<DamagedLine>,
}

impl Ledger {
    /// Starts a sweep that is kept in memory only.
    #[must_use]
    pub fn in_memory(study: &Study) -> Self {
        Self {
            study: study.clone(),
            shard: Shard::WHOLE,
            folder: None,
            rows: BTreeMap::new(),
            found: 0,
            damaged: Vec::new(),
        }
    }

    /// Starts or resumes a sweep in a folder, which is locked until it is dropped.
    ///
    /// # Errors
    /// [`StudyError`]: a folder that is not empty, in use or not writable, and a journal that does not belong to the study.
    pub fn open(
        study: &Study,
        folder: &Path,
        existing: Existing,
        options: &Options<'_>,
    ) -> Result<Self, StudyError> {
        let found = check_contents(folder, existing)?;
        make(folder)?;
        let mut journal = Journal::open(folder)?;
        let header = Header::new(study, options);
        let rows = match existing {
            Existing::Refuse if journal.is_empty()? => None,
            Existing::Refuse => return Err(StudyError::NotEmpty(folder.to_owned())),
            Existing::Resume => go_on(&mut journal, &header, study)?,
            Existing::Overwrite => {
                results::remove(folder, &found, Some(JOURNAL))?;
                None
            }
        };
        let (rows, damaged) = match rows {
            Some(rows) => rows,
            None => {
                journal.begin(&header)?;
                (BTreeMap::new(), Vec::new())
            }
        };
        save(folder, &[File::new(STUDY, study.to_toml())])?;
        Ok(Self {
            study: study.clone(),
            shard: options.shard,
            folder: Some((folder.to_owned(), journal)),
            found: rows.len(),
            rows,
            damaged,
        })
    }

    /// The rows so far, by case index.
    #[must_use]
    pub fn rows(&self) -> &BTreeMap<usize, Row> {
        &self.rows
    }

    /// Number of rows found in the journal at the start.
    #[must_use]
    pub fn found(&self) -> usize {
        self.found
    }

    /// Lines of the journal that were skipped; a case without another line is computed again.
    #[must_use]
    pub fn damaged(&self) -> &[DamagedLine] {
        &self.damaged
    }

    /// Number of rows without a reliable result.
    #[must_use]
    pub fn failed(&self) -> usize {
        self.rows
            .values()
            .filter(|row| row.problem.is_some())
            .count()
    }

    /// The cases without a row, in groups to be computed together and in order; the groups with the longest expected time come first.
    #[must_use]
    pub fn remaining(&self) -> Vec<Vec<usize>> {
        let plan = Plan::new(&self.study, self.shard);
        longest_first(&self.study, plan.chains())
            .into_iter()
            .map(|chain| {
                chain
                    .cases
                    .filter(|case| !self.rows.contains_key(case))
                    .collect()
            })
            .filter(|cases: &Vec<usize>| !cases.is_empty())
            .collect()
    }

    /// Adds rows that were computed elsewhere, as written by [`Row::to_json`]. A case that has a row keeps it: the same case may have been
    /// computed twice.
    ///
    /// # Errors
    /// [`StudyError::Answer`] if a line is not a result of a case, in which case nothing is added; and a journal that cannot be written.
    pub fn append(&mut self, lines: &[String]) -> Result<(), StudyError> {
        let rows: Result<BTreeMap<usize, Row>, StudyError> = lines
            .iter()
            .map(|line| Row::from_json(&self.study, line).map(|row| (row.index, row)))
            .collect();
        let mut rows = rows?;
        rows.retain(|index, _| !self.rows.contains_key(index));
        if let Some((_, journal)) = &mut self.folder {
            let new: Vec<Row> = rows.values().cloned().collect();
            journal.append(&new)?;
        }
        self.rows.append(&mut rows);
        Ok(())
    }

    /// Computes the remaining cases.
    ///
    /// # Errors
    /// [`StudyError::Interrupted`], and a journal that cannot be written.
    pub fn complete(&mut self, options: &mut Options<'_>) -> Result<(), StudyError> {
        let folder = &mut self.folder;
        complete(&self.study, &mut self.rows, options, |new| match folder {
            Some((_, journal)) => journal.append(new),
            None => Ok(()),
        })
    }

    /// Writes the tables, and returns the rows.
    ///
    /// # Errors
    /// [`StudyError::Incomplete`] if a case has no row, and files that cannot be written.
    pub fn finish(self) -> Result<Summary, StudyError> {
        let missing: usize = self.remaining().iter().map(Vec::len).sum();
        if missing > 0 {
            return Err(StudyError::Incomplete {
                missing,
                cases: self.rows.len() + missing,
            });
        }
        let rows: Vec<Row> = self.rows.into_values().collect();
        if let Some((folder, _)) = &self.folder {
            save(folder, &results(&self.study, &rows)).map_err(StudyError::Tables)?;
        }
        Ok(Summary {
            study: self.study,
            rows,
            found: self.found,
            damaged: self.damaged,
        })
    }
}

/// The rows in a journal and its skipped lines; `None` if the journal is empty.
fn go_on(
    journal: &mut Journal,
    header: &Header,
    study: &Study,
) -> Result<Option<Found>, StudyError> {
    let Some(contents) = journal.read()? else {
        return Ok(None);
    };
    contents.header.check(journal.path(), header)?;
    let bytes = contents.bytes;
    let rows = contents.rows(study);
    journal.keep_only(bytes)?;
    Ok(Some(rows))
}

/// Merges the shards of a sweep: the tables and the journal are the same as for an undivided sweep.
///
/// # Errors
/// [`StudyError`]: shards that do not form one sweep or are incomplete, for instance after damage, a folder that is not empty unless it may
/// be overwritten, and files that cannot be read or written.
pub fn merge(folder: &Path, shards: &[PathBuf], existing: Existing) -> Result<Summary, StudyError> {
    check_contents(folder, existing)?;
    refuse_own_shard(folder, shards)?;
    let journals: Vec<_> = shards
        .iter()
        .map(|shard| read_shard(shard))
        .collect::<Result<_, _>>()?;
    let Some((_, first)) = journals.first() else {
        return Err(StudyError::Shards(
            "there are no shards to merge".to_owned(),
        ));
    };
    let header = Header {
        shard: Shard::WHOLE,
        ..first.header.clone()
    };
    check_shards(&journals)?;
    let study = StudyFile::parse(JOURNAL, &header.study)?.study()?;
    let (mut rows, mut damaged) = (BTreeMap::new(), Vec::new());
    for (folder, contents) in journals {
        let shard = contents.header.shard;
        let (part, left_out) = contents.rows(&study);
        check_complete(&study, &folder, shard, &part, &left_out)?;
        rows.extend(part);
        damaged.extend(left_out);
    }
    let rows: Vec<Row> = rows.into_values().collect();
    let mut files = results(&study, &rows);
    files.push(File::new(STUDY, study.to_toml()));
    files.push(File::new(JOURNAL, whole(&header, &rows)));
    let replace = match existing {
        Existing::Overwrite => Replace::Allowed,
        Existing::Refuse | Existing::Resume => Replace::Refused,
    };
    save_results(folder, &files, replace)?;
    let found = rows.len();
    Ok(Summary {
        study,
        rows,
        found,
        damaged,
    })
}

fn read_shard(folder: &Path) -> Result<(PathBuf, Contents), StudyError> {
    let path = folder.join(JOURNAL);
    let file = match fs::File::open(&path) {
        Ok(file) => file,
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return Err(StudyError::NoSweep(folder.to_owned()));
        }
        Err(error) => return Err(StudyError::file("cannot read", &path, error)),
    };
    let contents = Contents::read(&path, &file)?;
    let contents = contents.ok_or_else(|| StudyError::NoSweep(folder.to_owned()))?;
    contents.header.check_version(&path)?;
    Ok((folder.to_owned(), contents))
}

/// Checks that these are all shards of one sweep.
fn check_shards(journals: &[(PathBuf, Contents)]) -> Result<(), StudyError> {
    let (first_folder, first) = &journals[0];
    let first = &first.header;
    let of = first.shard.of();
    let mut folders: BTreeMap<usize, &Path> = BTreeMap::new();
    for (folder, contents) in journals {
        let header = &contents.header;
        let wrong = |what: String| {
            let (a, b) = (first_folder.display(), folder.display());
            Err(StudyError::Shards(format!(
                "{a} and {b} are not of one sweep: {what}"
            )))
        };
        if let Some((line, a, b)) = first_difference(&first.study, &header.study) {
            return wrong(format!(
                "line {line} of the study is\n  {a}\nin the first and\n  {b}\nin the second"
            ));
        }
        if header.shard.of() != of {
            return wrong(format!(
                "one has shard {}, the other {}",
                first.shard, header.shard
            ));
        }
        if header.memory_limit != first.memory_limit {
            return wrong(format!(
                "a case may take {} of memory in one, {} in the other",
                memory(first.memory_limit),
                memory(header.memory_limit)
            ));
        }
        if let Some(other) = folders.insert(header.shard.number(), folder) {
            return Err(StudyError::Shards(format!(
                "{} and {} are both shard {}",
                other.display(),
                folder.display(),
                header.shard
            )));
        }
    }
    let missing = (1..=of).filter(|number| !folders.contains_key(number));
    let missing: Vec<String> = missing.map(|number| format!("{number}/{of}")).collect();
    if missing.is_empty() {
        return Ok(());
    }
    Err(StudyError::Shards(format!(
        "{} of {of} shards {} missing: {}",
        missing.len(),
        if missing.len() == 1 { "is" } else { "are" },
        shortened(&missing)
    )))
}

fn check_complete(
    study: &Study,
    folder: &Path,
    shard: Shard,
    rows: &BTreeMap<usize, Row>,
    damaged: &[DamagedLine],
) -> Result<(), StudyError> {
    let cases: Vec<usize> = Plan::new(study, shard).chains().flatten().collect();
    let missing = cases.iter().filter(|case| !rows.contains_key(case));
    let missing: Vec<String> = missing.map(ToString::to_string).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let damaged: String = damaged.iter().map(|line| format!("\n{line}")).collect();
    Err(StudyError::Shards(format!(
        "shard {shard} in {} is not complete: {} of {} cases are missing ({}); go on with it first: \
         fakir sweep --shard {shard} --resume{damaged}",
        folder.display(),
        missing.len(),
        cases.len(),
        shortened(&missing)
    )))
}

/// The first elements of a list, as text.
fn shortened(items: &[String]) -> String {
    const SHOWN: usize = 8;
    let shown = items[..items.len().min(SHOWN)].join(", ");
    if items.len() > SHOWN {
        format!("{shown}, ...")
    } else {
        shown
    }
}

fn refuse_own_shard(folder: &Path, shards: &[PathBuf]) -> Result<(), StudyError> {
    let Ok(place) = folder.canonicalize() else {
        return Ok(()); // the folder will be created
    };
    let is_in_there = |shard: &PathBuf| {
        let shard = shard.canonicalize();
        shard.is_ok_and(|shard| shard.starts_with(&place))
    };
    if shards.iter().any(is_in_there) {
        return Err(StudyError::Shards(format!(
            "{} is or contains one of the shards: give another folder for the merged results",
            folder.display()
        )));
    }
    Ok(())
}

/// Checks the content of a folder, if it exists; returns what must be removed.
fn check_contents(folder: &Path, existing: Existing) -> Result<Vec<PathBuf>, StudyError> {
    let empty = is_empty(folder)?;
    match existing {
        Existing::Refuse if !empty => Err(StudyError::NotEmpty(folder.to_owned())),
        Existing::Resume if !empty && !folder.join(JOURNAL).exists() => {
            Err(StudyError::NoSweep(folder.to_owned()))
        }
        Existing::Overwrite if !empty => match results::contents(folder, &[]) {
            Err(OutputError::InUse { folder }) => Err(StudyError::InUse(folder)),
            found => Ok(found?),
        },
        _ => Ok(Vec::new()),
    }
}

fn make(folder: &Path) -> Result<(), StudyError> {
    fs::create_dir_all(folder)
        .map_err(|error| StudyError::file("cannot make the folder", folder, error))
}

fn results(study: &Study, rows: &[Row]) -> Vec<File> {
    let table = Table::new(study, rows);
    let provenance = Provenance::of_study(study);
    let mut files = vec![
        File::new(CSV, table.to_csv()),
        #[cfg(feature = "parquet")]
        File::new(PARQUET, table.to_parquet(&provenance)),
    ];
    if let Some(figure) = of_study(study, rows) {
        files.extend(saved(figure, &provenance));
    }
    let names = files.iter().map(|file| file.name.as_ref());
    let provenance = provenance.file([JOURNAL, STUDY].into_iter().chain(names));
    files.push(provenance);
    files
}
