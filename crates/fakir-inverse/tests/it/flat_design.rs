//! Designs on a flat surface against closed forms, and targets of contacts under a load on pillars.

use fakir::problem::Load;
use fakir::state::{Run, SolveError};
use fakir_case::{Case, CaseFile, Key};
use fakir_inverse::design::{
    Answer, Design, DesignError, Limit, PressedQuantity, Reached, Wanted, design,
};
use std::f64::consts::PI;

const WORK: f64 = 50e-3;
const RUBBER: &str = r#"
[lens]
shape = "paraboloid"
radius = "1 mm"
young_modulus = "2 MPa"
poisson_ratio = 0.5

[substrate]
young_modulus = "2 MPa"
poisson_ratio = 0.5
"#;
/// `E*` of two bodies of 2 MPa and Poisson's ratio 1/2, Pa.
const MODULUS: f64 = 2e6 / 1.5;

fn file(sets: &[&str]) -> CaseFile {
    let mut file = CaseFile::parse("flat", RUBBER).unwrap();
    for set in sets {
        file.set(set).unwrap();
    }
    file
}

/// The value with the target, and its sensitivity; the contact of the case with the value has the target.
fn found(file: &CaseFile, free: Key, wanted: Wanted) -> [f64; 2] {
    let design = design(file, free, wanted, &Run::default()).unwrap();
    let answer = Answer {
        free,
        wanted,
        design,
    };
    let statement = answer.statement();
    let Design::Found {
        candidate,
        sensitivity,
    } = answer.design
    else {
        panic!("{statement}");
    };
    assert!((wanted.of(&candidate.reached) / wanted.value() - 1.0).abs() < 1e-8);
    assert!(
        candidate.reached.is_answer() && statement.contains("gives a"),
        "{statement}"
    );
    [candidate.value, sensitivity]
}

fn at(load: Load, quantity: PressedQuantity, value: f64) -> Wanted {
    Wanted::Pressed {
        quantity,
        value,
        load,
    }
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found / expected - 1.0).abs() < tolerance,
        "{found:e}, {expected:e}"
    );
}

/// Hertz (K. L. Johnson, Contact Mechanics, sec. 4.2): `F = 4/3 E* R^(1/2) zeta^(3/2)`, so that `R = (3 F/(4 E* zeta^(3/2)))^2`, and `a^3 = 3 F R/(4 E*)`.
#[test]
fn designs_are_those_of_hertz() {
    let (depth, force) = (2e-6_f64, 0.3e-3);
    let wanted = at(Load::Indentation(depth), PressedQuantity::Force, force);
    let radius = (3.0 * force / (4.0 * MODULUS * depth.powf(1.5))).powi(2);
    let [value, sensitivity] = found(&file(&[]), Key::LensRadius, wanted);
    close(value, radius, 1e-7);
    close(sensitivity, 0.5, 1e-3);
    let modulus = 3.0 * force / (4.0 * 1e-3_f64.sqrt() * depth.powf(1.5));
    // 1/E* = 0.75 (1/E_1 + 1/E_2).
    let substrate = (1.0 / (0.75 * modulus) - 1.0 / 2e6).recip();
    let [value, _] = found(&file(&[]), Key::SubstrateYoungModulus, wanted);
    close(value, substrate, 1e-6);
    let contact = 80e-6_f64;
    let wanted = at(Load::Force(force), PressedQuantity::ContactRadius, contact);
    let [value, _] = found(&file(&[]), Key::LensRadius, wanted);
    close(value, 4.0 * MODULUS * contact.powi(3) / (3.0 * force), 1e-7);
}

/// K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301 (1971): `3/2 pi w R`, with the receding work; and of a thickness, the case from which
/// the target is.
#[test]
#[ignore = "slow: designs with adhesion and films"]
fn designs_with_adhesion_and_films() {
    let pull = |load| Wanted::PullOff {
        force: 0.3e-3,
        load,
    };
    let wanted = pull(Load::Indentation(2e-6));
    let adhesive = file(&["adhesion.work=50mJ/m2"]);
    let [value, _] = found(&adhesive, Key::LensRadius, wanted);
    close(value, 0.3e-3 / (1.5 * PI * WORK), 1e-6);
    let work = 0.3e-3 / (1.5 * PI * 1e-3);
    let [value, sensitivity] = found(&adhesive, Key::WorkOfAdhesion, wanted);
    close(value, work, 1e-6);
    close(sensitivity, 1.0, 1e-3);
    // Without a work in the case the search begins with a usual one.
    let [value, _] = found(&file(&[]), Key::WorkOfAdhesion, wanted);
    close(value, work, 1e-6);
    let receding = file(&["adhesion.work=10mJ/m2", "adhesion.work_receding=80mJ/m2"]);
    let [value, _] = found(&receding, Key::RecedingWorkOfAdhesion, wanted);
    close(value, work, 1e-6);
    let film = file(&["substrate.thickness=40um"]);
    let load = Load::Indentation(1e-6);
    let truth = film
        .flat_case()
        .unwrap()
        .system
        .press(load, &Run::default());
    let wanted = at(load, PressedQuantity::Force, truth.unwrap().force);
    for start in [&film, &file(&["substrate.thickness=0.3mm"]), &file(&[])] {
        let [value, _] = found(start, Key::SubstrateThickness, wanted);
        close(value, 40e-6, 1e-6);
    }
    // The target is refused or out of reach with the reason.
    let refused = |file: &CaseFile, free, wanted| {
        let error = design(file, free, wanted, &Run::default()).unwrap_err();
        error.to_string()
    };
    let message = refused(&adhesive, Key::LensRadius, pull(Load::FloorContact));
    assert!(message.contains("no floor between pillars"), "{message}");
    let message = refused(&adhesive, Key::LensRadius, Wanted::Force(1e-3));
    assert!(message.contains("no floor between pillars"), "{message}");
    let message = refused(&file(&[]), Key::LensRadius, pull(load));
    assert!(message.contains("needs adhesion"), "{message}");
    let itself = at(Load::Force(1e-3), PressedQuantity::Force, 1e-3);
    let error = design(&adhesive, Key::LensRadius, itself, &Run::default());
    assert!(matches!(error, Err(DesignError::NotALoad(_))));
    let huge = at(load, PressedQuantity::Force, 1e6);
    let Design::OutOfReach { nearest, limit, .. } =
        design(&film, Key::SubstrateThickness, huge, &Run::default()).unwrap()
    else {
        panic!("no film is that stiff");
    };
    assert!(matches!(nearest.reached, Reached::PressedFlat(_)));
    assert!(
        matches!(limit, Limit::Solver(SolveError::LayerTooThin { .. })),
        "{limit:?}"
    );
}

/// The search ends a million times below its start of 50 mJ/m^2; `3/2 pi w R` there is 0.235619449 nN. Near the target, the closest value has the digits in which they
/// differ.
#[test]
fn where_a_search_ends_it_states_its_range() {
    let file = file(&["adhesion.work=50mJ/m2"]);
    let load = Load::Indentation(2e-6);
    let least = 1.5 * PI * WORK * 1e-6 * 1e-3;
    let statement = |force: f64| {
        let (free, wanted) = (Key::WorkOfAdhesion, Wanted::PullOff { force, load });
        let design = design(&file, free, wanted, &Run::default()).unwrap();
        let answer = Answer {
            free,
            wanted,
            design,
        };
        assert!(
            matches!(
                answer.design,
                Design::OutOfReach {
                    limit: Limit::Distance(_),
                    ..
                }
            ),
            "{:?}",
            answer.design
        );
        answer.statement()
    };
    let far = statement(0.5 * least);
    for words in [
        "No adhesion.work from 5.00e-5 mJ/m2 to ",
        "the closest value is 0.235619 nN, at ",
        ", where the search ends; with another initial adhesion.work it may find one",
    ] {
        assert!(far.contains(words), "{far}");
    }
    let near = statement(least * (1.0 - 1e-8));
    assert!(
        near.contains("the closest value is 0.235619449 nN"),
        "{near}"
    );
}

/// The force at an indentation of the paper's pattern is that of the case in which the pitch is found again.
#[test]
fn the_force_at_an_indentation_is_a_target_on_pillars() {
    let mut paper = CaseFile::parse("paper", &Case::example().to_toml()).unwrap();
    paper.set_number(Key::SurfaceFraction, 0.02);
    let case = paper.case().unwrap();
    let load = Load::Indentation(0.5e-6);
    let contact = fakir::press(&case.system, load, case.method, &Run::default()).unwrap();
    let pitch = case.system.pitch();
    paper.set_number(Key::Pitch, 1.3 * pitch);
    let wanted = at(load, PressedQuantity::Force, contact.force);
    let [value, _] = found(&paper, Key::Pitch, wanted);
    close(value, pitch, 1e-5);
}
