//! Cells of tables: their separators, and the notations of numbers.

use fakir_case::notation::is_formula_error;
pub(super) use fakir_case::notation::{
    Doubt, Evidence, Marks, Notation, is_not_measured, is_number, number,
};
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
