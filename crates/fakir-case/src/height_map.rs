//! Reading measured surfaces: NumPy arrays and plain numbers.
//!
//! | file | what is read |
//! |---|---|
//! | `.npy` | an array of two dimensions, rows and columns, of floating-point numbers (4 or 8 bytes) or integers, in C or Fortran order |
//! | `.npz` | one such array of an archive: the one named, or the only one |
//! | any other | rows of numbers separated by blanks, commas or semicolons, or numbers with decimal commas separated by blanks or semicolons; `#` begins a comment; an ESRI ASCII grid header is read, and what Gwyddion, SPIP, Attocube, Keyence and Nova write before a matrix (`# Width: 10 um`) |
//! | any other | three columns x, y, z of the points of a grid, in any order |
//! | SDF, X3P | the formats of ISO 25178, parts 71 and 72 |
//! | PNG, TIFF | a grey image of 16 bits; a TIFF image of floating-point numbers |
//!
//! A size or a height unit that the file states must equal the given one, and is used if none is given. For an ESRI ASCII grid and a
//! list of points the unit of lengths is unknown: the spacing must equal the given one in m, mm, um or nm.
//!
//! The first row of an array, a text or a file of ISO 25178 has the smallest y; that of an image and of an ESRI ASCII grid, which are seen with y
//! upwards, the largest y. The size of an array
//! is known from its header and checked before its elements are read and unpacked; the size of a text is checked while it is read. The lens axis
//! is at the centre of the map; [`HeightMap::with_axis_at`] moves it.

use crate::archive;
use crate::formats;
use crate::height_table::{HeightUnit, Source, Stated, Table};
use crate::input;
use crate::npy::{self, Header};
use crate::npz::{Archive, PackedArray};
use crate::table_text::text_of;
use crate::unit::{Dimension, format_quantity};
use crate::{height_image, height_missing, height_profiles, height_text};
use fakir::problem::{Grid, HeightMap};
use flate2::bufread::MultiGzDecoder;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

pub use crate::height_table::HeightMapError;

/// The physical size of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapScale {
    /// Size in the plane.
    pub size: MapSize,
    /// Height unit of the file, m; negative if the file contains depths.
    pub height_unit: f64,
}

/// The size of a map in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MapSize {
    /// Distance between neighbouring points along x and y, m.
    Pixel([f64; 2]),
    /// Extent of the whole map along x and y, m, including half a pixel around the outermost
    /// points.
    Extent([f64; 2]),
    /// Extent of the whole map along x, m, in the same way; pixels are squares.
    Width(f64),
}

/// Given part of the physical size of a map. The rest is taken from the file, if it states it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GivenScale {
    /// Size in the plane.
    pub size: Option<MapSize>,
    /// Height unit of the file, m; negative if the file contains depths. 1 m if the file does not state it either.
    pub height_unit: Option<f64>,
    /// Height of white above black in an image, m.
    pub height_range: Option<f64>,
    /// Whether missing heights are interpolated.
    pub fill_missing: bool,
}

impl From<MapScale> for GivenScale {
    fn from(scale: MapScale) -> Self {
        Self {
            size: Some(scale.size),
            height_unit: Some(scale.height_unit),
            ..Self::default()
        }
    }
}

/// Reads a height map; from an `.npz` archive, the array with the given name, or the only one.
/// `memory_limit` is the largest memory (bytes) of the map and the fields on it.
///
/// # Errors
/// [`HeightMapError`]: a file that cannot be read, has an unknown format, or does not contain a
/// two-dimensional array of finite numbers, or exceeds the memory limit; a size that is not
/// positive.
pub fn read_height_map(
    path: &Path,
    array: Option<&str>,
    scale: &MapScale,
    memory_limit: usize,
) -> Result<HeightMap, HeightMapError> {
    read_scaled_map(path, array, &(*scale).into(), memory_limit)
}

/// Reads a height map as [`read_height_map`]; the missing part of its size is taken from the file.
///
/// # Errors
/// As [`read_height_map`]; [`HeightMapError::NoSize`] if the file does not state its size either.
pub fn read_scaled_map(
    path: &Path,
    array: Option<&str>,
    scale: &GivenScale,
    memory_limit: usize,
) -> Result<HeightMap, HeightMapError> {
    read_map(path, array, scale, memory_limit).map(|read| read.map)
}

/// A map that has been read.
pub(crate) struct ReadMap {
    pub(crate) map: HeightMap,
    /// Height unit that the file states, m.
    pub(crate) stated_unit: Option<f64>,
}

/// [`read_scaled_map`] with the unit that the file states.
pub(crate) fn read_map(
    path: &Path,
    array: Option<&str>,
    scale: &GivenScale,
    memory_limit: usize,
) -> Result<ReadMap, HeightMapError> {
    let file = path.display().to_string();
    let source = Source {
        file: &file,
        memory_limit,
    };
    let opened = File::open(path).map_err(|error| source.unreadable(error))?;
    match extension(path).as_deref() {
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
            // At its end the checksum of the archive is verified.
            match entry.read(&mut [0]) {
                Ok(0) => place(&file, table, scale),
                Ok(_) => Err(source.damaged("it contains data after its last element")),
                Err(error) => Err(source.damaged(&error)),
            }
        }
        _ => scaled(&source, path, BufReader::new(opened), scale),
    }
}

/// [`read_scaled_map`] from the contents of a file, whose name and format `path` gives. Archives of NumPy are only read from files.
///
/// # Errors
/// As [`read_scaled_map`].
pub fn scaled_map_in(
    path: &Path,
    contents: &[u8],
    scale: &GivenScale,
    memory_limit: usize,
) -> Result<HeightMap, HeightMapError> {
    map_in(path, contents, scale, memory_limit).map(|read| read.map)
}

/// [`scaled_map_in`] with the unit that the file states.
pub(crate) fn map_in(
    path: &Path,
    contents: &[u8],
    scale: &GivenScale,
    memory_limit: usize,
) -> Result<ReadMap, HeightMapError> {
    let file = path.display().to_string();
    let source = Source {
        file: &file,
        memory_limit,
    };
    if extension(path).as_deref() == Some("npz") {
        return Err(HeightMapError::OtherFormat {
            format: "an archive of arrays",
            advice: "save one array as .npy",
            file,
        });
    }
    scaled(&source, path, contents, scale)
}

/// Whether a file with these contents is a height map rather than a table of named columns: its format is one of arrays, images or profilers, or
/// it is a text with many numbers in every row.
#[must_use]
pub fn is_height_map(path: &Path, contents: &[u8]) -> bool {
    /// Columns from which a text without headings is a map.
    const MANY: usize = 8;
    let is_array = matches!(extension(path).as_deref(), Some("npy" | "npz"));
    let is_known = match Signature::of(contents) {
        Some(Signature::Archive) => is_x3p(contents),
        Some(_) => true,
        // A grid of ESRI.
        None => contents.starts_with(b"ncols"),
    };
    if is_array || is_known {
        return true;
    }
    let start = String::from_utf8_lossy(&contents[..contents.len().min(100_000)]);
    if height_text::is_of_program(&start) {
        return true;
    }
    let rows = start.lines().filter(|line| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with(['#', '%']) && !line.starts_with("//")
    });
    let separators: &[char] = &[' ', '\t', ',', ';'];
    let numbers = |line: &str| {
        let cells = line.split(separators).filter(|cell| !cell.is_empty());
        let mut count = 0;
        for cell in cells {
            cell.parse::<f64>().ok()?;
            count += 1;
        }
        Some(count)
    };
    // The last line may be cut off.
    let rows: Vec<&str> = rows.take(8).collect();
    rows.len() > 2
        && rows[..rows.len() - 1]
            .iter()
            .all(|row| numbers(row).is_some_and(|count| count >= MANY))
}

/// Ending of the name of a file, in lower case.
fn extension(path: &Path) -> Option<String> {
    let extension = path.extension()?.to_ascii_lowercase();
    extension.to_str().map(str::to_owned)
}

/// Reads a map, which is no archive of arrays.
fn scaled(
    source: &Source<'_>,
    path: &Path,
    contents: impl BufRead,
    scale: &GivenScale,
) -> Result<ReadMap, HeightMapError> {
    let table = match extension(path).as_deref() {
        Some("npy") => parse_npy(source, contents)?,
        _ => parse_other(source, path, contents)?,
    };
    place(source.file, table, scale)
}

/// Number of bytes by which formats are recognised.
const FIRST_BYTES: usize = 512;

/// Formats of which the first bytes are known.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Signature {
    Png,
    Tiff,
    BinarySdf,
    Sdf,
    /// A zip archive, which may contain a profile in the format X3P.
    Archive,
}

impl Signature {
    fn of(start: &[u8]) -> Option<Self> {
        let known: [(&[u8], Self); 7] = [
            (b"\x89PNG", Self::Png),
            (b"II*\0", Self::Tiff),
            (b"MM\0*", Self::Tiff),
            (b"bISO", Self::BinarySdf),
            (b"aISO", Self::Sdf),
            (b"aBCR", Self::Sdf),
            (b"PK\x03\x04", Self::Archive),
        ];
        let mut known = known.into_iter();
        known.find_map(|(bytes, found)| start.starts_with(bytes).then_some(found))
    }
}

/// Whether an archive contains a profile in the format X3P.
fn is_x3p(archive: &[u8]) -> bool {
    let names = archive::names(archive);
    names.iter().any(|name| name == "main.xml")
}

/// Reads the whole of a file, which may have as many bytes as the memory of its map.
fn whole(source: &Source<'_>, opened: &mut dyn Read) -> Result<Vec<u8>, HeightMapError> {
    let most = source.memory_limit as u64;
    input::read_all(opened, most).map_err(|error| source.unreadable(error))
}

/// Reads a file that is neither an array nor an archive of NumPy, packed by gzip or not.
fn parse_other(
    source: &Source<'_>,
    path: &Path,
    mut opened: impl BufRead,
) -> Result<Table, HeightMapError> {
    let start = opened.fill_buf();
    let start = start.map_err(|error| source.unreadable(error))?;
    if !start.starts_with(b"\x1f\x8b") {
        return parse_unpacked(source, path, opened);
    }
    let unpacked = whole(source, &mut MultiGzDecoder::new(opened))?;
    parse_unpacked(source, &path.with_extension(""), &unpacked[..])
}

/// Reads a file that is not packed, by its first bytes.
fn parse_unpacked(
    source: &Source<'_>,
    path: &Path,
    mut opened: impl BufRead,
) -> Result<Table, HeightMapError> {
    let start = opened
        .fill_buf()
        .map_err(|error| source.unreadable(error))?;
    let start = start[..start.len().min(FIRST_BYTES)].to_vec();
    let whole = |opened: &mut dyn Read| whole(source, opened);
    let bytes = match Signature::of(&start) {
        Some(Signature::Png) => return height_image::png(source, &whole(&mut opened)?),
        Some(Signature::Tiff) => return height_image::tiff(source, &whole(&mut opened)?),
        Some(Signature::BinarySdf) => {
            return height_profiles::binary_sdf(source, &whole(&mut opened)?);
        }
        Some(Signature::Sdf) => return height_profiles::sdf(source, &whole(&mut opened)?),
        Some(Signature::Archive) => {
            let archive = whole(&mut opened)?;
            if is_x3p(&archive) {
                return height_profiles::x3p(source, &archive);
            }
            archive
        }
        None => start,
    };
    let is_wide = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    if is_wide {
        let bytes = whole(&mut opened)?;
        if let Some(text) = text_of(&bytes) {
            return height_text::parse(source, text.as_bytes());
        }
    }
    let format = formats::recognised(path, &bytes).map(|format| (format.name, format.heights));
    let wide = ("damaged text in UTF-16", "save it as text in UTF-8");
    let unknown = ("a binary file of an unknown format", formats::EXPORT);
    let is_binary = bytes.contains(&0);
    match format
        .or(is_wide.then_some(wide))
        .or(is_binary.then_some(unknown))
    {
        Some((format, advice)) => Err(HeightMapError::OtherFormat {
            file: source.file.to_owned(),
            format,
            advice,
        }),
        None => height_text::parse(source, opened),
    }
}

/// Writes values on the cells of a grid as a `.npy` file: an array of rows and columns that
/// [`read_height_map`] can read.
///
/// # Panics
/// If the number of values differs from the number of cells.
#[must_use]
pub fn to_npy(grid: &Grid, values: &[f64]) -> Vec<u8> {
    assert_eq!(values.len(), grid.cell_count());
    npy::write(grid.rows(), grid.columns(), values)
}

/// Sets the physical size of a table.
fn place(file: &str, table: Table, scale: &GivenScale) -> Result<ReadMap, HeightMapError> {
    let Table {
        columns,
        rows,
        mut values,
        stated,
        first_missing,
    } = table;
    let height_unit = match (scale.height_range, stated.white) {
        (Some(range), Some(white)) => range / white,
        (Some(range), None) => {
            return Err(HeightMapError::HeightRange {
                file: file.to_owned(),
                given: shown(range),
            });
        }
        (None, Some(_)) if scale.height_unit.is_none() => {
            let file = file.to_owned();
            return Err(HeightMapError::NoHeightRange { file });
        }
        _ => stated.height_unit(file, scale.height_unit)?,
    };
    if !height_unit.is_finite() || height_unit == 0.0 {
        return Err(HeightMapError::HeightUnit(height_unit));
    }
    if values.is_empty() {
        return Err(HeightMapError::Empty {
            file: file.to_owned(),
        });
    }
    let counts = [columns as f64, rows as f64];
    let size = scale.size.or(stated.size());
    let size = size.ok_or_else(|| HeightMapError::NoSize {
        file: file.to_owned(),
    })?;
    let cell = match size {
        MapSize::Pixel(cell) => cell,
        MapSize::Extent([width, height]) => [width / counts[0], height / counts[1]],
        MapSize::Width(width) => [width / counts[0]; 2],
    };
    // An invalid cell size is reported first, because it explains the errors that follow from it.
    Grid::new(1, 1, cell, [0.0, 0.0])?;
    let cell = stated.checked(file, cell, counts)?;
    fill_missing(
        file,
        &mut values,
        columns,
        first_missing,
        scale.fill_missing,
    )?;
    let origin = [0, 1].map(|axis| -0.5 * counts[axis] * cell[axis]);
    let grid = Grid::new(columns, rows, cell, origin)?;
    let heights = values.into_iter().map(|value| height_unit * value);
    let map = HeightMap::new(grid, heights.collect());
    let map = map.map_err(|problem| HeightMapError::Heights {
        file: file.to_owned(),
        problem,
    })?;
    let stated_unit = match stated.height_unit {
        Some(HeightUnit::Length(unit)) => Some(unit),
        _ => None,
    };
    Ok(ReadMap { map, stated_unit })
}

/// Interpolates missing heights, or refuses them with their count.
fn fill_missing(
    file: &str,
    values: &mut [f64],
    columns: usize,
    first: Option<[usize; 2]>,
    fill: bool,
) -> Result<(), HeightMapError> {
    let file = || file.to_owned();
    let count = values.iter().filter(|value| value.is_nan()).count();
    let Some(place) = values.iter().position(|value| value.is_nan()) else {
        return Ok(());
    };
    if count == values.len() {
        return Err(HeightMapError::Empty { file: file() });
    }
    if fill && 2 * count > values.len() {
        let problem = format!(
            "{count} of {} heights are missing, more than half, which are not interpolated",
            values.len()
        );
        return Err(HeightMapError::NoMap {
            file: file(),
            problem,
        });
    }
    match (fill, first) {
        (true, _) => {
            height_missing::fill(values, columns);
            Ok(())
        }
        (false, Some([line, column])) => Err(HeightMapError::NoData {
            file: file(),
            line,
            column,
            count,
        }),
        (false, None) => Err(HeightMapError::Missing {
            file: file(),
            count,
            total: values.len(),
            column: place % columns,
            row: place / columns,
        }),
    }
}

/// Name of the height unit in errors of contradictions.
pub(crate) const HEIGHT_UNIT: &str = "a unit of heights";

/// Relative tolerance of equal sizes: files state them with few digits.
const SAME_SIZE: f64 = 0.01;

/// Possible units of lengths in a file that does not state them, m.
const LENGTH_UNITS: [f64; 4] = [1.0, 1e-3, 1e-6, 1e-9];

fn is_same_size(size: f64, other: f64) -> bool {
    (size - other).abs() <= SAME_SIZE * other.abs()
}

impl Stated {
    /// Size in the plane, if the file states it.
    fn size(&self) -> Option<MapSize> {
        match self.extent {
            [Some(width), Some(height)] => Some(MapSize::Extent([width, height])),
            [Some(width), None] => Some(MapSize::Width(width)),
            [None, _] => {
                let unit = self.spacing_unit.filter(|_| self.is_list)?;
                Some(MapSize::Pixel(self.spacing?.map(|spacing| unit * spacing)))
            }
        }
    }

    /// Height unit, m: the given one, which must agree with the file, or that of the file.
    fn height_unit(&self, file: &str, given: Option<f64>) -> Result<f64, HeightMapError> {
        match (given, &self.height_unit) {
            (None, None) => Ok(1.0),
            (None, Some(HeightUnit::Length(unit))) => Ok(*unit),
            (None, Some(HeightUnit::Other(unit))) => Err(HeightMapError::NotHeights {
                file: file.to_owned(),
                unit: unit.clone(),
            }),
            (Some(given), Some(HeightUnit::Length(unit))) if !is_same_size(given.abs(), *unit) => {
                Err(HeightMapError::Contradiction {
                    file: file.to_owned(),
                    what: HEIGHT_UNIT,
                    stated: shown(*unit),
                    given: shown(given),
                })
            }
            (Some(given), _) => Ok(given),
        }
    }

    /// Sides of a cell (m), checked against the file; for a list of points, those of the file in the unit that agrees with the
    /// given size.
    fn checked(
        &self,
        file: &str,
        cell: [f64; 2],
        counts: [f64; 2],
    ) -> Result<[f64; 2], HeightMapError> {
        let contradiction = |what, stated, given| HeightMapError::Contradiction {
            file: file.to_owned(),
            what,
            stated,
            given,
        };
        for (axis, what) in ["a width", "a height"].into_iter().enumerate() {
            let given = cell[axis] * counts[axis];
            if let Some(stated) = self.extent[axis].filter(|stated| !is_same_size(given, *stated)) {
                return Err(contradiction(what, shown(stated), shown(given)));
            }
        }
        let is_square = is_same_size(cell[0], cell[1]);
        // Cells of another shape than the given ones, which are squares if one number is given.
        let is_wide = |[x, y]: &[f64; 2]| self.is_list || !is_same_size(*x, *y);
        let Some(spacing) = self.spacing.filter(|cell| is_square || is_wide(cell)) else {
            return Ok(cell);
        };
        // The width of a list may be the distance between its outermost points.
        let inner = cell[0] * counts[0] / (counts[0] - 1.0);
        let fits = |unit: &f64| {
            let distance = unit * spacing[0];
            is_same_size(cell[0], distance) || (self.is_list && is_same_size(inner, distance))
        };
        let mut units = match self.spacing_unit {
            Some(unit) => vec![unit],
            None => LENGTH_UNITS.to_vec(),
        }
        .into_iter();
        let Some(unit) = units.find(fits) else {
            // Columns and rows that are counted have no unit.
            let is_counted = spacing.iter().all(|step| (step - 1.0).abs() < 1e-9);
            if self.is_list && is_counted && self.spacing_unit.is_none() {
                return Ok(cell);
            }
            let stated = match self.spacing_unit {
                Some(unit) => shown(unit * spacing[0]),
                None => format!("{} (in a unit of length)", significant(spacing[0])),
            };
            return Err(contradiction(
                "a distance of points",
                stated,
                shown(cell[0]),
            ));
        };
        Ok(match is_wide(&spacing) {
            true => spacing.map(|distance| unit * distance),
            false => cell,
        })
    }
}

/// Formats a number with four digits.
fn significant(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Formats a length with four digits.
pub(crate) fn shown(length: f64) -> String {
    format_quantity(significant(length), Dimension::Length)
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
    if column_count == 3 && height_text::grid_of_points(&values, 3, [0, 1, 2]).is_some() {
        return Err(source.no_map(format!(
            "it is a list of {rows} points x, y, z: give its heights as rows and columns, as by z.reshape(rows, columns), or the list as text"
        )));
    }
    Ok(Table {
        columns: column_count,
        rows: row_count,
        values,
        stated: Stated::default(),
        first_missing: None,
    })
}
