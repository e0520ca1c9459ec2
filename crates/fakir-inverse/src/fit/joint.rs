//! Several curves fitted together: some parameters have one value for all curves, the others a value for every curve.
//!
//! The sum of squares of all curves is minimised at once. Its Jacobian has a block of rows for every curve, and in them the columns of the
//! shared parameters and those of the parameters of this curve. The search starts from separate fits of the curves, from which the test of
//! the agreement of the shared values follows too.

use super::curves::{CurveFit, FittedData, MeasuredCurve};
use super::descent::Descent;
use super::error::FitError;
use super::least_squares::Linear;
use super::measurements::{Measurements, Quantity};
use super::misfit::{self, LEVEL};
use super::model::{Model, RangeEnd, State};
use super::options::FitOptions;
use super::parameter::Parameter;
use super::{Datum, Estimate, OneSided, Search, check, quantile};
use fakir::numerics::convergence::larger;
use fakir::problem::Question;
use fakir::state::{Run, SolveError, Termination};
use fakir_case::{CaseFile, Key};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::time::Instant;

/// Largest standard deviation of a determined unknown, as in a single fit.
const LARGEST_DEVIATION: f64 = 1.0;

/// Test of whether all curves have the same shared values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// Increase of the sum of squares, with the errors of the separate fits, from these fits to the joint fit; divided by the first number of
    /// degrees of freedom if errors were estimated.
    pub statistic: f64,
    /// Number of values that the joint fit has fewer than the separate fits.
    pub degrees_of_freedom: usize,
    /// Degrees of freedom of the separate fits if errors were estimated: then the statistic has the F-distribution, otherwise that of
    /// chi-square.
    pub denominator: Option<usize>,
    /// Probability of a statistic of at least this value if all curves have the same shared values.
    pub p_value: f64,
}

impl Agreement {
    fn new(increase: f64, degrees_of_freedom: usize, denominator: Option<usize>) -> Self {
        // Smaller than zero by rounding or by the end of the searches.
        let increase = larger(increase, 0.0);
        let (statistic, p_value) = match denominator {
            None => (
                increase,
                misfit::chi_square_above(increase, degrees_of_freedom),
            ),
            Some(rest) => {
                let ratio = increase / degrees_of_freedom as f64;
                let law = FisherSnedecor::new(degrees_of_freedom as f64, rest as f64);
                (ratio, law.map_or(1.0, |law| law.sf(ratio)))
            }
        };
        Self {
            statistic,
            degrees_of_freedom,
            denominator,
            p_value,
        }
    }
}

/// A fit of several curves together.
#[derive(Debug)]
pub struct JointFit {
    /// All free parameters.
    pub free: Vec<Parameter>,
    /// Estimates of the shared parameters.
    pub shared: Vec<Estimate>,
    /// Correlation matrix of the shared parameters; `None` for parameters that are not determined.
    pub correlation: Vec<Vec<Option<f64>>>,
    /// The curves. Their fits contain all parameters, with the errors of the joint fit.
    pub curves: Vec<CurveFit>,
    /// Messages on parameters that the data do not determine.
    pub undetermined: Vec<String>,
    /// Sum of squares of (measured - computed)/error of all curves.
    pub chi_square: f64,
    /// Number of values of all curves minus number of shared parameters and of parameters of the curves.
    pub degrees_of_freedom: usize,
    /// Probability of a chi-square of at least this value; `None` if errors are estimated.
    pub chi_square_p_value: Option<f64>,
    /// Test of the shared values; `None` for one curve, or if a separate fit does not converge.
    pub agreement: Option<Agreement>,
    /// For every curve, the estimates of the shared parameters in its separate fit.
    pub separate: Vec<Vec<Estimate>>,
    /// The case with the shared values.
    pub file: CaseFile,
    /// Why the search stopped.
    pub termination: Termination,
    /// Number of steps of the joint search.
    pub iterations: usize,
}

impl JointFit {
    /// Whether the search converged, and every contact compared is solved.
    #[must_use]
    pub fn converged(&self) -> bool {
        let curves = self.curves.iter();
        self.termination == Termination::Converged
            && curves.fold(true, |all, curve| all & curve.converged().is_some())
    }

    /// Whether the shared values agree, as far as it can be tested.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.agreement.is_none_or(|test| test.p_value >= LEVEL)
    }

    /// Whether the fit describes every curve, chi-square of all curves is not too large, and the shared values agree.
    #[must_use]
    pub fn describes_data(&self) -> bool {
        let mut fits = self.curves.iter().filter_map(|c| c.outcome.as_ref().ok());
        fits.all(|fitted| fitted.fit.misfit.describes_data())
            && self.chi_square_p_value.is_none_or(|p| p >= LEVEL)
            && self.agrees()
    }
}

/// The free parameters that are shared if none are named: keys of the case, except for the position of the axis.
#[must_use]
pub fn shared_by_default(free: &[Parameter]) -> Vec<Parameter> {
    let of_axis =
        |parameter: &Parameter| matches!(parameter, Parameter::Key(Key::Offset | Key::OffsetAngle));
    let of_sample = |parameter: &Parameter| parameter.is_of_case() && !of_axis(parameter);
    free.iter().copied().filter(of_sample).collect()
}

/// Fits the free parameters to all curves together: those in `shared` have one value, the others a value for every curve. A curve may have a case of its
/// own: pillars and a flat reference of the same material share modulus and work of adhesion. The threads of `run` share the rows of a curve. `done` is
/// called after the separate fit of every curve.
///
/// # Errors
/// See [`FitError`]: the curves must contain the same quantities, and all of them must be read.
pub fn fit_jointly(
    file: &CaseFile,
    curves: Vec<MeasuredCurve>,
    free: &[Parameter],
    shared: &[Parameter],
    run: &Run<'_>,
    done: &(dyn Fn() + Sync),
) -> Result<JointFit, FitError> {
    let start = Instant::now();
    check_shared(free, shared)?;
    if curves.is_empty() {
        return Err(FitError::NoCurves);
    }
    let (mut names, mut cases) = (Vec::new(), Vec::new());
    let mut given: Vec<(Measurements, FitOptions)> = Vec::new();
    for curve in curves {
        given.push(curve.data.map_err(|error| error.of_curve(&curve.name))?);
        names.push(curve.name);
        cases.push(curve.case.unwrap_or_else(|| file.clone()));
    }
    check_quantities(&names, &given)?;
    let models = models(&cases, &names, &given, free, shared, run)?;
    let separate = separate_fits(&models, &names, &given, run, done);
    let (separate, ended): (Vec<Search<'_>>, Vec<Termination>) = separate?.into_iter().unzip();
    let all_converged = ended.iter().all(|ended| *ended == Termination::Converged);
    let snapshots: Vec<Snapshot> = separate
        .iter()
        .map(|search| Snapshot::new(search, shared))
        .collect::<Result<_, _>>()?;
    let mut joint = Joint::new(separate, free, shared, run)?;
    let termination = match &ended[..] {
        [ended] => *ended,
        // A kink is no reason to end before the first step.
        _ if joint.is_at_end(f64::INFINITY) => Termination::Converged,
        _ => joint.run(run)?,
    };
    let tested = all_converged && joint.searches.len() > 1;
    let agreement = tested.then(|| joint.agreement(&snapshots, shared.len()));
    let separate = snapshots.into_iter().map(|snapshot| snapshot.shared);
    joint.answer(
        Answered {
            file,
            names,
            shared,
            termination,
            agreement,
            separate: separate.collect(),
            wall_time: start.elapsed().as_secs_f64(),
        },
        &given,
    )
}

fn check_shared(free: &[Parameter], shared: &[Parameter]) -> Result<(), FitError> {
    if shared.is_empty() {
        return Err(FitError::NothingShared);
    }
    for (number, parameter) in shared.iter().enumerate() {
        if !free.contains(parameter) {
            return Err(FitError::SharedNotFree(*parameter));
        }
        if shared[..number].contains(parameter) {
            return Err(FitError::Twice(*parameter));
        }
    }
    Ok(())
}

/// Compared quantities of the data.
fn quantities(data: &Measurements) -> Vec<&'static str> {
    let is_there = |quantity: &Quantity| data.rows().iter().any(|row| quantity.of(row).is_some());
    let there = Quantity::ALL.into_iter().filter(is_there);
    there.map(Quantity::name).collect()
}

fn check_quantities(
    names: &[String],
    given: &[(Measurements, FitOptions)],
) -> Result<(), FitError> {
    let of: Vec<String> = given
        .iter()
        .map(|(data, _)| quantities(data).join(" and "))
        .collect();
    match of.iter().position(|other| *other != of[0]) {
        None => Ok(()),
        Some(other) => Err(FitError::OtherQuantities {
            first: names[0].clone(),
            of_first: of[0].clone(),
            other: names[other].clone(),
            of_other: of[other].clone(),
        }),
    }
}

/// The models of all curves, in which the unknown of a shared parameter means the same value.
fn models<'a>(
    cases: &'a [CaseFile],
    names: &[String],
    given: &'a [(Measurements, FitOptions)],
    free: &'a [Parameter],
    shared: &[Parameter],
    run: &Run<'a>,
) -> Result<Vec<Model<'a>>, FitError> {
    let mut models: Vec<Model<'a>> = Vec::new();
    for ((name, file), (data, options)) in names.iter().zip(cases).zip(given) {
        let model = file
            .check_surface(&[Question::Fit])
            .map_err(FitError::from)
            .and_then(|()| check(file, data, free, options))
            .and_then(|()| Model::new(file, data, free, options, run))
            .map_err(|error| error.of_curve(name))?;
        models.push(model);
    }
    if let Some((first, others)) = models.split_first_mut() {
        for model in others {
            for (number, parameter) in free.iter().enumerate() {
                // Both works of adhesion are compared with each other.
                if shared.contains(parameter) || parameter.is_work() {
                    model.scale_as(first, number);
                }
            }
        }
    }
    Ok(models)
}

/// The fit of every curve alone, and why its search ended.
fn separate_fits<'m, 'a: 'm>(
    models: &'m [Model<'a>],
    names: &[String],
    given: &[(Measurements, FitOptions)],
    run: &Run<'_>,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<(Search<'m>, Termination)>, FitError> {
    let alone = |number: usize| {
        let (_, options) = &given[number];
        let best = models[number].best(options, run, usize::MAX);
        let (search, ended, _) = best.map_err(|error| error.of_curve(&names[number]))?;
        done();
        Ok((search, ended))
    };
    let numbers = 0..models.len();
    match run.pool {
        None => numbers.map(alone).collect(),
        Some(pool) => pool.install(|| numbers.into_par_iter().map(alone).collect()),
    }
}

/// The end of a separate fit.
struct Snapshot {
    /// Values with their errors and residuals.
    values: Vec<(Datum, f64, f64)>,
    parameters: usize,
    is_estimated: bool,
    /// Estimates of the shared parameters.
    shared: Vec<Estimate>,
}

impl Snapshot {
    fn new(search: &Search<'_>, shared: &[Parameter]) -> Result<Self, FitError> {
        let residuals = search.residuals();
        let values = search.data.iter().zip(&search.errors).zip(residuals);
        let freedom = search.data.len().saturating_sub(search.unknowns.len());
        let quantile = quantile(search.has_scatter().then_some(freedom));
        let covariance = search.covariance();
        let starts = search.model.start()?;
        let estimate = |parameter: &Parameter| {
            let mut free = search.model.free.iter();
            let number = free.position(|free| free == parameter)?;
            let deviation = larger(covariance[number][number], 0.0).sqrt();
            let known = Some(deviation).filter(|d| *d > 0.0 && *d <= LARGEST_DEVIATION);
            Some(search.estimate(number, starts[number], known, quantile, None))
        };
        Ok(Self {
            values: values
                .map(|((datum, error), residual)| (*datum, *error, residual))
                .collect(),
            parameters: search.unknowns.len(),
            is_estimated: search.has_scatter(),
            shared: shared.iter().filter_map(estimate).collect(),
        })
    }
}

/// What is reported beside the numbers of the search.
struct Answered<'a> {
    file: &'a CaseFile,
    names: Vec<String>,
    shared: &'a [Parameter],
    termination: Termination,
    agreement: Option<Agreement>,
    separate: Vec<Vec<Estimate>>,
    wall_time: f64,
}

/// The search of all curves together.
struct Joint<'m> {
    searches: Vec<Search<'m>>,
    /// For every curve, the number of each of its unknowns among those of all curves.
    places: Vec<Vec<usize>>,
    unknowns: Vec<f64>,
    linear: Option<Linear>,
    iterations: usize,
}

impl<'m> Joint<'m> {
    /// Begins at the separate fits, with the mean of the shared unknowns.
    fn new(
        searches: Vec<Search<'m>>,
        free: &[Parameter],
        shared: &[Parameter],
        run: &Run<'_>,
    ) -> Result<Self, FitError> {
        let mut next = shared.len();
        let mut places = Vec::new();
        for _ in &searches {
            let of_curve = free.iter().map(|parameter| {
                let among = shared.iter().position(|shared| shared == parameter);
                among.unwrap_or_else(|| {
                    next += 1;
                    next - 1
                })
            });
            places.push(of_curve.collect::<Vec<usize>>());
        }
        let mut unknowns = vec![0.0; next];
        let mut weights = vec![0.0; next];
        for (search, places) in searches.iter().zip(&places) {
            let covariance = search.covariance();
            for (number, place) in places.iter().enumerate() {
                let variance = covariance[number][number];
                // Not determined by this curve: it hardly counts.
                let is_known = variance > 0.0 && variance < 1.0;
                let weight = if is_known { 1.0 / variance } else { 1e-6 };
                unknowns[*place] += weight * search.unknowns[number];
                weights[*place] += weight;
            }
        }
        for (unknown, weight) in unknowns.iter_mut().zip(weights) {
            *unknown /= weight;
        }
        let mut joint = Self {
            searches,
            places,
            unknowns,
            linear: None,
            iterations: 0,
        };
        if let [search] = &joint.searches[..] {
            // The separate fit is the joint fit.
            joint.iterations = search.earlier_iterations + search.iterations;
            joint.unknowns = joint.gathered(std::slice::from_ref(&search.unknowns));
            joint.decompose()?;
            return Ok(joint);
        }
        for search in &mut joint.searches {
            search.iterations = 0;
        }
        if run.cancel.is_cancelled() {
            return Err(SolveError::Interrupted.into());
        }
        let states = joint.states_at(&joint.unknowns)?;
        joint.accept(joint.unknowns.clone(), states);
        joint.select();
        joint.check_enough()?;
        joint.linearise()?;
        Ok(joint)
    }

    /// Unknowns of one curve.
    fn of_curve(&self, curve: usize, unknowns: &[f64]) -> Vec<f64> {
        self.places[curve]
            .iter()
            .map(|place| unknowns[*place])
            .collect()
    }

    /// Unknowns of all curves from those of every curve.
    fn gathered(&self, unknowns: &[Vec<f64>]) -> Vec<f64> {
        let mut gathered = self.unknowns.clone();
        for (places, unknowns) in self.places.iter().zip(unknowns) {
            for (place, unknown) in places.iter().zip(unknowns) {
                gathered[*place] = *unknown;
            }
        }
        gathered
    }

    fn decompose(&mut self) -> Result<(), FitError> {
        let rows = self.weighted_derivatives();
        let linear = Linear::new(&rows, self.unknowns.len()).ok_or(FitError::NoDerivatives)?;
        self.linear = Some(linear);
        Ok(())
    }

    fn values(&self) -> usize {
        self.searches.iter().map(|search| search.data.len()).sum()
    }

    /// Leverages of the values of every curve in the joint fit.
    fn leverages(&self) -> Vec<Vec<f64>> {
        let count = self.values();
        let all = match &self.linear {
            Some(linear) => linear.leverages(count),
            None => vec![0.0; count],
        };
        let mut rest = &all[..];
        let mut leverages = Vec::new();
        for search in &self.searches {
            let (of, others) = rest.split_at(search.data.len());
            leverages.push(of.to_vec());
            rest = others;
        }
        leverages
    }

    fn has_scatter(&self) -> bool {
        self.searches.iter().any(Search::has_scatter)
    }

    fn freedom(&self) -> usize {
        self.values().saturating_sub(self.unknowns.len())
    }

    /// Test of the shared values against the separate fits.
    fn agreement(&self, snapshots: &[Snapshot], shared: usize) -> Agreement {
        let (mut increase, mut values, mut parameters) = (0.0, 0, 0);
        for (search, snapshot) in self.searches.iter().zip(snapshots) {
            for (datum, error, residual) in &snapshot.values {
                if search.states[datum.row].problem.is_some() {
                    continue;
                }
                let joint = datum.measured.value - search.computed(datum, &search.states);
                increase += (joint / error).powi(2) - (residual / error).powi(2);
            }
            values += snapshot.values.len();
            parameters += snapshot.parameters;
        }
        let estimated = snapshots.iter().any(|snapshot| snapshot.is_estimated);
        let rest = values.saturating_sub(parameters).max(1);
        let fewer = shared * (snapshots.len() - 1);
        Agreement::new(increase, fewer, estimated.then_some(rest))
    }

    fn answer(
        mut self,
        answered: Answered<'_>,
        given: &[(Measurements, FitOptions)],
    ) -> Result<JointFit, FitError> {
        let covariance = self.covariance();
        let freedom = self.freedom();
        let quantile = quantile(self.has_scatter().then_some(freedom));
        let leverages = self.leverages();
        let (groups, undetermined) = self.undetermined(&covariance, &answered);
        let is_determined = |place: usize| !groups.iter().any(|group| group.contains(&place));
        let correlation_of = |places: &[usize]| -> Vec<Vec<Option<f64>>> {
            let with = |a: usize, b: usize| {
                let sizes = (covariance[a][a] * covariance[b][b]).sqrt();
                let known = is_determined(a) && is_determined(b);
                known.then(|| match a == b {
                    true => 1.0,
                    false => covariance[a][b] / sizes,
                })
            };
            let row = |a: &usize| places.iter().map(|b| with(*a, *b)).collect();
            places.iter().map(row).collect()
        };
        let mut curves = Vec::new();
        let mut shared = Vec::new();
        let mut file = answered.file.clone();
        let mut chi_square = 0.0;
        for (curve, search) in self.searches.iter_mut().enumerate() {
            let places = &self.places[curve];
            // The tests of a curve are those of its residuals beyond its own linear fit.
            search.decompose()?;
            search.earlier_iterations = 0;
            search.iterations = self.iterations;
            let mut fit = search.answer(answered.termination)?;
            let starts = search.model.start()?;
            for (number, estimate) in fit.estimates.iter_mut().enumerate() {
                let deviation = larger(covariance[places[number]][places[number]], 0.0).sqrt();
                let known = is_determined(places[number]).then_some(deviation);
                let ends = search.lower_end(number, known, quantile);
                *estimate = search.estimate(number, starts[number], known, quantile, ends);
            }
            fit.correlation = correlation_of(places);
            fit.undetermined = Vec::new();
            let lost: f64 = leverages[curve].iter().sum();
            let rest = (search.data.len() as f64 - lost).round().max(0.0) as usize;
            fit.degrees_of_freedom = rest;
            if fit.misfit.chi_square_p_value.is_some() {
                let [above, below] = [misfit::chi_square_above, misfit::chi_square_below]
                    .map(|test| (rest > 0).then(|| test(fit.chi_square, rest)));
                fit.misfit.chi_square_p_value = above;
                fit.misfit.small_chi_square_p_value = below;
            }
            chi_square += fit.chi_square;
            if curve == 0 {
                let of = answered.shared.iter().filter_map(|parameter| {
                    let mut estimates = fit.estimates.iter();
                    estimates.find(|estimate| estimate.parameter == *parameter)
                });
                shared = of.cloned().collect();
                for estimate in &shared {
                    estimate.parameter.set(&mut file, estimate.value);
                }
            }
            curves.push(fit);
        }
        let names = answered.names.into_iter().zip(given);
        let free = match self.searches.first() {
            Some(search) => search.model.free.to_vec(),
            None => Vec::new(),
        };
        let given_errors = !self.has_scatter() && freedom > 0;
        let shared_places: Vec<usize> = (0..answered.shared.len()).collect();
        Ok(JointFit {
            free,
            correlation: correlation_of(&shared_places),
            shared,
            curves: names
                .zip(curves)
                .map(|((name, (data, _)), fit)| CurveFit {
                    name,
                    outcome: Ok(FittedData {
                        data: data.clone(),
                        fit,
                        wall_time: answered.wall_time,
                    }),
                })
                .collect(),
            undetermined,
            chi_square,
            degrees_of_freedom: freedom,
            chi_square_p_value: given_errors.then(|| misfit::chi_square_above(chi_square, freedom)),
            agreement: answered.agreement,
            separate: answered.separate,
            file,
            termination: answered.termination,
            iterations: self.iterations,
        })
    }

    /// Groups of unknowns that the data do not determine, and messages on them.
    fn undetermined(
        &self,
        covariance: &[Vec<f64>],
        answered: &Answered<'_>,
    ) -> (Vec<Vec<usize>>, Vec<String>) {
        let mut groups = self.linear.as_ref().map_or(Vec::new(), Linear::unseen);
        for (place, row) in covariance.iter().enumerate() {
            let is_large = larger(row[place], 0.0).sqrt() > LARGEST_DEVIATION;
            if is_large && !groups.iter().any(|group| group.contains(&place)) {
                groups.push(vec![place]);
            }
        }
        let name = |place: &usize| {
            if let Some(parameter) = answered.shared.get(*place) {
                return parameter.name().to_owned();
            }
            let mut curves = self.places.iter().zip(&self.searches).zip(&answered.names);
            let found = curves.find_map(|((places, search), name)| {
                let number = places.iter().position(|other| other == place)?;
                Some(format!("{} of {name}", search.model.free[number].name()))
            });
            found.unwrap_or_default()
        };
        let statement = |group: &Vec<usize>| {
            let names: Vec<String> = group.iter().map(name).collect();
            match &names[..] {
                [one] => format!("the curves together do not determine {one}"),
                several => format!(
                    "the curves together determine only a combination of {}: hold all but one of them, or share more",
                    several.join(" and ")
                ),
            }
        };
        let statements = groups.iter().map(statement).collect();
        (groups, statements)
    }
}

impl Search<'_> {
    /// The interval of an unknown with a smallest value, in linear approximation, if it would extend beyond this value.
    fn lower_end(&self, number: usize, deviation: Option<f64>, quantile: f64) -> Option<OneSided> {
        let deviation = deviation.filter(|_| self.model.free[number].is_work())?;
        let [least, _] = self.model.range(number, &self.unknowns);
        let unknown = self.unknowns[number];
        (unknown - quantile * deviation < least).then_some(OneSided {
            least,
            upper: unknown + quantile * deviation,
        })
    }
}

impl Descent for Joint<'_> {
    type States = Vec<Vec<State>>;

    fn unknowns(&self) -> &[f64] {
        &self.unknowns
    }

    fn iterations(&self) -> usize {
        self.iterations
    }

    fn count_iteration(&mut self) {
        self.iterations += 1;
        for search in &mut self.searches {
            search.count_iteration();
        }
    }

    fn chi_square(&self) -> f64 {
        self.searches.iter().map(Search::chi_square).sum()
    }

    fn weighted_residuals(&self) -> Vec<f64> {
        let searches = self.searches.iter();
        searches.flat_map(Descent::weighted_residuals).collect()
    }

    fn weighted_derivatives(&self) -> Vec<Vec<f64>> {
        let mut all = Vec::new();
        for (search, places) in self.searches.iter().zip(&self.places) {
            for row in search.weighted_derivatives() {
                let mut wide = vec![0.0; self.unknowns.len()];
                for (place, value) in places.iter().zip(row) {
                    wide[*place] = value;
                }
                all.push(wide);
            }
        }
        all
    }

    fn linear(&self) -> Option<&Linear> {
        self.linear.as_ref()
    }

    fn left_by(&self, step: &[f64]) -> Option<RangeEnd> {
        let mut curves = self.searches.iter().enumerate();
        curves.find_map(|(curve, search)| {
            let places = &self.places[curve];
            let end = search.left_by(&self.of_curve(curve, step))?;
            Some(match end {
                RangeEnd::Of(number) => RangeEnd::Of(places[number]),
                RangeEnd::Equal(both) => RangeEnd::Equal(both.map(|number| places[number])),
            })
        })
    }

    fn bounded(&self, step: Vec<f64>) -> Vec<f64> {
        let mut excess = 1.0;
        for (curve, search) in self.searches.iter().enumerate() {
            excess = larger(excess, search.excess(&self.of_curve(curve, &step)));
        }
        step.into_iter().map(|step| step / excess).collect()
    }

    fn moved(&self, step: &[f64]) -> Vec<f64> {
        let curves = self.searches.iter().enumerate();
        let moved = curves.map(|(curve, search)| search.moved(&self.of_curve(curve, step)));
        self.gathered(&moved.collect::<Vec<_>>())
    }

    fn states_at(&self, unknowns: &[f64]) -> Result<Self::States, FitError> {
        let curves = self.searches.iter().enumerate();
        curves
            .map(|(curve, search)| search.states_at(&self.of_curve(curve, unknowns)))
            .collect()
    }

    fn are_enough(&self, states: &Self::States) -> bool {
        let mut curves = self.searches.iter().zip(states);
        curves.all(|(search, states)| search.are_enough(states))
    }

    fn trial_chi_square(&self, states: &Self::States) -> f64 {
        let curves = self.searches.iter().zip(states);
        curves
            .map(|(search, states)| search.trial_chi_square(states))
            .sum()
    }

    fn promised(&self, step: &[f64]) -> f64 {
        let curves = self.searches.iter().enumerate();
        curves
            .map(|(curve, search)| search.promised(&self.of_curve(curve, step)))
            .sum()
    }

    fn accept(&mut self, unknowns: Vec<f64>, states: Self::States) {
        let of_curves: Vec<Vec<f64>> = (0..self.searches.len())
            .map(|curve| self.of_curve(curve, &unknowns))
            .collect();
        let curves = self
            .searches
            .iter_mut()
            .zip(of_curves.into_iter().zip(states));
        for (search, (unknowns, states)) in curves {
            search.accept(unknowns, states);
        }
        self.unknowns = unknowns;
    }

    fn leave_out(&mut self, states: &Self::States) -> Result<bool, FitError> {
        let mut changed = false;
        for (search, states) in self.searches.iter_mut().zip(states) {
            changed |= search.leave_out(states)?;
        }
        if changed {
            self.linearise()?;
        }
        Ok(changed)
    }

    fn select(&mut self) -> bool {
        let mut changed = false;
        for search in &mut self.searches {
            changed |= search.select();
        }
        changed
    }

    fn check_enough(&self) -> Result<(), FitError> {
        self.searches.iter().try_for_each(Search::check_enough)
    }

    /// As for a single curve; errors are estimated with the leverages of the joint fit.
    fn linearise(&mut self) -> Result<(), FitError> {
        for search in &mut self.searches {
            search.differentiate()?;
        }
        self.decompose()?;
        if self.has_scatter() {
            let leverages = self.leverages();
            for (search, leverages) in self.searches.iter_mut().zip(leverages) {
                search.estimate_scatter(&leverages)?;
                search.errors = search.with_errors()?;
            }
            self.decompose()?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agreement_by_tables() {
        // Upper 5 % points: chi-square with 3 degrees of freedom 7.815, F with 3 and 20 degrees of freedom 3.098 (NIST/SEMATECH
        // e-Handbook of Statistical Methods, 1.3.6.7.4 and 1.3.6.7.3).
        let known = Agreement::new(7.815, 3, None);
        assert!((known.p_value - 0.05).abs() < 1e-4, "{known:?}");
        let estimated = Agreement::new(3.0 * 3.098, 3, Some(20));
        assert!((estimated.statistic - 3.098).abs() < 1e-12);
        assert!((estimated.p_value - 0.05).abs() < 1e-4, "{estimated:?}");
        assert!((Agreement::new(-1e-9, 2, None).p_value - 1.0).abs() < 1e-12);
    }
}
