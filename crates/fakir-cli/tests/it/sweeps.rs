//! Sweeps from a shell: killed, divided, interrupted, piped.

use crate::common::{Bench, Outcome, example, keys};
use fakir_study::TABLES;
use std::io::Write;
use std::process::{Child, Stdio};
use std::time::Duration;

const STUDY: &str = r#"
[study]
case = "case.toml"
[axes]
"pattern.offset" = [0, 0.1, 0.2, 0.3, 0.4, 0.5]
surface_fraction = { from = 1e-3, to = 1e-2, points = 20, spacing = "log" }
"#;

fn bench() -> Bench {
    let bench = Bench::new();
    let case = std::fs::read_to_string(example("paper-intermediate.toml")).unwrap();
    bench.write("case.toml", &case);
    bench.write("study.toml", STUDY);
    bench
}

fn bytes(bench: &Bench, folder: &str) -> Vec<Vec<u8>> {
    let read = |name| std::fs::read(bench.path(folder).join(name)).unwrap();
    TABLES.iter().map(read).collect()
}

fn journal_lines(bench: &Bench, folder: &str) -> usize {
    let journal = std::fs::read(bench.path(folder).join("journal.jsonl")).unwrap_or_default();
    journal.iter().filter(|byte| **byte == b'\n').count()
}

/// Waits until the journal has a number of lines; false if the sweep ends earlier.
fn wait_for_lines(bench: &Bench, folder: &str, lines: usize, sweep: &mut Child) -> bool {
    while journal_lines(bench, folder) < lines {
        if sweep.try_wait().unwrap().is_some() {
            return false;
        }
        std::thread::sleep(Duration::from_micros(200));
    }
    true
}

#[test]
fn a_sweep_killed_ten_times_gives_the_same_tables() {
    let bench = bench();
    let whole = bench.result(&["sweep", "study.toml", "--output", "whole"]);
    assert!(whole.starts_with("120 cases: critical states\n"), "{whole}");
    let expected = bytes(&bench, "whole");
    let mut random: u64 = 20_210_518;
    let mut killed = 0;
    while killed < 10 {
        // Numerical Recipes, a linear congruential generator.
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let more = (random >> 33) as usize % 9;
        let lines = journal_lines(&bench, "killed") + more;
        let mut sweep = bench
            .command(&["sweep", "study.toml", "--output", "killed", "--resume"])
            .spawn()
            .unwrap();
        assert!(
            wait_for_lines(&bench, "killed", lines, &mut sweep),
            "it ended before it could be killed"
        );
        sweep.kill().unwrap(); // SIGKILL
        sweep.wait().unwrap();
        killed += 1;
    }
    assert!(!bench.path("killed/table.csv").exists());
    let resumed = bench.result(&["sweep", "study.toml", "--output", "killed", "--resume"]);
    assert!(resumed.contains(" from the journal"), "{resumed}");
    assert_eq!(bytes(&bench, "killed"), expected);
}

#[test]
fn shards_merge_into_the_same_tables() {
    let bench = bench();
    bench.result(&["sweep", "study.toml", "--output", "whole", "--threads", "1"]);
    for shard in ["2/4", "4/4", "1/4", "3/4"] {
        let folder = shard.replace('/', "-of-");
        let text = bench.result(&[
            "sweep",
            "study.toml",
            "--output",
            &folder,
            "--shard",
            shard,
            "--threads",
            "2",
        ]);
        assert!(text.contains(" of 120 cases: critical states"), "{text}");
    }
    let folders = ["3-of-4", "1-of-4", "2-of-4", "4-of-4"];
    let incomplete = bench.run(&["merge", "merged", "1-of-4", "3-of-4", "4-of-4"]);
    assert_eq!(incomplete.status, Some(2));
    assert!(incomplete.stderr.contains("1 of 4 shards is missing: 2/4"));
    assert!(!bench.path("merged").exists());
    let text = bench.result(&[&["merge", "merged"], &folders[..]].concat());
    assert!(text.starts_with("120 cases: critical states\n"), "{text}");
    assert_eq!(bytes(&bench, "merged"), bytes(&bench, "whole"));
    assert_eq!(bench.files("merged"), bench.files("whole"));
    assert_eq!(
        bench.files("merged"),
        [
            &[
                "critical-states.png",
                "critical-states.svg",
                "journal.jsonl",
                "provenance.json",
                "study.toml",
            ],
            TABLES,
        ]
        .concat()
    );
    let figure = |folder: &str| bench.read(&format!("{folder}/critical-states.svg"));
    assert_eq!(figure("merged"), figure("whole"));
}

#[test]
fn a_damaged_line_is_named_and_its_case_computed_again() {
    let bench = bench();
    for folder in ["whole", "1-of-2", "2-of-2"] {
        let shard = if folder == "whole" {
            "1/1".to_owned()
        } else {
            folder.replace("-of-", "/")
        };
        bench.result(&["sweep", "study.toml", "--output", folder, "--shard", &shard]);
    }
    let damage = |folder: &str| {
        let path = format!("{folder}/journal.jsonl");
        let journal = bench
            .read(&path)
            .replacen("critical_force_N\":", "critical_force_N\":1", 1);
        bench.write(&path, &journal);
        format!(
            "{folder}/journal.jsonl:2: this line is damaged and left out: its checksum does not match its content"
        )
    };
    let expected = bytes(&bench, "whole");
    let named = damage("whole");
    let resume = ["sweep", "study.toml", "--output", "whole", "--resume"];
    let outcome = bench.run(&resume);
    assert_eq!(outcome.status, Some(0), "{}", outcome.stderr);
    assert!(
        outcome.stderr.starts_with(&format!("warning: {named}")),
        "{}",
        outcome.stderr
    );
    assert!(
        outcome
            .stderr
            .trim_end()
            .ends_with("; its case is computed again")
    );
    assert!(
        outcome.stdout.contains("computed  1 in"),
        "{}",
        outcome.stdout
    );
    assert_eq!(bytes(&bench, "whole"), expected);
    let again = bench.run(&resume);
    assert!(
        again
            .stderr
            .trim_end()
            .ends_with("; every case is in another line")
    );

    let named = damage("2-of-2");
    let merge = ["merge", "merged", "1-of-2", "2-of-2"];
    let outcome = bench.run(&merge);
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome
            .stderr
            .contains("shard 2/2 in 2-of-2 is not complete"),
        "{}",
        outcome.stderr
    );
    assert!(outcome.stderr.contains(&named), "{}", outcome.stderr);
    let shard = [
        "sweep",
        "study.toml",
        "--output",
        "2-of-2",
        "--shard",
        "2/2",
        "--resume",
    ];
    assert_eq!(bench.run(&shard).status, Some(0));
    let outcome = bench.run(&merge);
    assert_eq!(outcome.status, Some(0), "{}", outcome.stderr);
    assert!(outcome.stderr.contains(&named), "{}", outcome.stderr);
    assert_eq!(bytes(&bench, "merged"), expected);
}

#[test]
fn what_cannot_be_is_status_2_and_touches_nothing() {
    let bench = bench();
    bench.write(
        "broken.toml",
        "[study]\ncase = \"case.toml\"\n[axes]\nofset = [0, 1]\n",
    );
    std::fs::create_dir(bench.path("full")).unwrap();
    bench.write("full/mine", "mine");
    let attempts: [(&[&str], &str); 12] = [
        (&["broken.toml"], "did you mean pattern.offset?"),
        (&["case.toml"], "has no table [axes]"),
        (&["missing.toml"], "cannot read missing.toml"),
        (&["study.toml", "--set", "pattern.offset=0"], "is an axis"),
        (&["study.toml", "--shard", "0/4"], "no shard"),
        (&["study.toml", "--shard", "5/4"], "no shard"),
        (&["study.toml", "--shard", "x"], "no shard"),
        (
            &["study.toml", "--resume", "--overwrite"],
            "cannot be used with",
        ),
        (&["study.toml", "--output", "full"], "is not empty"),
        (
            &["study.toml", "--output", "full", "--resume"],
            "no sweep in full",
        ),
        (&["study.toml", "--output", "case.toml"], "case.toml"),
        (&["study.toml", "--memory-limit", "8"], "such as 8GB"),
    ];
    for (arguments, explanation) in attempts {
        let output: &[&str] = match arguments.contains(&"--output") {
            true => &[],
            false => &["--output", "results"],
        };
        let outcome = bench.run(&[&["sweep"], arguments, output].concat());
        assert_eq!(outcome.status, Some(2), "{arguments:?}");
        assert!(outcome.stderr.contains(explanation), "{}", outcome.stderr);
        assert_eq!(outcome.stdout, "");
    }
    assert!(!bench.path("results").exists());
    assert_eq!(bench.files("full"), ["mine"]);
    let outcome = bench.run(&["sweep", "study.toml", "--resume"]);
    assert!(outcome.stderr.contains("--output"), "{}", outcome.stderr);
    let outcome = bench.run(&["transition", "study.toml"]);
    assert!(outcome.stderr.contains("`fakir sweep` takes a study"));
}

#[test]
fn a_foreign_journal_is_not_gone_on_with() {
    let bench = bench();
    bench.result(&["sweep", "study.toml", "--output", "results"]);
    let before = bytes(&bench, "results");
    let other = [
        "sweep",
        "study.toml",
        "--output",
        "results",
        "--set",
        "lens.radius=2mm",
    ];
    let outcome = bench.run(&[&other[..], &["--resume"]].concat());
    assert_eq!(outcome.status, Some(2));
    assert!(
        outcome.stderr.contains("radius = \"2.2 mm\""),
        "{}",
        outcome.stderr
    );
    assert!(
        outcome.stderr.contains("radius = \"2 mm\""),
        "{}",
        outcome.stderr
    );
    assert_eq!(bytes(&bench, "results"), before);
    bench.result(&[&other[..], &["--overwrite"]].concat());
    assert_ne!(bytes(&bench, "results"), before);
}

#[test]
fn failures_are_counted_and_keep_their_rows() {
    let bench = bench();
    bench.write(
        "press.toml",
        "[study]\ncase = \"case.toml\"\nquestion = \"press\"\n[axes]\n\
         \"method.name\" = [\"homogenised\", \"punch\"]\n\
         indentation = [\"0.5 um\", \"1 um\", \"1 mm\"]\n",
    );
    let outcome = bench.run(&["sweep", "press.toml", "--output", "results"]);
    assert_eq!(outcome.status, Some(1), "{}", outcome.stderr);
    let text: Vec<&str> = outcome
        .stdout
        .lines()
        .filter(|line| !line.starts_with("computed"))
        .collect();
    // A build with the feature parquet saves a second table.
    let text = text.join("\n").replace("tables    ", "table     ");
    insta::assert_snapshot!(text.replace(", results/table.parquet", ""));
    let csv = bench.read("results/table.csv");
    assert_eq!(csv.lines().count(), 7);
    assert!(
        csv.lines()
            .nth(3)
            .unwrap()
            .contains("more than half the lens radius")
    );

    let printed = bench.run(&["sweep", "press.toml"]);
    assert_eq!(printed.status, Some(1));
    assert_eq!(printed.stdout, csv);
    assert!(
        printed
            .stderr
            .contains("warning: case 2 (method.name = \"homogenised\"")
    );
    assert_eq!(bench.run(&["sweep", "press.toml", "--quiet"]).stderr, "");

    let outcome = bench.run(&["sweep", "press.toml", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(
        keys(&json),
        [
            "cases",
            "cases_of_study",
            "failed",
            "fakir_version",
            "from_journal",
            "problems",
            "question",
            "rows",
            "wall_time_s"
        ]
    );
    assert_eq!(json["failed"], 2);
    assert_eq!(json["rows"][1]["load.indentation_m"], 1e-6);
    assert_eq!(json["problems"][1]["case"], 5);

    // Merged shards report the same.
    for shard in ["1/2", "2/2"] {
        let folder = shard.replace('/', "-of-");
        bench.run(&["sweep", "press.toml", "--shard", shard, "--output", &folder]);
    }
    let merged = bench.run(&["merge", "merged", "1-of-2", "2-of-2"]);
    assert_eq!(merged.status, Some(1), "{}", merged.stderr);
    assert!(
        merged
            .stdout
            .contains("case 2 (method.name = \"homogenised\""),
        "{}",
        merged.stdout
    );
}

#[test]
fn a_row_is_what_the_command_for_one_case_gives() {
    let bench = bench();
    let rows = bench.json(&["sweep", "study.toml"]);
    let row = &rows["rows"][39]; // at the end of a range
    assert_eq!(row["pattern.surface_fraction"], 1e-2);
    let alone = bench.json(&[
        "transition",
        "case.toml",
        "--set",
        "pattern.offset=0.1",
        "--set",
        "pattern.surface_fraction=0.01",
    ]);
    crate::common::assert_close(
        &row["critical_force_N"],
        alone["critical_force_N"].as_f64().unwrap(),
        1e-9,
    );
    assert_eq!(row["pillars_in_contact"], alone["pillars_in_contact"]);
    assert_eq!(row["pitch_m"], alone["pitch_m"]);
}

#[test]
fn a_study_from_a_pipe() {
    let bench = bench();
    let mut sweep = bench
        .command(&["sweep", "-"])
        .stdin(Stdio::piped())
        .spawn()
        .unwrap();
    let study = "[study]\ncase = \"case.toml\"\n[axes]\nsurface_fraction = [1e-3]\n";
    sweep
        .stdin
        .take()
        .unwrap()
        .write_all(study.as_bytes())
        .unwrap();
    let outcome = Outcome::of(&sweep.wait_with_output().unwrap());
    assert_eq!(outcome.status, Some(0), "{}", outcome.stderr);
    assert_eq!(outcome.stdout.lines().count(), 2);
}

#[test]
fn the_example_study_runs() {
    let bench = Bench::new();
    let study = example("study-surface-fraction.toml");
    let json = bench.json(&["sweep", &study, "--output", "results"]);
    assert_eq!(json["cases"], 60);
    assert_eq!(json["failed"], 0);
}

#[cfg(unix)]
#[test]
fn an_interrupt_keeps_the_journal() {
    let bench = bench();
    let mut sweep = bench
        .command(&[
            "sweep",
            "study.toml",
            "--output",
            "results",
            "--threads",
            "1",
        ])
        .spawn()
        .unwrap();
    assert!(wait_for_lines(&bench, "results", 3, &mut sweep));
    let interrupt = std::process::Command::new("kill")
        .args(["-INT", &sweep.id().to_string()])
        .status();
    assert!(interrupt.unwrap().success());
    let outcome = Outcome::of(&sweep.wait_with_output().unwrap());
    assert_eq!(outcome.status, Some(130), "{}", outcome.stderr);
    let done = journal_lines(&bench, "results") - 1;
    assert_eq!(
        outcome.stderr,
        format!("interrupted after {done} of 120 cases: --resume continues\n")
    );
    assert_eq!(bench.files("results"), ["journal.jsonl", "study.toml"]);
}

/// Once for the study, on standard error and in the JSON object.
#[test]
fn a_key_without_effect_is_named_once() {
    let bench = bench();
    let study = "[study]\ncase = \"case.toml\"\n[axes]\nsurface_fraction = [1e-3, 2e-3]\n";
    bench.write("study.toml", study);
    let angle = ["--set", "pattern.offset_angle=10deg"];
    let words = "pattern.offset_angle has no effect: the lens axis is on a pillar centre: pattern.offset is 0";
    let outcome = bench.run(&[&["sweep", "study.toml", "--json"], &angle[..]].concat());
    assert_eq!(outcome.status, Some(0), "{}", outcome.stderr);
    assert_eq!(outcome.stderr, format!("warning: {words}\n"));
    let summary: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(summary["case_warnings"], serde_json::json!([words]));
    let plain = bench.run(&["sweep", "study.toml", "--json"]);
    assert!(plain.stderr.is_empty() && !plain.stdout.contains("case_warnings"));
    // Also when shards are merged.
    for shard in ["1/2", "2/2"] {
        let folder = shard.replace('/', "-of-");
        let own = ["sweep", "study.toml", "--shard", shard, "--output", &folder];
        bench.run(&[&own[..], &angle].concat());
    }
    let merged = bench.run(&["merge", "merged", "1-of-2", "2-of-2", "--json"]);
    assert_eq!(merged.status, Some(0), "{}", merged.stderr);
    assert_eq!(merged.stderr, format!("warning: {words}\n"));
    assert!(merged.stdout.contains("case_warnings"), "{}", merged.stdout);
}

/// Thicknesses and the bases of films are axes like others. Under the critical force the displacement decreases with the thickness of a
/// film, and if the film is bonded.
#[test]
fn films_are_swept() {
    let bench = Bench::new();
    let case = std::fs::read_to_string(example("paper-intermediate.toml")).unwrap();
    bench.write("case.toml", &case);
    let study = r#"
[study]
case = "case.toml"
[axes]
surface_fraction = [0.01]
"substrate.thickness" = ["0.1 mm", "1 mm"]
"substrate.base" = ["rigid", "frictionless"]
"#;
    bench.write("study.toml", study);
    bench.result(&["sweep", "study.toml", "--output", "films"]);
    let table = bench.read("films/table.csv");
    let mut rows = table
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let names = rows.next().unwrap();
    let place = |name: &str| names.iter().position(|own| *own == name).unwrap();
    let (thickness, base) = (place("substrate.thickness_m"), place("substrate.base"));
    let indentation = place("critical_indentation_m");
    let rows: Vec<_> = rows.collect();
    assert_eq!(rows.len(), 4);
    let of = |required: f64, word: &str| -> f64 {
        let found = rows.iter().find(|row| {
            let own: f64 = row[thickness].parse().unwrap();
            (own / required - 1.0).abs() < 1e-9 && row[base] == word
        });
        found.unwrap()[indentation].parse().unwrap()
    };
    assert!(of(1e-4, "rigid") < of(1e-4, "frictionless"));
    assert!(of(1e-4, "frictionless") < of(1e-3, "frictionless"));
    assert!(of(1e-4, "rigid") < of(1e-3, "rigid"));
}
