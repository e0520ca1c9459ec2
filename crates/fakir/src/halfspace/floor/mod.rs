//! The floor between pillars: rectangles of constant pressure on a grid that is aligned with the lattice, if there is one.
//!
//! Pressures are constant on every rectangle, and displacements are means over rectangles (a Galerkin method: what one
//! rectangle does to another is what that does to this). Compared with displacements at the centres of the rectangles the
//! force has a smaller error at the same size of the cells, is exactly the derivative of the energy, and the energy falls
//! with every refinement.
//!
//! Lengths in pillar radii, pressures in units of the reduced modulus. [`grid`] lays the cells; [`kernels`] has what rectangles
//! and pillar tops do to rectangles; [`coupling`] applies both at once by fast Fourier transform, or with a [`table`] of pillars that stand
//! anywhere; [`load`] is a pressure as a function of position.

mod coarse;
pub(crate) mod coupling;
pub(crate) mod grid;
pub(crate) mod kernels;
pub(crate) mod load;
mod meeting;
mod mirrored;
mod table;
mod whole;
