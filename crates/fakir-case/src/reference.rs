//! The reference of all keys, generated from the key table.

use crate::entries::one_of;
use crate::idle::{IDLE, Idle};
use crate::key::{Key, Kind};
use crate::table::Part;
use crate::table::Presence;
use crate::unit::Dimension;
use std::fmt::Write;

/// All keys of case files as Markdown: for each table of the file, the accepted values of its keys,
/// when they are required, and their meanings.
#[must_use]
pub fn reference() -> String {
    let mut text = String::from(HEADER);
    let mut table = "";
    for key in Key::ALL {
        if key.table() != table {
            table = key.table();
            let _ = writeln!(text, "\n## [{table}]\n\n{COLUMNS}");
        }
        let _ = writeln!(
            text,
            "| `{}` | {} | {} | {} |",
            key.name(),
            value(key),
            presence(key),
            key.summary()
        );
    }
    text.push_str(WITHOUT_EFFECT);
    for Idle { key, reason, .. } in &IDLE {
        let _ = writeln!(text, "| `{key}` | {reason} |");
    }
    text
}

/// Accepted values of a key.
fn value(key: Key) -> String {
    match (key.kind(), key.range()) {
        (Kind::Number(Dimension::Number), Some(range)) => range.to_string(),
        (Kind::Number(dimension), Some(range)) => format!("{dimension}: {range}"),
        (Kind::Word, _) => words(&key.words()),
        (Kind::List(Dimension::Number), _) => "a list of numbers: greater than 0".to_owned(),
        (Kind::List(dimension), _) => format!("a list, each {dimension}: greater than 0"),
        _ => "a text".to_owned(),
    }
}

/// When a key is required, and its default otherwise.
fn presence(key: Key) -> String {
    let presence = match key.row().presence {
        Presence::Required if key.is_of_listed_pillars() => {
            format!(
                "required, unless a table of pillars has a column `{}_m`",
                key.name()
            )
        }
        Presence::Required => "required".to_owned(),
        Presence::Default => key.default().map_or_else(String::new, |value| {
            format!("default `{}`", key.written(&value))
        }),
        Presence::Otherwise(words) => format!("may be left out: {words}"),
        Presence::OneOf(other) | Presence::EitherSurface(other) => {
            format!("this or `{}`", other.name())
        }
    };
    let condition = match (key.goes_with(), key.part()) {
        (Some(_), _) => {
            let conditions: Vec<String> = key
                .choices()
                .map(|(choice, own)| format!("`{choice}` is {}", words(own)))
                .collect();
            format!("only if {}; ", conditions.join(" and "))
        }
        (None, Part::HeightMap) if key != Key::HeightMap => {
            format!("only with `{}`; ", Key::HeightMap.name())
        }
        (None, Part::Pattern) if key != Key::Arrangement => {
            format!("only with `{}`; ", Key::Arrangement.name())
        }
        _ => String::new(),
    };
    format!("{condition}{presence}")
}

/// Words in quotes, the last with an "or".
fn words(words: &[&str]) -> String {
    let list = one_of(words).replace('"', "`");
    list.strip_prefix("give ").unwrap_or(&list).to_owned()
}

const COLUMNS: &str = "\
| key | value | given | meaning |
|---|---|---|---|";

const HEADER: &str = "\
# The keys of a case file

A case has `[lens]` and `[substrate]`, `[relaxation]` if they are viscoelastic, and either `[pattern]`, with or without `[floor]`, `[adhesion]` and `[method]`, or
`[surface]`. Quantities have a unit, as in `\"6 um\"`; bare numbers are in SI units. Fractions can be in per
cent, as in `\"3 %\"`.
";

const WITHOUT_EFFECT: &str = "
## Keys without effect

A key that does not apply to a case is refused. These keys are accepted and have no effect in some cases; a warning on standard error and
`case_warnings` of the JSON results name them:

| key | reason |
|---|---|
";
