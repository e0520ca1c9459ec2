//! Reading measured surfaces: NumPy arrays and plain numbers.
//!
//! | file | what is read |
//! |---|---|
//! | `.npy` | an array of two dimensions, rows and columns, of floating-point numbers (4 or 8 bytes) or integers, in C or Fortran order |
//! | `.npz` | one such array of an archive: the one named, or the only one |
//! | any other | rows of numbers separated by blanks, commas or semicolons; `#` begins a comment; an ESRI ASCII grid header is understood |
//!
//! The first row of an array or text is that of smallest y; that of an ESRI ASCII grid, as its
//! format has it, that of largest y. The size of an array is known from its header and checked
//! before its elements are read, unpacked as they come; that of a text is checked while it is read. The lens axis is put on the centre of the map;
//! [`HeightMap::with_axis_at`] moves it.

use crate::npy::{self, Header};
use crate::npz::{Archive, PackedArray};
use fakir::problem::{Grid, HeightMap, InvalidGrid, InvalidHeightMap};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

/// Memory that every point of a map takes, bytes: its height and pillar on cells of three sizes,
/// separation, start, and the fields of the solution.
pub(crate) const BYTES_PER_POINT: f64 = 64.0;

/// Longest line of a text, bytes: millions of numbers.
const LONGEST_LINE: u64 = 64_000_000;

/// The physical size of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapScale {
    /// Size in the plane.
    pub size: MapSize,
    /// What a height of 1 in the file stands for, m; negative where the file has depths.
    pub height_unit: f64,
}

/// The size of a map in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MapSize {
    /// Distance between neighbouring points along x and y, m.
    Pixel([f64; 2]),
    /// Extent of the whole map along x and y, m, half a pixel around the outermost points
    /// included.
    Extent([f64; 2]),
    /// Extent of the whole map along x, m, in the same way; pixels are squares.
    Width(f64),
}

/// Why a height map cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HeightMapError {
    /// The file cannot be read at all.
    #[error("cannot read {file}: {source}")]
    Read {
        /// The file.
        file: String,
        /// Why the system could not read it.
        source: io::Error,
    },
    /// It is no NumPy file, or a damaged one.
    #[error("{file} is not a readable NumPy file: {problem}")]
    NotNumpy {
        /// The file, and the array of an archive.
        file: String,
        /// What is wrong with it.
        problem: String,
    },
    /// An archive has no array of that name.
    #[error("{file} has no array {wanted:?}; it has {}", list(.available))]
    NoSuchArray {
        /// The file.
        file: String,
        /// The name asked for.
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
    /// An array has elements that are no numbers.
    #[error(
        "{file} has elements of type {found}: heights are real numbers of 4 or 8 bytes, or integers"
    )]
    ElementType {
        /// The file, and the array of an archive.
        file: String,
        /// The type, as NumPy writes it.
        found: String,
    },
    /// A word of a text is no number.
    #[error("{file}, line {line}, column {column}: {text:?} is not a number")]
    NotANumber {
        /// The file.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// Which number of the line, counted from 1.
        column: usize,
        /// The word that is no number.
        text: String,
    },
    /// The rows of a text differ in length.
    #[error("{file}, line {line}: {found} numbers, but {expected} in the rows before")]
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
    /// An ESRI ASCII grid has another size than its header says.
    #[error(
        "{file}: {found_columns} columns and {found_rows} rows, but its header says {columns} and {rows}"
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
    #[error("{file}, line {line}, column {column}: there is no data")]
    NoData {
        /// The file.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// Which number of the line, counted from 1.
        column: usize,
    },
    /// More points than there is memory for.
    #[error(
        "{file} has {points}, which take {:.1} MB of memory or more; the limit is {:.1} MB",
        1e-6 * .bytes, 1e-6 * *.limit as f64
    )]
    TooLarge {
        /// The file, and the array of an archive.
        file: String,
        /// The number of points in words: `4 by 3 points`, or `8 points or more`.
        points: String,
        /// Memory that they and the fields on them take, bytes.
        bytes: f64,
        /// Memory allowed, bytes.
        limit: usize,
    },
    /// A line of a text that is no row of numbers, as it does not end.
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
    /// The size or the height unit given cannot be.
    #[error("the height unit cannot be {0} m: it must be a finite number other than 0")]
    HeightUnit(f64),
    /// The size given cannot be.
    #[error(transparent)]
    Grid(#[from] InvalidGrid),
    /// A height is not finite.
    #[error("{file}: {problem}")]
    Heights {
        /// The file, and the array of an archive.
        file: String,
        /// Which height.
        problem: InvalidHeightMap,
    },
}

/// Names for a person.
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
struct Table {
    columns: usize,
    rows: usize,
    values: Vec<f64>,
}

/// What is being read.
struct Source<'a> {
    /// What errors call it.
    file: &'a str,
    /// The most memory that the map may take, bytes.
    memory_limit: usize,
}

impl Source<'_> {
    fn damaged(&self, problem: &(impl ToString + ?Sized)) -> HeightMapError {
        HeightMapError::NotNumpy {
            file: self.file.to_owned(),
            problem: problem.to_string(),
        }
    }

    fn unreadable(&self, source: io::Error) -> HeightMapError {
        HeightMapError::Read {
            file: self.file.to_owned(),
            source,
        }
    }

    /// Whether so many points fit the memory allowed; `words` says how many they are.
    fn check_memory(
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

/// Reads a height map; of an `.npz` archive the array of the given name, or the only one.
/// `memory_limit` is the most memory (bytes) that the map and the fields on it may take.
///
/// # Errors
/// [`HeightMapError`]: a file that cannot be read, is of no known format, or holds no
/// two-dimensional array of finite numbers, or more of them than there is memory for; a size that is
/// not positive.
pub fn read_height_map(
    path: &Path,
    array: Option<&str>,
    scale: &MapScale,
    memory_limit: usize,
) -> Result<HeightMap, HeightMapError> {
    let file = path.display().to_string();
    let source = Source {
        file: &file,
        memory_limit,
    };
    let opened = File::open(path).map_err(|error| source.unreadable(error))?;
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    match extension.to_str() {
        Some("npy") => place(&file, parse_npy(&source, BufReader::new(opened))?, scale),
        Some("npz") => {
            let archive = Archive::open(opened).map_err(|error| source.damaged(&error))?;
            let packed = packed_array(&source, &archive, array)?;
            let file = format!("{file}, array {:?}", packed.name);
            let source = Source {
                file: &file,
                memory_limit,
            };
            let entry = archive.unpacked(packed);
            let mut entry = entry.map_err(|problem| source.damaged(&problem))?;
            let table = parse_npy(&source, &mut entry)?;
            // At its end the archive looks whether the array is what was packed.
            match entry.read(&mut [0]) {
                Ok(0) => place(&file, table, scale),
                Ok(_) => Err(source.damaged("it goes on after its last element")),
                Err(error) => Err(source.damaged(&error)),
            }
        }
        _ => place(&file, parse_text(&source, BufReader::new(opened))?, scale),
    }
}

/// Values on the cells of a grid as a `.npy` file: an array of rows and columns, as
/// [`read_height_map`] reads it.
///
/// # Panics
/// If there is not one value for every cell.
#[must_use]
pub fn to_npy(grid: &Grid, values: &[f64]) -> Vec<u8> {
    assert_eq!(values.len(), grid.cell_count());
    npy::write(grid.rows(), grid.columns(), values)
}

/// Gives a table its physical size.
fn place(file: &str, table: Table, scale: &MapScale) -> Result<HeightMap, HeightMapError> {
    let Table {
        columns,
        rows,
        values,
    } = table;
    if !scale.height_unit.is_finite() || scale.height_unit == 0.0 {
        return Err(HeightMapError::HeightUnit(scale.height_unit));
    }
    if values.is_empty() {
        return Err(HeightMapError::Empty {
            file: file.to_owned(),
        });
    }
    let (columns_f, rows_f) = (columns as f64, rows as f64);
    let cell = match scale.size {
        MapSize::Pixel(cell) => cell,
        MapSize::Extent([width, height]) => [width / columns_f, height / rows_f],
        MapSize::Width(width) => [width / columns_f; 2],
    };
    let origin = [-0.5 * columns_f * cell[0], -0.5 * rows_f * cell[1]];
    // An impossible cell size is the better explanation of an impossible origin.
    Grid::new(1, 1, cell, [0.0, 0.0])?;
    let grid = Grid::new(columns, rows, cell, origin)?;
    let heights = values.into_iter().map(|value| scale.height_unit * value);
    HeightMap::new(grid, heights.collect()).map_err(|problem| HeightMapError::Heights {
        file: file.to_owned(),
        problem,
    })
}

/// The array of an archive that is to be read.
fn packed_array<'a>(
    source: &Source<'_>,
    archive: &'a Archive,
    wanted: Option<&str>,
) -> Result<&'a PackedArray, HeightMapError> {
    let file = source.file.to_owned();
    let names = || {
        let names = archive.arrays.iter().map(|packed| packed.name.clone());
        names.collect()
    };
    match (wanted, &archive.arrays[..]) {
        (None, [only]) => Ok(only),
        (None, _) => Err(HeightMapError::ArrayNotNamed {
            file,
            available: names(),
        }),
        (Some(wanted), arrays) => {
            let named = arrays.iter().find(|packed| packed.name == wanted);
            named.ok_or_else(|| HeightMapError::NoSuchArray {
                file,
                wanted: wanted.to_owned(),
                available: names(),
            })
        }
    }
}

fn parse_npy(source: &Source<'_>, mut data: impl Read) -> Result<Table, HeightMapError> {
    let header = Header::read(&mut data).map_err(|error| source.damaged(&error))?;
    let [rows, columns] = header.shape[..] else {
        return Err(HeightMapError::Dimensions {
            file: source.file.to_owned(),
            shape: header.shape,
        });
    };
    let Some(element) = header.element_type() else {
        return Err(HeightMapError::ElementType {
            file: source.file.to_owned(),
            found: header.type_name().to_owned(),
        });
    };
    let count = rows.checked_mul(columns);
    let needed = count.and_then(|count| count.checked_mul(element.size as u64));
    let (Ok(row_count), Ok(column_count), Some(count), Some(needed)) = (
        usize::try_from(rows),
        usize::try_from(columns),
        count,
        needed,
    ) else {
        return Err(source.damaged(&format!("an array of {rows} by {columns} elements")));
    };
    source.check_memory(count, || format!("{columns} by {rows} points"))?;
    let mut data = data.take(needed);
    let stored = element.read(&mut data, row_count * column_count);
    let stored = stored.map_err(|error| match error.kind() {
        io::ErrorKind::UnexpectedEof => source.damaged(&format!(
            "it ends early: {needed} bytes of data expected, {} found",
            needed - data.limit()
        )),
        _ => source.damaged(&error),
    })?;
    let values = if header.fortran_order {
        (0..row_count)
            .flat_map(|row| (0..column_count).map(move |column| column * row_count + row))
            .map(|place| stored[place])
            .collect()
    } else {
        stored
    };
    Ok(Table {
        columns: column_count,
        rows: row_count,
        values,
    })
}

/// The header of an ESRI ASCII grid, as far as it matters here.
#[derive(Default)]
struct EsriHeader {
    columns: Option<usize>,
    rows: Option<usize>,
    no_data: Option<f64>,
    found: bool,
}

impl EsriHeader {
    /// Reads a line of the header. False if the line is none.
    fn take<'w>(&mut self, mut words: impl Iterator<Item = &'w str>) -> bool {
        let (Some(key), Some(value), None) = (words.next(), words.next(), words.next()) else {
            return false;
        };
        match key.to_ascii_lowercase().as_str() {
            "ncols" => self.columns = value.parse().ok(),
            "nrows" => self.rows = value.parse().ok(),
            "nodata_value" => self.no_data = value.parse().ok(),
            // The caller says where the map is and how large it is.
            "xllcorner" | "yllcorner" | "xllcenter" | "yllcenter" | "cellsize" | "dx" | "dy" => {}
            _ => return false,
        }
        self.found = true;
        true
    }
}

fn parse_text(source: &Source<'_>, mut text: impl BufRead) -> Result<Table, HeightMapError> {
    let mut header = EsriHeader::default();
    let (mut columns, mut values) = (0, Vec::new());
    let mut bytes = Vec::new();
    for line in 1.. {
        bytes.clear();
        let read = text
            .by_ref()
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut bytes);
        let length = read.map_err(|error| source.unreadable(error))?;
        if length == 0 {
            break;
        }
        if length as u64 == LONGEST_LINE {
            return Err(HeightMapError::LongLine {
                file: source.file.to_owned(),
                line,
            });
        }
        let content = String::from_utf8_lossy(&bytes);
        let content = content.split('#').next().unwrap_or_default();
        let words = || {
            content
                .split(|c: char| c.is_whitespace() || c == ',' || c == ';')
                .filter(|word| !word.is_empty())
        };
        let found = words().count();
        if found == 0 || (values.is_empty() && header.take(words())) {
            continue;
        }
        if values.is_empty() {
            columns = found;
        }
        if found != columns {
            return Err(HeightMapError::RaggedRow {
                file: source.file.to_owned(),
                line,
                found,
                expected: columns,
            });
        }
        let points = values.len() + found;
        source.check_memory(points as u64, || format!("{points} points or more"))?;
        for (column, word) in (1..).zip(words()) {
            values.push(height(source, line, column, word, header.no_data)?);
        }
    }
    let rows = values.len().checked_div(columns).unwrap_or(0);
    let (said_columns, said_rows) = (
        header.columns.unwrap_or(columns),
        header.rows.unwrap_or(rows),
    );
    if (said_columns, said_rows) != (columns, rows) {
        return Err(HeightMapError::HeaderSize {
            file: source.file.to_owned(),
            columns: said_columns,
            rows: said_rows,
            found_columns: columns,
            found_rows: rows,
        });
    }
    if header.found {
        values = values
            .rchunks_exact(columns.max(1))
            .flatten()
            .copied()
            .collect();
    }
    Ok(Table {
        columns,
        rows,
        values,
    })
}

/// A height of a text.
fn height(
    source: &Source<'_>,
    line: usize,
    column: usize,
    word: &str,
    no_data: Option<f64>,
) -> Result<f64, HeightMapError> {
    let file = || source.file.to_owned();
    let value: f64 = word.parse().map_err(|_| HeightMapError::NotANumber {
        file: file(),
        line,
        column,
        text: word.to_owned(),
    })?;
    if no_data.is_some_and(|marker| value.total_cmp(&marker).is_eq()) {
        return Err(HeightMapError::NoData {
            file: file(),
            line,
            column,
        });
    }
    Ok(value)
}
