//! The potential of a hexagonal lattice of unit charges in a neutralising background.
//!
//! If the load varies little between adjacent pillars, their effect at a point is that of the mean pressure plus that of the discreteness
//! of the forces: forces at the lattice points minus the same load distributed uniformly. With `1/r` as the influence of a force, the
//! second part is the electrostatic potential computed here. Lengths are in pitches, charges are 1.

use super::lattice_sums::inverse_power_sum;
use crate::problem::Point;
use std::f64::consts::PI;

const CELL_AREA: f64 = 0.866_025_403_784_438_6;

/// `v_s`: the potential at a lattice point due to all other charges and the background.
///
/// The lattice sum of `1/r`, continued analytically: -4.2134.
#[must_use]
pub fn site_potential() -> f64 {
    inverse_power_sum(1.0)
}

/// `v_h`: the potential at a hollow site, the centre of three neighbouring lattice points:
/// `v_s (sqrt3 - 1)/2` = -1.5422.
///
/// The lattice and its two kinds of hollow sites together are a hexagonal lattice of pitch
/// `1/sqrt3`: `v_s + 2 v_h = sqrt3 v_s`.
#[must_use]
pub fn hollow_potential() -> f64 {
    0.5 * (3f64.sqrt() - 1.0) * site_potential()
}

/// The potential at any point of the plane (in pitches from a lattice point, x along the second-neighbour direction as in
/// [`crate::problem`]). At a lattice point, where it is infinite, the charge at this point is omitted.
///
/// Ewald sum: P. P. Ewald, Annalen der Physik 369, 253 (1921), for charges in a plane.
#[must_use]
pub fn lattice_potential(point: Point) -> f64 {
    ewald(point, 2.0)
}

/// The Ewald sum with the Gaussian charge clouds `exp(-(splitting r)^2)`, `splitting` of order 1.
fn ewald(point: Point, splitting: f64) -> f64 {
    // erfc(6.5) = 4e-20.
    const REACH: f64 = 6.5;
    let background = 2.0 * PI.sqrt() / (CELL_AREA * splitting);
    near_sum(point, splitting, REACH / splitting)
        + far_sum(point, splitting, 2.0 * REACH * splitting)
        - background
}

/// `sum erfc(splitting r)/r`, with `-erf(splitting r)/r` for a charge at the point itself.
fn near_sum(point: Point, splitting: f64, reach: f64) -> f64 {
    let root = 3f64.sqrt();
    let mut sum = 0.0;
    // Rectangular cells of two charges, sqrt3 by 1, around the one nearest to the point.
    let cell_x = (point[0] / root).round() * root;
    let cell_y = point[1].round();
    let columns = (reach / root).ceil() as i32 + 1;
    let rows = reach.ceil() as i32 + 1;
    for column in -columns..=columns {
        for row in -rows..=rows {
            for half in [0.0, 0.5] {
                let x = point[0] - cell_x - root * (f64::from(column) + half);
                let y = point[1] - cell_y - (f64::from(row) + half);
                sum += screened(x.hypot(y), splitting);
            }
        }
    }
    sum
}

fn screened(distance: f64, splitting: f64) -> f64 {
    // At a smaller distance, the coordinates of point and lattice point differ by rounding only.
    if distance < 1e-12 {
        -2.0 * splitting / PI.sqrt()
    } else {
        libm::erfc(splitting * distance) / distance
    }
}

/// `(2 pi/A) sum erfc(G/(2 splitting))/G cos(G x)` over the reciprocal lattice, `G != 0`.
fn far_sum(point: Point, splitting: f64, reach: f64) -> f64 {
    let mut sum = 0.0;
    // Reciprocal vectors of the rectangular cell, (2 pi/sqrt3) m and 2 pi n, with m + n even.
    let step = 2.0 * PI / 3f64.sqrt();
    let columns = (reach / step).ceil() as i32;
    let rows = (reach / (2.0 * PI)).ceil() as i32;
    for m in -columns..=columns {
        for n in -rows..=rows {
            if (m + n) % 2 != 0 || (m, n) == (0, 0) {
                continue;
            }
            let wave = [step * f64::from(m), 2.0 * PI * f64::from(n)];
            let length = wave[0].hypot(wave[1]);
            let phase = wave[0] * point[0] + wave[1] * point[1];
            sum += libm::erfc(0.5 * length / splitting) / length * phase.cos();
        }
    }
    2.0 * PI / CELL_AREA * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hollow() -> Point {
        [1.0 / 3f64.sqrt(), 0.0]
    }

    #[test]
    fn closed_forms_agree_with_the_ewald_sum_and_published_digits() {
        // -4.213422636, -1.542219722: an independent Ewald sum.
        assert!((site_potential() + 4.213_422_636).abs() < 1e-9);
        assert!((hollow_potential() + 1.542_219_722).abs() < 1e-9);
        assert!((site_potential() - lattice_potential([0.0, 0.0])).abs() < 1e-13);
        assert!((hollow_potential() - lattice_potential(hollow())).abs() < 1e-13);
    }

    #[test]
    fn splitting_does_not_matter() {
        for point in [[0.0, 0.0], hollow(), [0.1, 0.0], [0.37, -0.21], [5.2, 3.3]] {
            let reference = ewald(point, 2.0);
            for splitting in [1.0, 1.5, 3.0, 4.0] {
                assert!((ewald(point, splitting) - reference).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn periodic_and_singular_at_the_charges_only() {
        let root = 3f64.sqrt();
        let inside = lattice_potential([0.2, 0.1]);
        assert!((lattice_potential([0.2 + 0.5 * root, 0.1 - 0.5]) - inside).abs() < 1e-12);
        assert!((lattice_potential([0.2 + 40.0 * root, 0.1 + 17.0]) - inside).abs() < 1e-11);
        assert!((lattice_potential([root, 2.0]) - site_potential()).abs() < 1e-12);
        let near = 1e-5;
        assert!((lattice_potential([near, 0.0]) - near.recip() - site_potential()).abs() < 1e-8);
        // Minimum halfway between three charges.
        assert!(hollow_potential() < inside);
        assert!(hollow_potential() < lattice_potential([0.0, 0.5]));
    }
}
