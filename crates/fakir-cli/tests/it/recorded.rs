//! Eighty commands, over all that the program can be asked, and their recorded answers.
//!
//! What is only rearranged must answer as before. `FAKIR_RECORD=1` records anew, which is right only
//! where answers are meant to change. Sums differ between processors by their last digits, and what is solved for
//! until a residual is small by more; `FAKIR_TOLERANCE=1e-12` is for one and the same machine.

use rayon::prelude::*;
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Largest relative difference between processors.
const TOLERANCE: f64 = 1e-8;

/// Relative difference allowed in error estimates and in what is left of residuals: they are differences of numbers that
/// nearly agree.
const TOLERANCE_OF_ERRORS: f64 = 1e-2;

/// What differs from run to run.
fn is_volatile(name: &str) -> bool {
    name.ends_with("time_s") || ["fakir_version", "folder"].contains(&name)
}

/// What is made of rounding alone: how well the energy of a cycle is balanced. Of a general surface it is an object, and more.
fn is_rounding(name: &str, value: &Value) -> bool {
    name == "certificate" && !value.is_object()
}

/// Takes out of an answer what differs from run to run, so that it is not recorded.
fn remove_volatile(answer: &mut Value) {
    match answer {
        Value::Object(members) => {
            members.retain(|name, value| !is_volatile(name) && !is_rounding(name, value));
            members.values_mut().for_each(remove_volatile);
        }
        Value::Array(values) => values.iter_mut().for_each(remove_volatile),
        _ => {}
    }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recorded")
}

/// Runs a command: exit status, JSON, and the tables it saved.
fn answer(line: &str) -> Value {
    let saved = tempfile::TempDir::new().unwrap();
    let out = saved.path().join("out");
    let words = line.split_whitespace().map(|word| match word {
        "OUT" => out.as_os_str(),
        word => word.as_ref(),
    });
    let output = Command::new(env!("CARGO_BIN_EXE_fakir"))
        .args(words)
        .args(
            ["--json", "--quiet"]
                .iter()
                .filter(|flag| **flag == "--json" || !line.starts_with("cite")),
        )
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let answer = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    let mut tables = Map::new();
    for entry in std::fs::read_dir(&out).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "csv") {
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            tables.insert(name, table(&std::fs::read_to_string(&path).unwrap()));
        }
    }
    let mut whole: Value = json!({
        "command": line,
        "status": output.status.code(),
        "answer": answer,
        "tables": tables,
    });
    remove_volatile(&mut whole);
    whole
}

/// The columns of a table by their names.
fn table(text: &str) -> Value {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names = lines.next().unwrap_or_default().split(',');
    let mut columns: Vec<(&str, Vec<Value>)> = names.map(|name| (name, Vec::new())).collect();
    for line in lines {
        for (cell, (_, column)) in line.split(',').zip(&mut columns) {
            let number = cell.parse::<f64>().ok().filter(|number| number.is_finite());
            column.push(number.map_or_else(|| json!(cell), |number| json!(number)));
        }
    }
    columns
        .into_iter()
        .map(|(name, column)| (name.to_owned(), Value::Array(column)))
        .collect::<Map<_, _>>()
        .into()
}

/// Differences between a recorded value and one of now, each with the place where it is.
fn differences(place: &str, before: &Value, now: &Value, tolerance: f64, found: &mut Vec<String>) {
    match (before, now) {
        (Value::Object(before), Value::Object(now)) => {
            for (name, value) in before {
                let inner = format!("{place}.{name}");
                match now.get(name) {
                    _ if is_volatile(name) => {}
                    Some(now) => differences(&inner, value, now, tolerance, found),
                    None => found.push(format!("{inner} is gone")),
                }
            }
        }
        (Value::Array(before), Value::Array(now)) if before.len() == now.len() => {
            // Numbers of one array are of one kind; that one is zero but for rounding is no difference.
            let largest = before
                .iter()
                .filter_map(Value::as_f64)
                .fold(0.0, |largest: f64, value| largest.max(value.abs()));
            for (index, (before, now)) in before.iter().zip(now).enumerate() {
                let inner = format!("{place}[{index}]");
                match (before.as_f64(), now.as_f64()) {
                    (Some(before), Some(now)) => {
                        compare(&inner, before, now, largest, tolerance, found);
                    }
                    _ => differences(&inner, before, now, tolerance, found),
                }
            }
        }
        (Value::Number(before), Value::Number(now)) => {
            let [before, now] = [before, now].map(|number| number.as_f64().unwrap());
            compare(place, before, now, before.abs(), tolerance, found);
        }
        _ if before == now => {}
        _ => found.push(format!("{place}: {before} before, {now} now")),
    }
}

fn compare(
    place: &str,
    before: f64,
    now: f64,
    scale: f64,
    tolerance: f64,
    found: &mut Vec<String>,
) {
    let error = ["error", "residual", "difference", "deviation"]
        .iter()
        .any(|word| place.contains(word));
    let tolerance = if error {
        tolerance.max(TOLERANCE_OF_ERRORS * (tolerance / TOLERANCE).min(1.0))
    } else {
        tolerance
    };
    if (before - now).abs() > tolerance * scale {
        let relative = (now / before - 1.0).abs();
        found.push(format!(
            "{place}: {before} before, {now} now ({relative:.1e})"
        ));
    }
}

#[test]
fn commands_answer_as_recorded() {
    let commands = std::fs::read_to_string(folder().join("commands.txt")).unwrap();
    let commands: Vec<&str> = commands
        .lines()
        .filter(|line| !line.starts_with('#'))
        .collect();
    assert_eq!(commands.len(), 77);
    let answers: Vec<Value> = commands.par_iter().map(|line| answer(line)).collect();
    let path = folder().join("answers.jsonl");
    if std::env::var_os("FAKIR_RECORD").is_some() {
        let lines: String = answers.iter().map(|answer| format!("{answer}\n")).collect();
        std::fs::write(path, lines).unwrap();
        return;
    }
    let tolerance =
        std::env::var("FAKIR_TOLERANCE").map_or(TOLERANCE, |text| text.parse().expect("a number"));
    let recorded = std::fs::read_to_string(path).unwrap();
    let mut found = Vec::new();
    for (before, now) in recorded.lines().zip(&answers) {
        let before: Value = serde_json::from_str(before).unwrap();
        let mut of_command = Vec::new();
        differences("", &before, now, tolerance, &mut of_command);
        if !of_command.is_empty() {
            found.push(format!("fakir {}", now["command"].as_str().unwrap()));
            found.extend(of_command);
        }
    }
    assert_eq!(recorded.lines().count(), answers.len());
    assert!(found.is_empty(), "{}", found.join("\n"));
}
