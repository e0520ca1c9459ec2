//! Response of an elastic half-space.
//!
//! * `disc`: one pillar top, its pressure expanded in the eigenfunctions of a disc, and the surface displacement around it;
//! * `coupling`: the interaction of the pillars;
//! * `floor`: the floor between the pillars, in rectangles on a grid that is aligned with the lattice;
//! * `jet`: fields with their derivatives at a point;
//! * [`layer`]: corrections for bodies that are layers instead of half-spaces;
//! * [`elements`]: rectangles of constant pressure, and the displacements that they cause.
#![doc = ""]
#![doc = include_str!("../../doc/rendered/halfspace.md")]

pub(crate) mod coupling;
pub(crate) mod disc;
pub mod elements;
pub(crate) mod floor;
pub(crate) mod jet;
pub mod layer;
