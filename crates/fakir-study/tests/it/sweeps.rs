//! Sweeps in memory and in folders: the tables are the same in all circumstances.

use fakir::problem::{Load, Relaxation};
use fakir::state::{CancelToken, Run};
use fakir_case::study::{Coordinate, Question};
use fakir_case::{Case, Study, StudyFile};
use fakir_study::history::{HistoryCourse, HistoryPlan, follow};
use fakir_study::{
    Existing, Options, Progress, Row, RowAnswer, Shard, StudyError, TABLES, Table, Values, merge,
    sweep, sweep_into,
};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn study(tables: &str) -> Study {
    let text = format!("{tables}\n{}", Case::example().to_toml());
    let file = StudyFile::parse("study.toml", &text).unwrap();
    file.study().unwrap()
}

/// Thirty cases of some milliseconds in six chains, one of which fails: the contact exceeds the lens.
fn cheap() -> Study {
    study(
        "[axes]\noffset = [0, 0.3, 0.5]\n\
         surface_fraction = [1e-3, 1.5e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3, 8e-3, 9e-3]",
    )
}

/// A case that is too large for the lens among valid ones.
fn with_failure() -> Study {
    study(
        "[study]\nquestion = \"press\"\n[axes]\nindentation = [\"1 um\", \"1 mm\", \"2 um\"]\n\
         \"method.name\" = [\"homogenised\", \"punch\"]",
    )
}

fn options() -> Options<'static> {
    Options {
        threads: 2,
        ..Options::default()
    }
}

fn tables(folder: &Path) -> Vec<Vec<u8>> {
    let names = TABLES.iter().chain(&["study.toml", "provenance.json"]);
    names
        .map(|name| fs::read(folder.join(name)).unwrap())
        .collect()
}

fn complete(folder: &Path) -> Vec<Vec<u8>> {
    sweep_into(&cheap(), folder, Existing::Refuse, &mut options()).unwrap();
    tables(folder)
}

fn without_times(rows: &[Row]) -> Vec<Row> {
    let row = |row: &Row| Row {
        wall_time: 0.0,
        ..row.clone()
    };
    rows.iter().map(row).collect()
}

#[test]
fn rows_do_not_depend_on_threads_and_are_those_of_single_cases() {
    let study = cheap();
    let by = |threads| {
        let mut options = Options {
            threads,
            ..Options::default()
        };
        without_times(&sweep(&study, &mut options).unwrap())
    };
    let rows = by(1);
    assert_eq!(rows, by(3));
    assert!(rows.iter().map(|row| row.index).eq(0..30));
    let Some(Values::Numbers(forces)) = Table::new(&study, &rows)
        .column("critical_force_N")
        .cloned()
    else {
        panic!("forces are numbers")
    };
    for (index, force) in forces.iter().enumerate() {
        let case = study.case(index).case.pattern().unwrap().clone();
        let alone = fakir::transition(&case.system, case.method, &Default::default()).unwrap();
        let (force, alone) = (force.unwrap(), alone.contact.force);
        // A start from a neighbouring case changes the residual of the iteration.
        assert!(
            (force / alone - 1.0).abs() < 1e-9,
            "{index}: {force} {alone}"
        );
    }
}

#[test]
fn a_case_that_fails_keeps_its_row() {
    let study = with_failure();
    let rows = sweep(&study, &mut options()).unwrap();
    let failed: Vec<usize> = rows
        .iter()
        .filter(|row| row.problem.is_some())
        .map(|row| row.index)
        .collect();
    assert_eq!(failed, [2, 3]);
    let table = Table::new(&study, &rows);
    let Some(Values::Words(problems)) = table.column("problem") else {
        panic!("problems are words")
    };
    assert!(
        problems[2]
            .as_ref()
            .unwrap()
            .contains("more than half the lens radius")
    );
    assert_eq!(problems[4].as_deref(), Some(""));
    let csv = table.to_csv();
    let line = csv.lines().nth(3).unwrap();
    assert!(
        line.starts_with("2,0.001,homogenised,,,,,,,,,,,,,,,,,,false,\"the contact would"),
        "{line}"
    );
    insta::assert_snapshot!(csv.lines().next().unwrap());
}

#[test]
fn what_is_resumed_comes_out_the_same_wherever_it_stopped() {
    let bench = TempDir::new().unwrap();
    let whole = bench.path().join("whole");
    let expected = complete(&whole);
    let journal = fs::read_to_string(whole.join("journal.jsonl")).unwrap();
    let ends: Vec<usize> = journal
        .match_indices('\n')
        .map(|(end, _)| end + 1)
        .collect();
    // Nothing, an incomplete heading, the heading, complete lines, incomplete lines, all.
    let stops = [
        0,
        10,
        ends[0],
        ends[0] + 1,
        ends[4],
        ends[7] - 1,
        ends[20] + 30,
        journal.len(),
    ];
    for stop in stops {
        let folder = bench.path().join(format!("stopped-{stop}"));
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join("journal.jsonl"), &journal[..stop]).unwrap();
        let summary = sweep_into(&cheap(), &folder, Existing::Resume, &mut options()).unwrap();
        let lines = ends.iter().filter(|end| **end <= stop).count();
        assert_eq!(summary.found, lines.saturating_sub(1));
        assert_eq!(tables(&folder), expected, "stopped after {stop} bytes");
        let journal = fs::read_to_string(folder.join("journal.jsonl")).unwrap();
        assert_eq!(journal.lines().count(), 31);
    }
}

#[test]
fn shards_in_any_order_come_out_as_if_never_divided() {
    let bench = TempDir::new().unwrap();
    let expected = complete(&bench.path().join("whole"));
    let mut folders: Vec<PathBuf> = Vec::new();
    for number in [3, 1, 4, 2] {
        let folder = bench.path().join(format!("shard-{number}"));
        let mut options = Options {
            shard: Shard::new(number, 4).unwrap(),
            ..options()
        };
        let summary = sweep_into(&cheap(), &folder, Existing::Refuse, &mut options).unwrap();
        assert!((2..=16).contains(&summary.rows.len()));
        folders.push(folder);
    }
    let merged = bench.path().join("merged");
    let summary = merge(&merged, &folders, Existing::Refuse).unwrap();
    assert_eq!(summary.rows.len(), 30);
    assert_eq!(tables(&merged), expected);
    // A merged sweep can be continued, although nothing is left to do.
    let again = sweep_into(&cheap(), &merged, Existing::Resume, &mut options()).unwrap();
    assert_eq!(again.found, 30);
    assert_eq!(tables(&merged), expected);

    let refused = |folder: &str, shards: &[PathBuf]| {
        let error = merge(&bench.path().join(folder), shards, Existing::Refuse);
        error.unwrap_err().to_string()
    };
    assert!(refused("merged", &folders).contains("not empty"));
    assert!(refused("a", &folders[..2]).contains("2 of 4 shards are missing: 2/4, 4/4"));
    let twice = [&folders[..], &folders[..1]].concat();
    assert!(refused("b", &twice).contains("are both shard 3/4"));
    assert!(refused("shard-1", &folders).contains("not empty"));
    assert!(refused("c", &[bench.path().to_owned()]).contains("there is no sweep in"));
    let journal = folders[0].join("journal.jsonl");
    let text = fs::read_to_string(&journal).unwrap();
    let shorter: Vec<&str> = text.lines().take(2).collect();
    fs::write(&journal, shorter.join("\n") + "\n").unwrap();
    let incomplete = refused("d", &folders);
    assert!(incomplete.contains("shard 3/4 in"), "{incomplete}");
    assert!(incomplete.contains("are missing ("), "{incomplete}");
    assert!(!bench.path().join("d").exists());
}

#[test]
fn what_does_not_fit_is_refused_with_the_reason() {
    let bench = TempDir::new().unwrap();
    let folder = bench.path().join("sweep");
    let expected = complete(&folder);
    let journal = fs::read_to_string(folder.join("journal.jsonl")).unwrap();
    let error = |study: &Study, existing, options: &mut Options<'_>| {
        let error = sweep_into(study, &folder, existing, options).unwrap_err();
        error
            .to_string()
            .replace(&folder.display().to_string(), "sweep")
    };
    let (study, other) = (cheap(), with_failure());
    insta::assert_snapshot!("not_empty", error(&study, Existing::Refuse, &mut options()));
    insta::assert_snapshot!(
        "other_study",
        error(&other, Existing::Resume, &mut options())
    );
    let mut shard = Options {
        shard: Shard::new(1, 2).unwrap(),
        ..options()
    };
    insta::assert_snapshot!("other_shard", error(&study, Existing::Resume, &mut shard));
    let mut memory = Options {
        memory_limit: Some(1_000_000),
        ..options()
    };
    insta::assert_snapshot!("other_memory", error(&study, Existing::Resume, &mut memory));

    let damage = |text: String| {
        fs::write(folder.join("journal.jsonl"), text).unwrap();
        error(&study, Existing::Resume, &mut options())
    };
    let lines: Vec<&str> = journal.lines().collect();
    let with_line = |number: usize, line: &str| {
        let mut lines = lines.clone();
        lines[number - 1] = line;
        lines.join("\n") + "\n"
    };
    let version = format!("\"{}\"", fakir_study::VERSION);
    let other_version = sealed(&lines[0].replace(&version, "\"0.0.9\""));
    let other_version = damage(with_line(1, &other_version));
    assert!(other_version.contains("is by fakir 0.0.9, and this is"));
    let format = with_line(
        1,
        &sealed(&lines[0].replace("\"format\":3", "\"format\":7")),
    );
    insta::assert_snapshot!("other_format", damage(format));
    insta::assert_snapshot!("damaged_heading", damage(with_line(1, &lines[0][1..])));

    // None of this has changed the tables; overwriting creates them again.
    assert_eq!(tables(&folder), expected);
    sweep_into(&other, &folder, Existing::Overwrite, &mut options()).unwrap();
    assert!(
        fs::read_to_string(folder.join("table.csv"))
            .unwrap()
            .starts_with("case,load.")
    );

    fs::remove_file(folder.join("journal.jsonl")).unwrap();
    insta::assert_snapshot!("no_sweep", error(&study, Existing::Resume, &mut options()));
}

/// A line of a journal with a checksum of its current content.
fn sealed(line: &str) -> String {
    let (text, _) = line.rsplit_once(",\"checksum\":").unwrap();
    format!(
        "{text},\"checksum\":\"{:08x}\"}}",
        crc32fast::hash(text.as_bytes())
    )
}

/// Damaged lines, lines of other cases and duplicate lines: all are reported, and the tables are unaffected.
#[test]
fn damaged_lines_are_named_and_their_cases_computed_again() {
    let bench = TempDir::new().unwrap();
    let folder = bench.path().join("sweep");
    let expected = complete(&folder);
    let journal = fs::read_to_string(folder.join("journal.jsonl")).unwrap();
    let mut lines: Vec<&str> = journal.lines().collect();
    // In the order of the cases, so that line 2 contains case 0.
    let case =
        |line: &&str| serde_json::from_str::<serde_json::Value>(line).unwrap()["case"].as_u64();
    lines[1..].sort_by_key(case);
    let mut other = lines.clone();
    // A digit of a force, a truncated line, one line replaced by another, a case that does not exist.
    let place = lines[2].find("critical_force_N").unwrap() + 20;
    let digit = if &lines[2][place..=place] == "1" {
        "2"
    } else {
        "1"
    };
    let forged = [&lines[2][..place], digit, &lines[2][place + 1..]].concat();
    let beyond = sealed(&lines[8].replacen("\"case\":", "\"case\":9", 1));
    let empty =
        sealed("{\"case\":0,\"wall_time_s\":0.1,\"problem\":null,\"answer\":null,\"checksum\":");
    (other[2], other[4], other[6]) = (&forged, &lines[4][..12], lines[5]);
    (other[8], other[30]) = (&beyond, &empty);
    fs::write(folder.join("journal.jsonl"), other.join("\n") + "\n").unwrap();
    let summary = sweep_into(&cheap(), &folder, Existing::Resume, &mut options()).unwrap();
    assert_eq!(summary.found, 25);
    let message: Vec<String> = summary.damaged.iter().map(ToString::to_string).collect();
    let message = message
        .join("\n")
        .replace(&bench.path().display().to_string(), "");
    insta::assert_snapshot!("damaged_lines", message);
    assert_eq!(tables(&folder), expected);
    // The repaired journal is complete, and reports the same again.
    let again = sweep_into(&cheap(), &folder, Existing::Resume, &mut options()).unwrap();
    assert_eq!((again.found, again.damaged.len()), (30, 5));
    assert_eq!(tables(&folder), expected);
}

/// A damaged line of a shard is reported when it is merged; the merge requires the complete shard.
#[test]
fn a_shard_that_lost_a_line_is_completed_first() {
    let bench = TempDir::new().unwrap();
    let expected = complete(&bench.path().join("whole"));
    let folders = [1, 2].map(|number| bench.path().join(format!("shard-{number}")));
    let in_shard = |number: usize, existing| {
        let mut options = Options {
            shard: Shard::new(number, 2).unwrap(),
            ..options()
        };
        sweep_into(&cheap(), &folders[number - 1], existing, &mut options).unwrap()
    };
    in_shard(1, Existing::Refuse);
    in_shard(2, Existing::Refuse);
    let journal = folders[1].join("journal.jsonl");
    let damaged = fs::read_to_string(&journal)
        .unwrap()
        .replacen("top_first", "top_fist", 1);
    fs::write(&journal, damaged).unwrap();
    let merged = bench.path().join("merged");
    let message = merge(&merged, &folders, Existing::Refuse)
        .unwrap_err()
        .to_string();
    assert!(message.contains("shard 2/2 in"), "{message}");
    assert!(
        message.contains("journal.jsonl:2: this line is damaged"),
        "{message}"
    );
    assert!(!merged.exists());
    in_shard(2, Existing::Resume);
    let summary = merge(&merged, &folders, Existing::Refuse).unwrap();
    assert_eq!(summary.damaged.len(), 1);
    assert_eq!(tables(&merged), expected);
}

#[test]
fn one_sweep_at_a_time_in_a_folder() {
    let bench = TempDir::new().unwrap();
    let folder = bench.path().to_owned();
    let study = cheap();
    let mut second = None;
    let mut listener = |_: Progress| {
        second.get_or_insert_with(|| {
            sweep_into(&study, &folder, Existing::Resume, &mut options()).map(|_| ())
        });
    };
    let mut first = Options {
        on_progress: Some(&mut listener),
        ..options()
    };
    sweep_into(&study, &folder, Existing::Refuse, &mut first).unwrap();
    assert!(matches!(second, Some(Err(StudyError::InUse(_)))));
}

#[test]
fn a_cancelled_sweep_continues_from_its_journal() {
    let bench = TempDir::new().unwrap();
    let expected = complete(&bench.path().join("whole"));
    let folder = bench.path().join("cancelled");
    let cancel = CancelToken::default();
    let mut seen = Vec::new();
    let mut listener = |progress: Progress| {
        seen.push(progress);
        if progress.done >= 3 {
            cancel.cancel();
        }
    };
    let mut interrupted = Options {
        threads: 1,
        cancel: cancel.clone(),
        on_progress: Some(&mut listener),
        ..options()
    };
    let error = sweep_into(&cheap(), &folder, Existing::Refuse, &mut interrupted).unwrap_err();
    let StudyError::Interrupted { done, cases: 30 } = error else {
        panic!("{error}")
    };
    assert!((3..30).contains(&done));
    assert!(
        seen.iter()
            .all(|progress| progress.cases == 30 && progress.failed == 0)
    );
    assert!(!folder.join("table.csv").exists());
    let journal = fs::read_to_string(folder.join("journal.jsonl")).unwrap();
    assert_eq!(journal.lines().count(), done + 1);
    let summary = sweep_into(&cheap(), &folder, Existing::Resume, &mut options()).unwrap();
    assert_eq!(summary.found, done);
    assert_eq!(tables(&folder), expected);
}

/// Holds over rate, time and relaxation have the numbers of single histories; the study as written gives the same cases.
#[test]
fn holds_over_times_are_those_of_single_histories() {
    let text = "[study]\nquestion = \"hold\"\nindentation = \"1 um\"\n\
                [axes]\nramp_time = [\"0 s\", \"10 s\"]\nhold_time = [\"5 s\", \"1 min\"]\n\
                \"relaxation.times\" = [[\"10 s\"], \"30 s\"]\n\
                [relaxation]\nstrengths = [1.0]\n";
    let study = study(text);
    let again = StudyFile::parse("again.toml", study.to_toml()).unwrap();
    let again = again.study().unwrap();
    assert_eq!(again.to_toml(), study.to_toml());
    assert_eq!(study.cases(), 8);
    let rows = sweep(&study, &mut options()).unwrap();
    let reread = without_times(&sweep(&again, &mut options()).unwrap());
    assert_eq!(reread, without_times(&rows));
    let case = Case::example();
    for row in &rows {
        assert_eq!(row.problem, None);
        let [ramp, duration] = [&row.coordinates[0], &row.coordinates[1]].map(|it| match it {
            Coordinate::Number(time) => *time,
            Coordinate::Word(word) => panic!("{word}"),
        });
        let Coordinate::Word(tau) = &row.coordinates[2] else {
            panic!("{:?}", row.coordinates)
        };
        let tau: f64 = tau.trim_end_matches(" s").parse().unwrap();
        let plan = HistoryPlan {
            relaxation: Relaxation::new(&[1.0], &[tau]).unwrap(),
            course: HistoryCourse::Hold {
                load: Load::Indentation(1e-6),
                ramp,
                duration,
                back: false,
            },
        };
        let found = follow(&case, &plan, &Run::default(), &|_| {}).unwrap();
        let Some(RowAnswer::Numbers(numbers)) = &row.answer else {
            panic!("{:?}", row.answer)
        };
        let end = found.history.states.last().unwrap();
        assert_eq!(numbers.number("end.force_N"), Some(end.force));
        assert_eq!(numbers.number("end.time_s"), Some(ramp + duration));
        if ramp.abs() <= 0.0 {
            // Expected: of a step the force is that of the relaxed contact times E(t)/E.
            let relaxed = numbers.number("equilibrium.force_N").unwrap();
            let expected = relaxed * (1.0 + (-duration / tau).exp());
            assert!((end.force / expected - 1.0).abs() < 1e-9);
        }
    }
    let refused = |text: &str| {
        let text = format!("{text}\n{}", Case::example().to_toml());
        let file = StudyFile::parse("study.toml", &text);
        file.and_then(StudyFile::study).unwrap_err().to_string()
    };
    let hold = "[study]\nquestion = \"hold\"\nforce = \"10 uN\"\n";
    let relaxation = "[relaxation]\nstrengths = [1.0]\ntimes = [\"10 s\"]\n";
    let axes = "[axes]\noffset = [0, 0.5]\n";
    assert!(refused(&format!("{hold}{axes}{relaxation}")).contains("needs a time"));
    let timed = format!("{hold}hold_time = \"10 s\"\n");
    assert!(refused(&format!("{timed}{axes}")).contains("missing"));
    let both = refused(&format!(
        "{timed}[axes]\nhold_time = [\"1 s\"]\n{relaxation}"
    ));
    assert!(both.contains("both"), "{both}");
    let other = refused(&format!(
        "{timed}indentation_rate = \"1 um/s\"\n{axes}{relaxation}"
    ));
    assert!(
        other.contains("rate of a load that is not given"),
        "{other}"
    );
    let zero = refused(&format!(
        "{timed}[axes]\nforce_rate = [\"0 N/s\"]\n{relaxation}"
    ));
    assert!(zero.contains("cannot be 0 N/s"), "{zero}");
    let twice = refused(&format!(
        "{timed}ramp_time = \"1 s\"\nforce_rate = \"1 uN/s\"\n{axes}{relaxation}"
    ));
    assert!(
        twice.contains("ramp_time and force_rate are both given"),
        "{twice}"
    );
    let press = "[study]\nquestion = \"press\"\nforce = \"10 uN\"\nramp_time = \"1 s\"\n";
    assert!(refused(&format!("{press}{axes}")).contains("a time has no place"));
}

/// A rate, as an axis or in `[study]`, is the load over the duration of its ramp.
#[test]
fn a_rate_is_the_load_over_the_duration_of_its_ramp() {
    let relaxed = "[relaxation]\nstrengths = [1.0]\ntimes = [\"10 s\"]\n";
    let ramps = |text: &str| {
        let study = study(&format!(
            "[study]\nquestion = \"hold\"\nhold_time = \"5 s\"\n{text}{relaxed}"
        ));
        let again = StudyFile::parse("again.toml", study.to_toml()).unwrap();
        assert_eq!(again.study().unwrap().to_toml(), study.to_toml());
        let cases = (0..study.cases()).map(|index| study.case(index).question);
        let ramps = cases.map(|question| match question {
            Question::Hold(hold) => hold.ramp_time,
            other => panic!("{other:?}"),
        });
        ramps.collect::<Vec<f64>>()
    };
    let slow =
        ramps("indentation = \"1 um\"\n[axes]\nindentation_rate = [\"0.1 um/s\", \"500 nm/s\"]\n");
    assert!((slow[0] - 10.0).abs() < 1e-12 && (slow[1] - 2.0).abs() < 1e-12);
    let loads = ramps("force_rate = \"2 uN/s\"\n[axes]\nforce = [\"10 uN\", \"20 uN\"]\n");
    assert!((loads[0] - 5.0).abs() < 1e-12 && (loads[1] - 10.0).abs() < 1e-12);
}
