//! Tables of lengths under a line with the names of their columns, in the formats of spreadsheets and of ImageJ.

use crate::notation::{Doubt, Evidence, Marks, Notation, is_number, number};
use crate::table_text::{cells, is_statistic, read_table, text_of};
use crate::unit::{Dimension, parse_quantity, symbol_of};
use std::f64::consts::PI;
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
    /// Names, which end in `_m`.
    pub(crate) names: [&'static str; N],
    /// Number of required columns, from the first.
    pub(crate) required: usize,
    /// Description in messages: `"a table of pillars has ..."`.
    pub(crate) accepted: &'static str,
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

/// Headings of columns that are not used: numbers and names of the rows, and other measurements of ImageJ.
const IGNORED: [&str; 44] = [
    "",
    "id",
    "no",
    "nr",
    "number",
    "index",
    "label",
    "name",
    "pillar",
    "mean",
    "min",
    "max",
    "stddev",
    "std dev",
    "mode",
    "median",
    "intden",
    "rawintden",
    "perim",
    "circ",
    "feret",
    "feretx",
    "ferety",
    "feretangle",
    "minferet",
    "ar",
    "round",
    "solidity",
    "major",
    "minor",
    "angle",
    "slice",
    "frame",
    "ch",
    "bx",
    "by",
    "xm",
    "ym",
    "skew",
    "kurt",
    "xstart",
    "ystart",
    "type",
    "group",
];

/// Difference of a diameter and twice a radius, over this, from which they contradict each other: both may be rounded.
const CONTRADICTION: f64 = 0.02;

/// Columns of a table, and that of a radius beside the diameter, with the column of the diameter.
type Places<const N: usize> = ([Option<Place>; N], Option<(usize, Place)>);

/// Quantity in a cell, from which the length of the column is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Form {
    /// The length.
    Length,
    /// Half of it: the radius of a diameter.
    Half,
    /// The area of a circle of this diameter.
    Area,
}

/// Interpretation of a heading.
#[derive(Debug, Clone, PartialEq)]
struct Meaning {
    column: usize,
    form: Form,
    unit: Option<String>,
}

/// Place of a column, and the interpretation of its cells.
#[derive(Debug, Clone)]
struct Place {
    place: usize,
    form: Form,
    unit: String,
}

impl<const N: usize> Columns<N> {
    /// Reads a file: values under a line with the names of the columns and their units, in any order, separated by commas, semicolons, tabs or
    /// blanks; text, `.gz` or `.xlsx`. Lines that begin with `#` are left out, unless they contain the names. `unit` is that of columns without one. A
    /// missing column, and an empty cell of a column that is not required, have the value of `otherwise`.
    pub(crate) fn read(
        &self,
        path: &Path,
        unit: Option<&str>,
        otherwise: [f64; N],
    ) -> Result<Table<N>, TableError> {
        let name = path.display().to_string();
        let bytes = read_table(path, LARGEST).map_err(|error| TableError::Unreadable {
            path: name.clone(),
            error,
        })?;
        self.parse(&name, &bytes, unit, otherwise)
    }

    /// [`read`](Self::read) from the contents of a file; `name` is its name in errors.
    pub(crate) fn parse(
        &self,
        name: &str,
        bytes: &[u8],
        unit: Option<&str>,
        otherwise: [f64; N],
    ) -> Result<Table<N>, TableError> {
        let wrong = |line: usize, problem: String| TableError::Line {
            path: name.to_owned(),
            line: line as u64 + 1,
            problem,
        };
        let text = text_of(bytes)
            .ok_or_else(|| wrong(0, format!("the file is no text; {}", self.accepted)))?;
        let lines: Vec<&str> = text.lines().collect();
        let (heading_line, separator, headings) = self.heading(&lines);
        let below = lines.iter().enumerate().skip(heading_line + 1);
        let mut rows_below = below.filter(|(_, line)| is_row(line)).peekable();
        let units = rows_below
            .peek()
            .map_or(Vec::new(), |(_, line)| cells(line, separator));
        let is_unit = |text: &String| length_unit(without_brackets(text)).is_some();
        let has_units = units.iter().any(is_unit) && !units.iter().any(|cell| is_number(cell));
        if has_units {
            rows_below.next();
        }
        let units = if has_units { &units[..] } else { &[] };
        let (places, radius) = self
            .places(&headings, units, unit)
            .map_err(|problem| wrong(heading_line, problem))?;
        let numbers = rows_below.clone();
        let numbers = numbers.map(|(index, line)| (index, cells(line, separator)));
        let notation = notation(&places, numbers, separator)
            .map_err(|(line, problem)| wrong(line, problem))?;
        let (mut rows, mut row_lines) = (Vec::new(), Vec::new());
        for (index, line) in rows_below {
            let mut row = cells(line, separator);
            while row.len() > headings.len() && row.last().is_some_and(String::is_empty) {
                row.pop();
            }
            if row.len() != headings.len() {
                let problem = format!(
                    "{} cells, but {} in the line of the names",
                    row.len(),
                    headings.len()
                );
                return Err(wrong(index, problem));
            }
            // ImageJ writes the mean and others of all particles below them.
            let is_used = |place: usize| places.iter().flatten().any(|used| used.place == place);
            let label = row
                .iter()
                .enumerate()
                .find(|(place, cell)| !is_used(*place) && is_statistic(cell));
            if let Some((_, label)) = label {
                let problem =
                    format!("\"{label}\" labels a statistic of the other rows: remove this row");
                return Err(wrong(index, problem));
            }
            let mut values = otherwise;
            for (column, place) in places.iter().enumerate() {
                let Some(place) = place else { continue };
                let text = &row[place.place];
                if text.is_empty() && column >= self.required {
                    continue;
                }
                values[column] = place.value(text, notation).ok_or_else(|| {
                    let unit = match &place.unit[..] {
                        "m" => "of metres".to_owned(),
                        unit => format!("in {unit}"),
                    };
                    let name = self.names[column];
                    wrong(
                        index,
                        format!("{name} is \"{text}\", and has to be a number {unit}"),
                    )
                })?;
            }
            if let Some((column, radius)) = &radius
                && let Some(twice) = radius.value(&row[radius.place], notation)
                && (values[*column] - twice).abs() > CONTRADICTION * twice
            {
                let problem = "radius and diameter contradict each other: leave one of them out";
                return Err(wrong(index, problem.to_owned()));
            }
            rows.push(values);
            row_lines.push(index as u64 + 1);
        }
        Ok(Table {
            name: name.to_owned(),
            heading_line: heading_line as u64 + 1,
            has: places.map(|place| place.is_some()),
            rows,
            lines: row_lines,
        })
    }

    /// Which columns the headings of a table name. Its rows and units are not checked.
    pub(crate) fn named(&self, bytes: &[u8]) -> [bool; N] {
        let text = text_of(bytes).unwrap_or_default();
        let lines: Vec<&str> = text.lines().collect();
        let (_, _, headings) = self.heading(&lines);
        let mut named = [false; N];
        for meaning in headings.iter().filter_map(|heading| self.meaning(heading)) {
            named[meaning.column] = true;
        }
        named
    }

    /// Line of the headings, from 0, the separator of the columns, and the headings: the first line that is no comment, or a comment before
    /// it if it contains numbers.
    fn heading(&self, lines: &[&str]) -> (usize, char, Vec<String>) {
        let first = lines.iter().position(is_row);
        let of_line = |text: &str| {
            let separators = [',', ';', '\t', ' '].into_iter();
            let split = separators.map(|separator| {
                let headings = self.with_positions(cells(text, separator));
                let known = headings
                    .iter()
                    .filter(|heading| self.meaning(heading).is_some());
                (known.count(), separator, headings)
            });
            split.fold((0, ',', cells(text, ',')), |best, next| {
                if next.0 > best.0 { next } else { best }
            })
        };
        let Some(first) = first else {
            return (0, ',', Vec::new());
        };
        let (known, separator, headings) = of_line(lines[first]);
        if known == 0 {
            let comments = lines[..first].iter().enumerate().rev();
            let found = comments.map(|(index, line)| {
                let text = line.trim_start().trim_start_matches('#');
                (index, of_line(text))
            });
            let mut found = found.filter(|(_, (known, _, _))| *known >= self.required);
            if let Some((index, (_, of_names, headings))) = found.next() {
                // The names may have another separator than the numbers below.
                let separators = [of_names, ' ', ',', ';', '\t'].into_iter();
                let mut fitting = separators
                    .filter(|separator| cells(lines[first], *separator).len() == headings.len());
                return (index, fitting.next().unwrap_or(of_names), headings);
            }
        }
        (first, separator, headings)
    }

    /// The headings with the centres of mass of ImageJ as the positions, if it wrote no others.
    fn with_positions(&self, mut headings: Vec<String>) -> Vec<String> {
        let has_x = headings.iter().any(|heading| {
            let meaning = self.meaning(heading);
            meaning.is_some_and(|meaning| self.names[meaning.column] == "x_m")
        });
        if !has_x {
            for heading in &mut headings {
                match &heading[..] {
                    "XM" => "X".clone_into(heading),
                    "YM" => "Y".clone_into(heading),
                    _ => {}
                }
            }
        }
        headings
    }

    /// Column named by a heading.
    fn meaning(&self, heading: &str) -> Option<Meaning> {
        let exact = self.names.iter().position(|name| *name == heading);
        if let Some(column) = exact {
            return Some(Meaning {
                column,
                form: Form::Length,
                unit: Some("m".to_owned()),
            });
        }
        let (name, unit) = split_unit(heading);
        let lower = name.to_lowercase().replace(['_', '-'], " ");
        let words: Vec<&str> = lower
            .split_whitespace()
            .filter(|word| {
                ![
                    "pillar",
                    "position",
                    "pos",
                    "center",
                    "centre",
                    "coordinate",
                    "top",
                    "stage",
                    "of",
                    "the",
                    "in",
                ]
                .contains(word)
            })
            .collect();
        let [word] = words[..] else { return None };
        let named = |wanted: &str| {
            let names = self.names.iter();
            names
                .clone()
                .position(|name| name.strip_suffix("_m") == Some(wanted))
        };
        let diameter = named("diameter");
        let (column, form) = match word {
            "diam" | "d" => (diameter?, Form::Length),
            "h" => (named("height")?, Form::Length),
            "area" => (diameter?, Form::Area),
            "radius" | "r" if diameter.is_some() => (diameter?, Form::Half),
            "r" => (named("radius")?, Form::Length),
            word => (named(word)?, Form::Length),
        };
        Some(Meaning { column, form, unit })
    }

    /// Places of the columns.
    fn places(
        &self,
        headings: &[String],
        units: &[String],
        default: Option<&str>,
    ) -> Result<Places<N>, String> {
        let Self {
            names,
            required,
            accepted,
        } = self;
        // In tables of ImageJ, width and height are those of a box around each particle.
        let has = |name: &&str| headings.iter().any(|heading| heading == name);
        let has_box = has(&"BX") || ["X", "Y", "Area", "Width", "Height"].iter().all(has);
        let mut places: [Option<Place>; N] = [const { None }; N];
        let mut radius = None;
        let meanings = headings
            .iter()
            .map(|heading| match has_box && heading == "Height" {
                true => None,
                false => self.meaning(heading),
            });
        let meanings: Vec<Option<Meaning>> = meanings.collect();
        for (place, (heading, meaning)) in headings.iter().zip(&meanings).enumerate() {
            let Some(meaning) = meaning else {
                let plain = heading.to_lowercase();
                let plain = plain.trim_matches(|c: char| !c.is_alphanumeric());
                let is_box = has_box && ["width", "height"].contains(&plain);
                // Per cents are no lengths: `%Area` of ImageJ.
                if IGNORED.contains(&plain) || is_box || heading.starts_with('%') {
                    continue;
                }
                return Err(format!("column \"{heading}\" is not known: {accepted}"));
            };
            let of_same =
                |other: &&Meaning| other.column == meaning.column && other.form == Form::Length;
            let is_beside =
                meaning.form != Form::Length && meanings.iter().flatten().any(|it| of_same(&it));
            if is_beside && meaning.form == Form::Area {
                continue;
            }
            let below = units
                .get(place)
                .map(|unit| without_brackets(unit).to_owned());
            let unit = meaning
                .unit
                .clone()
                .or(below.filter(|unit| !unit.is_empty()));
            let unit = unit.or(default.map(str::to_owned));
            let Some(unit) = unit else {
                return Err(format!(
                    "column \"{heading}\" has no unit: write it into the heading, as \"{heading} [um]\", or after the name of the file, as \"FILE [um]\""
                ));
            };
            let length = match meaning.form {
                Form::Area => unit
                    .trim_end_matches("^2")
                    .trim_end_matches(['2', '\u{b2}']),
                _ => &unit[..],
            };
            if length_unit(length).is_none() {
                return Err(format!(
                    "column \"{heading}\" is in the unknown unit \"{unit}\": give a length in {}",
                    Dimension::Length.unit_list()
                ));
            }
            let new = Place {
                place,
                form: meaning.form,
                unit: symbol_of(length).to_owned(),
            };
            if is_beside {
                radius = Some((meaning.column, new));
            } else if places[meaning.column].replace(new).is_some() {
                return Err(format!("two columns are \"{heading}\""));
            }
        }
        for (column, place) in names.iter().zip(&places).take(*required) {
            if place.is_none() {
                return Err(format!("the column {column} is missing: {accepted}"));
            }
        }
        Ok((places, radius))
    }
}

impl Place {
    /// Length of a cell, m.
    fn value(&self, text: &str, notation: Notation) -> Option<f64> {
        let number = number(text, notation)?;
        let length =
            |number: &str| parse_quantity(&format!("{number} {}", self.unit), Dimension::Length);
        match self.form {
            Form::Length => length(&number).ok(),
            Form::Half => Some(2.0 * length(&number).ok()?),
            Form::Area => {
                let area: f64 = number.parse().ok()?;
                Some((4.0 * area / PI).sqrt() * length("1").ok()?)
            }
        }
    }
}

/// Whether a line is no comment and not empty.
fn is_row(line: &&str) -> bool {
    let line = line.trim();
    !line.is_empty() && !line.starts_with('#')
}

/// The notation of the numbers of a table, or the line, from 0, of a number that may be two, and why.
fn notation<const N: usize>(
    places: &[Option<Place>; N],
    rows: impl Iterator<Item = (usize, Vec<String>)>,
    separator: char,
) -> Result<Notation, (usize, String)> {
    let mut evidence = Evidence::default();
    let used: Vec<usize> = places.iter().flatten().map(|place| place.place).collect();
    let mut columns: Vec<Marks> = used.iter().map(|_| Marks::new(false)).collect();
    for (index, row) in rows {
        for (marks, place) in columns.iter_mut().zip(&used) {
            let Some(cell) = row.get(*place) else {
                continue;
            };
            evidence.add(cell);
            marks.add(index as u64, cell);
        }
        if evidence.is_decided() {
            break;
        }
    }
    match evidence.notation(&columns, separator) {
        Ok(reading) => Ok(reading.notation),
        Err(Doubt(column)) => {
            let found = columns[column].doubtful().unwrap_or_default();
            let problem = format!(
                "{found}, and no other number decides it: write the numbers without separators of thousands"
            );
            Err((found.line as usize, problem))
        }
    }
}

pub(crate) fn length_unit(unit: &str) -> Option<f64> {
    parse_quantity(&format!("1 {}", symbol_of(unit)), Dimension::Length).ok()
}

/// Text without brackets around all of it.
fn without_brackets(text: &str) -> &str {
    text.trim().trim_matches(['[', ']', '(', ')'])
}

/// Name and unit of a heading: `x_um`, `X [um]`, `Area (um^2)`, `x / um`.
pub(crate) fn split_unit(heading: &str) -> (&str, Option<String>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((name, unit)) = heading
            .strip_suffix(close)
            .and_then(|it| it.rsplit_once(open))
        {
            return (name.trim(), Some(unit.trim().to_owned()));
        }
    }
    let split = ['/', ',', '_', ' '].into_iter().find_map(|separator| {
        let (name, unit) = heading.rsplit_once(separator)?;
        let unit = unit.trim();
        let length = unit
            .trim_end_matches("^2")
            .trim_end_matches(['2', '\u{b2}']);
        length_unit(length).map(|_| (name.trim(), Some(unit.to_owned())))
    });
    split.unwrap_or((heading, None))
}
