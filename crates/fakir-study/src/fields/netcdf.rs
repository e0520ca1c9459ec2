//! A [`FieldMap`] as netCDF, in the classic format with 64-bit offsets (NetCDF Classic Format Specification, "CDF-2").
//!
//! A header with dimensions, attributes and variables, then the values of one variable after the other. All numbers are
//! big-endian. Names and texts are padded with zeros to multiples of four bytes, bytes with the fill value of their type.

use super::map::{FieldMap, Values};
use crate::provenance::Provenance;

const MAGIC: &[u8; 4] = b"CDF\x02";

/// Tags of the lists in a header.
const DIMENSIONS: usize = 10;
const VARIABLES: usize = 11;
const ATTRIBUTES: usize = 12;

/// Fill value for values that are not finite (`NC_FILL_DOUBLE` of the specification), as in the classic format.
const FILL: f64 = 9.969_209_968_386_869e36;

/// Padding of variables of bytes (`NC_FILL_BYTE`).
const FILL_BYTE: i8 = -127;

/// The dimensions, slowest first.
const NAMES: [&str; 2] = ["y", "x"];

/// Value of an attribute of the file or of a variable.
enum Attribute {
    Text(String),
    Number(f64),
}

type Attributes = Vec<(&'static str, Attribute)>;

/// A variable over one or both dimensions, given by index.
struct Variable {
    name: &'static str,
    dimensions: &'static [usize],
    attributes: Attributes,
    kind: Kind,
    /// The values, padded.
    data: Vec<u8>,
}

/// Types of values, with their numbers in the format.
#[derive(Clone, Copy)]
enum Kind {
    Byte = 1,
    Text = 2,
    Double = 6,
}

/// The whole file.
pub(super) fn write(map: &FieldMap, provenance: &Provenance) -> Vec<u8> {
    let variables = variables(map);
    let begin = header(map, provenance, &variables, 0).len();
    let mut bytes = header(map, provenance, &variables, begin);
    for variable in &variables {
        bytes.extend(&variable.data);
    }
    bytes
}

/// The header of a file whose values start after `begin` bytes.
fn header(
    map: &FieldMap,
    provenance: &Provenance,
    variables: &[Variable],
    begin: usize,
) -> Vec<u8> {
    let mut header = MAGIC.to_vec();
    // There are no records, which would need an unlimited dimension.
    put(&mut header, 0);
    put(&mut header, DIMENSIONS);
    put(&mut header, NAMES.len());
    for (name, axis) in NAMES.iter().zip([map.y, map.x]) {
        put_text(&mut header, name);
        put(&mut header, axis.count);
    }
    put_attributes(&mut header, &about(map, provenance));
    put(&mut header, VARIABLES);
    put(&mut header, variables.len());
    let mut begin = begin as u64;
    for variable in variables {
        put_text(&mut header, variable.name);
        put(&mut header, variable.dimensions.len());
        for dimension in variable.dimensions {
            put(&mut header, *dimension);
        }
        put_attributes(&mut header, &variable.attributes);
        put(&mut header, variable.kind as usize);
        put(&mut header, variable.data.len());
        header.extend(begin.to_be_bytes());
        begin += variable.data.len() as u64;
    }
    header
}

/// Attributes of the file.
fn about(map: &FieldMap, provenance: &Provenance) -> Attributes {
    let mut about = vec![text("Conventions", "CF-1.8")];
    let pairs = provenance.attributes().into_iter();
    about.extend(pairs.map(|(name, content)| text(name, &content)));
    about.push(("force_N", Attribute::Number(map.force)));
    about.push(("indentation_m", Attribute::Number(map.indentation)));
    about
}

fn text(name: &'static str, content: &str) -> (&'static str, Attribute) {
    (name, Attribute::Text(content.to_owned()))
}

/// The coordinates, then the fields.
fn variables(map: &FieldMap) -> Vec<Variable> {
    let what = if map.around_axis {
        "distance from the lens axis"
    } else {
        "place"
    };
    let coordinates = [("y", "Y", map.y, &[0]), ("x", "X", map.x, &[1])];
    let coordinates = coordinates
        .into_iter()
        .map(|(name, axis, along, of)| Variable {
            name,
            dimensions: of,
            attributes: vec![
                text("units", "m"),
                text("long_name", &format!("{what} along {name}")),
                text("axis", axis),
            ],
            kind: Kind::Double,
            data: doubles(&along.coordinates()),
        });
    coordinates.chain(map.variables.iter().map(field)).collect()
}

fn field(variable: &super::map::Variable) -> Variable {
    let mut attributes = Vec::new();
    let (kind, data) = match &variable.values {
        Values::Numbers(unit, values) => {
            attributes.push(text("units", unit));
            if !values.iter().all(|value| value.is_finite()) {
                attributes.push(("_FillValue", Attribute::Number(FILL)));
            }
            (Kind::Double, doubles(values))
        }
        Values::Flags(flags) => {
            let mut data: Vec<u8> = flags.iter().map(|flag| flag.to_be_bytes()[0]).collect();
            pad(&mut data, FILL_BYTE.to_be_bytes()[0]);
            (Kind::Byte, data)
        }
    };
    attributes.push(text("long_name", variable.long_name));
    attributes.push(text("comment", &variable.comment));
    Variable {
        name: variable.name,
        dimensions: &[0, 1],
        attributes,
        kind,
        data,
    }
}

fn doubles(values: &[f64]) -> Vec<u8> {
    let finite = values.iter().map(|value| match value.is_finite() {
        true => *value,
        false => FILL,
    });
    finite.flat_map(f64::to_be_bytes).collect()
}

fn put_attributes(header: &mut Vec<u8>, attributes: &Attributes) {
    put(header, ATTRIBUTES);
    put(header, attributes.len());
    for (name, attribute) in attributes {
        put_text(header, name);
        match attribute {
            Attribute::Text(content) => {
                put(header, Kind::Text as usize);
                put_text(header, content);
            }
            Attribute::Number(number) => {
                put(header, Kind::Double as usize);
                put(header, 1);
                header.extend(number.to_be_bytes());
            }
        }
    }
}

/// A text preceded by its length.
fn put_text(header: &mut Vec<u8>, text: &str) {
    put(header, text.len());
    header.extend(text.as_bytes());
    pad(header, 0);
}

/// A number of the header.
fn put(header: &mut Vec<u8>, number: usize) {
    let number = u32::try_from(number).expect("texts and fields take less than 4 GB each");
    header.extend(number.to_be_bytes());
}

fn pad(bytes: &mut Vec<u8>, with: u8) {
    bytes.resize(bytes.len().next_multiple_of(4), with);
}

#[cfg(test)]
pub(super) mod tests {
    use netcdf3::FileReader;
    use std::io::Cursor;

    /// The values of a variable, as read by the library.
    pub(in crate::fields) fn numbers(contents: &[u8], name: &str) -> Vec<f64> {
        let input = Box::new(Cursor::new(contents.to_vec()));
        let mut reader = FileReader::open_seek_read("fields.nc", input).unwrap();
        assert_eq!(
            reader
                .data_set()
                .get_global_attr_as_string("Conventions")
                .unwrap(),
            "CF-1.8"
        );
        reader.read_var_f64(name).unwrap()
    }
}
