//! Every key in every kind of case, with every method: it changes the result, or is refused by name, or is in a list of keys without effect
//! with the reason. A key that a solver does not read fails here.

use fakir::problem::{CyclePlan, Load};
use fakir::state::{Run, SolveError};
use fakir_case::unit::Dimension;
use fakir_case::{Case, CaseFile, Key, Kind, Setting};
use fakir_study::record::{AsperityAnswer, FlatAnswer, Record, SurfaceAnswer};
use serde_json::Value;
use std::cell::RefCell;
use std::path::Path;
use std::{fs, iter};
use tempfile::TempDir;

const BODIES: &str = "[lens]\nradius = \"500 um\"\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.45\n\
    [substrate]\nyoung_modulus = \"2 MPa\"\npoisson_ratio = 0.45\n";
const PILLAR: &str = "[pattern.pillar]\ndiameter = \"6 um\"\nheight = \"0.2 um\"\n";
const INFINITE_LATTICE: &str =
    "[pattern]\npitch = \"20 um\"\noffset = 0.3\noffset_angle = \"20 deg\"\n";
const FINITE: &str = "[pattern]\nlattice = \"square\"\npitch = \"11 um\"\noffset = 0.3\n\
    offset_angle = \"20 deg\"\ncolumns = 2\n";
const SPECTRAL: &str = "name = \"spectral\"";
const LOVE: &str = "name = \"love\"\ncells_per_diameter = 8";
const LISTED: &str = "[pattern]\nlattice = \"listed\"\npillars = \"pillars.csv\"\n";
const ROUNDED: &str = "[pattern]\npitch = \"6 um\"\noffset = 0.3\noffset_angle = \"20 deg\"\n\
    columns = 2\ntop_radius = \"20 um\"\n[pattern.pillar]\nheight = \"0.14 um\"\n";
const MAP: &str = "[surface]\nheight_map = \"map.txt\"\ncell_size = \"3 um\"\nfloor = \"0.1 um\"\n";
const PATTERN: &str = "[surface]\narrangement = \"square\"\npitch = \"12 um\"\noffset = 0.3\n\
    offset_angle = \"20 deg\"\nvacancy_fraction = 0.2\n[surface.pillar]\ncross_section = \"square\"\nside = \"6 um\"\n\
    height = \"0.3 um\"\n[surface.grid]\nwidth = \"48 um\"\ncells_per_diameter = 4\n";

/// Below the critical state of all cases, m; for rounded tops just past the height.
const INDENTATION: f64 = 0.15e-6;

/// A folder with the files that cases refer to.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    for (name, shift, number) in [("", 0.0, 5), ("other_", 1e-6, 9)] {
        let pillars = format!(
            "x_m,y_m,height_m,diameter_m\n{shift:e},0,2e-7,6e-6\n1.3e-5,2e-6,1.9e-7,6e-6\n-4e-6,1.2e-5,1.95e-7,6e-6\n"
        );
        write(&format!("{name}pillars.csv"), pillars);
        let profile = (0..60).map(|k| {
            let radius = 2e-6 * f64::from(k);
            format!("{radius:e},{:e}\n", radius * radius / (1e-3 + 1e2 * shift))
        });
        let profile = profile.collect::<String>();
        write(
            &format!("{name}profile.csv"),
            format!("radius_m,height_m\n{profile}"),
        );
        let map = (0..24).map(|row| {
            let heights = (0..24).map(|column| {
                let top = (row + column) % 7 < 4 && (row * column) % number < 4;
                let height = if top { 2e-7 } else { 0.0 };
                format!("{height:e} ")
            });
            heights.chain(["\n".to_owned()]).collect::<String>()
        });
        write(&format!("{name}map.txt"), map.collect());
    }
    folder
}

/// Keys required by a word of a key.
fn companions(key: Key, word: &str, folder: &Path) -> Vec<String> {
    let named = |key: Key, name: &str| {
        let path = folder.join(name);
        vec![format!("{key}={:?}", path.display().to_string())]
    };
    let settings: &[&str] = match (key, word) {
        (Key::Lattice, "hexagonal" | "square") => &["pattern.pitch=13um"],
        (Key::Lattice, "rectangular") => &["pattern.pitch=12um", "pattern.pitch_y=12.5um"],
        (Key::Lattice, "oblique") => &[
            "pattern.pitch=12um",
            "pattern.pitch_y=12.5um",
            "pattern.lattice_angle=70deg",
        ],
        (Key::Lattice, "listed") => return named(Key::Pillars, "pillars.csv"),
        (Key::LensShape, "profile") => return named(Key::LensProfile, "profile.csv"),
        (Key::SubstrateBase, "elastic") => &[
            "substrate.base_young_modulus=1MPa",
            "substrate.base_poisson_ratio=0.3",
        ],
        (Key::LensBase, "elastic") => &[
            "lens.base_young_modulus=1MPa",
            "lens.base_poisson_ratio=0.3",
        ],
        (Key::Arrangement, "random") => &["surface.surface_fraction=0.2"],
        (Key::CrossSection, "circle") => &["surface.pillar.diameter=6um"],
        (Key::CrossSection, "polygon") => {
            &["surface.pillar.diameter=6um", "surface.pillar.sides=6"]
        }
        (Key::CrossSection, "ellipse") => {
            &["surface.pillar.length=8um", "surface.pillar.width=5um"]
        }
        (Key::Top, "cone") => &["surface.pillar.drop=0.1um"],
        (Key::Top, "chamfer") => &[
            "surface.pillar.drop=0.1um",
            "surface.pillar.chamfer_width=1.6um",
        ],
        (Key::Top, "rounded") => &["surface.pillar.edge_radius=0.2um"],
        _ => &[],
    };
    settings.iter().map(|&setting| setting.to_owned()).collect()
}

/// Additional settings with which a key is tried, so that it has an effect, or none.
fn contexts(key: Key) -> &'static [&'static [&'static str]] {
    match key {
        Key::PillarSeed => &[&["pattern.height_standard_deviation=0.1"]],
        Key::OffsetAngle => &[&["pattern.offset=0"]],
        Key::LensTiltDirection => &[&["lens.tilt=1deg"]],
        Key::PillarCompliance => &[&["pattern.pillar.diameter=5um"]],
        Key::SubstrateBase | Key::SubstrateBaseYoungModulus | Key::SubstrateBasePoissonRatio => {
            &[&["substrate.thickness=5um"]]
        }
        Key::LensBase | Key::LensBaseYoungModulus | Key::LensBasePoissonRatio => {
            &[&["lens.thickness=5um"]]
        }
        Key::RecedingWorkOfAdhesion => &[&["adhesion.work=0.1mJ/m2"]],
        // A floor with few holes, which takes little time.
        Key::AdhesiveFloor => &[&["adhesion.work=0.1mJ/m2", "pattern.columns=2"]],
        Key::PatternOffsetAngle => &[&["surface.offset=0"]],
        Key::Seed => &[&["surface.vacancy_fraction=0"]],
        Key::Orientation => &[&[
            "surface.pillar.cross_section=circle",
            "surface.pillar.diameter=6um",
        ]],
        _ => &[],
    }
}

/// A number that differs from the value of a key in a case.
fn other_number(key: Key, file: &CaseFile) -> f64 {
    let default = match key.default() {
        Some(Setting::Number(value)) => Some(value),
        _ => None,
    };
    match (key, file.given(key).unwrap().or(default)) {
        (Key::WorkOfAdhesion, _) => 1e-4,
        (Key::RecedingWorkOfAdhesion, _) => 2e-4,
        (Key::VacancyFraction, _) => 0.88,
        (Key::Columns, None) => 2.0,
        (Key::MinimumDistance, _) => 1e-5,
        (Key::MapWidth, _) => 9e-5,
        // All of the surface is floor.
        (Key::Floor, _) => 0.31e-6,
        (_, Some(value)) if key.is_whole() => value + 1.0,
        (_, Some(value)) if value != 0.0 => 1.1 * value,
        (_, None) if key.is_whole() => 3.0,
        _ => match key.dimension() {
            Dimension::Length => 5e-6,
            Dimension::Pressure => 1e6,
            _ => 0.2,
        },
    }
}

/// Numbers and flags of a result, without the effort of the solver.
fn numbers(record: &Record) -> Vec<f64> {
    fn add(value: &Value, all: &mut Vec<f64>) {
        match value {
            Value::Number(number) => all.push(number.as_f64().unwrap()),
            Value::Bool(flag) => all.push(f64::from(u8::from(*flag))),
            Value::Array(items) => items.iter().for_each(|item| add(item, all)),
            Value::Object(fields) => {
                let cost = ["iterations", "certificate"];
                let echo = ["surface_fraction", "pitch_m"];
                let left_out = [&cost[..], &echo[..]].concat();
                let fields = fields.iter();
                let fields = fields.filter(|(name, _)| !left_out.contains(&name.as_str()));
                fields.for_each(|(_, value)| add(value, all));
            }
            _ => {}
        }
    }
    let mut all = Vec::new();
    add(&serde_json::to_value(record.object()).unwrap(), &mut all);
    all
}

/// Questions that are tried in turn until a key has an effect.
fn questions(key: Key) -> &'static [Question] {
    match key {
        Key::RecedingWorkOfAdhesion => &[Question::Cycle],
        // Between rounded tops a cycle up to the transition turns before the jump onto the floor.
        Key::AdhesiveFloor => &[Question::Cycle, Question::PastTransition],
        Key::FloorContact => &[Question::Press, Question::PastTransition],
        _ => &[Question::Press, Question::Transition],
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Question {
    Press,
    Transition,
    PastTransition,
    Cycle,
}

/// The result of a case, or the reason for its refusal.
type Answer = Result<Vec<f64>, String>;

/// Solves a case.
fn answer(file: &CaseFile, question: Question) -> Answer {
    let run = Run::default();
    let load = Load::Indentation(INDENTATION);
    let refused = |error: SolveError| error.to_string();
    if file.is_surface() {
        let case = file.surface_case(1_000_000_000).map_err(|e| e.one_line())?;
        return match question {
            Question::Press => {
                let contact = case.system.press(load, &run).map_err(refused)?;
                let answer = SurfaceAnswer {
                    system: &case.system,
                    answer: &contact,
                };
                Ok(numbers(&Record::of(&answer)))
            }
            Question::Cycle => {
                let plan = CyclePlan {
                    turn: load.into(),
                    ..CyclePlan::default()
                };
                let cycle = case.system.cycle(plan, &run).map_err(refused)?;
                let answer = SurfaceAnswer {
                    system: &case.system,
                    answer: &cycle,
                };
                Ok(numbers(&Record::of(&answer)))
            }
            _ => {
                let critical = case.system.transition(&run).map_err(refused)?;
                let answer = SurfaceAnswer {
                    system: &case.system,
                    answer: &critical,
                };
                Ok(numbers(&Record::of(&answer)))
            }
        };
    }
    if file.is_flat() {
        let case = file.flat_case().map_err(|e| e.one_line())?;
        let system = &case.system;
        let contact = system.press(load, &run).map_err(refused)?;
        let answer = FlatAnswer {
            system,
            contact: &contact,
        };
        let mut found = numbers(&Record::of(&answer));
        if question == Question::Cycle {
            let plan = CyclePlan {
                turn: load.into(),
                ..CyclePlan::default()
            };
            let cycle = system.cycle(&plan, &run).map_err(refused)?;
            found.extend(cycle.pull_off.map(|contact| contact.force));
        }
        return Ok(found);
    }
    if file.is_rounded() {
        let case = file.asperity_case().map_err(|e| e.one_line())?;
        let load = match question {
            Question::PastTransition => {
                let critical = case
                    .field
                    .transition(case.accuracy, &run)
                    .map_err(refused)?;
                Load::Indentation(1.1 * critical.contact.indentation)
            }
            _ => load,
        };
        let contact = case
            .field
            .press(load, case.accuracy, &run)
            .map_err(refused)?;
        let answer = AsperityAnswer::of(&case, &contact);
        // Includes the point of application of the force, which rotates with the lattice.
        let pillars = case.field.asperities().iter().zip(&contact.asperities);
        let moment: f64 = pillars
            .map(|(asperity, state)| asperity.apex[0] * state.force)
            .sum();
        let mut found = [numbers(&Record::of(&answer)), vec![moment]].concat();
        if question == Question::Cycle {
            let plan = CyclePlan {
                turn: load.into(),
                ..CyclePlan::default()
            };
            let cycle = case
                .field
                .cycle(plan, case.accuracy, &run)
                .map_err(refused)?;
            found.extend(cycle.pull_off.map(|contact| contact.force));
        }
        return Ok(found);
    }
    let asked = match question {
        Question::Transition | Question::PastTransition => fakir::problem::Question::Transition,
        Question::Press => fakir::problem::Question::Press,
        Question::Cycle => fakir::problem::Question::Cycle,
    };
    let Case { system, method, .. } = file.case_for(&[asked]).map_err(|e| e.one_line())?;
    let press = |load| fakir::press(&system, load, method, &run).map_err(refused);
    match question {
        Question::Press => Ok(numbers(&Record::of(&press(load)?))),
        Question::Transition => {
            let critical = fakir::transition(&system, method, &run).map_err(refused)?;
            Ok(numbers(&Record::of(&critical)))
        }
        Question::PastTransition => {
            let critical = press(Load::FloorContact)?.indentation;
            let past = press(Load::Indentation(1.1 * critical))?;
            Ok(numbers(&Record::of(&past)))
        }
        Question::Cycle => {
            let cycle = fakir::cycle(&system, CyclePlan::default(), method, &run);
            let cycle = cycle.map_err(refused)?;
            let pull_off = cycle.pull_off.map_or(0.0, |it| it.force);
            Ok(vec![pull_off, cycle.turn.force, cycle.loop_area])
        }
    }
}

fn differ(one: &[f64], other: &[f64]) -> bool {
    let pairs = || one.iter().zip(other);
    one.len() != other.len() || pairs().any(|(a, b)| (a - b).abs() > 1e-9 * a.abs().max(b.abs()))
}

/// Whether a key may have no effect without a warning other than the result itself.
fn is_reported_elsewhere(key: Key, file: &CaseFile) -> bool {
    let method = file.case().map_or("", |case| case.method.name());
    // Only the spectral method has floor contact; the others give a negative gap, and a warning with the critical load.
    let is_floor = key == Key::FloorContact && method != "spectral";
    // A map may have no missing points; otherwise the case without the key is refused with their count.
    is_floor || key == Key::MissingPoints
}

/// Effect of a given key.
enum Effect {
    /// The result changes, or the case is refused by the name of the key.
    Seen,
    /// None, and this is listed.
    Listed,
    /// None.
    Ignored,
    /// The case is refused without naming the key.
    Unnamed(String),
}

/// A case with the results computed so far.
struct Base {
    file: CaseFile,
    answers: RefCell<Vec<(Question, Answer)>>,
}

impl Base {
    fn answer(&self, question: Question) -> Answer {
        let known = self
            .answers
            .borrow()
            .iter()
            .find(|(it, _)| *it == question)
            .cloned();
        let (_, answer) = known.unwrap_or_else(|| {
            let new = (question, answer(&self.file, question));
            self.answers.borrow_mut().push(new.clone());
            new
        });
        answer
    }

    /// The case with additional settings.
    fn with<S: AsRef<str>>(&self, settings: &[S]) -> Self {
        let mut file = self.file.clone();
        for setting in settings {
            file.set(setting.as_ref()).unwrap();
        }
        Self {
            file,
            answers: RefCell::default(),
        }
    }

    /// Gives a key another value.
    fn effect(&self, key: Key, value: Option<&str>, folder: &Path) -> Effect {
        let mut changed = self.file.clone();
        match value {
            Some(value) => {
                changed.set(&format!("{key}={value}")).unwrap();
                for setting in companions(key, value, folder) {
                    changed.set(&setting).unwrap();
                }
            }
            None => changed.set_number(key, other_number(key, &self.file)),
        }
        for question in questions(key) {
            match (self.answer(*question), answer(&changed, *question)) {
                // It was refused before.
                (Err(before), Err(words)) if before == words => return Effect::Seen,
                (_, Err(words)) => {
                    let mut names = words_of(key).into_iter().chain(value.map(str::to_owned));
                    return match names.any(|name| words.contains(&name)) {
                        true => Effect::Seen,
                        false => Effect::Unnamed(words),
                    };
                }
                (Err(_), Ok(_)) => return Effect::Seen,
                (Ok(one), Ok(other)) if differ(&one, &other) => return Effect::Seen,
                (Ok(_), Ok(_)) => {}
            }
        }
        let idle = changed.without_effect().unwrap();
        let is_warned_of = idle.iter().any(|(idle, _)| *idle == key);
        match is_warned_of || is_reported_elsewhere(key, &changed) {
            true => Effect::Listed,
            false => Effect::Ignored,
        }
    }
}

/// Words by which an error may refer to a key: its name, that of its table, that of the key that it depends on, or its meaning.
fn words_of(key: Key) -> Vec<String> {
    let table = key.path().split('.').next().unwrap();
    let mut words = vec![
        key.name().to_owned(),
        format!("{table}:"),
        format!("[{table}]"),
    ];
    words.extend(key.goes_with().map(|(choice, _)| choice.to_string()));
    let stands_for = match key {
        Key::Rotation => "without rotation",
        Key::Columns => "infinite",
        Key::HeightStandardDeviation | Key::VacancyFraction | Key::PillarSeed => "equal pillars",
        Key::RecedingWorkOfAdhesion => "adhesion.work",
        // A [surface] that is not flat needs a description.
        Key::Flat => "surface.height_map",
        _ => key.path(),
    };
    words.push(stands_for.to_owned());
    words
}

/// The values to try: every word except the default in effect, another file, or a number.
fn values(key: Key, is_given: bool, folder: &Path) -> Vec<Option<String>> {
    let named = |name: &str| {
        let path = folder.join(name);
        vec![Some(format!("{:?}", path.display().to_string()))]
    };
    match (key.kind(), key) {
        (Kind::Number(_), _) => vec![None],
        (Kind::Word, _) => {
            let default = match key.default() {
                Some(Setting::Word(word)) if !is_given => word,
                _ => String::new(),
            };
            let words = key.words().into_iter().filter(|word| *word != default);
            words.map(|word| Some(word.to_owned())).collect()
        }
        (Kind::Text, Key::Pillars) => named("other_pillars.csv"),
        (Kind::Text, Key::LensProfile) => named("other_profile.csv"),
        (Kind::Text, Key::HeightMap) => named("other_map.txt"),
        (Kind::Text, _) => vec![Some("other".to_owned())],
        // One of the two alone is refused; both have their effect on histories, which other tests compare.
        (Kind::List(_), Key::RelaxationTimes) => vec![Some("[\"20 s\"]".to_owned())],
        (Kind::List(_), _) => vec![Some("[1.5]".to_owned())],
    }
}

/// Faults of the keys in a case.
fn faults(text: &str) -> Vec<String> {
    let folder = folder();
    let folder = folder.path();
    let path = folder.join("case.toml");
    fs::write(&path, text).unwrap();
    let plain = Base {
        file: CaseFile::read(&path).unwrap(),
        answers: RefCell::default(),
    };
    assert!(
        plain.answer(Question::Press).is_ok(),
        "{:?}",
        plain.answer(Question::Press)
    );
    let mut faults = Vec::new();
    for key in Key::ALL {
        let is_given = text.contains(&format!("{} = ", key.name()));
        let more = contexts(key).iter().map(|settings| plain.with(settings));
        let mut bases: Vec<Base> = more.collect();
        // Also with the word that it requires, unless a case of that kind is tried separately.
        let choice = key.goes_with().filter(|(choice, words)| match choice {
            Key::MethodName => false,
            Key::Lattice => !["hexagonal", "listed"].contains(&words[0]),
            _ => true,
        });
        if let Some((choice, words)) = choice {
            let word = format!("{choice}={}", words[0]);
            let settings = [vec![word], companions(choice, words[0], folder)].concat();
            let with_word = iter::once(&plain).chain(&bases);
            let with_word: Vec<Base> = with_word.map(|base| base.with(&settings)).collect();
            bases.extend(with_word);
        }
        for (place, base) in iter::once(&plain).chain(&bases).enumerate() {
            let mut ignored = 0;
            for value in values(key, is_given, folder) {
                match base.effect(key, value.as_deref(), folder) {
                    Effect::Seen | Effect::Listed => {}
                    Effect::Ignored => ignored += 1,
                    Effect::Unnamed(words) => faults.push(format!("{key}: {words}")),
                }
            }
            // One of the words is the given one.
            if ignored > usize::from(key.kind() == Kind::Word && is_given) {
                faults.push(format!("{key} is accepted and ignored, place {place}"));
            }
        }
    }
    faults
}

fn check(cases: &[(&str, String)]) {
    let faults: Vec<String> = cases
        .iter()
        .flat_map(|(name, text)| {
            let faults = faults(text).into_iter();
            faults.map(move |fault| format!("{name}: {fault}"))
        })
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

fn pattern(arrangement: &str, method: &str) -> String {
    format!("{BODIES}{arrangement}{PILLAR}[method]\n{method}\n")
}

#[test]
fn infinite_lattices_with_the_spectral_method() {
    check(&[("infinite", pattern(INFINITE_LATTICE, SPECTRAL))]);
}

#[test]
fn finite_lattices_by_the_spectral_method() {
    check(&[("finite", pattern(FINITE, SPECTRAL))]);
}

#[test]
fn listed_pillars_by_the_spectral_method() {
    check(&[("listed", pattern(LISTED, SPECTRAL))]);
}

#[test]
fn infinite_lattices_with_boundary_elements() {
    check(&[("infinite", pattern(INFINITE_LATTICE, LOVE))]);
}

#[test]
fn finitely_many_pillars_with_boundary_elements() {
    check(&[
        ("finite", pattern(FINITE, LOVE)),
        ("listed", pattern(LISTED, LOVE)),
    ]);
}

/// These methods support infinite hexagonal lattices only, and refuse the keys of other arrangements.
#[test]
fn infinite_lattices_with_approximate_methods() {
    check(&[
        ("punch", pattern(INFINITE_LATTICE, "name = \"punch\"")),
        (
            "homogenised",
            pattern(INFINITE_LATTICE, "name = \"homogenised\""),
        ),
    ]);
}

#[test]
fn rounded_tops() {
    // Under a lens wide enough to touch several asperities.
    let bodies = BODIES.replace("500 um", "2 mm");
    check(&[("rounded", format!("{bodies}{ROUNDED}"))]);
}

#[test]
fn flat_surfaces() {
    check(&[("flat", format!("{BODIES}[surface]\nflat = true\n"))]);
}

#[test]
fn general_surfaces() {
    check(&[
        ("height map", format!("{BODIES}{MAP}")),
        ("pattern", format!("{BODIES}{PATTERN}")),
    ]);
}
