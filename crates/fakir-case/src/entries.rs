//! A TOML document as a flat list of known keys, each with its position.

use crate::error::{CaseError, Place, Source};
use crate::key::{
    FORMER_TABLE, Key, Kind, PATTERN_TABLE, Setting, former_table_words, is_table, join, names_in,
    present, similar,
};
use crate::unit::{Dimension, parse_quantity, with_article};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeFloat, DeInteger, DeString, DeTable, DeValue};

/// Value of a key as written in a file, before it is interpreted.
#[derive(Debug, Clone)]
pub(crate) enum Value {
    Text(String),
    /// A number as written, without a unit.
    Number(f64),
    /// A number in SI units that was not parsed from text.
    InSi(f64),
    Flag(bool),
    /// A list of values.
    List(Vec<Value>),
    /// A kind of value that no key accepts, by its name in TOML, such as a date.
    Other(&'static str),
}

/// A key that was set.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) value: Value,
    pub(crate) place: Place,
}

impl Entry {
    /// Whether it is `true`, as a flag or a word.
    pub(crate) fn is_true(&self) -> bool {
        match &self.value {
            Value::Flag(flag) => *flag,
            Value::Text(text) => text == "true",
            _ => false,
        }
    }

    /// A list of numbers in SI units that does not come from a file, as [`of_setting`](Self::of_setting).
    pub(crate) fn of_list(name: &str, key: Key, values: &[f64]) -> Self {
        let text = format!("{key} = {values:?}");
        Self {
            place: Place {
                span: 0..text.len(),
                source: Source::new(name, &text),
            },
            value: Value::List(values.iter().map(|value| Value::InSi(*value)).collect()),
        }
    }

    /// A setting that does not come from a file. Errors show it as `key = value` under that name.
    pub(crate) fn of_setting(name: &str, key: Key, setting: Setting) -> Self {
        let text = format!("{key} = {}", key.written(&setting));
        Self {
            place: Place {
                span: 0..text.len(),
                source: Source::new(name, &text),
            },
            value: match setting {
                Setting::Number(number) => Value::InSi(number),
                Setting::Word(word) => Value::Text(word),
            },
        }
    }
}

/// All keys that a document sets.
#[derive(Debug, Clone, Default)]
pub(crate) struct Entries {
    pub(crate) keys: BTreeMap<Key, Entry>,
    /// Position of the header of each table, for errors of missing keys.
    pub(crate) tables: BTreeMap<String, Place>,
    /// Keys that were given by a deprecated path.
    pub(crate) former: BTreeSet<Key>,
    /// Whether the table of the pillar pattern was given by its deprecated name.
    pub(crate) former_table: bool,
}

impl Entries {
    /// Reads a whole document.
    pub(crate) fn parse(source: &Source) -> Result<Self, CaseError> {
        let document = document(source)?;
        let mut entries = Self::default();
        entries.table(source, "", document.get_ref())?;
        Ok(entries)
    }

    /// Reads a document except the tables of a study.
    pub(crate) fn beside_study(source: &Source, document: &DeTable<'_>) -> Result<Self, CaseError> {
        let mut entries = Self::default();
        for (name, value) in in_order(document) {
            if !STUDY_TABLES.contains(&name.get_ref().as_ref()) {
                entries.item(source, name.get_ref(), name.span(), value)?;
            }
        }
        Ok(entries)
    }

    fn table(&mut self, source: &Source, path: &str, table: &DeTable<'_>) -> Result<(), CaseError> {
        for (name, value) in in_order(table) {
            let path = join(path, name.get_ref());
            self.item(source, &path, name.span(), value)?;
        }
        Ok(())
    }

    fn item(
        &mut self,
        source: &Source,
        path: &str,
        name: Range<usize>,
        value: &Spanned<DeValue<'_>>,
    ) -> Result<(), CaseError> {
        let place = |span| Place {
            source: source.clone(),
            span,
        };
        let written = path;
        let path = &*present(written);
        self.former_table |= path != written;
        if let Some(key) = Key::at(path) {
            let entry = Entry {
                value: plain_value(value.get_ref()),
                place: place(value.span()),
            };
            if path != key.path() {
                self.former.insert(key);
            }
            if let Some(first) = self.keys.insert(key, entry.clone()) {
                let names = [key.path(), key.former().unwrap_or_default()];
                let [a, b] = [(names[0], &first.place), (names[1], &entry.place)];
                return Err(both_given(a, b, key.table()).accepted(format!(
                    "give {key} alone: the other is its deprecated name"
                )));
            }
            return Ok(());
        }
        if STUDY_TABLES.contains(&path) {
            return Err(
                CaseError::at(&place(name), "this is a table of a study, not of a case")
                    .key(path)
                    .accepted("`fakir sweep` takes a study; leave this table out for a case"),
            );
        }
        if !is_table(path) {
            return Err(unknown_key(&place(name), path));
        }
        match value.get_ref() {
            DeValue::Table(table) => {
                let header = place(name);
                if let Some(first) = self.tables.insert(path.to_owned(), header.clone()) {
                    let names = [PATTERN_TABLE, FORMER_TABLE].map(|name| format!("[{name}]"));
                    let [a, b] = [(&*names[0], &first), (&*names[1], &header)];
                    return Err(both_given(a, b, "").accepted(former_table_words()));
                }
                self.table(source, path, table)
            }
            other => Err(CaseError::at(
                &place(value.span()),
                format!("this is a table, found {}", with_article(other.type_str())),
            )
            .key(path)
            .accepted(format!(
                "[{path}] with the keys {}",
                names_in(path).join(", ")
            ))),
        }
    }
}

/// Tables of a study file that a case file does not have.
pub(crate) const STUDY_TABLES: [&str; 2] = ["study", "axes"];

/// Parses a text as TOML.
pub(crate) fn document(source: &Source) -> Result<Spanned<DeTable<'_>>, CaseError> {
    let (document, errors) = DeTable::parse_recoverable(source.text());
    match first(errors) {
        Some(error) => Err(syntax_error(source, &error)),
        None => Ok(document),
    }
}

/// Entries of a table in the order of the file, so that its first error is reported.
pub(crate) fn in_order<'a, 'i>(
    table: &'a DeTable<'i>,
) -> Vec<(&'a Spanned<DeString<'i>>, &'a Spanned<DeValue<'i>>)> {
    let mut items: Vec<_> = table.iter().collect();
    items.sort_by_key(|(name, _)| name.span().start);
    items
}

/// Reads the value of an override: TOML, or bare words such as `3 um`.
pub(crate) fn override_value(text: &str) -> Value {
    match DeValue::parse(text) {
        Ok(value) => plain_value(value.get_ref()),
        Err(_) => Value::Text(text.to_owned()),
    }
}

pub(crate) fn plain_value(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => Value::Text(text.clone().into_owned()),
        DeValue::Integer(number) => Value::Number(integer(number)),
        DeValue::Float(number) => Value::Number(float(number)),
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Array(items) => Value::List(
            items
                .iter()
                .map(|item| plain_value(item.get_ref()))
                .collect(),
        ),
        other => Value::Other(other.type_str()),
    }
}

/// The nearest number to an integer of any length.
fn integer(number: &DeInteger<'_>) -> f64 {
    match number.radix() {
        10 => number.as_str().parse().unwrap_or(f64::NAN),
        radix => i128::from_str_radix(number.as_str(), radix).map_or(f64::NAN, |n| n as f64),
    }
}

fn float(number: &DeFloat<'_>) -> f64 {
    number.as_str().parse().unwrap_or(f64::NAN)
}

/// The first error in the text.
fn first(errors: Vec<toml::de::Error>) -> Option<toml::de::Error> {
    errors
        .into_iter()
        .min_by_key(|error| error.span().map_or(0, |span| span.start))
}

fn syntax_error(source: &Source, error: &toml::de::Error) -> CaseError {
    let report = CaseError::new(source, format!("not valid TOML: {}", error.message()));
    let report = match error.span() {
        Some(span) => report.label(span, "here"),
        None => report,
    };
    match error.message() {
        "duplicate key" => report.accepted("give each key and each table once"),
        _ => report.accepted(
            "a case file has lines like `key = value`, with words and quantities in double quotes",
        ),
    }
}

pub(crate) fn unknown_key(place: &Place, path: &str) -> CaseError {
    let (table, _) = path.rsplit_once('.').unwrap_or(("", path));
    let meant = similar(path).map(|meant| did_you_mean(place, path, &meant));
    if !table.is_empty() && !is_table(table) {
        let error = CaseError::at(place, format!("there is no table [{table}]")).key(path);
        let tables = format!("known tables: {}", names_in("").join(", "));
        return error.accepted(meant.unwrap_or(tables));
    }
    let place_in_file = match table {
        "" => "at the top level".to_owned(),
        _ => format!("in [{table}]"),
    };
    let known = format!("known {place_in_file}: {}", names_in(table).join(", "));
    let help = match meant {
        Some(meant) => format!("{meant} {known}"),
        None => known,
    };
    CaseError::at(place, "unknown key").key(path).accepted(help)
}

/// Advice to use another key. In a file, a key without its table is one whose heading is missing.
fn did_you_mean(place: &Place, path: &str, meant: &str) -> String {
    match meant.rsplit_once('.') {
        Some((table, name)) if name == path && !place.is_override() && Key::at(meant).is_some() => {
            format!("did you mean {meant}, below a heading [{table}]?")
        }
        _ => format!("did you mean {meant}?"),
    }
}

/// Error for a value assigned to a table, as in `method=love`, with the keys that accept it.
pub(crate) fn table_for_key(place: &Place, name: &str, surface: bool, value: &str) -> CaseError {
    let read = override_value(value);
    let inside = Key::ALL.into_iter().filter(|key| key.table() == name);
    let takes = |key: &Key| match (&read, key.kind()) {
        (Value::Text(text), Kind::Number(dimension)) => parse_quantity(text, dimension).is_ok(),
        (Value::Text(text), Kind::Word) => key.words().contains(&text.as_str()),
        (Value::Number(_), Kind::Number(_)) => true,
        (Value::Flag(_), Kind::Word) => key.is_flag(),
        (Value::List(_), Kind::List(_)) => true,
        _ => false,
    };
    let meant: Vec<String> = inside
        .chain(Key::named(name, surface))
        .filter(takes)
        .map(|key| format!("{key}={value}"))
        .collect();
    let keys = format!("keys of [{name}]: {}", names_in(name).join(", "));
    let advice = match &meant[..] {
        [] => keys,
        _ => format!("did you mean {}? {keys}", meant.join(" or ")),
    };
    CaseError::at(place, "this is a table of keys, not a key")
        .key(name)
        .accepted(advice)
}

/// Error for an ambiguous name.
pub(crate) fn ambiguous_key(place: &Place, name: &str, keys: &[Key]) -> CaseError {
    let paths: Vec<&str> = keys.iter().map(|key| key.path()).collect();
    CaseError::at(place, format!("{} keys have this name", keys.len()))
        .key(name)
        .accepted(format!("give {}", paths.join(" or ")))
}

/// Kind of a value, for "found ...".
pub(crate) fn kind_name(value: &Value) -> String {
    match value {
        Value::Text(_) => "a string".to_owned(),
        Value::Number(_) | Value::InSi(_) => "a number".to_owned(),
        Value::Flag(_) => "a boolean".to_owned(),
        Value::List(_) => "an array".to_owned(),
        Value::Other(name) => with_article(name),
    }
}

/// Accepted values of a key, for "accepted: ...".
pub(crate) fn accepted(key: Key) -> String {
    match key.kind() {
        Kind::Number(dimension) => dimension.accepted(),
        Kind::Word if key.is_flag() => format!("give {}", key.words().join(" or ")),
        Kind::Word => one_of(&key.words()),
        Kind::Text => NAME_IN_QUOTES.to_owned(),
        Kind::List(Dimension::Number) => "give a list of numbers, as [1.0, 0.5]".to_owned(),
        Kind::List(_) => {
            "give a list of quantities with their units, as [\"10 s\", \"2 min\"]".to_owned()
        }
    }
}

/// Accepted values for the name of a file, or of something in a file.
pub(crate) const NAME_IN_QUOTES: &str = "give a name in quotes";

/// Advice to give one of some words.
pub(crate) fn one_of(words: &[&str]) -> String {
    let words: Vec<_> = words.iter().map(|word| format!("\"{word}\"")).collect();
    match words.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("give {} or {last}", rest.join(", ")),
        _ => format!("give {}", words.concat()),
    }
}

/// Error for two entries that exclude each other; it points at the later one.
pub(crate) fn both_given(a: (&str, &Place), b: (&str, &Place), table: &str) -> CaseError {
    let (first, second) = if a.1.span.start < b.1.span.start {
        (a.1, b.1)
    } else {
        (b.1, a.1)
    };
    let mut error = CaseError::at(second, format!("{} and {} are both given", a.0, b.0));
    if !table.is_empty() {
        error = error.key(table);
    }
    if first.source.text() == second.source.text() {
        error = error.label(first.span.clone(), "and here");
    }
    error
}
