//! The case of the page as a command and as Python code, which the user can copy.

use crate::request::{GivenHold, is_on_page};
use fakir::problem::{FloorModel, Load};
use fakir_case::unit::{Dimension, format_quantity};
use fakir_case::{Case, Key};
use serde::Serialize;

/// A case as text for other uses of fakir.
#[derive(Debug, Serialize)]
pub(crate) struct Texts {
    /// The case file.
    toml: String,
    pub(crate) command: String,
    python: String,
}

/// For the contact at an indentation (m); for the critical state without an indentation.
pub(crate) fn texts(case: &Case, indentation: Option<f64>) -> Texts {
    Texts::of(case, Question::Contact(indentation))
}

/// The same for a case that `fakir init` cannot begin: from the saved case file.
pub(crate) fn saved_texts(toml: String, indentation: Option<f64>) -> Texts {
    let question = Question::Contact(indentation);
    Texts {
        toml,
        command: saved_command(question, ""),
        python: match indentation {
            None => format!("{SAVED}critical = case.transition()\nprint(critical)\n"),
            Some(indentation) => format!(
                "{SAVED}state = case.press(indentation=\"{}\")\nprint(state)\n",
                format_quantity(indentation, Dimension::Length)
            ),
        },
    }
}

/// Python code that reads the saved case file.
const SAVED: &str =
    "import fakir\n\ncase = fakir.read_case(\"fakir-case.toml\")  # the saved case file\n";

/// The command for the saved case file.
fn saved_command(question: Question, beside: &str) -> String {
    let question = question.command().replace("case.toml", "fakir-case.toml");
    format!("# the saved case file{beside}\n{question}\n")
}

/// For a cycle of loading and unloading.
pub(crate) fn cycle_texts(case: &Case) -> Texts {
    Texts::of(case, Question::Cycle)
}

/// For a load that is held. The question is also the first line of the case file, as a comment.
pub(crate) fn hold_texts(case: &Case, hold: &GivenHold) -> Texts {
    let question = Question::Hold(*hold);
    let texts = Texts::of(case, question);
    let asked = question.command().replace("case.toml", "fakir-case.toml");
    Texts {
        toml: format!("# {asked}\n{}", texts.toml),
        ..texts
    }
}

impl Texts {
    /// The case file.
    pub(crate) fn case_file(&self) -> &str {
        &self.toml
    }

    fn of(case: &Case, question: Question) -> Self {
        Self {
            toml: case.to_toml(),
            command: command(case, question),
            python: python(case, question),
        }
    }
}

/// Question about a case.
#[derive(Clone, Copy)]
enum Question {
    /// The contact at an indentation, m; the critical state without an indentation.
    Contact(Option<f64>),
    Cycle,
    /// A load that is reached in a time and held.
    Hold(GivenHold),
}

impl Question {
    /// The command for a case file `case.toml`.
    fn command(self) -> String {
        let option = |value, dimension| format_quantity(value, dimension).replace(' ', "");
        match self {
            Self::Contact(None) => "fakir transition case.toml".to_owned(),
            Self::Contact(Some(indentation)) => format!(
                "fakir press case.toml --indentation {}",
                option(indentation, Dimension::Length)
            ),
            Self::Cycle => "fakir cycle case.toml".to_owned(),
            Self::Hold(hold) => {
                let [name, load] = load_of(&hold);
                let [ramp, duration] = hold.times().map(|time| option(time, Dimension::Time));
                let load = load.replace(' ', "");
                format!("fakir hold case.toml --{name} {load} --ramp {ramp} --for {duration}")
            }
        }
    }
}

/// Name and value of a load that is held.
fn load_of(hold: &GivenHold) -> [String; 2] {
    match hold.load() {
        Load::Force(force) => ["force".to_owned(), format_quantity(force, Dimension::Force)],
        Load::Indentation(value) => [
            "indentation".to_owned(),
            format_quantity(value, Dimension::Length),
        ],
        Load::FloorContact => ["indentation".to_owned(), String::new()],
    }
}

/// The call of the Python package for a load that is held.
fn python_hold(hold: &GivenHold, relaxation: &str) -> String {
    let [name, load] = load_of(hold);
    let [ramp, duration] = hold
        .times()
        .map(|time| format_quantity(time, Dimension::Time));
    format!(
        "history = system.hold({name}=\"{load}\", ramp=\"{ramp}\", duration=\"{duration}\"{relaxation})\nprint(history)\n"
    )
}

/// The relaxation of a case as an argument in Python.
fn python_relaxation(case: &Case) -> String {
    let list = |key| case.value(key).unwrap_or_else(|| "[]".to_owned());
    let [strengths, times] = [Key::RelaxationStrengths, Key::RelaxationTimes].map(list);
    format!(", relaxation=fakir.Relaxation({strengths}, {times})")
}

/// The equivalent command. It overrides each key that differs from the case that `fakir init` writes, and
/// fails if a file with that name, possibly of another case, exists.
fn command(case: &Case, question: Question) -> String {
    let example = Case::example();
    if case.system.arrangement().name() == "listed" {
        return saved_command(question, ", beside the table of pillars");
    }
    if case.system.lens().sphere().is_none() {
        return saved_command(question, "");
    }
    let question = question.command();
    let changes = Key::ALL.into_iter().filter_map(|key| {
        let value = case.value(key)?;
        // Keys with the value of the example need no override.
        let same = example.value(key).as_ref() == Some(&value);
        (!same).then(|| format!(" \\\n    --set {}", argument(key, &value)))
    });
    let changes: String = changes.collect();
    format!("fakir init case.toml &&\n{question}{changes}\n")
}

/// `key=value` for a shell: a quantity without space, a word without quotes.
fn argument(key: Key, value: &str) -> String {
    if value.starts_with('[') {
        return format!("'{}={value}'", key.path());
    }
    let value = value.trim_matches('"').replace(' ', "");
    format!("{}={value}", key.path())
}

/// The equivalent Python code. The pillars of a table are those of the case file.
fn python(case: &Case, question: Question) -> String {
    if case.system.arrangement().name() == "listed" || case.system.lens().sphere().is_none() {
        return listed(case, question);
    }
    let [lens, substrate, pattern, pillar, method] =
        ["lens", "substrate", "pattern", "pattern.pillar", "method"]
            .map(|table| arguments(case, table));
    let kind = match case.system.arrangement().name() {
        "square" => "SquarePattern",
        "rectangular" => "RectangularPattern",
        "oblique" => "ObliquePattern",
        _ => "HexagonalPattern",
    };
    let floor = match case.system.floor_model() {
        FloorModel::Contact => "",
        FloorModel::Ignored => "    floor_contact=False,\n",
    };
    let adhesion = if case.system.adhesion().is_none() {
        String::new()
    } else {
        let works = arguments(case, "adhesion");
        format!("    adhesion=fakir.Adhesion({works}),\n")
    };
    let question = match question {
        Question::Contact(None) => format!(
            "critical = system.transition({method})\nprint(critical.force, \"N\", critical.indentation, \"m\")\n"
        ),
        Question::Contact(Some(indentation)) => format!(
            "state = system.press(indentation=\"{}\", {method})\nprint(state.force, \"N\")\n",
            format_quantity(indentation, Dimension::Length)
        ),
        Question::Cycle => {
            let accuracy = case.value(Key::Accuracy).unwrap_or_default();
            format!("cycle = system.cycle(accuracy={accuracy})\nprint(cycle)\n")
        }
        Question::Hold(hold) => python_hold(&hold, &python_relaxation(case)),
    };
    format!(
        "import fakir\n\n\
         system = fakir.System(\n    \
             lens=fakir.Lens({lens}),\n    \
             substrate=fakir.Substrate({substrate}),\n    \
             pattern=fakir.{kind}(\n        \
                 {pillar},\n        \
                 {pattern},\n    \
             ),\n{floor}{adhesion}\
         )\n{question}"
    )
}

/// Python code for a case that the saved case file describes: the pillars of a table, or another lens than a sphere.
fn listed(case: &Case, question: Question) -> String {
    let method = arguments(case, "method");
    let question = match question {
        Question::Contact(None) => {
            format!("critical = system.transition({method})\nprint(critical.force, \"N\")\n")
        }
        Question::Contact(Some(indentation)) => format!(
            "state = system.press(indentation=\"{}\", {method})\nprint(state.force, \"N\")\n",
            format_quantity(indentation, Dimension::Length)
        ),
        Question::Cycle => "cycle = system.cycle()\nprint(cycle)\n".to_owned(),
        // The relaxation is part of the case file.
        Question::Hold(hold) => python_hold(&hold, ""),
    };
    let beside = match case.system.arrangement().name() {
        "listed" => ", beside the table",
        _ => "",
    };
    format!(
        "import fakir\n\nsystem = fakir.System.from_file(\"fakir-case.toml\")  # the saved case file{beside}\n{question}"
    )
}

/// Keys of a table as arguments of a call: `radius="2.2 mm", young_modulus="2 MPa"`. Python uses
/// the same names, except for the name of the method and the angle of a lattice.
fn arguments(case: &Case, table: &str) -> String {
    let keys = Key::ALL.into_iter().filter(|key| key.table() == table);
    // Keys that distinguish lattices of equal pillars from others are written only if they differ
    // from the default.
    let plain = Case::example();
    let is_said = |key: &Key| match key {
        Key::Lattice => false,
        Key::Rotation
        | Key::Columns
        | Key::HeightStandardDeviation
        | Key::VacancyFraction
        | Key::PillarSeed => case.value(*key) != plain.value(*key),
        key => is_on_page(*key),
    };
    let arguments = keys.filter(is_said).filter_map(|key| {
        let name = match key {
            Key::MethodName => table,
            Key::LatticeAngle => "angle",
            _ => key.name(),
        };
        let value = match case.value(key)?.as_str() {
            "true" => "True".to_owned(),
            "false" => "False".to_owned(),
            other => other.to_owned(),
        };
        Some(format!("{name}={value}"))
    });
    arguments.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir_case::CaseFile;

    #[test]
    fn the_command_is_the_case() {
        let mut file = CaseFile::parse("case.toml", &Case::example().to_toml()).unwrap();
        let changes = [
            "pattern.pitch=25um",
            "lens.young_modulus=3.5MPa",
            "pattern.offset_angle=30deg",
            "method.name=punch",
        ];
        for change in changes {
            file.set(change).unwrap();
        }
        let case = file.case().unwrap();
        let command = command(&case, Question::Contact(Some(3e-6)));
        // An existing file of this name, which may contain another case, is not used.
        assert!(
            command.starts_with("fakir init case.toml &&\nfakir press"),
            "{command}"
        );
        assert!(
            command.contains("fakir press case.toml --indentation 3um \\\n"),
            "{command}"
        );
        let mut again = CaseFile::parse("case.toml", &Case::example().to_toml()).unwrap();
        let lines = command
            .lines()
            .filter_map(|line| line.trim().strip_prefix("--set "));
        for setting in lines {
            again.set(setting.trim_end_matches(['\\', ' '])).unwrap();
        }
        assert_eq!(again.case().unwrap(), case);
    }

    #[test]
    fn the_lines_for_python_are_of_the_lattice() {
        let mut file = CaseFile::parse("case.toml", &Case::example().to_toml()).unwrap();
        let changes = [
            "pattern.lattice=rectangular",
            "pattern.pitch=20um",
            "pattern.pitch_y=30um",
        ];
        for change in changes {
            file.set(change).unwrap();
        }
        let rectangular = python(&file.case().unwrap(), Question::Contact(None));
        assert!(
            rectangular.contains("fakir.RectangularPattern(")
                && rectangular.contains("pitch=\"20 um\", pitch_y=\"30 um\", offset=0"),
            "{rectangular}"
        );
        file.set("pattern.lattice=oblique").unwrap();
        file.set("pattern.lattice_angle=70deg").unwrap();
        let oblique = python(&file.case().unwrap(), Question::Contact(None));
        assert!(
            oblique.contains("fakir.ObliquePattern(")
                && oblique.contains("pitch_y=\"30 um\", angle=\"70 deg\", offset=0"),
            "{oblique}"
        );
    }

    #[test]
    fn the_lines_for_python_have_every_key() {
        let case = Case::example();
        let lines = python(&case, Question::Contact(Some(3e-6)));
        for required in [
            "lens=fakir.Lens(radius=\"2.2 mm\", young_modulus=\"2 MPa\", poisson_ratio=0.5),",
            "diameter=\"6 um\", height=\"2.2 um\", compliance=\"column\",\n",
            "surface_fraction=0.1, offset=0, offset_angle=\"0 deg\",\n",
            "indentation=\"3 um\", method=\"spectral\", accuracy=\"default\")",
        ] {
            assert!(lines.contains(required), "{lines}");
        }
        assert!(!lines.contains("floor"), "{lines}");
        let mut file = CaseFile::parse("case.toml", &case.to_toml()).unwrap();
        file.set("floor.contact=false").unwrap();
        file.set("adhesion.work=50mJ/m2").unwrap();
        let case = file.case().unwrap();
        let lines = python(&case, Question::Cycle);
        assert!(
            lines.contains("    ),\n    floor_contact=False,\n    adhesion=fakir.Adhesion(work=\"50 mJ/m2\"),\n)\n"),
            "{lines}"
        );
        assert!(
            lines.contains("cycle = system.cycle(accuracy=\"default\")"),
            "{lines}"
        );
        let mut adhesive = CaseFile::parse("case.toml", &Case::example().to_toml()).unwrap();
        adhesive.set("adhesion.work=50mJ/m2").unwrap();
        adhesive.set("adhesion.floor=true").unwrap();
        let message = python(&adhesive.case().unwrap(), Question::Cycle);
        assert!(
            message.contains("adhesion=fakir.Adhesion(work=\"50 mJ/m2\", floor=True),"),
            "{message}"
        );
        let command = command(&case, Question::Cycle);
        assert!(command.contains("fakir cycle case.toml \\\n"), "{command}");
        assert!(command.contains("--set adhesion.work=50mJ/m2"), "{command}");
    }
}
