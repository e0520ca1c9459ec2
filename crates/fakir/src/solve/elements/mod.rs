//! The contact conditions on elements of constant pressure.
//!
//! * [`solver`]: the conditions on any cells, with a certificate;
//! * [`separation`]: two surfaces of which the separation is known, with unknowns only where they touch;
//! * `pillars`: the elements of the pillars of a lattice;
//! * [`surface`]: a lens or a plate pressed onto any height map.
#![doc = ""]
#![doc = include_str!("../../../doc/rendered/elements.md")]

mod active;
mod closing;
pub(crate) mod pillars;
pub mod separation;
pub mod solver;
pub mod surface;
mod surface_level;
pub(crate) mod texture;
