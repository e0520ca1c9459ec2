//! What is to be solved and how, and its canonical text.

use crate::key::{Key, Kind};
use crate::unit::{Dimension, format_quantity};
use fakir::problem::{Accuracy, Method, PunchForm};
use fakir::problem::{ElementMesh, MeshLayout};
use fakir::problem::{HexagonalLattice, Lens, Material, Pillar, PillarCompliance, System, Texture};
use std::fmt::Write;

/// A system and the method to solve it with: what a case file describes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// What is pressed.
    pub system: System,
    /// How it is solved.
    pub method: Method,
    /// Which of pitch and surface fraction was given, and is written back.
    pub(crate) spacing: Spacing,
}

/// How the pitch was given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Spacing {
    Pitch(f64),
    SurfaceFraction(f64),
}

impl Spacing {
    pub(crate) fn pitch(self, diameter: f64) -> f64 {
        match self {
            Self::Pitch(pitch) => pitch,
            Self::SurfaceFraction(fraction) => {
                HexagonalLattice::with_surface_fraction(fraction, diameter).pitch
            }
        }
    }
}

impl Case {
    /// A case to be written with its pitch.
    #[must_use]
    pub fn new(system: System, method: Method) -> Self {
        let spacing = Spacing::Pitch(system.lattice().pitch);
        Self {
            system,
            method,
            spacing,
        }
    }

    /// The intermediate substrate of the paper (lens, substrate and pillars of the same
    /// elastomer) at a surface fraction of 0.1: what `fakir init` writes.
    #[must_use]
    pub fn example() -> Self {
        let elastomer = Material::new(2e6, 0.5);
        let pillar = Pillar {
            diameter: 6e-6,
            height: 2.2e-6,
            compliance: PillarCompliance::Column,
        };
        let lens = Lens {
            radius: 2.2e-3,
            material: elastomer,
        };
        let surface_fraction = 0.1;
        let lattice = HexagonalLattice::with_surface_fraction(surface_fraction, pillar.diameter);
        let system = System::new(lens, elastomer, Texture { pillar, lattice });
        Self {
            system: system.expect("the paper's values are valid"),
            method: Method::default(),
            spacing: Spacing::SurfaceFraction(surface_fraction),
        }
    }

    /// The case as a case file, commented. It depends on the case alone, and reading it gives the
    /// same case, bit for bit.
    #[must_use]
    pub fn to_toml(&self) -> String {
        write_toml(|key| self.value(key))
    }

    fn mesh(&self) -> Option<ElementMesh> {
        match self.method {
            Method::Love(mesh) => Some(mesh),
            _ => None,
        }
    }

    /// The value of a key as [`to_toml`](Self::to_toml) writes it, such as `"2.2 mm"` with its
    /// quotes; `None` if the case does without it.
    #[must_use]
    pub fn value(&self, key: Key) -> Option<String> {
        let system = &self.system;
        let number = |value: f64| written_number(key, value);
        let word = |word: &str| format!("\"{word}\"");
        Some(match key {
            Key::LensRadius => number(system.lens().radius),
            Key::LensYoungModulus => number(system.lens().material.young_modulus),
            Key::LensPoissonRatio => number(system.lens().material.poisson_ratio),
            Key::SubstrateYoungModulus => number(system.substrate().young_modulus),
            Key::SubstratePoissonRatio => number(system.substrate().poisson_ratio),
            Key::Lattice => word("hexagonal"),
            Key::SurfaceFraction => match self.spacing {
                Spacing::SurfaceFraction(fraction) => number(fraction),
                Spacing::Pitch(_) => return None,
            },
            Key::Pitch => match self.spacing {
                Spacing::Pitch(pitch) => number(pitch),
                Spacing::SurfaceFraction(_) => return None,
            },
            Key::Offset => number(system.lattice().offset),
            Key::OffsetAngle => number(system.lattice().offset_angle),
            Key::PillarDiameter => number(system.pillar().diameter),
            Key::PillarHeight => number(system.pillar().height),
            Key::PillarCompliance => word(match system.pillar().compliance {
                PillarCompliance::Column => "column",
                PillarCompliance::None => "none",
            }),
            Key::MethodName => word(self.method.name()),
            Key::Accuracy => match self.method {
                Method::Spectral(Accuracy::Default) => word("default"),
                Method::Spectral(Accuracy::Accurate) => word("accurate"),
                _ => return None,
            },
            Key::Form => match self.method {
                Method::Punch(PunchForm::Corrected) => word("corrected"),
                Method::Punch(PunchForm::Plain) => word("plain"),
                _ => return None,
            },
            Key::CellsPerDiameter => number(self.mesh()?.cells_per_diameter as f64),
            Key::Mesh => word(match self.mesh()?.layout {
                MeshLayout::Pillars => "pillars",
                MeshLayout::Pattern => "pattern",
            }),
            Key::Cells => word(if self.mesh()?.matched {
                "matched"
            } else {
                "plain"
            }),
            _ => return None, // of a [surface]
        })
    }
}

/// A case file of the keys that have a value, each with what it means.
pub(crate) fn write_toml(value: impl Fn(Key) -> Option<String>) -> String {
    format!("{HEADER}{}", write_tables(value))
}

/// The tables of a case file, without its heading.
pub(crate) fn write_tables(value: impl Fn(Key) -> Option<String>) -> String {
    let mut text = String::new();
    let mut table = "";
    for key in Key::ALL {
        let Some(value) = value(key) else {
            continue;
        };
        if key.table() != table {
            table = key.table();
            let _ = writeln!(text, "\n[{table}]");
        }
        let setting = format!("{} = {value}", key.name());
        let _ = writeln!(text, "{setting:<28} # {}", key.summary());
    }
    text
}

/// The number of a key in TOML.
pub(crate) fn written_number(key: Key, value: f64) -> String {
    match key.kind() {
        Kind::Number(Dimension::Number) | Kind::Word | Kind::Text => {
            format_quantity(value, Dimension::Number)
        }
        Kind::Number(dimension) => format!("\"{}\"", format_quantity(value, dimension)),
    }
}

const HEADER: &str = "\
# A lens pressed onto a surface with pillars: a case for fakir.
# Quantities have a unit (m mm um nm, GPa MPa kPa Pa, deg rad); bare numbers are in SI units.
";
