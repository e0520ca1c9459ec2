//! Cases of a study: the questions that they support, and their general surfaces.

use super::asked::Asked;
use crate::any_case::AnyCase;
use crate::error::CaseError;
use crate::file::CaseFile;
use crate::key::Key;
use crate::surface::SurfaceExample;
use fakir::problem::Question;
use fakir::state::Run;
use std::collections::BTreeMap;

impl AnyCase {
    /// Returns the case of a file of a study and checks that it supports the question.
    pub(super) fn studied(file: &CaseFile, asked: Asked) -> Result<Self, CaseError> {
        let of_adhesion = matches!(asked, Asked::Cycle | Asked::Collapse);
        let question = match asked {
            Asked::Press => Question::Press,
            Asked::Transition => Question::Transition,
            Asked::Cycle | Asked::Collapse => Question::Cycle,
            Asked::Hold => Question::Hold,
        };
        file.check_surface(&[Question::Sweep, question])?;
        // For pillars, a combination that is not supported is a row with the reason.
        let of_pillars = match of_adhesion {
            true => &[Question::Cycle][..],
            false => &[],
        };
        let case = file.any_case(of_pillars)?;
        let adhesion = match &case {
            Self::Pillars(case) => case.system.adhesion(),
            Self::Flat(case) => case.system.adhesion(),
            Self::Asperities(case) => case.field.adhesion(),
            Self::HeightMap(file) => file.surface_adhesion()?,
        };
        if of_adhesion && adhesion.is_none() {
            return Err(file.without_adhesion());
        }
        if asked == Asked::Collapse && case.pattern().is_none() {
            return Err(file.missing(Key::AdhesiveFloor).accepted(
                "a flat surface has no floor between pillars, and under rounded tops and on height maps a collapse is not computed: use question = \"cycle\"",
            ));
        }
        Ok(case)
    }
}

/// The general surfaces of a study that have been checked.
#[derive(Debug, Clone, Default)]
pub(super) struct Surfaces {
    /// One of each kind and of each set of keys.
    pub(super) examples: Vec<SurfaceExample>,
    /// Number of cells of each surface, by the steps along the axes that are not loads; `None` for
    /// a surface that exceeds the default memory limit.
    cells: BTreeMap<Vec<usize>, usize>,
}

impl Surfaces {
    /// Checks the surface of a case, unless it was checked in another case with these steps.
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

/// Generates or reads a surface to check it. A surface that exceeds the default memory limit is not
/// generated: the limit of the sweep decides whether it can be solved.
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
            "a height map has no pillars that define which part of it is the floor: give the \
             height at or below which it is",
        ));
    }
    Ok((example, case.system.surface().grid().cell_count()))
}
