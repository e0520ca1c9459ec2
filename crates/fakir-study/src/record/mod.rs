//! The numbers of results: one row for each, with its name, symbol and meaning, and how it is read from an answer.
//!
//! JSON objects, columns of tables, lines of journals, the reference of the manual and the JSON Schema are all made of these
//! rows. To give an answer one more number is to add a row to the file of its kind.
//!
//! A row's *path* is its place in the JSON object, with a dot between an object and a name in it; the last name ends in the SI unit.
//! In tables the column is named by the path with underscores for dots, with `relative_error_estimate` first, and a point has two columns.

mod contact;
mod cycle;
mod gradient;
mod limit;
mod object;
mod rounded;
mod schema;
mod surface;

pub use contact::of_floor;
pub use gradient::GradientObject;
pub use limit::LimitObject;
pub use object::Object;
pub use rounded::RoundedAnswer;
pub use schema::{reference, schema};
pub(crate) use surface::{METHOD, boundary_name, grid_object};
pub use surface::{SurfaceAnswer, indenter_name};

use fakir::problem::Point;
use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value as Json};
use std::sync::LazyLock;

/// The version of names and places of numbers in results; it rises when one of them changes or goes, not when some are added.
pub const SCHEMA_VERSION: u32 = 2;

/// What kind of value a row has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Type {
    Number,
    Count,
    Flag,
    Word,
    Words,
    Point,
}

/// A value of an answer. All numbers are in SI units.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    /// The answer has none.
    None,
    Number(f64),
    Count(usize),
    Flag(bool),
    Word(String),
    Words(Vec<String>),
    Point(Point),
}

/// A row without the way to read it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// Its place in the JSON object.
    pub(crate) path: &'static str,
    symbol: &'static str,
    meaning: &'static str,
    pub(crate) of: Type,
    /// Whether JSON objects have it, and whether tables have it.
    in_objects: bool,
    in_tables: bool,
    /// A column that is not named by the path.
    column: Option<&'static str>,
    /// Whether the object that it is in is `null` where this number is none.
    decides: bool,
}

/// A number of answers of one type.
pub struct Named<T> {
    entry: Entry,
    value: Box<dyn Fn(&T) -> Value>,
}

/// An answer whose numbers are recorded.
pub trait Recorded {
    /// What kind of answer it is.
    const KIND: Kind;

    /// Its numbers, in the order of the JSON object.
    fn rows() -> Vec<Named<Self>>
    where
        Self: Sized;
}

impl<T> Named<T> {
    fn new(
        path: &'static str,
        of: Type,
        meaning: &'static str,
        value: impl Fn(&T) -> Value + 'static,
    ) -> Self {
        let entry = Entry {
            path,
            symbol: "",
            meaning,
            of,
            in_objects: true,
            in_tables: true,
            column: None,
            decides: false,
        };
        let value = Box::new(value);
        Self { entry, value }
    }

    fn number(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> f64 + 'static,
    ) -> Self {
        Self::number_if_any(path, meaning, move |it| Some(value(it)))
    }

    fn number_if_any(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> Option<f64> + 'static,
    ) -> Self {
        Self::new(path, Type::Number, meaning, move |it| {
            value(it).map_or(Value::None, Value::Number)
        })
    }

    fn count(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> usize + 'static,
    ) -> Self {
        Self::count_if_any(path, meaning, move |it| Some(value(it)))
    }

    fn count_if_any(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> Option<usize> + 'static,
    ) -> Self {
        Self::new(path, Type::Count, meaning, move |it| {
            value(it).map_or(Value::None, Value::Count)
        })
    }

    fn flag(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> bool + 'static,
    ) -> Self {
        Self::new(path, Type::Flag, meaning, move |it| Value::Flag(value(it)))
    }

    fn word(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> Option<&'static str> + 'static,
    ) -> Self {
        Self::new(path, Type::Word, meaning, move |it| {
            value(it).map_or(Value::None, |word| Value::Word(word.to_owned()))
        })
    }

    fn words(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> &'static [&'static str] + 'static,
    ) -> Self {
        Self::new(path, Type::Words, meaning, move |it| {
            Value::Words(value(it).iter().map(|word| (*word).to_owned()).collect())
        })
    }

    fn point(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> Option<Point> + 'static,
    ) -> Self {
        Self::new(path, Type::Point, meaning, move |it| {
            value(it).map_or(Value::None, Value::Point)
        })
    }

    /// The same number of an answer that has this one as a part.
    fn of_part<U>(self, part: impl Fn(&U) -> &T + 'static) -> Named<U>
    where
        T: 'static,
    {
        let value = self.value;
        Named {
            entry: self.entry,
            value: Box::new(move |whole| value(part(whole))),
        }
    }

    /// With the symbol of the theory.
    fn symbol(mut self, symbol: &'static str) -> Self {
        self.entry.symbol = symbol;
        self
    }

    /// In JSON objects alone.
    fn in_objects(mut self) -> Self {
        self.entry.in_tables = false;
        self
    }

    /// In tables alone.
    fn in_tables(mut self) -> Self {
        self.entry.in_objects = false;
        self
    }

    /// With a column of this name.
    fn column(mut self, name: &'static str) -> Self {
        self.entry.column = Some(name);
        self
    }

    /// Without this number the object that it is in is `null`.
    fn decides(mut self) -> Self {
        self.entry.decides = true;
        self
    }
}

impl Entry {
    /// The columns of tables, and which coordinate each has of a point.
    pub(crate) fn columns(&self) -> Vec<(String, Option<usize>)> {
        if !self.in_tables {
            return Vec::new();
        }
        const ERRORS: &str = "relative_error_estimate";
        let mut names: Vec<&str> = self.path.split('.').collect();
        if let Some(place) = names.iter().position(|name| *name == ERRORS) {
            names.remove(place);
            names.insert(0, ERRORS);
        }
        let name = self.column.map_or_else(|| names.join("_"), str::to_owned);
        if self.of != Type::Point {
            return vec![(name, None)];
        }
        let (quantity, unit) = name.rsplit_once('_').unwrap_or((&name, ""));
        let coordinate = |(place, axis)| (format!("{quantity}_{axis}_{unit}"), Some(place));
        ["x", "y"].into_iter().enumerate().map(coordinate).collect()
    }
}

/// Which numbers an answer has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A contact with pillars.
    Press,
    /// The critical state with pillars.
    Transition,
    /// A contact with a height map.
    SurfacePress,
    /// The critical state with a height map.
    SurfaceTransition,
    /// A contact with rounded tops.
    RoundedPress,
    /// A cycle of loading and unloading.
    Cycle,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Press,
        Self::Transition,
        Self::SurfacePress,
        Self::SurfaceTransition,
        Self::RoundedPress,
        Self::Cycle,
    ];

    /// Its name in journals and in the schema.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Press => "press",
            Self::Transition => "transition",
            Self::SurfacePress => "surface_press",
            Self::SurfaceTransition => "surface_transition",
            Self::RoundedPress => "rounded_press",
            Self::Cycle => "cycle",
        }
    }

    /// What the reference calls it.
    fn heading(self) -> &'static str {
        match self {
            Self::Press => "A contact",
            Self::Transition => "A critical state",
            Self::SurfacePress => "A contact with a height map",
            Self::SurfaceTransition => "A critical state with a height map",
            Self::RoundedPress => "A contact with rounded tops",
            Self::Cycle => "A cycle",
        }
    }

    /// Its numbers, in the order of the JSON object.
    pub(crate) fn entries(self) -> &'static [Entry] {
        fn of<T: Recorded>() -> Vec<Entry> {
            T::rows().iter().map(|row| row.entry).collect()
        }
        static ALL: LazyLock<[Vec<Entry>; 6]> = LazyLock::new(|| {
            Kind::ALL.map(|kind| match kind {
                Kind::Press => of::<fakir::state::ContactState>(),
                Kind::Transition => of::<fakir::state::CriticalState>(),
                Kind::SurfacePress => of::<SurfaceAnswer<'_, fakir::state::SurfaceContact>>(),
                Kind::SurfaceTransition => {
                    of::<SurfaceAnswer<'_, fakir::state::SurfaceTransition>>()
                }
                Kind::RoundedPress => of::<RoundedAnswer<'_>>(),
                Kind::Cycle => of::<fakir::state::Cycle>(),
            })
        });
        &ALL[self as usize]
    }
}

/// The numbers of one answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    kind: Kind,
    /// One for every entry of the kind.
    values: Vec<Value>,
}

impl Record {
    /// The numbers of an answer.
    #[must_use]
    pub fn of<T: Recorded>(answer: &T) -> Self {
        Self {
            kind: T::KIND,
            values: T::rows().iter().map(|row| (row.value)(answer)).collect(),
        }
    }

    /// What kind of answer it is of.
    #[must_use]
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The value at a place of the kind's entries.
    pub(crate) fn value(&self, place: usize) -> &Value {
        &self.values[place]
    }

    fn get(&self, path: &str) -> Option<&Value> {
        let place = self
            .kind
            .entries()
            .iter()
            .position(|entry| entry.path == path)?;
        Some(&self.values[place])
    }

    /// A number by its path in the JSON object, in its SI unit; none if this answer has none.
    #[must_use]
    pub fn number(&self, path: &str) -> Option<f64> {
        match self.get(path)? {
            Value::Number(number) => Some(*number),
            _ => None,
        }
    }

    /// A whole number by its path in the JSON object; none if this answer has none.
    #[must_use]
    pub fn count(&self, path: &str) -> Option<usize> {
        match self.get(path)? {
            Value::Count(count) => Some(*count),
            _ => None,
        }
    }

    /// A point by its path in the JSON object, m; none if this answer has none.
    #[must_use]
    pub fn point(&self, path: &str) -> Option<Point> {
        match self.get(path)? {
            Value::Point(point) => Some(*point),
            _ => None,
        }
    }

    /// A word by its path in the JSON object; none if this answer has none.
    #[must_use]
    pub fn word(&self, path: &str) -> Option<&str> {
        match self.get(path)? {
            Value::Word(word) => Some(word),
            _ => None,
        }
    }

    /// Whether something is so, by its path in the JSON object.
    #[must_use]
    pub fn is(&self, path: &str) -> bool {
        self.get(path) == Some(&Value::Flag(true))
    }

    /// The JSON object of the numbers alone.
    #[must_use]
    pub fn object(&self) -> Object {
        let pairs = std::iter::zip(self.kind.entries(), &self.values);
        Object::of_values(pairs)
    }
}

/// In a journal: the kind, and every number that there is by its path. Numbers that are not finite, which JSON has not, are words.
impl Serialize for Record {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let numbers: Map<String, Json> = std::iter::zip(self.kind.entries(), &self.values)
            .filter(|(_, value)| **value != Value::None)
            .map(|(entry, value)| {
                let json = match value {
                    Value::Number(number) if !number.is_finite() => number.to_string().into(),
                    _ => value.json(),
                };
                (entry.path.to_owned(), json)
            })
            .collect();
        let kind = self.kind;
        Kept { kind, numbers }.serialize(serializer)
    }
}

#[derive(Serialize, Deserialize)]
struct Kept {
    kind: Kind,
    numbers: Map<String, Json>,
}

impl<'de> Deserialize<'de> for Record {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Kept { kind, mut numbers } = Kept::deserialize(deserializer)?;
        let values = kind.entries().iter().map(|entry| {
            let Some(json) = numbers.remove(entry.path) else {
                return Ok(Value::None);
            };
            entry
                .of
                .read(json)
                .map_err(|error| D::Error::custom(format!("{}: {error}", entry.path)))
        });
        let values = values.collect::<Result<_, _>>()?;
        match numbers.keys().next() {
            None => Ok(Self { kind, values }),
            Some(unknown) => Err(D::Error::custom(format!("{unknown} is not known"))),
        }
    }
}

impl Type {
    /// A value as journals have it.
    fn read(self, json: Json) -> Result<Value, serde_json::Error> {
        fn read<V: DeserializeOwned>(
            json: Json,
            value: impl Fn(V) -> Value,
        ) -> Result<Value, serde_json::Error> {
            serde_json::from_value(json).map(value)
        }
        match (self, json) {
            (Self::Number, Json::String(word)) => word
                .parse()
                .map(Value::Number)
                .map_err(|_| serde_json::Error::custom(format!("{word} is not a number"))),
            (Self::Number, json) => read(json, Value::Number),
            (Self::Count, json) => read(json, Value::Count),
            (Self::Flag, json) => read(json, Value::Flag),
            (Self::Word, json) => read(json, Value::Word),
            (Self::Words, json) => read(json, Value::Words),
            (Self::Point, json) => read(json, Value::Point),
        }
    }
}

impl Value {
    /// As JSON objects have it: what is no number is `null`.
    fn json(&self) -> Json {
        match self {
            Self::None => Json::Null,
            Self::Number(number) => (*number).into(),
            Self::Count(count) => (*count).into(),
            Self::Flag(flag) => (*flag).into(),
            Self::Word(word) => word.clone().into(),
            Self::Words(words) => words.clone().into(),
            Self::Point(point) => point.to_vec().into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Names are unique in objects and in tables, end in a unit that is known, and have a meaning.
    #[test]
    fn names_are_unique_and_mean_something() {
        for kind in Kind::ALL {
            let entries = kind.entries();
            let paths: BTreeSet<&str> = entries.iter().map(|entry| entry.path).collect();
            assert_eq!(paths.len(), entries.len(), "{kind:?}");
            let columns: Vec<String> = entries
                .iter()
                .flat_map(|entry| entry.columns().into_iter().map(|(name, _)| name))
                .collect();
            let names: BTreeSet<&String> = columns.iter().collect();
            assert_eq!(names.len(), columns.len(), "{kind:?}");
            for entry in entries {
                assert!(!entry.meaning.is_empty(), "{}", entry.path);
            }
            assert_eq!(Kind::ALL[kind as usize], kind);
        }
    }

    /// Also infinities, which JSON does not have.
    #[test]
    fn journals_give_every_number_back() {
        let kind = Kind::Press;
        let mut values: Vec<Value> = kind
            .entries()
            .iter()
            .map(|entry| match entry.of {
                Type::Number => Value::Number(0.1 + 0.2),
                Type::Count => Value::Count(7),
                Type::Flag => Value::Flag(true),
                Type::Word => Value::Word("a word".to_owned()),
                Type::Words => Value::Words(vec!["floor".to_owned()]),
                Type::Point => Value::Point([1.0, -2.0]),
            })
            .collect();
        let record = |values: &[Value]| Record {
            kind,
            values: values.to_vec(),
        };
        let back = |record: &Record| -> Record {
            serde_json::from_str(&serde_json::to_string(record).unwrap()).unwrap()
        };
        assert_eq!(back(&record(&values)), record(&values));
        let place = kind
            .entries()
            .iter()
            .position(|it| it.path == "force_N")
            .unwrap();
        values[place] = Value::Number(f64::INFINITY);
        assert_eq!(back(&record(&values)), record(&values));
        values[place] = Value::None;
        assert_eq!(back(&record(&values)), record(&values));
        let json = r#"{"kind":"press","numbers":{"force_n":1.0}}"#;
        let error = serde_json::from_str::<Record>(json).unwrap_err();
        assert!(
            error.to_string().contains("force_n is not known"),
            "{error}"
        );
    }
}
