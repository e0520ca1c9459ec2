//! Notations of numbers in tables: decimal points, decimal commas, and separators of thousands.

use std::fmt;

/// How the numbers of a file are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Notation {
    /// Each number by itself: a comma without a point is a decimal comma.
    #[default]
    Single,
    /// Decimal points; commas separate thousands.
    Point,
    /// Decimal commas; points separate thousands.
    Comma,
}

/// Notation of a file, if a single number determines it.
#[derive(Debug, Default)]
pub struct Evidence {
    point: bool,
    comma: bool,
    has_quotes: bool,
}

impl Evidence {
    /// Takes a line, whose numbers may be in quotes.
    pub fn add_line(&mut self, line: &str) {
        self.has_quotes |= line.contains('"');
    }

    /// Takes what a number shows.
    pub fn add(&mut self, text: &str) {
        let text = without_blanks(text);
        let [commas, points] = [',', '.'].map(|mark| text.matches(mark).count());
        match (commas, points) {
            (0, 0) => {}
            (0, 1) => self.point |= !is_grouped(&text, '.'),
            (0, _) => self.comma |= is_grouped(&text, '.'),
            // `1,234` alone may be either.
            (1, 0) if is_grouped(&text, ',') => {}
            (1, 0) => self.comma = true,
            (_, 0) => self.point |= is_grouped(&text, ','),
            _ => match text.rfind(',') > text.rfind('.') {
                true => self.comma = true,
                false => self.point = true,
            },
        }
    }

    /// Whether a number shows which mark is the decimal one.
    #[must_use]
    pub fn is_decided(&self) -> bool {
        self.point || self.comma
    }

    /// Whether numbers have decimal points.
    #[must_use]
    pub fn has_points(&self) -> bool {
        self.point
    }

    /// The notation of a file with these columns. One decimal mark decides: the other mark then separates thousands.
    ///
    /// # Errors
    /// The column whose numbers may be either, if nothing decides.
    pub fn notation(&self, columns: &[Marks], separator: char) -> Result<Reading, Doubt> {
        match (self.point, self.comma) {
            (true, false) => Ok(Reading::sure(Notation::Point)),
            (false, true) => Ok(Reading::sure(Notation::Comma)),
            // Between commas the points are decimal, as decimal commas would need quotes.
            (false, false)
                if separator == ',' && !self.has_quotes && !columns.iter().any(|it| it.commas) =>
            {
                Ok(Reading::sure(Notation::Single))
            }
            (false, false) => undecided(columns, separator),
            _ => Ok(Reading::sure(Notation::Single)),
        }
    }
}

/// How the numbers of a file are read.
#[derive(Debug, PartialEq, Eq)]
pub struct Reading {
    /// Their notation.
    pub notation: Notation,
    /// Whether another notation is possible, but unusual.
    pub is_assumed: bool,
}

impl Reading {
    fn sure(notation: Notation) -> Self {
        Self {
            notation,
            is_assumed: false,
        }
    }
}

/// A column whose numbers may have decimal marks or separators of thousands: its place among those that were given.
#[derive(Debug, PartialEq, Eq)]
pub struct Doubt(pub usize);

/// A number with one mark before three digits. As text: `"1,024" may be 1.024 or 1024`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Ambiguous {
    /// Its line, as it was given.
    pub line: u64,
    /// As it is written.
    pub text: String,
}

impl Ambiguous {
    /// The number if the mark is a decimal one.
    #[must_use]
    pub fn decimal(&self) -> String {
        self.text.replace(',', ".")
    }

    /// The number if the mark separates thousands.
    #[must_use]
    pub fn whole(&self) -> String {
        self.text.replace([',', '.'], "")
    }
}

impl fmt::Display for Ambiguous {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (decimal, whole) = (self.decimal(), self.whole());
        write!(f, "\"{}\" may be {decimal} or {whole}", self.text)
    }
}

/// Numbers of a column some of which have one mark before three digits, such as `1,024`: a decimal mark, or a separator of thousands.
#[derive(Debug, Default)]
pub struct Marks {
    /// The column is a time, which is often counted in whole numbers.
    is_time: bool,
    /// The first such number.
    first: Option<Ambiguous>,
    commas: bool,
    points: bool,
    /// The largest whole number without a mark.
    largest_plain: f64,
    /// Changes between rows with decimal marks, and with separators of thousands.
    steps: [Steps; 2],
}

impl Marks {
    /// Of a column, which may be a time.
    #[must_use]
    pub fn new(is_time: bool) -> Self {
        Self {
            is_time,
            ..Self::default()
        }
    }

    /// Takes a number, with its line.
    pub fn add(&mut self, line: u64, text: &str) {
        let plain = without_blanks(text);
        let of = |text: &str| number(text, Notation::Single)?.parse::<f64>().ok();
        let Some(decimal) = of(&plain).filter(|value| value.is_finite()) else {
            return;
        };
        let is_mark = |mark: &char| plain.matches(*mark).count() == 1 && is_grouped(&plain, *mark);
        let mark = [',', '.'].into_iter().find(is_mark);
        if mark.is_none() && !plain.contains(|c: char| !c.is_ascii_digit() && c != '-' && c != '+')
        {
            self.largest_plain = self.largest_plain.max(decimal.abs());
        }
        self.commas |= mark == Some(',');
        self.points |= mark == Some('.');
        let whole = mark.map_or(decimal, |_| 1000.0 * decimal);
        if mark.is_some() {
            self.first.get_or_insert_with(|| Ambiguous {
                line,
                text: text.to_owned(),
            });
        }
        self.steps[0].add(decimal);
        self.steps[1].add(whole);
    }

    /// The first number in doubt.
    #[must_use]
    pub fn doubtful(&self) -> Option<Ambiguous> {
        self.first.clone()
    }

    /// Whether there are whole numbers other than 0 below 1000, and none above it.
    #[must_use]
    pub fn has_plain_below_thousand(&self) -> bool {
        (1.0..1000.0).contains(&self.largest_plain)
    }

    /// Whether the marks separate thousands, if the column shows it: whole numbers from 1000 on have no mark, or the numbers jump in one of the
    /// notations alone, as from 923 to 1.024.
    fn are_thousands(&self) -> Option<bool> {
        /// Ratio of the largest changes that decides.
        const JUMP: f64 = 2.0;
        let [decimal, thousands] = [0, 1].map(|k: usize| self.steps[k].largest_part());
        match () {
            () if self.largest_plain >= 1000.0 => Some(false),
            () if !self.has_plain_below_thousand() => None,
            () if decimal >= JUMP * thousands => Some(true),
            () if thousands >= JUMP * decimal => Some(false),
            () => None,
        }
    }

    /// Whether the numbers would jump with decimal points.
    fn jumps(&self) -> bool {
        self.has_plain_below_thousand()
            && self.largest_plain >= 100.0
            && self.steps[0].largest_part() > 0.5
    }
}

/// Changes between the rows of a column.
#[derive(Debug, Default)]
struct Steps {
    last: Option<f64>,
    least: f64,
    most: f64,
    largest: f64,
}

impl Steps {
    fn add(&mut self, value: f64) {
        match self.last {
            None => (self.least, self.most) = (value, value),
            Some(last) => {
                self.least = self.least.min(value);
                self.most = self.most.max(value);
                self.largest = self.largest.max((value - last).abs());
            }
        }
        self.last = Some(value);
    }

    /// The largest change, as a fraction of the range.
    fn largest_part(&self) -> f64 {
        match self.most - self.least {
            range if range > 0.0 => self.largest / range,
            _ => 0.0,
        }
    }
}

/// The notation of a file no number of which decides it: every number with a mark has three digits behind it.
///
/// Decimal points are usual, and so are decimal commas where commas do not separate the columns: then numbers that all have marks, or whole
/// numbers from 1000 on without one, are read with them.
fn undecided(columns: &[Marks], separator: char) -> Result<Reading, Doubt> {
    let has = |mark: fn(&Marks) -> bool| columns.iter().position(mark);
    let (commas, points) = (has(|column| column.commas), has(|column| column.points));
    let shows = |wanted: bool| {
        let mut marked = columns.iter();
        marked.position(|column| column.first.is_some() && column.are_thousands() == Some(wanted))
    };
    let single = |is_assumed| {
        Ok(Reading {
            notation: Notation::Single,
            is_assumed,
        })
    };
    match (commas, points, shows(true), shows(false)) {
        // Rows with both marks are refused one by one.
        (Some(_), Some(_), _, _) | (None, None, _, _) => single(false),
        (_, _, Some(column), Some(_)) => Err(Doubt(column)),
        (Some(_), _, Some(_), None) => Ok(Reading::sure(Notation::Point)),
        (None, _, Some(_), None) => Ok(Reading::sure(Notation::Comma)),
        (_, _, None, Some(_)) => single(false),
        (None, Some(_), None, None) => has(Marks::jumps).map_or(single(false), |it| Err(Doubt(it))),
        (Some(column), None, None, None) => {
            let mut others = columns.iter().filter(|column| !column.is_time);
            let is_usual = others.clone().any(|column| column.largest_plain >= 1000.0)
                || !others.any(Marks::has_plain_below_thousand);
            match is_usual && separator != ',' {
                true => single(true),
                false => Err(Doubt(column)),
            }
        }
    }
}

/// Whether a number has groups of three digits that are separated by `mark`, as `-1,234,567`; a fraction may follow.
fn is_grouped(text: &str, mark: char) -> bool {
    let other = if mark == ',' { '.' } else { ',' };
    let text = text.trim_start_matches(['-', '+', '\u{2212}']);
    let whole = text.split_once(other).map_or(text, |(whole, _)| whole);
    let mut groups = whole.split(mark);
    let is_digits = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    let first = groups.next().unwrap_or_default();
    let is_first = (1..=3).contains(&first.len()) && is_digits(first) && !first.starts_with('0');
    is_first && groups.all(|group| group.len() == 3 && is_digits(group))
}

/// A number without blanks and apostrophes between its thousands.
fn without_blanks(text: &str) -> String {
    const BETWEEN: [char; 6] = [' ', '\u{a0}', '\u{2009}', '\u{202f}', '\'', '\u{2019}'];
    let text = text.trim();
    if !text.contains(BETWEEN) {
        return text.to_owned();
    }
    let commas = text.replace(BETWEEN, ",");
    let whole = commas
        .rsplit_once('.')
        .map_or(&commas[..], |(whole, _)| whole);
    match is_grouped(whole, ',') || is_grouped(&text.replace(BETWEEN, "."), '.') {
        true => text.replace(BETWEEN, ""),
        false => text.to_owned(),
    }
}

/// Converts a number to the notation of Rust: decimal point and ASCII minus sign.
#[must_use]
pub fn number(text: &str, notation: Notation) -> Option<String> {
    // Most numbers of most files: nothing to convert. With decimal commas a point may separate thousands.
    if is_plain_number(text) && !(notation == Notation::Comma && text.contains('.')) {
        return Some(text.to_owned());
    }
    let plain = without_blanks(text).replace('\u{2212}', "-");
    let commas = plain.matches(',').count();
    let plain = match notation {
        Notation::Point if commas > 0 => match is_grouped(&plain, ',') {
            true => plain.replace(',', ""),
            false => return None,
        },
        Notation::Comma if plain.contains('.') => match is_grouped(&plain, '.') {
            true => plain.replace('.', "").replace(',', "."),
            false => return None,
        },
        _ if commas == 1 && !plain.contains('.') => plain.replace(',', "."),
        _ => plain,
    };
    // Fortran writes exponents of double precision with D.
    let plain = match plain.split_once(['D', 'd']) {
        Some((digits, exponent)) => format!("{digits}e{exponent}"),
        None => plain,
    };
    plain.parse::<f64>().is_ok().then_some(plain)
}

/// The number of a text by itself ([`Notation::Single`]).
pub(crate) fn single(text: &str) -> Option<f64> {
    let plain = text.parse().ok().filter(|value: &f64| value.is_finite());
    plain.or_else(|| number(text, Notation::Single)?.parse().ok())
}

/// Whether a text is a number in any notation.
#[must_use]
pub fn is_number(text: &str) -> bool {
    let value = |notation| number(text, notation)?.parse::<f64>().ok();
    let notations = [Notation::Single, Notation::Point, Notation::Comma];
    let mut values = notations.into_iter().filter_map(value);
    is_plain_number(text) || values.any(|value| !value.is_nan())
}

/// Whether a text is a number as Rust writes it.
fn is_plain_number(text: &str) -> bool {
    text.parse::<f64>().is_ok_and(f64::is_finite)
}

/// Texts of cells that stand for a value that was not measured, in lower case. A row of asterisks does too.
const NOT_MEASURED: [&str; 13] = [
    "", "na", "n/a", "-", "--", "---", "bad", "null", "none", "?", "missing", "no data", "nodata",
];

/// Texts of numbers that are none, without their sign and without zeros behind them, as the libraries of C write them.
const NO_NUMBERS: [&str; 5] = ["nan", "nan(ind)", "nan(snan)", "1.#ind", "1.#qnan"];

/// Errors of formulas in spreadsheets, in English and German.
const FORMULA_ERRORS: [&str; 11] = [
    "#N/A", "#DIV/0!", "#VALUE!", "#REF!", "#NAME?", "#NUM!", "#NULL!", "#NV", "#WERT!", "#BEZUG!",
    "#ZAHL!",
];

/// Whether a cell stands for a value that was not measured.
#[must_use]
pub fn is_not_measured(text: &str) -> bool {
    let lower = text.trim().to_lowercase();
    let unsigned = lower.strip_prefix(['-', '+']).unwrap_or(&lower);
    // With the exponent of a number: `1.#QNAN0e+000`.
    let unsigned = match unsigned.split_once("e+") {
        Some((text, _)) if text.contains('#') => text,
        _ => unsigned,
    };
    NOT_MEASURED.contains(&&lower[..])
        || lower.bytes().all(|byte| byte == b'*')
        || NO_NUMBERS.contains(&unsigned.trim_end_matches('0'))
        || is_formula_error(&lower)
}

/// Whether a text is an error of a formula.
#[must_use]
pub fn is_formula_error(text: &str) -> bool {
    let mut errors = FORMULA_ERRORS.iter();
    errors.any(|error| error.eq_ignore_ascii_case(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_missing_values() {
        for text in [
            "-1.#IND",
            "1.#QNAN0",
            "-1.#IND00e+000",
            "***",
            "No Data",
            "N/A",
            "null",
            "#N/A",
            "",
        ] {
            assert!(is_not_measured(text), "{text}");
        }
        assert!(!is_not_measured("1.#INF") && !is_not_measured("0") && !is_not_measured("nan1"));
    }

    #[test]
    fn notations_of_files() {
        let read = |texts: &[&str]| -> Vec<Option<String>> {
            let mut evidence = Evidence::default();
            texts.iter().for_each(|text| evidence.add(text));
            let notation = evidence.notation(&[], ';').unwrap().notation;
            texts.iter().map(|text| number(text, notation)).collect()
        };
        let some = |texts: &[&str]| -> Vec<Option<String>> {
            texts.iter().map(|text| Some((*text).to_owned())).collect()
        };
        assert_eq!(
            read(&["1,234.5", "2,345", "0.5"]),
            some(&["1234.5", "2345", "0.5"])
        );
        assert_eq!(
            read(&["1.234,5", "2.345", "0,5"]),
            some(&["1234.5", "2345", "0.5"])
        );
        assert_eq!(read(&["1,234,567", "1,000"]), some(&["1234567", "1000"]));
        assert_eq!(read(&["1.234", "0,5"]), some(&["1234", "0.5"]));
        // A single comma is a decimal comma as long as no number has a point.
        assert_eq!(read(&["1,234", "2,5"]), some(&["1.234", "2.5"]));
        assert_eq!(read(&["1,5", "2.5"]), some(&["1.5", "2.5"]));
    }
}
