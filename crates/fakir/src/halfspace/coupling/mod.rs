//! How pillars act on each other through the half-space.
//!
//! Lengths in pillar radii, pressures in units of the reduced modulus, as in
//! [`disc`](super::disc). [`pair`] has the coefficients between two pillars in closed form;
//! [`lattice`] applies those of all [sites] at once: directly, or, for many, by fast Fourier transform: on a hexagonal lattice itself, and else on a grid under them. With pillars of several radii, that of one of them is the unit of length.

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
