//! Wavy surfaces on the periodic half-space. Displacements are relative to their mean, so that the force is prescribed.

use super::{Indenter, assert_within, grid};
use fakir::halfspace::elements::PeriodicConvolution;
use fakir::problem::Cells;
use fakir::solve::elements::solver::Prescribed;
use std::f64::consts::{PI, SQRT_2};

/// Amplitude of the waves of length 1; `E* = 1` throughout.
const AMPLITUDE: f64 = 1e-3;

/// `s = Delta (1 - cos 2 pi x)`, on a few rows.
fn westergaard(columns: usize) -> Indenter<PeriodicConvolution<'static>> {
    let grid = grid(columns, 4, 1.0 / columns as f64);
    Indenter::periodic(Cells::all(&grid), |[x, _]| {
        AMPLITUDE * (1.0 - (2.0 * PI * x).cos())
    })
}

/// H. M. Westergaard, J. Appl. Mech. 6, A-49 (1939); Johnson, Contact Mechanics, section 13.2: contact over `|x| < a` carries
/// `p = p* sin^2(pi a)`, `p* = pi E* Delta/lambda`, distributed as `2 p* cos(pi x) sqrt(sin^2(pi a) - sin^2(pi x))`.
#[test]
fn one_dimensional_wave_as_westergaard() {
    let full = PI * AMPLITUDE;
    let mut indenter = westergaard(512);
    let area = indenter.cells.grid().cell_count() as f64 * indenter.area();
    for half_width in [0.02, 0.1, 0.25, 0.4, 0.47] {
        let edge = (PI * half_width).sin();
        let contact = indenter.press(Prescribed::Force(full * edge * edge * area));
        let width = indenter.contact_area(&contact) / area;
        let cells = 512.0 * (width - 2.0 * half_width).abs();
        assert!(cells <= 2.0, "{width} instead of {}", 2.0 * half_width);

        let peak = 2.0 * full * edge;
        let (mut inside, mut anywhere) = (0.0_f64, 0.0_f64);
        for ([x, _], pressure) in indenter.cells.centres().zip(&contact.pressure) {
            let wave = (PI * x).sin();
            let expected =
                2.0 * full * (PI * x).cos() * (edge * edge - wave * wave).max(0.0).sqrt();
            let error = (pressure - expected).abs() / peak;
            anywhere = anywhere.max(error);
            if (x.abs() - half_width).abs() > 4.0 / 512.0 {
                inside = inside.max(error);
            }
        }
        println!("Westergaard, a = {half_width}: pressure within {inside:.1e}, {anywhere:.1e}");
        assert!(inside < 5e-3, "a = {half_width}: {inside:e}");
        // The profile is a square root at its edges, where the cells are partly in contact.
        let first_cell = (2.0 / (512.0 * half_width)).sqrt();
        assert!(
            anywhere < 0.5 * first_cell,
            "a = {half_width}: {anywhere:e}"
        );
    }
}

/// `s = Delta (1 - cos(2 pi x) cos(2 pi y))` in axes at 45 degrees to the waves, in which a square of side `1/sqrt 2` is a period with one
/// crest.
fn crossed(across: usize) -> Indenter<PeriodicConvolution<'static>> {
    let side = SQRT_2.recip();
    let grid = grid(across, across, side / across as f64);
    Indenter::periodic(Cells::all(&grid), |[u, v]| {
        let wave = |t: f64| (2.0 * PI * t / side).cos();
        AMPLITUDE * (1.0 - 0.5 * (wave(u) + wave(v)))
    })
}

/// Fraction of the surface in contact under a mean pressure, relative to that of full contact: `p* = sqrt(2) pi E* Delta/lambda`.
fn contact_fraction(across: usize, mean_pressure: f64) -> f64 {
    let mut indenter = crossed(across);
    let area = indenter.cells.len() as f64 * indenter.area();
    let full = SQRT_2 * PI * AMPLITUDE;
    let contact = indenter.press(Prescribed::Force(mean_pressure * full * area));
    indenter.contact_area(&contact) / area
}

/// Number of cells along the period.
const ACROSS: usize = 360;

/// Relative change of the area for half a cell at the edge of the round spot that covers this fraction of the period.
fn half_a_cell(fraction: f64) -> f64 {
    let radius = (fraction / PI).sqrt() * ACROSS as f64;
    1.0 / radius
}

/// K. L. Johnson, J. A. Greenwood, J. G. Higginson, Int. J. Mech. Sci. 27, 383 (1985): Hertz's contact at each crest at light load,
/// `A = pi (3 p/(8 pi p*))^(2/3)`.
///
/// The crest is flatter than a paraboloid: around it the mean of the surface over the angle is `Delta ((k r)^2/4 - (k r)^4/64)`,
/// `k = 2 sqrt(2) pi`, so that a contact of radius `a` carries `1 - (k a)^2/10` of Hertz's force and its area is `1 + (k a)^2/15` times
/// larger (Johnson, Contact Mechanics, section 5.3, for the term of fourth degree). Neighbours interact only at the order `(k a)^3`.
#[test]
fn crossed_waves_at_light_load() {
    for pressure in [0.001, 0.003, 0.01] {
        let hertz = PI * (3.0 * pressure / (8.0 * PI)).powf(2.0 / 3.0);
        // Two crests on a unit square, with wave number k.
        let slope = 8.0 * PI * PI * hertz / (2.0 * PI);
        let expected = hertz * (1.0 + slope / 15.0);
        let fraction = contact_fraction(ACROSS, pressure);
        println!("crossed waves, p/p* = {pressure}: {fraction:.5}, {expected:.5}, {hertz:.5}");
        assert_within(
            fraction,
            expected,
            half_a_cell(expected),
            "contact at light load",
        );
    }
}

/// The same close to full contact: the region without contact is a penny-shaped crack at each trough, `1 - A = 3/(2 pi) (1 - p/p*)`.
///
/// A crack of radius `b` closes smoothly if `∫ r T/sqrt(b^2 - r^2) dr = 0` over it. The mean over the angle of the tension in full contact
/// is `T = p* - p - p* ((k r)^2/4 - (k r)^4/64)`: hence `(k b)^2 = 6 (1 - p/p*) (1 + (k b)^2/20)`, of which the authors keep the first
/// order. Cracks interact at the order `(k b)^3`.
#[test]
fn crossed_waves_near_full_contact() {
    for pressure in [0.9, 0.95, 0.98] {
        let slope = 6.0 * (1.0 - pressure);
        let expected = 3.0 / (2.0 * PI) * (1.0 - pressure) * (1.0 + slope / 20.0);
        let open = 1.0 - contact_fraction(ACROSS, pressure);
        println!("crossed waves, p/p* = {pressure}: {open:.5} open, {expected:.5}");
        assert_within(
            open,
            expected,
            half_a_cell(expected),
            "what is not in contact",
        );
    }
}

#[test]
fn crossed_waves_in_full_contact() {
    // p = p* (p_mean/p* + cos cos): full contact from p* on.
    let mut indenter = crossed(64);
    let area = indenter.cells.len() as f64 * indenter.area();
    let full = SQRT_2 * PI * AMPLITUDE;
    let contact = indenter.press_from(Prescribed::Force(1.2 * full * area), 1e-13, None);
    for ((pressure, separation), gap) in contact
        .pressure
        .iter()
        .zip(&indenter.separation)
        .zip(&contact.gap)
    {
        let expected = full * (2.2 - separation / AMPLITUDE);
        assert!((pressure - expected).abs() < 1e-5 * full);
        assert!(gap.abs() < 1e-6 * AMPLITUDE);
    }
}
