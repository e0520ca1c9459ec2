//! A case file and its overrides, resolved into a [`Case`].

use crate::case::{Case, PillarsOrigin, Spacing};
use crate::columns::{Table, TableError};
use crate::entries::{
    Entries, Entry, NAME_IN_QUOTES, Value, accepted, ambiguous_key, both_given, kind_name, one_of,
    override_value, table_for_key, unknown_key,
};
use crate::error::{CaseError, OVERRIDE, Place, Source};
use crate::headings::{Given, Unit};
use crate::input::{self, LARGEST_CASE};
use crate::key::{Key, Setting, is_table, present};
use crate::parts::{Parts, PillarPatternParts, TRUE_OR_FALSE};
use crate::pillars::{
    DIAMETER, HEIGHT, chosen_columns, common_pillar, listed, pillars_in, read_pillars,
};
use crate::profile::read_profile;
use crate::table::{Field, IMPLIED, Part, Presence, Range};
use crate::unit::{Dimension, format_quantity, parse_quantity};
use fakir::problem::{
    Adhesion, Arrangement, Feature, FloorModel, InvalidQuantity, LensProfile, LensShape, Method,
    PillarList, PillarPattern, Quantity, Question, Requirement, ShapedLens,
};
use std::ops::Bound;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A case file that has been read, with the overrides applied so far.
///
/// ```
/// let text = fakir_case::Case::example().to_toml();
/// let mut file = fakir_case::CaseFile::parse("example.toml", &text)?;
/// file.set("pattern.pitch=25um")?;
/// let case = file.case()?;
/// assert_eq!(case.system.pitch(), 25e-6);
/// # Ok::<(), fakir_case::CaseError>(())
/// ```
#[derive(Debug, Clone)]
pub struct CaseFile {
    pub(crate) source: Source,
    pub(crate) entries: Entries,
    /// Folder relative to which file names in the case file are resolved.
    pub(crate) folder: PathBuf,
    /// Listed pillars that do not come from a file.
    pub(crate) pillars: Option<PillarList>,
    /// A table of heights of the lens that does not come from a file.
    pub(crate) profile: Option<Arc<LensProfile>>,
    /// Name and contents of a table of pillars that is given instead of read.
    pub(crate) table: Option<(PathBuf, Arc<[u8]>)>,
}

impl Case {
    /// Converts a case into a case file, so that keys can be set; `name` is its name in errors. Listed pillars without a file are
    /// taken from the case.
    ///
    /// # Errors
    /// Only if the case contains values that no file can have.
    pub fn to_file(&self, name: &str) -> Result<CaseFile, CaseError> {
        let mut file = CaseFile::parse(name, &self.to_toml())?;
        if let (Some(profile), None) = (self.system.lens().profile(), &self.profile) {
            file.profile = Some(Arc::clone(profile));
        }
        let from_file = self.pillars.as_ref().is_some_and(|it| it.path.is_some());
        match self.system.arrangement() {
            Arrangement::Listed(list) if !from_file => {
                let [x, y] = self.pillars.as_ref().map_or([0.0; 2], |origin| origin.axis);
                Ok(file.with_pillars(list.seen_from([-x, -y])))
            }
            _ => Ok(file),
        }
    }
}

impl CaseFile {
    /// Replaces the listed pillars of a file, if its arrangement is `"listed"`.
    #[must_use]
    pub fn with_pillars(mut self, pillars: PillarList) -> Self {
        for key in [Key::Pillars, Key::PillarColumns, Key::PillarUnit] {
            self.entries.keys.remove(&key);
        }
        Self {
            pillars: Some(pillars),
            ..self
        }
    }

    /// Gives the contents of the file that `pattern.pillars` or `surface.height_map` names, which is then not read.
    #[must_use]
    pub fn with_table(self, name: &str, contents: &[u8]) -> Self {
        Self {
            table: Some((PathBuf::from(name), contents.into())),
            ..self
        }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`CaseError`] if the file cannot be read, has more than [`LARGEST_CASE`] bytes, is not UTF-8 or TOML, or contains an unknown
    /// key. [`case`](Self::case) checks the values.
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

    /// Reads the contents of a file; `name` is its name in errors.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn from_bytes(name: &str, bytes: Vec<u8>) -> Result<Self, CaseError> {
        match String::from_utf8(bytes) {
            Ok(text) => Self::parse(name, &text),
            Err(error) => Err(not_utf8(name, &error)),
        }
    }

    /// Reads a text; `name` is its name in errors.
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
            pillars: None,
            profile: None,
            table: None,
        })
    }

    /// Builds a case file from settings; `name` is its name in errors.
    ///
    /// ```
    /// use fakir_case::{Case, CaseFile, Key};
    /// let example = Case::example();
    /// let settings = Key::ALL.into_iter().filter_map(|key| Some((key, example.setting(key)?)));
    /// assert_eq!(CaseFile::from_settings("by hand", settings).case()?, example);
    /// # Ok::<(), fakir_case::CaseError>(())
    /// ```
    #[must_use]
    pub fn from_settings(name: &str, settings: impl IntoIterator<Item = (Key, Setting)>) -> Self {
        let mut entries = Entries::default();
        for (key, setting) in settings {
            let entry = Entry::of_setting(name, key, setting);
            for (end, _) in key.path().match_indices('.') {
                let table = key.path()[..end].to_owned();
                entries.tables.insert(table, entry.place.clone());
            }
            entries.keys.insert(key, entry);
        }
        Self {
            source: Source::new(name, ""),
            entries,
            folder: PathBuf::new(),
            pillars: None,
            profile: None,
            table: None,
        }
    }

    /// Overrides one key: `pattern.surface_fraction=0.2`, with a value in TOML or a bare word or quantity (`lens.radius=2.2mm`).
    /// The last name of a key is sufficient if it is unique in such a case (`pitch=20um`).
    ///
    /// The last of several overrides of a key is used. An override replaces all entries of the file
    /// for the same choice: `pattern.pitch` replaces `surface_fraction` and vice versa, and
    /// `method.name` replaces the whole table `[method]`.
    ///
    /// # Errors
    /// [`CaseError`] for an argument that is not `key=value` or an unknown key; it points into the
    /// argument.
    pub fn set(&mut self, argument: &str) -> Result<(), CaseError> {
        let source = Source::new(OVERRIDE, argument);
        let Some((path, text)) = argument.split_once('=') else {
            return Err(
                CaseError::new(&source, "an override has the form key=value")
                    .label(0..argument.len(), "no `=` in this")
                    .accepted("for example pattern.surface_fraction=0.2"),
            );
        };
        let place = |start: usize, text: &str| {
            let start = start + text.len() - text.trim_start().len();
            Place {
                source: source.clone(),
                span: start..start + text.trim().len(),
            }
        };
        let written = path.trim();
        let name = &*present(written);
        let key = match self.named(name)[..] {
            [key] => key,
            [] if is_table(name) => {
                let surface = self.is_surface();
                return Err(table_for_key(&place(0, path), name, surface, text.trim()));
            }
            [] => return Err(unknown_key(&place(0, path), name)),
            ref several => return Err(ambiguous_key(&place(0, path), name, several)),
        };
        self.entries.former_table |= name != written;
        if ![key.path(), key.name()].contains(&name) {
            self.entries.former.insert(key);
        }
        let value = override_value(text.trim());
        for other in replaced_by(key, &value) {
            self.entries
                .keys
                .retain(|key, entry| *key != other || entry.place.is_override());
        }
        let entry = Entry {
            value,
            place: place(path.len() + 1, text),
        };
        self.entries.keys.insert(key, entry);
        Ok(())
    }

    /// Keys that an override can denote by path or last name. The name of a table does not denote a key.
    pub(crate) fn named(&self, name: &str) -> Vec<Key> {
        let name = &*present(name);
        if is_table(name) {
            return Vec::new();
        }
        Key::named(name, self.is_surface())
    }

    /// Sets a key to a number in SI units and replaces all entries of the file for the same choice,
    /// as [`set`](Self::set) does. The case is identical, bit for bit, to a file with that number.
    ///
    /// ```
    /// use fakir_case::{Case, CaseFile, Key};
    /// let mut file = CaseFile::parse("example.toml", &Case::example().to_toml())?;
    /// file.set_number(Key::Pitch, 25e-6);
    /// assert_eq!(file.case()?.system.pitch(), 25e-6);
    /// # Ok::<(), fakir_case::CaseError>(())
    /// ```
    pub fn set_number(&mut self, key: Key, value: f64) {
        let entry = Entry::of_setting("a number that was set", key, Setting::Number(value));
        self.put(key, entry);
    }

    /// Number given for a key, in SI units.
    ///
    /// # Errors
    /// [`CaseError`] for a value that is not a valid number.
    pub fn given(&self, key: Key) -> Result<Option<f64>, CaseError> {
        match self.entry(key) {
            Some(entry) => quantity(&Measured::by(key), entry).map(Some),
            None => Ok(None),
        }
    }

    /// The value given for a key: a number in SI units, or a word; `None` if neither is given.
    #[must_use]
    pub fn setting(&self, key: Key) -> Option<Setting> {
        match (self.given(key), &self.entry(key)?.value) {
            (Ok(Some(number)), _) => Some(Setting::Number(number)),
            (_, Value::Text(word)) => Some(Setting::Word(word.clone())),
            (_, Value::Flag(flag)) => Some(Setting::Word(flag.to_string())),
            _ => None,
        }
    }

    /// Sets a list of numbers in SI units.
    pub fn set_list(&mut self, key: Key, values: &[f64]) {
        let entry = Entry::of_list("a list that was set", key, values);
        self.put(key, entry);
    }

    /// Sets a key and replaces all entries for the same choice.
    pub(crate) fn put(&mut self, key: Key, entry: Entry) {
        for other in replaced_by(key, &entry.value) {
            self.entries.keys.remove(&other);
        }
        self.entries.keys.insert(key, entry);
    }

    /// The case that the file and its overrides describe.
    ///
    /// # Errors
    /// [`CaseError`] for a missing key or an invalid value, or a `[surface]` instead of a
    /// `[pattern]`.
    pub fn case(&self) -> Result<Case, CaseError> {
        self.refuse_surface(
            "this needs a [pattern], and the case has a [surface]",
            "a [surface] is solved with boundary elements: use press, transition, approach, verify or sweep",
        )?;
        let parts = self.parts(Part::OF_PILLARS)?;
        if self.is_rounded() {
            return Err(self
                .problem(Key::TopRadius, "this is computed for flat pillar tops only")
                .accepted("leave it out; rounded tops are supported by `press`, `transition`, `verify`, `approach`, `cycle`, `fit`, `sweep` and `design`"));
        }
        let pattern = &parts.pattern;
        let spacing = self.spacing(pattern)?;
        let mut pillar = pattern.pillar;
        let pitch = spacing.pitch(pattern.name, pillar.diameter);
        let (arrangement, pillars) = match pattern.plane_lattice(pitch) {
            Some(lattice) => (Arrangement::from(lattice), None),
            None => {
                let (list, origin) = self.listed_pillars(pattern)?;
                pillar = common_pillar(pillar, &list);
                (Arrangement::from(list), Some(origin))
            }
        };
        let pattern = PillarPattern::new(pillar, arrangement);
        let (shape, profile) = self.lens_shape(&parts)?;
        let (method, adhesion) = (parts.method.method(), self.adhesion(&parts));
        self.check_adhesion(adhesion, method)?;
        self.check_adhesive_floor(adhesion, parts.pattern.floor)?;
        self.check_bases(&parts)?;
        let relaxation = self.relaxation_of(&parts)?;
        let relaxation_table = self
            .entry(Key::RelaxationTable)
            .map(|_| self.named_file(Key::RelaxationTable, &parts.relaxation.table))
            .map(|path| std::path::absolute(&path).unwrap_or(path));
        let system = parts
            .system(shape, pattern, adhesion)
            .map_err(|invalid| self.impossible(&invalid))?;
        let spacing = match spacing {
            Spacing::Pitch(_) => Spacing::Pitch(system.pitch()),
            fraction => fraction,
        };
        Ok(Case {
            system,
            method,
            spacing,
            pillars,
            profile,
            relaxation: relaxation.map(|it| it.relaxation),
            relaxation_table,
        })
    }

    /// The [case](Self::case), if all of these questions are supported for it.
    ///
    /// # Errors
    /// [`CaseError`] with the reason and an alternative; and as [`case`](Self::case).
    pub fn case_for(&self, questions: &[Question]) -> Result<Case, CaseError> {
        let case = self.case()?;
        let features = Feature::of(&case.system);
        for question in questions {
            self.answers(*question, case.method.into(), &features)?;
        }
        Ok(case)
    }

    /// Shape of the lens, and the file of its table of heights, if any: next to the case file, or in the current folder if an override named it.
    pub(crate) fn lens_shape(
        &self,
        parts: &Parts,
    ) -> Result<(LensShape, Option<PathBuf>), CaseError> {
        if let Some(shape) = parts.shape.shape(parts.lens.radius) {
            return Ok((shape, None));
        }
        if let (Some(profile), None) = (&self.profile, self.entry(Key::LensProfile)) {
            return Ok((LensShape::Profile(Arc::clone(profile)), None));
        }
        let path = self.named_file(Key::LensProfile, &parts.shape.profile);
        let profile = read_profile(&path).map_err(|error| {
            self.problem(Key::LensProfile, error.to_string())
                .accepted("a table next to the case file, of columns radius_m and height_m")
        })?;
        // As an absolute path.
        let path = std::path::absolute(&path).unwrap_or(path);
        Ok((LensShape::Profile(Arc::new(profile)), Some(path)))
    }

    /// The lens that the keys of the bodies and of the shape describe, for surfaces that are not in a case file.
    ///
    /// # Errors
    /// [`CaseError`] for a missing key, an invalid value, or a table of heights that cannot be read.
    pub fn shaped_lens(&self) -> Result<ShapedLens, CaseError> {
        let parts = self.parts(&[Part::Bodies, Part::Shape])?;
        let (shape, _) = self.lens_shape(&parts)?;
        Ok(ShapedLens::new(shape, parts.lens.material))
    }

    /// The values of the keys of that lens, with the absolute path of a table of heights.
    ///
    /// # Errors
    /// [`CaseError`] for a missing key or an invalid value.
    pub fn lens_settings(&self) -> Result<Vec<(Key, Setting)>, CaseError> {
        let mut parts = self.parts(&[Part::Bodies, Part::Shape])?;
        let path = self.named_file(Key::LensProfile, &parts.shape.profile);
        let path = std::path::absolute(&path).unwrap_or(path);
        parts.shape.profile = path.to_string_lossy().into_owned();
        let keys = Key::ALL.into_iter().filter(|key| {
            let layer_without_thickness = key.is_of_layers() && self.entry(*key).is_none();
            key.table() == "lens" && !layer_without_thickness
        });
        let mut settings = Vec::new();
        for key in keys {
            if key.idle_with(&mut parts).is_none() {
                settings.push((key, key.get(&mut parts)));
            }
        }
        Ok(settings)
    }

    /// Spacing of the pillars, as given; NaN for listed pillars.
    pub(crate) fn spacing(&self, pattern: &PillarPatternParts) -> Result<Spacing, CaseError> {
        if self.entry(Key::Pitch).is_some() {
            return Ok(Spacing::Pitch(pattern.arrangement.lattice.pitch));
        }
        if pattern.is_listed() {
            return Ok(Spacing::Pitch(f64::NAN));
        }
        // The system is built with the pitch that follows from the surface fraction; therefore it
        // cannot check the surface fraction itself.
        let fraction = pattern.arrangement.surface_fraction;
        self.check_range(Key::SurfaceFraction, fraction)?;
        Ok(Spacing::SurfaceFraction(fraction))
    }

    /// The error for a table of pillars that was not read.
    pub(crate) fn no_pillars(&self, error: &TableError) -> CaseError {
        self.problem(Key::Pillars, error.to_string())
            .accepted("a table next to the case file, of columns x_m, y_m, height_m and diameter_m, also in other units, as x_um or X [um]")
    }

    /// Refuses an invalid height or diameter of pillars.
    pub(crate) fn check_common_pillar(&self) -> Result<(), CaseError> {
        for key in [Key::PillarHeight, Key::PillarDiameter] {
            if let Some(value) = self.given(key)? {
                self.check_range(key, value)?;
            }
        }
        Ok(())
    }

    /// Table of pillars, next to the case file or in the current folder if an override named it, and its path. It contains a height for
    /// every pillar, and a diameter if tops are flat.
    pub(crate) fn pillar_table(
        &self,
        pattern: &PillarPatternParts,
    ) -> Result<(Table<4>, PathBuf), CaseError> {
        let columns = match &pattern.pillar_columns[..] {
            "" => Vec::new(),
            text => chosen_columns(text).map_err(|problem| {
                self.problem(Key::PillarColumns, problem).accepted(
                    "x, y, height, and one of diameter, radius and area, each with the heading or the number of its column: \"x = POSITION_X, y = 4\"",
                )
            })?,
        };
        let unit = match &pattern.pillar_unit[..] {
            "" => None,
            text => Some(Unit::parse(text).ok_or_else(|| {
                self.problem(Key::PillarUnit, format!("\"{text}\" is no unit of length"))
                    .accepted("a unit, as \"um\", or the size of a pixel, as \"0.325 um\"")
            })?),
        };
        let given = Given { columns, unit };
        let (path, table) = match &self.table {
            Some((name, contents)) if *name == Path::new(&pattern.pillars) => {
                let table = pillars_in(&pattern.pillars, contents, &given, &pattern.pillar);
                (name.clone(), table)
            }
            _ => {
                let path = self.named_file(Key::Pillars, &pattern.pillars);
                let table = read_pillars(&path, &given, &pattern.pillar);
                (path, table)
            }
        };
        let table = table.map_err(|error| self.no_pillars(&error))?;
        for (key, column) in [(Key::PillarHeight, HEIGHT), (Key::PillarDiameter, DIAMETER)] {
            let is_needed = key == Key::PillarHeight || !self.is_rounded();
            if is_needed && self.entry(key).is_none() && !table.has[column] {
                return Err(self.missing(key).accepted(format!(
                    "give it for all pillars, or a column {}_m in {}",
                    key.name(),
                    path.display()
                )));
            }
        }
        Ok((table, path))
    }

    /// Pillars of a table, or those that do not come from a file.
    fn listed_pillars(
        &self,
        pattern: &PillarPatternParts,
    ) -> Result<(PillarList, PillarsOrigin), CaseError> {
        self.check_common_pillar()?;
        let axis = pattern.axis;
        if let (Some(list), None) = (&self.pillars, self.entry(Key::Pillars)) {
            let origin = PillarsOrigin {
                path: None,
                columns: String::new(),
                unit: String::new(),
                axis,
            };
            return Ok((list.seen_from(axis), origin));
        }
        let (table, path) = self.pillar_table(pattern)?;
        let list = listed(&table).map_err(|error| self.no_pillars(&error))?;
        // As an absolute path, unless its contents were given.
        let path = match self.table {
            Some(_) => Some(path),
            None => Some(std::path::absolute(&path).unwrap_or(path)),
        };
        let origin = PillarsOrigin {
            path,
            columns: pattern.pillar_columns.clone(),
            unit: pattern.pillar_unit.clone(),
            axis,
        };
        Ok((list.seen_from(axis), origin))
    }

    /// Path of a file that a key names: next to the case file, or in the current folder if an override named it.
    pub(crate) fn named_file(&self, key: Key, name: &str) -> PathBuf {
        match self.entry(key) {
            Some(entry) if entry.place.is_override() => PathBuf::from(name),
            _ => self.folder.join(name),
        }
    }

    /// The given adhesion.
    pub(crate) fn adhesion(&self, parts: &Parts) -> Adhesion {
        let given = &parts.pattern.adhesion;
        let receding = self.entry(Key::RecedingWorkOfAdhesion);
        Adhesion {
            work: given.work,
            work_receding: receding.map(|_| given.work_receding),
            floor: given.floor.0,
        }
    }

    /// Error of a cycle without adhesion.
    pub(crate) fn without_adhesion(&self) -> CaseError {
        let work = Key::WorkOfAdhesion;
        let error = match self.entry(work) {
            Some(_) => self.problem(
                work,
                "a cycle needs adhesive tops, and the work of adhesion is 0".to_owned(),
            ),
            None => self.missing(work),
        };
        error.accepted(
            "a cycle has a work of adhesion greater than 0, as \"50 mJ/m2\"; without adhesion, unloading \
             follows the curve of loading",
        )
    }

    /// Refuses a receding work of adhesion alone.
    pub(crate) fn check_receding(&self) -> Result<(), CaseError> {
        match self.without_needed(Key::RecedingWorkOfAdhesion) {
            Some(needed) => Err(self.missing(needed)),
            None => Ok(()),
        }
    }

    /// The key that this one needs, if this one is given without it.
    fn without_needed(&self, key: Key) -> Option<Key> {
        let needed = key.needs().filter(|_| self.entry(key).is_some());
        needed.filter(|needed| self.entry(*needed).is_none())
    }

    /// Refuses a receding work of adhesion alone, and adhesion with a method that does not support
    /// it.
    fn check_adhesion(&self, adhesion: Adhesion, method: Method) -> Result<(), CaseError> {
        self.check_receding()?;
        if adhesion.is_none() {
            return Ok(());
        }
        self.answers(Question::Press, method.into(), &[Feature::AdhesiveTops])
    }

    /// Refuses an adhesive floor without adhesive tops, or without floor contact.
    pub(crate) fn check_adhesive_floor(
        &self,
        adhesion: Adhesion,
        model: FloorModel,
    ) -> Result<(), CaseError> {
        let key = Key::AdhesiveFloor;
        if !adhesion.floor {
            return Ok(());
        }
        if adhesion.is_none() {
            return Err(self
                .problem(key, "an adhesive floor needs a work of adhesion")
                .accepted(format!("give {} too, as \"10 mJ/m2\"", Key::WorkOfAdhesion)));
        }
        if model == FloorModel::Ignored {
            return Err(self
                .problem(
                    key,
                    format!(
                        "a floor whose contact is ignored cannot be adhesive: {} = false",
                        Key::FloorContact
                    ),
                )
                .accepted(format!("leave it out, or set {} = true", Key::FloorContact)));
        }
        Ok(())
    }

    /// Refuses an invalid thickness, and a base of a half-space.
    pub(crate) fn check_bases(&self, parts: &Parts) -> Result<(), CaseError> {
        let bodies = [
            (&parts.substrate_layer, Key::SubstrateThickness),
            (&parts.lens_layer, Key::LensThickness),
        ];
        for (layer, thickness) in bodies {
            if self.entry(thickness).is_some() {
                self.check_range(thickness, layer.thickness)?;
            }
        }
        for base in [Key::SubstrateBase, Key::LensBase] {
            if let Some(thickness) = self.without_needed(base) {
                return Err(self
                    .problem(
                        base,
                        "only a body of finite thickness has a back that rests on something",
                    )
                    .accepted(format!("give {thickness} too, or leave this out")));
            }
        }
        Ok(())
    }

    /// Values of the keys of some parts: the given ones, and the defaults of the others.
    ///
    /// Checks according to the key table: kinds of values, words, numbers that the solver does not
    /// check itself, incompatible keys, and missing keys.
    pub(crate) fn parts(&self, wanted: &[Part]) -> Result<Parts, CaseError> {
        let keys = || {
            let keys = Key::ALL.into_iter();
            keys.filter(|key| wanted.contains(&key.part()))
        };
        let mut parts = Parts::default();
        for key in keys() {
            if let Some(entry) = self.entry(key) {
                self.read_value(key, entry, &mut parts)?;
            }
        }
        for (given, choice, word) in IMPLIED {
            let Field::Word(place) = choice.row().field else {
                continue;
            };
            if self.entry(given).is_some() && self.entry(choice).is_none() {
                place(&mut parts).choose(word);
            }
        }
        for key in keys().filter(|key| self.entry(*key).is_some()) {
            if let Some((choice, word)) = key.idle_with(&mut parts) {
                return Err(self.idle(key, choice, &word));
            }
        }
        for key in keys().filter(|key| self.entry(*key).is_none()) {
            if key.idle_with(&mut parts).is_none() {
                self.check_absence(key, &mut parts)?;
            }
        }
        self.refuse_both(keys())?;
        Ok(parts)
    }

    /// Sets a value, if the key accepts it.
    pub(crate) fn read_value(
        &self,
        key: Key,
        entry: &Entry,
        parts: &mut Parts,
    ) -> Result<(), CaseError> {
        let row = key.row();
        if let (Key::CellSize, Value::List(_)) = (key, &entry.value) {
            return Err(self
                .problem(key, "cells are squares, of one size")
                .accepted("give one length; resample a map of other cells"));
        }
        match row.field {
            Field::Number { place, .. } => {
                let read = quantity(&Measured::by(key), entry);
                let value = read.map_err(|error| match (row.presence, &entry.value) {
                    (Presence::Otherwise(words), Value::Text(_)) => {
                        error.or(&format!("leave it out: {words}"))
                    }
                    _ => error,
                })?;
                // A system and the patterns of pillars check their own quantities; the radius of rounded tops is none of them.
                let is_of_system = row.quantity.is_some() && key != Key::TopRadius;
                let is_checked_later = is_of_system || row.pattern_quantity.is_some();
                if !is_checked_later {
                    self.check_range(key, value)?;
                }
                *place(parts) = value;
            }
            Field::Word(place) => {
                let choice = place(parts);
                let problem = match &entry.value {
                    Value::Text(text) if choice.choose(text) => return Ok(()),
                    Value::Flag(flag) if choice.choose(TRUE_OR_FALSE[usize::from(!flag)]) => {
                        return Ok(());
                    }
                    Value::Text(text) => format!("\"{text}\" is not known"),
                    other if key.is_flag() => format!("found {}", kind_name(other)),
                    other => format!("expected a word, found {}", kind_name(other)),
                };
                return Err(self.problem(key, problem).accepted(accepted(key)));
            }
            Field::Text(place) => match &entry.value {
                Value::Text(text) => place(parts).clone_from(text),
                other => {
                    let problem = format!("expected a string, found {}", kind_name(other));
                    return Err(self.problem(key, problem).accepted(NAME_IN_QUOTES));
                }
            },
            Field::List { dimension, place } => {
                let measured = Measured::of(key.path(), dimension);
                let items = match &entry.value {
                    Value::List(items) => items.clone(),
                    // As in an override: 10 s, 2 min.
                    Value::Text(text) => text
                        .trim_matches(['[', ']'])
                        .split(',')
                        .map(|item| item.trim().trim_matches('"'))
                        .map(|item| match item.parse() {
                            Ok(number) => Value::Number(number),
                            Err(_) => Value::Text(item.to_owned()),
                        })
                        .collect(),
                    one => vec![one.clone()],
                };
                let items = items.into_iter().map(|value| {
                    let place = entry.place.clone();
                    quantity(&measured, &Entry { value, place })
                        .map_err(|error| error.accepted(accepted(key)))
                });
                *place(parts) = items.collect::<Result<_, _>>()?;
            }
        }
        Ok(())
    }

    /// Refuses a number that the key does not allow.
    pub(crate) fn check_range(&self, key: Key, value: f64) -> Result<(), CaseError> {
        let range = key.range().unwrap_or(Range::Finite);
        if range.allows(value) {
            return Ok(());
        }
        let shown = range.refused(value, key.dimension());
        Err(self
            .problem(key, format!("cannot be {shown}"))
            .accepted(format!("it must be {range}")))
    }

    /// Error for a key that is not accepted with the word of the key on which it depends.
    fn idle(&self, key: Key, choice: Key, word: &str) -> CaseError {
        let mut choices = key.choices();
        let words = choices
            .find(|(own, _)| *own == choice)
            .map_or(&[][..], |(_, words)| words);
        match (choice, words) {
            (Key::MethodName, [method]) => self
                .problem(key, format!("only the method \"{method}\" has this key"))
                .accepted(format!("leave it out, or {choice} = \"{method}\"")),
            _ => self
                .problem(
                    key,
                    format!("with {choice} = \"{word}\" there is no such key"),
                )
                .accepted(format!("leave it out, or {} as {choice}", one_of(words))),
        }
    }

    /// Refuses a missing key if it is required.
    fn check_absence(&self, key: Key, parts: &mut Parts) -> Result<(), CaseError> {
        match key.row().presence {
            Presence::Required if key == Key::Pillars && self.pillars.is_some() => Ok(()),
            Presence::Required if key == Key::LensProfile && self.profile.is_some() => Ok(()),
            // A rounded top may be an asperity on the half-space itself.
            Presence::Required if key == Key::PillarDiameter && self.is_rounded() => Ok(()),
            // Listed pillars may have individual values.
            Presence::Required if key.is_of_listed_pillars() && parts.pattern.is_listed() => Ok(()),
            Presence::Required => Err(self.missing(key)),
            // The file may contain it.
            Presence::OneOf(_) if key.part() == Part::HeightMap => Ok(()),
            Presence::OneOf(other) if other.idle_with(parts).is_some() => Err(self.missing(key)),
            Presence::OneOf(other) if self.entry(other).is_none() => Err(self
                .missing(key)
                .accepted(format!("give exactly one of {key} and {other}"))),
            _ => Ok(()),
        }
    }

    /// Refuses two keys of which exactly one can be given.
    fn refuse_both(&self, mut keys: impl Iterator<Item = Key>) -> Result<(), CaseError> {
        let both = keys.find_map(|key| {
            let other = key.alternative()?;
            Some((key, self.entry(key)?, other, self.entry(other)?))
        });
        match both {
            None => Ok(()),
            Some((key, entry, other, other_entry)) => Err(both_given(
                (key.name(), &entry.place),
                (other.name(), &other_entry.place),
                key.table(),
            )
            .accepted("give only one: the other follows from it")),
        }
    }

    /// Entry of a key.
    pub(crate) fn entry(&self, key: Key) -> Option<&Entry> {
        self.entries.keys.get(&key)
    }

    /// An error at the value of a key, with what to do instead.
    #[must_use]
    pub fn refusal(&self, key: Key, why: &str, instead: &str) -> CaseError {
        self.problem(key, why).accepted(instead)
    }

    /// An error at the value of a key.
    pub(crate) fn problem(&self, key: Key, problem: impl Into<String>) -> CaseError {
        match self.entry(key) {
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

    /// Error for a value that the solver refuses. It points at the key that set the value.
    pub(crate) fn impossible(&self, invalid: &InvalidQuantity) -> CaseError {
        if let Requirement::FiniteUnder(shape) = invalid.requirement {
            return self
                .problem(
                    Key::LensShape,
                    format!("a {shape} touches infinitely many pillars of an infinite lattice"),
                )
                .accepted(format!(
                    "give {}, or a list of pillars as {}",
                    Key::Columns,
                    Key::Pillars
                ));
        }
        if invalid.quantity == Quantity::PillarSlenderness {
            return self
                .problem(
                    Key::PillarCompliance,
                    format!(
                        "cannot be \"elastic\" with a {} of {:.3}",
                        invalid.quantity, invalid.value
                    ),
                )
                .accepted(format!("that must be {}", invalid.requirement));
        }
        let key = Key::of(invalid.quantity);
        // A pitch that is not given follows from the surface fraction.
        let by_fraction = key == Some(Key::Pitch) && self.entry(Key::Pitch).is_none();
        if by_fraction && self.entry(Key::SurfaceFraction).is_some() {
            return self
                .problem(Key::SurfaceFraction, "pillars overlap with this")
                .accepted("on a square lattice they touch at pi/4 = 0.7854");
        }
        let Some(key) = key else {
            return CaseError::new(&self.source, invalid.to_string());
        };
        let value = format_quantity(invalid.value, key.dimension());
        self.problem(key, format!("cannot be {value}"))
            .accepted(format!("it must be {}", invalid.requirement))
    }
}

/// Keys of the file that an override of `key` replaces.
fn replaced_by(key: Key, value: &Value) -> Vec<Key> {
    let word = match value {
        Value::Text(word) => word,
        _ => "",
    };
    // A method replaces the whole table of the file, even if it is the same method.
    let stays = |words: &[&str]| key != Key::MethodName && words.contains(&word);
    let idle = key.dependents().filter(|(_, words)| !stays(words));
    let idle = idle.map(|(dependent, _)| dependent);
    idle.chain(key.alternative()).collect()
}

/// Meaning of a number in a file.
#[derive(Debug, Clone)]
pub(crate) struct Measured {
    /// Path of a key, or of an entry of a study.
    pub(crate) path: String,
    /// Name in errors.
    pub(crate) label: String,
    pub(crate) dimension: Dimension,
    /// Usual range, in SI units, by which the plausibility of a number without a unit is judged.
    pub(crate) usual: Option<[f64; 2]>,
    /// Whether it can be negative.
    pub(crate) is_signed: bool,
}

impl Measured {
    /// The number of a key.
    pub(crate) fn by(key: Key) -> Self {
        Self {
            label: key.label(),
            usual: key.judged_by(),
            is_signed: matches!(key.bounds(), (Bound::Unbounded, _)),
            ..Self::of(key.path(), key.dimension())
        }
    }

    /// A positive number with that path, of which only the dimension is known.
    pub(crate) fn of(path: &str, dimension: Dimension) -> Self {
        Self {
            path: path.to_owned(),
            label: path.to_owned(),
            dimension,
            usual: dimension.usual(),
            is_signed: false,
        }
    }
}

/// Number of an entry in SI units. A number without a unit must be plausible.
pub(crate) fn quantity(measured: &Measured, entry: &Entry) -> Result<f64, CaseError> {
    let dimension = measured.dimension;
    let error = |problem| CaseError::at(&entry.place, problem).key(&measured.path);
    let problem = match &entry.value {
        Value::InSi(value) => return Ok(*value),
        Value::Number(value) => {
            let is_judged = measured.is_signed || *value >= 0.0;
            if let (Some(usual), true) = (measured.usual, is_judged) {
                let text = entry.place.text().replace('_', "");
                dimension
                    .check_bare(&text, *value, usual)
                    .map_err(|implausible| {
                        let problem = format!("invalid {} {}", measured.label, implausible.read);
                        error(problem).accepted(implausible.advice)
                    })?;
            }
            return Ok(*value);
        }
        Value::Text(text) if dimension != Dimension::Number => {
            match parse_quantity(text, dimension) {
                Ok(value) => return Ok(value),
                Err(error) => error.to_string(),
            }
        }
        Value::Text(text) => format!("expected a number, found the string \"{text}\""),
        other => format!("expected {dimension}, found {}", kind_name(other)),
    };
    Err(error(problem).accepted(dimension.accepted()))
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
