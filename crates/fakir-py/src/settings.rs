//! Keys and their values from Python.

use crate::error::value_error;
use fakir_case::{Key, Setting};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The key of that path.
pub(crate) fn key(path: &str) -> PyResult<Key> {
    Key::at(path).ok_or_else(|| value_error(format!("a case has no key \"{path}\"")))
}

/// Numbers in SI units and words, by their keys.
pub(crate) fn settings(
    numbers: Vec<(String, f64)>,
    words: Vec<(String, String)>,
) -> PyResult<Vec<(Key, Setting)>> {
    let numbers = numbers
        .into_iter()
        .map(|(path, number)| Ok((key(&path)?, Setting::Number(number))));
    let words = words
        .into_iter()
        .map(|(path, word)| Ok((key(&path)?, Setting::Word(word))));
    numbers.chain(words).collect()
}

/// Numbers and words by their keys.
pub(crate) type BodySettings = (Vec<(String, f64)>, Vec<(String, String)>);

/// A dictionary of values by their keys.
pub(crate) fn by_key<'py>(
    py: Python<'py>,
    settings: &[(Key, Setting)],
) -> PyResult<Bound<'py, PyDict>> {
    let values = PyDict::new(py);
    for (key, value) in settings {
        match value {
            Setting::Number(number) => values.set_item(key.path(), number)?,
            Setting::Word(word) => values.set_item(key.path(), word)?,
        }
    }
    Ok(values)
}
