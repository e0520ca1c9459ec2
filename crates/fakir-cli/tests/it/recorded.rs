//! Commands that cover all results of the program, and their recorded output: refactoring must not change it.
//!
//! Each file of `tests/recorded` contains one command, run in the folder of the repository, and its output: the exit status, the JSON
//! result, and the saved tables if the command contains `OUT`, a folder to save in. The test of a file has its name.
//!
//! `FAKIR_RECORD=1` records again: files whose output changed by more than [`RULES`] permit are rewritten, others are left untouched. A new
//! command is a file with `{"command": "…"}` and a name in the list below; this records its output.
//!
//! `FAKIR_TOLERANCE=1e-12` compares with that relative tolerance instead of the estimated errors, for changes that must not even change
//! rounding.

use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Smallest relative tolerance: far above rounding and the residuals of converged solvers, so that a different order of summation passes,
/// and far below the effect of a wrong formula.
const TOLERANCE: f64 = 1e-6;

/// Length in m below which coordinates of points on an axis are rounding errors.
const ROUNDED_LENGTH: f64 = 1e-18;

/// Largest relative tolerance. Larger estimates occur for coarse models and meshes, which do not depend on the order of summation.
const LARGEST_TOLERANCE: f64 = 1e-2;

/// Relative tolerance of [`Rule::Rough`].
const ROUGH_TOLERANCE: f64 = 1e-2;

/// Rule for the comparison of a part of a result.
///
/// Without a rule, numbers are compared with [`TOLERANCE`], relative to the largest number of their array, or otherwise to the recorded
/// number. Integers (counts) and words must be equal.
#[derive(Clone, Copy)]
enum Rule {
    /// Not recorded.
    Ignored,
    /// Compared with [`ROUGH_TOLERANCE`].
    Rough,
    /// Compared with the first of these relative error estimates that the result contains, between [`TOLERANCE`] and [`LARGEST_TOLERANCE`].
    Estimated(&'static [&'static str]),
    /// The same, but relative to the indentation.
    OfIndentation,
}

use Rule::{Estimated, Ignored, OfIndentation, Rough};

/// Rules by name; the first match applies. A name matches the end of a path of names; `*end` matches the end of a name, and `*part*` a path
/// that contains it.
const RULES: &[(Rule, &[&str])] = &[
    // These depend on the machine, the time and the release.
    (
        Ignored,
        &["*time_s", "folder", "fakir_version", "citations.version"],
    ),
    // Effort: a different order of summation may change the number of steps. `cargo xtask test instructions` counts instructions instead.
    (Ignored, &["iterations", "solutions"]),
    // Residuals at convergence, and the energy balance of a cycle: rounding. Tests of the solvers bound them.
    (Ignored, &["certificate"]),
    // Differences of nearly equal numbers, and probabilities, which are exponentials of such differences.
    (
        Rough,
        &[
            "*error*",
            "*residual*",
            "*difference*",
            "*deviation*",
            "*p_value",
        ],
    ),
    // Quantities with their own estimate; their reduced forms have the same relative error.
    (Estimated(&["share"]), &["floor.share", "floor.force_N"]),
    (Estimated(&["contact_area"]), &["floor.contact_area_m2"]),
    (
        Estimated(&["floor_share"]),
        &["floor_share", "floor_force_N"],
    ),
    (
        Estimated(&["floor_contact_area"]),
        &["floor_contact_area_m2"],
    ),
    (
        Estimated(&["critical_force", "force"]),
        &["critical_force_N"],
    ),
    (
        Estimated(&["critical_indentation", "indentation"]),
        &["critical_indentation_m"],
    ),
    (
        Estimated(&["contact_radius"]),
        &[
            "contact_radius_m",
            "critical_contact_radius_m",
            "normalized.contact_radius",
            "normalized_contact_radius",
        ],
    ),
    (
        Estimated(&["top_contact_radius", "contact_radius"]),
        &["top_contact_radius_m"],
    ),
    (
        Estimated(&["indentation"]),
        &[
            "indentation_m",
            "normalized.indentation",
            "normalized_indentation",
        ],
    ),
    (
        Estimated(&["pull_off_force"]),
        &["pull_off_force_N", "normalized_pull_off_force"],
    ),
    (
        Estimated(&["hysteresis"]),
        &["hysteresis_J", "normalized_hysteresis"],
    ),
    // Areas of the same loop, summed differently.
    (
        Estimated(&["hysteresis"]),
        &["work_of_separation_J", "dissipation_J"],
    ),
    // Forces on pillars, which add up to the total force, and limits that depend on the largest pillar force.
    (
        Estimated(&["pull_off_force"]),
        &[
            "pull-off-pillars.csv.force_N",
            "limits.kendall_strain.value",
        ],
    ),
    (
        Estimated(&["force"]),
        &[
            "force_N",
            "normalized.force",
            "normalized_force",
            "limits.pillar_stress.value",
            "limits.buckling.value",
        ],
    ),
    // Limits in closed form that depend on the contact radius.
    (
        Estimated(&["contact_radius"]),
        &[
            "limits.slope.value",
            "limits.contact_radius_over_lens_radius.value",
            "*_percent_m.value",
            "*_percent_J_per_m2.value",
        ],
    ),
    // A difference between the pillar height and displacements, which are of the order of the indentation.
    (OfIndentation, &["smallest_floor_gap_m"]),
];

/// The rule for a path of names, such as `answer.limits.slope.value`.
fn rule(path: &str) -> Option<Rule> {
    let matches = |name: &&str| {
        let end = name.trim_matches('*');
        if name.ends_with('*') {
            path.contains(end)
        } else if name.starts_with('*') {
            path.ends_with(end)
        } else {
            path.strip_suffix(name)
                .is_some_and(|before| before.ends_with('.'))
        }
    };
    let (rule, _) = RULES.iter().find(|(_, names)| names.iter().any(matches))?;
    Some(*rule)
}

/// The path of a part of a value. Parts of lists with a name are identified by it; others have the path of the list.
fn path_of(path: &str, key: Option<&str>, part: &Value) -> String {
    match key.or_else(|| part.get("name").and_then(Value::as_str)) {
        Some(name) => format!("{path}.{name}"),
        None => path.to_owned(),
    }
}

/// Removes the parts of a result that are not recorded.
fn remove_ignored(path: &str, value: &mut Value) {
    match value {
        Value::Object(members) => {
            members.retain(|name, _| !matches!(rule(&format!("{path}.{name}")), Some(Ignored)));
            for (name, part) in members {
                remove_ignored(&path_of(path, Some(name), part), part);
            }
        }
        Value::Array(values) => {
            for part in values {
                remove_ignored(&path_of(path, None, part), part);
            }
        }
        _ => {}
    }
}

/// Comparison of a recorded result with a current one.
struct Comparison {
    /// The relative tolerance that replaces all others.
    tight: Option<f64>,
    /// Whether names that are not recorded count as differences.
    complete: bool,
    differences: Vec<String>,
}

/// Location of a number.
struct Place<'a> {
    path: &'a str,
    /// The objects around it in the recorded result, from outside to inside.
    around: &'a [&'a Value],
    /// Its index in an array of numbers, and the largest number of that array.
    index: Option<usize>,
    largest: f64,
}

impl Place<'_> {
    /// The number with a name in an object, or with the same index in its column.
    fn beside(&self, object: &Value, name: &str) -> Option<f64> {
        let value = object.get(name)?;
        let value = value.get("numerical").unwrap_or(value);
        self.index
            .and_then(|index| value.get(index))
            .unwrap_or(value)
            .as_f64()
    }

    /// The closest enclosing relative error estimate of a quantity.
    fn estimate(&self, quantity: &str) -> Option<f64> {
        self.around.iter().rev().find_map(|object| {
            object
                .get("relative_error_estimate")
                .and_then(|estimates| self.beside(estimates, quantity))
                .or_else(|| self.beside(object, &format!("{quantity}_error_estimate")))
                .or_else(|| self.beside(object, &format!("relative_error_estimate_{quantity}")))
        })
    }

    /// Largest accepted difference from the recorded number.
    fn allowed(&self, recorded: f64, tight: Option<f64>) -> f64 {
        let rule = rule(self.path);
        if let Some(tight) = tight {
            let relative = match rule {
                // Numbers with the rule `Rough` may have lost up to six digits.
                Some(Rough) => (tight * 1e6).min(ROUGH_TOLERANCE).max(tight),
                _ => tight,
            };
            return relative * self.largest;
        }
        let (relative, scale) = match rule {
            Some(Rough) => return ROUGH_TOLERANCE * self.largest,
            Some(Estimated(quantities)) => {
                let estimate = quantities
                    .iter()
                    .find_map(|quantity| self.estimate(quantity));
                (estimate.unwrap_or(0.0), recorded.abs())
            }
            Some(OfIndentation) => {
                let mut objects = self.around.iter().rev();
                let indentation = objects.find_map(|object| self.beside(object, "indentation_m"));
                let estimate = self.estimate("indentation").unwrap_or(0.0);
                (estimate.max(TOLERANCE), indentation.unwrap_or(0.0).abs())
            }
            _ => (0.0, 0.0),
        };
        let absolute = if self.path.ends_with("_m") {
            ROUNDED_LENGTH
        } else {
            0.0
        };
        let relative = relative.min(LARGEST_TOLERANCE) * scale;
        relative.max(TOLERANCE * self.largest).max(absolute)
    }
}

impl Comparison {
    fn values(&mut self, path: &str, around: &[&Value], before: &Value, now: &Value) {
        match (before, now) {
            (Value::Object(members), Value::Object(now)) => {
                let around = [around, &[before]].concat();
                for (name, part) in members {
                    let path = path_of(path, Some(name), part);
                    match now.get(name) {
                        Some(now) => self.values(&path, &around, part, now),
                        None => self.differences.push(format!("{path} is missing")),
                    }
                }
                let mut new = now.keys().filter(|name| !members.contains_key(*name));
                if let (true, Some(name)) = (self.complete, new.next()) {
                    self.differences.push(format!("{path}.{name} is new"));
                }
            }
            (Value::Array(before), Value::Array(now)) if before.len() == now.len() => {
                // Numbers of one array are of the same kind: a number that is zero up to rounding is not a difference.
                let numbers = before.iter().filter_map(Value::as_f64);
                let largest = numbers.fold(0.0, |largest: f64, number| largest.max(number.abs()));
                for (index, (before, now)) in before.iter().zip(now).enumerate() {
                    if before.is_number() {
                        let index = Some(index);
                        let place = Place {
                            path,
                            around,
                            index,
                            largest,
                        };
                        self.numbers(&place, before, now);
                    } else {
                        self.values(&path_of(path, None, before), around, before, now);
                    }
                }
            }
            (Value::Number(number), _) => {
                let largest = number.as_f64().unwrap().abs();
                let place = Place {
                    path,
                    around,
                    index: None,
                    largest,
                };
                self.numbers(&place, before, now);
            }
            _ if before == now => {}
            _ => self
                .differences
                .push(format!("{path}: {before} before, {now} now")),
        }
    }

    fn numbers(&mut self, place: &Place<'_>, before: &Value, now: &Value) {
        let counts = [before, now]
            .iter()
            .all(|value| value.is_u64() || value.is_i64());
        let how = match (before.as_f64(), now.as_f64()) {
            (Some(recorded), Some(number)) if !counts => {
                let allowed = place.allowed(recorded, self.tight);
                let difference = (recorded - number).abs();
                if difference <= allowed {
                    return;
                }
                format!(": they differ by {difference:.1e}, {allowed:.1e} is allowed")
            }
            _ if before == now => return,
            _ => String::new(),
        };
        let at = place
            .index
            .map_or_else(String::new, |index| format!("[{index}]"));
        let path = place.path;
        self.differences
            .push(format!("{path}{at}: {before} before, {now} now{how}"));
    }
}

/// Differences between a recorded result and a current one; with `complete`, including new names.
fn differences(before: &Value, now: &Value, tight: Option<f64>, complete: bool) -> Vec<String> {
    let mut comparison = Comparison {
        tight,
        complete,
        differences: Vec::new(),
    };
    // Estimates for tables are found in the result.
    comparison.values("", &[&before["answer"]], before, now);
    comparison.differences
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recorded")
}

/// Runs a command: exit status, JSON result, and saved tables.
fn answer(command: &str) -> Value {
    let saved = tempfile::TempDir::new().unwrap();
    let out = saved.path().join("out");
    let words = command.split_whitespace().map(|word| match word {
        "OUT" => out.as_os_str(),
        word => word.as_ref(),
    });
    let quiet = (!command.starts_with("cite")).then_some("--quiet");
    let output = Command::new(env!("CARGO_BIN_EXE_fakir"))
        .args(words)
        .arg("--json")
        .args(quiet)
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let answer = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    let mut tables = Map::new();
    for entry in std::fs::read_dir(&out).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "csv") {
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            tables.insert(name, table(&std::fs::read_to_string(&path).unwrap()));
        }
    }
    let mut whole = json!({
        "command": command,
        "status": output.status.code(),
        "answer": answer,
        "tables": tables,
    });
    remove_ignored("", &mut whole);
    whole
}

/// The columns of a table by name.
fn table(text: &str) -> Value {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names = lines.next().unwrap_or_default().split(',');
    let mut columns: Vec<(&str, Vec<Value>)> = names.map(|name| (name, Vec::new())).collect();
    for line in lines {
        for (cell, (_, column)) in line.split(',').zip(&mut columns) {
            // Counts, numbers and words as in JSON.
            let value = serde_json::from_str(cell).ok().filter(Value::is_number);
            column.push(value.unwrap_or_else(|| json!(cell)));
        }
    }
    columns
        .into_iter()
        .map(|(name, column)| (name.to_owned(), Value::Array(column)))
        .collect::<Map<_, _>>()
        .into()
}

/// A value as JSON, with one line for each part that contains no list or object: one line per row or column.
fn layout(value: &Value, indent: usize) -> String {
    let (open, parts, close) = match value {
        Value::Object(members) => {
            let named = members
                .iter()
                .map(|(name, part)| (format!("{}: ", json!(name)), part));
            ('{', named.collect::<Vec<_>>(), '}')
        }
        Value::Array(parts) => (
            '[',
            parts.iter().map(|part| (String::new(), part)).collect(),
            ']',
        ),
        _ => return value.to_string(),
    };
    if !parts
        .iter()
        .any(|(_, part)| part.is_object() || part.is_array())
    {
        return value.to_string();
    }
    let inner = indent + 2;
    let lines: Vec<String> = parts
        .iter()
        .map(|(name, part)| format!("{:inner$}{name}{}", "", layout(part, inner)))
        .collect();
    format!("{open}\n{}\n{:indent$}{close}", lines.join(",\n"), "")
}

/// A complete recorded file, with the command first.
fn file(whole: &Value) -> String {
    let parts = ["command", "status", "answer", "tables"]
        .map(|name| format!("  \"{name}\": {}", layout(&whole[name], 2)));
    format!("{{\n{}\n}}\n", parts.join(",\n"))
}

fn check(name: &str) {
    let path = folder().join(format!("{name}.json"));
    let before: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    let command = before["command"].as_str().unwrap();
    let now = answer(command);
    let recording = std::env::var_os("FAKIR_RECORD").is_some();
    assert!(
        recording || !before["status"].is_null(),
        "no answer of fakir {command} is recorded: FAKIR_RECORD=1 does that"
    );
    let tight = std::env::var("FAKIR_TOLERANCE").map(|text| text.parse().expect("a number"));
    let found = differences(&before, &now, tight.ok(), recording);
    if !found.is_empty() && recording {
        std::fs::write(path, file(&now)).unwrap();
    } else {
        assert!(found.is_empty(), "fakir {command}\n{}", found.join("\n"));
    }
}

/// One test per file. Tests marked `slow` take more than 1.5 s of processor time in a release build.
macro_rules! recorded {
    ($($name:ident $($slow:ident)?,)*) => {
        const NAMES: &[&str] = &[$(stringify!($name)),*];

        $(recorded!(@test $name $($slow)?);)*
    };
    (@test $name:ident) => {
        #[test]
        fn $name() {
            check(stringify!($name));
        }
    };
    (@test $name:ident slow) => {
        #[test]
        #[ignore = "slow"]
        fn $name() {
            check(stringify!($name));
        }
    };
}

recorded! {
    adhesive_approach,
    adhesive_compare,
    adhesive_cycle,
    adhesive_cycle_by_force,
    adhesive_cycle_by_machine,
    adhesive_cycle_receding_work,
    adhesive_design_spread,
    adhesive_press,
    adhesive_press_by_tension_refused,
    adhesive_sweep_pull_off,
    adhesive_theory,
    adhesive_transition,
    adhesive_transition_attraction_range,
    approach_default,
    approach_homogenised,
    approach_past_transition,
    approach_past_transition_without_floor,
    approach_rigid_offset,
    cite_case,
    cite_surface,
    compare_default,
    compare_rigid,
    design_pitch,
    design_surface_fraction_with_spread,
    design_tolerances,
    design_unattainable,
    fit_modulus slow,
    fit_modulus_with_errors_given slow,
    flat_approach,
    flat_cycle,
    flat_cycle_machine_punch,
    flat_press,
    flat_press_film,
    flat_transition_refused,
    press_bem,
    press_bem_by_force,
    press_by_force,
    press_hexagonal_square_pillars_without_compliance,
    press_homogenised_by_force,
    press_one_pillar,
    press_past_transition,
    press_past_transition_without_floor,
    press_punch_by_force,
    press_punch_plain,
    press_random_square_pillars,
    press_rigid_by_force,
    press_short_of_contact,
    press_short_of_contact_turned,
    press_soft_accurate,
    press_square_pillars,
    press_square_pillars_by_force,
    press_square_pillars_coarse,
    press_with_fields,
    press_with_fields_without_floor,
    sweep_surface_fraction,
    theory_default,
    theory_one_pillar,
    theory_soft,
    transition_accurate,
    transition_bem,
    transition_bem_offset,
    transition_homogenised,
    transition_low_pillars,
    transition_offset_between_two_pillars,
    transition_offset_half_a_pitch,
    transition_offset_turned_without_compliance,
    transition_one_pillar,
    transition_punch,
    transition_punch_plain,
    transition_rigid,
    transition_rounded_square_pillars_refused,
    transition_small_lens,
    transition_soft,
    transition_soft_dense,
    transition_square_pillars,
    transition_wide_lattice,
    transition_with_fields,
    verify_press_by_force,
    verify_press_by_indentation,
}

#[test]
fn every_file_has_a_test() {
    let files: BTreeSet<String> = std::fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    let tests: BTreeSet<String> = NAMES.iter().map(|name| format!("{name}.json")).collect();
    assert_eq!(files, tests);
}

/// A contact with one changed number, and whether that is a difference.
#[test]
fn numbers_are_compared_within_their_errors() {
    let before = json!({
        "answer": {
            "force_N": 1.0,
            "indentation_m": 2.0,
            "contact_radius_m": 3.0,
            "smallest_floor_gap_m": 1e-3,
            "pillars_in_contact": 19,
            "limits": [{ "name": "slope", "value": 0.1 }],
            "relative_error_estimate": { "force": 1e-4, "indentation": 0.0, "contact_radius": 0.5 },
        },
        "tables": {
            "pillars.csv": { "force_N": [1.0, 0.5], "x_m": [1.0, 0.0], "status": ["full", "full"] },
            "approach.csv": { "force_N": [1.0, 2.0], "force_error_estimate": [1e-3, 1e-5] },
        },
    });
    for (place, now, differs) in [
        ("/answer/force_N", json!(1.00009), false),
        ("/answer/force_N", json!(1.00011), true),
        ("/answer/indentation_m", json!(2.0000019), false),
        ("/answer/indentation_m", json!(2.0000021), true),
        ("/answer/contact_radius_m", json!(3.029), false),
        ("/answer/contact_radius_m", json!(3.031), true),
        ("/answer/smallest_floor_gap_m", json!(1.0019e-3), false),
        ("/answer/smallest_floor_gap_m", json!(1.0021e-3), true),
        ("/answer/pillars_in_contact", json!(20), true),
        ("/answer/limits/0/value", json!(0.1009), false),
        ("/answer/limits/0/value", json!(0.1011), true),
        (
            "/answer/relative_error_estimate/force",
            json!(1.009e-4),
            false,
        ),
        (
            "/answer/relative_error_estimate/force",
            json!(1.011e-4),
            true,
        ),
        ("/answer/force_N", json!(null), true),
        ("/tables/pillars.csv/force_N/1", json!(0.50004), false),
        ("/tables/pillars.csv/force_N/1", json!(0.50006), true),
        ("/tables/pillars.csv/x_m/1", json!(9e-7), false),
        ("/tables/pillars.csv/x_m/1", json!(1.1e-6), true),
        ("/tables/pillars.csv/status/1", json!("partial"), true),
        ("/tables/approach.csv/force_N/0", json!(1.0009), false),
        ("/tables/approach.csv/force_N/1", json!(2.00003), true),
    ] {
        let mut after = before.clone();
        *after.pointer_mut(place).unwrap() = now.clone();
        let found = differences(&before, &after, None, false);
        assert_eq!(!found.is_empty(), differs, "{place}: {now}");
    }
    let mut after = before.clone();
    after["answer"]["new"] = json!(1);
    assert_eq!(differences(&before, &after, None, false), [""; 0]);
    assert_eq!(differences(&before, &after, None, true).len(), 1);
    assert_eq!(differences(&after, &before, None, false).len(), 1);
}
