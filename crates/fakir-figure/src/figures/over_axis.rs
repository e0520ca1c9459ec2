//! Charts of several quantities over one axis, with the same curves in each.

use crate::axis::{Axis, Scale};
use crate::chart::Chart;
use crate::series::{Marker, Series, Style};
use crate::text::Text;

/// The name of a quantity with its unit, and the points of every curve.
pub(crate) type Panel = (String, Vec<Vec<[f64; 2]>>);

/// A chart for every quantity. The labels of the curves are those of the first chart; an empty label has no entry in the legend.
pub(crate) fn charts(x: &Axis, labels: &[&Text], panels: Vec<Panel>) -> Vec<Chart> {
    let chart = |(number, (name, curves)): (usize, Panel)| {
        let series = curves.into_iter().zip(labels).enumerate();
        let series: Vec<Series> = series
            .map(|(k, (points, label))| {
                let style = Style {
                    marker: Some(Marker::ORDER[k % Marker::ORDER.len()]),
                    ..Style::line(k)
                };
                if number == 0 && **label != Text::default() {
                    Series::new((*label).clone(), points, style)
                } else {
                    Series::unnamed(points, style)
                }
            })
            .collect();
        let y = Axis {
            scale: scale_for(&series),
            ..Axis::linear(name)
        };
        Chart::new(x.clone(), y, series)
    };
    panels.into_iter().enumerate().map(chart).collect()
}

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
