//! Elements of constant pressure on a half-space, after Love.
//!
//! The surface is divided into equal rectangles, usually squares, with a constant pressure on
//! each; the displacement is taken at their centres (A. E. H. Love, Phil. Trans. R. Soc. A 228,
//! 377 (1929); K. L. Johnson, Contact Mechanics, section 3.3). Nothing here knows the spectral
//! basis of a disc, so that each method can check the other.
//!
//! * [`Grid`] and [`Cells`]: the rectangles, and those that can carry a pressure;
//! * [`Rectangle`]: the potential of one loaded rectangle, at any point, to rounding;
//! * [`Operator`]: the displacement of all cells from the pressures on them, with its
//!   implementations;
//! * [`solver`]: the contact conditions on them, with a certificate;
//! * [`ElementMesh`]: how the pillars of a [`System`](crate::system::System) are divided;
//! * [`SurfaceSystem`]: a lens or a plate pressed onto any [`HeightMap`].
//!
//! Lengths in m, pressures in Pa, compliances in 1/Pa.

#[cfg(test)]
mod conformance;
mod convolution;
mod free_space;
mod grid;
mod kernel;
mod lattice;
mod operator;
mod periodic;
pub(crate) mod pillars;
pub mod solver;
pub mod surface;
mod surface_level;
mod surface_map;

pub use free_space::FreeSpaceConvolution;
pub use grid::{Cells, Grid, InvalidGrid, Segment};
pub use kernel::Rectangle;
pub use lattice::LatticeOfGrids;
pub use operator::{Columns, Dense, Operator, displacement_at};
pub use periodic::{PeriodicConvolution, Preconditioned};
pub use pillars::{ElementMesh, MeshLayout};
pub use surface::{
    Boundary, Floor, Indenter, Share, Shares, SurfaceContact, SurfaceError, SurfaceSystem,
    SurfaceTransition, SurfaceWarning,
};
pub use surface_map::{HeightMap, InvalidHeightMap, PillarColumns};
