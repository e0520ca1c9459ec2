//! Headers of text files of JPK and of the Python package afmformats: comments that name columns, units and segments.

use super::cells::{BLANKS, cells, comment};

/// The header of the first segment of a file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Segments {
    /// Line of the names, from 0.
    pub(super) line: usize,
    /// The first line after the header, from 0.
    pub(super) first: usize,
    /// Names of the columns.
    pub(super) headings: Vec<String>,
    /// Their units.
    pub(super) units: Vec<String>,
    /// Spring constant of the cantilever, N/m.
    pub(super) spring_constant: Option<f64>,
}

/// The value of a comment `name: value`.
pub(super) fn value_of<'a>(line: &'a str, name: &str) -> Option<&'a str> {
    let (found, value) = comment(line)?.split_once(':')?;
    (found.trim() == name).then(|| value.trim())
}

/// Whether a text was written by `export_data` of afmformats.
pub(super) fn is_of_afmformats(lines: &[&str]) -> bool {
    let first = lines.first().and_then(|line| comment(line));
    first.is_some_and(|first| first.trim().starts_with("afmformats "))
}

/// Units of columns of afmformats, which are in SI units.
pub(super) fn units_of_afmformats(headings: &[String]) -> Vec<String> {
    let unit = |heading: &String| match &heading[..] {
        "force" => "N",
        "time" => "s",
        "height (measured)" | "height (piezo)" | "tip position" => "m",
        _ => "",
    };
    headings
        .iter()
        .map(|heading| unit(heading).to_owned())
        .collect()
}

/// Spring constant (N/m) in the metadata of afmformats, which are JSON.
pub(super) fn spring_constant_of_afmformats(lines: &[&str]) -> Option<f64> {
    lines
        .iter()
        .map_while(|line| comment(line))
        .find_map(|line| line.trim().strip_prefix("\"spring constant\":"))
        .and_then(|value| value.trim().trim_end_matches(',').parse().ok())
        .filter(|constant: &f64| constant.is_finite() && *constant > 0.0)
}

impl Segments {
    /// The header of a file, if it has one.
    pub(super) fn of(lines: &[&str]) -> Option<Self> {
        let words = |line: usize, name: &str| {
            let value = value_of(lines.get(line)?, name)?;
            Some(cells(value, BLANKS))
        };
        let line = (0..lines.len()).find(|line| words(*line, "columns").is_some())?;
        let mut headings = words(line, "columns").filter(|names| names.len() > 1)?;
        let mut units = Vec::new();
        let mut first = line + 1;
        while lines.get(first).is_some_and(|line| comment(line).is_some()) {
            let same_count = |names: &Vec<String>| names.len() == headings.len();
            if let Some(names) = words(first, "fancyNames").filter(same_count) {
                headings = names;
            } else if let Some(found) = words(first, "units").filter(same_count) {
                units = found;
            }
            first += 1;
        }
        let plain = |name: &String| name.replace(['(', ')'], " ").trim().to_owned();
        let spring_constant = lines[..first]
            .iter()
            .filter_map(|line| value_of(line, "springConstant"))
            .find_map(|value| value.parse().ok());
        Some(Self {
            line,
            first,
            headings: headings.iter().map(plain).collect(),
            units,
            spring_constant,
        })
    }
}
