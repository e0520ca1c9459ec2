//! How pillars act on each other through the half-space.
//!
//! Lengths in pillar radii, pressures in units of the reduced modulus, as in
//! [`disc`](super::disc). [`pair`] has the coefficients between two pillars in closed form;
//! [`lattice`] applies those of all pillars of a window at once, directly for few and by
//! fast Fourier transform for many.

pub(crate) mod convolution;
mod direct;
pub(crate) mod lattice;
pub(crate) mod operator;
pub(crate) mod pair;
pub(crate) mod window;
