//! Height maps from text: matrices of numbers, ESRI ASCII grids, matrices with the heading of Gwyddion, and lists of points.

use crate::headings::{length_unit, split_unit};
use crate::height_table::{HeightMapError, HeightUnit, LONGEST_LINE, Source, Stated, Table};
use crate::notation::{Evidence, Marks, Notation, is_not_measured, number, single};
use crate::table_text::{self, SEPARATORS, narrow_text, split_comment};
use crate::unit::{Dimension, parse_quantity};
use std::borrow::Cow;
use std::io::{BufRead, Read};

/// Smallest number of points of a list that is interpreted as a grid: two by three.
const FEWEST_POINTS: usize = 6;

/// Number of rows of three numbers beyond which they are not a map with three columns.
const FEWEST_ROWS_OF_A_LIST: usize = 100;

/// Number of columns or rows from which 0, 1, 2 and so on number them: in small maps they may be heights.
const FEWEST_NUMBERED: usize = 8;

/// Number of columns and rows from which an evenly spaced first row and first column are coordinates.
const FEWEST_COORDINATES: usize = 6;

/// Largest number of columns of a list of points, with further values of each.
const MOST_COLUMNS_OF_A_LIST: usize = 8;

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
        has_outer: [false; 2],
        values: Vec::new(),
        first_missing: None,
        list: None,
        has_quoted_commas: false,
        is_zygo_header: false,
    };
    // Lines of old programs of Macintosh end in a carriage return alone.
    let head = text.fill_buf().map_err(|error| source.unreadable(error))?;
    let has_feeds = head.contains(&b'\n') || !head[..head.len().saturating_sub(1)].contains(&b'\r');
    let end = if has_feeds { b'\n' } else { b'\r' };
    let mut bytes = Vec::new();
    for line in 1.. {
        bytes.clear();
        let read = text.by_ref().take(LONGEST_LINE).read_until(end, &mut bytes);
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
        reader.line(line, &narrow_text(&bytes))?;
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

/// The line that names the columns of a list of points.
struct Heading {
    /// Number of columns that it names.
    columns: usize,
    /// Those of x, y and z.
    places: [usize; 3],
    /// Whether it is a comment, which may also be a sentence with these letters.
    is_comment: bool,
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
    /// Whether the first and the last column have a text in any row.
    has_outer: [bool; 2],
    values: Vec<f64>,
    first_missing: Option<[usize; 2]>,
    /// Heading of a list of points.
    list: Option<Heading>,
    /// Whether numbers in quotes have commas, which may separate thousands.
    has_quoted_commas: bool,
    /// Whether the lines are the header of a list of points of Zygo.
    is_zygo_header: bool,
}

impl Reader<'_> {
    fn line(&mut self, line: usize, text: &str) -> Result<(), HeightMapError> {
        if self.values.is_empty() && self.is_header_of_program(line, text) {
            return Ok(());
        }
        // Comments of MATLAB and of C.
        let begins = text.trim_start();
        let (content, comment) = match begins.strip_prefix('%').or(begins.strip_prefix("//")) {
            Some(comment) => ("", comment),
            None => split_comment(text),
        };
        if self.values.is_empty() && content.trim().is_empty() {
            self.stated.take(comment);
            self.names_points(comment, true);
        }
        if self.values.is_empty()
            && (self.names_points(content, false) || self.stated.title(content))
        {
            return Ok(());
        }
        let content = simplified(content);
        self.has_quoted_commas |=
            text.contains('"') && !text.contains(['\t', ';']) && content.contains(',');
        let mut words = self.words(line, &content)?;
        let is_first = self.values.is_empty();
        if words.len() == self.columns + 1 && !is_first && words[self.columns].is_empty() {
            words.pop();
        }
        let is_blank = words.iter().all(|word| word.is_empty())
            && match is_first {
                true => content.trim().is_empty(),
                false => words.len() != self.columns,
            };
        if is_blank || is_first && self.header.take(&words) {
            return Ok(());
        }
        if is_first {
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
        for (has_text, place) in self.has_outer.iter_mut().zip([0, self.columns - 1]) {
            *has_text |= !words[place].is_empty();
        }
        // Numbers of old libraries of C that are none have a point too: `1.#QNAN`.
        let numbers = (0..).zip(&words);
        let numbers = numbers.filter(|(_, word)| !word.contains('#'));
        if self.point.is_none() && numbers.clone().any(|(_, word)| word.contains('.')) {
            self.point = Some(line);
        }
        if !self.evidence.is_decided() {
            for (column, word) in numbers {
                self.evidence.add(word);
                let of_list: usize = if self.columns == 3 { column } else { 0 };
                self.marks[of_list].add(line as u64, word);
            }
        }
        for (column, word) in (1..).zip(words) {
            let height = self.height(line, column, word)?;
            self.values.push(height);
        }
        Ok(())
    }

    /// Whether a line is part of the header of a program above a list of points: of Zygo, whose heights are in micrometres and whose points are
    /// counted, or of `WSxM`.
    fn is_header_of_program(&mut self, line: usize, text: &str) -> bool {
        /// Line and place of the distance of points, m.
        const RESOLUTION: (usize, usize) = (8, 6);
        if line == 1 && text.starts_with("Zygo XYZ Data File") {
            self.is_zygo_header = true;
            self.stated.height_unit = Some(HeightUnit::Length(1e-6));
        }
        if !self.is_zygo_header {
            return text.starts_with("WSxM ");
        }
        self.is_zygo_header = text.trim() != "#";
        if line == RESOLUTION.0 {
            let value = text.split_whitespace().nth(RESOLUTION.1);
            let distance = value.and_then(|value| value.parse().ok());
            self.stated.spacing_unit = distance.filter(|distance| *distance > 0.0);
        }
        true
    }

    /// Numbers of a line. They are separated by commas, unless blanks or semicolons separate them and a comma is inside a number; all
    /// commas of a text have the same meaning. Between separators other than blanks, nothing is a missing number.
    fn words<'t>(&mut self, line: usize, content: &'t str) -> Result<Vec<&'t str>, HeightMapError> {
        let split = |separator: char| {
            let cells: Vec<&str> = content.split(separator).map(str::trim).collect();
            let is_row = content.contains(separator) && cells.iter().all(|cell| is_cell(cell));
            is_row.then_some(cells)
        };
        if let Some(cells) = split(';').or_else(|| split('\t')) {
            if content.contains(',') {
                self.take_commas(line, Commas::Decimal)?;
            }
            return Ok(cells);
        }
        let between = |c: char| c.is_whitespace() || c == ';';
        let parts: Vec<&str> = content.split(between).filter(|w| !w.is_empty()).collect();
        if !content.contains(',') {
            return Ok(parts);
        }
        let is_decimal = |part: &&str| is_decimal(part) || is_not_measured(part);
        if parts.len() > 1 && parts.iter().all(is_decimal) {
            self.take_commas(line, Commas::Decimal)?;
            return Ok(parts);
        }
        let has_none_inside = |part: &&str| !part.trim_matches(',').contains(',');
        if parts.len() > 1 && !parts.iter().all(has_none_inside) {
            return Err(self.ambiguous(line));
        }
        self.take_commas(line, Commas::Separators)?;
        let numbers = || parts.iter().flat_map(|part| part.split(','));
        Ok(split(',').unwrap_or_else(|| numbers().filter(|word| !word.is_empty()).collect()))
    }

    /// Takes the meaning of the commas of a line, which must be that of the lines before.
    fn take_commas(&mut self, line: usize, found: Commas) -> Result<(), HeightMapError> {
        if self.commas != Commas::Unknown && self.commas != found {
            return Err(self.ambiguous(line));
        }
        self.commas = found;
        Ok(())
    }

    fn ambiguous(&self, line: usize) -> HeightMapError {
        HeightMapError::AmbiguousComma {
            file: self.source.file.to_owned(),
            line,
        }
    }

    /// Whether a line names coordinates in any order, `x y z` or `X (um), Y (um), Height (nm)`, whose places and units are kept.
    fn names_points(&mut self, content: &str, is_comment: bool) -> bool {
        let separators: [&[char]; 2] = [&SEPARATORS, &[',', ';', '\t', ' ']];
        separators.into_iter().any(|between| {
            let cells = content
                .split(between)
                .map(|cell| cell.trim().trim_matches('"'));
            let cells: Vec<(String, Option<String>)> = cells
                .filter(|cell| !cell.is_empty())
                .map(split_unit)
                .map(|(name, unit)| (name.to_lowercase(), unit))
                .collect();
            let find = |names: &[&str]| {
                let mut named = cells.iter().enumerate();
                let (place, (_, unit)) = named.find(|(_, cell)| names.contains(&&cell.0[..]))?;
                let unit = unit.as_deref().map(length_unit);
                // A unit of another dimension.
                (unit != Some(None)).then_some((place, unit.flatten()))
            };
            let (Some(x), Some(y), Some(z)) = (find(&["x"]), find(&["y"]), find(&NAMES_OF_Z))
            else {
                return false;
            };
            let is_heading = x.1 == y.1 && cells.len() <= MOST_COLUMNS_OF_A_LIST;
            if is_heading {
                self.list = Some(Heading {
                    columns: cells.len(),
                    places: [x.0, y.0, z.0],
                    is_comment,
                });
                self.stated.spacing_unit = x.1.or(self.stated.spacing_unit);
                let height_unit = z.1.map(HeightUnit::Length);
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
            Commas::Decimal if !self.has_quoted_commas => ';',
            Commas::Unknown => ';',
            _ => ',',
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
        let Some(value) = single(word) else {
            if is_not_measured(word) {
                return Ok(f64::NAN);
            }
            return Err(HeightMapError::NotANumber {
                file: self.source.file.to_owned(),
                line,
                column,
                text: word.to_owned(),
            });
        };
        let no_data = self.header.no_data();
        if no_data.is_some_and(|marker| value.total_cmp(&marker).is_eq()) {
            self.first_missing.get_or_insert([line, column]);
            return Ok(f64::NAN);
        }
        Ok(value)
    }

    /// Leaves out a first or a last column without any text: separators at the ends of the rows.
    fn without_empty_columns(&mut self) {
        let columns = self.columns;
        let [has_first, has_last] = self.has_outer;
        if columns < 2 || has_first && has_last {
            return;
        }
        let kept = usize::from(!has_first)..columns - usize::from(!has_last);
        let rows = self.values.chunks_exact(columns);
        self.values = rows.flat_map(|row| row[kept.clone()].to_vec()).collect();
        self.columns = kept.len();
    }

    fn table(mut self) -> Result<Table, HeightMapError> {
        self.check_thousands()?;
        if !self.header.found {
            self.without_empty_columns();
        }
        let Self {
            source,
            header,
            mut stated,
            columns,
            mut values,
            first_missing,
            list,
            ..
        } = self;
        let file = || source.file.to_owned();
        let rows = values.len().checked_div(columns).unwrap_or(0);
        let said_columns = header.columns.unwrap_or(columns);
        let said_rows = header.rows.unwrap_or(rows);
        if (said_columns, said_rows) != (columns, rows) {
            return Err(HeightMapError::HeaderSize {
                file: file(),
                columns: said_columns,
                rows: said_rows,
                found_columns: columns,
                found_rows: rows,
            });
        }
        if header.found {
            let [along_x, along_y] = header.cell;
            stated.spacing = along_x
                .or(along_y)
                .map(|side| [along_x.unwrap_or(side), along_y.unwrap_or(side)]);
            let upside_down = values.rchunks_exact(columns.max(1));
            values = upside_down.flatten().copied().collect();
        } else {
            let is_sized = stated.extent != [None; 2];
            let fitting = list.as_ref().filter(|heading| heading.columns == columns);
            if let (Some(heading), None) = (&list, fitting)
                && !heading.is_comment
            {
                return Err(source.no_map(format!(
                    "its headings name {} columns, and its rows have {columns}",
                    heading.columns
                )));
            }
            let places = fitting.map(|heading| heading.places);
            let is_list = columns == 3 && !is_sized || places.is_some();
            let is_wide = !is_sized && (4..=MOST_COLUMNS_OF_A_LIST).contains(&columns);
            let grid = (is_list || is_wide)
                .then(|| grid_of_points(&values, columns, places.unwrap_or([0, 1, 2])))
                .flatten();
            if let Some(mut table) = grid {
                if !is_list {
                    return Err(source.no_map(format!(
                        "it is a list of points x, y, z with {columns} columns: name them in a first line, as \"x y z intensity\", or keep three of them"
                    )));
                }
                table.stated.height_unit = stated.height_unit;
                table.stated.spacing_unit = stated.spacing_unit;
                return Ok(table);
            }
            if is_list && (places.is_some() || rows >= FEWEST_ROWS_OF_A_LIST) {
                return Err(HeightMapError::NotAGrid { file: file(), rows });
            }
            check_axes(source, &values, columns, is_sized)?;
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

/// Refuses a matrix that has coordinates or numbers in its first row or column, and a profile of a line.
fn check_axes(
    source: &Source<'_>,
    values: &[f64],
    columns: usize,
    is_sized: bool,
) -> Result<(), HeightMapError> {
    if columns == 0 {
        return Ok(());
    }
    let rows = values.len() / columns;
    let wrong = |problem: &str| Err(source.no_map(problem.to_owned()));
    let row = |row: usize| values.iter().skip(row * columns).take(columns).copied();
    let column = |column: usize| values.iter().skip(column).step_by(columns).copied();
    let increases = |sign: f64| {
        let pairs = column(0).zip(column(0).skip(1));
        pairs.clone().all(|(one, next)| sign * next > sign * one)
    };
    let is_long = rows >= FEWEST_NUMBERED;
    if columns == 2 && is_long && !is_sized && (increases(1.0) || increases(-1.0)) {
        return wrong(
            "it is a profile of a line, not a map: give a matrix of heights, or a list of points x, y, z",
        );
    }
    if rows.min(columns) >= FEWEST_COORDINATES {
        let [first_row, second_row] = [0, 1].map(|k| is_even(row(k).skip(1)));
        let [first_column, second_column] = [0, 1].map(|k| is_even(column(k).skip(1)));
        if first_row && !second_row && first_column && !second_column {
            return wrong(
                "its first row and its first column are coordinates or numbers, not heights: remove them (pandas leaves them out with \
                 header=False, index=False)",
            );
        }
    }
    if columns >= FEWEST_NUMBERED && is_numbered(row(0)) && !is_numbered(row(1)) {
        return Err(HeightMapError::NumberedColumns {
            file: source.file.to_owned(),
        });
    }
    if is_long && columns > 1 && is_numbered(column(0)) && !is_numbered(column(1)) {
        return wrong(
            "its first column is 0, 1, 2 and so on, which are numbers of rows, not heights: remove it (pandas leaves it out with index=False)",
        );
    }
    Ok(())
}

/// Whether values are 0, 1, 2 and so on, or 1, 2, 3 and so on.
fn is_numbered(mut values: impl Iterator<Item = f64>) -> bool {
    let first = values.next().filter(|first| [0.0, 1.0].contains(first));
    first.is_some_and(|first| {
        (1..)
            .zip(values)
            .all(|(k, value)| value.total_cmp(&(first + f64::from(k))).is_eq())
    })
}

/// Whether values are equally spaced, as rounded coordinates.
fn is_even(mut values: impl Iterator<Item = f64>) -> bool {
    /// Largest difference of two steps, over a step.
    const ROUNDED: f64 = 0.01;
    let (Some(first), Some(second)) = (values.next(), values.next()) else {
        return false;
    };
    let step = second - first;
    let mut last = second;
    step != 0.0
        && values.all(|value| {
            let is_same = (value - last - step).abs() <= ROUNDED * step.abs();
            last = value;
            is_same
        })
}

/// A line without blanks within a missing number of Zygo, and with separators in place of the quotes around its cells.
fn simplified(line: &str) -> Cow<'_, str> {
    const NO_DATA: &str = "No Data";
    if line.contains(NO_DATA) {
        return Cow::Owned(line.replace(NO_DATA, "NaN"));
    }
    if !line.contains('"') {
        return Cow::Borrowed(line);
    }
    let separators = SEPARATORS.into_iter();
    let separator = separators
        .clone()
        .find(|separator| line.contains(*separator));
    let cells = table_text::cells(line, separator.unwrap_or(' '));
    // Decimal commas within quotes.
    let has_commas = cells.iter().any(|cell| cell.contains(','));
    let between = separator.filter(|separator| !(has_commas && *separator == ','));
    Cow::Owned(cells.join(&between.unwrap_or('\t').to_string()))
}

/// Whether a cell between separators is a number, or a missing one.
fn is_cell(cell: &str) -> bool {
    single(cell).is_some() || is_not_measured(cell)
}

/// Whether a word is a number with a decimal comma or without a fraction.
fn is_decimal(word: &str) -> bool {
    let (whole, fraction) = word.split_once(',').unwrap_or((word, "0"));
    let ends_in_digit = whole.ends_with(|c: char| c.is_ascii_digit());
    let begins_with_digit = fraction.starts_with(|c: char| c.is_ascii_digit());
    ends_in_digit && begins_with_digit && !fraction.contains(',') && !word.contains('.')
}

/// Names of heights in the headings of lists of points, in lower case.
const NAMES_OF_Z: [&str; 4] = ["z", "height", "h\u{f6}he", "hauteur"];

/// Names of the extent along x in the languages of Gwyddion, in lower case.
const WIDTHS: [&str; 7] = [
    "width",
    "breite",
    "largeur",
    "anchura",
    "ancho",
    "larghezza",
    "\u{161}\u{ed}\u{159}ka",
];

/// Names of the extent along y.
const HEIGHTS: [&str; 7] = [
    "height",
    "h\u{f6}he",
    "hauteur",
    "altura",
    "alto",
    "altezza",
    "v\u{fd}\u{161}ka",
];

/// Names of the unit of the heights.
const VALUE_UNITS: [&str; 4] = ["value units", "werteinheiten", "werteinheit", "unit\u{e9}s"];

impl Stated {
    /// Reads a comment before the heights, as Gwyddion writes it in several languages: `Width: 10 um`, `Height: 10 um`, `Value units: m`; and as
    /// SPIP does, with lengths in nm: `x-length = 16000`.
    fn take(&mut self, comment: &str) {
        let Some((name, value)) = comment.split_once([':', '=']) else {
            return;
        };
        let value = value.trim().replace(',', ".");
        let length = |text: &str| parse_quantity(text, Dimension::Length).ok();
        let nanometres = || {
            let number = number(&value, Notation::Single)?;
            length(&format!("{number} nm"))
        };
        let name = name.trim().to_lowercase();
        let is = |names: &[&str]| names.contains(&&name[..]);
        if is(&WIDTHS) {
            self.extent[0] = length(&value);
        } else if is(&HEIGHTS) {
            self.extent[1] = length(&value);
        } else if is(&["x-length"]) {
            self.extent[0] = nanometres().or_else(|| length(&value));
        } else if is(&["y-length"]) {
            self.extent[1] = nanometres().or_else(|| length(&value));
        } else if is(&["bit2nm"]) {
            self.height_unit = nanometres().map(HeightUnit::Length);
        } else if is(&["lateral units", "xy units"]) {
            self.spacing_unit = length(&format!("1 {value}"));
        } else if is(&VALUE_UNITS) {
            let unit = length(&format!("1 {value}")).map(HeightUnit::Length);
            self.height_unit = Some(unit.unwrap_or(HeightUnit::Other(value)));
        }
    }

    /// Whether a line is a title of the heights with their unit, which is kept: `Height(nm)`.
    fn title(&mut self, line: &str) -> bool {
        let (name, unit) = split_unit(line.trim().trim_matches('"'));
        let name = name.to_lowercase();
        let is_title = NAMES_OF_Z
            .iter()
            .any(|known| name == *known || known.len() > 1 && name.starts_with(known));
        let unit = unit.as_deref().filter(|_| is_title).and_then(length_unit);
        if let Some(unit) = unit {
            self.height_unit = Some(HeightUnit::Length(unit));
        }
        unit.is_some()
    }
}

/// Relevant part of the header of an ESRI ASCII grid.
#[derive(Default)]
struct EsriHeader {
    columns: Option<usize>,
    rows: Option<usize>,
    /// Sides of a cell along x and y.
    cell: [Option<f64>; 2],
    no_data: Option<f64>,
    found: bool,
}

impl EsriHeader {
    /// The number of a missing point; the format defines one for headers that do not state it.
    fn no_data(&self) -> Option<f64> {
        const USUAL: f64 = -9999.0;
        self.no_data.or(self.found.then_some(USUAL))
    }

    /// Reads a line of the header. Returns false if the line is not part of a header.
    fn take(&mut self, words: &[&str]) -> bool {
        let [key, value] = words else {
            return false;
        };
        let number = || single(value);
        match key.to_ascii_lowercase().as_str() {
            "ncols" => self.columns = value.parse().ok(),
            "nrows" => self.rows = value.parse().ok(),
            "cellsize" => self.cell = [number(); 2],
            "dx" => self.cell[0] = number(),
            "dy" => self.cell[1] = number(),
            "nodata_value" => self.no_data = number(),
            // The caller sets the position of the map.
            "xllcorner" | "yllcorner" | "xllcenter" | "yllcenter" => {}
            _ => return false,
        }
        self.found = true;
        true
    }
}

/// Map from a list of points, if they are all points of a grid, in any order: rows of so many columns, with x, y and z in the given ones.
pub(crate) fn grid_of_points(
    values: &[f64],
    columns: usize,
    [x, y, z]: [usize; 3],
) -> Option<Table> {
    let count = values.len().checked_div(columns)?;
    if count < FEWEST_POINTS {
        return None;
    }
    let along = |axis: usize| Levels::of(values.iter().skip(axis).step_by(columns));
    let (along_x, along_y) = (along(x)?, along(y)?);
    let [row_count, column_count] = [along_y.count, along_x.count];
    // Points of a long list may be missing, up to half of the grid; three short columns are rather a map.
    let cells = column_count.checked_mul(row_count)?;
    let is_most = count >= FEWEST_ROWS_OF_A_LIST && cells <= 2 * count;
    if cells != count && !is_most {
        return None;
    }
    let mut heights = vec![None; cells];
    for point in values.chunks_exact(columns) {
        let cell = along_y.place(point[y]) * column_count + along_x.place(point[x]);
        if heights[cell].replace(point[z]).is_some() {
            return None;
        }
    }
    Some(Table {
        columns: column_count,
        rows: row_count,
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
