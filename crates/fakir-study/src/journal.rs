//! The journal of a sweep: a line of JSON for every case, written as it ends.
//!
//! The first line describes the sweep; it must match when the sweep continues. Every line ends with a checksum (CRC-32) of everything
//! before it in the line, so that a change of a few characters is detected. An incomplete last line, for instance after the process was
//! killed, is dropped. Any other damaged line is skipped and reported, and its case is computed again; a damaged first line is an error.

use crate::VERSION;
use crate::error::StudyError;
use crate::names::JOURNAL;
use crate::plan::{Plan, Shard};
use crate::record::Kind;
use crate::row::{Row, RowAnswer};
use crate::sweep::Options;
use fakir::state::Run;
use fakir_case::Study;
use fakir_case::study::Asked;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Version of the format written here.
const FORMAT: u32 = 3;

/// Version of the format without checksums.
const WITHOUT_CHECKSUMS: u32 = 1;

/// Largest number of bytes of a line. The first line contains a study, which is smaller.
const LONGEST_LINE: u64 = 64_000_000;

/// Description of a sweep.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Header {
    pub(crate) format: u32,
    pub(crate) fakir_version: String,
    pub(crate) shard: Shard,
    /// Memory limit of a case, bytes.
    pub(crate) memory_limit: usize,
    /// The study in its canonical form.
    pub(crate) study: String,
}

impl Header {
    pub(crate) fn new(study: &Study, options: &Options<'_>) -> Self {
        let run = Run {
            memory_limit: options.memory_limit,
            ..Run::default()
        };
        Self {
            format: FORMAT,
            fakir_version: VERSION.to_owned(),
            shard: options.shard,
            memory_limit: run.memory_limit(),
            study: study.to_toml().to_owned(),
        }
    }

    /// Reads the first line of a journal.
    fn read(journal: &Path, line: &[u8]) -> Result<Self, StudyError> {
        let is_old = |header: &Self| header.format == WITHOUT_CHECKSUMS;
        let header: Self = match read_sealed(line) {
            Ok(header) => header,
            Err(_) if serde_json::from_slice(line).is_ok_and(|header| is_old(&header)) => {
                return Err(StudyError::NoChecksums(journal.to_owned()));
            }
            Err(problem) => return Err(Self::damaged(journal, problem)),
        };
        if header.format != FORMAT {
            let problem = format!("its format {} is not known", header.format);
            return Err(Self::damaged(journal, problem));
        }
        Ok(header)
    }

    fn damaged(journal: &Path, problem: String) -> StudyError {
        StudyError::Damaged {
            journal: journal.to_owned(),
            line: 1,
            problem,
        }
    }

    /// Checks whether a journal that starts with this header can be continued as `here`.
    pub(crate) fn check(&self, journal: &Path, here: &Self) -> Result<(), StudyError> {
        let journal = || journal.to_owned();
        self.check_version(&journal())?;
        if let Some((line, there, here)) = first_difference(&self.study, &here.study) {
            return Err(StudyError::OtherStudy {
                journal: journal(),
                line,
                there,
                here,
            });
        }
        if self.shard != here.shard {
            return Err(StudyError::OtherShard {
                journal: journal(),
                there: self.shard,
                here: here.shard,
            });
        }
        if self.memory_limit != here.memory_limit {
            return Err(StudyError::OtherMemory {
                journal: journal(),
                there: self.memory_limit,
                here: here.memory_limit,
            });
        }
        Ok(())
    }

    /// Checks whether a journal was written by this version.
    pub(crate) fn check_version(&self, journal: &Path) -> Result<(), StudyError> {
        if self.fakir_version == VERSION {
            return Ok(());
        }
        Err(StudyError::OtherVersion {
            journal: journal.to_owned(),
            there: self.fakir_version.clone(),
            here: VERSION,
        })
    }
}

/// The first line in which two texts differ, from 1, and its content in both.
pub(crate) fn first_difference(a: &str, b: &str) -> Option<(usize, String, String)> {
    let (mut a, mut b) = (a.lines(), b.lines());
    let mut number = 0;
    loop {
        number += 1;
        match (a.next(), b.next()) {
            (None, None) => return None,
            (a, b) if a == b => {}
            (a, b) => {
                let shown = |line: Option<&str>| match line {
                    Some("") => "(an empty line)".to_owned(),
                    Some(line) => line.to_owned(),
                    None => "(nothing: it ends before)".to_owned(),
                };
                return Some((number, shown(a), shown(b)));
            }
        }
    }
}

/// The line of a case.
#[derive(Serialize, Deserialize)]
struct Line {
    case: usize,
    wall_time_s: f64,
    problem: Option<String>,
    answer: Option<RowAnswer>,
}

/// Whether a file is a journal, or the beginning of one, judged by its first bytes.
pub(crate) fn is_journal(path: &Path) -> bool {
    const START: &[u8] = b"{\"format\":";
    let start = File::open(path).and_then(|file| {
        let mut start = Vec::new();
        file.take(START.len() as u64).read_to_end(&mut start)?;
        Ok(start)
    });
    start.is_ok_and(|start| START.starts_with(&start))
}

/// Whether a sweep is writing a journal.
pub(crate) fn is_running(path: &Path) -> bool {
    let is_locked = |file: File| matches!(try_lock(&file), Ok(false));
    File::options().write(true).open(path).is_ok_and(is_locked)
}

/// Locks a file; false if another program has locked it.
#[cfg(any(unix, windows))]
fn try_lock(file: &File) -> io::Result<bool> {
    match fs4::FileExt::try_lock(file) {
        Ok(()) => Ok(true),
        Err(fs4::TryLockError::WouldBlock) => Ok(false),
        Err(fs4::TryLockError::Error(error)) => Err(error),
    }
}

/// Without files there are no other programs that write to them.
#[cfg(not(any(unix, windows)))]
fn try_lock(_file: &File) -> io::Result<bool> {
    Ok(true)
}

/// A locked journal, open for writing.
pub(crate) struct Journal {
    file: File,
    path: PathBuf,
}

impl Journal {
    /// Opens or creates the journal of a folder, and locks it until it is dropped.
    pub(crate) fn open(folder: &Path) -> Result<Self, StudyError> {
        let path = folder.join(JOURNAL);
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false);
        let file = options
            .open(&path)
            .map_err(|error| StudyError::file("cannot write", &path, error))?;
        match try_lock(&file) {
            Ok(true) => Ok(Self { file, path }),
            Ok(false) => Err(StudyError::InUse(folder.to_owned())),
            Err(error) => Err(StudyError::file("cannot lock", &path, error)),
        }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn is_empty(&self) -> Result<bool, StudyError> {
        let metadata = self.file.metadata();
        let metadata = metadata.map_err(|error| self.unreadable(error))?;
        Ok(metadata.len() == 0)
    }

    /// Reads the content; `None` if not even the first line is complete.
    pub(crate) fn read(&mut self) -> Result<Option<Contents>, StudyError> {
        let mut file = &self.file;
        file.rewind().map_err(|error| self.unreadable(error))?;
        Contents::read(&self.path, file)
    }

    /// Starts an empty journal.
    pub(crate) fn begin(&mut self, header: &Header) -> Result<(), StudyError> {
        self.keep_only(0)?;
        self.append_text(&(sealed(header) + "\n"))
    }

    /// Truncates the file to a number of bytes; new lines are appended there.
    pub(crate) fn keep_only(&mut self, bytes: u64) -> Result<(), StudyError> {
        self.file
            .set_len(bytes)
            .and_then(|()| self.file.seek(SeekFrom::Start(bytes)).map(drop))
            .map_err(|error| self.unwritable(error))
    }

    /// Adds rows; they are on the disk when the function returns.
    pub(crate) fn append(&mut self, rows: &[Row]) -> Result<(), StudyError> {
        self.append_text(&lines(rows))
    }

    fn append_text(&mut self, text: &str) -> Result<(), StudyError> {
        self.file
            .write_all(text.as_bytes())
            .and_then(|()| self.file.sync_data())
            .map_err(|error| self.unwritable(error))
    }

    fn unreadable(&self, error: io::Error) -> StudyError {
        StudyError::file("cannot read", &self.path, error)
    }

    fn unwritable(&self, error: io::Error) -> StudyError {
        StudyError::Journal {
            path: self.path.clone(),
            error,
        }
    }
}

/// The text of a whole journal.
pub(crate) fn whole(header: &Header, rows: &[Row]) -> String {
    sealed(header) + "\n" + &lines(rows)
}

fn lines(rows: &[Row]) -> String {
    rows.iter().map(|row| row.to_json() + "\n").collect()
}

impl Row {
    /// A line of a journal, without its end: the result, bit for bit, and a checksum. The values of the axes are not included; they follow
    /// from the case index.
    #[must_use]
    pub fn to_json(&self) -> String {
        sealed(&Line {
            case: self.index,
            wall_time_s: self.wall_time,
            problem: self.problem.clone(),
            answer: self.answer.clone(),
        })
    }

    /// Reads a case of this study as written by [`to_json`](Self::to_json).
    ///
    /// # Errors
    /// [`StudyError::Answer`] if the line is invalid.
    pub fn from_json(study: &Study, text: &str) -> Result<Self, StudyError> {
        read_sealed(text.as_bytes())
            .and_then(|line| Plan::new(study, Shard::WHOLE).row(study, line))
            .map_err(StudyError::Answer)
    }
}

/// A JSON object that ends with a checksum of everything before it.
fn sealed(value: &impl Serialize) -> String {
    let mut json = serde_json::to_string(value).expect("structs with named fields are JSON");
    let brace = json.pop();
    debug_assert_eq!(brace, Some('}'));
    let seal = seal(json.as_bytes());
    json + &seal
}

/// The end of a line that starts with `text`.
fn seal(text: &[u8]) -> String {
    format!(",\"checksum\":\"{:08x}\"}}", crc32fast::hash(text))
}

/// Reads a line written by [`sealed`]; otherwise describes the problem.
fn read_sealed<T: DeserializeOwned>(line: &[u8]) -> Result<T, String> {
    let end = line.len().saturating_sub(seal(b"").len());
    let (text, end) = line.split_at(end);
    if end != seal(text).as_bytes() {
        return Err("its checksum does not match its content".to_owned());
    }
    serde_json::from_slice(line).map_err(|error| without_place(&error))
}

/// Describes an error in JSON without the line number, which refers to a single line.
fn without_place(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let (problem, _) = text.split_once(" at line ").unwrap_or((&text, ""));
    format!("{problem}, column {}", error.column())
}

/// A skipped line of a journal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DamagedLine {
    /// The journal.
    pub journal: PathBuf,
    /// The line, from 1.
    pub line: usize,
    /// What is wrong with it.
    pub problem: String,
}

impl fmt::Display for DamagedLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            journal,
            line,
            problem,
        } = self;
        let journal = journal.display();
        write!(
            f,
            "{journal}:{line}: this line is damaged and left out: {problem}"
        )
    }
}

/// The rows in a journal, and the skipped lines.
pub(crate) type Found = (BTreeMap<usize, Row>, Vec<DamagedLine>);

/// Content of a journal.
pub(crate) struct Contents {
    path: PathBuf,
    pub(crate) header: Header,
    /// Lines or descriptions of their problems, with their line numbers in the file, from 1.
    lines: Vec<(usize, Result<Line, String>)>,
    /// Length up to the end of the last complete line.
    pub(crate) bytes: u64,
}

impl Contents {
    pub(crate) fn read(path: &Path, source: impl Read) -> Result<Option<Self>, StudyError> {
        let mut reader = BufReader::new(source);
        let mut contents: Option<Self> = None;
        let mut bytes = 0;
        for number in 1.. {
            let mut text = Vec::new();
            let length = (&mut reader)
                .take(LONGEST_LINE)
                .read_until(b'\n', &mut text)
                .map_err(|error| StudyError::file("cannot read", path, error))?;
            if length as u64 == LONGEST_LINE {
                return Err(StudyError::Damaged {
                    journal: path.to_owned(),
                    line: number,
                    problem: "it is longer than any line of a journal".to_owned(),
                });
            }
            if text.pop() != Some(b'\n') {
                break; // the end, or an incomplete line
            }
            bytes += length as u64;
            match &mut contents {
                None => {
                    contents = Some(Self {
                        path: path.to_owned(),
                        header: Header::read(path, &text)?,
                        lines: Vec::new(),
                        bytes,
                    });
                }
                Some(contents) => {
                    contents.lines.push((number, read_sealed(&text)));
                    contents.bytes = bytes;
                }
            }
        }
        Ok(contents)
    }

    /// The rows of the study, and the lines that contain none.
    pub(crate) fn rows(self, study: &Study) -> Found {
        let plan = Plan::new(study, self.header.shard);
        let (mut rows, mut damaged) = (BTreeMap::new(), Vec::new());
        for (number, line) in self.lines {
            let row = line.and_then(|line| plan.row(study, line));
            let kept = row.and_then(|row| match rows.entry(row.index) {
                Entry::Occupied(_) => Err(format!("case {} is there twice", row.index)),
                Entry::Vacant(place) => {
                    place.insert(row);
                    Ok(())
                }
            });
            if let Err(problem) = kept {
                damaged.push(DamagedLine {
                    journal: self.path.clone(),
                    line: number,
                    problem,
                });
            }
        }
        (rows, damaged)
    }
}

impl Plan {
    /// The row of a line, or a description of its problem.
    fn row(&self, study: &Study, line: Line) -> Result<Row, String> {
        let index = line.case;
        if !self.has(index) {
            return Err(format!("there is no case {index} in this sweep"));
        }
        if !is_complete(study, &line) {
            return Err(format!("case {index} has no answer that fits"));
        }
        Ok(Row {
            index,
            coordinates: study.coordinates(index),
            answer: line.answer,
            problem: line.problem,
            wall_time: line.wall_time_s,
        })
    }
}

/// Whether a line contains the requested result, or the reason for its absence.
fn is_complete(study: &Study, line: &Line) -> bool {
    match &line.answer {
        None => line.problem.is_some(),
        Some(RowAnswer::Numbers(record)) => Some(record.kind()) == Kind::of(study),
        Some(RowAnswer::Collapse(_)) => study.asked() == Asked::Collapse,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::sweep;
    use fakir_case::{Case, StudyFile};

    /// A study of three cases, and its journal.
    fn journal() -> (Study, Vec<Row>, String) {
        let text = format!(
            "[axes]\noffset = [0, 0.3, 0.5]\n{}",
            Case::example().to_toml()
        );
        let mut file = StudyFile::parse("study.toml", &text).unwrap();
        file.set("method.name=homogenised").unwrap();
        file.set("pattern.surface_fraction=1e-3").unwrap();
        let study = file.study().unwrap();
        let mut options = Options::default();
        let rows = sweep(&study, &mut options).unwrap();
        let text = whole(&Header::new(&study, &options), &rows);
        (study, rows, text)
    }

    /// Reads a journal from bytes.
    fn read(study: &Study, bytes: &[u8]) -> Result<(Vec<Row>, Vec<usize>), StudyError> {
        let contents = Contents::read(JOURNAL.as_ref(), bytes)?;
        let Some(contents) = contents else {
            return Ok((Vec::new(), Vec::new()));
        };
        let (rows, damaged) = contents.rows(study);
        let lines = damaged.iter().map(|damaged| damaged.line).collect();
        Ok((rows.into_values().collect(), lines))
    }

    /// Every character of a journal is changed, removed and doubled: the line is reported, and no row changes.
    #[test]
    fn no_change_of_a_character_passes_for_an_answer() {
        let (study, rows, text) = journal();
        assert_eq!(
            read(&study, text.as_bytes()).unwrap(),
            (rows.clone(), vec![])
        );
        let mut edits = 0;
        for position in 0..text.len() {
            let line = 1 + text[..position].matches('\n').count();
            let original = text.as_bytes()[position];
            let mut replacements = vec![vec![], vec![original; 2]];
            // A bit, the case of a letter, and other possible characters.
            let others = [
                original ^ 1,
                original ^ 0x20,
                b'0',
                b'9',
                b'-',
                b'.',
                b'e',
                b' ',
            ];
            let others = others.into_iter().filter(|other| *other != original);
            replacements.extend(others.map(|other| vec![other]));
            for replacement in replacements {
                let (before, after) = text.as_bytes().split_at(position);
                let edited = [before, &replacement, &after[1..]].concat();
                let context = || {
                    let line = text.lines().nth(line - 1).unwrap_or_default();
                    format!(
                        "{position} {:?} in {line}",
                        String::from_utf8_lossy(&replacement)
                    )
                };
                match read(&study, &edited) {
                    Err(StudyError::Damaged { line: 1, .. }) => {
                        assert_eq!(line, 1, "{}", context());
                    }
                    Err(other) => panic!("{}: {other}", context()),
                    Ok((kept, damaged)) => {
                        assert!(kept.iter().all(|row| rows.contains(row)), "{}", context());
                        let is_doubled_end = original == b'\n' && replacement == b"\n\n";
                        if position + 1 == text.len() && !is_doubled_end {
                            // Without its end the last line is incomplete: its case is open.
                            assert_eq!((kept.len(), damaged), (rows.len() - 1, vec![]));
                        } else {
                            let lost = !is_doubled_end;
                            assert!(kept.len() < rows.len() || !lost, "{}", context());
                            let named = if is_doubled_end { line + 1 } else { line };
                            assert!(damaged.contains(&named), "{}: {damaged:?}", context());
                        }
                    }
                }
                edits += 1;
            }
        }
        assert!(edits > 20_000, "{edits}");
    }

    #[test]
    fn a_journal_of_before_there_were_checksums_is_refused() {
        let (study, _, text) = journal();
        let seal = seal(b"").len();
        let old: String = text
            .replace("\"format\":3", "\"format\":1")
            .lines()
            .map(|line| format!("{}}}\n", &line[..line.len() - seal]))
            .collect();
        let error = read(&study, old.as_bytes()).unwrap_err();
        assert!(matches!(error, StudyError::NoChecksums(_)), "{error}");
        assert!(error.to_string().contains("--overwrite"));
    }

    /// The checksum agrees with other programs: `crc32` of "123456789", the check value of CRC-32 in the catalogue of parametrised CRC
    /// algorithms (G. Cook).
    #[test]
    fn the_checksum_is_a_usual_one() {
        assert_eq!(seal(b"123456789"), ",\"checksum\":\"cbf43926\"}");
    }
}
