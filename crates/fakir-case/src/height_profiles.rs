//! Height maps from the formats of ISO 25178: SDF (part 71) and X3P (part 72). Lengths are in metres; the first row has the
//! smallest y.

use crate::archive::member;
use crate::height_table::{HeightMapError, HeightUnit, Source, Stated, Table};
use crate::markup::{Part, attribute, parts};

fn wrong(source: &Source<'_>, problem: impl Into<String>) -> HeightMapError {
    HeightMapError::Profiles {
        file: source.file.to_owned(),
        problem: problem.into(),
    }
}

/// A table with distances of neighbouring points and a unit of heights, m.
fn table(columns: usize, rows: usize, values: Vec<f64>, cell: [f64; 2], height: f64) -> Table {
    let counts = [columns as f64, rows as f64];
    let extent = [0, 1].map(|axis| (cell[axis] > 0.0).then_some(cell[axis] * counts[axis]));
    Table {
        columns,
        rows,
        values,
        stated: Stated {
            extent,
            height_unit: Some(HeightUnit::Length(height)),
            ..Stated::default()
        },
        first_missing: None,
    }
}

/// Reads an SDF file in ASCII: a header of `name = value`, `*`, heights, `*`, and a trailer.
pub(crate) fn sdf(source: &Source<'_>, bytes: &[u8]) -> Result<Table, HeightMapError> {
    let text = String::from_utf8_lossy(bytes);
    let mut sections = text.split('*');
    let (header, heights) = (sections.next().unwrap_or_default(), sections.next());
    let value = |name: &str| {
        let mut lines = header.lines().filter_map(|line| line.split_once('='));
        let found = lines.find(|(key, _)| key.trim().eq_ignore_ascii_case(name));
        found.map(|(_, value)| value.trim())
    };
    let number = |name: &str| {
        let found = value(name).and_then(|value| value.parse::<f64>().ok());
        found.ok_or_else(|| wrong(source, format!("its header has no number {name}")))
    };
    let columns = number("NumPoints")? as usize;
    let rows = number("NumProfiles")? as usize;
    let cell = [number("Xscale")?, number("Yscale")?];
    let height = number("Zscale")?;
    let count = (columns as u64).saturating_mul(rows as u64);
    source.check_memory(count, || format!("{columns} by {rows} points"))?;
    let mut values = Vec::with_capacity(columns * rows);
    for word in heights.unwrap_or_default().split_whitespace() {
        let height = match word {
            "BAD" | "bad" => f64::NAN,
            word => word.parse().map_err(|_| {
                wrong(
                    source,
                    format!("\"{word}\" is no height: heights are numbers or BAD"),
                )
            })?,
        };
        values.push(height);
    }
    if values.len() != columns * rows {
        let problem = format!(
            "its header states {columns} by {rows} points, and it has {} heights",
            values.len()
        );
        return Err(wrong(source, problem));
    }
    Ok(table(columns, rows, values, cell, height))
}

/// Reads a binary SDF file: a header of fixed length, and heights. All numbers are little-endian.
///
/// | place | bytes | content |
/// |---|---|---|
/// | 0 | 42 | version, manufacturer, dates |
/// | 42, 44 | 2 | number of points of a profile, number of profiles |
/// | 46, 54, 62 | 8 | distances along x and y, unit of heights, m |
/// | 70 | 8 | resolution |
/// | 78, 79, 80 | 1 | compression, type of the heights, kind of checksum |
pub(crate) fn binary_sdf(source: &Source<'_>, bytes: &[u8]) -> Result<Table, HeightMapError> {
    const HEADER: usize = 81;
    let (header, heights) = bytes
        .split_at_checked(HEADER)
        .ok_or_else(|| wrong(source, "it ends within its header"))?;
    let count = |place: usize| usize::from(u16::from_le_bytes([header[place], header[place + 1]]));
    let number = |place: usize| Stored::Double.value(&header[place..place + 8]);
    let (columns, rows) = (count(42), count(44));
    let stored = match (header[78], header[79]) {
        (0, 3) => Stored::Float,
        (0, 5) => Stored::Short,
        (0, 6) => Stored::Long,
        (0, 7) => Stored::Double,
        (compression, kind) => {
            let problem = format!(
                "heights of type {kind} with compression {compression}: types 3, 5, 6 and 7 without compression are read; save it as SDF in ASCII"
            );
            return Err(wrong(source, problem));
        }
    };
    let points = (columns as u64) * (rows as u64);
    source.check_memory(points, || format!("{columns} by {rows} points"))?;
    let needed = columns * rows * stored.size();
    let Some(heights) = heights.get(..needed) else {
        let problem = format!(
            "its header says {columns} by {rows} points, {needed} bytes, and {} are left",
            heights.len()
        );
        return Err(wrong(source, problem));
    };
    let heights = heights.chunks_exact(stored.size());
    let values = heights.map(|height| {
        let value = stored.value(height);
        // Missing heights have the smallest number of their type.
        let is_missing = value <= stored.smallest();
        if is_missing { f64::NAN } else { value }
    });
    let values = values.collect();
    let cell = [number(46), number(54)];
    Ok(table(columns, rows, values, cell, number(62)))
}

/// How the heights of a binary file are stored.
#[derive(Clone, Copy, PartialEq)]
enum Stored {
    Short,
    Long,
    Float,
    Double,
}

impl Stored {
    fn size(self) -> usize {
        match self {
            Self::Short => 2,
            Self::Long | Self::Float => 4,
            Self::Double => 8,
        }
    }

    fn smallest(self) -> f64 {
        match self {
            Self::Short => f64::from(i16::MIN),
            Self::Long => f64::from(i32::MIN),
            Self::Float => f64::from(f32::MIN),
            Self::Double => f64::MIN,
        }
    }

    fn value(self, bytes: &[u8]) -> f64 {
        let mut eight = [0; 8];
        eight[..bytes.len()].copy_from_slice(bytes);
        let bits = u64::from_le_bytes(eight);
        match self {
            Self::Short => f64::from(bits as u16 as i16),
            Self::Long => f64::from(bits as u32 as i32),
            Self::Float => f64::from(f32::from_bits(bits as u32)),
            Self::Double => f64::from_bits(bits),
        }
    }
}

/// Content of the description of an X3P file.
#[derive(Default)]
struct Description {
    /// Texts of elements, by the names of the elements around them.
    texts: Vec<(String, String)>,
    /// Points that are listed in the description.
    points: Vec<String>,
}

impl Description {
    fn of(document: &str) -> Self {
        let mut description = Self::default();
        let mut path: Vec<&str> = Vec::new();
        for part in parts(document) {
            match part {
                Part::Start(name, given) => {
                    path.push(name);
                    if name == "Datum" {
                        description.points.push(String::new());
                    }
                    if let Some(unit) = attribute(given, "unit") {
                        description
                            .texts
                            .push((format!("{}@unit", path.join("/")), unit));
                    }
                }
                Part::End(_) => {
                    path.pop();
                }
                Part::Text(text) if path.last() == Some(&"Datum") => {
                    if let Some(point) = description.points.last_mut() {
                        point.push_str(text.trim());
                    }
                }
                Part::Text(text) if !text.trim().is_empty() => {
                    let text = text.trim().to_owned();
                    description.texts.push((path.join("/"), text));
                }
                Part::Text(_) => {}
            }
        }
        description
    }

    /// Text of an element, by the end of its path.
    fn text(&self, end: &str) -> Option<&str> {
        let found = self.texts.iter().find(|(path, _)| path.ends_with(end));
        found.map(|(_, text)| &text[..])
    }

    fn number(&self, end: &str) -> Option<f64> {
        self.text(end)?.parse().ok()
    }
}

/// Reads an X3P file: a ZIP archive with a description in XML and heights in a binary file or in the description.
pub(crate) fn x3p(source: &Source<'_>, bytes: &[u8]) -> Result<Table, HeightMapError> {
    let most = source.memory_limit as u64;
    let unpacked = |name: &str| {
        let found = member(bytes, name, most).map_err(|problem| wrong(source, problem))?;
        found.ok_or_else(|| wrong(source, format!("it has no {name}")))
    };
    let document = unpacked("main.xml")?;
    let description = Description::of(&String::from_utf8_lossy(&document));
    let missing = |what: &str| wrong(source, format!("its main.xml has no {what}"));
    let count = |name: &str| {
        let end = format!("MatrixDimension/{name}");
        let number = description.number(&end).ok_or_else(|| missing(&end))?;
        Ok::<_, HeightMapError>(number as usize)
    };
    let (columns, rows) = (count("SizeX")?, count("SizeY")?);
    let layers = description.number("MatrixDimension/SizeZ").unwrap_or(1.0);
    if layers > 1.0 {
        return Err(wrong(
            source,
            format!("it has {layers} layers: a height map has one"),
        ));
    }
    let points = (columns as u64).saturating_mul(rows as u64);
    source.check_memory(points, || format!("{columns} by {rows} points"))?;
    let increment = |axis: &str| {
        let end = format!("{axis}/Increment");
        description.number(&end).ok_or_else(|| missing(&end))
    };
    let cell = [increment("CX")?, increment("CY")?];
    let stored = match description.text("CZ/DataType").unwrap_or("D") {
        "I" => Stored::Short,
        "L" => Stored::Long,
        "F" => Stored::Float,
        "D" => Stored::Double,
        other => {
            return Err(wrong(
                source,
                format!("heights of the type {other}: I, L, F and D are read"),
            ));
        }
    };
    let is_whole = matches!(stored, Stored::Short | Stored::Long);
    let height = match is_whole {
        true => increment("CZ")?,
        false => 1.0,
    };
    let mut values: Vec<f64> = match description.text("DataLink/PointDataLink") {
        Some(link) => {
            let data = unpacked(link.trim_start_matches('/'))?;
            let cells = data.chunks_exact(stored.size());
            cells.map(|cell| stored.value(cell)).collect()
        }
        None => {
            let height = |point: &String| {
                let last = point.rsplit(';').next().unwrap_or_default();
                last.trim().parse().unwrap_or(f64::NAN)
            };
            description.points.iter().map(height).collect()
        }
    };
    if values.len() != columns * rows {
        let problem = format!(
            "its main.xml states {columns} by {rows} points, and it has {} heights",
            values.len()
        );
        return Err(wrong(source, problem));
    }
    // In units of the increment, as the values.
    let offset = description.number("CZ/Offset").unwrap_or(0.0) / height;
    values.iter_mut().for_each(|value| *value += offset);
    if let Some(link) = description.text("DataLink/ValidPointsLink") {
        // One bit for every point, the lowest first.
        let valid = unpacked(link.trim_start_matches('/'))?;
        for (point, value) in values.iter_mut().enumerate() {
            let byte = valid.get(point / 8).copied().unwrap_or(0xff);
            if byte >> (point % 8) & 1 == 0 {
                *value = f64::NAN;
            }
        }
    }
    Ok(table(columns, rows, values, cell, height))
}
