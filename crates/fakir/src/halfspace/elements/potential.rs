//! What the pressure on one cell does around it.

use super::rectangle::Rectangle;
use crate::halfspace::layer::force::AroundForce;
use crate::problem::Point;
use crate::problem::layer::WeightedLayer;

/// The potential of a cell under unit pressure, `∫ 1/r` over it, with what [layers](crate::halfspace::layer) add.
pub(crate) struct CellPotential {
    rectangle: Rectangle,
    area: f64,
    layers: Option<AroundForce>,
}

impl CellPotential {
    /// Of cells of these sides, in the unit of length of the layers; half-spaces have none.
    pub(crate) fn new([width, height]: [f64; 2], layers: &[WeightedLayer]) -> Self {
        Self {
            rectangle: Rectangle::new(width, height),
            area: width * height,
            layers: AroundForce::on_cell(layers, [width, height]),
        }
    }

    /// What layers add around a unit force on a cell.
    pub(super) fn layers(&self) -> Option<&AroundForce> {
        self.layers.as_ref()
    }

    /// At a place seen from the middle of the cell.
    pub(crate) fn at(&self, [x, y]: Point) -> f64 {
        let potential = self.rectangle.potential(x, y);
        match &self.layers {
            Some(layers) => potential + self.area * layers.value(x.hypot(y)),
            None => potential,
        }
    }
}
