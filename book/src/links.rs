//! Whether every link inside the book leads somewhere, and nothing is loaded from a network.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// A page: what other pages can point at in it, and what it points at.
struct Page {
    anchors: BTreeSet<String>,
    links: Vec<String>,
    /// Addresses of scripts, styles and pictures.
    loaded: Vec<String>,
}

/// Checks all pages of a book that has been built.
pub(crate) fn check(output: &Path) -> Result<(), String> {
    let mut pages = BTreeMap::new();
    collect(output, &mut pages)?;
    let mut problems = Vec::new();
    for (path, page) in &pages {
        let here = path.strip_prefix(output).unwrap_or(path).display();
        for address in &page.loaded {
            if address.contains("//") && !address.starts_with("data:") {
                problems.push(format!("{here} loads {address} from a network"));
            }
        }
        for link in page.links.iter().chain(&page.loaded) {
            if link.contains("//") || link.starts_with("mailto:") || link.starts_with("data:") {
                continue;
            }
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() {
                path.clone()
            } else {
                normal(&path.parent().unwrap_or(output).join(file))
            };
            let found = match pages.get(&target) {
                Some(other) => anchor.is_empty() || other.anchors.contains(anchor),
                None => target.exists(),
            };
            if !found {
                problems.push(format!("{here} points at {link}, which is not there"));
            }
        }
    }
    println!("{} pages, all links inside the book are valid", pages.len());
    if problems.is_empty() {
        Ok(())
    } else {
        Err(problems.join("\n"))
    }
}

fn collect(folder: &Path, pages: &mut BTreeMap<PathBuf, Page>) -> Result<(), String> {
    let unreadable = |error| format!("{}: {error}", folder.display());
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        // The page of what is not found is served from anywhere, and the one to print repeats the others.
        let left_out = ["404.html", "print.html", "toc.html"]
            .iter()
            .any(|name| path.ends_with(name));
        if path.is_dir() {
            collect(&path, pages)?;
        } else if path
            .extension()
            .is_some_and(|extension| extension == "html")
            && !left_out
        {
            let text = fs::read_to_string(&path).map_err(unreadable)?;
            let page = Page {
                anchors: attributes(&text, &[" id=\""]).into_iter().collect(),
                links: attributes(&text, &["<a href=\"", "<a class=\"header\" href=\""]),
                loaded: attributes(&text, &[" src=\"", "<link rel=\"stylesheet\" href=\""]),
            };
            pages.insert(path, page);
        }
    }
    Ok(())
}

/// The values of attributes that begin so.
fn attributes(text: &str, beginnings: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    for beginning in beginnings {
        for (place, _) in text.match_indices(beginning) {
            let rest = &text[place + beginning.len()..];
            if let Some((value, _)) = rest.split_once('"') {
                found.push(value.replace("&amp;", "&"));
            }
        }
    }
    found
}

/// A path without steps up.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        if part == Component::ParentDir {
            normal.pop();
        } else {
            normal.push(part);
        }
    }
    normal
}
