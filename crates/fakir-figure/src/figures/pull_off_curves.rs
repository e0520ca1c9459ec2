//! Pull-off force and hysteresis of many cycles.

use crate::axis::{Axis, Scale};
use crate::chart::{Chart, Grid};
use crate::figure::{Figure, PAGE};
use crate::series::{Marker, Series, Style};
use crate::text::Text;
use crate::unit::Unit;

/// Pull-off of a lens from adhesive tops in one case. Values that a cycle does not have are NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PullOffPoint {
    /// Value along the axis.
    pub x: f64,
    /// Pull-off force, N, negative.
    pub force: f64,
    /// Pull-off force over that of a single flat pillar (Kendall).
    pub normalized_force: f64,
    /// Area of the loop of force over indentation, J.
    pub hysteresis: f64,
    /// Hysteresis over the work of adhesion of the largest contact area on tops.
    pub normalized_hysteresis: f64,
}

/// Cycles of one curve, by increasing value along the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct PullOffCurve {
    /// Label in the legend; may be empty.
    pub label: Text,
    /// The cycles.
    pub points: Vec<PullOffPoint>,
}

/// Four panels over one axis. The first pair shows the pull-off force, and its ratio to the pull-off force of a single flat pillar (Kendall): an
/// equivalent number of independent pillars. The second pair shows the hysteresis, and its ratio to the work of adhesion of the whole top area
/// that was in contact. For flat pillars that detach one by one this ratio is `2 (1 + kappa)`, with `kappa` the compliance of a pillar as a column
/// over that of its top: the energy that each has stored at detachment (Kendall).
#[must_use]
pub fn pull_off_curves(x: &Axis, curves: &[PullOffCurve]) -> Figure {
    let largest = |value: fn(&PullOffPoint) -> f64| {
        let points = curves.iter().flat_map(|curve| &curve.points);
        let sizes = points.map(|point| value(point).abs());
        sizes.filter(|size| size.is_finite()).fold(0.0, f64::max)
    };
    let force = Unit::of_force(largest(|point| point.force));
    let energy = Unit::of_energy(largest(|point| point.hysteresis));
    let panels: [Panel; 4] = [
        (
            format!("pull-off force |*F*_{{p}}| ({})", force.name),
            Box::new(move |point| force.of(point.force.abs())),
        ),
        (
            "|*F*_{p}|/*F*_{Kendall}".to_owned(),
            Box::new(|point| point.normalized_force),
        ),
        (
            format!("hysteresis *E*_{{loop}} ({})", energy.name),
            Box::new(move |point| energy.of(point.hysteresis)),
        ),
        (
            "*E*_{loop}/(*w* *A*_{tops})".to_owned(),
            Box::new(|point| point.normalized_hysteresis),
        ),
    ];
    let charts = panels
        .into_iter()
        .enumerate()
        .map(|(panel, (label, value))| {
            let series: Vec<Series> = curves
                .iter()
                .enumerate()
                .map(|(k, curve)| {
                    let points = curve.points.iter().map(|point| [point.x, value(point)]);
                    let style = Style {
                        marker: Some(Marker::ORDER[k % Marker::ORDER.len()]),
                        ..Style::line(k)
                    };
                    // The first panel has the legend for all panels.
                    if panel == 0 && curve.label != Text::default() {
                        Series::new(curve.label.clone(), points.collect(), style)
                    } else {
                        Series::unnamed(points.collect(), style)
                    }
                })
                .collect();
            let y = Axis {
                label: Text::from(label),
                scale: scale_for(&series),
                range: None,
            };
            Chart::new(x.clone(), y, series)
        });
    Grid {
        name: "pull-off",
        width: PAGE,
        columns: 2,
        charts: charts.collect(),
        heights: vec![130.0, 130.0],
        common_x: true,
        common_y: false,
        titles: Vec::new(),
        tagged: true,
    }
    .figure()
    .with_description(
        "Pull-off force and hysteresis",
        "Four charts: the pull-off force, the same over that of one flat pillar \
         alone, the area of the loop of loading and unloading, and the same over the work of adhesion of all top area that was in contact.",
    )
}

/// Label and values of the axis.
type Panel = (String, Box<dyn Fn(&PullOffPoint) -> f64>);

/// Logarithmic if the values differ by more than a factor of five.
fn scale_for(series: &[Series]) -> Scale {
    let values = series.iter().flat_map(|series| series.values(1));
    let (low, high) = values
        .filter(|value| *value > 0.0)
        .fold((f64::INFINITY, 0.0f64), |(low, high), value| {
            (low.min(value), high.max(value))
        });
    if high > 5.0 * low {
        Scale::Logarithmic
    } else {
        Scale::Linear
    }
}
