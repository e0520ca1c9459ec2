//! Tables for a terminal.

use crate::numbers::{DIGITS, LENGTH_DIGITS, column_unit, significant};
use comfy_table::{CellAlignment, LineStyle, Table, TableStyle};
use fakir_case::unit::Dimension;

/// A column of a table of `T`s.
pub struct Column<T> {
    heading: String,
    cell: Box<dyn Fn(&T) -> String>,
    alignment: CellAlignment,
}

impl<T: 'static> Column<T> {
    /// A physical quantity. All values are in the unit that suits the largest one; the heading contains it. Missing
    /// values are a dash.
    pub fn quantity(
        name: &str,
        dimension: Dimension,
        rows: &[T],
        value: fn(&T) -> Option<f64>,
    ) -> Self {
        Self::scaled(name, dimension, rows, value, |_| DIGITS)
    }

    /// A force with this number of digits.
    pub fn force(
        name: &str,
        rows: &[T],
        value: impl Fn(&T) -> Option<f64> + 'static,
        known: fn(&T) -> usize,
    ) -> Self {
        Self::scaled(name, Dimension::Force, rows, value, known)
    }

    /// A length without an error estimate.
    pub fn length(name: &str, rows: &[T], value: fn(&T) -> Option<f64>) -> Self {
        Self::scaled(name, Dimension::Length, rows, value, |_| LENGTH_DIGITS)
    }

    /// A contact radius with this number of digits.
    pub fn radius(
        name: &str,
        rows: &[T],
        value: fn(&T) -> Option<f64>,
        known: fn(&T) -> usize,
    ) -> Self {
        Self::scaled(name, Dimension::Length, rows, value, known)
    }

    fn scaled(
        name: &str,
        dimension: Dimension,
        rows: &[T],
        value: impl Fn(&T) -> Option<f64> + 'static,
        known: fn(&T) -> usize,
    ) -> Self {
        let unit = column_unit(rows.iter().filter_map(&value), dimension);
        let size = unit.map_or(1.0, |unit| unit.in_si());
        Self {
            heading: unit.map_or(name.to_owned(), |unit| format!("{name} ({})", unit.symbol)),
            cell: Box::new(move |row| {
                number_or_dash(value(row).map(|value| value / size), known(row))
            }),
            alignment: CellAlignment::Right,
        }
    }

    /// A plain number.
    pub fn number(name: &str, digits: usize, value: fn(&T) -> Option<f64>) -> Self {
        Self {
            heading: name.to_owned(),
            cell: Box::new(move |row| number_or_dash(value(row), digits)),
            alignment: CellAlignment::Right,
        }
    }

    /// A count or a quantity with a separate format.
    pub fn right(name: &str, cell: fn(&T) -> String) -> Self {
        Self {
            heading: name.to_owned(),
            cell: Box::new(cell),
            alignment: CellAlignment::Right,
        }
    }

    /// Values in a format that depends on more than the row.
    pub fn formatted(name: &str, cell: impl Fn(&T) -> String + 'static) -> Self {
        Self {
            heading: name.to_owned(),
            cell: Box::new(cell),
            alignment: CellAlignment::Right,
        }
    }

    /// A column of words.
    pub fn text(name: &str, cell: fn(&T) -> String) -> Self {
        Self {
            heading: name.to_owned(),
            cell: Box::new(cell),
            alignment: CellAlignment::Left,
        }
    }
}

fn number_or_dash(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".to_owned(), |value| significant(value, digits))
}

/// A table with a rule under its headings.
pub fn table<T: 'static>(rows: &[T], columns: &[Column<T>]) -> String {
    let rule = LineStyle::none().fill('─').junction('─');
    let mut table = Table::new();
    table
        .load_style(TableStyle::new().header_separator(rule))
        .set_header(columns.iter().map(|column| &column.heading))
        .add_rows(
            rows.iter()
                .map(|row| columns.iter().map(|column| (column.cell)(row))),
        );
    for (column, drawn) in columns.iter().zip(table.column_iter_mut()) {
        drawn.set_cell_alignment(column.alignment);
        drawn.set_padding((0, 1));
    }
    lines(&table)
}

/// A list of quantities: name, number, unit and a remark.
pub fn list(rows: Vec<[String; 4]>) -> String {
    let mut table = Table::new();
    table.load_style(TableStyle::new()).add_rows(rows);
    // The unit follows its number closely.
    for (column, right) in table.column_iter_mut().zip([2, 1, 2, 0]) {
        column.set_padding((0, right));
    }
    if let Some(column) = table.column_mut(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    lines(&table)
}

/// Removes trailing blanks.
fn lines(table: &Table) -> String {
    table
        .lines()
        .map(|line| format!("{}\n", line.trim_end()))
        .collect()
}
