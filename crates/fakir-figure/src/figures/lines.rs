//! A chart of any series.

use crate::axis::Axis;
use crate::chart::{Chart, Grid};
use crate::figure::{COLUMN, Figure};
use crate::series::Series;

/// Axes and series of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct LineChart {
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// The data, in the values of the axes.
    pub series: Vec<Series>,
}

/// A chart of any series, one column wide, with the legend where it covers no data.
#[must_use]
pub fn lines(chart: &LineChart) -> Figure {
    let LineChart { x, y, series } = chart.clone();
    Grid::of_one("lines", COLUMN, 0.62 * COLUMN, Chart::new(x, y, series)).figure()
}
