//! Cells of tables: their separators, and the notations of numbers.

pub(super) use fakir_case::table_text::cells;

/// Possible separators of columns, the most reliable first.
pub(super) const SEPARATORS: [char; 3] = ['\t', ';', ','];

/// Stands for any number of blanks between columns.
pub(super) const BLANKS: char = ' ';

/// Text of a comment.
pub(super) fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let first = line.split(['\t', ';', ',', ' ']).next().unwrap_or(line);
    if is_formula_error(first) {
        return None;
    }
    let marks = ["#", "%", "//", "!", ";"];
    marks.into_iter().find_map(|mark| line.strip_prefix(mark))
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

    /// The notation of the file.
    pub(super) fn notation(&self) -> Notation {
        match (self.point, self.comma) {
            (true, false) => Notation::Point,
            (false, true) if self.points_of_thousands => Notation::Comma,
            _ => Notation::Single,
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

/// Whether a text is a number in any notation.
pub(super) fn is_number(text: &str) -> bool {
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
            let notation = evidence.notation();
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
