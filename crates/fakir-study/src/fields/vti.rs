//! A [`FieldMap`] as VTK image data: XML with embedded base64, which VTK 6 and later read.
//!
//! Each array is its length in bytes (64 bits) and its values, little-endian, as one block of base64. Texts are arrays of characters in
//! field data. The XML itself contains no external text.

use super::map::{FieldMap, Values, Variable};
use crate::provenance::Provenance;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write;

/// The whole file.
pub(super) fn write(map: &FieldMap, provenance: &Provenance) -> String {
    let (last_x, last_y) = (map.x.count - 1, map.y.count - 1);
    let extent = format!("0 {last_x} 0 {last_y} 0 0");
    let mut text = format!(
        r#"<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<ImageData WholeExtent="{extent}" Origin="{:e} {:e} 0" Spacing="{:e} {:e} {:e}">
<FieldData>
"#,
        map.x.start, map.y.start, map.x.spacing, map.y.spacing, map.x.spacing
    );
    for (name, value) in provenance.attributes() {
        // Strings are terminated by a zero.
        let bytes = [value.as_bytes(), &[0]].concat();
        array(&mut text, "String", name, r#" NumberOfTuples="1""#, &bytes);
    }
    for (name, value) in [("force_N", map.force), ("indentation_m", map.indentation)] {
        let tuples = r#" NumberOfTuples="1""#;
        array(&mut text, "Float64", name, tuples, &value.to_le_bytes());
    }
    let _ = write!(
        text,
        "</FieldData>\n<Piece Extent=\"{extent}\">\n<PointData Scalars=\"pressure_Pa\">\n"
    );
    for variable in &map.variables {
        point_data(&mut text, variable);
    }
    text + "</PointData>\n</Piece>\n</ImageData>\n</VTKFile>\n"
}

fn point_data(text: &mut String, variable: &Variable) {
    match &variable.values {
        Values::Numbers(unit, values) => {
            let finite = |value: &f64| if value.is_finite() { *value } else { f64::NAN };
            let bytes: Vec<u8> = values
                .iter()
                .flat_map(|value| finite(value).to_le_bytes())
                .collect();
            let name = format!("{}_{unit}", variable.name);
            array(text, "Float64", &name, "", &bytes);
        }
        Values::Flags(flags) => {
            let bytes: Vec<u8> = flags.iter().flat_map(|flag| flag.to_le_bytes()).collect();
            array(text, "Int8", variable.name, "", &bytes);
        }
    }
}

fn array(text: &mut String, kind: &str, name: &str, tuples: &str, values: &[u8]) {
    let _ = writeln!(
        text,
        r#"<DataArray type="{kind}" Name="{name}"{tuples} format="binary">"#
    );
    let length = (values.len() as u64).to_le_bytes();
    STANDARD.encode_string([&length, values].concat(), text);
    text.push_str("\n</DataArray>\n");
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The values of an array of numbers.
    pub(in crate::fields) fn numbers(contents: &[u8], name: &str) -> Vec<f64> {
        let text = std::str::from_utf8(contents).unwrap();
        let start = text.find(&format!("Name=\"{name}\"")).unwrap();
        let data = text[start..].lines().nth(1).unwrap();
        let bytes = STANDARD.decode(data).unwrap();
        let (length, values) = bytes.split_at(8);
        assert_eq!(
            values.len() as u64,
            u64::from_le_bytes(length.try_into().unwrap())
        );
        values
            .chunks_exact(8)
            .map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap()))
            .collect()
    }
}
