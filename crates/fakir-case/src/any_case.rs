//! A case of any kind of surface.

use crate::asperities::AsperityCase;
use crate::case::Case;
use crate::error::CaseError;
use crate::file::CaseFile;
use crate::flat::FlatCase;
use crate::key::{Key, Setting};
use crate::support::SurfaceKind;
use fakir::problem::{Feature, Interactions, Question, Solver};

/// A case of any kind of surface.
#[derive(Debug, Clone)]
pub enum AnyCase {
    /// Pillars with flat tops.
    Pillars(Box<Case>),
    /// Pillars with rounded tops.
    Asperities(Box<AsperityCase>),
    /// A height map, as the case file that describes it: it is generated when it is solved, on a sufficiently wide grid.
    HeightMap(Box<CaseFile>),
    /// A flat surface.
    Flat(Box<FlatCase>),
}

impl AnyCase {
    /// The case of pillars with flat tops, if it is one.
    #[must_use]
    pub fn pattern(&self) -> Option<&Case> {
        match self {
            Self::Pillars(case) => Some(case),
            _ => None,
        }
    }

    /// Interactions that do not change the normal contact.
    #[must_use]
    pub fn interactions(&self) -> Interactions {
        match self {
            Self::Pillars(case) => *case.system.interactions(),
            Self::Asperities(case) => *case.field.interactions(),
            Self::Flat(case) => *case.system.interactions(),
            Self::HeightMap(file) => file.interactions().unwrap_or_default(),
        }
    }

    /// Finite number of a key, in SI units; `None` if the case has none, and for a flat surface.
    #[must_use]
    pub fn number(&self, key: Key) -> Option<f64> {
        match self {
            Self::Pillars(case) => case.number(key),
            Self::Asperities(case) => case.number(key),
            Self::HeightMap(file) => {
                let given = file.given(key).ok().flatten();
                given.filter(|value| value.is_finite())
            }
            Self::Flat(case) => match case.setting(key) {
                Some(Setting::Number(number)) => Some(number),
                _ => None,
            },
        }
    }

    /// Whether its pillar tops are adhesive.
    #[must_use]
    pub fn is_adhesive(&self) -> bool {
        match self {
            Self::Pillars(case) => !case.system.adhesion().is_none(),
            Self::Flat(case) => !case.system.adhesion().is_none(),
            Self::Asperities(case) => !case.field.adhesion().is_none(),
            Self::HeightMap(file) => file
                .surface_adhesion()
                .is_ok_and(|adhesion| !adhesion.is_none()),
        }
    }
}

impl CaseFile {
    /// The case, if all of these questions are supported for it.
    ///
    /// # Errors
    /// [`CaseError`] with the reason and an alternative, or for an invalid case.
    pub fn any_case(&self, questions: &[Question]) -> Result<AnyCase, CaseError> {
        self.check_surface(questions)?;
        match self.surface_kind() {
            SurfaceKind::Pillars => Ok(AnyCase::Pillars(Box::new(self.case_for(questions)?))),
            SurfaceKind::Asperities => {
                let case = self.asperity_case()?;
                let features = Feature::of_asperities(&case.field);
                for question in questions {
                    self.answers(*question, Solver::Asperities, &features)?;
                }
                Ok(AnyCase::Asperities(Box::new(case)))
            }
            SurfaceKind::HeightMap => Ok(AnyCase::HeightMap(Box::new(self.clone()))),
            SurfaceKind::Flat => Ok(AnyCase::Flat(Box::new(self.flat_case()?))),
        }
    }

    /// Refuses questions that are not supported for the kind of surface, for any case of the kind.
    ///
    /// # Errors
    /// [`CaseError`] with the reason and an alternative.
    pub fn check_surface(&self, questions: &[Question]) -> Result<(), CaseError> {
        let Some(solver) = self.surface_kind().solver() else {
            return Ok(());
        };
        let features = match solver {
            Solver::HeightMap => self.features(&self.surface_parts()?.1),
            _ => Vec::new(),
        };
        let mut questions = questions.iter();
        questions.try_for_each(|question| self.answers(*question, solver, &features))
    }
}
