//! The key table: its statements are correct.

// Bounds are exact.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use fakir_case::unit::Dimension;
use fakir_case::{Case, CaseError, CaseFile, Key, Kind, Setting, StudyFile};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::ops::Bound;

/// Memory limit of the surfaces, bytes.
const MEMORY: usize = 100_000_000;

const BODIES: &str = "lens = { radius = 1e-3, young_modulus = 2e6, poisson_ratio = 0.5 }
substrate = { young_modulus = 2e6, poisson_ratio = 0.5 }
";

/// A case that has this key or accepts it.
fn case_for(key: Key) -> CaseFile {
    let of_height_maps = [
        Key::HeightUnit,
        Key::HeightRange,
        Key::CellSize,
        Key::MapWidth,
    ];
    let surface = if !key.table().starts_with("surface") {
        return CaseFile::parse("case.toml", &Case::example().to_toml()).unwrap();
    } else if of_height_maps.contains(&key) {
        "surface = { height_map = 'tests/height_maps/savetxt.txt', cell_size = 1e-6 }"
    } else {
        "surface = { arrangement = 'hexagonal', surface_fraction = 0.2, \
         pillar = { diameter = 6e-6, height = 1e-6 }, grid = { width = 5e-5 } }"
    };
    CaseFile::parse("case.toml", &format!("{BODIES}{surface}")).unwrap()
}

/// The error for this value of a key, if the value is invalid.
fn refusal(key: Key, value: f64) -> Option<CaseError> {
    let mut file = case_for(key);
    if key == Key::RecedingWorkOfAdhesion {
        file.set_number(Key::WorkOfAdhesion, 1e-3);
    }
    // The example does not name the shape of the lens.
    if let Some((choice, words)) = key.goes_with().filter(|_| key != Key::LensRadius) {
        file.set(&format!("{choice}={}", words[0])).unwrap();
        if choice == Key::Lattice && !["hexagonal", "listed"].contains(&words[0]) {
            file.set_number(Key::Pitch, 3e-5);
            file.set_number(Key::PitchY, 3e-5);
        }
        let siblings = Key::ALL.into_iter().filter(|other| {
            let goes_with = other.goes_with();
            goes_with.is_some_and(|(own, with)| own == choice && with.contains(&words[0]))
        });
        let of_its_own = |key: &Key| key.alternative().is_none() && choice != Key::Lattice;
        for sibling in siblings.filter(of_its_own) {
            match sibling.kind() {
                Kind::Number(Dimension::Length) if sibling.table() == key.table() => {
                    file.set_number(sibling, 5e-7);
                }
                Kind::Number(Dimension::Number) if sibling.default().is_none() => {
                    file.set_number(sibling, 6.0);
                }
                _ => {}
            }
        }
    }
    let of_layers = Key::ALL.into_iter().filter(|other| {
        let is_on_elastic_base = other.goes_with().is_some();
        let wanted = !is_on_elastic_base || key.goes_with().is_some();
        other.is_of_layers() && wanted && other.table() == key.table()
    });
    for other in of_layers.filter(|_| key.is_of_layers()) {
        match other.kind() {
            Kind::Number(Dimension::Length) => file.set_number(other, 1e-3),
            Kind::Number(Dimension::Pressure) => file.set_number(other, 1e9),
            Kind::Number(_) => file.set_number(other, 0.3),
            Kind::Word | Kind::Text | Kind::List(_) => {}
        }
    }
    file.set_number(key, value);
    let error = if file.is_surface() {
        file.surface_case(MEMORY).err()?
    } else {
        file.case().err()?
    };
    let is_the_value = error.key_path() == Some(key.path());
    (is_the_value && error.problem().starts_with("cannot be")).then_some(error)
}

/// The ranges of the table equal those of the solver and of the patterns, which check most of them.
#[test]
fn bounds_are_as_documented() {
    let mut bounds = 0;
    for key in Key::ALL {
        let Kind::Number(_) = key.kind() else {
            continue;
        };
        assert!(refusal(key, f64::NAN).is_some(), "{key}");
        let (lower, upper) = key.bounds();
        let outside = [
            match lower {
                Bound::Included(lower) => Some((lower, lower.next_down())),
                Bound::Excluded(lower) => Some((f64::NAN, lower)),
                Bound::Unbounded => None,
            },
            match upper {
                Bound::Included(upper) => Some((upper, upper.next_up())),
                Bound::Excluded(upper) => Some((f64::NAN, upper)),
                Bound::Unbounded => None,
            },
        ];
        for (inside, outside) in outside.into_iter().flatten() {
            bounds += 1;
            let error = refusal(key, outside);
            assert!(error.is_some(), "{key} can be {outside:e}");
            assert!(error.unwrap().what_is_accepted().is_some(), "{key}");
            if inside.is_finite() {
                let error = refusal(key, inside).map(|error| error.one_line());
                assert_eq!(error, None, "{key} cannot be {inside:e}");
            }
        }
    }
    assert!(bounds > 30);
}

/// Defaults are a part of what users rely on: a case file written today is the same case later.
#[test]
fn defaults_do_not_change() {
    let written = |key: Key| {
        let value = match key.default()? {
            Setting::Number(value) => format!("{value}"),
            Setting::Word(word) => word,
        };
        Some(format!("{key} = {value}"))
    };
    let found: Vec<String> = Key::ALL.into_iter().filter_map(written).collect();
    let expected = include_str!("defaults.txt");
    assert_eq!(found.join("\n"), expected.trim_end());
}

/// A default is the value of the case if the key is left out.
#[test]
fn defaults_are_as_documented() {
    let example = Case::example();
    for method in ["spectral", "punch", "love", "homogenised"] {
        let mut full = CaseFile::parse("case.toml", &example.to_toml()).unwrap();
        full.set(&format!("{}={method}", Key::MethodName)).unwrap();
        let full = full.case().unwrap();
        for key in Key::ALL {
            let (Some(default), Some(_)) = (key.default(), full.setting(key)) else {
                continue;
            };
            let others = Key::ALL.into_iter().filter(|other| {
                // The keys of a method other than the default one require its name.
                let choice = other.goes_with().map(|(choice, _)| choice);
                *other != key && (choice != Some(key) || key == Key::Lattice)
            });
            let settings = others.filter_map(|other| Some((other, full.setting(other)?)));
            let case = CaseFile::from_settings("without it", settings).case();
            assert_eq!(case.unwrap().setting(key), Some(default), "{key}");
        }
    }
}

#[test]
fn settings_are_not_read_as_text() {
    let settings = |word: &str| {
        let of_example = Key::ALL.into_iter().filter_map(|key| {
            let setting = Case::example().setting(key)?;
            (key != Key::MethodName).then_some((key, setting))
        });
        let word = (Key::MethodName, Setting::Word(word.to_owned()));
        CaseFile::from_settings("settings", of_example.chain([word]))
    };
    assert_eq!(settings("spectral").case().unwrap(), Case::example());
    for text in ["\"\nlens.radius = 1", "\\", "\u{7f}\u{0}", "a\"b", "'''"] {
        let error = settings(text).case().unwrap_err();
        assert_eq!(error.key_path(), Some("method.name"));
        assert_eq!(error.problem(), format!("\"{text}\" is not known"));
    }
    // As in a file, no setting replaces another.
    let both = [(Key::Pitch, Setting::Number(2e-5))];
    let example = Key::ALL
        .into_iter()
        .filter_map(|key| Some((key, Case::example().setting(key)?)));
    let error = CaseFile::from_settings("settings", example.chain(both)).case();
    assert!(error.unwrap_err().problem().contains("are both given"));
}

#[test]
fn the_reference_as_written() {
    let reference = fakir_case::reference();
    for key in Key::ALL {
        assert!(reference.contains(&format!("| `{}` |", key.name())));
    }
    insta::assert_snapshot!(reference);
}

/// SI unit of the numbers of a key; `None` for words, fractions and plain numbers.
fn si_unit(key: Key) -> &'static str {
    match key.dimension() {
        Dimension::Length => "m",
        Dimension::Pressure => "Pa",
        Dimension::Force => "N",
        Dimension::EnergyPerArea => "J/m2",
        Dimension::Stiffness => "N/m",
        Dimension::Angle => "rad",
        Dimension::Time => "s",
        Dimension::Speed => "m/s",
        Dimension::ForceRate => "N/s",
        Dimension::Fraction | Dimension::Number => "",
    }
}

/// A forgotten unit, at every key that has one: refused without it, read with it.
#[test]
fn numbers_without_a_unit_are_plausible_or_refused() {
    let mut judged = 0;
    for key in Key::ALL {
        let Some([least, most]) = key.judged_by().filter(|_| !si_unit(key).is_empty()) else {
            continue;
        };
        judged += 1;
        let (plausible, wrong) = match key.dimension() {
            Dimension::Pressure => ([least, 1e15], 2.0),
            _ => ([0.0, most], 20.0),
        };
        let given = |value: String| {
            let mut file = case_for(key);
            file.set(&format!("{key}={value}")).unwrap();
            file.given(key)
        };
        for value in plausible {
            assert_eq!(given(value.to_string()).unwrap(), Some(value), "{key}");
        }
        let unit = si_unit(key);
        let error = given(wrong.to_string()).unwrap_err();
        let read = format!("{wrong} {unit} (read from `{wrong}`, no unit: SI)");
        assert_eq!(error.key_path(), Some(key.path()));
        assert!(error.problem().ends_with(&read), "{error}");
        let advice = error.what_is_accepted().unwrap();
        assert!(advice.starts_with("did you mean `"), "{key}: {advice}");
        assert_eq!(given(format!("{wrong} {unit}")).unwrap(), Some(wrong));
    }
    assert!(judged > 35, "{judged}");
}

/// A deprecated path is accepted in files, overrides and studies, and a warning names the new one.
#[test]
fn deprecated_names_are_accepted_with_a_warning() {
    let warning = "pattern.height_spread is deprecated: use pattern.height_standard_deviation";
    let example = Case::example().to_toml();
    let with = |line: &str| example.replace("[pattern]\n", &format!("[pattern]\n{line}\n"));
    let parse = |text: &str| CaseFile::parse("case.toml", text).unwrap();
    let new = parse(&with("height_standard_deviation = 0.05"));
    assert!(new.warnings().is_empty());
    let old = parse(&with("height_spread = 0.05"));
    assert_eq!(old.case().unwrap(), new.case().unwrap());
    assert_eq!(old.warnings(), [warning]);
    assert!(!old.case().unwrap().to_toml().contains("height_spread"));
    let mut set = parse(&example);
    set.set("pattern.height_spread = 5 %").unwrap();
    assert_eq!(set.case().unwrap(), new.case().unwrap());
    assert_eq!(set.deprecations(), [warning]);
    for name in ["\"pattern.height_spread\"", "height_spread"] {
        let axis = format!("[axes]\n{name} = [0.05, 0.1]\n{example}");
        let study = StudyFile::parse("study.toml", &axis).unwrap();
        assert_eq!(study.case().deprecations(), [warning]);
        let study = study.study().unwrap();
        assert_eq!(study.case(0).case.pattern(), Some(&new.case().unwrap()));
    }
    let both = with("height_spread = 0.05\nheight_standard_deviation = 0.05");
    let message = CaseFile::parse("case.toml", &both).unwrap_err().one_line();
    assert!(
        message
            .contains("pattern.height_standard_deviation and pattern.height_spread are both given"),
        "{message}"
    );
}

/// The deprecated name of the table of the pillar pattern is accepted in files, overrides and studies, with one warning.
#[test]
fn the_former_table_is_accepted_with_a_warning() {
    let warning = "[texture] is deprecated: use [pattern]"; // former name
    let case = Case::example();
    let text = case.to_toml();
    let former = text.replace("[pattern", "[texture"); // former name
    let read = |text: &str| CaseFile::parse("case.toml", text).unwrap();
    assert_eq!(read(&former).case().unwrap(), case);
    assert_eq!(read(&former).warnings(), [warning]);
    assert!(read(&text).warnings().is_empty());
    for (old, new) in [
        ("texture.pitch=25um", "pattern.pitch=25um"), // former name
        ("texture.pillar.height=2um", "height=2um"),  // former name
    ] {
        let [mut with_old, mut with_new] = [read(&text), read(&text)];
        with_old.set(old).unwrap();
        with_new.set(new).unwrap();
        assert_eq!(with_old.case().unwrap(), with_new.case().unwrap());
        assert_eq!(with_old.warnings(), [warning]);
        assert!(with_new.warnings().is_empty());
    }
    for axis in [
        "\"texture.offset\" = [0, 0.5]",                      // former name
        "texture.offset = [0, 0.5]",                          // former name
        "texture.pillar = { height = [\"2 um\", \"3 um\"] }", // former name
    ] {
        let study = format!("[axes]\n{axis}\n{text}");
        let study = StudyFile::parse("study.toml", &study).unwrap();
        assert_eq!(study.case().deprecations(), [warning]);
        let study = study.study().unwrap();
        let axis = study.axes().next().unwrap();
        assert!(axis.variable().path().starts_with("pattern."));
        assert!(!study.to_toml().contains("texture")); // former name
    }
    let both = format!("{text}\n[texture]\noffset = 0.5\n"); // former name
    let message = CaseFile::parse("case.toml", &both).unwrap_err().one_line();
    let words = "[pattern] and [texture] are both given"; // former name
    assert!(message.contains(words), "{message}");
    assert_eq!(Key::at("texture.missing"), Some(Key::VacancyFraction)); // former name
    assert_eq!(Key::at_former("texture.pitch"), Some(Key::Pitch)); // former name
    assert_eq!(Key::at_former("pattern.pitch"), None);
}

/// The deprecated name of a vacancy fraction is accepted, with its table or without it.
#[test]
fn missing_is_a_former_name_of_the_vacancy_fraction() {
    let square = |line: &str| {
        let text = Case::example().to_toml();
        let lattice = text.replace("\"hexagonal\"", "\"square\"");
        let mut file = CaseFile::parse("case.toml", &lattice).unwrap();
        file.set(line).unwrap();
        file
    };
    let new = square("vacancy_fraction = 10 %");
    assert!(new.warnings().is_empty());
    for line in ["pattern.missing = 10 %", "missing = 10 %"] {
        let old = square(line);
        assert_eq!(old.case().unwrap(), new.case().unwrap());
        let warning = "pattern.missing is deprecated: use pattern.vacancy_fraction";
        assert_eq!(old.warnings(), [warning]);
    }
}

/// A key without effect is named with the reason, unless it has the default value.
#[test]
fn keys_without_effect_are_named() {
    let mut file = CaseFile::parse("case.toml", &Case::example().to_toml()).unwrap();
    assert!(file.warnings().is_empty());
    file.set("pattern.seed=7").unwrap();
    file.set("pattern.offset_angle=10deg").unwrap();
    let message = file.warnings().join("; ");
    assert!(
        message.contains("pattern.offset_angle has no effect: the lens axis is on"),
        "{message}"
    );
    assert!(
        message.contains("pattern.seed has no effect: nothing is random"),
        "{message}"
    );
    file.set("pattern.vacancy_fraction=0.1").unwrap();
    file.set("pattern.offset=0.1").unwrap();
    assert!(file.warnings().is_empty());
}

/// A value that may be valid or not.
fn any_value() -> impl Strategy<Value = Setting> {
    let known: Vec<String> = Key::ALL
        .into_iter()
        .flat_map(Key::words)
        .map(str::to_owned)
        .collect();
    prop_oneof![
        prop::num::f64::ANY.prop_map(Setting::Number),
        (0.0..1.0).prop_map(Setting::Number),
        prop::sample::select(known).prop_map(Setting::Word),
        "[0-9.e+-]{1,5} ?(um|mm|MPa|deg|UM)?".prop_map(Setting::Word),
        any::<String>().prop_map(Setting::Word),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    /// Settings give the same case, or the same refusal, as the same values in a file.
    #[test]
    fn settings_are_taken_as_in_a_file(
        odd in prop::collection::vec((prop::sample::select(Key::ALL.to_vec()), any_value()), 0..4),
        left_out in prop::collection::vec(prop::sample::select(Key::ALL.to_vec()), 0..2),
    ) {
        let example = Case::example();
        let of_example = Key::ALL.into_iter().filter_map(|key| Some((key, example.setting(key)?)));
        let mut settings: BTreeMap<Key, Setting> = of_example.chain(odd).collect();
        settings.retain(|key, _| !left_out.contains(key));
        let lines = settings.iter().map(|(key, setting)| {
            let value = match setting {
                // With its unit: a number without one must be plausible too.
                Setting::Number(number) if !si_unit(*key).is_empty() => {
                    toml::Value::from(format!("{number:e} {}", si_unit(*key)))
                }
                Setting::Number(number) => toml::Value::from(*number),
                Setting::Word(word) => toml::Value::from(word.as_str()),
            };
            format!("{key} = {value}\n")
        });
        let message = |error: CaseError| {
            let texts = [error.key_path(), Some(error.problem()), error.what_is_accepted()];
            texts.map(|text| text.map(str::to_owned))
        };
        // Compared as text, in which NaN equals NaN.
        let answer = |file: CaseFile| match file.case() {
            Ok(case) => Ok(case.to_toml()),
            Err(error) => Err(message(error)),
        };
        let of_file = CaseFile::parse("a case", &lines.collect::<String>()).unwrap();
        let of_settings = CaseFile::from_settings("a case", settings);
        prop_assert_eq!(answer(of_settings), answer(of_file));
    }
}
