//! One pillar top: a disc of radius 1 on a half-space of reduced modulus 1.
//!
//! Lengths are in units of the pillar radius `d/2` and pressures in units of the reduced modulus `E*` throughout this module and in
//! [`coupling`](crate::halfspace::coupling). The pressure is `p = q/mu` with `mu = sqrt(1 - rho^2)`, and `q` is expanded in the modes of
//! [`basis`]. On the hemisphere above the disc, with the measure `dOmega`, `p dA = q dOmega`.
//!
//! * [`basis`]: the modes, and the surface displacement due to each of them inside the disc;
//! * [`exterior`]: the displacement outside the disc;
//! * [`mode_rule`]: integrals of modes times functions over a disc;
//! * [`nodes`]: the points at which `q >= 0` is required;
//! * [`projection`]: the lens shape over a pillar top;
//! * [`covered`]: the region in contact on a partially covered top, and the pressure on it;

pub(crate) mod basis;
pub(crate) mod covered;
pub(crate) mod exterior;
pub(crate) mod mode_rule;
pub(crate) mod nodes;
pub(crate) mod projection;
