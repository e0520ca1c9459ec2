//! Derivatives of a contact with rounded tops with respect to the numbers of its array.

use super::asperity_contact::AsperityContact;
use super::critical::Critical;
use super::error::SolveError;
use super::finite::check_number;
use crate::problem::{Point, Quantity};

/// A contact with rounded tops at a load, or the critical state, with its exact derivatives: those of the discrete solution, for the same
/// asperities in contact. They are valid up to the next load at which a contact begins or ends.
///
/// A change of a number changes the equations at fixed contacts. The change of the contacts follows from the linearised equations, of
/// which one solution with the transposed matrix for each result is required (the adjoint method; J. Haslinger and R. A. E. Makinen,
/// Introduction to Shape Optimization, SIAM 2003, sec. 3.3).
#[derive(Debug, Clone)]
pub struct AsperityGradient {
    /// The contact.
    pub contact: AsperityContact,
    /// The critical state, if the load is that of the floor contact.
    pub critical: Option<Critical<AsperityContact>>,
    /// `dF/d zeta`, N/m.
    pub stiffness: f64,
    /// Derivatives of the force, N; `None` if it is prescribed.
    pub force: Option<AsperityDerivatives>,
    /// Derivatives of the indentation, m; `None` if it is prescribed.
    pub indentation: Option<AsperityDerivatives>,
    /// Derivatives of the contact area, m^2.
    pub area: AsperityDerivatives,
}

/// Partial derivatives of a result with respect to the numbers of an [array](crate::problem::AsperityArray), in units of the result
/// divided by the SI unit of the number. Lists have one entry for every asperity.
#[derive(Debug, Clone, PartialEq)]
pub struct AsperityDerivatives {
    /// With respect to the position of every asperity along x and y.
    pub apex: Vec<Point>,
    /// With respect to the height of every asperity, at a fixed compliance of its column.
    pub raised: Vec<f64>,
    /// With respect to the radius of curvature of every asperity.
    pub top_radius: Vec<f64>,
    /// With respect to the radius of the rim of every asperity; zero where the contact does not touch it.
    pub rim_radius: Vec<f64>,
    /// With respect to the compliance of the column of every asperity.
    pub column_compliance: Vec<f64>,
    /// With respect to the radius of the lens; zero for a lens without one.
    pub lens_radius: f64,
    /// With respect to the reduced modulus, at fixed compliances of columns and work of adhesion.
    pub reduced_modulus: f64,
    /// With respect to the work of adhesion; zero without adhesion, where it is not differentiable.
    pub work_of_adhesion: f64,
    /// With respect to the depth of the floor; zero unless the load is that of the floor contact.
    pub floor: f64,
    /// With respect to the quantities on which the response of layers relative to that of half-spaces depends, at a fixed reduced modulus;
    /// empty for half-spaces. Moduli and Poisson's ratios of the bodies are among them, as they share the compliance between the bodies.
    pub layers: Vec<(Quantity, f64)>,
}

impl AsperityDerivatives {
    /// Derivatives of this result plus a factor times another one.
    pub(crate) fn plus(&self, factor: f64, other: &Self) -> Self {
        let add = |one: &[f64], two: &[f64]| -> Vec<f64> {
            let pairs = one.iter().zip(two);
            pairs.map(|(one, two)| one + factor * two).collect()
        };
        let places = self.apex.iter().zip(&other.apex);
        let of_layers = self.layers.iter().zip(&other.layers);
        Self {
            layers: of_layers
                .map(|((quantity, one), (_, two))| (*quantity, one + factor * two))
                .collect(),
            apex: places
                .map(|(one, two)| [0, 1].map(|k| one[k] + factor * two[k]))
                .collect(),
            raised: add(&self.raised, &other.raised),
            top_radius: add(&self.top_radius, &other.top_radius),
            rim_radius: add(&self.rim_radius, &other.rim_radius),
            column_compliance: add(&self.column_compliance, &other.column_compliance),
            lens_radius: self.lens_radius + factor * other.lens_radius,
            reduced_modulus: self.reduced_modulus + factor * other.reduced_modulus,
            work_of_adhesion: self.work_of_adhesion + factor * other.work_of_adhesion,
            floor: self.floor + factor * other.floor,
        }
    }

    /// Derivatives of the result times a factor.
    pub(crate) fn times(&self, factor: f64) -> Self {
        self.plus(factor - 1.0, self)
    }

    fn check(&mut self) -> Result<(), SolveError> {
        let lists = [
            &mut self.raised,
            &mut self.top_radius,
            &mut self.rim_radius,
            &mut self.column_compliance,
        ];
        let lists = lists.into_iter().flatten();
        let numbers = [
            &mut self.lens_radius,
            &mut self.reduced_modulus,
            &mut self.work_of_adhesion,
            &mut self.floor,
        ];
        let places = self.apex.iter_mut().flatten();
        let of_layers = self.layers.iter_mut().map(|(_, value)| value);
        for value in lists.chain(numbers).chain(places).chain(of_layers) {
            check_number("gradient", value)?;
        }
        Ok(())
    }
}

impl AsperityGradient {
    /// Checks all numbers before the gradient is returned.
    pub(crate) fn checked(mut self) -> Result<Self, SolveError> {
        check_number("stiffness", &mut self.stiffness)?;
        let parts = [
            self.force.as_mut(),
            self.indentation.as_mut(),
            Some(&mut self.area),
        ];
        for derivatives in parts.into_iter().flatten() {
            derivatives.check()?;
        }
        Ok(self)
    }
}
