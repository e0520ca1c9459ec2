//! Cells of tables: their separators, and the notations of numbers.

pub(super) use fakir_case::notation::{Doubt, Evidence, Marks, Notation, is_number, number};
pub(super) use fakir_case::table_text::{SEPARATORS, cells};

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
}
