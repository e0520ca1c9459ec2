//! The potential of the pressure on one cell.

use super::rectangle::Rectangle;
use crate::halfspace::layer::force::AroundForce;
use crate::problem::Point;
use crate::problem::layer::WeightedLayer;

/// The potential of a cell under unit pressure, `∫ 1/r` over the cell, including the correction for [layers](crate::halfspace::layer).
pub(crate) struct CellPotential {
    rectangle: Rectangle,
    area: f64,
    layers: Option<AroundForce>,
}

impl CellPotential {
    /// Creates the potential for cells with these sides, in the unit of length of the layers; `layers` is empty for half-spaces.
    pub(crate) fn new([width, height]: [f64; 2], layers: &[WeightedLayer]) -> Self {
        Self {
            rectangle: Rectangle::new(width, height),
            area: width * height,
            layers: AroundForce::on_cell(layers, [width, height]),
        }
    }

    /// The potential at a position relative to the centre of the cell.
    pub(crate) fn at(&self, [x, y]: Point) -> f64 {
        let potential = self.rectangle.potential(x, y);
        match &self.layers {
            Some(layers) => potential + self.area * layers.value(x.hypot(y)),
            None => potential,
        }
    }
}
