//! The displacement of the cells from the pressures on them.

use super::rectangle::Rectangle;
use crate::problem::{Cells, HeightMap, Point};
use std::f64::consts::PI;

/// The normal displacement of every cell from the pressure on every cell: linear and symmetric.
///
/// Vectors have one entry for each cell.
pub trait Operator {
    /// Number of unknowns.
    fn len(&self) -> usize;

    /// `displacement = W pressure`, m from Pa.
    ///
    /// # Panics
    /// If a length is not [`len`](Self::len).
    fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]);

    /// The same of a step that pressures take, if there is a quicker way: good to about single precision, relative to the largest displacement.
    ///
    /// # Panics
    /// If a length is not [`len`](Self::len).
    fn apply_to_step(&mut self, step: &[f64], displacement: &mut [f64]) {
        self.apply(step, displacement);
    }

    /// An approximate solution of `W direction = residual`, symmetric and positive; by default
    /// the residual itself.
    ///
    /// # Panics
    /// If a length is not [`len`](Self::len).
    fn precondition(&mut self, residual: &[f64], direction: &mut [f64]) {
        direction.copy_from_slice(residual);
    }

    /// Whether there is nothing to act on.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl<O: Operator + ?Sized> Operator for Box<O> {
    fn len(&self) -> usize {
        (**self).len()
    }

    fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        (**self).apply(pressure, displacement);
    }

    fn apply_to_step(&mut self, step: &[f64], displacement: &mut [f64]) {
        (**self).apply_to_step(step, displacement);
    }

    fn precondition(&mut self, residual: &[f64], direction: &mut [f64]) {
        (**self).precondition(residual, direction);
    }
}

pub(super) fn check_lengths(cells: &Cells, pressure: &[f64], displacement: &[f64]) {
    assert_eq!(pressure.len(), cells.len(), "one pressure for every cell");
    assert_eq!(
        displacement.len(),
        cells.len(),
        "one displacement for every cell"
    );
}

/// The displacement (m) at any point (m) of a half-space of compliance `compliance` (1/Pa) under
/// the pressures (Pa) on `cells`, by summation over all of them.
///
/// # Panics
/// If there is not one pressure for every cell.
#[must_use]
pub fn displacement_at(cells: &Cells, compliance: f64, pressure: &[f64], point: Point) -> f64 {
    assert_eq!(pressure.len(), cells.len(), "one pressure for every cell");
    let [width, height] = cells.grid().cell();
    let rectangle = Rectangle::new(width, height);
    let sum: f64 = cells
        .centres()
        .zip(pressure)
        .map(|([x, y], pressure)| pressure * rectangle.potential(point[0] - x, point[1] - y))
        .sum();
    compliance / PI * sum
}

/// The free half-space by direct summation: the reference for the other operators.
///
/// The work of a product grows as the square of the number of cells.
#[derive(Debug, Clone)]
pub struct Dense {
    cells: Cells,
    /// Displacement of a cell from unit pressure on a cell so many columns and rows away.
    influence: Vec<f64>,
}

impl Dense {
    /// The operator on `cells` of a half-space of compliance `compliance`, 1/Pa: for two bodies
    /// the sum of their `(1 - nu^2)/E`.
    #[must_use]
    pub fn new(cells: Cells, compliance: f64) -> Self {
        let grid = cells.grid();
        let [width, height] = grid.cell();
        let rectangle = Rectangle::new(width, height);
        let influence = (0..grid.rows())
            .flat_map(|row| (0..grid.columns()).map(move |column| (column, row)))
            .map(|(column, row)| {
                compliance / PI * rectangle.potential(column as f64 * width, row as f64 * height)
            })
            .collect();
        Self { cells, influence }
    }

    /// Bytes that the operator takes, without the cells themselves.
    #[must_use]
    pub fn memory_estimate(cells: &Cells) -> usize {
        size_of::<f64>() * cells.grid().cell_count()
    }
}

impl Operator for Dense {
    fn len(&self) -> usize {
        self.cells.len()
    }

    fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        check_lengths(&self.cells, pressure, displacement);
        let columns = self.cells.grid().columns();
        for ((column, row), displacement) in self.cells.positions().zip(displacement) {
            *displacement = self
                .cells
                .positions()
                .zip(pressure)
                .map(|((other_column, other_row), pressure)| {
                    let place = row.abs_diff(other_row) * columns + column.abs_diff(other_column);
                    pressure * self.influence[place]
                })
                .sum();
        }
    }
}

/// An operator with columns under the pillars: each sinks uniformly in proportion to the force on
/// it, which adds a term of rank one for every pillar.
#[derive(Debug, Clone)]
pub struct Columns<O> {
    operator: O,
    /// Pillar of each cell.
    pillars: Vec<u32>,
    /// Displacement of a pillar from the sum of the pressures on its cells, m/Pa.
    influence: Vec<f64>,
    /// Work space: sum of the pressures on each pillar.
    sums: Vec<f64>,
}

impl Columns<()> {
    /// Label of the cells that stand on no pillar.
    pub const NO_PILLAR: u32 = HeightMap::NO_PILLAR;
}

impl<O: Operator> Columns<O> {
    /// Adds columns under the cells of `operator`. `pillars` has one label for every cell:
    /// pillars are counted from zero, and [`Columns::NO_PILLAR`] is none. `influence` is, for
    /// every pillar, how far it sinks for a unit sum of the pressures on its cells, m/Pa: its
    /// compliance, such as `4 h/(pi E d^2)`, times the area of a cell.
    ///
    /// # Panics
    /// If there is not one label for every cell.
    #[must_use]
    pub fn new(operator: O, pillars: Vec<u32>, influence: Vec<f64>) -> Self {
        assert_eq!(pillars.len(), operator.len(), "one label for every cell");
        Self {
            operator,
            // Where none sinks, nothing is asked about them.
            pillars: if influence.is_empty() {
                Vec::new()
            } else {
                pillars
            },
            sums: vec![0.0; influence.len()],
            influence,
        }
    }
}

impl<O: Operator> Operator for Columns<O> {
    fn len(&self) -> usize {
        self.operator.len()
    }

    fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        self.operator.apply(pressure, displacement);
        self.sink(pressure, displacement);
    }

    fn apply_to_step(&mut self, step: &[f64], displacement: &mut [f64]) {
        self.operator.apply_to_step(step, displacement);
        self.sink(step, displacement);
    }

    fn precondition(&mut self, residual: &[f64], direction: &mut [f64]) {
        self.operator.precondition(residual, direction);
    }
}

impl<O> Columns<O> {
    /// Adds what the columns sink.
    fn sink(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        self.sums.fill(0.0);
        // Cells on no pillar have no sum, as their label is beyond the last.
        for (pillar, pressure) in self.pillars.iter().zip(pressure) {
            if let Some(sum) = self.sums.get_mut(*pillar as usize) {
                *sum += pressure;
            }
        }
        for (sum, influence) in self.sums.iter_mut().zip(&self.influence) {
            *sum *= influence;
        }
        for (pillar, displacement) in self.pillars.iter().zip(displacement) {
            if let Some(sum) = self.sums.get(*pillar as usize) {
                *displacement += sum;
            }
        }
    }
}
