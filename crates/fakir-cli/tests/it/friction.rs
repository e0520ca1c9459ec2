//! Friction with the real program: the lateral force of every kind of result, refused keys, and the fit.

use crate::common::{Bench, example};
use serde_json::Value;
use std::f64::consts::PI;

/// Shear stresses on tops and floor, Pa.
const TOPS: f64 = 0.4e6;
const FLOOR: f64 = 0.15e6;

const BOTH: [&str; 4] = [
    "--set",
    "friction.shear_stress_tops=0.4MPa",
    "--set",
    "friction.shear_stress_floor=0.15MPa",
];

/// A sphere on a flat half-space.
const FLAT: &str = "[lens]\nshape = \"paraboloid\"\nradius = \"2 mm\"\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n\
                    [substrate]\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n";

/// The intermediate substrate of the paper at a surface fraction of 0.01, whose critical force is 92 uN.
fn sparse(bench: &Bench) -> String {
    let text = std::fs::read_to_string(example("paper-intermediate.toml")).unwrap();
    let changed = text.replace("surface_fraction = 0.1", "surface_fraction = 0.01");
    assert_ne!(changed, text);
    bench.write("sparse.toml", &changed);
    "sparse.toml".to_owned()
}

fn number(value: &Value, name: &str) -> f64 {
    let found = value[name].as_f64();
    found.unwrap_or_else(|| panic!("no number {name} in {value}"))
}

/// Checks that the force is the sum of its parts, these are stresses times areas, and the error is that of the areas.
fn check_sums(friction: &Value) {
    let [tops, floor] = ["tops", "floor"].map(|part| {
        let area = number(friction, &format!("{part}_contact_area_m2"));
        (area, number(friction, &format!("{part}_force_N")))
    });
    assert!((tops.1 / (TOPS * tops.0) - 1.0).abs() < 1e-14);
    assert!((floor.1 - FLOOR * floor.0).abs() <= 1e-14 * floor.1);
    let whole = number(friction, "lateral_force_N");
    assert!((whole / (tops.1 + floor.1) - 1.0).abs() < 1e-14);
    let errors = &friction["relative_error_estimate"];
    let [of_tops, of_floor] =
        ["tops_contact_area", "floor_contact_area"].map(|name| number(errors, name));
    let expected = (of_tops * tops.1 + of_floor * floor.1) / whole;
    let found = number(errors, "lateral_force");
    assert!((found - expected).abs() < 1e-12, "{found} {expected}");
}

/// Hertz: `a^2 = (3 F R/(4 E*))^(2/3)`, with E* = 4/3 MPa.
#[test]
fn a_flat_surface_slides_with_the_stress_on_tops_times_the_area_of_hertz() {
    let bench = Bench::new();
    bench.write("flat.toml", FLAT);
    let arguments = [
        "press",
        "flat.toml",
        "--force",
        "1mN",
        "--set",
        "shear_stress_tops=0.4MPa",
    ];
    let contact = bench.json(&arguments);
    let area = PI * (0.75_f64 * 1e-3 * 2e-3 / (4e6 / 3.0)).powf(2.0 / 3.0);
    let friction = &contact["friction"];
    assert!((number(friction, "lateral_force_N") / (TOPS * area) - 1.0).abs() < 1e-9);
    assert!(friction["floor_contact_area_m2"].is_null());
    // A flat punch: its own area.
    let punch = [
        "press",
        "flat.toml",
        "--force",
        "1mN",
        "--set",
        "lens.shape=punch",
        "--set",
        "lens.radius=50um",
        "--set",
        "shear_stress_tops=0.4MPa",
    ];
    let contact = bench.json(&punch);
    let force = number(&contact["friction"], "lateral_force_N");
    assert!((force / (TOPS * PI * 50e-6_f64.powi(2)) - 1.0).abs() < 1e-12);
}

#[test]
fn every_result_of_pillars_has_the_lateral_force() {
    let bench = Bench::new();
    let case = sparse(&bench);
    let critical = bench.json(&[&["transition", &case][..], &BOTH].concat());
    check_sums(&critical["friction"]);
    let on_floor = number(&critical["friction"], "floor_contact_area_m2");
    assert_eq!(on_floor.to_bits(), 0);
    // Between the areas of the pillars that are fully in contact and of all.
    let [count, partial] = ["pillars_in_contact", "pillars_partially_in_contact"]
        .map(|name| critical[name].as_u64().unwrap() as f64);
    let top = PI * 3e-6_f64.powi(2);
    let area = number(&critical["friction"], "tops_contact_area_m2");
    assert!(area > (count - partial) * top && area < count * top);
    // Twice the critical force: the floor takes part.
    let force = format!("{:e}", 2.0 * number(&critical, "critical_force_N"));
    let press = bench.json(&[&["press", &case, "--force", &force][..], &BOTH].concat());
    check_sums(&press["friction"]);
    let floor = number(&press["floor"], "contact_area_m2");
    let on_floor = number(&press["friction"], "floor_contact_area_m2");
    assert_eq!(on_floor.to_bits(), floor.to_bits());
    assert!(floor > 0.0 && number(&press["friction"], "floor_share") > 0.0);
    // Methods without the floor have no lateral force past the transition.
    let ignored = ["--set", "floor.contact=false"];
    let arguments = [
        &["press", &case, "--force", &force, "--json"][..],
        &BOTH,
        &ignored,
    ]
    .concat();
    let without: Value = serde_json::from_str(&bench.run(&arguments).stdout).unwrap();
    assert!(without["friction"]["lateral_force_N"].is_null());
    assert!(number(&without["friction"], "tops_force_N") > 0.0);
    // The text and the columns of a loading.
    let text = bench.result(&[&["press", &case, "--force", &force][..], &BOTH].concat());
    assert!(
        text.contains("lateral force") && text.contains("% on the floor"),
        "{text}"
    );
    let saved = ["approach", &case, "--step", "1um", "--output", "loading"];
    bench.result(&[&saved[..], &BOTH].concat());
    let table = bench.read("loading/approach.csv");
    assert!(
        table
            .lines()
            .next()
            .unwrap()
            .contains("friction_lateral_force_N")
    );
    let cited = bench.result(&["cite", "loading"]);
    assert!(cited.contains("Sliding friction at soft"));
    // The saved case has the keys.
    assert!(
        bench
            .read("loading/case.toml")
            .contains("shear_stress_floor = \"150 kPa\"")
    );
}

/// Without shear stresses results are as before.
#[test]
fn without_shear_stresses_nothing_is_added() {
    let bench = Bench::new();
    let case = sparse(&bench);
    let critical = bench.json(&["transition", &case]);
    assert!(critical.get("friction").is_none());
    bench.result(&["approach", &case, "--step", "1um", "--output", "loading"]);
    assert!(!bench.read("loading/approach.csv").contains("friction"));
    assert!(!bench.read("loading/case.toml").contains("friction"));
}

/// Lengths times 10 at the same moduli: forces and areas times 100.
#[test]
fn the_lateral_force_scales_with_the_area() {
    let bench = Bench::new();
    let case = sparse(&bench);
    let large = [
        "transition",
        &case,
        "--set",
        "lens.radius=22mm",
        "--set",
        "pattern.pillar.diameter=60um",
        "--set",
        "pattern.pillar.height=22um",
    ];
    let small = bench.json(&[&["transition", &case][..], &BOTH].concat());
    let large = bench.json(&[&large[..], &BOTH].concat());
    let [small, large] = [small, large].map(|it| number(&it["friction"], "lateral_force_N"));
    assert!(
        (large / (100.0 * small) - 1.0).abs() < 1e-6,
        "{small:e} {large:e}"
    );
}

/// The homogenised lattice, the punch lattice, elements and the spectral method agree within the sum of their errors.
#[test]
fn methods_agree_within_their_errors() {
    let bench = Bench::new();
    let case = sparse(&bench);
    let of = |method: &str| {
        let name = format!("method.name={method}");
        let arguments = ["press", &case, "--force", "50uN", "--set", &name];
        let contact = bench.json(&[&arguments[..], &BOTH].concat());
        let friction = &contact["friction"];
        let force = number(friction, "lateral_force_N");
        let error = number(&friction["relative_error_estimate"], "lateral_force");
        (force, error * force)
    };
    let (force, error) = of("spectral");
    assert!(error < 0.2 * force, "{error:e} {force:e}");
    for method in ["punch", "homogenised", "love"] {
        let (other, of_other) = of(method);
        assert!(
            (other - force).abs() <= error + of_other + 1e-12 * force,
            "{method}: {other:e} {force:e} {error:e} {of_other:e}"
        );
    }
}

#[test]
fn other_surfaces_have_one_stress_or_both() {
    let bench = Bench::new();
    let asperities = example("asperities.toml");
    let tops = ["--set", "friction.shear_stress_tops=0.4MPa"];
    let contact = bench.json(&[&["press", &asperities, "--force", "1mN"][..], &tops].concat());
    let area = number(&contact, "contact_area_m2");
    let force = number(&contact["friction"], "lateral_force_N");
    assert!((force / (TOPS * area) - 1.0).abs() < 1e-14);
    let refused = bench.run(&[&["press", &asperities, "--force", "1mN"][..], &BOTH].concat());
    assert_eq!(refused.status, Some(2));
    assert!(
        refused
            .stderr
            .contains("floor contact is not computed under rounded"),
        "{}",
        refused.stderr
    );
    bench.write("flat.toml", FLAT);
    let refused = bench.run(&[&["press", "flat.toml", "--force", "1mN"][..], &BOTH].concat());
    assert_eq!(refused.status, Some(2));
    assert!(
        refused.stderr.contains("friction.shear_stress_floor"),
        "{}",
        refused.stderr
    );
    // Square pillars on a grid: both areas, as far as the load reaches.
    let surface = example("square-pillars.toml");
    let wide = ["--set", "surface.grid.width=250um"];
    let press = ["press", &surface, "--force", "1mN"];
    let contact = bench.json(&[&press[..], &BOTH, &wide].concat());
    let friction = &contact["friction"];
    let expected = TOPS * number(&contact["tops"], "contact_area_m2")
        + FLOOR * number(&contact["floor"], "contact_area_m2");
    assert!((number(friction, "lateral_force_N") / expected - 1.0).abs() < 1e-14);
}

/// The lateral forces of the program itself, before and past the transition of rounded tops, give the stresses again.
#[test]
#[ignore = "slow: a fit of friction with the floor"]
fn stresses_on_rounded_tops_and_the_floor_are_found_again() {
    let bench = Bench::new();
    let mut case = vec![example("paper-intermediate.toml")];
    for set in [
        "pattern.columns=3",
        "pattern.pitch=30um",
        "pattern.top_radius=20um",
    ] {
        case.extend(["--set".to_owned(), set.to_owned()]);
    }
    let with = |command: &str, more: &[&str]| {
        let mut line: Vec<String> = vec![command.to_owned()];
        line.extend(case.iter().cloned());
        line.extend(more.iter().map(|word| (*word).to_owned()));
        line
    };
    let mut table = "indentation_m,lateral_force_N\n".to_owned();
    for indentation in ["1.5um", "3um", "4um", "5um"] {
        let line = with(
            "press",
            &[&["--indentation", indentation][..], &BOTH].concat(),
        );
        let contact = bench.json(&line.iter().map(String::as_str).collect::<Vec<_>>());
        let lateral = number(&contact["friction"], "lateral_force_N");
        table += &format!("{:e},{lateral:e}\n", number(&contact, "indentation_m"));
    }
    bench.write("lateral.csv", &table);
    let line = with("friction", &["lateral.csv", "--lateral-error", "1nN"]);
    let fit = bench.json(&line.iter().map(String::as_str).collect::<Vec<_>>());
    let stresses = fit["shear_stresses"].as_array().expect("two stresses");
    for (stress, expected) in stresses.iter().zip([TOPS, FLOOR]) {
        let found = number(stress, "value_Pa");
        assert!((found / expected - 1.0).abs() < 1e-6, "{found}");
    }
    assert_eq!(stresses.len(), 2);
}

#[test]
fn stresses_that_are_no_stresses_are_refused_with_their_place() {
    let bench = Bench::new();
    for (stress, shown) in [("\"-1 kPa\"", "-1 kPa"), ("nan", "NaN"), ("inf", "inf")] {
        let text = format!("{FLAT}\n[friction]\nshear_stress_tops = {stress}\n");
        bench.write("case.toml", &text);
        let outcome = bench.run(&["press", "case.toml", "--force", "1mN"]);
        assert_eq!(outcome.status, Some(2), "{}", outcome.stderr);
        let message = &outcome.stderr;
        assert!(message.contains("friction.shear_stress_tops"), "{message}");
        assert!(message.contains("case.toml:11"), "{message}");
        assert!(
            message.contains(shown) && message.contains("at least 0"),
            "{message}"
        );
    }
    bench.write(
        "case.toml",
        &format!("{FLAT}\n[friction]\nshear_stress_top = 1e5\n"),
    );
    let outcome = bench.run(&["press", "case.toml", "--force", "1mN"]);
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome.stderr.contains("shear_stress_tops"),
        "{}",
        outcome.stderr
    );
}

/// Other questions print that they do not use the keys.
#[test]
fn answers_without_a_lateral_force_warn() {
    let bench = Bench::new();
    let case = sparse(&bench);
    for arguments in [
        vec!["theory", &case],
        vec![
            "design",
            &case,
            "--free",
            "pitch",
            "--critical-force",
            "100uN",
        ],
    ] {
        let outcome = bench.run(&[&arguments[..], &BOTH].concat());
        let summary = bench.run(&[&arguments[..], &BOTH, &["--json"]].concat());
        assert!(
            summary
                .stdout
                .contains("friction.shear_stress_tops has no effect"),
            "{}{}",
            outcome.stderr,
            summary.stdout
        );
    }
}

#[test]
fn a_sweep_over_shear_stresses() {
    let bench = Bench::new();
    let case = sparse(&bench);
    let text = bench.read(&case);
    let study = format!("[axes]\n\"friction.shear_stress_tops\" = [0, 1e5, 2e5]\n{text}");
    bench.write("study.toml", &study);
    bench.result(&["sweep", "study.toml", "--output", "sweep", "--quiet"]);
    let table = bench.read("sweep/table.csv");
    let mut lines = table.lines();
    let place = lines
        .next()
        .unwrap()
        .split(',')
        .position(|name| name == "friction_lateral_force_N")
        .unwrap();
    let forces: Vec<f64> = lines
        .map(|line| line.split(',').nth(place).unwrap().parse().unwrap())
        .collect();
    assert_eq!(forces[0].to_bits(), 0);
    assert!((forces[2] / forces[1] - 2.0).abs() < 1e-12, "{forces:?}");
}

/// Lateral forces of known stresses, with a pattern of deviations in place of noise.
fn data(bench: &Bench, case: &str, forces: &[f64], deviation: f64) -> String {
    let mut text =
        String::from("normal force [uN],friction force [uN],friction force error [uN]\n");
    for (k, force) in forces.iter().enumerate() {
        let load = format!("{force}uN");
        let arguments = ["press", case, "--force", &load];
        let contact = bench.json(&[&arguments[..], &BOTH].concat());
        let lateral = 1e6 * number(&contact["friction"], "lateral_force_N");
        let sign = [1.0, -1.0, -1.0, 1.0][k % 4];
        text += &format!("{force},{},{deviation}\n", lateral + sign * deviation);
    }
    text
}

#[test]
fn a_fit_finds_both_stresses_and_states_what_is_not_determined() {
    let bench = Bench::new();
    let case = sparse(&bench);
    bench.write(
        "lateral.csv",
        &data(
            &bench,
            &case,
            &[10.0, 30.0, 60.0, 90.0, 150.0, 200.0, 300.0, 400.0],
            1.0,
        ),
    );
    let fit = bench.json(&["friction", &case, "lateral.csv"]);
    let stresses = fit["shear_stresses"].as_array().unwrap();
    for (stress, expected) in stresses.iter().zip([TOPS, FLOOR]) {
        let [low, high] = [0, 1].map(|end| stress["interval_Pa"][end].as_f64().unwrap());
        assert!(low < expected && expected < high, "{stress}");
        assert!((high - low) < 0.2 * expected, "{stress}");
    }
    assert_eq!(fit["determined"], true);
    assert!(fit["correlation"].as_f64().unwrap() < 0.0);
    // Files of the result.
    let folder = [
        "friction",
        &case,
        "lateral.csv",
        "--output",
        "fitted",
        "--quiet",
    ];
    let text = bench.result(&folder);
    assert!(
        text.contains("friction.shear_stress_floor") && text.contains("95 % interval"),
        "{text}"
    );
    let files = bench.files("fitted");
    for name in [
        "fitted.csv",
        "lateral-force.svg",
        "lateral-force.png",
        "case.toml",
        "summary.json",
    ] {
        assert!(files.iter().any(|file| file == name), "{name} of {files:?}");
    }
    assert!(bench.read("fitted/case.toml").contains("[friction]"));
    // Before the transition alone the floor is not determined.
    bench.write(
        "tops.csv",
        &data(&bench, &case, &[5.0, 10.0, 15.0, 20.0], 0.01),
    );
    let outcome = bench.run(&["friction", &case, "tops.csv", "--json"]);
    let fit: Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(fit["determined"], false);
    assert!(fit["shear_stresses"][1]["interval_Pa"].is_null());
    assert!((number(&fit["shear_stresses"][0], "value_Pa") / TOPS - 1.0).abs() < 0.01);
    assert!(
        outcome.stderr.contains("no row is past the transition"),
        "{}",
        outcome.stderr
    );
}

#[test]
fn tables_without_the_columns_are_refused() {
    let bench = Bench::new();
    let case = sparse(&bench);
    bench.write("a.csv", "force_uN,contact_radius_um\n1,2\n");
    let outcome = bench.run(&["friction", &case, "a.csv"]);
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome.stderr.contains("lateral_force_N"),
        "{}",
        outcome.stderr
    );
    bench.write("b.csv", "force_uN,lateral_force_uN\n-1,2\n");
    let outcome = bench.run(&["friction", &case, "b.csv"]);
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome.stderr.contains("b.csv:2: force_N"),
        "{}",
        outcome.stderr
    );
}
