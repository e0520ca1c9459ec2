//! Numbers of results are finite, and no zero is negative.

use super::error::SolveError;

/// Refuses a number that is infinite or undefined, and removes the sign of a negative zero.
pub(crate) fn check_number(what: &'static str, value: &mut f64) -> Result<(), SolveError> {
    if !value.is_finite() {
        return Err(SolveError::NotFinite { what });
    }
    *value += 0.0;
    Ok(())
}
