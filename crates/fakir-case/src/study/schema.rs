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
    let machine = is("drive", LoadingModeName::Machine.word());
    let cycle = is("question", Asked::Cycle.name());
    let hold = is("question", Asked::Hold.name());
    let times = Variable::RAMP.into_iter().chain([Variable::HoldTime]);
    let times: Vec<Value> = times
        .map(|time| json!({"required": [time.path()]}))
        .collect();
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
            "ramp_time": variable_schema(Variable::RampTime),
            "indentation_rate": variable_schema(Variable::IndentationRate),
            "force_rate": variable_schema(Variable::ForceRate),
            "hold_time": variable_schema(Variable::HoldTime),
            "drive": described(
                words_schema(&LoadingModeName::all()),
                "what is prescribed in a cycle",
                LoadingModeName::Displacement.word(),
            ),
            "machine_stiffness": stiffness,
        },
        "allOf": [
            {"if": {"required": ["machine_stiffness"]}, "then": machine},
            {"if": machine, "then": {"required": ["machine_stiffness"]}},
            {"if": {"required": ["drive"]}, "then": cycle},
            {"if": {"anyOf": times}, "then": hold},
        ],
    })
}

/// Rules of a study that concern more than one table: a load is given once, if the question needs one.
pub(crate) fn load_rules() -> Vec<Value> {
    let of_study = |inner: Value| json!({"required": ["study"], "properties": {"study": inner}});
    let loads = [Variable::Indentation, Variable::Force];
    let fixed = loads.map(|load| of_study(json!({"required": [load.path()]})));
    let varied = loads.map(is_axis);
    let all: Vec<&Value> = fixed.iter().chain(&varied).collect();
    let asks = |question: Asked| {
        of_study(
            json!({"required": ["question"], "properties": {"question": {"const": question.name()}}}),
        )
    };
    let mut rules = vec![json!({"if": asks(Asked::Press), "then": {"anyOf": all}})];
    for (index, one) in all.iter().enumerate() {
        for other in &all[..index] {
            rules.push(json!({"not": {"allOf": [one, other]}}));
        }
    }
    let takes_load = [Asked::Press, Asked::Cycle, Asked::Hold].map(asks);
    rules.push(json!({"if": {"anyOf": all}, "then": {"anyOf": takes_load}}));
    let ways = |variable: Variable| {
        let in_study = of_study(json!({"required": [variable.path()]}));
        [in_study, is_axis(variable)]
    };
    for times in [&Variable::RAMP[..], &[Variable::HoldTime]] {
        let all: Vec<Value> = times.iter().flat_map(|time| ways(*time)).collect();
        for (index, one) in all.iter().enumerate() {
            let others = all[..index].iter();
            rules.extend(others.map(|other| json!({"not": {"allOf": [one, other]}})));
        }
        let axes: Vec<Value> = times.iter().map(|time| is_axis(*time)).collect();
        rules.push(json!({"if": {"anyOf": axes}, "then": asks(Asked::Hold)}));
    }
    rules.push(json!({"if": asks(Asked::Hold), "then": {"anyOf": ways(Variable::HoldTime)}}));
    for (rate, load) in [
        (Variable::IndentationRate, Variable::Indentation),
        (Variable::ForceRate, Variable::Force),
    ] {
        rules.push(json!({"if": {"anyOf": ways(rate)}, "then": {"anyOf": ways(load)}}));
    }
    rules
}

fn described(mut schema: Value, description: &str, default: &str) -> Value {
    schema["description"] = description.into();
    schema["default"] = default.into();
    schema
}

/// Schema of `[axes]`: keys by their paths, in quotes or as tables, or by their last names.
pub(crate) fn axes_schema() -> Value {
    let (mut properties, mut tables) = (Map::new(), Map::new());
    let variables = || {
        let keys = Key::ALL.into_iter().map(Variable::Key);
        keys.chain(Variable::PRESCRIBED)
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
        let schemas: Vec<Value> = variables.into_iter().map(axis_reference).collect();
        let of_all = match &schemas[..] {
            [one] => one.clone(),
            _ => json!({"anyOf": schemas}),
        };
        if let Some((table, last)) = name.rsplit_once('.') {
            nested(&mut tables, table, last, of_all.clone());
        }
        properties.insert(name, of_all);
    }
    // `floor` is a table of keys and the last name of a key.
    for (name, table) in tables {
        let both = match properties.remove(&name) {
            Some(axis) => json!({"anyOf": [axis, table]}),
            None => table,
        };
        properties.insert(name, both);
    }
    // An axis by two names.
    let twice = variables().map(|variable| {
        let names: Vec<String> = names(variable)
            .into_iter()
            .filter(|name| properties.contains_key(name))
            .collect();
        let pairs = names
            .iter()
            .enumerate()
            .flat_map(|(index, one)| names[..index].iter().map(move |other| [other, one]));
        pairs
            .filter(|[one, other]| one != other)
            .map(|pair| json!({"required": pair}))
            .collect::<Vec<_>>()
    });
    let refused: Vec<Value> = twice.flatten().collect();
    json!({
        "type": "object",
        "description": "What is varied: each axis is a list, or a range { from, to, points, spacing }.",
        "minProperties": 1,
        "additionalProperties": false,
        "properties": properties,
        "not": {"anyOf": refused},
    })
}

/// Definitions of all axes, by their names in the schema.
pub(crate) fn axis_definitions() -> impl Iterator<Item = (String, Value)> {
    let keys = Key::ALL.into_iter().map(Variable::Key);
    let all = keys.chain(Variable::PRESCRIBED);
    all.map(|variable| (definition(variable), axis_schema(variable)))
}

/// Name of the definition of an axis.
fn definition(variable: Variable) -> String {
    format!("axis {}", variable.path())
}

fn axis_reference(variable: Variable) -> Value {
    json!({"$ref": format!("#/definitions/{}", definition(variable).replace(' ', "%20"))})
}

/// Whether a study has this axis, by any of its names: a schema of the whole file.
pub(crate) fn is_axis(variable: Variable) -> Value {
    let of_axes = |inner: Value| json!({"required": ["axes"], "properties": {"axes": inner}});
    let denotes = |name: &String| {
        [false, true]
            .into_iter()
            .any(|surface| Variable::named(name, surface).is_ok_and(|found| found == variable))
    };
    let mut ways: Vec<Value> = Vec::new();
    for name in names(variable).iter().filter(|name| denotes(name)) {
        ways.push(json!({"required": [name]}));
        if name.contains('.') {
            let nested = name
                .rsplit('.')
                .fold(Value::Null, |inner, part| match inner {
                    Value::Null => json!({"required": [part]}),
                    inner => json!({"required": [part], "properties": {part: inner}}),
                });
            ways.push(nested);
        }
    }
    of_axes(json!({"anyOf": ways}))
}

/// All names of a variable, deprecated ones included.
fn names(variable: Variable) -> Vec<String> {
    let path = variable.path();
    let last = |path: &str| path.rsplit('.').next().unwrap_or(path).to_owned();
    let mut names = vec![path.to_owned()];
    if last(path) != path {
        names.push(last(path));
    }
    if let Variable::Key(key) = variable
        && let Some(former) = key.former()
    {
        names.extend([former.to_owned(), last(former)]);
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
            let bounds = match load.is_rate() {
                true => (Excluded(0.0), Unbounded),
                false => (Included(0.0), Unbounded),
            };
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
    let Some(dimension) = variable.dimension() else {
        return list;
    };
    let positive = quantity_schema(dimension, (Excluded(0.0), Unbounded), None);
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
        "if": {"required": ["spacing"], "properties": {"spacing": {"const": PointSpacing::Log.word()}}},
        "then": {"properties": {"from": positive}},
    });
    json!({"anyOf": [list, range]})
}
