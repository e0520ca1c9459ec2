//! Histogram of a quantity.

use crate::axis::Axis;
use crate::chart::{Chart, Grid, Shade};
use crate::colour::Tint;
use crate::error::FigureError;
use crate::figure::{COLUMN, Figure};
use crate::scene::Colour;
use crate::series::{Dash, Series, Style};
use crate::text::Text;
use crate::unit::significant;

/// Values of a quantity, and percentiles to mark.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Name of the quantity and its unit.
    pub label: Text,
    /// The unit, which is printed behind the percentiles; may be empty.
    pub unit: Text,
    /// Values, in that unit. Values that are not finite are left out.
    pub values: Vec<f64>,
    /// Percentiles to mark, from 0 to 100, at most six.
    pub percentiles: Vec<f64>,
}

const BAR: Colour = Colour([188, 209, 228]);

/// Histogram of a quantity with its percentiles, one column wide.
///
/// The width of the bins follows D. Freedman and P. Diaconis (Z. Wahrscheinlichkeitstheorie verw.
/// Geb. 57, 453, 1981): twice the interquartile range over the cube root of the number of values,
/// with at least 5 and at most 60 bins. Percentiles are interpolated between values.
///
/// # Errors
/// [`FigureError::TooFewData`] for fewer than two values.
pub fn histogram(histogram: &Histogram) -> Result<Figure, FigureError> {
    let mut values: Vec<f64> = histogram
        .values
        .iter()
        .copied()
        .filter(|value| value.is_finite())
        .collect();
    values.sort_by(f64::total_cmp);
    if values.len() < 2 {
        return Err(FigureError::TooFewData {
            fewest: 2,
            given: values.len(),
        });
    }
    let bins = Bins::of(&values);
    let tallest = bins.counts.iter().copied().max().unwrap_or(0) as f64;
    let mut series = vec![Series::unnamed(
        bins.outline(),
        Style::line(0).in_tint(Tint::Black),
    )];
    for (k, percentage) in histogram.percentiles.iter().take(6).enumerate() {
        let value = percentile(&values, *percentage);
        let name = Text::from(ordinal(*percentage))
            .followed_by(format!(": {} ", significant(value, 4)))
            .followed_by(histogram.unit.clone());
        let dash = [
            Dash::Dashed,
            Dash::Solid,
            Dash::Dotted,
            Dash::DashDotted,
            Dash::LongDashed,
            Dash::DashDotDotted,
        ][k];
        let line = vec![[value, 0.0], [value, 1.08 * tallest]];
        series.push(Series::new(name, line, Style::line(k + 1).with_line(dash)));
    }
    let y = Axis::linear("number of samples").over(0.0, 1.08 * tallest);
    let mut chart = Chart::new(Axis::linear(histogram.label.clone()), y, series);
    let space = 0.5 * bins.width;
    chart.x = chart.x.over(
        bins.start - space,
        bins.start + bins.width * bins.counts.len() as f64 + space,
    );
    chart.shades.push(Shade {
        corners: bins.outline(),
        colour: BAR,
    });
    let figure = Grid::of_one("histogram", COLUMN, 0.55 * COLUMN, chart).figure();
    Ok(figure.with_description(
        "Histogram with percentiles",
        &format!("Histogram of {} values with percentiles.", values.len()),
    ))
}

/// Name of a percentile: `median`, `5th percentile`.
fn ordinal(percentage: f64) -> String {
    let digits = percentage.to_string();
    let ending = match digits.as_str() {
        "50" => return "median".to_owned(),
        "11" | "12" | "13" => "th",
        _ if digits.contains('.') => "th",
        _ => match digits.chars().last() {
            Some('1') => "st",
            Some('2') => "nd",
            Some('3') => "rd",
            _ => "th",
        },
    };
    format!("{percentage}{ending} percentile")
}

/// Percentile of sorted values, by linear interpolation.
fn percentile(sorted: &[f64], percentage: f64) -> f64 {
    let at = (percentage / 100.0).clamp(0.0, 1.0) * (sorted.len() - 1) as f64;
    let below = at.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (at - below as f64) * (sorted[above] - sorted[below])
}

struct Bins {
    start: f64,
    width: f64,
    counts: Vec<usize>,
}

impl Bins {
    fn of(sorted: &[f64]) -> Self {
        let (low, high) = (sorted[0], sorted[sorted.len() - 1]);
        let extent = high - low;
        if extent <= 1e-12 * low.abs().max(high.abs()) {
            // All values are equal: one bin, with a width of a hundredth of the value.
            let width = if low == 0.0 { 1.0 } else { 0.01 * low.abs() };
            return Self {
                start: low - 0.5 * width,
                width,
                counts: vec![sorted.len()],
            };
        }
        let quartiles = percentile(sorted, 75.0) - percentile(sorted, 25.0);
        let ideal = 2.0 * quartiles / (sorted.len() as f64).cbrt();
        let count = if ideal > 0.0 { extent / ideal } else { 60.0 };
        let count = (count.ceil() as usize).clamp(5, 60);
        let width = extent / count as f64;
        let mut counts = vec![0; count];
        for value in sorted {
            let bin = ((value - low) / width) as usize;
            counts[bin.min(count - 1)] += 1;
        }
        Self {
            start: low,
            width,
            counts,
        }
    }

    /// Corners of the outline of all bars.
    fn outline(&self) -> Vec<[f64; 2]> {
        let edge = |k: usize| self.start + k as f64 * self.width;
        let mut corners = vec![[self.start, 0.0]];
        for (k, count) in self.counts.iter().enumerate() {
            let height = *count as f64;
            corners.extend([[edge(k), height], [edge(k + 1), height]]);
        }
        corners.push([edge(self.counts.len()), 0.0]);
        corners
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_by_hand() {
        let values = [1.0, 2.0, 4.0, 8.0, 16.0];
        for (percentage, value) in [(50.0, 4.0), (0.0, 1.0), (100.0, 16.0), (12.5, 1.5)] {
            assert!((percentile(&values, percentage) - value).abs() < 1e-12);
        }
    }

    #[test]
    fn percentiles_have_english_names() {
        for (percentage, name) in [
            (50.0, "median"),
            (5.0, "5th percentile"),
            (91.0, "91st percentile"),
            (12.0, "12th percentile"),
            (2.5, "2.5th percentile"),
        ] {
            assert_eq!(ordinal(percentage), name);
        }
    }

    #[test]
    fn every_value_is_in_a_bin() {
        let values: Vec<f64> = (0..1000).map(|k| f64::from(k).sqrt()).collect();
        let bins = Bins::of(&values);
        assert_eq!(bins.counts.iter().sum::<usize>(), 1000);
        assert_eq!(Bins::of(&[3.0, 3.0, 3.0]).counts, [3]);
        assert_eq!(Bins::of(&[0.0, 0.0]).counts, [2]);
    }
}
