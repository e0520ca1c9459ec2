//! A system with its method, and its canonical text.

use crate::key::{Key, Setting};
use crate::parts::{ArrangementName, OfPillarPattern, Parts};
use crate::table::Range;
use fakir::problem::{
    Arrangement, HexagonalLattice, Lens, Material, Method, Pillar, PillarCompliance, PillarPattern,
    Point, Relaxation, System,
};
use std::f64::consts::PI;
use std::fmt::Write;
use std::ops::Bound::{self, Excluded, Included};
use std::path::PathBuf;

/// A system and its method, as a case file describes them.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// The lens and the surface with its pillars.
    pub system: System,
    /// The method that solves it.
    pub method: Method,
    /// The given one of pitch and surface fraction, with its value. The same one is written back.
    pub(crate) spacing: Spacing,
    /// Source of listed pillars.
    pub(crate) pillars: Option<PillarsOrigin>,
    /// File of the table of heights of the lens, if any.
    pub(crate) profile: Option<PathBuf>,
    /// Relaxation of the bodies, if they are viscoelastic. The moduli of the system are the relaxed ones.
    pub relaxation: Option<Relaxation>,
    /// File of the table to which it was fitted, if any.
    pub(crate) relaxation_table: Option<PathBuf>,
}

/// A table of pillars.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PillarsOrigin {
    /// File, if any.
    pub(crate) path: Option<PathBuf>,
    /// Its columns and their unit, as the case gives them.
    pub(crate) columns: String,
    pub(crate) unit: String,
    /// Position of the lens axis in its coordinates, m.
    pub(crate) axis: Point,
}

/// The form in which the pitch was given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Spacing {
    Pitch(f64),
    SurfaceFraction(f64),
}

impl Spacing {
    pub(crate) fn pitch(self, arrangement: OfPillarPattern, diameter: f64) -> f64 {
        match (self, arrangement.0) {
            (Self::Pitch(pitch), _) => pitch,
            (Self::SurfaceFraction(fraction), ArrangementName::Square) => {
                0.5 * diameter * (PI / fraction).sqrt()
            }
            (Self::SurfaceFraction(fraction), _) => {
                HexagonalLattice::with_surface_fraction(fraction, diameter).pitch
            }
        }
    }
}

impl Case {
    /// A case that is written with its pitch.
    #[must_use]
    pub fn new(system: System, method: Method) -> Self {
        let spacing = Spacing::Pitch(system.pitch());
        Self {
            system,
            method,
            spacing,
            pillars: None,
            profile: None,
            relaxation: None,
            relaxation_table: None,
        }
    }

    /// The intermediate substrate of the paper (lens, substrate and pillars of the same elastomer)
    /// at a surface fraction of 0.1, as `fakir init` writes it.
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
        let system = System::new(lens, elastomer, PillarPattern::new(pillar, lattice));
        Self {
            system: system.expect("the paper's values are valid"),
            method: Method::default(),
            spacing: Spacing::SurfaceFraction(surface_fraction),
            pillars: None,
            profile: None,
            relaxation: None,
            relaxation_table: None,
        }
    }

    /// The case as a case file with comments. It depends only on the case; reading it gives the
    /// same case, bit for bit.
    #[must_use]
    pub fn to_toml(&self) -> String {
        write_toml(|key| self.value(key))
    }

    /// The same, with the name of a table of pillars that were given without a file.
    #[must_use]
    pub fn to_toml_with_table(&self, name: &str) -> String {
        let path = self.pillars.as_ref().and_then(|it| it.path.as_ref());
        let is_without_file =
            path.is_none() && matches!(self.system.arrangement(), Arrangement::Listed(_));
        write_toml(|key| match key {
            Key::Pillars if is_without_file => Some(toml::Value::from(name).to_string()),
            _ => self.value(key),
        })
    }

    /// Value of a key; `None` if the case does not have it.
    #[must_use]
    pub fn setting(&self, key: Key) -> Option<Setting> {
        let not_given = match self.spacing {
            Spacing::Pitch(_) => Key::SurfaceFraction,
            Spacing::SurfaceFraction(_) => Key::Pitch,
        };
        let mut parts = self.parts();
        let does_without = key == not_given || (key.row().unwritten)(&parts);
        let is_absent = does_without || key.is_of_surface() || key.idle_with(&mut parts).is_some();
        (!is_absent).then(|| key.get(&mut parts))
    }

    /// Values of its keys.
    fn parts(&self) -> Parts {
        let mut parts = Parts::of(&self.system, self.method);
        let text = |path: &Option<PathBuf>| {
            let path = path.as_deref();
            path.map_or_else(String::new, |path| path.to_string_lossy().into_owned())
        };
        if let Spacing::SurfaceFraction(fraction) = self.spacing {
            parts.pattern.arrangement.surface_fraction = fraction;
        }
        if let Some(path) = &self.relaxation_table {
            parts.relaxation.table = path.to_string_lossy().into_owned();
        } else if let Some(relaxation) = &self.relaxation {
            let terms = relaxation.terms().iter();
            (parts.relaxation.strengths, parts.relaxation.times) =
                terms.map(|term| (term.strength, term.time)).unzip();
        }
        if self.system.lens().profile().is_some() {
            parts.shape.profile = text(&self.profile);
        }
        if let (OfPillarPattern(ArrangementName::Listed), Some(origin)) =
            (parts.pattern.name, &self.pillars)
        {
            parts.pattern.pillars = text(&origin.path);
            parts.pattern.pillar_columns.clone_from(&origin.columns);
            parts.pattern.pillar_unit.clone_from(&origin.unit);
            parts.pattern.axis = origin.axis;
        }
        parts
    }

    /// Number of a key of the pattern, in SI units. Pitch and surface fraction both have a number, whichever was
    /// given. `None` if the key does not accept numbers, has none in this case, or belongs to a general surface.
    #[must_use]
    pub fn number(&self, key: Key) -> Option<f64> {
        match key.get(&mut self.parts()) {
            Setting::Number(value) if !key.is_of_surface() && value.is_finite() => Some(value),
            _ => None,
        }
    }

    /// Smallest and largest valid number of a key for fixed values of all other keys, in SI units.
    #[must_use]
    pub fn allowed(&self, key: Key) -> (Bound<f64>, Bound<f64>) {
        let given = |other: Key| match self.setting(other) {
            Some(Setting::Number(value)) => Some(value),
            _ => None,
        };
        let (mut least, mut greatest) = bounds_beside(key, |other| self.number(other), given);
        // A film is at least as thick as pillars are high, and a layer as a quarter of their diameter.
        let system = &self.system;
        let layers = [system.substrate_layer(), system.lens_layer()];
        let [film, lens] = layers.map(|layer| layer.map(|layer| layer.thickness));
        let quarter = 0.25 * system.largest_diameter();
        match key {
            Key::SubstrateThickness => least = Included(quarter.max(system.pillar().height)),
            Key::LensThickness => least = Included(quarter),
            Key::PillarHeight => greatest = lower(greatest, film),
            Key::PillarDiameter => {
                for thickness in [film, lens] {
                    greatest = lower(greatest, thickness.map(|thickness| 4.0 * thickness));
                }
            }
            _ => {}
        }
        (least, greatest)
    }

    /// Value of a key as [`to_toml`](Self::to_toml) writes it, such as `"2.2 mm"` with its quotes;
    /// `None` if the case does not have it.
    #[must_use]
    pub fn value(&self, key: Key) -> Option<String> {
        self.setting(key).map(|value| key.written(&value))
    }
}

/// Smallest and largest valid number of a key beside other keys, from their numbers and from those of the given ones.
pub(crate) fn bounds_beside(
    key: Key,
    number: impl Fn(Key) -> Option<f64>,
    given: impl Fn(Key) -> Option<f64>,
) -> (Bound<f64>, Bound<f64>) {
    let (mut least, mut greatest) = key.bounds();
    match key.range() {
        Some(Range::AtLeast(other)) => least = number(other).map_or(least, Included),
        Some(Range::Below(other)) => greatest = number(other).map_or(greatest, Excluded),
        _ => {}
    }
    // The valid range of another given key may depend on this one.
    for other in Key::ALL {
        match (other.range(), given(other)) {
            (Some(Range::AtLeast(limit)), Some(value)) if limit == key => {
                greatest = Included(value);
            }
            (Some(Range::Below(limit)), Some(value)) if limit == key => least = Excluded(value),
            _ => {}
        }
    }
    (least, greatest)
}

/// Text of a case file with all keys for which `value` returns a value, each with its meaning as a comment.
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

const HEADER: &str = "\
# A lens pressed onto a surface with pillars: a case for fakir.
# Quantities have a unit (m mm um nm, GPa MPa kPa Pa, deg rad); bare numbers are in SI units.
";

/// The smaller of an upper bound and an optional inclusive bound.
pub(crate) fn lower(bound: Bound<f64>, other: Option<f64>) -> Bound<f64> {
    match (bound, other) {
        (Included(value) | Excluded(value), Some(other)) if value <= other => bound,
        (_, Some(other)) => Included(other),
        (_, None) => bound,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CaseFile;
    use std::ops::Bound::Unbounded;

    /// The range of a key depends on the given keys: with a fixed pitch the diameter is limited, with a fixed surface
    /// fraction it is not.
    #[test]
    fn what_a_key_allows_depends_on_the_other_keys() {
        let by_fraction = Case::example();
        let pitch = by_fraction.number(Key::Pitch).unwrap();
        let mut file = CaseFile::parse("case", &by_fraction.to_toml()).unwrap();
        file.set_number(Key::Pitch, pitch);
        let by_pitch = file.case().unwrap();
        let fraction = by_pitch.number(Key::SurfaceFraction).unwrap();
        assert!((fraction - 0.1).abs() < 1e-15);
        assert_eq!(by_pitch.number(Key::MethodName), None);
        assert_eq!(by_pitch.number(Key::GridWidth), None);

        let above_zero = (Excluded(0.0), Unbounded);
        assert_eq!(by_fraction.allowed(Key::PillarDiameter), above_zero);
        let at_most_touching = (Excluded(0.0), Included(pitch));
        assert_eq!(by_pitch.allowed(Key::PillarDiameter), at_most_touching);
        assert_eq!(by_pitch.allowed(Key::Pitch), (Included(6e-6), Unbounded));
        assert_eq!(
            by_pitch.allowed(Key::LensRadius),
            (Excluded(2.2e-6), Unbounded)
        );
        assert_eq!(
            by_pitch.allowed(Key::PillarHeight),
            (Excluded(0.0), Excluded(2.2e-3))
        );
    }
}
