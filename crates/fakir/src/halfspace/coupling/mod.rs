//! Interaction of pillars through the half-space.
//!
//! Lengths are in pillar radii and pressures in units of the reduced modulus, as in [`disc`](super::disc). [`pair`] contains the
//! coefficients between two pillars in closed form. [`lattice`] applies those of all [sites] at once: directly for few pillars; for many by
//! fast Fourier transform, on the lattice itself if equal tops stand on one without gaps, otherwise on a grid. For pillars of several radii,
//! the radius of one of them is the unit of length.

pub(crate) mod convolution;
pub(crate) mod copies;
pub(crate) mod derivative;
pub(crate) mod differences;
pub(crate) mod direct;
pub(crate) mod lattice;
pub(crate) mod moving;
pub(crate) mod on_grid;
pub(crate) mod operator;
pub(crate) mod pair;
pub(crate) mod sites;
pub(crate) mod window;
