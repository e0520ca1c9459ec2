//! The contact conditions on elements of constant pressure.
//!
//! * [`solver`]: the conditions on any cells, with a certificate;
//! * `pillars`: the elements of the pillars of a lattice;
//! * [`surface`]: a lens or a plate pressed onto any height map.
#![doc = ""]
#![doc = include_str!("../../../doc/rendered/elements.md")]

mod closing;
pub(crate) mod pillars;
pub mod solver;
pub mod surface;
mod surface_level;
pub(crate) mod texture;
