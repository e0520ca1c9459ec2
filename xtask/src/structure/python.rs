//! Imports of a module of a Python package.
//!
//! Imports for annotations only, below `if TYPE_CHECKING:`, are ignored: they are not executed.

use super::tree::Imports;

/// The name of the package, by which its modules can be imported too.
const PACKAGE: &str = "fakir";

/// The imports of a module in the folder of the package, also inside functions.
pub(super) fn imports(text: &str) -> Imports {
    let mut imports = Imports::default();
    for statement in statements(text) {
        if let Some((module, names)) = statement.split_once(" import ") {
            let module = module.trim_start_matches("from ").trim();
            let module = match module.strip_prefix('.') {
                Some(inside) => Some(inside),
                None => inside_package(module),
            };
            let folder = module.map(|module| words(module).collect::<Vec<_>>());
            for item in names.split(',').map(str::trim).filter(|it| !it.is_empty()) {
                let (name, alias) = item.split_once(" as ").unwrap_or((item, item));
                let target = folder.clone().map(|mut path| {
                    path.push(name.to_owned());
                    path
                });
                imports.uses.extend(target.clone());
                imports.names.insert(alias.to_owned(), target);
            }
        } else if let Some(modules) = statement.strip_prefix("import ") {
            let modules = modules
                .split(',')
                .filter_map(|it| it.split_whitespace().next());
            let inside = modules.filter_map(inside_package);
            imports
                .uses
                .extend(inside.map(|module| words(module).collect()));
        }
    }
    imports
}

/// The path of a module inside the package, if it exists.
fn inside_package(module: &str) -> Option<&str> {
    let rest = module.strip_prefix(PACKAGE)?;
    rest.strip_prefix('.').or(rest.is_empty().then_some(rest))
}

fn words(module: &str) -> impl Iterator<Item = String> {
    let words = module.split('.').filter(|word| !word.is_empty());
    words.map(str::to_owned)
}

/// The import statements of a module, each in one line without parentheses.
fn statements(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    // Whether the line is in a text of several lines, and how far a block of types is indented.
    let (mut quoted, mut types) = (false, None);
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let was_quoted = quoted;
        quoted ^= line.matches("\"\"\"").count() % 2 == 1;
        let code = line.split('#').next().unwrap_or_default();
        let indent = line.len() - line.trim_start().len();
        if was_quoted || code.trim().is_empty() {
            continue;
        }
        if types.is_some_and(|types| indent > types) {
            continue;
        }
        types = (code.trim() == "if TYPE_CHECKING:").then_some(indent);
        let mut statement = code.trim().to_owned();
        if !(statement.starts_with("import ") || statement.starts_with("from ")) {
            continue;
        }
        if statement.contains('(') {
            let rest = lines.by_ref().take_while(|line| !line.contains(')'));
            let rest = rest.map(|line| line.split('#').next().unwrap_or_default().trim());
            if !statement.contains(')') {
                let rest: Vec<&str> = rest.collect();
                statement = format!("{statement} {}", rest.join(" "));
            }
            statement = statement.replace(['(', ')'], "");
        }
        found.push(statement);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn imports_of_all_kinds_are_found() {
        let text = "\
\"\"\"A module.

from here import nothing
\"\"\"
import json, fakir.love
from . import _fakir, plot as draw  # from elsewhere
from ._state import (
    ContactState,  # a state
    Limit,
)
from fakir._run import warn
from numpy import array

if TYPE_CHECKING:
    from ._system import System


def load():
    from .love import Surface
";
        let found = imports(text);
        let uses: Vec<String> = found.uses.iter().map(|path| path.join(".")).collect();
        let expected = [
            "love",
            "_fakir",
            "plot",
            "_state.ContactState",
            "_state.Limit",
            "_run.warn",
            "love.Surface",
        ];
        assert_eq!(uses, expected);
        assert_eq!(found.names["draw"], Some(vec!["plot".to_owned()]));
        assert_eq!(found.names["array"], None);
    }
}
