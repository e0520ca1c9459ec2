//! Tests and benchmarks that need heavy libraries: figures drawn by a second renderer (`tests/figures.rs`) and timed
//! solutions (`cargo bench -p fakir-checks`).
//!
//! They are a separate package so that neither `cargo test` of a published crate nor the first tier of the checks
//! builds these libraries.
