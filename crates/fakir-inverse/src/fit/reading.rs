//! Reads tables in the formats of instruments: identifies the quantity and the unit of each column.
//!
//! A heading is interpreted by its words: all of them must be known, and they must name one quantity. The unit is in the name or the
//! heading (`displacement_um`, `Load [mN]`, `Force (mN)`, `F / mN`) or in a row of units below. Columns that are not recognised are not
//! used; the [`Layout`] lists them.

use super::column::{Column, DataError};
use fakir::state::Branch;
use fakir_case::unit::{Dimension, QuantityError, parse_quantity};
use std::borrow::Cow;

/// A column of a file or a table, and its interpretation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadColumn {
    /// Number of the column, from 1.
    pub number: usize,
    /// Heading as written.
    pub heading: String,
    /// Quantity; `None` if the column is not used.
    pub column: Option<Column>,
    /// Unit as written; `None` for a branch.
    pub unit: Option<String>,
    /// Whether the sign of its values is reversed.
    pub negated: bool,
    /// Whether the column was named by the user.
    pub by_hand: bool,
}

/// Interpretation of a file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Layout {
    /// Separator of the columns; `None` for arrays.
    pub separator: Option<char>,
    /// Whether numbers have decimal commas.
    pub decimal_comma: bool,
    /// Line of the headings, from 1; `None` without headings.
    pub heading_line: Option<u64>,
    /// The columns, in the order of the file.
    pub columns: Vec<ReadColumn>,
}

/// Values of one row of the file, each with its column.
pub(super) type RowValues = Vec<(Column, f64)>;

/// Interpretation of the columns, the columns found, and for every row its line in the file and its values.
pub(super) type Table = (Layout, Vec<Column>, Vec<(u64, RowValues)>);

/// Interpretation of arrays, and their columns with values in SI units.
pub(super) type Arrays = (Layout, Vec<(Column, Vec<f64>)>);

/// A column named by the user: `force=Load [mN]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedColumn {
    /// Quantity of the column.
    pub column: Column,
    /// Its heading, with the unit if the file has none; or `#` and its number, from 1.
    pub heading: String,
    /// Whether the sign of its values is reversed: for a position that decreases as the lens moves down.
    pub negated: bool,
}

impl NamedColumn {
    /// Combines the name of a quantity and a heading; a minus sign before the heading reverses the sign of
    /// the values.
    ///
    /// # Errors
    /// If there is no such quantity; the error lists the quantities that exist.
    pub fn new(quantity: &str, heading: &str) -> Result<Self, String> {
        let is_named = |column: &Column| column.quantity() == quantity || column.name() == quantity;
        let Some(column) = Column::ALL.into_iter().find(is_named) else {
            let known = Column::ALL.map(Column::quantity).join(", ");
            return Err(format!(
                "\"{quantity}\" is no quantity of measurements: give one of {known}"
            ));
        };
        let heading = heading.trim();
        let (negated, heading) = match heading.strip_prefix('-') {
            Some(rest) => (true, rest.trim()),
            None => (false, heading),
        };
        if heading.is_empty() {
            return Err(format!(
                "{quantity}: give the heading of its column, as in {quantity}=\"Channel 2 [{}]\"",
                example_unit(column)
            ));
        }
        Ok(Self {
            column,
            heading: heading.to_owned(),
            negated,
        })
    }

    /// Parses the form of the command line: `force=Load [mN]`.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn parse(text: &str) -> Result<Self, String> {
        let (quantity, heading) = text.split_once('=').ok_or_else(|| {
            format!("\"{text}\" names no column: write it like force=\"Load [mN]\"")
        })?;
        Self::new(quantity.trim(), heading)
    }

    /// Whether it matches the cell of a heading, and the unit that it gives.
    fn matches(&self, place: usize, heading: &str) -> Option<Option<String>> {
        let (number, unit) = split_unit(&self.heading);
        if let Some(number) = number
            .strip_prefix('#')
            .and_then(|n| n.trim().parse::<usize>().ok())
        {
            return (place + 1 == number).then_some(unit);
        }
        let plain = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        if plain(&self.heading) == plain(heading) {
            return Some(None);
        }
        // The name of a column without a unit, followed by the unit.
        (unit.is_some() && plain(&number) == plain(heading)).then_some(unit)
    }

    fn is_by_number(&self) -> bool {
        self.heading.starts_with('#')
    }
}

fn example_unit(column: Column) -> &'static str {
    match column.dimension() {
        Some(Dimension::Force) => "mN",
        Some(_) => "um",
        None => "s",
    }
}

/// Units that case files do not accept, each as a multiple of a unit that they accept.
const MORE_UNITS: [(&str, f64, &str); 12] = [
    ("cm", 10.0, "mm"),
    ("pm", 1e-3, "nm"),
    ("A", 0.1, "nm"),
    ("\u{c5}", 0.1, "nm"),
    ("\u{212b}", 0.1, "nm"),
    ("micron", 1.0, "um"),
    ("microns", 1.0, "um"),
    ("micrometer", 1.0, "um"),
    ("pN", 1e-3, "nN"),
    ("kN", 1e3, "N"),
    ("meter", 1.0, "m"),
    ("newton", 1.0, "N"),
];

/// Units of time.
const TIMES: [(&str, f64); 8] = [
    ("s", 1.0),
    ("sec", 1.0),
    ("seconds", 1.0),
    ("ms", 1e-3),
    ("us", 1e-6),
    ("min", 60.0),
    ("h", 3600.0),
    ("hours", 3600.0),
];

/// Conversion of the numbers of a column to SI units.
#[derive(Debug, Clone, PartialEq)]
enum Scale {
    /// A factor.
    Factor(f64),
    /// A unit that only shifts the decimal point, so that numbers are rounded once.
    Unit(String, Dimension),
}

impl Scale {
    fn of(column: Column, unit: &str) -> Result<Self, String> {
        let Some(dimension) = column.dimension() else {
            let ascii = unit.replace(['\u{b5}', '\u{3bc}'], "u");
            let known = TIMES.iter().find(|(symbol, _)| *symbol == ascii);
            return known
                .map(|(_, factor)| Self::Factor(*factor))
                .ok_or_else(|| {
                    format!("\"{unit}\" is not a known unit of time: give s, ms, us, min or h")
                });
        };
        let parsed = |unit: &str| parse_quantity(&format!("1 {unit}"), dimension);
        if let Some((_, factor, of)) = MORE_UNITS.iter().find(|(symbol, _, _)| *symbol == unit)
            && let Ok(value) = parsed(of)
        {
            return Ok(Self::Factor(factor * value));
        }
        let problem = match parsed(unit) {
            Ok(_) => return Ok(Self::Unit(unit.to_owned(), dimension)),
            Err(
                error @ (QuantityError::WrongDimension { .. } | QuantityError::UnknownUnit { .. }),
            ) => error.to_string(),
            Err(_) => format!("\"{unit}\" is not a known unit"),
        };
        Err(format!(
            "{problem}; {} is in {}",
            column.quantity(),
            dimension.unit_list()
        ))
    }

    /// The value of a decimal number in SI units.
    fn value(&self, number: &str) -> Option<f64> {
        match self {
            Self::Factor(factor) => number.parse::<f64>().ok().map(|value| factor * value),
            Self::Unit(unit, dimension) => {
                number.parse::<f64>().ok()?;
                parse_quantity(&format!("{number} {unit}"), *dimension).ok()
            }
        }
    }
}

/// Whether a text is a unit of anything.
fn is_unit(text: &str) -> bool {
    let dimensions = [
        Dimension::Length,
        Dimension::Force,
        Dimension::Pressure,
        Dimension::Stiffness,
        Dimension::EnergyPerArea,
        Dimension::Angle,
    ];
    let ascii = text.replace(['\u{b5}', '\u{3bc}'], "u");
    !text.is_empty()
        && (dimensions
            .into_iter()
            .any(|dimension| parse_quantity(&format!("1 {text}"), dimension).is_ok())
            || TIMES.iter().any(|(symbol, _)| *symbol == ascii)
            || MORE_UNITS.iter().any(|(symbol, _, _)| *symbol == text))
}

/// Text without brackets around all of it.
fn without_brackets(text: &str) -> &str {
    let text = text.trim();
    let pairs = [('[', ']'), ('(', ')'), ('{', '}')];
    let mut inside = pairs
        .into_iter()
        .filter_map(|(open, close)| text.strip_prefix(open)?.strip_suffix(close));
    inside.next().map_or(text, str::trim)
}

/// The name and the unit of a heading.
fn split_unit(heading: &str) -> (String, Option<String>) {
    let heading = heading.trim();
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}')] {
        if let Some(start) = heading
            .strip_suffix(close)
            .and_then(|rest| rest.rfind(open))
        {
            let inside = heading[start + 1..heading.len() - 1].trim();
            let name = heading[..start].trim().to_owned();
            // Words in brackets are not a unit.
            let is_word = words(inside)
                .iter()
                .all(|word| FILLERS.contains(&&word[..]));
            if !inside.is_empty() && !is_word {
                return (name, Some(inside.to_owned()));
            }
            return (format!("{name} {inside}"), None);
        }
    }
    for separator in ['/', ',', '_', ' ', '-', '.'] {
        if let Some((name, unit)) = heading.rsplit_once(separator)
            && !name.trim().is_empty()
            && is_unit(unit.trim())
        {
            return (name.trim().to_owned(), Some(unit.trim().to_owned()));
        }
    }
    (heading.to_owned(), None)
}

/// Words of a name, in lower case: `ContactRadius` has two.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut last_is_small = false;
    for character in name.chars() {
        let begins = !character.is_alphanumeric() || (last_is_small && character.is_uppercase());
        if begins {
            words.push(String::new());
        }
        if character.is_alphanumeric()
            && let Some(word) = words.last_mut()
        {
            word.extend(character.to_lowercase());
        }
        last_is_small = character.is_lowercase();
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Words that name a quantity.
const QUANTITIES: [(&str, Column); 19] = [
    ("time", Column::Time),
    ("elapsed", Column::Time),
    ("zeit", Column::Time),
    ("branch", Column::Branch),
    ("segment", Column::Branch),
    ("direction", Column::Branch),
    ("phase", Column::Branch),
    ("indentation", Column::Indentation),
    ("displacement", Column::Displacement),
    ("disp", Column::Displacement),
    ("position", Column::Displacement),
    ("travel", Column::Displacement),
    ("extension", Column::Displacement),
    ("stroke", Column::Displacement),
    ("crosshead", Column::Displacement),
    ("force", Column::Force),
    ("load", Column::Force),
    ("kraft", Column::Force),
    ("radius", Column::ContactRadius),
];

/// Words that name a quantity unless another word does: `z position`, `normal force fz`.
const SYMBOLS: [(&str, Column); 10] = [
    ("z", Column::Displacement),
    ("depth", Column::Displacement),
    ("distance", Column::Displacement),
    ("weg", Column::Displacement),
    ("pos", Column::Displacement),
    ("f", Column::Force),
    ("fn", Column::Force),
    ("fz", Column::Force),
    ("t", Column::Time),
    ("p", Column::Force),
];

/// Words that change a quantity into its standard error.
const ERRORS: [&str; 9] = [
    "error",
    "errors",
    "err",
    "std",
    "stdev",
    "sd",
    "sigma",
    "uncertainty",
    "deviation",
];

/// Words without effect that may accompany the name.
const FILLERS: [&str; 27] = [
    "normal",
    "measured",
    "contact",
    "raw",
    "corrected",
    "applied",
    "stage",
    "sensor",
    "cell",
    "channel",
    "total",
    "piezo",
    "vertical",
    "head",
    "machine",
    "axial",
    "compressive",
    "actual",
    "sample",
    "standard",
    "of",
    "the",
    "in",
    "mean",
    "average",
    "crosshead",
    "test",
];

/// Quantity that a name denotes, if all of its words are known.
fn quantity_of(name: &str) -> Option<Column> {
    let words = words(name);
    let is_error = words.iter().any(|word| ERRORS.contains(&&word[..]));
    let mut strong = Vec::new();
    let mut weak = Vec::new();
    let of = |table: &[(&str, Column)], word: &str| {
        let found = table.iter().find(|(known, _)| *known == word);
        found.map(|(_, column)| *column)
    };
    for word in &words {
        let is_other = ERRORS.contains(&&word[..])
            || FILLERS.contains(&&word[..])
            || word.chars().all(|c| c.is_ascii_digit());
        match (of(&QUANTITIES, word), of(&SYMBOLS, word)) {
            (Some(column), _) => strong.push((column, word)),
            (None, Some(column)) => weak.push((column, word)),
            (None, None) if is_other => {}
            (None, None) => return None,
        }
    }
    // `crosshead load` is a load.
    if strong.iter().any(|(_, word)| *word != "crosshead") {
        strong.retain(|(_, word)| *word != "crosshead");
    }
    let named = if strong.is_empty() { &weak } else { &strong };
    let (first, _) = *named.first()?;
    if named.iter().any(|(column, _)| *column != first) {
        return None;
    }
    match (is_error, first) {
        (false, _) => Some(first),
        (true, _) => Column::ALL
            .into_iter()
            .find(|column| column.errors_of() == Some(first)),
    }
}

/// The branch that a word names.
pub(super) fn branch_of(text: &str) -> Option<Branch> {
    const LOADING: [&str; 10] = [
        "loading",
        "load",
        "approach",
        "approaching",
        "advance",
        "advancing",
        "extend",
        "forward",
        "trace",
        "indent",
    ];
    const UNLOADING: [&str; 12] = [
        "unloading",
        "unload",
        "retract",
        "retraction",
        "retracting",
        "retrace",
        "withdraw",
        "withdrawal",
        "backward",
        "receding",
        "return",
        "pull-off",
    ];
    let text = without_brackets(text).to_lowercase();
    let text = text
        .trim_start_matches("segment")
        .trim_start_matches([':', ' ']);
    if LOADING.contains(&text) {
        Some(Branch::Loading)
    } else if UNLOADING.contains(&text) {
        Some(Branch::Unloading)
    } else {
        None
    }
}

/// A column that is used.
struct Used {
    place: usize,
    column: Column,
    scale: Option<Scale>,
    negated: bool,
    /// Whether words other than branches are an error.
    is_strict: bool,
}

/// Headings with their interpretation.
struct Heading {
    layout: Layout,
    used: Vec<Used>,
}

/// Possible interpretations of a cell of a heading.
struct Candidate {
    column: Column,
    unit: Option<String>,
    negated: bool,
    by_hand: bool,
}

fn candidate(place: usize, heading: &str, named: &[NamedColumn]) -> Option<Candidate> {
    let by_hand = named
        .iter()
        .find_map(|named| Some((named, named.matches(place, heading)?)));
    let (name, unit) = split_unit(heading);
    if let Some((named, given)) = by_hand {
        return Some(Candidate {
            column: named.column,
            unit: given.or(unit),
            negated: named.negated,
            by_hand: true,
        });
    }
    let column = quantity_of(&name)?;
    // A quantity named by the user is not searched for in other columns.
    let is_named = named.iter().any(|named| {
        let positions = [Column::Displacement, Column::Indentation];
        named.column == column || (positions.contains(&named.column) && positions.contains(&column))
    });
    (!is_named).then_some(Candidate {
        column,
        unit,
        negated: false,
        by_hand: false,
    })
}

/// Creates errors that refer to a file.
pub(super) struct Reader<'a> {
    pub(super) name: &'a str,
}

impl Reader<'_> {
    pub(super) fn fail(
        &self,
        line: Option<u64>,
        column: Option<&str>,
        problem: impl Into<String>,
    ) -> DataError {
        DataError {
            name: self.name.to_owned(),
            line,
            column: column.map(str::to_owned),
            problem: problem.into(),
        }
    }

    /// Interprets columns with these headings. `line` is the line of the headings, and `units` are the units of a
    /// row below them.
    fn heading(
        &self,
        headings: &[String],
        units: &[String],
        line: Option<u64>,
        named: &[NamedColumn],
    ) -> Result<Heading, DataError> {
        let fail = |heading: &str, problem: String| self.fail(line, Some(heading), problem);
        for named in named {
            let meant = headings.iter().enumerate();
            let meant = meant.filter(|(place, heading)| named.matches(*place, heading).is_some());
            let problem = match meant.count() {
                1 => continue,
                0 => format!("no column of that heading; there are {}", quoted(headings)),
                count => format!("{count} columns of that heading: give its number, as #2"),
            };
            return Err(fail(&named.heading, problem));
        }
        let mut columns: Vec<ReadColumn> = Vec::new();
        let mut used: Vec<Used> = Vec::new();
        let mut problems: Vec<(Column, usize, DataError)> = Vec::new();
        for (place, heading) in headings.iter().enumerate() {
            let mut read = ReadColumn {
                number: place + 1,
                heading: heading.clone(),
                column: None,
                unit: None,
                negated: false,
                by_hand: false,
            };
            if let Some(candidate) = candidate(place, heading, named) {
                let column = candidate.column;
                let below = units
                    .get(place)
                    .map(|unit| without_brackets(unit).to_owned());
                let unit = candidate.unit.or(below.filter(|unit| !unit.is_empty()));
                let scale = match &unit {
                    _ if column == Column::Branch => Ok(None),
                    Some(unit) => Scale::of(column, unit).map(Some),
                    None => Err(format!(
                        "no unit: write it into the heading, as \"{heading} [{unit}]\", into a row below the headings, or \
                         name the column by hand: {}=\"{heading} [{unit}]\"",
                        column.quantity(),
                        unit = example_unit(column)
                    )),
                };
                match scale {
                    Ok(scale) => {
                        used.push(Used {
                            place,
                            column,
                            scale,
                            negated: candidate.negated,
                            is_strict: candidate.by_hand || heading == "branch",
                        });
                        read.column = Some(column);
                        read.unit = unit.filter(|_| column != Column::Branch);
                        read.negated = candidate.negated;
                        read.by_hand = candidate.by_hand;
                    }
                    Err(problem) => problems.push((column, place, fail(heading, problem))),
                }
            }
            columns.push(read);
        }
        // If two columns have the same quantity, the one with a suitable unit is used. Time without a unit
        // is not used.
        for (column, _, problem) in problems {
            let has_other = used.iter().any(|used| used.column == column);
            if !has_other && column != Column::Time {
                return Err(problem);
            }
        }
        for (number, one) in used.iter().enumerate() {
            let Some(other) = used[..number]
                .iter()
                .find(|other| other.column == one.column)
            else {
                continue;
            };
            let (first, second) = (&headings[other.place], &headings[one.place]);
            if first == second {
                return Err(fail(second, "is there twice".to_owned()));
            }
            let quantity = one.column.quantity();
            let problem = format!(
                "\"{first}\" could be the {quantity} too: say which one is, as {quantity}=\"{second}\""
            );
            return Err(fail(second, problem));
        }
        Ok(Heading {
            layout: Layout {
                separator: None,
                decimal_comma: false,
                heading_line: line,
                columns,
            },
            used,
        })
    }

    /// Headings of arrays, each with its values; headings that are not recognised have none.
    pub(super) fn arrays(
        &self,
        named_values: &[(String, Option<Vec<f64>>)],
        named: &[NamedColumn],
    ) -> Result<Arrays, DataError> {
        let headings: Vec<String> = named_values.iter().map(|(name, _)| name.clone()).collect();
        let heading = self.heading(&headings, &[], None, named)?;
        let mut columns = Vec::new();
        for used in &heading.used {
            let (name, values) = &named_values[used.place];
            let Some(values) = values else {
                return Err(self.fail(None, Some(name), "give a column of numbers"));
            };
            let sign = if used.negated { -1.0 } else { 1.0 };
            let si = |value: &f64| match &used.scale {
                Some(Scale::Factor(factor)) => sign * factor * value,
                Some(scale) if value.is_finite() => {
                    sign * scale.value(&format!("{value:e}")).unwrap_or(f64::NAN)
                }
                _ => sign * value,
            };
            columns.push((used.column, values.iter().map(si).collect()));
        }
        Ok((heading.layout, columns))
    }

    /// The table of a file.
    pub(super) fn table(&self, bytes: &[u8], named: &[NamedColumn]) -> Result<Table, DataError> {
        let text = self.text(bytes)?;
        let text = if text.contains('\n') {
            text
        } else {
            Cow::Owned(text.replace('\r', "\n"))
        };
        let lines: Vec<&str> = text
            .split('\n')
            .map(|line| line.trim_end_matches('\r'))
            .collect();
        let place = self.find_heading(&lines, named)?;
        let Place {
            separator,
            line,
            first,
            headings,
        } = place;
        let mut first = first;
        let units = unit_row(&lines, first, separator, &headings, named);
        if let Some((after, _)) = &units {
            first = *after;
        }
        let units = units.map_or(Vec::new(), |(_, units)| units);
        let number = |line: usize| line as u64 + 1;
        let mut heading = self.heading(&headings, &units, line.map(number), named)?;
        heading.layout.separator = Some(separator);
        let mut rows = Rows::default();
        for (index, text) in lines.iter().enumerate().skip(first) {
            if text.trim().is_empty() || is_comment(text, separator, headings.len()) {
                continue;
            }
            let mut cells = cells(text, separator);
            while cells.len() > headings.len() && cells.last().is_some_and(String::is_empty) {
                cells.pop();
            }
            let is_again = cells == headings || (!units.is_empty() && cells == units);
            let mut full = cells.iter().filter(|cell| !cell.is_empty());
            let only = full.next().filter(|_| full.next().is_none());
            if is_again {
                continue;
            }
            if let Some(branch) = only.and_then(|cell| branch_of(cell)) {
                rows.label = Some(branch);
                continue;
            }
            self.row(
                number(index),
                &cells,
                &headings,
                separator,
                &mut heading,
                &mut rows,
            )?;
        }
        if let (Some((line, column, text)), true) = (&rows.comma, rows.has_point) {
            let problem = format!(
                "\"{text}\" has a comma where other numbers have a decimal point: write all of them alike, without separators of thousands"
            );
            return Err(self.fail(Some(*line), Some(column), problem));
        }
        heading.layout.decimal_comma = rows.comma.is_some();
        let mut columns: Vec<Column> = heading.used.iter().map(|used| used.column).collect();
        if rows.label.is_some() && !columns.contains(&Column::Branch) {
            columns.push(Column::Branch);
        }
        Ok((heading.layout, columns, rows.rows))
    }

    fn text<'a>(&self, bytes: &'a [u8]) -> Result<Cow<'a, str>, DataError> {
        let wide = |bytes: &[u8], join: fn([u8; 2]) -> u16| {
            let units = bytes.chunks_exact(2).map(|pair| join([pair[0], pair[1]]));
            char::decode_utf16(units).collect::<Result<String, _>>()
        };
        let decoded = match bytes {
            [0xff, 0xfe, rest @ ..] => wide(rest, u16::from_le_bytes),
            [0xfe, 0xff, rest @ ..] => wide(rest, u16::from_be_bytes),
            _ if bytes.contains(&0) => return Err(self.fail(None, None, "is no text")),
            _ => {
                let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
                return Ok(match std::str::from_utf8(bytes) {
                    Ok(text) => Cow::Borrowed(text),
                    // The bytes of Latin-1 are the first characters of Unicode.
                    Err(_) => Cow::Owned(bytes.iter().map(|byte| char::from(*byte)).collect()),
                });
            }
        };
        decoded
            .map(Cow::Owned)
            .map_err(|_| self.fail(None, None, "is no text"))
    }

    /// Finds the line of the headings and the separator for which most columns are recognised.
    fn find_heading(&self, lines: &[&str], named: &[NamedColumn]) -> Result<Place, DataError> {
        /// Number of lines in which headings are searched for.
        const MOST_LINES: usize = 1000;
        if !named.is_empty() && named.iter().all(NamedColumn::is_by_number) {
            return self.by_numbers(lines, named);
        }
        let mut best: Option<(usize, Place)> = None;
        // Headings in a comment are used if there are no others, and headings of a single column likewise.
        for (commented, least) in [(false, 2), (true, 2), (false, 1)] {
            for separator in SEPARATORS {
                let found = lines
                    .iter()
                    .take(MOST_LINES)
                    .enumerate()
                    .find_map(|(index, line)| {
                        let text = match (commented, comment(line)) {
                            (true, Some(text)) => text,
                            (true, None) => return None,
                            (false, _) if is_comment(line, separator, 0) => return None,
                            (false, _) => line,
                        };
                        let mut headings = cells(text, separator);
                        while headings.last().is_some_and(String::is_empty) {
                            headings.pop();
                        }
                        let known = headings.iter().enumerate();
                        let known = known
                            .filter(|(place, heading)| candidate(*place, heading, named).is_some())
                            .count();
                        (known >= least).then_some((
                            known,
                            Place {
                                separator,
                                line: Some(index),
                                first: index + 1,
                                headings,
                            },
                        ))
                    });
                let known = best.as_ref().map_or(0, |(known, _)| *known);
                best = found.filter(|(more, _)| *more > known).or(best);
            }
            if let Some((_, place)) = best.take() {
                return Ok(place);
            }
        }
        let quantities = Column::ALL.map(Column::name).join(", ");
        let mut texts = lines.iter().enumerate();
        let texts = texts.find(|(_, line)| !line.trim().is_empty() && comment(line).is_none());
        let Some((index, line)) = texts else {
            let problem =
                format!("no heading: a line that names the columns, such as {quantities}");
            return Err(self.fail(None, None, problem));
        };
        let numbers = SEPARATORS.map(|separator| cells(line, separator));
        let number = numbers
            .iter()
            .rev()
            .flatten()
            .find(|cell| number(cell).is_some());
        if let Some(cell) = number {
            let problem = "a number in the heading: the first line names the columns, or name them by hand by their numbers, as force=\"#2 [mN]\"";
            return Err(self.fail(Some(index as u64 + 1), Some(cell), problem));
        }
        let headings = numbers.into_iter().max_by_key(Vec::len).unwrap_or_default();
        let problem = format!(
            "no column is understood of {}; known are {quantities}, in other units too; or name them by hand, as force=\"HEADING [mN]\"",
            quoted(&headings),
        );
        Err(self.fail(Some(index as u64 + 1), None, problem))
    }

    /// Columns that are named by their numbers: the rows begin where the cells of these columns are
    /// numbers.
    fn by_numbers(&self, lines: &[&str], named: &[NamedColumn]) -> Result<Place, DataError> {
        for separator in SEPARATORS {
            let found = lines.iter().enumerate().find_map(|(index, line)| {
                let cells = cells(line, separator);
                let is_row = named.iter().all(|named| {
                    let mut found = cells.iter().enumerate();
                    found.any(|(place, cell)| {
                        named.matches(place, cell).is_some()
                            && (number(cell).is_some() || branch_of(cell).is_some())
                    })
                });
                is_row.then_some((index, cells))
            });
            if let Some((index, cells)) = found {
                // The previous line may contain headings, if it has as many columns.
                let before = index
                    .checked_sub(1)
                    .map(|line| self::cells(lines[line], separator));
                let before = before.filter(|before| before.len() == cells.len());
                let is_heading = before.is_some();
                let numbers = (1..=cells.len()).map(|number| format!("#{number}"));
                return Ok(Place {
                    separator,
                    line: index.checked_sub(1).filter(|_| is_heading),
                    first: index,
                    headings: before.unwrap_or_else(|| numbers.collect()),
                });
            }
        }
        let numbers: Vec<&str> = named.iter().map(|named| &named.heading[..]).collect();
        let problem = format!("no row with numbers in the columns {}", numbers.join(", "));
        Err(self.fail(None, None, problem))
    }

    fn row(
        &self,
        line: u64,
        cells: &[String],
        headings: &[String],
        separator: char,
        heading: &mut Heading,
        rows: &mut Rows,
    ) -> Result<(), DataError> {
        if cells.len() != headings.len() {
            let mut problem = format!(
                "{} cells, but {} in the heading",
                cells.len(),
                headings.len()
            );
            let are_whole = || cells.iter().all(|cell| !cell.contains('.'));
            if separator == ',' && cells.len() > headings.len() && are_whole() {
                problem +=
                    ": if numbers have decimal commas, separate the columns by semicolons or tabs";
            }
            return Err(self.fail(Some(line), None, problem));
        }
        let mut values = RowValues::new();
        let mut dropped = None;
        for used in &heading.used {
            let text = &cells[used.place];
            let name = &headings[used.place];
            if text.is_empty() {
                continue;
            }
            let value = if used.column == Column::Branch {
                match branch_of(text) {
                    Some(branch) => f64::from(u8::from(branch == Branch::Unloading)),
                    None if used.is_strict => {
                        let problem = format!("\"{text}\" is no branch: give loading or unloading");
                        return Err(self.fail(Some(line), Some(name), problem));
                    }
                    None => {
                        dropped = Some(used.place);
                        continue;
                    }
                }
            } else {
                let Some(plain) = number(text) else {
                    let problem =
                        format!("\"{text}\" is no number: give one like 1.2e-5, without unit");
                    return Err(self.fail(Some(line), Some(name), problem));
                };
                if text.contains(',') {
                    let place = || (line, name.clone(), text.clone());
                    rows.comma.get_or_insert_with(place);
                }
                rows.has_point |= text.contains('.');
                let scaled = used.scale.as_ref().and_then(|scale| scale.value(&plain));
                scaled.unwrap_or(f64::NAN)
            };
            values.push((used.column, if used.negated { -value } else { value }));
        }
        if let Some(place) = dropped {
            // Segments with numbers or other names: the branches follow from the motion.
            heading.used.retain(|used| used.place != place);
            heading.layout.columns[place].column = None;
            for (_, values) in &mut rows.rows {
                values.retain(|(column, _)| *column != Column::Branch);
            }
        }
        if let Some(branch) = rows.label
            && values.iter().all(|(column, _)| *column != Column::Branch)
        {
            values.push((
                Column::Branch,
                f64::from(u8::from(branch == Branch::Unloading)),
            ));
        }
        rows.rows.push((line, values));
        Ok(())
    }
}

/// The rows of a file.
#[derive(Default)]
struct Rows {
    rows: Vec<(u64, RowValues)>,
    /// Branch that a line between the rows named.
    label: Option<Branch>,
    /// The first number with a comma: line, column and text.
    comma: Option<(u64, String, String)>,
    has_point: bool,
}

/// Where the headings are.
struct Place {
    separator: char,
    line: Option<usize>,
    /// The first line that may be a row.
    first: usize,
    headings: Vec<String>,
}

/// Possible separators of columns, the most reliable first.
const SEPARATORS: [char; 3] = ['\t', ';', ','];

/// A row of units below the headings, and the line after it.
fn unit_row(
    lines: &[&str],
    first: usize,
    separator: char,
    headings: &[String],
    named: &[NamedColumn],
) -> Option<(usize, Vec<String>)> {
    let mut following = lines.iter().enumerate().skip(first);
    let (index, line) = following.find(|(_, line)| !line.trim().is_empty())?;
    let units = cells(comment(line).unwrap_or(line), separator);
    let is_plain = units.iter().all(|cell| number(cell).is_none());
    let of_used = |(place, unit): (usize, &String)| {
        let heading = headings.get(place)?;
        candidate(place, heading, named)?;
        Some(is_unit(without_brackets(unit)))
    };
    let is_there = units.iter().enumerate().filter_map(of_used).any(|is| is);
    (is_plain && is_there).then_some((index + 1, units))
}

/// Cells of a line, with or without quotes, trimmed.
fn cells(line: &str, separator: char) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut is_quoted = false;
    let mut characters = line.chars().peekable();
    while let Some(character) = characters.next() {
        let cell = cells.len() - 1;
        let begins = cells[cell].trim().is_empty();
        match character {
            '"' if is_quoted && characters.peek() == Some(&'"') => {
                characters.next();
                cells[cell].push('"');
            }
            '"' if is_quoted => is_quoted = false,
            '"' if begins => is_quoted = true,
            _ if character == separator && !is_quoted => cells.push(String::new()),
            _ => cells[cell].push(character),
        }
    }
    cells.iter().map(|cell| cell.trim().to_owned()).collect()
}

/// Text of a comment.
fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let marks = ["#", "%", "//", "!", ";"];
    marks.into_iter().find_map(|mark| line.strip_prefix(mark))
}

/// Whether a line is a comment. A line that begins with a semicolon may also be a row whose first cell
/// is empty.
fn is_comment(line: &str, separator: char, columns: usize) -> bool {
    let is_row = separator == ';'
        && line.trim_start().starts_with(';')
        && cells(line, separator).len() == columns;
    comment(line).is_some() && !is_row
}

/// Converts a number to the notation of Rust: decimal point and ASCII minus sign.
fn number(text: &str) -> Option<String> {
    let plain = text.replace('\u{2212}', "-");
    let commas = plain.matches(',').count();
    let plain = match commas {
        1 if !plain.contains('.') => plain.replace(',', "."),
        _ => plain,
    };
    plain.parse::<f64>().is_ok().then_some(plain)
}

fn quoted(headings: &[String]) -> String {
    let quoted: Vec<String> = headings
        .iter()
        .map(|heading| format!("\"{heading}\""))
        .collect();
    quoted.join(", ")
}

impl Layout {
    /// Interpretation of every column, one line each: `force: column 2 "Load [mN]", in mN`.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let of = |read: &ReadColumn| {
            let place = if read.heading.starts_with('#') {
                format!("column {}", read.number)
            } else {
                format!("column {} \"{}\"", read.number, read.heading)
            };
            let Some(column) = read.column else {
                return format!("not used: {place}");
            };
            let unit = read
                .unit
                .as_ref()
                .map_or(String::new(), |unit| format!(", in {unit}"));
            let sign = if read.negated {
                ", with the opposite sign"
            } else {
                ""
            };
            let hand = if read.by_hand { ", named by hand" } else { "" };
            format!("{}: {place}{unit}{sign}{hand}", column.quantity())
        };
        self.columns.iter().map(of).collect()
    }

    /// Columns found, for an error message: `seen were "Zeit [s]" as time, and "Kanal 2", not
    /// understood`.
    pub(super) fn seen(&self) -> String {
        let of = |read: &ReadColumn| match read.column {
            Some(column) => format!("\"{}\" as {}", read.heading, column.quantity()),
            None => format!("\"{}\", not understood", read.heading),
        };
        let seen: Vec<String> = self.columns.iter().map(of).collect();
        seen.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_of_instruments() {
        for (heading, quantity, unit) in [
            ("displacement_um", "displacement", "um"),
            ("Load [mN]", "force", "mN"),
            ("Force (mN)", "force", "mN"),
            ("F / mN", "force", "mN"),
            ("Fz, uN", "force", "uN"),
            ("Z Position (\u{b5}m)", "displacement", "\u{b5}m"),
            ("Load On Sample (uN)", "", ""),
            ("ContactRadius_um", "contact_radius", "um"),
            ("Contact radius [mm]", "contact_radius", "mm"),
            ("Crosshead load N", "force", "N"),
            ("Crosshead (mm)", "displacement", "mm"),
            ("Indentation depth (nm)", "indentation", "nm"),
            ("Force error [mN]", "force_error", "mN"),
            ("force_error_N", "force_error", "N"),
            ("Time (s)", "time", "s"),
            ("Normal Force (raw) [mN]", "force", "mN"),
            ("Friction force [mN]", "", ""),
            ("Lens radius [mm]", "", ""),
            ("Force setpoint [mN]", "", ""),
        ] {
            let (name, found) = split_unit(heading);
            let column = quantity_of(&name);
            assert_eq!(column.map_or("", Column::quantity), quantity, "{heading}");
            if column.is_some() {
                assert_eq!(found.as_deref(), Some(unit), "{heading}");
            }
        }
    }

    #[test]
    fn numbers_are_rounded_once() {
        let scale = Scale::of(Column::Displacement, "um").unwrap();
        assert_eq!(scale.value("2.65").unwrap().to_bits(), 2.65e-6f64.to_bits());
        // 1 cm = 10 mm, 1 pN = 1e-3 nN.
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-15;
        assert!(close(
            Scale::of(Column::Displacement, "cm")
                .unwrap()
                .value("3")
                .unwrap(),
            0.03
        ));
        assert!(close(
            Scale::of(Column::Force, "pN").unwrap().value("5").unwrap(),
            5e-12
        ));
        assert!(close(
            Scale::of(Column::Time, "min").unwrap().value("2").unwrap(),
            120.0
        ));
    }

    #[test]
    fn cells_in_quotes() {
        assert_eq!(cells("\"a,b\", c ,\"d\"\"e\"", ','), ["a,b", "c", "d\"e"]);
        assert_eq!(cells("1;;3;", ';'), ["1", "", "3", ""]);
        assert_eq!(number("\u{2212}1,5").as_deref(), Some("-1.5"));
        assert_eq!(number("1.234,5"), None);
    }
}
