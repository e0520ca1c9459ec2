//! Rounded tops with adhesion and the floor between them in contact at the same time: closed forms, limits and superposition.

use fakir::problem::{
    Accuracy, Adhesion, Asperity, AsperityArray, CyclePlan, FloorModel, Indenter, LensShape, Load,
    LoadingMode, Material, Point, ShapedLens, UnloadingPoint,
};
use fakir::state::{AsperityContact, AsperityCycle, FloorContact, Run};
use fakir::verify_asperities;
use std::f64::consts::PI;

/// Lengths in um, and a reduced modulus of 1 Pa: forces in um^2 Pa, works of adhesion in um Pa.
const UM: f64 = 1e-6;
const FORCE: f64 = 1e-12;

/// Radius of the lens, and radius of curvature of the tops, in um.
const LENS: f64 = 1000.0;
const TOP: f64 = 100.0;

/// Position, radius of the pillar and height of a top, in um.
type Top = (Point, f64, f64);

/// Contacts are within the tops, off their centres, or at a rim.
const WIDE: [Top; 3] = [
    ([9.0, 4.0], 16.0, 0.0),
    ([-24.0, 0.0], 15.0, 0.2),
    ([2.0, 43.0], 16.0, 0.0),
];

/// A rigid paraboloid above tops and a floor at a depth, with a work of adhesion.
fn array(depth: f64, tops: &[Top], work: f64) -> AsperityArray {
    let tops = tops.iter().map(|([x, y], rim, raised)| Asperity {
        rim_radius: Some(rim * UM),
        ..Asperity::new([x * UM, y * UM], TOP * UM).raised_by(raised * UM)
    });
    let shape = LensShape::Paraboloid { radius: LENS * UM };
    let lens: Indenter = ShapedLens::new(shape, Material::new(1e300, 0.0)).into();
    let array = AsperityArray::new(lens, Material::new(1.0, 0.0), tops.collect());
    let array = array.unwrap().with_floor(depth * UM).unwrap();
    array.with_adhesion(Adhesion::new(work * UM)).unwrap()
}

/// The same array with an adhesive floor.
fn with_adhesive_floor(array: &AsperityArray) -> AsperityArray {
    let adhesion = Adhesion {
        floor: true,
        ..array.adhesion()
    };
    array.clone().with_adhesion(adhesion).unwrap()
}

fn pressed(array: &AsperityArray, load: Load) -> AsperityContact {
    let contact = array.press(load, Accuracy::Default, &Run::default());
    let contact = contact.unwrap();
    assert!(contact.converged(), "{:?}", contact.termination);
    contact
}

fn floor(contact: &AsperityContact) -> &FloorContact {
    contact.floor.as_ref().expect("a floor in contact")
}

fn told(contact: &AsperityContact) {
    println!(
        "force {:e}, {:?}; share {:.5}, {:?}, {} cells, {} tops",
        contact.force / FORCE,
        contact.error,
        floor(contact).share,
        floor(contact).error,
        floor(contact).cells.len(),
        contact.touched()
    );
}

/// Expected: the contact without adhesion, which is computed by another method.
#[test]
fn little_adhesion_is_none() {
    for indentation in [1.9, 2.3] {
        let load = Load::Indentation(indentation * UM);
        let plain = pressed(&array(1.0, &WIDE, 0.0), load);
        let found = pressed(&array(1.0, &WIDE, 2e-6), load);
        told(&plain);
        told(&found);
        let force = found.force / plain.force - 1.0;
        let share = floor(&found).share / floor(&plain).share - 1.0;
        let stiffness =
            found.slopes.force_with_indentation / plain.slopes.force_with_indentation - 1.0;
        println!("{force:e} {share:e} {stiffness:e}");
        assert_eq!(found.touched(), plain.touched());
        let [own, other] = [&found, &plain].map(|it| it.error.unwrap().force);
        assert!(force.abs() < own + other && own < 0.02);
        let [own, other] = [&found, &plain].map(|it| floor(it).error.share);
        assert!(share.abs() < own + other && own < 0.15);
        assert!(stiffness.abs() < 0.02);
    }
}

/// Expected: the contact without adhesion, which is computed by another method. The fronts of the floor move cell by cell.
#[test]
fn little_adhesion_of_the_floor_is_none() {
    let load = Load::Indentation(1.6 * UM);
    let plain = pressed(&far_top(150.0, 1.0, 0.0), load);
    let found = pressed(&with_adhesive_floor(&far_top(150.0, 1.0, 2e-6)), load);
    told(&plain);
    told(&found);
    let force = found.force / plain.force - 1.0;
    let share = floor(&found).share / floor(&plain).share - 1.0;
    println!("{force:e} {share:e}");
    let [own, other] = [&found, &plain].map(|it| it.error.unwrap().force);
    assert!(force.abs() < own + other && own < 0.02);
    let [own, other] = [&found, &plain].map(|it| floor(it).error.share);
    assert!(share.abs() < own + other && own < 0.05);
}

/// Indentation and force of an isolated contact of radius `b`: K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301 (1971).
fn jkr(radius: f64, work: f64, b: f64) -> [f64; 2] {
    [
        b * b / radius - (2.0 * PI * work * b).sqrt(),
        4.0 / 3.0 * b.powi(3) / radius - (8.0 * PI * work * b.powi(3)).sqrt(),
    ]
}

/// Expected: a contact of Johnson, Kendall and Roberts and one of Hertz with the floor, `F = 4/3 E* sqrt(R) d^(3/2)`, each lowered by the
/// other as by a point force, `F/(pi E* r)`: the next terms are smaller by the squares of the radii over the distance, a percent of the displacement.
#[test]
fn a_far_top_and_the_floor_are_those_of_superposition() {
    let (away, work, depth, indentation) = (150.0, 2e-3, 1.0, 1.6);
    let plain = far_top(away, depth, work);
    assert!((plain.first_touch() / UM - 0.6).abs() < 1e-9);
    for (array, most) in [(with_adhesive_floor(&plain), 0.4), (plain, 0.01)] {
        let found = pressed(&array, Load::Indentation(indentation * UM));
        told(&found);
        let radius = (TOP.recip() + LENS.recip()).recip();
        // The contact is where the slopes of top and lens are equal.
        let distance = away * LENS / (LENS + TOP);
        let mut forces = [0.0; 2];
        for _ in 0..50 {
            let [of_top, of_floor] = forces;
            let entered = indentation - 0.6 - of_floor / (PI * distance);
            let past = indentation - depth - of_top / (PI * distance);
            forces = [
                jkr_at(radius, work, entered),
                match array.adhesion().floor {
                    true => jkr_at(LENS, work, past),
                    false => 4.0 / 3.0 * LENS.sqrt() * past.powf(1.5),
                },
            ];
        }
        let on_top = found.asperities[0].force / FORCE / forces[0] - 1.0;
        let on_floor = floor(&found).force / FORCE / forces[1] - 1.0;
        println!("{forces:?}: {on_top:e} {on_floor:e}");
        let error = floor(&found).error.share + found.error.unwrap().force;
        assert!(on_top.abs() < 2e-3, "{on_top}");
        assert!(on_floor.abs() < error + 1e-3 && error < most, "{on_floor}");
        assert!(on_floor.abs() < 0.05, "{on_floor}");
    }
}

/// A top that is touched at an indentation of 0.6, at a distance from the axis.
fn far_top(away: f64, depth: f64, work: f64) -> AsperityArray {
    let level = 0.5 * away * away / (LENS + TOP);
    array(depth, &[([away, 0.0], 30.0, level - 0.6)], work)
}

/// The force on such a contact at an indentation.
fn jkr_at(radius: f64, work: f64, indentation: f64) -> f64 {
    let (mut low, mut high) = (2.0, 90.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        match jkr(radius, work, middle)[0] < indentation {
            true => low = middle,
            false => high = middle,
        }
    }
    jkr(radius, work, low)[1]
}

/// Expected: at the critical state the floor carries nothing, just past it little; an unreachable floor changes nothing.
#[test]
fn the_share_of_the_floor_begins_at_zero() {
    let array = array(1.0, &WIDE, 1e-3);
    let run = Run::default();
    let critical = array.transition(Accuracy::Default, &run).unwrap().contact;
    let mut last = f64::INFINITY;
    for past in [1e-1, 3e-2, 1e-2] {
        let load = Load::Indentation((1.0 + past) * critical.indentation);
        let found = pressed(&array, load);
        told(&found);
        let alone = array.press_quickly(load, Accuracy::Default, None, &run);
        let alone = alone.unwrap();
        println!("{past:e}: {:e} above", found.force / alone.force - 1.0);
        let share = floor(&found).share;
        assert!(share < 0.6 * last && share < past);
        assert!(found.force >= alone.force && found.force < (1.0 + 2.0 * share) * alone.force);
        last = share;
    }
    let load = Load::Indentation(0.999 * critical.indentation);
    let before = pressed(&array, load);
    assert!(before.floor.is_none());
    assert!(before.floor_gap.is_some_and(|floor| floor.gap > 0.0));
}

/// Expected: the indentation under the force of a prescribed indentation is that indentation.
#[test]
fn a_prescribed_force_is_that_at_its_indentation() {
    let array = array(1.0, &WIDE, 1e-3);
    let found = pressed(&array, Load::Indentation(2.2 * UM));
    let again = pressed(&array, Load::Force(found.force));
    told(&found);
    told(&again);
    let off = again.indentation / found.indentation - 1.0;
    let share = floor(&again).share / floor(&found).share - 1.0;
    println!("{off:e} {share:e}");
    assert_eq!(again.force.to_bits(), found.force.to_bits());
    assert!((again.indentation - found.indentation).abs() < again.error.unwrap().indentation);
    assert!(share.abs() < floor(&again).error.share);
}

/// A low top, which is touched while the floor carries load already. Expected: before and after, the contacts with three and with four tops
/// in contact; the force drops as the top pulls the lens, and the floor carries more.
#[test]
#[ignore = "slow: a loading with jumps, on three grids at every load"]
fn a_top_jumps_into_contact_past_the_transition() {
    let mut tops = WIDE.to_vec();
    tops.push(([-30.0, -40.0], 12.0, -0.5));
    let array = array(1.0, &tops, 2e-3);
    let at = |indentation: f64| pressed(&array, Load::Indentation(indentation * UM));
    let (mut low, mut high) = (at(1.6), at(2.4));
    assert_eq!([low.touched(), high.touched()], [3, 4]);
    while high.indentation - low.indentation > 0.003 * UM {
        let middle = at(0.5 * (low.indentation + high.indentation) / UM);
        match middle.touched() < 4 {
            true => low = middle,
            false => high = middle,
        }
    }
    told(&low);
    told(&high);
    let last = high.asperities.last().unwrap();
    println!("{} {} {:?}", low.indentation, high.indentation, last);
    assert!(low.asperities.last().unwrap().gap < 0.01 * UM);
    assert!(last.force < 0.0 && last.radius > 2.0 * UM);
    assert!(high.force < low.force);
    assert!(floor(&high).force > floor(&low).force);
}

/// Expected: the floor, which has no adhesion, dissipates nothing and is lost before the tops, so that hysteresis and pull-off are those
/// without floor; the work of the loop is the dissipated energy.
#[test]
fn a_cycle_past_the_transition_loses_the_floor_again() {
    let array = array(1.0, &WIDE, 1e-3);
    let run = Run::default();
    for drive in [LoadingMode::Displacement, LoadingMode::Machine(2e-4)] {
        let plan = CyclePlan {
            turn: UnloadingPoint::Indentation(2.2 * UM),
            drive,
            retract: true,
        };
        let of = |array: &AsperityArray| array.cycle(plan, Accuracy::Default, &run).unwrap();
        let found = of(&array);
        let without = of(&array.clone().with_floor_model(FloorModel::Ignored));
        let ratio = |of: fn(&AsperityCycle) -> f64| of(&found) / of(&without) - 1.0;
        let off = [
            ratio(|it| it.pull_off.as_ref().unwrap().force),
            ratio(|it| it.loop_area.unwrap()),
            ratio(|it| it.dissipation),
        ];
        println!(
            "{off:?} {:?} {:?}, {} and {} steps",
            found.certificate(),
            found.errors,
            found.load_steps.len(),
            without.load_steps.len()
        );
        assert!(found.converged() && without.converged());
        assert!(floor(&found.turn).share > 0.05);
        assert!(found.turn.force > 1.02 * without.turn.force);
        assert!(off[0].abs() < 1e-8 && off[2].abs() < 1e-6);
        assert!(off[1].abs() < found.errors.loop_area + without.errors.loop_area + 1e-6);
        assert!(found.certificate().unwrap() < 1e-3);
        assert_eq!(found.events.len(), without.events.len());
    }
}

/// Expected: the lens on the floor as Johnson, Kendall and Roberts, `F = -3/2 pi w R` at pull-off, lowered by the far top as by a point force, which
/// changes pull-off by less than the force on that top; the fronts dissipate energy, and the loop is closed.
#[test]
#[ignore = "slow: both branches of a cycle on two grids with moving fronts"]
fn an_adhesive_floor_pulls_the_lens_off() {
    let work = 2e-3;
    let plain = far_top(150.0, 1.0, work);
    let run = Run::default();
    let plan = CyclePlan {
        turn: UnloadingPoint::Indentation(1.3 * UM),
        ..CyclePlan::default()
    };
    let of = |array: &AsperityArray| array.cycle(plan, Accuracy::Default, &run).unwrap();
    let (without, found) = (of(&plain), of(&with_adhesive_floor(&plain)));
    let force = |cycle: &AsperityCycle| cycle.pull_off.as_ref().unwrap().force / FORCE;
    let expected = -1.5 * PI * work * LENS;
    println!(
        "{} {} {expected} {:?} {:?} {:?} {:?}",
        force(&without),
        force(&found),
        [without.loop_area, found.loop_area],
        found.dissipation,
        found.certificate(),
        found.errors
    );
    assert!(found.converged() && without.converged());
    let off = (force(&found) - expected).abs();
    assert!(off < found.errors.pull_off_force * expected.abs() + force(&without).abs());
    assert!(found.errors.pull_off_force < 0.1);
    assert!(force(&found) < force(&without));
    assert!(found.dissipation > without.dissipation && without.dissipation > 0.0);
    assert!(found.certificate().unwrap() < found.errors.loop_area);
    assert!(found.separation.unwrap() <= without.separation.unwrap() + 1e-9 * UM);
}

/// Expected: boundary elements on tops and floor, with adhesion of both, which share the laws of fronts only.
#[test]
#[ignore = "slow: an adhesive floor among several tops, against boundary elements"]
fn an_adhesive_floor_as_with_boundary_elements() {
    let array = with_adhesive_floor(&array(1.0, &WIDE, 1e-3));
    let load = Load::Indentation(1.9 * UM);
    let found = verify_asperities(&array, load, 24, &Run::default()).unwrap();
    told(&found.discs);
    let elements = found.elements[1].floor.unwrap();
    let of_area = elements.area / floor(&found.discs).area - 1.0;
    println!(
        "{:?} {:?} {:?} {of_area:e}",
        found.force, found.area, found.floor_share
    );
    assert!(found.force.relative.abs() < 0.01, "{:?}", found.force);
    let share = found.floor_share.unwrap();
    assert!(floor(&found.discs).share < -0.1);
    assert!(share.relative.abs() < share.allowed && share.allowed < 0.6);
    assert!(of_area.abs() < elements.error.area + floor(&found.discs).error.area);
}

/// The floor is reached before the only top. Expected: Hertz's contact with the floor, `F = 4/3 E* sqrt(R) d^(3/2)`, and that of Johnson, Kendall and
/// Roberts with an adhesive floor; past the touch of the top,
/// it too is in contact.
#[test]
fn the_floor_may_be_reached_before_any_top() {
    let array = array(1.0, &[([60.0, 0.0], 12.0, 0.0)], 1e-3);
    assert!(array.first_touch() > 1.6 * UM);
    let depth = 0.5;
    let found = pressed(&array, Load::Indentation((1.0 + depth) * UM));
    told(&found);
    let force = found.force / (4.0 / 3.0 * LENS.sqrt() * depth.powf(1.5) * FORCE) - 1.0;
    let stiffness = 2.0 * (LENS * depth).sqrt() * UM;
    let stiffness = found.slopes.force_with_indentation / stiffness - 1.0;
    println!("{force:e} {stiffness:e}");
    assert_eq!((found.touched(), floor(&found).share), (0, 1.0));
    assert!(force.abs() < found.error.unwrap().force && found.error.unwrap().force < 0.02);
    assert!(stiffness.abs() < 0.03);
    let sticking = pressed(
        &with_adhesive_floor(&array),
        Load::Indentation((1.0 + depth) * UM),
    );
    told(&sticking);
    let force = sticking.force / (jkr_at(LENS, 1e-3, depth) * FORCE) - 1.0;
    println!("{force:e}");
    assert!(force.abs() < sticking.error.unwrap().force && sticking.error.unwrap().force < 0.25);
    let past = pressed(&array, Load::Indentation(2.4 * UM));
    told(&past);
    assert_eq!(past.touched(), 1);
    assert!(floor(&past).share > 0.5 && floor(&past).share < 1.0);
}
