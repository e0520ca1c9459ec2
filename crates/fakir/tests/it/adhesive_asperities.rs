//! Rounded tops with adhesion: closed forms of Johnson, Kendall and Roberts, limits, and balances of energy.

use fakir::problem::{
    Accuracy, Adhesion, Asperity, AsperityArray, CyclePlan, Indenter, Lens, Load, LoadingMode,
    Material, Point, UnloadingPoint,
};
use fakir::state::{
    AsperityContact, AsperityCycle, Branch, CycleEventKind, PillarStatus, Run, SolveError,
};
use std::f64::consts::PI;

/// Lengths in um, and a reduced modulus of 1 Pa: forces in um^2 Pa, works of adhesion in um Pa.
const UM: f64 = 1e-6;
const FORCE: f64 = 1e-12;

fn substrate() -> Material {
    Material::new(1.0, 0.0)
}

/// A nearly rigid sphere with the given radius, or a rigid plate.
fn indenter(radius: f64) -> Indenter {
    if radius.is_infinite() {
        return Indenter::Flat(None);
    }
    Indenter::from(Lens {
        radius: radius * UM,
        material: Material::new(1e300, 0.0),
    })
}

/// Asperities with positions, radii of curvature and heights.
fn array(radius: f64, work: f64, asperities: &[(Point, f64, f64)]) -> AsperityArray {
    let asperities = asperities.iter().map(|([x, y], radius, raised)| {
        Asperity::new([x * UM, y * UM], radius * UM).raised_by(raised * UM)
    });
    AsperityArray::new(indenter(radius), substrate(), asperities.collect())
        .expect("an array")
        .with_adhesion(Adhesion::new(work * UM))
        .expect("a work of adhesion")
}

fn press(array: &AsperityArray, load: Load) -> AsperityContact {
    let contact = array.press(load, Accuracy::Default, &Run::default());
    let contact = contact.expect("a contact");
    assert!(contact.converged(), "{:?}", contact.termination);
    contact
}

fn cycle(array: &AsperityArray, turn: UnloadingPoint, drive: LoadingMode) -> AsperityCycle {
    let plan = CyclePlan {
        turn,
        drive,
        retract: true,
    };
    let cycle = array.cycle(plan, Accuracy::Default, &Run::default());
    let cycle = cycle.expect("a cycle");
    assert!(cycle.converged(), "{:?}", cycle.termination);
    cycle
}

fn up_to(indentation: f64) -> UnloadingPoint {
    UnloadingPoint::Indentation(indentation * UM)
}

/// Indentation and force of an isolated contact of radius `b`: K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301 (1971).
fn jkr(radius: f64, work: f64, b: f64) -> [f64; 2] {
    [
        b * b / radius - (2.0 * PI * work * b).sqrt(),
        4.0 / 3.0 * b.powi(3) / radius - (8.0 * PI * work * b.powi(3)).sqrt(),
    ]
}

fn close(found: f64, expected: f64, relative: f64) {
    assert!(
        (found / expected - 1.0).abs() < relative,
        "{found:e} {expected:e} {:e}",
        found / expected - 1.0
    );
}

/// A sphere of radius 300 on a top of radius 100, a little off the axis: combined radius 75.
#[test]
fn one_asperity_is_that_of_johnson_kendall_and_roberts() {
    let (radius, work) = (100.0, 1e-3);
    let array = array(f64::INFINITY, work, &[([3.0, -7.0], radius, 0.4)]);
    // Contact begins where the undeformed bodies touch, with the radius at which the indentation is zero.
    let first = press(&array, Load::Indentation(-0.4 * UM));
    let begins = (2.0 * PI * work * radius * radius).cbrt();
    close(first.asperities[0].radius, begins * UM, 1e-8);
    let before = press(&array, Load::Indentation(-0.400_001 * UM));
    assert!(before.force == 0.0 && before.touched() == 0);
    // Without load the radius is (9/2 pi w R^2/E*)^(1/3).
    let rest = press(&array, Load::Force(0.0));
    let radius_at_rest = (4.5 * PI * work * radius * radius).cbrt();
    close(rest.asperities[0].radius, radius_at_rest * UM, 1e-8);
    for b in [6.0, 9.0, 14.0] {
        let [indentation, force] = jkr(radius, work, b);
        let contact = press(&array, Load::Indentation((indentation - 0.4) * UM));
        close(contact.asperities[0].radius, b * UM, 1e-8);
        close(contact.force, force * FORCE, 1e-8);
        close(contact.area, PI * b * b * FORCE, 1e-8);
        let error = contact.error.expect("an estimate");
        assert!(error.force < 1e-8 && error.area < 1e-8, "{error:?}");
        // The stiffness is dF/db over d(indentation)/db.
        let slope =
            |k: usize| (jkr(radius, work, b + 1e-4)[k] - jkr(radius, work, b - 1e-4)[k]) / 2e-4;
        let stiffness = slope(1) / slope(0) * FORCE / UM;
        close(contact.slopes.force_with_indentation, stiffness, 1e-7);
        let back = press(&array, Load::Force(contact.force));
        close(back.indentation, contact.indentation, 1e-8);
    }
}

/// Pull-off at -3/2 pi w R, and detachment at a controlled indentation where `b^(3/2) = (2 pi w)^(1/2) R/4`.
#[test]
fn the_pull_off_of_one_asperity() {
    let (lens, top, work) = (300.0, 100.0, 1e-3);
    let radius = 75.0;
    let array = array(lens, work, &[([0.0, 0.0], top, 0.0)]);
    let pull_off = -1.5 * PI * work * radius * FORCE;
    let last = (0.0625 * 2.0 * PI * work * radius * radius).cbrt();
    let [ends, at_end] = jkr(radius, work, last);
    for drive in [
        LoadingMode::Displacement,
        LoadingMode::Force,
        LoadingMode::Machine(2.0 * FORCE / UM),
    ] {
        let cycle = cycle(&array, up_to(0.5), drive);
        let found = cycle.pull_off.as_ref().expect("tension");
        println!(
            "{drive:?} {:?} {} {:?}",
            cycle.errors,
            cycle.load_steps.len(),
            cycle.certificate()
        );
        // A sphere of radius 300 differs from a paraboloid by (b/R)^2.
        close(found.force, pull_off, 2e-3);
        assert_eq!(cycle.events.len(), 2);
        assert_eq!(cycle.events[0].kind, CycleEventKind::SnapIn);
        assert_eq!(cycle.events[1].kind, CycleEventKind::Release);
        if drive == LoadingMode::Displacement {
            close(cycle.separation.expect("it detaches"), ends * UM, 2e-3);
            close(cycle.events[1].radius, last * UM, 2e-3);
            let steps = &cycle.load_steps;
            let before = steps[steps.len() - 2];
            close(before.force, at_end * FORCE, 2e-3);
        }
        if drive == LoadingMode::Force {
            assert!(cycle.loop_area.is_none() && cycle.work_of_separation.is_none());
        } else {
            // The error of a pressure of degree 2 under a sphere.
            assert!(cycle.certificate().expect("closed") < 1e-5);
            assert!(cycle.errors.loop_area < 2e-5);
        }
    }
}

/// The same under a plate, to rounding errors; the loop area is the energy of both jumps.
#[test]
fn the_pull_off_under_a_plate_is_exact() {
    let (radius, work) = (100.0, 1e-3);
    let array = array(f64::INFINITY, work, &[([0.0, 0.0], radius, 0.0)]);
    let cycle = cycle(&array, up_to(1.0), LoadingMode::Displacement);
    let pull_off = cycle.pull_off.as_ref().expect("tension");
    close(pull_off.force, -1.5 * PI * work * radius * FORCE, 1e-9);
    let last = (0.0625 * 2.0 * PI * work * radius * radius).cbrt();
    let [ends, _] = jkr(radius, work, last);
    close(cycle.separation.expect("it detaches"), ends * UM, 1e-8);
    close(cycle.events[1].radius, last * UM, 1e-6);
    assert!(cycle.errors.pull_off_force < 1e-8, "{:?}", cycle.errors);
    // Energy of a contact at an indentation: the integral of the force along the branch from radius 0.
    let steps = 20_000;
    let work_between = |from: f64, to: f64| -> f64 {
        let sum: f64 = (0..steps)
            .map(|k| {
                let at = |part: f64| {
                    jkr(
                        radius,
                        work,
                        from + (to - from) * (f64::from(k) + part) / f64::from(steps),
                    )
                };
                at(0.5)[1] * (at(1.0)[0] - at(0.0)[0])
            })
            .sum();
        sum
    };
    // Loading begins at indentation 0 and unloading ends at the smallest one: the loop is the branch between the two radii.
    let begins = (2.0 * PI * work * radius * radius).cbrt();
    let loop_area = work_between(begins, last) * FORCE * UM;
    close(cycle.dissipation, loop_area, 1e-8);
    // The loop is a small difference of the work of loading and of unloading.
    close(cycle.loop_area.expect("closed"), loop_area, 1e-5);
    let rest = (4.5 * PI * work * radius * radius).cbrt();
    let separation = work_between(rest, last) * FORCE * UM;
    close(cycle.work_of_separation.expect("closed"), separation, 1e-6);
}

/// Far from each other, equal tops at different heights are isolated ones.
#[test]
fn tops_far_apart_are_independent() {
    let work = 1e-3;
    let heights = [0.0, -0.1, -0.35];
    let places: Vec<_> = heights
        .iter()
        .zip(0..)
        .map(|(height, k)| ([f64::from(k) * 1e7, 0.0], 100.0, *height))
        .collect();
    let array = array(f64::INFINITY, work, &places);
    let contact = press(&array, Load::Indentation(0.2 * UM));
    let mut expected = 0.0;
    for (asperity, height) in contact.asperities.iter().zip(heights) {
        // The third is not touched yet.
        if height < -0.2 {
            assert_eq!(asperity.radius.to_bits(), 0);
            continue;
        }
        let [indentation, force] = jkr(100.0, work, asperity.radius / UM);
        assert!((indentation - 0.2 - height).abs() < 1e-6, "{indentation}");
        expected += force * FORCE;
    }
    close(contact.force, expected, 1e-8);
    let cycle = cycle(&array, up_to(0.6), LoadingMode::Displacement);
    let last = (0.0625 * 2.0 * PI * work * 1e4_f64).cbrt();
    let [ends, _] = jkr(100.0, work, last);
    let released: Vec<_> = cycle
        .events
        .iter()
        .filter(|event| event.kind == CycleEventKind::Release)
        .collect();
    assert_eq!(released.len(), 3);
    for (event, height) in released.iter().zip([-0.35, -0.1, 0.0]) {
        assert!((event.indentation / UM - (ends - height)).abs() < 1e-6);
    }
    assert!(
        cycle.certificate().expect("closed") < 1e-5,
        "{:?}",
        cycle.certificate()
    );
}

/// Seven tops with symmetric interactions: contacts begin and end by symmetry, and the balance of energy holds.
#[test]
fn seven_tops_are_symmetric_and_conserve_energy() {
    let work = 2e-3;
    let around = (0..6).map(|k| {
        let angle = PI / 3.0 * f64::from(k);
        ([40.0 * angle.cos(), 40.0 * angle.sin()], 100.0, 0.0)
    });
    let places: Vec<_> = std::iter::once(([0.0, 0.0], 100.0, 0.0))
        .chain(around)
        .collect();
    let array = array(f64::INFINITY, work, &places);
    let cycle = cycle(&array, up_to(0.8), LoadingMode::Displacement);
    println!(
        "{:?} {:?} {}",
        cycle.errors,
        cycle.certificate(),
        cycle.load_steps.len()
    );
    for event in &cycle.events {
        println!(
            "{:?} {} {:.6} {:.6}",
            event.kind,
            event.asperity,
            event.indentation / UM,
            event.radius / UM
        );
    }
    let turn = &cycle.turn;
    for k in 2..7 {
        close(turn.asperities[k].force, turn.asperities[1].force, 1e-9);
    }
    assert!(turn.asperities[0].force < turn.asperities[1].force);
    let balance = cycle.certificate().expect("closed");
    assert!(
        balance < 1e-3 && balance <= cycle.errors.loop_area,
        "{balance}"
    );
    // Tops that interact as point forces have at most the force of isolated ones at the same indentation of each.
    let pull_off = cycle.pull_off.as_ref().expect("tension").force;
    close(pull_off, -1.5 * PI * work * 100.0 * 7.0 * FORCE, 1e-2);
}

/// Two equal tops end contact together, although the determinant keeps its sign.
#[test]
fn two_equal_tops_end_contact_together() {
    let work = 1e-3;
    let places = [([-20.0, 0.0], 100.0, 0.0), ([20.0, 0.0], 100.0, 0.0)];
    let array = array(f64::INFINITY, work, &places);
    let cycle = cycle(&array, up_to(0.5), LoadingMode::Displacement);
    let events: Vec<_> = cycle
        .events
        .iter()
        .map(|it| (it.kind, it.indentation))
        .collect();
    assert_eq!(events.len(), 4);
    assert_eq!(events[0].1.to_bits(), events[1].1.to_bits());
    assert_eq!(events[2].1.to_bits(), events[3].1.to_bits());
    // The pull of the other top raises the surface by `|F|/(pi E* d)`.
    let last = (0.0625 * 2.0 * PI * work * 1e4_f64).cbrt();
    let [ends, force] = jkr(100.0, work, last);
    let raised = force / (PI * 40.0);
    let found = cycle.separation.expect("they detach") / UM;
    // To first order in the interaction, which changes with the radius too.
    assert!(
        (found - ends - raised).abs() < 0.2 * raised.abs(),
        "{found} {ends} {raised}"
    );
    assert!(cycle.certificate().expect("closed") < 1e-4);
}

/// Without adhesion in the limit of small works, and scaling: lengths by `s`, the modulus by `m` and the work by `s m`.
#[test]
fn limits_and_scaling() {
    let places = [([0.0, 0.0], 100.0, 0.0), ([30.0, 5.0], 80.0, -0.2)];
    let load = Load::Indentation(0.8 * UM);
    // The pull of adhesion grows with the root of the work, here 1e-18 m in units of the modulus.
    let stiff = |work: f64| {
        let soft = array(2000.0, 0.0, &places);
        let asperities = soft.asperities().to_vec();
        let stiff =
            AsperityArray::new(soft.indenter().clone(), Material::new(1e6, 0.0), asperities);
        let stiff = stiff.expect("an array").with_adhesion(Adhesion::new(work));
        press(&stiff.expect("a work"), load)
    };
    let [plain, weak] = [0.0, 1e-12].map(stiff);
    close(weak.force, plain.force, 1e-4);
    close(weak.area, plain.area, 1e-4);
    assert!(weak.area > plain.area);
    let strong = array(2000.0, 1e-3, &places);
    let strong = press(&strong, load);
    let scaled: Vec<Asperity> = places
        .iter()
        .map(|([x, y], radius, raised)| {
            Asperity::new([2.0 * x * UM, 2.0 * y * UM], 2.0 * radius * UM)
                .raised_by(2.0 * raised * UM)
        })
        .collect();
    let lens = Lens {
        radius: 4000.0 * UM,
        material: Material::new(1e300, 0.0),
    };
    let scaled = AsperityArray::new(Indenter::from(lens), Material::new(3.0, 0.0), scaled)
        .expect("an array")
        .with_adhesion(Adhesion::new(6.0 * 1e-3 * UM))
        .expect("a work");
    let scaled = press(&scaled, Load::Indentation(1.6 * UM));
    close(scaled.force, 12.0 * strong.force, 1e-9);
    close(scaled.area, 4.0 * strong.area, 1e-9);
}

/// Columns that are shortened or lengthened: the indentation is that of the contact plus the force times the compliance.
#[test]
fn columns_add_to_the_indentation() {
    let (radius, work, compliance) = (100.0, 1e-3, 0.01);
    let asperity = Asperity {
        column_compliance: compliance / UM,
        ..Asperity::new([0.0, 0.0], radius * UM)
    };
    let array = AsperityArray::new(indenter(f64::INFINITY), substrate(), vec![asperity])
        .expect("an array")
        .with_adhesion(Adhesion::new(work * UM))
        .expect("a work");
    for b in [7.0, 12.0] {
        let [indentation, force] = jkr(radius, work, b);
        let contact = press(
            &array,
            Load::Indentation((indentation + compliance * force) * UM),
        );
        close(contact.force, force * FORCE, 1e-8);
    }
    let cycle = cycle(&array, up_to(0.5), LoadingMode::Displacement);
    close(
        cycle.pull_off.expect("tension").force,
        -1.5 * PI * work * radius * FORCE,
        1e-9,
    );
}

/// Random heights and curvatures: cycles end, close and balance, and loading agrees with single contacts.
#[test]
fn random_arrays_conserve_energy() {
    for seed in 0..4u32 {
        let random =
            |k: u32| (f64::from(k * 7919 + seed * 104_729 + 13) * 0.618_033_988_75).fract();
        let places: Vec<_> = (0..9u32)
            .map(|k| {
                let place = [
                    f64::from(k % 3) * 40.0 + 5.0 * random(k),
                    f64::from(k / 3) * 40.0 + 5.0 * random(k + 50),
                ];
                (place, 60.0 + 80.0 * random(k + 100), -0.4 * random(k + 150))
            })
            .collect();
        let radius = if seed % 2 == 0 { f64::INFINITY } else { 5000.0 };
        let array = array(radius, 1e-3, &places);
        let cycle = cycle(&array, up_to(0.7), LoadingMode::Displacement);
        let balance = cycle.certificate().expect("closed");
        println!(
            "{seed}: {} steps, {} events, {balance:.1e}, {:?}",
            cycle.load_steps.len(),
            cycle.events.len(),
            cycle.errors
        );
        assert!(balance < 1e-3, "{balance}");
        let begun = cycle
            .events
            .iter()
            .filter(|it| it.kind == CycleEventKind::SnapIn)
            .count();
        assert_eq!(2 * begun, cycle.events.len());
        let turn = press(&array, Load::Indentation(0.7 * UM));
        close(cycle.turn.force, turn.force, 1e-10);
        // The force of a step of the loading is that of the contact there.
        let step = cycle
            .load_steps
            .iter()
            .rfind(|it| it.branch == Branch::Loading && it.indentation < 0.5 * UM);
        let step = step.expect("a step");
        let there = press(&array, Load::Indentation(step.indentation));
        assert!((there.force - step.force).abs() < 1e-7 * turn.force.abs());
    }
}

/// Up to the rim, a top is a punch of its radius `a` with a paraboloid as its end: `F = 2 a E* (z - a^2/(3 R))` (Hertz's force at `z = a^2/R`). On
/// unloading the contact leaves the rim, and the pull-off force is `3/2 pi w R` (Johnson, Kendall and Roberts).
#[test]
fn a_single_top_is_filled_up_to_its_rim_and_left_again() {
    let (radius, rim, work) = (100.0, 8.0, 1e-3);
    let top = Asperity {
        rim_radius: Some(rim * UM),
        ..Asperity::new([0.0; 2], radius * UM)
    };
    let rigid = Indenter::Flat(None);
    let array = AsperityArray::new(rigid, Material::new(1.0, 0.0), vec![top]).expect("an array");
    let array = array
        .with_adhesion(Adhesion::new(work * UM))
        .expect("adhesion");
    let found = cycle(
        &array,
        UnloadingPoint::Indentation(2.0 * UM),
        LoadingMode::Displacement,
    );
    assert_eq!(found.turn.asperities[0].status, PillarStatus::Full);
    let turn = 2.0 * rim * (2.0 - rim * rim / (3.0 * radius)) * UM * UM;
    assert!((found.turn.force / turn - 1.0).abs() < 1e-9);
    let pull_off = -1.5 * PI * work * radius * UM * UM;
    let force = found.pull_off.expect("tension").force;
    assert!(
        (force / pull_off - 1.0).abs() < 1e-8,
        "{force:e} {pull_off:e}"
    );
}

/// Rows of five tops with rims (lengths in um, `E* = 1`), each row by `step` lower than the one before, as under a tilted plate.
fn rows_with_rims(pitch: f64, step: f64, (radius, rim, work): (f64, f64, f64)) -> AsperityArray {
    let tops = (0..25u32).map(|k| {
        let [row, column] = [k / 5, k % 5].map(f64::from);
        let height = -step * (row + 0.02 * column);
        let place = [pitch * row * UM, pitch * column * UM];
        Asperity {
            rim_radius: Some(rim * UM),
            ..Asperity::new(place, radius * UM).raised_by(height * UM)
        }
    });
    let array = AsperityArray::new(Indenter::Flat(None), substrate(), tops.collect());
    let array = array.expect("an array");
    array
        .with_adhesion(Adhesion::new(work * UM))
        .expect("a work of adhesion")
}

/// On unloading one top leaves its rim while another is lost. The work of the cycle is dissipated, every top is released, and the pull-off force
/// is at most that of 25 tops alone, `3/2 pi w R` each (Johnson, Kendall and Roberts).
#[test]
fn tops_leave_their_rims_while_others_are_lost() {
    let (radius, rim, work) = (39.5, 6.58, 0.0945);
    for step in [0.01, 0.0375, 0.08] {
        let array = rows_with_rims(30.6, step, (radius, rim, work));
        let found = cycle(&array, up_to(1.5), LoadingMode::Displacement);
        let balance = found.certificate().expect("closed");
        let force = found.pull_off.as_ref().expect("tension").force;
        println!("{step}: balance {balance:e}, pull-off {force:e}");
        assert!(balance < 1e-3, "{step}: {balance}");
        assert_eq!(found.events.len(), 50);
        assert!(-force < 25.0 * 1.5 * PI * work * radius * UM * UM);
    }
}

/// The contact of a top that nearly fills it, found although it is nearer to the rim than the start of the iteration.
#[test]
fn contacts_that_nearly_fill_their_tops_are_found() {
    // The contact of an isolated top without load has a radius between 0.98 and 1.005 of that of the rim: (9 pi w R^2/(2 E*))^(1/3) (Johnson,
    // Kendall and Roberts, with E* = 1).
    let (radius, rim) = (35.5, 5.914);
    for part in [0.98, 0.99, 0.995, 0.999, 1.005] {
        let b: f64 = part * rim;
        let work = b.powi(3) * 2.0 / (9.0 * PI * radius * radius);
        let array = rows_with_rims(31.4, 0.094, (radius, rim, work));
        let contact = press(&array, Load::Indentation(0.5 * UM));
        assert_eq!(contact.asperities.len(), 25);
        let back = press(&array, Load::Force(contact.force));
        close(back.indentation, contact.indentation, 1e-7);
    }
}

#[test]
fn cycles_without_adhesion_or_end_are_refused() {
    let plain = array(f64::INFINITY, 0.0, &[([0.0, 0.0], 100.0, 0.0)]);
    let plan = CyclePlan::default();
    let run = Run::default();
    let refused =
        |array: &AsperityArray, plan| array.cycle(plan, Accuracy::Default, &run).unwrap_err();
    assert_eq!(refused(&plain, plan), SolveError::NoAdhesion);
    let adhesive = array(f64::INFINITY, 1e-3, &[([0.0, 0.0], 100.0, 0.0)]);
    assert_eq!(refused(&adhesive, plan), SolveError::NoFloor);
    let two = Adhesion {
        work_receding: Some(2e-3 * UM),
        ..adhesive.adhesion()
    };
    let two = adhesive.with_adhesion(two).expect("two works");
    assert!(matches!(refused(&two, plan), SolveError::Unsupported(_)));
}
