//! Imports of a module of a crate in Rust, except for its tests.

use super::tree::{Imports, Path};
use std::collections::{BTreeMap, BTreeSet};

/// Imports of a module, and its submodules for tests only.
pub(super) struct Module {
    pub(super) imports: Imports,
    pub(super) for_tests: Vec<Path>,
}

/// Reads the module `own` of a crate that has some modules.
///
/// Items that it only re-exports, as facades do, and modules that it only declares, are not included.
pub(super) fn module(own: &[String], text: &str, modules: &BTreeSet<Path>) -> Module {
    let all = tokens(text);
    let (code, for_tests) = without_tests(&all);
    let for_tests = for_tests.into_iter();
    let for_tests = for_tests.map(|name| below(own, name)).collect();
    let mut here = Here {
        own,
        modules,
        local: BTreeMap::new(),
    };
    let (imported, rest) = split(&code);
    let mut imports = Imports::default();
    for import in imported {
        let path = here.path(&import.path);
        if let Some(path) = &path {
            if !import.is_public || rest.contains(&import.name) {
                imports.uses.push(path.clone());
            }
            here.local.insert(import.name, path.clone());
        }
        imports.names.insert(import.name.to_owned(), path);
    }
    imports.uses.extend(here.paths(&rest));
    Module { imports, for_tests }
}

fn below(module: &[String], name: &str) -> Path {
    [module, &[name.to_owned()]].concat()
}

/// Resolution of names in a module.
struct Here<'a> {
    own: &'a [String],
    modules: &'a BTreeSet<Path>,
    /// Imports by their local names.
    local: BTreeMap<&'a str, Path>,
}

impl Here<'_> {
    /// A path from the root of the crate; `None` for other crates, and for items that are defined here.
    fn path(&self, words: &[&str]) -> Option<Path> {
        let mut path = match words.first()? {
            &"crate" => Vec::new(),
            &"super" | &"self" => self.own.to_vec(),
            first => match self.local.get(first) {
                Some(path) => path.clone(),
                None => Some(below(self.own, first)).filter(|path| self.modules.contains(path))?,
            },
        };
        let is_up = |word: &&&str| matches!(**word, "super" | "self");
        let ups = words.iter().take_while(is_up).count();
        for _ in words[..ups].iter().filter(|word| **word == "super") {
            path.pop();
        }
        let rest = words[ups.max(1)..].iter();
        path.extend(rest.map(|word| (*word).to_owned()));
        Some(path)
    }

    /// The paths of several names in some code.
    fn paths(&self, code: &[&str]) -> Vec<Path> {
        let mut found = Vec::new();
        let mut place = 0;
        while place < code.len() {
            let mut words = vec![code[place]];
            let is_start = place == 0 || !["::", "."].contains(&code[place - 1]);
            place += 1;
            while is_name(words[0])
                && code.get(place) == Some(&"::")
                && code.get(place + 1).is_some_and(|word| is_name(word))
            {
                words.push(code[place + 1]);
                place += 2;
            }
            if is_start && words.len() > 1 {
                found.extend(self.path(&words));
            }
        }
        found
    }
}

/// An imported item.
struct Import<'a> {
    path: Vec<&'a str>,
    /// Its local name: `*` for all items of a module.
    name: &'a str,
    is_public: bool,
}

/// Imports of some code, and the code without them and without declarations of modules.
fn split<'a>(code: &[&'a str]) -> (Vec<Import<'a>>, Vec<&'a str>) {
    let (mut imported, mut rest) = (Vec::new(), Vec::new());
    let mut place = 0;
    while place < code.len() {
        match &code[place..] {
            ["use", ..] => {
                let is_public = place > 0 && ["pub", ")"].contains(&code[place - 1]);
                let mut names = Vec::new();
                place = leaves(code, place + 1, &[], &mut names);
                imported.extend(names.into_iter().map(|(path, name)| Import {
                    path,
                    name,
                    is_public,
                }));
            }
            ["mod", _, ";", ..] => place += 3,
            _ => {
                rest.push(code[place]);
                place += 1;
            }
        }
    }
    (imported, rest)
}

/// Adds the paths of a tree of imports that starts at a place, below a prefix, each with its local name; returns the place after it.
fn leaves<'a>(
    code: &[&'a str],
    mut place: usize,
    above: &[&'a str],
    found: &mut Vec<(Vec<&'a str>, &'a str)>,
) -> usize {
    let mut path = above.to_vec();
    while place < code.len() {
        match code[place] {
            "{" => {
                place += 1;
                while place < code.len() && code[place] != "}" {
                    place = leaves(code, place, &path, found);
                    place += usize::from(code.get(place) == Some(&","));
                }
                return place + 1;
            }
            "*" => {
                found.push((path, "*"));
                return place + 1;
            }
            "::" => place += 1,
            word if is_name(word) => {
                // `self` in braces is the module itself.
                if word != "self" || path.is_empty() {
                    path.push(word);
                }
                place += 1;
                let mut name = path.last().copied().unwrap_or(word);
                if code.get(place) == Some(&"as") {
                    name = code.get(place + 1).copied().unwrap_or(name);
                    place += 2;
                }
                if code.get(place) != Some(&"::") {
                    found.push((path, name));
                    return place;
                }
            }
            _ => break,
        }
    }
    place
}

/// Code without the items that are compiled for tests only, and the names of modules among these.
fn without_tests<'a>(code: &[&'a str]) -> (Vec<&'a str>, Vec<&'a str>) {
    const FOR_TESTS: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let (mut kept, mut modules) = (Vec::new(), Vec::new());
    let mut place = 0;
    while place < code.len() {
        if !code[place..].starts_with(&FOR_TESTS) {
            kept.push(code[place]);
            place += 1;
            continue;
        }
        place += FOR_TESTS.len();
        while code.get(place) == Some(&"#") {
            place = behind(code, place, |word| word == "]");
        }
        // After `pub(crate)` and the like.
        let mut first = code[place..].iter().take(5);
        let is_import = first.find(|word| ["use", "mod"].contains(*word)) == Some(&"use");
        let end = behind(code, place, |word| word == ";" || word == "}" && !is_import);
        if let [.., "mod", name, ";"] = &code[place..end] {
            modules.push(*name);
        }
        place = end;
    }
    (kept, modules)
}

/// The place after the first terminator outside of all parentheses.
fn behind(code: &[&str], start: usize, is_end: impl Fn(&str) -> bool) -> usize {
    let mut depth = 0;
    for (place, word) in code.iter().enumerate().skip(start) {
        match *word {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        if depth <= 0 && is_end(word) {
            return place + 1;
        }
    }
    code.len()
}

fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// The tokens of a text, without comments and string literals.
fn tokens(text: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let in_name = |c: char| c.is_alphanumeric() || c == '_';
        let length = if rest.starts_with("//") {
            rest.find('\n')
        } else if let Some(comment) = rest.strip_prefix("/*") {
            comment.find("*/").map(|end| end + 4)
        } else if let Some(length) = quoted(rest) {
            Some(length)
        } else {
            let length = match rest.find(|c: char| !in_name(c)) {
                Some(0) if rest.starts_with("::") => 2,
                Some(0) => first.len_utf8(),
                Some(end) => end,
                None => rest.len(),
            };
            if !first.is_whitespace() {
                found.push(&rest[..length]);
            }
            Some(length)
        };
        rest = &rest[length.unwrap_or(rest.len())..];
    }
    found
}

/// The length of the string or character literal at the beginning, if there is one.
fn quoted(text: &str) -> Option<usize> {
    let plain = text.strip_prefix('b').unwrap_or(text);
    let before = text.len() - plain.len();
    if let Some(raw) = plain.strip_prefix('r') {
        let hashes = raw.len() - raw.trim_start_matches('#').len();
        let inside = raw[hashes..].strip_prefix('"')?;
        let end = format!("\"{}", "#".repeat(hashes));
        let length = inside.find(&end).map_or(inside.len(), |at| at + end.len());
        return Some(before + 1 + hashes + 1 + length);
    }
    let mut letters = plain.char_indices();
    let (_, quote) = letters.next().filter(|(_, c)| ['"', '\''].contains(c))?;
    let mut first = plain[1..].chars();
    if quote == '\'' && first.next() != Some('\\') && !first.as_str().starts_with('\'') {
        // A lifetime.
        return None;
    }
    let mut escaped = false;
    for (place, c) in letters {
        if c == quote && !escaped {
            return Some(before + place + 1);
        }
        escaped = c == '\\' && !escaped;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(text: &str) -> Path {
        text.split("::").map(str::to_owned).collect()
    }

    fn read(own: &str, text: &str) -> (Vec<String>, Vec<String>) {
        let modules = [
            "numerics::vector",
            "state",
            "state::run",
            "state::error",
            "solve",
        ];
        let modules: BTreeSet<Path> = modules.into_iter().map(path).collect();
        let found = module(&path(own), text, &modules);
        let words = |paths: Vec<Path>| paths.iter().map(|path| path.join("::")).collect();
        (words(found.imports.uses), words(found.for_tests))
    }

    #[test]
    fn all_paths_are_found() {
        let text = "use super::error::SolveError;\nuse crate::numerics::{self, vector::{dot, Lanes as L}};\n\
                    // crate::solve\n#[cfg(test)]\nuse crate::solve::newton;\nuse std::fmt;\n\
                    fn run() -> super::Own { L::new(crate::state::Run { a: fmt::new() }, \"crate::solve\", 'x', '\\'') }";
        let (uses, _) = read("state::run", text);
        let expected = [
            "state::error::SolveError",
            "numerics",
            "numerics::vector::dot",
            "numerics::vector::Lanes",
            "state::Own",
            "numerics::vector::Lanes::new",
            "state::Run",
        ];
        assert_eq!(uses, expected);
    }

    #[test]
    fn facades_do_not_use_what_they_re_export() {
        let text = "pub(crate) mod run;\nmod error;\n#[cfg(test)]\nmod samples;\npub use run::Run;\npub use error::{SolveError, Other};\n\
                    fn other() -> Other<'static> { self::run::start() }\n\
                    #[cfg(test)]\n#[allow(clippy::unwrap_used)]\nmod tests { use crate::solve; }";
        let (uses, for_tests) = read("state", text);
        assert_eq!(uses, ["state::error::Other", "state::run::start"]);
        assert_eq!(for_tests, ["state::samples"]);
    }

    #[test]
    fn texts_in_quotes_are_left_out() {
        let text = "a r#\"b \" c\"# 'd' &'e str b'\\'' br\"f\" \"g\\\"h\" /* i */ j";
        assert_eq!(tokens(text), ["a", "&", "'", "e", "str", "j"]);
    }
}
