//! The floor between pillars: rectangles of constant pressure on a grid that is aligned with the lattice, if there is one.
//!
//! Pressures are constant on every rectangle, and displacements are means over rectangles. This Galerkin method makes the interaction of
//! two rectangles symmetric. Compared with displacements at the centres of the rectangles, the force has a smaller error for the same cell
//! size and is exactly the derivative of the energy, and the energy decreases with every refinement.
//!
//! Lengths are in pillar radii, pressures in units of the reduced modulus. [`grid`] creates the cells; [`kernels`] contains the
//! displacements of rectangles due to rectangles and pillar tops; [`coupling`] applies both at once by fast Fourier transform, with the
//! effect of [`far`] pillars on a grid of their own if these extend far beyond the cells, or with a [`table`] for pillars at arbitrary
//! positions; [`load`] is a pressure as a function of position.

mod coarse;
pub(crate) mod coupling;
mod far;
pub(crate) mod grid;
pub(crate) mod kernels;
pub(crate) mod load;
mod meeting;
mod mirrored;
mod table;
mod whole;
