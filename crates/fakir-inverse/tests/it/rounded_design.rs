//! Designs and samples of rounded tops, against closed forms, laws of scaling and contacts that are solved again.

use fakir::problem::{CyclePlan, Load, UnloadingPoint};
use fakir::state::{Run, Solution};
use fakir_case::{AnyCase, AsperityCase, CaseFile, Key};
use fakir_inverse::design::{Design, DesignError, Limit, Reached, Wanted, design};
use fakir_inverse::spread::{Deviation, Landing, Sampling, Spread, SpreadError, Tolerance, spread};
use std::f64::consts::PI;

/// Nine rubber tops under a rigid lens.
const TOPS: &str = "[lens]\nradius = \"3 mm\"\nyoung_modulus = \"1e9 GPa\"\npoisson_ratio = 0.5\n\
                    [substrate]\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n\
                    [pattern]\nlattice = \"square\"\npitch = \"60 um\"\ncolumns = 3\ntop_radius = \"100 um\"\n\
                    [pattern.pillar]\nheight = \"2 um\"\ndiameter = \"24 um\"\n";

fn file(overrides: &[&str]) -> CaseFile {
    let mut file = CaseFile::parse("tops.toml", TOPS).unwrap();
    for argument in overrides {
        file.set(argument).unwrap();
    }
    file
}

fn critical_force(case: &AsperityCase) -> f64 {
    let critical = case.field.transition(case.accuracy, &Run::default());
    critical.unwrap().contact.force
}

fn found(file: &CaseFile, free: Key, wanted: Wanted) -> (f64, f64, AsperityCase) {
    match design(file, free, wanted, &Run::default()).unwrap() {
        Design::Found {
            candidate,
            sensitivity,
        } => {
            let AnyCase::Asperities(case) = candidate.case else {
                panic!("rounded tops");
            };
            (candidate.value, sensitivity, *case)
        }
        other => panic!("{free}: {other:?}"),
    }
}

/// Takes the critical force of a case, changes one quantity, and finds it again; the critical force of the resulting case file is the
/// target.
#[test]
fn every_free_quantity_of_rounded_tops_is_found_again() {
    let file = file(&[]);
    let force = critical_force(&file.asperity_case().unwrap());
    for free in [
        Key::Pitch,
        Key::TopRadius,
        Key::PillarHeight,
        Key::PillarDiameter,
        Key::LensRadius,
    ] {
        let truth = file.given(free).unwrap().unwrap();
        let mut other = file.clone();
        other.set_number(free, 0.9 * truth);
        let (value, sensitivity, case) = found(&other, free, Wanted::Force(force));
        println!("{free}: {value:e}, sensitivity {sensitivity}");
        assert!(
            (value / truth - 1.0).abs() < 1e-6 / sensitivity.abs().min(1.0),
            "{free}: {value:e}"
        );
        let written = CaseFile::parse("found", &case.to_toml()).unwrap();
        let again = critical_force(&written.asperity_case().unwrap());
        assert!((again / force - 1.0).abs() < 1e-8, "{free}");
    }
}

/// All forces are proportional to the modulus of the substrate, as the lens is rigid and columns have the same modulus. A missing radius of
/// curvature, and a contact radius, can be searched for too.
#[test]
fn designs_of_rounded_tops_obey_scaling() {
    let file = file(&[]);
    let force = critical_force(&file.asperity_case().unwrap());
    let wanted = Wanted::Force(3.0 * force);
    let (value, sensitivity, _) = found(&file, Key::SubstrateYoungModulus, wanted);
    assert!((value / 6e6 - 1.0).abs() < 1e-8, "{value:e}");
    assert!((sensitivity - 1.0).abs() < 1e-6, "{sensitivity}");
    // All lengths twice as large: so is the contact radius.
    let case = file.asperity_case().unwrap();
    let critical = case.field.transition(case.accuracy, &Run::default());
    let radius = critical.unwrap().contact_radius();
    let wide = self::file(&[
        "lens.radius=6mm",
        "pattern.pitch=120um",
        "pattern.pillar.diameter=48um",
        "pattern.top_radius=200um",
    ]);
    let wanted = Wanted::ContactRadius(2.0 * radius);
    let (value, ..) = found(&wide, Key::PillarHeight, wanted);
    assert!((value / 4e-6 - 1.0).abs() < 1e-5, "{value:e}");
}

/// Johnson, Kendall and Roberts: a single top is pulled off by `3/2 pi w R` with the relative radius of curvature, after any load.
#[test]
fn a_pull_off_force_of_rounded_tops_is_found() {
    let file = file(&["pattern.columns=1", "adhesion.work=20mJ/m2"]);
    let (work, lens) = (20e-3, 3e-3);
    for load in [Load::FloorContact, Load::Indentation(1e-6)] {
        let relative: f64 = 50e-6;
        let force = 1.5 * PI * work * relative;
        let wanted = Wanted::PullOff { force, load };
        let (value, ..) = found(&file, Key::TopRadius, wanted);
        let expected = (relative.recip() - f64::recip(lens)).recip();
        assert!((value / expected - 1.0).abs() < 1e-6, "{value:e}");
    }
}

#[test]
fn unattainable_targets_of_rounded_tops_are_answered_with_the_nearest() {
    let file = file(&[]);
    let wanted = Wanted::Force(1e3);
    let answer = design(&file, Key::Pitch, wanted, &Run::default()).unwrap();
    let Design::OutOfReach { nearest, limit, .. } = answer else {
        panic!("{answer:?}");
    };
    assert!(matches!(nearest.reached, Reached::CriticalOfTops(_)));
    assert!(
        matches!(limit, Limit::Range | Limit::Solver(_)),
        "{limit:?}"
    );
    // A plate has no transition.
    let plate = self::file(&["lens.shape=plate"]);
    let refused = design(&plate, Key::Pitch, Wanted::Force(1e-3), &Run::default());
    let message = refused.unwrap_err().to_string();
    assert!(message.contains("has no transition"), "{message}");
    // The floor carries no load where it is ignored.
    let share = Wanted::FloorShare {
        share: 0.1,
        load: Load::Force(1e-3),
    };
    let ignored = self::file(&["floor.contact=false"]);
    let refused = design(&ignored, Key::Pitch, share, &Run::default());
    assert!(matches!(refused, Err(DesignError::Case(_))), "{refused:?}");
}

/// Takes the floor share of a case under a load past the transition, changes the height of the pillars, and finds it again: the contact of
/// the resulting case has the target share within its estimated error.
fn check_floor_share(file: &CaseFile) {
    let run = Run::default();
    let case = file.asperity_case().unwrap();
    let critical = case.field.transition(case.accuracy, &run).unwrap();
    let load = Load::Force(1.6 * critical.contact.force);
    let share_of = |case: &AsperityCase| {
        let contact = case.field.press(load, case.accuracy, &run).unwrap();
        let floor = contact.floor.expect("a floor in contact");
        [floor.share, floor.error.share]
    };
    let [share, error] = share_of(&case);
    assert!(share > 0.01 && error < 0.05, "{share} {error}");
    let truth = file.given(Key::PillarHeight).unwrap().unwrap();
    let mut other = file.clone();
    other.set_number(Key::PillarHeight, 0.93 * truth);
    let wanted = Wanted::FloorShare { share, load };
    let (value, sensitivity, case) = found(&other, Key::PillarHeight, wanted);
    let [again, error_again] = share_of(&case);
    println!("{value:e} instead of {truth:e}: {again} instead of {share}, {error:e}");
    assert!((again / share - 1.0).abs() <= error + error_again);
    // A higher pillar lowers the share.
    assert!(sensitivity < 0.0 && (value / truth - 1.0).abs() < 0.02);
}

#[test]
fn a_floor_share_of_rounded_tops_is_found_again() {
    check_floor_share(&file(&[]));
}

#[test]
#[ignore = "slow: a design with an adhesive floor"]
fn a_floor_share_of_adhesive_rounded_tops_is_found_again() {
    check_floor_share(&file(&["adhesion.work=20mJ/m2"]));
}

fn samples(file: &CaseFile, sampling: &Sampling) -> Spread {
    spread(file, sampling, &Run::default(), &|_| {}).unwrap()
}

fn sampling(tolerances: Vec<Tolerance>, landing: Landing, samples: usize) -> Sampling {
    Sampling {
        tolerances,
        landing,
        indentations: vec![1.5e-6],
        samples,
        seed: 3,
    }
}

fn relative(key: Key, part: f64) -> Tolerance {
    Tolerance {
        key,
        deviation: Deviation::Relative(part),
    }
}

/// Forces of every sample are proportional to its modulus.
#[test]
fn samples_of_rounded_tops_scale_with_the_modulus() {
    let file = file(&[]);
    let case = file.asperity_case().unwrap();
    let critical = critical_force(&case);
    let load = Load::Indentation(1.5e-6);
    let pressed = case.field.press(load, case.accuracy, &Run::default());
    let pressed = pressed.unwrap().force;
    let tolerance = relative(Key::SubstrateYoungModulus, 0.1);
    let spread = samples(&file, &sampling(vec![tolerance], Landing::AsGiven, 6));
    assert_eq!(spread.found().count(), 6);
    for sample in &spread.samples {
        let times = sample.values[0] / 2e6;
        let force = sample.outcome.as_ref().unwrap().force;
        assert!((force / critical / times - 1.0).abs() < 1e-8);
        assert!((sample.forces[0] / pressed / times - 1.0).abs() < 1e-8);
    }
}

/// Samples land anywhere, have their own heights and vacancies, and equal the case with their values.
#[test]
fn samples_of_rounded_tops_are_cases() {
    let file = file(&[
        "pattern.height_standard_deviation=0.05",
        "pattern.vacancy_fraction=0.1",
    ]);
    let tolerance = relative(Key::TopRadius, 0.02);
    let spread = samples(&file, &sampling(vec![tolerance], Landing::Anywhere, 4));
    let mut last = f64::NAN;
    for sample in &spread.samples {
        let mut file = file.clone();
        file.set_number(Key::TopRadius, sample.values[0]);
        file.set_number(Key::Offset, sample.offset);
        file.set_number(Key::OffsetAngle, sample.offset_angle);
        let seed = sample.pillar_seed.expect("pillars scatter");
        file.set_number(Key::PillarSeed, f64::from(seed));
        let case = file.asperity_case().unwrap();
        let critical = case.field.transition(case.accuracy, &Run::default());
        let found = sample.outcome.as_ref().unwrap();
        let force = critical.unwrap().contact.force;
        assert!(force.total_cmp(&found.force).is_eq());
        assert!(!found.force.total_cmp(&last).is_eq());
        last = found.force;
    }
}

/// The pull-off force of one top is proportional to the work of adhesion (Johnson, Kendall and Roberts), after the critical state.
#[test]
fn samples_of_adhesive_rounded_tops_are_unloaded() {
    let file = file(&[
        "pattern.columns=1",
        "adhesion.work=20mJ/m2",
        "lens.shape=paraboloid",
    ]);
    let tolerance = relative(Key::WorkOfAdhesion, 0.1);
    let spread = samples(&file, &sampling(vec![tolerance], Landing::AsGiven, 3));
    let curvature = f64::recip(100e-6) + f64::recip(3e-3);
    for sample in &spread.samples {
        let pull_off = sample.outcome.as_ref().unwrap().pull_off.expect("adhesion");
        let expected = -1.5 * PI * sample.values[0] / curvature;
        assert!((pull_off.force / expected - 1.0).abs() < 1e-8);
        let mut file = file.clone();
        file.set_number(Key::WorkOfAdhesion, sample.values[0]);
        let case = file.asperity_case().unwrap();
        let critical = case.field.transition(case.accuracy, &Run::default());
        let critical = critical.unwrap().contact;
        let plan = CyclePlan {
            turn: UnloadingPoint::Indentation(critical.indentation),
            ..CyclePlan::default()
        };
        let cycle = case.field.cycle(plan, case.accuracy, &Run::default());
        let cycle = cycle.unwrap();
        assert!(cycle.is_answer());
        let hysteresis = cycle.loop_area.unwrap();
        assert!((pull_off.hysteresis / hysteresis - 1.0).abs() < 1e-12);
    }
}

#[test]
fn samples_of_listed_or_flat_surfaces_are_refused() {
    let plate = file(&["lens.shape=plate"]);
    let sampling = sampling(Vec::new(), Landing::AsGiven, 2);
    let refused = spread(&plate, &sampling, &Run::default(), &|_| {}).unwrap_err();
    assert!(matches!(refused, SpreadError::Case(_)), "{refused}");
    assert!(refused.to_string().contains("has no transition"));
}

/// Derivatives by every key of an oblique lattice with scattered heights, whose axis is off all lines of symmetry, equal central differences of
/// cases with these keys; those by the height of a pillar equal differences of the table of pillars.
#[test]
fn derivatives_by_keys_are_central_differences() {
    let file = file(&[
        "pattern.lattice=oblique",
        "pattern.pitch_y=66um",
        "pattern.lattice_angle=80deg",
        "pattern.offset=0.2",
        "pattern.offset_angle=0.4",
        "pattern.rotation=0.1",
        "pattern.height_standard_deviation=0.03",
        "lens.young_modulus=3MPa",
    ]);
    let run = Run::default();
    let case = file.asperity_case().unwrap();
    let load = Load::FloorContact;
    let found = case.gradient(load, &run).unwrap();
    let contact = &found.gradient.contact;
    let solved = |case: &AsperityCase| {
        let critical = case.field.transition(case.accuracy, &run).unwrap().contact;
        [critical.force, critical.indentation, critical.area]
    };
    let values = [contact.force, contact.indentation, contact.area];
    let of = &found.gradient;
    let all = [&of.force, &of.indentation, &of.area].map(|it| it.as_ref().unwrap());
    let mut keys = Vec::new();
    for (place, (quantity, _)) in all[0].quantities.iter().enumerate() {
        let key = Key::of(*quantity).unwrap();
        let value = file.given(key).unwrap().unwrap();
        let at = |step: f64| {
            let mut file = file.clone();
            file.set_number(key, value * (1.0 + step));
            solved(&file.asperity_case().unwrap())
        };
        // Poisson's ratio of 1/2 is the largest one.
        let (above, below) = match value >= 0.5 && key.path().ends_with("poisson_ratio") {
            true => (at(0.0), at(-2e-5)),
            false => (at(1e-5), at(-1e-5)),
        };
        for (k, result) in all.iter().enumerate() {
            let expected = (above[k] - below[k]) / (2e-5 * value);
            let off = (result.quantities[place].1 - expected) * value / values[k];
            assert!(off.abs() < 1e-4, "{} of {k}: {off:e}", key.path());
        }
        keys.push(key.path());
    }
    for key in [
        "lens.radius",
        "lens.young_modulus",
        "substrate.young_modulus",
        "pattern.pitch",
        "pattern.pitch_y",
        "pattern.lattice_angle",
        "pattern.offset",
        "pattern.offset_angle",
        "pattern.rotation",
        "pattern.top_radius",
        "pattern.pillar.diameter",
        "pattern.pillar.height",
    ] {
        assert!(keys.contains(&key), "{key}");
    }
    // The nearest pillar.
    let ((pillar, _), slope) = all[0].heights[0];
    let raised: Vec<f64> = case.field.asperities().iter().map(|it| it.raised).collect();
    let at = |step: f64| {
        let mut raised = raised.clone();
        raised[pillar as usize] += step;
        solved(&case.with_heights(&raised).unwrap())[0]
    };
    let expected = (at(1e-11) - at(-1e-11)) / 2e-11;
    assert!(
        (slope / expected - 1.0).abs() < 1e-4,
        "{slope:e} {expected:e}"
    );
}

/// All forces are proportional to the modulus, so that their relative scatter to first order is that of the modulus.
#[test]
fn the_first_order_scatter_of_rounded_tops_follows_from_derivatives() {
    let file = file(&[]);
    let force = critical_force(&file.asperity_case().unwrap());
    let tolerance = relative(Key::SubstrateYoungModulus, 0.1);
    let spread = samples(&file, &sampling(vec![tolerance], Landing::AsGiven, 2));
    let first_order = spread.first_order.unwrap();
    assert!((first_order.force / force / 0.1 - 1.0).abs() < 1e-8);
    assert!(first_order.indentation < 1e-8 * 2e-6);
}
