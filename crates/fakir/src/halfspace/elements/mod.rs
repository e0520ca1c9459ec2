//! Elements of constant pressure on a half-space, after Love.
//!
//! The surface is divided into equal rectangles, usually squares, with a constant pressure on each; the displacement is evaluated at their
//! centres (A. E. H. Love, Phil. Trans. R. Soc. A 228, 377 (1929); K. L. Johnson, Contact Mechanics, section 3.3). The module is
//! independent of the spectral basis of a disc, so that the two methods can verify each other.
//!
//! * [`Rectangle`]: the potential of one loaded rectangle, at any point, accurate to rounding;
//! * [`Operator`]: the displacement of all cells due to the pressures on them, with its implementations.
//!
//! On [layers](super::layer), the correction for a cell is that of a force at its centre, averaged over the cell.
//!
//! Lengths in m, pressures in Pa, compliances in 1/Pa.

#[cfg(test)]
mod conformance;
pub(crate) mod convolution;
pub(crate) mod free_space;
pub(crate) mod half_space;
pub(crate) mod lattice;
pub(crate) mod operator;
pub(crate) mod periodic;
pub(crate) mod potential;
pub(crate) mod rectangle;
pub(crate) mod scattered;

pub use free_space::FreeSpaceConvolution;
pub use lattice::LatticeOfGrids;
pub use operator::{Columns, Dense, Operator, displacement_at};
pub use periodic::{PeriodicConvolution, Preconditioned};
pub use rectangle::Rectangle;
