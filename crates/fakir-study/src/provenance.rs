//! Provenance of a result, written into every saved file.
//!
//! It depends on the problem alone, without dates or machine, so that the same problem produces the same files.

use crate::VERSION;
use crate::citations::{Citation, REFERENCE_DOI, Topic, citations};
use crate::output::File;
use fakir::problem::{Accuracy, Method, PunchForm};
use fakir_case::input::{self, LARGEST_STUDY};
use fakir_case::study::Asked;
use fakir_case::{Study, SurfaceKind};
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;

/// Name of the file with the provenance of a folder of results.
pub const FILE_NAME: &str = "provenance.json";

/// Largest size of the file, bytes. It contains a study, which is longer as a JSON string.
const LARGEST_PROVENANCE: u64 = 3 * LARGEST_STUDY;

/// Provenance of a result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// Version of fakir that computed it.
    pub fakir_version: String,
    /// Description of the question: `"critical state"`.
    pub question: String,
    /// Description of the method: `"spectral method, default accuracy"`.
    pub method: String,
    /// DOI of the paper that defines the problem.
    pub reference_doi: String,
    /// References to cite.
    pub citations: Vec<Citation>,
    /// The case or study as it was solved, as a file that can be run again (TOML).
    pub case: String,
    /// Files that were saved with it, by their paths relative to its folder.
    #[serde(default)]
    pub files: Vec<String>,
}

impl Provenance {
    /// The provenance of results of this version: descriptions of the question and the method, references, and the case or study in its
    /// canonical text.
    #[must_use]
    pub fn new(
        question: impl Into<String>,
        method: impl Into<String>,
        topics: &[Topic],
        case: impl Into<String>,
    ) -> Self {
        Self {
            fakir_version: VERSION.to_owned(),
            question: question.into(),
            method: method.into(),
            reference_doi: REFERENCE_DOI.to_owned(),
            citations: citations(topics),
            case: case.into(),
            files: Vec::new(),
        }
    }

    /// The provenance of a study.
    #[must_use]
    pub fn of_study(study: &Study) -> Self {
        let asked = match study.asked() {
            Asked::Transition => "critical state",
            Asked::Press => "contact under a load",
            Asked::Cycle => "loading and unloading with adhesion",
            Asked::Collapse => "collapse of an adhesive floor",
            Asked::Hold => "hold of viscoelastic bodies",
        };
        Self::new(
            format!("{asked}, {} cases", study.cases()),
            study_words(study),
            &Topic::of_study(study),
            study.to_toml(),
        )
    }

    /// As a JSON object.
    #[must_use]
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("texts are JSON") + "\n"
    }

    /// Reads the output of [`to_json`](Self::to_json).
    ///
    /// # Errors
    /// If it is not JSON, or a key is missing.
    pub fn from_json(text: &str) -> Result<Self, serde_json::Error> {
        serde_json::from_str(text)
    }

    /// Reads the file in a folder of results.
    ///
    /// # Errors
    /// If it cannot be read, or does not have the format of [`to_json`](Self::to_json).
    pub fn read(path: &Path) -> io::Result<Self> {
        let bytes = input::read(path, LARGEST_PROVENANCE)?;
        serde_json::from_slice(&bytes).map_err(|error| {
            let problem = format!("not as fakir writes it: {error}");
            io::Error::new(io::ErrorKind::InvalidData, problem)
        })
    }

    /// The file to be saved with results in files of these names, which it lists.
    #[must_use]
    pub fn file<'n>(&self, names: impl IntoIterator<Item = &'n str>) -> File {
        let listed = Self {
            files: names.into_iter().map(str::to_owned).collect(),
            ..self.clone()
        };
        File::new(FILE_NAME, listed.to_json())
    }

    /// The provenance without the citations in a few lines of text, for figures.
    #[must_use]
    pub fn stamp(&self) -> String {
        let Self {
            fakir_version,
            question,
            method,
            reference_doi,
            case,
            ..
        } = self;
        format!(
            "fakir {fakir_version}: {question}, {method}\nhttps://doi.org/{reference_doi}\n\n{case}"
        )
    }

    /// Names and texts for files with attributes, such as netCDF.
    #[must_use]
    pub fn attributes(&self) -> [(&'static str, String); 5] {
        let references: Vec<String> = self.citations.iter().map(Citation::text).collect();
        [
            ("title", format!("Lens on a surface: {}", self.question)),
            ("source", format!("fakir {}", self.fakir_version)),
            ("method", self.method.clone()),
            ("references", references.join("\n")),
            ("case", self.case.clone()),
        ]
    }
}

/// The method for flat surfaces in a few words.
pub(crate) const FLAT_METHOD: &str = "one disc of contact, closed forms on half-spaces";

/// The methods of a study in a few words.
#[must_use]
pub fn study_words(study: &Study) -> String {
    if study.surface_kind() == SurfaceKind::HeightMap {
        return "boundary elements on surfaces".to_owned();
    }
    if study.surface_kind() == SurfaceKind::Flat {
        return FLAT_METHOD.to_owned();
    }
    let words: Vec<String> = study.methods().into_iter().map(method_words).collect();
    words.join("; ")
}

/// Short description of a method: `spectral method, default accuracy`.
#[must_use]
pub fn method_words(method: Method) -> String {
    match method {
        Method::Spectral(Accuracy::Default) => "spectral method, default accuracy".to_owned(),
        Method::Spectral(Accuracy::Accurate) => "spectral method, accurate".to_owned(),
        Method::Punch(PunchForm::Plain) => "punch lattice, plain".to_owned(),
        Method::Punch(PunchForm::Corrected) => "punch lattice, corrected".to_owned(),
        Method::Homogenised => "homogenised lattice, an approximation".to_owned(),
        Method::Love(mesh) => format!(
            "boundary elements, {} cells across a pillar",
            mesh.cells_per_diameter
        ),
        other => format!("{} method", other.name()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir_case::{Case, CaseFile};

    #[test]
    fn the_case_can_be_run_again() {
        let case = Case::example();
        let method = method_words(case.method);
        let topics = [Topic::Method(case.method)];
        let stamp = Provenance::new("critical state", method, &topics, case.to_toml());
        let read = Provenance::from_json(&stamp.to_json()).unwrap();
        assert_eq!(read, stamp);
        let again = CaseFile::parse("case.toml", &read.case).unwrap();
        assert_eq!(again.case().unwrap(), case);
    }
}
