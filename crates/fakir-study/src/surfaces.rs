//! Cases with a general surface, on a grid that is wide enough for the contact.

use crate::numbers::{LENGTH_DIGITS, with_unit};
use fakir_case::unit::Dimension;
use fakir_case::{CaseError, CaseFile, Key, SurfaceCase};

/// An answer, and the case that was solved for it.
#[derive(Debug, Clone)]
pub struct Answered<T> {
    /// The case, on the grid that was wide enough.
    pub case: SurfaceCase,
    /// What was asked.
    pub answer: T,
    /// A sentence that says so, if the grid is wider than that of the file.
    pub widened: Option<String>,
}

/// Asks something of the case of a file. A grid that turns out too narrow for the contact is made wider
/// where that shows more of the surface. `needed` is the width (m) that would do, of an error that asks
/// for a wider grid.
///
/// # Errors
/// Those of the case, and those of `ask`.
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
            "the contact goes beyond the grid of the case: solved with surface.grid.width = {}",
            with_unit(width, Dimension::Length, LENGTH_DIGITS)
        ));
    }
}
