//! Meaning of valid cases with a general surface, and their round trip through writing and reading.

// Numbers are read exactly.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use fakir::problem::pattern::{CrossSection, Pattern, PillarShape, Top};
use fakir::problem::{
    Arrangement, Base, Boundary, Disorder, Floor, HeightMap, Indenter, LatticeForm,
    PillarCompliance, PlaneLattice, RandomPlaces, Scatter,
};
use fakir_case::{CaseError, CaseFile, Key, SurfaceCase, SurfaceOrigin};
use std::path::{Path, PathBuf};

const MEMORY: usize = 100_000_000;

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

fn with(overrides: &[&str]) -> Result<SurfaceCase, CaseError> {
    let mut file = CaseFile::read(&examples().join("square-pillars.toml"))?;
    assert!(file.is_surface());
    for argument in overrides {
        file.set(argument)?;
    }
    file.surface_case(MEMORY)
}

fn pattern(case: &SurfaceCase) -> Pattern {
    match &case.origin {
        SurfaceOrigin::Pattern(pattern) => pattern.clone(),
        SurfaceOrigin::HeightMap(path) => panic!("{}", path.display()),
    }
}

fn survives(case: &SurfaceCase) {
    let text = case.to_toml();
    let file = CaseFile::parse("case.toml", &text).unwrap();
    let again = file.surface_case(MEMORY).unwrap();
    assert_eq!(again.system, case.system);
    assert_eq!(again.system.floor(), case.system.floor());
    assert_eq!(again.to_toml(), text);
}

#[test]
fn square_pillars() {
    let case = with(&[]).unwrap();
    let found = pattern(&case);
    assert_eq!(
        found.pillar.cross_section,
        CrossSection::Square { side: 6e-6 }
    );
    assert_eq!(found.pillar.height, 0.5e-6);
    assert_eq!(found.pillar.compliance, PillarCompliance::Column);
    assert!((found.surface_fraction() - 0.2).abs() < 1e-15);
    assert_eq!(case.system.floor(), Some(Floor::OffPillars));
    assert_eq!(case.system.boundary(), Boundary::FreeSpace);
    let surface = case.system.surface();
    // Cells of a sixteenth of the side; the next multiple of four of them beyond 160 um.
    assert_eq!(surface.grid().cell(), [6e-6 / 16.0; 2]);
    assert_eq!(surface.grid().columns(), 428);
    assert_eq!(surface.highest(), 0.5e-6);
    // The pillar on the lens axis is complete.
    let tops = surface.grid().centres().zip(surface.heights());
    let central = tops.filter(|([x, y], height)| x.hypot(*y) < 5e-6 && **height > 0.0);
    assert_eq!(central.count(), 256);
    survives(&case);
}

#[test]
fn every_form_top_and_arrangement() {
    let case = with(&[
        "surface.arrangement=hexagonal",
        "surface.offset=0.5",
        "surface.offset_angle=30deg",
        "surface.pillar.cross_section=polygon",
        "surface.pillar.sides=6",
        "surface.pillar.diameter=6um",
        "surface.pillar.orientation=15deg",
        "surface.pillar.top=chamfer",
        "surface.pillar.chamfer_width=1um",
        "surface.pillar.drop=0.1um",
        "surface.pillar.compliance=none",
        "surface.pitch=15um",
        "surface.vacancy_fraction=0.1",
        "surface.height_half_width=0.2",
        "surface.seed=7",
        "surface.grid.cells_per_diameter=8",
        "surface.floor=10nm",
    ])
    .unwrap();
    let expected = Pattern {
        pillar: PillarShape {
            cross_section: CrossSection::Polygon {
                sides: 6,
                diameter: 6e-6,
            },
            orientation: 15f64.to_radians(),
            height: 0.5e-6,
            top: Top::Chamfer {
                width: 1e-6,
                drop: 1e-7,
            },
            compliance: PillarCompliance::None,
        },
        arrangement: Arrangement::Lattice(PlaneLattice {
            offset: 0.5,
            offset_angle: 30f64.to_radians(),
            disorder: Disorder {
                heights: Scatter::uniform(0.2, 7),
                missing: 0.1,
            },
            ..PlaneLattice::new(LatticeForm::Hexagonal { pitch: 15e-6 })
        }),
    };
    assert_eq!(pattern(&case), expected);
    assert_eq!(case.system.floor(), Some(Floor::AtOrBelow(10e-9)));
    survives(&case);

    let case = with(&[
        "surface.arrangement=random",
        "surface.pillar.cross_section=ellipse",
        "surface.pillar.length=8um",
        "surface.pillar.width=4um",
        "surface.pillar.top=rounded",
        "surface.pillar.edge_radius=0.2um",
        "surface.indenter=plate",
        "surface.boundary=periodic",
    ])
    .unwrap();
    let found = pattern(&case);
    // By default the distance of pillars is at least their length.
    let area = found.pillar.cross_section.area();
    let places = RandomPlaces {
        disorder: Disorder {
            heights: Scatter::uniform(0.0, 0),
            missing: 0.0,
        },
        ..RandomPlaces::with_surface_fraction(0.2, area, 8e-6)
    };
    assert_eq!(found.arrangement, Arrangement::Random(places));
    assert_eq!(found.pillar.top, Top::Rounded { radius: 0.2e-6 });
    assert!(matches!(case.system.indenter(), Indenter::Flat(Some(_))));
    survives(&case);
}

#[test]
fn a_choice_replaces_the_keys_of_the_others() {
    let cone = ["surface.pillar.top=cone", "surface.pillar.drop=0.1um"];
    let chamfer = [
        "surface.pillar.top=chamfer",
        "surface.pillar.chamfer_width=1um",
    ];
    let text = with(&cone).unwrap().to_toml();
    let mut file = CaseFile::parse("case.toml", &text).unwrap();
    for argument in chamfer {
        file.set(argument).unwrap();
    }
    // The key `drop` is accepted with a chamfer too.
    let case = file.surface_case(MEMORY).unwrap();
    let top = Top::Chamfer {
        width: 1e-6,
        drop: 1e-7,
    };
    assert_eq!(pattern(&case).pillar.top, top);
    file = CaseFile::parse("case.toml", &text).unwrap();
    file.set("surface.pillar.top=flat").unwrap();
    assert_eq!(
        pattern(&file.surface_case(MEMORY).unwrap()).pillar.top,
        Top::Flat
    );
}

/// Fraction of the cells covered by pillars.
fn filled(case: &SurfaceCase) -> f64 {
    let heights = case.system.surface().heights();
    heights.iter().filter(|height| **height > 0.0).count() as f64 / heights.len() as f64
}

#[test]
fn a_periodic_lattice_is_whole() {
    for (arrangement, period) in [("square", [1.0, 1.0]), ("hexagonal", [3f64.sqrt(), 1.0])] {
        for offset in ["0", "0.3", "-2.7"] {
            let case = with(&[
                &format!("surface.arrangement={arrangement}"),
                "surface.pitch=15um",
                &format!("surface.offset={offset}"),
                "surface.offset_angle=20deg",
                "surface.boundary=periodic",
                "surface.grid.width=60um",
            ])
            .unwrap();
            let surface = case.system.surface();
            let grid = surface.grid();
            let counts = [grid.columns(), grid.rows()];
            let mut cells = 1.0;
            for axis in 0..2 {
                let side = counts[axis] as f64 * grid.cell()[axis];
                let periods = side / (15e-6 * period[axis]);
                assert!((periods - periods.round()).abs() < 1e-9, "{side}");
                assert!((side - 60e-6).abs() <= 0.5 * period[axis] * 15e-6);
                cells *= periods.round();
                // The lens axis is inside, near the centre.
                let centre = grid.origin()[axis] + 0.5 * side;
                assert!(centre.abs() <= (0.5 + 1e-9) * period[axis] * 15e-6);
            }
            // As many pillars as in whole cells of the lattice, each drawn as one: a hexagonal
            // period has two.
            let pillars = surface.pillars().unwrap().compliance.len();
            let per_period = if arrangement == "square" { 1.0 } else { 2.0 };
            assert_eq!(pillars as f64, per_period * cells);
            let expected = pattern(&case).surface_fraction();
            assert!(
                (filled(&case) / expected - 1.0).abs() < 0.07,
                "{arrangement} {offset}"
            );
        }
    }
}

/// A case with the height map that NumPy wrote as text.
fn map(more: &str) -> CaseFile {
    let text = format!(
        "lens = {{ radius = 1e-3, young_modulus = 2e6, poisson_ratio = 0.5 }}\n\
         substrate = {{ young_modulus = 2e6, poisson_ratio = 0.5 }}\n\
         [surface]\nheight_map = 'tests/height_maps/savetxt.txt'\n{more}"
    );
    CaseFile::parse("case.toml", &text).unwrap()
}

#[test]
fn a_height_map_has_its_size_and_unit() {
    // Three rows of four columns, `10 row + column` units.
    let height = |surface: &HeightMap| surface.highest();
    let case = map("cell_size = \"2 um\"").surface_case(MEMORY).unwrap();
    assert_eq!(height(case.system.surface()), 23.0);
    assert_eq!(case.system.surface().grid().cell(), [2e-6; 2]);
    assert_eq!(case.system.floor(), None);
    let case = map("width = \"2 um\"\nheight_unit = \"1 nm\"\nfloor = \"5 nm\"");
    let case = case.surface_case(MEMORY).unwrap();
    assert!((height(case.system.surface()) - 23e-9).abs() < 1e-20);
    assert_eq!(case.system.surface().grid().cell(), [0.5e-6; 2]);
    assert_eq!(case.system.floor(), Some(Floor::AtOrBelow(5e-9)));
    survives(&case);
}

/// Heights up to 23 on a map of 8 um cannot be in metres, millimetres or micrometres.
#[test]
fn absurd_heights_are_refused_with_the_unit_that_was_meant() {
    let refused = |more: &str| {
        let file = map(more);
        let case = file.surface_case(MEMORY).unwrap();
        file.refuse_absurd_heights(&case).err()
    };
    let error = refused("cell_size = \"2 um\"").unwrap();
    assert_eq!(error.key_path(), Some(Key::HeightMap.path()));
    assert!(
        error
            .problem()
            .starts_with("heights differ by 23 m on a map of 8 um"),
        "{error}"
    );
    let meant = error.what_is_accepted().unwrap();
    assert_eq!(meant, "did you mean surface.height_unit = \"1 nm\"?");
    let error = refused("cell_size = \"200 um\"\nheight_unit = \"1 m\"").unwrap();
    assert_eq!(error.key_path(), Some(Key::HeightUnit.path()));
    let meant = error.what_is_accepted().unwrap();
    assert!(meant.contains("= \"1 um\" or \"1 nm\"?"), "{meant}");
    let error = refused("cell_size = \"2 um\"\nheight_unit = 1e-15").unwrap();
    assert!(error.what_is_accepted().unwrap().contains("\"1 nm\""));
    // Metres taken for micrometres: 2.3 pm are less than an atom.
    let error = refused("cell_size = \"2 um\"\nheight_unit = \"0.0001 nm\"").unwrap();
    assert!(
        error.problem().starts_with("heights differ by 0.0023 nm"),
        "{error}"
    );
    for fine in ["1 nm", "-1 nm", "0.1 um"] {
        let more = format!("cell_size = \"2 um\"\nheight_unit = \"{fine}\"");
        assert!(refused(&more).is_none(), "{fine}");
    }
}

/// Numbers that programs write for missing points, and a unit of the file that cannot be.
#[test]
fn markers_of_missing_points_and_wrong_units_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.txt");
    let refused = |text: &str, more: &str| {
        std::fs::write(&path, text).unwrap();
        let mut file = map(more);
        file.set(&format!("surface.height_map={}", path.display()))
            .unwrap();
        let case = file.surface_case(MEMORY).unwrap();
        let error = file.refuse_absurd_heights(&case).err()?;
        Some((
            error.problem().to_owned(),
            error.what_is_accepted()?.to_owned(),
        ))
    };
    let given = "cell_size = \"1 um\"\nheight_unit = \"1 nm\"";
    for (marker, shown) in [
        ("-9999", "-9999"),
        ("-32768", "-32768"),
        ("1.70141E+38", "1.7014e38"),
    ] {
        let (problem, _) = refused(&format!("1 2 {marker}\n3 4 {marker}\n"), given).unwrap();
        let expected = format!("the number {shown} is in the file in several points");
        assert!(problem.starts_with(&expected), "{problem}");
    }
    // Two heights alone, and heights down to such a number.
    assert_eq!(
        refused(
            "0 9999\n0 9999\n",
            "cell_size = \"10 um\"\nheight_unit = \"1 nm\""
        ),
        None
    );
    assert_eq!(
        refused(
            "-9999 -8000\n-5000 0\n",
            "cell_size = \"10 um\"\nheight_unit = \"1 nm\""
        ),
        None
    );
    let heading = "# Width: 8 um\n# Height: 6 um\n# Value units: m\n";
    let (problem, accepted) = refused(&format!("{heading}1 2\n3 4\n"), "").unwrap();
    assert!(problem.starts_with("heights differ by 3 m"), "{problem}");
    assert!(
        accepted.contains("the file states this unit, which looks wrong"),
        "{accepted}"
    );
}

/// A size that the file states need not be given, and one that contradicts it is refused at its key.
#[test]
fn a_height_map_may_state_its_size() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.txt");
    let heading = "# Width: 8 um\n# Height: 6 um\n# Value units: m\n";
    std::fs::write(
        &path,
        format!("{heading}0 1e-9\t0 1e-9\n0 0 0 0\n0 0 0 1e-9\n"),
    )
    .unwrap();
    let with_size = |more: &str| {
        let mut file = map(more);
        file.set(&format!("surface.height_map={}", path.display()))
            .unwrap();
        file.surface_case(MEMORY)
    };
    let case = with_size("").unwrap();
    assert_eq!(case.system.surface().grid().cell(), [2e-6; 2]);
    survives(&case);
    for (more, key) in [
        ("cell_size = \"1 um\"", Key::CellSize),
        ("width = \"8 mm\"", Key::MapWidth),
        ("height_unit = \"1 um\"", Key::HeightUnit),
    ] {
        let error = with_size(more).unwrap_err();
        assert_eq!(error.key_path(), Some(key.path()), "{error}");
        assert!(error.problem().contains("states a"), "{error}");
    }
}

#[test]
fn height_maps_are_sought_next_to_the_case_file() {
    let folder = tempfile::tempdir().unwrap();
    let package = env!("CARGO_MANIFEST_DIR");
    std::fs::copy(
        Path::new(package).join("tests/height_maps/savetxt.txt"),
        folder.path().join("map.txt"),
    )
    .unwrap();
    let text = map("cell_size = 1e-6")
        .surface_case(MEMORY)
        .unwrap()
        .to_toml();
    let line = text
        .lines()
        .find(|line| line.starts_with("height_map"))
        .unwrap();
    let text = text.replace(line, "height_map = \"map.txt\"");
    let path = folder.path().join("case.toml");
    std::fs::write(&path, text).unwrap();
    let mut file = CaseFile::read(&path).unwrap();
    let case = file.surface_case(MEMORY).unwrap();
    assert_eq!(
        case.origin,
        SurfaceOrigin::HeightMap(folder.path().join("map.txt"))
    );
    survives(&case);
    // A path in an override is relative to the current folder.
    file.set("surface.height_map=tests/height_maps/savetxt.txt")
        .unwrap();
    assert!(file.surface_case(MEMORY).is_ok());
}

#[test]
fn the_error_of_a_surface_too_large_for_memory_states_what_fits() {
    let error = with(&["surface.grid.cells_per_diameter=200"]).unwrap_err();
    assert_eq!(error.key_path(), Some(Key::GridWidth.path()));
    // 5334 by 5334 cells, at least 64 bytes each: 4.3 times too fine.
    assert!(
        error
            .to_string()
            .contains("a grid of 5336 by 5336 cells takes 1.82 GB"),
        "{error}"
    );
    assert!(error.what_is_accepted().unwrap().contains("4.3 times"));
    assert!(with(&["surface.grid.cells_per_diameter=46"]).is_ok());
    let error = map("cell_size = 1e-6").surface_case(500).unwrap_err();
    assert_eq!(error.key_path(), Some(Key::HeightMap.path()));
    // 64 bytes a point: the second row of four is one too many.
    assert!(
        error.to_string().contains("a map of 8 points or more"),
        "{error}"
    );
}

#[test]
fn a_height_map_that_cannot_be_read_is_named() {
    let mut file = map("cell_size = 1e-6");
    file.set("surface.height_map=no/such/map.npy").unwrap();
    let error = file.surface_case(MEMORY).unwrap_err();
    let wanted = "surface.height_map: cannot read no/such/map.npy: ";
    assert!(error.to_string().starts_with(wanted), "{error}");
    assert_eq!(error.position(), Some((1, 20)));
}

/// Bodies of finite thickness, as they are given.
#[test]
fn layers_are_those_of_the_keys() {
    let case = with(&[
        "substrate.thickness=5um",
        "lens.thickness=50um",
        "lens.base=frictionless",
    ]);
    let case = case.unwrap();
    let [film, lens] = case.system.layers().map(Option::unwrap);
    assert_eq!((film.thickness, film.base), (5e-6, Base::Rigid));
    assert_eq!((lens.thickness, lens.base), (50e-6, Base::Frictionless));
    let written = CaseFile::parse("written.toml", &case.to_toml()).unwrap();
    let again = written.surface_case(MEMORY).unwrap();
    assert_eq!(again.system.layers(), case.system.layers());
}

/// Questions that are not supported on a surface are refused at their position, in the file or in
/// an override.
#[test]
fn bases_without_a_thickness_are_refused() {
    for (setting, words) in [
        (
            "substrate.base=frictionless",
            "substrate.base: only a body of finite thickness",
        ),
        (
            "surface.array=heights",
            "surface.array: only a height map has this key",
        ),
    ] {
        let message = with(&[setting]).unwrap_err().one_line();
        assert!(
            message.starts_with("--set:1:") && message.contains(words),
            "{message}"
        );
        assert!(message.contains("leave"), "{message}");
    }
    let map = "lens = { radius = 1e-3, young_modulus = 2e6, poisson_ratio = 0.5 }\n\
               substrate = { young_modulus = 2e6, poisson_ratio = 0.5 }\n\
               surface = { height_map = 'tests/height_maps/savetxt.txt', array = 'heights', cell_size = 1e-6 }";
    let file = CaseFile::parse("case.toml", map).unwrap();
    let message = file.surface_case(MEMORY).unwrap_err().one_line();
    assert!(
        message.contains("surface.array: only .npz files have named arrays"),
        "{message}"
    );
}
