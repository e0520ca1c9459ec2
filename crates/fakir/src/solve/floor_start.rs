//! The pressure on the floor of one grid as the start on another.

use super::newton::Newton;
use crate::halfspace::floor::grid::FloorGrid;
use crate::problem::Point;

/// The pressure on the cells of a grid, to be looked up.
///
/// At the edge of a patch the pressure goes as the root of the distance `d`, `C sqrt(d)`, and the gap beyond it as `4/3 C d^(3/2)`, for a unit
/// modulus (Johnson, Contact Mechanics, section 4.2, near the edge). So the square of the one and the power 2/3 of the other are as one linear
/// function, whose zero is the edge, between cells too.
pub(super) struct FloorPressures {
    grid: FloorGrid,
    /// Place of every cell of the grid in the vectors.
    place: Vec<u32>,
    /// `C^2 d`, negative beyond the edge, and the pressure under a unit indentation.
    known: Vec<[f64; 2]>,
}

/// Mean pressure of the cells at an edge over `C` times the root of their side, the edge being anywhere within half a side.
const AT_EDGE: f64 = 0.69;

impl FloorPressures {
    pub(super) fn of(newton: &Newton<'_>) -> Option<Self> {
        let cells = newton.cells.as_ref()?;
        let scale = cells.unit_cell().recip();
        let contact = &newton.contact;
        let grid = cells.grid.cells.grid();
        let mut place = vec![u32::MAX; grid.cell_count()];
        for (number, index) in cells.grid.cells.indices().enumerate() {
            place[index] = number as u32;
        }
        let pressure = |number: usize| contact.floor_coefficients()[number] * scale;
        // All edges alike: it only says how far beyond a cell the zero is.
        let bears = |index: usize| {
            let number = place.get(index).map_or(usize::MAX, |place| *place as usize);
            cells.bears().get(number).is_some_and(|bears| *bears)
        };
        let columns = grid.columns();
        let (mut sum, mut count) = (0.0, 0.0);
        for (number, index) in cells.grid.cells.indices().enumerate() {
            let around = [index + 1, index + columns];
            let before = [1, columns].map(|step| index.wrapping_sub(step));
            if bears(index) && !around.iter().chain(&before).all(|index| bears(*index)) {
                sum += pressure(number);
                count += 1.0;
            }
        }
        let edge = sum / f64::max(count, 1.0) / (AT_EDGE * cells.unit_cell().sqrt());
        let known = contact
            .floor_load()
            .zip(contact.floor_unit_coefficients())
            .enumerate()
            .map(|(number, (load, unit))| {
                let pressure = pressure(number);
                let distance = if cells.bears()[number] {
                    pressure * pressure
                } else {
                    let gap = (-load).max(0.0);
                    -edge * edge * (0.75 * gap / edge).cbrt().powi(2)
                };
                [distance, unit * scale]
            })
            .collect();
        Some(Self {
            known,
            place,
            grid: cells.grid.clone(),
        })
    }

    /// The pressure at a point, and that under a unit indentation; zero outside of the cells.
    pub(super) fn at(&self, point: Point) -> [f64; 2] {
        let Some([nearest, unit]) = self.nearest(point) else {
            return [0.0; 2];
        };
        let distance = self.between(point).unwrap_or(nearest);
        if distance > 0.0 {
            [distance.sqrt(), unit]
        } else {
            [0.0; 2]
        }
    }

    /// What is known of the cell of a point.
    fn nearest(&self, point: Point) -> Option<[f64; 2]> {
        let columns = self.grid.cells.grid().columns();
        let [column, row] = self.grid.position_of(point)?;
        let place = self.place[row * columns + column] as usize;
        self.known.get(place).copied()
    }

    /// Between the centres of cells, linear in either direction; if there are all four.
    fn between(&self, [x, y]: Point) -> Option<f64> {
        let grid = self.grid.cells.grid();
        let ([left, low], [width, height]) = (grid.origin(), grid.cell());
        let (u, v) = ((x - left) / width - 0.5, (y - low) / height - 0.5);
        let (column, row) = (u.floor(), v.floor());
        let (u, v) = (u - column, v - row);
        let mut sum = 0.0;
        for (along, of_u) in [(0.0, 1.0 - u), (1.0, u)] {
            for (up, of_v) in [(0.0, 1.0 - v), (1.0, v)] {
                let weight = of_u * of_v;
                if weight > 1e-9 {
                    let centre = [
                        left + (column + along + 0.5) * width,
                        low + (row + up + 0.5) * height,
                    ];
                    sum += weight * self.nearest(centre)?[0];
                }
            }
        }
        Some(sum)
    }
}
