//! Heights as they are in a file, and errors of reading them.

use crate::notation::Ambiguous;
use fakir::problem::{InvalidGrid, InvalidHeightMap};
use std::io;

/// Memory for every point of a map, bytes: its height and pillar on cells of three sizes,
/// separation, start, and the fields of the solution.
pub(crate) const BYTES_PER_POINT: f64 = 64.0;

/// Longest line of a text, bytes, enough for millions of numbers.
pub(crate) const LONGEST_LINE: u64 = 64_000_000;

/// Reason why a height map cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HeightMapError {
    /// The file cannot be opened or read.
    #[error("cannot read {file}: {source}")]
    Read {
        /// The file.
        file: String,
        /// Reason given by the operating system.
        source: io::Error,
    },
    /// It is not a NumPy file, or it is damaged.
    #[error("{file} is not a readable NumPy file: {problem}")]
    NotNumpy {
        /// The file, and the array of an archive.
        file: String,
        /// Description of the error.
        problem: String,
    },
    /// An archive has no array of that name.
    #[error("{file} has no array {wanted:?}; it has {}", list(.available))]
    NoSuchArray {
        /// The file.
        file: String,
        /// Requested name.
        wanted: String,
        /// The names there are.
        available: Vec<String>,
    },
    /// An archive has several arrays, or none, and no name was given.
    #[error("{file} has {}: name the one to read", list(.available))]
    ArrayNotNamed {
        /// The file.
        file: String,
        /// The names there are.
        available: Vec<String>,
    },
    /// An array is not two-dimensional.
    #[error(
        "{file} has an array of shape {shape:?}: a height map has two dimensions, rows and columns"
    )]
    Dimensions {
        /// The file, and the array of an archive.
        file: String,
        /// Its shape.
        shape: Vec<u64>,
    },
    /// An array has elements that are not numbers.
    #[error(
        "{file} has elements of type {found}: heights are real numbers of 4 or 8 bytes, or integers"
    )]
    ElementType {
        /// The file, and the array of an archive.
        file: String,
        /// The type, as NumPy writes it.
        found: String,
    },
    /// A word of a text is not a number.
    #[error("{file}, line {line}, column {column}: {text:?} is not a number")]
    NotANumber {
        /// The file.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// Index of the number in the line, counted from 1.
        column: usize,
        /// The word that is not a number.
        text: String,
    },
    /// Commas that may be separators or decimal commas.
    #[error(
        "{file}, line {line}: the commas may separate numbers, be decimal commas or separate thousands: write \".\" as the decimal point, or separate \
         the numbers by tabs or semicolons alone, and leave out separators of thousands"
    )]
    AmbiguousComma {
        /// The file.
        file: String,
        /// Line, counted from 1.
        line: usize,
    },
    /// A mark that may be a decimal one or separate thousands.
    #[error(
        "{file}, line {}: {number}: write the numbers without separators of thousands", .number.line
    )]
    Thousands {
        /// The file.
        file: String,
        /// The number, and its line, counted from 1.
        number: Ambiguous,
    },
    /// A first row of numbers of columns.
    #[error(
        "{file}: the first row is 0, 1, 2 and so on, which are numbers of columns rather than heights: remove it (pandas leaves it out with header=False)"
    )]
    NumberedColumns {
        /// The file.
        file: String,
    },
    /// Numbers that are no matrix of heights alone: with coordinates, numbers of rows or columns, or of a line.
    #[error("{file}: {problem}")]
    NoMap {
        /// The file.
        file: String,
        /// What they are, and what to do about it.
        problem: String,
    },
    /// A file of another kind.
    #[error("{file} is {format}: {advice}")]
    OtherFormat {
        /// The file.
        file: String,
        /// What it is.
        format: &'static str,
        /// What converts it.
        advice: &'static str,
    },
    /// Points that are not a grid.
    #[error(
        "{file} has {rows} rows of 3 numbers: a list of points x, y, z must have every point of an evenly spaced grid, each once; \
         a map of 3 columns is read from a .npy file"
    )]
    NotAGrid {
        /// The file.
        file: String,
        /// Its rows.
        rows: usize,
    },
    /// The file contradicts a given value.
    #[error("{file} states {what} of {stated}, and {given} is given")]
    Contradiction {
        /// The file.
        file: String,
        /// What it states.
        what: &'static str,
        /// As it states it.
        stated: String,
        /// As it is given.
        given: String,
    },
    /// The size is neither given nor stated by the file.
    #[error("{file} does not state its size: give that of a cell, or the width")]
    NoSize {
        /// The file.
        file: String,
    },
    /// Values of another dimension than a length.
    #[error(
        "{file} has values in {unit:?}, which is not a unit of length: give the height of a value of 1"
    )]
    NotHeights {
        /// The file.
        file: String,
        /// Their unit.
        unit: String,
    },
    /// Rows of a text differ in length.
    #[error(
        "{file}, line {line}: {found} number{}, but {expected} in the rows before",
        if *.found == 1 { "" } else { "s" }
    )]
    RaggedRow {
        /// The file.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// Numbers in this row.
        found: usize,
        /// Numbers in the others.
        expected: usize,
    },
    /// Several maps in one text.
    #[error(
        "{file}, line {line}: another map begins below the rows of the first one, and a file is read as one map: save one map alone; \
         if the rows are of one map, remove the lines without numbers between them"
    )]
    SeveralMaps {
        /// The file.
        file: String,
        /// Line at which the second one begins, counted from 1.
        line: usize,
    },
    /// The number of columns or rows differs from that of the header.
    #[error(
        "{file}: {found_columns} columns and {found_rows} rows, but its header states {columns} and {rows}"
    )]
    HeaderSize {
        /// The file.
        file: String,
        /// Columns of its header.
        columns: usize,
        /// Rows of its header.
        rows: usize,
        /// Columns that it has.
        found_columns: usize,
        /// Rows that it has.
        found_rows: usize,
    },
    /// An ESRI ASCII grid has a point without data.
    #[error(
        "{file}, line {line}, column {column}: there is no data; {count} points are missing in all"
    )]
    NoData {
        /// The file.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// Index of the number in the line, counted from 1.
        column: usize,
        /// Number of missing points.
        count: usize,
    },
    /// Heights are missing.
    #[error(
        "{file}: {count} of {total} heights are missing, the first in column {column}, row {row} (counted from 0)"
    )]
    Missing {
        /// The file.
        file: String,
        /// Number of missing points.
        count: usize,
        /// Number of points.
        total: usize,
        /// Column of the first one, from 0.
        column: usize,
        /// Its row, from 0.
        row: usize,
    },
    /// An image whose pixels are not read.
    #[error("{file} is an image that is not read: {problem}")]
    Image {
        /// The file.
        file: String,
        /// Description of the error, and what is accepted.
        problem: String,
    },
    /// A file of the formats of ISO 25178 that is not read.
    #[error("{file} is not readable as SDF or X3P (ISO 25178): {problem}")]
    Profiles {
        /// The file.
        file: String,
        /// Description of the error.
        problem: String,
    },
    /// The heights of the grey values of an image are not given.
    #[error(
        "{file} is an image, which does not state its heights: give the height of white above black"
    )]
    NoHeightRange {
        /// The file.
        file: String,
    },
    /// A height range of a file that is no image of grey values.
    #[error(
        "{file} has heights, not grey values, and {given} is given as the height of white above black"
    )]
    HeightRange {
        /// The file.
        file: String,
        /// As it is given.
        given: String,
    },
    /// The points exceed the memory limit.
    #[error(
        "{file} has {points}, which take {:.1} MB of memory or more; the limit is {:.1} MB",
        1e-6 * .bytes, 1e-6 * *.limit as f64
    )]
    TooLarge {
        /// The file, and the array of an archive.
        file: String,
        /// The number of points in words: `4 by 3 points`, or `8 points or more`.
        points: String,
        /// Memory for them and the fields on them, bytes.
        bytes: f64,
        /// Memory allowed, bytes.
        limit: usize,
    },
    /// A line of a text is too long to be a row of numbers.
    #[error("{file}, line {line}: longer than {} MB, which no row of heights is", LONGEST_LINE / 1_000_000)]
    LongLine {
        /// The file.
        file: String,
        /// Line, counted from 1.
        line: usize,
    },
    /// No numbers at all.
    #[error("{file} has no heights")]
    Empty {
        /// The file.
        file: String,
    },
    /// The given size or height unit is invalid.
    #[error("the height unit cannot be {0} m: it must be a finite number other than 0")]
    HeightUnit(f64),
    /// The given size is invalid.
    #[error(transparent)]
    Grid(#[from] InvalidGrid),
    /// A height is not finite.
    #[error("{file}: {problem}")]
    Heights {
        /// The file, and the array of an archive.
        file: String,
        /// Index of the height.
        problem: InvalidHeightMap,
    },
}

/// Names for messages.
fn list(names: &[String]) -> String {
    match names {
        [] => "no arrays".to_owned(),
        [only] => format!("the array {only:?}"),
        _ => {
            let quoted: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
            format!("the arrays {}", quoted.join(", "))
        }
    }
}

/// Heights as they are in a file, row-major.
pub(crate) struct Table {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    /// Heights, NaN where they are missing.
    pub(crate) values: Vec<f64>,
    pub(crate) stated: Stated,
    /// Line and column of the first missing height of a text, from 1.
    pub(crate) first_missing: Option<[usize; 2]>,
}

/// The file that is being read.
pub(crate) struct Source<'a> {
    /// What errors call it.
    pub(crate) file: &'a str,
    /// Memory limit of the map, bytes.
    pub(crate) memory_limit: usize,
}

impl Source<'_> {
    pub(crate) fn damaged(&self, problem: &(impl ToString + ?Sized)) -> HeightMapError {
        HeightMapError::NotNumpy {
            file: self.file.to_owned(),
            problem: problem.to_string(),
        }
    }

    pub(crate) fn no_map(&self, problem: String) -> HeightMapError {
        HeightMapError::NoMap {
            file: self.file.to_owned(),
            problem,
        }
    }

    pub(crate) fn unreadable(&self, source: io::Error) -> HeightMapError {
        HeightMapError::Read {
            file: self.file.to_owned(),
            source,
        }
    }

    /// Checks the number of points against the memory limit; `words` describes their number.
    pub(crate) fn check_memory(
        &self,
        count: u64,
        words: impl FnOnce() -> String,
    ) -> Result<(), HeightMapError> {
        let bytes = BYTES_PER_POINT * count as f64;
        if bytes <= self.memory_limit as f64 {
            return Ok(());
        }
        Err(HeightMapError::TooLarge {
            file: self.file.to_owned(),
            points: words(),
            bytes,
            limit: self.memory_limit,
        })
    }
}

/// Size of the map and of the heights as stated by a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Stated {
    /// Extent along x and y, m.
    pub(crate) extent: [Option<f64>; 2],
    /// Height unit.
    pub(crate) height_unit: Option<HeightUnit>,
    /// Distance of neighbouring points along x and y, in a unit that is not stated.
    pub(crate) spacing: Option<[f64; 2]>,
    /// Unit of that distance, m.
    pub(crate) spacing_unit: Option<f64>,
    /// Grey value of white, if the values are those of an image.
    pub(crate) white: Option<f64>,
    /// Whether the points are a list, in which the distances along x and y may differ.
    pub(crate) is_list: bool,
}

/// Height unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum HeightUnit {
    /// A length, m.
    Length(f64),
    /// Something else, by its unit.
    Other(String),
}
