//! One pillar top: a disc of radius 1 on a half-space of reduced modulus 1.
//!
//! Lengths are in units of the pillar radius `d/2` and pressures in units of the reduced
//! modulus `E*` throughout this module and in [`coupling`](crate::coupling). The pressure is
//! `p = q/mu` with `mu = sqrt(1 - rho^2)`, and `q` is expanded in the modes of [`basis`]. On the
//! hemisphere that stands on the disc, with `dOmega` its measure, `p dA = q dOmega`.
//!
//! * [`basis`]: the modes, and the surface displacement each of them makes inside the disc;
//! * [`exterior`]: the displacement outside the disc;
//! * [`nodes`]: the points at which `q >= 0` is asked for;
//! * [`unilateral`]: the pressure on one pillar top under a given load, with `q >= 0`;
//! * [`rim`]: a sliver of contact at its rim, by elements;
//! * [`covered`]: the part of a partly touched top that is in contact, and the pressure on it;
//! * [`patch`]: a contact that lies wholly inside one pillar top.

pub(crate) mod basis;
mod cholesky;
pub(crate) mod covered;
pub(crate) mod exterior;
pub(crate) mod nodes;
pub(crate) mod patch;
mod pivoting;
pub(crate) mod rim;
pub(crate) mod special;
pub(crate) mod unilateral;
