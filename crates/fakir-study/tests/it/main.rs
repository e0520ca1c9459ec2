//! Tests of the crate `fakir-study` through its public interface: one program, so that it is linked once.

#![allow(clippy::unwrap_used)]

mod collapse;
mod cycles;
mod keys;
mod surfaces;
mod sweeps;
