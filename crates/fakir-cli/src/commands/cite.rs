//! `fakir cite`: what to cite.

use crate::arguments::{Cite, CitedMethod};
use crate::failure::{DONE, Failure, Status};
use crate::standard::print;
use fakir::problem::{Accuracy, ElementMesh, Method, PunchForm};
use fakir_case::input::{self, LARGEST_STUDY};
use fakir_case::{CaseFile, StudyFile};
use fakir_study::answer::described;
use fakir_study::citations::{Citation, Topic, citations};
use fakir_study::provenance::{FILE_NAME, Provenance, study_words};
use fakir_study::result::json;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// Characters in a line of text.
const WIDTH: usize = 96;

/// What is cited, and for what.
#[derive(Debug, Serialize)]
struct CiteJson {
    #[serde(rename = "for")]
    what: String,
    citations: Vec<Citation>,
}

impl CiteJson {
    fn new(what: impl Into<String>, topics: &[Topic]) -> Self {
        Self {
            what: what.into(),
            citations: citations(topics),
        }
    }
}

pub(crate) fn run(options: &Cite) -> Result<Status, Failure> {
    let cited = match (&options.what, options.method) {
        (Some(path), _) if path.is_dir() => of_folder(path)?,
        (Some(path), _) => of_file(path)?,
        (None, Some(method)) => of_method(method),
        (None, None) => CiteJson::new("any use of fakir", &[]),
    };
    print(&if options.json {
        json(&cited)
    } else if options.bibtex {
        let entries: Vec<String> = cited.citations.iter().map(Citation::bibtex).collect();
        entries.join("\n")
    } else {
        text(&cited)
    })?;
    Ok(DONE)
}

/// References in the results of a folder.
fn of_folder(folder: &Path) -> Result<CiteJson, Failure> {
    let path = folder.join(FILE_NAME);
    let provenance = Provenance::read(&path)
        .map_err(|error| Failure::file("no results of fakir: cannot read", &path, error))?;
    Ok(CiteJson {
        what: format!("{}, {}", provenance.question, provenance.method),
        citations: provenance.citations,
    })
}

fn of_file(path: &Path) -> Result<CiteJson, Failure> {
    if is_study(path) {
        let study = StudyFile::read(path)?.study()?;
        return Ok(CiteJson::new(study_words(&study), &Topic::of_study(&study)));
    }
    let file = CaseFile::read(path)?;
    let case = described(&file.any_case(&[])?)?;
    Ok(CiteJson::new(case.cited_as, &case.topics))
}

/// Whether a file can be read and has a table that only studies have.
fn is_study(path: &Path) -> bool {
    let has = |line: &str| {
        ["[study]", "[axes]"]
            .iter()
            .any(|table| line.starts_with(table))
    };
    let text = input::read(path, LARGEST_STUDY).unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    text.lines().any(|line| has(line.trim_start()))
}

fn of_method(method: CitedMethod) -> CiteJson {
    let (what, topics) = match method {
        CitedMethod::Spectral => (
            "spectral method",
            vec![Topic::Method(Method::Spectral(Accuracy::Default))],
        ),
        CitedMethod::Love => (
            "boundary elements",
            vec![Topic::Method(Method::Love(ElementMesh::default()))],
        ),
        CitedMethod::Punch => (
            "punch lattice",
            vec![Topic::Method(Method::Punch(PunchForm::default()))],
        ),
        CitedMethod::Homogenised => (
            "homogenised lattice",
            vec![Topic::Method(Method::Homogenised)],
        ),
        CitedMethod::Theory => (
            "closed forms and homogenised lattice",
            vec![Topic::ClosedForms, Topic::Method(Method::Homogenised)],
        ),
    };
    CiteJson::new(what, &topics)
}

fn text(cited: &CiteJson) -> String {
    let mut text = format!("To cite for {}:\n", cited.what);
    for citation in &cited.citations {
        text.push('\n');
        wrap(&mut text, &citation.text(), "");
        wrap(&mut text, &format!("for {}", citation.why), "    ");
    }
    text
}

/// Adds a paragraph in lines of at most [`WIDTH`] characters; longer words are not divided.
fn wrap(text: &mut String, paragraph: &str, indent: &str) {
    let mut line = indent.to_owned();
    for word in paragraph.split(' ') {
        let begun = line.len() > indent.len();
        if begun && line.chars().count() + 1 + word.chars().count() > WIDTH {
            let _ = writeln!(text, "{line}");
            line = indent.to_owned();
        } else if begun {
            line.push(' ');
        }
        line.push_str(word);
    }
    let _ = writeln!(text, "{line}");
}
