//! A system and a method, as described by a case file.

use crate::asperities::Asperities;
use crate::error::{PYTHON, case_error, value_error, warn_of_file};
use crate::flat::Flat;
use crate::settings::{key, settings};
use crate::surface::Surface;
use fakir::problem::{Arrangement, ListedPillar, PillarList};
use fakir_case::unit::{Dimension, parse_argument};
use fakir_case::{CaseFile, Key, Setting, SurfaceKind};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// A validated case.
#[pyclass(frozen, module = "fakir._fakir")]
pub(crate) struct Case {
    pub(crate) case: fakir_case::Case,
}

#[pymethods]
impl Case {
    /// Creates a case from numbers in SI units and words, by their keys, and from listed pillars, if any: x, y, height and diameter of
    /// each, m.
    #[staticmethod]
    #[pyo3(signature = (numbers, words, pillars=None))]
    fn build(
        numbers: Vec<(String, f64)>,
        words: Vec<(String, String)>,
        pillars: Option<Vec<[f64; 4]>>,
    ) -> PyResult<Self> {
        let file = CaseFile::from_settings(PYTHON, settings(numbers, words)?);
        Self::of(with_pillars(file, pillars)?, &[])
    }

    /// Creates a case from a text, with listed pillars that are not in a file.
    #[staticmethod]
    fn with_listed(text: &str, pillars: Vec<[f64; 4]>) -> PyResult<Self> {
        let file = CaseFile::parse(PYTHON, text).map_err(|error| case_error(&error))?;
        let at = |key| file.given(key).map_err(|error| case_error(&error));
        let axis = [at(Key::AxisX)?, at(Key::AxisY)?].map(|x| x.unwrap_or(0.0));
        // Convert back to the coordinates of the list.
        let moved =
            |[x, y, height, diameter]: [f64; 4]| [x + axis[0], y + axis[1], height, diameter];
        let pillars = pillars.into_iter().map(moved).collect();
        Self::of(with_pillars(file, Some(pillars))?, &[])
    }

    /// Listed pillars: x and y from the lens axis, height and diameter of each, m; `None` for a lattice.
    fn listed(&self) -> Option<Vec<[f64; 4]>> {
        let Arrangement::Listed(list) = self.case.system.arrangement() else {
            return None;
        };
        let row = |pillar: &ListedPillar| {
            let [x, y] = pillar.centre;
            [x, y, pillar.height, pillar.diameter]
        };
        Some(list.pillars().iter().map(row).collect())
    }

    /// The case with other settings, such as `method.name=love`.
    fn with_settings(&self, settings: Vec<String>) -> PyResult<Self> {
        Self::of(self.file()?, &settings)
    }

    /// The case as a case file.
    fn to_toml(&self) -> String {
        self.case.to_toml()
    }

    /// The same, with the name of a table of pillars that were given as arrays.
    fn to_toml_with_table(&self, name: &str) -> String {
        self.case.to_toml_with_table(name)
    }

    /// Numbers in SI units and words, by their keys. Includes both pitch and surface fraction.
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let values = PyDict::new(py);
        for key in Key::ALL {
            match self.case.setting(key) {
                Some(Setting::Number(number)) => values.set_item(key.path(), number)?,
                Some(Setting::Word(word)) => values.set_item(key.path(), word)?,
                None => {}
            }
        }
        // One of the two was given; the other is derived.
        let system = &self.case.system;
        values.set_item(Key::Pitch.path(), system.pitch())?;
        let fraction = system.pattern().surface_fraction();
        values.set_item(Key::SurfaceFraction.path(), fraction)?;
        Ok(values)
    }

    /// Height of the undeformed lens above its lowest point, at a point relative to its axis, m.
    fn sag(&self, x: f64, y: f64) -> f64 {
        self.case.system.lens().sag([x, y])
    }

    /// Centre of a pillar, m from the lens axis.
    fn centre(&self, i: i64, j: i64) -> PyResult<[f64; 2]> {
        let centre = self.case.system.arrangement().centre((i, j));
        centre.ok_or_else(|| value_error(format!("there is no pillar ({i}, {j})")))
    }
}

impl Case {
    fn of(mut file: CaseFile, overrides: &[String]) -> PyResult<Self> {
        for setting in overrides {
            file.set(setting).map_err(|error| case_error(&error))?;
        }
        let case = file.case().map_err(|error| case_error(&error))?;
        warn_of_file(&file)?;
        Ok(Self { case })
    }

    /// The case as a parsed file.
    pub(crate) fn file(&self) -> PyResult<CaseFile> {
        self.case
            .to_file(PYTHON)
            .map_err(|error| case_error(&error))
    }
}

/// A file with listed pillars, if there are any.
fn with_pillars(file: CaseFile, pillars: Option<Vec<[f64; 4]>>) -> PyResult<CaseFile> {
    let Some(rows) = pillars else {
        return Ok(file);
    };
    let pillar = |[x, y, height, diameter]: [f64; 4]| ListedPillar {
        centre: [x, y],
        height,
        diameter,
    };
    let list = PillarList::new(rows.into_iter().map(pillar).collect());
    let list = list.map_err(|error| value_error(error.to_string()))?;
    Ok(file.with_pillars(list))
}

impl From<fakir_case::Case> for Case {
    fn from(case: fakir_case::Case) -> Self {
        Self { case }
    }
}

/// Content of a case file.
#[derive(IntoPyObject)]
pub(crate) enum Described {
    PillarPattern(Case),
    Surface(Surface),
    Asperities(Asperities),
    Flat(Flat),
}

impl Described {
    pub(crate) fn of(file: CaseFile, overrides: &[String], rounded: bool) -> PyResult<Self> {
        match file.surface_kind() {
            SurfaceKind::HeightMap => Surface::of(file, overrides, None).map(Self::Surface),
            SurfaceKind::Flat if rounded => Flat::of(file, overrides).map(Self::Flat),
            SurfaceKind::Asperities if rounded => {
                Asperities::of(file, overrides).map(Self::Asperities)
            }
            SurfaceKind::Asperities | SurfaceKind::Pillars | SurfaceKind::Flat => {
                Case::of(file, overrides).map(Self::PillarPattern)
            }
        }
    }
}

/// Reads a case file; rounded tops are refused unless permitted.
#[pyfunction]
pub(crate) fn read_case(
    path: PathBuf,
    overrides: Vec<String>,
    rounded: bool,
) -> PyResult<Described> {
    let file = CaseFile::read(&path).map_err(|error| case_error(&error))?;
    Described::of(file, &overrides, rounded)
}

/// Reads the text of a case file with flat tops or a height map; `name` is used in error messages.
#[pyfunction]
pub(crate) fn parse_case(name: &str, text: &str, overrides: Vec<String>) -> PyResult<Described> {
    let file = CaseFile::parse(name, text).map_err(|error| case_error(&error))?;
    Described::of(file, &overrides, false)
}

/// Dimension of the numbers of a key, or of all keys of a last name: `"length"` and similar.
#[pyfunction]
pub(crate) fn dimension(path: &str) -> PyResult<&'static str> {
    let named = [false, true].map(|surface| Key::named(path, surface));
    let mut dimensions = named.iter().flatten().map(|key| key.dimension());
    match dimensions.next() {
        Some(first) if dimensions.all(|other| other == first) => Ok(first.noun()),
        _ => Ok(key(path)?.dimension().noun()),
    }
}

/// A number with a unit, such as `2200 um`, or a bare number, in SI units.
#[pyfunction]
pub(crate) fn parse_quantity(text: &str, dimension: &str) -> PyResult<f64> {
    let dimension = match dimension {
        "length" => Dimension::Length,
        "pressure" => Dimension::Pressure,
        "force" => Dimension::Force,
        "energy per area" => Dimension::EnergyPerArea,
        "stiffness" => Dimension::Stiffness,
        "angle" => Dimension::Angle,
        "time" => Dimension::Time,
        "speed" => Dimension::Speed,
        "rate of a force" => Dimension::ForceRate,
        "fraction" => Dimension::Fraction,
        "number" => Dimension::Number,
        _ => return Err(value_error(format!("no dimension \"{dimension}\""))),
    };
    parse_argument(text, dimension)
        .map_err(|error| value_error(format!("{error}; {}", dimension.accepted())))
}
