//! Maps and validity limits of contacts with rounded tops.

use fakir::problem::{
    Accuracy, Adhesion, Asperity, AsperityArray, Indenter, Lens, Load, Material, Point,
};
use fakir::state::{AsperityContact, Limit, Run};
use std::f64::consts::PI;

const UM: f64 = 1e-6;
const RADIUS: f64 = 100.0 * UM;
const FLOOR: f64 = 20.0 * UM;

const RUBBER: Material = Material {
    young_modulus: 2e6,
    poisson_ratio: 0.5,
};

fn press(array: &AsperityArray, load: Load) -> AsperityContact {
    array
        .press(load, Accuracy::Accurate, &Run::default())
        .unwrap()
}

fn one() -> AsperityArray {
    let top = Asperity::new([30.0 * UM, -20.0 * UM], RADIUS);
    AsperityArray::new(Indenter::Flat(None), RUBBER, vec![top]).unwrap()
}

fn beside(distance: f64) -> Point {
    [30.0 * UM + 0.6 * distance, -20.0 * UM + 0.8 * distance]
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{found:e} {expected:e}"
    );
}

/// Hertz's pressure and displacement (K. L. Johnson, Contact Mechanics, eq. 3.39 and 3.42): `p = 2 E* a/(pi R) sqrt(1 - (r/a)^2)`, and outside `u = ((2 a^2 -
/// r^2) arcsin(a/r) + a sqrt(r^2 - a^2))/(pi R)`.
#[test]
fn fields_of_one_top_are_those_of_hertz() {
    let array = one();
    let contact = press(&array, Load::Indentation(UM));
    let fields = contact.fields(&array, FLOOR).unwrap();
    let (radius, depth) = ((RADIUS * UM).sqrt(), UM);
    let top = 2.0 * array.reduced_modulus() * radius / (PI * RADIUS);
    for part in [0.0, 0.4, 0.9, 0.999] {
        let at = beside(part * radius);
        let pressure = top * (1.0 - part * part).sqrt();
        close(fields.pressure(at), pressure, 1e-9 * top);
        let rise = depth - (part * radius).powi(2) / (2.0 * RADIUS);
        close(fields.displacement(at), rise, 1e-9 * depth);
        close(fields.gap(at), 0.0, 1e-9 * depth);
        assert!(fields.is_on_top(at));
    }
    for part in [1.001, 1.5, 3.0, 5.0] {
        let r: f64 = part * radius;
        let square = r * r;
        let outside = (2.0 * radius * radius - square) * (radius / r).asin()
            + radius * (square - radius * radius).sqrt();
        let rise = outside / (PI * RADIUS);
        let at = beside(r);
        close(fields.displacement(at), rise, 1e-9 * depth);
        assert_eq!(fields.pressure(at).to_bits(), 0);
        close(
            fields.gap(at),
            square / (2.0 * RADIUS) + rise - depth,
            1e-9 * depth,
        );
    }
    // The top ends at the floor, at `r^2 = 2 R h`.
    let end = (2.0 * RADIUS * FLOOR).sqrt();
    assert!(fields.is_on_top(beside(0.999 * end)) && !fields.is_on_top(beside(1.001 * end)));
    let far = beside(3.0 * end);
    close(
        fields.gap(far),
        FLOOR - depth + fields.displacement(far),
        1e-15,
    );
}

/// `p = 2 E* a/(pi R) sqrt(1 - rho^2) - sqrt(2 w E*/(pi a))/sqrt(1 - rho^2)` (K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301 (1971)).
#[test]
fn pressures_with_adhesion_are_those_of_johnson_kendall_and_roberts() {
    let work = 50e-3;
    let array = one().with_adhesion(Adhesion::new(work)).unwrap();
    let contact = press(&array, Load::Force(1e-5));
    let fields = contact.fields(&array, FLOOR).unwrap();
    let (radius, modulus) = (contact.asperities[0].radius, array.reduced_modulus());
    let pull = (2.0 * work * modulus / (PI * radius)).sqrt();
    for part in [0.0, 0.5, 0.95, 0.999] {
        let root = (1.0_f64 - part * part).sqrt();
        let pressure = 2.0 * modulus * radius / (PI * RADIUS) * root - pull / root;
        close(
            fields.pressure(beside(part * radius)),
            pressure,
            1e-8 * pull / root,
        );
    }
}

fn sphere() -> Indenter {
    Indenter::from(Lens {
        radius: 3e-3,
        material: RUBBER,
    })
}

/// Nine tops under a lens.
fn nine(rim_radius: Option<f64>, column_compliance: f64) -> AsperityArray {
    let at = |k: i32| f64::from(k - 1) * 30.0 * UM;
    let tops = (0..9).map(|k| Asperity {
        rim_radius,
        column_compliance,
        ..Asperity::new([at(k % 3), at(k / 3)], RADIUS)
    });
    AsperityArray::new(sphere(), RUBBER, tops.collect()).unwrap()
}

/// The gap vanishes in the contacts and nowhere else, and the mean pressures add up to the force; with free edges, and with rims and columns.
#[test]
fn fields_of_many_tops() {
    for (rim, column) in [(None, 0.0), (Some(8.0 * UM), 0.01 / (2e6 * UM))] {
        let array = nine(rim, column);
        let contact = press(&array, Load::Indentation(1.2 * UM));
        assert_eq!(contact.touched(), 9);
        let fields = contact.fields(&array, FLOOR).unwrap();
        for state in &contact.asperities {
            for (part, angle) in [(0.0, 0.0), (0.5, 1.0), (0.9, 2.0)] {
                let at = |part: f64| {
                    let away = part * state.radius;
                    let [x, y] = state.centre;
                    [x + away * f64::cos(angle), y + away * f64::sin(angle)]
                };
                close(fields.gap(at(part)), 0.0, 1e-3 * UM);
                assert!(fields.gap(at(1.3 + part)) > 1e-3 * UM);
            }
        }
        let count = 121;
        let spacing = 100.0 * UM / f64::from(count - 1);
        let axis: Vec<f64> = (0..count)
            .map(|k| spacing * f64::from(k) - 50.0 * UM)
            .collect();
        let samples = fields.on_grid(&axis, &axis, &Run::default()).unwrap();
        let force: f64 = samples.pressure.iter().sum::<f64>() * spacing * spacing;
        close(force / contact.force, 1.0, 5e-3);
        let least = samples.gap.iter().copied().fold(f64::INFINITY, f64::min);
        println!("{rim:?}: {least:e} {:?}", contact.error);
        // Contacts that lean on a rim are discs only approximately.
        let tolerance = rim.map_or(1e-3 * UM, |_| 5e-3 * UM);
        assert!(least > -tolerance, "{least:e}");
        // The floor between the pillars, in the corner of the map; without rims the surface is above it.
        let corner = [axis[0], axis[0]];
        assert_eq!(fields.is_on_top(corner), rim.is_none());
        assert!(rim.is_none() || samples.gap[0] > FLOOR - 1.2 * UM);
        assert!(contact.fields(&one(), FLOOR).is_none());
    }
}

fn limit(limits: &[Limit], name: &str) -> f64 {
    let found = limits.iter().find(|limit| limit.name == name);
    found.unwrap_or_else(|| panic!("{name}: {limits:?}")).value
}

/// By their definitions.
#[test]
fn limits_of_the_model() {
    let array = one();
    let contact = press(&array, Load::Indentation(UM));
    let limits = contact.limits(&array, None);
    close(limit(&limits, "contact_on_top"), 0.1, 1e-9);
    let strain = contact.force / (contact.area * RUBBER.young_modulus);
    close(limit(&limits, "pillar_stress"), strain, 1e-9 * strain);
    assert_eq!(limits.len(), 2, "{limits:?}");
    // Under a lens, on a pillar that shortens as a column of a height of 40 um.
    let (rim, height) = (8.0 * UM, 40.0 * UM);
    let top = Asperity {
        rim_radius: Some(rim),
        column_compliance: height / (RUBBER.young_modulus * PI * rim * rim),
        ..Asperity::new([0.0; 2], RADIUS)
    };
    let array = AsperityArray::new(sphere(), RUBBER, vec![top]).unwrap();
    let contact = press(&array, Load::Indentation(0.5 * UM));
    let limits = contact.limits(&array, None);
    let radius = contact.asperities[0].radius;
    close(limit(&limits, "slope"), radius / 3e-3, 1e-12);
    close(
        limit(&limits, "contact_radius_over_lens_radius"),
        radius / 3e-3,
        1e-12,
    );
    let strain = contact.force / (PI * rim * rim * RUBBER.young_modulus);
    close(limit(&limits, "pillar_stress"), strain, 1e-12);
    // `pi^2 E I/h^2` with `I = pi r^4/4`.
    let euler = PI * PI * RUBBER.young_modulus * PI * rim.powi(4) / 4.0 / (height * height);
    close(limit(&limits, "buckling"), contact.force / euler, 1e-12);
    // Nothing is touched: there is no stress.
    let lifted = press(&array, Load::Indentation(-UM));
    assert!(
        lifted
            .limits(&array, None)
            .iter()
            .all(|limit| !limit.strained)
    );
}
