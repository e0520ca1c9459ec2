//! Output of commands, printed and saved, and the parts of its texts.

pub mod asperities;
pub mod state;
pub mod surface;
pub mod table;

use crate::output::File;
use crate::provenance::Provenance;
use crate::result::with_case_warnings;

/// The result of a command, in all output forms.
#[derive(Debug)]
pub struct Report {
    /// One JSON object.
    pub json: String,
    /// Tables as text.
    pub text: String,
    /// The question, the method and the version.
    pub provenance: Provenance,
    /// Tables and fields for other programs, and figures.
    pub tables: Vec<File>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Whether the numbers are reliable: every solution converged, its numbers are resolved, and in a verification both methods
    /// agree.
    pub converged: bool,
    /// Descriptions of the validity limits that are exceeded.
    pub exceeded: Vec<String>,
}

impl Report {
    /// The same with warnings about the case file: before its own warnings, and in the JSON object.
    #[must_use]
    pub fn with_case_warnings(mut self, warnings: Vec<String>) -> Self {
        if !warnings.is_empty() {
            self.json = with_case_warnings(&self.json, &warnings);
            self.warnings.splice(0..0, warnings);
        }
        self
    }

    /// The exit status: 1 unless it converged.
    #[must_use]
    pub fn status(&self) -> u8 {
        u8::from(!self.converged)
    }

    /// The files to save: the summary, the tables, the case as a case file, and the provenance.
    #[must_use]
    pub fn files(&self, command: &str) -> Vec<File> {
        let Provenance {
            fakir_version,
            case,
            ..
        } = &self.provenance;
        let case = format!("# As solved by fakir {fakir_version}: fakir {command}.\n{case}");
        let mut files = self.tables.clone();
        files.push(File::new("case.toml", case));
        files.push(File::new("summary.json", format!("{}\n", self.json)));
        let names = files.iter().map(|file| file.name.as_ref());
        files.push(self.provenance.file(names));
        files
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_did_not_converge_has_a_status_of_its_own() {
        let report = |converged| Report {
            json: "{}".to_owned(),
            text: String::new(),
            provenance: Provenance::new("", "", &[], ""),
            tables: Vec::new(),
            warnings: Vec::new(),
            converged,
            exceeded: Vec::new(),
        };
        assert_eq!(report(true).status(), 0);
        assert_eq!(report(false).status(), 1);
    }
}
