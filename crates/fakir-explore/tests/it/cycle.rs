//! Loading and unloading with adhesion, as the page requests it.

use crate::running::{Answer, Running, case, question};
use fakir::problem::CyclePlan;
use fakir::state::{Cycle, Run};
use fakir_case::{Case, CaseFile};
use serde_json::{Value, json};
use std::io::{Read, Write};
use std::time::{Duration, Instant};

/// The case of `fakir init` at another surface fraction, with a work of adhesion.
fn adhesive(surface_fraction: f64, work: &str) -> Value {
    let mut values = case(surface_fraction);
    values["adhesion.work"] = json!(work);
    values
}

/// Result of the library for the same case.
fn cycle(surface_fraction: f64, work: &str) -> Cycle {
    let mut file = CaseFile::parse("case", &Case::example().to_toml()).unwrap();
    file.set(&format!("pattern.surface_fraction={surface_fraction}"))
        .unwrap();
    file.set(&format!("adhesion.work={work}")).unwrap();
    let case = file.case().unwrap();
    let plan = CyclePlan::default();
    fakir::cycle(&case.system, plan, case.method, &Run::default()).unwrap()
}

fn stations(answer: &Answer) -> Vec<Value> {
    let lines = answer.lines();
    let sent = lines.iter().filter_map(|line| line.get("station"));
    sent.cloned().collect()
}

fn load(station: &Value) -> f64 {
    station["load"].as_f64().unwrap()
}

#[test]
fn the_cycle_is_that_of_the_library() {
    let expected = cycle(0.02, "5mJ/m2");
    let server = Running::start();
    let answer = server.ask(
        "/api/cycle",
        &question(server.next(), &adhesive(0.02, "5 mJ/m2")),
    );
    assert_eq!(answer.status, 200, "{}", answer.body);
    let shown = answer.line("cycle");
    let summary = &shown["summary"];
    let pull_off = expected.pull_off.as_ref().unwrap();
    assert_eq!(summary["pull_off_force_N"], json!(pull_off.force));
    assert_eq!(summary["hysteresis_J"], json!(expected.loop_area));
    let model = &summary["relative_error_estimate"]["pull_off_force"]["model_fronts"];
    assert_eq!(model, &json!(expected.errors.pull_off_force.fronts));
    let critical = answer.line("critical");
    let state = &expected.critical.as_ref().unwrap().contact;
    assert_eq!(critical["critical_force_N"], json!(state.force));
    // Without adhesion the critical force differs by less than one per cent.
    let without = shown["critical_force_without_adhesion_N"].as_f64().unwrap();
    assert!(without > state.force && without < 1.01 * state.force);
    let case = answer.line("case");
    let command = case["command"].as_str().unwrap();
    assert!(command.contains("fakir cycle case.toml"));
    assert!(answer.line("transition").as_array().unwrap().len() > 100);

    let sent = stations(&answer);
    assert_eq!(shown["states"], json!(sent.len()));
    assert!(sent.len() > 80, "{}", sent.len());
    // The first is the critical state, which is displayed unless another load is requested.
    assert_eq!(load(&sent[0]).to_bits(), 1f64.to_bits());
    assert_eq!(sent[0]["floor_contacts_m"].as_array().unwrap().len(), 6);
    let (mut pulls, mut parts, mut at_pull_off) = (0, 0, 0);
    for station in &sent {
        let place = station["place"].as_u64().unwrap() as usize;
        let expected_station = &expected.stations[place];
        let forces: Vec<f64> = serde_json::from_value(station["pillar_forces_N"].clone()).unwrap();
        assert_eq!(forces.len(), expected_station.pillars_in_contact);
        let sum: f64 = forces.iter().sum();
        let all: f64 = forces.iter().map(|force| force.abs()).sum();
        assert!((sum - expected_station.force).abs() <= 1e-4 * all + 1e-15);
        let holding = expected.holding(place);
        let partial = station["parts"].as_array().unwrap();
        assert_eq!(partial.len(), expected_station.pillars_partially_in_contact);
        for part in partial {
            let pillar = part["pillar"].as_u64().unwrap() as usize;
            let index = |k: usize| station["pillars"][2 * pillar + k].as_i64().unwrap();
            let index = (index(0), index(1));
            let held = holding.iter().find(|held| held.index == index).unwrap();
            assert_eq!(part["covered"], json!(held.covered));
            assert!(part["outline"].as_array().unwrap().len() >= 12);
        }
        let section = &station["section"];
        assert_eq!(
            section["surface_m"].as_array().unwrap().len(),
            section["x_m"].as_array().unwrap().len()
        );
        pulls += forces.iter().filter(|force| **force < 0.0).count();
        parts += partial.len();
        at_pull_off += usize::from(place == pull_off.station);
    }
    assert!(pulls > 0 && parts > 0);
    assert_eq!(at_pull_off, 1);
    let ends = |f: fn(f64, f64) -> f64| sent.iter().map(load).reduce(f).unwrap();
    assert!(ends(f64::min).abs() < f64::EPSILON);
    assert!((ends(f64::max) - 2.0).abs() < f64::EPSILON);
    let last = sent
        .iter()
        .max_by(|a, b| load(a).total_cmp(&load(b)))
        .unwrap();
    assert_eq!(last["pillars"], json!([]));
}

#[test]
fn the_requested_state_is_sent_first() {
    let server = Running::start();
    let mut asked = question(server.next(), &adhesive(0.01, "50 mJ/m2"));
    asked["load"] = json!({ "fraction": 2.0 });
    let sent = stations(&server.ask("/api/cycle", &asked));
    assert!((load(&sent[0]) - 2.0).abs() < f64::EPSILON);
    let away = |station: &Value| (load(station) - 2.0).abs();
    assert!(
        sent.windows(2)
            .all(|pair| away(&pair[0]) <= away(&pair[1]) + 1e-12)
    );
}

/// Only values of the load steps may depend on the position of the lens, even in a coarse cycle with hardly any adhesion.
#[test]
fn a_lens_that_meets_the_floor_first_has_nothing_to_pull() {
    let server = Running::start();
    let mut flat = adhesive(0.0004, "50 mJ/m2");
    // Half-way between pillars so far apart that the floor is nearer.
    flat["pattern.offset"] = json!(0.5);
    flat["pattern.pillar.height"] = json!("0.1 um");
    flat["lens.radius"] = json!("0.3 mm");
    let answer = server.ask("/api/cycle", &question(server.next(), &flat));
    assert_eq!(answer.status, 200, "{}", answer.body);
    let shown = answer.line("cycle");
    assert_eq!(shown["summary"]["pull_off_force_N"], Value::Null);
    assert_eq!(answer.line("critical")["regime"], "bottom_first");
    assert_eq!(shown["states"], json!(stations(&answer).len()));
}

/// With the messages of the library and of the key table.
#[test]
fn works_that_cannot_be_are_refused_at_their_key() {
    let server = Running::start();
    let refused = |path: &str, changes: &[(&str, Value)]| {
        let mut values = adhesive(0.01, "50 mJ/m2");
        for (key, value) in changes {
            values[*key] = value.clone();
        }
        let answer = server.ask(path, &question(server.next(), &values));
        let message: Value = serde_json::from_str(&answer.body).unwrap();
        assert_eq!(answer.status, 422, "{message}");
        message
    };
    let message = refused("/api/cycle", &[("adhesion.work", json!("-1 mJ/m2"))]);
    assert_eq!(message["key"], "adhesion.work");
    assert!(
        message["message"]
            .as_str()
            .unwrap()
            .contains("cannot be -1 mJ/m2"),
        "{message}"
    );
    let message = refused(
        "/api/cycle",
        &[("adhesion.work_receding", json!("10 mJ/m2"))],
    );
    assert_eq!(message["key"], "adhesion.work_receding");
    assert!(
        message["accepted"]
            .as_str()
            .unwrap()
            .contains("breaking contact takes at least the energy gained"),
        "{message}"
    );
    let message = refused("/api/cycle", &[("method.name", json!("punch"))]);
    assert!(
        message["message"]
            .as_str()
            .unwrap()
            .contains("the method \"punch\": only the spectral method supports adhesion"),
        "{message}"
    );
    let mut none = question(server.next(), &case(0.01));
    none["load"] = json!({ "fraction": 1.0 });
    let answer = server.ask("/api/cycle", &none);
    assert_eq!(answer.status, 422, "{}", answer.body);
}

/// Exactly.
#[test]
fn no_work_is_no_adhesion() {
    let server = Running::start();
    let state = |values: &Value| {
        let answer = server.ask("/api/contact", &question(server.next(), values));
        let mut state = answer.line("state");
        state["summary"]["wall_time_s"] = Value::Null;
        (state, answer.line("section"))
    };
    assert_eq!(state(&adhesive(0.01, "0 J/m2")), state(&case(0.01)));
}

#[test]
fn files_of_a_cycle_are_those_of_the_command_line() {
    let server = Running::start();
    let file = |values: &Value, name: &str, load: f64| {
        let mut asked = question(server.next(), values);
        asked["file"] = json!(name);
        asked["load"] = json!({ "fraction": load });
        server.ask("/api/export", &asked)
    };
    let values = adhesive(0.01, "50 mJ/m2");
    let toml = file(&values, "case.toml", 1.0).body;
    let read = CaseFile::parse("case.toml", &toml).unwrap().case().unwrap();
    assert!((read.system.adhesion().work / 50e-3 - 1.0).abs() < 1e-15);
    let summary: Value = serde_json::from_str(&file(&values, "summary.json", 1.0).body).unwrap();
    let expected = cycle(0.01, "50mJ/m2");
    assert_eq!(
        summary["pull_off_force_N"],
        json!(expected.pull_off.as_ref().unwrap().force)
    );
    // At the last detachment nothing is in contact; at the critical state all pillars reached by the
    // lens are.
    let rows = file(&values, "pillars.csv", 1.0).body.lines().count();
    assert_eq!(rows, 1 + expected.turn.pillars_in_contact);
    assert_eq!(file(&values, "pillars.csv", 2.0).status, 422);
    for name in ["cycle.svg", "releases.svg", "profiles.svg", "top-view.svg"] {
        let figure = file(&values, name, 1.5);
        assert!(figure.body.contains("<svg"), "{name}: {}", figure.body);
    }
    let without = file(&case(0.01), "cycle.svg", 1.0);
    assert_eq!(without.status, 422);
    assert!(
        without.body.contains("without adhesion there is no cycle"),
        "{}",
        without.body
    );
}

#[test]
fn a_newer_cycle_calls_off_the_one_before() {
    let server = Running::start();
    let start = Instant::now();
    // Some thousands of pillars, which takes minutes.
    let body = question(1, &adhesive(0.25, "1 mJ/m2")).to_string();
    let headers = [
        ("content-type", "application/json"),
        ("x-fakir-token", server.token.as_str()),
    ];
    let mut stream = server.connect();
    let request = server.request("/api/cycle", &body, &headers);
    stream.write_all(request.as_bytes()).unwrap();
    std::thread::sleep(Duration::from_millis(200));
    let newest = server.ask("/api/cycle", &question(2, &adhesive(0.01, "50 mJ/m2")));
    assert_eq!(newest.status, 200);
    assert!(!stations(&newest).is_empty());
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    let answer = String::from_utf8_lossy(&answer);
    assert!(!answer.contains("\"station\""), "{answer}");
    assert!(start.elapsed() < Duration::from_secs(25));
}
