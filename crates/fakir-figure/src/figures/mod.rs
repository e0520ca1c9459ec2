//! The figures.

pub(crate) mod approach;
pub(crate) mod asperity_cycle;
pub(crate) mod asperity_map;
mod branches;
pub(crate) mod critical_curves;
pub(crate) mod critical_states;
pub(crate) mod cycle;
pub(crate) mod designed_curve;
pub(crate) mod fit_curves;
pub(crate) mod fits;
pub(crate) mod flat;
pub(crate) mod floor_gap_map;
pub(crate) mod floor_pressure_map;
pub(crate) mod histogram;
pub(crate) mod history;
pub(crate) mod lateral_force;
pub(crate) mod lattice_sums;
pub(crate) mod lines;
mod over_axis;
pub(crate) mod phase_diagram;
pub(crate) mod pillar_pressure;
pub(crate) mod pressure_map;
pub(crate) mod profiles;
pub(crate) mod pull_off_curves;
pub(crate) mod surface_maps;
pub(crate) mod top_view;
