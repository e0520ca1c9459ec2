//! Tests of the crate `fakir-explore` through its public interface: one program, so that it is linked once.

#![allow(clippy::unwrap_used)]

mod cycle;
mod files;
mod hold;
mod odd_requests;
mod other_surfaces;
mod running;
mod server;
mod without_server;
