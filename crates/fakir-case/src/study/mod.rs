//! Study files: a case, and what of it is varied.
//!
//! ```
//! # let case = fakir_case::Case::example().to_toml();
//! let text = r#"
//! [study]
//! question = "transition"       # or "press", with indentation or force given here or as an axis; "cycle" or "collapse"
//! combine = "product"           # every value with every other; or "zip": first with first ...
//!
//! [axes]
//! pitch = { from = "10 um", to = "40 um", points = 5 }    # spacing = "log": at equal ratios
//! "texture.offset" = [0, 0.5]
//! "method.name" = ["spectral", "punch"]
//! "#;
//! let study = fakir_case::StudyFile::parse("study.toml", &format!("{text}{case}"))?.study()?;
//! assert_eq!(study.cases(), 20);
//! let first = study.case(0).case;
//! assert_eq!(first.texture().map(|case| case.system.pitch()), Some(10e-6));
//! # Ok::<(), fakir_case::CaseError>(())
//! ```
//!
//! * The case is in the same file, or `[study]` names its file: `case = "paper-soft.toml"`, sought
//!   next to the study. An axis takes the place of what the case gives.
//! * An axis is named by a [`Key`], in full or by its last name where that says which, or
//!   by `indentation` or `force`. Cases are in the order of the file, the last axis varying fastest.
//! * A case with a general `[surface]` has axes over keys of lens, substrate and surface.
//! * Where `method.name` is an axis, other keys of `[method]` count for the methods that have them.

mod axis;
mod posed;
mod read;

pub use axis::{Axis, Coordinate, Variable};
pub use posed::StudiedCase;

use crate::case::{Case, write_tables};
use crate::entries::{Entry, STUDY_TABLES, Value};
use crate::error::{CaseError, OVERRIDE, Place, Source};
use crate::file::{CaseFile, not_utf8, quantity};
use crate::input::{self, LARGEST_STUDY};
use crate::key::{Key, root};
use crate::parts::Words;
use crate::surface::SurfaceExample;
use crate::unit::{Dimension, format_quantity};
use axis::Values;
use fakir::problem::{CyclePlan, Drive, Load, Method};
use posed::{Surfaces, looked_at};
use std::fmt::Write;
use std::path::Path;

/// The most cases that a study can have.
pub const MAXIMUM_CASES: usize = 10_000_000;

/// What is asked about every case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Asked {
    /// The critical state.
    #[default]
    Transition,
    /// The contact under a load.
    Press,
    /// Loading and unloading with adhesion.
    Cycle,
    /// How a floor that sticks collapses and lets go, by the fast model of a collapsed floor and by closed forms.
    Collapse,
}

impl Words for Asked {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("transition", Self::Transition),
        ("press", Self::Press),
        ("cycle", Self::Cycle),
        ("collapse", Self::Collapse),
    ];
}

impl Asked {
    /// `"transition"`, `"press"`, `"cycle"` or `"collapse"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.word()
    }
}

/// How the axes of a study make its cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Combine {
    /// Every value of an axis with every value of the others; the last axis varies fastest.
    #[default]
    Product,
    /// The first values of all axes, then the second ones; all axes are equally long.
    Zip,
}

impl Words for Combine {
    const WORDS: &'static [(&'static str, Self)] =
        &[("product", Self::Product), ("zip", Self::Zip)];
}

/// A study file that has been read, with the overrides applied so far.
#[derive(Debug, Clone)]
pub struct StudyFile {
    source: Source,
    case: CaseFile,
    asked: Asked,
    combine: Combine,
    load: Option<FixedLoad>,
    drive: Drive,
    varied: Vec<Varied>,
}

/// A load that is the same in every case.
#[derive(Debug, Clone)]
struct FixedLoad {
    variable: Variable,
    load: Load,
    place: Place,
}

/// An axis and where it was given.
#[derive(Debug, Clone)]
struct Varied {
    axis: Axis,
    name: Place,
    /// Where every item of its list stands, or its range as a whole.
    items: Vec<Place>,
}

impl Varied {
    fn place(&self, step: usize) -> &Place {
        self.items.get(step).unwrap_or(&self.items[0])
    }
}

impl StudyFile {
    /// Reads a file, and the case file that it names.
    ///
    /// # Errors
    /// [`CaseError`] if a file cannot be read, is not UTF-8 or TOML, or has a key that no study
    /// has, and for axes that cannot be. Cases are looked at by [`study`](Self::study).
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

    /// Reads the contents of a file; `name` is what errors call it. A case file that it names is
    /// sought in the current folder.
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
        read::read(&source, folder)
    }

    /// Overrides one key of the case, as [`CaseFile::set`]; not one that is an axis.
    ///
    /// # Errors
    /// [`CaseError`].
    pub fn set(&mut self, argument: &str) -> Result<(), CaseError> {
        let (path, _) = argument.split_once('=').unwrap_or((argument, ""));
        if STUDY_TABLES.contains(&root(path.trim())) {
            return Err(CaseError::new(
                &Source::new(OVERRIDE, argument),
                "only keys of the case can be overridden",
            )
            .key(path.trim())
            .label(0..path.len(), "here")
            .accepted("for example texture.pillar.height=2um"));
        }
        self.case.set(argument)?;
        let [key] = self.case.named(path.trim())[..] else {
            return Ok(());
        };
        let variable = Variable::Key(key);
        let axes = self.varied.iter().map(|varied| varied.axis.variable);
        match axes
            .into_iter()
            .find(|axis| *axis == variable || variable.alternative() == Some(*axis))
        {
            None => Ok(()),
            Some(axis) => Err(CaseError::new(
                &Source::new(OVERRIDE, argument),
                format!("{} is an axis of the study", axis.path()),
            )
            .key(key.path())
            .label(0..argument.len(), "here")
            .accepted("leave out the override, or the axis")),
        }
    }

    /// The case that is varied.
    #[must_use]
    pub fn case(&self) -> &CaseFile {
        &self.case
    }

    /// The study that the file and its overrides describe, every case of it looked at.
    ///
    /// # Errors
    /// [`CaseError`] for axes that do not fit together, and for the first case that cannot be.
    pub fn study(self) -> Result<Study, CaseError> {
        let cases = self.number_of_cases()?;
        let mut examples: Vec<Case> = Vec::new();
        let mut surfaces = Surfaces::default();
        let (mut sticks, mut layered) = (false, false);
        for index in 0..cases {
            let blame = |error| self.blame(error, index);
            match self.resolve(index).map_err(blame)?.case {
                StudiedCase::Texture(case) => {
                    sticks |= !case.system.adhesion().is_none();
                    layered |= case.system.has_layers();
                    if examples.iter().all(|example| example.method != case.method) {
                        examples.push(*case);
                    }
                }
                StudiedCase::Surface(file) => {
                    surfaces.look(&self, &file, index).map_err(blame)?;
                }
            }
        }
        let mut study = Study {
            file: self,
            cases,
            examples,
            sticks,
            layered,
            surfaces,
            text: String::new(),
        };
        study.text = study.written();
        Ok(study)
    }

    fn number_of_cases(&self) -> Result<usize, CaseError> {
        let lengths = self.varied.iter().map(|varied| varied.axis.len());
        let cases = match self.combine {
            Combine::Product => lengths.fold(1usize, usize::saturating_mul),
            Combine::Zip => {
                let first = &self.varied[0];
                for other in &self.varied[1..] {
                    let (a, b) = (first.axis.len(), other.axis.len());
                    if a != b {
                        let problem = format!(
                            "values are combined one by one, but {} has {a} and {} has {b}",
                            first.axis.variable.path(),
                            other.axis.variable.path()
                        );
                        return Err(CaseError::at(&other.name, problem)
                            .key("axes")
                            .label(first.name.span.clone(), "and here")
                            .accepted("give as many of each, or combine = \"product\""));
                    }
                }
                first.axis.len()
            }
        };
        if cases > MAXIMUM_CASES {
            return Err(
                CaseError::at(&self.varied[0].name, format!("these are {cases} cases"))
                    .key("axes")
                    .accepted(format!("a study has at most {MAXIMUM_CASES}")),
            );
        }
        Ok(cases)
    }

    /// Whether there is a load exactly where one is asked for. `question` is where that is said.
    fn check_load(&self, question: Option<&Place>) -> Result<(), CaseError> {
        let axis = self
            .varied
            .iter()
            .find(|varied| varied.axis.variable.is_load())
            .map(|varied| (varied.axis.variable.path(), &varied.name));
        let fixed = self
            .load
            .as_ref()
            .map(|fixed| (fixed.variable.path(), &fixed.place));
        match (self.asked, axis, fixed) {
            (_, Some(axis), Some(fixed)) => Err(crate::file::both_given(fixed, axis, "study")
                .accepted("give a load once: in [study] or as an axis")),
            (Asked::Transition | Asked::Collapse, Some((path, place)), None)
            | (Asked::Transition | Asked::Collapse, None, Some((path, place))) => {
                Err(CaseError::at(
                    place,
                    format!(
                        "a load has no place in the question \"{}\"",
                        self.asked.name()
                    ),
                )
                .key(path)
                .accepted("leave it out, or question = \"press\" or \"cycle\" in [study]"))
            }
            (Asked::Press, None, None) => {
                let error = match question {
                    Some(place) => CaseError::at(place, "this question needs a load"),
                    None => CaseError::new(&self.source, "this question needs a load"),
                };
                Err(error.key("study.question").accepted(
                    "give indentation = \"3 um\" or force = \"20 uN\" in [study], or one of them as an axis",
                ))
            }
            // Loads of a cycle say where it turns back; without one it does so at the critical state.
            _ => Ok(()),
        }
    }

    /// The step along every axis of a case.
    fn steps(&self, index: usize) -> Vec<usize> {
        match self.combine {
            Combine::Zip => vec![index; self.varied.len()],
            Combine::Product => {
                let mut rest = index;
                let mut steps: Vec<usize> = self
                    .varied
                    .iter()
                    .rev()
                    .map(|varied| {
                        let step = rest % varied.axis.len();
                        rest /= varied.axis.len();
                        step
                    })
                    .collect();
                steps.reverse();
                steps
            }
        }
    }

    /// The step along every axis of a case that varies a key.
    fn steps_of_keys(&self, index: usize) -> Vec<usize> {
        let axes = self.varied.iter().zip(self.steps(index));
        let of_keys = axes.filter(|(varied, _)| !varied.axis.variable.is_load());
        of_keys.map(|(_, step)| step).collect()
    }

    /// Whether a case of a file can be.
    fn check(&self, case: StudiedCase) -> Result<(), CaseError> {
        match case {
            StudiedCase::Texture(_) => Ok(()),
            StudiedCase::Surface(file) => looked_at(&file, self.asked).map(drop),
        }
    }

    fn resolve(&self, index: usize) -> Result<StudyCase, CaseError> {
        self.resolve_with(index, |_| true)
    }

    /// A case that only some axes, by number, make different from the case of the file.
    fn resolve_with(
        &self,
        index: usize,
        counts: impl Fn(usize) -> bool,
    ) -> Result<StudyCase, CaseError> {
        let steps = self.steps(index);
        let mut file = self.case.clone();
        self.leave_out_idle_keys(&mut file, &steps);
        let mut load = self.load.as_ref().map(|fixed| fixed.load);
        let mut coordinates = Vec::with_capacity(steps.len());
        let axes = self.varied.iter().zip(steps).enumerate();
        for (_, (varied, step)) in axes.filter(|(number, _)| counts(*number)) {
            let coordinate = varied.axis.value(step);
            let entry = Entry {
                value: match &coordinate {
                    Coordinate::Number(number) => Value::InSi(*number),
                    Coordinate::Word(word) => Value::Text(word.clone()),
                },
                place: varied.place(step).clone(),
            };
            match varied.axis.variable {
                Variable::Key(Key::MethodName) => {
                    file.entries.keys.insert(Key::MethodName, entry);
                }
                Variable::Key(key) => file.put(key, entry),
                variable => load = Some(prescribed(variable, &entry)?),
            }
            coordinates.push(coordinate);
        }
        let load = load.unwrap_or(Load::FloorContact);
        let question = match self.asked {
            Asked::Transition | Asked::Press => Question::Contact(load),
            Asked::Cycle => Question::Cycle(CyclePlan {
                turn: load.into(),
                drive: self.drive,
                retract: true,
            }),
            Asked::Collapse => Question::Collapse,
        };
        let case = StudiedCase::of(file, self.asked)?;
        Ok(StudyCase {
            case,
            question,
            coordinates,
        })
    }

    /// Where the methods are varied, the case's keys for others than that of this case.
    fn leave_out_idle_keys(&self, file: &mut CaseFile, steps: &[usize]) {
        for (varied, step) in self.varied.iter().zip(steps) {
            let Values::Words(words) = &varied.axis.values else {
                continue;
            };
            if varied.axis.variable != Variable::Key(Key::MethodName) {
                continue;
            }
            let idle = |key: &Key, entry: &Entry| {
                let Some((Key::MethodName, owners)) = key.goes_with() else {
                    return false;
                };
                let has_it = |word: &String| owners.contains(&word.as_str());
                let is_of_study = words.iter().any(has_it);
                let is_override = entry.place.is_override();
                !has_it(&words[*step]) && (is_of_study || !is_override)
            };
            file.entries.keys.retain(|key, entry| !idle(key, entry));
        }
    }

    /// The values of all axes, as in a study file.
    fn settings(&self, steps: &[usize]) -> String {
        let axes = self.varied.iter().zip(steps);
        let settings: Vec<_> = axes
            .map(|(varied, step)| varied.axis.setting(*step))
            .collect();
        settings.join(", ")
    }

    /// The error of a case, at an axis, with the combination of values that it comes from.
    fn blame(&self, error: CaseError, index: usize) -> CaseError {
        // What is wrong with or without axes is the fault of the case alone.
        let of_file = StudiedCase::of(self.case.clone(), self.asked);
        if let Err(alone) = of_file.and_then(|case| self.check(case))
            && alone.one_line() == error.one_line()
        {
            return alone;
        }
        let steps = self.steps(index);
        let combination = format!("in case {index}, with {}", self.settings(&steps));
        let error = error.in_case(&combination);
        let places = || self.varied.iter().zip(&steps);
        if places().any(|(varied, step)| error.stands_at(varied.place(*step))) {
            return error;
        }
        let axes = 0..steps.len();
        let number = match index.checked_sub(1).map(|before| self.steps(before)) {
            // The slowest axis that changed since the case before, which was good.
            Some(before) => axes.into_iter().find(|axis| before[*axis] != steps[*axis]),
            // The axis without which there would be no error.
            None => axes.into_iter().find(|axis| {
                let without = self.resolve_with(index, |other| other != *axis);
                without.and_then(|case| self.check(case.case)).is_ok()
            }),
        };
        let number = number.unwrap_or(0);
        let varied = &self.varied[number];
        error.moved(varied.place(steps[number]), varied.axis.variable.path())
    }
}

/// The load of an entry.
fn prescribed(variable: Variable, entry: &Entry) -> Result<Load, CaseError> {
    let measured = variable.measured();
    let value = quantity(&measured, entry)?;
    let dimension = measured.dimension;
    if !(value.is_finite() && value >= 0.0) {
        return Err(CaseError::at(
            &entry.place,
            format!("cannot be {}", format_quantity(value, dimension)),
        )
        .key(variable.path())
        .accepted("it must be a finite number, 0 or greater"));
    }
    Ok(match variable {
        Variable::Force => Load::Force(value),
        _ => Load::Indentation(value),
    })
}

/// A study: a question about many cases, all of which can be.
#[derive(Debug, Clone)]
pub struct Study {
    file: StudyFile,
    cases: usize,
    /// The first case of each method.
    examples: Vec<Case>,
    /// Whether there is adhesion in any case.
    sticks: bool,
    layered: bool,
    surfaces: Surfaces,
    text: String,
}

/// What is asked about one case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Question {
    /// The contact at a load, or where the floor is reached.
    Contact(Load),
    /// Loading and unloading with adhesion.
    Cycle(CyclePlan),
    /// How a floor that sticks collapses and lets go.
    Collapse,
}

/// One case of a study.
#[derive(Debug, Clone)]
pub struct StudyCase {
    /// What is pressed, and how it is solved.
    pub case: StudiedCase,
    /// What is asked.
    pub question: Question,
    /// The value of every axis.
    pub coordinates: Vec<Coordinate>,
}

impl Study {
    /// What is asked about every case.
    #[must_use]
    pub fn asked(&self) -> Asked {
        self.file.asked
    }

    /// How the axes make the cases.
    #[must_use]
    pub fn combine(&self) -> Combine {
        self.file.combine
    }

    /// The axes, each of which varies one key or the load.
    pub fn axes(&self) -> impl ExactSizeIterator<Item = &Axis> {
        self.file.varied.iter().map(|varied| &varied.axis)
    }

    /// How many cases it has.
    #[must_use]
    pub fn cases(&self) -> usize {
        self.cases
    }

    /// A case, counted from 0.
    ///
    /// # Panics
    /// If there are no more than `index` cases.
    #[must_use]
    pub fn case(&self, index: usize) -> StudyCase {
        assert!(index < self.cases, "there are {} cases", self.cases);
        let resolved = self.file.resolve(index);
        resolved.expect("every case was looked at when the study was made")
    }

    /// The value of every axis in a case, counted from 0.
    ///
    /// # Panics
    /// If there are no more than `index` cases.
    #[must_use]
    pub fn coordinates(&self, index: usize) -> Vec<Coordinate> {
        assert!(index < self.cases, "there are {} cases", self.cases);
        let steps = self.file.steps(index);
        let axes = self.axes().zip(steps);
        axes.map(|(axis, step)| axis.value(step)).collect()
    }

    /// A case in words, as in a study file: `texture.pitch = "10 um", texture.offset = 0.5`.
    ///
    /// # Panics
    /// If there are no more than `index` cases.
    #[must_use]
    pub fn settings(&self, index: usize) -> String {
        assert!(index < self.cases, "there are {} cases", self.cases);
        self.file.settings(&self.file.steps(index))
    }

    /// Whether its cases have general surfaces.
    #[must_use]
    pub fn is_of_surfaces(&self) -> bool {
        self.file.case.is_surface()
    }

    /// General surfaces of its cases, one of each kind and choice of keys; none of textures.
    #[must_use]
    pub fn surfaces(&self) -> &[SurfaceExample] {
        &self.surfaces.examples
    }

    /// Cells of the general surface of a case; 0 of a texture, and of a surface that takes more memory
    /// than a computation may by default.
    ///
    /// # Panics
    /// If there are no more than `index` cases.
    #[must_use]
    pub fn cells(&self, index: usize) -> usize {
        assert!(index < self.cases, "there are {} cases", self.cases);
        self.surfaces.cells(&self.file, index)
    }

    /// The methods that cases with a texture are solved with.
    #[must_use]
    pub fn methods(&self) -> Vec<Method> {
        self.examples.iter().map(|case| case.method).collect()
    }

    /// Whether pillar tops stick in any of its cases.
    #[must_use]
    pub fn has_adhesion(&self) -> bool {
        self.sticks
    }

    /// Whether a body is a layer in any of its cases.
    #[must_use]
    pub fn has_layers(&self) -> bool {
        self.layered
    }

    /// The study as a study file. It depends on the study alone, and reading it gives the same
    /// study, bit for bit.
    #[must_use]
    pub fn to_toml(&self) -> &str {
        &self.text
    }

    fn written(&self) -> String {
        let mut text = String::from(HEADER);
        let file = &self.file;
        let _ = writeln!(text, "\n[study]\nquestion = \"{}\"", file.asked.name());
        let _ = writeln!(text, "combine = \"{}\"", file.combine.word());
        if let Some(FixedLoad {
            variable,
            load: Load::Force(value) | Load::Indentation(value),
            ..
        }) = &file.load
        {
            let _ = writeln!(text, "{} = {}", variable.path(), variable.written(*value));
        }
        // What is the default is not written, so that journals of before there were drives can be gone on with.
        if file.drive != Drive::Displacement {
            let _ = writeln!(text, "drive = \"{}\"", file.drive.name());
        }
        if let Some(stiffness) = file.drive.stiffness() {
            let stiffness = format_quantity(stiffness, Dimension::Stiffness);
            let _ = writeln!(text, "machine_stiffness = \"{stiffness}\"");
        }
        text.push_str("\n[axes]\n");
        for axis in self.axes() {
            let _ = writeln!(text, "{axis}");
        }
        text.push_str(&write_tables(|key| {
            let varied = |axis: &Axis| axis.variable == Variable::Key(key);
            if self.axes().any(varied) {
                return None;
            }
            // Other keys are the same in all cases that have them.
            let textures = self.examples.iter();
            let surfaces = self.surfaces().iter();
            textures
                .map(|case| case.value(key))
                .chain(surfaces.map(|surface| surface.value(key)))
                .find_map(|value| value)
        }));
        text
    }
}

const HEADER: &str = "\
# Many cases of a lens pressed onto a surface with pillars: a study for fakir.
# Quantities have a unit (m mm um nm, GPa MPa kPa Pa, N mN uN nN, deg rad); bare numbers are in SI units.
";
