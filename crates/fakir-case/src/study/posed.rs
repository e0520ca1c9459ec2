//! What a case of a study is of: a texture, or a general surface.

use super::asked::Asked;
use crate::any_case::AnyCase;
use crate::case::Case;
use crate::error::CaseError;
use crate::file::CaseFile;
use crate::key::Key;
use crate::rounded::RoundedCase;
use crate::surface::SurfaceExample;
use fakir::problem::Question;
use fakir::state::Run;
use std::collections::BTreeMap;

/// What is pressed in a case of a study, and how it is solved.
#[derive(Debug, Clone)]
pub enum StudiedCase {
    /// A texture.
    Texture(Box<Case>),
    /// Pillars with rounded tops.
    Rounded(Box<RoundedCase>),
    /// A general surface, as the case file that describes it: it is drawn when it is solved, on a grid
    /// that is wide enough.
    Surface(Box<CaseFile>),
}

impl StudiedCase {
    /// The case of a file, of which something can be asked.
    pub(super) fn of(file: CaseFile, asked: Asked) -> Result<Self, CaseError> {
        let of_adhesion = matches!(asked, Asked::Cycle | Asked::Collapse);
        let question = match asked {
            Asked::Press => Question::Press,
            Asked::Transition => Question::Transition,
            Asked::Cycle | Asked::Collapse => Question::Cycle,
        };
        let case = match file.any_case(&[Question::Sweep, question])? {
            AnyCase::HeightMap(file) => return Ok(Self::Surface(file)),
            AnyCase::Asperities(case) => return Ok(Self::Rounded(case)),
            AnyCase::Pillars(case) => case,
        };
        if of_adhesion && case.system.adhesion().is_none() {
            return Err(file.without_adhesion());
        }
        Ok(Self::Texture(case))
    }

    /// The case with a texture, if it is one.
    #[must_use]
    pub fn texture(&self) -> Option<&Case> {
        match self {
            Self::Texture(case) => Some(case),
            Self::Rounded(_) | Self::Surface(_) => None,
        }
    }
}

/// The general surfaces of a study that were looked at.
#[derive(Debug, Clone, Default)]
pub(super) struct Surfaces {
    /// One of each kind, and of each choice of keys.
    pub(super) examples: Vec<SurfaceExample>,
    /// Cells of each surface, by the steps along the axes that are no loads; none of a surface that
    /// takes more memory than there is by default.
    cells: BTreeMap<Vec<usize>, usize>,
}

impl Surfaces {
    /// Looks at the surface of a case, if no other case with these steps has had it.
    pub(super) fn look(
        &mut self,
        steps: Vec<usize>,
        file: &CaseFile,
        asked: Asked,
    ) -> Result<(), CaseError> {
        if self.cells.contains_key(&steps) {
            return Ok(());
        }
        let (example, cells) = looked_at(file, asked)?;
        if !self.examples.iter().any(|known| known.is_like(&example)) {
            self.examples.push(example);
        }
        self.cells.insert(steps, cells);
        Ok(())
    }

    pub(super) fn cells(&self, steps: &[usize]) -> usize {
        self.cells.get(steps).copied().unwrap_or_default()
    }
}

/// Draws or reads a surface to see whether it can be. One that takes more memory than a computation
/// may by default is not drawn: the limit of the sweep tells whether it can be solved.
pub(super) fn looked_at(
    file: &CaseFile,
    asked: Asked,
) -> Result<(SurfaceExample, usize), CaseError> {
    let example = file.surface_example()?;
    let case = match file.surface_case(Run::default().memory_limit()) {
        Err(error) if error.is_of_memory() => return Ok((example, 0)),
        case => case?,
    };
    file.refuse_absurd_heights(&case)?;
    if asked == Asked::Transition && case.system.floor().is_none() {
        return Err(file.missing(Key::Floor).accepted(
            "a height map has no pillars that would tell which part of it is the floor: give the \
             height at or below which it is",
        ));
    }
    Ok((example, case.system.surface().grid().cell_count()))
}
