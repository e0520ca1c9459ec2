//! Loading and unloading with adhesive pillar tops: results, saved files and refusals of the command.

use crate::common::{Bench, assert_close, example, keys, without_times};
use serde_json::Value;

/// The intermediate substrate of the paper at a surface fraction of 3 %, with 50 mJ/m^2.
fn adhesive() -> String {
    example("adhesive.toml")
}

/// Row `phi = 0.03`, `w = 50 mJ/m^2` of `crates/fakir/tests/reference/adhesion.csv`, from an independent program; the tolerances are the
/// errors given there (`err_*`), plus 1e-4 for force and indentation at the transition.
#[test]
fn a_cycle_agrees_with_an_independent_program() {
    let bench = Bench::new();
    let case = adhesive();
    let cycle = |more: &[&str]| {
        let arguments = [&["cycle", &case], more].concat();
        bench.json(&arguments)
    };
    let by_displacement = cycle(&[]);
    let of = |name: &str, expected: f64, tolerance: f64| {
        assert_close(&by_displacement[name], expected, tolerance);
    };
    of("critical_force_N", 3.773762e-4, 1e-4 + 3.0e-6);
    of("critical_indentation_m", 4.07602e-6, 1e-4 + 5.0e-7);
    of("pull_off_force_N", -5.697e-5, 5.4e-2);
    of("last_release_indentation_m", -1.0975e-6, 5.4e-2);
    of("hysteresis_J", 1.3315e-10, 6.3e-2);
    assert_eq!(by_displacement["critical_pillars_in_contact"], 55);
    assert_eq!(by_displacement["pull_off_pillars_in_contact"], 19);
    // The loop area equals the dissipation of all events, summed separately.
    assert!(by_displacement["certificate"].as_f64().unwrap() < 1e-4);
    assert_eq!(by_displacement["converged"], true);
    assert_eq!(by_displacement["drive"], "displacement");
    // The model error is separate from the numerical errors.
    let error = &by_displacement["relative_error_estimate"]["pull_off_force"];
    assert_eq!(error["model_fronts"], 0.05);
    // Pull-off varies by 3 % with the number of levels (`LEVEL_ERROR` of the library, as measured); all other errors are far smaller.
    assert_close(&error["numerical"], 0.03, 0.1);
    // The loading mode does not change the pull-off force.
    let pull_off = by_displacement["pull_off_force_N"].as_f64().unwrap();
    let by_force = cycle(&["--drive", "force"]);
    let by_machine = cycle(&["--machine-stiffness", "20N/m"]);
    assert_close(&by_force["pull_off_force_N"], pull_off, 1e-6);
    assert_close(&by_machine["pull_off_force_N"], pull_off, 1e-6);
    assert_eq!(by_force["drive"], "force");
    assert_eq!(by_machine["drive"], "machine");
    assert_eq!(by_machine["machine_stiffness_N_per_m"], 20.0);
}

#[test]
fn keys_of_a_cycle_are_the_contract() {
    let few = ["--set", "pattern.surface_fraction=0.003"];
    let case = adhesive();
    let arguments = [&["cycle", &case], &few[..]].concat();
    let result = Bench::new().json(&arguments);
    insta::assert_snapshot!("keys_of_a_cycle", keys(&result).join("\n"));
    let heading = |name: &str| {
        let mut columns: Vec<&String> = result[name][0].as_object().unwrap().keys().collect();
        columns.sort();
        columns
    };
    assert_eq!(
        heading("stations"),
        [
            "branch",
            "contact_area_m2",
            "contact_radius_m",
            "events",
            "force_N",
            "indentation_m",
            "pillars_in_contact",
            "pillars_partially_in_contact"
        ]
    );
    assert_eq!(
        heading("events"),
        [
            "branch",
            "covered",
            "covered_before",
            "event",
            "force_N",
            "i",
            "indentation_m",
            "j",
            "x_m",
            "y_m"
        ]
    );
}

#[test]
fn a_cycle_in_words() {
    let few = ["--set", "pattern.surface_fraction=0.01"];
    let case = adhesive();
    let arguments = [&["cycle", &case], &few[..]].concat();
    let shown = Bench::new().result(&arguments);
    insta::assert_snapshot!("cycle", without_times(&shown));
}

/// Some columns of a table, row by row.
fn records<const N: usize>(table: &str, columns: [&str; N]) -> Vec<Vec<String>> {
    let mut lines = table.lines().map(|line| line.split(','));
    let heading: Vec<&str> = lines.next().unwrap().collect();
    let places = columns.map(|name| heading.iter().position(|own| *own == name).unwrap());
    let row = |cells: std::str::Split<'_, char>| {
        let cells: Vec<&str> = cells.collect();
        places.map(|place| cells[place].to_owned()).into()
    };
    lines.map(row).collect()
}

fn number(text: &str) -> f64 {
    text.parse().unwrap()
}

/// The tables are consistent with the summary, and the pull-off force is a row of the curve.
#[test]
fn a_cycle_is_saved_with_its_tables_and_figures() {
    let bench = Bench::new();
    let arguments = ["cycle", &adhesive(), "--output", "results"];
    let result = bench.json(&arguments);
    assert_eq!(
        bench.files("results"),
        [
            "case.toml",
            "cycle.csv",
            "cycle.png",
            "cycle.svg",
            "events.csv",
            "provenance.json",
            "pull-off-pillars.csv",
            "releases.png",
            "releases.svg",
            "summary.json",
        ]
    );
    let rows = |name: &str| bench.read(&format!("results/{name}")).lines().count() - 1;
    let count = |name: &str| result[name].as_array().unwrap().len();
    assert_eq!(rows("cycle.csv"), count("stations"));
    assert_eq!(rows("events.csv"), count("events"));
    assert_eq!(rows("pull-off-pillars.csv"), 19);
    let unloading = |row: &Vec<String>| row[0] == "unloading";
    let curve = records(&bench.read("results/cycle.csv"), ["branch", "force_N"]);
    let pulls = curve
        .into_iter()
        .filter(unloading)
        .map(|row| number(&row[1]));
    let least = pulls.fold(f64::INFINITY, f64::min);
    assert_close(&result["pull_off_force_N"], least, 1e-12);
    // The forces of all attached pillars add up to the pull-off force.
    let pillars = records(&bench.read("results/pull-off-pillars.csv"), ["force_N"]);
    let whole = pillars.iter().map(|row| number(&row[0])).sum();
    assert_close(&result["pull_off_force_N"], whole, 1e-6);
    let case = bench.read("results/case.toml");
    assert!(case.contains("[adhesion]\nwork = \"50 mJ/m2\""), "{case}");
    let provenance: Value = serde_json::from_str(&bench.read("results/provenance.json")).unwrap();
    let cited = provenance["citations"].as_array().unwrap();
    for key in ["Kendall1971", "Johnson1971"] {
        assert!(cited.iter().any(|work| work["key"] == key), "{key}");
    }
}

#[test]
fn a_cycle_has_the_given_unloading_point() {
    let bench = Bench::new();
    let cycle = |end: [&str; 2]| bench.json(&["cycle", &adhesive(), end[0], end[1]]);
    let by_indentation = cycle(["--to", "2um"]);
    assert_close(&by_indentation["turn_indentation_m"], 2e-6, 1e-6);
    assert_eq!(by_indentation["critical_force_N"], Value::Null);
    assert_eq!(by_indentation["stopped_by_floor"], false);
    let by_force = cycle(["--to-force", "0.1mN"]);
    assert_close(&by_force["turn_force_N"], 1e-4, 1e-6);
    // Past the critical state, with load on the floor.
    let past = cycle(["--to", "4.2um"]);
    assert_close(&past["turn_indentation_m"], 4.2e-6, 1e-6);
    assert_close(&past["critical_indentation_m"], 4.07602e-6, 1e-4);
    assert!(past["floor"]["jump"].is_null() && past["floor"]["last"].is_object());
}

/// With the floor ignored the loading continues past the critical state, which is reported.
#[test]
fn without_floor_the_cycle_continues_past_the_critical_state() {
    let bench = Bench::new();
    let arguments = ["cycle", &adhesive(), "--to", "6um", "--without-floor"];
    let result = bench.json(&arguments);
    assert_close(&result["turn_indentation_m"], 6e-6, 1e-9);
    assert_close(&result["critical_indentation_m"], 4.07602e-6, 1e-4);
    assert_eq!(result["stopped_by_floor"], false);
    let shown = bench.result(&arguments);
    assert!(
        shown.contains("as if without floor: the critical state is at 377.376 uN and 4.07602 um"),
        "{shown}"
    );
}

#[test]
fn what_cannot_be_is_refused() {
    let bench = Bench::new();
    let (case, plain) = (adhesive(), example("paper-intermediate.toml"));
    let surface = example("square-pillars.toml");
    let peeling = example("peeling.toml");
    let attempts: [(&[&str], &str); 17] = [
        (&["cycle", &peeling], "has no transition"),
        (
            &["transition", &plain, "--attraction-range", "5nm"],
            "--attraction-range needs adhesive pillar tops",
        ),
        (
            &["theory", &case, "--attraction-range", "0nm"],
            "--attraction-range must be a length greater than 0",
        ),
        (
            &[
                "press",
                &surface,
                "--force",
                "20uN",
                "--attraction-range",
                "5nm",
            ],
            "--attraction-range needs adhesive pillar tops",
        ),
        (
            &["approach", &case, "--attraction-range", "5nm"],
            "unexpected argument",
        ),
        (&["cycle", &plain], "a cycle needs adhesive pillar tops"),
        (&["cycle", &surface], "a cycle needs adhesion"),
        (
            &["approach", &case, "--drive", "force"],
            "unexpected argument",
        ),
        (
            &["approach", &case, "--machine-stiffness", "20N/m"],
            "unexpected argument",
        ),
        (&["cycle", &case, "--step", "1um"], "unexpected argument"),
        (
            &["cycle", &case, "--machine-stiffness", "20uN"],
            "uN is a unit of force, not of stiffness",
        ),
        (
            &["cycle", &case, "--machine-stiffness", "-1"],
            "invalid stiffness of the machine -1",
        ),
        (
            &["cycle", &case, "--to=-1um"],
            "--to must be greater than 0",
        ),
        (
            &["transition", &case, "--set", "adhesion.work=-50mJ/m2"],
            "adhesion.work: cannot be -50 mJ/m2",
        ),
        (
            &["transition", &case, "--set", "adhesion.work=50mN"],
            "mN is a unit of force, not of energy per area",
        ),
        (
            &[
                "transition",
                &case,
                "--set",
                "adhesion.work_receding=1mJ/m2",
            ],
            "adhesion.work_receding: cannot be 1 mJ/m2",
        ),
        (
            &["transition", &case, "--set", "method.name=love"],
            "only the spectral method supports",
        ),
    ];
    for (arguments, explanation) in attempts {
        let outcome = bench.run(&[arguments, &["--output", "results"]].concat());
        assert_eq!(outcome.status, Some(2), "{arguments:?}: {}", outcome.stderr);
        assert_eq!(outcome.stdout, "", "{arguments:?}");
        assert!(
            outcome.stderr.contains(explanation),
            "{arguments:?}: {}",
            outcome.stderr
        );
    }
    assert_eq!(bench.files("."), Vec::<String>::new());
}

/// `press` and `transition` are on the loading branch; past the critical state the floor carries load too.
#[test]
fn the_loading_continues_on_the_floor() {
    let bench = Bench::new();
    let critical = bench.json(&["transition", &adhesive()]);
    assert_close(&critical["critical_force_N"], 3.773762e-4, 1e-4 + 3.0e-6);
    let past = bench.json(&["press", &adhesive(), "--indentation", "4.3um"]);
    assert_eq!(past["beyond_transition"], true);
    let share = past["floor"]["share"].as_f64().unwrap();
    assert!((0.001..0.1).contains(&share), "{share}");
}

/// Adhesive boundary elements on a height map of the same pillars confirm force and area on loading, which is not the contact without adhesion.
#[test]
fn elements_verify_adhesive_tops() {
    let bench = Bench::new();
    let case = adhesive();
    let few = [
        "verify",
        &case,
        "--indentation",
        "0.3um",
        "--set",
        "pattern.surface_fraction=0.1",
        "--set",
        "lens.radius=0.5mm",
        "--quiet",
    ];
    let found = bench.json(&few);
    assert_eq!(found["verdict"], "agree", "{found}");
    for name in ["force", "contact_area"] {
        let difference = found["relative_difference"][name].as_f64().unwrap();
        let allowed = found["allowed_difference"][name].as_f64().unwrap();
        assert!(
            difference.abs() < allowed && allowed < 0.2,
            "{name}: {found}"
        );
    }
    let dry = bench.json(&[&few[..], &["--set", "adhesion.work=0"]].concat());
    assert!(dry["relative_difference"]["contact_area"].is_null());
    let force = |found: &Value| found["answers"][2]["force_N"].as_f64().unwrap();
    assert!(force(&found) < 0.9 * force(&dry));
    let text = bench.run(&few);
    assert!(text.stdout.contains("Difference in the contact area"));
}

/// No number of a comparison is presented as including adhesion if it does not.
#[test]
fn a_comparison_marks_methods_without_adhesion() {
    let bench = Bench::new();
    let few = ["--set", "pattern.surface_fraction=0.003"];
    let case = adhesive();
    let arguments = [&["compare", &case], &few[..]].concat();
    let found = bench.json(&arguments);
    for row in found["methods"].as_array().unwrap() {
        let name = row["method"].as_str().unwrap();
        let remark = row["remark"].as_str().unwrap_or_default();
        let expected = match name {
            "spectral_default" | "spectral_accurate" => "",
            "homogenised" | "punch_plain" | "punch_corrected" | "love" => {
                "only the spectral method supports adhesion"
            }
            _ => "without adhesion",
        };
        assert!(
            remark.contains(expected) && remark.is_empty() == expected.is_empty(),
            "{name}: {remark}"
        );
        assert_eq!(
            row["critical_force_N"].is_null(),
            expected.starts_with("only"),
            "{name}"
        );
    }
    let shown = bench.result(&arguments);
    assert!(
        shown.contains("Only the method spectral has adhesion"),
        "{shown}"
    );
}

/// Kendall's force on a top of 3 um radius, and three halves of pi w R (Johnson, Kendall and Roberts), by hand; and the Tabor number of a
/// top, `sqrt(8 w a/(pi E*))/h0`.
#[test]
fn theory_has_the_closed_forms_of_adhesion() {
    let bench = Bench::new();
    let case = adhesive();
    let arguments = ["theory", &case, "--attraction-range", "5nm"];
    let found = bench.json(&[&arguments[..], &["--quiet"]].concat());
    let adhesion = &found["adhesion"];
    let force = |formula: &str| {
        let rows = adhesion["pull_off"].as_array().unwrap();
        let row = rows.iter().find(|row| row["formula"] == formula);
        row.unwrap()["force_N"].clone()
    };
    let (work, modulus, radius) = (50e-3f64, 4e6 / 3.0, 3e-6f64);
    let pi = std::f64::consts::PI;
    let kendall = -(8.0 * pi * work * modulus * radius.powi(3)).sqrt();
    assert_close(&force("kendall"), kendall, 1e-12);
    assert_close(&force("jkr_by_force"), -1.5 * pi * work * 2.2e-3, 1e-12);
    assert_close(
        &force("jkr_by_displacement"),
        -5.0 / 6.0 * pi * work * 2.2e-3,
        1e-12,
    );
    assert_close(&force("maugis_dugdale"), -1.5 * pi * work * 2.2e-3, 1e-3);
    let tabor = (8.0 * work * radius / (pi * modulus)).sqrt() / 5e-9;
    assert_close(&adhesion["tabor_number"], tabor, 1e-12);
    // All other results are without adhesion, and are marked as such.
    let plain = bench.json(&["theory", &adhesive(), "--set", "adhesion.work=0"]);
    assert_eq!(plain["adhesion"], Value::Null);
    assert_eq!(plain["critical_states"], found["critical_states"]);
    let outcome = bench.run(&arguments);
    assert!(
        outcome.stderr.contains("are without adhesion"),
        "{}",
        outcome.stderr
    );
    assert!(
        outcome.stdout.contains("These are without adhesion"),
        "{}",
        outcome.stdout
    );
}

/// If the range of the attraction is too large for the short-range assumption, results report it.
#[test]
fn a_range_of_attraction_is_compared_with_its_limit() {
    let bench = Bench::new();
    let case = adhesive();
    let few = ["--set", "pattern.surface_fraction=0.003"];
    let commands: [&[&str]; 3] = [
        &["transition", &case],
        &["press", &case, "--indentation", "1um"],
        &["cycle", &case],
    ];
    for command in commands {
        for (range, exceeded, words) in [
            (
                "5nm",
                false,
                "above 5: the range is small enough (JKR limit)",
            ),
            ("0.5um", true, "below 5: the range is too large (JKR limit)"),
        ] {
            let arguments = [command, &few, &["--attraction-range", range]].concat();
            let found = bench.json(&[&arguments[..], &["--quiet"]].concat());
            let limits = found["limits"].as_array().unwrap();
            let tabor = limits.iter().find(|limit| limit["name"] == "tabor_number");
            assert_eq!(tabor.unwrap()["strained"], exceeded, "{arguments:?}");
            let outcome = bench.run(&arguments);
            assert!(outcome.stdout.contains(words), "{}", outcome.stdout);
            let warned = outcome
                .stderr
                .contains("is too large for the model, the JKR limit (Tabor number");
            assert_eq!(warned, exceeded, "{}", outcome.stderr);
        }
        let without = bench.json(&[command, &few].concat());
        let limits = without["limits"].as_array().unwrap();
        assert!(limits.iter().all(|limit| limit["name"] != "tabor_number"));
    }
}

/// The work of adhesion scatters like any quantity: pull-off is reported for every sample, and no negative work is drawn.
#[test]
fn adhesive_samples_have_the_scatter_of_pull_off() {
    let bench = Bench::new();
    let case = adhesive();
    let arguments = [
        "design",
        &case,
        "--set",
        "pattern.surface_fraction=0.003",
        "--tolerance",
        "adhesion.work=60%",
        "--samples",
        "12",
        "--keep-offset",
        "--output",
        "found",
        "--json",
    ];
    // Of a normal distribution with this tolerance 5 % are negative: these are drawn again, and that is said.
    let outcome = bench.run(&arguments);
    assert_eq!(outcome.status, Some(0), "{}", outcome.stderr);
    assert!(
        outcome
            .stderr
            .contains("draws had a value that is not valid"),
        "{}",
        outcome.stderr
    );
    let found: Value = serde_json::from_str(&outcome.stdout).unwrap();
    let spread = found["spread"].clone();
    assert_eq!(spread["failed"], 0);
    let rows = records(
        &bench.read("found/samples.csv"),
        ["adhesion.work_J_per_m2", "pull_off_force_N", "hysteresis_J"],
    );
    assert_eq!(rows.len(), 12);
    let mut pairs: Vec<(f64, f64)> = rows
        .iter()
        .map(|row| (number(&row[0]), number(&row[1])))
        .collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(pairs[0].0 > 0.0);
    // Pull-off forces increase with the work of adhesion.
    assert!(
        pairs.windows(2).all(|pair| pair[1].1 < pair[0].1),
        "{pairs:?}"
    );
    let mean = pairs.iter().map(|pair| pair.1).sum::<f64>() / 12.0;
    assert_close(&spread["pull_off_force_N"]["mean"], mean, 1e-12);
    assert!(
        spread["hysteresis_J"]["standard_deviation"]
            .as_f64()
            .unwrap()
            > 0.0
    );
    assert!(
        bench
            .files("found")
            .contains(&"pull-off-spread.svg".to_owned())
    );
    // One of these is the cycle of a separate case.
    let work = format!("adhesion.work={}", rows[0][0]);
    let alone = bench.json(&[
        "cycle",
        &case,
        "--set",
        "pattern.surface_fraction=0.003",
        "--set",
        &work,
    ]);
    assert_close(&alone["pull_off_force_N"], number(&rows[0][1]), 1e-12);
    assert_close(&alone["hysteresis_J"], number(&rows[0][2]), 1e-12);
    // Without adhesion nothing is reported.
    let plain = bench.json(&[
        "design",
        &case,
        "--set",
        "adhesion.work=0",
        "--set",
        "pattern.surface_fraction=0.003",
        "--tolerance",
        "pattern.pillar.height=2%",
        "--samples",
        "2",
    ]);
    assert!(plain["spread"].get("pull_off_force_N").is_none());
}

/// Cycles along the work of adhesion, from the command line: invalid cases are refused before the computation.
#[test]
fn cycles_are_swept_and_refused_with_line_and_key() {
    let bench = Bench::new();
    let case = std::fs::read_to_string(adhesive()).unwrap();
    bench.write("case.toml", &case);
    let study = |axes: &str| {
        bench.write(
            "study.toml",
            &format!("[study]\ncase = \"case.toml\"\nquestion = \"cycle\"\n[axes]\n{axes}\n"),
        );
    };
    study("\"adhesion.work\" = [\"10 mJ/m2\", \"50 mJ/m2\"]\nsurface_fraction = [0.003, 0.006]");
    let shown = bench.result(&["sweep", "study.toml", "--output", "results"]);
    assert!(
        shown.starts_with("4 cases: cycles of loading and unloading with adhesion\n"),
        "{shown}"
    );
    assert!(bench.files("results").contains(&"pull-off.svg".to_owned()));
    let rows = records(
        &bench.read("results/table.csv"),
        ["pull_off_force_N", "converged"],
    );
    assert!(
        rows.iter()
            .all(|row| number(&row[0]) < 0.0 && row[1] == "true")
    );
    for (axes, key, place) in [
        (
            "\"adhesion.work\" = [\"10 mJ/m2\", \"-5 mJ/m2\"]",
            "adhesion.work",
            "study.toml:5:32",
        ),
        (
            "\"adhesion.work\" = [\"10 mJ/m2\", 0]",
            "adhesion.work",
            "study.toml:5:32",
        ),
        (
            "\"adhesion.work\" = [\"10 mJ/m2\", \"5 uN\"]",
            "adhesion.work",
            "study.toml:5:32",
        ),
        (
            "\"method.name\" = [\"spectral\", \"love\"]",
            "adhesion.work",
            "study.toml:5:30",
        ),
    ] {
        study(axes);
        let outcome = bench.run(&["sweep", "study.toml", "--output", "refused"]);
        assert_eq!(outcome.status, Some(2), "{axes}: {}", outcome.stderr);
        for words in [key, place] {
            assert!(
                outcome.stderr.contains(words),
                "{words}: {}",
                outcome.stderr
            );
        }
        assert!(!bench.path("refused").exists());
    }
}
