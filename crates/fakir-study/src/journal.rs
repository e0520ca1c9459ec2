//! The journal of a sweep: a line of JSON for every case, written as it ends.
//!
//! The first line says what is swept; it must fit when the sweep goes on. A last line that was not
//! written in full, as when the process is killed, is dropped; any other damage is an error.

use crate::VERSION;
use crate::answer::{Answer, Row};
use crate::error::StudyError;
use crate::plan::{Plan, Shard};
use crate::sweep::Options;
use fakir::contact::Run;
use fakir_case::Study;
use fakir_case::study::Asked;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Its name in the folder of a sweep.
pub(crate) const JOURNAL: &str = "journal.jsonl";

/// The version of what is written here.
const FORMAT: u32 = 1;

/// What is swept.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Header {
    pub(crate) format: u32,
    pub(crate) fakir_version: String,
    pub(crate) shard: Shard,
    /// Bytes that a case may take.
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

    /// Whether a journal begun with this, there, can be gone on with as `here`.
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

    /// Whether a journal is by this version.
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

/// The first line in which two texts differ, from 1, and what it is in both.
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

/// A case in the journal.
#[derive(Serialize, Deserialize)]
struct Line {
    case: usize,
    wall_time_s: f64,
    problem: Option<String>,
    answer: Option<Answer>,
}

/// A journal, locked, that is being written.
pub(crate) struct Journal {
    file: File,
    path: PathBuf,
}

impl Journal {
    /// Opens the journal of a folder, or makes it, and keeps other sweeps out until it is dropped.
    pub(crate) fn open(folder: &Path) -> Result<Self, StudyError> {
        let path = folder.join(JOURNAL);
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false);
        let file = options
            .open(&path)
            .map_err(|error| StudyError::file("cannot write", &path, error))?;
        match fs4::FileExt::try_lock(&file) {
            Ok(()) => Ok(Self { file, path }),
            Err(fs4::TryLockError::WouldBlock) => Err(StudyError::InUse(folder.to_owned())),
            Err(fs4::TryLockError::Error(error)) => {
                Err(StudyError::file("cannot lock", &path, error))
            }
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

    /// Reads what is there; `None` if not even its first line is.
    pub(crate) fn read(&mut self) -> Result<Option<Contents>, StudyError> {
        let mut file = &self.file;
        file.rewind().map_err(|error| self.unreadable(error))?;
        Contents::read(&self.path, file)
    }

    /// Begins it anew.
    pub(crate) fn begin(&mut self, header: &Header) -> Result<(), StudyError> {
        self.keep_only(0)?;
        self.append_text(&(to_json(header) + "\n"))
    }

    /// Drops what is beyond so many bytes, and goes on from there.
    pub(crate) fn keep_only(&mut self, bytes: u64) -> Result<(), StudyError> {
        self.file
            .set_len(bytes)
            .and_then(|()| self.file.seek(SeekFrom::Start(bytes)).map(drop))
            .map_err(|error| self.unwritable(error))
    }

    /// Adds rows; they are on the disk when it returns.
    pub(crate) fn append(&mut self, rows: &[Row]) -> Result<(), StudyError> {
        self.append_text(&lines(rows))
    }

    fn append_text(&mut self, text: &str) -> Result<(), StudyError> {
        self.file
            .write_all(text.as_bytes())
            .and_then(|()| self.file.sync_data())
            .map_err(|error| self.unwritable(error))
    }

    fn unreadable(&self, error: std::io::Error) -> StudyError {
        StudyError::file("cannot read", &self.path, error)
    }

    fn unwritable(&self, error: std::io::Error) -> StudyError {
        StudyError::Journal {
            path: self.path.clone(),
            error,
        }
    }
}

/// A whole journal as a text.
pub(crate) fn whole(header: &Header, rows: &[Row]) -> String {
    to_json(header) + "\n" + &lines(rows)
}

fn lines(rows: &[Row]) -> String {
    rows.iter().map(|row| row.to_json() + "\n").collect()
}

impl Row {
    /// As a line of a journal, without its end: the answer to the bit. The values of the axes
    /// are not in it, they follow from the number of the case.
    #[must_use]
    pub fn to_json(&self) -> String {
        to_json(&Line {
            case: self.index,
            wall_time_s: self.wall_time,
            problem: self.problem.clone(),
            answer: self.answer.clone(),
        })
    }

    /// Reads what [`to_json`](Self::to_json) wrote of a case of this study.
    ///
    /// # Errors
    /// [`StudyError::Answer`] for what is no such line.
    pub fn from_json(study: &Study, text: &str) -> Result<Self, StudyError> {
        let line: Line = serde_json::from_str(text)
            .map_err(|error| StudyError::Answer(without_place(&error)))?;
        Plan::new(study, Shard::WHOLE)
            .row(study, line)
            .map_err(StudyError::Answer)
    }
}

fn to_json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("structs with named fields are JSON objects")
}

/// What is wrong with JSON; the line it counts is the only one it has seen.
fn without_place(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let (problem, _) = text.split_once(" at line ").unwrap_or((&text, ""));
    format!("{problem}, column {}", error.column())
}

/// What a journal holds.
pub(crate) struct Contents {
    path: PathBuf,
    pub(crate) header: Header,
    /// With their numbers in the file, from 1.
    lines: Vec<(usize, Line)>,
    /// Up to the end of the last line that is there in full.
    pub(crate) bytes: u64,
}

impl Contents {
    pub(crate) fn read(path: &Path, file: &File) -> Result<Option<Self>, StudyError> {
        let damaged = |line, problem: String| StudyError::Damaged {
            journal: path.to_owned(),
            line,
            problem,
        };
        let mut reader = BufReader::new(file);
        let mut contents: Option<Self> = None;
        let mut bytes = 0;
        for number in 1.. {
            let mut text = Vec::new();
            let length = reader
                .read_until(b'\n', &mut text)
                .map_err(|error| StudyError::file("cannot read", path, error))?;
            if text.pop() != Some(b'\n') {
                break; // the end, or a line torn off
            }
            bytes += length as u64;
            match &mut contents {
                None => {
                    let header: Header = serde_json::from_slice(&text)
                        .map_err(|error| damaged(number, without_place(&error)))?;
                    if header.format != FORMAT {
                        let problem = format!("its format {} is not known", header.format);
                        return Err(damaged(number, problem));
                    }
                    contents = Some(Self {
                        path: path.to_owned(),
                        header,
                        lines: Vec::new(),
                        bytes,
                    });
                }
                Some(contents) => {
                    let line: Line = serde_json::from_slice(&text)
                        .map_err(|error| damaged(number, without_place(&error)))?;
                    contents.lines.push((number, line));
                    contents.bytes = bytes;
                }
            }
        }
        Ok(contents)
    }

    /// Its rows, which must be those of the study.
    pub(crate) fn rows(self, study: &Study) -> Result<BTreeMap<usize, Row>, StudyError> {
        let plan = Plan::new(study, self.header.shard);
        let mut rows = BTreeMap::new();
        for (number, line) in self.lines {
            let damaged = |problem: String| StudyError::Damaged {
                journal: self.path.clone(),
                line: number,
                problem,
            };
            let index = line.case;
            let row = plan.row(study, line).map_err(&damaged)?;
            if rows.insert(index, row).is_some() {
                return Err(damaged(format!("case {index} is there twice")));
            }
        }
        Ok(rows)
    }
}

impl Plan {
    /// The row of a line; or what is wrong with it.
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

/// Whether a line has an answer to what the study asks, or a reason why not.
fn is_complete(study: &Study, line: &Line) -> bool {
    match (&line.answer, study.asked()) {
        (None, _) => line.problem.is_some(),
        (Some(Answer::Transition(_)), asked) => asked == Asked::Transition,
        (Some(Answer::Press(_)), asked) => asked == Asked::Press,
    }
}
