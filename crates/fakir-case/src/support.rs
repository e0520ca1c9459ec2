//! Questions that a case supports, by the names of case files: the table of [`fakir::problem::Question`] with the keys that prevent an answer.

use crate::error::CaseError;
use crate::feature::{keys_of, named};
use crate::file::CaseFile;
use crate::key::Key;
use fakir::problem::{Feature, LensForm, Question, Solver, Unsupported};
use std::fmt::Write;

/// A kind of surface that a case can have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SurfaceKind {
    /// Pillars with flat tops: a `[pattern]`.
    Pillars,
    /// Pillars with rounded tops: a `[pattern]` with `top_radius`.
    Asperities,
    /// A height map, or pillars of any cross-section on one: a `[surface]`.
    HeightMap,
    /// No pillars: `surface.flat = true`, or neither `[pattern]` nor `[surface]`.
    Flat,
}

impl SurfaceKind {
    /// The solver; none for pillars with flat tops, for which it depends on the method.
    pub(crate) fn solver(self) -> Option<Solver> {
        match self {
            Self::Pillars => None,
            Self::Asperities => Some(Solver::Asperities),
            Self::HeightMap => Some(Solver::HeightMap),
            Self::Flat => Some(Solver::Flat),
        }
    }
}

impl CaseFile {
    /// Kind of surface of the case.
    #[must_use]
    pub fn surface_kind(&self) -> SurfaceKind {
        if self.is_flat() {
            SurfaceKind::Flat
        } else if self.is_surface() {
            SurfaceKind::HeightMap
        } else if self.is_rounded() {
            SurfaceKind::Asperities
        } else {
            SurfaceKind::Pillars
        }
    }

    /// Refuses a question that this solver does not support for a case with these features.
    pub(crate) fn answers(
        &self,
        question: Question,
        solver: Solver,
        features: &[Feature],
    ) -> Result<(), CaseError> {
        let Err(unsupported) = question.check(solver, features) else {
            return Ok(());
        };
        let Unsupported { why, instead, .. } = unsupported;
        let given = |key: &Key| self.entry(*key).is_some();
        let of_kind = match solver {
            Solver::Asperities => Some(Key::TopRadius),
            Solver::Flat => Some(Key::Flat),
            _ => method_name(solver).map(|_| Key::MethodName),
        };
        let of_layers = || {
            let mut keys = self.entries.keys.keys().copied();
            let has_layer = unsupported
                .with
                .iter()
                .any(|group| group.contains(&Feature::Layer));
            keys.find(|key| has_layer && key.is_of_layers())
        };
        let in_the_way = keys_of(&unsupported).find(given).or_else(of_layers);
        // The message contains the name of the method.
        let why = match method_name(solver) {
            Some(method) if solver != Solver::Spectral => {
                format!("the method \"{method}\": {why}")
            }
            _ => why.to_owned(),
        };
        match in_the_way.or(of_kind) {
            Some(key) => Err(self.problem(key, why).accepted(instead)),
            None => self.refuse_surface(&why, instead),
        }
    }
}

/// Name of a solver in the table.
fn heading(solver: Solver) -> String {
    let other = match solver {
        Solver::Asperities => "rounded tops",
        Solver::Flat => "flat surface",
        _ => "`[surface]`",
    };
    method_name(solver).map_or_else(|| other.to_owned(), |method| format!("`{method}`"))
}

/// The name in `method.name` of a solver of pillars with flat tops.
fn method_name(solver: Solver) -> Option<&'static str> {
    match solver {
        Solver::Spectral => Some("spectral"),
        Solver::Punch => Some("punch"),
        Solver::Elements => Some("love"),
        Solver::Homogenised => Some("homogenised"),
        Solver::Asperities | Solver::HeightMap | Solver::Flat => None,
    }
}

/// Name of a question in the table: the command or the option, if there is one.
fn asked(question: Question) -> String {
    match question {
        Question::Gradient => "`--gradient`".to_owned(),
        Question::AttractionRange => "`--attraction-range`".to_owned(),
        Question::Limits => "validity limits, `--strict`".to_owned(),
        Question::Fields => "maps, `--field-points`".to_owned(),
        Question::FloorShare | Question::VerifyFloor => question.name().to_owned(),
        Question::Spread => "`design` with tolerances".to_owned(),
        command => format!("`{}`", command.name()),
    }
}

/// Features of pillars and of the floor between them.
const OF_PILLARS: [Feature; 6] = [
    Feature::OtherArrangement,
    Feature::SeveralDiameters,
    Feature::ElasticPillars,
    Feature::IgnoredFloor,
    Feature::AdhesiveFloor,
    Feature::FloorInteraction,
];

/// The reason why a flat surface has none of the features of pillars.
const NO_PILLARS: Unsupported = Unsupported {
    why: "a flat surface has no pillars and no floor between them",
    instead: "describe the pillars in a [pattern]",
    with: &[&OF_PILLARS],
};
/// The same of a repeated surface.
const NOT_PERIODIC: Unsupported = Unsupported {
    why: "a pattern is infinite or ends, and an infinite one is computed as such: only a map, which shows a part of a surface, is repeated",
    instead: "use a [surface]",
    with: &[&[Feature::Periodic]],
};

/// The reason why no surface of this solver has all of these features, if there is one.
fn impossible(solver: Solver, features: &[Feature]) -> Option<Unsupported> {
    let any_of = |kinds: &[Feature]| features.iter().any(|feature| kinds.contains(feature));
    if solver == Solver::Flat && any_of(&OF_PILLARS) {
        return Some(NO_PILLARS);
    }
    (solver != Solver::HeightMap && any_of(&[Feature::Periodic])).then_some(NOT_PERIODIC)
}

/// Whether a lens can have all of these features: it has one shape.
fn is_one_lens(features: &[Feature]) -> bool {
    let is_lens = |feature: &&Feature| matches!(feature, Feature::Lens(_));
    features.iter().filter(is_lens).count() < 2
}

/// These features and those that they imply: a tilted plate is a plate, and an adhesive floor has adhesive tops.
fn whole(features: &[Feature]) -> Vec<Feature> {
    let mut all = features.to_vec();
    for (one, other) in [
        (Feature::TiltedPlate, Feature::Lens(LensForm::Plate)),
        (Feature::AdhesiveFloor, Feature::AdhesiveTops),
    ] {
        if all.contains(&one) && !all.contains(&other) {
            all.push(other);
        }
    }
    all
}

/// Numbered reasons of a table.
#[derive(Default)]
struct Notes(Vec<Unsupported>);

impl Notes {
    fn number(&mut self, unsupported: Unsupported) -> usize {
        let known = self.0.iter().position(|note| *note == unsupported);
        1 + known.unwrap_or_else(|| {
            self.0.push(unsupported);
            self.0.len() - 1
        })
    }

    /// Questions that a solver supports for a case with these features, among all that it supports without them.
    fn cell(&mut self, solver: Solver, features: &[Feature]) -> String {
        if let Some(why) = impossible(solver, features) {
            return format!("no such case ({})", self.number(why));
        }
        let features = &whole(features);
        let plain = Question::ALL.into_iter();
        let plain: Vec<Question> = plain
            .filter(|question| question.check(solver, &[]).is_ok())
            .collect();
        let refused: Vec<(Question, Unsupported)> = plain
            .iter()
            .filter_map(|question| Some((*question, question.check(solver, features).err()?)))
            .collect();
        let reasons = |notes: &mut Self| {
            let mut numbers: Vec<usize> = Vec::new();
            for (_, unsupported) in &refused {
                let number = notes.number(*unsupported);
                if !numbers.contains(&number) {
                    numbers.push(number);
                }
            }
            let numbers: Vec<String> = numbers.iter().map(usize::to_string).collect();
            numbers.join(", ")
        };
        if refused.is_empty() {
            "yes".to_owned()
        } else if refused.len() == plain.len() {
            format!("no ({})", reasons(self))
        } else {
            let names: Vec<String> = refused
                .iter()
                .map(|(question, _)| asked(*question))
                .collect();
            format!("all but {} ({})", names.join(", "), reasons(self))
        }
    }
}

/// Tables in Markdown of what is supported, with the reasons for what is not: every question with every solver, and every feature of a case, alone and with each
/// other feature.
#[must_use]
pub fn support() -> String {
    let headings = Solver::ALL.map(heading).join(" | ");
    let rule = "|---".repeat(Solver::ALL.len() + 1) + "|";
    let mut notes = Notes::default();
    let mut text = format!("| question | {headings} |\n{rule}\n");
    for question in Question::ALL {
        let cells = Solver::ALL.map(|solver| match question.check(solver, &[]) {
            Ok(()) => "yes".to_owned(),
            Err(unsupported) => format!("no ({})", notes.number(unsupported)),
        });
        let _ = writeln!(text, "| {} | {} |", asked(question), cells.join(" | "));
    }
    let _ = write!(text, "\n| with | {headings} |\n{rule}\n");
    for feature in Feature::ALL {
        let cells = Solver::ALL.map(|solver| notes.cell(solver, &[feature]));
        let _ = writeln!(text, "| {} | {} |", named(feature), cells.join(" | "));
    }
    for (place, one) in Feature::ALL.into_iter().enumerate() {
        for other in &Feature::ALL[place + 1..] {
            let both = [one, *other];
            // An adhesive floor requires adhesive tops.
            let implied = both == [Feature::AdhesiveTops, Feature::AdhesiveFloor];
            if implied || !Solver::ALL.into_iter().any(|solver| is_news(solver, both)) {
                continue;
            }
            let cells = Solver::ALL.map(|solver| match is_news(solver, both) {
                true => notes.cell(solver, &both),
                false => String::new(),
            });
            let named = both.map(named).join(" and ");
            let _ = writeln!(text, "| {named} | {} |", cells.join(" | "));
        }
    }
    let _ = writeln!(text, "\n{}\n", answered());
    for (number, note) in notes.0.iter().enumerate() {
        let _ = writeln!(
            text,
            "{}. {}. Instead: {}.",
            number + 1,
            note.why,
            note.instead
        );
    }
    text
}

/// The solvers of each kind of surface.
const OF_KINDS: [&[Solver]; 4] = [
    &[
        Solver::Spectral,
        Solver::Punch,
        Solver::Elements,
        Solver::Homogenised,
    ],
    &[Solver::Asperities],
    &[Solver::HeightMap],
    &[Solver::Flat],
];

/// How many of all cells of the tables are answered, in a sentence: without a feature, and with one of them.
fn answered() -> String {
    let [
        mut cells,
        mut missing,
        mut asked,
        mut meaningless,
        mut refused,
    ] = [0; 5];
    let alone = Feature::ALL.map(|feature| vec![feature]);
    for features in std::iter::once(Vec::new()).chain(alone) {
        for solvers in OF_KINDS {
            cells += 1;
            if impossible(solvers[0], &features).is_some() {
                missing += 1;
                continue;
            }
            let features = whole(&features);
            for question in Question::ALL {
                let of_all = |holds: &dyn Fn(Solver) -> bool| solvers.iter().all(|one| holds(*one));
                asked += 1;
                if of_all(&|solver| !question.has_meaning(solver, &features)) {
                    meaningless += 1;
                } else if of_all(&|solver| question.check(solver, &features).is_err()) {
                    refused += 1;
                }
            }
        }
    }
    let percent = |part: usize, of: usize| 100.0 * part as f64 / of as f64;
    let meant = asked - meaningless;
    format!(
        "Of the {cells} cases with a kind of surface and at most one of these features, {missing} ({:.0} %) do not exist. Of the {asked} questions on the \
         others, {meaningless} have no meaning, as that for the transition to the floor of a flat surface. Of the {meant} that have one, {} ({:.0} %) are answered by at least one \
         method, and {refused} are refused for the reasons below.",
        percent(missing, cells),
        meant - refused,
        percent(meant - refused, meant),
    )
}

/// Whether a solver refuses two features together in a question that it supports with each of them.
fn is_news(solver: Solver, both: [Feature; 2]) -> bool {
    let refuses = |question: &Question, features: &[Feature]| {
        question.check(solver, &whole(features)).is_err()
    };
    let news = |question: &Question| {
        refuses(question, &both) && both.iter().all(|feature| !refuses(question, &[*feature]))
    };
    is_one_lens(&both) && impossible(solver, &both).is_none() && Question::ALL.iter().any(news)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every reason names an alternative, and the spectral method supports all questions for pillars with flat tops.
    #[test]
    fn reasons_are_given_with_what_to_do() {
        for question in Question::ALL {
            assert_eq!(question.check(Solver::Spectral, &[]), Ok(()));
            for solver in Solver::ALL {
                if let Err(Unsupported { why, instead, .. }) = question.check(solver, &[]) {
                    assert!(!why.is_empty() && !instead.is_empty());
                }
            }
        }
        let table = support();
        let press = "| `press` | yes | yes | yes | yes | yes | yes |";
        assert!(table.contains(press), "{table}");
        assert!(
            table.contains("| cylinder and periodic surface |"),
            "{table}"
        );
        let ignored = table
            .lines()
            .find(|line| line.starts_with("| floor ignored |"));
        let cells: Vec<&str> = ignored.unwrap_or_default().split(" | ").collect();
        assert!(
            cells[5].starts_with("all but floor share ("),
            "the floor under rounded tops"
        );
        let empty = table.lines().filter(|line| line.contains("|  |"));
        assert!(empty.clone().all(|line| line.contains(" and ")), "{table}");
    }
}
