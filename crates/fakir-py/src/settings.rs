//! Keys and their values from Python.

use crate::error::value_error;
use fakir_case::{Key, Setting};
use pyo3::prelude::*;

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
