//! Cells of tables: their separators, and the notations of numbers.

pub(super) use fakir_case::table_text::cells;

/// Possible separators of columns, the most reliable first.
pub(super) const SEPARATORS: [char; 3] = ['\t', ';', ','];

/// Stands for any number of blanks between columns.
pub(super) const BLANKS: char = ' ';

/// Text of a comment.
pub(super) fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let marks = ["#", "%", "//", "!", ";"];
    let text = marks.into_iter().find_map(|mark| line.strip_prefix(mark))?;
    let first = line.split(['\t', ';', ',', ' ']).next().unwrap_or(line);
    (!is_formula_error(first)).then_some(text)
}

/// Whether a line is a comment. A line that begins with a semicolon may also be a row whose first cell
/// is empty.
pub(super) fn is_comment(line: &str, separator: char, columns: usize) -> bool {
    let is_row = separator == ';'
        && line.trim_start().starts_with(';')
        && cells(line, separator).len() == columns;
    comment(line).is_some() && !is_row
}

/// Texts of cells that stand for a value that was not measured, in lower case.
const NOT_MEASURED: [&str; 12] = [
    "", "na", "n/a", "-", "--", "---", "bad", "null", "none", "*", "?", "missing",
];

/// Texts of numbers that are none, without their sign, as the libraries of C write them.
const NO_NUMBERS: [&str; 5] = ["nan", "nan(ind)", "nan(snan)", "1.#ind", "1.#qnan"];

/// Errors of formulas in spreadsheets, in English and German.
const FORMULA_ERRORS: [&str; 11] = [
    "#N/A", "#DIV/0!", "#VALUE!", "#REF!", "#NAME?", "#NUM!", "#NULL!", "#NV", "#WERT!", "#BEZUG!",
    "#ZAHL!",
];

/// Whether a cell stands for a value that was not measured.
pub(super) fn is_not_measured(text: &str) -> bool {
    let lower = text.trim().to_lowercase();
    let unsigned = lower.strip_prefix(['-', '+']).unwrap_or(&lower);
    NOT_MEASURED.contains(&&lower[..]) || NO_NUMBERS.contains(&unsigned) || is_formula_error(&lower)
}

/// Whether a text is an error of a formula.
fn is_formula_error(text: &str) -> bool {
    let mut errors = FORMULA_ERRORS.iter();
    errors.any(|error| error.eq_ignore_ascii_case(text))
}

/// How the numbers of a file are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Notation {
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
pub(super) struct Evidence {
    point: bool,
    comma: bool,
    /// Points or commas that can only separate thousands.
    points_of_thousands: bool,
}

impl Evidence {
    pub(super) fn add(&mut self, text: &str) {
        let text = without_blanks(text);
        let [commas, points] = [',', '.'].map(|mark| text.matches(mark).count());
        match (commas, points) {
            (0, 0) => {}
            (0, 1) => self.point |= !is_grouped(&text, '.'),
            (0, _) => {
                self.comma |= is_grouped(&text, '.');
                self.points_of_thousands = true;
            }
            // `1,234` alone may be either.
            (1, 0) if is_grouped(&text, ',') => {}
            (1, 0) => self.comma = true,
            (_, 0) => self.point |= is_grouped(&text, ','),
            _ => match text.rfind(',') > text.rfind('.') {
                true => {
                    self.comma = true;
                    self.points_of_thousands = true;
                }
                false => self.point = true,
            },
        }
    }

    /// Whether a number shows which mark is the decimal one.
    pub(super) fn is_decided(&self) -> bool {
        self.point || self.comma
    }

    /// Whether numbers have decimal points.
    pub(super) fn has_points(&self) -> bool {
        self.point
    }

    /// The notation of a file with these columns.
    pub(super) fn notation(&self, columns: &[Marks], separator: char) -> Result<Reading, Doubt> {
        let has_thousands = || {
            let mut columns = columns.iter();
            self.points_of_thousands
                || columns.any(|column| column.points && column.has_plain_below_thousand())
        };
        match (self.point, self.comma) {
            (true, false) => Ok(Reading::sure(Notation::Point)),
            (false, true) if has_thousands() => Ok(Reading::sure(Notation::Comma)),
            (false, false) => undecided(columns, separator),
            _ => Ok(Reading::sure(Notation::Single)),
        }
    }
}

/// How the numbers of a file are read.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Reading {
    pub(super) notation: Notation,
    /// Whether another notation is possible, but unusual.
    pub(super) is_assumed: bool,
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
pub(super) struct Doubt(pub(super) usize);

/// Numbers of a column some of which have one mark before three digits, such as `1,024`: a decimal mark, or a separator of thousands.
#[derive(Debug, Default)]
pub(super) struct Marks {
    /// The column is a time, which is often counted in whole numbers.
    is_time: bool,
    /// The first such number, with its line.
    pub(super) first: Option<(u64, String)>,
    commas: bool,
    points: bool,
    /// The largest whole number without a mark.
    largest_plain: f64,
    /// Changes between rows with decimal marks, and with separators of thousands.
    steps: [Steps; 2],
}

impl Marks {
    pub(super) fn new(is_time: bool) -> Self {
        Self {
            is_time,
            ..Self::default()
        }
    }

    pub(super) fn add(&mut self, line: u64, text: &str) {
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
            self.first.get_or_insert_with(|| (line, text.to_owned()));
        }
        self.steps[0].add(decimal);
        self.steps[1].add(whole);
    }

    /// Whether there are whole numbers other than 0 below 1000, and none above it.
    pub(super) fn has_plain_below_thousand(&self) -> bool {
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
pub(super) fn number(text: &str, notation: Notation) -> Option<String> {
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

/// Whether a text is a number as Rust writes it.
fn is_plain_number(text: &str) -> bool {
    text.parse::<f64>().is_ok_and(f64::is_finite)
}

/// Whether a text is a number in any notation.
pub(super) fn is_number(text: &str) -> bool {
    if is_plain_number(text) {
        return true;
    }
    let notations = [Notation::Single, Notation::Point, Notation::Comma];
    notations
        .into_iter()
        .any(|notation| number(text, notation).is_some_and(|number| !is_not_measured(&number)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_in_quotes() {
        assert_eq!(cells("\"a,b\", c ,\"d\"\"e\"", ','), ["a,b", "c", "d\"e"]);
        assert_eq!(cells("1;;3;", ';'), ["1", "", "3", ""]);
        assert_eq!(cells("  1.0   2.0 \t3 ", ' '), ["1.0", "2.0", "3"]);
        let single = |text| number(text, Notation::Single);
        assert_eq!(single("\u{2212}1,5").as_deref(), Some("-1.5"));
        assert_eq!(single("1.234,5"), None);
        assert_eq!(single("1 234.5").as_deref(), Some("1234.5"));
        assert_eq!(single("1'234'567").as_deref(), Some("1234567"));
        assert_eq!(single("12 34"), None);
        assert_eq!(single("1.2D-3").as_deref(), Some("1.2e-3"));
        assert_eq!(single("-1,5d+02").as_deref(), Some("-1.5e+02"));
        assert_eq!(single("D5"), None);
    }

    #[test]
    fn cells_without_a_value() {
        let texts =
            "#DIV/0! #NV #WERT! #REF! #VALUE! #N/A -nan +NaN -nan(ind) -1.#IND 1.#QNAN NaN Bad -";
        for text in texts.split(' ') {
            assert!(is_not_measured(text) && !is_number(text), "{text}");
        }
        // A formula without a value does not make a comment of the row that it begins.
        assert_eq!(comment("#DIV/0!;2"), None);
        assert_eq!(comment("#REF: A"), Some("REF: A"));
        assert!(!is_not_measured("inf") && !is_not_measured("1.#INF"));
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
        // A single comma is a decimal comma as long as no number has a point.
        assert_eq!(read(&["1,234", "2,5"]), some(&["1.234", "2.5"]));
        assert_eq!(read(&["1,5", "2.5"]), some(&["1.5", "2.5"]));
    }
}
