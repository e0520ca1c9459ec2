//! Axes: ranges, ticks and their labels.

use crate::text::Text;

/// Scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences have equal lengths.
    Linear,
    /// Equal ratios have equal lengths; values that are not positive are not shown.
    Logarithmic,
}

impl Scale {
    /// Whether an axis can show a value.
    pub(crate) fn shows(self, value: f64) -> bool {
        value.is_finite() && (self == Self::Linear || value > 0.0)
    }
}

/// An axis of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Name of the quantity and its unit.
    pub label: Text,
    /// Scale.
    pub scale: Scale,
    /// First and last value; `None`: the range of the data.
    pub range: Option<[f64; 2]>,
    /// Whether a linear axis has ticks at whole numbers alone.
    pub whole: bool,
}

impl Axis {
    /// A linear axis that shows all data.
    #[must_use]
    pub fn linear(label: impl Into<Text>) -> Self {
        Self {
            label: label.into(),
            scale: Scale::Linear,
            range: None,
            whole: false,
        }
    }

    /// A logarithmic axis that shows all data that are positive.
    #[must_use]
    pub fn logarithmic(label: impl Into<Text>) -> Self {
        Self {
            scale: Scale::Logarithmic,
            ..Self::linear(label)
        }
    }

    /// A linear axis for numbers from 1 to `last`.
    pub(crate) fn numbered(label: impl Into<Text>, last: usize) -> Self {
        Self {
            whole: true,
            ..Self::linear(label).over(0.5, last as f64 + 0.5)
        }
    }

    /// The same axis from one value to another.
    #[must_use]
    pub fn over(self, first: f64, last: f64) -> Self {
        Self {
            range: Some([first, last]),
            ..self
        }
    }

    /// A linear axis of deviations: shows all data and the line of zero, with a margin on both sides of each.
    pub(crate) fn of_deviations(label: impl Into<Text>, values: impl Iterator<Item = f64>) -> Self {
        let finite = values.filter(|value| value.is_finite());
        let (low, high) = finite.fold((0.0f64, 0.0f64), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        let room = if high > low { 0.1 * (high - low) } else { 1.0 };
        Self::linear(label).over(low - room, high + room)
    }

    /// The same axis for the range of these values, with a margin.
    pub(crate) fn around(self, values: impl Iterator<Item = f64>) -> Self {
        let [first, last] = self.span(values).range;
        self.over(first, last)
    }

    /// Range of the axis: the given one, or that of the data with a margin.
    pub(crate) fn span(&self, data: impl Iterator<Item = f64>) -> Span {
        let shown = |value: &f64| self.scale.shows(*value);
        let range = self
            .range
            .filter(|range| range.iter().all(shown) && range[0] < range[1]);
        let range = range.unwrap_or_else(|| {
            let (low, high) = data
                .filter(shown)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                    (low.min(value), high.max(value))
                });
            with_padding(self.scale, low, high)
        });
        Span {
            scale: self.scale,
            range,
            whole: self.whole,
        }
    }
}

/// Margin between the data and the ends of an axis, relative to the range of the data.
const PADDING: f64 = 0.05;

fn with_padding(scale: Scale, low: f64, high: f64) -> [f64; 2] {
    if low > high {
        return [1.0, 10.0]; // no data
    }
    match scale {
        Scale::Logarithmic => {
            let factor = (high / low).powf(PADDING).max(1.05);
            [low / factor, high * factor]
        }
        Scale::Linear => {
            let extent = high - low;
            let space = if extent > 1e-12 * high.abs().max(low.abs()) {
                PADDING * extent
            } else if high == 0.0 {
                1.0
            } else {
                0.1 * high.abs()
            };
            // If zero is near the range, the axis starts at zero.
            let bottom = if low >= 0.0 && low < 0.3 * high {
                0.0
            } else {
                low - space
            };
            let top = if high <= 0.0 && high > 0.3 * low {
                0.0
            } else {
                high + space
            };
            [bottom, top]
        }
    }
}

/// The values along an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    pub(crate) scale: Scale,
    pub(crate) range: [f64; 2],
    /// Whether ticks of a linear scale are whole numbers.
    whole: bool,
}

/// A mark on an axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    pub(crate) value: f64,
    /// The number beside the tick; `None` for a minor tick.
    pub(crate) label: Option<Text>,
    pub(crate) major: bool,
}

/// Direction of an axis, which determines the size of labels along it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Direction {
    Across,
    Upwards,
}

impl Span {
    pub(crate) fn linear(low: f64, high: f64) -> Self {
        Self {
            scale: Scale::Linear,
            range: [low, high],
            whole: false,
        }
    }

    /// Position of a value, from 0 at the first value to 1 at the last; far below 0 for values that
    /// a logarithmic axis cannot show.
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        match self.scale {
            Scale::Linear => (value - low) / (high - low),
            Scale::Logarithmic if value > 0.0 => (value / low).ln() / (high / low).ln(),
            Scale::Logarithmic => -100.0,
        }
    }

    /// Value at a relative position.
    pub(crate) fn value(&self, fraction: f64) -> f64 {
        let [low, high] = self.range;
        match self.scale {
            Scale::Linear => low + fraction * (high - low),
            Scale::Logarithmic => low * (high / low).powf(fraction),
        }
    }

    fn holds(&self, value: f64) -> bool {
        (-1e-9..=1.0 + 1e-9).contains(&self.fraction(value))
    }

    /// Marks on an axis `length` points long with labels of `size` points.
    pub(crate) fn ticks(&self, length: f64, size: f64, direction: Direction) -> Vec<Tick> {
        let most = match direction {
            Direction::Across => length / (4.0 * size),
            Direction::Upwards => length / (3.2 * size),
        };
        let most = (most as usize).clamp(2, 7);
        // If the preferred numbers of ticks give a single label, more are tried.
        let candidates: Vec<Vec<Tick>> = (2..=most)
            .rev()
            .chain(most + 1..=2 * most + 4)
            .map(|count| match self.scale {
                Scale::Linear => linear_ticks(self.range, count, self.whole),
                Scale::Logarithmic => self.logarithmic_ticks(count),
            })
            .collect();
        // Two labels are needed to read the scale. If only one fits, it is shown.
        let with_labels = |fewest: usize| {
            candidates.iter().find(|ticks| {
                let labels = ticks.iter().filter(|tick| tick.label.is_some()).count();
                labels >= fewest && self.labels_are_apart(ticks, length, size, direction)
            })
        };
        with_labels(2)
            .or_else(|| with_labels(1))
            .or(candidates.get(most - 2))
            .cloned()
            .unwrap_or_default()
    }

    fn labels_are_apart(
        &self,
        ticks: &[Tick],
        length: f64,
        size: f64,
        direction: Direction,
    ) -> bool {
        let extents: Vec<(f64, f64)> = ticks
            .iter()
            .filter_map(|tick| {
                let half = 0.5
                    * match direction {
                        Direction::Across => size * (tick.label.as_ref()?.width() + 0.6),
                        Direction::Upwards => {
                            tick.label.as_ref()?;
                            1.3 * size
                        }
                    };
                let at = length * self.fraction(tick.value);
                Some((at - half, at + half))
            })
            .collect();
        extents.windows(2).all(|pair| pair[0].1 <= pair[1].0)
    }

    /// Ticks with at most `most` labels.
    fn logarithmic_ticks(&self, most: usize) -> Vec<Tick> {
        let [low, high] = self.range;
        let first = (low.log10() + 1e-9).floor() as i32;
        let last = (high.log10() - 1e-9).ceil() as i32;
        let decades: Vec<i32> = (first..=last)
            .filter(|power| self.holds(10f64.powi(*power)))
            .collect();
        if decades.len() < 2 {
            return self.ticks_within_a_decade([first, last], most);
        }
        let every = decades.len().div_ceil(most) as i32;
        let mut ticks = Vec::new();
        for power in first..=last {
            let decade = 10f64.powi(power);
            if self.holds(decade) {
                let labelled = power.rem_euclid(every) == 0;
                ticks.push(Tick {
                    value: decade,
                    label: labelled.then(|| Text::from(format!("10^{{{power}}}"))),
                    major: true,
                });
            }
            if last - first <= 10 {
                ticks.extend(
                    (2..10)
                        .map(|digit| f64::from(digit) * decade)
                        .filter(|value| self.holds(*value))
                        .map(|value| Tick {
                            value,
                            label: None,
                            major: false,
                        }),
                );
            }
        }
        ticks
    }

    /// Labels at numbers that are not powers of ten, for ranges with too few powers of ten.
    fn ticks_within_a_decade(&self, powers: [i32; 2], most: usize) -> Vec<Tick> {
        const CHOICES: [&[i32]; 4] = [
            &[1, 2, 3, 4, 5, 6, 7, 8, 9],
            &[1, 2, 3, 5, 7],
            &[1, 2, 5],
            &[1, 3],
        ];
        let all: Vec<(i32, f64)> = (powers[0]..=powers[1])
            .flat_map(|power| {
                (1..10).map(move |digit| (digit, f64::from(digit) * 10f64.powi(power)))
            })
            .filter(|(_, value)| self.holds(*value))
            .collect();
        let labelled = |digits: &[i32]| all.iter().filter(|(d, _)| digits.contains(d)).count();
        let choice = CHOICES
            .into_iter()
            .find(|digits| (2..=most).contains(&labelled(digits)));
        let digits = match choice {
            Some(digits) => digits,
            None if self.range[1] > 5.0 * self.range[0] && labelled(&[1]) > 0 => &[1],
            None => return linear_ticks(self.range, most, false),
        };
        all.iter()
            .map(|(digit, value)| {
                let label = digits.contains(digit);
                Tick {
                    value: *value,
                    label: label.then(|| Text::from(plain(*value))),
                    major: label,
                }
            })
            .collect()
    }
}

/// Formats a number with few digits, with a power of ten if it is very large or small.
fn plain(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e4).contains(&size) {
        let digits: f64 = format!("{value:.6e}").parse().unwrap_or(value);
        digits.to_string()
    } else {
        let power = size.log10().floor() as i32;
        let digits = value / 10f64.powi(power);
        let digits: f64 = format!("{digits:.4}").parse().unwrap_or(digits);
        format!("{digits}·10^{{{power}}}")
    }
}

/// Marks at multiples of 1, 2 or 5 times a power of ten, `most` with labels at most; at whole numbers if `whole`.
fn linear_ticks([low, high]: [f64; 2], most: usize, whole: bool) -> Vec<Tick> {
    let raw = (high - low) / most as f64;
    let raw = if whole { raw.max(1.0) } else { raw };
    let power = raw.log10().floor();
    let unit = 10f64.powf(power);
    let (step, minor) = [(1.0, 5), (2.0, 4), (5.0, 5), (10.0, 5)]
        .into_iter()
        .find(|(step, _)| step * unit >= 0.8 * raw)
        .map_or((10.0 * unit, 5), |(step, minor)| (step * unit, minor));
    let minor = if whole && step < f64::from(minor) {
        1
    } else {
        minor
    };
    let fine = step / f64::from(minor);
    let (first, last) = (
        (low / fine - 1e-6).ceil() as i64,
        (high / fine + 1e-6).floor() as i64,
    );
    let write = number_format(low.abs().max(high.abs()), step);
    (first..=last)
        .map(|k| {
            let value = k as f64 * fine;
            let major = k % i64::from(minor) == 0;
            Tick {
                value,
                label: major.then(|| if k == 0 { write(0.0) } else { write(value) }),
                major,
            }
        })
        .collect()
}

/// Returns the format of multiples of `step` up to `largest`: the same number of decimals for all,
/// and the same power of ten if they are very large or small.
fn number_format(largest: f64, step: f64) -> impl Fn(f64) -> Text {
    let power_of_step = (step.log10() + 1e-9).floor() as i32;
    let plain = (1e-3..1e5).contains(&largest) && power_of_step >= -5;
    let power = if plain {
        0
    } else {
        (largest.log10() + 1e-9).floor() as i32
    };
    let decimals = (power - power_of_step).max(0) as usize;
    move |value| {
        let digits = value / 10f64.powi(power);
        Text::from(if power == 0 {
            format!("{digits:.decimals$}")
        } else if value == 0.0 {
            "0".to_owned()
        } else {
            format!("{digits:.decimals$}·10^{{{power}}}")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(span: Span, length: f64) -> Vec<String> {
        span.ticks(length, 7.0, Direction::Across)
            .into_iter()
            .filter_map(|tick| tick.label.map(|label| label.to_string()))
            .collect()
    }

    fn logarithmic(low: f64, high: f64) -> Span {
        Span {
            scale: Scale::Logarithmic,
            range: [low, high],
            whole: false,
        }
    }

    #[test]
    fn round_numbers_on_linear_axes() {
        assert_eq!(
            labels(Span::linear(0.0, 1.0), 150.0),
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(labels(Span::linear(-3.0, 12.0), 150.0), ["0", "5", "10"]);
        assert_eq!(
            labels(Span::linear(0.0, 2.3e-7), 150.0),
            ["0", "0.5·10−7", "1.0·10−7", "1.5·10−7", "2.0·10−7"]
        );
    }

    #[test]
    fn whole_numbers_alone() {
        let ticks = |last: usize| {
            let span = Axis::numbered("curve", last).span(std::iter::empty());
            let ticks = span.ticks(200.0, 7.0, Direction::Across);
            assert!(ticks.iter().all(|tick| tick.value.fract() == 0.0));
            labels(span, 200.0)
        };
        assert_eq!(ticks(3), ["1", "2", "3"]);
        assert_eq!(ticks(1), ["1"]);
        assert_eq!(ticks(20), ["5", "10", "15", "20"]);
    }

    #[test]
    fn powers_of_ten_on_logarithmic_axes() {
        assert_eq!(
            labels(logarithmic(1e-4, 0.3), 200.0),
            ["10−4", "10−3", "10−2", "10−1"]
        );
        assert_eq!(
            labels(logarithmic(1.0, 7.0), 150.0),
            ["1", "2", "3", "5", "7"]
        );
        assert_eq!(
            labels(logarithmic(0.97, 1.04), 150.0),
            ["0.98", "1.00", "1.02", "1.04"]
        );
        let wide = labels(logarithmic(1e-12, 1e9), 150.0);
        assert!((3..=7).contains(&wide.len()), "{wide:?}");
    }

    #[test]
    fn labels_never_touch() {
        for step in 0..400 {
            let low = 10f64.powf(-6.0 + 0.03 * f64::from(step));
            for factor in [1.01, 1.5, 3.0, 30.0, 1e4, 1e9] {
                for span in [
                    logarithmic(low, low * factor),
                    Span::linear(-low, low * factor),
                ] {
                    for length in [60.0, 150.0, 400.0] {
                        let ticks = span.ticks(length, 7.0, Direction::Across);
                        let labelled = ticks.iter().any(|tick| tick.label.is_some());
                        assert!(labelled || length < 100.0, "{span:?} {length}");
                        let apart = span.labels_are_apart(&ticks, length, 7.0, Direction::Across);
                        assert!(apart || length < 100.0, "{span:?} {length}");
                    }
                }
            }
        }
    }

    /// Zero is inside the axis, not on its end, and at least two numbers are printed along an axis as high as that of residuals.
    #[test]
    fn axes_of_deviations_show_zero_and_two_numbers() {
        for step in 0..300 {
            let size = 10f64.powf(-3.0 + 0.02 * f64::from(step));
            for [low, high] in [[-1.0, 1.0], [-1.0, 0.0], [0.0, 1.0], [0.2, 0.9], [0.0, 0.0]] {
                let values = [low * size, high * size];
                let axis = Axis::of_deviations("residual", values.into_iter());
                let span = axis.span(std::iter::empty());
                let [bottom, top] = span.range;
                assert!(bottom < 0.0f64.min(values[0]) && top > 0.0f64.max(values[1]));
                let ticks = span.ticks(76.0, 7.0, Direction::Upwards);
                let labels = ticks.iter().filter(|tick| tick.label.is_some());
                assert!(labels.count() >= 2, "{span:?}");
                assert!(span.labels_are_apart(&ticks, 76.0, 7.0, Direction::Upwards));
            }
        }
    }

    #[test]
    fn ranges_contain_the_data() {
        let data = || [0.5, 3.0, -1.0].into_iter();
        let span = Axis::linear("x").span(data());
        assert!(data().all(|value| span.holds(value)));
        let span = Axis::logarithmic("x").span(data());
        assert!(span.holds(0.5) && span.holds(3.0) && !span.holds(-1.0));
        // Without data and with a single value there is a valid range.
        let bare = Axis::linear("x").span(std::iter::empty()).range;
        assert!(bare[0] < bare[1]);
        let single = Axis::linear("x").span(std::iter::once(5.0)).range;
        assert!(single[0] < 5.0 && single[1] > 5.0);
        // An invalid range is ignored.
        let span = Axis::logarithmic("x").over(0.0, 1.0).span(data());
        assert!(span.holds(0.5) && span.holds(3.0));
    }
}
