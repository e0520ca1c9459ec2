//! One pillar top: a disc of radius 1 on a half-space of reduced modulus 1.
//!
//! Lengths are in units of the pillar radius `d/2` and pressures in units of the reduced
//! modulus `E*` throughout this module and in [`coupling`](crate::halfspace::coupling). The pressure is
//! `p = q/mu` with `mu = sqrt(1 - rho^2)`, and `q` is expanded in the modes of [`basis`]. On the
//! hemisphere that stands on the disc, with `dOmega` its measure, `p dA = q dOmega`.
//!
//! * [`basis`]: the modes, and the surface displacement each of them makes inside the disc;
//! * [`exterior`]: the displacement outside the disc;
//! * [`nodes`]: the points at which `q >= 0` is asked for;
//! * [`projection`]: the lens shape over a pillar top;
//! * [`covered`]: the part of a partly touched top that is in contact, and the pressure on it;

pub(crate) mod basis;
pub(crate) mod covered;
pub(crate) mod exterior;
pub(crate) mod nodes;
pub(crate) mod projection;
