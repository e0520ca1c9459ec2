//! Initial data of the page.

use crate::request::{
    FARTHEST, GivenFile, LATTICES, LENSES, MOST_PILLARS, Values, is_on_page, is_thickness,
    of_any_case, of_case, table_of,
};
use crate::surface;
use fakir_case::table_text::read_packed;
use fakir_case::{AnyCase, Case, CaseError, Key, Kind, Setting};
use serde_json::{Value, json};
use std::io;
use std::ops::Bound;
use std::path::Path;

/// Largest table of pillars, bytes: every request of the page contains it, a third longer, and the server accepts one megabyte.
const LARGEST_TABLE: u64 = 700_000;

/// Reason why the page cannot start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// A `[surface]` that cannot be read, or that the page does not show.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// A table of pillars that cannot be read, or is too large.
    #[error(
        "pattern.pillars: {path}: {error}; the page takes tables of at most {LARGEST_TABLE} bytes, fakir transition and fakir press any other"
    )]
    Table {
        /// The file.
        path: String,
        /// Reason given by the system.
        error: io::Error,
    },
}

/// Initial data of the page: the case, the paper's intermediate case, the properties of all keys from the key table, and
/// limits.
///
/// # Errors
/// [`StartError`] for a `[surface]` that the page does not show, and for files that cannot be read.
pub fn start(case: &AnyCase, memory_limit: usize) -> Result<String, StartError> {
    let surface = match case {
        AnyCase::HeightMap(file) => Some(surface::First::of(file, memory_limit)?),
        _ => None,
    };
    let colours: Vec<[u8; 3]> = (0..=255u32)
        .map(|k| {
            let colorous::Color { r, g, b } =
                colorous::VIRIDIS.eval_continuous(f64::from(k) / 255.0);
            [r, g, b]
        })
        .collect();
    let mut values = of_any_case(case);
    let table = first_table(case)?.map(|(file, of_table)| {
        values.extend(of_table);
        file
    });
    let start = json!({
        "version": fakir_study::VERSION,
        "case": values,
        "surface": surface,
        "table": table,
        "paper": of_case(&Case::example()),
        "keys": keys(),
        "colours": colours,
        "most_pillars": MOST_PILLARS,
        "farthest_load": FARTHEST,
    });
    Ok(start.to_string())
}

/// The table of pillars of a case, and the values that name it; none on a lattice.
fn first_table(case: &AnyCase) -> Result<Option<(GivenFile, Values)>, StartError> {
    let setting = |key: Key| match case {
        AnyCase::Pillars(case) => case.setting(key),
        AnyCase::Asperities(case) => case.setting(key),
        AnyCase::HeightMap(_) | AnyCase::Flat(_) => None,
    };
    let Some(path) = table_of(setting(Key::Pillars)) else {
        return Ok(None);
    };
    let contents = match read_packed(Path::new(&path), LARGEST_TABLE) {
        Ok(contents) => contents,
        Err(error) => return Err(StartError::Table { path, error }),
    };
    let name = Path::new(&path).file_name().unwrap_or_default();
    let file = GivenFile::new(name.to_string_lossy().into_owned(), &contents);
    let word = |word: &str| Setting::Word(word.to_owned());
    // Without an axis the page takes the pillar nearest to the middle, as for a table that is dropped on it.
    let axis = |key: Key| setting(key).unwrap_or(Setting::Number(0.0));
    let values = [
        (Key::Lattice, word("listed")),
        (Key::Pillars, word(&file.name)),
        (Key::AxisX, axis(Key::AxisX)),
        (Key::AxisY, axis(Key::AxisY)),
    ];
    let given = values.map(|(key, value)| (key.path().to_owned(), value));
    let given = given.into_iter().collect();
    Ok(Some((file, given)))
}

/// Properties of each key on the page, from the key table: name and symbol, kind, words, bounds and default, and
/// the word of another key that it requires. The controls of the page are generated from them.
fn keys() -> Vec<Value> {
    let of_page = Key::ALL.into_iter();
    let of_page = of_page.filter(|key| is_on_page(*key));
    let bound = |bound| match bound {
        Bound::Included(value) | Bound::Excluded(value) => Some(value),
        Bound::Unbounded => None,
    };
    of_page
        .map(|key| {
            let (lower, upper) = key.bounds();
            json!({
                "key": key.path(),
                "table": key.table(),
                "label": key.label(),
                "symbol": key.symbol(),
                "meaning": key.summary(),
                "dimension": match key.kind() {
                    Kind::Number(dimension) | Kind::List(dimension) => Some(dimension.noun()),
                    Kind::Word | Kind::Text => None,
                },
                "text": key.kind() == Kind::Text,
                "list": matches!(key.kind(), Kind::List(_)),
                "least": bound(lower),
                "greatest": bound(upper),
                "usual": key.usual().or(usual_of_page(key)),
                "whole": key.is_whole(),
                "infinite": match key {
                    Key::TopRadius => Some("flat"),
                    _ => is_thickness(key).then_some("infinite"),
                },
                "on_flat": key.is_on_flat(),
                "words": words(key),
                "default": key.default(),
                "alternative": key.alternative().map(Key::path),
                "goes_with": key
                    .choices()
                    .find(|(choice, _)| is_on_page(*choice))
                    .map(|(choice, words)| json!({ "key": choice.path(), "words": words })),
            })
        })
        .collect()
}

/// Ends of the sliders of relaxing bodies with one term: from a small relaxation to glassy rubber, and from what an instrument resolves to days. Those
/// of the radius of rounded tops: from pointed to nearly flat ones.
fn usual_of_page(key: Key) -> Option<[f64; 2]> {
    match key {
        Key::RelaxationStrengths => Some([0.01, 100.0]),
        Key::RelaxationTimes => Some([1e-3, 1e5]),
        Key::TopRadius => Some([1e-6, 1e-3]),
        _ => None,
    }
}

/// Words of a key that the page supports.
fn words(key: Key) -> Vec<&'static str> {
    let all = key.words().into_iter();
    all.filter(|word| match key {
        Key::Lattice => LATTICES.contains(word),
        Key::LensShape => LENSES.contains(word),
        _ => true,
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The initial data contain the case and the properties of its controls from the key table.
    #[test]
    fn the_page_starts_with_the_case_and_its_keys() {
        let start: Value =
            serde_json::from_str(&start(&AnyCase::Pillars(Box::new(Case::example())), 0).unwrap())
                .unwrap();
        assert_eq!(start["case"]["lens.radius"], 2.2e-3);
        assert_eq!(start["case"]["method.name"], "spectral");
        assert_eq!(start["case"].get("pattern.pitch"), None);
        let keys = start["keys"].as_array().unwrap();
        let key = |path: &str| keys.iter().find(|key| key["key"] == path).unwrap();
        let ratio = key("substrate.poisson_ratio");
        assert_eq!(
            (&ratio["least"], &ratio["greatest"]),
            (&json!(0.0), &json!(0.5))
        );
        let radius = key("lens.radius");
        assert_eq!(radius["dimension"], "length");
        assert_eq!(
            (&radius["label"], &radius["symbol"]),
            (&json!("radius"), &json!("R"))
        );
        assert_eq!(radius["usual"], json!([1e-5, 0.1]));
        assert_eq!(ratio["usual"], json!([0.0, 0.5]));
        assert_eq!(key("pattern.surface_fraction")["label"], "surface fraction");
        assert_eq!(key("method.cells_per_diameter")["whole"], true);
        assert_eq!(key("substrate.thickness")["infinite"], "infinite");
        assert_eq!(key("pattern.top_radius")["infinite"], "flat");
        assert_eq!(radius["infinite"], Value::Null);
        assert_eq!(start["paper"]["substrate.young_modulus"], 2e6);
        assert_eq!(key("lens.radius")["goes_with"]["key"], "lens.shape");
        assert_eq!(key("lens.young_modulus")["goes_with"], Value::Null);
        let form = key("method.form");
        assert_eq!(form["words"], json!(["corrected", "plain"]));
        assert_eq!(form["default"], "corrected");
        assert_eq!(form["goes_with"]["words"], json!(["punch"]));
        assert_eq!(
            key("pattern.pitch")["alternative"],
            "pattern.surface_fraction"
        );
        for path in start["case"].as_object().unwrap().keys() {
            key(path);
        }
    }

    /// A table of pillars that a case names is part of the initial data, as every request contains it.
    #[test]
    fn the_page_starts_with_the_table_of_the_case() {
        let folder = tempfile::tempdir().unwrap();
        let table = "x_m,y_m\n0,0\n3e-5,0\n0,3e-5\n";
        std::fs::write(folder.path().join("pillars.csv"), table).unwrap();
        let of_pillars = [(Key::PillarDiameter, "6 um"), (Key::PillarHeight, "2.2 um")];
        for rounded in [false, true] {
            let mut text =
                "[lens]\nradius = \"2.2 mm\"\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n\
                [substrate]\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.5\n\
                [pattern]\nlattice = \"listed\"\npillars = \"pillars.csv\"\naxis_x = \"1 um\"\n"
                    .to_owned();
            for (key, value) in of_pillars {
                text += &format!(
                    "{} = \"{value}\"\n",
                    key.path().trim_start_matches("pattern.")
                );
            }
            if rounded {
                text += "top_radius = \"10 um\"\n";
            }
            let path = folder.path().join("case.toml");
            std::fs::write(&path, text).unwrap();
            let file = fakir_case::CaseFile::read(&path).unwrap();
            let case = file.any_case(&[fakir::problem::Question::Explore]).unwrap();
            let start: Value = serde_json::from_str(&start(&case, 0).unwrap()).unwrap();
            assert_eq!(start["table"]["name"], "pillars.csv", "{rounded}");
            assert_eq!(start["case"]["pattern.pillars"], "pillars.csv");
            assert_eq!(start["case"]["pattern.lattice"], "listed");
            assert_eq!(start["case"]["pattern.axis_x"], 1e-6);
            // What the page sends back is the same case.
            let values: Values = serde_json::from_value(start["case"].clone()).unwrap();
            let given: GivenFile = serde_json::from_value(start["table"].clone()).unwrap();
            let sent = crate::request::any_case(&values, Some(&given)).unwrap();
            assert_eq!(sent.number(Key::AxisX), Some(1e-6));
            assert_eq!(
                sent.number(Key::PillarHeight),
                case.number(Key::PillarHeight)
            );
        }
    }
}
