//! Meaning of study files.

use fakir::problem::pattern::CrossSection;
use fakir::problem::{Accuracy, ElementMesh, Grid, Indenter, Load, Method, PunchForm};
use fakir_case::height_map::to_npy;
use fakir_case::study::{Asked, Axis, Coordinate, Question, Variable};
use fakir_case::{
    AnyCase, Case, CaseFile, Key, Study, StudyFile, SurfaceCase, SurfaceKind, SurfaceOrigin,
};

/// A study of the example case.
fn study(tables: &str) -> Study {
    let text = format!("{tables}\n{}", Case::example().to_toml());
    let file = StudyFile::parse("study.toml", &text).unwrap();
    file.study().unwrap()
}

/// A case of a study of patterns.
fn pattern(study: &Study, index: usize) -> Case {
    study.case(index).case.pattern().unwrap().clone()
}

fn pitches(study: &Study) -> Vec<f64> {
    (0..study.cases())
        .map(|index| pattern(study, index).system.pitch())
        .collect()
}

#[test]
fn the_last_axis_varies_fastest() {
    let study = study("[axes]\npitch = [\"20 um\", \"30 um\"]\noffset = [0, 0.25, 0.5]");
    assert_eq!(study.cases(), 6);
    assert_eq!(pitches(&study), [20e-6, 20e-6, 20e-6, 30e-6, 30e-6, 30e-6]);
    assert_eq!(
        study.coordinates(4),
        [Coordinate::Number(30e-6), Coordinate::Number(0.25)]
    );
    assert_eq!(
        study.settings(4),
        "pattern.pitch = \"30 um\", pattern.offset = 0.25"
    );
    assert_eq!(study.case(4).coordinates, study.coordinates(4));
    assert_eq!(study.asked(), Asked::Transition);
    let columns: Vec<_> = study.axes().map(|axis| axis.variable().column()).collect();
    assert_eq!(columns, ["pattern.pitch_m", "pattern.offset"]);
}

#[test]
fn axes_that_go_together() {
    let study = study(
        "[study]\ncombine = \"zip\"\n[axes]\npitch = [\"20 um\", \"30 um\"]\noffset = [0, 0.5]",
    );
    assert_eq!(study.cases(), 2);
    assert_eq!(pitches(&study), [20e-6, 30e-6]);
    assert_eq!(study.coordinates(1)[1], Coordinate::Number(0.5));
}

/// A key without effect is named once for the study, even if it is an axis, unless it has an effect in some
/// case.
#[test]
fn keys_without_effect_in_any_case_are_named() {
    let words = |tables: &str| study(tables).warnings();
    let angle = "pattern.offset_angle has no effect: the lens axis is on a pillar centre: pattern.offset is 0";
    let axis = "[axes]\n\"pattern.offset_angle\" = [\"0 deg\", \"10 deg\", \"20 deg\"]";
    assert_eq!(words(axis), [angle]);
    let of_offset = format!("{axis}\n\"pattern.offset\" = [0, 0.5]");
    assert!(words(&of_offset).is_empty());
    let fixed = |offsets: &str| {
        let text = format!(
            "[axes]\n\"pattern.offset\" = {offsets}\n{}",
            Case::example().to_toml()
        );
        let mut file = StudyFile::parse("study.toml", &text).unwrap();
        file.set("pattern.offset_angle=10deg").unwrap();
        file.study().unwrap().warnings()
    };
    assert_eq!(fixed("[0]"), [angle]);
    assert!(fixed("[0, 0.5]").is_empty());
    assert!(words("[axes]\n\"pattern.pitch\" = [\"20 um\"]").is_empty());
}

#[test]
fn dotted_names_need_no_quotes() {
    let study = study("[axes]\npattern.pillar.height = [1e-6, 2e-6]\npattern.offset = [0, 0.5]");
    let axes: Vec<_> = study.axes().map(Axis::variable).collect();
    assert_eq!(
        axes,
        [Variable::Key(Key::PillarHeight), Variable::Key(Key::Offset)]
    );
}

#[test]
fn ranges_include_both_ends() {
    let range = "{ from = 3e-4, to = 0.29, points = 60, spacing = \"log\" }";
    let study = study(&format!("[axes]\nsurface_fraction = {range}"));
    let fractions: Vec<f64> = (0..60)
        .map(|index| match study.coordinates(index)[..] {
            [Coordinate::Number(number)] => number,
            _ => panic!("a number"),
        })
        .collect();
    assert_eq!((fractions[0], fractions[59]), (3e-4, 0.29));
    let ratio = (0.29_f64 / 3e-4).powf(1.0 / 59.0);
    for pair in fractions.windows(2) {
        assert!((pair[1] / pair[0] / ratio - 1.0).abs() < 1e-12);
    }
    let study = self::study("[axes]\noffset = { from = 0.1, to = 0.7, points = 4 }");
    let offset = |index: usize| {
        pattern(&study, index)
            .system
            .hexagonal_lattice()
            .expect("a hexagonal lattice")
            .offset
    };
    assert_eq!((offset(0), offset(3)), (0.1, 0.7));
    assert!((offset(1) - 0.3).abs() < 1e-15 && (offset(2) - 0.5).abs() < 1e-15);
}

#[test]
fn axes_take_per_cent() {
    let listed = study("[axes]\nsurface_fraction = [\"1 %\", 0.03]");
    let bare = study("[axes]\nsurface_fraction = [0.01, 0.03]");
    let ends = study("[axes]\nsurface_fraction = { from = \"1%\", to = \"3%\", points = 2 }");
    for index in 0..2 {
        let expected = bare.coordinates(index);
        assert_eq!(listed.coordinates(index), expected);
        assert_eq!(ends.coordinates(index), expected);
    }
}

#[test]
fn a_value_of_an_axis_is_that_of_a_case_file_bit_for_bit() {
    let study = study(
        "[axes]\n\"substrate.young_modulus\" = [\"0.0021 MPa\", 1000000000]\npitch = [\"18.07 um\"]\n\
         offset_angle = [\"10 deg\"]",
    );
    let mut file = CaseFile::parse("case.toml", &Case::example().to_toml()).unwrap();
    for argument in [
        "substrate.young_modulus=0.0021 MPa",
        "pattern.pitch=18.07 um",
        "pattern.offset_angle=10 deg",
    ] {
        file.set(argument).unwrap();
    }
    assert_eq!(pattern(&study, 0), file.case().unwrap());
    file.set_number(Key::SubstrateYoungModulus, 1e9);
    assert_eq!(pattern(&study, 1), file.case().unwrap());
    file.set_number(Key::SurfaceFraction, 0.2); // in place of the pitch
    let fraction = file.case().unwrap().system.pattern().surface_fraction();
    assert!((fraction / 0.2 - 1.0).abs() < 1e-15);
}

#[test]
fn loads() {
    let load = |study: &Study, index| study.case(index).question;
    let axis = study("[study]\nquestion = \"press\"\n[axes]\nforce = [\"20 uN\", 0]");
    assert_eq!(load(&axis, 0), Question::Contact(Load::Force(20e-6)));
    assert_eq!(load(&axis, 1), Question::Contact(Load::Force(0.0)));
    let column = axis.axes().next().unwrap().variable().column();
    assert_eq!(column, "load.force_N");
    let fixed = "[study]\nquestion = \"press\"\nindentation = \"3 um\"\n[axes]\noffset = [0, 0.5]";
    assert_eq!(
        load(&study(fixed), 1),
        Question::Contact(Load::Indentation(3e-6))
    );
}

#[test]
fn keys_of_methods_count_for_the_methods_that_have_them() {
    let methods = |tables: &str, set: &[&str]| -> Result<Vec<Method>, String> {
        let text = format!("{tables}\n{}", Case::example().to_toml());
        let mut file = StudyFile::parse("study.toml", &text).unwrap();
        for argument in set {
            file.set(argument).unwrap();
        }
        let study = file.study().map_err(|error| error.to_string())?;
        let cases = (0..study.cases()).map(|index| pattern(&study, index).method);
        Ok(cases.collect())
    };
    // The example has method.accuracy = "default", which the punch lattice does not accept.
    let axis = "[axes]\n\"method.name\" = [\"punch\", \"homogenised\"]";
    let corrected = Method::Punch(PunchForm::Corrected);
    assert_eq!(methods(axis, &[]), Ok(vec![corrected, Method::Homogenised]));
    let both = "[axes]\n\"method.name\" = [\"spectral\", \"punch\"]";
    assert_eq!(
        methods(both, &["method.accuracy=accurate", "method.form=plain"]),
        Ok(vec![
            Method::Spectral(Accuracy::Accurate),
            Method::Punch(PunchForm::Plain)
        ])
    );
    let idle = methods(axis, &["method.accuracy=accurate"]).unwrap_err();
    assert!(idle.contains("only the method \"spectral\""), "{idle}");
    let known = study("[axes]\noffset = [0, 0.5]\n\"method.name\" = [\"punch\", \"love\"]");
    let love = Method::Love(ElementMesh::default());
    assert_eq!(known.methods(), [corrected, love]);
}

#[test]
fn what_is_written_is_the_same_study() {
    let tables = [
        "[axes]\noffset = [0, 0.1, 0.8660254037844386]",
        "[axes]\npitch = { from = \"10.1 um\", to = 4e-5, points = 7, spacing = \"log\" }\noffset = [0, 1]",
        "[axes]\n\"method.name\" = [\"love\", \"spectral\"]\n\"lens.young_modulus\" = [\"1 GPa\"]",
        "[study]\nquestion = \"press\"\nforce = \"0.1 uN\"\ncombine = \"zip\"\n[axes]\noffset_angle = [1]",
        "[study]\nquestion = \"cycle\"\n[axes]\n\"adhesion.work\" = { from = \"1 mJ/m2\", to = 0.5, points = 3, spacing = \"log\" }",
        "[study]\nquestion = \"cycle\"\ndrive = \"machine\"\nmachine_stiffness = \"100 N/m\"\nforce = \"20 uN\"\n[axes]\n\"adhesion.work\" = [0.05]",
        "[study]\nquestion = \"press\"\n[axes]\nindentation = { from = 0, to = 1e-6, points = 3 }",
    ];
    for tables in tables {
        let study = study(tables);
        let written = study.to_toml();
        let again = StudyFile::parse("study.toml", written).unwrap();
        let again = again.study().unwrap();
        assert_eq!(again.to_toml(), written);
        assert_eq!(again.cases(), study.cases());
        for index in 0..study.cases() {
            assert_eq!(pattern(&again, index), pattern(&study, index));
            let [there, here] = [&again, &study].map(|study| study.case(index));
            assert_eq!(there.question, here.question);
            assert_eq!(there.coordinates, here.coordinates);
        }
    }
    insta::assert_snapshot!(study(tables[2]).to_toml());
}

#[test]
fn defaults_that_are_spelt_out_are_the_same_study() {
    let text = "[axes]\noffset_angle = [0, 0.1]\n[lens]\nradius = 0.0022\nyoung_modulus = 2e6\n\
                poisson_ratio = 0.5\n[substrate]\nyoung_modulus = 2e6\npoisson_ratio = 0.5\n\
                [pattern]\nsurface_fraction = 0.1\n[pattern.pillar]\ndiameter = 6e-6\nheight = 2.2e-6";
    let short = StudyFile::parse("short.toml", text).unwrap();
    let long = study("[axes]\n\"pattern.offset_angle\" = [\"0 deg\", \"0.1 rad\"]");
    assert_eq!(short.study().unwrap().to_toml(), long.to_toml());
}

/// A study of square pillars on a surface.
fn surface_study(tables: &str, surface: &str) -> Result<Study, String> {
    let text = format!(
        "{tables}\n[lens]\nradius = \"1 mm\"\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n\
         [substrate]\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n{surface}"
    );
    let study = StudyFile::parse("study.toml", &text).and_then(StudyFile::study);
    study.map_err(|error| error.one_line())
}

const PILLARS: &str = "[surface]\narrangement = \"square\"\nsurface_fraction = 0.2\n\
    [surface.pillar]\ncross_section = \"square\"\nside = \"6 um\"\nheight = \"1 um\"\n\
    [surface.grid]\nwidth = \"60 um\"\ncells_per_diameter = 8";

fn drawn(study: &Study, index: usize) -> SurfaceCase {
    let AnyCase::HeightMap(file) = study.case(index).case else {
        panic!("a surface")
    };
    file.surface_case(100_000_000).unwrap()
}

fn highest(case: &SurfaceCase) -> u64 {
    case.system.surface().highest().to_bits()
}

/// Any key of the case can be an axis, by its last name too; writing and reading gives the same
/// study.
#[test]
fn cases_with_a_surface_vary_along_its_keys() {
    let tables = "[axes]\npitch = [\"12 um\", \"15 um\"]\n\"surface.pillar.height\" = [\"1 um\", \"2 um\"]\n\
                  cross_section = [\"square\", \"circle\"]\n\"lens.radius\" = [\"1 mm\", \"2 mm\"]";
    let surface = PILLARS.replace("side", "diameter = \"5 um\"\nside");
    let study = surface_study(tables, &surface).unwrap();
    assert_eq!(study.cases(), 16);
    assert!(study.surface_kind() == SurfaceKind::HeightMap && study.methods().is_empty());
    let last = drawn(&study, 15);
    let Indenter::Lens(lens) = last.system.indenter() else {
        panic!("a lens")
    };
    assert_eq!(lens.sphere_radius().to_bits(), 2e-3_f64.to_bits());
    assert_eq!(highest(&last), 2e-6_f64.to_bits());
    let SurfaceOrigin::Pattern(pattern) = &last.origin else {
        panic!("pillars")
    };
    let circle = CrossSection::Circle { diameter: 5e-6 };
    assert_eq!(pattern.pillar.cross_section, circle);
    // 60 um in cells of 5/8 um.
    assert_eq!((study.cells(15), study.cells(13)), (96 * 96, 80 * 80));
    // Of squares and of circles.
    assert_eq!(study.surfaces().len(), 2);
    let again = StudyFile::parse("study.toml", study.to_toml()).unwrap();
    let again = again.study().unwrap();
    assert_eq!(again.to_toml(), study.to_toml());
    for index in 0..16 {
        let [there, here] = [&again, &study].map(|study| drawn(study, index).system);
        assert_eq!(there, here);
    }
}

/// Errors point at the axis that causes them, with the message of the case.
#[test]
fn surfaces_that_cannot_be_are_found_before_anything_is_computed() {
    let refused = |tables: &str, surface: &str| surface_study(tables, surface).unwrap_err();
    let message = refused("[axes]\n\"surface.surface_fraction\" = [0.2, 1.2]", PILLARS);
    assert!(
        message.starts_with("study.toml:2:36: surface.surface_fraction: cannot be 1.2"),
        "{message}"
    );
    let message = refused("[axes]\n\"surface.pitch\" = [\"12 um\", \"5 um\"]", PILLARS);
    assert!(
        message.starts_with("study.toml:2:29: surface.pitch: neighbouring pillars overlap"),
        "{message}"
    );
    // For random patterns the positions of the pillars differ.
    let random = PILLARS.replace("square\"\nsurf", "random\"\nsurf");
    let message = refused("[axes]\n\"surface.surface_fraction\" = [0.1, 0.9]", &random);
    assert!(
        message.contains("could be placed") && message.contains("in case 1"),
        "{message}"
    );
    let message = refused("[axes]\n\"surface.side\" = [\"5 um\"]", PILLARS.trim_end());
    assert!(
        message.contains("did you mean surface.pillar.side?"),
        "{message}"
    );
}

/// A height map that is an axis is searched for next to the study; without a floor there is no
/// transition.
#[test]
fn maps_are_an_axis_too() {
    let folder = tempfile::tempdir().unwrap();
    for (name, height) in [("low.npy", 1e-7), ("high.npy", 2e-7)] {
        let grid = Grid::centred(16, 16, 1e-6).unwrap();
        let heights = vec![height; grid.cell_count()];
        std::fs::write(folder.path().join(name), to_npy(&grid, &heights)).unwrap();
    }
    let study = |question: &str, names: &str| {
        let path = folder.path().join("study.toml");
        let text = format!(
            "[study]\n{question}\n[axes]\n\"surface.height_map\" = {names}\n[lens]\nradius = 1e-3\n\
             young_modulus = 2e6\npoisson_ratio = 0.5\n[substrate]\nyoung_modulus = 2e6\n\
             poisson_ratio = 0.5\n[surface]\ncell_size = \"1 um\""
        );
        std::fs::write(&path, text).unwrap();
        StudyFile::read(&path)?.study()
    };
    let press = "question = \"press\"\nforce = \"1 uN\"";
    let known = study(press, "[\"low.npy\", \"high.npy\"]").unwrap();
    assert_eq!(highest(&drawn(&known, 1)), 2e-7_f64.to_bits());
    // From any other folder.
    let again = StudyFile::parse("journal", known.to_toml()).unwrap();
    let first = drawn(&again.study().unwrap(), 0);
    assert_eq!(highest(&first), 1e-7_f64.to_bits());
    let missing = study(press, "[\"low.npy\", \"none.npy\"]").unwrap_err();
    assert_eq!(missing.position(), Some((5, 36)));
    assert!(missing.to_string().contains("none.npy"), "{missing}");
    let no_floor = study("question = \"transition\"", "[\"low.npy\"]").unwrap_err();
    assert_eq!(no_floor.key_path(), Some("surface.height_map"));
    let message = no_floor.one_line();
    assert!(
        message.contains("surface.floor: this key is missing"),
        "{message}"
    );
    assert!(message.contains("give the height at or below"), "{message}");
}

/// A surface that exceeds the default memory limit can be solved with a larger limit.
#[test]
fn memory_is_a_matter_of_the_sweep() {
    let study = surface_study(
        "[axes]\n\"surface.grid.width\" = [\"60 um\", \"1 m\"]",
        PILLARS,
    );
    let study = study.unwrap();
    assert_eq!((study.cells(0), study.cells(1)), (80 * 80, 0));
}
