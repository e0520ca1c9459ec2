//! Cases with a general surface: on a grid that is wide enough for the contact, and on two meshes.

use crate::numbers::{LENGTH_DIGITS, with_unit};
use fakir::problem::{ElementMesh, Load, Method};
use fakir::state::{ErrorEstimate, Run, SolveError, SurfaceContact};
use fakir::{Difference, InconclusiveReason, Verdict};
use fakir_case::unit::Dimension;
use fakir_case::{CaseError, CaseFile, Key, SurfaceCase, SurfaceOrigin};

/// A result, and the case that was solved.
#[derive(Debug, Clone)]
pub struct Answered<T> {
    /// The case, on the grid that was wide enough.
    pub case: SurfaceCase,
    /// The answer.
    pub answer: T,
    /// Message if the grid is wider than that of the file.
    pub widened: Option<String>,
}

/// Solves a problem for the case of a file. A grid that is too narrow for the contact is widened if that includes more of the surface.
/// `needed` returns the sufficient width (m) from an error that requires a wider grid.
///
/// # Errors
/// Those of the case, and those of the problem.
pub fn on_wide_enough_a_grid<T, E: From<CaseError>>(
    file: &CaseFile,
    memory_limit: usize,
    needed: impl Fn(&E) -> Option<f64>,
    mut ask: impl FnMut(&SurfaceCase) -> Result<T, E>,
) -> Result<Answered<T>, E> {
    let mut file = file.clone();
    let mut widened = None;
    loop {
        let case = file.surface_case(memory_limit)?;
        file.refuse_absurd_heights(&case)?;
        let error = match ask(&case) {
            Ok(answer) => {
                return Ok(Answered {
                    case,
                    answer,
                    widened,
                });
            }
            Err(error) => error,
        };
        let Some(width) = needed(&error).filter(|_| case.can_grow()) else {
            return Err(error);
        };
        file.set_number(Key::GridWidth, width);
        widened = Some(format!(
            "the contact extends beyond the grid of the case: solved with surface.grid.width = {}",
            with_unit(width, Dimension::Length, LENGTH_DIGITS)
        ));
    }
}

/// Errors of a verification of a surface.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceVerifyError {
    /// An invalid case.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// A contact that cannot be computed.
    #[error("{}", fakir_case::with_keys(.0))]
    Surface(#[from] SolveError),
    /// A height map is defined on its own cells only.
    #[error(
        "a height map cannot be verified: it is defined on its own cells only, so that there is no second \
         mesh; press and transition estimate the error from cells twice and four times as large"
    )]
    OneMesh,
    /// Random pillars have different positions on another grid.
    #[error(
        "pillars at random cannot be verified: their positions differ on a second mesh; press and \
         transition estimate the error from cells twice and four times as large"
    )]
    AtRandom,
}

/// The same problem for a pattern of pillars on two meshes.
#[derive(Debug, Clone)]
pub struct SurfaceVerification {
    /// On half as many cells across a pillar, and on all of them.
    pub answers: [Answered<SurfaceContact>; 2],
    /// Cells across a pillar of each.
    pub cells_per_diameter: [usize; 2],
    /// Relative difference of the force on half as many cells from that on all, and the value accepted by the estimates.
    pub force: Difference,
    /// The same for the indentation.
    pub indentation: Difference,
}

impl SurfaceVerification {
    /// The verdict, and why it is inconclusive, if it is.
    #[must_use]
    pub fn verdict(&self) -> (&'static str, Option<String>) {
        let failed = self.answers.iter().zip(self.cells_per_diameter).find_map(
            |(Answered { answer, .. }, cells_per_diameter)| {
                let method = Method::Love(ElementMesh {
                    cells_per_diameter,
                    ..ElementMesh::default()
                });
                let termination = answer.termination;
                let failed = InconclusiveReason::NotConverged {
                    method,
                    termination,
                };
                (!answer.converged()).then_some(failed)
            },
        );
        let verdict = Verdict::of(failed, &[self.force, self.indentation]);
        let reason = verdict.doubt().map(|doubt| doubt.to_string());
        (verdict.name(), reason)
    }

    /// Whether both converged and agree within their error estimates.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.verdict().0 == Verdict::Agree.name()
    }
}

/// Solves a problem with pillars of any form on half as many cells across a pillar and on `cells_per_diameter`. `next` is called with the
/// next mesh.
///
/// # Errors
/// See [`SurfaceVerifyError`].
pub fn verify(
    file: &CaseFile,
    control: Load,
    cells_per_diameter: usize,
    run: &Run<'_>,
    next: &dyn Fn(&str),
) -> Result<SurfaceVerification, SurfaceVerifyError> {
    let given = file.surface_case(run.memory_limit())?;
    match &given.origin {
        SurfaceOrigin::HeightMap(_) => return Err(SurfaceVerifyError::OneMesh),
        SurfaceOrigin::Pattern(_) if !given.can_grow() => return Err(SurfaceVerifyError::AtRandom),
        SurfaceOrigin::Pattern(_) => {}
    }
    let needed = |error: &SurfaceVerifyError| match error {
        SurfaceVerifyError::Surface(error) => error.needed_width(),
        _ => None,
    };
    let answer = |cells: usize| {
        next(&format!("{cells} cells across a pillar"));
        let mut file = file.clone();
        file.set_number(Key::GridCells, cells as f64);
        on_wide_enough_a_grid(&file, run.memory_limit(), needed, |case| {
            Ok(case.system.press(control, run)?)
        })
    };
    let cells = [cells_per_diameter / 2, cells_per_diameter];
    let answers = [answer(cells[0])?, answer(cells[1])?];
    let difference = |of: fn(&SurfaceContact) -> f64, error: fn(&ErrorEstimate) -> f64| {
        let [coarse, fine] = [0, 1].map(|mesh| of(&answers[mesh].answer));
        let estimates = [0, 1].map(|mesh| {
            let estimate = answers[mesh].answer.error.as_ref();
            estimate.map_or(f64::NAN, error)
        });
        Difference::of(coarse, fine, estimates[0] + estimates[1])
    };
    Ok(SurfaceVerification {
        force: difference(|contact| contact.force, |error| error.force),
        indentation: difference(|contact| contact.indentation, |error| error.indentation),
        answers,
        cells_per_diameter: cells,
    })
}
