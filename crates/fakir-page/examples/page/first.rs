//! Initial data of the page, and the answers to its first questions, which are shown while the module is loaded.

use fakir_case::{AnyCase, Case};
use fakir_explore::{Limits, Part, answer, start};
use serde_json::{Value, json};
use std::sync::{Arc, Mutex, PoisonError};

/// The data, and the answers to the same requests as those of the page for its first case.
pub(crate) fn data() -> Value {
    let example = AnyCase::Pillars(Box::new(Case::example()));
    let start = start(&example, usize::MAX).unwrap_or_default();
    let start: Value = serde_json::from_str(&start).unwrap_or_default();
    let case = &start["case"];
    let contact = json!({ "case": case, "load": { "fraction": 1 } });
    let lines = answered("contact", &contact);
    let critical = lines.iter().find_map(|line| line.get("critical")).cloned();
    let indentation = critical.unwrap_or_default()["critical_indentation_m"].clone();
    let load = json!({ "fraction": 1, "critical_indentation_m": indentation });
    let phase = json!({ "case": case, "load": load });
    let curves = json!({ "case": case });
    let questions = [("contact", contact), ("phase", phase), ("curves", curves)];
    let first: Vec<Value> = questions
        .into_iter()
        .map(|(path, question)| {
            let lines = answered(path, &question);
            json!({ "path": path, "question": question, "lines": lines })
        })
        .collect();
    json!({ "start": start, "first": first })
}

/// The lines of an answer, without progress.
fn answered(name: &str, question: &Value) -> Vec<Value> {
    let mut body = question.clone();
    body["ticket"] = json!({ "session": "first", "sequence": 1 });
    let lines = Arc::new(Mutex::new(Vec::new()));
    let received = Arc::clone(&lines);
    let limits = Limits {
        memory: 1_000_000_000,
        most_cells: 0.0,
    };
    answer(name, body.to_string().as_bytes(), limits, move |part| {
        if let Part::Line(line) = part {
            let line: Value = serde_json::from_slice(&line).unwrap_or_default();
            if line.get("progress").is_none() {
                let mut lines = received.lock().unwrap_or_else(PoisonError::into_inner);
                lines.push(line);
            }
        }
    });
    let lines = lines.lock().unwrap_or_else(PoisonError::into_inner);
    lines.clone()
}
