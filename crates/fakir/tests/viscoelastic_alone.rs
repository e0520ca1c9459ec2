#![allow(clippy::unwrap_used)]
#[path = "it/common/mod.rs"]
#[allow(dead_code)]
mod common;
#[path = "it/viscoelastic.rs"]
mod viscoelastic;
