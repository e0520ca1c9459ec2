//! Tables in files of text, in packed files and in spreadsheets.

use crate::formats;
use crate::input::{read, read_all};
use crate::notation::is_formula_error;
use crate::spreadsheet;
use flate2::read::MultiGzDecoder;
use std::borrow::Cow;
use std::io::{self, ErrorKind};
use std::path::Path;

/// Reads a table as text, which may have at most `most` bytes: a text, also packed by gzip (`.gz`), or a sheet of a spreadsheet (`.xlsx`), with a
/// line for each of its rows and tabs between cells. It is the sheet with the most rows of numbers, or that named after the file:
/// `data.xlsx#Sheet2`.
///
/// # Errors
/// As [`read`]: files of recognised formats that are not read ([`ErrorKind::Unsupported`]), with the name of a program that converts them.
pub fn read_table(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    unpack_table(path, read_packed(path, most)?, most)
}

/// The bytes of a file with a table, as [`unpack_table`] takes them: the name of a sheet may follow that of a spreadsheet.
///
/// # Errors
/// As [`read`].
pub fn read_packed(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    read(split_sheet(path).0, most)
}

/// The path of a file, and the name of a sheet of a spreadsheet after it.
fn split_sheet(path: &Path) -> (&Path, Option<&str>) {
    const ENDING: &str = ".xlsx#";
    let text = path.to_str().unwrap_or_default();
    match text.to_ascii_lowercase().find(ENDING) {
        Some(place) => {
            let (file, sheet) = text.split_at(place + ENDING.len() - 1);
            (Path::new(file), Some(&sheet[1..]))
        }
        None => (path, None),
    }
}

/// The text of a table with these contents, which are unpacked if they are packed, and at most so many bytes; `path` is the name of its file.
///
/// # Errors
/// As [`read_table`].
pub fn unpack_table(path: &Path, mut bytes: Vec<u8>, most: u64) -> io::Result<Vec<u8>> {
    let (path, sheet) = split_sheet(path);
    if bytes.starts_with(b"\x1f\x8b") {
        bytes = read_all(MultiGzDecoder::new(&bytes[..]), most)?;
    }
    let Some(format) = formats::recognised(path, &bytes) else {
        return Ok(bytes);
    };
    if format.is_spreadsheet() {
        let text = spreadsheet::to_text(&bytes, sheet, most);
        return text
            .map(String::into_bytes)
            .map_err(|problem| io::Error::new(ErrorKind::InvalidData, problem));
    }
    Err(io::Error::new(ErrorKind::Unsupported, format.no_table()))
}

/// The text of a table in UTF-8, with or without a byte order mark, in UTF-16 with one, or in Latin-1; `None` of other bytes. Cells in quotes that
/// continue in the lines below are in one line, and empty lines below keep the numbers of the lines.
#[must_use]
pub fn text_of(bytes: &[u8]) -> Option<Cow<'_, str>> {
    let wide = |bytes: &[u8], join: fn([u8; 2]) -> u16| {
        let units = bytes.chunks_exact(2).map(|pair| join([pair[0], pair[1]]));
        let text: Result<String, _> = char::decode_utf16(units).collect();
        text.ok().map(Cow::Owned)
    };
    match bytes {
        [0xff, 0xfe, rest @ ..] => wide(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => wide(rest, u16::from_be_bytes),
        _ if bytes.contains(&0) => match zeros(bytes) {
            Zeros::Odd => wide(bytes, u16::from_le_bytes),
            Zeros::Even => wide(bytes, u16::from_be_bytes),
            Zeros::Few => {
                let text: Vec<u8> = bytes.iter().copied().filter(|byte| *byte != 0).collect();
                Some(Cow::Owned(narrow_text(&text).into_owned()))
            }
            Zeros::Many => None,
        },
        _ => Some(narrow_text(bytes)),
    }
    .map(|text| match text.contains('\r') && !text.contains('\n') {
        // Lines of old programs of Macintosh.
        true => Cow::Owned(text.replace('\r', "\n")),
        false => text,
    })
    .map(|text| with_cells_in_one_line(&text).map_or(text, Cow::Owned))
}

/// Zeros among the bytes of a file.
enum Zeros {
    /// At most places of even or of odd numbers: text in UTF-16 without a byte order mark.
    Even,
    Odd,
    /// A few, which some programs write at ends of lines.
    Few,
    Many,
}

fn zeros(bytes: &[u8]) -> Zeros {
    /// Most zeros in a text.
    const FEW: usize = 8;
    let at = |first: usize| {
        let every_other = bytes.iter().skip(first).step_by(2);
        every_other.filter(|byte| **byte == 0).count()
    };
    let (even, odd) = (at(0), at(1));
    match () {
        () if even + odd <= FEW.min(bytes.len() / 20) => Zeros::Few,
        () if even == 0 && 5 * odd > 2 * bytes.len() => Zeros::Odd,
        () if odd == 0 && 5 * even > 2 * bytes.len() => Zeros::Even,
        () => Zeros::Many,
    }
}

/// The text of bytes in UTF-8, with or without a byte order mark, or in Latin-1.
pub(crate) fn narrow_text(bytes: &[u8]) -> Cow<'_, str> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        // The bytes of Latin-1 are the first characters of Unicode.
        Err(_) => Cow::Owned(bytes.iter().map(|byte| char::from(*byte)).collect()),
    }
}

/// The text of a line before a comment, and the comment. `#` begins a comment only at the beginning of a word, as numbers of old libraries of C
/// contain it (`-1.#IND`), and errors of formulas do not begin one.
pub(crate) fn split_comment(line: &str) -> (&str, &str) {
    let is_between = |c: char| c.is_whitespace() || SEPARATORS.contains(&c);
    let begins = |place: usize| {
        let word = line[place..].split(is_between).next().unwrap_or_default();
        line[..place].chars().next_back().is_none_or(is_between) && !is_formula_error(word)
    };
    let mut marks = line.match_indices('#').map(|(place, _)| place);
    match marks.find(|place| begins(*place)) {
        Some(place) => (&line[..place], &line[place + 1..]),
        None => (line, ""),
    }
}

/// The text with cells in quotes that continue in the lines below, as headings of spreadsheets do, in one line each; empty lines below keep the
/// numbers of the lines. `None` if there are no such cells.
fn with_cells_in_one_line(text: &str) -> Option<String> {
    /// Most lines of one cell.
    const MOST_LINES: usize = 8;
    let lines: Vec<&str> = text.split('\n').collect();
    let mut joined = String::new();
    let (mut copied, mut index) = (0, 0);
    while index < lines.len() {
        let is_open = |line: &str| line.contains('"') && ends_in_quotes(line);
        let mut row = lines[index].to_owned();
        let mut last = index;
        if is_open(&row) {
            let most = lines.len().min(index + MOST_LINES);
            // A line that begins with a quoted cell of its own is another row, below quotes that are never closed.
            let of_cell = (index + 1..most).take_while(|below| {
                let rest = lines[*below].trim_start().strip_prefix('"');
                rest.is_none_or(|rest| rest.trim_end().is_empty() || rest.starts_with(SEPARATORS))
            });
            let mut of_cell = of_cell.filter(|below| {
                row = format!("{} {}", row.trim_end(), lines[*below].trim_start());
                !ends_in_quotes(&row)
            });
            last = of_cell.next().unwrap_or(index);
        }
        if last > index {
            for line in &lines[copied..index] {
                joined.push_str(line);
                joined.push('\n');
            }
            joined.push_str(&row);
            joined.push_str(&"\n".repeat(last - index + 1));
            copied = last + 1;
        }
        index = last + 1;
    }
    (copied > 0).then(|| joined + &lines[copied..].join("\n"))
}

/// Possible separators of columns, the most reliable first.
pub const SEPARATORS: [char; 3] = ['\t', ';', ','];

/// Whether a line ends in a cell whose closing quotes are missing. Quotes within a cell, as of inches, open none.
fn ends_in_quotes(line: &str) -> bool {
    let (mut is_open, mut begins) = (false, true);
    let mut characters = line.chars().peekable();
    while let Some(character) = characters.next() {
        match character {
            '"' if is_open && characters.peek() == Some(&'"') => {
                characters.next();
            }
            '"' if is_open => (is_open, begins) = (false, false),
            '"' if begins => is_open = true,
            _ if is_open => {}
            _ => begins = SEPARATORS.contains(&character) || begins && character == ' ',
        }
    }
    is_open
}

/// Cells of a line of a table, with or without quotes, trimmed. A blank as the separator stands for any number of blanks.
#[must_use]
pub fn cells(line: &str, separator: char) -> Vec<String> {
    let is_blank = separator == ' ';
    let line = if is_blank { line.trim() } else { line };
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
            _ if is_blank && character.is_whitespace() && !is_quoted => {
                if !begins {
                    cells.push(String::new());
                }
            }
            _ if character == separator && !is_quoted => cells.push(String::new()),
            _ => cells[cell].push(character),
        }
    }
    cells.iter().map(|cell| cell.trim().to_owned()).collect()
}

/// Cells of a row below so many headings: empty cells behind them, as of a separator at the end, are left out.
#[must_use]
pub fn cells_of_row(line: &str, separator: char, count: usize) -> Vec<String> {
    let mut cells = cells(line, separator);
    while cells.len() > count && cells.last().is_some_and(String::is_empty) {
        cells.pop();
    }
    cells
}

/// Whether a label of a row names a statistic of the other rows: `Mean`, `Std. Dev.`, `Average (n = 7)`, `95% CI`.
#[must_use]
pub fn is_statistic(label: &str) -> bool {
    /// Words that may be followed by others.
    const FIRST_WORDS: [&str; 22] = [
        "mean",
        "average",
        "averages",
        "avg",
        "sd",
        "std",
        "stdev",
        "stddev",
        "sem",
        "median",
        "mittelwert",
        "mittel",
        "durchschnitt",
        "stabw",
        "standardabweichung",
        "moyenne",
        "promedio",
        "media",
        "m\u{e9}dia",
        "\u{441}\u{440}\u{435}\u{434}\u{43d}\u{435}\u{435}",
        "\u{5e73}\u{5747}",
        "\u{5e73}\u{5747}\u{503c}",
    ];
    const OTHERS: [&str; 19] = [
        "standard deviation",
        "standard error",
        "se",
        "min",
        "max",
        "minimum",
        "maximum",
        "sum",
        "total",
        "variance",
        "range",
        "count",
        "cv",
        "rsd",
        "rms",
        "summe",
        "q1",
        "q2",
        "q3",
    ];
    let plain = label.trim().trim_end_matches(':').replace('.', "");
    let plain = plain.to_lowercase();
    let is_percentile = plain
        .split_once('%')
        .is_some_and(|(number, rest)| number.parse::<f64>().is_ok() && ["", " ci"].contains(&rest));
    let first = plain.split([' ', '(', '\u{b1}', '=', ':']).next();
    is_percentile
        || OTHERS.contains(&&plain[..])
        || first.is_some_and(|word| FIRST_WORDS.contains(&word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_over_several_lines() {
        let of = |text: &str| text_of(text.as_bytes()).unwrap().into_owned();
        let table = "a\n\"Load\n(N)\",\"Extension\r\n(mm)\",t\n1,2,3\n";
        assert_eq!(
            of(table),
            "a\n\"Load (N)\",\"Extension (mm)\",t\n\n\n1,2,3\n"
        );
        // Inches, and quotes that are never closed before the next row.
        for text in ["5\" x 3\"\n2,\"3\n", "\"Sample\n\"Load\",\"Time\"\n1,2\n"] {
            assert_eq!(of(text), text);
        }
    }
}
