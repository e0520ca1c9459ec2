//! Many cases.

use crate::{Summary, Table, VERSION};
use serde::Serialize;
use serde_json::Value;
use std::path::Path;

/// A sweep or a merge: what `fakir sweep --json` and `fakir merge --json` print.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepSummary {
    question: &'static str,
    cases: usize,
    cases_of_study: usize,
    from_journal: usize,
    failed: usize,
    problems: Vec<ProblemRow>,
    #[serde(skip_serializing_if = "Option::is_none")]
    folder: Option<String>,
    /// The table, if it is not saved in a folder.
    #[serde(skip_serializing_if = "Option::is_none")]
    rows: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    wall_time_s: Option<f64>,
    fakir_version: &'static str,
}

/// A case that failed, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct ProblemRow {
    case: usize,
    settings: String,
    problem: String,
}

impl SweepSummary {
    /// The summary of a sweep whose tables are in `folder`, if they are saved. `wall_time` is the computing time in seconds; a merge has
    /// none.
    #[must_use]
    pub fn new(summary: &Summary, folder: Option<&Path>, wall_time: Option<f64>) -> Self {
        let study = &summary.study;
        let problems = summary.failed().map(|row| ProblemRow {
            case: row.index,
            settings: study.settings(row.index),
            problem: row.problem.clone().unwrap_or_default(),
        });
        let problems: Vec<ProblemRow> = problems.collect();
        Self {
            question: study.asked().name(),
            cases: summary.rows.len(),
            cases_of_study: study.cases(),
            from_journal: summary.found,
            failed: problems.len(),
            problems,
            folder: folder.map(|folder| folder.display().to_string()),
            rows: folder
                .is_none()
                .then(|| Table::new(study, &summary.rows).to_json()),
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ledger, Options};
    use fakir_case::{Case, StudyFile};

    /// The summary contains the rows unless a folder contains them, and the reason for every failed case.
    #[test]
    fn a_summary_has_the_rows_that_no_folder_has() {
        let text = format!(
            "[axes]\n\"pattern.offset\" = [0, 0.5]\n{}",
            Case::example().to_toml()
        );
        let mut file = StudyFile::parse("study.toml", &text).unwrap();
        file.set("method.name=homogenised").unwrap();
        let mut ledger = Ledger::in_memory(&file.study().unwrap());
        ledger.complete(&mut Options::default()).unwrap();
        let mut summary = ledger.finish().unwrap();
        summary.rows[1].problem = Some("a reason".to_owned());
        let json =
            |folder, time| serde_json::to_value(SweepSummary::new(&summary, folder, time)).unwrap();
        let in_memory = json(None, Some(2.0));
        assert_eq!(in_memory["question"], "transition");
        assert_eq!(
            (&in_memory["cases"], &in_memory["failed"]),
            (&2.into(), &1.into())
        );
        assert_eq!(in_memory["problems"][0]["settings"], "pattern.offset = 0.5");
        assert_eq!(in_memory["problems"][0]["problem"], "a reason");
        assert_eq!(in_memory["rows"].as_array().unwrap().len(), 2);
        assert_eq!(in_memory["wall_time_s"], 2.0);
        let saved = json(Some(Path::new("results")), None);
        assert_eq!(saved["folder"], "results");
        assert!(saved.get("rows").is_none() && saved.get("wall_time_s").is_none());
    }
}
