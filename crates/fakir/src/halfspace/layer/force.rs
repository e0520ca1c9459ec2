//! Correction of the displacement around a force for layers.

use super::table::{RadialPart, RadialTable};
use crate::halfspace::jet::FieldJet;
use crate::problem::layer::WeightedLayer;

/// Difference from `1/r` around a unit force due to layers, `DK(r) = sum_b (w_b/t_b) Psi_b(r/t_b)`.
#[derive(Debug)]
pub(crate) struct AroundForce {
    table: RadialTable,
    thinnest: f64,
}

impl AroundForce {
    /// Creates the correction for a force at one point; `None` on half-spaces. Layers and distances have the same unit of length.
    pub(crate) fn at_point(layers: &[WeightedLayer]) -> Option<Self> {
        Self::on_cell(layers, [0.0; 2])
    }

    /// Creates the correction for a force that is distributed uniformly over a rectangle with these sides. A wave has the mean
    /// `1 - k_x^2 h^2/24` over a cell with side `h`, so that the integrand is multiplied by `exp(-k^2 h^2/24)`; the error is of fourth
    /// order in `h/t`.
    pub(crate) fn on_cell(layers: &[WeightedLayer], cell: [f64; 2]) -> Option<Self> {
        Self::averaged(layers, cell, 1.0)
    }

    /// The same, averaged over an equal rectangle at the point of observation: the factor is squared.
    pub(crate) fn between_cells(layers: &[WeightedLayer], cell: [f64; 2]) -> Option<Self> {
        Self::averaged(layers, cell, 2.0)
    }

    fn averaged(layers: &[WeightedLayer], cell: [f64; 2], times: f64) -> Option<Self> {
        let [width, height] = cell;
        let thinnest = WeightedLayer::thinnest(layers)?;
        let part = RadialPart {
            factor: 1.0,
            degrees: Vec::new(),
            order: 0,
            power: 0,
        };
        let blur = times * (width * width + height * height) / 48.0;
        let table = RadialTable::new(layers, vec![part]).blurred(blur);
        Some(Self { table, thinnest })
    }

    /// Distance from the nearest singularity of the function: branch points at twice the thickness, along the imaginary axis.
    pub(crate) fn smoothness(&self, distance: f64) -> f64 {
        distance.hypot(2.0 * self.thinnest)
    }

    /// The value at a distance.
    pub(crate) fn value(&self, distance: f64) -> f64 {
        let mut value = [0.0];
        self.table.values(distance, &mut value);
        value[0]
    }

    /// The value `f(r)` at a distance, `f'/r`, and `f''`.
    fn radial(&self, distance: f64) -> [f64; 3] {
        let [mut value, mut first, mut second] = [[0.0]; 3];
        let jets = [&mut value[..], &mut first, &mut second];
        self.table.jets(distance, jets);
        // At the force itself the field is a paraboloid.
        let slope = if distance > 0.0 {
            first[0] / distance
        } else {
            second[0]
        };
        [value[0], slope, second[0]]
    }

    /// The value at a distance, and its derivative divided by the distance.
    pub(crate) fn value_and_slope(&self, distance: f64) -> [f64; 2] {
        let [value, slope, _] = self.radial(distance);
        [value, slope]
    }

    /// The value at a distance and its Laplacian.
    pub(crate) fn value_and_laplacian(&self, distance: f64) -> [f64; 2] {
        let [value, slope, second] = self.radial(distance);
        [value, second + slope]
    }

    /// The value and derivatives at an offset from the force.
    pub(crate) fn jet(&self, [x, y]: [f64; 2]) -> FieldJet {
        let distance = x.hypot(y);
        let [value, slope, second] = self.radial(distance);
        let twist = if distance > 0.0 {
            (second - slope) / (distance * distance)
        } else {
            0.0
        };
        FieldJet {
            value,
            gradient: [slope * x, slope * y],
            hessian: [slope + twist * x * x, twist * x * y, slope + twist * y * y],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::layer::tests::film;

    #[test]
    fn a_point_force_is_the_closed_form() {
        let film = film();
        let response = crate::halfspace::layer::LayerResponse::of(&film);
        let around = AroundForce::at_point(&[film]).unwrap();
        for distance in [0.0, 0.3, 1.0, 4.0, 17.0] {
            let scale = film.weight / film.thickness;
            let exact = scale * response.far_displacement(distance / film.thickness);
            let difference = around.value(distance) - exact;
            assert!(difference.abs() < 1e-14, "{distance} {difference:e}");
        }
        assert!(AroundForce::at_point(&[]).is_none());
    }

    #[test]
    fn a_cell_has_the_mean_of_points() {
        // The mean over a square of side h by 6x6 Gauss points; the error is of order h^4.
        let film = film();
        let around = AroundForce::at_point(&[film]).unwrap();
        let rule = crate::numerics::quadrature::gauss_legendre(6);
        for (side, error) in [(0.4, 1.5e-5), (0.2, 1e-6)] {
            let cell = AroundForce::on_cell(&[film], [side; 2]).unwrap();
            let both = AroundForce::between_cells(&[film], [side; 2]).unwrap();
            for [x, y] in [[0.0, 0.0], [0.8, 0.0], [1.1, 1.4]] {
                let (mut mean, mut mean_of_means) = (0.0, 0.0);
                for (u, along) in &rule {
                    for (v, across) in &rule {
                        let (x, y) = (x + 0.5 * side * u, y + 0.5 * side * v);
                        mean += 0.25 * along * across * around.value(x.hypot(y));
                        mean_of_means += 0.25 * along * across * cell.value(x.hypot(y));
                    }
                }
                let difference = cell.value(x.hypot(y)) - mean;
                assert!(difference.abs() < error, "{side} {x} {y} {difference:e}");
                let difference = both.value(x.hypot(y)) - mean_of_means;
                assert!(difference.abs() < error, "{side} {x} {y} {difference:e}");
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let around = AroundForce::at_point(&[film()]).unwrap();
        let step = 1e-4;
        for [x, y] in [[0.0, 0.0], [0.7, -0.4], [3.0, 2.0]] {
            let jet = around.jet([x, y]);
            let at = |dx: f64, dy: f64| around.jet([x + dx * step, y + dy * step]);
            let (right, left) = (at(1.0, 0.0), at(-1.0, 0.0));
            let (above, below) = (at(0.0, 1.0), at(0.0, -1.0));
            let slope = |a: f64, b: f64| (a - b) / (2.0 * step);
            let expected = [
                (jet.gradient[0], slope(right.value, left.value)),
                (jet.gradient[1], slope(above.value, below.value)),
                (jet.hessian[0], slope(right.gradient[0], left.gradient[0])),
                (jet.hessian[1], slope(above.gradient[0], below.gradient[0])),
                (jet.hessian[2], slope(above.gradient[1], below.gradient[1])),
            ];
            for (found, expected) in expected {
                assert!(
                    (found - expected).abs() < 1e-7,
                    "{x} {y} {found} {expected}"
                );
            }
        }
    }
}
