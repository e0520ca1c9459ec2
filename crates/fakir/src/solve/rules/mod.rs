//! Rules for the next state of a pillar top, and of a floor cell, under its load.

pub(crate) mod adhesive_tops;
pub(crate) mod bonded_floor;
mod coarse;
pub(crate) mod floor;
pub(crate) mod floor_fronts;
pub(crate) mod fronts;
pub(crate) mod groups;
pub(crate) mod patch;
pub(crate) mod rim;
pub(crate) mod tops;
pub(crate) mod unilateral;
