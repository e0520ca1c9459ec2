//! The search for the smallest sum of squares by the method of Levenberg and Marquardt, for one curve or several together.

use super::error::FitError;
use super::least_squares::Linear;
use super::model::RangeEnd;
use fakir::numerics::convergence::{larger, within};
use fakir::state::{Run, SolveError, Termination};

/// Largest number of steps of a search.
const MOST_ITERATIONS: usize = 100;

/// The search ends if the step is smaller than this fraction of the standard error of every
/// parameter.
const SMALL: f64 = 1e-3;

/// The sum of squares has kinks where pillars come into contact, and its minimum may be at a kink. The search ends there if
/// the last step reduced the sum of squares by at most this amount and the condition of [`LITTLE_PROMISED`] is met too.
pub(super) const NO_GAIN: f64 = 1e-4;

/// At a kink, the reduction of the sum of squares predicted for the next step must be at most this amount, which is less
/// than a standard error.
const LITTLE_PROMISED: f64 = 0.5;

/// Reduction of the sum of squares, about a third of a standard error, that the interpolation of rows may hide.
pub(super) const INTERPOLATED: f64 = 0.1;

/// The same if the sum of squares was computed along the step too, from 1/1024 of it to all of it, and no part gains [`NO_GAIN`]: the reduction that one
/// standard error makes.
const MOST_TESTED: f64 = 1.0;

/// After this number of steps [`LITTLE_PROMISED`] alone ends the search, because jumps of the contact radius may move the
/// best fit back and forth. From then on, rows left out as past the transition remain left out.
pub(super) const PATIENCE: usize = 30;

/// The search also ends if the step in the unknowns is as small as the errors of the solver.
const EXACT: f64 = 1e-8;

/// Damping at the start.
const FIRST_DAMPING: f64 = 1e-3;

/// Largest damping; beyond it, steps are too short to have an effect.
const MOST_DAMPING: f64 = 1e8;

/// A sum of squares and its linear approximation at a set of unknowns.
pub(super) trait Descent {
    /// Computed states at a set of unknowns.
    type States;

    fn unknowns(&self) -> &[f64];
    /// Number of steps so far.
    fn iterations(&self) -> usize;
    fn count_iteration(&mut self);
    fn chi_square(&self) -> f64;
    /// Measured minus computed values, divided by the errors.
    fn weighted_residuals(&self) -> Vec<f64>;
    /// Derivatives of the computed values with respect to the unknowns, divided by the errors.
    fn weighted_derivatives(&self) -> Vec<Vec<f64>>;
    /// Decomposition of these derivatives.
    fn linear(&self) -> Option<&Linear>;
    /// A bound of the unknowns that a step would violate.
    fn left_by(&self, step: &[f64]) -> Option<RangeEnd>;
    /// Shortens the step to the largest allowed change of every parameter.
    fn bounded(&self, step: Vec<f64>) -> Vec<f64>;
    /// The unknowns after a step, within their ranges.
    fn moved(&self, step: &[f64]) -> Vec<f64>;
    fn states_at(&self, unknowns: &[f64]) -> Result<Self::States, FitError>;
    /// Whether states are interpolated, so that small changes of the sum of squares are uncertain.
    fn is_interpolated(&self) -> bool {
        false
    }
    /// Whether all rows used have computed states, and enough of them are before the transition.
    fn are_enough(&self, states: &Self::States) -> bool;
    /// Sum of squares at other states, without jumps of the contact radius.
    fn trial_chi_square(&self, states: &Self::States) -> f64;
    /// Predicted reduction of the sum of squares, from the derivatives.
    fn promised(&self, step: &[f64]) -> f64;
    fn accept(&mut self, unknowns: Vec<f64>, states: Self::States);
    /// Leaves out rows that have no state among these, unless too few would remain; returns whether rows have changed.
    fn leave_out(&mut self, states: &Self::States) -> Result<bool, FitError>;
    /// Selects the rows to be used; returns whether they have changed.
    fn select(&mut self) -> bool;
    fn check_enough(&self) -> Result<(), FitError>;
    /// Computes derivatives and errors at the unknowns.
    fn linearise(&mut self) -> Result<(), FitError>;

    fn covariance(&self) -> Vec<Vec<f64>> {
        self.linear().map_or(Vec::new(), Linear::covariance)
    }

    /// Damped step. Unknowns at a bound that the step would violate remain there, and equal works of adhesion move together: this gives the best fit
    /// within the ranges.
    fn step(&self, damping: f64) -> Vec<f64> {
        let weighted = self.weighted_residuals();
        let Some(linear) = self.linear() else {
            return vec![0.0; self.unknowns().len()];
        };
        let mut step = linear.step(&weighted, damping);
        let mut rows = self.weighted_derivatives();
        let mut equal = None;
        while let Some(end) = self.left_by(&step) {
            for row in &mut rows {
                match end {
                    RangeEnd::Of(number) => row[number] = 0.0,
                    RangeEnd::Equal([work, receding]) => {
                        row[work] += std::mem::take(&mut row[receding]);
                    }
                }
            }
            if let RangeEnd::Equal(both) = end {
                equal = Some(both);
            }
            let Some(linear) = Linear::new(&rows, step.len()) else {
                break;
            };
            step = linear.step(&weighted, damping);
            if let Some([work, receding]) = equal {
                step[receding] = step[work];
            }
        }
        step
    }

    /// Whether this is the best fit, after a step that reduced the sum of squares by `gain`.
    fn is_at_end(&self, gain: f64) -> bool {
        let covariance = self.covariance();
        let step = self.step(0.0);
        // A sum of squares that is not finite is not a minimum.
        if !within(self.chi_square(), f64::MAX) {
            return false;
        }
        let near = |(j, step): (usize, &f64)| {
            let deviation = larger(covariance[j][j], 0.0).sqrt();
            within(step.abs(), larger(EXACT, SMALL * deviation))
        };
        let at_kink = within(gain, NO_GAIN) || self.iterations() > PATIENCE;
        step.iter().enumerate().all(near)
            || at_kink && within(self.promised(&step), LITTLE_PROMISED)
    }

    /// Moves to the best fit.
    fn run(&mut self, run: &Run<'_>) -> Result<Termination, FitError> {
        let mut damping = FIRST_DAMPING;
        while self.iterations() < MOST_ITERATIONS {
            if run.cancel.is_cancelled() {
                return Err(SolveError::Interrupted.into());
            }
            self.count_iteration();
            let mut advanced = self.advance(&mut damping)?;
            if advanced.is_none() {
                if self.is_at_end(0.0) {
                    return Ok(Termination::Converged);
                }
                advanced = self.advance_undamped(&mut damping)?;
            }
            let Some(gain) = advanced else {
                return Ok(match within(self.promised(&self.step(0.0)), MOST_TESTED) {
                    true => Termination::Converged,
                    false => Termination::Stagnated,
                });
            };
            let rows_changed = self.select();
            self.check_enough()?;
            self.linearise()?;
            if !rows_changed && self.is_at_end(gain) {
                return Ok(Termination::Converged);
            }
        }
        Ok(Termination::IterationLimit)
    }

    /// Moves along a part of the undamped step and returns the reduction of the sum of squares; `None` if there is none. Damped steps follow the row with the
    /// steepest derivative. If the curve is linear over a tiny change only, as beside the end of an attached lens, they stop although all other
    /// rows agree on a step.
    fn advance_undamped(&mut self, damping: &mut f64) -> Result<Option<f64>, FitError> {
        /// Number of halvings of the step.
        const HALVINGS: i32 = 10;
        let whole = self.bounded(self.step(0.0));
        let now = self.chi_square();
        for halvings in 0..=HALVINGS {
            let part = 0.5f64.powi(halvings);
            let step: Vec<f64> = whole.iter().map(|step| part * step).collect();
            let trial = self.moved(&step);
            match self.states_at(&trial) {
                Ok(states) if self.are_enough(&states) => {
                    let gain = now - self.trial_chi_square(&states);
                    if gain > NO_GAIN {
                        self.accept(trial, states);
                        *damping = FIRST_DAMPING;
                        return Ok(Some(gain));
                    }
                }
                Err(error) if error.is_interruption() => return Err(error),
                _ => {}
            }
        }
        Ok(None)
    }

    /// Moves to unknowns that fit better and returns the reduction of the sum of squares; `None` if none are found. A step that leads outside
    /// the model is shortened; if that does not help, the rows outside the model are left out.
    fn advance(&mut self, damping: &mut f64) -> Result<Option<f64>, FitError> {
        /// Number of times a step is shortened before rows are left out.
        const SHORTER: i32 = 4;
        let mut now = self.chi_square();
        let mut outside = 0;
        while *damping <= MOST_DAMPING {
            let step = self.bounded(self.step(*damping));
            // Smaller gains are uncertain by the interpolation; the steps after the search continue with solved rows.
            if self.is_interpolated() && within(self.promised(&step), NO_GAIN) {
                return Ok(None);
            }
            let trial = self.moved(&step);
            let step: Vec<f64> = trial
                .iter()
                .zip(self.unknowns())
                .map(|(a, b)| a - b)
                .collect();
            match self.states_at(&trial) {
                Ok(states) if self.are_enough(&states) => {
                    let squares = self.trial_chi_square(&states);
                    // Near the end, interpolation errors may exceed the gain.
                    let promised = self.promised(&step);
                    let is_near = self.is_interpolated() && within(promised, INTERPOLATED);
                    let noise = if is_near { INTERPOLATED } else { 0.0 };
                    if squares <= now + noise {
                        // Ratio of the actual to the predicted reduction. A small ratio means that the linear
                        // prediction fails over the length of the step, and that the next step should be shorter.
                        let kept = (now - squares) / promised;
                        self.accept(trial, states);
                        *damping = match kept {
                            kept if kept > 0.75 => (*damping * 0.1).max(1e-12),
                            kept if kept > 0.25 => *damping,
                            _ => *damping * 10.0,
                        };
                        return Ok(Some(now - squares));
                    }
                }
                Err(error) if error.is_interruption() => return Err(error),
                // The step was too long: it led to an invalid case or a case without contact.
                Err(_) => {}
                Ok(states) => {
                    outside += 1;
                    if outside > SHORTER && self.leave_out(&states)? {
                        (now, outside) = (self.chi_square(), 0);
                        *damping *= 0.1f64.powi(SHORTER);
                    }
                }
            }
            *damping *= 10.0;
        }
        Ok(None)
    }
}
