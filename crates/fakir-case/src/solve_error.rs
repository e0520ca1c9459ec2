//! Errors of the solvers, with the keys of the case that they concern.

use crate::key::Key;
use fakir::problem::{Feature, Unsupported};
use fakir::state::SolveError;

/// Text of an error, followed by the keys of a case that can be changed.
///
/// ```
/// use fakir::problem::Unsupported;
/// use fakir::state::SolveError;
/// let error = SolveError::Unsupported(Unsupported::BUT_FOR_A_SPHERE);
/// assert!(fakir_case::with_keys(&error).ends_with(" (lens.shape)"));
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

/// The keys that can be changed where there is no answer, each once.
pub(crate) fn keys_of(unsupported: &Unsupported) -> impl Iterator<Item = Key> {
    let features = unsupported.with.iter().copied().flatten();
    let mut keys: Vec<Key> = Vec::new();
    for key in features.flat_map(|feature| keys_with(*feature)) {
        if !keys.contains(key) {
            keys.push(*key);
        }
    }
    keys.into_iter()
}

/// The keys by which a case has a feature.
fn keys_with(feature: Feature) -> &'static [Key] {
    match feature {
        Feature::Lens(_) => &[Key::LensShape],
        Feature::TiltedPlate => &[Key::LensTilt],
        Feature::OtherArrangement => &[
            Key::Lattice,
            Key::Rotation,
            Key::Columns,
            Key::HeightStandardDeviation,
            Key::TextureMissing,
        ],
        Feature::SeveralDiameters => &[Key::PillarDiameter],
        Feature::SeveralColumns => &[Key::PillarHeight, Key::PillarCompliance],
        Feature::Layer => &[Key::SubstrateThickness, Key::LensThickness],
        Feature::ElasticPillars => &[Key::PillarCompliance],
        Feature::IgnoredFloor => &[Key::FloorContact],
        Feature::AdhesiveTops => &[Key::WorkOfAdhesion, Key::RecedingWorkOfAdhesion],
        Feature::AdhesiveFloor => &[Key::FloorSticks],
    }
}
