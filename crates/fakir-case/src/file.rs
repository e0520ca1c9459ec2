//! A case file and its overrides, resolved into a [`Case`].

use crate::case::{Case, Spacing, written_number};
use crate::entries::{Entries, Entry, Value, accepted, kind_name, override_value, unknown_key};
use crate::error::{CaseError, Place, Source};
use crate::input::{self, LARGEST_CASE};
use crate::key::{Key, Kind};
use crate::surface;
use crate::unit::{Dimension, format_quantity, parse_quantity};
use fakir::problem::{Accuracy, Method, PunchForm};
use fakir::problem::{ElementMesh, MeshLayout};
use fakir::problem::{
    HexagonalLattice, InvalidQuantity, Lens, MAXIMUM_SURFACE_FRACTION, Material, Pillar,
    PillarCompliance, Quantity, Requirement, System, Texture,
};
use std::path::{Path, PathBuf};

/// A case file that has been read, with the overrides applied so far.
///
/// ```
/// let text = fakir_case::Case::example().to_toml();
/// let mut file = fakir_case::CaseFile::parse("example.toml", &text)?;
/// file.set("texture.pitch=25um")?;
/// let case = file.case()?;
/// assert_eq!(case.system.lattice().pitch, 25e-6);
/// # Ok::<(), fakir_case::CaseError>(())
/// ```
#[derive(Debug, Clone)]
pub struct CaseFile {
    pub(crate) source: Source,
    pub(crate) entries: Entries,
    /// Files named in it are sought there.
    pub(crate) folder: PathBuf,
}

impl CaseFile {
    /// Reads a file.
    ///
    /// # Errors
    /// [`CaseError`] if the file cannot be read, has more than [`LARGEST_CASE`] bytes, is not UTF-8 or TOML, or has a key that no case
    /// file has. Values are looked at by [`case`](Self::case).
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        let name = path.display().to_string();
        let bytes = input::read(path, LARGEST_CASE).map_err(|error| {
            CaseError::new(
                &Source::new(&name, ""),
                format!("cannot read {name}: {error}"),
            )
        })?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Self {
            folder,
            ..Self::from_bytes(&name, bytes)?
        })
    }

    /// Reads the contents of a file; `name` is what errors call it.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn from_bytes(name: &str, bytes: Vec<u8>) -> Result<Self, CaseError> {
        match String::from_utf8(bytes) {
            Ok(text) => Self::parse(name, &text),
            Err(error) => Err(not_utf8(name, &error)),
        }
    }

    /// Reads a text; `name` is what errors call it.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(name: &str, text: &str) -> Result<Self, CaseError> {
        let source = Source::new(name, text);
        if text.trim().is_empty() {
            return Err(CaseError::new(&source, format!("{name} is empty"))
                .accepted("`fakir init` writes a case file to start from"));
        }
        let entries = Entries::parse(&source)?;
        Ok(Self {
            source,
            entries,
            folder: PathBuf::new(),
        })
    }

    /// Overrides one key: `texture.surface_fraction=0.2`, with a value in TOML or a bare word or
    /// quantity (`lens.radius=2.2mm`).
    ///
    /// Of several overrides of a key the last one counts. An override takes the place of what the
    /// file gives for the same choice: `texture.pitch` replaces the file's `surface_fraction` and the
    /// other way round, and `method.name` all of the file's `[method]`.
    ///
    /// # Errors
    /// [`CaseError`] for an argument that is not `key=value` or a key that no case file has; it
    /// points into the argument.
    pub fn set(&mut self, argument: &str) -> Result<(), CaseError> {
        let source = Source::new("--set", argument);
        let Some((path, text)) = argument.split_once('=') else {
            return Err(
                CaseError::new(&source, "an override has the form key=value")
                    .label(0..argument.len(), "no `=` in this")
                    .accepted("for example texture.surface_fraction=0.2"),
            );
        };
        let place = |start: usize, text: &str| {
            let start = start + text.len() - text.trim_start().len();
            Place {
                source: source.clone(),
                span: start..start + text.trim().len(),
            }
        };
        let key = Key::at(path.trim()).ok_or_else(|| unknown_key(&place(0, path), path.trim()))?;
        let value = override_value(text.trim());
        for other in replaced_by(key, &value) {
            self.entries
                .keys
                .retain(|key, entry| *key != other || entry.place.source.name() == "--set");
        }
        let entry = Entry {
            value,
            place: place(path.len() + 1, text),
        };
        self.entries.keys.insert(key, entry);
        Ok(())
    }

    /// Sets a key to a number in SI units, in place of what the file gives for the same choice, as
    /// [`set`](Self::set) does. The case is the same, bit for bit, as with that number in the file.
    ///
    /// ```
    /// use fakir_case::{Case, CaseFile, Key};
    /// let mut file = CaseFile::parse("example.toml", &Case::example().to_toml())?;
    /// file.set_number(Key::Pitch, 25e-6);
    /// assert_eq!(file.case()?.system.lattice().pitch, 25e-6);
    /// # Ok::<(), fakir_case::CaseError>(())
    /// ```
    pub fn set_number(&mut self, key: Key, value: f64) {
        let text = format!("{} = {}", key.path(), written_number(key, value));
        let place = Place {
            span: 0..text.len(),
            source: Source::new("a number that was set", &text),
        };
        let value = Value::Number(value);
        self.put(key, Entry { value, place });
    }

    /// The number that was given for a key, in SI units.
    ///
    /// # Errors
    /// [`CaseError`] for a value that is no such number.
    pub fn given(&self, key: Key) -> Result<Option<f64>, CaseError> {
        match self.entries.keys.get(&key) {
            Some(entry) => number(key, entry).map(Some),
            None => Ok(None),
        }
    }

    /// Sets a key, in place of what there is for the same choice.
    pub(crate) fn put(&mut self, key: Key, entry: Entry) {
        for other in replaced_by(key, &entry.value) {
            self.entries.keys.remove(&other);
        }
        self.entries.keys.insert(key, entry);
    }

    /// The case that the file and its overrides describe.
    ///
    /// # Errors
    /// [`CaseError`] for a key that is missing or has a value that cannot be, or a `[surface]` in
    /// place of a `[texture]`.
    pub fn case(&self) -> Result<Case, CaseError> {
        self.refuse_surface()?;
        let lens = Lens {
            radius: self.number(Key::LensRadius)?,
            material: Material::new(
                self.number(Key::LensYoungModulus)?,
                self.number(Key::LensPoissonRatio)?,
            ),
        };
        let substrate = Material::new(
            self.number(Key::SubstrateYoungModulus)?,
            self.number(Key::SubstratePoissonRatio)?,
        );
        let (lattice, spacing, pillar) = self.texture()?;
        let system = System::new(lens, substrate, Texture { pillar, lattice })
            .map_err(|invalid| self.impossible(&invalid))?;
        Ok(Case {
            system,
            method: self.method()?,
            spacing,
        })
    }

    fn texture(&self) -> Result<(HexagonalLattice, Spacing, Pillar), CaseError> {
        self.choice(Key::Lattice, &[("hexagonal", ())])?;
        let spacing = self.spacing()?;
        let offset = self.number_or(Key::Offset, 0.0)?;
        let offset_angle = self.number_or(Key::OffsetAngle, 0.0)?;
        let pillar = Pillar {
            diameter: self.number(Key::PillarDiameter)?,
            height: self.number(Key::PillarHeight)?,
            compliance: self
                .choice(
                    Key::PillarCompliance,
                    &[
                        ("column", PillarCompliance::Column),
                        ("none", PillarCompliance::None),
                    ],
                )?
                .unwrap_or_default(),
        };
        let lattice = HexagonalLattice {
            pitch: spacing.pitch(pillar.diameter),
            offset,
            offset_angle,
        };
        Ok((lattice, spacing, pillar))
    }

    fn spacing(&self) -> Result<Spacing, CaseError> {
        let keys = &self.entries.keys;
        match (keys.get(&Key::SurfaceFraction), keys.get(&Key::Pitch)) {
            (Some(_), None) => {
                let value = self.number(Key::SurfaceFraction)?;
                if value > 0.0 && value <= MAXIMUM_SURFACE_FRACTION {
                    return Ok(Spacing::SurfaceFraction(value));
                }
                Err(self.impossible(&InvalidQuantity {
                    quantity: Quantity::SurfaceFraction,
                    value,
                    requirement: Requirement::SurfaceFraction,
                }))
            }
            (None, Some(_)) => Ok(Spacing::Pitch(self.number(Key::Pitch)?)),
            (None, None) => Err(self
                .missing(Key::SurfaceFraction)
                .accepted("give exactly one of texture.surface_fraction and texture.pitch")),
            (Some(fraction), Some(pitch)) => Err(both_given(
                ("surface_fraction", &fraction.place),
                ("pitch", &pitch.place),
                "texture",
            )
            .accepted("give only one: the other follows from it")),
        }
    }

    fn method(&self) -> Result<Method, CaseError> {
        const ACCURACIES: [(&str, Accuracy); 2] = [
            ("default", Accuracy::Default),
            ("accurate", Accuracy::Accurate),
        ];
        const FORMS: [(&str, PunchForm); 2] = [
            ("corrected", PunchForm::Corrected),
            ("plain", PunchForm::Plain),
        ];
        let name = self
            .choice(Key::MethodName, &Name::ALL.map(|name| (name.word(), name)))?
            .unwrap_or(Name::Spectral);
        let accuracy = self.choice(Key::Accuracy, &ACCURACIES)?;
        let form = self.choice(Key::Form, &FORMS)?;
        for (key, owner) in OWNERS {
            if owner != name {
                self.only_for(key, owner.word())?;
            }
        }
        match name {
            Name::Spectral => Ok(Method::Spectral(accuracy.unwrap_or_default())),
            Name::Punch => Ok(Method::Punch(form.unwrap_or_default())),
            Name::Love => Ok(Method::Love(self.mesh()?)),
            Name::Homogenised => Ok(Method::Homogenised),
        }
    }

    fn mesh(&self) -> Result<ElementMesh, CaseError> {
        const MESHES: [(&str, MeshLayout); 2] = [
            ("pillars", MeshLayout::Pillars),
            ("pattern", MeshLayout::Pattern),
        ];
        const CELLS: [(&str, bool); 2] = [("matched", true), ("plain", false)];
        let default = ElementMesh::default();
        let cells = self.number_or(Key::CellsPerDiameter, default.cells_per_diameter as f64)?;
        if !(8.0..=1024.0).contains(&cells) || cells.fract() > 0.0 {
            return Err(self
                .problem(Key::CellsPerDiameter, format!("cannot be {cells}"))
                .accepted("it must be a whole number from 8 to 1024"));
        }
        Ok(ElementMesh {
            cells_per_diameter: cells as usize,
            layout: self.choice(Key::Mesh, &MESHES)?.unwrap_or(default.layout),
            matched: self.choice(Key::Cells, &CELLS)?.unwrap_or(default.matched),
        })
    }

    /// Refuses a key that the chosen method does not have.
    fn only_for(&self, key: Key, method: &str) -> Result<(), CaseError> {
        if self.entries.keys.contains_key(&key) {
            return Err(self
                .problem(key, format!("only the method \"{method}\" has this key"))
                .accepted(format!("leave it out, or method.name = \"{method}\"")));
        }
        Ok(())
    }

    pub(crate) fn number(&self, key: Key) -> Result<f64, CaseError> {
        let entry = self.entries.keys.get(&key);
        number(key, entry.ok_or_else(|| self.missing(key))?)
    }

    pub(crate) fn number_or(&self, key: Key, default: f64) -> Result<f64, CaseError> {
        self.entries
            .keys
            .get(&key)
            .map_or(Ok(default), |entry| number(key, entry))
    }

    /// Which of the `options` a key names; `None` if it is not given.
    pub(crate) fn choice<T: Copy>(
        &self,
        key: Key,
        options: &[(&str, T)],
    ) -> Result<Option<T>, CaseError> {
        let Some(entry) = self.entries.keys.get(&key) else {
            return Ok(None);
        };
        let Value::Text(text) = &entry.value else {
            let problem = format!("expected a word, found {}", kind_name(&entry.value));
            return Err(self.problem(key, problem).accepted(one_of(options)));
        };
        match options.iter().find(|(word, _)| word == text) {
            Some((_, value)) => Ok(Some(*value)),
            None => {
                let problem = format!("\"{text}\" is not known");
                Err(self.problem(key, problem).accepted(one_of(options)))
            }
        }
    }

    /// An error at the value of a key.
    pub(crate) fn problem(&self, key: Key, problem: impl Into<String>) -> CaseError {
        match self.entries.keys.get(&key) {
            Some(entry) => CaseError::at(&entry.place, problem),
            None => CaseError::new(&self.source, problem),
        }
        .key(key.path())
    }

    pub(crate) fn missing(&self, key: Key) -> CaseError {
        let table = key.table();
        let error = match self.entries.tables.get(table) {
            Some(place) => CaseError::new(&place.source, "this key is missing")
                .label(place.span.clone(), "in this table"),
            None => CaseError::new(
                &self.source,
                format!(
                    "this key is missing: {} has no table [{table}]",
                    self.source.name()
                ),
            ),
        };
        error.key(key.path()).accepted(accepted(key))
    }

    /// The error for a value that the physics refuses, at the key that set it.
    pub(crate) fn impossible(&self, invalid: &InvalidQuantity) -> CaseError {
        let key = Key::of(invalid.quantity);
        let Some(key) = key else {
            return CaseError::new(&self.source, invalid.to_string());
        };
        let value = match key.kind() {
            Kind::Number(dimension) => format_quantity(invalid.value, dimension),
            Kind::Word | Kind::Text => invalid.value.to_string(),
        };
        self.problem(key, format!("cannot be {value}"))
            .accepted(format!("it must be {}", invalid.requirement))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Name {
    Spectral,
    Love,
    Punch,
    Homogenised,
}

impl Name {
    const ALL: [Self; 4] = [Self::Spectral, Self::Love, Self::Punch, Self::Homogenised];

    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Spectral => "spectral",
            Self::Love => "love",
            Self::Punch => "punch",
            Self::Homogenised => "homogenised",
        }
    }
}

/// The keys that only one method has.
pub(crate) const OWNERS: [(Key, Name); 5] = [
    (Key::Accuracy, Name::Spectral),
    (Key::Form, Name::Punch),
    (Key::CellsPerDiameter, Name::Love),
    (Key::Mesh, Name::Love),
    (Key::Cells, Name::Love),
];

/// Advice to give one of some words.
pub(crate) fn one_of<T>(options: &[(&str, T)]) -> String {
    let words: Vec<_> = options
        .iter()
        .map(|(word, _)| format!("\"{word}\""))
        .collect();
    match words.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("give {} or {last}", rest.join(", ")),
        _ => format!("give {}", words.concat()),
    }
}

/// Keys of the file that an override of `key` takes the place of.
fn replaced_by(key: Key, value: &Value) -> Vec<Key> {
    match (key, value) {
        (Key::MethodName, _) => OWNERS.map(|(key, _)| key).to_vec(),
        (_, Value::Text(word)) if surface::is_choice(key) => {
            surface::idle_keys(key, word).collect()
        }
        _ => key.alternative().into_iter().collect(),
    }
}

pub(crate) fn number(key: Key, entry: &Entry) -> Result<f64, CaseError> {
    let dimension = match key.kind() {
        Kind::Number(dimension) => dimension,
        Kind::Word | Kind::Text => Dimension::Number,
    };
    quantity(key.path(), dimension, entry)
}

/// The number in SI units that an entry stands for, at a key of that path.
pub(crate) fn quantity(path: &str, dimension: Dimension, entry: &Entry) -> Result<f64, CaseError> {
    let problem = match &entry.value {
        Value::Number(value) => return Ok(*value),
        Value::Text(text) if dimension != Dimension::Number => {
            match parse_quantity(text, dimension) {
                Ok(value) => return Ok(value),
                Err(error) => error.to_string(),
            }
        }
        Value::Text(text) => format!("expected a number, found the string \"{text}\""),
        other => format!("expected {dimension}, found {}", kind_name(other)),
    };
    Err(CaseError::at(&entry.place, problem)
        .key(path)
        .accepted(dimension.accepted()))
}

/// The error for two entries of which only one can be given; it stands at the later one.
pub(crate) fn both_given(a: (&str, &Place), b: (&str, &Place), table: &str) -> CaseError {
    let (first, second) = if a.1.span.start < b.1.span.start {
        (a.1, b.1)
    } else {
        (b.1, a.1)
    };
    let mut error = CaseError::at(second, format!("{} and {} are both given", a.0, b.0));
    if !table.is_empty() {
        error = error.key(table);
    }
    if first.source.text() == second.source.text() {
        error = error.label(first.span.clone(), "and here");
    }
    error
}

pub(crate) fn not_utf8(name: &str, error: &std::string::FromUtf8Error) -> CaseError {
    let start = error.utf8_error().valid_up_to();
    let shown = String::from_utf8_lossy(error.as_bytes());
    CaseError::new(&Source::new(name, &shown), "not UTF-8 text")
        .label(
            start..start + char::REPLACEMENT_CHARACTER.len_utf8(),
            "here",
        )
        .accepted("save the file as UTF-8, or write \"um\" for \"µm\"")
}
