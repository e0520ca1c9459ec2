//! Tests of the crate `fakir-case` through its public interface: one program, so that it is linked once.

#![allow(clippy::unwrap_used)]

mod asperities;
mod cases;
mod flat;
mod height_map;
mod keys;
mod lenses;
mod malformed;
mod studies;
mod surfaces;
mod tables;
