//! Flat surfaces with the real binary: what is answered, saved and refused.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn fakir(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fakir"))
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .args(arguments)
        .output()
        .expect("the binary runs")
}

fn json(arguments: &[&str]) -> Value {
    let output = fakir(&[arguments, &["--json"]].concat());
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

fn number(value: &Value, name: &str) -> f64 {
    let found = value[name].as_f64();
    found.unwrap_or_else(|| panic!("no number {name} in {value}"))
}

const CASE: &str = "examples/flat.toml";

/// K. L. Johnson, K. Kendall, A. D. Roberts (1971): -(3/2) pi w R with the receding work; the sphere differs from their paraboloid by the order of (a/R)^2.
#[test]
fn the_pull_off_is_that_of_johnson_kendall_and_roberts() {
    let cycle = json(&["cycle", CASE, "--to", "5um"]);
    let expected = -1.5 * std::f64::consts::PI * 80e-3 * 2.2e-3;
    let found = number(&cycle, "pull_off_force_N");
    assert!((found / expected - 1.0).abs() < 1e-3, "{found:e}");
    assert!(number(&cycle, "hysteresis_J") > 0.0 && cycle["converged"] == true);
    // A film makes it larger or smaller by its thickness, and the Tabor number is among the limits.
    let range = ["press", CASE, "--force", "1mN", "--attraction-range", "5nm"];
    let limits = json(&range)["limits"].to_string();
    assert!(
        limits.contains("tabor_number") && limits.contains("substrate_thickness_of_one_percent_m")
    );
}

#[test]
fn files_of_a_contact_a_loading_and_a_cycle() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let has = |name: &str, files: &[&str]| {
        for file in files {
            assert!(
                folder.path().join(name).join(file).exists(),
                "{name}/{file}"
            );
        }
    };
    let saved = |arguments: &[&str], name: &str| {
        let output = fakir(&[arguments, &["--output", &at(name)]].concat());
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        has(name, &["case.toml", "summary.json", "provenance.json"]);
    };
    saved(&["press", CASE, "--indentation", "2um"], "press");
    has(
        "press",
        &[
            "pressure.csv",
            "flat-pressure.svg",
            "flat-pressure.png",
            "fields.nc",
            "fields.vti",
        ],
    );
    let folder_of = "maps";
    saved(
        &["press", CASE, "--force", "1mN", "--field-points", "33"],
        folder_of,
    );
    // Eight bytes for each point of three maps, with coordinates and texts.
    let size = std::fs::metadata(folder.path().join("maps/fields.nc")).unwrap();
    assert!((3 * 8 * 33 * 33..60_000).contains(&size.len()), "{size:?}");
    saved(&["approach", CASE, "--to", "3um"], "approach");
    has("approach", &["approach.csv", "approach.svg"]);
    saved(&["cycle", CASE, "--to", "3um"], "cycle");
    has("cycle", &["cycle.csv", "cycle.svg"]);
    // The saved case gives the same numbers.
    let again = at("press/case.toml");
    let [first, second] = [CASE, &again].map(|case| json(&["press", case, "--indentation", "2um"]));
    assert_eq!(first["force_N"], second["force_N"]);
}

#[test]
fn what_a_flat_surface_has_not_is_refused_with_the_reason() {
    for (arguments, why) in [
        (&["transition", CASE][..], "no floor between pillars"),
        (&["approach", CASE], "the loading has no end"),
        (&["cycle", CASE], "give --to or --to-force"),
        (&["theory", CASE], "closed forms"),
        (
            &[
                "design",
                CASE,
                "--free",
                "radius",
                "--critical-force",
                "1mN",
            ],
            "flat surface",
        ),
        (
            &["press", CASE, "--force", "1mN", "--set", "lens.shape=plate"],
            "no finite",
        ),
    ] {
        let output = fakir(arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            !output.status.success() && message.contains(why),
            "{arguments:?}: {message}"
        );
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    }
}

/// `-3/2 pi w R` (K. L. Johnson, K. Kendall, A. D. Roberts, 1971) of the receding work of the case, and Hertz's `R = (3 F/(4 E* zeta^(3/2)))^2`, of which a
/// sphere differs by the order of `zeta/R`.
#[test]
fn a_lens_is_designed() {
    let arguments = ["design", CASE, "--free", "lens.radius"];
    let pull = ["--pull-off", "0.5mN", "--at-indentation", "3um"];
    let design = json(&[&arguments[..], &pull].concat())["design"].clone();
    assert_eq!(design["status"], "found");
    let radius = 0.5e-3 / (1.5 * std::f64::consts::PI * 80e-3);
    assert!((number(&design, "value_m") / radius - 1.0).abs() < 2e-3);
    assert!((number(&design["cycle"], "pull_off_force_N") / -0.5e-3 - 1.0).abs() < 1e-6);
    let dry = [
        "--set",
        "adhesion.work=0",
        "--set",
        "adhesion.work_receding=0",
    ];
    let press = ["--force", "1mN", "--at-indentation", "2um"];
    let all = [&arguments[..], &press, &dry].concat();
    let design = json(&all)["design"].clone();
    let radius = (3.0 * 1e-3 / (4.0 * 2e6 / 1.5 * 2e-6_f64.powf(1.5))).powi(2);
    assert!((number(&design, "value_m") / radius - 1.0).abs() < 2e-3);
    assert_eq!(design["wanted"]["indentation_m"], 2e-6);
    assert!((number(&design["state"], "force_N") / 1e-3 - 1.0).abs() < 1e-8);
    let text = String::from_utf8(fakir(&all).stdout).unwrap();
    assert!(
        text.contains("gives a force of 1 mN in the contact at an indentation of 2 um"),
        "{text}"
    );
    let output = fakir(&["design", CASE, "--free", "lens.radius", "--force", "1mN"]);
    assert_eq!(output.status.code(), Some(2));
}

/// As of pillars that are not touched.
#[test]
fn an_untouched_surface_has_no_gradient() {
    let dry = ["adhesion.work=0", "adhesion.work_receding=0"];
    let arguments = ["press", CASE, "--force", "0", "--gradient"];
    let sets = dry.into_iter().flat_map(|setting| ["--set", setting]);
    let arguments: Vec<&str> = arguments.into_iter().chain(sets).collect();
    let output = fakir(&arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("not touched"), "{message}");
    assert_eq!(output.status.code(), Some(3), "{message}");
}

/// Boundary elements find the extent of the contact and its force; both lenses and punches, half-spaces and films.
#[test]
fn a_contact_is_verified_with_boundary_elements() {
    let dry = [
        "--set",
        "adhesion.work=0",
        "--set",
        "adhesion.work_receding=0",
    ];
    let film = &["--set", "substrate.thickness=0.2mm"];
    let punch = &["--set", "lens.shape=punch", "--set", "lens.radius=50um"];
    for (extra, is_dry) in [(&[][..], true), (film, true), (punch, true), (&[], false)] {
        let arguments = ["verify", CASE, "--force", "1mN"];
        let dry = if is_dry { &dry[..] } else { &[] };
        let found = json(&[&arguments[..], dry, extra].concat());
        assert_eq!(found["verdict"], "agree", "{found}");
        let answers = found["answers"].as_array().unwrap();
        let methods: Vec<&Value> = answers.iter().map(|row| &row["method"]).collect();
        assert_eq!(methods, ["disc", "love", "love"]);
        assert_eq!(answers[2]["cells_per_diameter"], 64);
        let [exact, elements] = [&answers[0], &answers[2]].map(|row| number(row, "indentation_m"));
        let tolerance = if is_dry { 1e-2 } else { 5e-2 };
        assert!(
            (elements / exact - 1.0).abs() < tolerance && elements.to_bits() != exact.to_bits()
        );
        assert!(
            found["relative_difference"]["contact_area"]
                .as_f64()
                .is_some()
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("verify");
    let saved = [
        "verify", CASE, "--force", "1mN", "--cells", "32", "--output",
    ];
    let done = fakir(&[&saved[..], &[&output.to_string_lossy()], &dry].concat());
    let message = String::from_utf8_lossy(&done.stdout).into_owned();
    // What is prescribed is not compared.
    assert!(!message.contains("Difference in force"), "{message}");
    assert!(
        done.status.success() && message.contains("elements, 32 cells"),
        "{message}"
    );
    assert!(output.join("verify.csv").exists() && output.join("provenance.json").exists());
}

/// The pull of JKR at a prescribed indentation grows with the work of adhesion; under Hertz, F is proportional to sqrt(R).
#[test]
fn derivatives_of_a_contact() {
    let found = json(&["press", CASE, "--indentation", "2um", "--gradient"]);
    let gradient = &found["gradient"];
    assert!(gradient["indentation_m"].is_null());
    let by = |key: &str| number(&gradient["force_N"], key);
    assert!(by("adhesion.work") < 0.0 && by("lens.young_modulus") > 0.0);
    let dry = [
        "--set",
        "adhesion.work=0",
        "--set",
        "adhesion.work_receding=0",
    ];
    let hertz = [
        "press",
        CASE,
        "--indentation",
        "2um",
        "--gradient",
        "--set",
        "lens.shape=paraboloid",
    ];
    let found = json(&[&hertz[..], &dry].concat());
    let by_radius = number(&found["gradient"]["force_N"], "lens.radius");
    let expected = number(&found, "force_N") / (2.0 * 2.2e-3);
    assert!((by_radius / expected - 1.0).abs() < 1e-9, "{by_radius:e}");
    let film = json(&[
        "press",
        CASE,
        "--force",
        "1mN",
        "--gradient",
        "--set",
        "substrate.thickness=0.2mm",
    ]);
    let by_thickness = number(&film["gradient"]["indentation_m"], "substrate.thickness");
    assert!(by_thickness > 0.0);
}

#[test]
fn a_sweep_of_contacts_and_of_cycles() {
    let folder = tempfile::tempdir().unwrap();
    let bodies = std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../..")
            .join(CASE),
    )
    .unwrap();
    std::fs::write(folder.path().join("flat.toml"), bodies).unwrap();
    for (question, extra, column) in [
        ("press", "indentation = \"2 um\"\n", "force_N"),
        ("cycle", "indentation = \"2 um\"\n", "pull_off_force_N"),
    ] {
        let study = folder.path().join(format!("{question}.toml"));
        let text = format!(
            "[study]\nquestion = \"{question}\"\ncase = \"flat.toml\"\n{extra}\n[axes]\n\"lens.radius\" = [\"1 mm\", \"2 mm\"]\n"
        );
        std::fs::write(&study, text).unwrap();
        let output = folder.path().join(question);
        let done = fakir(&[
            "sweep",
            &study.to_string_lossy(),
            "--output",
            &output.to_string_lossy(),
        ]);
        assert!(
            done.status.success(),
            "{}",
            String::from_utf8_lossy(&done.stderr)
        );
        let table = std::fs::read_to_string(output.join("table.csv")).unwrap();
        assert!(table.lines().next().unwrap().contains(column), "{table}");
        assert_eq!(table.lines().count(), 3);
    }
}

/// The true values are those of crates/fakir-inverse/examples/synthetic_retraction.rs.
#[test]
fn a_fit_of_a_reference_measurement() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("fit");
    let fit = |arguments: &[&str]| {
        let fixed = [
            "fit",
            "examples/fit/reference.txt",
            "--case",
            "examples/fit/reference.toml",
            "--machine-compliance",
            "1.5e-3",
        ];
        fakir(&[&fixed[..], arguments].concat())
    };
    let free =
        "substrate.young_modulus,adhesion.work,adhesion.work_receding,contact_point,force_offset";
    let done = fit(&[
        "--free",
        free,
        "--json",
        "--output",
        &output.to_string_lossy(),
    ]);
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    let json: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(json["method"], "flat");
    assert_eq!(json["describes_data"], true);
    for (number, (name, truth)) in [
        ("value_Pa", 1.7e6),
        ("value_J_per_m2", 30e-3),
        ("value_J_per_m2", 55e-3),
        ("value_m", 800e-9),
        ("value_N", 0.0),
    ]
    .into_iter()
    .enumerate()
    {
        let parameter = &json["parameters"][number];
        let error = name.replace("value", "standard_error");
        let [value, error] = [name, error.as_str()].map(|name| parameter[name].as_f64().unwrap());
        assert!((value - truth).abs() < 3.0 * error, "{parameter}");
    }
    let saved = std::fs::read_to_string(output.join("case.toml")).unwrap();
    assert!(!saved.contains("[pattern]") && saved.contains("work_receding"));
    let refused = fit(&["--free", "pattern.pitch"]);
    assert_eq!(refused.status.code(), Some(2));
    let words = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(words.contains("flat surface has no such key"), "{words}");
}
