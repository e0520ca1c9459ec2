//! Cases with rounded pillar tops.

use fakir::problem::{Accuracy, Base, Indenter, Material, PillarCompliance, ShapedLens};
use fakir_case::{AsperityCase, CaseFile};

const PLATE: &str = r#"
[lens]
shape = "plate"
young_modulus = "70 GPa"
poisson_ratio = 0.22

[substrate]
young_modulus = "1.5 MPa"
poisson_ratio = 0.5
"#;

const SITES: &str = r#"
[pattern]
lattice = "square"
pitch = "1.5 mm"
columns = 3
top_radius = "526 um"

[pattern.pillar]
height = "200 um"
"#;

fn file(text: &str) -> CaseFile {
    CaseFile::parse("case.toml", text).unwrap()
}

fn rounded(text: &str) -> AsperityCase {
    file(text).asperity_case().unwrap()
}

fn refused(text: &str) -> String {
    let error = file(text).asperity_case().unwrap_err();
    error.one_line()
}

#[test]
fn a_lattice_of_asperities_under_a_plate() {
    let case = rounded(&format!("{PLATE}{SITES}"));
    assert_eq!(case.accuracy, Accuracy::Default);
    assert!(matches!(case.field.indenter(), Indenter::Flat(Some(_))));
    let asperities = case.field.asperities();
    assert_eq!(asperities.len(), 9);
    for asperity in asperities {
        assert!(
            asperity.rim_radius.is_none() && asperity.column_compliance.abs() < f64::MIN_POSITIVE
        );
        assert!((asperity.top_radius - 526e-6).abs() < 1e-18 && asperity.raised.abs() < 1e-18);
    }
    let farthest = asperities
        .iter()
        .map(|asperity| asperity.apex[0].hypot(asperity.apex[1]))
        .fold(0.0, f64::max);
    assert!((farthest / (1.5e-3 * 2f64.sqrt()) - 1.0).abs() < 1e-14);
    let again = rounded(&case.to_toml());
    assert_eq!(again, case);
}

/// Pillars with a diameter have a rim and the compliance of columns, 4 h/(pi E d^2).
#[test]
fn pillars_with_a_diameter_have_a_rim_and_a_column() {
    let with_rim = format!("{PLATE}{SITES}diameter = \"400 um\"\n");
    let asperity = rounded(&with_rim).field.asperities()[0];
    assert_eq!(
        asperity.rim_radius.map(f64::to_bits),
        Some(200e-6f64.to_bits())
    );
    let column = 4.0 * 200e-6 / (std::f64::consts::PI * 1.5e6 * 400e-6f64.powi(2));
    assert!((asperity.column_compliance / column - 1.0).abs() < 1e-14);
    // A higher pillar is more compliant.
    let heights = vec![50e-6; 9];
    let raised = rounded(&with_rim).with_heights(&heights).unwrap();
    let asperity = raised.field.asperities()[0];
    assert!((asperity.column_compliance / column - 1.25).abs() < 1e-12);
    let stiff = rounded(&format!("{with_rim}compliance = \"none\"\n"));
    assert!(stiff.field.asperities()[0].column_compliance.abs() < f64::MIN_POSITIVE);
}

#[test]
fn heights_in_a_table_are_read_again_to_the_bit() {
    let folder = std::env::temp_dir().join(format!("fakir-rounded-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let case = rounded(&format!("{PLATE}{SITES}"));
    let heights: Vec<f64> = (0..9).map(|k| -1e-5 * f64::from(k).sqrt()).collect();
    let made = case.with_heights(&heights).unwrap();
    std::fs::write(folder.join("pillars.csv"), made.pillar_table()).unwrap();
    let path = folder.join("case.toml");
    std::fs::write(&path, made.to_toml_with_table("pillars.csv")).unwrap();
    let again = CaseFile::read(&path).unwrap().asperity_case().unwrap();
    for (one, other) in made.field.asperities().iter().zip(again.field.asperities()) {
        assert!((one.raised - other.raised).abs() < 1e-19);
        assert_eq!(one.apex.map(f64::to_bits), other.apex.map(f64::to_bits));
    }
    // The error for an overlap names the lines of the table.
    let table = "x_m,y_m,height_m,diameter_m\n0,0,1e-4,4e-4\n1e-4,0,1e-4,4e-4\n";
    std::fs::write(folder.join("pillars.csv"), table).unwrap();
    let message = CaseFile::read(&path).unwrap().asperity_case().unwrap_err();
    assert!(
        message
            .one_line()
            .contains("line 3: this pillar overlaps with that of line 2")
    );
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn what_rounded_tops_do_not_have_is_refused() {
    let with = |more: &str| refused(&format!("{PLATE}{SITES}{more}"));
    let set = |setting: &str| {
        let mut file = file(&format!("{PLATE}{SITES}"));
        file.set(setting).unwrap();
        file.asperity_case().unwrap_err().one_line()
    };
    for (message, words) in [
        (
            with("[adhesion]\nwork = \"-50 mJ/m2\"\n"),
            "adhesion.work: ",
        ),
        (
            with("[adhesion]\nwork = \"50 mJ/m2\"\nfloor = true\n"),
            "adhesion.floor: floor contact is not computed under rounded tops for a cylinder or a plate",
        ),
        (
            with("[adhesion]\nwork_receding = \"50 mJ/m2\"\n"),
            "adhesion.work_receding: rounded pillar tops support one work of adhesion",
        ),
        (
            set("substrate.base_young_modulus=1MPa"),
            "substrate.base_young_modulus: ",
        ),
        (
            with("[method]\nname = \"punch\"\n"),
            "has flat pillar tops only",
        ),
        (
            with("compliance = \"column\"\n"),
            "pattern.pillar.diameter: this key is missing",
        ),
        (
            with("compliance = \"elastic\"\n"),
            "is that of a top in contact as a whole",
        ),
        (
            set("pattern.top_radius=-1um"),
            "pattern.top_radius: cannot be",
        ),
        (
            set("pattern.columns=9999"),
            "too many pillars with rounded tops",
        ),
        (
            set("pattern.surface_fraction=0.1"),
            "pattern.pillar.diameter: this key is missing",
        ),
        (
            set("lens.radius=1mm"),
            "with lens.shape = \"plate\" there is no such key",
        ),
        (
            refused(&format!("{PLATE}{}", SITES.replace("columns = 3\n", ""))),
            "pattern.columns: this key is missing",
        ),
        (
            refused(&format!(
                "{PLATE}{}",
                SITES.replace("height = \"200 um\"\n", "")
            )),
            "pattern.pillar.height: this key is missing",
        ),
    ] {
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn adhesion_is_read_and_written() {
    let text = format!("{PLATE}{SITES}[adhesion]\nwork = \"50 mJ/m2\"\n");
    let case = file(&text).asperity_case().unwrap();
    assert_eq!(case.field.adhesion().work.to_bits(), 50e-3_f64.to_bits());
    let again = file(&case.to_toml()).asperity_case().unwrap();
    assert_eq!(again.field, case.field);
    let heights: Vec<f64> = case.field.asperities().iter().map(|it| it.raised).collect();
    let same = case.with_heights(&heights).unwrap();
    assert_eq!(same.field.adhesion(), case.field.adhesion());
}

/// A case as a file gives the same lens, of every shape, and a level plate is one without a tilt.
#[test]
fn lenses_of_every_shape_are_read_and_written() {
    for (lens, name) in [
        (
            "radius = \"9 mm\"\nshape = \"paraboloid\"\n",
            Some("paraboloid"),
        ),
        (
            "radius = \"9 mm\"\nshape = \"cylinder\"\nangle = \"20 deg\"\n",
            Some("cylinder"),
        ),
        (
            "shape = \"plate\"\ntilt = \"1 deg\"\ntilt_direction = \"30 deg\"\n",
            Some("plate"),
        ),
        ("shape = \"plate\"\n", None),
    ] {
        let bodies = "young_modulus = \"70 GPa\"\npoisson_ratio = 0.22\n[substrate]\nyoung_modulus = \"1.5 MPa\"\npoisson_ratio = 0.5\n";
        let case = rounded(&format!("[lens]\n{lens}{bodies}{SITES}"));
        let found = case.field.indenter().lens();
        assert_eq!(found.map(ShapedLens::shape_name), name);
        assert_eq!(case.lens_settings().is_empty(), name.is_none());
        let again = rounded(&case.to_toml());
        assert_eq!(again.field, case.field);
        let text = made_of(&case).to_toml();
        for key in ["shape", "tilt = ", "angle = ", "radius = "] {
            let given = lens.contains(&format!("\n{key}")) || lens.starts_with(key);
            let table = text.split("[substrate]").next().unwrap();
            assert_eq!(table.contains(&format!("\n{key}")), given, "{key}: {text}");
        }
    }
}

/// The same case made of an array, without a file.
fn made_of(case: &AsperityCase) -> AsperityCase {
    let made = AsperityCase::new(
        case.field.clone(),
        case.accuracy,
        case.height,
        PillarCompliance::None,
        case.lens_settings().to_vec(),
    );
    made.unwrap()
}

/// Both bodies can be layers, also those of a case made of an array; a base without a thickness is refused.
#[test]
fn layers_are_those_of_the_keys() {
    let substrate = "thickness = \"0.4 mm\"\nbase = \"elastic\"\nbase_young_modulus = \"3 MPa\"\nbase_poisson_ratio = 0.3\n";
    let of = |lens: &str| {
        let bodies = format!(
            "young_modulus = \"70 GPa\"\npoisson_ratio = 0.22\nthickness = \"2 mm\"\nbase = \"frictionless\"\n[substrate]\nyoung_modulus = \"1.5 MPa\"\npoisson_ratio = 0.5\n{substrate}"
        );
        rounded(&format!("[lens]\n{lens}{bodies}{SITES}"))
    };
    for lens in ["radius = \"9 mm\"\n", "shape = \"plate\"\n"] {
        let case = of(lens);
        let [film, of_lens] = case.field.layers().map(Option::unwrap);
        assert!((film.thickness - 0.4e-3).abs() < 1e-15);
        assert!((of_lens.thickness - 2e-3).abs() < 1e-15);
        assert_eq!(of_lens.base, Base::Frictionless);
        let soft = Material::new(3e6, 0.3);
        assert_eq!(film.base, Base::Elastic(soft));
        assert_eq!(rounded(&case.to_toml()).field, case.field);
        let made = made_of(&case);
        assert_eq!(made.field.layers(), case.field.layers());
        let text = made.to_toml();
        assert_eq!(text.matches("\nthickness = ").count(), 2, "{text}");
        assert_eq!(text.matches("\nbase_young_modulus = ").count(), 1);
    }
}

/// All computations of flat tops use `case`.
#[test]
fn flat_tops_are_not_computed_in_their_place() {
    let message = |text: &str| file(text).case().unwrap_err().one_line();
    let both = message(&format!("{PLATE}{SITES}diameter = \"400 um\"\n"));
    assert!(
        both.contains("pattern.top_radius: this is computed for flat pillar tops only"),
        "{both}"
    );
    assert!(both.contains("`press`"), "{both}");
}
