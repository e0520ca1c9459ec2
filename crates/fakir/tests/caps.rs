//! Rounded tops: closed forms, another program, elements, and what holds for all of them.

use fakir::problem::{
    Accuracy, Cap, CapField, Control, Indenter, Lens, Material, Point,
};
use fakir::state::{CapContact, PillarStatus, Run, SolveError};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::f64::consts::PI;

/// A micrometre, and the unit of force where lengths are in them and the reduced modulus is 1 Pa.
const UM: f64 = 1e-6;
const FORCE: f64 = 1e-12;

/// Of a reduced modulus of 1 Pa against a rigid plate, and half of that against the like.
fn substrate() -> Material {
    Material::new(1.0, 0.0)
}

/// A rigid sphere, or nearly so, of that radius in um; a rigid plate where it is infinite.
fn indenter(radius: f64) -> Indenter {
    if radius.is_infinite() {
        return Indenter::Flat(None);
    }
    Indenter::Lens(Lens {
        radius: radius * UM,
        material: Material::new(1e300, 0.0),
    })
}

/// Caps at places with radii of curvature and heights, all in um.
fn field(indenter: Indenter, caps: &[(Point, f64, f64)]) -> CapField {
    let caps = caps.iter().map(|([x, y], radius, raised)| {
        Cap::new([x * UM, y * UM], radius * UM).raised_by(raised * UM)
    });
    CapField::new(indenter, substrate(), caps.collect()).expect("a field")
}

fn press(field: &CapField, control: Control, accuracy: Accuracy) -> CapContact {
    let contact = field.press(control, accuracy, &Run::default());
    let contact = contact.expect("a contact");
    assert!(contact.converged(), "{:?}", contact.termination);
    contact
}

/// Seven caps of radius of curvature 100, one in the middle of six.
fn seven(pitch: f64) -> Vec<(Point, f64, f64)> {
    let around = (0..6).map(|k| {
        let angle = PI / 3.0 * f64::from(k);
        ([pitch * angle.cos(), pitch * angle.sin()], 100.0, 0.0)
    });
    std::iter::once(([0.0, 0.0], 100.0, 0.0)).chain(around).collect()
}

fn random_seven() -> Vec<(Point, f64, f64)> {
    let file = include_str!("any/rand7.csv");
    let mut reader = csv::Reader::from_reader(file.as_bytes());
    let rows = reader.records().map(|row| {
        let row = row.expect("a row");
        let value = |k: usize| row[k].parse::<f64>().expect("a number");
        ([value(0), value(1)], value(2), value(3))
    });
    rows.collect()
}

/// Numbers between two bounds.
struct Draws(ChaCha8Rng);

impl Draws {
    fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Hertz: `F = 4/3 sqrt(R) zeta^(3/2)`, `A = pi R zeta`.
#[test]
fn a_plate_on_one_cap() {
    let field = field(indenter(f64::INFINITY), &[([3.0, -7.0], 100.0, 0.4)]);
    for zeta in [-0.3, 0.01, 1.0] {
        for accuracy in [Accuracy::Default, Accuracy::Accurate] {
            let contact = press(&field, Control::Indentation(zeta * UM), accuracy);
            let overlap: f64 = zeta + 0.4;
            let force = 40.0 / 3.0 * overlap.powf(1.5) * FORCE;
            assert!((contact.force / force - 1.0).abs() < 1e-12);
            let area = PI * 100.0 * overlap * UM * UM;
            assert!((contact.area / area - 1.0).abs() < 1e-12);
            let slopes = &contact.slopes;
            let stiffness = 1.5 * force / (overlap * UM);
            assert!((slopes.force_with_indentation / stiffness - 1.0).abs() < 1e-9);
            assert!((slopes.area_with_height[0] / (PI * 100.0 * UM) - 1.0).abs() < 1e-9);
            assert!(contact.error.expect("an estimate").force < 1e-8);
            let back = press(&field, Control::Force(force), accuracy);
            assert!((back.indentation - zeta * UM).abs() < 1e-12 * overlap * UM);
        }
    }
    let lifted = press(&field, Control::Indentation(-0.5 * UM), Accuracy::Default);
    assert!(lifted.force == 0.0 && lifted.touched() == 0);
}

/// Two paraboloids: `1/R` is the sum of both curvatures, and the summit lies `X^2/(2(R + rho))` under the lowest point. The sphere is one to 1e-13.
#[test]
fn a_sphere_on_a_cap_off_its_axis() {
    let radius = 1e6;
    let field = field(indenter(radius), &[([24.0, -18.0], 100.0, 0.0)]);
    let contact = press(&field, Control::Indentation(1.0 * UM), Accuracy::Default);
    let overlap: f64 = 1.0 - 900.0 / (2.0 * (radius + 100.0));
    let effective = radius * 100.0 / (radius + 100.0);
    let force = 4.0 / 3.0 * effective.sqrt() * overlap.powf(1.5) * FORCE;
    assert!((contact.force / force - 1.0).abs() < 1e-12);
    assert!((contact.area / (PI * effective * overlap * UM * UM) - 1.0).abs() < 1e-12);
    let shifted = 24.0 * radius / (radius + 100.0) * UM;
    assert!((contact.caps[0].centre[0] - shifted).abs() < 1e-12 * UM);
}

/// By another program with a pressure of degree 6; errors are those it was given with.
#[test]
fn seven_caps_are_those_of_the_reference() {
    let plate = || indenter(f64::INFINITY);
    for (caps, force, force_error, area) in [
        (seven(50.0), 59.3662790748, 1.2e-4, Some((1621.29531523, 1.6e-1))),
        (seven(30.0), 48.6109060015, 9.7e-4, Some((1406.94749079, 1.4))),
        (random_seven(), 39.4573710025, 1.2e-3, None),
    ] {
        let field = field(plate(), &caps);
        for accuracy in [Accuracy::Default, Accuracy::Accurate] {
            let contact = press(&field, Control::Indentation(UM), accuracy);
            let found = contact.force / FORCE;
            let error = contact.error.expect("an estimate");
            println!("{accuracy:?} F {found} {:.2e} A {} steps {} {error:?}", found / force - 1.0, contact.area / UM / UM, contact.iterations);
            assert!((found - force).abs() < force_error, "{found} {force}");
            assert!((found / force - 1.0).abs() < error.force + 1e-7);
            if let Some((area, area_error)) = area {
                let found = contact.area / UM / UM;
                let relative = (found / area - 1.0).abs();
                assert!(relative < error.area, "{found} {area}");
                let bar = if accuracy == Accuracy::Default { 3e-4 * area } else { area_error };
                assert!((found - area).abs() < bar, "{found} {area}");
            }
        }
    }
}
