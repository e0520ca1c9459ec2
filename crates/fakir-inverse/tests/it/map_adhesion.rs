//! Designs of adhesive height maps, against closed forms and cycles of flat surfaces.

use crate::map_design::answer;
use fakir::problem::Load;
use fakir::state::Run;
use fakir_case::{CaseFile, Key};
use fakir_inverse::design::{Design, PressedQuantity, PulledOff, Reached, Wanted};
use std::f64::consts::PI;
use std::fmt::Write;

/// A sphere on a flat map of 48 by 48 cells.
fn flat(cell: &str, overrides: &[&str]) -> CaseFile {
    let text = format!(
        "[lens]\nshape = \"paraboloid\"\nradius = \"0.2 mm\"\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n\
         [substrate]\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n[adhesion]\nwork = \"30 mJ/m2\"\n\
         [surface]\nheight_map = \"map.txt\"\nheight_unit = \"1 um\"\ncell_size = \"{cell}\"\n"
    );
    let mut rows = String::new();
    for _ in 0..48 {
        writeln!(rows, "{}", "0 ".repeat(48)).unwrap();
    }
    let mut file = CaseFile::parse("map.toml", &text).unwrap();
    for argument in overrides {
        file.set(argument).unwrap();
    }
    file.with_table("map.txt", rows.as_bytes())
}

/// F = -3/2 pi w R (Johnson, Kendall, Roberts, Proc. R. Soc. A 324, 301 (1971)): the work of adhesion, and the lens radius, of a pull-off force.
#[test]
#[ignore = "slow: cycles on cells"]
fn a_work_of_adhesion_follows_from_a_pull_off_force() {
    let wanted = Wanted::PullOff {
        force: 1.5 * PI * 50e-3 * 0.2e-3,
        load: Load::Indentation(0.2e-6),
    };
    for (free, truth, start) in [
        (Key::WorkOfAdhesion, 50e-3, "adhesion.work=30 mJ/m2"),
        (Key::LensRadius, 0.2e-3, "adhesion.work=50 mJ/m2"),
    ] {
        let start = [start, "lens.radius=0.15 mm"];
        let start = match free {
            Key::LensRadius => &start[..],
            _ => &start[..1],
        };
        let found = answer(&flat("1.4 um", start), free, wanted);
        let Design::Found {
            candidate,
            sensitivity,
        } = &found.design
        else {
            panic!("{:?}", found.design);
        };
        let error = found.error().unwrap();
        println!("{free}: {} {error} {sensitivity}", candidate.value);
        assert!((candidate.value / truth - 1.0).abs() < error, "{free}");
        assert!(error < 0.4 && (sensitivity - 1.0).abs() < 0.3, "{free}");
        let Some(PulledOff { force, error }) = candidate.reached.pull_off() else {
            panic!("no pull-off");
        };
        assert!((-force / wanted.value() - 1.0).abs() <= error);
        assert!(matches!(candidate.reached, Reached::PulledOffOnMap(_)));
    }
}

/// The force at an indentation is that of the same sphere on a flat surface, whose modulus is found again within the error.
#[test]
fn a_modulus_follows_from_an_adhesive_force() {
    let load = Load::Indentation(0.5e-6);
    let bare = "[lens]\nshape = \"paraboloid\"\nradius = \"0.2 mm\"\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n\
                [substrate]\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n[adhesion]\nwork = \"5 mJ/m2\"\n";
    let exact = CaseFile::parse("flat.toml", bare).unwrap();
    let exact = exact.flat_case().unwrap();
    let force = exact.system.press(load, &Run::default()).unwrap().force;
    let file = flat(
        "1.2 um",
        &["adhesion.work=5 mJ/m2", "substrate.young_modulus=1.2 MPa"],
    );
    let wanted = Wanted::Pressed {
        quantity: PressedQuantity::Force,
        value: force,
        load,
    };
    let found = answer(&file, Key::SubstrateYoungModulus, wanted);
    let Design::Found { candidate, .. } = &found.design else {
        panic!("{:?}", found.design);
    };
    let error = found.error().unwrap();
    println!("{} {error} {force}", candidate.value);
    assert!((candidate.value / 2e6 - 1.0).abs() < error && error < 0.4);
}
