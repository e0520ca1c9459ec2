//! The interpretation of a file, and the hints of the user.

use super::column::{Column, DataError};
use super::heading::split_unit;
use super::units::{example_unit, is_unit, sensitivity};
use fakir::state::Branch;

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

impl ReadColumn {
    /// Whether its heading is the name of a quantity with a unit, `force_mN`, which defines the sign of its values.
    pub(super) fn is_canonical(&self) -> bool {
        self.column.is_some_and(|column| {
            let rest = self.heading.strip_prefix(column.quantity());
            rest.and_then(|rest| rest.strip_prefix('_'))
                .is_some_and(is_unit)
        })
    }
}

/// Why rows were skipped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SkipReason {
    /// Nothing was measured: empty cells, `NaN`, `Bad`, `-`.
    NotMeasured,
    /// Text: markers between the rows, footers.
    Text,
    /// A pause between the branches.
    Pause,
    /// Not selected.
    NotSelected,
}

impl SkipReason {
    /// Its name in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NotMeasured => "not_measured",
            Self::Text => "text",
            Self::Pause => "pause",
            Self::NotSelected => "not_selected",
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::NotMeasured => "without a value",
            Self::Text => "of text",
            Self::Pause => "of a pause",
            Self::NotSelected => "not selected",
        }
    }
}

/// Rows that were skipped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Skipped {
    /// Why.
    pub reason: SkipReason,
    /// Their lines in the file, or their numbers, from 1.
    pub lines: Vec<u64>,
}

/// Interpretation of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Layout {
    /// Separator of the columns; a blank stands for any number of them; `None` for arrays.
    pub separator: Option<char>,
    /// Whether numbers have decimal commas.
    pub decimal_comma: bool,
    /// Line of the headings, from 1; `None` without headings.
    pub heading_line: Option<u64>,
    /// The columns, in the order of the file.
    pub columns: Vec<ReadColumn>,
    /// Rows that were skipped.
    pub skipped: Vec<Skipped>,
    /// What was detected in the data, in sentences.
    pub notes: Vec<String>,
    /// Whether the sign of position or force is that of an instrument, which the data show.
    pub(super) is_sign_open: bool,
    /// The first line that cannot be read, if rows before it are selected.
    pub(super) failure: Option<DataError>,
    /// Compliance of the cantilever whose deflection is the force, m/N; it belongs to the instrument if the position is that of its base.
    pub cantilever_compliance: Option<f64>,
}

impl Layout {
    /// Interpretation of every column, one line each: `force: column 2 "Load [mN]", in mN`; then rows that were skipped, and what was
    /// detected.
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
        let mut lines: Vec<String> = self.columns.iter().map(of).collect();
        lines.extend(self.remarks());
        lines
    }

    /// Rows that were skipped, and notes on how the file was read.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let skipped = self.skipped.iter().map(Skipped::words);
        skipped.chain(self.notes.iter().cloned()).collect()
    }

    /// Number of rows that were skipped.
    #[must_use]
    pub fn rows_skipped(&self) -> usize {
        self.skipped.iter().map(|skipped| skipped.lines.len()).sum()
    }

    /// Adds rows that were skipped.
    pub(super) fn skip(&mut self, reason: SkipReason, lines: Vec<u64>) {
        if lines.is_empty() {
            return;
        }
        match self.skipped.iter_mut().find(|it| it.reason == reason) {
            Some(skipped) => skipped.lines.extend(lines),
            None => self.skipped.push(Skipped { reason, lines }),
        }
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

impl Skipped {
    /// `skipped: 3 rows without a value (lines 5 to 9)`.
    fn words(&self) -> String {
        let rows = match self.lines.len() {
            1 => "1 row".to_owned(),
            count => format!("{count} rows"),
        };
        let place = match &self.lines[..] {
            [] => String::new(),
            [line] => format!(" (line {line})"),
            [first, .., last] => format!(" (lines {first} to {last})"),
        };
        format!("skipped: {rows} {}{place}", self.reason.words())
    }
}

/// Hints of the user about the columns of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Hints {
    /// Columns named by the user.
    pub named: Vec<NamedColumn>,
    /// Spring constant of the cantilever, N/m: a column of its deflection is then read as the force.
    pub spring_constant: Option<f64>,
    /// The last row that is used, from 1: rows below it may contain anything.
    pub last_row: Option<usize>,
    /// Whether rows of pauses between the branches are used, as with viscoelastic bodies.
    pub has_pauses: bool,
}

impl Hints {
    /// The hints for the columns of a branch.
    pub(super) fn of_branch(&self, branch: Branch) -> Self {
        let named = self.named.iter();
        let own = named.filter(|named| named.branch.is_none_or(|of| of == branch));
        Self {
            named: own.cloned().collect(),
            ..self.clone()
        }
    }
}

impl From<&[NamedColumn]> for Hints {
    fn from(named: &[NamedColumn]) -> Self {
        Self {
            named: named.to_vec(),
            ..Self::default()
        }
    }
}

/// A column named by the user: `force=Load [mN]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedColumn {
    /// Quantity of the column.
    pub column: Column,
    /// Its heading, with the unit if the file has none; or `#` and its number, from 1.
    pub heading: String,
    /// Whether the sign of its values is reversed: for a position that decreases as the lens moves down.
    pub negated: bool,
    /// Sensitivities by which its values are multiplied: `25 nN/V`.
    pub factors: Vec<String>,
    /// Whether it is the deflection of a cantilever, which its spring constant converts to the force.
    pub is_deflection: bool,
    /// The branch in its heading, if both branches are side by side.
    pub(super) branch: Option<Branch>,
}

/// The number and the unit of one count: `25 nm`, `25 nm/step`.
fn of_counts(factor: &str) -> Option<(String, String)> {
    const COUNTS: [&str; 8] = [
        "step", "count", "bit", "digit", "lsb", "pulse", "tick", "px",
    ];
    let factor = factor.trim();
    let of = match factor.rsplit_once('/') {
        Some((of, count)) => {
            let count = count.trim().to_lowercase();
            let count = count.strip_suffix('s').unwrap_or(&count);
            COUNTS.contains(&count).then_some(of)?
        }
        None => factor,
    };
    let (number, unit) = of.trim().split_once(' ')?;
    let is_known = number.parse::<f64>().is_ok() && is_unit(unit.trim());
    is_known.then(|| (number.to_owned(), unit.trim().to_owned()))
}

impl NamedColumn {
    /// Combines the name of a quantity and a heading; a minus sign before the heading reverses the sign of
    /// the values, and sensitivities after it convert them: `Deflection [V]*25 nN/V`. The quantity `deflection` is that of a
    /// cantilever.
    ///
    /// # Errors
    /// If there is no such quantity; the error lists the quantities that exist.
    pub fn new(quantity: &str, heading: &str) -> Result<Self, String> {
        let is_named = |column: &Column| column.quantity() == quantity || column.name() == quantity;
        let is_deflection = quantity == "deflection";
        let found = match is_deflection {
            true => Some(Column::Force),
            false => Column::ALL.into_iter().find(is_named),
        };
        let Some(column) = found else {
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
        let mut heading = heading;
        let mut factors = Vec::new();
        while let Some((before, factor)) = heading.rsplit_once('*')
            && sensitivity(factor).is_some()
            && of_counts(factor).is_none()
        {
            factors.insert(0, factor.trim().to_owned());
            heading = before.trim();
        }
        // A number of counts or steps.
        let of_counts = heading.rsplit_once('*').and_then(|(before, factor)| {
            let (number, unit) = of_counts(factor)?;
            Some((format!("{} [{unit}]", before.trim()), number))
        });
        if let Some((_, number)) = &of_counts {
            factors.insert(0, number.clone());
        }
        let heading = of_counts.as_ref().map_or(heading, |(heading, _)| heading);
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
            factors,
            is_deflection,
            branch: None,
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
    pub(super) fn matches(&self, place: usize, heading: &str) -> Option<Option<String>> {
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

    pub(super) fn is_by_number(&self) -> bool {
        self.heading.starts_with('#')
    }
}
