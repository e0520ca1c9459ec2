//! Results as JSON objects.

use super::gradient::GradientObject;
use super::limit::LimitObject;
use super::named::{Entry, Named, Recorded, SCHEMA_VERSION, Value};
use crate::VERSION;
use fakir::state::Limit;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use serde_json::Value as Json;

/// A JSON object whose names keep their order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Object(Vec<(String, Node)>);

#[derive(Debug, Clone, PartialEq)]
enum Node {
    Leaf(Json),
    Group(Object),
    Limits(Vec<LimitObject>),
    Gradient(GradientObject),
}

impl Object {
    /// The numbers of an answer.
    pub(crate) fn of<T: Recorded>(answer: &T) -> Self {
        Self::of_rows(&T::rows(), answer)
    }

    /// Some numbers of an answer.
    pub(super) fn of_rows<T>(rows: &[Named<T>], answer: &T) -> Self {
        let values: Vec<Value> = rows.iter().map(|row| (row.value)(answer)).collect();
        Self::of_values(rows.iter().map(|row| &row.entry).zip(&values))
    }

    /// Numbers that are known.
    pub(super) fn of_values<'a>(pairs: impl Iterator<Item = (&'a Entry, &'a Value)>) -> Self {
        let pairs: Vec<(&str, &Entry, &Value)> = pairs
            .filter(|(entry, _)| entry.in_objects)
            .map(|(entry, value)| (entry.path, entry, value))
            .collect();
        // Parts of the case that are left out have no group.
        let is_there =
            |(_, entry, value): &(&str, &Entry, &Value)| !entry.if_given || **value != Value::None;
        let groups = groups(&pairs, |(path, ..)| path).into_iter();
        let groups = groups.filter(|(_, group)| group.iter().any(is_there));
        let pairs: Vec<_> = groups.flat_map(|(_, group)| group).collect();
        Self::tree(&pairs)
    }

    /// Values by what is left of their paths.
    fn tree(pairs: &[(&str, &Entry, &Value)]) -> Self {
        let node = |group: Vec<(&str, &Entry, &Value)>| {
            let inner: Vec<(&str, &Entry, &Value)> = group
                .iter()
                .filter_map(|(path, entry, value)| Some((path.split_once('.')?.1, *entry, *value)))
                .collect();
            let missing = |(path, entry, value): &(&str, &Entry, &Value)| {
                entry.decides && !path.contains('.') && **value == Value::None
            };
            if inner.is_empty() {
                Node::Leaf(group[0].2.json())
            } else if inner.iter().any(missing) {
                Node::Leaf(Json::Null)
            } else {
                Node::Group(Self::tree(&inner))
            }
        };
        let groups = groups(pairs, |(path, ..)| path).into_iter();
        Self(groups.map(|(name, group)| (name, node(group))).collect())
    }

    /// An object of one word.
    pub(crate) fn word(name: &str, word: &str) -> Self {
        Self::default().with(name, Node::Leaf(word.into()))
    }

    fn with(mut self, name: &str, node: Node) -> Self {
        self.0.push((name.to_owned(), node));
        self
    }

    /// The same with how near it is to where the model ends.
    #[must_use]
    pub(crate) fn with_limits(self, limits: Vec<Limit>) -> Self {
        self.with("limits", Node::Limits(LimitObject::all(limits)))
    }

    /// The same with derivatives, if there are any.
    #[must_use]
    pub fn with_gradient(self, gradient: Option<GradientObject>) -> Self {
        match gradient {
            Some(gradient) => self.with("gradient", Node::Gradient(gradient)),
            None => self,
        }
    }

    /// The same with how many seconds it took, and by which version of the program.
    #[must_use]
    pub(crate) fn timed(self, wall_time: f64) -> Self {
        self.with("wall_time_s", Node::Leaf(wall_time.into()))
            .with("fakir_version", Node::Leaf(VERSION.into()))
            .with("schema_version", Node::Leaf(SCHEMA_VERSION.into()))
    }
}

/// Items by the first name of their path, in the order in which the names come first.
pub(super) fn groups<'a, T: Copy>(
    items: &[T],
    path: impl Fn(&T) -> &'a str,
) -> Vec<(String, Vec<T>)> {
    let mut groups: Vec<(String, Vec<T>)> = Vec::new();
    for item in items {
        let name = path(item).split('.').next().unwrap_or_default();
        match groups.iter_mut().find(|(known, _)| known == name) {
            Some((_, group)) => group.push(*item),
            None => groups.push((name.to_owned(), vec![*item])),
        }
    }
    groups
}

impl Serialize for Object {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, node) in &self.0 {
            match node {
                Node::Leaf(json) => map.serialize_entry(name, json)?,
                Node::Group(object) => map.serialize_entry(name, object)?,
                Node::Limits(limits) => map.serialize_entry(name, limits)?,
                Node::Gradient(gradient) => map.serialize_entry(name, gradient)?,
            }
        }
        map.end()
    }
}
