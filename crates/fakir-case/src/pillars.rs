//! Tables of pillars: where each stands and, where they differ, how it is made.

use crate::input;
use fakir::problem::{InvalidPillars, ListedPillar, Pillar, PillarList};
use std::fmt::Display;
use std::path::Path;

/// Largest table of pillars, bytes: that of some million pillars.
pub const LARGEST_TABLE: u64 = 256_000_000;

/// The columns that a table of pillars can have.
const COLUMNS: [&str; 4] = ["x_m", "y_m", "height_m", "diameter_m"];

/// Why a table of pillars was not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PillarsError {
    /// The file cannot be read.
    #[error("cannot read {path}: {error}")]
    Unreadable {
        /// Its name.
        path: String,
        /// What was wrong.
        error: std::io::Error,
    },
    /// A line that is no row of the table.
    #[error("{path}, line {line}: {problem}")]
    Line {
        /// The file.
        path: String,
        /// Line, from 1.
        line: u64,
        /// What was wrong, and what would be right.
        problem: String,
    },
}

/// Reads a table of pillars: values separated by commas under a line with the names of the columns, `x_m` and `y_m`, and optionally
/// `height_m` and `diameter_m` (m), which are those of the common pillar where they are not given. Lines that begin with `#` are left out.
///
/// # Errors
/// A file that cannot be read, columns that are not known or missing, values that are no numbers, and pillars that cannot stand so,
/// with the line.
pub fn read_pillars(path: &Path, common: &Pillar) -> Result<PillarList, PillarsError> {
    let name = path.display().to_string();
    let unreadable = |error| PillarsError::Unreadable {
        path: name.clone(),
        error,
    };
    let bytes = input::read(path, LARGEST_TABLE).map_err(unreadable)?;
    parse_pillars(&name, &bytes, common)
}

/// [`read_pillars`] from the contents of a file; `name` is what errors call it.
///
/// # Errors
/// As [`read_pillars`].
pub fn parse_pillars(
    name: &str,
    bytes: &[u8],
    common: &Pillar,
) -> Result<PillarList, PillarsError> {
    let rows = Rows::parse(name, bytes, [common.height, common.diameter])?;
    let pillars = rows
        .values
        .iter()
        .map(|[x, y, height, diameter]| ListedPillar {
            centre: [*x, *y],
            height: *height,
            diameter: *diameter,
        });
    PillarList::new(pillars.collect()).map_err(|invalid| match invalid {
        InvalidPillars::NoPlace {
            pillar,
            axis,
            value,
        } => rows.wrong(pillar, no_place(axis, value)),
        InvalidPillars::NoSize {
            pillar,
            what,
            value,
        } => rows.wrong(pillar, no_size(what, value)),
        InvalidPillars::Overlap {
            pillars,
            distance,
            radii,
        } => rows.overlap(pillars, distance, radii),
        other => rows.problem(rows.heading_line, other.to_string()),
    })
}

fn no_place(axis: impl Display, value: f64) -> String {
    format!("{axis}_m is {value}, and has to be a finite number")
}

fn no_size(what: impl Display, value: f64) -> String {
    format!("{what}_m is {value}, and has to be a finite number greater than 0")
}

/// The numbers of a table of pillars, before it is known what they are for.
pub(crate) struct Rows {
    name: String,
    heading_line: u64,
    /// Of every row.
    lines: Vec<u64>,
    /// x, y, height and diameter of every row, m.
    pub(crate) values: Vec<[f64; 4]>,
}

impl Rows {
    /// Reads a table. The common height and diameter are those of pillars of which the table does not say it.
    pub(crate) fn read(path: &Path, common: [f64; 2]) -> Result<Self, PillarsError> {
        let name = path.display().to_string();
        let bytes = input::read(path, LARGEST_TABLE).map_err(|error| PillarsError::Unreadable {
            path: name.clone(),
            error,
        })?;
        Self::parse(&name, &bytes, common)
    }

    fn parse(name: &str, bytes: &[u8], [height, diameter]: [f64; 2]) -> Result<Self, PillarsError> {
        let wrong = |line: u64, problem: String| PillarsError::Line {
            path: name.to_owned(),
            line,
            problem,
        };
        let mut table = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_reader(bytes);
        let csv_line = |error: &csv::Error| error.position().map_or(1, csv::Position::line);
        let headings = table
            .headers()
            .map_err(|e| wrong(csv_line(&e), e.to_string()))?;
        let heading_line = headings.position().map_or(1, csv::Position::line);
        let mut places = [None; COLUMNS.len()];
        for (place, heading) in headings.iter().enumerate() {
            let known = COLUMNS.iter().position(|column| *column == heading);
            let Some(column) = known else {
                let problem = format!("there is no column \"{heading}\": {}", one_of_columns());
                return Err(wrong(heading_line, problem));
            };
            if places[column].replace(place).is_some() {
                return Err(wrong(
                    heading_line,
                    format!("two columns are \"{heading}\""),
                ));
            }
        }
        for column in 0..2 {
            if places[column].is_none() {
                let problem = format!(
                    "the column {} is missing: {}",
                    COLUMNS[column],
                    one_of_columns()
                );
                return Err(wrong(heading_line, problem));
            }
        }
        let otherwise = [f64::NAN, f64::NAN, height, diameter];
        let mut rows = Self {
            name: name.to_owned(),
            heading_line,
            lines: Vec::new(),
            values: Vec::new(),
        };
        for row in table.records() {
            let row = row.map_err(|error| wrong(csv_line(&error), error.to_string()))?;
            let line = row
                .position()
                .map_or(0, |position| line_of_row(bytes, position));
            let mut values = otherwise;
            for (column, place) in places.iter().enumerate() {
                let Some(text) = place.and_then(|place| row.get(place)) else {
                    continue;
                };
                values[column] = text.parse().map_err(|_| {
                    let column = COLUMNS[column];
                    wrong(
                        line,
                        format!("{column} is \"{text}\", and has to be a number of metres"),
                    )
                })?;
            }
            rows.values.push(values);
            rows.lines.push(line);
        }
        Ok(rows)
    }

    /// Refuses places that are none, and heights and diameters that are not above 0. A diameter that is not given is none.
    pub(crate) fn check_rounded(&self) -> Result<(), PillarsError> {
        if self.values.is_empty() {
            return Err(self.problem(self.heading_line, InvalidPillars::Empty.to_string()));
        }
        for (row, [x, y, height, diameter]) in self.values.iter().enumerate() {
            for (axis, value) in [("x", *x), ("y", *y)] {
                if !value.is_finite() {
                    return Err(self.wrong(row, no_place(axis, value)));
                }
            }
            for (what, value) in [("height", *height), ("diameter", *diameter)] {
                let not_given = what == "diameter" && value.is_nan();
                if !(not_given || value > 0.0 && value.is_finite()) {
                    return Err(self.wrong(row, no_size(what, value)));
                }
            }
        }
        Ok(())
    }

    /// The error for pillars that overlap.
    pub(crate) fn overlap(
        &self,
        [one, other]: [usize; 2],
        distance: f64,
        radii: f64,
    ) -> PillarsError {
        let problem = format!(
            "this pillar overlaps with that of line {}: their centres are {distance:.4e} m apart, and their \
             radii add up to {radii:.4e} m",
            self.line(one)
        );
        self.wrong(other, problem)
    }

    fn line(&self, row: usize) -> u64 {
        self.lines.get(row).copied().unwrap_or(self.heading_line)
    }

    fn wrong(&self, row: usize, problem: String) -> PillarsError {
        self.problem(self.line(row), problem)
    }

    fn problem(&self, line: u64, problem: String) -> PillarsError {
        PillarsError::Line {
            path: self.name.clone(),
            line,
            problem,
        }
    }
}

/// The line of a row, from 1: after the comments and empty lines that are skipped before it.
fn line_of_row(bytes: &[u8], start: &csv::Position) -> u64 {
    let rest = bytes.get(start.byte() as usize..).unwrap_or_default();
    let skipped = rest.split(|byte| *byte == b'\n').take_while(|line| {
        let text = line.trim_ascii();
        text.is_empty() || text.starts_with(b"#")
    });
    start.line() + skipped.count() as u64
}

fn one_of_columns() -> String {
    format!(
        "a table of pillars has {} and {}, and optionally {} and {}",
        COLUMNS[0], COLUMNS[1], COLUMNS[2], COLUMNS[3]
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir::problem::PillarCompliance;

    fn read(text: &str) -> Result<PillarList, String> {
        let common = Pillar {
            diameter: 6e-6,
            height: 2.2e-6,
            compliance: PillarCompliance::Column,
        };
        parse_pillars("pillars.csv", text.as_bytes(), &common).map_err(|error| error.to_string())
    }

    #[test]
    fn columns_may_come_in_any_order_and_some_be_left_out() {
        let list =
            read("# of a design\ny_m, x_m, height_m\n0, 1e-5, 2e-6\n0, 3e-5, 2.1e-6\n").unwrap();
        let [one, other] = list.pillars() else {
            panic!("two pillars")
        };
        let [x, y] = one.centre;
        let values = [x, y, one.height, one.diameter, other.height].map(f64::to_bits);
        assert_eq!(values, [1e-5, 0.0, 2e-6, 6e-6, 2.1e-6].map(f64::to_bits));
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        let wrong = |text: &str| read(text).unwrap_err();
        assert!(
            wrong("").contains("line 1: the column x_m is missing"),
            "{}",
            wrong("")
        );
        assert!(wrong("x_m,y_m\n").contains("there are no pillars"));
        assert!(wrong("x_m,y_m,colour\n0,0,1").contains("line 1: there is no column \"colour\""));
        assert!(wrong("x_m,y_m\n0,zero").contains("line 2: y_m is \"zero\""));
        assert!(wrong("x_m,y_m\n0,0\n1e-3").contains("line 3"));
        assert!(wrong("x_m,y_m\n0,inf").contains("line 2: y_m is inf"));
        assert!(wrong("x_m,y_m,height_m\n0,0,-1").contains("line 2: height_m is -1"));
        let overlap = wrong("x_m,y_m\n0,0\n1,0\n# here\n4e-6,0\n");
        assert!(
            overlap.contains("line 5: this pillar overlaps with that of line 2"),
            "{overlap}"
        );
        assert!(overlap.contains("4.0000e-6 m apart"), "{overlap}");
    }
}
