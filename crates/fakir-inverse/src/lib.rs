//! Inverse problems: design, scatter of samples, and fits of measured data.
//!
//! * [`design`](mod@design) finds the value of a parameter that gives a target critical force, contact radius,
//!   pull-off force or floor share.
//! * [`heights`] finds heights of rounded tops for a target curve, which [`target`] reads; [`pillar_heights`]
//!   applies it to the pillars of a case.
//! * [`spread`](mod@spread) draws samples about a case and computes the scatter of their critical
//!   states.
//! * [`fit`](mod@fit) finds moduli, sizes and instrument parameters from measured loading curves.
//! * [`DesignSummary`] and [`fit::FitSummary`] are the results as JSON objects;
//!   [`fakir_study::result`] contains all others. [`Spread::table`](spread::Spread::table) and
//!   [`Fit::table`](fit::Fit::table) are their tables.

mod derivative;
pub mod design;
pub mod fit;
pub mod heights;
pub mod pillar_heights;
mod result;
mod sample;
pub mod spread;
pub mod target;

pub use result::{DesignSummary, HeightsSummary};
