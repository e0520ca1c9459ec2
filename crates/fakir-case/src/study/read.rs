//! Reading the tables `[study]` and `[axes]`.

use super::asked::{Asked, Combine};
use super::axis::{Axis, PointSpacing, Range, Unnamed, Values, Variable};
use super::file::{FixedNumber, MAXIMUM_CASES, StudyFile, Varied};
use crate::entries::{
    Entries, Entry, NAME_IN_QUOTES, STUDY_TABLES, Value, both_given, document, in_order, kind_name,
    one_of, plain_value,
};
use crate::error::{CaseError, Place, Source};
use crate::file::{CaseFile, Measured, not_utf8, quantity};
use crate::input::{self, LARGEST_STUDY};
use crate::key::{Key, Kind, is_table, join, names_in, nearest, present};
use crate::parts::Words;
use crate::unit::{Dimension, format_quantity, with_article};
use fakir::problem::LoadingMode;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

const AXES_EXAMPLE: &str = "for example \"pattern.offset\" = [0, 0.5], or pitch = { from = \"10 um\", to = \"40 um\", points = 5 }";

type Item<'a, 'i> = (std::ops::Range<usize>, &'a Spanned<DeValue<'i>>);

impl StudyFile {
    /// Reads a file, and the case file that it names.
    ///
    /// # Errors
    /// [`CaseError`] if a file cannot be read, is not UTF-8 or TOML, or contains an unknown key,
    /// and for invalid axes. [`study`](Self::study) checks the cases.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        let name = path.display().to_string();
        let bytes = input::read(path, LARGEST_STUDY).map_err(|error| {
            CaseError::new(
                &Source::new(&name, ""),
                format!("cannot read {name}: {error}"),
            )
        })?;
        let text = String::from_utf8(bytes).map_err(|error| not_utf8(&name, &error))?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Self::of_text(&name, &text, &folder)
    }

    /// Reads the contents of a file; `name` is its name in errors. A case file that it names is
    /// searched for in the current folder.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn from_bytes(name: &str, bytes: Vec<u8>) -> Result<Self, CaseError> {
        match String::from_utf8(bytes) {
            Ok(text) => Self::parse(name, &text),
            Err(error) => Err(not_utf8(name, &error)),
        }
    }

    /// Reads a text, as [`from_bytes`](Self::from_bytes).
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(name: &str, text: &str) -> Result<Self, CaseError> {
        Self::of_text(name, text, Path::new(""))
    }

    fn of_text(name: &str, text: &str, folder: &Path) -> Result<Self, CaseError> {
        let source = Source::new(name, text);
        if text.trim().is_empty() {
            return Err(CaseError::new(&source, format!("{name} is empty"))
                .accepted("a study file is a case file with a table [axes]"));
        }
        read(&source, folder)
    }
}

fn read(source: &Source, folder: &Path) -> Result<StudyFile, CaseError> {
    let reader = Reader {
        source,
        folder,
        surface: false,
    };
    let document = document(source)?;
    let document = document.get_ref();
    let known = [&STUDY_TABLES[..], &names_in("")].concat();
    for (name, _) in in_order(document) {
        let path = name.get_ref();
        if !known.contains(&&*present(path)) {
            return Err(reader.unknown(name.span(), path, path, &known, "a study"));
        }
    }
    let settings = match document.get("study") {
        Some(value) => reader.settings(value)?,
        None => Settings::default(),
    };
    let entries = Entries::beside_study(source, document)?;
    let mut case = match settings.case {
        None => CaseFile {
            source: source.clone(),
            entries,
            folder: folder.to_owned(),
            pillars: None,
            table: None,
            profile: None,
        },
        Some((name, place)) => {
            if let Some((name, _)) = beside(document) {
                return Err(both_given_tables(&place, reader.place(name)));
            }
            named_case(folder, &name, &place)?
        }
    };
    let reader = Reader {
        surface: case.is_surface(),
        ..reader
    };
    let varied = reader.axes(document)?;
    for Varied { axis, name, .. } in &varied {
        let written = &source.text()[name.span.clone()];
        if let (Variable::Key(key), Some(former)) = (axis.variable, axis.variable.former_name())
            && written.contains(former)
        {
            case.entries.former.insert(key);
        }
    }
    if let Some(axes) = document.get("axes") {
        let axes = in_order(reader.table("axes", axes)?);
        let mut names = axes.iter().map(|(name, _)| name.get_ref());
        case.entries.former_table |= names.any(|name| present(name) != *name);
    }
    let file = StudyFile {
        source: source.clone(),
        case,
        asked: settings.asked,
        combine: settings.combine,
        load: settings.load,
        drive: settings.driven.drive(settings.asked)?,
        ramp: settings.ramp,
        hold_time: settings.hold_time,
        varied,
    };
    file.check_load(settings.question.as_ref())?;
    file.check_times(settings.question.as_ref())?;
    Ok(file)
}

fn beside<'a, 'i>(document: &'a DeTable<'i>) -> Option<Item<'a, 'i>> {
    in_order(document)
        .into_iter()
        .find(|(name, _)| !STUDY_TABLES.contains(&name.get_ref().as_ref()))
        .map(|(name, value)| (name.span(), value))
}

fn both_given_tables(named: &Place, table: Place) -> CaseError {
    CaseError::at(named, "a case is named, and the file has tables of one too")
        .key("study.case")
        .label(table.span, "of a case")
        .accepted("give one of them; --set overrides keys of the case that is named")
}

fn named_case(folder: &Path, name: &str, place: &Place) -> Result<CaseFile, CaseError> {
    let path = folder.join(name);
    if !path.is_file() {
        return Err(
            CaseError::at(place, format!("there is no file {}", path.display()))
                .key("study.case")
                .accepted("name a case file, from the folder of the study"),
        );
    }
    CaseFile::read(&path)
}

/// What `[study]` sets.
#[derive(Default)]
struct Settings {
    asked: Asked,
    /// Position of the question.
    question: Option<Place>,
    combine: Combine,
    load: Option<FixedNumber>,
    driven: Driven,
    ramp: Option<FixedNumber>,
    hold_time: Option<FixedNumber>,
    case: Option<(String, Place)>,
}

/// Loading mode of a cycle, as given.
#[derive(Default)]
struct Driven {
    name: Option<(LoadingModeName, Place)>,
    /// Stiffness, N/m.
    stiffness: Option<(f64, Place)>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum LoadingModeName {
    Displacement,
    Force,
    Machine,
}

impl Words for LoadingModeName {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("displacement", Self::Displacement),
        ("force", Self::Force),
        ("machine", Self::Machine),
    ];
}

impl Driven {
    fn drive(self, asked: Asked) -> Result<LoadingMode, CaseError> {
        const DRIVE: &str = "study.drive";
        const STIFFNESS: &str = "study.machine_stiffness";
        let of_cycles = |place: &Place, path: &str| {
            CaseError::at(place, "only a cycle has a drive")
                .key(path)
                .accepted("leave it out, or question = \"cycle\" in [study]")
        };
        let places = [
            (self.name.as_ref().map(|(_, place)| place), DRIVE),
            (self.stiffness.as_ref().map(|(_, place)| place), STIFFNESS),
        ];
        for (place, path) in places {
            if let (Some(place), true) = (place, asked != Asked::Cycle) {
                return Err(of_cycles(place, path));
            }
        }
        match (self.name, self.stiffness) {
            (None | Some((LoadingModeName::Displacement, _)), None) => {
                Ok(LoadingMode::Displacement)
            }
            (Some((LoadingModeName::Force, _)), None) => Ok(LoadingMode::Force),
            (Some((LoadingModeName::Machine, _)), Some((stiffness, _))) => {
                Ok(LoadingMode::Machine(stiffness))
            }
            (Some((LoadingModeName::Machine, place)), None) => {
                Err(CaseError::at(&place, "a machine has a stiffness")
                    .key(DRIVE)
                    .accepted("give machine_stiffness = \"100 N/m\" too"))
            }
            (_, Some((_, place))) => Err(CaseError::at(&place, "only a machine has a stiffness")
                .key(STIFFNESS)
                .accepted("leave it out, or drive = \"machine\"")),
        }
    }
}

struct Reader<'s> {
    source: &'s Source,
    /// Folder of files that axes name.
    folder: &'s Path,
    /// Whether the case has a general surface.
    surface: bool,
}

impl Reader<'_> {
    fn place(&self, span: std::ops::Range<usize>) -> Place {
        Place {
            source: self.source.clone(),
            span,
        }
    }

    fn entry(&self, value: &Spanned<DeValue<'_>>) -> Entry {
        Entry {
            value: plain_value(value.get_ref()),
            place: self.place(value.span()),
        }
    }

    fn table<'a, 'i>(
        &self,
        path: &str,
        value: &'a Spanned<DeValue<'i>>,
    ) -> Result<&'a DeTable<'i>, CaseError> {
        match value.get_ref() {
            DeValue::Table(table) => Ok(table),
            other => Err(CaseError::at(
                &self.place(value.span()),
                format!("this is a table, found {}", with_article(other.type_str())),
            )
            .key(path)
            .accepted(match path {
                "axes" => format!("[axes] lists what is varied: {AXES_EXAMPLE}"),
                _ => {
                    "[study] may have question, combine, case, a load, times and a drive".to_owned()
                }
            })),
        }
    }

    fn settings(&self, value: &Spanned<DeValue<'_>>) -> Result<Settings, CaseError> {
        const KEYS: [&str; 11] = [
            "question",
            "combine",
            "case",
            "indentation",
            "force",
            "ramp_time",
            "indentation_rate",
            "force_rate",
            "hold_time",
            "drive",
            "machine_stiffness",
        ];
        let mut settings = Settings::default();
        for (name, value) in in_order(self.table("study", value)?) {
            let path = join("study", name.get_ref());
            let entry = self.entry(value);
            match name.get_ref().as_ref() {
                "question" => {
                    settings.asked = word(&path, &entry)?;
                    settings.question = Some(entry.place);
                }
                "combine" => settings.combine = word(&path, &entry)?,
                "drive" => settings.driven.name = Some((word(&path, &entry)?, entry.place)),
                "machine_stiffness" => {
                    let measured = Measured::of(&path, Dimension::Stiffness);
                    let stiffness = quantity(&measured, &entry)?;
                    if !(stiffness > 0.0 && stiffness.is_finite()) {
                        let written = format_quantity(stiffness, Dimension::Stiffness);
                        return Err(CaseError::at(&entry.place, format!("cannot be {written}"))
                            .key(&path)
                            .accepted("it must be a finite number greater than 0"));
                    }
                    settings.driven.stiffness = Some((stiffness, entry.place));
                }
                "case" => match entry.value {
                    Value::Text(text) => settings.case = Some((text, entry.place)),
                    other => {
                        let problem =
                            format!("expected the name of a file, found {}", kind_name(&other));
                        return Err(CaseError::at(&entry.place, problem)
                            .key(&path)
                            .accepted(NAME_IN_QUOTES));
                    }
                },
                "hold_time" => {
                    settings.hold_time = Some(FixedNumber::read(Variable::HoldTime, entry)?);
                }
                ramp @ ("ramp_time" | "indentation_rate" | "force_rate") => {
                    let variable = match ramp {
                        "indentation_rate" => Variable::IndentationRate,
                        "force_rate" => Variable::ForceRate,
                        _ => Variable::RampTime,
                    };
                    let fixed = FixedNumber::read(variable, entry)?;
                    if let Some(first) = settings.ramp.replace(fixed) {
                        let second = self.place(value.span());
                        let [a, b] = [(first.variable.path(), &first.place), (ramp, &second)];
                        return Err(both_given(a, b, "study")
                            .accepted("give a ramp by its duration or by its rate"));
                    }
                }
                load @ ("indentation" | "force") => {
                    let variable = match load {
                        "force" => Variable::Force,
                        _ => Variable::Indentation,
                    };
                    if let Some(first) = &settings.load {
                        let (a, b) = (("indentation", &first.place), ("force", &entry.place));
                        return Err(both_given(a, b, "study").accepted("give only one"));
                    }
                    settings.load = Some(FixedNumber::read(variable, entry)?);
                }
                other => {
                    return Err(self.unknown(name.span(), &path, other, &KEYS, "[study]"));
                }
            }
        }
        Ok(settings)
    }

    fn unknown(
        &self,
        span: std::ops::Range<usize>,
        path: &str,
        name: &str,
        known: &[&str],
        place: &str,
    ) -> CaseError {
        let list = format!("known in {place}: {}", known.join(", "));
        CaseError::at(&self.place(span), "unknown key")
            .key(path)
            .accepted(match nearest(name, known) {
                Some(near) => format!("did you mean {near}? {list}"),
                None => list,
            })
    }

    fn axes(&self, document: &DeTable<'_>) -> Result<Vec<Varied>, CaseError> {
        let Some((header, value)) = document.get_key_value("axes") else {
            return Err(CaseError::new(
                self.source,
                format!("{} has no table [axes]", self.source.name()),
            )
            .accepted(format!("[axes] lists what a study varies: {AXES_EXAMPLE}")));
        };
        let mut varied = Vec::new();
        self.collect("", self.table("axes", value)?, &mut varied)?;
        // Entries with dotted names need not be adjacent.
        varied.sort_by_key(|axis| axis.name.span.start);
        if varied.is_empty() {
            return Err(
                CaseError::at(&self.place(header.span()), "there are no axes")
                    .key("axes")
                    .accepted(AXES_EXAMPLE),
            );
        }
        refuse_duplicates(&varied)?;
        Ok(varied)
    }

    /// Axes of a table at `path` inside the table of the axes: names with dots are nested tables.
    fn collect(
        &self,
        path: &str,
        table: &DeTable<'_>,
        varied: &mut Vec<Varied>,
    ) -> Result<(), CaseError> {
        for (name, value) in in_order(table) {
            let path = join(path, name.get_ref());
            match value.get_ref() {
                DeValue::Table(inner) if is_table(&present(&path)) => {
                    self.collect(&path, inner, varied)?;
                }
                _ => varied.push(self.axis(&path, name.span(), value)?),
            }
        }
        Ok(())
    }

    fn axis(
        &self,
        name: &str,
        span: std::ops::Range<usize>,
        value: &Spanned<DeValue<'_>>,
    ) -> Result<Varied, CaseError> {
        let place = self.place(span);
        let named = Variable::named(name, self.surface);
        let variable = named.map_err(|why| not_a_variable(&place, name, why))?;
        let path = variable.path();
        let (mut values, items) = match value.get_ref() {
            DeValue::Array(items) => self.list(path, variable, value.span(), items)?,
            DeValue::Table(table) => {
                let range = self.range(path, variable, value.span(), table)?;
                (Values::Range(range), vec![self.place(value.span())])
            }
            other => {
                let found = with_article(other.type_str());
                return Err(CaseError::at(
                    &self.place(value.span()),
                    format!("expected a list or a range of values, found {found}"),
                )
                .key(path)
                .accepted(AXES_EXAMPLE));
            }
        };
        if let (Variable::Key(Key::HeightMap), Values::Words(names)) = (variable, &mut values) {
            // Paths must also be valid for a study that is written elsewhere, as in a journal.
            for name in names {
                let path = self.folder.join(&*name);
                let path = std::path::absolute(&path).unwrap_or(path);
                *name = path.to_string_lossy().into_owned();
            }
        }
        Ok(Varied {
            axis: Axis { variable, values },
            name: place,
            items,
        })
    }

    fn list<'a, 'i: 'a>(
        &self,
        path: &str,
        variable: Variable,
        span: std::ops::Range<usize>,
        items: impl IntoIterator<Item = &'a Spanned<DeValue<'i>>>,
    ) -> Result<(Values, Vec<Place>), CaseError> {
        let entries: Vec<Entry> = items.into_iter().map(|item| self.entry(item)).collect();
        if entries.is_empty() {
            return Err(CaseError::at(&self.place(span), "the list is empty")
                .key(path)
                .accepted("give at least one value, or leave the axis out"));
        }
        let values = match variable.dimension() {
            Some(_) => {
                let measured = variable.measured();
                let numbers = entries.iter().map(|entry| quantity(&measured, entry));
                Values::Numbers(numbers.collect::<Result<_, _>>()?)
            }
            None => Values::Words(
                entries
                    .iter()
                    .map(|entry| match (variable, &entry.value) {
                        (Variable::Key(key), Value::List(items))
                            if matches!(key.kind(), Kind::List(_)) =>
                        {
                            list_in_words(path, entry, items)
                        }
                        _ => text(path, entry),
                    })
                    .collect::<Result<_, _>>()?,
            ),
        };
        Ok((
            values,
            entries.into_iter().map(|entry| entry.place).collect(),
        ))
    }

    fn range(
        &self,
        path: &str,
        variable: Variable,
        span: std::ops::Range<usize>,
        table: &DeTable<'_>,
    ) -> Result<Range, CaseError> {
        const KEYS: [&str; 4] = ["from", "to", "points", "spacing"];
        for (name, _) in in_order(table) {
            if !KEYS.contains(&name.get_ref().as_ref()) {
                let name_path = join(path, name.get_ref());
                return Err(self.unknown(
                    name.span(),
                    &name_path,
                    name.get_ref(),
                    &KEYS,
                    "a range",
                ));
            }
        }
        let Some(dimension) = variable.dimension() else {
            return Err(CaseError::at(&self.place(span), "words have no range")
                .key(path)
                .accepted("give a list of words in quotes"));
        };
        let needed = |name: &str| {
            table
                .get(name)
                .map(|value| self.entry(value))
                .ok_or_else(|| {
                    CaseError::at(
                        &self.place(span.clone()),
                        format!("`{name}` is missing in this range"),
                    )
                    .key(path)
                    .accepted("a range has from, to and points, and may have spacing = \"log\"")
                })
        };
        let (from, to, points) = (needed("from")?, needed("to")?, needed("points")?);
        let spacing = match table.get("spacing") {
            Some(value) => word(path, &self.entry(value))?,
            None => PointSpacing::Linear,
        };
        let measured = variable.measured();
        let range = Range {
            from: finite(&measured, &from)?,
            to: finite(&measured, &to)?,
            points: number_of_points(path, &points)?,
            spacing,
        };
        check_order(path, dimension, &range, &from.place, &to.place)?;
        Ok(range)
    }
}

fn not_a_variable(place: &Place, name: &str, why: Unnamed) -> CaseError {
    let (problem, accepted) = match why {
        Unnamed::Unknown(similar) => (
            format!("\"{name}\" is no key of a case"),
            match similar {
                Some(meant) => format!("did you mean {meant}?"),
                None => "an axis is named by a key, as in \"pattern.pillar.height\" or height, or \
                         by indentation or force"
                    .to_owned(),
            },
        ),
        Unnamed::Ambiguous(variables) => {
            let paths: Vec<_> = variables
                .iter()
                .map(|variable| format!("\"{}\"", variable.path()))
                .collect();
            (
                format!("\"{name}\" may be one of several keys"),
                format!("give {}", paths.join(" or ")),
            )
        }
        Unnamed::OfTheOther { surface: true } => (
            "the case has a [surface], and this is no key of one".to_owned(),
            "a case with a [surface] has axes over keys of lens, substrate and surface, and over loads"
                .to_owned(),
        ),
        Unnamed::OfTheOther { surface: false } => (
            "the case has no [surface]".to_owned(),
            "a case with a [pattern] has axes over keys of lens, substrate, pattern and method, and \
             over loads"
                .to_owned(),
        ),
    };
    CaseError::at(place, problem).key("axes").accepted(accepted)
}

fn refuse_duplicates(varied: &[Varied]) -> Result<(), CaseError> {
    for (index, later) in varied.iter().enumerate() {
        let variable = later.axis.variable;
        let clash = varied[..index].iter().find(|earlier| {
            earlier.axis.variable == variable
                || variable.alternative() == Some(earlier.axis.variable)
        });
        let Some(earlier) = clash else {
            continue;
        };
        let problem = if earlier.axis.variable == variable {
            format!("{} is an axis twice", variable.path())
        } else {
            let other = earlier.axis.variable;
            format!("{} and {} are both axes", other.path(), variable.path())
        };
        return Err(CaseError::at(&later.name, problem)
            .key("axes")
            .label(earlier.name.span.clone(), "and here")
            .accepted("give only one of them"));
    }
    Ok(())
}

/// The values of a key that takes a list, as on the command line: `10 s, 30 s`.
fn list_in_words(path: &str, entry: &Entry, items: &[Value]) -> Result<String, CaseError> {
    let words = items.iter().map(|item| match item {
        Value::Text(text) => Ok(text.clone()),
        Value::Number(number) => Ok(number.to_string()),
        other => Err(CaseError::at(
            &entry.place,
            format!(
                "expected a list of values, found {} in it",
                kind_name(other)
            ),
        )
        .key(path)
        .accepted("give a list for every case, as [[1.0], [0.5, 0.5]]")),
    });
    Ok(words.collect::<Result<Vec<_>, _>>()?.join(", "))
}

fn text(path: &str, entry: &Entry) -> Result<String, CaseError> {
    match &entry.value {
        Value::Text(text) => Ok(text.clone()),
        Value::Flag(flag) => Ok(flag.to_string()),
        other => Err(CaseError::at(
            &entry.place,
            format!("expected a word, found {}", kind_name(other)),
        )
        .key(path)
        .accepted("give words in quotes")),
    }
}

fn word<T: Words>(path: &str, entry: &Entry) -> Result<T, CaseError> {
    let problem = match &entry.value {
        Value::Text(text) => match T::named(text) {
            Some(value) => return Ok(value),
            None => format!("\"{text}\" is not known"),
        },
        other => format!("expected a word, found {}", kind_name(other)),
    };
    Err(CaseError::at(&entry.place, problem)
        .key(path)
        .accepted(one_of(&T::all())))
}

fn finite(measured: &Measured, entry: &Entry) -> Result<f64, CaseError> {
    let value = quantity(measured, entry)?;
    if value.is_finite() {
        return Ok(value);
    }
    Err(CaseError::at(&entry.place, format!("cannot be {value}"))
        .key(&measured.path)
        .accepted("a range has finite ends"))
}

fn number_of_points(path: &str, entry: &Entry) -> Result<usize, CaseError> {
    let points = quantity(&Measured::of(path, Dimension::Number), entry)?;
    if points.fract() == 0.0 && (2.0..=MAXIMUM_CASES as f64).contains(&points) {
        return Ok(points as usize);
    }
    Err(
        CaseError::at(&entry.place, format!("points cannot be {points}"))
            .key(path)
            .accepted(format!(
                "give a whole number from 2, for both ends, to {MAXIMUM_CASES}; a list can have a \
                 single value"
            )),
    )
}

fn check_order(
    path: &str,
    dimension: Dimension,
    range: &Range,
    from: &Place,
    to: &Place,
) -> Result<(), CaseError> {
    let written = |value| format_quantity(value, dimension);
    if range.from >= range.to {
        let problem = format!(
            "the range does not go up: from {} to {}",
            written(range.from),
            written(range.to)
        );
        return Err(CaseError::at(to, problem)
            .key(path)
            .label(from.span.clone(), "from here")
            .accepted("`to` is greater than `from`"));
    }
    if range.spacing == PointSpacing::Log && range.from <= 0.0 {
        let problem = format!(
            "a range of equal ratios cannot begin at {}",
            written(range.from)
        );
        return Err(CaseError::at(from, problem)
            .key(path)
            .accepted("give a start greater than 0, or spacing = \"linear\""));
    }
    Ok(())
}
