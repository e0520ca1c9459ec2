//! The interaction of contact sites as a linear operator.

use crate::numerics::workers::Workers;

/// The loads due to the coefficients of all sites, `B c`. The operator is symmetric: the work of one set of pressures on the displacements
/// of another equals the work of the other on the displacements of the first.
pub(crate) trait Coupling {
    /// `far = B c`, both site by site. The result is undefined after cancellation.
    fn apply(&mut self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>);

    /// The same to about seven digits, if this is faster.
    fn apply_roughly(&mut self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        self.apply(coefficients, far, workers);
    }

    /// Relative error of the products in addition to rounding.
    fn error(&self) -> f64 {
        0.0
    }

    /// Relative error of a solution that is computed from zero with single-precision products; used where the solution is corrected for it.
    fn rough_error(&self) -> f64 {
        0.0
    }
}

/// The sum of two operators, for example of a half-space and of the difference from it.
#[cfg(test)]
pub(crate) struct Sum<A, B> {
    first: A,
    second: B,
    workspace: Vec<f64>,
}

#[cfg(test)]
impl<A, B> Sum<A, B> {
    pub(crate) fn new(first: A, second: B) -> Self {
        Self {
            first,
            second,
            workspace: Vec::new(),
        }
    }
}

#[cfg(test)]
impl<A: Coupling, B: Coupling> Coupling for Sum<A, B> {
    fn apply(&mut self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        self.first.apply(coefficients, far, workers);
        self.workspace.resize(far.len(), 0.0);
        self.second
            .apply(coefficients, &mut self.workspace, workers);
        for (far, more) in far.iter_mut().zip(&self.workspace) {
            *far += more;
        }
    }
}
