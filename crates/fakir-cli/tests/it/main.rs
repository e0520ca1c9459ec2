//! Tests of the crate `fakir-cli` through its public interface: one program, so that it is linked once.

#![allow(clippy::unwrap_used)]

mod adhesion;
mod behaviour;
mod common;
mod design;
mod fits;
mod flat;
mod friction;
mod heights;
mod hold;
mod installed;
mod pattern_only;
mod recorded;
mod results;
mod surfaces;
mod sweeps;
mod unresolved;
