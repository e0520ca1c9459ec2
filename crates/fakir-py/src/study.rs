//! Sweeps: studies, and the ledger that stores their results.

use crate::error::{study_error, value_error, warn_of_file};
use crate::watched::{check_signals, stoppable};
use fakir::state::CancelToken;
use fakir_case::StudyFile;
use fakir_case::study::{Combine, Coordinate};
use fakir_study::{Existing, Options, Progress, StudyError, Table, Values};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard};

/// A case with axes along which it is varied.
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct Study {
    study: Arc<fakir_case::Study>,
}

/// Name of the column, path of the key, and the values.
type PyAxis<'py> = (String, &'static str, Bound<'py, PyAny>);

#[pymethods]
impl Study {
    /// Reads a study file.
    #[staticmethod]
    fn read(path: PathBuf, overrides: Vec<String>) -> PyResult<Self> {
        let file = StudyFile::read(&path).map_err(|error| study_error(&error.into()))?;
        Self::of(file, &overrides)
    }

    /// Reads the text of a study file; `name` is used in error messages.
    #[staticmethod]
    fn parse(name: &str, text: &str, overrides: Vec<String>) -> PyResult<Self> {
        let file = StudyFile::parse(name, text).map_err(|error| study_error(&error.into()))?;
        Self::of(file, &overrides)
    }

    /// The study as a file.
    fn to_toml(&self) -> &str {
        self.study.to_toml()
    }

    #[getter]
    fn cases(&self) -> usize {
        self.study.cases()
    }

    /// Descriptions of keys that change no result of any case.
    #[getter]
    fn without_effect(&self) -> Vec<String> {
        self.study.without_effect().to_vec()
    }

    /// `"transition"` or `"press"`.
    #[getter]
    fn question(&self) -> &'static str {
        self.study.asked().name()
    }

    /// Whether every value of an axis is combined with every value of the others.
    #[getter]
    fn is_product(&self) -> bool {
        self.study.combine() == Combine::Product
    }

    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Vec<PyAxis<'py>>> {
        self.study
            .axes()
            .map(|axis| {
                let values = PyList::empty(py);
                for step in 0..axis.len() {
                    match axis.value(step) {
                        Coordinate::Number(number) => values.append(number)?,
                        Coordinate::Word(word) => values.append(word)?,
                    }
                }
                let variable = axis.variable();
                Ok((variable.column(), variable.path(), values.into_any()))
            })
            .collect()
    }
}

impl Study {
    fn of(mut file: StudyFile, overrides: &[String]) -> PyResult<Self> {
        for setting in overrides {
            let set = file.set(setting);
            set.map_err(|error| study_error(&error.into()))?;
        }
        warn_of_file(file.case())?;
        let study = file.study().map_err(|error| study_error(&error.into()))?;
        Ok(Self {
            study: Arc::new(study),
        })
    }
}

/// Solves some cases of a study: lines of a journal, in the order of the cases.
#[pyfunction]
pub(crate) fn solve_cases(
    py: Python<'_>,
    study: &Study,
    cases: Vec<usize>,
    memory_limit: Option<usize>,
) -> PyResult<Vec<String>> {
    if let Some(case) = cases.iter().find(|case| **case >= study.study.cases()) {
        return Err(value_error(format!("there is no case {case}")));
    }
    let (cancel, study) = (CancelToken::default(), study.study.as_ref());
    let work = || fakir_study::solve(study, &cases, memory_limit, &cancel);
    let rows = py.detach(|| stoppable(&cancel, work, check_signals))?;
    let rows = rows.map_err(|error| study_error(&error))?;
    Ok(rows.iter().map(fakir_study::Row::to_json).collect())
}

/// The results of a sweep, in a folder or in memory.
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct Ledger {
    study: Arc<fakir_case::Study>,
    ledger: Mutex<Option<fakir_study::Ledger>>,
    memory_limit: Option<usize>,
}

/// Columns of a table with their values.
pub(crate) type PyColumns<'py> = Vec<(String, Bound<'py, PyAny>)>;

/// The columns of a sweep, and the whole table as CSV.
type Finished<'py> = (PyColumns<'py>, String);

#[pymethods]
impl Ledger {
    /// `existing` selects the treatment of a folder that is not empty: `"refuse"`, `"resume"` or `"overwrite"`.
    #[new]
    fn new(
        study: &Study,
        folder: Option<PathBuf>,
        existing: &str,
        memory_limit: Option<usize>,
    ) -> PyResult<Self> {
        let existing = match existing {
            "resume" => Existing::Resume,
            "overwrite" => Existing::Overwrite,
            _ => Existing::Refuse,
        };
        let options = Options {
            memory_limit,
            ..Options::default()
        };
        let ledger = match folder {
            None => fakir_study::Ledger::in_memory(&study.study),
            Some(folder) => fakir_study::Ledger::open(&study.study, &folder, existing, &options)
                .map_err(|error| study_error(&error))?,
        };
        Ok(Self {
            study: study.study.clone(),
            ledger: Mutex::new(Some(ledger)),
            memory_limit,
        })
    }

    /// Cases without a result, in groups that should be computed together and in order; the groups with the longest expected time come
    /// first.
    fn remaining(&self) -> PyResult<Vec<Vec<usize>>> {
        Ok(self.open()?.get()?.remaining())
    }

    /// Number of cases with a result.
    #[getter]
    fn done(&self) -> PyResult<usize> {
        Ok(self.open()?.get()?.rows().len())
    }

    /// Number of results found in the journal.
    #[getter]
    fn found(&self) -> PyResult<usize> {
        Ok(self.open()?.get()?.found())
    }

    /// Descriptions of journal lines that are skipped.
    #[getter]
    fn damaged(&self) -> PyResult<Vec<String>> {
        let mut open = self.open()?;
        Ok(open
            .get()?
            .damaged()
            .iter()
            .map(ToString::to_string)
            .collect())
    }

    /// Number of cases without a reliable result.
    #[getter]
    fn failed(&self) -> PyResult<usize> {
        Ok(self.open()?.get()?.failed())
    }

    /// Adds results, as lines of a journal. Cases that have one already keep it.
    fn append(&self, py: Python<'_>, lines: Vec<String>) -> PyResult<()> {
        py.detach(|| {
            self.open()?
                .get()?
                .append(&lines)
                .map_err(|e| study_error(&e))
        })
    }

    /// Computes the remaining cases on this machine. Progress is reported as the numbers of cases done, found, failed and in total.
    fn run(&self, py: Python<'_>, threads: usize, progress: Option<Py<PyAny>>) -> PyResult<()> {
        let latest: Mutex<Option<Progress>> = Mutex::new(None);
        let cancel = CancelToken::default();
        let token = cancel.clone();
        let work = || {
            let mut listener = |progress| {
                if let Ok(mut latest) = latest.lock() {
                    *latest = Some(progress);
                }
            };
            let mut options = Options {
                threads,
                cancel: token,
                memory_limit: self.memory_limit,
                on_progress: Some(&mut listener),
                ..Options::default()
            };
            let mut ledger = self.open()?;
            ledger
                .get()?
                .complete(&mut options)
                .map_err(|error| study_error(&error))
        };
        let look = || {
            Python::attach(|py| {
                py.check_signals()?;
                let news = latest.lock().ok().and_then(|mut latest| latest.take());
                if let (Some(listener), Some(news)) = (&progress, news) {
                    listener.call1(py, (news.done, news.found, news.failed, news.cases))?;
                }
                Ok::<_, PyErr>(())
            })
        };
        py.detach(|| stoppable(&cancel, work, look))?
    }

    /// Writes the tables, if the ledger is in a folder, and returns them.
    fn finish<'py>(&self, py: Python<'py>) -> PyResult<Finished<'py>> {
        let ledger = self.open()?.take()?;
        let summary = py.detach(|| ledger.finish());
        let summary = summary.map_err(|error| study_error(&error))?;
        let table = Table::new(&self.study, &summary.rows);
        Ok((columns(py, &table)?, table.to_csv()))
    }

    /// Closes the ledger, so that another sweep can use its folder.
    fn close(&self) {
        if let Ok(mut ledger) = self.ledger.lock() {
            *ledger = None;
        }
    }
}

impl Ledger {
    fn open(&self) -> PyResult<Open<'_>> {
        let ledger = self.ledger.lock();
        ledger
            .map(Open)
            .map_err(|_| study_error(&StudyError::Shards("the sweep was given up".to_owned())))
    }
}

/// Exclusive access to a ledger.
struct Open<'a>(MutexGuard<'a, Option<fakir_study::Ledger>>);

impl Open<'_> {
    fn get(&mut self) -> PyResult<&mut fakir_study::Ledger> {
        self.0.as_mut().ok_or_else(closed)
    }

    fn take(&mut self) -> PyResult<fakir_study::Ledger> {
        self.0.take().ok_or_else(closed)
    }
}

fn closed() -> PyErr {
    value_error("this sweep is closed")
}

/// The columns of a table: numbers as arrays with NaN for missing values, all others as lists.
pub(crate) fn columns<'py>(py: Python<'py>, table: &Table) -> PyResult<PyColumns<'py>> {
    let columns = table.columns.iter().map(|column| {
        let values = match &column.values {
            Values::Numbers(values) => {
                let numbers = values.iter().map(|value| value.unwrap_or(f64::NAN));
                PyArray1::from_iter(py, numbers).into_any()
            }
            Values::Counts(values) => values.into_pyobject(py)?,
            Values::Flags(values) => values.into_pyobject(py)?,
            Values::Words(values) => values.into_pyobject(py)?,
        };
        Ok((column.name.clone(), values))
    });
    columns.collect()
}
