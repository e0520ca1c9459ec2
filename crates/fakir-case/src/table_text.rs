//! Tables in files of text, in packed files and in spreadsheets.

use crate::formats;
use crate::input::{read, read_all};
use crate::spreadsheet;
use flate2::read::MultiGzDecoder;
use std::borrow::Cow;
use std::io::{self, ErrorKind};
use std::path::Path;

/// Reads a table as text, which may have at most `most` bytes: a text, also packed by gzip (`.gz`), or the first sheet of a
/// spreadsheet (`.xlsx`) with a row of numbers, with a line for each of its rows and tabs between cells.
///
/// # Errors
/// As [`read`]: files of recognised formats that are not read ([`ErrorKind::Unsupported`]), with the name of a program that converts them.
pub fn read_table(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    unpack_table(path, read(path, most)?, most)
}

/// The text of a table with these contents, which are unpacked if they are packed, and at most so many bytes; `path` is the name of its file.
///
/// # Errors
/// As [`read_table`].
pub fn unpack_table(path: &Path, mut bytes: Vec<u8>, most: u64) -> io::Result<Vec<u8>> {
    if bytes.starts_with(b"\x1f\x8b") {
        bytes = read_all(MultiGzDecoder::new(&bytes[..]), most)?;
    }
    let Some(format) = formats::recognised(path, &bytes) else {
        return Ok(bytes);
    };
    if format.is_spreadsheet() {
        let text = spreadsheet::to_text(&bytes, most);
        return text
            .map(String::into_bytes)
            .map_err(|problem| io::Error::new(ErrorKind::InvalidData, problem));
    }
    Err(io::Error::new(ErrorKind::Unsupported, format.no_table()))
}

/// The text of a table in UTF-8, with or without a byte order mark, in UTF-16 with one, or in Latin-1; `None` of other bytes.
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
        _ if bytes.contains(&0) => None,
        _ => {
            let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
            Some(match std::str::from_utf8(bytes) {
                Ok(text) => Cow::Borrowed(text),
                // The bytes of Latin-1 are the first characters of Unicode.
                Err(_) => Cow::Owned(bytes.iter().map(|byte| char::from(*byte)).collect()),
            })
        }
    }
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

/// Whether a label of a row names a statistic of the other rows: `Mean`, `SD`.
#[must_use]
pub fn is_statistic(label: &str) -> bool {
    const STATISTICS: [&str; 27] = [
        "mean",
        "average",
        "avg",
        "sd",
        "std",
        "stdev",
        "std dev",
        "standard deviation",
        "sem",
        "min",
        "max",
        "minimum",
        "maximum",
        "sum",
        "total",
        "median",
        "variance",
        "range",
        "count",
        "cv",
        "rsd",
        "mittelwert",
        "mittel",
        "stabw",
        "standardabweichung",
        "summe",
        "moyenne",
    ];
    if !label.starts_with(char::is_alphabetic) {
        return false;
    }
    let plain = label.trim_end_matches(':').replace('.', "");
    STATISTICS.contains(&&plain.to_lowercase()[..])
}
