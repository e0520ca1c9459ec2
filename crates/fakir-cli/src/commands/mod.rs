//! One module for each command: its call of the library, and its report.

pub(crate) mod cite;
pub(crate) mod compare;
pub(crate) mod design;
#[cfg(feature = "explore")]
pub(crate) mod explore;
pub(crate) mod fit;
pub(crate) mod fits;
pub(crate) mod friction;
pub(crate) mod heights;
pub(crate) mod init;
pub(crate) mod installed;
pub(crate) mod reproduce;
pub(crate) mod results;
pub(crate) mod sweep;
pub(crate) mod theory;
pub(crate) mod verify;
