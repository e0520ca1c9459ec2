//! Behaviour of the program: exit status, files, signals, pipes.

use crate::common::{Bench, Outcome, example};
use fakir_study::TABLES;
use std::io::Write;
use std::process::Stdio;

fn intermediate() -> String {
    example("paper-intermediate.toml")
}

#[test]
fn init_writes_a_case_that_works_and_overwrites_nothing() {
    let bench = Bench::new();
    let outcome = bench.run(&["init"]);
    assert_eq!(outcome.status, Some(0));
    assert_eq!(outcome.stdout, "");
    assert!(outcome.stderr.contains("fakir transition case.toml"));
    let written = bench.read("case.toml");
    assert_eq!(bench.result(&["init", "-"]), written);
    bench.result(&["theory", "case.toml"]);

    bench.write("case.toml", "mine");
    let outcome = bench.run(&["init", "case.toml"]);
    assert_eq!(outcome.status, Some(2));
    assert!(outcome.stderr.contains("--force"));
    assert_eq!(bench.read("case.toml"), "mine");
    assert_eq!(bench.run(&["init", "--force"]).status, Some(0));
    assert_eq!(bench.read("case.toml"), written);
    assert_eq!(bench.files("."), ["case.toml"]);
}

#[test]
fn init_prints_a_reference_of_all_keys() {
    let bench = Bench::new();
    let reference = bench.result(&["init", "--keys"]);
    assert_eq!(reference, fakir_case::reference());
    assert!(reference.contains("\n## [surface.pillar]\n"));
    assert!(bench.files(".").is_empty());
    for arguments in [
        ["init", "--keys", "case.toml"],
        ["init", "--keys", "--force"],
    ] {
        assert_eq!(bench.run(&arguments).status, Some(2));
    }
}

/// Validators in Python compare it with examples and malformed files: `tests/python/test_schema.py`.
#[test]
fn init_prints_a_schema_for_editors() {
    let bench = Bench::new();
    let printed = bench.result(&["init", "--schema"]);
    let schema: serde_json::Value = serde_json::from_str(&printed).expect("JSON");
    assert_eq!(schema, fakir_case::schema());
    let radius = &schema["definitions"]["lens.radius"];
    assert_eq!(radius["exclusiveMinimum"], 0.0);
    assert!(bench.files(".").is_empty());
    for other in ["--keys", "--force", "case.toml"] {
        assert_eq!(bench.run(&["init", "--schema", other]).status, Some(2));
    }
}

#[test]
fn bad_input_is_status_2_with_an_explanation_and_no_files() {
    let bench = Bench::new();
    let case = intermediate();
    bench.write("broken.toml", "[lens]\nradius = 2200 um\n");
    let surface = example("square-pillars.toml");
    bench.write("file", "");
    for (path, explanation) in [
        ("file/x", "file is a file, not a folder"),
        ("missing/x", "there is no folder missing; make it first"),
    ] {
        let outcome = bench.run(&["init", path]);
        assert_eq!(outcome.status, Some(2), "{path}");
        assert!(outcome.stderr.contains(explanation), "{}", outcome.stderr);
        assert!(!outcome.stderr.contains("os error"), "{}", outcome.stderr);
    }
    let attempts: [(&[&str], &str); 19] = [
        (&["transition", "broken.toml"], "broken.toml:2:10"),
        (&["transition", "missing.toml"], "cannot read missing.toml"),
        (
            &["transition", &case, "--set", "pattern.pich=1um"],
            "did you mean pattern.pitch?",
        ),
        (
            &["transition", &case, "--set", "lens.radius=2MPa"],
            "--set:1:13",
        ),
        (&["transition", &case, "--threads", "many"], "invalid value"),
        (&["transition", &case, "--memory-limit", "8"], "such as 8GB"),
        (
            &["transition", &case, "--output", "file"],
            "file is a file, not a folder",
        ),
        (
            &["transition", &case, "--output", "file/results"],
            "file is a file, not a folder",
        ),
        (&["transition", &case, "--field-points", "1"], "2 to 2048"),
        (
            &["transition", &surface, "--field-points", "9"],
            "on its own cells",
        ),
        (&["transition"], "<CASE>"),
        (&["press", &case], "--indentation"),
        (
            &["press", &case, "--force", "1uN", "--indentation", "1um"],
            "cannot be used with",
        ),
        (
            &["press", &case, "--force", "1um"],
            "um is a unit of length, not of force",
        ),
        (
            &["press", &case, "--force", "-1uN"],
            "invalid force -1 uN: must be 0 or greater",
        ),
        (
            &["press", &case, "--indentation", "nan"],
            "invalid indentation",
        ),
        (&["approach", &case, "--step", "0um"], "--step must be"),
        (&["approach", &case, "--step", "1nm"], "states"),
        (&["approach", &case, "--past-transition"], "--until"),
    ];
    for (arguments, explanation) in attempts {
        let arguments = match arguments.contains(&"--output") {
            true => arguments.to_vec(),
            false => [arguments, &["--output", "results"]].concat(),
        };
        let outcome = bench.run(&arguments);
        assert_eq!(outcome.status, Some(2), "{arguments:?}: {}", outcome.stderr);
        assert_eq!(outcome.stdout, "", "{arguments:?}");
        assert!(
            outcome.stderr.contains(explanation),
            "{arguments:?}: {}",
            outcome.stderr
        );
    }
    assert_eq!(bench.files("."), ["broken.toml", "file"]);
}

#[test]
fn what_the_physics_refuses_is_status_3() {
    let bench = Bench::new();
    let case = intermediate();
    let attempts: [(&[&str], &str); 3] = [
        (&["press", &case, "--force", "10N"], "half the lens radius"),
        (&["transition", &case, "--memory-limit", "100kB"], "memory"),
        (
            &[
                "transition",
                &case,
                "--set",
                "method.name=homogenised",
                "--set",
                "pattern.surface_fraction=0.9",
            ],
            "homogenised lattice needs a surface fraction below",
        ),
    ];
    for (arguments, explanation) in attempts {
        let outcome = bench.run(&[arguments, &["--output", "results"]].concat());
        assert_eq!(outcome.status, Some(3), "{arguments:?}: {}", outcome.stderr);
        assert_eq!(outcome.stdout, "");
        assert!(outcome.stderr.contains(explanation), "{}", outcome.stderr);
    }
    assert!(bench.files(".").is_empty());
}

/// 2048 points squared take 537 MB, 128 bytes each; checked before the computation.
#[test]
#[ignore = "slow: fields of many points"]
fn fields_count_against_the_memory_limit() {
    let bench = Bench::new();
    let run = |points: &str| {
        let limit = ["--memory-limit", "100MB", "--output", "results"];
        let fields = ["transition", &intermediate(), "--field-points", points];
        bench.run(&[&fields[..], &limit[..]].concat())
    };
    let outcome = run("2048");
    assert_eq!(outcome.status, Some(3), "{}", outcome.stderr);
    assert!(
        outcome.stderr.contains(
            "fields at 4194304 points take 536.9 MB of memory; the limit is 100.0 MB: raise the limit, \
             or request at most 781250 points, such as 883 by 883"
        ),
        "{}",
        outcome.stderr
    );
    assert!(bench.files(".").is_empty());
    assert_eq!(run("883").status, Some(0));
}

#[test]
fn more_threads_than_processors_are_warned_of() {
    let bench = Bench::new();
    let processors = std::thread::available_parallelism().unwrap();
    let message =
        format!("warning: 9999 threads exceed the number of processors: {processors} are used\n");
    bench.write(
        "study.toml",
        &format!(
            "[study]\ncase = \"{}\"\n[axes]\npitch = [40e-6]\n",
            intermediate()
        ),
    );
    for arguments in [
        &["transition", &intermediate()][..],
        &["sweep", "study.toml"],
    ] {
        let outcome = bench.run(&[arguments, &["--threads", "9999"]].concat());
        assert_eq!(
            (outcome.status, &outcome.stderr),
            (Some(0), &message),
            "{arguments:?}"
        );
    }
    bench.result(&[
        "transition",
        &intermediate(),
        "--threads",
        "9999",
        "--quiet",
    ]);
}

/// A device without an end in place of every file that is read.
#[cfg(target_os = "linux")]
#[test]
fn what_has_no_end_is_not_read_for_ever() {
    let bench = Bench::new();
    let device = "/dev/zero";
    bench.write(
        "study.toml",
        &format!("[study]\ncase = \"{device}\"\n[axes]\npitch = [40e-6]\n"),
    );
    let case = intermediate();
    let attempts: [(&[&str], &str); 6] = [
        (&["transition", device], "it has more than 4 MB"),
        (&["sweep", device], "it has more than 16 MB"),
        (&["cite", device], "it has more than 4 MB"),
        (
            &["fit", device, "--case", &case, "--free", "contact_point"],
            "it has more than 16 MB",
        ),
        (
            &["reproduce", "paper", "--output", "x", "--measured", device],
            "it has more than 16 MB",
        ),
        (&["sweep", "study.toml"], "there is no file /dev/zero"),
    ];
    for (arguments, explanation) in attempts {
        let outcome = bench.run(arguments);
        assert_eq!(outcome.status, Some(2), "{arguments:?}: {}", outcome.stderr);
        assert!(outcome.stderr.contains(explanation), "{}", outcome.stderr);
    }
    let device = std::fs::File::open(device).unwrap();
    let outcome = bench
        .command(&["transition", "-"])
        .stdin(device)
        .output()
        .unwrap();
    let outcome = Outcome::of(&outcome);
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome
            .stderr
            .contains("standard input: it has more than 4 MB"),
        "{}",
        outcome.stderr
    );
}

/// A verdict needs two solutions with significant digits: if the cells are too coarse for one, the comparison is inconclusive.
#[test]
#[ignore = "slow: fine meshes"]
fn verify_can_be_inconclusive() {
    let bench = Bench::new();
    bench.write("case.toml", include_str!("coarse_mesh.toml"));
    let outcome = bench.run(&["verify", "case.toml"]);
    assert_eq!(outcome.status, Some(1), "{}", outcome.stderr);
    let message = &outcome.stdout;
    assert!(message.contains("INCONCLUSIVE"), "{message}");
    assert!(
        message.contains("no digit is significant: the error estimates allow"),
        "{message}"
    );
    assert!(!message.contains("DISAGREE"), "{message}");
    let outcome = bench.run(&["verify", "case.toml", "--json"]);
    let answer: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(answer["agree"], false);
    assert_eq!(answer["verdict"], "cannot tell");
    assert!(
        answer["doubt"]
            .as_str()
            .unwrap()
            .contains("no digit is significant")
    );
    let sure = bench.json(&["verify", "case.toml", "--cells", "64"]);
    assert_eq!(sure["agree"], true);
    assert_eq!(sure["verdict"], "agree");
    assert!(sure["doubt"].is_null());
}

/// Loads far too small for a contact are refused with the smallest accepted one; results contain no gaps and no negative zero.
#[test]
fn loads_too_small_for_a_contact_are_refused() {
    let bench = Bench::new();
    let case = intermediate();
    for (load, smallest) in [
        ("--force=1e-100", "at least 1.20e-35 N"), // E* = 4/3 MPa, times (3 um)^2, times 1e-30
        ("--indentation=1e-90", "at least 3.00e-26 m"), // 3 um times 1e-20
    ] {
        for method in ["spectral", "punch", "love", "homogenised"] {
            let method = format!("method.name={method}");
            let outcome = bench.run(&["press", &case, load, "--set", &method]);
            assert_eq!(outcome.status, Some(2), "{}", outcome.stdout);
            assert!(outcome.stderr.contains(smallest), "{}", outcome.stderr);
        }
    }
    for load in [
        "--force=1.3e-35",
        "--force=-0.0",
        "--indentation=1e-25",
        "--indentation=0",
    ] {
        for offset in ["pattern.offset=0", "pattern.offset=0.3"] {
            let arguments = ["press", &case, load, "--set", offset, "--json", "--quiet"];
            let outcome = bench.run(&arguments);
            assert!(!outcome.stdout.is_empty(), "{}", outcome.stderr);
            // Only the untouched floor, some thresholds and an unresolved number are null.
            let nothing = ["floor", "threshold", "unresolved"];
            let numbers = nothing.iter().fold(outcome.stdout, |numbers, name| {
                numbers.replace(&format!("\"{name}\": null"), "")
            });
            for odd in ["null", "-0.0"] {
                assert!(!numbers.contains(odd), "{load}: {numbers}");
            }
        }
    }
}

/// A missing unit: a number that is implausible in SI units is refused with its reading and the likely intention, by every option with a
/// unit, and accepted with the unit.
#[test]
fn loads_without_a_unit_are_plausible_or_refused() {
    let bench = Bench::new();
    let case = intermediate();
    let attempts: [(&[&str], &str); 12] = [
        (&["press", &case, "--indentation=3"], "`3 um`"),
        (&["press", &case, "--force=20"], "`20 uN` or `20 mN`"),
        (&["verify", &case, "--indentation=3"], "`3 um`"),
        (&["approach", &case, "--step=0.5"], "`0.5 um`"),
        (&["approach", &case, "--to=18"], "`18 um`"),
        (&["approach", &case, "--to-force=20"], "`20 uN`"),
        (&["theory", &case, "--attraction-range=5"], "`5 nm`"),
        (
            &["design", &case, "--free=pitch", "--critical-force=1"],
            "`1 mN`",
        ),
        (
            &["design", &case, "--tolerance=pattern.pillar.height=0.05"],
            "`0.05 um`",
        ),
        (
            &["design", &case, "--tolerance=substrate.young_modulus=0.1"],
            "`0.1 MPa`",
        ),
        (&["transition", &case, "--set=pattern.pitch=20"], "`20 um`"),
        (
            &["transition", &case, "--set=pattern.offset_angle=30"],
            "`30 deg`",
        ),
    ];
    for (arguments, meant) in attempts {
        let outcome = bench.run(arguments);
        assert_eq!(outcome.status, Some(2), "{arguments:?}: {}", outcome.stdout);
        let words = outcome.stderr.split_whitespace().collect::<Vec<_>>();
        let words = words.join(" ").replace("│ ", "");
        assert!(words.contains("no unit: SI)"), "{arguments:?}: {words}");
        assert!(
            words.contains("did you mean") && words.contains(meant),
            "{arguments:?}: {words}"
        );
    }
    for setting in ["pattern.pitch=2e-5", "lens.radius=0.002", "lens.radius=2m"] {
        bench.result(&["theory", &case, "--set", setting, "--quiet"]);
    }
}

#[test]
fn what_cannot_be_cited_is_status_2() {
    let bench = Bench::new();
    bench.write("provenance.json", "{}");
    let attempts: [(&[&str], &str); 4] = [
        (&["cite", "missing"], "cannot read missing"),
        (&["cite", "."], "missing field"),
        (&["cite", "/"], "no results of fakir"),
        (&["cite", ".", "--method", "love"], "cannot be used with"),
    ];
    for (arguments, explanation) in attempts {
        let outcome = bench.run(arguments);
        assert_eq!(outcome.status, Some(2), "{arguments:?}: {}", outcome.stderr);
        assert!(outcome.stderr.contains(explanation), "{}", outcome.stderr);
    }
}

/// Two cases in the same folder: refused, and with --overwrite nothing of the first remains.
#[test]
fn results_are_replaced_whole_or_not_at_all() {
    let bench = Bench::new();
    let save = |command: &str, more: &[&str]| {
        let arguments = [command, &intermediate(), "--output", "results", "--quiet"];
        bench.run(&[&arguments, more].concat())
    };
    let small = ["--set", "pattern.surface_fraction=0.01"];
    assert_eq!(save("transition", &small).status, Some(0));
    let before = bench.files("results");
    assert!(before.contains(&"pillars.csv".to_owned()));
    let summary = bench.read("results/summary.json");
    for (command, more) in [
        ("transition", &[][..]),
        ("press", &["--force", "1uN"]),
        ("approach", &[]),
        ("verify", &[]),
        ("theory", &[]),
        ("compare", &[]),
        ("design", &["--samples", "2"]),
    ] {
        let outcome = save(command, more);
        assert_eq!(outcome.status, Some(2), "{command}: {}", outcome.stderr);
        let message = "the folder results is not empty: choose another, or --overwrite";
        assert!(
            outcome.stderr.contains(message),
            "{command}: {}",
            outcome.stderr
        );
        assert_eq!(outcome.stdout, "");
    }
    assert_eq!(bench.files("results"), before);
    assert_eq!(bench.read("results/summary.json"), summary);
    // No figures, and no pillars.
    let outcome = save("theory", &["--overwrite"]);
    assert_eq!(outcome.status, Some(0), "{}", outcome.stderr);
    let after = bench.files("results");
    assert!(
        !after.iter().any(|name| name.contains("pillar")),
        "{after:?}"
    );
    assert!(after.contains(&"lattice_sums.csv".to_owned()), "{after:?}");
    assert_eq!(bench.files("."), ["results"]);
    // A sweep replaces other results too, and vice versa.
    let study = format!(
        "[study]\ncase = \"{}\"\n[axes]\npitch = [40e-6]\n",
        intermediate()
    );
    bench.write("study.toml", &study);
    let sweep = ["sweep", "study.toml", "--output", "results", "--overwrite"];
    bench.result(&sweep);
    let swept = [&["journal.jsonl", "provenance.json", "study.toml"], TABLES].concat();
    assert_eq!(bench.files("results"), swept);
    assert_eq!(save("transition", &["--overwrite"]).status, Some(0));
    assert!(!bench.path("results/journal.jsonl").exists());
    // Files of the user are not lost, nor is an unrelated folder.
    bench.write("results/notes.txt", "mine");
    let before = bench.files("results");
    for outcome in [save("theory", &["--overwrite"]), bench.run(&sweep)] {
        assert_eq!(outcome.status, Some(2), "{}", outcome.stderr);
        assert!(
            outcome.stderr.contains("notes.txt is not among the files"),
            "{}",
            outcome.stderr
        );
    }
    assert_eq!(bench.files("results"), before);
    std::fs::create_dir(bench.path("home")).unwrap();
    bench.write("home/letter.txt", "mine");
    let outcome = bench.run(&["theory", &intermediate(), "--output", "home", "--overwrite"]);
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome.stderr.contains("is no folder of results"),
        "{}",
        outcome.stderr
    );
    assert_eq!(bench.read("home/letter.txt"), "mine");
}

#[test]
fn a_case_can_come_from_standard_input() {
    let bench = Bench::new();
    let mut child = bench
        .command(&["theory", "-", "--json"])
        .stdin(Stdio::piped())
        .spawn()
        .unwrap();
    let case = std::fs::read(intermediate()).unwrap();
    child.stdin.take().unwrap().write_all(&case).unwrap();
    let outcome = Outcome::of(&child.wait_with_output().unwrap());
    assert_eq!(outcome.status, Some(0));
    assert_eq!(
        outcome.stdout,
        bench.result(&["theory", &intermediate(), "--json"])
    );
}

#[test]
fn a_closed_pipe_is_no_error() {
    let bench = Bench::new();
    let mut child = bench
        .command(&["theory", "-"])
        .stdin(Stdio::piped())
        .spawn()
        .unwrap();
    // The reader closes the pipe before anything is printed.
    drop(child.stdout.take());
    let case = std::fs::read(intermediate()).unwrap();
    child.stdin.take().unwrap().write_all(&case).unwrap();
    let outcome = Outcome::of(&child.wait_with_output().unwrap());
    assert_eq!(outcome.status, Some(0));
    assert_eq!(outcome.stderr, "");
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_with_130_and_saves_nothing() {
    let bench = Bench::new();
    // Far longer than a test may take.
    let arguments = [
        "transition",
        "-",
        "--set",
        "pattern.surface_fraction=0.29",
        "--set",
        "method.accuracy=accurate",
        "--output",
        "results",
    ];
    let mut child = bench
        .command(&arguments)
        .stdin(Stdio::piped())
        .spawn()
        .unwrap();
    // A case that does not fit into a pipe: once it is written, the program is running and reading, with its handler in place.
    let mut case = std::fs::read(intermediate()).unwrap();
    case.extend("# padding\n".repeat(100_000).bytes());
    child.stdin.take().unwrap().write_all(&case).unwrap();
    let killed = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(killed.success());
    let outcome = Outcome::of(&child.wait_with_output().unwrap());
    assert_eq!(outcome.status, Some(130), "{}", outcome.stderr);
    assert_eq!(outcome.stderr, "interrupted: no result\n");
    assert_eq!(outcome.stdout, "");
    assert!(bench.files(".").is_empty());
}

#[test]
fn help_has_an_example_for_every_command() {
    let bench = Bench::new();
    assert!(bench.result(&["--version"]).starts_with("fakir "));
    assert!(bench.result(&["--help"]).contains("Exit status:"));
    for command in [
        "init",
        "transition",
        "press",
        "approach",
        "verify",
        "theory",
        "compare",
        "cite",
    ] {
        let help = bench.result(&[command, "--help"]);
        assert!(
            ["Example: fakir", "Examples:\n  fakir"]
                .iter()
                .any(|words| help.contains(&format!("{words} {command} "))),
            "{help}"
        );
        assert!(
            help.lines().all(|line| line.chars().count() <= 100),
            "{help}"
        );
    }
}

#[test]
#[cfg(feature = "explore")]
fn the_explorer_reports_why_it_cannot_start() {
    let bench = Bench::new();
    let busy = std::net::TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let port = busy.local_addr().unwrap().port().to_string();
    let outcome = bench.run(&["explore", "--no-browser", "--port", &port]);
    assert_eq!(outcome.status, Some(2));
    let message = outcome.stderr;
    assert!(
        message.starts_with(&format!("error: port {port} is in use: port ")),
        "{message}"
    );
    assert!(message.contains(" is free, give --port "), "{message}");
    let outcome = bench.run(&["explore", "--no-browser", "--set", "lens.raduis=1m"]);
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome.stderr.contains("did you mean lens.radius?"),
        "{}",
        outcome.stderr
    );
    let repelled = ["explore", "--no-browser", "--set", "adhesion.work=-1mJ/m2"];
    let outcome = bench.run(&repelled);
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome.stderr.contains("adhesion.work"),
        "{}",
        outcome.stderr
    );
    let empty_lines = "\n".repeat(700_000);
    let table = format!("x_m,y_m\n0,0\n3e-5,0\n{empty_lines}");
    bench.write("pillars.csv", &table);
    let listed = ["pattern.lattice=listed", "pattern.pillars=pillars.csv"];
    let mut arguments = vec!["explore", "--no-browser"];
    arguments.extend(listed.iter().flat_map(|setting| ["--set", setting]));
    let outcome = bench.run(&arguments);
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome.stderr.contains("tables of at most 700000 bytes"),
        "{}",
        outcome.stderr
    );
    bench.write(
        "lens.csv",
        "radius_m,height_m\n0,0\n1e-4,2.3e-6\n2e-4,9.1e-6\n4e-4,3.6e-5\n",
    );
    let profile = ["lens.shape=profile", "lens.profile=lens.csv"];
    let mut arguments = vec!["explore", "--no-browser"];
    arguments.extend(profile.iter().flat_map(|setting| ["--set", setting]));
    let outcome = bench.run(&arguments);
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome
            .stderr
            .contains("lens.shape: the page has no tables of heights of a lens"),
        "{}",
        outcome.stderr
    );
    let outcome = bench.run(&["explore", "missing.toml"]);
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome.stderr.contains("cannot read missing.toml"),
        "{}",
        outcome.stderr
    );
}

/// A substrate a thousand times softer than the lens: the columns are 4 % too soft, and their strain exceeds the range of linear elasticity.
#[test]
fn exceeded_limits_fail_on_request() {
    let bench = Bench::new();
    let case = intermediate();
    let soft = ["--set", "substrate.young_modulus=2kPa", "--quiet"];
    let ask = |more: &[&str]| bench.run(&[&["transition", &case], &soft[..], more].concat());
    let lenient = ask(&[]);
    assert_eq!(lenient.status, Some(0), "{}", lenient.stderr);
    let line = lenient
        .stdout
        .lines()
        .find(|l| l.starts_with("limits of the model"));
    assert!(line.unwrap().ends_with("exceeded:"), "{}", lenient.stdout);
    assert!(lenient.stdout.contains("error of the columns"));
    let strict = ask(&["--strict"]);
    assert_eq!(strict.status, Some(1));
    assert!(
        strict
            .stderr
            .contains("error: outside the limits of the model: ")
    );
    assert!(
        strict
            .stderr
            .contains("where the model is doubtful from 0.01 on")
    );
    assert!(strict.stdout.starts_with("Critical state"));
    // If no limit is exceeded strict mode makes no difference, and elastic pillars report their model error.
    let elastic = ["--set", "pattern.pillar.compliance=elastic", "--force=5uN"];
    let light = [&["press", &case, "--strict"], &elastic[..]].concat();
    let light = bench.run(&light);
    assert_eq!(light.status, Some(0), "{}", light.stderr);
    assert!(
        light.stdout.contains("limits of the model")
            && light.stdout.contains("error of the pillars")
    );
    let rounded = example("asperities.toml");
    let light = bench.run(&["press", &rounded, "--force=1uN", "--strict"]);
    assert_eq!(light.status, Some(0), "{}", light.stderr);
    // One top, `a/R = sqrt(zeta/R)`: 0.34 of 0.3.
    let one = [
        "--set",
        "pattern.columns=1",
        "--indentation=60um",
        "--strict",
    ];
    let strict = bench.run(&[&["press", &rounded], &one[..]].concat());
    assert_eq!(strict.status, Some(1), "{}", strict.stderr);
    assert!(
        strict.stderr.contains("contact over radius of a top"),
        "{}",
        strict.stderr
    );
}

#[test]
fn elastic_pillars_are_refused_at_their_key() {
    let bench = Bench::new();
    let case = intermediate();
    let elastic = "pattern.pillar.compliance=elastic";
    for (set, words) in [
        (
            "pattern.pillar.height=31um",
            "pattern.pillar.compliance: cannot be \"elastic\"",
        ),
        (
            "substrate.poisson_ratio=0.2",
            "substrate.poisson_ratio: cannot be 0.2",
        ),
    ] {
        let refused = bench.run(&["transition", &case, "--set", elastic, "--set", set]);
        assert_eq!(refused.status, Some(2), "{set}");
        assert!(refused.stderr.contains(words), "{set}: {}", refused.stderr);
    }
    let surface = example("square-pillars.toml");
    let refused = bench.run(&[
        "press",
        &surface,
        "--force=1uN",
        "--set",
        "surface.pillar.compliance=elastic",
    ]);
    assert_eq!(refused.status, Some(2));
    assert!(
        refused.stderr.contains("surface.pillar.compliance: "),
        "{}",
        refused.stderr
    );
}

/// A key without effect is reported on standard error and, with or without --quiet, in the JSON object.
#[test]
fn keys_without_effect_are_named() {
    let bench = Bench::new();
    let case = intermediate();
    let press = ["press", &case, "--indentation=50nm", "--json"];
    let set = ["--set", "pattern.seed=3"];
    let warning = "pattern.seed has no effect: nothing is random";
    let ask = |more: &[&str]| {
        let outcome = bench.run(&[&press[..], more].concat());
        assert_eq!(outcome.status, Some(0), "{}", outcome.stderr);
        let json: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
        (outcome.stderr, json)
    };
    let (message, json) = ask(&set);
    assert!(
        message.starts_with(&format!("warning: {warning}")),
        "{message}"
    );
    let listed = json["case_warnings"][0].as_str().unwrap();
    assert!(listed.starts_with(warning), "{listed}");
    let (message, quiet) = ask(&[&set[..], &["--quiet"]].concat());
    assert_eq!(message, "");
    assert_eq!(quiet["case_warnings"], json["case_warnings"]);
    let (message, without) = ask(&[]);
    assert!(message.is_empty() && without["case_warnings"].is_null());
    assert_eq!(without["force_N"], json["force_N"]);
}

/// The deprecated name of a key is accepted with a warning that gives the new one.
#[test]
fn deprecated_names_of_keys_are_accepted() {
    let bench = Bench::new();
    let case = intermediate();
    let ask = |name: &str| {
        let set = format!("pattern.{name}=1%");
        let outcome = bench.run(&[
            "press",
            &case,
            "--indentation=50nm",
            "--set",
            &set,
            "--json",
        ]);
        assert_eq!(outcome.status, Some(0), "{}", outcome.stderr);
        let json: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
        (outcome.stderr, json["force_N"].clone())
    };
    let (message, force) = ask("height_spread");
    let warning =
        "warning: pattern.height_spread is deprecated: use pattern.height_standard_deviation\n";
    assert_eq!(message, warning);
    assert_eq!(ask("height_standard_deviation"), (String::new(), force));
}

/// A contact inside one wide pillar top is limited to half the lens radius, as all others are.
#[test]
fn contacts_beyond_half_the_lens_radius_are_refused_on_one_pillar_too() {
    let bench = Bench::new();
    let case = example("paper-intermediate.toml");
    let mut arguments = vec!["press", &case, "--quiet"];
    for given in [
        "lens.radius=100um",
        "pattern.pitch=400um",
        "pattern.pillar.diameter=190um",
        "pattern.pillar.height=70um",
        "pattern.pillar.compliance=none",
    ] {
        arguments.extend(["--set", given]);
    }
    let within = bench.json(&[&arguments[..], &["--indentation", "20um"]].concat());
    let ratio = within["contact_radius_m"].as_f64().unwrap() / 100e-6;
    assert!(0.3 < ratio && ratio < 0.5, "{ratio}");
    let outcome = bench.run(&[&arguments[..], &["--indentation", "45um"]].concat());
    assert_eq!(outcome.status, Some(3), "{}", outcome.stdout);
    assert!(
        outcome.stderr.contains("more than half the lens radius"),
        "{}",
        outcome.stderr
    );
}
