//! How a contact changes with what it was computed from.

use super::checked::check_number;
use super::contact::ContactState;
use super::critical::CriticalState;
use super::error::SolveError;
use crate::problem::Quantity;

/// A contact under a load with its exact derivatives: those of the discrete solution itself, with the states of all pillars as they are. They hold
/// up to the next load at which a pillar is touched or let go, and central differences of the contact equal them.
///
/// The sensitivities come from adjoint solutions: one for the force, which is the response to a unit indentation, and one for the
/// critical state (J. Haslinger and R. A. E. Makinen, Introduction to Shape Optimization, SIAM 2003, sec. 3.3 and 5.3).
///
/// Where several points of the floor are reached at once, as on symmetric lattices, derivatives of the critical state with respect to single pillars
/// are those for one of these points; those with respect to what changes all of them alike hold as they are.
///
/// It is solved to rounding first, so that the contact differs from that of [`press`](crate::press) by less than its error.
#[derive(Debug, Clone)]
pub struct Gradient {
    /// The contact.
    pub contact: ContactState,
    /// `dF/d zeta`, N/m.
    pub stiffness: f64,
    /// Of the force, N; none where it is prescribed.
    pub force: Option<Derivatives>,
    /// Of the indentation, m; none where it is prescribed.
    pub indentation: Option<Derivatives>,
    /// Of the area of contact, m^2; none where the edge of the contact crosses a pillar: on its top the area changes from node to node.
    pub area: Option<Derivatives>,
}

/// Derivatives of a result with respect to quantities of a system, each while all others stay as they are: in units of the result
/// over the SI unit of the quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivatives {
    /// By the height of every touched pillar alone (per m), by its lattice indices, those nearest to the lens axis first. Its column is so much
    /// longer too; the indentation is told from the common height still.
    pub heights: Vec<((i64, i64), f64)>,
    /// By the quantities of the system: lens radius, moduli, Poisson's ratios, diameter, height and pitch. With the height the floor
    /// becomes deeper and columns longer, and with the diameter all columns thicker; with the pitch pillars stay where they are in pitches, the lens
    /// axis between them too.
    pub quantities: Vec<(Quantity, f64)>,
    /// By the column compliance of every pillar ([`System::column_compliance`](crate::problem::System::column_compliance)), per m/N.
    pub column_compliance: f64,
}

impl Derivatives {
    /// That with respect to a quantity of the system, if it is one of those known.
    #[must_use]
    pub fn by(&self, quantity: Quantity) -> Option<f64> {
        let found = self.quantities.iter().find(|(known, _)| *known == quantity);
        found.map(|(_, value)| *value)
    }

    /// Of this result plus a factor times another one.
    pub(crate) fn plus(&self, factor: f64, other: &Self) -> Self {
        self.with(other, |value, other| value + factor * other)
    }

    /// Of the result times a factor.
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
    /// The critical state, where the floor is just reached: of a gradient for [`Load::FloorContact`](crate::problem::Load).
    ///
    /// # Errors
    /// A number that is infinite or undefined.
    pub fn critical_state(&self) -> Result<CriticalState, SolveError> {
        CriticalState::new(self.contact.clone()).checked()
    }

    /// The gradient as it is handed out.
    pub(crate) fn checked(mut self) -> Result<Self, SolveError> {
        self.contact = self.contact.checked()?;
        check_number("stiffness", &mut self.stiffness)?;
        let parts = [&mut self.force, &mut self.indentation, &mut self.area];
        for derivatives in parts.into_iter().flatten() {
            derivatives.check()?;
        }
        Ok(self)
    }
}
