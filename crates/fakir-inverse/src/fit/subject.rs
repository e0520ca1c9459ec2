//! What a fit presses a lens on: pillars or a flat surface.

use super::error::FitError;
use fakir::problem::{Adhesion, CyclePlan, FloorModel, Load};
use fakir::state::{Cycle, FlatCycle, Limit, Run, SolveError};
use fakir_case::{Case, CaseError, CaseFile, FlatCase, Key, Setting};
use fakir_study::approach::Loadable;
use fakir_study::result::cycle_warnings;

/// A case that can be fitted.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Subject {
    Pillars(Box<Case>),
    Flat(Box<FlatCase>),
}

impl Subject {
    pub(super) fn of(file: &CaseFile) -> Result<Self, CaseError> {
        Ok(if file.is_flat() {
            Self::Flat(Box::new(file.flat_case()?))
        } else {
            Self::Pillars(Box::new(file.case()?))
        })
    }

    /// Reduced modulus, Pa.
    pub(super) fn reduced_modulus(&self) -> f64 {
        match self {
            Self::Pillars(case) => case.system.reduced_modulus(),
            Self::Flat(case) => case.system.reduced_modulus(),
        }
    }

    pub(super) fn has_pillars(&self) -> bool {
        matches!(self, Self::Pillars(_))
    }

    /// Refuses histories of viscoelastic bodies that are not supported: those with adhesion.
    pub(super) fn check_history(&self) -> Result<(), SolveError> {
        match self {
            Self::Pillars(case) => case.check_history(),
            Self::Flat(case) => case.check_history(),
        }
    }

    /// Name of the method in JSON.
    pub(super) fn method_name(&self) -> &'static str {
        match self {
            Self::Pillars(case) => case.method.name(),
            Self::Flat(_) => "flat",
        }
    }

    pub(super) fn setting(&self, key: Key) -> Option<Setting> {
        match self {
            Self::Pillars(case) => case.setting(key),
            Self::Flat(case) => case.setting(key),
        }
    }

    /// Finite number of a key, in SI units.
    pub(super) fn number(&self, key: Key) -> Option<f64> {
        match self {
            Self::Pillars(case) => case.number(key),
            Self::Flat(case) => match case.setting(key) {
                Some(Setting::Number(value)) => Some(value).filter(|value| value.is_finite()),
                _ => None,
            },
        }
    }

    pub(super) fn adhesion(&self) -> Adhesion {
        match self {
            Self::Pillars(case) => case.system.adhesion(),
            Self::Flat(case) => case.system.adhesion(),
        }
    }

    /// Half the distance of neighbouring pillars, m; 0 on a flat surface, where the contact radius has no jumps.
    pub(super) fn half_pitch(&self) -> f64 {
        match self {
            Self::Pillars(case) => 0.5 * case.system.pitch(),
            Self::Flat(_) => 0.0,
        }
    }

    /// Length (m) below which no contact radius is of interest.
    pub(super) fn least_radius(&self) -> f64 {
        match self {
            Self::Pillars(case) => 0.5 * case.system.pillar().diameter,
            Self::Flat(_) => 1e-3 * self.number(Key::LensRadius).unwrap_or(1e-3),
        }
    }

    /// Gap between the lens and the floor at an indentation before contact, m; none without a floor.
    pub(super) fn gap_before_contact(&self, indentation: f64) -> Option<f64> {
        match self {
            Self::Pillars(case) => Some(case.system.pillar().height - indentation),
            Self::Flat(_) => None,
        }
    }

    /// Limits of the model in the contact under a load.
    pub(super) fn limits(&self, load: Load, run: &Run<'_>) -> Result<Vec<Limit>, FitError> {
        Ok(match self {
            Self::Pillars(case) => fakir::press(&case.system, load, case.method, run)?.limits(None),
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

/// Name of the method of fits with a case: that of a method for pillars, or `flat`.
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
            Self::Flat(cycle, _) => Some([cycle.pull_off.as_ref()?.force, 0.0]),
        }
    }

    /// Whether its numbers are the solution.
    #[must_use]
    pub fn converged(&self) -> bool {
        match self {
            Self::Pillars(cycle) => cycle.converged(),
            Self::Flat(cycle, _) => cycle.converged(),
        }
    }

    /// Limits of the model at the end of the loading.
    #[must_use]
    pub fn limits(&self) -> Vec<Limit> {
        match self {
            Self::Pillars(cycle) => cycle.turn.limits(None),
            Self::Flat(_, limits) => limits.clone(),
        }
    }

    /// Indentation at which the lens reaches the floor, m; none if it does not.
    #[must_use]
    pub fn critical_indentation(&self) -> Option<f64> {
        match self {
            Self::Pillars(cycle) => Some(cycle.critical.as_ref()?.contact.indentation),
            Self::Flat(..) => None,
        }
    }

    /// Warnings about its numbers.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        match self {
            Self::Pillars(cycle) => cycle_warnings(cycle),
            Self::Flat(cycle, _) => {
                let warnings = cycle.turn.warnings.iter().map(ToString::to_string);
                let unresolved = cycle.unresolved().map(|it| it.to_string());
                warnings.chain(unresolved).collect()
            }
        }
    }
}
