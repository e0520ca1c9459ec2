//! Reading measured surfaces: NumPy arrays and plain numbers.
//!
//! | file | what is read |
//! |---|---|
//! | `.npy` | an array of two dimensions, rows and columns, of floating-point numbers (4 or 8 bytes) or integers, in C or Fortran order |
//! | `.npz` | one such array of an archive: the one named, or the only one |
//! | any other | rows of numbers separated by blanks, commas or semicolons; `#` begins a comment; an ESRI ASCII grid header is understood |
//!
//! The first row of an array or text is that of smallest y; that of an ESRI ASCII grid, as its
//! format has it, that of largest y. The lens axis is put on the centre of the map;
//! [`HeightMap::with_axis_at`] moves it.

use fakir::love::{Grid, HeightMap, InvalidGrid, InvalidHeightMap};
use npyz::{DType, NpyFile, NpyHeader, Order, TypeChar, WriterBuilder};
use std::io::{Cursor, Read};
use std::path::Path;
use zip::ZipArchive;

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
        /// Why not.
        source: std::io::Error,
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
        /// What is there.
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

/// Reads a height map; of an `.npz` archive the array of the given name, or the only one.
///
/// # Errors
/// [`HeightMapError`]: a file that cannot be read, is of no known format, or holds no
/// two-dimensional array of finite numbers; a size that is not positive.
pub fn read_height_map(
    path: &Path,
    array: Option<&str>,
    scale: &MapScale,
) -> Result<HeightMap, HeightMapError> {
    let file = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|source| HeightMapError::Read {
        file: file.clone(),
        source,
    })?;
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    match extension.to_str() {
        Some("npy") => place(&file, parse_npy(&file, &bytes)?, scale),
        Some("npz") => {
            let (name, bytes) = extract(&file, &bytes, array)?;
            let file = format!("{file}, array {name:?}");
            place(&file, parse_npy(&file, &bytes)?, scale)
        }
        _ => place(&file, parse_text(&file, &bytes)?, scale),
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
    let shape = [grid.rows() as u64, grid.columns() as u64];
    let mut bytes = Vec::new();
    let options = npyz::WriteOptions::new().default_dtype().shape(&shape);
    let written = options.writer(&mut bytes).begin_nd().and_then(|mut array| {
        array.extend(values.iter().copied())?;
        array.finish()
    });
    written.expect("memory takes every byte");
    bytes
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

/// Takes an array out of an archive, as the bytes of its `.npy` file, with its name.
fn extract(
    file: &str,
    bytes: &[u8],
    wanted: Option<&str>,
) -> Result<(String, Vec<u8>), HeightMapError> {
    let damaged = |problem: String| HeightMapError::NotNumpy {
        file: file.to_owned(),
        problem,
    };
    let mut archive =
        ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(error.to_string()))?;
    let available: Vec<String> = archive
        .file_names()
        .filter_map(|name| Some(name.ok()?.strip_suffix(".npy")?.to_owned()))
        .collect();
    let name = match (wanted, &available[..]) {
        (None, [only]) => only.clone(),
        (None, _) => {
            return Err(HeightMapError::ArrayNotNamed {
                file: file.to_owned(),
                available,
            });
        }
        (Some(wanted), names) if names.iter().any(|name| name == wanted) => wanted.to_owned(),
        (Some(wanted), _) => {
            return Err(HeightMapError::NoSuchArray {
                file: file.to_owned(),
                wanted: wanted.to_owned(),
                available,
            });
        }
    };
    let mut entry = archive
        .by_name(&format!("{name}.npy"))
        .map_err(|error| damaged(error.to_string()))?;
    let mut contents = Vec::new();
    entry
        .read_to_end(&mut contents)
        .map_err(|error| damaged(error.to_string()))?;
    drop(entry);
    Ok((name, contents))
}

fn parse_npy(file: &str, bytes: &[u8]) -> Result<Table, HeightMapError> {
    let damaged = |problem: String| HeightMapError::NotNumpy {
        file: file.to_owned(),
        problem,
    };
    let mut data = bytes;
    let header = NpyHeader::from_reader(&mut data).map_err(|error| damaged(error.to_string()))?;
    let [rows, columns] = *header.shape() else {
        return Err(HeightMapError::Dimensions {
            file: file.to_owned(),
            shape: header.shape().to_vec(),
        });
    };
    let count = rows.checked_mul(columns);
    let size = header.dtype().num_bytes().unwrap_or(1) as u64;
    let needed = count.and_then(|count| count.checked_mul(size));
    let (Ok(rows), Ok(columns), Some(needed)) =
        (usize::try_from(rows), usize::try_from(columns), needed)
    else {
        return Err(damaged(format!("an array of {rows} by {columns} elements")));
    };
    if needed > data.len() as u64 {
        return Err(damaged(format!(
            "it ends early: {needed} bytes of data expected, {} found",
            data.len()
        )));
    }
    let order = header.order();
    let stored = read_elements(file, NpyFile::with_header(header, data))?;
    let values = match order {
        Order::C => stored,
        Order::Fortran => (0..rows)
            .flat_map(|row| (0..columns).map(move |column| column * rows + row))
            .map(|place| stored[place])
            .collect(),
    };
    Ok(Table {
        columns,
        rows,
        values,
    })
}

/// All elements as they are stored, whatever their type.
fn read_elements(file: &str, array: NpyFile<&[u8]>) -> Result<Vec<f64>, HeightMapError> {
    let element = array.header().dtype();
    let kind = match &element {
        DType::Plain(kind) => (kind.type_char(), kind.size_field()),
        DType::Array(..) | DType::Record(_) => (TypeChar::Object, 0),
    };
    let values = match kind {
        (TypeChar::Float, 8) => array.into_vec::<f64>(),
        (TypeChar::Float, 4) => floats(array.into_vec::<f32>()),
        (TypeChar::Int, 1) => floats(array.into_vec::<i8>()),
        (TypeChar::Int, 2) => floats(array.into_vec::<i16>()),
        (TypeChar::Int, 4) => floats(array.into_vec::<i32>()),
        (TypeChar::Uint, 1) => floats(array.into_vec::<u8>()),
        (TypeChar::Uint, 2) => floats(array.into_vec::<u16>()),
        (TypeChar::Uint, 4) => floats(array.into_vec::<u32>()),
        (TypeChar::Int, 8) => array
            .into_vec::<i64>()
            .map(|values| values.into_iter().map(|value| value as f64).collect()),
        (TypeChar::Uint, 8) => array
            .into_vec::<u64>()
            .map(|values| values.into_iter().map(|value| value as f64).collect()),
        _ => {
            return Err(HeightMapError::ElementType {
                file: file.to_owned(),
                found: element.descr(),
            });
        }
    };
    values.map_err(|error| HeightMapError::NotNumpy {
        file: file.to_owned(),
        problem: error.to_string(),
    })
}

fn floats<T: Into<f64>>(values: std::io::Result<Vec<T>>) -> std::io::Result<Vec<f64>> {
    Ok(values?.into_iter().map(Into::into).collect())
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
    /// Takes a line of the header; whether it is one.
    fn take(&mut self, words: &[&str]) -> bool {
        let [key, value] = words else {
            return false;
        };
        match key.to_ascii_lowercase().as_str() {
            "ncols" => self.columns = value.parse().ok(),
            "nrows" => self.rows = value.parse().ok(),
            "nodata_value" => self.no_data = value.parse().ok(),
            // Place and size in the plane are the caller's to give.
            "xllcorner" | "yllcorner" | "xllcenter" | "yllcenter" | "cellsize" | "dx" | "dy" => {}
            _ => return false,
        }
        self.found = true;
        true
    }
}

fn parse_text(file: &str, bytes: &[u8]) -> Result<Table, HeightMapError> {
    let text = String::from_utf8_lossy(bytes);
    let mut header = EsriHeader::default();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for (line, content) in (1..).zip(text.lines()) {
        let content = content.split('#').next().unwrap_or_default();
        let words: Vec<&str> = content
            .split(|c: char| c.is_whitespace() || c == ',' || c == ';')
            .filter(|word| !word.is_empty())
            .collect();
        if words.is_empty() || (rows.is_empty() && header.take(&words)) {
            continue;
        }
        let row = parse_row(file, line, &words, header.no_data)?;
        let expected = rows.first().map_or(row.len(), Vec::len);
        if row.len() != expected {
            return Err(HeightMapError::RaggedRow {
                file: file.to_owned(),
                line,
                found: row.len(),
                expected,
            });
        }
        rows.push(row);
    }
    if header.found {
        rows.reverse();
    }
    let (found_columns, found_rows) = (rows.first().map_or(0, Vec::len), rows.len());
    let columns = header.columns.unwrap_or(found_columns);
    let wanted_rows = header.rows.unwrap_or(found_rows);
    if (columns, wanted_rows) != (found_columns, found_rows) {
        return Err(HeightMapError::HeaderSize {
            file: file.to_owned(),
            columns,
            rows: wanted_rows,
            found_columns,
            found_rows,
        });
    }
    Ok(Table {
        columns: found_columns,
        rows: found_rows,
        values: rows.concat(),
    })
}

fn parse_row(
    file: &str,
    line: usize,
    words: &[&str],
    no_data: Option<f64>,
) -> Result<Vec<f64>, HeightMapError> {
    (1..)
        .zip(words)
        .map(|(column, word)| {
            let value: f64 = word.parse().map_err(|_| HeightMapError::NotANumber {
                file: file.to_owned(),
                line,
                column,
                text: (*word).to_owned(),
            })?;
            if no_data.is_some_and(|marker| value.total_cmp(&marker).is_eq()) {
                return Err(HeightMapError::NoData {
                    file: file.to_owned(),
                    line,
                    column,
                });
            }
            Ok(value)
        })
        .collect()
}
