//! Cases with a flat surface.

use crate::case::write_toml;
use crate::error::CaseError;
use crate::file::CaseFile;
use crate::key::{Key, Setting};
use crate::parts::Parts;
use crate::surface::pattern_and_surface;
use crate::table::Part;
use fakir::problem::{FlatSystem, InvalidFlat, LensShape, Question, ShapedLens, Solver};

/// A lens or a flat punch on a flat surface, as a case file describes them.
#[derive(Debug, Clone, PartialEq)]
pub struct FlatCase {
    /// The bodies and the adhesion.
    pub system: FlatSystem,
    /// All given keys and their values.
    settings: Vec<(Key, Setting)>,
}

impl FlatCase {
    /// The case as a case file with comments. It contains the given keys; reading it gives the same case, bit for bit.
    #[must_use]
    pub fn to_toml(&self) -> String {
        write_toml(|key| {
            let setting = self.setting(key)?;
            Some(key.written(&setting))
        })
    }

    /// The value of a key; none if it was not given.
    #[must_use]
    pub fn setting(&self, key: Key) -> Option<Setting> {
        let setting = self.settings.iter().find(|(given, _)| *given == key);
        setting.map(|(_, value)| value.clone())
    }
}

impl CaseFile {
    /// Whether the case has a flat surface: `surface.flat = true`, or neither a `[pattern]` nor a `[surface]`.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        let given = |table| self.place_of(table).is_some();
        match self.entry(Key::Flat) {
            Some(entry) => entry.is_true(),
            None => !given("surface") && !given("pattern") && self.pillars.is_none(),
        }
    }

    /// The case with a flat surface that the file and its overrides describe.
    ///
    /// # Errors
    /// [`CaseError`] for a missing key or an invalid value, and for keys that a flat surface does not have.
    pub fn flat_case(&self) -> Result<FlatCase, CaseError> {
        let mut parts = self.flat_parts()?;
        self.answers(Question::Press, Solver::Flat, &self.features(&parts))?;
        let material = parts.lens.material;
        let (shape, file) = self.lens_shape(&parts)?;
        if let (LensShape::Profile(_), Some(file)) = (&shape, file) {
            parts.shape.profile = file.to_string_lossy().into_owned();
        }
        let system = FlatSystem::new(ShapedLens::new(shape, material), parts.substrate);
        let system = system.map_err(|error| match error {
            InvalidFlat::Quantity(invalid) => self.impossible(&invalid),
            other => self.problem(Key::LensShape, other.to_string()),
        })?;
        let adhesion = self.adhesion(&parts);
        self.check_receding()?;
        self.check_bases(&parts)?;
        self.relaxation_of(&parts)?;
        let table = self.named_file(Key::RelaxationTable, &parts.relaxation.table);
        let table = std::path::absolute(&table).unwrap_or(table);
        parts.relaxation.table = table.to_string_lossy().into_owned();
        let system = system
            .with_adhesion(adhesion)
            .and_then(|system| {
                system.with_layers(parts.substrate_layer.layer(), parts.lens_layer.layer())
            })
            .and_then(|system| system.with_interactions(parts.interactions))
            .map_err(|invalid| self.impossible(&invalid))?;
        Ok(FlatCase {
            system,
            settings: self
                .entries
                .keys
                .keys()
                .map(|key| (*key, key.get(&mut parts)))
                .collect(),
        })
    }

    /// The values of all keys; refuses those of pillars and of other surfaces.
    pub(crate) fn flat_parts(&self) -> Result<Parts, CaseError> {
        if let (Some(surface), Some(pattern)) = (self.place_of("surface"), self.place_of("pattern"))
        {
            return Err(pattern_and_surface(surface, pattern));
        }
        let mut given = self.entries.keys.keys().copied();
        if let Some(key) = given.find(|key| !key.is_on_flat()) {
            let instead = match key.table() {
                "method" => "leave it out: a flat surface has one method",
                _ => "leave it out, or describe the pillars as a [pattern] or a [surface]",
            };
            let why = match self.entry(Key::Flat) {
                Some(_) => "a flat surface has no such key",
                None => "without [pattern] and [surface] the surface is flat, and has no such key",
            };
            return Err(self.problem(key, why).accepted(instead));
        }
        self.parts(Part::OF_FLAT)
    }
}
