//! Lenses of other shapes in case files.

use fakir::problem::LensShape;
use fakir_case::{Case, CaseError, CaseFile, Key, SurfaceCase};

const REST: &str = "
[substrate]
young_modulus = '2 MPa'
poisson_ratio = 0.5
[pattern]
lattice = 'square'
pitch = '20 um'
columns = 7
[pattern.pillar]
diameter = '6 um'
height = '2.2 um'
";

fn file(lens: &str) -> CaseFile {
    let text = format!("[lens]\nyoung_modulus = '2 MPa'\npoisson_ratio = 0.5\n{lens}\n{REST}");
    CaseFile::parse("case.toml", &text).expect("keys that are known")
}

fn case(lens: &str) -> Case {
    file(lens).case().expect("a valid case")
}

fn refused(lens: &str) -> CaseError {
    file(lens).case().expect_err("a case that cannot be")
}

/// A table of `r^2/(2R)` with R = 1 mm.
fn table(folder: &tempfile::TempDir) -> String {
    let path = folder.path().join("lens.csv");
    let rows = (0..9).map(|k| format!("{k}e-5,{:e}\n", f64::from(k * k) * 1e-10 / 2e-3));
    let text = format!("radius_m,height_m\n{}", rows.collect::<String>());
    std::fs::write(&path, text).expect("a folder to write to");
    path.display().to_string()
}

#[test]
fn shapes_are_read_and_written_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let profile = format!("profile = '{}'", table(&folder));
    for (lens, name) in [
        ("radius = '2.2 mm'", "sphere"),
        ("shape = 'sphere'\nradius = '2.2 mm'", "sphere"),
        ("shape = 'paraboloid'\nradius = '2.2 mm'", "paraboloid"),
        (
            "shape = 'cylinder'\nradius = '2.2 mm'\nangle = '33.3 deg'",
            "cylinder",
        ),
        ("shape = 'plate'", "plate"),
        (
            "shape = 'plate'\ntilt = '0.3 deg'\ntilt_direction = '-70 deg'",
            "plate",
        ),
        (profile.as_str(), "profile"),
    ] {
        let case = case(lens);
        assert_eq!(case.system.lens().shape_name(), name);
        let again = CaseFile::parse("again", &case.to_toml()).unwrap();
        assert_eq!(again.case().unwrap(), case, "{lens}");
        assert_eq!(case.to_file("again").unwrap().case().unwrap(), case);
    }
    // The shape of a sphere is not required and not written.
    assert!(!case("radius = '2.2 mm'").to_toml().contains("shape"));
    let LensShape::Profile(profile) = case(&profile).system.lens().shape.clone() else {
        panic!("a profile")
    };
    assert!((profile.apex_radius() / 1e-3 - 1.0).abs() < 1e-9);
}

/// An override of the shape removes the keys that the new shape does not have.
#[test]
fn shapes_are_overridden() {
    let mut file = file("radius = '2.2 mm'");
    file.set("lens.shape=plate").unwrap();
    file.set("lens.tilt=1deg").unwrap();
    let case = file.case().unwrap();
    let LensShape::Plate { tilt, .. } = case.system.lens().shape else {
        panic!("a plate")
    };
    assert!((tilt / 1f64.to_radians() - 1.0).abs() < 1e-15);
    assert_eq!(case.setting(Key::LensRadius), None);
}

#[track_caller]
fn assert_refused(lens: &str, key: &str, problem: &str, accepted: &str) {
    let error = refused(lens);
    assert_eq!(error.key_path(), Some(key), "{}", error.one_line());
    assert!(error.problem().contains(problem), "{}", error.one_line());
    let message = error.what_is_accepted().unwrap_or("");
    assert!(message.contains(accepted), "{message}");
}

#[test]
fn what_does_not_belong_together_is_refused() {
    assert_refused(
        "shape = 'plate'\nradius = '2 mm'",
        "lens.radius",
        "with lens.shape = \"plate\" there is no such key",
        "leave it out, or give \"sphere\", \"paraboloid\", \"cylinder\" or \"punch\" as lens.shape",
    );
    assert_refused(
        "radius = '2 mm'\nangle = '1 deg'",
        "lens.angle",
        "lens.shape = \"sphere\"",
        "cylinder",
    );
    assert_refused(
        "shape = 'cylinder'\nradius = '2 mm'\ntilt = 0.1",
        "lens.tilt",
        "no such key",
        "plate",
    );
    assert_refused(
        "radius = '2 mm'\nprofile = 'a.csv'",
        "lens.radius",
        "lens.shape = \"profile\"",
        "leave it out",
    );
    assert_refused("shape = 'cylinder'", "lens.radius", "missing", "");
    assert_refused("shape = 'profile'", "lens.profile", "missing", "");
    assert_refused(
        "shape = 'cone'",
        "lens.shape",
        "\"cone\" is not known",
        "sphere",
    );
    assert_refused(
        "shape = 'plate'\ntilt = '11 deg'",
        "lens.tilt",
        "cannot be 11 deg",
        "from 0 to 10 deg",
    );
    assert_refused(
        "profile = 'nowhere.csv'",
        "lens.profile",
        "cannot read nowhere.csv",
        "radius_m and height_m",
    );
}

#[test]
fn infinite_lattices_are_refused_under_cylinders_and_plates() {
    for lens in ["shape = 'plate'", "shape = 'cylinder'\nradius = '2.2 mm'"] {
        let text = format!("[lens]\nyoung_modulus = '2 MPa'\npoisson_ratio = 0.5\n{lens}\n{REST}");
        let text = text.replace("columns = 7", "");
        let error = CaseFile::parse("case.toml", &text)
            .unwrap()
            .case()
            .unwrap_err();
        assert!(
            error.one_line().starts_with("case.toml:4:9: lens.shape: "),
            "{}",
            error.one_line()
        );
        assert!(error.problem().contains("touches infinitely many pillars"));
        assert!(
            error
                .what_is_accepted()
                .unwrap()
                .contains("pattern.columns")
        );
    }
}

/// A square pattern on a grid under a lens with these keys and a boundary.
fn on_a_grid(lens: &str, boundary: &str) -> Result<SurfaceCase, CaseError> {
    let text = format!(
        "[lens]\n{lens}young_modulus = 2e6\npoisson_ratio = 0.5\n\
         [substrate]\nyoung_modulus = 2e6\npoisson_ratio = 0.5\n\
         [surface]\narrangement = 'square'\npitch = 12e-6\nboundary = '{boundary}'\n\
         [surface.pillar]\ndiameter = 6e-6\nheight = 2e-6\n\
         [surface.grid]\ncells_per_diameter = 8\nwidth = 24e-6\n"
    );
    CaseFile::parse("case.toml", &text)
        .unwrap()
        .surface_case(1 << 30)
}

/// Each shape has its own lens, a level plate is the plate of `surface.indenter`, and the case file is written again.
#[test]
fn surfaces_take_every_lens() {
    for (keys, name) in [
        ("shape = 'paraboloid'\nradius = 1e-3\n", "paraboloid"),
        (
            "shape = 'cylinder'\nradius = 1e-3\nangle = 0.5\n",
            "cylinder",
        ),
        ("shape = 'plate'\ntilt = 0.01\n", "plate"),
    ] {
        let case = on_a_grid(keys, "free").unwrap();
        let lens = case.system.indenter().lens().unwrap();
        assert_eq!(lens.shape_name(), name);
        let again = CaseFile::parse("again.toml", &case.to_toml()).unwrap();
        assert_eq!(again.surface_case(1 << 30).unwrap().system, case.system);
    }
    let level = on_a_grid("shape = 'plate'\n", "periodic").unwrap();
    assert!(level.system.indenter().lens().is_none());
}

/// What is not periodic is refused on a periodic surface, and a plate has no shape.
#[test]
fn lenses_without_end_are_refused_on_periodic_surfaces() {
    for (keys, key) in [
        ("shape = 'cylinder'\nradius = 1e-3\n", "lens.shape"),
        ("shape = 'plate'\ntilt = 0.01\n", "lens.tilt"),
    ] {
        let error = on_a_grid(keys, "periodic").unwrap_err();
        assert_eq!(error.key_path(), Some(key));
        assert!(error.problem().contains("not periodic"), "{error}");
        assert!(error.what_is_accepted().unwrap().contains("free boundary"));
    }
    let error = on_a_grid(
        "shape = 'paraboloid'\nradius = 1e-3\n",
        "free'\nindenter = 'plate",
    );
    let error = error.unwrap_err();
    assert_eq!(error.key_path(), Some("lens.radius"), "{error}");
}
