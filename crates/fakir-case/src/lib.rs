//! Case files.

pub mod height_map;
