//! A study file: a case, and the axes along which it is varied.

use super::asked::{Asked, Combine, Hold, Question};
use super::axis::{Axis, Coordinate, Values, Variable};
use super::posed::looked_at;
use crate::any_case::AnyCase;
use crate::entries::{Entry, STUDY_TABLES, Value, both_given};
use crate::error::{CaseError, OVERRIDE, Place, Source};
use crate::file::{CaseFile, quantity};
use crate::idle::{IDLE, Idle, without_effect_words};
use crate::key::{Key, root};
use crate::unit::format_quantity;
use fakir::problem::{CyclePlan, Load, LoadingMode, Relaxation};

/// Largest number of cases of a study.
pub const MAXIMUM_CASES: usize = 10_000_000;

/// A study file that has been read, with the overrides applied so far.
#[derive(Debug, Clone)]
pub struct StudyFile {
    pub(super) source: Source,
    pub(super) case: CaseFile,
    pub(super) asked: Asked,
    pub(super) combine: Combine,
    pub(super) load: Option<FixedNumber>,
    pub(super) drive: LoadingMode,
    /// Duration or rate of the ramp, and duration of the hold, that are the same in every case.
    pub(super) ramp: Option<FixedNumber>,
    pub(super) hold_time: Option<FixedNumber>,
    pub(super) varied: Vec<Varied>,
}

/// A load, a time or a rate, in SI units, that is the same in every case.
#[derive(Debug, Clone)]
pub(super) struct FixedNumber {
    pub(super) variable: Variable,
    pub(super) value: f64,
    pub(super) place: Place,
}

impl FixedNumber {
    pub(super) fn read(variable: Variable, entry: Entry) -> Result<Self, CaseError> {
        let value = not_negative(variable, &entry)?;
        let place = entry.place;
        Ok(Self {
            variable,
            value,
            place,
        })
    }
}

/// An axis with its position.
#[derive(Debug, Clone)]
pub(super) struct Varied {
    pub(super) axis: Axis,
    pub(super) name: Place,
    /// Position of every item of its list, or of its range as a whole.
    pub(super) items: Vec<Place>,
}

impl Varied {
    fn place(&self, step: usize) -> &Place {
        self.items.get(step).unwrap_or(&self.items[0])
    }
}

/// One case of a study.
#[derive(Debug, Clone)]
pub struct StudyCase {
    /// System and method.
    pub case: AnyCase,
    /// Question.
    pub question: Question,
    /// Relaxation of the bodies of a hold.
    pub relaxation: Option<Relaxation>,
    /// The value of every axis.
    pub coordinates: Vec<Coordinate>,
}

/// What is prescribed in a case, in addition to the keys.
#[derive(Debug, Clone, Copy)]
struct Posed {
    load: Option<Load>,
    ramp: Option<(Variable, f64)>,
    hold_time: f64,
}

impl Posed {
    /// Duration of the ramp to a load, s: 0 for a step. A rate is one of the load: [`StudyFile::check_times`] has ensured it.
    fn ramp_time(&self, load: Load) -> f64 {
        match (self.ramp, load) {
            (None, _) => 0.0,
            (Some((Variable::RampTime, time)), _) => time,
            (Some((_, rate)), Load::Indentation(amount) | Load::Force(amount)) => amount / rate,
            (Some(_), Load::FloorContact) => unreachable!("a rate without its load is refused"),
        }
    }
}

impl StudyFile {
    /// Overrides one key of the case, as [`CaseFile::set`]; an axis cannot be overridden.
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
            .accepted("for example pattern.pillar.height=2um"));
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

    pub(super) fn number_of_cases(&self) -> Result<usize, CaseError> {
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

    /// Checks that there is a load if and only if the question requires one. `question` is its
    /// position.
    pub(super) fn check_load(&self, question: Option<&Place>) -> Result<(), CaseError> {
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
            (_, Some(axis), Some(fixed)) => Err(both_given(fixed, axis, "study")
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
                .accepted(
                    "leave it out, or question = \"press\", \"cycle\" or \"hold\" in [study]",
                ))
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
            // The load of a cycle is its unloading point; the default is the critical state, as that of a hold.
            _ => Ok(()),
        }
    }

    /// Checks that there are times and rates if and only if the question requires them. `question` is its position.
    pub(super) fn check_times(&self, question: Option<&Place>) -> Result<(), CaseError> {
        let fixed = [&self.ramp, &self.hold_time].into_iter().flatten();
        let fixed = fixed.map(|fixed| (fixed.variable, &fixed.place));
        let axes = self.varied.iter();
        let axes = axes.map(|varied| (varied.axis.variable, &varied.name));
        let given: Vec<(Variable, &Place)> = fixed.chain(axes).collect();
        let of_a_kind = [&Variable::RAMP[..], &[Variable::HoldTime]];
        let [ramps, holds] = of_a_kind.map(|kind| {
            let of_kind = given.iter().filter(|(given, _)| kind.contains(given));
            of_kind.copied().collect::<Vec<_>>()
        });
        for kind in [&ramps, &holds] {
            if let [first, second, ..] = kind[..] {
                let [first, second] = [first, second].map(|(given, place)| (given.path(), place));
                return Err(both_given(first, second, "study").accepted(
                    "give a time once, in [study] or as an axis, and a ramp by its duration or by its rate",
                ));
            }
        }
        if self.asked != Asked::Hold {
            let Some((variable, place)) = ramps.first().or(holds.first()) else {
                return Ok(());
            };
            let problem = format!(
                "a time has no place in the question \"{}\"",
                self.asked.name()
            );
            return Err(CaseError::at(place, problem)
                .key(variable.path())
                .accepted("leave it out, or question = \"hold\" in [study]"));
        }
        if holds.is_empty() {
            let error = match question {
                Some(place) => CaseError::at(place, "this question needs a time"),
                None => CaseError::new(&self.source, "this question needs a time"),
            };
            return Err(error
                .key("study.question")
                .accepted("give hold_time = \"10 min\" in [study], or as an axis"));
        }
        self.check_rate(&ramps)
    }

    /// Checks that a rate is one of the load that is prescribed.
    fn check_rate(&self, ramps: &[(Variable, &Place)]) -> Result<(), CaseError> {
        let Some(&(rate, place)) = ramps.first() else {
            return Ok(());
        };
        let load = match rate {
            Variable::IndentationRate => Variable::Indentation,
            Variable::ForceRate => Variable::Force,
            _ => return Ok(()),
        };
        let fixed = self.load.as_ref().map(|fixed| fixed.variable);
        let mut given = fixed
            .into_iter()
            .chain(self.varied.iter().map(|v| v.axis.variable));
        if given.any(|given| given == load) {
            return Ok(());
        }
        let problem = format!("{} is the rate of a load that is not given", rate.path());
        Err(CaseError::at(place, problem)
            .key(rate.path())
            .accepted(format!(
                "give {} too, in [study] or as an axis, or ramp_time instead",
                load.path()
            )))
    }

    /// The step along every axis of a case.
    pub(super) fn steps(&self, index: usize) -> Vec<usize> {
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
    pub(super) fn steps_of_keys(&self, index: usize) -> Vec<usize> {
        let axes = self.varied.iter().zip(self.steps(index));
        let of_keys = axes.filter(|(varied, _)| varied.axis.variable.is_key());
        of_keys.map(|(_, step)| step).collect()
    }

    /// Checks a case of a file.
    fn check(&self, case: AnyCase) -> Result<(), CaseError> {
        match case {
            AnyCase::HeightMap(file) => looked_at(&file, self.asked).map(drop),
            _ => Ok(()),
        }
    }

    pub(super) fn resolve(&self, index: usize) -> Result<StudyCase, CaseError> {
        self.resolve_with(index, |_| true)
    }

    /// Warnings about keys without effect in any case.
    pub(super) fn without_effect(&self, cases: usize) -> Vec<String> {
        let is_axis = |key| {
            let mut axes = self.varied.iter();
            axes.any(|varied| varied.axis.variable == Variable::Key(key))
        };
        let mut candidates: Vec<&Idle> = IDLE
            .iter()
            .filter(|idle| self.case.entry(idle.key).is_some() || is_axis(idle.key))
            .collect();
        let mut found: Vec<Key> = Vec::new();
        for index in 0..cases {
            if candidates.is_empty() {
                break;
            }
            let posed = self.posed(index, |_| true);
            let given = posed.and_then(|(file, ..)| file.may_be_idle());
            for (idle, is_idle) in given.unwrap_or_default() {
                if !is_idle {
                    candidates.retain(|candidate| candidate.key != idle.key);
                } else if !found.contains(&idle.key) {
                    found.push(idle.key);
                }
            }
        }
        candidates.retain(|candidate| found.contains(&candidate.key));
        let words = candidates.into_iter();
        words
            .map(|idle| without_effect_words(idle.key, idle.reason))
            .collect()
    }

    /// File, load with times, and axis values of a case to which only some axes, by number, are applied.
    fn posed(
        &self,
        index: usize,
        counts: impl Fn(usize) -> bool,
    ) -> Result<(CaseFile, Posed, Vec<Coordinate>), CaseError> {
        let steps = self.steps(index);
        let mut file = self.case.clone();
        self.leave_out_idle_keys(&mut file, &steps);
        let ramp = self.ramp.as_ref();
        let mut posed = Posed {
            load: (self.load.as_ref()).map(|fixed| prescribed(fixed.variable, fixed.value)),
            ramp: ramp.map(|fixed| (fixed.variable, fixed.value)),
            hold_time: self.hold_time.as_ref().map_or(0.0, |fixed| fixed.value),
        };
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
                Variable::HoldTime => posed.hold_time = not_negative(Variable::HoldTime, &entry)?,
                ramp if Variable::RAMP.contains(&ramp) => {
                    posed.ramp = Some((ramp, not_negative(ramp, &entry)?));
                }
                load => posed.load = Some(prescribed(load, not_negative(load, &entry)?)),
            }
            coordinates.push(coordinate);
        }
        Ok((file, posed, coordinates))
    }

    /// A case to which only some axes, by number, are applied.
    fn resolve_with(
        &self,
        index: usize,
        counts: impl Fn(usize) -> bool,
    ) -> Result<StudyCase, CaseError> {
        let (file, posed, coordinates) = self.posed(index, counts)?;
        let load = posed.load.unwrap_or(Load::FloorContact);
        let question = match self.asked {
            Asked::Transition | Asked::Press => Question::Contact(load),
            Asked::Cycle => Question::Cycle(CyclePlan {
                turn: load.into(),
                drive: self.drive,
                retract: true,
            }),
            Asked::Collapse => Question::Collapse,
            Asked::Hold => Question::Hold(Hold {
                load,
                ramp_time: posed.ramp_time(load),
                hold_time: posed.hold_time,
            }),
        };
        let relaxation = match self.asked {
            Asked::Hold => Some(file.viscoelastic()?.relaxation),
            _ => None,
        };
        let case = AnyCase::studied(&file, self.asked)?;
        Ok(StudyCase {
            case,
            question,
            relaxation,
            coordinates,
        })
    }

    /// If the methods are varied, the keys for methods other than that of this case.
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

    /// Values of all axes, as in a study file.
    pub(super) fn settings(&self, steps: &[usize]) -> String {
        let axes = self.varied.iter().zip(steps);
        let settings: Vec<_> = axes
            .map(|(varied, step)| varied.axis.setting(*step))
            .collect();
        settings.join(", ")
    }

    /// Error of a case, at an axis, with the combination of values that causes it.
    pub(super) fn blame(&self, error: CaseError, index: usize) -> CaseError {
        // An error that also occurs without axes is an error of the case.
        let of_file = AnyCase::studied(&self.case, self.asked);
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
            // The slowest axis that has changed since the previous case, which was valid.
            Some(before) => axes.into_iter().find(|axis| before[*axis] != steps[*axis]),
            // The axis that causes the error.
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

/// The load of a variable with a value.
fn prescribed(variable: Variable, value: f64) -> Load {
    match variable {
        Variable::Force => Load::Force(value),
        _ => Load::Indentation(value),
    }
}

/// The number of an entry, which is not negative: a load, a time, or a rate, which is not 0 either.
pub(super) fn not_negative(variable: Variable, entry: &Entry) -> Result<f64, CaseError> {
    let measured = variable.measured();
    let value = quantity(&measured, entry)?;
    let dimension = measured.dimension;
    let is_rate = variable.is_rate();
    if !(value.is_finite() && if is_rate { value > 0.0 } else { value >= 0.0 }) {
        return Err(CaseError::at(
            &entry.place,
            format!("cannot be {}", format_quantity(value, dimension)),
        )
        .key(variable.path())
        .accepted(match is_rate {
            true => "it must be a finite number greater than 0; without it the load is a step",
            false => "it must be a finite number, 0 or greater",
        }));
    }
    Ok(value)
}
