//! Rules for the next state of a pillar top, and of a floor cell, under its load.

mod coarse;
pub(crate) mod floor;
pub(crate) mod floor_fronts;
pub(crate) mod fronts;
pub(crate) mod groups;
pub(crate) mod patch;
pub(crate) mod rim;
pub(crate) mod sticky;
pub(crate) mod stuck_floor;
pub(crate) mod tops;
pub(crate) mod unilateral;
