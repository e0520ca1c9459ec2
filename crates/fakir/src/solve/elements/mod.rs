//! Contact conditions on elements of constant pressure.
//!
//! * [`solver`]: the conditions on arbitrary cells, with a duality gap;
//! * [`separation`]: two surfaces given by their separation, with unknowns only in an active set;
//! * `pillars`: elements on the pillars of a lattice;
//! * `asperities`: elements on rounded tops, and `asperity_map` on tops and floor;
//! * [`surface`]: a lens or a plate pressed onto a height map;
//! * `adhesive`: the same with adhesion; `surface_gradient`: derivatives.
#![doc = ""]
#![doc = include_str!("../../../doc/rendered/elements.md")]

mod active;
mod adhesive;
pub(crate) mod asperities;
pub(crate) mod asperity_map;
mod closing;
pub(crate) mod flat;
pub(crate) mod pattern;
pub(crate) mod pillars;
pub mod separation;
pub mod solver;
pub mod surface;
mod surface_gradient;
mod surface_level;
