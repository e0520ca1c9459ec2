//! Mean displacement of a rectangle due to a loaded rectangle or a loaded pillar top.

use super::far::Part;
use super::grid::{Division, GAUSS};
use crate::halfspace::disc::exterior::Exterior;
use crate::halfspace::layer::force::AroundForce;
use crate::numerics::vector::{LANES, Lanes, widest};
use crate::problem::layer::WeightedLayer;
use std::f64::consts::PI;

/// Distance, in longer sides of a cell, above which the interaction of two rectangles is computed from their moments: there the closed form
/// is a small difference of large terms. The two agree to 1e-10 at this distance.
const FAR: f64 = 24.0;

/// Mean displacement of a rectangle due to a unit pressure on an equal one, on a half-space of unit compliance.
///
/// The integral of `1/(pi r)` over both rectangles is the second difference, in each direction, of
/// `G(x, y) = x y^2/2 asinh(x/|y|) + x^2 y/2 asinh(y/|x|) - r^3/6`, whose fourth mixed derivative is `1/r`.
#[derive(Debug)]
pub(crate) struct Rectangles {
    cell: [f64; 2],
    near: usize,
    /// `G` at integer numbers of cells from -1 on, in units of the cube of the cell's longer side; rows of constant x.
    table: Vec<f64>,
    /// Correction for layers, averaged over both rectangles; `None` on half-spaces.
    layers: Option<AroundForce>,
}

impl Rectangles {
    /// Creates the table on half-spaces or layers, in the unit of length of the cells.
    pub(crate) fn new(division: &Division, layers: &[WeightedLayer]) -> Self {
        let cell = division.cell;
        let longest = division.longest();
        let shortest = cell[0].min(cell[1]);
        let near = (FAR * longest / shortest).ceil() as usize + 1;
        let side = near + 3;
        let table = (0..side * side)
            .map(|index| {
                let (i, j) = (index / side, index % side);
                fourfold_integral(
                    (i as f64 - 1.0) * cell[0] / longest,
                    (j as f64 - 1.0) * cell[1] / longest,
                )
            })
            .collect();
        Self {
            cell,
            near,
            table,
            layers: AroundForce::between_cells(layers, cell),
        }
    }

    /// The displacement of a rectangle at this distance in columns and rows.
    #[cfg(test)]
    pub(crate) fn value(&self, columns: usize, rows: usize) -> f64 {
        let mut values = vec![0.0; columns + 1];
        self.fill_row(rows, &mut values);
        values[columns]
    }

    /// The displacements of the rectangles at this distance in rows, by columns.
    pub(crate) fn fill_row(&self, rows: usize, values: &mut [f64]) {
        let [width, height] = self.cell;
        let y = rows as f64 * height;
        let far = FAR * width.max(height);
        let is_near = |columns: &usize| (*columns as f64 * width).hypot(y) <= far;
        let near = (0..values.len()).take_while(is_near).count();
        for (columns, value) in values[..near].iter_mut().enumerate() {
            *value = self.by_differences(columns, rows);
        }
        widest(
            #[inline(always)]
            || {
                for (columns, value) in values.iter_mut().enumerate().skip(near) {
                    *value = self.by_moments(columns as f64 * width, y);
                }
            },
        );
        if let Some(layers) = &self.layers {
            let factor = width * height / PI;
            for (columns, value) in values.iter_mut().enumerate() {
                *value += factor * layers.value((columns as f64 * width).hypot(y));
            }
        }
    }

    fn by_differences(&self, columns: usize, rows: usize) -> f64 {
        let [width, height] = self.cell;
        let side = self.near + 3;
        let row = |i: usize| {
            let from = (columns + i) * side + rows;
            let [before, at, after] = [0, 1, 2].map(|j| self.table[from + j]);
            before - 2.0 * at + after
        };
        let difference = row(0) - 2.0 * row(1) + row(2);
        difference * width.max(height).powi(3) / (PI * width * height)
    }

    /// The expansion about the centres of both, to fourth order in the sides divided by the distance.
    #[inline(always)]
    fn by_moments(&self, x: f64, y: f64) -> f64 {
        let [width, height] = self.cell;
        let inverse_square = (x * x + y * y).recip();
        let (cx, cy) = (x * x * inverse_square, y * y * inverse_square);
        let (p, q) = (
            width * width * inverse_square,
            height * height * inverse_square,
        );
        let second = (p * (3.0 * cx - 1.0) + q * (3.0 * cy - 1.0)) / 12.0;
        let pure = |c: f64| 9.0 - 90.0 * c + 105.0 * c * c;
        let fourth = (p * p * pure(cx) + q * q * pure(cy)) / 360.0
            + p * q * (105.0 * cx * cy - 12.0) / 144.0;
        width * height * inverse_square.sqrt() / PI * (1.0 + second + fourth)
    }
}

/// `G(x, y)`, even in both.
fn fourfold_integral(x: f64, y: f64) -> f64 {
    let (x, y) = (x.abs(), y.abs());
    let distance = x.hypot(y);
    let part = |a: f64, b: f64| {
        if a > 0.0 && b > 0.0 {
            0.5 * a * b * b * (a / b).asinh()
        } else {
            0.0
        }
    };
    part(x, y) + part(y, x) - distance.powi(3) / 6.0
}

/// Mean displacement of rectangles due to the modes of a pillar top whose centre is a corner of the grid: by two Gauss points in each
/// direction. Zero on rectangles that the top covers or cuts. The far [part](Part) is evaluated at the centres.
pub(crate) struct PillarMeans {
    exterior: Exterior,
    part: Part,
    /// Lower left corners are integer multiples of this.
    cell: [f64; 2],
    /// The Gauss points relative to the lower left corner.
    points: [Lanes; 2],
    values: Vec<Lanes>,
}

impl PillarMeans {
    /// Prepares the means for the modes up to a degree, on half-spaces or layers.
    pub(super) fn new(
        division: &Division,
        degree: usize,
        layers: &[WeightedLayer],
        part: Part,
    ) -> Self {
        let cell = division.cell;
        let sides = if part.is_at_centres() {
            [0.0; 2]
        } else {
            [-GAUSS, GAUSS]
        };
        let along = |k: usize, of: [usize; LANES]| {
            Lanes(of.map(|point| 0.5 * cell[k] * (1.0 + sides[point])))
        };
        let exterior = Exterior::new(degree).with_layers(layers, &[1.0]);
        Self {
            cell,
            points: [along(0, [0, 0, 1, 1]), along(1, [0, 1, 0, 1])],
            values: vec![Lanes::default(); exterior.count()],
            exterior,
            part,
        }
    }

    /// Computes the means for rectangles whose lower left corners are `row` cells above the centre, into the first half of the columns of
    /// every mode.
    pub(crate) fn fill_row(&mut self, row: usize, columns: usize, means: &mut [f64]) {
        let y = row as f64 * self.cell[1];
        let at_y = Lanes::splat(y) + self.points[1];
        widest(
            #[inline(always)]
            || {
                for column in 0..columns / 2 {
                    let x = column as f64 * self.cell[0];
                    // Corners on the rim belong to cells outside the top, despite rounding.
                    let covered = x * x + y * y < 1.0 - 1e-12;
                    let zero = covered || self.part.is_zero_from(x.hypot(y));
                    let at_x = Lanes::splat(x) + self.points[0];
                    let mut weight = Lanes::splat(0.25);
                    if !zero {
                        let radii = Lanes::splat(1.0);
                        self.exterior
                            .lane_values([at_x, at_y], radii, &mut self.values);
                        weight = weight * self.part.weight(at_x * at_x + at_y * at_y);
                    }
                    for (mode, value) in self.values.iter().enumerate() {
                        let mean = if zero { 0.0 } else { (weight * *value).sum() };
                        means[mode * columns + column] = mean;
                    }
                }
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::elements::Rectangle;
    use crate::numerics::quadrature::gauss_legendre;

    fn division() -> Division {
        Division {
            fineness: 4,
            parts: [7, 4],
            cell: [0.37, 0.31],
        }
    }

    /// Love's potential of one rectangle, averaged over the other by Gauss quadrature on subdivisions.
    #[test]
    fn rectangles_by_quadrature() {
        let division = division();
        let [width, height] = division.cell;
        let (kernel, rectangle) = (
            Rectangles::new(&division, &[]),
            Rectangle::new(width, height),
        );
        let rule = gauss_legendre(24);
        for (columns, rows) in [
            (2, 0),
            (0, 3),
            (1, 2),
            (5, 7),
            (19, 11),
            (30, 0),
            (22, 31),
            (200, 100),
        ] {
            let mut mean = 0.0;
            for (u, weight_u) in &rule {
                for (v, weight_v) in &rule {
                    let x = (columns as f64 + 0.5 * u) * width;
                    let y = (rows as f64 + 0.5 * v) * height;
                    mean += 0.25 * weight_u * weight_v * rectangle.potential(x, y) / PI;
                }
            }
            let found = kernel.value(columns, rows);
            assert!(
                (found / mean - 1.0).abs() < 3e-10,
                "{columns} {rows}: {found} {mean}"
            );
        }
    }

    #[test]
    fn the_own_mean_of_a_square_has_its_closed_form() {
        // 4 ln(1 + sqrt 2) - 4 (sqrt 2 - 1)/3, the mean of 1/r over a unit square and itself.
        let division = Division {
            fineness: 1,
            parts: [1, 1],
            cell: [0.2, 0.2],
        };
        let root = 2f64.sqrt();
        let expected = 4.0 * root.ln_1p() - 4.0 * (root - 1.0) / 3.0;
        let found = Rectangles::new(&division, &[]).value(0, 0) * PI / 0.2;
        assert!((found / expected - 1.0).abs() < 1e-13, "{found} {expected}");
    }

    #[test]
    fn closed_form_and_moments_agree_where_they_meet() {
        let division = division();
        let kernel = Rectangles::new(&division, &[]);
        for columns in 0..24usize {
            for rows in 0..29usize {
                let x = columns as f64 * division.cell[0];
                let y = rows as f64 * division.cell[1];
                let distance = x.hypot(y);
                if !(0.9 * FAR * 0.37..=FAR * 0.37).contains(&distance) {
                    continue;
                }
                let (near, far) = (kernel.value(columns, rows), kernel.by_moments(x, y));
                assert!(
                    (near / far - 1.0).abs() < 1e-9,
                    "{columns} {rows}: {near} {far}"
                );
            }
        }
    }

    /// The displacement due to a pillar top, averaged by Gauss quadrature of high order.
    #[test]
    fn pillars_by_quadrature() {
        let division = division();
        let [width, height] = division.cell;
        let exterior = Exterior::new(2);
        let rule = gauss_legendre(20);
        let mut of_pillar = PillarMeans::new(&division, 2, &[], Part::Whole);
        for ([columns, rows], tolerance) in [([3, 1], 2e-3), ([7, 4], 1e-5), ([20, 31], 1e-8)] {
            let (mut workspace, mut row, mut expected) = ([0.0; 6], [0.0; 6 * 80], [0.0; 6]);
            of_pillar.fill_row(rows, 80, &mut row);
            let means: [f64; 6] = std::array::from_fn(|mode| row[mode * 80 + columns]);
            for (u, weight_u) in &rule {
                for (v, weight_v) in &rule {
                    let x = (columns as f64 + 0.5 + 0.5 * u) * width;
                    let y = (rows as f64 + 0.5 + 0.5 * v) * height;
                    exterior.values([x, y], 1.0, &mut workspace);
                    for (sum, value) in expected.iter_mut().zip(&workspace) {
                        *sum += 0.25 * weight_u * weight_v * value;
                    }
                }
            }
            for (found, expected) in means.iter().zip(&expected) {
                let error = (found - expected).abs() / means[0];
                assert!(error < tolerance, "{columns} {rows}: {found} {expected}");
            }
        }
    }
}
