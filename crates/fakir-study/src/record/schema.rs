//! What results are made of, for readers and for programs: the tables of the manual, and a JSON Schema.

use super::named::{Entry, Kind, SCHEMA_VERSION, Type};
use super::object::groups;
use serde_json::{Map, Value, json};

/// The names of all numbers of contacts, as Markdown: a table for each kind of answer.
#[must_use]
pub fn reference() -> String {
    let tables = Kind::ALL.map(|kind| format!("## {}\n\n{}\n", kind.heading(), table(kind)));
    tables.join("\n")
}

/// The numbers of one kind: name, symbol, meaning.
fn table(kind: Kind) -> String {
    let mut lines = vec![
        "| name | symbol | meaning |".to_owned(),
        "|---|---|---|".to_owned(),
    ];
    for entry in kind.entries() {
        let columns = entry.columns();
        let names: Vec<String> = columns
            .iter()
            .map(|(name, _)| format!("`{name}`"))
            .collect();
        let names = names.join(", ");
        let own = format!("`{}`", entry.path);
        let name = if !entry.in_objects {
            format!("in tables {names}")
        } else if names.is_empty() || names == own {
            own
        } else {
            format!("{own}; in tables {names}")
        };
        lines.push(format!("| {name} | {} | {} |", entry.symbol, entry.meaning));
    }
    lines.join("\n")
}

/// The JSON Schema (draft 7) of `--json` and `summary.json` of `press`, `transition`, `approach` and `hold`, for every kind of surface, and of `cycle`: one definition a kind.
#[must_use]
pub fn schema() -> Value {
    let mut definitions: Map<String, Value> = Kind::ALL
        .iter()
        .map(|kind| (kind.name().to_owned(), of_kind(*kind)))
        .collect();
    definitions.insert("approach".to_owned(), approach());
    let answers = Kind::ALL.into_iter().filter(|kind| !kind.is_a_row());
    let answers = answers.map(Kind::name).chain(["approach"]);
    let kinds: Vec<Value> = answers.map(definition).collect();
    json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Results of fakir",
        "description": "Numbers are in SI units; names end in the unit.",
        "anyOf": kinds,
        "definitions": definitions,
    })
}

/// A reference to a definition of the schema.
fn definition(name: &str) -> Value {
    json!({"$ref": format!("#/definitions/{name}")})
}

/// Whether it is a part of a history.
fn of_history(kind: Kind) -> bool {
    matches!(kind, Kind::HistoryState | Kind::HistoryEvent)
}

/// A loading: its states, and the critical state if there is one.
fn approach() -> Value {
    let of = |kind: Kind| definition(kind.name());
    let states = Kind::ALL
        .into_iter()
        .filter(|kind| kind.is_a_row() && !of_history(*kind));
    let states: Vec<Value> = states.map(of).collect();
    let critical = [
        of(Kind::Transition),
        of(Kind::SurfaceTransition),
        of(Kind::AsperityTransition),
        json!({"type": "null"}),
    ];
    json!({
        "type": "object",
        "required": ["method", "critical", "states", "converged", "wall_time_s", "fakir_version"],
        "properties": {
            "method": {"type": "string"},
            "critical": {"anyOf": critical},
            "states": {"type": "array", "items": {"anyOf": states}},
            "converged": {"type": "boolean"},
            "wall_time_s": {"type": "number"},
            "fakir_version": {"type": "string"},
        },
    })
}

fn of_kind(kind: Kind) -> Value {
    let entries: Vec<(&str, &Entry)> = kind
        .entries()
        .iter()
        .filter(|entry| entry.in_objects)
        .map(|entry| (entry.path, entry))
        .collect();
    let mut object = of_group(&entries);
    if kind.is_a_row() {
        return object;
    }
    let number_or_none = json!({"type": ["number", "null"]});
    let limit = json!({
        "type": "object",
        "properties": {
            "name": {"type": "string"},
            "value": number_or_none,
            "threshold": number_or_none,
            "strained": {"type": "boolean"},
        },
        "required": ["name", "value", "threshold", "strained"],
        "additionalProperties": false,
    });
    let words = json!({"type": "array", "items": {"type": "string"}});
    // Beside the numbers: those that are always there, and those that may be.
    let always = [
        ("wall_time_s", json!({"type": "number"})),
        ("fakir_version", json!({"type": "string"})),
        ("schema_version", json!({"const": SCHEMA_VERSION})),
    ];
    let sometimes = [
        ("gradient", json!({"type": "object"})),
        ("floor", json!({"type": "object"})),
        ("case_warnings", words.clone()),
    ];
    let limits = json!({"type": "array", "items": limit});
    let limits = (kind != Kind::History).then_some(("limits", limits));
    let rows = json!({"type": "array", "items": {"type": "object"}});
    let of_cycle = [
        ("stations", rows.clone()),
        ("events", rows),
        ("warnings", words.clone()),
    ];
    let of_cycle = of_cycle.into_iter().filter(|_| kind == Kind::Cycle);
    let parts = |kind: Kind| json!({"type": "array", "items": definition(kind.name())});
    let with_states = [
        ("events", parts(Kind::HistoryEvent)),
        ("states", parts(Kind::HistoryState)),
        ("warnings", words.clone()),
    ];
    let with_states = with_states.into_iter().filter(|_| kind == Kind::History);
    if kind == Kind::History {
        // Method, indenter and surface, which depend on the kind of surface.
        object["additionalProperties"] = json!(true);
    }
    let required = limits
        .into_iter()
        .chain(of_cycle)
        .chain(with_states)
        .chain(always);
    for (name, value) in required {
        if let Some(names) = object["required"].as_array_mut() {
            names.push(name.into());
        }
        object["properties"][name] = value;
    }
    for (name, value) in sometimes {
        if object["properties"][name].is_null() {
            object["properties"][name] = value;
        }
    }
    object
}

/// An object of values by what is left of their paths.
fn of_group(entries: &[(&str, &Entry)]) -> Value {
    let mut properties = Map::new();
    for (name, group) in groups(entries, |(path, _)| path) {
        let inner: Vec<(&str, &Entry)> = group
            .iter()
            .filter_map(|(path, entry)| Some((path.split_once('.')?.1, *entry)))
            .collect();
        let value = if inner.is_empty() {
            of_entry(group[0].1)
        } else {
            let mut object = of_group(&inner);
            let may_be_missing = inner
                .iter()
                .any(|(path, entry)| entry.decides && !path.contains('.'));
            if may_be_missing {
                object["type"] = json!(["object", "null"]);
            }
            object
        };
        properties.insert(name, value);
    }
    let may_be_left_out = |name: &String| {
        let first = |path: &str| path.split('.').next() == Some(name);
        let mut own = entries.iter().filter(|(path, _)| first(path));
        own.all(|(_, entry)| entry.if_given)
    };
    let is_inside = entries.iter().all(|(_, entry)| entry.if_given);
    let names = properties.keys();
    let required: Vec<&String> = names
        .filter(|name| is_inside || !may_be_left_out(name))
        .collect();
    json!({
        "type": "object",
        "required": required,
        "properties": properties,
        "additionalProperties": false,
    })
}

fn of_entry(entry: &Entry) -> Value {
    let of = match entry.of {
        Type::Number => json!({"type": ["number", "null"]}),
        Type::Count => json!({"type": ["integer", "null"], "minimum": 0}),
        Type::Flag if entry.optional => json!({"type": ["boolean", "null"]}),
        Type::Flag => json!({"type": "boolean"}),
        Type::Word => json!({"type": ["string", "null"]}),
        Type::Words => json!({"type": "array", "items": {"type": "string"}}),
        Type::Point => json!({
            "type": ["array", "null"],
            "items": {"type": "number"},
            "minItems": 2,
            "maxItems": 2,
        }),
    };
    let mut object = of;
    object["description"] = entry.meaning.into();
    object
}
