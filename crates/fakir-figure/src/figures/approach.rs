//! A loading: force and contact radius over the indentation.

use crate::axis::Axis;
use crate::chart::{Chart, Grid};
use crate::colour::Tint;
use crate::error::FigureError;
use crate::figure::{COLUMN, Figure};
use crate::series::{Dash, Marker, Series, Style};
use crate::unit::Unit;

/// A state of a loading, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadingPoint {
    /// Indentation, m.
    pub indentation: f64,
    /// Normal force, N.
    pub force: f64,
    /// The part of it that the floor bears, N, where that is known.
    pub floor_force: Option<f64>,
    /// Contact radius, m; none under a plate.
    pub contact_radius: Option<f64>,
    /// Pillars touched, and how many of them partially, where that is known.
    pub pillars: Option<[usize; 2]>,
    /// Whether the floor is left out beyond where it is touched, and this state is there.
    pub without_floor: bool,
}

/// Force over indentation, and below it the contact radius, the share of the floor and how many pillars are touched, as far as there
/// are such. The critical state is marked, also if the loading ends before it; what the floor bears has a curve of its own. States
/// without the floor that they would touch are joined by a grey dashed line.
///
/// # Errors
/// [`FigureError::TooFewData`] of fewer than two states.
pub fn approach(
    points: &[LoadingPoint],
    critical: Option<LoadingPoint>,
) -> Result<Figure, FigureError> {
    if points.len() < 2 {
        return Err(FigureError::TooFewData {
            fewest: 2,
            given: points.len(),
        });
    }
    let all = || points.iter().chain(&critical);
    let largest = |value: &dyn Fn(&LoadingPoint) -> f64| all().map(value).fold(0.0, f64::max);
    let across = Unit::of_length(largest(&|point| point.indentation));
    let force = Unit::of_force(largest(&|point| point.force));
    let radius = Unit::of_length(largest(&|point| point.contact_radius.unwrap_or(0.0)));
    let x = || Axis::linear(format!("indentation *ζ* ({})", across.name));
    let curve = |name: &str, unit: Unit, tint, value: Value, symbol: &str| {
        let series = series(points, critical.as_ref(), [across, unit], value, name, tint);
        let y = Axis::linear(format!("{symbol} ({})", unit.name));
        Chart::new(x(), y, series)
    };
    let mut upper = curve("force", force, Tint::Blue, |p| Some(p.force), "force *F*");
    if all().any(|point| point.floor_force.is_some_and(|force| force > 0.0)) {
        let on_floor = points
            .iter()
            .filter_map(|point| Some([across.of(point.indentation), force.of(point.floor_force?)]));
        let style = Style::line(1).in_tint(Tint::Vermillion);
        let on_floor = Series::new("on the floor", on_floor.collect(), style);
        upper.series.insert(1, on_floor);
    }
    let mut charts = vec![upper];
    let mut heights = vec![122.0];
    // The legend above explains all curves of the one colour.
    let unnamed = |mut chart: Chart| {
        for series in &mut chart.series {
            series.label = None;
        }
        chart
    };
    if all().any(|point| point.contact_radius.is_some()) {
        let symbol = "contact radius *a*";
        let value: Value = |point| point.contact_radius;
        charts.push(unnamed(curve("", radius, Tint::Blue, value, symbol)));
        heights.push(104.0);
    }
    if all().any(|point| share(point).is_some_and(|share| share > 0.0)) {
        let points = points
            .iter()
            .filter_map(|point| Some([across.of(point.indentation), share(point)?]));
        let style = Style::line(1).in_tint(Tint::Vermillion);
        let y = Axis::linear("share of the floor");
        let line = Series::new("", points.collect(), style);
        charts.push(unnamed(Chart::new(x(), y, vec![line])));
        heights.push(80.0);
    }
    if points.iter().any(|point| point.pillars.is_some()) {
        let series = |label: &str, style, count: fn([usize; 2]) -> usize| {
            let points = points.iter().filter_map(|point| {
                let count = count(point.pillars?) as f64;
                Some([across.of(point.indentation), count])
            });
            Series::new(label, points.collect(), style)
        };
        let touched = series("touched", Style::line(0), |[all, _]| all);
        let partial = Style::line(2).in_tint(Tint::Black);
        let partial = series("partially", partial, |[_, partial]| partial);
        charts.push(Chart::new(
            x(),
            Axis::linear("pillars"),
            vec![touched, partial],
        ));
        heights.push(80.0);
    }
    let figure = Grid {
        name: "approach",
        width: COLUMN,
        columns: 1,
        heights,
        charts,
        common_x: true,
        common_y: false,
        titles: Vec::new(),
        tagged: false,
    }
    .figure();
    Ok(figure.with_description(
        "Loading of the surface",
        "Force over indentation, and below it the contact radius, the share of the floor and the \
         pillars that are touched, as far as there are such; the critical state, in which the floor \
         is just reached, is marked.",
    ))
}

/// What the floor bears over the whole force.
fn share(point: &LoadingPoint) -> Option<f64> {
    let on_floor = point.floor_force?;
    Some(if point.force > 0.0 {
        on_floor / point.force
    } else {
        0.0
    })
}

type Value = fn(&LoadingPoint) -> Option<f64>;

/// The curve, what of it is without the floor, and the critical state.
fn series(
    points: &[LoadingPoint],
    critical: Option<&LoadingPoint>,
    [across, up]: [Unit; 2],
    value: Value,
    name: &str,
    tint: Tint,
) -> Vec<Series> {
    let at = |point: &LoadingPoint| Some([across.of(point.indentation), up.of(value(point)?)]);
    let with_floor = points.iter().filter(|point| !point.without_floor);
    let dots = Style {
        tint,
        line: Some(Dash::Solid),
        marker: Some(Marker::Disc),
    };
    let mut series = vec![Series::new(name, with_floor.filter_map(at).collect(), dots)];
    let beyond: Vec<_> = points.iter().filter(|point| point.without_floor).collect();
    if !beyond.is_empty() {
        // The line goes on from the critical state.
        let beyond = critical.into_iter().chain(beyond).filter_map(at).collect();
        let style = Style::line(1).in_tint(Tint::Grey);
        series.push(Series::new("as if without floor", beyond, style));
    }
    if let Some(place) = critical.and_then(at) {
        let style = Style {
            tint: Tint::Vermillion,
            line: None,
            marker: Some(Marker::Diamond),
        };
        series.push(Series::new("critical state", vec![place], style));
    }
    series
}
