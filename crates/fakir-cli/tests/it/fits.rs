//! `fakir fit` from the command line.

use crate::common::{Bench, Outcome, example, keys};
use serde_json::Value;

/// The example of the manual, with a fast method: the values agree with the spectral method to a standard error.
fn arguments<'a>(data: &'a str, case: &'a str) -> Vec<&'a str> {
    vec![
        "fit",
        data,
        "--case",
        case,
        "--free",
        "substrate.young_modulus,contact_point,machine_compliance",
        "--set",
        "method.name=punch",
        "--quiet",
    ]
}

/// The case is read once, whatever the number of files.
#[test]
fn the_case_may_be_standard_input() {
    let bench = Bench::new();
    let (data, case) = (example("fit/loading.csv"), example("fit/case.toml"));
    let other = example("fit/tester.csv");
    for others in [&[][..], &[&other[..]]] {
        let mut arguments = arguments(&data, "-");
        arguments.extend(others);
        let case = std::fs::File::open(&case).unwrap();
        let outcome = bench.command(&arguments).stdin(case).output().unwrap();
        let outcome = Outcome::of(&outcome);
        assert!(
            !outcome.stderr.contains("standard input"),
            "{}",
            outcome.stderr
        );
        assert!(
            outcome.stdout.contains("substrate.young_modulus"),
            "{}",
            outcome.stderr
        );
    }
}

#[test]
fn the_example_gives_its_truth() {
    let bench = Bench::new();
    let (data, case) = (example("fit/loading.csv"), example("fit/case.toml"));
    let mut arguments = arguments(&data, &case);
    arguments.extend(["--output", "results"]);
    let result = bench.json(&arguments);
    for (estimate, suffix, truth) in [
        (&result["parameters"][0], "_Pa", 1.4e6),
        (&result["parameters"][1], "_m", 3e-6),
        (&result["parameters"][2], "_m_per_N", 2e-3),
    ] {
        let ends = &estimate[format!("confidence_interval_95{suffix}")];
        let [low, high] = [0, 1].map(|end| ends[end].as_f64().unwrap());
        assert!(low < truth && truth < high, "{estimate}");
    }
    assert_eq!(
        bench.files("results"),
        [
            "case.toml",
            "fit.png",
            "fit.svg",
            "fitted.csv",
            "provenance.json",
            "summary.json"
        ]
    );
    let saved: Value = serde_json::from_str(&bench.read("results/summary.json")).unwrap();
    assert_eq!(keys(&saved), keys(&result));
    assert_eq!(bench.read("results/fitted.csv").lines().count(), 37);
    let fitted = (result["parameters"][0]["value_Pa"].as_f64().unwrap() / 1e6).to_string();
    let case = bench.read("results/case.toml");
    let line = format!("young_modulus = \"{}", &fitted[..10]);
    assert!(case.contains(&line), "{line}: {case}");
}

#[test]
fn skipped_rows_are_stated() {
    let bench = Bench::new();
    let case = example("fit/case.toml");
    let given = std::fs::read_to_string(example("fit/loading.csv")).unwrap();
    bench.write("data.csv", &format!("{given}Bad,-\nend of test\n"));
    let mut arguments = arguments("data.csv", &case);
    arguments.extend(["--rows", "3:", "--to", "8um"]);
    let result = bench.json(&arguments);
    let reasons: Vec<&str> = result["skipped"]
        .as_array()
        .unwrap()
        .iter()
        .map(|skipped| skipped["reason"].as_str().unwrap())
        .collect();
    assert_eq!(reasons, ["text", "not_measured", "not_selected"]);
    let skipped = result["rows_skipped"].as_u64().unwrap();
    assert_eq!(skipped + result["rows"].as_u64().unwrap(), 38);
    let outcome = bench.run(&arguments);
    assert!(outcome.stdout.contains("  skipped: 1 row of text (line "));
    assert!(outcome.stdout.contains("  skipped: 1 row without a value"));
    assert!(outcome.stdout.contains(" not selected (lines "));
    arguments.extend(["--cycle", "2"]);
    let outcome = bench.run(&arguments);
    assert_eq!(outcome.status, Some(2));
    let message = "data.csv: there is no cycle 2: the data have 1, numbered from 1";
    assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
}

#[test]
fn bad_input_ends_with_status_2() {
    let bench = Bench::new();
    let case = example("fit/case.toml");
    bench.write("data.csv", "displacement_m,force_N\n1e-6,2 uN\n");
    let outcome = bench.run(&arguments("data.csv", &case));
    assert_eq!(outcome.status, Some(2));
    assert_eq!(
        outcome.stderr,
        "error: data.csv:2: force_N: \"2 uN\" is no number: give one like 1.2e-5, without unit\n"
    );
    let outcome = bench.run(&arguments("missing.csv", &case));
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome
            .stderr
            .starts_with("error: missing.csv: cannot read: ")
    );
    let outcome = bench.run(&["fit", "data.csv", "--case", &case, "--free", "lens.mass"]);
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome
            .stderr
            .contains("give one of substrate.young_modulus")
    );
    let data = example("fit/loading.csv");
    for (given, told) in [
        (&["--starts", "0"][..], "give a whole number from 1 to 32"),
        (
            &["--machine-compliance=-1"],
            "a machine compliance of -1 m/N: must be 0 or greater",
        ),
        (
            &["--column", "force=force_N", "--column", "force=#2 [N]"],
            "a second column of force_N: give one",
        ),
    ] {
        let outcome = bench.run(&[&arguments(&data, &case)[..], given].concat());
        assert_eq!(outcome.status, Some(2), "{}", outcome.stderr);
        assert!(outcome.stderr.contains(told), "{}", outcome.stderr);
    }
}

/// A small lens at a large depth: the fit prints and saves the limits that `press` reports for its fitted case, and fails in strict mode.
#[test]
fn limits_of_the_model_are_those_of_press() {
    let bench = Bench::new();
    let case = example("fit/case.toml");
    let small = [
        "--set",
        "lens.radius=100um",
        "--set",
        "pattern.surface_fraction=0.2",
        "--set",
        "pattern.pillar.height=8um",
        "--set",
        "method.name=punch",
    ];
    let pressed = |depth: &str| {
        let arguments = ["press", &case, "--indentation", depth, "--quiet"];
        bench.json(&[&arguments[..], &small].concat())
    };
    let mut data = "indentation_m,force_N\n".to_owned();
    for depth in ["2um", "4um", "6um"] {
        let state = pressed(depth);
        data += &format!("{},{}\n", state["indentation_m"], state["force_N"]);
    }
    bench.write("data.csv", &data);
    let free = "substrate.young_modulus";
    let fit = [
        "fit", "data.csv", "--case", &case, "--free", free, "--quiet",
    ];
    let fit = [&fit[..], &small, &["--set", "substrate.young_modulus=2MPa"]].concat();
    let result = bench.json(&fit);
    let expected = pressed("6um");
    let limits = |value: &Value| -> Vec<(String, bool)> {
        let limits = value["limits"].as_array().unwrap().iter();
        let verdict = |limit: &Value| (limit["name"].to_string(), limit["strained"] == true);
        limits.map(verdict).collect()
    };
    assert_eq!(limits(&result), limits(&expected));
    let strained = limits(&result).into_iter().any(|(_, strained)| strained);
    assert!(strained, "{result}");
    let outcome = bench.run(&[&fit[..], &["--strict"]].concat());
    assert_eq!(outcome.status, Some(1), "{}", outcome.stderr);
    assert!(
        outcome
            .stderr
            .starts_with("error: outside the limits of the model: "),
        "{}",
        outcome.stderr
    );
    assert!(outcome.stdout.contains("exceeded:"), "{}", outcome.stdout);
}

/// The example without the machine compliance.
#[test]
fn a_fit_that_does_not_describe_the_data_is_reported_with_quiet_too() {
    let bench = Bench::new();
    let (data, case) = (example("fit/loading.csv"), example("fit/case.toml"));
    let mut quiet = arguments(&data, &case);
    quiet[5] = "substrate.young_modulus,contact_point";
    let outcome = bench.run(&quiet);
    assert_eq!(outcome.status, Some(0), "{}", outcome.stderr);
    let warning = "warning: the fit does not describe the data";
    assert!(outcome.stderr.starts_with(warning), "{}", outcome.stderr);
    let outcome = bench.run(&[&quiet[..], &["--strict"]].concat());
    assert_eq!(outcome.status, Some(1), "{}", outcome.stderr);
}

/// The example with both branches: a case, and its free parameters.
#[test]
#[ignore = "slow: fits of cycles"]
fn the_example_of_a_retraction_gives_its_truth() {
    let bench = Bench::new();
    let (data, case) = (
        example("fit/retraction.csv"),
        example("fit/retraction.toml"),
    );
    let free = "adhesion.work,substrate.young_modulus,contact_point,force_offset";
    let arguments = ["fit", &data, "--case", &case, "--free", free, "--quiet"];
    let result = bench.json(&[&arguments[..], &["--output", "results"]].concat());
    // True values of crates/fakir-inverse/examples/synthetic_retraction.rs.
    let truths = [
        ("_J_per_m2", 0.035),
        ("_Pa", 1.4e6),
        ("_m", 3e-6),
        ("_N", 2e-6),
    ];
    for (number, (suffix, truth)) in truths.into_iter().enumerate() {
        let ends = &result["parameters"][number][format!("confidence_interval_95{suffix}")];
        let [low, high] = [0, 1].map(|end| ends[end].as_f64().unwrap());
        assert!(low < truth && truth < high, "{ends}: {truth}");
    }
    let pull_off = &result["pull_off"];
    assert!(pull_off["measured_force_N"].as_f64().unwrap() < 0.0);
    // The front shapes alone contribute 0.05; tilting columns add to that.
    let of_model = pull_off["relative_error_of_model"].as_f64().unwrap();
    assert!((0.05..0.5).contains(&of_model), "{of_model}");
    let table = bench.read("results/fitted.csv");
    assert!(table.starts_with("line,branch,displacement_m,"), "{table}");
    assert!(table.contains(",unloading,") && table.contains(",loading,"));
    let figure = bench.read("results/fit.svg");
    assert!(figure.contains("unloading"));
    let provenance = bench.read("results/provenance.json");
    assert!(provenance.contains("Kendall"), "{provenance}");
}

/// Examples in the formats of instruments, read without options: true values of crates/fakir-inverse/examples/synthetic_instruments.rs.
#[test]
#[ignore = "slow: fits of whole files"]
fn examples_of_instruments_give_their_truths() {
    const COMPLIANCE: [&str; 2] = ["--machine-compliance", "0.002"];
    type Truths<'a> = &'a [(&'a str, f64)];
    let cases: [(&str, &str, &[&str], Truths); 3] = [
        (
            "nanoindenter.txt",
            "substrate.young_modulus,contact_point,displacement_drift",
            &COMPLIANCE,
            &[("_Pa", 1.4e6), ("_m", 500e-9), ("_m", 60e-9)],
        ),
        (
            "tester.csv",
            "substrate.young_modulus,contact_point,machine_compliance,force_offset",
            &[],
            &[
                ("_Pa", 1.4e6),
                ("_m", 12e-6),
                ("_m_per_N", 2e-3),
                ("_N", 5e-6),
            ],
        ),
        (
            "microscope.csv",
            "substrate.young_modulus",
            &["--set", "pattern.surface_fraction=0.05"],
            &[("_Pa", 1.4e6)],
        ),
    ];
    let bench = Bench::new();
    let case = example("fit/case.toml");
    for (name, free, more, truths) in cases {
        let data = example(&format!("fit/{name}"));
        let arguments = ["fit", &data, "--case", &case, "--free", free, "--quiet"];
        let result = bench.json(&[&arguments[..], more].concat());
        for (estimate, (suffix, truth)) in
            result["parameters"].as_array().unwrap().iter().zip(truths)
        {
            let ends = &estimate[format!("confidence_interval_95{suffix}")];
            let [low, high] = [0, 1].map(|end| ends[end].as_f64().unwrap());
            assert!(low < *truth && *truth < high, "{name}: {estimate}");
        }
        assert_eq!(
            result["describes_data"], true,
            "{name}: {}",
            result["tests"]
        );
    }
}

#[test]
#[ignore = "slow: fits of a whole file"]
fn a_machine_that_is_left_out_of_the_example_is_named() {
    let bench = Bench::new();
    let (data, case) = (example("fit/loading.csv"), example("fit/case.toml"));
    let free = "substrate.young_modulus,contact_point";
    let outcome = bench.run(&[
        "fit", &data, "--case", &case, "--free", free, "--output", "results",
    ]);
    assert_eq!(outcome.status, Some(0));
    let warning = "warning: the fit does not describe the data";
    assert!(outcome.stderr.contains(warning), "{}", outcome.stderr);
    assert!(
        outcome
            .stderr
            .contains("most likely wrong: machine_compliance (p = "),
        "{}",
        outcome.stderr
    );
    assert!(
        outcome
            .stdout
            .contains("force: column 2 \"force_N\", in N\n")
    );
    let summary: Value = serde_json::from_str(&bench.read("results/summary.json")).unwrap();
    assert_eq!(summary["describes_data"], false);
    let most = &summary["tests"]["left_out"][0];
    assert_eq!(most["name"], "machine_compliance");
    assert_eq!(summary["columns"][1]["quantity"], "force");
    assert!(
        bench
            .read("results/fit.svg")
            .contains("does not describe the data")
    );
}

#[test]
fn columns_are_named_on_the_command_line() {
    let bench = Bench::new();
    let case = example("fit/case.toml");
    let text = std::fs::read_to_string(example("fit/loading.csv")).unwrap();
    let text = text.replace("displacement_m,force_N", "Channel 1,Channel 2");
    bench.write("data.csv", &text);
    let named = [
        "--column",
        "displacement=Channel 1 [m]",
        "--column",
        "force=#2 [N]",
    ];
    let by_hand = bench.json(&[&arguments("data.csv", &case)[..], &named].concat());
    let plain = example("fit/loading.csv");
    let plain = bench.json(&arguments(&plain, &case));
    assert_eq!(by_hand["parameters"], plain["parameters"]);
    let outcome = bench.run(&arguments("data.csv", &case));
    assert_eq!(outcome.status, Some(2));
    let outcome =
        bench.run(&[&arguments("data.csv", &case)[..], &["--column", "mass=#1"]].concat());
    assert_eq!(outcome.status, Some(2));
    assert!(outcome.stderr.contains("\"mass\" is no quantity"));
}

/// Arguments of a fit of several files.
fn several<'a>(files: &[&'a str], options: &[&'a str]) -> Vec<&'a str> {
    [&["fit"], files, options].concat()
}

/// Three curves of one modulus, 1.4 MPa, of crates/fakir-inverse/examples/synthetic_curves.rs.
#[test]
fn several_files_are_fitted_separately() {
    let bench = Bench::new();
    let case = example("fit/case.toml");
    let files = ["fit/spot-1.csv", "fit/spot-2.csv", "fit/spot-3.csv"].map(example);
    let options = [
        "--case",
        &case,
        "--free",
        "substrate.young_modulus,contact_point",
        "--machine-compliance",
        "0.002",
        "--set",
        "method.name=punch",
        "--quiet",
    ];
    let names = files.each_ref().map(|file| &file[..]);
    let result = bench.json(&[&several(&names, &options)[..], &["--output", "results"]].concat());
    let modulus = &result["parameters"][0];
    assert_eq!(modulus["name"], "substrate.young_modulus");
    assert_eq!(modulus["curves"], 3);
    let number = |value: &Value| value.as_f64().unwrap();
    let mean = number(&modulus["mean_Pa"]);
    let error = number(&modulus["standard_error_of_mean_Pa"]);
    assert!((mean - 1.4e6).abs() < 4.0 * error, "{modulus}");
    // Every fit is that of the file alone.
    let alone = bench.json(&several(&names[1..2], &options));
    assert_eq!(
        result["curves"][1]["fit"]["parameters"],
        alone["parameters"]
    );
    assert_eq!(
        bench.files("results"),
        [
            "case.toml",
            "curves",
            "fits.csv",
            "fits.png",
            "fits.svg",
            "provenance.json",
            "summary.json"
        ]
    );
    assert_eq!(
        bench.files("results/curves"),
        ["1-spot-1", "2-spot-2", "3-spot-3"]
    );
    assert_eq!(
        bench.files("results/curves/2-spot-2"),
        ["fit.svg", "fitted.csv"]
    );
    assert_eq!(bench.read("results/fits.csv").lines().count(), 4);
    // The folder is replaced as a whole, with its subfolders.
    let again = [
        &several(&names[..2], &options)[..],
        &["--output", "results", "--overwrite"],
    ];
    let text = bench.result(&again.concat());
    assert!(
        text.starts_with("2 curves, each fitted separately\n"),
        "{text}"
    );
    assert_eq!(bench.files("results/curves"), ["1-spot-1", "2-spot-2"]);
    // A file that cannot be read is named, and the others are fitted.
    let outcome = bench.run(&several(&[names[0], "missing.csv", names[2]], &options));
    assert_eq!(outcome.status, Some(1), "{}", outcome.stderr);
    let warning = "warning: no fit of missing.csv: cannot read: ";
    assert!(outcome.stderr.contains(warning), "{}", outcome.stderr);
    let told = "no result of missing.csv: cannot read: ";
    assert!(outcome.stdout.contains(told), "{}", outcome.stdout);
    assert!(
        outcome
            .stdout
            .contains("3 curves, each fitted separately, 1 without a result")
    );
}

/// Two spots of a flat sample, of the closed form of Hertz: `F = 4/3 E* sqrt(R) zeta^(3/2)` with 1.7 MPa, 0.5 and 2 mm under a rigid lens.
#[test]
fn several_files_of_a_flat_surface_are_fitted_separately() {
    let bench = Bench::new();
    let case = "[lens]\nshape = \"paraboloid\"\nradius = \"2 mm\"\nyoung_modulus = \"1e9 GPa\"\npoisson_ratio = 0.3\n\
                [substrate]\nyoung_modulus = \"1 MPa\"\npoisson_ratio = 0.5\n";
    bench.write("flat.toml", case);
    for (name, point) in [("one.csv", 0.5e-6), ("two.csv", 1e-6)] {
        let mut text = "displacement_m,force_N\n".to_owned();
        for row in 0..40 {
            let reading = 0.1e-6 * f64::from(row);
            let depth = (reading - point).max(0.0);
            let ripple = if row % 2 == 0 { 1e-7 } else { -1e-7 };
            let force = 4.0 / 3.0 * 1.7e6 / 0.75 * 2e-3f64.sqrt() * depth.powf(1.5) + ripple;
            text += &format!("{reading:e},{force:e}\n");
        }
        bench.write(name, &text);
    }
    let options = [
        "--case",
        "flat.toml",
        "--free",
        "substrate.young_modulus,contact_point",
        "--quiet",
    ];
    let arguments = several(&["one.csv", "two.csv"], &options);
    let result = bench.json(&[&arguments[..], &["--output", "results"]].concat());
    let modulus = result["parameters"][0]["mean_Pa"].as_f64().unwrap();
    assert!((modulus / 1.7e6 - 1.0).abs() < 1e-3, "{result}");
    assert_eq!(result["method"], "flat");
    let alone = bench.json(&several(&["two.csv"], &options));
    assert_eq!(
        result["curves"][1]["fit"]["parameters"],
        alone["parameters"]
    );
    let saved = bench.files("results");
    assert!(saved.contains(&"fits.svg".to_owned()), "{saved:?}");
    let text = bench.result(&arguments);
    assert!(text.contains("flat surface under a paraboloid"), "{text}");
}

#[test]
fn bad_input_of_several_files_ends_with_status_2() {
    let bench = Bench::new();
    let case = example("fit/case.toml");
    let data = example("fit/spot-1.csv");
    let fit = |files: &[&str], free: &str| {
        let options = ["--case", &case, "--free", free, "--quiet"];
        bench.run(&[&["fit"], files, &options[..]].concat())
    };
    let outcome = fit(&["one.csv", "two.csv"], "substrate.young_modulus");
    assert_eq!(outcome.status, Some(2));
    let lines: Vec<&str> = outcome.stderr.lines().collect();
    assert!(lines.len() == 2, "{lines:?}");
    assert!(lines[0].starts_with("error: one.csv: cannot read: "));
    assert!(lines[1].starts_with("error: two.csv: cannot read: "));
    let outcome = fit(&[&data, &data], "substrate.young_modulus");
    assert_eq!(outcome.status, Some(2));
    let told = "is given twice: give every file once";
    assert!(outcome.stderr.contains(told), "{}", outcome.stderr);
    // An error of the parameters is printed once.
    let other = example("fit/spot-2.csv");
    let outcome = fit(&[&data, &other], "substrate.thickness");
    assert_eq!(outcome.status, Some(2));
    assert_eq!(outcome.stderr.lines().count(), 1, "{}", outcome.stderr);
}

/// The three curves together: one modulus, 1.4 MPa, and the contact points of crates/fakir-inverse/examples/synthetic_curves.rs.
#[test]
#[ignore = "slow: a joint fit of three files"]
fn several_files_are_fitted_together() {
    let bench = Bench::new();
    let case = example("fit/case.toml");
    let files = ["fit/spot-1.csv", "fit/spot-2.csv", "fit/spot-3.csv"].map(example);
    let names = files.each_ref().map(|file| &file[..]);
    let options = [
        "--case",
        &case,
        "--free",
        "substrate.young_modulus,contact_point",
        "--machine-compliance",
        "0.002",
        "--set",
        "method.name=punch",
        "--quiet",
        "--joint",
    ];
    let arguments = several(&names, &options);
    let result = bench.json(&[&arguments[..], &["--output", "results"]].concat());
    assert_eq!(
        result["shared"],
        serde_json::json!(["substrate.young_modulus"])
    );
    let number = |value: &Value| value.as_f64().unwrap();
    let modulus = &result["parameters"][0];
    let ends = &modulus["confidence_interval_95_Pa"];
    assert!(
        number(&ends[0]) < 1.4e6 && 1.4e6 < number(&ends[1]),
        "{modulus}"
    );
    for (curve, point) in [3e-6, 3.4e-6, 2.2e-6].into_iter().enumerate() {
        let fit = &result["curves"][curve]["fit"];
        assert_eq!(fit["parameters"][0]["value_Pa"], modulus["value_Pa"]);
        let ends = &fit["parameters"][1]["confidence_interval_95_m"];
        assert!(
            number(&ends[0]) < point && point < number(&ends[1]),
            "{ends}"
        );
    }
    assert_eq!(result["agreement"]["agree"], true);
    assert_eq!(result["describes_data"], true, "{result}");
    assert!(
        bench
            .read("results/fits.csv")
            .starts_with("file,substrate.young_modulus_Pa,")
    );
    let text = bench.result(&arguments);
    assert!(text.starts_with("3 curves, fitted together\n"), "{text}");
    assert!(
        text.contains("the curves agree on the shared values: joint fit against separate fits, F "),
        "{text}"
    );
    // All files must be readable.
    let outcome = bench.run(&several(&[names[0], "missing.csv"], &options));
    assert_eq!(outcome.status, Some(2), "{}", outcome.stderr);
    assert!(
        outcome
            .stderr
            .starts_with("error: missing.csv: cannot read: ")
    );
    let outcome = bench.run(&[&arguments[..], &["--shared", "force_offset"]].concat());
    assert_eq!(outcome.status, Some(2), "{}", outcome.stderr);
    assert_eq!(
        outcome.stderr,
        "error: force_offset is shared, but not free: make it free too\n"
    );
}

/// Curves at even steps of the displacement with a contact point (um) and normal noise (uN) of the loading and the unloading of a cycle.
fn measured(cycle: &str, contact_point: f64, noise: f64, seed: u64) -> String {
    const ROWS: usize = 50;
    let mut state = seed;
    // Twelve uniform numbers have a variance of one.
    let mut normal = || {
        let uniform = |_| {
            state = state * 48_271 % 2_147_483_647;
            state as f64 / 2_147_483_647.0
        };
        (0..12).map(uniform).sum::<f64>() - 6.0
    };
    let mut text = "branch,displacement_um,force_uN\n".to_owned();
    for branch in ["loading", "unloading"] {
        let of_branch = |line: &str| {
            let mut cells = line.split(',');
            let is_of = cells.next() == Some(branch);
            let mut number = || cells.next()?.parse::<f64>().ok();
            is_of.then(|| Some([number()?, number()?])).flatten()
        };
        let mut points: Vec<[f64; 2]> = cycle.lines().filter_map(of_branch).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let [low, high] = [points[0][0], points[points.len() - 1][0]];
        for row in 0..ROWS {
            let part = (row as f64 + 0.5) / ROWS as f64;
            let part = if branch == "loading" {
                part
            } else {
                1.0 - part
            };
            let at = low + part * (high - low);
            let next = points.partition_point(|point| point[0] < at);
            let [[x, f], [next_x, next_f]] = [points[next - 1], points[next]];
            let force = f + (next_f - f) * (at - x) / (next_x - x);
            let [displacement, force] = [1e6 * at + contact_point, 1e6 * force + noise * normal()];
            text += &format!("{branch},{displacement:.6},{force:.6}\n");
        }
    }
    text
}

/// Two cycles on adhesive pillars and one on a flat sample of the same rubber: modulus and work of adhesion of all of them, 2 MPa and 50 mJ/m^2, and a
/// contact point for each.
#[test]
#[ignore = "slow: a joint fit of adhesive pillars and a flat surface"]
fn pillars_and_a_flat_reference_are_fitted_together() {
    let bench = Bench::new();
    let flat = std::fs::read_to_string(example("flat.toml")).unwrap();
    bench.write(
        "flat.toml",
        &flat.replace("work_receding", "# work_receding"),
    );
    let pillars = example("adhesive.toml");
    let made = [
        ("flat", "flat.toml", "5um", 2.0),
        ("pillars", &pillars, "0.6um", 0.2),
    ];
    let points = [1.0, 0.3, -0.7];
    let mut files = Vec::new();
    for (name, case, to, noise) in made {
        bench.result(&["cycle", case, "--to", to, "--quiet", "--output", name]);
        let cycle = bench.read(&format!("{name}/cycle.csv"));
        for _ in 0..if name == "flat" { 1 } else { 2 } {
            let file = format!("{}.csv", files.len());
            let seed = 1 + files.len() as u64;
            bench.write(&file, &measured(&cycle, points[files.len()], noise, seed));
            files.push(file);
        }
    }
    let names: Vec<&str> = files.iter().map(|file| &file[..]).collect();
    let mut options = vec![
        "--free",
        "substrate.young_modulus,adhesion.work,contact_point",
    ];
    options.extend(["--set", "substrate.young_modulus=2.5MPa"]);
    options.extend(["--set", "adhesion.work=40mJ/m2", "--joint", "--quiet"]);
    let with_cases = |cases: &[&'static str]| {
        let mut arguments: Vec<String> = several(&names, &options)
            .into_iter()
            .map(str::to_owned)
            .collect();
        for case in cases {
            let case = if *case == "flat" {
                "flat.toml"
            } else {
                &pillars
            };
            arguments.extend(["--case".to_owned(), case.to_owned()]);
        }
        arguments
    };
    let arguments = with_cases(&["flat", "pillars", "pillars"]);
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = bench.json(&arguments);
    let shared = ["substrate.young_modulus", "adhesion.work"];
    assert_eq!(result["shared"], serde_json::json!(shared));
    let is_near = |estimate: &Value, suffix: &str, truth: f64| {
        let [value, error] = ["value", "standard_error"]
            .map(|name| estimate[format!("{name}{suffix}")].as_f64().unwrap());
        assert!((value - truth).abs() < 3.0 * error, "{truth}: {estimate}");
        assert!(error < 0.01 * truth.abs(), "{truth}: {estimate}");
    };
    is_near(&result["parameters"][0], "_Pa", 2e6);
    is_near(&result["parameters"][1], "_J_per_m2", 50e-3);
    for (curve, point) in points.into_iter().enumerate() {
        is_near(
            &result["curves"][curve]["fit"]["parameters"][2],
            "_m",
            1e-6 * point,
        );
    }
    assert_eq!(result["agreement"]["agree"], true, "{result}");
    let text = bench.result(&arguments);
    let lines: Vec<&str> = text.lines().collect();
    assert!(
        lines[1].starts_with("1  flat surface under a sphere"),
        "{text}"
    );
    assert!(lines[2].starts_with("2  surface fraction 0.03"), "{text}");
    let arguments = with_cases(&["flat", "pillars"]);
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = bench.run(&arguments);
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome.stderr.contains("2 cases for 3 files"),
        "{}",
        outcome.stderr
    );
}
