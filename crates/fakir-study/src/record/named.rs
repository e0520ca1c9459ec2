//! Named numbers: a row of the record, and the values that it gives.

use crate::exact;
use fakir::problem::Point;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

/// The version of names and places of numbers in results; it increases if one of them is changed or removed, not if some are added.
pub const SCHEMA_VERSION: u32 = 3;

/// What kind of value a row has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Type {
    /// In the unit of the row.
    Number,
    /// A whole number.
    Count,
    /// Whether something is so.
    Flag,
    /// One of a few words.
    Word,
    /// Several words.
    Words,
    /// Two coordinates in the unit of the row.
    Point,
}

/// A value of an answer. All numbers are in SI units.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// The answer has none.
    None,
    /// Of [`Type::Number`].
    Number(f64),
    /// Of [`Type::Count`].
    Count(usize),
    /// Of [`Type::Flag`].
    Flag(bool),
    /// Of [`Type::Word`].
    Word(String),
    /// Of [`Type::Words`].
    Words(Vec<String>),
    /// Of [`Type::Point`].
    Point(Point),
}

/// A row without the way to read it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// Its place in the JSON object.
    pub path: &'static str,
    /// The symbol of the theory, if it has one.
    pub symbol: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// What kind of value it has.
    pub of: Type,
    /// Whether JSON objects have it.
    pub in_objects: bool,
    /// Whether tables have it.
    pub(super) in_tables: bool,
    /// A column that is not named by the path.
    pub(super) column: Option<&'static str>,
    /// Whether it can be none in an object that is there.
    pub optional: bool,
    /// Whether the object that it is in is `null` where this number is none.
    pub decides: bool,
    /// Whether it belongs to a part of the case that may be left out: without that, objects and tables do not contain it.
    pub if_given: bool,
}

/// How units are written at the end of a path, and the units. The longer ones come first.
const UNITS: [(&str, &str); 8] = [
    ("_J_per_m2", "J/m^2"),
    ("_N_per_m", "N/m"),
    ("_Pa", "Pa"),
    ("_m2", "m^2"),
    ("_m", "m"),
    ("_N", "N"),
    ("_J", "J"),
    ("_s", "s"),
];

/// A number of answers of one type.
pub struct Named<T> {
    pub(super) entry: Entry,
    pub(super) value: Box<dyn Fn(&T) -> Value>,
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
    pub(super) fn new(
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
            optional: false,
            decides: false,
            if_given: false,
        };
        let value = Box::new(value);
        Self { entry, value }
    }

    pub(super) fn number(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> f64 + 'static,
    ) -> Self {
        Self::number_if_any(path, meaning, move |it| Some(value(it))).always()
    }

    pub(super) fn number_if_any(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> Option<f64> + 'static,
    ) -> Self {
        Self::new(path, Type::Number, meaning, move |it| {
            value(it).map_or(Value::None, Value::Number)
        })
        .optional()
    }

    pub(super) fn count(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> usize + 'static,
    ) -> Self {
        Self::count_if_any(path, meaning, move |it| Some(value(it))).always()
    }

    pub(super) fn count_if_any(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> Option<usize> + 'static,
    ) -> Self {
        Self::new(path, Type::Count, meaning, move |it| {
            value(it).map_or(Value::None, Value::Count)
        })
        .optional()
    }

    pub(super) fn flag(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> bool + 'static,
    ) -> Self {
        Self::new(path, Type::Flag, meaning, move |it| Value::Flag(value(it)))
    }

    pub(super) fn flag_if_any(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> Option<bool> + 'static,
    ) -> Self {
        Self::new(path, Type::Flag, meaning, move |it| {
            value(it).map_or(Value::None, Value::Flag)
        })
        .optional()
    }

    pub(super) fn word(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> Option<&'static str> + 'static,
    ) -> Self {
        Self::new(path, Type::Word, meaning, move |it| {
            value(it).map_or(Value::None, |word| Value::Word(word.to_owned()))
        })
    }

    pub(super) fn words(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> &'static [&'static str] + 'static,
    ) -> Self {
        Self::new(path, Type::Words, meaning, move |it| {
            Value::Words(value(it).iter().map(|word| (*word).to_owned()).collect())
        })
    }

    pub(super) fn point(
        path: &'static str,
        meaning: &'static str,
        value: impl Fn(&T) -> Option<Point> + 'static,
    ) -> Self {
        Self::new(path, Type::Point, meaning, move |it| {
            value(it).map_or(Value::None, Value::Point)
        })
    }

    /// The same number of an answer that has this one as a part.
    pub(super) fn of_part<U>(self, part: impl Fn(&U) -> &T + 'static) -> Named<U>
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
    pub(super) fn symbol(mut self, symbol: &'static str) -> Self {
        self.entry.symbol = symbol;
        self
    }

    /// In JSON objects alone.
    pub(super) fn in_objects(mut self) -> Self {
        self.entry.in_tables = false;
        self
    }

    /// In tables alone.
    pub(super) fn in_tables(mut self) -> Self {
        self.entry.in_objects = false;
        self
    }

    /// With a column of this name.
    pub(super) fn column(mut self, name: &'static str) -> Self {
        self.entry.column = Some(name);
        self
    }

    /// Without this number the object that it is in is `null`.
    pub(super) fn decides(mut self) -> Self {
        self.entry.decides = true;
        self.always()
    }

    /// It belongs to a part of the case that may be left out; objects and tables in which it is always none do not contain it.
    pub(super) fn if_given(mut self) -> Self {
        self.entry.if_given = true;
        self
    }

    /// Some answers have none.
    pub(super) fn optional(mut self) -> Self {
        self.entry.optional = true;
        self
    }

    /// It is never none where the object that it is in is there.
    pub(super) fn always(mut self) -> Self {
        self.entry.optional = false;
        self
    }
}

impl Entry {
    /// The unit that its path ends in; empty if it has none.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        let found = UNITS.iter().find(|(end, _)| self.path.ends_with(end));
        found.map_or("", |(_, unit)| unit)
    }

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

/// Defines the enum of kinds, their list, their names and headings.
macro_rules! kinds {
    ($($(#[$doc:meta])* $kind:ident = $name:literal, $heading:literal;)+) => {
        /// Which numbers an answer has.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
        pub enum Kind {
            $($(#[$doc])* #[serde(rename = $name)] $kind,)+
        }

        impl Kind {
            /// All of them.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$kind),+];

            /// Its name in journals and in the schema.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$kind => $name,)+
                }
            }

            /// What the reference calls it.
            pub(super) fn heading(self) -> &'static str {
                match self {
                    $(Self::$kind => $heading,)+
                }
            }
        }
    };
}

kinds! {
    /// A contact with pillars.
    Press = "press", "A contact";
    /// The critical state with pillars.
    Transition = "transition", "A critical state";
    /// A contact with a height map.
    SurfacePress = "surface_press", "A contact with a height map";
    /// The critical state with a height map.
    SurfaceTransition = "surface_transition", "A critical state with a height map";
    /// A contact with rounded tops.
    #[serde(alias = "rounded_press")]
    AsperityPress = "asperity_press", "A contact with rounded tops";
    /// The critical state with rounded tops.
    AsperityTransition = "asperity_transition", "A critical state with rounded tops";
    /// A cycle of rounded tops.
    AsperityCycle = "asperity_cycle", "A cycle with rounded tops";
    /// A cycle with a height map.
    SurfaceCycle = "surface_cycle", "A cycle with a height map";
    /// A cycle of loading and unloading.
    Cycle = "cycle", "A cycle";
    /// A state of a loading of pillars.
    Loading = "loading", "A state of a loading";
    /// A state of a loading of a height map.
    SurfaceLoading = "surface_loading", "A state of a loading of a height map";
    /// A state of a loading of rounded tops.
    #[serde(alias = "rounded_loading")]
    AsperityLoading = "asperity_loading", "A state of a loading of rounded tops";
    /// A contact with a flat surface.
    FlatPress = "flat_press", "A contact with a flat surface";
    /// A cycle with a flat surface.
    FlatCycle = "flat_cycle", "A cycle with a flat surface";
    /// A state of a loading of a flat surface.
    FlatLoading = "flat_loading", "A state of a loading of a flat surface";
    /// The contact of viscoelastic bodies over time.
    History = "history", "A contact over time";
    /// A state of it.
    HistoryState = "history_state", "A state of a contact over time";
    /// An event of it.
    HistoryEvent = "history_event", "An event of a contact over time";
}

impl Type {
    /// A value as journals have it.
    pub(super) fn read(self, json: Json) -> Result<Value, serde_json::Error> {
        fn read<V: DeserializeOwned>(
            json: Json,
            value: impl Fn(V) -> Value,
        ) -> Result<Value, serde_json::Error> {
            serde_json::from_value(json).map(value)
        }
        match self {
            Self::Number => exact::deserialize(json).map(Value::Number),
            Self::Count => read(json, Value::Count),
            Self::Flag => read(json, Value::Flag),
            Self::Word => read(json, Value::Word),
            Self::Words => read(json, Value::Words),
            Self::Point => read(json, Value::Point),
        }
    }
}

impl Value {
    /// As tables in text have it, of a point one of its coordinates; numbers with all their digits.
    pub(super) fn cell(&self, coordinate: Option<usize>) -> String {
        match self {
            Self::None => String::new(),
            Self::Number(number) => format!("{number:?}"),
            Self::Count(count) => count.to_string(),
            Self::Flag(flag) => flag.to_string(),
            Self::Word(word) => word.clone(),
            Self::Words(words) => words.join(" "),
            Self::Point(point) => {
                coordinate.map_or(String::new(), |axis| format!("{:?}", point[axis]))
            }
        }
    }

    /// As JSON objects have it: what is no number is `null`.
    pub(super) fn json(&self) -> Json {
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
