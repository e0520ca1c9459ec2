//! What a fit presses a lens on: pillars with flat or rounded tops, a height map, or a flat surface.

use super::error::FitError;
use super::parameter::Parameter;
use fakir::problem::{Adhesion, CyclePlan, Feature, FloorModel, Load, Question, Solver};
use fakir::state::{AsperityCycle, Cycle, FlatCycle, Limit, Run, SolveError};
use fakir_case::{
    AsperityCase, Case, CaseError, CaseFile, FlatCase, Key, Setting, SurfaceBodies, SurfaceCase,
};
use fakir_study::approach::Loadable;
use fakir_study::result::{asperity_cycle_warnings, cycle_warnings};
use fakir_study::surfaces::on_wide_enough_a_grid;

/// Name of the method on height maps.
pub(super) const MAP: &str = "love";

/// A case that can be fitted.
#[derive(Debug, Clone)]
pub(super) enum Subject {
    Pillars(Box<Case>),
    Asperities(Box<Tops>),
    HeightMap(Box<Map>),
    Flat(Box<FlatCase>),
}

/// Pillars with rounded tops.
#[derive(Debug, Clone)]
pub(super) struct Tops {
    pub(super) case: AsperityCase,
    /// Numbers of the keys that are given, in SI units.
    numbers: Vec<(Key, f64)>,
}

/// A height map, which is read or generated only for its loading curve.
#[derive(Debug, Clone)]
pub(super) struct Map {
    pub(super) file: CaseFile,
    bodies: SurfaceBodies,
    numbers: Vec<(Key, f64)>,
}

impl Subject {
    pub(super) fn of(file: &CaseFile) -> Result<Self, CaseError> {
        Ok(if file.is_flat() {
            Self::Flat(Box::new(file.flat_case()?))
        } else if file.is_surface() {
            Self::HeightMap(Box::new(Map {
                bodies: file.surface_bodies()?,
                numbers: numbers(file)?,
                file: file.clone(),
            }))
        } else if file.is_rounded() {
            Self::Asperities(Box::new(Tops {
                case: file.asperity_case()?,
                numbers: numbers(file)?,
            }))
        } else {
            Self::Pillars(Box::new(file.case()?))
        })
    }

    /// Reduced modulus, Pa.
    pub(super) fn reduced_modulus(&self) -> f64 {
        match self {
            Self::Pillars(case) => case.system.reduced_modulus(),
            Self::Asperities(tops) => tops.case.field.reduced_modulus(),
            Self::HeightMap(map) => map.bodies.reduced_modulus,
            Self::Flat(case) => case.system.reduced_modulus(),
        }
    }

    /// Whether there are pillars with flat tops.
    pub(super) fn has_pillars(&self) -> bool {
        matches!(self, Self::Pillars(_))
    }

    /// Whether the modulus of the substrate matters besides the reduced modulus: for columns.
    pub(super) fn has_columns(&self) -> bool {
        match self {
            Self::Pillars(_) => true,
            Self::Asperities(tops) => {
                let mut asperities = tops.case.field.asperities().iter();
                asperities.any(|asperity| asperity.column_compliance > 0.0)
            }
            Self::HeightMap(map) => map.bodies.has_columns,
            Self::Flat(_) => false,
        }
    }

    /// Indentation below which nothing is touched, m; of a height map only its loading curve contains it.
    pub(super) fn first_touch(&self) -> f64 {
        match self {
            Self::Pillars(_) | Self::Flat(_) => 0.0,
            Self::Asperities(tops) => tops.case.field.first_touch(),
            Self::HeightMap(_) => f64::NEG_INFINITY,
        }
    }

    /// Refuses histories of viscoelastic bodies that are not supported: those with adhesion.
    pub(super) fn check_history(&self) -> Result<(), SolveError> {
        match self {
            Self::Pillars(case) => case.check_history(),
            Self::Asperities(tops) => tops.case.check_history(),
            Self::HeightMap(_) => Ok(()),
            Self::Flat(case) => case.check_history(),
        }
    }

    /// Name of the method in JSON.
    pub(super) fn method_name(&self) -> &'static str {
        match self {
            Self::Pillars(case) => case.method.name(),
            Self::Asperities(_) => "rounded tops",
            Self::HeightMap(_) => MAP,
            Self::Flat(_) => "flat",
        }
    }

    /// Whether a key has a value.
    pub(super) fn has(&self, key: Key) -> bool {
        match self {
            Self::Pillars(case) => case.setting(key).is_some(),
            Self::Asperities(_) | Self::HeightMap(_) => self.number(key).is_some(),
            Self::Flat(case) => case.setting(key).is_some(),
        }
    }

    /// Finite number of a key, in SI units.
    pub(super) fn number(&self, key: Key) -> Option<f64> {
        match self {
            Self::Pillars(case) => case.number(key),
            Self::Asperities(tops) => among(&tops.numbers, key),
            Self::HeightMap(map) => among(&map.numbers, key),
            Self::Flat(case) => match case.setting(key) {
                Some(Setting::Number(value)) => Some(value).filter(|value| value.is_finite()),
                _ => None,
            },
        }
    }

    pub(super) fn adhesion(&self) -> Adhesion {
        match self {
            Self::Pillars(case) => case.system.adhesion(),
            Self::Asperities(tops) => tops.case.field.adhesion(),
            Self::HeightMap(_) => Adhesion::NONE,
            Self::Flat(case) => case.system.adhesion(),
        }
    }

    /// Half the distance of neighbouring pillars, m; 0 on a flat surface, where the contact radius has no jumps, and on height maps, where it
    /// is not compared.
    pub(super) fn half_pitch(&self) -> f64 {
        match self {
            Self::Pillars(case) => 0.5 * case.system.pitch(),
            Self::Asperities(tops) => 0.5 * tops.case.spacing(),
            Self::HeightMap(_) | Self::Flat(_) => 0.0,
        }
    }

    /// Length (m) below which no contact radius is of interest.
    pub(super) fn least_radius(&self) -> f64 {
        match self {
            Self::Pillars(case) => 0.5 * case.system.pillar().diameter,
            Self::Asperities(_) => 1e-3 * self.number(Key::TopRadius).unwrap_or(1e-3),
            Self::HeightMap(_) | Self::Flat(_) => {
                1e-3 * self.number(Key::LensRadius).unwrap_or(1e-3)
            }
        }
    }

    /// Gap between the lens and the floor at an indentation before contact, m; none without a floor.
    pub(super) fn gap_before_contact(&self, indentation: f64) -> Option<f64> {
        match self {
            Self::Pillars(case) => Some(case.system.pillar().height - indentation),
            Self::Asperities(_) | Self::HeightMap(_) | Self::Flat(_) => None,
        }
    }

    /// Limits of the model in the contact under a load.
    pub(super) fn limits(&self, load: Load, run: &Run<'_>) -> Result<Vec<Limit>, FitError> {
        Ok(match self {
            Self::Pillars(case) => fakir::press(&case.system, load, case.method, run)?.limits(None),
            Self::Asperities(tops) => {
                let AsperityCase {
                    field, accuracy, ..
                } = &tops.case;
                field.press(load, *accuracy, run)?.limits(field, None)
            }
            Self::HeightMap(map) => {
                let solve = |case: &SurfaceCase| {
                    let contact = case.system.press(load, run)?;
                    Ok(contact.limits(&case.system, None))
                };
                let memory = run.memory_limit();
                on_wide_enough_a_grid(&map.file, memory, FitError::needed_width, solve)?.answer
            }
            Self::Flat(case) => case.system.press(load, run)?.limits(&case.system, None),
        })
    }

    /// The cycle of a plan. A cycle requires adhesion: without any, the smallest possible work is used, which has no visible effect.
    pub(super) fn cycle(&self, plan: CyclePlan, run: &Run<'_>) -> Result<FittedCycle, SolveError> {
        Ok(match self {
            Self::Pillars(case) => {
                let system = case.system.with_adhesion(some(self.adhesion()));
                let mut system = system.map_err(SolveError::from)?;
                // Rows past the transition are left out, and the floor between the tops takes most of the time.
                if !system.adhesion().floor {
                    system = system.with_floor(FloorModel::Ignored);
                }
                let cycle = fakir::cycle(&system, plan, case.method, run)?;
                FittedCycle::Pillars(Box::new(cycle))
            }
            Self::Asperities(tops) => {
                let mut case = tops.case.clone();
                let adhesion = some(self.adhesion());
                case.field = case
                    .field
                    .with_adhesion(adhesion)
                    .map_err(SolveError::from)?;
                let cycle = case.field.cycle(plan, case.accuracy, run)?;
                FittedCycle::Asperities(Box::new((case, cycle)))
            }
            Self::HeightMap(_) => {
                let adhesive = [Feature::AdhesiveTops];
                let refused = Question::Fit.check(Solver::HeightMap, &adhesive);
                return Err(refused.err().map_or(SolveError::NoFloor, Into::into));
            }
            Self::Flat(case) => {
                let system = case.system.clone().with_adhesion(some(self.adhesion()));
                let system = system.map_err(SolveError::from)?;
                let cycle = system.cycle(&plan, run)?;
                let limits = cycle.turn.limits(&system, None);
                FittedCycle::Flat(Box::new(cycle), limits)
            }
        })
    }
}

/// The finite numbers of a file among the keys that can be fitted.
fn numbers(file: &CaseFile) -> Result<Vec<(Key, f64)>, CaseError> {
    let mut numbers = Vec::new();
    for parameter in Parameter::ALL {
        if let Parameter::Key(key) = parameter
            && let Some(value) = file.given(key)?.filter(|value| value.is_finite())
        {
            numbers.push((key, value));
        }
    }
    Ok(numbers)
}

fn among(numbers: &[(Key, f64)], key: Key) -> Option<f64> {
    let mut numbers = numbers.iter();
    numbers
        .find(|(given, _)| *given == key)
        .map(|(_, value)| *value)
}

/// Whether the bodies of a case are viscoelastic or their relaxation is free, so that the rows are a history over time, to which pauses belong.
///
/// # Errors
/// An invalid relaxation.
pub fn has_relaxation(file: &CaseFile, free: &[Parameter]) -> Result<bool, CaseError> {
    let is_free = free.iter().any(|parameter| parameter.is_of_relaxation());
    Ok(is_free || file.relaxation()?.is_some())
}

/// Name of the method of fits with a case: that of a method for pillars, `rounded tops`, `love` on a height map, or `flat`.
///
/// # Errors
/// [`CaseError`] for an invalid case.
pub fn method_name(file: &CaseFile) -> Result<&'static str, CaseError> {
    Subject::of(file).map(|subject| subject.method_name())
}

/// The adhesion, or the smallest one if there is none.
pub(super) fn some(adhesion: Adhesion) -> Adhesion {
    if adhesion.is_none() {
        Adhesion::new(Adhesion::SMALLEST_WORK)
    } else {
        adhesion
    }
}

/// The cycle of a fit with adhesion.
#[derive(Debug, Clone)]
pub enum FittedCycle {
    /// On pillars.
    Pillars(Box<Cycle>),
    /// On rounded tops, with their case.
    Asperities(Box<(AsperityCase, AsperityCycle)>),
    /// On a flat surface, and the limits of the model at the end of the loading.
    Flat(Box<FlatCycle>, Vec<Limit>),
}

impl FittedCycle {
    /// Pull-off force, N, and its relative error of the model; none without unloading.
    #[must_use]
    pub fn pull_off(&self) -> Option<[f64; 2]> {
        match self {
            Self::Pillars(cycle) => {
                let force = cycle.pull_off.as_ref()?.force;
                Some([force, cycle.errors.pull_off_force.model()])
            }
            Self::Asperities(fitted) => Some([fitted.1.pull_off.as_ref()?.force, 0.0]),
            Self::Flat(cycle, _) => Some([cycle.pull_off.as_ref()?.force, 0.0]),
        }
    }

    /// Whether its numbers are the solution.
    #[must_use]
    pub fn converged(&self) -> bool {
        match self {
            Self::Pillars(cycle) => cycle.converged(),
            Self::Asperities(fitted) => fitted.1.converged(),
            Self::Flat(cycle, _) => cycle.converged(),
        }
    }

    /// Limits of the model at the end of the loading.
    #[must_use]
    pub fn limits(&self) -> Vec<Limit> {
        match self {
            Self::Pillars(cycle) => cycle.turn.limits(None),
            Self::Asperities(fitted) => fitted.1.turn.limits(&fitted.0.field, None),
            Self::Flat(_, limits) => limits.clone(),
        }
    }

    /// Indentation at which the lens reaches the floor, m; none if it does not.
    #[must_use]
    pub fn critical_indentation(&self) -> Option<f64> {
        match self {
            Self::Pillars(cycle) => Some(cycle.critical.as_ref()?.contact.indentation),
            Self::Asperities(_) | Self::Flat(..) => None,
        }
    }

    /// Warnings about its numbers.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        match self {
            Self::Pillars(cycle) => cycle_warnings(cycle),
            Self::Asperities(fitted) => asperity_cycle_warnings(&fitted.0, &fitted.1),
            Self::Flat(cycle, _) => {
                let warnings = cycle.turn.warnings.iter().map(ToString::to_string);
                let unresolved = cycle.unresolved().map(|it| it.to_string());
                warnings.chain(unresolved).collect()
            }
        }
    }
}
