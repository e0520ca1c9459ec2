//! The numbers of one answer, as journals keep them.

use super::named::{Entry, Kind, Recorded, Value};
use super::object::Object;
use crate::exact;
use fakir::problem::Point;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value as Json};

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

    /// All rows with their values.
    pub fn values(&self) -> impl Iterator<Item = (&Entry, &Value)> {
        std::iter::zip(self.kind.entries(), &self.values)
    }

    fn get(&self, path: &str) -> Option<&Value> {
        let mut values = self.values();
        Some(values.find(|(entry, _)| entry.path == path)?.1)
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

    /// Records of one kind as CSV, with their columns as heading; what is none is empty.
    ///
    /// # Panics
    /// Never: memory takes every byte.
    #[must_use]
    pub fn csv(records: &[Self]) -> Vec<u8> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let kind = records.first().map(|record| record.kind);
        let entries = kind.map_or(&[][..], Kind::entries);
        let is_there = |place: usize| {
            let mut values = records.iter().map(|record| &record.values[place]);
            !entries[place].if_given || values.any(|value| *value != Value::None)
        };
        let shown: Vec<usize> = (0..entries.len())
            .filter(|place| is_there(*place))
            .collect();
        let names = shown
            .iter()
            .flat_map(|place| entries[*place].columns())
            .map(|(name, _)| name);
        let mut lines = vec![names.collect::<Vec<String>>()];
        lines.extend(records.iter().map(|record| {
            let cells = shown.iter().flat_map(|place| {
                let (entry, value) = (&entries[*place], &record.values[*place]);
                let columns = entry.columns().into_iter();
                columns.map(|(_, coordinate)| value.cell(coordinate))
            });
            cells.collect()
        }));
        for line in lines {
            writer.write_record(line).expect("memory takes every byte");
        }
        writer.into_inner().expect("memory takes every byte")
    }

    /// The JSON object of the numbers alone.
    #[must_use]
    pub fn object(&self) -> Object {
        Object::of_values(self.values())
    }
}

/// In a journal: the kind, and every number that there is by its path. Numbers that are not finite, which JSON has not, are words.
impl Serialize for Record {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let json = |value: &Value| match value {
            Value::Number(number) => exact::serialize(number, serde_json::value::Serializer),
            _ => Ok(value.json()),
        };
        let numbers: Result<Map<String, Json>, _> = self
            .values()
            .filter(|(_, value)| **value != Value::None)
            .map(|(entry, value)| Ok((entry.path.to_owned(), json(value)?)))
            .collect();
        let numbers = numbers.map_err(serde::ser::Error::custom::<serde_json::Error>)?;
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

#[cfg(test)]
mod tests {
    use super::super::named::Type;
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
