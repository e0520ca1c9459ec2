//! Whether a fit describes the data: tests of its residuals, with p-values.

use super::measurements::Quantity;
use super::parameter::Parameter;
use fakir::state::Branch;
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};
use statrs::function::erf::erfc;
use statrs::function::gamma::ln_gamma;

/// Significance level of all tests together: the largest probability of rejecting a fit that describes its data. Half of it is shared by
/// the tests of the residuals, half by those of fixed parameters.
pub const LEVEL: f64 = 0.01;

/// Runs test of the residuals of a quantity in the order of the load, which counts their changes of
/// sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunsTest {
    /// The quantity.
    pub quantity: Quantity,
    /// The branch.
    pub branch: Branch,
    /// Residuals above and below zero.
    pub signs: [usize; 2],
    /// Runs of residuals of one sign.
    pub runs: usize,
    /// Probability of at most this number of runs if all orders of the signs are equally likely.
    pub p_value: f64,
}

impl RunsTest {
    /// Test of residuals in their order; residuals of zero are ignored.
    pub(super) fn new(quantity: Quantity, branch: Branch, residuals: &[f64]) -> Option<Self> {
        let signs: Vec<bool> = residuals
            .iter()
            .filter(|residual| **residual != 0.0)
            .map(|residual| *residual > 0.0)
            .collect();
        let above = signs.iter().filter(|sign| **sign).count();
        let below = signs.len() - above;
        if signs.is_empty() {
            return None;
        }
        let runs = 1 + signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
        Some(Self {
            quantity,
            branch,
            signs: [above, below],
            runs,
            p_value: probability_of_runs(above, below, runs),
        })
    }

    /// Expected number of runs, `2 n m/(n + m) + 1`.
    #[must_use]
    pub fn expected(&self) -> f64 {
        let [above, below] = self.signs.map(|count| count as f64);
        2.0 * above * below / (above + below) + 1.0
    }
}

/// Exact probability of at most `runs` runs in a random order of `above` and `below` signs: A. Wald and J. Wolfowitz, Ann.
/// Math. Stat. 11, 147 (1940).
pub(super) fn probability_of_runs(above: usize, below: usize, runs: usize) -> f64 {
    if above == 0 || below == 0 {
        return 1.0;
    }
    // Logarithm of the number of ways to divide an ordered sequence into a given number of non-empty groups.
    let divided = |things: usize, groups: usize| {
        if groups == 0 || groups > things {
            return f64::NEG_INFINITY;
        }
        ln_choose(things - 1, groups - 1)
    };
    let all = ln_choose(above + below, above);
    let of = |number: usize| {
        let (half, more) = (number / 2, number.div_ceil(2));
        let one = divided(above, half) + divided(below, more);
        let other = divided(above, more) + divided(below, half);
        (one - all).exp() + (other - all).exp()
    };
    let sum: f64 = (2..=runs).map(of).sum();
    sum.min(1.0)
}

fn ln_choose(of: usize, some: usize) -> f64 {
    let factorial = |n: usize| ln_gamma(n as f64 + 1.0);
    factorial(of) - factorial(some) - factorial(of - some)
}

/// Probability of a chi-square of at least this value.
pub(super) fn chi_square_above(chi_square: f64, freedom: usize) -> f64 {
    ChiSquared::new(freedom as f64).map_or(1.0, |law| law.sf(chi_square))
}

/// Probability of a chi-square of at most this value.
pub(super) fn chi_square_below(chi_square: f64, freedom: usize) -> f64 {
    ChiSquared::new(freedom as f64).map_or(1.0, |law| law.cdf(chi_square))
}

/// Score test (C. R. Rao, Proc. Camb. Phil. Soc. 44, 50 (1948)), or Lagrange multiplier test, of a fixed parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeftOut {
    /// The parameter.
    pub parameter: Parameter,
    /// Probability, under a correct model, of residuals that are correlated at least as much with the effect of
    /// the parameter.
    pub p_value: f64,
    /// Value of the parameter after a linear step if it were free, in SI units; `None` if that is far away.
    pub value: Option<f64>,
}

/// Score test of the relaxation of viscoelastic bodies in a fit with elastic ones: whether the residuals are correlated with the force of a weak
/// term of relaxation, `F - ∫ exp(-(t - s)/tau) F(s) ds/tau` of the elastic force `F`, of the first order in the strength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateTest {
    /// Relaxation time of the most significant term of those tried, s.
    pub time: f64,
    /// Its strength after a linear step.
    pub strength: f64,
    /// Probability, if the data do not depend on the rate, of at least this correlation in any of the terms tried.
    pub p_value: f64,
}

impl RateTest {
    /// Whether the data depend on the rate.
    #[must_use]
    pub fn is_significant(&self) -> bool {
        self.p_value < LEVEL
    }

    /// Message to the user if the data depend on the rate.
    #[must_use]
    pub fn statement(&self) -> Option<String> {
        self.is_significant().then(|| {
            format!(
                "the forces depend on the rate (p = {}), and the bodies of the fit are elastic: its moduli are those of this test only; give [relaxation] in the case, and free its strengths and times, to begin with strengths = [{:.1}] and times = [\"{:.2} s\"]",
                probability(self.p_value),
                self.strength.max(0.1),
                self.time
            )
        })
    }
}

/// The force of a weak term of relaxation at every time (s): the forces minus their memory, in which they are linear in time between the rows.
pub(super) fn weak_relaxation(times: &[f64], forces: &[f64], time: f64) -> Vec<f64> {
    let mut memory = 0.0;
    let mut before: Option<[f64; 2]> = None;
    let rows = times.iter().zip(forces);
    rows.map(|(at, force)| {
        if let Some([start, from]) = before {
            let width = at - start;
            if width > 0.0 {
                let lag = (force - from) / width * time;
                memory = force - lag + (memory - from + lag) * (-width / time).exp();
            }
        }
        before = Some([*at, *force]);
        force - memory
    })
    .collect()
}

/// Decrease of the sum of squares when a column is added to a linear fit, and the corresponding step. Residuals and column are divided by
/// the errors and projected orthogonally to the free parameters. `None` if nothing remains of the column.
pub(super) struct Score {
    pub(super) gain: f64,
    pub(super) step: f64,
}

impl Score {
    /// `column` is the remainder, after the projection, of a column of norm `length`.
    pub(super) fn new(residuals: &[f64], column: &[f64], length: f64) -> Option<Self> {
        /// Relative remainder below which a column is explained by the free parameters: it is due to
        /// errors of the derivatives.
        const LEAST_LEFT: f64 = 1e-3;
        let square: f64 = column.iter().map(|value| value * value).sum();
        if !(length > 0.0 && square.sqrt() > LEAST_LEFT * length && square.is_finite()) {
            return None;
        }
        let along: f64 = residuals.iter().zip(column).map(|(r, c)| r * c).sum();
        Some(Self {
            gain: along * along / square,
            step: along / square,
        })
    }

    /// p-value: from chi-square with one degree of freedom if errors are known, or from Student's distribution if they are estimated from the
    /// residuals, with `freedom` degrees of freedom and `squares` the sum of squares.
    pub(super) fn p_value(&self, squares: f64, freedom: usize, is_estimated: bool) -> f64 {
        if !is_estimated {
            return erfc((0.5 * self.gain).sqrt());
        }
        let rest = freedom as f64 - 1.0;
        let variance = (squares - self.gain).max(0.0) / rest;
        if variance <= 0.0 {
            return 0.0;
        }
        let law = StudentsT::new(0.0, 1.0, rest);
        law.map_or(1.0, |law| 2.0 * law.sf((self.gain / variance).sqrt()))
    }
}

/// Whether the fit describes the data.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Misfit {
    /// Runs tests; residuals as small as the errors of the solver are not tested.
    pub runs: Vec<RunsTest>,
    /// Probability of a chi-square of at least this value; `None` if errors are estimated.
    pub chi_square_p_value: Option<f64>,
    /// Probability of a chi-square of at most this value.
    pub small_chi_square_p_value: Option<f64>,
    /// Fixed parameters, in order of increasing p-value.
    pub left_out: Vec<LeftOut>,
}

impl Misfit {
    fn level_of_residuals(&self) -> f64 {
        let tests = self.runs.len() + 2 * usize::from(self.chi_square_p_value.is_some());
        0.5 * LEVEL / tests.max(1) as f64
    }

    /// Runs tests that reject the fit.
    pub fn bad_runs(&self) -> impl Iterator<Item = &RunsTest> {
        let level = self.level_of_residuals();
        self.runs.iter().filter(move |runs| runs.p_value < level)
    }

    /// Whether chi-square is too large.
    #[must_use]
    pub fn is_chi_square_large(&self) -> bool {
        let level = self.level_of_residuals();
        self.chi_square_p_value.is_some_and(|p| p < level)
    }

    /// Whether chi-square is too small: then the given errors are too large.
    #[must_use]
    pub fn is_chi_square_small(&self) -> bool {
        let level = self.level_of_residuals();
        self.small_chi_square_p_value.is_some_and(|p| p < level)
    }

    /// Fixed parameters whose values the data reject, in order of increasing p-value.
    pub fn wanted(&self) -> impl Iterator<Item = &LeftOut> {
        let level = 0.5 * LEVEL / self.left_out.len().max(1) as f64;
        self.left_out
            .iter()
            .filter(move |left| left.p_value < level)
    }

    /// Whether no test rejects the fit.
    #[must_use]
    pub fn describes_data(&self) -> bool {
        self.bad_runs().next().is_none()
            && !self.is_chi_square_large()
            && self.wanted().next().is_none()
    }

    /// Message to the user if the fit does not describe the data.
    #[must_use]
    pub fn statement(&self, words: impl Fn(Parameter, f64) -> String) -> Option<String> {
        if self.describes_data() {
            return None;
        }
        let mut reasons: Vec<String> = self
            .bad_runs()
            .map(|test| {
                format!(
                    "residuals of the {} on {} have {} runs of one sign, where {:.0} are expected (p = {})",
                    test.quantity.name(),
                    test.branch.name(),
                    test.runs,
                    test.expected(),
                    probability(test.p_value)
                )
            })
            .collect();
        if let (true, Some(p)) = (self.is_chi_square_large(), self.chi_square_p_value) {
            reasons.push(format!(
                "chi-square is too large (p = {}): the given errors are too small, or the model is wrong",
                probability(p)
            ));
        }
        let wanted: Vec<String> = self
            .wanted()
            .map(|left| {
                let about = left.value.map_or(String::new(), |value| {
                    format!(", about {}", words(left.parameter, value))
                });
                format!(
                    "{} (p = {}{about})",
                    left.parameter.name(),
                    probability(left.p_value)
                )
            })
            .collect();
        match &wanted[..] {
            [] => reasons.push("no fixed parameter explains it".to_owned()),
            [one] => reasons.push(format!("fixed parameter most likely wrong: {one}")),
            [first, others @ ..] => {
                const MOST: usize = 2;
                let some: Vec<&str> = others.iter().take(MOST).map(|text| &text[..]).collect();
                reasons.push(format!(
                    "fixed parameters most likely wrong: {first}, or {}",
                    some.join(" or ")
                ));
            }
        }
        Some(format!(
            "the fit does not describe the data; its confidence intervals are not valid: {}",
            reasons.join("; ")
        ))
    }
}

/// Formats a probability with two digits.
fn probability(p: f64) -> String {
    if p < 1e-16 {
        "1e-16 or less".to_owned()
    } else if p < 1e-3 {
        format!("{p:.0e}")
    } else {
        let digits = if p < 1e-2 { 4 } else { 2 };
        format!("{p:.digits$}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_the_tables() {
        // F. S. Swed and C. Eisenhart, Ann. Math. Stat. 14, 66 (1943), table I: cumulative probabilities of the number
        // of runs.
        for (above, below, runs, p) in [
            (5, 5, 2, 0.008),
            (5, 5, 3, 0.040),
            (5, 5, 5, 0.357),
            (10, 10, 6, 0.019),
            (10, 10, 5, 0.004),
            (2, 20, 2, 0.009),
        ] {
            let found = probability_of_runs(above, below, runs);
            assert!(
                (found - p).abs() < 5.1e-4,
                "{above} {below} {runs}: {found}"
            );
        }
        // One positive and one negative sign have two orders, each with two runs; the probabilities of all
        // numbers of runs add up to one.
        assert!((probability_of_runs(1, 1, 2) - 1.0).abs() < 1e-12);
        assert!((probability_of_runs(70, 50, 120) - 1.0).abs() < 1e-10);
    }

    #[test]
    fn weak_relaxation_of_a_ramp_and_a_hold() {
        // A force v t up to T: its memory is v (t - tau (1 - exp(-t/tau))), and from T on the difference from v T decays with tau.
        let times: Vec<f64> = (0..40).map(|k| 0.5 * f64::from(k)).collect();
        let (speed, tau, end) = (2.0, 3.0, 8.0f64);
        let forces: Vec<f64> = times.iter().map(|t| speed * t.min(end)).collect();
        let found = weak_relaxation(&times, &forces, tau);
        for (t, found) in times.iter().zip(found) {
            let ramp = speed * tau * (1.0 - (-t.min(end) / tau).exp());
            let expected = ramp * (-(t - end).max(0.0) / tau).exp();
            assert!((found - expected).abs() < 1e-12, "{t}");
        }
    }

    #[test]
    fn runs_counted_one_by_one() {
        // All orders of 4 and 3 signs.
        let mut counts = [0usize; 8];
        for pattern in 0u32..128 {
            if pattern.count_ones() == 4 {
                let signs: Vec<f64> = (0..7)
                    .map(|bit| if pattern >> bit & 1 == 1 { 1.0 } else { -1.0 })
                    .collect();
                let test = RunsTest::new(Quantity::Force, Branch::Loading, &signs).unwrap();
                counts[test.runs] += 1;
            }
        }
        let mut sum = 0.0;
        for (runs, count) in counts.iter().enumerate() {
            sum += *count as f64 / 35.0;
            assert!((probability_of_runs(4, 3, runs) - sum).abs() < 1e-12);
        }
    }

    #[test]
    fn chi_squares_of_the_tables() {
        // NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.4: upper critical values.
        for (freedom, value, p) in [
            (1, 3.841, 0.05),
            (10, 18.307, 0.05),
            (10, 23.209, 0.01),
            (100, 149.449, 0.001),
        ] {
            assert!((chi_square_above(value, freedom) / p - 1.0).abs() < 2e-3);
            assert!((chi_square_below(value, freedom) + p - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn a_left_out_slope_by_hand() {
        // y = 0, 0, 3, 3 at x = 0 to 3, fitted by a constant alone: residuals -1.5, -1.5, 1.5, 1.5, the slope left out is x - 1.5. Then the slope is
        // 6/5, it lowers the sum of squares 9 by 36/5 to 9/5, and t of two degrees of freedom is sqrt(36/5/(9/10)) = sqrt(8), with
        // p = 1 - t/sqrt(2 + t^2) = 1 - sqrt(0.8).
        let residuals = [-1.5, -1.5, 1.5, 1.5];
        let score = Score::new(&residuals, &[-1.5, -0.5, 0.5, 1.5], 14f64.sqrt()).unwrap();
        assert!((score.step - 1.2).abs() < 1e-12 && (score.gain - 7.2).abs() < 1e-12);
        assert!((score.p_value(9.0, 3, true) - (1.0 - 0.8f64.sqrt())).abs() < 1e-10);
        // With unit errors known, chi-square of one degree of freedom: 1 - erf(sqrt(3.6)).
        assert!((score.p_value(9.0, 3, false) - 0.007_290_4).abs() < 1e-6);
    }
}
