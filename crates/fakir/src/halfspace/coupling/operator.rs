//! What places of contact do to each other, as a linear operator.

use crate::numerics::workers::Workers;

/// The loads that the coefficients of all places make on each other, `B c`. It is symmetric: the work that one set of pressures does
/// on the displacements of another is that of the other on those of the one.
pub(crate) trait Coupling {
    /// `far = B c`, both place by place. If it is cancelled, anything.
    fn apply(&mut self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>);

    /// The same to about seven digits, if that is quicker.
    fn apply_roughly(&mut self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        self.apply(coefficients, far, workers);
    }

    /// Relative error of its products beyond rounding.
    fn error(&self) -> f64 {
        0.0
    }

    /// Relative error of a solution from nothing by rough products, where they are to be made up for.
    fn rough_error(&self) -> f64 {
        0.0
    }
}

/// The sum of two operators, such as of a half-space and of what differs from it.
#[cfg(test)]
pub(crate) struct Sum<A, B> {
    first: A,
    second: B,
    room: Vec<f64>,
}

#[cfg(test)]
impl<A, B> Sum<A, B> {
    pub(crate) fn new(first: A, second: B) -> Self {
        Self {
            first,
            second,
            room: Vec::new(),
        }
    }
}

#[cfg(test)]
impl<A: Coupling, B: Coupling> Coupling for Sum<A, B> {
    fn apply(&mut self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        self.first.apply(coefficients, far, workers);
        self.room.resize(far.len(), 0.0);
        self.second.apply(coefficients, &mut self.room, workers);
        for (far, more) in far.iter_mut().zip(&self.room) {
            *far += more;
        }
    }
}
