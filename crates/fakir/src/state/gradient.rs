//! Derivatives of a contact with respect to its input quantities.

use super::contact::ContactState;
use super::critical::CriticalState;
use super::error::SolveError;
use super::finite::check_number;
use crate::problem::Quantity;

/// A contact under a load with its exact derivatives: those of the discrete solution, at constant contact states of all pillars. They are
/// valid up to the next load at which a pillar comes into contact or detaches, and equal central differences of the contact.
///
/// The sensitivities follow from adjoint solutions: one for the force, which is the response to a unit indentation, and one for the
/// critical state (J. Haslinger and R. A. E. Makinen, Introduction to Shape Optimization, SIAM 2003, sec. 3.3 and 5.3).
///
/// If several points of the floor are reached simultaneously, as on symmetric lattices, derivatives of the critical state with respect to
/// single pillars are those for one of these points; derivatives with respect to quantities that affect all points equally are valid
/// without restriction.
///
/// The contact is first solved to rounding, so that it differs from that of [`press`](crate::press) by less than its error.
///
/// Past the transition the states of the floor cells are constant too. Cells at the edge of the floor contact come and go with any change of
/// the load, and cause noise in differences over small steps, but hardly affect these derivatives, as their pressure is near zero.
///
/// On a [flat surface](crate::problem::FlatSystem::gradient), `C` is a [`FlatContact`](super::FlatContact), and there are no pillars.
#[derive(Debug, Clone)]
pub struct Gradient<C = ContactState> {
    /// The contact.
    pub contact: C,
    /// `dF/d zeta`, N/m.
    pub stiffness: f64,
    /// Derivatives of the force, N; `None` if it is prescribed.
    pub force: Option<Derivatives>,
    /// Derivatives of the indentation, m; `None` if it is prescribed.
    pub indentation: Option<Derivatives>,
    /// Derivatives of the contact area, m^2; `None` if the edge of the contact crosses a pillar, whose area in contact changes in steps of
    /// nodes, and with floor contact, whose area changes in steps of cells.
    pub area: Option<Derivatives>,
}

/// Partial derivatives of a result with respect to quantities of a system, in units of the result divided by the SI unit of the quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivatives {
    /// Derivatives with respect to the height of every pillar in contact (per m), by its lattice indices, in order of increasing distance
    /// from the lens axis. The column becomes longer as well; the indentation remains relative to the common height.
    pub heights: Vec<((i64, i64), f64)>,
    /// Derivatives with respect to the quantities of the system: lens radius, moduli, Poisson's ratios, diameter, height and pitch. The
    /// height changes the depth of the floor and the length of columns, the diameter the thickness of all columns; with the pitch, the
    /// positions of pillars and lens axis in units of the pitch remain constant.
    pub quantities: Vec<(Quantity, f64)>,
    /// Derivative with respect to the column compliance of every pillar
    /// ([`System::column_compliance`](crate::problem::System::column_compliance)), per m/N.
    pub column_compliance: f64,
}

impl Derivatives {
    /// The derivative with respect to a quantity of the system; `None` if it is not available.
    #[must_use]
    pub fn by(&self, quantity: Quantity) -> Option<f64> {
        let found = self.quantities.iter().find(|(known, _)| *known == quantity);
        found.map(|(_, value)| *value)
    }

    /// Derivatives of this result plus a factor times another one.
    pub(crate) fn plus(&self, factor: f64, other: &Self) -> Self {
        self.with(other, |value, other| value + factor * other)
    }

    /// Derivatives of the result times a factor.
    pub(crate) fn times(&self, factor: f64) -> Self {
        self.with(self, |value, _| factor * value)
    }

    fn with(&self, other: &Self, each: impl Fn(f64, f64) -> f64) -> Self {
        let heights = self.heights.iter().zip(&other.heights);
        let quantities = self.quantities.iter().zip(&other.quantities);
        Self {
            heights: heights
                .map(|((index, value), (_, other))| (*index, each(*value, *other)))
                .collect(),
            quantities: quantities
                .map(|((quantity, value), (_, other))| (*quantity, each(*value, *other)))
                .collect(),
            column_compliance: each(self.column_compliance, other.column_compliance),
        }
    }

    fn check(&mut self) -> Result<(), SolveError> {
        let heights = self.heights.iter_mut().map(|(_, value)| value);
        let quantities = self.quantities.iter_mut().map(|(_, value)| value);
        let own = std::iter::once(&mut self.column_compliance);
        for value in heights.chain(quantities).chain(own) {
            check_number("gradient", value)?;
        }
        Ok(())
    }
}

impl Gradient {
    /// The critical state, of a gradient for [`Load::FloorContact`](crate::problem::Load).
    ///
    /// # Errors
    /// A number that is infinite or undefined.
    pub fn critical_state(&self) -> Result<CriticalState, SolveError> {
        CriticalState::new(self.contact.clone()).checked()
    }

    /// Checks the gradient before it is returned.
    pub(crate) fn checked(mut self) -> Result<Self, SolveError> {
        self.contact = self.contact.checked()?;
        self.with_checked_derivatives()
    }
}

impl<C> Gradient<C> {
    /// The gradient of a contact that has been checked.
    pub(crate) fn with_checked_derivatives(mut self) -> Result<Self, SolveError> {
        check_number("stiffness", &mut self.stiffness)?;
        let parts = [&mut self.force, &mut self.indentation, &mut self.area];
        for derivatives in parts.into_iter().flatten() {
            derivatives.check()?;
        }
        Ok(self)
    }
}
