//! Measured curves of loading and unloading.

use super::column::{Column, DataError, branch};
use super::layout::{Hints, Layout, NamedColumn, SkipReason};
use super::orientation::{Reversed, are_negative, reversed};
use super::reading::{Reader, RowValues};
use fakir::state::Branch;
use fakir_case::input::LARGEST_TABLE;
use fakir_case::table_text::read_table;
use fakir_case::unit::{Dimension, format_quantity};
use std::ops::Range;
use std::path::Path;

/// Kind of the measured position of the lens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Position {
    /// Reading of the instrument; contact point and machine compliance convert it into an
    /// indentation.
    Displacement,
    /// The indentation itself.
    Indentation,
    /// The position was not measured, and the force is the load.
    None,
}

/// A measured value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Value in SI units.
    pub value: f64,
    /// Standard error, if known.
    pub error: Option<f64>,
}

/// One measured state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// Line in the file, or row number, from 1.
    pub line: u64,
    /// Displacement or indentation, m.
    pub position: Option<Measured>,
    /// Force, N.
    pub force: Option<Measured>,
    /// Contact radius, m.
    pub contact_radius: Option<Measured>,
    /// Branch, if the data contain it.
    pub branch: Option<Branch>,
    /// Time, s, if the data contain it.
    pub time: Option<f64>,
}

impl Measurement {
    /// Whether it has a load and a quantity measured under it.
    fn is_usable(&self) -> bool {
        match self.position {
            Some(_) => self.force.is_some() || self.contact_radius.is_some(),
            None => self.force.is_some() && self.contact_radius.is_some(),
        }
    }
}

/// A quantity that is compared with the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Normal force, N.
    Force,
    /// Contact radius, m.
    ContactRadius,
}

impl Quantity {
    /// Both quantities.
    pub const ALL: [Self; 2] = [Self::Force, Self::ContactRadius];

    /// Its name in a sentence.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::ContactRadius => "contact radius",
        }
    }

    /// Value of the quantity in a row that is compared with the model; a force that is the load is
    /// not compared.
    #[must_use]
    pub fn of(self, row: &Measurement) -> Option<Measured> {
        match self {
            Self::Force => row.position.and(row.force),
            Self::ContactRadius => row.contact_radius,
        }
    }
}

/// A measured loading experiment.
///
/// A file is a text, also packed by gzip (`.gz`), or a spreadsheet (`.xlsx`). It contains a heading, then a row for every state; cells that
/// were not measured are empty, or `NaN`, `Bad` or `-`. Columns are separated by commas, semicolons, tabs or blanks; with the others than commas, numbers
/// may have decimal commas. Lines before the heading and lines that begin with `#`, `%`, `;`, `//` or `!` are ignored. The following columns are recognised, in any order and in any known unit, which is in the name
/// (`force_uN`), in the heading (`Load [mN]`) or in a row of units below:
///
/// | column | |
/// |---|---|
/// | `displacement_m` | reading of the instrument; larger is deeper |
/// | `indentation_m` | in place of it: how far the lens has come down since its lowest point was level with the pillar tops |
/// | `force_N` | normal force |
/// | `contact_radius_m` | distance from the lens axis of the farthest point of a pillar top in contact |
/// | `time_s` | when, for a drift |
/// | `branch` | `loading` or `unloading`, also as a line between the rows; without it unloading begins after the largest load, also of several cycles |
///
/// Standard errors are in columns of the same names with `_error` before the unit: `displacement_error_m`, `indentation_error_m`,
/// `force_error_N`, `contact_radius_error_m`. A quantity has errors in all of its rows or in none. Other columns are not used;
/// [`layout`](Self::layout) returns the interpretation, and a [`NamedColumn`] names a column explicitly.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurements {
    name: String,
    position: Position,
    rows: Vec<Measurement>,
    layout: Layout,
    /// See [`unloading_point`](Self::unloading_point).
    unloading_point: Option<f64>,
}

impl Measurements {
    /// Reads a file, with the columns that the user names.
    ///
    /// # Errors
    /// [`DataError`] names file, line and column.
    pub fn read(path: &Path, named: &[NamedColumn]) -> Result<Self, DataError> {
        Self::read_with(path, &named.into())
    }

    /// Reads a file, with the hints of the user about its columns.
    ///
    /// # Errors
    /// [`DataError`] names file, line and column.
    pub fn read_with(path: &Path, hints: &Hints) -> Result<Self, DataError> {
        let name = path.display().to_string();
        match read_table(path, LARGEST_TABLE) {
            Ok(bytes) => Self::from_bytes(&name, &bytes, hints),
            Err(error) => {
                Err(Reader { name: &name }.fail(None, None, format!("cannot read: {error}")))
            }
        }
    }

    /// Reads the contents of a file; `name` is its name in errors.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn from_csv(name: &str, bytes: &[u8], named: &[NamedColumn]) -> Result<Self, DataError> {
        Self::from_bytes(name, bytes, &named.into())
    }

    /// Reads the contents of a text file, with the hints of the user about its columns; `name` is its name in errors.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn from_bytes(name: &str, bytes: &[u8], hints: &Hints) -> Result<Self, DataError> {
        let reader = Reader { name };
        let (mut layout, columns, rows) = reader.table(bytes, hints)?;
        let failure = layout.failure.take();
        let measurements = reader.measurements(layout, &columns, rows)?;
        match (failure, hints.last_row) {
            (Some(failure), Some(last)) if measurements.rows.len() < last => Err(failure),
            _ => Ok(measurements),
        }
    }

    /// Reads columns by their headings, as in a file, with values in the unit of the heading; `None` for columns that do not contain numbers and
    /// cannot be used. Branches are 0 for loading and 1 for unloading.
    ///
    /// # Errors
    /// [`DataError`]
    pub fn from_columns(
        columns: &[(String, Option<Vec<f64>>)],
        hints: &Hints,
    ) -> Result<Self, DataError> {
        let reader = Reader { name: "data" };
        let (layout, columns) = reader.arrays(columns, hints)?;
        reader.columns(layout, &columns)
    }

    /// Reads columns of values of the same length; NaN means not measured. Errors name them `the
    /// data` and number their rows from 1.
    ///
    /// # Errors
    /// [`DataError`]
    pub fn new(columns: &[(Column, Vec<f64>)]) -> Result<Self, DataError> {
        Reader { name: "data" }.columns(Layout::default(), columns)
    }

    /// Interpretation of a file or of the headings of columns.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    pub(super) fn layout_mut(&mut self) -> &mut Layout {
        &mut self.layout
    }

    /// Whether there are contact radii.
    pub(super) fn has_radii(&self) -> bool {
        self.rows.iter().any(|row| row.contact_radius.is_some())
    }

    /// The same without contact radii.
    pub(super) fn without_radii(&self) -> Self {
        let mut without = self.clone();
        for row in &mut without.rows {
            row.contact_radius = None;
        }
        without
    }

    pub(super) fn replace_rows(&mut self, rows: Vec<Measurement>) {
        self.rows = rows;
    }

    /// The load, as read, at which the unloading begins, if it is larger than the loads of all rows: that of a row that was not selected, or of one in
    /// which only the position was measured. The adhesive contact on unloading depends on it.
    #[must_use]
    pub fn unloading_point(&self) -> Option<f64> {
        self.unloading_point
    }

    /// Adds notes if the load cell seems to have been saturated, and if rows are repeated.
    fn note_repeated_rows(&mut self) {
        /// Fewest consecutive rows with the same force, and the fraction of a file that they must exceed, as one row of so many.
        const FEWEST: usize = 5;
        const ONE_OF: usize = 50;
        /// Smallest force of a limit, over the largest magnitude: small forces are equal because they are rounded.
        const LARGE: f64 = 0.3;
        let force = |row: &Measurement| row.force.map_or(f64::NAN, |force| force.value);
        let forces: Vec<f64> = self.rows.iter().map(force).collect();
        let loads = self.loads();
        let largest = forces
            .iter()
            .fold(0.0, |most: f64, force| most.max(force.abs()));
        let ends = [f64::min, f64::max].map(|end| forces.iter().copied().reduce(end));
        let is_end = |force: f64| ends.contains(&Some(force)) && force.abs() > LARGE * largest;
        let equal = forces.chunk_by(|one, other| one.total_cmp(other).is_eq());
        let mut first = 0;
        let mut notes = Vec::new();
        for run in equal {
            let rows = first..first + run.len();
            first = rows.end;
            let has_moved = loads[rows.start].total_cmp(&loads[rows.end - 1]).is_ne();
            let is_long = run.len() >= FEWEST.max(forces.len() / ONE_OF);
            if self.position != Position::None && is_long && has_moved && is_end(run[0]) {
                let force = format_quantity(run[0], Dimension::Force);
                let lines = [rows.start, rows.end - 1].map(|row| self.rows[row].line);
                notes.push(format!(
                    "{} rows (lines {} to {}) have the same extreme force of {force}: if the load cell was saturated, leave them out",
                    run.len(),
                    lines[0],
                    lines[1]
                ));
            }
        }
        let pairs = self.rows.windows(2);
        let repeated = pairs.filter(|pair| {
            let same = |of: fn(&Measurement) -> Option<Measured>| of(&pair[0]) == of(&pair[1]);
            same(|row| row.position) && same(|row| row.force) && same(|row| row.contact_radius)
        });
        let repeated = repeated.count();
        if 5 * repeated >= 2 * self.rows.len() && repeated >= FEWEST {
            notes.push(format!(
                "{repeated} rows repeat the row before them, so that the standard errors are too small: remove them"
            ));
        }
        self.layout.notes.extend(notes);
    }

    /// Keeps the load of a row that is left out if the unloading begins there, and adds a note.
    pub(super) fn keep_unloading_point(&mut self, load: f64, line: u64) {
        let loads = self.loads();
        let largest = loads.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let has_unloading = self.branches().contains(&Branch::Unloading);
        if has_unloading && load > largest.max(self.unloading_point.unwrap_or(f64::NEG_INFINITY)) {
            self.unloading_point = Some(load);
            let load = format_quantity(load, self.load_dimension());
            self.layout.notes.push(format!(
                "the unloading begins at {load}, the load of line {line}, which is otherwise left out"
            ));
        }
    }

    /// Sets a standard error of the force (N) if none was given.
    #[must_use]
    pub fn with_force_error(mut self, error: f64) -> Self {
        for force in self.rows.iter_mut().filter_map(|row| row.force.as_mut()) {
            force.error.get_or_insert(error);
        }
        self
    }

    /// Sets a standard error of the contact radius (m) if none was given.
    #[must_use]
    pub fn with_contact_radius_error(mut self, error: f64) -> Self {
        let radii = self
            .rows
            .iter_mut()
            .filter_map(|row| row.contact_radius.as_mut());
        for radius in radii {
            radius.error.get_or_insert(error);
        }
        self
    }

    /// Sets a standard error of displacement or indentation (m) if none was given.
    #[must_use]
    pub fn with_position_error(mut self, error: f64) -> Self {
        for position in self.rows.iter_mut().filter_map(|row| row.position.as_mut()) {
            position.error.get_or_insert(error);
        }
        self
    }

    /// Name of the file.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Kind of the measured position of the lens.
    #[must_use]
    pub fn position(&self) -> Position {
        self.position
    }

    /// Measured states.
    #[must_use]
    pub fn rows(&self) -> &[Measurement] {
        &self.rows
    }

    /// Whether all rows have a time, and the last is after the first: then a drift is linear in time.
    #[must_use]
    pub fn has_times(&self) -> bool {
        let times: Option<Vec<f64>> = self.rows.iter().map(|row| row.time).collect();
        times.is_some_and(|times| times.last() > times.first())
    }

    /// Branch of every row: as given, or from the motion.
    pub(super) fn branches(&self) -> Vec<Branch> {
        let by_motion = branches_of(&self.loads()).into_iter();
        let rows = self.rows.iter().zip(by_motion);
        rows.map(|(row, by_motion)| row.branch.unwrap_or(by_motion))
            .collect()
    }

    /// Load of every row: its position if measured, otherwise its force.
    pub(super) fn loads(&self) -> Vec<f64> {
        let loads = self.rows.iter().map(|row| row.position.or(row.force));
        loads
            .map(|load| load.map_or(0.0, |load| load.value))
            .collect()
    }

    /// Checks that cycles of loading and unloading are alike, because a fit with adhesion treats all rows as one cycle.
    pub(super) fn check_cycles(&self) -> Result<(), DataError> {
        let loads = self.loads();
        let least_change = TURN * range(&loads);
        let has_branches = self.rows.iter().any(|row| row.branch.is_some());
        let branches = self.branches();
        let largest = |cycle: &Range<usize>| {
            let loads = loads[cycle.clone()].iter().copied();
            loads.fold(f64::NEG_INFINITY, f64::max)
        };
        let turn = loads.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for cycle in self.cycles() {
            // Of branches that are given, a cycle may be part of one that turns elsewhere.
            let is_whole = !has_branches
                || [Branch::Loading, Branch::Unloading]
                    .iter()
                    .all(|branch| branches[cycle.clone()].contains(branch));
            let before = loads[cycle.start.saturating_sub(1)] - loads[0];
            let why = if is_whole && turn - largest(&cycle) > least_change {
                "turns at a smaller load than another"
            } else if !has_branches && before > least_change {
                "begins before the lens is back where the first began"
            } else {
                continue;
            };
            let lines = [cycle.start, cycle.end - 1].map(|row| self.rows[row].line);
            let positions = [Column::Displacement, Column::Indentation];
            let mut columns = self.layout.columns.iter();
            let position = columns.find(|read| {
                let is_position = |column| positions.contains(&column);
                read.column.is_some_and(is_position) && !read.is_canonical() && !read.negated
            });
            let sign = position.map_or(String::new(), |read| {
                let heading = &read.heading;
                format!("; or give displacement=\"-{heading}\" if the position decreases as the lens moves down")
            });
            let problem = format!(
                "lines {} to {} are a cycle of loading and unloading that {why}: with adhesion a fit takes cycles that are alike; choose one \
                 (--cycle 1, in Python cycle=1), or fit each by itself{sign}",
                lines[0], lines[1]
            );
            return Err(Reader { name: &self.name }.fail(Some(lines[0]), None, problem));
        }
        Ok(())
    }

    /// Checks that either all rows have a branch or none.
    pub(super) fn check_branches(&self) -> Result<(), DataError> {
        let missing = self.rows.iter().find(|row| row.branch.is_none());
        match missing {
            Some(row) if self.rows.iter().any(|row| row.branch.is_some()) => {
                let reader = Reader { name: &self.name };
                let problem = "no branch here, but in other rows: give all of them or none";
                Err(reader.fail(Some(row.line), Some(Column::Branch.name()), problem))
            }
            _ => Ok(()),
        }
    }

    /// Checks that a quantity has errors either in all rows or in none.
    pub(super) fn check_errors(&self) -> Result<(), DataError> {
        type Pick = fn(&Measurement) -> Option<Measured>;
        let position = match self.position {
            Position::Indentation => Column::IndentationError,
            _ => Column::DisplacementError,
        };
        let quantities: [(Column, Pick); 3] = [
            (position, |row| row.position),
            (Column::ForceError, |row| row.force),
            (Column::ContactRadiusError, |row| row.contact_radius),
        ];
        for (column, pick) in quantities {
            let values = || {
                self.rows
                    .iter()
                    .filter_map(|row| Some((row.line, pick(row)?)))
            };
            let some = values().any(|(_, value)| value.error.is_some());
            let missing = values().find(|(_, value)| value.error.is_none());
            if let (true, Some((line, _))) = (some, missing) {
                let problem = "no standard error here, but in other rows: give all of them or none";
                return Err(Reader { name: &self.name }.fail(
                    Some(line),
                    Some(column.name()),
                    problem,
                ));
            }
        }
        Ok(())
    }
}

/// Smallest change of the load, as a fraction of the range of all loads, that counts as a reversal; smaller changes
/// are noise.
const TURN: f64 = 0.1;

/// Difference between the largest and the smallest value.
fn range(loads: &[f64]) -> f64 {
    let [least, largest] = loads.iter().fold(
        [f64::INFINITY, f64::NEG_INFINITY],
        |[least, largest], load| [least.min(*load), largest.max(*load)],
    );
    largest - least
}

/// Branches from the motion: loading up to the first of the largest loads, unloading down to the first of the smallest loads after it, and so
/// on.
fn branches_of(loads: &[f64]) -> Vec<Branch> {
    let least_change = TURN * range(loads);
    let mut branches = vec![Branch::Loading; loads.len()];
    let mut branch = Branch::Loading;
    let mut turn = 0;
    for (row, load) in loads.iter().enumerate() {
        let further = match branch {
            Branch::Loading => load - loads[turn],
            Branch::Unloading => loads[turn] - load,
        };
        if further > 0.0 {
            turn = row;
        } else if -further > least_change {
            let other = match branch {
                Branch::Loading => Branch::Unloading,
                Branch::Unloading => Branch::Loading,
            };
            branches[turn + 1..].fill(other);
            branch = other;
            turn = row;
        }
    }
    // Small steps back after the last of the largest loads belong to the unloading.
    if branch == Branch::Loading {
        branches[turn + 1..].fill(Branch::Unloading);
    }
    branches
}

/// Reverses signs that differ from those of columns whose names define them, and notes it.
fn orient(layout: &mut Layout, rows: &mut [(u64, RowValues)], position: Position) {
    let is_free = |wanted: &[Column]| {
        let columns = layout.columns.iter();
        let mut columns =
            columns.filter(|read| read.column.is_some_and(|column| wanted.contains(&column)));
        columns.clone().next().is_some()
            && columns.all(|read| !read.is_canonical() && !read.by_hand)
    };
    let positions = [Column::Displacement, Column::Indentation];
    let [can_turn_position, can_turn_force] = [is_free(&positions), is_free(&[Column::Force])];
    let found = match position {
        Position::None => Reversed {
            position: false,
            force: are_negative(rows),
        },
        _ => reversed(rows, layout.is_sign_open),
    };
    // One sign alone is not changed if both are wrong.
    let is_wrong = |column: Option<Column>| match column {
        Some(Column::Force) => found.force && !can_turn_force,
        Some(column) => positions.contains(&column) && found.position && !can_turn_position,
        None => false,
    };
    let wrong = layout.columns.iter().filter(|read| is_wrong(read.column));
    let wrong: Vec<String> = wrong
        .filter_map(|read| Some((read.column?.quantity(), read)))
        .map(|(quantity, read)| {
            let sign = if read.negated { "" } else { "-" };
            format!("{quantity}=\"{sign}{}\"", read.heading)
        })
        .collect();
    if !wrong.is_empty() {
        layout.notes.push(format!(
            "the data look like a compression with another sign, which is not reversed where the name or the user defines it: did you mean {}?",
            wrong.join(" and ")
        ));
        return;
    }
    let mut turn = |wanted: &[Column], note: &str| {
        let values = rows.iter_mut().flat_map(|(_, row)| row);
        for (_, value) in values.filter(|(column, _)| wanted.contains(column)) {
            *value = -*value;
        }
        for read in &mut layout.columns {
            if read.column.is_some_and(|column| wanted.contains(&column)) {
                read.negated = !read.negated;
            }
        }
        layout.notes.push(note.to_owned());
    };
    if found.force {
        turn(
            &[Column::Force],
            "compression is counted negative in the data: the sign of the force is reversed",
        );
    }
    if found.position {
        let note = "the position decreases as the lens moves down: its sign is reversed";
        turn(&positions, note);
    }
}

impl Reader<'_> {
    fn measurements(
        &self,
        layout: Layout,
        columns: &[Column],
        rows: Vec<(u64, RowValues)>,
    ) -> Result<Measurements, DataError> {
        let position = self.check_columns(&layout, columns)?;
        let (mut layout, mut rows) = (layout, rows);
        orient(&mut layout, &mut rows, position);
        let mut measurements = Measurements {
            name: self.name.to_owned(),
            position,
            rows: Vec::new(),
            layout,
            unloading_point: None,
        };
        let mut not_measured = Vec::new();
        let mut farthest: Option<(f64, u64)> = None;
        let mut passed: Option<(f64, u64)> = None;
        for (line, cells) in rows {
            let row = self.measurement(line, &cells)?;
            if row.is_usable() {
                measurements.rows.push(row);
                // Between rows that are used.
                farthest = passed;
                continue;
            }
            not_measured.push(line);
            let position = row.position.filter(|_| !measurements.rows.is_empty());
            if let Some(position) = position
                && passed.is_none_or(|(load, _)| position.value > load)
            {
                passed = Some((position.value, line));
            }
        }
        if measurements.rows.is_empty() {
            let problem = "no row with a load and something measured under it";
            return Err(self.fail(None, None, problem));
        }
        measurements
            .layout
            .skip(SkipReason::NotMeasured, not_measured);
        if let Some((load, line)) = farthest {
            measurements.keep_unloading_point(load, line);
        }
        measurements.note_cycles();
        measurements.note_repeated_rows();
        Ok(measurements)
    }

    /// Builds measurements from columns of values and their interpretation.
    fn columns(
        &self,
        layout: Layout,
        columns: &[(Column, Vec<f64>)],
    ) -> Result<Measurements, DataError> {
        let length = columns.first().map_or(0, |(_, values)| values.len());
        for (number, (column, values)) in columns.iter().enumerate() {
            let name = Some(column.name());
            if values.len() != length {
                let problem = format!("has {} values, but the first column {length}", values.len());
                return Err(self.fail(None, name, problem));
            }
            if columns[..number].iter().any(|(other, _)| other == column) {
                return Err(self.fail(None, name, "is given twice"));
            }
        }
        let row = |k: usize| {
            let cells = columns.iter().map(|(column, values)| (*column, values[k]));
            (
                k as u64 + 1,
                cells.filter(|(_, value)| !value.is_nan()).collect(),
            )
        };
        let names: Vec<Column> = columns.iter().map(|(column, _)| *column).collect();
        self.measurements(layout, &names, (0..length).map(row).collect())
    }

    fn check_columns(&self, layout: &Layout, columns: &[Column]) -> Result<Position, DataError> {
        let has = |column: Column| columns.contains(&column);
        for column in columns {
            if let Some(owner) = column.errors_of().filter(|owner| !has(*owner)) {
                let problem = format!("errors of a column that is not there: {}", owner.name());
                return Err(self.fail(None, Some(column.name()), problem));
            }
        }
        let position = match (has(Column::Displacement), has(Column::Indentation)) {
            (true, true) => {
                let problem = "displacement_m and indentation_m: give only one of them, or name the one that counts by hand";
                return Err(self.fail(None, None, problem));
            }
            (true, false) => Position::Displacement,
            (false, true) => Position::Indentation,
            (false, false) => Position::None,
        };
        let enough = match position {
            Position::None => has(Column::Force) && has(Column::ContactRadius),
            _ => has(Column::Force) || has(Column::ContactRadius),
        };
        if !enough {
            let mut problem =
                "columns are missing: at least two of displacement_m (or indentation_m), \
                               force_N and contact_radius_m must be there"
                    .to_owned();
            if !layout.columns.is_empty() {
                problem += &format!("; seen were {}", layout.seen());
                problem += "; columns can be named by hand, as force=\"HEADING [mN]\"";
            }
            return Err(self.fail(None, None, problem));
        }
        Ok(position)
    }

    fn measurement(&self, line: u64, cells: &RowValues) -> Result<Measurement, DataError> {
        let mut row = Measurement {
            line,
            position: None,
            force: None,
            contact_radius: None,
            branch: None,
            time: None,
        };
        for (column, value) in cells {
            if let Some(problem) = column.problem(*value) {
                let problem = format!("{value}: {problem}");
                return Err(self.fail(Some(line), Some(column.name()), problem));
            }
            let of = |error: Column| {
                let error = cells.iter().find(|(column, _)| *column == error);
                Some(Measured {
                    value: *value,
                    error: error.map(|(_, value)| *value),
                })
            };
            match column {
                Column::Displacement => row.position = of(Column::DisplacementError),
                Column::Indentation => row.position = of(Column::IndentationError),
                Column::Force => row.force = of(Column::ForceError),
                Column::ContactRadius => row.contact_radius = of(Column::ContactRadiusError),
                Column::Time => row.time = Some(*value),
                Column::Branch => row.branch = branch(*value),
                _ => {}
            }
        }
        match (row.position, row.force) {
            (None, Some(force))
                if force.value < 0.0 && row.contact_radius.is_some() && row.branch.is_none() =>
            {
                let problem = format!(
                    "{}: a force that is the load cannot be negative, unless a column branch states whether it \
                     was measured on loading or on unloading",
                    force.value
                );
                Err(self.fail(Some(line), Some(Column::Force.name()), problem))
            }
            _ => Ok(row),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signs(loads: &[f64]) -> String {
        let branches = branches_of(loads).into_iter();
        branches
            .map(|branch| if branch == Branch::Loading { '+' } else { '-' })
            .collect()
    }

    #[test]
    fn branches_follow_the_motion() {
        // One cycle: unloading from the first of the largest loads on, even if it has only just
        // started.
        assert_eq!(signs(&[0.0, 5.0, 4.8, 10.0, 10.0, 9.5, 2.0]), "++++---");
        assert_eq!(signs(&[0.0, 10.0, 9.9]), "++-");
        assert_eq!(signs(&[10.0, 5.0, 0.0, 0.5]), "+---");
        assert_eq!(signs(&[3.0]), "+");
        // Two cycles, with noise at the reversals.
        let twice = [
            0.0, 4.0, 10.0, 9.7, 9.9, 4.0, 0.0, 0.4, 0.1, 4.0, 10.0, 5.0, 0.0,
        ];
        assert_eq!(signs(&twice), "+++----++++--");
    }

    #[test]
    fn cycles_that_are_not_alike_are_refused() {
        let message = |loads: &[f64]| {
            let columns = [Column::Indentation, Column::Force].map(|it| (it, loads.to_vec()));
            let message = Measurements::new(&columns).unwrap().check_cycles();
            message.map_err(|error| error.to_string())
        };
        assert_eq!(message(&[0.0, 10.0, 0.0, 10.0, 0.0]), Ok(()));
        let smaller = message(&[0.0, 10.0, 0.0, 6.0, 0.0]).unwrap_err();
        assert!(
            smaller.starts_with("data:4: lines 4 to 5 are a cycle"),
            "{smaller}"
        );
        assert!(smaller.contains("--cycle 1"), "{smaller}");
        let not_back = message(&[0.0, 10.0, 4.0, 6.0, 10.0, 0.0]).unwrap_err();
        assert!(not_back.contains("lines 4 to 6") && not_back.contains("before the lens is back"));
    }
}
