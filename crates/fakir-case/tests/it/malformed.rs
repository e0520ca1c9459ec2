//! Invalid case files of all known kinds, and their error messages.

use fakir_case::{Case, CaseError, CaseFile, StudyFile};
use miette::{GraphicalReportHandler, GraphicalTheme};
use std::path::Path;

fn rendered(error: &CaseError) -> String {
    let mut text = String::new();
    GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor())
        .with_width(100)
        .render_report(&mut text, error)
        .unwrap();
    format!("{text}\n{}\n", error.one_line())
}

#[test]
fn every_malformed_file_is_explained() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/malformed");
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    assert!(paths.len() >= 50);
    for path in paths {
        let name = path.file_name().unwrap().to_str().unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let error = CaseFile::from_bytes(name, bytes)
            .and_then(|file| file.case())
            .expect_err(name);
        insta::assert_snapshot!(name.trim_end_matches(".toml"), rendered(&error));
    }
}

/// Memory limit of the surfaces, bytes.
const MEMORY: usize = 100_000_000;

#[test]
fn every_malformed_surface_is_explained() {
    // The errors contain the folder of height maps, which must be the same on every machine.
    let folder = Path::new("tests/malformed_surfaces");
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "toml")
        })
        .collect();
    paths.sort();
    assert!(paths.len() >= 45);
    for path in paths {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let error = CaseFile::read(&path)
            .and_then(|file| file.surface_case(MEMORY))
            .expect_err(name);
        insta::assert_snapshot!(format!("surface_{name}"), rendered(&error));
    }
}

#[test]
fn every_malformed_study_is_explained() {
    let mut paths: Vec<_> = std::fs::read_dir("tests/malformed_studies")
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file())
        .collect();
    paths.sort();
    assert!(paths.len() >= 60);
    for path in paths {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let error = StudyFile::read(&path)
            .and_then(StudyFile::study)
            .map(|study| study.cases())
            .expect_err(name);
        insta::assert_snapshot!(format!("study_{name}"), rendered(&error));
    }
}

#[test]
fn overrides_of_a_study() {
    let text = format!(
        "[axes]\nsurface_fraction = [0.1, 0.2]\n{}",
        Case::example().to_toml()
    );
    let file = StudyFile::parse("study.toml", &text).unwrap();
    for (name, argument) in [
        ("of an axis", "pattern.surface_fraction=0.3"),
        ("of what an axis replaces", "pattern.pitch=20um"),
        ("of no key", "axes.offset=0"),
        ("that cannot be", "pattern.pillar.diameter=0um"),
    ] {
        let mut file = file.clone();
        let error = file.set(argument).and_then(|()| file.study().map(drop));
        insta::assert_snapshot!(
            format!("study_override_{}", name.replace(' ', "_")),
            rendered(&error.unwrap_err())
        );
    }
}

#[test]
fn a_study_is_no_case() {
    let text = "[study]\nquestion = \"press\"\n";
    let error = CaseFile::parse("study.toml", text).unwrap_err();
    insta::assert_snapshot!("study_for_case", rendered(&error));
}

#[test]
fn a_surface_is_no_pattern() {
    let text = "[surface]\nheight_map = \"map.npy\"\n";
    let error = CaseFile::parse("case.toml", text).unwrap().case();
    insta::assert_snapshot!("surface_for_texture", rendered(&error.unwrap_err()));
    let mut pattern = CaseFile::parse("case.toml", &Case::example().to_toml()).unwrap();
    pattern.set("surface.arrangement=square").unwrap();
    let error = pattern.case().unwrap_err();
    let same = pattern.surface_case(MEMORY).unwrap_err();
    assert_eq!(error.one_line(), same.one_line());
    insta::assert_snapshot!("surface_over_texture", rendered(&error));
}

#[test]
fn every_malformed_override_is_explained() {
    let overrides: &[(&str, &[&str])] = &[
        ("no equals sign", &["pattern.pitch"]),
        ("unknown key", &["pattern.pitsch=20um"]),
        ("key without its table", &["young_modulus=2MPa"]),
        ("table for a key", &["method=love"]),
        ("table for one of two keys", &["lens=2mm"]),
        ("table for no key", &["lens=blue"]),
        ("table of pillars", &["pillar.diameter=6um"]),
        ("word for a thickness", &["substrate.thickness=infinite"]),
        ("unknown table", &["sphere.radius=2mm"]),
        ("empty", &[""]),
        ("empty value", &["lens.radius="]),
        ("wrong unit", &["lens.radius=2 MPa"]),
        ("negative", &["pattern.pillar.height=-1um"]),
        ("number too large", &["lens.radius=1e400 um"]),
        ("above half", &["lens.poisson_ratio = 0.6"]),
        ("word for a number", &["pattern.surface_fraction=dense"]),
        ("unknown method", &["method.name=fem"]),
        ("pitch below the diameter", &["pattern.pitch=5um"]),
        (
            "file at fault after an override",
            &["pattern.pillar.diameter=20um", "pattern.pitch=19um"],
        ),
        (
            "both of an exclusive pair",
            &["pattern.pitch=20um", "pattern.surface_fraction=0.2"],
        ),
        (
            "accuracy of another method",
            &["method.name=punch", "method.accuracy=accurate"],
        ),
    ];
    let text = Case::example().to_toml();
    for (name, arguments) in overrides {
        let resolve = || {
            let mut file = CaseFile::parse("case.toml", &text)?;
            for argument in *arguments {
                file.set(argument)?;
            }
            file.case()
        };
        let error = resolve().expect_err(name);
        insta::assert_snapshot!(
            format!("override_{}", name.replace(' ', "_")),
            rendered(&error)
        );
    }
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let error = CaseFile::read(Path::new("no/such/case.toml")).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("cannot read no/such/case.toml: ")
    );
    assert_eq!(error.position(), None);
}
