//! Height maps from text: matrices of numbers, ESRI ASCII grids, matrices with the header of Gwyddion and other programs, and lists of points.

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
        header: Header::default(),
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
        program: None,
        blocks: Blocks::default(),
    };
    // Lines of old programs of Macintosh end in a carriage return alone.
    let head = text.fill_buf().map_err(|error| source.unreadable(error))?;
    let has_feeds = head.contains(&b'\n') || !head[..head.len().saturating_sub(1)].contains(&b'\r');
    let end = if has_feeds { b'\n' } else { b'\r' };
    let start = String::from_utf8_lossy(&head[..head.len().min(FIRST_BYTES)]);
    if Program::of(&start).is_none() {
        let mut refused = REFUSED.into_iter();
        if let Some((_, format, advice)) = refused.find(|(part, ..)| start.contains(part)) {
            return Err(HeightMapError::OtherFormat {
                file: source.file.to_owned(),
                format,
                advice,
            });
        }
    }
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
    header: Header,
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
    /// The program whose header is being read.
    program: Option<Program>,
    blocks: Blocks,
}

/// Programs with headers of their own above the numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Program {
    /// Lists of points of Zygo.
    Zygo,
    /// Tables of the microscopes VK and VR of Keyence.
    Keyence,
    /// Text of SPIP, and of Nova of NT-MDT, whose lines do not begin with `#`.
    Spip,
}

impl Program {
    /// The program that wrote a file with this beginning.
    fn of(start: &str) -> Option<Self> {
        let known = [
            ("Zygo XYZ Data File", Self::Zygo),
            ("Measured date", Self::Keyence),
            ("Gemessenes Datum", Self::Keyence),
            ("File Format = ASCII", Self::Spip),
            ("# File Format = ASCII", Self::Spip),
        ];
        let start = start.trim_start_matches(['\u{feff}', '"']);
        let mut known = known.into_iter();
        known.find_map(|(begins, program)| start.starts_with(begins).then_some(program))
    }
}

/// Whether a text begins with the header of a program that writes height maps.
pub(crate) fn is_of_program(start: &str) -> bool {
    Program::of(start).is_some()
}

/// Blocks of rows, which are separated by lines without numbers.
#[derive(Debug, Default)]
struct Blocks {
    /// Whether the line before has no numbers.
    is_between: bool,
    /// Rows of the last block.
    rows: usize,
    /// Rows of the shortest of the others, and the first line of the second block.
    others: Option<(usize, usize)>,
}

impl Blocks {
    /// Takes a row of numbers.
    fn add(&mut self, line: usize) {
        if self.is_between && self.rows > 0 {
            let (shortest, second) = self.others.unwrap_or((self.rows, line));
            self.others = Some((shortest.min(self.rows), second));
            self.rows = 0;
        }
        self.rows += 1;
        self.is_between = false;
    }

    /// First line of the second map, if every block has several rows. Blocks of one row are lines with space between them.
    fn second_map(&self) -> Option<usize> {
        let (shortest, second) = self.others?;
        (shortest > 1 && self.rows > 1).then_some(second)
    }
}

impl Reader<'_> {
    fn line(&mut self, line: usize, text: &str) -> Result<(), HeightMapError> {
        if self.values.is_empty() && self.is_header_of_program(line, text)? {
            return Ok(());
        }
        // Comments of MATLAB and of C.
        let begins = text.trim_start();
        let (content, comment) = match begins.strip_prefix('%').or(begins.strip_prefix("//")) {
            Some(comment) => ("", comment),
            None => split_comment(text),
        };
        if content.trim().is_empty() {
            let is_header = self.take_comment(comment);
            if is_header && !self.values.is_empty() {
                return Err(self.several_maps(line));
            }
        }
        if self.values.is_empty() && content.trim().is_empty() {
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
            self.blocks.is_between = true;
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
        self.blocks.add(line);
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

    /// Whether a line is part of the header of a program, which is read: of Zygo, whose heights are in micrometres and whose points are
    /// counted; of Keyence, up to the title of the heights; of SPIP and Nova, up to `Start of Data :` or a number; or of `WSxM`.
    fn is_header_of_program(&mut self, line: usize, text: &str) -> Result<bool, HeightMapError> {
        /// Line and place of the distance of points, m.
        const RESOLUTION: (usize, usize) = (8, 6);
        if line == 1 {
            self.program = Program::of(text);
        }
        let Some(program) = self.program else {
            return Ok(text.starts_with("WSxM "));
        };
        let is_last;
        match program {
            Program::Zygo => {
                is_last = text.trim() == "#";
                self.stated.height_unit = Some(HeightUnit::Length(1e-6));
                if line == RESOLUTION.0 {
                    let value = text.split_whitespace().nth(RESOLUTION.1);
                    let distance = value.and_then(|value| value.parse().ok());
                    self.stated.spacing_unit = distance.filter(|distance| *distance > 0.0);
                }
            }
            Program::Keyence => {
                let mut separators = SEPARATORS.into_iter();
                let separator = separators.find(|separator| text.contains(*separator));
                let cells = table_text::cells(text, separator.unwrap_or(','));
                let name = cells[0].to_lowercase();
                let value = cells[1..].join(" ");
                let value = value.trim();
                is_last = value.is_empty() && NAMES_OF_Z.contains(&&name[..]);
                match &name[..] {
                    "output image data" | "bilddatenausg."
                        if !NAMES_OF_Z.contains(&&value.to_lowercase()[..]) =>
                    {
                        return Err(self.source.no_map(format!(
                            "line {line}: its data are {value:?}, not heights: export the heights (\"Height\")"
                        )));
                    }
                    "unit" | "einheit" => self.stated.take_unit(value),
                    _ => {
                        self.header.take_named(&mut self.stated, &name, value);
                    }
                }
            }
            Program::Spip => {
                // Lines of a description have any text.
                let between = |c: char| c.is_whitespace() || SEPARATORS.contains(&c);
                let first = text.trim_start().split(between).next();
                if first.is_some_and(|word| single(word).is_some()) {
                    self.program = None;
                    return Ok(false);
                }
                let text = text.trim_start_matches(['#', ' ']);
                is_last = text.starts_with("Start of ");
                let named = text.split_once('=');
                if named.is_some_and(|(name, value)| {
                    name.trim() == "DataScaleNeeded" && value.trim().eq_ignore_ascii_case("yes")
                }) {
                    return Err(self.source.no_map(format!(
                        "line {line}: its numbers are not heights before they are scaled: open it in Gwyddion and save it as text (ASCII data matrix)"
                    )));
                }
                self.take_comment(text);
            }
        }
        if is_last {
            self.program = None;
        }
        Ok(true)
    }

    /// Takes a line of a header, as `Width: 10 um`. Returns false if it is none.
    fn take_comment(&mut self, comment: &str) -> bool {
        let Some((name, value)) = comment.split_once([':', '=', '\u{ff1a}']) else {
            return false;
        };
        let name = name.trim().to_lowercase();
        self.header.take_named(&mut self.stated, &name, value)
    }

    fn several_maps(&self, line: usize) -> HeightMapError {
        HeightMapError::SeveralMaps {
            file: self.source.file.to_owned(),
            line,
        }
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
        if self.header.counts[0] != Some(self.columns) {
            self.without_empty_columns();
        }
        let second_map = self.blocks.second_map().map(|line| self.several_maps(line));
        let Self {
            source,
            header,
            mut stated,
            mut columns,
            mut values,
            first_missing,
            list,
            ..
        } = self;
        let file = || source.file.to_owned();
        let mut rows = values.len().checked_div(columns).unwrap_or(0);
        let [said_columns, said_rows] = header.counts;
        let said_columns = said_columns.unwrap_or(columns);
        let said_rows = said_rows.unwrap_or(rows);
        // All numbers in one line, or one in each.
        if (columns == 1 || rows == 1) && said_columns.checked_mul(said_rows) == Some(values.len())
        {
            (columns, rows) = (said_columns, said_rows);
        }
        if rows > 0 && said_columns == columns && said_rows.checked_mul(2) == Some(rows) {
            return Err(source.no_map(format!(
                "below its {said_rows} rows it has as many again, as SPIP writes the mask of points that were not measured: open it in Gwyddion and save \
                 it as text (ASCII data matrix), or replace the heights of these points by NaN and remove the mask"
            )));
        }
        if (said_columns, said_rows) != (columns, rows) {
            return Err(HeightMapError::HeaderSize {
                file: file(),
                columns: said_columns,
                rows: said_rows,
                found_columns: columns,
                found_rows: rows,
            });
        }
        for (axis, count) in [columns, rows].into_iter().enumerate() {
            let extent = header.extent(axis, count);
            stated.extent[axis] = stated.extent[axis].or(extent);
        }
        if header.is_esri {
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
            if let (Some(error), None) = (second_map, header.counts[1]) {
                return Err(error);
            }
            if columns == 1 && rows > 1 && !is_sized {
                return Err(source.no_map(format!(
                    "it is one column of {rows} numbers, and the number of columns of the map is not stated: reshape it to rows and columns, \
                     as by numpy.savetxt(\"map.txt\", heights.reshape(rows, columns))"
                )));
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

/// Names of the unit of the heights: of Gwyddion in its languages, of SPIP and Attocube, and of Nova.
const VALUE_UNITS: [&str; 10] = [
    "value units",
    "werteinheiten",
    "werteinheit",
    "einheiten",
    "unit\u{e9}s",
    "unidades de valor",
    "unit\u{e0} valore",
    "jednotky hodnot",
    "z-unit",
    "unit data",
];

/// Names of what a map contains, with which headers of Gwyddion begin.
const CHANNELS: [&str; 5] = ["channel", "kanal", "kan\u{e1}l", "canal", "canale"];

/// Number of bytes in which parts of headers are searched.
const FIRST_BYTES: usize = 512;

/// Texts with headers that are not read: a part of their first lines, what they are, and what to do.
const REFUSED: [(&str, &str, &str); 2] = [
    (
        "\"\\*File list",
        "a text of NanoScope with its header",
        "open the file of the microscope in Gwyddion and save it as text (ASCII data matrix)",
    ),
    (
        "ImageDataCsv",
        "a table of Keyence whose header is neither English nor German",
        "export it in English; or remove the lines above the numbers, and give the case surface.cell_size (the XY calibration of the header) and \
         surface.height_unit (its unit)",
    ),
];

impl Stated {
    /// Takes the unit of the heights, as `nm` or `[nm]`.
    fn take_unit(&mut self, unit: &str) {
        let unit = unit.trim_matches(['[', ']', '(', ')']).trim();
        let length = length_of(&format!("1 {unit}")).map(HeightUnit::Length);
        self.height_unit = Some(length.unwrap_or(HeightUnit::Other(unit.to_owned())));
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

/// A length with its unit, m.
fn length_of(text: &str) -> Option<f64> {
    parse_quantity(text, Dimension::Length).ok()
}

/// Numbers of a header that have a meaning together with others, and the relevant part of the header of an ESRI ASCII grid.
#[derive(Default)]
struct Header {
    /// Columns and rows.
    counts: [Option<usize>; 2],
    /// Extents along x and y without a unit.
    lengths: [Option<f64>; 2],
    /// Sides of a cell along x and y.
    cell: [Option<f64>; 2],
    /// Units of lengths along x and y, m; not a number for another dimension.
    units: [Option<f64>; 2],
    no_data: Option<f64>,
    /// Whether it is an ESRI ASCII grid.
    is_esri: bool,
}

impl Header {
    /// Reads a line of a header with its name in lower case, as Gwyddion writes it in several languages: `Width: 10 um`, `Height: 10 um`,
    /// `Value units: m`; as SPIP does, with lengths in nm: `x-length = 16000`; as Attocube does, with their unit: `x-unit: um`; as Nova does, with
    /// cells: `Scale X = 0.5`, `Unit X = um`; and as Keyence does: `XY Calibration` of `277.462 nm`. Returns false if it is none of these.
    fn take_named(&mut self, stated: &mut Stated, name: &str, value: &str) -> bool {
        let value = value.trim().replace(',', ".");
        let bare = || number(&value, Notation::Single)?.parse::<f64>().ok();
        let is = |names: &[&str]| names.contains(&name);
        let axis = |names: [&str; 2]| names.iter().position(|known| *known == name);
        if is(&WIDTHS) || is(&HEIGHTS) {
            let extent = length_of(&value);
            stated.extent[usize::from(is(&HEIGHTS))] = extent;
            return extent.is_some();
        }
        if let Some(axis) = axis(["x-length", "y-length"]) {
            self.lengths[axis] = bare();
            stated.extent[axis] = length_of(&value);
        } else if let Some(axis) = axis(["x-unit", "y-unit"]).or(axis(["unit x", "unit y"])) {
            self.units[axis] = Some(length_of(&format!("1 {value}")).unwrap_or(f64::NAN));
        } else if let Some(axis) = axis(["x-pixels", "y-pixels"])
            .or(axis(["nx", "ny"]))
            .or(axis(["horizontal", "vertical"]))
            .or(axis(["horizont.", "vertikal"]))
        {
            self.counts[axis] = value.parse().ok();
        } else if let Some(axis) = axis(["scale x", "scale y"]) {
            self.cell[axis] = bare();
        } else if is(&["xy calibration", "xy-justierung"]) {
            self.cell = [length_of(&value); 2];
            self.units = [Some(1.0); 2];
        } else if is(&["bit2nm"]) {
            let unit = bare().map(|unit| HeightUnit::Length(1e-9 * unit));
            stated.height_unit = stated.height_unit.take().or(unit);
        } else if is(&["lateral units", "xy units"]) {
            stated.spacing_unit = length_of(&format!("1 {value}"));
        } else if is(&VALUE_UNITS) {
            stated.take_unit(&value);
        } else {
            return is(&CHANNELS);
        }
        true
    }

    /// Extent along an axis with so many points, m, if its unit is known. Lengths of SPIP without a unit are in nm.
    fn extent(&self, axis: usize, count: usize) -> Option<f64> {
        const NANOMETRE: f64 = 1e-9;
        let unit = self.units[axis].or(self.units[0]);
        let cell = self.cell[axis].filter(|_| !self.is_esri);
        let of_cells = || Some(unit? * cell? * count as f64);
        let length = self.lengths[axis].map(|length| unit.unwrap_or(NANOMETRE) * length);
        let extent = length.or_else(of_cells)?.abs();
        (extent > 0.0 && extent.is_finite()).then_some(extent)
    }

    /// The number of a missing point; the format defines one for headers that do not state it.
    fn no_data(&self) -> Option<f64> {
        const USUAL: f64 = -9999.0;
        self.no_data.or(self.is_esri.then_some(USUAL))
    }

    /// Reads a line of the header of an ESRI ASCII grid. Returns false if the line is not part of one.
    fn take(&mut self, words: &[&str]) -> bool {
        let [key, value] = words else {
            return false;
        };
        let number = || single(value);
        match key.to_ascii_lowercase().as_str() {
            "ncols" => self.counts[0] = value.parse().ok(),
            "nrows" => self.counts[1] = value.parse().ok(),
            "cellsize" => self.cell = [number(); 2],
            "dx" => self.cell[0] = number(),
            "dy" => self.cell[1] = number(),
            "nodata_value" => self.no_data = number(),
            // The caller sets the position of the map.
            "xllcorner" | "yllcorner" | "xllcenter" | "yllcenter" => {}
            _ => return false,
        }
        self.is_esri = true;
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
