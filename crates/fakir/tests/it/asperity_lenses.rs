//! Rounded tops under lenses of every shape: closed forms, symmetries and limits.

use fakir::problem::{
    Accuracy, Adhesion, Asperity, AsperityArray, CyclePlan, Indenter, InvalidAsperities,
    LensProfile, LensShape, Load, Material, Point, ShapedLens, UnloadingPoint,
};
use fakir::state::{AsperityContact, AsperityCycle, Run, SolveError};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// Lengths in um, and a reduced modulus of 1 Pa: forces in um^2 Pa.
const UM: f64 = 1e-6;
const FORCE: f64 = 1e-12;

/// Radius of curvature of all tops.
const TOP: f64 = 100.0;

/// A nearly rigid lens.
fn lens(shape: LensShape) -> Indenter {
    Indenter::from(ShapedLens::new(shape, Material::new(1e300, 0.0)))
}

fn sphere(radius: f64) -> Indenter {
    let radius = radius * UM;
    lens(LensShape::Sphere { radius })
}

fn paraboloid(radius: f64) -> Indenter {
    let radius = radius * UM;
    lens(LensShape::Paraboloid { radius })
}

fn cylinder(radius: f64, angle: f64) -> Indenter {
    let radius = radius * UM;
    lens(LensShape::Cylinder { radius, angle })
}

fn plate(tilt: f64, direction: f64) -> Indenter {
    lens(LensShape::Plate { tilt, direction })
}

/// The profile of a function of the radius up to a radius, both in um.
fn profile(end: f64, height: impl Fn(f64) -> f64) -> Indenter {
    let radii = (0..=400).map(|k| end * f64::from(k) / 400.0);
    let heights = radii.clone().map(|r| height(r) * UM);
    let profile = LensProfile::new(radii.clone().map(|r| r * UM).collect(), heights.collect());
    lens(LensShape::Profile(Arc::new(profile.expect("a profile"))))
}

/// Tops at these places with these heights, um.
fn array(indenter: Indenter, tops: &[(Point, f64)]) -> AsperityArray {
    let tops = tops
        .iter()
        .map(|([x, y], raised)| Asperity::new([x * UM, y * UM], TOP * UM).raised_by(raised * UM));
    AsperityArray::new(indenter, Material::new(1.0, 0.0), tops.collect()).expect("an array")
}

fn adhesive(array: AsperityArray, work: f64) -> AsperityArray {
    array
        .with_adhesion(Adhesion::new(work * UM))
        .expect("a work of adhesion")
}

fn press(array: &AsperityArray, indentation: f64) -> AsperityContact {
    let load = Load::Indentation(indentation * UM);
    let contact = array.press(load, Accuracy::Default, &Run::default());
    let contact = contact.expect("a contact");
    assert!(contact.converged(), "{:?}", contact.termination);
    contact
}

fn cycle(array: &AsperityArray, end: f64) -> AsperityCycle {
    let plan = CyclePlan {
        turn: UnloadingPoint::Indentation(end * UM),
        ..CyclePlan::default()
    };
    let cycle = array.cycle(plan, Accuracy::Default, &Run::default());
    let cycle = cycle.expect("a cycle");
    assert!(cycle.converged(), "{:?}", cycle.termination);
    cycle
}

fn close(found: f64, expected: f64, relative: f64) {
    assert!(
        (found / expected - 1.0).abs() < relative,
        "{found:e} {expected:e} {:e}",
        found / expected - 1.0
    );
}

/// Hertz for a combined radius of curvature and an overlap.
fn hertz(radius: f64, overlap: f64) -> f64 {
    4.0 / 3.0 * radius.sqrt() * overlap.powf(1.5)
}

/// Three tops at different heights, without symmetry.
const THREE: [(Point, f64); 3] = [
    ([12.0, 5.0], 0.2),
    ([-26.0, 14.0], 0.0),
    ([6.0, -38.0], -0.1),
];

/// Under a tilted plate, the overlap is a paraboloid with the curvature of the top, whose summit is moved down the plate by `R tan(tilt)`
/// and raised by half of this times the slope.
#[test]
fn a_tilted_plate_on_one_top_is_a_shifted_hertzian_contact() {
    let (tilt, direction, place): (f64, f64, Point) = (0.05, 0.7, [8.0, -5.0]);
    let array = array(plate(tilt, direction), &[(place, 0.3)]);
    let slope = tilt.tan();
    let along = place[0] * direction.cos() + place[1] * direction.sin();
    for indentation in [0.5, 2.0] {
        let overlap = indentation + 0.3 - slope * along + 0.5 * TOP * slope * slope;
        let contact = press(&array, indentation);
        close(contact.force / FORCE, hertz(TOP, overlap), 1e-11);
        close(contact.area / FORCE, PI * TOP * overlap, 1e-11);
        let centre = contact.asperities[0].centre;
        let expected = [
            place[0] - TOP * slope * direction.cos(),
            place[1] - TOP * slope * direction.sin(),
        ];
        for (found, expected) in centre.into_iter().zip(expected) {
            close(found / UM, expected, 1e-10);
        }
    }
    // Its first contact is at the negative of the height of that summit.
    let first = -(0.3 - slope * along + 0.5 * TOP * slope * slope);
    assert!(press(&array, first - 1e-6).touched() == 0);
    assert!(press(&array, first + 1e-6).touched() == 1);
}

/// With adhesion the pull-off of one top is that of Johnson, Kendall and Roberts, `3/2 pi w R`, at any tilt, and with the combined radius
/// under a paraboloid.
#[test]
fn pull_off_forces_of_one_top() {
    let work = 0.05;
    for (indenter, radius) in [(plate(0.03, 2.0), TOP), (paraboloid(300.0), 75.0)] {
        let array = adhesive(array(indenter, &[([6.0, 3.0], 0.0)]), work);
        let cycle = cycle(&array, 1.5);
        let pull_off = cycle.pull_off.expect("tension").force / FORCE;
        close(pull_off, -1.5 * PI * work * radius, 1e-9);
    }
}

/// A level plate is the limit of a tilted one; plates with opposite tilts are mirror images; a plate that rises along y is one along x with
/// the tops rotated.
#[test]
fn symmetric_tilts() {
    for work in [0.0, 0.002] {
        let force = |indenter: Indenter, tops: &[(Point, f64)]| {
            press(&adhesive(array(indenter, tops), work), 1.0).force / FORCE
        };
        let level = force(Indenter::Flat(None), &THREE);
        close(force(plate(1e-9, 0.3), &THREE), level, 1e-7);
        let tilted = force(plate(0.01, 0.0), &THREE);
        assert!((tilted / level - 1.0).abs() > 1e-2);
        let mirrored = THREE.map(|([x, y], raised)| ([-x, y], raised));
        close(force(plate(0.01, PI), &mirrored), tilted, 1e-10);
        let turned = THREE.map(|([x, y], raised)| ([-y, x], raised));
        close(force(plate(0.01, FRAC_PI_2), &turned), tilted, 1e-10);
        close(
            force(cylinder(900.0, FRAC_PI_2), &turned),
            force(cylinder(900.0, 0.0), &THREE),
            1e-10,
        );
    }
}

/// A paraboloid on a top off its axis: Hertz with the combined radius, at the height of the summit of the difference, `d^2/(2 (R1 + R2))`.
#[test]
fn a_paraboloid_on_one_top_is_a_hertzian_contact() {
    let array = array(paraboloid(300.0), &[([12.0, -5.0], 0.1)]);
    let overlap = 1.5 + 0.1 - 169.0 / (2.0 * 400.0);
    let contact = press(&array, 1.5);
    close(contact.force / FORCE, hertz(75.0, overlap), 1e-11);
}

/// Sphere and paraboloid with the same curvature differ by `r^4/(8 R^3)`.
#[test]
fn a_paraboloid_is_a_large_sphere() {
    for work in [0.0, 0.002] {
        let force = |indenter| press(&adhesive(array(indenter, &THREE), work), 1.0).force;
        let difference = [2e3, 4e3].map(|radius: f64| {
            let relative = force(paraboloid(radius)) / force(sphere(radius)) - 1.0;
            println!("{work} {radius}: {relative:e}");
            relative
        });
        assert!(difference[0].abs() < 2e-4);
        // The third power of the curvature.
        close(difference[0] / difference[1], 8.0, 0.2);
    }
}

/// The spline through 401 rows meets the sphere to `1e-9` of its height.
#[test]
fn the_profile_of_a_sphere_is_the_sphere() {
    let radius: f64 = 400.0;
    let table = || profile(120.0, |r| radius - (radius * radius - r * r).sqrt());
    for work in [0.0, 0.002] {
        let found = press(&adhesive(array(table(), &THREE), work), 1.2);
        let expected = press(&adhesive(array(sphere(radius), &THREE), work), 1.2);
        close(found.force, expected.force, 1e-6);
        close(found.area, expected.area, 1e-6);
        assert_eq!(found.touched(), expected.touched());
    }
    // A contact beyond the last row.
    let wide = array(table(), &[([118.0, 0.0], 30.0)]);
    let load = Load::Indentation(UM);
    let refused = wide.press(load, Accuracy::Default, &Run::default());
    let refused = refused.unwrap_err();
    assert!(
        matches!(refused, SolveError::ProfileEnds { .. }),
        "{refused}"
    );
}

/// Hertz for a cylinder on a paraboloid: an ellipse with curvatures `1/R1` and `1/R1 + 1/R2`, by complete elliptic integrals (K. L. Johnson,
/// Contact Mechanics, eq. 4.26). A disc is less stiff, and the estimated error is the difference.
#[test]
fn a_cylinder_on_one_top_is_an_ellipse() {
    for radius in [100.0, 400.0, 1600.0] {
        let array = array(cylinder(radius, 0.4), &[([3.0, 2.0], 0.0)]);
        let contact = press(&array, 1.0);
        // The top at (3, 2) is beside the line of the cylinder.
        let across = 2.0 * 0.4f64.cos() - 3.0 * 0.4f64.sin();
        let overlap = 1.0 - across * across / (2.0 * (radius + TOP));
        let [force, area] = ellipse([1.0 / TOP, 1.0 / TOP + 1.0 / radius], overlap);
        let estimate = contact.error.expect("an estimate");
        let errors = [
            contact.force / FORCE / force - 1.0,
            contact.area / FORCE / area - 1.0,
        ];
        println!("{radius}: {errors:?} {estimate:?}");
        for (error, estimate) in errors.into_iter().zip([estimate.force, estimate.area]) {
            // Half of the estimate at least, which is therefore the difference and not only a bound.
            assert!(
                -error < 1.01 * estimate + 1e-5,
                "{radius}: {error} {estimate}"
            );
            assert!(-error > 0.5 * estimate, "{radius}: {error} {estimate}");
        }
    }
}

/// Force and area of the elliptic contact of two principal curvatures, the smaller one first, at a depth: the ratio `k` of the semi-axes
/// solves `(E/k^2 - K)/(K - E) = B/A`.
fn ellipse([low, high]: [f64; 2], depth: f64) -> [f64; 2] {
    // Complete elliptic integrals of the first and the second kind by the trapezoidal rule, which converges exponentially here.
    let integrals = |k: f64| {
        let terms = (0..400).map(|i| {
            let sine = (FRAC_PI_2 * (f64::from(i) + 0.5) / 400.0).sin();
            let root = (1.0 - (1.0 - k * k) * sine * sine).sqrt();
            [root.recip(), root]
        });
        terms.fold([0.0; 2], |[a, b], [c, d]| {
            [a + c * FRAC_PI_2 / 400.0, b + d * FRAC_PI_2 / 400.0]
        })
    };
    let missing = |k: f64| {
        let [first, second] = integrals(k);
        (second / (k * k) - first) / (first - second) - high / low
    };
    let (mut below, mut above) = (0.1, 1.0 - 1e-9);
    for _ in 0..60 {
        let middle = 0.5 * (below + above);
        if missing(middle) > 0.0 {
            below = middle;
        } else {
            above = middle;
        }
    }
    let k = below;
    let [first, second] = integrals(k);
    let square = 1.0 - k * k;
    let a = (depth * (first - second) / (0.5 * low * square * first)).sqrt();
    let b = k * a;
    let pressure = 0.5 * low * a * a * square / (b * (first - second));
    [2.0 / 3.0 * pressure * PI * a * b, PI * a * b]
}

/// The force under a cylinder tends to that under a plate as the inverse of its radius.
#[test]
fn a_wide_cylinder_is_a_plate() {
    for work in [0.0, 0.002] {
        let force = |indenter| press(&adhesive(array(indenter, &THREE), work), 1.0).force;
        let level = force(Indenter::Flat(None));
        let away = [1e6, 2e6].map(|radius: f64| force(cylinder(radius, 0.3)) / level - 1.0);
        println!("{away:?}");
        assert!(away[0].abs() < 1e-3);
        close(away[0] / away[1], 2.0, 1e-2);
    }
}

/// The loop area of a cycle is the energy that its jumps dissipate, under every lens. The contact under a cylinder is an oval, which is
/// treated as a disc: with curvatures `k (1 + e)` and `k (1 - e)` the difference is of the order of `e^2`, here `0.053^2`.
#[test]
fn cycles_conserve_energy_under_every_lens() {
    for (indenter, allowed) in [
        (plate(0.01, 0.4), 1e-4),
        (cylinder(900.0, 1.0), 2.8e-3),
        (paraboloid(900.0), 1e-4),
        (profile(120.0, |r| r * r / 1800.0 + r.powi(4) / 4e8), 1e-4),
    ] {
        let cycle = cycle(&adhesive(array(indenter, &THREE), 0.002), 1.0);
        let certificate = cycle.certificate().expect("a closed cycle");
        println!("{certificate:e} {:e}", cycle.errors.loop_area);
        assert!(certificate < allowed, "{certificate}");
        assert!(certificate <= cycle.errors.loop_area);
        assert!(cycle.pull_off.expect("tension").force < 0.0);
    }
}

/// A profile with a ring whose underside is concave with a smaller radius than that of the tops touches a top on two sides.
#[test]
fn a_profile_that_is_hollow_over_a_top_is_refused() {
    let tops = vec![Asperity::new([0.0, 0.0], TOP * UM)];
    let wavy = profile(120.0, |r| r * r / 400.0 + 1.28 * (1.0 - (r / 8.0).cos()));
    let refused = AsperityArray::new(wavy, Material::new(1.0, 0.0), tops).unwrap_err();
    assert!(
        matches!(refused, InvalidAsperities::Concave { .. }),
        "{refused}"
    );
}
