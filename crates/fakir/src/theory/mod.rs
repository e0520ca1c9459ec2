//! Approximate solutions in closed form or with little computation.
//!
//! * [`closed_forms`]: the formulas of the paper for the critical state, as printed and corrected where they differ, the transition curve
//!   and the phase diagram;
//! * [`adhesion`]: single adhesive contacts;
//! * [`stuck_floor`]: the floor bonded to the lens: free annuli around pillars, and the threshold of collapse;
//! * [`lattice_sums`]: the sums over the pillars under a Hertz-like load on which these formulas are based, with the fits of the paper and
//!   the exact limits of the fitted coefficients;
//! * [`lattice_potential`]: the effect of a uniformly loaded lattice of pillars on one pillar and on the floor between three;
//! * [`prony`]: the relaxation function of a table of measured moduli;
//! * [`layer`]: axisymmetric contacts with layers of finite thickness, and the effect of a thick layer on any contact.
//!
//! "The paper" is the publication named in [`crate::problem`]. All quantities are in SI units.

pub mod adhesion;
pub mod closed_forms;
pub mod lattice_potential;
pub mod lattice_sums;
pub mod layer;
mod limits;
pub mod prony;
#[cfg(test)]
pub(crate) mod reference;
pub mod stuck_floor;
mod summits;
