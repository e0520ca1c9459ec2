//! Tables of numbers under a line with the names of their columns.

use crate::input;
use std::path::Path;

/// Largest table, bytes, enough for some million rows.
const LARGEST: u64 = 256_000_000;

/// Reason why a table was not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum TableError {
    /// The file cannot be read.
    #[error("cannot read {path}: {error}")]
    Unreadable {
        /// Its name.
        path: String,
        /// Description of the error.
        error: std::io::Error,
    },
    /// A line that is not a row of the table.
    #[error("{path}, line {line}: {problem}")]
    Line {
        /// The file.
        path: String,
        /// Line, from 1.
        line: u64,
        /// Description of the error, and what is accepted.
        problem: String,
    },
}

/// Columns of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Columns<const N: usize> {
    pub(crate) names: [&'static str; N],
    /// Number of required columns, from the first.
    pub(crate) required: usize,
    /// Description in messages: `"a table of pillars has ..."`.
    pub(crate) told: &'static str,
}

/// A table that has been read.
#[derive(Debug)]
pub(crate) struct Table<const N: usize> {
    name: String,
    heading_line: u64,
    /// Columns present.
    pub(crate) has: [bool; N],
    pub(crate) rows: Vec<[f64; N]>,
    lines: Vec<u64>,
}

impl<const N: usize> Table<N> {
    /// Error for a row, from 0, or for the whole table.
    pub(crate) fn wrong(&self, row: Option<usize>, problem: String) -> TableError {
        TableError::Line {
            path: self.name.clone(),
            line: self.line(row),
            problem,
        }
    }

    /// Line of a row, from 1; without a row, the line of the column names.
    pub(crate) fn line(&self, row: Option<usize>) -> u64 {
        let line = row.and_then(|row| self.lines.get(row));
        line.copied().unwrap_or(self.heading_line)
    }
}

impl<const N: usize> Columns<N> {
    /// Reads a file: values separated by commas under a line with the names of the columns, in any order. Lines that begin with `#` are left out.
    /// A missing column has the value of `otherwise`.
    pub(crate) fn read(&self, path: &Path, otherwise: [f64; N]) -> Result<Table<N>, TableError> {
        let name = path.display().to_string();
        let bytes = input::read(path, LARGEST).map_err(|error| TableError::Unreadable {
            path: name.clone(),
            error,
        })?;
        self.parse(&name, &bytes, otherwise)
    }

    /// [`read`](Self::read) from the contents of a file; `name` is its name in errors.
    pub(crate) fn parse(
        &self,
        name: &str,
        bytes: &[u8],
        otherwise: [f64; N],
    ) -> Result<Table<N>, TableError> {
        let Self {
            names,
            required,
            told,
        } = self;
        let wrong = |line: u64, problem: String| TableError::Line {
            path: name.to_owned(),
            line,
            problem,
        };
        let mut table = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_reader(bytes);
        let csv_line = |error: &csv::Error| error.position().map_or(1, csv::Position::line);
        let headings = table
            .headers()
            .map_err(|e| wrong(csv_line(&e), e.to_string()))?;
        let heading_line = headings.position().map_or(1, csv::Position::line);
        let mut places = [None; N];
        for (place, heading) in headings.iter().enumerate() {
            let known = names.iter().position(|column| *column == heading);
            let Some(column) = known else {
                let problem = format!("there is no column \"{heading}\": {told}");
                return Err(wrong(heading_line, problem));
            };
            if places[column].replace(place).is_some() {
                return Err(wrong(
                    heading_line,
                    format!("two columns are \"{heading}\""),
                ));
            }
        }
        for (column, place) in names.iter().zip(&places).take(*required) {
            if place.is_none() {
                let problem = format!("the column {column} is missing: {told}");
                return Err(wrong(heading_line, problem));
            }
        }
        let (mut rows, mut lines) = (Vec::new(), Vec::new());
        for row in table.records() {
            let row = row.map_err(|error| wrong(csv_line(&error), error.to_string()))?;
            let line = row
                .position()
                .map_or(0, |position| line_of_row(bytes, position));
            let mut values = otherwise;
            for ((value, column), place) in values.iter_mut().zip(names).zip(&places) {
                let Some(text) = place.and_then(|place| row.get(place)) else {
                    continue;
                };
                *value = text.parse().map_err(|_| {
                    wrong(
                        line,
                        format!("{column} is \"{text}\", and has to be a number of metres"),
                    )
                })?;
            }
            rows.push(values);
            lines.push(line);
        }
        Ok(Table {
            name: name.to_owned(),
            heading_line,
            has: places.map(|place| place.is_some()),
            rows,
            lines,
        })
    }
}

/// The line of a row, from 1: after the comments and empty lines that are skipped before it.
fn line_of_row(bytes: &[u8], start: &csv::Position) -> u64 {
    let rest = bytes.get(start.byte() as usize..).unwrap_or_default();
    let skipped = rest.split(|byte| *byte == b'\n').take_while(|line| {
        let text = line.trim_ascii();
        text.is_empty() || text.starts_with(b"#")
    });
    start.line() + skipped.count() as u64
}
