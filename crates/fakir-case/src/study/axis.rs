//! Variables of a study, and their values.

use crate::file::Measured;
use crate::key::{Key, Kind, last_part, present, root};
use crate::parts::Words;
use crate::unit::{Dimension, format_quantity};
use std::fmt;
use strsim::levenshtein;

/// The value of a variable in a case.
pub use crate::key::Setting as Coordinate;

/// Variable of an axis of a study: a key of the case, the load, or a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variable {
    /// A key of the case.
    Key(Key),
    /// The prescribed indentation, m.
    Indentation,
    /// The prescribed force, N.
    Force,
    /// Time in which viscoelastic bodies are loaded, s.
    RampTime,
    /// Rate of the indentation while viscoelastic bodies are loaded, m/s.
    IndentationRate,
    /// Rate of the force while viscoelastic bodies are loaded, N/s.
    ForceRate,
    /// Time for which the load is then held, s.
    HoldTime,
}

impl Variable {
    /// The variables that are no keys: loads, times and rates.
    pub(crate) const PRESCRIBED: [Self; 6] = [
        Self::Indentation,
        Self::Force,
        Self::RampTime,
        Self::IndentationRate,
        Self::ForceRate,
        Self::HoldTime,
    ];

    /// The variables that prescribe how fast the load of a hold is reached, of which at most one is given.
    pub(crate) const RAMP: [Self; 3] = [Self::RampTime, Self::IndentationRate, Self::ForceRate];

    /// Name in a study: `"pattern.surface_fraction"`, `"indentation"`.
    #[must_use]
    pub fn path(self) -> &'static str {
        match self {
            Self::Key(key) => key.path(),
            Self::Indentation => "indentation",
            Self::Force => "force",
            Self::RampTime => "ramp_time",
            Self::IndentationRate => "indentation_rate",
            Self::ForceRate => "force_rate",
            Self::HoldTime => "hold_time",
        }
    }

    /// Name as a column, with its unit: `"substrate.young_modulus_Pa"`. A prescribed load is
    /// `"load.indentation_m"` or `"load.force_N"`, which distinguishes it from indentation and
    /// force as results.
    #[must_use]
    pub fn column(self) -> String {
        match (self, self.dimension()) {
            (Self::Key(key), _) => key.column(),
            (load, dimension) => {
                let suffix = dimension.map_or("", Dimension::suffix);
                format!("load.{}{suffix}", load.path())
            }
        }
    }

    /// Dimension of its values; `None` if they are words.
    #[must_use]
    pub fn dimension(self) -> Option<Dimension> {
        match self {
            Self::Key(key) => match key.kind() {
                Kind::Number(dimension) => Some(dimension),
                Kind::Word | Kind::Text | Kind::List(_) => None,
            },
            Self::Indentation => Some(Dimension::Length),
            Self::Force => Some(Dimension::Force),
            Self::RampTime | Self::HoldTime => Some(Dimension::Time),
            Self::IndentationRate => Some(Dimension::Speed),
            Self::ForceRate => Some(Dimension::ForceRate),
        }
    }

    /// Meaning of its numbers; plain numbers if they are words.
    pub(crate) fn measured(self) -> Measured {
        match self {
            Self::Key(key) => Measured::by(key),
            load => Measured::of(load.path(), load.dimension().unwrap_or(Dimension::Number)),
        }
    }

    pub(crate) fn is_load(self) -> bool {
        matches!(self, Self::Indentation | Self::Force)
    }

    /// Whether it is a rate, which is greater than 0.
    pub(crate) fn is_rate(self) -> bool {
        matches!(self, Self::IndentationRate | Self::ForceRate)
    }

    pub(crate) fn is_key(self) -> bool {
        matches!(self, Self::Key(_))
    }

    /// The variable that it excludes.
    pub(crate) fn alternative(self) -> Option<Self> {
        match self {
            Self::Key(key) => key.alternative().map(Self::Key),
            Self::Indentation => Some(Self::Force),
            Self::Force => Some(Self::Indentation),
            Self::RampTime | Self::IndentationRate | Self::ForceRate | Self::HoldTime => None,
        }
    }

    /// A value of the variable as written in TOML.
    pub(crate) fn written(self, value: f64) -> String {
        match self {
            Self::Key(key) => key.written_number(value),
            load => {
                let dimension = load.dimension().unwrap_or(Dimension::Number);
                format!("\"{}\"", format_quantity(value, dimension))
            }
        }
    }

    /// All variables of cases with a general surface, or with a pattern.
    fn all(surface: bool) -> impl Iterator<Item = Self> {
        let keys = Key::ALL.into_iter();
        let keys = keys.filter(move |key| key.is_of_bodies() || key.is_of_surface() == surface);
        keys.map(Self::Key).chain(Self::PRESCRIBED)
    }

    /// Returns the variable with that path or last name.
    pub(crate) fn named(name: &str, surface: bool) -> Result<Self, Unnamed> {
        let name = &*present(name);
        if let Some(variable) = Self::all(surface).find(|variable| variable.is_at(name)) {
            return Ok(variable);
        }
        let namesakes: Vec<Self> = Self::all(surface)
            .filter(|variable| variable.last_name() == name || variable.former_name() == Some(name))
            .collect();
        let others: &[&str] = match surface {
            true => &["pattern", "method"],
            false => &["surface"],
        };
        match namesakes[..] {
            [variable] => Ok(variable),
            [] if others.contains(&root(name)) => Err(Unnamed::OfTheOther { surface }),
            [] => Err(Unnamed::Unknown(similar(name, surface))),
            _ => Err(Unnamed::Ambiguous(namesakes)),
        }
    }

    fn is_at(self, path: &str) -> bool {
        self.path() == path || matches!(self, Self::Key(key) if key.former() == Some(path))
    }

    /// The last part of its deprecated path.
    pub(super) fn former_name(self) -> Option<&'static str> {
        let Self::Key(key) = self else {
            return None;
        };
        key.former_name()
    }

    fn last_name(self) -> &'static str {
        last_part(self.path())
    }
}

/// Reason why a name is not that of a variable.
pub(crate) enum Unnamed {
    Unknown(Option<&'static str>),
    Ambiguous(Vec<Variable>),
    /// A key of a pillar pattern although the case has a general surface, or vice versa.
    OfTheOther {
        surface: bool,
    },
}

/// Suggestion for a misspelt name: a path, or a last name if that is sufficient.
fn similar(name: &str, surface: bool) -> Option<&'static str> {
    // The right name in the wrong table is more likely than a misspelling.
    let misplaced = name
        .rsplit_once('.')
        .and_then(|(_, last)| Variable::all(surface).find(|variable| variable.last_name() == last));
    if let Some(variable) = misplaced {
        return Some(variable.path());
    }
    let dotted = name.contains('.');
    let distance = |variable: Variable| {
        let path = levenshtein(name, variable.path());
        let last = levenshtein(name, variable.last_name());
        if dotted { path } else { path.min(last) }
    };
    let (distance, nearest) = Variable::all(surface)
        .map(|variable| (distance(variable), variable))
        .min_by_key(|(distance, _)| *distance)?;
    (distance <= 1 + name.len() / 5).then(|| nearest.path())
}

/// One axis of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    pub(crate) variable: Variable,
    pub(crate) values: Values,
}

/// The values of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Values {
    Numbers(Vec<f64>),
    Words(Vec<String>),
    Range(Range),
}

/// Numbers from one to another, both inclusive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Range {
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Number of values, at least 2.
    pub(crate) points: usize,
    pub(crate) spacing: PointSpacing,
}

/// Spacing of the points of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PointSpacing {
    /// Equal differences.
    Linear,
    /// Equal ratios.
    Log,
}

impl Words for PointSpacing {
    const WORDS: &'static [(&'static str, Self)] = &[("linear", Self::Linear), ("log", Self::Log)];
}

impl Range {
    /// Value of a point, identical on every machine.
    fn at(&self, point: usize) -> f64 {
        let last = self.points - 1;
        if point == 0 {
            return self.from;
        }
        if point == last {
            return self.to;
        }
        let part = point as f64 / last as f64;
        match self.spacing {
            PointSpacing::Linear => self.from + (self.to - self.from) * part,
            PointSpacing::Log => self.from * libm::pow(self.to / self.from, part),
        }
    }
}

impl Axis {
    /// Variable.
    #[must_use]
    pub fn variable(&self) -> Variable {
        self.variable
    }

    /// Number of values, at least one.
    #[must_use]
    #[allow(clippy::len_without_is_empty)] // it never is
    pub fn len(&self) -> usize {
        match &self.values {
            Values::Numbers(numbers) => numbers.len(),
            Values::Words(words) => words.len(),
            Values::Range(range) => range.points,
        }
    }

    /// The value at a step from 0 to [`len`](Self::len), exclusively.
    #[must_use]
    pub fn value(&self, step: usize) -> Coordinate {
        match &self.values {
            Values::Numbers(numbers) => Coordinate::Number(numbers[step]),
            Values::Words(words) => Coordinate::Word(words[step].clone()),
            Values::Range(range) => Coordinate::Number(range.at(step)),
        }
    }

    /// Whether its values are numbers, not words.
    #[must_use]
    pub fn is_numeric(&self) -> bool {
        !matches!(self.values, Values::Words(_))
    }

    /// A value as written in a study file: `pattern.pitch = "20 um"`.
    pub(crate) fn setting(&self, step: usize) -> String {
        let value = match self.value(step) {
            Coordinate::Number(number) => self.variable.written(number),
            Coordinate::Word(word) => format!("\"{word}\""),
        };
        format!("{} = {value}", self.variable.path())
    }
}

/// As in a study file.
impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = |value: &f64| self.variable.written(*value);
        let list = |items: Vec<String>| format!("[{}]", items.join(", "));
        let values = match &self.values {
            Values::Numbers(numbers) => list(numbers.iter().map(number).collect()),
            Values::Words(words) => list(words.iter().map(|word| format!("\"{word}\"")).collect()),
            Values::Range(range) => {
                format!(
                    "{{ from = {}, to = {}, points = {}, spacing = \"{}\" }}",
                    number(&range.from),
                    number(&range.to),
                    range.points,
                    range.spacing.word()
                )
            }
        };
        write!(f, "\"{}\" = {values}", self.variable.path())
    }
}
