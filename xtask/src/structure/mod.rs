//! Checks that dependencies between crates, and between the modules of a crate, point in one direction, and that no file of a crate, of the Python package
//! or of the page uses itself through other files; and that no comparison of numbers panics on NaN.
//!
//! A file that uses an item through a facade (`lib.rs`, `mod.rs`, `__init__.py`) depends on the file that defines the item. A facade does not depend
//! on what it only re-exports. Tests are exempt.

mod comparisons;
mod files;
mod python;
mod rust;
mod script;
mod tree;

use self::files::{collect, read, root};
use self::tree::{Arrows, Path, Tree, arrows, circles, upward};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::path::{Path as FilePath, PathBuf};

/// The crates; each depends only on crates before it.
const CRATES: [&str; 11] = [
    "fakir-fft",
    "fakir",
    "fakir-case",
    "fakir-figure",
    "fakir-study",
    "fakir-inverse",
    "fakir-paper",
    "fakir-explore",
    "fakir-page",
    "fakir-cli",
    "fakir-py",
];

/// Crates with layers of modules; each layer uses only layers before it. The last ones are files.
const LAYERS: [(&str, &[&str]); 1] = [(
    "fakir",
    &[
        "numerics",
        "problem",
        "halfspace",
        "state",
        "theory",
        "solve",
        "method",
        "verify",
        "collapse",
    ],
)];

/// The check.
pub(crate) fn check(_cargo: &OsStr) -> Result<(), String> {
    let mut problems = comparisons::problems()?;
    problems.extend(dependencies()?);
    let mut folders: Vec<(String, Tree)> = Vec::new();
    for name in CRATES {
        let source = root().join("crates").join(name).join("src");
        folders.push((name.to_owned(), crate_tree(&source)?));
    }
    folders.push(("xtask".to_owned(), crate_tree(&root().join("xtask/src"))?));
    let package = root().join("python/fakir");
    let mut package = plain_tree(&package, "py", "__init__", python::imports)?;
    // The extension module, which imports none of the others.
    package.insert(vec!["_fakir".to_owned()], tree::Imports::default());
    folders.push(("Python package".to_owned(), package));
    let page = root().join("crates/fakir-explore/page");
    let page = plain_tree(&page, "js", "", script::imports)?;
    folders.push(("page".to_owned(), page));
    for (name, tree) in folders {
        let arrows = arrows(&tree);
        let targets: usize = arrows.values().map(BTreeSet::len).sum();
        println!("{name}: {} files, {targets} arrows", arrows.len());
        let found = problems_of(&name, &arrows).into_iter();
        problems.extend(found.map(|problem| format!("{name}: {problem}")));
    }
    if problems.is_empty() {
        Ok(())
    } else {
        Err(problems.join("\n"))
    }
}

fn problems_of(name: &str, arrows: &Arrows) -> Vec<String> {
    let layers = LAYERS.iter().find(|(own, _)| *own == name);
    let mut problems = layers.map_or_else(Vec::new, |(_, layers)| upward(arrows, layers));
    problems.extend(circles(arrows));
    problems
}

/// Crates that depend on a later one, or are not on the list.
fn dependencies() -> Result<Vec<String>, String> {
    let floor = |name: &str| CRATES.iter().position(|own| *own == name);
    let mut problems = Vec::new();
    for name in CRATES {
        let manifest = read(&root().join("crates").join(name).join("Cargo.toml"))?;
        for other in depends_on(&manifest) {
            if floor(&other).is_none_or(|other| Some(other) >= floor(name)) {
                problems.push(format!("{name} depends on {other}, which is not below it"));
            }
        }
    }
    let folders = std::fs::read_dir(root().join("crates")).map_err(|error| error.to_string())?;
    for folder in folders {
        let folder = folder.map_err(|error| error.to_string())?.file_name();
        let name = folder.to_string_lossy();
        if floor(&name).is_none() {
            problems.push(format!("{name} is not in the list of crates: add it"));
        }
    }
    Ok(problems)
}

/// The crates of the project that a crate depends on, except for its tests.
fn depends_on(manifest: &str) -> Vec<String> {
    let mut is_table = false;
    let mut found = Vec::new();
    for line in manifest.lines() {
        if let Some(table) = line.strip_prefix('[') {
            is_table = table.ends_with("dependencies]") && !table.contains("dev-dependencies");
        } else if is_table {
            let end = line.find(|c: char| !(c.is_alphanumeric() || c == '-' || c == '_'));
            let name = &line[..end.unwrap_or(line.len())];
            if name.starts_with("fakir") {
                found.push(name.to_owned());
            }
        }
    }
    found
}

/// The modules of a crate, except those for tests only.
fn crate_tree(source: &FilePath) -> Result<Tree, String> {
    let mut files = Vec::new();
    collect(source, "rs", &mut files)?;
    // The program of a crate that is also a library.
    let is_library = source.join("lib.rs").exists();
    files.retain(|file| !(is_library && *file == source.join("main.rs")));
    let texts: BTreeMap<Path, String> = texts(source, &files, &["lib", "main", "mod"])?;
    let modules: BTreeSet<Path> = texts.keys().cloned().collect();
    let mut tree = Tree::new();
    let mut for_tests = Vec::new();
    for (path, text) in &texts {
        let module = rust::module(path, text, &modules);
        tree.insert(path.clone(), module.imports);
        for_tests.extend(module.for_tests);
    }
    tree.retain(|path, _| !for_tests.iter().any(|tests| path.starts_with(tests)));
    Ok(tree)
}

/// The modules of a folder without subfolders.
fn plain_tree(
    folder: &FilePath,
    extension: &str,
    facade: &str,
    imports: fn(&str) -> tree::Imports,
) -> Result<Tree, String> {
    let mut files = Vec::new();
    collect(folder, extension, &mut files)?;
    files.retain(|file| file.parent() == Some(folder));
    let texts = texts(folder, &files, &[facade])?.into_iter();
    Ok(texts.map(|(path, text)| (path, imports(&text))).collect())
}

/// The contents of files by their paths. Facades have the path of their folder.
fn texts(
    root: &FilePath,
    files: &[PathBuf],
    facades: &[&str],
) -> Result<BTreeMap<Path, String>, String> {
    let mut texts = BTreeMap::new();
    for file in files {
        let inside = file.strip_prefix(root).unwrap_or(file).with_extension("");
        let words = inside.iter().map(|word| word.to_string_lossy());
        let words = words.filter(|word| !facades.contains(&&**word));
        texts.insert(words.map(Cow::into_owned).collect(), read(file)?);
    }
    Ok(texts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dependencies_of_tests_are_left_out() {
        let manifest = "[package]\nname = \"fakir-study\"\n\n[dependencies]\nfakir.workspace = true\nfakir-case = { workspace = true }\n\
                        [dev-dependencies]\nfakir-cli.workspace = true\n";
        assert_eq!(depends_on(manifest), ["fakir", "fakir-case"]);
    }
}
