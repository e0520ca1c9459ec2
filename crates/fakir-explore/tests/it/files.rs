//! Files that the user gives: what they contain, and height maps.

use crate::without_server::{base64, lines};
use serde_json::{Value, json};
use std::fmt::Write as _;

fn ask(name: &str, mut body: Value) -> Vec<Value> {
    body["ticket"] = json!({ "session": "test", "sequence": 1 });
    lines(name, &body)
}

fn given(name: &str, contents: &[u8]) -> Value {
    json!({ "name": name, "base64": base64(contents) })
}

#[test]
fn files_are_told_apart_by_their_contents() {
    let matrix = "0.1 0.2 0.3 0.1 0.2 0.3 0.1 0.2 0.3\n".repeat(9);
    for (name, contents, expected) in [
        (
            "a.csv",
            "x_um,y_um\n0,0\n9,0\n",
            json!({ "kind": "pillars", "height": false, "diameter": false }),
        ),
        (
            "Results.csv",
            " ,Label,X [um],Y [um],Area [um^2],Height [um]\n1,a,10,0,28,2\n",
            json!({ "kind": "pillars", "height": true, "diameter": true }),
        ),
        (
            "a.csv",
            "displacement_um,force_uN\n0,0\n1,2\n2,3\n",
            json!({ "kind": "curve" }),
        ),
        ("a.txt", matrix.as_str(), json!({ "kind": "heights" })),
        ("a.asc", "ncols 4\nnrows 4\n", json!({ "kind": "heights" })),
        ("a.npy", "\u{93}NUMPY", json!({ "kind": "heights" })),
        ("a.csv", "1,2\n2,3\n3,4\n4,5\n", json!({ "kind": "curve" })),
    ] {
        let found = ask("read", json!({ "file": given(name, contents.as_bytes()) }));
        assert_eq!(found, [json!({ "read": expected })], "{name}");
    }
    let png = ask(
        "read",
        json!({ "file": given("a.bin", b"\x89PNG\r\n\x1a\n") }),
    );
    assert_eq!(png[0]["read"]["kind"], "heights");
    let other = ask("read", json!({ "file": given("a.csv", b"") }));
    assert_eq!(other[0]["read"]["kind"], "curve");
}

/// Radius of curvature of the bump, and of the lens, m.
const BUMP: f64 = 1e-3;
const LENS: f64 = 2.2e-3;

/// A round bump of `side` by `side` points over 200 um, as rows of heights in um.
fn bump(side: usize) -> String {
    let mut text = String::new();
    let at = |k: usize| 200e-6 * ((k as f64 + 0.5) / side as f64 - 0.5);
    for row in 0..side {
        for column in 0..side {
            let height = -(at(row).powi(2) + at(column).powi(2)) / (2.0 * BUMP);
            write!(text, "{} ", 1e6 * height).unwrap();
        }
        text.push('\n');
    }
    text
}

fn question(map: &str) -> Value {
    let values = json!({
        "lens.radius": LENS, "lens.young_modulus": 2e6, "lens.poisson_ratio": 0.5,
        "substrate.young_modulus": 2e6, "substrate.poisson_ratio": 0.5,
        "surface.width": "200 um", "surface.height_unit": "1 um",
    });
    json!({ "case": values, "map": given("bump.txt", map.as_bytes()) })
}

/// A lens on a round bump is Hertz's contact with the radius 1/(1/R + 1/R_bump): F = 4/3 E* sqrt(R) delta^(3/2), with the modulus
/// E* = 2/3 E of two incompressible bodies of modulus E.
#[test]
fn a_height_map_is_answered_on_large_cells_first() {
    let mut body = question(&bump(192));
    let indentation: f64 = 2e-6;
    body["indentation_m"] = json!(indentation);
    let answers = ask("surface", body);
    let answers: Vec<&Value> = answers
        .iter()
        .filter_map(|line| line.get("surface"))
        .collect();
    assert_eq!(answers.len(), 2, "{answers:?}");
    let radius = 1.0 / (1.0 / LENS + 1.0 / BUMP);
    let modulus = 2e6 * 2.0 / 3.0;
    let expected = 4.0 / 3.0 * modulus * radius.sqrt() * indentation.powf(1.5);
    for (answer, (cells, tolerance)) in answers.iter().zip([(96, 2e-2), (192, 5e-3)]) {
        assert_eq!(answer["cells"], json!([cells, cells]));
        assert_eq!(answer["file_cells"], json!([192, 192]));
        let force = answer["summary"]["force_N"].as_f64().unwrap();
        assert!(
            (force / expected - 1.0).abs() < tolerance,
            "{force} {expected}"
        );
    }
    assert_eq!(answers[0]["approximate"], true);
    assert_eq!(answers[1]["approximate"], false);
    let last = answers[1];
    let [columns, rows] = [0, 1].map(|k| last["drawn"][k].as_u64().unwrap() as usize);
    let pressures = last["pressures"].as_str().unwrap();
    assert_eq!(pressures.len(), columns * rows);
    assert_eq!(last["heights"].as_str().unwrap().len(), columns * rows);
    // The contact is a disc of radius sqrt(R delta) around the middle.
    let touched = pressures.bytes().filter(|letter| *letter != b' ').count();
    let area = std::f64::consts::PI * radius * indentation;
    let cell = 200e-6 / columns as f64;
    assert!(
        (touched as f64 * cell * cell / area - 1.0).abs() < 0.06,
        "{touched}"
    );
    assert_eq!(
        last["section"]["x_m"].as_array().unwrap().len(),
        last["section"]["lens_m"].as_array().unwrap().len()
    );
    assert!(
        last["toml"]
            .as_str()
            .unwrap()
            .contains("height_map = \"bump.txt\"")
    );
    assert_eq!(
        last["command"],
        "fakir press fakir-surface.toml --indentation 2um"
    );
}

/// What the file does not state is asked for by the key that gives it.
#[test]
fn height_maps_that_cannot_be_placed_are_refused_at_their_key() {
    let refused = |body: Value| {
        let lines = ask("surface", body);
        lines[lines.len() - 1]["refused"].clone()
    };
    let mut body = question(&bump(24));
    body["case"]
        .as_object_mut()
        .unwrap()
        .remove("surface.width");
    let refusal = refused(body);
    assert!(
        refusal["accepted"]
            .as_str()
            .unwrap()
            .contains("surface.width"),
        "{refusal}"
    );
    // In metres the bump is as high as it is wide.
    let mut body = question(&bump(24));
    body["case"]
        .as_object_mut()
        .unwrap()
        .remove("surface.height_unit");
    let refusal = refused(body);
    assert!(refusal.to_string().contains("1 um"), "{refusal}");
    let mut odd = question(&bump(24));
    odd["indentation_m"] = json!(-1.0);
    assert_eq!(refused(odd)["key"], "indentation_m");
    let archive = json!({
        "case": question("")["case"],
        "map": given("a.npz", b"PK\x03\x04"),
    });
    let refusal = refused(archive);
    assert!(
        refusal["message"]
            .as_str()
            .unwrap()
            .contains("save one array as .npy"),
        "{refusal}"
    );
}
