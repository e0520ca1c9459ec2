//! Features of a problem that some solvers do not support, by the names and keys of case files.

use crate::file::CaseFile;
use crate::key::Key;
use crate::parts::Parts;
use fakir::problem::{Boundary, Feature, FloorModel, LensForm, PillarCompliance, Unsupported};

/// Name of a feature in the table.
pub(crate) fn named(feature: Feature) -> &'static str {
    match feature {
        Feature::Lens(LensForm::Profile) => "lens with a table of heights",
        Feature::Lens(LensForm::Punch) => "flat punch",
        Feature::Lens(form) => form.name(),
        Feature::TiltedPlate => "tilted plate",
        Feature::OtherArrangement => "other arrangement than the infinite hexagonal lattice",
        Feature::SeveralDiameters => "pillars of several diameters",
        Feature::Periodic => "periodic surface",
        Feature::Layer => "lens or substrate of finite thickness",
        Feature::ElasticPillars => "elastic pillars",
        Feature::IgnoredFloor => "floor ignored",
        Feature::AdhesiveTops => "adhesive tops",
        Feature::AdhesiveFloor => "adhesive floor",
        Feature::FloorInteraction => "shear stress on the floor",
    }
}

/// The keys that can be changed if a combination is not supported, each once.
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
        Feature::Lens(_) => &[Key::LensShape, Key::LensProfile],
        Feature::TiltedPlate => &[Key::LensTilt],
        Feature::OtherArrangement => &[
            Key::Lattice,
            Key::Pillars,
            Key::Rotation,
            Key::Columns,
            Key::HeightStandardDeviation,
            Key::VacancyFraction,
        ],
        Feature::SeveralDiameters => &[Key::PillarDiameter],
        Feature::Periodic => &[Key::Boundary],
        Feature::Layer => &[Key::SubstrateThickness, Key::LensThickness],
        Feature::ElasticPillars => &[Key::PillarCompliance],
        Feature::IgnoredFloor => &[Key::FloorContact],
        Feature::AdhesiveTops => &[Key::WorkOfAdhesion, Key::RecedingWorkOfAdhesion],
        Feature::AdhesiveFloor => &[Key::AdhesiveFloor],
        Feature::FloorInteraction => &[Key::ShearStressFloor],
    }
}

impl CaseFile {
    /// Features of a case that some solvers do not support, by its keys.
    pub(crate) fn features(&self, parts: &Parts) -> Vec<Feature> {
        let pattern = &parts.pattern;
        let is_of_layers = |key: &Key| key.is_of_layers();
        let has = |feature: &Feature| match feature {
            Feature::Lens(form) => parts.shape.form == *form,
            Feature::TiltedPlate => {
                parts.shape.form == LensForm::Plate && parts.shape.tilt.abs() > 0.0
            }
            Feature::Periodic => parts.surface.boundary == Boundary::Periodic,
            Feature::Layer => self.entries.keys.keys().any(is_of_layers),
            Feature::ElasticPillars => pattern.pillar.compliance == PillarCompliance::Elastic,
            Feature::AdhesiveTops => {
                pattern.adhesion.work.abs() > 0.0
                    || self.entry(Key::RecedingWorkOfAdhesion).is_some()
            }
            Feature::AdhesiveFloor => pattern.adhesion.floor.0,
            Feature::FloorInteraction => parts.interactions.act_on_floor(),
            Feature::IgnoredFloor => pattern.floor == FloorModel::Ignored,
            // These are determined from a system, or have a different meaning on other surfaces.
            Feature::OtherArrangement | Feature::SeveralDiameters => false,
        };
        Feature::ALL.into_iter().filter(has).collect()
    }
}
