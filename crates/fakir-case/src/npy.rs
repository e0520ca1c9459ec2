//! The `.npy` format of NumPy (`numpy.lib.format`, versions 1 to 3), for two-dimensional arrays of real numbers.
//!
//! | bytes | content |
//! |---|---|
//! | 6 | `\x93NUMPY` |
//! | 2 | version, major and minor |
//! | 2 in version 1, 4 from version 2 on | length of the header, little-endian |
//! | that length | a Python dictionary with the keys `descr`, `fortran_order` and `shape` |
//! | the rest | the elements, without gaps |

use std::fmt::{self, Display};
use std::io::{self, Read};

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Longest header, bytes: a dictionary of a type and a shape has about 100.
const LONGEST_HEADER: u32 = 65_536;

/// The header with its prefix is padded to a multiple of this, bytes.
const ALIGNMENT: usize = 64;

/// Elements are read in blocks of about this size, bytes, so that a header alone allocates nothing.
const BLOCK: usize = 1 << 16;

/// The header of an array.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Header {
    /// The type of the elements, as Python writes it: `<f8` in quotes, or a list of fields.
    descr: String,
    /// Whether the first index varies fastest.
    pub(crate) fortran_order: bool,
    /// The length along each dimension.
    pub(crate) shape: Vec<u64>,
}

/// How the elements of an array are stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ElementType {
    kind: ElementKind,
    /// Bytes per element.
    pub(crate) size: usize,
    is_big_endian: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum ElementKind {
    Float,
    Signed,
    Unsigned,
}

/// Reason why an array cannot be read.
#[derive(Debug)]
pub(crate) enum NpyError {
    /// The file cannot be read, or ends early.
    Read(io::Error),
    /// The file has another format.
    Format(String),
}

impl Display for NpyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                f.write_str("it ends within its header")
            }
            Self::Read(error) => error.fmt(f),
            Self::Format(problem) => f.write_str(problem),
        }
    }
}

impl From<io::Error> for NpyError {
    fn from(error: io::Error) -> Self {
        Self::Read(error)
    }
}

impl Header {
    /// Reads the header; the elements follow in `data`.
    pub(crate) fn read(mut data: impl Read) -> Result<Self, NpyError> {
        let mut magic = Vec::with_capacity(MAGIC.len());
        data.by_ref()
            .take(MAGIC.len() as u64)
            .read_to_end(&mut magic)?;
        if magic != MAGIC {
            let problem = "it does not begin with \\x93NUMPY, as every .npy file does";
            return Err(NpyError::Format(problem.to_owned()));
        }
        let mut version = [0; 2];
        data.read_exact(&mut version)?;
        let mut length = [0; 4];
        match version {
            [1, 0] => data.read_exact(&mut length[..2])?,
            [2 | 3, 0] => data.read_exact(&mut length)?,
            [major, minor] => {
                return Err(NpyError::Format(format!(
                    "version {major}.{minor} of the format is not supported: versions 1.0, 2.0 and 3.0 are"
                )));
            }
        }
        let length = u32::from_le_bytes(length);
        if length > LONGEST_HEADER {
            let problem = "its header is longer than any that NumPy writes";
            return Err(NpyError::Format(problem.to_owned()));
        }
        let mut text = vec![0; length as usize];
        data.read_exact(&mut text)?;
        // Versions 1 and 2 are in Latin-1, version 3 in UTF-8: only the name of a field can contain characters
        // that are not ASCII.
        let text = String::from_utf8_lossy(&text);
        Self::parse(&text).map_err(|problem| {
            NpyError::Format(format!("its header {:?} {problem}", text.trim_end()))
        })
    }

    /// Parses the header from a dictionary, or returns a description of the error.
    fn parse(text: &str) -> Result<Self, String> {
        let inner = text.trim().strip_prefix('{');
        let inner = inner.and_then(|inner| inner.strip_suffix('}'));
        let inner = inner.ok_or("is not a dictionary in braces")?;
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        for item in items(inner)? {
            let (key, value) = key_and_value(item)
                .ok_or_else(|| format!("has {item:?}, which is not a key with a value"))?;
            let is_new = match key {
                "descr" => descr.replace(value.to_owned()).is_none(),
                "fortran_order" => fortran_order.replace(boolean(value)?).is_none(),
                "shape" => shape.replace(tuple(value)?).is_none(),
                _ => {
                    return Err(format!(
                        "has the key {key:?}: descr, fortran_order and shape are accepted"
                    ));
                }
            };
            if !is_new {
                return Err(format!("has the key {key:?} twice"));
            }
        }
        let without = |key: &str| format!("does not have the key {key:?}");
        Ok(Self {
            descr: descr.ok_or_else(|| without("descr"))?,
            fortran_order: fortran_order.ok_or_else(|| without("fortran_order"))?,
            shape: shape.ok_or_else(|| without("shape"))?,
        })
    }

    /// The type of the elements as NumPy names it, without quotes.
    pub(crate) fn type_name(&self) -> &str {
        unquoted(&self.descr).unwrap_or(&self.descr)
    }

    /// The type of the elements; `None` unless they are integers, or floating-point numbers of 4 or 8 bytes.
    pub(crate) fn element_type(&self) -> Option<ElementType> {
        let name = unquoted(&self.descr)?;
        let mut letters = name.chars();
        let order = letters.next()?;
        let kind = letters.next()?;
        let size = match letters.as_str() {
            "1" => 1,
            "2" => 2,
            "4" => 4,
            "8" => 8,
            _ => return None,
        };
        let kind = match (kind, size) {
            ('f', 4 | 8) => ElementKind::Float,
            ('i', _) => ElementKind::Signed,
            ('u', _) => ElementKind::Unsigned,
            _ => return None,
        };
        let is_big_endian = match order {
            '<' => false,
            '>' => true,
            '=' => cfg!(target_endian = "big"),
            '|' if size == 1 => false,
            _ => return None,
        };
        Some(ElementType {
            kind,
            size,
            is_big_endian,
        })
    }
}

impl ElementType {
    /// Reads elements in the order in which they are stored.
    ///
    /// # Errors
    /// [`io::ErrorKind::UnexpectedEof`] if there are fewer than `count`.
    pub(crate) fn read(self, mut data: impl Read, count: usize) -> io::Result<Vec<f64>> {
        let block = BLOCK / self.size;
        let mut bytes = vec![0; self.size * count.min(block)];
        let mut values = Vec::with_capacity(count.min(block));
        while values.len() < count {
            let length = self.size * (count - values.len()).min(block);
            let bytes = &mut bytes[..length];
            data.read_exact(bytes)?;
            values.extend(bytes.chunks_exact(self.size).map(|bytes| self.value(bytes)));
        }
        Ok(values)
    }

    fn value(self, bytes: &[u8]) -> f64 {
        // The bytes in order of significance, in the low end of a word.
        let mut word = [0; 8];
        word[..self.size].copy_from_slice(bytes);
        if self.is_big_endian {
            word[..self.size].reverse();
        }
        let word = u64::from_le_bytes(word);
        match (self.kind, self.size) {
            (ElementKind::Float, 4) => f64::from(f32::from_bits(word as u32)),
            (ElementKind::Float, _) => f64::from_bits(word),
            (ElementKind::Unsigned, _) => word as f64,
            (ElementKind::Signed, size) => {
                // Shifts the sign into the highest bit and back, which repeats it.
                let shift = 64 - 8 * size as u32;
                ((word << shift) as i64 >> shift) as f64
            }
        }
    }
}

/// A `.npy` file of rows and columns, in double precision and C order.
pub(crate) fn write(rows: usize, columns: usize, values: &[f64]) -> Vec<u8> {
    let mut header =
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows}, {columns}), }}");
    let prefix = MAGIC.len() + 4;
    let padded = (prefix + header.len() + 1).next_multiple_of(ALIGNMENT) - prefix;
    header.extend(std::iter::repeat_n(' ', padded - header.len() - 1));
    header.push('\n');
    let mut bytes = Vec::with_capacity(prefix + padded + 8 * values.len());
    bytes.extend(MAGIC);
    bytes.extend([1, 0]);
    // Two numbers of at most 20 digits are far below the limit of 65 535 bytes.
    bytes.extend((padded as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    for value in values {
        bytes.extend(value.to_le_bytes());
    }
    bytes
}

/// Items separated by commas outside quotes and brackets; nothing follows a trailing comma.
fn items(text: &str) -> Result<Vec<&str>, String> {
    let (mut items, mut start) = (Vec::new(), 0);
    let (mut depth, mut quote) = (0usize, None);
    for (place, letter) in text.char_indices() {
        match (quote, letter) {
            (Some(open), _) if letter == open => quote = None,
            (Some(_), _) => {}
            (None, '\'' | '"') => quote = Some(letter),
            (None, '(' | '[' | '{') => depth += 1,
            (None, ')' | ']' | '}') => {
                depth = depth.checked_sub(1).ok_or("closes a bracket too many")?;
            }
            (None, ',') if depth == 0 => {
                items.push(text[start..place].trim());
                start = place + 1;
            }
            (None, _) => {}
        }
    }
    if depth > 0 || quote.is_some() {
        return Err("has a bracket or a quote that is not closed".to_owned());
    }
    let last = text[start..].trim();
    if !last.is_empty() {
        items.push(last);
    }
    Ok(items)
}

/// `'key': value`.
fn key_and_value(item: &str) -> Option<(&str, &str)> {
    let (key, value) = item.split_once(':')?;
    Some((unquoted(key.trim())?, value.trim()))
}

fn unquoted(text: &str) -> Option<&str> {
    let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    let inner = text.strip_prefix(quote)?.strip_suffix(quote)?;
    (!inner.contains(quote)).then_some(inner)
}

fn boolean(value: &str) -> Result<bool, String> {
    match value {
        "True" => Ok(true),
        "False" => Ok(false),
        _ => Err(format!(
            "has fortran_order {value}: True and False are accepted"
        )),
    }
}

/// A tuple of lengths: `()`, `(3,)`, `(3, 4)`; Python 2 writes `3L`.
fn tuple(value: &str) -> Result<Vec<u64>, String> {
    let problem =
        || format!("has the shape {value}: a tuple of lengths such as (3, 4) is accepted");
    let inner = value.strip_prefix('(').and_then(|it| it.strip_suffix(')'));
    let lengths = items(inner.ok_or_else(problem)?)?;
    let length = |text: &str| {
        let digits = text.strip_suffix('L').unwrap_or(text);
        // A sign is not a digit.
        let is_number = digits.bytes().all(|digit| digit.is_ascii_digit());
        is_number.then(|| digits.parse().ok()).flatten()
    };
    let shape: Option<Vec<u64>> = lengths.iter().map(|text| length(text)).collect();
    // `(3)` is a number in brackets.
    let is_tuple = lengths.len() != 1 || inner.is_some_and(|it| it.trim_end().ends_with(','));
    shape.filter(|_| is_tuple).ok_or_else(problem)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp)] // files contain these numbers exactly

    use super::*;

    /// A file after the format's definition: prefix, length, header, elements.
    fn file(version: [u8; 2], header: &str, elements: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY".to_vec();
        bytes.extend(version);
        let width = if version[0] == 1 { 2 } else { 4 };
        bytes.extend(&(header.len() as u32).to_le_bytes()[..width]);
        bytes.extend(header.as_bytes());
        bytes.extend(elements);
        bytes
    }

    fn parse(header: &str) -> Result<Header, String> {
        let bytes = file([1, 0], header, &[]);
        Header::read(&mut &bytes[..]).map_err(|error| error.to_string())
    }

    fn element(name: &str) -> Option<ElementType> {
        let header = format!("{{'descr': '{name}', 'fortran_order': False, 'shape': (1,), }}");
        parse(&header).unwrap().element_type()
    }

    fn value(name: &str, bytes: &[u8]) -> f64 {
        let values = element(name).unwrap().read(&mut &bytes[..], 1);
        values.unwrap()[0]
    }

    #[test]
    fn headers_are_read_with_any_spacing_and_order_of_keys() {
        let expected = Header {
            descr: "'<f8'".to_owned(),
            fortran_order: false,
            shape: vec![3, 4],
        };
        for header in [
            // As NumPy writes it, with the padding.
            "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }                     \n",
            "{'shape':(3,4),'fortran_order':False,'descr':'<f8'}",
            " { 'descr' :\t'<f8' , 'fortran_order' : False ,\n 'shape' : ( 3 , 4 , ) } \n",
            "{\"descr\": '<f8', \"fortran_order\": False, \"shape\": (3L, 4L), }",
        ] {
            let found = parse(header).map(|found| Header {
                descr: found.descr.replace('"', "'"),
                ..found
            });
            assert_eq!(found, Ok(expected.clone()), "{header}");
        }
        let fortran = parse("{'descr': '<f8', 'fortran_order': True, 'shape': (2, 1), }").unwrap();
        assert!(fortran.fortran_order);
        for (shape, lengths) in [
            ("()", vec![]),
            ("(7,)", vec![7]),
            ("(2, 3, 5)", vec![2, 3, 5]),
        ] {
            let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
            assert_eq!(parse(&header).unwrap().shape, lengths);
        }
    }

    #[test]
    fn all_three_versions_are_read_and_others_are_refused() {
        let header = "{'descr': '|u1', 'fortran_order': False, 'shape': (1, 2), }\n";
        for version in [[1, 0], [2, 0], [3, 0]] {
            let bytes = file(version, header, &[5, 6]);
            let mut data = &bytes[..];
            let found = Header::read(&mut data).unwrap();
            let values = found.element_type().unwrap().read(&mut data, 2).unwrap();
            assert_eq!(values, [5.0, 6.0]);
        }
        let error = Header::read(&mut &file([4, 1], header, &[])[..]).unwrap_err();
        let expected = "version 4.1 of the format is not supported: versions 1.0, 2.0 and 3.0 are";
        assert_eq!(error.to_string(), expected);
    }

    #[test]
    fn numbers_of_every_type_are_read() {
        // Origin: the two's complement and IEEE 754 patterns of these numbers.
        assert_eq!(value("<f8", &1.5f64.to_le_bytes()), 1.5);
        assert_eq!(value(">f8", &(-1.5f64).to_be_bytes()), -1.5);
        assert_eq!(value("<f4", &0.1f32.to_le_bytes()), f64::from(0.1f32));
        assert_eq!(value(">f4", &[0x3f, 0x80, 0, 0]), 1.0);
        assert_eq!(value("|i1", &[0xff]), -1.0);
        assert_eq!(value("<i1", &[0x7f]), 127.0);
        assert_eq!(value("|u1", &[0xff]), 255.0);
        assert_eq!(value("<i2", &[0xfe, 0xff]), -2.0);
        assert_eq!(value(">u2", &[0x01, 0x02]), 258.0);
        assert_eq!(value(">i4", &[0xff, 0xff, 0xff, 0xfd]), -3.0);
        assert_eq!(value("<u4", &[0xff; 4]), f64::from(u32::MAX));
        assert_eq!(value("<i8", &i64::MIN.to_le_bytes()), -(2f64.powi(63)));
        assert_eq!(value(">u8", &[0xff; 8]), 2f64.powi(64));
        assert!(value("<f8", &f64::NAN.to_le_bytes()).is_nan());
    }

    #[test]
    fn other_types_are_named() {
        for name in [
            "<c16", "|b1", "<f2", "<f16", "<U8", "|S4", "<M8[ns]", "|O", "|i2", "<i3", "f8", "",
        ] {
            assert_eq!(element(name), None, "{name}");
        }
        let record = "{'descr': [('x', '<f8'), ('y', '<f8', (2,))], 'fortran_order': False, 'shape': (1,), }";
        let header = parse(record).unwrap();
        assert_eq!(header.element_type(), None);
        assert_eq!(header.type_name(), "[('x', '<f8'), ('y', '<f8', (2,))]");
        let header = parse(&record.replace("[('x', '<f8'), ('y', '<f8', (2,))]", "'<c16'"));
        assert_eq!(header.unwrap().type_name(), "<c16");
    }

    #[test]
    fn errors_of_headers_state_what_is_accepted() {
        let whole = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }";
        for (from, to, expected) in [
            ("}", "", "is not a dictionary in braces"),
            ("False", "false", "True and False are accepted"),
            ("(3, 4)", "(3)", "a tuple of lengths such as (3, 4)"),
            ("(3, 4)", "[3, 4]", "a tuple of lengths such as (3, 4)"),
            ("(3, 4)", "(3, -4)", "a tuple of lengths such as (3, 4)"),
            ("(3, 4)", "(3, )4", "a tuple of lengths such as (3, 4)"),
            ("(3, 4)", "(3, 99999999999999999999)", "a tuple of lengths"),
            ("(3, 4)", "(3, 4", "is not closed"),
            ("(3, 4)", "3, 4)", "closes a bracket too many"),
            (
                "'shape'",
                "'size'",
                "has the key \"size\": descr, fortran_order and shape",
            ),
            (", 'shape': (3, 4)", "", "does not have the key \"shape\""),
            (
                "'<f8',",
                "'<f8', 'descr': '<f8',",
                "has the key \"descr\" twice",
            ),
            ("'shape':", "'shape'", "not a key with a value"),
            ("'<f8'", "'<f8", "is not closed"),
        ] {
            let header = whole.replacen(from, to, 1);
            let error = parse(&header).unwrap_err();
            assert!(error.contains(expected), "{header}: {error}");
        }
    }

    #[test]
    fn truncated_files_are_noticed_at_every_byte() {
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2), }\n";
        let bytes = file([2, 0], header, &[0; 16]);
        let start = bytes.len() - 16;
        for length in 0..bytes.len() {
            let mut data = &bytes[..length];
            match Header::read(&mut data) {
                Ok(found) => {
                    assert!(length >= start);
                    let read = found.element_type().unwrap().read(&mut data, 2);
                    assert_eq!(read.unwrap_err().kind(), io::ErrorKind::UnexpectedEof);
                }
                Err(error) => {
                    let expected = if length < MAGIC.len() {
                        "it does not begin with \\x93NUMPY, as every .npy file does"
                    } else {
                        "it ends within its header"
                    };
                    assert!(length < start);
                    assert_eq!(error.to_string(), expected);
                }
            }
        }
        let error = Header::read(&mut &b"PK\x03\x04 and more"[..]).unwrap_err();
        assert!(error.to_string().contains("does not begin with"), "{error}");
    }

    /// The size in a header is not allocated before there are elements.
    #[test]
    fn huge_shapes_and_headers_allocate_nothing() {
        let element = element("<f8").unwrap();
        let read = element.read(&mut &[0; 24][..], usize::MAX);
        assert_eq!(read.unwrap_err().kind(), io::ErrorKind::UnexpectedEof);
        let mut bytes = file([2, 0], "{}", &[]);
        bytes[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
        let error = Header::read(&mut &bytes[..]).unwrap_err().to_string();
        assert!(error.contains("its header is longer"), "{error}");
    }

    /// More elements than fit one block, and a written array as NumPy writes it: `numpy.save` of zeros(3, 4) has a
    /// header of 118 bytes that ends in a line feed.
    #[test]
    fn what_is_written_is_read_back() {
        let values: Vec<f64> = (0..20_000).map(|k| f64::from(k).sqrt()).collect();
        let bytes = write(100, 200, &values);
        let mut data = &bytes[..];
        let header = Header::read(&mut data).unwrap();
        assert_eq!((header.type_name(), header.fortran_order), ("<f8", false));
        assert_eq!(header.shape, [100, 200]);
        let read = header.element_type().unwrap().read(&mut data, 20_000);
        assert_eq!(read.unwrap(), values);
        assert!(data.is_empty());
        let zeros = write(3, 4, &[0.0; 12]);
        assert_eq!(zeros.len(), 128 + 96);
        assert_eq!(zeros[..10], *b"\x93NUMPY\x01\x00\x76\x00");
        assert_eq!(zeros[127], b'\n');
    }
}
