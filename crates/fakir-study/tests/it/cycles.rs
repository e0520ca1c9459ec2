//! Sweeps of loading and unloading with adhesion.

use fakir::problem::{CyclePlan, LoadingMode, UnloadingPoint};
use fakir::state::Run;
use fakir::theory::adhesion::kendall_pull_off;
use fakir_case::{Case, Study, StudyFile};
use fakir_study::{Existing, Options, Shard, TABLES, Table, Values, merge, sweep, sweep_into};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

fn study(tables: &str) -> Study {
    let text = format!("{tables}\n{}", Case::example().to_toml());
    let file = StudyFile::parse("study.toml", &text).unwrap();
    file.study().unwrap()
}

/// Six cycles with a few pillars each.
fn cycles() -> Study {
    study(
        "[study]\nquestion = \"cycle\"\n[axes]\nsurface_fraction = [0.003, 0.01]\n\
         \"adhesion.work\" = { from = \"5 mJ/m2\", to = \"80 mJ/m2\", points = 3, spacing = \"log\" }",
    )
}

fn numbers(table: &Table, name: &str) -> Vec<f64> {
    match table.column(name) {
        Some(Values::Numbers(values)) => values.iter().map(|value| value.unwrap()).collect(),
        other => panic!("{name}: {other:?}"),
    }
}

/// Every row agrees with the cycle of its case alone, with separate numerical and model errors.
#[test]
fn rows_are_those_of_single_cycles() {
    let study = cycles();
    let rows = sweep(&study, &mut Options::default()).unwrap();
    let table = Table::new(&study, &rows);
    insta::assert_snapshot!(
        "columns_of_cycles",
        table.to_csv().lines().next().unwrap().replace(',', "\n")
    );
    let works = numbers(&table, "adhesion.work_J_per_m2");
    assert!(
        (works[1] / 20e-3 - 1.0).abs() < 1e-12,
        "log spacing: {works:?}"
    );
    let of = |name: &str| numbers(&table, name);
    for index in [0, 5] {
        let case = study.case(index).case;
        let system = case.pattern().unwrap().system.clone();
        let method = case.pattern().unwrap().method;
        let cycle = fakir::cycle(&system, CyclePlan::default(), method, &Run::default()).unwrap();
        let pull_off = cycle.pull_off.as_ref().unwrap();
        for (name, expected) in [
            ("pull_off_force_N", pull_off.force),
            ("pull_off_indentation_m", pull_off.indentation),
            ("last_release_indentation_m", cycle.separation.unwrap()),
            ("work_of_separation_J", cycle.work_of_separation),
            ("hysteresis_J", cycle.loop_area),
            (
                "critical_force_N",
                cycle.critical.as_ref().unwrap().contact.force,
            ),
            (
                "relative_error_estimate_pull_off_force",
                cycle.errors.pull_off_force.numerical(),
            ),
            (
                "relative_model_error_pull_off_force",
                cycle.errors.pull_off_force.model(),
            ),
            (
                "relative_model_error_hysteresis",
                cycle.errors.loop_area.model(),
            ),
        ] {
            assert_eq!(of(name)[index].to_bits(), expected.to_bits(), "{name}");
        }
        let kendall = kendall_pull_off(system.reduced_modulus(), 3e-6, works[index]);
        let reduced = of("normalized_pull_off_force")[index];
        assert!((reduced * kendall / pull_off.force - 1.0).abs() < 1e-12);
    }
    let counts = |name: &str| match table.column(name) {
        Some(Values::Counts(values)) => values.clone(),
        other => panic!("{name}: {other:?}"),
    };
    // Only pillars that were in contact are attached at pull-off.
    let (held, touched) = (
        counts("pull_off_pillars_in_contact"),
        counts("turn_pillars_in_contact"),
    );
    assert!(
        held.iter()
            .zip(&touched)
            .all(|(held, touched)| held <= touched && *held > Some(0))
    );
}

/// A pillar that detaches alone loses its stored energy, `2 (1 + kappa) w` per area of its top (K. Kendall, J. Phys. D 4, 1186 (1971)): at
/// large distances and strong adhesion the hysteresis is close to that, and never larger.
#[test]
fn pillars_far_apart_lose_what_each_has_stored() {
    let study = study(
        "[study]\nquestion = \"cycle\"\n[axes]\nsurface_fraction = [0.001]\n\"adhesion.work\" = [\"0.5 J/m2\"]",
    );
    let rows = sweep(&study, &mut Options::default()).unwrap();
    let found = numbers(&Table::new(&study, &rows), "normalized_hysteresis")[0];
    let case = study.case(0).case;
    let kappa = case.pattern().unwrap().system.column_compliance_ratio();
    let limit = 2.0 * (1.0 + kappa);
    assert!(found < limit && found > 0.75 * limit, "{found} of {limit}");
}

/// Interrupted, divided, or in one go: the same files.
#[test]
fn shards_and_resumed_sweeps_give_the_same_files() {
    let study = cycles();
    let folder = TempDir::new().unwrap();
    let place = |name: &str| folder.path().join(name);
    let options = |shard| Options {
        shard,
        ..Options::default()
    };
    sweep_into(
        &study,
        &place("whole"),
        Existing::Refuse,
        &mut options(Shard::WHOLE),
    )
    .unwrap();
    let shards = [1, 2].map(|number| {
        let path = place(&format!("shard-{number}"));
        let shard = Shard::new(number, 2).unwrap();
        sweep_into(&study, &path, Existing::Refuse, &mut options(shard)).unwrap();
        // A part of a sweep has tables, and no figure.
        assert!(path.join("table.csv").exists() && !path.join("pull-off.svg").exists());
        path
    });
    merge(&place("merged"), &shards, Existing::Refuse).unwrap();
    // A journal that ends after four cases.
    let journal = fs::read_to_string(place("whole").join("journal.jsonl")).unwrap();
    let begun: Vec<&str> = journal.lines().take(5).collect();
    fs::create_dir(place("begun")).unwrap();
    fs::write(
        place("begun").join("journal.jsonl"),
        begun.join("\n") + "\n",
    )
    .unwrap();
    let resumed = sweep_into(
        &study,
        &place("begun"),
        Existing::Resume,
        &mut options(Shard::WHOLE),
    );
    assert_eq!(resumed.unwrap().found, 4);
    let files = |path: &Path| {
        let others = ["provenance.json", "pull-off.svg", "pull-off.png"];
        let names = TABLES.iter().chain(&others);
        let files = names.map(|name| fs::read(path.join(name)).unwrap());
        files.collect::<Vec<_>>()
    };
    for name in ["merged", "begun"] {
        assert!(files(&place(name)) == files(&place("whole")), "{name}");
    }
}

/// The unloading point and the loading mode of the study apply to every cycle.
#[test]
fn cycles_have_the_unloading_point_and_loading_mode_of_the_study() {
    let study = study(
        "[study]\nquestion = \"cycle\"\ndrive = \"machine\"\nmachine_stiffness = \"20 N/m\"\n[axes]\n\
         surface_fraction = [0.01]\n\"adhesion.work\" = [0.05]\nindentation = [\"0.5 um\", \"1 um\"]",
    );
    let rows = sweep(&study, &mut Options::default()).unwrap();
    let table = Table::new(&study, &rows);
    let turns = numbers(&table, "turn_indentation_m");
    assert!((turns[0] / 0.5e-6 - 1.0).abs() < 1e-9 && (turns[1] / 1e-6 - 1.0).abs() < 1e-9);
    let Some(Values::Numbers(critical)) = table.column("critical_force_N") else {
        panic!("no critical forces");
    };
    assert_eq!(critical, &[None, None]);
    let plan = CyclePlan {
        turn: UnloadingPoint::Indentation(1e-6),
        drive: LoadingMode::Machine(20.0),
        retract: true,
    };
    let case = study.case(1).case;
    let pattern = case.pattern().unwrap();
    let cycle = fakir::cycle(&pattern.system, plan, pattern.method, &Run::default()).unwrap();
    assert_eq!(
        numbers(&table, "hysteresis_J")[1].to_bits(),
        cycle.loop_area.to_bits()
    );
}
