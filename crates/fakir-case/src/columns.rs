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
    /// The unit after the name of a file.
    #[error("{path}: \"{unit}\" is no unit of length")]
    Unit {
        /// The file.
        path: String,
        /// The unit.
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

/// What a case says about a table.
#[derive(Debug, Clone, Default)]
pub(crate) struct Given {
    /// The columns that are used, if the case names them; all others are then left out.
    pub(crate) columns: Vec<Chosen>,
    /// The unit of columns without one.
    pub(crate) unit: Option<Unit>,
}

/// A column that a case names.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chosen {
    column: usize,
    form: Form,
    /// Its heading, or its number from 1.
    heading: String,
}

/// A unit of length, or a length that is one, as the size of a pixel.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unit {
    number: f64,
    symbol: String,
}

impl Unit {
    /// A length in metres.
    pub(crate) fn metres(number: f64) -> Self {
        Self {
            number,
            symbol: "m".to_owned(),
        }
    }

    /// The unit of a text, `um` or `0.325 um`; `None` if it is no length greater than 0.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        if length_unit(text).is_some() {
            return Some(Self {
                number: 1.0,
                symbol: symbol_of(text).to_owned(),
            });
        }
        let length = parse_quantity(text, Dimension::Length).ok()?;
        (length > 0.0 && length.is_finite()).then(|| Self::metres(length))
    }
}

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
    unit: Unit,
}

/// The names of the columns of a table.
struct Headings {
    /// The line below them, from 0.
    first: usize,
    separator: char,
    texts: Vec<String>,
    /// The interpretation of each.
    meanings: Vec<Option<Meaning>>,
    /// Whether the case names the columns that are used.
    are_chosen: bool,
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
        let numbers = rows_below.clone();
        let numbers = numbers.map(|(index, line)| (index, cells(line, separator)));
        let notation = notation(&places, numbers, separator)
            .map_err(|(line, problem)| wrong(line, problem))?;
        let headings = headings.texts;
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

    /// Which columns the headings of a table name. Its rows and units are not checked.
    pub(crate) fn named(&self, bytes: &[u8]) -> [bool; N] {
        let text = text_of(bytes).unwrap_or_default();
        let lines: Vec<&str> = text.lines().collect();
        let mut named = [false; N];
        for meaning in self.headings(&lines).meanings.iter().flatten() {
            named[meaning.column] = true;
        }
        named
    }

    /// The columns that a case names: `"x = POSITION_X, y = 4, diameter = RADIUS"`, each by its heading or its number.
    ///
    /// # Errors
    /// A description of what is wrong with the text.
    pub(crate) fn chosen(&self, text: &str) -> Result<Vec<Chosen>, String> {
        let mut chosen: Vec<Chosen> = Vec::new();
        for part in text
            .split([',', ';'])
            .filter(|part| !part.trim().is_empty())
        {
            let wrong = || format!("\"{}\" names no column", part.trim());
            let (name, heading) = part.split_once('=').ok_or_else(wrong)?;
            let (name, heading) = (name.trim(), heading.trim().trim_matches(['"', '\'']));
            let Some(Meaning {
                column,
                form,
                unit: None,
            }) = self.meaning(name)
            else {
                return Err(format!("there is no quantity \"{name}\""));
            };
            if heading.is_empty() {
                return Err(wrong());
            }
            if chosen.iter().any(|other| other.column == column) {
                return Err(format!("\"{name}\" is given twice"));
            }
            if let Some(other) = chosen.iter().find(|other| other.heading == heading) {
                let other = self.names[other.column].trim_end_matches("_m");
                return Err(format!("{other} and {name} are the same column"));
            }
            chosen.push(Chosen {
                column,
                form,
                heading: heading.to_owned(),
            });
        }
        let has = |column: usize| chosen.iter().any(|chosen| chosen.column == column);
        match (0..self.required).find(|column| !has(*column)) {
            Some(column) => Err(format!(
                "the column of {} is missing",
                self.names[column].trim_end_matches("_m")
            )),
            None => Ok(chosen),
        }
    }

    /// The headings of a table: the first line that is no comment, or a comment before it if it contains numbers.
    fn headings(&self, lines: &[&str]) -> Headings {
        let first = lines.iter().position(is_row);
        let of_line = |text: &str| {
            let separators = SEPARATORS_OF_NAMES.into_iter();
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
        let found = |line: usize, separator: char, texts: Vec<String>| Headings {
            first: line + 1,
            separator,
            meanings: self.meanings(&texts),
            texts,
            are_chosen: false,
        };
        let Some(first) = first else {
            return found(0, ',', Vec::new());
        };
        let (known, separator, headings) = of_line(lines[first]);
        if known == 0 {
            let comments = lines[..first].iter().enumerate().rev();
            let of_comments = comments.map(|(index, line)| (index, of_line(of_comment(line))));
            let mut of_comments = of_comments.filter(|(_, (known, _, _))| *known >= self.required);
            if let Some((index, (_, of_names, headings))) = of_comments.next() {
                // The names may have another separator than the numbers below.
                let separators = [of_names, ' ', ',', ';', '\t'].into_iter();
                let mut fitting = separators
                    .filter(|separator| cells(lines[first], *separator).len() == headings.len());
                return found(index, fitting.next().unwrap_or(of_names), headings);
            }
        }
        found(first, separator, headings)
    }

    /// The interpretation of headings. In tables of ImageJ, width and height are those of a box around each particle.
    fn meanings(&self, headings: &[String]) -> Vec<Option<Meaning>> {
        let has_box = has_box(headings);
        let meanings = headings
            .iter()
            .map(|heading| match has_box && heading == "Height" {
                true => None,
                false => self.meaning(heading),
            });
        meanings.collect()
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
                    "centroid",
                    "location",
                    "areashape",
                    "mass",
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
        let mut places: [Option<Place>; N] = [const { None }; N];
        let mut radius = None;
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
            let length = unit.as_deref().map(|unit| match meaning.form {
                Form::Area => unit
                    .trim_end_matches("^2")
                    .trim_end_matches(['2', '\u{b2}']),
                _ => unit,
            });
            let length = length.filter(|length| default.is_none() || !is_pixel(length));
            let unit = match length {
                Some(length) if length_unit(length).is_some() => Unit::parse(length),
                Some(pixel) if is_pixel(pixel) => {
                    return Err(format!(
                        "column \"{heading}\" is in pixels: give the size of one after the name of the file, as \"FILE [0.325 um]\""
                    ));
                }
                Some(_) => {
                    return Err(format!(
                        "column \"{heading}\" is in the unknown unit \"{}\": give a length in {}",
                        unit.unwrap_or_default(),
                        Dimension::Length.unit_list()
                    ));
                }
                None => default.cloned(),
            };
            let Some(unit) = unit else {
                return Err(format!(
                    "column \"{heading}\" has no unit: write it into the heading, as \"{heading} [um]\", or after the name of the file, as \"FILE [um]\""
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
            Form::Length => length(&number),
            Form::Half => Some(2.0 * length(&number)?),
            Form::Area => {
                let area: f64 = number.parse().ok()?;
                Some((4.0 * area / PI).sqrt() * length("1")?)
            }
        }
    }
}

/// Separators of the names of columns.
const SEPARATORS_OF_NAMES: [char; 4] = [',', ';', '\t', ' '];

/// The headings of a table whose columns the case names, by their texts in some line or by their numbers.
fn chosen_headings(lines: &[&str], columns: &[Chosen]) -> Result<Headings, String> {
    let number = |chosen: &Chosen| {
        chosen
            .heading
            .parse()
            .ok()
            .and_then(|it: usize| it.checked_sub(1))
    };
    let is_named = columns.iter().any(|chosen| number(chosen).is_none());
    let place = |texts: &[String], chosen: &Chosen| match number(chosen) {
        Some(place) => Some(place).filter(|place| *place < texts.len()),
        None => texts.iter().position(|text| *text == chosen.heading),
    };
    let split =
        |line: &str| SEPARATORS_OF_NAMES.map(|separator| (separator, cells(line, separator)));
    for (index, line) in lines.iter().enumerate() {
        for (separator, texts) in split(of_comment(line)) {
            let places = columns.iter().map(|chosen| place(&texts, chosen));
            let Some(places) = places.collect::<Option<Vec<usize>>>() else {
                continue;
            };
            // Without names the first row of numbers decides; its headings are those above it, if there are any.
            if !is_named && !(is_row(line) && places.iter().all(|place| is_number(&texts[*place])))
            {
                continue;
            }
            let width = texts.len();
            let above = || {
                let above = cells(of_comment(lines[index.checked_sub(1)?]), separator);
                (above.len() == width).then_some(above)
            };
            let (first, texts) = match is_named {
                true => (index + 1, texts),
                false => (index, above().unwrap_or_else(|| vec![String::new(); width])),
            };
            let mut meanings = vec![None; width];
            for (chosen, place) in columns.iter().zip(places) {
                meanings[place] = Some(Meaning {
                    column: chosen.column,
                    form: chosen.form,
                    unit: split_unit(&texts[place]).1,
                });
            }
            // The numbers may have another separator than names in a comment.
            let row = lines[first..].iter().find(|line| is_row(line));
            let separators = [separator, ' ', ',', ';', '\t'].into_iter();
            let mut fitting =
                separators.filter(|other| row.is_some_and(|row| cells(row, *other).len() == width));
            return Ok(Headings {
                first,
                separator: fitting.next().unwrap_or(separator),
                texts,
                meanings,
                are_chosen: true,
            });
        }
    }
    let most = lines
        .iter()
        .flat_map(|line| split(line))
        .max_by_key(|(separator, texts)| {
            let found = columns
                .iter()
                .filter(|chosen| place(texts, chosen).is_some());
            (found.count(), *separator != ' ', texts.len())
        });
    let texts = most.map_or(Vec::new(), |(_, texts)| texts);
    let missing = columns
        .iter()
        .find(|chosen| place(&texts, chosen).is_none());
    Err(match missing {
        Some(chosen) => format!(
            "there is no column \"{}\"; there are {}",
            chosen.heading,
            texts.join(", ")
        ),
        None => "no line has numbers in all the columns that are named".to_owned(),
    })
}

/// A line without the sign of a comment before it.
fn of_comment(line: &str) -> &str {
    line.trim_start().trim_start_matches('#')
}

/// The row of units among the first rows below the headings, and the number of rows above it: some programs repeat the headings in other words.
fn units_below<'a>(
    rows: impl Iterator<Item = (usize, &'a &'a str)>,
    separator: char,
) -> Option<(usize, Vec<String>)> {
    /// Most rows of names and units below the headings.
    const MOST: usize = 3;
    let rows = rows.take(MOST).map(|(_, line)| cells(line, separator));
    let mut rows = rows.take_while(|row| !row.iter().any(|cell| is_number(cell)));
    let is_unit = |text: &String| {
        let text = without_brackets(text);
        length_unit(text).is_some() || is_pixel(text)
    };
    let mut rows = rows.by_ref().enumerate();
    rows.find(|(_, row)| row.iter().any(is_unit))
}

/// Whether a unit is that of places in an image.
fn is_pixel(unit: &str) -> bool {
    ["px", "pix", "pixel", "pixels"].contains(&&unit.trim().to_lowercase()[..])
}

/// Whether a table is one of ImageJ with the boxes around particles.
fn has_box(headings: &[String]) -> bool {
    let has = |name: &&str| headings.iter().any(|heading| heading == name);
    has(&"BX") || ["X", "Y", "Area", "Width", "Height"].iter().all(has)
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
        (length_unit(length).is_some() || is_pixel(length))
            .then(|| (name.trim(), Some(unit.to_owned())))
    });
    split.unwrap_or((heading, None))
}
