//! What a command hands back, ready to be printed and saved.

pub(crate) mod state;
pub(crate) mod surface;
pub(crate) mod table;

use crate::output::File;
use serde::Serialize;

/// The result of a command, in every form it is wanted in.
#[derive(Debug)]
pub(crate) struct Report {
    /// One JSON object.
    pub(crate) json: String,
    /// Tables for a person.
    pub(crate) text: String,
    /// Tables and fields for other programs.
    pub(crate) tables: Vec<File>,
    /// What to be careful about.
    pub(crate) warnings: Vec<String>,
    pub(crate) converged: bool,
}

impl Report {
    /// The files to save: the summary, the tables, and the case as a case file.
    pub(crate) fn files(&self, case: &str, command: &str) -> Vec<File> {
        let case = format!(
            "# As solved by fakir {}: fakir {command}.\n{case}",
            env!("CARGO_PKG_VERSION")
        );
        let mut files = self.tables.clone();
        files.push(File::new("case.toml", case));
        files.push(File::new("summary.json", format!("{}\n", self.json)));
        files
    }
}

/// A JSON object, with its keys in the order of the fields.
pub(crate) fn json(value: &impl Serialize) -> String {
    serde_json::to_string_pretty(value).expect("structs with named fields are JSON objects")
}

/// Rows as CSV, with the names of their fields as heading.
pub(crate) fn csv<T: Serialize>(name: &'static str, rows: impl IntoIterator<Item = T>) -> File {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).expect("flat structs are CSV records");
    }
    let bytes = writer.into_inner().expect("memory takes every byte");
    File::new(name, String::from_utf8_lossy(&bytes).into_owned())
}
