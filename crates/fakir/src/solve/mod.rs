//! Solvers: contact conditions on all pillars, windows, starts and growth around them, error estimates, and [`elements`].
#![doc = ""]
#![doc = include_str!("../../doc/rendered/spectral.md")]
#![doc = include_str!("../../doc/rendered/mixed.md")]
#![doc = include_str!("../../doc/rendered/punch.md")]

pub(crate) mod adhesive;
pub(crate) mod answers;
pub(crate) mod asperities;
pub(crate) mod assembled;
mod bonded_floor;
mod bonded_floor_errors;
pub mod collapsed_floor;
pub(crate) mod control;
pub mod elastic_curve;
pub mod elements;
pub(crate) mod estimate;
pub mod flat;
pub(crate) mod floor;
mod floor_start;
pub(crate) mod gradient;
pub mod homogenised;
mod linearized;
mod mixed;
pub(crate) mod newton;
mod outside;
mod patches;
pub(crate) mod path;
mod reach;
pub(crate) mod rules;
pub(crate) mod spectral;
mod touched;
pub mod viscoelastic;
