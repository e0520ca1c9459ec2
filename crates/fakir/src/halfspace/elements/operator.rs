//! The displacement of cells due to the pressures on them.

use super::rectangle::Rectangle;
use crate::problem::{Cells, HeightMap, Point};
use std::f64::consts::PI;

/// The normal displacement of every cell due to the pressure on every cell: linear and symmetric.
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

    /// The same for a pressure step, if there is a faster way: accurate to about single precision, relative to the largest displacement.
    ///
    /// # Panics
    /// If a length is not [`len`](Self::len).
    fn apply_to_step(&mut self, step: &[f64], displacement: &mut [f64]) {
        self.apply(step, displacement);
    }

    /// An approximate solution of `W direction = residual`, symmetric and positive; by default the residual itself.
    ///
    /// # Panics
    /// If a length is not [`len`](Self::len).
    fn precondition(&mut self, residual: &[f64], direction: &mut [f64]) {
        direction.copy_from_slice(residual);
    }

    /// Whether there are no unknowns.
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

/// The displacement (m) at any point (m) of a half-space with the given `compliance` (1/Pa) under the pressures (Pa) on `cells`, by direct
/// summation.
///
/// # Panics
/// If the number of pressures is not the number of cells.
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

/// The non-periodic half-space by direct summation: the reference for the other operators.
///
/// The work of a product is proportional to the square of the number of cells.
#[derive(Debug, Clone)]
pub struct Dense {
    cells: Cells,
    /// Displacement of a cell due to unit pressure on a cell at this distance in columns and rows.
    influence: Vec<f64>,
}

impl Dense {
    /// The operator on `cells` of a half-space with the given `compliance` in 1/Pa: for two bodies, the sum of their `(1 - nu^2)/E`.
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

    /// Memory in bytes of the operator, without the cells themselves.
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

/// An operator with elastic columns (pillars) under cells. The displacement of each pillar is uniform and proportional to its force, which
/// adds a term of rank one per pillar.
#[derive(Debug, Clone)]
pub struct Columns<O> {
    operator: O,
    /// Pillar of each cell.
    pillars: Vec<u32>,
    /// Displacement of a pillar per sum of the pressures on its cells, m/Pa.
    influence: Vec<f64>,
    /// Workspace: sum of the pressures on each pillar.
    sums: Vec<f64>,
}

impl Columns<()> {
    /// Label of cells that belong to no pillar.
    pub const NO_PILLAR: u32 = HeightMap::NO_PILLAR;
}

impl<O: Operator> Columns<O> {
    /// Adds columns under the cells of `operator`. `pillars` contains one label for every cell: pillars are numbered from zero, and
    /// [`Columns::NO_PILLAR`] means no pillar. `influence` contains the displacement of every pillar per sum of the pressures on its cells,
    /// m/Pa: its compliance, such as `4 h/(pi E d^2)`, times the area of a cell.
    ///
    /// # Panics
    /// If the number of labels is not the number of cells.
    #[must_use]
    pub fn new(operator: O, pillars: Vec<u32>, influence: Vec<f64>) -> Self {
        assert_eq!(pillars.len(), operator.len(), "one label for every cell");
        Self {
            operator,
            // Without compliant pillars, the labels are not used.
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
    /// Adds the displacements of the columns.
    fn sink(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        self.sums.fill(0.0);
        // Cells without a pillar have no sum, since their label exceeds the last index.
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
