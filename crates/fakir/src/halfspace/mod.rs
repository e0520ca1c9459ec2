//! How an elastic half-space gives way.
//!
//! * `disc`: one pillar top, its pressure in the eigenfunctions of a disc, and the surface around it;
//! * `coupling`: how the pillars of a lattice act on each other;
//! * `floor`: the floor between the pillars, in rectangles on a grid that is aligned with the lattice;
//! * `jet`: fields with their derivatives at a point;
//! * [`layer`]: what changes where a body is no half-space but a layer;
//! * [`elements`]: rectangles of constant pressure, and the displacement of all from all.
#![doc = ""]
#![doc = include_str!("../../doc/rendered/halfspace.md")]

pub(crate) mod coupling;
pub(crate) mod disc;
pub mod elements;
pub(crate) mod floor;
pub(crate) mod jet;
pub mod layer;
