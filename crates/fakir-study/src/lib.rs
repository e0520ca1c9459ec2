//! Many cases: sweeps along axes of a case file, with a journal that survives being killed, tables,
//! exports of fields, and the inverse question of design.

pub mod design;
pub mod spread;
