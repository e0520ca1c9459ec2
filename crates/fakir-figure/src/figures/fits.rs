//! Fitted parameters of several curves, with their mean and scatter.

use crate::axis::Axis;
use crate::chart::{Chart, Grid, Shade};
use crate::colour::Tint;
use crate::figure::{COLUMN, Figure, PAGE};
use crate::scene::Colour;
use crate::series::{Dash, Series, Style};
use crate::text::Text;

/// Colour of the band of the standard deviation.
const BAND: Colour = Colour::grey(225);

/// A fitted value of one curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedValue {
    /// Number of the curve, from 1.
    pub curve: usize,
    /// Value.
    pub value: f64,
    /// Its standard error; `None` if the data do not determine it.
    pub error: Option<f64>,
    /// Whether it is far from the others.
    pub outlier: bool,
}

/// A parameter and its values.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedParameter {
    /// Name of the parameter.
    pub name: String,
    /// Unit of its values.
    pub unit: String,
    /// The values, in this unit.
    pub values: Vec<FittedValue>,
    /// Mean of the values, or their common value, with half the width of its band: the standard deviation, or the standard error.
    pub mean: Option<[f64; 2]>,
}

/// Values with standard errors over the number of the curve, one panel for every parameter: a line at the mean, and a band whose half
/// width is the standard deviation; with `joint`, at the shared value with its standard error. `curves` is the number of curves.
#[must_use]
pub fn fits(parameters: &[FittedParameter], curves: usize, joint: bool) -> Figure {
    let columns = if parameters.len() > 1 { 2 } else { 1 };
    let rows = parameters.len().div_ceil(columns);
    let (title, description) = if joint {
        (
            "Parameters of a joint fit",
            "Fitted value of every curve with its standard error; shared values as a line in the band of their standard error.",
        )
    } else {
        (
            "Fitted parameters of several curves",
            "Fitted value of every curve with its standard error; mean as a line in the band of the standard deviation.",
        )
    };
    Grid {
        name: "fits",
        width: if columns > 1 { PAGE } else { COLUMN },
        columns,
        charts: parameters
            .iter()
            .map(|one| panel(one, curves, joint))
            .collect(),
        heights: vec![120.0; rows.max(1)],
        common_x: false,
        common_y: false,
        titles: Vec::new(),
        tagged: false,
    }
    .figure()
    .with_description(title, description)
}

fn panel(of: &FittedParameter, curves: usize, joint: bool) -> Chart {
    let name = format!("{} ({})", of.name, of.unit);
    let label = if of.unit.is_empty() { &of.name } else { &name };
    let mut series = Vec::new();
    let ends = [0.5, curves as f64 + 0.5];
    if let Some([mean, _]) = of.mean {
        let name = match joint {
            true => "shared value, standard error",
            false => "mean, standard deviation",
        };
        let line = ends.map(|end| [end, mean]).to_vec();
        let style = Style::line(0).with_line(Dash::Solid);
        series.push(Series::new(name, line, style));
    }
    let mut marks = |name: &str, style: Style, is_shown: fn(&FittedValue) -> bool| {
        let shown: Vec<&FittedValue> = of.values.iter().filter(|value| is_shown(value)).collect();
        if !shown.is_empty() {
            let points = shown.iter().map(|v| [v.curve as f64, v.value]).collect();
            let errors = shown.iter().map(|v| [0.0, v.error.unwrap_or(0.0)]);
            series.push(Series::new(name, points, style).with_errors(errors.collect()));
        }
    };
    let determined = Style::marks(0).in_tint(Tint::Black);
    marks("curve", determined, |v| v.error.is_some() && !v.outlier);
    let far = Style::marks(3).in_tint(Tint::Vermillion);
    marks("outlier", far, |v| v.error.is_some() && v.outlier);
    let unknown = Style::marks(4).in_tint(Tint::Grey);
    marks("not determined", unknown, |v| v.error.is_none());
    let mut chart = Chart::new(
        Axis::numbered("number of the curve", curves),
        Axis::linear(Text::plain(label)),
        series,
    );
    if let Some([mean, half]) = of.mean.filter(|[_, half]| *half > 0.0) {
        let [low, high] = [mean - half, mean + half];
        chart.shades.push(Shade {
            corners: vec![
                [ends[0], low],
                [ends[1], low],
                [ends[1], high],
                [ends[0], high],
            ],
            colour: BAND,
        });
    }
    chart
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_show_all_values_and_the_outlier() {
        let value = |curve: usize, value: f64| FittedValue {
            curve,
            value,
            error: Some(0.1),
            outlier: value > 2.0,
        };
        let one = FittedParameter {
            name: "substrate.young_modulus".to_owned(),
            unit: "MPa".to_owned(),
            values: vec![value(1, 1.0), value(2, 1.1), value(3, 5.0)],
            mean: Some([2.37, 2.3]),
        };
        let two = FittedParameter {
            name: "adhesion.work".to_owned(),
            unit: String::new(),
            values: vec![FittedValue {
                error: None,
                ..value(1, 0.0)
            }],
            mean: None,
        };
        let drawn = fits(&[one, two], 3, false).svg();
        for text in ["substrate.young_modulus (MPa)", "outlier", "not determined"] {
            assert!(drawn.contains(text), "{text}: {drawn}");
        }
    }
}
