//! Whether the rooms of the crate `fakir` use only what is below them, and no file itself by way of others; and whether any crate compares numbers in a way
//! that ends the program where one of them is NaN.
//!
//! Tests at the end of a file may use anything.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

/// Rooms from the ground up, and the files above them all.
const ROOMS: [&str; 10] = [
    "numerics",
    "problem",
    "halfspace",
    "state",
    "theory",
    "solve",
    "method",
    "verify",
    "kernels",
    "lib",
];

/// A module by its path, such as `state::fields`, and the modules it uses.
type Uses = BTreeMap<String, BTreeSet<String>>;

/// The check.
pub(crate) fn check(_cargo: &OsStr) -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/fakir/src");
    let mut files = Vec::new();
    collect(&root, &mut files)?;
    let mut texts = BTreeMap::new();
    for file in &files {
        let text =
            fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
        texts.insert(module_of(&root, file), text);
    }
    // Files that are there for tests only.
    let for_tests: Vec<String> = texts
        .iter()
        .flat_map(|(module, text)| tests_of(module, text))
        .collect();
    texts.retain(|module, _| !for_tests.contains(module));
    let facades: BTreeSet<String> = files
        .iter()
        .filter(|file| file.ends_with("mod.rs"))
        .map(|file| module_of(&root, file))
        .collect();
    let modules: BTreeSet<String> = texts.keys().cloned().collect();
    let uses: Uses = texts
        .iter()
        .map(|(module, text)| (module.clone(), used(module, text, &modules, &facades)))
        .collect();
    let mut problems = problems(&uses);
    problems.extend(unchecked_comparisons()?);
    if problems.is_empty() {
        let arrows: usize = uses.values().map(BTreeSet::len).sum();
        println!(
            "{} files, {arrows} arrows, all of them downward",
            uses.len()
        );
        Ok(())
    } else {
        Err(problems.join("\n"))
    }
}

/// Comparisons of all crates that end the program where a number is NaN.
fn unchecked_comparisons() -> Result<Vec<String>, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    for folder in ["crates", "checks", "xtask"] {
        collect(&root.join(folder), &mut files)?;
    }
    let is_test = |path: &Path| {
        let mut names = path.components().map(std::path::Component::as_os_str);
        names.any(|name| name == "tests" || name == "tests.rs" || name == "target")
    };
    let mut problems = Vec::new();
    for file in &files {
        let inside = file.strip_prefix(&root).unwrap_or(file);
        if is_test(inside) {
            continue;
        }
        let text =
            fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
        let found = comparisons(&text).into_iter();
        problems
            .extend(found.map(|(line, advice)| format!("{}:{line}: {advice}", inside.display())));
    }
    Ok(problems)
}

/// Lines, from 1, of comparisons that end the program where a number is NaN, each with what to write instead. `f64::clamp` also does where its bounds are
/// exchanged: only bounds that are constants are passed.
fn comparisons(text: &str) -> Vec<(usize, &'static str)> {
    let code: Vec<&str> = text
        .split("#[cfg(test)]\nmod tests {")
        .next()
        .unwrap_or_default()
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect();
    let code = code.join("\n");
    let line = |place: usize| code[..place].matches('\n').count() + 1;
    let mut found = Vec::new();
    for (place, name) in code.match_indices("partial_cmp") {
        if code[place + name.len()..].starts_with('(') && !code[..place].ends_with("fn ") {
            found.push((line(place), "partial_cmp: use total_cmp"));
        }
    }
    for (place, name) in code.match_indices(".clamp(") {
        if !is_constant(inside_parentheses(&code[place + name.len()..])) {
            let advice = "clamp by a bound that is computed: use numerics::convergence::clamped, or max and min of whole numbers";
            found.push((line(place), advice));
        }
    }
    found
}

/// The text up to the parenthesis that closes.
fn inside_parentheses(text: &str) -> &str {
    let mut depth = 1;
    let end = text.find(|c: char| {
        depth += match c {
            '(' => 1,
            ')' => -1,
            _ => 0,
        };
        depth == 0
    });
    &text[..end.unwrap_or(text.len())]
}

/// Whether an expression is of numbers and constants alone, whose names are in capitals.
fn is_constant(expression: &str) -> bool {
    let separators = |c: char| !(c.is_alphanumeric() || c == '_' || c == '.' || c == ':');
    expression.split(separators).all(|word| {
        let name = word.rsplit("::").next().unwrap_or_default();
        name.starts_with(|c: char| c.is_ascii_digit()) || !name.contains(|c: char| c.is_lowercase())
    })
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), String> {
    let entries = fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    for entry in entries {
        let path = entry.map_err(|error| error.to_string())?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

fn module_of(root: &Path, file: &Path) -> String {
    let inside = file.strip_prefix(root).unwrap_or(file).with_extension("");
    let words: Vec<String> = inside
        .iter()
        .map(|word| word.to_string_lossy().into_owned())
        .filter(|word| word != "mod")
        .collect();
    words.join("::")
}

/// The modules that a facade has for tests only.
fn tests_of(module: &str, text: &str) -> Vec<String> {
    let lines: Vec<&str> = text.lines().collect();
    let pairs = lines
        .windows(2)
        .filter(|pair| pair[0].trim() == "#[cfg(test)]");
    pairs
        .filter_map(|pair| pair[1].trim().strip_prefix("mod ")?.strip_suffix(';'))
        .map(|name| format!("{module}::{name}"))
        .collect()
}

/// The modules that a text uses, its tests aside.
fn used(
    module: &str,
    text: &str,
    modules: &BTreeSet<String>,
    facades: &BTreeSet<String>,
) -> BTreeSet<String> {
    let code: String = text
        .split("#[cfg(test)]")
        .next()
        .unwrap_or_default()
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect::<Vec<_>>()
        .join(" ");
    // `super` of a facade is the folder around it, that of a file the facade beside it.
    let mut parent: Vec<&str> = module.split("::").collect();
    parent.pop();
    let mut found = BTreeSet::new();
    for (start, word) in [("crate::", Vec::new()), ("super::", parent)] {
        for (place, _) in code.match_indices(start) {
            let before = code[..place].chars().next_back();
            if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                continue;
            }
            for path in paths(&code[place + start.len()..]) {
                let mut words = word.clone();
                for part in path.split("::") {
                    if part == "super" {
                        words.pop();
                    } else {
                        words.push(part);
                    }
                }
                let target = (1..=words.len())
                    .rev()
                    .map(|length| words[..length].join("::"))
                    .find(|path| modules.contains(path));
                // The crate itself: what its root hands out again.
                let target = target.unwrap_or_else(|| "lib".to_owned());
                if target != module {
                    found.insert(target);
                }
            }
        }
    }
    // A facade hands out what is in its files, and names them without a path.
    if facades.contains(module) || module == "lib" {
        let prefix = if module == "lib" {
            String::new()
        } else {
            format!("{module}::")
        };
        found.extend(
            modules
                .iter()
                .filter(|other| {
                    other
                        .strip_prefix(&prefix)
                        .is_some_and(|rest| !rest.contains("::"))
                        && *other != module
                })
                .cloned(),
        );
    }
    found
}

/// The paths that begin here: one, or all of a group in braces.
fn paths(text: &str) -> Vec<String> {
    let end = text
        .find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'))
        .unwrap_or(text.len());
    let path = text[..end].to_owned();
    if !path.ends_with("::") || !text[end..].starts_with('{') {
        return vec![path.trim_end_matches("::").to_owned()];
    }
    let mut depth = 0;
    let mut inside = String::new();
    let mut found = Vec::new();
    for c in text[end..].chars() {
        match c {
            '{' => {
                depth += 1;
                if depth == 1 {
                    continue;
                }
            }
            '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 || (depth == 1 && c == ',') {
            let piece = inside.trim();
            if !piece.is_empty() {
                found.extend(paths(piece).into_iter().map(|rest| format!("{path}{rest}")));
            }
            inside.clear();
            if depth == 0 {
                break;
            }
        } else {
            inside.push(c);
        }
    }
    found
}

fn floor_of(module: &str) -> usize {
    let room = module.split("::").next().unwrap_or_default();
    ROOMS
        .iter()
        .position(|name| *name == room)
        .unwrap_or(ROOMS.len())
}

/// Upward arrows, and files that use themselves by way of others.
fn problems(uses: &Uses) -> Vec<String> {
    let mut problems = Vec::new();
    for (module, targets) in uses {
        if floor_of(module) == ROOMS.len() {
            problems.push(format!(
                "{module} is in no room: add it to the list of rooms"
            ));
        }
        for target in targets {
            if floor_of(target) > floor_of(module) {
                problems.push(format!("{module} uses {target}, which is above it"));
            }
        }
    }
    // Taking away what uses nothing that is left, again and again, leaves the circles and what leads to them.
    let mut left: Uses = uses.clone();
    loop {
        let names: BTreeSet<String> = left.keys().cloned().collect();
        let before = left.len();
        left.retain(|_, targets| targets.iter().any(|target| names.contains(target)));
        if left.len() == before {
            break;
        }
    }
    // And the other way round, what nothing left uses.
    loop {
        let wanted: BTreeSet<String> = left.values().flatten().cloned().collect();
        let before = left.len();
        left.retain(|module, _| wanted.contains(module));
        if left.len() == before {
            break;
        }
    }
    if !left.is_empty() {
        let names: Vec<String> = left.keys().cloned().collect();
        for (module, targets) in &left {
            let inside: Vec<&str> = targets
                .iter()
                .filter(|target| names.contains(target))
                .map(String::as_str)
                .collect();
            problems.push(format!("in a circle: {module} uses {}", inside.join(", ")));
        }
    }
    problems
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(list: &[&str]) -> BTreeSet<String> {
        list.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn finds_what_is_used() {
        let modules = names(&[
            "numerics",
            "numerics::vector",
            "state",
            "state::run",
            "state::error",
        ]);
        let facades = names(&["numerics", "state"]);
        let text = "use super::error::SolveError;\nuse crate::numerics::{vector::{dot, Lanes}};\n\
                    // crate::solve\n#[cfg(test)] use crate::solve::newton;";
        let found = used("state::run", text, &modules, &facades);
        assert_eq!(found, names(&["numerics::vector", "state::error"]));
    }

    #[test]
    fn finds_comparisons_that_nan_ends() {
        let text = "a.partial_cmp(&b).unwrap();\n// c.clamp(d, e)\nx.clamp(0.0, 1e5 - Self::MOST_SIDES);\n\
                    x.abs()\n    .clamp(\n        least(0.5),\n        1.0,\n    );\nn.clamp(1, 2_000);\n\
                    fn partial_cmp(&self) {}\n#[cfg(test)]\nmod tests { x.clamp(a, b) }";
        let lines: Vec<usize> = comparisons(text).iter().map(|found| found.0).collect();
        assert_eq!(lines, [1, 5]);
        assert!(!is_constant("0.1 * target, target") && is_constant("-1e-12, DIGITS"));
    }

    #[test]
    fn tells_upward_arrows_and_circles() {
        let uses = |list: &[(&str, &[&str])]| -> Uses {
            list.iter()
                .map(|(module, targets)| ((*module).to_owned(), names(targets)))
                .collect()
        };
        let good = uses(&[
            ("state::run", &["numerics::vector"]),
            ("numerics::vector", &[]),
        ]);
        assert!(problems(&good).is_empty());
        let upward = uses(&[("numerics::vector", &["state::run"]), ("state::run", &[])]);
        assert_eq!(problems(&upward).len(), 1);
        let circle = uses(&[
            ("state::a", &["state::b"]),
            ("state::b", &["state::a"]),
            ("state::c", &["state::a"]),
        ]);
        assert_eq!(problems(&circle).len(), 2);
    }
}
