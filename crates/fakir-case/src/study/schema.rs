//! JSON Schemas of the tables of a study: `[study]` and `[axes]`.

use super::asked::{Asked, Combine};
use super::axis::{PointSpacing, Variable};
use super::file::MAXIMUM_CASES;
use super::read::LoadingModeName;
use crate::key::{FORMER_TABLE, Key, PATTERN_TABLE};
use crate::parts::Words;
use crate::unit::Dimension;
use crate::value_schema::{quantity_schema, whole_schema, words_schema};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::ops::Bound::{Excluded, Included, Unbounded};

/// Schema of `[study]`.
pub(crate) fn study_schema() -> Value {
    let stiffness = quantity_schema(Dimension::Stiffness, (Excluded(0.0), Unbounded), None);
    let is =
        |name: &str, word: &str| json!({"required": [name], "properties": {name: {"const": word}}});
    let loads = json!({"anyOf": [{"required": ["indentation"]}, {"required": ["force"]}]});
    let machine = is("drive", LoadingModeName::Machine.word());
    let cycle = is("question", Asked::Cycle.name());
    let without_load = [Asked::Transition, Asked::Collapse].map(Asked::name);
    json!({
        "type": "object",
        "description": "The question about every case, and how the axes are combined.",
        "additionalProperties": false,
        "properties": {
            "question": described(words_schema(&Asked::all()), "question about every case", Asked::default().name()),
            "combine": described(
                words_schema(&Combine::all()),
                "product: every value with every other; zip: first with first",
                Combine::default().word(),
            ),
            "case": {"type": "string", "description": "case file, relative to the study; without it the case is in this file"},
            "indentation": variable_schema(Variable::Indentation),
            "force": variable_schema(Variable::Force),
            "drive": described(
                words_schema(&LoadingModeName::all()),
                "what is prescribed in a cycle",
                LoadingModeName::Displacement.word(),
            ),
            "machine_stiffness": stiffness,
        },
        "allOf": [
            {"not": {"required": ["indentation", "force"]}},
            {"if": {"required": ["machine_stiffness"]}, "then": machine},
            {"if": machine, "then": {"required": ["machine_stiffness"]}},
            {"if": {"required": ["drive"]}, "then": cycle},
            {
                "if": {"anyOf": [
                    {"not": {"required": ["question"]}},
                    {"properties": {"question": {"enum": without_load}}},
                ]},
                "then": {"not": loads},
            },
        ],
    })
}

fn described(mut schema: Value, description: &str, default: &str) -> Value {
    schema["description"] = description.into();
    schema["default"] = default.into();
    schema
}

/// Schema of `[axes]`: keys by their paths, in quotes or as tables, or by their last names.
pub(crate) fn axes_schema() -> Value {
    let mut properties = Map::new();
    let variables = || {
        let keys = Key::ALL.into_iter().map(Variable::Key);
        keys.chain([Variable::Indentation, Variable::Force])
    };
    // The names of each variable. A last name may belong to several: the kind of surface decides.
    let mut named: BTreeMap<String, Vec<Variable>> = BTreeMap::new();
    for variable in variables() {
        for surface in [false, true] {
            for name in names(variable) {
                let Ok(found) = Variable::named(&name, surface) else {
                    continue;
                };
                let all = named.entry(name).or_default();
                if !all.contains(&found) {
                    all.push(found);
                }
            }
        }
    }
    for (name, variables) in named {
        let schemas: Vec<Value> = variables.into_iter().map(axis_schema).collect();
        let of_all = match &schemas[..] {
            [one] => one.clone(),
            _ => json!({"anyOf": schemas}),
        };
        if let Some((table, last)) = name.rsplit_once('.') {
            nested(&mut properties, table, last, of_all.clone());
        }
        properties.insert(name, of_all);
    }
    json!({
        "type": "object",
        "description": "What is varied: each axis is a list, or a range { from, to, points, spacing }.",
        "minProperties": 1,
        "additionalProperties": false,
        "properties": properties,
    })
}

/// All names of a variable, deprecated ones included.
fn names(variable: Variable) -> Vec<String> {
    let path = variable.path();
    let last = |path: &str| path.rsplit('.').next().unwrap_or(path).to_owned();
    let mut names = vec![path.to_owned(), last(path)];
    if let Variable::Key(key) = variable {
        if let Some(former) = key.former() {
            names.extend([former.to_owned(), last(former)]);
        }
    }
    for index in 0..names.len() {
        if let Some(rest) = names[index].strip_prefix(PATTERN_TABLE)
            && rest.starts_with('.')
        {
            names.push(format!("{FORMER_TABLE}{rest}"));
        }
    }
    names
}

/// Adds an axis to the object of a table inside `[axes]`.
fn nested(properties: &mut Map<String, Value>, table: &str, name: &str, axis: Value) {
    let (first, rest) = table.split_once('.').unwrap_or((table, ""));
    let object = properties.entry(first).or_insert_with(
        || json!({"type": "object", "additionalProperties": false, "properties": {}}),
    );
    let Some(inner) = object["properties"].as_object_mut() else {
        return;
    };
    if rest.is_empty() {
        inner.insert(name.to_owned(), axis);
    } else {
        nested(inner, rest, name, axis);
    }
}

/// Schema of the values of a variable.
fn variable_schema(variable: Variable) -> Value {
    match variable {
        Variable::Key(key) => json!({"$ref": format!("#/definitions/{key}")}),
        load => {
            let dimension = load.dimension().unwrap_or(Dimension::Number);
            let bounds = (Included(0.0), Unbounded);
            let mut schema = quantity_schema(dimension, bounds, dimension.usual());
            schema["description"] =
                format!("prescribed {} (in {})", load.path(), dimension.unit_list()).into();
            schema
        }
    }
}

/// Schema of an axis: a list, or a range of numbers.
fn axis_schema(variable: Variable) -> Value {
    let item = variable_schema(variable);
    let list = json!({"type": "array", "items": item, "minItems": 1});
    if variable.dimension().is_none() {
        return list;
    }
    let range = json!({
        "type": "object",
        "additionalProperties": false,
        "required": ["from", "to", "points"],
        "properties": {
            "from": item,
            "to": item,
            "points": whole_schema(2.0, MAXIMUM_CASES as f64),
            "spacing": words_schema(&PointSpacing::all()),
        },
    });
    json!({"anyOf": [list, range]})
}
