//! Errors of the solvers with the keys of the case that they are about.

use crate::key::Key;
use fakir::state::{FloorDifference, SolveError, TopDifference};

/// The text of an error, and behind it the keys of a case that can be changed.
///
/// ```
/// use fakir::state::{SolveError, TopDifference};
/// let error = SolveError::TopsDiffer { what: TopDifference::Diameters };
/// assert!(fakir_case::with_keys(&error).ends_with(" (texture.pillar.diameter)"));
/// ```
#[must_use]
pub fn with_keys(error: &SolveError) -> String {
    let keys: &[Key] = match error {
        SolveError::TopsDiffer { what } => match what {
            TopDifference::Diameters => &[Key::PillarDiameter],
            TopDifference::Columns => &[Key::PillarHeight, Key::PillarCompliance],
        },
        SolveError::FloorDoesNotStick { what } => match what {
            FloorDifference::Arrangement => &[
                Key::FloorSticks,
                Key::Lattice,
                Key::Rotation,
                Key::Columns,
                Key::HeightStandardDeviation,
                Key::TextureMissing,
            ],
            FloorDifference::Layer => &[
                Key::FloorSticks,
                Key::SubstrateThickness,
                Key::LensThickness,
            ],
            FloorDifference::ElasticPillars => &[Key::FloorSticks, Key::PillarCompliance],
        },
        SolveError::NotUnderShape { .. } => &[Key::LensShape, Key::MethodName],
        SolveError::NotWithLayers { .. } => &[Key::SubstrateThickness, Key::LensThickness],
        _ => &[],
    };
    let keys: Vec<&str> = keys.iter().map(|key| key.path()).collect();
    match &keys[..] {
        [] => error.to_string(),
        _ => format!("{error} ({})", keys.join(", ")),
    }
}
