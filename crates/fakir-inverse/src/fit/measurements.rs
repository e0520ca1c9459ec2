//! Measured curves of loading and unloading.

use fakir::state::Branch;
use fakir_case::input::{self, LARGEST_TABLE};
use std::path::Path;

/// A column of measured values, in SI units; the branch as 0 of loading and 1 of unloading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // see `Column::name`
pub enum Column {
    Displacement,
    DisplacementError,
    Indentation,
    IndentationError,
    Force,
    ForceError,
    ContactRadius,
    ContactRadiusError,
    Branch,
}

impl Column {
    /// All columns.
    pub const ALL: [Self; 9] = [
        Self::Displacement,
        Self::DisplacementError,
        Self::Indentation,
        Self::IndentationError,
        Self::Force,
        Self::ForceError,
        Self::ContactRadius,
        Self::ContactRadiusError,
        Self::Branch,
    ];

    /// Its heading: `"displacement_m"`, `"force_error_N"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement_m",
            Self::DisplacementError => "displacement_error_m",
            Self::Indentation => "indentation_m",
            Self::IndentationError => "indentation_error_m",
            Self::Force => "force_N",
            Self::ForceError => "force_error_N",
            Self::ContactRadius => "contact_radius_m",
            Self::ContactRadiusError => "contact_radius_error_m",
            Self::Branch => "branch",
        }
    }

    /// The column of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|column| column.name() == name)
    }

    /// Of a column of standard errors, the column they belong to.
    fn errors_of(self) -> Option<Self> {
        match self {
            Self::DisplacementError => Some(Self::Displacement),
            Self::IndentationError => Some(Self::Indentation),
            Self::ForceError => Some(Self::Force),
            Self::ContactRadiusError => Some(Self::ContactRadius),
            _ => None,
        }
    }

    fn problem(self, value: f64) -> Option<&'static str> {
        match self {
            _ if !value.is_finite() => Some("must be a finite number"),
            Self::Branch if branch(value).is_none() => {
                Some("a branch is 0 for loading or 1 for unloading")
            }
            Self::DisplacementError | Self::IndentationError if value < 0.0 => {
                Some("a standard error cannot be negative")
            }
            Self::ForceError | Self::ContactRadiusError if value <= 0.0 => Some(
                "a standard error must be greater than 0; leave the column out and the scatter \
                 is estimated",
            ),
            Self::ContactRadius if value < 0.0 => Some("a contact radius cannot be negative"),
            _ => None,
        }
    }
}

/// The branch that a value of the column stands for.
fn branch(value: f64) -> Option<Branch> {
    let mut named = [(0.0, Branch::Loading), (1.0, Branch::Unloading)].into_iter();
    named.find_map(|(number, branch)| value.total_cmp(&number).is_eq().then_some(branch))
}

/// What the position of the lens was measured as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Position {
    /// The reading of the instrument, which the contact point and the compliance of the machine
    /// turn into an indentation.
    Displacement,
    /// The indentation itself.
    Indentation,
    /// The position was not measured, and the force is the load.
    None,
}

/// A measured value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// In SI units.
    pub value: f64,
    /// Standard error, if it is known.
    pub error: Option<f64>,
}

/// One measured state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// Line of the file it is from, or its number, counted from 1.
    pub line: u64,
    /// Displacement or indentation, m.
    pub position: Option<Measured>,
    /// Force, N.
    pub force: Option<Measured>,
    /// Contact radius, m.
    pub contact_radius: Option<Measured>,
    /// Whether it was measured on loading or on unloading, if the data say so.
    pub branch: Option<Branch>,
}

impl Measurement {
    /// Whether it has a load and something that was measured under it.
    fn is_usable(&self) -> bool {
        match self.position {
            Some(_) => self.force.is_some() || self.contact_radius.is_some(),
            None => self.force.is_some() && self.contact_radius.is_some(),
        }
    }
}

/// A measured loading experiment.
///
/// As a CSV file: a heading, then a row for every state, cells that were not measured empty; lines
/// that begin with `#` are passed over. Columns, in any order and as far as measured, in SI units:
///
/// | column | |
/// |---|---|
/// | `displacement_m` | reading of the instrument; larger is deeper |
/// | `indentation_m` | in place of it: how far the lens has come down since its lowest point was level with the pillar tops |
/// | `force_N` | normal force |
/// | `contact_radius_m` | distance from the lens axis of the farthest point of a pillar top in contact |
///
/// | `branch` | `loading` or `unloading`; without it unloading begins after the largest load |
///
/// and their standard errors in columns of the same names with `_error` before the unit:
/// `displacement_error_m`, `indentation_error_m`, `force_error_N`, `contact_radius_error_m`. A
/// quantity has errors in all of its rows or in none.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurements {
    name: String,
    position: Position,
    rows: Vec<Measurement>,
}

/// Why measured values cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{name}{}: {}{problem}", .line.map_or(String::new(), |line| format!(":{line}")),
        .column.as_ref().map_or(String::new(), |column| format!("{column}: ")))]
pub struct DataError {
    /// The file.
    pub name: String,
    /// The line in it.
    pub line: Option<u64>,
    /// The column.
    pub column: Option<String>,
    /// What is wrong, and what would be right.
    pub problem: String,
}

/// The values of one row of the file, each with its column.
type RowValues = Vec<(Column, f64)>;

impl Measurements {
    /// Reads a CSV file.
    ///
    /// # Errors
    /// [`DataError`] names file, line and column.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let name = path.display().to_string();
        match input::read(path, LARGEST_TABLE) {
            Ok(bytes) => Self::from_csv(&name, &bytes),
            Err(error) => {
                Err(Reader { name: &name }.fail(None, None, format!("cannot read: {error}")))
            }
        }
    }

    /// Reads the contents of a CSV file; `name` is what errors call it.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn from_csv(name: &str, bytes: &[u8]) -> Result<Self, DataError> {
        let reader = Reader { name };
        let (columns, rows) = reader.table(bytes)?;
        reader.measurements(&columns, rows)
    }

    /// Columns of values, all of the same length; NaN stands for what was not measured. Errors call
    /// them the data, and count their rows from 1.
    ///
    /// # Errors
    /// [`DataError`]
    pub fn new(columns: &[(Column, Vec<f64>)]) -> Result<Self, DataError> {
        let reader = Reader { name: "data" };
        let length = columns.first().map_or(0, |(_, values)| values.len());
        for (number, (column, values)) in columns.iter().enumerate() {
            let name = Some(column.name());
            if values.len() != length {
                let problem = format!("has {} values, but the first column {length}", values.len());
                return Err(reader.fail(None, name, problem));
            }
            if columns[..number].iter().any(|(other, _)| other == column) {
                return Err(reader.fail(None, name, "is given twice"));
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
        reader.measurements(&names, (0..length).map(row).collect())
    }

    /// The same with a standard error of the force (N) where none was given.
    #[must_use]
    pub fn with_force_error(mut self, error: f64) -> Self {
        for force in self.rows.iter_mut().filter_map(|row| row.force.as_mut()) {
            force.error.get_or_insert(error);
        }
        self
    }

    /// The same with a standard error of the contact radius (m) where none was given.
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

    /// The same with a standard error of displacement or indentation (m) where none was given.
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

    /// What the position of the lens was measured as.
    #[must_use]
    pub fn position(&self) -> Position {
        self.position
    }

    /// The states that were measured.
    #[must_use]
    pub fn rows(&self) -> &[Measurement] {
        &self.rows
    }

    /// The branch of every row: as given, or loading up to the first of the largest loads and unloading after it.
    pub(super) fn branches(&self) -> Vec<Branch> {
        let load = |row: &Measurement| row.position.or(row.force).map_or(0.0, |m| m.value);
        let mut turn = 0;
        for (number, row) in self.rows.iter().enumerate() {
            if load(row) > load(&self.rows[turn]) {
                turn = number;
            }
        }
        let rows = self.rows.iter().enumerate();
        rows.map(|(number, row)| {
            row.branch.unwrap_or(if number > turn {
                Branch::Unloading
            } else {
                Branch::Loading
            })
        })
        .collect()
    }

    /// Checks that all rows have a branch or none.
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

    /// Checks that a quantity has errors in all rows or in none.
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

/// Columns, and for every row its line in the file and its values.
type Table = (Vec<Column>, Vec<(u64, RowValues)>);

/// The number that the text of a cell stands for.
fn value(column: Column, text: &str) -> Result<f64, String> {
    if column == Column::Branch {
        let mut numbers = [0.0, 1.0].into_iter();
        let is_named = |number: &f64| branch(*number).is_some_and(|branch| branch.name() == text);
        return numbers
            .find(is_named)
            .ok_or_else(|| format!("\"{text}\" is no branch: give loading or unloading"));
    }
    text.parse()
        .map_err(|_| format!("\"{text}\" is no number: give one like 1.2e-5, without unit"))
}

struct Reader<'a> {
    name: &'a str,
}

impl Reader<'_> {
    fn fail(
        &self,
        line: Option<u64>,
        column: Option<&str>,
        problem: impl Into<String>,
    ) -> DataError {
        DataError {
            name: self.name.to_owned(),
            line,
            column: column.map(str::to_owned),
            problem: problem.into(),
        }
    }

    fn table(&self, bytes: &[u8]) -> Result<Table, DataError> {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(bytes);
        let bad = |error: &csv::Error| {
            let line = error.position().map(csv::Position::line);
            let problem = match error.kind() {
                csv::ErrorKind::UnequalLengths {
                    expected_len, len, ..
                } => {
                    format!("{len} cells, but {expected_len} in the heading")
                }
                csv::ErrorKind::Utf8 { .. } => "is not UTF-8 text".to_owned(),
                _ => error.to_string(),
            };
            self.fail(line, None, problem)
        };
        let heading = reader.headers().map_err(|error| bad(&error))?.clone();
        let line = heading.position().map_or(1, csv::Position::line);
        let columns = self.columns(&heading, line)?;
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| bad(&error))?;
            let line = record.position().map_or(0, csv::Position::line);
            let mut cells = RowValues::new();
            for (column, text) in columns.iter().zip(&record) {
                if text.is_empty() {
                    continue;
                }
                let value = value(*column, text)
                    .map_err(|problem| self.fail(Some(line), Some(column.name()), problem))?;
                cells.push((*column, value));
            }
            rows.push((line, cells));
        }
        Ok((columns, rows))
    }

    fn columns(&self, heading: &csv::StringRecord, line: u64) -> Result<Vec<Column>, DataError> {
        let known = || Column::ALL.map(Column::name).join(", ");
        if heading.iter().all(str::is_empty) {
            let problem = format!(
                "no heading: the first line names the columns, of {}",
                known()
            );
            return Err(self.fail(None, None, problem));
        }
        let mut columns = Vec::new();
        for name in heading {
            let fail = |problem: String| self.fail(Some(line), Some(name), problem);
            let column = Column::named(name).ok_or_else(|| match name.parse::<f64>() {
                Ok(_) => {
                    fail("a number in the heading: the first line names the columns".to_owned())
                }
                Err(_) => fail(format!("unknown column; known, in SI units: {}", known())),
            })?;
            if columns.contains(&column) {
                return Err(fail("is there twice".to_owned()));
            }
            columns.push(column);
        }
        Ok(columns)
    }

    fn measurements(
        &self,
        columns: &[Column],
        rows: Vec<(u64, RowValues)>,
    ) -> Result<Measurements, DataError> {
        let position = self.check_columns(columns)?;
        let mut measurements = Measurements {
            name: self.name.to_owned(),
            position,
            rows: Vec::new(),
        };
        for (line, cells) in rows {
            let row = self.measurement(line, &cells)?;
            if row.is_usable() {
                measurements.rows.push(row);
            }
        }
        if measurements.rows.is_empty() {
            let problem = "no row with a load and something measured under it";
            return Err(self.fail(None, None, problem));
        }
        Ok(measurements)
    }

    fn check_columns(&self, columns: &[Column]) -> Result<Position, DataError> {
        let has = |column: Column| columns.contains(&column);
        for column in columns {
            if let Some(owner) = column.errors_of().filter(|owner| !has(*owner)) {
                let problem = format!("errors of a column that is not there: {}", owner.name());
                return Err(self.fail(None, Some(column.name()), problem));
            }
        }
        let position = match (has(Column::Displacement), has(Column::Indentation)) {
            (true, true) => {
                let problem = "displacement_m and indentation_m: give only one of them";
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
            let problem = "columns are missing: at least two of displacement_m (or indentation_m), \
                           force_N and contact_radius_m must be there";
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
                Column::Branch => row.branch = branch(*value),
                _ => {}
            }
        }
        match (row.position, row.force) {
            (None, Some(force))
                if force.value < 0.0 && row.contact_radius.is_some() && row.branch.is_none() =>
            {
                let problem = format!(
                    "{}: a force that is the load cannot be negative, unless a column branch says whether it \
                     was measured on loading or on unloading",
                    force.value
                );
                Err(self.fail(Some(line), Some(Column::Force.name()), problem))
            }
            _ => Ok(row),
        }
    }
}
