//! Single contacts on a non-periodic half-space.

use super::{Indenter, assert_within, error, grid};
use fakir::halfspace::elements::{FreeSpaceConvolution, displacement_at};
use fakir::problem::Cells;
use fakir::solve::elements::solver::Prescribed;
use std::f64::consts::PI;

/// A paraboloid of radius 1 at this indentation: `a = sqrt(zeta)`, `F = 4/3 zeta^(3/2)` with
/// `E* = 1` (Johnson, Contact Mechanics, eqs. 4.22 to 4.24).
const INDENTATION: f64 = 0.01;
const CONTACT_RADIUS: f64 = 0.1;

fn hertz_force() -> f64 {
    4.0 / 3.0 * INDENTATION.powf(1.5)
}

/// `across` cells along the diameter of the contact, on a square that is a quarter wider.
pub(super) fn paraboloid(across: usize) -> Indenter<FreeSpaceConvolution<'static>> {
    let count = across + across / 4;
    let grid = grid(count, count, 2.0 * CONTACT_RADIUS / across as f64);
    Indenter::free(Cells::all(&grid), |[x, y]| 0.5 * (x * x + y * y))
}

/// Relative error of the force under a paraboloid.
pub(super) fn hertz_error(across: usize) -> f64 {
    let contact = paraboloid(across).press(Prescribed::Indentation(INDENTATION));
    error(contact.force, hertz_force())
}

#[test]
fn paraboloid_at_an_indentation_as_hertz() {
    let mut indenter = paraboloid(120);
    let contact = indenter.press(Prescribed::Indentation(INDENTATION));
    assert_within(contact.force, hertz_force(), 5e-4, "force");
    let radius = (indenter.contact_area(&contact) / PI).sqrt();
    // Each cell at the edge is either in contact or not.
    assert_within(radius, CONTACT_RADIUS, 1.0 / 120.0, "contact radius");
    check_profile(&indenter, &contact.pressure, CONTACT_RADIUS);
}

#[test]
fn paraboloid_under_a_force_as_hertz() {
    let mut indenter = paraboloid(120);
    let contact = indenter.press(Prescribed::Force(hertz_force()));
    assert_within(contact.force, hertz_force(), 1e-12, "force");
    assert_within(contact.indentation, INDENTATION, 5e-4, "indentation");
    let radius = (indenter.contact_area(&contact) / PI).sqrt();
    assert_within(radius, CONTACT_RADIUS, 1.0 / 120.0, "contact radius");
    check_profile(&indenter, &contact.pressure, CONTACT_RADIUS);
}

/// `p = p0 sqrt(1 - (r/a)^2)` with `p0 = 2 a E*/(pi R)`.
fn check_profile(
    indenter: &Indenter<FreeSpaceConvolution<'static>>,
    pressure: &[f64],
    contact_radius: f64,
) {
    let peak = 2.0 * contact_radius / PI;
    let mut largest: f64 = 0.0;
    for ([x, y], pressure) in indenter.cells.centres().zip(pressure) {
        let r = x.hypot(y) / contact_radius;
        let expected = peak * (1.0 - r * r).max(0.0).sqrt();
        // The slope of the profile is infinite at the edge: the last cells contain averages.
        let tolerance = if r < 0.95 { 3e-3 } else { 0.1 };
        let error = (pressure - expected).abs() / peak;
        assert!(error < tolerance, "{pressure} instead of {expected} at {r}");
        if r < 0.95 {
            largest = largest.max(error);
        }
    }
    println!("Hertz, pressure within {largest:.1e} of the peak up to 0.95 of the radius");
}

#[test]
fn far_away_a_contact_is_a_point_force() {
    // Boussinesq, w = c F/(pi r); the next term is c M/(4 pi r^3) with the second moment
    // M = ∫ p r^2 dA = 2/5 F a^2 of Hertz's pressure.
    let mut indenter = paraboloid(60);
    let contact = indenter.press(Prescribed::Indentation(INDENTATION));
    for (direction, radii) in [(0.0, 3.0_f64), (0.3, 10.0), (2.0, 100.0), (4.0, 1e4)] {
        let distance = radii * CONTACT_RADIUS;
        let point = [
            distance * f64::cos(direction),
            distance * f64::sin(direction),
        ];
        let displacement = displacement_at(&indenter.cells, 1.0, &contact.pressure, point);
        let charge = contact.force / (PI * distance);
        let tolerance = 0.11 / (radii * radii) + 1e-12;
        assert_within(displacement, charge, tolerance, "point force");
        let next = 1.0 + 0.1 / (radii * radii);
        // The next term is (9/64)(3/35 * 8) times the inverse distance to the fourth power, in addition to the error of the elements.
        let tolerance = 0.2 * radii.powi(-4) + 1e-3 * radii.powi(-2) + 1e-12;
        assert_within(displacement, charge * next, tolerance, "with its moment");
    }
}
