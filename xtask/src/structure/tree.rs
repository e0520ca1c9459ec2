//! A tree of source files, and their dependencies.

use std::collections::{BTreeMap, BTreeSet};

/// Names from the root of a tree to a file, or to an item in a file. Empty for the root.
pub(super) type Path = Vec<String>;

/// Largest number of facades in a chain that is followed.
const CHAIN: usize = 10;

/// Imports of a file.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Imports {
    /// Paths that it uses.
    pub(super) uses: Vec<Path>,
    /// Names that this file re-exports, with the paths of the items; `None` for items outside of the tree.
    pub(super) names: BTreeMap<String, Option<Path>>,
}

/// The files of a tree with their imports.
pub(super) type Tree = BTreeMap<Path, Imports>;

/// The files that each file uses.
pub(super) type Arrows = BTreeMap<Path, BTreeSet<Path>>;

/// A path as text.
pub(super) fn shown(path: &[String]) -> String {
    match path {
        [] => "the root".to_owned(),
        _ => path.join("::"),
    }
}

/// The dependencies between files. An item that is used through a facade counts where it is defined.
pub(super) fn arrows(tree: &Tree) -> Arrows {
    let used = |(own, imports): (&Path, &Imports)| {
        let owners = imports.uses.iter().filter_map(|path| owner(tree, path));
        (own.clone(), owners.filter(|owner| owner != own).collect())
    };
    tree.iter().map(used).collect()
}

/// The file that defines the item at a path; `None` outside of the tree.
fn owner(tree: &Tree, path: &[String]) -> Option<Path> {
    let mut path = path.to_vec();
    for _ in 0..CHAIN {
        let length = (0..=path.len())
            .rev()
            .find(|length| tree.contains_key(&path[..*length]))?;
        let rest = path.split_off(length);
        let target = rest.first().and_then(|name| tree[&path].names.get(name));
        match target {
            None => return Some(path),
            Some(None) => return None,
            Some(Some(target)) => path = [&target[..], &rest[1..]].concat(),
        }
    }
    None
}

/// Files that use one in a later layer, or are in no layer. Layers are in the order of `LAYERS`; the root
/// is above them.
pub(super) fn upward(arrows: &Arrows, layers: &[&str]) -> Vec<String> {
    let floor = |path: &Path| match path.first() {
        Some(layer) => layers.iter().position(|name| name == layer),
        None => Some(layers.len()),
    };
    let mut problems = Vec::new();
    for (file, targets) in arrows {
        if floor(file).is_none() {
            let file = shown(file);
            problems.push(format!(
                "{file} is in no layer: add it to the list of layers"
            ));
        }
        for target in targets.iter().filter(|target| floor(target) > floor(file)) {
            let (file, target) = (shown(file), shown(target));
            problems.push(format!("{file} uses {target}, which is above it"));
        }
    }
    problems
}

/// Files that use themselves through other files.
pub(super) fn circles(arrows: &Arrows) -> Vec<String> {
    // Repeatedly removing files that use no remaining file leaves the circles and the files that lead to them.
    let mut left: Arrows = arrows.clone();
    loop {
        let names: BTreeSet<Path> = left.keys().cloned().collect();
        left.retain(|_, targets| targets.iter().any(|target| names.contains(target)));
        if left.len() == names.len() {
            break;
        }
    }
    // Likewise for files that no remaining file uses.
    loop {
        let before = left.len();
        let used: BTreeSet<Path> = left.values().flatten().cloned().collect();
        left.retain(|file, _| used.contains(file));
        if left.len() == before {
            break;
        }
    }
    let words = |(file, targets): (&Path, &BTreeSet<Path>)| {
        let inside = targets.iter().filter(|target| left.contains_key(*target));
        let inside: Vec<String> = inside.map(|target| shown(target)).collect();
        format!("in a circle: {} uses {}", shown(file), inside.join(", "))
    };
    left.iter().map(words).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(text: &str) -> Path {
        let words = text.split("::").filter(|word| !word.is_empty());
        words.map(str::to_owned).collect()
    }

    fn arrows_of(list: &[(&str, &[&str])]) -> Arrows {
        let pair = |(file, targets): &(&str, &[&str])| {
            let targets = targets.iter().map(|target| path(target));
            (path(file), targets.collect())
        };
        list.iter().map(pair).collect()
    }

    #[test]
    fn finds_upward_arrows_and_circles() {
        let layers = ["numerics", "state"];
        let good = arrows_of(&[
            ("state::run", &["numerics::vector"]),
            ("numerics::vector", &[]),
            ("", &["state::run"]),
        ]);
        assert!(upward(&good, &layers).is_empty() && circles(&good).is_empty());
        let bad = arrows_of(&[
            ("numerics::vector", &["state::run", ""]),
            ("state::run", &[]),
            ("elsewhere", &[]),
        ]);
        assert_eq!(upward(&bad, &layers).len(), 3);
        let circle = arrows_of(&[
            ("a", &["b"]),
            ("b", &["a"]),
            ("before", &["a"]),
            ("behind", &[]),
        ]);
        let found = circles(&circle);
        assert_eq!(found, ["in a circle: a uses b", "in a circle: b uses a"]);
    }

    #[test]
    fn what_a_facade_re_exports_is_used_where_it_is_defined() {
        let file = |uses: &[&str], names: &[(&str, Option<&str>)]| Imports {
            uses: uses.iter().map(|it| path(it)).collect(),
            names: names
                .iter()
                .map(|(name, target)| ((*name).to_owned(), target.map(path)))
                .collect(),
        };
        let tree = Tree::from([
            (
                path(""),
                file(&[], &[("Run", Some("state::Run")), ("serde", None)]),
            ),
            (
                path("state"),
                file(&[], &[("Run", Some("state::run::Run"))]),
            ),
            (path("state::run"), file(&[], &[])),
            (
                path("solve"),
                file(&["Run::new", "serde::de", "state::Own", "other"], &[]),
            ),
        ]);
        let targets = &arrows(&tree)[&path("solve")];
        let expected = ["", "state", "state::run"].map(path);
        assert_eq!(*targets, BTreeSet::from(expected));
    }
}
