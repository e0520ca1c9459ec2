//! Scalar fields in the plane with their derivatives at a point.

/// A scalar field in the plane with its gradient and Hessian `[xx, xy, yy]`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct FieldJet {
    pub(crate) value: f64,
    pub(crate) gradient: [f64; 2],
    pub(crate) hessian: [f64; 3],
}

impl FieldJet {
    /// Adds `factor` times another field.
    pub(crate) fn add_scaled(&mut self, factor: f64, other: &Self) {
        self.value += factor * other.value;
        for k in 0..2 {
            self.gradient[k] += factor * other.gradient[k];
        }
        for k in 0..3 {
            self.hessian[k] += factor * other.hessian[k];
        }
    }

    /// The value at an offset, to second order.
    pub(crate) fn expanded(&self, [x, y]: [f64; 2]) -> f64 {
        let [along, cross, across] = self.hessian;
        let slope = self.gradient[0] * x + self.gradient[1] * y;
        self.value + slope + 0.5 * (along * x * x + across * y * y) + cross * x * y
    }
}
