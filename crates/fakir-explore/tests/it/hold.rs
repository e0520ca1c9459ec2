//! Viscoelastic bodies over time, as the page requests them.

use crate::running::{Running, case, question};
use crate::without_server::lines;
use serde_json::{Value, json};

/// The question for a load that is held, on bodies of one term of strength 1 and a relaxation time of 10 s.
fn held(surface_fraction: f64, by: &str, load: f64, ramp: f64, duration: f64) -> Value {
    let mut values = case(surface_fraction);
    values["relaxation.strengths"] = json!("1");
    values["relaxation.times"] = json!("10 s");
    json!({
        "ticket": { "session": "test", "sequence": 1 },
        "case": values,
        "hold": { "by": by, "load": load, "ramp_s": ramp, "hold_s": duration },
    })
}

fn line(name: &str, body: &Value) -> Value {
    let lines = lines(name, body);
    let found = lines.iter().find_map(|line| line.get("history")).cloned();
    found.unwrap_or_else(|| panic!("{lines:?}"))
}

fn number(value: &Value, name: &str) -> f64 {
    value[name].as_f64().unwrap()
}

/// Relaxation under a fixed indentation: the force falls as the relaxation function, F(t) = F(infinity) (1 + exp(-t/10 s)), while the contact
/// stays. At the load of each state the elastic contact has its radius.
#[test]
fn a_held_indentation_relaxes_and_its_loads_are_those_of_the_slider() {
    let body = held(0.01, "indentation", 2e-6, 0.0, 30.0);
    let history = line("hold", &body);
    let summary = &history["summary"];
    let states = summary["states"].as_array().unwrap();
    let loads = history["loads"].as_array().unwrap();
    assert_eq!(states.len(), loads.len());
    let rest = summary["equilibrium"]["force_N"].as_f64().unwrap();
    // The first state is that before the step.
    assert_eq!(states[0]["force_N"], 0.0);
    for state in &states[1..] {
        let expected = rest * (1.0 + (-number(state, "time_s") / 10.0).exp());
        let force = number(state, "force_N");
        assert!((force / expected - 1.0).abs() < 1e-4, "{state}");
    }
    let last = loads.last().unwrap().as_f64().unwrap();
    let mut asked = question(1, &body["case"]);
    asked["load"] = json!({ "fraction": last });
    let answer = lines("contact", &asked);
    let state = answer.iter().find_map(|line| line.get("state")).unwrap();
    let (found, expected) = (
        number(&state["summary"], "contact_radius_m"),
        number(states.last().unwrap(), "contact_radius_m"),
    );
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    let indentation = number(&state["summary"], "indentation_m");
    assert!((indentation / 2e-6 - 1.0).abs() < 1e-6, "{indentation}");
}

/// Held at 1.2 times the relaxed critical force, the lens reaches the floor after 2 tau ln 3: the creep function of one term of strength 1 is
/// J(t) = 1 - exp(-t/(2 tau))/2, and 1.2 J(t) = 1 at exp(-t/(2 tau)) = 1/3.
#[test]
fn the_server_computes_the_time_to_floor_contact() {
    let mut body = held(0.01, "force", 1e-4, 0.0, 60.0);
    let critical = lines("contact", &question(1, &body["case"]));
    let critical = critical
        .iter()
        .find_map(|line| line.get("critical"))
        .unwrap();
    body["hold"]["load"] = json!(1.2 * number(critical, "critical_force_N"));
    let server = Running::start();
    let mut asked = question(server.next(), &body["case"]);
    asked.as_object_mut().unwrap().remove("load");
    asked["hold"] = body["hold"].clone();
    let answer = server.ask("/api/hold", &asked);
    assert_eq!(answer.status, 200, "{}", answer.body);
    let history = answer.line("history");
    let time = number(&history["summary"], "time_to_floor_contact_s");
    let expected = 20.0 * 3f64.ln();
    assert!((time / expected - 1.0).abs() < 1e-3, "{time} {expected}");
    // The load passes the critical one at that time, and the floor carries a part of the force in the end.
    let end = &history["summary"]["end"];
    assert!(number(end, "floor_share") > 0.0, "{end}");
    let last = history["loads"].as_array().unwrap().last().unwrap();
    assert!(last.as_f64().unwrap() > 1.0);
    let command = history["case"]["command"].as_str().unwrap();
    assert!(
        command.contains("fakir hold case.toml --force "),
        "{command}"
    );
    assert!(command.contains(" --ramp 0s --for "), "{command}");
    assert!(
        command.contains("--set 'relaxation.times=[\"10 s\"]'"),
        "{command}"
    );
    let toml = history["case"]["toml"].as_str().unwrap();
    assert!(
        toml.starts_with("# fakir hold fakir-case.toml --force "),
        "{toml}"
    );
    assert!(toml.contains("times = [\"10 s\"]"), "{toml}");
    let python = history["case"]["python"].as_str().unwrap();
    assert!(
        python.contains("relaxation=fakir.Relaxation([1], [\"10 s\"])"),
        "{python}"
    );
}

/// The reason is in the answer, and the command where another program computes it.
#[test]
fn what_the_page_cannot_compute_over_time_is_refused() {
    let refused = |body: &Value| {
        let lines = lines("hold", body);
        assert!(!lines.iter().any(|line| line.get("history").is_some()));
        lines[lines.len() - 1]["refused"].clone()
    };
    let mut elastic = held(0.01, "force", 1e-4, 0.0, 60.0);
    let keys = elastic["case"].as_object_mut().unwrap();
    keys.retain(|key, _| !key.starts_with("relaxation"));
    assert_eq!(refused(&elastic)["key"], "relaxation.strengths");

    let mut adhesive = held(0.01, "force", 1e-4, 0.0, 60.0);
    adhesive["case"]["adhesion.work"] = json!(0.05);
    let words = refused(&adhesive).to_string();
    assert!(words.contains("adhesi"), "{words}");

    let dense = held(0.25, "indentation", 1e-6, 0.0, 60.0);
    let words = refused(&dense).to_string();
    assert!(words.contains("takes too long for the page"), "{words}");
    assert!(
        words.contains("fakir hold case.toml --indentation 1um"),
        "{words}"
    );

    for (name, value) in [("load", -1.0), ("ramp_s", -1.0), ("hold_s", 1e10)] {
        let mut odd = held(0.01, "force", 1e-4, 0.0, 60.0);
        odd["hold"][name] = json!(value);
        assert!(refused(&odd)["accepted"].is_string());
    }
    // More than the slider of the load shows.
    let far = held(0.01, "indentation", 9e-6, 1.0, 60.0);
    let words = refused(&far).to_string();
    assert!(words.contains("times the critical indentation"), "{words}");
}
