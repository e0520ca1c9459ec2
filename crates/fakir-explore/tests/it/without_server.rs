//! Answers without a server, which are those of the module of WebAssembly.

use crate::running::{case, question};
use fakir::problem::{Load, Method};
use fakir::state::Run;
use fakir_case::{Case, CaseFile};
use fakir_explore::{Limits, Part, answer};
use serde_json::{Value, json};
use std::sync::{Arc, Mutex};

const LIMITS: Limits = Limits {
    memory: 1_000_000_000,
    most_cells: 3e4,
};

/// The parts of an answer: lines, and the file if there is one.
fn parts(name: &str, body: &Value) -> Vec<Part> {
    let parts = Arc::new(Mutex::new(Vec::new()));
    let received = Arc::clone(&parts);
    answer(name, body.to_string().as_bytes(), LIMITS, move |part| {
        received.lock().unwrap().push(part);
    });
    let parts = parts.lock().unwrap();
    parts.clone()
}

/// The lines of an answer.
pub(crate) fn lines(name: &str, body: &Value) -> Vec<Value> {
    let lines = parts(name, body).into_iter().filter_map(|part| match part {
        Part::Line(line) => Some(serde_json::from_slice(&line).unwrap()),
        Part::File { .. } => None,
    });
    lines.collect()
}

/// The media types of the files of an answer.
pub(crate) fn media_types(name: &str, body: &Value) -> Vec<&'static str> {
    let files = parts(name, body).into_iter().filter_map(|part| match part {
        Part::File { kind, .. } => Some(kind),
        Part::Line(_) => None,
    });
    files.collect()
}

fn line<'a>(lines: &'a [Value], name: &str) -> &'a Value {
    let found = lines.iter().find_map(|line| line.get(name));
    found.unwrap_or_else(|| panic!("no {name} in {lines:?}"))
}

fn example() -> Case {
    let mut file = CaseFile::parse("case", &Case::example().to_toml()).unwrap();
    file.set("pattern.surface_fraction=0.01").unwrap();
    file.case().unwrap()
}

/// The expected number is that of the library for the same case.
#[test]
fn answers_are_those_of_the_library() {
    let system = example().system;
    let expected = fakir::transition(&system, Method::default(), &Run::default()).unwrap();
    let lines = lines("contact", &question(1, &case(0.01)));
    let critical = line(&lines, "critical");
    assert_eq!(critical["critical_force_N"], json!(expected.contact.force));
    assert!(line(&lines, "section")["x_m"].as_array().unwrap().len() > 100);
}

#[test]
fn a_file_is_one_part_with_its_media_type() {
    let mut body = question(1, &case(0.01));
    body["file"] = json!("case.toml");
    let found = parts("export", &body);
    let [Part::File { kind, contents }] = &found[..] else {
        panic!("{found:?}");
    };
    assert_eq!(*kind, "application/toml");
    assert_eq!(*contents, example().to_toml().into_bytes());
}

#[test]
fn invalid_requests_are_refused_in_a_line() {
    for (name, body) in [
        ("nothing", json!({})),
        ("contact", json!({ "case": 1 })),
        ("contact", json!(null)),
        ("fit", question(1, &case(0.01))),
    ] {
        let lines = lines(name, &body);
        assert_eq!(lines.len(), 1, "{lines:?}");
        assert!(lines[0]["refused"]["message"].is_string(), "{lines:?}");
    }
}

/// More cells than allowed are refused before they are solved, with the command that computes the same.
#[test]
fn an_adhesive_floor_of_many_cells_is_refused_with_the_command() {
    let mut values = case(0.1);
    values["adhesion.work"] = json!(0.05);
    values["adhesion.floor"] = json!("true");
    let lines = lines("cycle", &question(1, &values));
    let refused = line(&lines, "refused");
    assert_eq!(refused["key"], "adhesion.floor");
    let accepted = refused["accepted"].as_str().unwrap();
    assert!(accepted.contains("fakir cycle case.toml"), "{accepted}");
    assert!(accepted.contains("--set adhesion.floor=true"), "{accepted}");
}

/// A curve that the library computes for a modulus of 2 MPa, read with a contact point of 1 um, is fitted from 1.5 MPa.
#[test]
fn a_measured_curve_is_read_and_fitted() {
    let system = example().system;
    let run = Run::default();
    let text: String = (1..=12)
        .map(|k| {
            let zeta = 0.15e-6 * f64::from(k);
            let load = Load::Indentation(zeta);
            let state = fakir::press(&system, load, Method::default(), &run).unwrap();
            format!("{},{}\n", 1e6 * (zeta + 1e-6), 1e6 * state.force)
        })
        .collect();
    let text = format!("displacement_um,force_uN\n{text}");
    let mut values = case(0.01);
    values["substrate.young_modulus"] = json!(1.5e6);
    let mut body = json!({
        "ticket": { "session": "test", "sequence": 1 },
        "case": values,
        "curve": { "name": "curve.csv", "base64": base64(text.as_bytes()) },
    });
    let read = lines("fit", &body);
    let measured = line(&read, "measured");
    assert_eq!(measured["position"], "displacement");
    assert_eq!(measured["position_m"].as_array().unwrap().len(), 12);
    body["free"] = json!(["substrate.young_modulus", "contact_point"]);
    body["contact_point_m"] = json!(0.9e-6);
    let found = lines("fit", &body);
    let fitted = line(&found, "fitted");
    let estimate = |name: &str| {
        let all = fitted["estimates"].as_array().unwrap();
        let found = all.iter().find(|it| it["name"] == name).unwrap();
        found["value"].as_f64().unwrap()
    };
    let modulus = estimate("substrate.young_modulus");
    assert!((modulus / 2e6 - 1.0).abs() < 1e-3, "{modulus}");
    let point = estimate("contact_point");
    assert!((point / 1e-6 - 1.0).abs() < 1e-3, "{point}");
}

#[test]
fn a_file_that_is_no_curve_is_refused() {
    let picture = b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR";
    for contents in [
        &picture[..],
        b"",
        b"hello\n",
        b"force_N,contact_radius_m\n1,2\n",
    ] {
        let body = json!({
            "ticket": { "session": "test", "sequence": 1 },
            "case": case(0.01),
            "curve": { "name": "curve.csv", "base64": base64(contents) },
        });
        let lines = lines("fit", &body);
        assert_eq!(line(&lines, "refused")["key"], "curve", "{lines:?}");
    }
}

/// Base64, as the browser writes it.
pub(crate) fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let of_three = |three: &[u8]| {
        let number = three
            .iter()
            .fold(0, |all, byte| all << 8 | u32::from(*byte))
            << (8 * (3 - three.len()));
        let letters = (0..4).map(move |k| match k <= three.len() {
            true => char::from(LETTERS[(number >> (18 - 6 * k) & 63) as usize]),
            false => '=',
        });
        letters.collect::<String>()
    };
    bytes.chunks(3).map(of_three).collect()
}

/// A case with a table of pillars, given as text.
fn with_table(text: &str) -> Value {
    let mut values = case(0.01);
    let values_of = values.as_object_mut().unwrap();
    values_of.retain(|key, _| !key.starts_with("pattern.") || key.starts_with("pattern.pillar."));
    values["pattern.lattice"] = json!("listed");
    values["pattern.pillars"] = json!("sample.csv");
    let mut body = question(1, &values);
    body["table"] = json!({ "name": "sample.csv", "base64": base64(text.as_bytes()) });
    body
}

/// The expected number is that of the finite square lattice with pillars at the same positions. The coordinates of the table start at a
/// corner: the lens axis is that of the pillar in the middle.
#[test]
fn a_table_of_pillars_has_the_contact_of_its_lattice() {
    let mut file = example().to_file("lattice").unwrap();
    for change in [
        "pattern.lattice=square",
        "pattern.pitch=30um",
        "pattern.columns=9",
    ] {
        file.set(change).unwrap();
    }
    let system = file.case().unwrap().system;
    let expected = fakir::transition(&system, Method::default(), &Run::default()).unwrap();
    let mut text = "x_um,y_um\n".to_owned();
    for (column, row) in (0..9).flat_map(|column| (0..9).map(move |row| (column, row))) {
        text += &format!("{},{}\n", 100 + 30 * column, 30 * row);
    }
    let lines = lines("contact", &with_table(&text));
    let critical = line(&lines, "critical");
    let force = critical["critical_force_N"].as_f64().unwrap();
    assert!(
        (force / expected.contact.force - 1.0).abs() < 1e-9,
        "{force}"
    );
    let listed = line(&lines, "state")["lattice"]["listed"]
        .as_array()
        .unwrap();
    assert_eq!(listed.len(), 81);
    let nearest = listed
        .iter()
        .filter_map(|it| Some(it[0].as_f64()?.hypot(it[1].as_f64()?)));
    assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-12);
    // The case file names the table.
    let toml = line(&lines, "case")["toml"].as_str().unwrap();
    assert!(toml.contains("pillars = \"sample.csv\""), "{toml}");
}

#[test]
fn tables_of_pillars_that_cannot_be_read_are_refused_in_words() {
    let many = |count: u32| {
        (0..count)
            .map(|k| format!("{}\n", 20 * k))
            .collect::<String>()
    };
    let mut link = with_table("x_um,y_um\n0,0\n");
    link.as_object_mut().unwrap().remove("table");
    for (body, words) in [
        (with_table("x_um,y_um\n0,zero\n"), "line 2"),
        (with_table("x_um,y_um\n0,0\n3,0\n"), "overlaps"),
        (with_table("position\n0\n"), "x_m"),
        (
            with_table(&format!("x_um,y_um\n{}", many(6000).replace('\n', ",0\n"))),
            "6000 pillars",
        ),
        (link, "not part of a link"),
    ] {
        let lines = lines("contact", &body);
        let message = lines[0]["refused"].to_string();
        assert!(message.contains(words), "{message}");
    }
    let curves = lines("curves", &{
        let mut body = with_table("x_um,y_um\n0,0\n30,0\n");
        body.as_object_mut().unwrap().remove("load");
        body
    });
    assert!(
        curves[0]["refused"]
            .to_string()
            .contains("surface fraction"),
        "{curves:?}"
    );
}
