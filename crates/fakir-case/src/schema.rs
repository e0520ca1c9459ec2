//! A JSON Schema of case and study files, made from the key table.
//!
//! It states what a file must contain by itself: names, kinds of values, words, units, signs and ranges, and keys that require or exclude
//! each other. Conditions between numbers, and files that a case names, are checked when the case is read.

use crate::entries::STUDY_TABLES;
use crate::key::{FORMER_TABLE, Key, PATTERN_TABLE, Setting};
use crate::study::{Variable, axes_schema, axis_definitions, is_axis, load_rules, study_schema};
use crate::table::{IMPLIED, Part, Presence};
use crate::value_schema::{accepted_words, key_schema};
use serde_json::{Map, Value, json};

/// A JSON Schema (draft 7) of case and study files, as editors of TOML use it to complete and check them.
///
/// ```
/// let schema = fakir_case::schema();
/// assert_eq!(schema["properties"]["lens"]["type"], "object");
/// ```
#[must_use]
pub fn schema() -> Value {
    let keys = Key::ALL.into_iter();
    let values = keys.map(|key| (key.path().to_owned(), key_schema(key)));
    let keys = Key::ALL.into_iter();
    let presences = keys.map(|key| (format!("given {key}"), given_anywhere(key)));
    let definitions: Map<String, Value> =
        values.chain(axis_definitions()).chain(presences).collect();
    let mut properties = Map::new();
    for key in Key::ALL {
        let value = json!({"$ref": format!("#/definitions/{key}")});
        insert(&mut properties, key.path(), value);
        if let Some(former) = key.former() {
            let note = format!("deprecated: use {key}");
            let mut value = key_schema(key);
            value["description"] = note.into();
            insert(&mut properties, former, value);
        }
    }
    let mut former = properties[PATTERN_TABLE].clone();
    former["description"] = format!("deprecated: use [{PATTERN_TABLE}]").into();
    properties.insert(FORMER_TABLE.to_owned(), former);
    let tables: Vec<Value> = properties.keys().map(|name| has(name)).collect();
    let [study, axes] = STUDY_TABLES;
    properties.insert(study.to_owned(), study_schema());
    properties.insert(axes.to_owned(), axes_schema());
    // The case of a study may be in another file, and the deprecated table is checked when the file is read.
    let is_elsewhere = any(vec![has("study.case"), has(FORMER_TABLE)]);
    let mut rules = vec![
        json!({"if": has(study), "then": has(axes)}),
        json!({"if": has("study.case"), "then": not(any(tables))}),
        not(all(vec![has(PATTERN_TABLE), has("surface")])),
        json!({"if": not(is_elsewhere), "then": of_kinds()}),
    ];
    rules.extend(load_rules());
    for key in Key::ALL {
        if let Some(other) = key.alternative().filter(|other| key < *other) {
            let axes = [key, other].map(|key| is_axis(Variable::Key(key)));
            rules.push(not(all(axes.into())));
        }
    }
    json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Case and study files of fakir",
        "description": "Quantities have a unit, as in \"6 um\"; bare numbers are in SI units.",
        "type": "object",
        "additionalProperties": false,
        "properties": properties,
        "definitions": definitions,
        "allOf": rules,
    })
}

/// Adds a value to the objects of nested tables.
fn insert(properties: &mut Map<String, Value>, path: &str, value: Value) {
    let Some((table, rest)) = path.split_once('.') else {
        properties.insert(path.to_owned(), value);
        return;
    };
    let object = properties.entry(table).or_insert_with(
        || json!({"type": "object", "additionalProperties": false, "properties": {}}),
    );
    if let Some(inner) = object["properties"].as_object_mut() {
        insert(inner, rest, value);
    }
}

/// Rules of a case by its kind of surface.
fn of_kinds() -> Value {
    let is_flat = any(vec![
        both(has(Key::Flat.path()), in_words(Key::Flat, &["true"])),
        not(any(vec![has(PATTERN_TABLE), has("surface")])),
    ]);
    let of = |parts: &[Part]| -> Value {
        let wanted = Key::ALL.into_iter();
        all(wanted
            .filter(|key| parts.contains(&key.part()))
            .flat_map(rules)
            .collect())
    };
    let refused = |is_refused: &dyn Fn(Key) -> bool| -> Value {
        let keys = Key::ALL.into_iter().filter(|key| is_refused(*key));
        not(any(keys.map(written).collect()))
    };
    let flat = both(refused(&|key| !key.is_on_flat()), of(Part::OF_FLAT));
    let (map, pattern) = (Key::HeightMap, Key::Arrangement);
    let on_map = |kind: Part, other: Part| {
        both(
            refused(&|key| [other, Part::PillarPattern].contains(&key.part())),
            of(&[
                Part::Bodies,
                Part::Shape,
                Part::Surface,
                kind,
                Part::Adhesion,
                Part::AdhesionOnFloor,
            ]),
        )
    };
    let surface = all(vec![
        json!({"oneOf": [given(map), given(pattern)]}),
        json!({
            "if": given(map),
            "then": on_map(Part::HeightMap, Part::Pattern),
            "else": on_map(Part::Pattern, Part::HeightMap),
        }),
    ]);
    json!({
        "if": is_flat,
        "then": flat,
        "else": {"if": has("surface"), "then": surface, "else": of(Part::OF_PILLARS)},
    })
}

/// Rules of a key in the cases of its kind: with which words it is accepted, when it is required, and what it needs.
fn rules(key: Key) -> Vec<Value> {
    let mut rules = Vec::new();
    let choices: Vec<Value> = key
        .choices()
        .map(|(choice, words)| chosen(choice, words))
        .collect();
    if !choices.is_empty() {
        rules.push(json!({"if": written(key), "then": all(choices)}));
    }
    if let Some(needed) = key.needs() {
        rules.push(json!({"if": given(key), "then": given(needed)}));
    }
    match key.row().presence {
        Presence::Required => {
            let mut instead = vec![given(key)];
            // As in the check of absent keys: a table may contain it for every pillar, and a rounded top has no rim.
            if key.is_of_listed_pillars() {
                instead.push(chosen(Key::Lattice, &["listed"]));
            }
            if key == Key::PillarDiameter {
                instead.push(given(Key::TopRadius));
            }
            rules.push(json!({"if": accepted(key), "then": any(instead)}));
        }
        Presence::OneOf(other) => {
            rules.push(not(both(written(key), written(other))));
            // A height map may contain its size.
            if key.part() != Part::HeightMap {
                let alone = both(accepted(key), not(accepted(other)));
                rules.push(json!({"if": alone, "then": given(key)}));
                let either = any(vec![given(key), given(other)]);
                rules.push(json!({"if": both(accepted(key), accepted(other)), "then": either}));
            }
        }
        Presence::Default | Presence::Otherwise(_) | Presence::EitherSurface(_) => {}
    }
    rules
}

/// Whether a key is accepted, by the words of the keys on which it depends.
fn accepted(key: Key) -> Value {
    all(key
        .choices()
        .map(|(choice, words)| chosen(choice, words))
        .collect())
}

/// Whether a key has one of some words: as given, by default, or because another key implies it.
fn chosen(choice: Key, words: &[&str]) -> Value {
    let is_written = both(written(choice), in_words(choice, words));
    // Along an axis the words differ.
    let mut ways = vec![is_written, is_axis(Variable::Key(choice))];
    let implied: Vec<(Key, &str)> = IMPLIED
        .into_iter()
        .filter(|(_, set, _)| *set == choice)
        .map(|(by, _, word)| (by, word))
        .collect();
    for (by, word) in &implied {
        if words.contains(word) {
            ways.push(both(given(*by), not(given(choice))));
        }
    }
    let is_default = |default: &Setting| match default {
        Setting::Word(word) => words.contains(&word.as_str()),
        Setting::Number(_) => false,
    };
    if choice.default().is_some_and(|default| is_default(&default)) {
        let mut absent = vec![given(choice)];
        absent.extend(implied.iter().map(|(by, _)| given(*by)));
        ways.push(not(any(absent)));
    }
    any(ways)
}

/// Whether a key is given: in the case, or as an axis.
fn given(key: Key) -> Value {
    json!({"$ref": format!("#/definitions/given%20{key}")})
}

/// The definition of [`given`].
fn given_anywhere(key: Key) -> Value {
    any(vec![written(key), is_axis(Variable::Key(key))])
}

/// Whether a key is written in the case, by its name or its deprecated one.
fn written(key: Key) -> Value {
    let names = [Some(key.path()), key.former()];
    any(names.into_iter().flatten().map(has).collect())
}

/// Whether there is a table or a key at a path.
fn has(path: &str) -> Value {
    match path.split_once('.') {
        Some((table, rest)) => json!({"required": [table], "properties": {table: has(rest)}}),
        None => json!({"required": [path]}),
    }
}

/// Whether a key, if it is given, has one of some words.
fn in_words(key: Key, words: &[&str]) -> Value {
    let innermost = accepted_words(key, words);
    key.path().rsplit('.').fold(
        innermost,
        |inner, name| json!({"properties": {name: inner}}),
    )
}

fn both(one: Value, other: Value) -> Value {
    all(vec![one, other])
}

fn all(mut schemas: Vec<Value>) -> Value {
    match schemas.len() {
        0 => json!({}),
        1 => schemas.remove(0),
        _ => json!({"allOf": schemas}),
    }
}

fn any(mut schemas: Vec<Value>) -> Value {
    match schemas.len() {
        1 => schemas.remove(0),
        _ => json!({"anyOf": schemas}),
    }
}

fn not(schema: Value) -> Value {
    Value::Object(Map::from_iter([("not".to_owned(), schema)]))
}
