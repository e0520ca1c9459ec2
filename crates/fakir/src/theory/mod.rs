//! Approximate answers in closed form or nearly so.
//!
//! * [`closed_forms`]: the paper's formulas for the critical state, as printed and
//!   corrected where they differ, the transition curve and the phase diagram;
//! * [`adhesion`]: lone contacts that stick;
//! * [`stuck_floor`]: the floor stuck to the lens: free annuli round pillars, and when it collapses;
//! * [`lattice_sums`]: the sums over the pillars under a Hertz-like load that they rest on,
//!   with the paper's fits and the exact limits of the fitted coefficients;
//! * [`lattice_potential`]: what a uniformly loaded lattice of pillars does to one pillar
//!   and to the floor between three;
//! * [`layer`]: axisymmetric contacts with layers of finite thickness, and what a thick layer does to any contact.
//!
//! "The paper" is the one named in [`crate::problem`]. All quantities are in SI units.

pub mod adhesion;
pub mod closed_forms;
pub mod lattice_potential;
pub mod lattice_sums;
pub mod layer;
mod limits;
#[cfg(test)]
pub(crate) mod reference;
pub mod stuck_floor;
