//! Cases with a general surface instead of a pillar pattern: a height map, or pillars of any shape.

use crate::case::write_toml;
use crate::entries::both_given;
use crate::error::{CaseError, Place};
use crate::file::CaseFile;
use crate::height_map::{
    GivenScale, HEIGHT_UNIT, HeightMapError, MapSize, ReadMap, map_in, read_map, shown,
};
use crate::height_table::BYTES_PER_POINT;
use crate::input;
use crate::key::{Key, Setting, root};
use crate::parts::{
    ArrangementName, IndenterForm, MissingPoints, OutlineForm, OutlineParts, Parts, SurfaceParts,
    TopForm,
};
use crate::table::Part;
use crate::unit::{Dimension, format_quantity, parse_quantity};
use fakir::problem::pattern::{CrossSection, InvalidPattern, Pattern, PillarShape, Top};
use fakir::problem::{
    Adhesion, Arrangement, Boundary, Floor, FloorModel, Grid, HeightMap, Indenter, LatticeForm,
    PillarCompliance, Point, Question, RandomPlaces, ShapedLens, Solver, SurfaceSystem,
};
use std::path::{Path, PathBuf};

/// A general surface and its indenter, as a case file with a `[surface]` describes them.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceCase {
    /// The system. It has no floor if the surface is a height map without `surface.floor`.
    pub system: SurfaceSystem,
    /// Source of the surface.
    pub origin: SurfaceOrigin,
    /// Height unit that the file of a height map states, m.
    stated_unit: Option<f64>,
    /// All given keys and their values, as written in a case file.
    settings: Vec<(Key, String)>,
}

/// Source of a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum SurfaceOrigin {
    /// A height map in the given file.
    HeightMap(PathBuf),
    /// Generated from the description of its pillars.
    Pattern(Pattern),
}

impl SurfaceCase {
    /// Whether a wider `surface.grid` contains more of the same surface: only for pillars on a
    /// lattice. A height map ends with its data, and random pillars have other positions on another
    /// grid.
    #[must_use]
    pub fn can_grow(&self) -> bool {
        match &self.origin {
            SurfaceOrigin::HeightMap(_) => false,
            SurfaceOrigin::Pattern(pattern) => {
                !matches!(pattern.arrangement, Arrangement::Random(_))
            }
        }
    }

    /// The case as a case file with comments. It contains the given keys, with the absolute path of
    /// a height map, unless its contents were given; reading it gives the same case, bit for bit.
    #[must_use]
    pub fn to_toml(&self) -> String {
        write_toml(|key| {
            let setting = self.settings.iter().find(|(given, _)| *given == key);
            setting.map(|(_, value)| value.clone())
        })
    }
}

/// The elastic bodies of a case with a general surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceBodies {
    /// Reduced modulus, Pa.
    pub reduced_modulus: f64,
    /// Whether pillars shorten as columns, so that the modulus of the substrate has an effect besides the reduced modulus.
    pub has_columns: bool,
}

/// A general surface as a representative of similar ones.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceExample {
    /// Boundary.
    pub boundary: Boundary,
    /// Whether its pillars have random positions.
    pub is_random: bool,
    /// All given keys and their values, as written in a case file.
    settings: Vec<(Key, String)>,
}

impl SurfaceExample {
    /// Whether another surface is of the same kind and has the same keys.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        let keys = |example: &Self| -> Vec<Key> {
            let settings = example.settings.iter();
            settings.map(|(key, _)| *key).collect()
        };
        self.boundary == other.boundary
            && self.is_random == other.is_random
            && keys(self) == keys(other)
    }

    /// Value of a key as written in a case file, if given.
    pub(crate) fn value(&self, key: Key) -> Option<String> {
        let setting = self.settings.iter().find(|(given, _)| *given == key);
        setting.map(|(_, value)| value.clone())
    }
}

/// Smallest height difference of a map that is not flat, m: a tenth of an atom. Smaller ones are heights in another unit, or rounding.
const LOWEST_RELIEF: f64 = 1e-11;

/// Largest height difference over the extent of a map; larger values are implausible.
const HIGHEST_RELIEF: f64 = 2.0;

/// The number of cells along each side of a grid is a multiple of this, so that the same surface
/// can be solved on cells twice and four times as large.
const CELLS_MULTIPLE: f64 = 4.0;

impl CaseFile {
    /// Whether the case has a general surface: a `[surface]`, or an override of one of its keys.
    #[must_use]
    pub fn is_surface(&self) -> bool {
        self.place_of("surface").is_some() && !self.is_flat()
    }

    /// Name and contents of the file with the height map, of at most `largest` bytes; none if the case describes its pillars.
    ///
    /// # Errors
    /// [`CaseError`] for a file that cannot be read.
    pub fn height_map_contents(
        &self,
        largest: u64,
    ) -> Result<Option<(String, Vec<u8>)>, CaseError> {
        let Some(Setting::Word(named)) = self.setting(Key::HeightMap) else {
            return Ok(None);
        };
        let path = self.named_file(Key::HeightMap, &named);
        let contents = input::read(&path, largest).map_err(|error| {
            let name = path.display();
            self.problem(Key::HeightMap, format!("cannot read {name}: {error}"))
        })?;
        let name = path.file_name().unwrap_or_default();
        Ok(Some((name.to_string_lossy().into_owned(), contents)))
    }

    /// The case with a general surface that the file and its overrides describe.
    ///
    /// `memory_limit` is the largest memory (bytes) of the surface and the fields on it.
    ///
    /// # Errors
    /// [`CaseError`] for a missing key or an invalid value, a `[pattern]` or a `[method]`, a height
    /// map that cannot be read, or a surface that exceeds the memory limit.
    pub fn surface_case(&self, memory_limit: usize) -> Result<SurfaceCase, CaseError> {
        let (kind, parts) = self.surface_parts()?;
        self.relaxation_of(&parts)?;
        let SurfaceParts { boundary, .. } = parts.surface;
        let mut stated_unit = None;
        let (surface, origin) = if kind == Part::HeightMap {
            let named = Path::new(&parts.surface.height_map);
            let path = match &self.table {
                Some((name, _)) if name == named => name.clone(),
                _ => self.named_file(Key::HeightMap, &parts.surface.height_map),
            };
            let read = self.height_map(&parts.surface, &path, memory_limit)?;
            stated_unit = read.stated_unit;
            (read.map, SurfaceOrigin::HeightMap(path))
        } else {
            let pattern = self.pattern(&parts)?;
            let surface = self.draw(&pattern, &parts, memory_limit)?;
            (surface, SurfaceOrigin::Pattern(pattern))
        };
        let floor = match self.entry(Key::Floor) {
            Some(_) => Some(Floor::AtOrBelow(parts.surface.floor)),
            None => surface.pillars().map(|_| Floor::OffPillars),
        };
        let indenter = match parts.surface.indenter {
            IndenterForm::Lens => {
                let (shape, _) = self.lens_shape(&parts)?;
                ShapedLens::new(shape, parts.lens.material).into()
            }
            IndenterForm::Plate => Indenter::Flat(Some(parts.lens.material)),
        };
        let mut system = SurfaceSystem::new(indenter, parts.substrate, surface, boundary)
            .map_err(|invalid| self.impossible(&invalid))?;
        self.check_bases(&parts)?;
        self.check_adhesive_floor(self.adhesion(&parts), parts.pattern.floor)?;
        system = system
            .with_layers(parts.substrate_layer.layer(), parts.lens_layer.layer())
            .and_then(|system| system.with_interactions(parts.interactions))
            .and_then(|system| system.with_adhesion(self.adhesion(&parts)))
            .map_err(|invalid| self.impossible(&invalid))?;
        if matches!(origin, SurfaceOrigin::Pattern(_)) {
            system = system.continued();
        }
        if let SurfaceOrigin::Pattern(pattern) = &origin
            && let (CrossSection::Circle { diameter }, Top::Flat) =
                (pattern.pillar.cross_section, pattern.pillar.top)
        {
            system = system
                .with_round_tops(diameter)
                .map_err(|invalid| self.impossible(&invalid))?;
        }
        if let Some(floor) = floor {
            system = system
                .with_floor(floor)
                .with_floor_model(parts.pattern.floor);
        } else if let Some(key) = self.given_on_floor(&parts) {
            return Err(self
                .problem(
                    key,
                    "it is not known which part of this height map is the floor",
                )
                .accepted(format!(
                    "give {}, the height at or below which it is, or leave this out",
                    Key::Floor
                )));
        }
        Ok(SurfaceCase {
            system,
            origin,
            stated_unit,
            settings: self.settings(parts),
        })
    }

    /// The elastic bodies of a case with a general surface, without generating or reading the surface.
    ///
    /// # Errors
    /// [`CaseError`] for a missing key or an invalid value.
    pub fn surface_bodies(&self) -> Result<SurfaceBodies, CaseError> {
        let (kind, parts) = self.surface_parts()?;
        let bodies = [parts.lens.material, parts.substrate];
        let compliances = bodies.map(|body| body.plane_strain_compliance());
        Ok(SurfaceBodies {
            reduced_modulus: compliances.iter().sum::<f64>().recip(),
            has_columns: kind == Part::Pattern
                && parts.outline.compliance.0 != PillarCompliance::None,
        })
    }

    /// The pillars of a general surface, without generating it; `None` for a height map of a file.
    ///
    /// # Errors
    /// [`CaseError`] for a missing key or an invalid value.
    pub fn surface_pattern(&self) -> Result<Option<Pattern>, CaseError> {
        let (kind, parts) = self.surface_parts()?;
        let is_pattern = kind == Part::Pattern;
        is_pattern.then(|| self.pattern(&parts)).transpose()
    }

    /// Description of the surface, without generating or reading it.
    pub(crate) fn surface_example(&self) -> Result<SurfaceExample, CaseError> {
        let (kind, parts) = self.surface_parts()?;
        Ok(SurfaceExample {
            boundary: parts.surface.boundary,
            is_random: kind == Part::Pattern && parts.surface.name.0 == ArrangementName::Random,
            settings: self.settings(parts),
        })
    }

    /// Whether it is a height map or a pattern, and the values of all keys.
    pub(crate) fn surface_parts(&self) -> Result<(Part, Parts), CaseError> {
        self.refuse_pillar_pattern()?;
        let kind = self.kind_of_surface()?;
        let parts = self.parts(&[
            Part::Bodies,
            Part::Shape,
            Part::Surface,
            kind,
            Part::Interactions,
            Part::InteractionsOnFloor,
            Part::Adhesion,
            Part::AdhesionOnFloor,
            Part::FloorLoad,
        ])?;
        self.answers(Question::Press, Solver::HeightMap, &self.features(&parts))?;
        Ok((kind, parts))
    }

    /// The first given key of an interaction on the floor, of its adhesion, or that ignores it.
    fn given_on_floor(&self, parts: &Parts) -> Option<Key> {
        let mut given = self.entries.keys.keys().copied();
        let is_adhesive = parts.pattern.adhesion.floor.0;
        let is_ignored = parts.pattern.floor == FloorModel::Ignored;
        given.find(|key| {
            key.part() == Part::InteractionsOnFloor
                || *key == Key::AdhesiveFloor && is_adhesive
                || *key == Key::FloorContact && is_ignored
        })
    }

    /// The adhesion of a general surface, without generating or reading it.
    ///
    /// # Errors
    /// [`CaseError`] for a missing key or an invalid value.
    pub fn surface_adhesion(&self) -> Result<Adhesion, CaseError> {
        let (_, parts) = self.surface_parts()?;
        Ok(self.adhesion(&parts))
    }

    /// Whether a general surface defines its floor: by its height, or by its pillars.
    #[must_use]
    pub fn defines_floor(&self) -> bool {
        self.entry(Key::Floor).is_some() || self.entry(Key::Arrangement).is_some()
    }

    /// First position of a table or one of its keys.
    pub(crate) fn place_of(&self, table: &str) -> Option<&Place> {
        let header = self.entries.tables.get(table);
        let mut keys = self.entries.keys.iter();
        header.or_else(|| {
            let (_, entry) = keys.find(|(key, _)| root(key.path()) == table)?;
            Some(&entry.place)
        })
    }

    /// Refuses a general surface where a pillar pattern is required, with the given message.
    pub(crate) fn refuse_surface(&self, problem: &str, accepted: &str) -> Result<(), CaseError> {
        match (self.place_of("surface"), self.place_of("pattern")) {
            (None, _) => Ok(()),
            (Some(surface), Some(pattern)) => Err(pattern_and_surface(surface, pattern)),
            (Some(surface), None) => Err(CaseError::at(surface, problem)
                .key("surface")
                .accepted(accepted)),
        }
    }

    fn refuse_pillar_pattern(&self) -> Result<(), CaseError> {
        if let (Some(surface), Some(pattern)) = (self.place_of("surface"), self.place_of("pattern"))
        {
            return Err(pattern_and_surface(surface, pattern));
        }
        if let Some(place) = self.place_of("method") {
            return Err(CaseError::at(place, "a [surface] has no choice of methods")
                .key("method")
                .accepted("leave [method] out: surfaces are solved with boundary elements, on [surface.grid]"));
        }
        let mut given = self.entries.keys.keys().copied();
        match given.find(|key| key.part() == Part::PillarPattern) {
            None => Ok(()),
            Some(key) => Err(self
                .problem(key, format!("[{}] belongs to a [pattern]", key.table()))
                .accepted("leave it out, or describe round pillars as a [pattern]")),
        }
    }

    /// Whether the surface is a height map or a pattern; refuses the keys of the other.
    fn kind_of_surface(&self) -> Result<Part, CaseError> {
        let (map, pattern) = (Key::HeightMap, Key::Arrangement);
        let (kind, other) = match (self.entry(map), self.entry(pattern)) {
            (Some(_), None) => (Part::HeightMap, Part::Pattern),
            (None, Some(_)) => (Part::Pattern, Part::HeightMap),
            (Some(file), Some(pillars)) => {
                return Err(both_given(
                    (map.name(), &file.place),
                    (pattern.name(), &pillars.place),
                    map.table(),
                )
                .accepted("give only one: a height map, or pillars"));
            }
            (None, None) => {
                return Err(self
                    .missing(map)
                    .accepted(format!("give {map} = \"FILE\", or {pattern} for pillars")));
            }
        };
        let mut given = self.entries.keys.keys().copied();
        match given.find(|key| key.part() == other) {
            None => Ok(kind),
            Some(key) if kind == Part::HeightMap => Err(self
                .problem(key, "a height map does not have this key")
                .accepted(format!(
                    "leave it out, or give {pattern} in place of {}",
                    map.name()
                ))),
            Some(key) => Err(self
                .problem(key, "only a height map has this key")
                .accepted(match key {
                    Key::MapWidth => format!("the extent of a pattern is {}", Key::GridWidth),
                    _ => format!("leave it out, or give {map} in place of {}", pattern.name()),
                })),
        }
    }

    fn height_map(
        &self,
        parts: &SurfaceParts,
        path: &Path,
        memory_limit: usize,
    ) -> Result<ReadMap, CaseError> {
        let cell_size = self.entry(Key::CellSize);
        let width = self.entry(Key::MapWidth);
        let scale = GivenScale {
            size: cell_size
                .map(|_| MapSize::Pixel([parts.cell_size; 2]))
                .or(width.map(|_| MapSize::Width(parts.width))),
            height_unit: self.entry(Key::HeightUnit).map(|_| parts.height_unit),
            height_range: self.entry(Key::HeightRange).map(|_| parts.height_range),
            fill_missing: parts.missing_points == MissingPoints::Fill,
        };
        let array = self.entry(Key::Array).map(|_| parts.array.as_str());
        let extension = path.extension().unwrap_or_default();
        if array.is_some() && !extension.eq_ignore_ascii_case("npz") {
            let problem = format!(
                "only .npz files have named arrays, and this is {}",
                path.display()
            );
            return Err(self
                .problem(Key::Array, problem)
                .accepted("leave it out, or name an .npz file as surface.height_map"));
        }
        let read = match &self.table {
            Some((name, contents)) if name == path => map_in(path, contents, &scale, memory_limit),
            _ => read_map(path, array, &scale, memory_limit),
        };
        read.map_err(|error| match error {
            HeightMapError::TooLarge { points, bytes, .. } => {
                let points = format!("a map of {points}");
                self.too_large(Key::HeightMap, bytes, memory_limit, &points)
            }
            HeightMapError::NoSize { .. } => {
                let (key, other) = (Key::CellSize, Key::MapWidth);
                let accepted = format!("give exactly one of {key} and {other}");
                self.missing(key).accepted(accepted)
            }
            HeightMapError::Contradiction { what, .. } => {
                let key = match (what, cell_size) {
                    (HEIGHT_UNIT, _) => Key::HeightUnit,
                    (_, Some(_)) => Key::CellSize,
                    (_, None) => Key::MapWidth,
                };
                self.problem(key, error.to_string()).accepted(
                    "give what the file states; what it states with a unit can be left out",
                )
            }
            HeightMapError::Missing { .. } | HeightMapError::NoData { .. } => self
                .problem(Key::HeightMap, error.to_string())
                .accepted(format!(
                    "give {} = \"fill\" to interpolate them",
                    Key::MissingPoints
                )),
            HeightMapError::NoHeightRange { .. } => {
                self.missing(Key::HeightRange).accepted(format!(
                    "give {}, the height of white above black, or {}, that of one grey value",
                    Key::HeightRange,
                    Key::HeightUnit
                ))
            }
            HeightMapError::HeightRange { .. } => self
                .problem(Key::HeightRange, error.to_string())
                .accepted(format!("leave it out, or give {}", Key::HeightUnit)),
            HeightMapError::NotHeights { .. } => self
                .problem(Key::HeightMap, error.to_string())
                .accepted(format!("give {}", Key::HeightUnit)),
            error => self.problem(Key::HeightMap, error.to_string()),
        })
    }

    /// Refuses a height map whose heights are implausible relative to its extent, which indicates
    /// another unit.
    ///
    /// # Errors
    /// [`CaseError`] with the probable unit.
    pub fn refuse_absurd_heights(&self, case: &SurfaceCase) -> Result<(), CaseError> {
        let SurfaceOrigin::HeightMap(_) = case.origin else {
            return Ok(());
        };
        let surface = case.system.surface();
        let unit = match (self.given(Key::HeightUnit)?, case.stated_unit) {
            (Some(unit), _) => unit.abs(),
            (None, stated) => stated.unwrap_or(1.0),
        };
        if let Some((marker, count)) = marker_of_missing(surface.heights(), unit) {
            let times = if count == 1 {
                "once"
            } else {
                "in several points"
            };
            let problem = format!(
                "the number {marker} is in the file {times}, far from the heights: it probably marks missing points"
            );
            return Err(self
                .problem(Key::HeightMap, problem)
                .accepted("replace it by NaN in the file"));
        }
        let Some([range, extent]) = implausible_relief(surface) else {
            return Ok(());
        };
        let is_usual = |unit_meant: &&str| {
            let meant = parse_quantity(&format!("1 {unit_meant}"), Dimension::Length);
            let relief = meant.map_or(f64::NAN, |meant| range / unit * meant);
            relief >= 10.0 * LOWEST_RELIEF && relief <= 0.25 * HIGHEST_RELIEF * extent
        };
        let units = ["m", "mm", "um", "nm"].into_iter().filter(is_usual);
        let units: Vec<String> = units.take(2).map(|unit| format!("\"1 {unit}\"")).collect();
        let key = match self.entry(Key::HeightUnit) {
            Some(_) => Key::HeightUnit,
            None => Key::HeightMap,
        };
        let [range, extent, unit] = [range, extent, unit].map(shown);
        let problem = format!(
            "heights differ by {range} on a map of {extent}, where a height of 1 in the file stands for {unit}"
        );
        if case.stated_unit.is_some() {
            let accepted = "the file states this unit, which looks wrong: correct it in the file, or the size of the map";
            return Err(self.problem(key, problem).accepted(accepted));
        }
        Err(self.problem(key, problem).accepted(match &units[..] {
            [] => format!(
                "give {}, and the size of the map, as the file has them",
                Key::HeightUnit
            ),
            _ => format!("did you mean {} = {}?", Key::HeightUnit, units.join(" or ")),
        }))
    }

    /// Error for a surface that exceeds the memory limit.
    fn too_large(&self, key: Key, bytes: f64, limit: usize, what: &str) -> CaseError {
        let limit = limit as f64;
        self.problem(
            key,
            format!(
                "{what} takes {:.2} GB of memory or more; the limit is {:.2} GB",
                1e-9 * bytes,
                1e-9 * limit
            ),
        )
        .of_memory()
        .accepted(format!(
            "make it coarser: cells {:.1} times as large fit, if few of them are touched; or raise \
             the limit",
            // The factor is rounded up, so that cells of the size in the error fit into the memory.
            ((bytes / limit).sqrt() * 10.0).ceil() / 10.0
        ))
    }

    fn pattern(&self, parts: &Parts) -> Result<Pattern, CaseError> {
        let pillar = pillar(&parts.outline);
        let arrangement = self.arrangement(&parts.surface, &pillar.cross_section)?;
        let pattern = Pattern::new(pillar, arrangement);
        pattern
            .check()
            .map_err(|invalid| self.impossible_pattern(&invalid))?;
        Ok(pattern)
    }

    fn arrangement(
        &self,
        parts: &SurfaceParts,
        outline: &CrossSection,
    ) -> Result<Arrangement, CaseError> {
        let (name, given) = (parts.name.0, &parts.arrangement);
        let fraction = self.entry(Key::PatternFraction);
        let fraction = fraction.map(|_| given.surface_fraction);
        if let Some(fraction) = fraction {
            self.check_range(Key::PatternFraction, fraction)?;
        }
        let Some(unit) = given.plane_lattice(name, 1.0) else {
            let places = RandomPlaces::with_surface_fraction(
                given.surface_fraction,
                outline.area(),
                match self.entry(Key::MinimumDistance) {
                    Some(_) => given.minimum_distance,
                    None => outline.outer_diameter(),
                },
            );
            let disorder = given.disorder();
            return Ok(RandomPlaces { disorder, ..places }.into());
        };
        let pitch = fraction.map_or(given.lattice.pitch, |fraction| {
            (outline.area() / unit.form.cell_area() / fraction).sqrt()
        });
        Ok(unit.stretched(pitch).into())
    }

    /// Generates the pattern on a grid. Its cells are squares; if the grid is a period of the
    /// pattern, they are as close to squares as whole cells allow.
    fn draw(
        &self,
        pattern: &Pattern,
        parts: &Parts,
        memory_limit: usize,
    ) -> Result<HeightMap, CaseError> {
        let SurfaceParts {
            boundary,
            grid_cells,
            grid_width: width,
            ..
        } = parts.surface;
        let substrate = &parts.substrate;
        let cell = pattern.pillar.cross_section.inner_diameter() / grid_cells;
        let sides = match (boundary, pattern.period()) {
            (Boundary::Periodic, Some(period)) => {
                period.map(|side| side * (width / side).round().max(1.0))
            }
            _ => [width; 2],
        };
        let counts = sides.map(|side| CELLS_MULTIPLE * (side / cell / CELLS_MULTIPLE).ceil());
        let bytes = BYTES_PER_POINT * counts[0] * counts[1];
        if bytes > memory_limit as f64 {
            let size = format!("a grid of {} by {} cells", counts[0], counts[1]);
            return Err(self.too_large(Key::GridWidth, bytes, memory_limit, &size));
        }
        let counts = counts.map(|count| count as usize);
        let drawn = match boundary {
            Boundary::FreeSpace => Grid::centred(counts[0], counts[1], cell)
                .map(|grid| pattern.height_map(&grid, substrate)),
            Boundary::Periodic => period_grid(pattern, sides, counts)
                .map(|grid| pattern.periodic_height_map(&grid, substrate)),
        };
        drawn
            .map_err(|invalid| self.problem(Key::GridWidth, invalid.to_string()))?
            .map_err(|invalid| self.impossible_pattern(&invalid))
    }

    /// Error for an invalid pattern, at the key that causes it.
    fn impossible_pattern(&self, invalid: &InvalidPattern) -> CaseError {
        match invalid {
            InvalidPattern::Value {
                quantity,
                value,
                requirement,
            } => {
                let Some(key) = Key::of_pattern(*quantity) else {
                    return CaseError::new(&self.source, invalid.to_string());
                };
                let value = format_quantity(*value, key.dimension());
                self.problem(key, format!("cannot be {value}"))
                    .accepted(format!("it must be {requirement}"))
            }
            InvalidPattern::Overlap {
                pitch,
                outer_diameter,
            } => {
                let key = if self.entries.keys.contains_key(&Key::PatternPitch) {
                    Key::PatternPitch
                } else {
                    Key::PatternFraction
                };
                let [pitch, across] = [*pitch, *outer_diameter].map(shown);
                let problem = format!(
                    "neighbouring pillars overlap: at a pitch of {pitch} they are {across} across"
                );
                self.problem(key, problem)
                    .accepted("widen the pitch, lower the surface fraction, or turn the pillars")
            }
            InvalidPattern::TooCrowded {
                placed,
                wanted,
                minimum_distance,
            } => {
                let problem = format!(
                    "only {placed} of {wanted} pillars could be placed at least {} from the others",
                    shown(*minimum_distance)
                );
                self.problem(Key::PatternFraction, problem)
                    .accepted("lower the surface fraction or the minimum distance")
            }
            other => CaseError::new(&self.source, other.to_string()),
        }
    }

    /// All given keys and their values, as written in a case file.
    pub(crate) fn settings(&self, mut parts: Parts) -> Vec<(Key, String)> {
        for (key, place) in [
            (Key::HeightMap, &mut parts.surface.height_map),
            (Key::Pillars, &mut parts.pattern.pillars),
            (Key::LensProfile, &mut parts.shape.profile),
            (Key::RelaxationTable, &mut parts.relaxation.table),
        ] {
            // A file whose contents were given has only its name.
            let is_given = self
                .table
                .as_ref()
                .is_some_and(|(name, _)| name == Path::new(place));
            if is_given {
                continue;
            }
            let path = self.named_file(key, place);
            let path = std::path::absolute(&path).unwrap_or(path);
            *place = path.to_string_lossy().into_owned();
        }
        let keys = self.entries.keys.keys();
        keys.map(|key| (*key, key.written(&key.get(&mut parts))))
            .collect()
    }
}

/// The height difference and the extent of a map, m, if this difference is implausible, which indicates another unit.
#[must_use]
pub fn implausible_relief(map: &HeightMap) -> Option<[f64; 2]> {
    let (grid, range) = (map.grid(), map.highest() - map.lowest());
    let [width, height] = grid.cell();
    let extent = (width * grid.columns() as f64).max(height * grid.rows() as f64);
    let is_usual = (LOWEST_RELIEF..=HIGHEST_RELIEF * extent).contains(&range);
    (range != 0.0 && !is_usual).then_some([range, extent])
}

/// The number that programs write for a missing point and how many heights (m) have it, if these are far from the others.
fn marker_of_missing(heights: &[f64], unit: f64) -> Option<(String, usize)> {
    /// Numbers that mark missing points, of either sign: also the largest one of 4 bytes and half of it.
    const MARKERS: [f64; 6] = [
        999.99,
        9999.0,
        99_999.0,
        999_999.0,
        1.701_41e38,
        3.402_82e38,
    ];
    /// The smallest whole numbers of 2 and 4 bytes.
    const SMALLEST: [f64; 2] = [-32_768.0, -2_147_483_648.0];
    /// Relative precision of such a number as it is written.
    const SAME: f64 = 1e-5;
    /// Distance of the number from the other heights, over their range.
    const FAR: f64 = 2.0;
    let is_marker = |height: f64| {
        let value = height / unit;
        let is = |marker: &f64| (value - marker).abs() <= SAME * marker.abs();
        let mut signed = MARKERS.iter().flat_map(|marker| [*marker, -marker]);
        signed.any(|marker| is(&marker)) || SMALLEST.iter().any(is)
    };
    let ends = [f64::min, f64::max].map(|end| heights.iter().copied().reduce(end));
    let found = ends.into_iter().flatten().find(|end| is_marker(*end))?;
    let is_found = |height: f64| (height - found).abs() <= SAME * found.abs();
    let others = heights.iter().filter(|height| !is_found(**height));
    let (least, most) = others
        .clone()
        .fold((f64::MAX, f64::MIN), |(least, most), height| {
            (least.min(*height), most.max(*height))
        });
    let distance = (found - least).abs().min((found - most).abs());
    let count = heights.len() - others.count();
    // With six digits, without the error of the division.
    let marker: f64 = format!("{:.5e}", found / unit).parse().ok()?;
    let shown = match marker.abs() < 1e15 {
        true => marker.to_string(),
        false => format!("{marker:.4e}"),
    };
    // Two heights alone are those of a design.
    (most > least && distance > FAR * (most - least)).then_some((shown, count))
}

/// Pillar with the given values.
fn pillar(parts: &OutlineParts) -> PillarShape {
    let &OutlineParts { diameter, drop, .. } = parts;
    PillarShape {
        cross_section: match parts.form {
            OutlineForm::Circle => CrossSection::Circle { diameter },
            OutlineForm::Square => CrossSection::Square { side: parts.side },
            OutlineForm::Polygon => CrossSection::Polygon {
                sides: parts.sides as u32,
                diameter,
            },
            OutlineForm::Ellipse => CrossSection::Ellipse {
                length: parts.length,
                width: parts.width,
            },
        },
        orientation: parts.orientation,
        height: parts.height,
        top: match parts.top {
            TopForm::Flat => Top::Flat,
            TopForm::Cone => Top::Cone { drop },
            TopForm::Chamfer => Top::Chamfer {
                width: parts.chamfer_width,
                drop,
            },
            TopForm::Rounded => Top::Rounded {
                radius: parts.edge_radius,
            },
        },
        compliance: parts.compliance.0,
    }
}

pub(crate) fn pattern_and_surface(surface: &Place, pattern: &Place) -> CaseError {
    both_given(("[surface]", surface), ("[pattern]", pattern), "")
        .accepted("give only one: a hexagonal lattice of discs, or a general surface")
}

/// A grid of whole periods with the lens axis near its centre. Its borders are half-way between
/// neighbouring rows of pillars, where they cut the fewest pillars and pass through no centre.
fn period_grid(
    pattern: &Pattern,
    sides: Point,
    counts: [usize; 2],
) -> Result<Grid, fakir::problem::InvalidGrid> {
    let lattice = pattern.arrangement.lattice();
    let rows = match (pattern.period(), lattice) {
        // Every second row is shifted by half a period.
        (Some(period), Some(lattice)) if matches!(lattice.form, LatticeForm::Hexagonal { .. }) => {
            period.map(|side| 0.5 * side)
        }
        (Some(period), _) => period,
        (None, _) => sides,
    };
    // From a pillar to the lens axis.
    let offset = lattice.map_or([0.0; 2], |lattice| lattice.origin().map(|x| -x));
    let origin = [0, 1].map(|axis| {
        let first = ((offset[axis] - 0.5 * sides[axis]) / rows[axis] - 0.5).round() + 0.5;
        first * rows[axis] - offset[axis]
    });
    let cell = [0, 1].map(|axis| sides[axis] / counts[axis] as f64);
    Grid::new(counts[0], counts[1], cell, origin)
}
