//! JSON Schemas of single values: what a key, or an entry of a study, accepts.

use crate::key::{Key, Kind};
use crate::parts::TRUE_OR_FALSE;
use crate::table::Range;
use crate::unit::Dimension;
use serde_json::{Value, json};
use std::ops::Bound;

/// Digits of a number of either sign, as they are read before a unit.
const SIGNED: &str = r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?";

/// Digits of a number that is not negative.
const NOT_NEGATIVE: &str = r"(\+?(\d+\.?\d*|\.\d+)|-(0+\.?0*|\.0+))([eE][+-]?\d+)?";

/// Digits of a positive number.
const POSITIVE: &str = r"\+?(0*[1-9]\d*(\.\d*)?|0*\.0*[1-9]\d*)([eE][+-]?\d+)?";

/// Sign that every value of a quantity has, whatever its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Sign {
    Any,
    NotNegative,
    Positive,
}

/// Schema of a number with or without a unit, `bounds` in SI units. `usual` is the range by which a number without a unit is judged.
pub(crate) fn quantity_schema(
    dimension: Dimension,
    bounds: (Bound<f64>, Bound<f64>),
    usual: Option<[f64; 2]>,
) -> Value {
    let mut schema = json!({"type": "number"});
    match bounds.0 {
        Bound::Included(least) => schema["minimum"] = least.into(),
        Bound::Excluded(least) => schema["exclusiveMinimum"] = least.into(),
        Bound::Unbounded => {}
    }
    match bounds.1 {
        Bound::Included(greatest) => schema["maximum"] = greatest.into(),
        Bound::Excluded(greatest) => schema["exclusiveMaximum"] = greatest.into(),
        Bound::Unbounded => {}
    }
    if let Some([least, greatest]) = usual.map(|usual| dimension.plausible(usual)) {
        let is_signed = matches!(bounds.0, Bound::Unbounded);
        if least > 0.0 || (least.is_finite() && is_signed) {
            schema["minimum"] = least.into();
        }
        let limited = matches!(bounds.1, Bound::Unbounded);
        if greatest.is_finite() && limited {
            schema["maximum"] = greatest.into();
        }
    }
    let sign = match bounds.0 {
        Bound::Excluded(least) if least >= 0.0 => Sign::Positive,
        Bound::Included(least) if least >= 0.0 => Sign::NotNegative,
        _ => Sign::Any,
    };
    if let Some(pattern) = with_unit(dimension, sign) {
        schema["type"] = json!(["number", "string"]);
        schema["pattern"] = pattern.into();
    }
    schema
}

/// Regular expression of a number with a unit; `None` if numbers of this dimension have no unit.
fn with_unit(dimension: Dimension, sign: Sign) -> Option<String> {
    let digits = match sign {
        Sign::Any => SIGNED,
        Sign::NotNegative => NOT_NEGATIVE,
        Sign::Positive => POSITIVE,
    };
    let units: Vec<String> = dimension
        .symbols()
        .map(|symbol| {
            symbol
                .replace('u', "[u\u{b5}\u{3bc}]")
                .replace('2', r"(\^?2|²)")
                .replace('\u{c5}', "[\u{c5}\u{212b}]")
        })
        .collect();
    (!units.is_empty()).then(|| format!(r"^\s*({digits})\s*({})\s*$", units.join("|")))
}

/// Schema of one of some words.
pub(crate) fn words_schema(words: &[&str]) -> Value {
    json!({"enum": words})
}

/// Schema of a number without a unit that is an integer.
pub(crate) fn whole_schema(first: f64, last: f64) -> Value {
    json!({"type": "integer", "minimum": first as u64, "maximum": last as u64})
}

/// Schema of the values of a key, with its meaning and default.
pub(crate) fn key_schema(key: Key) -> Value {
    let mut schema = match (key.kind(), key.range()) {
        (Kind::Number(_), Some(Range::Whole(first, last))) => {
            whole_schema(first as f64, last as f64)
        }
        (Kind::Number(dimension), _) => quantity_schema(dimension, key.bounds(), key.judged_by()),
        (Kind::Word, _) => accepted_words(key, &key.words()),
        (Kind::List(dimension), _) => json!({
            "type": "array",
            "items": quantity_schema(dimension, key.bounds(), key.judged_by()),
        }),
        (Kind::Text, _) => json!({"type": "string"}),
    };
    if key.range() == Some(Range::NotZero) {
        schema["not"] = json!({"const": 0});
    }
    schema["description"] = description(key).into();
    if let Some(default) = key.default() {
        schema["default"] = default_of(key, &key.written(&default));
    }
    schema
}

/// Some words of a key: Boolean values are accepted with and without quotes.
pub(crate) fn accepted_words(key: Key, words: &[&str]) -> Value {
    if !key.is_flag() {
        return words_schema(words);
    }
    let bare = words.iter().map(|word| json!(*word == TRUE_OR_FALSE[0]));
    let quoted = words.iter().map(|word| json!(word));
    json!({"enum": bare.chain(quoted).collect::<Vec<_>>()})
}

/// A default as it is written in TOML, as JSON: numbers, flags and strings have the same form in both.
fn default_of(key: Key, written: &str) -> Value {
    serde_json::from_str(written).unwrap_or_else(|_| format!("{key}: {written}").into())
}

/// Meaning of a key, with its units and the valid range.
fn description(key: Key) -> String {
    let units = match key.kind() {
        Kind::Number(Dimension::Fraction) => " (a number, or in per cent as \"3 %\")".to_owned(),
        Kind::Number(dimension) if dimension.symbols().next().is_some() => {
            format!(
                " (in {}; a bare number is in SI units)",
                dimension.unit_list()
            )
        }
        _ => String::new(),
    };
    let range = match key.range() {
        None | Some(Range::Finite) => String::new(),
        Some(range) => format!("; {range}"),
    };
    let symbol = key
        .symbol()
        .map(|symbol| format!("{symbol}: "))
        .unwrap_or_default();
    format!("{symbol}{}{units}{range}", key.summary())
}
