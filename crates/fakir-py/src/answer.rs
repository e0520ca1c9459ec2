//! Results of all kinds: their numbers, as defined by the record.

use fakir::state::{Contact, Termination};
use fakir_study::record::{Entry, Kind, Record, Recorded, Type, Value};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Common base of contacts, critical states and cycles in Python.
#[pyclass(frozen, subclass, module = "fakir._fakir")]
pub(crate) struct Answer {
    record: Record,
    summary: String,
    termination: &'static str,
    warnings: Vec<String>,
}

#[pymethods]
impl Answer {
    /// The object that the program prints with `--json`.
    fn json(&self) -> &str {
        &self.summary
    }

    /// The numbers by their paths in the record.
    fn numbers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let numbers = PyDict::new(py);
        for (Entry { path, .. }, value) in self.record.values() {
            match value {
                Value::None => numbers.set_item(path, py.None())?,
                Value::Number(number) => numbers.set_item(path, number)?,
                Value::Count(count) => numbers.set_item(path, count)?,
                Value::Flag(flag) => numbers.set_item(path, flag)?,
                Value::Word(word) => numbers.set_item(path, word)?,
                Value::Words(words) => numbers.set_item(path, words)?,
                Value::Point([x, y]) => numbers.set_item(path, (x, y))?,
            }
        }
        Ok(numbers)
    }

    /// Reason for the end of the iteration.
    #[getter]
    fn termination(&self) -> &'static str {
        self.termination
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }
}

impl Answer {
    /// `summary` is the object that the program prints with `--json`.
    pub(crate) fn new<T: Recorded>(
        answer: &T,
        summary: String,
        termination: Termination,
        warnings: Vec<String>,
    ) -> Self {
        Self {
            record: Record::of(answer),
            summary,
            termination: termination.description(),
            warnings,
        }
    }
}

impl Answer {
    /// The same of a record.
    pub(crate) fn of_record(
        record: Record,
        summary: String,
        converged: bool,
        warnings: Vec<String>,
    ) -> Self {
        let termination = if converged {
            Termination::Converged
        } else {
            Termination::Stagnated
        };
        Self {
            record,
            summary,
            termination: termination.description(),
            warnings,
        }
    }
}

/// Warnings of a contact, except that it did not converge, which Python raises as an exception.
pub(crate) fn warnings(contact: &impl Contact) -> Vec<String> {
    let words = contact.warnings().iter().map(ToString::to_string);
    let unresolved = contact.unresolved().map(|it| it.to_string());
    words.chain(unresolved).collect()
}

/// A row of the record: path, unit, symbol, meaning, Python type, whether the value can be null in an object that is present, and whether
/// the object is null without it.
type Row = (
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    bool,
    bool,
);

/// The rows of the record for all kinds of results, in the order of the JSON objects.
#[pyfunction]
pub(crate) fn record() -> Vec<(&'static str, Vec<Row>)> {
    let row = |entry: &Entry| {
        let of = match entry.of {
            Type::Number => "float",
            Type::Count => "int",
            Type::Flag => "bool",
            Type::Word => "str",
            Type::Words => "list[str]",
            Type::Point => "tuple[float, float]",
        };
        let (unit, symbol) = (entry.unit(), entry.symbol);
        let (optional, decides) = (entry.optional, entry.decides);
        (
            entry.path,
            unit,
            symbol,
            entry.meaning,
            of,
            optional,
            decides,
        )
    };
    let rows = |kind: Kind| {
        let shown = kind.entries().iter().filter(|entry| entry.in_objects);
        (kind.name(), shown.map(row).collect())
    };
    let answers = Kind::ALL.into_iter().filter(|kind| !kind.is_a_row());
    answers.map(rows).collect()
}
