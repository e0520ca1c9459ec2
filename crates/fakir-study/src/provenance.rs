//! Where numbers come from: what goes with every file of results.

use serde::Serialize;

/// The version of fakir.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The paper that states the problem.
pub const DOI: &str = "10.1103/PhysRevE.104.055007";

/// The same, for a list of references.
pub const CITATION: &str = "R. Ledesma-Alonso, E. Raphaël, F. Restagno, C. Poulard, \
                            Phys. Rev. E 104, 055007 (2021)";

/// What a result was computed from and with; it has no times, so that the same question gives the
/// same file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Provenance {
    /// `"fakir"`
    pub program: &'static str,
    /// The version of fakir.
    pub fakir_version: &'static str,
    /// The methods that were used.
    pub methods: Vec<String>,
    /// What was computed, as the case or study file that says so.
    pub input: String,
    /// Where the problem is stated.
    pub citation: &'static str,
    /// The same as a DOI.
    pub doi: &'static str,
}

impl Provenance {
    /// Of results computed by this version from a case or study file.
    #[must_use]
    pub fn new(methods: Vec<String>, input: &str) -> Self {
        Self {
            program: "fakir",
            fakir_version: VERSION,
            methods,
            input: input.to_owned(),
            citation: CITATION,
            doi: DOI,
        }
    }

    /// A JSON object, as in `provenance.json`.
    #[must_use]
    pub fn to_json(&self) -> String {
        let text = serde_json::to_string_pretty(self);
        text.expect("a struct of texts is a JSON object") + "\n"
    }

    /// As pairs of names and texts, for files that keep such pairs.
    #[must_use]
    pub fn pairs(&self) -> Vec<(&'static str, String)> {
        vec![
            ("program", self.program.to_owned()),
            ("fakir_version", self.fakir_version.to_owned()),
            ("methods", self.methods.join(", ")),
            ("input", self.input.clone()),
            ("citation", self.citation.to_owned()),
            ("doi", self.doi.to_owned()),
        ]
    }
}
