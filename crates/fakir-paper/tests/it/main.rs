//! Tests of the crate `fakir-paper` through its public interface: one program, so that it is linked once.

#![allow(clippy::unwrap_used)]

mod reproduce;
mod reproduce_adhesion;
