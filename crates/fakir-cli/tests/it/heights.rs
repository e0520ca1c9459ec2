//! Rounded pillar tops from the command line: `fakir press` and `fakir design --free heights`.

use crate::common::{Bench, assert_close};

/// Twenty-five rubber asperities under a glass plate, with a reduced modulus of 2 MPa.
const CASE: &str = r#"
[lens]
shape = "plate"
young_modulus = "70 GPa"
poisson_ratio = 0.22

[substrate]
young_modulus = "1.5 MPa"
poisson_ratio = 0.5

[pattern]
lattice = "square"
pitch = "1.5 mm"
columns = 5
top_radius = "526 um"

[pattern.pillar]
height = "200 um"
"#;

/// `E*` of the case, Pa.
fn modulus() -> f64 {
    (0.75 / 1.5e6 + (1.0 - 0.22f64.powi(2)) / 70e9).recip()
}

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench
}

/// A curve of the area (in um^2, as a function of force over reduced modulus in um^2).
fn curve(bench: &Bench, area: impl Fn(f64) -> f64) {
    let rows = [2.4e4, 3.4e4, 4.4e4, 5.4e4]
        .map(|force: f64| format!("{},{}\n", 1e-9 * force * modulus(), area(force)));
    bench.write(
        "curve.csv",
        &format!("force_mN,area_um2\n{}", rows.concat()),
    );
}

/// With --quiet, because wide contacts cause a warning.
const DESIGN: [&str; 7] = [
    "design",
    "case.toml",
    "--quiet",
    "--free",
    "heights",
    "--target",
    "curve.csv",
];

/// Designs, then presses the saved case: it has the target areas.
#[track_caller]
fn designed_and_pressed_again(bench: &Bench, area: impl Fn(f64) -> f64) {
    curve(bench, &area);
    let answer = bench.json(&[&DESIGN[..], &["--output", "found"]].concat());
    let design = &answer["design"];
    assert_eq!(design["status"], "found", "{}", design["statement"]);
    assert_eq!(design["pillars"], 25);
    for (row, force) in [2.4e4, 5.4e4].into_iter().enumerate() {
        let newton = format!("{:e}", 1e-12 * force * modulus());
        let again = bench.json(&["press", "found/case.toml", "--quiet", "--force", &newton]);
        assert_close(&again["contact_area_m2"], 1e-12 * area(force), 2e-5);
        let value = &design["curve"][3 * row]["area_m2"];
        assert_close(
            &again["contact_area_m2"],
            value.as_f64().unwrap_or(0.0),
            1e-9,
        );
    }
}

#[test]
fn a_linear_interface() {
    let bench = bench();
    designed_and_pressed_again(&bench, |force| 10.0 * force);
    assert_eq!(
        bench.files("found"),
        [
            "case.toml",
            "contact-map.png",
            "contact-map.svg",
            "curve.csv",
            "design.png",
            "design.svg",
            "heights.npy",
            "heights.png",
            "pillars.csv",
            "provenance.json",
            "summary.json",
            "surface.stl",
        ]
    );
    let pillars = bench.read("found/pillars.csv");
    assert!(pillars.starts_with("x_m,y_m,height_m\n"), "{pillars}");
    assert_eq!(pillars.lines().count(), 26);
}

#[test]
fn a_bilinear_interface() {
    designed_and_pressed_again(&bench(), |force| {
        8.0 * force + 3.0 * (force - 3.9e4).max(0.0)
    });
}

/// Pillars with a diameter shorten as columns, according to their own heights.
#[test]
fn force_of_the_indentation_with_columns() {
    let bench = bench();
    bench.write(
        "curve.csv",
        "indentation_um,force_mN\n20,12\n40,42\n60,90\n",
    );
    let columns = ["--set", "pattern.pillar.diameter=1mm", "--output", "found"];
    let answer = bench.json(&[&DESIGN[..], &columns].concat());
    assert_eq!(
        answer["design"]["status"], "found",
        "{}",
        answer["design"]["statement"]
    );
    let again = bench.json(&[
        "press",
        "found/case.toml",
        "--quiet",
        "--indentation",
        "40um",
    ]);
    assert_close(&again["force_N"], 42e-3, 2e-5);
}

/// The scatter from derivatives equals that of pillars with height errors.
#[test]
fn the_scatter_by_errors_of_heights() {
    let bench = bench();
    curve(&bench, |force| 10.0 * force);
    let more = ["--height-error", "20nm", "--output", "found"];
    let answer = bench.json(&[&DESIGN[..], &more].concat());
    let row = &answer["design"]["curve"][2];
    let scatter = row["scatter"].as_f64().unwrap_or(0.0);
    let wanted = row["wanted_area_m2"].as_f64().unwrap_or(0.0);
    let force = format!("{:e}", row["force_N"].as_f64().unwrap_or(0.0));
    let pillars = bench.read("found/pillars.csv");
    let case = bench.read("found/case.toml");
    // Every pillar raised by 20 nm in turn: the sum of squares of the effects.
    let mut squares = 0.0;
    for number in 1..=25 {
        let moved: Vec<String> = pillars
            .lines()
            .enumerate()
            .map(|(line, text)| match text.rsplit_once(',') {
                Some((place, height)) if line == number => {
                    let height: f64 = height.parse().unwrap_or(0.0);
                    format!("{place},{:?}\n", height + 20e-9)
                }
                _ => format!("{text}\n"),
            })
            .collect();
        bench.write("pillars.csv", &moved.concat());
        bench.write("moved.toml", &case);
        let area =
            bench.json(&["press", "moved.toml", "--quiet", "--force", &force])["contact_area_m2"]
                .as_f64();
        squares += (area.unwrap_or(0.0) / wanted - 1.0).powi(2);
    }
    assert!(
        (squares.sqrt() / scatter - 1.0).abs() < 0.01,
        "{scatter:e} {:e}",
        squares.sqrt()
    );
    let text = bench.result(&[&DESIGN[..], &["--height-error", "20nm"]].concat());
    assert!(
        text.contains("scatter (%)") && text.contains("error of heights"),
        "{text}"
    );
}

#[test]
fn what_no_heights_have_is_status_3_with_the_nearest() {
    let bench = bench();
    bench.write("curve.csv", "force_mN,area_um2\n48,200000\n60,9e5\n");
    let outcome = bench.run(&DESIGN);
    assert_eq!(outcome.status, Some(3), "{}", outcome.stderr);
    assert!(
        outcome.stderr.contains("curve.csv:3: an area of 9e-7 m^2"),
        "{}",
        outcome.stderr
    );
    assert!(
        outcome.stderr.contains("if all carry the same"),
        "{}",
        outcome.stderr
    );
    // Within the range of single loads, but not together: the search reports the closest result.
    bench.write(
        "curve.csv",
        "indentation_um,force_mN\n10,40\n45,800\n80,2560\n",
    );
    let outcome = bench.run(&DESIGN);
    assert_eq!(outcome.status, Some(3), "{}", outcome.stderr);
    assert!(
        outcome
            .stdout
            .contains("out of reach of these asperities: the nearest found"),
        "{}",
        outcome.stdout
    );
}

/// A contact that leans on the rim of its pillar has an estimated area error above a half.
#[test]
fn a_stated_error_above_a_half_is_no_answer() {
    let bench = bench();
    bench.write("curve.csv", "indentation_um,area_um2\n5,20000\n");
    let leaning = [
        "lens.shape=sphere",
        "lens.radius=5mm",
        "pattern.pitch=300um",
        "pattern.columns=1",
        "pattern.offset=0.5",
        "pattern.top_radius=12mm",
        "pattern.pillar.height=2mm",
        "pattern.pillar.diameter=220um",
        "pattern.pillar.compliance=none",
    ];
    let set = leaning.map(|setting| ["--set", setting]).concat();
    let outcome = bench.run(&[&DESIGN[..], &["--json"], &set[..]].concat());
    assert_eq!(outcome.status, Some(1), "{}", outcome.stderr);
    // Reported even with --quiet.
    assert!(
        outcome
            .stderr
            .contains("warning: the contact area is not resolved"),
        "{}",
        outcome.stderr
    );
    let result: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    let stated = result["design"]["relative_error_estimate"].as_f64();
    assert!(stated.is_some_and(|stated| stated > 0.5), "{stated:?}");
    // Also if this occurs under a load below the largest.
    bench.write(
        "curve.csv",
        "indentation_um,area_um2\n3,10968.279\n5,20049.112\n",
    );
    let outcome = bench.run(&[&DESIGN[..], &set[..]].concat());
    assert_eq!(outcome.status, Some(1), "{}", outcome.stdout);
    let message = "warning: contact at an indentation of 3 um: the contact area is not resolved";
    assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
}

#[test]
fn what_makes_no_sense_is_status_2() {
    let bench = bench();
    curve(&bench, |force| 10.0 * force);
    bench.write("falls.csv", "force_mN,area_um2\n30,200000\n40,190000\n");
    bench.write("word.csv", "force_mN,area_um2\n30,wide\n");
    let design = ["design", "case.toml"];
    let set = ["--set", "pattern.pillar.height=10um"];
    for (arguments, message) in [
        (
            &["--free", "heights", "--target", "falls.csv"][..],
            "falls.csv:3: the target area does not increase",
        ),
        (
            &["--free", "heights", "--target", "word.csv"],
            "word.csv:2: area_um2: \"wide\" is no number",
        ),
        (
            &["--free", "heights", "--target", "none.csv"],
            "none.csv: cannot read",
        ),
        (&["--free", "heights"], "required"),
        (
            &["--free", "heights", "--critical-force", "1mN"],
            "--free heights requires --target",
        ),
        (
            &["--free", "pitch", "--target", "curve.csv"],
            "--target is the curve of --free heights",
        ),
        (&["--target", "curve.csv"], "required"),
        (
            &[
                "--free",
                "heights",
                "--target",
                "curve.csv",
                "--samples",
                "3",
            ],
            "cannot be used with",
        ),
        (
            &[
                "--free",
                "heights",
                "--target",
                "curve.csv",
                "--height-error",
                "0",
            ],
            "greater than 0",
        ),
        (
            &["--free", "pitch", "--critical-force", "1mN"],
            "a cylinder or a plate has no transition",
        ),
        (
            &[&["--free", "heights", "--target", "curve.csv"][..], &set].concat(),
            "below the floor: give pattern.pillar.height",
        ),
    ] {
        let outcome = bench.run(&[&design[..], arguments].concat());
        assert_eq!(outcome.status, Some(2), "{arguments:?} {}", outcome.stderr);
        let flowing = outcome
            .stderr
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ");
        assert!(flowing.contains(message), "{}", outcome.stderr);
    }
}

/// A single asperity under a plate is Hertz's contact: F = 4/3 E* sqrt(R) zeta^(3/2), A = pi R zeta.
#[test]
fn one_rounded_top_is_a_contact_of_hertz() {
    let bench = bench();
    let press = ["press", "case.toml", "--set", "pattern.columns=1"];
    let answer = bench.json(&[&press[..], &["--indentation", "2um"]].concat());
    let force = 4.0 / 3.0 * modulus() * 526e-6f64.sqrt() * 2e-6f64.powf(1.5);
    assert_close(&answer["force_N"], force, 1e-9);
    let area = std::f64::consts::PI * 526e-6 * 2e-6;
    assert_close(&answer["contact_area_m2"], area, 1e-9);
    assert_eq!(answer["tops"], "rounded");
    assert_eq!(answer["floor_out_of_reach"], true);
    assert!(answer["contact_radius_m"].is_null());
    let newton = format!("{force:e}");
    let answer = bench.json(&[&press[..], &["--force", &newton, "--output", "pressed"]].concat());
    assert_close(&answer["indentation_m"], 2e-6, 1e-9);
    assert_eq!(
        bench.files("pressed"),
        [
            "case.toml",
            "contact-map.png",
            "contact-map.svg",
            "fields.nc",
            "fields.vti",
            "pillars.csv",
            "provenance.json",
            "summary.json"
        ]
    );
    let few = ["--force", &newton, "--output", "few", "--field-points", "9"];
    bench.run(&[&press[..], &few].concat());
    let map = std::fs::read(bench.path("few/fields.vti")).unwrap();
    assert!(String::from_utf8_lossy(&map).contains("WholeExtent=\"0 8 0 8 0 0\""));
    let table = bench.read("pressed/pillars.csv");
    assert!(table.starts_with(
        "x_m,y_m,height_m,status,centre_x_m,centre_y_m,contact_radius_m,force_N,gap_m\n"
    ));
    let text = bench.result(&[&press[..], &["--indentation", "2um"]].concat());
    assert!(
        text.contains("left out: adhesion; the floor carries no load"),
        "{text}"
    );
}

/// Under a lens the contact is that of two spheres: curvatures add.
#[test]
fn a_lens_on_a_rounded_top() {
    let bench = bench();
    let press = [
        "press",
        "case.toml",
        "--set",
        "lens.shape=sphere",
        "--set",
        "lens.radius=5mm",
        "--set",
        "pattern.columns=1",
        "--indentation",
        "2um",
    ];
    let answer = bench.json(&press);
    let radius = (1.0f64 / 526e-6 + 1.0 / 5e-3).recip();
    let force = 4.0 / 3.0 * modulus() * radius.sqrt() * 2e-6f64.powf(1.5);
    // The lens is the exact sphere, not its paraboloid.
    assert_close(&answer["force_N"], force, 1e-4);
    assert!(answer["contact_radius_m"].as_f64().is_some());
}

#[test]
fn the_floor_and_wide_contacts_are_reported() {
    let bench = bench();
    let press = [
        "press",
        "case.toml",
        "--set",
        "pattern.columns=1",
        "--indentation",
        "60um",
    ];
    let outcome = bench.run(&[&press[..], &["--set", "pattern.pillar.height=50um"]].concat());
    assert_eq!(outcome.status, Some(0), "{}", outcome.stderr);
    assert!(
        outcome.stderr.contains("the floor may be reached"),
        "{}",
        outcome.stderr
    );
    assert!(
        outcome
            .stderr
            .contains("of the radius of curvature of its top"),
        "{}",
        outcome.stderr
    );
    assert!(
        outcome
            .stdout
            .contains("the load of the floor if it is reached"),
        "{}",
        outcome.stdout
    );
}

/// The loading of a single asperity is Hertz's, F = 4/3 E* sqrt(R) zeta^(3/2), and ends at the given indentation, because there is no
/// critical state.
#[test]
fn a_loading_of_rounded_tops() {
    let bench = bench();
    let approach = ["approach", "case.toml", "--set", "pattern.columns=1"];
    let without_end = bench.run(&approach);
    assert_eq!(without_end.status, Some(2), "{}", without_end.stderr);
    assert!(
        without_end.stderr.contains("give the last indentation"),
        "{}",
        without_end.stderr
    );
    let to = ["--step", "1um", "--to", "3um"];
    let loading = bench.json(&[&approach[..], &to].concat());
    assert!(loading["critical"].is_null());
    let states = loading["states"].as_array().unwrap();
    assert_eq!(states.len(), 4);
    for (depth, state) in states.iter().enumerate().skip(1) {
        let depth = 1e-6 * depth as f64;
        let force = 4.0 / 3.0 * modulus() * 526e-6f64.sqrt() * depth.powf(1.5);
        assert_close(&state["force_N"], force, 1e-9);
        let area = std::f64::consts::PI * 526e-6 * depth;
        assert_close(&state["contact_area_m2"], area, 1e-9);
        assert_eq!(state["floor_out_of_reach"], true);
        assert!(state["beyond_transition"].is_null());
    }
    let saved = bench.run(&[&approach[..], &to, &["--output", "loaded"]].concat());
    assert_eq!(saved.status, Some(0), "{}", saved.stderr);
    assert_eq!(bench.read("loaded/approach.csv").lines().count(), 5);
    assert!(bench.files("loaded").contains(&"approach.svg".to_owned()));
}

/// A sweep of rounded tops agrees with `press`.
#[test]
fn a_sweep_of_rounded_tops() {
    let bench = bench();
    let study = "[study]\nquestion = \"press\"\nindentation = \"2 um\"\n[axes]\n\"pattern.top_radius\" = [\"300 um\", \"526 um\"]";
    let case = CASE
        .replace("top_radius = \"526 um\"\n", "")
        .replace("columns = 5", "columns = 1");
    bench.write("study.toml", &format!("{study}\n{case}"));
    let swept = bench.run(&["sweep", "study.toml", "--output", "swept"]);
    assert_eq!(swept.status, Some(0), "{}", swept.stderr);
    let table = bench.read("swept/table.csv");
    let mut lines = table
        .lines()
        .map(|line| line.split(',').collect::<Vec<&str>>());
    let heading = lines.next().unwrap();
    let place = heading.iter().position(|name| *name == "force_N").unwrap();
    for radius in [300e-6f64, 526e-6] {
        let force = 4.0 / 3.0 * modulus() * radius.sqrt() * 2e-6f64.powf(1.5);
        let found: f64 = lines.next().unwrap()[place].parse().unwrap();
        assert!((found / force - 1.0).abs() < 1e-9);
    }
}

/// Pillars under a lens that reaches the floor between them.
fn low_pillars() -> String {
    CASE.replace("shape = \"plate\"", "radius = \"20 mm\"")
        .replace("pitch = \"1.5 mm\"", "pitch = \"1 mm\"")
        .replace(
            "height = \"200 um\"",
            "height = \"40 um\"\ndiameter = \"0.5 mm\"",
        )
}

/// Expected: the contact under the critical force has the critical indentation and no gap; below it there is a gap, and above it the floor
/// carries load; all front ends give the same numbers.
#[test]
fn the_floor_under_rounded_tops_is_reached_at_the_transition() {
    let bench = Bench::new();
    bench.write("case.toml", &low_pillars());
    let run = |arguments: &[&str]| {
        let output = bench.run(arguments);
        assert_eq!(output.status, Some(0), "{arguments:?}: {}", output.stderr);
        output
    };
    let json = |arguments: &[&str]| -> serde_json::Value {
        serde_json::from_str(&run(arguments).stdout).unwrap()
    };
    let critical = json(&["transition", "case.toml", "--json"]);
    let number = |object: &serde_json::Value, name: &str| object[name].as_f64().unwrap();
    let force = number(&critical, "critical_force_N");
    let indentation = number(&critical, "critical_indentation_m");
    assert_eq!(critical["regime"], "top_first");
    assert!(force > 0.0 && indentation > 40e-6);
    assert!(number(&critical, "smallest_floor_gap_m").abs() <= 0.0);
    assert!(number(&critical["relative_error_estimate"], "force") < 0.05);
    let at = |part: f64| {
        let force = format!("{:e}N", part * force);
        json(&["press", "case.toml", "--force", &force, "--json"])
    };
    assert!((number(&at(1.0), "indentation_m") / indentation - 1.0).abs() < 1e-6);
    let [before, reached, past] = [0.9, 1.0, 1.1].map(at);
    let gaps = [&before, &reached, &past].map(|it| number(it, "smallest_floor_gap_m"));
    assert!(
        gaps[0] > 0.0 && gaps[1].abs() < 1e-5 * gaps[0] && gaps[2].abs() <= 0.0,
        "{gaps:?}"
    );
    assert_eq!(before["floor_out_of_reach"], true);
    assert!(before["floor"].is_null());
    let share = number(&past["floor"], "share");
    assert!(share > 0.0 && share < 0.1, "{share}");
    // An ignored floor carries no load.
    let above = format!("{:e}N", 1.1 * force);
    let ignored = ["--set", "floor.contact=false"];
    let above = run(&[&["press", "case.toml", "--force", &above][..], &ignored].concat());
    assert!(above.stderr.contains("below the floor"), "{}", above.stderr);
    let report = run(&["transition", "case.toml", "--output", "critical"]).stdout;
    assert!(
        report.contains("rests on rounded tops and just reaches the floor"),
        "{report}"
    );
    assert!(bench.read("critical/pillars.csv").lines().count() == 26);
    // The loading ends at the critical state, and contains it where it goes on.
    let loading = json(&["approach", "case.toml", "--step", "10um", "--json"]);
    let last = loading["states"]
        .as_array()
        .unwrap()
        .last()
        .unwrap()
        .clone();
    assert!((number(&last, "force_N") / force - 1.0).abs() < 1e-12);
    let before = json(&[
        "approach",
        "case.toml",
        "--step",
        "10um",
        "--to",
        "20um",
        "--json",
    ]);
    assert!(before["critical"].is_null());
    bench.write(
        "study.toml",
        &format!("[study]\nquestion = \"transition\"\n[axes]\n\"pattern.pillar.height\" = [\"35um\", \"40um\"]\n{}", low_pillars()),
    );
    run(&["sweep", "study.toml", "--output", "swept"]);
    let table = bench.read("swept/table.csv");
    let mut lines = table.lines();
    let place = lines
        .next()
        .unwrap()
        .split(',')
        .position(|name| name == "critical_force_N");
    let swept: Vec<f64> = lines
        .map(|line| {
            line.split(',')
                .nth(place.unwrap())
                .unwrap()
                .parse()
                .unwrap()
        })
        .collect();
    assert!(
        (swept[1] / force - 1.0).abs() < 1e-9 && swept[0] < force,
        "{swept:?}"
    );
}

/// No command silently treats rounded tops as flat.
#[test]
fn every_other_command_refuses_rounded_tops() {
    let bench = bench();
    bench.write(
        "study.toml",
        &format!("[axes]\n\"pattern.pitch\" = [1e-3, 2e-3]\n{CASE}"),
    );
    let floor = bench.run(&["transition", "case.toml"]);
    assert_eq!(floor.status, Some(2), "{}", floor.stderr);
    assert!(
        floor
            .stderr
            .contains("a cylinder or a plate has no transition")
    );
    for (arguments, message) in [
        (&["theory", "case.toml"][..], "those of flat pillar tops"),
        (&["compare", "case.toml"], "only one method computes"),
        (
            &["design", "case.toml", "--samples", "3", "--keep-offset"],
            "has no transition",
        ),
    ] {
        let outcome = bench.run(arguments);
        assert_eq!(outcome.status, Some(2), "{arguments:?} {}", outcome.stderr);
        assert!(
            outcome.stderr.contains(message),
            "{arguments:?} {}",
            outcome.stderr
        );
    }
    let sweep = bench.run(&["sweep", "study.toml"]);
    assert_ne!(sweep.status, Some(0), "{} {}", sweep.stdout, sweep.stderr);
    let option = ["--attraction-range", "5nm"];
    let outcome = bench.run(&[&["press", "case.toml", "--force", "1mN"][..], &option].concat());
    assert_eq!(outcome.status, Some(2), "{option:?}");
    let message = "--attraction-range needs adhesive pillar tops";
    assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
}

/// A film on glass is stiffer than a half-space; results contain its limits and derivatives, and boundary elements agree.
#[test]
fn rounded_tops_on_a_film() {
    let bench = bench();
    let film = ["--set", "substrate.thickness=1mm", "--quiet"];
    let load = ["--force", "20mN"];
    let pressed = |more: &[&str]| bench.json(&[&["press", "case.toml"], &load[..], more].concat());
    let half_space = pressed(&["--quiet"]);
    let on_film = pressed(&[&film[..], &["--gradient"]].concat());
    let indentation = |of: &serde_json::Value| of["indentation_m"].as_f64().unwrap();
    assert!(indentation(&on_film) < 0.95 * indentation(&half_space));
    let limits = on_film["limits"].as_array().unwrap();
    let limit = limits
        .iter()
        .find(|limit| limit["name"] == "indentation_over_thickness");
    let of_thickness = limit.unwrap()["value"].as_f64().unwrap();
    assert!((of_thickness / (indentation(&on_film) / 1e-3) - 1.0).abs() < 1e-9);
    // The exact derivative by the thickness against the difference over a hundredth.
    let by = on_film["gradient"]["indentation_m"]["substrate.thickness"]
        .as_f64()
        .unwrap_or_else(|| panic!("{}", on_film["gradient"]));
    let at = |thickness: &str| indentation(&pressed(&["--set", thickness, "--quiet"]));
    let thicker = at("substrate.thickness=1.005mm");
    let difference = (thicker - at("substrate.thickness=0.995mm")) / 1e-5;
    assert!((by / difference - 1.0).abs() < 1e-3, "{by} {difference}");
    let verified = [&["verify", "case.toml", "--cells", "16"], &load[..], &film].concat();
    let found = bench.json(&verified);
    assert_eq!(found["verdict"], "agree", "{found}");
}

/// Boundary elements on every top find the same contacts, with adhesion on one grid.
#[test]
fn rounded_tops_are_verified_with_boundary_elements() {
    let bench = bench();
    let load = ["--quiet", "--force", "20mN", "--cells", "16"];
    let found = bench.json(&[&["verify", "case.toml"], &load[..]].concat());
    assert_eq!(found["verdict"], "agree", "{found}");
    let answers = found["answers"].as_array().unwrap();
    let methods: Vec<&serde_json::Value> = answers.iter().map(|row| &row["method"]).collect();
    assert_eq!(methods, ["discs", "love", "love"]);
    assert_eq!(answers[2]["cells_per_diameter"], 16);
    assert_eq!(answers[2]["pillars_in_contact"], 25);
    // The discs are those of `press` with the accurate setting.
    let accurate = [
        "--set",
        "method.accuracy=accurate",
        "--quiet",
        "--force",
        "20mN",
    ];
    let pressed = bench.json(&[&["press", "case.toml"], &accurate[..]].concat());
    assert_eq!(answers[0]["indentation_m"], pressed["indentation_m"]);
    let [discs, elements] = [0, 2].map(|row| answers[row]["indentation_m"].as_f64().unwrap());
    assert!((elements / discs - 1.0).abs() < 3e-3 && elements.to_bits() != discs.to_bits());
    let area = found["relative_difference"]["contact_area"]
        .as_f64()
        .unwrap();
    assert!(
        area != 0.0
            && area.abs()
                < found["allowed_difference"]["contact_area"]
                    .as_f64()
                    .unwrap()
    );
    let text = bench.run(&[&["verify", "case.toml", "--output", "verified"], &load[..]].concat());
    assert!(
        text.stdout.contains("elements, 16 cells"),
        "{}",
        text.stdout
    );
    assert!(
        text.stdout.contains("Difference in the contact area"),
        "{}",
        text.stdout
    );
    assert!(
        bench
            .read("verified/verify.csv")
            .contains("pillars_in_contact")
    );
    let one = [
        "verify",
        "case.toml",
        "--indentation",
        "1um",
        "--set",
        "pattern.columns=1",
        "--set",
        "adhesion.work=50mJ/m2",
        // The force is a small difference, in tension: on 32 cells an eighth of the work of adhesion is half of it, and nothing is concluded.
        "--cells",
        "64",
    ];
    let found = bench.json(&one);
    assert_eq!(found["verdict"], "agree", "{found}");
    let untold = bench.run(&["verify", "case.toml"]);
    assert_eq!(untold.status, Some(2), "{}", untold.stderr);
    assert!(untold.stderr.contains("--force"), "{}", untold.stderr);
}

/// As on flat tops: the edges of a viscoelastic contact dissipate.
#[test]
fn a_history_of_adhesive_tops_is_refused() {
    let bench = bench();
    let relaxation = [
        "--set",
        "relaxation.strengths=[0.5]",
        "--set",
        "relaxation.times=[1]",
    ];
    let hold = ["hold", "case.toml", "--force", "20mN", "--for", "1s"];
    let adhesive = ["--set", "adhesion.work=50mJ/m2"];
    let refused = bench.run(&[&hold[..], &relaxation, &adhesive].concat());
    assert_eq!(refused.status, Some(2), "{}", refused.stderr);
    assert!(refused.stderr.contains("dissipate"), "{}", refused.stderr);
}

/// A modulus from data of `approach`.
#[test]
fn a_modulus_is_fitted_to_rounded_tops() {
    let bench = bench();
    let loading = [
        "approach",
        "case.toml",
        "--quiet",
        "--to",
        "4um",
        "--step",
        "0.2um",
    ];
    bench.run(&[&loading[..], &["--output", "loading"]].concat());
    let set = ["--set", "substrate.young_modulus=1MPa"];
    let fit = [
        "fit",
        "loading/approach.csv",
        "--case",
        "case.toml",
        "--free",
        "substrate.young_modulus",
    ];
    let found = bench.json(&[&fit[..], &set].concat());
    assert_eq!(found["method"], "rounded tops");
    assert_close(&found["parameters"][0]["value_Pa"], 1.5e6, 1e-3);
}

/// The case of a design has the target critical force, samples are saved, and derivatives are those of differences.
#[test]
fn rounded_tops_are_designed_sampled_and_differentiated() {
    let bench = bench();
    bench.write("low.toml", &low_pillars().replace("40 um", "20 um"));
    let before = bench.json(&["transition", "low.toml"]);
    let target = 1.03 * before["critical_force_N"].as_f64().unwrap();
    let target_text = format!("{target:e}N");
    let question = ["--free", "top_radius", "--critical-force", &target_text];
    let samples = ["--samples", "3", "--tolerance", "pattern.pillar.height=1%"];
    let rest = ["--keep-offset", "--output", "found"];
    let arguments = [&["design", "low.toml"], &question[..], &samples, &rest].concat();
    let answer = bench.json(&arguments);
    assert_eq!(answer["tops"], "rounded");
    let design = &answer["design"];
    assert_eq!(design["status"], "found", "{answer}");
    assert!(answer["spread"]["critical_force_N"]["mean"].is_number());
    let header = bench.read("found/samples.csv");
    assert!(
        header.starts_with("sample,pattern.pillar.height_m"),
        "{header}"
    );
    let force_at = |set: &str| {
        let arguments = ["transition", "found/case.toml", "--gradient", "--set", set];
        let found = bench.json(&arguments);
        let force = found["critical_force_N"].as_f64().unwrap();
        (force, found["gradient"].clone())
    };
    let radius = design["value_m"].as_f64().unwrap();
    let set = |factor: f64| format!("pattern.top_radius={:e}", factor * radius);
    let (force, gradient) = force_at(&set(1.0));
    assert!((force / target - 1.0).abs() < 1e-8, "{force:e}");
    let [(above, _), (below, _)] = [1.0 + 1e-5, 1.0 - 1e-5].map(|factor| force_at(&set(factor)));
    let expected = (above - below) / (2e-5 * radius);
    let slope = gradient["force_N"]["pattern.top_radius"].as_f64().unwrap();
    assert!(
        (slope / expected - 1.0).abs() < 1e-4,
        "{slope:e} {expected:e}"
    );
    assert!(!gradient["pillars"].as_array().unwrap().is_empty());
    let text = bench.result(&["transition", "found/case.toml", "--gradient"]);
    assert!(
        text.contains("Derivatives") && text.contains("pattern.top_radius"),
        "{text}"
    );
    // Loading up to the critical state.
    let work = ["--set", "adhesion.work=5mJ/m2"];
    let cycle = bench.json(&[&["cycle", "found/case.toml"], &work[..]].concat());
    let critical = bench.json(&[&["transition", "found/case.toml"], &work[..]].concat());
    let ends = [
        &cycle["turn_indentation_m"],
        &critical["critical_indentation_m"],
    ];
    let [turn, critical] = ends.map(|value| value.as_f64().unwrap_or(f64::NAN));
    assert!(
        (turn / critical - 1.0).abs() < 1e-9,
        "{turn:e} {critical:e}"
    );
}
