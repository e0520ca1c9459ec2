//! Tables of lengths under a line with the names of their columns, in the formats of spreadsheets and of ImageJ.

use crate::headings::{
    Columns, Form, Given, Headings, IGNORED, Unit, chosen_headings, has_box, is_no_unit, is_pixel,
    is_row, length_unit, of_area, units_below, without_brackets,
};
use crate::notation::{Doubt, Evidence, Marks, Notation, is_not_measured, number};
use crate::table_text::{cells_of_row, is_statistic, read_table, text_of};
use crate::unit::{Dimension, parse_quantity};
use std::collections::BTreeSet;
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
    /// The unit after the name of a file.
    #[error("{path}: \"{unit}\" is no unit of length")]
    Unit {
        /// The file.
        path: String,
        /// The unit.
        unit: String,
    },
    /// A unit after the name of a file, and as a key.
    #[error(
        "{path}: the unit is given twice, as \"{unit}\" after the name and as pattern.pillar_unit"
    )]
    TwoUnits {
        /// The file.
        path: String,
        /// The unit after its name.
        unit: String,
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

/// Difference of a diameter and twice a radius, over this, from which they contradict each other: both may be rounded.
const CONTRADICTION: f64 = 0.02;

/// Columns of a table, and that of a radius beside the diameter, with the column of the diameter.
type Places<const N: usize> = ([Option<Place>; N], Option<(usize, Place)>);

/// Place of a column, and the interpretation of its cells.
#[derive(Debug, Clone)]
struct Place {
    place: usize,
    form: Form,
    unit: Unit,
}

impl<const N: usize> Columns<N> {
    /// Reads a file: values under a line with the names of the columns and their units, in any order, separated by commas, semicolons, tabs or
    /// blanks; text, `.gz` or `.xlsx`. Lines that begin with `#` are left out, unless they contain the names. A missing column, and an empty cell of a
    /// column that is not required, have the value of `otherwise`.
    pub(crate) fn read(
        &self,
        path: &Path,
        given: &Given,
        otherwise: [f64; N],
    ) -> Result<Table<N>, TableError> {
        let name = path.display().to_string();
        let bytes = read_table(path, LARGEST).map_err(|error| TableError::Unreadable {
            path: name.clone(),
            error,
        })?;
        self.parse(&name, &bytes, given, otherwise)
    }

    /// [`read`](Self::read) from the contents of a file; `name` is its name in errors.
    pub(crate) fn parse(
        &self,
        name: &str,
        bytes: &[u8],
        given: &Given,
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
        let headings = match given.columns.is_empty() {
            true => self.headings(&lines),
            false => {
                chosen_headings(&lines, &given.columns).map_err(|problem| wrong(0, problem))?
            }
        };
        let (first, separator) = (headings.first, headings.separator);
        let below = lines.iter().enumerate().skip(first);
        let mut rows_below = below.filter(|(_, line)| is_row(line));
        let units = units_below(rows_below.clone(), separator);
        if let Some((skipped, _)) = &units {
            rows_below.nth(*skipped);
        }
        let units = units.map_or(Vec::new(), |(_, units)| units);
        let heading_line = first.saturating_sub(1);
        let (places, radius) = self
            .places(&headings, &units, given.unit.as_ref())
            .map_err(|problem| wrong(heading_line, problem))?;
        let all = rows_of(&headings, rows_below).map_err(|(line, problem)| wrong(line, problem))?;
        let notation = notation(&places, &all, separator, &lines)
            .map_err(|(line, problem)| wrong(line, problem))?;
        check_labels(&headings.texts, &places, &all)
            .map_err(|(line, problem)| wrong(line, problem))?;
        let (mut rows, mut row_lines) = (Vec::new(), Vec::new());
        for (index, row) in all {
            let mut values = otherwise;
            for (column, place) in places.iter().enumerate() {
                let Some(place) = place else { continue };
                let text = &row[place.place];
                if column >= self.required && is_not_measured(text) {
                    continue;
                }
                values[column] = place.value(text, notation).ok_or_else(|| {
                    let unit = match (&place.unit.symbol[..], place.unit.number) {
                        ("m", 1.0) => "of metres".to_owned(),
                        (unit, 1.0) => format!("in {unit}"),
                        (unit, number) => format!("in units of {number} {unit}"),
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

    /// Places of the columns.
    fn places(
        &self,
        headings: &Headings,
        units: &[String],
        default: Option<&Unit>,
    ) -> Result<Places<N>, String> {
        let Self {
            names,
            required,
            accepted,
        } = self;
        let has_box = has_box(&headings.texts);
        let has = |name: &&str| headings.texts.iter().any(|heading| heading == name);
        if !headings.are_chosen && !has_box && ["X", "Y", "Area", "Width", "Height"].iter().all(has)
        {
            return Err(format!(
                "column \"Height\" may be the height of pillars, or of boxes around them in an image: rename or remove it; {accepted}"
            ));
        }
        let mut places: [Option<Place>; N] = [const { None }; N];
        let mut radius = None;
        let mut is_default_used = false;
        let meanings = &headings.meanings;
        for (place, (heading, meaning)) in headings.texts.iter().zip(meanings).enumerate() {
            let Some(meaning) = meaning else {
                let plain = heading.to_lowercase();
                let plain = plain.trim_matches(|c: char| !c.is_alphanumeric());
                let is_box = has_box && ["width", "height"].contains(&plain);
                // Per cents are no lengths: `%Area` of ImageJ.
                if headings.are_chosen
                    || IGNORED.contains(&plain)
                    || is_box
                    || heading.starts_with('%')
                {
                    continue;
                }
                return Err(format!("column \"{heading}\" is not known: {accepted}"));
            };
            let mut others = meanings.iter().flatten();
            let is_beside = meaning.form != Form::Length
                && others
                    .clone()
                    .any(|it| it.column == meaning.column && it.form == Form::Length);
            let is_replaced = meaning.form == Form::Area
                && others.any(|it| it.column == meaning.column && it.form != Form::Area);
            if is_replaced {
                continue;
            }
            let below = units
                .get(place)
                .map(|unit| without_brackets(unit).to_owned());
            let unit = meaning
                .unit
                .clone()
                .or(below.filter(|unit| !unit.is_empty()));
            let length = unit.as_deref().map(|unit| match meaning.form {
                Form::Area => of_area(unit),
                _ => unit,
            });
            let is_given = |unit: &&str| default.is_some() && (is_pixel(unit) || is_no_unit(unit));
            let length = length.filter(|length| !is_given(length));
            let unit = match length {
                Some(length) if length_unit(length).is_some() => Unit::parse(length),
                Some(pixel) if is_pixel(pixel) => {
                    return Err(format!(
                        "column \"{heading}\" is in pixels: give the size of one after the name of the file, as \"FILE [0.325 um]\", or as pattern.pillar_unit"
                    ));
                }
                Some(_) => {
                    return Err(format!(
                        "column \"{heading}\" is in the unknown unit \"{}\": give a length in {}",
                        unit.unwrap_or_default(),
                        Dimension::Length.unit_list()
                    ));
                }
                None => {
                    is_default_used = true;
                    default.cloned()
                }
            };
            let Some(unit) = unit else {
                return Err(format!(
                    "column \"{heading}\" has no unit: write it into the heading, as \"{heading} [um]\", or after the name of the file, as \"FILE [um]\", or give pattern.pillar_unit"
                ));
            };
            let new = Place {
                place,
                form: meaning.form,
                unit,
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
        if default.is_some() && !is_default_used {
            return Err(
                "a unit of columns without one is given, but all columns have units: leave it out"
                    .to_owned(),
            );
        }
        Ok((places, radius))
    }
}

impl Place {
    /// Length of a cell, m.
    fn value(&self, text: &str, notation: Notation) -> Option<f64> {
        let number = number(text, notation)?;
        let Unit { number: of, symbol } = &self.unit;
        let length = |number: &str| {
            let length = parse_quantity(&format!("{number} {symbol}"), Dimension::Length);
            Some(of * length.ok()?)
        };
        match self.form {
            Form::Area if number.starts_with('-') => None,
            Form::Length => length(&number),
            Form::Half => Some(2.0 * length(&number)?),
            Form::Area => {
                let area: f64 = number.parse().ok()?;
                Some((4.0 * area / PI).sqrt() * length("1")?)
            }
        }
    }
}

/// A row, with its line, from 0.
type Row = (usize, Vec<String>);

/// What is wrong with a line, from 0.
type Wrong = (usize, String);

/// The rows of a table below its headings, each with as many cells as there are.
fn rows_of<'a>(
    headings: &Headings,
    lines: impl Iterator<Item = (usize, &'a &'a str)>,
) -> Result<Vec<Row>, Wrong> {
    let width = headings.texts.len();
    let mut rows: Vec<Row> = Vec::new();
    let mut are_named = None;
    for (index, line) in lines {
        let mut row = cells_of_row(line, headings.separator, width);
        if row.iter().all(String::is_empty) {
            continue;
        }
        // R writes no heading over the names of its rows. Commas might be decimal ones.
        let has_name = row.len() == width + 1 && headings.separator != ',';
        if *are_named.get_or_insert(has_name) && has_name {
            row.remove(0);
        }
        if row.len() != width {
            let problem = format!("{} cells, but {width} in the line of the names", row.len());
            return Err((index, problem));
        }
        rows.push((index, row));
    }
    Ok(rows)
}

/// Refuses rows that are statistics of the others, as `ImageJ` writes them below the particles, and rows of several images.
fn check_labels<const N: usize>(
    headings: &[String],
    places: &[Option<Place>; N],
    rows: &[Row],
) -> Result<(), Wrong> {
    let is_used = |place: usize| places.iter().flatten().any(|used| used.place == place);
    for (place, heading) in headings.iter().enumerate().filter(|(it, _)| !is_used(*it)) {
        let is_of_statistic = |(_, row): &&Row| is_statistic(&row[place]);
        let statistic = rows.iter().find(is_of_statistic);
        if let Some((line, row)) = statistic
            && !rows.iter().all(|row| is_of_statistic(&row))
        {
            let label = &row[place];
            let problem =
                format!("\"{label}\" labels a statistic of the other rows: remove this row");
            return Err((*line, problem));
        }
        if NAMES_OF_IMAGES.contains(&&heading.to_lowercase().replace([' ', '_'], "")[..]) {
            let images: BTreeSet<&String> = rows.iter().map(|(_, row)| &row[place]).collect();
            let second = rows.iter().find(|(_, row)| row[place] != rows[0].1[place]);
            if let Some((line, row)) = second {
                let problem = format!(
                    "\"{heading}\" is {} here and {} in line {}: the rows belong to {} images; keep those of one, or remove this column if all have the same axes",
                    row[place],
                    rows[0].1[place],
                    rows[0].0 + 1,
                    images.len()
                );
                return Err((*line, problem));
            }
        }
    }
    Ok(())
}

/// Headings of the number or the name of an image, in lower case and without blanks.
const NAMES_OF_IMAGES: [&str; 8] = [
    "slice",
    "frame",
    "image",
    "imagenumber",
    "imagename",
    "filename",
    "positiont",
    "timepoint",
];

/// The notation of the numbers of a table, or the line, from 0, of a number that may be two, and why.
fn notation<const N: usize>(
    places: &[Option<Place>; N],
    rows: &[Row],
    separator: char,
    lines: &[&str],
) -> Result<Notation, Wrong> {
    let mut evidence = Evidence::default();
    let used: Vec<usize> = places.iter().flatten().map(|place| place.place).collect();
    let mut columns: Vec<Marks> = used.iter().map(|_| Marks::new(false)).collect();
    for (index, row) in rows {
        evidence.add_line(lines[*index]);
        for (marks, place) in columns.iter_mut().zip(&used) {
            evidence.add(&row[*place]);
            marks.add(*index as u64, &row[*place]);
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
