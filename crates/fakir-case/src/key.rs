//! The keys of a case file: the one list from which files are read, errors are worded and files
//! are written.

use crate::unit::Dimension;
use fakir::problem::Quantity;

/// A key of a case file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Key {
    /// `lens.radius`
    LensRadius,
    /// `lens.young_modulus`
    LensYoungModulus,
    /// `lens.poisson_ratio`
    LensPoissonRatio,
    /// `substrate.young_modulus`
    SubstrateYoungModulus,
    /// `substrate.poisson_ratio`
    SubstratePoissonRatio,
    /// `texture.lattice`
    Lattice,
    /// `texture.surface_fraction`
    SurfaceFraction,
    /// `texture.pitch`
    Pitch,
    /// `texture.offset`
    Offset,
    /// `texture.offset_angle`
    OffsetAngle,
    /// `texture.pillar.diameter`
    PillarDiameter,
    /// `texture.pillar.height`
    PillarHeight,
    /// `texture.pillar.compliance`
    PillarCompliance,
    /// `surface.height_map`
    HeightMap,
    /// `surface.array`
    Array,
    /// `surface.height_unit`
    HeightUnit,
    /// `surface.cell_size`
    CellSize,
    /// `surface.width`
    MapWidth,
    /// `surface.arrangement`
    Arrangement,
    /// `surface.surface_fraction`
    PatternFraction,
    /// `surface.pitch`
    PatternPitch,
    /// `surface.minimum_distance`
    MinimumDistance,
    /// `surface.offset`
    PatternOffset,
    /// `surface.offset_angle`
    PatternOffsetAngle,
    /// `surface.missing`
    Missing,
    /// `surface.height_spread`
    HeightSpread,
    /// `surface.seed`
    Seed,
    /// `surface.floor`
    Floor,
    /// `surface.boundary`
    Boundary,
    /// `surface.indenter`
    Indenter,
    /// `surface.pillar.cross_section`
    CrossSection,
    /// `surface.pillar.diameter`
    OutlineDiameter,
    /// `surface.pillar.side`
    OutlineSide,
    /// `surface.pillar.sides`
    OutlineSides,
    /// `surface.pillar.length`
    OutlineLength,
    /// `surface.pillar.width`
    OutlineWidth,
    /// `surface.pillar.orientation`
    Orientation,
    /// `surface.pillar.height`
    PatternHeight,
    /// `surface.pillar.top`
    Top,
    /// `surface.pillar.drop`
    Drop,
    /// `surface.pillar.chamfer_width`
    ChamferWidth,
    /// `surface.pillar.edge_radius`
    EdgeRadius,
    /// `surface.pillar.compliance`
    PatternCompliance,
    /// `surface.grid.cells_per_diameter`
    GridCells,
    /// `surface.grid.width`
    GridWidth,
    /// `method.name`
    MethodName,
    /// `method.accuracy`
    Accuracy,
    /// `method.form`
    Form,
    /// `method.cells_per_diameter`
    CellsPerDiameter,
    /// `method.mesh`
    Mesh,
    /// `method.cells`
    Cells,
}

/// What kind of value a key takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A number of some dimension.
    Number(Dimension),
    /// One of some words.
    Word,
    /// The name of a file, or of something in it.
    Text,
}

impl Key {
    /// Every key, in the order in which files are written.
    pub const ALL: [Self; 51] = [
        Self::LensRadius,
        Self::LensYoungModulus,
        Self::LensPoissonRatio,
        Self::SubstrateYoungModulus,
        Self::SubstratePoissonRatio,
        Self::Lattice,
        Self::SurfaceFraction,
        Self::Pitch,
        Self::Offset,
        Self::OffsetAngle,
        Self::PillarDiameter,
        Self::PillarHeight,
        Self::PillarCompliance,
        Self::HeightMap,
        Self::Array,
        Self::HeightUnit,
        Self::CellSize,
        Self::MapWidth,
        Self::Arrangement,
        Self::PatternFraction,
        Self::PatternPitch,
        Self::MinimumDistance,
        Self::PatternOffset,
        Self::PatternOffsetAngle,
        Self::Missing,
        Self::HeightSpread,
        Self::Seed,
        Self::Floor,
        Self::Boundary,
        Self::Indenter,
        Self::CrossSection,
        Self::OutlineDiameter,
        Self::OutlineSide,
        Self::OutlineSides,
        Self::OutlineLength,
        Self::OutlineWidth,
        Self::Orientation,
        Self::PatternHeight,
        Self::Top,
        Self::Drop,
        Self::ChamferWidth,
        Self::EdgeRadius,
        Self::PatternCompliance,
        Self::GridCells,
        Self::GridWidth,
        Self::MethodName,
        Self::Accuracy,
        Self::Form,
        Self::CellsPerDiameter,
        Self::Mesh,
        Self::Cells,
    ];

    /// The key with its tables: `"texture.pillar.diameter"`.
    #[must_use]
    pub fn path(self) -> &'static str {
        match self {
            Self::LensRadius => "lens.radius",
            Self::LensYoungModulus => "lens.young_modulus",
            Self::LensPoissonRatio => "lens.poisson_ratio",
            Self::SubstrateYoungModulus => "substrate.young_modulus",
            Self::SubstratePoissonRatio => "substrate.poisson_ratio",
            Self::Lattice => "texture.lattice",
            Self::SurfaceFraction => "texture.surface_fraction",
            Self::Pitch => "texture.pitch",
            Self::Offset => "texture.offset",
            Self::OffsetAngle => "texture.offset_angle",
            Self::PillarDiameter => "texture.pillar.diameter",
            Self::PillarHeight => "texture.pillar.height",
            Self::PillarCompliance => "texture.pillar.compliance",
            Self::HeightMap => "surface.height_map",
            Self::Array => "surface.array",
            Self::HeightUnit => "surface.height_unit",
            Self::CellSize => "surface.cell_size",
            Self::MapWidth => "surface.width",
            Self::Arrangement => "surface.arrangement",
            Self::PatternFraction => "surface.surface_fraction",
            Self::PatternPitch => "surface.pitch",
            Self::MinimumDistance => "surface.minimum_distance",
            Self::PatternOffset => "surface.offset",
            Self::PatternOffsetAngle => "surface.offset_angle",
            Self::Missing => "surface.missing",
            Self::HeightSpread => "surface.height_spread",
            Self::Seed => "surface.seed",
            Self::Floor => "surface.floor",
            Self::Boundary => "surface.boundary",
            Self::Indenter => "surface.indenter",
            Self::CrossSection => "surface.pillar.cross_section",
            Self::OutlineDiameter => "surface.pillar.diameter",
            Self::OutlineSide => "surface.pillar.side",
            Self::OutlineSides => "surface.pillar.sides",
            Self::OutlineLength => "surface.pillar.length",
            Self::OutlineWidth => "surface.pillar.width",
            Self::Orientation => "surface.pillar.orientation",
            Self::PatternHeight => "surface.pillar.height",
            Self::Top => "surface.pillar.top",
            Self::Drop => "surface.pillar.drop",
            Self::ChamferWidth => "surface.pillar.chamfer_width",
            Self::EdgeRadius => "surface.pillar.edge_radius",
            Self::PatternCompliance => "surface.pillar.compliance",
            Self::GridCells => "surface.grid.cells_per_diameter",
            Self::GridWidth => "surface.grid.width",
            Self::MethodName => "method.name",
            Self::Accuracy => "method.accuracy",
            Self::Form => "method.form",
            Self::CellsPerDiameter => "method.cells_per_diameter",
            Self::Mesh => "method.mesh",
            Self::Cells => "method.cells",
        }
    }

    /// The key named by `path`.
    #[must_use]
    pub fn at(path: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|key| key.path() == path)
    }

    /// The table it is in: `"texture.pillar"`.
    #[must_use]
    pub fn table(self) -> &'static str {
        self.split().0
    }

    /// The key within its table: `"diameter"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.split().1
    }

    /// Whether it belongs to a `[surface]`.
    pub(crate) fn is_of_surface(self) -> bool {
        root(self.path()) == "surface"
    }

    fn split(self) -> (&'static str, &'static str) {
        self.path().rsplit_once('.').unwrap_or(("", self.path()))
    }

    /// What kind of value it takes.
    #[must_use]
    pub fn kind(self) -> Kind {
        match self {
            Self::LensRadius
            | Self::Pitch
            | Self::PillarDiameter
            | Self::PillarHeight
            | Self::HeightUnit
            | Self::CellSize
            | Self::MapWidth
            | Self::PatternPitch
            | Self::MinimumDistance
            | Self::Floor
            | Self::OutlineDiameter
            | Self::OutlineSide
            | Self::OutlineLength
            | Self::OutlineWidth
            | Self::PatternHeight
            | Self::Drop
            | Self::ChamferWidth
            | Self::EdgeRadius
            | Self::GridWidth => Kind::Number(Dimension::Length),
            Self::LensYoungModulus | Self::SubstrateYoungModulus => {
                Kind::Number(Dimension::Pressure)
            }
            Self::OffsetAngle | Self::PatternOffsetAngle | Self::Orientation => {
                Kind::Number(Dimension::Angle)
            }
            Self::LensPoissonRatio
            | Self::SubstratePoissonRatio
            | Self::SurfaceFraction
            | Self::Offset
            | Self::CellsPerDiameter
            | Self::PatternFraction
            | Self::PatternOffset
            | Self::Missing
            | Self::HeightSpread
            | Self::Seed
            | Self::OutlineSides
            | Self::GridCells => Kind::Number(Dimension::Number),
            Self::Lattice
            | Self::PillarCompliance
            | Self::MethodName
            | Self::Accuracy
            | Self::Form
            | Self::Mesh
            | Self::Cells
            | Self::Arrangement
            | Self::Boundary
            | Self::Indenter
            | Self::CrossSection
            | Self::Top
            | Self::PatternCompliance => Kind::Word,
            Self::HeightMap | Self::Array => Kind::Text,
        }
    }

    /// What it means, in a few words.
    #[must_use]
    pub fn summary(self) -> &'static str {
        match self {
            Self::LensRadius => "radius of curvature",
            Self::LensYoungModulus => "Young's modulus",
            Self::LensPoissonRatio => "Poisson's ratio, 0 to 0.5",
            Self::SubstrateYoungModulus => "Young's modulus, of the pillars too",
            Self::SubstratePoissonRatio => "Poisson's ratio, 0 to 0.5",
            Self::Lattice => "arrangement of the pillars: hexagonal",
            Self::SurfaceFraction => {
                "part of the surface that is pillar top; or give pitch instead"
            }
            Self::Pitch => "distance of neighbouring pillars; or give surface_fraction instead",
            Self::Offset => "distance of the lens axis from a pillar centre, in pitches",
            Self::OffsetAngle => "direction of the offset; x points to a second neighbour",
            Self::PillarDiameter => "diameter of a pillar",
            Self::PillarHeight => "height of a pillar",
            Self::PillarCompliance => "column: pillars shorten under load; or none",
            Self::HeightMap => {
                "file of heights: .npy, .npz or numbers; or give arrangement instead"
            }
            Self::Array => "name of the array to read, of an .npz file with several",
            Self::HeightUnit => "what a height of 1 in the file stands for",
            Self::CellSize => "distance of neighbouring points of the map; or give width instead",
            Self::MapWidth => "extent of the map along x; or give cell_size instead",
            Self::Arrangement => {
                "of pillars: hexagonal, square or random; or give height_map instead"
            }
            Self::PatternFraction => "part of the surface that is pillar; or give pitch instead",
            Self::PatternPitch => {
                "distance of neighbouring pillars; or give surface_fraction instead"
            }
            Self::MinimumDistance => "between the centres of random pillars",
            Self::PatternOffset => "distance of the lens axis from a pillar centre, in pitches",
            Self::PatternOffsetAngle => "direction of the offset from x",
            Self::Missing => "part of the pillars that are missing",
            Self::HeightSpread => "relative variation of the heights of pillars",
            Self::Seed => "whole number that decides what is random",
            Self::Floor => "floor is what is at or below this height; else all that is no pillar",
            Self::Boundary => "free: nothing is touched beyond the grid; or periodic",
            Self::Indenter => "lens or plate",
            Self::CrossSection => "circle, square, polygon or ellipse",
            Self::OutlineDiameter => "of a circle, or of that through the corners of a polygon",
            Self::OutlineSide => "of a square",
            Self::OutlineSides => "of a polygon: how many",
            Self::OutlineLength => "of an ellipse, along x",
            Self::OutlineWidth => "of an ellipse, along y",
            Self::Orientation => "by which pillars are turned, anticlockwise",
            Self::PatternHeight => "height of a pillar",
            Self::Top => "flat, cone, chamfer or rounded",
            Self::Drop => "of a cone or chamfer: how much lower the edge is than the centre",
            Self::ChamferWidth => "distance from the edge at which a chamfer begins",
            Self::EdgeRadius => "of a rounded top",
            Self::PatternCompliance => "column: pillars shorten under load; or none",
            Self::GridCells => "cells across the narrowest diameter of a pillar, 4 or more",
            Self::GridWidth => {
                "extent of the grid around the lens axis; of a periodic lattice whole periods"
            }
            Self::MethodName => "spectral (exact), love (elements), punch or homogenised",
            Self::Accuracy => "of the spectral method: default or accurate",
            Self::Form => "of the punch method: corrected or plain",
            Self::CellsPerDiameter => "of the method love: squares across a pillar, 8 or more",
            Self::Mesh => "of the method love: a grid on all pillars, or one over the pattern",
            Self::Cells => "of the method love: matched to a flat punch, or plain",
        }
    }

    /// The key that cannot be given together with it.
    #[must_use]
    pub fn alternative(self) -> Option<Self> {
        match self {
            Self::SurfaceFraction => Some(Self::Pitch),
            Self::Pitch => Some(Self::SurfaceFraction),
            Self::PatternFraction => Some(Self::PatternPitch),
            Self::PatternPitch => Some(Self::PatternFraction),
            Self::CellSize => Some(Self::MapWidth),
            Self::MapWidth => Some(Self::CellSize),
            _ => None,
        }
    }

    /// The key that sets a quantity of a [`System`](fakir::problem::System); loads have none.
    #[must_use]
    pub fn of(quantity: Quantity) -> Option<Self> {
        match quantity {
            Quantity::LensRadius => Some(Self::LensRadius),
            Quantity::LensYoungModulus => Some(Self::LensYoungModulus),
            Quantity::LensPoissonRatio => Some(Self::LensPoissonRatio),
            Quantity::SubstrateYoungModulus => Some(Self::SubstrateYoungModulus),
            Quantity::SubstratePoissonRatio => Some(Self::SubstratePoissonRatio),
            Quantity::PillarDiameter => Some(Self::PillarDiameter),
            Quantity::PillarHeight => Some(Self::PillarHeight),
            Quantity::Pitch => Some(Self::Pitch),
            Quantity::SurfaceFraction => Some(Self::SurfaceFraction),
            Quantity::Offset => Some(Self::Offset),
            Quantity::OffsetAngle => Some(Self::OffsetAngle),
            _ => None,
        }
    }
}

/// Whether `path` names a table of a case file.
pub(crate) fn is_table(path: &str) -> bool {
    path == "texture" || Key::ALL.into_iter().any(|key| key.table() == path)
}

/// Names that can stand in the table `path`, tables included; the top level is `""`.
pub(crate) fn names_in(path: &str) -> Vec<&'static str> {
    let mut names: Vec<&'static str> = Key::ALL
        .into_iter()
        .filter_map(|key| {
            let below = match path {
                "" => key.path(),
                _ => key.path().strip_prefix(path)?.strip_prefix('.')?,
            };
            below.split('.').next()
        })
        .collect();
    names.dedup();
    names
}

/// The path of a key or table that `path` may have been meant to be: one spelt nearly so in the
/// same table, or one of the same name in another.
pub(crate) fn similar(path: &str) -> Option<String> {
    let (table, name) = path.rsplit_once('.').unwrap_or(("", path));
    let near = names_in(table)
        .into_iter()
        .map(|known| (edit_distance(name, known), known))
        .min()
        .filter(|(distance, known)| *distance <= 1 + known.len() / 4);
    if let Some((_, known)) = near {
        return Some(join(table, known));
    }
    let namesakes = || Key::ALL.into_iter().filter(|key| key.name() == name);
    let close_by = namesakes().find(|key| root(key.path()) == root(path));
    let elsewhere = close_by.or_else(|| namesakes().next());
    elsewhere.map(|key| key.path().to_owned())
}

/// The outermost table of a path.
pub(crate) fn root(path: &str) -> &str {
    path.split('.').next().unwrap_or(path)
}

/// `table.name`, or the name alone at the top level.
pub(crate) fn join(table: &str, name: &str) -> String {
    match table {
        "" => name.to_owned(),
        _ => format!("{table}.{name}"),
    }
}

/// The number of letters to insert, remove or replace to make `a` into `b` (Levenshtein).
pub(crate) fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for j in 0..b.len() {
            let replaced = diagonal + usize::from(letter != b[j]);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_found_by_its_path() {
        for key in Key::ALL {
            assert_eq!(Key::at(key.path()), Some(key));
            assert!(is_table(key.table()));
            assert!(names_in(key.table()).contains(&key.name()));
        }
        assert_eq!(
            names_in(""),
            ["lens", "substrate", "texture", "surface", "method"]
        );
        assert!(names_in("texture").contains(&"pillar"));
    }

    #[test]
    fn misspelt_and_misplaced_keys() {
        assert_eq!(similar("lens.raduis").unwrap(), "lens.radius");
        assert_eq!(
            similar("texture.diameter").unwrap(),
            "texture.pillar.diameter"
        );
        assert_eq!(
            similar("surface.diameter").unwrap(),
            "surface.pillar.diameter"
        );
        assert_eq!(similar("lense").unwrap(), "lens");
        assert_eq!(similar("lens.colour"), None);
        assert_eq!(edit_distance("kitten", "sitting"), 3);
    }
}
