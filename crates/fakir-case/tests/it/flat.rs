//! Cases with a flat surface.

use fakir::problem::{Adhesion, Base, LensShape};
use fakir_case::{AnyCase, CaseFile, FlatCase, SurfaceKind};

const BODIES: &str = r#"
[lens]
radius = "2.2 mm"
young_modulus = "2 MPa"
poisson_ratio = 0.5

[substrate]
young_modulus = "2 MPa"
poisson_ratio = 0.5
"#;

const PILLARS: &str = r#"
[pattern]
pitch = "20 um"

[pattern.pillar]
diameter = "6 um"
height = "2.2 um"
"#;

const FLAT: &str = "\n[surface]\nflat = true\n";

fn file(text: &str) -> CaseFile {
    CaseFile::parse("case.toml", text).unwrap()
}

fn flat(text: &str) -> FlatCase {
    match file(text).any_case(&[]).unwrap() {
        AnyCase::Flat(case) => *case,
        other => panic!("{other:?}"),
    }
}

fn refused(text: &str) -> String {
    file(text).any_case(&[]).unwrap_err().one_line()
}

#[test]
fn without_pillars_and_without_a_surface_it_is_flat() {
    let case = flat(BODIES);
    assert_eq!(case.system.lens().shape_name(), "sphere");
    assert_eq!(case.system, flat(&format!("{BODIES}{FLAT}")).system);
    assert!(case.system.adhesion().is_none() && !case.system.has_layers());
    // A false flag, and pillars, are not a flat surface.
    let pillars = file(&format!("{BODIES}{PILLARS}"));
    assert_eq!(pillars.surface_kind(), SurfaceKind::Pillars);
    let mut added = file(BODIES);
    for setting in ["pattern.pitch=20um", "pattern.pillar.diameter=6um"] {
        added.set(setting).unwrap();
    }
    assert_eq!(added.surface_kind(), SurfaceKind::Pillars);
}

#[test]
fn all_keys_of_bodies_and_adhesion_are_read_and_written_back() {
    let text = format!(
        "{}thickness = \"0.2 mm\"\nbase = \"frictionless\"\n\n[adhesion]\nwork = \"50 mJ/m2\"\nwork_receding = \"80 mJ/m2\"\n{FLAT}",
        BODIES.replace("[lens]", "[lens]\nshape = \"punch\"")
    );
    let case = flat(&text);
    assert!(
        matches!(case.system.lens().shape, LensShape::Punch { radius } if (radius - 2.2e-3).abs() < 1e-18)
    );
    let [film, lens] = case.system.layers();
    assert_eq!(film.map(|film| film.base), Some(Base::Frictionless));
    assert!(lens.is_none());
    let both = Adhesion {
        work_receding: Some(80e-3),
        ..Adhesion::new(50e-3)
    };
    assert_eq!(case.system.adhesion(), both);
    assert_eq!(flat(&case.to_toml()), case);
}

#[test]
fn keys_of_pillars_and_other_surfaces_are_refused_at_their_line() {
    let message = refused(&format!("{BODIES}{FLAT}height_map = \"map.npy\"\n"));
    assert!(
        message.contains("case.toml:13") && message.contains("a flat surface has no such key"),
        "{message}"
    );
    let message = refused(&format!("{BODIES}{PILLARS}{FLAT}"));
    assert!(
        message.contains("[pattern]") && message.contains("[surface]"),
        "{message}"
    );
    let message = refused(&format!("{BODIES}\n[method]\nname = \"punch\"\n"));
    assert!(
        message.contains("a flat surface has one method"),
        "{message}"
    );
    let message = refused(&format!("{BODIES}\n[floor]\ncontact = false\n"));
    assert!(message.contains("describe the pillars"), "{message}");
    let message = refused(&format!(
        "{BODIES}\n[adhesion]\nwork = \"50 mJ/m2\"\nfloor = true\n"
    ));
    assert!(message.contains("adhesion.floor"), "{message}");
}

#[test]
fn lenses_without_a_disc_of_contact_and_punches_across_pillars_are_refused() {
    let of_shape = |shape: &str, rest: &str| {
        let lens = format!("[lens]\nshape = \"{shape}\"");
        refused(&format!("{}{rest}", BODIES.replace("[lens]", &lens)))
    };
    let message = of_shape("cylinder", "");
    assert!(
        message.contains("lens.shape") && message.contains("no finite"),
        "{message}"
    );
    let message = of_shape("punch", PILLARS);
    assert!(
        message.contains("lens.radius") && message.contains("its edge crosses none"),
        "{message}"
    );
    let message = refused(&BODIES.replace("\"2.2 mm\"", "\"-2.2 mm\""));
    assert!(message.contains("lens.radius"), "{message}");
    let message = refused(&format!(
        "{BODIES}\n[adhesion]\nwork_receding = \"50 mJ/m2\"\n"
    ));
    assert!(message.contains("adhesion.work"), "{message}");
}
