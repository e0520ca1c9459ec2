//! Meaning of valid case files, and their round trip through writing and reading.

// Numbers are read exactly.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use fakir::problem::{
    Accuracy, Adhesion, ElementMesh, HexagonalLattice, MeshLayout, Method, PillarCompliance,
    PunchForm, System,
};
use fakir_case::{Case, CaseError, CaseFile};
use proptest::prelude::*;
use std::path::Path;

fn parse(text: &str) -> Case {
    CaseFile::parse("case.toml", text).unwrap().case().unwrap()
}

fn with(overrides: &[&str]) -> Result<Case, CaseError> {
    let mut file = CaseFile::parse("case.toml", &Case::example().to_toml())?;
    for argument in overrides {
        file.set(argument)?;
    }
    file.case()
}

/// The values of tables I and II of the paper, common to all substrates, at the surface fraction 0.1.
fn check_paper(name: &str, substrate_modulus: f64) -> System {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../examples")
        .join(name);
    let case = CaseFile::read(&path).unwrap().case().unwrap();
    assert_eq!(case.method, Method::Spectral(Accuracy::Default));
    let system = case.system;
    assert_eq!(system.lens().sphere_radius(), 2200e-6);
    assert_eq!(system.lens().material.young_modulus, 2e6);
    assert_eq!(system.lens().material.poisson_ratio, 0.5);
    assert_eq!(system.substrate().young_modulus, substrate_modulus);
    assert_eq!(system.substrate().poisson_ratio, 0.5);
    assert_eq!(system.pillar().diameter, 6e-6);
    assert_eq!(system.pillar().height, 2.2e-6);
    assert_eq!(system.pillar().compliance, PillarCompliance::Column);
    assert_eq!(
        system
            .hexagonal_lattice()
            .expect("a hexagonal lattice")
            .offset,
        0.0
    );
    assert_eq!(
        system
            .hexagonal_lattice()
            .expect("a hexagonal lattice")
            .offset_angle,
        0.0
    );
    assert!((system.pattern().surface_fraction() - 0.1).abs() < 1e-15);
    system
}

#[test]
fn examples_are_the_systems_of_the_paper() {
    check_paper("paper-rigid.toml", 1e9);
    let intermediate = check_paper("paper-intermediate.toml", 2e6);
    check_paper("paper-soft.toml", 2e3);
    assert_eq!(Case::example().system, intermediate);
}

/// The last name of a key is sufficient if it is unique in such a case.
#[test]
fn overrides_by_the_last_name_of_a_key() {
    for (short, whole) in [
        ("pitch=25um", "pattern.pitch=25um"),
        ("diameter=5um", "pattern.pillar.diameter=5um"),
        ("work=20mJ/m2", "adhesion.work=20mJ/m2"),
        ("accuracy=accurate", "method.accuracy=accurate"),
    ] {
        assert_eq!(with(&[short]).unwrap(), with(&[whole]).unwrap());
    }
}

/// 50 mJ/m^2 is 0.05 J/m^2 in every notation, and without the table there is no adhesion.
#[test]
fn works_of_adhesion() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/adhesive.toml");
    let example = CaseFile::read(&path).unwrap().case().unwrap();
    assert_eq!(example.system.adhesion(), Adhesion::new(0.05));
    assert!(Case::example().system.adhesion().is_none());
    let adhesion = |overrides: &[&str]| with(overrides).unwrap().system.adhesion();
    for work in [
        "50mJ/m2",
        "50 mJ/m^2",
        "50 mJ/m²",
        "50 mN/m",
        "0.05 N/m",
        "0.05",
    ] {
        let found = adhesion(&[&format!("adhesion.work={work}")]);
        assert_eq!(found, Adhesion::new(0.05), "{work}");
    }
    let both = [
        "adhesion.work=50mJ/m2",
        "adhesion.work_receding=80mJ/m2",
        "method.accuracy=accurate",
    ];
    let adhesive = Adhesion {
        work: 0.05,
        work_receding: Some(0.08),
        floor: false,
    };
    let case = with(&both).unwrap();
    assert_eq!(case.system.adhesion(), adhesive);
    let text = case.to_toml();
    assert!(
        text.contains("\n[adhesion]\nwork = \"50 mJ/m2\" "),
        "{text}"
    );
    assert!(text.contains("\nwork_receding = \"80 mJ/m2\" "), "{text}");
    assert_eq!(parse(&text), case);
    // Two works of zero mean no adhesion, and are written and read unchanged.
    let zeros = with(&["adhesion.work=0", "adhesion.work_receding=0"]).unwrap();
    assert!(zeros.system.adhesion().is_none());
    assert_eq!(parse(&zeros.to_toml()), zeros);
    // Without adhesion all methods are accepted, and the case is written as before.
    let none = with(&["adhesion.work=0", "method.name=love"]).unwrap();
    assert_eq!(none, with(&["method.name=love"]).unwrap());
    assert!(!none.to_toml().contains("adhesion"));
}

#[test]
fn layers_survive_writing_and_reading() {
    use fakir::problem::{Base, Layer, Material};
    let half_spaces = with(&[]).unwrap();
    assert!(!half_spaces.system.has_layers());
    assert!(!half_spaces.to_toml().contains("thickness"));
    let film = with(&["substrate.thickness=0.2 mm"]).unwrap();
    assert_eq!(film.system.substrate_layer(), Some(&Layer::new(0.2e-3)));
    let overrides = [
        "substrate.thickness=0.2 mm",
        "substrate.base=elastic",
        "substrate.base_young_modulus=3 GPa",
        "substrate.base_poisson_ratio=0.4",
        "lens.thickness=1 mm",
        "lens.base=frictionless",
    ];
    let both = with(&overrides).unwrap();
    let base = both.system.substrate_layer().unwrap().base;
    assert_eq!(base, Base::Elastic(Material::new(3e9, 0.4)));
    assert_eq!(both.system.lens_layer().unwrap().base, Base::Frictionless);
    assert_eq!(parse(&both.to_toml()), both);
    assert_eq!(parse(&film.to_toml()), film);
}

#[test]
fn what_may_be_left_out() {
    let case = parse(
        r#"
        lens = { radius = 0.0022, young_modulus = 2_000_000, poisson_ratio = 0 }
        substrate = { young_modulus = 2e6, poisson_ratio = 0.5 }
        pattern.pitch = "20 µm"
        pattern.pillar = { diameter = "6000 nm", height = "2.2 μm" }
        "#,
    );
    assert_eq!(case.method, Method::default());
    assert_eq!(
        *case
            .system
            .hexagonal_lattice()
            .expect("a hexagonal lattice"),
        HexagonalLattice::new(20e-6)
    );
    assert_eq!(case.system.lens().material.young_modulus, 2e6);
    assert_eq!(case.system.pillar().height, 2.2e-6);
    assert_eq!(case.system.pillar().compliance, PillarCompliance::Column);
}

#[test]
fn overrides_replace_the_other_of_a_pair_and_the_method() {
    let pitch = |overrides: &[&str]| with(overrides).unwrap().system.pitch();
    assert_eq!(pitch(&["pattern.pitch=20um"]), 20e-6);
    assert_eq!(
        pitch(&["pattern.pitch=20um", "pattern.pitch = \"21 um\""]),
        21e-6
    );
    let method = |overrides: &[&str]| with(overrides).unwrap().method;
    assert_eq!(method(&["method.name=homogenised"]), Method::Homogenised);
    let plain = ["method.name=punch", "method.form=plain"];
    assert_eq!(method(&plain), Method::Punch(PunchForm::Plain));
    let accurate = ["method.accuracy=accurate"];
    assert_eq!(method(&accurate), Method::Spectral(Accuracy::Accurate));
    let love = ["method.name=love", "method.mesh=pattern"];
    let pattern = ElementMesh {
        layout: MeshLayout::Pattern,
        ..ElementMesh::default()
    };
    assert_eq!(method(&love), Method::Love(pattern));
    // In any order.
    let accurate = ["method.accuracy=accurate", "method.name=spectral"];
    assert_eq!(method(&accurate), Method::Spectral(Accuracy::Accurate));
}

#[test]
fn overrides_take_bare_quantities() {
    let case = with(&[
        "lens.radius=3 mm",
        "pattern.offset_angle=30deg",
        "substrate.young_modulus=1e9",
    ]);
    let system = case.unwrap().system;
    assert_eq!(system.lens().sphere_radius(), 3e-3);
    assert_eq!(
        system
            .hexagonal_lattice()
            .expect("a hexagonal lattice")
            .offset_angle,
        30f64.to_radians()
    );
    assert_eq!(system.substrate().young_modulus, 1e9);
}

/// Per cent shifts the decimal point, so that "29 %" is exactly the decimal number 0.29.
#[test]
fn fractions_are_taken_in_per_cent() {
    for (text, number) in [("3%", "0.03"), ("29 %", "0.29"), ("0.7 %", "0.007")] {
        let bare = with(&[&format!("pattern.surface_fraction={number}")]).unwrap();
        let given = with(&[&format!("pattern.surface_fraction={text}")]).unwrap();
        assert_eq!(given, bare);
        let example = Case::example().to_toml();
        let line = example
            .lines()
            .find(|line| line.contains("surface_fraction ="))
            .unwrap();
        let file = example.replace(line, &format!("surface_fraction = \"{text}\""));
        assert_eq!(parse(&file), bare);
    }
    let error = with(&["lens.poisson_ratio=50%"]).unwrap_err();
    assert!(error.to_string().contains("expected a number"), "{error}");
    let error = with(&["pattern.surface_fraction=120 %"]).unwrap_err();
    assert!(error.to_string().contains("cannot be 1.2"), "{error}");
}

#[test]
fn the_example_as_written() {
    insta::assert_snapshot!(Case::example().to_toml());
}

proptest! {
    #[test]
    fn a_case_survives_writing_and_reading(
        radius in 1e-4..1e-1_f64,
        modulus in 1e2..1e12_f64,
        ratio in 0.0..0.5_f64,
        diameter in 1e-7..1e-5_f64,
        spacing in 1.0..20.0_f64,
        offset in 0.0..1.0_f64,
        angle in 0.0..3.0_f64,
        by_pitch: bool,
        method in 0..6usize,
    ) {
        let methods = [
            Method::Spectral(Accuracy::Default),
            Method::Spectral(Accuracy::Accurate),
            Method::Punch(PunchForm::Corrected),
            Method::Punch(PunchForm::Plain),
            Method::Love(ElementMesh {
                cells_per_diameter: 24,
                layout: MeshLayout::Pattern,
                matched: false,
            }),
            Method::Homogenised,
        ];
        let spacing = if by_pitch {
            format!("pattern.pitch={:e}", diameter * spacing)
        } else {
            format!("pattern.surface_fraction={}", 0.9 / (spacing * spacing))
        };
        let overrides = [
            format!("lens.radius={radius}"),
            format!("lens.young_modulus={modulus}"),
            format!("substrate.poisson_ratio={ratio}"),
            format!("pattern.pillar.diameter={diameter:e}"),
            format!("pattern.offset={offset}"),
            format!("pattern.offset_angle={angle}"),
            spacing,
        ];
        let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
        let mut case = with(&overrides).unwrap();
        case.method = methods[method];
        prop_assert_eq!(case.system.lens().sphere_radius().to_bits(), radius.to_bits());
        let text = case.to_toml();
        prop_assert_eq!(parse(&text), case.clone());
        prop_assert_eq!(parse(&text).to_toml(), text);
        let by_system = Case::new(case.system, case.method);
        prop_assert_eq!(parse(&by_system.to_toml()), by_system);
    }
}

/// A case that names the columns of its table and the size of a pixel is written with both.
#[test]
fn columns_and_unit_of_a_table_are_written() {
    let folder = tempfile::TempDir::new().unwrap();
    let table = "ID,POSITION_X,POSITION_Y,QUALITY,R\n1,0,0,9,6\n2,40,0,8,6\n";
    std::fs::write(folder.path().join("spots.csv"), table).unwrap();
    let bodies = "lens = { radius = 2e-3, young_modulus = 2e6, poisson_ratio = 0.5 }\n\
                  substrate = { young_modulus = 2e6, poisson_ratio = 0.5 }\n";
    let read = |pattern: &str| {
        let path = folder.path().join("case.toml");
        std::fs::write(
            &path,
            format!("{bodies}[pattern]\npillars = \"spots.csv\"\n{pattern}"),
        )
        .unwrap();
        CaseFile::read(&path).unwrap()
    };
    let columns = "x = POSITION_X, y = POSITION_Y, radius = R";
    let named =
        format!("pillar_columns = \"{columns}\"\npillar_unit = \"0.5 um\"\npillar.height = 2e-6\n");
    let case = read(&named).case().unwrap();
    assert!((case.system.pillar().diameter / 6e-6 - 1.0).abs() < 1e-12);
    let text = case.to_toml();
    assert!(
        text.contains(columns) && text.contains("pillar_unit = \"0.5 um\""),
        "{text}"
    );
    assert_eq!(parse(&text), case);
    // As overrides, and of rounded tops, whose tables in other files have the usual columns.
    let mut file = read(&named);
    file.set("pillar_unit=1um").unwrap();
    assert!((file.case().unwrap().system.pillar().diameter / 12e-6 - 1.0).abs() < 1e-12);
    file.set("top_radius=10um").unwrap();
    let rounded = file.asperity_case().unwrap();
    assert!(rounded.to_toml().contains(columns));
    assert!(
        !rounded
            .to_toml_with_table("pillars.csv")
            .contains("pillar_")
    );
    // On lattices they have no meaning.
    for (setting, place) in [
        (
            "pillar_columns = \"x = 1\"\npillar.height = 2e-6\n",
            "pattern.pillar_columns: the column of y is missing",
        ),
        (
            "pillar_unit = \"0 um\"\n",
            "pattern.pillar_unit: \"0 um\" is no unit of length",
        ),
    ] {
        let error = read(setting).case().unwrap_err().to_string();
        assert!(error.contains(place), "{error}");
    }
    let lattice = "lattice = \"square\"\npitch = 2e-5\npillar_unit = \"um\"\npillar = { diameter = 6e-6, height = 2e-6 }\n";
    let text = format!("{bodies}[pattern]\n{lattice}");
    let error = CaseFile::parse("case.toml", &text).and_then(|file| file.case());
    assert!(error.unwrap_err().to_string().contains("pillar_unit"));
}

/// A table with a height and a diameter for every pillar needs no common values: indentations are measured from the highest pillar, and
/// results are normalised by the mean diameter.
#[test]
fn a_table_of_whole_pillars_needs_no_common_one() {
    let folder = tempfile::TempDir::new().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let read = |case: &str| {
        write("case.toml", case);
        CaseFile::read(&folder.path().join("case.toml")).unwrap()
    };
    let bodies = "lens = { radius = 2e-3, young_modulus = 2e6, poisson_ratio = 0.5 }\n\
                  substrate = { young_modulus = 2e6, poisson_ratio = 0.5 }\n";
    let listed = format!("{bodies}pattern = {{ pillars = \"pillars.csv\" }}\n");
    let rounded = format!("{bodies}pattern = {{ pillars = \"pillars.csv\", top_radius = 1e-5 }}\n");

    write(
        "pillars.csv",
        "x_m,y_m,height_m,diameter_m\n0,0,2e-6,6e-6\n2e-5,0,2.2e-6,4e-6\n",
    );
    let case = read(&listed).case().unwrap();
    assert_eq!(case.system.pillar().height, 2.2e-6);
    assert!((case.system.pillar().diameter / 5e-6 - 1.0).abs() < 1e-15);
    assert_eq!(parse(&case.to_toml()), case);
    let case = read(&rounded).asperity_case().unwrap();
    assert_eq!(case.height, 2.2e-6);
    assert_eq!(case.heights(), [2e-6, 2.2e-6]);
    // Given values are used and must be valid.
    let given = |setting: &str| {
        let mut file = read(&listed);
        file.set(setting).unwrap();
        file.case()
    };
    assert_eq!(
        given("pattern.pillar.height=3um")
            .unwrap()
            .system
            .pillar()
            .height,
        3e-6
    );
    let wrong = given("pattern.pillar.diameter=nan").unwrap_err();
    assert_eq!(wrong.key_path(), Some("pattern.pillar.diameter"));

    // Equal diameters equal the common one exactly, as layers and adhesion require.
    let rows = (0..7).map(|k| format!("{k}e-5,0,1e-6,{:e}\n", 0.1e-6 * 3.0));
    let rows = rows.collect::<String>();
    write(
        "pillars.csv",
        &format!("x_m,y_m,height_m,diameter_m\n{rows}"),
    );
    let case = read(&listed).case().unwrap();
    assert_eq!(case.system.pillar().diameter, 0.1e-6 * 3.0);

    // The error for a missing column names it and the alternatives.
    write("pillars.csv", "x_m,y_m,height_m\n0,0,2e-6\n");
    let message = read(&listed).case().unwrap_err().one_line();
    assert!(
        message.contains("pattern.pillar.diameter: this key is missing"),
        "{message}"
    );
    assert!(message.contains("a column diameter_m in "), "{message}");
    assert!(read(&rounded).asperity_case().is_ok());
    write("pillars.csv", "x_m,y_m,diameter_m\n0,0,2e-6\n");
    let message = read(&rounded).asperity_case().unwrap_err().one_line();
    assert!(message.contains("a column height_m in "), "{message}");
}
