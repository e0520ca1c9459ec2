//! The contact of viscoelastic bodies over time.

use crate::axis::Axis;
use crate::chart::{Chart, Grid};
use crate::colour::Tint;
use crate::error::FigureError;
use crate::figure::{COLUMN, Figure};
use crate::series::{Dash, Series, Style};
use crate::unit::Unit;

/// A state of a history, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HistoryPoint {
    /// Time, s.
    pub time: f64,
    /// Indentation, m.
    pub indentation: f64,
    /// Normal force, N.
    pub force: f64,
    /// Contact radius, m; `None` under a plate.
    pub contact_radius: Option<f64>,
    /// Fraction of the load carried by the floor; `None` without a floor.
    pub floor_share: Option<f64>,
}

/// Force and indentation over time; below them, where these exist, the contact radius and the fraction of the load carried by the floor. The
/// time at which the floor is reached is marked if it is shown.
///
/// # Errors
/// [`FigureError::TooFewData`] for fewer than two states.
pub fn history(points: &[HistoryPoint], floor_contact: Option<f64>) -> Result<Figure, FigureError> {
    if points.len() < 2 {
        return Err(FigureError::TooFewData {
            fewest: 2,
            given: points.len(),
        });
    }
    let largest =
        |value: &dyn Fn(&HistoryPoint) -> f64| points.iter().map(value).fold(0.0, f64::max);
    let duration = largest(&|point| point.time);
    let Unit { name, size: second } = Unit::of_time(duration);
    let force = Unit::of_force(largest(&|point| point.force));
    let depth = Unit::of_length(largest(&|point| point.indentation));
    let radius = Unit::of_length(largest(&|point| point.contact_radius.unwrap_or(0.0)));
    let chart = |value: &dyn Fn(&HistoryPoint) -> Option<f64>, symbol: String, tint: Tint| {
        let line = points
            .iter()
            .filter_map(|point| Some([point.time / second, value(point)?]));
        let line: Vec<[f64; 2]> = line.collect();
        let top = line.iter().map(|point| point[1]).fold(0.0, f64::max);
        let mut series = vec![Series::new("", line, Style::line(0).in_tint(tint))];
        if let Some(time) = floor_contact.filter(|time| *time > 0.0 && *time <= duration) {
            let style = Style {
                tint: Tint::Grey,
                line: Some(Dash::Dashed),
                marker: None,
            };
            let mark = vec![[time / second, 0.0], [time / second, top]];
            series.push(Series::new("floor contact", mark, style));
        }
        Chart::new(
            Axis::linear(format!("time *t* ({name})")),
            Axis::linear(symbol),
            series,
        )
    };
    let mut charts = vec![
        chart(
            &|point| Some(force.of(point.force)),
            format!("force *F* ({})", force.name),
            Tint::Blue,
        ),
        chart(
            &|point| Some(depth.of(point.indentation)),
            format!("indentation *ζ* ({})", depth.name),
            Tint::Blue,
        ),
    ];
    if points.iter().any(|point| point.contact_radius.is_some()) {
        charts.push(chart(
            &|point| Some(radius.of(point.contact_radius?)),
            format!("contact radius *a* ({})", radius.name),
            Tint::Blue,
        ));
    }
    if points
        .iter()
        .any(|point| point.floor_share.is_some_and(|share| share > 0.0))
    {
        charts.push(chart(
            &|point| point.floor_share,
            "*F*_{floor}/*F*".to_owned(),
            Tint::Vermillion,
        ));
    }
    // The axes name the curves, and the legend of the first panel explains the marks of all.
    for (panel, chart) in charts.iter_mut().enumerate() {
        for (place, series) in chart.series.iter_mut().enumerate() {
            if panel > 0 || place == 0 {
                series.label = None;
            }
        }
    }
    let figure = Grid {
        name: "history",
        width: COLUMN,
        columns: 1,
        heights: charts.iter().map(|_| 100.0).collect(),
        charts,
        common_x: true,
        common_y: false,
        titles: Vec::new(),
        tagged: true,
    }
    .figure();
    Ok(figure.with_description(
        "Force, indentation and contact of viscoelastic bodies over time",
        "Force and indentation over time, and below them, where these exist, the contact radius and the fraction of the load carried by \
         the floor; the time at which the lens reaches the floor is marked.",
    ))
}
