//! Headers of JPK's text files: comments that name columns, units and segments.

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
