//! The inverse questions: what must be made, how far it scatters, and what was measured.
//!
//! * [`design`](mod@design) turns the question round: which value gives a wanted critical force, or floor share.
//! * [`heights`] finds heights of rounded tops for a wanted curve, which [`target`] reads; [`pillar_heights`] are
//!   those of the pillars of a case.
//! * [`spread`](mod@spread) draws samples about a case, and says how far their critical states scatter.
//! * [`fit`](mod@fit) finds moduli, sizes and instrument parameters from measured loading curves.
//! * [`DesignSummary`] and [`fit::FitSummary`] are the answers as JSON objects, as
//!   [`fakir_study::result`] has all others; [`Spread::table`](spread::Spread::table) and
//!   [`Fit::table`](fit::Fit::table) are their tables.

mod derivative;
pub mod design;
pub mod fit;
pub mod heights;
pub mod pillar_heights;
mod result;
pub mod spread;
pub mod target;

pub use result::{DesignSummary, HeightsSummary};
