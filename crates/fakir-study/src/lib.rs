//! Many cases: sweeps along axes of a case file, with a journal that survives being killed, tables,
//! exports of fields, and the inverse question of design.
//!
//! * [`output`]: files that are there whole or not at all.

pub mod output;
