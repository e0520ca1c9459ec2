//! Tables of a target curve.

use crate::fit::DataError;
use crate::heights::{Curve, WantedPoint};
use fakir_case::input::{self, LARGEST_TABLE};
use fakir_case::unit::{Dimension, parse_quantity};
use std::path::Path;

/// A target curve, from a CSV file with two columns: a heading with the units, as in `force_mN,area_um2`, and a row for every point; lines that
/// begin with `#` are ignored.
///
/// | columns | curve |
/// |---|---|
/// | `force`, `area` | area of the force |
/// | `indentation`, `force` | force of the indentation |
/// | `indentation`, `area` | area of the indentation |
///
/// Units are `N`, `mN`, `uN`, `nN`; `m`, `mm`, `um`, `nm`; `m2`, `mm2`, `um2`, `nm2`. Points may come in any order.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Kind of curve.
    pub curve: Curve,
    /// Points, by increasing load, in SI units.
    pub points: Vec<WantedPoint>,
    /// Line of each point in the file.
    lines: Vec<u64>,
    name: String,
}

/// Quantity of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Column {
    Indentation,
    Force,
    Area,
}

/// A column with its unit, in SI units.
#[derive(Debug, Clone, Copy)]
struct Heading {
    column: Column,
    unit: f64,
}

const COLUMNS: &str = "two of indentation_um, force_mN and area_um2, or in other units (N, mN, uN, nN; m, mm, um, nm; m2, mm2, um2, nm2)";

impl Heading {
    fn named(text: &str) -> Option<Self> {
        let (name, unit) = text.rsplit_once('_')?;
        let of = |symbol: &str, dimension| parse_quantity(&format!("1 {symbol}"), dimension).ok();
        let (column, unit) = match name {
            "indentation" => (Column::Indentation, of(unit, Dimension::Length)?),
            "force" => (Column::Force, of(unit, Dimension::Force)?),
            "area" | "contact_area" => {
                let side = of(unit.strip_suffix('2')?, Dimension::Length)?;
                (Column::Area, side * side)
            }
            _ => return None,
        };
        Some(Self { column, unit })
    }
}

impl Target {
    /// Reads a CSV file.
    ///
    /// # Errors
    /// [`DataError`] names file, line and column.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let name = path.display().to_string();
        match input::read(path, LARGEST_TABLE) {
            Ok(bytes) => Self::from_csv(&name, &bytes),
            Err(error) => Err(DataError {
                name,
                line: None,
                column: None,
                problem: format!("cannot read: {error}"),
            }),
        }
    }

    /// Reads the contents of a CSV file; `name` is its name in errors.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn from_csv(name: &str, bytes: &[u8]) -> Result<Self, DataError> {
        let fail = |line: Option<u64>, column: Option<&str>, problem: String| DataError {
            name: name.to_owned(),
            line,
            column: column.map(str::to_owned),
            problem,
        };
        let mut table = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_reader(bytes);
        let line_of = |error: &csv::Error| error.position().map(csv::Position::line);
        let names = table.headers();
        let names = names
            .map_err(|e| fail(line_of(&e), None, e.to_string()))?
            .clone();
        let line = names.position().map(csv::Position::line);
        let mut headings = Vec::new();
        for heading in &names {
            let known = Heading::named(heading).ok_or_else(|| {
                fail(
                    line,
                    None,
                    format!("there is no column \"{heading}\": give {COLUMNS}"),
                )
            })?;
            headings.push(known);
        }
        let [one, other] = headings[..] else {
            let problem = format!("there are {} columns: give {COLUMNS}", headings.len());
            return Err(fail(line, None, problem));
        };
        let (curve, load_first) = match (one.column, other.column) {
            (Column::Force, Column::Area) => (Curve::AreaOfForce, true),
            (Column::Area, Column::Force) => (Curve::AreaOfForce, false),
            (Column::Indentation, Column::Force) => (Curve::ForceOfIndentation, true),
            (Column::Force, Column::Indentation) => (Curve::ForceOfIndentation, false),
            (Column::Indentation, Column::Area) => (Curve::AreaOfIndentation, true),
            (Column::Area, Column::Indentation) => (Curve::AreaOfIndentation, false),
            _ => {
                let problem = format!("both columns are of the same quantity: give {COLUMNS}");
                return Err(fail(line, None, problem));
            }
        };
        let mut points = Vec::new();
        for row in table.records() {
            let row = row.map_err(|e| fail(line_of(&e), None, e.to_string()))?;
            let line = row.position().map(csv::Position::line);
            let mut numbers = [0.0; 2];
            for (place, (heading, number)) in headings.iter().zip(&mut numbers).enumerate() {
                let text = row.get(place).unwrap_or_default();
                let column = names.get(place);
                let value: f64 = text
                    .parse()
                    .map_err(|_| fail(line, column, format!("\"{text}\" is no number")))?;
                if !(value > 0.0 && value.is_finite()) {
                    let problem = format!("{text} cannot be: it must be finite and greater than 0");
                    return Err(fail(line, column, problem));
                }
                *number = value * heading.unit;
            }
            let [one, other] = numbers;
            let (load, value) = if load_first {
                (one, other)
            } else {
                (other, one)
            };
            points.push((WantedPoint { load, value }, line.unwrap_or_default()));
        }
        if points.is_empty() {
            return Err(fail(
                line,
                None,
                "there are no points under the heading".to_owned(),
            ));
        }
        points.sort_by(|(a, _), (b, _)| a.load.total_cmp(&b.load));
        for pair in points.windows(2) {
            let [(before, first), (after, line)] = pair else {
                continue;
            };
            if after.load <= before.load {
                let problem = format!("the {} is that of line {first}", curve.load_name());
                return Err(fail(Some(*line), None, problem));
            }
        }
        let (points, lines) = points.into_iter().unzip();
        Ok(Self {
            curve,
            points,
            lines,
            name: name.to_owned(),
        })
    }

    /// Error of a point of the curve, with its line in the file.
    #[must_use]
    pub fn at_point(&self, number: usize, problem: String) -> DataError {
        DataError {
            name: self.name.clone(),
            line: self.lines.get(number).copied(),
            column: None,
            problem,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Target, String> {
        Target::from_csv("curve.csv", text.as_bytes()).map_err(|error| error.to_string())
    }

    #[test]
    fn columns_in_any_order_and_unit() {
        let target = read("# target\narea_um2, force_mN\n20,2\n10,1\n").unwrap();
        assert_eq!(target.curve, Curve::AreaOfForce);
        let [one, other] = target.points[..] else {
            panic!("two points")
        };
        for (value, expected) in [
            (one.load, 1e-3),
            (one.value, 1e-11),
            (other.load, 2e-3),
            (other.value, 2e-11),
        ] {
            assert!((value / expected - 1.0).abs() < 1e-15, "{value}");
        }
        assert_eq!(
            read("indentation_um,force_N\n1,1\n").unwrap().curve,
            Curve::ForceOfIndentation
        );
        assert_eq!(
            read("indentation_um,area_m2\n1,1\n").unwrap().curve,
            Curve::AreaOfIndentation
        );
    }

    #[test]
    fn errors_state_their_line() {
        let wrong = |text: &str| read(text).unwrap_err();
        for (text, message) in [
            (
                "force,area\n1,1\n",
                "curve.csv:1: there is no column \"force\"",
            ),
            ("force_mN,area_mN\n1,1\n", "there is no column \"area_mN\""),
            ("force_mN\n1\n", "curve.csv:1: there are 1 columns"),
            (
                "force_mN,force_N\n1,1\n",
                "both columns are of the same quantity",
            ),
            ("force_mN,area_um2\n", "no points under the heading"),
            (
                "force_mN,area_um2\n1,x\n",
                "curve.csv:2: area_um2: \"x\" is no number",
            ),
            ("force_mN,area_um2\n1,-1\n", "area_um2: -1 cannot be"),
            (
                "force_mN,area_um2\n1,1\n1,2\n",
                "curve.csv:3: the force is that of line 2",
            ),
            ("force_mN,area_um2\n1,1,3\n", "curve.csv:2"),
        ] {
            assert!(wrong(text).contains(message), "{}", wrong(text));
        }
    }
}
