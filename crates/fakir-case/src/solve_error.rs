//! Errors of the solvers, with the keys of the case that they concern.

use crate::feature::keys_of;
use crate::key::Key;
use fakir::state::SolveError;

/// Text of an error, followed by the keys of a case that can be changed.
///
/// ```
/// use fakir::problem::Unsupported;
/// use fakir::state::SolveError;
/// let error = SolveError::Unsupported(Unsupported::BUT_FOR_A_SPHERE);
/// assert!(fakir_case::with_keys(&error).contains(" (lens.shape"));
/// ```
#[must_use]
pub fn with_keys(error: &SolveError) -> String {
    let SolveError::Unsupported(unsupported) = error else {
        return error.to_string();
    };
    let keys: Vec<&str> = keys_of(unsupported).map(Key::path).collect();
    match &keys[..] {
        [] => error.to_string(),
        _ => format!("{error} ({})", keys.join(", ")),
    }
}
