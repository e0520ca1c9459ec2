//! Surfaces patterned with pillars of any shape and arrangement, as height maps.
//!
//! A [`Pattern`] has pillars of one [shape](PillarShape) in an [`Arrangement`](crate::problem::Arrangement): on a lattice or at random,
//! optionally with missing pillars and varying heights. It is drawn on the cells of a grid around the lens axis, as a
//! [`HeightMap`](crate::problem::HeightMap) with labelled pillars and their compliance as columns. The same pattern and seed result in the
//! same surface; on a lattice, also where grids of different extent or cell size overlap.
//!
//! The floor has height 0. A cell belongs to a pillar if its centre does.

pub(crate) mod drawing;
mod invalid;
mod placement;
pub(crate) mod shape;
#[cfg(test)]
mod tests;

pub use drawing::Pattern;
pub use invalid::{InvalidPattern, PatternQuantity};
pub use shape::{CrossSection, PillarShape, Top};
