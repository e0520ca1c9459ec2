//! Cases with a general surface in place of a texture: a height map, or pillars of any form.

use crate::case::{write_toml, written_number};
use crate::entries::{Entry, Value, kind_name};
use crate::error::{CaseError, Place};
use crate::file::{CaseFile, both_given, number, one_of};
use crate::height_map::{BYTES_PER_POINT, HeightMapError, MapScale, MapSize, read_height_map};
use crate::key::{Key, Kind, root};
use crate::unit::{Dimension, format_quantity};
use fakir::problem::pattern::{
    Arrangement, CrossSection, InvalidPattern, Pattern, PatternQuantity, PillarShape, Top,
};
use fakir::problem::{Boundary, Floor, Grid, HeightMap, Indenter, SurfaceSystem};
use fakir::problem::{HexagonalLattice, Lens, Material, PillarCompliance, Point};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// A general surface and what is pressed onto it: what a case file with a `[surface]` describes.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceCase {
    /// What is pressed.
    pub system: SurfaceSystem,
    /// Which part of the surface is the floor; none for a height map without `surface.floor`.
    pub floor: Option<Floor>,
    /// Where the surface is from.
    pub origin: SurfaceOrigin,
    /// What was given, in TOML.
    settings: Vec<(Key, String)>,
}

/// Where a surface is from.
#[derive(Debug, Clone, PartialEq)]
pub enum SurfaceOrigin {
    /// A file of heights.
    HeightMap(PathBuf),
    /// Pillars.
    Pattern(Pattern),
}

impl SurfaceCase {
    /// Whether a wider `surface.grid` shows more of the same surface: that of pillars on a lattice
    /// does. A height map ends with its data, and on another grid pillars at random stand elsewhere.
    #[must_use]
    pub fn can_grow(&self) -> bool {
        match &self.origin {
            SurfaceOrigin::HeightMap(_) => false,
            SurfaceOrigin::Pattern(pattern) => {
                !matches!(pattern.arrangement, Arrangement::Random { .. })
            }
        }
    }

    /// The case as a case file, commented. It has what was given, a height map by its absolute
    /// path; reading it gives the same case, bit for bit.
    #[must_use]
    pub fn to_toml(&self) -> String {
        write_toml(|key| {
            let setting = self.settings.iter().find(|(given, _)| *given == key);
            setting.map(|(_, value)| value.clone())
        })
    }
}

/// Cells along the sides of a grid are a multiple of this, so that it can be solved on cells
/// twice and four times as large.
const CELLS_MULTIPLE: f64 = 4.0;

/// Cells across a pillar if the case does not say.
const CELLS_PER_DIAMETER: u64 = 16;

/// Whole numbers that a number in a case file holds exactly.
const WHOLE_NUMBERS: RangeInclusive<u64> = 0..=1 << f64::MANTISSA_DIGITS;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Form {
    Circle,
    Square,
    Polygon,
    Ellipse,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum TopForm {
    Flat,
    Cone,
    Chamfer,
    Rounded,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Placement {
    Hexagonal,
    Square,
    Random,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum IndenterForm {
    Lens,
    Plate,
}

const FORMS: [(&str, Form); 4] = [
    ("circle", Form::Circle),
    ("square", Form::Square),
    ("polygon", Form::Polygon),
    ("ellipse", Form::Ellipse),
];

const TOPS: [(&str, TopForm); 4] = [
    ("flat", TopForm::Flat),
    ("cone", TopForm::Cone),
    ("chamfer", TopForm::Chamfer),
    ("rounded", TopForm::Rounded),
];

const PLACEMENTS: [(&str, Placement); 3] = [
    ("hexagonal", Placement::Hexagonal),
    ("square", Placement::Square),
    ("random", Placement::Random),
];

const INDENTERS: [(&str, IndenterForm); 2] =
    [("lens", IndenterForm::Lens), ("plate", IndenterForm::Plate)];

const BOUNDARIES: [(&str, Boundary); 2] = [
    ("free", Boundary::FreeSpace),
    ("periodic", Boundary::Periodic),
];

const COMPLIANCES: [(&str, PillarCompliance); 2] = [
    ("column", PillarCompliance::Column),
    ("none", PillarCompliance::None),
];

/// The keys that only some choices have: key, key of the choice, its words.
const OWNERS: [(Key, Key, &[&str]); 13] = [
    (Key::LensRadius, Key::Indenter, &["lens"]),
    (
        Key::PatternPitch,
        Key::Arrangement,
        &["hexagonal", "square"],
    ),
    (
        Key::PatternOffset,
        Key::Arrangement,
        &["hexagonal", "square"],
    ),
    (
        Key::PatternOffsetAngle,
        Key::Arrangement,
        &["hexagonal", "square"],
    ),
    (Key::MinimumDistance, Key::Arrangement, &["random"]),
    (
        Key::OutlineDiameter,
        Key::CrossSection,
        &["circle", "polygon"],
    ),
    (Key::OutlineSide, Key::CrossSection, &["square"]),
    (Key::OutlineSides, Key::CrossSection, &["polygon"]),
    (Key::OutlineLength, Key::CrossSection, &["ellipse"]),
    (Key::OutlineWidth, Key::CrossSection, &["ellipse"]),
    (Key::Drop, Key::Top, &["cone", "chamfer"]),
    (Key::ChamferWidth, Key::Top, &["chamfer"]),
    (Key::EdgeRadius, Key::Top, &["rounded"]),
];

/// The keys that only a height map has.
const OF_HEIGHT_MAP: [Key; 4] = [Key::Array, Key::HeightUnit, Key::CellSize, Key::MapWidth];

/// The keys that any surface has.
const OF_ANY: [Key; 4] = [Key::HeightMap, Key::Floor, Key::Boundary, Key::Indenter];

/// Whether other keys go with only some of the words of this one.
pub(crate) fn is_choice(key: Key) -> bool {
    OWNERS.iter().any(|(_, choice, _)| *choice == key)
}

/// The keys that do not go with this word of a choice.
pub(crate) fn idle_keys(choice: Key, word: &str) -> impl Iterator<Item = Key> {
    OWNERS
        .iter()
        .filter(move |(_, of, words)| *of == choice && !words.contains(&word))
        .map(|(key, _, _)| *key)
}

impl CaseFile {
    /// Whether the case has a general surface: a `[surface]`, or an override of one of its keys.
    #[must_use]
    pub fn is_surface(&self) -> bool {
        self.place_of("surface").is_some()
    }

    /// The case with a general surface that the file and its overrides describe.
    ///
    /// `memory_limit` is the most memory (bytes) that the surface and the fields on it may take.
    ///
    /// # Errors
    /// [`CaseError`] for a key that is missing or has a value that cannot be, a `[texture]` or a
    /// `[method]`, a height map that cannot be read, or a surface too large for the memory.
    pub fn surface_case(&self, memory_limit: usize) -> Result<SurfaceCase, CaseError> {
        self.refuse_texture()?;
        let indenter = self.indenter()?;
        let substrate = Material::new(
            self.number(Key::SubstrateYoungModulus)?,
            self.number(Key::SubstratePoissonRatio)?,
        );
        let boundary = self
            .choice(Key::Boundary, &BOUNDARIES)?
            .unwrap_or(Boundary::FreeSpace);
        let (surface, origin) = match self.map_or_pattern()? {
            Some(entry) => {
                let (surface, path) = self.height_map(entry, memory_limit)?;
                (surface, SurfaceOrigin::HeightMap(path))
            }
            None => {
                let pattern = self.pattern()?;
                let surface = self.draw(&pattern, boundary, &substrate, memory_limit)?;
                (surface, SurfaceOrigin::Pattern(pattern))
            }
        };
        let floor = match self.entries.keys.get(&Key::Floor) {
            Some(entry) => Some(Floor::AtOrBelow(self.finite(Key::Floor, entry)?)),
            None => surface.pillars().map(|_| Floor::OffPillars),
        };
        let mut system = SurfaceSystem::new(indenter, substrate, surface, boundary)
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
        Ok(SurfaceCase {
            system,
            floor,
            origin,
            settings: self.settings()?,
        })
    }

    /// Where a table or one of its keys was first set.
    fn place_of(&self, table: &str) -> Option<&Place> {
        let header = self.entries.tables.get(table);
        let mut keys = self.entries.keys.iter();
        header.or_else(|| {
            let (_, entry) = keys.find(|(key, _)| root(key.path()) == table)?;
            Some(&entry.place)
        })
    }

    /// Refuses a general surface where a texture is wanted.
    pub(crate) fn refuse_surface(&self) -> Result<(), CaseError> {
        match (self.place_of("surface"), self.place_of("texture")) {
            (None, _) => Ok(()),
            (Some(surface), Some(texture)) => Err(texture_and_surface(surface, texture)),
            (Some(surface), None) => Err(CaseError::at(
                surface,
                "this needs a [texture], and the case has a [surface]",
            )
            .key("surface")
            .accepted(
                "fakir press and fakir transition take a [surface]; all commands a [texture]",
            )),
        }
    }

    fn refuse_texture(&self) -> Result<(), CaseError> {
        if let (Some(surface), Some(texture)) = (self.place_of("surface"), self.place_of("texture"))
        {
            return Err(texture_and_surface(surface, texture));
        }
        match self.place_of("method") {
            Some(method) => Err(
                CaseError::at(method, "a [surface] has no choice of methods")
                    .key("method")
                    .accepted(
                        "leave [method] out: surfaces are solved by elements, on [surface.grid]",
                    ),
            ),
            None => Ok(()),
        }
    }

    fn indenter(&self) -> Result<Indenter, CaseError> {
        let form = self.chosen(Key::Indenter, &INDENTERS, IndenterForm::Lens)?;
        let material = Material::new(
            self.number(Key::LensYoungModulus)?,
            self.number(Key::LensPoissonRatio)?,
        );
        Ok(match form {
            IndenterForm::Lens => Indenter::Lens(Lens {
                radius: self.number(Key::LensRadius)?,
                material,
            }),
            IndenterForm::Plate => Indenter::Flat(Some(material)),
        })
    }

    /// The entry of the height map, if that is what the case has; refuses the keys of the other.
    fn map_or_pattern(&self) -> Result<Option<&Entry>, CaseError> {
        let keys = &self.entries.keys;
        let (map, arrangement) = (keys.get(&Key::HeightMap), keys.get(&Key::Arrangement));
        if let (Some(map), Some(arrangement)) = (map, arrangement) {
            let [map, arrangement] = [
                ("height_map", &map.place),
                ("arrangement", &arrangement.place),
            ];
            return Err(both_given(map, arrangement, "surface")
                .accepted("give only one: a height map, or pillars"));
        }
        if map.is_none() && arrangement.is_none() {
            return Err(self.missing(Key::HeightMap).accepted(
                "give surface.height_map = \"FILE\", or surface.arrangement for pillars",
            ));
        }
        let mut given = keys
            .keys()
            .copied()
            .filter(|key| key.is_of_surface() && !OF_ANY.contains(key));
        let idle = given.find(|key| OF_HEIGHT_MAP.contains(key) != map.is_some());
        match (idle, map) {
            (None, _) => Ok(map),
            (Some(key), Some(_)) => Err(self
                .problem(key, "a height map does not have this key")
                .accepted("leave it out, or give surface.arrangement in place of height_map")),
            (Some(key), None) => Err(self
                .problem(key, "only a height map has this key")
                .accepted(match key {
                    Key::MapWidth => "the extent of a pattern is surface.grid.width",
                    _ => "leave it out, or give surface.height_map in place of arrangement",
                })),
        }
    }

    fn height_map(
        &self,
        entry: &Entry,
        memory_limit: usize,
    ) -> Result<(HeightMap, PathBuf), CaseError> {
        let path = self.path(entry)?;
        let array = match self.entries.keys.get(&Key::Array) {
            Some(entry) => Some(text(Key::Array, entry)?),
            None => None,
        };
        let keys = &self.entries.keys;
        let size = match (keys.get(&Key::CellSize), keys.get(&Key::MapWidth)) {
            (Some(cell), None) => {
                if let Value::Other("array") = cell.value {
                    return Err(self
                        .problem(Key::CellSize, "cells are squares, of one size")
                        .accepted("give one length; resample a map of other cells"));
                }
                MapSize::Pixel([self.positive(Key::CellSize)?; 2])
            }
            (None, Some(_)) => MapSize::Width(self.positive(Key::MapWidth)?),
            (None, None) => {
                return Err(self
                    .missing(Key::CellSize)
                    .accepted("give exactly one of surface.cell_size and surface.width"));
            }
            (Some(cell), Some(width)) => {
                let [cell, width] = [("cell_size", &cell.place), ("width", &width.place)];
                return Err(both_given(cell, width, "surface")
                    .accepted("give only one: the other follows from it"));
            }
        };
        let height_unit = match keys.get(&Key::HeightUnit) {
            Some(entry) => {
                let unit = self.finite(Key::HeightUnit, entry)?;
                if unit == 0.0 {
                    return Err(self.problem(Key::HeightUnit, "cannot be 0").accepted(
                        "it must be another length; negative where the file has depths",
                    ));
                }
                unit
            }
            None => 1.0,
        };
        let scale = MapScale { size, height_unit };
        match read_height_map(&path, array, &scale, memory_limit) {
            Ok(surface) => Ok((surface, path)),
            Err(HeightMapError::TooLarge { points, bytes, .. }) => {
                let points = format!("a map of {points}");
                Err(self.too_large(Key::HeightMap, bytes, memory_limit, &points))
            }
            Err(error) => Err(self.problem(Key::HeightMap, error.to_string())),
        }
    }

    /// A surface that needs more memory than there may be.
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
        .accepted(format!(
            "make it coarser: cells {:.1} times as large fit, if few of them are touched; or raise \
             the limit",
            // Rounded up, so that they do.
            ((bytes / limit).sqrt() * 10.0).ceil() / 10.0
        ))
    }

    /// The file named by an entry: next to the case file; of an override, in the current folder.
    fn path(&self, entry: &Entry) -> Result<PathBuf, CaseError> {
        let name = Path::new(text(Key::HeightMap, entry)?);
        Ok(match entry.place.source.name() {
            "--set" => name.to_owned(),
            _ => self.folder.join(name),
        })
    }

    fn pattern(&self) -> Result<Pattern, CaseError> {
        let pillar = self.pillar()?;
        let pattern = Pattern {
            pillar,
            arrangement: self.arrangement(&pillar.cross_section)?,
            missing: self.number_or(Key::Missing, 0.0)?,
            height_spread: self.number_or(Key::HeightSpread, 0.0)?,
            seed: self.whole(Key::Seed, WHOLE_NUMBERS)?.unwrap_or(0),
        };
        pattern
            .check()
            .map_err(|invalid| self.impossible_pattern(&invalid))?;
        Ok(pattern)
    }

    fn pillar(&self) -> Result<PillarShape, CaseError> {
        let cross_section = match self.chosen(Key::CrossSection, &FORMS, Form::Circle)? {
            Form::Circle => CrossSection::Circle {
                diameter: self.number(Key::OutlineDiameter)?,
            },
            Form::Square => CrossSection::Square {
                side: self.number(Key::OutlineSide)?,
            },
            Form::Polygon => CrossSection::Polygon {
                sides: self
                    .whole(Key::OutlineSides, 3..=1000)?
                    .ok_or_else(|| self.missing(Key::OutlineSides))? as u32,
                diameter: self.number(Key::OutlineDiameter)?,
            },
            Form::Ellipse => CrossSection::Ellipse {
                length: self.number(Key::OutlineLength)?,
                width: self.number(Key::OutlineWidth)?,
            },
        };
        let top = match self.chosen(Key::Top, &TOPS, TopForm::Flat)? {
            TopForm::Flat => Top::Flat,
            TopForm::Cone => Top::Cone {
                drop: self.number(Key::Drop)?,
            },
            TopForm::Chamfer => Top::Chamfer {
                width: self.number(Key::ChamferWidth)?,
                drop: self.number(Key::Drop)?,
            },
            TopForm::Rounded => Top::Rounded {
                radius: self.number(Key::EdgeRadius)?,
            },
        };
        Ok(PillarShape {
            cross_section,
            orientation: self.number_or(Key::Orientation, 0.0)?,
            height: self.number(Key::PatternHeight)?,
            top,
            compliance: self
                .choice(Key::PatternCompliance, &COMPLIANCES)?
                .unwrap_or_default(),
        })
    }

    fn arrangement(&self, outline: &CrossSection) -> Result<Arrangement, CaseError> {
        let placement = self.chosen(Key::Arrangement, &PLACEMENTS, Placement::Hexagonal)?;
        if placement == Placement::Random {
            return Ok(Arrangement::Random {
                surface_fraction: self.number(Key::PatternFraction)?,
                minimum_distance: self.number_or(Key::MinimumDistance, outline.outer_diameter())?,
            });
        }
        // Of a lattice of pitch 1.
        let unit_cell_area = match placement {
            Placement::Hexagonal => HexagonalLattice::new(1.0).cell_area(),
            _ => 1.0,
        };
        let pitch = self.pitch(outline.area() / unit_cell_area)?;
        let lattice = HexagonalLattice {
            pitch,
            offset: self.number_or(Key::PatternOffset, 0.0)?,
            offset_angle: self.number_or(Key::PatternOffsetAngle, 0.0)?,
        };
        Ok(match placement {
            Placement::Hexagonal => Arrangement::Hexagonal(lattice),
            _ => Arrangement::Square {
                pitch,
                offset: lattice.offset_vector(),
            },
        })
    }

    /// The pitch of a lattice with a surface fraction of 1 at the pitch `sqrt(full)`.
    fn pitch(&self, full: f64) -> Result<f64, CaseError> {
        let keys = &self.entries.keys;
        let fraction = keys.get(&Key::PatternFraction);
        match (fraction, keys.get(&Key::PatternPitch)) {
            (Some(_), None) => {
                let fraction = self.number(Key::PatternFraction)?;
                if fraction > 0.0 && fraction < 1.0 {
                    return Ok((full / fraction).sqrt());
                }
                Err(self
                    .problem(Key::PatternFraction, format!("cannot be {fraction}"))
                    .accepted("it must be above 0 and below 1"))
            }
            (None, Some(_)) => self.number(Key::PatternPitch),
            (None, None) => Err(self
                .missing(Key::PatternFraction)
                .accepted("give exactly one of surface.surface_fraction and surface.pitch")),
            (Some(fraction), Some(pitch)) => {
                let [fraction, pitch] = [
                    ("surface_fraction", &fraction.place),
                    ("pitch", &pitch.place),
                ];
                Err(both_given(fraction, pitch, "surface")
                    .accepted("give only one: the other follows from it"))
            }
        }
    }

    /// The pattern on a grid of cells that are squares, or nearly so on a period.
    fn draw(
        &self,
        pattern: &Pattern,
        boundary: Boundary,
        substrate: &Material,
        memory_limit: usize,
    ) -> Result<HeightMap, CaseError> {
        let cells = self
            .whole(Key::GridCells, 4..=1024)?
            .unwrap_or(CELLS_PER_DIAMETER);
        let cell = pattern.pillar.cross_section.inner_diameter() / cells as f64;
        let width = self.positive(Key::GridWidth)?;
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

    /// The error for a pattern that cannot be, at the key that is to blame.
    fn impossible_pattern(&self, invalid: &InvalidPattern) -> CaseError {
        match invalid {
            InvalidPattern::Value {
                quantity,
                value,
                requirement,
            } => {
                let Some(key) = key_of(*quantity) else {
                    return CaseError::new(&self.source, invalid.to_string());
                };
                let value = match key.kind() {
                    Kind::Number(dimension) => format_quantity(*value, dimension),
                    Kind::Word | Kind::Text => value.to_string(),
                };
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
                let [pitch, across] = [*pitch, *outer_diameter].map(rounded);
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
                    "only {placed} of {wanted} pillars found a place {} from the others",
                    rounded(*minimum_distance)
                );
                self.problem(Key::PatternFraction, problem)
                    .accepted("lower the surface fraction or the minimum distance")
            }
            other => CaseError::new(&self.source, other.to_string()),
        }
    }

    /// The choice that a key makes; refuses the keys that do not go with it.
    fn chosen<T: Copy + PartialEq>(
        &self,
        key: Key,
        options: &[(&str, T)],
        default: T,
    ) -> Result<T, CaseError> {
        let value = self.choice(key, options)?.unwrap_or(default);
        let word = options.iter().find(|(_, option)| *option == value);
        let word = word.map_or("", |(word, _)| *word);
        let idle = idle_keys(key, word).find(|idle| self.entries.keys.contains_key(idle));
        let Some(idle) = idle else {
            return Ok(value);
        };
        let owners = OWNERS.iter().filter(|(owned, _, _)| *owned == idle);
        let words: Vec<(&str, ())> = owners
            .flat_map(|(_, _, words)| words.iter().map(|word| (*word, ())))
            .collect();
        Err(self
            .problem(
                idle,
                format!("with {} = \"{word}\" there is no such key", key.path()),
            )
            .accepted(format!(
                "leave it out, or {} as {}",
                one_of(&words),
                key.path()
            )))
    }

    /// A whole number; `None` if it is not given.
    fn whole(&self, key: Key, range: RangeInclusive<u64>) -> Result<Option<u64>, CaseError> {
        let Some(entry) = self.entries.keys.get(&key) else {
            return Ok(None);
        };
        let value = number(key, entry)?;
        let (first, last) = (*range.start(), *range.end());
        if value.fract() == 0.0 && value >= first as f64 && value <= last as f64 {
            return Ok(Some(value as u64));
        }
        Err(self
            .problem(key, format!("cannot be {value}"))
            .accepted(format!("it must be a whole number from {first} to {last}")))
    }

    fn finite(&self, key: Key, entry: &Entry) -> Result<f64, CaseError> {
        let value = number(key, entry)?;
        if value.is_finite() {
            return Ok(value);
        }
        Err(self
            .problem(key, format!("cannot be {value}"))
            .accepted("it must be a finite number"))
    }

    fn positive(&self, key: Key) -> Result<f64, CaseError> {
        let value = self.number(key)?;
        if value > 0.0 && value.is_finite() {
            return Ok(value);
        }
        Err(self
            .problem(
                key,
                format!("cannot be {}", format_quantity(value, Dimension::Length)),
            )
            .accepted("it must be a finite number greater than 0"))
    }

    /// What was given, in TOML.
    fn settings(&self) -> Result<Vec<(Key, String)>, CaseError> {
        let quoted = |text: &str| toml::Value::from(text).to_string();
        self.entries
            .keys
            .iter()
            .map(|(key, entry)| {
                let value = match (key.kind(), &entry.value) {
                    (Kind::Number(_), _) => written_number(*key, number(*key, entry)?),
                    _ if *key == Key::HeightMap => {
                        let path = self.path(entry)?;
                        let path = std::path::absolute(&path).unwrap_or(path);
                        quoted(&path.to_string_lossy())
                    }
                    _ => quoted(text(*key, entry)?),
                };
                Ok((*key, value))
            })
            .collect()
    }
}

fn text(key: Key, entry: &Entry) -> Result<&str, CaseError> {
    match &entry.value {
        Value::Text(text) => Ok(text),
        other => {
            let problem = format!("expected a string, found {}", kind_name(other));
            Err(CaseError::at(&entry.place, problem)
                .key(key.path())
                .accepted("give a name in quotes"))
        }
    }
}

fn texture_and_surface(surface: &Place, texture: &Place) -> CaseError {
    both_given(("[surface]", surface), ("[texture]", texture), "")
        .accepted("give only one: a hexagonal lattice of discs, or a general surface")
}

/// A grid of whole periods with the lens axis near its centre. Its borders are where they cut the
/// fewest pillars, and go through no centre: half way between neighbouring rows of pillars.
fn period_grid(
    pattern: &Pattern,
    sides: Point,
    counts: [usize; 2],
) -> Result<Grid, fakir::problem::InvalidGrid> {
    let (rows, offset) = match pattern.arrangement {
        Arrangement::Hexagonal(lattice) => {
            let period = pattern.period().unwrap_or(sides);
            (period.map(|side| 0.5 * side), lattice.offset_vector())
        }
        Arrangement::Square { pitch, offset } => ([pitch; 2], offset),
        Arrangement::Random { .. } => (sides, [0.0, 0.0]),
    };
    let origin = [0, 1].map(|axis| {
        let first = ((offset[axis] - 0.5 * sides[axis]) / rows[axis] - 0.5).round() + 0.5;
        first * rows[axis] - offset[axis]
    });
    let cell = [0, 1].map(|axis| sides[axis] / counts[axis] as f64);
    Grid::new(counts[0], counts[1], cell, origin)
}

/// A length in four digits.
fn rounded(length: f64) -> String {
    let value = format!("{length:.3e}").parse().unwrap_or(length);
    format_quantity(value, Dimension::Length)
}

/// The key that sets a quantity of a [`Pattern`].
fn key_of(quantity: PatternQuantity) -> Option<Key> {
    use PatternQuantity as Q;
    Some(match quantity {
        Q::Diameter => Key::OutlineDiameter,
        Q::Side => Key::OutlineSide,
        Q::Sides => Key::OutlineSides,
        Q::Length => Key::OutlineLength,
        Q::Width => Key::OutlineWidth,
        Q::Orientation => Key::Orientation,
        Q::Height => Key::PatternHeight,
        Q::Drop => Key::Drop,
        Q::ChamferWidth => Key::ChamferWidth,
        Q::EdgeRadius => Key::EdgeRadius,
        Q::Pitch => Key::PatternPitch,
        Q::Offset => Key::PatternOffset,
        Q::OffsetAngle => Key::PatternOffsetAngle,
        Q::SurfaceFraction => Key::PatternFraction,
        Q::MinimumDistance => Key::MinimumDistance,
        Q::Missing => Key::Missing,
        Q::HeightSpread => Key::HeightSpread,
        Q::YoungModulus => Key::SubstrateYoungModulus,
        _ => return None,
    })
}
