//! The results of R. Ledesma-Alonso, E. Raphaël, F. Restagno, C. Poulard, Phys. Rev. E 104, 055007
//! (2021), computed anew: tables, figures, and a report that holds every claim against them.

pub mod analysis;
pub mod claims;
pub mod grid;
