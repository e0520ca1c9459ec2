//! The formulas for the critical state, by name, with their ranges.

use fakir::problem::{Feature, Question, Solver, System};
use fakir::solve::homogenised;
use fakir::state::SolveError;
use fakir::theory::closed_forms;
use fakir::theory::closed_forms::{Form, TransitionEstimate};

/// Ratio of contact radius to pitch above which lattice sums are not evaluated term by term.
pub const LARGEST_SUM: f64 = 2000.0;

/// Surface fraction above which the force in the dense limit is within 7 %: 0.2, with a margin for rounding.
const DENSE: f64 = 0.2 * (1.0 - 1e-9);

/// A formula for the critical state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Formula {
    /// One pillar in contact, as in the paper.
    SmallContact,
    /// One pillar in contact, with the exact distance of the floor contact.
    OnePillar,
    /// Many pillars in contact, as printed in the paper.
    LargeContactAsPrinted,
    /// Many pillars in contact, corrected.
    LargeContactCorrected,
    /// Many pillars in contact, by exact lattice sums instead of fitted ones.
    ExactLatticeSums,
    /// The homogenised lattice in the limit of a dense pattern.
    HomogenisedDenseLimit,
}

impl Formula {
    /// All formulas.
    pub const ALL: [Self; 6] = [
        Self::SmallContact,
        Self::OnePillar,
        Self::LargeContactAsPrinted,
        Self::LargeContactCorrected,
        Self::ExactLatticeSums,
        Self::HomogenisedDenseLimit,
    ];

    /// Its name in JSON, in tables and in Python.
    #[must_use]
    pub fn key(self) -> &'static str {
        match self {
            Self::SmallContact => "small_contact",
            Self::OnePillar => "one_pillar",
            Self::LargeContactAsPrinted => "large_contact_as_printed",
            Self::LargeContactCorrected => "large_contact_corrected",
            Self::ExactLatticeSums => "exact_lattice_sums",
            Self::HomogenisedDenseLimit => "homogenised_dense_limit",
        }
    }

    /// The formula with that name in JSON.
    #[must_use]
    pub fn named(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|formula| formula.key() == key)
    }

    /// Its descriptive name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::SmallContact => "small contact (paper)",
            Self::OnePillar => "one pillar, r_c exact",
            Self::LargeContactAsPrinted => "large contact (paper)",
            Self::LargeContactCorrected => "large contact, corrected",
            Self::ExactLatticeSums => "exact sums at that radius",
            Self::HomogenisedDenseLimit => "homogenised, dense limit",
        }
    }

    /// The critical state by the formula, regardless of its range. Lattice sums are over the contact radius of the corrected formula for
    /// large contacts.
    #[must_use]
    pub fn estimate(self, system: &System) -> TransitionEstimate {
        match self {
            Self::SmallContact => closed_forms::small_contact(system),
            Self::OnePillar => closed_forms::one_pillar(system),
            Self::LargeContactAsPrinted => closed_forms::large_contact(system, Form::AsPrinted),
            Self::LargeContactCorrected => closed_forms::large_contact(system, Form::Corrected),
            Self::ExactLatticeSums => {
                closed_forms::transition_from_exact_sums(system, radius_of_sums(system))
            }
            Self::HomogenisedDenseLimit => homogenised::dense_limit(system),
        }
    }

    /// Whether the system is in the range of the formula.
    #[must_use]
    pub fn applies(self, system: &System) -> bool {
        let one_pillar = touches_one_pillar(system);
        match self {
            Self::SmallContact | Self::OnePillar => one_pillar,
            Self::LargeContactAsPrinted | Self::LargeContactCorrected | Self::ExactLatticeSums => {
                !one_pillar
            }
            Self::HomogenisedDenseLimit => {
                !one_pillar && system.pattern().surface_fraction() >= DENSE
            }
        }
    }
}

/// A formula for the critical state, evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosedForm {
    /// The formula.
    pub formula: Formula,
    /// The critical state.
    pub estimate: TransitionEstimate,
    /// Whether the system is in the range of the formula.
    pub applies: bool,
}

/// Returns an error for systems that the formulas do not cover.
///
/// # Errors
/// [`Unsupported`](fakir::problem::Unsupported) for a body of finite thickness, unless equal pillars form the infinite hexagonal lattice,
/// and for a lens that is not a sphere.
pub fn check_arrangement(system: &System) -> Result<(), SolveError> {
    Question::Theory.check(Solver::Spectral, &Feature::of(system))?;
    Ok(())
}

/// Every formula that can be evaluated for this system.
///
/// # Errors
/// As [`check_arrangement`].
pub fn closed_forms(system: &System) -> Result<Vec<ClosedForm>, SolveError> {
    check_arrangement(system)?;
    let can_be_summed = radius_of_sums(system) <= LARGEST_SUM * system.pitch();
    let forms = Formula::ALL
        .into_iter()
        .filter(|formula| can_be_summed || *formula != Formula::ExactLatticeSums)
        .map(|formula| ClosedForm {
            formula,
            estimate: formula.estimate(system),
            applies: formula.applies(system),
        })
        .filter(|form| form.estimate.force > 0.0 && form.estimate.force.is_finite());
    Ok(forms.collect())
}

/// Whether the lens touches only one pillar at the transition, by the paper's criterion.
#[must_use]
pub fn touches_one_pillar(system: &System) -> bool {
    system.pattern().surface_fraction() < closed_forms::small_contact_limit(system)
}

/// The contact radius of the corrected formula for large contacts, m.
fn radius_of_sums(system: &System) -> f64 {
    closed_forms::large_contact_radius(system, Form::Corrected)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir_case::Case;

    #[test]
    fn formulas_are_found_by_their_names() {
        for formula in Formula::ALL {
            assert_eq!(Formula::named(formula.key()), Some(formula));
        }
        assert_eq!(Formula::named("Hertz"), None);
    }

    #[test]
    fn the_list_has_what_gives_numbers_only() {
        let forms = closed_forms(&Case::example().system).unwrap();
        assert!(forms.iter().all(|form| form.estimate.force > 0.0));
        assert!(forms.iter().any(|form| form.applies));
    }
}
