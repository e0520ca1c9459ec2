//! What is asked: a case by its keys, and where on the way to the critical state.

use crate::refusal::Refusal;
use fakir::problem::{HexagonalLattice, System};
use fakir::theory::homogenised;
use fakir_case::{Case, CaseFile, Key};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Longest text of a value.
const LONGEST_TEXT: usize = 100;

/// More pillars than this are not solved for: it would take minutes.
pub(crate) const MOST_PILLARS: f64 = 20_000.0;

/// Farthest that a load may go, in critical loads.
pub(crate) const FARTHEST: f64 = 1.5;

/// Which request of which page it is: of the same page and kind only the newest counts.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Ticket {
    pub(crate) session: String,
    pub(crate) sequence: u64,
}

/// The value of a key: a number in SI units, or a word or quantity as in a case file.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
pub(crate) enum Value {
    Number(f64),
    Text(String),
}

/// A case by its keys, as `{"lens.radius": 2.2e-3, ...}`.
pub(crate) type Values = BTreeMap<String, Value>;

/// `POST /api/contact`, and `/api/phase`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct AtLoad {
    pub(crate) ticket: Ticket,
    pub(crate) case: Values,
    #[serde(default)]
    pub(crate) load: LoadPoint,
}

/// `POST /api/curves`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Curves {
    pub(crate) ticket: Ticket,
    pub(crate) case: Values,
}

/// `POST /api/export`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Export {
    pub(crate) ticket: Ticket,
    pub(crate) case: Values,
    #[serde(default)]
    pub(crate) load: LoadPoint,
    pub(crate) file: String,
}

/// Where on the way from first touch to the critical state.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LoadPoint {
    /// 0 at first touch, 1 in the critical state, more beyond it.
    pub(crate) fraction: f64,
    /// The critical indentation, m, where it is known already.
    #[serde(default)]
    pub(crate) critical_indentation_m: Option<f64>,
}

impl Default for LoadPoint {
    fn default() -> Self {
        Self {
            fraction: 1.0,
            critical_indentation_m: None,
        }
    }
}

impl LoadPoint {
    pub(crate) fn is_critical(&self) -> bool {
        (self.fraction - 1.0).abs() < 1e-9
    }

    pub(crate) fn check(&self) -> Result<(), Refusal> {
        if !(0.0..=FARTHEST).contains(&self.fraction) {
            return Err(Refusal::impossible(format!("cannot be {}", self.fraction))
                .at("load.fraction")
                .accepted(format!(
                    "it must be from 0, first touch, to {FARTHEST}; the critical state is at 1"
                )));
        }
        match self.critical_indentation_m {
            Some(value) if !(value > 0.0 && value.is_finite()) => {
                Err(Refusal::impossible(format!("cannot be {value}"))
                    .at("load.critical_indentation_m")
                    .accepted("leave it out, or give a length in m greater than 0"))
            }
            _ => Ok(()),
        }
    }
}

/// The case of some values.
pub(crate) fn case(values: &Values) -> Result<Case, Refusal> {
    let mut text = String::new();
    for (path, value) in values {
        if Key::at(path).is_none() {
            let shown: String = path.chars().take(LONGEST_TEXT).collect();
            return Err(Refusal::impossible("unknown key")
                .at(shown)
                .accepted("the keys of a case file, as in texture.pillar.diameter"));
        }
        let value = match value {
            Value::Number(value) => format!("{value:e}"),
            Value::Text(value) if value.len() > LONGEST_TEXT => {
                return Err(Refusal::impossible("this text is too long")
                    .at(path)
                    .accepted(format!("at most {LONGEST_TEXT} bytes")));
            }
            Value::Text(value) => quoted(value),
        };
        text.push_str(&format!("{path} = {value}\n"));
    }
    let case = CaseFile::parse("the page", &text)?.case()?;
    check_size(&case)?;
    Ok(case)
}

/// A text in TOML.
fn quoted(text: &str) -> String {
    let escaped: String = text
        .chars()
        .map(|c| match c {
            '"' | '\\' => format!("\\{c}"),
            c if c.is_control() => format!("\\u{:04x}", u32::from(c)),
            c => c.to_string(),
        })
        .collect();
    format!("\"{escaped}\"")
}

/// Refuses a texture with more pillars in contact than can be waited for.
fn check_size(case: &Case) -> Result<(), Refusal> {
    let pillars = expected_pillars(&case.system);
    if pillars <= MOST_PILLARS {
        return Ok(());
    }
    let (key, accepted) = match case.value(Key::Pitch) {
        None => {
            let limit = largest_fraction(&case.system, MOST_PILLARS);
            let limit = (limit * 1e3).floor() / 1e3;
            (Key::SurfaceFraction, format!("up to {limit}"))
        }
        Some(_) => {
            let limit = largest_fraction(&case.system, MOST_PILLARS);
            let diameter = case.system.pillar().diameter;
            let pitch = HexagonalLattice::with_surface_fraction(limit, diameter).pitch;
            (Key::Pitch, format!("from {:.4} um", pitch * 1e6))
        }
    };
    Err(Refusal::impossible(format!(
        "about {} pillars would be touched, more than can be solved for while one waits",
        significant(pillars)
    ))
    .at(key.path())
    .accepted(format!(
        "with all else as it is, {accepted}; or lower pillars, a smaller lens, or \
         `fakir transition`, which has no such limit"
    )))
}

/// A number in two digits.
fn significant(value: f64) -> String {
    let size = 10f64.powf(value.abs().log10().floor() - 1.0);
    format!("{}", (value / size).round() * size)
}

/// About how many pillars are touched in the critical state, by the dense limit of the homogenised
/// lattice: 30 % at most off where there are many.
pub(crate) fn expected_pillars(system: &System) -> f64 {
    let radius = homogenised::dense_limit(system).contact_radius();
    // A contact cannot be wider than the lens.
    let radius = radius.min(system.lens().radius);
    let pillars = PI * radius * radius / system.lattice().cell_area();
    if pillars.is_finite() {
        pillars
    } else {
        f64::MAX
    }
}

/// The largest surface fraction with at most so many pillars, by bisection.
pub(crate) fn largest_fraction(system: &System, pillars: f64) -> f64 {
    let (mut low, mut high) = (1e-6_f64, system.texture().surface_fraction());
    for _ in 0..60 {
        let middle = (low * high).sqrt();
        let fits = at_fraction(system, middle).is_some_and(|s| expected_pillars(&s) <= pillars);
        if fits {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The same system at another surface fraction.
pub(crate) fn at_fraction(system: &System, fraction: f64) -> Option<System> {
    let lattice = HexagonalLattice::with_surface_fraction(fraction, system.pillar().diameter);
    let lattice = HexagonalLattice {
        pitch: lattice.pitch,
        ..*system.lattice()
    };
    system.with_lattice(lattice).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(case: &Case) -> Values {
        Key::ALL
            .into_iter()
            .filter_map(|key| {
                let text = case.value(key)?;
                let value = match text.parse() {
                    Ok(number) => Value::Number(number),
                    Err(_) => Value::Text(text.trim_matches('"').to_owned()),
                };
                Some((key.path().to_owned(), value))
            })
            .collect()
    }

    #[test]
    fn the_case_is_that_of_a_case_file_to_the_bit() {
        let example = Case::example();
        assert_eq!(case(&values(&example)).unwrap(), example);
        let mut in_si = values(&example);
        in_si.insert("lens.radius".to_owned(), Value::Number(2.2e-3));
        assert_eq!(case(&in_si).unwrap(), example);
    }

    #[test]
    fn too_many_pillars_are_refused_with_what_is_accepted() {
        let mut dense = values(&Case::example());
        dense.insert("texture.surface_fraction".to_owned(), Value::Number(0.6));
        let refusal = case(&dense).unwrap_err();
        let told = serde_json::to_string(&refusal).unwrap();
        assert!(
            told.contains("\"key\":\"texture.surface_fraction\""),
            "{told}"
        );
        assert!(told.contains("with all else as it is, up to 0."), "{told}");
    }

    #[test]
    fn texts_cannot_break_out_of_their_quotes() {
        for text in ["\"\nlens.radius = 1", "\\", "\u{7f}\u{0}", "a\"b"] {
            let mut odd = values(&Case::example());
            odd.insert("method.name".to_owned(), Value::Text(text.to_owned()));
            let told = serde_json::to_string(&case(&odd).unwrap_err()).unwrap();
            assert!(told.contains("\"key\":\"method.name\""), "{told}");
        }
    }
}
