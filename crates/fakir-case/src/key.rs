//! Properties of a key, from the [table](crate::table).

use crate::parts::{Parts, TRUE_OR_FALSE};
use crate::table::{Field, Part, Presence, Range, Row, TABLE};
use crate::unit::{Dimension, format_quantity};
use fakir::problem::Quantity;
use fakir::problem::pattern::PatternQuantity;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt;
use std::ops::Bound;

pub use crate::table::Key;

/// The table of the pillar pattern.
pub(crate) const PATTERN_TABLE: &str = "pattern";

/// Deprecated name of [`PATTERN_TABLE`], which is still accepted with a warning.
pub(crate) const FORMER_TABLE: &str = "texture"; // former name

/// Kind of value of a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A number of some dimension.
    Number(Dimension),
    /// One of some words.
    Word,
    /// Name of a file, or of something in a file.
    Text,
    /// A list of numbers of some dimension.
    List(Dimension),
}

/// The value of a key, or of an axis of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "a value must be a finite number in SI units, or a text such as \"20 um\""
)]
pub enum Setting {
    /// In SI units.
    Number(f64),
    /// One of some words, or another text.
    Word(String),
}

impl Key {
    fn entry(self) -> &'static (Part, &'static str, Row) {
        &TABLE[self as usize]
    }

    /// Its row of the table.
    pub(crate) fn row(self) -> &'static Row {
        &self.entry().2
    }

    /// Part of a case to which it belongs.
    pub(crate) fn part(self) -> Part {
        self.entry().0
    }

    /// The key with its tables: `"pattern.pillar.diameter"`.
    #[must_use]
    pub fn path(self) -> &'static str {
        self.entry().1
    }

    /// Returns the key named by `path`, which may be a [former](Self::former) one, or in a table by its former name.
    #[must_use]
    pub fn at(path: &str) -> Option<Self> {
        let path = &*present(path);
        let mut keys = Self::ALL.into_iter();
        keys.find(|key| key.path() == path || key.former() == Some(path))
    }

    /// Returns the key named by `path` if this is a deprecated name of it.
    #[must_use]
    pub fn at_former(path: &str) -> Option<Self> {
        Self::at(path).filter(|key| key.path() != path)
    }

    /// The deprecated path of the key, which is still accepted with a warning.
    #[must_use]
    pub fn former(self) -> Option<&'static str> {
        self.row().former
    }

    /// The last part of its deprecated path.
    pub(crate) fn former_name(self) -> Option<&'static str> {
        self.former().map(last_part)
    }

    /// Keys that `name` can denote: the key with that path, or the keys with that last name in cases with a general surface or with
    /// a pattern.
    #[must_use]
    pub fn named(name: &str, surface: bool) -> Vec<Self> {
        match Self::at(name) {
            Some(key) => vec![key],
            None => Self::ALL
                .into_iter()
                .filter(|key| key.name() == name || key.former_name() == Some(name))
                .filter(|key| key.is_of_bodies() || key.is_of_surface() == surface)
                .collect(),
        }
    }

    /// The table it is in: `"pattern.pillar"`.
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

    /// Whether only cases with a general surface have it.
    #[must_use]
    pub fn is_of_surface(self) -> bool {
        matches!(
            self.part(),
            Part::Flat | Part::HeightMap | Part::Pattern | Part::Surface
        )
    }

    /// Whether cases with a flat surface have it.
    #[must_use]
    pub fn is_on_flat(self) -> bool {
        Part::OF_FLAT.contains(&self.part())
    }

    /// Whether it turns a half-space into a layer.
    #[must_use]
    pub fn is_of_layers(self) -> bool {
        matches!(
            self,
            Self::LensThickness
                | Self::LensBase
                | Self::LensBaseYoungModulus
                | Self::LensBasePoissonRatio
                | Self::SubstrateThickness
                | Self::SubstrateBase
                | Self::SubstrateBaseYoungModulus
                | Self::SubstrateBasePoissonRatio
        )
    }

    /// Whether patterns and general surfaces have it: keys of the lens and the substrate, and of interactions.
    pub(crate) fn is_of_bodies(self) -> bool {
        self.part() == Part::Bodies || self.is_of_interactions()
    }

    /// Whether it is a quantity of an interaction that does not change the normal contact.
    #[must_use]
    pub fn is_of_interactions(self) -> bool {
        matches!(self.part(), Part::Interactions | Part::InteractionsOnFloor)
    }

    /// Whether a table of pillars may contain it for every pillar, so that it is not required.
    pub(crate) fn is_of_listed_pillars(self) -> bool {
        matches!(self, Self::PillarHeight | Self::PillarDiameter)
    }

    /// Kind of its value.
    #[must_use]
    pub fn kind(self) -> Kind {
        match self.row().field {
            Field::Number { dimension, .. } => Kind::Number(dimension),
            Field::Word(_) => Kind::Word,
            Field::Text(_) => Kind::Text,
            Field::List { dimension, .. } => Kind::List(dimension),
        }
    }

    /// Meaning, in a few words.
    #[must_use]
    pub fn summary(self) -> &'static str {
        self.row().summary
    }

    /// Label of a control: `"surface fraction"`.
    #[must_use]
    pub fn label(self) -> String {
        let label = self.row().label.unwrap_or_else(|| self.name());
        label.replace('_', " ")
    }

    /// Symbol in the paper, if any; the part after `_` is a subscript.
    #[must_use]
    pub fn symbol(self) -> Option<&'static str> {
        self.row().symbol
    }

    /// Usual range of its numbers, in SI units: the valid range, or the part of it in which patterns are made.
    /// `None` if it does not accept numbers, or has no usual range.
    #[must_use]
    pub fn usual(self) -> Option<[f64; 2]> {
        let allowed = match self.bounds() {
            (Bound::Included(least), Bound::Included(greatest)) => Some([least, greatest]),
            _ => None,
        };
        self.row().usual.or(allowed)
    }

    /// Usual range, in SI units, by which the plausibility of a number without a unit is judged: its own range, or
    /// that of its dimension.
    #[must_use]
    pub fn judged_by(self) -> Option<[f64; 2]> {
        self.usual().or(self.dimension().usual())
    }

    /// Whether its numbers are positive and not restricted to integers, like sizes and moduli.
    #[must_use]
    pub fn is_positive(self) -> bool {
        matches!(self.bounds(), (Bound::Excluded(least), _) if least >= 0.0)
    }

    /// Its name as a column of a table, with the unit of its numbers: `"pattern.pitch_m"`.
    #[must_use]
    pub fn column(self) -> String {
        format!("{self}{}", self.dimension().suffix())
    }

    /// Whether its numbers are integers.
    #[must_use]
    pub fn is_whole(self) -> bool {
        matches!(self.range(), Some(Range::Whole(..)))
    }

    /// Whether it is a setting of the computation or a count, not a quantity of a sample.
    #[must_use]
    pub fn is_setting(self) -> bool {
        self.is_whole() || self == Self::GridWidth
    }

    /// Accepted words; empty if it accepts something else.
    #[must_use]
    pub fn words(self) -> Vec<&'static str> {
        match self.row().field {
            Field::Word(place) => place(&mut Parts::default()).words(),
            _ => Vec::new(),
        }
    }

    /// Whether it is `true` or `false`, which have no quotes in a file.
    #[must_use]
    pub fn is_flag(self) -> bool {
        self.words() == TRUE_OR_FALSE
    }

    /// Smallest and largest valid number, in SI units, except for bounds that depend on other keys.
    #[must_use]
    pub fn bounds(self) -> (Bound<f64>, Bound<f64>) {
        match self.row().field {
            Field::Number { range, .. } => range.bounds(),
            _ => (Bound::Unbounded, Bound::Unbounded),
        }
    }

    /// Default value; `None` if it is required, or has none if left out.
    #[must_use]
    pub fn default(self) -> Option<Setting> {
        match self.row().presence {
            Presence::Default => Some(self.get(&mut Parts::default())),
            _ => None,
        }
    }

    /// The key on which it depends, and the words of that key with which it is accepted.
    #[must_use]
    pub fn goes_with(self) -> Option<(Self, &'static [&'static str])> {
        self.row().goes_with
    }

    /// The key that it excludes, and that an override replaces.
    #[must_use]
    pub fn alternative(self) -> Option<Self> {
        match self.row().presence {
            Presence::OneOf(other) => Some(other),
            _ => None,
        }
    }

    /// Returns the key of a quantity of a [`System`](fakir::problem::System); loads have none.
    #[must_use]
    pub fn of(quantity: Quantity) -> Option<Self> {
        let mut keys = Self::ALL.into_iter();
        keys.find(|key| key.row().quantity == Some(quantity))
    }

    /// Returns the key of a quantity of a [`Pattern`](fakir::problem::pattern::Pattern).
    pub(crate) fn of_pattern(quantity: PatternQuantity) -> Option<Self> {
        let mut keys = Self::ALL.into_iter();
        keys.find(|key| key.row().pattern_quantity == Some(quantity))
    }

    /// Dimension and valid range of its numbers; `None` if it accepts something else.
    pub(crate) fn range(self) -> Option<Range> {
        match self.row().field {
            Field::Number { range, .. } => Some(range),
            _ => None,
        }
    }

    /// Dimension of its numbers; that of plain numbers if it accepts something else.
    #[must_use]
    pub fn dimension(self) -> Dimension {
        match self.kind() {
            Kind::Number(dimension) => dimension,
            Kind::Word | Kind::Text | Kind::List(_) => Dimension::Number,
        }
    }

    /// Its value.
    pub(crate) fn get(self, parts: &mut Parts) -> Setting {
        match self.row().field {
            Field::Number { place, .. } => Setting::Number(*place(parts)),
            Field::Word(place) => Setting::Word(place(parts).chosen().to_owned()),
            Field::Text(place) => Setting::Word(place(parts).clone()),
            Field::List { dimension, place } => {
                let items = place(parts).iter();
                let items = items.map(|value| format_quantity(*value, dimension));
                Setting::Word(items.collect::<Vec<_>>().join(", "))
            }
        }
    }

    /// A value of it as in a case file: `"2.2 mm"` with its quotes.
    pub(crate) fn written(self, value: &Setting) -> String {
        match value {
            Setting::Number(value) => self.written_number(*value),
            Setting::Word(word) if self.is_flag() => word.clone(),
            Setting::Word(word) if matches!(self.kind(), Kind::List(_)) => {
                let items = word.split(',').map(|item| match self.kind() {
                    Kind::List(Dimension::Number) => item.trim().to_owned(),
                    _ => toml::Value::from(item.trim()).to_string(),
                });
                format!("[{}]", items.collect::<Vec<_>>().join(", "))
            }
            Setting::Word(word) => toml::Value::from(word.as_str()).to_string(),
        }
    }

    /// A number of it as in a case file.
    pub(crate) fn written_number(self, value: f64) -> String {
        let text = format_quantity(value, self.dimension());
        match self.dimension() {
            Dimension::Fraction | Dimension::Number => text,
            _ => format!("\"{text}\""),
        }
    }

    /// The word of the key on which it depends, if it is not accepted with that word.
    pub(crate) fn idle_with(self, parts: &mut Parts) -> Option<(Self, String)> {
        self.choices()
            .find_map(|(choice, words)| match choice.get(parts) {
                Setting::Word(word) if !words.contains(&word.as_str()) => Some((choice, word)),
                _ => None,
            })
    }

    /// The key without which it is refused.
    pub(crate) fn needs(self) -> Option<Self> {
        self.row().needs
    }

    /// The keys on which it depends, with the words of each with which it is accepted.
    pub fn choices(self) -> impl Iterator<Item = (Self, &'static [&'static str])> {
        let row = self.row();
        row.goes_with.into_iter().chain(row.goes_also_with)
    }

    /// The keys that depend on this one.
    pub(crate) fn dependents(self) -> impl Iterator<Item = (Self, &'static [&'static str])> {
        Self::ALL.into_iter().filter_map(move |key| {
            let (_, words) = key.choices().find(|(choice, _)| *choice == self)?;
            Some((key, words))
        })
    }
}

/// Its path.
impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.path())
    }
}

/// The path with the present name of its outermost table.
pub(crate) fn present(path: &str) -> Cow<'_, str> {
    match path.strip_prefix(FORMER_TABLE) {
        Some(rest) if rest.is_empty() || rest.starts_with('.') => {
            format!("{PATTERN_TABLE}{rest}").into()
        }
        _ => path.into(),
    }
}

/// Warning that the deprecated name of the table of the pillar pattern was used.
pub(crate) fn former_table_words() -> String {
    format!("[{FORMER_TABLE}] is deprecated: use [{PATTERN_TABLE}]")
}

/// The part after the last dot.
pub(crate) fn last_part(path: &'static str) -> &'static str {
    path.rsplit_once('.').map_or(path, |(_, name)| name)
}

/// Whether `path` names a table of a case file.
pub(crate) fn is_table(path: &str) -> bool {
    let below = |key: Key| key.path().strip_prefix(path)?.strip_prefix('.');
    Key::ALL.into_iter().any(|key| below(key).is_some())
}

/// The tables of that last name: `pattern.pillar` and `surface.pillar` are called `pillar`.
fn tables_named(name: &str) -> Vec<&'static str> {
    let tables = Key::ALL.into_iter().map(Key::table);
    let mut tables: Vec<&str> = tables
        .filter(|table| table.rsplit('.').next() == Some(name))
        .collect();
    tables.dedup();
    tables
}

/// Names accepted in the table `path`, including tables; the top level is `""`.
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

/// Suggestion for a misspelt path: a key or table with a similar name in the same table, or with
/// the same name in another.
pub(crate) fn similar(path: &str) -> Option<String> {
    let (table, name) = path.rsplit_once('.').unwrap_or(("", path));
    if let Some(known) = nearest(name, &names_in(table)) {
        return Some(join(table, known));
    }
    let namesakes = || Key::ALL.into_iter().filter(|key| key.name() == name);
    let close_by = namesakes().find(|key| root(key.path()) == root(path));
    // A path without its outermost table, as `pillar.diameter`.
    let ending = format!(".{path}");
    let inner = Key::ALL
        .into_iter()
        .map(Key::path)
        .filter(|known| !table.is_empty() && known.ends_with(&ending));
    let whole: Vec<&str> = inner.chain(tables_named(path)).collect();
    match close_by.or_else(|| namesakes().next()) {
        _ if !whole.is_empty() => Some(whole.join(" or ")),
        key => key.map(|key| key.path().to_owned()),
    }
}

/// The name of which `name` is a misspelling: at most one letter, plus one for every four letters,
/// is inserted, removed or replaced.
pub(crate) fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    known
        .iter()
        .map(|known| (strsim::levenshtein(name, known), *known))
        .min()
        .filter(|(distance, known)| *distance <= 1 + known.len() / 4)
        .map(|(_, known)| known)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_found_by_its_path() {
        for key in Key::ALL {
            assert_eq!(Key::at(key.path()), Some(key));
            assert!(key.former().is_none_or(|path| Key::at(path) == Some(key)));
            assert!(is_table(key.table()));
            assert!(names_in(key.table()).contains(&key.name()));
        }
        assert_eq!(
            names_in(""),
            [
                "lens",
                "substrate",
                "relaxation",
                "pattern",
                "floor",
                "adhesion",
                "friction",
                "surface",
                "method"
            ]
        );
        assert!(names_in("pattern").contains(&"pillar"));
    }

    #[test]
    fn misspelt_and_misplaced_keys() {
        assert_eq!(similar("lens.raduis").unwrap(), "lens.radius");
        assert_eq!(
            similar("pattern.diameter").unwrap(),
            "pattern.pillar.diameter"
        );
        assert_eq!(
            similar("surface.diameter").unwrap(),
            "surface.pillar.diameter"
        );
        assert_eq!(similar("lense").unwrap(), "lens");
        assert_eq!(
            similar("pillar").unwrap(),
            "pattern.pillar or surface.pillar"
        );
        assert_eq!(
            similar("pillar.height").unwrap(),
            "pattern.pillar.height or surface.pillar.height"
        );
        assert_eq!(similar("lens.colour"), None);
    }

    /// The rows name each other by keys and words: these must be there.
    #[test]
    fn the_rows_of_the_table_fit_together() {
        for key in Key::ALL {
            if let Some(other) = key.alternative() {
                assert_eq!(other.alternative(), Some(key), "{key}");
                assert_eq!(other.table(), key.table(), "{key}");
            }
            if let Some((choice, words)) = key.goes_with() {
                assert!(
                    words.iter().all(|word| choice.words().contains(word)),
                    "{key}"
                );
            }
            if let Some(Setting::Number(value)) = key.default() {
                assert!(key.range().unwrap().allows(value), "{key}");
            }
            for usual in key.usual().into_iter().flatten() {
                assert!(key.range().unwrap().allows(usual), "{key}");
            }
            for word in key.words() {
                let Field::Word(place) = key.row().field else {
                    panic!("{key} has words")
                };
                let mut parts = Parts::default();
                assert!(place(&mut parts).choose(word));
                assert_eq!(key.get(&mut parts), Setting::Word(word.to_owned()));
            }
        }
    }
}
