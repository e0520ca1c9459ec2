//! Sweeps of cases with a general surface: the same tables in all circumstances, with the numbers of single cases.

use fakir::state::Run;
use fakir_case::study::Question;
use fakir_case::{AnyCase, CaseFile, Study, StudyFile};
use fakir_study::provenance::Provenance;
use fakir_study::surfaces::on_wide_enough_a_grid;
use fakir_study::{Existing, Options, Row, Shard, TABLES, Table, Values, merge, sweep, sweep_into};
use std::fs;
use std::path::Path;

const CASE: &str = "[lens]\nradius = \"1 mm\"\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n\
    [substrate]\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n\
    [surface]\narrangement = \"square\"\nsurface_fraction = 0.2\n\
    [surface.pillar]\ncross_section = \"square\"\nside = \"6 um\"\nheight = \"0.3 um\"\n\
    [surface.grid]\nwidth = \"160 um\"\ncells_per_diameter = 8";

fn study(tables: &str) -> Study {
    let file = StudyFile::parse("study.toml", &format!("{tables}\n{CASE}")).unwrap();
    file.study().unwrap()
}

/// Twelve contacts, some of which reach the floor, in six chains.
fn presses() -> Study {
    study(
        "[study]\nquestion = \"press\"\n[axes]\n\"surface.pillar.height\" = [\"0.2 um\", \"0.4 um\"]\n\
         \"surface.surface_fraction\" = [0.1, 0.2, 0.3]\nindentation = [\"0.5 um\", \"2 um\"]",
    )
}

fn numbers(table: &Table, name: &str) -> Vec<Option<f64>> {
    match table.column(name) {
        Some(Values::Numbers(numbers)) => numbers.clone(),
        other => panic!("{name}: {other:?}"),
    }
}

fn file(study: &Study, index: usize) -> CaseFile {
    match study.case(index).case {
        AnyCase::HeightMap(file) => *file,
        _ => panic!("a surface"),
    }
}

#[test]
fn rows_are_those_of_single_cases_on_any_threads() {
    let study = presses();
    let by = |threads| {
        let mut options = Options {
            threads,
            ..Options::default()
        };
        let rows = sweep(&study, &mut options).unwrap();
        Table::new(&study, &rows)
    };
    let table = by(1);
    assert_eq!(table.to_csv(), by(2).to_csv());
    let heading = "case,surface.pillar.height_m,surface.surface_fraction,load.indentation_m,method,\
                   force_N,indentation_m,tops_force_N,tops_contact_area_m2,floor_force_N,\
                   floor_contact_area_m2,contact_area_m2,contact_radius_m,grid_columns,grid_rows,\
                   grid_cell_x_m,grid_cell_y_m,relative_error_estimate_force,\
                   relative_error_estimate_indentation,relative_error_estimate_contact_radius,\
                   relative_error_estimate_contact_area,energy_bound,iterations,converged,problem";
    assert_eq!(table.to_csv().lines().next(), Some(heading));
    let force = numbers(&table, "force_N");
    let (tops, floor) = (
        numbers(&table, "tops_force_N"),
        numbers(&table, "floor_force_N"),
    );
    for index in 0..study.cases() {
        let case = file(&study, index).surface_case(1_000_000_000).unwrap();
        let Question::Contact(control) = study.case(index).question else {
            panic!("the answer is not a contact");
        };
        let alone = case.system.press(control, &Run::default()).unwrap();
        assert_eq!(force[index], Some(alone.force));
        let (tops, floor) = (tops[index].unwrap(), floor[index].unwrap());
        assert!(((tops + floor) / alone.force - 1.0).abs() < 1e-12);
        assert_eq!(floor.to_bits(), alone.shares.unwrap().floor.force.to_bits());
    }
    // Some of them reach the floor.
    let loaded = floor.iter().filter(|force| **force > Some(0.0)).count();
    assert!(loaded > 0 && loaded < study.cases(), "{floor:?}");
    let provenance = Provenance::of_study(&study);
    assert!(
        provenance
            .citations
            .iter()
            .any(|cited| cited.key == "Love1929")
    );
}

#[test]
fn critical_states_have_their_own_columns_and_narrow_grids_grow() {
    let study = study("[axes]\n\"surface.grid.width\" = [\"24 um\", \"160 um\"]");
    let rows = sweep(&study, &mut Options::default()).unwrap();
    assert!(rows.iter().all(|row| row.problem.is_none()), "{rows:?}");
    let table = Table::new(&study, &rows);
    let columns = match table.column("grid_columns") {
        Some(Values::Counts(columns)) => columns.clone(),
        other => panic!("{other:?}"),
    };
    assert!(columns[0] > Some(24 * 8 / 6), "{columns:?}");
    let force = numbers(&table, "critical_force_N");
    let error = numbers(&table, "relative_error_estimate_force");
    // On another grid the cells are shifted slightly.
    let [narrow, wide] = [force[0].unwrap(), force[1].unwrap()];
    assert!((narrow / wide - 1.0).abs() < 2.0 * error[1].unwrap());
    let needed = |_: &fakir_study::answer::AnswerError| None;
    let alone = on_wide_enough_a_grid(&file(&study, 1), 1_000_000_000, needed, |case| {
        Ok(case.system.transition(&Run::default())?)
    });
    assert_eq!(force[1], Some(alone.unwrap().answer.contact.force));
    for name in [
        "bottom_contact_x_m",
        "contact_radius_m",
        "critical_indentation_m",
    ] {
        assert!(numbers(&table, name).iter().all(Option::is_some), "{name}");
    }
}

/// A sweep that was interrupted and resumed, or divided and merged, leaves the same files as an uninterrupted one, byte for byte.
#[test]
fn interrupted_and_divided_sweeps_give_the_same_tables() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let tables = |folder: &Path| {
        let names = TABLES.iter().chain(&["study.toml", "provenance.json"]);
        let files = names.map(|name| fs::read(folder.join(name)).unwrap());
        files.collect::<Vec<_>>()
    };
    let study = presses();
    sweep_into(
        &study,
        &at("whole"),
        Existing::Refuse,
        &mut Options::default(),
    )
    .unwrap();
    let whole = tables(&at("whole"));
    // As if it had been killed in its fifth case.
    fs::create_dir(at("resumed")).unwrap();
    let journal = fs::read_to_string(at("whole").join("journal.jsonl")).unwrap();
    let lines: Vec<&str> = journal.lines().collect();
    let part = format!("{}\n{}", lines[..5].join("\n"), &lines[5][..40]);
    fs::write(at("resumed").join("journal.jsonl"), part).unwrap();
    let resumed = sweep_into(
        &study,
        &at("resumed"),
        Existing::Resume,
        &mut Options::default(),
    );
    assert_eq!(resumed.unwrap().found, 4);
    assert_eq!(tables(&at("resumed")), whole);
    for number in 1..=2 {
        let mut options = Options {
            shard: Shard::new(number, 2).unwrap(),
            ..Options::default()
        };
        let part = at(&format!("part-{number}"));
        sweep_into(&study, &part, Existing::Refuse, &mut options).unwrap();
    }
    merge(
        &at("merged"),
        &[at("part-2"), at("part-1")],
        Existing::Refuse,
    )
    .unwrap();
    assert_eq!(tables(&at("merged")), whole);
}

/// A row read back from a line of a journal is identical, bit for bit; a result for another question is refused.
#[test]
fn rows_go_through_the_journal_to_the_bit() {
    let transitions = study("[axes]\n\"lens.radius\" = [\"0.9 mm\"]");
    let pressed =
        study("[study]\nquestion = \"press\"\nforce = \"50 uN\"\n[axes]\n\"lens.radius\" = [1e-3]");
    for (study, other) in [(&transitions, &pressed), (&pressed, &transitions)] {
        let rows = sweep(study, &mut Options::default()).unwrap();
        let line = rows[0].to_json();
        assert_eq!(Row::from_json(study, &line).unwrap(), rows[0]);
        assert!(Row::from_json(other, &line).is_err());
    }
}

/// A plate has no contact radius, a map without a floor no shares: the cells of the table are empty.
#[test]
fn what_there_is_not_is_empty() {
    let tables = "[study]\nquestion = \"press\"\nforce = \"50 uN\"\n[axes]\n\
                  \"surface.grid.cells_per_diameter\" = [4, 8]";
    let case = CASE
        .replace("radius = \"1 mm\"\n", "")
        .replace(
            "surface_fraction",
            "indenter = \"plate\"\nboundary = \"periodic\"\nsurface_fraction",
        )
        .replace("160 um", "50 um");
    let file = StudyFile::parse("study.toml", &format!("{tables}\n{case}")).unwrap();
    let study = file.study().unwrap();
    let table = Table::new(&study, &sweep(&study, &mut Options::default()).unwrap());
    assert_eq!(numbers(&table, "contact_radius_m"), [None, None]);
    assert!(numbers(&table, "tops_force_N").iter().all(Option::is_some));
}

/// Exceeding the memory limit affects a single case only, and the cases before are kept.
#[test]
fn a_surface_too_large_for_the_memory_is_a_row_with_its_reason() {
    let study = study("[axes]\n\"surface.grid.cells_per_diameter\" = [8, 256]");
    let mut options = Options {
        memory_limit: Some(100_000_000),
        ..Options::default()
    };
    let rows = sweep(&study, &mut options).unwrap();
    assert_eq!(rows[0].problem, None);
    let problem = rows[1].problem.as_deref().unwrap();
    assert!(problem.contains("of memory"), "{problem}");
    assert!(rows[1].answer.is_none());
}
