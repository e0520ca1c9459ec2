//! Statistics of a parameter over several curves: mean, scatter, weighted mean and outliers.

use super::misfit::chi_square_above;

/// Modified z-score beyond which a value is an outlier: B. Iglewicz and D. C. Hoaglin, How to Detect and Handle Outliers, ASQC
/// Quality Press (1993), who recommend 3.5.
pub const OUTLIER_SCORE: f64 = 3.5;

/// Smallest number of curves for which outliers are named. With fewer, the median absolute deviation is too uncertain.
pub const FEWEST_FOR_OUTLIERS: usize = 5;

/// Median absolute deviation of a normal distribution, in standard deviations: its upper quartile.
const NORMAL_DEVIATION: f64 = 0.6745;

/// A value of one curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Number of the curve, from 0.
    pub curve: usize,
    /// Value, in SI units.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// A value far from the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Number of the curve, from 0.
    pub curve: usize,
    /// Value, in SI units.
    pub value: f64,
    /// Modified z-score, `0.6745 (value - median)/(median absolute deviation)`; its size is above [`OUTLIER_SCORE`].
    pub score: f64,
}

/// Mean of values weighted with the inverse squares of their standard errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedMean {
    /// The mean, in SI units.
    pub value: f64,
    /// Its standard error, from the standard errors of the values.
    pub standard_error: f64,
    /// Sum of squares of (value - mean)/standard error.
    pub chi_square: f64,
    /// Number of values minus one.
    pub degrees_of_freedom: usize,
    /// Probability of a chi-square of at least this value if all curves have the same value and normal errors; `None` for one curve.
    pub p_value: Option<f64>,
}

/// Statistics of the values of several curves, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    /// Number of values.
    pub count: usize,
    /// Arithmetic mean.
    pub mean: f64,
    /// Standard deviation of a single value, with `count - 1` degrees of freedom; `None` for one value.
    pub standard_deviation: Option<f64>,
    /// Standard error of the mean, from the standard deviation.
    pub standard_error: Option<f64>,
    /// Median.
    pub median: f64,
    /// Weighted mean; `None` if a standard error is not positive.
    pub weighted_mean: Option<WeightedMean>,
    /// Values far from the others. They are contained in all means.
    pub outliers: Vec<Outlier>,
}

impl Statistics {
    /// Statistics of at least one value; `None` without values, or if a value is not finite.
    #[must_use]
    pub fn new(samples: &[Sample]) -> Option<Self> {
        let count = samples.len();
        let values: Vec<f64> = samples.iter().map(|sample| sample.value).collect();
        if count == 0 || values.iter().any(|value| !value.is_finite()) {
            return None;
        }
        let mean = values.iter().sum::<f64>() / count as f64;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let standard_deviation = (count > 1).then(|| (squares / (count - 1) as f64).sqrt());
        let median = median(values);
        Some(Self {
            count,
            mean,
            standard_deviation,
            standard_error: standard_deviation.map(|scatter| scatter / (count as f64).sqrt()),
            median,
            weighted_mean: weighted_mean(samples),
            outliers: outliers(samples, median),
        })
    }
}

/// Median of at least one finite value.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 {
        values[half]
    } else {
        f64::midpoint(values[half - 1], values[half])
    }
}

fn weighted_mean(samples: &[Sample]) -> Option<WeightedMean> {
    // Relative to the smallest error, so that the squares neither overflow nor vanish.
    let least = samples.iter().map(|s| s.standard_error);
    let least = least.fold(f64::INFINITY, f64::min);
    let is_usable = |s: &Sample| s.standard_error > 0.0 && s.standard_error.is_finite();
    if !samples.iter().all(is_usable) {
        return None;
    }
    let weight = |sample: &Sample| (least / sample.standard_error).powi(2);
    let sum: f64 = samples.iter().map(weight).sum();
    let weighted: f64 = samples.iter().map(|s| weight(s) * s.value).sum();
    let value = weighted / sum;
    let terms = samples.iter();
    let chi_square = terms
        .map(|s| ((s.value - value) / s.standard_error).powi(2))
        .sum();
    let degrees_of_freedom = samples.len() - 1;
    Some(WeightedMean {
        value,
        standard_error: least / sum.sqrt(),
        chi_square,
        degrees_of_freedom,
        p_value: (degrees_of_freedom > 0).then(|| chi_square_above(chi_square, degrees_of_freedom)),
    })
}

/// Values whose modified z-score is too large. There are none among fewer than [`FEWEST_FOR_OUTLIERS`] values, nor if more than half of
/// the values are equal, so that the median absolute deviation is zero.
fn outliers(samples: &[Sample], median: f64) -> Vec<Outlier> {
    let deviations = samples.iter().map(|sample| (sample.value - median).abs());
    let deviation = self::median(deviations.collect());
    if samples.len() < FEWEST_FOR_OUTLIERS || deviation <= 0.0 {
        return Vec::new();
    }
    let outlier = |sample: &Sample| {
        let score = NORMAL_DEVIATION * (sample.value - median) / deviation;
        (score.abs() > OUTLIER_SCORE).then_some(Outlier {
            curve: sample.curve,
            value: sample.value,
            score,
        })
    };
    samples.iter().filter_map(outlier).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(values: &[f64], errors: &[f64]) -> Vec<Sample> {
        let pairs = values.iter().zip(errors).enumerate();
        pairs
            .map(|(curve, (value, standard_error))| Sample {
                curve,
                value: *value,
                standard_error: *standard_error,
            })
            .collect()
    }

    #[test]
    fn means_by_hand() {
        // Mean (1 + 2 + 6)/3 = 3, squares 4 + 1 + 9 = 14, standard deviation sqrt(7). Weights 1, 1, 1/4: weighted mean
        // (1 + 2 + 1.5)/2.25 = 2, standard error 1/sqrt(2.25) = 2/3, chi-square 1 + 0 + 16/4 = 5, whose probability with two degrees of
        // freedom is exp(-5/2).
        let found = Statistics::new(&samples(&[1.0, 2.0, 6.0], &[1.0, 1.0, 2.0])).unwrap();
        assert!((found.mean - 3.0).abs() < 1e-14 && (found.median - 2.0).abs() < 1e-14);
        assert!((found.standard_deviation.unwrap() - 7f64.sqrt()).abs() < 1e-14);
        assert!((found.standard_error.unwrap() - (7f64 / 3.0).sqrt()).abs() < 1e-14);
        let weighted = found.weighted_mean.unwrap();
        assert!((weighted.value - 2.0).abs() < 1e-14);
        assert!((weighted.standard_error - 2.0 / 3.0).abs() < 1e-14);
        assert!((weighted.chi_square - 5.0).abs() < 1e-13);
        assert!((weighted.p_value.unwrap() - (-2.5f64).exp()).abs() < 1e-12);
        assert!(found.outliers.is_empty());
    }

    #[test]
    fn outliers_of_the_book() {
        // Two of ten values are far away. Median 2.45; the absolute deviations are twice 0.05, four times 0.15, twice 0.35, 5.75 and
        // 5.85, with the median 0.15: scores 0.6745*5.75/0.15 = 25.86 and 0.6745*5.85/0.15 = 26.31, all others at most 1.574.
        let values = [2.1, 2.6, 2.4, 2.5, 2.3, 2.1, 2.3, 2.6, 8.2, 8.3];
        let found = Statistics::new(&samples(&values, &[1.0; 10])).unwrap();
        let scores: Vec<(usize, f64)> = found.outliers.iter().map(|o| (o.curve, o.score)).collect();
        assert_eq!(scores.len(), 2);
        assert_eq!((scores[0].0, scores[1].0), (8, 9));
        assert!((scores[0].1 - 25.856).abs() < 1e-3 && (scores[1].1 - 26.306).abs() < 1e-3);
        // Too few, or more than half of them equal.
        for values in [&[1.0, 1.1, 0.9, 50.0][..], &[1.0, 1.0, 1.0, 1.0, 50.0]] {
            let found = Statistics::new(&samples(values, &[1.0; 5])).unwrap();
            assert!(found.outliers.is_empty(), "{values:?}");
        }
    }

    #[test]
    fn one_value_and_none() {
        let found = Statistics::new(&samples(&[4.0], &[0.5])).unwrap();
        assert_eq!((found.mean, found.standard_deviation), (4.0, None));
        let weighted = found.weighted_mean.unwrap();
        assert_eq!((weighted.standard_error, weighted.p_value), (0.5, None));
        assert_eq!(Statistics::new(&[]), None);
        assert_eq!(Statistics::new(&samples(&[f64::NAN], &[1.0])), None);
        let exact = Statistics::new(&samples(&[1.0, 2.0], &[0.0, 1.0])).unwrap();
        assert_eq!(exact.weighted_mean, None);
    }
}
