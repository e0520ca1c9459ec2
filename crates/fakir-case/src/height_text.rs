//! Height maps from text: matrices of numbers, ESRI ASCII grids, matrices with the heading of Gwyddion, and lists of points.

use crate::columns::{length_unit, split_unit};
use crate::height_table::{HeightMapError, HeightUnit, LONGEST_LINE, Source, Stated, Table};
use crate::notation::{Evidence, Marks, Notation};
use crate::unit::{Dimension, parse_quantity};
use std::io::{BufRead, Read};

/// Byte order mark of UTF-8.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// Smallest number of points of a list that is interpreted as a grid: two by three.
const FEWEST_POINTS: usize = 6;

/// Number of rows of three numbers beyond which they are not a map with three columns.
const FEWEST_ROWS_OF_A_LIST: usize = 100;

/// Number of columns from which a first row of 0, 1, 2 and so on numbers them: in small maps it may be heights.
const FEWEST_NUMBERED: usize = 8;

/// Coordinates of a list are equal if they differ by at most this fraction of their range.
const SAME: f64 = 1e-6;

/// Largest deviation of a coordinate from an equally spaced grid, over the spacing: coordinates may be
/// rounded to few digits.
const UNEVEN: f64 = 0.25;

/// Reads a text.
pub(crate) fn parse(source: &Source<'_>, mut text: impl BufRead) -> Result<Table, HeightMapError> {
    let mut reader = Reader {
        source,
        header: EsriHeader::default(),
        stated: Stated::default(),
        commas: Commas::Unknown,
        point: None,
        evidence: Evidence::default(),
        marks: Default::default(),
        columns: 0,
        values: Vec::new(),
        first_missing: None,
    };
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
        reader.line(line, &String::from_utf8_lossy(&bytes))?;
    }
    reader.table()
}

/// Meaning of commas in a text.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Commas {
    /// Unknown so far.
    Unknown,
    /// Decimal comma.
    Decimal,
    /// Separator of numbers.
    Separators,
}

/// A text that is being read.
struct Reader<'a> {
    source: &'a Source<'a>,
    header: EsriHeader,
    stated: Stated,
    commas: Commas,
    /// First line of a number with a point.
    point: Option<usize>,
    /// What numbers show of decimal marks, as long as none has shown it.
    evidence: Evidence,
    /// Numbers whose marks may separate thousands: of each column of a list of points, of all columns of a map.
    marks: [Marks; 3],
    columns: usize,
    values: Vec<f64>,
    first_missing: Option<[usize; 2]>,
}

impl Reader<'_> {
    fn line(&mut self, line: usize, text: &str) -> Result<(), HeightMapError> {
        let text = text.trim_start_matches(BYTE_ORDER_MARK);
        let (content, comment) = text.split_once('#').unwrap_or((text, ""));
        if self.values.is_empty() && content.trim().is_empty() {
            self.stated.take(comment);
        }
        if self.values.is_empty() && self.names_points(content) {
            return Ok(());
        }
        let words = self.words(line, content)?;
        if words.is_empty() || (self.values.is_empty() && self.header.take(&words)) {
            return Ok(());
        }
        if self.values.is_empty() {
            self.columns = words.len();
        }
        if words.len() != self.columns {
            return Err(HeightMapError::RaggedRow {
                file: self.source.file.to_owned(),
                line,
                found: words.len(),
                expected: self.columns,
            });
        }
        let points = self.values.len() + words.len();
        self.source
            .check_memory(points as u64, || format!("{points} points or more"))?;
        if self.point.is_none() && words.iter().any(|word| word.contains('.')) {
            self.point = Some(line);
        }
        if !self.evidence.is_decided() {
            for (column, word) in words.iter().enumerate() {
                self.evidence.add(word);
                let of_list = if self.columns == 3 { column } else { 0 };
                self.marks[of_list].add(line as u64, word);
            }
        }
        for (column, word) in (1..).zip(words) {
            let height = self.height(line, column, word)?;
            self.values.push(height);
        }
        Ok(())
    }

    /// Numbers of a line. They are separated by commas, unless blanks or semicolons separate them and a comma is inside a number; all
    /// commas of a text have the same meaning.
    fn words<'t>(&mut self, line: usize, content: &'t str) -> Result<Vec<&'t str>, HeightMapError> {
        let between = |c: char| c.is_whitespace() || c == ';';
        let parts: Vec<&str> = content.split(between).filter(|w| !w.is_empty()).collect();
        let found = if !content.contains(',') {
            None
        } else if parts.len() > 1 && parts.iter().all(|part| is_decimal(part)) {
            Some(Commas::Decimal)
        } else if parts.len() == 1
            || parts
                .iter()
                .all(|part| !part.trim_matches(',').contains(','))
        {
            Some(Commas::Separators)
        } else {
            return Err(self.ambiguous(line));
        };
        if let Some(found) = found {
            if self.commas != Commas::Unknown && self.commas != found {
                return Err(self.ambiguous(line));
            }
            self.commas = found;
        }
        if found != Some(Commas::Separators) {
            return Ok(parts);
        }
        let numbers = parts.iter().flat_map(|part| part.split(','));
        Ok(numbers.filter(|word| !word.is_empty()).collect())
    }

    fn ambiguous(&self, line: usize) -> HeightMapError {
        HeightMapError::AmbiguousComma {
            file: self.source.file.to_owned(),
            line,
        }
    }

    /// Whether a line names coordinates, `x y z` or `X (um), Y (um), Z (nm)`, whose units are kept.
    fn names_points(&mut self, content: &str) -> bool {
        let separators: [&[char]; 2] = [&[',', ';', '\t'], &[',', ';', '\t', ' ']];
        separators.into_iter().any(|between| {
            let cells = content
                .split(between)
                .map(|cell| cell.trim().trim_matches('"'));
            let cells: Vec<&str> = cells.filter(|cell| !cell.is_empty()).collect();
            let [x, y, z] = cells[..] else { return false };
            let [x, y, z] = [x, y, z].map(split_unit);
            let named = [(&x, "x"), (&y, "y"), (&z, "z")];
            let unit = |unit: &Option<String>| unit.as_deref().map(length_unit);
            let units = [&x.1, &y.1, &z.1].map(unit);
            let is_heading = named
                .iter()
                .all(|((name, _), axis)| name.eq_ignore_ascii_case(axis))
                && units
                    .iter()
                    .all(|unit| unit.is_none_or(|known| known.is_some()))
                && units[0] == units[1];
            if is_heading {
                self.stated.spacing_unit = units[0].flatten().or(self.stated.spacing_unit);
                let height_unit = units[2].flatten().map(HeightUnit::Length);
                self.stated.height_unit = height_unit.or(self.stated.height_unit.take());
            }
            is_heading
        })
    }

    /// Refuses numbers whose marks separate thousands, or may do so.
    fn check_thousands(&self) -> Result<(), HeightMapError> {
        if let (Commas::Decimal, Some(line)) = (self.commas, self.point) {
            return Err(self.ambiguous(line));
        }
        let separator = match self.commas {
            Commas::Separators => ',',
            _ => ';',
        };
        let reading = self.evidence.notation(&self.marks, separator);
        let is_as_read =
            self.evidence.is_decided() || reading.is_ok_and(|it| it.notation == Notation::Single);
        let doubtful = self.marks.iter().find_map(Marks::doubtful);
        match (is_as_read, doubtful) {
            (false, Some(number)) => Err(HeightMapError::Thousands {
                file: self.source.file.to_owned(),
                number,
            }),
            _ => Ok(()),
        }
    }

    /// A height of the text.
    fn height(&mut self, line: usize, column: usize, word: &str) -> Result<f64, HeightMapError> {
        if ["BAD", "bad", "---", "--"].contains(&word) {
            return Ok(f64::NAN);
        }
        let file = || self.source.file.to_owned();
        // A word can only contain a decimal comma here.
        let number = word.replace(',', ".").parse();
        let value: f64 = number.map_err(|_| HeightMapError::NotANumber {
            file: file(),
            line,
            column,
            text: word.to_owned(),
        })?;
        let no_data = self.header.no_data;
        if no_data.is_some_and(|marker| value.total_cmp(&marker).is_eq()) {
            self.first_missing.get_or_insert([line, column]);
            return Ok(f64::NAN);
        }
        Ok(value)
    }

    fn table(self) -> Result<Table, HeightMapError> {
        self.check_thousands()?;
        let Self {
            source,
            header,
            mut stated,
            columns,
            mut values,
            first_missing,
            ..
        } = self;
        let rows = values.len().checked_div(columns).unwrap_or(0);
        let is_numbered = |row: &[f64]| {
            (0..)
                .zip(row)
                .all(|(k, value)| value.to_bits() == f64::from(k).to_bits())
        };
        let mut first_rows = values.chunks_exact(columns.max(1));
        let [first, second] =
            [first_rows.next(), first_rows.next()].map(|row| row.is_some_and(is_numbered));
        if columns >= FEWEST_NUMBERED && first && !second {
            return Err(HeightMapError::NumberedColumns {
                file: source.file.to_owned(),
            });
        }
        let said_columns = header.columns.unwrap_or(columns);
        let said_rows = header.rows.unwrap_or(rows);
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
            stated.spacing = header.cell.map(|cell| [cell; 2]);
            let upside_down = values.rchunks_exact(columns.max(1));
            values = upside_down.flatten().copied().collect();
        } else if columns == 3 && stated.extent == [None; 2] {
            if let Some(mut table) = grid_of_points(&values) {
                table.stated.height_unit = stated.height_unit;
                table.stated.spacing_unit = stated.spacing_unit;
                return Ok(table);
            }
            if rows >= FEWEST_ROWS_OF_A_LIST {
                return Err(HeightMapError::NotAGrid {
                    file: source.file.to_owned(),
                    rows,
                });
            }
        }
        Ok(Table {
            columns,
            rows,
            values,
            stated,
            first_missing,
        })
    }
}

/// Whether a word is a number with a decimal comma or without a fraction.
fn is_decimal(word: &str) -> bool {
    let (whole, fraction) = word.split_once(',').unwrap_or((word, "0"));
    let ends_in_digit = whole.ends_with(|c: char| c.is_ascii_digit());
    let begins_with_digit = fraction.starts_with(|c: char| c.is_ascii_digit());
    ends_in_digit && begins_with_digit && !fraction.contains(',') && !word.contains('.')
}

impl Stated {
    /// Reads a comment before the heights, as Gwyddion writes it: `Width: 10 um`, `Height: 10 um`, `Value units: m`.
    fn take(&mut self, comment: &str) {
        let Some((name, value)) = comment.split_once(':') else {
            return;
        };
        // A micro sign of another encoding is not valid UTF-8.
        let value = value.trim().replace('\u{fffd}', "u").replace(',', ".");
        match name.trim() {
            "Width" => self.extent[0] = parse_quantity(&value, Dimension::Length).ok(),
            "Lateral units" | "XY units" => {
                let unit = parse_quantity(&format!("1 {value}"), Dimension::Length);
                self.spacing_unit = unit.ok();
            }
            "Height" => self.extent[1] = parse_quantity(&value, Dimension::Length).ok(),
            "Value units" => {
                let unit = parse_quantity(&format!("1 {value}"), Dimension::Length);
                let unit = unit.map(HeightUnit::Length);
                self.height_unit = Some(unit.unwrap_or(HeightUnit::Other(value)));
            }
            _ => {}
        }
    }
}

/// Relevant part of the header of an ESRI ASCII grid.
#[derive(Default)]
struct EsriHeader {
    columns: Option<usize>,
    rows: Option<usize>,
    cell: Option<f64>,
    no_data: Option<f64>,
    found: bool,
}

impl EsriHeader {
    /// Reads a line of the header. Returns false if the line is not part of a header.
    fn take(&mut self, words: &[&str]) -> bool {
        let [key, value] = words else {
            return false;
        };
        match key.to_ascii_lowercase().as_str() {
            "ncols" => self.columns = value.parse().ok(),
            "nrows" => self.rows = value.parse().ok(),
            "cellsize" => self.cell = value.replace(',', ".").parse().ok(),
            "nodata_value" => self.no_data = value.replace(',', ".").parse().ok(),
            // The caller sets the position of the map.
            "xllcorner" | "yllcorner" | "xllcenter" | "yllcenter" | "dx" | "dy" => {}
            _ => return false,
        }
        self.found = true;
        true
    }
}

/// Map from a list of points x, y, z, if they are all points of a grid, in any order.
fn grid_of_points(values: &[f64]) -> Option<Table> {
    let count = values.len() / 3;
    if count < FEWEST_POINTS {
        return None;
    }
    let [along_x, along_y] = [0, 1].map(|axis| Levels::of(values.iter().skip(axis).step_by(3)));
    let (along_x, along_y) = (along_x?, along_y?);
    let (columns, rows) = (along_x.count, along_y.count);
    // Points of a long list may be missing, up to half of the grid; three short columns are rather a map.
    let cells = columns.checked_mul(rows)?;
    let is_most = count >= FEWEST_ROWS_OF_A_LIST && cells <= 2 * count;
    if cells != count && !is_most {
        return None;
    }
    let mut heights = vec![None; cells];
    for point in values.chunks_exact(3) {
        let cell = along_y.place(point[1]) * columns + along_x.place(point[0]);
        if heights[cell].replace(point[2]).is_some() {
            return None;
        }
    }
    Some(Table {
        columns,
        rows,
        values: heights
            .into_iter()
            .map(|height| height.unwrap_or(f64::NAN))
            .collect(),
        first_missing: None,
        stated: Stated {
            spacing: Some([along_x.step, along_y.step]),
            is_list: true,
            ..Stated::default()
        },
    })
}

/// Equally spaced coordinates, at least two.
struct Levels {
    first: f64,
    step: f64,
    count: usize,
}

impl Levels {
    /// Finds them for the given coordinates; `None` if these are not equally spaced.
    fn of<'v>(coordinates: impl Iterator<Item = &'v f64>) -> Option<Self> {
        let mut levels: Vec<f64> = coordinates.copied().collect();
        levels.sort_by(f64::total_cmp);
        let (first, last) = (*levels.first()?, *levels.last()?);
        let range = last - first;
        if !(range > 0.0 && range.is_finite()) {
            return None;
        }
        levels.dedup_by(|later, earlier| *later - *earlier <= SAME * range);
        let count = levels.len();
        let step = range / (count - 1) as f64;
        let is_even = (0..).zip(&levels).all(|(place, level): (u32, _)| {
            (level - first - step * f64::from(place)).abs() <= UNEVEN * step
        });
        is_even.then_some(Self { first, step, count })
    }

    fn place(&self, coordinate: f64) -> usize {
        // Levels are equally spaced; therefore this is one of them.
        (((coordinate - self.first) / self.step).round() as usize).min(self.count - 1)
    }
}
