//! Tests of the crate `fakir-inverse` through its public interface: one program, so that it is linked once.

#![allow(clippy::unwrap_used)]

mod adhesion;
mod curves;
mod films;
mod fit;
mod flat;
mod flat_design;
mod height_maps;
mod heights;
mod map_adhesion;
mod map_design;
mod map_spread;
mod measurements;
mod over_time;
mod rounded;
mod rounded_design;
