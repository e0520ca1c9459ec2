//! Figures of contacts between a lens and a surface patterned with pillars, as SVG and PNG.
//!
//! Every figure is a function from typed data to a [`Figure`], which renders to SVG text and PNG
//! bytes; the crate opens no files. Widths are those of Phys. Rev. E, 86 mm for a column and 178 mm
//! for a page. Quantities are given in SI units and shown with a suitable prefix.
//!
//! ```
//! use fakir_figure::{Axis, LineChart, Series, Style, lines};
//!
//! let points = (1..=20).map(f64::from).map(|x| [x, x.powf(1.5)]).collect();
//! let figure = lines(&LineChart {
//!     x: Axis::logarithmic("force *F* (µN)"),
//!     y: Axis::logarithmic("number of pillars *n*"),
//!     series: vec![Series::new("*n* = *F*^{3/2}", points, Style::line(0))],
//! });
//! assert!(figure.svg().starts_with("<svg"));
//! assert!(figure.faults().is_empty());
//! ```
//!
//! # Base
//! A figure is a list of paths, discs, text and images. This crate writes it as SVG, and `tiny-skia`
//! renders it as pixels. Both use the font that is embedded in every SVG: SVG and PNG agree, and no
//! font needs to be installed.

mod axis;
mod cells;
mod chart;
mod colour;
mod error;
#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod every;
mod figure;
mod figures;
mod font;
mod frame;
mod legend;
mod map;
mod patches;
mod png;
mod raster;
#[cfg(test)]
mod samples;
mod scene;
mod section;
mod series;
mod svg;
mod text;
mod unit;

pub use axis::{Axis, Scale};
pub use cells::SurfaceState;
pub use colour::Tint;
pub use error::FigureError;
pub use figure::{Figure, RESOLUTION};
pub use figures::approach::{LoadingPoint, approach};
pub use figures::asperity_cycle::asperity_cycle_curve;
pub use figures::asperity_map::asperity_map;
pub use figures::critical_curves::{
    CriticalColumn, CriticalCurve, CriticalPoint, Measured, critical_curves,
};
pub use figures::critical_states::{CriticalStateCurve, CriticalStatePoint, critical_states};
pub use figures::cycle::{cycle_curve, release_map};
pub use figures::designed_curve::{
    DesignedCurve, DesignedQuantity, DesignedValues, designed_curve,
};
pub use figures::fit_curves::{FittedCurve, FittedLoad, FittedPoint, FittedQuantity, fit_curves};
pub use figures::fits::{FittedParameter, FittedValue, fits};
pub use figures::flat::{flat_cycle, flat_pressure, surface_cycle};
pub use figures::floor_gap_map::floor_gap_map;
pub use figures::floor_pressure_map::floor_pressure_map;
pub use figures::histogram::{Histogram, histogram};
pub use figures::history::{HistoryPoint, history};
pub use figures::lateral_force::{LateralModel, LateralPoint, lateral_force};
pub use figures::lattice_sums::lattice_sums;
pub use figures::lines::{LineChart, lines};
pub use figures::phase_diagram::{PhaseDiagram, phase_diagram, phase_point};
pub use figures::pillar_pressure::pillar_pressure;
pub use figures::pressure_map::pressure_map;
pub use figures::profiles::{ProfileState, profiles, surface_profiles};
pub use figures::pull_off_curves::{PullOffCurve, PullOffPoint, pull_off_curves};
pub use figures::surface_maps::{surface_gap_map, surface_pressure_map};
pub use figures::top_view::{View, top_view};
pub use png::grey_map;
pub use section::{Section, SectionDetail};
pub use series::{Dash, Marker, Series, Style};
pub use svg::font_css;
pub use text::Text;
