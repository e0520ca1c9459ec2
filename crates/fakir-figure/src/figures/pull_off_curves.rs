//! Pull-off force and hysteresis of many cycles.

use super::over_axis::{Panel, charts};
use crate::axis::Axis;
use crate::chart::Grid;
use crate::figure::{Figure, PAGE};
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
    let quantities: [(String, Quantity); 4] = [
        (
            format!("pull-off force |*F*_{{p}}| ({})", force.name),
            Box::new(move |point| force.of(point.force.abs())),
        ),
        (
            "pull-off force |*F*_{p}|/*F*_{Kendall}".to_owned(),
            Box::new(|point| point.normalized_force),
        ),
        (
            format!("hysteresis *E*_{{loop}} ({})", energy.name),
            Box::new(move |point| energy.of(point.hysteresis)),
        ),
        (
            "hysteresis *E*_{loop}/(*w* *A*_{tops})".to_owned(),
            Box::new(|point| point.normalized_hysteresis),
        ),
    ];
    let panels = quantities.into_iter().map(|(name, value)| -> Panel {
        let points = |curve: &PullOffCurve| {
            let points = curve.points.iter();
            points.map(|point| [point.x, value(point)]).collect()
        };
        (name, curves.iter().map(points).collect())
    });
    let labels: Vec<&Text> = curves.iter().map(|curve| &curve.label).collect();
    Grid {
        name: "pull-off",
        width: PAGE,
        columns: 2,
        charts: charts(x, &labels, panels.collect()),
        heights: vec![130.0, 130.0],
        common_x: true,
        common_y: false,
        titles: Vec::new(),
        tagged: true,
    }
    .figure()
    .with_description(
        "Pull-off force and hysteresis of cycles",
        "Four charts: the pull-off force, its ratio to the pull-off force of a single flat pillar (Kendall), the area of the loop of \
         loading and unloading, and its ratio to the work of adhesion of the whole top area that was in contact.",
    )
}

type Quantity = Box<dyn Fn(&PullOffPoint) -> f64>;
