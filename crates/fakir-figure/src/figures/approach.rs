//! A loading curve: force and contact radius over the indentation.

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
    /// Force on the floor, N, if known.
    pub floor_force: Option<f64>,
    /// Contact radius, m; `None` under a plate.
    pub contact_radius: Option<f64>,
    /// Number of pillars in contact, and of those in partial contact, if known.
    pub pillars: Option<[usize; 2]>,
    /// Whether this state is past the transition and floor contact is ignored.
    pub without_floor: bool,
}

/// Force over indentation; below it, if available, the contact radius, the fraction of the load carried by the floor, and the number
/// of pillars in contact. The critical state is marked even if the loading ends before it; the floor force has a separate curve.
/// States past the transition for which floor contact is ignored are joined by a grey dashed line.
///
/// # Errors
/// [`FigureError::TooFewData`] for fewer than two states.
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
    // The legend of the first panel explains this colour.
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
        let y = Axis::linear("fraction of the load on the floor");
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
        "Force over indentation, and below it the contact radius, the fraction of the load on the floor and the \
         number of pillars in contact, if any; the critical state, in which the floor \
         is just reached, is marked.",
    ))
}

/// Floor force over total force.
fn share(point: &LoadingPoint) -> Option<f64> {
    let on_floor = point.floor_force?;
    Some(if point.force > 0.0 {
        on_floor / point.force
    } else {
        0.0
    })
}

type Value = fn(&LoadingPoint) -> Option<f64>;

/// The curve, its part without the floor, and the critical state.
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
        // The line continues from the critical state.
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
