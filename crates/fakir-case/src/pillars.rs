//! Tables of pillars: position and, if they differ, height and diameter of each.

use crate::columns::{Columns, Table, TableError};
use fakir::problem::{InvalidPillars, ListedPillar, Pillar, PillarList};
use std::fmt::Display;
use std::path::Path;

const COLUMNS: Columns<4> = Columns {
    names: ["x_m", "y_m", "height_m", "diameter_m"],
    required: 2,
    told: "a table of pillars has x_m and y_m, and optionally height_m and diameter_m",
};

/// Columns of heights and diameters in a table of pillars.
pub(crate) const HEIGHT: usize = 2;
pub(crate) const DIAMETER: usize = 3;

/// Reads a table of pillars: values separated by commas under a line with the names of the columns, `x_m` and `y_m`, and optionally
/// `height_m` and `diameter_m` (m), whose defaults are those of the common pillar. Lines that begin with `#` are ignored.
///
/// # Errors
/// A file that cannot be read, unknown or missing columns, and values that are not numbers, with the line.
pub(crate) fn read_pillars(path: &Path, common: &Pillar) -> Result<Table<4>, TableError> {
    COLUMNS.read(path, otherwise(common))
}

fn otherwise(common: &Pillar) -> [f64; 4] {
    [f64::NAN, f64::NAN, common.height, common.diameter]
}

/// The common pillar of a list: its height defaults to that of the highest pillar, its diameter to the mean.
pub(crate) fn common_pillar(given: Pillar, list: &PillarList) -> Pillar {
    let pillars = list.pillars();
    let highest = || {
        pillars
            .iter()
            .map(|pillar| pillar.height)
            .fold(0.0, f64::max)
    };
    let mean = || {
        // Relative to the first one, so that the mean of equal diameters is exact.
        let first = pillars[0].diameter;
        let excess = pillars.iter().map(|pillar| pillar.diameter - first);
        first + excess.sum::<f64>() / pillars.len() as f64
    };
    let or = |value: f64, otherwise: &dyn Fn() -> f64| match value.is_nan() {
        true => otherwise(),
        false => value,
    };
    Pillar {
        height: or(given.height, &highest),
        diameter: or(given.diameter, &mean),
        ..given
    }
}

/// The pillars of a table.
///
/// # Errors
/// Invalid pillars, with the line.
pub(crate) fn listed(table: &Table<4>) -> Result<PillarList, TableError> {
    let pillar = |[x, y, height, diameter]: &[f64; 4]| ListedPillar {
        centre: [*x, *y],
        height: *height,
        diameter: *diameter,
    };
    let pillars = table.rows.iter().map(pillar).collect();
    PillarList::new(pillars).map_err(|invalid| match invalid {
        InvalidPillars::NoPlace {
            pillar,
            axis,
            value,
        } => table.wrong(Some(pillar), no_place(axis, value)),
        InvalidPillars::NoSize {
            pillar,
            what,
            value,
        } => table.wrong(Some(pillar), no_size(what, value)),
        InvalidPillars::Overlap {
            pillars,
            distance,
            radii,
        } => overlap(table, pillars, distance, radii),
        other => table.wrong(None, other.to_string()),
    })
}

fn no_place(axis: impl Display, value: f64) -> String {
    format!("{axis}_m is {value}, and has to be a finite number")
}

fn no_size(what: impl Display, value: f64) -> String {
    format!("{what}_m is {value}, and has to be a finite number greater than 0")
}

/// The error for pillars that overlap.
pub(crate) fn overlap(
    table: &Table<4>,
    [one, other]: [usize; 2],
    distance: f64,
    radii: f64,
) -> TableError {
    let problem = format!(
        "this pillar overlaps with that of line {}: their centres are {distance:.4e} m apart, and their \
         radii add up to {radii:.4e} m",
        table.line(Some(one))
    );
    table.wrong(Some(other), problem)
}

/// Refuses pillars that rounded tops do not support: some may have no diameter.
pub(crate) fn check_rounded(table: &Table<4>) -> Result<(), TableError> {
    if table.rows.is_empty() {
        return Err(table.wrong(None, InvalidPillars::Empty.to_string()));
    }
    for (row, [x, y, height, diameter]) in table.rows.iter().enumerate() {
        for (axis, value) in [("x", *x), ("y", *y)] {
            if !value.is_finite() {
                return Err(table.wrong(Some(row), no_place(axis, value)));
            }
        }
        for (what, value) in [("height", *height), ("diameter", *diameter)] {
            let not_given = what == "diameter" && value.is_nan();
            if !(not_given || value > 0.0 && value.is_finite()) {
                return Err(table.wrong(Some(row), no_size(what, value)));
            }
        }
    }
    Ok(())
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
        let table = COLUMNS.parse("pillars.csv", text.as_bytes(), otherwise(&common));
        table
            .and_then(|table| listed(&table))
            .map_err(|error| error.to_string())
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
