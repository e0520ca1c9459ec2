//! Many cases: sweeps along axes of a case file, with a journal that survives being killed, tables,
//! exports of fields, and the inverse question of design.
//!
//! * [`output`]: files that are there whole or not at all;
//! * [`provenance`]: where a result is from, stamped on every file;
//! * [`citations`]: what to cite for it;
//! * [`fields`]: pressure, gap and displacement on a grid, as netCDF and for ParaView;
//! * [`design`]: the case that has a wanted answer;
//! * [`spread`]: how far answers scatter.

pub mod citations;
pub mod design;
pub mod fields;
pub mod output;
pub mod provenance;
pub mod spread;
