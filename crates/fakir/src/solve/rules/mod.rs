//! What a pillar top does next under the load on it.

pub(crate) mod patch;
pub(crate) mod rim;
pub(crate) mod tops;
pub(crate) mod unilateral;
