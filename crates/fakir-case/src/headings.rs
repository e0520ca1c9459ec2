//! The headings of a table: which column contains which quantity, in which unit.

use crate::notation::is_number;
use crate::table_text::{SEPARATORS, cells, text_of};
use crate::unit::{Dimension, parse_quantity, symbol_of};

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
    pub(crate) number: f64,
    pub(crate) symbol: String,
}

impl Unit {
    /// The unit of a text, `um` or `0.325 um`; `None` if it is no length greater than 0.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        if length_unit(text).is_some() {
            return Some(Self {
                number: 1.0,
                symbol: symbol_of(text).to_owned(),
            });
        }
        let length = parse_quantity(text, Dimension::Length).ok()?;
        (length > 0.0 && length.is_finite()).then(|| Self {
            number: length,
            symbol: "m".to_owned(),
        })
    }
}

/// Quantity in a cell, from which the length of the column is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Form {
    /// The length.
    Length,
    /// Half of it: the radius of a diameter.
    Half,
    /// The area of a circle of this diameter.
    Area,
}

/// Interpretation of a heading.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Meaning {
    pub(crate) column: usize,
    pub(crate) form: Form,
    pub(crate) unit: Option<String>,
}

/// The names of the columns of a table.
pub(crate) struct Headings {
    /// The line below them, from 0.
    pub(crate) first: usize,
    pub(crate) separator: char,
    pub(crate) texts: Vec<String>,
    /// The interpretation of each.
    pub(crate) meanings: Vec<Option<Meaning>>,
    /// Whether the case names the columns that are used.
    pub(crate) are_chosen: bool,
}

/// Headings of columns that are not used: numbers and names of the rows, and other measurements of ImageJ.
pub(crate) const IGNORED: [&str; 44] = [
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

impl<const N: usize> Columns<N> {
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
        for part in parts_of(text) {
            let wrong = || format!("\"{part}\" names no column");
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
            if heading == "0" {
                return Err("columns are numbered from 1".to_owned());
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

    /// The headings of a table: the first line that names the required columns, also below titles; or else the first line that is no comment, or a comment
    /// before it if it contains numbers.
    pub(crate) fn headings(&self, lines: &[&str]) -> Headings {
        /// Most lines of titles above the headings.
        const TITLES: usize = 20;
        let of_line = |text: &str| {
            let mut best = (0, ',', cells(text, ','));
            for separator in SEPARATORS_OF_NAMES {
                let headings = self.with_positions(cells(text, separator));
                let known = headings
                    .iter()
                    .filter(|heading| self.meaning(heading).is_some());
                let known = known.count();
                // Blanks also separate the words of a heading.
                let is_better = known > best.0 && (separator != ' ' || best.0 < self.required);
                if is_better {
                    best = (known, separator, headings);
                }
            }
            best
        };
        let found = |line: usize, separator: char, texts: Vec<String>| Headings {
            first: line + 1,
            separator,
            meanings: self.meanings(&texts),
            texts,
            are_chosen: false,
        };
        let mut rows = lines.iter().enumerate().filter(|(_, line)| is_row(line));
        let Some((first, _)) = rows.clone().next() else {
            return found(0, ',', Vec::new());
        };
        let names = rows.by_ref().take(TITLES).filter_map(|(index, line)| {
            let (known, separator, headings) = of_line(line);
            (known >= self.required).then_some((index, separator, headings))
        });
        let mut names: Vec<(usize, char, Vec<String>)> = names.collect();
        // Words of a title may be those of headings, but there are not as many as cells in the rows below.
        let is_above_rows = |(index, separator, headings): &(usize, char, Vec<String>)| {
            let below = lines[index + 1..]
                .iter()
                .filter(|line| is_row(line))
                .take(4);
            below
                .map(|line| cells(line, *separator).len())
                .any(|count| count == headings.len())
        };
        if !names.is_empty() {
            let place = names.iter().position(is_above_rows).unwrap_or(0);
            let (index, separator, headings) = names.swap_remove(place);
            return found(index, separator, headings);
        }
        let (known, separator, headings) = of_line(lines[first]);
        if known == 0 {
            let comments = lines[..first].iter().enumerate().rev();
            let of_comments = comments.map(|(index, line)| (index, of_line(of_comment(line))));
            let mut of_comments = of_comments.filter(|(_, (known, _, _))| *known >= self.required);
            if let Some((index, (_, of_names, headings))) = of_comments.next() {
                let separator = separator_below(&lines[index + 1..], of_names, headings.len());
                return found(index, separator, headings);
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
            "diam" | "d" | "durchmesser" | "diam\u{e8}tre" | "di\u{e1}metro" => {
                (diameter?, Form::Length)
            }
            "h" | "h\u{f6}he" | "hauteur" | "altura" => (named("height")?, Form::Length),
            "area" | "fl\u{e4}che" | "surface" => (diameter?, Form::Area),
            "radius" | "r" if diameter.is_some() => (diameter?, Form::Half),
            "r" => (named("radius")?, Form::Length),
            word => (named(word)?, Form::Length),
        };
        Some(Meaning { column, form, unit })
    }
}

/// Separators of the names of columns.
const SEPARATORS_OF_NAMES: [char; 4] = [',', ';', '\t', ' '];

/// The parts of a text between commas or semicolons, which quotes may contain.
fn parts_of(text: &str) -> Vec<&str> {
    let mut is_quoted = false;
    let parts = text.split(|c: char| {
        is_quoted ^= c == '"';
        !is_quoted && [',', ';'].contains(&c)
    });
    let parts = parts.map(str::trim);
    parts.filter(|part| !part.is_empty()).collect()
}

/// A heading as it is compared: without case, and with one sign for micro.
fn comparable(heading: &str) -> String {
    heading
        .trim()
        .to_lowercase()
        .replace(['\u{b5}', '\u{3bc}'], "u")
}

impl Chosen {
    /// Its place, if it is given by its number.
    fn number(&self) -> Option<usize> {
        self.heading.parse::<usize>().ok()?.checked_sub(1)
    }

    /// Its place among headings, or the places of those that are written so.
    fn places(&self, texts: &[String]) -> Vec<usize> {
        if let Some(number) = self.number() {
            return (number < texts.len())
                .then_some(number)
                .into_iter()
                .collect();
        }
        let places = |is: &dyn Fn(&String) -> bool| -> Vec<usize> {
            let found = texts.iter().enumerate().filter(|(_, text)| is(text));
            found.map(|(place, _)| place).collect()
        };
        let exact = places(&|text| *text == self.heading);
        if !exact.is_empty() {
            return exact;
        }
        let wanted = comparable(&self.heading);
        places(&|text| comparable(text) == wanted)
    }
}

/// The headings of a table whose columns the case names, by their texts in some line or by their numbers.
fn chosen_line(lines: &[&str], columns: &[Chosen]) -> Option<(usize, char, Vec<String>)> {
    let is_named = columns.iter().any(|chosen| chosen.number().is_none());
    let has_all = |texts: &[String]| columns.iter().all(|it| !it.places(texts).is_empty());
    for (index, line) in lines.iter().enumerate() {
        for separator in SEPARATORS_OF_NAMES {
            let texts = cells(of_comment(line), separator);
            if !has_all(&texts) {
                continue;
            }
            if is_named {
                return Some((index + 1, separator, texts));
            }
            // Without names the first row of numbers decides; its headings are those above it, if there are any.
            let are_numbers = columns.iter().flat_map(|chosen| chosen.places(&texts));
            if is_row(line) && are_numbers.clone().all(|place| is_number(&texts[place])) {
                let (first, names) = names_above(&lines[..index], separator, texts.len());
                return Some((first, separator, names));
            }
        }
    }
    None
}

/// The line below the headings, from 0, and the headings themselves, in the lines above the first row of numbers, which has so many cells.
fn names_above(above: &[&str], separator: char, width: usize) -> (usize, Vec<String>) {
    let fitting = above.iter().enumerate().rev().map(|(index, line)| {
        let texts = cells(of_comment(line), separator);
        (index, texts)
    });
    let mut fitting = fitting
        .filter(|(_, texts)| texts.len() == width)
        .take_while(|(_, texts)| !texts.iter().any(|text| is_number(text)));
    let none = || vec![String::new(); width];
    match (fitting.next(), fitting.next()) {
        (Some((_, texts)), Some((index, names))) if has_units(&texts) => (index + 1, names),
        (Some((index, texts)), None) if has_units(&texts) => (index, none()),
        (Some((index, names)), _) => (index + 1, names),
        (None, _) => (above.len(), none()),
    }
}

/// [`chosen_line`], with the interpretation of its headings.
pub(crate) fn chosen_headings(lines: &[&str], columns: &[Chosen]) -> Result<Headings, String> {
    let Some((first, separator, texts)) = chosen_line(lines, columns) else {
        return Err(no_such_column(lines, columns));
    };
    let width = texts.len();
    let mut meanings = vec![None; width];
    for chosen in columns {
        let place = match chosen.places(&texts)[..] {
            [place] => place,
            ref places => {
                let numbers: Vec<String> = places.iter().map(|it| (it + 1).to_string()).collect();
                return Err(format!(
                    "there are several columns \"{}\": give the number of one of them, {}",
                    chosen.heading,
                    numbers.join(" or ")
                ));
            }
        };
        let meaning = Meaning {
            column: chosen.column,
            form: chosen.form,
            unit: split_unit(&texts[place]).1,
        };
        if meanings[place].replace(meaning).is_some() {
            return Err(format!("column {} is given twice", place + 1));
        }
    }
    Ok(Headings {
        first,
        separator: separator_below(&lines[first..], separator, width),
        texts,
        meanings,
        are_chosen: true,
    })
}

/// The separator of the rows below names with this one: names in a comment may have another.
fn separator_below(lines: &[&str], of_names: char, count: usize) -> char {
    let row = lines.iter().find(|line| is_row(line));
    let separators = [of_names, ' ', ',', ';', '\t'].into_iter();
    let mut fitting =
        separators.filter(|other| row.is_some_and(|row| cells(row, *other).len() == count));
    fitting.next().unwrap_or(of_names)
}

/// The error for a table that does not have all columns that the case names.
fn no_such_column(lines: &[&str], columns: &[Chosen]) -> String {
    /// Most headings in a message.
    const MOST: usize = 20;
    let mut best: (usize, Vec<String>) = (0, Vec::new());
    for line in lines {
        for separator in SEPARATORS_OF_NAMES {
            let texts = cells(of_comment(line), separator);
            let words = texts
                .iter()
                .filter(|text| !text.is_empty() && !is_number(text));
            let found = columns.iter().filter(|it| !it.places(&texts).is_empty());
            // The line that has most of the columns, or else most words.
            let score = 1000 * found.count() + words.count() * usize::from(separator != ' ');
            if score > best.0 {
                best = (score, texts);
            }
        }
    }
    let (_, texts) = best;
    let missing = columns
        .iter()
        .find(|chosen| chosen.places(&texts).is_empty());
    let Some(chosen) = missing else {
        return "no line has numbers in all the columns that are named".to_owned();
    };
    let mut shown = texts.clone();
    shown.truncate(MOST);
    let rest = match texts.len() - shown.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!(
        "there is no column \"{}\"; there are {}{rest}",
        chosen.heading,
        shown.join(", ")
    )
}

/// A line without the sign of a comment before it.
fn of_comment(line: &str) -> &str {
    let text = line.trim_start();
    match text.strip_prefix("% ") {
        Some(text) => text,
        None => text.trim_start_matches('#'),
    }
}

/// The row of units among the first rows below the headings, and the number of rows above it: some programs repeat the headings in other words.
pub(crate) fn units_below<'a>(
    rows: impl Iterator<Item = (usize, &'a &'a str)>,
    separator: char,
) -> Option<(usize, Vec<String>)> {
    /// Most rows of names and units below the headings.
    const MOST: usize = 3;
    let rows = rows.take(MOST).map(|(_, line)| cells(line, separator));
    let rows = rows.take_while(|row| !row.iter().any(|cell| is_number(cell)));
    rows.enumerate().find(|(_, row)| has_units(row))
}

/// Whether a row has units of lengths or places.
fn has_units(row: &[String]) -> bool {
    row.iter().any(|text| {
        let text = without_brackets(text);
        length_unit(text).is_some() || is_pixel(text)
    })
}

/// Whether a unit is that of places in an image.
pub(crate) fn is_pixel(unit: &str) -> bool {
    ["px", "pix", "pixel", "pixels"].contains(&&unit.trim().to_lowercase()[..])
}

/// Whether a word in brackets behind a heading stands for a unit that it does not name, as `X (unit)`.
pub(crate) fn is_no_unit(word: &str) -> bool {
    ["unit", "units", "calibrated", "a.u."].contains(&&word.trim().to_lowercase()[..])
}

/// Whether a table is one of ImageJ with the boxes around particles.
pub(crate) fn has_box(headings: &[String]) -> bool {
    headings.iter().any(|heading| heading == "BX")
}

/// Whether a line is no comment and not empty. A number behind `#`, and a separator, are the label of a row.
pub(crate) fn is_row(line: &&str) -> bool {
    let line = line.trim_matches(|c: char| c.is_whitespace() || c == '\u{1a}');
    let is_label = |rest: &str| {
        let behind = rest.trim_start_matches(|c: char| c.is_ascii_digit());
        behind.len() < rest.len() && behind.starts_with(SEPARATORS)
    };
    match line.strip_prefix('#') {
        Some(rest) => is_label(rest),
        None => !line.is_empty() && !line.starts_with("% "),
    }
}

/// The unit of length in a unit of area: `um` of `um^2`, `sq um` and `um*um`.
pub(crate) fn of_area(unit: &str) -> &str {
    let unit = unit.trim();
    let unit = ["square ", "sq. ", "sq "]
        .iter()
        .find_map(|word| unit.strip_prefix(word))
        .unwrap_or(unit);
    match unit.split_once('*') {
        Some((one, other)) if one == other || other == "*2" => one,
        _ => unit
            .trim_end_matches("^2")
            .trim_end_matches(['2', '\u{b2}']),
    }
}

pub(crate) fn length_unit(unit: &str) -> Option<f64> {
    parse_quantity(&format!("1 {}", symbol_of(unit)), Dimension::Length).ok()
}

/// Text without brackets around all of it.
pub(crate) fn without_brackets(text: &str) -> &str {
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
        let length = of_area(unit);
        (length_unit(length).is_some() || is_pixel(length))
            .then(|| (name.trim(), Some(unit.to_owned())))
    });
    split.unwrap_or((heading, None))
}
