//! The rows of a sweep as a table: one row per case, one column per axis and per number.

use crate::collapsed::{Collapsed, FloorJump, FloorLoss};
use crate::output::File;
use crate::record::{Entry, Kind, Record, Type, Value as Recorded};
use crate::row::{Row, RowAnswer};
use fakir_case::Study;
use fakir_case::study::Coordinate;
use serde_json::{Map, Value, json};

/// A table of results, without computing times: the same study gives the same table.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The columns, all of the same length.
    pub columns: Vec<Column>,
}

/// A column of a [`Table`].
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name, which ends with the unit, as in `critical_force_N`.
    pub name: String,
    /// A value for every row.
    pub values: Values,
}

/// The values of a column; `None` for cases without a result.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers in SI units.
    Numbers(Vec<Option<f64>>),
    /// Whole numbers.
    Counts(Vec<Option<i64>>),
    /// Yes or no.
    Flags(Vec<Option<bool>>),
    /// Words.
    Words(Vec<Option<String>>),
}

impl Table {
    /// The table of some rows of a study.
    #[must_use]
    pub fn new(study: &Study, rows: &[Row]) -> Self {
        let index = |row: &Row| i64::try_from(row.index).ok();
        let mut columns = vec![Column {
            name: "case".to_owned(),
            values: Values::Counts(rows.iter().map(index).collect()),
        }];
        for (number, axis) in study.axes().enumerate() {
            let coordinates = rows.iter().map(|row| &row.coordinates[number]);
            columns.push(Column {
                name: axis.variable().column(),
                values: coordinate_values(axis.is_numeric(), coordinates),
            });
        }
        match Kind::of(study) {
            Some(kind) => number_columns(rows, kind, &mut columns),
            None => collapse_columns(rows, &mut columns),
        }
        let converged = |row: &Row| Some(row.problem.is_none());
        columns.push(Column {
            name: "converged".to_owned(),
            values: Values::Flags(rows.iter().map(converged).collect()),
        });
        let problem = |row: &Row| Some(row.problem.clone().unwrap_or_default());
        columns.push(Column {
            name: "problem".to_owned(),
            values: Values::Words(rows.iter().map(problem).collect()),
        });
        Self { columns }
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// The column of that name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&Values> {
        let column = self.columns.iter().find(|column| column.name == name)?;
        Some(&column.values)
    }

    /// The table as CSV: a heading, then the rows. Numbers have the smallest number of digits that reproduces them.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let heading = self.columns.iter().map(|column| column.name.as_str());
        let mut written = writer.write_record(heading);
        for row in 0..self.rows() {
            let cells = self.columns.iter().map(|column| column.values.cell(row));
            written = written.and_then(|()| writer.write_record(cells));
        }
        written.expect("memory takes rows of equal length");
        let bytes = writer.into_inner().expect("memory takes every byte");
        String::from_utf8(bytes).expect("cells are texts")
    }

    /// The table as a CSV file; `None` for a table without rows.
    #[must_use]
    pub fn some_csv(&self, name: &'static str) -> Option<File> {
        (self.rows() > 0).then(|| File::new(name, self.to_csv()))
    }

    /// The table as a list of JSON objects, one for every row.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let object = |row| {
            let cells = self.columns.iter();
            let cells = cells.map(|column| (column.name.clone(), column.values.json(row)));
            Value::Object(cells.collect::<Map<_, _>>())
        };
        Value::Array((0..self.rows()).map(object).collect())
    }
}

fn coordinate_values<'a>(
    numeric: bool,
    coordinates: impl Iterator<Item = &'a Coordinate>,
) -> Values {
    if numeric {
        Values::Numbers(
            coordinates
                .map(|coordinate| match coordinate {
                    Coordinate::Number(number) => Some(*number),
                    Coordinate::Word(_) => None,
                })
                .collect(),
        )
    } else {
        Values::Words(
            coordinates
                .map(|coordinate| match coordinate {
                    Coordinate::Word(word) => Some(word.clone()),
                    Coordinate::Number(_) => None,
                })
                .collect(),
        )
    }
}

/// Adds columns for the results of one kind.
struct Answers<'a, T> {
    answers: Vec<Option<&'a T>>,
    columns: &'a mut Vec<Column>,
}

impl<'a, T> Answers<'a, T> {
    /// Selects the results of one kind.
    fn of(
        rows: &'a [Row],
        columns: &'a mut Vec<Column>,
        kind: impl Fn(&'a RowAnswer) -> Option<&'a T>,
    ) -> Self {
        let answers = rows.iter().map(|row| row.answer.as_ref().and_then(&kind));
        Self {
            answers: answers.collect(),
            columns,
        }
    }

    fn push(&mut self, name: &str, values: Values) {
        self.columns.push(Column {
            name: name.to_owned(),
            values,
        });
    }

    fn values<V>(&self, value: impl Fn(&T) -> V) -> Vec<Option<V>> {
        let answers = self.answers.iter();
        answers.map(|answer| answer.map(&value)).collect()
    }

    fn number(&mut self, name: &str, value: impl Fn(&T) -> f64) {
        self.push(name, Values::Numbers(self.values(value)));
    }

    fn number_if_any(&mut self, name: &str, value: impl Fn(&T) -> Option<f64>) {
        let values = self.values(value).into_iter().map(Option::flatten);
        self.push(name, Values::Numbers(values.collect()));
    }

    fn count_if_any(&mut self, name: &str, value: impl Fn(&T) -> Option<usize>) {
        let count = |answer: &T| value(answer).and_then(|value| i64::try_from(value).ok());
        let values = self.values(count).into_iter().map(Option::flatten);
        self.push(name, Values::Counts(values.collect()));
    }

    fn word(&mut self, name: &str, value: impl Fn(&T) -> String) {
        self.push(name, Values::Words(self.values(value)));
    }
}

/// The columns of the results of one kind.
fn number_columns(rows: &[Row], kind: Kind, columns: &mut Vec<Column>) {
    let answers = rows.iter().map(|row| row.answer.as_ref());
    let records: Vec<Option<&Record>> = answers
        .map(|answer| match answer {
            Some(RowAnswer::Numbers(record)) if record.kind() == kind => Some(record),
            _ => None,
        })
        .collect();
    for (place, entry) in kind.entries().iter().enumerate() {
        let mut found = records.iter().flatten().map(|record| record.value(place));
        if entry.if_given && found.all(|value| *value == Recorded::None) {
            continue;
        }
        for (name, coordinate) in entry.columns() {
            let values = records
                .iter()
                .map(|record| Some(record.as_ref()?.value(place)));
            columns.push(Column {
                name,
                values: Values::of_entry(entry, coordinate, values),
            });
        }
    }
}

/// Columns of the jump-in to an adhesive floor.
fn jump_columns<T>(of: &mut Answers<'_, T>, jump: impl Fn(&T) -> Option<FloorJump>) {
    of.number_if_any("jump_force_N", |it| Some(jump(it)?.force));
    of.number_if_any("jump_floor_area_m2", |it| Some(jump(it)?.floor_area));
    of.number_if_any("jump_front_radius_m", |it| Some(jump(it)?.front_radius));
    of.count_if_any("jump_holes", |it| Some(jump(it)?.holes));
}

/// Columns of its detachment.
fn loss_columns<T>(of: &mut Answers<'_, T>, lost: impl Fn(&T) -> Option<FloorLoss>) {
    of.number_if_any("floor_lost_indentation_m", |it| Some(lost(it)?.indentation));
    of.number_if_any("floor_lost_force_N", |it| Some(lost(it)?.force));
}

fn collapse_columns(rows: &[Row], columns: &mut Vec<Column>) {
    let mut of: Answers<'_, Collapsed> = Answers::of(rows, columns, |answer| match answer {
        RowAnswer::Collapse(collapsed) => Some(&**collapsed),
        _ => None,
    });
    of.word("method", |it| it.method.clone());
    of.number("surface_fraction", |it| it.surface_fraction);
    of.number("pitch_m", |it| it.pitch);
    of.number("work_of_adhesion_J_per_m2", |it| it.work);
    of.number("work_over_stiffness", |it| it.work_over_stiffness);
    of.number("collapse_work_J_per_m2", |it| it.collapse_work);
    of.number("work_over_collapse_work", |it| it.work_over_collapse_work);
    of.number_if_any("annulus_radius_m", |it| it.annulus_radius);
    of.number_if_any("net_work_J_per_m2", |it| it.net_work);
    of.number_if_any("smooth_floor_pull_off_force_N", |it| it.smooth_pull_off);
    of.number_if_any("annulus_slope", |it| it.annulus_slope);
    of.number("lens_number", |it| it.lens_number);
    of.number("column_number", |it| it.column_number);
    of.number("critical_force_N", |it| it.critical_force);
    of.number("critical_indentation_m", |it| it.critical_indentation);
    of.number("critical_contact_radius_m", |it| it.critical_contact_radius);
    of.number("relative_error_estimate_critical_force", |it| {
        it.relative_error_estimate_critical_force
    });
    jump_columns(&mut of, |it| it.jump);
    of.number_if_any("turn_indentation_m", |it| it.turn_indentation);
    of.word("fate", |it| it.fate.name().to_owned());
    loss_columns(&mut of, |it| it.lost);
    of.number_if_any("floor_pull_off_force_N", |it| it.pull_off);
    of.number_if_any("floor_hysteresis_J", |it| it.hysteresis);
    of.word("jump_validity", |it| it.jump_validity.name().to_owned());
    of.word("unloading_validity", |it| {
        it.unloading_validity.name().to_owned()
    });
    of.number_if_any("relative_model_error_jump_force", |it| it.force_error);
    of.number_if_any("relative_model_error_jump_floor_area", |it| it.area_error);
}

impl Values {
    /// The values of one of the columns, a value for every row of the table.
    fn of_entry<'a>(
        entry: &Entry,
        coordinate: Option<usize>,
        values: impl Iterator<Item = Option<&'a Recorded>>,
    ) -> Self {
        match entry.of {
            Type::Number | Type::Point => {
                let number = |value: Option<&Recorded>| match value? {
                    Recorded::Number(number) => Some(*number),
                    Recorded::Point(point) => Some(point[coordinate?]),
                    _ => None,
                };
                Self::Numbers(values.map(number).collect())
            }
            Type::Count => {
                let count = |value: Option<&Recorded>| match value? {
                    Recorded::Count(count) => i64::try_from(*count).ok(),
                    _ => None,
                };
                Self::Counts(values.map(count).collect())
            }
            Type::Flag => {
                let flag = |value: Option<&Recorded>| match value? {
                    Recorded::Flag(flag) => Some(*flag),
                    _ => None,
                };
                Self::Flags(values.map(flag).collect())
            }
            Type::Word | Type::Words => {
                let words = |value: Option<&Recorded>| match value? {
                    Recorded::Word(word) => Some(word.clone()),
                    Recorded::Words(words) => Some(words.join(" ")),
                    _ => None,
                };
                Self::Words(values.map(words).collect())
            }
        }
    }

    /// Number of values.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Counts(values) => values.len(),
            Self::Flags(values) => values.len(),
            Self::Words(values) => values.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn cell(&self, row: usize) -> String {
        match self {
            Self::Numbers(values) => values[row].map(|value| format!("{value:?}")),
            Self::Counts(values) => values[row].map(|value| value.to_string()),
            Self::Flags(values) => values[row].map(|value| value.to_string()),
            Self::Words(values) => values[row].clone(),
        }
        .unwrap_or_default()
    }

    fn json(&self, row: usize) -> Value {
        match self {
            Self::Numbers(values) => json!(values[row]),
            Self::Counts(values) => json!(values[row]),
            Self::Flags(values) => json!(values[row]),
            Self::Words(values) => json!(values[row]),
        }
    }
}
