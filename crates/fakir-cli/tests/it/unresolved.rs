//! Results whose stated error exceeds 0.5 are not answers, whatever was asked: the reason is printed, even with
//! `--quiet`, or is in the row of a table, and the exit status is 1.

use crate::common::{Bench, Outcome, example};

/// A pillar that carries the whole load, by the punch method, which states an error of 1.5 for it. The spectral method resolves it.
const PUNCH: [&str; 3] = ["case.toml", "--set", "method.name=punch"];

/// A folder with the case of [`PUNCH`].
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("case.toml", include_str!("coarse_mesh.toml"));
    bench
}

/// Runs a command whose result is not resolved.
#[track_caller]
fn unresolved(bench: &Bench, command: &[&str], more: &[&str]) -> Outcome {
    let outcome = bench.run(&[command, more, &["--quiet"]].concat());
    assert_eq!(outcome.status, Some(1), "{}", outcome.stderr);
    assert_ne!(outcome.stdout, "");
    let names_it = outcome
        .stderr
        .contains(" is not resolved: its estimated relative error ");
    assert!(
        names_it && outcome.stderr.contains(" exceeds 0.5; "),
        "{}",
        outcome.stderr
    );
    outcome
}

/// Runs a sweep with a single case that is not resolved: the reason is in its row.
#[track_caller]
fn unresolved_row(bench: &Bench, more: &[&str]) {
    let outcome = bench.run(&[&["sweep", "study.toml", "--quiet"], more].concat());
    assert_eq!(outcome.status, Some(1), "{}", outcome.stderr);
    let rows = outcome.stdout.lines();
    let named =
        rows.filter(|row| row.contains(",false,the ") && row.contains(" is not resolved: "));
    assert_eq!(named.count(), 1, "{}", outcome.stdout);
}

#[test]
fn contacts_are_no_answers() {
    let bench = bench();
    let ask = |name: &'static str| [&[name][..], &PUNCH].concat();
    unresolved(&bench, &ask("press"), &["--indentation", "1um"]);
    unresolved(&bench, &ask("press"), &["--force", "40mN"]);
    unresolved(&bench, &ask("transition"), &[]);
    unresolved(
        &bench,
        &ask("approach"),
        &["--to", "1um", "--step", "0.5um"],
    );
    // The same questions by a method that resolves them.
    for (name, more) in [
        ("press", &["--indentation", "1um"][..]),
        ("transition", &[]),
    ] {
        let outcome = bench.run(&[&[name, "case.toml"], more].concat());
        assert_eq!(outcome.status, Some(0), "{}", outcome.stderr);
    }
}

#[test]
fn comparisons_are_no_answers() {
    let bench = bench();
    let found = unresolved(&bench, &["compare", "case.toml"], &[]);
    let told = "warning: punch, corrected: the force is not resolved";
    assert!(found.stderr.contains(told), "{}", found.stderr);
    unresolved(&bench, &["verify", "case.toml"], &[]);
}

#[test]
fn designs_and_samples_are_no_answers() {
    let bench = bench();
    let design = [&["design"][..], &PUNCH].concat();
    let wanted = [
        "--free",
        "pattern.pillar.height",
        "--critical-force",
        "42mN",
    ];
    unresolved(&bench, &design, &wanted);
    let samples = [
        "--samples",
        "2",
        "--tolerance",
        "substrate.young_modulus=1%",
    ];
    let found = unresolved(&bench, &design, &samples);
    let told = "warning: 2 of 2 samples have no solution; the first: the force is not resolved";
    assert!(found.stderr.contains(told), "{}", found.stderr);
}

#[test]
fn cases_of_sweeps_are_no_answers() {
    let bench = bench();
    for question in ["transition", "press"] {
        let load = match question {
            "press" => "indentation = \"1 um\"\n",
            _ => "",
        };
        let study = format!(
            "[study]\nquestion = \"{question}\"\n{load}case = \"case.toml\"\n[axes]\n\"method.name\" = [\"punch\", \"spectral\"]\n"
        );
        bench.write("study.toml", &study);
        unresolved_row(&bench, &[]);
    }
}

/// Every row of the data, by its own contact; the errors of the contacts are those of [`PUNCH`].
#[test]
fn rows_of_fits_are_no_answers() {
    let bench = bench();
    bench.write(
        "data.csv",
        "indentation_um,force_mN\n0.8,20.2\n1,26.8\n1.2,33.2\n",
    );
    let fit = |method: &str| {
        let set = format!("method.name={method}");
        let free = ["--free", "substrate.young_modulus", "--quiet"];
        bench.run(
            &[
                &["fit", "data.csv", "--case", "case.toml", "--set", &set][..],
                &free,
            ]
            .concat(),
        )
    };
    let outcome = fit("punch");
    assert_eq!(outcome.status, Some(1), "{}", outcome.stderr);
    let told = "warning: 3 states (lines 2 to 4) did not converge or are not resolved";
    assert!(outcome.stderr.contains(told), "{}", outcome.stderr);
    assert!(!fit("spectral").stderr.contains("not resolved"));
}

/// Small contacts off the centre of a top: fronts on the top have a few positions only. At 1 pm the contact is smaller than the first of them: a force of 0
/// with an error of 1.
#[test]
fn cycles_are_no_answers() {
    let bench = Bench::new();
    let case = example("adhesive.toml");
    let cycle = ["cycle", &case, "--set", "pattern.offset=0.05", "--set"];
    for (work, to, quantity) in [
        (
            "adhesion.work=0.1mJ/m2",
            "1pm",
            "force at the end of loading",
        ),
        ("adhesion.work=1e-6", "100nm", "pull-off force"),
        ("adhesion.work=1e-9", "100nm", "hysteresis"),
    ] {
        let found = unresolved(&bench, &cycle, &[work, "--to", to]);
        let told = format!("warning: the {quantity} is not resolved");
        assert!(found.stderr.contains(&told), "{}", found.stderr);
    }
    let study = format!(
        "[study]\nquestion = \"cycle\"\ncase = '{case}'\n[axes]\n\"pattern.offset\" = [0.05]\n"
    );
    bench.write("study.toml", &study);
    unresolved_row(&bench, &["--set", "adhesion.work=1e-9"]);
}
