//! Moduli, sizes, works of adhesion and instrument parameters from measured curves, by least squares.
//!
//! The data contain at least two of position (displacement or indentation), force and contact radius: see [`Measurements`]. If the
//! position is measured it is the load, and force and contact radius are compared with the contact at the indentation `zeta =
//! displacement - contact_point - machine_compliance F`; otherwise the force is the load. A `force_offset` is included in all
//! measured forces. Displacement and force may drift, linearly in time or in the row number. States past the transition are used if
//! the method includes the floor: with the spectral method, unless the case ignores the floor. Otherwise they are left out.
//!
//! With adhesion all rows belong to one [cycle](fakir::cycle) of loading and unloading, up to the largest measured load, and each row
//! has a branch. The cycle is driven by a machine with the fitted compliance.
//!
//! If the case has a [relaxation](fakir_case::CaseRelaxation) and all rows have a time, the rows are the history of viscoelastic bodies. Between rows
//! the indentation is linear in time; before the first row there was no contact. All states follow from one elastic loading curve, which scales with
//! the moduli ([`measured_history`](fakir::solve::viscoelastic::measured_history)); strengths and relaxation times can be fitted too.
//!
//! # Method
//! The sum of squares of (measured - computed)/error is minimised by the method of Levenberg and Marquardt (K. Levenberg, Q. Appl. Math. 2, 164 (1944); D. W. Marquardt, J.
//! SIAM 11, 431 (1963)), over the logarithms of moduli, sizes and works of adhesion (near zero, over the work itself). Derivatives of the contact are exact, or central
//! differences if there are none (adhesion, contact radius, other methods). Errors are updated in every step:
//!
//! * An error of the load is included through the slope of the curve, `sigma^2 + (slope sigma_x)^2` (J.
//!   Orear, Am. J. Phys. 50, 912 (1982)); the correlation that it causes between force and contact radius
//!   of a row is neglected.
//! * A quantity without given errors has the same error in all rows, chosen so that its sum of
//!   squares equals its degrees of freedom: the number of values minus their leverages.
//! * The contact radius jumps from one ring of pillars to the next. The rings of a hexagonal lattice are
//!   at most about half a pitch apart beyond the first; therefore a measured radius has an error of at
//!   least `(e/2)/sqrt(12)` (uniform over half the pitch `e`), added in quadrature. A jump has no
//!   derivative. Instead, the derivative of the radius of gyration of the pillar forces is used, which
//!   affects the weights of the data but not the result for data without errors.
//! * With adhesion the force jumps where pillars detach, and between jumps it hardly depends on the work of adhesion. The data show only between which rows a jump occurs.
//!   Therefore a row of the unloading is compared with the straight line through the interval of the computed curve between its neighbouring rows. The mean square deviation of the
//!   curve from that line, averaged over the neighbouring rows and multiplied by the number of rows that share the interval, is added to the square of the error. The search starts
//!   with the work of adhesion whose pull-off force is the smallest measured force, and with longer intervals, in which jumps that are far from their position have an effect.
//!
//! Beyond a number of rows, the contact is solved at few loads only and interpolated between them; [`Scatter::interpolation_error`] is the
//! estimated error of that.
//!
//! # Errors of the result
//! The covariance is the inverse of the normal matrix. The 95 % intervals follow from the normal distribution if all errors were given, otherwise from
//! Student's distribution, whose degrees of freedom are the number of values minus that of parameters; intervals of logarithms are symmetric in the
//! logarithm. A work of adhesion may be zero, and the receding work may equal the other: the search stops at these bounds. An interval that would extend
//! below zero ends at zero and is one-sided: at its upper end the sum of squares has increased by the square of the quantile. A parameter is not determined
//! if the derivatives are linearly dependent or the error exceeds a factor of e (for a contact point or compliance: the range of the data). It has no
//! interval and is reported as [`Undetermined`].
//!
//! # Whether the fit describes the data
//! [`Misfit`] contains tests with p-values: runs of residuals of one sign in the order of the load; chi-square, if errors were given; and for every
//! fixed parameter the score test, which shows whether the residuals are correlated with its effect. With estimated errors this is the t-test of an
//! added column in a linear regression. For the thickness of a half-space the test is one-sided, in the inverse of the thickness, which cannot be
//! negative. Rows whose error is mainly due to jumps are correlated and have no runs test.
//!
//! If an elastic fit has forces at known times, [`RateTest`] is the same score test of a weak relaxation, with five relaxation times from the duration
//! of the data to a hundredth of it. It is exact to the first order in the strength while the contact grows.

mod attachment;
mod cells;
mod column;
mod curve;
mod curves;
mod curves_report;
mod descent;
mod error;
pub mod friction;
mod heading;
mod joint;
mod joint_report;
mod layout;
mod least_squares;
mod measurements;
mod misfit;
mod model;
mod options;
mod orientation;
mod over_time;
mod parameter;
mod radius;
mod reading;
mod report;
mod sampled;
mod segments;
mod selection;
mod statistics;
mod subject;
mod table;
mod units;

pub use column::{Column, DataError};
pub use curves::{CurveFit, CurveFits, FittedData, MeasuredCurve, fit_curves};
pub use curves_report::CurvesSummary;
pub use error::FitError;
pub use joint::{Agreement, JointFit, fit_jointly, shared_by_default};
pub use joint_report::JointSummary;
pub use layout::{Hints, Layout, NamedColumn, ReadColumn, SkipReason, Skipped};
pub use measurements::{Measured, Measurement, Measurements, Position, Quantity};
pub use misfit::{LEVEL, LeftOut, Misfit, RateTest, RunsTest};
pub use options::{FitOptions, MOST_STARTS};
pub use parameter::Parameter;
pub use report::FitSummary;
pub use selection::Selection;
pub use statistics::{
    FEWEST_FOR_OUTLIERS, OUTLIER_SCORE, Outlier, Sample, Statistics, WeightedMean,
};
pub use subject::{FittedCycle, has_relaxation, method_name};

use descent::{Descent, INTERPOLATED, NO_GAIN, PATIENCE};
use fakir::numerics::convergence::{larger, within};
use fakir::numerics::roots::{self, Point};
use fakir::problem::{Feature, Question, Solver};
use fakir::state::{Branch, Limit, Run, SolveError, Termination};
use fakir_case::{CaseFile, Key, SurfaceKind};
use least_squares::Linear;
use misfit::Score;
use model::{Derivatives, Model, RangeEnd, State};
use sampled::{Purpose, Sampled, Tolerance};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use std::borrow::Cow;
use std::cell::{Cell as StdCell, OnceCell};
use std::collections::BTreeSet;
use std::convert::Infallible;
use std::sync::Arc;
use table::Table;

/// A fitted parameter, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// The parameter.
    pub parameter: Parameter,
    /// Initial value.
    pub start: f64,
    /// Value; not meaningful if the parameter is not determined.
    pub value: f64,
    /// Standard error; `None` if the data do not determine it.
    pub standard_error: Option<f64>,
    /// Ends of the 95 % confidence interval; `None` if the data do not determine it.
    pub interval: Option<[f64; 2]>,
    /// Whether the interval ends at the smallest possible value of the parameter, so that the data determine only the upper end: for a work of
    /// adhesion that is compatible with zero.
    pub one_sided: bool,
}

/// Parameters that the data cannot distinguish, or a parameter that does not affect them.
#[derive(Debug, Clone, PartialEq)]
pub struct Undetermined {
    /// The parameters.
    pub parameters: Vec<Parameter>,
    /// Message to the user.
    pub statement: String,
}

/// The error of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scatter {
    /// The quantity.
    pub quantity: Quantity,
    /// Number of values used.
    pub values: usize,
    /// Root mean square of measured - computed.
    pub residual: f64,
    /// Standard error of a value, estimated from the residuals; `None` if errors were given.
    pub estimated: Option<f64>,
    /// Estimated interpolation error: the largest one of the force, N, or the root mean square of that of the contact radius, m. `None` if all
    /// rows were solved.
    pub interpolation_error: Option<f64>,
}

/// A measured value and the corresponding computed value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compared {
    /// The measured value.
    pub measured: f64,
    /// Computed value, as the instrument would read it. A force on unloading with adhesion is the value of the straight line through the interval
    /// of the curve between the neighbouring rows.
    pub computed: f64,
    /// Standard error used in the fit: given or estimated, including the errors due to the load and
    /// to jumps.
    pub error: f64,
}

impl Compared {
    /// Measured minus computed.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.measured - self.computed
    }
}

/// A row of the data with computed values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedRow {
    /// Measured values.
    pub measurement: Measurement,
    /// Branch of the cycle or of the history of viscoelastic bodies; otherwise `None`.
    pub branch: Option<Branch>,
    /// Computed indentation, m.
    pub indentation: f64,
    /// Force, N, unless it is the load.
    pub force: Option<Compared>,
    /// Contact radius, m.
    pub contact_radius: Option<Compared>,
    /// Smallest gap between lens and floor, m; negative past the transition if floor contact is ignored. It is not computed with
    /// adhesion.
    pub smallest_floor_gap: Option<f64>,
    /// Whether the row was used in the fit. It is not used past the transition if floor contact is ignored or with adhesion, nor if the state is
    /// outside the model.
    pub used: bool,
    /// Whether the model has this state; otherwise there are no computed values, and [`Fit::not_modelled`] contains
    /// the reason.
    pub modelled: bool,
    /// Whether the contact was solved, and its numbers are resolved.
    pub converged: bool,
}

impl FittedRow {
    /// Measured and computed value of a quantity, if it was measured.
    #[must_use]
    pub fn compared(&self, quantity: Quantity) -> Option<Compared> {
        match quantity {
            Quantity::Force => self.force,
            Quantity::ContactRadius => self.contact_radius,
        }
    }
}

/// A point of a computed curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// Branch of the cycle or of the history of viscoelastic bodies; otherwise `None`.
    pub branch: Option<Branch>,
    /// Displacement or indentation, m; the force, N, if that is the load.
    pub load: f64,
    /// Computed force plus the offset of the instrument, N.
    pub force: f64,
    /// The computed contact radius, m.
    pub contact_radius: f64,
}

/// Pull-off of the data and of the fitted cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedPullOff {
    /// Smallest measured force minus the offset of the instrument, N.
    pub measured: f64,
    /// Pull-off force of the fitted cycle, N.
    pub computed: f64,
    /// Relative model error of this force, which the intervals do not include: errors due to the shapes of partial contacts and to columns that do not
    /// tilt.
    pub model_error: f64,
    /// Relative change of the work of adhesion that corresponds to this error of the pull-off force; `None` if no work of adhesion
    /// was fitted.
    pub work_error: Option<f64>,
}

/// A search for the best fit, from one of several starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartedFit {
    /// Whether the search converged to a valid case.
    pub converged: bool,
    /// Twice the negative logarithm of the likelihood per value; the smallest is the best.
    pub deviance: Option<f64>,
    /// Whether it converged to the fit that is returned.
    pub is_answer: bool,
}

/// Result of a fit.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Parameters, in the order in which they were given.
    pub estimates: Vec<Estimate>,
    /// Correlation matrix; `None` for parameters that are not determined.
    pub correlation: Vec<Vec<Option<f64>>>,
    /// Parameters that the data do not determine.
    pub undetermined: Vec<Undetermined>,
    /// Sum of squares of (measured - computed)/error.
    pub chi_square: f64,
    /// Number of values minus number of parameters.
    pub degrees_of_freedom: usize,
    /// Quantities compared.
    pub scatter: Vec<Scatter>,
    /// The data with the computed values.
    pub rows: Vec<FittedRow>,
    /// The computed curve over the range of the data, for a figure.
    pub curve: Vec<CurvePoint>,
    /// Contact point, m, fitted or given.
    pub contact_point: f64,
    /// Machine compliance, m/N, fitted or given.
    pub machine_compliance: f64,
    /// Offset of the measured forces, N, fitted or given.
    pub force_offset: f64,
    /// Drift of the displacement (m) and of the force (N) from the first row to the last, fitted or given.
    pub displacement_drift: f64,
    /// Drift of the force, N.
    pub force_drift: f64,
    /// Slope of the reading without any force over the displacement from the first row on, N/m.
    pub force_slope: f64,
    /// Time of every row, from 0 at the first to 1 at the last; drifts are linear in it.
    pub moments: Vec<f64>,
    /// Whether the fit describes the data.
    pub misfit: Misfit,
    /// Whether forces at known times depend on the rate, in a fit with elastic bodies; `None` without times, and with adhesion.
    pub rate: Option<RateTest>,
    /// Searches; the first one starts from the case.
    pub starts: Vec<StartedFit>,
    /// Number of contacts, gradients and cycles solved.
    pub solutions: usize,
    /// Cycle with the fitted values; `None` without adhesion.
    pub cycle: Option<FittedCycle>,
    /// Name of the method: `spectral`, or `flat` on a flat surface.
    pub method: &'static str,
    /// Pull-off of this cycle and of the data; `None` without unloading.
    pub pull_off: Option<FittedPullOff>,
    /// Whether the rows are the history of viscoelastic bodies.
    pub is_viscoelastic: bool,
    /// Line of the first row if the data contain no loading: the unloading is then assumed to begin there.
    pub assumed_unloading_point: Option<u64>,
    /// Whether the data have contact radii that were left out: on rounded tops and height maps, where they jump.
    pub radii_left_out: bool,
    /// The case with the fitted values.
    pub file: CaseFile,
    /// Limits of the model in the contact under the largest load used, with the fitted values; `None` without such a contact.
    pub limits: Vec<Limit>,
    /// Rows outside the model, by their lines, each with the reason.
    pub not_modelled: Vec<(u64, String)>,
    /// Why the search stopped.
    pub termination: Termination,
    /// Number of steps of the search.
    pub iterations: usize,
}

impl Fit {
    /// Whether the result is a best fit: the search converged, and every contact compared is
    /// solved.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.termination == Termination::Converged && self.rows.iter().all(|row| row.converged)
    }

    /// Rows left out because they are past the transition and the method or the case ignores the floor.
    pub fn past_transition(&self) -> impl Iterator<Item = &FittedRow> {
        self.rows.iter().filter(|row| row.modelled && !row.used)
    }

    /// Whether an error was estimated, so that intervals follow Student's distribution.
    #[must_use]
    pub fn is_scatter_estimated(&self) -> bool {
        self.scatter
            .iter()
            .any(|scatter| scatter.estimated.is_some())
    }

    /// Chi-square per degree of freedom: about 1 if the model fits. `None` if errors are estimated,
    /// which would make it 1.
    #[must_use]
    pub fn reduced_chi_square(&self) -> Option<f64> {
        let meant = !self.is_scatter_estimated() && self.degrees_of_freedom > 0;
        meant.then(|| self.chi_square / self.degrees_of_freedom as f64)
    }
}

/// Smallest estimated error of a quantity, relative to its largest value: the error of the solver.
const LEAST_SCATTER: f64 = 1e-9;

/// Fits whose deviances per value differ by at most this amount are considered equal.
const SAME_DEVIANCE: f64 = 1e-4;

/// Residuals below this fraction of the largest value are attributed to the solver.
const SOLVED: f64 = 1e-5;

/// Largest fraction of the variance of a value in a runs test that may be due to jumps.
const JUMPS: f64 = 0.1;

/// Number of points of the computed curve.
const CURVE: usize = 61;

/// Shortest averaging intervals of a curve with adhesion, as fractions of the range of the loads, used one after the other.
const STRETCHES: [f64; 2] = [0.125, 0.05];

/// Fits the free parameters to the data. Other parameters, and the initial values, are those of the
/// case file. The threads of `run` share the rows.
///
/// # Errors
/// See [`FitError`]. A parameter that the data do not determine is not an error: see [`Fit`].
pub fn fit(
    file: &CaseFile,
    data: &Measurements,
    free: &[Parameter],
    options: &FitOptions,
    run: &Run<'_>,
) -> Result<Fit, FitError> {
    let fitted = fit_with(file, data, free, options, run, sampled::DIRECT);
    fitted.map_err(|error| error.within(data.name()))
}

/// [`fit`] in which up to `direct` rows are solved in every step.
fn fit_with(
    file: &CaseFile,
    data: &Measurements,
    free: &[Parameter],
    options: &FitOptions,
    run: &Run<'_>,
    direct: usize,
) -> Result<Fit, FitError> {
    file.check_surface(&[Question::Fit])?;
    // Those of the program's own tables, and of instruments that measure both.
    let leaves_radii = radii_jump(file) && data.position() != Position::None && data.has_radii();
    let data = &match leaves_radii {
        true => Cow::Owned(data.without_radii()),
        false => Cow::Borrowed(data),
    };
    check(file, data, free, options)?;
    let model = Model::new(file, data, free, options, run)?;
    let (search, termination, starts) = model.best(options, run, direct)?;
    let mut fitted = search.answer(termination)?;
    fitted.starts = starts;
    fitted.radii_left_out = leaves_radii;
    Ok(fitted)
}

/// Smallest number of starts with a free contact point and a free slope of the force, and on a flat surface if the first search does not converge.
const MORE_STARTS: usize = 4;

impl<'a> Model<'a> {
    /// Runs a search from each start; returns the best one and all starts.
    fn best<'m>(
        &'m self,
        options: &FitOptions,
        run: &Run<'_>,
        direct: usize,
    ) -> Result<(Search<'m>, Termination, Vec<StartedFit>), FitError>
    where
        'a: 'm,
    {
        let begin = self.start()?;
        let (mut search, mut termination) = self.search(begin.clone(), run, direct)?;
        let mut starts = vec![search.started(termination)];
        let mut answer = 0;
        // A tilted base line and the first part of the contact look alike, so that one start often ends in a wrong one of the two.
        let is_tilted = [Parameter::ContactPoint, Parameter::ForceSlope]
            .iter()
            .all(|parameter| self.free.contains(parameter));
        // On a flat surface a search takes a second.
        let is_stuck = self.is_flat() && termination != Termination::Converged;
        let least = if is_tilted || is_stuck {
            MORE_STARTS
        } else {
            1
        };
        for number in 1..options.starts.max(least) {
            match self.search(self.other_start(&begin, number), run, direct) {
                Ok((other, ended)) => {
                    let started = other.started(ended);
                    let best = starts[answer];
                    let is_better = match (started.deviance, best.deviance) {
                        (Some(one), Some(two)) => one < two - SAME_DEVIANCE,
                        (one, _) => one.is_some(),
                    };
                    if (started.converged, is_better) > (best.converged, false) {
                        (search, termination, answer) = (other, ended, number);
                    }
                    starts.push(started);
                }
                Err(error) if error.is_interruption() => return Err(error),
                // It started from an invalid case or from a case without a contact.
                Err(_) => starts.push(StartedFit {
                    converged: false,
                    deviance: None,
                    is_answer: false,
                }),
            }
        }
        let best = starts[answer].deviance;
        for started in &mut starts {
            started.is_answer = match (started.deviance, best) {
                (Some(one), Some(two)) => within((one - two).abs(), SAME_DEVIANCE),
                _ => false,
            };
        }
        starts[answer].is_answer = true;
        Ok((search, termination, starts))
    }

    /// Runs a search from the given unknowns to its end.
    fn search<'m>(
        &'m self,
        unknowns: Vec<f64>,
        run: &Run<'_>,
        direct: usize,
    ) -> Result<(Search<'m>, Termination), FitError>
    where
        'a: 'm,
    {
        let stages = if self.is_adhesive && !self.is_flat() {
            &STRETCHES[..]
        } else {
            &[0.0]
        };
        let mut search = Search::new(self, unknowns, stages[0], direct)?;
        let mut termination = search.run(run)?;
        for stretch in &stages[1..] {
            search.restart(*stretch)?;
            termination = search.run(run)?;
        }
        search.finish()?;
        Ok((search, termination))
    }
}

/// Whether contact radii jump from one top to the next by more than a pitch accounts for.
fn radii_jump(file: &CaseFile) -> bool {
    matches!(
        file.surface_kind(),
        SurfaceKind::Asperities | SurfaceKind::HeightMap
    )
}

fn check(
    file: &CaseFile,
    data: &Measurements,
    free: &[Parameter],
    options: &FitOptions,
) -> Result<(), FitError> {
    data.check_errors()?;
    data.check_branches()?;
    if radii_jump(file) && data.has_radii() {
        return Err(FitError::RadiusOfTops(data.name().to_owned()));
    }
    if free.is_empty() {
        return Err(FitError::NothingFree);
    }
    for (number, parameter) in free.iter().enumerate() {
        if !Parameter::ALL.contains(parameter) {
            return Err(FitError::NotFree(*parameter));
        }
        if free[..number].contains(parameter) {
            return Err(FitError::Twice(*parameter));
        }
        if let Parameter::Key(key) = parameter
            && file.is_flat()
            && !key.is_on_flat()
        {
            return Err(FitError::NotOnFlat(*parameter));
        }
        if parameter.is_work() && file.is_surface() {
            Question::Fit
                .check(Solver::HeightMap, &[Feature::AdhesiveTops])
                .map_err(SolveError::from)?;
        }
        if parameter.is_of_displacement() && data.position() != Position::Displacement {
            return Err(FitError::NoDisplacement {
                name: data.name().to_owned(),
                parameter: *parameter,
            });
        }
        let name = || data.name().to_owned();
        if parameter.is_of_relaxation() && !data.has_times() {
            return Err(FitError::NoTimes {
                name: name(),
                parameter: *parameter,
            });
        }
        if parameter.is_of_force() && data.rows().iter().all(|row| row.force.is_none()) {
            return Err(FitError::NoForce {
                name: name(),
                parameter: *parameter,
            });
        }
        // On a flat surface and on rounded tops the lens is pulled from the first contact on, and adhesion shows on loading too.
        let shows_on_loading = (file.is_flat() || file.is_rounded())
            && *parameter == Parameter::Key(Key::WorkOfAdhesion);
        if parameter.is_work() && !shows_on_loading && !data.branches().contains(&Branch::Unloading)
        {
            return Err(FitError::NoUnloading {
                name: name(),
                parameter: *parameter,
            });
        }
    }
    let receding = Parameter::Key(Key::RecedingWorkOfAdhesion);
    let has_receding = free.contains(&receding)
        || subject::Subject::of(file)?
            .adhesion()
            .work_receding
            .is_some();
    if has_receding
        && free.contains(&Parameter::Key(Key::WorkOfAdhesion))
        && data.unloading_point().is_none()
        && !data.branches().contains(&Branch::Loading)
    {
        return Err(FitError::NoLoading {
            name: data.name().to_owned(),
        });
    }
    if !options.contact_point.unwrap_or(0.0).is_finite() {
        return Err(FitError::NotFinite("the contact point"));
    }
    if !options.machine_compliance.is_finite() {
        return Err(FitError::NotFinite("the machine compliance"));
    }
    if options.machine_compliance < 0.0 {
        return Err(FitError::NegativeCompliance(options.machine_compliance));
    }
    if !options.force_offset.is_finite() {
        return Err(FitError::NotFinite("the force offset"));
    }
    let drifts = [
        options.displacement_drift,
        options.force_drift,
        options.force_slope,
    ];
    if !drifts.iter().all(|drift| drift.is_finite()) {
        return Err(FitError::NotFinite("a drift"));
    }
    if options.starts > MOST_STARTS {
        return Err(FitError::TooManyStarts(options.starts));
    }
    Ok(())
}

/// Whether the loads of rows, each given with its residual, increase or decrease, except for noise in a hold. Their residuals are then compared in the
/// order of the rows: sorted by load, the residuals of a hold would follow the noise of the loads.
fn moves_on(rows: &[(f64, f64)]) -> bool {
    /// Largest fraction of the changes in the other direction.
    const BACK: f64 = 0.25;
    let steps = rows.windows(2).map(|pair| pair[1].0 - pair[0].0);
    let (forward, back) = steps.fold((0.0, 0.0), |(forward, back), step: f64| {
        (forward + step.max(0.0), back + (-step).max(0.0))
    });
    forward.min(back) <= BACK * (forward + back)
}

/// A value compared with the model.
#[derive(Debug, Clone, Copy)]
struct Datum {
    row: usize,
    quantity: Quantity,
    measured: Measured,
}

/// The interval of an unknown that ends at its smallest possible value.
#[derive(Debug, Clone, Copy)]
struct OneSided {
    least: f64,
    upper: f64,
}

/// State of the search at a set of unknowns.
struct Search<'a> {
    model: &'a Model<'a>,
    /// Shortest interval of a curve with adhesion, as a fraction of the range of the loads.
    stretch: f64,
    unknowns: Vec<f64>,
    states: Vec<State>,
    derivatives: Vec<Derivatives>,
    /// For every row, whether it is used: before the transition, or with the floor.
    used: Vec<bool>,
    data: Vec<Datum>,
    errors: Vec<f64>,
    /// Estimated error of each quantity.
    scatter: [f64; 2],
    linear: Option<Linear>,
    iterations: usize,
    /// Number of steps with previous interval lengths.
    earlier_iterations: usize,
    /// Number of contacts solved for the tests.
    solved: StdCell<usize>,
    /// Interpolation between solved states; `None` if every row is solved.
    sampled: Option<Sampled>,
    /// States in some rows with their derivatives, for the tests of fixed parameters.
    of_tests: OnceCell<Arc<Table>>,
    /// Whether the search has ended.
    is_finished: bool,
}

impl<'a> Search<'a> {
    fn new(
        model: &'a Model<'a>,
        unknowns: Vec<f64>,
        stretch: f64,
        direct: usize,
    ) -> Result<Self, FitError> {
        let rows = model.data.rows();
        let scale = |quantity: Quantity| {
            let values = rows.iter().filter_map(|row| quantity.of(row));
            values.fold(0.0, |largest: f64, value| largest.max(value.value.abs()))
        };
        let mut search = Self {
            model,
            stretch,
            states: Vec::new(),
            derivatives: Vec::new(),
            used: Vec::new(),
            data: Vec::new(),
            errors: Vec::new(),
            scatter: Quantity::ALL.map(|quantity| 0.01 * scale(quantity)),
            linear: None,
            iterations: 0,
            earlier_iterations: 0,
            solved: StdCell::new(0),
            sampled: Sampled::suits(model, direct).then(Sampled::default),
            of_tests: OnceCell::new(),
            is_finished: false,
            unknowns,
        };
        search.states = search.states_at(&search.unknowns)?;
        search.select();
        search.check_enough().or_else(|error| {
            // The initial values may place too many states past the transition.
            search.used = search
                .states
                .iter()
                .map(|state| state.problem.is_none())
                .collect();
            search.collect();
            search.check_enough().or_else(|_| {
                model.first_problem(&search.unknowns)?;
                Err(error)
            })
        })?;
        search.linearise()?;
        Ok(search)
    }

    /// Continues the search from the current unknowns with other intervals.
    fn restart(&mut self, stretch: f64) -> Result<(), FitError> {
        self.stretch = stretch;
        self.earlier_iterations += self.iterations;
        self.iterations = 0;
        self.settle(self.unknowns.clone())
    }

    /// Moves to unknowns, with the states, rows and derivatives that belong to them.
    fn settle(&mut self, unknowns: Vec<f64>) -> Result<(), FitError> {
        let states = self.states_at(&unknowns)?;
        self.settle_at(unknowns, states)
    }

    /// The same with known states.
    fn settle_at(&mut self, unknowns: Vec<f64>, states: Vec<State>) -> Result<(), FitError> {
        self.unknowns = unknowns;
        self.states = states;
        self.select();
        self.check_enough()?;
        self.linearise()
    }

    /// Ends the search: the states of the result are solved, up to a number of rows for each of them, and the search continues with these for a few
    /// steps.
    fn finish(&mut self) -> Result<(), FitError> {
        /// Largest number of steps.
        const STEPS: usize = 2;
        if self.sampled.is_none() {
            return Ok(());
        }
        self.is_finished = true;
        self.settle(self.unknowns.clone())?;
        for _ in 0..STEPS {
            let step = self.step(0.0);
            if within(self.promised(&step), NO_GAIN) {
                break;
            }
            let step = self.bounded(step);
            let trial = self.model.moved(&self.unknowns, &step);
            let states = match self.states_at(&trial) {
                Ok(states) if self.are_enough(&states) => states,
                Err(error) if error.is_interruption() => return Err(error),
                _ => break,
            };
            // The step is short, and interpolation errors may exceed the gain.
            let noise = match self.tolerance().every_row {
                true => 0.0,
                false => INTERPOLATED,
            };
            if !within(self.trial_chi_square(&states), self.chi_square() + noise) {
                break;
            }
            self.iterations += 1;
            self.settle_at(trial, states)?;
        }
        Ok(())
    }

    /// Computed states of all rows.
    fn states_at(&self, unknowns: &[f64]) -> Result<Vec<State>, FitError> {
        match &self.sampled {
            Some(sampled) => sampled.states(self.model, unknowns, self.tolerance()),
            None => self.model.states(unknowns, self.stretch),
        }
    }

    /// Derivatives with respect to fixed parameters, which are free in another model. They are not interpolated between the states of the search, which
    /// are too far apart for the tests of these parameters: up to a number of rows, they are computed in each, else in so many rows at equal distances
    /// in the order of the load.
    fn derivatives_of_fixed(
        &self,
        model: &Model<'_>,
        unknowns: &[f64],
    ) -> Result<Vec<Derivatives>, FitError> {
        let Some(sampled) = &self.sampled else {
            return model.derivatives(unknowns, &self.states, self.stretch);
        };
        let table = match self.of_tests.get() {
            Some(known) => known,
            None => {
                let table = self.table_of_tests(sampled)?;
                self.of_tests.get_or_init(|| table)
            }
        };
        Sampled::default().derivatives(model, unknowns, &self.states, table, Purpose::Result)
    }

    /// States in these rows, with the exact derivatives of their forces.
    fn table_of_tests(&self, sampled: &Sampled) -> Result<Arc<Table>, FitError> {
        let (model, tolerance) = (self.model, self.tolerance());
        let rows = model.data.rows();
        if rows.len() <= sampled::SOLVED_AT_END {
            return sampled.table(model, &self.unknowns, tolerance);
        }
        let mut order: Vec<usize> = (0..rows.len()).filter(|row| self.used[*row]).collect();
        order.sort_by(|a, b| model::load_of(&rows[*a]).total_cmp(&model::load_of(&rows[*b])));
        let steps = sampled::SOLVED_AT_END.min(order.len()).max(2) - 1;
        let places = (0..=steps).map(|k| order.len().saturating_sub(1) * k / steps);
        let picked: BTreeSet<usize> = places
            .filter_map(|place| order.get(place).copied())
            .collect();
        sampled.table_of(model, &self.unknowns, &picked, tolerance)
    }

    /// Derivatives at the states.
    fn derivatives_at_states(&self, purpose: Purpose) -> Result<Vec<Derivatives>, FitError> {
        let (model, unknowns) = (self.model, &self.unknowns);
        let Some(sampled) = &self.sampled else {
            return model.derivatives(unknowns, &self.states, self.stretch);
        };
        let table = sampled.table(model, unknowns, self.tolerance())?;
        sampled.derivatives(model, unknowns, &self.states, &table, purpose)
    }

    /// Tolerances of the interpolation.
    fn tolerance(&self) -> Tolerance {
        let rows = self.model.data.rows();
        let largest = Quantity::ALL.map(|quantity| {
            let values = rows.iter().filter_map(|row| quantity.of(row));
            values.fold(0.0, |largest: f64, value| largest.max(value.value.abs()))
        });
        let errors = Quantity::ALL.map(|quantity| {
            let pairs = self.data.iter().zip(&self.errors);
            let used = pairs.filter(|(datum, _)| datum.quantity == quantity);
            let used = used.map(|(_, error)| *error);
            let smallest = used.reduce(f64::min);
            // At the start there are no errors yet.
            let first = || self.scatter[quantity as usize] * (rows.len() as f64).sqrt();
            smallest.unwrap_or_else(first)
        });
        let tolerance = Tolerance::new(errors, largest, rows.len());
        if self.is_finished && rows.len() <= sampled::SOLVED_AT_END {
            tolerance.exact().of_result()
        } else if self.is_finished {
            tolerance.of_result()
        } else {
            tolerance.of_search(errors)
        }
    }

    /// Selects the rows to be used and their values; returns whether they have changed.
    fn select(&mut self) -> bool {
        // After many steps a row that was left out remains so; otherwise a row at the transition might alternate
        // forever.
        let stays_out = |row: usize| self.iterations > PATIENCE && !self.used[row];
        let above_floor = |state: &State| !state.past_transition && state.problem.is_none();
        let used: Vec<bool> = self
            .states
            .iter()
            .enumerate()
            .map(|(row, state)| above_floor(state) && !stays_out(row))
            .collect();
        let changed = used != self.used;
        self.used = used;
        self.collect();
        changed
    }

    fn collect(&mut self) {
        let rows = self.model.data.rows().iter().enumerate();
        let used = rows.filter(|(row, _)| self.used[*row]);
        self.data = used
            .flat_map(|(row, measurement)| {
                Quantity::ALL.into_iter().filter_map(move |quantity| {
                    let measured = quantity.of(measurement)?;
                    Some(Datum {
                        row,
                        quantity,
                        measured,
                    })
                })
            })
            .collect();
    }

    fn has_scatter(&self) -> bool {
        self.data.iter().any(|datum| datum.measured.error.is_none())
    }

    fn check_enough(&self) -> Result<(), FitError> {
        let (values, parameters) = (self.data.len(), self.unknowns.len());
        let estimated = self.has_scatter();
        if values < parameters + usize::from(estimated) {
            return Err(FitError::TooFewData {
                name: self.model.data.name().to_owned(),
                values,
                parameters,
                estimated,
            });
        }
        Ok(())
    }

    fn computed(&self, datum: &Datum, states: &[State]) -> f64 {
        match datum.quantity {
            Quantity::Force => states[datum.row].read_force,
            Quantity::ContactRadius => states[datum.row].contact_radius,
        }
    }

    /// Measured minus computed.
    fn residuals(&self) -> Vec<f64> {
        let residual = |datum: &Datum| datum.measured.value - self.computed(datum, &self.states);
        self.data.iter().map(residual).collect()
    }

    /// Derivatives and errors at the unknowns.
    fn linearise(&mut self) -> Result<(), FitError> {
        self.differentiate()?;
        // The estimated errors depend on the leverages, and the leverages on the errors. One repetition is sufficient,
        // because every step of the search updates them.
        self.decompose()?;
        if self.has_scatter() {
            let leverages = match &self.linear {
                Some(linear) => linear.leverages(self.data.len()),
                None => vec![0.0; self.data.len()],
            };
            self.estimate_scatter(&leverages)?;
            self.errors = self.with_errors()?;
            self.decompose()?;
        }
        Ok(())
    }

    /// Derivatives at the unknowns, and errors with the scatter as estimated before.
    fn differentiate(&mut self) -> Result<(), FitError> {
        let purpose = match self.is_finished {
            true => Purpose::Result,
            false => Purpose::Search,
        };
        self.derivatives = self.derivatives_at_states(purpose)?;
        self.errors = self.with_errors()?;
        Ok(())
    }

    /// Derivatives of the values with respect to the unknowns, divided by the errors of the values.
    fn weighted_derivatives(&self) -> Vec<Vec<f64>> {
        let values = self.data.iter().zip(&self.errors);
        values
            .map(|(datum, error)| {
                let row = &self.derivatives[datum.row];
                let derivatives = match datum.quantity {
                    Quantity::Force => &row.force,
                    Quantity::ContactRadius => &row.contact_radius,
                };
                derivatives.iter().map(|value| value / error).collect()
            })
            .collect()
    }

    fn decompose(&mut self) -> Result<(), FitError> {
        let rows = self.weighted_derivatives();
        let linear = Linear::new(&rows, self.unknowns.len()).ok_or(FitError::NoDerivatives)?;
        self.linear = Some(linear);
        Ok(())
    }

    /// Variance of a value in addition to its own error: due to the load and to jumps.
    fn known_variance(&self, datum: &Datum, half_pitch: f64) -> f64 {
        let row = &self.model.data.rows()[datum.row];
        let slopes = &self.derivatives[datum.row];
        let (slope, jumps) = match datum.quantity {
            Quantity::Force => (
                slopes.force_by_position,
                self.states[datum.row].force_variance,
            ),
            Quantity::ContactRadius => (slopes.radius_by_position, half_pitch * half_pitch / 12.0),
        };
        let of = |measured: Option<Measured>| measured.and_then(|m| m.error).unwrap_or(0.0);
        let load = match row.position {
            Some(_) => slope * of(row.position),
            None => slopes.radius_by_force * of(row.force),
        };
        load * load + jumps
    }

    /// Additional variance in the weights: rows in one interval share its jumps and together contain the information of one
    /// row.
    fn shared_variance(&self, datum: &Datum) -> f64 {
        let state = &self.states[datum.row];
        match datum.quantity {
            Quantity::Force => state.force_variance * (state.sharing - 1.0),
            Quantity::ContactRadius => 0.0,
        }
    }

    fn half_pitch(&self) -> Result<f64, FitError> {
        let settings = self.model.settings(&self.unknowns)?;
        Ok(settings.case.half_pitch())
    }

    fn with_errors(&self) -> Result<Vec<f64>, FitError> {
        let half_pitch = self.half_pitch()?;
        let error = |datum: &Datum| {
            let own = datum
                .measured
                .error
                .unwrap_or(self.scatter[datum.quantity as usize]);
            let known = self.known_variance(datum, half_pitch) + self.shared_variance(datum);
            (own * own + known).sqrt()
        };
        Ok(self.data.iter().map(error).collect())
    }

    /// Sum of squares divided by the individual variance of each value.
    fn chi_square_of_values(&self) -> f64 {
        let residuals = self.residuals();
        let terms = self.data.iter().zip(&residuals).zip(&self.errors);
        terms
            .map(|((datum, residual), error)| {
                residual * residual / (error * error - self.shared_variance(datum))
            })
            .sum()
    }

    /// Estimates the errors of quantities without given errors, from the residuals and the leverages of the values.
    fn estimate_scatter(&mut self, leverages: &[f64]) -> Result<(), FitError> {
        let half_pitch = self.half_pitch()?;
        let residuals = self.residuals();
        for quantity in Quantity::ALL {
            let mut terms = Vec::new();
            let (mut freedom, mut largest) = (0.0, 0.0f64);
            for (k, datum) in self.data.iter().enumerate() {
                if datum.quantity == quantity && datum.measured.error.is_none() {
                    terms.push((residuals[k].powi(2), self.known_variance(datum, half_pitch)));
                    freedom += 1.0 - leverages[k];
                    largest = largest.max(datum.measured.value.abs());
                }
            }
            if terms.is_empty() {
                continue;
            }
            if freedom < 0.5 {
                return Err(FitError::NoScatter {
                    name: self.model.data.name().to_owned(),
                    quantity: quantity.name(),
                    values: terms.len(),
                });
            }
            let least = LEAST_SCATTER * if largest > 0.0 { largest } else { 1.0 };
            self.scatter[quantity as usize] = larger(own_variance(&terms, freedom).sqrt(), least);
        }
        Ok(())
    }

    fn chi_square(&self) -> f64 {
        let residuals = self.residuals();
        let terms = residuals.iter().zip(&self.errors);
        terms
            .map(|(residual, error)| (residual / error).powi(2))
            .sum()
    }

    /// How many times a step is longer than the largest allowed change of a parameter; 1 if it is not.
    fn excess(&self, step: &[f64]) -> f64 {
        let lengths = step.iter().zip(self.model.free);
        lengths
            .map(|(step, parameter)| step.abs() / parameter.longest_step())
            .fold(1.0, larger)
    }

    /// Whether all rows used have computed states, and enough of them are before the transition.
    fn are_enough(&self, states: &[State]) -> bool {
        let is_there = |datum: &&Datum| states[datum.row].problem.is_none();
        let before = |datum: &&Datum| !states[datum.row].past_transition;
        let least = self.unknowns.len() + usize::from(self.has_scatter());
        self.data.iter().all(|datum| is_there(&datum))
            && self.data.iter().filter(before).count() >= least
    }

    /// Leaves out rows that have no state among these, unless too few would remain.
    fn leave_out(&mut self, states: &[State]) -> Result<bool, FitError> {
        let before = self.used.clone();
        for (used, state) in self.used.iter_mut().zip(states) {
            *used &= state.problem.is_none();
        }
        let changed = self.used != before;
        self.collect();
        if self.check_enough().is_err() {
            self.used = before;
            self.collect();
            return Ok(false);
        }
        self.linearise()?;
        Ok(changed)
    }

    /// Predicted reduction of the sum of squares, from the derivatives.
    fn promised(&self, step: &[f64]) -> f64 {
        let residuals = self.residuals();
        let terms = self.data.iter().zip(residuals).zip(&self.errors);
        terms
            .map(|((datum, residual), error)| {
                let row = &self.derivatives[datum.row];
                let slopes = match datum.quantity {
                    Quantity::Force => &row.force,
                    Quantity::ContactRadius => &row.contact_radius,
                };
                let change: f64 = slopes
                    .iter()
                    .zip(step)
                    .map(|(slope, step)| slope * step)
                    .sum();
                (residual / error).powi(2) - ((residual - change) / error).powi(2)
            })
            .sum()
    }

    /// Sum of squares at other states, without jumps of the contact radius: it changes as the
    /// [radius without jumps](radius::smooth_radius).
    fn trial_chi_square(&self, states: &[State]) -> f64 {
        let terms = self.data.iter().zip(&self.errors).map(|(datum, error)| {
            let (from, to) = (&self.states[datum.row], &states[datum.row]);
            let computed = match datum.quantity {
                Quantity::Force => to.read_force,
                Quantity::ContactRadius => {
                    from.contact_radius + to.smooth_radius - from.smooth_radius
                }
            };
            ((datum.measured.value - computed) / error).powi(2)
        });
        let sum: f64 = terms.sum();
        if sum.is_nan() { f64::INFINITY } else { sum }
    }

    /// Reason for the end of the search.
    fn started(&self, termination: Termination) -> StartedFit {
        let terms = self.residuals().into_iter().zip(&self.errors);
        let sum: f64 = terms.map(|(r, e)| (r / e).powi(2) + 2.0 * e.ln()).sum();
        let deviance = sum / self.data.len() as f64;
        StartedFit {
            converged: termination == Termination::Converged,
            deviance: Some(deviance).filter(|deviance| deviance.is_finite()),
            is_answer: false,
        }
    }

    /// The largest value of a quantity.
    fn largest(&self, quantity: Quantity) -> f64 {
        let values = self.data.iter().filter(|datum| datum.quantity == quantity);
        values.fold(0.0, |largest: f64, datum| {
            largest.max(datum.measured.value.abs())
        })
    }

    /// Whether the errors of a quantity are estimated from residuals that are as small as the errors of
    /// the solver.
    fn is_exact(&self, quantity: Quantity) -> bool {
        let mut of = self.data.iter().filter(|datum| datum.quantity == quantity);
        let estimated = of
            .next()
            .is_some_and(|datum| datum.measured.error.is_none());
        estimated
            && within(
                self.scatter[quantity as usize],
                SOLVED * self.largest(quantity),
            )
    }

    /// Tests of whether the fit describes the data. Beside the best fit, any fixed parameter may seem wrong: none is tested before the search has converged.
    fn misfit(&self, termination: Termination) -> Result<Misfit, FitError> {
        let freedom = self.data.len().saturating_sub(self.unknowns.len());
        let given = !self.has_scatter() && freedom > 0;
        let chi_square = self.chi_square_of_values();
        Ok(Misfit {
            runs: self.runs()?,
            chi_square_p_value: given.then(|| misfit::chi_square_above(chi_square, freedom)),
            small_chi_square_p_value: given.then(|| misfit::chi_square_below(chi_square, freedom)),
            left_out: match termination {
                Termination::Converged => self.left_out(freedom)?,
                _ => Vec::new(),
            },
        })
    }

    fn runs(&self) -> Result<Vec<RunsTest>, FitError> {
        let residuals = self.residuals();
        let half_pitch = self.half_pitch()?;
        let mut tests = Vec::new();
        for quantity in Quantity::ALL {
            if self.is_exact(quantity) {
                continue;
            }
            let least = SOLVED * self.largest(quantity);
            for branch in [Branch::Loading, Branch::Unloading] {
                let counts = |(k, datum): &(usize, &Datum)| {
                    // Rows that share jumps are correlated. Without adhesion, a jump of the radius affects a single row.
                    let known = self.known_variance(datum, half_pitch);
                    let jumps = if self.model.is_adhesive { known } else { 0.0 };
                    datum.quantity == quantity
                        && self.model.branches[datum.row] == branch
                        && jumps <= JUMPS * self.errors[*k].powi(2)
                        && residuals[*k].abs() > 0.1 * least
                };
                let mut of: Vec<(f64, f64)> = self
                    .data
                    .iter()
                    .enumerate()
                    .filter(counts)
                    .map(|(k, datum)| {
                        let load = model::load_of(&self.model.data.rows()[datum.row]);
                        (load, residuals[k])
                    })
                    .collect();
                if !moves_on(&of) {
                    of.sort_by(|a, b| a.0.total_cmp(&b.0));
                }
                let ordered: Vec<f64> = of.into_iter().map(|(_, residual)| residual).collect();
                tests.extend(RunsTest::new(quantity, branch, &ordered));
            }
        }
        Ok(tests)
    }

    /// Fixed parameters that could have been free.
    fn held(&self) -> Vec<Parameter> {
        let data = self.model.data;
        let compares_force = self
            .data
            .iter()
            .any(|datum| datum.quantity == Quantity::Force);
        let is_by_force = self.is_by_force();
        let has_unloading = data.branches().contains(&Branch::Unloading);
        let could = |parameter: &Parameter| match parameter {
            // The offset cannot be tested with the axis on a pillar, where all directions are equivalent; with adhesion every key requires
            // two cycles.
            Parameter::Key(Key::Offset | Key::OffsetAngle) => false,
            Parameter::Key(_) if parameter.is_work() => self.model.is_adhesive && has_unloading,
            // Another elastic curve would be needed for every size.
            Parameter::Key(key) if self.model.is_viscoelastic || self.model.is_map() => {
                matches!(key, Key::SubstrateYoungModulus | Key::LensYoungModulus)
            }
            _ if parameter.is_of_relaxation() => self.model.is_viscoelastic,
            // On rounded tops, and on pillars with adhesion, there are no layers.
            Parameter::Key(_) if parameter.is_thickness() => {
                !self.model.is_rounded() && (!self.model.is_adhesive || self.model.is_flat())
            }
            Parameter::Key(Key::TopRadius) => self.model.is_rounded(),
            Parameter::Key(key) if self.model.is_rounded() => self.model.is_given(*key),
            Parameter::Key(_) => true,
            // A tilted base line is rare, and mistaken for other parameters.
            Parameter::ForceSlope => false,
            _ if parameter.is_of_displacement() => data.position() == Position::Displacement,
            _ => compares_force || is_by_force,
        };
        let is_held = |parameter: &Parameter| !self.model.free.contains(parameter);
        let all = Parameter::ALL.into_iter();
        all.filter(|parameter| is_held(parameter) && could(parameter))
            .collect()
    }

    fn left_out(&self, freedom: usize) -> Result<Vec<LeftOut>, FitError> {
        let quantities = Quantity::ALL.into_iter();
        let mut there = quantities.filter(|q| self.data.iter().any(|d| d.quantity == *q));
        let Some(linear) = self.linear.as_ref().filter(|_| freedom > 1) else {
            return Ok(Vec::new());
        };
        if there.all(|quantity| self.is_exact(quantity)) {
            return Ok(Vec::new());
        }
        self.model.know_largest_contact(&self.states);
        // Each of them may be missing from the case.
        let exists = |parameter: &Parameter| {
            let free = [*parameter];
            let model = self.model.with(&self.unknowns, &free);
            let Ok((start, model)) = model.and_then(|model| Ok((model.start()?, model))) else {
                return false;
            };
            let near = [-1e-2, 1e-2].map(|step| model.settings(&[start[0] + step]));
            near.iter().all(Result::is_ok)
        };
        let held = self.held().into_iter().filter(exists);
        // If the method does not support a layer, only the test of its thickness is left out.
        let (of_layers, others): (Vec<_>, Vec<_>) = held.partition(|held| held.is_thickness());
        let alone = of_layers.iter().map(std::slice::from_ref);
        let mut left = Vec::new();
        for group in [&others[..]].into_iter().chain(alone) {
            left.extend(self.scores(group, linear, freedom)?);
        }
        // Parameters with the same effect differ by rounding, and remain in the order of the keys.
        let suspicion = |left: &LeftOut| (1e6 * left.p_value.ln()).round();
        left.sort_by(|a, b| suspicion(a).total_cmp(&suspicion(b)));
        Ok(left)
    }

    /// Test of whether forces at known times depend on the rate.
    fn rate_test(&self, freedom: usize) -> Option<RateTest> {
        /// Relaxation times that are tried, as fractions of the duration of the data.
        const FRACTIONS: [f64; 5] = [1.0, 0.3, 0.1, 0.03, 0.01];
        let data = self.model.data;
        let suits = !self.model.is_viscoelastic && !self.model.is_adhesive && data.has_times();
        let linear = self.linear.as_ref().filter(|_| suits && freedom > 1)?;
        if self.is_exact(Quantity::Force) {
            return None;
        }
        // In the order of time; rows that were left out are not part of the history.
        let mut rows: Vec<(usize, f64)> = data
            .rows()
            .iter()
            .enumerate()
            .filter(|(number, _)| self.used[*number])
            .filter_map(|(number, row)| Some((number, row.time?)))
            .collect();
        rows.sort_by(|one, other| one.1.total_cmp(&other.1));
        let times: Vec<f64> = rows.iter().map(|(_, time)| *time).collect();
        let forces: Vec<f64> = rows
            .iter()
            .map(|(row, _)| self.states[*row].force)
            .collect();
        let duration = times.last()? - times.first()?;
        let between = duration / (times.len() as f64 - 1.0);
        let compliance = self
            .model
            .settings(&self.unknowns)
            .ok()?
            .compliance(data.position());
        let residuals = self.residuals().into_iter().zip(&self.errors);
        let weighted: Vec<f64> = residuals
            .map(|(residual, error)| residual / error)
            .collect();
        let rest = linear.rest(&weighted);
        let squares: f64 = rest.iter().map(|residual| residual * residual).sum();
        let tried: Vec<f64> = FRACTIONS
            .iter()
            .map(|part| part * duration)
            .filter(|time| *time >= between)
            .collect();
        let test = |time: &f64| {
            let mut by_row = vec![0.0; self.states.len()];
            let terms = misfit::weak_relaxation(&times, &forces, *time);
            for ((row, _), term) in rows.iter().zip(terms) {
                by_row[*row] = term;
            }
            let values = self.data.iter().zip(&self.errors);
            let column: Vec<f64> = values
                .map(|(datum, error)| match datum.quantity {
                    Quantity::Force => {
                        // At a fixed reading, of which the machine takes a part.
                        let part = compliance * self.derivatives[datum.row].force_by_position;
                        by_row[datum.row] * (1.0 - part) / error
                    }
                    Quantity::ContactRadius => 0.0,
                })
                .collect();
            let length = column.iter().map(|value| value * value).sum::<f64>().sqrt();
            let score = Score::new(&rest, &linear.rest(&column), length)?;
            let both = score.p_value(squares, freedom, self.scatter_counts());
            // Strengths are positive.
            let p_value = if score.step > 0.0 {
                0.5 * both
            } else {
                1.0 - 0.5 * both
            };
            Some(RateTest {
                time: *time,
                strength: score.step,
                p_value: (p_value * tried.len() as f64).min(1.0),
            })
        };
        let tests = tried.iter().filter_map(test);
        tests.min_by(|one, other| one.p_value.total_cmp(&other.p_value))
    }

    /// Score tests of fixed parameters; `None` if the model has no derivatives with respect to them.
    fn scores(
        &self,
        held: &[Parameter],
        linear: &Linear,
        freedom: usize,
    ) -> Result<Vec<LeftOut>, FitError> {
        if held.is_empty() {
            return Ok(Vec::new());
        }
        let model = self.model.with(&self.unknowns, held)?;
        let start = model.start()?;
        let derivatives = match self.derivatives_of_fixed(&model, &start) {
            Ok(derivatives) => derivatives,
            Err(error) if error.is_interruption() => return Err(error),
            Err(_) => return Ok(Vec::new()),
        };
        self.solved.set(self.solved.get() + model.solved());
        let weighted: Vec<f64> = self
            .residuals()
            .iter()
            .zip(&self.errors)
            .map(|(residual, error)| residual / error)
            .collect();
        let residuals = linear.rest(&weighted);
        let squares: f64 = residuals.iter().map(|residual| residual * residual).sum();
        // Errors that are known otherwise, such as those of jumps, are not estimated.
        let is_estimated = self.scatter_counts();
        let score = |(number, parameter): (usize, &Parameter)| {
            let column: Vec<f64> = self
                .data
                .iter()
                .zip(&self.errors)
                .map(|(datum, error)| {
                    let row = &derivatives[datum.row];
                    let slopes = match datum.quantity {
                        Quantity::Force => &row.force,
                        Quantity::ContactRadius => &row.contact_radius,
                    };
                    slopes[number] / error
                })
                .collect();
            let length = column.iter().map(|value| value * value).sum::<f64>().sqrt();
            let score = Score::new(&residuals, &linear.rest(&column), length)?;
            let both = score.p_value(squares, freedom, is_estimated);
            // From a half-space, the thickness can change in one direction only.
            let (p_value, is_near) = match (model.is_infinite(*parameter), score.step > 0.0) {
                (false, _) => (both, score.step.abs() <= 1.0),
                (true, true) => (0.5 * both, score.step <= 1.0),
                (true, false) => (1.0 - 0.5 * both, false),
            };
            let unknown = start[number] + score.step;
            Some(LeftOut {
                parameter: *parameter,
                p_value,
                value: Some(model.value(number, unknown)).filter(|_| is_near),
            })
        };
        Ok(held.iter().enumerate().filter_map(score).collect())
    }

    /// Whether estimated errors contribute.
    fn scatter_counts(&self) -> bool {
        self.data.iter().zip(&self.errors).any(|(datum, error)| {
            let own = self.scatter[datum.quantity as usize];
            datum.measured.error.is_none() && own * own > JUMPS * error * error
        })
    }

    fn answer(&self, termination: Termination) -> Result<Fit, FitError> {
        let covariance = self.covariance();
        let freedom = self.data.len().saturating_sub(self.unknowns.len());
        let deviation = |number: usize| covariance[number][number].max(0.0).sqrt();
        let quantile = quantile(self.has_scatter().then_some(freedom));
        let ends = (0..self.unknowns.len())
            .map(|number| match self.model.free[number].is_work() {
                true => self.one_sided(number, deviation(number), quantile),
                false => Ok(None),
            })
            .collect::<Result<Vec<_>, _>>()?;
        let undetermined = self.undetermined(&covariance, &ends);
        let determined = |number: usize| {
            let parameter = self.model.free[number];
            !undetermined
                .iter()
                .any(|u| u.parameters.contains(&parameter))
        };
        let start = self.model.start()?;
        let estimates = (0..self.unknowns.len())
            .map(|number| {
                let known = determined(number).then_some(deviation(number));
                self.estimate(number, start[number], known, quantile, ends[number])
            })
            .collect();
        let correlation = (0..self.unknowns.len())
            .map(|a| {
                let with = |b: usize| {
                    let known = determined(a) && determined(b);
                    let sizes = (covariance[a][a] * covariance[b][b]).sqrt();
                    known.then(|| {
                        if a == b {
                            1.0
                        } else {
                            covariance[a][b] / sizes
                        }
                    })
                };
                (0..self.unknowns.len()).map(with).collect()
            })
            .collect();
        let settings = self.model.settings(&self.unknowns)?;
        let solved = if self.model.is_adhesive {
            self.model.cycle(&settings)?
        } else {
            None
        };
        let curve = match &solved {
            Some((curve, _)) => self.curve_of_cycle(&settings, curve),
            None if self.model.is_viscoelastic => self.curve_over_time(&settings),
            None => self.curve(&settings)?,
        };
        let pull_off = match &solved {
            Some((_, cycle)) => self.pull_off(&settings, cycle)?,
            None => None,
        };
        Ok(Fit {
            estimates,
            correlation,
            undetermined,
            chi_square: self.chi_square_of_values(),
            degrees_of_freedom: freedom,
            scatter: self.scatters()?,
            rows: self.rows(),
            limits: match &solved {
                Some((_, cycle)) => cycle.limits(),
                None => self.limits(&settings)?,
            },
            not_modelled: self.not_modelled(),
            curve,
            contact_point: settings.contact_point,
            machine_compliance: settings.machine_compliance,
            force_offset: settings.force_offset,
            displacement_drift: settings.displacement_drift,
            force_drift: settings.force_drift,
            force_slope: settings.force_slope,
            moments: self.model.moments.clone(),
            misfit: self.misfit(termination)?,
            rate: self.rate_test(freedom),
            starts: Vec::new(),
            solutions: self.model.solved() + self.solved.get(),
            cycle: solved.map(|(_, cycle)| cycle),
            method: settings.case.method_name(),
            pull_off,
            is_viscoelastic: self.model.is_viscoelastic,
            assumed_unloading_point: self.model.assumed_unloading_point(),
            radii_left_out: false,
            file: self.model.file(&self.unknowns),
            termination,
            iterations: self.earlier_iterations + self.iterations,
        })
    }

    fn estimate(
        &self,
        number: usize,
        start: f64,
        deviation: Option<f64>,
        quantile: f64,
        one_sided: Option<OneSided>,
    ) -> Estimate {
        let parameter = self.model.free[number];
        let unknown = self.unknowns[number];
        let value = self.model.value(number, unknown);
        let slope = self.model.slope(number, unknown);
        if let Some(OneSided { least, upper }) = one_sided {
            let [least, upper] = [least, upper].map(|end| self.model.value(number, end));
            return Estimate {
                parameter,
                start: self.model.value(number, start),
                value,
                standard_error: Some((upper - value) / quantile),
                interval: Some([least, upper]),
                one_sided: true,
            };
        }
        let ends = |deviation: f64| {
            let reach = quantile * deviation;
            if parameter.is_positive() {
                [unknown - reach, unknown + reach].map(|end| self.model.value(number, end))
            } else {
                [value - slope * reach, value + slope * reach]
            }
        };
        Estimate {
            parameter,
            start: self.model.value(number, start),
            value,
            standard_error: deviation.map(|deviation| deviation * slope),
            interval: deviation.map(ends),
            one_sided: false,
        }
    }

    /// For an unknown whose interval would extend beyond its smallest possible value: this value, and the value at which the sum of squares has
    /// increased by the square of the quantile, with the other unknowns optimised in linear approximation. `None` for other unknowns, and if the
    /// sum of squares does not increase.
    fn one_sided(
        &self,
        number: usize,
        deviation: f64,
        quantile: f64,
    ) -> Result<Option<OneSided>, FitError> {
        /// First distance that is tried, number of doublings, and number of subsequent bisections.
        const FIRST: f64 = 0.25;
        const DOUBLINGS: usize = 6;
        const HALVINGS: usize = 8;
        let [least, greatest] = self.model.range(number, &self.unknowns);
        // A bound that another free work of adhesion sets is uncertain.
        let works = self.model.free.iter().filter(|free| free.is_work());
        let least = match works.count() {
            2 => least.min(model::ZERO),
            _ => least,
        };
        let unknown = self.unknowns[number];
        if deviation > 0.0 && unknown - quantile * deviation > least {
            return Ok(None);
        }
        let mut rows = self.weighted_derivatives();
        for row in &mut rows {
            row[number] = 0.0;
        }
        let Some(others) = Linear::new(&rows, self.unknowns.len()) else {
            return Ok(None);
        };
        let squares = |states: &[State]| -> f64 {
            let data = self.data.iter().zip(&self.errors);
            let weighted: Vec<f64> = data
                .map(|(datum, error)| (datum.measured.value - self.computed(datum, states)) / error)
                .collect();
            others.rest(&weighted).iter().map(|rest| rest * rest).sum()
        };
        let now = squares(&self.states);
        let has_risen = |end: f64| -> Result<bool, FitError> {
            let mut moved = self.unknowns.clone();
            moved[number] = end;
            match self.model.states(&moved, self.stretch) {
                Ok(states) => Ok(squares(&states) - now > quantile * quantile),
                Err(error) if error.is_interruption() => Err(error),
                Err(_) => Ok(false),
            }
        };
        let (mut below, mut above) = (unknown, unknown + FIRST);
        for _ in 0..DOUBLINGS {
            if above > greatest {
                return Ok(None);
            }
            if has_risen(above)? {
                for _ in 0..HALVINGS {
                    let middle = f64::midpoint(below, above);
                    if has_risen(middle)? {
                        above = middle;
                    } else {
                        below = middle;
                    }
                }
                return Ok(Some(OneSided {
                    least,
                    upper: above,
                }));
            }
            (below, above) = (above, unknown + 2.0 * (above - unknown));
        }
        Ok(None)
    }

    /// Quantities compared: `force alone`, `force and contact radius`.
    fn compared(&self) -> (String, bool) {
        let there = |quantity: &Quantity| self.data.iter().any(|d| d.quantity == *quantity);
        let names: Vec<&str> = Quantity::ALL
            .iter()
            .filter(|q| there(q))
            .map(|q| q.name())
            .collect();
        (names.join(" and "), names.len() > 1)
    }

    fn undetermined(
        &self,
        covariance: &[Vec<f64>],
        ends: &[Option<OneSided>],
    ) -> Vec<Undetermined> {
        /// Correlation beyond which another parameter is the explanation.
        const TIED: f64 = 0.9;
        /// Largest standard deviation of a determined unknown. Unknowns are logarithms, or fractions of the range of the
        /// data.
        const LARGEST_DEVIATION: f64 = 1.0;
        let mut groups = self.linear.as_ref().map_or(Vec::new(), Linear::unseen);
        groups.retain(|group| group.len() > 1 || ends[group[0]].is_none());
        let deviation = |j: usize| covariance[j][j].max(0.0).sqrt();
        let is_large = |j: usize| deviation(j) > LARGEST_DEVIATION && ends[j].is_none();
        for j in 0..self.unknowns.len() {
            if !is_large(j) || groups.iter().any(|group| group.contains(&j)) {
                continue;
            }
            let tied = |k: &usize| {
                let correlation = covariance[j][*k] / (deviation(j) * deviation(*k));
                *k == j || (is_large(*k) && correlation.abs() > TIED)
            };
            groups.push((0..self.unknowns.len()).filter(tied).collect());
        }
        let free = self.model.free;
        let group = |members: Vec<usize>| members.into_iter().map(|j| free[j]).collect();
        groups
            .into_iter()
            .map(group)
            .map(|parameters: Vec<Parameter>| Undetermined {
                statement: self.statement(&parameters),
                parameters,
            })
            .collect()
    }

    fn statement(&self, parameters: &[Parameter]) -> String {
        let (quantities, several) = self.compared();
        let names: Vec<&str> = parameters
            .iter()
            .map(|parameter| parameter.name())
            .collect();
        match names[..] {
            [name] if several => format!("{quantities} do not determine {name}"),
            [name] => format!("{quantities} alone does not determine {name}"),
            [first, ref others @ ..] => {
                let verb = if several { "cannot" } else { "alone cannot" };
                format!(
                    "{quantities} {verb} distinguish {first} from {}: only a combination of them is \
                     determined; fix all but one of them",
                    others.join(" and ")
                )
            }
            [] => String::new(),
        }
    }

    fn scatters(&self) -> Result<Vec<Scatter>, FitError> {
        let residuals = self.residuals();
        let interpolated = self.interpolation_errors()?;
        let mut scatters = Vec::new();
        for quantity in Quantity::ALL {
            let of: Vec<usize> = (0..self.data.len())
                .filter(|k| self.data[*k].quantity == quantity)
                .collect();
            let Some(first) = of.first() else {
                continue;
            };
            let squares: f64 = of.iter().map(|k| residuals[*k].powi(2)).sum();
            let estimated = self.data[*first].measured.error.is_none();
            scatters.push(Scatter {
                quantity,
                values: of.len(),
                residual: (squares / of.len() as f64).sqrt(),
                estimated: estimated.then_some(self.scatter[quantity as usize]),
                interpolation_error: interpolated.as_ref().map(|errors| {
                    let errors = of.iter().map(|k| errors[self.data[*k].row]);
                    match quantity {
                        Quantity::Force => errors.fold(0.0, |most, [force, _]| larger(most, force)),
                        Quantity::ContactRadius => {
                            let squares: f64 = errors.map(|[_, radius]| radius * radius).sum();
                            (squares / of.len() as f64).sqrt()
                        }
                    }
                }),
            });
        }
        Ok(scatters)
    }

    /// Estimated interpolation errors of force and contact radius of every row; `None` if all rows were solved.
    fn interpolation_errors(&self) -> Result<Option<Vec<[f64; 2]>>, FitError> {
        let tolerance = self.tolerance();
        if self.model.is_viscoelastic || self.model.uses_curve() {
            let settings = self.model.settings(&self.unknowns)?;
            let error = self.model.error_over_time(&settings)?;
            if error.is_nan() {
                return Ok(None);
            }
            let forces = self.states.iter().map(|state| state.force);
            let largest = forces.fold(0.0, larger);
            return Ok(Some(vec![[error * largest, 0.0]; self.states.len()]));
        }
        match &self.sampled {
            Some(sampled) if !tolerance.every_row => {
                let states = &self.states;
                let errors = sampled.errors(self.model, &self.unknowns, states, tolerance);
                errors.map(Some)
            }
            _ => Ok(None),
        }
    }

    fn rows(&self) -> Vec<FittedRow> {
        let mut places = vec![[None; 2]; self.states.len()];
        for (place, datum) in self.data.iter().enumerate() {
            places[datum.row][datum.quantity as usize] = Some(place);
        }
        let rows = self.model.data.rows().iter().zip(&self.states).enumerate();
        rows.map(|(number, (measurement, state))| {
            let modelled = state.problem.is_none();
            let compared = |quantity: Quantity, computed: f64| {
                let measured = quantity.of(measurement).filter(|_| modelled)?;
                let place = places[number][quantity as usize];
                let error = place.map(|place: usize| self.errors[place]);
                Some(Compared {
                    measured: measured.value,
                    computed,
                    error: error
                        .or(measured.error)
                        .unwrap_or(self.scatter[quantity as usize]),
                })
            };
            FittedRow {
                measurement: *measurement,
                branch: (self.model.is_adhesive || self.model.is_viscoelastic)
                    .then(|| self.model.branches[number]),
                indentation: state.indentation,
                force: compared(Quantity::Force, state.read_force),
                contact_radius: compared(Quantity::ContactRadius, state.contact_radius),
                smallest_floor_gap: state.smallest_floor_gap,
                used: self.used[number],
                modelled,
                converged: state.converged,
            }
        })
        .collect()
    }

    /// Limits of the model under the largest load.
    fn limits(&self, settings: &model::Settings) -> Result<Vec<Limit>, FitError> {
        let rows = self.states.iter().zip(&self.used);
        let used = rows.filter(|(_, used)| **used);
        let deepest = used.map(|(state, _)| state.indentation).fold(0.0, f64::max);
        if deepest <= 0.0 {
            return Ok(Vec::new());
        }
        self.model.limits(settings, deepest)
    }

    fn not_modelled(&self) -> Vec<(u64, String)> {
        let rows = self.model.data.rows().iter().zip(&self.states);
        rows.filter_map(|(row, state)| Some((row.line, state.problem.clone()?)))
            .collect()
    }

    /// Pull-off of the fitted cycle and the smallest measured force.
    fn pull_off(
        &self,
        settings: &model::Settings,
        cycle: &FittedCycle,
    ) -> Result<Option<FittedPullOff>, FitError> {
        /// Step of the logarithm of the work of adhesion for the derivative of the pull-off force.
        const STEP: f64 = 0.1;
        let (Some(measured), Some([computed, model_error])) =
            (self.model.measured_pull(settings), cycle.pull_off())
        else {
            return Ok(None);
        };
        let works = [Key::RecedingWorkOfAdhesion, Key::WorkOfAdhesion];
        let is_free = |key: &Key| self.model.free.contains(&Parameter::Key(*key));
        let mut work_error = None;
        if let Some(key) = works.into_iter().find(is_free)
            && let Some(work) = settings.case.number(key).filter(|work| *work > 0.0)
        {
            let mut file = self.model.file(&self.unknowns);
            file.set_number(key, work * STEP.exp());
            let more = model::Settings {
                case: subject::Subject::of(&file)?,
                ..settings.clone()
            };
            let more = match self.model.cycle(&more) {
                Ok(more) => more.and_then(|(_, cycle)| cycle.pull_off()),
                Err(error) if error.is_interruption() => return Err(error),
                Err(_) => None,
            };
            let power = more.map(|[more, _]| (more / computed).ln() / STEP);
            work_error = power
                .filter(|power| *power > 0.0)
                .map(|power| model_error / power);
        }
        Ok(Some(FittedPullOff {
            measured: measured - settings.force_offset,
            computed,
            model_error,
            work_error,
        }))
    }

    /// Computed curve of a cycle over the range of the data.
    fn curve_of_cycle(&self, settings: &model::Settings, curve: &curve::Curve) -> Vec<CurvePoint> {
        let loads = self.model.data.rows().iter().map(model::load_of);
        let least = loads.fold(f64::INFINITY, f64::min);
        let instrument = least - settings.load(self.model.data.position(), least, 0.0);
        let of_branch = |branch: Branch| {
            let first = curve.at(branch, least - instrument);
            let places = curve.places(branch).iter().copied();
            let places = places.filter(move |place| place.position + instrument > least);
            let before = places.clone().next().filter(|_| first.force == 0.0);
            // Before its first point the curve has no contact.
            let touch = before.map(|place| curve::Place {
                force: 0.0,
                contact_radius: 0.0,
                ..place
            });
            let all = [first].into_iter().chain(touch).chain(places);
            let mut points: Vec<CurvePoint> = all
                .map(|place| {
                    let load = place.position + instrument;
                    let travel = self.model.travel_to(load);
                    CurvePoint {
                        branch: Some(branch),
                        load,
                        force: place.force + settings.base_line(0.0, travel),
                        contact_radius: place.contact_radius,
                    }
                })
                .collect();
            if branch == Branch::Unloading {
                points.reverse();
            }
            points
        };
        let mut points = of_branch(Branch::Loading);
        if self.model.branches.contains(&Branch::Unloading) {
            points.extend(of_branch(Branch::Unloading));
        }
        points
    }

    /// Computed curve of a history, through its rows.
    fn curve_over_time(&self, settings: &model::Settings) -> Vec<CurvePoint> {
        let rows = self.model.data.rows().iter().zip(&self.states).enumerate();
        let points = rows.filter(|(number, _)| self.used[*number]);
        let points = points.map(|(number, (row, state))| {
            let moment = self.model.moments[number];
            let drift = match self.model.data.position() {
                Position::Displacement => settings.displacement_drift,
                Position::Indentation => 0.0,
                Position::None => settings.force_drift,
            };
            CurvePoint {
                branch: Some(self.model.branches[number]),
                load: model::load_of(row) - drift * moment,
                force: state.force + settings.base_line(0.0, self.model.travel(row)),
                contact_radius: state.contact_radius,
            }
        });
        points.collect()
    }

    /// Computed curve over the range of the data used.
    fn curve(&self, settings: &model::Settings) -> Result<Vec<CurvePoint>, FitError> {
        let rows = self.model.data.rows().iter().zip(&self.used);
        let loads: Vec<f64> = rows
            .filter(|(_, used)| **used)
            .filter_map(|(row, _)| row.position.or(row.force.filter(|_| self.is_by_force())))
            .map(|load| load.value)
            .collect();
        let low = loads.iter().copied().fold(f64::INFINITY, f64::min);
        let high = loads.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if low > high {
            return Ok(Vec::new());
        }
        let at = |k: usize| low + (high - low) * k as f64 / (CURVE - 1) as f64;
        let mut points = Vec::with_capacity(CURVE);
        let table = match &self.sampled {
            Some(sampled) => Some(sampled.table(self.model, &self.unknowns, self.tolerance())?),
            None => None,
        };
        for load in (0..CURVE).map(at) {
            let state = if let Some(table) = &table {
                let state = sampled::state_at(self.model.data, settings, table, load, 0.0);
                if state.problem.is_some() {
                    continue;
                }
                Ok(state)
            } else if self.is_by_force() {
                self.model.state_under(settings, load, 0.0)
            } else {
                self.model.state_at(settings, load, 0.0, 0.0)
            };
            match state {
                Ok(state) => points.push(CurvePoint {
                    branch: None,
                    load,
                    force: state.force + settings.base_line(0.0, self.model.travel_to(load)),
                    contact_radius: state.contact_radius,
                }),
                Err(error) if error.is_interruption() => return Err(error),
                // Because of drifts it may be outside the model although the rows are inside.
                Err(_) => {}
            }
        }
        Ok(points)
    }

    fn is_by_force(&self) -> bool {
        self.model.data.position() == Position::None
    }
}

impl Descent for Search<'_> {
    type States = Vec<State>;

    fn unknowns(&self) -> &[f64] {
        &self.unknowns
    }

    fn iterations(&self) -> usize {
        self.iterations
    }

    fn count_iteration(&mut self) {
        self.iterations += 1;
    }

    fn chi_square(&self) -> f64 {
        self.chi_square()
    }

    fn weighted_residuals(&self) -> Vec<f64> {
        let residuals = self.residuals();
        let terms = residuals.iter().zip(&self.errors);
        terms.map(|(residual, error)| residual / error).collect()
    }

    fn weighted_derivatives(&self) -> Vec<Vec<f64>> {
        self.weighted_derivatives()
    }

    fn linear(&self) -> Option<&Linear> {
        self.linear.as_ref()
    }

    fn left_by(&self, step: &[f64]) -> Option<RangeEnd> {
        self.model.left_by(&self.unknowns, step)
    }

    fn bounded(&self, step: Vec<f64>) -> Vec<f64> {
        let excess = self.excess(&step);
        step.into_iter().map(|step| step / excess).collect()
    }

    fn moved(&self, step: &[f64]) -> Vec<f64> {
        self.model.moved(&self.unknowns, step)
    }

    fn states_at(&self, unknowns: &[f64]) -> Result<Vec<State>, FitError> {
        self.states_at(unknowns)
    }

    fn is_interpolated(&self) -> bool {
        self.sampled.is_some()
    }

    fn are_enough(&self, states: &Vec<State>) -> bool {
        self.are_enough(states)
    }

    fn trial_chi_square(&self, states: &Vec<State>) -> f64 {
        self.trial_chi_square(states)
    }

    fn promised(&self, step: &[f64]) -> f64 {
        self.promised(step)
    }

    fn accept(&mut self, unknowns: Vec<f64>, states: Vec<State>) {
        self.unknowns = unknowns;
        self.states = states;
    }

    fn leave_out(&mut self, states: &Vec<State>) -> Result<bool, FitError> {
        self.leave_out(states)
    }

    fn select(&mut self) -> bool {
        self.select()
    }

    fn check_enough(&self) -> Result<(), FitError> {
        self.check_enough()
    }

    fn linearise(&mut self) -> Result<(), FitError> {
        self.linearise()
    }
}

/// Variance `s^2` for which the sum of `r^2/(s^2 + v)` is `freedom`; zero if the sum is smaller
/// without it.
fn own_variance(terms: &[(f64, f64)], freedom: f64) -> f64 {
    let sum = |own: f64| {
        let terms = terms.iter().filter(|(square, _)| *square > 0.0);
        terms
            .map(|(square, variance)| square / (own + variance))
            .sum::<f64>()
    };
    let squares: f64 = terms.iter().map(|(square, _)| square).sum();
    let largest = squares / freedom;
    let end = |position: f64| Point {
        position,
        value: sum(position) - freedom,
    };
    if end(0.0).value <= 0.0 {
        return 0.0;
    }
    let ends = [end(0.0), end(largest)];
    match roots::find(ends, 0.0, |own| Ok::<_, Infallible>(end(own).value)) {
        Ok(Some(root)) => root.closest().position,
        // Without any other variance the sum is `freedom` at the upper end, except for rounding.
        Ok(None) => largest,
    }
}

/// Half-width of a 95 % interval in standard errors: of Student's distribution with the given
/// degrees of freedom, or of the normal distribution.
fn quantile(freedom: Option<usize>) -> f64 {
    const PROBABILITY: f64 = 0.975;
    match freedom.map(|freedom| StudentsT::new(0.0, 1.0, freedom as f64)) {
        Some(Ok(student)) => student.inverse_cdf(PROBABILITY),
        _ => Normal::standard().inverse_cdf(PROBABILITY),
    }
}

#[cfg(test)]
mod interpolation_tests;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_the_tables() {
        // E. g. NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.2.
        for (freedom, value) in [(Some(1), 12.706), (Some(10), 2.228), (None, 1.960)] {
            assert!((quantile(freedom) - value).abs() < 6e-4);
        }
    }

    #[test]
    fn variances_by_hand() {
        assert!((own_variance(&[(1.0, 0.0), (3.0, 0.0)], 2.0) - 2.0).abs() < 1e-12);
        assert!((own_variance(&[(6.0, 1.0), (6.0, 1.0)], 2.0) - 5.0).abs() < 1e-12);
        assert!(own_variance(&[(1.0, 1.0)], 2.0).abs() < 1e-12);
    }
}
