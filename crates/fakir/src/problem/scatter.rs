//! Distributions of pillar heights, and the random numbers for all random properties of surfaces.

use std::f64::consts::PI;

/// The distribution of the heights of pillars.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Law {
    /// A normal law, truncated at four standard deviations. Its parameter is the standard deviation.
    #[default]
    Normal,
    /// A uniform law. Its parameter is the half-width.
    Uniform,
}

impl Law {
    /// The largest deviation divided by the parameter.
    pub(crate) fn reach(self) -> f64 {
        match self {
            Self::Normal => 4.0,
            Self::Uniform => 1.0,
        }
    }
}

/// Variation of the heights of pillars about the common height. Every height is independent of the others and determined by the seed and
/// the index of its pillar.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Scatter {
    /// The distribution of the heights.
    pub law: Law,
    /// The parameter of the law relative to the common height; 0 for equal heights.
    pub parameter: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Scatter {
    /// Normally distributed heights with a standard deviation relative to the common height.
    #[must_use]
    pub fn normal(standard_deviation: f64, seed: u64) -> Self {
        Self {
            law: Law::Normal,
            parameter: standard_deviation,
            seed,
        }
    }

    /// Uniformly distributed heights with a half-width relative to the common height.
    #[must_use]
    pub fn uniform(half_width: f64, seed: u64) -> Self {
        Self {
            law: Law::Uniform,
            parameter: half_width,
            seed,
        }
    }

    /// Whether all heights are equal.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.parameter == 0.0
    }

    /// The largest deviation from the common height, relative to that height.
    #[must_use]
    pub fn most(&self) -> f64 {
        self.law.reach() * self.parameter
    }

    /// The standard deviation relative to the common height, neglecting the truncation of a normal law.
    #[must_use]
    pub fn standard_deviation(&self) -> f64 {
        match self.law {
            Law::Normal => self.parameter,
            Law::Uniform => self.parameter / 3f64.sqrt(),
        }
    }
}

/// Differences between the pillars of an arrangement: each pillar is present or missing and has a random height, independent of the others
/// and reproducible for the same seed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Disorder {
    /// The variation of the heights. Its seed also determines which pillars are missing.
    pub heights: Scatter,
    /// Probability that a pillar is missing.
    pub missing: f64,
}

impl Disorder {
    /// Whether no pillar is missing and all have the same height.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.heights.is_none() && self.missing == 0.0
    }

    /// Height of the pillar with an index, relative to the common height; `None` if the pillar is missing.
    ///
    /// Published samples must be reproducible in every version, so that each law keeps the random stream with which it was introduced:
    /// pillar patterns have normally distributed heights, height maps uniformly distributed ones.
    #[must_use]
    pub fn height_ratio(&self, index: (i64, i64)) -> Option<f64> {
        match self.heights.law {
            Law::Normal => self.normal_ratio(index),
            Law::Uniform => self.uniform_ratio(index),
        }
    }

    fn normal_ratio(&self, (i, j): (i64, i64)) -> Option<f64> {
        let Scatter {
            parameter, seed, ..
        } = self.heights;
        // Two streams, so that heights do not depend on the probability that pillars are missing.
        let stream = |number: u64| {
            let mut state = mixed(seed ^ mixed(number));
            for index in [i, j] {
                state = mixed(state ^ index as u64);
            }
            state
        };
        if self.missing > 0.0 && uniform(stream(1)) < self.missing {
            return None;
        }
        if parameter == 0.0 {
            return Some(1.0);
        }
        let mut state = stream(2);
        loop {
            // G. E. P. Box, M. E. Muller, Ann. Math. Stat. 29, 610 (1958).
            let (one, other) = (uniform(mixed(state)), uniform(mixed(state ^ 1)));
            let deviation = (-2.0 * (1.0 - one).ln()).sqrt() * (2.0 * PI * other).cos();
            if deviation.abs() <= Law::Normal.reach() {
                return Some(1.0 + parameter * deviation);
            }
            state = mixed(state);
        }
    }

    fn uniform_ratio(&self, (i, j): (i64, i64)) -> Option<f64> {
        let Scatter {
            parameter, seed, ..
        } = self.heights;
        let mut of_row = Random::new(seed ^ (i as u64).wrapping_mul(GOLDEN));
        let mut random =
            Random::new(of_row.next() ^ (j as u64).wrapping_mul(0xd1b5_4a32_d192_ed03));
        if random.uniform() < self.missing {
            return None;
        }
        Some(1.0 + parameter * (2.0 * random.uniform() - 1.0))
    }
}

/// 2^64 divided by the golden ratio, the increment of SplitMix64.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A sequence of random numbers: SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014).
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        let next = mixed(self.0);
        self.0 = self.0.wrapping_add(GOLDEN);
        next
    }

    /// A uniformly distributed number in [0, 1).
    pub(super) fn uniform(&mut self) -> f64 {
        uniform(self.next())
    }
}

/// The output function of SplitMix64: adjacent states have unrelated outputs.
fn mixed(state: u64) -> u64 {
    let mut z = state.wrapping_add(GOLDEN);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A number in [0, 1) from the 53 bits of the mantissa.
fn uniform(bits: u64) -> f64 {
    (bits >> 11) as f64 * 2f64.powi(-53)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means and deviations of many samples, within four of their standard errors.
    #[test]
    fn heights_have_the_given_scatter() {
        let disorder = Disorder {
            heights: Scatter::normal(0.05, 3),
            missing: 0.1,
        };
        let (mut missing, mut heights) = (0, Vec::new());
        for i in -100..100 {
            for j in -100..100 {
                match disorder.height_ratio((i, j)) {
                    None => missing += 1,
                    Some(ratio) => heights.push(ratio),
                }
            }
        }
        let drawn = 40_000.0;
        assert!((f64::from(missing) / drawn - 0.1).abs() < 4.0 * (0.09 / drawn).sqrt());
        let count = heights.len() as f64;
        let mean = heights.iter().sum::<f64>() / count;
        let variance = heights.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / count;
        assert!((mean - 1.0).abs() < 4.0 * 0.05 / count.sqrt());
        assert!((variance.sqrt() / 0.05 - 1.0).abs() < 4.0 / (2.0 * count).sqrt() + 1e-3);
        assert!(heights.iter().all(|h| (h - 1.0).abs() <= 0.2));
        // Heights of neighbours are independent.
        let row: Vec<f64> = (0..10_000)
            .filter_map(|i| {
                Disorder {
                    missing: 0.0,
                    ..disorder
                }
                .height_ratio((i, 7))
            })
            .map(|ratio| (ratio - 1.0) / 0.05)
            .collect();
        let product: f64 = row.windows(2).map(|pair| pair[0] * pair[1]).sum();
        assert!((product / 1e4).abs() < 0.04);
        // The height of a pillar does not change when others are removed.
        let whole = Disorder {
            missing: 0.0,
            ..disorder
        };
        let same = |index| {
            disorder
                .height_ratio(index)
                .is_none_or(|ratio| Some(ratio) == whole.height_ratio(index))
        };
        assert!((0..100).all(|i| same((i, -i))));
        let other = Disorder {
            heights: Scatter::normal(0.05, 4),
            ..whole
        };
        assert_ne!(other.height_ratio((0, 0)), whole.height_ratio((0, 0)));
    }

    /// Samples of the random streams as first published, computed by an independent program: a seed must define the same pillars in every
    /// version.
    #[test]
    fn published_draws_stay() {
        let drawn = |heights: Scatter| {
            let disorder = Disorder {
                heights,
                missing: 0.25,
            };
            [-3, -2, 0, 1].map(|i| disorder.height_ratio((i, 2 * i + 1)))
        };
        let normal = [
            Some(0.9688855899325534),
            Some(1.0079377908961469),
            Some(0.9718109957202881),
            None,
        ];
        let uniform = [
            None,
            Some(0.9894543071332559),
            Some(1.1827405196238783),
            Some(1.0647308272522198),
        ];
        let drawn = [
            drawn(Scatter::normal(0.05, 3)),
            drawn(Scatter::uniform(0.2, 3)),
        ];
        for (drawn, published) in drawn
            .iter()
            .flatten()
            .zip([normal, uniform].iter().flatten())
        {
            let same = match (drawn, published) {
                (Some(drawn), Some(published)) => (drawn - published).abs() < 1e-14,
                (drawn, published) => drawn.is_none() && published.is_none(),
            };
            assert!(same, "{drawn:?} is not {published:?}");
        }
    }
}
