//! Result of a command, to be printed and saved.

pub(crate) mod asperities;
pub(crate) mod figures;
pub(crate) mod maps;
pub(crate) mod state;
pub(crate) mod surface;
pub(crate) mod table;

use fakir_study::output::File;
use fakir_study::provenance::Provenance;
use fakir_study::result::with_case_warnings;

/// The result of a command, in all output forms.
#[derive(Debug)]
pub(crate) struct Report {
    /// One JSON object.
    pub(crate) json: String,
    /// Tables as text.
    pub(crate) text: String,
    /// Question and method.
    pub(crate) provenance: Provenance,
    /// Tables and fields for other programs, and figures.
    pub(crate) tables: Vec<File>,
    /// Warnings.
    pub(crate) warnings: Vec<String>,
    /// Whether the numbers are reliable: every solution converged, its numbers are resolved, and two methods that verify each other agree.
    pub(crate) converged: bool,
    /// Validity limits of the model that are exceeded.
    pub(crate) strained: Vec<String>,
}

impl Report {
    /// Adds warnings about the case as written: before the others, and in the JSON object.
    pub(crate) fn with_case_warnings(mut self, warnings: Vec<String>) -> Self {
        if !warnings.is_empty() {
            self.json = with_case_warnings(&self.json, &warnings);
            self.warnings.splice(0..0, warnings);
        }
        self
    }

    /// The exit status: 1 unless it converged.
    pub(crate) fn status(&self) -> u8 {
        u8::from(!self.converged)
    }

    /// The files to save: the summary, the tables, the case as a case file, and the provenance.
    pub(crate) fn files(&self, command: &str) -> Vec<File> {
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
            strained: Vec::new(),
        };
        assert_eq!(report(true).status(), 0);
        assert_eq!(report(false).status(), 1);
    }
}
