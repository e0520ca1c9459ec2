//! Designs of height maps, against laws of scaling and contacts that are solved again.

use fakir::problem::Load;
use fakir::state::Run;
use fakir_case::{CaseFile, Key};
use fakir_inverse::design::{Answer, Design, DesignError, Reached, Wanted, design, free_key};

/// Square pillars without columns under a rigid lens, so that all forces are in proportion to one modulus.
const SQUARES: &str = "[lens]\nradius = \"1 mm\"\nyoung_modulus = \"1e9 GPa\"\npoisson_ratio = 0.5\n\
                       [substrate]\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n\
                       [surface]\narrangement = \"square\"\npitch = \"12 um\"\n\
                       [surface.pillar]\ncross_section = \"square\"\nside = \"6 um\"\nheight = \"0.2 um\"\ncompliance = \"none\"\n\
                       [surface.grid]\ncells_per_diameter = 6\nwidth = \"80 um\"\n";

fn file(overrides: &[&str]) -> CaseFile {
    let mut file = CaseFile::parse("squares.toml", SQUARES).unwrap();
    for argument in overrides {
        file.set(argument).unwrap();
    }
    file
}

/// The result of a search that must not fail.
pub(crate) fn answer(file: &CaseFile, free: Key, wanted: Wanted) -> Answer {
    let design = design(file, free, wanted, &Run::default()).unwrap();
    Answer {
        free,
        wanted,
        design,
    }
}

fn critical_force(file: &CaseFile) -> f64 {
    let case = file.surface_case(1_000_000_000).unwrap();
    case.system
        .transition(&Run::default())
        .unwrap()
        .contact
        .force
}

/// Forces on half-spaces are in proportion to the modulus, whatever the cells.
#[test]
fn a_modulus_follows_from_its_proportion() {
    let force = critical_force(&file(&[]));
    let found = answer(
        &file(&[]),
        Key::SubstrateYoungModulus,
        Wanted::Force(1.7 * force),
    );
    let Design::Found {
        candidate,
        sensitivity,
    } = &found.design
    else {
        panic!("{:?}", found.design);
    };
    let error = found.error().unwrap();
    assert!(
        (candidate.value / 3.4e6 - 1.0).abs() < 0.1 * error.max(1e-9),
        "{} {error}",
        candidate.value
    );
    assert!((sensitivity - 1.0).abs() < 1e-6, "{sensitivity}");
    assert!(matches!(candidate.reached, Reached::CriticalOnMap(_)));
    assert!(
        found.statement().contains("substrate.young_modulus = 3.4"),
        "{}",
        found.statement()
    );
}

/// The height at which the critical force is that of a known height, and the radius of a lens, within the stated errors.
#[test]
fn heights_and_radii_are_found_again() {
    let cells = "surface.grid.cells_per_diameter=12";
    let force = critical_force(&file(&[cells]));
    for (free, start, truth) in [
        (Key::PatternHeight, "surface.pillar.height=0.3 um", 0.2e-6),
        (Key::LensRadius, "lens.radius=0.8 mm", 1e-3),
    ] {
        let found = answer(&file(&[cells, start]), free, Wanted::Force(force));
        let Design::Found { candidate, .. } = &found.design else {
            panic!("{free}: {:?}", found.design);
        };
        let error = found.error().unwrap();
        // With 3, 6 and 12 cells across a pillar.
        assert!(error < 0.3, "{free}: {error}");
        assert!(
            (candidate.value / truth - 1.0).abs() < error,
            "{free}: {} {error}",
            candidate.value
        );
    }
}

/// A fraction of the load on the floor under an indentation does not depend on the modulus, but on the height; the contact at the found height has it.
#[test]
fn a_floor_share_is_met_within_its_error() {
    let load = Load::Indentation(1.2e-6);
    let truth = file(&[]).surface_case(1_000_000_000).unwrap();
    let contact = truth.system.press(load, &Run::default()).unwrap();
    let share = contact.shares.unwrap().floor.force / contact.force;
    assert!(share > 0.01 && share < 0.9, "{share}");
    let wanted = Wanted::FloorShare { share, load };
    let found = answer(
        &file(&["surface.pillar.height=0.25 um"]),
        Key::PatternHeight,
        wanted,
    );
    let Design::Found { candidate, .. } = &found.design else {
        panic!("{:?}", found.design);
    };
    let [reached, error] = candidate.reached.floor_share().unwrap();
    assert!(
        (reached / share - 1.0).abs() <= 1.5 * error,
        "{reached} {share} {error}"
    );
    assert!((candidate.value / 0.2e-6 - 1.0).abs() < found.error().unwrap());
}

#[test]
fn what_height_maps_do_not_have_is_refused() {
    let refused =
        |file: &CaseFile, free, wanted| design(file, free, wanted, &Run::default()).unwrap_err();
    let pitch = refused(&file(&[]), Key::Pitch, Wanted::Force(1e-3));
    assert!(
        matches!(
            pitch,
            DesignError::NotGiven(Key::Pitch) | DesignError::NotFree(Key::Pitch)
        ),
        "{pitch}"
    );
    let pull_off = Wanted::PullOff {
        force: 1e-6,
        load: Load::FloorContact,
    };
    let pull_off = refused(&file(&[]), Key::PatternHeight, pull_off);
    assert!(matches!(pull_off, DesignError::NoAdhesion), "{pull_off}");
    let plate = refused(
        &file(&["surface.indenter=plate"]),
        Key::PatternHeight,
        Wanted::ContactRadius(1e-5),
    );
    assert!(!plate.to_string().is_empty(), "{plate}");
    // The last name of a key remains that of a pattern.
    assert_eq!(free_key("pitch"), Ok(Key::Pitch));
    assert_eq!(free_key("surface.pitch"), Ok(Key::PatternPitch));
    assert_eq!(free_key("height_unit"), Ok(Key::HeightUnit));
}
