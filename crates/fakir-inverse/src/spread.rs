//! Scatter of the critical state of a pattern: sizes and moduli vary from sample to sample, pillars have different heights or
//! are missing, and the lens axis has any position on the lattice. With adhesive tops every sample is also unloaded, which
//! gives the scatter of pull-off force and hysteresis.
//!
//! On a height map every sample is solved again on its cells: pillars are drawn again with the sizes, heights and positions of the sample, and a map of
//! a file varies as a whole. The errors of the cells are stated for mean and standard deviation.
//!
//! In addition to the samples, the scatter to first order is computed from the exact derivatives of the critical
//! state.

use crate::derivative::ByKey;
use crate::sample::{SampleError, answers};
use chacha20::ChaCha12Rng;
use fakir::problem::{Arrangement, Disorder, Load, Point, Question};
use fakir::state::{Derivatives, Run, SolveError};
use fakir_case::unit::{Dimension, QuantityError, parse_plausible, parse_quantity};
use fakir_case::{AnyCase, CaseError, CaseFile, Key, Kind, SurfaceKind};
use fakir_study::{Column, Table, Values};
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

pub use crate::sample::{Critical, Numbers, PullOff};

/// A varying quantity, normally distributed about its value in the case file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Key of the quantity.
    pub key: Key,
    /// Its standard deviation.
    pub deviation: Deviation,
}

/// A standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Deviation {
    /// In SI units.
    Absolute(f64),
    /// As a fraction of the value.
    Relative(f64),
}

impl Deviation {
    /// Reads the standard deviation of a key: `"0.05 um"`, or `"3 %"` of its value. A number without a unit must be plausible; a deviation
    /// may be much smaller than the value.
    ///
    /// # Errors
    /// [`QuantityError`]
    pub fn parse(key: Key, text: &str) -> Result<Self, QuantityError> {
        if text.trim_end().ends_with('%') {
            parse_quantity(text, Dimension::Fraction).map(Self::Relative)
        } else {
            let usual = key.judged_by().map(|[least, most]| [1e-3 * least, most]);
            parse_plausible(text, key.dimension(), usual).map(Self::Absolute)
        }
    }
}

/// Position of the lens axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Landing {
    /// Anywhere on the lattice, uniformly distributed.
    #[default]
    Anywhere,
    /// As in the case file.
    AsGiven,
}

impl Landing {
    /// Name in results: `"anywhere"` or `"as_given"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Anywhere => "anywhere",
            Self::AsGiven => "as_given",
        }
    }
}

/// Settings of the samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampling {
    /// Varying quantities.
    pub tolerances: Vec<Tolerance>,
    /// Position of the lens axis.
    pub landing: Landing,
    /// Indentations, m, at which the force on every sample is computed too.
    pub indentations: Vec<f64>,
    /// Number of samples, at least 2.
    pub samples: usize,
    /// Seed of all random numbers. A sample depends only on it and on the number of the sample.
    pub seed: u64,
}

impl Sampling {
    /// Default number of samples.
    pub const SAMPLES: usize = 500;
    /// The same on a height map, where each takes seconds: the standard error of a standard deviation is then 10 % of it.
    pub const SAMPLES_ON_MAP: usize = 50;
    /// Default seed.
    pub const SEED: u64 = 1;

    /// Default number of samples about a case.
    #[must_use]
    pub fn default_samples(kind: SurfaceKind) -> usize {
        match kind {
            SurfaceKind::HeightMap => Self::SAMPLES_ON_MAP,
            SurfaceKind::Pillars | SurfaceKind::Asperities | SurfaceKind::Flat => Self::SAMPLES,
        }
    }
}

/// One sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Values of the varying quantities, in SI units, in the order of the tolerances.
    pub values: Vec<f64>,
    /// Number of draws before this one, which had an invalid value, such as a negative height.
    pub drawn_again: usize,
    /// Distance of the lens axis from a pillar centre, in pitches; 0 without a lattice.
    pub offset: f64,
    /// Direction of the offset, rad.
    pub offset_angle: f64,
    /// Seed of heights and missing pillars, `pattern.seed`; `None` if pillars do not scatter.
    pub pillar_seed: Option<u32>,
    /// Critical force, indentation and contact radius, or the reason why there are none.
    pub outcome: Result<Critical, String>,
    /// Forces (N) at the given indentations; empty for a sample without a critical state.
    pub forces: Vec<f64>,
    /// On a height map, all these numbers at the ends of the errors that are estimated for its cells, on the side of larger cells; `None` for other
    /// surfaces, and if the errors are not known.
    pub at_errors: Option<Numbers>,
}

/// Standard deviations of the critical state to first order in those of the varying quantities and of the heights of all pillars, from its exact
/// derivatives at the given position of the lens axis. The scatter of this position is not included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstOrder {
    /// Of the critical force, N.
    pub force: f64,
    /// Of the critical indentation, m.
    pub indentation: f64,
}

/// Samples and their scatter.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    /// Samples, in the order in which they were drawn.
    pub samples: Vec<Sample>,
    /// Scatter to first order, or the reason why there is none.
    pub first_order: Result<FirstOrder, String>,
    /// Keys of what is drawn besides the tolerances.
    drawn: Option<Drawn>,
    /// Whether the pillars are at random positions.
    is_random: bool,
}

/// Errors of a spread.
#[derive(Debug, thiserror::Error)]
pub enum SpreadError {
    /// Invalid case.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The computation was stopped.
    #[error("{}", fakir_case::with_keys(.0))]
    Solve(#[from] SolveError),
    /// Samples that are all the same.
    #[error(
        "nothing varies among the samples: give a tolerance, let pillars scatter with pattern.height_standard_deviation or pattern.vacancy_fraction, or let the lens land anywhere"
    )]
    NothingVaries,
    /// A key that is not a number of the case.
    #[error("{} has no tolerance: it must be a number that the case file gives", .0.path())]
    NotVariable(Key),
    /// A size that the table of pillars gives for every pillar.
    #[error(
        "{} has no tolerance here: the table gives it for every pillar, and this value is only the one to which indentations and results refer: leave the column out of the table", .0.path()
    )]
    OfTable(Key),
    /// A key is given twice.
    #[error("{} has two tolerances", .0.path())]
    Twice(Key),
    /// A deviation that is not greater than zero.
    #[error("the standard deviation of {} must be a number greater than 0", .0.path())]
    NotPositive(Key),
    /// A deviation so large that hardly any sample is valid.
    #[error("hardly any sample is possible: with these deviations {problem}: give smaller ones")]
    Impossible {
        /// Error of the samples.
        problem: String,
    },
    /// Random positions of the lens axis among listed pillars.
    #[error(
        "listed pillars have no cell in which a lens lands anywhere: vary pattern.axis_x and pattern.axis_y in its place"
    )]
    NoCell,
    /// The same on a height map.
    #[error(
        "a height map of a file has no cell in which a lens lands anywhere: let it land as given (--keep-offset; landing=\"as_given\" in Python)"
    )]
    NoCellOnMap,
    /// A height map without a floor.
    #[error(
        "the scatter is that of the critical state, and a height map has no pillars that define its floor: give surface.floor, the height at or below which it is"
    )]
    NoFloor,
    /// A key that no sample differs in.
    #[error(
        "{} has no tolerance: it is a count, a seed or a setting of the computation, not a quantity in which samples differ", .0.path()
    )]
    Setting(Key),
    /// A key that a height map does not have.
    #[error("{} has no tolerance: {}", key.path(), .instead)]
    NotOfMap {
        /// The key.
        key: Key,
        /// What is right in its place.
        instead: String,
    },
    /// Fewer than two samples.
    #[error("a spread takes at least 2 samples")]
    TooFew,
    /// An invalid indentation.
    #[error("there is no force at an indentation of {0} m: give finite lengths")]
    NoIndentation(f64),
}

/// Largest number of draws of one sample. Invalid values, such as a negative height, are drawn
/// again, which truncates the normal distribution.
const DRAWS: usize = 100;

/// Computes the critical states of samples drawn about a case, with the method of the case; with adhesive tops also
/// the unloading. `done` receives the number of finished samples.
///
/// # Errors
/// See [`SpreadError`]. Samples without a solution are not an error: they contain the reason.
pub fn spread(
    file: &CaseFile,
    sampling: &Sampling,
    run: &Run<'_>,
    done: &(dyn Fn(usize) + Sync),
) -> Result<Spread, SpreadError> {
    if sampling.samples < 2 {
        return Err(SpreadError::TooFew);
    }
    let case = file.any_case(&[Question::Spread])?;
    let arrangement = arrangement(&case)?;
    let varied = varied(file, &case, arrangement.as_ref(), &sampling.tolerances)?;
    if let AnyCase::HeightMap(file) = &case {
        if !file.defines_floor() {
            return Err(SpreadError::NoFloor);
        }
        // A surface that is too large, or a file that cannot be read.
        file.surface_case(run.memory_limit())?;
    }
    let cell = arrangement.as_ref().and_then(Cell::of);
    let is_anywhere = sampling.landing == Landing::Anywhere;
    let is_random = matches!(arrangement, Some(Arrangement::Random(_)));
    if cell.is_none() && is_anywhere && !is_random {
        return Err(match case {
            AnyCase::HeightMap(_) => SpreadError::NoCellOnMap,
            _ => SpreadError::NoCell,
        });
    }
    let disorder = arrangement.as_ref().and_then(disorder);
    if varied.is_empty() && disorder.is_none() && !is_anywhere && !is_random {
        return Err(SpreadError::NothingVaries);
    }
    let is_of_file = arrangement.is_none() && matches!(case, AnyCase::HeightMap(_));
    let drawn = (!is_of_file).then(|| Drawn::of(&case));
    if let Some(value) = sampling
        .indentations
        .iter()
        .find(|value| !value.is_finite())
    {
        return Err(SpreadError::NoIndentation(*value));
    }
    let first_order = first_order(file, &case, disorder, &varied, run)?;
    let count = AtomicUsize::new(0);
    // Threads share the samples; every sample is computed by one thread.
    let single = Run {
        pool: None,
        progress: None,
        ..run.clone()
    };
    let draw_sample = |number: usize| -> Result<Sample, SpreadError> {
        let sample = Draw {
            file,
            cell,
            drawn,
            varied: &varied,
            sampling,
            // Random pillars have other positions in every sample.
            scatters: disorder.is_some() || is_random && is_anywhere,
        }
        .sample(number, &single)?;
        done(count.fetch_add(1, Ordering::Relaxed) + 1);
        Ok(sample)
    };
    let samples: Result<Vec<_>, SpreadError> = match run.pool {
        Some(pool) => pool.install(|| {
            (0..sampling.samples)
                .into_par_iter()
                .map(draw_sample)
                .collect()
        }),
        None => (0..sampling.samples).map(draw_sample).collect(),
    };
    Ok(Spread {
        samples: samples?,
        first_order,
        drawn,
        is_random,
    })
}

/// The arrangement of the pillars; `None` for a height map of a file and a flat surface.
fn arrangement(case: &AnyCase) -> Result<Option<Arrangement>, CaseError> {
    Ok(match case {
        AnyCase::Pillars(case) => Some(case.system.arrangement().clone()),
        AnyCase::Asperities(case) => case.lattice().map(Arrangement::from),
        AnyCase::HeightMap(file) => file.surface_pattern()?.map(|it| it.arrangement),
        AnyCase::Flat(_) => None,
    })
}

/// Scatter of the pillars, if any.
fn disorder(arrangement: &Arrangement) -> Option<Disorder> {
    Some(arrangement.disorder()).filter(|disorder| !disorder.is_none())
}

/// Scatter to first order, or the reason why there is none.
fn first_order(
    file: &CaseFile,
    case: &AnyCase,
    disorder: Option<Disorder>,
    varied: &[(Key, f64, f64)],
    run: &Run<'_>,
) -> Result<Result<FirstOrder, String>, SpreadError> {
    if disorder.is_some_and(|disorder| disorder.missing > 0.0) {
        return Ok(Err("pillars are there or missing".to_owned()));
    }
    if varied.is_empty() && disorder.is_none() {
        return Ok(Err("only the place of landing varies".to_owned()));
    }
    let load = Load::FloorContact;
    let (found, height) = match case {
        AnyCase::Pillars(case) => {
            let found = fakir::gradient(&case.system, load, case.method, run);
            let found = found.map(|it| [it.force, it.indentation]);
            (found, case.system.pillar().height)
        }
        AnyCase::Asperities(case) => {
            let found = case.gradient(load, run).map(|it| it.gradient);
            (found.map(|it| [it.force, it.indentation]), case.height)
        }
        AnyCase::HeightMap(_) | AnyCase::Flat(_) => {
            return Ok(Err(
                "the critical state on this surface has no derivatives".to_owned()
            ));
        }
    };
    let [of_force, of_indentation] = match found {
        Err(SolveError::Interrupted) => return Err(SolveError::Interrupted.into()),
        Err(error) => return Ok(Err(error.to_string())),
        Ok(derivatives) => derivatives,
    };
    let by_key = ByKey::of_case(file, case)?;
    let height_deviation = disorder.map_or(0.0, |it| it.heights.standard_deviation() * height);
    let deviation = |derivatives: &Option<Derivatives>| -> Result<f64, String> {
        let derivatives = derivatives
            .as_ref()
            .ok_or_else(|| "there are no derivatives of it".to_owned())?;
        let heights = derivatives.heights.iter();
        let mut variance: f64 = heights
            .map(|(_, slope)| (slope * height_deviation).powi(2))
            .sum();
        for (key, _, deviation) in varied {
            let slope = by_key.of(derivatives, *key).ok_or_else(|| {
                format!("there are no derivatives with respect to {}", key.path())
            })?;
            variance += (slope * deviation).powi(2);
        }
        Ok(variance.sqrt())
    };
    let both = deviation(&of_force).and_then(|force| {
        let indentation = deviation(&of_indentation)?;
        Ok(FirstOrder { force, indentation })
    });
    Ok(both)
}

/// Varying keys, with mean and standard deviation.
fn varied(
    file: &CaseFile,
    case: &AnyCase,
    arrangement: Option<&Arrangement>,
    tolerances: &[Tolerance],
) -> Result<Vec<(Key, f64, f64)>, SpreadError> {
    let mut varied: Vec<(Key, f64, f64)> = Vec::new();
    for Tolerance { key, deviation } in tolerances {
        if key.is_setting() {
            return Err(SpreadError::Setting(*key));
        }
        if matches!(case, AnyCase::HeightMap(_))
            && let Some(instead) = instead_on_map(file, *key, arrangement.is_some())?
        {
            return Err(SpreadError::NotOfMap { key: *key, instead });
        }
        let mean = match key.kind() {
            Kind::Number(_) => file.given(*key)?,
            Kind::Word | Kind::Text | Kind::List(_) => None,
        };
        let mean = mean.ok_or(SpreadError::NotVariable(*key))?;
        if is_of_table(file, case, *key, mean) {
            return Err(SpreadError::OfTable(*key));
        }
        if varied.iter().any(|(other, _, _)| other == key) {
            return Err(SpreadError::Twice(*key));
        }
        let deviation = match deviation {
            Deviation::Absolute(value) => *value,
            Deviation::Relative(part) => part * mean,
        };
        if !(deviation > 0.0 && deviation.is_finite()) {
            return Err(SpreadError::NotPositive(*key));
        }
        varied.push((*key, mean, deviation));
    }
    Ok(varied)
}

/// Whether a size of the common pillar is that of no pillar, as the table gives those of all.
fn is_of_table(file: &CaseFile, case: &AnyCase, key: Key, value: f64) -> bool {
    if ![Key::PillarHeight, Key::PillarDiameter].contains(&key) {
        return false;
    }
    let mut other = file.clone();
    other.set_number(key, 1.001 * value);
    let (AnyCase::Pillars(case), Ok(AnyCase::Pillars(other))) = (case, other.any_case(&[])) else {
        return false;
    };
    let lists = [case.system.arrangement(), other.system.arrangement()];
    matches!(lists, [Arrangement::Listed(one), Arrangement::Listed(other)] if one == other)
}

/// What is right in the place of a key that a height map does not have; `None` for the keys that it has.
fn instead_on_map(
    file: &CaseFile,
    key: Key,
    has_pillars: bool,
) -> Result<Option<String>, CaseError> {
    if file.given(key)?.is_some() {
        return Ok(None);
    }
    let path = key.path();
    if has_pillars {
        let of_surface = path
            .strip_prefix("pattern.")
            .map(|it| format!("surface.{it}"));
        let of_surface = of_surface.filter(|path| Key::at(path).is_some());
        return Ok(of_surface.map(|path| format!("the pillars of a [surface] have {path}")));
    }
    let is_of_pillars = path.starts_with("pattern.") || key.is_of_surface();
    let of_file = [
        Key::HeightUnit,
        Key::HeightRange,
        Key::CellSize,
        Key::MapWidth,
        Key::Floor,
    ];
    Ok((is_of_pillars && !of_file.contains(&key)).then(|| {
        "the map of a file varies as a whole: give surface.height_unit or surface.height_range for the scale of its heights, surface.cell_size or \
         surface.width for its lengths, or a quantity of lens and substrate; for pillars that vary, describe them by surface.arrangement"
            .to_owned()
    }))
}

/// Keys of the position of the lens axis on a lattice and of the seed of its pillars.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Drawn {
    offset: Key,
    offset_angle: Key,
    seed: Key,
}

impl Drawn {
    fn of(case: &AnyCase) -> Self {
        match case {
            AnyCase::HeightMap(_) => Self {
                offset: Key::PatternOffset,
                offset_angle: Key::PatternOffsetAngle,
                seed: Key::Seed,
            },
            AnyCase::Pillars(_) | AnyCase::Asperities(_) | AnyCase::Flat(_) => Self {
                offset: Key::Offset,
                offset_angle: Key::OffsetAngle,
                seed: Key::PillarSeed,
            },
        }
    }
}

struct Draw<'a> {
    file: &'a CaseFile,
    /// Cell of the lattice; `None` for other arrangements.
    cell: Option<Cell>,
    /// Keys of what is drawn; `None` without pillars.
    drawn: Option<Drawn>,
    varied: &'a [(Key, f64, f64)],
    sampling: &'a Sampling,
    /// Whether the samples differ in the heights of their pillars or in missing pillars.
    scatters: bool,
}

impl Draw<'_> {
    fn sample(&self, number: usize, run: &Run<'_>) -> Result<Sample, SpreadError> {
        let mut random = stream(self.sampling.seed, number);
        let mut problem = String::new();
        for drawn_again in 0..DRAWS {
            let values: Vec<f64> = self
                .varied
                .iter()
                .map(|(_, mean, deviation)| {
                    let normal: f64 = StandardNormal.sample(&mut random);
                    mean + deviation * normal
                })
                .collect();
            let landing = self.land(&mut random);
            let mut file = self.file.clone();
            for ((key, _, _), value) in self.varied.iter().zip(&values) {
                file.set_number(*key, *value);
            }
            // A number of a case file represents 32 bits exactly.
            let pillar_seed = self
                .scatters
                .then(|| Distribution::<u32>::sample(&StandardUniform, &mut random));
            if let Some(drawn) = self.drawn {
                if self.sampling.landing == Landing::Anywhere && self.cell.is_some() {
                    file.set_number(drawn.offset, landing.0);
                    file.set_number(drawn.offset_angle, landing.1);
                }
                if let Some(seed) = pillar_seed {
                    file.set_number(drawn.seed, f64::from(seed));
                }
            }
            let case = match file.any_case(&[]) {
                Ok(case) => case,
                Err(error) => {
                    problem = error.one_line();
                    continue;
                }
            };
            let found = match answers(&case, &self.sampling.indentations, run) {
                Err(SampleError::Case(error)) => {
                    problem = error.one_line();
                    continue;
                }
                Err(SampleError::Solve(SolveError::Interrupted)) => {
                    return Err(SolveError::Interrupted.into());
                }
                Err(SampleError::Solve(error)) => Err(error.to_string()),
                Ok(found) => found,
            };
            let (offset, offset_angle) = landed(&case)?;
            let mut sample = Sample {
                values,
                drawn_again,
                offset,
                offset_angle,
                pillar_seed,
                outcome: Err(String::new()),
                forces: Vec::new(),
                at_errors: None,
            };
            sample.outcome = found.map(|found| {
                sample.forces = found.numbers.forces;
                sample.at_errors = found.at_errors;
                found.numbers.critical
            });
            return Ok(sample);
        }
        Err(SpreadError::Impossible { problem })
    }

    /// A position on the lattice, as distance (pitches) and direction from the nearest pillar:
    /// uniformly distributed over a parallelogram of lattice vectors, which is one cell.
    fn land(&self, random: &mut ChaCha12Rng) -> (f64, f64) {
        let [u, v]: [f64; 2] =
            std::array::from_fn(|_| Distribution::<f64>::sample(&StandardUniform, random));
        let Some(Cell { vectors, pitch }) = self.cell else {
            return (0.0, 0.0);
        };
        let at = |u: f64, v: f64| [0, 1].map(|k| u * vectors[0][k] + v * vectors[1][k]);
        let point = at(u, v);
        // Relative to the nearest corner of the cell, where the pillars are.
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(i, j)| at(i, j));
        let from = |corner: Point| [point[0] - corner[0], point[1] - corner[1]];
        let away = |[x, y]: &Point| x.hypot(*y);
        let nearest = corners.map(from).into_iter();
        let nearest = nearest.min_by(|one, other| away(one).total_cmp(&away(other)));
        let [x, y] = nearest.unwrap_or(point);
        (x.hypot(y) / pitch, y.atan2(x))
    }
}

/// A cell of a lattice.
#[derive(Debug, Clone, Copy)]
struct Cell {
    /// Its sides, m.
    vectors: [Point; 2],
    /// The pitch, m.
    pitch: f64,
}

impl Cell {
    /// `None` for listed and random pillars.
    fn of(arrangement: &Arrangement) -> Option<Self> {
        let form = arrangement.lattice()?.form;
        Some(Self {
            vectors: form.vectors(),
            pitch: form.pitch(),
        })
    }
}

/// Position of the lens axis on a lattice: distance (pitches) and direction (rad) from a pillar.
fn landed(case: &AnyCase) -> Result<(f64, f64), CaseError> {
    let lattice = arrangement(case)?.and_then(|it| it.lattice());
    Ok(lattice.map_or((0.0, 0.0), |lattice| (lattice.offset, lattice.offset_angle)))
}

/// Random numbers of one sample.
fn stream(seed: u64, number: usize) -> ChaCha12Rng {
    use chacha20::rand_core::SeedableRng;
    let mut random = ChaCha12Rng::seed_from_u64(seed);
    random.set_stream(number as u64);
    random
}

/// Location and width of a distribution, estimated from samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub deviation: f64,
    /// Estimated errors of mean and standard deviation due to the cells of a height map: the mean of the estimated errors, and the change of the
    /// deviation if every sample is moved by its error, towards its value on larger cells. Without the error of a finite number of samples.
    /// `None` for other surfaces.
    pub errors: Option<[f64; 2]>,
    /// Percentages and their percentiles.
    pub percentiles: Vec<(f64, f64)>,
}

/// Percentages whose percentiles are computed.
pub const PERCENTAGES: [f64; 7] = [2.5, 5.0, 25.0, 50.0, 75.0, 95.0, 97.5];

impl Spread {
    /// Whether the pillars are at random positions, among which the lens lands in the place of a cell of a lattice.
    #[must_use]
    pub fn is_among_random_pillars(&self) -> bool {
        self.is_random
    }

    /// The critical states that were found.
    pub fn found(&self) -> impl Iterator<Item = &Critical> {
        self.samples
            .iter()
            .filter_map(|sample| sample.outcome.as_ref().ok())
    }

    /// Number of draws with an invalid value, which were drawn again: the distribution is truncated there.
    #[must_use]
    pub fn drawn_again(&self) -> usize {
        self.samples.iter().map(|sample| sample.drawn_again).sum()
    }

    /// A warning if values were drawn again.
    #[must_use]
    pub fn truncation(&self) -> Option<String> {
        let again = self.drawn_again();
        (again > 0).then(|| {
            format!(
                "{again} of {} draws had a value that is not valid, as a negative length or a Poisson's ratio above 0.5, and were drawn again: the normal \
                 distributions are truncated there, and their means are shifted",
                again + self.samples.len()
            )
        })
    }

    /// Reasons for samples without a solution.
    pub fn failures(&self) -> impl Iterator<Item = &str> {
        self.samples
            .iter()
            .filter_map(|sample| sample.outcome.as_ref().err().map(String::as_str))
    }

    /// Table `samples.csv`: the values drawn for every sample and its critical state, or the reason
    /// why there is none.
    #[must_use]
    pub fn table(&self, sampling: &Sampling) -> Table {
        let samples = || self.samples.iter();
        let numbers = |name: String, values: Vec<Option<f64>>| Column {
            name,
            values: Values::Numbers(values),
        };
        let mut columns = vec![Column {
            name: "sample".to_owned(),
            values: Values::Counts((0..).map(Some).take(self.samples.len()).collect()),
        }];
        for (number, tolerance) in sampling.tolerances.iter().enumerate() {
            columns.push(numbers(
                tolerance.key.column(),
                samples()
                    .map(|sample| Some(sample.values[number]))
                    .collect(),
            ));
        }
        let drawn = |name: &str, of: fn(&Sample) -> f64| {
            let values = samples().map(|sample| Some(of(sample)));
            numbers(name.to_owned(), values.collect())
        };
        let found = |name: &str, of: fn(&Critical) -> f64| {
            let value = |sample: &Sample| sample.outcome.as_ref().ok().map(of);
            let values = samples().map(|sample| value(sample).filter(|it| it.is_finite()));
            numbers(name.to_owned(), values.collect())
        };
        if let Some(keys) = self.drawn {
            columns.extend([
                drawn(&keys.offset.column(), |sample| sample.offset),
                drawn(&keys.offset_angle.column(), |sample| sample.offset_angle),
            ]);
            if samples().any(|sample| sample.pillar_seed.is_some()) {
                let seeds = samples().map(|sample| sample.pillar_seed.map(i64::from));
                columns.push(Column {
                    name: keys.seed.column(),
                    values: Values::Counts(seeds.collect()),
                });
            }
        }
        columns.extend([
            found("critical_force_N", |critical| critical.force),
            found("critical_indentation_m", |critical| critical.indentation),
            found("critical_contact_radius_m", |critical| {
                critical.contact_radius
            }),
        ]);
        if self.is_adhesive() {
            let pulled = |name: &str, of: fn(&PullOff) -> f64| {
                let value = |sample: &Sample| Some(of(&sample.outcome.as_ref().ok()?.pull_off?));
                numbers(name.to_owned(), samples().map(value).collect())
            };
            columns.extend([
                pulled("pull_off_force_N", |pull_off| pull_off.force),
                pulled("hysteresis_J", |pull_off| pull_off.hysteresis),
            ]);
        }
        for (number, indentation) in sampling.indentations.iter().enumerate() {
            let forces = samples().map(|sample| sample.forces.get(number).copied());
            columns.push(numbers(force_column(*indentation), forces.collect()));
        }
        let problem = |sample: &Sample| sample.outcome.as_ref().err().cloned();
        columns.push(Column {
            name: "problem".to_owned(),
            values: Values::Words(
                samples()
                    .map(|sample| Some(problem(sample).unwrap_or_default()))
                    .collect(),
            ),
        });
        Table { columns }
    }

    /// Mean, standard deviation and percentiles of one value of the critical states; `None` for
    /// fewer than two of them, and of the contact radius of a plate.
    pub fn summary(&self, pick: impl Fn(&Critical) -> f64) -> Option<Summary> {
        self.summary_of(|it| Some(pick(&it.critical)))
    }

    /// Mean, standard deviation and percentiles of one value of the unloading; `None` without adhesion.
    pub fn pull_off_summary(&self, pick: impl Fn(&PullOff) -> f64) -> Option<Summary> {
        self.summary_of(|it| it.critical.pull_off.as_ref().map(&pick))
    }

    /// Mean, standard deviation and percentiles of the force at one of the given indentations, by its index.
    #[must_use]
    pub fn force_summary(&self, place: usize) -> Option<Summary> {
        self.summary_of(|it| it.forces.get(place).copied())
    }

    /// Whether the samples were unloaded.
    #[must_use]
    pub fn is_adhesive(&self) -> bool {
        self.found().any(|critical| critical.pull_off.is_some())
    }

    /// Former name of [`is_adhesive`](Self::is_adhesive).
    #[deprecated(note = "renamed to `is_adhesive`")]
    #[must_use]
    pub fn sticks(&self) -> bool {
        self.is_adhesive()
    }

    fn summary_of(&self, pick: impl Fn(&Numbers) -> Option<f64>) -> Option<Summary> {
        let numbers = |sample: &Sample| {
            Some(Numbers {
                critical: *sample.outcome.as_ref().ok()?,
                forces: sample.forces.clone(),
            })
        };
        let found = || self.samples.iter().filter(|it| it.outcome.is_ok());
        let values = found().filter_map(|it| pick(&numbers(it)?));
        let mut values: Vec<f64> = values.collect();
        if values.len() < 2 || values.iter().any(|value| value.is_nan()) {
            return None;
        }
        let at_errors: Option<Vec<f64>> = found().map(|it| pick(it.at_errors.as_ref()?)).collect();
        let at_errors = at_errors.map(|moved| {
            // Errors of both signs need not cancel in the mean: larger cells may hide a common one.
            let changes = moved.iter().zip(&values);
            let of_mean = changes.map(|(one, other)| (one - other).abs()).sum::<f64>();
            let (_, deviation) = mean_and_deviation(&moved);
            (of_mean / moved.len() as f64, deviation)
        });
        values.sort_by(f64::total_cmp);
        let (mean, deviation) = mean_and_deviation(&values);
        Some(Summary {
            mean,
            deviation,
            errors: at_errors.map(|(of_mean, at_errors)| [of_mean, (at_errors - deviation).abs()]),
            percentiles: PERCENTAGES
                .map(|percentage| (percentage, percentile(&values, percentage)))
                .to_vec(),
        })
    }
}

/// Mean, and standard deviation of a sample.
fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0)).sqrt())
}

/// Name of the column of forces at an indentation (m): `force_at_1.5_um_N`.
fn force_column(indentation: f64) -> String {
    // Rounded to the picometre, to remove rounding errors of the unit.
    let micrometres = (indentation * 1e12).round() / 1e6;
    format!("force_at_{micrometres}_um_N")
}

/// Percentile of sorted values, with linear interpolation (definition 7 of R. J. Hyndman, Y. Fan,
/// Am. Stat. 50, 361 (1996)).
fn percentile(sorted: &[f64], percentage: f64) -> f64 {
    let position = percentage / 100.0 * (sorted.len() - 1) as f64;
    let below = sorted[position.floor() as usize];
    let above = sorted[position.ceil() as usize];
    below + (above - below) * position.fract()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir_case::Case;

    fn file() -> CaseFile {
        let mut file = CaseFile::parse("paper", &Case::example().to_toml()).unwrap();
        file.set_number(Key::SurfaceFraction, 1e-3);
        file.set_number(Key::PillarHeight, 1e-6);
        file
    }

    fn sampling(tolerances: Vec<Tolerance>, landing: Landing, samples: usize) -> Sampling {
        Sampling {
            tolerances,
            landing,
            indentations: Vec::new(),
            samples,
            seed: 1,
        }
    }

    /// All forces scale with both moduli: their relative scatter is that of the moduli.
    #[test]
    fn a_spread_of_the_moduli_is_a_spread_of_the_force() {
        let tolerance = Tolerance {
            key: Key::SubstrateYoungModulus,
            deviation: Deviation::Relative(0.1),
        };
        let mut stiff_lens = file();
        stiff_lens.set_number(Key::LensYoungModulus, 1e15);
        let sampling = sampling(vec![tolerance], Landing::AsGiven, 400);
        let spread = spread(&stiff_lens, &sampling, &Run::default(), &|_| {}).unwrap();
        let case = stiff_lens.case().unwrap();
        let modulus = case.system.substrate().young_modulus;
        let reference = fakir::transition(&case.system, case.method, &Run::default()).unwrap();
        for sample in &spread.samples {
            let force = sample.outcome.as_ref().unwrap().force;
            let expected = reference.contact.force * sample.values[0] / modulus;
            assert!((force / expected - 1.0).abs() < 1e-6);
        }
        let summary = spread.summary(|critical| critical.force).unwrap();
        let relative = summary.deviation / reference.contact.force;
        // Four standard errors: 0.1/sqrt(2 * 400) and 0.1/sqrt(400).
        assert!((relative - 0.1).abs() < 0.015, "{relative}");
        assert!((summary.mean / reference.contact.force - 1.0).abs() < 0.02);
    }

    /// At an indentation of 0.1 nm the lens touches four of the finest cells of the mesh, and none of the cells that are twice
    /// as large.
    #[test]
    fn samples_whose_numbers_are_not_resolved_fail() {
        let mut coarse = file();
        for setting in ["method.name=love", "method.cells_per_diameter=8"] {
            coarse.set(setting).unwrap();
        }
        let tolerance = Tolerance {
            key: Key::SubstrateYoungModulus,
            deviation: Deviation::Relative(0.1),
        };
        let at = |indentation: f64| {
            let sampling = Sampling {
                indentations: vec![indentation],
                ..sampling(vec![tolerance], Landing::AsGiven, 2)
            };
            spread(&coarse, &sampling, &Run::default(), &|_| {}).unwrap()
        };
        assert_eq!(at(1e-7).failures().count(), 0);
        let doubtful = at(1e-10);
        let problems: Vec<&str> = doubtful.failures().collect();
        assert_eq!(problems.len(), 2);
        assert!(
            problems[0].contains("the force is not resolved"),
            "{problems:?}"
        );
    }

    /// Moments of a uniform distribution over a hexagonal cell: the mean of the squared distance
    /// from its middle is 5/36 e^2 (second moment of a regular hexagon of inradius e/2).
    #[test]
    fn the_lens_lands_uniformly_on_the_cell() {
        let case = file().case().unwrap();
        let sampling = sampling(Vec::new(), Landing::Anywhere, 2);
        let draw = Draw {
            file: &file(),
            cell: Cell::of(case.system.arrangement()),
            drawn: None,
            varied: &[],
            sampling: &sampling,
            scatters: false,
        };
        let count = 20_000;
        let offsets: Vec<(f64, f64)> = (0..count).map(|k| draw.land(&mut stream(7, k))).collect();
        let mean =
            |f: &dyn Fn(&(f64, f64)) -> f64| offsets.iter().map(f).sum::<f64>() / count as f64;
        assert!((mean(&|o| o.0 * o.0) - 5.0 / 36.0).abs() < 4.0 * 0.1 / (count as f64).sqrt());
        assert!(mean(&|o| (6.0 * o.1).cos()).abs() < 0.2);
        assert!(mean(&|o| o.1.cos()).abs() < 4.0 / (count as f64).sqrt());
        assert!(offsets.iter().all(|o| o.0 <= 1.0 / 3f64.sqrt() + 1e-12));
    }

    /// A square lattice of phi = 0.03 with scattered pillars and the lens axis off all symmetry lines.
    fn scattered(height_spread: f64, missing: f64) -> CaseFile {
        let mut file = CaseFile::parse("square", &Case::example().to_toml()).unwrap();
        file.set("pattern.lattice=square").unwrap();
        file.set_number(Key::SurfaceFraction, 0.03);
        file.set_number(Key::Offset, 0.3);
        file.set_number(Key::OffsetAngle, 0.35);
        file.set_number(Key::HeightStandardDeviation, height_spread);
        file.set_number(Key::VacancyFraction, missing);
        file
    }

    /// Every pillar of every sample has a separate height, and small deviations change the critical state as its
    /// derivatives predict.
    #[test]
    #[ignore = "slow: many samples"]
    fn heights_of_pillars_scatter_to_first_order() {
        let file = scattered(2e-3, 0.0);
        let tolerance = Tolerance {
            key: Key::SubstrateYoungModulus,
            deviation: Deviation::Relative(1e-3),
        };
        let sampling = Sampling {
            indentations: vec![3e-6],
            ..sampling(vec![tolerance], Landing::AsGiven, 60)
        };
        let spread = spread(&file, &sampling, &Run::default(), &|_| {}).unwrap();
        assert_eq!(spread.found().count(), 60);
        let first_order = spread.first_order.clone().unwrap();
        for (found, expected) in [
            (spread.summary(|it| it.force), first_order.force),
            (spread.summary(|it| it.indentation), first_order.indentation),
        ] {
            let ratio = found.unwrap().deviation / expected;
            println!("{ratio}");
            // Three standard errors of a deviation, 1/sqrt(2 * 59).
            assert!((ratio - 1.0).abs() < 3.0 / 118f64.sqrt(), "{ratio}");
        }
        // Each sample equals the case with its seed and values.
        for sample in &spread.samples[..2] {
            let mut file = file.clone();
            file.set_number(Key::PillarSeed, f64::from(sample.pillar_seed.unwrap()));
            file.set_number(Key::SubstrateYoungModulus, sample.values[0]);
            let case = file.case().unwrap();
            let control = Load::Indentation(3e-6);
            let state = fakir::press(&case.system, control, case.method, &Run::default());
            assert_eq!(sample.forces, [state.unwrap().force]);
        }
        let table = spread.table(&sampling).to_csv();
        let head = table.lines().next().unwrap();
        assert!(
            head.contains("pattern.seed") && head.contains("force_at_3_um_N"),
            "{head}"
        );
    }

    /// Different pillars are missing in each sample.
    #[test]
    fn vacancies_are_redrawn_in_every_sample() {
        let sampling = sampling(Vec::new(), Landing::AsGiven, 8);
        let spread = spread(&scattered(0.0, 0.1), &sampling, &Run::default(), &|_| {}).unwrap();
        let forces: Vec<f64> = spread.found().map(|critical| critical.force).collect();
        assert_eq!(forces.len(), 8);
        let (least, most) = forces
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(a, b), f| (a.min(*f), b.max(*f)));
        assert!(most > 1.05 * least, "{least} {most}");
        assert!(spread.first_order.is_err());
    }

    #[test]
    fn samples_do_not_depend_on_threads() {
        let tolerance = Tolerance {
            key: Key::PillarHeight,
            deviation: Deviation::Absolute(0.05e-6),
        };
        let sampling = sampling(vec![tolerance], Landing::Anywhere, 20);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(2)
            .build()
            .unwrap();
        let shared = Run {
            pool: Some(&pool),
            ..Run::default()
        };
        let alone = spread(&file(), &sampling, &Run::default(), &|_| {}).unwrap();
        assert_eq!(alone, spread(&file(), &sampling, &shared, &|_| {}).unwrap());
        assert!(alone.found().count() == 20);
    }

    #[test]
    fn what_cannot_vary_is_refused() {
        let ask = |tolerances| {
            let sampling = sampling(tolerances, Landing::AsGiven, 2);
            spread(&file(), &sampling, &Run::default(), &|_| {}).unwrap_err()
        };
        let tolerance = |key, part| Tolerance {
            key,
            deviation: Deviation::Relative(part),
        };
        let twice = vec![tolerance(Key::PillarHeight, 0.1); 2];
        assert!(matches!(ask(twice), SpreadError::Twice(_)));
        let word = vec![tolerance(Key::MethodName, 0.1)];
        assert!(matches!(ask(word), SpreadError::NotVariable(_)));
        let absent = vec![tolerance(Key::Pitch, 0.1)];
        assert!(matches!(ask(absent), SpreadError::NotVariable(_)));
        let none = vec![tolerance(Key::PillarHeight, 0.0)];
        assert!(matches!(ask(none), SpreadError::NotPositive(_)));
    }

    #[test]
    fn percentiles_between_samples() {
        // Definition 7 on 1, 2, 3, 4: the median is 2.5, the quartiles 1.75 and 3.25.
        let sorted = [1.0, 2.0, 3.0, 4.0];
        for (percentage, expected) in [(25.0, 1.75), (50.0, 2.5), (75.0, 3.25), (100.0, 4.0)] {
            assert!((percentile(&sorted, percentage) - expected).abs() < 1e-15);
        }
    }
}
