//! The keys of a case file: the one list from which files are read, errors are worded and files
//! are written.

use crate::unit::Dimension;
use fakir::system::Quantity;

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
}

impl Key {
    /// Every key, in the order in which files are written.
    pub const ALL: [Self; 19] = [
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

    fn split(self) -> (&'static str, &'static str) {
        self.path().rsplit_once('.').unwrap_or(("", self.path()))
    }

    /// What kind of value it takes.
    #[must_use]
    pub fn kind(self) -> Kind {
        match self {
            Self::LensRadius | Self::Pitch | Self::PillarDiameter | Self::PillarHeight => {
                Kind::Number(Dimension::Length)
            }
            Self::LensYoungModulus | Self::SubstrateYoungModulus => {
                Kind::Number(Dimension::Pressure)
            }
            Self::OffsetAngle => Kind::Number(Dimension::Angle),
            Self::LensPoissonRatio
            | Self::SubstratePoissonRatio
            | Self::SurfaceFraction
            | Self::Offset
            | Self::CellsPerDiameter => Kind::Number(Dimension::Number),
            Self::Lattice
            | Self::PillarCompliance
            | Self::MethodName
            | Self::Accuracy
            | Self::Form
            | Self::Mesh
            | Self::Cells => Kind::Word,
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
            _ => None,
        }
    }

    /// The key that sets a quantity of a [`System`](fakir::system::System); loads have none.
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
    let elsewhere = Key::ALL.into_iter().find(|key| key.name() == name);
    elsewhere.map(|key| key.path().to_owned())
}

/// `table.name`, or the name alone at the top level.
pub(crate) fn join(table: &str, name: &str) -> String {
    match table {
        "" => name.to_owned(),
        _ => format!("{table}.{name}"),
    }
}

/// The number of letters to insert, remove or replace to make `a` into `b` (Levenshtein).
fn edit_distance(a: &str, b: &str) -> usize {
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
        assert_eq!(names_in(""), ["lens", "substrate", "texture", "method"]);
        assert!(names_in("texture").contains(&"pillar"));
    }

    #[test]
    fn misspelt_and_misplaced_keys() {
        assert_eq!(similar("lens.raduis").unwrap(), "lens.radius");
        assert_eq!(
            similar("texture.diameter").unwrap(),
            "texture.pillar.diameter"
        );
        assert_eq!(similar("lense").unwrap(), "lens");
        assert_eq!(similar("lens.colour"), None);
        assert_eq!(edit_distance("kitten", "sitting"), 3);
    }
}
