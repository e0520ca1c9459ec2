//! Linear viscoelasticity: relaxation and creep of a Prony series.

use super::quantity::Requirement;
use std::fmt;

/// Bisection steps for a retardation time: more than the digits of a double.
const HALVINGS: usize = 200;

/// A term of a Prony series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelaxationTerm {
    /// Modulus of the term relative to the relaxed modulus.
    pub strength: f64,
    /// Relaxation time, s.
    pub time: f64,
}

/// Why a relaxation function is invalid.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum InvalidRelaxation {
    /// There are no terms.
    Empty,
    /// The numbers of strengths and times differ.
    Lengths {
        /// Number of strengths.
        strengths: usize,
        /// Number of times.
        times: usize,
    },
    /// A strength that is not positive.
    Strength(f64),
    /// A time that is not positive, s.
    Time(f64),
}

impl fmt::Display for InvalidRelaxation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let positive = Requirement::Positive;
        match self {
            Self::Empty => f.write_str("a relaxation function needs at least one term"),
            Self::Lengths { strengths, times } => write!(
                f,
                "{strengths} strengths and {times} times: every term needs both"
            ),
            Self::Strength(value) => {
                write!(f, "invalid strength {value}: it must be {positive}")
            }
            Self::Time(value) => write!(f, "invalid time {value} s: it must be {positive}"),
        }
    }
}

impl std::error::Error for InvalidRelaxation {}

/// The relaxation function of all elastic bodies of a contact, a Prony series:
/// `E(t) = E (1 + sum g_k exp(-t/tau_k))`, where `E` is the relaxed modulus and Poisson's ratio is constant.
///
/// ```
/// use fakir::problem::Relaxation;
///
/// let relaxation = Relaxation::new(&[1.0], &[10.0])?;
/// assert_eq!(relaxation.instantaneous(), 2.0);
/// let creep = relaxation.creep();
/// // The retardation time of a single term is (1 + g) tau.
/// assert!((creep.terms()[0].time - 20.0).abs() < 1e-12);
/// assert!((creep.at(0.0) - 0.5).abs() < 1e-15);
/// # Ok::<(), fakir::problem::InvalidRelaxation>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxation {
    terms: Vec<RelaxationTerm>,
}

impl Relaxation {
    /// Terms with these strengths, relative to the relaxed modulus, and times (s).
    ///
    /// # Errors
    /// [`InvalidRelaxation`]: no terms, different numbers of strengths and times, or values that are not positive and finite.
    pub fn new(strengths: &[f64], times: &[f64]) -> Result<Self, InvalidRelaxation> {
        if strengths.len() != times.len() {
            return Err(InvalidRelaxation::Lengths {
                strengths: strengths.len(),
                times: times.len(),
            });
        }
        if strengths.is_empty() {
            return Err(InvalidRelaxation::Empty);
        }
        let positive = |value: f64| value > 0.0 && value.is_finite();
        if let Some(strength) = strengths.iter().find(|value| !positive(**value)) {
            return Err(InvalidRelaxation::Strength(*strength));
        }
        if let Some(time) = times.iter().find(|value| !positive(**value)) {
            return Err(InvalidRelaxation::Time(*time));
        }
        let mut terms: Vec<RelaxationTerm> = strengths
            .iter()
            .zip(times)
            .map(|(strength, time)| RelaxationTerm {
                strength: *strength,
                time: *time,
            })
            .collect();
        terms.sort_by(|one, other| one.time.total_cmp(&other.time));
        Ok(Self { terms })
    }

    /// The terms by increasing time. Terms of equal times are kept apart.
    #[must_use]
    pub fn terms(&self) -> &[RelaxationTerm] {
        &self.terms
    }

    /// The modulus at a time (s) after a step, relative to the relaxed modulus.
    #[must_use]
    pub fn at(&self, time: f64) -> f64 {
        let terms = self.terms.iter();
        1.0 + terms
            .map(|term| term.strength * (-time.max(0.0) / term.time).exp())
            .sum::<f64>()
    }

    /// The instantaneous modulus relative to the relaxed one.
    #[must_use]
    pub fn instantaneous(&self) -> f64 {
        1.0 + self.terms.iter().map(|term| term.strength).sum::<f64>()
    }

    /// The longest relaxation time, s.
    #[must_use]
    pub fn longest_time(&self) -> f64 {
        self.terms.last().map_or(0.0, |term| term.time)
    }

    /// The shortest relaxation time, s.
    #[must_use]
    pub fn shortest_time(&self) -> f64 {
        self.terms.first().map_or(0.0, |term| term.time)
    }

    /// The terms with those of equal times joined.
    pub(crate) fn distinct(&self) -> Vec<RelaxationTerm> {
        // In order of time, so that a time that is not larger is equal.
        let mut joined: Vec<RelaxationTerm> = Vec::with_capacity(self.terms.len());
        for term in &self.terms {
            match joined.last_mut() {
                Some(last) if last.time >= term.time => last.strength += term.strength,
                _ => joined.push(*term),
            }
        }
        joined
    }

    /// The creep function, exact: `J(s) E(s) = 1/s^2` in Laplace space, so that its retardation times are the zeros of `s E(s)`. Each lies
    /// between two relaxation times, and the last beyond all of them.
    #[must_use]
    pub fn creep(&self) -> Creep {
        let terms = self.distinct();
        // s E(s) at s = -1/time. It increases from minus infinity to plus infinity between two relaxation times.
        let modulus = |time: f64| {
            let lost = |term: &RelaxationTerm| term.strength * term.time / (time - term.time);
            1.0 - terms.iter().map(lost).sum::<f64>()
        };
        let spread: f64 = terms.iter().map(|term| term.strength * term.time).sum();
        let creeping = terms.iter().enumerate().map(|(place, term)| {
            let mut low = term.time;
            let mut high = match terms.get(place + 1) {
                Some(next) => next.time,
                None => 2.0 * (term.time + spread),
            };
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if !(middle > low && middle < high) {
                    break;
                }
                if modulus(middle) < 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let time = 0.5 * (low + high);
            let slope: f64 = terms
                .iter()
                .map(|term| term.strength * term.time * (time / (time - term.time)).powi(2))
                .sum();
            RelaxationTerm {
                strength: time / slope,
                time,
            }
        });
        Creep {
            instantaneous: 1.0 / self.instantaneous(),
            terms: creeping.collect(),
        }
    }
}

/// The creep function that belongs to a [`Relaxation`], relative to the relaxed compliance:
/// `J(t) = J_0 + sum J_k (1 - exp(-t/theta_k))`, with `J = 1` after a long time.
#[derive(Debug, Clone, PartialEq)]
pub struct Creep {
    instantaneous: f64,
    terms: Vec<RelaxationTerm>,
}

impl Creep {
    /// The terms by increasing retardation time (s).
    #[must_use]
    pub fn terms(&self) -> &[RelaxationTerm] {
        &self.terms
    }

    /// The compliance at once after a step, relative to the relaxed one.
    #[must_use]
    pub fn instantaneous(&self) -> f64 {
        self.instantaneous
    }

    /// The longest retardation time, s.
    #[must_use]
    pub fn longest_time(&self) -> f64 {
        self.terms.last().map_or(0.0, |term| term.time)
    }

    /// The compliance at a time (s) after a step, relative to the relaxed one.
    #[must_use]
    pub fn at(&self, time: f64) -> f64 {
        // From the relaxed value, which it approaches: exact for long times.
        let missing = |term: &RelaxationTerm| term.strength * (-time.max(0.0) / term.time).exp();
        1.0 - self.terms.iter().map(missing).sum::<f64>()
    }

    /// The time (s) at which the compliance reaches a value relative to the relaxed compliance; `None` for values of 1 and more, which
    /// are never reached. It is 0 for values up to the instantaneous one.
    #[must_use]
    pub fn time_to(&self, value: f64) -> Option<f64> {
        if value.is_nan() || value >= 1.0 {
            return None;
        }
        if value <= self.at(0.0) {
            return Some(0.0);
        }
        let missing = |time: f64| {
            let terms = self.terms.iter();
            terms
                .map(|term| term.strength * (-time / term.time).exp())
                .sum::<f64>()
        };
        let wanted = 1.0 - value;
        let (mut low, mut high) = (0.0, self.longest_time());
        while missing(high) > wanted && high.is_finite() {
            high *= 2.0;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if !(middle > low && middle < high) {
                break;
            }
            if missing(middle) > wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(0.5 * (low + high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn several() -> Relaxation {
        Relaxation::new(&[0.5, 3.0, 0.2, 1.0], &[2.0, 0.1, 400.0, 30.0]).unwrap()
    }

    /// Expected: `∫_0^t J(t - s) E(s) ds = t`, by Gauss-Legendre quadrature on short intervals.
    #[test]
    fn creep_is_the_inverse_of_relaxation() {
        let relaxation = several();
        let creep = relaxation.creep();
        assert_eq!(creep.terms().len(), 4);
        for time in [0.01, 1.0, 30.0, 1000.0] {
            // Nodes dense at both ends, where one of the factors changes fast.
            let steps = 4000;
            let mut sum = 0.0;
            let place = |k: usize| {
                let x = k as f64 / steps as f64;
                time * (0.5 - 0.5 * (std::f64::consts::PI * x).cos())
            };
            for k in 0..steps {
                let (a, b) = (place(k), place(k + 1));
                for node in [-1.0, 1.0] {
                    let s = 0.5 * (a + b) + 0.5 * (b - a) * node / 3.0f64.sqrt();
                    sum += 0.5 * (b - a) * creep.at(time - s) * relaxation.at(s);
                }
            }
            assert!((sum / time - 1.0).abs() < 1e-9, "{time} {sum}");
        }
    }

    /// Expected: the standard linear solid, `J = 1 - g/(1 + g) exp(-t/((1 + g) tau))`.
    #[test]
    fn creep_of_one_term() {
        let creep = Relaxation::new(&[1.0], &[10.0]).unwrap().creep();
        for time in [0.0, 5.0, 100.0] {
            let expected = 1.0 - 0.5 * (-time / 20.0f64).exp();
            assert!((creep.at(time) - expected).abs() < 1e-14);
        }
        let reached = creep.time_to(1.0 / 1.2).unwrap();
        assert!((reached / (20.0 * 3.0f64.ln()) - 1.0).abs() < 1e-14);
        assert_eq!(creep.time_to(0.4), Some(0.0));
        assert_eq!(creep.time_to(1.0), None);
        assert_eq!(creep.time_to(f64::NAN), None);
    }

    /// Equal times are one term of the sum of their strengths.
    #[test]
    fn equal_times_are_joined() {
        let two = Relaxation::new(&[0.25, 0.75], &[10.0, 10.0]).unwrap();
        let one = Relaxation::new(&[1.0], &[10.0]).unwrap();
        assert_eq!(two.creep(), one.creep());
    }

    #[test]
    fn invalid_terms_are_refused() {
        assert!(Relaxation::new(&[], &[]).is_err());
        assert!(Relaxation::new(&[1.0], &[]).is_err());
        for odd in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Relaxation::new(&[odd], &[1.0]).is_err());
            assert!(Relaxation::new(&[1.0], &[odd]).is_err());
        }
    }
}
